//! Rigid bodies: identities on random trees, reference values, refusals.

mod identities;
mod long_chain;
mod oracle;
mod pair;
mod refusals;
mod support;
