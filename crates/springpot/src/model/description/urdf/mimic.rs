//! Joints that follow other joints.

use std::collections::HashMap;

use super::error::DescriptionError;
use super::joint::JointEntry;
use super::problem::DescriptionProblem;
use super::reader::Reader;
use crate::model::spec::Mimic;
use crate::names::nearest;

/// Joints of a circle that a message names.
const NAMED: usize = 20;

/// Checks that every mimic joint follows a joint of one degree, and in the end one with a coordinate of its own.
pub(super) fn check<'a>(reader: &Reader<'a>, joints: &[JointEntry<'a>]) -> Result<(), DescriptionError> {
    if joints.iter().all(|joint| joint.mimic.is_none()) {
        return Ok(());
    }
    let lookup: HashMap<&str, usize> = joints.iter().enumerate().map(|(k, joint)| (&*joint.spec.name, k)).collect();
    let mut follows: Vec<Option<usize>> = vec![None; joints.len()];
    for (index, entry) in joints.iter().enumerate() {
        let (Some(node), Some(Mimic { joint: target, .. })) = (entry.mimic, &entry.spec.mimic) else { continue };
        let (joint, target) = (entry.spec.name.clone(), target.clone());
        let Some(&followed) = lookup.get(target.as_str()) else {
            let others = joints.iter().map(|other| &*other.spec.name).filter(|other| *other != joint);
            let suggestion = nearest(&target, others).map(str::to_owned);
            return Err(reader.fail(node, DescriptionProblem::UnknownMimic { joint, target, suggestion }));
        };
        let kind = joints[followed].spec.kind;
        if kind.nv() != 1 {
            let culprit = target.clone();
            return Err(reader.fail(node, DescriptionProblem::MimicOfManyDegrees { joint, target, culprit, kind }));
        }
        follows[index] = Some(followed);
    }
    // Number of the walk that saw a joint first; a walk that meets itself is a circle.
    let mut seen: Vec<Option<usize>> = vec![None; joints.len()];
    for start in 0..joints.len() {
        let mut at = start;
        while seen[at].is_none() {
            seen[at] = Some(start);
            let Some(next) = follows[at] else { break };
            at = next;
        }
        if seen[at] == Some(start) && follows[at].is_some() {
            let mut circle = vec![at];
            let mut next = follows[at].unwrap_or(at);
            while next != at {
                circle.push(next);
                next = follows[next].unwrap_or(at);
            }
            let names = circle.iter().take(NAMED).map(|&joint| joints[joint].spec.name.clone()).collect();
            let node = joints[at].mimic.unwrap_or(joints[at].node);
            return Err(reader.fail(node, DescriptionProblem::MimicCycle { joints: names }));
        }
    }
    Ok(())
}
