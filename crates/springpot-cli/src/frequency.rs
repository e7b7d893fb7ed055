//! Frequencies as every command reads them: a number is in Hz, and a unit says whether turns or radians are counted.

use springpot_scenario::units::{UnitError, parse_quantity, split_quantity};
use std::f64::consts::TAU;
use std::fmt;

/// Most frequencies of a band.
const MOST: usize = 100_000;
/// Rows that are printed, where nothing asks for all.
const PRINTED: usize = 13;

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

/// The frequencies, Hz, of which the options --from, --to and --points speak, evenly on a logarithmic scale; what is wrong, and what would be right.
pub(crate) fn band(from: &str, to: &str, points: usize) -> Result<Vec<f64>, (String, String)> {
    let read = |name: &str, text: &str| {
        let help = || "write 10, '10 Hz' or '60 rad/s'".to_owned();
        match angular(text) {
            Ok(omega) if omega > 0.0 && omega.is_finite() => Ok(omega / TAU),
            Ok(_) => Err((format!("--{name} {text}: not a frequency above 0"), help())),
            Err(error) => Err((format!("--{name} {text}: {error}"), help())),
        }
    };
    let (low, high) = (read("from", from)?, read("to", to)?);
    if low >= high {
        return Err((format!("--from {from} is not below --to {to}"), "swap them".to_owned()));
    }
    if !(2..=MOST).contains(&points) {
        return Err((format!("--points {points}: out of range"), format!("write 2 to {MOST}")));
    }
    Ok((0..points).map(|k| low * (high / low).powf(k as f64 / (points - 1) as f64)).collect())
}

/// The rows of a band that are printed, and what a page says where they are not all.
pub(crate) fn printed(count: usize) -> (impl Iterator<Item = usize>, String) {
    let (last, printed) = (count - 1, count.min(PRINTED));
    let left_out = format!("\n{printed} of {count} frequencies; all of them: --json or --out FILE.csv\n");
    ((0..printed).map(move |k| k * last / (printed - 1).max(1)), if printed < count { left_out } else { String::new() })
}
