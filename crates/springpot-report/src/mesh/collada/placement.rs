//! What a node does with its coordinates: rows of an affine map.

use super::xml::{Node, words};
use crate::mesh::Unread;

#[derive(Debug, Clone, Copy)]
pub(super) struct Placement([[f64; 4]; 3]);

impl Placement {
    /// Coordinates in a unit, m.
    pub(super) fn unit(metres: f64) -> Self {
        Self([[metres, 0.0, 0.0, 0.0], [0.0, metres, 0.0, 0.0], [0.0, 0.0, metres, 0.0]])
    }

    /// Coordinates of a file whose `up_axis` is `up`, z up.
    pub(super) fn upright(self, up: &str) -> Self {
        self.of(match up {
            "Y_UP" => Self([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0], [0.0, 1.0, 0.0, 0.0]]),
            "X_UP" => Self([[0.0, -1.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0], [1.0, 0.0, 0.0, 0.0]]),
            _ => return self,
        })
    }

    /// This of what a node says: its steps in the order of the file.
    ///
    /// # Errors
    /// A number is missing or is none.
    pub(super) fn then(self, node: Node<'_>) -> Result<Self, Unread> {
        let mut steps = node.children().filter(|child| child.is_element());
        steps.try_fold(self, |placement, step| Ok(step_of(step)?.map_or(placement, |step| placement.of(step))))
    }

    /// This of another.
    fn of(self, Self(inner): Self) -> Self {
        Self(self.0.map(|row| {
            [0, 1, 2, 3].map(|k| {
                let sum = row[0] * inner[0][k] + row[1] * inner[1][k] + row[2] * inner[2][k];
                if k == 3 { sum + row[3] } else { sum }
            })
        }))
    }

    pub(super) fn point(&self, point: [f32; 3]) -> [f32; 3] {
        let [x, y, z] = point.map(f64::from);
        self.0.map(|row| (row[0] * x + row[1] * y + row[2] * z + row[3]) as f32)
    }

    /// Whether it makes mirror images.
    pub(super) fn mirrors(&self) -> bool {
        let [a, b, c] = self.0;
        a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
            < 0.0
    }
}

fn step_of(step: Node<'_>) -> Result<Option<Placement>, Unread> {
    Ok(match step.tag_name().name() {
        "matrix" => {
            let m = numbers::<16>(step)?;
            let row = |k: usize| [m[k], m[k + 1], m[k + 2], m[k + 3]];
            Some(Placement([row(0), row(4), row(8)]))
        }
        "translate" => {
            let [x, y, z] = numbers(step)?;
            Some(Placement([[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z]]))
        }
        "scale" => {
            let [x, y, z] = numbers(step)?;
            Some(Placement([[x, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0], [0.0, 0.0, z, 0.0]]))
        }
        "rotate" => Some(turn(numbers(step)?)),
        _ => None,
    })
}

/// About an axis by degrees; none where there is no axis.
fn turn([x, y, z, degrees]: [f64; 4]) -> Placement {
    let length = (x * x + y * y + z * z).sqrt();
    if length == 0.0 || !length.is_finite() {
        return Placement::unit(1.0);
    }
    let (x, y, z) = (x / length, y / length, z / length);
    let (s, c) = degrees.to_radians().sin_cos();
    let v = 1.0 - c;
    Placement([
        [c + x * x * v, x * y * v - z * s, x * z * v + y * s, 0.0],
        [x * y * v + z * s, c + y * y * v, y * z * v - x * s, 0.0],
        [x * z * v - y * s, y * z * v + x * s, c + z * z * v, 0.0],
    ])
}

fn numbers<const N: usize>(node: Node<'_>) -> Result<[f64; N], Unread> {
    let refused = || Unread::Broken("a transformation lacks a number");
    let all: Option<Vec<f64>> = words(node).take(N).map(|word| word.parse().ok()).collect();
    all.ok_or_else(refused)?.try_into().map_err(|_| refused())
}
