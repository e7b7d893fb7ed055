//! Where an instance is in its life.

use serde::{Deserialize, Serialize};

/// Where an instance is in its life (FMI 2.0.4, 4.2.4).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    /// Made, or reset: parameters and inputs may be set.
    Instantiated,
    /// Start values may be set, and what follows from them may be read.
    Initialization,
    /// At a communication point.
    Stepping,
    /// Over; values may be read.
    Terminated,
    /// A step failed: values of the last point may be read, a state set, the instance reset.
    Failed,
}
