//! `[motion]`: the kinds of motion, each read by a file of its own.

mod controller;
mod forward;
mod gripper_path;
mod idle;
mod joints;
mod prescribed;
mod shaping;

use crate::keys::FORWARD_RUNS;
use crate::keys::{MOTION, MotionKind};
use crate::reader::{Field, Read, Table};
use crate::robot::Robot;
use crate::signals::plan::TorqueTexts;
use crate::text::refusal::{Place, RefusalKind};
use controller::ControllerPlan;
use serde_json::{Map, Value, json};
use springpot::control::Control;
use springpot::model::Model;
use springpot::motion::gripper_path::Course;
use springpot::system::Motion;
use std::fmt;
use std::sync::Arc;

/// What moves the robot.
#[derive(Debug, Clone)]
pub struct MotionPlan {
    kind: MotionKind,
    /// What the record of a run has of it besides its kind.
    record: Map<String, Value>,
    maker: Arc<dyn Maker>,
    /// Where it stands, and where the motion of each joint does that has one of its own, or a torque.
    place: Place,
    joints: Vec<(String, Place)>,
    torques: Vec<(String, Place)>,
    has_orientation: bool,
    /// Torques that are feedback, by velocity.
    feedback: TorqueTexts,
    controller: Option<ControllerPlan>,
    /// Torques and inputs that follow from the state; nothing until the plan is whole.
    control: Control,
}

/// What makes the motion of a run.
trait Maker: fmt::Debug + Send + Sync {
    /// The motion of `model`; what has to be solved for it is solved along `course`.
    fn motion(&self, model: &Model, course: &Course<'_>) -> Motion;

    /// Whether it says where the gripper should be: the joints are then found along all of it, which takes its time.
    fn has_path(&self) -> bool;
}

impl Maker for Motion {
    fn motion(&self, _: &Model, _: &Course<'_>) -> Motion {
        self.clone()
    }

    fn has_path(&self) -> bool {
        Self::has_path(self)
    }
}

/// What a kind of motion is read into: the record of it, and what makes it.
type Made = (Map<String, Value>, Arc<dyn Maker>);

fn record<const N: usize>(fields: [(&str, Value); N]) -> Map<String, Value> {
    fields.map(|(key, value)| (key.to_owned(), value)).into_iter().collect()
}

/// A motion that is known when it is read.
fn ready<const N: usize>(fields: [(&str, Value); N], motion: impl Into<Motion>) -> Made {
    (record(fields), Arc::new(motion.into()))
}

impl MotionPlan {
    /// Where the time between two samples of its controller stands, and what it is, s.
    pub(crate) fn controller_sample(&self) -> Option<(&Place, f64)> {
        self.controller.as_ref()?.sample()
    }

    /// Its kind as the scenario names it.
    pub fn kind(&self) -> &'static str {
        self.kind.name()
    }

    /// Whether it follows from forces.
    pub fn is_forward(&self) -> bool {
        self.kind == MotionKind::Forward
    }

    /// Whether it says where the gripper should be. The joints have to be found along all of it then, for each case anew.
    pub fn has_path(&self) -> bool {
        self.maker.has_path()
    }

    /// Whether a path of the gripper has to be solved, be it that of the motion or that of its controller.
    pub fn solves_path(&self) -> bool {
        self.has_path() || self.controller.as_ref().is_some_and(|controller| controller.path_place().is_some())
    }

    /// Where the motion of a joint stands in the scenario; that of the whole where there is none.
    pub fn place_of(&self, joint: &str) -> &Place {
        self.own_place_of(joint).unwrap_or(&self.place)
    }

    /// Where the motion of a joint stands that has one of its own.
    pub(crate) fn own_place_of(&self, joint: &str) -> Option<&Place> {
        said_of(&self.joints, joint)
    }

    /// Where the path of the gripper stands that it follows, or that its controller does; its own place where there is none.
    pub(crate) fn place_of_path(&self) -> &Place {
        self.controller.as_ref().and_then(ControllerPlan::path_place).unwrap_or(&self.place)
    }

    /// Where the reference of a controller stands that says what `what` is to do; its own place where there is none.
    pub(crate) fn place_of_reference(&self, what: &str) -> &Place {
        self.controller.as_ref().map_or(&self.place, |controller| controller.reference_place(what))
    }

    /// Where the force on a joint stands: its torque, else the controller.
    pub(crate) fn place_of_force(&self, joint: &str) -> Option<&Place> {
        said_of(&self.torques, joint).or_else(|| self.place_of_controller())
    }

    /// Where the controller stands.
    pub(crate) fn place_of_controller(&self) -> Option<&Place> {
        self.controller.as_ref().map(ControllerPlan::place)
    }

    /// Torques that are feedback, by velocity.
    pub(crate) fn feedback(&self) -> &TorqueTexts {
        &self.feedback
    }

    /// Whether a controller drives it, which says where the gripper should be.
    pub(crate) fn has_controller(&self) -> bool {
        self.controller.is_some()
    }

    /// Largest forces of the controller by joint, N·m or N, and where they are said.
    pub fn force_limits(&self) -> Option<(&Place, Vec<(String, f64)>)> {
        self.controller.as_ref().and_then(ControllerPlan::limits)
    }

    /// The controller in words: its kind, what it follows, when it acts.
    pub fn controller_words(&self) -> Option<String> {
        self.controller.as_ref().map(ControllerPlan::words)
    }

    /// Takes what follows from the state, its controller apart.
    pub(crate) fn follow(&mut self, control: Control) {
        self.control = control;
    }

    /// What follows from the state of `model`; the reference of its controller is solved along `course`.
    pub(crate) fn control(&self, model: &Model, course: &Course<'_>) -> Control {
        let controller = self.controller.as_ref().map(|controller| controller.made(model, course));
        Control { controller, ..self.control.clone() }
    }

    /// Whether it says how the gripper is to be turned, or its controller does.
    pub(crate) fn has_orientation(&self) -> bool {
        self.has_orientation || self.controller.as_ref().is_some_and(|controller| controller.has_orientation)
    }

    /// The motion of `model`, solved along `course`.
    pub(crate) fn made(&self, model: &Model, course: &Course<'_>) -> Motion {
        self.maker.motion(model, course)
    }

    /// As the record of a run has it.
    pub(crate) fn resolved(&self) -> Value {
        let mut resolved = json!({ "kind": self.kind() });
        if let Value::Object(resolved) = &mut resolved {
            resolved.extend(self.record.clone());
        }
        resolved
    }
}

/// Reads `[motion]`.
pub(crate) fn read(root: &Table<'_>, robot: &Robot, end: Option<f64>) -> Read<MotionPlan> {
    let field = root.require("motion")?;
    if field.node.entries().is_none() {
        return Err(field.wrong_type("a table: [motion]"));
    }
    let row = MOTION.get("kind");
    let Some(node) = field.node.get("kind") else {
        let refusal = field.node.place.refuse(RefusalKind::Missing, "[motion] has no `kind`");
        let right = row.map(|row| row.right()).unwrap_or_default();
        return Err(root.ctx.refuse(refusal.help(format!("write {right}"))));
    };
    let word = Field { key: "kind", row, node, owner: "[motion]".into(), ..field.clone() }.word("kind of motion")?;
    let kind = MotionKind::named(word).expect("a word that may stand there");
    let table = Table::of_kind(field.ctx, field.node, "[motion]", (&MOTION, kind.name()), |key| {
        MOTION.get(key).filter(|row| row.only == [MotionKind::Forward.name()])?;
        let message = format!("`{key}` of [motion] belongs to kind = {FORWARD_RUNS:?}, and this is {:?}", kind.name());
        Some((RefusalKind::Rule, message))
    })?;
    let (mut feedback, mut controller) = (TorqueTexts::new(), None);
    let (record, maker) = match kind {
        MotionKind::Prescribed => prescribed::read(&table, robot, end)?,
        MotionKind::GripperPath => gripper_path::read(&table, robot, end)?,
        MotionKind::Forward => {
            let made;
            (made, feedback, controller) = forward::read(&table, robot, end)?;
            made
        }
    };
    let places = |key: &str| {
        let entries = field.node.get(key).and_then(|node| node.entries()).unwrap_or_default();
        entries.iter().map(|entry| (entry.key.clone(), entry.node.place.clone())).collect::<Vec<_>>()
    };
    let (joints, torques) = ([places("joints"), places("prescribed")].concat(), places("torque"));
    let (place, has_orientation) = (field.node.place.clone(), field.node.get("rpy").is_some());
    Ok(MotionPlan {
        kind,
        record,
        maker,
        place,
        joints,
        torques,
        has_orientation,
        feedback,
        controller,
        control: Control::default(),
    })
}

/// Where a table by joints says something of `joint`, or of the joint that has this coordinate.
fn said_of<'p>(places: &'p [(String, Place)], joint: &str) -> Option<&'p Place> {
    let of_all = |name: &str| joint.strip_prefix(name).is_some_and(|rest| rest.starts_with('.'));
    let own = places.iter().find(|(name, _)| name == joint);
    own.or_else(|| places.iter().find(|(name, _)| of_all(name))).map(|(_, place)| place)
}
