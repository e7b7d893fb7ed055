//! How columns answer to sines.

use super::linearisation::{LinearElement, Linearisation};
use crate::linalg::ComplexLu;
use crate::observe::{Axis, ElementQuantity, LeafQuantity, Quantity};
use num_complex::Complex64;

/// What is moved by a sine of amplitude 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Excitation {
    /// The actuator force on a velocity that forces move.
    Torque(usize),
    /// The coordinate of a velocity that signals move.
    Motion(usize),
    /// An input of an element.
    Input(usize, usize),
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
    /// X_f = −T_ff⁻¹ (T_fp X_p + Σ g ∂F/∂u − δτ) with T(iω) = M s² + D s + K + Σ K_e* g gᵀ.
    ///
    /// # Errors
    /// [`NoResponse`] where the quantity is not linear in what moves.
    pub fn frequency_response(
        &self,
        excitation: Excitation,
        of: Quantity,
        omega: f64,
    ) -> Result<Complex64, NoResponse> {
        check(of)?;
        let n = self.model.nv();
        let s = Complex64::new(0.0, omega);
        let input = |e: usize| match excitation {
            Excitation::Input(of, i) if of == e => Some(i),
            _ => None,
        };
        let whole = self.dynamic_stiffness(s);
        // What the excitation alone asks of the actuators.
        let mut asked = vec![Complex64::ZERO; n];
        for (e, element) in self.elements.iter().enumerate() {
            if let Some(i) = input(e) {
                let gain = element.tangent.gain(s, i) + element.stretched_by(i) * element.tangent.modulus(s);
                asked.iter_mut().zip(&element.gradient).for_each(|(asked, g)| *asked += gain * g);
            }
        }
        let mut x = vec![Complex64::ZERO; n];
        if let Excitation::Motion(k) = excitation {
            x[k] = Complex64::ONE;
        }
        let mut right: Vec<Complex64> = self.free.iter().map(|&k| -row(&whole, n, k, &x) - asked[k]).collect();
        if let Excitation::Torque(k) = excitation
            && let Some(place) = self.free.iter().position(|&free| free == k)
        {
            right[place] += 1.0;
        }
        let count = self.free.len();
        let block = (0..count * count).map(|i| whole[self.free[i / count] * n + self.free[i % count]]).collect();
        let solution = ComplexLu::new(count, block).solve(&right);
        self.free.iter().zip(solution).for_each(|(&k, value)| x[k] = value);
        self.observe(of, s, &x, &input, &|k| row(&whole, n, k, &x) + asked[k]).ok_or(NoResponse::None)
    }

    /// T(s), nv × nv.
    fn dynamic_stiffness(&self, s: Complex64) -> Vec<Complex64> {
        let n = self.model.nv();
        let mut whole: Vec<Complex64> =
            (0..n * n).map(|i| s * (s * self.mass[i] + self.damping[i]) + self.stiffness[i]).collect();
        for element in &self.elements {
            let modulus = element.tangent.modulus(s);
            for (r, row) in element.gradient.iter().enumerate() {
                for (c, column) in element.gradient.iter().enumerate() {
                    whole[r * n + c] += modulus * (row * column);
                }
            }
        }
        whole
    }

    /// A quantity where the tangent coordinates have the amplitudes `x`.
    fn observe(
        &self,
        of: Quantity,
        s: Complex64,
        x: &[Complex64],
        input: &dyn Fn(usize) -> Option<usize>,
        torque: &dyn Fn(usize) -> Complex64,
    ) -> Option<Complex64> {
        let n = self.model.nv();
        let along = |vector: &[f64]| vector.iter().zip(x).map(|(g, x)| g * x).sum::<Complex64>();
        match of {
            Quantity::Coordinate(i) => self.coordinates.chunks(n.max(1)).nth(i).map(along),
            Quantity::Velocity(k) => x.get(k).map(|x| s * x),
            Quantity::Acceleration(k) => x.get(k).map(|x| s * s * x),
            Quantity::Torque(k) => (k < n).then(|| torque(k)),
            Quantity::Gripper(axis) => {
                let place = Axis::ALL.iter().position(|other| *other == axis)?;
                self.gripper.as_ref().map(|jacobian| along(&jacobian[place * n..(place + 1) * n]))
            }
            Quantity::Element(e, quantity) => {
                let element = self.elements.get(e)?;
                let stroke = along(&element.gradient);
                let mut leaves = Vec::new();
                let own = stroke + input(e).map_or(0.0, |i| element.stretched_by(i));
                let force = element.tangent.answer(s, own, input(e), &mut |leaf| leaves.push(leaf));
                Some(match quantity {
                    ElementQuantity::Length | ElementQuantity::Stroke => stroke,
                    ElementQuantity::Rate => s * stroke,
                    ElementQuantity::Force => force,
                    ElementQuantity::Derivative => {
                        let fractional = |order: f64| order > 0.0 && order < 1.0;
                        let first = leaves.iter().find(|leaf| fractional(leaf.order));
                        let first = first.or_else(|| leaves.iter().find(|leaf| leaf.order == 1.0));
                        first.map_or(stroke, |leaf| leaf.derivative)
                    }
                    ElementQuantity::GeneralizedForce(k) => {
                        let bend = element.hessian.chunks(n.max(1)).nth(k).map(along)?;
                        -force * element.gradient.get(k)? - element.force * bend
                    }
                    ElementQuantity::InputValue(i) if input(e) == Some(i) => Complex64::ONE,
                    ElementQuantity::InputValue(_) => Complex64::ZERO,
                    ElementQuantity::Leaf(i, quantity) => {
                        let leaf = leaves.get(i)?;
                        match quantity {
                            LeafQuantity::Stroke => leaf.stroke,
                            LeafQuantity::Rate => s * leaf.stroke,
                            LeafQuantity::Force => leaf.force,
                            LeafQuantity::Derivative => leaf.derivative,
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

impl LinearElement {
    /// By how much a unit of an input makes its stroke longer.
    fn stretched_by(&self, input: usize) -> f64 {
        self.stretch.filter(|(own, _)| *own == input).map_or(0.0, |(_, stretch)| stretch)
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

/// A row of a matrix times a vector.
fn row(matrix: &[Complex64], n: usize, k: usize, x: &[Complex64]) -> Complex64 {
    matrix[k * n..(k + 1) * n].iter().zip(x).map(|(m, x)| m * x).sum()
}
