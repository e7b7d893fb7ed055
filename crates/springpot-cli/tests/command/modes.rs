//! `springpot modes`: eigenvalues about rest, and answers to sines.

use crate::support::{ARM, Csv, Place};
use serde_json::Value;
use std::f64::consts::TAU;

/// The arm in free fall onto its damper.
fn falling() -> Place {
    forward("start = { q = { q1 = \"0.1\" } }")
}

fn forward(motion: &str) -> Place {
    let at = ARM.find("[motion]").unwrap();
    Place::with(&format!(
        "{}[motion]\nkind = \"forward\"\n{motion}\n\n[time]\nend = 0.35\noutput_step = 0.05\n",
        &ARM[..at]
    ))
}

/// One mass on a spring and a dashpot, pushed.
fn mass(law: &str, motion: &str) -> Place {
    Place::with(&format!(
        "[robot]\ngravity = [0, 0, -10]\n[[robot.body]]\nname = \"b\"\nmass = 2\n\
         joint = {{ name = \"z\", kind = \"prismatic\", axis = [0, 0, 1], origin = [0, 0, 0] }}\n\
         [[element]]\nname = \"e\"\njoint = \"z\"\n{law}\n[motion]\nkind = \"forward\"\n{motion}\n[time]\nend = 1\noutput_step = 0.5\n"
    ))
}

const KELVIN_VOIGT: &str = "law = \"kelvin-voigt\"\nparameters = { k = 50, c = 4 }";

#[test]
fn eigenvalues_are_printed_written_and_drawn() {
    let place = mass(KELVIN_VOIGT, "");
    let done = place.done(&["modes", "arm.toml", "--equilibrium"]);
    for words in ["about   the equilibrium", "z = -0.4", "-1 ± 4.899i", "0.79577", "0.2 "] {
        assert!(done.stdout.contains(words), "{words}: {}", done.stdout);
    }
    assert!(done.stderr.is_empty() && done.stdout.lines().all(|line| line.chars().count() <= 80), "{}", done.stdout);
    place.done(&["modes", "arm.toml", "--equilibrium", "--out", "m.csv"]);
    let rows = Csv::new(&place.read("m.csv"));
    assert_eq!((rows.numbers("re [1/s]")[0], rows.numbers("damping_ratio")[0]), (-1.0, 0.2));
    assert!((rows.numbers("im [1/s]")[0] - 24.0f64.sqrt()).abs() < 1e-14);
    let json: Value =
        serde_json::from_str(&place.done(&["modes", "arm.toml", "--equilibrium", "--json"]).stdout).unwrap();
    assert!((json["q"][0].as_f64().unwrap() + 0.4).abs() < 1e-15, "{json}");
    assert_eq!((&json["modes"][0]["re"], &json["complete"]), (&Value::from(-1.0), &Value::from(true)));
    for ending in ["svg", "png", "pdf", "json"] {
        place.done(&["modes", "arm.toml", "--equilibrium", "--out", &format!("m.{ending}")]);
        assert!(std::fs::metadata(place.path(format!("m.{ending}"))).unwrap().len() > 400, "{ending}");
    }
}

#[test]
fn where_it_is_linearised_is_told() {
    let place = falling();
    let start = place.done(&["modes", "arm.toml"]);
    assert!(start.stdout.contains("about   the start, at rest"), "{}", start.stdout);
    assert!(start.stderr.contains("missing on q1") && start.stderr.contains("--equilibrium"), "{}", start.stderr);
    let later = place.done(&["modes", "arm.toml", "--at", "100 ms", "--set", "element.damper.alpha=0.3"]);
    assert!(later.stdout.contains("about   t = 0.1 s, at rest"), "{}", later.stdout);
    // Kinematics that are given are held by the actuators.
    let given = Place::new().done(&["modes", "arm.toml", "--at", "0.1"]);
    assert!(given.stdout.contains("held by constant actuator forces") && given.stderr.is_empty(), "{}", given.stdout);
    let unstable = mass("network = \"polynomial(k1, k2, k3)\"\nparameters = { k1 = -32, k2 = 0, k3 = 1 }", "");
    let told = unstable.done(&["modes", "arm.toml"]).stdout;
    assert!(told.contains("is unstable: it grows to e times itself in 0.25 s"), "{told}");
    let free = mass("law = \"dashpot\"\nparameters = { c = 4 }", "");
    assert!(free.done(&["modes", "arm.toml"]).stdout.contains("1 motion that no stiffness holds"));
}

#[test]
fn columns_answer_to_sines() {
    let place = mass(KELVIN_VOIGT, "");
    let ask = ["modes", "arm.toml", "--equilibrium", "--frequency-response", "tau.z", "q.z"];
    let with = |more: &[&str]| place.done(&[&ask[..], more].concat());
    with(&["--from", "0.1", "--to", "10 Hz", "--points", "41", "--out", "r.csv"]);
    let text = place.read("r.csv");
    assert!(
        text.starts_with("frequency [Hz],gain [m per N],phase [deg],real [m per N],imaginary [m per N]\n"),
        "{text}"
    );
    let rows = Csv::new(&text);
    let [f, gain, phase] = ["frequency [Hz]", "gain [m per N]", "phase [deg]"].map(|name| rows.numbers(name));
    assert_eq!((f.len(), f[0]), (41, 0.1));
    for ((f, gain), phase) in f.iter().zip(gain).zip(phase) {
        let omega = TAU * f;
        let (re, im) = (50.0 - 2.0 * omega * omega, 4.0 * omega);
        assert!((gain * re.hypot(im) - 1.0).abs() < 1e-12 && (phase + im.atan2(re).to_degrees()).abs() < 1e-9);
    }
    let page = with(&[]).stdout;
    assert!(page.contains("q.z under a sine of tau.z") && page.contains("13 of 301 frequencies"), "{page}");
    assert!(page.lines().all(|line| line.chars().count() <= 80), "{page}");
    let json: Value = serde_json::from_str(&with(&["--json", "--points", "3"]).stdout).unwrap();
    assert_eq!((json["unit"].as_str(), json["gain"].as_array().unwrap().len()), (Some("m per N"), 3));
    for ending in ["svg", "png", "pdf"] {
        with(&["--out", &format!("r.{ending}")]);
        assert!(std::fs::metadata(place.path(format!("r.{ending}"))).unwrap().len() > 2_000, "{ending}");
    }
    // A joint that is shaken, and a voltage.
    let shaken = forward("prescribed = { q1 = \"0.1*sin(t)\" }");
    for (input, column) in
        [("q.q1", "q.x"), ("q.q1", "tau.q1"), ("damper.u", "gripper.x"), ("tau.x", "damper.springpot1.force")]
    {
        shaken.done(&["modes", "arm.toml", "--frequency-response", input, column]);
    }
}

#[test]
fn what_it_cannot_do_is_refused() {
    let place = falling();
    let flowing = mass("law = \"maxwell\"\nparameters = { k = 50, c = 4 }", "");
    let locked = mass(KELVIN_VOIGT, "locked = [\"z\"]");
    let prescribed = Place::new();
    let response = "--frequency-response";
    for (place, arguments, words) in [
        (&place, &["--at", "2"][..], &["--at 2: t = 2 s is outside the motion"][..]),
        (&place, &["--at", "1 m"], &["--at 1 m", "\"500 ms\""]),
        (&place, &[response, "tau.q9", "q.x"], &["there is no such input", "did you mean `tau.q1`?"]),
        (&place, &[response, "q.q1", "q.x"], &["no signal of `prescribed` moves this joint"]),
        (&place, &[response, "tau.q1", "damper.forc"], &["no column \"damper.forc\"", "did you mean `damper.force`?"]),
        (&place, &[response, "tau.q1", "energy.kinetic"], &["energies are not linear in small motions"]),
        (&place, &[response, "tau.q1", "damper.stored"], &["energies are not linear"]),
        (&place, &[response, "tau.q1", "q.x", "--from", "0"], &["--from 0: not a frequency above 0"]),
        (&place, &[response, "tau.q1", "q.x", "--points", "1"], &["--points 1: out of range"]),
        (&place, &["--from", "1"], &["--frequency-response"]),
        (&place, &["--out", "m.txt"], &["--out m.txt: no kind of file", ".csv"]),
        (&flowing, &["--equilibrium"], &["nothing holds z", "20 N are left over", "locked"]),
        (&locked, &[], &["no joint is free to move", "free a joint"]),
        (&locked, &[response, "tau.z", "q.z"], &["forces do not move this joint"]),
        (&prescribed, &["--equilibrium"], &["the motion is given in advance", "kind = \"forward\""]),
    ] {
        let all: Vec<&str> = ["modes", "arm.toml"].into_iter().chain(arguments.iter().copied()).collect();
        let refused = place.springpot(&all);
        let said = refused.said();
        assert_eq!(refused.code, Some(2), "{arguments:?}: {}", refused.stderr);
        words.iter().for_each(|words| assert!(said.contains(words), "{arguments:?}: {words:?}: {}", refused.stderr));
    }
}

const CONTROLLER: &str =
    "[motion.controller]\nkind = \"pid\"\nkp = 20\nki = 30\nkd = 4\nreference = { kind = \"joints\", z = 0.1 }";

#[test]
fn closed_loops_are_in_and_left_out_when_asked() {
    let place = mass(KELVIN_VOIGT, CONTROLLER);
    let eigenvalues = |more: &[&str]| {
        let done = place.done(&[&["modes", "arm.toml", "--json"], more].concat());
        let json: Value = serde_json::from_str(&done.stdout).unwrap();
        let modes = json["modes"].as_array().unwrap().clone();
        (
            modes.iter().map(|mode| [mode["re"].as_f64().unwrap(), mode["im"].as_f64().unwrap()]).collect::<Vec<_>>(),
            done.stderr,
        )
    };
    // 2 s³ + 8 s² + 70 s + 30 = 0.
    let (closed, said) = eigenvalues(&[]);
    assert!(closed.len() == 2 && said.is_empty(), "{closed:?} {said}");
    let s = closed[0][0];
    assert!((2.0 * s.powi(3) + 8.0 * s * s + 70.0 * s + 30.0).abs() < 1e-12, "{s}");
    let (open, _) = eigenvalues(&["--open"]);
    assert!(
        open.len() == 1 && (open[0][0] + 1.0).abs() < 1e-14 && (open[0][1] - 24.0f64.sqrt()).abs() < 1e-13,
        "{open:?}"
    );
    let rest = place.done(&["modes", "arm.toml", "--equilibrium"]).stdout;
    assert!(rest.contains("z = 0.1"), "{rest}");
    let sampled = mass(KELVIN_VOIGT, &format!("{CONTROLLER}\nsample = \"10 ms\""));
    let told = sampled.done(&["modes", "arm.toml"]).stderr;
    assert!(told.contains("is left out: these are the modes of the robot alone"), "{told}");
    let reference =
        place.done(&["modes", "arm.toml", "--frequency-response", "reference.z", "q.z", "--points", "2", "--json"]);
    let json: Value = serde_json::from_str(&reference.stdout).unwrap();
    assert_eq!(json["unit"], "m per m");
}

#[test]
fn sweeps_give_every_case() {
    let place = mass(KELVIN_VOIGT, CONTROLLER);
    let sweep = ["modes", "arm.toml", "--sweep", "motion.controller.kp=10,40"];
    let with = |more: &[&str]| place.done(&[&sweep[..], more].concat());
    with(&["--out", "m.csv"]);
    let text = place.read("m.csv");
    assert!(text.starts_with("motion.controller.kp"), "{text}");
    let rows = Csv::new(&text);
    assert_eq!(rows.numbers("mode"), [1.0, 2.0, 1.0, 2.0]);
    let json: Value = serde_json::from_str(&with(&["--json"]).stdout).unwrap();
    assert_eq!(json["cases"][1]["set"]["motion.controller.kp"], 40.0);
    assert_eq!(json["cases"][1]["modes"].as_array().unwrap().len(), 2);
    with(&["--out", "m.svg"]);
    assert!(place.read("m.svg").contains("Root locus"));
    assert!(with(&[]).stdout.contains("mode"));
}

#[test]
fn margins_are_told_and_drawn() {
    let place = mass(
        "law = \"spring\"\nparameters = { k = 1e-9 }",
        "[motion.controller]\nkind = \"pid\"\nkp = 50\nki = 0\nkd = 8\nreference = { kind = \"joints\", z = 0 }",
    );
    let json: Value =
        serde_json::from_str(&place.done(&["modes", "arm.toml", "--margins", "z", "--json"]).stdout).unwrap();
    let margins = &json["margins"];
    let omega = ((64.0 + (4096.0f64 + 4.0 * 4.0 * 2500.0).sqrt()) / 8.0).sqrt();
    assert!((margins["phase_margin_frequency"].as_f64().unwrap() * TAU / omega - 1.0).abs() < 1e-8, "{json}");
    assert!(
        (margins["phase_margin"].as_f64().unwrap() - (8.0 * omega).atan2(50.0).to_degrees()).abs() < 1e-7,
        "{json}"
    );
    assert!(margins["gain_margin"].is_null() && json["unstable"] == false, "{json}");
    place.done(&["modes", "arm.toml", "--margins", "z", "--decibel", "--out", "l.svg"]);
    assert!(place.read("l.svg").contains("phase margin") && place.read("l-nyquist.svg").contains("Im L"));
    let page = place.done(&["modes", "arm.toml", "--margins", "z"]).stdout;
    assert!(
        page.contains("phase") && page.contains("deg at") && page.lines().all(|line| line.chars().count() <= 80),
        "{page}"
    );
    let refused = place.springpot(&["modes", "arm.toml", "--margins", "y"]);
    assert!(refused.code == Some(2) && refused.said().contains("there is no such joint"), "{}", refused.stderr);
}
