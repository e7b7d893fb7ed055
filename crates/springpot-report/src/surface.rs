//! Triangles of mesh files, few enough for a page.

use crate::scene::{Scene, Shape, Visual};
use std::collections::HashMap;
use std::path::Path;

/// Most triangles over all meshes of a file; more are merged.
const MOST_TRIANGLES: usize = 120_000;
/// Largest file that is read, bytes.
const LARGEST: u64 = 64 << 20;
/// Cells along the longest side of a mesh that is made coarser, at first.
const CELLS: f32 = 96.0;

/// Vertices and triangles.
#[derive(Debug, Clone, Default)]
pub(crate) struct Surface {
    pub(crate) vertices: Vec<[f32; 3]>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

/// The surfaces of all mesh files of the scenes by their path, and files that could not be read.
pub(crate) fn read_all(scenes: &[Scene]) -> (HashMap<&str, Surface>, Vec<String>) {
    let (mut surfaces, mut unread): (HashMap<&str, Surface>, Vec<String>) = (HashMap::new(), Vec::new());
    for path in paths(scenes) {
        match read(Path::new(path)) {
            Some(surface) => _ = surfaces.insert(path, surface),
            None => unread.push(path.to_owned()),
        }
    }
    let all: usize = surfaces.values().map(|surface| surface.triangles.len()).sum();
    if all > MOST_TRIANGLES {
        for surface in surfaces.values_mut() {
            // Each mesh keeps its share.
            let share = (surface.triangles.len() as f64 * MOST_TRIANGLES as f64 / all as f64) as usize;
            *surface = coarse(surface, share.max(64));
        }
    }
    (surfaces, unread)
}

/// The mesh files of the scenes, each once, in their order.
pub(crate) fn paths(scenes: &[Scene]) -> Vec<&str> {
    let mut paths: Vec<&str> = Vec::new();
    for visual in scenes.iter().flat_map(visuals) {
        if let Shape::Mesh { path, .. } = &visual.shape
            && !paths.contains(&path.as_str())
        {
            paths.push(path);
        }
    }
    paths
}

fn visuals(scene: &Scene) -> impl Iterator<Item = &Visual> {
    let root = scene.root.iter().flat_map(|root| &root.visuals);
    scene.bodies.iter().flat_map(|body| &body.visuals).chain(root)
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
    pub(crate) fn extent(&self) -> ([f32; 3], [f32; 3]) {
        let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for vertex in &self.vertices {
            for k in 0..3 {
                (low[k], high[k]) = (low[k].min(vertex[k]), high[k].max(vertex[k]));
            }
        }
        (low, [0, 1, 2].map(|k| (high[k] - low[k]).max(f32::MIN_POSITIVE)))
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A sphere of many triangles as an STL text.
    pub(crate) fn ball(parts: u32) -> Surface {
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
}
