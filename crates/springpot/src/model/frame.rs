//! Where bodies and points are in the links that carry them.

use crate::spatial::{Placement, Rotation, Vec3};

/// Where a described body is: its link, and its joint frame in the link's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    pub(super) link: usize,
    pub(super) placement: Placement,
}

impl Frame {
    /// The inertial frame.
    pub const WORLD: Self =
        Self { link: 0, placement: Placement { rotation: Rotation::IDENTITY, translation: Vec3::ZERO } };

    /// The link that carries the body; 0 is the world.
    pub fn link(&self) -> usize {
        self.link
    }

    /// The body's joint frame in the frame of its link.
    pub fn placement(&self) -> &Placement {
        &self.placement
    }
}

/// An [`Anchor`](super::Anchor) as the algorithms want it: the link that carries the point, and the point in the link's frame.
///
/// It belongs to the [`Model`](super::Model) that resolved it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Site {
    pub(super) link: usize,
    pub(super) point: Vec3,
}

impl Site {
    /// The link that carries the point; 0 is the world.
    #[inline]
    pub fn link(&self) -> usize {
        self.link
    }

    /// The point in the link's frame, m.
    #[inline]
    pub fn point(&self) -> Vec3 {
        self.point
    }
}
