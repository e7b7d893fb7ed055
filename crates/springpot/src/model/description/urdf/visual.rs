//! `<visual>`: what a link looks like. It has no part in the dynamics, so that what cannot be read is left out.

use super::package::{Found, Packages};
use super::reader::{Node, Reader};
use crate::model::description::visual::{Visual, VisualShape};
use std::collections::HashMap;

/// Colours of materials that have a name.
pub(super) type Materials<'a> = HashMap<&'a str, [f64; 4]>;

/// Colours that the robot names, in whatever place.
pub(super) fn materials<'a>(reader: &Reader<'a>, robot: Node<'a>) -> Materials<'a> {
    let named = robot.descendants().filter(|&node| reader.name(node) == Some("material"));
    named.filter_map(|node| Some((reader.text(node, "name")?, color(reader, node)?))).collect()
}

/// The shapes of a link.
pub(super) fn read<'a>(
    reader: &Reader<'a>,
    link: Node<'a>,
    materials: &Materials<'a>,
    mut packages: Option<&mut Packages>,
) -> Vec<Visual> {
    let visuals = link.children().filter(|&node| reader.name(node) == Some("visual"));
    visuals.filter_map(|node| visual(reader, node, materials, packages.as_deref_mut())).collect()
}

fn visual<'a>(
    reader: &Reader<'a>,
    node: Node<'a>,
    materials: &Materials<'a>,
    packages: Option<&mut Packages>,
) -> Option<Visual> {
    let child = |name: &str| node.children().find(|&child| reader.name(child) == Some(name));
    let [origin, rpy] = match child("origin") {
        Some(origin) => ["xyz", "rpy"].map(|name| reader.text(origin, name).map_or(Some([0.0; 3]), numbers)),
        None => [Some([0.0; 3]); 2],
    };
    let own = child("geometry")?.children().find(|child| child.is_element())?;
    let number = |name: &str| reader.text(own, name).and_then(numbers::<1>).map(|[number]| number);
    let shape = match reader.name(own)? {
        "mesh" => {
            let file = reader.text(own, "filename")?.to_owned();
            let place = match packages.map(|packages| packages.find(&file)) {
                Some(Found::At(place)) => Some(place),
                _ => None,
            };
            VisualShape::Mesh { file, place, scale: reader.text(own, "scale").and_then(numbers).unwrap_or([1.0; 3]) }
        }
        "box" => VisualShape::Box(reader.text(own, "size").and_then(numbers)?),
        "cylinder" => VisualShape::Cylinder { radius: number("radius")?, length: number("length")? },
        "sphere" => VisualShape::Sphere { radius: number("radius")? },
        _ => return None,
    };
    let color = child("material").and_then(|material| {
        color(reader, material).or_else(|| materials.get(reader.text(material, "name")?).copied())
    });
    Some(Visual { origin: origin?, rpy: rpy?, color, shape })
}

fn color<'a>(reader: &Reader<'a>, material: Node<'a>) -> Option<[f64; 4]> {
    let color = material.children().find(|&child| reader.name(child) == Some("color"))?;
    numbers(reader.text(color, "rgba")?)
}

/// Exactly `N` finite numbers.
fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let all: Option<Vec<f64>> = text.split_whitespace().map(|word| word.parse().ok()).collect();
    let numbers: [f64; N] = all?.try_into().ok()?;
    numbers.iter().all(|number| number.is_finite()).then_some(numbers)
}
