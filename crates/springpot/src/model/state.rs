//! Whether numbers are a state of a robot: the algorithms take them as they are.

use super::robot::Model;

/// Why numbers are no state of the robot.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StateError {
    /// There are too few or too many numbers.
    #[error("{symbol} has {given} numbers; this robot's {symbol} has {expected}")]
    Length {
        /// `q`, `v`, …
        symbol: &'static str,
        /// How many there are.
        given: usize,
        /// How many there must be.
        expected: usize,
    },

    /// A number is NaN or infinite.
    #[error("{symbol}.{label} is {value}; it must be finite")]
    NotFinite {
        /// `q`, `v`, …
        symbol: &'static str,
        /// Which one, as in [`Model::q_labels`].
        label: String,
        /// The value.
        value: f64,
    },

    /// The attitude of a spherical or floating joint has no direction.
    #[error("the quaternion of joint \"{joint}\" has the length {length}; it must have one, such as [0, 0, 0, 1]")]
    ZeroQuaternion {
        /// The joint.
        joint: String,
        /// 0, or so little that its square is 0.
        length: f64,
    },
}

impl Model {
    /// Whether `q` is a configuration: nq finite numbers and quaternions of any length but 0, which the algorithms normalise.
    ///
    /// # Errors
    /// [`StateError`].
    pub fn check_q(&self, q: &[f64]) -> Result<(), StateError> {
        check("q", q, self.nq(), |k| self.q_labels().swap_remove(k).name)?;
        for (j, space) in self.own_joints_and_spaces() {
            let Some(first) = space.quaternion() else { continue };
            let square: f64 = q[self.q_range(j)][first..].iter().map(|x| x * x).sum();
            if !square.is_normal() {
                return Err(StateError::ZeroQuaternion { joint: self.joint_names()[j].clone(), length: square.sqrt() });
            }
        }
        Ok(())
    }

    /// Whether `v` is a vector of nv finite numbers: velocities, accelerations or forces, called `symbol` in the message.
    ///
    /// # Errors
    /// [`StateError`].
    pub fn check_v(&self, symbol: &'static str, v: &[f64]) -> Result<(), StateError> {
        check(symbol, v, self.nv(), |k| self.v_labels().swap_remove(k).name)
    }
}

fn check(
    symbol: &'static str,
    values: &[f64],
    expected: usize,
    label: impl Fn(usize) -> String,
) -> Result<(), StateError> {
    if values.len() != expected {
        return Err(StateError::Length { symbol, given: values.len(), expected });
    }
    match values.iter().position(|x| !x.is_finite()) {
        Some(k) => Err(StateError::NotFinite { symbol, label: label(k), value: values[k] }),
        None => Ok(()),
    }
}
