//! How steps are taken: along kinematics given in advance (`prescribed`), in forward dynamics by Radau IIA(5) (`radau`) or a method of
//! order 8 (`explicit`), and in steps of one size ([`fixed`]).

mod chosen;
mod explicit;
pub mod fixed;
mod prescribed;
mod radau;
pub(crate) mod solver;
pub(crate) mod stepper;
