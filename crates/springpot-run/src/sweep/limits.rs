//! Limits of joints that cases pass, gathered over the cases.

use springpot::driver::{LimitKind, PassedLimit};
use std::collections::HashMap;

/// A limit that one or more cases pass.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct CasesPassing {
    /// What the first of them does.
    #[serde(flatten)]
    pub passed: PassedLimit,
    /// Index of that case in the grid.
    pub case: usize,
    /// How many cases pass it.
    pub cases: usize,
}

/// Gathers what the cases pass, in any order of the cases.
#[derive(Debug, Default)]
pub struct LimitTally(HashMap<(String, LimitKind), (CasesPassing, usize)>);

impl LimitTally {
    /// Takes what case `index` passes.
    pub fn take(&mut self, index: usize, limits: &[PassedLimit]) {
        for (position, passed) in limits.iter().enumerate() {
            let new = || (CasesPassing { passed: passed.clone(), case: index, cases: 0 }, position);
            let (known, at) = self.0.entry((passed.joint.clone(), passed.kind)).or_insert_with(new);
            if index < known.case {
                (known.passed, known.case, *at) = (passed.clone(), index, position);
            }
            known.cases += 1;
        }
    }

    /// Joint and limit by joint and limit, as the first cases list them.
    pub fn passing(&self) -> Vec<CasesPassing> {
        let mut all: Vec<_> = self.0.values().collect();
        all.sort_by_key(|(known, position)| (known.case, *position));
        all.into_iter().map(|(known, _)| known.clone()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn passed(joint: &str, kind: LimitKind, value: f64) -> PassedLimit {
        PassedLimit { joint: joint.into(), kind, limit: 1.0, unit: "rad", first: 0.0, farthest: 0.5, value }
    }

    #[test]
    fn the_order_of_the_cases_does_not_matter() {
        let cases = [
            vec![],
            vec![passed("b", LimitKind::Upper, 1.5)],
            vec![passed("a", LimitKind::Upper, 1.25), passed("b", LimitKind::Upper, 1.75)],
        ];
        let gathered = |order: [usize; 3]| {
            let mut tally = LimitTally::default();
            order.iter().for_each(|&index| tally.take(index, &cases[index]));
            tally.passing()
        };
        let expected = gathered([0, 1, 2]);
        let brief = expected.iter().map(|one| (one.passed.joint.as_str(), one.passed.value, one.case, one.cases));
        assert_eq!(brief.collect::<Vec<_>>(), [("b", 1.5, 1, 2), ("a", 1.25, 2, 1)]);
        for order in [[0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
            assert_eq!(gathered(order), expected);
        }
    }
}
