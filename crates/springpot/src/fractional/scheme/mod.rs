//! Named schemes for D^a of samples, −2 ≤ a ≤ 2, for comparison with the literature and for those who need one of them.
//!
//! | name | orders a | accuracy on smooth x | grid |
//! |---|---|---|---|
//! | `grunwald-letnikov` | −2 … 2 | 1 | equal steps |
//! | `grunwald-letnikov(N)` | 0 … 2 | 1, and what the cut memory leaves | equal steps |
//! | `l1` | −2 … 1 | 2 − a, integrals 2 | any |
//! | `l1-2` | −2 … 2 | 3 − a, integrals 3 | any |
//! | `fbdf-1` … `fbdf-6` | −2 … 2 | 1 … 6 | equal steps |
//! | `expansion-2004(N)` | 0 … 1 | 2 − a in 1/N | any |
//! | `expansion-2008(N)` | 0 … 1 | 1 − a in 1/N | any |
//!
//! With a < 0, D^a is the Riemann–Liouville integral of order −a. On equal steps all but the expansions take O(N log N)
//! operations by FFT. All start at t = 0 and know nothing of what was before.
//!
//! # Which one
//!
//! For smooth samples none: [`derivative`](super::derivative) with its splines errs less in the same time. `l1` is exact for
//! the broken line through the samples, so it stays right where x has kinks at samples. `l1-2` puts a parabola through three of
//! them and gains an order where x is smooth. `grunwald-letnikov` is the limit of the definition stopped at the step h.
//! `fbdf-p` is the convolution that solvers of fractional differential equations step with, here with the starting weights
//! that keep its order from the first row on. The expansions are those of the papers: moments of x in place of its past,
//! wrong until they have many more terms than the motion has had radians.
//!
//! Halving the step divides the error by 2 to the order:
//!
//! ```
//! use springpot::fractional::Kind;
//! use springpot::fractional::scheme::{Samples, Scheme};
//!
//! // D^½ t⁴ at t = 1 is Γ(5)/Γ(9/2).
//! let exact = 24.0 / 11.631_728_396_567_448;
//! let error = |scheme: Scheme, steps: usize| -> f64 {
//!     let t: Vec<f64> = (0..=steps).map(|k| k as f64 / steps as f64).collect();
//!     let x: Vec<f64> = t.iter().map(|t| t.powi(4)).collect();
//!     let y = scheme.differentiate(&Samples { t: &t, x: &x, rate: None }, 0.5, Kind::Caputo).unwrap();
//!     (y[steps] - exact).abs()
//! };
//! for scheme in [Scheme::GrunwaldLetnikov, Scheme::L1, Scheme::L12, Scheme::Fbdf(3)] {
//!     let measured = (error(scheme, 500) / error(scheme, 1000)).log2();
//!     assert!((measured - scheme.order(0.5)).abs() < 0.1, "{scheme}: {measured}");
//! }
//! ```

mod convolution;
mod differentiate;
mod error;
mod expansion;
mod fbdf;
mod grunwald_letnikov;
mod l1;
mod named;
mod rates;
mod samples;
mod weights;

pub(super) use convolution::sum_of_convolutions;
pub use convolution::{causal_convolution, direct_convolution};
pub use error::SchemeError;
pub use named::{Scheme, SchemeNameError};
pub use rates::differenced_rates;
pub use samples::{Samples, UniformPrefix};
