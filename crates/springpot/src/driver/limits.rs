//! Limits of joints that a motion passes, seen in its rows.

use super::simulation::Simulation;
use crate::model::{Dimension, Limits, Model};
use crate::observe::{Observables, Quantity};
use crate::system::System;
use crate::system::settings::Settings;
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;

/// What is beyond a limit by less than this, in its unit and as a share of it, is rounding.
const ROUNDING: f64 = 1e-9;

/// The limits that a joint may have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LimitKind {
    /// Smallest coordinate.
    Lower,
    /// Largest coordinate.
    Upper,
    /// Largest speed.
    Velocity,
    /// Largest actuator force.
    Effort,
}

impl LimitKind {
    const fn name(self) -> &'static str {
        match self {
            Self::Lower => "lower limit",
            Self::Upper => "upper limit",
            Self::Velocity => "velocity limit",
            Self::Effort => "effort limit",
        }
    }
}

/// One of a few names; behind its own, so that it is read as one of them and not taken from the text that is read.
type UnitName = &'static str;

/// A limit that a joint passes; `Display` is one sentence without full stop.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PassedLimit {
    /// Name of the joint.
    pub joint: String,
    /// Which of its limits.
    pub kind: LimitKind,
    /// The limit, in `unit`.
    pub limit: f64,
    /// rad, m, rad/s, m/s, N*m or N.
    #[serde(deserialize_with = "unit")]
    pub unit: UnitName,
    /// Time of the first row beyond it, s.
    pub first: f64,
    /// Time of the row that is farthest beyond it, s.
    pub farthest: f64,
    /// Coordinate, velocity or actuator force in that row, in `unit`.
    pub value: f64,
}

impl PassedLimit {
    /// How far beyond the limit the value is.
    pub fn excess(&self) -> f64 {
        excess(self.kind, self.limit, self.value)
    }
}

impl fmt::Display for PassedLimit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { joint, kind, limit, unit, first, farthest, .. } = self;
        let (by, kind) = (brief(self.excess()), kind.name());
        write!(f, "joint {joint:?} passes its {kind} {} {unit} at t = {} s, by ", brief(*limit), brief(*first))?;
        if first == farthest {
            write!(f, "{by} {unit}")
        } else {
            write!(f, "up to {by} {unit} at t = {} s", brief(*farthest))
        }
    }
}

/// What a [`LimitWatch`] has seen so far.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Watch(Vec<Option<Passed>>);

/// Watches the rows of a run for joints that pass their limits. What happens between two rows is not seen.
#[derive(Debug, Clone)]
pub struct LimitWatch {
    /// Where rows have their time.
    time: usize,
    watched: Vec<Watched>,
}

/// One limit of one joint.
#[derive(Debug, Clone)]
struct Watched {
    joint: String,
    kind: LimitKind,
    limit: f64,
    unit: &'static str,
    /// Value = ratio · row\[column\] + offset.
    column: usize,
    ratio: f64,
    offset: f64,
    passed: Option<Passed>,
}

#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct Passed {
    first: f64,
    farthest: f64,
    value: f64,
}

impl LimitWatch {
    /// Watches every limit of the robot's joints. A joint that follows another one has no actuator, so no limit of effort.
    pub fn new(system: &System) -> Self {
        let model = &system.model;
        let observables = system.observables();
        let watched = (0..model.joint_count()).flat_map(|joint| of_joint(model, &observables, joint)).collect();
        Self { time: position(&observables, Quantity::Time), watched }
    }

    /// Whether no joint has a limit.
    pub fn is_empty(&self) -> bool {
        self.watched.is_empty()
    }

    /// What was seen so far.
    pub fn seen(&self) -> Watch {
        Watch(self.watched.iter().map(|watched| watched.passed).collect())
    }

    /// Goes on from what another watch of the same robot has seen.
    pub fn go_on(&mut self, Watch(seen): Watch) {
        for (watched, passed) in self.watched.iter_mut().zip(seen) {
            watched.passed = passed;
        }
    }

    /// Looks at one row, in the order of [`System::columns`].
    pub fn see(&mut self, row: &[f64]) {
        for watched in &mut self.watched {
            let value = watched.ratio * row[watched.column] + watched.offset;
            let excess = |value| excess(watched.kind, watched.limit, value);
            // An empty field is beyond nothing.
            if excess(value) > ROUNDING * (1.0 + watched.limit.abs()) {
                let new = Passed { first: row[self.time], farthest: row[self.time], value };
                let passed = watched.passed.get_or_insert(new);
                if excess(value) > excess(passed.value) {
                    *passed = Passed { first: passed.first, ..new };
                }
            }
        }
    }

    /// The limits that were passed, joint by joint.
    pub fn passed(self) -> Vec<PassedLimit> {
        let passed = |Watched { joint, kind, limit, unit, passed, .. }: Watched| {
            passed.map(|Passed { first, farthest, value }| PassedLimit {
                joint,
                kind,
                limit,
                unit,
                first,
                farthest,
                value,
            })
        };
        self.watched.into_iter().filter_map(passed).collect()
    }
}

impl System {
    /// The row at t = 0, in the order of [`System::columns`], whether or not the run has one there; without its forces
    /// where these are not known at once (named schemes).
    ///
    /// # Errors
    /// What keeps a run from starting.
    pub fn first_row(&self, settings: &Settings) -> Result<Vec<f64>, crate::system::error::RunError> {
        let begun = Simulation::at_start(self.clone(), settings.clone());
        if let Ok(snapshot) = begun.and_then(|mut simulation| simulation.snapshot()) {
            return Ok(self.observables().quantities().into_iter().map(|quantity| snapshot.value(quantity)).collect());
        }
        let state = self.state(0.0)?;
        let known = |quantity| match quantity {
            Quantity::Time => 0.0,
            Quantity::Coordinate(k) => state.q[k],
            Quantity::Velocity(k) => state.v[k],
            Quantity::Acceleration(k) => state.a[k],
            _ => f64::NAN,
        };
        Ok(self.observables().quantities().into_iter().map(known).collect())
    }
}

/// Where a quantity that every system has stands in its rows.
fn position(observables: &Observables, quantity: Quantity) -> usize {
    observables.position(quantity).expect("a quantity of every system")
}

fn of_joint(model: &Model, observables: &Observables, joint: usize) -> Vec<Watched> {
    let (q, v) = (model.q_range(joint).start, model.v_range(joint).start);
    let Some(dimension) = model.joint_space(joint).dimension() else { return Vec::new() };
    let units = dimension.units();
    let followed = model.followed(joint);
    let (ratio, offset) = followed.map_or((1.0, 0.0), |(_, ratio, offset)| (ratio, offset));
    let Limits { lower, upper, velocity, effort } = *model.limits(joint);
    let effort = if followed.is_some() { f64::INFINITY } else { effort };
    let all = [
        (LimitKind::Lower, lower, units.coordinate, Quantity::Coordinate(q), offset),
        (LimitKind::Upper, upper, units.coordinate, Quantity::Coordinate(q), offset),
        (LimitKind::Velocity, velocity, units.velocity, Quantity::Velocity(v), 0.0),
        (LimitKind::Effort, effort, units.force, Quantity::Torque(v), 0.0),
    ];
    let finite = all.into_iter().filter(|(_, limit, ..)| limit.is_finite());
    let name = &model.joint_names()[joint];
    let watched = finite.map(|(kind, limit, unit, quantity, offset)| Watched {
        joint: name.clone(),
        kind,
        limit,
        unit,
        column: position(observables, quantity),
        ratio,
        offset,
        passed: None,
    });
    watched.collect()
}

/// How far `value` is beyond a limit; negative within it, NaN for an empty field.
fn excess(kind: LimitKind, limit: f64, value: f64) -> f64 {
    match kind {
        LimitKind::Lower => limit - value,
        LimitKind::Upper => value - limit,
        LimitKind::Velocity | LimitKind::Effort => value.abs() - limit,
    }
}

/// `x` to six digits.
fn brief(x: f64) -> f64 {
    format!("{x:.5e}").parse().unwrap_or(x)
}

/// One of the six units.
fn unit<'de, D: Deserializer<'de>>(deserializer: D) -> Result<&'static str, D::Error> {
    let text = String::deserialize(deserializer)?;
    let units = [Dimension::Length, Dimension::Angle].map(Dimension::units);
    let mut units = units.into_iter().flat_map(|units| [units.coordinate, units.velocity, units.force]);
    let known = units.find(|unit| *unit == text);
    known.ok_or_else(|| serde::de::Error::custom("not a unit of a limit"))
}
