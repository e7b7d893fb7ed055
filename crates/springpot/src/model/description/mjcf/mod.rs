//! MJCF files.
//!
//! Bodies, their joints and their masses; the frame of a body is the file's, with links without mass between its joints where it has several. What a
//! file holds beside them is listed, and what would move the robot otherwise is refused or listed as such.

mod attitude;
mod body;
mod classes;
mod element;
mod geom;
mod given;
mod joint;
mod mass;
mod meshes;
mod settings;
mod triangles;

use self::body::{Bodies, Walk};
use self::classes::Classes;
use self::element::Element;
use self::geom::Geoms;
use self::given::Reader;
use self::meshes::Meshes;
use self::settings::Settings;
use super::package::Packages;
use super::problem::Owner;
use super::source::Source;
use super::warning::{DescriptionWarningKind, Warnings};
use super::{BodyLines, DescriptionError, DescriptionOptions, Format, JointSpring, RobotDescription, RootLink, Visual};
use super::{error, package, problem, source, warning};
use std::path::Path;

/// Sections that are read, and those that describe nothing that moves by itself.
const READ: [&str; 5] = ["compiler", "option", "default", "asset", "worldbody"];
const UNUSED: [&str; 10] =
    ["contact", "tendon", "actuator", "sensor", "keyframe", "visual", "statistic", "size", "custom", "extension"];
/// Those that change the motion.
const HEEDED: [&str; 2] = ["equality", "deformable"];

/// Reads the `<mujoco>` of a file.
pub(super) fn read(
    source: &Source<'_>,
    root: roxmltree::Node<'_, '_>,
    options: &DescriptionOptions,
) -> Result<RobotDescription, DescriptionError> {
    let packages = || source.file.map(|file| Packages::of(file, &options.package_path));
    let (root, included) = element::load(source, root, packages().as_mut())?;
    let others = included.iter().map(|file| Source::new(&file.text, Some(&file.path)));
    let sources = std::iter::once(Source::new(source.text, source.file)).chain(others).collect();
    let mut reader = Reader { sources, warnings: Warnings::default() };
    if options.floating_base {
        let why = "says itself what floats, by <freejoint>; floating_base is for URDF files";
        return Err(reader.refuse(root.at, &Owner::Mujoco, why));
    }
    list_sections(&mut reader, &root);
    let settings = Settings::of(&mut reader, &root)?;
    let classes = Classes::of(&reader, &root)?;
    let materials = geom::materials(&reader, &root, &classes)?;
    let mut meshes = Meshes::of(&mut reader, &root, &classes, &settings, packages())?;
    let geoms = Geoms { settings: &settings, materials: &materials, meshes: &mut meshes };
    let walk = Walk { reader: &mut reader, settings: &settings, classes: &classes, geoms };
    let Bodies { mut specs, lines, visuals, world, springs, start, tuned, .. } = walk.bodies(root.all("worldbody"))?;
    mass::scale(&mut specs, &settings);
    let parts = included.iter().map(|file| file.path.clone()).chain(meshes.read().cloned()).collect();
    let line = reader.line(root.at);
    let mut robot = RobotDescription {
        name: root.text("model").unwrap_or_default().to_owned(),
        file: source.file.map(Path::to_path_buf),
        root: RootLink { name: "world".to_owned(), line, inertial: None, visuals: world },
        floating_base: false,
        accept_inertia: options.accept_inertia,
        bodies: specs,
        lines,
        visuals,
        format: Format::Mjcf,
        parts,
        gravity: settings.gravity,
        springs,
        start,
        warnings: reader.warnings.finish(),
    };
    tune(&mut robot, &tuned);
    Ok(robot)
}

fn list_sections(reader: &mut Reader<'_>, root: &Element) {
    for section in &root.children {
        let tag = section.tag.as_str();
        let kind = match tag {
            _ if READ.contains(&tag) => continue,
            _ if UNUSED.contains(&tag) => DescriptionWarningKind::NotUsed,
            _ if HEEDED.contains(&tag) && section.children.is_empty() => continue,
            _ if HEEDED.contains(&tag) => DescriptionWarningKind::InSimulator,
            _ => DescriptionWarningKind::UnknownElement,
        };
        reader.warn(kind, &Owner::Mujoco, section.at, format!("<{tag}>"));
    }
}

/// Gives springs and dampers that are told by time constant T and damping ratio ζ their stiffness M/(Tζ)² and damping 2M/T, M being what the joint
/// has to move where the bodies stand as the file places them, 1/(M⁻¹)_kk, as MuJoCo 4 has it.
fn tune(robot: &mut RobotDescription, tuned: &[(String, [f64; 2])]) {
    if tuned.is_empty() {
        return;
    }
    // What has no mass is told by who builds it.
    let Some(felt) = mass::felt(&robot.bodies, &robot.start) else { return };
    for (name, [time, ratio]) in tuned {
        let Some(body) = robot.bodies.iter().position(|body| body.joint.name == *name) else { continue };
        for spring in robot.springs.iter_mut().filter(|spring| spring.joint == *name) {
            spring.stiffness = felt[body] / (time * ratio).powi(2);
        }
        robot.bodies[body].joint.damping[0] = 2.0 * felt[body] / time;
    }
}
