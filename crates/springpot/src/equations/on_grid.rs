//! Elements with a named offline scheme: their derivative is taken on the grid of the rows.

use super::context::Context;
use super::evaluate::{Evaluation, Scratch};
use crate::elements::Element;
use crate::fractional::scheme::Samples;
use crate::law::{InputValue, Observation, Point, State};
use crate::motion::Trajectory;
use crate::system::error::RunError;
use crate::system::row_times::RowTimes;

/// D^alpha x per row, for each memory of each element with a named scheme; `None` for the others.
pub(crate) type GridDerivatives = Vec<Option<Vec<Vec<f64>>>>;

/// Evaluates the strokes at all rows and differentiates them.
///
/// # Errors
/// [`RunError::Scheme`] where a scheme does not fit the grid, and what stops the motion before its end.
pub(crate) fn derivatives(
    cx: Context,
    trajectory: &Trajectory,
    rows: &RowTimes,
    scratch: &mut Scratch,
) -> Result<GridDerivatives, RunError> {
    let system = cx.system;
    if system.elements.iter().all(|element| element.scheme.is_none()) {
        return Ok(vec![None; system.elements.len()]);
    }
    let times = rows.all();
    let mut evaluation = Evaluation::new(system);
    let (mut strokes, mut rates) = (vec![Vec::new(); system.elements.len()], vec![Vec::new(); system.elements.len()]);
    for &t in &times {
        cx.evaluate(trajectory, t, t, scratch, &mut evaluation)?;
        for (e, state) in evaluation.elements.iter().enumerate() {
            // A start within rounding of 0 is no jump.
            let stroke = if t == 0.0 { system.elements[e].jump(state.reading.coordinate) } else { state.stroke };
            strokes[e].push(stroke);
            rates[e].push(state.reading.rate);
        }
    }
    let derivative = |e: usize| {
        let element = &system.elements[e];
        let scheme = element.scheme.as_ref()?;
        let samples = Samples { t: &times, x: &strokes[e], rate: Some(&rates[e]) };
        let derivatives = begin(element, &evaluation.elements[e].inputs).and_then(|state| {
            let orders = state.memories().iter().map(crate::fractional::Memory::alpha);
            let values = orders.map(|alpha| scheme.differentiate(&samples, alpha, element.derivative));
            let values = values.collect::<Result<_, _>>();
            values.map_err(|source| RunError::Scheme { element: element.name.clone(), source })
        });
        Some(derivatives)
    };
    (0..system.elements.len()).map(|e| derivative(e).transpose()).collect()
}

/// An element whose `derivatives` come from a named scheme, one list for each memory, at row `row`: its energies are unknown.
pub(crate) fn on_grid_observation(
    element: &Element,
    at: &Point,
    derivatives: &[Vec<f64>],
    row: usize,
) -> Result<Observation, RunError> {
    let mut state = begin(element, at.inputs)?;
    for (memory, values) in state.memories_mut().iter_mut().zip(derivatives) {
        memory.tell(values.get(row).copied().unwrap_or(f64::NAN));
    }
    Ok(Observation { stored: None, ..element.law.now(at, &state) })
}

/// The state of a law that knows no past.
fn begin(element: &Element, inputs: &[InputValue]) -> Result<State, RunError> {
    let begun = element.begin(element.rest, inputs);
    begun.map_err(RunError::of_kernel(&element.name))
}
