//! Elements: a measure of the configuration with a law, and all elements of a system without a robot.

mod bank;
mod element;
mod measure;

pub use bank::{BankState, ElementBank, MemoryRange};
pub(crate) use bank::{Kept, LastNode};
pub use element::Element;
pub use measure::{
    Bushing, Cable, CableError, Component, Joint, JointMeasureError, Line, Measure, NoDirection, Reading,
};
pub(crate) use measure::{Forces, MeasureKind, Pull};
