//! `springpot modulus`: an element under steady sines.

use crate::support::{ARM, Csv, Place};

/// Another law in the arm's damper.
fn with(law: &str) -> Place {
    let from = ARM.find("law = ").unwrap();
    let to = ARM[from..].find("[motion]").unwrap() + from;
    Place::with(&format!("{}{law}\n{}", &ARM[..from], &ARM[to..]))
}

#[test]
fn the_modulus_is_that_of_the_law() {
    let place = with("law = \"fractional-zener\"\nparameters = { k_e = 100, k_m = 300, c = 80, alpha = 0.4 }");
    place.done(&["modulus", "arm.toml", "damper", "--from", "0.1", "--to", "1 kHz", "--points", "5", "--out", "m.csv"]);
    let text = place.read("m.csv");
    assert!(text.starts_with("frequency [Hz],storage [N/m],loss [N/m],tan_delta,cycle [J]\n"), "{text}");
    let rows = Csv::new(&text);
    let [hertz, storage, loss] = ["frequency [Hz]", "storage [N/m]", "loss [N/m]"].map(|name| rows.numbers(name));
    for ((f, storage), loss) in hertz.iter().zip(storage).zip(loss) {
        // c (iω)^α in series with k_m, beside k_e.
        let (size, angle) = (80.0 * (std::f64::consts::TAU * f).powf(0.4), 0.2 * std::f64::consts::PI);
        let (re, im) = (size * angle.cos(), size * angle.sin());
        let whole = (300.0 + re).powi(2) + im * im;
        let series = [300.0 * (re * (300.0 + re) + im * im) / whole, 300.0 * 300.0 * im / whole];
        assert!((storage - 100.0 - series[0]).abs() < 1e-9 * storage && (loss - series[1]).abs() < 1e-9 * loss);
    }
    assert_eq!((rows.numbers("frequency [Hz]")[0], hertz.len()), (0.1, 5));
    let cycle = rows.numbers("cycle [J]")[2];
    assert!((cycle - std::f64::consts::PI * rows.numbers("loss [N/m]")[2] * 1e-6).abs() < 1e-12 * cycle);
}

#[test]
fn it_is_printed_drawn_and_written() {
    let place = with("law = \"maxwell\"\nparameters = { k = 300, c = 80 }");
    let printed = place.done(&["modulus", "arm.toml", "damper", "--amplitude", "2 mm"]).stdout;
    for words in ["element damper under x = 0.002 m sin(2 pi f t)", "K', N/m", "tan delta", "13 of 121 frequencies"] {
        assert!(printed.contains(words), "{words}: {printed}");
    }
    assert!(printed.lines().all(|line| line.chars().count() <= 80), "{printed}");
    let json: serde_json::Value =
        serde_json::from_str(&place.done(&["modulus", "arm.toml", "damper", "--json", "--points", "3"]).stdout)
            .unwrap();
    assert_eq!((json["element"].as_str(), json["storage"].as_array().unwrap().len()), (Some("damper"), 3));
    for ending in ["svg", "png", "pdf"] {
        place.done(&["modulus", "arm.toml", "damper", "--out", &format!("m.{ending}")]);
        assert!(std::fs::metadata(place.path(format!("m.{ending}"))).unwrap().len() > 2_000, "{ending}");
    }
}

const RUBBER: &str = "law = \"filled-rubber\"\n\
    parameters = { k = 3e4, c = 900, alpha = 0.3, k_f = [4e4, 2e4], F_f = [6, 15] }";

/// K' and K'' of that at ω, 1/s, and A, m: Caughey's formula for what slips.
fn rubber(omega: f64, amplitude: f64) -> [f64; 2] {
    let (size, angle) = (900.0 * omega.powf(0.3), 0.15 * std::f64::consts::PI);
    let mut exact = [3e4 + size * angle.cos(), size * angle.sin()];
    for [k, yields] in [[4e4, 6.0], [2e4, 15.0]] {
        let share = (yields / k / amplitude).min(1.0);
        let back = (1.0f64 - 2.0 * share).acos();
        exact[0] += k / std::f64::consts::PI * (back - back.sin() * back.cos());
        exact[1] += 4.0 * k * share / std::f64::consts::PI * (1.0 - share);
    }
    exact
}

#[test]
fn over_the_amplitude_it_is_the_first_harmonic() {
    let place = with(RUBBER);
    let amplitudes = ["--amplitude", "0.1mm, 1 mm,5e-3"];
    let asked = |more: &[&str]| {
        let all = ["modulus", "arm.toml", "damper", "--from", "0.1", "--to", "1 kHz", "--points", "5"];
        place.done(&[&all[..], &amplitudes, more].concat()).stdout
    };
    asked(&["--out", "m.csv"]);
    let text = place.read("m.csv");
    let head = "frequency [Hz],amplitude [m],storage [N/m],loss [N/m],tan_delta,cycle [J]\n";
    assert!(text.starts_with(head), "{text}");
    let rows = Csv::new(&text);
    let column = |name: &str| rows.numbers(name);
    let [hertz, amplitude, storage, loss, cycle] =
        ["frequency [Hz]", "amplitude [m]", "storage [N/m]", "loss [N/m]", "cycle [J]"].map(column);
    assert_eq!(amplitude, [[1e-4; 5], [1e-3; 5], [5e-3; 5]].concat());
    for k in 0..15 {
        assert_eq!(hertz[k], hertz[k % 5]);
        let [re, im] = rubber(std::f64::consts::TAU * hertz[k], amplitude[k]);
        assert!((storage[k] - re).abs() < 1e-10 * re && (loss[k] - im).abs() < 1e-10 * re, "row {k}");
        assert!(
            (cycle[k] - std::f64::consts::PI * im * amplitude[k].powi(2)).abs() < 1e-10 * re * amplitude[k].powi(2)
        );
    }
    let json: serde_json::Value = serde_json::from_str(&asked(&["--json"])).unwrap();
    for name in ["frequency", "amplitude", "storage", "loss", "tan_delta", "cycle"] {
        assert_eq!(json[name].as_array().unwrap().len(), 15, "{name}");
    }
    assert_eq!((json["unit"].as_str(), json["amplitude"][5].as_f64()), (Some("N/m"), Some(1e-3)));
    let printed = asked(&[]);
    assert!(printed.contains("X, m") && printed.contains("first harmonic: K*"), "{printed}");
    assert!(printed.lines().all(|line| line.chars().count() <= 80), "{printed}");
    for ending in ["svg", "png"] {
        asked(&["--out", &format!("m.{ending}")]);
    }
    assert!(place.read("m.svg").contains("0.1mm"));
    // One frequency, and one amplitude of a law that is not linear.
    let one = ["modulus", "arm.toml", "damper", "--from", "10", "--to", "10 Hz", "--amplitude", "1mm,2mm", "--out"];
    place.done(&[&one[..], &["p.csv"]].concat());
    place.done(&[&one[..], &["p.svg"]].concat());
    assert_eq!(place.read("p.csv").lines().count(), 3);
    assert!(place.read("p.svg").contains("at 10 Hz") && place.read("p.svg").contains("amplitude, m"));
    let single = place.done(&["modulus", "arm.toml", "damper", "--json", "--points", "3", "--amplitude", "1mm"]).stdout;
    let json: serde_json::Value = serde_json::from_str(&single).unwrap();
    assert_eq!(json["amplitude"].as_array().unwrap().len(), 3);
    // Of a linear law it does not matter, but rows say it where there are several.
    let linear = with("law = \"maxwell\"\nparameters = { k = 300, c = 80 }");
    let all = ["modulus", "arm.toml", "damper", "--points", "2", "--amplitude", "1 mm,2 mm", "--out", "m.csv"];
    linear.done(&all);
    let text = linear.read("m.csv");
    let rows = Csv::new(&text);
    let [storage, cycle] = ["storage [N/m]", "cycle [J]"].map(|name| rows.numbers(name));
    assert_eq!(storage[..2], storage[2..]);
    assert!((cycle[2] - 4.0 * cycle[0]).abs() < 1e-12 * cycle[2]);
}

#[test]
fn what_has_a_state_is_driven() {
    let place =
        with("network = \"series(polynomial(k, z, c), dashpot(d))\"\nparameters = { k = 100, z = 0, c = 2e4, d = 12 }");
    let all =
        ["modulus", "arm.toml", "damper", "--from", "1", "--to", "4", "--points", "3", "--amplitude", "0.1", "--json"];
    let json: serde_json::Value = serde_json::from_str(&place.done(&all).stdout).unwrap();
    let storage = json["storage"].as_array().unwrap();
    assert!(storage.iter().all(|k| k.as_f64().unwrap() > 10.0), "{storage:?}");
}

#[test]
fn what_is_not_linear_needs_an_amplitude() {
    let place = with(RUBBER);
    for (arguments, words) in [
        (&[][..], &["is not linear: its modulus depends on the amplitude", "--amplitude '1 mm'"][..]),
        (&["--amplitude", "0"], &["--amplitude 0: not a stroke above 0"]),
        (&["--amplitude", "1mm,-2mm"], &["--amplitude -2mm: not a stroke above 0"]),
        (&["--amplitude", "1mm,"], &["--amplitude : not a stroke above 0"]),
        (&["--amplitude", "1 deg"], &["--amplitude 1 deg: not a stroke above 0", "write '1 mm'"]),
        (&["--amplitude", "1mm", "--set", "element.damper.F_f=[6, 0]"], &["`F_f`", "0"]),
        (&["--amplitude", "1mm", "--set", "element.damper.k_f=[1]"], &["`F_f`", "has 2 values, but `k_f` has 1"]),
        (&["--amplitude", "1mm", "--set", "element.damper.k_f=[-1, 2]"], &["`k_f`", "-1"]),
        (&["--amplitude", "1mm", "--set", "element.damper.k_f=[]"], &["`k_f`", "must be an array of values"]),
        (&["--amplitude", "1mm", "--set", "element.damper.F_f=[\"6 kg\", 1]"], &["`F_f`", "6 kg"]),
    ] {
        let all: Vec<&str> = ["modulus", "arm.toml", "damper"].into_iter().chain(arguments.iter().copied()).collect();
        let refused = place.springpot(&all);
        let said = refused.said();
        assert_eq!(refused.code, Some(2), "{arguments:?}: {}", refused.stderr);
        words.iter().for_each(|words| assert!(said.contains(words), "{arguments:?}: {words:?}: {}", refused.stderr));
    }
}

#[test]
fn what_it_cannot_do_is_refused() {
    let place = with("law = \"maxwell\"\nparameters = { k = 300, c = 80 }");
    for (arguments, words) in [
        (&["dampr"][..], &["there is no element \"dampr\"", "did you mean `damper`?"][..]),
        (&["damper", "--from", "0"], &["--from 0: not a frequency above 0"]),
        (&["damper", "--from", "1 m"], &["--from 1 m", "write 10, '10 Hz' or '60 rad/s'"]),
        (&["damper", "--from", "10", "--to", "1"], &["--from 10 is not below --to 1"]),
        (&["damper", "--points", "1"], &["--points 1: out of range"]),
        (&["damper", "--amplitude", "1 kg"], &["--amplitude 1 kg: not a stroke above 0"]),
        (&["damper", "--out", "m.txt"], &["--out m.txt: no kind of file", ".csv"]),
        (&["damper", "--set", "element.damper.k=-1"], &["`k`", "is -1"]),
    ] {
        let all: Vec<&str> = ["modulus", "arm.toml"].into_iter().chain(arguments.iter().copied()).collect();
        let refused = place.springpot(&all);
        let said = refused.said();
        assert_eq!(refused.code, Some(2), "{arguments:?}: {}", refused.stderr);
        words.iter().for_each(|words| assert!(said.contains(words), "{arguments:?}: {words:?}: {}", refused.stderr));
    }
}
