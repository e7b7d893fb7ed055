//! Finding the times at which signals change their branch.

use crate::signal::Signal;

/// Signature of the branches that several signals are on at t.
pub fn branch<'a>(signals: impl IntoIterator<Item = &'a Signal>, t: f64) -> u64 {
    signals.into_iter().fold(0, |sum, signal| sum.rotate_left(7) ^ signal.branch(t))
}

/// The last time with the branch of `from` and the first time with another one, where `branch(to)` differs from `branch(from)`.
///
/// They are neighbours up to a few bits of `to`.
pub fn locate(branch: impl Fn(f64) -> u64, from: f64, to: f64) -> (f64, f64) {
    let before = branch(from);
    let (mut low, mut high) = (from, to);
    while high - low > 2.0 * f64::EPSILON * to.abs() {
        let middle = 0.5 * (low + high);
        if branch(middle) == before { low = middle } else { high = middle }
    }
    (low, high)
}

#[cfg(test)]
mod tests {
    use super::locate;

    #[test]
    fn neighbours() {
        let (low, high) = locate(|t| (t >= 0.3) as u64, 0.1, 5.0);
        assert!(low < 0.3 && high >= 0.3 && high - low < 3e-15);
        let (low, high) = locate(|t| (t > 0.0) as u64, 0.0, 1.0);
        assert!(low == 0.0 && high <= 1e-15);
    }
}
