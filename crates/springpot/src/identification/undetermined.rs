//! Combinations of parameters that the rows do not tell apart.

use super::estimate::scaled;
use crate::linalg::{Triangle, column_singular_values};

/// Singular values of the column-scaled J below this share of the largest tell of what is not determined.
pub(super) const OPEN: f64 = 1e-3;
/// Parts of a direction below this share of its largest are none of it.
const PART: f64 = 1e-2;

/// A direction in which parameters may move together, and hardly any residual changes.
#[derive(Debug, Clone, PartialEq)]
pub struct Undetermined {
    /// Parameters and their parts: the singular vector of J with columns of norm 1, its largest part 1.
    pub combination: Vec<(usize, f64)>,
    /// Its singular value over the largest.
    pub ratio: f64,
    /// Of two parameters what is determined instead.
    pub determined: Option<Determined>,
}

/// A sum of two parameters that is determined where neither of them is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Determined {
    /// Parameters and their factors, the first 1.
    pub sum: [(usize, f64); 2],
    /// Its value.
    pub value: f64,
    /// Its standard deviation.
    pub sd: f64,
}

/// The directions at a minimum; `noise` is the variance of residuals.
pub(super) fn undetermined(triangle: &Triangle, columns: &[usize], values: &[f64], noise: f64) -> Vec<Undetermined> {
    let (scaled, norms) = scaled(triangle, columns);
    let all = column_singular_values(&scaled, columns.len());
    let largest = all.iter().map(|(sigma, _)| *sigma).fold(0.0, f64::max);
    let is_open = |sigma: f64| sigma < OPEN * largest;
    let open = all.iter().filter(|(sigma, _)| is_open(*sigma));
    let mut found: Vec<Undetermined> = open
        .map(|(sigma, direction)| {
            let most = direction.iter().fold(0.0_f64, |most, part| if part.abs() > most.abs() { *part } else { most });
            let parts = direction.iter().enumerate().map(|(k, part)| (k, part / most));
            let parts: Vec<(usize, f64)> = parts.filter(|(_, part)| part.abs() >= PART).collect();
            let determined = match parts[..] {
                // Across the direction, in the scaled columns, lies what they tell.
                [(first, a), (second, b)] => {
                    let factor = -a * norms[second] / (b * norms[first]);
                    let sum = [(columns[first], 1.0), (columns[second], factor)];
                    let value = sum.iter().map(|(j, factor)| factor * values[*j]).sum();
                    let along = |direction: &[f64]| {
                        direction[first] / norms[first] + factor * direction[second] / norms[second]
                    };
                    let closed = all.iter().filter(|(sigma, _)| !is_open(*sigma));
                    let variance: f64 = closed.map(|(sigma, direction)| (along(direction) / sigma).powi(2)).sum();
                    Some(Determined { sum, value, sd: (noise * variance).sqrt() })
                }
                _ => None,
            };
            let combination = parts.into_iter().map(|(k, part)| (columns[k], part)).collect();
            Undetermined { combination, ratio: sigma / largest, determined }
        })
        .collect();
    found.sort_by(|a, b| a.ratio.total_cmp(&b.ratio));
    found
}

impl Undetermined {
    /// It in words: `only E_c + E_kv = 50.0 ± 0.1 is determined`.
    pub fn text(&self, name: impl Fn(usize) -> String) -> String {
        match &self.determined {
            Some(Determined { sum: [(first, _), (second, factor)], value, sd }) => {
                let size = factor.abs();
                let written = if (size - 1.0).abs() < 1e-3 { String::new() } else { format!("{}·", digits(size, 4)) };
                let sign = if *factor < 0.0 { "−" } else { "+" };
                // One digit of the spread more than the first says how many of the value count.
                let places = if *sd > 0.0 && sd.is_finite() && *value != 0.0 {
                    (value.abs().log10().floor() - sd.log10().floor()).clamp(0.0, 12.0) as usize + 2
                } else {
                    6
                };
                let (first, second) = (name(*first), name(*second));
                format!(
                    "only {first} {sign} {written}{second} = {} ± {} is determined",
                    digits(*value, places),
                    digits(*sd, 2)
                )
            }
            None => {
                let parts: Vec<String> =
                    self.combination.iter().map(|(j, part)| format!("{} ({part:+.2})", name(*j))).collect();
                match &parts[..] {
                    [one] => format!("{} is not determined", one.split(' ').next().unwrap_or(one)),
                    _ => format!("{} moved together change nothing", parts.join(", ")),
                }
            }
        }
    }
}

impl Undetermined {
    /// What moves together, in words without values: `E_c and E_kv only by E_c + E_kv`.
    pub fn direction(&self, name: impl Fn(usize) -> String) -> String {
        match &self.determined {
            Some(Determined { sum: [(first, _), (second, factor)], .. }) => {
                let (first, second, size) = (name(*first), name(*second), factor.abs());
                let written = if (size - 1.0).abs() < 1e-3 { String::new() } else { format!("{}·", digits(size, 4)) };
                let sign = if *factor < 0.0 { "−" } else { "+" };
                format!("{first} and {second} only by {first} {sign} {written}{second}")
            }
            None => self.text(name),
        }
    }
}

/// A number of so many significant digits.
fn digits(value: f64, count: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let exponent = value.abs().log10().floor() as i32;
    if (-4..15).contains(&exponent) {
        let places = (count as i32 - 1 - exponent).max(0) as usize;
        return format!("{value:.places$}");
    }
    format!("{value:.*e}", count - 1)
}
