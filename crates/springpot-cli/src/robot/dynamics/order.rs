//! The order of the numbers in a file of states: one block a joint.

use super::json_text::Json;
use crate::robot::Robot;
use springpot::model::Label;
use springpot_scenario::{Refusal, RefusalKind, Refusals, suggest};

/// Which number of q and v stands where in a file.
#[derive(Debug)]
pub(super) struct Order {
    /// The joints, in the order of their blocks.
    pub(super) joints: Vec<String>,
    /// Index in the model's q of every number of the file's q, and what it is called.
    pub(super) q: Vec<usize>,
    pub(super) q_names: Vec<String>,
    /// The same of v, a, tau and all results.
    pub(super) v: Vec<usize>,
    pub(super) v_names: Vec<String>,
}

impl Order {
    /// The order of the model.
    pub(super) fn of_model(robot: &Robot) -> Self {
        let joints: Vec<usize> = robot.own_joints().map(|(joint, _)| joint).collect();
        Self::of(robot, &joints)
    }

    /// The order that a file gives; every joint that has coordinates of its own must be there once.
    pub(super) fn read(robot: &Robot, names: &Json<'_>) -> Result<Self, Refusals> {
        let Some(items) = names.items() else {
            let message = format!("\"joints\" is {}, but must be an array of names", names.written());
            return Err(names.refuse(RefusalKind::WrongType, message).into());
        };
        let mut joints = Vec::with_capacity(items.len());
        for item in &items {
            let Some(name) = item.text() else {
                let message = format!("\"joints\" holds {}, but must hold names", item.written());
                return Err(item.refuse(RefusalKind::WrongType, message).into());
            };
            let own = robot.own_joints().find(|(_, own)| *own == name);
            let (joint, _) = own.ok_or_else(|| no_such_joint(robot, item, &name))?;
            if joints.contains(&joint) {
                let refusal = item.refuse(RefusalKind::BadName, format!("joint {name:?} stands twice"));
                return Err(refusal.help("name every joint once").into());
            }
            joints.push(joint);
        }
        let missing: Vec<&str> =
            robot.own_joints().filter(|(joint, _)| !joints.contains(joint)).map(|(_, name)| name).collect();
        if !missing.is_empty() {
            let message = format!("\"joints\" leaves out {}", missing.join(", "));
            let refusal = names.refuse(RefusalKind::Missing, message);
            return Err(refusal.help("name every joint that has coordinates of its own").into());
        }
        Ok(Self::of(robot, &joints))
    }

    fn of(robot: &Robot, joints: &[usize]) -> Self {
        let model = &robot.model;
        let q: Vec<usize> = joints.iter().flat_map(|&joint| model.q_range(joint)).collect();
        let v: Vec<usize> = joints.iter().flat_map(|&joint| model.v_range(joint)).collect();
        let names = |labels: Vec<Label>, order: &[usize]| order.iter().map(|&k| labels[k].name.clone()).collect();
        Self {
            joints: joints.iter().map(|&joint| model.joint_names()[joint].clone()).collect(),
            q_names: names(model.q_labels(), &q),
            v_names: names(model.v_labels(), &v),
            q,
            v,
        }
    }

    /// Numbers of the file in the order of the model.
    pub(super) fn into_model(order: &[usize], numbers: &[f64]) -> Vec<f64> {
        let mut sorted = vec![0.0; order.len()];
        for (&index, &number) in order.iter().zip(numbers) {
            sorted[index] = number;
        }
        sorted
    }
}

/// Why there are no numbers of a joint of this name.
fn no_such_joint(robot: &Robot, item: &Json<'_>, name: &str) -> Refusal {
    let refuse = |kind, message: String, help: String| item.refuse(kind, message).help(help);
    let leave_out = "leave it out".to_owned();
    if let Some((leader, ..)) = robot.model.joint_index(name).and_then(|joint| robot.model.followed(joint)) {
        let leader = &robot.model.joint_names()[leader];
        let message = format!("joint {name:?} follows joint {leader:?} and has no coordinate of its own");
        return refuse(RefusalKind::Rule, message, "leave it out; --ignore-mimic gives it a coordinate".to_owned());
    }
    if robot.fixed_bodies().any(|(_, body)| body.joint.name == name) {
        return refuse(RefusalKind::Rule, format!("joint {name:?} is fixed and has no coordinate"), leave_out);
    }
    if let Some(link) = robot.bodies.iter().find(|body| body.name == name) {
        let message = format!("{name:?} is a link, not a joint; the joint that carries it is {:?}", link.joint.name);
        return refuse(RefusalKind::UnknownName, message, "name joints".to_owned());
    }
    let names: Vec<&str> = robot.own_joints().map(|(_, name)| name).collect();
    refuse(RefusalKind::UnknownName, format!("there is no joint {name:?}"), suggest(name, names.iter().copied()))
}
