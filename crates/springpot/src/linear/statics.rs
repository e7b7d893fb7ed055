//! A system at rest: the forces that remain, and their derivatives.

use super::control::{self, ControlAtRest, Holding};
use super::error::LinearError;
use crate::actuation::Drive;
use crate::dynamics::{Kinematics, RneaDerivatives, Workspace};
use crate::elements::{Forces, Pull};
use crate::equations::control::Eye;
use crate::law::{AtRest, Heated, InputValue, Point};
use crate::system::{Motion, System};

/// A system at rest in one configuration.
pub(super) struct Statics {
    pub(super) kinematics: Kinematics,
    pub(super) elements: Vec<ElementAtRest>,
    /// What follows from the state, and signals' torques (nv) beside it; none where kinematics are given.
    pub(super) control: ControlAtRest,
    pub(super) torques: Option<Vec<f64>>,
    /// What actuators hold it with: gravity's torques less ΣQ (nv).
    pub(super) holding: Vec<f64>,
    /// Sums of the magnitudes of the terms of `holding` (nv).
    pub(super) sizes: Vec<f64>,
    /// ∂ of `holding` by q, the elements' forces constant; by v; the mass matrix.
    pub(super) slopes: RneaDerivatives,
}

/// An element at rest.
pub(super) struct ElementAtRest {
    pub(super) stroke: f64,
    pub(super) gradient: Vec<f64>,
    pub(super) law: AtRest,
}

impl Statics {
    /// What is missing for an equilibrium on velocity `k`, N·m or N: nothing where an integral holds it, or kinematics are given.
    pub(super) fn missing(&self, k: usize) -> f64 {
        match &self.torques {
            Some(torques) if self.control.held[k].is_none() => self.holding[k] - torques[k] - self.control.torque[k],
            _ => 0.0,
        }
    }

    /// What holds the robot of `system`, nv × nv, integrals apart.
    pub(super) fn stiffness(&self, system: &System) -> Vec<f64> {
        let held = system.elements.iter().zip(&self.elements).map(|(element, at)| Holding {
            gradient: &at.gradient,
            hessian: element.measure.hessian(&system.model, &self.kinematics),
            force: at.law.force,
            stiffness: at.law.stiffness.unwrap_or(0.0),
            tangent: &at.law.tangent,
            stretch: element.law.as_heated().and_then(Heated::stretch),
        });
        self.control.linear.static_stiffness(self.slopes.d_q.clone(), &held.collect::<Vec<_>>())
    }

    /// The sum of the magnitudes of all that acts on velocity `k`.
    pub(super) fn size(&self, k: usize) -> f64 {
        self.sizes[k] + self.torques.as_ref().map_or(0.0, |torques| torques[k].abs()) + self.control.torque[k].abs()
    }
}

impl System {
    /// The system at rest at `q`, inputs as they are at `t`; `held` are the strokes that it starts from.
    pub(super) fn at_rest(&self, q: &[f64], t: f64, held: &[f64]) -> Result<Statics, LinearError> {
        let (model, n) = (&self.model, self.model.nv());
        let still = vec![0.0; n];
        let kinematics = Kinematics::at_velocity(model, q, &still);
        let mut forces = Forces::default();
        let weight = forces.inverse_dynamics(model, [q, &still, &still]);
        let mut sizes: Vec<f64> = weight.iter().map(|torque| torque.abs()).collect();
        let mut elements = Vec::new();
        let mut readings = Vec::new();
        for element in &self.elements {
            let (reading, gradient) = element.measure.read(model, &kinematics);
            reading.check().map_err(|why| LinearError::NoDirection { element: element.name.clone(), why })?;
            readings.push((reading, gradient));
        }
        let coordinates: Vec<f64> = readings.iter().map(|(reading, _)| reading.coordinate).collect();
        let read = |e: usize| [coordinates[e], 0.0];
        let eye = Eye { system: self, t, q, v: &still, kinematics: &kinematics, element: &read };
        for (e, ((element, held), (reading, gradient))) in self.elements.iter().zip(held).zip(readings).enumerate() {
            let mut inputs = vec![InputValue::default(); element.inputs.len()];
            element.inputs_at(t, &mut inputs);
            for (_, input, value) in control::inputs(self, &eye).filter(|(own, ..)| *own == e) {
                inputs[input].value = value;
            }
            for (row, input) in element.entry.inputs.iter().zip(&mut inputs) {
                input.rate = 0.0;
                if !row.range.contains(input.value) {
                    let what = format!("{}.{}", element.name, row.name);
                    return Err(LinearError::Value { what, problem: format!("{} is out of its range", input.value) });
                }
            }
            element.law.check_inputs(&inputs).map_err(|broken| LinearError::Value {
                what: format!("element \"{}\"", element.name),
                problem: broken.rule,
            })?;
            let stroke = element.stroke(reading.coordinate);
            let at = Point { t, stroke, rate: 0.0, inputs: &inputs };
            let law = element.law.at_rest(&at, *held);
            let law = law.ok_or_else(|| LinearError::NoRest { element: element.name.clone(), stroke })?;
            forces.push(&element.measure, Pull::constant(law.force));
            sizes.iter_mut().zip(&gradient).for_each(|(size, g)| *size += (g * law.force).abs());
            elements.push(ElementAtRest { stroke, gradient, law });
        }
        let holding = forces.inverse_dynamics(model, [q, &still, &still]);
        let mut slopes = RneaDerivatives::new(model);
        let mut workspace = Workspace::new(model);
        forces.inverse_dynamics_derivatives_into(model, &kinematics, &still, &mut workspace, &mut slopes);
        let torques = self.torques_at(t)?;
        let mut pull = vec![0.0; n];
        for element in &elements {
            pull.iter_mut().zip(&element.gradient).for_each(|(sum, g)| *sum += g * element.law.force);
        }
        let by_signals = |k: usize| torques.as_ref().map_or(0.0, |torques| torques[k]);
        let needed: Vec<f64> = holding.iter().enumerate().map(|(k, torque)| torque - by_signals(k)).collect();
        let control = control::at_rest(&eye, &pull, &needed)?;
        Ok(Statics { kinematics, elements, control, torques, holding, sizes, slopes })
    }

    /// The strokes at t = 0, from which Caputo's derivatives count.
    pub(super) fn strokes_at_start(&self) -> Vec<f64> {
        // Where the start is not known nothing was held anywhere.
        let Ok(start) = self.state(0.0) else { return vec![0.0; self.elements.len()] };
        let kinematics = Kinematics::at_velocity(&self.model, &start.q, &start.v);
        let stroke = |element: &crate::elements::Element| {
            element.stroke(element.measure.read(&self.model, &kinematics).0.coordinate)
        };
        self.elements.iter().map(stroke).collect()
    }

    /// The velocities that forces move: all of them where kinematics are given, which the actuators then hold.
    pub(super) fn moved_by_forces(&self) -> Vec<usize> {
        match &self.motion {
            Motion::Given(_) => (0..self.model.nv()).collect(),
            Motion::Forward(forward) => forward.free_velocities(&self.model),
        }
    }

    /// The velocities of joints of one degree that signals move in forward dynamics.
    pub(super) fn moved_by_signals(&self) -> Vec<usize> {
        let Motion::Forward(forward) = &self.motion else { return Vec::new() };
        let model = &self.model;
        let joints = model.own_joints().zip(&forward.drives);
        let prescribed = joints.filter(|(_, drive)| matches!(drive, Drive::Prescribed(_)));
        prescribed.map(|(j, _)| model.v_range(j)).filter(|rates| rates.len() == 1).map(|rates| rates.start).collect()
    }

    /// The actuator forces at `t` (nv), 0 where there are none; `None` where kinematics are given.
    fn torques_at(&self, t: f64) -> Result<Option<Vec<f64>>, LinearError> {
        let Motion::Forward(forward) = &self.motion else { return Ok(None) };
        let mut torques = vec![0.0; self.model.nv()];
        for (k, signal) in forward.forces(&self.model) {
            torques[k] = signal.at(t).value;
            if !torques[k].is_finite() {
                let what = format!("tau.{}", self.model.v_labels()[k].name);
                return Err(LinearError::Value { what, problem: format!("{} is no finite number", torques[k]) });
            }
        }
        Ok(Some(torques))
    }
}
