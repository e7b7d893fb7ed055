//! What a checkpoint holds, as it is written.

use crate::asked::Asked;
use crate::sweep::events::CaseEvents;
use crate::sweep::metrics::CaseMetrics;
use crate::sweep::shard::Shard;
use crate::table::sealed::SealError;
use crate::table::{Format, Statistics};
use crate::trouble::Trouble;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use springpot::driver::{Checkpoint, PassedLimit, Report, Watch};
use springpot::sensitivity::Lost;
use springpot::system::{Stop, System};
use springpot_scenario::{Cases, Plan};
use std::fmt::{self, Write as _};
use std::io;
use std::ops::Range;
use std::time::Duration;

/// Where a run comes from: all that its command said.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Origin {
    /// The scenario, and what was set and swept.
    pub asked: Asked,
    /// Whether figures are drawn.
    pub figures: bool,
    /// Simulated time from one checkpoint to the next, s; infinite where a case has none before its end.
    pub every: f64,
    /// The format of the rows at the end.
    pub format: Format,
    /// The part of the cases that is run; `None`: all.
    pub shard: Option<Shard>,
}

impl Origin {
    /// The cases that are run, of `all`.
    pub fn cases(&self, all: usize) -> Range<usize> {
        self.shard.map_or(0..all, |shard| shard.cases(all))
    }
}

/// What all cases share.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Head {
    pub(super) origin: Origin,
    pub(super) cases: usize,
    /// [`digest`] of the first case.
    pub(super) digest: u32,
}

/// A beginning of a file, or a part of one: how long it is, and what its bytes are.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(in crate::sweep) struct Stretch {
    pub(in crate::sweep) bytes: u64,
    /// CRC-32 of the bytes.
    pub(in crate::sweep) sum: u32,
}

impl Stretch {
    /// The stretch with `bytes` behind it.
    pub(in crate::sweep) fn take(&mut self, bytes: &[u8]) {
        let mut hasher = crc32fast::Hasher::new_with_initial_len(self.sum, self.bytes);
        hasher.update(bytes);
        *self = Self { bytes: self.bytes + bytes.len() as u64, sum: hasher.finalize() };
    }
}

/// How far a case has written.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(in crate::sweep) struct Written {
    /// Its rows.
    pub(in crate::sweep) rows: Stretch,
    /// Whether its rows are in a file of their own too, since its turn had not come when it began.
    pub(in crate::sweep) aside: bool,
    /// Its values that are kept for figures.
    pub(in crate::sweep) kept: Stretch,
    /// One for each selected column, and for those beside them that rank parameters.
    pub(in crate::sweep) statistics: Vec<Statistics>,
    /// Its events.
    pub(in crate::sweep) events: CaseEvents,
    /// Wall time of the case.
    pub(in crate::sweep) wall: Duration,
    /// Wall time of the whole run when this was written.
    pub(in crate::sweep) wall_of_run: Duration,
}

/// A case under way.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(in crate::sweep) struct CaseState {
    pub(in crate::sweep) index: usize,
    pub(in crate::sweep) digest: u32,
    pub(in crate::sweep) written: Written,
    pub(in crate::sweep) watch: Watch,
    pub(in crate::sweep) lost: Vec<Lost>,
    pub(in crate::sweep) run: Checkpoint,
}

/// A case that has come to its end.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(in crate::sweep) struct CaseDone {
    pub(in crate::sweep) index: usize,
    pub(in crate::sweep) written: Written,
    pub(in crate::sweep) report: Report,
    pub(in crate::sweep) error: Option<Trouble>,
    pub(in crate::sweep) no_ledger: Option<String>,
    pub(in crate::sweep) limits: Vec<PassedLimit>,
    pub(in crate::sweep) metrics: CaseMetrics,
}

/// CRC-32 of formatted text.
struct TextSum(crc32fast::Hasher);

impl fmt::Write for TextSum {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0.update(text.as_bytes());
        Ok(())
    }
}

/// A number that differs where a case differs: in its plan as resolved, in a signal's samples, in a tolerance.
pub(super) fn digest(plan: &Plan, system: &System) -> u32 {
    let mut sum = TextSum(crc32fast::Hasher::new());
    let inputs: Vec<_> = system.elements.iter().map(|element| &element.inputs).collect();
    let written = write!(sum, "{} {:?} {:?} {inputs:?}", plan.resolved(), plan.settings, system.motion);
    written.expect("a sum takes all text");
    sum.0.finalize()
}

/// As [`digest`], of case `index`; `None` where its plan is refused.
pub(super) fn digest_of(cases: &Cases, index: usize) -> Option<u32> {
    // What a gripper path leads to follows from what is asked of it.
    let unsolved = Stop::new(true);
    cases.plan(index).ok().map(|plan| digest(&plan, &plan.system_unless(&unsolved)))
}

/// Bytes that hold every number to the bit.
pub(in crate::sweep) fn bytes(value: &impl Serialize) -> io::Result<Vec<u8>> {
    postcard::to_stdvec(value).map_err(io::Error::other)
}

/// What [`bytes`] were made from.
pub(in crate::sweep) fn value<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, SealError> {
    match postcard::take_from_bytes(bytes) {
        Ok((value, [])) => Ok(value),
        _ => Err(SealError::Damaged),
    }
}
