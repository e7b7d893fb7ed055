//! Fractional calculus on its own: no robot, no law.

pub mod gamma;
