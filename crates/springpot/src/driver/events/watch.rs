//! The events of a run: steps end where they act, rows are told where they happen.

use super::sides::{Functions, Passage, Sides};
use crate::driver::output::Output;
use crate::driver::time_loop::{Driver, Mark, RowsAhead};
use crate::equations::context::{Context, Held};
use crate::methods::stepper::Target;
use crate::system::System;
use crate::system::error::RunError;
use crate::system::settings::{Settings, Stop};
use crate::system::{Action, Event, Setting};
use serde::{Deserialize, Serialize};

/// Tries to end a step where an event acts.
const MOST_TRIES: usize = 40;

/// Times that differ by less than this share of their step are one.
const ONE_TIME: f64 = 1e-12;

/// So many events that act within this share of the run get nowhere.
const CHATTER: f64 = 1e-9;
const MOST_AT_ONCE: u32 = 1000;

/// Watches the events of a run.
#[derive(Debug)]
pub(crate) struct Watch<'s> {
    functions: Functions<'s>,
    state: WatchState,
    /// What happens in the step at hand, or at the present time.
    passages: Vec<Passage>,
}

/// What of the events must outlast a step.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct WatchState {
    sides: Sides,
    /// What events have set.
    pub(crate) held: Held,
    /// When the first of the events acted that lie close together, and how many they are.
    together: (f64, u32),
}

/// What becomes of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Next {
    GoesOn,
    /// An event ends it here.
    Stops,
}

impl<'s> Watch<'s> {
    /// # Errors
    /// Of a function of t alone that changes more often than a run can follow; [`RunError::Interrupted`].
    pub(crate) fn new(
        system: &'s System,
        settings: &Settings,
        state: WatchState,
        stop: &Stop,
    ) -> Result<Self, RunError> {
        let functions = Functions::new(system.context(), settings, stop)?;
        Ok(Self { functions, state, passages: Vec::new() })
    }

    pub(crate) fn state(&self) -> &WatchState {
        &self.state
    }

    /// The system, and what events have set.
    pub(crate) fn cx(&self) -> Context<'_> {
        Context { held: &self.state.held, ..self.functions.cx }
    }

    fn is_idle(&self) -> bool {
        self.functions.events.is_empty()
    }

    /// Looks at the start of a run.
    ///
    /// # Errors
    /// What a row there may show.
    pub(crate) fn start(&mut self, driver: &mut Driver) -> Result<(), RunError> {
        if self.state.sides.is_known() { Ok(()) } else { self.look_now(driver) }
    }

    /// Looks at the present time, between two steps: at the start of a run, and behind what was crossed.
    ///
    /// # Errors
    /// What a row there may show.
    pub(crate) fn look_now(&mut self, driver: &mut Driver) -> Result<(), RunError> {
        if self.is_idle() {
            return Ok(());
        }
        let mut sides = std::mem::take(&mut self.state.sides);
        let cx = Context { held: &self.state.held, ..self.functions.cx };
        let passages = self.functions.look_now(cx, driver, &mut sides)?;
        self.take(passages, sides)
    }

    /// Looks through the step at hand, and has it end at the first event that acts in it.
    ///
    /// The step is solved anew to where its own interpolation sees the event, until the event is at its end. `before` is where the driver was before
    /// it took the step, `rows` what it was told.
    ///
    /// # Errors
    /// Where no step leads on.
    pub(crate) fn look(&mut self, driver: &mut Driver, before: Mark, rows: Option<RowsAhead>) -> Result<(), RunError> {
        if self.is_idle() {
            return Ok(());
        }
        let (mut low, mut high) = (driver.t(), f64::INFINITY);
        let (mut wanted, mut asked) = (None, f64::INFINITY);
        for tried in 0.. {
            // What changes at the start of a step is crossed first.
            let Some(step) = driver.step_at_hand() else { return Ok(()) };
            let mut sides = self.state.sides.clone();
            let cx = Context { held: &self.state.held, ..self.functions.cx };
            let passages = self.functions.look(cx, driver, &step, &mut sides)?;
            let counts = |passage: &Passage| self.functions.counts(passage);
            let acts = |passage: &&Passage| counts(passage) && self.functions.events[passage.event].acts();
            let first = passages.iter().find(acts).copied();
            let near = near(&step);
            let next = match (first, wanted) {
                // Cut short by something else, it ends before the event.
                (None, Some(_)) if step.to < asked => return self.take(passages, sides),
                (None, None) => return self.take(passages, sides),
                (Some(first), _) if first.t <= step.from + near => {
                    driver.take_back(before);
                    return self.at_start(first, step.from);
                }
                (Some(first), _) => {
                    (high, wanted) = (step.to, Some(first.event));
                    first.t
                }
                (None, Some(event)) => {
                    low = step.to;
                    step.to + self.ahead(driver, &step, event)?
                }
            };
            let Some(event) = wanted else { return Ok(()) };
            let is_here = (next - step.to).abs() <= near || high - low <= near;
            if is_here || tried >= MOST_TRIES {
                return self.end_at(driver, &step, event, passages, sides);
            }
            asked = if low < next && next < high { next } else { 0.5 * (low + high) };
            driver.take_back(before);
            driver.advance(Context { held: &self.state.held, ..self.functions.cx }, asked, rows, &mut || false)?;
        }
        Ok(())
    }

    fn ahead(&mut self, driver: &mut Driver, step: &Target, event: usize) -> Result<f64, RunError> {
        let cx = Context { held: &self.state.held, ..self.functions.cx };
        self.functions.ahead(cx, driver, step, event)
    }

    fn take(&mut self, mut passages: Vec<Passage>, sides: Sides) -> Result<(), RunError> {
        passages.retain(|passage| self.functions.counts(passage));
        (self.passages, self.state.sides) = (passages, sides);
        Ok(())
    }

    /// An event acts before the step that was taken back.
    fn at_start(&mut self, first: Passage, t: f64) -> Result<(), RunError> {
        self.state.sides.leave(first.event, first.t);
        self.passages = vec![Passage { t, ..first }];
        Ok(())
    }

    /// The step ends at an event that acts, and at all others that happen at the same time.
    fn end_at(
        &mut self,
        driver: &mut Driver,
        step: &Target,
        event: usize,
        mut passages: Vec<Passage>,
        mut sides: Sides,
    ) -> Result<(), RunError> {
        let near = near(step);
        let last: Vec<_> = passages.extract_if(.., |passage| passage.t >= step.to - near).collect();
        for other in 0..self.functions.events.len() {
            let sign = sides.signs[other];
            let rises = match last.iter().find(|passage| passage.event == other) {
                Some(passage) => passage.rises,
                None if other == event => sign < 0,
                None if sign != 0 && self.ahead(driver, step, other)?.abs() <= near => sign < 0,
                None => continue,
            };
            sides.signs[other] = 0;
            passages.push(Passage { event: other, t: step.to, rises });
        }
        self.take(passages, sides)
    }

    /// Tells the rows of what was seen, and does what the events do that act.
    ///
    /// # Errors
    /// What the rows or the new torques and inputs may show; [`RunError::EventChatter`].
    pub(crate) fn happen(&mut self, driver: &mut Driver, output: &mut Output) -> Result<Next, RunError> {
        let mut passages = std::mem::take(&mut self.passages);
        let Some(last) = passages.last().copied() else { return Ok(Next::GoesOn) };
        let near = driver.step_at_hand().map_or(0.0, |step| near(&step));
        // What happens at one time does so in the order of the scenario.
        let mut from = 0;
        while from < passages.len() {
            let t = passages[from].t;
            let count = passages[from..].iter().take_while(|passage| passage.t - t <= near).count();
            passages[from..from + count].sort_by_key(|passage| passage.event);
            from += count;
        }
        let before = self.state.held.clone();
        let cx = Context { held: &before, ..self.functions.cx };
        for passage in &passages {
            output.event(cx, driver, passage.event, passage.t)?;
        }
        let events = self.functions.events;
        let acting = || passages.iter().map(|passage| &events[passage.event]).filter(|event| event.acts());
        let mut held = before.clone();
        for event in acting() {
            event.set(cx.system, &mut held);
        }
        if let Some(event) = acting().next() {
            self.count(event, last.t, driver.recorder.settings.end)?;
        }
        if acting().any(|event| event.action == Action::Stop) {
            return Ok(Next::Stops);
        }
        if held != before {
            driver.disturb(cx)?;
            self.state.held = held;
        }
        Ok(Next::GoesOn)
    }

    fn count(&mut self, event: &Event, t: f64, end: f64) -> Result<(), RunError> {
        let span = CHATTER * end;
        let (first, count) = &mut self.state.together;
        (*first, *count) = if t - *first <= span && *count > 0 { (*first, *count + 1) } else { (t, 1) };
        if *count <= MOST_AT_ONCE {
            return Ok(());
        }
        Err(RunError::EventChatter { t, event: event.name.clone(), count: *count, span })
    }
}

impl Event {
    /// Sets what it sets.
    fn set(&self, system: &System, held: &mut Held) {
        let Action::Set(settings) = &self.action else { return };
        for setting in settings {
            match *setting {
                Setting::Input { element, input, value } => {
                    held.hold_input(system, element, input, Some(value)).expect("an input of the system")
                }
                Setting::Torque { velocity, value } => held.hold_force(system.model.nv(), velocity, value),
            }
        }
    }
}

/// How far apart times may be that are one.
fn near(step: &Target) -> f64 {
    (ONE_TIME * (step.to - step.from)).max(4.0 * f64::EPSILON * step.to)
}
