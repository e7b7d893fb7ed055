//! What the papers say about their results, shown with the shipped scenarios.

mod support;

use springpot_scenario::{Cases, SweptValue};
use std::f64::consts::PI;
use support::truth::pair_at;
use support::{Run, largest, relative_difference, run_case, shipped};

/// Largest and smallest value.
fn range(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)))
}

/// Root mean square of what a straight line leaves of y, for t > `from`.
fn detrended_rms(t: &[f64], y: &[f64], from: f64) -> f64 {
    let points: Vec<(f64, f64)> = t.iter().copied().zip(y.iter().copied()).filter(|(t, _)| *t > from).collect();
    let count = points.len() as f64;
    let mean = points.iter().fold((0.0, 0.0), |(t, y), p| (t + p.0 / count, y + p.1 / count));
    let covariance: f64 = points.iter().map(|p| (p.0 - mean.0) * (p.1 - mean.1)).sum();
    let variance: f64 = points.iter().map(|p| (p.0 - mean.0).powi(2)).sum();
    let slope = covariance / variance;
    let rest: f64 = points.iter().map(|p| (p.1 - mean.1 - slope * (p.0 - mean.0)).powi(2)).sum();
    (rest / count).sqrt()
}

/// Every case of a scenario with the first of its swept values as a number.
fn by_number(cases: &Cases) -> Vec<(f64, Run)> {
    let first = |index: usize| match cases.values(index)[0] {
        SweptValue::Number(number) => number,
        ref other => panic!("{other:?} is no number"),
    };
    let each = (0..cases.len()).map(|index| (first(index), run_case(cases, index)));
    each.inspect(|(_, run)| assert!(run.error.is_none(), "{:?}", run.error)).collect()
}

#[test]
fn lower_order_smaller_swing() {
    let runs = by_number(&shipped("thermoviscoelastic_order.toml", &[]));
    // Detrended rms of Q₂ for t > 2 s, N·m, from an independent program on its own grid.
    let reference = [(0.1, 1.02), (0.3, 1.30), (0.5, 1.70), (0.7, 2.29), (0.9, 3.19), (1.0, 3.82)];
    assert_eq!(runs.len(), reference.len());
    let mut last = 0.0;
    for ((alpha, run), (order, wanted)) in runs.iter().zip(reference) {
        assert_eq!(*alpha, order);
        let swing = detrended_rms(&run.t(), &run.column("strut.Q.q2"), 2.0);
        println!("alpha = {alpha}: {swing:.4} N m, reference {wanted}");
        assert!((swing - wanted).abs() < 0.02 * wanted, "alpha = {alpha}: {swing}, not {wanted}");
        assert!(swing > last, "alpha = {alpha}");
        last = swing;
    }
}

#[test]
fn warmth_lowers_the_generalized_force() {
    let cases = shipped("thermoviscoelastic_temperature.toml", &[]);
    let system = cases.plan(0).unwrap().system();
    let runs = by_number(&cases);
    assert_eq!(runs.iter().map(|(kelvin, _)| *kelvin).collect::<Vec<_>>(), [273.15, 293.15, 313.15, 333.15]);
    for pair in runs.windows(2) {
        let [(cold, colder), (warm, warmer)] = pair else { unreachable!() };
        let rows = colder.t().into_iter().zip(colder.column("strut.Q.q2")).zip(warmer.column("strut.Q.q2"));
        for ((t, q), warmer_q) in rows {
            assert!(warmer_q < q, "t = {t}: Q₂ = {warmer_q} at {warm} K, {q} at {cold} K");
            // dQ₂/dT = a_kv·E_kv·∂l/∂q₂, and ∂l/∂q₂ < 0.
            let (_, _, gradient) = pair_at(&system, &system.elements[0], t);
            let fall = (q - warmer_q) / (warm - cold);
            assert!((fall + 0.0140 * gradient[1]).abs() < 2e-11, "t = {t}: {fall} N m/K, ∂l/∂q₂ = {}", gradient[1]);
        }
    }
}

/// Smallest and largest Q₂ for t > `from` of every order.
fn ranges(file: &str, column: &str, derivative: &str, from: f64) -> Vec<(f64, f64, f64)> {
    let element = column.split('.').next().unwrap();
    let set = format!("element.{element}.derivative={derivative}");
    let runs = by_number(&shipped(file, &[&set]));
    let late = |run: &Run| -> Vec<f64> {
        run.t().iter().zip(run.column(column)).filter(|(t, _)| **t > from).map(|(_, q)| q).collect()
    };
    let range_of = |(alpha, run): &(f64, Run)| {
        let (low, high) = range(&late(run));
        println!("{file}, {derivative}, alpha = {alpha}, t > {from} s: Q₂ from {low:.2} to {high:.2} N m");
        (*alpha, low, high)
    };
    runs.iter().map(range_of).collect()
}

#[test]
fn fractional_orders_reach_values_that_order_one_does_not() {
    for (file, column) in [("magnetorheological_order.toml", "damper.Q.q2"), ("piezo_order.toml", "stack.Q.q2")] {
        // As the papers define the derivative every order below 1 does, for its force is large after the start.
        let all = ranges(file, column, "riemann-liouville", 0.0);
        let whole = all.iter().find(|(alpha, ..)| *alpha == 1.0).unwrap();
        for (alpha, low, high) in all.iter().filter(|(alpha, ..)| *alpha < 1.0) {
            assert!(*high > whole.2 + 1.0 || *low < whole.1 - 1.0, "{file}, alpha = {alpha}: {low} … {high}");
        }
        // Without the start, and for elements held at x(0) before, the low orders still do.
        for derivative in ["riemann-liouville", "caputo"] {
            let all = ranges(file, column, derivative, 1.0);
            let whole = all.iter().find(|(alpha, ..)| *alpha == 1.0).unwrap();
            let beyond =
                |(alpha, low, high): &&(f64, f64, f64)| *alpha < 1.0 && (*high > whole.2 + 1.0 || *low < whole.1 - 1.0);
            let orders: Vec<f64> = all.iter().filter(beyond).map(|(alpha, ..)| *alpha).collect();
            println!("{file}, {derivative}: orders {orders:?} reach beyond order 1 after the first second");
            assert!(!orders.is_empty(), "{file}, {derivative}");
        }
    }
}

/// Amplitude of the share of y at `frequency`, Hz; the rows must be evenly spaced over whole seconds.
fn fourier(t: &[f64], y: &[f64], frequency: f64) -> f64 {
    let count = y.len() as f64;
    let mean = y.iter().sum::<f64>() / count;
    let sum = |wave: fn(f64) -> f64| -> f64 {
        t.iter().zip(y).map(|(t, y)| (y - mean) * wave(2.0 * PI * frequency * t)).sum::<f64>() * 2.0 / count
    };
    sum(f64::sin).hypot(sum(f64::cos))
}

#[test]
fn the_piezo_ripple_has_eight_hertz_and_its_amplitude() {
    for alpha in ["0.1", "0.5", "0.9"] {
        let set = format!("element.stack.alpha={alpha}");
        // 0 V, 60 sin(2π·8 t) V, 120 sin(2π·8 t) V.
        // The ripple is the difference of two runs: each has to be as good as it.
        let cases = shipped("piezo_voltage.toml", &[&set, "solver.rtol=1e-10"]);
        let [silent, sixty, double] = [0, 1, 2].map(|index| run_case(&cases, index));
        let rest = silent.column("stack.Q.q2");
        let system = cases.plan(0).unwrap().system();
        let gradient: Vec<f64> = silent.t().iter().map(|t| pair_at(&system, &system.elements[0], *t).2[1]).collect();
        for (run, volts) in [(&sixty, 60.0), (&double, 120.0)] {
            assert_eq!(run.rows.len(), 1251);
            let t = run.t();
            let ripple: Vec<f64> = run.column("stack.Q.q2").iter().zip(&rest).map(|(a, b)| a - b).collect();
            // Q₂ = −F ∂l/∂q₂ and F holds −alpha_pz·E_pz·U.
            let wanted: Vec<f64> =
                t.iter().zip(&gradient).map(|(t, g)| 1e-5 * 3000.0 * volts * (2.0 * PI * 8.0 * t).sin() * g).collect();
            let error = ripple.iter().zip(&wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(error < 1e-11 * largest(&rest), "alpha = {alpha}: {error:e} of {}", largest(&rest));
            let rows = t.len() - 1;
            let coefficients: Vec<f64> = (1..=40).map(|f| fourier(&t[..rows], &ripple[..rows], f64::from(f))).collect();
            let at_eight = coefficients[7];
            let mean_gradient = gradient[..rows].iter().map(|g| g.abs()).sum::<f64>() / (rows as f64);
            let amplitude = 1e-5 * 3000.0 * volts * mean_gradient;
            println!("alpha = {alpha}, {volts} V: {at_eight:.6} N m at 8 Hz, wanted {amplitude:.6}");
            assert!((at_eight / amplitude - 1.0).abs() < 1e-3, "{at_eight} N m at 8 Hz, wanted {amplitude}");
            for (f, other) in (1..=40).zip(&coefficients).filter(|(f, _)| *f != 8) {
                assert!(*other < 0.02 * at_eight, "{other} N m at {f} Hz");
            }
        }
    }
}

#[test]
fn constant_voltage_shifts_and_does_not_ripple() {
    let cases = shipped("piezo_order.toml", &[]);
    // Six orders, each with 60 sin(2π·8 t) V and 60 V.
    assert_eq!(cases.len(), 12);
    let [wave, constant] = [4, 5].map(|index| run_case(&cases, index));
    assert_eq!(cases.labels(5)[1], "60 V");
    let (force, shifted) = (wave.column("stack.force"), constant.column("stack.force"));
    let (u, constant_u) = (wave.column("stack.U"), constant.column("stack.U"));
    assert!(constant_u.iter().all(|u| *u == 60.0));
    for k in 1..force.len() {
        let wanted = -0.03 * (60.0 - u[k]);
        assert!((shifted[k] - force[k] - wanted).abs() < 1e-10 * largest(&force), "row {k}");
    }
    let memories = [&wave, &constant].map(|run| run.column("stack.derivative"));
    assert!(relative_difference(&memories[0][1..], &memories[1][1..]) < 1e-10);
}

#[test]
fn the_expansion_of_the_papers_converges_slowly() {
    // N = 7, 30, 100 of the 2004 form: its error grows with t, is as large as the derivative itself for N ≪ ωt = 80, and only
    // then falls like N^{alpha−2}.
    let cases = shipped("expansion_scheme.toml", &[]);
    let derivatives: Vec<Vec<f64>> = (0..cases.len()).map(|k| run_case(&cases, k).column("strut.derivative")).collect();
    let errors: Vec<f64> =
        derivatives[1..].iter().map(|d| relative_difference(&derivatives[0][1..], &d[1..])).collect();
    println!("expansion errors relative to the largest |D^½ x|: {errors:?}");
    assert_eq!(errors.len(), 3);
    assert!(errors[0] > 1.0 && errors[1] > 0.3 && errors[2] > 0.05, "{errors:?}");
    assert!(errors.windows(2).all(|e| e[1] < 0.5 * e[0]), "{errors:?}");
}
