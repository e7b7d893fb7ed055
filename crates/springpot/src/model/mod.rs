//! The robot: bodies, joints, anchors.
//!
//! A robot is described body by body ([`BodySpec`]) and built once into a constant [`Model`], which threads share.
//!
//! ```
//! use springpot::model::{BodySpec, JointSpec, ModelBuilder, Parent};
//!
//! let mut builder = ModelBuilder::new([0.0, 0.0, -9.81]);
//! builder.push(BodySpec {
//!     name: "rod".into(),
//!     parent: Parent::World,
//!     joint: JointSpec::revolute("q1", [0.0, 1.0, 0.0], [0.0; 3]),
//!     mass: 2.0,
//!     com: [0.5, 0.0, 0.0],
//!     inertia: [[0.001, 0.0, 0.0], [0.0, 0.17, 0.0], [0.0, 0.0, 0.17]],
//! })?;
//! let model = builder.finish()?;
//! assert_eq!(model.nv(), 1);
//! # Ok::<(), springpot::model::ModelError>(())
//! ```

mod builder;
mod degree;
#[cfg(feature = "urdf")]
pub mod description;
mod dimension;
mod error;
mod frame;
mod kind;
mod labels;
mod manifold;
mod mass_check;
mod numbering;
mod robot;
mod spec;
mod state;
mod turns;
mod validate;

pub use builder::ModelBuilder;
pub(crate) use degree::{Axis, Degree, DegreeMotion, JointMotion};
pub use dimension::{Dimension, Units};
pub use error::{Field, ModelError, Subject};
pub use frame::{Frame, Site};
pub use kind::{AxisNeed, Component, JointKind, MOST_COORDINATES, Move, Space};
pub use labels::Label;
pub use robot::{DescribedJoint, Model};
pub use spec::{Anchor, BodySpec, FRICTION_SPEED, FrictionLaw, JointPart, JointSpec, Limits, Mimic, Parent};
pub use state::StateError;
pub(crate) use turns::{FreeTurn, Turned, add_turned};
