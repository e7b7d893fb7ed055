//! The nodes of a scene, one after the other.

use super::color::Colors;
use super::geometry;
use super::placement::Placement;
use super::xml::{Index, Node, children, down};
use crate::mesh::Unread;
use crate::mesh::sink::Sink;
use std::collections::HashMap;
use std::rc::Rc;

/// Most elements that are visited; instances multiply them.
const MOST_VISITS: usize = 2_000_000;
/// Most numbers of all meshes together: more than a file holds, unless meshes share them.
const MOST_NUMBERS: usize = 40_000_000;

pub(super) fn read<'a>(index: &Index<'a>, sink: &mut Sink) -> Result<(), Unread> {
    let metres = down(index.root, &["asset", "unit"]).and_then(|unit| unit.attribute("meter")?.trim().parse().ok());
    let unit = Placement::unit(metres.filter(|metres: &f64| *metres > 0.0 && metres.is_finite()).unwrap_or(1.0));
    let asset =
        |names: &[&'static str]| down(index.root, names).and_then(|node| node.text()).unwrap_or_default().trim();
    // MeshLab, whose library signs so, writes Y_UP whatever is up.
    let is_told = !asset(&["asset", "contributor", "authoring_tool"]).contains("VCGLib");
    let placement = if is_told { unit.upright(asset(&["asset", "up_axis"])) } else { unit };
    let mut reader = Reader { index, meshes: HashMap::new(), colors: Colors::default(), numbers: 0 };
    let told = down(index.root, &["scene", "instance_visual_scene"]);
    let scene = told.and_then(|scene| index.target(scene, "url", "visual_scene"));
    let scene = scene.or_else(|| down(index.root, &["library_visual_scenes", "visual_scene"]));
    let Some(scene) = scene else {
        // Shapes that nothing places are where their numbers say.
        for library in children(index.root, "library_geometries") {
            for shape in children(library, "geometry") {
                reader.draw(shape, None, &placement, sink)?;
            }
        }
        return Ok(());
    };
    let mut to_come: Vec<(Node<'a>, Placement)> = vec![(scene, placement)];
    let mut visited = 0;
    while let Some((node, placement)) = to_come.pop() {
        // What a node holds itself is gone through again for each of its instances.
        let own = |child: Node<'_>| if child.tag_name().name() == "node" { 1 } else { child.descendants().count() };
        visited += 1 + node.children().map(own).sum::<usize>();
        if visited > MOST_VISITS || to_come.len() > MOST_VISITS {
            return Err(Unread::Broken("its nodes and their instances are too many"));
        }
        let placement = placement.then(node)?;
        for child in node.children().filter(|child| child.is_element()) {
            match child.tag_name().name() {
                "node" => to_come.push((child, placement)),
                "instance_node" => {
                    to_come.extend(index.target(child, "url", "node").map(|instance| (instance, placement)));
                }
                "instance_geometry" => {
                    if let Some(shape) = index.target(child, "url", "geometry") {
                        reader.draw(shape, Some(child), &placement, sink)?;
                    }
                }
                _ => {}
            }
        }
    }
    Ok(())
}

struct Reader<'i, 'a> {
    index: &'i Index<'a>,
    meshes: HashMap<roxmltree::NodeId, Rc<geometry::Mesh<'a>>>,
    colors: Colors,
    /// Of all meshes.
    numbers: usize,
}

impl<'a> Reader<'_, 'a> {
    /// Draws a `<geometry>` where it is placed, with the materials that its instance binds.
    fn draw(
        &mut self,
        shape: Node<'a>,
        instance: Option<Node<'a>>,
        placement: &Placement,
        sink: &mut Sink,
    ) -> Result<(), Unread> {
        let mesh = match self.meshes.get(&shape.id()) {
            Some(known) => known.clone(),
            None => {
                let mesh = Rc::new(geometry::read(self.index, shape)?);
                self.numbers += mesh.numbers;
                if self.numbers > MOST_NUMBERS {
                    return Err(Unread::Broken("its meshes share their numbers too often"));
                }
                self.meshes.insert(shape.id(), mesh.clone());
                mesh
            }
        };
        let bound = instance.map(|instance| self.colors.bound(self.index, instance)).unwrap_or_default();
        let mirrors = placement.mirrors();
        for (symbol, triangles) in &mesh.groups {
            let color = symbol.and_then(|symbol| match bound.get(symbol) {
                Some(color) => *color,
                None => self.colors.named(self.index, symbol),
            });
            for corners in triangles {
                let [a, mut b, mut c] = corners.map(|corner| placement.point(mesh.points[corner as usize]));
                if mirrors {
                    (b, c) = (c, b);
                }
                sink.triangle(color, [a, b, c])?;
            }
        }
        Ok(())
    }
}
