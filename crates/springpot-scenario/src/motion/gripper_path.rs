//! The gripper follows a path.

use super::joints::{ByJoint, Parts, rpy, signal};
use super::{Made, Maker, record};
use crate::reader::{Field, Read, Refused, Table, all};
use crate::robot::{OwnJoint, Robot};
use crate::signals::plan::SignalPlan;
use crate::text::refusal::RefusalKind;
use serde_json::{Map, Value, json};
use springpot::model::Model;
use springpot::model::description::FLOATING_BASE;
use springpot::motion::gripper_path::{Course, Task};
use springpot::motion::{GripperPath, Trajectory};
use springpot::system::Motion;
use std::sync::Arc;

/// A path that is followed from near a guess.
#[derive(Debug)]
pub(super) struct Path {
    task: Task,
    /// Coordinates near the start (every joint has one), in the order of q, rad or m.
    guess: Vec<f64>,
}

impl Path {
    /// Where the gripper should be: world x, y, z, m.
    pub(super) fn position(&self) -> &[springpot::signal::Signal; 3] {
        &self.task.position
    }

    /// Near these coordinates, in place of a guess.
    pub(super) fn start_from(&mut self, q: &[f64]) {
        self.guess.copy_from_slice(q);
    }

    /// The motion of `model` along it, as far as `course` goes.
    pub(super) fn trajectory(&self, model: &Model, course: &Course<'_>) -> Trajectory {
        let path = GripperPath::new(model, self.task.clone(), &self.guess, course);
        Trajectory::GripperPath(Box::new(path))
    }
}

impl Maker for Path {
    fn motion(&self, model: &Model, course: &Course<'_>) -> Motion {
        self.trajectory(model, course).into()
    }

    fn has_path(&self) -> bool {
        true
    }
}

/// Reads what belongs to the kind "gripper-path".
pub(super) fn read(table: &Table<'_>, robot: &Robot, end: Option<f64>) -> Read<Made> {
    let (record, path) = path(table, robot, end)?;
    Ok((record, Arc::new(path)))
}

/// Reads a path of the gripper and its record, whoever follows it.
pub(super) fn path(table: &Table<'_>, robot: &Robot, end: Option<f64>) -> Read<(Map<String, Value>, Path)> {
    if robot.gripper.is_none() {
        let message = "kind = \"gripper-path\" needs a gripper, but the robot has none";
        let place = table.get("kind").map_or(&table.node.place, |field| &field.node.place);
        let right = "write [robot.gripper] with body = \"NAME\" and point = [x, y, z]";
        table.ctx.refuse(place.refuse(RefusalKind::Missing, message).help(right));
    }
    if let Some(joint) = robot.own_joints().find(|joint| joint.units().is_none()) {
        let (name, kind) = (joint.name, robot.kind_of(&joint).name());
        let message = format!("kind = \"gripper-path\" moves joints of one degree, but joint {name:?} is {kind}");
        let place = table.get("kind").map_or(&table.node.place, |field| &field.node.place);
        let right = match &robot.parts.urdf {
            Some(_) if name == FLOATING_BASE => "leave floating_base out, or write kind = \"prescribed\"",
            _ => "write kind = \"prescribed\", or a joint of another kind",
        };
        return Err(table.ctx.refuse(place.refuse(RefusalKind::Rule, message).help(right)));
    }
    let axis = |key: &'static str| {
        let field = table.require(key)?;
        signal(&field, true, end)
    };
    let (x, y, z) = (axis("x"), axis("y"), axis("z"));
    let rpy = table.get("rpy").map(|field| rpy(&field, end)).transpose();
    let guess = table.get("guess").map_or_else(|| Ok(vec![0.0; robot.model().nq()]), |field| guess(&field, robot));
    let (x, y, z, rpy, guess) = (x?, y?, z?, rpy?, guess?);
    let gripper = robot.gripper.as_ref().ok_or(Refused)?;
    let guesses: Map<String, Value> =
        robot.own_joints().map(|joint| joint.name.to_owned()).zip(guess.iter().map(|guess| json!(guess))).collect();
    let record = record([
        ("x", x.record()),
        ("y", y.record()),
        ("z", z.record()),
        ("rpy", json!(rpy.as_ref().map(|rpy| rpy.each_ref().map(SignalPlan::record)))),
        ("guess", guesses.into()),
    ]);
    let model = robot.model();
    let task = Task {
        site: model.resolve(&gripper.anchor).expect("an anchor that was read"),
        frame: model.frame(gripper.anchor.body).expect("a body that was read"),
        position: [x, y, z].map(|signal| signal.signal),
        rpy: rpy.map(|rpy| rpy.map(|signal| signal.signal)),
    };
    Ok((record, Path { task, guess }))
}

fn guess(field: &Field<'_>, robot: &Robot) -> Read<Vec<f64>> {
    let given = ByJoint::open(field, robot, Parts::Coordinates)?;
    let unit = |joint: &OwnJoint<'_>| joint.units().map_or("", |units| units.coordinate);
    all(robot.own_joints().map(|joint| given.get(&joint).map_or(Ok(0.0), |field| field.number(unit(&joint)))))
}
