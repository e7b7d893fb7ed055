//! A run looked at where rows were measured.

use super::compared::Predicted;
use springpot::Simulation;
use springpot::identification::Failed;
use springpot::observe::{Quantity, Snapshot};
use springpot::system::{Settings, System};

/// Something wanted of a run.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ask {
    /// When, s.
    pub(super) t: f64,
    /// Which column and row it is.
    pub(super) column: usize,
    pub(super) row: usize,
    pub(super) quantity: Quantity,
    /// Whether d/dt is wanted too.
    pub(super) wants_rate: bool,
}

/// Points of a rate, and how far apart they are, as a share of the step.
const POINTS: usize = 5;
const APART: f64 = 1.0 / 16.0;
/// Most steps of a trial, and how many more for each row: one far off may have no end.
const STEPS: [usize; 2] = [200_000, 1_000];

/// The beginning of a step is looked at so far behind it, as a share.
const BEHIND: f64 = 1e-9;

/// Runs the system as far as it is asked about. `by` says which parameter of the record each of its own is, of `count`. What is asked before the start
/// or behind the end is that of the start or the end.
pub(super) fn walk(
    system: System,
    settings: Settings,
    mut asks: Vec<Ask>,
    by: &[usize],
    count: usize,
    into: &mut Predicted,
) -> Result<(), Failed> {
    let failed = |error: springpot::system::RunError| Failed(error.to_string());
    let (end, most) = (settings.end, STEPS[0] + STEPS[1] * asks.len());
    let mut left = most;
    let mut run = Simulation::new(system, settings).map_err(failed)?;
    asks.sort_by(|a, b| a.t.total_cmp(&b.t));
    let mut snapshot: Option<(f64, Snapshot)> = None;
    for Ask { t, column, row, quantity, wants_rate } in asks {
        let is_inside = (0.0..=end).contains(&t);
        let t = t.clamp(0.0, end);
        while run.t() < t {
            if left == 0 {
                return Err(Failed(format!("the run takes more than {most} steps until t = {} s", run.t())));
            }
            left -= 1;
            if !run.step().map_err(failed)? && run.t() < t {
                return Err(Failed(format!("the run ends at t = {} s", run.t())));
            }
        }
        // What lies a rounding behind the last step is no shorter step.
        let t = t.max(run.t_before() + BEHIND * (run.t() - run.t_before()));
        let at = match snapshot.take().filter(|(at, _)| *at == t) {
            Some((_, at)) => at,
            None => run.interpolate(t).map_err(failed)?,
        };
        into.model[column][row] = at.value(quantity);
        snapshot = Some((t, at));
        if !by.is_empty() {
            let slopes = run.derivatives(t, quantity).map_err(failed)?;
            for (own, slope) in by.iter().zip(slopes) {
                into.slopes[column][row * count + own] = slope;
            }
        }
        if wants_rate && is_inside && run.t() > run.t_before() {
            into.rates[column][row] = rate(&mut run, t, quantity).map_err(failed)?;
        }
    }
    Ok(())
}

/// d/dt of a quantity within the last step: that of the polynomial through five values about it.
fn rate(run: &mut Simulation, t: f64, quantity: Quantity) -> Result<f64, springpot::system::RunError> {
    let (from, to) = (run.t_before(), run.t());
    let apart = APART * (to - from);
    let middle = t.clamp(from + 3.0 * apart, to - 2.0 * apart);
    let mut values = [0.0; POINTS];
    for (k, value) in values.iter_mut().enumerate() {
        let at = (middle + (k as f64 - 2.0) * apart).min(to);
        *value = run.interpolate(at)?.value(quantity);
    }
    // Lagrange's polynomials on −2 … 2, differentiated at θ.
    let theta = (t - middle) / apart;
    let slope = |k: usize| {
        let node = |j: usize| j as f64 - 2.0;
        let others = || (0..POINTS).filter(move |j| *j != k);
        others().map(|left| others().filter(|j| *j != left).map(|j| theta - node(j)).product::<f64>()).sum::<f64>()
            / others().map(|j| node(k) - node(j)).product::<f64>()
    };
    Ok((0..POINTS).map(|k| slope(k) * values[k]).sum::<f64>() / apart)
}
