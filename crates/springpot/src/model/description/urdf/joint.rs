//! `<joint>`: what it joins, how it moves.

use super::error::DescriptionError;
use super::limit;
use super::problem::Owner;
use super::problem::{DescriptionProblem, TYPES, brief};
use super::reader::{Node, Reader};
use super::warning::DescriptionWarningKind;
use crate::model::kind::JointKind;
use crate::model::spec::{JointSpec, Mimic};
use crate::names::nearest;

/// Types of neighbours of the format, of which no file says enough.
const OTHER_TYPES: [&str; 4] = ["universal", "helical", "screw", "cylindrical"];

/// A joint as it stands in the file.
#[derive(Debug)]
pub(super) struct JointEntry<'a> {
    pub(super) node: Node<'a>,
    /// The `<parent>` and the name of its link.
    pub(super) parent: (Node<'a>, &'a str),
    /// The `<child>` and the name of its link.
    pub(super) child: (Node<'a>, &'a str),
    /// The `<mimic>` that applies.
    pub(super) mimic: Option<Node<'a>>,
    pub(super) spec: JointSpec,
}

/// Reads a `<joint>`.
pub(super) fn read<'a>(
    reader: &mut Reader<'a>,
    node: Node<'a>,
    ignore_mimic: bool,
) -> Result<JointEntry<'a>, DescriptionError> {
    let name = reader.own_name(node, "joint")?;
    let owner = Owner::Joint(name.to_owned());
    reader.attributes(node, &owner, &["name", "type"], &["dont_collapse"]);
    let kind = read_kind(reader, node, name, &owner)?;
    let wanted = ["origin", "parent", "child", "axis", "limit", "dynamics", "mimic"];
    let found = reader.children(node, &owner, wanted, &["calibration", "safety_controller"])?;
    let [origin, parent, child, axis, limit, dynamics, mimic] = found;
    let parent = read_end(reader, node, parent, &owner, "parent")?;
    let child = read_end(reader, node, child, &owner, "child")?;
    let (origin, rpy) = reader.origin(origin, &owner)?;

    let mut spec = JointSpec { kind, rpy, ..JointSpec::fixed(name, origin) };
    if kind == JointKind::Planar {
        spec.axis = read_axis(reader, node, axis, &owner)?;
    }
    if kind.nv() != 1 {
        if let Some(mimic) = mimic.filter(|_| !ignore_mimic && kind.nv() > 1 && kind != JointKind::Floating) {
            let target = read_mimic(reader, mimic, &owner)?.joint;
            let joint = name.to_owned();
            return Err(reader
                .fail(mimic, DescriptionProblem::MimicOfManyDegrees { culprit: joint.clone(), joint, target, kind }));
        }
        let unused =
            [(axis.filter(|_| !kind.has_axis()), "axis"), (limit, "limit"), (dynamics, "dynamics"), (mimic, "mimic")];
        for (element, name) in unused {
            let Some(element) = element else { continue };
            if kind == JointKind::Floating {
                let line = reader.line(element);
                reader.warnings.add(DescriptionWarningKind::OfFloatingJoint, &owner, line, format!("<{name}>"));
            } else {
                reader.not_used(element, &owner, &format!("<{name}> of {} joints", kind.name()));
            }
        }
        return Ok(JointEntry { node, parent, child, mimic: None, spec });
    }
    spec.axis = read_axis(reader, node, axis, &owner)?;
    spec.limits[0] = limit::read(reader, node, limit, &owner, kind)?;
    if let Some(dynamics) = dynamics {
        reader.leaf(dynamics, &owner, &["damping", "friction"], &[])?;
        let damping = reader.number(dynamics, &owner, "damping")?.unwrap_or(0.0);
        spec.damping[0] = reader.not_negative(dynamics, &owner, "damping", damping)?;
        let friction = reader.number(dynamics, &owner, "friction")?.unwrap_or(0.0);
        spec.friction[0] = reader.not_negative(dynamics, &owner, "friction", friction)?;
    }
    if let Some(mimic) = mimic {
        let found = read_mimic(reader, mimic, &owner)?;
        if ignore_mimic {
            reader.warnings.add(DescriptionWarningKind::MimicIgnored, &owner, reader.line(mimic), "");
        } else {
            spec.mimic = Some(found);
        }
    }
    Ok(JointEntry { node, parent, child, mimic: mimic.filter(|_| !ignore_mimic), spec })
}

fn read_kind<'a>(
    reader: &Reader<'a>,
    node: Node<'a>,
    name: &str,
    owner: &Owner,
) -> Result<JointKind, DescriptionError> {
    let written = reader.required(node, owner, "type")?;
    // Gazebo's name of it.
    let own = if written == "ball" { JointKind::Spherical.name() } else { written };
    if let Some(kind) = TYPES.into_iter().find(|kind| kind.name() == own) {
        return Ok(kind);
    }
    let (joint, kind) = (name.to_owned(), written.chars().take(40).collect());
    Err(reader.fail(
        node,
        if OTHER_TYPES.contains(&written) {
            DescriptionProblem::UnsupportedJointType { joint, kind }
        } else {
            let suggestion = nearest(written, TYPES.map(JointKind::name)).map(str::to_owned);
            DescriptionProblem::UnknownJointType { joint, kind, suggestion }
        },
    ))
}

/// The `<parent>` or `<child>` and the name of its link.
fn read_end<'a>(
    reader: &mut Reader<'a>,
    joint: Node<'a>,
    end: Option<Node<'a>>,
    owner: &Owner,
    element: &'static str,
) -> Result<(Node<'a>, &'a str), DescriptionError> {
    let Some(end) = end else {
        return Err(reader.fail(joint, DescriptionProblem::MissingElement { owner: owner.clone(), element }));
    };
    reader.leaf(end, owner, &["link"], &[])?;
    Ok((end, reader.required(end, owner, "link")?))
}

fn read_axis<'a>(
    reader: &mut Reader<'a>,
    joint: Node<'a>,
    axis: Option<Node<'a>>,
    owner: &Owner,
) -> Result<[f64; 3], DescriptionError> {
    const DEFAULT: [f64; 3] = [1.0, 0.0, 0.0];
    let Some(axis) = axis else {
        reader.warnings.add(DescriptionWarningKind::NoAxis, owner, reader.line(joint), "");
        return Ok(DEFAULT);
    };
    reader.leaf(axis, owner, &["xyz"], &[])?;
    let Some(xyz) = reader.numbers(axis, owner, "xyz")? else {
        reader.warnings.add(DescriptionWarningKind::NoAxis, owner, reader.line(axis), "");
        return Ok(DEFAULT);
    };
    if xyz == [0.0; 3] {
        let joint = owner.name().unwrap_or_default().to_owned();
        return Err(reader.fail(axis, DescriptionProblem::ZeroAxis { joint }));
    }
    let length = xyz[0].hypot(xyz[1]).hypot(xyz[2]);
    if (length - 1.0).abs() > 1e-3 {
        reader.warnings.add(
            DescriptionWarningKind::AxisLength,
            owner,
            reader.line(axis),
            format!("length {}", brief(length)),
        );
    }
    Ok(xyz)
}

fn read_mimic<'a>(reader: &mut Reader<'a>, node: Node<'a>, owner: &Owner) -> Result<Mimic, DescriptionError> {
    reader.leaf(node, owner, &["joint", "multiplier", "offset"], &[])?;
    Ok(Mimic {
        joint: reader.required(node, owner, "joint")?.to_owned(),
        multiplier: reader.number(node, owner, "multiplier")?.unwrap_or(1.0),
        offset: reader.number(node, owner, "offset")?.unwrap_or(0.0),
    })
}
