//! The signs of a mechanism sketch, in pixels.

use super::ElementSign;
use super::element::{self, Drawn};
use super::labels::{Frame, Obstacles};
use super::plane::{direction, normal, offset};
use crate::draw::{Color, INK, Outline, PAPER, Point, Scene, Stroke};
use std::f64::consts::{SQRT_2, TAU};

pub(super) const ELEMENT: Color = Color(0xc0, 0x39, 0x1b);
const AXIS: Color = Color(0x55, 0x55, 0x55);
const PLINTH: Color = Color(0xd9, 0xd9, 0xd9);
/// Thickness of a body and of its arms.
pub(super) const BODY: f64 = 8.0;
pub(super) const ARM: f64 = 4.0;
/// Radius of a revolute joint.
pub(super) const JOINT: f64 = 6.5;
/// Radius of the spiral on a joint and of the ring of a bushing.
pub(super) const SPIRAL: f64 = 17.0;
/// Half length of an element beside a joint that slides.
pub(super) const SLIDE: f64 = 32.0;
/// And its distance from the joint's axis.
const BESIDE: f64 = 28.0;
pub(super) const RING: f64 = 11.0;
const DASH_DOT: &[f64] = &[8.0, 2.5, 1.5, 2.5];

/// A drawing with what later labels must keep clear of.
#[derive(Default)]
pub(super) struct Sheet {
    pub(super) scene: Scene,
    pub(super) obstacles: Obstacles,
}

impl Sheet {
    /// A body's centre line: a bar with a dark rim, set off by a white edge from what lies behind it.
    pub(super) fn body(&mut self, points: &[Point], color: Color, width: f64) {
        self.scene.line(points, Stroke::new(PAPER, width + 3.5));
        self.scene.line(points, Stroke::new(INK, width));
        self.scene.line(points, Stroke::new(color, width - 2.2));
        self.obstacles.line(points, width);
    }

    /// An element with the sign of its law between two straight ends.
    pub(super) fn element(&mut self, from: Point, to: Point, sign: &ElementSign) {
        let (along, length) = direction(from, to);
        let Drawn { lines, closed, half } = element::draw(sign, from, along, length);
        let width = if matches!(sign, ElementSign::Parallel(_)) { 1.5 } else { 1.9 };
        self.scene.lines(lines.clone(), Stroke::new(PAPER, width + 3.1));
        for shape in closed {
            self.scene.draw(Outline::Polygon(shape), Some(PAPER), Some(Stroke::new(ELEMENT, width)));
        }
        self.scene.lines(lines, Stroke::new(ELEMENT, width));
        self.obstacles.line(&[from, to], 2.0);
        let middle = offset(from, 0.5 * length, along);
        let [long, high] = half.unwrap_or([0.0, 1.0]);
        self.obstacles.line(&[offset(middle, -long, along), offset(middle, long, along)], 2.0 * high);
    }

    /// Straight pieces of a cable.
    pub(super) fn cable(&mut self, points: &[Point]) {
        if points.len() > 1 {
            self.scene.line(points, Stroke::new(PAPER, 5.0));
            self.scene.line(points, Stroke::new(ELEMENT, 1.9));
            self.obstacles.line(points, 2.0);
        }
    }

    /// What a cable runs over.
    pub(super) fn roller(&mut self, at: Point) {
        let circle = |radius| Outline::Circle { center: at, radius };
        self.scene.draw(circle(5.5), Some(PAPER), Some(Stroke::new(ELEMENT, 1.6)));
        self.scene.draw(circle(1.4), Some(ELEMENT), None);
        self.obstacles.frame(Frame::sized(at, [6.5; 2]));
    }

    /// A torsion spring about a joint.
    pub(super) fn spiral(&mut self, at: Point) {
        let point = |i: i32| {
            let share = f64::from(i) / 90.0;
            let (sine, cosine) = (share * 2.25 * TAU).sin_cos();
            let radius = JOINT + 1.5 + share * (SPIRAL - JOINT - 1.5);
            [at[0] + radius * cosine, at[1] - radius * sine]
        };
        let spiral: Vec<Point> = (0..=90).map(point).collect();
        self.scene.line(&spiral, Stroke::new(PAPER, 3.6));
        self.scene.line(&spiral, Stroke::new(ELEMENT, 1.7));
        self.obstacles.frame(Frame::sized(at, [SPIRAL; 2]));
    }

    /// An element beside a joint that slides.
    pub(super) fn slide(&mut self, at: Point, along: Point, sign: &ElementSign) {
        let across = normal(along);
        let corner = |a: f64, b: f64| offset(offset(at, a, along), b, across);
        self.element(corner(-SLIDE, -BESIDE), corner(SLIDE, -BESIDE), sign);
        for end in [-SLIDE, SLIDE] {
            // Without a white edge, which would cut the element's ends.
            let bracket = [corner(end, 0.0), corner(end, -BESIDE)];
            self.scene.line(&bracket, Stroke::new(ELEMENT, 1.9));
            self.obstacles.line(&bracket, 2.0);
        }
    }

    /// A ring of rubber between two frames.
    pub(super) fn bushing(&mut self, from: Point, to: Point) {
        self.cable(&[from, to]);
        let at = [0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])];
        let circle = |radius| Outline::Circle { center: at, radius };
        self.scene.draw(circle(RING), Some(PAPER), Some(Stroke::new(ELEMENT, 1.8)));
        // Strokes at 45° that end on the ring.
        let strokes = [-0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75].map(|share| {
            let half = (1.0f64 - share * share).sqrt();
            let corner = |side: f64| [share + side * half, share - side * half].map(|x| x * RING / SQRT_2);
            [1.0, -1.0].map(corner).map(|[x, y]| [at[0] + x, at[1] + y]).to_vec()
        });
        self.scene.lines(strokes.to_vec(), Stroke::new(ELEMENT, 0.9));
        self.scene.draw(circle(4.0), Some(PAPER), Some(Stroke::new(ELEMENT, 1.6)));
        self.obstacles.frame(Frame::sized(at, [RING + 1.0; 2]));
    }

    /// The pin that ends an element.
    pub(super) fn pin(&mut self, at: Point) {
        let circle = Outline::Circle { center: at, radius: 3.2 };
        self.scene.draw(circle, Some(ELEMENT), Some(Stroke::new(PAPER, 1.0)));
        self.obstacles.line(&[at], 8.0);
    }

    /// A thin dash-dotted line.
    pub(super) fn axis_line(&mut self, points: &[Point]) {
        self.scene.line(points, Stroke::new(AXIS, 1.0).dashed(DASH_DOT));
        self.obstacles.line(points, 1.0);
    }

    /// A line with an arrow head at its end.
    pub(super) fn arrow(&mut self, points: &[Point], color: Color, width: f64) {
        let [.., before, tip] = points else { return };
        let (along, _) = direction(*before, *tip);
        let (back, across) = (offset(*tip, -7.0, along), normal(along));
        self.scene.line(points, Stroke::new(color, width));
        let head = vec![offset(*tip, 1.0, along), offset(back, 2.8, across), offset(back, -2.8, across)];
        self.scene.draw(Outline::Polygon(head), Some(color), None);
        self.obstacles.line(points, 4.0);
    }

    /// The sense of a joint's axis: a curved arrow, as projected points.
    pub(super) fn sense(&mut self, points: &[Point]) {
        self.arrow(points, AXIS, 1.2);
    }

    pub(super) fn revolute(&mut self, at: Point) {
        let circle = |radius| Outline::Circle { center: at, radius };
        self.scene.draw(circle(JOINT), Some(PAPER), Some(Stroke::new(INK, 1.8)));
        self.scene.draw(circle(1.6), Some(INK), None);
        self.obstacles.frame(Frame::sized(at, [JOINT + 1.0; 2]));
    }

    pub(super) fn spherical(&mut self, at: Point) {
        let circle = |radius| Outline::Circle { center: at, radius };
        self.scene.draw(circle(JOINT), Some(PAPER), Some(Stroke::new(INK, 1.8)));
        self.scene.draw(circle(0.55 * JOINT), Some(INK), None);
        self.obstacles.frame(Frame::sized(at, [JOINT + 1.0; 2]));
    }

    /// An axis of the frame that points straight out of the paper (a dot) or into it (a cross).
    pub(super) fn end_on(&mut self, at: Point, out: bool) {
        self.scene.draw(Outline::Circle { center: at, radius: 4.5 }, Some(PAPER), Some(Stroke::new(INK, 1.2)));
        if out {
            self.scene.dot(at, 1.7, INK);
        } else {
            let tip = |x: f64, y: f64| [at[0] + 3.2 * x, at[1] + 3.2 * y];
            let cross = vec![vec![tip(-1.0, -1.0), tip(1.0, 1.0)], vec![tip(-1.0, 1.0), tip(1.0, -1.0)]];
            self.scene.lines(cross, Stroke::new(INK, 1.2).butt());
        }
    }

    /// A rectangle along the projected axis.
    pub(super) fn prismatic(&mut self, at: Point, along: Point) {
        let across = normal(along);
        let corner = |a: f64, b: f64| offset(offset(at, a, along), b, across);
        let sheath = vec![corner(-13.0, -7.0), corner(13.0, -7.0), corner(13.0, 7.0), corner(-13.0, 7.0)];
        self.scene.draw(Outline::Polygon(sheath), Some(PAPER), Some(Stroke::new(INK, 1.8)));
        self.scene.line(&[corner(-13.0, 0.0), corner(13.0, 0.0)], Stroke::new(INK, 1.0));
        self.obstacles.line(&[corner(-13.0, 0.0), corner(13.0, 0.0)], 16.0);
    }

    /// Two fingers that open away from the body.
    pub(super) fn gripper(&mut self, at: Point, along: Point) {
        let across = normal(along);
        let corner = |a: f64, b: f64| offset(offset(at, a, along), b, across);
        let jaw = [corner(13.0, 6.0), corner(6.0, 8.0), corner(0.0, 8.0), corner(0.0, -8.0), corner(6.0, -8.0)];
        let jaw = [jaw.as_slice(), &[corner(13.0, -6.0)]].concat();
        self.scene.line(&jaw, Stroke::new(PAPER, 5.5));
        self.scene.line(&jaw, Stroke::new(INK, 2.2));
        self.scene.draw(Outline::Circle { center: at, radius: 3.2 }, Some(PAPER), Some(Stroke::new(INK, 1.6)));
        self.obstacles.line(&[at, corner(13.0, 0.0)], 18.0);
    }

    /// The base: a plinth on hatched ground. `down` is 1, or −1 for a robot that hangs.
    pub(super) fn base(&mut self, at: Point, down: f64) {
        let corner = |x: f64, y: f64| [at[0] + x, at[1] + down * y];
        let plinth = vec![corner(-8.0, 0.0), corner(8.0, 0.0), corner(15.0, 17.0), corner(-15.0, 17.0)];
        self.scene.draw(Outline::Polygon(plinth), Some(PLINTH), Some(Stroke::new(INK, 1.2)));
        self.hatching(corner(0.0, 17.0), 34.0, down);
        self.obstacles.line(&[at, corner(0.0, 17.0)], 26.0);
    }

    /// A point fixed to the ground away from the base.
    pub(super) fn fixed(&mut self, at: Point, down: f64) {
        let corner = |x: f64, y: f64| [at[0] + x, at[1] + down * y];
        let triangle = vec![at, corner(-6.0, 10.0), corner(6.0, 10.0)];
        self.scene.draw(Outline::Polygon(triangle), Some(PLINTH), Some(Stroke::new(INK, 1.2)));
        self.hatching(corner(0.0, 10.0), 13.0, down);
        self.obstacles.line(&[at, corner(0.0, 10.0)], 12.0);
    }

    /// A ground line of half width `half` with strokes on its far side.
    fn hatching(&mut self, middle: Point, half: f64, down: f64) {
        let [x, y] = middle;
        let count = (half / 4.0).round() as i32;
        let strokes = (0..count).map(|i| {
            let at = x - half + 8.0 + 8.0 * f64::from(i);
            vec![[at, y], [at - 7.0, y + 7.0 * down]]
        });
        let strokes = strokes.filter(|stroke| stroke[0][0] <= x + half + 0.1).collect();
        self.scene.lines(strokes, Stroke::new(INK, 0.9));
        self.scene.line(&[[x - half, y], [x + half, y]], Stroke::new(INK, 1.6));
        self.obstacles.frame(Frame::sized([x, y + 3.5 * down], [half + 1.0, 5.0]));
    }
}
