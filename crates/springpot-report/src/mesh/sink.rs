//! Where triangles go: one surface a colour, equal corners as one vertex.

use super::{FARTHEST, MOST_TRIANGLES, Unread};
use std::collections::HashMap;

/// Most colours of a file; what has others has none.
const MOST_COLORS: usize = 256;

/// Red, green and blue as screens have them.
pub(crate) type Rgb = [u8; 3];

/// Vertices and triangles.
#[derive(Debug, Clone, Default)]
pub(crate) struct Surface {
    pub(crate) vertices: Vec<[f32; 3]>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

/// What has one colour in a file.
#[derive(Debug, Clone, Default)]
pub(crate) struct Part {
    /// `None`: the file says nothing of it.
    pub(crate) color: Option<Rgb>,
    pub(crate) surface: Surface,
}

/// Parts that grow.
#[derive(Debug, Default)]
pub(super) struct Sink {
    parts: Vec<Part>,
    /// By colour, the index of its part.
    colors: HashMap<Option<Rgb>, usize>,
    /// By part and coordinates to the bit, the index of the vertex.
    vertices: Vec<HashMap<[u32; 3], u32>>,
    taken: usize,
}

impl Sink {
    /// Takes a triangle; one without an area that can be seen to be none is left out.
    ///
    /// # Errors
    /// There are too many, or a corner is too far away.
    pub(super) fn triangle(&mut self, color: Option<Rgb>, corners: [[f32; 3]; 3]) -> Result<(), Unread> {
        self.taken += 1;
        if self.taken > MOST_TRIANGLES {
            return Err(Unread::TooMany);
        }
        // NaN is not near either.
        if !corners.iter().flatten().all(|number| number.abs() <= FARTHEST) {
            return Err(Unread::TooFar);
        }
        let part = self.part(color);
        let (vertices, places) = (&mut self.parts[part].surface.vertices, &mut self.vertices[part]);
        let [a, b, c] = corners.map(|corner| {
            // −0 is 0.
            let corner = corner.map(|number| number + 0.0);
            *places.entry(corner.map(f32::to_bits)).or_insert_with(|| {
                vertices.push(corner);
                vertices.len() as u32 - 1
            })
        });
        if a != b && b != c && c != a {
            self.parts[part].surface.triangles.push([a, b, c]);
        }
        Ok(())
    }

    fn part(&mut self, color: Option<Rgb>) -> usize {
        let color = color.filter(|_| self.colors.len() < MOST_COLORS || self.colors.contains_key(&color));
        *self.colors.entry(color).or_insert_with(|| {
            self.parts.push(Part { color, surface: Surface::default() });
            self.vertices.push(HashMap::new());
            self.parts.len() - 1
        })
    }

    /// The parts that have a triangle.
    ///
    /// # Errors
    /// There is none.
    pub(super) fn finish(mut self) -> Result<Vec<Part>, Unread> {
        self.parts.retain(|part| !part.surface.triangles.is_empty());
        if self.parts.is_empty() { Err(Unread::Empty) } else { Ok(self.parts) }
    }
}

/// A colour from parts 0 … 1, white where they are none.
pub(super) fn rgb(parts: [f32; 3]) -> Rgb {
    parts.map(|part| if part.is_nan() { 255 } else { (255.0 * part.clamp(0.0, 1.0)).round() as u8 })
}
