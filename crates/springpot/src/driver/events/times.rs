//! Events on functions of t alone, whose passages are known before the run, and parts of t in the others.

use super::passage::Passage;
use crate::signal::{Agenda, AgendaError, Passages, Signal, Watched, passages};
use crate::system::error::RunError;
use crate::system::event::Event;
use crate::system::settings::{Settings, Stop};
use crate::system::{Motion, System};

/// Share of the range of a part that may stay unseen between the places at which a step is looked at.
const UNSEEN: f64 = 1e-3;

/// A stretch in which a part departs that little from a cubic is looked at in so many places.
const PLACES: f64 = 4.0;

/// What of events hangs on t alone.
#[derive(Debug, Default)]
pub(crate) struct Times {
    /// Of events that hang on nothing else, when they pass zero.
    passages: Vec<Option<Passages>>,
    /// What the parts of the others do.
    parts: Agenda,
}

impl Times {
    /// Looks through the events of a run.
    ///
    /// # Errors
    /// [`RunError::TooBusy`] of a function that passes zero, or has kinks, more often than the run may take steps; [`RunError::NotFinite`] of one that is no
    /// number; [`RunError::Interrupted`].
    pub(crate) fn of(events: &[Event], settings: &Settings, stop: &Stop) -> Result<Self, RunError> {
        let (end, most) = (settings.end, settings.most_kinks());
        let failed = |event: &Event, error: AgendaError| match error {
            AgendaError::Interrupted => RunError::Interrupted { t: 0.0 },
            AgendaError::TooBusy { times, .. } => RunError::TooBusy { what: named(event), times, limit: most },
        };
        let of_event = |event: &Event| {
            let Some(function) = event.when.of_time_alone() else { return Ok(None) };
            let found = passages(&function, end, most, Some(stop)).map_err(|error| failed(event, error))?;
            match found {
                (_, Some(t)) => Err(RunError::NotFinite { t, what: named(event), value: function.value(t) }),
                (passages, None) => Ok(Some(passages)),
            }
        };
        let known = events.iter().map(of_event).collect::<Result<Vec<_>, _>>()?;
        let mut signals: Vec<(&Event, Signal)> = Vec::new();
        for (event, _) in events.iter().zip(&known).filter(|(_, known)| known.is_none()) {
            signals.extend(event.when.parts_of_time().into_iter().map(|part| (event, Signal::expression(part))));
        }
        let watched: Vec<Watched> =
            signals.iter().map(|(_, signal)| Watched { signal, is_position: false, slack: 1.0 }).collect();
        let parts = Agenda::new(&watched, end, UNSEEN, most, Some(stop)).map_err(|error| {
            let signal = if let AgendaError::TooBusy { signal, .. } = error { signal } else { 0 };
            failed(signals[signal].0, error)
        })?;
        let least = PLACES * parts.least_steps(end, end);
        if let Some((event, _)) = signals.first().filter(|_| least > most as f64) {
            return Err(RunError::TooBusy { what: named(event), times: least, limit: most });
        }
        Ok(Self { passages: known, parts })
    }

    /// Whether an event hangs on nothing else.
    pub(crate) fn knows(&self, event: usize) -> bool {
        self.passages[event].is_some()
    }

    /// The passages after the times that were `seen` of each event, up to t, which is seen then.
    pub(crate) fn take(&self, seen: &mut Vec<f64>, t: f64) -> Vec<Passage> {
        seen.resize(self.passages.len(), 0.0);
        let mut taken = Vec::new();
        for (event, (known, seen)) in self.passages.iter().zip(seen).enumerate() {
            let Some(known) = known else { continue };
            let first = known.partition_point(|(at, _)| *at <= *seen);
            let own = known[first..].iter().take_while(|(at, _)| *at <= t);
            taken.extend(own.map(|&(t, rises)| Passage { event, t, rises }));
            *seen = seen.max(t);
        }
        taken
    }

    /// How far behind t an event passes zero next, s.
    pub(crate) fn ahead(&self, event: usize, t: f64) -> f64 {
        let known = self.passages[event].as_deref().unwrap_or_default();
        known.get(known.partition_point(|(at, _)| *at <= t)).map_or(f64::INFINITY, |(at, _)| at - t)
    }

    /// Adds the times between `from` and `to` at which parts of t ask to be looked at.
    pub(crate) fn places(&self, [from, to]: [f64; 2], places: &mut Vec<f64>) {
        let (mut t, mut stop) = (from, self.parts.next_stop(from));
        loop {
            let reach = self.parts.reach(t, to - t);
            // As far as nothing is bounded, the places that every step is looked at do.
            let next = if reach < to - t { t + reach / PLACES } else { to };
            while let Some(kink) = stop.filter(|kink| kink.before <= next && kink.before < to) {
                let after = kink.after.unwrap_or(kink.before);
                places.extend([kink.before, after].into_iter().filter(|at| from < *at && *at < to));
                stop = self.parts.next_stop(after.max(kink.before.next_up()));
            }
            if next >= to || next <= t {
                return;
            }
            places.push(next);
            t = next;
        }
    }
}

fn named(event: &Event) -> String {
    format!("`when` of event \"{}\"", event.name)
}

impl System {
    /// The events of a motion that follows from forces; of one that is given in advance none happens.
    pub(in crate::driver) fn watched_events(&self) -> &[Event] {
        match self.motion {
            Motion::Given(_) => &[],
            Motion::Forward(_) => &self.events,
        }
    }

    /// Looks through what of events hangs on t alone, as a run does before its first row.
    ///
    /// # Errors
    /// As [`Times::of`].
    pub(crate) fn look_at_events(&self, settings: &Settings, stop: &Stop) -> Result<(), RunError> {
        Times::of(self.watched_events(), settings, stop).map(|_| ())
    }
}
