//! How a figure looks: ranges, scales, size, words.
//!
//! An option is a field of [`Look`] and a row of [`OPTIONS`], in `options`: the key of a scenario, the option of the command and the argument in Python are
//! made of the row. What an option may take is a variant of [`Takes`], which is read from TOML in `read`.

mod options;
mod read;

pub(super) use options::KEYS;
pub use options::{AxisLook, Look, LookOption, OPTIONS, Spelt, Takes};
pub(super) use read::read;

use super::columns::ColumnGlob;
use crate::text::refusal::Place;
use crate::units::{self, Unit};
use serde_json::{Map, Value as Json, json};

/// Smallest and largest side of a figure, m.
pub const FIGURE_SIDES: [f64; 2] = [0.02, 2.0];

/// An option of a look that was asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Said {
    /// Its name.
    pub option: &'static str,
    /// What was asked, for messages.
    pub what: String,
    /// Where it stands in a scenario.
    pub place: Option<Place>,
}

/// An end of an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct RangeEnd {
    /// As written, without its unit.
    pub number: f64,
    /// Its unit; without one it is in that of what is drawn.
    pub unit: Option<String>,
}

/// What a column is called.
#[derive(Debug, Clone, PartialEq)]
pub struct FigureLabel {
    /// The column or glob.
    pub column: ColumnGlob,
    /// What it is called.
    pub text: String,
}

/// A format of figures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FigureFormat {
    /// Scalable vector graphics.
    Svg,
    /// Pixels.
    Png,
    /// A page.
    Pdf,
}

impl FigureFormat {
    /// All formats.
    pub const ALL: [Self; 3] = [Self::Svg, Self::Png, Self::Pdf];

    /// What stands for those of a figure that names none.
    pub const DEFAULT: [Self; 2] = [Self::Svg, Self::Png];

    /// Its name, which is the ending of its files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Png => "png",
            Self::Pdf => "pdf",
        }
    }
}

impl RangeEnd {
    /// Reads a number or a quantity.
    ///
    /// # Errors
    /// Why it is neither.
    pub fn parse(text: &str) -> Result<Self, String> {
        let (number, unit) = match units::split_quantity(text) {
            Some((number, unit)) if !unit.is_empty() => (number, Some(unit)),
            _ => (text.trim(), None),
        };
        let number =
            units::parse_quantity(number, "", &|_| None).map_err(|_| "not a number or a quantity".to_owned())?;
        if !number.is_finite() {
            return Err("not a finite number".to_owned());
        }
        match unit.map(|unit| Unit::parse(unit, &|_| None)).transpose() {
            Ok(_) => Ok(Self { number, unit: unit.map(str::to_owned) }),
            Err(error) => Err(error.to_string()),
        }
    }

    /// As it was written.
    pub fn written(&self) -> String {
        self.unit.as_ref().map_or(self.number.to_string(), |unit| format!("{} {unit}", self.number))
    }
}

impl Look {
    /// The option of that name, where it was asked for.
    pub fn said(&self, option: &str) -> Option<&Said> {
        self.said.iter().find(|said| said.option == option)
    }

    /// What run.json says of it: what is not left out.
    pub(super) fn record(&self) -> Map<String, Json> {
        let mut look = self.clone();
        let recorded = OPTIONS.iter().filter_map(|option| {
            let value = match option.takes {
                Takes::Range(at) => {
                    let end = |end: &RangeEnd| end.unit.as_ref().map_or(json!(end.number), |_| json!(end.written()));
                    at(&mut look).as_ref().map(|ends| ends.iter().map(end).collect())
                }
                Takes::Flag { word, at, .. } => at(&mut look).then(|| json!(word)),
                Takes::Text(at) => at(&mut look).as_ref().map(|text| json!(text)),
                Takes::TextOrFalse { text, hides } => match *hides(&mut look) {
                    true => Some(json!(false)),
                    false => text(&mut look).as_ref().map(|text| json!(text)),
                },
                Takes::Size(at) | Takes::Times(at) | Takes::Direction(at) => at(&mut look).map(|pair| json!(pair)),
                Takes::Labels if look.hides_names => Some(json!(false)),
                Takes::Labels => (!look.labels.is_empty())
                    .then(|| look.labels.iter().map(|label| (label.column.text.clone(), json!(label.text))).collect()),
                Takes::Formats => (look.formats != FigureFormat::DEFAULT)
                    .then(|| look.formats.iter().map(|format| format.name()).collect()),
            };
            value.map(|value: Json| (option.name().to_owned(), value))
        });
        recorded.collect()
    }
}
