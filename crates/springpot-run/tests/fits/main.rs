//! Fits to records whose truth is known.

mod moduli;
mod support;
