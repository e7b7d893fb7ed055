//! Fractional calculus on its own: no robot, no law.
//!
//! A derivative D^a x of an order a that is not an integer weighs the whole past of x. From t = 0 on, with n = ⌈a⌉,
//!
//! D^a x(t) = I^{n−a} x⁽ⁿ⁾(t), I^b y(t) = 1/Γ(b) ∫₀ᵗ (t−s)^{b−1} y(s) ds (Caputo),
//!
//! and D^{−b} = I^b is the integral of order b. [`Definition`] says how Riemann–Liouville and Grünwald–Letnikov differ
//! from it. All orders from −2 to 2 are here, for three kinds of x:
//!
//! | x is given as | use | error on smooth x |
//! |---|---|---|
//! | samples in an array | [`derivative`], [`derivative_with_error`] | h^{7−a}, or by [`Method`] |
//! | samples that come one by one | [`Stream`], [`RatedStream`] with rates | h^{7−a}, h^{4−a} |
//! | a function of time | [`Piecewise::of`], asked at any time | 1e-10 of the largest value, with an estimate |
//! | samples with known kinks and jumps | [`Piecewise::spline`], [`Piecewise::then`] | h^{7−a} |
//!
//! # Samples
//!
//! ```
//! use springpot::fractional::{Definition, Method, derivative_with_error, scheme::Samples};
//!
//! let t: Vec<f64> = (0..=2000).map(|k| 0.005 * k as f64).collect();
//! let x: Vec<f64> = t.iter().map(|t| t.sin()).collect();
//! let samples = Samples { t: &t, x: &x, rate: None };
//! let found = derivative_with_error(&samples, 0.5, Definition::Caputo, Method::Spline)?;
//! // Long after the start D^½ sin t is sin(t + π/4), and its algebraic tail is t^{−3/2}/Γ(−½) = −t^{−3/2}/(2√π).
//! let settled = (10.0 + std::f64::consts::FRAC_PI_4).sin() - 10f64.powf(-1.5) / (2.0 * std::f64::consts::PI.sqrt());
//! assert!((found.values[2000] - settled).abs() < 1e-3);
//! assert!(found.error[2000] < 1e-9);
//! # Ok::<(), springpot::fractional::DerivativeError>(())
//! ```
//!
//! Which method? [`Method::Spline`] for anything smooth. [`Method::Hermite`] where rates were measured too. A kink
//! costs every spline its order: cut the samples there ([`Piecewise::then`]), or take the broken line,
//! [`scheme::Scheme::L1`]. Noise is amplified like h^−a by all of them; filter first. The schemes of the literature are
//! there for comparison and for those who need one of them: see [`scheme`].
//!
//! # Functions
//!
//! ```
//! use springpot::fractional::{Definition, Piecewise};
//!
//! let x = Piecewise::of(|t| (3.0 * t).cos(), 0.0..=10.0, 1e-15)?;
//! let d = x.derivative(0.99, Definition::Caputo)?;
//! let y = d.at(5.0);
//! assert!(y.error < 1e-10);
//! // Order 0.99 is nearly x' = −3 sin 15.
//! assert!((y.value + 3.0 * 15f64.sin()).abs() < 0.05);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # How it works
//!
//! Every order is an integral of an order below 1 of a piecewise polynomial y, a derivative of x or its running
//! integral. On equal steps the moments of (t−s)^{b−1} against the polynomials are exact, and the sum over the past is
//! a convolution, done by FFT. On other steps, in streams and for functions, only the newest piece meets the exact
//! kernel; the past goes through a [`kernel`] of exponentials, each with one number that is carried from step to step.
//! [`Memory`] is the same mathematics for a time loop that asks for implicit answers: [`memory`] tells of it. A
//! [`MemoryTangent`] beside it has its derivative by parameters, by the order too.

mod differintegral;
mod exponentials;
pub mod gamma;
mod history;
pub mod kernel;
pub mod kind;
mod lanes;
mod local;
pub mod memory;
pub mod mittag_leffler;
pub mod prony;
pub mod scheme;
mod shelf;
mod slopes;
pub mod step;
mod table;
mod tangent;

pub use differintegral::{
    Definition, DefinitionNameError, DerivativeError, Differintegral, Estimate, Estimated, FunctionError, Method,
    MethodNameError, Piecewise, RatedStream, Row, Stream, derivative, derivative_with_error,
};
pub use kernel::{Kernel, KernelError};
pub use kind::Kind;
pub use memory::{Affine, Energy, Memory, StepStart};
pub use shelf::Kernels;
pub(crate) use shelf::Shelf;
pub(crate) use step::SEXTIC;
pub use step::{Form, RatePolynomial};
pub use tangent::{
    EnergyTangent, MemoryTangent, RecalledTangent, Singular, TangentEnd, TangentPoint, TangentSeeds, TangentStep,
};
pub(crate) use tangent::{MemoryAdjoint, OfStep, PastOfStep, PortColumns, Told};
