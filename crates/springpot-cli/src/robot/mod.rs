//! Commands about a robot: info, dynamics, modes, linearise.

pub(crate) mod dynamics;
mod file;
pub(crate) mod info;
pub(crate) mod linearise;
pub(crate) mod modes;

pub(crate) use file::{Refused, Robot, is_scenario, read, refuse_urdf_flags};
