//! The signs of elements: springs, dashpots, springpots, and what is made of them.

use super::ElementSign;
use super::plane::{normal, offset};
use crate::draw::Point;
use std::f64::consts::TAU;

/// Half height of a sign alone, and beside others.
const TALL: f64 = 6.5;
const LOW: f64 = 6.0;
/// Distance of signs that lie side by side.
const PITCH: f64 = 17.0;
/// Distance of a spring's teeth on the same side, and the most room for a spring.
const TOOTH: f64 = 10.0;
const LONGEST_COIL: f64 = 160.0;
/// Length of the other signs, and what they need at least.
const LENGTH: f64 = 54.0;
const LEAST: f64 = 20.0;
/// From the end of parts side by side to the parts.
const BAR: f64 = 4.0;

/// An element drawn between two points.
pub(super) struct Drawn {
    pub(super) lines: Vec<Vec<Point>>,
    /// What hides the lines behind it.
    pub(super) closed: Vec<Vec<Point>>,
    /// Half length and half height of the sign about the middle; nothing where there is no room for it.
    pub(super) half: Option<[f64; 2]>,
}

/// Coordinates along the element and across it.
struct Pen {
    origin: Point,
    along: Point,
    lines: Vec<Vec<Point>>,
    closed: Vec<Vec<Point>>,
    /// Half height of each sign.
    tall: f64,
}

/// Draws an element of this length from `from` on.
pub(super) fn draw(sign: &ElementSign, from: Point, along: Point, length: f64) -> Drawn {
    let rails = rails(sign);
    let wanted = match sign {
        ElementSign::Spring => (0.64 * length).min(LONGEST_COIL),
        _ => (parts(sign) as f64 * LENGTH + 2.0 * BAR).min(0.8 * length),
    };
    let body = wanted.min(length - 16.0);
    let tall = if rails > 1 { LOW } else { TALL };
    let mut pen = Pen { origin: from, along, lines: Vec::new(), closed: Vec::new(), tall };
    if body < parts(sign) as f64 * LEAST {
        pen.line(&[[0.0, 0.0], [length, 0.0]]);
        return Drawn { lines: pen.lines, closed: pen.closed, half: None };
    }
    let (start, end) = (0.5 * (length - body), 0.5 * (length + body));
    if sign == &ElementSign::Spring {
        // One line, so that its corners are round.
        let mut points = vec![[0.0, 0.0]];
        points.extend(coil(start, end, 0.0, tall));
        points.push([length, 0.0]);
        pen.line(&points);
    } else {
        pen.line(&[[0.0, 0.0], [start, 0.0]]);
        pen.line(&[[end, 0.0], [length, 0.0]]);
        pen.part(sign, start, end, 0.0);
    }
    let high = 0.5 * PITCH * (rails as f64 - 1.0) + tall;
    Drawn { lines: pen.lines, closed: pen.closed, half: Some([0.5 * body, high]) }
}

/// How many signs lie side by side.
fn rails(sign: &ElementSign) -> usize {
    match sign {
        ElementSign::Parallel(parts) => parts.iter().map(rails).sum::<usize>().max(1),
        ElementSign::Series(parts) => parts.iter().map(rails).max().unwrap_or(1),
        _ => 1,
    }
}

/// How many signs lie one behind the other.
fn parts(sign: &ElementSign) -> usize {
    match sign {
        ElementSign::Parallel(each) => each.iter().map(parts).max().unwrap_or(1),
        ElementSign::Series(each) => each.iter().map(parts).sum::<usize>().max(1),
        _ => 1,
    }
}

/// A zigzag.
fn coil(start: f64, end: f64, across: f64, tall: f64) -> Vec<Point> {
    let length = end - start;
    let teeth = 2 * (length / TOOTH).round().max(2.0) as usize;
    let tooth = |k: usize| {
        let side = if k.is_multiple_of(2) { tall } else { -tall };
        [start + length * (k as f64 + 0.5) / teeth as f64, across + side]
    };
    std::iter::once([start, across]).chain((0..teeth).map(tooth)).chain([[end, across]]).collect()
}

impl Pen {
    fn at(&self, [a, b]: Point) -> Point {
        offset(offset(self.origin, a, self.along), b, normal(self.along))
    }

    fn line(&mut self, points: &[Point]) {
        let points = points.iter().map(|point| self.at(*point)).collect();
        self.lines.push(points);
    }

    fn close(&mut self, points: &[Point]) {
        let points = points.iter().map(|point| self.at(*point)).collect();
        self.closed.push(points);
    }

    /// A sign from `start` to `end` along a line that is `across` beside the middle.
    fn part(&mut self, sign: &ElementSign, start: f64, end: f64, across: f64) {
        let (middle, tall) = (0.5 * (start + end), self.tall);
        let leads = |pen: &mut Self, half: f64| {
            pen.line(&[[start, across], [middle - half, across]]);
            pen.line(&[[middle + half, across], [end, across]]);
        };
        match sign {
            ElementSign::Spring => {
                let lead = 0.1 * (end - start);
                let mut points = vec![[start, across]];
                points.extend(coil(start + lead, end - lead, across, tall));
                points.push([end, across]);
                self.line(&points);
            }
            ElementSign::Dashpot => {
                let half = (0.3 * (end - start)).min(9.0);
                let (back, open) = (middle - half, middle + half);
                self.line(&[[start, across], [back, across]]);
                self.line(&[
                    [open, across - tall],
                    [back, across - tall],
                    [back, across + tall],
                    [open, across + tall],
                ]);
                let plate = middle + 0.2 * half;
                self.line(&[[plate, across - 0.65 * tall], [plate, across + 0.65 * tall]]);
                self.line(&[[plate, across], [end, across]]);
            }
            ElementSign::Springpot => {
                let half = (0.4 * (end - start)).min(1.6 * tall);
                leads(self, half);
                let corners = [
                    [middle - half, across],
                    [middle, across + tall],
                    [middle + half, across],
                    [middle, across - tall],
                ];
                self.close(&corners);
            }
            ElementSign::Source => {
                leads(self, tall);
                let point = |k: u32| {
                    let (sin, cos) = (TAU * f64::from(k) / 24.0).sin_cos();
                    [middle + tall * cos, across + tall * sin]
                };
                self.close(&(0..24).map(point).collect::<Vec<_>>());
                self.line(&[[middle - 0.55 * tall, across], [middle + 0.55 * tall, across]]);
                let head = |side: f64| [middle + 0.1 * tall, across + side * 0.4 * tall];
                self.line(&[head(1.0), [middle + 0.55 * tall, across], head(-1.0)]);
            }
            ElementSign::Parallel(parts) => {
                let all = rails(sign) as f64;
                let bars = (start + BAR, end - BAR);
                self.line(&[[start, across], [bars.0, across]]);
                self.line(&[[bars.1, across], [end, across]]);
                let mut top = across - 0.5 * PITCH * all;
                let mut places = Vec::new();
                for part in parts {
                    let own = PITCH * rails(part) as f64;
                    places.push(top + 0.5 * own);
                    self.part(part, bars.0, bars.1, top + 0.5 * own);
                    top += own;
                }
                if let (Some(first), Some(last)) = (places.first(), places.last()) {
                    for bar in [bars.0, bars.1] {
                        self.line(&[[bar, *first], [bar, *last]]);
                    }
                }
            }
            ElementSign::Series(each) => {
                let share = (end - start) / parts(sign) as f64;
                let mut at = start;
                for part in each {
                    let next = at + share * parts(part) as f64;
                    self.part(part, at, next, across);
                    at = next;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(sign: &ElementSign, length: f64) -> Drawn {
        draw(sign, [10.0, 20.0], [1.0, 0.0], length)
    }

    #[test]
    fn signs_reach_from_end_to_end() {
        use ElementSign::{Dashpot, Parallel, Series, Source, Spring, Springpot};
        let maxwell = Series(vec![Spring, Springpot]);
        let signs =
            [Spring, Dashpot, Springpot, Source, maxwell.clone(), Parallel(vec![Spring, Springpot, maxwell, Dashpot])];
        for sign in &signs {
            for length in [5.0, 40.0, 90.0, 400.0] {
                let Drawn { lines, closed, half } = drawn(sign, length);
                let points = || lines.iter().chain(&closed).flatten();
                let extent = points().fold((f64::MAX, f64::MIN), |(lo, hi), p| (lo.min(p[0]), hi.max(p[0])));
                assert!((extent.0 - 10.0).abs() < 1e-9 && (extent.1 - 10.0 - length).abs() < 1e-9, "{sign:?} {length}");
                let high = half.map_or(0.0, |half| half[1]);
                assert!(points().all(|p| (p[1] - 20.0).abs() <= high + 1e-9), "{sign:?} {length}");
                assert_eq!(half.is_some(), length > 85.0 || (length > 36.0 && parts(sign) == 1), "{sign:?} {length}");
            }
        }
        assert_eq!((rails(&signs[5]), parts(&signs[5])), (4, 2));
    }
}
