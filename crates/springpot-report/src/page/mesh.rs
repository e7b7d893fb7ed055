//! Triangles of mesh files, small enough for a page.

use crate::scene::{Scene, Shape, Visual};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;
use serde_json::{Value, json};
use std::collections::HashMap;
use std::path::Path;

/// Most triangles of a page over all its meshes; more are merged.
const MOST_TRIANGLES: usize = 120_000;
/// Largest file that is read, bytes.
const LARGEST: u64 = 64 << 20;
/// Cells along the longest side of a mesh that is made coarser, at first.
const CELLS: f32 = 96.0;

/// A mesh: 16-bit coordinates within a box, and the corners of its triangles.
#[derive(Debug, Serialize)]
pub(super) struct Mesh {
    low: [f32; 3],
    size: [f32; 3],
    positions: String,
    triangles: String,
}

/// Vertices and triangles.
#[derive(Debug, Clone, Default)]
struct Surface {
    vertices: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
}

/// The scenes with indices of meshes in the place of files, those meshes, and files that could not be read.
pub(super) fn embed(scenes: &[Scene]) -> (Vec<Value>, Vec<Mesh>, Vec<String>) {
    let mut paths: Vec<&str> = Vec::new();
    for visual in scenes.iter().flat_map(visuals) {
        if let Shape::Mesh { path, .. } = &visual.shape
            && !paths.contains(&path.as_str())
        {
            paths.push(path);
        }
    }
    let mut unread = Vec::new();
    let mut surfaces: HashMap<&str, Surface> = HashMap::new();
    for path in &paths {
        match read(Path::new(path)) {
            Some(surface) => _ = surfaces.insert(path, surface),
            None => unread.push((*path).to_owned()),
        }
    }
    let all: usize = surfaces.values().map(|surface| surface.triangles.len()).sum();
    let mut places: HashMap<&str, usize> = HashMap::new();
    let mut meshes = Vec::new();
    for path in &paths {
        let Some(surface) = surfaces.get(path) else { continue };
        // Each mesh keeps its share.
        let share = (surface.triangles.len() as f64 * MOST_TRIANGLES as f64 / all.max(1) as f64) as usize;
        places.insert(path, meshes.len());
        meshes.push(if all > MOST_TRIANGLES { coarse(surface, share.max(64)).packed() } else { surface.packed() });
    }
    (scenes.iter().map(|scene| with_indices(scene, &places)).collect(), meshes, unread)
}

fn visuals(scene: &Scene) -> impl Iterator<Item = &Visual> {
    let root = scene.root.iter().flat_map(|root| &root.visuals);
    scene.bodies.iter().flat_map(|body| &body.visuals).chain(root)
}

/// A scene as JSON whose shapes name meshes by index; shapes without a mesh are left out.
fn with_indices(scene: &Scene, places: &HashMap<&str, usize>) -> Value {
    let shown = |visuals: &[Visual]| -> Value {
        let shown = visuals.iter().filter_map(|visual| {
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

/// A file of STL, OBJ or COLLADA; `None` where it cannot be read or holds no triangle.
fn read(path: &Path) -> Option<Surface> {
    if !std::fs::metadata(path).is_ok_and(|about| about.is_file() && about.len() <= LARGEST) {
        return None;
    }
    let scene = mesh_loader::Loader::default().merge_meshes(true).load(path).ok()?;
    let mut surface = Surface::default();
    for mesh in scene.meshes {
        let first = u32::try_from(surface.vertices.len()).ok()?;
        let count = u32::try_from(mesh.vertices.len()).ok()?;
        let faces = mesh.faces.iter().filter(|face| face.iter().all(|corner| *corner < count));
        surface.triangles.extend(faces.map(|face| face.map(|corner| corner + first)));
        surface.vertices.extend(&mesh.vertices);
    }
    let is_whole = surface.vertices.iter().flatten().all(|number| number.is_finite());
    (is_whole && !surface.triangles.is_empty()).then(|| welded(&surface))
}

/// The same surface whose equal vertices are one.
fn welded(surface: &Surface) -> Surface {
    let mut places: HashMap<[u32; 3], u32> = HashMap::new();
    merged(surface, |vertex| {
        let next = places.len() as u32;
        *places.entry(vertex.map(f32::to_bits)).or_insert(next)
    })
}

/// About `wanted` triangles: vertices of one cell of a grid become their mean.
fn coarse(surface: &Surface, wanted: usize) -> Surface {
    let (low, size) = surface.extent();
    let longest = size.iter().fold(0.0_f32, |longest, side| longest.max(*side));
    let mut cells = CELLS;
    loop {
        let mut places: HashMap<[i32; 3], u32> = HashMap::new();
        let found = merged(surface, |vertex| {
            let cell = [0, 1, 2].map(|k| ((vertex[k] - low[k]) / longest * cells).floor() as i32);
            let next = places.len() as u32;
            *places.entry(cell).or_insert(next)
        });
        if found.triangles.len() <= wanted || cells < 4.0 {
            return found;
        }
        cells *= 0.75;
    }
}

/// The surface whose vertices of one place are their mean; triangles that lose their area are left out.
fn merged(surface: &Surface, mut place: impl FnMut(&[f32; 3]) -> u32) -> Surface {
    let places: Vec<u32> = surface.vertices.iter().map(&mut place).collect();
    let count = places.iter().max().map_or(0, |most| *most as usize + 1);
    let (mut sums, mut members) = (vec![[0.0_f64; 3]; count], vec![0.0_f64; count]);
    for (vertex, place) in surface.vertices.iter().zip(&places) {
        let place = *place as usize;
        sums[place].iter_mut().zip(vertex).for_each(|(sum, number)| *sum += f64::from(*number));
        members[place] += 1.0;
    }
    let vertices = sums.iter().zip(&members).map(|(sum, count)| sum.map(|sum| (sum / count) as f32)).collect();
    let corners = surface.triangles.iter().map(|triangle| triangle.map(|corner| places[corner as usize]));
    let triangles = corners.filter(|[a, b, c]| a != b && b != c && c != a).collect();
    Surface { vertices, triangles }
}

impl Surface {
    /// The lowest corner of its box, and the sides.
    fn extent(&self) -> ([f32; 3], [f32; 3]) {
        let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for vertex in &self.vertices {
            for k in 0..3 {
                (low[k], high[k]) = (low[k].min(vertex[k]), high[k].max(vertex[k]));
            }
        }
        (low, [0, 1, 2].map(|k| (high[k] - low[k]).max(f32::MIN_POSITIVE)))
    }

    fn packed(&self) -> Mesh {
        let (low, size) = self.extent();
        let steps = |vertex: &[f32; 3]| [0, 1, 2].map(|k| ((vertex[k] - low[k]) / size[k] * 65535.0).round() as u16);
        let positions: Vec<u8> = self.vertices.iter().flat_map(steps).flat_map(u16::to_le_bytes).collect();
        let triangles: Vec<u8> = self.triangles.iter().flatten().flat_map(|corner| corner.to_le_bytes()).collect();
        Mesh { low, size, positions: STANDARD.encode(positions), triangles: STANDARD.encode(triangles) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sphere of many triangles as an STL text.
    fn ball(parts: u32) -> Surface {
        let point = |i: u32, j: u32| {
            let (a, b) =
                (i as f32 / parts as f32 * std::f32::consts::TAU, j as f32 / parts as f32 * std::f32::consts::PI);
            [a.cos() * b.sin(), a.sin() * b.sin(), b.cos()]
        };
        let mut surface = Surface::default();
        for (i, j) in (0..parts).flat_map(|i| (0..parts).map(move |j| (i, j))) {
            let first = surface.vertices.len() as u32;
            surface.vertices.extend([point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)]);
            surface.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
        surface
    }

    #[test]
    fn a_coarse_surface_is_near_the_fine_one() {
        let fine = welded(&ball(200));
        let few = coarse(&fine, 3000);
        assert!(
            fine.triangles.len() > 70_000 && (500..=3000).contains(&few.triangles.len()),
            "{}",
            few.triangles.len()
        );
        for vertex in &few.vertices {
            let radius = vertex.iter().map(|x| x * x).sum::<f32>().sqrt();
            assert!((0.9..1.01).contains(&radius), "{radius}");
        }
    }

    #[test]
    fn coordinates_are_within_a_step_of_sixteen_bits() {
        let surface = ball(20);
        let packed = surface.packed();
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
