//! Forward kinematics: where the links are and how they move.

use super::joint::{self, Stands};
use crate::model::{Frame, Model, Site};
use crate::spatial::{Motion, Placement, Scalar, Vec3};

/// How far the last update went.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Level {
    Position,
    Velocity,
    Acceleration,
}

/// Placements, velocities and accelerations of all links in one state, in world axes.
///
/// Velocities are needed by point velocities, Jacobian rates, pairs and the kinetic energy, accelerations by point
/// accelerations alone. Reading further than the last update went is a programming error (a debug assertion).
#[derive(Debug, Clone)]
pub struct Kinematics<T = f64> {
    level: Level,
    // Indexed by link; 0 is the world and never moves.
    placements: Vec<Placement<T>>,
    // Of every joint, its link in the parent's.
    locals: Vec<Placement<T>>,
    /// ω, and the velocity of the link's origin.
    velocities: Vec<Motion<T>>,
    /// dω/dt, and the acceleration of the link's origin (the second derivative of its position).
    accelerations: Vec<Motion<T>>,
    joint_velocities: Vec<T>,
    stands: Stands<T>,
}

impl<T: Scalar> Kinematics<T> {
    /// The robot in its neutral configuration, positions only.
    pub fn new(model: &Model) -> Self {
        Self::neutral(model)
    }

    /// [`Self::new`], inlined.
    #[inline(always)]
    pub(super) fn neutral(model: &Model) -> Self {
        let n = model.joint_count();
        let mut kinematics = Self {
            level: Level::Position,
            placements: vec![Placement::IDENTITY; n + 1],
            locals: vec![Placement::IDENTITY; n],
            velocities: vec![Motion::ZERO; n + 1],
            accelerations: vec![Motion::ZERO; n + 1],
            joint_velocities: vec![T::ZERO; model.nv()],
            stands: Stands::new(model),
        };
        let mut neutral = vec![T::ZERO; model.nq()];
        for (coordinate, number) in neutral.iter_mut().zip(model.neutral()) {
            *coordinate = T::from_f64(number);
        }
        kinematics.place(model, &neutral);
        kinematics
    }

    /// The robot at `q` (nq).
    pub fn at_position(model: &Model, q: &[T]) -> Self {
        let mut kinematics = Self::new(model);
        kinematics.update_position(model, q);
        kinematics
    }

    /// The robot at `q` (nq) with velocities `v` (nv).
    pub fn at_velocity(model: &Model, q: &[T], v: &[T]) -> Self {
        let mut kinematics = Self::new(model);
        kinematics.update_velocity(model, q, v);
        kinematics
    }

    /// The robot at `q` (nq) with velocities `v` (nv) and accelerations `a` (nv).
    pub fn at_acceleration(model: &Model, q: &[T], v: &[T], a: &[T]) -> Self {
        let mut kinematics = Self::new(model);
        kinematics.update_acceleration(model, q, v, a);
        kinematics
    }

    /// Of every joint, the placement of its link in the parent's.
    #[inline(always)]
    pub(super) fn locals(&self) -> &[Placement<T>] {
        &self.locals
    }

    /// World placements of all links, the world first.
    #[inline(always)]
    pub(super) fn placements(&self) -> &[Placement<T>] {
        &self.placements
    }

    /// Moves to `q` (nq): placements alone. Does not allocate.
    pub fn update_position(&mut self, model: &Model, q: &[T]) {
        self.place(model, q);
    }

    /// Moves to `q` (nq) with velocities `v` (nv). Does not allocate.
    ///
    /// With r from the parent link's origin to the joint's: ω = ω_p + e q̇, ṗ = ṗ_p + ω_p × r (revolute); ω = ω_p,
    /// ṗ = ṗ_p + ω_p × r + e q̇ (prismatic); ω = ω_p + R ω_J, ṗ = ṗ_p + ω_p × r + R u_J (floating, with its twist (u_J, ω_J) in
    /// the link's axes).
    pub fn update_velocity(&mut self, model: &Model, q: &[T], v: &[T]) {
        self.set_moving(model, q, v);
    }

    /// Moves to `q` (nq) with velocities `v` (nv) and accelerations `a` (nv). Does not allocate.
    ///
    /// ω̇ = ω̇_p + ω_p × e q̇ + e q̈, p̈ = p̈_p + ω̇_p × r + ω_p × (ω_p × r) (revolute); ω̇ = ω̇_p, p̈ the same
    /// + 2 ω_p × e q̇ + e q̈ (prismatic); ω̇ = ω̇_p + ω_p × R ω_J + R ω̇_J, p̈ the same + (ω_p + ω) × R u_J + R u̇_J (floating).
    pub fn update_acceleration(&mut self, model: &Model, q: &[T], v: &[T], a: &[T]) {
        self.set_accelerating(model, q, v, a);
    }

    /// [`Self::update_position`], inlined.
    #[inline(always)]
    pub(super) fn place(&mut self, model: &Model, q: &[T]) {
        self.level = Level::Position;
        let (n, q) = (model.joint_count(), &q[..model.nq()]);
        assert_eq!(self.placements.len(), n + 1, "the kinematics are of another model");
        self.stands.read(model, q);
        let mut last = self.placements[0];
        for j in 0..n {
            let parent = model.parent_link(j);
            // Along a chain the link before is still at hand.
            if parent != j {
                last = self.placements[parent];
            }
            let local = self.stands.placement(model, j, q);
            last = last * local;
            (self.locals[j], self.placements[j + 1]) = (local, last);
        }
    }

    /// [`Self::update_velocity`], inlined.
    #[inline(always)]
    pub(super) fn set_moving(&mut self, model: &Model, q: &[T], v: &[T]) {
        self.place(model, q);
        self.level = Level::Velocity;
        let v = &v[..model.nv()];
        self.joint_velocities.copy_from_slice(v);
        for j in 0..model.joint_count() {
            let parent = model.parent_link(j);
            let link = &self.placements[j + 1];
            let arm = link.translation - self.placements[parent].translation;
            let Motion { angular, linear } = self.velocities[parent];
            let carried = Motion { angular, linear: linear + angular.cross(arm) };
            self.velocities[j + 1] = joint::velocity(model, j, link, carried, v);
        }
    }

    /// [`Self::update_velocity`] of a robot of which joints stand still, where they stood when this was made, but where `moves` says so, velocity by
    /// velocity.
    #[inline(always)]
    pub(crate) fn update_velocity_of_moving(&mut self, model: &Model, q: &[T], v: &[T], moves: &[bool]) {
        self.level = Level::Velocity;
        let (n, q, v) = (model.joint_count(), &q[..model.nq()], &v[..model.nv()]);
        self.stands.read(model, q);
        self.joint_velocities.copy_from_slice(v);
        for j in 0..n {
            let (parent, moves) = (model.parent_link(j), moves[model.coordinates(j).v]);
            if moves {
                self.locals[j] = self.stands.placement(model, j, q);
            }
            let (Placement { rotation, translation }, local) = (self.placements[parent], &self.locals[j]);
            let arm = rotation * local.translation;
            let link = Placement { rotation: rotation * local.rotation, translation: translation + arm };
            let Motion { angular, linear } = self.velocities[parent];
            let carried = Motion { angular, linear: linear + angular.cross(arm) };
            self.velocities[j + 1] = if moves { joint::velocity(model, j, &link, carried, v) } else { carried };
            self.placements[j + 1] = link;
        }
    }

    /// [`Self::update_acceleration`], inlined.
    #[inline(always)]
    pub(super) fn set_accelerating(&mut self, model: &Model, q: &[T], v: &[T], a: &[T]) {
        self.set_moving(model, q, v);
        self.level = Level::Acceleration;
        let (v, a) = (&v[..model.nv()], &a[..model.nv()]);
        for j in 0..model.joint_count() {
            let parent = model.parent_link(j);
            let link = &self.placements[j + 1];
            let arm = link.translation - self.placements[parent].translation;
            let omega = self.velocities[parent].angular;
            let Motion { angular, linear } = self.accelerations[parent];
            let carried = Motion { angular, linear: linear + angular.cross(arm) + omega.cross(omega.cross(arm)) };
            self.accelerations[j + 1] = joint::acceleration(model, j, link, (carried, omega), [v, a]);
        }
    }

    /// World placement of `link` (0 is the world, joint j moves link j + 1).
    #[inline(always)]
    pub fn link(&self, link: usize) -> &Placement<T> {
        &self.placements[link]
    }

    /// World placement of a body's joint frame; its `rotation` takes body components to world components.
    #[inline(always)]
    pub fn frame(&self, frame: &Frame) -> Placement<T> {
        self.placements[frame.link()] * Placement::from_f64(frame.placement())
    }

    /// World position r_P of a point, m.
    #[inline(always)]
    pub fn position(&self, site: &Site) -> Vec3<T> {
        self.placements[site.link()].point(Vec3::from_f64(site.point()))
    }

    /// World velocity dr_P/dt of a point, m/s.
    #[inline(always)]
    pub fn velocity(&self, site: &Site) -> Vec3<T> {
        self.velocity_at(site.link(), self.arm(site))
    }

    /// World acceleration d²r_P/dt² of a point, m/s² (gravity is no part of it).
    #[inline(always)]
    pub fn acceleration(&self, site: &Site) -> Vec3<T> {
        let Motion { angular, linear } = self.link_acceleration(site.link());
        let (omega, arm) = (self.velocities[site.link()].angular, self.arm(site));
        linear + angular.cross(arm) + omega.cross(omega.cross(arm))
    }

    /// ω, rad/s, and velocity of the origin, m/s, of `link` in world axes.
    #[inline(always)]
    pub fn link_velocity(&self, link: usize) -> Motion<T> {
        debug_assert!(self.level >= Level::Velocity, "the kinematics hold positions only");
        self.velocities[link]
    }

    /// dω/dt, rad/s², and acceleration of the origin, m/s², of `link` in world axes.
    #[inline(always)]
    pub fn link_acceleration(&self, link: usize) -> Motion<T> {
        debug_assert!(self.level >= Level::Acceleration, "the kinematics hold no accelerations");
        self.accelerations[link]
    }

    /// The joint velocities of the last update.
    #[inline(always)]
    pub fn joint_velocities(&self) -> &[T] {
        debug_assert!(self.level >= Level::Velocity, "the kinematics hold positions only");
        &self.joint_velocities
    }

    /// Where moving joint `joint` stands, rad or m; of one that follows another, ratio · its coordinate + offset. Without
    /// meaning for a floating joint.
    #[inline(always)]
    pub fn joint_coordinate(&self, joint: usize) -> T {
        self.stands.coordinate(joint)
    }

    /// From the origin of the point's link to the point, world axes.
    #[inline(always)]
    pub(super) fn arm(&self, site: &Site) -> Vec3<T> {
        self.placements[site.link()].rotation * Vec3::from_f64(site.point())
    }

    #[inline(always)]
    fn velocity_at(&self, link: usize, arm: Vec3<T>) -> Vec3<T> {
        let Motion { angular, linear } = self.link_velocity(link);
        linear + angular.cross(arm)
    }
}
