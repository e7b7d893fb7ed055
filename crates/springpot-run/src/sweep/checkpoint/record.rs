//! What a checkpoint holds, as it is written.

use crate::sweep::events::CaseEvents;
use crate::sweep::metrics::CaseMetrics;
use crate::table::sealed::SealError;
use crate::table::{Format, Statistics};
use crate::trouble::Trouble;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use springpot::integrate::{Checkpoint, PassedLimit, Report, Stop, System, Watch};
use springpot_scenario::{Cases, Plan, RefusalKind, Scenario};
use std::fmt::{self, Write as _};
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Where a run comes from: all that its command said.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Origin {
    /// The scenario's file as it was typed.
    pub typed: String,
    /// The same from the root of the file system.
    pub file: PathBuf,
    /// Its text.
    pub text: String,
    /// The values that were set, `PATH=VALUE`.
    pub overrides: Vec<String>,
    /// The parameters that were swept, `PATH=v1,v2,…`.
    pub sweeps: Vec<String>,
    /// Whether figures are drawn.
    pub figures: bool,
    /// Simulated time from one checkpoint to the next, s.
    pub every: f64,
    /// The format of the rows at the end.
    pub format: Format,
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
    /// One for each selected column.
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

impl Origin {
    /// The origin of a run of `scenario`, read from `file`, with nothing set or swept.
    ///
    /// # Errors
    /// The file system's, where the file is gone.
    pub fn of(file: &Path, scenario: &Scenario, figures: bool, every: f64) -> io::Result<Self> {
        Ok(Self {
            typed: file.display().to_string(),
            file: file.canonicalize()?,
            text: scenario.source().text.to_string(),
            overrides: Vec::new(),
            sweeps: Vec::new(),
            figures,
            every,
            format: Format::Csv,
        })
    }

    /// The scenario; `None` where its file says something else by now. A file that is gone does not matter.
    ///
    /// # Errors
    /// As [`Scenario::parse`] and [`Scenario::set`].
    pub fn scenario(&self) -> Result<Option<Scenario>, springpot_scenario::Refusals> {
        match Scenario::read(&self.file) {
            Ok(now) if *now.source().text != *self.text => return Ok(None),
            Err(refusals) if refusals.iter().any(|refusal| refusal.kind != RefusalKind::File) => return Ok(None),
            _ => {}
        }
        // As typed, where that still leads there: messages then name files as those of the first command did.
        let typed = Path::new(&self.typed);
        let same = typed.canonicalize().is_ok_and(|file| file == self.file);
        let folder = if same { typed } else { &self.file }.parent().unwrap_or(Path::new(""));
        let mut scenario = Scenario::parse(&self.text, &*self.typed, folder)?;
        self.overrides.iter().try_for_each(|assignment| scenario.set(assignment))?;
        self.sweeps.iter().try_for_each(|assignment| scenario.sweep(assignment))?;
        Ok(Some(scenario))
    }
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
pub(super) fn bytes(value: &impl Serialize) -> io::Result<Vec<u8>> {
    postcard::to_stdvec(value).map_err(io::Error::other)
}

/// What [`bytes`] were made from.
pub(super) fn value<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, SealError> {
    match postcard::take_from_bytes(bytes) {
        Ok((value, [])) => Ok(value),
        _ => Err(SealError::Damaged),
    }
}
