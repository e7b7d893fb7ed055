//! On which side of zero the functions of events are, and where they pass it in a step.

use super::Event;
use crate::integrate::context::Context;
use crate::integrate::driver::Driver;
use crate::integrate::error::RunError;
use crate::integrate::stepper::Target;
use crate::integrate::system::Motion;
use crate::integrate::zero::{SAMPLES, lowest_between, zero_within};
use crate::observe::Snapshot;
use serde::{Deserialize, Serialize};

/// Where a step is looked at besides, where some function has just left zero.
const EARLY: [f64; 2] = [1.0 / 1024.0, 1.0 / 64.0];

/// How closely passages are found, in units of the step.
const CLOSE: f64 = 1e-13;

/// A value is zero that rounding of its columns may have made: this share of them, and so much in SI.
const ROUNDING: f64 = 1e-12;
const LEAST: f64 = 1e-14;

/// A function has passed zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Passage {
    pub(super) event: usize,
    pub(super) t: f64,
    pub(super) rises: bool,
}

impl Sides {
    /// Whether they were ever looked at.
    pub(super) fn is_known(&self) -> bool {
        !self.signs.is_empty()
    }
}

/// What is asked for values.
#[derive(Debug)]
pub(super) struct Functions<'s> {
    pub(super) cx: Context<'s>,
    pub(super) events: &'s [Event],
    snapshot: Snapshot,
    columns: Vec<f64>,
}

/// Of every event, what outlasts a step.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct Sides {
    /// Sign of the function; 0 until it has left zero.
    pub(super) signs: Vec<i8>,
    /// Its value at the present time.
    values: Vec<f64>,
}

impl<'s> Functions<'s> {
    pub(super) fn new(cx: Context<'s>) -> Self {
        let events: &[Event] = match cx.system.motion {
            Motion::Given(_) => &[],
            Motion::Forward(_) => &cx.system.events,
        };
        Self { cx, events, snapshot: Snapshot::new(cx.system), columns: Vec::new() }
    }

    /// Whether a passage is in the direction of its event.
    pub(super) fn counts(&self, passage: &Passage) -> bool {
        self.events[passage.event].direction.counts(passage.rises)
    }

    /// Goes to a time of the step at hand, or to the present one.
    pub(super) fn go_to(&mut self, cx: Context, driver: &mut Driver, t: f64) -> Result<(), RunError> {
        driver.read(cx, t, 0, &mut self.snapshot).map(|_| ())
    }

    /// The function of an event there.
    pub(super) fn value(&mut self, event: usize) -> f64 {
        let Event { when, columns, .. } = &self.events[event];
        self.columns.clear();
        self.columns.extend(columns.iter().map(|quantity| self.snapshot.value(*quantity)));
        when.value(self.snapshot.t(), &self.columns)
    }

    /// Its side there: 0 where it is zero but for rounding, or no number.
    fn clear_side(&mut self, event: usize) -> i8 {
        let value = self.value(event);
        let (when, t) = (&self.events[event].when, self.snapshot.t());
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
    pub(super) fn look_now(
        &mut self,
        cx: Context,
        driver: &mut Driver,
        Sides { signs, values }: &mut Sides,
    ) -> Result<Vec<Passage>, RunError> {
        let t = driver.reached();
        self.go_to(cx, driver, t)?;
        signs.resize(self.events.len(), 0);
        let mut passages = Vec::new();
        for (event, sign) in signs.iter_mut().enumerate() {
            let now = self.clear_side(event);
            if *sign != 0 && now == -*sign {
                passages.push(Passage { event, t, rises: now > 0 });
            }
            // Where a step ends at an event, the function is as near to zero as times can be told.
            let near = values.get(event).map_or(0.0, |value| 2.0 * value.abs());
            if now != 0 && (*sign != 0 || self.value(event).abs() > near) {
                *sign = now;
            }
        }
        *values = self.values()?;
        Ok(passages)
    }

    /// The functions of all events there.
    ///
    /// # Errors
    /// [`RunError::NotFinite`] of a function whose columns are numbers, but for t = 0.
    fn values(&mut self) -> Result<Vec<f64>, RunError> {
        let mut values = Vec::with_capacity(self.events.len());
        for (k, event) in self.events.iter().enumerate() {
            let (value, t) = (self.value(k), self.snapshot.t());
            if !value.is_finite() && t > 0.0 && self.columns.iter().all(|column| column.is_finite()) {
                let what = format!("`when` of event \"{}\"", event.name);
                return Err(RunError::NotFinite { t, what, value });
            }
            values.push(value);
        }
        Ok(values)
    }

    /// The passages in the step at hand in the order of their times; the sides are taken to its end.
    ///
    /// A function that leaves zero does not pass it. Two passages between two of the places that are looked at are seen where the function is lower
    /// at one of them than at its neighbours.
    pub(super) fn look(
        &mut self,
        cx: Context,
        driver: &mut Driver,
        step: &Target,
        Sides { signs, values: start }: &mut Sides,
    ) -> Result<Vec<Passage>, RunError> {
        let mut passages = Vec::new();
        // At the very start of a step no law is asked.
        let close = CLOSE.max(f64::EPSILON * step.to / (step.to - step.from));
        let early = EARLY.into_iter().filter(|_| signs.contains(&0)).collect::<Vec<_>>();
        // The two places before, and the values there.
        let mut before = [(f64::NAN, vec![f64::NAN; start.len()]), (0.0, std::mem::take(start))];
        for theta in early.into_iter().chain((1..=SAMPLES).map(|i| i as f64 / SAMPLES as f64)) {
            self.go_to(cx, driver, time(step, theta))?;
            let values = self.values()?;
            for (event, sign) in signs.iter_mut().enumerate() {
                if *sign == 0 {
                    self.go_to(cx, driver, time(step, theta))?;
                    *sign = self.clear_side(event);
                    continue;
                }
                let side = f64::from(*sign);
                let [first, left] = [0, 1].map(|k| (before[k].0, side * before[k].1[event]));
                let here = (theta, side * values[event]);
                let mut failed = None;
                let mut at = |theta: f64| match self.go_to(cx, driver, time(step, theta.max(0.5 * close))) {
                    Ok(()) => side * self.value(event),
                    Err(error) => {
                        failed.get_or_insert(error);
                        f64::NAN
                    }
                };
                let mut note = |theta: f64, rises: bool| passages.push(Passage { event, t: time(step, theta), rises });
                if here.1 <= 0.0 {
                    note(zero_within(&mut at, left.0, here.0, close), side < 0.0);
                    *sign = side_of(values[event]);
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
            before[1] = (theta, values);
        }
        let [_, (_, end)] = before;
        *start = end;
        passages.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.event.cmp(&b.event)));
        Ok(passages)
    }

    /// How far behind the end of the step at hand a function passes zero on a straight line, s; negative where it lies before.
    pub(super) fn ahead(
        &mut self,
        cx: Context,
        driver: &mut Driver,
        step: &Target,
        event: usize,
    ) -> Result<f64, RunError> {
        const SHORT: f64 = 0.001;
        self.go_to(cx, driver, time(step, 1.0 - SHORT))?;
        let before = self.value(event);
        self.go_to(cx, driver, step.to)?;
        let end = self.value(event);
        Ok(SHORT * (step.to - step.from) * end / (before - end))
    }
}

/// Whether a function that is lowest in the middle of three places may come to zero between them: a parabola falls by less than it rises there.
fn may_dip([first, middle, last]: [f64; 3]) -> bool {
    middle <= first && middle < last && middle < (first - middle) + (last - middle)
}

fn time(step: &Target, theta: f64) -> f64 {
    if theta == 1.0 { step.to } else { (step.from + theta * (step.to - step.from)).clamp(step.from.next_up(), step.to) }
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
