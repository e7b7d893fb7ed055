//! Lines cut at the edges of a panel.

use crate::draw::Point;

/// The data area of a panel in pixels.
#[derive(Clone, Copy)]
pub(super) struct Area {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) width: f64,
    pub(super) height: f64,
}

/// The pieces of a line that lie inside.
pub(super) fn clip(points: &[Point], area: Area) -> Vec<Vec<Point>> {
    let mut pieces: Vec<Vec<Point>> = Vec::new();
    let mut open = false;
    for pair in points.windows(2) {
        let Some((from, to)) = inside(pair[0], pair[1], area) else {
            open = false;
            continue;
        };
        match pieces.last_mut() {
            Some(piece) if open => piece.push(to),
            _ => pieces.push(vec![from, to]),
        }
        open = to == pair[1];
    }
    pieces
}

/// The part of a straight line that lies inside (Liang and Barsky).
fn inside(from: Point, to: Point, area: Area) -> Option<(Point, Point)> {
    let (low, high) = ([area.left, area.top], [area.left + area.width, area.top + area.height]);
    let (mut enters, mut leaves) = (0.0f64, 1.0f64);
    for axis in 0..2 {
        let length = to[axis] - from[axis];
        if length == 0.0 {
            if from[axis] < low[axis] || from[axis] > high[axis] {
                return None;
            }
            continue;
        }
        let at = [low[axis], high[axis]].map(|edge| (edge - from[axis]) / length);
        enters = enters.max(at[0].min(at[1]));
        leaves = leaves.min(at[0].max(at[1]));
    }
    if enters > leaves {
        return None;
    }
    let at = |share: f64| [0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis]));
    // Ends that stay are not computed anew, so that pieces join.
    Some((if enters == 0.0 { from } else { at(enters) }, if leaves == 1.0 { to } else { at(leaves) }))
}

#[cfg(test)]
mod tests {
    use super::*;

    const AREA: Area = Area { left: 0.0, top: 0.0, width: 10.0, height: 10.0 };

    #[test]
    fn lines_end_at_the_edges() {
        assert_eq!(clip(&[[-5.0, 5.0], [5.0, 5.0], [15.0, 5.0]], AREA), [vec![[0.0, 5.0], [5.0, 5.0], [10.0, 5.0]]]);
        assert_eq!(clip(&[[1.0, 1.0], [2.0, 2.0]], AREA), [vec![[1.0, 1.0], [2.0, 2.0]]]);
        assert!(clip(&[[-5.0, 0.0], [0.0, 50.0]], AREA).is_empty());
        assert!(clip(&[[-5.0, -1.0], [50.0, -1.0]], AREA).is_empty());
        assert_eq!(clip(&[[-5.0, 5.0], [0.0, 5.0], [5.0, 5.0]], AREA), [vec![[0.0, 5.0], [0.0, 5.0], [5.0, 5.0]]]);
        let there_and_back = clip(&[[5.0, 5.0], [5.0, 15.0], [6.0, 15.0], [6.0, 5.0]], AREA);
        assert_eq!(there_and_back, [vec![[5.0, 5.0], [5.0, 10.0]], vec![[6.0, 10.0], [6.0, 5.0]]]);
    }
}
