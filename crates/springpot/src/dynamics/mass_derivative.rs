//! Derivatives of the mass matrix.

use super::joint;
use super::kinematics::Kinematics;
use super::moments::at_reference;
use super::workspace::Workspace;
use crate::model::Model;
use crate::spatial::Scalar;

/// ∂M/∂q, the derivatives of the mass matrix along the velocities: of M(q ⊕ δ e_c) by δ, which for joints of one degree is ∂M/∂q_c.
///
/// `derivative` is nv × nv × nv with ∂M_ab/∂q_c at (a·nv + b)·nv + c, symmetric in a and b (all entries are written); needs positions. With unit motions J
/// and I of all that a degree carries at one point in world axes, and b beyond a,
///
/// - where c carries b but not a: J_a·(J_c ×* I_b J_b);
/// - where c is beyond both: J_a·(J_c ×* I_c J_b − I_c (J_c × J_b));
///
/// else 0: what carries both turns them as one. So O(n d²) operations fill the array (d: depth of the tree). ∂M_ab/∂q_c = Γ_bc,a + Γ_ac,b where all
/// joints have one degree. Source: differentiated by hand from M_ab = J_a·I_b J_b.
#[inline(always)]
pub fn mass_derivative_into<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    workspace: &mut Workspace<T>,
    derivative: &mut [T],
) {
    let (n, degrees) = (model.nv(), model.degrees());
    assert_eq!(derivative.len(), n * n * n, "the derivative of the mass matrix is nv x nv x nv");
    derivative.fill(T::ZERO);
    if n == 0 {
        return;
    }
    at_reference(model, kinematics, workspace);
    for j in (0..model.joint_count()).rev() {
        let carried = workspace.composite[j];
        if let Some(parent) = model.parent_link(j).checked_sub(1) {
            workspace.composite[parent] += carried;
        }
    }
    let (composite, unit) = (&workspace.composite, &workspace.axes.unit);
    for (k, degree) in degrees.iter().enumerate() {
        let (link, own) = (degree.link, degree.index);
        let (inertia, motion) = (composite[link - 1], unit[k]);
        let momentum = inertia * motion;
        for a in joint::carriers(model, k) {
            let (carrier, row) = (&degrees[a], degrees[a].index);
            if carrier.link == link {
                continue;
            }
            // This degree as b, with c from its own joint inwards.
            for c in joint::path_to(model, link, carrier.link) {
                let entry = unit[a].dot(unit[c].cross_force(momentum));
                let column = degrees[c].index;
                derivative[(row * n + own) * n + column] += entry;
                derivative[(own * n + row) * n + column] += entry;
            }
            // This degree as c, with a for b.
            let turned = inertia * motion.cross(unit[a]);
            let felt = motion.cross_force(inertia * unit[a]);
            for b in joint::path_to_world(model, carrier.link) {
                let entry = unit[b].dot(felt) - unit[b].dot(turned);
                let column = degrees[b].index;
                derivative[(row * n + column) * n + own] += entry;
                if degrees[b].link != carrier.link {
                    derivative[(column * n + row) * n + own] += entry;
                }
            }
        }
    }
}

/// [`mass_derivative_into`], allocating.
pub fn mass_derivative<T: Scalar>(model: &Model, kinematics: &Kinematics<T>) -> Vec<T> {
    let n = model.nv();
    let mut derivative = vec![T::ZERO; n * n * n];
    mass_derivative_into(model, kinematics, &mut Workspace::new(model), &mut derivative);
    derivative
}
