//! Rigid bodies: identities on random trees, reference values, refusals.

mod derivatives;
mod identities;
mod joints;
mod lanes;
mod long_chain;
mod manifold;
mod moments;
mod oracle;
mod pair;
mod recursions;
mod refusals;
mod robots_oracle;
mod support;
#[path = "../support/work.rs"]
mod work;
