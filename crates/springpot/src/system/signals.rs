//! The signals that drive a run, and what they ask of its steps.

use super::error::RunError;
use super::jump::refuse_jumps;
use super::settings::Settings;
use super::{Motion, System};
use crate::signal::{Agenda, AgendaError, Signal, Watched};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Share of a signal's range that may stay unseen between the nodes of a step, in units of rtol and within these bounds: what is
/// seen at all is met to rtol by the control of the steps.
const UNSEEN: f64 = 1e2;
const UNSEEN_BOUNDS: [f64; 2] = [1e-6, 1e-2];

/// How many times more an input may hide from which no motion follows.
const INPUT_SLACK: f64 = 1e3;

/// How many more steps a run may take for every switch of its signals.
const STEPS_PER_SWITCH: u64 = 100;

/// Neighbouring times at which rounding may leave the argument of a sign 0.
const MOST_TURNING: usize = 256;

/// Values that differ by less than this share of them are one.
const STILL: f64 = 1e-9;

/// Kinks and jumps that are looked at before a run.
const MOST_LOOKED_AT: usize = 10_000;

impl System {
    /// Whether anything that drives the robot varies with time.
    pub(crate) fn varies(&self) -> bool {
        let Motion::Forward(forward) = &self.motion else { return true };
        let varies = |signal: &Signal| signal.is_constant().is_none();
        let aims = self.control.controller.as_ref().is_some_and(|controlled| {
            let forward = controlled.feed_forward.iter().any(|(_, signal)| varies(signal));
            forward || controlled.reference.trajectory().signals().iter().any(|signal| varies(signal))
        });
        forward.has_paths()
            || forward.forces(&self.model).any(|(_, signal)| varies(signal))
            || self.control.laws().any(|(law, _)| !law.parts_of_time().is_empty())
            || aims
            || self.elements.iter().flat_map(|element| &element.inputs).any(varies)
    }

    /// Looks through all signals before a run whose own steps are at most `longest`.
    ///
    /// # Errors
    /// [`RunError`] where a signal changes more often than the run may take steps, or the run is interrupted.
    pub(crate) fn agenda(&self, settings: &Settings, longest: f64, stop: &AtomicBool) -> Result<Arc<Agenda>, RunError> {
        let named = self.watched();
        let watched: Vec<Watched> = named.iter().map(|(_, watched)| *watched).collect();
        let [least, most] = UNSEEN_BOUNDS;
        let tolerance = (UNSEEN * settings.rtol).clamp(least, most);
        let most = settings.most_kinks();
        let found = self.shared.look(&watched, (settings.end, tolerance, most), stop);
        let agenda = found.map_err(|error| match error {
            AgendaError::Interrupted => RunError::Interrupted { t: 0.0 },
            AgendaError::TooBusy { signal, times } => {
                RunError::TooBusy { what: named[signal].0.clone(), times, limit: most }
            }
        })?;
        self.check_samples(settings)?;
        let limit = settings.step_limit(agenda.switches());
        let (least, times) = (agenda.least_steps(settings.end, longest), settings.end / longest);
        if times > limit as f64 {
            return Err(RunError::TooShortSteps { longest, times, limit });
        }
        if least > limit as f64 {
            let what = self.busiest(&named, settings, longest, tolerance).unwrap_or_else(|| "the motion".to_owned());
            return Err(RunError::TooBusy { what, times: least, limit });
        }
        Ok(agenda)
    }

    /// The name of the signal that by itself asks for the most steps.
    fn busiest(
        &self,
        named: &[(String, Watched<'_>)],
        settings: &Settings,
        longest: f64,
        tolerance: f64,
    ) -> Option<String> {
        let steps = |watched: &Watched<'_>| {
            let alone = Agenda::new(&[*watched], settings.end, tolerance, settings.most_kinks(), None).ok()?;
            Some(alone.least_steps(settings.end, longest))
        };
        let each = named.iter().filter_map(|(name, watched)| Some((steps(watched)?, name)));
        each.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, name)| name.clone())
    }

    /// Refuses laws that are sampled more often than the run may take steps.
    fn check_samples(&self, settings: &Settings) -> Result<(), RunError> {
        let laws =
            self.control.laws().map(|(law, sampling)| (format!("the feedback \"{}\"", law.expression()), sampling));
        let controller = self.control.controller.as_ref().map(|own| ("the controller".to_owned(), own.sampling));
        let limit = settings.step_limit(0);
        for (what, sampling) in laws.chain(controller) {
            let times = sampling.map_or(0.0, |sampling| settings.end / sampling.period);
            if times > limit as f64 {
                return Err(RunError::TooBusy { what, times, limit });
            }
        }
        Ok(())
    }

    /// How often the signals of a run that chooses its steps switch, as [`crate::driver::run`] finds out before its first row; `stop` interrupts.
    ///
    /// # Errors
    /// [`RunError::TooBusy`] where a signal changes more often than the run may take steps, [`RunError::Interrupted`].
    pub fn switches(&self, settings: &Settings, stop: &AtomicBool) -> Result<u64, RunError> {
        Ok(self.agenda(settings, settings.end, stop)?.switches())
    }

    /// Looks at the kinks and jumps of the signals, up to a number of them, for coordinates that jump there, for references that a controller answers
    /// with an impulse, and for temperatures that stretch an element at once; on gripper paths a run looks for itself.
    ///
    /// # Errors
    /// [`RunError::Jump`], [`RunError::ReferenceJump`], [`RunError::Rule`], and as [`Self::switches`], also for functions of events that hang on t alone.
    pub fn look_for_jumps(&self, settings: &Settings, stop: &AtomicBool) -> Result<(), RunError> {
        self.look_for_jumps_of_references(settings, stop)?;
        self.look_for_jumps_of_heat(settings, stop)?;
        self.look_at_events(settings, stop)?;
        if self.motion.has_path() || settings.fixed_step.is_some() {
            return Ok(());
        }
        let agenda = self.agenda(settings, settings.end, stop)?;
        let (mut left, mut right) = (self.state(0.0)?, self.state(0.0)?);
        let mut t = 0.0;
        for _ in 0..MOST_LOOKED_AT {
            let Some(kink) = agenda.next_stop(t).filter(|stop| stop.before < settings.end) else { break };
            if stop.load(Ordering::Relaxed) {
                return Err(RunError::Interrupted { t: 0.0 });
            }
            let after = kink.after.unwrap_or(kink.before).max(t.next_up());
            self.place(kink.before, &mut left)?;
            self.place(after, &mut right)?;
            let speed = |k: usize| left.v[k].abs() + right.v[k].abs();
            let mut spare = right.clone();
            refuse_jumps(&self.model, (kink.before, &left.q), (after, &right.q), speed, 0.0, |at, places| {
                self.place(at, &mut spare)?;
                places.clone_from(&spare.q);
                Ok(())
            })?;
            t = after;
        }
        Ok(())
    }

    /// The reference of a controller that follows accelerations, or has D^mu of its error, must not jump, sampled or not.
    pub(crate) fn look_for_jumps_of_references(&self, settings: &Settings, stop: &AtomicBool) -> Result<(), RunError> {
        let Some(controlled) = &self.control.controller else { return Ok(()) };
        let derives =
            || !controlled.shaping.on_measurement && controlled.error_terms().iter().any(|term| term.order > 0.0);
        if !controlled.law.follows_accelerations() && !derives() {
            return Ok(());
        }
        for (what, signal) in controlled.reference.trajectory().named_signals(&self.model) {
            if let Some((t, [before, after])) = self.first_jump(&what, signal, settings, stop)? {
                let what = what.replace("the motion of ", "");
                return Err(RunError::ReferenceJump { t, what, jump: after - before });
            }
        }
        Ok(())
    }

    /// A temperature that stretches an element must not jump.
    fn look_for_jumps_of_heat(&self, settings: &Settings, stop: &AtomicBool) -> Result<(), RunError> {
        for element in &self.elements {
            let Some(signal) = element.law.stretched_by().and_then(|input| element.inputs.get(input)) else { continue };
            if let Some((t, [before, after])) = self.first_jump("a temperature", signal, settings, stop)? {
                return Err(RunError::heat_jump(t, &element.name, before, after));
            }
        }
        Ok(())
    }

    /// The first time from t on at which no sign turns, whose value there belongs to no step.
    pub(crate) fn past_turns(&self, t: f64) -> f64 {
        let turns = |t: f64| self.signals().any(|signal| signal.turns_at(t));
        let mut past = t;
        for _ in 0..MOST_TURNING {
            if !turns(past) {
                break;
            }
            past = past.next_up();
        }
        past
    }

    /// Whether a sign turns at t.
    pub(crate) fn turns_at(&self, t: f64) -> bool {
        self.signals().any(|signal| signal.turns_at(t))
    }

    fn signals(&self) -> impl Iterator<Item = &Signal> {
        let feedback = self.control.laws().flat_map(|(law, _)| law.parts_of_time());
        let aims = self.control.controller.iter().flat_map(|controlled| controlled.reference.trajectory().signals());
        let forward = self.control.controller.iter().flat_map(|controlled| &controlled.feed_forward);
        let aims = aims.chain(forward.map(|(_, signal)| signal));
        let inputs = self.elements.iter().flat_map(|element| &element.inputs).chain(feedback).chain(aims);
        let motion = match &self.motion {
            Motion::Given(trajectory) => trajectory.signals(),
            Motion::Forward(forward) => forward.signals(),
        };
        motion.into_iter().chain(inputs)
    }

    /// Every signal with its name.
    fn watched(&self) -> Vec<(String, Watched<'_>)> {
        let position = |signal| Watched { signal, is_position: true, slack: 1.0 };
        let own = |signal| Watched { signal, is_position: false, slack: 1.0 };
        let mut watched: Vec<(String, Watched)> = Vec::new();
        let labels = self.model.v_labels();
        match &self.motion {
            Motion::Given(trajectory) => {
                let named = trajectory.named_signals(&self.model).into_iter();
                watched.extend(named.map(|(name, signal)| (name, position(signal))));
            }
            Motion::Forward(forward) => {
                let torque = |k: usize| format!("the torque on \"{}\"", labels[k].name);
                watched.extend(forward.forces(&self.model).map(|(k, signal)| (torque(k), own(signal))));
                for (j, joint) in forward.paths(&self.model) {
                    let name = format!("the motion of joint \"{}\"", self.model.joint_names()[j]);
                    watched.extend(joint.signals().into_iter().map(|signal| (name.clone(), position(signal))));
                }
            }
        }
        for element in &self.elements {
            for (entry, signal) in element.entry.inputs.iter().zip(&element.inputs) {
                // Along a motion given in advance inputs change energies alone, which steps are held to as well.
                let slack = if matches!(self.motion, Motion::Forward(_)) { 1.0 } else { INPUT_SLACK };
                let name = format!("input {} of element \"{}\"", entry.name, element.name);
                watched.push((name, Watched { slack, ..own(signal) }));
            }
        }
        watched.extend(self.watched_control());
        watched.retain(|(_, watched): &(String, Watched<'_>)| is_function(watched.signal));
        watched
    }

    /// What control follows at every time: parts of expressions that hang on t alone, and references.
    fn watched_control(&self) -> Vec<(String, Watched<'_>)> {
        let mut watched = Vec::new();
        for (law, _) in self.control.laws().filter(|(_, sampling)| sampling.is_none()) {
            let name = format!("the feedback \"{}\"", law.expression());
            let parts = law.parts_of_time().iter().map(|signal| Watched { signal, is_position: false, slack: 1.0 });
            watched.extend(parts.map(|part| (name.clone(), part)));
        }
        let continuous = self.control.controller.as_ref().filter(|controlled| controlled.sampling.is_none());
        if let Some(controlled) = continuous {
            let signals = controlled.reference.trajectory().named_signals(&self.model).into_iter();
            let position = |signal| Watched { signal, is_position: true, slack: 1.0 };
            watched.extend(signals.map(|(name, signal)| (format!("{name} as the reference has it"), position(signal))));
            watched.extend(controlled.feed_forward.iter().map(|(k, signal)| {
                let name = format!("the feed-forward of joint \"{}\"", self.model.v_labels()[*k].name);
                (name, Watched { signal, is_position: false, slack: 1.0 })
            }));
        }
        watched
    }

    /// When a signal first jumps, and its values on both sides; its first kinks are looked at, up to a number of them.
    fn first_jump(
        &self,
        what: &str,
        signal: &Signal,
        settings: &Settings,
        stop: &AtomicBool,
    ) -> Result<Option<(f64, [f64; 2])>, RunError> {
        if !is_function(signal) {
            return Ok(None);
        }
        let watched = [Watched { signal, is_position: true, slack: 1.0 }];
        let most = settings.most_kinks();
        let found = self.shared.look(&watched, (settings.end, UNSEEN_BOUNDS[1], most), stop);
        let agenda = found.map_err(|error| match error {
            AgendaError::Interrupted => RunError::Interrupted { t: 0.0 },
            AgendaError::TooBusy { times, .. } => RunError::TooBusy { what: what.to_owned(), times, limit: most },
        })?;
        let mut t = 0.0;
        for _ in 0..MOST_LOOKED_AT {
            let Some(kink) = agenda.next_stop(t).filter(|stop| stop.before < settings.end) else { break };
            if stop.load(Ordering::Relaxed) {
                return Err(RunError::Interrupted { t: 0.0 });
            }
            let after = kink.after.unwrap_or(kink.before).max(t.next_up());
            let [left, right] = [kink.before, after].map(|at| signal.at(at));
            let reach = 2.0 * (after - kink.before) * (left.first.abs() + right.first.abs());
            let rounding = STILL * (left.value.abs() + right.value.abs());
            if (right.value - left.value).abs() > reach + rounding {
                return Ok(Some((after, [left.value, right.value])));
            }
            t = after;
        }
        Ok(None)
    }
}

fn is_function(signal: &Signal) -> bool {
    signal.is_constant().is_none()
}

impl Settings {
    /// Steps that a run may take where nothing else is said and its signals do not switch.
    pub const MOST_STEPS: u64 = 10_000_000;

    /// Kinks of one signal that a run may have, each of which ends a step.
    pub(crate) fn most_kinks(&self) -> u64 {
        self.max_steps.unwrap_or(Self::MOST_STEPS)
    }

    /// Inner steps that a run may take whose signals switch that often.
    pub(crate) fn step_limit(&self, switches: u64) -> u64 {
        self.max_steps.unwrap_or_else(|| Self::MOST_STEPS.saturating_add(STEPS_PER_SWITCH.saturating_mul(switches)))
    }
}
