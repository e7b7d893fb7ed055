//! What drives the joints at one time: checked where it is asked for.

use super::context::Context;
use super::evaluate::Evaluation;
use crate::actuation::Forward;
use crate::model::Model;
use crate::motion::JointPath;
use crate::signal::Signal;
use crate::system::error::RunError;

/// The actuator force on velocity `k` at t.
pub(crate) fn force_at(cx: Context, k: usize, signal: &Signal, t: f64) -> Result<f64, RunError> {
    finite(cx, k, t, cx.force(k, signal, t))
}

/// The force `value` on velocity `k` at t.
pub(crate) fn finite(cx: Context, k: usize, t: f64, value: f64) -> Result<f64, RunError> {
    if value.is_finite() {
        return Ok(value);
    }
    Err(RunError::NotFinite { t, what: format!("tau.{}", cx.system.model.v_labels()[k].name), value })
}

/// The coordinates, velocities and accelerations of joint `j`, which `path` prescribes, at t; `q`, `v` and `a` are those of the
/// whole robot.
fn take_path(
    model: &Model,
    j: usize,
    path: &JointPath,
    t: f64,
    q: &mut [f64],
    v: &mut [f64],
    a: &mut [f64],
) -> Result<(), RunError> {
    let (places, rates) = (model.q_range(j), model.v_range(j));
    path.at(t, &mut q[places.clone()], &mut v[rates.clone()], &mut a[rates.clone()]);
    for (symbol, values, range) in [("q", q, places), ("v", v, rates.clone()), ("a", a, rates)] {
        if let Some(k) = range.clone().find(|&k| !values[k].is_finite()) {
            let labels = if symbol == "q" { model.q_labels() } else { model.v_labels() };
            return Err(RunError::NotFinite { t, what: format!("{symbol}.{}", labels[k].name), value: values[k] });
        }
    }
    Ok(())
}

impl Forward {
    /// Puts the coordinates, velocities and accelerations of all joints that signals move, at t, into those of the whole robot.
    ///
    /// # Errors
    /// [`RunError::NotFinite`].
    pub(crate) fn take_paths(
        &self,
        model: &Model,
        t: f64,
        q: &mut [f64],
        v: &mut [f64],
        a: &mut [f64],
    ) -> Result<(), RunError> {
        self.paths(model).try_for_each(|(j, path)| take_path(model, j, path, t, q, v, a))
    }
}

/// What drives the joints at t, and the places of those that signals move.
pub(crate) fn drive(cx: Context, forward: &Forward, t: f64, evaluation: &mut Evaluation) {
    let model = &cx.system.model;
    for (j, signals) in forward.forced(model) {
        for (k, signal) in model.v_range(j).zip(signals) {
            evaluation.driven[k] = Some(cx.force(k, signal, t));
        }
    }
    for (j, path) in forward.paths(model) {
        let (q, v) = (model.q_range(j), model.v_range(j));
        path.at(t, &mut evaluation.q[q], &mut evaluation.v[v.clone()], &mut evaluation.a[v]);
    }
    for j in forward.locked(model) {
        let (q, v) = (model.q_range(j), model.v_range(j));
        evaluation.q[q.clone()].copy_from_slice(&forward.q[q]);
        evaluation.v[v.clone()].fill(0.0);
        evaluation.a[v].fill(0.0);
    }
}
