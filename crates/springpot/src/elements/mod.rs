//! Elements without a robot.

mod bank;

pub use bank::{ElementBank, MemoryRange};
