//! `<link>`: its inertia, and the files of its shapes.

use super::Inertial;
use super::error::DescriptionError;
use super::problem::DescriptionProblem;
use super::problem::Owner;
use super::reader::{Node, Reader};
use crate::linalg::symmetric_eigenvalues;
use crate::spatial::{Rotation, Symmetric3};

/// Refuses a principal moment below minus this share of the largest one.
const POSITIVE_TOLERANCE: f64 = 1e-12;
/// Notes a largest principal moment that exceeds the sum of the others by more than this share of itself.
const TRIANGLE_TOLERANCE: f64 = 1e-9;

/// A tensor that is not positive, with entries below this times the mass, m², is that of a point mass and rounding
/// errors.
const NOISE: f64 = 1e-15;

/// A link as it stands in the file.
#[derive(Debug)]
pub(super) struct LinkEntry<'a> {
    pub(super) name: &'a str,
    pub(super) node: Node<'a>,
    pub(super) inertial: Option<InertialEntry<'a>>,
    pub(super) meshes: Vec<Mesh<'a>>,
}

/// An `<inertial>` as it stands in the file.
#[derive(Debug)]
pub(super) struct InertialEntry<'a> {
    /// The `<inertia>`.
    pub(super) node: Node<'a>,
    pub(super) value: Inertial,
    pub(super) line: usize,
    pub(super) physical: Physical,
}

/// Whether an inertia tensor can be that of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Physical {
    Yes,
    /// Not positive, but all of it rounding errors.
    Noise,
    /// The largest principal moment is above the sum of the others.
    BrokenTriangle {
        largest: f64,
        others: f64,
    },
    /// The smallest principal moment is below zero.
    NotPositive {
        smallest: f64,
    },
}

/// The file of a shape.
#[derive(Debug)]
pub(super) struct Mesh<'a> {
    pub(super) file: &'a str,
    pub(super) line: usize,
}

/// Reads a `<link>`.
pub(super) fn read<'a>(reader: &mut Reader<'a>, node: Node<'a>) -> Result<LinkEntry<'a>, DescriptionError> {
    let name = reader.own_name(node, "link")?;
    let owner = Owner::Link(name.to_owned());
    reader.attributes(node, &owner, &["name"], &["type", "dont_collapse"]);
    let mut inertial = None;
    let mut meshes = Vec::new();
    for child in node.children() {
        match reader.name(child) {
            Some("inertial") => {
                if let Some(first) = inertial.replace(child) {
                    let (element, first) = ("inertial".to_owned(), reader.line(first));
                    return Err(reader.fail(child, DescriptionProblem::DuplicateElement { owner, element, first }));
                }
            }
            Some("visual" | "collision") => {
                for mesh in child.descendants().filter(|&node| reader.name(node) == Some("mesh")) {
                    meshes.extend(reader.text(mesh, "filename").map(|file| Mesh { file, line: reader.line(mesh) }));
                }
            }
            Some("material") => {}
            Some(known @ ("contact" | "self_collision_checking" | "sensor")) => {
                reader.not_used(child, &owner, &format!("<{known}>"));
            }
            _ if child.is_element() => reader.unknown_element(child, &owner)?,
            _ => reader.stray_text(child, &owner),
        }
    }
    let inertial = inertial.map(|child| read_inertial(reader, child, &owner)).transpose()?;
    Ok(LinkEntry { name, node, inertial, meshes })
}

fn read_inertial<'a>(
    reader: &mut Reader<'a>,
    node: Node<'a>,
    owner: &Owner,
) -> Result<InertialEntry<'a>, DescriptionError> {
    let [origin, mass, inertia] = reader.children(node, owner, ["origin", "mass", "inertia"], &[])?;
    reader.attributes(node, owner, &[], &[]);
    let missing = |element| reader.fail(node, DescriptionProblem::MissingElement { owner: owner.clone(), element });
    let mass_node = mass.ok_or_else(|| missing("mass"))?;
    let inertia_node = inertia.ok_or_else(|| missing("inertia"))?;

    let (com, rpy) = reader.origin(origin, owner)?;
    reader.leaf(mass_node, owner, &["value"], &[])?;
    let mass = reader.required_number(mass_node, owner, "value")?;
    let mass = reader.not_negative(mass_node, owner, "value", mass)?;

    reader.leaf(inertia_node, owner, &["ixx", "ixy", "ixz", "iyy", "iyz", "izz"], &[])?;
    let tensor = Symmetric3 {
        xx: reader.required_number(inertia_node, owner, "ixx")?,
        xy: reader.required_number(inertia_node, owner, "ixy")?,
        xz: reader.required_number(inertia_node, owner, "ixz")?,
        yy: reader.required_number(inertia_node, owner, "iyy")?,
        yz: reader.required_number(inertia_node, owner, "iyz")?,
        zz: reader.required_number(inertia_node, owner, "izz")?,
    };
    let physical = judge(tensor, mass);
    let turned = match physical {
        Physical::Noise => Symmetric3::ZERO,
        _ if rpy == [0.0; 3] => tensor,
        _ => tensor.rotated(&Rotation::from_rpy(rpy)),
    };
    let value = Inertial { mass, com, inertia: turned.to_matrix() };
    Ok(InertialEntry { node: inertia_node, value, line: reader.line(node), physical })
}

fn judge(tensor: Symmetric3, mass: f64) -> Physical {
    let matrix = tensor.to_matrix();
    let [smallest, middle, largest] = symmetric_eigenvalues(matrix);
    let others = smallest + middle;
    if smallest < -POSITIVE_TOLERANCE * largest.abs() {
        let is_noise = matrix.iter().flatten().all(|entry| entry.abs() <= NOISE * mass);
        if is_noise { Physical::Noise } else { Physical::NotPositive { smallest } }
    } else if largest - others > TRIANGLE_TOLERANCE * largest {
        Physical::BrokenTriangle { largest, others }
    } else {
        Physical::Yes
    }
}
