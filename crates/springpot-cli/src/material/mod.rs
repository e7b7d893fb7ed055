//! Commands about a material: laws, master curves, modulus, prony, derivative.

pub(crate) mod derivative;
pub(crate) mod laws;
pub(crate) mod master;
pub(crate) mod modulus;
pub(crate) mod prony;
