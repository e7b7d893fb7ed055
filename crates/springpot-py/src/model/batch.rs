//! One algorithm for one state or for many, these on all cores without the GIL.

#![expect(unsafe_code, reason = "rows of one array are written by several threads")]

use super::core::{Core, Scratch};
use crate::array::{Rows, Sink, numbers};
use crate::error::{guarded, type_error, value_error};
use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyTuple};
use springpot::dynamics::batch::{BatchError, BatchWorkspace};
use springpot::model::{Model, StateError};
use springpot::spatial::{SimdError, SimdLevel};
use std::array::from_fn;
use std::fmt;
use std::ops::Range;
use std::sync::OnceLock;

/// States that are worth a thread.
const WORTH_A_THREAD: usize = 256;
/// States whose arguments are read, and checked, before they are worked out side by side.
const CHUNK: usize = 64;
/// More states than this are worked out without the GIL.
const WORTH_RELEASING: usize = 16;

/// What an argument is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Symbol {
    /// Coordinates, nq.
    Q(&'static str),
    /// Velocities, accelerations or forces, nv.
    V(&'static str),
}

impl Symbol {
    fn name(self) -> &'static str {
        match self {
            Self::Q(name) | Self::V(name) => name,
        }
    }

    fn width(self, model: &Model) -> usize {
        match self {
            Self::Q(_) => model.nq(),
            Self::V(_) => model.nv(),
        }
    }

    /// Without quaternions there is nothing to look at but whether the numbers are finite.
    #[inline]
    fn check(self, core: &Core, values: &[f64], is_finite: bool) -> Result<(), StateError> {
        match self {
            Self::Q(_) if is_finite && core.is_free_of_quaternions => Ok(()),
            Self::V(_) if is_finite => Ok(()),
            Self::Q(_) => core.model.check_q(values),
            Self::V(name) => core.model.check_v(name, values),
        }
    }
}

/// Why a state has no result.
#[derive(Debug, Clone)]
enum NoResult {
    State(StateError),
    /// A number that the result holds where the state is finite.
    NotFinite(f64),
    Level(SimdError),
    Batch(BatchError),
}

impl fmt::Display for NoResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::State(error) => error.fmt(f),
            Self::Level(error) => error.fmt(f),
            Self::Batch(error) => error.fmt(f),
            Self::NotFinite(value) => {
                let why = "numbers of the state are too large, its mass matrix has no inverse, or two points coincide";
                write!(f, "the result holds {value}: {why}")
            }
        }
    }
}

/// An algorithm on rows of states side by side.
type Together<'a, const I: usize, const O: usize> =
    &'a (dyn Fn(&Model, &mut BatchWorkspace, [&[f64]; I], [&mut [f64]; O]) -> Result<(), BatchError> + Sync);

/// As [`one_result`], state by state.
pub(crate) fn one_by_one<'py, const I: usize>(
    core: &Core,
    inputs: [(&Bound<'py, PyAny>, Symbol); I],
    shape: &[usize],
    out: Option<&Bound<'py, PyAny>>,
    work: impl Fn(&Model, &mut Scratch, [&[f64]; I], &mut [f64]) + Sync,
) -> PyResult<Bound<'py, PyAny>> {
    let work = |model: &Model, scratch: &mut Scratch, inputs: [&[f64]; I], [out]: [&mut [f64]; 1]| {
        work(model, scratch, inputs, out);
    };
    let [only] = apply(core, inputs, [shape], out, None, work)?;
    Ok(only)
}

/// As [`each`], of one result.
pub(crate) fn one_result<'py, const I: usize>(
    core: &Core,
    inputs: [(&Bound<'py, PyAny>, Symbol); I],
    shape: &[usize],
    out: Option<&Bound<'py, PyAny>>,
    together: impl Fn(&Model, &mut BatchWorkspace, [&[f64]; I], [&mut [f64]; 1]) -> Result<(), BatchError> + Sync,
    work: impl Fn(&Model, &mut Scratch, [&[f64]; I], &mut [f64]) + Sync,
) -> PyResult<Bound<'py, PyAny>> {
    let work = |model: &Model, scratch: &mut Scratch, inputs: [&[f64]; I], [out]: [&mut [f64]; 1]| {
        work(model, scratch, inputs, out);
    };
    let [only] = apply(core, inputs, [shape], out, Some(&together), work)?;
    Ok(only)
}

/// Applies an algorithm to every state that the arguments hold: `work` to one where all have one dimension, `together` to all rows.
///
/// `shapes` are those of the results of one state; results of many have the number of states before them.
pub(crate) fn each<'py, const I: usize, const O: usize>(
    core: &Core,
    inputs: [(&Bound<'py, PyAny>, Symbol); I],
    shapes: [&[usize]; O],
    out: Option<&Bound<'py, PyAny>>,
    together: impl Fn(&Model, &mut BatchWorkspace, [&[f64]; I], [&mut [f64]; O]) -> Result<(), BatchError> + Sync,
    work: impl Fn(&Model, &mut Scratch, [&[f64]; I], [&mut [f64]; O]) + Sync,
) -> PyResult<[Bound<'py, PyAny>; O]> {
    apply(core, inputs, shapes, out, Some(&together), work)
}

/// [`each`]; without `together` rows are worked out by `work`, one by one.
fn apply<'py, const I: usize, const O: usize>(
    core: &Core,
    inputs: [(&Bound<'py, PyAny>, Symbol); I],
    shapes: [&[usize]; O],
    out: Option<&Bound<'py, PyAny>>,
    together: Option<Together<'_, I, O>>,
    work: impl Fn(&Model, &mut Scratch, [&[f64]; I], [&mut [f64]; O]) + Sync,
) -> PyResult<[Bound<'py, PyAny>; O]> {
    let py = inputs[0].0.py();
    guarded(py, || {
        let model = &*core.model;
        let symbols = inputs.map(|(_, symbol)| symbol);
        let arrays = all(inputs.map(|(value, symbol)| numbers(value, symbol.name())))?;
        let rows = all(from_fn::<_, I, _>(|k| Rows::new(&arrays[k], symbols[k].name(), symbols[k].width(model))))?;
        let count = common_count(&rows, &symbols)?;
        let outs = own_outs(out, O)?;
        let sinks = all(from_fn::<_, O, _>(|k| {
            let (mut shape, own) = ([0; 4], outs.as_ref().map(|outs| &outs[k]));
            let used = shapes[k].len() + usize::from(count.is_some());
            shape[used - shapes[k].len()..used].copy_from_slice(shapes[k]);
            shape[0] = count.unwrap_or(shape[0]);
            Sink::new(py, &shape[..used], own)
        }))?;
        let targets = from_fn::<_, O, _>(|k| if count.is_none() { sinks[k].0.flat() } else { sinks[k].0 });
        match count {
            None => one(core, &symbols, &rows, &targets, 0, &work).map_err(value_error)?,
            Some(count) => {
                if targets.iter().any(|target| rows.iter().any(|rows| rows.is_torn_by(target))) {
                    return Err(value_error("out shares memory with an argument, row by row in another order"));
                }
                let level = SimdLevel::chosen().map_err(value_error)?;
                let part = |from: usize, to: usize| match together {
                    Some(together) => side_by_side(core, level, &symbols, &rows, &targets, from..to, together),
                    None => in_turn(core, &symbols, &rows, &targets, from..to, &work),
                };
                let run = || many(count, &part);
                let done = if count < WORTH_RELEASING { run() } else { py.detach(run) };
                done.map_err(|(row, error)| value_error(format!("row {row}: {error}")))?;
            }
        }
        Ok(from_fn(|k| {
            let array = sinks[k].1.as_any();
            match (count, shapes[k]) {
                // SAFETY: the work is done, and nobody else has the new number.
                (None, []) => PyFloat::new(py, unsafe { targets[k].row(0) }[0]).into_any(),
                _ => array.clone(),
            }
        }))
    })
}

#[inline]
fn one<const I: usize, const O: usize>(
    core: &Core,
    symbols: &[Symbol; I],
    rows: &[Rows; I],
    targets: &[Sink; O],
    row: usize,
    work: &impl Fn(&Model, &mut Scratch, [&[f64]; I], [&mut [f64]; O]),
) -> Result<(), NoResult> {
    let mut scratch = core.scratch();
    let done = state(core, &mut scratch, symbols, rows, targets, row, work);
    core.give_back(scratch);
    done
}

#[inline]
fn state<const I: usize, const O: usize>(
    core: &Core,
    scratch: &mut Scratch,
    symbols: &[Symbol; I],
    rows: &[Rows; I],
    targets: &[Sink; O],
    row: usize,
    work: &impl Fn(&Model, &mut Scratch, [&[f64]; I], [&mut [f64]; O]),
) -> Result<(), NoResult> {
    let model = &*core.model;
    // Taken out for the time of the call: the work has the rest.
    let mut inputs = std::mem::take(&mut scratch.inputs);
    let mut done = Ok(());
    for k in 0..I {
        let width = symbols[k].width(model);
        inputs[k].resize(width, 0.0);
        let is_finite = rows[k].read_finite(row, &mut inputs[k]);
        done = done.and_then(|()| symbols[k].check(core, &inputs[k], is_finite).map_err(NoResult::State));
    }
    if done.is_ok() {
        // SAFETY: each row is taken once, by one thread.
        let mut outs = from_fn::<_, O, _>(|k| unsafe { targets[k].row(row) });
        work(model, scratch, from_fn(|k| inputs[k].as_slice()), outs.each_mut().map(|out| &mut **out));
        done = outs.iter().try_for_each(|out| finite(out));
    }
    scratch.inputs = inputs;
    done
}

/// Whether all numbers are finite, looked at without a branch for each.
#[inline]
fn finite(values: &[f64]) -> Result<(), NoResult> {
    if values.iter().fold(true, |all, value| all & value.is_finite()) {
        return Ok(());
    }
    values.iter().find(|value| !value.is_finite()).map_or(Ok(()), |bad| Err(NoResult::NotFinite(*bad)))
}

/// Some rows one by one; the first that has no result ends it.
fn in_turn<const I: usize, const O: usize>(
    core: &Core,
    symbols: &[Symbol; I],
    rows: &[Rows; I],
    targets: &[Sink; O],
    mut wanted: Range<usize>,
    work: &impl Fn(&Model, &mut Scratch, [&[f64]; I], [&mut [f64]; O]),
) -> Result<(), (usize, NoResult)> {
    let mut scratch = core.scratch();
    let done = wanted
        .try_for_each(|row| state(core, &mut scratch, symbols, rows, targets, row, work).map_err(|error| (row, error)));
    core.give_back(scratch);
    done
}

/// Some rows side by side; the first that has no result ends it.
fn side_by_side<const I: usize, const O: usize>(
    core: &Core,
    level: SimdLevel,
    symbols: &[Symbol; I],
    rows: &[Rows; I],
    targets: &[Sink; O],
    wanted: Range<usize>,
    together: Together<'_, I, O>,
) -> Result<(), (usize, NoResult)> {
    let model = &*core.model;
    let mut scratch = core.scratch();
    let Scratch { inputs, together: room, .. } = &mut *scratch;
    let widths = symbols.map(|symbol| symbol.width(model));
    if room.is_none() {
        *room = Some(BatchWorkspace::at(model, level).map_err(|error| (wanted.start, NoResult::Level(error)))?);
    }
    let room = room.as_mut().expect("it was made");
    let mut done = Ok(());
    let mut from = wanted.start;
    while from < wanted.end && done.is_ok() {
        let to = wanted.end.min(from + CHUNK);
        for k in 0..I {
            inputs[k].resize((to - from) * widths[k], 0.0);
        }
        done = (from..to).try_for_each(|row| {
            (0..I).try_for_each(|k| {
                let values = &mut inputs[k][(row - from) * widths[k]..][..widths[k]];
                let is_finite = rows[k].read_finite(row, values);
                symbols[k].check(core, values, is_finite).map_err(|error| (row, NoResult::State(error)))
            })
        });
        if done.is_ok() {
            // SAFETY: each row is taken once, by one thread.
            let outs = from_fn::<_, O, _>(|k| unsafe { targets[k].rows(from, to) });
            done = together(model, room, from_fn(|k| inputs[k].as_slice()), outs).map_err(|error| match error {
                BatchError::NotFinite { row, value } => (from + row, NoResult::NotFinite(value)),
                other => (from, NoResult::Batch(other)),
            });
        }
        from = to;
    }
    core.give_back(scratch);
    done
}

/// The first row that has no result, where there is one; `part` works out some rows.
fn many(
    count: usize,
    part: &(impl Fn(usize, usize) -> Result<(), (usize, NoResult)> + Sync),
) -> Result<(), (usize, NoResult)> {
    let threads = cores().min(count / WORTH_A_THREAD).max(1);
    if threads == 1 {
        return part(0, count);
    }
    let bound = |k: usize| count * k / threads;
    std::thread::scope(|scope| {
        let others: Vec<_> = (1..threads).map(|k| scope.spawn(move || part(bound(k), bound(k + 1)))).collect();
        let first = part(0, bound(1));
        let results = others.into_iter().map(|thread| thread.join());
        results.fold(first, |done, next| {
            let next = next.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            done.and(next)
        })
    })
}

fn cores() -> usize {
    static CORES: OnceLock<usize> = OnceLock::new();
    *CORES.get_or_init(|| std::thread::available_parallelism().map_or(1, usize::from))
}

/// How many states there are; `None`: one, without a dimension of its own.
#[inline]
fn common_count<const I: usize>(rows: &[Rows; I], symbols: &[Symbol; I]) -> PyResult<Option<usize>> {
    let mut counts = rows.iter().zip(symbols).filter_map(|(rows, symbol)| Some((rows.count?, symbol)));
    let Some((count, first)) = counts.next() else { return Ok(None) };
    match counts.find(|(other, _)| *other != count) {
        None => Ok(Some(count)),
        Some((other, symbol)) => {
            let (first, symbol) = (first.name(), symbol.name());
            Err(value_error(format!("{first} has {count} rows, and {symbol} has {other}; they must have as many")))
        }
    }
}

/// The arrays that the caller wants written: one, or a tuple of as many as there are results.
#[inline]
fn own_outs<'py>(out: Option<&Bound<'py, PyAny>>, wanted: usize) -> PyResult<Option<Vec<Bound<'py, PyAny>>>> {
    let Some(out) = out.filter(|out| !out.is_none()) else { return Ok(None) };
    if wanted == 1 {
        return Ok(Some(vec![out.clone()]));
    }
    let tuple = out.cast::<PyTuple>().map_err(|_| type_error(format!("out must be a tuple of {wanted} arrays")))?;
    match tuple.len() {
        count if count == wanted => Ok(Some(tuple.iter().collect())),
        count => Err(value_error(format!("out has {count} arrays; there are {wanted} results"))),
    }
}

#[inline]
fn all<T, const N: usize>(results: [PyResult<T>; N]) -> PyResult<[T; N]> {
    let mut failed = None;
    let values = results.map(|result| result.map_err(|error| failed = failed.take().or(Some(error))).ok());
    match failed {
        Some(error) => Err(error),
        None => Ok(values.map(|value| value.expect("none has failed"))),
    }
}
