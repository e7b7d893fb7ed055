//! `springpot init`: what it writes passes `check` and `run` as it is.

use crate::support::{Place, testdata};
use std::fs;

/// Checks and runs the starter, and returns its text.
fn runs(place: &Place, file: &str) -> String {
    let checked = place.done(&["check", file]);
    assert!(checked.stdout.contains("strut: fractional-kelvin-voigt"), "{}", checked.stdout);
    place.done(&["run", file, "--out", "ran", "--quiet", "--set", "time.end=0.2", "--no-figures"]);
    assert_eq!(place.record("ran")["cases_done"], 3);
    let strokes = place.table("ran/results.csv").numbers("strut.stroke");
    let (low, high) = strokes.iter().fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(*x), high.max(*x)));
    assert!(high - low > 1e-4, "{file}: the strut changes by {}", high - low);
    place.read(file)
}

#[test]
fn without_a_robot() {
    let place = Place::new();
    let ended = place.done(&["init"]);
    assert!(ended.stdout.contains("wrote scenario.toml") && ended.stdout.contains("springpot run scenario.toml"));
    let text = runs(&place, "scenario.toml");
    assert!(text.lines().filter(|line| line.contains('#')).count() > 10, "{text}");
    // The figures are drawn too.
    place.done(&["run", "scenario.toml", "--quiet"]);
    let files = place.files("results/scenario/figures");
    assert_eq!(files, ["force.png", "force.svg", "loop.png", "loop.svg", "robot.png", "robot.svg"]);
}

#[test]
fn robots_of_every_kind() {
    for robot in ["anymal_b", "double_pendulum", "panda", "simple_humanoid", "solo12", "ur5"] {
        let place = Place::new();
        fs::copy(testdata(&format!("multibody/{robot}.urdf")), place.path(format!("{robot}.urdf"))).unwrap();
        place.done(&["init", &format!("{robot}.urdf")]);
        let text = runs(&place, &format!("{robot}.toml"));
        assert!(text.contains(&format!("urdf = \"{robot}.urdf\"\n")), "{text}");
        let zeros = ["0000000", "9999999"];
        assert!(!zeros.iter().any(|digits| text.contains(digits)), "{text}");
    }
}

#[test]
fn paths_lead_from_the_scenario_to_the_robot() {
    let place = Place::new();
    for folder in ["robots", "studies/first"] {
        fs::create_dir_all(place.path(folder)).unwrap();
    }
    fs::copy(testdata("multibody/double_pendulum.urdf"), place.path("robots/a \"b\".urdf")).unwrap();
    place.done(&["init", "robots/a \"b\".urdf", "--out", "studies/first/swing.toml"]);
    let text = runs(&place, "studies/first/swing.toml");
    assert!(text.contains(r#"urdf = "../../robots/a \"b\".urdf""#), "{text}");
}

#[test]
fn strange_names_are_quoted() {
    let place = Place::new();
    let link = |name: &str, com: &str| {
        format!(
            "<link name=\"{name}\"><inertial><origin xyz=\"{com}\"/><mass value=\"1\"/>\
             <inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>"
        )
    };
    // Its centre of mass is on the axis, so that only another point gives the element a stroke.
    place.write(
        "odd.urdf",
        format!(
            "<robot name=\"o'dd\"><link name=\"base\"/>{}<joint name=\"left knee.1\" type=\"revolute\"><parent link=\"base\"/>\
             <child link=\"lower leg\"/><axis xyz=\"0 0 1\"/><limit lower=\"1\" upper=\"2\" effort=\"1\" velocity=\"0.5\"/></joint></robot>",
            link("lower leg", "0.1 0 0")
        ),
    );
    place.done(&["init", "odd.urdf"]);
    let text = runs(&place, "odd.toml");
    assert!(text.contains("\"left knee.1\" = \"1.5 + 0.072*sin(2*pi*t)\"\n"), "{text}");
}

#[test]
fn nothing_is_overwritten_and_bad_robots_are_refused() {
    let place = Place::new();
    let before = place.read("arm.toml");
    let refused = place.springpot(&["init", "--out", "arm.toml"]);
    assert_eq!(refused.code, Some(2));
    assert!(refused.stderr.contains("arm.toml is there already") && place.read("arm.toml") == before);

    place.write("bad.urdf", "<robot><link name=\"a\"></robot>");
    let refused = place.springpot(&["init", "bad.urdf"]);
    assert!(refused.code == Some(2) && refused.stderr.contains("bad.urdf:1:"), "{}", refused.stderr);
    place.write(
        "rigid.urdf",
        "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/>\
         <joint name=\"j\" type=\"fixed\"><parent link=\"a\"/><child link=\"b\"/></joint></robot>",
    );
    let refused = place.springpot(&["init", "rigid.urdf"]);
    let help = "with `springpot init rigid.urdf --floating-base` its root link floats";
    assert!(refused.code == Some(2) && refused.stderr.contains("no joint moves"), "{}", refused.stderr);
    assert!(refused.stderr.contains(help), "{}", refused.stderr);
    let failed = place.springpot(&["init", "--out", "nowhere/x.toml"]);
    assert!(failed.code == Some(1) && failed.stderr.contains("cannot be written"), "{}", failed.stderr);
    assert_eq!(place.files("."), ["arm.toml", "bad.urdf", "rigid.urdf"]);
}

#[test]
fn links_and_a_floating_base_are_chosen() {
    let place = Place::new();
    let panda = testdata("multibody/panda.urdf");
    for (arguments, from, to) in [
        (&["--from", "panda_link1", "--to", "panda_link4"][..], "panda_link1", "panda_link4"),
        (&["--from", "world", "--to", "panda_link2"], "world", "panda_link2"),
        (&["--to", "panda_link6"], "", "panda_link6"),
    ] {
        place.done(&[&["init", &panda, "--out", "chosen.toml"][..], arguments].concat());
        let text = runs(&place, "chosen.toml");
        assert!(text.contains(&format!("from = {{ body = \"{from}")), "{text}");
        assert!(text.contains(&format!("to = {{ body = \"{to}\"")), "{text}");
        std::fs::remove_file(place.path("chosen.toml")).unwrap();
    }
    for (arguments, words) in [
        (&["--from", "panda_lnk1"][..], "no link \"panda_lnk1\"\n  help: did you mean `panda_link1`?"),
        (
            &["--from", "panda_link1", "--to", "panda_link1"],
            "--from and --to are one link, \"panda_link1\": an element joins two",
        ),
    ] {
        let refused = place.springpot(&[&["init", &panda, "--out", "chosen.toml"][..], arguments].concat());
        assert!(refused.code == Some(2) && refused.stderr.contains(words), "{}", refused.stderr);
    }
    let inertial = "<inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>";
    place.write("drone.urdf", format!("<robot name=\"d\"><link name=\"frame\">{inertial}</link></robot>"));
    place.done(&["init", "drone.urdf", "--floating-base"]);
    let text = runs(&place, "drone.toml");
    assert!(
        text.contains("floating_base = true\n") && text.contains("floating_base = { z = \"0.02*sin(2*pi*t)\" }\n"),
        "{text}"
    );
}
