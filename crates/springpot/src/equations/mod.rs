//! The equations of motion at one time: what is known there, and the forces of all that acts.

pub(crate) mod context;
pub(crate) mod control;
pub(crate) mod coulomb;
pub(crate) mod drives;
pub(crate) mod evaluate;
pub(crate) mod kinks;
pub(crate) mod on_grid;
mod pose;
pub(crate) mod resistance;
mod steady;
pub(crate) mod tangent;
pub(crate) mod zero;

pub use pose::{ElementStart, Pose, State};
pub use steady::SteadyError;
