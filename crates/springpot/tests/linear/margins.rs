//! Margins against closed forms.

use crate::support::system;
use crate::{arm, linear};
use num_complex::Complex64;
use springpot::linear::{Linearisation, Margins};
use std::f64::consts::{PI, TAU};

/// A slider without a spring under a controller, of 2 kg, with `damping`.
fn slider(damping: f64, motion: &str) -> Linearisation {
    linear(&system(&format!(
        "[robot]\ngravity = [0, 0, 0]\n[[robot.body]]\nname = \"b\"\nmass = 2\n\
         joint = {{ name = \"x\", kind = \"prismatic\", axis = [1, 0, 0], origin = [0, 0, 0], damping = {damping:?} }}\n\
         [motion]\nkind = \"forward\"\n{motion}\n[time]\nend = 1\noutput_step = 0.5\n"
    )))
}

fn controlled(damping: f64, gains: &str) -> Margins {
    let reference = "reference = { kind = \"joints\", x = 0 }";
    let about = slider(damping, &format!("[motion.controller]\nkind = \"pid\"\n{gains}\n{reference}"));
    about.loop_gain(0).unwrap().margins().unwrap()
}

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * b.abs().max(1e-3)
}

#[test]
fn proportional_and_derivative_of_a_double_integrator() {
    // L = (kd s + kp)/(m s²): |L| = 1 where m² ω⁴ = kd² ω² + kp².
    let (m, kp, kd) = (2.0f64, 50.0f64, 8.0f64);
    let margins = controlled(0.0, "kp = 50\nki = 0\nkd = 8");
    let square = (kd * kd + (kd.powi(4) + 4.0 * m * m * kp * kp).sqrt()) / (2.0 * m * m);
    let omega = square.sqrt();
    let lag = (kd * omega).atan2(kp);
    let (phase, at) = margins.phase.unwrap();
    assert!(same(phase, lag) && same(at, omega), "{margins:?} {lag} {omega}");
    assert!(same(margins.delay.unwrap(), lag / omega) && margins.gain.is_none() && !margins.is_unstable, "{margins:?}");
    // |S|² = m² ω⁴/((kp − m ω²)² + kd² ω²) is largest where 2 kp² = (2 m kp − kd²) ω².
    let best = 2.0 * kp * kp / (2.0 * m * kp - kd * kd);
    let peak = m * best / ((kp - m * best).powi(2) + kd * kd * best).sqrt();
    assert!(same(margins.sensitivity.0, peak), "{margins:?} {peak}");
    assert!((margins.sensitivity.1.unwrap() / best.sqrt() - 1.0).abs() < 1e-6, "{margins:?}");
}

#[test]
fn a_lag_and_a_chain_of_integrators() {
    // By velocity feedback of a damped mass L = k/(m s + d): |L| = 1 at ω = √(k² − d²)/m, never real.
    let lag = |gain: f64| {
        let about = slider(3.0, &format!("torque = {{ x = \"-{gain:?}*v.x\" }}"));
        about.loop_gain(0).unwrap().margins().unwrap()
    };
    let margins = lag(5.0);
    let omega = 4.0 / 2.0;
    let expected = PI - (2.0f64 * omega).atan2(3.0);
    let (phase, at) = margins.phase.unwrap();
    assert!(same(phase, expected) && same(at, omega) && margins.gain.is_none(), "{margins:?}");
    assert!(same(margins.delay.unwrap(), expected / omega), "{margins:?}");
    assert!((margins.sensitivity.0 - 1.0).abs() < 1e-9 && margins.sensitivity.1.is_none(), "{margins:?}");
    let never = lag(2.0);
    assert_eq!((never.phase, never.gain, never.delay), (None, None, None));
    // L = ki/(s² (m s + d)) has too much lag at all frequencies; L = (kp s + ki)/(s² (m s + d)) has not.
    let unstable = controlled(3.0, "kp = 0\nki = 10\nkd = 0");
    assert!(unstable.is_unstable && unstable.phase.unwrap().0 > PI, "{unstable:?}");
    // L = (kd s² + kp s + ki)/(s² (m s + d)) with kd = 0: real where atan(kp ω/ki) = atan(m ω/d), nowhere but at 0.
    let stable = controlled(3.0, "kp = 20\nki = 10\nkd = 0");
    let loop_gain = |omega: f64| {
        let s = Complex64::new(0.0, omega);
        (20.0 * s + 10.0) / (s * s * (2.0 * s + 3.0))
    };
    let (phase, at) = stable.phase.unwrap();
    assert!(!stable.is_unstable && same(loop_gain(at).norm(), 1.0), "{stable:?}");
    assert!(same(phase, (loop_gain(at).arg() + PI).rem_euclid(TAU)) && stable.gain.is_none(), "{stable:?}");
}

#[test]
fn a_gain_that_may_rise_so_far() {
    // L = k/(s (m s + d)) · 1/(τ s + 1), the lag by a spring and a dashpot in series: here the integral of a mass with two dampers.
    // L = ki/(s (m s² + d s + k)): real at ω = √(k/m), where |L| = ki/(d k/m).
    let reference = "reference = { kind = \"joints\", x = 0 }";
    let text = crate::slider(
        2.0,
        "law = \"kelvin-voigt\"\nparameters = { k = 50, c = 4 }",
        &format!("[motion.controller]\nkind = \"pid\"\nkp = 0\nki = 30\nkd = 0\n{reference}"),
        "[time]\nend = 1\noutput_step = 0.5",
    );
    let about = linear(&system(&text));
    let margins = about.loop_gain(0).unwrap().margins().unwrap();
    let (factor, at) = margins.gain.unwrap();
    assert!(same(factor, 4.0 * 25.0 / 30.0) && same(at, 5.0), "{margins:?}");
    assert!(!margins.is_unstable);
    // Just beyond it the loop is unstable.
    let beyond = system(&text.replace("ki = 30", "ki = 100.001"));
    assert!(linear(&beyond).loop_gain(0).unwrap().margins().unwrap().is_unstable);
}

#[test]
fn the_closed_loop_has_its_determinant() {
    // det T_closed = det T_open (1 + L), whatever other loops do: at an eigenvalue of the closed loop 1 + L = 0.
    let controller = "[motion.controller]\nkind = \"fractional-pid\"\nkp = { q1 = 40, q2 = 60, q3 = 9 }\nki = 8\nkd = { q1 = 6, q2 = 9, q3 = 1 }\n\
                      lambda = 0.7\nmu = 0.8\nreference = { kind = \"joints\", q1 = 0, q2 = 0.2, q3 = 0.1 }";
    let about = linear(&system(&arm("", &format!("start = {{ q = {{ q2 = 0.2, q3 = 0.1 }} }}\n{controller}"))));
    for k in 0..3 {
        let gain = about.loop_gain(k).unwrap();
        let margins = gain.margins().unwrap();
        let (phase, at) = margins.phase.unwrap();
        let own = gain.at(at);
        assert!(same(own.norm(), 1.0) && same((own.arg() + PI).rem_euclid(TAU), phase), "{k}: {margins:?}");
        // Scaling the loop by the factor of the gain margin brings it to −1.
        if let Some((factor, at)) = margins.gain {
            assert!((factor * gain.at(at) + 1.0).norm() < 1e-9, "{k}: {margins:?}");
        }
        assert!((1.0 + gain.at(margins.sensitivity.1.unwrap())).norm().recip() / margins.sensitivity.0 - 1.0 < 1e-12);
    }
    assert!(about.loop_gain(7).is_none());
}
