//! Fits to records whose truth is known.

mod arm;
mod moduli;
mod strokes;
mod support;
