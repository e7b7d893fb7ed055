//! How a figure looks: ranges, scales, size, words.

mod keys;
mod read;

pub(super) use keys::{
    ASPECT, FORMATS, LABELS, LEGEND, SIZE, VIEW, WINDOW, X_LABEL, X_RANGE, X_SCALE, Y_LABEL, Y_RANGE, Y_SCALE,
};
pub(super) use read::read;

use super::super::refusal::Place;
use super::super::units::{self, Unit};
use super::columns::ColumnGlob;
use serde_json::{Map, Value as Json, json};

/// How a figure looks.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Look {
    /// Along x.
    pub x: AxisLook,
    /// Along y.
    pub y: AxisLook,
    /// Where lengths along x and y are asked to have one scale.
    pub equal: Option<Place>,
    /// Width and height, m.
    pub size: Option<[f64; 2]>,
    /// What columns are called.
    pub labels: Vec<FigureLabel>,
    /// What stands above the legend.
    pub legend: Option<String>,
    /// There is no legend.
    pub hides_legend: bool,
    /// Only rows with t from the first to the second are drawn, s.
    pub window: Option<[f64; 2]>,
    /// The files that are written.
    pub formats: Vec<FigureFormat>,
    /// From where the robot is seen: turned about z, and above the horizon, degrees.
    pub view: Option<[f64; 2]>,
    /// Nothing of the robot is named.
    pub hides_names: bool,
}

/// How one axis looks.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct AxisLook {
    /// From where to where it runs.
    pub range: Option<AxisRange>,
    /// It is logarithmic.
    pub is_log: bool,
    /// What stands at it, its unit included.
    pub label: Option<String>,
}

/// From where to where an axis runs.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisRange {
    /// First and last value.
    pub ends: [RangeEnd; 2],
    /// What it is, for messages.
    pub what: String,
    /// Where it stands.
    pub place: Place,
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
    /// What run.json says of it: what is not left out.
    pub(super) fn record(&self) -> Map<String, Json> {
        let mut record = Map::new();
        let mut put = |key: &str, value: Json| {
            record.insert(key.to_owned(), value);
        };
        for (name, axis) in [("x", &self.x), ("y", &self.y)] {
            if let Some(range) = &axis.range {
                let end = |end: &RangeEnd| end.unit.as_ref().map_or(json!(end.number), |_| json!(end.written()));
                put(&format!("{name}_range"), range.ends.iter().map(end).collect());
            }
            if axis.is_log {
                put(&format!("{name}_scale"), json!("log"));
            }
            if let Some(label) = &axis.label {
                put(&format!("{name}_label"), json!(label));
            }
        }
        if self.equal.is_some() {
            put("aspect", json!("equal"));
        }
        for (name, pair) in [("size", self.size), ("window", self.window), ("view", self.view)] {
            if let Some(pair) = pair {
                put(name, json!(pair));
            }
        }
        if !self.labels.is_empty() {
            put("labels", self.labels.iter().map(|label| (label.column.text.clone(), json!(label.text))).collect());
        }
        if self.hides_names {
            put("labels", json!(false));
        }
        if let Some(legend) = &self.legend {
            put("legend", json!(legend));
        }
        if self.hides_legend {
            put("legend", json!(false));
        }
        if self.formats != FigureFormat::DEFAULT {
            put("formats", self.formats.iter().map(|format| format.name()).collect());
        }
        record
    }
}
