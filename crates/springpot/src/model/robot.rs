//! The constant robot.

mod parts;

use self::parts::{DegreeTree, Drivetrain, Masses, Names, Numbering};
use super::degree::{Coordinates, Degree, DegreeMotion, JointMotion};
use super::error::ModelError;
use super::frame::{Frame, Site};
use super::kind::{JointKind, Space};
use super::spec::{Anchor, FrictionLaw, Limits, Parent};
use crate::spatial::{Inertia, Placement, Rotation, Vec3};
use std::ops::Range;

/// The robot: a tree of links, each moved by one joint; constant, shared by threads.
///
/// *Link* 0 is the world, and joint j moves link j + 1: it turns it about, or shifts it along, the z axis of the link's own
/// frame, or does both at once (a helical joint), or all three axes of it (a spherical or floating joint). Links come in the
/// order of their joints, parents first. Bodies on fixed joints are part of the link that carries them.
///
/// A described joint with several coordinates that are numbers is a chain of joints here, one for each coordinate, called
/// after it with a dot ("c.z", "c.rz"), on links without mass but the last ([`Model::described_joints`]).
///
/// The coordinates q and the velocities v stand in the order of the joints, [`Space::nq`] and [`Space::nv`] of them for each
/// joint but those that follow another one ([`Model::followed`]): these have none of their own.
#[derive(Debug, Clone)]
pub struct Model {
    pub(super) gravity: [f64; 3],
    pub(super) numbering: Numbering,
    // One entry per joint, indexed by j.
    pub(super) motions: Vec<JointMotion>,
    /// Shift of a helical joint, m/rad.
    pub(super) pitches: Vec<f64>,
    pub(super) spaces: Vec<Space>,
    /// Which described joint it is, or is part of.
    pub(super) described_as: Vec<usize>,
    pub(super) limits: Vec<Limits>,
    pub(super) parents: Vec<usize>,
    pub(super) placements: Vec<Placement>,
    pub(super) bodies_of_joints: Vec<usize>,
    pub(super) masses: Masses,
    pub(super) drivetrain: Drivetrain,
    pub(super) tree: DegreeTree,
    // One entry per described joint that moves.
    pub(super) described: Vec<DescribedJoint>,
    // One entry per described body.
    pub(super) frames: Vec<Frame>,
    pub(super) names: Names,
}

/// A joint that moves, as it is described: one joint of the [`Model`], or a chain of them.
#[derive(Debug, Clone)]
pub struct DescribedJoint {
    /// Its name.
    pub name: String,
    /// What it is.
    pub kind: JointKind,
    /// Its joints of the model.
    pub joints: Range<usize>,
}

impl Model {
    pub(super) fn empty(gravity: [f64; 3]) -> Self {
        Self {
            gravity,
            numbering: Numbering::default(),
            motions: Vec::new(),
            pitches: Vec::new(),
            spaces: Vec::new(),
            described_as: Vec::new(),
            limits: Vec::new(),
            parents: Vec::new(),
            placements: Vec::new(),
            bodies_of_joints: Vec::new(),
            masses: Masses::default(),
            drivetrain: Drivetrain::default(),
            tree: DegreeTree::of_the_world(),
            described: Vec::new(),
            frames: Vec::new(),
            names: Names::default(),
        }
    }

    /// Number of coordinates q.
    #[inline]
    pub fn nq(&self) -> usize {
        self.numbering.nq
    }

    /// Number of velocities v.
    #[inline]
    pub fn nv(&self) -> usize {
        self.numbering.nv
    }

    /// The coordinate whose time derivative velocity `k` is; `None` for a joint of several degrees.
    #[inline]
    pub fn coordinate_of(&self, k: usize) -> Option<usize> {
        self.numbering.places[k]
    }

    /// Number of moving joints, those that follow another one included; joint j moves link j + 1.
    #[inline]
    pub fn joint_count(&self) -> usize {
        self.motions.len()
    }

    /// Gravitational acceleration, m/s², world axes.
    pub fn gravity(&self) -> [f64; 3] {
        self.gravity
    }

    /// What the velocity of each moving joint is called; where it has several, what stands before theirs.
    pub fn velocity_names(&self) -> &[String] {
        &self.names.velocities
    }

    /// Names of the moving joints.
    pub fn joint_names(&self) -> &[String] {
        &self.names.joints
    }

    /// Index of the moving joint called `name`.
    pub fn joint_index(&self, name: &str) -> Option<usize> {
        self.names.joints.iter().position(|other| other == name)
    }

    /// Whether a fixed joint is called `name`.
    pub fn has_fixed_joint(&self, name: &str) -> bool {
        self.names.fixed_joints.iter().any(|other| other == name)
    }

    /// What the coordinates of moving joint `joint` may be.
    pub fn joint_space(&self, joint: usize) -> Space {
        self.spaces[joint]
    }

    /// The described joint that moving joint `joint` is or is part of.
    pub fn described_joint(&self, joint: usize) -> &DescribedJoint {
        &self.described[self.described_as[joint]]
    }

    /// The joints that move as they are described, in their order.
    pub fn described_joints(&self) -> &[DescribedJoint] {
        &self.described
    }

    /// Whether a joint that moves, or a coordinate of one, is called `name`.
    pub fn has_joint(&self, name: &str) -> bool {
        self.joint_index(name).is_some() || self.described.iter().any(|joint| joint.name == name)
    }

    /// Where moving joint `joint` finds its coordinates in q: those of the joint that it follows, if it follows one.
    pub fn q_range(&self, joint: usize) -> Range<usize> {
        let first = self.numbering.coordinates[joint].q;
        first..first + self.spaces[joint].nq()
    }

    /// Where moving joint `joint` finds its velocities in v: those of the joint that it follows, if it follows one.
    pub fn v_range(&self, joint: usize) -> Range<usize> {
        let first = self.numbering.coordinates[joint].v;
        first..first + self.spaces[joint].nv()
    }

    /// The joint with coordinates of its own that moving joint `joint` follows, and the ratio and offset of
    /// coordinate = ratio · its coordinate + offset; `None` for a joint with coordinates of its own.
    pub fn followed(&self, joint: usize) -> Option<(usize, f64, f64)> {
        let Coordinates { ratio, offset, .. } = self.numbering.coordinates[joint];
        self.numbering.followed[joint].map(|leader| (leader, ratio, offset))
    }

    /// Whether every joint has coordinates of its own.
    pub fn is_free_of_followers(&self) -> bool {
        self.numbering.followed.iter().all(Option::is_none)
    }

    /// Whether every joint has one degree of freedom, so that v = dq/dt and Christoffel symbols exist.
    pub fn is_one_degree(&self) -> bool {
        self.spaces.iter().all(|space| space.nv() == 1)
    }

    /// What moving joint `joint` is built for.
    pub fn limits(&self, joint: usize) -> &Limits {
        &self.limits[joint]
    }

    /// The described body on moving joint `joint`.
    pub fn joint_body(&self, joint: usize) -> usize {
        self.bodies_of_joints[joint]
    }

    /// Inertia of rotors as felt along each velocity, kg·m² or kg (nv): on the diagonal of the mass matrix.
    #[inline]
    pub fn rotors(&self) -> &[f64] {
        &self.drivetrain.rotors
    }

    /// [`Self::rotors`]; nothing where there is none.
    #[inline]
    pub(crate) fn felt_rotors(&self) -> &[f64] {
        if self.drivetrain.has_rotors { &self.drivetrain.rotors } else { &[] }
    }

    /// Inertia of the rotor per moving joint as felt along its coordinate, kg·m² or kg.
    pub fn armature(&self) -> &[f64] {
        &self.drivetrain.armature
    }

    /// Viscous damping per moving joint, N·m·s/rad or N·s/m; no algorithm of `dynamics` adds it by itself.
    pub fn damping(&self) -> &[f64] {
        &self.drivetrain.damping
    }

    /// Coulomb friction per moving joint, N·m or N; no algorithm of `dynamics` adds it by itself.
    pub fn friction(&self) -> &[f64] {
        &self.drivetrain.friction
    }

    /// What the friction of each moving joint does at and near rest.
    pub fn friction_laws(&self) -> &[FrictionLaw] {
        &self.drivetrain.friction_laws
    }

    /// Names of the described bodies, in the order in which they were pushed.
    pub fn body_names(&self) -> &[String] {
        &self.names.bodies
    }

    /// Their inertias, about the origins of their joints' frames and in their axes.
    pub fn body_inertias(&self) -> &[Inertia] {
        &self.masses.bodies
    }

    /// Their links, and where they are in these.
    pub(crate) fn frames(&self) -> &[Frame] {
        &self.frames
    }

    /// Index of the body called `name`.
    pub fn body_index(&self, name: &str) -> Option<usize> {
        self.names.body_lookup.get(name).copied()
    }

    /// The body called `name`, or the world: "world", or the root link of a robot on a fixed base.
    pub fn find_body(&self, name: &str) -> Option<Parent> {
        let world = name == "world" || self.names.worlds.iter().any(|other| other == name);
        self.body_index(name).map(Parent::Body).or(world.then_some(Parent::World))
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

    /// A frame with its origin at the anchor, turned by `rotation` against the axes of the anchor's body.
    ///
    /// # Errors
    /// As [`Self::resolve`].
    pub fn resolve_frame(&self, anchor: &Anchor, rotation: &Rotation) -> Result<Frame, ModelError> {
        let Site { link, point } = self.resolve(anchor)?;
        let rotation = self.frame(anchor.body)?.placement.rotation * *rotation;
        Ok(Frame { link, placement: Placement { rotation, translation: point } })
    }

    /// How far from the world's origin a frame's origin is where all joints that shift stand at 0, at most, m.
    pub(crate) fn reach(&self, frame: &Frame) -> f64 {
        let (mut reach, mut link) = (frame.placement.translation.norm(), frame.link);
        while let Some(joint) = link.checked_sub(1) {
            reach += self.placements[joint].translation.norm();
            link = self.parents[joint];
        }
        reach
    }

    /// The same robot with other inertias, whatever they are: of every described body that about the origin of its joint's frame and in its axes, and
    /// the armature of every moving joint. Of inertias that are differences it gives the differences of whatever is linear in them.
    ///
    /// # Panics
    /// Where there are more or fewer of them.
    #[must_use]
    pub fn with_inertias(&self, bodies: &[Inertia], armature: &[f64]) -> Self {
        assert_eq!((bodies.len(), armature.len()), (self.frames.len(), self.joint_count()), "bodies and joints");
        let mut model = self.clone();
        model.masses.inertias.fill(Inertia::ZERO);
        model.masses.bodies = bodies.to_vec();
        for (frame, inertia) in self.frames.iter().zip(bodies).filter(|(frame, _)| frame.link > 0) {
            model.masses.inertias[frame.link - 1] += inertia.to_parent(&frame.placement);
        }
        model.masses.collect_subtrees(&model.parents);
        model.drivetrain.armature = armature.to_vec();
        model.drivetrain.collect_rotors(&model.numbering, &model.spaces);
        model
    }

    /// The same robot in another field of gravity, m/s², world axes.
    #[must_use]
    pub fn with_gravity(&self, gravity: [f64; 3]) -> Self {
        Self { gravity, ..self.clone() }
    }

    /// The link that moving joint `joint` hangs on; 0 is the world, joint j moves link j + 1.
    #[inline]
    pub fn parent_link(&self, joint: usize) -> usize {
        self.parents[joint]
    }

    /// Inertia of the link that `joint` moves, about the origin of the link's frame and in its axes.
    #[inline]
    pub fn link_inertia(&self, joint: usize) -> &Inertia {
        &self.masses.inertias[joint]
    }

    /// Mass of all that `joint` carries, kg.
    #[inline]
    pub fn subtree_mass(&self, joint: usize) -> f64 {
        self.masses.subtrees[joint]
    }

    /// Of the velocities `v` (nv) those that are angular, rad/s.
    pub(crate) fn turning<'a>(&'a self, v: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        let turns = self.tree.degrees.iter().filter(|degree| !matches!(degree.motion, DegreeMotion::Shift(_)));
        turns.map(|degree| degree.ratio * v[degree.index])
    }

    /// Whether a link has a negative principal moment, as [`ModelBuilder::accept_inertia`](super::ModelBuilder::accept_inertia)
    /// lets it have, so that the mass matrix may not be positive definite everywhere.
    #[inline]
    pub fn may_be_indefinite(&self) -> bool {
        self.masses.may_be_indefinite
    }

    /// The link frame of `joint` in the frame of its parent link where the joint stands at 0 (a floating one: at the origin,
    /// unturned).
    #[inline]
    pub fn joint_placement(&self, joint: usize) -> &Placement {
        &self.placements[joint]
    }

    #[inline]
    pub(crate) fn motion(&self, joint: usize) -> JointMotion {
        self.motions[joint]
    }

    /// Shift of helical joint `joint`, m/rad.
    #[inline]
    pub(crate) fn pitch(&self, joint: usize) -> f64 {
        self.pitches[joint]
    }

    #[inline]
    pub(crate) fn coordinates(&self, joint: usize) -> &Coordinates {
        &self.numbering.coordinates[joint]
    }

    #[inline]
    pub(crate) fn degrees(&self) -> &[Degree] {
        &self.tree.degrees
    }

    /// The degrees of moving joint `joint`.
    #[inline]
    pub(crate) fn degrees_of(&self, joint: usize) -> Range<usize> {
        // Links stand in the order of their joints, and each has a degree at least.
        self.tree.last_degrees[joint]..self.tree.last_degrees[joint + 1]
    }

    /// One more than the degree that carries degree `k`, or 0.
    #[inline]
    pub(crate) fn carrier(&self, k: usize) -> usize {
        self.tree.carriers[k]
    }

    /// One more than the last degree on the way to `link`, or 0.
    #[inline]
    pub(crate) fn last_degree(&self, link: usize) -> usize {
        self.tree.last_degrees[link]
    }

    /// One more than the last velocity whose elimination touches velocity `i`, `i` among them.
    #[inline]
    pub(crate) fn subtree_end(&self, i: usize) -> usize {
        self.tree.ends[i]
    }

    /// The velocities whose elimination touches velocity `i`, but `i`, from the last one inwards.
    #[inline(always)]
    pub(crate) fn carried(&self, i: usize) -> impl Iterator<Item = usize> + Clone + '_ {
        (i + 1..self.tree.ends[i]).rev().filter(move |k| self.tree.is_depth_first || self.touches(*k, i))
    }

    /// Whether rows of the mass matrix are full enough to be worked on several columns at a time.
    pub(crate) fn is_deep(&self) -> bool {
        self.tree.is_deep
    }

    /// Whether the elimination of velocity `k` touches velocity `i`.
    #[cold]
    fn touches(&self, mut k: usize, i: usize) -> bool {
        while k > i {
            match self.tree.pivots[k].checked_sub(1) {
                Some(inner) => k = inner,
                None => return false,
            }
        }
        k == i
    }

    /// One more than the velocity that the elimination of velocity `i` touches next, or 0.
    #[inline]
    pub(crate) fn pivot(&self, i: usize) -> usize {
        self.tree.pivots[i]
    }
}
