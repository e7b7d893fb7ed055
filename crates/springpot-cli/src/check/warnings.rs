//! What deserves a warning at t = 0, gathered over the cases.

use crate::diagnostic;
use crate::numbers::{count, short};
use crate::run::{NAMED_LIMITS, in_cases};
use springpot::integrate::{ElementStart, LimitWatch, System};
use springpot_run::sweep::{CasesPassing, LimitTally};
use springpot_scenario::{Cases, Plan};
use std::ops::RangeInclusive;

/// A stroke at t = 0 beyond this share of the rest length is worth a warning.
const LARGE_STROKE: f64 = 0.2;

/// The starts of the cases that were looked at.
pub(super) struct Warnings {
    pub(super) looked_at: usize,
    elements: Vec<ElementWarnings>,
    limits: LimitTally,
}

struct ElementWarnings {
    name: String,
    length: [f64; 2],
    stroke: [f64; 2],
    large: Option<Found>,
    singular: Option<Found>,
}

/// The first case of several in which something was found.
struct Found {
    index: usize,
    cases: usize,
    start: ElementStart,
    rest_length: f64,
}

impl Warnings {
    pub(super) fn new(plan: &Plan) -> Self {
        let none = [f64::INFINITY, f64::NEG_INFINITY];
        let element = |name: &String| ElementWarnings {
            name: name.clone(),
            length: none,
            stroke: none,
            large: None,
            singular: None,
        };
        let elements = plan.elements.iter().map(|plan| element(&plan.element.name)).collect();
        Self { looked_at: 0, elements, limits: LimitTally::default() }
    }

    /// Takes the start of one case.
    pub(super) fn take(&mut self, index: usize, plan: &Plan, system: &System, starts: &[ElementStart]) {
        if let Ok(row) = system.first_row(&plan.settings) {
            let mut watch = LimitWatch::new(system);
            watch.see(&row);
            self.limits.take(index, &watch.passed());
        }
        for ((element, plan), start) in self.elements.iter_mut().zip(&plan.elements).zip(starts) {
            widen(&mut element.length, start.length);
            widen(&mut element.stroke, start.stroke);
            let found = |found: &mut Option<Found>| {
                let new = || Found { index, cases: 0, start: start.clone(), rest_length: plan.element.rest };
                found.get_or_insert_with(new).cases += 1;
            };
            if start.stroke.abs() > LARGE_STROKE * plan.element.rest {
                found(&mut element.large);
            }
            if start.singular {
                found(&mut element.singular);
            }
        }
    }

    /// Smallest and largest l(0) of an element, m.
    pub(super) fn lengths(&self, element: usize) -> RangeInclusive<f64> {
        let [low, high] = self.elements[element].length;
        low..=high
    }

    /// Smallest and largest x(0) of an element, m.
    pub(super) fn strokes(&self, element: usize) -> RangeInclusive<f64> {
        let [low, high] = self.elements[element].stroke;
        low..=high
    }

    /// Prints the warnings on stderr.
    pub(super) fn print(&self, cases: &Cases) {
        let Self { looked_at, elements, limits } = self;
        diagnostic::robot_warnings(cases);
        let placed = |found: &Found, message: &str| in_cases(cases, *looked_at, found.index, found.cases, message);
        for ElementWarnings { name, large, singular, .. } in elements {
            if let Some(found) = large {
                let Found { start, rest_length, .. } = found;
                let message = format!(
                    "element \"{name}\" starts with a stroke of {} m, more than 20 % of its rest length {} m",
                    short(start.stroke),
                    short(*rest_length)
                );
                let help = "look at rest_length and at the points of from and to, or at the start of the motion";
                diagnostic::warning(placed(found, &message), Some(help.into()));
            }
            if let Some(found) = singular {
                let message = format!(
                    "element \"{name}\" starts with x(0) = {} m and the Riemann-Liouville derivative: its force \
                     is infinite at t = 0 and its energy is not known",
                    short(found.start.stroke)
                );
                let help = "this says that it jumped there from x = 0; derivative = \"caputo\" says that it was held \
                            there before";
                diagnostic::warning(placed(found, &message), Some(help.into()));
            }
        }
        let passing = limits.passing();
        for CasesPassing { passed, case, cases: found } in passing.iter().take(NAMED_LIMITS) {
            diagnostic::warning(in_cases(cases, *looked_at, *case, *found, &passed.to_string()), None);
        }
        if let Some(more @ 1..) = passing.len().checked_sub(NAMED_LIMITS) {
            let more = count(more, "more limit of a joint is", "more limits of joints are");
            diagnostic::warning(format!("{more} passed at the start"), None);
        }
    }
}

fn widen(range: &mut [f64; 2], value: f64) {
    *range = [range[0].min(value), range[1].max(value)];
}
