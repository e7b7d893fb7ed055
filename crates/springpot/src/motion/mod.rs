//! Kinematics given in advance: q, v, a as functions of time.

mod attitude;
mod error;
pub mod gripper_path;
mod prescribed;
mod source;
mod trajectory;
mod wanted;

pub use error::PathError;
pub use gripper_path::GripperPath;
pub use prescribed::{JointPath, PosePath};
pub use source::Source;
pub use trajectory::Trajectory;
pub use wanted::Wanted;
