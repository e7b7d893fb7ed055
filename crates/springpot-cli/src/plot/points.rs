//! The points of a curve, of which a long one keeps those that can be seen.

/// Points beyond which a curve is thinned.
const MOST: usize = 1 << 18;
/// Neighbours of which the extreme ones are kept.
const GROUP: usize = 16;

/// A curve that grows point by point.
#[derive(Debug, Default, Clone)]
pub(super) struct Points {
    pub(super) x: Vec<f64>,
    pub(super) y: Vec<f64>,
}

impl Points {
    pub(super) fn push(&mut self, x: f64, y: f64) {
        self.x.push(x);
        self.y.push(y);
        if self.x.len() >= MOST {
            self.thin();
        }
    }

    /// Keeps of every group of neighbours the first, the last, the extremes of both coordinates, and a gap.
    fn thin(&mut self) {
        let (x, y) = (std::mem::take(&mut self.x), std::mem::take(&mut self.y));
        for start in (0..x.len()).step_by(GROUP) {
            let all = start..(start + GROUP).min(x.len());
            let mut kept = vec![all.start, all.end - 1];
            for values in [&x, &y] {
                let finite = || all.clone().filter(|&k| values[k].is_finite());
                kept.extend(finite().min_by(|&a, &b| values[a].total_cmp(&values[b])));
                kept.extend(finite().max_by(|&a, &b| values[a].total_cmp(&values[b])));
                kept.extend(all.clone().find(|&k| !values[k].is_finite()));
            }
            kept.sort_unstable();
            kept.dedup();
            self.x.extend(kept.iter().map(|&k| x[k]));
            self.y.extend(kept.iter().map(|&k| y[k]));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_curves_keep_extremes_ends_and_gaps() {
        let mut points = Points::default();
        let count = 5 * MOST;
        for k in 0..count {
            let y = match k {
                777_777 => 5.0,
                1_000_000 => -7.0,
                500_000 => f64::NAN,
                k => (k as f64 * 1e-3).sin(),
            };
            points.push(k as f64, y);
        }
        assert!(points.x.len() < MOST && points.x.len() == points.y.len(), "{}", points.x.len());
        assert_eq!((points.x[0], points.x[points.x.len() - 1]), (0.0, (count - 1) as f64));
        assert!(points.x.windows(2).all(|pair| pair[0] < pair[1]));
        let at = |x: f64| points.y[points.x.iter().position(|other| *other == x).unwrap()];
        assert_eq!((at(777_777.0), at(1_000_000.0)), (5.0, -7.0));
        assert_eq!(points.y.iter().filter(|y| y.is_nan()).count(), 1);
    }
}
