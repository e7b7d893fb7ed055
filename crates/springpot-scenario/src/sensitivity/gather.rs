//! What a parameter moves, before it is told to the engine.

use super::constants::Constants;
use super::extended::{Extended, Site, Virtual};
use crate::elements::plan::ShapePlan;
use crate::plan::Plan;
use crate::robot::described::EndStops;
use crate::text::document::Node;
use springpot::actuation::Drive;
use springpot::control::{ControllerNumber, FeedbackSlope};
use springpot::dual::Dual;
use springpot::law::leaf::EndStop;
use springpot::law::{Heat, Network};
use springpot::model::BodySpec;
use springpot::sensitivity::{Seed, Switched};
use springpot::signal::{MovedJump, Signal};
use springpot::spatial::{Inertia, Symmetric3, Vec3};
use springpot::system::{Motion, System};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Done, or why a number cannot be a parameter.
pub(super) type Moved = Result<(), String>;

/// By how much a number changes with a parameter.
#[derive(Debug, Clone)]
pub(crate) enum Slope {
    Number(f64),
    /// As a function of time, which jumps at times that move.
    Signal {
        by: Signal,
        jumps: Vec<MovedJump>,
    },
    /// As an expression of the state changes in which constants do so.
    Feedback(Constants),
}

/// Why feedback cannot stand where it does not act.
const OF_STATE: &str = "no derivative is known of what follows from the state";

impl Slope {
    pub(crate) fn number(self) -> Result<f64, String> {
        match self {
            Self::Number(by) => Ok(by),
            Self::Signal { .. } => Err("it is a function of time".to_owned()),
            Self::Feedback(_) => Err(OF_STATE.to_owned()),
        }
    }

    fn switching(self) -> Result<(Signal, Vec<MovedJump>), String> {
        match self {
            Self::Number(by) => Ok((Signal::constant(by), Vec::new())),
            Self::Signal { by, jumps } => Ok((by, jumps)),
            Self::Feedback(_) => Err(OF_STATE.to_owned()),
        }
    }

    /// Of a function of time whose jumps do not move.
    pub(super) fn signal(self) -> Result<Signal, String> {
        let (by, jumps) = self.switching()?;
        if jumps.is_empty() { Ok(by) } else { Err("it moves when a function of time jumps".to_owned()) }
    }
}

/// Where numbers stand.
pub(super) struct Scene<'a> {
    pub(super) plan: &'a Plan,
    pub(super) document: &'a Node,
    /// What is simulated.
    pub(super) system: &'a System,
}

impl Scene<'_> {
    /// What drives the joint of a velocity, where forces move the robot.
    pub(super) fn drive(&self, velocity: usize) -> Option<&Drive> {
        let Motion::Forward(forward) = &self.system.motion else { return None };
        let model = &self.system.model;
        let at = model.own_joints().position(|j| model.v_range(j).contains(&velocity))?;
        forward.drives.get(at)
    }

    /// Whether `[motion]` says under `key` how the joint of a velocity is led.
    pub(super) fn says(&self, key: &str, velocity: usize) -> bool {
        let model = &self.plan.model;
        let Some(j) = model.own_joints().find(|&j| model.v_range(j).contains(&velocity)) else { return false };
        let names = [&*model.joint_names()[j], &*model.described_joint(j).name];
        let said = self.document.get("motion").and_then(|motion| motion.get(key));
        let entries = said.and_then(|said| said.entries()).unwrap_or_default();
        let items = said.and_then(|said| said.items()).unwrap_or_default();
        entries
            .iter()
            .map(|entry| entry.key.as_str())
            .chain(items.iter().filter_map(|item| item.text()))
            .any(|said| names.contains(&said))
    }

    /// The first or the last point, or frame, of element `e`.
    pub(super) fn end(&self, e: usize, is_first: bool) -> Site {
        match &self.plan.elements[e].shape {
            ShapePlan::Points(points) => Site::Point(e, if is_first { 0 } else { points.len() - 1 }),
            _ => Site::Point(e, usize::from(!is_first)),
        }
    }

    /// How the first or the last frame of element `e` is turned.
    pub(super) fn rpy(&self, e: usize, is_first: bool) -> [f64; 3] {
        match &self.plan.elements[e].shape {
            ShapePlan::Bushing { from, to, .. } => {
                if is_first {
                    from.rpy
                } else {
                    to.rpy
                }
            }
            _ => [0.0; 3],
        }
    }
}

/// What changes of a body.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct BodySlope {
    pub(super) mass: f64,
    pub(super) com: [f64; 3],
    pub(super) inertia: [[f64; 3]; 3],
}

impl BodySlope {
    /// What changes of its inertia about the origin of its frame: m, m·c, J + m(c·c 1 − c cᵀ).
    fn of(&self, body: &BodySpec) -> Inertia {
        let (dc, c, m, dm) = (self.com, body.com, body.mass, self.mass);
        let central = Symmetric3::from_upper(self.inertia);
        let entry = |i: usize, j: usize| {
            let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let one = if i == j { 1.0 } else { 0.0 };
            dm * (dot(c, c) * one - c[i] * c[j]) + m * (2.0 * dot(c, dc) * one - dc[i] * c[j] - c[i] * dc[j])
        };
        let steiner = Symmetric3 {
            xx: entry(0, 0),
            yy: entry(1, 1),
            zz: entry(2, 2),
            xy: entry(0, 1),
            xz: entry(0, 2),
            yz: entry(1, 2),
        };
        let first_moment = std::array::from_fn(|i| dm * c[i] + m * dc[i]);
        Inertia { mass: dm, first_moment: Vec3(first_moment), rotational: central + steiner }
    }
}

/// What one parameter moves.
#[derive(Debug, Default)]
pub(super) struct Gather {
    pub(super) q: Vec<(usize, f64)>,
    pub(super) v: Vec<(usize, f64)>,
    /// By element, the slopes of its parameters.
    laws: BTreeMap<usize, Vec<f64>>,
    /// By joint, the slopes of stiffness, damping, lower and upper end of its stop.
    stops: BTreeMap<usize, [f64; 4]>,
    /// By element, the slopes of the numbers of its heat.
    heats: BTreeMap<usize, Heat>,
    pub(super) rest: Vec<(usize, f64)>,
    /// For how long elements were held before t = 0.
    pub(super) age: Vec<(usize, f64)>,
    inputs: Vec<(usize, usize, Signal)>,
    drives: Vec<(usize, Signal)>,
    switches: Vec<(Switched, MovedJump)>,
    /// Functions of events.
    pub(super) when: Vec<(usize, FeedbackSlope)>,
    when_of_time: Vec<(usize, Signal)>,
    /// Numbers of an event and of one of its settings.
    pub(super) set: Vec<(usize, usize, f64)>,
    /// Of feedback, by velocity, or by element and input.
    pub(super) torques: Vec<(usize, FeedbackSlope)>,
    pub(super) fed_back: Vec<(usize, usize, FeedbackSlope)>,
    /// Of the controller: its numbers, where its reference wants velocities and the gripper, largest forces and how fast they change.
    pub(super) controller: Vec<(ControllerNumber, f64)>,
    pub(super) reference: Vec<(usize, Signal)>,
    pub(super) point: Vec<(usize, Signal)>,
    pub(super) limits: Vec<(usize, f64)>,
    pub(super) rate_limits: Vec<(usize, f64)>,
    pub(super) damping: Vec<(usize, f64)>,
    pub(super) friction: Vec<(usize, f64)>,
    pub(super) armature: Vec<(usize, f64)>,
    bodies: BTreeMap<usize, BodySlope>,
    pub(super) gravity: [f64; 3],
    pub(super) moves_gravity: bool,
    places: Vec<(Virtual, f64)>,
}

impl Gather {
    pub(super) fn law(&mut self, e: usize, count: usize) -> &mut Vec<f64> {
        self.laws.entry(e).or_insert_with(|| vec![0.0; count])
    }

    pub(super) fn stop(&mut self, joint: usize) -> &mut [f64; 4] {
        self.stops.entry(joint).or_default()
    }

    /// The slopes of what temperature does to an element, where it does anything.
    pub(super) fn heat(&mut self, e: usize, plan: &Plan) -> Option<&mut Heat> {
        let own = &plan.elements[e];
        let still = own.element.law.as_heated()?.heat().still();
        // The law is built anew with them.
        self.law(e, own.parameters.len());
        Some(self.heats.entry(e).or_insert(still))
    }

    pub(super) fn body(&mut self, body: usize) -> &mut BodySlope {
        self.bodies.entry(body).or_default()
    }

    /// Moves input `input` of element `element`.
    pub(super) fn input(&mut self, element: usize, input: usize, slope: Slope) -> Moved {
        let (by, jumps) = slope.switching()?;
        self.inputs.push((element, input, by));
        self.switch(Switched::Input { element, input }, jumps);
        Ok(())
    }

    /// Moves the actuator force on a velocity.
    pub(super) fn drive(&mut self, velocity: usize, slope: Slope) -> Moved {
        let (by, jumps) = slope.switching()?;
        self.drives.push((velocity, by));
        self.switch(Switched::Drive(velocity), jumps);
        Ok(())
    }

    /// Moves the function of an event that hangs on t alone.
    pub(super) fn when_of_time(&mut self, event: usize, slope: Slope) -> Moved {
        self.when_of_time.push((event, slope.signal()?));
        Ok(())
    }

    fn switch(&mut self, of: Switched, jumps: Vec<MovedJump>) {
        self.switches.extend(jumps.into_iter().map(|jump| (of, jump)));
    }

    /// Shifts what stands at `site` along `axis`.
    pub(super) fn shift(&mut self, site: Site, axis: [f64; 3], by: f64) {
        self.places.push((Virtual { site, turns: false, axis }, by));
    }

    /// Turns what stands at `site` about `axis`.
    pub(super) fn turn(&mut self, site: Site, axis: [f64; 3], by: f64) {
        self.places.push((Virtual { site, turns: true, axis }, by));
    }

    /// The joints that it moves beyond those of the robot.
    pub(super) fn virtuals(&self) -> impl Iterator<Item = &Virtual> {
        self.places.iter().map(|(joint, _)| joint)
    }

    /// Whether it moves what a path of the gripper is solved with: where the robot starts, or how it is built.
    pub(super) fn moves_paths(&self) -> bool {
        let moves = |(joint, _): &(Virtual, f64)| !matches!(joint.site, Site::Point(..));
        !self.q.is_empty() || self.places.iter().any(moves)
    }

    /// What the engine takes, of a robot that was extended by the joints of all parameters.
    pub(super) fn seeds(self, plan: &Plan, extended: &Extended) -> Vec<Seed> {
        let model = extended.model();
        let joint_name = |j: usize| &*plan.model.joint_names()[j];
        let joint = |j: usize| model.joint_index(joint_name(j)).expect("a joint of the robot");
        let mut seeds = Vec::new();
        // What the robot's coordinates at t = 0 change by.
        let mut start = vec![0.0; model.nv()];
        for &(velocity, by) in &self.q {
            start[extended.own(velocity)] += by;
            seeds.push(Seed::Position { velocity, by });
        }
        seeds.extend(self.v.iter().map(|&(velocity, by)| Seed::Velocity { velocity, by }));
        for (virtual_joint, by) in &self.places {
            let velocity = extended.velocity(virtual_joint);
            start[velocity] += by;
            seeds.push(Seed::Place { velocity, by: *by });
        }
        for (element, slopes) in self.laws {
            let planned = &plan.elements[element];
            let numbers: Vec<Dual> =
                planned.parameters.iter().zip(slopes).map(|(&value, slope)| Dual { value, slope }).collect();
            if let Ok(law) = (planned.element.entry.build)(&numbers, planned.element.derivative) {
                let law = match self.heats.get(&element) {
                    Some(moved) => law.with_moving_heat(*moved),
                    None => law,
                };
                seeds.push(Seed::Law { element, law });
            }
        }
        for (joint, slopes) in self.stops {
            let limits = plan.model.limits(joint);
            let stop = plan.end_stops.and_then(|EndStops { stiffness, damping }| {
                let values = [stiffness, damping, limits.lower, limits.upper];
                let [k, d, lower, upper] = std::array::from_fn(|i| Dual { value: values[i], slope: slopes[i] });
                let element = extended.system.end_stop(joint_name(joint))?;
                Some((element, EndStop::new(k, d, lower, upper).ok()?))
            });
            seeds.extend(stop.map(|(element, stop)| Seed::Law { element, law: Network::leaf(stop) }));
        }
        seeds.extend(self.rest.iter().map(|&(element, by)| Seed::Rest { element, by }));
        seeds.extend(self.age.iter().map(|&(element, by)| Seed::Age { element, by }));
        let rests = plan.elements.iter().enumerate().filter(|(_, element)| element.rest_at_start);
        for (element, _) in rests.filter(|_| start.iter().any(|by| *by != 0.0)) {
            let by = extended.gradient(element).iter().zip(&start).map(|(g, by)| g * by).sum();
            seeds.push(Seed::Rest { element, by });
        }
        seeds.extend(self.inputs.into_iter().map(|(element, input, by)| Seed::Input { element, input, by }));
        seeds.extend(self.drives.into_iter().map(|(velocity, by)| Seed::Drive { velocity, by }));
        seeds.extend(self.switches.into_iter().map(|(of, jump)| {
            let [argument, by] = [jump.argument, jump.slope].map(Signal::expression);
            Seed::Switch { of, argument, by }
        }));
        seeds.extend(self.when.into_iter().map(|(event, by)| Seed::When { event, by }));
        seeds.extend(self.when_of_time.into_iter().map(|(event, by)| Seed::WhenOfTime { event, by }));
        seeds.extend(self.set.iter().map(|&(event, setting, by)| Seed::Set { event, setting, by }));
        seeds.extend(self.torques.into_iter().map(|(velocity, by)| Seed::TorqueFeedback { velocity, by }));
        let fed_back = self.fed_back.into_iter();
        seeds.extend(fed_back.map(|(element, input, by)| Seed::InputFeedback { element, input, by }));
        seeds.extend(self.controller.into_iter().map(|(number, by)| Seed::Controller { number, by }));
        seeds.extend(self.reference.into_iter().map(|(velocity, by)| Seed::Reference { velocity, by }));
        seeds.extend(self.point.into_iter().map(|(axis, by)| Seed::ReferencePoint { axis, by }));
        seeds.extend(self.limits.iter().map(|&(velocity, by)| Seed::Limit { velocity, by }));
        seeds.extend(self.rate_limits.iter().map(|&(velocity, by)| Seed::RateLimit { velocity, by }));
        seeds.extend(self.damping.iter().map(|&(j, by)| Seed::Damping { joint: joint(j), by }));
        seeds.extend(self.friction.iter().map(|&(j, by)| Seed::Friction { joint: joint(j), by }));
        if !self.bodies.is_empty() || !self.armature.is_empty() {
            let mut bodies = vec![Inertia::ZERO; model.body_names().len()];
            for (body, slope) in &self.bodies {
                bodies[extended.body(*body)] = slope.of(&plan.bodies[*body]);
            }
            let mut armature = vec![0.0; model.joint_count()];
            self.armature.iter().for_each(|&(j, by)| armature[joint(j)] += by);
            seeds.push(Seed::Inertia(Arc::new(model.with_inertias(&bodies, &armature))));
        }
        if self.moves_gravity {
            seeds.push(Seed::Gravity(Arc::new(model.with_gravity(self.gravity))));
        }
        seeds
    }
}
