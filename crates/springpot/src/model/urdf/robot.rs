//! What stands in `<robot>`.

use std::path::Path;

use super::error::{Owner, UrdfError, UrdfProblem};
use super::joint::JointEntry;
use super::link::{Inertial, InertialEntry, LinkEntry};
use super::package::Packages;
use super::reader::{Node, Reader};
use super::source::Source;
use super::tree::Tree;
use super::warning::UrdfWarningKind;
use super::{BodyLines, FLOATING_BASE, RootLink, Urdf, UrdfOptions, joint, link, mimic};
use crate::model::{BodySpec, JointKind, JointSpec, Parent};

/// Elements of `<robot>` that have no part in the dynamics.
const UNUSED: [&str; 6] = ["transmission", "gazebo", "ros2_control", "sensor", "mujoco", "model_state"];
/// Elements of other programs that join links or drive them, for which there is no place in a tree.
const UNSUPPORTED: [&str; 4] = ["loop_joint", "linear_spring_damper", "linear_bushing_rpy", "ball_constraint"];

/// Reads a whole file.
pub(super) fn read(text: &str, file: Option<&Path>, options: &UrdfOptions) -> Result<Urdf, UrdfError> {
    let source = Source::new(text, file);
    let document = source.parse()?;
    let robot = document.root_element();
    let mut reader = Reader::new(&source, robot);
    if robot.tag_name().name() != "robot" {
        let root = robot.tag_name().name().chars().take(40).collect();
        return Err(reader.fail(robot, UrdfProblem::NotUrdf { root }));
    }
    let (links, joints) = entries(&mut reader, robot, options)?;
    if links.is_empty() {
        return Err(reader.fail(robot, UrdfProblem::NoLinks));
    }
    let tree = Tree::of(&reader, &links, &joints)?;
    mimic::check(&reader, &joints)?;
    check_reserved(&reader, &links, &joints, tree.root, options)?;
    if let Some(file) = file {
        let mut packages = Packages::of(file, &options.package_path);
        for link in &links {
            let owner = Owner::Link(link.name.to_owned());
            for mesh in link.meshes.iter().filter(|mesh| !packages.finds(mesh.file)) {
                reader.warnings.add(UrdfWarningKind::MeshNotFound, &owner, mesh.line, format!("{:?}", mesh.file));
            }
        }
    }
    let name = reader.text(robot, "name").unwrap_or_default().to_owned();
    if name.is_empty() {
        reader.warnings.add(UrdfWarningKind::NoName, &Owner::Robot, reader.line(robot), "");
    }
    Ok(assemble(reader, name, links, joints, &tree, options))
}

type Entries<'a> = (Vec<LinkEntry<'a>>, Vec<JointEntry<'a>>);

fn entries<'a>(reader: &mut Reader<'a>, robot: Node<'a>, options: &UrdfOptions) -> Result<Entries<'a>, UrdfError> {
    let owner = Owner::Robot;
    reader.attributes(robot, &owner, &["name"], &["version"]);
    let (mut links, mut joints) = (Vec::new(), Vec::new());
    for node in robot.children() {
        match reader.name(node) {
            Some("link") => links.push(link::read(reader, node)?),
            Some("joint") => joints.push(joint::read(reader, node, options.ignore_mimic)?),
            Some("material") => {}
            Some(name) if UNUSED.contains(&name) => {
                reader.not_used(node, &owner, &format!("<{name}>"));
                if name == "gazebo" {
                    note_simulator(reader, node);
                }
            }
            _ if node.is_element() => {
                if UNSUPPORTED.contains(&node.tag_name().name()) {
                    let what = format!("<{}>", node.tag_name().name());
                    return Err(reader.fail(node, UrdfProblem::Unsupported { owner, what }));
                }
                reader.unknown_element(node, &owner)?;
            }
            _ => reader.stray_text(node, &owner),
        }
    }
    Ok((links, joints))
}

/// Notes what changes the motion of bodies in a simulator and stands in its own elements.
fn note_simulator<'a>(reader: &mut Reader<'a>, gazebo: Node<'a>) {
    for node in gazebo.descendants().filter(Node::is_element) {
        let says = |words: [&str; 2]| node.text().is_some_and(|text| words.contains(&text.trim()));
        let changes_motion = match node.tag_name().name() {
            "springStiffness" => true,
            "turnGravityOff" => says(["true", "1"]),
            "gravity" => says(["false", "0"]),
            "joint" | "hinge" | "slider" | "ball" => {
                node.children().any(|child| matches!(child.tag_name().name(), "parent" | "body1"))
            }
            _ => false,
        };
        if changes_motion {
            let what = format!("<{}>", node.tag_name().name());
            reader.warnings.add(UrdfWarningKind::InSimulator, &Owner::Robot, reader.line(node), what);
        }
    }
}

fn check_reserved<'a>(
    reader: &Reader<'a>,
    links: &[LinkEntry<'a>],
    joints: &[JointEntry<'a>],
    root: usize,
    options: &UrdfOptions,
) -> Result<(), UrdfError> {
    let world = links.iter().position(|link| link.name == "world");
    if let Some(world) = world.filter(|&link| link != root || options.floating_base) {
        return Err(reader.fail(links[world].node, UrdfProblem::ReservedLink { is_root: world == root }));
    }
    match joints.iter().find(|joint| joint.spec.name == FLOATING_BASE) {
        Some(joint) if options.floating_base => Err(reader.fail(joint.node, UrdfProblem::ReservedJoint)),
        _ => Ok(()),
    }
}

/// The bodies in their order, and what is to be said of those that move.
fn assemble<'a>(
    mut reader: Reader<'a>,
    name: String,
    links: Vec<LinkEntry<'a>>,
    mut joints: Vec<JointEntry<'a>>,
    tree: &Tree,
    options: &UrdfOptions,
) -> Urdf {
    let floats = options.floating_base;
    let lines: Vec<usize> = links.iter().map(|link| reader.line(link.node)).collect();
    let root = &links[tree.root];
    let mut bodies = Vec::with_capacity(links.len());
    let mut body_lines = Vec::with_capacity(links.len());
    // Of every link that is done: the body to hang on, and whether it moves in the world.
    let mut done = vec![(Parent::World, false); links.len()];
    if floats {
        let joint = JointSpec::floating(FLOATING_BASE, [0.0; 3]);
        bodies.push(body(root, Parent::World, joint));
        body_lines.push(BodyLines { link: lines[tree.root], joint: lines[tree.root] });
        note_inertia(&mut reader, root, true, true);
        done[tree.root] = (Parent::Body(0), true);
    }
    for branch in &tree.order {
        let (link, joint) = (&links[branch.child], &mut joints[branch.joint]);
        let (parent, parent_moves) = done[branch.parent];
        let is_carried = joint.spec.kind != JointKind::Fixed;
        let moves = parent_moves || is_carried;
        note_inertia(&mut reader, link, is_carried, moves);
        done[branch.child] = (Parent::Body(bodies.len()), moves);
        body_lines.push(BodyLines { link: lines[branch.child], joint: reader.line(joint.node) });
        let spec = std::mem::replace(&mut joint.spec, JointSpec::fixed("", [0.0; 3]));
        bodies.push(body(link, parent, spec));
    }
    let root = RootLink {
        name: root.name.to_owned(),
        line: lines[tree.root],
        inertial: root.inertial.as_ref().map(|inertial| inertial.value),
    };
    let file = reader.source.file.map(Path::to_path_buf);
    let warnings = reader.warnings.finish();
    Urdf { name, file, root, floating_base: floats, bodies, lines: body_lines, warnings }
}

fn body(link: &LinkEntry<'_>, parent: Parent, joint: JointSpec) -> BodySpec {
    let Inertial { mass, com, inertia } = link.inertial.as_ref().map_or(Inertial::ZERO, |inertial| inertial.value);
    BodySpec { name: link.name.to_owned(), parent, joint, mass, com, inertia }
}

/// Notes what is odd about the inertia of a link.
///
/// A link without mass on a fixed joint is a frame, and what is fixed to the world has no part in the dynamics: neither is worth
/// a line.
fn note_inertia(reader: &mut Reader<'_>, link: &LinkEntry<'_>, is_carried: bool, moves: bool) {
    let owner = Owner::Link(link.name.to_owned());
    match &link.inertial {
        None if is_carried => {
            let line = reader.line(link.node);
            reader.warnings.add(UrdfWarningKind::NoInertial, &owner, line, "");
        }
        Some(InertialEntry { value, line, broken_triangle }) => {
            if is_carried && value.mass == 0.0 {
                reader.warnings.add(UrdfWarningKind::ZeroMass, &owner, *line, "");
            }
            if let Some((largest, others)) = broken_triangle.filter(|_| moves) {
                let what = format!("principal moment {largest:.3e} above the sum {others:.3e} of the other two");
                reader.warnings.add(UrdfWarningKind::TriangleInequality, &owner, *line, what);
            }
        }
        None => {}
    }
}
