//! The three-body arm under control against an independent program (testdata/control/arm.py).

use super::support::robots::{ARM, strut};
use super::support::run;

const REFERENCE: &str = include_str!("../../../../testdata/control/arm.csv");

const KP: &str = "{ q1 = 200, q2 = 300, q3 = 120 }";
const KD: &str = "{ q1 = 20, q2 = 30, q3 = 8 }";

/// The arm with its spring and dashpot, moving from point to point; `controller` is the rest of that table.
pub(super) fn scenario(controller: &str, output_step: f64) -> String {
    let strut = strut("law = \"kelvin-voigt\"\nparameters = { k = 400, c = 15 }");
    format!(
        "{ARM}{strut}\n[motion]\nkind = \"forward\"\nstart = {{ q = {{ q2 = 0.1, q3 = 0.2 }} }}\n[motion.controller]\n{controller}\n\
         reference = {{ kind = \"move\", to = {{ q1 = 0.6, q2 = -0.2, q3 = 0.9 }}, duration = \"0.8 s\" }}\n\
         [time]\nend = \"1.5 s\"\noutput_step = {output_step}\n"
    )
}

/// Compares a run with the reference of that name: q within 1e-10 rad, v and τ within 1e-8 of their units; the number of numbers compared.
fn compare(name: &str, controller: &str) -> usize {
    let got = run(&scenario(controller, 0.1));
    assert!(got.residual() < 1e-8, "{name}: {}", got.residual());
    let rows: Vec<Vec<f64>> = REFERENCE
        .lines()
        .filter_map(|line| line.strip_prefix(&format!("{name},")))
        .map(|line| line.split(',').map(|x| x.parse().unwrap()).collect())
        .collect();
    assert_eq!(rows.len(), 16, "{name}");
    let columns = ["t", "q.q1", "q.q2", "q.q3", "v.q1", "v.q2", "v.q3", "tau.q1", "tau.q2", "tau.q3"];
    let mut compared = 0;
    for (k, column) in columns.into_iter().enumerate() {
        let most = if k < 4 { 1e-10 } else { 1e-8 };
        for (row, value) in rows.iter().zip(got.column(column)) {
            assert!((row[k] - value).abs() <= most, "{name} {column} at {}: {value}, not {}", row[0], row[k]);
            compared += 1;
        }
    }
    compared
}

#[test]
fn laws_that_are_smooth() {
    let compared = [
        compare("pd-gravity", &format!("kind = \"pd-gravity\"\nkp = {KP}\nkd = {KD}")),
        compare("computed-torque", "kind = \"computed-torque\"\nkp = 80\nkd = 15"),
        compare("impedance", "kind = \"impedance\"\nkp = 900\nkd = 60"),
    ];
    assert_eq!(compared.iter().sum::<usize>(), 480);
}

#[test]
fn integrals_at_limits_freeze_and_slide() {
    let ki = "{ q1 = 400, q2 = 2500, q3 = 300 }";
    let limits = "{ q1 = 6, q2 = 26, q3 = 7 }";
    compare("pid-limits", &format!("kind = \"pid\"\nkp = {KP}\nkd = {KD}\nki = {ki}\nlimits = {limits}"));
}

#[test]
fn limits_of_rates() {
    let law = format!(
        "kind = \"pd-gravity\"\nkp = {KP}\nkd = {KD}\nrate_limits = {{ q1 = 60, q2 = 150, q3 = 30 }}\nlimits = {{ q1 = 9, q2 = 26, q3 = 8 }}"
    );
    compare("pd-rate-limits", &law);
}

#[test]
fn samples_and_delays_cost_no_accuracy() {
    let law = "kind = \"computed-torque\"\nkp = 80\nkd = 15\nlimits = { q1 = 24, q2 = 48, q3 = 18 }\nsample = \"5 ms\"";
    compare("sampled-computed-torque", law);
    compare("delayed-computed-torque", &format!("{law}\ndelay = \"10 ms\""));
    let law = format!(
        "kind = \"pid\"\nkp = {KP}\nkd = {KD}\nki = {{ q1 = 80, q2 = 150, q3 = 60 }}\nlimits = {{ q1 = 12, q2 = 24, q3 = 9 }}\nsample = \"10 ms\""
    );
    compare("sampled-pid-limits", &law);
}

#[test]
fn the_gripper_errs_by_the_distance_from_the_reference() {
    let run = run(&scenario("kind = \"pd-gravity\"\nkp = 200\nkd = 20", 0.1));
    let [first, .., last] = &run.column("gripper.error")[..] else { panic!("rows") };
    assert_eq!(*first, 0.0);
    // H(q) and H(q_d) by hand: the arm of scenarios/, whose last joint turns about the same axis as the second.
    let place = |q: [f64; 3]| {
        let (r, z) = (0.5 * q[1].cos() + 0.4 * (q[1] + q[2]).cos(), 0.6 - 0.5 * q[1].sin() - 0.4 * (q[1] + q[2]).sin());
        [r * q[0].cos(), r * q[0].sin(), z]
    };
    let end = |name: &str| *run.column(name).last().unwrap();
    let (is, wanted) = (place(["q.q1", "q.q2", "q.q3"].map(end)), place([0.6, -0.2, 0.9]));
    let off: f64 = is.iter().zip(wanted).map(|(is, wanted)| (is - wanted).powi(2)).sum();
    assert!((last - off.sqrt()).abs() < 1e-12, "{last} {}", off.sqrt());
}

#[test]
fn a_reference_that_jumps_is_refused_where_it_would_make_an_impulse() {
    let text = |kind: &str| {
        let reference = "{ kind = \"joints\", q1 = \"0.1*step(t - 0.5)\", q2 = 0, q3 = 0 }";
        format!(
            "{ARM}\n[motion]\nkind = \"forward\"\n[motion.controller]\nkind = \"{kind}\"\nkp = 100\nkd = 20\nreference = {reference}\n\
             [time]\nend = 1\noutput_step = 0.1\n"
        )
    };
    let error = super::support::try_run(&text("computed-torque")).error.expect("a jump").to_string();
    assert!(error.starts_with("t = 0.5 s: the reference of joint \"q1\" jumps by 1e-1"), "{error}");
    // A step of what is wanted is a step of the force elsewhere.
    let run = run(&text("pd-gravity"));
    let tau = run.column("tau.q1");
    assert!((tau[5] - 10.0).abs() < 1e-9 && tau[4].abs() < 1e-9, "{tau:?}");
}
