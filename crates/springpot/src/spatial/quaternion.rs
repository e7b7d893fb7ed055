//! Quaternions of attitudes.

use std::ops::Mul;

use super::vector::Vec3;

/// A quaternion x, y, z, w (vector part first). Unit quaternions q and −q stand for the same attitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quaternion(pub [f64; 4]);

impl Quaternion {
    /// No turn.
    pub const IDENTITY: Self = Self([0.0, 0.0, 0.0, 1.0]);

    /// From x, y, z, w.
    pub fn new(components: [f64; 4]) -> Self {
        Self(components)
    }

    /// The attitude after turning by |`vector`| rad about `vector`: (sin(θ/2)/θ v, cos(θ/2)).
    pub fn from_rotation_vector(vector: Vec3) -> Self {
        let square = vector.dot(vector);
        let (factor, cosine) = if square < 1e-8 {
            (0.5 - square / 48.0, 1.0 - square / 8.0)
        } else {
            let theta = square.sqrt();
            let (sine, cosine) = (0.5 * theta).sin_cos();
            (sine / theta, cosine)
        };
        let [x, y, z] = (vector * factor).0;
        Self([x, y, z, cosine])
    }

    /// The attitude Rz(yaw) Ry(pitch) Rx(roll), angles in rad; without a jump of sign where the angles have none.
    pub fn from_rpy([roll, pitch, yaw]: [f64; 3]) -> Self {
        let about = |axis: [f64; 3], angle: f64| Self::from_rotation_vector(Vec3(axis) * angle);
        about([0.0, 0.0, 1.0], yaw) * about([0.0, 1.0, 0.0], pitch) * about([1.0, 0.0, 0.0], roll)
    }

    /// The turn of at most π that leads to this attitude (of length 1), as axis times angle, rad.
    pub fn rotation_vector(self) -> Vec3 {
        let [x, y, z, w] = if self.0[3] < 0.0 { self.0.map(|c| -c) } else { self.0 };
        let vector = Vec3([x, y, z]);
        let sine = vector.norm();
        let factor =
            if sine < 1e-4 { 2.0 / w - 2.0 * sine * sine / (3.0 * w * w * w) } else { 2.0 * sine.atan2(w) / sine };
        vector * factor
    }

    /// The inverse of a unit quaternion.
    pub fn conjugate(self) -> Self {
        let [x, y, z, w] = self.0;
        Self([-x, -y, -z, w])
    }

    /// The unit quaternion of this direction; NaN for length 0.
    pub fn normalised(self) -> Self {
        let norm = self.0.iter().map(|c| c * c).sum::<f64>().sqrt();
        Self(self.0.map(|c| c / norm))
    }
}

/// The turn `other` in the axes that the first turn has led to.
impl Mul for Quaternion {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let ([a, b, c, d], [x, y, z, w]) = (self.0, other.0);
        Self([
            d * x + a * w + b * z - c * y,
            d * y - a * z + b * w + c * x,
            d * z + a * y - b * x + c * w,
            d * w - a * x - b * y - c * z,
        ])
    }
}
