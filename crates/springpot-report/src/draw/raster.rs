//! A scene as a PNG file.

use super::scene::{Align, Outline, Point, Scene, Shape, Stroke, Text};
use super::{Color, Font, PAPER};
use crate::ReportError;
use tiny_skia::{FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, StrokeDash, Transform};
use ttf_parser::OutlineBuilder;

/// Pixels per unit of the scene: 240 dpi.
const SCALE: f64 = 2.5;
/// Pixels per metre of paper: 240 per inch.
const PIXELS_PER_METRE: f64 = 9449.0;
/// Largest picture, pixels.
const MOST_PIXELS: f64 = 120e6;
/// Segments stroked at once.
const PIECE: usize = 256;

pub(super) fn write(scene: &Scene, font: &Font) -> Result<Vec<u8>, ReportError> {
    let (width, height) = ((scene.width * SCALE).ceil(), (scene.height * SCALE).ceil());
    let too_large = ReportError::Canvas { width: width as u32, height: height as u32 };
    if width * height > MOST_PIXELS {
        return Err(too_large);
    }
    let mut canvas = Canvas { pixmap: Pixmap::new(width as u32, height as u32).ok_or(too_large)?, font };
    canvas.pixmap.fill(tiny_skia::Color::from_rgba8(PAPER.0, PAPER.1, PAPER.2, 255));
    for shape in &scene.shapes {
        match shape {
            Shape::Drawn { outline, fill, stroke } => canvas.draw(outline, *fill, *stroke),
            Shape::Text(text) => canvas.text(text),
        }
    }
    encode(&canvas.pixmap, (PIXELS_PER_METRE * scene.width / scene.page()[0]).round() as u32)
}

struct Canvas<'a> {
    pixmap: Pixmap,
    font: &'a Font,
}

impl Canvas<'_> {
    fn draw(&mut self, outline: &Outline, fill: Option<Color>, stroke: Option<Stroke>) {
        if let (Outline::Lines(runs), None, Some(stroke)) = (outline, fill, stroke) {
            return runs.iter().for_each(|run| self.stroke(run, stroke));
        }
        let Some(path) = outline_path(outline) else { return };
        if let Some(color) = fill {
            self.pixmap.fill_path(&path, &paint(color), FillRule::Winding, scale(), None);
        }
        if let Some(stroke) = stroke {
            self.pixmap.stroke_path(&path, &paint(stroke.color), &pen(stroke), scale(), None);
        }
    }

    /// Strokes a line piece by piece: the rasteriser's time grows with the square of the edges in one path.
    fn stroke(&mut self, points: &[Point], stroke: Stroke) {
        let mut phase = 0.0;
        let mut start = 0;
        while start < points.len() {
            let piece = &points[start..(start + PIECE + 1).min(points.len())];
            let mut pen = pen(stroke);
            pen.dash = dash(stroke, phase);
            if let Some(path) = lines_path(piece) {
                self.pixmap.stroke_path(&path, &paint(stroke.color), &pen, scale(), None);
            }
            if !stroke.dash.is_empty() {
                phase += piece.windows(2).map(|p| (p[1][0] - p[0][0]).hypot(p[1][1] - p[0][1])).sum::<f64>();
            }
            start += PIECE;
        }
    }

    fn text(&mut self, text: &Text) {
        let Some(path) = text_path(text, self.font) else { return };
        if text.halo {
            let rim = pen(Stroke::new(PAPER, 3.0));
            self.pixmap.stroke_path(&path, &paint(PAPER), &rim, scale(), None);
        }
        self.pixmap.fill_path(&path, &paint(text.color), FillRule::Winding, scale(), None);
    }
}

fn scale() -> Transform {
    Transform::from_scale(SCALE as f32, SCALE as f32)
}

fn paint(color: Color) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(color.0, color.1, color.2, 255);
    paint
}

fn pen(stroke: Stroke) -> tiny_skia::Stroke {
    tiny_skia::Stroke {
        width: stroke.width as f32,
        line_cap: if stroke.butt { LineCap::Butt } else { LineCap::Round },
        line_join: LineJoin::Round,
        dash: dash(stroke, 0.0),
        ..Default::default()
    }
}

fn dash(stroke: Stroke, phase: f64) -> Option<StrokeDash> {
    StrokeDash::new(stroke.dash.iter().map(|length| *length as f32).collect(), phase as f32)
}

fn lines_path(points: &[Point]) -> Option<Path> {
    let mut builder = PathBuilder::new();
    trace(&mut builder, points);
    builder.finish()
}

fn outline_path(outline: &Outline) -> Option<Path> {
    let mut builder = PathBuilder::new();
    match outline {
        Outline::Circle { center: [x, y], radius } => builder.push_circle(*x as f32, *y as f32, *radius as f32),
        Outline::Lines(runs) => runs.iter().for_each(|run| trace(&mut builder, run)),
        Outline::Polygon(points) => {
            trace(&mut builder, points);
            builder.close();
        }
    }
    builder.finish()
}

fn trace(builder: &mut PathBuilder, points: &[Point]) {
    for (i, [x, y]) in points.iter().enumerate() {
        match i {
            0 => builder.move_to(*x as f32, *y as f32),
            _ => builder.line_to(*x as f32, *y as f32),
        }
    }
}

fn text_path(text: &Text, font: &Font) -> Option<Path> {
    let width = font.width(&text.content, 1.0);
    let start = match text.align {
        Align::Start => 0.0,
        Align::Middle => -0.5 * width,
        Align::End => -width,
    };
    let mut glyphs = Glyphs { builder: PathBuilder::new(), text, unit: font.unit(), pen: start, drop: 0.0 };
    font.walk(&text.content, |glyph| {
        (glyphs.pen, glyphs.drop, glyphs.unit) = (start + glyph.pen, glyph.drop, glyph.scale * font.unit());
        font.outline(glyph.id, &mut glyphs);
    });
    glyphs.builder.finish()
}

/// Puts glyph outlines (font units, y upwards) where a text stands.
struct Glyphs<'a> {
    builder: PathBuilder,
    text: &'a Text,
    unit: f64,
    pen: f64,
    drop: f64,
}

impl Glyphs<'_> {
    fn place(&self, x: f32, y: f32) -> (f32, f32) {
        let along = (self.pen + f64::from(x) * self.unit) * self.text.size;
        let above = (f64::from(y) * self.unit - self.drop) * self.text.size;
        let [x, y] = self.text.at;
        let (x, y) = if self.text.upwards { (x - above, y - along) } else { (x + along, y - above) };
        (x as f32, y as f32)
    }
}

impl OutlineBuilder for Glyphs<'_> {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.place(x, y);
        self.builder.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.place(x, y);
        self.builder.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ((x1, y1), (x, y)) = (self.place(x1, y1), self.place(x, y));
        self.builder.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let ((x1, y1), (x2, y2), (x, y)) = (self.place(x1, y1), self.place(x2, y2), self.place(x, y));
        self.builder.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.builder.close();
    }
}

fn encode(pixmap: &Pixmap, per_metre: u32) -> Result<Vec<u8>, ReportError> {
    // The canvas is opaque, so that premultiplied and plain colours agree and alpha can go.
    let rgb: Vec<u8> = pixmap.data().chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, pixmap.width(), pixmap.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    encoder.set_pixel_dims(Some(png::PixelDimensions { xppu: per_metre, yppu: per_metre, unit: png::Unit::Meter }));
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&rgb)?;
    writer.finish()?;
    Ok(file)
}
