//! Runs of the smallest robot with one element.

#![allow(dead_code, reason = "each test uses its share")]

use springpot::law::Catalog;
use springpot::simulate::{Report, RunError, Stop, along};
use springpot_scenario::Scenario;

/// Rows of a slider of 1 kg on the x axis, drawn by the element `e` from the world: its stroke is q.
pub(crate) struct Run {
    columns: Vec<String>,
    pub(crate) rows: Vec<Vec<f64>>,
    pub(crate) report: Report,
    pub(crate) outcome: Result<(), RunError>,
}

impl Run {
    pub(crate) fn new(element: &str, q: &str, end: f64, step: f64) -> Self {
        let text = format!(
            r#"
[[robot.body]]
name = "slider"
joint = {{ name = "q", kind = "prismatic", axis = [1, 0, 0], origin = [1, 0, 0] }}
mass = 1
[[element]]
name = "e"
from = {{ body = "world", point = [0, 0, 0] }}
to = {{ body = "slider", point = [0, 0, 0] }}
rest_length = 1
{element}
[motion]
kind = "prescribed"
joints = {{ q = "{q}" }}
[time]
end = {end}
output_step = {step}
"#
        );
        let scenario = Scenario::parse(&text, "slider.toml", "").unwrap();
        let plan = scenario.cases(&Catalog::standard()).unwrap().plan(0).unwrap();
        let system = plan.system();
        let columns = system.columns().into_iter().map(|column| column.name).collect();
        let mut rows: Vec<Vec<f64>> = Vec::new();
        let mut keep = |row: &[f64]| {
            rows.push(row.to_vec());
            Ok(())
        };
        let (report, outcome) = along(&system, &plan.settings, &mut keep, &Stop::new(false));
        Self { columns, rows, report, outcome }
    }

    pub(crate) fn springpot(alpha: f64, q: &str, end: f64, step: f64) -> Self {
        let run = Self::new(&format!("law = \"springpot\"\nparameters = {{ c = 3.0, alpha = {alpha} }}"), q, end, step);
        assert!(run.outcome.is_ok(), "alpha {alpha}, {q}: {:?}", run.outcome);
        run
    }

    pub(crate) fn column(&self, name: &str) -> Vec<f64> {
        let k = self.columns.iter().position(|column| column == name).unwrap();
        self.rows.iter().map(|row| row[k]).collect()
    }

    /// Largest |D^alpha x − exact(t)|; every row must be there and filled.
    pub(crate) fn largest_error(&self, end: f64, step: f64, exact: impl Fn(f64) -> f64) -> f64 {
        let (t, derivative) = (self.column("t"), self.column("e.derivative"));
        assert_eq!(t.len(), (end / step).round() as usize + 1);
        t.iter()
            .zip(derivative)
            .map(|(t, d)| (d - exact(*t)).abs())
            .fold(0.0, |m, e| if e > m || e.is_nan() { e } else { m })
    }
}
