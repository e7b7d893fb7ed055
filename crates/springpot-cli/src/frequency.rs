//! Frequencies as every command reads them: a number is in Hz, and a unit says whether turns or radians are counted.

use springpot_scenario::units::{UnitError, parse_quantity, split_quantity};
use std::f64::consts::TAU;
use std::fmt;

/// Why a text is no frequency.
pub(crate) enum Misread {
    /// It is no quantity of that dimension.
    Unit(UnitError),
    /// Its unit counts neither turns nor radians.
    Open(String),
}

impl fmt::Display for Misread {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unit(error) => error.fmt(f),
            Self::Open(unit) => write!(f, "{unit:?} does not say whether turns (Hz) or radians (rad/s) are counted"),
        }
    }
}

/// rad/s in one of what this unit counts; an empty unit is Hz.
pub(crate) fn radians(unit: &str) -> Result<f64, Misread> {
    match unit {
        "" => Ok(TAU),
        unit if unit.ends_with("Hz") => Ok(TAU),
        unit if unit.contains("rad") || unit.contains("deg") => Ok(1.0),
        unit => Err(Misread::Open(unit.to_owned())),
    }
}

/// The angular frequency, rad/s.
pub(crate) fn angular(text: &str) -> Result<f64, Misread> {
    let value = parse_quantity(text, "Hz", &|_| None).map_err(Misread::Unit)?;
    Ok(value * radians(split_quantity(text).map_or("", |(_, unit)| unit))?)
}
