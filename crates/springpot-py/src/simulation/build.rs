//! From a scenario and callables to a simulation.

use super::callback::{Callback, What, find_input};
use super::snapshot::Columns;
use super::{Inner, PySimulation, failed};
use crate::array::numbers;
use crate::error::{scenario_error, type_error, value_error};
use crate::interrupt::interruptible;
use crate::model::{PyModel, origin::Origin as ModelOrigin};
use crate::quantity::number;
use crate::scenario::{CATALOG, asked as scenario_asked};
use numpy::{PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString, PyTuple};
use springpot::Simulation;
use springpot::actuation::Drive;
use springpot::motion::{JointPath, Trajectory};
use springpot::signal::Signal;
use springpot::system::{Motion, RunError, System};
use springpot_run::Asked as Origin;
use springpot_scenario::{Plan, RobotPlan, suggest};
use std::sync::{Arc, Mutex};

/// Stretches of a motion that is given as a callable, where nobody says how long they are.
const STRETCHES: f64 = 1000.0;
/// Most points of it.
const MOST_POINTS: f64 = 1e7;

/// What the caller wants besides the scenario.
pub(super) struct Asked<'a, 'py> {
    pub(super) controller: Option<Bound<'py, PyAny>>,
    pub(super) inputs: Option<&'a Bound<'py, PyDict>>,
    pub(super) motions: Option<&'a Bound<'py, PyDict>>,
    pub(super) sample: Option<&'a Bound<'py, PyAny>>,
    pub(super) motion_step: Option<&'a Bound<'py, PyAny>>,
    pub(super) sensitivity: Option<&'a Bound<'py, PyAny>>,
}

impl<'py> Asked<'_, 'py> {
    /// What the caller wants, by its words.
    fn words(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let words = PyDict::new(py);
        words.set_item("controller", &self.controller)?;
        words.set_item("inputs", self.inputs)?;
        words.set_item("motions", self.motions)?;
        words.set_item("sample", self.sample)?;
        words.set_item("motion_step", self.motion_step)?;
        Ok(words)
    }
}

/// The same simulation at its start once more, of what [`Asked::words`] gave.
pub(super) fn again(py: Python<'_>, origin: Origin, words: &Bound<'_, PyDict>) -> PyResult<PySimulation> {
    let word = |name: &str| Ok::<_, PyErr>(words.get_item(name)?.filter(|word| !word.is_none()));
    let (inputs, motions) = (word("inputs")?, word("motions")?);
    let (sample, motion_step) = (word("sample")?, word("motion_step")?);
    let asked = Asked {
        controller: word("controller")?,
        inputs: inputs.as_ref().map(|inputs| inputs.cast()).transpose()?,
        motions: motions.as_ref().map(|motions| motions.cast()).transpose()?,
        sample: sample.as_ref(),
        motion_step: motion_step.as_ref(),
        sensitivity: None,
    };
    of(py, origin, &asked)
}

pub(super) fn build(
    py: Python<'_>,
    scenario: &Bound<'_, PyAny>,
    set: Option<&Bound<'_, PyAny>>,
    asked: &Asked<'_, '_>,
) -> PyResult<PySimulation> {
    let mut origin = scenario_asked(scenario, set)?;
    if let Some(by) = asked.sensitivity {
        origin.sensitivity = match by.cast::<PyString>() {
            Ok(one) => vec![one.to_cow()?.into_owned()],
            Err(_) => by.extract()?,
        };
    }
    of(py, origin, asked)
}

/// A simulation of a scenario that says by what it is differentiated.
fn of(py: Python<'_>, origin: Origin, asked: &Asked<'_, '_>) -> PyResult<PySimulation> {
    let scenario = origin.scenario().map_err(|refusals| scenario_error(py, &refusals))?.without_sweeps();
    let plan = interruptible(py, |_| scenario.cases(&CATALOG).and_then(|cases| cases.plan(0)))?;
    let plan = plan.map_err(|refusals| scenario_error(py, &refusals))?;
    let motions = motions(py, &plan, asked)?;
    let differentiated = plan.sensitivity.as_ref().filter(|plan| plan.is_asked());
    if differentiated.is_some() && !motions.is_empty() {
        return Err(value_error(
            "a simulation with derivatives takes its motions from the scenario: leave `motions` out, or the sensitivity",
        ));
    }
    let parameters =
        differentiated.map_or_else(Vec::new, |plan| plan.parameters.iter().map(|own| own.name.clone()).collect());
    let made = interruptible(py, |stop| {
        let mut system = plan.system_unless(stop);
        if !motions.is_empty() {
            replace(&mut system, &plan, motions)?;
        }
        let system = Arc::new(system);
        Simulation::new(system.clone(), plan.settings.clone())
            .map(|simulation| (simulation, system))
            .map_err(Unmade::Run)
    })?;
    let (mut simulation, system) = made.map_err(|unmade| match unmade {
        Unmade::Run(error) => failed(py, &error),
        Unmade::Motion(message) => value_error(message),
    })?;
    let fixed = plan.settings.fixed_step.map(|by| by.step);
    let callbacks = callbacks(py, &mut simulation, asked, fixed)?;
    let driven = match &system.motion {
        Motion::Given(_) => Vec::new(),
        Motion::Forward(forward) => {
            let drives = system.model.own_joints().zip(&forward.drives);
            let driven = drives.filter(|(_, drive)| matches!(drive, Drive::Force(_)));
            driven.flat_map(|(j, _)| system.model.v_range(j)).collect()
        }
    };
    if asked.controller.is_some() && driven.is_empty() {
        return Err(value_error("a controller needs joints that forces drive: a motion of the kind \"forward\""));
    }
    let (model, nv, end) = (system.model.clone(), system.model.nv(), simulation.end());
    let (own, control) = (vec![0.0; nv], vec![0.0; nv]);
    let robot = RobotPlan {
        gravity: plan.gravity,
        bodies: plan.bodies,
        model: plan.model,
        urdf: plan.urdf,
        gripper: plan.gripper,
    };
    let (columns, quantities) = Columns::new(&system.observables());
    Ok(PySimulation {
        words: asked.words(py)?.unbind(),
        robot: Py::new(py, PyModel::of(py, robot, ModelOrigin::Scenario(origin.clone()))?)?,
        origin,
        columns: Arc::new(columns),
        quantities,
        parameters,
        v_names: model.v_labels().into_iter().map(|label| label.name).collect(),
        inner: Mutex::new(Inner { simulation, callbacks, driven, own, control }),
        model,
        end,
    })
}

enum Unmade {
    Run(RunError),
    Motion(String),
}

/// Callables with their samples; inputs that are numbers are held at once.
fn callbacks(
    py: Python<'_>,
    simulation: &mut Simulation,
    asked: &Asked<'_, '_>,
    fixed: Option<f64>,
) -> PyResult<Vec<Callback>> {
    let period = |own: Option<&Bound<'_, PyAny>>, what: &str| -> PyResult<f64> {
        let Some(sample) = own.or(asked.sample) else {
            let help = "say when it is asked, sample=\"1 ms\", or give the scenario a fixed-step solver";
            return fixed.ok_or_else(|| value_error(format!("{what} has no sample time; {help}")));
        };
        match number(sample, "s", "sample")? {
            period if period > 0.0 => Ok(period),
            period => Err(value_error(format!("sample is {period} s; it must be positive"))),
        }
    };
    let mut callbacks = Vec::new();
    if let Some(controller) = &asked.controller {
        if !controller.is_callable() {
            return Err(type_error("controller must be callable: f(t, q, v) -> tau"));
        }
        let period = period(None, "the controller")?;
        let function = controller.clone().unbind();
        callbacks.push(Callback { what: What::Controller, function, period, count: 0 });
    }
    for (name, said) in asked.inputs.into_iter().flat_map(|inputs| inputs.iter()) {
        let name: String = name.extract()?;
        let Some((of, own)) = name.rsplit_once('.') else {
            return Err(value_error(format!("inputs are named \"element.input\", not \"{name}\"")));
        };
        let (element, input, unit) = find_input(simulation, of, own)?;
        let pair = said.cast::<PyTuple>().ok().filter(|pair| pair.len() == 2);
        let (function, sample) = match pair {
            Some(pair) => (pair.get_item(0)?, Some(pair.get_item(1)?)),
            None => (said, None),
        };
        if function.is_callable() {
            let period = period(sample.as_ref(), &name)?;
            let what = What::Input { element, input, name };
            callbacks.push(Callback { what, function: function.unbind(), period, count: 0 });
        } else {
            let value = number(&function, &unit, &name)?;
            simulation.set_input(element, input, Some(value)).map_err(|error| failed(py, &error))?;
        }
    }
    Ok(callbacks)
}

/// Motions of joints as splines: through (times, values), or through a callable's values on a grid.
fn motions(py: Python<'_>, plan: &Plan, asked: &Asked<'_, '_>) -> PyResult<Vec<(String, Signal)>> {
    let end = plan.settings.end;
    let step = match asked.motion_step {
        None => end / STRETCHES,
        Some(step) => number(step, "s", "motion_step")?,
    };
    if !(step > 0.0 && end / step <= MOST_POINTS) {
        return Err(value_error(format!(
            "motion_step is {step} s; it must be positive and at least {}",
            end / MOST_POINTS
        )));
    }
    let mut motions = Vec::new();
    for (joint, said) in asked.motions.into_iter().flat_map(|motions| motions.iter()) {
        let joint: String = joint.extract()?;
        let (times, values) = if said.is_callable() {
            let stretches = (end / step).ceil().max(3.0);
            let times: Vec<f64> = (0..=stretches as usize).map(|k| end * k as f64 / stretches).collect();
            let mut values = Vec::with_capacity(times.len());
            for (k, t) in times.iter().enumerate() {
                values.push(said.call1((*t,))?.extract::<f64>()?);
                if k % 1024 == 0 {
                    py.check_signals()?;
                }
            }
            (times, values)
        } else {
            let pair = said.cast::<PyTuple>().ok().filter(|pair| pair.len() == 2).ok_or_else(|| {
                type_error(format!("the motion of \"{joint}\" must be a callable f(t) or a tuple (times, values)"))
            })?;
            (column(&pair.get_item(0)?, "times")?, column(&pair.get_item(1)?, "values")?)
        };
        if let Some(bad) = values.iter().find(|value| !value.is_finite()) {
            return Err(value_error(format!("the motion of \"{joint}\" is {bad} somewhere; it must be finite")));
        }
        let signal = Signal::spline(&times, &values);
        let signal = signal.map_err(|error| value_error(format!("the motion of \"{joint}\": {error}")))?;
        motions.push((joint, signal.held()));
    }
    Ok(motions)
}

/// A column of numbers.
fn column(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<f64>> {
    let array = numbers(value, name)?;
    match array.shape() {
        [_] => Ok(array.to_vec()?),
        shape => {
            Err(value_error(format!("{name} has shape {}; it must have shape (N,)", crate::array::written(shape))))
        }
    }
}

/// Lets joints move as signals say.
fn replace(system: &mut System, plan: &Plan, motions: Vec<(String, Signal)>) -> Result<(), Unmade> {
    let model = system.model.clone();
    let own: Vec<usize> = model.own_joints().collect();
    let find = |joint: &str| {
        let place = own.iter().position(|j| model.joint_names()[*j] == joint);
        let place = place.filter(|place| model.v_range(own[*place]).len() == 1);
        place.ok_or_else(|| {
            let help = suggest(joint, own.iter().map(|j| model.joint_names()[*j].as_str()).collect::<Vec<_>>());
            Unmade::Motion(format!("no joint of one degree with a coordinate of its own is called \"{joint}\"; {help}"))
        })
    };
    match &system.motion {
        Motion::Forward(forward) => {
            let mut forward = (**forward).clone();
            for (joint, signal) in motions {
                let (place, jet) = (find(&joint)?, signal.at(0.0));
                forward.q[model.q_range(own[place]).start] = jet.value;
                forward.v[model.v_range(own[place]).start] = jet.first;
                forward.drives[place] = Drive::Prescribed(JointPath::Coordinate(signal));
            }
            system.motion = forward.into();
        }
        Motion::Given(trajectory) => {
            let Trajectory::Prescribed(paths) = &**trajectory else {
                let why = "motions replace those of joints, and this scenario follows a gripper path";
                return Err(Unmade::Motion(why.to_owned()));
            };
            let mut paths = paths.clone();
            for (joint, signal) in motions {
                paths[find(&joint)?] = JointPath::Coordinate(signal);
            }
            system.motion = Trajectory::Prescribed(paths).into();
        }
    }
    // What rests where it starts does so at the new start.
    if plan.elements.iter().any(|plan| plan.rest_at_start) {
        let starts = system.element_starts().map_err(Unmade::Run)?;
        for ((element, start), plan) in system.elements.iter_mut().zip(starts).zip(&plan.elements) {
            if plan.rest_at_start {
                element.rest = start.length;
            }
        }
    }
    Ok(())
}
