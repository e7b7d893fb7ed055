//! Zeros of functions on a step, θ from 0 to 1.

use crate::collocation::Cubic;

/// The first zero of a cubic that is positive at 0, or at `early` where it begins on a zero.
pub(crate) fn first_zero_of(cubic: &Cubic, early: f64) -> Option<f64> {
    if cubic.is_clear() { None } else { first_zero(|theta| cubic.at(theta.max(early))) }
}

/// Places at which a step is looked at.
pub(crate) const SAMPLES: usize = 16;

/// The first zero on [0, 1] of a function that is positive at 0; 0 where it is not.
///
/// A dip that is narrower than a sixteenth is seen where the function has one lowest place there.
pub(crate) fn first_zero(mut f: impl FnMut(f64) -> f64) -> Option<f64> {
    let (mut a, mut at_a) = (0.0, f(0.0));
    if at_a <= 0.0 {
        return Some(0.0);
    }
    let mut before: Option<(f64, f64)> = None;
    for i in 1..=SAMPLES {
        let b = i as f64 / SAMPLES as f64;
        let at_b = f(b);
        if at_b <= 0.0 {
            return Some(zero_between(&mut f, a, b));
        }
        if let Some((left, at_left)) = before
            && at_a <= at_left
            && at_a < at_b
        {
            let low = lowest_between(&mut f, left, b);
            if f(low) <= 0.0 {
                return Some(zero_between(&mut f, left, low));
            }
        }
        before = Some((a, at_a));
        (a, at_a) = (b, at_b);
    }
    None
}

/// The zero between a place where `f` is positive and one where it is not.
pub(crate) fn zero_between(f: &mut impl FnMut(f64) -> f64, above: f64, below: f64) -> f64 {
    zero_within(f, above, below, 0.0)
}

/// As [`zero_between`], no closer than this.
pub(crate) fn zero_within(f: &mut impl FnMut(f64) -> f64, mut above: f64, mut below: f64, close: f64) -> f64 {
    while below - above > (f64::EPSILON * below).max(close) {
        let middle = 0.5 * (above + below);
        if middle <= above || middle >= below {
            break;
        }
        if f(middle) > 0.0 { above = middle } else { below = middle }
    }
    below
}

/// The lowest place of a function with one dip between `a` and `b`, by golden sections.
pub(crate) fn lowest_between(f: &mut impl FnMut(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    const SECTION: f64 = 0.618_033_988_749_894_8;
    for _ in 0..40 {
        let (c, d) = (b - SECTION * (b - a), a + SECTION * (b - a));
        if f(c) < f(d) { b = d } else { a = c }
    }
    0.5 * (a + b)
}

#[cfg(test)]
mod tests {
    use super::first_zero;

    #[test]
    fn first_zeros() {
        let near = |found: Option<f64>, expected: f64| assert!((found.unwrap() - expected).abs() < 1e-12, "{found:?}");
        near(first_zero(|x| 0.3 - x), 0.3);
        near(first_zero(|x| (0.5 - x) * (x - 0.7) * (x - 0.9)), 0.5);
        // A dip between two samples.
        near(first_zero(|x| (x - 0.51) * (x - 0.52)), 0.51);
        assert_eq!(first_zero(|x| (x - 0.5).powi(2) + 1e-9), None);
        near(first_zero(|x| 1e-11 - x), 1e-11);
        assert_eq!(first_zero(|x| -1.0 - x), Some(0.0));
    }
}
