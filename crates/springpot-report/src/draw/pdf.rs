//! A scene as a PDF file of one page: lines as lines, text as text, the font inside.

use super::font::Glyph;
use super::scene::{Align, Outline, Point, Scene, Shape, Stroke, Text};
use super::script::plain;
use super::{Color, Font, PAPER};
use miniz_oxide::deflate::compress_to_vec_zlib;
use pdf_writer::types::{
    CidFontType, FontFlags, LineCapStyle, LineJoinStyle, SystemInfo, TextRenderingMode, UnicodeCmap,
};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, Str, TextStr};
use std::collections::BTreeMap;
use ttf_parser::GlyphId;

/// Points of 1/72 inch in a pixel of 1/96.
const POINTS: f64 = 0.75;
const LEVEL: u8 = 6;
const FONT: Name<'_> = Name(b"F");
const FONT_NAME: Name<'_> = Name(b"DejaVuSans");
/// Control points of a quarter circle.
const ROUND: f64 = 0.552_284_75;
const SYSTEM: SystemInfo<'_> = SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };

pub(super) fn write(scene: &Scene, font: &Font) -> Vec<u8> {
    let [width, height] = scene.page().map(|side| POINTS * side);
    let scale = width / scene.width;
    let mut page = Sheet { content: Content::new(), font, used: BTreeMap::new() };
    page.content.set_fill_rgb(1.0, 1.0, 1.0).rect(0.0, 0.0, width as f32, height as f32).fill_nonzero();
    page.content.transform([scale as f32, 0.0, 0.0, -scale as f32, 0.0, height as f32]);
    page.content.set_line_join(LineJoinStyle::RoundJoin);
    for shape in &scene.shapes {
        match shape {
            Shape::Drawn { outline, fill, stroke } => page.draw(outline, *fill, *stroke),
            Shape::Text(text) => page.text(text),
        }
    }

    let [catalog, pages, leaf, body, info, rest] = [1, 2, 3, 4, 5, 6].map(Ref::new);
    let mut pdf = Pdf::new();
    pdf.catalog(catalog).pages(pages);
    pdf.pages(pages).kids([leaf]).count(1);
    let mut entry = pdf.page(leaf);
    entry.media_box(Rect::new(0.0, 0.0, width as f32, height as f32)).parent(pages).contents(body);
    entry.resources().fonts().pair(FONT, rest);
    entry.finish();
    pdf.document_info(info).title(TextStr(&plain(&scene.title)));
    let data = compress_to_vec_zlib(&page.content.finish(), LEVEL);
    pdf.stream(body, &data).filter(Filter::FlateDecode);
    embed(&mut pdf, rest, font, &page.used);
    pdf.finish()
}

struct Sheet<'a> {
    content: Content,
    font: &'a Font,
    /// What each glyph that is drawn stands for.
    used: BTreeMap<u16, char>,
}

impl Sheet<'_> {
    fn draw(&mut self, outline: &Outline, fill: Option<Color>, stroke: Option<Stroke>) {
        if let Some(color) = fill {
            let [r, g, b] = rgb(color);
            self.content.set_fill_rgb(r, g, b);
        }
        if let Some(stroke) = stroke {
            let [r, g, b] = rgb(stroke.color);
            let cap = if stroke.butt { LineCapStyle::ButtCap } else { LineCapStyle::RoundCap };
            self.content.set_stroke_rgb(r, g, b).set_line_width(stroke.width as f32).set_line_cap(cap);
            self.content.set_dash_pattern(stroke.dash.iter().map(|length| *length as f32), 0.0);
        }
        match outline {
            Outline::Lines(runs) => runs.iter().for_each(|run| self.trace(run)),
            Outline::Polygon(points) => {
                self.trace(points);
                self.content.close_path();
            }
            Outline::Circle { center, radius } => self.circle(*center, *radius),
        }
        match (fill, stroke) {
            (Some(_), Some(_)) => self.content.fill_nonzero_and_stroke(),
            (Some(_), None) => self.content.fill_nonzero(),
            (None, Some(_)) => self.content.stroke(),
            (None, None) => self.content.end_path(),
        };
    }

    fn trace(&mut self, points: &[Point]) {
        for (i, point) in points.iter().enumerate() {
            let [x, y] = point.map(rounded);
            if i == 0 {
                self.content.move_to(x, y)
            } else {
                self.content.line_to(x, y)
            };
        }
    }

    fn circle(&mut self, [x, y]: Point, r: f64) {
        let at = |a: f64, b: f64| [(x + r * a) as f32, (y + r * b) as f32];
        let [start_x, start_y] = at(1.0, 0.0);
        self.content.move_to(start_x, start_y);
        for (c, s) in [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)] {
            let (first, second, end) = (at(c - ROUND * s, s + ROUND * c), at(ROUND * c - s, ROUND * s + c), at(-s, c));
            self.content.cubic_to(first[0], first[1], second[0], second[1], end[0], end[1]);
        }
        self.content.close_path();
    }

    fn text(&mut self, text: &Text) {
        let mut glyphs: Vec<Glyph> = Vec::new();
        self.font.walk(&text.content, |glyph| glyphs.push(glyph));
        for glyph in &glyphs {
            self.used.entry(glyph.id.0).or_insert(glyph.character);
        }
        self.content.begin_text();
        if text.halo {
            let [r, g, b] = rgb(PAPER);
            self.content.set_stroke_rgb(r, g, b).set_line_width(3.0).set_dash_pattern([], 0.0);
            self.content.set_text_rendering_mode(TextRenderingMode::Stroke);
            self.show(text, &glyphs);
        }
        let [r, g, b] = rgb(text.color);
        self.content.set_text_rendering_mode(TextRenderingMode::Fill).set_fill_rgb(r, g, b);
        self.show(text, &glyphs);
        self.content.end_text();
    }

    /// Shows stretches of glyphs of one size.
    fn show(&mut self, text: &Text, glyphs: &[Glyph]) {
        let width = self.font.width(&text.content, 1.0);
        let start = match text.align {
            Align::Start => 0.0,
            Align::Middle => -0.5 * width,
            Align::End => -width,
        };
        for stretch in glyphs.chunk_by(|a, b| a.scale == b.scale) {
            let first = stretch[0];
            let (along, below) = ((start + first.pen) * text.size, first.drop * text.size);
            let [x, y] = text.at;
            let matrix = if text.upwards {
                [0.0, -1.0, -1.0, 0.0, x + below, y - along]
            } else {
                [1.0, 0.0, 0.0, -1.0, x + along, y + below]
            };
            let codes: Vec<u8> = stretch.iter().flat_map(|glyph| glyph.id.0.to_be_bytes()).collect();
            self.content.set_font(FONT, (first.scale * text.size) as f32);
            self.content.set_text_matrix(matrix.map(|number| number as f32)).show(Str(&codes));
        }
    }
}

/// Writes the font as the objects from `first` on.
fn embed(pdf: &mut Pdf, first: Ref, font: &Font, used: &BTreeMap<u16, char>) {
    let [cid, descriptor, cmap, file] = [1, 2, 3, 4].map(|next| Ref::new(first.get() + next));
    let face = font.face();
    let em = |units: i16| (1000.0 * f64::from(units) * font.unit()) as f32;
    pdf.type0_font(first)
        .base_font(FONT_NAME)
        .encoding_predefined(Name(b"Identity-H"))
        .descendant_font(cid)
        .to_unicode(cmap);
    let mut entry = pdf.cid_font(cid);
    entry.subtype(CidFontType::Type2).base_font(FONT_NAME).system_info(SYSTEM).font_descriptor(descriptor);
    entry.default_width(0.0).cid_to_gid_map_predefined(Name(b"Identity"));
    let mut widths = entry.widths();
    for id in used.keys() {
        widths.same(*id, *id, (1000.0 * font.advance(GlyphId(*id))) as f32);
    }
    widths.finish();
    entry.finish();
    let bounds = face.global_bounding_box();
    pdf.font_descriptor(descriptor)
        .name(FONT_NAME)
        .flags(FontFlags::NON_SYMBOLIC)
        .bbox(Rect::new(em(bounds.x_min), em(bounds.y_min), em(bounds.x_max), em(bounds.y_max)))
        .italic_angle(0.0)
        .ascent(em(face.ascender()))
        .descent(em(face.descender()))
        .cap_height(em(face.capital_height().unwrap_or(face.ascender())))
        .stem_v(80.0)
        .font_file2(file);
    let mut unicode = UnicodeCmap::new(Name(b"Custom"), SYSTEM);
    used.iter().for_each(|(id, character)| unicode.pair(*id, *character));
    pdf.cmap(cmap, &unicode.finish());
    let packed = compress_to_vec_zlib(font.file(), LEVEL);
    pdf.stream(file, &packed).filter(Filter::FlateDecode).pair(Name(b"Length1"), font.file().len() as i32);
}

fn rgb(color: Color) -> [f32; 3] {
    [color.0, color.1, color.2].map(|part| f32::from(part) / 255.0)
}

/// Two decimals, as in SVG.
fn rounded(pixels: f64) -> f32 {
    ((100.0 * pixels).round() / 100.0) as f32
}
