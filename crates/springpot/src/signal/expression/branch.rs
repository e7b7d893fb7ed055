//! On which side of its kinks an expression is.

/// A side for each kink of an expression, in the order in which they are met: below, or not.
///
/// Two times with equal branches have no kink between them that has switched an odd number of times.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Branch {
    /// Those of the first 64, which is all that most expressions have.
    pub(super) first: u64,
    /// Those of the others, 64 at a time.
    pub(super) rest: Vec<u64>,
}

impl Branch {
    /// Whether kink `k` is below.
    pub fn is_below(&self, k: usize) -> bool {
        let word = if k < 64 { Some(&self.first) } else { self.rest.get(k / 64 - 1) };
        word.is_some_and(|word| word >> (k % 64) & 1 == 1)
    }

    /// The kinks that are below.
    pub fn below(&self) -> impl Iterator<Item = usize> + '_ {
        let words = std::iter::once(&self.first).chain(&self.rest).enumerate();
        words.flat_map(|(at, &word)| (0..64).filter(move |bit| word >> bit & 1 == 1).map(move |bit| 64 * at + bit))
    }

    /// Puts kink `k` below.
    pub(super) fn set(&mut self, k: usize) {
        if k < 64 {
            self.first |= 1 << k;
            return;
        }
        let at = k / 64 - 1;
        if self.rest.len() <= at {
            self.rest.resize(at + 1, 0);
        }
        self.rest[at] |= 1 << (k % 64);
    }

    /// Whether none is below.
    pub(in crate::signal) fn is_empty(&self) -> bool {
        self.first == 0 && self.rest.iter().all(|word| *word == 0)
    }
}

#[cfg(test)]
mod tests {
    use super::Branch;

    #[test]
    fn any_number_of_kinks_has_its_side() {
        let mut branch = Branch::default();
        let below = [0, 5, 63, 64, 130, 1000];
        below.iter().for_each(|k| branch.set(*k));
        assert!(branch.below().eq(below));
        assert!((0..1100).all(|k| branch.is_below(k) == below.contains(&k)));
        assert!(!branch.is_empty() && Branch::default().is_empty());
    }
}
