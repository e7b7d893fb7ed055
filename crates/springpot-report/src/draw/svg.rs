//! A scene as an SVG document.

use super::scene::{Align, Outline, Point, Scene, Shape, Stroke, Text};
use super::script::{DROP, LOWERED, pieces, plain};
use super::{Color, PAPER};
use std::fmt::Write;

/// Verdana comes second because it is as wide as DejaVu Sans.
const FAMILY: &str = "'DejaVu Sans', Verdana, Arial, sans-serif";

pub(super) fn write(scene: &Scene) -> String {
    let mut svg = String::new();
    let (width, height) = (Number(scene.width), Number(scene.height));
    let [page_width, page_height] = scene.page().map(Number);
    let _ = write!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{page_width}\" height=\"{page_height}\" viewBox=\"0 0 {width} {height}\" \
         font-family=\"{FAMILY}\" fill=\"none\" stroke-linejoin=\"round\" stroke-linecap=\"round\" role=\"img\">\n\
         <title>{}</title>\n<rect width=\"{width}\" height=\"{height}\" fill=\"{PAPER}\"/>\n",
        Escaped(&plain(&scene.title))
    );
    for shape in &scene.shapes {
        match shape {
            Shape::Drawn { outline, fill, stroke } => drawn(&mut svg, outline, *fill, *stroke),
            Shape::Text(text) => write_text(&mut svg, text),
        }
    }
    svg.push_str("</svg>\n");
    svg
}

fn drawn(svg: &mut String, outline: &Outline, fill: Option<Color>, stroke: Option<Stroke>) {
    match outline {
        Outline::Circle { center: [x, y], radius } => {
            let _ = write!(svg, "<circle cx=\"{}\" cy=\"{}\" r=\"{}\"", Number(*x), Number(*y), Number(*radius));
        }
        Outline::Lines(runs) => {
            svg.push_str("<path d=\"");
            runs.iter().for_each(|run| path(svg, run));
            svg.push('"');
        }
        Outline::Polygon(points) => {
            svg.push_str("<path d=\"");
            path(svg, points);
            svg.push_str("Z\"");
        }
    }
    if let Some(color) = fill {
        let _ = write!(svg, " fill=\"{color}\"");
    }
    if let Some(stroke) = stroke {
        let _ = write!(svg, " stroke=\"{}\" stroke-width=\"{}\"", stroke.color, Number(stroke.width));
        for (i, length) in stroke.dash.iter().enumerate() {
            let _ = write!(svg, "{}{}", if i == 0 { " stroke-dasharray=\"" } else { " " }, Number(*length));
        }
        if !stroke.dash.is_empty() {
            svg.push('"');
        }
        if stroke.butt {
            svg.push_str(" stroke-linecap=\"butt\"");
        }
    }
    svg.push_str("/>\n");
}

fn path(svg: &mut String, points: &[Point]) {
    for (i, [x, y]) in points.iter().enumerate() {
        let _ = write!(svg, "{}{} {}", if i == 0 { 'M' } else { 'L' }, Number(*x), Number(*y));
    }
}

fn write_text(svg: &mut String, text: &Text) {
    if text.halo {
        // A text of its own: not every reader knows `paint-order`.
        let rim = format!("stroke=\"{PAPER}\" stroke-width=\"3\" aria-hidden=\"true\"");
        text_element(svg, text, &rim);
    }
    text_element(svg, text, &format!("fill=\"{}\"", text.color));
}

fn text_element(svg: &mut String, text: &Text, paint: &str) {
    let ([x, y], size) = (text.at.map(Number), Number(text.size));
    let _ = write!(svg, "<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\" {paint}");
    match text.align {
        Align::Start => {}
        Align::Middle => svg.push_str(" text-anchor=\"middle\""),
        Align::End => svg.push_str(" text-anchor=\"end\""),
    }
    if text.upwards {
        let _ = write!(svg, " transform=\"rotate(-90 {x} {y})\"");
    }
    svg.push('>');
    let mut lowered = false;
    for piece in pieces(&text.content) {
        let words = Escaped(piece.text);
        // The line goes on where the last piece left it.
        let _ = match (lowered, piece.lowered) {
            (false, false) => write!(svg, "{words}"),
            (true, false) => write!(svg, "<tspan dy=\"{}\">{words}</tspan>", Number(-DROP * text.size)),
            (_, true) => {
                let (down, size) = (Number(DROP * text.size), Number(LOWERED * text.size));
                write!(svg, "<tspan dy=\"{down}\" font-size=\"{size}\">{words}</tspan>")
            }
        };
        lowered = piece.lowered;
    }
    svg.push_str("</text>\n");
}

/// A coordinate with at most two decimals.
struct Number(f64);

impl std::fmt::Display for Number {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let hundredths = (self.0 * 100.0).round() as i64;
        let (sign, size) = (if hundredths < 0 { "-" } else { "" }, hundredths.unsigned_abs());
        match (size / 100, size % 100) {
            (whole, 0) => write!(f, "{sign}{whole}"),
            (whole, rest) if rest % 10 == 0 => write!(f, "{sign}{whole}.{}", rest / 10),
            (whole, rest) => write!(f, "{sign}{whole}.{rest:02}"),
        }
    }
}

/// Text with XML's special characters as entities and the characters XML forbids left out.
struct Escaped<'a>(&'a str);

impl std::fmt::Display for Escaped<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for c in self.0.chars() {
            match c {
                '&' => f.write_str("&amp;")?,
                '<' => f.write_str("&lt;")?,
                '>' => f.write_str("&gt;")?,
                '"' => f.write_str("&quot;")?,
                '\u{fffe}' | '\u{ffff}' => {}
                c if c.is_control() => {}
                c => f.write_char(c)?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let written: Vec<String> =
            [0.0, -0.001, 1.0, -1.5, 2.25, 2.05, 1e6, 123.456].iter().map(|v| Number(*v).to_string()).collect();
        assert_eq!(written, ["0", "0", "1", "-1.5", "2.25", "2.05", "1000000", "123.46"]);
    }

    #[test]
    fn xml_specials_are_escaped() {
        assert_eq!(Escaped("a<b & \"c\">\u{1}d").to_string(), "a&lt;b &amp; &quot;c&quot;&gt;d");
    }
}
