//! From a plan to what the time loop runs.

use super::plan::{DrivePlan, JointPlan, MotionPlan, Plan, SignalPlan};
use springpot::actuation::{Drive, Forward};
use springpot::integrate::{Motion, Stop, System};
use springpot::model::{Anchor, Site};
use springpot::motion::gripper_path::{Course, Task};
use springpot::motion::{GripperPath, JointPath, PosePath, Trajectory};
use springpot::observe::Observables;
use springpot::signal::Signal;

impl Plan {
    /// The robot, its elements and its motion. A gripper path is solved here, as far as it can be followed.
    pub fn system(&self) -> System {
        self.system_unless(&Stop::new(false))
    }

    /// [`Self::system`], but a gripper path is followed until `stop` is set: it then ends there.
    pub fn system_unless(&self, stop: &Stop) -> System {
        System {
            elements: self.elements.iter().map(|plan| plan.element.clone()).collect(),
            motion: self.solved_motion(stop),
            gripper: self.gripper.as_ref().map(|gripper| self.site(&gripper.anchor)),
            model: self.model.clone(),
            tells_joint_losses: self.tells_joint_losses,
        }
    }

    /// What can be observed of the system, but for the energy lost in joints.
    pub(crate) fn observables(&self) -> Observables {
        let observables = Observables::new(&self.model, self.elements.iter().map(|plan| &plan.element));
        match self.gripper {
            Some(_) => observables.with_gripper(matches!(self.motion, MotionPlan::GripperPath { .. })),
            None => observables,
        }
    }

    fn solved_motion(&self, stop: &Stop) -> Motion {
        match &self.motion {
            MotionPlan::Prescribed { joints } => Trajectory::Prescribed(joints.iter().map(path).collect()).into(),
            MotionPlan::GripperPath { position, rpy, guess, .. } => {
                let gripper = self.gripper.as_ref().expect("a gripper path was read with its gripper");
                let task = Task {
                    site: self.site(&gripper.anchor),
                    frame: self.model.frame(gripper.anchor.body).expect("a body that was read"),
                    position: position.each_ref().map(signal),
                    rpy: rpy.as_ref().map(|rpy| rpy.each_ref().map(signal)),
                };
                let course = Course { end: self.settings.end, max_step: self.settings.max_step, stop };
                let path = GripperPath::new(&self.model, task, guess, &course);
                Trajectory::GripperPath(Box::new(path)).into()
            }
            MotionPlan::Forward(plan) => {
                let drives = plan.drives.iter().map(drive).collect();
                Forward { q: plan.q.clone(), v: plan.v.clone(), drives }.into()
            }
        }
    }

    fn site(&self, anchor: &Anchor) -> Site {
        self.model.resolve(anchor).expect("an anchor that was read")
    }
}

fn drive(plan: &DrivePlan) -> Drive {
    match plan {
        DrivePlan::Force(signals) => Drive::Force(signals.iter().map(signal).collect()),
        DrivePlan::Prescribed(joint) => Drive::Prescribed(path(joint)),
        DrivePlan::Locked => Drive::Locked,
    }
}

fn path(plan: &JointPlan) -> JointPath {
    match plan {
        JointPlan::Coordinate(coordinate) => JointPath::Coordinate(signal(coordinate)),
        JointPlan::Pose(pose) => JointPath::Pose(Box::new(PosePath {
            position: pose.position.each_ref().map(signal),
            rpy: pose.rpy.each_ref().map(signal),
        })),
    }
}

fn signal(plan: &SignalPlan) -> Signal {
    plan.signal.clone()
}
