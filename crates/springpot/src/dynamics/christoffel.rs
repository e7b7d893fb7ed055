//! Christoffel symbols of the first kind, in closed form.

use super::crba::composites;
use super::joint;
use super::kinematics::Kinematics;
use super::workspace::Workspace;
use crate::model::{Degree, Model};
use crate::spatial::{Motion, Placement, Scalar, Symmetric3, Vec3};

/// Christoffel symbols of the first kind Γ_ab,c = ½(∂_a M_bc + ∂_b M_ac − ∂_c M_ab), so that (C v)_c = Γ_ab,c v^a v^b.
///
/// `gamma` is nv × nv × nv with Γ_ab,c at (a·nv + b)·nv + c, symmetric in a and b (all entries are written); needs positions.
/// Panics unless all joints have one degree of freedom ([`Model::is_one_degree`]): the velocities of others are no rates of
/// coordinates.
/// With lo = min(a, b) and hi = max(a, b), one of which must carry the other, and with Π_i = ½ tr(J_i) I − J_i,
///
/// Γ_ab,c = Σ_{i carried by hi} m_i (Om_lo × T_hi(C_i))·T_c(C_i) + Om_lo·Π_i (Om_hi × Om_c) = Om_lo·∫ T_hi × T_c dm.
///
/// The integral runs over what both hi and c carry: it is a moment of the composite body of the deeper one, known from its
/// mass and first and second moments. So O(n d²) operations fill the array (d: depth of the tree), beyond the nv³ zeros.
#[inline(always)]
pub fn christoffel_into<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    workspace: &mut Workspace<T>,
    gamma: &mut [T],
) {
    assert!(model.is_one_degree(), "Christoffel symbols exist where every joint has one degree of freedom");
    let (n, degrees) = (model.nv(), model.degrees());
    assert_eq!(gamma.len(), n * n * n, "the Christoffel symbols are nv x nv x nv");
    composites(model, kinematics, &mut workspace.composite);
    gamma.fill(T::ZERO);
    let at = |a: usize, b: usize, c: usize| (degrees[a].index * n + degrees[b].index) * n + degrees[c].index;
    for (k, degree) in degrees.iter().enumerate() {
        let deeper = Deeper::new(model, kinematics, workspace, k);
        // ∫ T_k × T_h dm changes its sign with the order of k and h, and vanishes for h = k.
        for h in joint::carriers(model, k) {
            let carrier = &degrees[h];
            let moment = deeper.moment_against(model, carrier, kinematics.link(carrier.link));
            for lo in joint::path_to_world(model, degree.link) {
                let entry = joint::angular_column(&degrees[lo], kinematics.link(degrees[lo].link)).dot(moment);
                gamma[at(lo, k, h)] += entry;
                if lo != k {
                    gamma[at(k, lo, h)] += entry;
                }
            }
            for lo in joint::path_to_world(model, carrier.link) {
                let entry = -joint::angular_column(&degrees[lo], kinematics.link(degrees[lo].link)).dot(moment);
                gamma[at(lo, h, k)] += entry;
                if lo != h {
                    gamma[at(h, lo, k)] += entry;
                }
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

/// The deeper degree of two, with the moments of mass of all it carries about its own origin.
struct Deeper<T> {
    origin: Vec3<T>,
    unit: Motion<T>,
    mass: T,
    first: Vec3<T>,
    second: Symmetric3<T>,
}

impl<T: Scalar> Deeper<T> {
    #[inline(always)]
    fn new(model: &Model, kinematics: &Kinematics<T>, workspace: &Workspace<T>, k: usize) -> Self {
        let degree = &model.degrees()[k];
        let (link, composite) = (kinematics.link(degree.link), &workspace.composite[degree.link - 1]);
        Self {
            origin: link.translation,
            unit: joint::unit_motion(model, degree, link, Vec3::ZERO),
            mass: composite.mass,
            first: composite.first_moment,
            second: composite.rotational.second_moments(),
        }
    }

    /// ∫ T_k × T_h dm over what this degree k carries, for a degree h on `link` that carries k.
    ///
    /// With T_k = v_k + w_k × r, T_h = v_h + w_h × r at this degree's origin and m, H = ∫ r dm, P = ∫ r rᵀ dm, it is
    /// v_k × (m v_h + w_h × H) + (w_k × H) × v_h + P (w_k × w_h).
    #[inline(always)]
    fn moment_against(&self, model: &Model, h: &Degree, link: &Placement<T>) -> Vec3<T> {
        let velocity = joint::point_column(model, h, link, self.origin);
        let spin = joint::angular_column(h, link);
        let Motion { angular, linear } = self.unit;
        linear.cross(velocity.times_plus(self.mass, spin.cross(self.first)))
            + angular.cross(self.first).cross(velocity)
            + self.second * angular.cross(spin)
    }
}
