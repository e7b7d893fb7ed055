//! Special cases in elementary functions, recurrences, duplication, monotonicity, symmetry.

use proptest::prelude::*;
use springpot::fractional::gamma::reciprocal_gamma;
use springpot::fractional::mittag_leffler::{Complex64, MittagLeffler, mittag_leffler};

fn value(a: f64, b: f64, z: Complex64) -> Complex64 {
    mittag_leffler(a, b, z).unwrap()
}

fn close(computed: Complex64, exact: Complex64, tolerance: f64, what: &str) {
    let error = (computed - exact).norm();
    assert!(error <= tolerance * exact.norm().max(1e-3), "{what}: {computed} instead of {exact}");
}

/// Points around the origin in all directions.
fn points() -> Vec<Complex64> {
    let radii = [1e-9, 1e-3, 0.1, 0.9, 1.0, 1.1, 3.0, 9.0, 30.0];
    radii.iter().flat_map(|r| (0..24).map(move |k| Complex64::from_polar(*r, 0.261_799 * k as f64))).collect()
}

#[test]
fn elementary_functions_are_special_cases() {
    for z in points() {
        close(value(1.0, 1.0, z), z.exp(), 1e-12, "E_1(z) = e^z");
        close(value(2.0, 1.0, -z * z), z.cos(), 1e-12, "E_2(-z²) = cos z");
        close(value(2.0, 1.0, z * z), z.cosh(), 1e-12, "E_2(z²) = cosh z");
        close(z * value(2.0, 2.0, -z * z), z.sin(), 1e-12, "z E_{2,2}(-z²) = sin z");
        if z.norm() > 0.05 {
            close(value(1.0, 2.0, z), (z.exp() - 1.0) / z, 1e-12, "E_{1,2}(z) = (e^z - 1)/z");
        }
    }
}

/// E_{1,−m}(z) = z^{m+1} e^z and E_{2,1−2m}(−z²) = (−z²)^m cos z: almost all of what other b would have cancels.
#[test]
fn whole_negative_parameters_are_elementary() {
    for z in points() {
        for m in 0..=20u32 {
            let exact = z.powu(m + 1) * z.exp();
            close(value(1.0, -f64::from(m), z), exact, 1e-12, &format!("E_{{1,-{m}}}({z})"));
        }
        for m in 0..=10u32 {
            let square = -z * z;
            let b = 1.0 - 2.0 * f64::from(m);
            close(value(2.0, b, square), square.powu(m) * z.cos(), 1e-12, &format!("E_{{2,{b}}}({square})"));
        }
    }
}

/// dⁿ/dzⁿ z^{m+1} e^z by Leibniz' rule, on the positive axis, where its terms do not cancel, and beside it.
#[test]
fn derivatives_of_whole_negative_parameters() {
    for radius in [0.01, 0.06, 0.3, 1.0, 3.0, 9.0] {
        for angle in [0.0, 0.5, -1.2] {
            let z = Complex64::from_polar(radius, angle);
            for m in [1, 2, 5, 12, 20] {
                for n in [1, 2, 5, 10] {
                    let (mut sum, mut factor) = (Complex64::ZERO, 1.0);
                    for j in 0..=n.min(m + 1) {
                        sum += factor * z.powi(m + 1 - j);
                        // Binomial coefficient times falling factorial.
                        factor *= f64::from(n - j) / f64::from(j + 1) * f64::from(m + 1 - j);
                    }
                    let computed = MittagLeffler::derivative(1.0, -f64::from(m), n as usize).unwrap().complex(z);
                    close(computed, sum * z.exp(), 1e-12, &format!("derivative {n} of E_{{1,-{m}}} at {z}"));
                }
            }
        }
    }
}

/// e^{x²} erfc x for x > 0: the series of positive terms below 1.5, the continued fraction above.
fn scaled_erfc(x: f64) -> f64 {
    let root_pi = std::f64::consts::PI.sqrt();
    if x < 1.5 {
        let (mut term, mut sum) = (x, x);
        for n in 1..60 {
            term *= 2.0 * x * x / (2 * n + 1) as f64;
            sum += term;
        }
        return (x * x).exp() - 2.0 / root_pi * sum;
    }
    let tail = (1..400).rev().fold(x, |tail, k| x + 0.5 * k as f64 / tail);
    1.0 / (root_pi * tail)
}

#[test]
fn order_one_half_is_the_scaled_error_function() {
    let half = MittagLeffler::new(0.5, 1.0).unwrap();
    for k in 0..=240 {
        let x = 10f64.powf(-6.0 + 0.05 * k as f64);
        close(half.real(-x).into(), scaled_erfc(x).into(), 1e-12, &format!("E_½(-{x})"));
    }
    // Where series and careless contours return -5.4e41 and NaN.
    for (a, x, exact) in [
        (0.5, -10.0, 0.056_140_992_743_822_59),
        (0.5, -28.0, 0.020_136_801_964_214_275),
        (0.3, -100.0, 0.007_658_856_222_286_641),
        (0.9, -30.0, 0.003_713_707_698_459_852),
    ] {
        close(value(a, 1.0, Complex64::new(x, 0.0)), exact.into(), 1e-13, "known trap");
    }
}

#[test]
fn relaxations_are_completely_monotone() {
    for a in [0.05, 0.3, 0.5, 0.77, 0.95, 1.0] {
        for b in [a, 1.0, 1.7] {
            for n in 0..=6 {
                let derivative = MittagLeffler::derivative(a, b, n).unwrap();
                // (−1)ⁿ dⁿ/dxⁿ of E(−x) is the n-th derivative of E at −x.
                let values = (0..60).map(|k| derivative.real(-10f64.powf(-3.0 + 0.1 * k as f64)));
                // What is below rounding has no sign.
                let values: Vec<f64> = values.collect();
                let noise = 1e-14 * values[0];
                assert!(values.iter().all(|v| *v > -noise), "a = {a}, b = {b}, n = {n}: {values:?}");
                assert!(values.windows(2).all(|v| v[1] <= v[0] + noise), "a = {a}, b = {b}, n = {n}: {values:?}");
            }
        }
    }
}

#[test]
fn slices_and_single_arguments_agree_to_the_bit() {
    let x: Vec<f64> = (0..101).map(|k| -10f64.powf(-4.0 + 0.1 * k as f64)).chain([0.0, 2.0, f64::NAN, -1.0]).collect();
    for (a, b, n) in
        [(0.5, 1.0, 0), (1.0, 1.0, 0), (1.7, 1.0, 0), (0.5, 1.0, 2), (0.5, 1.0, 6), (0.7, -3.5, 0), (0.7, -3.5, 3)]
    {
        let function = MittagLeffler::derivative(a, b, n).unwrap();
        let mut values = vec![0.0; x.len()];
        function.real_into(&x, &mut values);
        let z: Vec<Complex64> = x.iter().map(|x| Complex64::new(*x, 0.0)).collect();
        let mut complex = vec![Complex64::ZERO; x.len()];
        function.complex_into(&z, &mut complex);
        for k in 0..x.len() {
            assert_eq!(values[k].to_bits(), function.real(x[k]).to_bits(), "x = {}", x[k]);
            assert_eq!(values[k].to_bits(), complex[k].re.to_bits(), "x = {}", x[k]);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, rng_seed: proptest::test_runner::RngSeed::Fixed(5), ..ProptestConfig::default() })]

    #[test]
    fn recurrence_duplication_derivative_and_symmetry(
        a in 0.05f64..2.0,
        b in -2.0f64..4.0,
        radius in -2.0f64..1.5,
        angle in -3.2f64..3.2,
        n in 0usize..4,
    ) {
        let z = Complex64::from_polar(10f64.powf(radius), angle);
        let e = value(a, b, z);
        // Where it overflows there is nothing to compare.
        prop_assume!(e.is_finite() && e.norm() < 1e200);
        let scale = |terms: &[Complex64]| terms.iter().map(|t| t.norm()).fold(1e-3, f64::max);

        let next = z * value(a, a + b, z);
        let sum = next + reciprocal_gamma(b);
        prop_assert!((e - sum).norm() <= 1e-11 * scale(&[e, next]), "E = 1/Γ(b) + z E: {} {}", e, sum);

        let (minus, twice) = (value(a, b, -z), 2.0 * value(2.0 * a, b, z * z));
        prop_assume!(minus.is_finite());
        prop_assert!((e + minus - twice).norm() <= 1e-11 * scale(&[e, minus]), "duplication: {} {}", e + minus, twice);

        let derivative = |n: usize, b: f64| MittagLeffler::derivative(a, b, n).unwrap().complex(z);
        // The n-th derivative of a z E' = E_{a,b−1} − (b − 1) E.
        let left = a * z * derivative(n + 1, b) + a * n as f64 * derivative(n, b);
        let right = [derivative(n, b - 1.0), (b - 1.0) * derivative(n, b)];
        prop_assert!((left - right[0] + right[1]).norm() <= 1e-11 * scale(&right), "derivative {}: {}", n, left);

        let conjugate = value(a, b, z.conj());
        prop_assert!((conjugate.conj() - e).norm() <= 1e-14 * scale(&[e]), "{} {}", conjugate, e);
    }
}
