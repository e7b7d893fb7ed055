//! Kinks in motions and inputs, sampled motions and inputs: the same accuracy as where all is smooth, because steps end there.

use crate::support::robots::{ARM, at, every, magnetorheological, prescribed, springpot, strut};
use crate::support::truth::{derivatives, pair_at};
use crate::support::{cases, largest, relative_difference, run, run_case};
use std::f64::consts::PI;
use std::fmt::Write as _;

const RTOL: f64 = 1e-9;

/// Largest error of D^alpha x with the truth cut at the kinks, and the steps tried.
fn error(text: &str, width: f64, kinks: &[f64]) -> (f64, u64) {
    let system = cases(text).plan(0).unwrap().system();
    let run = run(text);
    let (t, values) = (run.t(), run.column("strut.derivative"));
    // At a kink the rate is that of one side; no truth is asked for there.
    let rows = t.iter().zip(&values).filter(|(t, _)| **t > 0.0 && kinks.iter().all(|k| (*t - k).abs() > 1e-9));
    let (times, values): (Vec<f64>, Vec<f64>) = rows.unzip();
    let exact = derivatives(&system, 0, &times, width, kinks);
    (relative_difference(&exact, &values), run.effort())
}

#[test]
fn kinked_motions() {
    let halves: Vec<f64> = (1..13).map(|k| f64::from(k) * PI / 4.0).collect();
    let quarter = |y: f64, omega: f64, end: f64| -> Vec<f64> {
        // sin(omega t) = y
        let (first, period) = (y.asin() / omega, 2.0 * PI / omega);
        let starts = (0..40).map(|k| f64::from(k) * period);
        starts.flat_map(|s| [s + first, s + 0.5 * period - first]).filter(|t| *t < end).collect()
    };
    let clipped = quarter(0.5, 3.0, 5.0);
    let cases: [(&str, &str, f64, Vec<f64>); 6] = [
        ("0.2*abs(sin(4*t))", "0.1*t", 5.0, halves),
        ("0.2*min(sin(3*t), 0.5)", "0.1*t", 5.0, clipped),
        ("0.1*max(0, t - 1)", "0.3*sin(2*t)", 3.0, vec![1.0]),
        // A trapezoid: up, hold, down.
        ("min(0.4*t, 0.2, 0.2 - 0.3*(t - 2))", "0", 2.5, vec![0.5, 2.0]),
        // Kinks that meet and follow closely.
        ("0.1*abs(t - 1) + 0.1*abs(t - 1.0001)", "0.05*abs(t - 1)", 2.0, vec![1.0, 1.0001]),
        // A kink in the second derivative alone.
        ("0.3*max(0, t - 0.7)^2", "0.1*abs(t - 1.3)*(t - 1.3)", 2.0, vec![0.7, 1.3]),
    ];
    for (q2, q3, end, kinks) in &cases {
        for alpha in [0.1, 0.5, 0.9] {
            let text = format!("{ARM}{}{}{}", springpot(alpha, "caputo"), prescribed(q2, q3), every(*end, 0.0313));
            let (error, effort) = error(&text, 0.1, kinks);
            println!("q2 = {q2}, q3 = {q3}, alpha = {alpha}: {error:.1e}, {effort} steps");
            assert!(error < RTOL, "q2 = {q2}, q3 = {q3}, alpha = {alpha}: {error:.1e}");
        }
    }
}

#[test]
fn narrow_kinked_pulses() {
    // A triangle far narrower than the longest step: both its feet and its tip lie between two nodes.
    for (centre, width) in [(1.5, 0.02), (1.777, 0.002), (1.777, 0.0005)] {
        let q2 = format!("0.1*max(0, 1 - abs(t - {centre})/{width})");
        let kinks = [centre - width, centre, centre + width];
        let times: Vec<f64> = (-8..=30).map(|k| centre + width * (0.23 * f64::from(k) + 0.01)).collect();
        let text = format!("{ARM}{}{}{}", springpot(0.5, "caputo"), prescribed(&q2, "0"), at(2.0, &times));
        let (error, effort) = error(&text, 0.1, &kinks);
        println!("triangle of {width} s at {centre} s: {error:.1e}, {effort} steps");
        assert!(error < RTOL, "triangle of {width} s at {centre} s: {error:.1e}");
    }
}

#[test]
fn kinked_inputs_leave_the_memory_alone() {
    // The voltage switches and clips; force = E_c x + (mu_0 + u mu) D^alpha x on both sides.
    for (u, value) in [
        ("step(t - 1) + 2*step(t - 2.3)", (|t| f64::from(t >= 1.0) + 2.0 * f64::from(t >= 2.3)) as fn(f64) -> f64),
        ("max(0, sin(5*t))", |t| (5.0 * t).sin().max(0.0)),
        ("1 + sign(t - 1.7)", |t| {
            1.0 + if t > 1.7 {
                1.0
            } else if t < 1.7 {
                -1.0
            } else {
                0.0
            }
        }),
    ] {
        let element = magnetorheological(0.5, "caputo").replace("u = \"1 V\"", &format!("u = \"{u}\""));
        let text = format!("{ARM}{element}{}{}", prescribed("0.1*sin(8*t)", "0.1*t"), every(3.0, 0.0171));
        let system = cases(&text).plan(0).unwrap().system();
        let run = run(&text);
        let times = &run.t()[1..];
        let exact = derivatives(&system, 0, times, 0.1, &[]);
        assert!(relative_difference(&exact, &run.column("strut.derivative")[1..]) < RTOL, "{u}");
        let force: Vec<f64> = times
            .iter()
            .zip(&exact)
            .map(|(t, d)| {
                2500.0 * (pair_at(&system, &system.elements[0], *t).0 - 0.7) + (5000.0 + 1000.0 * value(*t)) * d
            })
            .collect();
        let error = relative_difference(&force, &run.column("strut.force")[1..]);
        assert!(error < RTOL, "{u}: {error:.1e}");
        let residual = run.report.energy_residual.unwrap() / run.report.energy_turned_over.unwrap();
        println!("u = {u}: force {error:.1e}, residual {residual:.1e}, {} steps", run.effort());
        assert!(residual < 1e-7, "{u}: {residual:.1e}");
    }
}

#[test]
fn sampled_motions_and_inputs() {
    let folder = tempfile::tempdir().unwrap();
    // Uneven samples; the spline through them is the motion, straight lines the temperature.
    let mut motion = String::from("t,q1,q2,q3\n");
    let mut temperature = String::from("t,T\n");
    let mut knots = Vec::new();
    for k in 0..=60 {
        let t = 0.05 * f64::from(k) + if k % 60 == 0 { 0.0 } else { 0.01 * (f64::from(k) * 1.7).sin() };
        writeln!(motion, "{t},0,{},{}", 0.1 * (8.0 * t).sin(), 0.1 * t).unwrap();
        writeln!(temperature, "{t},{}", 25.0 + 10.0 * (3.0 * t).sin()).unwrap();
        knots.push(t);
    }
    std::fs::write(folder.path().join("motion.csv"), motion).unwrap();
    std::fs::write(folder.path().join("T.csv"), temperature).unwrap();
    for alpha in [0.1, 0.5, 0.9] {
        let element = strut(&format!(
            "law = \"thermoviscoelastic\"\n\
             parameters = {{ E_c = 30, E_kv = 20, E_d = 50, alpha = {alpha}, a_kv = 0.0007 }}\n\
             inputs = {{ T = {{ csv = \"T.csv\", column = \"T\", unit = \"degC\" }} }}"
        ));
        let motion = "\n[motion]\nkind = \"prescribed\"\ncsv = \"motion.csv\"\n";
        let text = format!("{ARM}{element}{motion}{}", every(3.0, 0.017));
        let scenario = springpot_scenario::Scenario::parse(&text, "sampled.toml", folder.path()).unwrap();
        let cases = scenario.cases(&springpot::law::Catalog::standard()).unwrap();
        let system = cases.plan(0).unwrap().system();
        let run = run_case(&cases, 0);
        assert!(run.error.is_none(), "{:?}", run.error);
        let times = &run.t()[1..];
        // The third derivative of the spline jumps at every knot.
        let exact = derivatives(&system, 0, times, 0.1, &knots);
        let error = relative_difference(&exact, &run.column("strut.derivative")[1..]);
        let forces: Vec<f64> = run.t()[1..]
            .iter()
            .zip(&exact)
            .zip(&run.column("strut.T")[1..])
            .map(|((t, d), kelvin)| {
                50.0 * (pair_at(&system, &system.elements[0], *t).0 - 0.7) + 50.0 * d - 0.014 * (kelvin - 273.15)
            })
            .collect();
        let force_error = relative_difference(&forces, &run.column("strut.force")[1..]);
        let residual = run.report.energy_residual.unwrap() / run.report.energy_turned_over.unwrap();
        println!(
            "alpha = {alpha}: {error:.1e}, force {force_error:.1e}, residual {residual:.1e}, {} steps",
            run.effort()
        );
        assert!(error < RTOL && force_error < RTOL, "alpha = {alpha}: {error:.1e} {force_error:.1e}");
        assert!(residual < 1e-7, "alpha = {alpha}: {residual:.1e}");
        assert!(largest(&exact) > 0.0);
    }
}

#[test]
fn a_jump_of_a_joint_is_an_error_that_names_it() {
    let text = format!("{ARM}{}{}{}", springpot(0.5, "caputo"), prescribed("0.1*step(t - 1)", "0"), every(2.0, 0.1));
    let run = run_case(&cases(&text), 0);
    let message = run.error.expect("the joint jumps").to_string();
    assert!(message.contains("joint \"q2\" jumps by 1e-1") && message.contains("t = 1"), "{message}");
    assert_eq!(run.report.t_reached, Some(0.9));
    assert_eq!(run.rows.len(), 10);
}

#[test]
fn rows_at_kinks_and_jumps() {
    // Every kink and jump is the time of a row; no row is lost, and on each the function's own value stands.
    for (u, value) in [
        ("step(t - 1)", (|t| f64::from(t >= 1.0)) as fn(f64) -> f64),
        ("1 + sign(t - 1.5)", |t| 1.0 + if t == 1.5 { 0.0 } else { f64::signum(t - 1.5) }),
        ("step(t - 0.5) + step(t - 2) + max(0, t - 1)", |t| {
            f64::from(t >= 0.5) + f64::from(t >= 2.0) + (t - 1.0).max(0.0)
        }),
    ] {
        for alpha in [0.0, 0.5, 1.0] {
            for step in [0.5, 0.125] {
                let element = magnetorheological(alpha, "caputo").replace("u = \"1 V\"", &format!("u = \"{u}\""));
                let motion = prescribed("0.1*max(0, t - 1) + 0.05*abs(t - 1.5)", "0.2*abs(sin(t - 2))");
                let text = format!("{ARM}{element}{motion}{}", every(3.0, step));
                let system = cases(&text).plan(0).unwrap().system();
                let run = run(&text);
                assert_eq!(run.t(), (0..=(3.0 / step) as usize).map(|k| k as f64 * step).collect::<Vec<_>>());
                let case = format!("u = {u}, alpha = {alpha}, step {step}");
                let inputs: Vec<f64> = run.t().into_iter().map(value).collect();
                assert_eq!(run.column("strut.u"), inputs, "{case}");
                let exact = derivatives(&system, 0, &run.t()[1..], 0.1, &[1.0, 1.5, 2.0]);
                let (derivative, force) = (run.column("strut.derivative"), run.column("strut.force"));
                assert!(relative_difference(&exact, &derivative[1..]) < RTOL, "{case}");
                for (k, t) in run.t().into_iter().enumerate().skip(1) {
                    let stroke = pair_at(&system, &system.elements[0], t).0 - 0.7;
                    let wanted = 2500.0 * stroke + (5000.0 + 1000.0 * inputs[k]) * derivative[k];
                    assert!((force[k] - wanted).abs() < 1e-12 * largest(&force), "{case}, t = {t}");
                }
                // The ledger closes in every row, the one in which the input jumps as well.
                let residual = largest(&run.column("energy.residual")) / run.report.energy_turned_over.unwrap();
                assert!(residual < 1e-7, "{case}: {residual:.1e}");
            }
        }
    }
}

#[test]
fn rows_before_and_after_the_first_kink_are_those_of_the_parts() {
    // Until the kink the run is the run without it, to the bit.
    let with =
        |q2: &str| run(&format!("{ARM}{}{}{}", springpot(0.5, "caputo"), prescribed(q2, "0.1*t"), every(1.0, 0.25)));
    let (kinked, smooth) = (with("0.1*sin(t) + max(0, t - 0.75)"), with("0.1*sin(t)"));
    let (a, b) = (kinked.column("strut.derivative"), smooth.column("strut.derivative"));
    for k in 1..=3 {
        assert!((a[k] - b[k]).abs() < 1e-11 * largest(&b), "row {k}");
    }
    assert!((a[4] - b[4]).abs() > 1e-3 * largest(&b));
}
