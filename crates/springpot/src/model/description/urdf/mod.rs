//! URDF files.

mod joint;
mod limit;
mod link;
mod mimic;
mod reader;
mod robot;
mod tree;
mod visual;

use super::{BodyLines, DescriptionOptions, FLOATING_BASE, Format, Inertial, RobotDescription, RootLink};
use super::{error, package, problem, source, warning};

pub(super) use robot::read;
