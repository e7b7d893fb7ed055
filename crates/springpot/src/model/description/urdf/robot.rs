//! What stands in `<robot>`.

use std::collections::HashSet;
use std::path::Path;

use super::error::DescriptionError;
use super::joint::JointEntry;
use super::link::{LinkEntry, Physical};
use super::package::{Found, Packages};
use super::problem::Owner;
use super::problem::{DescriptionProblem, brief};
use super::reader::{Node, Reader};
use super::source::Source;
use super::tree::Tree;
use super::visual;
use super::warning::DescriptionWarningKind;
use super::{
    BodyLines, DescriptionOptions, FLOATING_BASE, Format, Inertial, RobotDescription, RootLink, joint, link, mimic,
};
use crate::model::description::visual::Visual;
use crate::model::kind::JointKind;
use crate::model::spec::{BodySpec, JointSpec, Parent};

/// The inertial frame's name.
const WORLD: &str = "world";

/// Elements of `<robot>` that have no part in the dynamics.
const UNUSED: [&str; 6] = ["transmission", "gazebo", "ros2_control", "sensor", "mujoco", "model_state"];
/// Elements of other programs that join links or drive them, for which there is no place in a tree.
const UNSUPPORTED: [&str; 4] = ["loop_joint", "linear_spring_damper", "linear_bushing_rpy", "ball_constraint"];

/// Reads the `<robot>` of a file.
pub(in crate::model::description) fn read(
    source: &Source<'_>,
    robot: Node<'_>,
    options: &DescriptionOptions,
) -> Result<RobotDescription, DescriptionError> {
    let mut reader = Reader::new(source, robot);
    let file = source.file;
    let (links, mut joints) = entries(&mut reader, robot, options)?;
    if links.is_empty() {
        return Err(reader.fail(robot, DescriptionProblem::NoLinks));
    }
    let tree = Tree::of(&reader, &links, &joints)?;
    mimic::check(&reader, &joints)?;
    check_reserved(&reader, &links, tree.root)?;
    if options.floating_base {
        free_the_name(&mut reader, &mut joints)?;
    }
    let mut packages = file.map(|file| Packages::of(file, &options.package_path));
    if let Some(packages) = &mut packages {
        for link in &links {
            let owner = Owner::Link(link.name.to_owned());
            for mesh in &link.meshes {
                let kind = match packages.find(mesh.file) {
                    Found::At(_) | Found::Elsewhere => continue,
                    Found::Nowhere => DescriptionWarningKind::MeshNotFound,
                    Found::Outside => DescriptionWarningKind::MeshOutside,
                };
                reader.warnings.add(kind, &owner, mesh.line, mesh.file);
            }
        }
    }
    let materials = visual::materials(&reader, robot);
    let looks = links.iter().map(|link| visual::read(&reader, link.node, &materials, packages.as_mut())).collect();
    let name = reader.text(robot, "name").unwrap_or_default().to_owned();
    if name.is_empty() {
        reader.warnings.add(DescriptionWarningKind::NoName, &Owner::Robot, reader.line(robot), "");
    }
    assemble(reader, name, links, looks, joints, &tree, options)
}

type Entries<'a> = (Vec<LinkEntry<'a>>, Vec<JointEntry<'a>>);

fn entries<'a>(
    reader: &mut Reader<'a>,
    robot: Node<'a>,
    options: &DescriptionOptions,
) -> Result<Entries<'a>, DescriptionError> {
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
                    return Err(reader.fail(node, DescriptionProblem::Unsupported { owner, what }));
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
            reader.warnings.add(DescriptionWarningKind::InSimulator, &Owner::Robot, reader.line(node), what);
        }
    }
}

fn check_reserved<'a>(reader: &Reader<'a>, links: &[LinkEntry<'a>], root: usize) -> Result<(), DescriptionError> {
    match links.iter().position(|link| link.name == WORLD).filter(|&link| link != root) {
        Some(world) => Err(reader.fail(links[world].node, DescriptionProblem::ReservedLink)),
        None => Ok(()),
    }
}

/// What a root link that floats is called: its name, but for "world", which is the inertial frame.
fn floating_name<'a>(reader: &mut Reader<'a>, links: &[LinkEntry<'a>], root: usize) -> String {
    let link = &links[root];
    if link.name != WORLD {
        return link.name.to_owned();
    }
    let mut free = FLOATING_BASE.to_owned();
    while links.iter().any(|link| link.name == free) {
        free.push('_');
    }
    let owner = Owner::Link(WORLD.to_owned());
    reader.warnings.add(
        DescriptionWarningKind::Renamed,
        &owner,
        reader.line(link.node),
        format!("called {free:?} here"),
    );
    free
}

/// Keeps the name of the floating joint free: a fixed joint, which has no coordinates to be named, gets another one.
fn free_the_name<'a>(reader: &mut Reader<'a>, joints: &mut [JointEntry<'a>]) -> Result<(), DescriptionError> {
    let Some(taken) = joints.iter().position(|joint| joint.spec.name == FLOATING_BASE) else { return Ok(()) };
    let node = joints[taken].node;
    if joints[taken].spec.kind != JointKind::Fixed {
        return Err(reader.fail(node, DescriptionProblem::ReservedJoint));
    }
    let names: HashSet<&str> = joints.iter().map(|joint| joint.spec.name.as_str()).collect();
    let mut free = format!("{FLOATING_BASE}_2");
    while names.contains(free.as_str()) {
        free.push('_');
    }
    let owner = Owner::Joint(FLOATING_BASE.to_owned());
    reader.warnings.add(DescriptionWarningKind::Renamed, &owner, reader.line(node), format!("called {free:?} here"));
    joints[taken].spec.name = free;
    Ok(())
}

/// The bodies in their order, and what is to be said of those that move.
fn assemble<'a>(
    mut reader: Reader<'a>,
    name: String,
    links: Vec<LinkEntry<'a>>,
    mut looks: Vec<Vec<Visual>>,
    mut joints: Vec<JointEntry<'a>>,
    tree: &Tree,
    options: &DescriptionOptions,
) -> Result<RobotDescription, DescriptionError> {
    let floats = options.floating_base;
    let lines: Vec<usize> = links.iter().map(|link| reader.line(link.node)).collect();
    let root = &links[tree.root];
    let mut bodies = Vec::with_capacity(links.len());
    let mut body_lines = Vec::with_capacity(links.len());
    let mut visuals = Vec::with_capacity(links.len());
    // Of every link that is done: the body to hang on, and whether it moves in the world.
    let mut done = vec![(Parent::World, false); links.len()];
    if floats {
        let joint = JointSpec::floating(FLOATING_BASE, [0.0; 3]);
        let name = floating_name(&mut reader, &links, tree.root);
        bodies.push(BodySpec { name, ..body(root, Parent::World, joint) });
        body_lines.push(BodyLines { link: lines[tree.root], joint: lines[tree.root] });
        visuals.push(std::mem::take(&mut looks[tree.root]));
        note_inertia(&mut reader, root, [true, true], options)?;
        done[tree.root] = (Parent::Body(0), true);
    } else {
        note_inertia(&mut reader, root, [false, false], options)?;
    }
    for branch in &tree.order {
        let (link, joint) = (&links[branch.child], &mut joints[branch.joint]);
        let (parent, parent_moves) = done[branch.parent];
        let is_carried = joint.spec.kind != JointKind::Fixed;
        let moves = parent_moves || is_carried;
        note_inertia(&mut reader, link, [is_carried, moves], options)?;
        done[branch.child] = (Parent::Body(bodies.len()), moves);
        body_lines.push(BodyLines { link: lines[branch.child], joint: reader.line(joint.node) });
        visuals.push(std::mem::take(&mut looks[branch.child]));
        let spec = std::mem::replace(&mut joint.spec, JointSpec::fixed("", [0.0; 3]));
        bodies.push(body(link, parent, spec));
    }
    let root = RootLink {
        name: root.name.to_owned(),
        line: lines[tree.root],
        inertial: root.inertial.as_ref().map(|inertial| inertial.value),
        visuals: std::mem::take(&mut looks[tree.root]),
    };
    let file = reader.source.file.map(Path::to_path_buf);
    let warnings = reader.warnings.finish();
    Ok(RobotDescription {
        name,
        file,
        root,
        floating_base: floats,
        accept_inertia: options.accept_inertia,
        bodies,
        lines: body_lines,
        visuals,
        format: Format::Urdf,
        parts: Vec::new(),
        gravity: None,
        springs: Vec::new(),
        start: Vec::new(),
        warnings,
    })
}

fn body(link: &LinkEntry<'_>, parent: Parent, joint: JointSpec) -> BodySpec {
    let Inertial { mass, com, inertia } = link.inertial.as_ref().map_or(Inertial::ZERO, |inertial| inertial.value);
    BodySpec { name: link.name.to_owned(), parent, joint, mass, com, inertia }
}

/// Notes what is odd about the inertia of a link, which is on a moving joint or not, and moves in the world or not.
///
/// A link without mass on a fixed joint is a frame, and what is fixed to the world has no part in the dynamics: neither
/// is worth a line.
///
/// # Errors
/// A negative principal moment on a moving joint that is not accepted.
fn note_inertia<'a>(
    reader: &mut Reader<'a>,
    link: &LinkEntry<'a>,
    [is_carried, moves]: [bool; 2],
    options: &DescriptionOptions,
) -> Result<(), DescriptionError> {
    let owner = Owner::Link(link.name.to_owned());
    let Some(inertial) = &link.inertial else {
        if is_carried {
            reader.warnings.add(DescriptionWarningKind::NoInertial, &owner, reader.line(link.node), "");
        }
        return Ok(());
    };
    let line = inertial.line;
    if is_carried && inertial.value.mass == 0.0 {
        reader.warnings.add(DescriptionWarningKind::ZeroMass, &owner, line, "");
    }
    match inertial.physical {
        Physical::NotPositive { smallest } if is_carried && !options.accept_inertia => {
            let problem = DescriptionProblem::InertiaNotPositive { link: link.name.to_owned(), smallest };
            return Err(reader.fail(inertial.node, problem));
        }
        Physical::NotPositive { smallest } => {
            let with = match (is_carried, moves) {
                (true, _) => ", used as it is",
                (false, true) => "",
                (false, false) => ", fixed to the world",
            };
            let what = format!("{} kg*m^2{with}", brief(smallest));
            reader.warnings.add(DescriptionWarningKind::NotPositive, &owner, line, what);
        }
        Physical::BrokenTriangle { largest, others } if moves => {
            let what = format!("moment {} above the sum {} of the other two", brief(largest), brief(others));
            reader.warnings.add(DescriptionWarningKind::TriangleInequality, &owner, line, what);
        }
        Physical::Noise => reader.warnings.add(DescriptionWarningKind::PointMass, &owner, line, ""),
        Physical::BrokenTriangle { .. } | Physical::Yes => {}
    }
    Ok(())
}
