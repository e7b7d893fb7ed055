//! Fractional calculus on its own: no robot, no law.

mod differintegral;
pub mod gamma;
pub mod kernel;
pub mod kind;
pub mod memory;
pub mod scheme;
pub mod step;

pub use differintegral::{
    Definition, DefinitionNameError, DerivativeError, Differintegral, Estimate, Estimated, FunctionError, Method,
    MethodNameError, Piecewise, RatedStream, Row, Stream, derivative, derivative_with_error,
};
pub use kernel::{Kernel, KernelError};
pub use kind::Kind;
pub use memory::{Affine, Energy, Memory, StepStart};
pub use step::{Form, Nodes, RatePolynomial};
