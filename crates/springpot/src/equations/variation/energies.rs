//! What parameters change of what is dissipated, supplied and lost since t = 0.

use super::adjoint::keeps_works;
use super::seen::felt;
use super::{ROW, Variation, at_start, of_step};
use crate::collocation::{Nodes, STAGES};
use crate::dynamics::{coriolis, gravity, kinetic_energy, potential_energy};
use crate::equations::assembly::Equations;
use crate::equations::resistance::{direction, each_loss_slope};
use crate::law::variation::{ObservationVariation, PowersVariation};
use crate::law::{Point, Power, Powers};
use crate::observe::Quantity;
use crate::signal::Signal;
use crate::system::sensitivity::{Seed, Sensitivity};
use crate::system::{Action, Event, Motion, Setting};
use serde::{Deserialize, Serialize};

/// What is stored at most in an end that is just hit, in units of what it would take in the time so far.
const NOTHING: f64 = 1e-13;

/// Change of a power between two steps, in units of it, that is none.
const GOES_ON: f64 = 1e-4;

/// What parameters change of works.
#[derive(Debug)]
pub(super) struct Works {
    /// Whether somebody asks for them.
    is_kept: bool,
    /// Those of the steps that are over.
    done: WorksDone,
    /// Flows of the step at hand, once asked for.
    flows: Option<Flows>,
    /// At the row: of every element dissipated and supplied, and what joints lost.
    row: (Vec<[Vec<f64>; 2]>, Vec<f64>),
}

/// What of it outlasts a step: blocks of parameters.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct WorksDone {
    /// Of every element, dissipated and supplied since t = 0.
    elements: Vec<[Vec<f64>; 2]>,
    /// Lost in joints since t = 0.
    joints: Vec<f64>,
    /// Kinetic, potential and stored energy at t = 0.
    origin: Vec<f64>,
    /// What was crossed before the step at hand.
    crossed: Option<Crossed>,
    /// What every element dissipated and was supplied with at the end of the last step, W.
    last: Vec<[f64; 2]>,
}

/// A change that comes later by so much, s, and what every element dissipated and was supplied with before, W; of one whose force jumps by how much less
/// it dissipates behind it, where that is known.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Crossed {
    later: Vec<f64>,
    before: Vec<([f64; 2], Option<f64>)>,
}

/// What changes of the flows of a step: of every element dissipated and supplied, and of what joints lose.
#[derive(Debug)]
enum Flows {
    /// At the start and at the nodes.
    AtNodes { elements: Vec<[Vec<f64>; 2]>, joints: Vec<f64> },
    /// Of a step that integrated them itself: one block behind the other, what comes of them in the whole step and until the row.
    Integrated { whole: Vec<f64>, row: Vec<f64>, last: Vec<[f64; 2]> },
}

impl Works {
    /// Of steps of one size, whose flows are told at their ends alone, nothing is kept.
    pub(super) fn new(by: &Sensitivity, elements: usize, has_fixed_steps: bool) -> Self {
        let count = by.parameters.len();
        let asked: Vec<Quantity> = by.columns.iter().map(|column| column.of).collect();
        let asks = match &by.adjoint {
            Some(quantities) => keeps_works(quantities),
            // Who names no columns asks for any of them.
            None => asked.is_empty() || keeps_works(&asked),
        };
        let blocks = || vec![0.0; count];
        let each = || (0..elements).map(|_| [blocks(), blocks()]).collect();
        Self {
            is_kept: !has_fixed_steps && asks,
            done: WorksDone { elements: each(), joints: blocks(), origin: blocks(), crossed: None, last: Vec::new() },
            flows: None,
            row: (each(), blocks()),
        }
    }

    /// The flows of another step are asked for from now on.
    pub(super) fn forget(&mut self) {
        self.flows = None;
    }

    /// Every block that steps change.
    pub(super) fn each_block(&mut self, take: &mut dyn FnMut(&mut [f64])) {
        if !self.is_kept {
            return;
        }
        let WorksDone { elements, joints, crossed, .. } = &mut self.done;
        let crossed = crossed.iter_mut().map(|crossed| &mut crossed.later);
        elements.iter_mut().flatten().chain([joints]).chain(crossed).for_each(|block| take(block));
    }

    pub(super) fn save(&self) -> WorksDone {
        self.done.clone()
    }

    pub(super) fn load(&mut self, done: WorksDone) -> bool {
        let fits = done.elements.len() == self.done.elements.len() && done.joints.len() == self.done.joints.len();
        (self.done, self.flows) = (done, None);
        fits
    }
}

impl Flows {
    /// Adds what comes of them until θ of a step of size `h` to `sums` of the elements and of the joints.
    fn add(&self, count: usize, part: (f64, f64), (elements, joints): (&mut [[Vec<f64>; 2]], &mut [f64])) {
        let sums = elements.iter_mut().flatten().map(Vec::as_mut_slice).chain([joints]);
        match self {
            Self::AtNodes { elements, joints } => {
                let flows = elements.iter().flatten().chain([joints]);
                sums.zip(flows).for_each(|(sum, flows)| Self::until(flows, count, part, sum));
            }
            Self::Integrated { whole, row, .. } => {
                let works = if part.1 == 1.0 { whole } else { row };
                for (sum, works) in sums.zip(works.chunks_exact(count.max(1))) {
                    sum.iter_mut().zip(works).for_each(|(sum, work)| *sum += work);
                }
            }
        }
    }

    /// What comes of blocks of flows until θ of a step of size `h`.
    fn until(flows: &[f64], count: usize, (h, theta): (f64, f64), to: &mut [f64]) {
        for (p, to) in to.iter_mut().enumerate() {
            let mut powers = Powers::default();
            for (power, flow) in powers.iter_mut().zip(flows.iter().skip(p).step_by(count)) {
                power.dissipation = *flow;
            }
            *to += Power::integrate(&powers, Nodes::Radau, h, theta).dissipation;
        }
    }
}

impl Variation {
    /// Takes in what changes of the energies at the start that was seen.
    pub(super) fn begin_works(&mut self, equations: &Equations) {
        if !self.works.is_kept {
            return;
        }
        let count = self.count();
        let [mut origin, potential] = self.mechanical(0);
        origin.iter_mut().zip(potential).for_each(|(sum, own)| *sum += own);
        let (mut force, mut derivative, mut told) = (vec![0.0; count], vec![0.0; count], Vec::new());
        for (e, element) in self.elements.iter().enumerate() {
            let at = at_start(count, [&element.stroke, &element.rate], &element.inputs);
            let (force, derivative, told) = (&mut force, &mut derivative, &mut told);
            let mut sum = ObservationVariation { force, stored: &mut origin, derivative, told, leaves: None };
            equations.bank.vary_now(e, (&equations.bank.point(e, 0), false), &at, &element.law, &mut sum);
        }
        self.works.done.origin = origin;
    }

    /// Something is crossed that comes later by so much: flows jump there.
    pub(super) fn cross_works(&mut self, equations: &Equations, later: &[f64]) {
        if self.works.is_kept {
            let before = |e: usize| {
                let bank = &equations.bank;
                let flows = self.works.done.last.get(e).copied().unwrap_or_default();
                if !self.system.elements[e].law.jumps() {
                    return (flows, None);
                }
                // An end that is hit has nothing stored yet: all of its force, on whichever side of it that is told, is lost from there on.
                let at = bank.point(e, 0);
                let force = [equations.force_behind(e), bank.response(e).force[STAGES - 1]];
                let lost = force[usize::from(force[0] == 0.0)] * at.rate;
                let stored = bank.now(e, &at).and_then(|observation| observation.stored).unwrap_or(0.0);
                (flows, Some(if stored <= NOTHING * lost.abs() * at.t { -lost } else { 0.0 }))
            };
            let later = later.iter().map(|later| if later.is_finite() { *later } else { 0.0 }).collect();
            let before = (0..self.elements.len()).map(before).collect();
            self.works.done.crossed = Some(Crossed { later, before });
        }
    }

    /// An input of element `e` jumps, and what it has stored with it: what that supplies changes as nobody tells.
    pub(crate) fn lose_supplied(&mut self, e: usize) {
        let [_, supplied] = &mut self.works.done.elements[e];
        supplied.fill(f64::NAN);
    }

    /// Makes sure that the flows of the step at hand are known where anybody asks for works.
    pub(crate) fn prepare_works(&mut self, equations: &Equations) {
        if self.works.is_kept {
            self.flow(equations);
        }
    }

    /// Works out the flows of the step at hand, whose motion is known, where that was not done.
    fn flow(&mut self, equations: &Equations) {
        if self.works.flows.is_some() {
            return;
        }
        self.begin_flows(equations, |e| {
            let first = equations.bank.powers(e)[0];
            [first.dissipation, first.input]
        });
        let count = self.count();
        let blocks = || vec![0.0; (STAGES + 1) * count];
        let (mut elements, mut joints) = (Vec::with_capacity(self.elements.len()), blocks());
        for (e, element) in self.elements.iter().enumerate() {
            let told = of_step(count, [&element.stroke, &element.rate], &element.inputs);
            let mut own = [blocks(), blocks()];
            let [dissipation, input] = &mut own;
            equations.bank.vary_powers(e, &told, &element.law, &mut PowersVariation { dissipation, input });
            elements.push(own);
        }
        joints.chunks_exact_mut(count).enumerate().for_each(|(i, flow)| self.flow_of_joints(equations, i, flow));
        self.works.flows = Some(Flows::AtNodes { elements, joints });
    }

    /// Takes what was crossed before the step at hand into the works, at whose start every element dissipates and is supplied with `first`, W.
    fn begin_flows(&mut self, equations: &Equations, first: impl Fn(usize) -> [f64; 2]) {
        let crossed = self.works.done.crossed.take();
        for (e, [last, _]) in std::mem::take(&mut self.works.done.last).into_iter().enumerate() {
            let (law, [now, _]) = (&self.system.elements[e].law, first(e));
            // What begins to slip dissipates at once, from a time that not all tell.
            if crossed.is_none()
                && (now - last).abs() > GOES_ON * last.abs().max(now.abs())
                && law.begins_untold(&equations.bank.point(e, 0))
            {
                let [dissipated, supplied] = &mut self.works.done.elements[e];
                dissipated.fill(f64::NAN);
                supplied.fill(f64::NAN);
            }
        }
        if let Some(Crossed { later, before }) = crossed {
            // Δ∫P dt = (P⁻ − P⁺)·δt*.
            let works = self.works.done.elements.iter_mut().zip(before).enumerate();
            for (e, ([dissipated, supplied], ([dissipation, input], less))) in works {
                let after = first(e);
                let less = less.unwrap_or(dissipation - after[0]);
                for (work, jump) in [(dissipated, less), (supplied, input - after[1])] {
                    work.iter_mut().zip(&later).for_each(|(work, later)| *work += jump * later);
                }
            }
        }
    }

    /// Adds what changes of what joints lose at node `i`.
    fn flow_of_joints(&self, equations: &Equations, i: usize, flow: &mut [f64]) {
        let (count, model, node) = (self.count(), &self.system.model, &self.nodes[i]);
        let own = |k: usize| self.own_v.iter().position(|own| *own == k);
        let sliding = |k: usize| own(k).map_or(0.0, |own| equations.sliding(own, node.v_now[k]));
        each_loss_slope(&self.system, &node.v_now, sliding, |k, slope| {
            let changes = node.v[k * count..].iter();
            flow.iter_mut().zip(changes).for_each(|(flow, change)| *flow += slope * change);
        });
        for (p, parameter) in self.by.parameters.iter().enumerate() {
            for seed in &parameter.seeds {
                match seed {
                    Seed::Damping { joint, by } => flow[p] += by * felt(model, *joint, &node.v_now).2.powi(2),
                    Seed::Friction { joint, by } => {
                        let (_, _, speed) = felt(model, *joint, &node.v_now);
                        flow[p] += by * speed * direction(model.friction_laws()[*joint], speed);
                    }
                    _ => {}
                }
            }
        }
    }

    /// How many blocks of flows a step integrates: two of every element, and one of the joints; none where nobody asks for works.
    pub(crate) fn flow_count(&self) -> usize {
        if self.works.is_kept { 2 * self.elements.len() + 1 } else { 0 }
    }

    /// These flows at node `i`, whose changes are known, where elements are told these points and keep nothing.
    pub(crate) fn flows_at<'p>(
        &self,
        equations: &Equations,
        i: usize,
        at: impl Fn(usize) -> Point<'p>,
        flows: &mut [f64],
    ) {
        flows.fill(0.0);
        let count = self.count();
        if flows.is_empty() {
            return;
        }
        let (elements, joints) = flows.split_at_mut(2 * self.elements.len() * count);
        for (e, (own, element)) in elements.chunks_exact_mut(2 * count).zip(&self.elements).enumerate() {
            let sums: [&mut [f64]; 2] = own.split_at_mut(count).into();
            equations.bank.vary_powers_at(e, &at(e), &element.told(count, i, None), &element.law, sums);
        }
        self.flow_of_joints(equations, i, joints);
    }

    /// Begins a step that integrates its flows itself, at whose start every element dissipates and is supplied with `first`, W.
    pub(crate) fn begin_integrated(&mut self, equations: &Equations, first: impl Fn(usize) -> [f64; 2]) {
        self.works.forget();
        if self.works.is_kept {
            self.begin_flows(equations, first);
        }
    }

    /// What a step comes to that integrated its flows itself, and what every element dissipates and is supplied with at its end, W.
    pub(crate) fn take_integrated(&mut self, works: &[f64], last: impl Fn(usize) -> [f64; 2]) {
        if self.works.is_kept {
            let last = (0..self.elements.len()).map(last).collect();
            self.works.flows = Some(Flows::Integrated { whole: works.to_vec(), row: Vec::new(), last });
        }
    }

    /// What it comes to until the row.
    pub(crate) fn take_integrated_at_row(&mut self, works: impl Iterator<Item = f64>) {
        if let Some(Flows::Integrated { row, .. }) = &mut self.works.flows {
            row.clear();
            row.extend(works);
        }
    }

    /// Takes the flows of the accepted step in; the bank has not taken it yet.
    pub(super) fn commit_works(&mut self, equations: &Equations) {
        if !self.works.is_kept {
            return;
        }
        self.flow(equations);
        let (count, Works { done, flows, .. }) = (self.by.parameters.len(), &mut self.works);
        let Some(flows) = flows.take() else { return };
        flows.add(count, (equations.bank.size(), 1.0), (&mut done.elements, &mut done.joints));
        done.last = match flows {
            Flows::Integrated { last, .. } => last,
            Flows::AtNodes { .. } => {
                let last = |e: usize| equations.bank.powers(e)[STAGES];
                (0..self.elements.len()).map(last).map(|last| [last.dissipation, last.input]).collect()
            }
        };
    }

    /// Works out what has changed of the works until a row, at θ of the step at hand or between two.
    pub(super) fn read_works(&mut self, equations: &Equations, theta: Option<f64>) {
        if !self.works.is_kept {
            return;
        }
        if theta.is_some() {
            self.flow(equations);
        }
        let (count, Works { done, flows, row, .. }) = (self.by.parameters.len(), &mut self.works);
        row.0.clone_from(&done.elements);
        row.1.clone_from(&done.joints);
        if let Some((theta, flows)) = theta.zip(flows.as_ref()) {
            flows.add(count, (equations.bank.size(), theta), (&mut row.0, &mut row.1));
        }
    }

    /// What changes at the row of what element `e` has dissipated (0) or was supplied with (1).
    pub(super) fn work(&self, e: usize, which: usize) -> Option<Vec<f64>> {
        self.works.is_kept.then(|| self.works.row.0[e][which].clone())
    }

    /// What changes at the row of what was lost in joints; ends of joints that give way are among them.
    pub(super) fn lost_in_joints(&self) -> Option<Vec<f64>> {
        let mut sum = self.works.is_kept.then(|| self.works.row.1.clone())?;
        for (e, _) in self.system.elements.iter().enumerate().filter(|(_, element)| !element.shown) {
            let [_, stored, _] = &self.elements[e].row;
            let own = stored.iter().zip(&self.works.row.0[e][0]);
            sum.iter_mut().zip(own).for_each(|(sum, (stored, dissipated))| *sum += stored + dissipated);
        }
        Some(sum)
    }

    /// What changes at the row of the work of the actuators: what of all energies changes, less what did so at t = 0, since their balance holds for all
    /// values of the parameters.
    pub(super) fn work_of_actuators(&self) -> Option<Vec<f64>> {
        let mut sum = self.works.is_kept.then(|| self.works.row.1.clone())?;
        if !self.is_driven() {
            return Some(vec![0.0; sum.len()]);
        }
        let [kinetic, potential] = self.mechanical(ROW);
        for (p, sum) in sum.iter_mut().enumerate() {
            *sum += kinetic[p] + potential[p] - self.works.done.origin[p];
            for (element, [dissipated, supplied]) in self.elements.iter().zip(&self.works.row.0) {
                *sum += element.row[1][p] + dissipated[p] - supplied[p];
            }
        }
        Some(sum)
    }

    /// Whether anything does work on the robot besides its elements and joints: else that is 0, and no difference of what is rounded.
    fn is_driven(&self) -> bool {
        let system = &self.system;
        let Motion::Forward(forward) = &system.motion else { return true };
        let sets = |event: &Event| match &event.action {
            Action::Set(settings) => settings.iter().any(|setting| matches!(setting, Setting::Torque { .. })),
            _ => false,
        };
        let is_nothing = |signal: &Signal| signal.is_constant() == Some(0.0);
        !system.control.is_empty()
            || forward.has_paths()
            || forward.forces(&system.model).any(|(_, signal)| !is_nothing(signal))
            || system.events.iter().any(sets)
    }

    /// What changes of kinetic and potential energy at node `i`.
    pub(super) fn mechanical(&self, i: usize) -> [Vec<f64>; 2] {
        let (count, n, node, model) = (self.count(), self.nv(), &self.nodes[i], &self.system.model);
        let along = |slopes: &[f64], blocks: &[f64], p: usize| -> f64 {
            slopes.iter().enumerate().map(|(k, slope)| slope * blocks[k * count + p]).sum()
        };
        // (M v)·δv + (Cᵀ v)·δq, since Ṁ = C + Cᵀ; of joints that turn freely, whose axes turn along, with v ×* M v.
        let v = &node.v_now;
        let coriolis = coriolis(model, &node.kinematics);
        let sum = |entry: &dyn Fn(usize) -> f64| -> f64 { v.iter().enumerate().map(|(c, v)| entry(c) * v).sum() };
        let momentum: Vec<f64> = (0..n).map(|k| sum(&|c| node.slopes.d_a[k * n + c])).collect();
        let mut bent: Vec<f64> = (0..n).map(|k| sum(&|c| coriolis[c * n + k])).collect();
        for turn in model.free_turns() {
            turn.add_moment(v, &momentum, &mut bent);
        }
        let weights = gravity(model, &node.kinematics);
        let of_inertias = self.of_seeds(|seed| match seed {
            Seed::Inertia(change) => kinetic_energy(change, &node.kinematics),
            _ => 0.0,
        });
        let of_robot = self.of_seeds(|seed| match seed {
            Seed::Inertia(change) | Seed::Gravity(change) => potential_energy(change, &node.kinematics),
            _ => 0.0,
        });
        let kinetic = |p: usize| along(&momentum, &node.v, p) + along(&bent, &node.q, p) + of_inertias[p];
        let potential = |p: usize| along(&weights, &node.q, p) + of_robot[p];
        [(0..count).map(kinetic).collect(), (0..count).map(potential).collect()]
    }
}
