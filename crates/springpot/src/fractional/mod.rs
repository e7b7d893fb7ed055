//! Fractional calculus on its own: no robot, no law.
//!
//! D^alpha for 0 ≤ alpha ≤ 1 with lower terminal 0, Caputo or Riemann–Liouville ([`Kind`]). [`Memory`] is what a time loop
//! steps: any step size, asked as often as wanted, changed by committing alone. [`stream::Stream`] is the same mathematics for uniform
//! samples; [`scheme`] holds the schemes of the literature by name.
//!
//! ```
//! use springpot::fractional::stream::Stream;
//!
//! // D^½ t = 2√(t/π), from samples of t and of its rate.
//! let (h, count) = (0.01, 1000);
//! let mut derivative = Stream::new(0.5, h, count, 1e-8)?;
//! for k in 0..count {
//!     let t = k as f64 * h;
//!     let d = derivative.push(t, 1.0);
//!     assert!((d - 2.0 * (t / std::f64::consts::PI).sqrt()).abs() < 1e-7);
//! }
//! # Ok::<(), springpot::fractional::KernelError>(())
//! ```

pub mod gamma;
pub mod kernel;
pub mod kind;
pub mod memory;
pub mod mittag_leffler;
pub mod prony;
pub mod scheme;
pub mod step;
pub mod stream;

pub use kernel::{Kernel, KernelError};
pub use kind::Kind;
pub use memory::{Affine, Energy, Memory, StepStart};
pub use step::{Form, Nodes, RatePolynomial};
