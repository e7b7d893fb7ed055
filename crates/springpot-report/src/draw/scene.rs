//! What a figure is made of.

use super::Color;

/// A position in pixels, y downwards.
pub(crate) type Point = [f64; 2];

/// How a line is drawn; ends and corners are round unless `butt` is set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stroke {
    pub(crate) color: Color,
    pub(crate) width: f64,
    /// Lengths of dashes and gaps in pixels; empty for a solid line.
    pub(crate) dash: &'static [f64],
    pub(crate) butt: bool,
}

impl Stroke {
    pub(crate) fn new(color: Color, width: f64) -> Self {
        Self { color, width, dash: &[], butt: false }
    }

    pub(crate) fn dashed(self, dash: &'static [f64]) -> Self {
        Self { dash, butt: !dash.is_empty(), ..self }
    }

    pub(crate) fn butt(self) -> Self {
        Self { butt: true, ..self }
    }
}

/// Which end of a text its position names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Align {
    Start,
    Middle,
    End,
}

/// One line of text on its baseline.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Text {
    pub(crate) content: String,
    pub(crate) at: Point,
    pub(crate) size: f64,
    pub(crate) align: Align,
    pub(crate) color: Color,
    /// Reads upwards instead of to the right.
    pub(crate) upwards: bool,
    /// Has a rim in the colour of the paper, to stand out from lines below it.
    pub(crate) halo: bool,
}

/// The geometry of a shape.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Outline {
    /// Lines through points; several where the curve has gaps.
    Lines(Vec<Vec<Point>>),
    Polygon(Vec<Point>),
    Circle {
        center: Point,
        radius: f64,
    },
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Shape {
    Drawn { outline: Outline, fill: Option<Color>, stroke: Option<Stroke> },
    Text(Text),
}

/// A figure: shapes from back to front.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Scene {
    pub(crate) width: f64,
    pub(crate) height: f64,
    /// Width on paper, pixels of 1/96 inch, where it is not that of the shapes: the scene is shrunk to it.
    pub(crate) paper_width: Option<f64>,
    /// What a screen reader says.
    pub(crate) title: String,
    /// What it does not show.
    pub(crate) remarks: Vec<String>,
    pub(crate) shapes: Vec<Shape>,
}

impl Scene {
    /// Its size on paper, pixels of 1/96 inch.
    pub(crate) fn page(&self) -> [f64; 2] {
        let width = self.paper_width.unwrap_or(self.width);
        [width, self.height * width / self.width]
    }

    pub(crate) fn line(&mut self, points: &[Point], stroke: Stroke) {
        self.lines(vec![points.to_vec()], stroke);
    }

    pub(crate) fn lines(&mut self, runs: Vec<Vec<Point>>, stroke: Stroke) {
        self.draw(Outline::Lines(runs), None, Some(stroke));
    }

    pub(crate) fn draw(&mut self, outline: Outline, fill: Option<Color>, stroke: Option<Stroke>) {
        self.shapes.push(Shape::Drawn { outline, fill, stroke });
    }

    pub(crate) fn dot(&mut self, center: Point, radius: f64, color: Color) {
        self.draw(Outline::Circle { center, radius }, Some(color), None);
    }

    pub(crate) fn text(&mut self, text: Text) {
        self.shapes.push(Shape::Text(text));
    }

    /// Moves every shape.
    pub(crate) fn shift(&mut self, [dx, dy]: Point) {
        let move_by = |point: &mut Point| *point = [point[0] + dx, point[1] + dy];
        for shape in &mut self.shapes {
            match shape {
                Shape::Drawn { outline: Outline::Lines(runs), .. } => runs.iter_mut().flatten().for_each(move_by),
                Shape::Drawn { outline: Outline::Polygon(points), .. } => points.iter_mut().for_each(move_by),
                Shape::Drawn { outline: Outline::Circle { center, .. }, .. } => move_by(center),
                Shape::Text(text) => move_by(&mut text.at),
            }
        }
    }
}

impl Text {
    pub(crate) fn new(content: impl Into<String>, at: Point, size: f64, align: Align) -> Self {
        Self { content: content.into(), at, size, align, color: super::INK, upwards: false, halo: false }
    }

    pub(crate) fn color(self, color: Color) -> Self {
        Self { color, ..self }
    }

    pub(crate) fn upwards(self) -> Self {
        Self { upwards: true, ..self }
    }

    pub(crate) fn halo(self) -> Self {
        Self { halo: true, ..self }
    }
}
