//! Placements: where a frame is in its parent.

use std::ops::Mul;

use super::force::Force;
use super::motion::Motion;
use super::rotation::Rotation;
use super::scalar::Scalar;
use super::vector::Vec3;

/// Pose of a child frame in its parent: a point with child components x has parent components R x + p.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement<T = f64> {
    /// R: child components to parent components.
    pub rotation: Rotation<T>,
    /// p: origin of the child frame in the parent frame, m.
    pub translation: Vec3<T>,
}

impl<T: Scalar> Placement<T> {
    /// The child frame is the parent frame.
    pub const IDENTITY: Self = Self { rotation: Rotation::IDENTITY, translation: Vec3::ZERO };

    /// A constant placement (the same in every state).
    #[inline(always)]
    pub fn from_f64(p: &Placement<f64>) -> Self {
        Self { rotation: Rotation::from_f64(&p.rotation), translation: Vec3::from_f64(p.translation) }
    }

    /// Parent components of the point with child components `x`.
    #[inline(always)]
    pub fn point(&self, x: Vec3<T>) -> Vec3<T> {
        self.rotation * x + self.translation
    }

    /// A motion given at the parent's origin, at the child's origin and in child axes: (Rᵀ ω, Rᵀ (v + ω × p)).
    #[inline(always)]
    pub fn motion_to_child(&self, m: Motion<T>) -> Motion<T> {
        Motion {
            angular: self.rotation.unrotate(m.angular),
            linear: self.rotation.unrotate(m.linear + m.angular.cross(self.translation)),
        }
    }

    /// A force given at the child's origin, at the parent's origin and in parent axes: (R f, R n + p × R f).
    #[inline(always)]
    pub fn force_to_parent(&self, f: Force<T>) -> Force<T> {
        let linear = self.rotation * f.linear;
        Force { linear, angular: self.rotation * f.angular + self.translation.cross(linear) }
    }
}

impl<T: Scalar> Default for Placement<T> {
    fn default() -> Self {
        Self::IDENTITY
    }
}

/// The pose of a grandchild: (R₁ R₂, R₁ p₂ + p₁).
impl<T: Scalar> Mul for Placement<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, child: Self) -> Self {
        Self { rotation: self.rotation * child.rotation, translation: self.point(child.translation) }
    }
}
