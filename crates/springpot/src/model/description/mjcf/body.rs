//! `<worldbody>`: bodies, what is on them, and frames.

use super::attitude::{self, placement};
use super::classes::Classes;
use super::element::{At, Element};
use super::error::DescriptionError;
use super::geom::{Geom, Geoms};
use super::given::{Given, Reader};
use super::joint::{self, Joint};
use super::mass::{self, Mass};
use super::problem::Owner;
use super::settings::Settings;
use super::warning::DescriptionWarningKind;
use super::{BodyLines, JointSpring, Visual};
use crate::model::spec::{BodySpec, JointSpec, Parent};
use crate::names::is_name;
use crate::spatial::{Inertia, Placement, Vec3};
use std::collections::HashMap;

/// Elements of a body that move nothing.
const UNUSED: [&str; 3] = ["site", "camera", "light"];
/// Those that make bodies or joints that are not read.
const REFUSED: [&str; 5] = ["replicate", "composite", "flexcomp", "attach", "plugin"];

const KNOWN: [&str; 7] = ["name", "childclass", "pos", "mocap", "gravcomp", "user", "sleep"];

/// What the bodies of a file are.
#[derive(Debug, Default)]
pub(super) struct Bodies {
    pub(super) specs: Vec<BodySpec>,
    pub(super) lines: Vec<BodyLines>,
    pub(super) visuals: Vec<Vec<Visual>>,
    /// What the world looks like.
    pub(super) world: Vec<Visual>,
    pub(super) springs: Vec<JointSpring>,
    /// Coordinates of joints where the bodies stand as the file places them, of those that are not 0.
    pub(super) start: Vec<(String, Vec<f64>)>,
    /// Joints with springs and dampers that follow from the inertia, and what they follow from.
    pub(super) tuned: Vec<(String, [f64; 2])>,
    /// The owner of each name, as the file writes it.
    names: HashMap<(bool, String), String>,
    /// Bodies so far, the world included, as MuJoCo counts them.
    count: usize,
}

/// What the walk through bodies needs.
pub(super) struct Walk<'d, 'r, 's> {
    pub(super) reader: &'r mut Reader<'s>,
    pub(super) settings: &'d Settings,
    pub(super) classes: &'d Classes,
    pub(super) geoms: Geoms<'d>,
}

/// A body that is to be read.
struct Task<'d> {
    element: &'d Element,
    parent: Parent,
    class: Option<&'d str>,
    /// Frames between it and its parent.
    offset: Placement,
}

/// An element of a body, behind frames.
struct Inside<'d> {
    element: &'d Element,
    class: Option<&'d str>,
    offset: Placement,
}

/// What stands in a body.
#[derive(Default)]
struct Contents<'d> {
    joints: Vec<Inside<'d>>,
    geoms: Vec<Inside<'d>>,
    bodies: Vec<Inside<'d>>,
    inertial: Option<&'d Element>,
}

impl<'d> Walk<'d, '_, '_> {
    /// Reads all bodies, parents first, in the order of the file.
    pub(super) fn bodies(mut self, worlds: impl Iterator<Item = &'d Element>) -> Result<Bodies, DescriptionError> {
        let mut bodies = Bodies { count: 1, ..Bodies::default() };
        let mut tasks = Vec::new();
        for world in worlds {
            let owner = Owner::Body("world".to_owned());
            let mut contents = Contents::default();
            let class = world.text("childclass");
            self.gather(world, class, Placement::IDENTITY, &owner, &mut contents)?;
            if let Some(joint) = contents.joints.first() {
                return Err(self.reader.refuse(joint.element.at, &owner, "has a joint, and does not move"));
            }
            for geom in &contents.geoms {
                let read = self.geom(geom, &owner, false)?;
                bodies.world.extend(read.visuals);
            }
            let into_task = |Inside { element, class, offset }| Task { element, parent: Parent::World, class, offset };
            tasks.extend(contents.bodies.into_iter().map(into_task));
        }
        tasks.reverse();
        while let Some(task) = tasks.pop() {
            let first = tasks.len();
            self.body(task, &mut bodies, &mut tasks)?;
            tasks[first..].reverse();
        }
        Ok(bodies)
    }

    /// Sorts what stands in a body or frame.
    fn gather(
        &mut self,
        parent: &'d Element,
        class: Option<&'d str>,
        offset: Placement,
        owner: &Owner,
        contents: &mut Contents<'d>,
    ) -> Result<(), DescriptionError> {
        for element in &parent.children {
            let inside = || Inside { element, class, offset };
            match element.tag.as_str() {
                "joint" | "freejoint" => contents.joints.push(inside()),
                "geom" => contents.geoms.push(inside()),
                "body" => contents.bodies.push(inside()),
                "inertial" => contents.inertial = Some(element),
                "frame" => {
                    let own = placement(self.reader, &Given::alone(element, owner), self.settings)?;
                    let class = element.text("childclass").or(class);
                    self.gather(element, class, offset * own, owner, contents)?;
                }
                tag if UNUSED.contains(&tag) => {
                    self.reader.warn(DescriptionWarningKind::NotUsed, owner, element.at, format!("<{tag}>"));
                }
                tag if REFUSED.contains(&tag) => {
                    let why = format!("has a <{tag}>, which is not supported");
                    return Err(self.reader.refuse(element.at, owner, why));
                }
                tag => {
                    self.reader.warn(DescriptionWarningKind::UnknownElement, owner, element.at, format!("<{tag}>"));
                }
            }
        }
        Ok(())
    }

    fn geom(&mut self, geom: &Inside<'d>, body: &Owner, counts: bool) -> Result<Geom, DescriptionError> {
        let owner = geom.element.text("name").map_or_else(|| body.clone(), |name| Owner::Geom(name.to_owned()));
        let class = geom.element.text("class").or(geom.class);
        let class = self.classes.find(self.reader, class, "geom", (geom.element.at, &owner))?;
        let given = Given { element: geom.element, class, owner: &owner };
        self.geoms.read(self.reader, &given, &geom.offset, counts)
    }

    fn body(&mut self, task: Task<'d>, bodies: &mut Bodies, tasks: &mut Vec<Task<'d>>) -> Result<(), DescriptionError> {
        let Task { element, parent, class, offset } = task;
        let written = element.text("name").map_or_else(|| format!("body{}", bodies.count), str::to_owned);
        bodies.count += 1;
        let owner = Owner::Body(written.clone());
        let name = self.name(bodies, false, &written, (element.at, &owner))?;
        self.reader.check_attributes(element, &owner, &[&KNOWN, &attitude::WAYS]);
        let given = Given::alone(element, &owner);
        let place = offset * placement(self.reader, &given, self.settings)?;
        if given.number(self.reader, "gravcomp")?.unwrap_or(0.0) != 0.0 {
            let what = "gravcomp of <body>";
            self.reader.warn(DescriptionWarningKind::InSimulator, &owner, element.at, what);
        }
        let class = element.text("childclass").or(class);
        let mut contents = Contents::default();
        self.gather(element, class, Placement::IDENTITY, &owner, &mut contents)?;
        let by_shapes = self.settings.from_shapes.unwrap_or(contents.inertial.is_none());
        let mut inertia = Inertia::ZERO;
        let mut visuals = Vec::new();
        for geom in &contents.geoms {
            let read = self.geom(geom, &owner, by_shapes)?;
            read.inertia.into_iter().for_each(|own| inertia += own);
            visuals.extend(read.visuals);
        }
        let own = match contents.inertial.filter(|_| !by_shapes) {
            Some(inertial) => mass::inertial(self.reader, &Given::alone(inertial, &owner), self.settings)?,
            None => Mass::of(&inertia),
        };
        let joints = self.joints(&contents, bodies, &written, parent)?;
        let lines = BodyLines {
            link: self.reader.line(element.at),
            joint: self.reader.line(joints.first().map_or(element.at, |joint| joint.at)),
        };
        let index = hang(bodies, parent, &name, place, joints, lines);
        mass::give(&mut bodies.specs[index], &own, self.settings);
        bodies.visuals[index] = visuals;
        let into_task =
            |Inside { element, class, offset }| Task { element, parent: Parent::Body(index), class, offset };
        tasks.extend(contents.bodies.into_iter().map(into_task));
        Ok(())
    }

    /// The joints of a body; those without a name are called after it.
    fn joints(
        &mut self,
        contents: &Contents<'d>,
        bodies: &mut Bodies,
        body: &str,
        parent: Parent,
    ) -> Result<Vec<Joint>, DescriptionError> {
        let mut joints = Vec::new();
        let mut nameless = 0;
        for Inside { element, class, offset } in &contents.joints {
            let written = element.text("name").map(str::to_owned).unwrap_or_else(|| {
                nameless += 1;
                if nameless == 1 { format!("{body}_joint") } else { format!("{body}_joint_{nameless}") }
            });
            let owner = Owner::Joint(written.clone());
            let name = self.name(bodies, true, &written, (element.at, &owner))?;
            // A freejoint has nothing from its class.
            let class = match element.tag.as_str() {
                "freejoint" => None,
                tag => {
                    let class = element.text("class").or(*class);
                    self.classes.find(self.reader, class, tag, (element.at, &owner))?
                }
            };
            let given = Given { element, class, owner: &owner };
            let joint = joint::read(self.reader, &given, self.settings, name, offset)?;
            if joint.is_free() && (parent != Parent::World || contents.joints.len() > 1) {
                let why = "is free, and so must be the only joint of a body of the world";
                return Err(self.reader.refuse(element.at, &owner, why));
            }
            joints.push(joint);
        }
        Ok(joints)
    }

    /// A name as columns can have it, of a joint or a body; no two may become one.
    fn name(
        &self,
        bodies: &mut Bodies,
        is_joint: bool,
        written: &str,
        (at, owner): (At, &Owner),
    ) -> Result<String, DescriptionError> {
        let mut name: String =
            written.chars().map(|c| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' }).collect();
        if !is_name(&name) {
            name.insert(0, '_');
        }
        if !is_joint && name == "world" {
            return Err(self.reader.refuse(at, owner, "is called as the world is"));
        }
        if let Some(other) = bodies.names.insert((is_joint, name.clone()), written.to_owned()) {
            let why = if other == written {
                "stands twice; names must be unique".to_owned()
            } else {
                format!("becomes {name:?}, and so does {other:?}; rename one of them")
            };
            return Err(self.reader.refuse(at, owner, why));
        }
        Ok(name)
    }
}

/// Hangs a body with its joints on its parent, with links that have no mass between them, and gives its number. The frame of the last joint is
/// the body's where that turns about the body's origin, else the body is fixed to it.
fn hang(
    bodies: &mut Bodies,
    parent: Parent,
    name: &str,
    place: Placement,
    joints: Vec<Joint>,
    lines: BodyLines,
) -> usize {
    let push = |bodies: &mut Bodies, name: String, parent: Parent, joint: JointSpec, at: Placement| {
        let joint = JointSpec { origin: at.translation.0, rpy: attitude::rpy(&at.rotation), ..joint };
        bodies.specs.push(BodySpec { name, parent, joint, mass: 0.0, com: [0.0; 3], inertia: [[0.0; 3]; 3] });
        bodies.lines.push(lines);
        bodies.visuals.push(Vec::new());
        bodies.specs.len() - 1
    };
    let count = joints.len();
    let is_off = joints.last().is_some_and(|joint| joint.anchor != Vec3::ZERO);
    let (mut parent, mut at, mut anchor) = (parent, place, Vec3::ZERO);
    for (k, joint) in joints.into_iter().enumerate() {
        let is_body = k + 1 == count && !is_off;
        let link = if is_body { name.to_owned() } else { format!("{name}/{}", joint.spec.name) };
        let frame = if joint.is_free() {
            start_of_free(bodies, &joint, &at);
            Placement::IDENTITY
        } else {
            let way = Placement { translation: joint.anchor - anchor, ..Placement::IDENTITY };
            at * way * joint.before_reference()
        };
        if joint.reference != 0.0 {
            bodies.start.push((joint.spec.name.clone(), vec![joint.reference]));
        }
        if let Some([stiffness, slack]) = joint.spring {
            bodies.springs.push(JointSpring { joint: joint.spec.name.clone(), stiffness, slack });
        }
        if let Some(tuned) = joint.tuned {
            bodies.tuned.push((joint.spec.name.clone(), tuned));
        }
        anchor = joint.anchor;
        parent = Parent::Body(push(bodies, link, parent, joint.spec, frame));
        at = Placement::IDENTITY;
    }
    if count > 0 && !is_off {
        let Parent::Body(index) = parent else { return 0 };
        return index;
    }
    let at = if count == 0 { place } else { Placement { translation: Vec3::ZERO - anchor, ..Placement::IDENTITY } };
    push(bodies, name.to_owned(), parent, JointSpec::fixed(format!("{name}/fixed"), [0.0; 3]), at)
}

/// Where a body that moves freely stands in the file: its coordinates there.
fn start_of_free(bodies: &mut Bodies, joint: &Joint, at: &Placement) {
    let coordinates = at.translation.0.into_iter().chain(attitude::rpy(&at.rotation)).collect();
    bodies.start.push((joint.spec.name.clone(), coordinates));
}
