//! Least squares of any residuals: min over p of Σ r_i(p)² within bounds, and what the minimum says of p.
//!
//! A [`Problem`] gives residuals and their exact derivatives in blocks of rows; nothing here knows what they are. Parameters move in p,
//! ln p or the logit of p ([`Scale`]), by Levenberg–Marquardt steps from several starts ([`fit()`]). What has its least cost at a bound that
//! the variable does not reach is put there to the bit. A trial without residuals counts as one of infinite cost.
//!
//! | | |
//! |---|---|
//! | σ² | cost/(n − p), n rows and p parameters that are estimated; 1 where every standard deviation is known |
//! | covariance | σ²(JᵀJ)⁻¹, times (1 + ρ)/(1 − ρ) where residuals that follow one another are correlated |
//! | [`Fit::wald`] | value ± t·sd in the variable of the scale, brought back |
//! | [`profile()`] | where the cost of the others' best has risen by t²σ² |
//! | [`replicate`] | a fit of residuals drawn anew |
//! | [`Undetermined`] | singular vectors of J with columns of norm 1, below 1e-3 of the largest singular value |
//!
//! ```
//! use springpot::identification::{Failed, Parameter, Problem, Rows, Series, Settings, fit};
//! use std::sync::atomic::AtomicBool;
//!
//! /// y = a·e^{−b·x}.
//! struct Decay {
//!     parameters: [Parameter; 2],
//!     series: [Series; 1],
//! }
//!
//! impl Problem for Decay {
//!     fn parameters(&self) -> &[Parameter] {
//!         &self.parameters
//!     }
//!     fn series(&self) -> &[Series] {
//!         &self.series
//!     }
//!     fn rows(&self, values: &[f64], _: &[bool], take: &mut dyn FnMut(Rows<'_>)) -> Result<(), Failed> {
//!         for (x, y) in [(0.0, 2.01), (1.0, 1.21), (2.0, 0.74), (3.0, 0.44)] {
//!             let part = f64::exp(-values[1] * x);
//!             take(Rows { series: 0, residuals: &[values[0] * part - y], jacobian: &[part, -values[0] * x * part] });
//!         }
//!         Ok(())
//!     }
//! }
//!
//! let parameters = ["a", "b"].map(|name| Parameter::new(name, 1.0, [0.0, f64::INFINITY]));
//! let decay = Decay { parameters, series: [Series::new("y")] };
//! let found = fit(&decay, &Settings::default(), &AtomicBool::new(false))?;
//! assert!((found.values[1] - 0.5).abs() < 2.0 * found.sd(1) && found.sd(1) < 0.02);
//! # Ok::<(), springpot::identification::FitError>(())
//! ```

mod bootstrap;
mod descent;
mod estimate;
mod fit;
mod limits;
mod look;
mod parameter;
mod problem;
mod profile;
mod starts;
mod student;
mod undetermined;

pub use bootstrap::{Bootstrap, percentiles, replicate};
pub use estimate::Criteria;
pub use fit::{Fit, FitError, Reached, Settings, Status, at_start, best, fit, reach};
pub use parameter::{Parameter, Prior, Scale, Side};
pub use problem::{Failed, Loss, Problem, Rows, Series};
pub use profile::{profile, rise};
pub use student::student_quantile;
pub use undetermined::{Determined, Undetermined};
