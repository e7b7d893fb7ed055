//! What a run says of itself at its end.

use crate::random::slider;
use crate::support::{cases, run_system, try_run};
use springpot::signal::Signal;
use springpot::system::{RunError, Settings};

const SPRINGPOT: &str = "law = \"springpot\"\nparameters = { c = 1, alpha = 0.5 }";

#[test]
fn a_signal_that_changes_too_often_is_refused_before_the_run() {
    let motion = "kind = \"forward\"\nstart = { q = { q = 1 } }\ntorque = { q = \"sign(sin(2*pi*1e4*t))\" }";
    let text = slider(SPRINGPOT, motion, 3.0, 3) + "[solver]\nmax_steps = 1000\n";
    let cases = cases(&text);
    let plan = cases.plan(0).unwrap();
    let run = run_system(&plan.system(), &plan.settings);
    assert!(matches!(run.error, Some(RunError::TooBusy { limit: 1000, .. })), "{:?}", run.error);
    assert_eq!(run.rows.len(), 0);
    // Without a limit of the user's it grows with the switches.
    let settings = Settings { max_steps: None, ..plan.settings.clone() };
    let run = run_system(&plan.system(), &settings);
    assert!(run.error.is_none() && run.report.switches == Some(59_999), "{:?}", run.report);
}

/// Where steps are too short, or too few are allowed, no signal is to blame.
#[test]
fn too_few_steps_are_told_from_signals_that_change() {
    for motion in
        ["kind = \"forward\"\nstart = { q = { q = 1 } }", "kind = \"prescribed\"\njoints = { q = \"sin(t)\" }"]
    {
        for (key, most) in [("max_steps = 5", 5), ("max_step = 1e-9", 10_000_000)] {
            let cases = cases(&(slider(SPRINGPOT, motion, 3.0, 3) + "[solver]\n" + key + "\n"));
            let plan = cases.plan(0).unwrap();
            let error = run_system(&plan.system(), &plan.settings).error.unwrap();
            assert!(matches!(error, RunError::TooShortSteps { limit, .. } if limit == most), "{motion} {key}: {error}");
            let help = plan.cure(&error).help.unwrap();
            assert_eq!(help.contains("solver.max_step,"), key.starts_with("max_step ="), "{help}");
        }
    }
}

#[test]
fn the_resolution_is_recorded() {
    let text = slider(SPRINGPOT, "kind = \"prescribed\"\njoints = { q = \"1+0.1*sin(t)\" }", 8.0, 8);
    let cases = cases(&text);
    let plan = cases.plan(0).unwrap();
    let run = run_system(&plan.system(), &plan.settings);
    assert_eq!((run.report.switches, run.report.resolution), (Some(0), Some(8.0 / (1u64 << 30) as f64)));
    assert!(run.report.is_balanced());
}

#[test]
fn no_number_of_elements_hides_a_kink() {
    // 130 elements with one stepped input.
    let one = slider(
        "law = \"magnetorheological\"\nparameters = { E_c = 1, mu_0 = 1, mu = 2, alpha = 0.5 }\ninputs = { u = \"step(t-0.5)\" }",
        "kind = \"prescribed\"\njoints = { q = \"1+0.1*sin(3*t)\" }",
        1.0,
        4,
    );
    let cases = cases(&one);
    let plan = cases.plan(0).unwrap();
    let mut system = plan.system();
    let element = system.elements[0].clone();
    system.elements = (0..130)
        .map(|k| {
            let mut element = element.clone();
            element.name = format!("e{k}");
            element.inputs = vec![Signal::expression("step(t-0.5)".parse().unwrap())];
            element
        })
        .collect();
    let run = run_system(&system, &plan.settings);
    assert!(run.error.is_none(), "{:?}", run.error);
    assert_eq!(run.report.switches, Some(1));
    assert!(run.residual() < 1e-7, "{}", run.residual());
}

#[test]
fn what_overflows_is_a_failure() {
    let law = "law = \"thermoviscoelastic\"\nscheme = \"l1\"\ninputs = { T = \"60 degC\" }\nparameters = { E_c = 30, E_kv = 20, E_d = 50, alpha = 0.5, a_kv = 1.7e308 }";
    let text = slider(law, "kind = \"prescribed\"\njoints = { q = \"1+0.1*sin(t)\" }", 1.0, 4);
    let run = try_run(&text);
    let Some(RunError::NotFinite { what, .. }) = &run.error else { panic!("{:?}", run.error) };
    assert_eq!(what, "tau.q");
    let text = slider(SPRINGPOT, "kind = \"prescribed\"\njoints = { q = \"1+0.3*min(1,1e300*t)\" }", 1.0, 4);
    assert!(try_run(&text).error.is_some());
}
