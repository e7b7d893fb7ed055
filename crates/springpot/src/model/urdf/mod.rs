//! Robots from URDF files.
//!
//! [`Urdf::read`] turns a file into bodies as [`ModelBuilder`] takes them, and says what it left out. The format is
//! that of <https://wiki.ros.org/urdf/XML>; where it leaves a choice, urdfdom's is taken unless the doc comments here
//! say otherwise.
//!
//! ```
//! use springpot::model::urdf::{Urdf, UrdfOptions};
//!
//! let text = r#"<robot name="pendulum">
//!   <link name="stand"/>
//!   <link name="rod">
//!     <inertial>
//!       <origin xyz="0 0 -0.5"/>
//!       <mass value="2"/>
//!       <inertia ixx="0.17" ixy="0" ixz="0" iyy="0.17" iyz="0" izz="0.001"/>
//!     </inertial>
//!   </link>
//!   <joint name="pivot" type="continuous">
//!     <parent link="stand"/>
//!     <child link="rod"/>
//!     <axis xyz="0 1 0"/>
//!   </joint>
//! </robot>"#;
//! let urdf = Urdf::parse(text, None, &UrdfOptions::default())?;
//! assert_eq!(urdf.root.name, "stand");
//! let model = urdf.model([0.0, 0.0, -9.81])?;
//! assert_eq!(model.joint_names(), ["pivot"]);
//! # Ok::<(), springpot::model::urdf::UrdfError>(())
//! ```

mod error;
mod joint;
mod limit;
mod link;
mod mimic;
mod package;
mod problem;
mod reader;
mod robot;
mod source;
mod tree;
mod visual;
mod warning;

use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

pub use error::UrdfError;
pub use link::Inertial;
pub use package::MeshPlace;
pub use problem::{Owner, UrdfProblem};
pub use visual::{Visual, VisualShape};
pub use warning::{UrdfPlace, UrdfWarning, UrdfWarningKind};

use super::{BodySpec, Field, JointKind, Model, ModelBuilder, ModelError, Parent};

/// Name of the joint that lets the base float.
pub const FLOATING_BASE: &str = "floating_base";

/// How a URDF file is read.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct UrdfOptions {
    /// Whether the root link hangs on a floating joint called [`FLOATING_BASE`] instead of being the world.
    pub floating_base: bool,
    /// Whether mimic joints have a coordinate of their own; a warning lists them.
    pub ignore_mimic: bool,
    /// Whether inertias that no distribution of mass has are taken as they are; warnings list them.
    pub accept_inertia: bool,
    /// Folders that are packages or hold some, for `package://` after the ancestors of the file; relative ones count
    /// from the current folder. The environment (`ROS_PACKAGE_PATH`) is not read, so that the same files give the same
    /// answer everywhere.
    pub package_path: Vec<PathBuf>,
}

/// The link that is the child of no joint.
#[derive(Debug, Clone, PartialEq)]
pub struct RootLink {
    /// Its name.
    pub name: String,
    /// Its line, from 1.
    pub line: usize,
    /// Its mass and inertia, if it has some; on a fixed base they have no part in the dynamics.
    pub inertial: Option<Inertial>,
    /// What it looks like where it does not move; of a floating base that stands in [`Urdf::visuals`].
    pub visuals: Vec<Visual>,
}

/// Where a body stands in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BodyLines {
    /// Line of its `<link>`, from 1.
    pub link: usize,
    /// Line of the `<joint>` that carries it, from 1; that of the link for the floating base.
    pub joint: usize,
}

/// A robot as a URDF file describes it.
#[derive(Debug, Clone, PartialEq)]
pub struct Urdf {
    /// Name of the robot; empty, with a warning, where it has none.
    pub name: String,
    /// The file that was read, as it was given.
    pub file: Option<PathBuf>,
    /// The root link; on a fixed base it is the world.
    pub root: RootLink,
    /// Whether the base floats, as asked for.
    pub floating_base: bool,
    /// Whether inertias that no distribution of mass has are taken, as asked for.
    pub accept_inertia: bool,
    /// The links but the root, on their joints: parents first, depth first, siblings in the order of the file. On a
    /// floating base the root comes before them, on the joint [`FLOATING_BASE`].
    ///
    /// A link's frame is the frame of its joint. Of mimic joints, the one that is followed may come later; it has one
    /// degree, and no joints follow one another in a circle.
    pub bodies: Vec<BodySpec>,
    /// Where the bodies stand in the file.
    pub lines: Vec<BodyLines>,
    /// What the bodies look like, as far as that can be read.
    pub visuals: Vec<Vec<Visual>>,
    /// What was not used or was assumed, by kind, the weightiest first.
    pub warnings: Vec<UrdfWarning>,
}

impl Urdf {
    /// Reads a file.
    ///
    /// `<visual>`, `<collision>` and `<material>` have no part in the dynamics; shapes of `<visual>` that can be read are in [`Urdf::visuals`]. Mesh files that are not found, whatever
    /// else is not used, massless links on moving joints, and single links whose inertia breaks the triangle inequality
    /// are warnings.
    ///
    /// # Errors
    /// A file that cannot be read or is no UTF-8, no XML or no URDF; names that are missing, empty, not unique or
    /// reserved; links that are not one tree; types of joints besides fixed, revolute, continuous, prismatic and
    /// floating; numbers that are missing, too few, too many or not finite (limits may be `inf`); negative mass, damping
    /// or friction; on a moving joint, a principal moment below −1e-12 of the largest that is not accepted; the axis 0 0 0; mimic joints that
    /// follow no joint of one degree, or one another; xacro. Each names the link or joint and has its line.
    pub fn read(path: &Path, options: &UrdfOptions) -> Result<Self, UrdfError> {
        robot::read(&Self::read_text(path)?, Some(path), options)
    }

    /// The text of a file, for [`Urdf::parse`].
    ///
    /// # Errors
    /// A file that cannot be read, is too long or is no UTF-8.
    pub fn read_text(path: &Path) -> Result<String, UrdfError> {
        source::read(path)
    }

    /// As [`Urdf::read`], from text. Mesh files are looked for from `file`, and not at all without it.
    ///
    /// # Errors
    /// As [`Urdf::read`].
    pub fn parse(text: &str, file: Option<&Path>, options: &UrdfOptions) -> Result<Self, UrdfError> {
        robot::read(text, file, options)
    }

    /// The robot in the uniform field `gravity`, m/s², axes of the root link on a fixed base and of the world on a
    /// floating one.
    ///
    /// The root link of a fixed base becomes a name of the world.
    ///
    /// # Errors
    /// [`UrdfProblem::NothingMoves`], and [`UrdfProblem::Model`]: a link that moves which is not physical together with
    /// what is fixed to it and not accepted; a mass matrix that is singular in every configuration or, where a negative moment
    /// was accepted, not positive in a generic one; gravity not finite; overflow.
    pub fn model(&self, gravity: [f64; 3]) -> Result<Model, UrdfError> {
        if self.bodies.is_empty() {
            let problem = UrdfProblem::NothingMoves { link: self.root.name.clone() };
            return Err(UrdfError::new(self.file.as_deref(), Some((self.root.line, 1)), problem));
        }
        let mut builder = ModelBuilder::of_urdf(gravity);
        if !self.floating_base {
            builder.name_world(self.root.name.clone());
        }
        if self.accept_inertia {
            builder.accept_inertia();
        }
        let mut moves: Vec<bool> = Vec::with_capacity(self.bodies.len());
        for body in &self.bodies {
            let is_carried = match body.parent {
                Parent::World => false,
                Parent::Body(parent) => moves.get(parent).is_some_and(|moves| *moves),
            };
            moves.push(is_carried || body.joint.kind != JointKind::Fixed);
            let mut body = body.clone();
            if moves.last() == Some(&false) {
                // What is fixed to the world has no part in the dynamics, and need not be physical.
                body.inertia = [[0.0; 3]; 3];
            }
            builder.push(body).map_err(|error| self.blame(error))?;
        }
        builder.finish().map_err(|error| self.blame(error))
    }

    /// The error with the place of the body that it is about.
    fn blame(&self, source: ModelError) -> UrdfError {
        let place = source.subject().and_then(|subject| {
            let lines = self.lines.get(subject.body)?;
            Some(if is_of_link(subject.field) { lines.link } else { lines.joint })
        });
        UrdfError::new(self.file.as_deref(), place.map(|line| (line, 1)), UrdfProblem::Model { source })
    }
}

/// Whether a field of a body stands in its `<link>`.
fn is_of_link(field: Field) -> bool {
    matches!(field, Field::Name | Field::Mass | Field::Com | Field::Inertia)
}
