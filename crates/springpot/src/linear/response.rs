//! How columns answer to sines.

use super::assembly::{Assembly, Parts, Row};
use super::linearisation::{LinearElement, Linearisation};
use crate::observe::{Axis, ElementQuantity, LeafQuantity, Quantity};
use num_complex::Complex64;

/// What is moved by a sine of amplitude 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Excitation {
    /// The actuator force on a velocity that forces move.
    Torque(usize),
    /// The coordinate of a velocity that signals move.
    Motion(usize),
    /// An input of an element, beside what feedback says of it.
    Input(usize, usize),
    /// Where a controller wants the joint of a velocity ([`super::LinearControl::aims`]).
    Reference(usize),
}

/// Why a column does not answer linearly.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NoResponse {
    /// It is a quadratic function of small motions.
    #[error("energies are not linear in small motions")]
    Energy,
    /// A law tells it beside stroke, rate and force, as a voltage.
    #[error("the responses of an element are those of its stroke, its force and its leaves")]
    Told,
    /// It is a distance, or the time.
    #[error("it is not linear in small motions")]
    NotLinear,
    /// The system has no such column.
    #[error("the system has no such column")]
    None,
}

impl Linearisation {
    /// The complex amplitude of a quantity at the angular frequency `omega`, rad/s, under an excitation of amplitude 1: of
    /// Re(A e^{iωt}) under cos ωt.
    ///
    /// X_f = −T_ff⁻¹ (T_fp X_p + Σ g ∂F/∂u − δτ) with T(iω) = M s² + D s + K + Σ K_e* g gᵀ − ∂τ/∂q − s ∂τ/∂v + …, of the closed loop where
    /// something follows from the state. A torque acts beside that of a controller; `tau` is what both say.
    ///
    /// # Errors
    /// [`NoResponse`] where the quantity is not linear in what moves.
    pub fn frequency_response(
        &self,
        excitation: Excitation,
        of: Quantity,
        omega: f64,
    ) -> Result<Complex64, NoResponse> {
        let assembly = Assembly::new(self, &[excitation], Parts::All, None);
        let row = assembly.observe(of)?;
        let s = Complex64::new(0.0, omega);
        let powers = assembly.powers(s);
        let columns = &assembly.solve(s, &powers)[0];
        Ok(row.times(s, &assembly.springpots, &powers, columns))
    }

    /// Whether a quantity is linear in what moves.
    ///
    /// # Errors
    /// [`NoResponse`].
    pub fn is_linear(&self, of: Quantity) -> Result<(), NoResponse> {
        Assembly::new(self, &[], Parts::All, None).observe(of).map(|_| ())
    }

    /// All that can be excited: torques on what forces move, coordinates of joints that signals move, inputs of elements, and references.
    pub fn excitations(&self) -> Vec<Excitation> {
        let torques = self.free.iter().map(|&k| Excitation::Torque(k));
        let moved = self.moved.iter().map(|&k| Excitation::Motion(k));
        let of = |(e, element): (usize, &LinearElement)| (0..element.inputs).map(move |i| Excitation::Input(e, i));
        let inputs = self.elements.iter().enumerate().flat_map(of);
        let aims = self.control.aims.iter().map(|aim| Excitation::Reference(aim.velocity));
        torques.chain(moved).chain(inputs).chain(aims).collect()
    }
}

impl Assembly<'_> {
    /// A quantity as a row.
    ///
    /// # Errors
    /// [`NoResponse`].
    pub(super) fn observe(&self, of: Quantity) -> Result<Row, NoResponse> {
        check(of)?;
        self.observed(of).ok_or(NoResponse::None)
    }

    fn observed(&self, of: Quantity) -> Option<Row> {
        let linear = self.linear;
        let n = linear.left_over.len();
        let line = |matrix: &[f64], k: usize| matrix.chunks(n.max(1)).nth(k).map(|line| self.of_velocities(line, 0));
        let unit = |k: usize, power: usize| {
            let weights: Vec<f64> = (0..n).map(|own| f64::from(u8::from(own == k))).collect();
            (k < n).then(|| self.of_velocities(&weights, power))
        };
        match of {
            Quantity::Coordinate(i) => line(&linear.coordinates, i),
            Quantity::Velocity(k) => unit(k, 1),
            Quantity::Acceleration(k) => unit(k, 2),
            Quantity::Torque(k) => self.needed.get(k).cloned(),
            Quantity::Gripper(axis) => {
                let place = Axis::ALL.iter().position(|other| *other == axis)?;
                line(linear.gripper.as_ref()?, place)
            }
            Quantity::Element(e, quantity) => {
                let element = linear.elements.get(e)?;
                let force = &self.forces[e];
                let stroke = |power: usize| self.of_velocities(&element.gradient, power);
                Some(match quantity {
                    ElementQuantity::Length | ElementQuantity::Stroke => stroke(0),
                    ElementQuantity::Rate => stroke(1),
                    ElementQuantity::Force => force.clone(),
                    ElementQuantity::Derivative => {
                        let fractional = |order: f64| order > 0.0 && order < 1.0;
                        let leaves = &self.leaves[e];
                        let first = leaves.iter().find(|leaf| fractional(leaf.order));
                        let first = first.or_else(|| leaves.iter().find(|leaf| leaf.order == 1.0));
                        first.map_or_else(|| stroke(0), |leaf| leaf.derivative.clone())
                    }
                    ElementQuantity::GeneralizedForce(k) => {
                        let bend = line(&element.hessian, k)?;
                        self.sum([(-element.gradient.get(k)?, force), (-element.force, &bend)])
                    }
                    ElementQuantity::InputValue(i) => self.of_columns(self.input(e, i)),
                    ElementQuantity::Leaf(i, quantity) => {
                        let leaf = self.leaves[e].get(i)?;
                        match quantity {
                            LeafQuantity::Stroke => leaf.stroke.clone(),
                            LeafQuantity::Rate => leaf.stroke.rate()?,
                            LeafQuantity::Force => leaf.force.clone(),
                            LeafQuantity::Derivative => leaf.derivative.clone(),
                        }
                    }
                    ElementQuantity::Told(_)
                    | ElementQuantity::Stored
                    | ElementQuantity::Dissipated
                    | ElementQuantity::Input => return None,
                })
            }
            Quantity::Time | Quantity::GripperError | Quantity::Energy(_) | Quantity::Derivative(_) => None,
        }
    }
}

/// # Errors
/// [`NoResponse`] where the quantity is not linear in what moves.
fn check(of: Quantity) -> Result<(), NoResponse> {
    match of {
        Quantity::Energy(_)
        | Quantity::Element(_, ElementQuantity::Stored | ElementQuantity::Dissipated | ElementQuantity::Input) => {
            Err(NoResponse::Energy)
        }
        Quantity::Element(_, ElementQuantity::Told(_)) => Err(NoResponse::Told),
        Quantity::Time | Quantity::GripperError | Quantity::Derivative(_) => Err(NoResponse::NotLinear),
        _ => Ok(()),
    }
}
