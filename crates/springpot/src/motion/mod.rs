//! Kinematics given in advance: q, v, a as functions of time.

mod attitude;
pub mod gripper_path;
mod prescribed;
mod source;
mod trajectory;

pub use gripper_path::{GripperPath, PathError, Wanted};
pub use prescribed::{JointPath, PosePath};
pub use source::Source;
pub use trajectory::Trajectory;
