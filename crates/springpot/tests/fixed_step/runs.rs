//! Whole runs: rows, the last step, the ledger.

use crate::loops::*;
use springpot::law::Catalog;
use springpot::methods::fixed::Method;
use springpot::system::{FixedStep, Settings};
use springpot_scenario::Scenario;

const START: &str = "start = { q = { q2 = 0.1 }, v = { q1 = 0.5 } }";

#[test]
fn a_scenario_names_method_and_step() {
    let text = arm(&format!(
        "{}{}[solver]\nmethod = \"midpoint\"\nstep = \"2 ms\"\nmemory_rtol = 1e-8\n",
        thermoviscoelastic(0.5, "caputo"),
        free(START)
    ));
    let cases = Scenario::parse(&text, "arm.toml", "").unwrap().cases(&Catalog::standard()).unwrap();
    let plan = cases.plan(0).unwrap();
    assert_eq!(plan.resolved()["solver"]["method"], "midpoint");
    assert_eq!(plan.resolved()["solver"]["step"], 0.002);
    let (rows, report, outcome) = rows(&plan.system(), &plan.settings);
    outcome.unwrap();
    assert_eq!((rows.len(), report.steps, report.rejected_steps), (11, 500, 0));
    assert_eq!(report.newton_iterations, Some(1500));
}

#[test]
fn rows_are_those_of_the_loop() {
    let system = system(&arm(&(thermoviscoelastic(0.5, "caputo") + &free(START))));
    for method in METHODS {
        let by = FixedStep { method, step: 1e-3 };
        let (rows, report, outcome) = rows(&system, &settings(0.3, &[0.0, 0.1, 0.3], Some(by)));
        outcome.unwrap();
        assert_eq!(report.steps, 300);
        for (row, t) in rows.iter().zip([0.0, 0.1, 0.3]) {
            let robot = looped(&system, method, 1e-3, t);
            assert_eq!(row[0], robot.t());
            assert!(distance(&row[1..7], &state(&robot)) < 1e-11, "{method:?} at {t}: {row:?}");
        }
    }
}

/// Rows between the ends of steps are on the curve, and accelerations solve the equations of motion.
#[test]
fn rows_between_the_steps_change_nothing_and_lie_between() {
    let system = system(&arm(&(thermoviscoelastic(0.5, "caputo") + &free(START))));
    let truth = rows(&system, &settings(0.5, &[0.1004, 0.2507, 0.5], None)).0;
    for (method, largest) in [(Method::BackwardEuler, [0.1, 1.0]), (Method::Midpoint, [1e-4, 2e-2])] {
        let run = |step: f64, times: &[f64]| {
            let (rows, report, outcome) = rows(&system, &settings(0.5, times, Some(FixedStep { method, step })));
            outcome.unwrap();
            assert!(report.steps > 0);
            rows
        };
        let fine = run(1e-3, &[0.1004, 0.2507, 0.5]);
        assert_eq!(fine[2], run(1e-3, &[0.5])[0]);
        for (row, truth) in fine.iter().zip(&truth) {
            assert!(distance(&row[1..7], &truth[1..7]) < largest[0], "{method:?}: {row:?} {truth:?}");
            assert!(distance(&row[7..10], &truth[7..10]) < largest[1], "{method:?}: {row:?} {truth:?}");
        }
        let by = FixedStep { method, step: 1e-3 };
        for t in [0.1, 0.2] {
            let equation = system.equation(&settings(0.5, &[t], Some(by)), t).unwrap();
            let left = equation.residual().into_iter().fold(0.0, |m: f64, x| m.max(x.abs()));
            assert!(left < 1e-11 * equation.largest_term(), "{left:e}");
        }
    }
}

#[test]
fn the_last_step_is_cut_where_the_end_is_no_multiple() {
    let system = system(&arm(&(thermoviscoelastic(0.5, "caputo") + &free(START))));
    let truth = truth(&system, 0.1234);
    for method in METHODS {
        let by = Some(FixedStep { method, step: 1e-3 });
        let (rows, report, outcome) = rows(&system, &settings(0.1234, &[0.1234], by));
        outcome.unwrap();
        assert_eq!(report.steps, 124);
        assert_eq!(rows[0][0], 0.1234);
        let error = distance(&rows[0][1..7], &truth);
        assert!(error < if method == Method::Midpoint { 1e-4 } else { 0.05 }, "{method:?}: {error:e}");
        // One step that is longer than the run is the run.
        let (rows, report, outcome) =
            self::rows(&system, &settings(0.01, &[0.01], Some(FixedStep { method, step: 5.0 })));
        outcome.unwrap();
        assert_eq!((rows.len(), report.steps), (1, 1));
    }
}

/// The residual is the method's own error: its order, not rounding.
#[test]
fn the_ledger_measures_the_method() {
    for alpha in [0.3, 0.8] {
        let system = system(&arm(&(thermoviscoelastic(alpha, "caputo") + &free(START))));
        let residual = |method: Method, step: f64| {
            let (_, report, outcome) = rows(&system, &settings(0.5, &[0.25, 0.5], Some(FixedStep { method, step })));
            outcome.unwrap();
            report.energy_residual.unwrap() / report.energy_turned_over.unwrap()
        };
        // With alpha near 1 the midpoint's is so small that its order is not seen yet at these steps.
        for (method, order, largest) in [(Method::BackwardEuler, 0.9, 5e-3), (Method::Midpoint, 0.6, 2e-6)] {
            let off = [4e-3, 2e-3, 1e-3].map(|step| residual(method, step));
            println!("ledger, alpha {alpha}, {method:?}, 4, 2, 1 ms: {:.1e} {:.1e} {:.1e}", off[0], off[1], off[2]);
            assert!(off[2] < largest && off[2] > 1e-9, "{alpha} {method:?}: {off:?}");
            let found = (off[0] / off[2]).log2() / 2.0;
            assert!(found > order, "{alpha} {method:?}: {found} {off:?}");
        }
    }
}

#[test]
fn limits_on_steps_and_unknown_ledgers_are_told() {
    let system = system(&arm(&(thermoviscoelastic(0.5, "riemann-liouville") + &free(START))));
    let by = Some(FixedStep { method: Method::Midpoint, step: 1e-3 });
    let (rows, report, outcome) = rows(&system, &settings(0.1, &[0.0, 0.05, 0.1], by));
    outcome.unwrap();
    assert!(report.energy_residual.is_none() && rows[0][7].is_nan() && rows[1][7].is_finite());
    let few = Settings { max_steps: Some(60), ..settings(0.1, &[0.05, 0.1], by) };
    let (rows, report, outcome) = self::rows(&system, &few);
    assert_eq!((rows.len(), report.steps), (1, 60));
    assert!(outcome.unwrap_err().to_string().contains("60 steps are used up"));
}
