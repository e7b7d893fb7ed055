//! The constant robot.

use std::collections::HashMap;

use super::error::ModelError;
use super::spec::{Anchor, JointKind, Parent};
use crate::spatial::{Inertia, Placement, Rotation, Vec3};

/// The robot: a tree of links, each moved by one joint; constant, shared by threads.
///
/// *Link* 0 is the world, and joint j moves link j + 1 by turning it about, or shifting it along, the z axis of the link's
/// own frame. Links come in the order of their joints, parents first. Bodies on fixed joints are part of the link that
/// carries them. Joint j has the coordinate q_j and the velocity v_j.
#[derive(Debug, Clone)]
pub struct Model {
    pub(super) gravity: [f64; 3],
    // One entry per joint, indexed by j.
    pub(super) motions: Vec<JointMotion>,
    pub(super) parents: Vec<usize>,
    pub(super) placements: Vec<Placement>,
    pub(super) inertias: Vec<Inertia>,
    pub(super) subtree_masses: Vec<f64>,
    pub(super) bodies_of_joints: Vec<usize>,
    pub(super) joint_names: Vec<String>,
    pub(super) damping: Vec<f64>,
    pub(super) friction: Vec<f64>,
    // One entry per described body.
    pub(super) frames: Vec<Frame>,
    pub(super) body_names: Vec<String>,
    pub(super) body_lookup: HashMap<String, usize>,
}

/// What a joint does in its z-aligned frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum JointMotion {
    /// Turns about z.
    Revolute,
    /// Shifts along z.
    Prismatic,
}

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

/// An [`Anchor`] as the algorithms want it: the link that carries the point, and the point in the link's frame.
///
/// It belongs to the [`Model`] that resolved it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Site {
    link: usize,
    point: Vec3,
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

impl Model {
    pub(super) fn empty(gravity: [f64; 3]) -> Self {
        Self {
            gravity,
            motions: Vec::new(),
            parents: Vec::new(),
            placements: Vec::new(),
            inertias: Vec::new(),
            subtree_masses: Vec::new(),
            bodies_of_joints: Vec::new(),
            joint_names: Vec::new(),
            damping: Vec::new(),
            friction: Vec::new(),
            frames: Vec::new(),
            body_names: Vec::new(),
            body_lookup: HashMap::new(),
        }
    }

    pub(super) fn collect_subtree_masses(&mut self) {
        self.subtree_masses = self.inertias.iter().map(|inertia| inertia.mass).collect();
        for j in (0..self.nv()).rev() {
            if let Some(parent) = self.parents[j].checked_sub(1) {
                self.subtree_masses[parent] += self.subtree_masses[j];
            }
        }
    }

    /// Number of coordinates q.
    #[inline]
    pub fn nq(&self) -> usize {
        self.motions.len()
    }

    /// Number of velocities v; joint j has velocity j.
    #[inline]
    pub fn nv(&self) -> usize {
        self.motions.len()
    }

    /// Gravitational acceleration, m/s², world axes.
    pub fn gravity(&self) -> [f64; 3] {
        self.gravity
    }

    /// Names of the moving joints, in the order of q.
    pub fn joint_names(&self) -> &[String] {
        &self.joint_names
    }

    /// Index in q of the moving joint called `name`.
    pub fn joint_index(&self, name: &str) -> Option<usize> {
        self.joint_names.iter().position(|other| other == name)
    }

    /// [`JointKind::Revolute`] (coordinate in rad) or [`JointKind::Prismatic`] (coordinate in m) of moving joint `joint`.
    pub fn joint_kind(&self, joint: usize) -> JointKind {
        match self.motions[joint] {
            JointMotion::Revolute => JointKind::Revolute,
            JointMotion::Prismatic => JointKind::Prismatic,
        }
    }

    /// The described body on moving joint `joint`.
    pub fn joint_body(&self, joint: usize) -> usize {
        self.bodies_of_joints[joint]
    }

    /// Viscous damping per moving joint, N·m·s/rad or N·s/m; no algorithm of `dynamics` adds it by itself.
    pub fn damping(&self) -> &[f64] {
        &self.damping
    }

    /// Coulomb friction per moving joint, N·m or N; no algorithm of `dynamics` adds it by itself.
    pub fn friction(&self) -> &[f64] {
        &self.friction
    }

    /// Names of the described bodies, in the order in which they were pushed.
    pub fn body_names(&self) -> &[String] {
        &self.body_names
    }

    /// Index of the body called `name`.
    pub fn body_index(&self, name: &str) -> Option<usize> {
        self.body_lookup.get(name).copied()
    }

    /// Where a body (or the world) is in its link.
    ///
    /// # Errors
    /// [`ModelError::NoSuchBody`].
    pub fn frame(&self, body: Parent) -> Result<Frame, ModelError> {
        match body {
            Parent::World => Ok(Frame::WORLD),
            Parent::Body(body) => {
                self.frames.get(body).copied().ok_or(ModelError::NoSuchBody { body, count: self.frames.len() })
            }
        }
    }

    /// The anchor's link and its point there; do it once, not per step.
    ///
    /// # Errors
    /// [`ModelError::NoSuchBody`], [`ModelError::AnchorNotFinite`].
    pub fn resolve(&self, anchor: &Anchor) -> Result<Site, ModelError> {
        let frame = self.frame(anchor.body)?;
        let point = Vec3(anchor.point);
        if !point.is_finite() {
            return Err(ModelError::AnchorNotFinite { point: anchor.point });
        }
        Ok(Site { link: frame.link, point: frame.placement.point(point) })
    }

    /// The link that moving joint `joint` hangs on; 0 is the world, joint j moves link j + 1.
    #[inline]
    pub fn parent_link(&self, joint: usize) -> usize {
        self.parents[joint]
    }

    /// Inertia of the link that `joint` moves, about the origin of the link's frame and in its axes.
    #[inline]
    pub fn link_inertia(&self, joint: usize) -> &Inertia {
        &self.inertias[joint]
    }

    /// Mass of all that `joint` carries, kg.
    #[inline]
    pub fn subtree_mass(&self, joint: usize) -> f64 {
        self.subtree_masses[joint]
    }

    /// The link frame of `joint` at q_joint = 0 in the frame of its parent link.
    #[inline]
    pub fn joint_placement(&self, joint: usize) -> &Placement {
        &self.placements[joint]
    }

    #[inline]
    pub(crate) fn motion(&self, joint: usize) -> JointMotion {
        self.motions[joint]
    }
}
