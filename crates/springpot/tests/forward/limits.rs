//! Limits of the order, and the order of the method in time.

use crate::support::forward::{at, distance, every, falling, largest, slider, state};
use crate::support::robots::{ARM, strut};
use crate::support::{Run, run};

/// Relative distance of all of q and v of two runs, whose rows are at the same times.
fn gap(a: &Run, b: &Run) -> f64 {
    let states: Vec<&String> = a.names.iter().filter(|n| n.starts_with("q.") || n.starts_with("v.")).collect();
    assert!(!states.is_empty());
    largest(states.into_iter().map(|name| distance(&a.column(name), &b.column(name)) / (1.0 + largest(a.column(name)))))
}

#[test]
fn alpha_one_is_a_dashpot_and_alpha_zero_a_spring() {
    let law = |text: &str| {
        format!(
            "{ARM}{}\n[motion]\nkind = \"forward\"\nstart = {{ q = {{ q2 = 0.3 }}, v = {{ q3 = 1 }} }}\n",
            strut(text)
        )
    };
    // Steps of one size, since the choice of steps turns rounding into differences as large as the tolerance.
    let rows = every(1.0, 0.1, 1e-5) + "max_step = 1e-3\nfirst_step = 1e-3\nmethod = \"radau\"\n";
    for derivative in ["caputo", "riemann-liouville"] {
        let springpot = |alpha: f64| {
            run(&(law(&format!(
                "law = \"fractional-kelvin-voigt\"\nparameters = {{ k = 40, c = 30, alpha = {alpha} }}\nderivative = \"{derivative}\""
            )) + &rows))
        };
        let dashpot = run(&(law("law = \"kelvin-voigt\"\nparameters = { k = 40, c = 30 }") + &rows));
        let gap_dashpot = gap(&dashpot, &springpot(1.0));
        assert!(gap_dashpot < 1e-13, "{derivative}: {gap_dashpot:e}");
        if derivative == "riemann-liouville" {
            let spring = run(&(law("law = \"spring\"\nparameters = { k = 70 }") + &rows));
            let gap_spring = gap(&spring, &springpot(0.0));
            println!("dashpot {gap_dashpot:.1e}, spring {gap_spring:.1e}");
            assert!(gap_spring < 1e-12, "{gap_spring:e}");
        }
        // The limits are approached.
        let near = [gap(&dashpot, &springpot(0.99)), gap(&dashpot, &springpot(0.999))];
        if derivative == "caputo" {
            assert!(near[1] > 0.0 && near[1] < 0.2 * near[0], "{near:?}");
        }
    }
}

/// Error of the slider's state at the rows, and the steps that it took.
struct Effort {
    error: f64,
    steps: u64,
}

/// −d ln(error)/d ln(steps) by least squares.
fn measured_order(efforts: &[Effort]) -> f64 {
    let points: Vec<(f64, f64)> = efforts.iter().map(|e| ((e.steps as f64).ln(), e.error.ln())).collect();
    let n = points.len() as f64;
    let (mx, my) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / n, y + p.1 / n));
    let (xy, xx) = points.iter().fold((0.0, 0.0), |(xy, xx), (x, y)| (xy + (x - mx) * (y - my), xx + (x - mx).powi(2)));
    -xy / xx
}

/// Work and precision for a scenario without its time and solver.
fn work_precision(text: &str, end: f64, rtols: &[f64]) -> Vec<Effort> {
    let times = [0.25, 0.5, 0.75, 1.0].map(|share| (share * end).to_string()).join(", ");
    let rows = |rtol| format!("{text}{}", at(&end.to_string(), &times, rtol));
    let best = run(&rows(1e-13));
    let efforts = rtols.iter().map(|rtol| {
        let run = run(&rows(*rtol));
        let error = gap(&best, &run);
        println!("rtol {rtol:e}: error {error:.1e}, {} + {} steps", run.report.steps, run.report.rejected_steps);
        Effort { error, steps: run.report.steps }
    });
    efforts.collect()
}

#[test]
fn the_order_in_time_is_five_at_every_fractional_order() {
    let rtols = [1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11];
    for alpha in [0.1, 0.5, 0.9] {
        let law = format!("law = \"fractional-kelvin-voigt\"\nparameters = {{ k = 50, c = 50, alpha = {alpha} }}");
        let text = slider("2", -9.81, &law, &state("0", "1"));
        let order = measured_order(&work_precision(&text, 2.0, &rtols));
        println!("slider, alpha = {alpha}: order {order:.2}");
        assert!(order >= 4.7, "slider, alpha = {alpha}: {order}");
        let arm = falling(alpha, 25.0, "caputo", "start = { q = { q2 = 0.4, q3 = 0.5 } }");
        let order = measured_order(&work_precision(&arm, 2.0, &rtols));
        println!("arm, alpha = {alpha}: order {order:.2}");
        assert!(order >= 4.7, "arm, alpha = {alpha}: {order}");
    }
}

#[test]
fn singular_starts_keep_the_order() {
    for alpha in [0.3, 0.5, 0.8] {
        let text = falling(alpha, 25.0, "riemann-liouville", "start = { q = { q2 = 0.4, q3 = 0.5 } }");
        let efforts = work_precision(&text, 2.0, &[1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11]);
        let order = measured_order(&efforts);
        println!("singular, alpha = {alpha}: order {order:.2}");
        assert!(order >= 3.7, "alpha = {alpha}: {order}");
        assert!(efforts.last().unwrap().error < 1e-8, "alpha = {alpha}");
    }
}

#[test]
fn rows_between_steps_are_as_good_as_those_at_their_ends() {
    for (alpha, derivative) in
        [(0.5, "caputo"), (0.5, "riemann-liouville"), (0.9, "caputo"), (0.2, "riemann-liouville")]
    {
        let text = falling(alpha, 25.0, derivative, "start = { q = { q2 = 0.4, q3 = 0.5 } }");
        // Rows far apart are ends of steps, rows close together are not.
        let dense = run(&format!("{text}{}", every(2.0, 0.001, 1e-9)));
        let sparse = run(&format!("{text}{}", every(2.0, 0.1, 1e-9)));
        let single = run(&format!("{text}{}", at("2", "2", 1e-9)));
        for name in sparse.names.iter().filter(|name| *name != "t" && !name.starts_with("energy.residual")) {
            let (fine, coarse) = (dense.column(name), sparse.column(name));
            let size = 1.0 + coarse.iter().filter(|x| x.is_finite()).fold(0.0, |m: f64, x| m.max(x.abs()));
            // Forces and accelerations are singular at t = 0 after such a start, and mean little next to it.
            for k in 1..coarse.len() {
                if coarse[k].is_nan() && fine[100 * k].is_nan() {
                    continue;
                }
                let error = (coarse[k] - fine[100 * k]).abs() / size;
                assert!(error < 3e-7, "{alpha} {derivative} {name} at {}: {error:e}", sparse.rows[k][0]);
            }
            let (last, only) = (*coarse.last().unwrap(), single.column(name)[0]);
            assert!(last.is_nan() && only.is_nan() || (last - only).abs() < 3e-7 * size, "{name}: {last} {only}");
        }
        // Every row of the dense run against runs that end there.
        for k in [3usize, 17, 40, 333, 1001] {
            let t = dense.rows[k][0];
            let exact = run(&format!("{text}{}", at(&t.to_string(), &t.to_string(), 1e-12)));
            for name in dense.names.iter().filter(|name| name.starts_with("q.") || name.starts_with("v.")) {
                let error = (exact.column(name)[0] - dense.column(name)[k]).abs();
                assert!(error < 2e-7, "{alpha} {derivative} {name} at {t}: {error:e}");
            }
        }
    }
}

/// Series keep the tolerance too. At loose ones the layer in which they begin and their energies ask for more steps than the motion does, so that work
/// tells less of the order than steps of one size do (`networks/convergence.rs`).
#[test]
fn series_keep_every_tolerance() {
    let rtols = [1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11];
    for alpha in [0.2, 0.5, 0.8, 0.95] {
        for (name, parameters) in [
            ("fractional-maxwell", "k = 90, c = 40"),
            ("fractional-zener", "k_e = 50, k_m = 90, c = 40"),
            ("poynting-thomson", "k_1 = 90, k_2 = 50, c = 40"),
        ] {
            let law = format!("law = \"{name}\"\nparameters = {{ {parameters}, alpha = {alpha} }}");
            let text = slider("2", -9.81, &law, &state("0", "1"));
            let efforts = work_precision(&text, 2.0, &rtols);
            let order = measured_order(&efforts);
            println!("{name}, alpha = {alpha}: order {order:.2}");
            assert!(efforts.iter().zip(rtols).all(|(effort, rtol)| effort.error < rtol), "{name}, alpha = {alpha}");
        }
    }
}

/// What the first accelerations would lead to over a long run is no measure of a motion that they do not lead to.
#[test]
fn a_motion_is_measured_by_what_it_does() {
    let system = |torque: &str| {
        format!(
            "[robot]\ngravity = [0, 0, 0]\n[[robot.body]]\nname = \"b\"\nmass = 1\n\
             joint = {{ name = \"z\", kind = \"prismatic\", axis = [0, 0, 1] }}\n\
             [motion]\nkind = \"forward\"\ntorque = {{ z = {torque} }}\n"
        )
    };
    // Alone it would come to 10 km/s in 1000 s; it never moves faster than 0.1 m/s.
    let shaken = run(&(system("\"10*cos(100*t)\"") + &at("1000", "1, 10, 100", 1e-9)));
    for (t, v) in shaken.t().iter().zip(shaken.column("v.z")) {
        let error = (v - 0.1 * (100.0 * t).sin()).abs();
        assert!(error < 1e-8 * t, "{t}: {error:e}");
    }
}

/// A ball that falls on a stop again and again: each bounce costs no more than a share of the tolerance.
#[test]
fn ten_thousand_bounces_keep_the_tolerance() {
    let (gravity, height, omega) = (9.81, 0.01, 100.0f64);
    let speed = (2.0f64 * gravity * height).sqrt();
    let in_contact = 2.0 * (std::f64::consts::PI - (speed / omega).atan2(gravity / omega.powi(2))) / omega;
    let period = 2.0 * speed / gravity + in_contact;
    let law =
        format!("network = \"stop(k, lower, upper)\"\nparameters = {{ k = {}, lower = 0, upper = 1 }}", omega.powi(2));
    let text = slider("1", -gravity, &law, &state(&height.to_string(), "0"));
    let bounces = 10_000.0;
    let times = [1.0, 10.0, 100.0, bounces].map(|n| (n * period).to_string()).join(", ");
    let rtol = 1e-9;
    let run = run(&(text + &at(&(bounces * period).to_string(), &times, rtol) + "max_steps = 10000000\n"));
    for (row, n) in [1.0, 10.0, 100.0, bounces].into_iter().enumerate() {
        let lost = run.column("energy.residual")[row].abs() / (gravity * height);
        println!("{n} bounces: {lost:.1e} of the energy");
        assert!(lost < n * rtol, "{n} bounces: {lost:e}");
    }
    assert!((run.column("q.q")[2] - height).abs() < 100.0 * rtol);
}
