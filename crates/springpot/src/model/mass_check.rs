//! Whether the mass matrix is positive definite.

use super::degree::JointMotion;
use super::error::ModelError;
use super::robot::Model;
use super::validate;
use crate::spatial::{Inertia, Motion, Placement, Rotation, Vec3};

/// A pivot below this share of what it was computed from is rounding.
const PIVOT_TOLERANCE: f64 = 1e-14;

/// Rounding of a link's inertia about its origin, summed over what is fixed to it.
const ROUNDING: f64 = 1e-14;

type Vec6 = [f64; 6];
type Matrix6 = [Vec6; 6];

/// Refuses a robot whose mass matrix is singular in every configuration, or not positive in a generic one.
///
/// The pivots of M = Lᵀ D L are the inertias D_j that joint j feels when all joints beyond it are free (Featherstone, Rigid
/// Body Dynamics Algorithms, 2008, §7.3). det M is analytic in q: if it vanishes at one generic q, it does so everywhere. A
/// singularity of single configurations (point masses on massless rods) is not seen here, nor is, where inertias are negative, what
/// other configurations do.
pub(super) fn positive_definite(model: &Model) -> Result<(), ModelError> {
    let n = model.joint_count();
    let length = length_scale(model);
    let mut articulated: Vec<Matrix6> = model.masses.inertias.iter().map(matrix).collect();
    // What the diagonal blocks would be without the subtraction, the measure of their rounding error.
    let mut gross: Vec<[f64; 2]> = articulated.iter().map(block_traces).collect();
    let mut leads = vec![false; n];
    for leader in model.numbering.followed.iter().flatten() {
        leads[*leader] = true;
    }
    for j in (0..n).rev() {
        let body = model.bodies_of_joints[j];
        let name = || model.names.bodies[body].clone();
        if !gross[j].iter().all(|x| x.is_finite()) {
            return Err(ModelError::Overflow { body, name: name() });
        }
        let mut reduced = articulated[j];
        let mut lost = Vec::with_capacity(6);
        // Joints that follow one another share their inertia: a singularity of theirs is not looked for.
        let degrees = if model.numbering.followed[j].is_some() || leads[j] { 0..0 } else { model.degrees_of(j) };
        for degree in model.tree.degrees[degrees].iter().rev() {
            let Motion { angular, linear } = degree.unit(model.pitches[j]);
            let unit = [angular.0, linear.0];
            let unit = unit.as_flattened();
            // What it does not move is left out: it may be infinite.
            let moved = || (0..6).filter(|&k| unit[k] != 0.0);
            let column = reduced.map(|row| moved().map(|k| row[k] * unit[k]).sum::<f64>());
            let armature = model.drivetrain.armature[j];
            let pivot = moved().map(|k| column[k] * unit[k]).sum::<f64>() + armature;
            let before = moved().map(|k| gross[j][k / 3] * unit[k] * unit[k]).sum::<f64>() + armature;
            if !pivot.is_finite() {
                return Err(ModelError::Overflow { body, name: name() });
            }
            // Of an inertia that was accepted, what it is measured by may be negative too.
            if pivot <= PIVOT_TOLERANCE * before.max(0.0) {
                let joint = model.names.joints[j].clone();
                return Err(match pivot < -PIVOT_TOLERANCE * before.abs() {
                    true => ModelError::IndefiniteMassMatrix { body, name: name(), joint },
                    false => ModelError::SingularMassMatrix { body, name: name(), joint },
                });
            }
            for r in 0..6 {
                for c in 0..6 {
                    reduced[r][c] -= column[r] * column[c] / pivot;
                }
            }
            lost.push((column, pivot));
        }
        let Some(parent) = model.parents[j].checked_sub(1) else { continue };
        let transform = force_transform(&generic_placement(model, j, length));
        let moved = congruence(&transform, &reduced);
        let traces = block_traces(&moved);
        for block in 0..2 {
            gross[parent][block] += traces[block];
        }
        for (column, pivot) in lost {
            let turned = transform.map(|row| (0..6).map(|k| row[k] * column[k]).sum::<f64>());
            for block in 0..2 {
                gross[parent][block] += turned[3 * block..3 * block + 3].iter().map(|x| x * x / pivot).sum::<f64>();
            }
        }
        for r in 0..6 {
            for c in 0..6 {
                articulated[parent][r][c] += moved[r][c];
            }
        }
    }
    Ok(())
}

/// Refuses a link whose inertia, with all that is fixed to it, no mass distribution has, unless all are taken; tells whether one has a
/// negative principal moment.
pub(super) fn links(model: &Model, takes_any: bool) -> Result<bool, ModelError> {
    let mut any_negative = false;
    for (inertia, &body) in model.masses.inertias.iter().zip(&model.bodies_of_joints) {
        let central = inertia.about_com().to_matrix();
        let name = &model.names.bodies[body];
        if central.iter().flatten().any(|x| !x.is_finite()) {
            return Err(ModelError::Overflow { body, name: name.clone() });
        }
        // The tensor about the centre of mass is a difference, known to the rounding of what it is taken from.
        let about_origin = inertia.rotational.to_matrix().iter().flatten().fold(0.0, |s: f64, x| s.max(x.abs()));
        match validate::inertia(body, name, central, ROUNDING * about_origin, true) {
            Err(error) if takes_any && error.is_of_no_mass() => {
                any_negative |= matches!(error, ModelError::InertiaNotPositive { .. });
            }
            judged => judged?,
        }
    }
    Ok(any_negative)
}

/// A length of the robot's own size, m.
fn length_scale(model: &Model) -> f64 {
    let offsets = model.placements.iter().map(|p| p.translation.norm());
    let centres = model.masses.inertias.iter().filter(|i| i.mass > 0.0).map(|i| i.first_moment.norm() / i.mass);
    let largest = offsets.chain(centres).filter(|x| x.is_finite()).fold(0.0, f64::max);
    if largest > 0.0 { largest } else { 1.0 }
}

/// The placement of joint j at a coordinate without special angles or distances.
fn generic_placement(model: &Model, j: usize, length: f64) -> Placement {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let generic = 0.37 + ((j + 1) as f64 * GOLDEN).fract();
    let at_zero = model.placements[j];
    if model.motions[j] == JointMotion::Spherical {
        let turn = Rotation::from_rpy([generic, 0.5 * generic, -generic]);
        return Placement { rotation: at_zero.rotation * turn, ..at_zero };
    }
    // Wherever a floating joint stands, it takes up all that it carries.
    let [degree] = model.tree.degrees[model.degrees_of(j)] else { return at_zero };
    let Motion { angular: Vec3([.., turn]), linear: Vec3([.., shift]) } = degree.unit(model.pitches[j]);
    let coordinate = if turn == 0.0 { generic * length } else { generic };
    let (sin, cos) = (turn * coordinate).sin_cos();
    Placement {
        rotation: at_zero.rotation.turned_about_z(sin, cos),
        translation: at_zero.rotation.z_axis().times_plus(shift * coordinate, at_zero.translation),
    }
}

/// \[v\]× as rows.
fn cross_matrix(v: Vec3) -> [[f64; 3]; 3] {
    let [x, y, z] = v.0;
    [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]
}

/// The 6 × 6 inertia, angular rows first: [[I, h×], [−h×, m 1]].
fn matrix(inertia: &Inertia) -> Matrix6 {
    let (rotational, h) = (inertia.rotational.to_matrix(), cross_matrix(inertia.first_moment));
    let mut m = [[0.0; 6]; 6];
    for r in 0..3 {
        m[3 + r][3 + r] = inertia.mass;
        for c in 0..3 {
            m[r][c] = rotational[r][c];
            m[r][3 + c] = h[r][c];
            m[3 + r][c] = -h[r][c];
        }
    }
    m
}

/// The matrix that takes (moment, force) from child to parent: [[R, p× R], [0, R]].
fn force_transform(placement: &Placement) -> Matrix6 {
    let r = placement.rotation.0;
    let p = cross_matrix(placement.translation);
    let mut m = [[0.0; 6]; 6];
    for i in 0..3 {
        for k in 0..3 {
            m[i][k] = r[i][k];
            m[3 + i][3 + k] = r[i][k];
            m[i][3 + k] = (0..3).map(|l| p[i][l] * r[l][k]).sum();
        }
    }
    m
}

/// X A Xᵀ.
fn congruence(x: &Matrix6, a: &Matrix6) -> Matrix6 {
    let product = x.map(|row| [0, 1, 2, 3, 4, 5].map(|c| (0..6).map(|k| row[k] * a[k][c]).sum::<f64>()));
    product.map(|row| [0, 1, 2, 3, 4, 5].map(|c| (0..6).map(|k| row[k] * x[c][k]).sum()))
}

/// Traces of the angular and of the linear diagonal block.
fn block_traces(m: &Matrix6) -> [f64; 2] {
    [m[0][0] + m[1][1] + m[2][2], m[3][3] + m[4][4] + m[5][5]]
}
