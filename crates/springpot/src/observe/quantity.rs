//! One number of a row: which it is, and what it is called.

use super::element::ElementQuantity;
use crate::elements::Component;
use std::fmt;

/// What can be observed. `Id` says which coordinate, velocity, element or input: its index in a system, or its name as in columns.
///
/// ```
/// use springpot::observe::{ElementQuantity, Quantity};
///
/// let quantity = Quantity::read("strut.Q.q2").expect("the name of a column");
/// assert_eq!(quantity, Quantity::Element("strut", ElementQuantity::GeneralizedForce("q2")));
/// assert_eq!(quantity.to_string(), "strut.Q.q2");
/// assert_eq!(quantity.symbol(), "Q₂ of strut");
/// assert_eq!(quantity.meaning(), "generalized force of strut on q2");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Quantity<Id = usize> {
    /// t, s.
    Time,
    /// A number of q: rad, m, or a component of a quaternion.
    Coordinate(Id),
    /// A number of v: rad/s or m/s.
    Velocity(Id),
    /// A number of a: rad/s² or m/s².
    Acceleration(Id),
    /// A number of tau, the actuator forces: N·m or N.
    Torque(Id),
    /// Something of an element.
    Element(Id, ElementQuantity<Id>),
    /// World coordinate of the gripper, m.
    Gripper(Axis),
    /// Distance of the gripper from the wanted point, m.
    GripperError,
    /// A term of the energy balance, J.
    Energy(EnergyQuantity),
    /// The derivative of one of these by a parameter ([`crate::system::sensitivity::Sensitivity::columns`]).
    Derivative(Id),
}

/// What must be known for a quantity, each with all before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Needs {
    /// t, q and v.
    Places,
    /// Where the gripper is.
    Gripper,
    /// Coordinates of the elements and their rates.
    Readings,
    /// Forces, energies, accelerations, inputs.
    Forces,
}

/// An axis of the world.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Axis {
    /// x.
    X,
    /// y.
    Y,
    /// z.
    Z,
}

/// A term of the energy balance of the whole system, J.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum EnergyQuantity {
    /// Kinetic energy.
    Kinetic,
    /// Potential energy in the field of gravity, 0 at the world origin.
    Potential,
    /// Work of the actuators since t = 0.
    Actuators,
    /// Energy lost in joint damping and friction since t = 0.
    Joints,
    /// Kinetic + potential + stored + dissipated − input − actuators, less its value at t = 0.
    Residual,
}

impl Axis {
    /// All three.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// 0, 1 or 2: its place in a vector.
    pub(crate) const fn index(self) -> usize {
        self as usize
    }

    /// `x`, `y` or `z`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
        }
    }
}

impl EnergyQuantity {
    /// All terms, in the order of the columns.
    pub const ALL: [Self; 5] = [Self::Kinetic, Self::Potential, Self::Actuators, Self::Joints, Self::Residual];

    /// What follows `energy.` in the column.
    pub const fn key(self) -> &'static str {
        match self {
            Self::Kinetic => "kinetic",
            Self::Potential => "potential",
            Self::Actuators => "actuators",
            Self::Joints => "joints",
            Self::Residual => "residual",
        }
    }

    const fn meaning(self) -> &'static str {
        match self {
            Self::Kinetic => "kinetic energy",
            Self::Potential => "potential energy in the field of gravity, 0 at the world origin",
            Self::Actuators => "work of the actuators since t = 0",
            Self::Joints => "energy lost in joint damping and friction, and taken up by end stops, since t = 0",
            Self::Residual => "kinetic + potential + stored + dissipated - input - actuators, less its value at t = 0",
        }
    }
}

impl<Id> Quantity<Id> {
    /// Whether it is a work since t = 0: dissipated, supplied, done by actuators or lost in joints.
    pub const fn is_work(&self) -> bool {
        matches!(
            self,
            Self::Element(_, ElementQuantity::Dissipated | ElementQuantity::Input)
                | Self::Energy(EnergyQuantity::Actuators | EnergyQuantity::Joints)
        )
    }
}

impl Quantity {
    /// What must be known for its value.
    pub(crate) const fn needs(self) -> Needs {
        match self {
            Self::Time | Self::Coordinate(_) | Self::Velocity(_) => Needs::Places,
            Self::Gripper(_) => Needs::Gripper,
            Self::Element(_, ElementQuantity::Length | ElementQuantity::Stroke | ElementQuantity::Rate) => {
                Needs::Readings
            }
            Self::Element(..)
            | Self::Acceleration(_)
            | Self::Torque(_)
            | Self::GripperError
            | Self::Energy(_)
            | Self::Derivative(_) => Needs::Forces,
        }
    }
}

impl<'a> Quantity<&'a str> {
    /// The quantity that a column of this name holds, of whatever system; `None` where no column can be called so.
    ///
    /// Names of elements hold no dot, but one before the component of a bushing; those of joints may, and the parts of a floating
    /// joint follow one. What is no quantity of every element is taken for an input.
    pub fn read(name: &'a str) -> Option<Self> {
        if Self::of_derivative(name).is_some() {
            return Some(Self::Derivative(name));
        }
        let Some((first, rest)) = name.split_once('.') else { return (name == "t").then_some(Self::Time) };
        match first {
            "q" => return Some(Self::Coordinate(rest)),
            "v" => return Some(Self::Velocity(rest)),
            "a" => return Some(Self::Acceleration(rest)),
            "tau" => return Some(Self::Torque(rest)),
            "gripper" if rest == "error" => return Some(Self::GripperError),
            _ => {}
        }
        let axis = || Axis::ALL.into_iter().find(|axis| first == "gripper" && axis.name() == rest);
        let energy = || EnergyQuantity::ALL.into_iter().find(|energy| first == "energy" && energy.key() == rest);
        let component = rest.split_once('.').filter(|(part, _)| Component::ALL.iter().any(|c| c.name() == *part));
        let (element, key) = component.map_or((first, rest), |(part, key)| (&name[..=first.len() + part.len()], key));
        let of_element = || ElementQuantity::read(key).map(|quantity| Self::Element(element, quantity));
        axis().map(Self::Gripper).or_else(|| energy().map(Self::Energy)).or_else(of_element)
    }

    /// The column and the parameter that `d(COLUMN)/d(PARAMETER)` names.
    pub fn of_derivative(name: &'a str) -> Option<(&'a str, &'a str)> {
        name.strip_prefix("d(")?.strip_suffix(')')?.split_once(")/d(")
    }

    /// What it holds, in a few words; an input says its name, which [`super::Observables`] replace by the words of its law.
    pub fn meaning(&self) -> String {
        match self {
            Self::Time => "time".into(),
            Self::Coordinate(label) => format!("coordinate of {label}"),
            Self::Velocity(label) => format!("velocity of {label}"),
            Self::Acceleration(label) => format!("acceleration of {label}"),
            Self::Torque(label) => format!("actuator force of {label}"),
            Self::Element(name, quantity) => quantity.meaning(name),
            Self::Gripper(axis) => format!("world {} of the gripper", axis.name()),
            Self::GripperError => "distance of the gripper from the wanted point".into(),
            Self::Energy(energy) => energy.meaning().into(),
            Self::Derivative(name) => {
                let (of, by) = Quantity::of_derivative(name).unwrap_or((name, ""));
                format!("derivative of {of} by {by}")
            }
        }
    }
}

/// The name of its column.
impl fmt::Display for Quantity<&str> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Time => f.write_str("t"),
            Self::Coordinate(label) => write!(f, "q.{label}"),
            Self::Velocity(label) => write!(f, "v.{label}"),
            Self::Acceleration(label) => write!(f, "a.{label}"),
            Self::Torque(label) => write!(f, "tau.{label}"),
            Self::Element(name, quantity) => write!(f, "{name}.{quantity}"),
            Self::Gripper(axis) => write!(f, "gripper.{}", axis.name()),
            Self::GripperError => f.write_str("gripper.error"),
            Self::Energy(energy) => write!(f, "energy.{}", energy.key()),
            Self::Derivative(name) => f.write_str(name),
        }
    }
}
