//! Linear models against the exact answers, over orders and tolerances.

use crate::support::system;
use crate::{arm, linear, on_joints, slider};
use num_complex::Complex64;
use springpot::linear::{Excitation, LinearModel, Linearisation, LineariseError, ModelOrder, StateKind, linearise};
use springpot::observe::{Axis, ElementQuantity, Quantity};
use std::f64::consts::TAU;

const TIME: &str = "[time]\nend = 1\noutput_step = 0.5";
const BAND: [f64; 2] = [0.1 * TAU, 100.0 * TAU];

fn model(about: &Linearisation, inputs: &[Excitation], outputs: &[Quantity], tolerance: f64) -> LinearModel {
    let model = linearise(about, &ModelOrder { inputs, outputs, band: BAND, tolerance });
    model.unwrap_or_else(|error| panic!("{tolerance}: {error}"))
}

/// The largest relative deviation of all channels at frequencies of its own.
fn deviation(about: &Linearisation, model: &LinearModel, inputs: &[Excitation], outputs: &[Quantity]) -> f64 {
    let mut worst = 0.0f64;
    for k in 0..=61 {
        let omega = BAND[0] * (BAND[1] / BAND[0]).powf(f64::from(k) / 61.0);
        let own = model.frequency_response(omega);
        for (i, input) in inputs.iter().enumerate() {
            for (o, output) in outputs.iter().enumerate() {
                let exact = about.frequency_response(*input, *output, omega).unwrap();
                worst = worst.max((own[o][i] - exact).norm() / exact.norm());
            }
        }
    }
    worst
}

fn is_stable(model: &LinearModel) -> bool {
    model.poles().unwrap().iter().all(|s| s.re < 1e-9 * s.norm())
}

#[test]
fn springpots_of_all_orders_and_tolerances() {
    let (inputs, outputs) =
        ([Excitation::Torque(0)], [Quantity::Coordinate(0), Quantity::Element(0, ElementQuantity::Force)]);
    for alpha in [0.05, 0.5, 0.95] {
        let law = format!("law = \"fractional-kelvin-voigt\"\nparameters = {{ k = 50, c = 8, alpha = {alpha} }}");
        let about = linear(&system(&slider(2.0, &law, "", TIME)));
        let mut before = 0;
        for tolerance in [1e-2, 1e-4, 1e-6, 1e-8] {
            let model = model(&about, &inputs, &outputs, tolerance);
            assert!(model.error <= tolerance && is_stable(&model), "{alpha} {tolerance}: {}", model.error);
            assert!(deviation(&about, &model, &inputs, &outputs) <= tolerance, "{alpha} {tolerance}");
            // log(1/tolerance) log(band) to a factor.
            assert!(
                model.states.len() >= before && model.states.len() <= 26,
                "{alpha} {tolerance}: {}",
                model.states.len()
            );
            before = model.states.len();
        }
    }
}

#[test]
fn an_arm_of_six_elements_with_a_closed_loop() {
    let laws = on_joints([
        "law = \"fractional-zener\"\nparameters = { k_e = 40, k_m = 200, c = 15, alpha = 0.4 }",
        "law = \"maxwell\"\nparameters = { k = 300, c = 20 }",
        "network = \"parallel(springpot(c1, a1), springpot(c2, a2), spring(k))\"\n\
         parameters = { c1 = 5, a1 = 0.2, c2 = 3, a2 = 0.8, k = 30 }",
    ]) + "[[element]]\nname = \"strut\"\nfrom = { body = \"column\", point = [0.14, -0.1, 0.08] }\n\
          to = { body = \"forearm\", point = [-0.06, 0.1, 0.08] }\nrest_length = \"70 cm\"\nlaw = \"piezo-kelvin-voigt\"\n\
          parameters = { E_c = 300, E_pz = 900, E_d = 40, alpha = 0.5, alpha_pz = 1e-3 }\ninputs = { U = 1 }\n\
          [[element]]\nname = \"more\"\njoint = \"q1\"\nlaw = \"springpot\"\nparameters = { c = 6, alpha = 0.55 }\n\
          [[element]]\nname = \"other\"\njoint = \"q3\"\nlaw = \"kelvin-voigt\"\nparameters = { k = 20, c = 1 }\n";
    let controller = "[motion.controller]\nkind = \"fractional-pid\"\nkp = { q1 = 40, q2 = 60, q3 = 9 }\nki = 8\nkd = { q1 = 6, q2 = 9, q3 = 1 }\n\
                      lambda = 0.7\nmu = 0.8\nreference = { kind = \"joints\", q1 = 0, q2 = 0.2, q3 = 0.1 }";
    let about = linear(&system(&arm(&laws, &format!("start = {{ q = {{ q2 = 0.2, q3 = 0.1 }} }}\n{controller}"))));
    let inputs = [Excitation::Torque(1), Excitation::Input(3, 0), Excitation::Reference(2)];
    let outputs = [Quantity::Coordinate(2), Quantity::Velocity(0), Quantity::Gripper(Axis::Z)];
    for tolerance in [1e-2, 1e-4, 1e-6] {
        let model = model(&about, &inputs, &outputs, tolerance);
        assert!(model.error <= tolerance && is_stable(&model), "{tolerance}: {}", model.error);
        assert!(deviation(&about, &model, &inputs, &outputs) <= tolerance, "{tolerance}");
        let integrals = model.states.iter().filter(|state| state.kind == StateKind::Inner).count();
        assert!(integrals >= 3, "{:?}", model.states);
    }
}

#[test]
fn models_without_memories_are_exact() {
    let law = "law = \"kelvin-voigt\"\nparameters = { k = 50, c = 4 }";
    let about = linear(&system(&slider(2.0, law, "", TIME)));
    let own = model(&about, &[Excitation::Torque(0)], &[Quantity::Coordinate(0), Quantity::Acceleration(0)], 1e-8);
    assert_eq!(own.a, [[0.0, 1.0], [-25.0, -2.0]]);
    assert_eq!(
        (&own.b, &own.c, &own.d),
        (&vec![vec![0.0], vec![0.5]], &vec![vec![1.0, 0.0], vec![-25.0, -2.0]], &vec![vec![0.0], vec![0.5]])
    );
    assert!(own.error < 1e-13, "{}", own.error);
    // Behind a dashpot there is a stroke of its own.
    let maxwell = linear(&system(&slider(2.0, "law = \"maxwell\"\nparameters = { k = 50, c = 4 }", "", TIME)));
    let own = model(&maxwell, &[Excitation::Torque(0)], &[Quantity::Velocity(0)], 1e-8);
    assert_eq!(own.states.len(), 3);
    let s = Complex64::new(0.0, 7.0);
    let expected = s / (2.0 * s * s + (1.0 / 50.0 + 1.0 / (4.0 * s)).inv());
    assert!((own.frequency_response(7.0)[0][0] - expected).norm() < 1e-13 * expected.norm());
}

#[test]
fn shaken_robots_and_what_is_not_proper() {
    let laws = on_joints([
        "law = \"fractional-kelvin-voigt\"\nparameters = { k = 20, c = 5, alpha = 0.4 }",
        "law = \"kelvin-voigt\"\nparameters = { k = 200, c = 8 }",
        "law = \"fractional-kelvin-voigt\"\nparameters = { k = 60, c = 2, alpha = 0.5 }",
    ]);
    let about = linear(&system(&arm(&laws, "start = { q = { q3 = 0.2 } }\nprescribed = { q2 = \"0.3 + 0*t\" }")));
    let (inputs, outputs) =
        ([Excitation::Motion(1)], [Quantity::Coordinate(2), Quantity::Element(2, ElementQuantity::Force)]);
    let own = model(&about, &inputs, &outputs, 1e-5);
    assert!(own.error <= 1e-5 && deviation(&about, &own, &inputs, &outputs) <= 1e-5, "{}", own.error);
    let ask = |outputs: &[Quantity]| {
        let order = ModelOrder { inputs: &inputs, outputs, band: BAND, tolerance: 1e-4 };
        linearise(&about, &order).map(|model| model.states.len())
    };
    assert_eq!(
        ask(&[Quantity::Coordinate(2), Quantity::Velocity(1)]),
        Err(LineariseError::NotProper { output: 1, input: 0 })
    );
    assert!(matches!(ask(&[Quantity::Time]), Err(LineariseError::Output(_))));
    let wrong =
        |band, tolerance| linearise(&about, &ModelOrder { inputs: &inputs, outputs: &outputs, band, tolerance });
    assert!(matches!(wrong([2.0, 1.0], 1e-4), Err(LineariseError::Order(_))));
    assert!(matches!(wrong(BAND, 0.0), Err(LineariseError::Order(_))));
    assert!(matches!(wrong([1e-9, 1e9], 1e-11), Err(LineariseError::OutOfReach { .. })));
}
