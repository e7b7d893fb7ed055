//! Accuracy is the run's business: every D^alpha x within rtol of the largest of its curve against an independent quadrature,
//! whatever the motion, the order and the rows.

use crate::support::oracle::{file, number};
use crate::support::robots::{ARM, SWING, at, every, prescribed, springpot};
use crate::support::truth::{Truth, derivatives};
use crate::support::{Run, cases, largest, relative_difference, run, run_case};
use springpot::fractional::gamma::{gamma, reciprocal_gamma};

/// The default of [solver].
const RTOL: f64 = 1e-9;

const ALPHAS: [f64; 8] = [0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 0.999];

/// Largest error of D^alpha x of the strut in units of its largest value; panels of the truth at most `width` wide.
fn error(text: &str, run: &Run, width: f64) -> f64 {
    let system = cases(text).plan(0).unwrap().system();
    let (t, values) = (run.t(), run.column("strut.derivative"));
    let skip = usize::from(t[0] == 0.0);
    let exact = derivatives(&system, 0, &t[skip..], width, &[]);
    relative_difference(&exact, &values[skip..])
}

#[test]
fn the_truth_meets_closed_forms() {
    let mut worst = 0.0f64;
    for alpha in ALPHAS {
        let truth = Truth::new(alpha, 10.0, 0.25, &[0.7, 3.0]);
        for t in [1e-3, 0.25, 0.3, 0.7000001, 1.0, 5.003, 10.0] {
            for power in [1.0, 2.0, 5.0] {
                let exact = gamma(power + 1.0) * reciprocal_gamma(power + 1.0 - alpha) * f64::powf(t, power - alpha);
                let value = truth.caputo(t, &|s| power * s.powf(power - 1.0));
                worst = worst.max((value / exact - 1.0).abs());
            }
            // A kink at 0.7: x = max(0, t − 0.7).
            let kinked = truth.caputo(t, &|s| if s > 0.7 { 1.0 } else { 0.0 });
            let exact = if t > 0.7 { (t - 0.7).powf(1.0 - alpha) * reciprocal_gamma(2.0 - alpha) } else { 0.0 };
            worst = worst.max((kinked - exact).abs() / exact.max(1e-3));
        }
    }
    let rows = file("fractional/derivatives.json");
    let mut compared = 0;
    for row in rows["functions"]["0.7*sin(8t)+0.1*t"].as_array().unwrap() {
        let (alpha, t, exact) = (number(&row["alpha"]), number(&row["t"]), number(&row["caputo"]));
        let value = Truth::new(alpha, t, 0.1, &[]).caputo(t, &|s| 5.6 * (8.0 * s).cos() + 0.1);
        worst = worst.max((value - exact).abs());
        compared += 1;
    }
    println!("truth errs by {worst:.1e}");
    assert_eq!(compared, 60);
    assert!(worst < 1e-12, "{worst:e}");
}

#[test]
fn every_order_meets_the_tolerance() {
    for derivative in ["caputo", "riemann-liouville"] {
        for alpha in ALPHAS {
            let text = format!("{ARM}{}{SWING}{}", springpot(alpha, derivative), every(10.0, 0.05));
            let run = run(&text);
            let error = error(&text, &run, 0.1);
            println!("{derivative}, alpha = {alpha}: {error:.1e}, {} steps", run.effort());
            assert!(error < RTOL, "{derivative}, alpha = {alpha}: {error:.1e}");
        }
    }
}

/// Steps of one size of a motion of 8 rad/s: order 8 − alpha, and no less than the estimate of it, 7 − alpha.
#[test]
fn along_a_motion_the_order_is_eight_less_alpha() {
    for alpha in [0.1, 0.3, 0.5, 0.7, 0.9] {
        let of_step = |step: f64| {
            let solver =
                format!("\n[solver]\nrtol = 0.1\nmemory_rtol = 1e-12\nfirst_step = {step}\nmax_step = {step}\n");
            let text = format!("{ARM}{}{SWING}{}{solver}", springpot(alpha, "caputo"), every(4.0, 0.04));
            let run = run(&text);
            assert!(run.effort() < 4.0f64.div_euclid(step) as u64 + 4, "{} steps", run.effort());
            error(&text, &run, 0.1)
        };
        let errors = [0.08, 0.056, 0.04].map(of_step);
        let order = (errors[0] / errors[2]).ln() / 2f64.ln();
        println!("alpha = {alpha}: {errors:?}, order {order:.2}");
        assert!(order > 6.9 - alpha && errors[2] > 1e-12, "alpha = {alpha}: {errors:?}, order {order}");
    }
}

#[test]
fn looser_tolerances_are_met_and_cheaper() {
    let mut last = u64::MAX;
    for rtol in [1e-11, 1e-8, 1e-5, 1e-3] {
        let mut effort = 0;
        for alpha in [0.1, 0.5, 0.9] {
            let solver = format!("\n[solver]\nrtol = {rtol:e}\n");
            let text = format!("{ARM}{}{SWING}{}{solver}", springpot(alpha, "caputo"), every(10.0, 0.05));
            let run = run(&text);
            let error = error(&text, &run, 0.1);
            println!("rtol = {rtol:e}, alpha = {alpha}: {error:.1e}, {} steps", run.effort());
            assert!(error < rtol, "rtol = {rtol:e}, alpha = {alpha}: {error:.1e}");
            effort += run.effort();
        }
        assert!(effort <= last);
        last = effort;
    }
}

#[test]
fn fast_motion() {
    // 800 rad/s for half a second; rows that have nothing to do with the period.
    for alpha in [0.1, 0.5, 0.9] {
        let motion = prescribed("0.1*sin(800*t)", "0.1*t");
        let text = format!("{ARM}{}{motion}{}", springpot(alpha, "riemann-liouville"), every(0.5, 0.037));
        let run = run(&text);
        let error = error(&text, &run, 0.004);
        println!("800 rad/s, alpha = {alpha}: {error:.1e}, {} steps", run.effort());
        assert!(error < RTOL, "alpha = {alpha}: {error:.1e}");
    }
}

#[test]
fn slow_motion_takes_few_steps() {
    // An hour, a turn every ten minutes.
    for alpha in [0.1, 0.5, 0.9] {
        let motion = prescribed("0.3*sin(2*pi*t/600)", "0.2*(1 - cos(2*pi*t/3600))");
        let text = format!("{ARM}{}{motion}{}", springpot(alpha, "caputo"), every(3600.0, 37.0));
        let run = run(&text);
        let error = error(&text, &run, 60.0);
        println!("one hour, alpha = {alpha}: {error:.1e}, {} steps, {} modes", run.effort(), run.report.modes);
        assert!(error < RTOL, "alpha = {alpha}: {error:.1e}");
        assert!(run.effort() < 10_000, "alpha = {alpha}: {} steps", run.effort());
    }
}

#[test]
fn fast_and_slow_in_one_motion() {
    // A tremor on a slow sweep, whose amplitude dies away: small next to the largest value, never lost.
    for alpha in [0.1, 0.5, 0.9] {
        let motion = prescribed("0.3*sin(0.5*t) + 0.02*exp(-t)*sin(120*t)", "0.1*t");
        let text = format!("{ARM}{}{motion}{}", springpot(alpha, "caputo"), every(5.0, 0.031));
        let run = run(&text);
        let error = error(&text, &run, 0.01);
        println!("tremor, alpha = {alpha}: {error:.1e}, {} steps", run.effort());
        assert!(error < RTOL, "alpha = {alpha}: {error:.1e}");
    }
}

#[test]
fn late_narrow_pulses_are_not_stepped_over() {
    // At rest (or nearly) for most of the run, then a pulse as narrow as 1e-4 of the run. (What lies wholly between two nodes of
    // the longest step, a five-hundredth of the run, cannot be seen: such motions need solver.max_step.)
    for (end, centre, width) in [(10.0, 9.0, 0.05), (10.0, 9.0, 0.01), (10.0, 7.775, 0.001), (3600.0, 3000.0, 5.0)] {
        for rest in ["0", "0.001*t"] {
            let motion = prescribed(&format!("0.2*exp(-((t - {centre})/{width})^2)"), rest);
            let times: Vec<f64> = (-8..=20).map(|k| centre + 0.4 * width * f64::from(k)).filter(|t| *t < end).collect();
            let text = format!("{ARM}{}{motion}{}", springpot(0.5, "caputo"), at(end, &times));
            let run = run(&text);
            // The truth's panels follow the pulse.
            let system = cases(&text).plan(0).unwrap().system();
            let cuts: Vec<f64> = (-30..=60).map(|k| centre + 0.3 * width * f64::from(k)).collect();
            let exact = derivatives(&system, 0, &times, end, &cuts);
            let error = relative_difference(&exact, &run.column("strut.derivative"));
            println!("pulse of {width} s at {centre} of {end} s, {rest}: {error:.1e}, {} steps", run.effort());
            assert!(error < RTOL, "pulse of {width} s at {centre} of {end} s, {rest}: {error:.1e}");
        }
    }
}

#[test]
fn rows_do_not_change_the_results() {
    // Rows choose no steps: with half the output step the common rows are the same bits, in every column.
    for (alpha, derivative, motion, end, step) in [
        (0.5, "riemann-liouville", SWING.to_owned(), 10.0, 0.02),
        (0.9, "caputo", prescribed("0.1*sin(800*t)", "0.1*t"), 0.5, 0.01),
        (0.1, "caputo", prescribed("0.1*sin(3*t)", "0.2*abs(sin(2*t))"), 4.0, 0.05),
    ] {
        let with = |step: f64| run(&format!("{ARM}{}{motion}{}", springpot(alpha, derivative), every(end, step)));
        let (coarse, fine) = (with(step), with(0.5 * step));
        assert_eq!(fine.rows.len(), 2 * coarse.rows.len() - 1);
        assert_eq!(coarse.effort(), fine.effort());
        for (k, row) in coarse.rows.iter().enumerate() {
            let bits = |row: &[f64]| row.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(row), bits(&fine.rows[2 * k]), "row {k} of {derivative}, alpha = {alpha}");
        }
    }
}

#[test]
fn one_row_and_many_rows_agree() {
    let text = |time: String| format!("{ARM}{}{SWING}{time}", springpot(0.7, "caputo"));
    let many = run(&text(every(10.0, 0.001)));
    let one = run(&text(at(10.0, &[3.217])));
    assert_eq!((many.rows.len(), one.rows.len()), (10_001, 1));
    let derivative = many.column("strut.derivative");
    assert!((derivative[3217] - one.column("strut.derivative")[0]).abs() < RTOL * largest(&derivative));
    // Rows cost no steps.
    assert_eq!(many.effort(), one.effort());
}

#[test]
fn sweeps_and_single_runs_give_equal_bits() {
    let sweep = "\n[[sweep]]\nparameter = \"element.strut.alpha\"\nvalues = [0.1, 0.5, 0.9]\n";
    let text = |alpha: f64| format!("{ARM}{}{SWING}{}", springpot(alpha, "caputo"), every(2.0, 0.1));
    let swept = cases(&(text(0.3) + sweep));
    for (index, alpha) in [0.1, 0.5, 0.9].into_iter().enumerate() {
        assert_eq!(run_case(&swept, index).rows, run(&text(alpha)).rows, "alpha = {alpha}");
    }
}
