//! Derivatives and integrals of order −2 … 2 of samples, streams and closures.

mod closures;
mod convergence;
mod estimates;
mod exactness;
mod identities;
mod oracle;
mod refusals;
mod streams;
mod support;
