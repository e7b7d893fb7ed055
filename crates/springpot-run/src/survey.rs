//! What is known of the cases before any of them is run: where elements start, and which cases cannot.

use crate::checks;
use crate::numbers::short;
use crate::sweep::LimitTally;
use crate::trouble::Trouble;
use springpot::control::Aim;
use springpot::driver::LimitWatch;
use springpot::dynamics::Kinematics;
use springpot::equations::ElementStart;
use springpot::model::{Dimension, Space};
use springpot::system::{RowTimes, RunError, Stop, System};
use springpot_scenario::{Cases, ElementPlan, Plan, Refusals, Remark, ShapePlan};
use std::ops::RangeInclusive;

/// A stroke at t = 0 beyond this share of the rest length is worth a warning.
const LARGE_STROKE: f64 = 0.2;
/// Values of each sweep that are looked at; fewer where a gripper path must be followed for each.
const LOOKED_AT: usize = 1_000;
const PATHS_FOLLOWED: usize = 50;

/// A revolute joint that turns faster on average, rad/s, and farther, rad, may have been given in degrees; and at how many times it is looked at.
const FAST_TURN: f64 = 10.0;
const FAR_TURN: f64 = 12.0;
/// As an angle of a scenario, rad, at the start.
const FAR_START: f64 = 4.0 * std::f64::consts::PI;
const TURNS_LOOKED_AT: u32 = 257;

/// So many warnings are enough.
const MOST_WARNINGS: usize = 20;

/// How closely cases are looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Depth {
    /// Where they start.
    Starts,
    /// Also the limits of joints there, and whether gripper paths can be followed to their end.
    Paths,
}

/// The first case, and each other value of each sweep with the rest at their first values.
#[derive(Debug)]
pub struct Survey {
    /// Number of cases that were looked at.
    pub looked_at: usize,
    /// By element.
    pub elements: Vec<ElementSurvey>,
    /// Joints that start beyond their limits; of [`Depth::Paths`].
    pub limits: LimitTally,
    /// Cases that cannot run, each with why.
    pub failures: Vec<(usize, Trouble)>,
    /// How many of them ask of a controller what none can do: the scenario is to be refused where no case is left.
    pub refused: usize,
    /// Whether it was broken off.
    pub interrupted: bool,
    /// Whether the run ends before its second row is due; the end and the distance of the rows, s.
    pub short: Option<[f64; 2]>,
    /// What deserves a warning in the sweeps, and in files, geometry and motion of the cases looked at, each of which is named but for the first.
    pub warnings: Vec<(usize, Remark)>,
    /// Every element where the first case starts.
    pub first: Option<Vec<ElementStart>>,
}

/// The starts of one element.
#[derive(Debug)]
pub struct ElementSurvey {
    /// The element.
    pub name: String,
    /// Unit of its coordinate and stroke.
    pub unit: &'static str,
    /// The key of the scenario that says where it rests.
    pub rest_key: &'static str,
    length: [f64; 2],
    stroke: [f64; 2],
    /// It starts far from its rest length.
    pub large: Option<Found>,
    /// It starts with an infinite force.
    pub singular: Option<Found>,
}

/// The first case of several in which something was found.
#[derive(Debug)]
pub struct Found {
    /// The case.
    pub index: usize,
    /// How many there are.
    pub cases: usize,
    /// Where the element starts.
    pub start: ElementStart,
    /// Its rest length, m.
    pub rest_length: f64,
}

impl Survey {
    /// Looks at the cases; `plan` and `system` are the first one. Cases whose combination of values is refused are left out.
    ///
    /// # Errors
    /// Of [`Depth::Paths`]: the refusals of a combination of values.
    pub fn of(cases: &Cases, plan: &Plan, system: &System, depth: Depth, stop: &Stop) -> Result<Self, Refusals> {
        let none = [f64::INFINITY, f64::NEG_INFINITY];
        let element = |plan: &ElementPlan| ElementSurvey {
            name: plan.element.name.clone(),
            unit: if plan.element.measure.is_rotation() { "rad" } else { "m" },
            rest_key: if matches!(plan.shape, ShapePlan::Points(_)) { "rest_length" } else { "rest" },
            length: none,
            stroke: none,
            large: None,
            singular: None,
        };
        let mut survey = Self {
            looked_at: 0,
            elements: plan.all_elements().into_iter().map(element).collect(),
            limits: LimitTally::default(),
            failures: Vec::new(),
            refused: 0,
            interrupted: false,
            short: short_run(plan),
            warnings: cases.remarks().into_iter().map(|remark| (0, remark)).collect(),
            first: None,
        };
        for index in looked_at(cases, plan, depth) {
            if survey.interrupted {
                break;
            }
            if index == 0 {
                let along = checks::elements(plan, system)
                    .into_iter()
                    .chain(fast_turns(plan, system))
                    .chain(far_starts(plan, system));
                survey.remark(0, plan.warnings.iter().cloned().chain(checks::sizes(plan, system)).chain(along));
                survey.look(index, plan, system, depth, stop);
                continue;
            }
            match cases.plan(index) {
                Ok(plan) => {
                    let system = if depth == Depth::Paths { plan.system() } else { plan.system_at_start() };
                    let system = system.sharing(cases.shared());
                    survey.remark(index, plan.warnings.iter().cloned().chain(checks::sizes(&plan, &system)));
                    survey.look(index, &plan, &system, depth, stop);
                }
                Err(refusals) if depth == Depth::Paths => return Err(refusals),
                Err(_) => {}
            }
        }
        Ok(survey)
    }

    fn look(&mut self, index: usize, plan: &Plan, system: &System, depth: Depth, stop: &Stop) {
        self.looked_at += 1;
        match system.element_starts() {
            Ok(starts) => {
                self.take(index, plan, &starts);
                if index == 0 {
                    self.first = Some(starts);
                }
            }
            Err(error) => return self.failures.push((index, Trouble::of(&error, plan))),
        }
        let mut watch = LimitWatch::new(system);
        if depth == Depth::Paths
            && !watch.is_empty()
            && let Ok(row) = system.first_row(&plan.settings)
        {
            watch.see(&row);
            self.limits.take(index, &watch.passed());
        }
        let ends_early = || match system.motion.has_path() {
            true => system.pose(plan.settings.end).err(),
            false => reference_ends(system, plan.settings.end),
        };
        let failure = match depth {
            // A path that jumps is told as such, as a run tells it, before it is followed.
            Depth::Paths => system.look_for_jumps(&plan.settings, stop).err().or_else(ends_early),
            Depth::Starts => system.look_for_jumps(&plan.settings, stop).err(),
        };
        match failure {
            None => {}
            Some(RunError::Interrupted { .. }) => self.interrupted = true,
            Some(failure) => {
                self.refused += usize::from(matches!(failure, RunError::ReferenceJump { .. }));
                self.failures.push((index, Trouble::of(&failure, plan)));
            }
        }
    }

    /// Takes warnings of one case, of each place the first.
    fn remark(&mut self, index: usize, remarks: impl IntoIterator<Item = Remark>) {
        for remark in remarks {
            let is_told = |(_, told): &(usize, Remark)| match (&told.place, &remark.place) {
                (Some(told), Some(place)) => {
                    told == place || *told.source == *place.source && place.source.name.starts_with("--")
                }
                _ => told.message == remark.message,
            };
            if self.warnings.len() < MOST_WARNINGS && !self.warnings.iter().any(is_told) {
                self.warnings.push((index, remark));
            }
        }
    }

    /// Takes the start of one case.
    fn take(&mut self, index: usize, plan: &Plan, starts: &[ElementStart]) {
        for ((place, plan), start) in plan.placed_elements().zip(starts) {
            let element = &mut self.elements[place];
            widen(&mut element.length, start.length);
            widen(&mut element.stroke, start.stroke);
            let found = |found: &mut Option<Found>| {
                let new = || Found { index, cases: 0, start: start.clone(), rest_length: plan.element.rest };
                found.get_or_insert_with(new).cases += 1;
            };
            let is_length = matches!(plan.shape, ShapePlan::Points(_));
            if is_length && start.stroke.abs() > LARGE_STROKE * plan.element.rest {
                found(&mut element.large);
            }
            if start.singular {
                found(&mut element.singular);
            }
        }
    }

    /// Whether every case is known not to run to its end.
    pub fn is_hopeless(&self, cases: &Cases) -> bool {
        self.failures.len() == cases.len()
    }
}

impl ElementSurvey {
    /// Smallest and largest l(0), m.
    pub fn lengths(&self) -> RangeInclusive<f64> {
        self.length[0]..=self.length[1]
    }

    /// Smallest and largest x(0), m.
    pub fn strokes(&self) -> RangeInclusive<f64> {
        self.stroke[0]..=self.stroke[1]
    }
}

/// The first case, and each other value of each sweep with the rest at their first values.
fn looked_at(cases: &Cases, plan: &Plan, depth: Depth) -> Vec<usize> {
    let most = if depth == Depth::Paths && plan.motion.solves_path() { PATHS_FOLLOWED } else { LOOKED_AT };
    let mut indices = vec![0];
    let mut stride = cases.len();
    for axis in 0..cases.axis_count() {
        let count = cases.axis_len(axis);
        stride /= count;
        indices.extend((1..count.min(most)).map(|k| k * stride));
    }
    indices
}

/// Why the reference of a controller cannot be followed to the end.
fn reference_ends(system: &System, end: f64) -> Option<RunError> {
    let controlled = system.control.controller.as_ref()?;
    let (mut kinematics, mut aim) = (Kinematics::new(&system.model), Aim::default());
    controlled.reference.at_into(&system.model, None, end, &mut kinematics, &mut aim).err().map(RunError::from)
}

/// End and distance of the rows where no second row is due before the end.
fn short_run(plan: &Plan) -> Option<[f64; 2]> {
    match &plan.settings.rows {
        RowTimes::Step { step, end } if step > end => Some([*end, *step]),
        _ => None,
    }
}

/// What joints measure that turn, but not without end.
const ANGLE: Space = Space::Line(Dimension::Angle);

/// Joints whose own motion begins many turns away, in an expression without a unit.
fn far_starts(plan: &Plan, system: &System) -> Vec<Remark> {
    let Ok(state) = system.state(0.0) else { return Vec::new() };
    let turning = system.model.own_joints().filter(|j| system.model.joint_space(*j) == ANGLE);
    let remarks = turning.filter_map(|j| {
        let (name, angle) = (&system.model.joint_names()[j], state.q[system.model.q_range(j).start]);
        let place = plan.motion.place_of(name);
        // Without a motion of its own the place is that of all; with a unit, what is written is meant.
        let is_own =
            place != plan.motion.place_of("") && !["deg", "rad"].iter().any(|unit| place.text().contains(unit));
        (is_own && angle.abs() > FAR_START).then(|| {
            let turns = angle.abs() / std::f64::consts::TAU;
            let message =
                format!("joint \"{name}\" starts at {} without a unit: rad, and so {turns:.1} turns", short(angle));
            let help =
                "if its motion is in degrees, write { expression = \"…\", unit = \"deg\" }; if not, unit = \"rad\"";
            Remark::at(place, message).help(help)
        })
    });
    remarks.collect()
}

/// Joints that turn by tens of radians per second over the whole run, as where degrees are taken for radians.
fn fast_turns(plan: &Plan, system: &System) -> Vec<Remark> {
    if plan.motion.is_forward() || plan.motion.has_path() {
        return Vec::new();
    }
    let nv = system.model.nv();
    let (mut speeds, mut lowest, mut highest) = (vec![0.0; nv], vec![f64::INFINITY; nv], vec![f64::NEG_INFINITY; nv]);
    for k in 0..TURNS_LOOKED_AT {
        let t = plan.settings.end * f64::from(k) / f64::from(TURNS_LOOKED_AT);
        let Ok(state) = system.state(t) else { return Vec::new() };
        for j in system.model.own_joints().filter(|j| system.model.joint_space(*j) == ANGLE) {
            let (q, v) = (state.q[system.model.q_range(j).start], system.model.v_range(j).start);
            speeds[v] += state.v[v].abs() / f64::from(TURNS_LOOKED_AT);
            (lowest[v], highest[v]) = (lowest[v].min(q), highest[v].max(q));
        }
    }
    let fast = system.model.own_joints().filter_map(|j| {
        let v = system.model.v_range(j).start;
        let name = &system.model.joint_names()[j];
        (speeds[v] > FAST_TURN && highest[v] - lowest[v] > FAR_TURN).then(|| {
            let message = format!("joint \"{name}\" turns by {:.0} rad/s on average", speeds[v]);
            let help = "if its motion is in degrees, say so with unit = \"deg\"";
            Remark::at(plan.motion.place_of(name), message).help(help)
        })
    });
    fast.collect()
}

fn widen(range: &mut [f64; 2], value: f64) {
    *range = [range[0].min(value), range[1].max(value)];
}
