//! The links and joints of a file as one tree.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use super::error::DescriptionError;
use super::joint::JointEntry;
use super::link::LinkEntry;
use super::problem::DescriptionProblem;
use super::problem::Owner;
use super::reader::Reader;
use crate::names::nearest;

/// Links of a circle that a message names.
const NAMED: usize = 20;

/// The root, and the order of the others.
pub(super) struct Tree {
    /// Index of the root link.
    pub(super) root: usize,
    /// Every joint with the link that it carries, parents first, depth first, siblings in the order of the file.
    pub(super) order: Vec<Branch>,
}

/// A joint, and the links at its ends, by their indices in the file.
#[derive(Debug, Clone, Copy)]
pub(super) struct Branch {
    pub(super) joint: usize,
    pub(super) parent: usize,
    pub(super) child: usize,
}

impl Tree {
    /// # Errors
    /// No links, names that are not unique, links that do not exist, and links that are not one tree.
    pub(super) fn of<'a>(
        reader: &Reader<'a>,
        links: &[LinkEntry<'a>],
        joints: &[JointEntry<'a>],
    ) -> Result<Self, DescriptionError> {
        let branches = branches(reader, links, joints)?;
        let mut joint_of_link: Vec<Option<usize>> = vec![None; links.len()];
        for (joint, branch) in branches.iter().enumerate() {
            if let Some(first) = joint_of_link[branch.child].replace(joint) {
                let name = |joint: usize| joints[joint].spec.name.clone();
                let (link, line) = (links[branch.child].name.to_owned(), reader.line(joints[first].node));
                let problem = DescriptionProblem::TwoParents { link, first: name(first), line, second: name(joint) };
                return Err(reader.fail(joints[joint].child.0, problem));
            }
        }
        let roots: Vec<usize> = (0..links.len()).filter(|&link| joint_of_link[link].is_none()).collect();
        let &[root] = roots.as_slice() else {
            let Some(second) = roots.get(1) else {
                return Err(circle(reader, links, joints, &branches, &joint_of_link, 0));
            };
            let names = roots.iter().map(|&link| links[link].name.to_owned()).collect();
            return Err(reader.fail(links[*second].node, DescriptionProblem::SeveralRoots { roots: names }));
        };

        let mut children: Vec<Vec<usize>> = vec![Vec::new(); links.len()];
        for (joint, branch) in branches.iter().enumerate() {
            children[branch.parent].push(joint);
        }
        let mut order = Vec::with_capacity(joints.len());
        let mut waiting: Vec<usize> = children[root].iter().rev().copied().collect();
        while let Some(joint) = waiting.pop() {
            order.push(branches[joint]);
            waiting.extend(children[branches[joint].child].iter().rev());
        }
        if order.len() < joints.len() {
            let mut is_reached = vec![false; links.len()];
            is_reached[root] = true;
            order.iter().for_each(|branch| is_reached[branch.child] = true);
            let lost = is_reached.iter().position(|reached| !reached).unwrap_or(root);
            return Err(circle(reader, links, joints, &branches, &joint_of_link, lost));
        }
        Ok(Self { root, order })
    }
}

/// The ends of every joint.
fn branches<'a>(
    reader: &Reader<'a>,
    links: &[LinkEntry<'a>],
    joints: &[JointEntry<'a>],
) -> Result<Vec<Branch>, DescriptionError> {
    let mut link_lookup: HashMap<&str, usize> = HashMap::with_capacity(links.len());
    for (index, link) in links.iter().enumerate() {
        match link_lookup.entry(link.name) {
            Entry::Vacant(entry) => entry.insert(index),
            Entry::Occupied(entry) => {
                let (owner, first) = (Owner::Link(link.name.to_owned()), reader.line(links[*entry.get()].node));
                return Err(reader.fail(link.node, DescriptionProblem::DuplicateName { owner, first }));
            }
        };
    }
    let mut joint_lookup: HashMap<&str, usize> = HashMap::with_capacity(joints.len());
    let mut branches = Vec::with_capacity(joints.len());
    for (index, joint) in joints.iter().enumerate() {
        let name = &joint.spec.name;
        match joint_lookup.entry(name) {
            Entry::Vacant(entry) => entry.insert(index),
            Entry::Occupied(entry) => {
                let (owner, first) = (Owner::Joint(name.clone()), reader.line(joints[*entry.get()].node));
                return Err(reader.fail(joint.node, DescriptionProblem::DuplicateName { owner, first }));
            }
        };
        let end = |(node, link), element| {
            link_lookup.get(link).copied().ok_or_else(|| {
                let suggestion = nearest(link, links.iter().map(|link| link.name)).map(str::to_owned);
                let (joint, link) = (name.clone(), link.to_owned());
                reader.fail(node, DescriptionProblem::UnknownLink { joint, element, link, suggestion })
            })
        };
        let (parent, child) = (end(joint.parent, "parent")?, end(joint.child, "child")?);
        if parent == child {
            let problem = DescriptionProblem::JoinsItself { joint: name.clone(), link: links[parent].name.to_owned() };
            return Err(reader.fail(joint.node, problem));
        }
        branches.push(Branch { joint: index, parent, child });
    }
    Ok(branches)
}

/// The circle that `start` is on or hangs on; its links are the children of one joint each.
fn circle<'a>(
    reader: &Reader<'a>,
    links: &[LinkEntry<'a>],
    joints: &[JointEntry<'a>],
    branches: &[Branch],
    joint_of_link: &[Option<usize>],
    start: usize,
) -> DescriptionError {
    let parent = |link: usize| joint_of_link[link].map_or(link, |joint| branches[joint].parent);
    // As many steps up as there are links end inside the circle.
    let inside = (0..links.len()).fold(start, |link, _| parent(link));
    let mut circle = vec![inside];
    let mut link = parent(inside);
    while link != inside {
        circle.push(link);
        link = parent(link);
    }
    circle.reverse();
    // From the link that comes first in the file.
    let first = circle.iter().enumerate().min_by_key(|(_, link)| **link).map_or(0, |(k, _)| k);
    circle.rotate_left(first);
    let names = circle.iter().take(NAMED).map(|&link| links[link].name.to_owned()).collect();
    let node = joint_of_link[circle[0]].map_or(links[circle[0]].node, |joint| joints[joint].node);
    reader.fail(node, DescriptionProblem::Cycle { links: names })
}
