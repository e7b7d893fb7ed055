//! (under construction)

pub mod units;
