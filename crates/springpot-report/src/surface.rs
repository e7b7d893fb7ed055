//! Triangles of mesh files, few enough for a page.

use crate::mesh::{self, MeshFile, Part, Surface};
use crate::scene::{Scene, Shape, Visual};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::Path;

/// Most triangles over all meshes of a file; more are merged.
const MOST_TRIANGLES: usize = 120_000;
/// Bytes of all mesh files that are read.
const MOST_BYTES: u64 = 512 << 20;
/// Cells along the longest side of a mesh that is made coarser, at first.
const CELLS: f32 = 96.0;

/// The surfaces of all mesh files of the scenes by their names, and a word on those that could not be read; names without a file have none.
pub(crate) fn read_all<'a>(
    scenes: &'a [Scene],
    files: &BTreeMap<String, MeshFile>,
) -> (HashMap<&'a str, Vec<Part>>, Option<String>) {
    let (mut surfaces, mut unread): (HashMap<&str, Vec<Part>>, Vec<String>) = (HashMap::new(), Vec::new());
    let mut bytes = 0;
    for (name, file) in names(scenes).into_iter().filter_map(|name| Some((name, files.get(name)?))) {
        bytes += size_of(&file.path);
        if bytes > MOST_BYTES {
            unread.push(format!("{name} cannot be read: the meshes before it have {} MiB", MOST_BYTES >> 20));
            continue;
        }
        match mesh::read(file) {
            Ok(mut parts) => {
                thin(&mut parts, MOST_TRIANGLES);
                surfaces.insert(name, parts);
            }
            Err(why) => unread.push(format!("{name} cannot be read as a mesh: {why}")),
        }
    }
    let all: usize = surfaces.values().map(|parts| count(parts)).sum();
    if all > MOST_TRIANGLES {
        for parts in surfaces.values_mut() {
            // Each mesh keeps its share.
            let share = (count(parts) as f64 * MOST_TRIANGLES as f64 / all as f64) as usize;
            thin(parts, share);
        }
    }
    let word = match &unread[..] {
        [] => None,
        [one] => Some(one.clone()),
        [first, rest @ ..] => Some(format!("{first}; and {} more", rest.len())),
    };
    (surfaces, word)
}

fn size_of(path: &Path) -> u64 {
    std::fs::metadata(path).map_or(0, |about| about.len().min(mesh::LARGEST))
}

fn count(parts: &[Part]) -> usize {
    parts.iter().map(|part| part.surface.triangles.len()).sum()
}

/// Leaves about so many triangles, of each part its share.
fn thin(parts: &mut [Part], wanted: usize) {
    let all = count(parts);
    if all <= wanted {
        return;
    }
    for part in parts {
        let share = (part.surface.triangles.len() as f64 * wanted as f64 / all as f64) as usize;
        part.surface = coarse(&part.surface, share.max(16));
    }
}

/// Names of the mesh files of the scenes, each once, in their order.
pub(crate) fn names(scenes: &[Scene]) -> Vec<&str> {
    let mut seen = HashSet::new();
    let named = scenes.iter().flat_map(visuals).filter_map(|visual| match &visual.shape {
        Shape::Mesh { path, .. } => Some(path.as_str()),
        _ => None,
    });
    named.filter(|name| seen.insert(*name)).collect()
}

fn visuals(scene: &Scene) -> impl Iterator<Item = &Visual> {
    let root = scene.root.iter().flat_map(|root| &root.visuals);
    scene.bodies.iter().flat_map(|body| &body.visuals).chain(root)
}

/// Whether a shape can be drawn at all: finite, and no larger than what is drawn.
pub(crate) fn is_drawable(visual: &Visual) -> bool {
    let sizes: &[f64] = match &visual.shape {
        Shape::Mesh { scale, .. } => scale,
        Shape::Box(sizes) | Shape::Ellipsoid(sizes) => sizes,
        Shape::Cylinder(radius, length) => &[*radius, *length],
        Shape::Sphere(radius) => std::slice::from_ref(radius),
    };
    sizes.iter().chain(&visual.origin).chain(&visual.rpy).all(|number| number.abs() < FARTHEST)
}

/// Lengths beyond are not drawn, m.
const FARTHEST: f64 = 1e9;

/// About `wanted` triangles: vertices of one cell of a grid become their mean.
fn coarse(surface: &Surface, wanted: usize) -> Surface {
    let (low, size) = surface.extent();
    let longest = size.iter().fold(0.0_f32, |longest, side| longest.max(*side));
    let mut cells = CELLS;
    loop {
        let mut places: HashMap<[i32; 3], u32> = HashMap::new();
        let mut found = merged(surface, |vertex| {
            let cell = [0, 1, 2].map(|k| ((vertex[k] - low[k]) / longest * cells).floor() as i32);
            let next = places.len() as u32;
            *places.entry(cell).or_insert(next)
        });
        if found.triangles.len() <= wanted {
            return found;
        }
        if cells < 4.0 {
            // A cloud of triangles that no grid makes fewer is no surface.
            found.triangles.truncate(wanted);
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

    /// A sphere of many triangles, each with its own corners.
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

    fn welded(surface: &Surface) -> Surface {
        let mut places: HashMap<[u32; 3], u32> = HashMap::new();
        merged(surface, |vertex| {
            let next = places.len() as u32;
            *places.entry(vertex.map(f32::to_bits)).or_insert(next)
        })
    }

    #[test]
    fn a_cloud_becomes_no_more_than_is_wanted() {
        let mut seed = 7_u32;
        let mut number = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) as f32 / 16_777_216.0
        };
        let vertices: Vec<[f32; 3]> = (0..30_000).map(|_| [number(), number(), number()]).collect();
        let triangles = (0..10_000).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        assert_eq!(coarse(&Surface { vertices, triangles }, 500).triangles.len(), 500);
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
