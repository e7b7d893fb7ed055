//! Multibody dynamics with fractional-order material elements.
//!
//! Springpot simulates robots whose bodies are joined by real materials: rubber, polymer, foam, magnetorheological fluid,
//! piezo ceramics. Such a material's force remembers the whole past motion, and a fractional derivative says so with two
//! numbers where a chain of springs and dashpots needs twenty.
//!
//! Everything inside the library is in SI units, radians and right-handed frames.

pub mod dynamics;
pub mod element;
pub mod fractional;
pub mod law;
pub mod model;
pub mod motion;
#[cfg(feature = "scenario")]
pub mod scenario;
pub mod signal;
pub mod simulate;
pub mod spatial;
#[cfg(feature = "scenario")]
pub mod sweep;
pub mod table;
