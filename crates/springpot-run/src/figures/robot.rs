//! The robot at t = 0 as a mechanism sketch.

use super::source::Source;
use crate::panels::millimetres;
use crate::scene::{ground, sign_of};
use springpot::equations::Pose;
use springpot::model::{Anchor, JointKind, JointPart, Move, Parent};
use springpot::system::System;
use springpot_report::vector::{distance, nearest};
use springpot_report::{Drawn, ElementMark, ElementShape, JointMark, Link, RobotDrawing, WORLD};
use springpot_scenario::{FigurePlan, Plan, ShapePlan};

/// Most links of a sketch.
const MOST_LINKS: usize = 1_000;

/// What is this near to a line of the sketch, as a share of the robot's size, is on it.
const ON_LINE: f64 = 0.04;

pub(super) fn draw(source: &Source<'_>) -> Result<Drawn, String> {
    drawing(source.figure, source.system, source.plan)?.draw().map_err(|error| error.to_string())
}

/// The robot at t = 0 with its joints, elements and gripper.
fn drawing(figure: &FigurePlan, system: &System, plan: &Plan) -> Result<RobotDrawing, String> {
    let pose = system.pose(0.0).map_err(|error| error.to_string())?;
    let skeleton = Skeleton::of(plan, &pose)?;
    let mut drawing = RobotDrawing {
        title: figure.title.clone(),
        view: figure.look.view,
        hides_names: figure.look.hides_names,
        size: figure.look.size.map(millimetres),
        ..RobotDrawing::default()
    };
    let near = ON_LINE * skeleton.size();
    for (bone, name) in skeleton.bones.iter().zip(&skeleton.names) {
        drawing.links.push(Link { name: (*name).to_owned(), points: bone.line(near) });
    }
    for index in 0..plan.bodies.len() {
        for (part, position, axis) in parts(plan, &pose, index) {
            let kind = match part.moves {
                Move::Turn | Move::Screw => springpot_report::JointKind::Revolute,
                Move::Shift => springpot_report::JointKind::Prismatic,
                Move::Ball => springpot_report::JointKind::Spherical,
                Move::Pose => continue,
            };
            let axis = if part.moves == Move::Ball { [0.0; 3] } else { axis };
            drawing.joints.push(JointMark { name: part.name, position, axis, kind });
        }
    }
    let bracket = |drawing: &mut RobotDrawing, anchor: &Anchor| {
        let link = match anchor.body {
            Parent::World => WORLD,
            Parent::Body(index) => skeleton.bone_of[index].map_or(WORLD, |bone| skeleton.names[bone]),
        };
        drawing.bracket(link, pose.point(anchor));
    };
    for element in &plan.elements {
        let (name, sign) = (element.element.name.clone(), sign_of(&element.element));
        match &element.shape {
            ShapePlan::Points(points) => {
                let at: Vec<[f64; 3]> = points.iter().map(|point| pose.point(point)).collect();
                let [from, via @ .., to] = &at[..] else { continue };
                let shape = if via.is_empty() { ElementShape::Line } else { ElementShape::Cable(via.to_vec()) };
                drawing.elements.push(ElementMark { name, from: *from, to: *to, sign, shape });
                points.iter().for_each(|point| bracket(&mut drawing, point));
            }
            ShapePlan::Joint(joint) => {
                let mut parts = (0..plan.bodies.len()).flat_map(|body| parts(plan, &pose, body));
                let Some((_, at, axis)) = parts.find(|(part, ..)| part.name == *joint) else { continue };
                let shape = match element.element.measure.is_rotation() {
                    true => ElementShape::Turn,
                    false => ElementShape::Slide(axis),
                };
                drawing.elements.push(ElementMark { name, from: at, to: at, sign, shape });
            }
            ShapePlan::Bushing { from, to, component } => {
                // One ring for all components.
                let name = name.strip_suffix(component.name()).and_then(|name| name.strip_suffix('.'));
                let name = name.unwrap_or_default().to_owned();
                if drawing.elements.iter().any(|drawn| drawn.name == name) {
                    continue;
                }
                let [first, second] = [from, to].map(|frame| pose.point(&frame.anchor));
                let shape = ElementShape::Bushing;
                drawing.elements.push(ElementMark { name, from: first, to: second, sign, shape });
                [from, to].iter().for_each(|frame| bracket(&mut drawing, &frame.anchor));
            }
        }
    }
    drawing.gripper = plan.gripper.as_ref().map(|gripper| pose.point(&gripper.anchor));
    drawing.ground = ground(plan, &pose);
    Ok(drawing)
}

/// What the joint of a body is made of, where each part is, and its axis in the world.
fn parts(plan: &Plan, pose: &Pose<'_>, body: usize) -> Vec<(JointPart, [f64; 3], [f64; 3])> {
    let spec = &plan.bodies[body].joint;
    let (frame, parts) = (Parent::Body(body), spec.parts());
    let Some(first) = plan.model.described_joints().iter().find(|joint| joint.name == spec.name) else {
        return Vec::new();
    };
    let is_only = parts.len() == 1;
    let placed = parts.into_iter().zip(first.joints.clone()).map(|(part, joint)| {
        // The axis of a chain is that of the link that it moves.
        let axis = if is_only { pose.direction(frame, spec.axis) } else { pose.joint_axis(joint) };
        (part, pose.origin(frame), axis)
    });
    placed.collect()
}

/// The centre lines of a robot. Links of a URDF that are fixed to others are frames of those and have no line.
struct Skeleton<'a> {
    bones: Vec<Bone>,
    names: Vec<&'a str>,
    /// By body: the bone that it is, or is a frame of; `None` where that is the world.
    bone_of: Vec<Option<usize>>,
}

/// The centre line of one body: from its origin to every joint that it carries.
struct Bone {
    origin: [f64; 3],
    ends: Vec<[f64; 3]>,
}

impl<'a> Skeleton<'a> {
    fn of(plan: &'a Plan, pose: &Pose<'_>) -> Result<Self, String> {
        let mut skeleton =
            Self { bones: Vec::new(), names: Vec::new(), bone_of: Vec::with_capacity(plan.bodies.len()) };
        let root = plan.urdf.as_ref().map(|urdf| &urdf.robot).filter(|robot| !robot.floating_base);
        if let Some(robot) = root {
            // The name of the ground would draw it as ground.
            skeleton.add([0.0; 3], if robot.root.name == WORLD { "" } else { &robot.root.name });
        }
        let root = root.map(|_| 0);
        // By bone: what ends it where it carries no joint.
        let mut frames: Vec<Vec<[f64; 3]>> = vec![Vec::new(); skeleton.bones.len()];
        for (index, body) in plan.bodies.iter().enumerate() {
            let holder = match body.parent {
                Parent::World => root,
                Parent::Body(parent) => skeleton.bone_of[parent],
            };
            let origin = pose.origin(Parent::Body(index));
            let is_frame = plan.urdf.is_some() && body.joint.kind == JointKind::Fixed;
            if is_frame {
                skeleton.bone_of.push(holder);
                holder.into_iter().for_each(|bone| frames[bone].push(origin));
                continue;
            }
            holder.into_iter().for_each(|bone| skeleton.bones[bone].ends.push(origin));
            skeleton.bone_of.push(Some(skeleton.bones.len()));
            skeleton.add(origin, &body.name);
            frames.push(vec![pose.point(&Anchor { body: Parent::Body(index), point: body.com })]);
        }
        if skeleton.bones.len() > MOST_LINKS {
            return Err(format!("the robot has {} links (at most {MOST_LINKS} are drawn)", skeleton.bones.len()));
        }
        if let Some(gripper) = &plan.gripper
            && let Parent::Body(body) = gripper.anchor.body
            && let Some(bone) = skeleton.bone_of[body]
        {
            skeleton.bones[bone].ends.push(pose.point(&gripper.anchor));
        }
        for (bone, frames) in skeleton.bones.iter_mut().zip(frames) {
            // A body that carries nothing reaches to its farthest frame, or to its centre of mass.
            if bone.ends.is_empty() {
                let farther = |a: [f64; 3], b: [f64; 3]| {
                    if distance(b, bone.origin) > distance(a, bone.origin) { b } else { a }
                };
                bone.ends.extend(frames.into_iter().reduce(farther));
            }
        }
        Ok(skeleton)
    }

    /// Largest extent along an axis of the world, m.
    fn size(&self) -> f64 {
        let extent = |axis: usize| {
            let points = self.bones.iter().flat_map(|bone| bone.ends.iter().chain([&bone.origin]));
            let (low, high) = points.fold((f64::MAX, f64::MIN), |(low, high), p| (low.min(p[axis]), high.max(p[axis])));
            high - low
        };
        (0..3).map(extent).fold(0.0, f64::max)
    }

    fn add(&mut self, origin: [f64; 3], name: &'a str) {
        self.bones.push(Bone { origin, ends: Vec::new() });
        self.names.push(name);
    }
}

impl Bone {
    /// One line there and back again through all ends, the farthest first; ends nearer to it than `near` are left out.
    fn line(&self, near: f64) -> Vec<[f64; 3]> {
        let mut ends = self.ends.clone();
        ends.sort_by(|a, b| distance(*b, self.origin).total_cmp(&distance(*a, self.origin)));
        let mut line = vec![self.origin];
        for end in ends {
            let on_line = line.chunks(2).any(|piece| match piece {
                [_, _] => distance(nearest(piece, end), end) <= near,
                _ => end == self.origin,
            });
            if !on_line {
                if line.len() > 1 {
                    line.push(self.origin);
                }
                line.push(end);
            }
        }
        line
    }
}
