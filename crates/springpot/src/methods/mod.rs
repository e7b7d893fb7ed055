//! How steps are taken: along kinematics given in advance (`prescribed`), in forward dynamics by Radau IIA(5) (`radau`), and in steps of one
//! size ([`fixed`]).

pub mod fixed;
mod prescribed;
mod radau;
pub(crate) mod solver;
pub(crate) mod stepper;
