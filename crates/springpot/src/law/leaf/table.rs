//! The spring whose force is a table of its stroke.

use super::contract::Holds;
use super::elastic::Elastic;
use super::kind::{LeafBuild, LeafKind};
use crate::dual::Dual;
use crate::law::catalog::{Param, Range};
use std::sync::Arc;

/// F(x) through points: a monotone piecewise cubic (PCHIP), continued linearly beyond them. Stores ∫₀ˣ F dx exactly.
///
/// Slopes at the points are the weighted harmonic means of Fritsch & Butland (SIAM J. Sci. Stat. Comput. 5, 1984) inside, the
/// three-point formula at the ends that keeps the shape, as in SciPy's `PchipInterpolator`: where the points rise, so does F.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    x: Vec<f64>,
    force: Vec<f64>,
    slope: Vec<f64>,
    /// ∫ F from the first point to each.
    energy: Vec<f64>,
    /// ∫ F from the first point to x = 0.
    zero: f64,
}

/// Why points are no function.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum TableError {
    /// There are fewer than two.
    #[error("it has {rows} of the two rows or more that a curve needs")]
    TooFew {
        /// How many.
        rows: usize,
    },
    /// x does not increase.
    #[error("it is no function: x must increase, but in row {row} it is {x} after {before}")]
    NoFunction {
        /// Which row, counted from 1.
        row: usize,
        /// x there.
        x: f64,
        /// x in the row before.
        before: f64,
    },
    /// A number is infinite or none.
    #[error("row {row} has a number that is not finite")]
    NotFinite {
        /// Which row, counted from 1.
        row: usize,
    },
}

impl Table {
    /// Through (x, F), m and N.
    ///
    /// # Errors
    /// [`TableError`]: two points at least, x increases, all finite.
    pub fn new(points: impl IntoIterator<Item = (f64, f64)>) -> Result<Self, TableError> {
        let (x, force): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
        if x.len() < 2 {
            return Err(TableError::TooFew { rows: x.len() });
        }
        if let Some(k) = (0..x.len()).find(|&k| !(x[k].is_finite() && force[k].is_finite())) {
            return Err(TableError::NotFinite { row: k + 1 });
        }
        if let Some(k) = (1..x.len()).find(|&k| x[k] <= x[k - 1]) {
            return Err(TableError::NoFunction { row: k + 1, x: x[k], before: x[k - 1] });
        }
        let slope = slopes(&x, &force);
        let mut table = Self { x, force, slope, energy: vec![0.0], zero: 0.0 };
        for k in 0..table.x.len() - 1 {
            let whole = table.energy[k] + table.piece_energy(k, table.x[k + 1]);
            table.energy.push(whole);
        }
        table.zero = table.energy_from_first(0.0);
        Ok(table)
    }

    /// The piece that `x` lies in; beyond the ends `None`, and the point there.
    fn piece(&self, x: f64) -> Result<usize, usize> {
        let last = self.x.len() - 1;
        match self.x.partition_point(|point| *point <= x) {
            0 => Err(0),
            k if k > last => Err(last),
            k => Ok(k - 1),
        }
    }

    /// Coefficients of (x − x_k)^p of F in piece `k`.
    fn cubic(&self, k: usize) -> [f64; 4] {
        let width = self.x[k + 1] - self.x[k];
        let secant = (self.force[k + 1] - self.force[k]) / width;
        let [left, right] = [self.slope[k], self.slope[k + 1]];
        let bend = (3.0 * secant - 2.0 * left - right) / width;
        [self.force[k], left, bend, (left + right - 2.0 * secant) / (width * width)]
    }

    fn piece_energy(&self, k: usize, x: f64) -> f64 {
        let ([a, b, c, d], s) = (self.cubic(k), x - self.x[k]);
        s * (a + s * (b / 2.0 + s * (c / 3.0 + s * d / 4.0)))
    }

    fn energy_from_first(&self, x: f64) -> f64 {
        match self.piece(x) {
            Ok(k) => self.energy[k] + self.piece_energy(k, x),
            Err(k) => {
                let s = x - self.x[k];
                self.energy[k] + s * (self.force[k] + s * self.slope[k] / 2.0)
            }
        }
    }

    /// The smallest slope anywhere.
    fn least_slope(&self) -> f64 {
        let piece = |k: usize| {
            let ([_, b, c, d], width) = (self.cubic(k), self.x[k + 1] - self.x[k]);
            let lowest = if d > 0.0 { (-c / (3.0 * d)).clamp(0.0, width) } else { 0.0 };
            (b + lowest * (2.0 * c + lowest * 3.0 * d)).min(self.slope[k + 1]).min(b)
        };
        (0..self.x.len() - 1).map(piece).fold(f64::INFINITY, f64::min)
    }
}

/// Slopes at the points.
fn slopes(x: &[f64], force: &[f64]) -> Vec<f64> {
    let last = x.len() - 1;
    let width: Vec<f64> = x.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let secant: Vec<f64> = force.windows(2).zip(&width).map(|(pair, width)| (pair[1] - pair[0]) / width).collect();
    if last == 1 {
        return vec![secant[0]; 2];
    }
    let inner = |k: usize| {
        let [before, after] = [secant[k - 1], secant[k]];
        if before * after <= 0.0 {
            return 0.0;
        }
        let [w1, w2] = [2.0 * width[k] + width[k - 1], width[k] + 2.0 * width[k - 1]];
        (w1 + w2) / (w1 / before + w2 / after)
    };
    let end = |near: usize, next: usize| {
        let ([w, v], [s, r]) = ([width[near], width[next]], [secant[near], secant[next]]);
        let slope = ((2.0 * w + v) * s - w * r) / (w + v);
        let sign = |x: f64| if x == 0.0 { 0.0 } else { x.signum() };
        if sign(slope) != sign(s) {
            0.0
        } else if sign(s) != sign(r) && slope.abs() > 3.0 * s.abs() {
            3.0 * s
        } else {
            slope
        }
    };
    let mut slopes = vec![end(0, 1)];
    slopes.extend((1..last).map(inner));
    slopes.push(end(last - 1, last - 2));
    slopes
}

impl Elastic for Table {
    fn name(&self) -> &'static str {
        "table"
    }

    fn force(&self, x: f64) -> f64 {
        match self.piece(x) {
            Ok(k) => {
                let ([a, b, c, d], s) = (self.cubic(k), x - self.x[k]);
                a + s * (b + s * (c + s * d))
            }
            Err(k) => self.force[k] + (x - self.x[k]) * self.slope[k],
        }
    }

    fn slope(&self, x: f64) -> f64 {
        match self.piece(x) {
            Ok(k) => {
                let ([_, b, c, d], s) = (self.cubic(k), x - self.x[k]);
                b + s * (2.0 * c + s * 3.0 * d)
            }
            Err(k) => self.slope[k],
        }
    }

    fn energy(&self, x: f64) -> f64 {
        self.energy_from_first(x) - self.zero
    }

    /// Its points are no parameters.
    fn numbers(&self, _: &mut dyn FnMut(Dual)) -> bool {
        true
    }

    fn holds(&self) -> Holds {
        match self.least_slope() {
            _ if self.force.iter().all(|force| *force == 0.0) => Holds::Never,
            slope if slope > 0.0 => Holds::Always,
            _ => Holds::AtTimes,
        }
    }
}

/// What networks know of it.
pub(super) fn kind() -> LeafKind {
    LeafKind {
        name: "table",
        equation: "F = F(x) through the rows of a file",
        params: vec![Param::new("file", "", "CSV file with the columns x and F, m and N", Range::ANY)],
        build: LeafBuild::Table(|table: &Arc<Table>| table.clone()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// scipy.interpolate.PchipInterpolator (SciPy 1.17) of the same points.
    #[test]
    fn slopes_are_those_of_scipy() {
        let table = Table::new([(-1.0, -3.0), (0.0, 0.0), (0.5, 2.0), (2.0, 2.5), (3.0, 2.0)]).unwrap();
        let wanted = [7.0 / 3.0, 108.0 / 31.0, 48.0 / 67.0, 0.0, -5.0 / 6.0];
        assert!(table.slope.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-14), "{:?}", table.slope);
        let values = [
            (-0.75, -2.366_431_451_612_903),
            (-0.2, -0.683_268_817_204_300_9),
            (0.3, 1.411_643_716_899_374_3),
            (1.1, 2.330_746_268_656_716_4),
            (1.9, 2.498_087_341_072_416),
            (2.6, 2.296),
        ];
        for (x, force) in values {
            assert!((table.force(x) - force).abs() < 1e-13, "{x}: {}", table.force(x));
        }
        assert!((table.energy(2.6) - 5.524_383_630_235_917).abs() < 1e-13);
        assert_eq!(table.force(-2.0), -3.0 - table.slope[0]);
        let line = Table::new([(0.0, 1.0), (2.0, 5.0)]).unwrap();
        assert_eq!([line.force(-1.0), line.force(0.5), line.force(4.0)], [-1.0, 2.0, 9.0]);
        assert_eq!(line.energy(2.0), 6.0);
    }

    #[test]
    fn only_rising_tables_hold() {
        let holds = |points: &[(f64, f64)]| Elastic::holds(&Table::new(points.iter().copied()).unwrap());
        assert_eq!(holds(&[(0.0, 0.0), (1.0, 1.0), (2.0, 3.0)]), Holds::Always);
        assert_eq!(holds(&[(0.0, 0.0), (1.0, 1.0), (2.0, 1.0)]), Holds::AtTimes);
        assert_eq!(holds(&[(0.0, 0.0), (1.0, 0.0)]), Holds::Never);
        assert_eq!(Table::new([(0.0, 1.0)]), Err(TableError::TooFew { rows: 1 }));
        assert_eq!(Table::new([(0.0, 1.0), (0.0, 2.0)]), Err(TableError::NoFunction { row: 2, x: 0.0, before: 0.0 }));
        assert_eq!(Table::new([(0.0, f64::NAN), (1.0, 2.0)]), Err(TableError::NotFinite { row: 1 }));
    }
}
