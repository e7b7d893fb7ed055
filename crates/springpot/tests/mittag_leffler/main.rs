//! The Mittag-Leffler function: reference values, identities, bad input.

mod identities;
mod references;
mod refusals;
