//! Triangles from STL and OBJ files, and the exact integrals over what they enclose.

use crate::spatial::{Symmetric3, Vec3};
use std::collections::{HashMap, HashSet};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Longest file, bytes.
const MAX_BYTES: u64 = 256 << 20;

/// Bytes of the head of a binary STL file, its count included, and of a triangle.
const HEAD: usize = 84;
const FACET: usize = 50;

/// Corners, each once, and triangles by their numbers.
#[derive(Debug, Default)]
pub(super) struct Triangles {
    corners: Vec<[f64; 3]>,
    faces: Vec<[usize; 3]>,
}

/// Volume, m³, centre, m, and moments about it for a density of 1, m⁵.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Solid {
    pub(super) volume: f64,
    pub(super) centre: Vec3,
    pub(super) moments: Symmetric3,
}

impl Triangles {
    /// Reads an STL or OBJ file; why not, in words that go behind "mesh file …".
    pub(super) fn read(path: &Path) -> Result<Self, String> {
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        let is = |name: &str| extension == name;
        if !is("stl") && !is("obj") {
            return Err("is neither STL nor OBJ, which alone are read".to_owned());
        }
        let unreadable = |error: std::io::Error| format!("cannot be read: {error}");
        let mut bytes = Vec::new();
        File::open(path).map_err(unreadable)?.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(unreadable)?;
        if bytes.len() as u64 > MAX_BYTES {
            return Err(format!("has more than {MAX_BYTES} bytes"));
        }
        if is("obj") { Self::of_obj(&String::from_utf8_lossy(&bytes)) } else { Self::of_stl(&bytes) }
    }

    fn of_stl(bytes: &[u8]) -> Result<Self, String> {
        let count = bytes.get(80..HEAD).and_then(|count| count.first_chunk()).map(|count| u32::from_le_bytes(*count));
        let is_binary = count.is_some_and(|count| bytes.len() as u64 == HEAD as u64 + FACET as u64 * u64::from(count));
        let mut soup = Vec::new();
        if is_binary {
            for facet in bytes[HEAD..].chunks_exact(FACET) {
                // Behind the normal.
                let numbers = facet[12..48].as_chunks().0.iter().map(|word| f64::from(f32::from_le_bytes(*word)));
                soup.extend(numbers);
            }
        } else {
            let text = String::from_utf8_lossy(bytes);
            for line in text.lines().filter_map(|line| line.trim_start().strip_prefix("vertex")) {
                for word in line.split_ascii_whitespace() {
                    soup.push(word.parse().map_err(|_| format!("has {word:?} where a number should be"))?);
                }
            }
        }
        if !soup.len().is_multiple_of(9) || soup.is_empty() {
            return Err("has no whole triangles".to_owned());
        }
        let mut triangles = Self::default();
        let mut known: HashMap<[u64; 3], usize> = HashMap::new();
        for corners in soup.as_chunks::<9>().0 {
            let face = [0, 3, 6].map(|k| {
                // No corner at -0.
                let corner = [0, 1, 2].map(|c| corners[k + c] + 0.0);
                *known.entry(corner.map(f64::to_bits)).or_insert_with(|| {
                    triangles.corners.push(corner);
                    triangles.corners.len() - 1
                })
            });
            triangles.faces.push(face);
        }
        triangles.checked()
    }

    fn of_obj(text: &str) -> Result<Self, String> {
        let mut triangles = Self::default();
        for (number, line) in text.lines().enumerate() {
            let wrong = |word: &str| format!("has {word:?} in line {}", number + 1);
            let mut words = line.split_ascii_whitespace();
            match words.next() {
                Some("v") => {
                    let mut corner = [0.0; 3];
                    for (slot, word) in corner.iter_mut().zip(words.by_ref()) {
                        *slot = word.parse().map_err(|_| wrong(word))?;
                    }
                    triangles.corners.push(corner);
                }
                Some("f") => {
                    let mut face = Vec::new();
                    for word in words {
                        let own = word.split('/').next().unwrap_or_default();
                        let index: i64 = own.parse().map_err(|_| wrong(word))?;
                        let count = triangles.corners.len() as i64;
                        let at = if index < 0 { count + index } else { index - 1 };
                        let at = usize::try_from(at).ok().filter(|at| *at < triangles.corners.len());
                        face.push(at.ok_or_else(|| wrong(word))?);
                    }
                    let [first, rest @ ..] = &face[..] else { continue };
                    triangles.faces.extend(rest.windows(2).map(|pair| [*first, pair[0], pair[1]]));
                }
                _ => {}
            }
        }
        if triangles.faces.is_empty() {
            return Err("has no triangles".to_owned());
        }
        triangles.checked()
    }

    fn checked(self) -> Result<Self, String> {
        let is_finite = self.corners.as_flattened().iter().all(|x| x.is_finite());
        if is_finite { Ok(self) } else { Err("has corners that are not finite".to_owned()) }
    }

    /// Moves and turns every corner.
    pub(super) fn map(&mut self, to: impl Fn([f64; 3]) -> [f64; 3]) {
        self.corners.iter_mut().for_each(|corner| *corner = to(*corner));
    }

    /// What they enclose: the integrals of 1, x and x xᵀ over the tetrahedra from one point to every face, with their signs.
    ///
    /// Why they enclose nothing, in words that go behind "mesh file …".
    pub(super) fn solid(&self) -> Result<Solid, String> {
        let mut edges = HashSet::new();
        for face in self.faces.iter().filter(|[a, b, c]| a != b && b != c && c != a) {
            for k in 0..3 {
                if !edges.insert((face[k], face[(k + 1) % 3])) {
                    return Err("has faces that are not all turned the same way".to_owned());
                }
            }
        }
        if edges.iter().any(|(a, b)| !edges.contains(&(*b, *a))) {
            return Err("has faces that enclose no volume: edges are open".to_owned());
        }
        let count = self.corners.len() as f64;
        let middle = [0, 1, 2].map(|k| self.corners.iter().map(|corner| corner[k]).sum::<f64>() / count);
        let (mut volume, mut first, mut second) = (0.0, [0.0; 3], [[0.0; 3]; 3]);
        for face in &self.faces {
            let corners = face.map(|at| Vec3([0, 1, 2].map(|k| self.corners[at][k] - middle[k])));
            let [a, b, c] = corners;
            let own = a.dot(b.cross(c)) / 6.0;
            let sum = a + b + c;
            volume += own;
            for i in 0..3 {
                first[i] += own / 4.0 * sum.0[i];
                for j in 0..3 {
                    let products: f64 = corners.iter().map(|x| x.0[i] * x.0[j]).sum();
                    second[i][j] += own / 20.0 * (products + sum.0[i] * sum.0[j]);
                }
            }
        }
        if !(volume.abs() > 0.0 && volume.is_finite()) {
            return Err("has faces that enclose no volume".to_owned());
        }
        // Turned inside out they enclose the same.
        let sign = volume.signum();
        let centre = first.map(|x| x / volume);
        let about = |i: usize, j: usize| sign * (second[i][j] - volume * centre[i] * centre[j]);
        let trace = about(0, 0) + about(1, 1) + about(2, 2);
        let moments = Symmetric3 {
            xx: trace - about(0, 0),
            yy: trace - about(1, 1),
            zz: trace - about(2, 2),
            xy: -about(0, 1),
            xz: -about(0, 2),
            yz: -about(1, 2),
        };
        let centre = Vec3([0, 1, 2].map(|k| middle[k] + centre[k]));
        Ok(Solid { volume: volume.abs(), centre, moments })
    }
}

#[cfg(test)]
mod tests {
    use super::Triangles;

    /// A box of full sizes 2, 3, 4 about (5, 6, 7).
    const BOX: &str = "v 4 4.5 5\nv 6 4.5 5\nv 6 7.5 5\nv 4 7.5 5\nv 4 4.5 9\nv 6 4.5 9\nv 6 7.5 9\nv 4 7.5 9\n\
                       f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2/1 3/1 7/1 6/1\nf -6 -5 -1 -2\nf 4 1 5 8\n";

    #[test]
    fn a_box_has_the_moments_of_a_box() {
        let solid = Triangles::of_obj(BOX).unwrap().solid().unwrap();
        let moments = solid.moments;
        let wanted = [25.0, 20.0, 13.0, 0.0, 0.0, 0.0].map(|x| 24.0 / 12.0 * x);
        let found = [moments.xx, moments.yy, moments.zz, moments.xy, moments.xz, moments.yz];
        assert!((solid.volume - 24.0).abs() < 1e-13, "{solid:?}");
        assert!(found.iter().zip(wanted).all(|(x, y)| (x - y).abs() < 1e-12), "{solid:?}");
        assert!(solid.centre.0.iter().zip([5.0, 6.0, 7.0]).all(|(x, y)| (x - y).abs() < 1e-14), "{solid:?}");
    }

    #[test]
    fn what_encloses_nothing_is_told() {
        let open = Triangles::of_obj(&BOX.replace("f 4 1 5 8\n", "")).unwrap();
        assert!(open.solid().unwrap_err().contains("open"));
        let turned = Triangles::of_obj(&BOX.replace("f 4 1 5 8", "f 8 5 1 4")).unwrap();
        assert!(turned.solid().unwrap_err().contains("same way"));
        for (text, why) in [("v 1 2 x\n", "line 1"), ("v 0 0 0\nf 1 2 3\n", "line 2"), ("", "no triangles")] {
            assert!(Triangles::of_obj(text).unwrap_err().contains(why), "{text}");
        }
        for (bytes, why) in [(&b"solid\nvertex 1 2 q\n"[..], "number"), (b"solid\n", "whole"), (b"", "whole")] {
            assert!(Triangles::of_stl(bytes).unwrap_err().contains(why), "{why}");
        }
    }
}
