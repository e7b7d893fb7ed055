//! Shapes in pixels, and the three ways of writing them: SVG, PNG and PDF.

mod color;
mod font;
mod pdf;
mod raster;
mod scene;
mod script;
mod svg;
mod wrap;

pub(crate) use color::{Color, INK, PAPER};
pub(crate) use font::Font;
pub(crate) use scene::{Align, Outline, Point, Scene, Stroke, Text};
pub(crate) use wrap::{wrap, wrap_evenly};

use crate::{Rendered, ReportError};

/// Writes a scene in all formats.
pub(crate) fn render(scene: &Scene, font: &Font) -> Result<Rendered, ReportError> {
    Ok(Rendered {
        svg: svg::write(scene),
        png: raster::write(scene, font)?,
        pdf: pdf::write(scene, font),
        remarks: scene.remarks.clone(),
    })
}
