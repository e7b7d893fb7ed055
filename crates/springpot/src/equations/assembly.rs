//! The equations of motion over one step, RNEA(q, v, a) + Σ g F + resistance = τ: one assembly that every method asks.
//!
//! At a node sensors see the state, inputs follow from it, elements answer, torques follow, friction resists, in this order. Nobody else adds a
//! force, and nothing but [`Equations::commit`] outlasts a step.

use super::context::Context;
use super::control::{ControlRun, Eye};
use super::drives::force_at;
use super::friction::Friction;
use super::guards::Changes;
use super::kinks::Kinks;
use super::node::{ElementNodes, Node};
use super::resistance::{add_smooth_resistance, add_tangents};
use super::rounding::Rounding;
use super::solve::Solve;
use super::tangent::{Coupling, couplings};
use crate::actuation::Forward;
use crate::collocation::radau::GAMMA;
use crate::collocation::{Nodes, RADAU_NODES, STAGES};
use crate::dynamics::{Kinematics, RneaDerivatives, Workspace, crba_into};
use crate::elements::{Element, ElementBank, Forces, NoDirection, Pull};
use crate::fractional::Form;
use crate::law::{InputValue, Point, Response};
use crate::model::Model;
use crate::system::error::RunError;
use crate::system::{Motion, System};
use std::sync::Arc;

/// Above this stiffness a springpot of order below ½ takes its polynomial through strokes, which is stable however stiff.
const STIFF: f64 = 10.0;

/// The forces that act over a step, what they follow from, and how they answer to the motion.
#[derive(Debug)]
pub(crate) struct Equations {
    pub(crate) bank: ElementBank,
    /// What follows from the state, where anything does.
    pub(super) control: Option<Box<ControlRun>>,
    /// What drives the joints; nothing where kinematics are given in advance.
    pub(super) forward: Arc<Forward>,
    pub(super) friction: Friction,
    pub(super) kinks: Kinks,
    pub(super) changes: Changes,
    pub(super) elements: Vec<ElementNodes>,
    /// Velocities that forces drive and no friction holds.
    pub(super) free: Vec<usize>,
    /// Forces of the actuators on these at the nodes.
    pub(super) driven: [Vec<f64>; STAGES],
    /// Whether a start is singular, so that its share of the accelerations is kept apart.
    pub(super) is_singular: bool,
    /// Whether a springpot can be unstable where it is stiff.
    may_yield: bool,
    pub(super) tangent: Tangent,
    pub(super) rounding: Rounding,
    scratch: Scratch,
}

/// The equations linearised at the start of the step.
#[derive(Debug)]
pub(super) struct Tangent {
    pub(super) is_known: bool,
    /// Whether sensors and elements were read there, and whether the mass matrix is that of `crba`, which alone steps without derivatives ask for.
    pub(super) is_seen: bool,
    pub(super) is_weighed: bool,
    /// Positions and velocities of the links, and whether they are those of the start.
    pub(super) is_placed: bool,
    pub(super) kinematics: Kinematics,
    /// The mass matrix; ∂(RNEA + resistance − τ)/∂q and /∂v, forces of the elements constant.
    pub(super) slopes: RneaDerivatives,
    /// Factors of the mass matrix over the free velocities, where somebody asked for them.
    pub(super) mass: Solve,
}

#[derive(Debug)]
struct Scratch {
    forces: Forces,
    workspace: Workspace,
    /// nv values.
    tau: Vec<f64>,
    right: Vec<f64>,
}

impl Equations {
    /// Of a system before its start; `has_fixed_steps`: in steps of one size.
    pub(crate) fn new(system: &System, has_fixed_steps: bool) -> Self {
        let model = &system.model;
        let laws = system.elements.iter().map(|element| element.law.clone()).collect();
        let mut bank = ElementBank::new(laws, Nodes::Radau, Form::Rates);
        bank.share(system.shared.kernels());
        for (e, element) in system.elements.iter().enumerate() {
            bank.reserve_inputs(e, element.inputs.len());
        }
        let forward = match &system.motion {
            Motion::Forward(forward) => forward.clone(),
            Motion::Given(_) => Arc::new(Forward { q: Vec::new(), v: Vec::new(), drives: Vec::new() }),
        };
        Self {
            bank,
            control: ControlRun::of(system, has_fixed_steps),
            friction: Friction::new(model, &forward),
            kinks: Kinks::of(system),
            changes: Changes::default(),
            elements: system.elements.iter().map(|_| ElementNodes::new(model.nv())).collect(),
            free: forward.free_velocities(model),
            forward,
            driven: Default::default(),
            is_singular: false,
            may_yield: system.elements.iter().any(may_yield),
            tangent: Tangent {
                is_known: false,
                is_seen: false,
                is_weighed: false,
                is_placed: false,
                kinematics: Kinematics::new(model),
                slopes: RneaDerivatives::new(model),
                mass: Solve::default(),
            },
            rounding: Rounding::default(),
            scratch: Scratch {
                forces: Forces::default(),
                workspace: Workspace::new(model),
                tau: vec![0.0; model.nv()],
                right: Vec::new(),
            },
        }
    }

    /// What drives the joints.
    pub(crate) fn forward(&self) -> &Forward {
        &self.forward
    }

    /// The velocities that forces drive and no friction holds, in rising order: those that are sought.
    pub(crate) fn free(&self) -> &[usize] {
        &self.free
    }

    /// Takes over which velocities friction holds.
    pub(super) fn take_free(&mut self) {
        self.free = self.friction.free();
        self.rounding.shares.forget();
    }

    /// Whether a start is singular, so that its share of the accelerations is kept apart.
    pub(crate) fn is_singular(&self) -> bool {
        self.is_singular
    }

    /// Whether friction sticks at any velocity that forces drive.
    pub(crate) fn rubs(&self) -> bool {
        self.friction.rubbing().next().is_some()
    }

    /// Whether friction holds any joint.
    pub(crate) fn holds_any(&self) -> bool {
        self.friction.holds_any()
    }

    /// The mass matrix (nv × nv), and the derivatives of all but the elements' forces by q and v, at the start of the step.
    pub(crate) fn slopes(&self) -> &RneaDerivatives {
        &self.tangent.slopes
    }

    /// Positions and velocities of the links at the start of the step.
    pub(crate) fn kinematics_at_start(&self) -> &Kinematics {
        &self.tangent.kinematics
    }

    /// Why an element lost its direction in the step, and its number, where one did.
    pub(crate) fn lost(&self) -> Option<(usize, NoDirection)> {
        self.elements.iter().enumerate().find_map(|(e, element)| Some((e, element.lost()?)))
    }

    /// Begins a step of size `h` whose last node is at `t_end`: what follows from time alone at all nodes, and what the start tells; whether that
    /// was linearised anew.
    ///
    /// # Errors
    /// Where an input breaks a rule of its law, an element has no direction, or a reference cannot be followed.
    pub(crate) fn begin(&mut self, cx: Context, at: Node, h: f64, t_end: f64) -> Result<bool, RunError> {
        self.bank.start(at.t, h);
        let nodes = [at.t, at.t + RADAU_NODES[0] * h, at.t + RADAU_NODES[1] * h, t_end];
        for (e, element) in cx.system.elements.iter().enumerate().filter(|(_, element)| !element.inputs.is_empty()) {
            for (k, t) in nodes.into_iter().enumerate() {
                let values = self.bank.inputs_mut(e, k);
                cx.inputs_at(e, t, values);
                element.check_inputs(t, values)?;
            }
        }
        let is_new = !self.tangent.is_known;
        if is_new {
            self.linearise(cx, at)?;
        }
        if let Some(control) = &self.control {
            control.write_inputs(cx, 0, &mut self.bank);
        }
        Ok(is_new)
    }

    /// Makes ready for what is asked at the nodes of the step that has begun.
    ///
    /// # Errors
    /// Where a reference cannot be followed.
    pub(crate) fn prepare(&mut self, cx: Context, t_end: f64) -> Result<(), RunError> {
        let (t, h) = (self.bank.from(), self.bank.size());
        if let Some(control) = &mut self.control {
            control.start(cx, t, h, t_end)?;
        }
        self.choose_forms(cx, h);
        self.bank.prepare();
        Ok(())
    }

    fn linearise(&mut self, cx: Context, at: Node) -> Result<(), RunError> {
        self.see_start(cx, at)?;
        let (model, Tangent { kinematics, slopes, .. }) = (&cx.system.model, &mut self.tangent);
        let Scratch { forces, workspace, .. } = &mut self.scratch;
        self.rounding.forget();
        forces.clear();
        for (element, nodes) in cx.system.elements.iter().zip(&self.elements) {
            forces.push(&element.measure, Pull::constant(nodes.force));
        }
        forces.inverse_dynamics_derivatives_into(model, kinematics, at.a, workspace, slopes);
        add_tangents(cx.system, at.v, &mut slopes.d_v);
        if let Some(control) = &mut self.control {
            let read = |e: usize| self.elements[e].read(0);
            let eye = Eye { system: cx.system, t: at.t, q: at.q, v: at.v, kinematics, element: &read };
            control.linearise(&eye, slopes);
        }
        if self.is_singular || self.may_yield {
            self.share_forces(model.nv());
        }
        (self.tangent.is_known, self.tangent.is_weighed) = (true, false);
        Ok(())
    }

    /// Reads sensors and elements at the start of the step, unless that was done.
    fn see_start(&mut self, cx: Context, at: Node) -> Result<(), RunError> {
        let (model, Tangent { kinematics, is_placed, .. }) = (&cx.system.model, &mut self.tangent);
        if !std::mem::replace(is_placed, true) {
            kinematics.update_velocity(model, at.q, at.v);
        }
        if std::mem::replace(&mut self.tangent.is_seen, true) {
            return Ok(());
        }
        let kinematics = &self.tangent.kinematics;
        for (e, (element, nodes)) in cx.system.elements.iter().zip(&mut self.elements).enumerate() {
            let [reading, ..] = &mut nodes.readings;
            element.measure.read_into(model, kinematics, &mut nodes.gradient, reading);
            element.check_direction(at.t, reading)?;
            self.bank.set_stroke(e, 0, element.stroke(reading.coordinate), reading.rate);
            self.bank.set_resolution(e, element.resolution(reading.coordinate));
        }
        if let Some(control) = &mut self.control {
            let read = |e: usize| self.elements[e].read(0);
            control.see_start(&Eye { system: cx.system, t: at.t, q: at.q, v: at.v, kinematics, element: &read })?;
        }
        Ok(())
    }

    /// Begins a step of size `h` that asks for no derivatives: what the start tells, and the mass matrix there.
    ///
    /// # Errors
    /// Where an input breaks a rule of its law, an element has no direction, or a reference cannot be followed.
    pub(crate) fn stand_at(&mut self, cx: Context, at: Node, h: f64) -> Result<(), RunError> {
        self.bank.start(at.t, h);
        for (e, element) in cx.system.elements.iter().enumerate().filter(|(_, element)| !element.inputs.is_empty()) {
            let values = self.bank.inputs_mut(e, 0);
            cx.inputs_at(e, at.t, values);
            element.check_inputs(at.t, values)?;
        }
        self.see_start(cx, at)?;
        if !std::mem::replace(&mut self.tangent.is_weighed, true) {
            let Tangent { kinematics, slopes, .. } = &mut self.tangent;
            self.rounding.forget();
            crba_into(&cx.system.model, kinematics, &mut self.scratch.workspace, &mut slopes.d_a);
        }
        if let Some(control) = &self.control {
            control.write_inputs(cx, 0, &mut self.bank);
        }
        self.driven.iter_mut().for_each(Vec::clear);
        Ok(())
    }

    /// Takes the nodes of a step that was worked out without them, where it is looked at for changes: inputs, sensors and elements at `nodes`, whose last
    /// one is at `t_end`.
    ///
    /// # Errors
    /// Where an input breaks a rule of its law, or a reference cannot be followed.
    pub(crate) fn take_nodes(
        &mut self,
        cx: Context,
        nodes: [Node; STAGES],
        kinematics: [&Kinematics; STAGES],
    ) -> Result<(), RunError> {
        for (e, element) in cx.system.elements.iter().enumerate().filter(|(_, element)| !element.inputs.is_empty()) {
            for (k, node) in nodes.iter().enumerate() {
                let values = self.bank.inputs_mut(e, k + 1);
                cx.inputs_at(e, node.t, values);
                element.check_inputs(node.t, values)?;
            }
        }
        self.prepare(cx, nodes[STAGES - 1].t)?;
        for (k, (node, kinematics)) in nodes.iter().zip(kinematics).enumerate() {
            self.see(cx, k + 1, [node.q, node.v], kinematics);
        }
        self.answer();
        Ok(())
    }

    /// Goes on to the end of a step that was worked out at one time after another: the forces of the elements there, and the positions and velocities
    /// of the links, which are exchanged for those of the start.
    pub(crate) fn arrive(&mut self, forces: &[f64], kinematics: &mut Kinematics) {
        std::mem::swap(&mut self.tangent.kinematics, kinematics);
        self.tangent.forget();
        self.tangent.is_placed = true;
        for (nodes, force) in self.elements.iter_mut().zip(forces) {
            (nodes.singular, nodes.force) = (0.0, *force);
        }
    }

    /// −M⁻¹ ∂y/∂q of every element over the free velocities.
    fn share_forces(&mut self, nv: usize) {
        let (free, Tangent { slopes, mass, .. }) = (&self.free, &mut self.tangent);
        let right = &mut self.scratch.right;
        let regular = mass.factor_part(&slopes.d_a, nv, free);
        for ElementNodes { gradient, share, .. } in &mut self.elements {
            share.fill(0.0);
            if !regular {
                continue;
            }
            right.clear();
            right.extend(free.iter().map(|&k| -gradient[k]));
            mass.solve(right);
            free.iter().zip(&*right).for_each(|(&k, x)| share[k] = *x);
        }
    }

    /// Through strokes where the rates would be unstable: order below ½ and h² c (γ_0 h)^−alpha gᵀ M⁻¹ g ≥ 10, in sum over such
    /// elements, since several may pull at one joint.
    fn choose_forms(&mut self, cx: Context, h: f64) {
        if !self.may_yield {
            return;
        }
        let mut stiffness = 0.0;
        for (e, (element, nodes)) in cx.system.elements.iter().zip(&self.elements).enumerate() {
            element.law.for_each_springpot(&self.bank.point(e, 0), &mut |term| {
                if term.is_yielding() {
                    let softness: f64 = nodes.gradient.iter().zip(&nodes.share).map(|(g, s)| -g * s).sum();
                    stiffness += h * h * term.stiffness(1.0 / (GAMMA * h)) * softness;
                }
            });
        }
        for (e, element) in cx.system.elements.iter().enumerate() {
            let through_strokes = stiffness >= STIFF && may_yield(element);
            self.bank.set_form(e, if through_strokes { Form::Strokes } else { Form::Rates });
        }
    }

    /// Puts what signals say of the joints at `t` into node `i` (from 0), which is at `q`, `v` and `a`: forces of the actuators, places of joints
    /// that are moved; those that friction holds and that are locked stay at `held`, the coordinates at the start.
    ///
    /// # Errors
    /// [`RunError::NotFinite`].
    pub(crate) fn drive(
        &mut self,
        cx: Context,
        (i, t): (usize, f64),
        held: &[f64],
        [q, v, a]: [&mut [f64]; 3],
    ) -> Result<(), RunError> {
        let (model, driven) = (&cx.system.model, &mut self.driven[i]);
        driven.clear();
        for (j, signals) in self.forward.forced(model) {
            for (k, signal) in model.v_range(j).zip(signals) {
                let force = force_at(cx, k, signal, t)?;
                if !self.friction.holds(k) {
                    driven.push(force);
                    continue;
                }
                let place = model.coordinate_of(k).expect("friction sticks in joints of one degree");
                (q[place], v[k], a[k]) = (held[place], 0.0, 0.0);
            }
        }
        for j in self.forward.locked(model) {
            let own = model.q_range(j);
            q[own.clone()].copy_from_slice(&held[own]);
            a[model.v_range(j)].fill(0.0);
        }
        self.forward.take_paths(model, t, q, v, a)
    }

    /// Puts joints that signals move or that stay back to `q`, the coordinates of all, where they were `kept`.
    pub(crate) fn keep_moved(&self, model: &Model, kept: &[f64], q: &mut [f64]) {
        for j in self.forward.paths(model).map(|(j, _)| j).chain(self.forward.locked(model)) {
            q[model.q_range(j)].copy_from_slice(&kept[model.q_range(j)]);
        }
    }

    /// Sees the robot at node `i` (from 1): what its sensors and its elements are told there.
    pub(crate) fn see(&mut self, cx: Context, i: usize, [q, v]: [&[f64]; 2], kinematics: &Kinematics) {
        let model = &cx.system.model;
        for (e, (element, nodes)) in cx.system.elements.iter().zip(&mut self.elements).enumerate() {
            // The gradient is that of the start.
            let (reading, gradient) = (&mut nodes.readings[i], &mut self.scratch.tau);
            element.measure.read_into(model, kinematics, gradient, reading);
            self.bank.set_stroke(e, i, element.stroke(reading.coordinate), reading.rate);
            if let Some(control) = &mut self.control {
                control.keep_gradient(i, e, gradient);
            }
        }
        if let Some(control) = &mut self.control {
            let read = |e: usize| self.elements[e].read(i);
            control.see(i, &Eye { system: cx.system, t: control.time(i), q, v, kinematics, element: &read });
            control.write_inputs(cx, i, &mut self.bank);
        }
    }

    /// What elements and controllers answer at the nodes that were seen.
    pub(crate) fn answer(&mut self) {
        (0..self.bank.len()).for_each(|e| self.bank.evaluate_element(e));
        if let Some(control) = &mut self.control {
            control.answer(&self.bank);
        }
    }

    /// RNEA + Σ g F + resistance − τ at node `i` (from 1) for the free velocities, behind what `residual` holds.
    pub(crate) fn residual(
        &mut self,
        cx: Context,
        i: usize,
        at: Node,
        kinematics: &Kinematics,
        residual: &mut Vec<f64>,
    ) {
        let (model, Scratch { forces, workspace, tau, .. }) = (&cx.system.model, &mut self.scratch);
        forces.clear();
        for (e, element) in cx.system.elements.iter().enumerate() {
            forces.push(&element.measure, Pull::constant(self.bank.response(e).force[i - 1]));
        }
        forces.inverse_dynamics_into(model, kinematics, (at.q, at.a), workspace, tau);
        add_smooth_resistance(cx.system, at.v, tau);
        self.friction.add_sliding(tau);
        let from = residual.len();
        residual.extend(self.free.iter().zip(&self.driven[i - 1]).map(|(&k, driven)| tau[k] - driven));
        if let Some(control) = &self.control {
            let own = residual[from..].iter_mut().zip(&self.free);
            for (residual, &k) in own.filter(|(_, k)| !cx.holds_force(**k)) {
                *residual -= control.torque(i)[k];
            }
        }
    }

    /// Takes over how forces answer to inputs that follow from the state, at what elements answered last.
    pub(crate) fn take_input_forces(&mut self) {
        if let Some(control) = &mut self.control {
            control.take_input_forces(&self.bank);
        }
    }

    /// How the terms of errors answer to the step, by velocity.
    pub(crate) fn term_responses(&self) -> impl Iterator<Item = (usize, Response)> {
        self.control.iter().flat_map(|control| control.responses())
    }

    /// How all forces answered last to the motion within the step.
    pub(crate) fn couplings(&self) -> Vec<Coupling<'_>> {
        couplings(self.elements.iter().map(|nodes| &nodes.gradient[..]), &self.bank, self.control.as_deref())
    }

    /// Takes what singular starts have in the forces at node `i` (from 1) out of the accelerations `a` (nv).
    pub(crate) fn take_off_singular(&self, i: usize, a: &mut [f64]) {
        for (e, nodes) in self.elements.iter().enumerate() {
            let singular = self.bank.response(e).singular[i - 1];
            for &k in &self.free {
                a[k] -= nodes.share[k] * singular;
            }
        }
    }

    /// What the last step's end had of singular starts, seen from this step's start, out of the accelerations `a` (nv).
    pub(crate) fn take_off_singular_before(&self, a: &mut [f64]) {
        for nodes in &self.elements {
            for &k in &self.free {
                a[k] -= nodes.share[k] * nodes.singular;
            }
        }
    }

    /// The forces of singular starts at `t` of every element, their integrals from `from` on, and the integrals of those.
    pub(crate) fn singular_forces(&self, cx: Context, from: f64, t: f64, forces: &mut Vec<[f64; 3]>) {
        forces.clear();
        if !self.is_singular {
            return;
        }
        let mut inputs = Vec::new();
        for (e, element) in cx.system.elements.iter().enumerate() {
            inputs.clear();
            inputs.resize(element.inputs.len(), InputValue::default());
            cx.inputs_at(e, t, &mut inputs);
            let mut sum = [0.0; 3];
            self.bank.for_each_singularity(e, &inputs, &mut |term| {
                sum.iter_mut().zip(singular_parts(&term, from, t)).for_each(|(sum, part)| *sum += part);
            });
            forces.push(sum);
        }
    }

    /// What these forces do to velocity `k`: its acceleration, velocity and travel.
    pub(crate) fn singular_motion(&self, k: usize, forces: &[[f64; 3]]) -> [f64; 3] {
        forces
            .iter()
            .zip(&self.elements)
            .fold([0.0; 3], |sum, (force, nodes)| [0, 1, 2].map(|order| sum[order] + nodes.share[k] * force[order]))
    }

    /// Goes on to the end of the step, where the links are as `kinematics` tell, which is given those at the start.
    pub(crate) fn accept(&mut self, kinematics: &mut Kinematics) {
        std::mem::swap(&mut self.tangent.kinematics, kinematics);
        self.tangent.forget();
        self.tangent.is_placed = true;
        for (e, nodes) in self.elements.iter_mut().enumerate() {
            let response = self.bank.response(e);
            nodes.singular = response.singular[STAGES - 1];
            nodes.force = response.force[STAGES - 1] - nodes.singular;
        }
    }

    /// The start is another one: what was known of it holds no longer.
    pub(crate) fn restart(&mut self) {
        self.tangent.forget();
        self.elements.iter_mut().for_each(|nodes| nodes.singular = 0.0);
    }

    /// The force of element `e` at the start, without the share of a singular start, N or N·m.
    pub(crate) fn force_at_start(&self, e: usize) -> f64 {
        self.elements[e].force
    }

    /// The force of element `e` that the accelerations at the start go with, N or N·m.
    pub(crate) fn force_behind(&self, e: usize) -> f64 {
        self.elements[e].force + self.elements[e].singular
    }

    /// How stiff the end stops and other kinks of forces are that velocity `k` moves, N·m/rad or N/m, at the start.
    pub(crate) fn stiffness_of_stops(&self, cx: Context, k: usize) -> f64 {
        let stops = self.kinks.elements().iter();
        stops.map(|&e| self.stiffness(cx, e, 0.0) * self.elements[e].gradient[k].powi(2)).sum()
    }

    /// How fast the stroke of element `e` may be where velocity k is `coming(k)`, m/s or rad/s.
    pub(crate) fn coming_rate(&self, e: usize, coming: impl Fn(usize) -> f64) -> f64 {
        self.elements[e].gradient.iter().enumerate().map(|(k, g)| g.abs() * coming(k)).sum()
    }

    /// How far and how fast velocity `k` of this mass still has to go for a memory of its error; zeros without one.
    pub(crate) fn missing(&self, k: usize, mass: f64) -> [f64; 2] {
        self.control.as_ref().map_or([0.0; 2], |control| control.missing(k, mass))
    }

    /// How far and how fast each velocity that a controller drives is to go with its reference.
    pub(crate) fn going(&self) -> impl Iterator<Item = (usize, [f64; 2])> {
        self.control.iter().flat_map(|control| control.going())
    }
}

impl Tangent {
    /// The start is another one.
    pub(super) fn forget(&mut self) {
        (self.is_known, self.is_seen, self.is_weighed, self.is_placed) = (false, false, false, false);
    }
}

/// Whether a springpot of the element can be unstable where it is stiff.
fn may_yield(element: &Element) -> bool {
    let inputs = vec![InputValue::default(); element.inputs.len()];
    let mut may_yield = false;
    let at = Point { t: 0.0, stroke: 0.0, rate: 0.0, inputs: &inputs };
    element.law.for_each_springpot(&at, &mut |term| may_yield |= term.is_yielding());
    may_yield
}

/// A share s·t^−alpha of a singular start in a force at t, its integral from `from` on, and the integral of that.
pub(super) fn singular_parts(term: &crate::law::Term, from: f64, t: f64) -> [f64; 3] {
    let alpha = term.order;
    let parts = |t: f64| {
        let value = if t == 0.0 { 0.0 } else { term.coefficient * t.powf(-alpha) };
        [value, value * t / (1.0 - alpha), value * t * t / ((1.0 - alpha) * (2.0 - alpha))]
    };
    let ([value, once, twice], [_, before, before_twice]) = (parts(t), parts(from));
    [value, once - before, twice - before_twice - (t - from) * before]
}
