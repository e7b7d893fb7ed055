//! What a curve spans.

pub(super) type Point = [f64; 2];

/// Coordinates beyond this are gaps, as they are in figures.
const LARGEST: f64 = 1e300;

/// Steps below this part of a coordinate cannot be told apart.
const FINEST: f64 = 1.0 / (1u64 << 56) as f64;

/// Whether a point has a coordinate that cannot be drawn.
pub(super) fn is_gap(point: &Point) -> bool {
    !point.iter().all(|v| v.abs() <= LARGEST)
}

/// Lowest and highest coordinates of a curve, and the points that have them.
pub(super) struct Extent {
    pub(super) low: Point,
    high: Point,
    /// Indices of the points with the lowest x and y, then of those with the highest.
    pub(super) extremes: [usize; 4],
    /// Whether x never decreases.
    pub(super) runs_on: bool,
}

impl Extent {
    /// The extent of a curve; `None` where it has no point but gaps.
    pub(super) fn of(points: &[Point]) -> Option<Self> {
        let first = points.iter().position(|point| !is_gap(point))?;
        let mut extent = Self { low: points[first], high: points[first], extremes: [first; 4], runs_on: true };
        let mut before = f64::NEG_INFINITY;
        for (k, point) in points.iter().enumerate().skip(first).filter(|(_, point)| !is_gap(point)) {
            extent.runs_on &= point[0] >= before;
            before = point[0];
            for axis in 0..2 {
                if point[axis] < extent.low[axis] {
                    extent.low[axis] = point[axis];
                    extent.extremes[axis] = k;
                }
                if point[axis] > extent.high[axis] {
                    extent.high[axis] = point[axis];
                    extent.extremes[2 + axis] = k;
                }
            }
        }
        Some(extent)
    }

    /// The largest power of two that parts the extent along an axis into no fewer than `parts`; powers of two nest.
    pub(super) fn step(&self, axis: usize, parts: usize) -> f64 {
        let (low, high) = (self.low[axis], self.high[axis]);
        let finest = FINEST * low.abs().max(high.abs());
        let step = ((high - low) / parts as f64).max(finest).max(f64::MIN_POSITIVE);
        // Without the mantissa; `log2` differs between systems.
        f64::from_bits(step.to_bits() & f64::INFINITY.to_bits())
    }

    /// Number of steps of this size that the extent touches along an axis.
    pub(super) fn count(&self, axis: usize, step: f64) -> usize {
        ((self.high[axis] / step).floor() - (self.low[axis] / step).floor()) as usize + 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_powers_of_two() {
        let of = |low: f64, high: f64| Extent::of(&[[low, 0.0], [f64::NAN, 9.0], [high, 0.0]]).unwrap();
        assert_eq!(of(0.0, 10.0).step(0, 10), 1.0);
        assert_eq!(of(0.0, 15.9).step(0, 10), 1.0);
        assert_eq!(of(-3.0, 0.0).step(0, 24), 0.125);
        assert_eq!(of(-3.0, 0.0).count(0, 0.125), 25);
        assert_eq!(of(-1e300, 1e300).count(0, of(-1e300, 1e300).step(0, 100)) / 100, 1);
        for constant in [0.0, 5e-324, 1.0, -1e300] {
            let extent = of(constant, constant);
            assert_eq!(extent.count(0, extent.step(0, 1000)), 1, "{constant}");
        }
        assert!(Extent::of(&[[1e301, 0.0], [0.0, f64::INFINITY]]).is_none());
        assert_eq!(Extent::of(&[[2.0, 1.0], [1.0, 3.0], [3.0, 0.0]]).unwrap().extremes, [1, 2, 2, 1]);
        assert!(of(1.0, 1.0).runs_on && !of(1.0, 0.0).runs_on);
    }
}
