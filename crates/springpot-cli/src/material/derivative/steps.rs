//! Times that are equal steps to the digits they are written with.

/// Most that a time may be off an equal step, in steps: coarser digits do not tell equal from unequal.
const LARGEST_ROUNDING: f64 = 1e-2;

/// Times from the first on; those that are equal steps to the digits they are written with are equal steps.
///
/// What is written with fewer digits than the rest, as `0` and `0.5` among `0.0009991`, has the resolution of the rest. All
/// depends on the numbers alone: `0.5`, `0.50` and `5e-1` are one.
pub(super) fn from_start(times: &[f64]) -> Vec<f64> {
    let (first, last) = (times[0], times[times.len() - 1]);
    let count = (times.len() - 1).max(1) as f64;
    let step = (last - first) / count;
    let resolution = Resolution::of(times);
    let [at_first, at_last] = [first, last].map(|t| resolution.at(t));
    let rounding = 4.0 * f64::EPSILON * first.abs().max(last.abs());
    let is_equal = times.iter().enumerate().all(|(k, t)| {
        // Rounding moves a time by half a unit, and the steps between both ends as they are moved; cut digits, by one.
        let share = k as f64 / count;
        let unit = resolution.at(*t).max((1.0 - share) * at_first + share * at_last);
        (t - first - k as f64 * step).abs() <= (unit + rounding).min(LARGEST_ROUNDING * step)
    });
    let times = times.iter().enumerate();
    times.map(|(k, t)| if is_equal { k as f64 * step } else { t - first }).collect()
}

/// The unit of the last digit by decade.
///
/// Fixed decimals have one unit throughout; a fixed number of digits has a coarser one in every decade. So a time is
/// written at least as finely as any of its own decade or above.
struct Resolution {
    /// Power of ten of the last digit from the decade `lowest` on.
    digits: Vec<i32>,
    lowest: i32,
}

impl Resolution {
    fn of(times: &[f64]) -> Self {
        let places: Vec<(i32, i32)> = times.iter().filter_map(|t| places(*t)).collect();
        let lowest = places.iter().map(|(decade, _)| *decade).min().unwrap_or(0);
        let highest = places.iter().map(|(decade, _)| *decade).max().unwrap_or(0);
        // Whole numbers are exact to 1, whatever zeros they end in.
        let mut digits = vec![0; (highest - lowest) as usize + 1];
        for (decade, digit) in places {
            let finest = &mut digits[(decade - lowest) as usize];
            *finest = digit.min(*finest);
        }
        for k in (1..digits.len()).rev() {
            digits[k - 1] = digits[k].min(digits[k - 1]);
        }
        Self { digits, lowest }
    }

    /// The unit of the last digit that `t` is written with.
    fn at(&self, t: f64) -> f64 {
        let decade = places(t).map_or(self.lowest, |(decade, _)| decade);
        10f64.powi(self.digits[(decade - self.lowest) as usize])
    }
}

/// Powers of ten of the first and the last digit in the shortest text of a number; none of 0.
fn places(t: f64) -> Option<(i32, i32)> {
    if t == 0.0 {
        return None;
    }
    let text = format!("{t:e}");
    let (digits, decade) = text.split_once('e')?;
    let decade = decade.parse::<i32>().ok()?;
    let decimals = digits.split_once('.').map_or(0, |(_, decimals)| decimals.len()) as i32;
    Some((decade, decade - decimals))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn are_equal(texts: impl Iterator<Item = String>) -> bool {
        let times: Vec<f64> = texts.map(|text| text.parse().unwrap()).collect();
        let found = from_start(&times);
        let step = (times[times.len() - 1] - times[0]) / (times.len() - 1) as f64;
        found.iter().enumerate().all(|(k, t)| *t == k as f64 * step)
    }

    /// `digits` significant ones, as %g of C writes them.
    fn significant(t: f64, digits: usize) -> String {
        format!("{t:.*e}", digits - 1).parse::<f64>().unwrap().to_string()
    }

    #[test]
    fn the_first_and_the_last_digit() {
        let cases =
            [(0.5, (-1, -1)), (100.0, (2, 2)), (0.000_999_1, (-4, -7)), (-12.25, (1, -2)), (0.1 + 0.2, (-1, -17))];
        assert!(cases.iter().all(|(t, expected)| places(*t) == Some(*expected)) && places(0.0).is_none());
    }

    #[test]
    fn rounded_equal_steps_are_equal() {
        let h = 1.0 / 300.0;
        for start in [0.0, -1.5, 7.0, 1_234.567_891_2] {
            let rows = |count: i32| (0..count).map(move |k| start + f64::from(k) * h);
            assert!(are_equal(rows(900).map(|t| format!("{t:.6}"))), "fixed, from {start}");
            assert!(are_equal(rows(900).map(|t| format!("{:.6}", t).parse::<f64>().unwrap().to_string())), "no zeros");
            assert!(are_equal(rows(900).map(|t| t.to_string())), "shortest, from {start}");
            assert!(are_equal(rows(900).map(|t| format!("{}", (t * 1e5).floor() / 1e5))), "cut, from {start}");
        }
        // Six digits: units of 1e-8 at first, of 1e-5 in the end.
        assert!(are_equal((0..2900).map(|k| significant(f64::from(k) * h, 6))));
        assert!(are_equal((0..4000).map(|k| format!("{:.8e}", f64::from(k) * h))));
        assert!(are_equal((0..500).map(|k| (17 * k).to_string())));
        assert!(are_equal((0..500).map(|k| ((333.33 * f64::from(k)).round() + 1e9).to_string())));
    }

    #[test]
    fn jitter_above_the_last_digit_is_not() {
        // ± 3 units of the last digit; every hundredth time is round.
        let jitter = |k: u32| if k.is_multiple_of(100) { 0.0 } else { f64::from(k * 7919 % 7) - 3.0 };
        for digits in [5, 6, 7, 9] {
            let unit = 10f64.powi(-digits);
            let times = |round: bool| {
                (0..1000).map(move |k| {
                    let t = f64::from(k) * 0.001 + jitter(k) * unit;
                    let text = format!("{t:.*}", digits as usize);
                    if round { text.parse::<f64>().unwrap().to_string() } else { text }
                })
            };
            assert!(!are_equal(times(true)) && !are_equal(times(false)), "{digits} decimals");
        }
        assert!(!are_equal(["0", "1", "2.5", "3"].iter().map(ToString::to_string)));
        assert!(!are_equal(["0", "1000", "2000", "3010"].iter().map(ToString::to_string)));
    }
}
