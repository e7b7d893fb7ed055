//! A run that somebody else drives, step by step.

use super::events::{Next, Watch, WatchState};
use super::report::Report;
use super::state::SimulationState;
use super::time_loop::Driver;

use crate::collocation::STAGES;
use crate::equations::Variation;
use crate::equations::context::Context;
use crate::equations::evaluate::Evaluation;
use crate::observe::Quantity;
use crate::observe::Snapshot;
use crate::system::error::RunError;
use crate::system::row_times::RowTimes;
use crate::system::sensitivity::{Lost, SensitivityError};
use crate::system::settings::{Settings, Stop};
use crate::system::{Event, System};
use std::sync::Arc;

/// A system on its way, driven step by step by whoever owns it: a controller, another engine, a notebook.
///
/// The steps are those of [`super::run`]: chosen for the tolerance, or of one size where [`Settings::fixed_step`] says so. [`Self::step`] takes
/// the next one, [`Self::step_to`] as many as it takes to be at a time, [`Self::interpolate`] looks into the last one. Torques and inputs may be
/// held from outside between any two of them. The memories of the elements are part of it: [`Self::state`] has all that it takes to go on to the
/// bit, in this simulation or in another one of the same system and settings.
///
/// ```
/// use springpot::Simulation;
/// use springpot::law::Catalog;
/// use springpot_scenario::Scenario;
///
/// let text = r#"
/// robot.body = [{ name = "arm", joint = { name = "q1", kind = "revolute", axis = [0, 1, 0] }, mass = 1, com = [0.2, 0, 0] }]
/// motion = { kind = "forward" }
/// time = { end = "2 s", output_step = "10 ms" }
/// [[element]]
/// name = "strut"
/// from = { body = "world", point = [0, 0, -0.3] }
/// to = { body = "arm", point = [0.3, 0, 0] }
/// rest_length = "42 cm"
/// law = "springpot"
/// parameters = { c = "50 N*s^alpha/m", alpha = 0.4 }
/// "#;
/// let plan = Scenario::parse(text, "arm.toml", "")?.cases(&Catalog::standard())?.plan(0)?;
/// let mut arm = Simulation::new(plan.system(), plan.settings)?;
/// // A proportional-derivative controller that holds the arm level, sampled at 100 Hz.
/// for sample in 1..=200 {
///     arm.set_torque(0, -100.0 * arm.q()[0] - 5.0 * arm.v()[0])?;
///     arm.step_to(f64::from(sample) / 100.0)?;
/// }
/// assert_eq!(arm.t(), 2.0);
/// assert!(arm.v()[0].abs() < 0.01 && arm.q()[0].abs() < 0.02);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Simulation {
    system: Arc<System>,
    driver: Driver,
    events: Watch,
    samples: Option<RowTimes>,
    /// Number of the next sample.
    sample: usize,
}

impl Simulation {
    /// A system at t = 0; of the `settings` all but the rows count.
    ///
    /// # Errors
    /// [`RunError`] that keeps a run from starting: of its settings, its signals, its elements. An element with a named scheme is refused, which
    /// works on complete motions alone.
    pub fn new(system: impl Into<Arc<System>>, settings: Settings) -> Result<Self, RunError> {
        Self::begun(system.into(), settings, Driver::new)
    }

    /// One that tells its start and takes no step: its memories have no kernels.
    pub(super) fn at_start(system: impl Into<Arc<System>>, settings: Settings) -> Result<Self, RunError> {
        Self::begun(system.into(), settings, Driver::at_start)
    }

    fn begun(
        system: Arc<System>,
        settings: Settings,
        begin: impl FnOnce(Context, &Settings, &Stop, fn(&Driver)) -> Result<Driver, RunError>,
    ) -> Result<Self, RunError> {
        system.refuse_schemes()?;
        let stop = Stop::new(false);
        let mut driver = begin(system.context(), &settings, &stop, |_| {})?;
        let mut events = Watch::new(&system, &settings, WatchState::default(), &stop)?;
        events.start(&system, &mut driver)?;
        Ok(Self { system, driver, events, samples: None, sample: 0 })
    }

    /// Takes one step, which ends at the next sample at the latest: `false`, and nothing done, where the end is reached.
    ///
    /// # Errors
    /// [`RunError`] where no step leads on. The simulation is then where it was and may go on from another [`Self::set_state`].
    pub fn step(&mut self) -> Result<bool, RunError> {
        self.step_until(f64::INFINITY)
    }

    /// As [`Self::step`], but the step ends at `until`, s, at the latest; none is taken where that is reached already.
    ///
    /// # Errors
    /// As there.
    pub fn step_until(&mut self, until: f64) -> Result<bool, RunError> {
        self.step_until_unless(until, &mut || false)
    }

    /// As [`Self::step_until`], but before every try of a step `pauses` is asked whether it is to be left for now.
    ///
    /// # Errors
    /// As there, and [`RunError::Interrupted`]: asked again it goes on as if it had not been.
    pub fn step_until_unless(&mut self, until: f64, pauses: &mut dyn FnMut() -> bool) -> Result<bool, RunError> {
        if self.driver.is_recorded() {
            return Err(SensitivityError::Backwards { what: "a run that is driven step by step".into() }.into());
        }
        let before = self.driver.steps();
        // What changes at the start of a step is crossed first, and so is what an event does at the end of the last one.
        while self.driver.steps() == before {
            if self.happen()? {
                return Ok(false);
            }
            while self.cross()? {
                if self.happen()? {
                    return Ok(false);
                }
                if pauses() {
                    return Err(RunError::Interrupted { t: self.driver.reached() });
                }
            }
            if self.driver.has_ended() {
                return Ok(false);
            }
            let t = self.driver.reached();
            // What was crossed may have been the way that was left.
            if t >= until {
                return Ok(true);
            }
            let sample = self.samples.as_ref().and_then(|times| {
                while self.sample < times.count() && times.at(self.sample) <= t {
                    self.sample += 1;
                }
                (self.sample < times.count()).then(|| times.at(self.sample))
            });
            let (until, mark) = (sample.map_or(until, |sample| sample.min(until)), self.driver.mark());
            self.driver.advance(self.events.cx(&self.system), until, None, pauses)?;
            self.events.look(&self.system, &mut self.driver, mark, None)?;
        }
        Ok(true)
    }

    /// Takes the step at hand into the past, or crosses what is behind it, where events may pass as well: `true` where something was crossed.
    fn cross(&mut self) -> Result<bool, RunError> {
        let crossed = self.driver.settle(self.events.cx(&self.system))?;
        if crossed {
            self.events.look_now(&self.system, &mut self.driver)?;
        }
        Ok(crossed)
    }

    /// Does what events do at the present time: `true` where one of them ends it.
    fn happen(&mut self) -> Result<bool, RunError> {
        if self.events.has_stopped() {
            return Ok(true);
        }
        Ok(self.events.happen(&self.system, &mut self.driver, &mut |_, _, _, _| Ok(()))? == Next::Stops)
    }

    /// The event that ended it at [`Self::t`].
    pub fn stopped_by(&self) -> Option<&Event> {
        self.events.stopped(&self.system).map(|event| &self.system.events[event])
    }

    /// The events of the last step, in their order, and when they happened, s.
    pub fn passed(&self) -> impl Iterator<Item = (&Event, f64)> {
        self.events.passed().map(|(event, t)| (&self.system.events[event], t))
    }

    /// Takes steps until the time is t, s, where the last one ends, or until an event ends it.
    ///
    /// # Errors
    /// [`RunError::Outside`] where t is before the present time or beyond the end, and those of [`Self::step`].
    pub fn step_to(&mut self, t: f64) -> Result<(), RunError> {
        self.check_time(t, self.t(), self.end())?;
        while self.t() < t && self.step_until(t)? {}
        Ok(())
    }

    /// Ends steps at these times from now on, as controllers with a sample time ask for; `None`: at none.
    pub fn sample_at(&mut self, times: Option<RowTimes>) {
        (self.samples, self.sample) = (times, 0);
    }

    /// Time, s.
    pub fn t(&self) -> f64 {
        self.driver.reached()
    }

    /// Where the motion ends, s.
    pub fn end(&self) -> f64 {
        self.driver.recorder.settings.end
    }

    /// Where the last step began, s: the earliest time of [`Self::interpolate`].
    pub fn t_before(&self) -> f64 {
        self.driver.step_at_hand().map_or(self.t(), |step| step.from)
    }

    /// Coordinates, nq values.
    pub fn q(&self) -> &[f64] {
        &self.present().q
    }

    /// Velocities, nv values.
    pub fn v(&self) -> &[f64] {
        &self.present().v
    }

    fn present(&self) -> &Evaluation {
        let at = if self.driver.step_at_hand().is_some() { STAGES } else { 0 };
        &self.driver.recorder.evaluations[at]
    }

    /// All that is known at the present time: what a step led to, or after [`Self::set_torque`] and [`Self::set_input`] what they make of it.
    ///
    /// # Errors
    /// [`RunError`] where an input breaks a rule of its law.
    pub fn snapshot(&mut self) -> Result<Snapshot, RunError> {
        self.interpolate(self.t())
    }

    /// The derivative of a quantity at a time of the last step by each parameter of [`System::sensitivity`]; NaN where it is unknown.
    ///
    /// # Errors
    /// As of [`Self::interpolate`].
    pub fn derivatives(&mut self, t: f64, quantity: Quantity) -> Result<Vec<f64>, RunError> {
        let mut snapshot = Snapshot::new(&self.system);
        self.check_time(t, self.t_before(), self.t())?;
        while self.driver.is_disturbed() {
            self.cross()?;
        }
        let theta = self.driver.read(self.events.cx(&self.system), t, 0, &mut snapshot)?;
        let variation = self.driver.vary(theta, &snapshot, Variation::is_of_motion(&self.system.model, quantity));
        let unknown = |all: &Variation| vec![f64::NAN; all.count()];
        Ok(variation.map_or_else(Vec::new, |all| all.values(quantity, &snapshot).unwrap_or_else(|| unknown(all))))
    }

    /// By which parameters of [`System::sensitivity`] derivatives have ended, and where.
    pub fn lost(&self) -> impl Iterator<Item = &Lost> {
        self.driver.lost()
    }

    /// The derivatives of q and v at the present time by the parameters of [`System::sensitivity`]: nq × P and nv × P, row by row; empty where there
    /// are none. Torques and inputs that are held from outside stay what they are.
    ///
    /// # Errors
    /// As of [`Self::interpolate`].
    pub fn tangents(&mut self) -> Result<[Vec<f64>; 2], RunError> {
        let mut snapshot = Snapshot::new(&self.system);
        while self.driver.is_disturbed() {
            self.cross()?;
        }
        let t = self.t();
        let theta = self.driver.read(self.events.cx(&self.system), t, 0, &mut snapshot)?;
        let (nq, nv) = (self.system.model.nq(), self.system.model.nv());
        let of_motion = self.system.model.is_one_degree();
        let Some(variation) = self.driver.vary(theta, &snapshot, of_motion) else { return Ok(Default::default()) };
        let all = |count: usize, of: fn(usize) -> Quantity| {
            let unknown = || vec![f64::NAN; variation.count()];
            (0..count).flat_map(|k| variation.values(of(k), &snapshot).unwrap_or_else(unknown)).collect()
        };
        Ok([all(nq, Quantity::Coordinate), all(nv, Quantity::Velocity)])
    }

    /// All that is known at a time of the last step, from [`Self::t_before`] to [`Self::t`].
    ///
    /// # Errors
    /// [`RunError::Outside`], and where an input breaks a rule of its law.
    pub fn interpolate(&mut self, t: f64) -> Result<Snapshot, RunError> {
        let mut snapshot = Snapshot::new(&self.system);
        self.interpolate_into(t, &mut snapshot)?;
        Ok(snapshot)
    }

    /// [`Self::interpolate`] into a snapshot of this system.
    ///
    /// # Errors
    /// As there.
    pub fn interpolate_into(&mut self, t: f64, snapshot: &mut Snapshot) -> Result<(), RunError> {
        self.check_time(t, self.t_before(), self.t())?;
        while self.driver.is_disturbed() {
            self.cross()?;
        }
        self.driver.show(self.events.cx(&self.system), t, 0, snapshot)?;
        Ok(())
    }

    fn check_time(&self, t: f64, from: f64, to: f64) -> Result<(), RunError> {
        if from <= t && t <= to { Ok(()) } else { Err(RunError::Outside { t, from, to }) }
    }

    /// Holds a torque (or force) on a velocity from now on, on top of what the motion's signals say, N·m or N.
    ///
    /// # Errors
    /// [`RunError::NotDriven`] where no force drives that velocity, [`RunError::NotFinite`].
    pub fn set_torque(&mut self, velocity: usize, torque: f64) -> Result<(), RunError> {
        let (model, t) = (&self.system.model, self.t());
        if !self.system.driven_velocities().contains(&velocity) {
            return Err(RunError::NotDriven { velocity });
        }
        if !torque.is_finite() {
            let what = format!("tau.{}", model.v_labels()[velocity].name);
            return Err(RunError::NotFinite { t, what, value: torque });
        }
        let nv = model.nv();
        if self.events.cx(&self.system).torque(velocity) != torque {
            self.disturb()?;
            self.events.held_mut().torques_mut(nv)[velocity] = torque;
        }
        Ok(())
    }

    /// Holds an input of an element at a value from now on, SI, whatever its signal says; `None` gives it back to its signal.
    ///
    /// # Errors
    /// [`RunError::NoInput`] where there is no such element or input, [`RunError::InputRange`], [`RunError::Rule`] and [`RunError::NotFinite`]
    /// where the law does not take the value.
    pub fn set_input(&mut self, element: usize, input: usize, value: Option<f64>) -> Result<(), RunError> {
        self.happen()?;
        let mut held = self.events.held_mut().clone();
        held.hold_input(&self.system, element, input, value).ok_or(RunError::NoInput { element, input })?;
        let t = self.t();
        let of = &self.system.elements[element];
        let mut values = vec![Default::default(); of.inputs.len()];
        Context { held: &held, ..self.system.context() }.inputs_at(element, t, &mut values);
        of.check_inputs(t, &values)?;
        if held != *self.events.held_mut() {
            self.disturb()?;
            *self.events.held_mut() = held;
            self.driver.hold_input([element, input], value.is_some());
        }
        Ok(())
    }

    fn disturb(&mut self) -> Result<(), RunError> {
        self.happen()?;
        self.driver.disturb(self.events.cx(&self.system))
    }

    /// What it takes to go on from here, to the bit. The last step is in the past then and can no longer be looked into.
    ///
    /// # Errors
    /// [`RunError::Chatter`] where nothing follows.
    pub fn state(&mut self) -> Result<SimulationState, RunError> {
        self.happen()?;
        let cx = self.events.cx(&self.system);
        self.driver.close(cx)?;
        Ok(SimulationState { driver: self.driver.state(cx), events: self.events.state().clone() })
    }

    /// Goes on from a state of the same system and settings, later or earlier.
    ///
    /// # Errors
    /// [`RunError::OtherRun`] where it is of another system; nothing is changed then.
    pub fn set_state(&mut self, state: &SimulationState) -> Result<(), RunError> {
        let SimulationState { driver, events } = state.clone();
        self.driver.go_on(events.cx(&self.system), driver)?;
        self.events.go_on(events);
        self.sample = 0;
        Ok(())
    }

    /// The system.
    pub fn system(&self) -> &System {
        &self.system
    }

    /// Steps taken so far, and tried and not kept.
    pub fn report(&self) -> Report {
        self.driver.report()
    }
}
