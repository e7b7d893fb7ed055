//! Triangles of mesh files as a page holds them.

use crate::mesh::{MeshFile, Part, Surface};
use crate::scene::{Scene, Shape, Visual};
use crate::surface;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;
use serde_json::{Value, json};
use std::collections::{BTreeMap, HashMap};

/// What has one colour in a mesh: 16-bit coordinates within a box, and the corners of its triangles.
#[derive(Debug, Serialize)]
pub(super) struct Mesh {
    /// `#rrggbb`, where the file says it.
    color: Option<String>,
    low: [f32; 3],
    size: [f32; 3],
    positions: String,
    triangles: String,
}

/// The scenes with indices of meshes in the place of files, those meshes, and a word on files that could not be read.
pub(super) fn embed(
    scenes: &[Scene],
    files: &BTreeMap<String, MeshFile>,
) -> (Vec<Value>, Vec<Vec<Mesh>>, Option<String>) {
    let (surfaces, unread) = surface::read_all(scenes, files);
    let mut places: HashMap<&str, usize> = HashMap::new();
    let mut meshes = Vec::new();
    for name in surface::names(scenes) {
        let Some(parts) = surfaces.get(name) else { continue };
        places.insert(name, meshes.len());
        meshes.push(parts.iter().map(Mesh::of).collect());
    }
    (scenes.iter().map(|scene| with_indices(scene, &places)).collect(), meshes, unread)
}

/// A scene as JSON whose shapes name meshes by index; shapes without a mesh are left out.
fn with_indices(scene: &Scene, places: &HashMap<&str, usize>) -> Value {
    let shown = |visuals: &[Visual]| -> Value {
        let shown = visuals.iter().filter(|visual| surface::is_drawable(visual)).filter_map(|visual| {
            let mut value = serde_json::to_value(visual).ok()?;
            if let Shape::Mesh { path, scale } = &visual.shape {
                value["shape"] = json!({ "mesh": { "index": places.get(path.as_str())?, "scale": scale } });
            }
            Some(value)
        });
        shown.collect()
    };
    let mut value = serde_json::to_value(scene).unwrap_or_default();
    for (k, body) in scene.bodies.iter().enumerate() {
        value["bodies"][k]["visuals"] = shown(&body.visuals);
    }
    if let Some(root) = &scene.root {
        value["root"]["visuals"] = shown(&root.visuals);
    }
    value
}

impl Mesh {
    fn of(part: &Part) -> Self {
        let Part { color, surface } = part;
        let color = color.map(|[red, green, blue]| format!("#{red:02x}{green:02x}{blue:02x}"));
        Self { color, ..Self::packed(surface) }
    }

    fn packed(surface: &Surface) -> Self {
        let (low, size) = surface.extent();
        let steps = |vertex: &[f32; 3]| [0, 1, 2].map(|k| ((vertex[k] - low[k]) / size[k] * 65535.0).round() as u16);
        let positions: Vec<u8> = surface.vertices.iter().flat_map(steps).flat_map(u16::to_le_bytes).collect();
        let triangles: Vec<u8> = surface.triangles.iter().flatten().flat_map(|corner| corner.to_le_bytes()).collect();
        Self { color: None, low, size, positions: STANDARD.encode(positions), triangles: STANDARD.encode(triangles) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::tests::ball;

    #[test]
    fn coordinates_are_within_a_step_of_sixteen_bits() {
        let surface = ball(20);
        let packed = Mesh::packed(&surface);
        let bytes = STANDARD.decode(&packed.positions).unwrap();
        for (k, vertex) in surface.vertices.iter().enumerate() {
            for axis in 0..3 {
                let at = 6 * k + 2 * axis;
                let step = f32::from(u16::from_le_bytes([bytes[at], bytes[at + 1]]));
                let found = packed.low[axis] + packed.size[axis] * step / 65535.0;
                assert!((found - vertex[axis]).abs() <= packed.size[axis] / 60_000.0);
            }
        }
        assert_eq!(STANDARD.decode(&packed.triangles).unwrap().len(), 12 * surface.triangles.len());
    }
}
