//! Cables, elements on joints and bushings as a user meets them.

use crate::support::{Csv, Place};
use serde_json::json;

const ROBOT: &str = r#"[robot]
[[robot.body]]
name = "upper"
joint = { name = "q1", kind = "revolute", axis = [0, 1, 0], origin = [0, 0, 0] }
mass = 3.0
com = [0.25, 0.01, 0.02]
inertia = { xx = 0.01, yy = 0.07, zz = 0.07 }
[[robot.body]]
name = "fore"
joint = { name = "q2", kind = "continuous", axis = [0, 1, 0], origin = [0.5, 0, 0] }
mass = 2.0
com = [0.18, -0.01, 0.01]
inertia = { xx = 0.006, yy = 0.03, zz = 0.03 }
[[robot.body]]
name = "slide"
joint = { name = "s", kind = "prismatic", axis = [1, 0, 0], origin = [0.3, 0, 0] }
mass = 0.5
com = [0, 0, 0]
inertia = { xx = 0.001, yy = 0.001, zz = 0.001 }
"#;

const CABLE: &str = r#"[[element]]
name = "rope"
from = { body = "world", point = [0, 0, -0.3] }
via = [{ body = "upper", point = [0.2, 0, -0.1] }, { body = "upper", point = ["30 cm", 0, -0.1] }]
to = { body = "fore", point = [0.2, 0, 0] }
rest_length = "0.5 m"
law = "fractional-kelvin-voigt"
parameters = { k = "200 N/m", c = "40 N*s^alpha/m", alpha = 0.4 }
"#;

const TORSION: &str = r#"[[element]]
name = "torsion"
joint = "q2"
rest = "10 deg"
law = "fractional-kelvin-voigt"
parameters = { k = "5 N*m/rad", c = "0.4 N*m*s^alpha/rad", alpha = 0.3 }
"#;

const BUSHING: &str = r#"[[element]]
name = "mount"
from = { body = "upper", point = [0.5, 0, 0] }
to = { body = "fore", point = [0.01, 0, 0], rpy = [0, "5 deg", 0] }
[element.bushing]
x = { law = "spring", parameters = { k = "2 kN/m" } }
ry = { network = "parallel(spring(k), springpot(c, a))", parameters = { k = "3 N*m/rad", c = "0.2 N*m*s^a/rad", a = 0.4 }, rest = "start" }
"#;

const MOTION: &str = r#"[motion]
kind = "forward"
start = { q = { q1 = 0.1, q2 = 0.4 }, v = { q2 = -1.0 } }
[time]
end = 0.5
output_step = 0.05
"#;

fn place(elements: &[&str]) -> Place {
    Place::with(&[&[ROBOT], elements, &[MOTION]].concat().concat())
}

fn rows(place: &Place) -> Csv {
    place.done(&["run", "arm.toml", "--quiet"]);
    place.table("results/arm/results.csv")
}

/// `check` refuses with these words.
fn refused(elements: &[&str], set: &[&str], words: &[&str]) {
    let set: Vec<&str> = set.iter().flat_map(|one| ["--set", one]).collect();
    let place = place(elements);
    let ended = place.springpot(&[&["check", "arm.toml"][..], &set].concat());
    assert_eq!(ended.code, Some(2), "{}", ended.stdout);
    let text = ended.said();
    for words in words {
        assert!(text.contains(words), "{words}\nis not in\n{}", ended.stderr);
    }
}

#[test]
fn columns_and_record_of_each_shape() {
    let place = place(&[CABLE, TORSION, BUSHING]);
    let table = rows(&place);
    let record = place.record("results/arm");
    let unit = |column: &str| {
        table.at(column);
        let all = record["columns"].as_array().unwrap();
        all.iter().find(|one| one["name"] == column).map(|one| one["unit"].as_str().unwrap().to_owned()).unwrap()
    };
    for (element, units) in [
        ("rope", ["m", "m", "m/s", "m/s^alpha", "N"]),
        ("torsion", ["rad", "rad", "rad/s", "rad/s^alpha", "N*m"]),
        ("mount.x", ["m", "m", "m/s", "m", "N"]),
        ("mount.ry", ["rad", "rad", "rad/s", "rad/s", "N*m"]),
    ] {
        let keys = ["length", "stroke", "rate", "derivative", "force"].map(|key| format!("{element}.{key}"));
        let found = keys.each_ref().map(|key| unit(key));
        if element == "mount.ry" {
            // A network's order has any name.
            assert_eq!(found[..3], units[..3]);
        } else {
            assert_eq!(found, units.map(str::to_owned), "{element}");
        }
        assert_eq!(unit(&format!("{element}.Q.q2")), "N*m");
    }
    // The torsion spring is on the joint, at 10 degrees.
    let (q, y, x) = (table.numbers("q.q2"), table.numbers("torsion.length"), table.numbers("torsion.stroke"));
    let (force, pull) = (table.numbers("torsion.force"), table.numbers("torsion.Q.q2"));
    for k in 0..q.len() {
        assert!((y[k] - q[k]).abs() < 1e-14 && (x[k] - q[k] + 10f64.to_radians()).abs() < 1e-14);
        assert!((force[k] + pull[k]).abs() < 1e-12);
    }
    assert_eq!(table.numbers("mount.ry.stroke")[0], 0.0);
    let turn = table.numbers("mount.ry.length");
    for k in 0..q.len() {
        assert!((turn[k] - q[k] - 5f64.to_radians()).abs() < 1e-12, "{} {}", turn[k], q[k]);
    }
    let elements = &record["plan"]["elements"];
    assert_eq!(elements[0]["via"][1], json!({ "body": "upper", "point": [0.3, 0.0, -0.1] }));
    assert_eq!((&elements[1]["joint"], &elements[1]["rest"]), (&json!("q2"), &json!(10f64.to_radians())));
    assert_eq!((&elements[2]["name"], &elements[2]["bushing"]), (&json!("mount.x"), &json!("x")));
    assert_eq!(elements[3]["to"]["rpy"], json!([0.0, 5f64.to_radians(), 0.0]));
    let residual = &record["cases"][0]["energy_residual"];
    assert!(residual.is_null() || residual.as_f64().unwrap() < 1e-6, "{residual}");
}

#[test]
fn components_have_paths() {
    let place = place(&[CABLE, BUSHING]);
    place.done(&[
        "run",
        "arm.toml",
        "--quiet",
        "--set",
        "element.mount.ry.a=0.7",
        "--set",
        "element.mount.z.law=spring",
        "--set",
        "element.mount.z.parameters={ k = 100 }",
        "--set",
        "element.rope.via=[{ body = \"upper\", point = [0.2, 0, -0.2] }]",
        "--sweep",
        "element.mount.x.k=1 kN/m,3 kN/m",
    ]);
    let record = place.record("results/arm");
    let elements = &record["plan"]["elements"];
    assert_eq!(elements[3]["parameters"]["a"], json!(0.7));
    assert_eq!((&elements[2]["name"], &elements[2]["parameters"]["k"]), (&json!("mount.z"), &json!(100.0)));
    let table = place.table("results/arm/results.csv");
    assert_eq!(table.numbers("element.mount.x.k").last(), Some(&3000.0));
    let set = ["element.mount.ry.stiffness=3"];
    refused(&[BUSHING], &set, &["`element.mount.ry` has no `stiffness`"]);
    refused(&[BUSHING], &["element.mount.rw=3"], &["`element.mount` has no `rw`", "rx"]);
}

#[test]
fn check_and_dynamics_tell_them() {
    let place = place(&[CABLE, TORSION, BUSHING]);
    let said = place.done(&["check", "arm.toml"]).stdout;
    for words in [
        "rope: fractional-kelvin-voigt, cable over 2 points, caputo",
        "torsion: fractional-kelvin-voigt, on joint q2, caputo",
        "y(0) = 0.4 rad, y0 = 0.174533 rad",
        "mount.ry: network, caputo",
        "k\u{a0}=\u{a0}5\u{a0}N*m/rad",
        "dy/dq = q1: 0, q2: 1, s: 0",
    ] {
        assert!(
            said.contains(words) || said.replace('\u{a0}', " ").contains(&words.replace('\u{a0}', " ")),
            "{words}\n{said}"
        );
    }
    let said = place.done(&["dynamics", "arm.toml", "--at", "0.2"]).stdout;
    for words in ["Q rope", "Q torsion", "Q mount.x", "y - y0"] {
        assert!(said.contains(words), "{words}\n{said}");
    }
}

#[test]
fn the_sketch_shows_them() {
    let place = place(&[CABLE, TORSION, BUSHING, "[[figure]]\nname = \"robot\"\nkind = \"robot\"\n"]);
    place.done(&["run", "arm.toml", "--quiet"]);
    let svg = place.read("results/arm/figures/robot.svg");
    assert!(svg.len() > 2000);
}

#[test]
fn units_of_rotations_are_those_of_rotations() {
    let words = &["`N/m` does not fit: this place takes `N*m/rad`"];
    refused(&[TORSION], &["element.torsion.k=5 N/m"], words);
    refused(&[TORSION], &["element.torsion.rest=1 cm"], &["rad"]);
    refused(&[&TORSION.replace("q2", "s")], &[], &["N/m"]);
    let slides = TORSION.replace("q2", "s").replace("N*m", "N").replace("/rad", "/m").replace("10 deg", "1 cm");
    rows(&place(&[&slides]));
    rows(&place(&[&TORSION.replace("\"10 deg\"", "\"start\"")]));
    refused(&[BUSHING], &["element.mount.ry.k=1 N/m"], &["N*m/rad"]);
    refused(&[TORSION], &["element.torsion.k=-1"], &["N*m/rad"]);
}

#[test]
fn what_cannot_be_is_refused() {
    let twice = CABLE.replace("[\"30 cm\", 0, -0.1]", "[0.2, 0, -0.1]");
    refused(&[&twice], &[], &["point 1 of `via` and point 2 of `via` are one point", "segment 2"]);
    let end = CABLE.replace("body = \"upper\", point = [\"30 cm\", 0, -0.1]", "body = \"fore\", point = [0.2, 0, 0]");
    refused(&[&end], &[], &["point 2 of `via` and `to`", "segment 3"]);
    let rigid = CABLE.replace("fore", "upper").replace("\"world\"", "\"upper\"");
    refused(&[&rigid], &[], &["its length cannot change"]);
    refused(&[&CABLE.replace("\"fore\"", "\"fire\"")], &[], &["names no body: \"fire\"", "fore"]);
    let both = format!("{TORSION}from = {{ body = \"world\", point = [0, 0, 0] }}\n");
    refused(&[&both], &[], &["element \"torsion\" has both `joint` and `from`: leave one of them out"]);
    refused(&[&TORSION.replace("\"q2\"", "\"q22\"")], &[], &["names no joint: \"q22\"", "q2"]);
    refused(&[&TORSION.replace("rest =", "rest_length =")], &[], &["write `rest`"]);
    refused(&[&CABLE.replace("rest_length", "rest")], &[], &["write `rest_length`"]);
    refused(&[&BUSHING.replace("to = {", "law = \"spring\"\nto = {")], &[], &["has no `law`: write it in a component"]);
    let (frames, _) = BUSHING.split_once("[element.bushing]").unwrap();
    refused(&[&format!("{frames}bushing = {{}}\n")], &[], &["has no component", "x, y, z, rx, ry and rz"]);
    refused(&[&format!("{frames}bushing = {{ rw = {{ law = \"spring\" }} }}\n")], &[], &["unknown key `rw`"]);
    refused(&[&BUSHING.replace("\"fore\"", "\"upper\"")], &[], &["frames cannot move against each other"]);
    let turned = CABLE.replace("0, -0.3] }", "0, -0.3], rpy = [0, 0, 1] }");
    refused(&[&turned], &[], &["`rpy` of", "a point has no axes"]);
    let floating = TORSION.replace("\"q2\"", "\"base\"").replace("\"10 deg\"", "0");
    let base =
        ROBOT.replace("name = \"q1\", kind = \"revolute\", axis = [0, 1, 0],", "name = \"base\", kind = \"floating\",");
    let motion = MOTION.replace("q1 = 0.1, ", "");
    let place = Place::with(&[&base, &floating, &motion].map(String::as_str).concat());
    let ended = place.springpot(&["check", "arm.toml"]);
    let said = ended.said();
    assert_eq!(ended.code, Some(2), "{}", ended.stdout);
    assert!(
        said.contains("joint \"base\" is floating") && said.contains("joints with one coordinate are q2"),
        "{said}"
    );
}

#[test]
fn half_a_turn_stops_a_run() {
    let place = place(&[BUSHING]);
    let set = ["--set", "motion.start.v={ q2 = 60 }", "--set", "element.mount.ry.k=0", "--set", "element.mount.x.k=1"];
    let ended = place.springpot(&[&["run", "arm.toml", "--quiet"][..], &set].concat());
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    let said = ended.said();
    for words in ["element \"mount.ry\" is turned by 3.1", "jumps at half a turn, pi", "error: arm.toml:", ": t = 0."] {
        assert!(said.contains(words), "{words}\n{said}");
    }
    assert_eq!(place.record("results/arm")["status"], json!("failed"));
}
