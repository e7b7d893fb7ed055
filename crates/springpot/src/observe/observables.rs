//! What can be observed of a system, in the order of its rows.

use super::element::ElementQuantity;
use super::quantity::{Axis, EnergyQuantity, Quantity};
use super::units::ObservedElement;
use crate::elements::Element;
use crate::law::{InputValue, Point};
use crate::model::{Label, Model};
use crate::table::Column;

/// How many numbers a system has, and which of those that not all systems have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Shape {
    pub(crate) nq: usize,
    pub(crate) nv: usize,
    /// Whether there is a gripper.
    pub(crate) gripper: bool,
    /// Whether its wanted point is known.
    pub(crate) wanted: bool,
    /// Whether rows tell what is lost in joints.
    pub(crate) joint_losses: bool,
}

impl Shape {
    /// Calls `visit` with every quantity in the order of the rows; `inputs` says how many each element has.
    pub(crate) fn each(self, inputs: impl IntoIterator<Item = usize>, visit: &mut impl FnMut(Quantity)) {
        let Self { nq, nv, gripper, wanted, joint_losses } = self;
        visit(Quantity::Time);
        (0..nq).map(Quantity::Coordinate).for_each(&mut *visit);
        (0..nv).map(Quantity::Velocity).for_each(&mut *visit);
        (0..nv).map(Quantity::Acceleration).for_each(&mut *visit);
        (0..nv).map(Quantity::Torque).for_each(&mut *visit);
        for (e, inputs) in inputs.into_iter().enumerate() {
            let before = ElementQuantity::BEFORE_FORCES.into_iter();
            let forces = (0..nv).map(ElementQuantity::GeneralizedForce);
            let inputs = (0..inputs).map(ElementQuantity::InputValue);
            let all = before.chain(forces).chain(ElementQuantity::BEFORE_INPUTS).chain(inputs);
            all.map(|quantity| Quantity::Element(e, quantity)).for_each(&mut *visit);
        }
        if gripper {
            Axis::ALL.into_iter().map(Quantity::Gripper).for_each(&mut *visit);
        }
        if gripper && wanted {
            visit(Quantity::GripperError);
        }
        let told = |energy: &EnergyQuantity| *energy != EnergyQuantity::Joints || joint_losses;
        EnergyQuantity::ALL.into_iter().filter(told).map(Quantity::Energy).for_each(&mut *visit);
    }
}

/// What can be observed of a system: its quantities in the order of its rows, with names, units and meanings.
#[derive(Debug, Clone)]
pub struct Observables {
    shape: Shape,
    coordinates: Vec<Label>,
    velocities: Vec<Label>,
    elements: Vec<ObservedElement>,
}

impl Observables {
    /// Those of a robot with its elements, without a gripper; rows do not tell what is lost in joints.
    pub fn new<'a>(model: &Model, elements: impl IntoIterator<Item = &'a Element>) -> Self {
        let element = |element: &Element| ObservedElement {
            name: element.name.clone(),
            kind: element.measure.kind(),
            is_rotation: element.measure.is_rotation(),
            derivative_unit: derivative_unit(element),
            entry: element.entry.clone(),
        };
        let (nq, nv) = (model.nq(), model.nv());
        Self {
            shape: Shape { nq, nv, gripper: false, wanted: false, joint_losses: false },
            coordinates: model.q_labels(),
            velocities: model.v_labels(),
            elements: elements.into_iter().map(element).collect(),
        }
    }

    /// With a gripper, and its distance from the wanted point where that is known.
    #[must_use]
    pub fn with_gripper(self, wanted: bool) -> Self {
        Self { shape: Shape { gripper: true, wanted, ..self.shape }, ..self }
    }

    /// With the energy lost in damping and friction of joints.
    #[must_use]
    pub fn with_joint_losses(self) -> Self {
        Self { shape: Shape { joint_losses: true, ..self.shape }, ..self }
    }

    /// All quantities, in the order of the rows.
    pub fn quantities(&self) -> Vec<Quantity> {
        let mut quantities = Vec::new();
        let inputs = self.elements.iter().map(|element| element.entry.inputs.len());
        self.shape.each(inputs, &mut |quantity| quantities.push(quantity));
        quantities
    }

    /// Where a quantity stands in a row; `None` where the system has no such quantity.
    pub fn position(&self, quantity: Quantity) -> Option<usize> {
        let (mut position, mut count) = (None, 0);
        let inputs = self.elements.iter().map(|element| element.entry.inputs.len());
        self.shape.each(inputs, &mut |other| {
            if other == quantity {
                position = Some(count);
            }
            count += 1;
        });
        position
    }

    /// The columns of the rows, in order.
    pub fn columns(&self) -> Vec<Column> {
        self.quantities().into_iter().map(|quantity| self.column(quantity)).collect()
    }

    /// Name, unit and meaning of a quantity.
    ///
    /// # Panics
    /// Where an index is none of this system.
    pub fn column(&self, quantity: Quantity) -> Column {
        let named = self.named(quantity);
        let meaning = match quantity {
            Quantity::Element(e, ElementQuantity::InputValue(i)) => {
                let words = &self.elements[e].entry.inputs[i].meaning;
                Quantity::Element(&*self.elements[e].name, ElementQuantity::InputValue(&**words)).meaning()
            }
            Quantity::Element(e, quantity) => {
                let element = &self.elements[e];
                quantity.named(element, &self.velocities).meaning_on(element.kind, &element.name)
            }
            _ => named.meaning(),
        };
        Column::new(named.to_string(), self.unit(quantity), meaning)
    }

    /// The quantity with names in place of indices.
    ///
    /// # Panics
    /// Where an index is none of this system.
    pub fn named(&self, quantity: Quantity) -> Quantity<&str> {
        let velocity = |k: usize| self.velocities[k].name.as_str();
        match quantity {
            Quantity::Time => Quantity::Time,
            Quantity::Coordinate(k) => Quantity::Coordinate(&self.coordinates[k].name),
            Quantity::Velocity(k) => Quantity::Velocity(velocity(k)),
            Quantity::Acceleration(k) => Quantity::Acceleration(velocity(k)),
            Quantity::Torque(k) => Quantity::Torque(velocity(k)),
            Quantity::Element(e, quantity) => {
                let element = &self.elements[e];
                Quantity::Element(&element.name, quantity.named(element, &self.velocities))
            }
            Quantity::Gripper(axis) => Quantity::Gripper(axis),
            Quantity::GripperError => Quantity::GripperError,
            Quantity::Energy(energy) => Quantity::Energy(energy),
        }
    }

    /// SI unit of a quantity; empty for a pure number.
    ///
    /// # Panics
    /// Where an index is none of this system.
    pub fn unit(&self, quantity: Quantity) -> &str {
        match quantity {
            Quantity::Time => "s",
            Quantity::Coordinate(k) => self.coordinates[k].dimension.units().coordinate,
            Quantity::Velocity(k) => self.velocities[k].dimension.units().velocity,
            Quantity::Acceleration(k) => self.velocities[k].dimension.units().acceleration,
            Quantity::Torque(k) => self.velocities[k].dimension.units().force,
            Quantity::Element(e, quantity) => quantity.unit(&self.elements[e], &self.velocities),
            Quantity::Gripper(_) | Quantity::GripperError => "m",
            Quantity::Energy(_) => "J",
        }
    }
}

/// Unit of D^alpha x, the same for every alpha that a sweep may go through.
fn derivative_unit(element: &Element) -> &'static str {
    let inputs = vec![InputValue::default(); element.inputs.len()];
    let [any, zero, one] = match element.measure.is_rotation() {
        true => ["rad/s^alpha", "rad", "rad/s"],
        false => ["m/s^alpha", "m", "m/s"],
    };
    match element.law.reported_order(&Point { t: 0.0, stroke: 0.0, rate: 0.0, inputs: &inputs }) {
        _ if element.entry.params.iter().any(|param| param.name == "alpha") => any,
        0.0 => zero,
        _ => one,
    }
}
