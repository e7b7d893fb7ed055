//! Symmetric 3 × 3 matrices.

use std::ops::{Add, AddAssign, Mul};

use super::rotation::Rotation;
use super::scalar::Scalar;
use super::vector::Vec3;

/// A symmetric 3 × 3 matrix; the off-diagonals are tensor components (xy stands in row x, column y).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Symmetric3<T = f64> {
    /// Diagonal entry of row x.
    pub xx: T,
    /// Diagonal entry of row y.
    pub yy: T,
    /// Diagonal entry of row z.
    pub zz: T,
    /// Entry of row x, column y.
    pub xy: T,
    /// Entry of row x, column z.
    pub xz: T,
    /// Entry of row y, column z.
    pub yz: T,
}

impl<T: Scalar> Symmetric3<T> {
    /// The zero matrix.
    pub const ZERO: Self = Self { xx: T::ZERO, yy: T::ZERO, zz: T::ZERO, xy: T::ZERO, xz: T::ZERO, yz: T::ZERO };

    /// A constant matrix (the same in every state).
    #[inline(always)]
    pub fn from_f64(s: &Symmetric3<f64>) -> Self {
        Self {
            xx: T::from_f64(s.xx),
            yy: T::from_f64(s.yy),
            zz: T::from_f64(s.zz),
            xy: T::from_f64(s.xy),
            xz: T::from_f64(s.xz),
            yz: T::from_f64(s.yz),
        }
    }

    /// The upper triangle of `m`, row-major.
    #[inline(always)]
    pub fn from_upper(m: [[T; 3]; 3]) -> Self {
        Self { xx: m[0][0], yy: m[1][1], zz: m[2][2], xy: m[0][1], xz: m[0][2], yz: m[1][2] }
    }

    /// All nine entries, row-major.
    #[inline(always)]
    pub fn to_matrix(self) -> [[T; 3]; 3] {
        [[self.xx, self.xy, self.xz], [self.xy, self.yy, self.yz], [self.xz, self.yz, self.zz]]
    }

    /// Sum of the diagonal.
    #[inline(always)]
    pub fn trace(self) -> T {
        self.xx + self.yy + self.zz
    }

    /// R S Rᵀ: the same tensor in the axes into which `r` leads.
    #[inline(always)]
    pub fn rotated(self, r: &Rotation<T>) -> Self {
        let [r0, r1, r2] = r.rows();
        let (s0, s1, s2) = (self * r0, self * r1, self * r2);
        Self { xx: r0.dot(s0), yy: r1.dot(s1), zz: r2.dot(s2), xy: r0.dot(s1), xz: r0.dot(s2), yz: r1.dot(s2) }
    }

    /// ½ tr(S) I − S: from the inertia tensor ∫ (r² I − r rᵀ) dm to the second moments of mass ∫ r rᵀ dm.
    #[inline(always)]
    pub fn second_moments(self) -> Self {
        let half = self.trace() * T::from_f64(0.5);
        Self { xx: half - self.xx, yy: half - self.yy, zz: half - self.zz, xy: -self.xy, xz: -self.xz, yz: -self.yz }
    }
}

impl<T: Scalar> Mul<Vec3<T>> for Symmetric3<T> {
    type Output = Vec3<T>;
    #[inline(always)]
    fn mul(self, v: Vec3<T>) -> Vec3<T> {
        let [x, y, z] = v.0;
        Vec3([
            self.xz.times_plus(z, self.xy.times_plus(y, self.xx * x)),
            self.yz.times_plus(z, self.yy.times_plus(y, self.xy * x)),
            self.zz.times_plus(z, self.yz.times_plus(y, self.xz * x)),
        ])
    }
}

impl<T: Scalar> Add for Symmetric3<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self {
            xx: self.xx + o.xx,
            yy: self.yy + o.yy,
            zz: self.zz + o.zz,
            xy: self.xy + o.xy,
            xz: self.xz + o.xz,
            yz: self.yz + o.yz,
        }
    }
}

impl<T: Scalar> AddAssign for Symmetric3<T> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
