//! Friction of joints: a number, or a table with what it does near rest.

use crate::support::{assert_all_refused, cases, catalog, edited, parse};
use springpot::model::FrictionLaw;
use springpot_scenario::RefusalKind::*;

/// A load on a rail and an arm on it.
const LIFT: &str = r#"
[[robot.body]]
name = "b"
joint = { name = "q", kind = "prismatic", axis = [0, 0, 1], friction = { force = "10 N", stick = true } }
mass = 1
[[robot.body]]
name = "arm"
joint = { name = "p", kind = "revolute", axis = [0, 1, 0], friction = { force = "20 N*cm", speed = "1 mrad/s" } }
mass = 1
com = [0.1, 0, 0]

[motion]
kind = "forward"
torque = { q = 9 }

[time]
end = 1
output_step = 0.1
"#;

fn laws(text: &str) -> Vec<(f64, FrictionLaw)> {
    let plan = cases(text).unwrap().plan(0).unwrap();
    plan.model.friction().iter().copied().zip(plan.model.friction_laws().iter().copied()).collect()
}

#[test]
fn friction_is_a_number_or_a_table() {
    use FrictionLaw::{Smooth, Sticking};
    assert_eq!(laws(LIFT), [(10.0, Sticking), (0.2, Smooth { speed: 1e-3 })]);
    let table = "{ force = \"10 N\", stick = true }";
    for (written, law) in [
        ("3", (3.0, Smooth { speed: 1e-3 })),
        ("\"3 N\"", (3.0, Smooth { speed: 1e-3 })),
        ("{ force = 3 }", (3.0, Smooth { speed: 1e-3 })),
        ("{ force = 3, speed = \"2 mm/s\" }", (3.0, Smooth { speed: 2e-3 })),
        ("{ force = 3, speed = \"2 mm/s\", stick = false }", (3.0, Smooth { speed: 2e-3 })),
        ("{ force = 3, speed = \"2 mm/s\", stick = true }", (3.0, Sticking)),
    ] {
        assert_eq!(laws(&edited(LIFT, &[(table, written)]))[0], law, "{written}");
    }
}

#[test]
fn friction_is_swept_set_and_recorded() {
    let text = LIFT.to_owned()
        + "[[sweep]]\nparameter = \"robot.body.b.joint.friction.force\"\nvalues = [\"1 N\", \"2 N\"]\n\
           [[sweep]]\nparameter = \"robot.body.b.joint.friction.stick\"\nvalues = [false, true]\n";
    let mut scenario = parse(&text).unwrap();
    scenario.set("robot.body.arm.joint.friction.speed=2 mrad/s").unwrap();
    let cases = scenario.cases(&catalog()).unwrap();
    let friction =
        |i: usize, body: usize| cases.plan(i).unwrap().resolved()["bodies"][body]["joint"]["friction"].clone();
    assert_eq!(cases.len(), 4);
    assert_eq!(friction(0, 0), serde_json::json!({ "force": 1.0, "speed": 1e-3, "stick": false }));
    assert_eq!(friction(3, 0), serde_json::json!({ "force": 2.0, "speed": null, "stick": true }));
    assert_eq!(friction(3, 1), serde_json::json!({ "force": 0.2, "speed": 2e-3, "stick": false }));
}

#[test]
fn friction_is_refused_where_it_is_wrong() {
    let table = "friction = { force = \"10 N\", stick = true }";
    let arm = "friction = { force = \"20 N*cm\", speed = \"1 mrad/s\" }";
    assert_all_refused(
        LIFT,
        &[
            (&[(table, "friction = { force = \"10 ‸N*m\" }")], BadQuantity, "this place takes `N`"),
            (&[(arm, "friction = { force = \"10 ‸N\" }")], BadQuantity, "this place takes `N*m`"),
            (&[(table, "friction = { force = 1, speed = \"1 ‸rad/s\" }")], BadQuantity, "this place takes `m/s`"),
            (&[(arm, "friction = { force = 1, speed = \"1 ‸mm/s\" }")], BadQuantity, "this place takes `rad/s`"),
            (&[(table, "friction = { force = 1, speed = ‸0 }")], OutOfRange, "must be positive"),
            (&[(table, "friction = { force = 1, stick = true, speed = ‸-1 }")], OutOfRange, "must be positive"),
            (&[(table, "friction = { force = ‸-1, stick = true }")], Rule, "joint.friction of body \"b\" is -1"),
            (&[(table, "friction = { force = 1, ‸sticks = true }")], UnknownKey, "did you mean `stick`?"),
            (&[(table, "friction = { force = 1, stick = ‸1 }")], WrongType, "true or false"),
            (&[(table, "friction = ‸{ stick = true }")], Missing, "has no `force`"),
            (&[(table, "friction = ‸[1]")], WrongType, "must be a number or a quantity in N"),
        ],
    );
}
