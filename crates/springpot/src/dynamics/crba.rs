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
    let n = model.nv();
    assert_eq!(mass.len(), n * n, "the mass matrix is nv x nv");
    mass.fill(T::ZERO);
    if model.is_free_of_followers() {
        entries::<T, Both>(model, kinematics, workspace, mass);
    } else {
        entries::<T, Sums>(model, kinematics, workspace, mass);
    }
}

/// [`crba_into`] of which the lower triangle alone is asked for; the upper one may be left as it is.
#[inline(always)]
pub(super) fn lower_crba_into<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    workspace: &mut Workspace<T>,
    mass: &mut [T],
) {
    let n = model.nv();
    assert_eq!(mass.len(), n * n, "the mass matrix is nv x nv");
    if !model.is_free_of_followers() {
        return crba_into(model, kinematics, workspace, mass);
    }
    for row in 0..n {
        mass[row * n..=row * n + row].fill(T::ZERO);
    }
    entries::<T, Lower>(model, kinematics, workspace, mass);
}

/// [`crba_into`] of which the lower triangle is asked for where joints couple ([`couples`]); all else may be left as it is.
#[inline(always)]
pub(super) fn coupled_crba_into<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    workspace: &mut Workspace<T>,
    mass: &mut [T],
) {
    if !model.is_free_of_followers() {
        return crba_into(model, kinematics, workspace, mass);
    }
    entries::<T, Lower>(model, kinematics, workspace, mass);
}

/// Calls `found` with row and column of each entry below the diagonal of the mass matrix that is not 0 everywhere.
pub(super) fn couples(model: &Model, mut found: impl FnMut(usize, usize)) {
    let degrees = model.degrees();
    for (k, degree) in degrees.iter().enumerate() {
        for c in joint::carriers(model, k) {
            found(degree.index, degrees[c].index);
        }
    }
}

/// Where an entry goes.
trait Places<T> {
    /// What degree `k` feels of itself.
    fn put_own(mass: &mut [T], n: usize, k: usize, entry: T);
    /// Of velocities `row` and `column`, which lies beyond, or is the same where degrees share a velocity.
    fn put(mass: &mut [T], n: usize, row: usize, column: usize, entry: T);
}

/// Into both triangles.
struct Both;
/// Into the lower triangle.
struct Lower;
/// Onto both triangles, where degrees share a velocity.
struct Sums;

// An entry is added to 0, since −0 is none.
impl<T: Scalar> Places<T> for Both {
    #[inline(always)]
    fn put_own(mass: &mut [T], n: usize, k: usize, entry: T) {
        mass[k * n + k] = T::ZERO + entry;
    }

    #[inline(always)]
    fn put(mass: &mut [T], n: usize, row: usize, column: usize, entry: T) {
        let entry = T::ZERO + entry;
        mass[row * n + column] = entry;
        mass[column * n + row] = entry;
    }
}

impl<T: Scalar> Places<T> for Lower {
    #[inline(always)]
    fn put_own(mass: &mut [T], n: usize, k: usize, entry: T) {
        mass[k * n + k] = T::ZERO + entry;
    }

    #[inline(always)]
    fn put(mass: &mut [T], n: usize, row: usize, column: usize, entry: T) {
        mass[column * n + row] = T::ZERO + entry;
    }
}

impl<T: Scalar> Places<T> for Sums {
    #[inline(always)]
    fn put_own(mass: &mut [T], n: usize, k: usize, entry: T) {
        mass[k * n + k] += entry;
    }

    #[inline(always)]
    fn put(mass: &mut [T], n: usize, row: usize, column: usize, entry: T) {
        mass[row * n + column] += entry;
        mass[column * n + row] += entry;
    }
}

/// Entries of the mass matrix where joints couple.
#[inline(always)]
fn entries<T: Scalar, P: Places<T>>(
    model: &Model,
    kinematics: &Kinematics<T>,
    workspace: &mut Workspace<T>,
    mass: &mut [T],
) {
    let (n, degrees) = (model.nv(), model.degrees());
    let Workspace { composite, columns: axes, .. } = workspace;
    composites(model, kinematics, composite);
    for (k, degree) in degrees.iter().enumerate() {
        let (link, column) = (kinematics.link(degree.link), degree.index);
        let unit = joint::unit_motion(model, degree, link, Vec3::ZERO);
        axes[k] = joint::axis(degree, link);
        let momentum = joint::momentum(degree, &composite[degree.link - 1], unit);
        P::put_own(mass, n, column, joint::felt(model, degree, axes[k], momentum));
        // Degrees of one joint, six where it floats, feel the momentum about one point.
        let (mut about, mut moved) = (degree.link, momentum);
        for c in joint::carriers(model, k) {
            if degrees[c].link != about {
                about = degrees[c].link;
                moved = momentum.shifted(link.translation - kinematics.link(about).translation);
            }
            P::put(mass, n, degrees[c].index, column, joint::felt(model, &degrees[c], axes[c], moved));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{BodySpec, JointSpec, Mimic, ModelBuilder, Parent};

    /// Eleven joints, every second one a slider; two hang on each, and one follows another where there are followers.
    fn tree(has_follower: bool) -> Model {
        let mut builder = ModelBuilder::new([0.0, 0.0, -9.81]);
        for k in 0..11_usize {
            let (name, axis, origin) = (format!("q{k}"), [1.0, 0.3 * k as f64, -0.5], [0.2, -0.1, 0.3]);
            let mut joint = if k % 2 == 0 {
                JointSpec::revolute(name, axis, origin)
            } else {
                JointSpec::prismatic(name, axis, origin)
            };
            if has_follower && k == 7 {
                joint.mimic = Some(Mimic { joint: "q3".into(), multiplier: -0.7, offset: 0.1 });
            }
            let body = BodySpec {
                name: format!("b{k}"),
                parent: k.checked_sub(1).map_or(Parent::World, |before| Parent::Body(before / 2)),
                joint,
                mass: 1.0,
                com: [0.1, 0.0, 0.2],
                inertia: [[0.2, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 0.2]],
            };
            builder.push(body).unwrap();
        }
        builder.finish().unwrap()
    }

    #[test]
    fn parts_of_the_mass_matrix_have_the_bits_of_the_whole() {
        for has_follower in [false, true] {
            let model = tree(has_follower);
            let n = model.nv();
            let (kinematics, mut workspace) =
                (Kinematics::at_position(&model, &model.random(3)), Workspace::new(&model));
            let bits = |matrix: &[f64], row: usize, column: usize| matrix[row * n + column].to_bits();
            let [mut whole, mut lower, mut coupled, mut sums] = [(); 4].map(|()| vec![f64::NAN; n * n]);
            crba_into(&model, &kinematics, &mut workspace, &mut whole);
            lower_crba_into(&model, &kinematics, &mut workspace, &mut lower);
            coupled_crba_into(&model, &kinematics, &mut workspace, &mut coupled);
            sums.fill(0.0);
            entries::<f64, Sums>(&model, &kinematics, &mut workspace, &mut sums);
            let mut is_coupled = vec![false; n * n];
            couples(&model, |row, column| is_coupled[row * n + column] = true);
            for row in 0..n {
                for column in 0..n {
                    let entry = bits(&whole, row, column);
                    assert_eq!(entry, bits(&sums, row, column), "{row} {column}");
                    assert_eq!(entry, bits(&whole, column, row), "{row} {column}");
                    if column <= row {
                        assert_eq!(entry, bits(&lower, row, column), "{row} {column}");
                    }
                    if is_coupled[row * n + column] || row == column {
                        assert_eq!(entry, bits(&coupled, row, column), "{row} {column}");
                    } else if !is_coupled[column * n + row] {
                        assert_eq!(entry, 0.0_f64.to_bits(), "{row} {column}");
                    }
                }
            }
        }
    }
}
