//! Kinks of the elements' forces within a step, such as the engagement of a stop: steps end on them.

use super::zero::first_zero_of;
use crate::collocation::{Cubic, STAGES};
use crate::elements::{Element, ElementBank};
use crate::law::{Guard, InputValue, Point};
use crate::system::System;

/// Where a step is first looked at whose start is on a kink.
const EARLY: f64 = 1.0 / 64.0;

/// How far behind its kink a step may end, in units of what the guard goes over in it.
const SHARE: f64 = 1e-8;

/// The same where it is rounding, in units of that of the stroke.
const ROUNDINGS: f64 = 16.0;

/// Most jumps of which each is this share of the run or less behind the one before.
const MOST_JUMPS: u32 = 1_000;
const CHATTER: f64 = 1e-6;

/// A kink that a step comes upon.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Kink {
    element: usize,
    guard: usize,
    /// Sign of the guard before it.
    sign: f64,
}

/// What is seen of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Seen {
    Nothing,
    /// The first kink is at θ.
    Within(f64, Kink),
    /// It is at the end, or so little before it that nothing is to be gained.
    AtEnd,
}

/// Elements whose forces have kinks.
#[derive(Debug, Default)]
pub(crate) struct Kinks {
    elements: Vec<usize>,
    guards: Vec<Guard>,
    /// Whether forces may jump there.
    may_jump: bool,
    /// Jumps that follow each other closely: the first, the last, and how many.
    jumps: Option<(f64, f64, u32)>,
}

impl Kinks {
    pub(crate) fn of(system: &System) -> Self {
        let has_guards = |element: &Element| {
            let inputs = vec![InputValue::default(); element.inputs.len()];
            element.law.has_guards(&Point { t: 0.0, stroke: 0.0, rate: 0.0, inputs: &inputs })
        };
        let elements = system.elements.iter().enumerate().filter(|(_, element)| has_guards(element));
        Self {
            elements: elements.map(|(e, _)| e).collect(),
            guards: Vec::new(),
            may_jump: system.elements.iter().any(|element| element.law.jumps()),
            jumps: None,
        }
    }

    /// Their numbers.
    pub(crate) fn elements(&self) -> &[usize] {
        &self.elements
    }

    /// Whether what follows a kink starts anew, since a force may jump there.
    pub(crate) fn may_jump(&self) -> bool {
        self.may_jump
    }

    /// Counts a jump at `t` of a run up to `end`; how many there were and within what time, s, where there is no end of them.
    pub(crate) fn count_jump(&mut self, t: f64, end: f64) -> Option<(u32, f64)> {
        let (first, count) = match self.jumps {
            Some((first, last, count)) if t - last <= CHATTER * end => (first, count + 1),
            _ => (t, 1),
        };
        self.jumps = Some((first, t, count));
        (count > MOST_JUMPS).then_some((count, t - first))
    }

    /// Whether there are none.
    pub(crate) fn is_idle(&self) -> bool {
        self.elements.is_empty()
    }

    /// The first kink of the step that the bank was told; `noise` is what a motion that follows from forces rounds each stroke by.
    pub(crate) fn look(&mut self, bank: &ElementBank, noise: impl Fn(usize) -> f64) -> Seen {
        let mut first: Option<(f64, Kink)> = None;
        let mut is_at_end = false;
        for &element in &self.elements {
            let noise = ROUNDINGS * (bank.resolution(element) + noise(element));
            self.guards.clear();
            bank.guards(element, &mut self.guards);
            for (guard, values) in self.guards.iter().enumerate() {
                let largest = values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
                if !values.iter().all(|value| value.is_finite()) || largest <= noise {
                    continue;
                }
                let on_it = values[0].abs() <= noise;
                let cubic = Cubic::through(values);
                let sign = if on_it { cubic.at(EARLY) } else { values[0] }.signum();
                let ahead = if sign < 0.0 { -cubic } else { cubic };
                let found = first_zero_of(&ahead, if on_it { EARLY } else { 0.0 });
                let Some(theta) = found.filter(|theta| *theta > 0.0) else { continue };
                if is_just_behind(values, sign, noise) && theta > 0.9 {
                    is_at_end = true;
                } else if first.is_none_or(|(earliest, _)| theta < earliest) {
                    first = Some((theta, Kink { element, guard, sign }));
                }
            }
        }
        match first {
            Some((theta, kink)) => Seen::Within(theta, kink),
            None if is_at_end => Seen::AtEnd,
            None => Seen::Nothing,
        }
    }

    /// Elements on a kink of which the step that the bank was told ends, `noise` as in [`Self::look`].
    pub(crate) fn at_end(&mut self, bank: &ElementBank, noise: impl Fn(usize) -> f64) -> Vec<usize> {
        let Self { elements, guards, .. } = self;
        let mut ends = |element: &usize| {
            let noise = ROUNDINGS * (bank.resolution(*element) + noise(*element));
            guards.clear();
            bank.guards(*element, guards);
            guards.iter().any(|values| {
                let sign = if values[0].abs() <= noise { values[1] } else { values[0] }.signum();
                moved(values) > noise && is_just_behind(values, sign, noise)
            })
        };
        elements.iter().copied().filter(|element| ends(element)).collect()
    }

    /// How far a kink is away at θ; negative behind it.
    pub(crate) fn value(&mut self, bank: &ElementBank, kink: Kink, theta: f64) -> f64 {
        self.guards.clear();
        bank.guards(kink.element, &mut self.guards);
        kink.sign * Cubic::through(&self.guards[kink.guard]).at(theta)
    }
}

/// How far a guard goes from where it is at the start of the step.
fn moved(values: &Guard) -> f64 {
    values.iter().fold(0.0, |moved: f64, value| moved.max((value - values[0]).abs()))
}

/// Whether a step ends on the kink of a guard, or so little behind it that nothing is to be gained; `sign` is that of the guard before it.
fn is_just_behind(values: &Guard, sign: f64, noise: f64) -> bool {
    (0.0..=(SHARE * moved(values)).max(noise)).contains(&(-sign * values[STAGES]))
}
