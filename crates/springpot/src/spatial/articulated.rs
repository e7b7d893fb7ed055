//! Articulated-body inertias.

use std::ops::AddAssign;

use super::force::Force;
use super::inertia::Inertia;
use super::motion::Motion;
use super::scalar::Scalar;
use super::symmetric::Symmetric3;
use super::vector::Vec3;

/// A symmetric 6 × 6 inertia about the origin of the frame in which it is expressed: (n, f) = [[A, B], [Bᵀ, C]] (α, β) with
/// moment n, force f, angular α and linear β.
///
/// A rigid body has A its inertia tensor, B = \[h\]× and C = m 1; a body that feels free joints beyond it has no such structure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArticulatedInertia<T = f64> {
    /// A, kg·m².
    pub angular: Symmetric3<T>,
    /// B, kg·m, row by row.
    pub coupling: [Vec3<T>; 3],
    /// C, kg.
    pub linear: Symmetric3<T>,
}

impl<T: Scalar> ArticulatedInertia<T> {
    /// No inertia.
    pub const ZERO: Self = Self { angular: Symmetric3::ZERO, coupling: [Vec3::ZERO; 3], linear: Symmetric3::ZERO };

    /// A rigid body.
    #[inline(always)]
    pub fn from_rigid(inertia: &Inertia<T>) -> Self {
        let ([x, y, z], m) = (inertia.first_moment.0, inertia.mass);
        Self {
            angular: inertia.rotational,
            coupling: [Vec3([T::ZERO, -z, y]), Vec3([z, T::ZERO, -x]), Vec3([-y, x, T::ZERO])],
            linear: Symmetric3 { xx: m, yy: m, zz: m, ..Symmetric3::ZERO },
        }
    }

    /// The force that gives the angular acceleration `alpha` alone: (A α, Bᵀ α).
    #[inline(always)]
    pub fn times_angular(&self, alpha: Vec3<T>) -> Force<T> {
        let ([x, y, z], [b0, b1, b2]) = (alpha.0, self.coupling);
        Force { angular: self.angular * alpha, linear: b2.times_plus(z, b1.times_plus(y, b0 * x)) }
    }

    /// The force that gives the linear acceleration `beta` alone: (B β, C β).
    #[inline(always)]
    pub fn times_linear(&self, beta: Vec3<T>) -> Force<T> {
        let [b0, b1, b2] = self.coupling;
        Force { angular: Vec3([b0.dot(beta), b1.dot(beta), b2.dot(beta)]), linear: self.linear * beta }
    }

    /// The force that the acceleration `m` takes: (A α + B β, Bᵀ α + C β).
    #[inline(always)]
    pub fn times(&self, m: Motion<T>) -> Force<T> {
        self.times_angular(m.angular) + self.times_linear(m.linear)
    }

    /// self − U Uᵀ k: what is left when one joint yields.
    #[inline(always)]
    pub fn minus_outer(&self, u: Force<T>, k: T) -> Self {
        let ([nx, ny, nz], f) = (u.angular.0, u.linear);
        let minus_k = -k;
        let [b0, b1, b2] = self.coupling;
        let kf = f * minus_k;
        Self {
            angular: plus_outer(&self.angular, u.angular, minus_k),
            coupling: [kf.times_plus(nx, b0), kf.times_plus(ny, b1), kf.times_plus(nz, b2)],
            linear: plus_outer(&self.linear, f, minus_k),
        }
    }

    /// The same inertia about another point, from which the present origin is seen at `d`; the axes stay.
    ///
    /// B' = B + \[d\]× C, A' = A − B \[d\]× + \[d\]× B'ᵀ, C' = C.
    #[inline(always)]
    pub fn shifted(&self, d: Vec3<T>) -> Self {
        let c = &self.linear;
        let columns =
            [d.cross(Vec3([c.xx, c.xy, c.xz])), d.cross(Vec3([c.xy, c.yy, c.yz])), d.cross(Vec3([c.xz, c.yz, c.zz]))];
        let [Vec3([x0, x1, x2]), Vec3([y0, y1, y2]), Vec3([z0, z1, z2])] = columns;
        let [b0, b1, b2] = self.coupling;
        let coupling = [b0 + Vec3([x0, y0, z0]), b1 + Vec3([x1, y1, z1]), b2 + Vec3([x2, y2, z2])];
        // Row r of −B [d]× is d × b_r, column c of [d]× B'ᵀ is d × b'_c.
        let ([p0, p1, p2], [q0, q1, q2]) = (crossed(d, self.coupling), crossed(d, coupling));
        let a = &self.angular;
        let angular = Symmetric3 {
            xx: a.xx + (p0[0] + q0[0]),
            yy: a.yy + (p1[1] + q1[1]),
            zz: a.zz + (p2[2] + q2[2]),
            xy: a.xy + (p0[1] + q1[0]),
            xz: a.xz + (p0[2] + q2[0]),
            yz: a.yz + (p1[2] + q2[1]),
        };
        Self { angular, coupling, linear: self.linear }
    }
}

/// s + k v vᵀ; a function, since closures are not always inlined.
#[inline(always)]
fn plus_outer<T: Scalar>(s: &Symmetric3<T>, v: Vec3<T>, k: T) -> Symmetric3<T> {
    let ([x, y, z], [kx, ky, kz]) = (v.0, (v * k).0);
    Symmetric3 {
        xx: kx.times_plus(x, s.xx),
        yy: ky.times_plus(y, s.yy),
        zz: kz.times_plus(z, s.zz),
        xy: kx.times_plus(y, s.xy),
        xz: kx.times_plus(z, s.xz),
        yz: ky.times_plus(z, s.yz),
    }
}

/// d × b of every row b.
#[inline(always)]
fn crossed<T: Scalar>(d: Vec3<T>, [b0, b1, b2]: [Vec3<T>; 3]) -> [[T; 3]; 3] {
    [d.cross(b0).0, d.cross(b1).0, d.cross(b2).0]
}

impl<T: Scalar> AddAssign for ArticulatedInertia<T> {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        self.angular += o.angular;
        let ([a0, a1, a2], [b0, b1, b2]) = (self.coupling, o.coupling);
        self.coupling = [a0 + b0, a1 + b1, a2 + b2];
        self.linear += o.linear;
    }
}
