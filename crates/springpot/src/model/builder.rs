//! From a described robot to a [`Model`].

use std::collections::HashMap;
use std::f64::consts::TAU;

use super::degree::JointMotion;
use super::error::{Field, ModelError};
use super::frame::Frame;
use super::kind::Move;
use super::robot::{DescribedJoint, Model};
use super::spec::{BodySpec, JointPart, JointSpec, Mimic, Parent};
use super::validate::Rules;
use super::{mass_check, numbering, validate};
use crate::spatial::{Inertia, Placement, Rotation, Symmetric3, Vec3};

/// Builds a [`Model`] body by body, parents first.
///
/// Axes are turned to z and fixed joints are merged into the moving body that carries them (or into the world); the merged
/// bodies keep their names and frames.
#[derive(Debug, Clone)]
pub struct ModelBuilder {
    model: Model,
    rules: Rules,
    takes_any_inertia: bool,
    takes_idle_joints: bool,
    /// Body of each joint name, fixed joints included.
    joint_lookup: HashMap<String, usize>,
    /// What each moving joint follows.
    mimics: Vec<Option<Mimic>>,
}

impl ModelBuilder {
    /// A robot without bodies, in the uniform field `gravity`, m/s², world axes.
    pub fn new(gravity: [f64; 3]) -> Self {
        Self::with_rules(gravity, Rules::Body)
    }

    /// As [`ModelBuilder::new`], for links of a URDF: names may be any text, and a link may have a principal moment above the
    /// sum of the others, as long as each moving link together with what is fixed to it has not.
    pub fn of_urdf(gravity: [f64; 3]) -> Self {
        Self::with_rules(gravity, Rules::UrdfLink)
    }

    fn with_rules(gravity: [f64; 3], rules: Rules) -> Self {
        Self {
            model: Model::empty(gravity),
            rules,
            takes_any_inertia: false,
            takes_idle_joints: false,
            joint_lookup: HashMap::new(),
            mimics: Vec::new(),
        }
    }

    /// Gives the world another name besides "world": that of the root link of a robot on a fixed base.
    pub fn name_world(&mut self, name: impl Into<String>) {
        self.model.names.worlds.push(name.into());
    }

    /// Takes inertias that no distribution of mass has as they are, as other programs do: principal moments below 0, or above the
    /// sum of the others. What must be positive definite all the same is the mass matrix: where a link has a negative moment,
    /// [`ModelBuilder::finish`] looks at one generic configuration, and what integrates the motion at those that it meets.
    pub fn accept_inertia(&mut self) {
        self.takes_any_inertia = true;
    }

    /// Takes robots whose mass matrix is singular in every configuration: joints that carry no mass. Their forces follow from a motion as of any
    /// robot; no motion follows from forces.
    pub fn accept_idle_joints(&mut self) {
        self.takes_idle_joints = true;
    }

    /// Adds a body and returns its index.
    ///
    /// # Errors
    /// Names that are not unique identifiers, a parent that is not earlier, numbers that are not finite, a zero axis, a
    /// negative mass, damping or friction, a speed of friction that is not positive, an inertia that no mass distribution has: a principal moment below −1e-12 of the
    /// largest, or the largest above the sum of the others by more than 1e-9 of itself. The builder is then as it was.
    pub fn push(&mut self, spec: BodySpec) -> Result<usize, ModelError> {
        let body = self.model.names.bodies.len();
        validate::body(body, &spec, self.rules, self.takes_any_inertia)?;
        if let Some(&first) = self.model.names.body_lookup.get(&spec.name) {
            return Err(ModelError::DuplicateName { body, field: Field::Name, name: spec.name, first });
        }
        let coordinates = spec.joint.kind.numbers().filter(|(part, _)| !part.is_empty());
        let names: Vec<String> = coordinates.map(|(part, _)| format!("{}.{part}", spec.joint.name)).collect();
        let names: Vec<String> = names.into_iter().chain([spec.joint.name.clone()]).collect();
        if let Some((name, &first)) = names.iter().find_map(|name| self.joint_lookup.get_key_value(name)) {
            let name = name.clone();
            return Err(ModelError::DuplicateName { body, field: Field::JointName, name, first });
        }
        self.joint_lookup.extend(names.into_iter().map(|name| (name, body)));

        let parent = match spec.parent {
            Parent::World => Frame::WORLD,
            Parent::Body(index) => self.model.frames[index],
        };
        let joint = spec.joint;
        let offset = Placement { rotation: Rotation::from_rpy(joint.rpy), translation: joint.origin.into() };
        let in_parent_link = parent.placement * offset;
        let frame = self.add_joint(parent.link, in_parent_link, joint, body);
        let model = &mut self.model;
        let own = Inertia::from_central(spec.mass, spec.com.into(), Symmetric3::from_upper(spec.inertia));
        model.masses.bodies.push(own);
        // What is fixed to the world has no part in the dynamics.
        if frame.link > 0 {
            model.masses.inertias[frame.link - 1] += own.to_parent(&frame.placement);
        }
        model.frames.push(frame);
        model.names.body_lookup.insert(spec.name.clone(), body);
        model.names.bodies.push(spec.name);
        Ok(body)
    }

    /// Appends the joints that a described joint is, each with its link, and returns the frame of its body.
    fn add_joint(&mut self, parent_link: usize, in_parent_link: Placement, joint: JointSpec, body: usize) -> Frame {
        let parts = joint.parts();
        let mut frame = Frame { link: parent_link, placement: in_parent_link };
        let first = self.model.motions.len();
        for (k, part) in parts.iter().enumerate() {
            frame = self.add_link(frame, part, k, &joint, body);
        }
        let model = &mut self.model;
        if parts.is_empty() {
            model.names.fixed_joints.push(joint.name);
        } else {
            let joints = first..first + parts.len();
            model.described.push(DescribedJoint { name: joint.name, kind: joint.kind, joints });
        }
        frame
    }

    /// Appends part `k` of a joint, whose frame stands at `at` where its coordinate is 0, and returns where the frame is in the
    /// new link.
    fn add_link(&mut self, at: Frame, part: &JointPart, k: usize, joint: &JointSpec, body: usize) -> Frame {
        let to_z = match part.moves {
            Move::Turn | Move::Shift | Move::Screw => Rotation::with_z_axis(Vec3(part.axis)),
            Move::Ball | Move::Pose => Rotation::IDENTITY,
        };
        let model = &mut self.model;
        model.motions.push(match part.moves {
            Move::Turn => JointMotion::Revolute,
            Move::Shift => JointMotion::Prismatic,
            Move::Screw => JointMotion::Helical,
            Move::Ball => JointMotion::Spherical,
            Move::Pose => JointMotion::Floating,
        });
        model.pitches.push(joint.lead / TAU);
        model.spaces.push(part.space);
        model.described_as.push(model.described.len());
        model.parents.push(at.link);
        model.placements.push(at.placement * Placement { rotation: to_z, translation: Vec3::ZERO });
        model.masses.inertias.push(Inertia::ZERO);
        model.bodies_of_joints.push(body);
        model.names.joints.push(part.name.clone());
        model.names.velocities.push(part.velocity.clone());
        // What a joint without numbers for coordinates says of these has no meaning.
        let is_number = part.space.dimension().is_some();
        model.drivetrain.damping.push(if is_number { joint.damping[k] } else { 0.0 });
        model.drivetrain.friction.push(if is_number { joint.friction[k] } else { 0.0 });
        model.drivetrain.armature.push(if is_number { joint.armature[k] } else { joint.armature_all });
        model.drivetrain.friction_laws.push(joint.friction_law[k]);
        model.limits.push(joint.limits[k]);
        self.mimics.push(joint.mimic.clone());
        Frame {
            link: model.motions.len(),
            placement: Placement { rotation: to_z.transpose(), translation: Vec3::ZERO },
        }
    }

    /// The finished robot.
    ///
    /// # Errors
    /// No bodies; gravity not finite; a joint that follows one that does not exist, follows itself in a circle, or has (or
    /// follows a joint that has) more or less than one degree of freedom; of a URDF, a moving link that, with all that is
    /// fixed to it, has an inertia that no mass distribution has and that was not accepted; a mass matrix that is singular in every configuration (a
    /// joint that can move without moving mass is named) or, with accepted inertias, not positive in a generic one; overflow of the combined inertias.
    pub fn finish(self) -> Result<Model, ModelError> {
        let mut model = self.model;
        if model.names.bodies.is_empty() {
            return Err(ModelError::NoBodies);
        }
        if let Some(component) = model.gravity.iter().position(|g| !g.is_finite()) {
            return Err(ModelError::GravityNotFinite { component, value: model.gravity[component] });
        }
        numbering::number(&mut model, &self.mimics)?;
        if self.rules == Rules::UrdfLink || self.takes_any_inertia {
            model.masses.may_be_indefinite = mass_check::links(&model, self.takes_any_inertia)?;
        }
        if !self.takes_idle_joints {
            mass_check::positive_definite(&model)?;
        }
        model.masses.collect_subtrees(&model.parents);
        Ok(model)
    }
}
