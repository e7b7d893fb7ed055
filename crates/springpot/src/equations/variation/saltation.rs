//! What parameters change where the motion starts anew: the time of a change moves, and with it what acts before and behind it.
//!
//! Where accelerations jump from a⁻ to a⁺ at a time t* that comes later by δt*, the changes at fixed t jump by δv⁺ = δv⁻ + (a⁻ − a⁺) δt*; places,
//! strokes and memories go on as they are (Galán, Feehery & Barton, Applied Numerical Mathematics 31, 1999).

use super::Variation;
use crate::collocation::STAGES;
use crate::dual::Dual;
use crate::equations::assembly::Equations;
use crate::equations::evaluate::Evaluation;
use crate::equations::node::Node;
use crate::law::{InputValue, Network, Point};
use crate::system::sensitivity::{Lost, Seed, SensitivityError, Switched};
use crate::system::{Action, Event, Motion, Setting};
use serde::{Deserialize, Serialize};

/// Times of one change that differ by less than this share of them are one.
const ONE_TIME: f64 = 1e-9;

/// Accelerations and velocities that differ by less than this share of the largest do not jump: the end of a step knows them as well as its iteration.
const JUMP: f64 = 1e-5;

/// A guard this near its zero is on it, in units of what it goes over in the step.
const ON_IT: f64 = 1e-6;

/// A velocity that changes by no more than accelerations do to it in this share of the time does not jump.
const STILL: f64 = 1e-12;

/// What rounding makes of a stroke, as a share of it and of its coordinate.
const ROUNDINGS: f64 = 256.0 * f64::EPSILON;

const SWITCHES_AT_START: &str = "a function of time switches there, and in another way beside it";

/// A switch this near is here, as a share of the time.
const HERE: f64 = 1e-12;

/// What is known of a change that is about to be crossed, and of those before.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Saltation {
    /// How much later the change at the present time comes, s, where the motion starts anew.
    later: Option<Vec<f64>>,
    /// The accelerations on the near side of that change, where the end of the step has those behind it.
    arrived: Option<Vec<f64>>,
    /// Elements whose inputs jump there, and what these were before.
    jumping: Vec<(usize, Vec<InputValue>)>,
    /// How much later what was crossed last comes, and when that was.
    last: Option<(f64, Vec<f64>)>,
    pub(super) held: SetVariation,
    /// Where derivatives ended, parameter by parameter.
    pub(super) lost: Vec<Option<Lost>>,
}

impl Saltation {
    /// Of so many parameters, before any change.
    pub(super) fn new(count: usize) -> Self {
        Self {
            later: None,
            arrived: None,
            jumping: Vec::new(),
            last: None,
            held: SetVariation::default(),
            lost: vec![None; count],
        }
    }

    /// Every block of it.
    pub(super) fn each_block(&mut self, take: &mut dyn FnMut(&mut [f64])) {
        let Self { later, last, held: SetVariation { drives, inputs }, .. } = self;
        let last = last.iter_mut().map(|(_, later)| later);
        let held = drives.iter_mut().map(|(_, by)| by).chain(inputs.iter_mut().map(|(_, by)| by));
        later.iter_mut().chain(last).chain(held).for_each(|block| take(block));
    }

    /// Whether it is of so many parameters.
    pub(super) fn fits(&self, count: usize) -> bool {
        self.lost.len() == count
    }
}

/// What parameters change of what is held in place of signals: those that are not among them are held at what no parameter moves.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct SetVariation {
    drives: Vec<(usize, Vec<f64>)>,
    inputs: Vec<([usize; 2], Vec<f64>)>,
}

impl SetVariation {
    /// The actuator forces that are held, by their velocities.
    pub(super) fn drives(&self) -> impl Iterator<Item = (usize, &[f64])> {
        self.drives.iter().map(|(k, by)| (*k, &by[..]))
    }

    /// The inputs that are held, by their elements and numbers.
    pub(super) fn inputs(&self) -> impl Iterator<Item = ([usize; 2], &[f64])> {
        self.inputs.iter().map(|(at, by)| (*at, &by[..]))
    }

    /// Of the actuator force on velocity `k`, where it is held.
    pub(super) fn drive(&self, k: usize) -> Option<&[f64]> {
        self.drives.iter().find(|(held, _)| *held == k).map(|(_, by)| &by[..])
    }

    /// Of an input of an element, where it is held.
    pub(super) fn input(&self, element: usize, input: usize) -> Option<&[f64]> {
        self.inputs.iter().find(|(held, _)| *held == [element, input]).map(|(_, by)| &by[..])
    }
}

impl Variation {
    /// Whether the derivatives by parameter `p` exist so far.
    pub(crate) fn knows(&self, p: usize) -> bool {
        self.saltation.lost[p].is_none()
    }

    /// Where derivatives ended, parameter by parameter.
    pub(crate) fn lost(&self) -> &[Option<Lost>] {
        &self.saltation.lost
    }

    /// Whether a change is noted whose far side nobody has gone to.
    pub(crate) fn is_about_to_change(&self) -> bool {
        self.saltation.later.is_some()
    }

    /// Derivatives by parameter `p` end at `t`.
    pub(crate) fn lose(&mut self, p: usize, t: f64, why: &str) {
        self.saltation.lost[p].get_or_insert_with(|| Lost { parameter: p, t, why: why.to_owned() });
    }

    /// Derivatives by all parameters end at `t`.
    pub(crate) fn lose_all(&mut self, t: f64, why: &str) {
        (0..self.count()).for_each(|p| self.lose(p, t, why));
    }

    /// The change at the present time, `t`, comes later by δt* = −δγ/γ̇, parameter by parameter, where a function γ that changes by `of(p)` passes
    /// zero at `speed`.
    pub(crate) fn passes(&mut self, t: f64, speed: f64, of: impl Fn(&Self, usize) -> f64) {
        let later = (0..self.count()).map(|p| Self::later(of(self, p), speed)).collect();
        self.comes_later(t, later);
    }

    /// How much later a function passes zero at `speed` that changes by so much: −δγ/γ̇, 0 where nothing changes.
    pub(crate) fn later(change: f64, speed: f64) -> f64 {
        if change == 0.0 { 0.0 } else { -change / speed }
    }

    /// The change at the present time, `t`, comes later by so much, s, parameter by parameter.
    pub(crate) fn comes_later(&mut self, t: f64, later: Vec<f64>) {
        let known = self.saltation.later.take();
        for p in 0..later.len() {
            let other = known.as_ref().map_or(later[p], |known| known[p]);
            if !later[p].is_finite() {
                self.lose(p, t, "what changes there is reached without speed");
            } else if (later[p] - other).abs() > ONE_TIME * later[p].abs().max(other.abs()) {
                self.lose(p, t, "two changes come at one time, which it moves apart");
            }
        }
        self.saltation.later = Some(later);
    }

    /// These velocities come to rest at the present time, where the robot is `at`.
    pub(crate) fn stop(&mut self, stopping: &[usize], at: &Evaluation) {
        for &k in stopping {
            let row = self.own_v[k];
            self.passes(at.t, at.a[k], |own, p| own.nodes[0].v[row * own.count() + p]);
        }
    }

    /// Forces of elements may jump at the present time, where the robot is `at`, behind a step of size `h`.
    pub(crate) fn hit(&mut self, at: &Evaluation, h: f64) {
        for (e, element) in at.elements.iter().enumerate() {
            if !self.system.elements[e].law.jumps() {
                continue;
            }
            let (value, rate) = (element.stroke, element.reading.rate);
            let guards = |law: &Network, slope: f64| {
                let mut all = Vec::new();
                law.jumps_at(Dual { value, slope }, &mut |guard| all.push(guard));
                all
            };
            let own = guards(&self.system.elements[e].law, rate);
            // A step may be so short that rounding of the coordinate is more.
            let near = ON_IT * h * rate.abs() + ROUNDINGS * (element.reading.coordinate.abs() + value.abs());
            for (g, guard) in own.iter().enumerate().filter(|(_, guard)| guard.value.abs() <= near) {
                let change = |own: &Self, p: usize| {
                    let law = own.law_by(e, p).unwrap_or(&own.system.elements[e].law);
                    guards(law, own.elements[e].stroke[p])[g].slope
                };
                self.passes(at.t, guard.slope, change);
            }
        }
    }

    /// Functions of time that switch at t = 0, where a parameter moves that.
    pub(super) fn switch_at_start(&mut self) {
        let by = self.by.clone();
        for (p, parameter) in by.parameters.iter().enumerate() {
            let moves = |seed: &Seed| match seed {
                Seed::Switch { argument, by, .. } => argument.value(0.0) == 0.0 && by.value(0.0) != 0.0,
                _ => false,
            };
            if parameter.seeds.iter().any(moves) {
                self.lose(p, 0.0, SWITCHES_AT_START);
            }
        }
    }

    /// Functions of time switch between two times, `before` and `t`, those that `switches` says.
    pub(crate) fn switch(
        &mut self,
        equations: &Equations,
        [before, t]: [f64; 2],
        switches: impl Fn(Switched) -> bool,
        sources: &[Switched],
    ) {
        self.catch_up(equations);
        let by = self.by.clone();
        let mut later = vec![0.0; self.count()];
        for (p, parameter) in by.parameters.iter().enumerate() {
            let (mut own, mut moved) = (Vec::new(), false);
            for seed in &parameter.seeds {
                let Seed::Switch { of, argument, by } = seed else { continue };
                let at = argument.at(if before == 0.0 { 0.0 } else { t });
                let is_here = (at.value / at.first).abs() <= HERE * t || at.first == 0.0 && at.value == 0.0;
                if !is_here || !switches(*of) {
                    continue;
                }
                let own_later = -by.value(t) / at.first;
                if before == 0.0 || !own_later.is_finite() {
                    self.lose(p, t, SWITCHES_AT_START);
                } else if moved && (own_later - later[p]).abs() > ONE_TIME * own_later.abs() {
                    self.lose(p, t, "two functions of time switch at one time, which it moves apart");
                }
                (later[p], moved) = (own_later, true);
                own.push(*of);
            }
            if moved && later[p] != 0.0 && sources.iter().any(|source| switches(*source) && !own.contains(source)) {
                self.lose(p, t, "another function of time switches at the same time, which it does not move");
            }
        }
        if later.iter().any(|later| *later != 0.0) {
            self.comes_later(t, later);
            for source in sources.iter().filter(|source| switches(**source)) {
                if let Switched::Input { element, .. } = source {
                    self.note_inputs(equations, *element, t);
                }
            }
        }
    }

    /// An input of element `e` jumps with the change at the present time, `t`; the bank has what it was before at the end of the last step.
    pub(crate) fn note_inputs(&mut self, equations: &Equations, e: usize, t: f64) {
        let (element, at) = (&self.system.elements[e], equations.bank.point(e, STAGES));
        let state = equations.bank.law_state(e);
        if state.and_then(|state| element.law.rates(&at, state)).is_some() {
            self.saltation.jumping.push((e, at.inputs.to_vec()));
            return;
        }
        let name = &element.name;
        let why =
            format!("an input of \"{name}\" jumps at a time that it moves, and the law has more inside than it tells");
        let later = self.saltation.later.clone().unwrap_or_default();
        (0..later.len()).filter(|p| later[*p] != 0.0).for_each(|p| self.lose(p, t, &why));
    }

    /// Inner variables of laws whose inputs jump go on with other rates: δz⁺ = δz⁻ + (z'⁻ − z'⁺) δt*.
    fn turn_inner_variables(&mut self, equations: &Equations, later: &[f64]) {
        let known: Vec<f64> = later.iter().map(|later| if later.is_finite() { *later } else { 0.0 }).collect();
        for (e, inputs) in std::mem::take(&mut self.saltation.jumping) {
            let (law, at) = (&self.system.elements[e].law, equations.bank.point(e, 0));
            let Some(state) = equations.bank.law_state(e) else { continue };
            let sides = [Point { inputs: &inputs, ..at }, at];
            let [before, after] = sides.map(|at| law.rates(&at, state).unwrap_or_default());
            self.elements[e].law.jump([&before, &after], &known);
        }
    }

    /// Adds what parameters change of the function of an event on a branch, at t and where its columns have these values.
    pub(crate) fn add_when(&self, number: usize, (branch, t): (u64, f64), columns: &[f64], changes: &mut [f64]) {
        let own = self.of_seeds(|seed| match seed {
            Seed::When { event, by } if *event == number => by.value_on(branch, t, columns),
            Seed::WhenOfTime { event, by } if *event == number => by.value(t),
            _ => 0.0,
        });
        changes.iter_mut().zip(own).for_each(|(change, own)| *change += own);
    }

    /// An event sets what it sets, at `t`, later by so much, s.
    pub(crate) fn set(&mut self, equations: &Equations, (number, event): (usize, &Event), (t, later): (f64, Vec<f64>)) {
        let Action::Set(settings) = &event.action else { return };
        self.comes_later(t, later);
        for (k, setting) in settings.iter().enumerate() {
            let own = |seed: &Seed| match seed {
                Seed::Set { event, setting, by } if (*event, *setting) == (number, k) => *by,
                _ => 0.0,
            };
            let by = self.of_seeds(own);
            match *setting {
                Setting::Torque { velocity, .. } => {
                    self.saltation.held.drives.retain(|(held, _)| *held != velocity);
                    self.saltation.held.drives.push((velocity, by));
                }
                Setting::Input { element, input, .. } => {
                    self.hold_input([element, input], Some(by));
                    self.note_inputs(equations, element, t);
                }
            }
        }
    }

    /// An input is held from outside, or given back to its signal; it changes by so much.
    pub(crate) fn hold_input(&mut self, at: [usize; 2], by: Option<Vec<f64>>) {
        self.saltation.held.inputs.retain(|(held, _)| *held != at);
        self.saltation.held.inputs.extend(by.map(|by| (at, by)));
    }

    /// A step ends in which accelerations were `a` at its start, so short that they were so until the change behind it.
    pub(crate) fn arrive(&mut self, a: &[f64]) {
        self.saltation.arrived = Some(a.to_vec());
    }

    /// Goes to the far side of what was crossed, `start`, where velocities and accelerations were those `before` and are those `after`; at a
    /// change of the robot's own, whose time nobody gave beforehand, where `is_own`.
    ///
    /// # Errors
    /// What is kept of a controller's errors and cannot go on.
    pub(crate) fn settle(
        &mut self,
        equations: &Equations,
        start: Node,
        [before, after]: [[&[f64]; 2]; 2],
        is_own: bool,
    ) -> Result<(), SensitivityError> {
        self.catch_up(equations);
        let count = self.count();
        let ([v, a], [v_after, a_after]) = (before, after);
        let arrived = self.saltation.arrived.take();
        let a = arrived.as_deref().unwrap_or(a);
        // Where friction catches a joint, what its velocity had left is no jump.
        let is_moved = |k: usize| {
            let left = STILL * start.t * a_after[k].abs().max(a[k].abs());
            !equations.free().contains(&k) && (v_after[k] - v[k]).abs() > left
        };
        if jumps(JUMP, v, v_after, is_moved) {
            self.follow_jump(start.t, [v, v_after]);
        }
        match self.saltation.later.take() {
            Some(later) => {
                for (k, (before, after)) in a.iter().zip(a_after).enumerate() {
                    let blocks = self.own_v[k] * count..;
                    let changes = self.nodes[0].v[blocks].iter_mut().zip(&later).filter(|(_, later)| later.is_finite());
                    changes.for_each(|(v, later)| *v += (before - after) * later);
                }
                self.turn_inner_variables(equations, &later);
                self.cross_works(equations, &later);
                self.saltation.last = Some((start.t, later));
            }
            None if is_own && jumps(JUMP, a, a_after, |_| true) => self.lose_all(start.t, "forces jump there"),
            None => {
                self.saltation.jumping.clear();
                self.saltation.last = None;
            }
        }
        self.hold_still(equations);
        if let (Some(control), Some(run)) = (&mut self.control, &equations.control) {
            let [node, ..] = &self.nodes;
            control.settle(run, start.t, [&node.q, &node.v])?;
        }
        self.see_start(equations, start);
        if let Some(one_size) = &mut self.one_size {
            one_size.accelerated = [false; 2];
            return Ok(());
        }
        self.accelerate(equations);
        self.restart_singular(equations);
        Ok(())
    }

    /// Velocities that forces move jump at `t`, from before to after, with those of joints that signals move: M_ff Δv_f = −M_fp Δv_p.
    ///
    /// δΔv_f = −M_ff⁻¹ (δM Δv)_f, at a time that no parameter moves; where one does, strokes go on in another way from there on.
    fn follow_jump(&mut self, t: f64, [before, after]: [&[f64]; 2]) {
        let later = self.saltation.later.clone().unwrap_or_default();
        for p in (0..later.len()).filter(|p| later[*p] != 0.0) {
            self.lose(p, t, "velocities jump with that of a joint that a signal moves, at a time that it moves");
        }
        let (count, n) = (self.count(), self.nv());
        let Motion::Forward(forward) = &self.system.motion else { return };
        let free = forward.free_velocities(&self.system.model);
        let mut jump = vec![0.0; n];
        for (&k, (before, after)) in self.own_v.iter().zip(before.iter().zip(after)) {
            jump[k] = after - before;
        }
        let owed = self.change_of_mass(&jump);
        let mut change = vec![0.0; n * count];
        let [start, ..] = &self.nodes;
        if !self.room.solve.factor_part(&start.slopes.d_a, n, &free) {
            return self.lose_all(t, "velocities jump with that of a joint that a signal moves");
        }
        self.solve_free(&free, &owed, &mut change);
        let [start, ..] = &mut self.nodes;
        start.v.iter_mut().zip(change).for_each(|(v, change)| *v += change);
    }

    /// How much later what was crossed last comes, s, where that was at `t`.
    pub(crate) fn crossed(&self, t: f64) -> Vec<f64> {
        match &self.saltation.last {
            Some((at, later)) if (t - at).abs() <= HERE * t => later.clone(),
            _ => vec![0.0; self.count()],
        }
    }

    /// What friction holds stays at rest.
    pub(super) fn hold_still(&mut self, equations: &Equations) {
        let count = self.count();
        if self.one_size.is_some() {
            // Steps of one size find anew what is held in each.
            return;
        }
        for (k, &row) in self.own_v.iter().enumerate() {
            if equations.holds(k) {
                self.nodes[0].v[row * count..(row + 1) * count].fill(0.0);
            }
        }
    }
}

/// Whether one of the numbers that count jumps by more than this share of the largest.
pub(super) fn jumps(share: f64, before: &[f64], after: &[f64], counts: impl Fn(usize) -> bool) -> bool {
    let largest = before.iter().chain(after).fold(0.0, |largest: f64, x| largest.max(x.abs()));
    let pairs = before.iter().zip(after).enumerate().filter(|(k, _)| counts(*k));
    pairs.fold(0.0, |jump: f64, (_, (before, after))| jump.max((before - after).abs())) > share * largest
}
