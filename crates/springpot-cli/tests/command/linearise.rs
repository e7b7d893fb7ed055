//! `springpot linearise`: matrices as files.

use crate::support::Place;
use serde_json::Value;

fn mass(motion: &str) -> Place {
    Place::with(&format!(
        "[robot]\ngravity = [0, 0, 0]\n[[robot.body]]\nname = \"b\"\nmass = 2\n\
         joint = {{ name = \"z\", kind = \"prismatic\", axis = [0, 0, 1], origin = [0, 0, 0] }}\n\
         [[element]]\nname = \"e\"\njoint = \"z\"\nlaw = \"fractional-kelvin-voigt\"\nparameters = {{ k = 50, c = 4, alpha = 0.5 }}\n\
         [motion]\nkind = \"forward\"\n{motion}\n[time]\nend = 1\noutput_step = 0.5\n"
    ))
}

const CONTROLLER: &str =
    "[motion.controller]\nkind = \"pid\"\nkp = 20\nki = 30\nkd = 4\nreference = { kind = \"joints\", z = 0 }";

#[test]
fn matrices_are_written_with_names_and_units() {
    let place = mass(CONTROLLER);
    let ask = ["linearise", "arm.toml", "--input", "tau.z,reference.z", "--output", "q.z", "--band", "0.1 Hz,20 Hz"];
    let done = place.done(&[&ask[..], &["--tolerance", "1e-3", "--out", "m.json"]].concat());
    assert!(done.stdout.contains("of memories") && done.stdout.contains("every channel within"), "{}", done.stdout);
    let json: Value = serde_json::from_str(&place.read("m.json")).unwrap();
    let length = |key: &str| json[key].as_array().unwrap().len();
    let n = length("states");
    assert_eq!([length("A"), length("B"), length("C"), length("D")], [n, n, 1, 1]);
    assert_eq!((&json["inputs"][1], &json["states"][0]), (&Value::from("reference.z"), &Value::from("q.z")));
    assert!(json["states"].as_array().unwrap().contains(&Value::from("e.memory1")), "{json}");
    assert!(json["states"].as_array().unwrap().contains(&Value::from("controller.z.integral1")), "{json}");
    assert_eq!((&json["units"]["tau.z"], &json["units"]["v.z"]), (&Value::from("N"), &Value::from("m/s")));
    assert!(json["error"].as_f64().unwrap() <= 1e-3 && json["about"]["t"] == 0.0 && json["band"][1] == 20.0, "{json}");
    place.done(&[&ask[..], &["--out", "m.npz"]].concat());
    let bytes = std::fs::read(place.path("m.npz")).unwrap();
    assert!(bytes.starts_with(b"PK") && bytes.windows(6).any(|name| name == b"A.npy\x01"));
    let open = place.done(&[
        "linearise",
        "arm.toml",
        "--open",
        "--input",
        "tau.z",
        "--output",
        "q.z,e.force",
        "--out",
        "o.json",
    ]);
    assert!(!open.stdout.is_empty());
}

#[test]
fn what_it_cannot_do_is_refused_and_nothing_is_written() {
    let (place, sampled) = (mass(CONTROLLER), mass(&format!("{CONTROLLER}\nsample = \"10 ms\"")));
    let base = ["linearise", "arm.toml", "--out", "m.json"];
    for (place, arguments, code, words) in [
        (
            &place,
            &["--input", "tau.y", "--output", "q.z"][..],
            2,
            &["there is no such input", "did you mean `tau.z`?"][..],
        ),
        (&place, &["--input", "tau.z", "--output", "q.y"], 2, &["there is no column \"q.y\""]),
        (&place, &["--input", "tau.z", "--output", "energy.kinetic"], 2, &["energies are not linear"]),
        (&place, &["--input", "tau.z", "--output", "q.z", "--band", "10 Hz,1 Hz"], 2, &["is not below", "swap them"]),
        (&place, &["--input", "tau.z", "--output", "q.z", "--band", "10 Hz"], 2, &["not two frequencies"]),
        (&place, &["--input", "tau.z", "--output", "q.z", "--tolerance", "-1"], 2, &["a tolerance is"]),
        (&place, &["--input", "reference.z", "--output", "tau.z"], 2, &["answers to how fast reference.z changes"]),
        (&sampled, &["--input", "tau.z", "--output", "q.z"], 2, &["`sample`", "--open"]),
        (
            &place,
            &["--input", "tau.z", "--output", "q.z", "--tolerance", "1e-11", "--band", "1e-9 Hz,1e9 Hz"],
            1,
            &["is reached, not 1.0e-11"],
        ),
    ] {
        let all: Vec<&str> = base.iter().chain(arguments).copied().collect();
        let refused = place.springpot(&all);
        assert_eq!(refused.code, Some(code), "{arguments:?}: {}", refused.stderr);
        words
            .iter()
            .for_each(|words| assert!(refused.said().contains(words), "{arguments:?}: {words:?}: {}", refused.stderr));
        assert!(!place.path("m.json").exists(), "{arguments:?}");
    }
    sampled.done(&[&base[..], &["--open", "--input", "tau.z", "--output", "q.z"]].concat());
}
