//! Christoffel symbols of the first kind, in closed form.

use super::crba::composites;
use super::{Kinematics, Workspace, joint};
use crate::model::{JointMotion, Model};
use crate::spatial::{Scalar, Symmetric3, Vec3};

/// Christoffel symbols of the first kind Γ_ab,c = ½(∂_a M_bc + ∂_b M_ac − ∂_c M_ab), so that (C v)_c = Γ_ab,c v^a v^b.
///
/// `gamma` is nv × nv × nv with Γ_ab,c at (a·nv + b)·nv + c, symmetric in a and b (all entries are written); needs positions.
/// With lo = min(a, b) and hi = max(a, b), one of which must carry the other, and with Π_i = ½ tr(J_i) I − J_i,
///
/// Γ_ab,c = Σ_{i carried by hi} m_i (Om_lo × T_hi(C_i))·T_c(C_i) + Om_lo·Π_i (Om_hi × Om_c) = Om_lo·∫ T_hi × T_c dm.
///
/// The integral runs over what both hi and c carry: it is a moment of the composite body of the deeper one, known from its
/// mass and first and second moments. So O(n d²) operations fill the array (d: depth of the tree), beyond the nv³ zeros.
pub fn christoffel_into<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    workspace: &mut Workspace<T>,
    gamma: &mut [T],
) {
    let n = model.nv();
    assert_eq!(gamma.len(), n * n * n, "the Christoffel symbols are nv x nv x nv");
    composites(model, kinematics, &mut workspace.composite);
    gamma.fill(T::ZERO);
    let index = |a: usize, b: usize, c: usize| (a * n + b) * n + c;
    for k in 0..n {
        let deeper = Deeper::new(model, kinematics, workspace, k);
        // ∫ T_k × T_h dm changes its sign with the order of k and h, and vanishes for h = k.
        for h in joint::path_to_world(model, model.parent_link(k)) {
            let moment = deeper.moment_against(model, kinematics, h);
            for lo in joint::path_to_world(model, k + 1) {
                let entry = joint::angular_column(model, lo, kinematics.link(lo + 1)).dot(moment);
                gamma[index(lo, k, h)] = entry;
                gamma[index(k, lo, h)] = entry;
            }
            for lo in joint::path_to_world(model, h + 1) {
                let entry = -joint::angular_column(model, lo, kinematics.link(lo + 1)).dot(moment);
                gamma[index(lo, h, k)] = entry;
                gamma[index(h, lo, k)] = entry;
            }
        }
    }
}

/// [`christoffel_into`], allocating.
pub fn christoffel<T: Scalar>(model: &Model, kinematics: &Kinematics<T>) -> Vec<T> {
    let n = model.nv();
    let mut gamma = vec![T::ZERO; n * n * n];
    christoffel_into(model, kinematics, &mut Workspace::new(model), &mut gamma);
    gamma
}

/// The deeper joint of two, with the moments of mass of all it carries about its own origin.
struct Deeper<T> {
    motion: JointMotion,
    origin: Vec3<T>,
    axis: Vec3<T>,
    mass: T,
    first: Vec3<T>,
    second: Symmetric3<T>,
}

impl<T: Scalar> Deeper<T> {
    #[inline]
    fn new(model: &Model, kinematics: &Kinematics<T>, workspace: &Workspace<T>, k: usize) -> Self {
        let (link, composite) = (kinematics.link(k + 1), &workspace.composite[k]);
        Self {
            motion: model.motion(k),
            origin: link.translation,
            axis: link.rotation.z_axis(),
            mass: composite.mass,
            first: composite.first_moment,
            second: composite.rotational.second_moments(),
        }
    }

    /// ∫ T_k × T_h dm over what this joint k carries, for a joint h that carries k.
    ///
    /// With T_k = v_k + w_k × r, T_h = v_h + w_h × r at this joint's origin and m, H = ∫ r dm, P = ∫ r rᵀ dm, it is
    /// v_k × (m v_h + w_h × H) + (w_k × H) × v_h + P (w_k × w_h).
    #[inline]
    fn moment_against(&self, model: &Model, kinematics: &Kinematics<T>, h: usize) -> Vec3<T> {
        let link = kinematics.link(h + 1);
        let velocity = joint::point_column(model, h, link, self.origin);
        let spin = joint::angular_column(model, h, link);
        match self.motion {
            JointMotion::Revolute => self.axis.cross(self.first).cross(velocity) + self.second * self.axis.cross(spin),
            JointMotion::Prismatic => self.axis.cross(velocity.times_plus(self.mass, spin.cross(self.first))),
        }
    }
}
