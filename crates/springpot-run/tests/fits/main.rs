//! Fits to records whose truth is known.

mod arm;
mod moduli;
mod others;
mod strokes;
mod support;
