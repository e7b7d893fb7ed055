//! Derivatives and integrals of order −2 … 2 of samples, streams and closures.

mod along;
mod closure;
mod definition;
mod error;
mod first_slope;
mod hermite;
mod method;
mod order;
mod piecewise;
mod sampled;
mod stream;
mod uniform;

pub use definition::{Definition, DefinitionNameError};
pub use error::{DerivativeError, FunctionError};
pub use method::{Method, MethodNameError};
pub use piecewise::{Differintegral, Estimate, Piecewise};
pub use sampled::{Estimated, derivative, derivative_with_error};
pub use stream::{RatedStream, Row, Stream};
