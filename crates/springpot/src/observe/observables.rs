//! What can be observed of a system, in the order of its rows.

use super::element::{ElementQuantity, LeafQuantity};
use super::quantity::{Axis, EnergyQuantity, Quantity};
use super::units::ObservedElement;
use crate::elements::Element;
use crate::law::{InputValue, Point};
use crate::model::{Label, Model};
use crate::table::Column;

/// How many numbers a system has, and which of those that not all systems have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Shape {
    nq: usize,
    nv: usize,
    /// Whether there is a gripper.
    pub(crate) gripper: bool,
    /// Whether its wanted point is known.
    pub(crate) wanted: bool,
    /// Whether rows tell what is lost in joints.
    pub(crate) joint_losses: bool,
    /// Whether rows tell the leaves of elements.
    pub(crate) leaves: bool,
    /// How many derivatives rows tell.
    pub(crate) derivatives: usize,
}

/// How many numbers an element has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct ElementShape {
    /// Whether rows tell it.
    pub(crate) shown: bool,
    pub(crate) inputs: usize,
    pub(crate) leaves: usize,
    /// Whether its law has one derivative to tell.
    pub(crate) derivative: bool,
    /// How many numbers its law tells of itself.
    pub(crate) told: usize,
}

impl Shape {
    /// Calls `visit` with every quantity in the order of the rows.
    pub(crate) fn each(self, elements: impl IntoIterator<Item = ElementShape>, visit: &mut impl FnMut(Quantity)) {
        let Self { nq, nv, gripper, wanted, joint_losses, leaves: tells_leaves, derivatives } = self;
        visit(Quantity::Time);
        (0..nq).map(Quantity::Coordinate).for_each(&mut *visit);
        (0..nv).map(Quantity::Velocity).for_each(&mut *visit);
        (0..nv).map(Quantity::Acceleration).for_each(&mut *visit);
        (0..nv).map(Quantity::Torque).for_each(&mut *visit);
        let shown = elements.into_iter().enumerate().filter(|(_, element)| element.shown);
        for (e, ElementShape { inputs, leaves, derivative, told, .. }) in shown {
            let known = |quantity: &ElementQuantity| *quantity != ElementQuantity::Derivative || derivative;
            let before = ElementQuantity::BEFORE_FORCES.into_iter().filter(known);
            let forces = (0..nv).map(ElementQuantity::GeneralizedForce);
            let told = (0..told).map(ElementQuantity::Told);
            let inputs = (0..inputs).map(ElementQuantity::InputValue);
            let leaves = 0..if tells_leaves { leaves } else { 0 };
            let leaves =
                leaves.flat_map(|leaf| LeafQuantity::ALL.map(|quantity| ElementQuantity::Leaf(leaf, quantity)));
            let all =
                before.chain(forces).chain(ElementQuantity::BEFORE_INPUTS).chain(told).chain(inputs).chain(leaves);
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
        (0..derivatives).map(Quantity::Derivative).for_each(&mut *visit);
    }
}

/// What can be observed of a system: its quantities in the order of its rows, with names, units and meanings.
#[derive(Debug, Clone)]
pub struct Observables {
    shape: Shape,
    coordinates: Vec<Label>,
    velocities: Vec<Label>,
    elements: Vec<ObservedElement>,
    derivatives: Vec<Column>,
}

impl Observables {
    /// Those of a robot with its elements, without a gripper; rows do not tell what is lost in joints.
    pub fn new<'a>(model: &Model, elements: impl IntoIterator<Item = &'a Element>) -> Self {
        let element = |element: &Element| ObservedElement {
            name: element.name.clone(),
            shown: element.shown,
            kind: element.measure.kind(),
            is_rotation: element.measure.is_rotation(),
            derivative_unit: derivative_unit(element),
            tells_derivative: element.law.tells_derivative(),
            tells: element.law.tells(),
            leaves: element.law.leaf_names().into_iter().zip(leaf_units(element)).collect(),
            entry: element.entry.clone(),
        };
        let (nq, nv) = (model.nq(), model.nv());
        Self {
            shape: Shape { nq, nv, gripper: false, wanted: false, joint_losses: false, leaves: false, derivatives: 0 },
            coordinates: model.q_labels(),
            velocities: model.v_labels(),
            elements: elements.into_iter().map(element).collect(),
            derivatives: Vec::new(),
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

    /// With the leaves of the elements' laws.
    #[must_use]
    pub fn with_leaves(self) -> Self {
        Self { shape: Shape { leaves: true, ..self.shape }, ..self }
    }

    /// With these derivatives behind all else.
    #[must_use]
    pub fn with_derivatives(self, derivatives: Vec<Column>) -> Self {
        Self { shape: Shape { derivatives: derivatives.len(), ..self.shape }, derivatives, ..self }
    }

    /// All quantities, in the order of the rows.
    pub fn quantities(&self) -> Vec<Quantity> {
        let mut quantities = Vec::new();
        self.shape.each(self.element_shapes(), &mut |quantity| quantities.push(quantity));
        quantities
    }

    /// Where a quantity stands in a row; `None` where the system has no such quantity.
    pub fn position(&self, quantity: Quantity) -> Option<usize> {
        let (mut position, mut count) = (None, 0);
        self.shape.each(self.element_shapes(), &mut |other| {
            if other == quantity {
                position = Some(count);
            }
            count += 1;
        });
        position
    }

    fn element_shapes(&self) -> impl Iterator<Item = ElementShape> + '_ {
        self.elements.iter().map(|element| ElementShape {
            shown: element.shown,
            inputs: element.entry.inputs.len(),
            leaves: element.leaves.len(),
            derivative: element.tells_derivative,
            told: element.tells.len(),
        })
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
        if let Quantity::Derivative(k) = quantity {
            return self.derivatives[k].clone();
        }
        let named = self.named(quantity);
        let meaning = match quantity {
            Quantity::Element(e, ElementQuantity::InputValue(i)) => {
                let words = &self.elements[e].entry.inputs[i].meaning;
                Quantity::Element(&*self.elements[e].name, ElementQuantity::InputValue(&**words)).meaning()
            }
            Quantity::Element(e, ElementQuantity::Told(i)) => {
                self.elements[e].tells[i].meaning_of(&self.elements[e].name)
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
            Quantity::Derivative(k) => Quantity::Derivative(&self.derivatives[k].name),
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
            Quantity::Derivative(k) => &self.derivatives[k].unit,
        }
    }
}

/// Units of the derivatives of leaves, in their order.
fn leaf_units(element: &Element) -> Vec<&'static str> {
    let inputs = vec![InputValue::default(); element.inputs.len()];
    let at = Point { t: 0.0, stroke: 0.0, rate: 0.0, inputs: &inputs };
    let [any, zero, one] = units_of_derivative(element.measure.is_rotation());
    let orders = element.law.leaf_orders(&at).into_iter();
    orders.map(|order| order.map_or(any, |order| if order == 0.0 { zero } else { one })).collect()
}

/// Units of D^alpha x, of x and of x'.
fn units_of_derivative(is_rotation: bool) -> [&'static str; 3] {
    if is_rotation { ["rad/s^alpha", "rad", "rad/s"] } else { ["m/s^alpha", "m", "m/s"] }
}

/// Unit of D^alpha x, the same for every alpha that a sweep may go through.
fn derivative_unit(element: &Element) -> &'static str {
    let inputs = vec![InputValue::default(); element.inputs.len()];
    let [any, zero, one] = units_of_derivative(element.measure.is_rotation());
    let at = Point { t: 0.0, stroke: 0.0, rate: 0.0, inputs: &inputs };
    match element.law.reported_order(&at) {
        _ if element.law.leaf_orders(&at).contains(&None) => any,
        0.0 => zero,
        _ => one,
    }
}
