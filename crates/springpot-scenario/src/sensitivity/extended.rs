//! The robot with locked joints for what parameters move of its geometry.

use crate::elements::plan::ShapePlan;
use crate::plan::Plan;
use springpot::actuation::{Drive, Forward};
use springpot::dynamics::Kinematics;
use springpot::model::{Anchor, BodySpec, JointSpec, Model, ModelBuilder, ModelError, Parent};
use springpot::motion::{JointPath, Trajectory};
use springpot::signal::Signal;
use springpot::spatial::{Rotation, Vec3};
use springpot::system::{Motion, System};
use std::sync::Arc;

/// What is moved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Site {
    /// The joint of a body, with all behind it.
    Joint(usize),
    /// All behind the joint of a body, the body included.
    Behind(usize),
    /// A point of an element, or one of the two frames of a bushing.
    Point(usize, usize),
    Gripper,
}

/// A joint, locked at 0, that moves something: its axis is in the axes that a pose stands in, those of the joint itself behind it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Virtual {
    pub(super) site: Site,
    pub(super) turns: bool,
    pub(super) axis: [f64; 3],
}

/// The system of a plan with such joints.
pub(super) struct Extended {
    virtuals: Vec<Virtual>,
    /// Where each of them stands among the velocities.
    velocities: Vec<usize>,
    /// Of every body, and of every velocity of the robot, which of the extended one it is.
    bodies: Vec<usize>,
    own: Vec<usize>,
    pub(super) system: Arc<System>,
}

/// `axis` in the axes that a frame is turned against.
pub(super) fn rotated(rpy: [f64; 3], axis: [f64; 3]) -> [f64; 3] {
    (Rotation::from_rpy(rpy) * Vec3(axis)).0
}

/// Puts bodies together.
struct Bodies {
    virtuals: Vec<Virtual>,
    specs: Vec<BodySpec>,
}

impl Bodies {
    /// What the joint of virtual `k` is called.
    fn name(k: usize) -> String {
        format!("\u{2202}{k}")
    }

    /// Adds the joints of `site` between `parent` and what stands there at `origin`; the body that carries it, and where it stands there.
    fn chain(&mut self, site: Site, mut parent: Parent, mut origin: [f64; 3]) -> (Parent, [f64; 3]) {
        for k in 0..self.virtuals.len() {
            let Virtual { site: own, turns, axis } = self.virtuals[k];
            if own == site {
                let make = if turns { JointSpec::revolute } else { JointSpec::prismatic };
                parent = self.push(Self::name(k), parent, make(Self::name(k), axis, origin));
                origin = [0.0; 3];
            }
        }
        (parent, origin)
    }

    /// Adds a body without mass.
    fn push(&mut self, name: String, parent: Parent, joint: JointSpec) -> Parent {
        self.specs.push(BodySpec { name, parent, joint, mass: 0.0, com: [0.0; 3], inertia: [[0.0; 3]; 3] });
        Parent::Body(self.specs.len() - 1)
    }
}

impl Extended {
    /// The system of a plan, extended by `virtuals`.
    ///
    /// # Errors
    /// A motion that is solved for a path of the gripper; a robot that cannot be built so.
    pub(super) fn new(plan: &Plan, base: &System, virtuals: Vec<Virtual>) -> Result<Self, String> {
        if virtuals.is_empty() {
            let (bodies, own) = ((0..plan.bodies.len()).collect(), (0..plan.model.nv()).collect());
            return Ok(Self { virtuals, velocities: Vec::new(), bodies, own, system: Arc::new(base.clone()) });
        }
        let is_solved = |path: &Trajectory| !matches!(path, Trajectory::Prescribed(_));
        if matches!(&base.motion, Motion::Given(path) if is_solved(path)) {
            return Err("no derivative by geometry is known of joints that follow a path of the gripper".to_owned());
        }
        let mut made = Bodies { virtuals, specs: Vec::new() };
        let mut bodies = Vec::with_capacity(plan.bodies.len());
        let moved = |bodies: &[usize], parent: Parent| match parent {
            Parent::World => Parent::World,
            Parent::Body(body) => Parent::Body(bodies[body]),
        };
        for (b, spec) in plan.bodies.iter().enumerate() {
            let (parent, origin) = made.chain(Site::Joint(b), moved(&bodies, spec.parent), spec.joint.origin);
            let joint = JointSpec { origin, ..spec.joint.clone() };
            let behind: Vec<usize> =
                (0..made.virtuals.len()).filter(|&k| made.virtuals[k].site == Site::Behind(b)).collect();
            let (mut parent, mut joint) = (parent, joint);
            for k in behind {
                parent = made.push(format!("{} before {}", Bodies::name(k), spec.name), parent, joint);
                joint = JointSpec::revolute(Bodies::name(k), made.virtuals[k].axis, [0.0; 3]);
            }
            made.specs.push(BodySpec { parent, joint, ..spec.clone() });
            bodies.push(made.specs.len() - 1);
        }
        let mut anchors: Vec<Vec<Anchor>> = Vec::new();
        let anchor = |made: &mut Bodies, site: Site, anchor: &Anchor| {
            let (body, point) = made.chain(site, moved(&bodies, anchor.body), anchor.point);
            Anchor { body, point }
        };
        for (e, element) in plan.elements.iter().enumerate() {
            let points: Vec<&Anchor> = match &element.shape {
                ShapePlan::Points(points) => points.iter().collect(),
                ShapePlan::Bushing { from, to, .. } => vec![&from.anchor, &to.anchor],
                ShapePlan::Joint(_) => Vec::new(),
            };
            let points = points.into_iter().enumerate();
            anchors.push(points.map(|(k, point)| anchor(&mut made, Site::Point(e, k), point)).collect());
        }
        let gripper = plan.gripper.as_ref().map(|gripper| anchor(&mut made, Site::Gripper, &gripper.anchor));
        let model = Arc::new(build(plan, &made.specs).map_err(|error| error.to_string())?);
        let shapes = plan.elements.iter().zip(anchors).map(|(element, anchors)| element.shape.with_anchors(&anchors));
        let measures = shapes.map(|shape| shape.measure(&model)).collect::<Option<Vec<_>>>();
        let elements = plan.elements.iter().zip(measures.ok_or("an element cannot be measured")?);
        let elements = elements.map(|(plan, measure)| springpot::elements::Element { measure, ..plan.element.clone() });
        let system = System {
            elements: elements.collect(),
            motion: extended_motion(&base.motion, &plan.model, &model),
            gripper: gripper.map(|anchor| model.resolve(&anchor)).transpose().map_err(|error| error.to_string())?,
            model: model.clone(),
            sensitivity: None,
            ..base.clone()
        };
        let system = plan.with_end_stops(system);
        let velocity = |name: &str| model.joint_index(name).map(|joint| model.v_range(joint));
        let velocities = (0..made.virtuals.len()).filter_map(|k| velocity(&Bodies::name(k))).map(|range| range.start);
        let velocities = velocities.collect();
        let names = plan.model.own_joints().map(|j| plan.model.joint_names()[j].as_str());
        let own = names.filter_map(velocity).flatten().collect();
        Ok(Self { virtuals: made.virtuals, velocities, bodies, own, system: Arc::new(system) })
    }

    /// Whether anything was added.
    pub(super) fn is_extended(&self) -> bool {
        !self.virtuals.is_empty()
    }

    pub(super) fn model(&self) -> &Model {
        &self.system.model
    }

    /// Which body of the robot a body of the plan is.
    pub(super) fn body(&self, body: usize) -> usize {
        self.bodies[body]
    }

    /// Which velocity a velocity of the run is.
    pub(super) fn own(&self, velocity: usize) -> usize {
        self.own[velocity]
    }

    /// The velocity of a joint that was added.
    pub(super) fn velocity(&self, joint: &Virtual) -> usize {
        let at = self.virtuals.iter().position(|own| own == joint).expect("a joint that was added");
        self.velocities[at]
    }

    /// ∂y/∂q of element `e` where the run starts.
    pub(super) fn gradient(&self, e: usize) -> Vec<f64> {
        // Joints that signals move start where these say. Where nothing can start a run says why.
        let Ok(start) = self.system.state(0.0) else { return Vec::new() };
        let kinematics = Kinematics::at_velocity(self.model(), &start.q, &start.v);
        self.system.elements[e].measure.read(self.model(), &kinematics).1
    }
}

fn build(plan: &Plan, bodies: &[BodySpec]) -> Result<Model, ModelError> {
    // What was refused, was refused of the robot itself.
    let mut builder = ModelBuilder::of_urdf(plan.gravity);
    builder.accept_inertia();
    builder.accept_idle_joints();
    for body in bodies {
        builder.push(body.clone())?;
    }
    builder.finish()
}

/// The motion of the joints that the robot has, the others locked at 0.
fn extended_motion(motion: &Motion, own: &Model, model: &Model) -> Motion {
    let forward = match motion {
        Motion::Forward(forward) => forward,
        Motion::Given(path) => {
            let Trajectory::Prescribed(paths) = &**path else { return motion.clone() };
            let still = || JointPath::Coordinate(Signal::constant(0.0));
            let path = |j: usize| own_place(own, model, j).map_or_else(still, |(_, at)| paths[at].clone());
            return Motion::Given(Arc::new(Trajectory::Prescribed(model.own_joints().map(path).collect())));
        }
    };
    let (mut q, mut v) = (model.neutral(), vec![0.0; model.nv()]);
    let drives = model.own_joints().map(|j| {
        let Some((i, at)) = own_place(own, model, j) else { return Drive::Locked };
        q[model.q_range(j)].copy_from_slice(&forward.q[own.q_range(i)]);
        v[model.v_range(j)].copy_from_slice(&forward.v[own.v_range(i)]);
        forward.drives[at].clone()
    });
    let drives = drives.collect();
    Forward { q, v, drives }.into()
}

/// Which joint of the robot joint `j` of the extended one is, and where it stands among those with coordinates.
fn own_place(own: &Model, model: &Model, j: usize) -> Option<(usize, usize)> {
    own.own_joints().zip(0..).find(|(i, _)| own.joint_names()[*i] == model.joint_names()[j])
}
