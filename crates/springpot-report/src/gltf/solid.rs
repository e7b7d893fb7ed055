//! Triangles of plain solids, with normals.

use crate::scene::Placement;
use crate::vector::{cross, difference, dot, norm};
use std::f64::consts::{PI, TAU};

/// Triangles of one material: positions, unit normals and corners.
#[derive(Debug, Clone, Default)]
pub(super) struct Solid {
    pub(super) positions: Vec<[f32; 3]>,
    pub(super) normals: Vec<[f32; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
}

impl Solid {
    /// A grid of points with normals, `across` of them in each of so many rows.
    fn grid(rows: usize, across: usize, at: impl Fn(usize, usize) -> ([f64; 3], [f64; 3])) -> Self {
        let mut solid = Self::default();
        for (row, k) in (0..rows).flat_map(|row| (0..across).map(move |k| (row, k))) {
            let (position, normal) = at(row, k);
            solid.push(position, normal);
        }
        for (row, k) in (1..rows).flat_map(|row| (1..across).map(move |k| (row, k))) {
            let [a, b] = [row - 1, row].map(|row| (row * across + k - 1) as u32);
            solid.triangles.extend([[a, b, a + 1], [a + 1, b, b + 1]]);
        }
        solid
    }

    fn push(&mut self, position: [f64; 3], normal: [f64; 3]) {
        self.positions.push(position.map(|number| number as f32));
        self.normals.push(unit(normal));
    }

    /// About z from z = 0 to `length`, closed.
    pub(super) fn cylinder(radius: f64, length: f64, parts: usize) -> Self {
        let turn = |k: usize| (TAU * k as f64 / parts as f64).sin_cos();
        let mut solid = Self::grid(2, parts + 1, |row, k| {
            let (s, c) = turn(k);
            ([radius * c, radius * s, length * (1 - row) as f64], [c, s, 0.0])
        });
        for (z, up) in [(0.0, -1.0), (length, 1.0)] {
            let middle = solid.positions.len() as u32;
            solid.push([0.0, 0.0, z], [0.0, 0.0, up]);
            for k in 0..=parts {
                let (s, c) = turn(k);
                solid.push([radius * c, radius * s, z], [0.0, 0.0, up]);
            }
            let fan = (1..=parts as u32).map(|k| match up > 0.0 {
                true => [middle, middle + k, middle + k + 1],
                false => [middle, middle + k + 1, middle + k],
            });
            solid.triangles.extend(fan);
        }
        solid
    }

    /// About the origin.
    pub(super) fn sphere(radius: f64, parts: usize) -> Self {
        Self::rounded(radius, 0.0, parts)
    }

    /// A cylinder along z from 0 to `length` with round ends.
    pub(super) fn rounded(radius: f64, length: f64, parts: usize) -> Self {
        let half = parts / 4;
        Self::grid(2 * half + 2, parts + 1, |row, k| {
            let (upper, step) = if row <= half { (true, row) } else { (false, row - 1) };
            let ((s, c), (sin, cos)) =
                ((TAU * k as f64 / parts as f64).sin_cos(), (PI * step as f64 / (2 * half) as f64).sin_cos());
            let normal = [sin * c, sin * s, cos];
            let z = radius * cos + if upper { length } else { 0.0 };
            ([radius * normal[0], radius * normal[1], z], normal)
        })
    }

    /// About the origin, full sizes.
    pub(super) fn cuboid(sizes: [f64; 3]) -> Self {
        let mut solid = Self::default();
        for (axis, side) in (0..3).flat_map(|axis| [(axis, 1.0), (axis, -1.0)]) {
            let first = solid.positions.len() as u32;
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            for (a, b) in [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)] {
                let (mut position, mut normal) = ([0.0; 3], [0.0; 3]);
                (position[axis], position[u], position[v]) =
                    (0.5 * side * sizes[axis], a * side * sizes[u], b * sizes[v]);
                normal[axis] = side;
                solid.push(position, normal);
            }
            solid.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
        solid
    }

    /// A ring about z: its radius, and that of its tube.
    pub(super) fn ring(radius: f64, tube: f64) -> Self {
        let (around, parts) = (40, 12);
        Self::grid(around + 1, parts + 1, |row, k| {
            let ((s, c), (sin, cos)) =
                ((TAU * row as f64 / around as f64).sin_cos(), (TAU * k as f64 / parts as f64).sin_cos());
            let normal = [cos * c, cos * s, sin];
            ([(radius + tube * cos) * c, (radius + tube * cos) * s, tube * sin], normal)
        })
    }

    /// Triangles without normals: each keeps its own corners and is flat.
    pub(super) fn faceted(vertices: &[[f32; 3]], triangles: &[[u32; 3]], scale: [f64; 3]) -> Self {
        let mut solid = Self::default();
        let is_mirrored = scale.iter().product::<f64>() < 0.0;
        for triangle in triangles {
            let [a, mut b, mut c] =
                triangle.map(|corner| [0, 1, 2].map(|k| f64::from(vertices[corner as usize][k]) * scale[k]));
            if is_mirrored {
                (b, c) = (c, b);
            }
            let normal = cross(difference(b, a), difference(c, a));
            let first = solid.positions.len() as u32;
            [a, b, c].into_iter().for_each(|corner| solid.push(corner, normal));
            solid.triangles.push([first, first + 1, first + 2]);
        }
        solid
    }

    /// The same, longer by these factors along its axes, its normals with it.
    pub(super) fn stretched(mut self, factors: [f64; 3]) -> Self {
        let by = |vector: [f32; 3], factor: &dyn Fn(f64) -> f64| {
            [0, 1, 2].map(|k| f64::from(vector[k]) * factor(factors[k]))
        };
        for position in &mut self.positions {
            *position = by(*position, &|factor| factor).map(|number| number as f32);
        }
        for normal in &mut self.normals {
            *normal = unit(by(*normal, &f64::recip));
        }
        self
    }

    /// The same elsewhere.
    pub(super) fn placed(mut self, placement: &Placement) -> Self {
        for position in &mut self.positions {
            *position = placement.point(position.map(f64::from)).map(|number| number as f32);
        }
        for normal in &mut self.normals {
            *normal = unit(placement.direction(normal.map(f64::from)));
        }
        self
    }

    /// Both as one.
    pub(super) fn extend(&mut self, other: Self) {
        let first = self.positions.len() as u32;
        self.positions.extend(other.positions);
        self.normals.extend(other.normals);
        self.triangles.extend(other.triangles.into_iter().map(|triangle| triangle.map(|corner| corner + first)));
    }
}

/// Along z where there is no direction.
fn unit(a: [f64; 3]) -> [f32; 3] {
    let length = norm(a);
    if length > 0.0 && length.is_finite() { a.map(|part| (part / length) as f32) } else { [0.0, 0.0, 1.0] }
}

/// The least turn that takes z into a direction; none where there is no direction.
pub(super) fn from_z(direction: [f64; 3]) -> [f64; 4] {
    between([0.0, 0.0, 1.0], direction)
}

/// The least turn that takes a direction into another.
pub(super) fn between(a: [f64; 3], b: [f64; 3]) -> [f64; 4] {
    let (long_a, long_b) = (norm(a), norm(b));
    if !(long_a > 0.0 && long_b > 0.0) {
        return Placement::IDENTITY.turn;
    }
    let (a, b) = (a.map(|part| part / long_a), b.map(|part| part / long_b));
    let w = 1.0 + dot(a, b);
    let turn = if w > 1e-9 {
        let [x, y, z] = cross(a, b);
        [x, y, z, w]
    } else if a[0].abs() > 0.5 {
        // Half a turn about any direction across.
        [a[1], -a[0], 0.0, 0.0]
    } else {
        [0.0, a[2], -a[1], 0.0]
    };
    let length = norm(turn);
    turn.map(|part| part / length)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Six times the volume that the triangles enclose, seen from outside.
    fn volume(solid: &Solid) -> f64 {
        let at = |corner: u32| solid.positions[corner as usize].map(f64::from);
        let one = |[a, b, c]: &[u32; 3]| {
            let (a, b, c) = (at(*a), at(*b), at(*c));
            a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
        };
        solid.triangles.iter().map(one).sum::<f64>() / 6.0
    }

    #[test]
    fn solids_are_closed_and_their_faces_look_outwards() {
        let near = |solid: &Solid, expected: f64| {
            let found = volume(solid);
            assert!((found / expected - 1.0).abs() < 0.05, "{found} {expected}");
            for normal in &solid.normals {
                assert!((normal.iter().map(|part| part * part).sum::<f32>() - 1.0).abs() < 1e-5);
            }
        };
        near(&Solid::cylinder(0.5, 2.0, 40), PI * 0.5);
        near(&Solid::sphere(0.7, 48), 4.0 / 3.0 * PI * 0.7_f64.powi(3));
        near(&Solid::rounded(0.5, 2.0, 48), PI * 0.5 + 4.0 / 3.0 * PI * 0.125);
        near(&Solid::cuboid([1.0, 2.0, 3.0]), 6.0);
        near(&Solid::ring(2.0, 0.3), 2.0 * PI * PI * 2.0 * 0.09);
        let cube = Solid::cuboid([1.0; 3]);
        near(&Solid::faceted(&cube.positions, &cube.triangles, [-1.0, 2.0, 1.0]), 2.0);
    }

    #[test]
    fn turns_take_one_direction_into_the_other() {
        for (a, b) in [
            ([0.0, 0.0, 1.0], [0.0, 0.0, -1.0]),
            ([1.0, 0.0, 0.0], [-2.0, 0.0, 0.0]),
            ([0.3, -0.4, 0.5], [0.1, 0.2, 0.9]),
            ([0.0, 1.0, 0.0], [0.0, -1.0, 0.0]),
        ] {
            let turned = Placement { turn: between(a, b), ..Placement::IDENTITY }.direction(a);
            let (scale, long) = (norm(a), norm(b));
            for k in 0..3 {
                assert!((turned[k] / scale - b[k] / long).abs() < 1e-9, "{a:?} {b:?} {turned:?}");
            }
        }
        assert_eq!(from_z([0.0; 3]), [0.0, 0.0, 0.0, 1.0]);
    }
}
