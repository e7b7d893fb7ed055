//! What signals do between two times, known before a run steps through them.
//!
//! A step looks at a signal at a few nodes; what happens between them it cannot see. So the whole run is looked through beforehand,
//! cell by cell, with bounds instead of samples (`Expression::look`): where no kink switches and the signal is a polynomial up to a
//! small share of its own range, the cell is done; where a kink switches once it is located to the last bit; else the cell is halved.
//! No pulse is too narrow to be found, down to [`FINEST`](super::watched::FINEST) of the run. The outcome is a list of *stops*, where steps end, and of
//! *windows* that bound the steps in them.

use super::expression::Expression;
use super::function::{Kind, Signal};
use super::scan::{MANY_KINKS, Scan};
use super::watched::{AgendaError, Watched, Window};
use std::sync::atomic::AtomicBool;

/// What a run must not step over.
#[derive(Debug, Clone, Default)]
pub struct Agenda {
    /// The first times after kinks, ascending.
    kinks: Vec<f64>,
    /// Times at which a derivative of samples jumps, ascending.
    breaks: Vec<f64>,
    windows: Vec<Window>,
    /// Widths below which kinks and the start are one.
    tiny: f64,
}

/// Where a step must end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    /// The last time that belongs to the step.
    pub before: f64,
    /// The first time on the other side of a kink or jump; `None` where a derivative of samples jumps at `before` itself.
    pub after: Option<f64>,
}

impl Agenda {
    /// Looks through `signals` from 0 to `end`.
    ///
    /// `tolerance` is the share of a signal's own range (and of its integral's) that may stay unseen between the nodes of a step, `most` how many kinks of
    /// one signal the run can follow.
    ///
    /// # Errors
    /// [`AgendaError`] where a signal changes more often than that, or where `stop` is set.
    pub fn new(
        signals: &[Watched<'_>],
        end: f64,
        tolerance: f64,
        most: u64,
        stop: Option<&AtomicBool>,
    ) -> Result<Self, AgendaError> {
        let mut agenda = Self { tiny: f64::EPSILON * f64::EPSILON * end, ..Self::default() };
        for (index, watched) in signals.iter().enumerate() {
            match &watched.signal.kind {
                Kind::Constant(_) => {}
                Kind::Samples(samples) => {
                    agenda.breaks.extend_from_slice(samples.break_points());
                    agenda.kinks.extend(samples.kinks());
                }
                Kind::Expression(expression) => {
                    agenda.look(expression, watched, end, tolerance, (most, stop)).map_err(|error| match error {
                        AgendaError::TooBusy { times, .. } => AgendaError::TooBusy { signal: index, times },
                        AgendaError::Interrupted => error,
                    })?;
                }
            }
        }
        for times in [&mut agenda.kinks, &mut agenda.breaks] {
            times.retain(|t| 0.0 < *t && *t <= end);
            times.sort_by(f64::total_cmp);
            times.dedup();
        }
        Ok(agenda)
    }

    /// Looks through one expression; of a sum of many kinks, term by term: to look at all of them beside each kink would take as often as there are others.
    fn look(
        &mut self,
        expression: &Expression,
        watched: &Watched<'_>,
        end: f64,
        tolerance: f64,
        (most, stop): (u64, Option<&AtomicBool>),
    ) -> Result<(), AgendaError> {
        let mut whole = Scan::new(expression, watched, end, tolerance, (most, stop));
        let terms = if expression.kink_count() > MANY_KINKS { expression.terms() } else { Vec::new() };
        if terms.len() < 2 {
            whole.run()?;
            self.take(&mut [whole]);
            return Ok(());
        }
        let Signal { scale, offset, .. } = *watched.signal;
        let signal = |term: &Expression| Signal { kind: Kind::Expression(term.clone().into()), scale, offset };
        let signals: Vec<Signal> = terms.iter().map(signal).collect();
        let of_terms = terms.iter().zip(&signals);
        let mut scans: Vec<Scan> = of_terms
            .map(|(term, signal)| Scan::new(term, &Watched { signal, ..*watched }, end, tolerance, (most, stop)))
            .collect();
        whole.sample();
        scans.iter_mut().for_each(Scan::sample);
        // What the terms hide adds up to what the whole may hide.
        let share = |of: &dyn Fn(&Scan) -> f64| (of(&whole) / scans.iter().map(of).sum::<f64>()).min(1.0);
        let share = share(&|scan| scan.seen.range()).min(share(&|scan| scan.integral_scale()));
        let mut left = most;
        for scan in &mut scans {
            (scan.tolerance, scan.most) = (scan.tolerance * share, left);
            scan.run_sampled()?;
            left = left.saturating_sub(scan.kinks.len() as u64);
        }
        self.take(&mut scans);
        Ok(())
    }

    /// Takes what was found.
    fn take(&mut self, scans: &mut [Scan<'_>]) {
        for scan in scans {
            self.kinks.append(&mut scan.kinks);
            self.windows = meet(&self.windows, &scan.windows);
        }
    }

    /// The first times after kinks, ascending, s.
    pub(super) fn kinks(&self) -> &[f64] {
        &self.kinks
    }

    /// Number of kinks and jumps of expressions.
    pub fn switches(&self) -> u64 {
        self.kinks.len() as u64
    }

    /// The shortest of the longest steps, s; `None` where nothing but the stops bounds the steps.
    pub fn finest(&self) -> Option<f64> {
        let finest = self.windows.iter().map(|window| window.longest).fold(f64::INFINITY, f64::min);
        finest.is_finite().then_some(finest)
    }

    /// At least as many steps does a run to `end` take whose own longest step is `longest`.
    pub fn least_steps(&self, end: f64, longest: f64) -> f64 {
        let ends = self.windows.iter().skip(1).map(|window| window.start).chain([end]);
        let bounded =
            self.windows.iter().zip(ends).map(|(window, to)| (to - window.start) / window.longest.min(longest));
        let even = if self.windows.is_empty() { end / longest } else { bounded.sum() };
        even + self.kinks.len() as f64
    }

    /// How long a step from `t` may be, at most `h`, so that its nodes see all that happens in it. It may end where a window with
    /// shorter steps begins.
    pub fn reach(&self, t: f64, h: f64) -> f64 {
        let first = self.windows.partition_point(|window| window.start <= t).saturating_sub(1);
        let mut reach = h;
        for window in self.windows.get(first..).unwrap_or_default() {
            let ahead = window.start - t;
            if ahead >= reach {
                break;
            }
            reach = reach.min(window.longest.max(ahead));
        }
        reach
    }

    /// The first stop at or after `t`; kinks that only rounding tells apart are one.
    pub fn next_stop(&self, t: f64) -> Option<Stop> {
        let k = self.kinks.partition_point(|after| self.before(*after) < t);
        let kink = self.kinks.get(k).map(|&after| {
            let next = self.kinks[k + 1..].iter().take_while(|next| **next - after <= 8.0 * f64::EPSILON * after);
            Stop { before: self.before(after), after: Some(next.last().copied().unwrap_or(after)) }
        });
        let breaks = self.breaks.get(self.breaks.partition_point(|at| *at <= t)).copied();
        match (kink, breaks) {
            (Some(kink), Some(at)) if at < kink.before => Some(Stop { before: at, after: None }),
            (None, Some(at)) => Some(Stop { before: at, after: None }),
            (kink, _) => kink,
        }
    }

    /// The last time before a kink.
    fn before(&self, after: f64) -> f64 {
        if after <= self.tiny { 0.0 } else { after.next_down() }
    }
}

/// The shorter of the longest steps at each time.
fn meet(a: &[Window], b: &[Window]) -> Vec<Window> {
    if a.is_empty() || b.is_empty() {
        return if a.is_empty() { b.to_vec() } else { a.to_vec() };
    }
    let (mut met, mut i, mut j): (Vec<Window>, usize, usize) = (Vec::new(), 0, 0);
    loop {
        let window = Window { start: a[i].start.max(b[j].start), longest: a[i].longest.min(b[j].longest) };
        if met.last().is_none_or(|last| last.longest != window.longest) {
            met.push(window);
        }
        match (a.get(i + 1), b.get(j + 1)) {
            (None, None) => return met,
            (Some(next), other) if other.is_none_or(|other| next.start <= other.start) => {
                j += usize::from(other.is_some_and(|other| other.start == next.start));
                i += 1;
            }
            _ => j += 1,
        }
    }
}
