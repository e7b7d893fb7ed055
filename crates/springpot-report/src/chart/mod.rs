//! Curves in panels, with axes and a legend.

mod axes;
mod data;
mod decimate;
mod layout;
mod legend;
mod style;
mod ticks;

use crate::{Rendered, ReportError, draw};

/// Panels of one figure.
const MOST_PANELS: usize = 64;
/// Curves of one figure, over all panels.
const MOST_CURVES: usize = 2000;

/// A figure of curves: one or more panels with the same axes and one legend to their right.
///
/// All text may hold any Unicode: Greek letters, sub- and superscripts are in the shipped font. Labels carry their units as text,
/// such as `"Q₂ of strut, N·m"`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plot {
    /// Stands above the panels.
    pub title: Option<String>,
    /// Quantity and unit along x, for all panels.
    pub x_label: String,
    /// Quantity and unit along y, for all panels.
    pub y_label: String,
    /// Stands above the legend.
    pub legend_title: Option<String>,
    /// In reading order: one panel fills the figure, several make a grid of at most four columns. No panel gives an empty one.
    pub panels: Vec<Panel>,
}

/// One pair of axes and its curves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Panel {
    /// Stands above the panel.
    pub title: Option<String>,
    /// From back to front. Without any finite point the panel says "no data".
    pub curves: Vec<Curve>,
}

/// One line. Curves of the same label, in any panel, look the same and share one legend entry.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    /// Legend entry; an empty one makes no entry.
    pub label: String,
    /// Abscissae, in any order: loops are fine.
    pub x: Vec<f64>,
    /// Ordinates, as many as x. A point of which a coordinate is NaN, infinite or beyond 1e300 is a gap in the line.
    pub y: Vec<f64>,
}

impl Plot {
    /// Draws the figure.
    ///
    /// - The legend lists labels in the order in which they first appear. Three labels or more that differ only in one number,
    ///   rising or falling, are coloured from dark to light (plasma); others get distinct colours and dashes.
    /// - x ends at the data (with a margin where a curve runs back); y has a margin of 5 %. All panels share x; they share y too,
    ///   unless one of them would come out flatter than a twentieth of the range. A constant curve gets ±10 % around it.
    /// - Ticks are multiples of 1, 2 or 5; a common power of ten or offset stands once at the end of the axis.
    /// - A curve with more points than pixels keeps the first, lowest, highest and last point of every column.
    ///
    /// # Errors
    /// [`ReportError::LengthMismatch`] for a curve with unequal numbers of x and y; [`ReportError::TooManyPanels`] above 64 panels
    /// and [`ReportError::TooManyCurves`] above 2000 curves.
    pub fn render(&self) -> Result<Rendered, ReportError> {
        let curves = || self.panels.iter().flat_map(|panel| &panel.curves);
        if self.panels.len() > MOST_PANELS {
            return Err(ReportError::TooManyPanels { panels: self.panels.len(), limit: MOST_PANELS });
        }
        if curves().count() > MOST_CURVES {
            return Err(ReportError::TooManyCurves { curves: curves().count(), limit: MOST_CURVES });
        }
        if let Some(Curve { label, x, y }) = curves().find(|curve| curve.x.len() != curve.y.len()) {
            return Err(ReportError::LengthMismatch { curve: label.clone(), x: x.len(), y: y.len() });
        }
        let font = draw::Font::load()?;
        draw::render(layout::scene(self, &font), &font)
    }
}
