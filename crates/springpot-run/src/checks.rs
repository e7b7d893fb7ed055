//! What a scenario may say and hardly mean: points far from the robot, elements that no joint stretches, numbers beyond all materials.

use crate::numbers::short;
use springpot::dynamics::Kinematics;
use springpot::model::{Anchor, Dimension, Parent};
use springpot::system::System;
use springpot_scenario::{Plan, Remark, ShapePlan};

/// An anchor farther from the robot than so many times its size is hardly meant.
const FAR: f64 = 10.0;
/// A body longer than so many times the others' median is hardly meant.
const LONG: f64 = 30.0;
/// No material has a parameter beyond this, SI.
const BEYOND: f64 = 1e30;
/// A gradient below this share of the lengths at hand is 0.
const ROUNDING: f64 = 1e-12;
/// Times, or configurations where the motion is not known yet, in which gradients are looked at.
const LOOKED_AT: u32 = 65;
/// How far apart such configurations are, rad and m.
const APART: [f64; 2] = [0.7, 0.13];

/// Anchors far from the robot where it starts, and parameters beyond all sense.
pub(crate) fn sizes(plan: &Plan, system: &System) -> Vec<Remark> {
    let far = far_anchors(plan, system).unwrap_or_default();
    let beyond = plan.elements.iter().flat_map(|element| {
        let named = element.element.entry.params.iter().zip(&element.parameters);
        named.filter(|(_, value)| value.abs() > BEYOND).map(|(param, value)| {
            let unit = if param.unit.is_empty() { String::new() } else { format!(" {}", param.unit) };
            let message = format!("element \"{}\": {} is {}{unit}", element.element.name, param.name, short(*value));
            Remark::at(&element.place, message)
                .help("no material has so much, and forces and energies leave the range of numbers")
        })
    });
    far.into_iter().chain(beyond).chain(long_members(plan)).collect()
}

/// Bodies that are much larger than the others, as where one is written in mm.
fn long_members(plan: &Plan) -> Vec<Remark> {
    let length = |vector: [f64; 3]| vector.iter().map(|x| x * x).sum::<f64>().sqrt();
    let sizes: Vec<f64> = plan.bodies.iter().map(|body| length(body.com).max(length(body.joint.origin))).collect();
    let mut remarks = Vec::new();
    for (k, (body, places)) in plan.bodies.iter().zip(&plan.body_places).enumerate() {
        let mut others: Vec<f64> = sizes.iter().enumerate().filter(|(j, _)| *j != k).map(|(_, size)| *size).collect();
        others.retain(|size| *size > 0.0);
        others.sort_by(f64::total_cmp);
        let Some(median) = others.get(others.len() / 2) else { continue };
        for (key, said, vector) in [("com", "centre of mass", body.com), ("joint.origin", "joint", body.joint.origin)] {
            // A file of a robot is not written by hand.
            let Some((_, place)) = places.fields.iter().find(|(field, _)| field == key) else { continue };
            if length(vector) > LONG * median {
                let message = format!(
                    "body \"{}\": its {said} is {} m away, where other bodies are {} m long",
                    body.name,
                    two_digits(length(vector)),
                    two_digits(*median)
                );
                remarks.push(Remark::at(place, message).help("plain numbers are metres: \"200 mm\" or 0.2"));
            }
        }
    }
    remarks
}

/// The smallest box that holds points.
struct Extent {
    low: [f64; 3],
    high: [f64; 3],
}

impl Extent {
    fn of(points: impl IntoIterator<Item = [f64; 3]>) -> Option<Self> {
        let mut points = points.into_iter();
        let first = points.next()?;
        let mut extent = Self { low: first, high: first };
        for point in points {
            for k in 0..3 {
                extent.low[k] = extent.low[k].min(point[k]);
                extent.high[k] = extent.high[k].max(point[k]);
            }
        }
        Some(extent)
    }

    fn diagonal(&self) -> f64 {
        (0..3).map(|k| (self.high[k] - self.low[k]).powi(2)).sum::<f64>().sqrt()
    }

    /// How far outside a point lies.
    fn distance(&self, point: [f64; 3]) -> f64 {
        (0..3).map(|k| (self.low[k] - point[k]).max(point[k] - self.high[k]).max(0.0).powi(2)).sum::<f64>().sqrt()
    }
}

/// The points of elements that lie far outside the robot: outside the box of its joints, centres of mass and gripper, by many times its diagonal.
/// A single body that only slides has no size.
fn far_anchors(plan: &Plan, system: &System) -> Option<Vec<Remark>> {
    if !plan.elements.iter().any(|element| matches!(element.shape, ShapePlan::Points(_) | ShapePlan::Bushing { .. })) {
        return None;
    }
    let pose = system.pose(0.0).ok()?;
    let model = &plan.model;
    let turns = (0..model.joint_count()).any(|j| model.joint_space(j).dimension() == Some(Dimension::Angle));
    let points = plan.bodies.iter().enumerate().flat_map(|(index, body)| {
        let body_is = Parent::Body(index);
        let com = (body.mass > 0.0).then(|| pose.point(&Anchor { body: body_is, point: body.com }));
        com.into_iter().chain([pose.origin(body_is)])
    });
    let gripper = plan.gripper.as_ref().map(|gripper| pose.point(&gripper.anchor));
    let robot = Extent::of(points.chain(gripper))?;
    let size = robot.diagonal();
    if size == 0.0 || !size.is_finite() || !(turns || plan.bodies.len() > 1) {
        return None;
    }
    let mut remarks = Vec::new();
    for element in &plan.elements {
        let anchors: Vec<&Anchor> = match &element.shape {
            ShapePlan::Points(points) => points.iter().collect(),
            ShapePlan::Bushing { from, to, .. } => vec![&from.anchor, &to.anchor],
            ShapePlan::Joint(_) => continue,
        };
        for (anchor, place) in anchors.into_iter().zip(&element.ends) {
            let distance = robot.distance(pose.point(anchor));
            if distance > FAR * size {
                let message = format!(
                    "element \"{}\": a point of it is {} m away from a robot that is {} m across",
                    element.element.name,
                    two_digits(distance),
                    two_digits(size)
                );
                remarks.push(Remark::at(place, message).help("plain numbers are metres: \"300 mm\" or 0.3"));
            }
        }
    }
    Some(remarks)
}

/// Elements whose coordinate no joint changes: ∂y/∂q is 0 at all times that are looked at, or, where the motion follows from forces, in all
/// configurations.
pub(crate) fn elements(plan: &Plan, system: &System) -> Vec<Remark> {
    let model = &system.model;
    let mut is_moved = vec![false; plan.elements.len()];
    for k in 0..LOOKED_AT {
        let t = plan.settings.end * f64::from(k) / f64::from(LOOKED_AT - 1);
        let Ok(mut state) = system.state(if plan.motion.is_forward() { 0.0 } else { t }) else { return Vec::new() };
        if plan.motion.is_forward() {
            let own = model.own_joints().filter_map(|j| Some((j, model.joint_space(j).dimension()?)));
            for (joint, (j, dimension)) in own.enumerate() {
                let slides = dimension == Dimension::Length;
                // Golden angles: no two joints keep step.
                let turn = (f64::from(k) * 0.618_034 * (joint + 1) as f64).sin();
                state.q[model.q_range(j).start] += APART[usize::from(slides)] * turn;
            }
        }
        let kinematics = Kinematics::at_velocity(model, &state.q, &state.v);
        for (moved, element) in is_moved.iter_mut().zip(&system.elements) {
            let (reading, gradient) = element.measure.read(model, &kinematics);
            let scale = 1.0 + reading.coordinate.abs();
            // NaN, where points meet, is no rest.
            *moved |= gradient.iter().any(|slope| slope.is_nan() || slope.abs() > ROUNDING * scale);
        }
        if is_moved.iter().all(|moved| *moved) {
            return Vec::new();
        }
    }
    let still = plan.elements.iter().zip(is_moved).filter(|(_, moved)| !moved);
    let remark = |(element, _): (&springpot_scenario::ElementPlan, bool)| {
        let name = &element.element.name;
        let message = format!("no joint stretches element \"{name}\": dl/dq is 0 all along, and so is its Q");
        let place = element.ends.last().unwrap_or(&element.place);
        Remark::at(place, message).help("look at its points: do they lie on the axis of the joint between them?")
    };
    still.map(remark).collect()
}

/// A length for a message.
fn two_digits(length: f64) -> String {
    short(format!("{length:.1e}").parse().unwrap_or(length))
}
