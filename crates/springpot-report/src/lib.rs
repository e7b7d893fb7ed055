//! Figures of Springpot results: curves ([`Plot`]), coloured cells ([`Map`]) and robots with their elements ([`RobotDrawing`]), as SVG, PNG and PDF.
//!
//! The crate takes plain numbers and text and knows nothing of the engine. Every figure is laid out once, in pixels of 1/96 inch
//! (y downwards), and written three times: as SVG and as PDF with text kept as text, and as PNG at 2.5 pixels per unit (240 dpi). A subset of
//! DejaVu Sans travels with the crate and draws all text (Latin, Greek, Cyrillic, sub- and superscripts, operators), so that no
//! font of the machine is read; the same input gives the same bytes. A character outside the subset is drawn as an empty box in
//! the PNG and left to the viewer's fonts in the SVG.
//!
//! ```
//! use springpot_report::{Curve, Panel, Plot};
//!
//! let x: Vec<f64> = (0..200).map(|i| 0.05 * f64::from(i)).collect();
//! let curve = |alpha: f64| Curve {
//!     label: format!("α = {alpha}"),
//!     y: x.iter().map(|t| (-alpha * t).exp() * (8.0 * t).sin()).collect(),
//!     x: x.clone(),
//!     ..Curve::default()
//! };
//! let plot = Plot {
//!     title: Some("Generalized force Q₂ at 25 °C".into()),
//!     x: "t, s".into(),
//!     y: "Q₂ of strut, N·m".into(),
//!     panels: vec![Panel { curves: vec![curve(0.1), curve(0.5), curve(0.9)], ..Panel::default() }],
//!     ..Plot::default()
//! };
//! let figure = plot.render()?;
//! assert!(figure.svg.contains("α = 0.5"));
//! # Ok::<(), springpot_report::ReportError>(())
//! ```

mod chart;
mod draw;
pub mod formula;
pub mod gltf;
pub mod latex;
mod mesh;
pub mod page;
pub mod recording;
mod robot;
pub mod scene;
mod surface;
pub mod vector;

pub use chart::{Axis, Curve, Map, MapAxis, Panel, Plot, Scale};
pub use draw::Drawn;
pub use mesh::MeshFile;
pub use robot::{ElementMark, ElementShape, ElementSign, JointKind, JointMark, Link, RobotDrawing, WORLD};

/// Width of a figure without a size of its own, mm.
pub const WIDTH: f64 = 150.0;

/// Pixels of 1/96 inch in a millimetre.
const PIXELS_PER_MM: f64 = 96.0 / 25.4;

/// One figure in all formats.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rendered {
    /// The figure as an SVG 1.1 document; its size is in pixels of 1/96 inch.
    pub svg: String,
    /// The same figure as a PDF file of one page, with its font inside.
    pub pdf: Vec<u8>,
    /// The same figure as a PNG file with 2.5 pixels per SVG unit and its physical size recorded (240 dpi).
    pub png: Vec<u8>,
    /// What it does not show: values that a logarithmic axis has no place for, names that found no room; a clause each.
    pub remarks: Vec<String>,
}

/// Why a figure could not be drawn.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// A curve's coordinates do not pair up: give as many x as y.
    #[error("curve `{curve}` has {x} x values and {y} y values; it needs as many of one as of the other")]
    LengthMismatch {
        /// The curve's label.
        curve: String,
        /// Number of x values.
        x: usize,
        /// Number of y values.
        y: usize,
    },
    /// More panels than one page can hold: split the figure.
    #[error("{panels} panels do not fit into one figure (at most {limit}); draw several figures")]
    TooManyPanels {
        /// Panels asked for.
        panels: usize,
        /// Panels allowed.
        limit: usize,
    },
    /// More curves than a figure can show: split the figure.
    #[error("{curves} curves do not fit into one figure (at most {limit}); draw several figures")]
    TooManyCurves {
        /// Curves asked for, over all panels.
        curves: usize,
        /// Curves allowed.
        limit: usize,
    },
    /// More cells than a map can show.
    #[error("{cells} cells do not fit into one map (at most {limit}); draw fewer of them")]
    TooManyCells {
        /// Cells asked for.
        cells: usize,
        /// Cells allowed.
        limit: usize,
    },
    /// Nothing is left for the curves: give the figure more room, or fewer words.
    #[error("a figure of {width:.0} by {height:.0} mm leaves no room for curves beside its labels and its legend")]
    TooSmall {
        /// Width, mm.
        width: f64,
        /// Height, mm.
        height: f64,
    },
    /// A point of the robot is NaN or infinite.
    #[error("the position of `{what}` is not finite")]
    NotFinite {
        /// Name of the link, joint or element, or `gripper` or `ground`.
        what: String,
    },
    /// The picture is larger than the memory set aside for it.
    #[error("a picture of {width} by {height} pixels is too large")]
    Canvas {
        /// Width, pixels.
        width: u32,
        /// Height, pixels.
        height: u32,
    },
    /// The shipped font could not be read.
    #[error("the shipped font is damaged")]
    Font(#[from] ttf_parser::FaceParsingError),
    /// The PNG file could not be written.
    #[error("the PNG could not be encoded")]
    Png(#[from] png::EncodingError),
}
