//! Derivatives of whole runs by their parameters, against differences of whole runs.

mod adjoint;
mod laws;
mod replay;
#[path = "../support/mod.rs"]
mod support;

use springpot::Simulation;
use springpot::dual::Dual;
use springpot::law::{Catalog, Derivative, Network};
use springpot::observe::{ElementQuantity, EnergyQuantity, Quantity};
use springpot::sensitivity::{Parameter, Seed, Sensitivity};
use springpot::signal::Signal;
use std::sync::Arc;
use support::cases;

/// k, c of the strut, its rest length, q2(0), v.q2(0), damping of q2, a torque on q3, gravity.
const VALUES: [f64; 8] = [120.0, 15.0, 0.35, 0.4, -0.3, 0.2, 0.5, -9.81];
const NAMES: [&str; 8] = ["k", "c", "rest", "q2", "v2", "damping", "torque", "gravity"];

/// Steps of the differences in units of the values, where neither rounding nor curvature is seen.
const STEPS: [f64; 8] = [5e-3, 3e-3, 3e-4, 5e-3, 1e-2, 2e-2, 3e-3, 1e-3];

fn arm(values: &[f64; 8], [law, motion]: [&str; 2], rtol: f64) -> String {
    let [k, c, rest, q2, v2, damping, torque, gravity] = values;
    let falls = format!(
        "kind = \"forward\"\nstart = {{ q = {{ q1 = 0.3, q2 = {q2:?}, q3 = -0.5 }}, v = {{ q2 = {v2:?}, q1 = 0.7 }} }}\n\
         torque = {{ q3 = \"{torque:?}*cos(4*t)\" }}"
    );
    let motion = if motion.is_empty() { &falls } else { motion };
    let law = law.replace("{k}", &format!("{k:?}")).replace("{c}", &format!("{c:?}"));
    format!(
        r#"
[robot]
gravity = [0, 0, {gravity:?}]
[[robot.body]]
name = "one"
joint = {{ name = "q1", kind = "revolute", axis = [0, 0, 1], origin = [0, 0, 0.3] }}
mass = 3
com = [0.02, 0.1, 0.05]
inertia = {{ xx = 0.03, yy = 0.02, zz = 0.04 }}
[[robot.body]]
name = "two"
parent = "one"
joint = {{ name = "q2", kind = "revolute", axis = [1, 0, 0], origin = [0, 0.1, 0.2], damping = {damping:?} }}
mass = 2
com = [0, 0.2, 0.03]
inertia = {{ xx = 0.02, yy = 0.01, zz = 0.02 }}
[[robot.body]]
name = "three"
parent = "two"
joint = {{ name = "q3", kind = "revolute", axis = [1, 0, 0], origin = [0, 0.4, 0] }}
mass = 1
com = [0.01, 0.15, 0]
inertia = {{ xx = 0.01, yy = 0.004, zz = 0.01 }}
[[element]]
name = "strut"
from = {{ body = "one", point = [0.05, 0, 0] }}
to = {{ body = "three", point = [0, 0.1, 0.05] }}
rest_length = {rest:?}
{law}
[motion]
{motion}
[time]
end = 0.7
output_step = 0.1
[solver]
rtol = {rtol:e}
memory_rtol = 1e-12
"#
    )
}

/// What is compared.
fn quantities() -> Vec<Quantity> {
    use ElementQuantity::{Force, GeneralizedForce, Length, Rate, Stored, Stroke};
    let of_robot = (0..3).flat_map(|k| [Quantity::Coordinate(k), Quantity::Velocity(k), Quantity::Acceleration(k)]);
    let of_element = [Length, Stroke, Rate, Force, GeneralizedForce(1), Stored].map(|of| Quantity::Element(0, of));
    let of_robot = of_robot.chain([EnergyQuantity::Kinetic, EnergyQuantity::Potential].map(Quantity::Energy));
    of_robot.chain([0, 1, 2].map(Quantity::Torque)).chain(of_element).collect()
}

/// Times of the rows that are compared, none of which a step ends on.
const ROWS: [f64; 3] = [0.1734, 0.4321, 0.6789];

/// Takes steps until they have passed `t`.
fn pass(simulation: &mut Simulation, t: f64) {
    while simulation.t() < t {
        simulation.step().unwrap();
    }
}

/// All quantities at the rows.
fn rows_of(text: &str) -> Vec<Vec<f64>> {
    let plan = cases(text).plan(0).unwrap();
    let mut simulation = Simulation::new(plan.system(), plan.settings.clone()).unwrap();
    let row = |t: f64| {
        pass(&mut simulation, t);
        let snapshot = simulation.interpolate(t).unwrap();
        quantities().into_iter().map(|quantity| snapshot.value(quantity)).collect()
    };
    ROWS.map(row).to_vec()
}

/// The fourth-order difference of all rows by a number.
fn difference(step: f64, value: f64, rows: impl Fn(f64) -> Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let d = step * value.abs();
    let [a, b, c, e] = [1.0, -1.0, 2.0, -2.0].map(|steps| rows(value + steps * d));
    let of = |r: usize, k: usize| (8.0 * (a[r][k] - b[r][k]) - (c[r][k] - e[r][k])) / (12.0 * d);
    (0..a.len()).map(|r| (0..a[r].len()).map(|k| of(r, k)).collect()).collect()
}

fn parameter(name: &str, value: f64, seeds: Vec<Seed>) -> Parameter {
    Parameter { name: name.into(), value, typical: value.abs(), seeds }
}

/// A law of numbers of which one changes.
fn law(name: &str, values: &[f64], which: usize) -> Network {
    let entry = Catalog::standard().get(name).unwrap().clone();
    let numbers: Vec<Dual> = values
        .iter()
        .enumerate()
        .map(|(k, value)| Dual { value: *value, slope: if k == which { 1.0 } else { 0.0 } })
        .collect();
    (entry.build)(&numbers, Derivative::Caputo).unwrap()
}

/// Derivatives of q and v at the end by all of [`NAMES`], and by differences.
fn compare([text, motion]: [&str; 2], name: &str, law_values: &[f64], [k, c]: [usize; 2], more: &[(&str, usize, f64)]) {
    let at = |values: &[f64; 8], rtol: f64| arm(values, [text, motion], rtol);
    let plan = cases(&at(&VALUES, 1e-9)).plan(0).unwrap();
    let mut system = plan.system();
    let heavier = cases(&at(&[&VALUES[..7], &[1.0]].concat().try_into().unwrap(), 1e-9)).plan(0).unwrap().system();
    let seeds = |p: usize| match NAMES[p] {
        "k" => Seed::Law { element: 0, law: law(name, law_values, k) },
        "c" => Seed::Law { element: 0, law: law(name, law_values, c) },
        "rest" => Seed::Rest { element: 0, by: 1.0 },
        "q2" | "v2" | "torque" if !motion.is_empty() => Seed::Rest { element: 0, by: 0.0 },
        "q2" => Seed::Position { velocity: 1, by: 1.0 },
        "v2" => Seed::Velocity { velocity: 1, by: 1.0 },
        "damping" => Seed::Damping { joint: 1, by: 1.0 },
        "torque" => Seed::Drive {
            velocity: 2,
            by: Signal::expression(springpot::signal::Expression::parse("cos(4*t)").unwrap()),
        },
        _ => Seed::Gravity(heavier.model.clone()),
    };
    let mut parameters: Vec<Parameter> =
        (0..NAMES.len()).map(|k| parameter(NAMES[k], VALUES[k], vec![seeds(k)])).collect();
    for (what, which, _) in more {
        let seed = Seed::Law { element: 0, law: law(name, law_values, *which) };
        parameters.push(parameter(what, law_values[*which], vec![seed]));
    }
    let by = Sensitivity { parameters, control: true, ..Sensitivity::default() };
    system.sensitivity = Some(Arc::new(by));
    let mut simulation = Simulation::new(system, plan.settings.clone()).unwrap();
    let rows = ROWS.map(|t| {
        pass(&mut simulation, t);
        let of = |quantity| simulation.derivatives(t, quantity).unwrap();
        quantities().into_iter().map(of).collect::<Vec<_>>()
    });
    for p in 0..NAMES.len() + more.len() {
        let (what, truth) = match more.get(p.wrapping_sub(NAMES.len())) {
            None => (
                NAMES[p],
                difference(STEPS[p], VALUES[p], |value| {
                    let mut values = VALUES;
                    values[p] = value;
                    rows_of(&at(&values, 1e-12))
                }),
            ),
            Some((what, which, step)) => (
                *what,
                difference(*step, law_values[*which], |value| {
                    let [old, new] = [law_values[*which], value].map(|value| format!("{what} = {value:?}"));
                    rows_of(&arm(&VALUES, [&text.replace(&old, &new), motion], 1e-12))
                }),
            ),
        };
        for (k, quantity) in quantities().into_iter().enumerate() {
            let size = truth.iter().fold(0.0f64, |size, row| size.max(row[k].abs()));
            for (r, row) in truth.iter().enumerate() {
                let (found, miss) = (rows[r][k][p], (rows[r][k][p] - row[k]).abs() / size.max(1e-5));
                // Of accelerations within a step the differences know no more.
                let is_loose = matches!(quantity, Quantity::Acceleration(_)) || what == "alpha";
                let known = if is_loose { 5e-6 } else { 1.5e-7 };
                assert!(
                    miss < known,
                    "{name} by {what}: {quantity:?} at {}: {found} for {}, {miss:e}",
                    ROWS[r],
                    row[k]
                );
            }
        }
    }
}

#[test]
fn an_arm_with_a_spring_and_a_dashpot() {
    compare(
        ["law = \"kelvin-voigt\"\nparameters = { k = {k}, c = {c} }", ""],
        "kelvin-voigt",
        &[120.0, 15.0],
        [0, 1],
        &[],
    );
}

#[test]
fn an_arm_with_parts_in_series() {
    let text = "law = \"zener\"\nparameters = { k_e = 60.0, k_m = {k}, c = {c} }";
    compare([text, ""], "zener", &[60.0, 120.0, 15.0], [1, 2], &[("k_e", 0, 1e-2)]);
}

#[test]
fn an_arm_with_a_damper_behind_its_driver() {
    let text = "law = \"bouc-wen-damper\"\nparameters = { c_0a = {k}, c_0b = {c}, k_0 = 60.0, x_0 = 0.01, alpha_a = 80.0, \
                alpha_b = 5.0, A = 1.0, beta = 20.0, gamma = 50.0, n = 2.0, eta = 6.0 }\n\
                inputs = { u = \"0.6 + 0.5*sin(9*t)\" }";
    let values = [120.0, 15.0, 60.0, 0.01, 80.0, 5.0, 1.0, 20.0, 50.0, 2.0, 6.0];
    let more = [("alpha_a", 4, 1e-2), ("beta", 7, 1e-2), ("n", 9, 4e-3), ("eta", 10, 1e-2)];
    compare([text, ""], "bouc-wen-damper", &values, [0, 1], &more);
}

fn fractional(alpha: f64, motion: &str) {
    let text = format!("law = \"fractional-kelvin-voigt\"\nparameters = {{ k = {{k}}, c = {{c}}, alpha = {alpha:?} }}");
    compare([&text, motion], "fractional-kelvin-voigt", &[120.0, 15.0, alpha], [0, 1], &[("alpha", 2, 6e-3)]);
}

#[test]
fn an_arm_with_a_springpot() {
    [0.1, 0.5, 0.9].into_iter().for_each(|alpha| fractional(alpha, ""));
}

#[test]
fn an_arm_along_given_motions() {
    let motion =
        "kind = \"prescribed\"\njoints = { q1 = \"0.4*sin(3*t)\", q2 = \"0.3 + 0.2*t\", q3 = \"-0.5 + 0.3*t^2\" }";
    [0.2, 0.7].into_iter().for_each(|alpha| fractional(alpha, motion));
}

/// At rest in equilibrium nothing moves but the derivatives: of a linear system they are its motion from v(0) = 1.
#[test]
fn a_slider_at_rest_in_equilibrium() {
    let text = |v: f64, rtol: f64| {
        let law = "law = \"fractional-kelvin-voigt\"\nparameters = { k = 50, c = 50, alpha = 0.5 }";
        let start = support::forward::state("0", &format!("{v:?}"));
        support::forward::slider("2", 0.0, law, &start) + &support::forward::every(2.0, 0.5, rtol)
    };
    let of = |plan: &springpot_scenario::Plan, by: Option<Sensitivity>| {
        let mut system = plan.system();
        system.sensitivity = by.map(Arc::new);
        Simulation::new(system, plan.settings.clone()).unwrap()
    };
    let seeds = vec![Seed::Velocity { velocity: 0, by: 1.0 }];
    let by = Sensitivity { parameters: vec![parameter("v", 1.0, seeds)], control: true, ..Sensitivity::default() };
    let mut still = of(&cases(&text(0.0, 1e-9)).plan(0).unwrap(), Some(by));
    let mut moving = of(&cases(&text(1.0, 1e-11)).plan(0).unwrap(), None);
    for t in [0.05, 0.5, 1.0, 2.0] {
        pass(&mut still, t);
        pass(&mut moving, t);
        let snapshot = moving.interpolate(t).unwrap();
        for quantity in [Quantity::Coordinate(0), Quantity::Velocity(0), Quantity::Element(0, ElementQuantity::Force)] {
            let found = still.derivatives(t, quantity).unwrap()[0];
            let truth = snapshot.value(quantity);
            assert!((found - truth).abs() < 2e-8 * if matches!(quantity, Quantity::Element(..)) { 50.0 } else { 1.0 });
        }
    }
}

#[test]
fn states_take_derivatives_with_them() {
    let law_text = "law = \"fractional-kelvin-voigt\"\nparameters = { k = {k}, c = {c}, alpha = 0.4 }";
    let plan = cases(&arm(&VALUES, [law_text, ""], 1e-8)).plan(0).unwrap();
    let network = |which| law("fractional-kelvin-voigt", &[VALUES[0], VALUES[1], 0.4], which);
    let alpha = parameter("alpha", 0.4, vec![Seed::Law { element: 0, law: network(2) }]);
    let v = parameter("v", 0.3, vec![Seed::Velocity { velocity: 1, by: 1.0 }]);
    let mut system = plan.system();
    let by = Sensitivity { parameters: vec![alpha, v], control: true, ..Sensitivity::default() };
    system.sensitivity = Some(Arc::new(by));
    let system = Arc::new(system);
    let begin = || Simulation::new(system.clone(), plan.settings.clone()).unwrap();
    let (mut first, mut second) = (begin(), begin());
    pass(&mut first, 0.3);
    let state = first.state().unwrap();
    second.set_state(&state).unwrap();
    let all = |simulation: &mut Simulation| {
        pass(simulation, 0.6);
        let of = |quantity| simulation.derivatives(0.6, quantity).unwrap();
        quantities().into_iter().map(of).collect::<Vec<_>>()
    };
    assert_eq!(all(&mut first), all(&mut second));
}

/// A force that jumps at a time that no parameter moves: of a linear system the derivative is half the difference of two runs.
#[test]
fn a_force_that_jumps_by_a_parameter() {
    let text = |f: f64| {
        let law = "law = \"fractional-kelvin-voigt\"\nparameters = { k = 50, c = 5, alpha = 0.5 }";
        let motion = format!("{}\ntorque = {{ q = \"{f:?}*step(t - 0.3)\" }}", support::forward::state("0.1", "0"));
        support::forward::slider("2", 0.0, law, &motion) + &support::forward::every(1.0, 0.5, 1e-10)
    };
    let plan = cases(&text(2.0)).plan(0).unwrap();
    let by = Signal::expression(springpot::signal::Expression::parse("step(t - 0.3)").unwrap());
    let force = parameter("f", 2.0, vec![Seed::Drive { velocity: 0, by }]);
    let mut system = plan.system();
    system.sensitivity =
        Some(Arc::new(Sensitivity { parameters: vec![force], control: true, ..Sensitivity::default() }));
    let mut run = Simulation::new(system, plan.settings.clone()).unwrap();
    let mut others = [1.0, 3.0].map(|f| {
        let plan = cases(&text(f)).plan(0).unwrap();
        Simulation::new(plan.system(), plan.settings.clone()).unwrap()
    });
    for t in [0.2, 0.31, 0.5, 1.0] {
        pass(&mut run, t);
        for quantity in [Quantity::Coordinate(0), Quantity::Velocity(0)] {
            let [low, high] = others.each_mut().map(|other| {
                pass(other, t);
                other.interpolate(t).unwrap().value(quantity)
            });
            let found = run.derivatives(t, quantity).unwrap()[0];
            assert!(
                (found - 0.5 * (high - low)).abs() < 1e-9,
                "{quantity:?} at {t}: {found} for {}",
                0.5 * (high - low)
            );
        }
    }
}
