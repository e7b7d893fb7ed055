//! `springpot prony`: the table, the formats, refusals.

use crate::support::{Csv, Place};
use serde_json::Value;
use springpot::fractional::prony::PronySeries;

const SPRINGPOT: [&str; 9] =
    ["prony", "--order", "0.5", "--coefficient", "50 N*s^alpha/m", "--from", "1 ms", "--to", "10 s"];

fn asked(place: &Place, more: &[&str]) -> String {
    place.done(&[&SPRINGPOT[..], more].concat()).stdout
}

/// G(t) of the springpot.
fn relaxation(t: f64) -> f64 {
    50.0 / (std::f64::consts::PI * t).sqrt()
}

#[test]
fn the_table_tells_the_error_and_every_branch() {
    let place = Place::new();
    let text = asked(&place, &[]);
    let series: PronySeries = serde_json::from_str(&asked(&place, &["--format", "json"])).unwrap();
    let branches = series.terms.len();
    for line in [
        "springpot  50 N*s^alpha/m, alpha = 0.5".to_owned(),
        "window     0.001 s to 10 s".to_owned(),
        format!("series     {branches} branches, all moduli positive"),
        "G_e        0 N/m, what stays".to_owned(),
    ] {
        assert!(text.lines().any(|found| found == line), "{line:?} in\n{text}");
    }
    assert!(text.contains(" of G(t), verified; at most 1e-4 was asked for\n"), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    let rows: Vec<&str> = text.lines().skip_while(|line| !line.contains("tau_k, s")).skip(1).collect();
    assert_eq!(rows.len(), branches, "{text}");
    for t in [1e-3, 0.03, 1.0, 10.0] {
        assert!((series.relaxation(t) / relaxation(t) - 1.0).abs() <= 1e-4, "t = {t}");
    }
    assert!(series.error <= 1e-4 && series.error > 1e-6);
}

#[test]
fn csv_is_that_series() {
    let place = Place::new();
    let table = Csv::new(&asked(&place, &["--format", "csv", "--rtol", "1e-6"]));
    assert_eq!(table.header, ["term", "modulus", "relaxation_time", "viscosity"]);
    let [moduli, times, viscosities] = ["modulus", "relaxation_time", "viscosity"].map(|name| table.numbers(name));
    assert!(moduli[0] == 0.0 && times[0].is_nan());
    for t in [1e-3f64, 0.2, 9.0] {
        let sum: f64 = (1..moduli.len()).map(|k| moduli[k] * (-t / times[k]).exp()).sum();
        assert!((sum / relaxation(t) - 1.0).abs() <= 1e-6, "t = {t}");
    }
    assert!((1..moduli.len()).all(|k| viscosities[k] == moduli[k] * times[k]));
    // To a file: the same text, and nothing on stdout.
    let ended = place.done(&[&SPRINGPOT[..], &["--format", "csv", "--rtol", "1e-6", "--out", "chain.csv"]].concat());
    assert_eq!(ended.stdout, "");
    assert_eq!(place.read("chain.csv"), asked(&place, &["--format", "csv", "--rtol", "1e-6"]));
}

/// G(t) of an Abaqus table whose instantaneous modulus stands in a comment.
fn abaqus(text: &str) -> impl Fn(f64) -> f64 {
    let whole: f64 =
        text.lines().find_map(|line| line.strip_prefix("** Instantaneous modulus: ")).unwrap().parse().unwrap();
    let rows = text.lines().skip_while(|line| *line != "*VISCOELASTIC, TIME=PRONY").skip(1);
    let rows: Vec<Vec<f64>> = rows.map(|row| row.split(", ").map(|n| n.parse().unwrap()).collect()).collect();
    assert!(rows.len() > 5 && rows.iter().map(|row| row[0]).sum::<f64>() < 1.0, "{text}");
    move |t| whole * (1.0 - rows.iter().map(|row| row[0] * -(-t / row[2]).exp_m1()).sum::<f64>())
}

#[test]
fn element_codes_get_a_long_term_modulus() {
    let place = Place::new();
    let text = asked(&place, &["--format", "abaqus"]);
    let modulus = abaqus(&text);
    for t in [1e-3, 0.02, 0.5, 10.0] {
        assert!((modulus(t) / relaxation(t) - 1.0).abs() <= 1e-4, "t = {t}");
    }
    assert!(
        text.contains("** It stands for what relaxes later; the equilibrium modulus of the material: 0\n"),
        "{text}"
    );
    let text = asked(&place, &["--format", "abaqus", "--equilibrium", "20 N/m"]);
    let modulus = abaqus(&text);
    for t in [1e-3, 0.02, 0.5, 10.0] {
        assert!((modulus(t) / (20.0 + relaxation(t)) - 1.0).abs() <= 1e-4, "t = {t}");
    }
    assert!(text.contains("of it: 20\n") && !text.contains("It stands for"), "{text}");
    let text = asked(&place, &["--format", "ansys", "--bulk", "relaxes"]);
    assert!(
        text.contains("\nTB,PRONY,1,1,") && text.contains(",SHEAR\nTBDATA,1,") && text.contains(",BULK\nTBDATA,1,"),
        "{text}"
    );
}

#[test]
fn frequencies_and_moduli_of_elasticity() {
    let place = Place::new();
    let band = |from: &str, to: &str| {
        let arguments = ["prony", "--order", "0.3", "--coefficient", "2 MPa*s^alpha", "--band", "--format", "json"];
        let ended = place.done(&[&arguments[..], &["--from", from, "--to", to]].concat());
        serde_json::from_str::<PronySeries>(&ended.stdout).unwrap()
    };
    let series = band("0.1", "1 kHz");
    for f in [0.1, 3.0, 1e3] {
        let omega = std::f64::consts::TAU * f;
        let exact = 2e6 * omega.powf(0.3);
        let (sin, cos) = (0.15 * std::f64::consts::PI).sin_cos();
        let modulus = series.complex_modulus(omega);
        assert!((modulus.re - exact * cos).hypot(modulus.im - exact * sin) <= 1e-4 * exact, "{f} Hz");
    }
    let angular = band("0.628318530717958647692 rad/s", "1 kHz");
    assert_eq!(angular.terms.len(), series.terms.len());
    let value: Value = serde_json::to_value(angular.window).unwrap();
    assert!((value["frequencies"]["from"].as_f64().unwrap() - 0.2 * std::f64::consts::PI).abs() < 1e-14, "{value}");
    let text = place.done(&[
        "prony",
        "--order",
        "0.3",
        "--coefficient",
        "2 MPa*s^alpha",
        "--band",
        "--from",
        "0.1",
        "--to",
        "1 kHz",
    ]);
    assert!(
        text.stdout.contains("window     0.1 Hz to 1000 Hz\n") && text.stdout.contains("g_k, Pa"),
        "{}",
        text.stdout
    );
}

#[test]
fn mistakes_are_refused_with_what_would_be_right() {
    let place = Place::new();
    let with = |change: &[(&str, &str)]| {
        let mut arguments: Vec<String> = SPRINGPOT.iter().map(|a| (*a).to_owned()).collect();
        for (name, value) in change {
            match arguments.iter().position(|a| a == name) {
                Some(at) => arguments[at + 1] = (*value).to_owned(),
                None => arguments.extend([(*name).to_owned(), (*value).to_owned()]),
            }
        }
        place.springpot(&arguments.iter().map(String::as_str).collect::<Vec<_>>())
    };
    for (change, words) in [
        (&[("--order", "1")][..], "write an order above 0 and below 1"),
        (&[("--order", "nan")], "--order NaN: out of range"),
        (&[("--order", "half")], "--order half: not a value that it takes"),
        (&[("--coefficient", "50 N/m")], "write a positive coefficient such as"),
        (&[("--coefficient", "-50")], "--coefficient -50: not a positive number"),
        (&[("--from", "1 m")], "--from 1 m: `m` does not fit"),
        (&[("--from", "0")], "--from 0: not a positive number"),
        (&[("--from", "20 s")], "--from 20 s is not below --to 10 s"),
        (&[("--to", "1e30")], "name a shorter window"),
        (&[("--rtol", "1e-15")], "--rtol 0.000000000000001"),
        (&[("--rtol", "-1")], "the tolerance must lie between"),
        (&[("--equilibrium", "20 Pa")], "write a modulus in N/m"),
        (&[("--equilibrium", "-3")], "not a positive number"),
        (&[("--format", "ansyss")], "ansys"),
        (
            &[("--coefficient", "1e308"), ("--from", "1e5"), ("--to", "1e9")],
            "--coefficient 1e308: the viscosity of branch ",
        ),
        (&[("--coefficient", "1e308"), ("--from", "1e-9")], "--coefficient 1e308: "),
        (&[("--coefficient", "1e-310")], "is too small for numbers of 64 bits"),
    ] {
        let ended = with(change);
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{change:?}: {}", ended.stderr);
        assert!(ended.stderr.contains(words), "{change:?}: {words}: {}", ended.stderr);
    }
    let ended = with(&[("--out", "no/such/folder/chain.csv")]);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    assert!(ended.stderr.contains("cannot be written"), "{}", ended.stderr);
}

#[test]
fn help_shows_an_example_and_every_option() {
    let place = Place::new();
    let help = place.done(&["prony", "--help"]).stdout;
    assert_eq!(place.done(&["help", "prony"]).stdout, help);
    for words in ["Example", "--band", "--equilibrium <MODULUS>", "--format <FORMAT>", "--bulk <BULK>", "--out <FILE>"]
    {
        assert!(help.contains(words), "{help}");
    }
}

#[test]
fn whole_laws_relax_too() {
    let place = Place::new();
    let ask = |law: &str, parameters: &[&str]| {
        let each = parameters.iter().flat_map(|parameter| ["--parameter", *parameter]);
        let all: Vec<&str> = ["prony", "--law", law, "--from", "1e-3", "--to", "10"].into_iter().chain(each).collect();
        place.springpot(&all)
    };
    let zener = ask("fractional-zener", &["k_e=2 N/cm", "k_m=900", "c=120 N*s^alpha/m", "alpha=0.6"]);
    assert_eq!(zener.code, Some(0), "{}", zener.stderr);
    for words in ["law        fractional-zener, k_e=2 N/cm", "G_e        200 N/m", "all moduli positive"] {
        assert!(zener.stdout.contains(words), "{words}: {}", zener.stdout);
    }
    for (law, parameters, words) in [
        ("fractional-zenner", &[][..], "did you mean `fractional-zener`?"),
        ("fractional-maxwell", &["k=1", "c=2"], "--parameter alpha is missing"),
        ("fractional-maxwell", &["k=1", "c=2", "beta=1"], "has no such parameter"),
        ("fractional-maxwell", &["k=1", "c=2", "alpha=1.5"], "out of range"),
        ("fractional-maxwell", &["k=1 s", "c=2", "alpha=0.5"], "--parameter k=1 s"),
        ("fractional-maxwell", &["k"], "no value"),
        ("maxwell", &["k=1", "c=2"], "are not springs and springpots alone"),
        ("thermoviscoelastic", &["E_c=1", "E_kv=1", "E_d=1", "alpha=0.5", "a_kv=0"], "has inputs"),
    ] {
        let refused = ask(law, parameters);
        let said = refused.said();
        assert!(refused.code == Some(2) && said.contains(words), "{law} {parameters:?}: {}", refused.stderr);
    }
}
