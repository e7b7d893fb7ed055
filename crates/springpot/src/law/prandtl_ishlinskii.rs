//! Hysteresis after Prandtl and Ishlinskii, and its exact inverse.

use super::rule::RuleError;
use crate::dual::{Dual, Real};

/// y = (1 − Σ a_i)·x + Σ a_i·p_i, p_i the play of the half width r_i: max(x − r_i, min(x + r_i, p_i)), all 0 at first.
///
/// Its first curve bends at r_i, from the slope 1 − Σ a_i to 1, and its branches are that curve twice as large. The inverse is of the same kind: x = y + Σ b_i·s_i, s_i the stop of
/// y at ±ρ_i, where ρ_i is y on the first curve at r_i and 1 + Σ_{j>i} b_j one over its slope behind it (Kuhnen 2003).
///
/// ```
/// use springpot::law::PrandtlIshlinskii;
///
/// let hysteresis = PrandtlIshlinskii::new(&[0.08, 0.05], &[10.0, 40.0])?;
/// let wanted = [0.0, 60.0, 25.0, 90.0, 0.0];
/// let driven = hysteresis.inverse(&wanted);
/// let reached = hysteresis.outputs(&driven);
/// assert!(wanted.iter().zip(&reached).all(|(wanted, reached)| (wanted - reached).abs() < 1e-12));
/// # Ok::<(), springpot::law::RuleError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct PrandtlIshlinskii {
    /// a_i and r_i.
    plays: Vec<[f64; 2]>,
    /// b_i and ρ_i.
    stops: Vec<Stop>,
}

/// An elastic part that slips: s follows its stroke between ±`limit`, and counts `weight` times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    /// b ≥ 0.
    pub weight: Dual,
    /// ρ > 0.
    pub limit: Dual,
}

impl PrandtlIshlinskii {
    /// From the weights a_i, without unit, and the half widths r_i in the unit of x.
    ///
    /// # Errors
    /// [`RuleError`]: a_i ≥ 0, Σ a_i < 1, 0 < r_1 < r_2 < …
    ///
    /// # Panics
    /// Where there are not as many weights as half widths.
    pub fn new<T: Copy + Into<Dual>>(weights: &[T], widths: &[T]) -> Result<Self, RuleError> {
        assert_eq!(weights.len(), widths.len(), "a weight for each half width");
        let [a, r] = [weights, widths].map(|numbers| numbers.iter().map(|x| (*x).into()).collect::<Vec<Dual>>());
        let [weights, widths] = [&a, &r].map(|numbers| Dual::values(numbers));
        RuleError::unless(weights.iter().all(|a| *a >= 0.0), "a_i ≥ 0", "a")?;
        let loss: f64 = weights.iter().sum();
        RuleError::unless(loss < 1.0, "Σ a_i < 1", "a")?;
        RuleError::unless(
            widths.iter().all(|r| *r > 0.0) && widths.is_sorted_by(|a, b| a < b),
            "0 < r_1 < r_2 < …",
            "r",
        )?;
        let one = Dual::from(1.0);
        let (mut slope, mut at, mut value) = (one - a.iter().copied().sum(), Dual::default(), Dual::default());
        let stops = a.iter().zip(&r).map(|(a, r)| {
            value += slope * (*r - at);
            let before = slope;
            (at, slope) = (*r, slope + *a);
            Stop { weight: one / before - one / slope, limit: value }
        });
        let stops = stops.collect();
        Ok(Self { plays: weights.into_iter().zip(widths).map(|(a, r)| [a, r]).collect(), stops })
    }

    /// The stops of the inverse.
    pub fn stops(&self) -> &[Stop] {
        &self.stops
    }

    /// y along `inputs`, between which x runs one way, from rest.
    pub fn outputs(&self, inputs: &[f64]) -> Vec<f64> {
        let mut plays = vec![0.0f64; self.plays.len()];
        let value = |x: &f64| {
            let lost = plays.iter_mut().zip(&self.plays).map(|(p, [a, r])| {
                *p = p.clamp(x - r, x + r);
                a * (x - *p)
            });
            x - lost.sum::<f64>()
        };
        inputs.iter().map(value).collect()
    }

    /// x along `outputs`, between which y runs one way, from rest: what to drive with so that these come out.
    pub fn inverse(&self, outputs: &[f64]) -> Vec<f64> {
        let (mut held, mut before) = (vec![0.0; self.stops.len()], 0.0);
        let value = |y: &f64| {
            let moved = y - std::mem::replace(&mut before, *y);
            let of_stops = held.iter_mut().zip(&self.stops).map(|(held, stop)| {
                *held = stop.after(*held, moved);
                stop.weight.value * *held
            });
            y + of_stops.sum::<f64>()
        };
        outputs.iter().map(value).collect()
    }
}

impl Stop {
    /// s after its stroke has moved one way.
    pub fn after<T: Real>(&self, held: T, moved: T) -> T {
        let (s, limit) = (held + moved, T::of(self.limit));
        if s.value() > limit.value() {
            limit
        } else if s.value() < -limit.value() {
            -limit
        } else {
            s
        }
    }

    /// Whether it slips there.
    pub(super) fn slips<T: Real>(&self, held: T, moved: T) -> bool {
        (held + moved).value().abs() >= self.limit.value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_undoes_it_whatever_the_path() {
        let hysteresis = PrandtlIshlinskii::new(&[0.1, 0.0, 0.06, 0.2], &[2.0, 5.0, 11.0, 30.0]).unwrap();
        // A path of many turns, large and small.
        let path: Vec<f64> =
            (0..400).map(|k| f64::from(k) * 0.37).map(|t| 60.0 * t.sin() + 25.0 * (7.3 * t).cos()).collect();
        for (there, back) in [
            (hysteresis.outputs(&path), PrandtlIshlinskii::inverse as fn(&PrandtlIshlinskii, &[f64]) -> Vec<f64>),
            (hysteresis.inverse(&path), PrandtlIshlinskii::outputs),
        ] {
            let off = path.iter().zip(back(&hysteresis, &there)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-12, "{off:e}");
            assert!(path.iter().zip(&there).any(|(a, b)| (a - b).abs() > 1.0));
        }
    }

    #[test]
    fn its_first_curve_and_its_rules() {
        let hysteresis = PrandtlIshlinskii::new(&[0.25, 0.25], &[10.0, 30.0]).unwrap();
        // Slopes ½, ¾ and 1; back from 40 twice as long.
        assert_eq!(hysteresis.outputs(&[10.0, 30.0, 40.0, 20.0, -20.0]), [5.0, 20.0, 30.0, 20.0, -10.0]);
        for (weights, widths, rule) in [
            ([-0.1, 0.2], [1.0, 2.0], "a_i ≥ 0"),
            ([0.5, 0.5], [1.0, 2.0], "Σ a_i < 1"),
            ([0.1, 0.2], [2.0, 1.0], "0 < r_1 < r_2 < …"),
            ([0.1, 0.2], [0.0, 1.0], "0 < r_1 < r_2 < …"),
            ([0.1, f64::NAN], [0.5, 1.0], "a_i ≥ 0"),
        ] {
            assert_eq!(PrandtlIshlinskii::new(&weights, &widths).unwrap_err().rule, rule);
        }
    }
}
