//! Fits of laws and robots to measurements: `springpot fit`.
//!
//! [`Fitting`] has the records and what is sought; [`fit()`] finds it, [`look()`] says beforehand what the records can
//! determine. [`Problem`] has residuals and their derivatives for other minimisers.

mod admissible;
mod ahead;
mod compared;
mod figures;
mod files;
mod moduli;
mod momentum;
mod outcome;
mod predicted;
mod problem;
mod record;
mod search;
mod smooth;
mod stroke;
mod track;
mod walk;

pub use ahead::{Ahead, look};
pub use files::{save, told};
pub use outcome::{ColumnScore, Outcome, RecordScore, Status};
pub use record::json;
pub use search::{FitError, fit};

use self::problem::Problem as Residuals;
use springpot::identification::{Failed, Problem as _, Rows};
use springpot_scenario::Fitting;

/// The residuals of a fit, for other minimisers.
pub struct Problem<'a>(Residuals<'a>);

impl<'a> Problem<'a> {
    /// That of these measurements.
    ///
    /// # Errors
    /// What keeps a record from being compared.
    pub fn new(fitting: &'a Fitting) -> Result<Self, String> {
        Residuals::new(fitting).map(Self)
    }

    /// The residuals at these values in the parameters' own units, those of priors behind all others; and row by row their derivatives.
    ///
    /// # Errors
    /// Why there are none there.
    pub fn residuals(&self, values: &[f64], is_differentiated: bool) -> Result<(Vec<f64>, Vec<f64>), Failed> {
        let (mut residuals, mut jacobian) = (Vec::new(), Vec::new());
        let wanted = vec![is_differentiated; values.len()];
        self.0.rows(values, &wanted, &mut |rows: Rows<'_>| {
            residuals.extend_from_slice(rows.residuals);
            jacobian.extend_from_slice(rows.jacobian);
        })?;
        for (j, parameter) in self.0.parameters.iter().enumerate() {
            let Some(prior) = parameter.prior else { continue };
            residuals.push((values[j] - prior.mean) / prior.sd);
            if is_differentiated {
                jacobian.extend((0..values.len()).map(|k| if k == j { prior.sd.recip() } else { 0.0 }));
            }
        }
        Ok((residuals, jacobian))
    }
}
