//! The equations of motion at one time: the numbers of a run's row, and nothing left over.

use crate::support::robots::{ARM, SWING, every, springpot};
use crate::support::{cases, scenarios, shipped};
use springpot::driver::{Equation, EquationError, run as simulate};
use springpot::system::Motion;
use springpot::system::{RowTimes, Settings, Stop};
use springpot_scenario::Cases;

/// Times of a motion as shares of its duration; all but the end are no multiples of a step.
const SHARES: [f64; 4] = [0.0, 0.1037, 0.5219, 1.0];

/// The columns of a row that an equation holds too.
fn told(equation: &Equation, labels: &[String], q_labels: &[String]) -> Vec<(String, f64)> {
    let state = &equation.state;
    let mut told = vec![("t".to_owned(), equation.t)];
    let mut all = |prefix: &str, labels: &[String], values: &[f64]| {
        assert_eq!(labels.len(), values.len());
        told.extend(labels.iter().zip(values).map(|(label, value)| (format!("{prefix}.{label}"), *value)));
    };
    all("q", q_labels, &state.q);
    all("v", labels, &state.v);
    all("a", labels, &state.a);
    all("tau", labels, &equation.tau);
    for element in &equation.elements {
        all(&format!("{}.Q", element.name), labels, &element.q_force);
        let keys = ["length", "stroke", "rate", "derivative", "force"].map(str::to_owned);
        let values = [element.length, element.stroke, element.rate, element.derivative, element.force];
        all(&element.name, &keys, &values);
    }
    told
}

/// Compares a case at [`SHARES`] of its motion; returns how many numbers were compared.
fn check(what: &str, cases: &Cases, case: usize) -> usize {
    let plan = cases.plan(case).unwrap();
    let (system, settings) = (plan.system(), plan.settings.clone());
    // Named schemes live on the rows, and steps of robots that move by themselves may end on rows.
    let named_scheme = system.elements.iter().any(|element| element.scheme.is_some());
    let of_rows = named_scheme || matches!(system.motion, Motion::Forward(_));
    let count = settings.rows.count() - 1;
    let times: Vec<f64> = match of_rows {
        true => SHARES.map(|share| settings.rows.at((share * count as f64) as usize)).to_vec(),
        false => SHARES.map(|share| share * settings.end).to_vec(),
    };
    let rows_at = if of_rows { settings.rows.clone() } else { RowTimes::Times(times.as_slice().into()) };
    let mut table = system.table();
    let (_, outcome) =
        simulate(&system, &Settings { rows: rows_at, ..settings.clone() }, &mut table, &Stop::new(false));
    outcome.unwrap();

    let columns: Vec<&str> = table.columns().iter().map(|column| column.name.as_str()).collect();
    let written = table.column("t").unwrap();
    let names = |labels: Vec<springpot::model::Label>| labels.into_iter().map(|label| label.name).collect::<Vec<_>>();
    let (labels, q_labels) = (names(system.model.v_labels()), names(system.model.q_labels()));
    let mut compared = 0;
    for t in times {
        let row = table.row(written.iter().position(|at| *at == t).unwrap());
        let equation = system.equation(&settings, t).unwrap();
        for (name, value) in told(&equation, &labels, &q_labels) {
            let Some(column) = columns.iter().position(|column| *column == name) else {
                assert!(name.ends_with(".derivative") && value.is_nan(), "{what} case {case}: no column {name}");
                continue;
            };
            let expected = row[column];
            assert_eq!(value.to_bits(), expected.to_bits(), "{what} case {case}, {name} at {t}: {value} {expected}");
            compared += 1;
        }
        let singular = equation.elements.iter().any(|element| element.force.is_nan());
        let largest =
            equation.residual().into_iter().fold(0.0, |m: f64, r| if r.is_nan() { f64::NAN } else { m.max(r.abs()) });
        // Accelerations between steps are interpolated where forces bring them about.
        let bound = if matches!(system.motion, Motion::Forward(_)) { 1e-8 } else { 1e-13 };
        assert!(singular || largest <= bound * equation.largest_term(), "{what} case {case} at {t}: {largest}");
    }
    compared
}

#[test]
fn every_shipped_scenario_closes_with_the_numbers_of_its_run() {
    let mut compared = 0;
    let mut files = 0;
    for entry in std::fs::read_dir(scenarios()).unwrap().map(Result::unwrap) {
        let name = entry.file_name().into_string().unwrap();
        if name.ends_with(".toml") {
            let cases = shipped(&name, &[]);
            compared += check(&name, &cases, cases.len() - 1);
            files += 1;
        }
    }
    assert!(files >= 9 && compared > 36 * files, "{compared} numbers of {files} scenarios");
}

#[test]
fn what_is_no_time_of_the_motion_is_an_error() {
    let cases = cases(&format!("{ARM}{}{SWING}{}", springpot(0.5, "caputo"), every(1.0, 0.1)));
    let plan = cases.plan(0).unwrap();
    let system = plan.system();
    for t in [-1e-300, 1.0_f64.next_up(), f64::NAN, f64::INFINITY] {
        let error = system.equation(&plan.settings, t).unwrap_err();
        assert!(matches!(error, EquationError::Outside { end: 1.0, .. }), "{error}");
    }
    let scheme = springpot(0.5, "caputo") + "scheme = \"l1\"\n";
    let cases = crate::support::cases(&format!("{ARM}{scheme}{SWING}{}", every(1.0, 0.1)));
    let plan = cases.plan(0).unwrap();
    let error = plan.system().equation(&plan.settings, 0.34).unwrap_err();
    assert!(matches!(error, EquationError::NotARow { nearest: 0.3, .. }), "{error}");
    // A motion that an event ends is no longer than that.
    let stop = "[motion]\nkind = \"forward\"\n[[event]]\nname = \"stop\"\nwhen = \"t - 0.25\"\naction = \"stop\"\n";
    let cases = crate::support::cases(&format!("{ARM}{}{stop}{}", springpot(0.5, "caputo"), every(1.0, 0.1)));
    let plan = cases.plan(0).unwrap();
    let system = plan.system();
    assert_eq!(system.equation(&plan.settings, 0.2).unwrap().t, 0.2);
    for t in [0.3, 0.31] {
        let error = system.equation(&plan.settings, t).unwrap_err();
        assert!(matches!(error, EquationError::Outside { end, .. } if (end - 0.25).abs() < 1e-12), "{error}");
    }
}
