//! The mass matrix by composite inertias.

use super::joint;
use super::kinematics::Kinematics;
use super::workspace::Workspace;
use crate::model::Model;
use crate::spatial::{Inertia, Scalar, Vec3};

/// Mass matrix M(q), the basic metric tensor a_ab = Σ_i m_i T_a(C_i)·T_b(C_i) + Om_a·J_i Om_b.
///
/// `mass` is nv × nv, row-major, symmetric (both triangles are written), kg·m², kg·m or kg; needs positions. With b beyond
/// a, column b is the momentum of all that joint b carries when it moves at unit speed, and a_ab is what joint a feels of it;
/// joints on different branches do not couple. Rotors stand on the diagonal.
#[inline(always)]
pub fn crba_into<T: Scalar>(model: &Model, kinematics: &Kinematics<T>, workspace: &mut Workspace<T>, mass: &mut [T]) {
    let (n, degrees) = (model.nv(), model.degrees());
    assert_eq!(mass.len(), n * n, "the mass matrix is nv x nv");
    let Workspace { composite, columns: axes, .. } = workspace;
    composites(model, kinematics, composite);
    mass.fill(T::ZERO);
    for (k, degree) in degrees.iter().enumerate() {
        let (link, column) = (kinematics.link(degree.link), degree.index);
        let unit = joint::unit_motion(model, degree, link, Vec3::ZERO);
        axes[k] = joint::axis(degree, link);
        let momentum = joint::momentum(degree, &composite[degree.link - 1], unit);
        mass[column * n + column] += joint::felt(model, degree, axes[k], momentum);
        // Degrees of one joint, six where it floats, feel the momentum about one point.
        let (mut about, mut moved) = (degree.link, momentum);
        for c in joint::carriers(model, k) {
            if degrees[c].link != about {
                about = degrees[c].link;
                moved = momentum.shifted(link.translation - kinematics.link(about).translation);
            }
            let entry = joint::felt(model, &degrees[c], axes[c], moved);
            let row = degrees[c].index;
            mass[row * n + column] += entry;
            mass[column * n + row] += entry;
        }
    }
    for (k, &rotor) in model.felt_rotors().iter().enumerate() {
        mass[k * n + k] += T::from_f64(rotor);
    }
}

/// [`crba_into`], allocating.
pub fn crba<T: Scalar>(model: &Model, kinematics: &Kinematics<T>) -> Vec<T> {
    let n = model.nv();
    let mut mass = vec![T::ZERO; n * n];
    crba_into(model, kinematics, &mut Workspace::new(model), &mut mass);
    mass
}

/// The inertia of all that each joint carries, about the joint's own origin, in world axes.
#[inline(always)]
pub(super) fn composites<T: Scalar>(model: &Model, kinematics: &Kinematics<T>, composite: &mut [Inertia<T>]) {
    let n = model.joint_count();
    let composite = &mut composite[..n];
    composite.fill(Inertia::ZERO);
    let mut carried = Inertia::ZERO;
    for j in (0..n).rev() {
        let link = kinematics.link(j + 1);
        let own = Inertia::from_f64(model.link_inertia(j)).rotated(&link.rotation);
        // Along a chain what the next joint carries is still at hand.
        let total = own + composite[j] + carried;
        composite[j] = total;
        carried = Inertia::ZERO;
        if let Some(parent) = model.parent_link(j).checked_sub(1) {
            let moved = total.shifted(link.translation - kinematics.link(parent + 1).translation);
            if parent + 1 == j {
                carried = moved;
            } else {
                composite[parent] += moved;
            }
        }
    }
}
