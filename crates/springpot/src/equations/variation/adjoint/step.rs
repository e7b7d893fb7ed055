//! Steps that are gone back through by their own equations: no column is followed through them.
//!
//! With ρ_i what is unbalanced at stage i where the accelerations stay, J δa = −ρ. Back over the step ∂m/∂ρ = −μ with Jᵀ μ = ∂m/∂a, once for each number
//! m, and what parameters, the start and the past put into ρ, strokes and rates adds its own times μ. Laws say by a few columns of their own how forces and
//! memories answer to strokes and rates at the nodes.

use super::tape::{MemoryOfStep, Starts};
use super::weighing::Changed;
use crate::collocation::STAGES;
use crate::equations::assembly::Equations;
use crate::equations::node::Node;
use crate::equations::variation::{ElementVariation, NodeVariation, Variation};
use crate::fractional::{MemoryTangent, PortColumns};
use crate::law::variation::{LawVariation, StepVariation};
use crate::law::{Derivative, Network};
use crate::linalg::Lu;
use crate::model::FrictionLaw;
use crate::observe::Quantity;
use crate::system::sensitivity::Seed;
use std::sync::Arc;

/// Columns of a law: stroke and rate at the start and at the nodes, of each memory what it keeps beside its modes, what parameters are its own, and the
/// past at as many lags as a step asks a memory for.
pub(super) const POINTS: usize = STAGES + 1;
pub(super) const OF_NODES: usize = 2 * POINTS;
pub(super) const KEPT: usize = 3;
const LAGS: usize = 5;

/// What all such steps of a run have in common.
#[derive(Debug)]
pub(super) struct Plan {
    /// Velocities, all of which follow from forces.
    pub(super) velocities: usize,
    /// What parameters change of the robot.
    pub(super) changed: Changed,
    pub(super) elements: Vec<ElementPlan>,
    /// Of each quantity of a row, whether it is a place, a velocity or an acceleration, and of which one; `None`: the time.
    pub(super) motion: Vec<Option<(usize, usize)>>,
}

#[derive(Debug)]
pub(super) struct ElementPlan {
    /// What parameters change of the stroke where the robot stays.
    pub(super) rest: Vec<(usize, f64)>,
    /// Parameters of its own.
    pub(super) law: Vec<usize>,
    pub(super) memories: usize,
    pub(super) columns: usize,
}

impl Plan {
    /// How many numbers the state has that go on through such a step.
    pub(super) fn numbers(&self) -> usize {
        3 * self.velocities + self.elements.iter().map(|element| KEPT * element.memories).sum::<usize>()
    }

    /// Parameters that change anything in a step.
    pub(super) fn each_parameter(&self) -> impl Iterator<Item = usize> + '_ {
        let of_elements = self.elements.iter().flat_map(|own| own.law.iter().chain(own.rest.iter().map(|(p, _)| p)));
        self.changed.each_parameter().chain(of_elements.copied())
    }
}

impl ElementPlan {
    /// The first column of memory `k`, and of its lags.
    pub(super) fn memory(&self, k: usize) -> usize {
        OF_NODES + KEPT * k
    }

    pub(super) fn own(&self) -> usize {
        OF_NODES + KEPT * self.memories
    }

    fn ports(&self, k: usize) -> PortColumns {
        PortColumns { lags: [self.own() + self.law.len() + LAGS * k, LAGS], sums: [0, 0] }
    }
}

/// A law by columns of its own.
#[derive(Debug)]
pub(crate) struct Narrow {
    law: LawVariation,
    /// Ones where a column is a stroke, and where it is a rate.
    told: [Vec<f64>; 2],
    forces: Vec<f64>,
}

impl Narrow {
    fn of(plan: &ElementPlan, law: &LawVariation) -> Self {
        let columns = plan.columns;
        let mut parameters = vec![None; columns];
        parameters[plan.own()..].iter_mut().zip(&plan.law).for_each(|(column, p)| *column = Some(*p));
        let ones = |first: usize| {
            let mut ones = vec![0.0; POINTS * columns];
            (0..POINTS).for_each(|m| ones[m * columns + first + m] = 1.0);
            ones
        };
        Self {
            law: law.narrowed(&parameters, |k| plan.ports(k)),
            told: [ones(0), ones(POINTS)],
            forces: vec![0.0; STAGES * columns],
        }
    }

    fn told(&self, columns: usize) -> StepVariation<'_> {
        let [stroke, rate] = &self.told;
        StepVariation { count: columns, stroke, rate, inputs: [&[], &[]], passed: None }
    }
}

/// A step as it is gone back through.
#[derive(Debug)]
pub(crate) struct SolvedStep {
    pub(super) plan: Arc<Plan>,
    /// How many numbers the state has in front of it.
    pub(super) state: usize,
    pub(super) h: f64,
    /// The stages; at the last one signals are those then.
    pub(super) times: [f64; STAGES],
    /// Jᵀ.
    pub(super) transposed: Lu,
    /// In the order in which they are read: q, v and a of the start and of the stages; of each stage the forces of the elements; its rows by q and v; of each
    /// element at each node ∂y/∂q and ∂y'/∂q, and what forces and memories have by its columns.
    pub(super) numbers: Vec<f64>,
    pub(super) memories: Vec<MemoryOfStep>,
    /// Rows in it, and where.
    pub(super) rows: Vec<(usize, f64)>,
}

impl SolvedStep {
    /// q, v and a at the start and at the stages.
    pub(super) fn motion(&self) -> impl Iterator<Item = [&[f64]; 3]> {
        let n = self.plan.velocities;
        self.numbers[..POINTS * 3 * n].chunks_exact(3 * n).map(move |own| [0, 1, 2].map(|k| &own[k * n..(k + 1) * n]))
    }

    /// Forces of the elements at a stage.
    pub(super) fn force(&self, stage: usize) -> &[f64] {
        let elements = self.plan.elements.len();
        &self.numbers[POINTS * 3 * self.plan.velocities + stage * elements..][..elements]
    }

    /// What was kept of equations, laws and memories.
    pub(super) fn equations(&self) -> &[f64] {
        &self.numbers[POINTS * 3 * self.plan.velocities + STAGES * self.plan.elements.len()..]
    }

    pub(super) fn bytes(&self) -> usize {
        let matrix = STAGES * STAGES * self.plan.velocities * self.plan.velocities;
        size_of::<Self>()
            + size_of_val(&self.numbers[..])
            + size_of_val(&self.rows[..])
            + matrix * size_of::<f64>()
            + self.memories.iter().map(MemoryOfStep::bytes).sum::<usize>()
    }
}

impl Variation {
    /// What steps have in common that are gone back through by their own equations; `None` where there is more in them than that.
    pub(super) fn plan(&self, equations: &Equations, quantities: &[Quantity], parameters: usize) -> Option<Plan> {
        let system = &self.system;
        let seeds = || self.by.parameters[..parameters].iter().enumerate();
        let is_plain = |(e, own): (usize, &ElementVariation)| {
            let (element, state) = (&system.elements[e], equations.bank.law_state(e));
            let law: &Network = &element.law;
            state.is_some_and(|state| state.size().variables == 0)
                && own.inputs[0].is_empty()
                && element.derivative != Derivative::RiemannLiouville
                && law.as_heated().is_none()
                && !law.has_memories_in_series()
                && !law.jumps()
        };
        let moves_changes = |seed: &Seed| matches!(seed, Seed::Switch { .. } | Seed::Set { .. });
        let has_more = self.control.is_some()
            || self.one_size.is_some()
            || super::keeps_works(quantities)
            || !system.model.is_one_degree()
            || system.model.friction_laws().contains(&FrictionLaw::Sticking)
            || equations.free().len() != self.own_v.len()
            || seeds().any(|(_, parameter)| parameter.seeds.iter().any(moves_changes))
            || !self.elements.iter().enumerate().all(is_plain);
        if has_more {
            return None;
        }
        let elements = self.elements.iter().enumerate().map(|(e, own)| {
            let rest = own.rest.iter().copied().enumerate().filter(|(_, by)| *by != 0.0).collect();
            let law: Vec<usize> = (0..parameters).filter(|p| self.law_by(e, *p).is_some()).collect();
            let memories = equations.bank.law_state(e).map_or(0, |state| state.size().memories);
            let columns = OF_NODES + (KEPT + LAGS) * memories + law.len();
            ElementPlan { rest, law, memories, columns }
        });
        let motion = quantities.iter().map(|of| match of {
            Quantity::Coordinate(k) => Some((0, *k)),
            Quantity::Velocity(k) => Some((1, *k)),
            Quantity::Acceleration(k) => Some((2, *k)),
            _ => None,
        });
        let motion = motion.collect();
        let elements = elements.collect();
        Some(Plan { velocities: self.own_v.len(), changed: Changed::of(self), elements, motion })
    }

    /// Whether the step at hand waits to be gone back through, no column being followed through it.
    pub(crate) fn is_unsolved(&self) -> bool {
        self.room.solved.is_some()
    }

    /// Its columns are to be followed through it after all: when signals at its end are those there.
    pub(crate) fn follow_columns(&mut self) -> Option<f64> {
        let [.., t_end] = self.room.solved.take()?.times;
        Some(t_end)
    }

    /// Whether all is as in the middle of a motion.
    pub(super) fn goes_on(&self, equations: &Equations) -> bool {
        let is_singular = equations.is_singular() || self.elements.iter().any(|element| element.law.is_singular());
        !is_singular && !self.is_about_to_change()
    }

    /// Keeps what it takes to go back through the step at hand, of size h, which starts and has its stages there ([`super::Recording::keep_step`]); `fill`
    /// writes J into zeros. `false` where J is singular.
    pub(super) fn keep_step(
        &mut self,
        equations: &Equations,
        (plan, starts): (&Arc<Plan>, &Starts),
        (h, at): (f64, [Node; POINTS]),
        fill: impl FnOnce(&Self, &[NodeVariation], &mut [f64]),
    ) -> bool {
        for (e, (plan, own)) in plan.elements.iter().zip(&mut self.elements).enumerate() {
            own.exact = equations.bank.exact_response(e);
            let narrow = own.narrow.get_or_insert_with(|| Box::new(Narrow::of(plan, &own.law)));
            for (k, memory) in narrow.law.memories_mut().iter_mut().enumerate() {
                memory.forget_asked();
                for (which, kept) in memory.kept_mut().into_iter().enumerate() {
                    kept.fill(0.0);
                    kept[plan.memory(k) + which] = 1.0;
                }
            }
            lend(own.law.memories_mut(), narrow.law.memories_mut());
            let mut forces = std::mem::take(&mut narrow.forces);
            forces.fill(0.0);
            equations.bank.vary(e, &narrow.told(plan.columns), &narrow.law, &mut forces);
            narrow.forces = forces;
            lend(narrow.law.memories_mut(), own.law.memories_mut());
        }
        let (n, elements) = (plan.velocities, plan.elements.len());
        let Some(mut alone) = self.room.alone.take() else { return false };
        alone.see(at, |e, i| self.response(equations, e).force[i]);
        let (size, [_, stages @ ..]) = (STAGES * n, &alone.nodes);
        let mut transposed = Lu::default();
        let is_regular = transposed.factor(size, |matrix| {
            fill(self, stages, matrix);
            for row in 0..size {
                (0..row).for_each(|column| matrix.swap(row * size + column, column * size + row));
            }
        });
        let mut numbers = Vec::with_capacity(self.room.kept);
        for NodeVariation { q_now, v_now, a_now, .. } in &alone.nodes {
            [q_now, v_now, a_now].into_iter().for_each(|own| numbers.extend_from_slice(own));
        }
        numbers.extend_from_slice(&alone.force[elements..]);
        for NodeVariation { slopes, .. } in stages {
            for row in 0..n {
                numbers.extend_from_slice(&slopes.d_q[row * n..(row + 1) * n]);
                numbers.extend_from_slice(&slopes.d_v[row * n..(row + 1) * n]);
            }
        }
        for (e, own) in self.elements.iter().enumerate() {
            for node in &alone.nodes {
                node.gradients[e].iter().for_each(|slopes| numbers.extend_from_slice(slopes));
            }
            let (response, columns) = (self.response(equations, e), plan.elements[e].columns);
            let first = numbers.len();
            own.narrow.iter().for_each(|narrow| numbers.extend_from_slice(&narrow.forces));
            for (i, forces) in numbers[first..].chunks_exact_mut(columns).enumerate() {
                for m in 0..STAGES {
                    forces[m + 1] += response.d_stroke[i][m];
                    forces[POINTS + m + 1] += response.d_rate[i][m];
                }
            }
        }
        let [_, times @ ..] = at.map(|node| node.t);
        self.room.alone = Some(alone);
        if !is_regular {
            return false;
        }
        self.room.solved = Some(Box::new(SolvedStep {
            plan: plan.clone(),
            state: starts.numbers,
            h,
            times,
            transposed,
            numbers,
            memories: Vec::new(),
            rows: Vec::new(),
        }));
        true
    }

    /// Notes a row at θ of the step that waits.
    pub(super) fn note_row(&mut self, number: usize, theta: f64) {
        self.room.solved.iter_mut().for_each(|step| step.rows.push((number, theta)));
    }

    /// Takes the step that waits into what changes of the laws' states, whose bank has not taken it yet: columns of ones stand behind it, from `first` on.
    pub(super) fn commit_step(&mut self, equations: &Equations, first: usize) -> Option<Box<SolvedStep>> {
        let mut step = self.room.solved.take()?;
        for (e, (plan, own)) in step.plan.elements.iter().zip(&mut self.elements).enumerate() {
            let ElementVariation { law, narrow: Some(narrow), .. } = own else { return None };
            lend(law.memories_mut(), narrow.law.memories_mut());
            let [stroke, rate] = &narrow.told;
            let told = StepVariation { count: plan.columns, stroke, rate, inputs: [&[], &[]], passed: None };
            equations.bank.commit_variation(e, &told, &mut narrow.law);
            lend(narrow.law.memories_mut(), law.memories_mut());
            for memory in narrow.law.memories_mut() {
                memory.kept_mut().iter().for_each(|row| step.numbers.extend_from_slice(row));
                let past = memory.take_past();
                let rows = if past.is_some() { memory.pieces().count() } else { 0 };
                memory.pieces().take(rows).for_each(|row| step.numbers.extend_from_slice(row));
                let told = memory.split_asked([0; 2]);
                step.memories.push(MemoryOfStep { past, rows, told });
            }
        }
        self.room.kept = step.numbers.len();
        let Self { nodes: [start, ..], own_v, elements, room, by, .. } = self;
        let count = by.parameters.len();
        let was_ahead = room.alone.as_mut().and_then(|alone| alone.ahead.replace(STAGES)).is_some();
        let memories = elements.iter_mut().flat_map(|element| element.law.memories_mut());
        if was_ahead {
            // The ones stand there already.
            memories.for_each(MemoryTangent::take_origin);
            return Some(step);
        }
        let mut column = first;
        let mut stand = |block: &mut [f64]| {
            block.fill(0.0);
            block[column] = 1.0;
            column += 1;
        };
        for blocks in [&mut start.q, &mut start.v, &mut start.a] {
            own_v.iter().for_each(|k| stand(&mut blocks[k * count..(k + 1) * count]));
        }
        memories.for_each(|memory| {
            memory.kept_mut().into_iter().for_each(&mut stand);
            memory.take_origin();
        });
        Some(step)
    }

    /// Sees where the step starts, behind steps that no columns were followed through.
    pub(crate) fn catch_up(&mut self, equations: &Equations) {
        let Some(mut alone) = self.room.alone.take() else { return };
        if let Some(i) = alone.ahead.take() {
            let (NodeVariation { t, q_now, v_now, a_now, .. }, elements) = (&alone.nodes[i], self.elements.len());
            let at = Node { t: *t, q: q_now, v: v_now, a: a_now };
            self.see(equations, 0, at, &alone.force[i * elements..(i + 1) * elements]);
            (0..elements).for_each(|e| self.measure(e, 0));
        }
        self.room.alone = Some(alone);
    }
}

/// Memories by other columns take over what is none of these columns' own.
fn lend(from: &mut [MemoryTangent], to: &mut [MemoryTangent]) {
    from.iter_mut().zip(to).for_each(|(from, to)| from.lend(to));
}
