//! Spatial inertias.

use std::ops::{Add, AddAssign, Mul};

use super::force::Force;
use super::motion::Motion;
use super::placement::Placement;
use super::rotation::Rotation;
use super::scalar::Scalar;
use super::symmetric::Symmetric3;
use super::vector::Vec3;

/// Mass, first moments and inertia tensor of a rigid body about the origin of the frame in which it is expressed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Inertia<T = f64> {
    /// Mass m, kg.
    pub mass: T,
    /// First moments h = m c with the centre of mass c, kg·m.
    pub first_moment: Vec3<T>,
    /// Inertia tensor about the origin, ∫ (r² I − r rᵀ) dm, kg·m².
    pub rotational: Symmetric3<T>,
}

impl<T: Scalar> Inertia<T> {
    /// No mass.
    pub const ZERO: Self = Self { mass: T::ZERO, first_moment: Vec3::ZERO, rotational: Symmetric3::ZERO };

    /// A constant inertia (the same in every state).
    #[inline(always)]
    pub fn from_f64(i: &Inertia<f64>) -> Self {
        Self {
            mass: T::from_f64(i.mass),
            first_moment: Vec3::from_f64(i.first_moment),
            rotational: Symmetric3::from_f64(&i.rotational),
        }
    }

    /// The inertia about the origin of a body with mass `mass`, centre of mass `com` and tensor `central` about it.
    #[inline(always)]
    pub fn from_central(mass: T, com: Vec3<T>, central: Symmetric3<T>) -> Self {
        Self { mass, first_moment: Vec3::ZERO, rotational: central }.shifted(com)
    }

    /// The same body in the axes into which `r` leads; the origin stays.
    #[inline(always)]
    pub fn rotated(&self, r: &Rotation<T>) -> Self {
        Self { mass: self.mass, first_moment: *r * self.first_moment, rotational: self.rotational.rotated(r) }
    }

    /// The same body about another point, from which the present origin is seen at `d`; the axes stay.
    ///
    /// h' = h + m d, I' = I + 2 (h·d) 1 − h dᵀ − d hᵀ + m (d·d 1 − d dᵀ).
    #[inline(always)]
    pub fn shifted(&self, d: Vec3<T>) -> Self {
        let first_moment = d.times_plus(self.mass, self.first_moment);
        // With g = h + h' = 2 h + m d the correction is (g·d) 1 − ½ (g dᵀ + d gᵀ).
        let g = self.first_moment + first_moment;
        let ([gx, gy, gz], [x, y, z]) = (g.0, d.0);
        let (px, py, pz) = (gx * x, gy * y, gz * z);
        let minus_half = T::from_f64(-0.5);
        let correction = Symmetric3 {
            xx: py + pz,
            yy: px + pz,
            zz: px + py,
            xy: minus_half * (gx * y + gy * x),
            xz: minus_half * (gx * z + gz * x),
            yz: minus_half * (gy * z + gz * y),
        };
        Self { mass: self.mass, first_moment, rotational: self.rotational + correction }
    }

    /// Momentum of the body that turns about the origin with the angular velocity `omega`: (ω × h, I ω).
    #[inline(always)]
    pub fn turned_by(&self, omega: Vec3<T>) -> Force<T> {
        Force { linear: omega.cross(self.first_moment), angular: self.rotational * omega }
    }

    /// Momentum of the body that moves with the velocity `v` without turning: (m v, h × v).
    #[inline(always)]
    pub fn shifted_by(&self, v: Vec3<T>) -> Force<T> {
        Force { linear: v * self.mass, angular: self.first_moment.cross(v) }
    }

    /// The same body in the parent frame of `placement`.
    #[inline(always)]
    pub fn to_parent(&self, placement: &Placement<T>) -> Self {
        self.rotated(&placement.rotation).shifted(placement.translation)
    }
}

impl Inertia<f64> {
    /// The tensor about the centre of mass, I − m (c·c 1 − c cᵀ); where there is no mass, the tensor itself.
    pub fn about_com(&self) -> Symmetric3 {
        if self.mass == 0.0 {
            return self.rotational;
        }
        // Adding the mass −m about the centre of mass undoes the shift.
        let com = self.first_moment * (1.0 / self.mass);
        let steiner = Self::from_central(-self.mass, com, Symmetric3::ZERO);
        self.rotational + steiner.rotational
    }
}

/// Momentum of the body that moves with a velocity.
impl<T: Scalar> Mul<Motion<T>> for Inertia<T> {
    type Output = Force<T>;
    #[inline(always)]
    fn mul(self, m: Motion<T>) -> Force<T> {
        Force {
            linear: m.linear.times_plus(self.mass, m.angular.cross(self.first_moment)),
            angular: self.rotational * m.angular + self.first_moment.cross(m.linear),
        }
    }
}

impl<T: Scalar> Add for Inertia<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            mass: self.mass + other.mass,
            first_moment: self.first_moment + other.first_moment,
            rotational: self.rotational + other.rotational,
        }
    }
}

impl<T: Scalar> AddAssign for Inertia<T> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
