//! Which numbers of q and v belong to which joint.

use super::degree::{Coordinates, Degree};
use super::error::ModelError;
use super::robot::Model;
use super::spec::Mimic;
use std::collections::HashMap;

/// What a joint follows: that joint, the ratio and the offset.
type Leader = Option<(usize, f64, f64)>;

/// Gives every joint its coordinates and velocities, and every degree of freedom its carrier; `mimics` has one entry a joint.
pub(super) fn number(model: &mut Model, mimics: &[Option<Mimic>]) -> Result<(), ModelError> {
    let leaders = leaders(model, mimics)?;
    let mut own = Vec::with_capacity(leaders.len());
    for (space, leader) in model.spaces.iter().zip(&leaders) {
        own.push((model.numbering.nq, model.numbering.nv));
        if leader.is_none() {
            model.numbering.places.extend((0..space.nv()).map(|_| (space.nv() == 1).then_some(model.numbering.nq)));
            model.numbering.nq += space.nq();
            model.numbering.nv += space.nv();
        }
    }
    for (j, leader) in leaders.iter().enumerate() {
        let (source, ratio, offset) = leader.unwrap_or((j, 1.0, 0.0));
        let (q, v) = own[source];
        model.numbering.coordinates.push(Coordinates { q, v, ratio, offset });
        model.numbering.followed.push(leader.map(|(source, ..)| source));
        let mut carrier = model.tree.last_degrees[model.parents[j]];
        for (k, motion) in model.motions[j].degrees().into_iter().enumerate() {
            model.tree.degrees.push(Degree { link: j + 1, motion, index: v + k, ratio });
            model.tree.carriers.push(carrier);
            carrier = model.tree.degrees.len();
        }
        model.tree.last_degrees.push(carrier);
    }
    model.drivetrain.collect_rotors(&model.numbering, &model.spaces);
    // Without followers, degrees and velocities are the same; followers couple branches, so that nothing is known to stay 0.
    model.tree.pivots =
        if model.is_free_of_followers() { model.tree.carriers.clone() } else { (0..model.numbering.nv).collect() };
    model.tree.collect_ends();
    Ok(())
}

/// The joint with coordinates of its own that each joint follows in the end.
fn leaders(model: &Model, mimics: &[Option<Mimic>]) -> Result<Vec<Leader>, ModelError> {
    let names: HashMap<&str, usize> =
        model.names.joints.iter().enumerate().map(|(j, name)| (name.as_str(), j)).collect();
    let mut resolved: Vec<Option<Leader>> = vec![None; mimics.len()];
    let mut chain = Vec::new();
    for j in 0..mimics.len() {
        let mut at = j;
        // Outwards to a joint that is resolved or follows none, then back.
        while resolved[at].is_none() {
            let Some(mimic) = &mimics[at] else {
                resolved[at] = Some(None);
                break;
            };
            chain.push((at, mimic));
            if chain.len() > mimics.len() {
                let body = model.bodies_of_joints[j];
                return Err(ModelError::MimicCycle { body, joint: model.names.joints[j].clone() });
            }
            at = followed(model, &names, at, mimic)?;
        }
        while let Some((follower, mimic)) = chain.pop() {
            let (leader, ratio, offset) = resolved[at].flatten().unwrap_or((at, 1.0, 0.0));
            resolved[follower] =
                Some(Some((leader, mimic.multiplier * ratio, mimic.multiplier * offset + mimic.offset)));
            at = follower;
        }
    }
    Ok(resolved.into_iter().map(Option::flatten).collect())
}

/// The joint that joint `j` follows by `mimic`.
fn followed(model: &Model, names: &HashMap<&str, usize>, j: usize, mimic: &Mimic) -> Result<usize, ModelError> {
    let (body, described) = (model.bodies_of_joints[j], model.described_joint(j));
    let (joint, kind) = (described.name.clone(), described.kind);
    if kind.nv() != 1 {
        return Err(ModelError::MimicKind { body, joint, kind });
    }
    let target = names.get(mimic.joint.as_str()).copied();
    target.filter(|&target| model.spaces[target].nv() == 1).ok_or_else(|| ModelError::MimicTarget {
        body,
        joint,
        followed: mimic.joint.clone(),
        exists: model.has_joint(&mimic.joint),
    })
}
