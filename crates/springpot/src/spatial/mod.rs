//! Vectors, rotations and spatial quantities; nothing here knows a robot.
//!
//! Every type is a plain `Copy` array over one sealed [`Scalar`], `f64` by default.
//! A [`Motion`] or [`Force`] is a pair of three-vectors taken at the origin of the frame it is expressed in.

pub(crate) mod along;
mod articulated;
pub(crate) mod columns;
pub(crate) mod dispatch;
mod force;
mod inertia;
#[cfg(target_arch = "x86_64")]
pub(crate) mod lanes;
mod motion;
mod placement;
mod quaternion;
mod rotation;
mod rotation_vector;
mod scalar;
mod symmetric;
mod vector;

pub use articulated::ArticulatedInertia;
pub use dispatch::{SimdError, SimdLevel};
pub use force::Force;
pub use inertia::Inertia;
pub use motion::Motion;
pub use placement::Placement;
pub use quaternion::Quaternion;
pub use rotation::Rotation;
pub(crate) use rotation_vector::{left_inverse, left_inverse_slope, left_inverse_transposed};
pub use scalar::Scalar;
pub use symmetric::Symmetric3;
pub use vector::Vec3;
