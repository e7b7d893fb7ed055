//! The events of a run or simulation: steps end where they act, somebody is told where they happen.

use super::passage::Passage;
use super::sides::{Functions, Sides};
use crate::driver::roots::{Bracket, MOST_TRIES};
use crate::driver::time_loop::{Driver, Mark, RowsAhead};
use crate::equations::context::{Context, Held};
use crate::methods::stepper::Target;
use crate::system::System;
use crate::system::error::RunError;
use crate::system::settings::{Settings, Stop};
use crate::system::{Action, Event, Setting};
use serde::{Deserialize, Serialize};

/// Times that differ by less than this share of their step are one.
const ONE_TIME: f64 = 1e-12;

/// So many events that act within this share of the run get nowhere.
const CHATTER: f64 = 1e-9;
const MOST_AT_ONCE: u32 = 1000;

/// Watches the events of a run.
#[derive(Debug)]
pub(crate) struct Watch {
    functions: Functions,
    state: WatchState,
    /// What happens in the step at hand, or at the present time.
    passages: Vec<Passage>,
}

/// What of the events must outlast a step.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct WatchState {
    sides: Sides,
    /// What is held, by events or from outside.
    held: Held,
    /// The event that ended it.
    stopped: Option<usize>,
    /// When the first of the events acted that lie close together, and how many they are.
    together: (f64, u32),
}

/// Is told of an event at a time, s, of the step at hand, and of how much later it comes, parameter by parameter ([`Driver::passage`]).
pub(crate) type Tell<'a> = dyn FnMut(Context, &mut Driver, (usize, f64), &[f64]) -> Result<(), RunError> + 'a;

/// What becomes of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Next {
    GoesOn,
    /// An event ends it here.
    Stops,
}

impl WatchState {
    /// The system, and what is held.
    pub(crate) fn cx<'a>(&'a self, system: &'a System) -> Context<'a> {
        Context { held: &self.held, ..system.context() }
    }
}

impl Watch {
    /// # Errors
    /// Of a function of t alone that changes more often than a run can follow; [`RunError::Interrupted`].
    pub(crate) fn new(system: &System, settings: &Settings, state: WatchState, stop: &Stop) -> Result<Self, RunError> {
        let functions = Functions::new(system, settings, stop)?;
        Ok(Self { functions, state, passages: Vec::new() })
    }

    pub(crate) fn state(&self) -> &WatchState {
        &self.state
    }

    /// The system, and what events have set.
    pub(crate) fn cx<'a>(&'a self, system: &'a System) -> Context<'a> {
        self.state.cx(system)
    }

    /// What is held from outside, to be changed.
    pub(crate) fn held_mut(&mut self) -> &mut Held {
        &mut self.state.held
    }

    /// Whether an event has ended it.
    pub(crate) fn has_stopped(&self) -> bool {
        self.state.stopped.is_some()
    }

    /// The event that ended it, or does so where it is.
    pub(crate) fn stopped(&self, system: &System) -> Option<usize> {
        let stops = |event: &usize| system.watched_events()[*event].action == Action::Stop;
        self.state.stopped.or_else(|| self.passages.iter().map(|passage| passage.event).find(stops))
    }

    /// What happens in the step at hand, or at the present time, in the order in which it does: events with their times.
    pub(crate) fn passed(&self) -> impl Iterator<Item = (usize, f64)> {
        self.passages.iter().map(|passage| (passage.event, passage.t))
    }

    /// Goes on from another state.
    pub(crate) fn go_on(&mut self, state: WatchState) {
        self.state = state;
        self.passages.clear();
    }

    /// Looks at the start of a run.
    ///
    /// # Errors
    /// What a row there may show.
    pub(crate) fn start(&mut self, system: &System, driver: &mut Driver) -> Result<(), RunError> {
        if self.state.sides.is_known() { Ok(()) } else { self.look_now(system, driver) }
    }

    /// Looks at the present time, between two steps: at the start of a run, and behind what was crossed.
    ///
    /// # Errors
    /// What a row there may show.
    pub(crate) fn look_now(&mut self, system: &System, driver: &mut Driver) -> Result<(), RunError> {
        if system.watched_events().is_empty() {
            return Ok(());
        }
        let mut sides = std::mem::take(&mut self.state.sides);
        let cx = self.state.cx(system);
        let passages = self.functions.look_now(cx, driver, &mut sides)?;
        self.take(system, passages, sides);
        Ok(())
    }

    /// Looks through the step at hand, and has it end at the first event that acts in it.
    ///
    /// The step is solved anew to where its own interpolation sees the event, until the event is at its end. `before` is where the driver was before
    /// it took the step, `rows` what it was told.
    ///
    /// # Errors
    /// Where no step leads on.
    pub(crate) fn look(
        &mut self,
        system: &System,
        driver: &mut Driver,
        before: Mark,
        rows: Option<RowsAhead>,
    ) -> Result<(), RunError> {
        self.passages.clear();
        let events = system.watched_events();
        if events.is_empty() {
            return Ok(());
        }
        let mut bracket = Bracket::new(driver.t());
        let (mut wanted, mut asked) = (None, f64::INFINITY);
        for tried in 0.. {
            // What changes at the start of a step is crossed first.
            let Some(step) = driver.step_at_hand() else { return Ok(()) };
            let mut sides = self.state.sides.clone();
            let cx = self.state.cx(system);
            let passages = self.functions.look(cx, driver, &step, &mut sides)?;
            let acts = |passage: &&Passage| counts(events, passage) && events[passage.event].acts();
            let first = passages.iter().find(acts).copied();
            let near = near(&step);
            let next = match first {
                // Nothing acts, or cut short by something else it ends before the event.
                None if wanted.is_none() || step.to < asked => {
                    self.take(system, passages, sides);
                    return Ok(());
                }
                Some(first) if first.t <= step.from + near => {
                    driver.take_back(before);
                    self.at_start(first, step.from);
                    return Ok(());
                }
                Some(first) => {
                    bracket.is_before(step.to);
                    wanted = Some(first.event);
                    first.t
                }
                None => {
                    bracket.is_behind(step.to);
                    step.to + wanted.map_or(Ok(0.0), |event| self.functions.ahead(cx, driver, &step, event))?
                }
            };
            let Some(event) = wanted else { return Ok(()) };
            let is_here = (next - step.to).abs() <= near || bracket.is_closed(near);
            if is_here || tried >= MOST_TRIES {
                return self.end_at(system, driver, &step, event, passages, sides);
            }
            asked = bracket.next(Some(next));
            driver.take_back(before);
            driver.advance(cx, asked, rows, &mut || false)?;
        }
        Ok(())
    }

    fn take(&mut self, system: &System, mut passages: Vec<Passage>, sides: Sides) {
        passages.retain(|passage| counts(system.watched_events(), passage));
        (self.passages, self.state.sides) = (passages, sides);
    }

    /// An event acts before the step that was taken back.
    fn at_start(&mut self, first: Passage, t: f64) {
        self.state.sides.leave(first.event, first.t);
        self.passages = vec![Passage { t, ..first }];
    }

    /// The step ends at an event that acts, and at all others that happen at the same time.
    fn end_at(
        &mut self,
        system: &System,
        driver: &mut Driver,
        step: &Target,
        event: usize,
        mut passages: Vec<Passage>,
        mut sides: Sides,
    ) -> Result<(), RunError> {
        let (near, cx) = (near(step), self.state.cx(system));
        let last: Vec<_> = passages.extract_if(.., |passage| passage.t >= step.to - near).collect();
        for other in 0..system.watched_events().len() {
            let sign = sides.signs[other];
            let rises = match last.iter().find(|passage| passage.event == other) {
                Some(passage) => passage.rises,
                None if other == event => sign < 0,
                None if sign != 0 && self.functions.ahead(cx, driver, step, other)?.abs() <= near => sign < 0,
                None => continue,
            };
            sides.signs[other] = 0;
            passages.push(Passage { event: other, t: step.to, rises });
        }
        self.take(system, passages, sides);
        Ok(())
    }

    /// Tells of what was seen, and does what the events do that act.
    ///
    /// # Errors
    /// Those of `tell`, and what new torques and inputs may show; [`RunError::EventChatter`].
    pub(crate) fn happen(&mut self, system: &System, driver: &mut Driver, tell: &mut Tell) -> Result<Next, RunError> {
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
        let cx = Context { held: &before, ..system.context() };
        let events = system.watched_events();
        let mut moved = Vec::new();
        for passage in &passages {
            let later = driver.passage(cx, passage.event, passage.t)?;
            tell(cx, driver, (passage.event, passage.t), later.as_deref().unwrap_or_default())?;
            moved.extend(later.map(|later| (*passage, later)));
        }
        let acting = || passages.iter().map(|passage| &events[passage.event]).filter(|event| event.acts());
        let mut held = before.clone();
        for event in acting() {
            event.set(cx.system, &mut held);
        }
        for (passage, later) in moved {
            driver.vary_event(cx, passage.event, (passage.t, later));
        }
        if let Some(event) = acting().next() {
            self.count(event, last.t, driver.recorder.settings.end)?;
        }
        let stops = |passage: &&Passage| events[passage.event].action == Action::Stop;
        if let Some(passage) = passages.iter().find(stops) {
            self.state.stopped = Some(passage.event);
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

/// Whether a passage is in the direction of its event.
fn counts(events: &[Event], passage: &Passage) -> bool {
    events[passage.event].direction.counts(passage.rises)
}

/// How far apart times may be that are one.
fn near(step: &Target) -> f64 {
    (ONE_TIME * (step.to - step.from)).max(4.0 * f64::EPSILON * step.to)
}
