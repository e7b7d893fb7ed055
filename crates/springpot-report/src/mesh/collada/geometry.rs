//! Meshes: points of their sources, and the triangles that primitives make of them.

use super::xml::{Index, Node, children, down, words};
use crate::mesh::Unread;

/// Most numbers of a corner or a point.
const WIDEST: usize = 32;

/// Triangles between points, by the name that they have for their material.
#[derive(Debug, Default)]
pub(super) struct Mesh<'a> {
    pub(super) points: Vec<[f32; 3]>,
    /// Numbers that were read for them.
    pub(super) numbers: usize,
    pub(super) groups: Vec<(Option<&'a str>, Vec<[u32; 3]>)>,
}

/// The mesh of a `<geometry>`; of splines and the like, an empty one.
pub(super) fn read<'a>(index: &Index<'a>, geometry: Node<'a>) -> Result<Mesh<'a>, Unread> {
    let mut found = Mesh::default();
    let Some(mesh) = children(geometry, "mesh").next() else { return Ok(found) };
    let Some(vertices) = children(mesh, "vertices").next() else { return Ok(found) };
    let mut inputs = children(vertices, "input");
    let positions = inputs.find(|input| input.attribute("semantic") == Some("POSITION"));
    let source = positions.and_then(|input| index.target(input, "source", "source"));
    (found.points, found.numbers) = points(index, source.ok_or(Unread::Broken("a mesh has no positions"))?)?;
    for primitive in mesh.children().filter(|child| child.is_element()) {
        let triangles = triangles(primitive, found.points.len())?;
        if !triangles.is_empty() {
            found.groups.push((primitive.attribute("material"), triangles));
        }
    }
    Ok(found)
}

/// The points of a `<source>`, and how many numbers it has.
fn points<'a>(index: &Index<'a>, source: Node<'a>) -> Result<(Vec<[f32; 3]>, usize), Unread> {
    let accessor = down(source, &["technique_common", "accessor"]);
    let told = accessor.and_then(|accessor| index.target(accessor, "source", "float_array"));
    let array = told.or_else(|| children(source, "float_array").next());
    let array = array.ok_or(Unread::Broken("a source has no array of numbers"))?;
    let numbers: Result<Vec<f32>, _> = words(array).map(str::parse).collect();
    let numbers = numbers.map_err(|_| Unread::Broken("a coordinate is no number"))?;
    let number = |name: &str, default: usize| -> Result<usize, Unread> {
        let written = accessor.and_then(|accessor| accessor.attribute(name));
        let number = written.map_or(Some(default), |written| written.trim().parse().ok());
        number.ok_or(Unread::Broken("an accessor has a number that is none"))
    };
    let (stride, offset) = (number("stride", 3)?, number("offset", 0)?);
    if !(3..=WIDEST).contains(&stride) {
        return Err(Unread::Broken("the stride of positions is not 3, or somewhat more"));
    }
    let there = numbers.len().saturating_sub(offset) / stride;
    let count = number("count", there)?;
    if count > there {
        return Err(Unread::Broken("an accessor tells of more points than are there"));
    }
    let points = numbers.get(offset..).unwrap_or_default().chunks_exact(stride).take(count);
    Ok((points.map(|point| [point[0], point[1], point[2]]).collect(), numbers.len()))
}

/// The triangles of a primitive; none of what is none.
fn triangles(primitive: Node<'_>, points: usize) -> Result<Vec<[u32; 3]>, Unread> {
    let kind = primitive.tag_name().name();
    if !["triangles", "polylist", "polygons", "trifans", "tristrips"].contains(&kind) {
        return Ok(Vec::new());
    }
    let (stride, offset) = layout(primitive)?;
    let mut lists = Vec::new();
    for list in children(primitive, "p") {
        lists.push(corners(list, stride, offset, points)?);
    }
    // A polygon with holes is drawn without them.
    for list in children(primitive, "ph").filter_map(|polygon| children(polygon, "p").next()) {
        lists.push(corners(list, stride, offset, points)?);
    }
    let mut found = Vec::new();
    match kind {
        "triangles" | "polylist" => {
            let all = lists.concat();
            let count: Option<usize> =
                primitive.attribute("count").map(|count| count.trim().parse()).transpose().ok().flatten();
            let mut rest = &all[..];
            let mut polygon = |size: usize| -> Result<(), Unread> {
                let (one, behind) =
                    rest.split_at_checked(size).ok_or(Unread::Broken("a mesh tells of more corners than are there"))?;
                rest = behind;
                fan(one, &mut found);
                Ok(())
            };
            match kind {
                "triangles" => (0..count.unwrap_or(all.len() / 3)).try_for_each(|_| polygon(3))?,
                _ => {
                    let sizes = children(primitive, "vcount").flat_map(words);
                    for size in sizes {
                        polygon(size.parse().map_err(|_| Unread::Broken("a number of corners is none"))?)?;
                    }
                }
            }
        }
        "tristrips" => {
            for list in &lists {
                for (k, three) in list.windows(3).enumerate() {
                    let turned = [[0, 1, 2], [1, 0, 2]][k % 2];
                    found.push(turned.map(|corner| three[corner]));
                }
            }
        }
        _ => lists.iter().for_each(|list| fan(list, &mut found)),
    }
    Ok(found)
}

/// Triangles of a polygon, all from its first corner.
fn fan(polygon: &[u32], triangles: &mut Vec<[u32; 3]>) {
    let Some((first, rest)) = polygon.split_first() else { return };
    triangles.extend(rest.windows(2).map(|two| [*first, two[0], two[1]]));
}

/// How many numbers a corner has, and which of them is that of its point.
fn layout(primitive: Node<'_>) -> Result<(usize, usize), Unread> {
    let (mut stride, mut own) = (0, None);
    for input in children(primitive, "input") {
        let offset = input.attribute("offset").map_or(Some(0), |offset| offset.trim().parse().ok());
        let offset: usize =
            offset.filter(|offset| *offset < WIDEST).ok_or(Unread::Broken("an offset is none, or too large"))?;
        stride = stride.max(offset + 1);
        if input.attribute("semantic") == Some("VERTEX") {
            own = Some(offset);
        }
    }
    Ok((stride, own.ok_or(Unread::Broken("corners do not say which point they are"))?))
}

/// The points of corners.
fn corners(list: Node<'_>, stride: usize, offset: usize, points: usize) -> Result<Vec<u32>, Unread> {
    let own = words(list).skip(offset).step_by(stride).map(|word| {
        let place: Option<u32> = word.parse().ok();
        place
            .filter(|place| (*place as usize) < points)
            .ok_or(Unread::Broken("a corner names a point that is not there"))
    });
    own.collect()
}
