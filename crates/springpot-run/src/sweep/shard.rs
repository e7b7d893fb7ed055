//! A part of the cases of a sweep, for one of several machines.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::ops::Range;
use std::str::FromStr;

/// One of `count` stretches of cases, as equal as they can be; the first is 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    number: usize,
    count: usize,
}

impl Shard {
    /// Shard `number` of `count`; `None` unless 1 <= number <= count.
    pub fn new(number: usize, count: usize) -> Option<Self> {
        (1..=count).contains(&number).then_some(Self { number, count })
    }

    /// Which of them it is, from 1.
    pub fn number(self) -> usize {
        self.number
    }

    /// How many there are.
    pub fn count(self) -> usize {
        self.count
    }

    /// Its cases, of `all`; none where there are more shards than cases.
    pub fn cases(self, all: usize) -> Range<usize> {
        // The first ones take what does not divide.
        let (each, more) = (all / self.count, all % self.count);
        let before = |shards: usize| shards * each + shards.min(more);
        before(self.number - 1)..before(self.number)
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.count)
    }
}

/// Why a text names no shard.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("write which of how many, 1/16 \u{2026} 16/16")]
pub struct NoShard;

impl FromStr for Shard {
    type Err = NoShard;

    fn from_str(text: &str) -> Result<Self, NoShard> {
        let (number, count) = text.split_once('/').ok_or(NoShard)?;
        let whole = |text: &str| text.trim().parse::<usize>().map_err(|_| NoShard);
        Self::new(whole(number)?, whole(count)?).ok_or(NoShard)
    }
}

#[cfg(test)]
mod tests {
    use super::Shard;

    #[test]
    fn shards_are_every_case_once_and_of_one_size() {
        for (all, count) in [(0, 3), (1, 3), (7, 3), (16, 16), (10_000, 7), (5, 9)] {
            let parts: Vec<_> = (1..=count).map(|number| Shard::new(number, count).unwrap().cases(all)).collect();
            assert!(parts.iter().cloned().flatten().eq(0..all), "{all} {count}");
            let sizes = || parts.iter().map(ExactSizeIterator::len);
            assert!(sizes().max().unwrap() - sizes().min().unwrap() <= 1);
        }
    }

    #[test]
    fn only_one_to_count_are_shards() {
        assert_eq!("3/16".parse(), Ok(Shard::new(3, 16).unwrap()));
        for text in ["", "3", "0/16", "17/16", "3/0", "-1/2", "1/2/3", "a/b", "1.0/2"] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
    }
}
