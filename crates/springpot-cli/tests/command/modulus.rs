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
