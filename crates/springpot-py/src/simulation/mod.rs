//! `springpot.Simulation`: a system stepped from Python.

mod build;
mod callback;
mod snapshot;
mod state;
mod stepping;

use self::callback::Callback;
use self::snapshot::Columns;
use self::state::PyState;
use crate::array::{Rows, numbers};
use crate::error::{guarded, run_error, run_error_at, type_error, value_error};
use crate::model::PyModel;
use crate::pickle;
use crate::quantity::number;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::gc::{PyTraverseError, PyVisit};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyString};
use springpot::Simulation;
use springpot::model::Model;
use springpot::observe::Quantity;
use springpot::system::RunError;
use springpot_run::Asked;
use std::sync::{Arc, Mutex, MutexGuard, TryLockError};

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<PySimulation>()?;
    module.add_class::<snapshot::PySnapshot>()?;
    module.add_class::<PyState>()
}

/// A scenario on its way, stepped from Python.
///
/// Args:
///     scenario: a path, a text (with a line break or ``=``) or a dict. Of a sweep the values of the file itself count.
///     set: values in place of its own, by dotted path.
///     controller: ``f(t, q, v) -> tau`` with arrays of shape ``(nq,)``, ``(nv,)`` → ``(nv,)`` (a float where nv is 1), N·m or N. Asked at every
///         step of a fixed-step scenario, else at ``sample``; tau holds until the next time. It comes on top of the scenario's torques and of
///         :meth:`set_torque`. Joints that no force drives are passed over.
///     inputs: by ``"element.input"``: a number or a text with a unit, held; ``f(t, q, v) -> float`` (SI), asked as a controller is; or a tuple
///         of it and its own sample time.
///     motions: by joint of one degree: ``f(t) -> float`` (rad or m), or a tuple of times and values. In a forward motion the joint becomes a
///         prescribed one, in a prescribed motion its path is replaced. Callables are asked before the start, on a grid of ``motion_step`` from
///         0 to the end; what moves is the C² spline through their values, whose derivatives are its velocity and acceleration.
///     sample: seconds between two times at which callables are asked, 0 included; a number or a text such as ``"1 ms"``.
///     motion_step: step of the grid of motions, s; the thousandth part of the run where left out.
///     sensitivity: paths of numbers, or names of parameters, by which it is differentiated besides those of the scenario: ``dq``, ``dv`` and the
///         columns ``d(…)/d(…)`` of snapshots. What is held from outside, and what callables give, does not move with them.
///
/// Callables of one instant see what was before any of them acts, and none is asked at the end. An exception that one raises comes through as
/// it is; the simulation is then where it was. A step ends at the next sample at the latest. Whoever calls a simulation that is at work, from
/// another thread or from one of its callables, gets a ``RunError``. Events of the scenario happen as in :func:`springpot.run`: ``passed`` tells those of
/// the last step, and where one stops, ``step`` is False and ``step_to`` ends there.
///
/// >>> import springpot as sp
/// >>> arm = sp.Simulation('''
/// ... robot.body = [{ name = "arm", joint = { name = "q1", kind = "revolute", axis = [0, 1, 0] }, mass = 1, com = [0.2, 0, 0] }]
/// ... motion = { kind = "forward" }
/// ... time = { end = "2 s", output_step = "10 ms" }
/// ... [[element]]
/// ... name = "strut"
/// ... from = { body = "world", point = [0, 0, -0.3] }
/// ... to = { body = "arm", point = [0.3, 0, 0] }
/// ... rest_length = "42 cm"
/// ... law = "springpot"
/// ... parameters = { c = "50 N*s^alpha/m", alpha = 0.4 }
/// ... ''', controller=lambda t, q, v: -100 * q - 5 * v, sample="10 ms")
/// >>> arm.step_to(2.0)
/// >>> bool(abs(arm.v[0]) < 0.01 and abs(arm.q[0]) < 0.02)
/// True
/// >>> now = arm.snapshot()
/// >>> now.units["strut.force"]
/// 'N'
#[pyclass(frozen, name = "Simulation", module = "springpot._springpot")]
pub(crate) struct PySimulation {
    inner: Mutex<Inner>,
    model: Arc<Model>,
    robot: Py<PyModel>,
    /// The scenario, and the callables and other words that it was made with.
    origin: Asked,
    words: Py<PyDict>,
    columns: Arc<Columns>,
    /// How the values of the columns are found.
    quantities: Vec<Quantity>,
    v_names: Vec<String>,
    /// By what it is differentiated.
    parameters: Vec<String>,
    end: f64,
}

/// What the bytes of its scenario begin with.
const TAG: &str = "springpot simulation 1\n";

/// What a pickle holds: the scenario, what else it was made with, and where it is.
type Parts<'py> = (Bound<'py, PyBytes>, Bound<'py, PyDict>, Py<PyState>);

/// What one caller at a time works with.
struct Inner {
    simulation: Simulation,
    callbacks: Vec<Callback>,
    /// The velocities that forces drive.
    driven: Vec<usize>,
    /// Torques of the caller and of the controller (nv), which add up.
    own: Vec<f64>,
    control: Vec<f64>,
}

/// What goes wrong in a simulation: what was asked of it, or where it came.
fn failed(py: Python<'_>, error: &RunError) -> PyErr {
    match error {
        RunError::Outside { .. } | RunError::NotDriven { .. } | RunError::NoInput { .. } | RunError::OtherRun => {
            value_error(error)
        }
        _ => run_error(py, error),
    }
}

impl PySimulation {
    /// The simulation for one call.
    fn lock(&self, py: Python<'_>) -> PyResult<MutexGuard<'_, Inner>> {
        match self.inner.try_lock() {
            Ok(inner) => Ok(inner),
            Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => {
                let why = "the simulation is at work: in another thread, or in the step that called this callback";
                Err(run_error_at(py, why, None))
            }
        }
    }

    /// A call that needs the simulation.
    fn with<T>(&self, py: Python<'_>, work: impl FnOnce(&mut Inner) -> PyResult<T>) -> PyResult<T> {
        guarded(py, || work(&mut *self.lock(py)?))
    }

    /// Derivatives of q (0) or v (1).
    fn tangents<'py>(&self, py: Python<'py>, which: usize) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.with(py, |inner| {
            let mut found = inner.simulation.tangents().map_err(|error| failed(py, &error))?;
            let rows = if which == 0 { self.model.nq() } else { self.model.nv() };
            PyArray1::from_vec(py, std::mem::take(&mut found[which])).reshape([rows, self.parameters.len()])
        })
    }

    /// Which velocity is called so, or has that index.
    fn velocity(&self, joint: &Bound<'_, PyAny>) -> PyResult<usize> {
        let nv = self.v_names.len();
        if let Ok(name) = joint.cast::<PyString>() {
            let name = name.to_cow()?;
            return self.v_names.iter().position(|own| *own == name).ok_or_else(|| {
                // The velocity of what was named as a coordinate.
                let named = self.model.q_labels().iter().position(|label| label.name == *name);
                let of_it = named.and_then(|place| (0..nv).find(|k| self.model.coordinate_of(*k) == Some(place)));
                let suggest = || springpot_scenario::suggest(&name, self.v_names.iter().map(String::as_str));
                let help = of_it.map_or_else(suggest, |k| format!("did you mean `{}`?", self.v_names[k]));
                value_error(format!("no velocity is called \"{name}\"; {help}"))
            });
        }
        let index: isize = joint.extract()?;
        let index = if index < 0 { index + nv as isize } else { index };
        usize::try_from(index)
            .ok()
            .filter(|index| *index < nv)
            .ok_or_else(|| value_error(format!("there is no velocity {index}; there are {nv}")))
    }
}

#[pymethods]
impl PySimulation {
    #[new]
    #[pyo3(signature = (scenario, *, set=None, controller=None, inputs=None, motions=None, sample=None, motion_step=None, sensitivity=None))]
    #[expect(clippy::too_many_arguments, reason = "keywords of Python")]
    fn new(
        py: Python<'_>,
        scenario: &Bound<'_, PyAny>,
        set: Option<&Bound<'_, PyAny>>,
        controller: Option<Bound<'_, PyAny>>,
        inputs: Option<&Bound<'_, PyDict>>,
        motions: Option<&Bound<'_, PyDict>>,
        sample: Option<&Bound<'_, PyAny>>,
        motion_step: Option<&Bound<'_, PyAny>>,
        sensitivity: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let asked = build::Asked { controller, inputs, motions, sample, motion_step, sensitivity };
        guarded(py, || build::build(py, scenario, set, &asked))
    }

    /// Time, s.
    #[getter]
    fn t(&self, py: Python<'_>) -> PyResult<f64> {
        self.with(py, |inner| Ok(inner.simulation.t()))
    }

    /// Where the last step began, s: the earliest time of :meth:`interpolate`.
    #[getter]
    fn t_before(&self, py: Python<'_>) -> PyResult<f64> {
        self.with(py, |inner| Ok(inner.simulation.t_before()))
    }

    /// Where the motion ends, s.
    #[getter]
    fn end(&self) -> f64 {
        self.end
    }

    /// Coordinates, shape ``(nq,)``; a copy.
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.with(py, |inner| Ok(PyArray1::from_slice(py, inner.simulation.q())))
    }

    /// Velocities, shape ``(nv,)``; a copy.
    #[getter]
    fn v<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.with(py, |inner| Ok(PyArray1::from_slice(py, inner.simulation.v())))
    }

    /// Names of what it is differentiated by, in the order of the last axis of ``dq`` and ``dv``.
    #[getter]
    fn parameters(&self) -> Vec<String> {
        self.parameters.clone()
    }

    /// Derivatives of q by the parameters, shape ``(nq, P)``.
    #[getter]
    fn dq<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.tangents(py, 0)
    }

    /// Derivatives of v by the parameters, shape ``(nv, P)``.
    #[getter]
    fn dv<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.tangents(py, 1)
    }

    /// The robot.
    #[getter]
    fn model(&self, py: Python<'_>) -> Py<PyModel> {
        self.robot.clone_ref(py)
    }

    /// Names of all that a snapshot tells, in the order of the rows of a run.
    #[getter]
    fn columns(&self) -> Vec<String> {
        self.columns.names().map(str::to_owned).collect()
    }

    /// SI units by column; empty for a pure number.
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.columns.units(py)
    }

    /// Names of the elements.
    #[getter]
    fn element_names(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        self.with(py, |inner| Ok(inner.simulation.system().elements.iter().map(|e| e.name.clone()).collect()))
    }

    /// Takes one step, which ends at the next sample and at the next event that acts at the latest; ``False``, and nothing done, at the end.
    fn step(&self, py: Python<'_>) -> PyResult<bool> {
        self.with(py, |inner| inner.step(py))
    }

    /// Takes steps until the time is t, s, where the last one ends, or until an event stops it. Ctrl-C stops it between two steps.
    fn step_to(&self, py: Python<'_>, t: &Bound<'_, PyAny>) -> PyResult<()> {
        let t = number(t, "s", "t")?;
        self.with(py, |inner| inner.step_to(py, t))
    }

    /// All that is known at the present time.
    fn snapshot(&self, py: Python<'_>) -> PyResult<snapshot::PySnapshot> {
        self.with(py, |inner| {
            let taken = inner.simulation.snapshot().map_err(|error| failed(py, &error))?;
            Ok(snapshot::PySnapshot::new(&taken, self.columns.clone(), &self.quantities))
        })
    }

    /// All that is known at a time of the last step, from :attr:`t_before` to :attr:`t`.
    fn interpolate(&self, py: Python<'_>, t: &Bound<'_, PyAny>) -> PyResult<snapshot::PySnapshot> {
        let t = number(t, "s", "t")?;
        self.with(py, |inner| {
            let taken = inner.simulation.interpolate(t).map_err(|error| failed(py, &error))?;
            Ok(snapshot::PySnapshot::new(&taken, self.columns.clone(), &self.quantities))
        })
    }

    /// Holds a torque (N·m) or force (N) on a joint from now on, on top of the scenario's; ``joint`` is one of the names or places of v.
    fn set_torque(&self, py: Python<'_>, joint: &Bound<'_, PyAny>, torque: &Bound<'_, PyAny>) -> PyResult<()> {
        let velocity = self.velocity(joint)?;
        let unit = self.model.v_labels()[velocity].dimension.units().force;
        let torque = number(torque, unit, "torque")?;
        self.with(py, |inner| {
            let total = torque + inner.control[velocity];
            inner.simulation.set_torque(velocity, total).map_err(|error| failed(py, &error))?;
            inner.own[velocity] = torque;
            Ok(())
        })
    }

    /// Holds torques on all joints that forces drive, shape ``(nv,)``, N·m or N.
    fn set_torques(&self, py: Python<'_>, tau: &Bound<'_, PyAny>) -> PyResult<()> {
        let nv = self.v_names.len();
        let array = numbers(tau, "tau")?;
        let rows = Rows::new(&array, "tau", nv)?;
        if rows.count.is_some() {
            return Err(value_error(format!("tau must have shape ({nv},)")));
        }
        let mut values = vec![0.0; nv];
        rows.read(0, &mut values);
        self.model.check_v("tau", &values).map_err(value_error)?;
        self.with(py, |inner| {
            inner.own = values;
            inner.apply_torques(py)
        })
    }

    /// Holds an input of an element from now on, SI or a text with a unit; ``None`` gives it back to its signal.
    #[pyo3(signature = (element, input, value))]
    fn set_input(&self, py: Python<'_>, element: &str, input: &str, value: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        self.with(py, |inner| {
            let (e, i, unit) = callback::find_input(&inner.simulation, element, input)?;
            let value = value.map(|value| number(value, &unit, input)).transpose()?;
            inner.simulation.set_input(e, i, value).map_err(|error| failed(py, &error))
        })
    }

    /// All that it takes to go on to the bit, memories of the elements included; picklable. What callables keep is not in it.
    fn state(&self, py: Python<'_>) -> PyResult<PyState> {
        self.with(py, |inner| inner.state(py))
    }

    /// Goes on from a state of the same scenario, values and callables, later or earlier.
    fn set_state(&self, py: Python<'_>, state: &PyState) -> PyResult<()> {
        self.with(py, |inner| inner.set_state(py, state))
    }

    /// Steps taken and rejected, Newton iterations, exponentials of the memories.
    #[getter]
    fn report<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.with(py, |inner| {
            let (report, words) = (inner.simulation.report(), PyDict::new(py));
            words.set_item("steps", report.steps)?;
            words.set_item("rejected_steps", report.rejected_steps)?;
            words.set_item("newton_iterations", report.newton_iterations)?;
            words.set_item("explicit_steps", report.explicit_steps)?;
            words.set_item("evaluations", report.evaluations)?;
            words.set_item("method_switches", report.method_switches)?;
            words.set_item("modes", report.modes)?;
            Ok(words)
        })
    }

    /// The events of the last step in their order: pairs of a name and when it happened, s. What one sets acts with the next step.
    #[getter]
    fn passed(&self, py: Python<'_>) -> PyResult<Vec<(String, f64)>> {
        self.with(py, |inner| Ok(inner.simulation.passed().map(|(event, t)| (event.name.clone(), t)).collect()))
    }

    /// The name of the event that ended the simulation where it is, or None: no step leads on from there.
    #[getter]
    fn stopped_by(&self, py: Python<'_>) -> PyResult<Option<String>> {
        self.with(py, |inner| Ok(inner.simulation.stopped_by().map(|event| event.name.clone())))
    }

    /// Another one of the same scenario, values and callables, where this one is; they go on apart, but for what callables keep.
    fn copy(&self, py: Python<'_>) -> PyResult<Self> {
        let state = self.state(py)?;
        let other = guarded(py, || build::again(py, self.origin.clone(), self.words.bind(py)))?;
        other.set_state(py, &state)?;
        Ok(other)
    }

    fn __copy__(&self, py: Python<'_>) -> PyResult<Self> {
        self.copy(py)
    }

    fn __deepcopy__(&self, py: Python<'_>, _memo: &Bound<'_, PyAny>) -> PyResult<Self> {
        self.copy(py)
    }

    /// What `__reduce__` made.
    #[staticmethod]
    fn _from_parts(py: Python<'_>, origin: &[u8], words: &Bound<'_, PyDict>, state: &PyState) -> PyResult<Self> {
        let origin = pickle::of_bytes(TAG, "simulation", origin)?;
        let simulation = guarded(py, || build::again(py, origin, words))?;
        simulation.set_state(py, state)?;
        Ok(simulation)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Parts<'py>)> {
        let words = self.words.bind(py).clone();
        if let Err(error) = py.import("pickle")?.call_method1("dumps", (&words,)) {
            let what = "what a simulation asks (controller, inputs, motions) must be picklable, functions of a module and no lambdas";
            return Err(type_error(format!("{what}: {error}; its state() is picklable in any case")));
        }
        let state = Py::new(py, self.state(py)?)?;
        let origin = pickle::to_bytes(py, TAG, &self.origin)?;
        Ok((py.get_type::<Self>().getattr("_from_parts")?, (origin, words, state)))
    }

    fn __repr__(&self) -> String {
        let end = self.end;
        match self.inner.try_lock() {
            Ok(inner) => format!("Simulation(t={}, end={end}, nq={})", inner.simulation.t(), self.model.nq()),
            Err(_) => format!("Simulation(at work, end={end}, nq={})", self.model.nq()),
        }
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        // One at work is held by its caller.
        let Ok(inner) = self.inner.try_lock() else { return Ok(()) };
        visit.call(&self.words)?;
        inner.callbacks.iter().try_for_each(|callback| visit.call(&callback.function))
    }

    fn __clear__(&self) {
        if let Ok(mut inner) = self.inner.try_lock() {
            inner.callbacks.clear();
        }
    }
}
