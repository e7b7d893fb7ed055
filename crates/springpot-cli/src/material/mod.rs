//! Commands about a material: laws, modulus, prony, derivative.

pub(crate) mod derivative;
pub(crate) mod laws;
pub(crate) mod modulus;
pub(crate) mod prony;
