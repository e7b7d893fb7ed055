//! Fractional calculus on its own: no robot, no law.

pub mod gamma;
pub mod kernel;
pub mod kind;
pub mod memory;
pub mod scheme;
pub mod step;
pub mod stream;

pub use kernel::{Kernel, KernelError};
pub use kind::Kind;
pub use memory::{Affine, Energy, Memory, StepStart};
pub use step::{Form, Nodes, RatePolynomial};
