//! Controllers against closed forms.

use super::support::forward::{every, largest, slider, state};
use super::support::robots::{ARM, magnetorheological};
use super::support::run;
use num_complex::Complex64;
use springpot::fractional::mittag_leffler::mittag_leffler;

/// A mass of 2 kg on a slide without gravity whose element does nothing.
fn mass(controller: &str, end: f64) -> String {
    let free = slider("2", 0.0, "law = \"spring\"\nparameters = { k = 1e-30 }", &state("0", "0"));
    format!("{free}[motion.controller]\n{controller}\n{}", every(end, end / 50.0, 1e-10))
}

fn e(a: f64, b: f64, z: f64) -> f64 {
    mittag_leffler(a, b, Complex64::from(z)).unwrap().re
}

/// m ë + ki I^λ e = 0 from e = 1, at rest: e = E_{2+λ,1}(−(ki/m) t^{2+λ}).
#[test]
fn fractional_integrals() {
    for lambda in [0.2, 0.5, 0.8, 1.0] {
        let law = format!(
            "kind = \"fractional-pid\"\nkp = 0\nki = 3\nlambda = {lambda}\nreference = {{ kind = \"joints\", q = \"1\" }}"
        );
        let run = run(&mass(&law, 3.0));
        let off = run.t().into_iter().zip(run.column("q.q")).map(|(t, q)| {
            let exact = 1.0 - e(2.0 + lambda, 1.0, -1.5 * t.powf(2.0 + lambda));
            (q - exact).abs()
        });
        let off = largest(off);
        assert!(off < 1e-9, "lambda {lambda}: {off:e}");
    }
}

/// m ë + kd D^μ e = 0 from e = 0, ė = 1: e = t·E_{2−μ,2}(−(kd/m) t^{2−μ}).
#[test]
fn fractional_derivatives() {
    for mu in [0.1, 0.3, 0.5, 0.7, 0.9, 1.0] {
        let law = format!(
            "kind = \"fractional-pid\"\nkp = 0\nkd = 3\nmu = {mu}\nreference = {{ kind = \"joints\", q = \"t\" }}"
        );
        let run = run(&mass(&law, 3.0));
        let off = run.t().into_iter().zip(run.column("q.q")).map(|(t, q)| {
            let exact = t - t * e(2.0 - mu, 2.0, -1.5 * t.powf(2.0 - mu));
            (q - exact).abs()
        });
        let off = largest(off);
        assert!(off < 1e-9, "mu {mu}: {off:e}");
    }
}

/// The arm with a magnetorheological strut under computed torque, tracking.
fn tracking(compensate: bool) -> String {
    let strut = magnetorheological(0.5, "caputo");
    format!(
        "{ARM}{strut}\n[motion]\nkind = \"forward\"\nstart = {{ q = {{ q2 = 0.1, q3 = 0.2 }} }}\n[motion.controller]\n\
         kind = \"computed-torque\"\nkp = 100\nkd = 20\ncompensate_elements = {compensate}\n\
         reference = {{ kind = \"joints\", q1 = \"0.3*sin(2*t)\", q2 = \"0.2*cos(3*t)\", q3 = \"0.5\" }}\n{}",
        every(2.0, 0.02, 1e-9)
    )
}

/// e″ + Kd e′ + Kp e = 0 with a double root: e = (e_0 + (e_0' + ω e_0) t) e^{−ωt}.
#[test]
fn computed_torque_with_compensation_has_linear_errors() {
    let run = run(&tracking(true));
    let t = run.t();
    for (joint, reference, e0, v0) in [
        ("q1", (|t: f64| 0.3 * (2.0 * t).sin()) as fn(f64) -> f64, 0.0, 0.6),
        ("q2", |t| 0.2 * (3.0 * t).cos(), 0.1, 0.0),
        ("q3", |_| 0.5, 0.3, 0.0),
    ] {
        let q = run.column(&format!("q.{joint}"));
        let off = t.iter().zip(q).map(|(t, q)| reference(*t) - q - (e0 + (v0 + 10.0 * e0) * t) * (-10.0 * t).exp());
        let off = largest(off);
        assert!(off < 1e-10, "{joint}: {off:e}");
    }
    assert!(run.residual() < 1e-9);
}

/// Without compensation the error is driven by the elements: a(q)(e″ + Kd e′ + Kp e) = −Q, row by row.
#[test]
fn computed_torque_without_compensation_has_the_stated_bias() {
    let run = run(&tracking(false));
    let (compensated, t) = (super::support::run(&tracking(true)), run.t());
    let column = |name: &str| run.column(name);
    let mut worst = 0.0f64;
    for (k, t) in t.iter().enumerate() {
        // The torque that the law says, from the same state: what is missing in the equations of motion is Q of the strut.
        let says: Vec<f64> = ["q1", "q2", "q3"].iter().map(|j| column(&format!("a.{j}"))[k]).collect();
        let wanted = [
            -1.2 * (2.0 * t).sin()
                + 20.0 * (0.6 * (2.0 * t).cos() - column("v.q1")[k])
                + 100.0 * (0.3 * (2.0 * t).sin() - column("q.q1")[k]),
            -1.8 * (3.0 * t).cos()
                + 20.0 * (-0.6 * (3.0 * t).sin() - column("v.q2")[k])
                + 100.0 * (0.2 * (3.0 * t).cos() - column("q.q2")[k]),
            -20.0 * column("v.q3")[k] + 100.0 * (0.5 - column("q.q3")[k]),
        ];
        // a(q)·(q̈ − wanted) = Q.
        let plan = super::support::cases(&tracking(false)).plan(0).unwrap();
        let q: Vec<f64> = ["q1", "q2", "q3"].iter().map(|j| column(&format!("q.{j}"))[k]).collect();
        let kinematics = springpot::dynamics::Kinematics::at_position(&plan.model, &q);
        let mass = springpot::dynamics::crba(&plan.model, &kinematics);
        for (row, joint) in ["q1", "q2", "q3"].iter().enumerate() {
            let left: f64 = (0..3).map(|c| mass[row * 3 + c] * (says[c] - wanted[c])).sum();
            worst = worst.max((left - column(&format!("strut.Q.{joint}"))[k]).abs());
        }
    }
    assert!(worst < 1e-6, "{worst:e}");
    assert!(largest(run.column("gripper.error")) > 2.0 * largest(compensated.column("gripper.error")[60..].to_vec()));
}

/// A step that takes longer than the force allows: without anti-windup the integral goes on growing, and the mass overshoots by far.
#[test]
fn anti_windup_spares_the_overshoot() {
    let overshoot = |rule: &str| {
        let law = format!(
            "kind = \"pid\"\nkp = 20\nki = 10\nkd = 12\nlimits = {{ q = 2 }}\nanti_windup = \"{rule}\"\nreference = {{ kind = \"joints\", q = \"3\" }}"
        );
        largest(run(&mass(&law, 6.0)).column("q.q")) - 3.0
    };
    let (stopped, running) = (overshoot("conditional"), overshoot("none"));
    assert!(stopped < 0.35 * running && running > 0.5, "{stopped} {running}");
}
