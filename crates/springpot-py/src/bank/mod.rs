//! `springpot.Bank`: laws with their states, for other people's integrators.

mod core;
mod told;

use self::core::{Core, Settings};
use crate::array::{Rows, column, flat, numbers, written};
use crate::error::{guarded, run_error_at, type_error, value_error};
use crate::law::described;
use crate::quantity::number;
use numpy::{PyArray1, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use springpot::collocation::Nodes;
use springpot::elements::MemoryRange;
use springpot::fractional::Form;
use springpot::law::Course;
use std::sync::{Mutex, MutexGuard, TryLockError};

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<PyBank>()
}

/// Elements with their memories, for other people's integrators: strokes in, forces and tangents out. It knows no robot.
///
/// Args:
///     elements: :class:`Law` objects, or dicts ``{"law": name | "network": text, "parameters": {…}, "derivative": "caputo", "name": …}``; names
///         default to "0", "1", ….
///     nodes: where a step of size h is asked, at t + c·h: ``"end"`` (c = 1, order 2 − alpha), ``"midpoint"`` (c = ½: forces are means over the
///         step, order 2 in the motion) or ``"radau"`` (three nodes, (4 ∓ √6)/10 and 1, order 5).
///     form: what the memory takes x' from between the nodes: ``"rates"`` (for radau) or ``"strokes"`` (else; also where very stiff).
///     motion: ``"sought"`` where strokes are found together with the forces, ``"given"`` where they are measured or prescribed.
///     tolerance: relative error of the memories, 1e-13 … 0.1.
///     step: the shortest step that is planned, s; shorter ones may follow. 1 ms where left out.
///     horizon: the longest past that is remembered to that tolerance, s. 100 s where left out.
///
/// What an integrator does for a step from t to t + h:
///
/// 1. guess strokes x and rates x' at the nodes and call :meth:`evaluate`, which is pure: as often as it likes, with other guesses and other h;
/// 2. solve its equations with the forces and their tangents;
/// 3. :meth:`evaluate` once more with what it found, and :meth:`commit`, which takes the step into the past. Steps follow one another: the next
///    one starts where this one ended.
///
/// Explicit integrators (a callback that is asked for a force at t, after a step of h) take ``nodes="end"``, evaluate the step *behind* them, from
/// t − h to t, with the stroke and rate now, use that force, and commit it. In the right-hand side of ``scipy.integrate.solve_ivp``, over a stretch
/// that starts at t0, ``evaluate(t0, t - t0, x, x')`` gives the force at t > t0; commit at the end of the stretch. To reject a step, do not commit;
/// to go back further, :meth:`state` and :meth:`set_state`.
///
/// Stroke x, m, force F, N, positive in tension; on a rotation rad and N·m.
///
/// >>> import numpy as np, springpot as sp
/// >>> bank = sp.Bank([sp.law("springpot", c=1.0, alpha=0.5)], motion="given", step=0.01, horizon=1.0)
/// >>> bank.begin([0.0])
/// >>> for n in range(100):  # x = t²
/// ...     t = 0.01 * (n + bank.nodes)
/// ...     force, by_stroke, by_rate = bank.evaluate(0.01 * n, 0.01, [t**2], [2 * t])
/// ...     bank.commit()
/// >>> bool(abs(force[0, -1] - 8 / (3 * np.sqrt(np.pi))) < 1e-7)  # D^½ t² at t = 1
/// True
#[pyclass(frozen, name = "Bank", module = "springpot._springpot")]
#[derive(Debug)]
pub(crate) struct PyBank {
    core: Mutex<Core>,
    nodes: Nodes,
    names: Vec<String>,
    /// `element.input` and its unit, element by element.
    inputs: Vec<(String, String)>,
}

/// Forces and their two tangents.
type Answer<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>);

impl PyBank {
    fn lock(&self, py: Python<'_>) -> PyResult<MutexGuard<'_, Core>> {
        match self.core.try_lock() {
            Ok(core) => Ok(core),
            Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => Err(run_error_at(py, "the bank is at work in another thread", None)),
        }
    }

    fn with<T>(&self, py: Python<'_>, work: impl FnOnce(&mut Core) -> PyResult<T>) -> PyResult<T> {
        guarded(py, || work(&mut *self.lock(py)?))
    }

    /// n numbers, one for each element.
    fn column(&self, value: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<f64>> {
        let (array, n) = (numbers(value, name)?, self.names.len());
        match array.shape() {
            [found] if *found == n => flat(&array),
            shape => Err(value_error(format!("{name} has shape {}; it must have shape ({n},)", written(shape)))),
        }
    }

    /// n × nodes numbers; with one node n numbers do as well.
    fn matrix(&self, value: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<f64>> {
        let (array, n, s) = (numbers(value, name)?, self.names.len(), self.nodes.count());
        match *array.shape() {
            [found] if found == n && s == 1 => flat(&array),
            [found, nodes] if found == n && nodes == s => {
                let (rows, mut all) = (Rows::new(&array, name, s)?, vec![0.0; n * s]);
                all.chunks_mut(s).enumerate().for_each(|(e, row)| rows.read(e, row));
                Ok(all)
            }
            _ => {
                let shape = written(array.shape());
                Err(value_error(format!("{name} has shape {shape}; it must have shape ({n}, {s})")))
            }
        }
    }
}

#[pymethods]
impl PyBank {
    #[new]
    #[pyo3(signature = (elements, *, nodes="radau", form=None, motion="sought", tolerance=1e-8, step=None, horizon=None))]
    #[expect(clippy::too_many_arguments, reason = "keywords of Python")]
    fn new(
        py: Python<'_>,
        elements: Vec<Bound<'_, PyAny>>,
        nodes: &str,
        form: Option<&str>,
        motion: &str,
        tolerance: f64,
        step: Option<&Bound<'_, PyAny>>,
        horizon: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        guarded(py, || {
            let nodes = match nodes {
                "end" => Nodes::One,
                "midpoint" => Nodes::Midpoint,
                "radau" => Nodes::Radau,
                other => {
                    let help = "write \"end\", \"midpoint\" or \"radau\"";
                    return Err(value_error(format!("nodes is \"{other}\"; {help}")));
                }
            };
            let form = match (form, nodes) {
                (None, Nodes::Radau) | (Some("rates"), _) => Form::Rates,
                (None, _) | (Some("strokes"), _) => Form::Strokes,
                (Some(other), _) => {
                    return Err(value_error(format!("form is \"{other}\"; write \"rates\" or \"strokes\"")));
                }
            };
            let course = match motion {
                "sought" => Course::Sought,
                "given" => Course::Given,
                other => return Err(value_error(format!("motion is \"{other}\"; write \"sought\" or \"given\""))),
            };
            let time = |said: Option<&Bound<'_, PyAny>>, name: &str, default: f64| match said {
                None => Ok(default),
                Some(said) => match number(said, "s", name)? {
                    seconds if seconds > 0.0 => Ok(seconds),
                    seconds => Err(value_error(format!("{name} is {seconds} s; it must be positive"))),
                },
            };
            let (shortest, horizon) = (time(step, "step", 1e-3)?, time(horizon, "horizon", 100.0)?);
            let memory = MemoryRange { tolerance, shortest, horizon };
            if !(1e-13..=0.1).contains(&tolerance) {
                return Err(value_error(format!("tolerance is {tolerance}; it must be between 1e-13 and 0.1")));
            }
            let (mut names, mut laws) = (Vec::new(), Vec::new());
            for (k, element) in elements.iter().enumerate() {
                let description = described(element)?;
                let name = description.name.clone().unwrap_or_else(|| k.to_string());
                if names.contains(&name) {
                    return Err(value_error(format!("two elements are called \"{name}\"")));
                }
                let built = description.build();
                let place = |error: PyErr| {
                    let of = format!("element \"{name}\": {}", error.value(py));
                    if error.is_instance_of::<pyo3::exceptions::PyValueError>(py) { value_error(of) } else { error }
                };
                laws.push(built.map_err(place)?);
                names.push(name);
            }
            let inputs = names.iter().zip(&laws).flat_map(|(name, law)| {
                law.entry.inputs.iter().map(move |input| (format!("{name}.{}", input.name), input.unit.to_string()))
            });
            let inputs: Vec<_> = inputs.collect();
            let core = Core::new(
                laws.iter().map(|law| (law.network.clone(), law.entry.clone(), law.derivative)).collect(),
                Settings { nodes, form, course, memory },
            );
            Ok(Self { core: Mutex::new(core), nodes, names, inputs })
        })
    }

    /// c of the nodes, shape ``(nodes,)``.
    #[getter]
    fn nodes<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.nodes.positions())
    }

    /// A of the collocation, x_i − x_0 = h Σ A_ij x'_j: shape ``(nodes, nodes)``.
    #[getter]
    fn matrix_of_nodes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let s = self.nodes.count();
        let rows = self.nodes.matrix().iter().take(s);
        let flat = PyArray1::from_iter(py, rows.flat_map(|row| row[..s].to_vec()).collect::<Vec<f64>>());
        Ok(flat.reshape([s, s])?.into_any())
    }

    /// Names of the elements.
    #[getter]
    fn names(&self) -> Vec<String> {
        self.names.clone()
    }

    /// All inputs, ``"element.input"``, in the order in which arrays have them.
    #[getter]
    fn inputs(&self) -> Vec<String> {
        self.inputs.iter().map(|(name, _)| name.clone()).collect()
    }

    /// Where the last committed step ended, s.
    #[getter]
    fn t(&self, py: Python<'_>) -> PyResult<f64> {
        self.with(py, |core| Ok(core.t()))
    }

    /// Number of exponentials in all memories.
    #[getter]
    fn modes(&self, py: Python<'_>) -> PyResult<usize> {
        self.with(py, |core| Ok(core.modes()))
    }

    /// Goes to t = 0; whatever was is forgotten.
    ///
    /// Args:
    ///     strokes: x(0), shape ``(n,)``, m. Held there for t < 0 with the Caputo derivative; with Riemann–Liouville x was 0 and jumped.
    ///     rates: x'(0), shape ``(n,)``, m/s; 0 where left out.
    ///     inputs: at t = 0, as in :meth:`evaluate`; needed where laws have inputs.
    #[pyo3(signature = (strokes, rates=None, inputs=None))]
    fn begin(
        &self,
        py: Python<'_>,
        strokes: &Bound<'_, PyAny>,
        rates: Option<&Bound<'_, PyAny>>,
        inputs: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let strokes = self.column(strokes, "strokes")?;
        let rates = rates.map(|rates| self.column(rates, "rates")).transpose()?;
        self.with(py, |core| {
            let rates = rates.unwrap_or_else(|| vec![0.0; strokes.len()]);
            let inputs = told::held(inputs, &self.inputs, None)?;
            core.begin(strokes, rates, inputs).map_err(|error| self.told(py, error, 0.0))
        })
    }

    /// Rates, shape ``(n,)``, and inputs right after a jump of them, at the start of the next step; without it the next step starts with those at the end of the last one.
    #[pyo3(signature = (rates=None, inputs=None))]
    fn restart(
        &self,
        py: Python<'_>,
        rates: Option<&Bound<'_, PyAny>>,
        inputs: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let rates = rates.map(|rates| self.column(rates, "rates")).transpose()?;
        self.with(py, |core| {
            let inputs = inputs.map(|inputs| told::held(Some(inputs), &self.inputs, core.inputs())).transpose()?;
            let t = core.t();
            core.restart(rates, inputs).map_err(|error| self.told(py, error, t))
        })
    }

    /// Forces of a step from t to t + h, at its nodes, and their tangents; pure.
    ///
    /// Args:
    ///     t: where the last step that was committed ended, s; 0 after :meth:`begin`. h: s, positive.
    ///     strokes: x at the nodes, shape ``(n, nodes)``, or ``(n,)`` with one node.
    ///     rates: x' there, in the same shape; left out: those of the polynomial through the strokes.
    ///     inputs: shape ``(m,)`` or ``(m, nodes)`` in the order of :attr:`inputs`, or a dict by name of numbers, texts with units, or arrays of
    ///         shape ``(nodes,)``; what is not said stays as it was. They count as held over the step.
    ///
    /// Returns:
    ///     F, shape ``(n, nodes)``, N; ∂F_i/∂x_j and ∂F_i/∂x'_j, shape ``(n, nodes, nodes)``, N/m and N·s/m. Where rates were left out, the first
    ///     tangent has all of it, and the second is 0.
    #[pyo3(signature = (t, h, strokes, rates=None, inputs=None))]
    fn evaluate<'py>(
        &self,
        py: Python<'py>,
        t: f64,
        h: f64,
        strokes: &Bound<'py, PyAny>,
        rates: Option<&Bound<'py, PyAny>>,
        inputs: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Answer<'py>> {
        let strokes = self.matrix(strokes, "strokes")?;
        let rates = rates.map(|rates| self.matrix(rates, "rates")).transpose()?;
        self.with(py, |core| {
            let (n, s) = (self.names.len(), self.nodes.count());
            let inputs = told::at_nodes(inputs, &self.inputs, s, core.inputs())?;
            core.evaluate(t, h, &strokes, rates.as_deref(), inputs).map_err(|error| self.told(py, error, t))?;
            let forces = PyArray1::from_vec(py, core.forces()).reshape([n, s])?.into_any();
            let slopes = core.slopes(rates.is_none());
            let [by_stroke, by_rate] = slopes.map(|slopes| PyArray1::from_vec(py, slopes).reshape([n, s, s]));
            Ok((forces, by_stroke?.into_any(), by_rate?.into_any()))
        })
    }

    /// Takes the step that was evaluated last into the past.
    fn commit(&self, py: Python<'_>) -> PyResult<()> {
        self.with(py, |core| {
            let t = core.t();
            core.commit().map_err(|error| self.told(py, error, t))
        })
    }

    /// Energy stored in each element, shape ``(n,)``, J; NaN where unknown.
    #[getter]
    fn stored<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.with(py, |core| Ok(PyArray1::from_vec(py, core.stored())))
    }

    /// Energy dissipated since t = 0, shape ``(n,)``, J.
    #[getter]
    fn dissipated<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.with(py, |core| Ok(PyArray1::from_vec(py, core.energies().0)))
    }

    /// Energy supplied by inputs since t = 0, shape ``(n,)``, J.
    #[getter]
    fn supplied<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.with(py, |core| Ok(PyArray1::from_vec(py, core.energies().1)))
    }

    /// All that outlasts a step, as one array: to be kept, pickled, and given to a bank of the same elements.
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.with(py, |core| {
            let state = core.state().map_err(|error| self.told(py, error, 0.0))?;
            Ok(PyArray1::from_vec(py, state))
        })
    }

    /// Goes on from a state of a bank of the same elements and settings.
    fn set_state(&self, py: Python<'_>, state: &Bound<'_, PyAny>) -> PyResult<()> {
        let state = column(state, "state")?;
        self.with(py, |core| core.set_state(&state).map_err(|error| self.told(py, error, 0.0)))
    }

    fn __len__(&self) -> usize {
        self.names.len()
    }

    fn __reduce__(&self) -> PyResult<()> {
        Err(type_error(
            "a bank is not copied: keep its state(), and give it to set_state() of one of the same elements and settings",
        ))
    }

    fn __repr__(&self) -> String {
        format!("Bank({} elements, nodes={:?})", self.names.len(), self.nodes.positions())
    }
}

impl PyBank {
    fn told(&self, py: Python<'_>, error: core::BankError, t: f64) -> PyErr {
        use core::BankError::{Broken, Elsewhere, Kernel, NotBegun, NotEvaluated, NotFinite, OtherBank, Step};
        match error {
            NotBegun => value_error("the bank has not begun; call begin(strokes) first"),
            NotEvaluated => value_error("no step was evaluated since the last commit"),
            OtherBank => value_error("the state is one of another bank"),
            Step(t, h) => value_error(format!("t = {t} s, h = {h} s: times must be finite, and h positive")),
            Elsewhere(t, last) => value_error(format!("a step from t = {t} s, but the last one ended at {last} s")),
            NotFinite(what, e, value) => {
                value_error(format!("{what} of element \"{}\" is {value}; it must be finite", self.names[e]))
            }
            Broken(e, why) => run_error_at(py, format!("t = {t} s: element \"{}\": {why}", self.names[e]), Some(t)),
            Kernel(why) => run_error_at(py, why, Some(0.0)),
        }
    }
}
