//! The shipped font: widths and outlines.

use ttf_parser::{Face, FaceParsingError, GlyphId, OutlineBuilder};

/// Height of capital letters and digits, in em.
const CAP_HEIGHT: f64 = 0.729;

/// DejaVu Sans, cut to the characters figures need (`fonts/README.md`).
pub(crate) struct Font {
    face: Face<'static>,
    unit: f64,
}

impl Font {
    pub(crate) fn load() -> Result<Self, FaceParsingError> {
        let face = Face::parse(include_bytes!("../../fonts/DejaVuSans-subset.ttf"), 0)?;
        let unit = 1.0 / f64::from(face.units_per_em());
        Ok(Self { face, unit })
    }

    /// Width of a text set in `size` pixels.
    pub(crate) fn width(&self, text: &str, size: f64) -> f64 {
        text.chars().map(|c| self.advance(self.glyph(c))).sum::<f64>() * size
    }

    /// Distance from the middle of the capitals down to the baseline.
    pub(crate) fn middle(size: f64) -> f64 {
        0.5 * CAP_HEIGHT * size
    }

    /// Hands each glyph of a text with its pen position (em) to `place`.
    pub(crate) fn walk(&self, text: &str, mut place: impl FnMut(GlyphId, f64)) {
        let mut pen = 0.0;
        for glyph in text.chars().map(|c| self.glyph(c)) {
            place(glyph, pen);
            pen += self.advance(glyph);
        }
    }

    /// Draws one glyph's outline in font units, y upwards; a blank draws nothing.
    pub(crate) fn outline(&self, glyph: GlyphId, builder: &mut impl OutlineBuilder) {
        let _ = self.face.outline_glyph(glyph, builder);
    }

    /// One font unit, in em.
    pub(crate) fn unit(&self) -> f64 {
        self.unit
    }

    fn glyph(&self, c: char) -> GlyphId {
        self.face.glyph_index(c).unwrap_or(GlyphId(0))
    }

    fn advance(&self, glyph: GlyphId) -> f64 {
        f64::from(self.face.glyph_hor_advance(glyph).unwrap_or(0)) * self.unit
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn has_the_characters_of_labels() {
        let font = Font::load().unwrap();
        for c in "AZaz09αβγδλμπωΔΩ₀₁₂₃₉⁰¹²⁻⁹°·×−±≤≥∂∫√∞…→’ÄéñŁЖя℃".chars()
        {
            assert_ne!(font.glyph(c), GlyphId(0), "{c}");
        }
        assert_eq!(font.glyph('漢'), GlyphId(0));
    }

    #[test]
    fn digits_are_of_one_width() {
        let font = Font::load().unwrap();
        let width = font.width("0", 10.0);
        assert!(width > 5.0 && width < 7.0);
        for digit in '1'..='9' {
            assert_eq!(font.width(&digit.to_string(), 10.0), width);
        }
    }
}
