//! Arrays from Python, of any strides and real numbers, and arrays for Python.

#![expect(unsafe_code, reason = "Python owns the memory")]

use crate::error::{type_error, value_error};
use numpy::npyffi::{_PyArray_GET_ITEM_DATA, NPY_ARRAY_WRITEABLE};
use numpy::{PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyDict;

/// A float64 array: the argument itself where it is one, else its numbers converted.
///
/// # Errors
/// `TypeError` for what holds no real numbers; `name` is the argument's.
#[inline]
pub(crate) fn numbers<'py>(value: &Bound<'py, PyAny>, name: &str) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    match value.cast::<PyArrayDyn<f64>>() {
        Ok(array) => Ok(array.clone()),
        Err(_) => converted(value, name),
    }
}

/// Numbers of another type, of another byte order, or in lists.
#[cold]
fn converted<'py>(value: &Bound<'py, PyAny>, name: &str) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    static ASARRAY: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let py = value.py();
    let asarray = ASARRAY.import(py, "numpy", "asarray")?;
    let found = asarray.call1((value,))?;
    let kind: String = found.getattr("dtype")?.getattr("kind")?.extract()?;
    if !matches!(kind.as_str(), "b" | "i" | "u" | "f") {
        let dtype = found.getattr("dtype")?;
        return Err(type_error(format!("{name} must be an array of real numbers, not of {dtype}")));
    }
    let words = PyDict::new(py);
    words.set_item("dtype", "float64")?;
    Ok(asarray.call((found,), Some(&words))?.cast_into::<PyArrayDyn<f64>>()?)
}

/// Rows of a matrix in Python's memory, or one row, read value by value: no reference into it is made, since Python may write there.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rows {
    data: *const f64,
    /// `None`: an array of one dimension, the same for every row.
    pub(crate) count: Option<usize>,
    /// Bytes from row to row, and from number to number.
    strides: [isize; 2],
    width: usize,
}

// SAFETY: reading alone is done through the pointer, and whoever sends rows to other threads keeps the array alive meanwhile.
unsafe impl Send for Rows {}
// SAFETY: as above.
unsafe impl Sync for Rows {}

impl Rows {
    /// Rows of `width` numbers, or one such row.
    ///
    /// # Errors
    /// `ValueError` for another shape.
    #[inline]
    pub(crate) fn new(array: &Bound<'_, PyArrayDyn<f64>>, name: &str, width: usize) -> PyResult<Self> {
        let (count, strides) = match (array.shape(), array.strides()) {
            (&[n], &[stride]) if n == width => (None, [0, stride]),
            (&[count, n], &[row, stride]) if n == width => (Some(count), [row, stride]),
            (shape, _) => return Err(wrong_shape(name, shape, width)),
        };
        Ok(Self { data: array.data(), count, strides, width })
    }

    /// Copies row `row` (of one row: that one).
    pub(crate) fn read(&self, row: usize, into: &mut [f64]) {
        let _ = self.read_finite(row, into);
    }

    /// Copies a row as [`Rows::read`], and says whether its numbers are finite.
    #[inline]
    #[must_use]
    pub(crate) fn read_finite(&self, row: usize, into: &mut [f64]) -> bool {
        assert!(self.count.is_none_or(|count| row < count) && into.len() == self.width);
        let [to_row, to_next] = self.strides;
        let mut is_finite = true;
        // SAFETY: the row and its numbers lie within the shape of the array, which NumPy keeps within its memory.
        unsafe {
            let start = self.data.byte_offset(to_row * row as isize);
            for (k, number) in into.iter_mut().enumerate() {
                *number = start.byte_offset(to_next * k as isize).read_unaligned();
                is_finite &= number.is_finite();
            }
        }
        is_finite
    }

    /// Whether `out` lies in the same memory, in rows that are not the very same.
    pub(crate) fn is_torn_by(&self, out: &Sink) -> bool {
        let Some(count) = self.count.filter(|count| *count > 1 && self.width > 0) else { return false };
        let own = self.strides.iter().zip([count, self.width]);
        let (mut low, mut high) = (self.data as isize, self.data as isize + 8);
        for (stride, n) in own {
            let reach = stride * (n as isize - 1);
            (low, high) = (low + reach.min(0), high + reach.max(0));
        }
        let (from, to) = (out.data as isize, out.data as isize + 8 * (out.count * out.width) as isize);
        let same = out.data.cast_const() == self.data && self.strides == [8 * out.width as isize, 8];
        !same && low < to && from < high
    }
}

#[cold]
fn wrong_shape(name: &str, shape: &[usize], width: usize) -> PyErr {
    value_error(format!("{name} has shape {}; it must have shape ({width},) or (N, {width})", written(shape)))
}

/// A shape as Python writes it.
pub(crate) fn written(shape: &[usize]) -> String {
    match shape {
        [one] => format!("({one},)"),
        _ => format!("({})", shape.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")),
    }
}

/// Numbers for which there is room without asking.
const MOST: f64 = 1e7;

/// Where results go: `count` rows of `width` numbers, one after the other.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sink {
    data: *mut f64,
    count: usize,
    width: usize,
}

// SAFETY: rows are handed out one by one, each to one thread; whoever sends a sink keeps the array alive meanwhile.
unsafe impl Send for Sink {}
// SAFETY: as above.
unsafe impl Sync for Sink {}

impl Sink {
    /// The numbers of an array of `shape`: the caller's own `out`, or a new one.
    ///
    /// # Errors
    /// `ValueError` where `out` has another shape or layout or may not be written; `TypeError` where it is no float64 array.
    #[inline]
    pub(crate) fn new<'py>(
        py: Python<'py>,
        shape: &[usize],
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<(Self, Bound<'py, PyArrayDyn<f64>>)> {
        let array = match out {
            None if shape.iter().map(|n| *n as f64).product::<f64>() < MOST => PyArrayDyn::zeros(py, shape, false),
            // NumPy says itself where there is no room.
            None => py.import("numpy")?.call_method1("zeros", (shape.to_vec(),))?.cast_into::<PyArrayDyn<f64>>()?,
            Some(out) => taken(out, shape)?,
        };
        let count = shape.first().copied().unwrap_or(1);
        Ok((Self { data: array.data(), count, width: shape.iter().skip(1).product() }, array))
    }

    /// All of it as one row.
    pub(crate) fn flat(self) -> Self {
        Self { count: 1, width: self.count * self.width, ..self }
    }

    /// Row `row`.
    ///
    /// # Safety
    /// No other reference to this row is alive.
    #[inline]
    pub(crate) unsafe fn row<'a>(&self, row: usize) -> &'a mut [f64] {
        // SAFETY: as the caller says.
        unsafe { self.rows(row, row + 1) }
    }

    /// Rows `from` to `to`, one after the other.
    ///
    /// # Safety
    /// No other reference to these rows is alive.
    #[inline]
    pub(crate) unsafe fn rows<'a>(&self, from: usize, to: usize) -> &'a mut [f64] {
        assert!(from <= to && to <= self.count);
        // SAFETY: the rows lie one after the other in an array that was made or checked so; the caller has these alone.
        unsafe { std::slice::from_raw_parts_mut(self.data.add(from * self.width), (to - from) * self.width) }
    }
}

fn taken<'py>(out: &Bound<'py, PyAny>, shape: &[usize]) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let array = out.cast::<PyArrayDyn<f64>>().map_err(|_| type_error("out must be a float64 array"))?;
    if array.shape() != shape {
        let (found, wanted) = (written(array.shape()), written(shape));
        return Err(value_error(format!("out has shape {found}; the result has shape {wanted}")));
    }
    // SAFETY: the array is alive, and its flags are a plain number beside its shape.
    let is_writeable = unsafe { (*_PyArray_GET_ITEM_DATA(array.as_array_ptr())).flags } & NPY_ARRAY_WRITEABLE != 0;
    if !(array.is_c_contiguous() && array.data().is_aligned() && is_writeable) {
        return Err(value_error("out must be C-contiguous and writeable"));
    }
    Ok(array.clone())
}

/// The numbers of an array in C order.
pub(crate) fn flat(array: &Bound<'_, PyArrayDyn<f64>>) -> PyResult<Vec<f64>> {
    match array.is_c_contiguous() {
        true => Ok(array.to_vec()?),
        false => {
            let copied = array.call_method1("ravel", ("C",))?;
            Ok(copied.cast::<numpy::PyArray1<f64>>().map_err(PyErr::from)?.to_vec()?)
        }
    }
}

/// The numbers of `name`, an array of shape (N,).
pub(crate) fn column(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<f64>> {
    let array = numbers(value, name)?;
    match array.shape() {
        [_] => flat(&array),
        shape => Err(value_error(format!("{name} has shape {}; it must have shape (N,)", written(shape)))),
    }
}
