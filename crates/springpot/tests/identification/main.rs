//! The minimiser on problems with known answers, and what it says of its minima.

mod bounds;
mod nist;
mod robust;
mod scales;
mod support;
mod uncertainty;
