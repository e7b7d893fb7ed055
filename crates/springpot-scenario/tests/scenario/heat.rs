//! `shift`, `thermal` and `expansion` of elements.

use crate::support::{assert_all_refused, cases, edited, parse, single};
use serde_json::json;
use springpot::law::{Catalog, Expansion, Shift, Thermal};
use springpot_scenario::RefusalKind::*;

const INPUTS: &str = "inputs = { T = \"25 degC\" }";
const WLF: &str = "shift = { kind = \"wlf\", C1 = 17.44, C2 = \"51.6 K\", T_ref = \"0 degC\" }";
const THERMAL: &str = "thermal = { capacity = \"50 J/K\", conductance = 0.5, ambient = \"20 degC\" }";

/// The example on a joint, with keys of heat in the place of its inputs.
fn heated(keys: &str) -> String {
    edited(&single(), &[(INPUTS, keys)])
}

#[test]
fn heat_is_planned() {
    let keys = format!("{WLF}\n{THERMAL}\nexpansion = {{ coefficient = \"1 mm/K\", T_ref = 300 }}");
    let plan = cases(&heated(&keys)).unwrap().plan(0).unwrap();
    let heat = plan.elements[0].element.law.as_heated().expect("a heated law").heat();
    assert_eq!(heat.shift, Some(Shift::Wlf { c1: 17.44, c2: 51.6, reference: 273.15 }));
    let thermal = Thermal { capacity: 50.0, conductance: 0.5, ambient: 293.15, start: 293.15 };
    assert_eq!(heat.thermal, Some(thermal));
    assert_eq!(heat.expansion, Some(Expansion { coefficient: 1e-3, reference: 300.0 }));
    let element = &plan.resolved()["elements"][0];
    assert_eq!(element["shift"], json!({ "kind": "wlf", "C1": 17.44, "C2": 51.6, "T_ref": 273.15 }));
    assert_eq!(element["thermal"]["start"], json!(293.15));
    assert_eq!(element["expansion"], json!({ "coefficient": 1e-3, "T_ref": 300.0 }));
    assert_eq!(element["inputs"], json!({}));
    let columns: Vec<(String, String)> = plan.system().columns().into_iter().map(|c| (c.name, c.unit)).collect();
    let at = columns.iter().position(|(name, _)| name == "strut.input").unwrap();
    let of = |name: &str, unit: &str| (name.to_owned(), unit.to_owned());
    assert_eq!(columns[at + 1..at + 3], [of("strut.T", "K"), of("strut.heat", "J")]);
}

#[test]
fn a_law_without_a_temperature_gets_one() {
    let spring = "law = \"springpot\"\nparameters = { c = 5, alpha = 0.5 }";
    let text = |keys: &str| {
        let text = heated(keys);
        let law = text.find("law = \"thermoviscoelastic\"").unwrap();
        let end = law + text[law..].find('}').unwrap() + 1;
        format!("{}{spring}{}", &text[..law], &text[end..])
    };
    let arrhenius = "shift = { kind = \"arrhenius\", energy = 8e4, T_ref = 300 }";
    let told = cases(&text(&format!("{arrhenius}\ninputs = {{ T = \"300 + t\" }}"))).unwrap().plan(0).unwrap();
    assert_eq!(told.elements[0].element.entry.inputs[0].name, "T");
    assert!(told.system().columns().iter().any(|column| column.name == "strut.T" && column.unit == "K"));
    let refusals = cases(&text(arrhenius)).err().unwrap().to_string();
    assert!(
        refusals.contains("needs the inputs T") && refusals.contains("`thermal`, which makes it a state"),
        "{refusals}"
    );
    // Paths lead into the tables, and to the temperature.
    let mut scenario = parse(&text(&format!("{arrhenius}\n{THERMAL}"))).unwrap();
    scenario.set("element.strut.thermal.capacity=\"2 J/K\"").unwrap();
    scenario.sweep("element.strut.shift.energy=5e4,6e4").unwrap();
    let both = scenario.cases(&Catalog::standard()).unwrap();
    assert_eq!(both.len(), 2);
    let heat = *both.plan(1).unwrap().elements[0].element.law.as_heated().unwrap().heat();
    assert_eq!(heat.thermal.unwrap().capacity, 2.0);
    assert_eq!(heat.shift, Some(Shift::Arrhenius { energy: 6e4, reference: 300.0 }));
    let mut scenario = parse(&text(arrhenius)).unwrap();
    scenario.set("element.strut.T=\"30 degC\"").unwrap();
    assert!(scenario.cases(&Catalog::standard()).is_ok());
    let mut scenario = parse(&text(THERMAL)).unwrap();
    scenario.set("element.strut.T=\"30 degC\"").unwrap();
    let refusals = scenario.cases(&Catalog::standard()).err().unwrap().to_string();
    assert!(refusals.contains("has no `T`"), "{refusals}");
}

#[test]
fn what_is_wrong_with_heat_is_refused_in_its_place() {
    let base = heated(&format!("{WLF}\n{THERMAL}\nexpansion = {{ coefficient = \"1 mm/K\", T_ref = 300 }}"));
    assert_all_refused(
        &base,
        &[
            (&[("capacity = \"50 J/K\"", "capacity = ‸\"-50 J/K\"")], OutOfRange, "must be positive"),
            (&[("capacity = \"50 J/K\", ", ""), ("thermal = ", "thermal = ‸")], Missing, "capacity = \"50 J/K\""),
            (&[("conductance = 0.5", "conductance = ‸-0.5")], Rule, "conductance ≥ 0"),
            (&[("ambient = \"20 degC\"", "ambient = ‸20")], OutOfRange, "degC"),
            (&[("ambient = \"20 degC\"", "ambient = \"20 degC\", start = ‸\"2000 K\"")], OutOfRange, "2000 K"),
            (&[("ambient = \"20 degC\"", "ambient = ‸\"-60 degC\"")], Rule, "C2 + T − T_ref > 0"),
            (&[("ambient = \"20 degC\"", "‸ambiance = \"20 degC\"")], UnknownKey, "did you mean `ambient`?"),
            (&[("capacity = \"50 J/K\"", "capacity = \"50 ‸W/K\"")], BadQuantity, "J/K"),
            (&[("kind = \"wlf\"", "kind = ‸\"wfl\"")], UnknownName, "there is wlf and arrhenius"),
            (&[("kind = \"wlf\", ", ""), ("shift = ", "shift = ‸")], Missing, "kind"),
            (&[("C1 = 17.44", "C1 = ‸-1")], Rule, "C1 ≥ 0"),
            (&[("C2 = \"51.6 K\"", "C2 = ‸0")], OutOfRange, "must be positive"),
            (&[("C2 = \"51.6 K\"", "C2 = ‸\"51.6 degC\"")], BadQuantity, "no difference of two\n  help: write it in K"),
            (&[("C2 = \"51.6 K\"", "C2 = ‸\"93 degF\"")], BadQuantity, "a temperature and no difference of two"),
            (
                &[("C2 = \"51.6 K\"", "C2 = ‸{ expression = \"50 + 2\", unit = \"degC\" }")],
                BadQuantity,
                "no difference of two",
            ),
            (
                &[("C1 = 17.44", "C1 = 17.44, ‸energy = 3")],
                Rule,
                "`energy` of `shift` of element \"strut\" is none of kind",
            ),
            (&[("T_ref = 300", "T_ref = ‸30")], OutOfRange, "30 K"),
            (&[("coefficient = \"1 mm/K\"", "coefficient = \"1 ‸mm\"")], BadQuantity, "m/K"),
            (&[(THERMAL, &format!("{THERMAL}\ninputs = {{ ‸T = 300 }}"))], Rule, "stands beside `thermal`"),
            (&[(THERMAL, "inputs = { T = ‸\"-60 degC\" }")], Rule, "at or below the pole at 221.55 K"),
            (
                &[(THERMAL, "inputs = { T = ‸\"-51.5 degC\" }")],
                Rule,
                "does not go with `shift`, which needs an a_T between 1e-100 and 1e100: at T = 221.65 K log10 a_T is 8.982e3",
            ),
            (&[(THERMAL, "inputs = { T = ‸\"300 - 1000*t\" }")], OutOfRange, "help: keep it between 150 and 1500 K"),
            (&[(THERMAL, "inputs = { T = ‸\"25 + t\" }")], OutOfRange, "unit = \"degC\" }"),
            (&[(THERMAL, "inputs = { T = ‸\"20 K\" }")], OutOfRange, "help: keep it between 150 and 1500 K"),
            (
                &[("derivative = \"riemann-liouville\"", "scheme = ‸\"l1\"")],
                Rule,
                "a temperature, of which no named scheme knows",
            ),
        ],
    );
}

#[test]
fn components_of_bushings_take_heat() {
    let text = r#"
[[robot.body]]
name = "arm"
joint = { name = "q1", kind = "revolute", axis = [0, 0, 1], origin = [0, 0, 0] }
mass = 1
com = [0.1, 0, 0]

[[element]]
name = "mount"
from = { body = "world", point = [0, 0, 0] }
to = { body = "arm", point = [0, 0, 0] }
[element.bushing.rz]
law = "fractional-kelvin-voigt"
parameters = { k = "5 N*m/rad", c = "0.4 N*m*s^alpha/rad", alpha = 0.3 }
thermal = { capacity = "2 J/K", conductance = 0.1, ambient = 293 }
expansion = { coefficient = "0.1 deg/K", T_ref = 293 }

[motion]
kind = "prescribed"
joints = { q1 = "0.1*sin(t)" }

[time]
end = 1
output_step = 0.1
"#;
    let plan = cases(text).unwrap().plan(0).unwrap();
    let heat = plan.elements[0].element.law.as_heated().unwrap().heat();
    assert!((heat.expansion.unwrap().coefficient - 0.1f64.to_radians()).abs() < 1e-17);
    assert!(plan.system().columns().iter().any(|column| column.name == "mount.rz.heat"));
}
