//! From the values of data sheets to the parameters of a law.
//!
//! Under x = X·cos(ωt) the law F = k·x + c·D^alpha x answers, once the start has faded, with the complex stiffness
//! K(ω) = k + c·(iω)^alpha. Data sheets tell parts of it:
//!
//! | quantity | meaning | unit |
//! |---|---|---|
//! | [`Quantity::LossFactor`] | tan δ = Im K/Re K | 1 |
//! | [`Quantity::Stiffness`] | dynamic stiffness \|K\| | N/m |
//! | [`Quantity::Storage`] | storage stiffness Re K | N/m |
//! | [`Quantity::Loss`] | loss stiffness Im K | N/m |
//! | [`Quantity::Damping`] | equivalent viscosity Im K/ω | N·s/m |
//!
//! A springpot has tan δ = tan(alpha·π/2) at every frequency, so that one loss factor and one stiffness are enough for
//! it. Where two data make K known at one frequency, springpot and Kelvin–Voigt element follow in closed form, and with
//! the static stiffness the fractional Kelvin–Voigt element too. Everything else is solved for the smallest sum of
//! squares of relative deviations, which is 0 where the data determine the law exactly. [`fit()`] takes a whole measurement of storage and
//! loss over frequency, and tells the spread of the parameters too.
//!
//! Source: R. L. Bagley, P. J. Torvik, *Fractional calculus — a different approach to the analysis of viscoelastically
//! damped structures*, AIAA J. 21 (1983) 741–748.
//!
//! ```
//! use springpot::law::Catalog;
//! use springpot::law::datasheet::{Datum, Quantity, identify};
//! let omega = 2.0 * std::f64::consts::PI * 10.0;
//! let data = [
//!     Datum { quantity: Quantity::LossFactor, value: 0.3, omega },
//!     Datum { quantity: Quantity::Stiffness, value: 5000.0, omega },
//! ];
//! let catalog = Catalog::standard();
//! let springpot = catalog.get("springpot").expect("a law that comes with Springpot");
//! let mount = identify(springpot, &data)?;
//! assert!((mount.order - 2.0 / std::f64::consts::PI * 0.3_f64.atan()).abs() < 1e-15);
//! assert!((mount.predict(&data[1]) - 5000.0).abs() < 1e-9);
//! # Ok::<(), springpot::law::datasheet::DatasheetError>(())
//! ```

mod closed;
mod fit;
mod nearest;
mod networks;

pub use fit::{FitError, Fitted, Measured, fit};
pub use networks::{FittedNetwork, can_fit, fit_network};

use super::catalog::{Catalog, Entry, Param};
use super::network::Network;
use super::step::{Point, Term};
use crate::fractional::Kind as Derivative;
use std::f64::consts::FRAC_PI_2;
use std::fmt;
use std::sync::Arc;

/// What a data sheet tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// tan δ = Im K/Re K.
    LossFactor,
    /// |K|, N/m.
    Stiffness,
    /// Re K, N/m.
    Storage,
    /// Im K, N/m.
    Loss,
    /// Im K/ω, N·s/m.
    Damping,
}

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::LossFactor, Self::Stiffness, Self::Storage, Self::Loss, Self::Damping];

    /// Its name, as in `springpot laws --from`.
    pub fn name(self) -> &'static str {
        match self {
            Self::LossFactor => "tan_delta",
            Self::Stiffness => "stiffness",
            Self::Storage => "storage",
            Self::Loss => "loss",
            Self::Damping => "damping",
        }
    }

    /// Its unit in the grammar of quantities; empty for a pure number.
    pub fn unit(self) -> &'static str {
        match self {
            Self::LossFactor => "",
            Self::Stiffness | Self::Storage | Self::Loss => "N/m",
            Self::Damping => "N*s/m",
        }
    }

    /// Whether it tells of dissipation.
    pub fn is_of_losses(self) -> bool {
        matches!(self, Self::LossFactor | Self::Loss | Self::Damping)
    }

    /// Its value for K at ω.
    fn of(self, k: [f64; 2], omega: f64) -> f64 {
        match self {
            Self::LossFactor => k[1] / k[0],
            Self::Stiffness => k[0].hypot(k[1]),
            Self::Storage => k[0],
            Self::Loss => k[1],
            Self::Damping => k[1] / omega,
        }
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// One value of a data sheet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Datum {
    /// What it is.
    pub quantity: Quantity,
    /// Its value, SI; positive.
    pub value: f64,
    /// At which angular frequency, rad/s; 0: static.
    pub omega: f64,
}

/// The form of a law that data can determine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Model {
    /// F = k·x.
    Spring,
    /// F = c·x'.
    Dashpot,
    /// F = c·D^alpha x.
    Springpot,
    /// F = k·x + c·x'.
    KelvinVoigt,
    /// F = k·x + c·D^alpha x.
    FractionalKelvinVoigt,
}

impl Model {
    /// All of them, those of few parameters first.
    pub const ALL: [Self; 5] =
        [Self::Spring, Self::Dashpot, Self::Springpot, Self::KelvinVoigt, Self::FractionalKelvinVoigt];

    /// The form of a law of the catalog; `None` where data sheets cannot determine it: it has inputs, or parameters other than k, c and
    /// alpha, or what it builds of them is not the sum of such a spring and such a springpot.
    pub fn of(law: &Entry) -> Option<Self> {
        let trial = |param: &Param| {
            let value = match &*param.name {
                "k" => 2.0,
                "c" => 3.0,
                "alpha" => 0.25,
                _ => return None,
            };
            Some(param.range.low.max(value).min(param.range.high))
        };
        let values: Vec<f64> = law.params.iter().map(trial).collect::<Option<_>>()?;
        let value = |name: &str| law.params.iter().zip(&values).find(|(param, _)| param.name == name).map(|(_, x)| *x);
        let [k, c, alpha] = ["k", "c", "alpha"].map(value);
        let free = [k, c, alpha].map(|value| value.is_some());
        let form = Self::ALL.into_iter().find(|form| form.free() == free && law.inputs.is_empty())?;
        let network = law.build(&values, Derivative::Caputo).ok()?;
        let spring = k.map(|coefficient| Term { coefficient, order: 0.0 });
        let springpot = c.map(|coefficient| Term { coefficient, order: alpha.unwrap_or(1.0) });
        let mut found = sum(&network)?;
        found.sort_by(|a, b| a.order.total_cmp(&b.order));
        (found == [spring, springpot].into_iter().flatten().collect::<Vec<_>>()).then_some(form)
    }

    /// The first law of this form in a catalog.
    pub fn law(self, catalog: &Catalog) -> Option<&Arc<Entry>> {
        catalog.entries().iter().find(|law| Self::of(law) == Some(self))
    }

    /// The law that data of this kind determine: no losses, a spring; two data, a springpot, or a Kelvin–Voigt element
    /// where one of them is static; more, a fractional Kelvin–Voigt element, or a springpot where all of them are of
    /// one frequency.
    pub fn for_data(data: &[Datum]) -> Self {
        let losses = data.iter().any(|datum| datum.quantity.is_of_losses());
        let is_static = data.iter().any(|datum| datum.omega == 0.0);
        let mut frequencies: Vec<f64> = data.iter().map(|datum| datum.omega).collect();
        frequencies.sort_by(f64::total_cmp);
        frequencies.dedup();
        match (data.len(), losses, frequencies.len()) {
            (0 | 1, true, _) if data.iter().all(|datum| datum.quantity == Quantity::Damping) => Self::Dashpot,
            (0 | 1, _, _) | (_, false, 1) => Self::Spring,
            (2, ..) if is_static => Self::KelvinVoigt,
            (2, ..) | (_, _, 1) => Self::Springpot,
            _ => Self::FractionalKelvinVoigt,
        }
    }

    /// Whether k, c and alpha are free.
    fn free(self) -> [bool; 3] {
        match self {
            Self::Spring => [true, false, false],
            Self::Dashpot => [false, true, false],
            Self::Springpot => [false, true, true],
            Self::KelvinVoigt => [true, true, false],
            Self::FractionalKelvinVoigt => [true, true, true],
        }
    }

    /// Number of its parameters.
    pub fn parameter_count(self) -> usize {
        self.free().into_iter().filter(|free| *free).count()
    }
}

/// The terms c·D^order x whose sum a network is; `None` where it is more than that.
fn sum(network: &Network) -> Option<Vec<Term>> {
    let at = Point { t: 0.0, stroke: 0.0, rate: 0.0, inputs: &[] };
    match network {
        Network::Leaf(leaf) if leaf.is_linear() && leaf.size().variables == 0 => Some(vec![leaf.linearised(&at)]),
        Network::Parallel(parts) => parts.iter().map(sum).collect::<Option<Vec<_>>>().map(|terms| terms.concat()),
        Network::Leaf(_) | Network::Series(_) | Network::Heated(_) => None,
    }
}

/// Why data determine no law.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DatasheetError {
    /// A law that such data do not determine ([`Model::of`]).
    #[error("the law {law:?} has parameters that such data say nothing about")]
    OtherLaw {
        /// The law.
        law: String,
    },
    /// A value is not a positive number, or a frequency is negative or infinite.
    #[error("{quantity} = {value} at {omega} rad/s: values must be positive and finite, frequencies not negative")]
    NotPositive {
        /// Of what.
        quantity: Quantity,
        /// The value.
        value: f64,
        /// Its frequency, rad/s.
        omega: f64,
    },
    /// A quantity of losses without a frequency.
    #[error("{quantity} needs a frequency other than 0: at rest nothing is lost")]
    NeedsFrequency {
        /// Which.
        quantity: Quantity,
    },
    /// One quantity twice at the same frequency.
    #[error("{quantity} is given twice at {omega} rad/s")]
    Twice {
        /// Which.
        quantity: Quantity,
        /// Where, rad/s.
        omega: f64,
    },
    /// A static stiffness for a law that has none.
    #[error("the law {law} has no static stiffness")]
    NoStaticStiffness {
        /// The law.
        law: String,
    },
    /// Fewer data than parameters.
    #[error("the law {law} has {needed} parameters, and {given} data are given")]
    TooFew {
        /// The law.
        law: String,
        /// Its parameters.
        needed: usize,
        /// Data given.
        given: usize,
    },
    /// Losses alone say nothing of how stiff it is.
    #[error("no stiffness is given: a loss factor alone does not say how stiff the element is")]
    NoStiffness,
    /// The data leave a parameter open.
    #[error("the data leave the law {law} open: they say the same thing more than once, or nothing about losses")]
    Undetermined {
        /// The law.
        law: String,
    },
    /// No admissible parameters have these values.
    #[error("no law {law} with k ≥ 0, c ≥ 0 and 0 ≤ alpha ≤ 1 has these values; the nearest is off by {percent:.3} %")]
    Unreachable {
        /// The law.
        law: String,
        /// Largest relative deviation of the nearest one, in percent.
        percent: f64,
    },
}

/// A law whose parameters were found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Identified {
    /// Its form.
    pub model: Model,
    /// k, N/m; 0 where the law has none.
    pub stiffness: f64,
    /// c, N·s^alpha/m; 0 where the law has none.
    pub coefficient: f64,
    /// alpha; 1 where the law has a dashpot.
    pub order: f64,
}

impl Identified {
    /// K(ω) = k + c·(iω)^alpha as real and imaginary part, N/m.
    pub fn complex_stiffness(&self, omega: f64) -> [f64; 2] {
        let magnitude = if omega == 0.0 && self.order > 0.0 { 0.0 } else { self.coefficient * omega.powf(self.order) };
        let (sin, cos) = sin_cos(self.order);
        [self.stiffness + magnitude * cos, magnitude * sin]
    }

    /// What this law has in the place of `datum`.
    pub fn predict(&self, datum: &Datum) -> f64 {
        if datum.quantity == Quantity::Damping && datum.omega == 0.0 && self.order == 1.0 {
            return self.coefficient;
        }
        datum.quantity.of(self.complex_stiffness(datum.omega), datum.omega)
    }

    /// The parameter of that name in the catalog's row; `None` for a name that the law does not have.
    pub fn parameter(&self, name: &str) -> Option<f64> {
        let [k, c, alpha] = self.model.free();
        match name {
            "k" if k => Some(self.stiffness),
            "c" if c => Some(self.coefficient),
            "alpha" if alpha => Some(self.order),
            _ => None,
        }
    }

    /// Largest relative deviation from `data`; 0 without any.
    pub fn deviation(&self, data: &[Datum]) -> f64 {
        data.iter().map(|datum| (self.predict(datum) / datum.value - 1.0).abs()).fold(0.0, f64::max)
    }
}

/// sin and cos of order·π/2, exact at the ends.
fn sin_cos(order: f64) -> (f64, f64) {
    match order {
        0.0 => (0.0, 1.0),
        1.0 => (1.0, 0.0),
        _ => (FRAC_PI_2 * order).sin_cos(),
    }
}

/// Finds the parameters of `law` from `data`: exactly where there are as many data as parameters, else with the
/// smallest sum of squares of relative deviations.
///
/// A [`Quantity::Damping`] at ω = 0 is the c of a dashpot.
///
/// # Errors
/// [`DatasheetError`]: a law of another form, data that make no sense, too few of them, or none that the law can have.
pub fn identify(law: &Entry, data: &[Datum]) -> Result<Identified, DatasheetError> {
    let name = || law.name.to_string();
    let model = Model::of(law).ok_or_else(|| DatasheetError::OtherLaw { law: name() })?;
    check(law, model, data)?;
    let (given, needed) = (data.len(), model.parameter_count());
    if given < needed {
        return Err(DatasheetError::TooFew { law: name(), needed, given });
    }
    if data.iter().all(|datum| datum.quantity == Quantity::LossFactor) {
        return Err(DatasheetError::NoStiffness);
    }
    let closed = if given == needed { closed::form(model, data) } else { None };
    let found = match closed {
        Some(found) => found,
        None => nearest::nearest(model, data).ok_or_else(|| DatasheetError::Undetermined { law: name() })?,
    };
    let deviation = found.deviation(data);
    if given == needed && deviation.is_nan() | (deviation > nearest::EXACT) {
        return Err(DatasheetError::Unreachable { law: name(), percent: 100.0 * deviation });
    }
    Ok(found)
}

fn check(law: &Entry, model: Model, data: &[Datum]) -> Result<(), DatasheetError> {
    for (i, &Datum { quantity, value, omega }) in data.iter().enumerate() {
        let admissible = value > 0.0 && value.is_finite() && omega >= 0.0 && omega.is_finite();
        if !admissible {
            return Err(DatasheetError::NotPositive { quantity, value, omega });
        }
        let of_a_dashpot = quantity == Quantity::Damping && matches!(model, Model::Dashpot | Model::KelvinVoigt);
        if omega == 0.0 && quantity.is_of_losses() && !of_a_dashpot {
            return Err(DatasheetError::NeedsFrequency { quantity });
        }
        if omega == 0.0 && !quantity.is_of_losses() && matches!(model, Model::Springpot | Model::Dashpot) {
            return Err(DatasheetError::NoStaticStiffness { law: law.name.to_string() });
        }
        if data[..i].iter().any(|other| other.quantity == quantity && other.omega == omega) {
            return Err(DatasheetError::Twice { quantity, omega });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
