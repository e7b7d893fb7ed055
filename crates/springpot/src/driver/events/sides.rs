//! On which side of zero the functions of events are, and where they pass it in a step.

use super::nodes::Nodes;
use super::passage::Passage;
use super::times::Times;
use crate::driver::time_loop::Driver;
use crate::equations::context::Context;
use crate::equations::zero::{SAMPLES, lowest_between, zero_within};
use crate::methods::stepper::Target;
use crate::observe::{Needs, Snapshot};
use crate::system::System;
use crate::system::error::RunError;
use crate::system::event::Event;
use crate::system::settings::{Settings, Stop};
use serde::{Deserialize, Serialize};

/// Where a step is looked at besides, where some function has just left zero.
const EARLY: [f64; 2] = [1.0 / 1024.0, 1.0 / 64.0];

/// How closely passages are found, in units of the step.
const CLOSE: f64 = 1e-13;

/// A value is zero that rounding of its columns may have made: this share of them, and so much in SI.
const ROUNDING: f64 = 1e-12;
const LEAST: f64 = 1e-14;

/// In place of the sign of a function that has been 0 for a while: it passes zero where it leaves it.
const RESTS: i8 = 2;

impl Sides {
    /// Whether they were ever looked at.
    pub(crate) fn is_known(&self) -> bool {
        !self.signs.is_empty()
    }

    /// Forgets the side of an event that acted at t.
    pub(crate) fn leave(&mut self, event: usize, t: f64) {
        self.signs[event] = 0;
        self.seen[event] = self.seen[event].max(t);
    }
}

/// What is asked for values.
#[derive(Debug)]
pub(crate) struct Functions {
    /// What is known of them before the run.
    times: Times,
    /// What must be known for each.
    needs: Vec<Needs>,
    nodes: Nodes,
    snapshot: Snapshot,
    columns: Vec<f64>,
}

/// Of every event, what outlasts a step.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Sides {
    /// Sign of the function; 0 until it has left zero, and of functions of t alone; [`RESTS`].
    pub(crate) signs: Vec<i8>,
    /// Its value at the present time.
    values: Vec<f64>,
    /// Up to when the passages of functions of t alone were taken, s.
    seen: Vec<f64>,
}

impl Functions {
    /// # Errors
    /// As [`Times::of`].
    pub(crate) fn new(system: &System, settings: &Settings, stop: &Stop) -> Result<Self, RunError> {
        let events = system.watched_events();
        let times = Times::of(events, settings, stop)?;
        let needs = |event: &Event| event.columns.iter().map(|quantity| quantity.needs()).max();
        let needs = events.iter().map(|event| needs(event).unwrap_or(Needs::Places)).collect();
        let (nodes, snapshot) = (Nodes::of(events), Snapshot::new(system));
        Ok(Self { times, needs, nodes, snapshot, columns: Vec::new() })
    }

    /// The events whose passages are not known beforehand.
    fn of_state(&self) -> Vec<usize> {
        (0..self.needs.len()).filter(|&event| !self.times.knows(event)).collect()
    }

    /// Goes to a time of the step at hand, or to the present one, for the functions of these events.
    fn go_to(&mut self, cx: Context, driver: &mut Driver, t: f64, events: &[usize]) -> Result<(), RunError> {
        let needs = events.iter().map(|&event| self.needs[event]).max();
        driver.glance(cx, t, needs.unwrap_or(Needs::Places), &mut self.snapshot)
    }

    /// The function of an event there.
    fn value(&mut self, event: &Event) -> f64 {
        let Event { when, columns, .. } = event;
        self.columns.clear();
        self.columns.extend(columns.iter().map(|quantity| self.snapshot.value(*quantity)));
        when.value(self.snapshot.t(), &self.columns)
    }

    /// Its side there: 0 where it is zero but for rounding, or no number.
    fn clear_side(&mut self, event: &Event) -> i8 {
        let value = self.value(event);
        let (when, t) = (&event.when, self.snapshot.t());
        let off = |x: f64| x + ROUNDING * x.abs() + LEAST;
        let mut noise = (when.value(off(t), &self.columns) - value).abs();
        for k in 0..self.columns.len() {
            let kept = self.columns[k];
            self.columns[k] = off(kept);
            noise += (when.value(t, &self.columns) - value).abs();
            self.columns[k] = kept;
        }
        if value.abs() > noise { side_of(value) } else { 0 }
    }

    /// Takes the sides that are not known at the present time; what lies on the other one by now has passed zero in a jump.
    pub(crate) fn look_now(
        &mut self,
        cx: Context,
        driver: &mut Driver,
        Sides { signs, values, seen }: &mut Sides,
    ) -> Result<Vec<Passage>, RunError> {
        let t = driver.reached();
        let all = cx.system.watched_events();
        signs.resize(all.len(), 0);
        values.resize(all.len(), 0.0);
        let mut passages = self.times.take(seen, t);
        let events = self.of_state();
        if events.is_empty() {
            return Ok(passages);
        }
        self.go_to(cx, driver, t, &events)?;
        for &event in &events {
            let (now, sign) = (self.clear_side(&all[event]), &mut signs[event]);
            if *sign != 0 && now != 0 && (now == -*sign || *sign == RESTS) {
                passages.push(Passage { event, t, rises: now > 0 });
            }
            // Where a step ends at an event, the function is as near to zero as times can be told.
            if now != 0 && (*sign != 0 || self.value(&all[event]).abs() > 2.0 * values[event].abs()) {
                *sign = now;
            }
            values[event] = self.finite_value(&all[event])?;
        }
        Ok(passages)
    }

    /// The function of an event there.
    ///
    /// # Errors
    /// [`RunError::NotFinite`] of a function whose columns are numbers, but for t = 0.
    fn finite_value(&mut self, event: &Event) -> Result<f64, RunError> {
        let (value, t) = (self.value(event), self.snapshot.t());
        if !value.is_finite() && t > 0.0 && self.columns.iter().all(|column| column.is_finite()) {
            let what = format!("`when` of event \"{}\"", event.name);
            return Err(RunError::NotFinite { t, what, value });
        }
        Ok(value)
    }

    /// The passages in the step at hand in the order of their times; the sides are taken to its end.
    ///
    /// A function that leaves zero does not pass it.
    pub(crate) fn look(
        &mut self,
        cx: Context,
        driver: &mut Driver,
        step: &Target,
        sides: &mut Sides,
    ) -> Result<Vec<Passage>, RunError> {
        // At the very start of a step no law is asked.
        let earliest = step.from + close(step) * (step.to - step.from);
        let mut passages = self.times.take(&mut sides.seen, step.to);
        passages.iter_mut().for_each(|passage| passage.t = passage.t.max(earliest).min(step.to));
        let mut events = self.of_state();
        if !events.is_empty() {
            let (from, size) = (step.from, step.to - step.from);
            let mut places: Vec<f64> = (1..SAMPLES).map(|i| from + size * i as f64 / SAMPLES as f64).collect();
            self.times.places([from, step.to], &mut places);
            places.push(step.to);
            places.sort_by(f64::total_cmp);
            places.dedup();
            let all = cx.system.watched_events();
            // What stays away from zero need not be asked more closely.
            let apart = |functions: &mut Self, event: usize, sides: &mut Sides, driver: &mut Driver| {
                let cubic = driver.solver.stepper().is_cubic();
                let known = cubic && functions.needs[event] < Needs::Forces && sides.signs[event].abs() == 1;
                if !known {
                    return Ok(false);
                }
                functions.nodes.read(cx, driver, all, &functions.needs, &mut functions.snapshot)?;
                let end = functions.nodes.end_where_apart(all, event, &places, step, sides.signs[event]);
                sides.values[event] = end.unwrap_or(sides.values[event]);
                Ok::<_, RunError>(end.is_some())
            };
            self.nodes.forget();
            let mut open = Vec::new();
            for event in events.drain(..) {
                if !apart(self, event, sides, driver)? {
                    open.push(event);
                }
            }
            if !open.is_empty() {
                self.look_closely((cx, driver, step), &open, &places, sides, &mut passages)?;
            }
        }
        passages.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.event.cmp(&b.event)));
        Ok(passages)
    }

    /// Looks for passages of events at these times of the step.
    ///
    /// Two of them between two of the places are seen where the function is lower at one of these than at its neighbours.
    fn look_closely(
        &mut self,
        (cx, driver, step): (Context, &mut Driver, &Target),
        events: &[usize],
        places: &[f64],
        Sides { signs, values: start, .. }: &mut Sides,
        passages: &mut Vec<Passage>,
    ) -> Result<(), RunError> {
        let (all, close) = (cx.system.watched_events(), close(step) * (step.to - step.from));
        let earliest = step.from + 0.5 * close;
        let early = EARLY.into_iter().filter(|_| events.iter().any(|&event| signs[event] == 0));
        let mut places: Vec<f64> =
            early.map(|theta| step.from + theta * (step.to - step.from)).chain(places.iter().copied()).collect();
        places.sort_by(f64::total_cmp);
        // The two places before, and the values there.
        let starts = events.iter().map(|&event| start[event]).collect();
        let mut before = [(f64::NAN, vec![f64::NAN; events.len()]), (step.from, starts)];
        for t in places.into_iter().filter(|t| *t > step.from) {
            self.go_to(cx, driver, t, events)?;
            let values = events.iter().map(|&event| self.finite_value(&all[event])).collect::<Result<Vec<_>, _>>()?;
            for (k, &event) in events.iter().enumerate() {
                let sign = &mut signs[event];
                if sign.abs() != 1 {
                    self.go_to(cx, driver, t, &[event])?;
                    let now = self.clear_side(&all[event]);
                    if *sign == RESTS && now != 0 {
                        let (side, from) = (f64::from(now), before[1].0);
                        let mut failed = None;
                        let mut back = |back: f64| match self.go_to(cx, driver, (t - back).max(earliest), &[event]) {
                            Ok(()) => side * self.value(&all[event]),
                            Err(error) => {
                                failed.get_or_insert(error);
                                f64::NAN
                            }
                        };
                        let left = zero_within(&mut back, 0.0, t - from, close);
                        if let Some(error) = failed {
                            return Err(error);
                        }
                        passages.push(Passage { event, t: (t - left).max(earliest), rises: now > 0 });
                    }
                    *sign = match now {
                        // Nothing but 0 all along: it has come to rest there.
                        0 if *sign == RESTS || (values[k] == 0.0 && before[1].1[k] == 0.0) => RESTS,
                        now => now,
                    };
                    continue;
                }
                let side = f64::from(*sign);
                let [first, left] = [0, 1].map(|at| (before[at].0, side * before[at].1[k]));
                let here = (t, side * values[k]);
                let mut failed = None;
                let mut at = |t: f64| match self.go_to(cx, driver, t.max(earliest), &[event]) {
                    Ok(()) => side * self.value(&all[event]),
                    Err(error) => {
                        failed.get_or_insert(error);
                        f64::NAN
                    }
                };
                let mut note = |t: f64, rises: bool| passages.push(Passage { event, t, rises });
                if here.1 <= 0.0 {
                    note(zero_within(&mut at, left.0, here.0, close), side < 0.0);
                    *sign = side_of(values[k]);
                } else if may_dip([first.1, left.1, here.1]) {
                    let lowest = lowest_between(&mut at, first.0, here.0);
                    if at(lowest) < 0.0 {
                        note(zero_within(&mut at, first.0, lowest, close), side < 0.0);
                        // From behind, where it is above zero again.
                        let back = zero_within(&mut |back| at(here.0 - back), 0.0, here.0 - lowest, close);
                        note(here.0 - back, side > 0.0);
                    }
                }
                if let Some(error) = failed {
                    return Err(error);
                }
            }
            before.swap(0, 1);
            before[1] = (t, values);
        }
        let [_, (_, end)] = before;
        events.iter().zip(end).for_each(|(&event, value)| start[event] = value);
        Ok(())
    }

    /// How far behind the end of the step at hand a function passes zero, on a straight line where it follows the state, s; negative where it lies before.
    pub(crate) fn ahead(
        &mut self,
        cx: Context,
        driver: &mut Driver,
        step: &Target,
        event: usize,
    ) -> Result<f64, RunError> {
        const SHORT: f64 = 0.001;
        if self.times.knows(event) {
            return Ok(self.times.ahead(event, step.to));
        }
        let short = SHORT * (step.to - step.from);
        self.go_to(cx, driver, (step.to - short).max(step.from.next_up()), &[event])?;
        let function = &cx.system.watched_events()[event];
        let before = self.value(function);
        self.go_to(cx, driver, step.to, &[event])?;
        let end = self.value(function);
        Ok(short * end / (before - end))
    }
}

/// How closely passages are found, in units of the step.
fn close(step: &Target) -> f64 {
    CLOSE.max(f64::EPSILON * step.to / (step.to - step.from))
}

/// Whether a function that is lowest in the middle of three places may come to zero between them: a parabola falls by less than it rises there.
fn may_dip([first, middle, last]: [f64; 3]) -> bool {
    middle <= first && middle < last && middle < (first - middle) + (last - middle)
}

fn side_of(value: f64) -> i8 {
    if value > 0.0 {
        1
    } else if value < 0.0 {
        -1
    } else {
        0
    }
}
