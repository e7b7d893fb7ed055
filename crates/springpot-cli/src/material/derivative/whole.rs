//! Derivatives of all rows at once.

use super::sheet::{Layout, Sheet};
use super::{FEWEST, Problem, steps};
use springpot::fractional::scheme::{Samples, SchemeError};
use springpot::fractional::{DerivativeError, Method, derivative, derivative_with_error};
use springpot_run::table::push_fields;
use std::io::Write;

/// The derivatives of all rows, or nothing; `last_line` is that of the last row.
pub(super) fn differentiate(
    layout: &Layout,
    sheet: &Sheet,
    (method, with_error): (Method, bool),
    last_line: u64,
    output: &mut dyn Write,
) -> Result<(), Problem> {
    if sheet.times.len() < FEWEST {
        return Err(Problem::TooFewRows { line: last_line, given: sheet.times.len() });
    }
    let times = steps::from_start(&sheet.times);
    let (mut results, mut names): (Vec<Vec<f64>>, _) = (Vec::new(), layout.results().into_iter());
    for values in &sheet.values {
        let samples = Samples { t: &times, x: values, rate: None };
        for &order in &layout.orders {
            let on_line = |problem| match row(&problem) {
                Some(row) => Problem::Row { line: sheet.line(row), problem },
                None => problem.into(),
            };
            let (values, error) = if with_error {
                let estimated = derivative_with_error(&samples, order, layout.definition, method).map_err(on_line)?;
                (estimated.values, Some(estimated.error))
            } else {
                (derivative(&samples, order, layout.definition, method).map_err(on_line)?, None)
            };
            let name = names.next().unwrap_or_default();
            if let Some(row) = values.iter().enumerate().position(|(row, value)| !layout.may_be(*value, row == 0)) {
                return Err(Problem::NotFinite { line: sheet.line(row), name });
            }
            results.push(values);
            results.extend(error);
        }
    }
    output.write_all(&layout.header(with_error))?;
    let mut text = String::new();
    for row in 0..times.len() {
        output.write_all(sheet.row_text(row))?;
        text.clear();
        push_fields(&mut text, results.iter().map(|result| result[row]));
        text.push('\n');
        output.write_all(text.as_bytes())?;
    }
    Ok(())
}

/// The row that a scheme refuses.
fn row(problem: &DerivativeError) -> Option<usize> {
    match problem {
        DerivativeError::Samples(SchemeError::NotUniform { row, .. }) => Some(*row),
        _ => None,
    }
}
