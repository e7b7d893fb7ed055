//! What can be observed of an element: names, units, words and values.

use super::evaluation::{ElementEvaluation, ElementRow};
use super::subscript::at_joint;
use super::units::ObservedElement;
use crate::elements::MeasureKind;
use crate::law::{LeafState, Told};
use crate::model::Label;
use std::fmt;

/// A number of an element. `Id` as in [`super::Quantity`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ElementQuantity<Id = usize> {
    /// y: the length l of a line, m, or the coordinate of a joint, m or rad. On an angle m reads rad and N reads N·m in what
    /// follows.
    Length,
    /// x = y − y0, m.
    Stroke,
    /// x', m/s.
    Rate,
    /// D^alpha x, m/s^alpha.
    Derivative,
    /// F, N, positive in tension.
    Force,
    /// Q_b = −F·∂y/∂q_b of a velocity b: N·m or N.
    GeneralizedForce(Id),
    /// Energy stored, J; unknown where the derivative comes from a named scheme.
    Stored,
    /// Energy dissipated since t = 0, J; unknown where `Stored` is.
    Dissipated,
    /// Energy supplied by the inputs since t = 0, J.
    Input,
    /// What its law tells of itself beside that ([`Told`]), in its order: of a circuit voltage, charge and current, of what warms itself its temperature and
    /// the heat that it lost.
    Told(Id),
    /// Value of an input, in the order of its law.
    InputValue(Id),
    /// Something of a leaf of its law.
    Leaf(Id, LeafQuantity),
}

/// A number of a leaf.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum LeafQuantity {
    /// Its own stroke, m.
    Stroke,
    /// Its rate, m/s.
    Rate,
    /// Its force, N.
    Force,
    /// D^alpha of its stroke, m/s^alpha; the rate of a dashpot, else the stroke.
    Derivative,
}

impl LeafQuantity {
    /// All of them, in the order of the columns.
    pub const ALL: [Self; 4] = [Self::Stroke, Self::Rate, Self::Force, Self::Derivative];

    /// What follows the leaf's name in the column.
    pub const fn key(self) -> &'static str {
        match self {
            Self::Stroke => "stroke",
            Self::Rate => "rate",
            Self::Force => "force",
            Self::Derivative => "derivative",
        }
    }

    /// What it is, in a few words.
    const fn words(self) -> &'static str {
        match self {
            Self::Stroke => "stroke",
            Self::Rate => "rate of the stroke",
            Self::Force => "force",
            Self::Derivative => "derivative of the stroke",
        }
    }

    fn value(self, leaf: &LeafState) -> f64 {
        match self {
            Self::Stroke => leaf.stroke,
            Self::Rate => leaf.rate,
            Self::Force => leaf.force,
            Self::Derivative => leaf.derivative,
        }
    }
}

impl<Id> ElementQuantity<Id> {
    /// Those that come before the generalized forces in a row.
    pub(super) const BEFORE_FORCES: [Self; 5] = [Self::Length, Self::Stroke, Self::Rate, Self::Derivative, Self::Force];
    /// Those that come between the generalized forces and the inputs.
    pub(super) const BEFORE_INPUTS: [Self; 3] = [Self::Stored, Self::Dissipated, Self::Input];
}

impl ElementQuantity {
    /// Its value in a row, NaN where unknown.
    pub(super) fn value(self, row: &ElementRow, state: &ElementEvaluation) -> f64 {
        let ElementRow { observation, told, leaves, dissipated, input } = row;
        match self {
            Self::Length => state.reading.coordinate,
            Self::Stroke => state.stroke,
            Self::Rate => state.reading.rate,
            Self::Derivative => observation.derivative,
            Self::Force => observation.force(),
            Self::GeneralizedForce(k) => row.generalized_force(state, k),
            Self::Stored => observation.stored.unwrap_or(f64::NAN),
            Self::Dissipated => observation.stored.map_or(f64::NAN, |_| *dissipated),
            Self::Input => *input,
            Self::Told(i) => told.get(i).copied().unwrap_or(f64::NAN),
            Self::InputValue(i) => state.inputs.get(i).map_or(f64::NAN, |input| input.value),
            Self::Leaf(i, quantity) => leaves.get(i).map_or(f64::NAN, |leaf| quantity.value(leaf)),
        }
    }

    /// Its unit.
    pub(super) fn unit<'a>(self, element: &'a ObservedElement, velocities: &[Label]) -> &'a str {
        let of_element = |[rotation, translation]: [&'static str; 2]| match element.is_rotation {
            true => rotation,
            false => translation,
        };
        match self {
            Self::Length | Self::Stroke | Self::Leaf(_, LeafQuantity::Stroke) => of_element(["rad", "m"]),
            Self::Rate | Self::Leaf(_, LeafQuantity::Rate) => of_element(["rad/s", "m/s"]),
            Self::Leaf(i, LeafQuantity::Derivative) => element.leaves[i].1,
            Self::Derivative => element.derivative_unit,
            Self::Force | Self::Leaf(_, LeafQuantity::Force) => of_element(["N*m", "N"]),
            Self::GeneralizedForce(k) => velocities[k].dimension.units().force,
            Self::Stored | Self::Dissipated | Self::Input => "J",
            Self::Told(i) => element.tells[i].unit,
            Self::InputValue(i) => &element.entry.inputs[i].unit,
        }
    }

    /// The same with names in place of indices.
    pub(super) fn named<'a>(self, element: &'a ObservedElement, velocities: &'a [Label]) -> ElementQuantity<&'a str> {
        match self {
            Self::Length => ElementQuantity::Length,
            Self::Stroke => ElementQuantity::Stroke,
            Self::Rate => ElementQuantity::Rate,
            Self::Derivative => ElementQuantity::Derivative,
            Self::Force => ElementQuantity::Force,
            Self::GeneralizedForce(k) => ElementQuantity::GeneralizedForce(&velocities[k].name),
            Self::Stored => ElementQuantity::Stored,
            Self::Dissipated => ElementQuantity::Dissipated,
            Self::Input => ElementQuantity::Input,
            Self::Told(i) => ElementQuantity::Told(element.tells[i].key),
            Self::InputValue(i) => ElementQuantity::InputValue(&element.entry.inputs[i].name),
            Self::Leaf(i, quantity) => ElementQuantity::Leaf(&element.leaves[i].0, quantity),
        }
    }
}

impl<'a> ElementQuantity<&'a str> {
    /// From what follows the element's name in a column.
    pub(super) fn read(key: &'a str) -> Option<Self> {
        match key.split_once('.') {
            Some(("Q", velocity)) => Some(Self::GeneralizedForce(velocity)),
            Some((leaf, key)) => LeafQuantity::ALL
                .into_iter()
                .find(|quantity| quantity.key() == key)
                .map(|quantity| Self::Leaf(leaf, quantity)),
            None => {
                let told = Told::BY_NAME.map(|told| Self::Told(told.key));
                let mut known = Self::BEFORE_FORCES.into_iter().chain(Self::BEFORE_INPUTS).chain(told);
                Some(known.find(|quantity| quantity.to_string() == key).unwrap_or(Self::InputValue(key)))
            }
        }
    }

    /// What it holds, in a few words.
    pub(super) fn meaning(&self, element: &str) -> String {
        match self {
            Self::Length => format!("length of {element}"),
            Self::Stroke => format!("length of {element} less its rest length"),
            Self::Rate => format!("rate of the stroke of {element}"),
            Self::Derivative => format!("fractional derivative of the stroke of {element}"),
            Self::Force => format!("force of {element}, positive in tension"),
            Self::GeneralizedForce(velocity) => format!("generalized force of {element} on {velocity}"),
            Self::Stored => format!("energy stored in {element}"),
            Self::Dissipated => format!("energy dissipated in {element} since t = 0"),
            Self::Input => format!("energy supplied by the inputs of {element} since t = 0"),
            Self::Told(key) => told(key).map_or_else(|| format!("{key} of {element}"), |told| told.meaning_of(element)),
            Self::InputValue(input) => format!("{input} of {element}"),
            Self::Leaf(leaf, quantity) => format!("{} of {leaf} in {element}", quantity.words()),
        }
    }

    /// [`Self::meaning`] where the element acts on another coordinate than a length.
    pub(super) fn meaning_on(&self, kind: MeasureKind, element: &str) -> String {
        let coordinate = match kind {
            MeasureKind::Length => return self.meaning(element),
            MeasureKind::Joint => "coordinate of the joint",
            MeasureKind::Shift => "relative shift",
            MeasureKind::Turn => "component of the relative rotation vector",
        };
        match self {
            Self::Length => format!("{coordinate} of {element}"),
            Self::Stroke => format!("{coordinate} of {element} less its rest value"),
            Self::Force => format!("force of {element}, positive where it drives the coordinate down"),
            _ => self.meaning(element),
        }
    }

    /// What figures call it.
    pub(super) fn symbol(&self, element: &str) -> String {
        match self {
            Self::Length => format!("length l of {element}"),
            Self::Stroke => format!("stroke x of {element}"),
            Self::Rate => format!("stroke rate of {element}"),
            Self::Derivative => format!("Dᵅ x of {element}"),
            Self::Force => format!("force F of {element}"),
            Self::GeneralizedForce(velocity) => format!("Q{} of {element}", at_joint(velocity)),
            Self::Stored => format!("energy stored in {element}"),
            Self::Dissipated => format!("energy dissipated in {element}"),
            Self::Input => format!("energy supplied to {element}"),
            Self::Told(key) => told(key).map_or_else(|| format!("{key} of {element}"), |told| told.symbol_of(element)),
            Self::InputValue(input) => format!("{input} of {element}"),
            Self::Leaf(leaf, LeafQuantity::Stroke) => format!("stroke x of {leaf} in {element}"),
            Self::Leaf(leaf, LeafQuantity::Rate) => format!("stroke rate of {leaf} in {element}"),
            Self::Leaf(leaf, LeafQuantity::Force) => format!("force F of {leaf} in {element}"),
            Self::Leaf(leaf, LeafQuantity::Derivative) => format!("Dᵅ x of {leaf} in {element}"),
        }
    }
}

/// What follows the element's name in the column.
impl fmt::Display for ElementQuantity<&str> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Length => "length",
            Self::Stroke => "stroke",
            Self::Rate => "rate",
            Self::Derivative => "derivative",
            Self::Force => "force",
            Self::GeneralizedForce(velocity) => return write!(f, "Q.{velocity}"),
            Self::Stored => "stored",
            Self::Dissipated => "dissipated",
            Self::Input => "input",
            Self::Told(key) | Self::InputValue(key) => key,
            Self::Leaf(leaf, quantity) => return write!(f, "{leaf}.{}", quantity.key()),
        })
    }
}

/// What laws tell under this key, of those that a name tells.
fn told(key: &str) -> Option<Told> {
    Told::BY_NAME.into_iter().find(|told| told.key == key)
}
