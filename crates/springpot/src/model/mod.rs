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
mod error;
mod mass_check;
mod principal;
mod robot;
mod spec;
#[cfg(feature = "urdf")]
pub mod urdf;
mod validate;

pub use builder::ModelBuilder;
pub use error::{Field, ModelError, Subject};
pub(crate) use robot::JointMotion;
pub use robot::{Frame, Model, Site};
pub use spec::{Anchor, BodySpec, JointKind, JointSpec, Limits, Mimic, Parent};
