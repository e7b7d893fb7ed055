//! Robots as files describe them: URDF and MJCF.
//!
//! [`RobotDescription::read`] turns a file into bodies as [`ModelBuilder`] takes them, and says what it left out; which format it has, its outermost
//! element says. URDF is that of <https://wiki.ros.org/urdf/XML>, and where it leaves a choice, urdfdom's is taken unless the doc comments say
//! otherwise; MJCF is that of <https://mujoco.readthedocs.io/en/stable/XMLreference.html>, as far as it describes bodies and joints.
//!
//! ```
//! use springpot::model::description::{DescriptionOptions, RobotDescription};
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
//! let robot = RobotDescription::parse(text, None, &DescriptionOptions::default())?;
//! assert_eq!(robot.root.name, "stand");
//! let model = robot.model([0.0, 0.0, -9.81])?;
//! assert_eq!(model.joint_names(), ["pivot"]);
//! # Ok::<(), springpot::model::description::DescriptionError>(())
//! ```

mod error;
mod inertial;
mod mjcf;
mod package;
mod problem;
mod source;
mod urdf;
mod visual;
mod warning;

use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

pub use error::DescriptionError;
pub use inertial::Inertial;
pub use package::MeshPlace;
pub use problem::{DescriptionProblem, Owner};
pub use visual::{Visual, VisualShape};
pub use warning::{DescriptionPlace, DescriptionWarning, DescriptionWarningKind};

use super::{BodySpec, Field, JointKind, Model, ModelBuilder, ModelError, Parent};
use source::Source;

/// Name of the joint that lets the base float.
pub const FLOATING_BASE: &str = "floating_base";

/// How a file is read.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct DescriptionOptions {
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
    /// What it looks like where it does not move; of a floating base that stands in [`RobotDescription::visuals`].
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

/// A robot as a file describes it.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotDescription {
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
    /// Which format it has.
    pub format: Format,
    /// The files that it was read from beside its own: what it includes, and meshes that it takes masses from.
    pub parts: Vec<PathBuf>,
    /// Gravity in the axes of the world, m/s², where the file tells it, as MJCF can.
    pub gravity: Option<[f64; 3]>,
    /// Springs of joints, of MJCF.
    pub springs: Vec<JointSpring>,
    /// Where the file places what moves, of MJCF: joints and their coordinates, in the order of the bodies, where these are not 0; of those that float
    /// x y z and roll, pitch, yaw.
    pub start: Vec<(String, Vec<f64>)>,
    /// What was not used or was assumed, by kind, the weightiest first.
    pub warnings: Vec<DescriptionWarning>,
}

/// A format of files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// `<robot>`.
    Urdf,
    /// `<mujoco>`.
    Mjcf,
}

/// A spring of a joint of one coordinate: the force −stiffness·(q − slack) along it.
#[derive(Debug, Clone, PartialEq)]
pub struct JointSpring {
    /// Name of the joint.
    pub joint: String,
    /// N·m/rad or N/m, above 0.
    pub stiffness: f64,
    /// The coordinate at which it is slack, rad or m.
    pub slack: f64,
}

impl RobotDescription {
    /// Whether it was read from MJCF.
    pub fn is_mjcf(&self) -> bool {
        self.format == Format::Mjcf
    }

    /// Reads a file.
    ///
    /// `<visual>`, `<collision>` and `<material>` have no part in the dynamics; shapes of `<visual>` that can be read are in [`RobotDescription::visuals`]. Mesh files that are not found, whatever
    /// else is not used, massless links on moving joints, and single links whose inertia breaks the triangle inequality
    /// are warnings.
    ///
    /// # Errors
    /// A file that cannot be read or is no UTF-8, no XML or no URDF; names that are missing, empty, not unique or
    /// reserved; links that are not one tree; types of joints besides fixed, revolute, continuous, prismatic and
    /// floating; numbers that are missing, too few, too many or not finite (limits may be `inf`); negative mass, damping
    /// or friction; on a moving joint, a principal moment below −1e-12 of the largest that is not accepted; the axis 0 0 0; mimic joints that
    /// follow no joint of one degree, or one another; xacro. Each names the link or joint and has its line.
    pub fn read(path: &Path, options: &DescriptionOptions) -> Result<Self, DescriptionError> {
        Self::parse(&Self::read_text(path)?, Some(path), options)
    }

    /// The text of a file, for [`RobotDescription::parse`].
    ///
    /// # Errors
    /// A file that cannot be read, is too long or is no UTF-8.
    pub fn read_text(path: &Path) -> Result<String, DescriptionError> {
        source::read(path)
    }

    /// As [`RobotDescription::read`], from text. Mesh files are looked for from `file`, and not at all without it.
    ///
    /// # Errors
    /// As [`RobotDescription::read`].
    pub fn parse(text: &str, file: Option<&Path>, options: &DescriptionOptions) -> Result<Self, DescriptionError> {
        let source = Source::new(text, file);
        let document = source.parse()?;
        let root = document.root_element();
        match root.tag_name().name() {
            "robot" => urdf::read(&source, root, options),
            "mujoco" => mjcf::read(&source, root, options),
            other => {
                let root_name = other.chars().take(40).collect();
                Err(source.fail(root.range().start, DescriptionProblem::NoRobot { root: root_name }))
            }
        }
    }

    /// The robot in the uniform field `gravity`, m/s², axes of the root link on a fixed base and of the world on a
    /// floating one.
    ///
    /// The root link of a fixed base becomes a name of the world.
    ///
    /// # Errors
    /// [`DescriptionProblem::NothingMoves`], and [`DescriptionProblem::Model`]: a link that moves which is not physical together with
    /// what is fixed to it and not accepted; a mass matrix that is singular in every configuration or, where a negative moment
    /// was accepted, not positive in a generic one; gravity not finite; overflow.
    pub fn model(&self, gravity: [f64; 3]) -> Result<Model, DescriptionError> {
        if self.bodies.is_empty() {
            let problem = DescriptionProblem::NothingMoves { link: self.root.name.clone() };
            return Err(DescriptionError::new(self.file.as_deref(), Some((self.root.line, 1)), problem));
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
    fn blame(&self, source: ModelError) -> DescriptionError {
        let place = source.subject().and_then(|subject| {
            let lines = self.lines.get(subject.body)?;
            Some(if is_of_link(subject.field) { lines.link } else { lines.joint })
        });
        DescriptionError::new(self.file.as_deref(), place.map(|line| (line, 1)), DescriptionProblem::Model { source })
    }
}

/// Whether a field of a body stands in its `<link>`.
fn is_of_link(field: Field) -> bool {
    matches!(field, Field::Name | Field::Mass | Field::Com | Field::Inertia)
}
