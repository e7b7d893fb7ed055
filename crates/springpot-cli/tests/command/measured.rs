//! `springpot laws --from`: moduli, angles and whole measurements.

use crate::support::Place;
use serde_json::Value;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Storage and loss of k = 2000 N/m, c = 800 N·s^alpha/m, alpha = 0.35.
fn mount(omega: f64) -> [f64; 2] {
    let (sin, cos) = (0.35 * FRAC_PI_2).sin_cos();
    let size = 800.0 * omega.powf(0.35);
    [2000.0 + size * cos, size * sin]
}

/// Frequencies in Hz, evenly on a logarithmic axis.
fn hertz(count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |k| 10.0_f64.powf(-1.0 + 3.0 * k as f64 / (count - 1) as f64))
}

/// A file of this header and what `row` makes of a frequency in Hz, storage and loss.
fn file(header: &str, count: usize, row: impl Fn(f64, f64, f64) -> String) -> String {
    let rows = hertz(count).map(|f| {
        let [storage, loss] = mount(TAU * f);
        row(f, storage, loss)
    });
    [header.to_owned()].into_iter().chain(rows).collect::<Vec<_>>().join("\n")
}

fn json(place: &Place, arguments: &[&str]) -> Value {
    serde_json::from_str(&place.done(&[&["laws", "--json", "--from"], arguments].concat()).stdout).unwrap()
}

fn parameter(answer: &Value, name: &str) -> f64 {
    answer["parameters"][name].as_f64().unwrap_or_else(|| panic!("{answer}"))
}

fn refused(place: &Place, arguments: &[&str], words: &[&str]) {
    let ended = place.springpot(&[&["laws"], arguments].concat());
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{arguments:?}");
    let told = ended.said();
    assert!(words.iter().all(|word| told.contains(word)), "{arguments:?}: {}", ended.stderr);
}

#[test]
fn an_angle_is_read_as_the_angle() {
    let place = Place::new();
    let tan = 30.0_f64.to_radians().tan();
    let number = json(&place, &[&format!("tan_delta = {tan} at 10 Hz, stiffness = 5 kN/m")]);
    for written in ["tan_delta = 30 deg", "loss_factor = 0.5235987755982988 rad", "tan δ = 523.5987755982988 mrad"] {
        let data = format!("{written} at 10 Hz, stiffness = 5 kN/m");
        let angle = json(&place, &[&data]);
        assert!((parameter(&angle, "alpha") / parameter(&number, "alpha") - 1.0).abs() < 1e-14, "{angle}");
        assert!((angle["check"][0]["wanted"].as_f64().unwrap() - tan).abs() < 1e-15, "{angle}");
        let page = place.done(&["laws", "--from", &data]).stdout;
        assert!(page.contains("(angle: tan δ = 0.57735) wanted"), "{page}");
    }
    // A share is a number.
    let share = json(&place, &["tan_delta = 30 % at 10 Hz, stiffness = 5 kN/m"]);
    assert_eq!(share["check"][0]["wanted"], 0.3);
    for angle in ["90 deg", "120 deg", "2 rad"] {
        let data = format!("tan_delta = {angle} at 10 Hz, stiffness = 5 kN/m");
        refused(&place, &["--from", &data], &["--from:1:13", "is no loss angle", "between 0 and 90 deg"]);
    }
}

#[test]
fn moduli_are_stiffnesses_of_the_sample() {
    let place = Place::new();
    // A/L = 4 cm²/10 mm = 0.04 m.
    let wanted = json(&place, &["storage = 80 kN/m at 10 Hz, loss = 8 kN/m at 10 Hz"]);
    for data in [
        "E' = 2 MPa at 10 Hz, E'' = 0.2 MPa at 10 Hz, area = 4 cm^2, length = 10 mm",
        "length = 10 mm; G′ = 2 MPa at 10 Hz; G″ = 200 kPa; area = 4e-4",
        "storage modulus = 2 MPa at 10 Hz, loss_modulus = 0.2 MPa, area: 4 cm^2, length: 1 cm",
        "K' = 80 kN/m at 10 Hz, k″ = 200 kPa, area = 4 cm^2, length = 10 mm",
    ] {
        let found = json(&place, &[data]);
        for name in ["c", "alpha"] {
            assert!((parameter(&found, name) / parameter(&wanted, name) - 1.0).abs() < 1e-13, "{data}: {found}");
        }
    }
    let bare = "E' = 2 MPa at 10 Hz, E'' = 0.2 MPa at 10 Hz";
    let sized = place.done(&["laws", "--from", bare, "--area", "4 cm^2", "--length", "10 mm"]).stdout;
    assert!(sized.contains("2 MPa (80000 N/m) wanted, 80000 N/m reached"), "{sized}");
    refused(&place, &["--from", bare], &["--from:1:6", "takes area and length", "--area '4 cm^2' --length '10 mm'"]);
    refused(&place, &["--from", bare, "--area", "4 cm^2"], &["takes area and length"]);
    refused(&place, &["--from", bare, "--area", "4 cm"], &["--area 4 cm: ", "in m^2"]);
    refused(&place, &["--from", bare, "--length", "-1 mm"], &["--length -1 mm: not a positive number"]);
    let twice = format!("{bare}, area = 3 cm^2");
    refused(&place, &["--from", &twice, "--area", "4 cm^2"], &["area is given twice"]);
    refused(&place, &["--from", "stiffness = 5, length = 0"], &["--from:1:25", "must be positive"]);
    refused(
        &place,
        &["--from", "stiffness = 5", "--area", "4 cm^2", "--length", "1 m"],
        &["nothing is in Pa", "E' = 2 MPa"],
    );
    refused(&place, &["--from", "damping = 5 Pa at 3 Hz"], &["does not fit"]);
    // Without a unit it is what all numbers are, which is told.
    let told = place.done(&["laws", "--from", "E' = 2e6 at 10 Hz, tan_delta = 0.1"]).stderr;
    assert!(told.contains("no unit and is read in N/m") && told.contains("E' = 2e6 MPa"), "{told}");
}

#[test]
fn one_reading_of_frequencies() {
    let place = Place::new();
    let alike = |data: &[&str]| {
        let found: Vec<f64> = data.iter().map(|data| parameter(&json(&place, &[data]), "c")).collect();
        assert!(found.windows(2).all(|pair| (pair[0] / pair[1] - 1.0).abs() < 1e-14), "{found:?}");
    };
    alike(&[
        "tan_delta = 0.3 at 10, stiffness = 5 kN/m",
        "tan_delta = 0.3 at 10 Hz, stiffness = 5 kN/m",
        "tan_delta = 0.3 at 0.01 kHz, stiffness = 5 kN/m",
        "tan_delta = 0.3 at 62.83185307179586 rad/s, stiffness = 5 kN/m",
        "tan_delta = 0.3 at 3600 deg/s, stiffness = 5 kN/m",
    ]);
    let band = |from: &str, to: &str| {
        let arguments =
            ["prony", "--order", "0.5", "--coefficient", "50", "--band", "--format", "csv", "--from", from, "--to", to];
        place.springpot(&arguments)
    };
    let plain = band("0.1", "100").stdout;
    assert!(!plain.is_empty());
    assert_eq!(band("0.1 Hz", "0.1 kHz").stdout, plain);
    let open = band("0.1 1/s", "100 1/s");
    assert_eq!(open.code, Some(2));
    assert!(open.stderr.contains("turns (Hz) or radians (rad/s)"), "{}", open.stderr);
    place.write("open.csv", "frequency [1/s],storage,loss\n1,2,3\n");
    refused(&place, &["--from", "open.csv"], &["open.csv:1: ", "turns (Hz) or radians", "write Hz or rad/s"]);
}

#[test]
fn a_measurement_is_fitted_and_drawn() {
    let place = Place::new();
    place.write("plain.csv", file("frequency,storage,loss", 40, |f, re, im| format!("{f},{re},{im}")));
    let page = place.done(&["laws", "--from", "plain.csv"]).stdout;
    assert!(page.lines().all(|line| line.chars().count() <= 80), "{page}");
    for words in [
        "fractional-kelvin-voigt   F = ",
        "  k     = 2000 ± ",
        "  alpha = 0.35 ± ",
        "frequency, storage, loss of plain.csv, 40 rows, 0.1 Hz to 100 Hz",
        "(line ",
        "plain-fit.svg",
        "parameters = { k = \"2000 N/m\", c = \"800 N*s^alpha/m\", alpha = 0.35 }",
    ] {
        assert!(page.contains(words), "{words}: {page}");
    }
    let svg = place.read("plain-fit.svg");
    assert!(svg.contains("measured") && svg.contains("storage") && svg.contains("loss"), "{svg}");

    // The same in other words.
    place.write(
        "rad.csv",
        file("Freq (rad/s),K' [kN/m],K'' [N/cm]", 40, |f, re, im| format!("{},{},{}", TAU * f, re / 1e3, im / 100.0)),
    );
    place.write(
        "pa.csv",
        file("t,f [kHz],E' [MPa],Tan Delta,T", 40, |f, re, im| {
            format!("x,{},{},{},warm", f / 1e3, re / 0.04 / 1e6, im / re)
        }),
    );
    place.write(
        "deg.csv",
        file("frequency,storage modulus (Pa),tan δ [deg]", 40, |f, re, im| {
            format!("{f},{},{}", re / 0.04, (im / re).atan().to_degrees())
        }),
    );
    let sample = ["--area", "4 cm^2", "--length", "10 mm"];
    for (name, options) in [("plain.csv", &[][..]), ("rad.csv", &[]), ("pa.csv", &sample), ("deg.csv", &sample)] {
        let answer = json(&place, &[&[name], options, &["--out", "figure.PNG"]].concat());
        for (parameter_name, wanted) in [("k", 2000.0), ("c", 800.0), ("alpha", 0.35)] {
            assert!((parameter(&answer, parameter_name) / wanted - 1.0).abs() < 1e-10, "{name}: {answer}");
            assert!(answer["spread"][parameter_name].as_f64().is_some_and(|spread| spread < 1e-7 * wanted), "{answer}");
        }
        assert_eq!((&answer["law"], &answer["rows"]), (&"fractional-kelvin-voigt".into(), &40.into()));
        assert!(answer["deviation"].as_f64().unwrap() < 1e-10 && answer["line"].as_u64().unwrap() > 1, "{answer}");
        assert_eq!(answer["figure"], "figure.PNG");
    }
    assert!(std::fs::read(place.path("figure.PNG")).unwrap().starts_with(b"\x89PNG"));

    // Other laws restrict it, and the worst row is named.
    let answer = json(&place, &["plain.csv", "--out", "s.svg"]);
    let springpot = place.done(&["laws", "springpot", "--json", "--from", "plain.csv", "--out", "s.svg"]).stdout;
    let springpot: Value = serde_json::from_str(&springpot).unwrap();
    assert!(
        springpot["rms"].as_f64() > answer["rms"].as_f64() && springpot["parameters"]["k"].is_null(),
        "{springpot}"
    );
    for law in ["spring", "dashpot", "kelvin-voigt"] {
        assert!(
            place
                .done(&["laws", law, "--from", "plain.csv", "--out", "s.svg"])
                .stdout
                .contains(&format!("law = \"{law}\""))
        );
    }
    let plain = place.read("plain.csv");
    let outlier = plain.lines().enumerate().map(|(k, line)| match k {
        20 => format!("{}9\n", line.split_inclusive(',').take(2).collect::<String>()),
        _ => format!("{line}\n"),
    });
    place.write("outlier.csv", outlier.collect::<String>());
    assert_eq!(json(&place, &["outlier.csv"])["line"], 21);
}

#[test]
fn measurements_that_make_no_law_are_refused() {
    let place = Place::new();
    for (text, words) in [
        ("", &["the file is empty"][..]),
        ("1,2,3\n", &["bad.csv:1: ", "must name the columns", "frequency [rad/s], E' [MPa]"]),
        ("storage,loss\n1,2\n", &["bad.csv:1: no column is the frequency; the columns are storage, loss"]),
        ("frequency,stiffness,loss\n1,2,3\n", &["no column is the storage"]),
        ("frequency,storage,T\n1,2,3\n", &["no column is loss or tan_delta"]),
        ("frequency,storage,K',loss\n1,2,3,4\n", &["\"storage\" and \"K'\" are the same quantity"]),
        ("frequency [m],storage,loss\n1,2,3\n", &["bad.csv:1: ", "m does not fit", "Hz or rad/s"]),
        ("frequency,storage [kN],loss\n1,2,3\n", &["kN does not fit", "Pa or N/m"]),
        ("frequency,storage [foo],loss\n1,2,3\n", &["bad.csv:1: ", "foo"]),
        ("frequency,E' [MPa],loss\n1,2,3\n", &["takes area and length", "--area '4 cm^2'"]),
        ("frequency,storage,tan_delta [s]\n1,2,3\n", &["s does not fit"]),
        ("frequency,storage,tan_delta [deg]\n1,2,3\n2,2,95\n", &["bad.csv:3: ", "no loss angle", "90 deg"]),
        (
            "frequency,storage,loss\n1,2,3\n2,-2,3\n",
            &["bad.csv:3: storage is -2, but must be positive", "leave it out"],
        ),
        ("frequency,storage,loss\n0,2,3\n", &["bad.csv:2: frequency is 0"]),
        ("frequency,storage,loss\n1,2,x\n", &["bad.csv:2: ", "not a number"]),
        ("frequency,storage,loss\n1,2\n", &["bad.csv:2: 2 cells"]),
        ("frequency,storage,loss\n", &["bad.csv:1: 0 rows", "needs at least 3", "3 frequencies or more"]),
        ("frequency,storage,loss\n1,2,3\n2,3,4\n", &["bad.csv:3: 2 rows", "needs at least 3"]),
        ("frequency,storage,loss\n1,2,3\n1,3,4\n1,4,5\n", &["bad.csv:4: ", "3 different frequencies", "have 1"]),
    ] {
        place.write("bad.csv", text);
        refused(&place, &["--from", "bad.csv"], words);
    }
    refused(&place, &["--from", "none.csv"], &["none.csv: cannot be read"]);
    place.write("good.csv", file("frequency,storage,loss", 5, |f, re, im| format!("{f},{re},{im}")));
    refused(&place, &["--from", "good.csv", "--out", "x.gif"], &["neither .svg nor .png"]);
    refused(&place, &["--from", "good.csv", "--area", "1 m^2", "--length", "1 m"], &["nothing is in Pa", "E' [MPa]"]);
    refused(&place, &["thermoviscoelastic", "--from", "good.csv"], &["say nothing about", "kelvin-voigt"]);
    refused(
        &place,
        &["--from", "stiffness = 5", "--out", "x.svg"],
        &["--out x.svg: only the measurement of a CSV file"],
    );
    assert!(place.files(".").iter().all(|name| !name.ends_with("svg")));
    assert_eq!(place.springpot(&["laws", "--from", "good.csv", "--out", "no/such/folder.svg"]).code, Some(1));
}

#[test]
fn networks_are_fitted_too() {
    // k_e beside k_m in series with c·(iω)^alpha.
    let (k_e, k_m, c, alpha) = (300.0, 5000.0, 400.0, 0.45);
    let mut text = "frequency,storage,loss\n".to_owned();
    for k in 0..33 {
        let hertz = 10f64.powf(-2.0 + 0.125 * f64::from(k));
        let (size, angle) = (c * (std::f64::consts::TAU * hertz).powf(alpha), alpha * std::f64::consts::FRAC_PI_2);
        let (re, im) = (size * angle.cos(), size * angle.sin());
        let whole = (k_m + re).powi(2) + im * im;
        text.push_str(&format!(
            "{hertz},{},{}\n",
            k_e + k_m * (re * (k_m + re) + im * im) / whole,
            k_m * k_m * im / whole
        ));
    }
    let place = Place::new();
    place.write("dma.csv", &text);
    let answer = place.done(&["laws", "fractional-zener", "--from", "dma.csv", "--json"]).stdout;
    let answer: serde_json::Value = serde_json::from_str(&answer).unwrap();
    for (name, value) in [("k_e", k_e), ("k_m", k_m), ("c", c), ("alpha", alpha)] {
        assert!((answer["parameters"][name].as_f64().unwrap() / value - 1.0).abs() < 1e-5, "{answer}");
    }
    let page = place.done(&["laws", "fractional-zener", "--from", "dma.csv", "--out", "fit.svg"]).stdout;
    assert!(page.contains("k_e   = 300 ±") && page.contains("law = \"fractional-zener\""), "{page}");
    let refused = place.springpot(&["laws", "bouc-wen", "--from", "dma.csv"]);
    assert!(refused.code == Some(2) && refused.stderr.contains("fractional-burgers"), "{}", refused.stderr);
}
