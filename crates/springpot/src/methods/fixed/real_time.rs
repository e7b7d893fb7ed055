//! A robot with its elements in a controller's loop.

use super::control::{LoopControl, LoopControlState};
use super::step::OneStage;
use crate::dynamics::{kinetic_energy, potential_energy};
use crate::elements::{BankState, ElementBank, MemoryRange};
use crate::equations::context::{Context, Held};
use crate::fractional::Form;
use crate::law::{Course, InputValue, Point};
use crate::system::definite::Definite;
use crate::system::error::RunError;
use crate::system::fixed_step::Method;
use crate::system::row_times::multiple;
use crate::system::{Motion, System};
use serde::{Deserialize, Serialize};

/// How the memories of the elements are built.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MemorySettings {
    /// Relative error of the kernels, 1e-13 … 0.1; 1e-6 is far below the error of a step and takes some 30 exponentials.
    pub tolerance: f64,
    /// The longest past that is remembered to that tolerance, s; what is older fades too early. The price grows with its logarithm.
    pub horizon: f64,
}

/// Why there is no [`Loop`].
#[derive(Debug, thiserror::Error)]
pub enum LoopError {
    /// The step is not a positive number.
    #[error("the step must be positive and finite, not {0} s")]
    Step(f64),
    /// The motion is given in advance.
    #[error("the robot must move by itself (forward dynamics); its motion is given in advance")]
    MotionGiven,
    /// A named offline scheme needs the whole motion.
    #[error("element \"{element}\" has a named scheme, which works on complete motions alone")]
    Scheme {
        /// Element.
        element: String,
    },
    /// The start is no state that a run can start from.
    #[error(transparent)]
    Run(#[from] RunError),
}

/// Forward dynamics of a robot with its elements, step by step, at t = 0, h, 2h, …
///
/// [`Loop::advance`] does not allocate (unless it fails), and its work is the same in every step: a fixed number of Newton
/// iterations and a constant number of exponentials; where friction sticks, a few pivots in every iteration. Signals of the motion (actuator forces, prescribed joints) and inputs of
/// the elements act as the [`System`] says, at the stage of the method; the torques that are handed over come on top. What controls the system acts
/// at its samples, or where it has none at the start of every step, and holds in between. Kinks of signals and break points are stepped over.
///
/// ```
/// use springpot::law::Catalog;
/// use springpot_scenario::Scenario;
/// use springpot::methods::fixed::{Loop, MemorySettings, Method};
///
/// let text = r#"
/// robot.body = [{ name = "arm", joint = { name = "q1", kind = "revolute", axis = [0, 1, 0] }, mass = 1, com = [0.2, 0, 0] }]
/// motion = { kind = "forward" }
/// time = { end = "1 s", output_step = "10 ms" }
/// [[element]]
/// name = "strut"
/// from = { body = "world", point = [0, 0, -0.3] }
/// to = { body = "arm", point = [0.3, 0, 0] }
/// rest_length = "42 cm"
/// law = "springpot"
/// parameters = { c = "50 N*s^alpha/m", alpha = 0.4 }
/// "#;
/// let cases = Scenario::parse(text, "arm.toml", "")?.cases(&Catalog::standard())?;
/// let system = cases.plan(0)?.system();
/// let memory = MemorySettings { tolerance: 1e-6, horizon: 60.0 };
/// let mut arm = Loop::new(&system, Method::BackwardEuler, 1e-3, memory)?;
/// for _ in 0..2000 {
///     // A proportional–derivative controller that holds the arm level.
///     let torque = -100.0 * arm.q()[0] - 5.0 * arm.v()[0];
///     arm.advance(&[torque])?;
/// }
/// assert_eq!(arm.t(), 2.0);
/// assert!(arm.v()[0].abs() < 0.01 && arm.q()[0].abs() < 0.02);
/// assert!(arm.force(0).is_finite());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Loop<'a> {
    system: &'a System,
    held: Held,
    stage: OneStage,
    bank: ElementBank,
    control: Option<LoopControl>,
    definite: Option<Definite>,
    step: f64,
    steps: u64,
}

/// The state of a [`Loop`] between two steps, memories, samples and what is held included. It belongs to the system, method, step and memories
/// that it was taken from, and what goes on from it does so to the bit, in any process on the same machine.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct LoopState {
    steps: u64,
    q: Vec<f64>,
    v: Vec<f64>,
    a: Vec<f64>,
    held: Held,
    bank: BankState,
    /// What the bank was told of the inputs at the stage of the last step.
    inputs: Vec<Vec<InputValue>>,
    control: Option<LoopControlState>,
}

impl<'a> Loop<'a> {
    /// At t = 0, where the motion of `system` starts, with empty memories; `step` in s.
    ///
    /// # Errors
    /// [`LoopError`].
    pub fn new(system: &'a System, method: Method, step: f64, memory: MemorySettings) -> Result<Self, LoopError> {
        if !(step > 0.0 && step.is_finite()) {
            return Err(LoopError::Step(step));
        }
        let Motion::Forward(forward) = &system.motion else { return Err(LoopError::MotionGiven) };
        let mut held = Held::default();
        held.torques_mut(system.model.nv());
        let stage = OneStage::new(Context { system, held: &held, sampled: Held::NONE }, forward, method)?;
        let mut control = LoopControl::of(system, step, &stage, memory)?;
        let first = control.as_mut().map(|control| control.first(system, &stage)).transpose()?;
        let cx = Context { system, held: &held, sampled: first.as_deref().unwrap_or(Held::NONE) };
        system.check_definite(&stage.origin.q)?;
        let laws = system.elements.iter().map(|element| element.law.clone()).collect();
        let mut bank = ElementBank::new(laws, method.nodes(), Form::Strokes);
        bank.set_course(Course::Sought);
        let range = MemoryRange { tolerance: memory.tolerance, shortest: step, horizon: memory.horizon };
        for (e, element) in system.elements.iter().enumerate() {
            if element.scheme.is_some() {
                return Err(LoopError::Scheme { element: element.name.clone() });
            }
            let mut inputs = vec![Default::default(); element.inputs.len()];
            cx.inputs_at(e, 0.0, &mut inputs);
            element.check_inputs(0.0, &inputs)?;
            let [coordinate, _] = stage.equations.read(e);
            let mut is_known = Ok(());
            let begun = element.begin_within(coordinate, &inputs, memory.tolerance, memory.horizon).and_then(|state| {
                is_known = element.check_start(&state);
                bank.begin_from(e, &element.start(coordinate, &inputs), state);
                bank.open_element(e, element.memory_range(range, &inputs))
            });
            begun.map_err(RunError::of_kernel(&element.name))?;
            is_known?;
        }
        // Here and not in the first step, so that none allocates.
        let node = stage.stage_time(multiple(1, step), step);
        stage.equations.begin(cx, &mut bank, [0.0, node], step)?;
        Ok(Self { system, held, stage, bank, control, definite: Definite::of(&system.model), step, steps: 0 })
    }

    /// Goes one step on. `torque` holds an actuator force for each velocity (nv), N·m or N, held over the step; those of prescribed and
    /// locked joints count for nothing.
    ///
    /// # Errors
    /// [`RunError`] where a torque or signal is not finite, an input breaks a rule of its law, an element has no direction, an
    /// accepted inertia leaves the mass matrix indefinite, or the step is too long for a finite motion. The robot then stays where it was and may be advanced with another torque. Panics where
    /// `torque` is too short.
    pub fn advance(&mut self, torque: &[f64]) -> Result<(), RunError> {
        let to = multiple(self.steps + 1, self.step);
        let nv = self.system.model.nv();
        self.held.torques_mut(nv).copy_from_slice(&torque[..nv]);
        if let Some(control) = &mut self.control {
            control.take(self.system, &self.stage, &self.bank)?;
        }
        let sampled = self.control.as_ref().map_or(Held::NONE, LoopControl::acting);
        let cx = Context { system: self.system, held: &self.held, sampled };
        self.stage.attempt(cx, &mut self.bank, to, self.step)?;
        if let Some(definite) = &mut self.definite {
            let (origin, end) = (&self.stage.origin, &self.stage.end);
            definite.check_way(&self.system.model, [origin.t, to], [&origin.q, &end.q])?;
        }
        if let Some(control) = &mut self.control {
            control.commit(self.system, &self.stage)?;
        }
        self.bank.commit();
        self.stage.accept();
        self.steps += 1;
        Ok(())
    }

    /// Holds an input of an element at `value` (SI) from the next step on, whatever its signal says; `None` gives it back to its
    /// signal. Element and input are indices in the order of the system and of the law.
    ///
    /// # Errors
    /// [`RunError::NoInput`] where there is no such element or input.
    pub fn hold_input(&mut self, element: usize, input: usize, value: Option<f64>) -> Result<(), RunError> {
        let held = self.held.hold_input(self.system, element, input, value);
        held.ok_or(RunError::NoInput { element, input })
    }

    /// What it takes to go on from here.
    pub fn state(&self) -> LoopState {
        let Self { stage, bank, .. } = self;
        LoopState {
            steps: self.steps,
            q: stage.origin.q.clone(),
            v: stage.origin.v.clone(),
            a: stage.a.clone(),
            held: self.held.clone(),
            bank: bank.state(),
            inputs: (0..bank.len()).map(|e| bank.point(e, 1).inputs.to_vec()).collect(),
            control: self.control.as_ref().map(LoopControl::state),
        }
    }

    /// Goes on from a state of a loop of the same system, method, step and memories, later or earlier. What [`Self::force`], [`Self::correction`]
    /// and [`Self::kinetic_energy`] tell of the last step they tell again behind the next one.
    ///
    /// # Errors
    /// [`RunError::OtherRun`] where it is of another system.
    pub fn set_state(&mut self, state: &LoopState) -> Result<(), RunError> {
        let LoopState { steps, q, v, a, held, bank, inputs, control } = state.clone();
        let Self { system, stage, .. } = self;
        let fits = [q.len(), v.len(), a.len()] == [stage.origin.q.len(), stage.origin.v.len(), stage.a.len()];
        let inputs_fit = inputs.iter().map(Vec::len).eq(system.elements.iter().map(|element| element.inputs.len()));
        let controls = match (&mut self.control, control) {
            (None, None) => true,
            (Some(own), Some(state)) if fits && inputs_fit => own.go_on(state),
            _ => false,
        };
        if !(fits && inputs_fit && controls && self.bank.set_state(bank)) {
            return Err(RunError::OtherRun);
        }
        (self.steps, self.held) = (steps, held);
        for (e, values) in inputs.iter().enumerate() {
            self.bank.inputs_mut(e, 1).copy_from_slice(values);
        }
        stage.a = a;
        let sampled = self.control.as_ref().map_or(Held::NONE, LoopControl::acting);
        stage.go_on(Context { system, held: &self.held, sampled }, multiple(steps, self.step), &q, &v);
        Ok(())
    }

    /// Time, s.
    pub fn t(&self) -> f64 {
        self.stage.origin.t
    }

    /// Coordinates, nq values.
    pub fn q(&self) -> &[f64] {
        &self.stage.origin.q
    }

    /// Velocities, nv values.
    pub fn v(&self) -> &[f64] {
        &self.stage.origin.v
    }

    /// Accelerations of the last step, nv values: those at its end with backward Euler's method, their mean with the midpoint rule.
    /// Before the first step those of prescribed joints alone.
    pub fn a(&self) -> &[f64] {
        &self.stage.a
    }

    /// Force of an element, N (N·m where it acts on an angle), positive in tension, as the last step took it: at its end
    /// with backward Euler's method, its mean with the midpoint rule; 0 before the first step.
    pub fn force(&self, element: usize) -> f64 {
        self.bank.response(element).force[0]
    }

    /// Length of an element, m, or the coordinate of the joint that it acts on, m or rad.
    pub fn length(&self, element: usize) -> f64 {
        self.stage.equations.read(element)[0]
    }

    /// Stroke of an element, m or rad: what its length or coordinate has more than at rest.
    pub fn stroke(&self, element: usize) -> f64 {
        self.system.elements[element].stroke(self.length(element))
    }

    /// Rate of an element's stroke, m/s or rad/s.
    pub fn rate(&self, element: usize) -> f64 {
        self.stage.equations.read(element)[1]
    }

    /// Kinetic energy, J.
    pub fn kinetic_energy(&self) -> f64 {
        kinetic_energy(&self.system.model, &self.stage.origin.kinematics)
    }

    /// Potential energy in the field of gravity, J, 0 at the world's origin.
    pub fn potential_energy(&self) -> f64 {
        potential_energy(&self.system.model, &self.stage.origin.kinematics)
    }

    /// Energy stored in an element, J; `None` after a singular start, where it is unknown.
    pub fn stored_energy(&self, element: usize) -> Option<f64> {
        let inputs = self.bank.point(element, 1).inputs;
        let point = Point { t: self.t(), stroke: self.stroke(element), rate: self.rate(element), inputs };
        self.bank.now(element, &point)?.stored
    }

    /// Largest change of a velocity, in its unit, that the last Newton iteration of the last step made at its stage: how far the fixed
    /// number of iterations was from converging. 0 before the first step.
    pub fn correction(&self) -> f64 {
        self.stage.correction
    }

    /// Number of exponentials in all memories; it never changes.
    pub fn modes(&self) -> usize {
        self.bank.modes()
    }

    /// The method.
    pub fn method(&self) -> Method {
        self.stage.method
    }

    /// Step size, s.
    pub fn step(&self) -> f64 {
        self.step
    }
}
