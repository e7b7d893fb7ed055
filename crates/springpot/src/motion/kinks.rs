//! Finding the times at which signals change their branch.

use crate::signal::Signal;

/// Signature of the branches that several signals are on at t.
pub fn branch<'a>(signals: impl IntoIterator<Item = &'a Signal>, t: f64) -> u64 {
    signals.into_iter().fold(0, |sum, signal| sum.rotate_left(7) ^ signal.branch(t))
}

/// The last time with the branch of `from` and the first time with another one, where `branch(to)` differs from `branch(from)`.
///
/// No number lies between them, but next to t = 0, where they are closer than 1e-31·`to`.
pub fn locate(branch: impl Fn(f64) -> u64, from: f64, to: f64) -> (f64, f64) {
    let before = branch(from);
    let (mut low, mut high) = (from, to);
    while low.next_up() < high && high - low > f64::EPSILON * f64::EPSILON * to.abs() {
        let middle = low + 0.5 * (high - low);
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
        assert!(high == 0.3 && low == 0.3f64.next_down());
        let (low, high) = locate(|t| (t > 0.0) as u64, 0.0, 1.0);
        assert!(low == 0.0 && high <= 1e-15);
    }
}
