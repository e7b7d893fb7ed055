//! The memory's mean over a step against closed forms.

use springpot::collocation::Nodes;
use springpot::fractional::gamma::gamma;
use springpot::fractional::{Form, Kind, Memory, RatePolynomial, StepStart};

/// Steps of uneven size; strokes x = x(0) + 3t, for which the constant rate is exact.
fn steps() -> Vec<f64> {
    (0..400).map(|k| 1e-3 * (1.5 + (0.7 * f64::from(k)).sin())).collect()
}

/// Mean over t … t + h of t^−power/Γ(1−power): (t_1^{1−power} − t^{1−power})/(h Γ(2−power)).
fn mean_of_power(t: f64, h: f64, power: f64) -> f64 {
    ((t + h).powf(1.0 - power) - t.powf(1.0 - power)) / (h * gamma(2.0 - power))
}

#[test]
fn the_mean_is_exact_for_straight_strokes() {
    for alpha in [0.0, 0.1, 0.5, 0.9, 0.99, 1.0] {
        for kind in [Kind::Caputo, Kind::RiemannLiouville] {
            let origin = 0.2;
            let mut memory = Memory::new(alpha, kind, origin, origin, 1e-10, 1e-4, 10.0).unwrap();
            let mut t = 0.0;
            for h in steps() {
                let start = StepStart { t, h, stroke: origin + 3.0 * t, rate: 3.0 };
                let middle = 3.0 * 0.5 * h;
                // D^alpha of 3t is 3 t^{1−alpha}/Γ(2−alpha).
                let mut expected = 3.0 * mean_of_power(t, h, alpha - 1.0);
                if kind == Kind::RiemannLiouville && alpha < 1.0 {
                    expected += origin * mean_of_power(t, h, alpha);
                }
                for form in [Form::Rates, Form::Strokes] {
                    let affine = memory.respond(&start, Nodes::Midpoint, form);
                    let mut mean = affine.stroke[0][0] * middle + affine.rate[0][0] * 3.0 + affine.history[0];
                    // The singular share is its value in the middle, or its mean.
                    mean +=
                        memory.singular_moments(&start, Nodes::Midpoint, None)[0] - memory.singular_part(t + 0.5 * h);
                    let error = (mean - expected).abs() / expected;
                    assert!(error < 3e-10, "{alpha} {kind:?} {form:?} at {t}: {mean} {expected} {error:e}");
                }
                memory.commit(&RatePolynomial::cubic(h, [3.0, 0.0, 0.0, 0.0]));
                t += h;
            }
        }
    }
}

/// Σ h F u of any rates is not negative: the work of a closed history that begins unloaded.
#[test]
fn the_work_of_the_mean_is_never_negative() {
    for alpha in [0.02, 0.3, 0.7, 0.98] {
        let mut memory = Memory::new(alpha, Kind::Caputo, 0.0, 0.0, 1e-8, 1e-4, 100.0).unwrap();
        let (h, mut work, mut stroke) = (1e-2, 0.0, 0.0);
        for k in 0..3000 {
            // What changes its sign in every step is the worst for a rule that looks at the middle.
            let rate = if k % 2 == 0 { 1.0 } else { -1.0 } * (1.0 + 0.5 * f64::from(k).sin());
            let start = StepStart { t: f64::from(k) * h, h, stroke, rate };
            let affine = memory.respond(&start, Nodes::Midpoint, Form::Rates);
            work += h * rate * (affine.rate[0][0] * rate + affine.history[0]);
            assert!(work > 0.0, "{alpha}: {work} after step {k}");
            memory.commit(&RatePolynomial::cubic(h, [rate, 0.0, 0.0, 0.0]));
            stroke += h * rate;
        }
    }
}
