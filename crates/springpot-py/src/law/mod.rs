//! Laws by name and networks by text.

mod datasheet;
mod master;
mod prony;
mod read;

pub(crate) use self::read::{Description, described};

use crate::array::{flat, numbers};
use crate::error::{guarded, value_error};
use crate::notebook;
use crate::scenario::CATALOG;
use numpy::{Complex64, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use springpot::fractional::prony::Relaxation as _;
use springpot::law::{Derivative, Entry, InputValue, Network, Param, Point, Tangent};
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::sync::Arc;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<PyLaw>()?;
    module.add_function(wrap_pyfunction!(laws, module)?)?;
    datasheet::register(module)?;
    master::register(module)?;
    prony::register(module)
}

/// A law with its parameters: the force of a stroke's history. :func:`springpot.law` and :func:`springpot.network` make them.
///
/// Two are equal where they are the same law, or the same network, with the same parameters and the same definition of the derivative.
#[pyclass(frozen, name = "Law", module = "springpot._springpot")]
#[derive(Debug)]
pub(crate) struct PyLaw {
    pub(crate) entry: Arc<Entry>,
    pub(crate) network: Network,
    pub(crate) derivative: Derivative,
    /// SI, in the order of the entry; of a list all of them.
    values: Vec<Vec<f64>>,
    /// What it was made of: `law` or `network`, that text, parameters and tables.
    made_of: Description,
}

/// The name of a derivative's definition.
pub(crate) fn definition_name(derivative: Derivative) -> &'static str {
    match derivative {
        Derivative::Caputo => "caputo",
        Derivative::RiemannLiouville => "riemann-liouville",
    }
}

/// A row of the catalog as a dict.
fn row<'py>(py: Python<'py>, entry: &Entry) -> PyResult<Bound<'py, PyDict>> {
    let row = PyDict::new(py);
    row.set_item("name", &*entry.name)?;
    row.set_item("equation", &*entry.equation)?;
    row.set_item("source", &*entry.source)?;
    let parameter = |param: &Param| -> PyResult<Bound<'py, PyDict>> {
        let words = PyDict::new(py);
        words.set_item("name", &*param.name)?;
        words.set_item("unit", &*param.unit)?;
        words.set_item("meaning", &*param.meaning)?;
        words.set_item("low", param.range.low)?;
        words.set_item("high", param.range.high)?;
        words.set_item("default", param.default)?;
        words.set_item("is_list", param.is_list)?;
        Ok(words)
    };
    let parameters = entry.params.iter().map(parameter).collect::<PyResult<Vec<_>>>()?;
    row.set_item("parameters", parameters)?;
    let inputs = PyList::empty(py);
    for input in &entry.inputs {
        let words = PyDict::new(py);
        words.set_item("name", &*input.name)?;
        words.set_item("unit", &*input.unit)?;
        words.set_item("meaning", &*input.meaning)?;
        words.set_item("low", input.range.low)?;
        words.set_item("high", input.range.high)?;
        inputs.append(words)?;
    }
    row.set_item("inputs", inputs)?;
    Ok(row)
}

/// All laws that have a name.
#[pyfunction]
fn laws(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    CATALOG.entries().iter().map(|entry| row(py, entry)).collect()
}

impl PyLaw {
    /// Inputs by name, 0 where nothing is said.
    fn inputs(&self, given: Option<&Bound<'_, PyDict>>) -> PyResult<Vec<InputValue>> {
        let mut inputs = vec![InputValue::default(); self.entry.inputs.len()];
        for (name, value) in given.into_iter().flat_map(|given| given.iter()) {
            let name: String = name.extract()?;
            let Some(at) = self.entry.inputs.iter().position(|input| input.name == name) else {
                return Err(value_error(format!("the law has no input \"{name}\"")));
            };
            inputs[at].value = crate::quantity::number(&value, &self.entry.inputs[at].unit, &name)?;
        }
        Ok(inputs)
    }

    /// How it answers to small motions, where it is linear and has no inputs.
    fn tangent(&self) -> PyResult<Tangent> {
        if !self.network.is_linear() || !self.entry.inputs.is_empty() {
            return Err(value_error(format!("the law {} is not linear, or has inputs", self.entry.name)));
        }
        let at = Point { t: 0.0, stroke: 0.0, rate: 0.0, inputs: &[] };
        let rest = self.network.at_rest(&at, 0.0).map(|rest| rest.tangent.reduced());
        rest.ok_or_else(|| value_error("the parts of the law come to no common force"))
    }
}

#[pymethods]
impl PyLaw {
    #[new]
    #[pyo3(signature = (description))]
    fn new(py: Python<'_>, description: &Bound<'_, PyAny>) -> PyResult<Self> {
        guarded(py, || described(description)?.build())
    }

    /// Name in the catalog, or the text of a network.
    #[getter]
    fn name(&self) -> &str {
        &self.entry.name
    }

    /// The law in one line.
    #[getter]
    fn equation(&self) -> &str {
        &self.entry.equation
    }

    /// Where it comes from.
    #[getter]
    fn source(&self) -> &str {
        &self.entry.source
    }

    /// The definition that its springpots take.
    #[getter]
    fn derivative(&self) -> &'static str {
        definition_name(self.derivative)
    }

    /// Parameters, SI; those that are tables as tuples of strokes and forces, those that are expressions as texts.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let words = PyDict::new(py);
        for (param, values) in self.entry.params.iter().zip(&self.values) {
            match (&values[..], param.is_list) {
                ([only], false) => words.set_item(&*param.name, only)?,
                (all, _) => words.set_item(&*param.name, all)?,
            }
        }
        for (name, x, force) in self.made_of.tables() {
            words.set_item(name, (x, force))?;
        }
        self.made_of.texts().try_for_each(|(name, text)| words.set_item(name, text))?;
        Ok(words)
    }

    /// Units of the parameters.
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let words = PyDict::new(py);
        self.entry.params.iter().try_for_each(|param| words.set_item(&*param.name, &*param.unit))?;
        self.made_of.tables().try_for_each(|(name, ..)| words.set_item(name, "m, N"))?;
        Ok(words)
    }

    /// Names of the inputs.
    #[getter]
    #[pyo3(name = "inputs")]
    fn names_of_inputs(&self) -> Vec<String> {
        self.entry.inputs.iter().map(|input| input.name.to_string()).collect()
    }

    /// Names of the leaves of its network.
    #[getter]
    fn leaves(&self) -> Vec<String> {
        self.network.leaf_names().into_iter().map(|name| name.to_string()).collect()
    }

    /// Whether F is an affine function of strokes and rates.
    #[getter]
    fn is_linear(&self) -> bool {
        self.network.is_linear()
    }

    /// A dict that describes the same law, for :class:`Bank` and :class:`Law`.
    #[getter]
    fn description<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.made_of.to_dict(py)
    }

    /// K*(ω) = K' + iK'' under a steady sine: complex, in the shape of ``omega`` (rad/s), N/m. Inputs count 0 where left out.
    ///
    /// >>> import springpot as sp
    /// >>> sp.law("kelvin-voigt", k=3.0, c=2.0).modulus([0.0, 10.0])
    /// array([3. +0.j, 3.+20.j])
    #[pyo3(signature = (omega, inputs=None))]
    fn modulus<'py>(
        &self,
        py: Python<'py>,
        omega: &Bound<'py, PyAny>,
        inputs: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<Complex64>>> {
        if !self.network.is_linear() {
            return Err(value_error(format!("the law {} is not linear: it has no modulus", self.entry.name)));
        }
        let inputs = self.inputs(inputs)?;
        let at = Point { t: 0.0, stroke: 0.0, rate: 0.0, inputs: &inputs };
        each(py, omega, "omega", |omega| {
            let [re, im] = self.network.complex_modulus(&at, omega);
            Complex64::new(re, im)
        })
    }

    /// F at t > 0, s, after a unit step of the stroke: in the shape of ``t``, N/m. For linear laws of springs and springpots.
    fn relaxation<'py>(&self, py: Python<'py>, t: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let tangent = self.tangent()?;
        if !tangent.is_smooth() {
            let why = "the relaxation is worked out for springs and springpots alone, and the law holds a dashpot";
            return Err(value_error(why));
        }
        if let Tangent::Leaf(term, _) = &tangent
            && term.order == 0.0
        {
            return each(py, t, "t", |_| term.coefficient);
        }
        each(py, t, "t", |t| if t > 0.0 { tangent.relaxation(t) } else { f64::NAN })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyDict>,))> {
        Ok((py.get_type::<Self>().into_any(), (self.made_of.to_dict(py)?,)))
    }

    fn __repr__(&self) -> String {
        let values =
            self.entry.params.iter().zip(&self.values).map(|(param, values)| match (&values[..], param.is_list) {
                ([only], false) => format!("{}={only}", param.name),
                (all, _) => format!("{}={all:?}", param.name),
            });
        let tables = self.made_of.tables().map(|(name, x, _)| format!("{name}=<{} points>", x.len()));
        let tables = tables.chain(self.made_of.texts().map(|(name, text)| format!("{name}={text:?}")));
        let derivative = std::iter::once(format!("derivative=\"{}\"", definition_name(self.derivative)));
        let words = values.chain(tables).chain(derivative).collect::<Vec<_>>().join(", ");
        format!("Law(\"{}\", {words})", self.entry.name)
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.made_of.is_same_law(&other.made_of)
    }

    fn __hash__(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        self.entry.name.hash(&mut hasher);
        // 0 and −0 are equal.
        self.values.iter().flatten().for_each(|value| (value + 0.0).to_bits().hash(&mut hasher));
        hasher.finish()
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        notebook::html("law", slf)
    }
}

/// A function of every number of an array.
pub(crate) fn each<'py, T: numpy::Element + Clone>(
    py: Python<'py>,
    value: &Bound<'py, PyAny>,
    name: &str,
    of: impl Fn(f64) -> T,
) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
    let array = numbers(value, name)?;
    let shape = array.shape().to_vec();
    let all: Vec<T> = flat(&array)?.into_iter().map(of).collect();
    let flat = numpy::PyArray1::from_vec(py, all);
    flat.reshape(&shape[..])
}
