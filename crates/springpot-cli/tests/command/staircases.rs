//! Signals of a thousand steps, written out: as a torque and as an input.

use crate::support::Place;

const STEPS: usize = 1000;

/// Where the steps are, s, and how high, in no order.
fn steps() -> Vec<(f64, f64)> {
    let at = |k: usize| 0.0021 + 0.005 * k as f64 + 0.001 * ((k * 7) % 3) as f64;
    (0..STEPS).map(|k| (k * 617) % STEPS).map(|k| (at(k), 0.01 + 0.001 * (k % 5) as f64)).collect()
}

fn scenario() -> String {
    let stairs: Vec<String> = steps().iter().map(|(t, height)| format!("{height:?}*step(t - {t:?})")).collect();
    let stairs = stairs.join(" + ");
    format!(
        r#"
[robot]
gravity = [0, 0, 0]
[[robot.body]]
name = "mass"
joint = {{ name = "x", kind = "prismatic", axis = [1, 0, 0] }}
mass = 2
[[robot.body]]
name = "plate"
parent = "world"
joint = {{ name = "y", kind = "prismatic", axis = [0, 1, 0] }}
mass = 1
[[element]]
name = "stack"
joint = "y"
law = "piezo-kelvin-voigt"
parameters = {{ E_c = 0, E_pz = 2, E_d = 0, alpha = 0.5, alpha_pz = 1 }}
inputs = {{ U = "{stairs}" }}
[motion]
kind = "forward"
torque = {{ x = "{stairs}" }}
prescribed = {{ y = 0 }}
[time]
end = "6 s"
output_step = "10 ms"
"#
    )
}

#[test]
fn every_jump_is_a_stop() {
    let place = Place::with(&scenario());
    place.done(&["run", "arm.toml", "--out", "o"]);
    assert!(place.read("arm.toml").len() > 30_000);
    // Torque and input jump together.
    assert_eq!(place.record("o")["cases"][0]["switches"], STEPS);
    let table = place.table("o/results.csv");
    let (t, v, force) = (table.numbers("t"), table.numbers("v.x"), table.numbers("stack.force"));
    let mut worst = [0.0f64; 2];
    for (row, &t) in t.iter().enumerate() {
        let passed = || steps().into_iter().filter(move |(at, _)| *at <= t);
        let impulse: f64 = passed().map(|(at, height)| height * (t - at)).sum();
        let height: f64 = passed().map(|(_, height)| height).sum();
        worst[0] = worst[0].max((v[row] - impulse / 2.0).abs());
        worst[1] = worst[1].max((force[row] + 2.0 * height).abs());
    }
    // v reaches 16 m/s and the force 24 N.
    assert!(worst[0] < 1e-10 && worst[1] < 1e-12, "{worst:?}");
}
