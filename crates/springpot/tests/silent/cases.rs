//! The scenarios of `testdata/silent/`, against values found by other means.

use crate::support::{Run, run_system};
use springpot::law::Catalog;
use springpot::system::RunError;
use springpot_scenario::Scenario;
use std::path::PathBuf;

/// Runs a scenario of `testdata/silent/` after `overrides`; it may fail.
pub(crate) fn silent(name: &str, overrides: &[&str]) -> Run {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../testdata/silent").join(format!("{name}.toml"));
    let mut scenario = Scenario::read(path).unwrap_or_else(|refusals| panic!("{refusals}"));
    for assignment in overrides {
        scenario.set(assignment).unwrap_or_else(|refusals| panic!("{refusals}"));
    }
    let cases = scenario.cases(&Catalog::standard()).unwrap_or_else(|refusals| panic!("{refusals}"));
    let plan = cases.plan(0).expect("a valid plan");
    run_system(&plan.system(), &plan.settings)
}

/// The column of a run at the times of `expected` is right to `digits` of the largest of `expected`.
pub(crate) fn holds(run: &Run, column: &str, expected: &[(f64, f64)], tolerance: f64) {
    assert!(run.error.is_none(), "{}", run.error.as_ref().unwrap());
    let (t, values) = (run.column("t"), run.column(column));
    let scale = expected.iter().fold(0.0, |largest: f64, (_, value)| largest.max(value.abs()));
    for (at, value) in expected {
        let row = t.iter().position(|t| t == at).unwrap_or_else(|| panic!("no row at {at}"));
        assert!((values[row] - value).abs() <= tolerance * scale, "{column} at {at}: {} {value}", values[row]);
    }
}

#[test]
fn a_switched_torque_moves_its_mass() {
    // Impulse response in closed form, convolved with the 20 000 windows: 9 digits.
    let run = silent("d1a_pwm_torque", &["time.end=20"]);
    holds(&run, "e.stroke", &[(10.0, 1.407_667_82), (20.0, 1.141_553_87)], 1e-8);
    assert_eq!(run.report.switches, Some(40_000));
    assert!(run.residual() < 1e-8, "{}", run.residual());
}

#[test]
fn a_switched_damper_damps() {
    // Matrix exponentials of the mode-extended state, phase by phase: 5 digits.
    let run = silent("d1b_pwm_damper", &[]);
    holds(&run, "e.stroke", &[(10.0, 0.025_269), (35.0, 0.007_357_0), (60.0, 0.001_507_8)], 3e-5);
    assert!(run.residual() < 1e-6, "{}", run.residual());
}

#[test]
fn the_ledger_of_a_switched_damper_closes() {
    // Analytic lags of the modes, Gauss in every window.
    for (name, dissipated) in [("d1c_pwm_ledger", 0.286_79), ("d1d_pwm_ledger_300", 12.714_7)] {
        let run = silent(name, &[]);
        holds(&run, "e.dissipated", &[(10.0, dissipated)], 2e-5);
        assert!(run.residual() < 1e-7, "{name}: {}", run.residual());
    }
}

#[test]
fn trains_of_pulses_are_seen() {
    // Quadrature of the memory integral.
    holds(&silent("d2a_endurance", &[]), "e.derivative", &[(306.0, 0.366_098_4), (597.7, -1.109_42e-3)], 1e-6);
    holds(&silent("d2b_taps", &[]), "e.derivative", &[(30.26, 6.002_7e-3)], 1e-5);
}

#[test]
fn a_hammer_strikes() {
    let run = silent("d2c_hammer", &[]);
    assert!(run.error.is_none());
    let after = run.column("t").into_iter().zip(run.column("e.stroke")).filter(|(t, _)| *t > 31.4);
    let largest = after.fold(0.0, |largest: f64, (_, x)| largest.max(x.abs()));
    assert!((largest / 0.036_114_32 - 1.0).abs() < 1e-6, "{largest}");
}

#[test]
fn a_small_vibration_is_as_exact_as_a_large_one() {
    // Closed form, 30 digits: of the amplitude 1e-7.
    let run = silent("d5_small_amplitude", &[]);
    assert!(run.error.is_none());
    let (t, x) = (run.column("t"), run.column("e.stroke"));
    let row = t.iter().position(|t| *t == 2.5).unwrap();
    assert!((x[row] - 4.355e-9).abs() < 1e-12, "{}", x[row]);
}

#[test]
fn a_jump_of_a_nanometre_is_refused() {
    let run = silent("d6_jump_1nm", &[]);
    assert!(matches!(run.error, Some(RunError::Jump { t: 1.0, .. })), "{:?}", run.error);
    // So is one right after the start.
    let run = silent("d6_jump_1nm", &["motion.joints.q=1+1e-9*sign(t)"]);
    assert!(matches!(run.error, Some(RunError::Jump { .. })), "{:?}", run.error);
}

#[test]
fn a_pulse_in_a_long_rest_ends_the_rest() {
    let run = silent("d8_hang", &[]);
    assert!(run.error.is_none(), "{:?}", run.error);
    assert!(run.report.steps < 20_000, "{}", run.report.steps);
    let fine = silent("d8_hang", &["solver.max_step=0.0002"]);
    let (a, b) = (run.column("e.derivative"), fine.column("e.derivative"));
    let scale = b.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
    assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-8 * scale), "{a:?} {b:?}");
}

#[test]
fn the_usual_triangle_wave_runs() {
    let run = silent("h2_triangle", &[]);
    assert!(run.error.is_none(), "{:?}", run.error);
    for text in ["1+0.1*acos(cos(7*t))", "1+sqrt(sin(7*t)^2)", "1+0.1*asin(cos(7*t))"] {
        let set = format!("motion.joints.q={text}");
        let run = silent("h2_triangle", &[&set]);
        assert!(run.error.is_none(), "{text}: {:?}", run.error);
    }
}

#[test]
fn feedback_switches_with_time() {
    // Closed forms; the damper by an explicit method of order 8 at 1e-12.
    let x = [(19.0, 0.018_768_653_0), (25.0, 3.809_782_796), (35.0, 2.473_242_866), (60.0, 2.512_378_386)];
    holds(&silent("feedback_step_of_time", &[]), "q.x", &x, 1e-8);
    let x = [(19.0, 1.758_897_44), (25.0, 1.985_865_67), (35.0, 1.868_191_99), (60.0, 1.862_294_92)];
    holds(&silent("feedback_abs_of_time", &[]), "q.x", &x, 1e-8);
    let tau = [(19.0, 5.506_855_43), (25.0, 9.379_999_77), (35.0, 8.796_957_6), (60.0, 7.509_872_47)];
    holds(&silent("feedback_abs_of_time", &[]), "tau.x", &tau, 1e-8);
    let x = [(1.0, -0.302_282_89), (2.5, 0.064_860_93), (4.0, 0.003_386_87), (5.0, 0.000_070_91)];
    holds(&silent("feedback_input_step", &[]), "q.x", &x, 3e-8);
}
