//! From where the robot is seen.

use super::{RobotDrawing, WORLD};
use crate::vector::{Vector, along, difference, distance, dot};

/// An orthographic view: unit vectors to the right and upwards on the paper, and into it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct View {
    pub(super) right: Vector,
    pub(super) up: Vector,
    pub(super) into: Vector,
}

/// Turns about z to choose from, degrees: at 0 x points to the right and y into the paper.
const TURNS: [f64; 12] = [25.0, 30.0, 35.0, 40.0, 20.0, 50.0, 60.0, -25.0, -35.0, -50.0, 120.0, 145.0];
/// Heights of the eye to choose from, degrees above the horizon.
const HEIGHTS: [f64; 3] = [18.0, 24.0, 30.0];
/// Points looked at when comparing views; more cost time and change nothing.
const MOST_POINTS: usize = 80;

impl View {
    /// Turned by `turn` about z and seen from `height` above the horizon, degrees.
    fn turned(turn: f64, height: f64) -> Self {
        let ((s, c), (sh, ch)) = (turn.to_radians().sin_cos(), height.to_radians().sin_cos());
        Self { right: [c, s, 0.0], up: [-s * sh, c * sh, ch], into: [-s * ch, c * ch, -sh] }
    }

    /// Position on the paper, up positive.
    pub(super) fn project(&self, point: Vector) -> [f64; 2] {
        [dot(point, self.right), dot(point, self.up)]
    }

    /// The view that is asked for, or the best one of a robot.
    pub(super) fn of(robot: &RobotDrawing) -> Self {
        if let Some([azimuth, elevation]) = robot.view {
            return Self::turned(azimuth, elevation);
        }
        let lines = lines(robot);
        let points = samples(robot, &lines);
        let span = |axis: usize| {
            let values = points.iter().map(|p| p[axis]);
            values.clone().fold(f64::MIN, f64::max) - values.fold(f64::MAX, f64::min)
        };
        let size = (0..3).map(span).fold(0.0, f64::max);
        let flat = |axis: usize| span(axis) <= 1e-6 * size;
        if flat(1) {
            return Self { right: [1.0, 0.0, 0.0], up: [0.0, 0.0, 1.0], into: [0.0, 1.0, 0.0] };
        }
        if flat(0) {
            return Self { right: [0.0, 1.0, 0.0], up: [0.0, 0.0, 1.0], into: [-1.0, 0.0, 0.0] };
        }
        if flat(2) {
            return Self { right: [1.0, 0.0, 0.0], up: [0.0, 1.0, 0.0], into: [0.0, 0.0, -1.0] };
        }
        let views = TURNS.iter().flat_map(|turn| HEIGHTS.map(|height| Self::turned(*turn, height)));
        let scored = views.map(|view| (view.clarity(&lines, &points, size), view));
        let (_, best) = scored.fold((f64::MIN, Self::turned(TURNS[0], HEIGHTS[0])), |best, next| {
            if next.0 > best.0 + 1e-9 { next } else { best }
        });
        best
    }

    /// How well points stay apart on the paper, less for every pair of lines that cross.
    fn clarity(&self, lines: &[[Vector; 2]], points: &[Vector], size: f64) -> f64 {
        let (mut sum, mut count, mut closest) = (0.0, 0.0, 1.0f64);
        for (i, a) in points.iter().enumerate() {
            for b in &points[..i] {
                let far = distance(*a, *b);
                if far > 0.08 * size {
                    let [x, y] = self.project(difference(*a, *b));
                    let seen = x.hypot(y);
                    sum += seen / far;
                    count += 1.0;
                    closest = closest.min(seen / size);
                }
            }
        }
        let pairs = lines.iter().enumerate().flat_map(|(i, a)| lines[..i].iter().map(move |b| (a, b)));
        let crossings = pairs.filter(|(a, b)| self.cross(a, b, size)).count();
        if count == 0.0 { 0.0 } else { sum / count + 2.0 * closest.min(0.08) - 0.06 * crossings as f64 }
    }

    /// Two lines without a common end cross on the paper.
    fn cross(&self, a: &[Vector; 2], b: &[Vector; 2], size: f64) -> bool {
        let touch = a.iter().any(|p| b.iter().any(|q| distance(*p, *q) < 0.02 * size));
        let [p, q, r, s] = [a[0], a[1], b[0], b[1]].map(|point| self.project(point));
        let side =
            |p: [f64; 2], q: [f64; 2], r: [f64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
        !touch && side(p, q, r) * side(p, q, s) < 0.0 && side(r, s, p) * side(r, s, q) < 0.0
    }
}

/// Straight pieces of links and elements.
fn lines(robot: &RobotDrawing) -> Vec<[Vector; 2]> {
    let links = robot.links.iter().filter(|link| link.name != WORLD);
    let links = links.flat_map(|link| link.points.windows(2).map(|pair| [pair[0], pair[1]]));
    let elements = robot.elements.iter().map(super::ElementMark::points);
    let elements = elements.flat_map(|points| points.windows(2).map(|two| [two[0], two[1]]).collect::<Vec<_>>());
    links.chain(elements).collect()
}

/// Points on all lines and marks, evenly thinned.
fn samples(robot: &RobotDrawing, lines: &[[Vector; 2]]) -> Vec<Vector> {
    let on_lines = lines.iter().flat_map(|[a, b]| [0.0, 0.5, 1.0].map(|t| along(*a, t, difference(*b, *a))));
    let joints = robot.joints.iter().map(|joint| joint.position);
    let fixed = robot.links.iter().filter(|link| link.name == WORLD).flat_map(|link| link.points.iter().copied());
    let all: Vec<Vector> = on_lines.chain(joints).chain(fixed).chain(robot.gripper).chain(robot.ground).collect();
    let step = all.len().div_ceil(MOST_POINTS).max(1);
    all.into_iter().step_by(step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector::cross;

    #[test]
    fn views_are_right_handed_and_orthonormal() {
        for turn in TURNS {
            let view = View::turned(turn, 24.0);
            for (a, b, c) in [(view.right, view.up, view.into), (view.up, view.into, view.right)] {
                assert!((dot(a, a) - 1.0).abs() < 1e-12 && dot(a, b).abs() < 1e-12);
                // Right × up points out of the paper.
                assert!((dot(cross(a, b), c) + 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn flat_robots_are_seen_straight_on() {
        let link = |points: &[Vector]| super::super::Link { name: "a".into(), points: points.to_vec() };
        let mut robot =
            RobotDrawing { links: vec![link(&[[0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0]])], ..Default::default() };
        assert_eq!(View::of(&robot).into, [0.0, 1.0, 0.0]);
        robot.links[0].points[2] = [1.0, 1.0, 1.0];
        assert!(View::of(&robot).into[2] < 0.0);
    }
}
