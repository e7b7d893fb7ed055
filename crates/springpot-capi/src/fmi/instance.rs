//! One instance of an FMU: a simulation, and the modes of the standard around it.

use super::build::{Live, Setup};
use super::checkpoint::Checkpoint;
use super::mode::Mode;
use super::resources::Resources;
use super::variables::{Role, Variable};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Times of a master and of the simulation that differ by less than this share are one: masters add up their steps.
const SAME_TIME: f64 = 1e-9;

/// Why a call was refused. Nothing was done.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Fault {
    /// In words.
    #[error("{0}")]
    Error(String),
    /// The step leads beyond the end of the scenario, or beyond an event that ends it.
    #[error("{0}")]
    Discard(String),
}

impl From<String> for Fault {
    fn from(message: String) -> Self {
        Self::Error(message)
    }
}

/// An instance.
#[derive(Debug)]
pub struct Instance {
    resources: Arc<Resources>,
    mode: Mode,
    setup: Setup,
    /// By value reference: forces that are added, N·m or N.
    torques: BTreeMap<u32, f64>,
    /// Inputs of elements that were set since the start.
    held: BTreeSet<u32>,
    /// A step was to lead beyond the end, or beyond an event that ends it.
    has_ended: bool,
    live: Option<Live>,
}

impl Instance {
    /// An instance of these resources.
    pub fn new(resources: Arc<Resources>) -> Self {
        let (setup, torques, held) = (Setup::default(), BTreeMap::new(), BTreeSet::new());
        Self { resources, mode: Mode::Instantiated, setup, torques, held, has_ended: false, live: None }
    }

    /// Where it is in its life.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// Time of the present communication point, s.
    pub fn t(&self) -> f64 {
        self.live.as_ref().map_or(0.0, |live| live.simulation.t())
    }

    /// Whether a step was to lead beyond the end of the scenario, or beyond an event that ends it.
    pub fn has_ended(&self) -> bool {
        self.has_ended
    }

    fn must_be(&self, what: &str, modes: &[Mode]) -> Result<(), Fault> {
        match modes.contains(&self.mode) {
            true => Ok(()),
            false => Err(format!("{what} has no place here: the instance is {}", words(self.mode)).into()),
        }
    }

    /// Says when the experiment starts and ends, s, and how exact it is to be.
    ///
    /// # Errors
    /// Where it does not start at 0, or ends before.
    pub fn set_up(&mut self, start: f64, stop: Option<f64>, tolerance: Option<f64>) -> Result<(), Fault> {
        self.must_be("fmi2SetupExperiment", &[Mode::Instantiated])?;
        if start != 0.0 {
            return Err(format!("the start time is {start} s: memories begin at 0, so that it must be 0").into());
        }
        if let Some(stop) = stop.filter(|stop| !(*stop > 0.0 && stop.is_finite())) {
            return Err(format!("the stop time is {stop} s: it must be after the start").into());
        }
        if let Some(tolerance) = tolerance.filter(|tolerance| !(*tolerance > 0.0 && tolerance.is_finite())) {
            return Err(format!("the tolerance is {tolerance}: it must be positive").into());
        }
        self.setup.end = stop;
        // Steps of one size have no tolerance.
        let is_rtol = |variable: &Variable| variable.place().is_some_and(|(path, _)| path == "solver.rtol");
        let rtol = self.resources.variables().iter().position(is_rtol);
        if let Some((reference, tolerance)) = rtol.zip(tolerance) {
            self.setup.changes.insert(reference as u32, tolerance);
        }
        self.live = None;
        Ok(())
    }

    /// Begins the initialization.
    ///
    /// # Errors
    /// Where it is not the time for it.
    pub fn enter_initialization(&mut self) -> Result<(), Fault> {
        self.must_be("fmi2EnterInitializationMode", &[Mode::Instantiated])?;
        self.mode = Mode::Initialization;
        Ok(())
    }

    /// Ends the initialization at t = 0.
    ///
    /// # Errors
    /// Where the scenario does not take what was set, or cannot start.
    pub fn exit_initialization(&mut self) -> Result<(), Fault> {
        self.must_be("fmi2ExitInitializationMode", &[Mode::Initialization])?;
        self.live()?;
        self.mode = Mode::Stepping;
        Ok(())
    }

    /// The simulation, built where it is not yet.
    fn live(&mut self) -> Result<&mut Live, Fault> {
        if self.live.is_none() {
            let mut live = Live::new(&self.resources, &self.setup)?;
            for (reference, torque) in &self.torques {
                if let Some(Role::Torque { velocity }) = self.role(*reference) {
                    live.changed().set_torque(*velocity, *torque).map_err(|error| error.to_string())?;
                }
            }
            self.live = Some(live);
        }
        self.live.as_mut().ok_or_else(|| Fault::Error("the simulation is missing".to_owned()))
    }

    fn role(&self, reference: u32) -> Option<&Role> {
        self.resources.variables().get(reference as usize).map(|variable| &variable.role)
    }

    fn known(&self, reference: u32) -> Result<&Variable, Fault> {
        let variables = self.resources.variables();
        let unknown = || format!("there is no real variable {reference}: there are {}, from 0", variables.len());
        variables.get(reference as usize).ok_or_else(|| unknown().into())
    }

    /// The value of a variable.
    ///
    /// # Errors
    /// Where there is no such variable, or no value before the initialization.
    pub fn get(&mut self, reference: u32) -> Result<f64, Fault> {
        let Variable { name, role, .. } = self.known(reference)?;
        let set = self.setup.changes.get(&reference).copied();
        match role {
            _ if self.mode == Mode::Failed && self.live.is_none() => {
                return Err(format!("{name} is lost with the instance").into());
            }
            Role::Time => return Ok(self.t()),
            Role::Torque { .. } => return Ok(self.torques.get(&reference).copied().unwrap_or(0.0)),
            Role::Parameter { start, .. } => return Ok(set.unwrap_or(*start)),
            Role::Input { start, .. } if self.live.is_none() => return Ok(set.unwrap_or(*start)),
            Role::Output { .. } if self.mode == Mode::Instantiated => {
                return Err(format!("{name} has no value before fmi2EnterInitializationMode").into());
            }
            Role::Input { .. } | Role::Output { .. } => {}
        }
        Ok(self.live()?.value(reference as usize)?.unwrap_or(f64::NAN))
    }

    /// Sets an input or a parameter.
    ///
    /// # Errors
    /// Where it cannot be set, now or ever, or the law does not take the value.
    pub fn set(&mut self, reference: u32, value: f64) -> Result<(), Fault> {
        let (mode, variable) = (self.mode, self.known(reference)?);
        let name = &variable.name;
        if !value.is_finite() {
            return Err(format!("{name} cannot be set to {value}").into());
        }
        let before = matches!(mode, Mode::Instantiated | Mode::Initialization);
        match variable.role {
            Role::Time | Role::Output { .. } => Err(format!("{name} is no input and no parameter").into()),
            _ if !before && mode != Mode::Stepping => {
                Err(format!("{name} cannot be set: the instance is {}", words(mode)).into())
            }
            Role::Parameter { .. } | Role::Input { .. } if before => {
                self.setup.changes.insert(reference, value);
                self.live = None;
                Ok(())
            }
            Role::Parameter { .. } => Err(format!("{name} is fixed after the initialization").into()),
            Role::Torque { velocity } => {
                if let Some(live) = &mut self.live {
                    live.changed().set_torque(velocity, value).map_err(|error| error.to_string())?;
                }
                self.torques.insert(reference, value);
                Ok(())
            }
            // The same as at the start, which is what the scenario says now.
            Role::Input { .. }
                if !self.held.contains(&reference) && self.setup.changes.get(&reference) == Some(&value) =>
            {
                Ok(())
            }
            Role::Input { element, input, .. } => {
                let simulation = self.live()?.changed();
                simulation.set_input(element, input, Some(value)).map_err(|error| error.to_string())?;
                self.held.insert(reference);
                Ok(())
            }
        }
    }

    /// Goes from a communication point to the next one, s.
    ///
    /// # Errors
    /// [`Fault::Discard`] where that is beyond the end, which is left as it is, or beyond an event that ends it, where it then is. Where no step leads on, the instance has [`Mode::Failed`].
    pub fn do_step(&mut self, point: f64, size: f64) -> Result<(), Fault> {
        self.must_be("fmi2DoStep", &[Mode::Stepping])?;
        let live = self.live()?;
        let (t, end) = (live.simulation.t(), live.simulation.end());
        if !(size > 0.0 && size.is_finite()) {
            return Err(format!("a communication step of {size} s: it must be positive").into());
        }
        let is_here = (point - t).abs() <= SAME_TIME * (t + size);
        if !is_here {
            return Err(format!("the communication point is {point} s, but the instance is at {t} s").into());
        }
        let mut target = point + size;
        if target > end && target - end <= SAME_TIME * (end + size) {
            target = end;
        }
        if target > end {
            self.has_ended = true;
            let message = format!("a step to {target} s leads beyond the end at {end} s: say a later stop time");
            return Err(Fault::Discard(message));
        }
        // A step that rounding takes away is done.
        if target <= t {
            return Ok(());
        }
        let simulation = live.changed();
        match simulation.step_to(target) {
            Err(error) => {
                self.mode = Mode::Failed;
                Err(Fault::Error(error.to_string()))
            }
            Ok(()) => match simulation.stopped_by().filter(|_| simulation.t() < target) {
                None => Ok(()),
                Some(event) => {
                    let message = format!("event {:?} ends the simulation at {} s", event.name, simulation.t());
                    self.has_ended = true;
                    Err(Fault::Discard(message))
                }
            },
        }
    }

    /// Ends the simulation.
    ///
    /// # Errors
    /// Where it has not started.
    pub fn terminate(&mut self) -> Result<(), Fault> {
        self.must_be("fmi2Terminate", &[Mode::Stepping, Mode::Failed])?;
        self.mode = Mode::Terminated;
        Ok(())
    }

    /// After a defect nothing but [`Self::restore`] and [`Self::reset`] leads on.
    pub(super) fn break_off(&mut self) {
        (self.mode, self.live) = (Mode::Failed, None);
    }

    /// Goes back to where it was when it was made.
    pub fn reset(&mut self) {
        *self = Self::new(self.resources.clone());
    }

    /// Its state.
    ///
    /// # Errors
    /// After a step that failed.
    pub fn checkpoint(&mut self) -> Result<Checkpoint, Fault> {
        use Mode::{Initialization, Instantiated, Stepping, Terminated};
        self.must_be("fmi2GetFMUstate", &[Instantiated, Initialization, Stepping, Terminated])?;
        let is_under_way = matches!(self.mode, Stepping | Terminated);
        let simulation = match &mut self.live {
            // What is read afterwards is what is read after the state was set again.
            Some(live) if is_under_way => Some(live.changed().state().map_err(|error| error.to_string())?),
            _ => None,
        };
        let (guid, setup) = (self.resources.guid().to_owned(), self.setup.clone());
        let (torques, held) = (self.torques.clone(), self.held.clone());
        Ok(Checkpoint { guid, mode: self.mode, setup, torques, held, has_ended: self.has_ended, simulation })
    }

    /// Goes to a state of an instance of the same FMU.
    ///
    /// # Errors
    /// Where it is of another FMU; nothing is changed then.
    pub fn restore(&mut self, checkpoint: &Checkpoint) -> Result<(), Fault> {
        let Checkpoint { guid, mode, setup, torques, held, has_ended, simulation } = checkpoint;
        if guid != self.resources.guid() {
            return Err("the state is of another FMU".to_owned().into());
        }
        match (simulation, &mut self.live) {
            (Some(state), Some(live)) if live.setup == *setup => {
                live.changed().set_state(state).map_err(|error| error.to_string())?;
            }
            (Some(state), _) => {
                let mut live = Live::new(&self.resources, setup)?;
                live.changed().set_state(state).map_err(|error| error.to_string())?;
                self.live = Some(live);
            }
            (None, _) => self.live = None,
        }
        (self.mode, self.setup, self.has_ended) = (*mode, setup.clone(), *has_ended);
        (self.torques, self.held) = (torques.clone(), held.clone());
        Ok(())
    }
}

fn words(mode: Mode) -> &'static str {
    match mode {
        Mode::Instantiated => "not yet initialized",
        Mode::Initialization => "in its initialization",
        Mode::Stepping => "under way",
        Mode::Terminated => "terminated",
        Mode::Failed => "at a step that failed",
    }
}
