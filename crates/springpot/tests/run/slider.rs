//! Runs of the smallest robot with one element.

use crate::support::{Run, run, try_run};

/// A slider of 1 kg on the x axis, drawn by the element `e` from the world: its stroke is q.
fn text(element: &str, q: &str, end: f64, step: f64) -> String {
    format!(
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
    )
}

/// A run of the slider with an element; it may fail.
pub(crate) fn with(element: &str, q: &str, end: f64, step: f64) -> Run {
    try_run(&text(element, q, end, step))
}

/// A run of the slider with a springpot.
pub(crate) fn springpot(alpha: f64, q: &str, end: f64, step: f64) -> Run {
    run(&text(&format!("law = \"springpot\"\nparameters = {{ c = 3.0, alpha = {alpha} }}"), q, end, step))
}

/// Largest |D^alpha x − exact(t)|; every row must be there and filled.
pub(crate) fn largest_error(run: &Run, end: f64, step: f64, exact: impl Fn(f64) -> f64) -> f64 {
    let (t, derivative) = (run.t(), run.column("e.derivative"));
    assert_eq!(t.len(), (end / step).round() as usize + 1);
    t.iter()
        .zip(derivative)
        .map(|(t, d)| (d - exact(*t)).abs())
        .fold(0.0, |m, e| if e > m || e.is_nan() { e } else { m })
}
