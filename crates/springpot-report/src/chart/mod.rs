//! Curves in panels, with axes and a legend.

mod axes;
mod clip;
mod data;
mod decimate;
mod layout;
mod legend;
mod map;
mod style;
mod ticks;

pub use map::{Map, MapAxis};

use crate::{Drawn, Rendered, ReportError, draw};

/// Panels of one figure.
const MOST_PANELS: usize = 64;
/// Curves of one figure, over all panels.
const MOST_CURVES: usize = 2000;

/// A figure of curves: one or more panels over the same x, and one legend.
///
/// All text may hold any Unicode: Greek letters, sub- and superscripts are in the shipped font; `E_{d}` is drawn with an index. Labels
/// carry their units as text, such as `"Q₂ of strut, N·m"`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plot {
    /// Stands above the panels.
    pub title: Option<String>,
    /// Along x, for all panels.
    pub x: Axis,
    /// Along y, for all panels that have none of their own.
    pub y: Axis,
    /// A second y axis, to the right, for the curves that ask for it.
    pub right: Option<Axis>,
    /// Lengths along x and y have one scale.
    pub is_equal: bool,
    /// Width and height of the page, mm; else [`crate::WIDTH`] and what it takes.
    pub size: Option<[f64; 2]>,
    /// Stands above the legend.
    pub legend_title: Option<String>,
    /// There is no legend.
    pub hides_legend: bool,
    /// Panels beside one another; else one panel fills the figure, and several make a grid of at most four columns.
    pub columns: Option<usize>,
    /// In reading order. No panel gives an empty one.
    pub panels: Vec<Panel>,
}

/// One axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis {
    /// Quantity and unit.
    pub label: String,
    /// From where to where it runs, finite and rising (above zero where it is logarithmic); else what the curves need. What lies beyond is
    /// not drawn.
    pub range: Option<[f64; 2]>,
    /// How numbers become lengths.
    pub scale: Scale,
}

/// How numbers become lengths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// Equal differences are equal lengths.
    #[default]
    Linear,
    /// Equal ratios are equal lengths; what is not above zero is a gap.
    Log,
}

/// One pair of axes and its curves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Panel {
    /// Stands above the panel.
    pub title: Option<String>,
    /// A y axis of its own.
    pub y: Option<Axis>,
    /// From back to front. Without any finite point the panel says "no data".
    pub curves: Vec<Curve>,
}

/// One line. Curves of the same label and kind, in any panel, look the same; each label and each kind has one legend entry.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    /// Legend entry; an empty one makes no entry.
    pub label: String,
    /// What else tells it apart, such as the column where the label is a swept value: where there are several kinds, labels are
    /// colours and kinds are dashes.
    pub kind: String,
    /// Its ordinates belong to [`Plot::right`].
    pub is_right: bool,
    /// Its points are marked.
    pub is_marked: bool,
    /// It is points without a line, as measured ones are: in black and grey, with legend entries behind all others.
    pub is_points: bool,
    /// Abscissae, in any order: loops are fine.
    pub x: Vec<f64>,
    /// Ordinates, as many as x. A point of which a coordinate is NaN, infinite or beyond 1e300 is a gap in the line.
    pub y: Vec<f64>,
}

impl From<&str> for Axis {
    /// An axis with this label.
    fn from(label: &str) -> Self {
        label.to_owned().into()
    }
}

impl From<String> for Axis {
    fn from(label: String) -> Self {
        Self { label, ..Self::default() }
    }
}

impl Plot {
    /// Draws the figure.
    ///
    /// - The legend lists labels in the order in which they first appear, then kinds; it stands to the right where that leaves room for
    ///   the curves, else below. Three labels or more that differ only in one number, rising or falling, are coloured from dark to
    ///   light (plasma), with dashes where they are more than six; others get distinct colours and dashes.
    /// - x ends at the data (with a margin where a curve runs back or is marked); y has a margin of 5 %. All panels share x; panels with the same y
    ///   axis share y too, unless one of them would come out flatter than a twentieth of the range. A constant curve gets ±10 %.
    /// - Pages narrower than 110 mm have smaller letters, down to four fifths.
    /// - Ticks are multiples of 1, 2 or 5; a common power of ten or offset stands once at the end of the axis.
    /// - Long curves are drawn with fewer points, no farther than 0.1 pixels from all of them; only where all curves together would
    ///   still have more than 100 000 points, the longest keep the first, lowest, highest and last point of wider columns.
    ///
    /// # Errors
    /// [`ReportError::LengthMismatch`] for a curve with unequal numbers of x and y; [`ReportError::TooManyPanels`] above 64 panels
    /// and [`ReportError::TooManyCurves`] above 2000 curves; [`ReportError::TooSmall`] where the size leaves no room.
    pub fn render(&self) -> Result<Rendered, ReportError> {
        self.draw()?.rendered()
    }

    /// As [`Self::render`], where not all formats are wanted.
    ///
    /// # Errors
    /// As there.
    pub fn draw(&self) -> Result<Drawn, ReportError> {
        let curves = || self.panels.iter().flat_map(|panel| &panel.curves);
        if self.panels.len() > MOST_PANELS {
            return Err(ReportError::TooManyPanels { panels: self.panels.len(), limit: MOST_PANELS });
        }
        if curves().count() > MOST_CURVES {
            return Err(ReportError::TooManyCurves { curves: curves().count(), limit: MOST_CURVES });
        }
        if let Some(Curve { label, x, y, .. }) = curves().find(|curve| curve.x.len() != curve.y.len()) {
            return Err(ReportError::LengthMismatch { curve: label.clone(), x: x.len(), y: y.len() });
        }
        let font = draw::Font::load()?;
        Ok(Drawn::new(layout::scene(self, &font)?, font))
    }
}
