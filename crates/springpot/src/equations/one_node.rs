//! The equations of motion at the one node of a step of one size: its end, or its middle.

use super::context::Context;
use super::drives::force_at;
use super::resistance::{add_secants, add_smooth_resistance};
use crate::actuation::Forward;
use crate::collocation::Nodes;
use crate::dynamics::{Kinematics, RneaDerivatives, Workspace};
use crate::elements::{Element, ElementBank, Forces, Pull, Reading};
use crate::law::Response;
use crate::model::Model;
use crate::system::System;
use crate::system::error::RunError;
use std::sync::Arc;

/// The robot at one time, positions and velocities of its links included.
#[derive(Debug, Clone)]
pub(crate) struct Place {
    pub(crate) t: f64,
    pub(crate) q: Vec<f64>,
    pub(crate) v: Vec<f64>,
    pub(crate) kinematics: Kinematics,
}

/// The forces that act at the node, and how they answer to the motion.
#[derive(Debug, Clone)]
pub(crate) struct OneNode {
    nodes: Nodes,
    forward: Arc<Forward>,
    elements: Vec<ElementStep>,
    /// Forces of the actuators on the velocities that forces drive.
    driven: Vec<f64>,
    forces: Forces,
    workspace: Workspace,
    slopes: RneaDerivatives,
    tau: Vec<f64>,
}

/// One element over a step.
#[derive(Debug, Clone)]
struct ElementStep {
    /// At the start and at the end.
    ends: [Reading; 2],
    /// At the node, where that is not the end.
    node: Reading,
    /// ∂y/∂q at the node and at the end.
    gradients: [Vec<f64>; 2],
}

impl ElementStep {
    /// At the start of a motion.
    ///
    /// # Errors
    /// Where its force has no direction.
    fn new(element: &Element, model: &Model, start: &Kinematics) -> Result<Self, RunError> {
        let (reading, gradient) = element.measure.read(model, start);
        element.check_direction(0.0, &reading)?;
        let ends = [reading.clone(), reading.clone()];
        Ok(Self { ends, node: reading, gradients: [gradient.clone(), gradient] })
    }
}

impl OneNode {
    /// At the start of a motion.
    ///
    /// # Errors
    /// Where the force of an element has no direction.
    pub(crate) fn new(
        system: &System,
        forward: &Arc<Forward>,
        nodes: Nodes,
        start: &Kinematics,
    ) -> Result<Self, RunError> {
        let model = &system.model;
        let elements = system.elements.iter().map(|element| ElementStep::new(element, model, start));
        Ok(Self {
            nodes,
            elements: elements.collect::<Result<_, _>>()?,
            driven: vec![0.0; forward.free_velocities(model).len()],
            forward: forward.clone(),
            forces: Forces::with_room_for(system.elements.iter().map(|element| &element.measure)),
            workspace: Workspace::new(model),
            slopes: RneaDerivatives::new(model),
            tau: vec![0.0; model.nv()],
        })
    }

    fn ends_at_node(&self) -> bool {
        self.nodes.positions()[0] == 1.0
    }

    /// What drives the joints.
    pub(crate) fn forward(&self) -> &Forward {
        &self.forward
    }

    /// Coordinate and rate of element `e` at the start of the step.
    pub(crate) fn read(&self, e: usize) -> [f64; 2] {
        let [start, _] = &self.elements[e].ends;
        [start.coordinate, start.rate]
    }

    /// The readings of the elements at the start and at the end of the step.
    pub(crate) fn ends(&self) -> impl Iterator<Item = &[Reading; 2]> {
        self.elements.iter().map(|element| &element.ends)
    }

    /// ∂y/∂q of element `e` at the start of the step.
    pub(crate) fn gradient(&self, e: usize) -> &[f64] {
        let [at_node, at_end] = &self.elements[e].gradients;
        if self.ends_at_node() { at_node } else { at_end }
    }

    /// The force of element `e` in the step.
    pub(crate) fn force(&self, e: usize) -> f64 {
        self.forces.values()[e]
    }

    /// Begins a step of size `h` from `t`, whose node is at the time `at`: what is known before it is found.
    ///
    /// # Errors
    /// Where an input breaks a rule of its law.
    pub(crate) fn begin(&self, cx: Context, bank: &mut ElementBank, [t, at]: [f64; 2], h: f64) -> Result<(), RunError> {
        bank.start(t, h);
        bank.set_nodes(self.nodes);
        for (e, (element, step)) in cx.system.elements.iter().zip(&self.elements).enumerate() {
            let [start, _] = &step.ends;
            for (point, time) in [t, at].into_iter().enumerate() {
                bank.set_stroke(e, point, element.stroke(start.coordinate), start.rate);
                let values = bank.inputs_mut(e, point);
                cx.inputs_at(e, time, values);
                element.check_inputs(time, values)?;
            }
        }
        bank.prepare();
        Ok(())
    }

    /// Puts what signals say of the joints into the node and the end of the step, and into the accelerations `a` at the node.
    ///
    /// # Errors
    /// [`RunError::NotFinite`].
    pub(crate) fn drive(
        &mut self,
        cx: Context,
        node: &mut Place,
        end: &mut Place,
        a: &mut [f64],
    ) -> Result<(), RunError> {
        let model = &cx.system.model;
        for (driven, (k, signal)) in self.driven.iter_mut().zip(self.forward.forces(model)) {
            *driven = force_at(cx, k, signal, node.t)?;
        }
        for j in self.forward.locked(model) {
            a[model.v_range(j)].fill(0.0);
        }
        // The accelerations at the end are not asked for.
        self.forward.take_paths(model, end.t, &mut end.q, &mut end.v, a)?;
        self.forward.take_paths(model, node.t, &mut node.q, &mut node.v, a)
    }

    /// Takes the places of all joints but those that signals move.
    pub(crate) fn move_others(&self, model: &Model, moved: &[f64], q: &mut [f64]) {
        for j in self.forward.forced(model).map(|(j, _)| j).chain(self.forward.locked(model)) {
            q[model.q_range(j)].copy_from_slice(&moved[model.q_range(j)]);
        }
    }

    /// Asks the elements.
    ///
    /// With the midpoint rule, which acts along ∂y/∂q at the node, the law gets the mean of the strokes at both ends and the
    /// rate (x_1 − x_0)/h. The work of a spring is then the energy that it takes up, but for terms of order h³: with strokes
    /// and rates of the node itself stiff elements make energy.
    ///
    /// # Errors
    /// Where an element has no direction.
    pub(crate) fn answer(
        &mut self,
        cx: Context,
        bank: &mut ElementBank,
        [node, end]: [&Place; 2],
        h: f64,
    ) -> Result<(), RunError> {
        let (ends_at_node, model) = (self.ends_at_node(), &cx.system.model);
        self.forces.clear();
        for (e, element) in cx.system.elements.iter().enumerate() {
            let ElementStep { ends: [at_start, at_end], node: at_node, gradients: [gradient, gradient_at_end] } =
                &mut self.elements[e];
            let measure = &element.measure;
            let (reading, coordinate, rate) = if ends_at_node {
                measure.read_into(model, &node.kinematics, gradient, at_end);
                (&*at_end, at_end.coordinate, at_end.rate)
            } else {
                measure.read_into(model, &node.kinematics, gradient, at_node);
                measure.read_into(model, &end.kinematics, gradient_at_end, at_end);
                let travel = at_end.coordinate - at_start.coordinate;
                (&*at_node, 0.5 * (at_start.coordinate + at_end.coordinate), travel / h)
            };
            if reading.coordinate.is_finite() {
                element.check_direction(node.t, reading)?;
            }
            bank.set_stroke(e, 1, element.stroke(coordinate), rate);
            bank.set_resolution(e, element.resolution(reading.coordinate));
            bank.evaluate_element(e);
            let Response { force, d_stroke, d_rate, .. } = bank.response(e);
            let [d_coordinate, d_rate] = if ends_at_node { [d_stroke[0][0], d_rate[0][0]] } else { [0.0; 2] };
            self.forces.push(measure, Pull { force: force[0], d_coordinate, d_rate });
        }
        Ok(())
    }

    /// What is missing of τ at the node, in the order of the velocities `free`.
    pub(crate) fn residual(&mut self, cx: Context, free: &[usize], node: &Place, a: &[f64], residual: &mut [f64]) {
        let Self { forces, workspace, tau, driven, .. } = self;
        forces.inverse_dynamics_into(&cx.system.model, &node.kinematics, (&node.q, a), workspace, tau);
        add_smooth_resistance(cx.system, &node.v, tau);
        for ((r, &k), driven) in residual.iter_mut().zip(free).zip(&*driven) {
            *r = driven - tau[k];
        }
    }

    /// The mass matrix, and the derivatives of all forces by q and v at the node, those of the elements included; `kappa` is the time from the start
    /// of the step to the node, s.
    pub(crate) fn linearise(
        &mut self,
        cx: Context,
        bank: &ElementBank,
        node: &Place,
        a: &[f64],
        kappa: f64,
    ) -> &RneaDerivatives {
        let (ends_at_node, model) = (self.ends_at_node(), &cx.system.model);
        let Self { forces, workspace, slopes, elements, .. } = self;
        forces.inverse_dynamics_derivatives_into(model, &node.kinematics, a, workspace, slopes);
        add_secants(cx.system, &node.v, &mut slopes.d_v);
        if !ends_at_node {
            // ∂F/∂a = (κ² ∂F/∂x + κ ∂F/∂x') ∂y/∂q, taken at the end; added to the place of κ² K.
            for (e, step) in elements.iter().enumerate() {
                let Response { d_stroke, d_rate, .. } = bank.response(e);
                let stiffness = d_stroke[0][0] + d_rate[0][0] / kappa;
                let [at_node, at_end] = &step.gradients;
                for (line, push) in slopes.d_q.chunks_exact_mut(model.nv()).zip(at_node) {
                    for (entry, g) in line.iter_mut().zip(at_end) {
                        *entry += stiffness * push * g;
                    }
                }
            }
        }
        slopes
    }

    /// Whether the elements have a direction at the end of the step, which is at `t`.
    ///
    /// # Errors
    /// Where one has lost it.
    pub(crate) fn check_end(&self, cx: Context, t: f64) -> Result<(), RunError> {
        for (element, step) in cx.system.elements.iter().zip(&self.elements) {
            let [start, end] = &step.ends;
            if let Some(why) = start.lost_until(end).or(end.check().err()) {
                return Err(element.without_direction(t, why));
            }
        }
        Ok(())
    }

    /// Goes on to the end of the step.
    pub(crate) fn accept(&mut self) {
        self.elements.iter_mut().for_each(|element| element.ends.swap(0, 1));
    }

    /// Goes on from where a step starts elsewhere.
    pub(crate) fn go_on(&mut self, cx: Context, start: &Kinematics) {
        for (element, step) in cx.system.elements.iter().zip(&mut self.elements) {
            let [at_node, at_end] = &mut step.gradients;
            element.measure.read_into(&cx.system.model, start, at_end, &mut step.ends[0]);
            // Where the node is the end of the step.
            at_node.copy_from_slice(at_end);
        }
    }
}
