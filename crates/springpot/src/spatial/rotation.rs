//! Rotation matrices.

use std::ops::Mul;

use super::quaternion::Quaternion;
use super::scalar::Scalar;
use super::vector::Vec3;

/// A rotation matrix R, row-major: it takes components in the child frame to components in the parent frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rotation<T = f64>(pub [[T; 3]; 3]);

impl<T: Scalar> Rotation<T> {
    /// No rotation.
    pub const IDENTITY: Self =
        Self([[T::ONE, T::ZERO, T::ZERO], [T::ZERO, T::ONE, T::ZERO], [T::ZERO, T::ZERO, T::ONE]]);

    /// A constant rotation (the same in every state).
    #[inline(always)]
    pub fn from_f64(r: &Rotation<f64>) -> Self {
        let [r0, r1, r2] = r.rows();
        Self([Vec3::from_f64(r0).0, Vec3::from_f64(r1).0, Vec3::from_f64(r2).0])
    }

    /// Rodrigues' formula R = I + sin q \[e\]× + (1 − cos q) \[e\]×² for a unit vector `axis` and an angle in rad.
    #[inline(always)]
    pub fn from_axis_angle(axis: Vec3<T>, angle: T) -> Self {
        let (s, c) = angle.sin_cos();
        let [x, y, z] = axis.0;
        let k = T::ONE - c;
        // [e]×² = e eᵀ − I for a unit vector, so that the diagonal is e_i² (1 − c) + c.
        Self([
            [k * x * x + c, k * x * y - s * z, k * x * z + s * y],
            [k * x * y + s * z, k * y * y + c, k * y * z - s * x],
            [k * x * z - s * y, k * y * z + s * x, k * z * z + c],
        ])
    }

    /// R = 1 + 2 w \[u\]× + 2 \[u\]×² for the quaternion (u, w) = `components`/|`components`|, in the order x, y, z, w: any length but
    /// 0 gives a rotation, length 0 gives NaN.
    #[inline(always)]
    pub fn from_quaternion_components([x, y, z, w]: [T; 4]) -> Self {
        let square = w.times_plus(w, z.times_plus(z, y.times_plus(y, x * x)));
        let scale = T::from_f64(2.0) / square;
        let (sx, sy, sz) = (x * scale, y * scale, z * scale);
        let (xx, yy, zz) = (x * sx, y * sy, z * sz);
        let (xy, xz, yz) = (x * sy, x * sz, y * sz);
        let (wx, wy, wz) = (w * sx, w * sy, w * sz);
        Self([
            [T::ONE - (yy + zz), xy - wz, xz + wy],
            [xy + wz, T::ONE - (xx + zz), yz - wx],
            [xz - wy, yz + wx, T::ONE - (xx + yy)],
        ])
    }

    /// R · Rz(angle) from the sine and cosine of the angle; the third column stays.
    #[inline(always)]
    pub fn turned_about_z(&self, sin: T, cos: T) -> Self {
        let [r0, r1, r2] = self.0;
        Self([row_about_z(r0, sin, cos), row_about_z(r1, sin, cos), row_about_z(r2, sin, cos)])
    }

    /// The rows, as vectors.
    #[inline(always)]
    pub fn rows(&self) -> [Vec3<T>; 3] {
        let [r0, r1, r2] = self.0;
        [Vec3(r0), Vec3(r1), Vec3(r2)]
    }

    /// The third column: the z axis of the child frame in the parent frame.
    #[inline(always)]
    pub fn z_axis(&self) -> Vec3<T> {
        Vec3([self.0[0][2], self.0[1][2], self.0[2][2]])
    }

    /// Column `k`: axis `k` of the child frame in the parent frame.
    #[inline(always)]
    pub fn column(&self, k: usize) -> Vec3<T> {
        Vec3([self.0[0][k], self.0[1][k], self.0[2][k]])
    }

    /// Rᵀ, the inverse.
    #[inline(always)]
    pub fn transpose(&self) -> Self {
        let m = &self.0;
        Self([[m[0][0], m[1][0], m[2][0]], [m[0][1], m[1][1], m[2][1]], [m[0][2], m[1][2], m[2][2]]])
    }

    /// Rᵀ v: from parent components to child components.
    #[inline(always)]
    pub fn unrotate(&self, v: Vec3<T>) -> Vec3<T> {
        let ([x, y, z], m) = (v.0, &self.0);
        Vec3([
            m[2][0].times_plus(z, m[1][0].times_plus(y, m[0][0] * x)),
            m[2][1].times_plus(z, m[1][1].times_plus(y, m[0][1] * x)),
            m[2][2].times_plus(z, m[1][2].times_plus(y, m[0][2] * x)),
        ])
    }
}

// Functions, since closures are not always inlined.

/// A row of R times Rz.
#[inline(always)]
fn row_about_z<T: Scalar>([a, b, c]: [T; 3], sin: T, cos: T) -> [T; 3] {
    [a.times_plus(cos, b * sin), b.times_plus(cos, -(a * sin)), c]
}

/// A row times a matrix.
#[inline(always)]
fn row_times<T: Scalar>([a, b, c]: [T; 3], other: &Rotation<T>) -> [T; 3] {
    let [x, y, z] = other.0;
    [
        c.times_plus(z[0], b.times_plus(y[0], a * x[0])),
        c.times_plus(z[1], b.times_plus(y[1], a * x[1])),
        c.times_plus(z[2], b.times_plus(y[2], a * x[2])),
    ]
}

impl Rotation<f64> {
    /// The attitude of a quaternion (of any length but 0).
    pub fn from_quaternion(quaternion: Quaternion) -> Self {
        Self::from_quaternion_components(quaternion.0)
    }

    /// R = Rz(yaw) Ry(pitch) Rx(roll), angles in rad.
    pub fn from_rpy([roll, pitch, yaw]: [f64; 3]) -> Self {
        let ((sr, cr), (sp, cp), (sy, cy)) = (roll.sin_cos(), pitch.sin_cos(), yaw.sin_cos());
        Self([
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ])
    }

    /// A rotation whose third column is the unit vector `axis`; it is exact for the six coordinate directions.
    ///
    /// Source: Duff et al., Building an orthonormal basis, revisited, JCGT 6(1), 2017.
    pub fn with_z_axis(axis: Vec3<f64>) -> Self {
        let [x, y, z] = axis.0;
        let sign = 1f64.copysign(z);
        let a = -1.0 / (sign + z);
        let b = x * y * a;
        Self([[1.0 + sign * x * x * a, b, x], [sign * b, sign + y * y * a, y], [-sign * x, -y, z]])
    }

    /// The shortest turn that leads z to `axis`, of length 1; half a turn about x where that is −z.
    pub fn shortest_from_z(axis: Vec3<f64>) -> Self {
        let [x, y, z] = axis.0;
        let square = x * x + y * y;
        if square == 0.0 {
            let sign = 1f64.copysign(z);
            return Self([[1.0, 0.0, 0.0], [0.0, sign, 0.0], [0.0, 0.0, sign]]);
        }
        // 1/(1 + z), without a difference of numbers that are nearly the same.
        let a = if z >= 0.0 { 1.0 / (1.0 + z) } else { (1.0 - z) / square };
        Self([[1.0 - x * x * a, -x * y * a, x], [-x * y * a, 1.0 - y * y * a, y], [-x, -y, z]])
    }
}

impl<T: Scalar> Default for Rotation<T> {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl<T: Scalar> Mul<Vec3<T>> for Rotation<T> {
    type Output = Vec3<T>;
    #[inline(always)]
    fn mul(self, v: Vec3<T>) -> Vec3<T> {
        let [r0, r1, r2] = self.rows();
        Vec3([r0.dot(v), r1.dot(v), r2.dot(v)])
    }
}

impl<T: Scalar> Mul for Rotation<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let [r0, r1, r2] = self.0;
        Self([row_times(r0, &other), row_times(r1, &other), row_times(r2, &other)])
    }
}
