//! The sample that moduli were measured on, and angles for loss factors.

use super::Refused;
use springpot_scenario::units::{UnitError, parse_quantity};
use std::f64::consts::FRAC_PI_2;

/// Area and length of a sample: the modulus E is its stiffness k = E·A/L.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Sample {
    /// m².
    area: Option<f64>,
    /// m.
    length: Option<f64>,
    /// Moduli stay what they are: those of a sample of 1 m² and 1 m.
    is_implied: bool,
}

/// What is missing of a size.
pub(super) enum Missized {
    Twice,
    NotPositive,
    Unit(UnitError),
}

impl Sample {
    /// Names and units of its sizes.
    pub(super) const SIZES: [(&str, &str, &str); 2] = [("area", "m^2", "4 cm^2"), ("length", "m", "10 mm")];

    /// What would complete it.
    pub(super) const CURE: &str = "give the sample: --area '4 cm^2' --length '10 mm', or area = 4 cm^2, length = 10 mm among the values of a data sheet";

    /// The one for which moduli are stiffnesses.
    pub(super) const IMPLIED: Self = Self { area: Some(1.0), length: Some(1.0), is_implied: true };

    pub(super) fn new(area: &Option<String>, length: &Option<String>) -> Result<Self, Refused> {
        let mut sample = Self::default();
        for ((name, unit, example), given) in Self::SIZES.into_iter().zip([area, length]) {
            let Some(text) = given else { continue };
            let why = match sample.set(name, text) {
                Ok(()) | Err(Missized::Twice) => continue,
                Err(Missized::NotPositive) => "not a positive number".to_owned(),
                Err(Missized::Unit(error)) => error.to_string(),
            };
            return Err(Refused::new(
                format!("--{name} {text}: {why}"),
                format!("write a positive number in {unit}, or with a unit: '{example}'"),
            ));
        }
        Ok(sample)
    }

    /// Takes `area` or `length`, once.
    pub(super) fn set(&mut self, name: &str, text: &str) -> Result<(), Missized> {
        let (size, unit) = if name == "area" { (&mut self.area, "m^2") } else { (&mut self.length, "m") };
        let value = parse_quantity(text, unit, &|_| None).map_err(Missized::Unit)?;
        match size.is_some() {
            _ if !(value > 0.0 && value.is_finite()) => Err(Missized::NotPositive),
            true => Err(Missized::Twice),
            false => {
                *size = Some(value);
                Ok(())
            }
        }
    }

    pub(super) fn is_given(&self) -> bool {
        !self.is_implied && (self.area.is_some() || self.length.is_some())
    }

    /// A/L, m; `None` where one of them is not known.
    pub(super) fn stiffness_of_one(&self) -> Option<f64> {
        Some(self.area? / self.length?)
    }
}

/// Whether a loss factor is told as the angle δ.
pub(super) fn is_angle(unit: &str) -> bool {
    unit.contains("rad") || unit.contains("deg")
}

/// tan δ of an angle in rad; `None` from 90° on.
pub(super) fn tangent(delta: f64) -> Option<f64> {
    (delta < FRAC_PI_2).then(|| delta.tan())
}

/// What is right where an angle is not.
pub(super) const ANGLES: &str = "the angle δ lies between 0 and 90 deg; a loss factor is a number without unit";
