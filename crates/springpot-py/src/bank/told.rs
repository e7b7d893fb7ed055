//! Inputs as Python says them: an array of all of them, or a dict by name.

use crate::array::{Rows, numbers, written};
use crate::error::value_error;
use crate::quantity::number;
use numpy::PyUntypedArrayMethods;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use springpot_scenario::suggest;

/// All inputs at one time; what is not said stays as it was `last`.
pub(super) fn held(
    said: Option<&Bound<'_, PyAny>>,
    names: &[(String, String)],
    last: Option<&[f64]>,
) -> PyResult<Vec<f64>> {
    at_nodes(said, names, 1, last)
}

/// All inputs at the nodes of a step, node by node.
pub(super) fn at_nodes(
    said: Option<&Bound<'_, PyAny>>,
    names: &[(String, String)],
    nodes: usize,
    last: Option<&[f64]>,
) -> PyResult<Vec<f64>> {
    let all = names.len();
    let mut values = vec![f64::NAN; all * nodes];
    if let Some(last) = last {
        values.chunks_mut(all.max(1)).for_each(|row| row.copy_from_slice(last));
    }
    match said {
        None => {}
        Some(said) => match said.cast::<PyDict>() {
            Ok(words) => {
                for (name, value) in words {
                    let name: String = name.extract()?;
                    let Some(k) = names.iter().position(|(own, _)| *own == name) else {
                        let known = names.iter().map(|(own, _)| own.as_str()).collect::<Vec<_>>();
                        return Err(value_error(format!("there is no input \"{name}\"; {}", suggest(&name, known))));
                    };
                    let row = one(&value, &names[k].1, &name, nodes)?;
                    row.iter().enumerate().for_each(|(node, value)| values[node * all + k] = *value);
                }
            }
            Err(_) => matrix(said, all, nodes, &mut values)?,
        },
    }
    match (0..all).find(|k| values[*k].is_nan()) {
        Some(k) if last.is_none() => {
            Err(value_error(format!("the input \"{}\" is missing: inputs={{\"{}\": …}}", names[k].0, names[k].0)))
        }
        _ => Ok(values),
    }
}

/// One input at the nodes: a number or a text with a unit for all of them, or an array.
fn one(value: &Bound<'_, PyAny>, unit: &str, name: &str, nodes: usize) -> PyResult<Vec<f64>> {
    if value.is_instance_of::<PyString>() {
        return Ok(vec![number(value, unit, name)?; nodes]);
    }
    let array = numbers(value, name)?;
    match array.shape() {
        [] => Ok(vec![number(value, unit, name)?; nodes]),
        [n] if *n == nodes => {
            let mut row = vec![0.0; nodes];
            Rows::new(&array, name, nodes)?.read(0, &mut row);
            Ok(row)
        }
        shape => Err(value_error(format!(
            "{name} has shape {}; it must be a number or have shape ({nodes},)",
            written(shape)
        ))),
    }
}

/// All inputs: (m,) for all nodes, or (m, nodes).
fn matrix(said: &Bound<'_, PyAny>, all: usize, nodes: usize, values: &mut [f64]) -> PyResult<()> {
    let array = numbers(said, "inputs")?;
    match *array.shape() {
        [n] if n == all => {
            let rows = Rows::new(&array, "inputs", all)?;
            values.chunks_mut(all.max(1)).for_each(|row| rows.read(0, row));
            Ok(())
        }
        [n, found] if n == all && found == nodes => {
            let (rows, mut row) = (Rows::new(&array, "inputs", nodes)?, vec![0.0; nodes]);
            for k in 0..all {
                rows.read(k, &mut row);
                row.iter().enumerate().for_each(|(node, value)| values[node * all + k] = *value);
            }
            Ok(())
        }
        _ => {
            let shape = written(array.shape());
            Err(value_error(format!("inputs has shape {shape}; it must have shape ({all},) or ({all}, {nodes})")))
        }
    }
}
