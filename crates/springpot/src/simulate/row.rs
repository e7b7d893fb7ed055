//! The columns of the results and how a row is filled.

use super::System;
use super::ledger::Balance;
use super::moment::Moment;
use crate::element::Element;
use crate::law::{InputValue, Observation, Point};
use crate::model::{Label, Measure};
use crate::table::Column;

/// Units of generalized forces, by [`Measure`].
const FORCES: [&str; 3] = ["N*m", "N", ""];

/// One element in one row.
#[derive(Debug, Clone, Copy)]
pub(super) struct ElementRow {
    pub(super) observation: Observation,
    /// Dissipated and supplied since t = 0, J; NaN where unknown.
    pub(super) dissipated: f64,
    pub(super) input: f64,
}

impl System {
    /// The columns of a run's rows, in order.
    pub fn columns(&self) -> Vec<Column> {
        let model = &self.model;
        let (coordinates, velocities) = (model.q_labels(), model.v_labels());
        let mut columns = vec![Column::new("t", "s", "time")];
        for (prefix, labels, units, meaning) in [
            ("q", &coordinates, ["rad", "m", "1"], "coordinate"),
            ("v", &velocities, ["rad/s", "m/s", ""], "velocity"),
            ("a", &velocities, ["rad/s^2", "m/s^2", ""], "acceleration"),
            ("tau", &velocities, FORCES, "actuator force"),
        ] {
            for label in labels {
                let name = format!("{prefix}.{}", label.name);
                columns.push(Column::new(name, unit(label, units), format!("{meaning} of {}", label.name)));
            }
        }
        for element in &self.elements {
            let name = &element.name;
            let mut add = |key: &str, unit: &str, meaning: String| {
                columns.push(Column::new(format!("{name}.{key}"), unit, meaning));
            };
            add("length", "m", format!("length of {name}"));
            add("stroke", "m", format!("length of {name} less its rest length"));
            add("rate", "m/s", format!("rate of the stroke of {name}"));
            add("derivative", derivative_unit(element), format!("fractional derivative of the stroke of {name}"));
            add("force", "N", format!("force of {name}, positive in tension"));
            for label in &velocities {
                let joint = &label.name;
                add(&format!("Q.{joint}"), unit(label, FORCES), format!("generalized force of {name} on {joint}"));
            }
            add("stored", "J", format!("energy stored in {name}"));
            add("dissipated", "J", format!("energy dissipated in {name} since t = 0"));
            add("input", "J", format!("energy supplied by the inputs of {name} since t = 0"));
            for input in &element.entry.inputs {
                add(&input.name, &input.unit, format!("{} of {name}", input.meaning));
            }
        }
        if self.gripper.is_some() {
            for axis in ["x", "y", "z"] {
                columns.push(Column::new(format!("gripper.{axis}"), "m", format!("world {axis} of the gripper")));
            }
            if self.motion.has_path() {
                columns.push(Column::new("gripper.error", "m", "distance of the gripper from the wanted point"));
            }
        }
        columns.push(Column::new("energy.kinetic", "J", "kinetic energy"));
        columns.push(Column::new(
            "energy.potential",
            "J",
            "potential energy in the field of gravity, 0 at the world origin",
        ));
        columns.push(Column::new("energy.actuators", "J", "work of the actuators since t = 0"));
        if self.tells_joint_losses {
            columns.push(Column::new("energy.joints", "J", "energy lost in joint damping and friction since t = 0"));
        }
        columns.push(Column::new(
            "energy.residual",
            "J",
            "kinetic + potential + stored + dissipated - input - actuators, less its value at t = 0",
        ));
        columns
    }

    /// Fills one row; `balance` holds the work and losses, `residual` the ledger's residual, NaN where unknown.
    pub(super) fn fill_row(
        &self,
        moment: &Moment,
        elements: &[ElementRow],
        balance: &Balance,
        joints: f64,
        residual: f64,
        row: &mut Vec<f64>,
    ) {
        row.clear();
        row.push(moment.t);
        row.extend(&moment.q);
        row.extend(&moment.v);
        row.extend(&moment.a);
        for j in 0..self.model.nv() {
            let from_elements: f64 = elements
                .iter()
                .zip(&moment.elements)
                .map(|(row, state)| generalized_force(row.observation.force(), state.gradient[j]))
                .sum();
            row.push(moment.driven[j].unwrap_or(moment.rigid[j] - from_elements));
        }
        for (ElementRow { observation, dissipated, input }, state) in elements.iter().zip(&moment.elements) {
            let known = observation.stored.is_some();
            row.extend([state.length, state.stroke, state.rate, observation.derivative, observation.force()]);
            row.extend(state.gradient.iter().map(|g| generalized_force(observation.force(), *g)));
            row.push(observation.stored.unwrap_or(f64::NAN));
            row.push(if known { *dissipated } else { f64::NAN });
            row.push(*input);
            row.extend(state.inputs.iter().map(|input| input.value));
        }
        if self.gripper.is_some() {
            row.extend(moment.gripper);
            row.extend(moment.gripper_error);
        }
        row.extend([moment.kinetic, moment.potential, balance.actuators]);
        if self.tells_joint_losses {
            row.push(joints);
        }
        row.push(residual);
        // No field says -0.
        row.iter_mut().for_each(|value| *value += 0.0);
    }
}

/// The unit of a number, from those for angles, lengths and quaternions.
fn unit<'a>(label: &Label, [angle, length, quaternion]: [&'a str; 3]) -> &'a str {
    match label.measure {
        Measure::Angle => angle,
        Measure::Length => length,
        Measure::Quaternion => quaternion,
    }
}

/// Q_b = −F·∂l/∂q_b.
fn generalized_force(force: f64, gradient: f64) -> f64 {
    -force * gradient
}

/// Unit of D^alpha x, the same for every alpha that a sweep may go through.
fn derivative_unit(element: &Element) -> &'static str {
    let inputs = vec![InputValue::default(); element.inputs.len()];
    match element.law.reported_order(&Point { t: 0.0, stroke: 0.0, rate: 0.0, inputs: &inputs }) {
        _ if element.entry.params.iter().any(|param| param.name == "alpha") => "m/s^alpha",
        0.0 => "m",
        _ => "m/s",
    }
}
