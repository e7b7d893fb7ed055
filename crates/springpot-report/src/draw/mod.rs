//! Shapes in pixels, and the two ways of writing them: SVG and PNG.

mod color;
mod font;
mod raster;
mod scene;
mod svg;
mod wrap;

pub(crate) use color::{Color, INK, PAPER};
pub(crate) use font::Font;
pub(crate) use scene::{Align, Outline, Point, Scene, Stroke, Text};
pub(crate) use wrap::wrap;

use crate::{Rendered, ReportError};

/// Writes a scene in both formats, on a page of whole, even pixels so that the raster's scale is exact.
pub(crate) fn render(mut scene: Scene, font: &Font) -> Result<Rendered, ReportError> {
    let even = |size: f64| 2.0 * (0.5 * size).ceil();
    (scene.width, scene.height) = (even(scene.width), even(scene.height));
    Ok(Rendered { svg: svg::write(&scene), png: raster::write(&scene, font)? })
}
