//! `springpot dynamics --states`: the reference robots through the program, whole files, and the order of the numbers.

use crate::support::{Ended, Place, numbers, testdata};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::Write;
use std::process::Stdio;

/// A robot of testdata/multibody: its reference file, its URDF, how it is read, and the number of its states.
struct Reference {
    file: &'static str,
    urdf: &'static str,
    flags: &'static [&'static str],
    states: usize,
}

const fn reference(file: &'static str, urdf: &'static str, flags: &'static [&'static str], states: usize) -> Reference {
    Reference { file, urdf, flags, states }
}

const REFERENCES: [Reference; 8] = [
    reference("double_pendulum", "double_pendulum", &["--christoffel"], 5),
    reference("ur5", "ur5", &["--christoffel"], 5),
    reference("panda", "panda", &["--christoffel", "--ignore-mimic"], 5),
    reference("simple_humanoid", "simple_humanoid", &["--christoffel"], 5),
    reference("solo12_ff", "solo12", &["--floating-base"], 3),
    reference("anymal_b_ff", "anymal_b", &["--floating-base"], 3),
    reference("simple_humanoid_ff", "simple_humanoid", &["--floating-base"], 2),
    reference("panda_mimic", "panda", &["--christoffel"], 3),
];

/// Keys of the results, of the reference, and the error allowed in units of the largest entry.
const COMPARED: [(&str, &str, f64); 15] = [
    ("M", "M", 1e-12),
    ("coriolis", "C_matrix", 1e-12),
    ("gravity", "g", 1e-12),
    ("rnea", "rnea", 1e-12),
    ("aba", "aba", 1e-12),
    ("rnea_dq", "drnea_dq", 1e-10),
    ("rnea_dv", "drnea_dqd", 1e-10),
    ("aba_dq", "daba_dq", 1e-10),
    ("aba_dv", "daba_dqd", 1e-10),
    ("aba_dtau", "daba_dtau", 1e-12),
    ("kinetic", "kinetic", 1e-12),
    ("potential", "potential", 1e-12),
    ("com", "com", 1e-12),
    ("jacobian", "ee_J_lwa", 1e-12),
    ("pose", "", 1e-12),
];

/// Compares to `tolerance` of the largest reference value; returns how many numbers were compared, and the worst error.
fn close(what: &str, computed: &Value, reference: &Value, tolerance: f64) -> (usize, f64) {
    let (computed, reference) = (numbers(computed), numbers(reference));
    assert_eq!(computed.len(), reference.len(), "{what}");
    let largest = reference.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let mut worst = 0.0_f64;
    for (k, (c, r)) in computed.iter().zip(&reference).enumerate() {
        assert!((c - r).abs() <= tolerance * largest, "{what}[{k}]: {c} instead of {r}");
        worst = worst.max((c - r).abs() / largest.max(f64::MIN_POSITIVE));
    }
    (reference.len(), worst)
}

/// The reference has the force index first: [c][a][b].
fn moved(christoffel: &Value) -> Value {
    let n = christoffel.as_array().unwrap().len();
    let at = |a: usize, b: usize, c: usize| christoffel[a][b][c].clone();
    (0..n).map(|c| (0..n).map(|a| (0..n).map(|b| at(a, b, c)).collect()).collect::<Vec<Value>>()).collect()
}

/// The names of the joints that have numbers of their own, and the states as the program takes them.
fn input(reference: &Value) -> (Vec<String>, Vec<Value>) {
    let joints = reference["model"]["joints"].as_array().unwrap().iter();
    let own = joints.filter(|joint| joint["mimic"].is_null());
    let names = own.map(|joint| joint["name"].as_str().unwrap().to_owned()).collect();
    let state = |s: &Value| json!({ "q": s["q"], "v": s["qd"], "a": s["qdd"], "tau": s["tau"] });
    (names, reference["states"].as_array().unwrap().iter().map(state).collect())
}

fn run(place: &Place, urdf: &str, input: &Value, flags: &[&str]) -> Value {
    place.write("states.json", input.to_string());
    let urdf = testdata(&format!("multibody/{urdf}.urdf"));
    let ended = place.done(&[&["dynamics", &urdf, "--states", "states.json"], flags].concat());
    serde_json::from_str(&ended.stdout).unwrap()
}

fn read(file: &str) -> Value {
    serde_json::from_str(&std::fs::read_to_string(testdata(file)).unwrap()).unwrap()
}

#[test]
fn all_reference_robots_in_all_states() {
    let place = Place::new();
    let (mut total, mut worst) = (0, BTreeMap::new());
    for Reference { file, urdf, flags, states: count } in REFERENCES {
        let reference = read(&format!("multibody/{file}.json"));
        let (joints, states) = input(&reference);
        let frame = reference["model"]["ee"]["frame"].as_str().unwrap();
        let flags = [flags, &["--frame", frame]].concat();
        let output = run(&place, urdf, &json!({ "joints": joints, "states": states }), &flags);
        assert_eq!(output["joints"], json!(joints), "{file}");
        let computed = output["states"].as_array().unwrap();
        assert_eq!((computed.len(), states.len()), (count, count), "{file}");
        for (computed, reference) in computed.iter().zip(reference["states"].as_array().unwrap()) {
            let n = computed["rnea"].as_array().unwrap().len();
            let mut seen = 0;
            let mut compare = |key: &'static str, computed: &Value, reference: &Value, tolerance: f64| {
                let (count, error) = close(&format!("{file} {key}"), computed, reference, tolerance);
                seen += count;
                let known: &mut f64 = worst.entry(key).or_default();
                *known = known.max(error);
            };
            for (key, of_reference, tolerance) in COMPARED {
                if key == "pose" {
                    compare("pose R", &computed["pose"]["R"], &reference["ee_R"], tolerance);
                    compare("pose p", &computed["pose"]["p"], &reference["ee_p"], tolerance);
                } else {
                    compare(key, &computed[key], &reference[of_reference], tolerance);
                }
            }
            let with_christoffel = !reference["christoffel1"].is_null();
            if with_christoffel {
                compare("christoffel", &moved(&computed["christoffel"]), &reference["christoffel1"], 1e-12);
            }
            let symbols = if with_christoffel { n * n * n } else { 0 };
            assert_eq!(seen, 7 * n * n + symbols + 3 * n + 6 * n + 9 + 3 + 1 + 1 + 3, "{file}");
            let keys = computed.as_object().unwrap().len();
            assert_eq!(keys, COMPARED.len() + usize::from(!computed["christoffel"].is_null()), "{file}");
            total += seen;
        }
    }
    for (key, error) in worst {
        println!("{key:12} {error:.1e}");
    }
    assert_eq!(total, 76_488);
}

#[test]
fn the_order_of_the_file_is_the_order_of_the_results() {
    let place = Place::new();
    let reference = read("multibody/anymal_b_ff.json");
    let (joints, states) = input(&reference);
    let flags = ["--floating-base", "--frame", "LF_FOOT"];
    let given = run(&place, "anymal_b", &json!({ "joints": joints, "states": states }), &flags);

    // The blocks reversed: the floating joint, of 7 and 6 numbers, comes last.
    let reversed: Vec<&String> = joints.iter().rev().collect();
    let turned = |numbers: &Value, first: usize| -> Vec<Value> {
        let numbers = numbers.as_array().unwrap();
        numbers[first..].iter().rev().chain(&numbers[..first]).cloned().collect()
    };
    let state = |s: &Value| json!({ "q": turned(&s["q"], 7), "v": turned(&s["v"], 6), "a": turned(&s["a"], 6), "tau": turned(&s["tau"], 6) });
    let states: Vec<Value> = states.iter().map(state).collect();
    let output = run(&place, "anymal_b", &json!({ "joints": reversed, "states": states }), &flags);
    assert_eq!(output["joints"], json!(reversed));
    let of_vector = |vector: &Value| Value::from(turned(vector, 6));
    let columns = |matrix: &Value| matrix.as_array().unwrap().iter().map(of_vector).collect::<Value>();
    for (given, output) in given["states"].as_array().unwrap().iter().zip(output["states"].as_array().unwrap()) {
        for (key, value) in given.as_object().unwrap() {
            let expected = match key.as_str() {
                "kinetic" | "potential" | "com" | "pose" => value.clone(),
                "gravity" | "rnea" | "aba" => of_vector(value),
                "jacobian" => columns(value),
                _ => of_vector(&columns(value)),
            };
            assert_eq!(output[key], expected, "{key}: not the same bits");
        }
    }
}

#[test]
fn christoffel_symbols_come_in_the_order_of_the_file_too() {
    let place = Place::new();
    let state = |q: [f64; 2]| json!({ "q": q, "v": [0, 0], "a": [0, 0], "tau": [0, 0] });
    let of = |joints: [&str; 2], q| {
        let input = json!({ "joints": joints, "states": [state(q)] });
        run(&place, "double_pendulum", &input, &["--christoffel"])["states"][0]["christoffel"].clone()
    };
    let (given, turned) = (of(["joint1", "joint2"], [0.3, 0.8]), of(["joint2", "joint1"], [0.8, 0.3]));
    for (a, b, c) in (0..8).map(|k| (k / 4, k / 2 % 2, k % 2)) {
        assert_eq!(given[a][b][c], turned[1 - a][1 - b][1 - c]);
    }
    assert!(given[0][1][0].as_f64().unwrap() != 0.0, "{given}");
}

#[test]
fn joints_may_be_left_out_and_states_come_from_standard_input() {
    let place = Place::new();
    let input = json!({ "states": [
        { "tau": [0, 0], "a": [0, 0], "v": [0, 0], "q": [0.1, 0.2] },
        { "q": [1, 2e0], "v": [0.5, -0.5], "a": [0, 1], "tau": [1, 1] },
    ]});
    let named = run(&place, "double_pendulum", &input, &[]);
    assert_eq!(named["joints"], json!(["joint1", "joint2"]));

    let urdf = testdata("multibody/double_pendulum.urdf");
    let mut command = place.command(&["dynamics", &urdf, "--states", "-"]);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    child.stdin.take().unwrap().write_all(format!("\u{feff}{input}").as_bytes()).unwrap();
    let piped = Ended::from(child.wait_with_output().unwrap());
    assert_eq!(serde_json::from_str::<Value>(&piped.stdout).unwrap(), named);
    let none = run(&place, "double_pendulum", &json!({ "states": [] }), &[]);
    assert_eq!(none, json!({ "joints": ["joint1", "joint2"], "states": [] }));
}

#[test]
fn what_is_left_out_or_assumed_is_said() {
    let place = Place::new();
    place.write("states.json", r#"{"states": []}"#);
    let said = |arguments: &[&str]| {
        let urdf = testdata(&format!("multibody/{}.urdf", arguments[0]));
        place.done(&[&["dynamics", &urdf, "--states", "states.json"], &arguments[1..]].concat()).stderr
    };
    let panda = said(&["panda"]);
    let losses = "warning: joint damping and friction are no part of the numbers: damping 0.003 N·m·s/rad of \
                  panda_joint1, panda_joint2, panda_joint3, panda_joint4, panda_joint5, panda_joint6, panda_joint7; \
                  damping 0.3 N·s/m of panda_finger_joint1, panda_finger_joint2\n";
    assert!(
        panda.contains(losses) && panda.contains("multibody/panda.urdf: not used: 7 <safety_controller>"),
        "{panda}"
    );
    assert!(said(&["panda", "--ignore-mimic"]).contains("panda_finger_joint2"));
    assert!(!said(&["ur5"]).contains("damping"));
}

#[test]
fn frames_are_links_joints_or_the_world() {
    let place = Place::new();
    let input = json!({ "states": [{ "q": [0, 0.5, -0.3, 0, 0.2, 0.1], "v": [0, 0, 0, 0, 0, 0], "a": [0, 0, 0, 0, 0, 0],
        "tau": [0, 0, 0, 0, 0, 0] }]});
    let of = |frame: &str| run(&place, "ur5", &input, &["--frame", frame])["states"][0].clone();
    // A fixed link, its joint, the world by both of its names.
    let (link, joint) = (of("tool0"), of("wrist_3_link-tool0_fixed_joint"));
    assert_eq!((&link["pose"], &link["jacobian"]), (&joint["pose"], &joint["jacobian"]));
    let world = of("world");
    assert_eq!(
        world["pose"],
        json!({ "R": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], "p": [0.0, 0.0, 0.0] })
    );
    assert!(numbers(&world["jacobian"]).iter().all(|x| *x == 0.0));
    assert_eq!(of("shoulder_pan_joint")["pose"], of("shoulder_link")["pose"]);
    assert_ne!(of("wrist_3_joint")["pose"], link["pose"]);
}

#[test]
fn quaternions_are_normalised_with_a_warning() {
    let place = Place::new();
    let urdf = testdata("multibody/solo12.urdf");
    let state = |length: f64| {
        let mut q = vec![0.1, 0.2, 0.3, 0.0, 0.6 * length, 0.0, -0.8 * length];
        q.extend([0.1; 12]);
        json!({ "q": q, "v": vec![0.2; 18], "a": vec![0.3; 18], "tau": vec![0.4; 18] })
    };
    let of = |states: &[Value]| {
        place.write("states.json", json!({ "states": states }).to_string());
        let ended = place.done(&["dynamics", &urdf, "--states", "states.json", "--floating-base"]);
        (serde_json::from_str::<Value>(&ended.stdout).unwrap(), ended.stderr)
    };
    let (right, said) = of(&[state(1.0), state(1.0 + 5e-7)]);
    assert!(!said.contains("quaternion"), "{said}");
    let (same, said) = of(&[state(1.0), state(2.0), state(1e-200)]);
    let warning = "warning: the quaternion of floating_base in states[1] has the length 2, not 1, and is normalised; so it \
                   is of 1 other\n";
    assert!(said.contains(warning), "{said}");
    for k in [1, 2] {
        close("M", &same["states"][k]["M"], &right["states"][0]["M"], 1e-13);
        close("aba_dq", &same["states"][k]["aba_dq"], &right["states"][0]["aba_dq"], 1e-12);
    }
}

/// The robot of a scenario: `[robot]` is enough, and what is wrong in the rest does not matter.
#[test]
fn scenarios_and_robots_alone_are_taken() {
    let place = Place::new();
    let state = json!({ "states": [{ "q": [0.3, 0.1], "v": [1, 2], "a": [0, 0], "tau": [0, 0] }] });
    place.write("states.json", state.to_string());
    let of = |file: &str, more: &[&str]| {
        let ended = place.done(&[&["dynamics", file, "--states", "states.json"], more].concat());
        serde_json::from_str::<Value>(&ended.stdout).unwrap()
    };
    let whole = of("arm.toml", &["--frame", "slide"]);
    assert_eq!(whole["joints"], json!(["q1", "x"]));
    let text = place.read("arm.toml");
    place.write("robot.toml", &text[..text.find("[[element]]").unwrap()]);
    assert_eq!(of("robot.toml", &["--frame", "x"]), whole);
    place.write("spoilt.toml", text.replace("kind = \"prescribed\"", "kind = \"no such thing\""));
    assert_eq!(of("spoilt.toml", &["--frame", "slide"]), whole);
    // M of the sliding joint is its mass.
    assert_eq!(of("robot.toml", &["--set", "robot.body.slide.mass=3"])["states"][0]["M"][1][1], json!(3.0));
    place.write("arm.urdf", std::fs::read(testdata("multibody/double_pendulum.urdf")).unwrap());
    place.write("urdf.toml", "[robot]\nurdf = \"arm.urdf\"\ngravity = [0, 0, 0]\n");
    let weightless = of("urdf.toml", &["--frame", "link2"]);
    assert_eq!(weightless["states"][0]["gravity"], json!([0.0, 0.0]));
}

#[test]
fn numbers_that_are_not_finite_are_null_and_named() {
    let place = Place::new();
    let urdf = testdata("multibody/double_pendulum.urdf");
    let state = |v: f64| json!({ "q": [0.1, 0.2], "v": [v, 1], "a": [0, 0], "tau": [0, 0] });
    let states: Vec<Value> = [1.0, 1e200, 1.0, 1e200].into_iter().map(state).collect();
    place.write("states.json", json!({ "states": states }).to_string());
    let ended = place.springpot(&["dynamics", &urdf, "--states", "states.json"]);
    assert_eq!(ended.code, Some(1));
    let output: Value = serde_json::from_str(&ended.stdout).unwrap();
    assert!(output["states"][1]["rnea"].is_null() && output["states"][1]["kinetic"].is_null());
    assert!(output["states"][2]["rnea"].is_array() && output["states"][1]["M"] == output["states"][2]["M"]);
    for k in [1, 3] {
        assert!(ended.stderr.contains(&format!("error: states[{k}]: rnea, aba, ")), "{}", ended.stderr);
    }
    assert!(!ended.stderr.contains("states[0]") && !ended.stderr.contains("states[2]"), "{}", ended.stderr);
}

#[test]
fn a_closed_pipe_is_no_error_and_a_full_disk_is() {
    let place = Place::new();
    let urdf = testdata("multibody/simple_humanoid.urdf");
    let state = json!({ "q": vec![0.1; 29], "v": vec![0.2; 29], "a": vec![0.3; 29], "tau": vec![0.4; 29] });
    place.write("states.json", json!({ "states": vec![state; 20] }).to_string());
    let arguments = ["dynamics", &urdf, "--states", "states.json"];
    let mut child = place.command(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let ended = Ended::from(child.wait_with_output().unwrap());
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    if !std::path::Path::new("/dev/full").exists() {
        return;
    }
    for arguments in
        [&arguments[..], &["info", &urdf], &["info", &urdf, "--json"], &["dynamics", "arm.toml", "--at", "0.1"]]
    {
        let full = std::fs::File::options().write(true).open("/dev/full").unwrap();
        let ended = Ended::from(place.command(arguments).stdout(full).output().unwrap());
        assert_eq!(ended.code, Some(1), "{arguments:?}");
        assert!(ended.stderr.contains("error: the results cannot be written: "), "{}", ended.stderr);
    }
}
