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
pub(crate) use wrap::{wrap, wrap_evenly, wrap_to_end};

use crate::{Rendered, ReportError};

/// A figure that is laid out; a format is written when it is asked for.
pub struct Drawn {
    scene: Scene,
    font: Font,
}

impl Drawn {
    pub(crate) fn new(scene: Scene, font: Font) -> Self {
        Self { scene, font }
    }

    /// As [`Rendered::svg`].
    pub fn svg(&self) -> String {
        svg::write(&self.scene)
    }

    /// As [`Rendered::png`].
    ///
    /// # Errors
    /// Where there is no room for so many pixels.
    pub fn png(&self) -> Result<Vec<u8>, ReportError> {
        raster::write(&self.scene, &self.font)
    }

    /// As [`Rendered::pdf`].
    pub fn pdf(&self) -> Vec<u8> {
        pdf::write(&self.scene, &self.font)
    }

    /// As [`Rendered::remarks`].
    pub fn remarks(&self) -> &[String] {
        &self.scene.remarks
    }

    /// It in all formats.
    ///
    /// # Errors
    /// As [`Self::png`].
    pub fn rendered(self) -> Result<Rendered, ReportError> {
        Ok(Rendered { svg: self.svg(), png: self.png()?, pdf: self.pdf(), remarks: self.scene.remarks })
    }
}
