//! Elements: a material between two points, and all elements of a system without a robot.

mod bank;
mod element;

pub(crate) use bank::Kept;
pub use bank::{ElementBank, MemoryRange};
pub use element::Element;
