//! Runs whose rows lie on the kinks of motions and inputs, against closed forms.

use crate::slider;
use springpot::fractional::gamma::reciprocal_gamma;

/// D^alpha of p!·(t − k)^p₊/p!·slope, p = 1 or 2.
fn power(alpha: f64, p: i32, s: f64) -> f64 {
    let factorial = f64::from(p);
    if s <= 0.0 { 0.0 } else { factorial * s.powf(f64::from(p) - alpha) * reciprocal_gamma(f64::from(p) + 1.0 - alpha) }
}

const ORDERS: [f64; 5] = [0.1, 0.5, 0.9, 0.99, 0.999];

#[test]
fn rows_on_the_kinks_of_a_motion() {
    for alpha in ORDERS {
        // A ramp between two rests.
        let run = slider::springpot(alpha, "0.3*max(0, min(1, t - 1))", 4.0, 0.125);
        let exact = |t: f64| 0.3 * (power(alpha, 1, t - 1.0) - power(alpha, 1, t - 2.0));
        assert!(slider::largest_error(&run, 4.0, 0.125, exact) < 1e-10, "alpha {alpha}");
        // Two signals of the same expression turn within one bit of t = 1.
        let run = slider::springpot(alpha, "0.3*max(0, t - 1)*min(1, max(0, 2 - t))", 4.0, 0.125);
        let exact = |t: f64| {
            let rising = power(alpha, 1, t - 1.0) - power(alpha, 2, t - 1.0);
            0.3 * (rising + power(alpha, 1, t - 2.0) + power(alpha, 2, t - 2.0))
        };
        assert!(slider::largest_error(&run, 4.0, 0.125, exact) < 1e-10, "alpha {alpha}");
        // The last row lies on a kink.
        let run = slider::springpot(alpha, "0.3*abs(t - 2)", 2.0, 0.25);
        assert!(slider::largest_error(&run, 2.0, 0.25, |t| -0.3 * power(alpha, 1, t)) < 1e-10, "alpha {alpha}");
    }
}

#[test]
fn impulses_are_booked_in_the_row_on_the_kink() {
    for alpha in [0.1, 0.5, 0.9] {
        let run = slider::springpot(alpha, "0.3*max(0, min(1, t - 1))", 4.0, 0.5);
        // The slider of 1 kg is stopped at t = 2: 45 mJ.
        for (t, residual) in run.column("t").iter().zip(run.column("energy.residual")) {
            assert!(residual.abs() < 1e-6, "alpha {alpha}, t = {t}: {residual}");
        }
        assert!(run.report.energy_residual.unwrap() < 1e-6);
    }
}

#[test]
fn rows_on_the_jump_of_an_input() {
    for alpha in ORDERS {
        let run = |u: &str| {
            let element = format!(
                "law = \"magnetorheological\"\ninputs = {{ u = \"{u}\" }}\n\
                 parameters = {{ E_c = 2.0, mu_0 = 3.0, mu = 5.0, alpha = {alpha} }}"
            );
            slider::with(&element, "0.3*sin(2*t)", 2.0, 0.25)
        };
        let (plain, jumping) = (run("1 + 0*t"), run("step(t - 1)"));
        assert!(plain.error.is_none() && jumping.error.is_none());
        let derivative = plain.column("e.derivative");
        let largest = derivative.iter().fold(0.0f64, |m, d| m.max(d.abs()));
        for (k, t) in jumping.column("t").into_iter().enumerate() {
            let at = |name: &str| jumping.column(name)[k];
            assert!((at("e.derivative") - derivative[k]).abs() < 1e-10 * largest, "alpha {alpha}, t = {t}");
            let c = if t < 1.0 { 3.0 } else { 8.0 };
            assert!((at("e.force") - 2.0 * at("e.stroke") - c * at("e.derivative")).abs() < 1e-12);
            // What the jump adds to the stored energy is supplied in the same row.
            assert!(at("energy.residual").abs() < 1e-6, "alpha {alpha}, t = {t}: {}", at("energy.residual"));
        }
    }
}

#[test]
fn a_short_ramp_after_a_long_rest_is_run() {
    // Nothing is turned over before the ramp, and at alpha near 1 the power jumps.
    for alpha in ORDERS {
        let run = slider::springpot(alpha, "0.3*max(0, min(0.001, t - 1.0003))", 4.0, 0.125);
        let exact = |t: f64| 0.3 * (power(alpha, 1, t - 1.0003) - power(alpha, 1, t - 1.0003 - 0.001));
        assert!(slider::largest_error(&run, 4.0, 0.125, exact) < 1e-11, "alpha {alpha}");
    }
}
