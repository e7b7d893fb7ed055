//! What a link looks like. It has no part in the dynamics, so that what cannot be read is left out.

use super::package::MeshPlace;

/// A shape on a link.
#[derive(Debug, Clone, PartialEq)]
pub struct Visual {
    /// Its origin in the link's frame, m.
    pub origin: [f64; 3],
    /// Its roll, pitch and yaw against the link's frame, rad.
    pub rpy: [f64; 3],
    /// Red, green, blue and opacity, 0 … 1.
    pub color: Option<[f64; 4]>,
    /// What it is.
    pub shape: VisualShape,
}

/// What a [`Visual`] is.
#[derive(Debug, Clone, PartialEq)]
pub enum VisualShape {
    /// A file of triangles.
    Mesh {
        /// As written.
        file: String,
        /// Where it was found, if it was.
        place: Option<MeshPlace>,
        /// Factors along its axes.
        scale: [f64; 3],
    },
    /// Full sizes along its axes, m.
    Box([f64; 3]),
    /// About its z axis, centred.
    Cylinder {
        /// m.
        radius: f64,
        /// m.
        length: f64,
    },
    /// Its radii along its axes, centred, m.
    Ellipsoid([f64; 3]),
    /// Centred.
    Sphere {
        /// m.
        radius: f64,
    },
}
