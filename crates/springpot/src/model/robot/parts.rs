//! What a [`Model`](crate::model::Model) is made of, by what is handed on together.

use crate::model::degree::{Coordinates, Degree};
use crate::model::kind::Space;
use crate::model::spec::FrictionLaw;
use crate::spatial::Inertia;
use std::collections::BTreeMap;

/// How q and v are numbered: one entry per joint, indexed by j, but for `places`.
#[derive(Debug, Clone, Default)]
pub(in crate::model) struct Numbering {
    pub(in crate::model) nq: usize,
    pub(in crate::model) nv: usize,
    pub(in crate::model) coordinates: Vec<Coordinates>,
    /// The coordinate that each velocity moves; none for those of joints of several degrees.
    pub(in crate::model) places: Vec<Option<usize>>,
    pub(in crate::model) followed: Vec<Option<usize>>,
}

/// The degrees of freedom and the tree that they make, indexed by k; those of joint j follow those of joint j − 1.
#[derive(Debug, Clone)]
pub(in crate::model) struct DegreeTree {
    pub(in crate::model) degrees: Vec<Degree>,
    /// One more than the degree that carries degree k, or 0 where the world does.
    pub(in crate::model) carriers: Vec<usize>,
    /// One more than the last degree of each link, with the world's 0 first; where a link has none, its carrier's.
    pub(in crate::model) last_degrees: Vec<usize>,
    /// One more than the velocity that the elimination of velocity i touches next, or 0.
    pub(in crate::model) pivots: Vec<usize>,
    /// One more than the last velocity whose elimination touches velocity i, itself among them.
    pub(in crate::model) ends: Vec<usize>,
    /// Whether all velocities up to there do.
    pub(in crate::model) is_depth_first: bool,
    /// Whether the elimination of a velocity touches eight others or more, in the mean.
    pub(in crate::model) is_deep: bool,
}

/// What moves with the links, one entry per joint.
#[derive(Debug, Clone, Default)]
pub(in crate::model) struct Masses {
    pub(in crate::model) inertias: Vec<Inertia>,
    /// Of the described bodies, about the origins of their joints' frames and in their axes.
    pub(in crate::model) bodies: Vec<Inertia>,
    /// Of all that a joint carries, kg.
    pub(in crate::model) subtrees: Vec<f64>,
    pub(in crate::model) may_be_indefinite: bool,
}

/// What turns and rubs inside the joints, one entry per joint.
#[derive(Debug, Clone, Default)]
pub(in crate::model) struct Drivetrain {
    pub(in crate::model) armature: Vec<f64>,
    pub(in crate::model) damping: Vec<f64>,
    pub(in crate::model) friction: Vec<f64>,
    pub(in crate::model) friction_laws: Vec<FrictionLaw>,
    /// Armature felt along each velocity.
    pub(in crate::model) rotors: Vec<f64>,
    pub(in crate::model) has_rotors: bool,
}

/// What everything is called.
#[derive(Debug, Clone, Default)]
pub(in crate::model) struct Names {
    /// Of the joints that move.
    pub(in crate::model) joints: Vec<String>,
    /// What the velocity of each of them, or the joint before the names of several, is called.
    pub(in crate::model) velocities: Vec<String>,
    pub(in crate::model) fixed_joints: Vec<String>,
    pub(in crate::model) bodies: Vec<String>,
    pub(in crate::model) body_lookup: BTreeMap<String, usize>,
    /// What the world is called besides "world".
    pub(in crate::model) worlds: Vec<String>,
}

impl Masses {
    /// Adds up what the joints carry, whose links hang on `parents`.
    pub(in crate::model) fn collect_subtrees(&mut self, parents: &[usize]) {
        self.subtrees = self.inertias.iter().map(|inertia| inertia.mass).collect();
        for j in (0..self.subtrees.len()).rev() {
            if let Some(parent) = parents[j].checked_sub(1) {
                self.subtrees[parent] += self.subtrees[j];
            }
        }
    }
}

impl Drivetrain {
    /// Adds up the armatures felt along `nv` velocities, those of followers through their leaders; of a joint of several velocities each feels it.
    pub(in crate::model) fn collect_rotors(&mut self, numbering: &Numbering, spaces: &[Space]) {
        self.rotors = vec![0.0; numbering.nv];
        for ((own, space), armature) in numbering.coordinates.iter().zip(spaces).zip(&self.armature) {
            let felt = &mut self.rotors[own.v..own.v + space.nv()];
            felt.iter_mut().for_each(|rotor| *rotor += own.ratio * own.ratio * armature);
        }
        self.has_rotors = self.rotors.iter().any(|rotor| *rotor != 0.0);
    }
}

impl DegreeTree {
    /// That of the world alone.
    pub(in crate::model) fn of_the_world() -> Self {
        Self {
            degrees: Vec::new(),
            carriers: Vec::new(),
            last_degrees: vec![0],
            pivots: Vec::new(),
            ends: Vec::new(),
            is_depth_first: true,
            is_deep: false,
        }
    }

    /// Works out what lies beyond each velocity from the pivots.
    pub(in crate::model) fn collect_ends(&mut self) {
        let n = self.pivots.len();
        let mut counts = vec![1; n];
        self.ends = (1..=n).collect();
        for k in (0..n).rev() {
            if let Some(inner) = self.pivots[k].checked_sub(1) {
                counts[inner] += counts[k];
                self.ends[inner] = self.ends[inner].max(self.ends[k]);
            }
        }
        self.is_depth_first = (0..n).all(|i| self.ends[i] - i == counts[i]);
        self.is_deep = counts.iter().sum::<usize>() >= 9 * n.max(1);
    }
}
