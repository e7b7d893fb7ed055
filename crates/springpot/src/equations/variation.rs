//! What parameters change at the nodes of a step: the equations of motion linearised there, and their right sides.

mod adjoint;
mod at_once;
mod control;
mod energies;
mod found;
mod inertias;
mod one_node;
mod past;
mod rows;
mod saltation;
mod seen;
mod singular;
mod sizes;
mod state;

use super::assembly::Equations;
use super::control::ControlVariation;
use super::node::Node;
use super::solve::Solve;
use crate::collocation::STAGES;
use crate::dynamics::{Abreast, Kinematics, RneaDerivatives, Sought, Workspace};
use crate::elements::MemoryRange;
use crate::law::past::Begun;
use crate::law::variation::{LawVariation, PointVariation, StepVariation};
use crate::law::{Network, Response, Start};
use crate::linalg::columns::add;
use crate::observe::Quantity;
use crate::system::sensitivity::{Seed, Sensitivity, SensitivityError};
use crate::system::{Motion, System};
use adjoint::{Alone, Narrow, SolvedStep, lines};
pub(crate) use adjoint::{Backwards, Endings, Entries, Recording, Starts};
use energies::Works;
pub(crate) use found::Found;
use inertias::Inertias;
use one_node::OneSize;
pub(crate) use one_node::{STAGE, Told};
use saltation::Saltation;
use singular::Singular;
use sizes::Sizes;
pub(crate) use sizes::{StepErrors, TANGENTS};
pub(crate) use state::VariationState;
use std::ops::Range;
use std::sync::Arc;

/// Derivatives of a run by its parameters, in blocks of one number for each parameter; velocities count as those of the extended robot.
#[derive(Debug)]
pub(crate) struct Variation {
    pub(super) by: Arc<Sensitivity>,
    pub(super) system: Arc<System>,
    coordinates: Coordinates,
    /// Of every velocity of the run, which of the extended robot it is; the others stand for places and stay 0.
    pub(super) own_v: Vec<usize>,
    pub(crate) elements: Vec<ElementVariation>,
    /// What moves geometry, for good: velocity of the extended robot, parameter, by how much.
    placed: Vec<(usize, usize, f64)>,
    inertias: Inertias,
    /// Seeds that push joints by themselves: parameter, and which of its seeds.
    pushes: Vec<(usize, usize)>,
    /// At the start of the step, at its nodes, and at a row.
    pub(crate) nodes: [NodeVariation; ROW + 1],
    sizes: Sizes,
    singular: Singular,
    pub(crate) room: Room,
    /// Of a change that is about to be crossed, and of those before.
    saltation: Saltation,
    works: Works,
    /// Of what follows from the state, where anything does.
    control: Option<Box<ControlVariation>>,
    /// What is known of steps of one size, where it takes such.
    one_size: Option<OneSize>,
    /// Of velocities at t = 0 before an impulse there.
    before_kick: Option<Vec<f64>>,
}

/// Coordinates of the extended robot.
#[derive(Debug)]
struct Coordinates {
    /// Of every coordinate of the run, which of them it is.
    own: Vec<usize>,
    values: Vec<f64>,
}

/// Room to work in, kept from step to step.
#[derive(Debug)]
pub(crate) struct Room {
    workspace: Workspace,
    /// Where nodes are seen side by side, with what is asked of the robot.
    abreast: Abreast,
    /// Whether kinematics of the nodes are asked for beside that.
    stands: bool,
    pub(crate) solve: Solve,
    /// Right-hand sides of a step, side by side.
    pub(crate) right: Vec<f64>,
    /// The step at hand, where no column is followed through it, and how much the last one kept.
    solved: Option<Box<SolvedStep>>,
    kept: usize,
    /// The robot of the run at the nodes of such steps.
    alone: Option<Box<Alone>>,
}

/// How often what changes of temperatures is found together with what changes of the motion.
const MOST_PASSES: usize = 20;

/// Change of the forces, in units of the largest, at which they are found.
const SETTLED: f64 = 1e-12;

/// The node of a row.
pub(crate) const ROW: usize = STAGES + 1;

/// An element over a step.
#[derive(Debug)]
pub(crate) struct ElementVariation {
    pub(crate) law: LawVariation,
    /// What changes of its stroke where the robot stays.
    rest: Vec<f64>,
    /// Stroke and rate, node by node.
    pub(crate) stroke: Vec<f64>,
    pub(crate) rate: Vec<f64>,
    /// Inputs, value and rate, point by point; empty where no parameter moves any.
    inputs: [Vec<f64>; 2],
    /// Forces at the nodes, by all but strokes and rates there.
    pub(crate) force: Vec<f64>,
    /// Its answer, where that of the step has other tangents.
    exact: Option<Response>,
    /// Force, stored energy and D^alpha x at the row.
    row: [Vec<f64>; 3],
    /// What the law tells of itself there.
    told: Vec<f64>,
    /// What its leaves are there, where rows tell of them.
    leaves: Vec<f64>,
    /// Its law by columns of its own, for steps that are gone back through by their own equations.
    narrow: Option<Box<Narrow>>,
}

/// One node.
#[derive(Debug)]
pub(crate) struct NodeVariation {
    t: f64,
    pub(crate) kinematics: Kinematics,
    /// ∂(RNEA + resistance + Σ g F)/∂q, /∂v, /∂a, F constant.
    pub(crate) slopes: RneaDerivatives,
    /// q, v and a of the extended robot.
    q_now: Vec<f64>,
    v_now: Vec<f64>,
    pub(super) a_now: Vec<f64>,
    /// y and y' of every element.
    readings: Vec<[f64; 2]>,
    /// ∂y/∂q and ∂y'/∂q of every element.
    pub(crate) gradients: Vec<[Vec<f64>; 2]>,
    /// ∂²y/∂q² (nv × nv).
    hessians: Vec<Vec<f64>>,
    /// Blocks of q, v and a.
    pub(crate) q: Vec<f64>,
    pub(crate) v: Vec<f64>,
    pub(crate) a: Vec<f64>,
    /// Of the equations of motion where the motion stays.
    explicit: Vec<f64>,
    /// What changed inertias and gravity ask of the velocities.
    efforts: Vec<f64>,
}

impl NodeVariation {
    /// Of a robot at `start`, for so many parameters, `efforts` numbers of what they ask of the velocities.
    fn new(System { model, elements, .. }: &System, start: &[f64], (count, efforts): (usize, usize)) -> Self {
        let n = model.nv();
        let zeros = || vec![0.0; n * count];
        Self {
            t: 0.0,
            kinematics: Kinematics::new(model),
            slopes: RneaDerivatives::new(model),
            q_now: start.to_vec(),
            v_now: vec![0.0; n],
            a_now: vec![0.0; n],
            readings: vec![[0.0; 2]; elements.len()],
            gradients: elements.iter().map(|_| [vec![0.0; n], vec![0.0; n]]).collect(),
            hessians: vec![vec![0.0; n * n]; elements.len()],
            q: zeros(),
            v: zeros(),
            a: zeros(),
            explicit: zeros(),
            efforts: vec![0.0; efforts],
        }
    }

    /// Number of velocities.
    pub(crate) fn nv(&self) -> usize {
        self.v_now.len()
    }
}

impl Variation {
    /// Of a run of `system`; `has_fixed_steps`: in steps of one size.
    ///
    /// # Errors
    /// What has no derivative.
    pub(crate) fn new(
        system: &System,
        by: &Arc<Sensitivity>,
        equations: &Equations,
        has_fixed_steps: bool,
    ) -> Result<Self, SensitivityError> {
        let extended = by.extended.clone().unwrap_or_else(|| Arc::new(system.clone()));
        check(system)?;
        let one_size = has_fixed_steps.then(|| OneSize::new(system, by)).transpose()?;
        let (model, count) = (&extended.model, by.parameters.len());
        let (mut own_q, mut own_v) = (Vec::new(), Vec::new());
        for j in system.model.own_joints() {
            let name = &system.model.joint_names()[j];
            let Some(other) = model.joint_index(name) else {
                return Err(SensitivityError::Unknown { what: format!("joint \"{name}\"") });
            };
            own_q.extend(model.q_range(other));
            own_v.extend(model.v_range(other));
        }
        let control = equations.control.as_deref();
        let control = control.map(|run| ControlVariation::new(run, system, by, &extended, [&own_q, &own_v]));
        let control = control.transpose()?;
        let start = match &extended.motion {
            Motion::Forward(forward) => forward.q.clone(),
            Motion::Given(_) => model.neutral(),
        };
        let inertias = Inertias::of(by);
        let lines = lines(&extended);
        let moves = (0..model.nv()).map(|k| own_v.contains(&k)).collect();
        let stands = control.is_some() || lines.len() < extended.elements.len();
        let abreast = Abreast::new(model, Sought { moves, links: inertias.links(), fields: inertias.fields(), lines });
        let efforts = abreast.sought.changes() * model.nv();
        let element = |(e, inputs): (usize, usize)| {
            let mut rest = vec![0.0; count];
            let mut moves_inputs = control.iter().flat_map(|control| control.inputs()).any(|(own, _)| own == e);
            for (p, parameter) in by.parameters.iter().enumerate() {
                for seed in &parameter.seeds {
                    match seed {
                        Seed::Rest { element, by } if *element == e => rest[p] -= by,
                        Seed::Input { element, .. } if *element == e => moves_inputs = true,
                        Seed::Set { event, setting, .. } => moves_inputs |= system.sets_input_of(*event, *setting, e),
                        _ => {}
                    }
                }
            }
            let points = || vec![0.0; (ROW + 1) * count];
            let inputs = || vec![0.0; if moves_inputs { (ROW + 1) * inputs * count } else { 0 }];
            ElementVariation {
                law: LawVariation::default(),
                rest,
                stroke: points(),
                rate: points(),
                inputs: [inputs(), inputs()],
                force: vec![0.0; STAGES * count],
                exact: None,
                row: [(); 3].map(|()| vec![0.0; count]),
                told: Vec::new(),
                leaves: Vec::new(),
                narrow: None,
            }
        };
        let seeds = by.parameters.iter().enumerate().flat_map(|(p, own)| own.seeds.iter().map(move |seed| (p, seed)));
        let placed = seeds.filter_map(|(p, seed)| match seed {
            Seed::Place { velocity, by } => Some((*velocity, p, *by)),
            _ => None,
        });
        let placed = placed.collect();
        let is_push = |seed: &Seed| matches!(seed, Seed::Drive { .. } | Seed::Damping { .. } | Seed::Friction { .. });
        let seeds =
            by.parameters.iter().enumerate().flat_map(|(p, own)| own.seeds.iter().enumerate().map(move |k| (p, k)));
        let pushes = seeds.filter(|(_, (_, seed))| is_push(seed)).map(|(p, (which, _))| (p, which)).collect();
        let elements = extended.elements.iter().map(|element| element.inputs.len()).enumerate().map(element).collect();
        Ok(Self {
            coordinates: Coordinates { own: own_q, values: start.clone() },
            own_v,
            elements,
            placed,
            inertias,
            pushes,
            nodes: std::array::from_fn(|_| NodeVariation::new(&extended, &start, (count, efforts))),
            sizes: Sizes::new(by, model.nv(), extended.elements.len()),
            singular: Singular::new(extended.elements.len(), model.nv(), count),
            room: Room {
                workspace: Workspace::new(model),
                abreast,
                stands,
                solve: Solve::default(),
                right: Vec::new(),
                solved: None,
                kept: 0,
                alone: by.adjoint.is_some().then(|| Box::new(Alone::of(system))),
            },
            saltation: Saltation::new(count),
            works: Works::new(by, extended.elements.len(), has_fixed_steps),
            by: by.clone(),
            system: extended.clone(),
            control,
            one_size,
            before_kick: None,
        })
    }

    /// Number of parameters.
    pub(crate) fn count(&self) -> usize {
        self.by.parameters.len()
    }

    /// Number of velocities of the extended robot.
    pub(crate) fn nv(&self) -> usize {
        self.system.model.nv()
    }

    /// Of every velocity of the run, which of the extended robot it is.
    pub(crate) fn own_v(&self) -> &[usize] {
        &self.own_v
    }

    /// Accelerations at the nodes of the step do not change, as far as is known.
    pub(crate) fn rest_stages(&mut self) {
        let (count, Self { nodes, own_v, .. }) = (self.count(), self);
        for stage in &mut nodes[1..=STAGES] {
            own_v.iter().for_each(|k| stage.a[k * count..(k + 1) * count].fill(0.0));
        }
    }

    /// Whether what changes of a quantity is what changes of the motion alone.
    pub(crate) fn is_motion(&self, of: Quantity) -> bool {
        Self::is_of_motion(&self.system.model, of)
    }

    /// Which velocity of the extended robot each of these of the run is.
    pub(crate) fn of_run(&self, velocities: &[usize]) -> Vec<usize> {
        velocities.iter().map(|&k| self.own_v[k]).collect()
    }

    /// What changes at t = 0, of a run whose elements have begun and whose robot is at `start`, and was `before` an impulse at t = 0. The memories of
    /// elements are made for this range; `settles`: jumps inside series are shared out by all of them ([`Element::settled`]).
    ///
    /// # Errors
    /// A leaf that has no derivatives; a past of which none are known.
    pub(crate) fn begin(
        &mut self,
        run: &System,
        equations: &Equations,
        [before, start]: [Node; 2],
        (range, settles): (MemoryRange, bool),
    ) -> Result<(), SensitivityError> {
        let (by, count) = (self.by.clone(), self.count());
        let node = &mut self.nodes[0];
        for (p, parameter) in by.parameters.iter().enumerate() {
            for seed in &parameter.seeds {
                match seed {
                    Seed::Position { velocity, by } => node.q[self.own_v[*velocity] * count + p] += by,
                    Seed::Velocity { velocity, by } => node.v[self.own_v[*velocity] * count + p] += by,
                    Seed::Place { velocity, by } => node.q[velocity * count + p] += by,
                    _ => {}
                }
            }
        }
        self.place_nodes();
        self.hold_still(equations);
        // What laws keep begins at the strokes and inputs of t = 0.
        self.see_start(equations, start);
        if let (Some(control), Some(run)) = (&mut self.control, &equations.control) {
            let [node, ..] = &self.nodes;
            control.begin(run, [&node.q, &node.v])?;
            control.push_at(0, None, (run, false), [&node.q, &node.v]);
        }
        let (system, mut jolts) = (self.system.clone(), Vec::new());
        for (e, element) in system.elements.iter().enumerate() {
            let law = |seed: &Seed| match seed {
                Seed::Law { element, law } if *element == e => Some(law.clone()),
                _ => None,
            };
            let laws: Vec<Option<Network>> =
                by.parameters.iter().map(|parameter| parameter.seeds.iter().find_map(law)).collect();
            let Some(state) = equations.bank.law_state(e) else {
                return Err(SensitivityError::Unknown {
                    what: format!("\"{}\", which has a named scheme", element.name),
                });
            };
            let at = equations.bank.point(e, 0);
            let past = self.past_variation(run, e)?;
            let own = &self.elements[e];
            let told = at_start(count, [&own.stroke, &own.rate], &own.inputs);
            let of = element.start(element.rest + at.stroke, at.inputs);
            let jump = if of.jump == 0.0 { 0.0 } else { at.stroke };
            let of = Begun { law: &element.law, by: &laws, start: Start { stroke: at.stroke, jump, ..of }, told };
            let jolt =
                (!settles && self.one_size.is_none()).then(|| element.jolt_variation(of, range.horizon)).flatten();
            let begun = element.variation(of, &past, state, range, settles || jolt.is_some());
            let law = begun.map_err(|what| SensitivityError::Unknown {
                what: format!("{what} in the law of \"{}\"", element.name),
            })?;
            self.elements[e].law = law;
            jolts.push(jolt);
        }
        self.kick(equations, &jolts, [before, start]);
        self.accelerate(equations);
        let is_known =
            |own: &Self, p: usize| own.nodes[0].explicit.iter().skip(p).step_by(count).all(|x| x.is_finite());
        for p in (0..count).filter(|p| !is_known(self, *p)).collect::<Vec<_>>() {
            self.lose(p, 0.0, "what it changes of a force is not finite");
        }
        self.switch_at_start();
        self.begin_singular(equations);
        self.begin_works(equations);
        self.take_sizes();
        Ok(())
    }

    /// Tells all nodes what changes of places, once for all.
    fn place_nodes(&mut self) {
        let [start, others @ ..] = &mut self.nodes;
        others.iter_mut().for_each(|node| node.q.copy_from_slice(&start.q));
    }

    /// What follows the start is another function than what came before: sees it, and what changes of the accelerations there.
    pub(crate) fn start_anew(&mut self, equations: &Equations, start: Node) {
        self.see_start(equations, start);
        self.accelerate(equations);
    }

    /// Sees where the step starts, and what changes of the elements there.
    pub(super) fn see_start(&mut self, equations: &Equations, start: Node) {
        if self.one_size.is_some() {
            return self.see_start_of_one(equations, start);
        }
        let force: Vec<f64> = (0..self.elements.len()).map(|e| equations.force_behind(e)).collect();
        self.see(equations, 0, start, &force);
        self.steer(0, equations, &force);
        (0..self.elements.len()).for_each(|e| self.measure(e, 0));
        self.feed_back(0);
        self.push_at(0, None, equations);
    }

    /// Solves M δa = −(K δq + D δv + explicit + Σ g δF) at the start that was seen.
    pub(super) fn accelerate(&mut self, equations: &Equations) {
        if self.one_size.is_some() {
            // Where a row asks for them.
            return;
        }
        let free = self.of_run(equations.free());
        if !free.is_empty() {
            (0..self.elements.len()).for_each(|e| self.pull(equations, (e, 0), &equations.bank.point(e, 0)));
        }
        self.solve_node(0, &free);
    }

    /// What changes of the inputs at node `i`, at time t, which follow from time alone or are held.
    pub(super) fn look_at_inputs(&mut self, i: usize, t: f64) {
        let Self { by, system, elements, saltation: Saltation { held, .. }, .. } = self;
        if elements.iter().all(|element| element.inputs[0].is_empty()) {
            return;
        }
        let count = by.parameters.len();
        for element in elements.iter_mut() {
            for blocks in &mut element.inputs {
                let own = blocks.len() / (ROW + 1);
                blocks[i * own..(i + 1) * own].fill(0.0);
            }
        }
        for ([element, input], by) in held.inputs() {
            let place = ((i * system.elements[element].inputs.len()) + input) * count;
            let [values, _] = &mut elements[element].inputs;
            if !values.is_empty() {
                values[place..place + count].copy_from_slice(by);
            }
        }
        for (p, parameter) in by.parameters.iter().enumerate() {
            for seed in &parameter.seeds {
                let Seed::Input { element, input, by } = seed else { continue };
                if held.input(*element, *input).is_some() {
                    continue;
                }
                let (inputs, change) = (system.elements[*element].inputs.len(), by.at(t));
                let place = ((i * inputs) + input) * count + p;
                let [values, rates] = &mut elements[*element].inputs;
                values[place] += change.value;
                rates[place] += change.first;
            }
        }
        if self.one_size.is_some() {
            // Whatever follows from the state is sampled.
            let held = self.control.iter().flat_map(|control| control.held_inputs());
            for (e, input, by) in held.filter(|(e, input, _)| self.saltation.held.input(*e, *input).is_none()) {
                let place = (i * self.system.elements[e].inputs.len() + input) * count;
                let [values, _] = &mut self.elements[e].inputs;
                values[place..place + count].copy_from_slice(by);
            }
        }
    }

    /// Follows the motion at the nodes, as they have it, with all that is told of it.
    pub(crate) fn follow(&mut self, equations: &Equations) {
        for i in 1..=STAGES {
            (0..self.elements.len()).for_each(|e| self.measure(e, i));
            self.feed_back(i);
        }
        if let (Some(control), Some(run)) = (&mut self.control, &equations.control) {
            let [nodes @ .., _] = &self.nodes;
            control.follow(run, nodes.each_ref().map(|node| [&node.q[..], &node.v[..]]));
        }
    }

    /// The motion changes at node `i`, from 1, as where the step starts; places change everywhere by the same.
    pub(crate) fn take_start(&mut self, i: usize) {
        self.take_motion(i);
        self.take(i, |node| &mut node.a);
    }

    /// The same of places and velocities alone.
    pub(crate) fn take_motion(&mut self, i: usize) {
        self.take(i, |node| &mut node.q);
        self.take(i, |node| &mut node.v);
    }

    fn take(&mut self, i: usize, of: fn(&mut NodeVariation) -> &mut Vec<f64>) {
        let ([start, others @ ..], count) = (&mut self.nodes, self.by.parameters.len());
        let (from, to) = (of(start), of(&mut others[i - 1]));
        for block in self.own_v.iter().map(|&k| k * count..(k + 1) * count) {
            to[block.clone()].copy_from_slice(&from[block]);
        }
    }

    /// What changes of stroke and rate of element `e` at node `i`.
    pub(crate) fn measure(&mut self, e: usize, i: usize) {
        let (count, Self { nodes, elements, own_v, placed, .. }) = (self.count(), self);
        let (node, element) = (&nodes[i], &mut elements[e]);
        let [gradient, bend] = &node.gradients[e];
        let stroke = &mut element.stroke[i * count..(i + 1) * count];
        let rate = &mut element.rate[i * count..(i + 1) * count];
        stroke.copy_from_slice(&element.rest);
        rate.fill(0.0);
        for &k in own_v.iter() {
            let (q, v) = (&node.q[k * count..][..count], &node.v[k * count..][..count]);
            let (g, y) = (gradient[k], bend[k]);
            add(stroke, [g], [q]);
            add(rate, [y, g], [q, v]);
        }
        for &(k, p, by) in placed.iter() {
            stroke[p] += gradient[k] * by;
            rate[p] += bend[k] * by;
        }
    }

    /// Adds what changes of the equation of velocity `row` at node `i`, the forces of the elements apart, where q, v and a change as the node has
    /// them: parameter by parameter.
    pub(crate) fn add_unbalanced(&self, i: usize, row: usize, sum: &mut [f64]) {
        let (count, n, node) = (self.count(), self.nv(), &self.nodes[i]);
        let block = |blocks: &'_ [f64], k: usize| -> Range<usize> { k * count..((k + 1) * count).min(blocks.len()) };
        let explicit = &node.explicit[block(&node.explicit, row)];
        sum.iter_mut().zip(explicit).for_each(|(sum, own)| *sum += own);
        let slopes = &node.slopes;
        for &k in &self.own_v {
            let at = row * n + k;
            let (by_q, by_v, by_a) = (slopes.d_q[at], slopes.d_v[at], slopes.d_a[at]);
            let own = block(&node.q, k);
            add(sum, [by_q, by_v, by_a], [&node.q[own.clone()], &node.v[own.clone()], &node.a[own]]);
        }
        self.placed.iter().for_each(|(k, p, by)| sum[*p] += slopes.d_q[row * n + k] * by);
        if let Some(control) = self.control.as_ref().filter(|_| !self.is_held(row)) {
            sum.iter_mut().enumerate().for_each(|(p, sum)| *sum -= control.pushed(i, row, p));
        }
    }

    /// Adds what the changed forces of the elements do to the equation of velocity `row` at node `i`; those of element `e` change by `force(e)`.
    pub(crate) fn add_pulled<'f>(&self, i: usize, row: usize, force: impl Fn(usize) -> &'f [f64], sum: &mut [f64]) {
        if self.relieves(i, row) {
            return;
        }
        for (e, [gradient, _]) in self.nodes[i].gradients.iter().enumerate() {
            let g = gradient[row];
            if g != 0.0 {
                add(sum, [g], [force(e)]);
            }
        }
    }

    /// Asks the laws what changes of their forces where strokes and rates at the nodes stay.
    pub(crate) fn ask(&mut self, equations: &Equations) {
        let count = self.count();
        self.works.forget();
        let nodes = if self.one_size.is_some() { 1 } else { STAGES };
        for (e, ElementVariation { law, stroke, rate, inputs, force, exact, .. }) in
            self.elements.iter_mut().enumerate()
        {
            *exact = equations.bank.exact_response(e);
            let told = of_nodes(nodes, count, [stroke, rate], inputs);
            equations.bank.vary(e, &told, law, &mut force[..nodes * count]);
        }
        if self.one_size.is_some() {
            return;
        }
        if let (Some(control), Some(run)) = (&mut self.control, &equations.control) {
            control.ask(run);
            (1..=STAGES).for_each(|i| control.push(i, run, false));
        }
        self.ask_singular(equations);
    }

    /// Works out what changes at the nodes by `once`, which is told whether it is `again`: as often as temperatures follow from losses, and those from what
    /// was found. False where `once` finds nothing.
    pub(crate) fn pass(&mut self, equations: &Equations, mut once: impl FnMut(&mut Self, bool) -> bool) -> bool {
        for pass in 0..MOST_PASSES {
            if pass > 0 && !self.ask_again(equations) {
                break;
            }
            if !once(self, pass > 0) {
                return false;
            }
        }
        true
    }

    /// Asks again the laws that follow what changes of strokes and rates at the nodes by more than their tangents: those whose losses warm them; false
    /// where they answer as before.
    fn ask_again(&mut self, equations: &Equations) -> bool {
        let warms = |element: &crate::elements::Element| {
            element.law.as_heated().is_some_and(|heated| heated.heat().thermal.is_some())
        };
        if !self.system.elements.iter().any(warms) {
            return false;
        }
        let before: Vec<Vec<f64>> = self.elements.iter().map(|element| element.force.clone()).collect();
        self.ask(equations);
        let moved = |(element, before): (&ElementVariation, &Vec<f64>)| {
            let count = self.by.parameters.len();
            (0..count).any(|p| {
                let of = |blocks: &[f64]| blocks.iter().skip(p).step_by(count).copied().collect::<Vec<_>>();
                let (now, before) = (of(&element.force), of(before));
                let largest = now.iter().fold(0.0f64, |largest, force| largest.max(force.abs()));
                now.iter().zip(&before).any(|(now, before)| (now - before).abs() > SETTLED * largest)
            })
        };
        self.elements.iter().zip(&before).any(moved)
    }

    /// Takes the accepted step into what changes of the laws' states; the bank has not taken it yet.
    pub(crate) fn commit(&mut self, equations: &Equations) {
        self.foresee(STAGES, equations);
        self.commit_works(equations);
        let (count, one_size) = (self.count(), self.one_size.is_some());
        for (e, ElementVariation { law, stroke, rate, inputs, .. }) in self.elements.iter_mut().enumerate() {
            let told = of_step(count, [stroke, rate], inputs);
            equations.bank.commit_variation(e, &told, law);
        }
        if !one_size {
            self.commit_singular(equations);
        }
        for ElementVariation { stroke, rate, inputs, .. } in &mut self.elements {
            let last = STAGES * count;
            for blocks in [stroke, rate] {
                blocks.copy_within(last..last + count, 0);
            }
            for blocks in inputs {
                let own = blocks.len() / (ROW + 1);
                blocks.copy_within(STAGES * own..(STAGES + 1) * own, 0);
            }
        }
        if let (Some(control), Some(run)) = (&mut self.control, &equations.control) {
            let [nodes @ .., _] = &self.nodes;
            if one_size {
                control.commit_ends(run, [0, STAGES].map(|i| [&nodes[i].q[..], &nodes[i].v[..]]));
            } else {
                control.commit(run, nodes.each_ref().map(|node| [&node.q[..], &node.v[..]]));
            }
        }
        if let Some(OneSize { accelerated: [start, end], .. }) = &mut self.one_size {
            (*start, *end) = (*end, false);
        }
        self.nodes.swap(0, STAGES);
        self.take_sizes();
    }

    /// What element `e` answered to the step that was asked.
    pub(crate) fn response<'a>(&'a self, equations: &'a Equations, e: usize) -> &'a Response {
        self.elements[e].exact.as_ref().unwrap_or_else(|| equations.bank.response(e))
    }

    /// What changes of the force of element `e` at node `i` (from 1), parameter by parameter.
    pub(crate) fn force(&self, response: &Response, e: usize, i: usize, force: &mut [f64]) {
        let (count, element) = (self.count(), &self.elements[e]);
        force.copy_from_slice(&element.force[(i - 1) * count..][..count]);
        for m in 0..STAGES {
            let (by_stroke, by_rate) = (response.d_stroke[i - 1][m], response.d_rate[i - 1][m]);
            let own = (m + 1) * count..(m + 2) * count;
            add(force, [by_stroke, by_rate], [&element.stroke[own.clone()], &element.rate[own]]);
        }
    }

    /// The law of element `e` built of numbers that change with parameter `p`, where it has any.
    pub(super) fn law_by(&self, e: usize, p: usize) -> Option<&Network> {
        self.by.parameters[p].seeds.iter().find_map(|seed| match seed {
            Seed::Law { element, law } if *element == e => Some(law),
            _ => None,
        })
    }

    /// What the seeds of each parameter give in sum.
    pub(super) fn of_seeds(&self, of: impl Fn(&Seed) -> f64) -> Vec<f64> {
        self.by.parameters.iter().map(|parameter| parameter.seeds.iter().map(&of).sum()).collect()
    }
}

/// What changes of what a law is told of the start of the step.
fn at_start<'a>(count: usize, [stroke, rate]: [&'a Vec<f64>; 2], inputs: &'a [Vec<f64>; 2]) -> PointVariation<'a> {
    let inputs = inputs.each_ref().map(|blocks| &blocks[..blocks.len() / (ROW + 1)]);
    PointVariation { stroke: &stroke[..count], rate: &rate[..count], inputs, step: None, passed: None }
}

/// What changes of what a law is told of a step, without the row behind.
fn of_step<'a>(count: usize, told: [&'a Vec<f64>; 2], inputs: &'a [Vec<f64>; 2]) -> StepVariation<'a> {
    of_nodes(STAGES, count, told, inputs)
}

/// The same of a step of so many nodes.
fn of_nodes<'a>(
    nodes: usize,
    count: usize,
    [stroke, rate]: [&'a Vec<f64>; 2],
    inputs: &'a [Vec<f64>; 2],
) -> StepVariation<'a> {
    let step = (nodes + 1) * count;
    let inputs = inputs.each_ref().map(|blocks| &blocks[..blocks.len() / (ROW + 1) * (nodes + 1)]);
    StepVariation { count, stroke: &stroke[..step], rate: &rate[..step], inputs, passed: None }
}

/// What no derivative is known of.
fn check(system: &System) -> Result<(), SensitivityError> {
    let unknown = |what: &str| Err(SensitivityError::Unknown { what: what.to_owned() });
    if !system.control.is_empty() && matches!(system.motion, Motion::Given(_)) {
        return unknown("what follows from the state along a given motion");
    }
    Ok(())
}
