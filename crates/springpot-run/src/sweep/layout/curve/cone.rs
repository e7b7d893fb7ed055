//! Straight lines that pass many points.

/// Farthest that a point is from the line that passes it.
pub(super) const TOLERANCE: f64 = 0.5;

/// The directions from an anchor of straight lines that pass all points so far within [`TOLERANCE`].
pub(super) struct Cone {
    anchor: [f64; 2],
    /// The rightmost and leftmost direction; `None` where all are open.
    bounds: Option<[[f64; 2]; 2]>,
    /// Largest distance of a point.
    reached: f64,
}

impl Cone {
    /// All directions from `anchor`.
    pub(super) fn new(anchor: [f64; 2]) -> Self {
        Self { anchor, bounds: None, reached: 0.0 }
    }

    /// Narrows the cone so that its lines pass `point` too; `false`, and nothing changes, where the line to `point` does not pass
    /// all points before it, or where the curve turns back.
    pub(super) fn take(&mut self, point: [f64; 2]) -> bool {
        let to = [point[0] - self.anchor[0], point[1] - self.anchor[1]];
        let distance = (to[0] * to[0] + to[1] * to[1]).sqrt();
        if distance < self.reached - TOLERANCE {
            return false;
        }
        if let Some([right, left]) = self.bounds
            && (cross(right, to) < 0.0 || cross(to, left) < 0.0)
        {
            return false;
        }
        if distance > TOLERANCE {
            // The tangents from the anchor to a circle around the point.
            let sine = TOLERANCE / distance;
            let cosine = (1.0 - sine * sine).sqrt();
            let turned = |sine: f64| [cosine * to[0] - sine * to[1], cosine * to[1] + sine * to[0]];
            let (own_right, own_left) = (turned(-sine), turned(sine));
            let [right, left] = self.bounds.unwrap_or([own_right, own_left]);
            let right = if cross(right, own_right) > 0.0 { own_right } else { right };
            let left = if cross(own_left, left) > 0.0 { own_left } else { left };
            self.bounds = Some([right, left]);
        }
        self.reached = self.reached.max(distance);
        true
    }
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points that lines from the first one pass, until one does not.
    fn taken(points: &[[f64; 2]]) -> usize {
        let mut cone = Cone::new(points[0]);
        points[1..].iter().take_while(|point| cone.take(**point)).count()
    }

    #[test]
    fn lines_pass_all_points_that_are_taken() {
        let straight: Vec<[f64; 2]> = (0..100).map(|k| [3.0 - f64::from(k), 0.7 * f64::from(k)]).collect();
        assert_eq!(taken(&straight), 99);
        assert_eq!(taken(&[[0.0, 0.0], [5.0, 0.0], [10.0, 0.9], [15.0, 0.9]]), 3);
        assert_eq!(taken(&[[0.0, 0.0], [5.0, 0.0], [10.0, 1.1]]), 1);
        assert_eq!(taken(&[[0.0, 0.0], [5.0, 0.0], [4.6, 0.0], [4.4, 0.0]]), 2);
        // A circle: every chord that is taken has an arrow within the tolerance.
        let circle: Vec<[f64; 2]> =
            (0..2000).map(|k| f64::from(k) * 1e-3).map(|a| [400.0 * a.cos(), 400.0 * a.sin()]).collect();
        let last = taken(&circle);
        let chord = (circle[last][0] - circle[0][0]).hypot(circle[last][1] - circle[0][1]);
        let longest = (8.0 * 400.0 * TOLERANCE).sqrt();
        assert!(chord <= longest && chord > 0.7 * longest, "{chord} {longest}");
    }
}
