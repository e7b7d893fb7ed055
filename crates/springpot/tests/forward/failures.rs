//! Runs that cannot go on, and runs that must.

use crate::support::forward::{at, every, largest, slider, state};
use crate::support::{Run, run, try_run};
use springpot::law::Catalog;
use springpot::system::RunError;
use springpot_scenario::Scenario;

const SPRINGPOT: &str = "law = \"springpot\"\nparameters = { c = 30, alpha = 0.5 }";

/// A run that fails after some rows, which are all complete and finite.
fn failed(text: &str) -> (Run, RunError) {
    let mut run = try_run(text);
    let error = run.error.take().expect("a failure");
    assert_eq!(run.rows.len() as u64, run.report.rows);
    assert!(!run.rows.is_empty(), "{error}");
    assert!(run.rows.iter().flatten().all(|x| x.is_finite()));
    (run, error)
}

#[test]
fn points_that_meet_end_the_run_where_they_meet() {
    // Falling freely from 8 m onto the element's other end, which a spring of no strength marks: l = 8 − g t²/2.
    let spring = "law = \"spring\"\nparameters = { k = 1e-9 }";
    let text = slider("2", -9.81, spring, &state("0", "0")) + &every(5.0, 0.01, 1e-8);
    let (run, error) = failed(&text);
    let meeting = (16.0f64 / 9.81).sqrt();
    match &error {
        RunError::ZeroLength { t, element, length } => {
            assert!(element == "e" && (t - meeting).abs() < 1e-6 && *length < 1e-5, "{error}");
        }
        other => panic!("{other}"),
    }
    assert!(meeting - run.report.t_reached.unwrap() < 0.02, "{:?}", run.report);
}

#[test]
fn what_is_not_finite_is_named_with_its_time() {
    let with = |start: &str, law: &str| slider("2", -9.81, law, start) + &every(2.0, 0.01, 1e-8);
    let torque = state("0", "0") + "\ntorque = { q = \"sqrt(0.713 - t + 2*step(t - 0.7135))\" }";
    let tv = "law = \"thermoviscoelastic\"\nparameters = { E_c = 10, E_kv = 10, E_d = 10, alpha = 0.5, a_kv = 0.001 }\n\
              inputs = { T = \"300 + log(1.01 - t + 2*step(t - 1.0101))\" }";
    for (text, name, when) in [(with(&torque, SPRINGPOT), "tau.q", 0.713), (with(&state("0", "0"), tv), "e.T", 1.01)] {
        let (run, error) = failed(&text);
        let RunError::NotFinite { t, what, value } = &error else { panic!("{error}") };
        assert!(what == name && !value.is_finite() && (t - when).abs() < 0.05, "{error}");
        assert!(run.report.t_reached.unwrap() > when - 0.1, "{:?}", run.report);
        assert!(error.to_string().contains(name), "{error}");
    }
}

#[test]
fn a_prescribed_joint_that_jumps_or_is_not_finite_ends_the_run() {
    let body = |path: &str| {
        format!(
            r#"
[[robot.body]]
name = "cart"
joint = {{ name = "x", kind = "prismatic", axis = [1, 0, 0] }}
mass = 2
[[robot.body]]
name = "pendulum"
joint = {{ name = "swing", kind = "revolute", axis = [0, 1, 0] }}
mass = 1
com = [0, 0, -0.5]
inertia = {{ xx = 0.01, yy = 0.01, zz = 0.01 }}
[motion]
kind = "forward"
prescribed = {{ x = "{path}" }}
"#
        ) + &every(1.0, 0.01, 1e-8)
    };
    let (_, error) = failed(&body("0.1*step(t - 0.35)"));
    assert!(error.to_string().starts_with("t = 0.35") && error.to_string().contains("joint \"x\" jumps by"), "{error}");
    let (_, error) = failed(&body("0.1*sqrt(0.5 - step(t - 0.505) + step(t - 0.515))"));
    let RunError::NotFinite { what, .. } = &error else { panic!("{error}") };
    assert!(what.ends_with(".x"), "{error}");
}

#[test]
fn stiffness_beyond_reason_runs_or_says_why() {
    for (k, c, alpha) in [(1e12, 1e6, 0.5), (1e12, 1e12, 0.05), (1e9, 1.0, 0.9), (0.0, 1e12, 0.1), (0.0, 1e15, 0.02)] {
        let law = format!("law = \"fractional-kelvin-voigt\"\nparameters = {{ k = {k}, c = {c}, alpha = {alpha} }}");
        let text = slider("2", -9.81, &law, &state("0", "0")) + &every(1.0, 0.1, 1e-6) + "max_steps = 200000\n";
        let run = try_run(&text);
        println!(
            "k = {k:e}, c = {c:e}, alpha = {alpha}: {:?} {:?}",
            run.report,
            run.error.as_ref().map(ToString::to_string)
        );
        match &run.error {
            None => assert!(largest(run.column("q.q")) < 1e-3, "{k:e} {c:e} {alpha}: {:?}", run.column("q.q")),
            Some(RunError::StepTooSmall { subject, .. }) => assert!(subject.contains("\"q\""), "{subject}"),
            Some(RunError::NoConvergence { joint, .. }) => assert_eq!(joint, "q"),
            Some(RunError::TooManySteps { .. }) => {}
            Some(other) => panic!("{other}"),
        }
        assert!(run.rows.iter().flatten().all(|x| x.is_finite()));
    }
}

#[test]
fn small_orders_stay_bounded_when_stiff() {
    // Through rates alone these explode: order below ½ and a step of many periods.
    for alpha in [0.01, 0.05, 0.1, 0.2, 0.3, 0.45] {
        let law = format!("law = \"springpot\"\nparameters = {{ c = 1e7, alpha = {alpha} }}");
        let text = slider("2", -9.81, &law, &state("0", "0")) + &every(10.0, 0.5, 1e-4);
        let run = run(&text);
        // Between the spring and the creep of the springpot: |x| = m g t^alpha/(c Γ(1 + alpha)) when nothing swings.
        let slow = 2.0 * 9.81 * 10f64.powf(alpha) / 1e7;
        assert!(largest(run.column("q.q")) < 3.0 * slow, "alpha = {alpha}: {:?}", run.column("q.q"));
        println!("alpha = {alpha}: {} steps, {:.1e} of {slow:.1e}", run.report.steps, largest(run.column("q.q")));
    }
}

#[test]
fn rest_without_gravity_is_rest() {
    for law in [SPRINGPOT, "law = \"spring\"\nparameters = { k = 10 }", "law = \"dashpot\"\nparameters = { c = 10 }"] {
        let run = run(&(slider("2", 0.0, law, &state("0", "0")) + &every(1000.0, 100.0, 1e-8)));
        for name in run.names.iter().filter(|name| *name != "t" && *name != "e.length") {
            assert!(run.column(name).iter().all(|x| *x == 0.0), "{name}: {:?}", run.column(name));
        }
        assert!(run.report.steps < 120, "{:?}", run.report);
        assert_eq!((run.report.rejected_steps, run.report.energy_residual), (0, Some(0.0)));
    }
}

#[test]
fn limits_of_steps_and_tolerances() {
    let text = slider("2", -9.81, SPRINGPOT, &state("0", "0"));
    let (run, error) = failed(&(text.clone() + &every(5.0, 0.01, 1e-8) + "max_steps = 50\n"));
    assert!(matches!(error, RunError::TooManySteps { limit: 50, .. }), "{error}");
    assert_eq!(run.report.steps, 50);
    let absurd = text.clone() + &at("1", "1", 1e-16);
    let refused = Scenario::parse(&absurd, "test.toml", "").and_then(|s| s.cases(&Catalog::standard()));
    assert!(refused.unwrap_err().to_string().contains("outside 1e-13"));
    // The smallest tolerance still comes to an end.
    let smallest = try_run(&(text + &at("1", "1", 1e-13)));
    assert!(smallest.error.is_none(), "{:?}", smallest.error);
}

#[test]
fn extreme_forces_and_starts() {
    let torque = |force: &str| {
        slider("2", -9.81, SPRINGPOT, &(state("0", "0") + &format!("\ntorque = {{ q = \"{force}\" }}")))
            + &every(1e-3, 1e-4, 1e-8)
    };
    let pushed = run(&torque("1e6"));
    let x = *pushed.column("q.q").last().unwrap();
    assert!((x - 0.5 * (1e6 / 2.0 - 9.81) * 1e-6).abs() < 1e-3 * x, "{x}");
    let absurd = try_run(&torque("1e300"));
    let error = absurd.error.expect("beyond double precision").to_string();
    assert!(error.contains("v.q is inf"), "{error}");
    assert!(absurd.rows.iter().flatten().all(|x| x.is_finite()));
    // An arm stretched out, whose gripper could not be driven from here; forward it just falls.
    let stretched =
        crate::support::forward::falling(0.5, 25.0, "caputo", "start = { q = { q2 = -1.5707963267948966 } }");
    let fallen = run(&(stretched + &every(1.0, 0.01, 1e-8)));
    assert!(fallen.residual() < 1e-8);
}
