//! From a described robot to a [`Model`].

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use super::degree::JointMotion;
use super::error::{Field, ModelError};
use super::frame::Frame;
use super::robot::Model;
use super::spec::{BodySpec, JointSpec, Mimic, Parent};
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
            joint_lookup: HashMap::new(),
            mimics: Vec::new(),
        }
    }

    /// Gives the world another name besides "world": that of the root link of a robot on a fixed base.
    pub fn name_world(&mut self, name: impl Into<String>) {
        self.model.world_names.push(name.into());
    }

    /// Takes inertias that no distribution of mass has as they are, as other programs do: principal moments below 0, or above the
    /// sum of the others. What must be positive definite all the same is the mass matrix: where a link has a negative moment,
    /// [`ModelBuilder::finish`] looks at one generic configuration, and what integrates the motion at those that it meets.
    pub fn accept_inertia(&mut self) {
        self.takes_any_inertia = true;
    }

    /// Adds a body and returns its index.
    ///
    /// # Errors
    /// Names that are not unique identifiers, a parent that is not earlier, numbers that are not finite, a zero axis, a
    /// negative mass, damping or friction, a speed of friction that is not positive, an inertia that no mass distribution has: a principal moment below −1e-12 of the
    /// largest, or the largest above the sum of the others by more than 1e-9 of itself. The builder is then as it was.
    pub fn push(&mut self, spec: BodySpec) -> Result<usize, ModelError> {
        let body = self.model.body_names.len();
        validate::body(body, &spec, self.rules, self.takes_any_inertia)?;
        if let Some(&first) = self.model.body_lookup.get(&spec.name) {
            return Err(ModelError::DuplicateName { body, field: Field::Name, name: spec.name, first });
        }
        match self.joint_lookup.entry(spec.joint.name.clone()) {
            Entry::Occupied(entry) => {
                let (name, first) = (spec.joint.name, *entry.get());
                return Err(ModelError::DuplicateName { body, field: Field::JointName, name, first });
            }
            Entry::Vacant(entry) => entry.insert(body),
        };

        let parent = match spec.parent {
            Parent::World => Frame::WORLD,
            Parent::Body(index) => self.model.frames[index],
        };
        let joint = spec.joint;
        let offset = Placement { rotation: Rotation::from_rpy(joint.rpy), translation: joint.origin.into() };
        let in_parent_link = parent.placement * offset;
        let frame = match joint.motion() {
            None => {
                self.model.fixed_joints.push(joint.name);
                Frame { link: parent.link, placement: in_parent_link }
            }
            Some(motion) => self.add_link(parent.link, in_parent_link, motion, joint, body),
        };
        let model = &mut self.model;
        // What is fixed to the world has no part in the dynamics.
        if frame.link > 0 {
            let central = Symmetric3::from_upper(spec.inertia);
            let own = Inertia::from_central(spec.mass, spec.com.into(), central);
            model.inertias[frame.link - 1] += own.to_parent(&frame.placement);
        }
        model.frames.push(frame);
        model.body_lookup.insert(spec.name.clone(), body);
        model.body_names.push(spec.name);
        Ok(body)
    }

    /// Appends a moving joint and returns the frame of its body.
    fn add_link(
        &mut self,
        parent_link: usize,
        in_parent_link: Placement,
        motion: JointMotion,
        joint: JointSpec,
        body: usize,
    ) -> Frame {
        let to_z = if joint.kind.has_axis() { Rotation::with_z_axis(unit(joint.axis)) } else { Rotation::IDENTITY };
        let model = &mut self.model;
        model.motions.push(motion);
        model.kinds.push(joint.kind);
        model.parents.push(parent_link);
        model.placements.push(in_parent_link * Placement { rotation: to_z, translation: Vec3::ZERO });
        model.inertias.push(Inertia::ZERO);
        model.bodies_of_joints.push(body);
        model.joint_names.push(joint.name);
        model.damping.push(joint.damping);
        model.friction.push(joint.friction);
        model.friction_laws.push(joint.friction_law);
        model.limits.push(joint.limits);
        self.mimics.push(joint.mimic);
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
        if model.body_names.is_empty() {
            return Err(ModelError::NoBodies);
        }
        if let Some(component) = model.gravity.iter().position(|g| !g.is_finite()) {
            return Err(ModelError::GravityNotFinite { component, value: model.gravity[component] });
        }
        numbering::number(&mut model, &self.mimics)?;
        if self.rules == Rules::UrdfLink || self.takes_any_inertia {
            model.may_be_indefinite = mass_check::links(&model, self.takes_any_inertia)?;
        }
        mass_check::positive_definite(&model)?;
        model.collect_subtree_masses();
        Ok(model)
    }
}

/// The direction of a vector that is not zero, safe from overflow and underflow.
fn unit(axis: [f64; 3]) -> Vec3 {
    let largest = axis.iter().fold(0.0, |s: f64, x| s.max(x.abs()));
    let scaled = Vec3(axis.map(|x| x / largest));
    let norm = scaled.norm();
    Vec3(scaled.0.map(|x| x / norm))
}
