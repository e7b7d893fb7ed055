//! The reference files of the papers' two motions, read whole: every number within 1e-9 of the largest of its own curve, with
//! no [solver] section.

mod support;

use serde_json::Value;
use support::oracle::{column, file, number, numbers};
use support::robots::{ARM, PATH, SWING, at, magnetorheological, thermoviscoelastic};
use support::{Run, largest, run};

/// The tolerance that the papers' results must meet without any setting.
const TOLERANCE: f64 = 1e-9;

/// Tolerance of what comes from the rigid bodies alone.
const KINEMATICS: f64 = 1e-13;

/// Compares curves and keeps the worst of each kind.
#[derive(Default)]
struct Comparison {
    count: usize,
    worst: Vec<(&'static str, f64)>,
}

impl Comparison {
    /// Every value within `tolerance` of `scale`.
    fn compare(
        &mut self,
        what: &'static str,
        case: &str,
        reference: &[f64],
        values: &[f64],
        scale: f64,
        tolerance: f64,
    ) {
        assert_eq!(reference.len(), values.len(), "{case}: {what}");
        for (k, (wanted, got)) in reference.iter().zip(values).enumerate() {
            let error = (wanted - got).abs() / scale;
            assert!(error <= tolerance, "{case}: {what}[{k}] = {got:e}, not {wanted:e}: {error:.1e} of {scale:e}");
            self.count += 1;
            match self.worst.iter_mut().find(|(name, _)| *name == what) {
                Some((_, worst)) => *worst = worst.max(error),
                None => self.worst.push((what, error)),
            }
        }
    }

    /// Every value within `tolerance` of the largest of its own curve.
    fn curve(&mut self, what: &'static str, case: &str, reference: &[f64], values: &[f64], tolerance: f64) {
        self.compare(what, case, reference, values, largest(reference), tolerance);
    }

    fn report(&self, name: &str) {
        println!("{name}: {} numbers", self.count);
        self.worst.iter().for_each(|(what, error)| println!("  {what:12} {error:.1e}"));
    }
}

fn kinematics(comparison: &mut Comparison, oracle: &Value, run: &Run) {
    for (j, joint) in ["q1", "q2", "q3"].into_iter().enumerate() {
        // The angle and the rate of a joint at rest are exactly 0.
        let pairs = [("q", "q", KINEMATICS), ("qd", "v", KINEMATICS)];
        for (key, prefix, tolerance) in pairs {
            let reference = column(&oracle[key], j);
            let scale = largest(&reference).max(f64::MIN_POSITIVE);
            let values = run.column(&format!("{prefix}.{joint}"));
            comparison.compare(key, joint, &reference, &values, scale, tolerance);
        }
    }
    let stroke = numbers(&oracle["x"]);
    // A stroke is the difference of two lengths of 0.7 m.
    comparison.compare("stroke", "", &stroke, &run.column("strut.stroke"), 0.7, KINEMATICS);
    comparison.curve("rate", "", &numbers(&oracle["xdot"]), &run.column("strut.rate"), 1e-13);
    // ∂l/∂q_b where F is not 0: −Q_b/F.
    let force = run.column("strut.force");
    for b in 0..3 {
        let q = run.column(&format!("strut.Q.q{}", b + 1));
        let gradient: Vec<f64> = q.iter().zip(&force).map(|(q, f)| -q / f).collect();
        comparison.compare("gradient", "", &column(&oracle["dl_dq"], b), &gradient, 0.1, 1e-13);
    }
}

/// Force and Q of one case against the columns of its run; Q_1 is measured by the largest of Q_2 and Q_3.
fn forces(comparison: &mut Comparison, case: &Value, suffix: &str, run: &Run) {
    let name = format!("{} {suffix}", case["name"]);
    let force = numbers(&case[&format!("F_{suffix}")]);
    comparison.curve("force", &name, &force, &run.column("strut.force"), TOLERANCE);
    let q = &case[&format!("Q_{suffix}")];
    let others = largest(&column(q, 1)).max(largest(&column(q, 2)));
    comparison.compare("Q1", &name, &column(q, 0), &run.column("strut.Q.q1"), others, TOLERANCE);
    comparison.curve("Q2", &name, &column(q, 1), &run.column("strut.Q.q2"), TOLERANCE);
    comparison.curve("Q3", &name, &column(q, 2), &run.column("strut.Q.q3"), TOLERANCE);
}

const KINDS: [(&str, &str); 2] = [("RL", "riemann-liouville"), ("Caputo", "caputo")];

#[test]
fn prescribed_thermoviscoelastic() {
    let oracle = file("papers/prescribed_thermoviscoelastic.json");
    let times = at(10.0, &numbers(&oracle["t"]));
    let mut comparison = Comparison::default();
    for (suffix, derivative) in KINDS {
        for (alpha, reference) in oracle[&format!("D_{suffix}")].as_object().unwrap() {
            let element = thermoviscoelastic(alpha.parse().unwrap(), 25.0, derivative);
            let run = run(&format!("{ARM}{element}{SWING}{times}"));
            let name = format!("alpha = {alpha} {suffix}");
            comparison.curve("derivative", &name, &numbers(reference), &run.column("strut.derivative"), TOLERANCE);
            kinematics(&mut comparison, &oracle, &run);
        }
        for case in oracle["cases"].as_array().unwrap() {
            let temperature = case["T"].as_f64().unwrap();
            let element = thermoviscoelastic(number(&case["lambda"]), temperature, derivative);
            forces(&mut comparison, case, suffix, &run(&format!("{ARM}{element}{SWING}{times}")));
        }
    }
    comparison.report("prescribed_thermoviscoelastic");
    // 41 times · 2 kinds · (3 orders · (1 derivative + 3 q + 3 v + stroke + rate + 3 gradients) + 4 cases · (F + 3 Q))
    assert_eq!(comparison.count, 41 * 2 * (3 * 12 + 4 * 4));
}

#[test]
fn gripper_path_magnetorheological() {
    let oracle = file("papers/gripper_path_magnetorheological.json");
    let times = at(10.0, &numbers(&oracle["t"]));
    let mut comparison = Comparison::default();
    for (suffix, derivative) in KINDS {
        for (alpha, reference) in oracle[&format!("D_{suffix}")].as_object().unwrap() {
            let element = magnetorheological(alpha.parse().unwrap(), derivative);
            let run = run(&format!("{ARM}{element}{PATH}{times}"));
            let name = format!("alpha = {alpha} {suffix}");
            comparison.curve("derivative", &name, &numbers(reference), &run.column("strut.derivative"), TOLERANCE);
            kinematics(&mut comparison, &oracle, &run);
        }
        for case in oracle["cases"].as_array().unwrap() {
            let element = magnetorheological(number(&case["lambda"]), derivative);
            forces(&mut comparison, case, suffix, &run(&format!("{ARM}{element}{PATH}{times}")));
        }
    }
    comparison.report("gripper_path_magnetorheological");
    assert_eq!(comparison.count, 41 * 2 * (12 + 4));
}
