//! Forward runs hold their tolerance from a nanometre to a kilometre.

use crate::support::forward::{at, largest, slider, state};
use crate::support::{Run, run};

/// Distance of the slider's anchor, m.
fn anchor(x: f64) -> f64 {
    f64::max(8.0, 16.0 * x)
}

/// A vibration of amplitude `x` on `k`, `c`, of 1 kg.
fn vibration(x: f64, k: f64, c: f64, derivative: &str, solver: &str) -> Run {
    let law = format!(
        "law = \"fractional-kelvin-voigt\"\nparameters = {{ k = {k:e}, c = {c:e}, alpha = 0.5 }}\nderivative = \"{derivative}\""
    );
    let slider = slider("1", 0.0, &law, &state(&format!("{x:e}"), "0"));
    let slider = slider.replace("0, 8]", &format!("0, {}]", anchor(x))).replace("= 8\n", &format!("= {}\n", anchor(x)));
    run(&(slider + &at("2", "0, 0.1, 0.3, 1, 2", 1e-9) + solver))
}

#[test]
fn amplitudes_from_a_nanometre_to_a_kilometre_err_alike() {
    for derivative in ["caputo", "riemann-liouville"] {
        let unit = vibration(0.1, 1000.0, 20.0, derivative, "");
        let expected = unit.column("q.q");
        for x in [1e-9, 1e-7, 1e-5, 1e-3, 10.0, 1e3] {
            let run = vibration(x, 1000.0, 20.0, derivative, "");
            let errors =
                run.column("q.q").iter().zip(&expected).map(|(q, unit)| q / x - unit / 0.1).collect::<Vec<_>>();
            // Strokes are rounded to 2e-16 of the anchor's distance.
            let allowed = 2e-8 + 2e-16 * anchor(x) / x;
            assert!(largest(errors.iter().copied()) < allowed, "{derivative} {x}: {errors:?}");
            assert!(run.report.steps < 2 * unit.report.steps, "{x}: {} {}", run.report.steps, unit.report.steps);
        }
    }
}

#[test]
fn ten_nanometres_on_a_stiff_bearing() {
    // 1e9 N/m under a step of 10 N: x = (1 − cos ωt) F/k without damping.
    let law = "law = \"spring\"\nparameters = { k = 1e9 }";
    let text = slider("1", -10.0, law, &state("0", "0")) + &at("0.01", "0.001, 0.0033, 0.01", 1e-9);
    let (omega, run) = (1e9f64.sqrt(), run(&text));
    for (t, x) in run.column("t").into_iter().zip(run.column("q.q")) {
        let right = -1e-8 * (1.0 - (omega * t).cos());
        // 8 m away, a stroke is rounded to 1e-15 m, which is 1e-7 of it.
        assert!((x - right).abs() < 2e-6 * 1e-8, "{t}: {x:e} {right:e}");
    }
}

#[test]
fn an_absolute_tolerance_is_a_floor() {
    let strict = vibration(1e-7, 1000.0, 20.0, "caputo", "");
    let loose = vibration(1e-7, 1000.0, 20.0, "caputo", "atol = 1e-13\n");
    assert!(loose.report.steps < strict.report.steps / 2, "{} {}", loose.report.steps, strict.report.steps);
}
