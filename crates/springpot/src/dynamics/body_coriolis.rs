//! The body Coriolis matrix (Singh & Wensing) by two integrals over the mass.

use crate::spatial::{Force, Inertia, Motion, Scalar, Symmetric3, Vec3};

/// The body Coriolis matrix B of moving bodies by two integrals: l = ∫ ṙ dm (linear momentum) and S = ∫ ṙ rᵀ dm.
///
/// They hold all that B = ½((v×*) I − I (v×) + (I v)×̄*) knows, with (f×̄*) w = w ×* f:
/// B (α, β) = (tr(S) α − S α, α × l) in the order (moment, force). Being integrals, they add up over bodies.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct BodyCoriolis<T> {
    pub(super) momentum: Vec3<T>,
    /// Rows of S − tr(S) 1.
    rows: [Vec3<T>; 3],
}

impl<T: Scalar> BodyCoriolis<T> {
    pub(super) const ZERO: Self = Self { momentum: Vec3::ZERO, rows: [Vec3::ZERO; 3] };

    /// Of a body with `inertia` about the reference point that moves with `velocity`, and whose momentum is `momentum`.
    ///
    /// S = u hᵀ + \[ω\]× Π with the second moments Π = ∫ r rᵀ dm.
    #[inline(always)]
    pub(super) fn new(inertia: &Inertia<T>, velocity: Motion<T>, momentum: Force<T>) -> Self {
        let Symmetric3 { xx, yy, zz, xy, xz, yz } = inertia.rotational.second_moments();
        let (omega, h) = (velocity.angular, inertia.first_moment);
        let (u, [hx, hy, hz]) = (velocity.linear, h.0);
        let x = u.times_plus(hx, omega.cross(Vec3([xx, xy, xz]))).0;
        let y = u.times_plus(hy, omega.cross(Vec3([xy, yy, yz]))).0;
        let z = u.times_plus(hz, omega.cross(Vec3([xz, yz, zz]))).0;
        let rows = [
            Vec3([-(y[1] + z[2]), y[0], z[0]]),
            Vec3([x[1], -(x[0] + z[2]), z[1]]),
            Vec3([x[2], y[2], -(x[0] + y[1])]),
        ];
        Self { momentum: momentum.linear, rows }
    }

    /// B (α, β), which β does not change.
    #[inline(always)]
    pub(super) fn times(&self, alpha: Vec3<T>) -> Force<T> {
        let [r0, r1, r2] = self.rows;
        let angular = -Vec3([r0.dot(alpha), r1.dot(alpha), r2.dot(alpha)]);
        Force { angular, linear: alpha.cross(self.momentum) }
    }

    /// The angular part of Bᵀ (η, φ); the linear part is 0.
    #[inline(always)]
    pub(super) fn transposed_times(&self, motion: Motion<T>) -> Vec3<T> {
        let ([x, y, z], [r0, r1, r2]) = (motion.angular.0, self.rows);
        self.momentum.cross(motion.linear) - r2.times_plus(z, r1.times_plus(y, r0 * x))
    }
}

impl<T: Scalar> std::ops::AddAssign for BodyCoriolis<T> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        self.momentum += other.momentum;
        let ([a0, a1, a2], [b0, b1, b2]) = (self.rows, other.rows);
        self.rows = [a0 + b0, a1 + b1, a2 + b2];
    }
}
