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
    for (kind, leader) in model.kinds.iter().zip(&leaders) {
        own.push((model.nq, model.nv));
        if leader.is_none() {
            model.nq += kind.nq();
            model.nv += kind.nv();
        }
    }
    for (j, leader) in leaders.iter().enumerate() {
        let (source, ratio, offset) = leader.unwrap_or((j, 1.0, 0.0));
        let (q, v) = own[source];
        model.coordinates.push(Coordinates { q, v, ratio, offset });
        model.followed.push(leader.map(|(source, ..)| source));
        let mut carrier = model.last_degrees[model.parents[j]];
        for (k, &motion) in model.motions[j].degrees().iter().enumerate() {
            model.degrees.push(Degree { link: j + 1, motion, index: v + k, ratio });
            model.carriers.push(carrier);
            carrier = model.degrees.len();
        }
        model.last_degrees.push(carrier);
    }
    // Without followers, degrees and velocities are the same; followers couple branches, so that nothing is known to stay 0.
    model.pivots = if model.is_free_of_followers() { model.carriers.clone() } else { (0..model.nv).collect() };
    Ok(())
}

/// The joint with coordinates of its own that each joint follows in the end.
fn leaders(model: &Model, mimics: &[Option<Mimic>]) -> Result<Vec<Leader>, ModelError> {
    let names: HashMap<&str, usize> =
        model.joint_names.iter().enumerate().map(|(j, name)| (name.as_str(), j)).collect();
    (0..mimics.len())
        .map(|j| {
            let (body, joint) = (model.bodies_of_joints[j], &model.joint_names[j]);
            let (mut at, mut ratio, mut offset) = (j, 1.0, 0.0);
            let mut hops = 0;
            while let Some(mimic) = &mimics[at] {
                let kind = model.kinds[at];
                if kind.nv() != 1 {
                    return Err(ModelError::MimicKind { body, joint: joint.clone(), kind });
                }
                let target = names.get(mimic.joint.as_str()).copied();
                at = target.filter(|&target| model.kinds[target].nv() == 1).ok_or_else(|| ModelError::MimicTarget {
                    body,
                    joint: joint.clone(),
                    followed: mimic.joint.clone(),
                    exists: target.is_some(),
                })?;
                (ratio, offset) = (ratio * mimic.multiplier, ratio * mimic.offset + offset);
                hops += 1;
                if hops > mimics.len() {
                    return Err(ModelError::MimicCycle { body, joint: joint.clone() });
                }
            }
            Ok((hops > 0).then_some((at, ratio, offset)))
        })
        .collect()
}
