//! The shipped font: widths and outlines.

use super::script::{DROP, LOWERED, pieces};
use ttf_parser::{Face, FaceParsingError, GlyphId, OutlineBuilder};

/// Height of capital letters and digits, in em.
const CAP_HEIGHT: f64 = 0.729;

const FILE: &[u8] = include_bytes!("../../fonts/DejaVuSans-subset.ttf");

/// DejaVu Sans, cut to the characters figures need (`fonts/README.md`).
pub(crate) struct Font {
    face: Face<'static>,
    unit: f64,
}

/// One glyph of a text, in em of the text's size.
#[derive(Clone, Copy)]
pub(crate) struct Glyph {
    pub(crate) id: GlyphId,
    pub(crate) character: char,
    /// Where it starts on the line.
    pub(crate) pen: f64,
    /// Its size, and how far below the line it stands.
    pub(crate) scale: f64,
    pub(crate) drop: f64,
}

impl Font {
    pub(crate) fn load() -> Result<Self, FaceParsingError> {
        let face = Face::parse(FILE, 0)?;
        let unit = 1.0 / f64::from(face.units_per_em());
        Ok(Self { face, unit })
    }

    /// Width of a text set in `size` pixels.
    pub(crate) fn width(&self, text: &str, size: f64) -> f64 {
        let mut width = 0.0;
        self.walk(text, |glyph| width += glyph.scale * self.advance(glyph.id));
        width * size
    }

    /// Distance from the middle of the capitals down to the baseline.
    pub(crate) fn middle(size: f64) -> f64 {
        0.5 * CAP_HEIGHT * size
    }

    /// Hands over each glyph of a text.
    pub(crate) fn walk(&self, text: &str, mut place: impl FnMut(Glyph)) {
        let mut pen = 0.0;
        for piece in pieces(text) {
            let (scale, drop) = if piece.lowered { (LOWERED, DROP) } else { (1.0, 0.0) };
            for character in piece.text.chars() {
                let id = self.glyph(character);
                place(Glyph { id, character, pen, scale, drop });
                pen += scale * self.advance(id);
            }
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

    /// The file.
    pub(crate) fn file(&self) -> &'static [u8] {
        FILE
    }

    pub(crate) fn face(&self) -> &Face<'static> {
        &self.face
    }

    fn glyph(&self, c: char) -> GlyphId {
        self.face.glyph_index(c).unwrap_or(GlyphId(0))
    }

    /// How far the pen moves on, em.
    pub(crate) fn advance(&self, glyph: GlyphId) -> f64 {
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
