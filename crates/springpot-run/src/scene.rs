//! What is drawn of a robot: of one case of a scenario, for pages and files that outlive the run.

use crate::meshes::{self, RobotPlace};
use crate::parts::Part;
use crate::record::MOST_SHOWN;
use serde_json::{Map, Value, json};
use springpot::elements::Element;
use springpot::equations::Pose;
use springpot::law::{InputValue, Network, Point, Term};
use springpot::model::description::{self, VisualShape};
use springpot::model::{Anchor, BodySpec, JointKind, JointSpec, Mimic, Move, Parent};
use springpot::system::System;
use springpot_report::ElementSign;
use springpot_report::scene::{
    Body, Driven, Follows, Freedom, Joint, LawText, Parameter, Path, Placed, Root, Scene, SceneElement, SceneShape,
    Shape, Spot, Visual,
};
use springpot_scenario::{Cases, ElementPlan, FramePlan, Plan, ShapePlan};
use std::path::Path as FilePath;

/// Points of a path.
const POINTS: usize = 400;

/// One case as it is drawn, without the wanted path; its meshes are called by their paths from `folder`.
pub(crate) fn scene(plan: &Plan, folder: &FilePath) -> Scene {
    let robot = plan.urdf.as_ref().map(|urdf| &urdf.robot);
    let visual = |shown: &description::Visual| visual(shown, folder);
    let places = Places::of(plan);
    let mut bodies = Vec::new();
    for (index, body) in plan.bodies.iter().enumerate() {
        let mut joints = joints(&body.joint);
        let last = joints.pop();
        let (mut parent, mut origin, mut rpy) = (places.of_parent(body.parent), body.joint.origin, body.joint.rpy);
        for joint in joints {
            let name = joint.name.clone();
            bodies.push(Body { name, parent, origin, rpy, joint, com: [0.0; 3], mass: 0.0, visuals: Vec::new() });
            (parent, origin, rpy) = (Some(bodies.len() - 1), [0.0; 3], [0.0; 3]);
        }
        let visuals = robot.and_then(|robot| robot.visuals.get(index)).map_or(&[][..], Vec::as_slice);
        bodies.extend(last.map(|joint| Body {
            name: body.name.clone(),
            parent,
            origin,
            rpy,
            joint,
            com: body.com,
            mass: body.mass,
            visuals: visuals.iter().filter_map(&visual).collect(),
        }));
    }
    let root = robot.filter(|robot| !robot.floating_base).map(|robot| Root {
        name: robot.root.name.clone(),
        visuals: robot.root.visuals.iter().filter_map(&visual).collect(),
    });
    Scene {
        bodies,
        root,
        ground: None,
        gripper: plan.gripper.as_ref().map(|gripper| places.spot(&gripper.anchor)),
        elements: elements(plan, &places),
        wanted: None,
    }
}

/// Where the gripper is to be, and where the robot stands; nothing of what cannot be told.
pub(crate) fn complete(scene: &mut Scene, plan: &Plan, system: &System) {
    scene.ground = system.pose(0.0).ok().and_then(|pose| ground(plan, &pose));
    let end = plan.settings.end;
    let mut path = Path::default();
    for k in 0..=POINTS {
        let t = end * k as f64 / POINTS as f64;
        let Ok(Some([x, y, z])) = system.wanted(t) else { return };
        for (to, value) in [&mut path.t, &mut path.x, &mut path.y, &mut path.z].into_iter().zip([t, x, y, z]) {
            to.push(value);
        }
    }
    scene.wanted = Some(path);
}

/// What is said of the law of an element.
fn law(plan: &ElementPlan) -> LawText {
    let ElementPlan { element, parameters, inputs, .. } = plan;
    let entry = &element.entry;
    let parameters = entry.params.iter().zip(parameters).map(|(param, value)| Parameter {
        name: param.name.to_string(),
        value: *value,
        unit: param.unit.to_string(),
        meaning: param.meaning.to_string(),
    });
    let inputs = entry.inputs.iter().zip(inputs).map(|(input, signal)| Driven {
        name: input.name.to_string(),
        written: signal.written.clone(),
        unit: input.unit.to_string(),
    });
    let parts = Part::of(entry);
    LawText {
        name: element.name.clone(),
        law: entry.name.to_string(),
        equation: entry.equation.to_string(),
        // Whoever reads a page has no folder of documents.
        source: entry.source.trim_end_matches(" (docs/LITERATURE.md)").to_owned(),
        drawing: parts.as_ref().and_then(Part::drawing),
        modulus: parts.as_ref().and_then(Part::modulus),
        relaxation: parts.as_ref().and_then(Part::relaxation),
        parameters: parameters.collect(),
        inputs: inputs.collect(),
    }
}

/// Where the robot stands; nowhere where its first body floats.
pub(crate) fn ground(plan: &Plan, pose: &Pose<'_>) -> Option<[f64; 3]> {
    let first = plan.bodies.first()?;
    match (first.joint.kind, &plan.urdf) {
        (JointKind::Floating, _) => None,
        (_, Some(_)) => Some([0.0; 3]),
        (_, None) => Some(pose.origin(Parent::Body(0))),
    }
}

/// What an element's law holds, as it is at t = 0.
pub(crate) fn sign_of(element: &Element) -> ElementSign {
    let mut inputs = vec![InputValue { value: 0.0, rate: 0.0 }; element.inputs.len()];
    element.inputs_at(0.0, &mut inputs);
    sign(&element.law, &Point { t: 0.0, stroke: 0.0, rate: 0.0, inputs: &inputs })
}

fn sign(law: &Network, at: &Point<'_>) -> ElementSign {
    let all = || law.parts().iter().map(|part| sign(part, at)).collect();
    match law {
        Network::Leaf(leaf) => match leaf.linearised(at) {
            // A stop that is free at the moment is a spring all the same.
            Term { order: 0.0, coefficient: 0.0 } if leaf.is_linear() => ElementSign::Source,
            Term { order: 0.0, .. } => ElementSign::Spring,
            Term { order: 1.0, .. } => ElementSign::Dashpot,
            Term { .. } => ElementSign::Springpot,
        },
        Network::Parallel(_) => ElementSign::Parallel(all()),
        Network::Series(_) => ElementSign::Series(all()),
        Network::Heated(heated) => sign(heated.law(), &Point { inputs: &heated.inputs_of_law(at.inputs), ..*at }),
    }
}

fn elements(plan: &Plan, places: &Places) -> Vec<SceneElement> {
    let mut drawn: Vec<SceneElement> = Vec::with_capacity(plan.elements.len());
    for element in &plan.elements {
        let (mut name, sign) = (element.element.name.clone(), sign_of(&element.element));
        let shape = match &element.shape {
            ShapePlan::Points(points) => SceneShape::Points(points.iter().map(|anchor| places.spot(anchor)).collect()),
            ShapePlan::Joint(joint) => {
                let Some((body, axis)) = places.of_joint(plan, joint) else { continue };
                SceneShape::Joint { body, axis, turns: element.element.measure.is_rotation() }
            }
            ShapePlan::Bushing { from, to, component } => {
                // One ring for all components.
                let part = std::mem::take(&mut name);
                let whole = part.strip_suffix(component.name()).and_then(|whole| whole.strip_suffix('.'));
                name = whole.unwrap_or_default().to_owned();
                if let Some(SceneElement { shape: SceneShape::Bushing { parts, .. }, .. }) =
                    drawn.iter_mut().find(|drawn| drawn.name == name)
                {
                    parts.push(part);
                    continue;
                }
                SceneShape::Bushing { from: places.placed(from), to: places.placed(to), parts: vec![part] }
            }
        };
        drawn.push(SceneElement { name, sign, contact: lets_go(&element.element.law), shape });
    }
    drawn
}

/// Whether a part of a law is one-sided, as a contact is.
fn lets_go(law: &Network) -> bool {
    match law {
        Network::Leaf(leaf) => leaf.free().is_some(),
        _ => law.parts().iter().any(lets_go),
    }
}

/// The joints that a joint is drawn as, a body each; they are given in its frame, where all of its coordinates are 0.
fn joints(spec: &JointSpec) -> Vec<Joint> {
    let follows = |mimic: &Mimic| Follows { joint: mimic.joint.clone(), ratio: mimic.multiplier, offset: mimic.offset };
    let parts = spec.parts();
    if parts.is_empty() {
        let (name, axis) = (spec.name.clone(), spec.axis);
        return vec![Joint { name, kind: Freedom::Fixed, axis, lead: None, rate: None, follows: None }];
    }
    let is_only = parts.len() == 1;
    let drawn = parts.into_iter().map(|part| Joint {
        kind: match part.moves {
            Move::Turn if spec.kind == JointKind::Continuous => Freedom::Continuous,
            Move::Turn => Freedom::Revolute,
            Move::Shift => Freedom::Prismatic,
            Move::Screw => Freedom::Helical,
            Move::Ball => Freedom::Spherical,
            Move::Pose => Freedom::Floating,
        },
        axis: if is_only { spec.axis } else { part.axis },
        lead: (part.moves == Move::Screw).then_some(spec.lead),
        rate: (part.velocity != part.name).then_some(part.velocity),
        name: part.name,
        follows: spec.mimic.as_ref().map(follows),
    });
    drawn.collect()
}

/// Which body of the scene each body of the plan is: those of joints of several coordinates stand behind one for each of the others.
struct Places(Vec<usize>);

impl Places {
    fn of(plan: &Plan) -> Self {
        let mut count = 0;
        let last = |body: &BodySpec| {
            count += body.joint.parts().len().max(1);
            count - 1
        };
        Self(plan.bodies.iter().map(last).collect())
    }

    fn of_parent(&self, parent: Parent) -> Option<usize> {
        match parent {
            Parent::World => None,
            Parent::Body(index) => Some(self.0[index]),
        }
    }

    /// The body of the scene that a joint, or a coordinate of one, moves, and what it moves along or about.
    fn of_joint(&self, plan: &Plan, name: &str) -> Option<(usize, [f64; 3])> {
        plan.bodies.iter().zip(&self.0).find_map(|(body, last)| {
            let parts = body.joint.parts();
            let k = parts.iter().position(|part| part.name == name)?;
            let axis = if parts.len() == 1 { body.joint.axis } else { parts[k].axis };
            Some((last + 1 + k - parts.len(), axis))
        })
    }

    fn spot(&self, anchor: &Anchor) -> Spot {
        Spot { body: self.of_parent(anchor.body), point: anchor.point }
    }

    fn placed(&self, frame: &FramePlan) -> Placed {
        Placed { body: self.of_parent(frame.anchor.body), point: frame.anchor.point, rpy: frame.rpy }
    }
}

/// A shape of a URDF file; nothing for files that were not found.
fn visual(visual: &description::Visual, folder: &FilePath) -> Option<Visual> {
    let shape = match &visual.shape {
        VisualShape::Mesh { place, scale, .. } => {
            Shape::Mesh { path: meshes::name(folder, &place.as_ref()?.path), scale: *scale }
        }
        VisualShape::Box(sizes) => Shape::Box(*sizes),
        VisualShape::Cylinder { radius, length } => Shape::Cylinder(*radius, *length),
        VisualShape::Ellipsoid(radii) => Shape::Ellipsoid(*radii),
        VisualShape::Sphere { radius } => Shape::Sphere(*radius),
    };
    Some(Visual { origin: visual.origin, rpy: visual.rpy, color: visual.color, shape })
}

/// What is drawn of a run, and said of its laws: known before its first step.
#[derive(Debug)]
pub(crate) struct Drawn {
    /// Each once.
    scenes: Vec<Scene>,
    /// The scene of each of the first cases.
    places: Vec<usize>,
    /// Whether all cases have one scene.
    is_one: bool,
    /// Where the robots of the scenes are; their meshes are called by their paths from the folder of the first.
    robots: Vec<RobotPlace>,
    laws: Vec<LawText>,
}

impl Drawn {
    /// The scenes of the first cases; `first`: the plan and the system of the first of them.
    pub(crate) fn of(cases: &Cases, first: (&Plan, &System)) -> Self {
        let place = |plan: &Plan| plan.urdf.as_ref().and_then(RobotPlace::of);
        let mut robots: Vec<RobotPlace> = place(first.0).into_iter().collect();
        let folder = robots.first().map(|robot| robot.folder().to_owned()).unwrap_or_default();
        let mut scenes = vec![scene(first.0, &folder)];
        complete(&mut scenes[0], first.0, first.1);
        let moves = |path: &String| !path.starts_with("element.") && !path.starts_with("solver.");
        let is_moved = cases.parameters().iter().any(moves);
        // Of elements that the first case has not, what the first one with them says.
        let mut laws: Vec<Option<LawText>> = vec![None; first.0.all_elements().len()];
        let mut tell = |plan: &Plan| {
            for (told, element) in laws.iter_mut().zip(plan.all_elements()) {
                if told.is_none() && plan.elements.iter().any(|own| own.element.name == element.element.name) {
                    *told = Some(law(element));
                }
            }
        };
        tell(first.0);
        let mut places = vec![0];
        for index in 1..cases.len().min(MOST_SHOWN) {
            // A case without a plan has no rows either.
            let Ok(plan) = cases.plan(index) else {
                places.push(0);
                continue;
            };
            tell(&plan);
            let mut own = scene(&plan, &folder);
            if let Some(place) = place(&plan).filter(|place| !robots.contains(place)) {
                robots.push(place);
            }
            match is_moved {
                true => complete(&mut own, &plan, &plan.system()),
                false => (own.ground, own.wanted) = (scenes[0].ground, scenes[0].wanted.clone()),
            }
            let place = scenes.iter().position(|scene| *scene == own).unwrap_or_else(|| {
                scenes.push(own);
                scenes.len() - 1
            });
            places.push(place);
        }
        let is_one = !is_moved && scenes.len() == 1;
        Self { scenes, places, is_one, robots, laws: laws.into_iter().flatten().collect() }
    }

    /// Adds it to the record of a run whose results are in that folder.
    pub(crate) fn record(&self, record: &mut Map<String, Value>, results: &FilePath) {
        for listed in record.get_mut("cases").and_then(Value::as_array_mut).into_iter().flatten() {
            let index = listed["index"].as_u64().map_or(0, |index| index as usize);
            match self.places.get(index) {
                Some(0) => {}
                Some(place) => listed["scene"] = json!(place),
                None if self.is_one => {}
                None => listed["scene"] = Value::Null,
            }
        }
        if self.scenes.iter().any(meshes::has_any) {
            let robots: Vec<_> = self.robots.iter().filter_map(|robot| robot.record(results)).collect();
            record.insert("robots".to_owned(), json!(robots));
        }
        record.insert("scenes".to_owned(), json!(self.scenes));
        record.insert("laws".to_owned(), json!(self.laws));
    }
}
