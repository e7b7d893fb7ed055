//! Following a path from its start to its end.
//!
//! Knots are set as far apart as the branch between them is known: of a robot that is not redundant a polynomial between them must
//! lead Newton's method, of a redundant one it must be q itself, and q' = J⁺ṙ be integrated to rounding, both but for what Newton's
//! method puts right. They never skip what the path's signals do ([`Agenda`]).

use super::course::{Course, MOST_KNOTS};
use super::hermite::{Knot, Knots, quintic_into};
use super::passage::{CLOSE, Passage, SINGULAR, Search};
use super::solver::{ITERATIONS, Miss, START_ITERATIONS, Solver};
use crate::motion::PathError;
use crate::signal::{Agenda, AgendaError, Watched};
use std::sync::atomic::Ordering;

/// The first stretch and the longest, as shares of the path.
const FIRST: f64 = 1.0 / 64.0;
const LONGEST: f64 = 1.0 / 16.0;

/// The longest reach of a polynomial through a singular instant, as a share of the path.
const LONGEST_PASSAGE: f64 = 0.25;

/// Stretches that shrink below this share of the path lead nowhere.
const SHORTEST: f64 = 1e-10;

/// Errors of the polynomial between two knots: from where Newton's method finds the branch, and what nothing puts right.
const LEADS: f64 = 1e-5;
const IDLE: f64 = 3e-10;

/// Errors of the integration over a stretch, likewise.
const INTEGRAL_LEADS: f64 = 1e-6;
const INTEGRAL_IDLE: f64 = 1e-11;

/// Errors cannot be below this many roundings of the coordinates.
const ROUNDINGS: f64 = 64.0;

/// A stretch has the nodes of this many steps of a run.
const STEPS_IN_STRETCH: usize = 8;

/// Share of a signal's range that may stay unseen between the nodes of such a step: the errors of a stretch are looked at anyway.
const UNSEEN: f64 = 1e-4;

/// Knots around a turn in a nearly singular configuration are at most this many times as far apart as it lasts.
const RESOLVED: f64 = 100.0;

/// Where a path is tried again that could not be followed on, as shares of it.
const LATER: [f64; 4] = [1e-6, 1e-4, 1e-3, 1e-2];

pub(super) struct Follower<'a> {
    pub(super) solver: Solver<'a>,
    pub(super) course: &'a Course<'a>,
    agenda: Agenda,
    longest: f64,
    pub(super) knots: Knots,
    pub(super) passages: Vec<Passage>,
}

/// Where a piece of the path leads to from its start, for a guess of what is ahead.
enum Heading {
    /// The user's guess.
    Guess(Vec<f64>),
    /// On with the velocity before a kink.
    On(Vec<f64>),
}

impl<'a> Follower<'a> {
    /// Looks through the path's signals.
    ///
    /// # Errors
    /// [`PathError`] where they change too often to be followed, or where this is interrupted.
    pub(super) fn new(solver: Solver<'a>, course: &'a Course<'a>) -> Result<Self, PathError> {
        let too_many = PathError::TooManyStretches { t: 0.0, limit: MOST_KNOTS / 2 };
        let watched: Vec<Watched> =
            solver.task.signals().map(|signal| Watched { signal, is_position: true, slack: 1.0 }).collect();
        let agenda =
            Agenda::new(&watched, course.end, UNSEEN, 4 * MOST_KNOTS as u64, Some(course.stop)).map_err(|error| {
                match error {
                    AgendaError::Interrupted => PathError::Interrupted { t: 0.0 },
                    AgendaError::TooBusy { .. } => too_many,
                }
            })?;
        let longest = (LONGEST * course.end).min(course.max_step.unwrap_or(f64::INFINITY));
        let steps = STEPS_IN_STRETCH as f64;
        if agenda.least_steps(course.end, longest / steps) / steps > 0.5 * MOST_KNOTS as f64 {
            return Err(too_many);
        }
        Ok(Self { solver, course, agenda, longest, knots: Knots::default(), passages: Vec::new() })
    }

    /// Knots and passages from t = 0, near `guess`, to the end.
    ///
    /// # Errors
    /// Why they end early; those up to there are good.
    pub(super) fn follow(&mut self, guess: &[f64]) -> Result<(), PathError> {
        self.solver.look_around(guess);
        let end = self.course.end;
        let (mut t, mut q, mut heading, mut iterations) =
            (0.0, guess.to_vec(), Heading::Guess(guess.to_vec()), START_ITERATIONS);
        loop {
            let stop = self.agenda.next_stop(t).filter(|stop| stop.before < end);
            // At a break of samples the derivatives are those of the right side.
            let to = stop.map_or(end, |stop| if stop.after.is_some() { stop.before } else { stop.before.next_down() });
            let first = self.knots.len();
            self.set_out(t, q, &heading, to, iterations)?;
            self.march(to, first)?;
            self.pass_singular(first)?;
            let Some(stop) = stop else { return Ok(()) };
            // Across a kink the coordinates go on, their rates do not.
            let last = self.knots.knot(self.knots.len() - 1);
            (t, q, heading, iterations) = (stop.after.unwrap_or(stop.before), last.q, Heading::On(last.v), ITERATIONS);
        }
    }

    /// The first knots of a piece of the path, from t to `end`.
    fn set_out(
        &mut self,
        t: f64,
        q: Vec<f64>,
        heading: &Heading,
        end: f64,
        iterations: usize,
    ) -> Result<(), PathError> {
        let start = match self.solver.knot(t, q, iterations) {
            Ok(start) => start,
            Err(Miss { distance, angle }) => return Err(PathError::OutOfReach { t, at: t, distance, angle }),
        };
        if start.conditioning >= CLOSE || end <= t || self.solver.rests(t) {
            self.knots.push(&start);
            return Ok(());
        }
        let search = Search {
            t,
            conditioning: start.conditioning,
            within: [t, end],
            longest: (LONGEST_PASSAGE * self.course.end).min(end - t),
            shortest: SHORTEST * self.course.end,
        };
        let ahead = |to: f64| match heading {
            Heading::Guess(guess) => guess.clone(),
            Heading::On(v) => start.q.iter().zip(v).map(|(q, v)| q + (to - t) * v).collect(),
        };
        match self.solver.way_out(&start, &search, ahead) {
            Some(passage) => {
                self.set_knots(&passage, t, passage.to, start.conditioning);
                self.passages.push(passage);
            }
            None if start.conditioning < SINGULAR => return Err(PathError::Singular { t }),
            None => self.knots.push(&start),
        }
        Ok(())
    }

    /// Knots on a passage, evenly from `from` to `to`.
    fn set_knots(&mut self, passage: &Passage, from: f64, to: f64, conditioning: f64) {
        for k in 0..=4 {
            let t = if k == 4 { to } else { from + 0.25 * k as f64 * (to - from) };
            self.knots.push(&passage.knot(t, conditioning));
        }
    }

    /// Knots from the last one to `end`, of the piece whose first knot is `first`.
    fn march(&mut self, end: f64, first: usize) -> Result<(), PathError> {
        let mut h = FIRST * self.course.end;
        loop {
            let from = self.knots.knot(self.knots.len() - 1);
            let t = from.t;
            if t >= end {
                return Ok(());
            }
            if self.course.stop.load(Ordering::Relaxed) {
                return Err(PathError::Interrupted { t });
            }
            if self.knots.len() >= MOST_KNOTS {
                return Err(PathError::TooManyStretches { t, limit: MOST_KNOTS / 2 });
            }
            let to = self.stretch(t, h).min(end);
            let advanced = self.advance(&from, to);
            if to == end && self.arrives(&from, end, first, advanced.is_err()) {
                return Ok(());
            }
            match advanced {
                Ok((middle, last, growth)) => {
                    self.knots.push(&middle);
                    self.knots.push(&last);
                    // A stretch cut short says nothing against the size chosen before.
                    let size = to - t;
                    h = (size * growth).max(if size < h && growth >= 1.0 { h } else { 0.0 }).min(self.longest);
                }
                Err(()) => {
                    h = 0.3 * (to - t);
                    if h < SHORTEST * self.course.end {
                        self.step_back();
                        return Err(self.why(&from, to));
                    }
                }
            }
        }
    }

    /// Where a stretch from t ends that is to be h long and hides nothing of the signals.
    fn stretch(&self, t: f64, h: f64) -> f64 {
        let step = h.min(self.longest) / STEPS_IN_STRETCH as f64;
        (0..STEPS_IN_STRETCH).fold(t, |to, _| to + self.agenda.reach(to, step))
    }

    /// Knots at the middle and at `to`, and by how much the next stretch may be longer; an error asks for a shorter one.
    fn advance(&mut self, from: &Knot, to: f64) -> Result<(Knot, Knot, f64), ()> {
        let h = to - from.t;
        let middle_t = from.t + 0.5 * h;
        let is_redundant = self.solver.freedom.is_redundant;
        let rounding = ROUNDINGS * f64::EPSILON * from.q.iter().fold(0.0f64, |m, q| m.max(q.abs()));
        let solver = &mut self.solver;
        let mut error = 0.0f64;
        let middle = if is_redundant { solver.extrapolate(from, middle_t) } else { from.taylor(0.5 * h) };
        let middle = solver.knot(middle_t, middle, ITERATIONS).map_err(drop)?;
        let mut departs = vec![0.0; from.q.len()];
        // What of an error is left when Newton's method has put right what moves the gripper.
        let mut weigh = |solver: &Solver, departs: &mut [f64], leads: f64, idle: f64| {
            let all = departs.iter().fold(0.0f64, |m, x| if x.is_nan() { f64::NAN } else { m.max(x.abs()) });
            let idle = if is_redundant { solver.idle_part(departs) / idle.max(rounding) } else { 0.0 };
            let worst = (all / leads.max(rounding)).max(idle);
            error = if all.is_finite() { error.max(worst) } else { f64::INFINITY };
        };
        let last = if is_redundant {
            let (coarse, fine) = (solver.extrapolate(from, to), solver.extrapolate(&middle, to));
            let last = solver.knot(to, fine.clone(), ITERATIONS).map_err(drop)?;
            (0..departs.len()).for_each(|j| departs[j] = coarse[j] - fine[j]);
            weigh(solver, &mut departs, INTEGRAL_LEADS, INTEGRAL_IDLE);
            last
        } else {
            solver.knot(to, middle.taylor(0.5 * h), ITERATIONS).map_err(drop)?
        };
        // Halving the stretch, as the middle knot does, divides the interpolation error by 64.
        quintic_into(from.side(), last.side(), middle_t, &mut departs);
        departs.iter_mut().zip(&middle.q).for_each(|(d, q)| *d -= q);
        weigh(solver, &mut departs, LEADS, IDLE);
        if error > 1.0 {
            return Err(());
        }
        Ok((middle, last, (0.8 * error.powf(-1.0 / 6.0)).clamp(0.5, 3.0)))
    }

    /// Whether the piece from knot `first` ends in a singular configuration, and knots lead there.
    fn arrives(&mut self, from: &Knot, end: f64, first: usize, is_stuck: bool) -> bool {
        let conditioning = self.solver.conditioning(end, &mut from.taylor(end - from.t));
        if conditioning >= CLOSE || self.solver.rests(end) {
            return false;
        }
        let begin = self.knots.times()[first];
        let search = Search {
            t: end,
            // Where J leads nowhere, anything better than nothing.
            conditioning: if is_stuck { conditioning.min(SINGULAR) } else { conditioning },
            within: [begin, end],
            longest: (LONGEST_PASSAGE * self.course.end).max(end - from.t).min(end - begin),
            shortest: end - from.t,
        };
        let Self { solver, knots, .. } = self;
        let found = search.find(|[edge, _], times| {
            if nearness(solver, knots, edge) < CLOSE {
                return None;
            }
            let known = times.partition_point(|t| *t <= from.t);
            let mut values = positions(solver, knots, &times[..known])?;
            values.extend(solver.chain(from, times[known..].iter().copied())?);
            Some(values)
        });
        let Some(passage) = found else { return false };
        // The first of them is there already.
        let before = self.knots.len();
        self.set_knots(&passage, from.t, end, conditioning);
        debug_assert_eq!(self.knots.len(), before + 5);
        self.passages.push(passage);
        true
    }

    /// Passages through singular configurations between the knots from `first` on.
    fn pass_singular(&mut self, first: usize) -> Result<(), PathError> {
        let mut k = first;
        while k < self.knots.len() {
            if let Some([low, high]) = self.dip(first, k)
                && self.passages.last().is_none_or(|last| high > last.to)
            {
                self.pass(first, [low, high])?;
            }
            k += 1;
        }
        Ok(())
    }

    /// The times around knot `k` between which J may come close to a loss of rank.
    fn dip(&self, first: usize, k: usize) -> Option<[f64; 2]> {
        let (times, nearness) = (self.knots.times(), self.knots.conditioning());
        let (low, high) = (k.saturating_sub(1).max(first), (k + 1).min(times.len() - 1));
        if nearness[k] > nearness[low] || nearness[k] > nearness[high] || low == high {
            return None;
        }
        // As steep as it is around.
        let around = k.saturating_sub(2).max(first)..=(k + 2).min(times.len() - 1);
        let steep =
            around.clone().zip(around.skip(1)).map(|(i, j)| (nearness[j] - nearness[i]).abs() / (times[j] - times[i]));
        let way = (times[k] - times[low]).max(times[high] - times[k]);
        let least = nearness[k] - 1.5 * way * steep.fold(0.0, f64::max);
        (least < CLOSE).then_some([times[low], times[high]])
    }

    /// Looks for the instant between two times at which J is nearest to a loss of rank, and passes it where that is close.
    fn pass(&mut self, first: usize, [low, high]: [f64; 2]) -> Result<(), PathError> {
        let Self { solver, knots, .. } = self;
        let (t, conditioning) = lowest(|t| nearness(solver, knots, t), low, high);
        let [begin, end] = [knots.times()[first], knots.times()[knots.len() - 1]];
        if conditioning >= CLOSE || solver.rests(t) {
            return Ok(());
        }
        // Time in which it would become 1.
        let sides = [low, high].into_iter().filter(|side| *side != t);
        let scale = sides.map(|side| (side - t).abs() / nearness(solver, knots, side)).fold(f64::INFINITY, f64::min);
        let longest = (0.6 * scale).min(LONGEST_PASSAGE * self.course.end).min((t - begin).max(end - t));
        let shortest = (1e-9 * scale).max(1e-13 * self.course.end);
        let search = Search { t, conditioning, within: [begin, end], longest, shortest };
        let found = search.find(|edges, times| {
            // Outside of it J says enough.
            let mut inside = edges.into_iter().filter(|edge| *edge != begin && *edge != end);
            let is_clear = inside.all(|edge| nearness(solver, knots, edge) >= CLOSE);
            if is_clear { positions(solver, knots, times) } else { None }
        });
        match found {
            Some(passage) => {
                if self.passages.last().is_none_or(|last| last.to < passage.to) {
                    self.passages.push(passage);
                }
                Ok(())
            }
            // Knots this far apart have gone past a turn within their tolerance.
            None if conditioning < SINGULAR || high - low > RESOLVED * conditioning * scale => {
                self.come_near(t);
                Err(PathError::Singular { t })
            }
            None => Ok(()),
        }
    }

    /// Leaves out the last knots at which J is nearly singular: where the path leaves the reach, rates grow without bound.
    fn step_back(&mut self) {
        let passed = self.passages.last().map_or(0.0, |passage| passage.to);
        while self.knots.conditioning().last().is_some_and(|c| *c < CLOSE)
            && self.knots.times().last().is_some_and(|t| *t > passed)
        {
            self.knots.truncate(self.knots.len() - 1);
        }
    }

    /// Leaves knots only up to the singular instant t, as near as J is good.
    fn come_near(&mut self, t: f64) {
        let keep = self.knots.times().partition_point(|knot| *knot < t).max(1);
        self.knots.truncate(keep);
        loop {
            let last = self.knots.knot(self.knots.len() - 1);
            let half = 0.5 * (t - last.t);
            match self.solver.knot(last.t + half, last.taylor(half), ITERATIONS) {
                Ok(next) if next.conditioning >= CLOSE && half > SHORTEST * self.course.end => self.knots.push(&next),
                _ => return,
            }
        }
    }

    /// Why the path cannot be followed from knot `from` to t.
    fn why(&mut self, from: &Knot, t: f64) -> PathError {
        for share in LATER {
            let at = (t + share * self.course.end).min(self.course.end);
            let target = self.solver.task.target(at);
            if let Err(Miss { distance, angle }) = self.solver.newton(&target, &mut from.q.clone(), START_ITERATIONS) {
                return PathError::OutOfReach { t, at, distance, angle };
            }
        }
        PathError::Singular { t }
    }
}

/// How far J is from losing rank at t, which is between knots.
fn nearness(solver: &mut Solver, knots: &Knots, t: f64) -> f64 {
    let mut q = vec![0.0; solver.model.nv()];
    knots.interpolate_into(t, &mut q);
    solver.conditioning(t, &mut q)
}

/// Positions at times between knots.
fn positions(solver: &mut Solver, knots: &Knots, times: &[f64]) -> Option<Vec<Vec<f64>>> {
    let place = |t: &f64| {
        let mut q = vec![0.0; solver.model.nv()];
        knots.interpolate_into(*t, &mut q);
        solver.newton(&solver.task.target(*t), &mut q, ITERATIONS).ok()?;
        Some(q)
    };
    times.iter().map(place).collect()
}

/// Where a function is lowest that falls, then rises, and how low: by the golden section.
fn lowest(mut f: impl FnMut(f64) -> f64, low: f64, high: f64) -> (f64, f64) {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let (mut a, mut b) = (low, high);
    let (mut x, mut y) = (b - GOLDEN * (b - a), a + GOLDEN * (b - a));
    let (mut fx, mut fy) = (f(x), f(y));
    for _ in 0..60 {
        if fx < fy {
            (b, y, fy) = (y, x, fx);
            x = b - GOLDEN * (b - a);
            fx = f(x);
        } else {
            (a, x, fx) = (x, y, fy);
            y = a + GOLDEN * (b - a);
            fy = f(y);
        }
    }
    let ends = [(x, fx), (y, fy), (low, f(low)), (high, f(high))];
    ends.into_iter().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((x, fx))
}
