//! Derivatives and integrals of order −2 … 2 of samples, streams and closures.

mod probe;
