//! Elements with a named offline scheme: their derivative is taken on the grid of the rows.

use super::moment::{Moment, Scratch};
use super::{RowTimes, RunError, System};
use crate::fractional::scheme::Samples;

/// D^alpha x per row, for each memory of each element with a named scheme; `None` for the others.
pub(super) type GridDerivatives = Vec<Option<Vec<Vec<f64>>>>;

/// Evaluates the strokes at all rows and differentiates them.
///
/// # Errors
/// [`RunError::Scheme`] where a scheme does not fit the grid, and what stops the motion before its end.
pub(super) fn derivatives(
    system: &System,
    rows: &RowTimes,
    scratch: &mut Scratch,
) -> Result<GridDerivatives, RunError> {
    if system.elements.iter().all(|element| element.scheme.is_none()) {
        return Ok(vec![None; system.elements.len()]);
    }
    let times = rows.all();
    let mut moment = Moment::new(system);
    let (mut strokes, mut rates) = (vec![Vec::new(); system.elements.len()], vec![Vec::new(); system.elements.len()]);
    for &t in &times {
        system.evaluate(t, t, scratch, &mut moment)?;
        for (e, state) in moment.elements.iter().enumerate() {
            // A start within rounding of 0 is no jump.
            let stroke = if t == 0.0 { system.elements[e].jump(state.length) } else { state.stroke };
            strokes[e].push(stroke);
            rates[e].push(state.rate);
        }
    }
    let derivative = |e: usize| {
        let element = &system.elements[e];
        let scheme = element.scheme.as_ref()?;
        let samples = Samples { t: &times, x: &strokes[e], rate: Some(&rates[e]) };
        let name = || element.name.clone();
        let inputs = &moment.elements[e].inputs;
        let begun = element.begin(element.rest_length, inputs);
        let derivatives = begun.map_err(|source| RunError::Kernel { element: name(), source }).and_then(|state| {
            let orders = state.memories().iter().map(crate::fractional::Memory::alpha);
            let values = orders.map(|alpha| scheme.differentiate(&samples, alpha, element.derivative));
            values.collect::<Result<_, _>>().map_err(|source| RunError::Scheme { element: name(), source })
        });
        Some(derivatives)
    };
    (0..system.elements.len()).map(|e| derivative(e).transpose()).collect()
}
