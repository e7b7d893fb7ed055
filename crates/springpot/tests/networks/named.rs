//! The laws that are networks by name, from the scenario's side, with the tolerance that everybody has: against closed forms.

use crate::departure;
use crate::pasts::slider;
use springpot::fractional::mittag_leffler::{Complex64, MittagLeffler};

const ORDERS: [f64; 4] = [0.2, 0.5, 0.8, 0.95];

/// Largest error, in units of the largest force.
const ALLOWED: f64 = 1e-9;

fn law(name: &str, parameters: &str, past: &str) -> String {
    format!("law = \"{name}\"\nparameters = {{ {parameters} }}\n{past}")
}

/// k E_{α,b}(−(t/τ)^α) t^{b−1} + e t^{b−1}: relaxation (b = 1) and what a ramp makes of it (b = 2).
fn relaxed(alpha: f64, b: f64, [stiffness, rest]: [f64; 2], slow: f64, t: f64) -> f64 {
    let decay = MittagLeffler::new(alpha, b).unwrap().real(-t.powf(alpha) / slow);
    (stiffness * decay + rest) * t.powf(b - 1.0)
}

/// Ramps and steps: relaxing stiffness, what remains, and τ^α.
#[test]
fn ramps_and_steps_are_mittag_leffler_functions() {
    let mut worst = 0.0f64;
    for alpha in ORDERS {
        let remaining = 90.0 * 25.0 / 115.0;
        for (name, parameters, stiffness, slow) in [
            ("fractional-maxwell", "k = 90, c = 40", [90.0, 0.0], 40.0 / 90.0),
            ("fractional-zener", "k_e = 25, k_m = 90, c = 40", [90.0, 25.0], 40.0 / 90.0),
            ("poynting-thomson", "k_1 = 90, k_2 = 25, c = 40", [90.0 - remaining, remaining], 40.0 / 115.0),
        ] {
            for (motion, b, past) in [("0.3*t", 2.0, ""), ("0.3", 1.0, "past = \"unloaded\"")] {
                let run = slider(&law(name, &format!("{parameters}, alpha = {alpha}"), past), motion, 2.0);
                let exact = run.t().into_iter().map(|t| 0.3 * relaxed(alpha, b, stiffness, slow, t));
                let error = departure(&run.column("e.force"), &exact.collect::<Vec<_>>());
                assert!(error < ALLOWED, "{name} {alpha} {motion}: {error:e} in {} steps", run.effort());
                worst = worst.max(error);
            }
        }
    }
    println!("worst {worst:e}");
}

/// The classical laws are those of order 1.
#[test]
fn the_classical_laws_are_limits() {
    for (fractional, classical, parameters) in [
        ("fractional-maxwell", "maxwell", "k = 90, c = 40"),
        ("fractional-zener", "zener", "k_e = 25, k_m = 90, c = 40"),
        ("fractional-burgers", "burgers", "k_1 = 90, c_1 = 40, k_2 = 25, c_2 = 10"),
    ] {
        let orders = if fractional.ends_with("burgers") { "alpha_1 = 1, alpha_2 = 1" } else { "alpha = 1" };
        let motion = "0.05*sin(7*t) + 0.1*t";
        let limit = slider(&law(fractional, &format!("{parameters}, {orders}"), ""), motion, 2.0);
        let plain = slider(&law(classical, parameters, ""), motion, 2.0);
        let error = departure(&limit.column("e.force"), &plain.column("e.force"));
        assert!(error < 1e-12, "{fractional}: {error:e}");
    }
}

/// A steady sine, by the complex modulus.
#[test]
fn every_named_law_has_its_complex_modulus() {
    let omega = std::f64::consts::TAU * 1.5;
    let s = Complex64::new(0.0, omega);
    let series = |parts: &[Complex64]| parts.iter().map(Complex64::inv).sum::<Complex64>().inv();
    let k = |k: f64| Complex64::from(k);
    let mut worst = 0.0f64;
    let mut check = |name: &str, parameters: &str, modulus: Complex64| {
        let past = "past = \"steady\"\nperiod = \"2/3 s\"".replace("\"2/3 s\"", &format!("{}", 2.0 / 3.0));
        let run = slider(&law(name, parameters, &past), "0.1*sin(3*pi*t)", 2.0);
        let exact = run.t().into_iter().map(|t| (modulus * 0.1 * (s * t).exp()).im);
        let error = departure(&run.column("e.force"), &exact.collect::<Vec<_>>());
        assert!(error < ALLOWED, "{name} {parameters}: {error:e} in {} steps", run.effort());
        worst = worst.max(error);
    };
    for alpha in ORDERS {
        let c = |c: f64, alpha: f64| c * s.powf(alpha);
        let order = format!("alpha = {alpha}");
        let of = |parameters: &str| format!("{parameters}, {order}");
        check("fractional-maxwell", &of("k = 90, c = 40"), series(&[k(90.0), c(40.0, alpha)]));
        check("fractional-zener", &of("k_e = 25, k_m = 90, c = 40"), k(25.0) + series(&[k(90.0), c(40.0, alpha)]));
        check("poynting-thomson", &of("k_1 = 90, k_2 = 25, c = 40"), series(&[k(90.0), k(25.0) + c(40.0, alpha)]));
        let other = 1.1 - alpha;
        check(
            "fractional-burgers",
            &format!("k_1 = 90, c_1 = 40, alpha_1 = {alpha}, k_2 = 25, c_2 = 10, alpha_2 = {other}"),
            series(&[k(90.0), c(40.0, alpha), k(25.0) + c(10.0, other)]),
        );
    }
    let c = |c: f64| c * s;
    check("maxwell", "k = 90, c = 4", series(&[k(90.0), c(4.0)]));
    check("zener", "k_e = 25, k_m = 90, c = 4", k(25.0) + series(&[k(90.0), c(4.0)]));
    check("burgers", "k_1 = 90, c_1 = 4, k_2 = 25, c_2 = 2", series(&[k(90.0), c(4.0), k(25.0) + c(2.0)]));
    check("jeffreys", "c_1 = 4, k = 25, c_2 = 2", series(&[c(4.0), k(25.0) + c(2.0)]));
    let term = |stiffness: f64, tau: f64| series(&[k(stiffness), c(stiffness * tau)]);
    check("prony", "k_e = 5, k = [90, 30], tau = [0.1, 2]", k(5.0) + term(90.0, 0.1) + term(30.0, 2.0));
    println!("worst {worst:e}");
}

/// At ω = 0 what is left is what stays: springs that no damper relieves.
#[test]
fn at_rest_the_modulus_is_what_remains() {
    use springpot::law::{Catalog, Derivative, InputValue, Point};
    let at = Point { t: 0.0, stroke: 0.0, rate: 0.0, inputs: &[InputValue { value: 0.0, rate: 0.0 }] };
    let remaining = [
        ("maxwell", &[90.0, 4.0][..], 0.0),
        ("fractional-zener", &[25.0, 90.0, 40.0, 0.4], 25.0),
        ("poynting-thomson", &[90.0, 25.0, 40.0, 0.4], 90.0 * 25.0 / 115.0),
        ("fractional-burgers", &[90.0, 40.0, 0.4, 25.0, 10.0, 0.6], 0.0),
        ("jeffreys", &[4.0, 25.0, 2.0], 0.0),
    ];
    for (name, parameters, stiffness) in remaining {
        let law = Catalog::standard().get(name).unwrap().build(parameters, Derivative::Caputo).unwrap();
        let [stored, lost] = law.complex_modulus(&at, 0.0);
        assert!((stored - stiffness).abs() < 1e-12 && lost == 0.0, "{name}: {stored} {lost}");
        let near = law.complex_modulus(&at, 1e-30);
        assert!((near[0] - stiffness).abs() < 1e-6, "{name}: {near:?}");
    }
}
