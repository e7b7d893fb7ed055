//! `springpot laws`: every law, its page, and laws from data sheets.

use crate::support::Place;
use serde_json::Value;
use springpot::law::Catalog;
use springpot_scenario::Scenario;
use std::f64::consts::{PI, TAU};

/// What the examples of the pages stand in.
const AROUND: &str = r#"
robot.body = [{ name = "arm", joint = { name = "q1", kind = "revolute", axis = [0, 1, 0] }, mass = 1, com = [0.2, 0, 0] }]
motion = { kind = "prescribed", joints = { q1 = "0.5*sin(t)" } }
time = { end = 1, output_step = 0.5 }
"#;

fn admissible(element: &str) {
    let scenario = Scenario::parse(&format!("{AROUND}{element}"), "example", "").unwrap();
    let cases = scenario.cases(&Catalog::standard()).unwrap_or_else(|refusals| panic!("{refusals}\n{element}"));
    assert_eq!(cases.plan(0).unwrap().elements.len(), 1);
}

/// From `[[element]]` on.
fn element(text: &str) -> &str {
    &text[text.find("[[element]]").unwrap()..]
}

#[test]
fn stacks_start_from_what_a_stack_is() {
    let laws = Catalog::standard();
    let stacks = laws.entries().iter().filter(|law| law.name.starts_with("piezo-stack"));
    let lost = stacks.map(|law| {
        let page = Place::new().done(&["laws", &law.name]).stdout;
        let blocked =
            AROUND.replace("0.5*sin(t)", "0").replace("end = 1, output_step = 0.5", "end = 2, output_step = 0.01");
        let place = Place::with(&format!("{blocked}{}", element(&page)));
        place.done(&["run", "arm.toml", "--out", "o"]);
        let table = place.table("o/results.csv");
        // Blocked it pushes, with F_block at V_max and never more.
        let force = table.numbers("strut.force");
        assert!(force.iter().all(|force| (-1e3..0.0).contains(force)), "{}: {force:?}", law.name);
        // The drive swings about 50 V; what its way up leaves of the way down.
        let driven = table.numbers("strut.U");
        let passes = |rises: bool| {
            let is_it = |k: &usize| (driven[*k] < 50.0) == rises && (driven[k + 1] < 50.0) != rises;
            let k = (1..driven.len() - 1).find(is_it).unwrap();
            let share = (50.0 - driven[k]) / (driven[k + 1] - driven[k]);
            force[k] + share * (force[k + 1] - force[k])
        };
        (&*law.name, passes(true) - passes(false))
    });
    let lost: Vec<(&str, f64)> = lost.collect();
    assert_eq!(lost.len(), 4);
    for (name, lost) in lost {
        assert_eq!(lost.abs() > 10.0, name != "piezo-stack", "{name}: {lost} N");
    }
}

#[test]
fn the_table_has_every_law_and_fits() {
    let place = Place::new();
    let table = place.done(&["laws"]).stdout;
    assert!(table.lines().all(|line| line.chars().count() <= 80), "{table}");
    for law in Catalog::standard().entries() {
        let line = table.lines().find(|line| line.starts_with(&format!("{} ", law.name))).unwrap();
        assert!(law.inputs.iter().all(|input| line.contains(&format!(" {} ", input.name))), "{line}");
        let words: Vec<&str> = table.split_whitespace().collect();
        let equation: Vec<&str> = law.equation.split_whitespace().collect();
        assert!(words.windows(equation.len()).any(|window| window == equation), "{}", law.equation);
    }
}

#[test]
fn every_page_says_all_and_its_example_runs() {
    let place = Place::new();
    let all: Value = serde_json::from_str(&place.done(&["laws", "--json"]).stdout).unwrap();
    for (law, row) in Catalog::standard().entries().iter().zip(all.as_array().unwrap()) {
        let page = place.done(&["laws", &law.name]).stdout;
        for param in &law.params {
            let found = page.lines().find(|line| line.starts_with(&format!("  {} ", param.name))).unwrap();
            assert!(found.contains(if param.unit.is_empty() { " 1 " } else { &param.unit }), "{found}");
        }
        // Long equations are broken.
        let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(words(&page).contains(&words(&law.equation)) && page.contains("source  "), "{page}");
        admissible(element(&page));

        let one: Value = serde_json::from_str(&place.done(&["laws", &law.name, "--json"]).stdout).unwrap();
        assert_eq!(&one, row);
        assert_eq!(row["name"], *law.name);
        assert_eq!(row["parameters"].as_array().unwrap().len(), law.params.len());
        for (param, row) in law.params.iter().zip(row["parameters"].as_array().unwrap()) {
            let named = row["name"] == *param.name && row["unit"] == *param.unit && row["meaning"] == *param.meaning;
            assert!(named && row["default"].as_f64() == param.default, "{row}");
            assert_eq!(row["minimum"].as_f64(), (param.range.low > f64::MIN).then_some(param.range.low));
        }
        admissible(row["example"].as_str().unwrap());
    }
    assert_eq!(all.as_array().unwrap().len(), Catalog::standard().entries().len());
}

#[test]
fn a_data_sheet_gives_parameters() {
    let place = Place::new();
    let from = |law: Option<&str>, data: &str| {
        let arguments: Vec<&str> = ["laws"].into_iter().chain(law).chain(["--from", data]).collect();
        let page = place.done(&arguments).stdout;
        admissible(element(&page));
        let answer = place.done(&[&arguments[..], &["--json"]].concat()).stdout;
        (page, serde_json::from_str::<Value>(&answer).unwrap())
    };
    let (page, answer) = from(None, "tan_delta = 0.3 at 10 Hz, stiffness = 5 kN/m");
    let alpha = 2.0 / PI * 0.3_f64.atan();
    assert_eq!(answer["law"], "springpot");
    assert!((answer["parameters"]["alpha"].as_f64().unwrap() - alpha).abs() < 1e-15);
    let c = answer["parameters"]["c"].as_f64().unwrap();
    assert!((c / (5000.0 / (20.0 * PI).powf(alpha)) - 1.0).abs() < 1e-14);
    assert!(
        page.contains("law = \"springpot\"\nparameters = { c = \"2319.12 N*s^alpha/m\", alpha = 0.185547 }"),
        "{page}"
    );
    assert!(page.contains("stiffness at 10 Hz  5 kN/m wanted, 5000 N/m reached"), "{page}");
    assert!(!page.contains("deviation"), "{page}");
    // The same frequency in other words.
    let same = from(None, &format!("loss_factor: 0.3; stiffness = 50 N/cm at {} rad/s", 10.0 * TAU)).1;
    assert!((same["parameters"]["c"].as_f64().unwrap() / c - 1.0).abs() < 1e-12);

    let same = from(None, "tan_delta = 0.3 at 10, stiffness = 5 kN/m").1;
    assert_eq!(same["parameters"]["c"].as_f64(), Some(c));

    let (_, answer) = from(Some("kelvin-voigt"), "tan_delta = 0.3 at 10 Hz, stiffness = 5 kN/m at 10 Hz");
    let delta = 0.3_f64.atan();
    let wanted = [5000.0 * delta.cos(), 5000.0 * delta.sin() / (10.0 * TAU)];
    for (name, wanted) in ["k", "c"].into_iter().zip(wanted) {
        assert!((answer["parameters"][name].as_f64().unwrap() / wanted - 1.0).abs() < 1e-13, "{answer}");
    }
    assert_eq!(from(None, "stiffness = 2 kN/m, damping = 40 N*s/m").1["law"], "kelvin-voigt");
    assert_eq!(from(None, "stiffness = 2 kN/m").1["law"], "spring");
    assert_eq!(from(None, "damping = 2").1["law"], "dashpot");

    let (page, answer) = from(
        None,
        "stiffness = 2 kN/m at 0, tan_delta = 0.2 at 10 Hz, stiffness = 3 kN/m at 10 Hz, tan_delta = 0.25 at 30 Hz",
    );
    assert_eq!(answer["law"], "fractional-kelvin-voigt");
    assert!((1e-3..2e-2).contains(&answer["deviation"].as_f64().unwrap()) && page.contains("largest deviation 0.92 %"));
    assert_eq!(answer["check"].as_array().unwrap().len(), 4);
}

#[test]
fn what_is_wrong_is_said() {
    let place = Place::new();
    let refused = |arguments: &[&str], words: &[&str]| {
        let ended = place.springpot(&[&["laws"], arguments].concat());
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{arguments:?}");
        assert!(words.iter().all(|word| ended.stderr.contains(word)), "{arguments:?}: {}", ended.stderr);
    };
    refused(&["termoviscoelastic"], &["there is no law", "did you mean `thermoviscoelastic`?"]);
    refused(&["thermoviscoelastic", "--from", "stiffness = 3"], &["such data say nothing about", "kelvin-voigt"]);
    for (data, words) in [
        ("", &["holds no data"][..]),
        (" , ", &["holds no data"]),
        ("stiffness", &["--from:1:1", "has no `=`"]),
        ("tandelta = 0.3", &["did you mean `tan_delta`?"]),
        ("tan_delta = 0.3", &["needs a frequency", "at 10 Hz"]),
        ("tan_delta = 0.3 at 10 Hz", &["no stiffness is given"]),
        ("stiffness = 5 kN at 3 Hz", &["--from:1:15", "does not fit", "N/m"]),
        ("stiffness = 5 kN/m at 3 m", &["--from:1:25", "10 Hz or 63 rad/s"]),
        (
            "tan_delta = 0.3 at 10 1/s, stiffness = 5",
            &["does not say whether turns (Hz) or radians", "10 Hz or 63 rad/s"],
        ),
        ("tan_delta = 0.3 at -10 Hz, stiffness = 5", &["is no frequency"]),
        ("tan_delta = -0.3 at 1 Hz, stiffness = 5", &["must be positive"]),
        ("tan_delta = nan at 1 Hz, stiffness = 5", &["--from:1:13"]),
        ("stiffness = 3, stiffness = 4", &["given twice"]),
        ("tan_delta = 0.1 at 3 Hz, stiffness = 2 at 4 Hz, storage = 3", &["storage has no frequency", "several"]),
        (
            "stiffness = 3 at 0, tan_delta = 0.1 at 3 Hz, stiffness = 2 at 3 Hz",
            &["off by 23", "rises with the frequency"],
        ),
        ("stiffness = 3 at 0, stiffness = 4 at 1 Hz, storage = 4 at 1 Hz", &["look at units"]),
    ] {
        refused(&["--from", data], words);
    }
    refused(
        &["fractional-kelvin-voigt", "--from", "tan_delta = 0.1 at 3 Hz, stiffness = 2"],
        &["it needs three values"],
    );
    refused(&["springpot", "--from", "stiffness = 2 at 3 Hz"], &["add the losses"]);
    refused(&["springpot", "--from", "stiffness = 2, storage = 1"], &["no static stiffness"]);
}

#[test]
fn networks_are_drawn_with_their_modulus_and_relaxation() {
    let place = Place::new();
    let page = place.done(&["laws", "fractional-zener"]).stdout;
    for line in [
        "  o--+--[spring k_e]------------------------+--o",
        "     +--[spring k_m]--[springpot c, alpha]--+",
        "  K*(ω) = k_e + 1/(1/k_m + 1/(c·(iω)^alpha))",
        "  G(t)  = k_e + k_m·E_alpha(−k_m·t^alpha/c)",
        "  E_alpha is the Mittag-Leffler function.",
    ] {
        assert!(page.lines().any(|own| own == line), "{line}: {page}");
    }
    assert!(!place.done(&["laws", "bouc-wen"]).stdout.contains("K*("));
}
