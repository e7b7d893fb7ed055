//! Colours.

/// An opaque sRGB colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Color(pub(crate) u8, pub(crate) u8, pub(crate) u8);

/// Text and axes.
pub(crate) const INK: Color = Color(0x22, 0x22, 0x22);
/// The ground of every figure.
pub(crate) const PAPER: Color = Color(0xff, 0xff, 0xff);

impl std::fmt::Display for Color {
    /// The form SVG reads: `#rrggbb`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "#{:02x}{:02x}{:02x}", self.0, self.1, self.2)
    }
}
