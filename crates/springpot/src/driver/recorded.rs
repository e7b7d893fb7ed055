//! Runs that are recorded: what is kept of them to go back through them, and what is run again for it.

use super::run::{Begun, go};
use super::state::Checkpoint;
use super::time_loop::Driver;
use crate::account::recorder::Recorder;
use crate::equations::{Backwards, Endings, Entries, Starts};
use crate::observe::Snapshot;
use crate::system::System;
use crate::system::error::RunError;
use crate::system::sensitivity::{Lost, Share};
use crate::system::settings::{Settings, Stop};

/// Most that a [`Tape`] keeps of the maps of a run, bytes. Beyond it stretches of the run are run again when they are gone back through.
pub const MOST_KEPT: usize = 1 << 30;

/// Stretches that what may be kept is room for.
const STRETCHES: usize = 8;

/// A run to be gone back through.
#[derive(Debug)]
pub struct Tape {
    system: System,
    settings: Settings,
    kept: Kept,
    /// Numbers of parameters, of columns, of memories and of quantities of a row.
    sizes: [usize; 4],
}

/// What is kept of a run.
#[derive(Debug)]
pub(super) struct Kept {
    /// At most, bytes.
    most: usize,
    /// Whether a stretch is run again: it ends where it ended before.
    is_again: bool,
    stretches: Vec<Stretch>,
}

/// A stretch of it.
#[derive(Debug)]
struct Stretch {
    /// Where it begins, if not at t = 0.
    from: Option<(Checkpoint, Starts)>,
    /// `None` where there was no room.
    entries: Option<Entries>,
    /// Whether derivatives end in it.
    has_endings: bool,
}

impl Kept {
    /// Of a run, or of a stretch that is run again.
    pub(super) fn new(most: usize, is_again: bool) -> Self {
        Self { most, is_again, stretches: vec![Stretch { from: None, entries: None, has_endings: false }] }
    }

    /// Ends the stretch at hand where it is long enough; everything is settled. `true` where a stretch that is run again is over.
    pub(super) fn look(
        &mut self,
        driver: &mut Driver,
        checkpoint: impl FnOnce(&Driver) -> Checkpoint,
    ) -> Result<bool, RunError> {
        driver.cut()?;
        let Some(recording) = &mut driver.recorder.recording else { return Ok(false) };
        // Rows since the cut would not be written again.
        if recording.bytes() < self.most / STRETCHES || recording.has_rows() {
            return Ok(false);
        }
        let (entries, starts) = (recording.take_entries(), recording.starts().clone());
        self.take(entries);
        if !self.is_again {
            self.stretches.push(Stretch {
                from: Some((checkpoint(driver), starts)),
                entries: None,
                has_endings: false,
            });
        }
        Ok(self.is_again)
    }

    /// Takes in the stretch at hand, and forgets the earliest ones where there is no room.
    fn take(&mut self, entries: Entries) {
        let Some((last, earlier)) = self.stretches.split_last_mut() else { return };
        let mut left = self.most.saturating_sub(self.most / STRETCHES + entries.bytes());
        last.has_endings = entries.has_endings();
        last.entries = Some(entries);
        for stretch in earlier.iter_mut().rev() {
            let bytes = stretch.entries.as_ref().map_or(0, Entries::bytes);
            if bytes > left {
                stretch.entries = None;
            }
            left = if stretch.entries.is_some() { left - bytes } else { 0 };
        }
    }

    /// The run is over.
    pub(super) fn end(&mut self, driver: &mut Driver) -> Option<[usize; 4]> {
        let Recorder { variation: Some(variation), recording: Some(recording), .. } = &mut driver.recorder else {
            return None;
        };
        if self.stretches.last().is_some_and(|last| last.entries.is_none()) {
            recording.finish(variation);
            self.take(recording.take_entries());
        }
        Some(recording.sizes())
    }
}

impl Tape {
    pub(super) fn new(system: &System, settings: &Settings, kept: Kept, sizes: [usize; 4]) -> Self {
        Self { system: system.clone(), settings: settings.clone(), kept, sizes }
    }

    /// How much it holds of the maps of steps, bytes.
    pub fn bytes(&self) -> usize {
        self.kept.stretches.iter().flat_map(|stretch| &stretch.entries).map(Entries::bytes).sum()
    }

    /// The derivatives of numbers by all parameters: of each number its own, where it changes by its `shares` of rows. No number where none exists.
    ///
    /// # Errors
    /// [`RunError::Interrupted`] in a stretch that is run again.
    pub fn gradients(&self, shares: &[Vec<Share>], stop: &Stop) -> Result<Vec<Vec<f64>>, RunError> {
        if shares.is_empty() {
            return Ok(Vec::new());
        }
        let mut back = Backwards::new(shares, self.sizes);
        for stretch in self.kept.stretches.iter().rev() {
            match &stretch.entries {
                Some(entries) => back.go(entries),
                None => back.go(&self.again(stretch, stop)?),
            }
        }
        Ok(back.gradients())
    }

    /// By which parameters derivatives end, and where: none where they do not.
    ///
    /// # Errors
    /// [`RunError::Interrupted`] in a stretch that is run again.
    pub fn lost(&self, stop: &Stop) -> Result<Vec<Lost>, RunError> {
        let Some(last) = self.kept.stretches.iter().rposition(|stretch| stretch.has_endings) else {
            return Ok(Vec::new());
        };
        let mut endings = Endings::new(self.sizes);
        for stretch in &self.kept.stretches[..=last] {
            match &stretch.entries {
                Some(entries) => endings.go(entries),
                None => endings.go(&self.again(stretch, stop)?),
            }
        }
        Ok(endings.lost())
    }

    /// Runs a stretch again.
    fn again(&self, stretch: &Stretch, stop: &Stop) -> Result<Entries, RunError> {
        let (system, settings) = (&self.system, &self.settings);
        let mut kept = Kept::new(self.kept.most, true);
        let mut nobody = |_: &[f64]| Ok(());
        let begun = match &stretch.from {
            None => Begun::new(system, settings, stop, |_| ()),
            Some((checkpoint, starts)) => {
                let mut begun = Begun::again(system, settings, checkpoint.clone(), stop, |_| ());
                if let Ok(Some(recording)) = begun.driver.as_mut().map(|driver| &mut driver.recorder.recording) {
                    recording.go_on(starts.clone());
                }
                begun
            }
        };
        let (_, outcome) = go(system, begun, &mut nobody, &mut kept, stop);
        outcome?;
        let entries = kept.stretches.pop().and_then(|stretch| stretch.entries);
        entries.ok_or(RunError::OtherRun)
    }
}

impl Driver {
    /// Whether the run is kept, to go back through it.
    pub(super) fn is_recorded(&self) -> bool {
        self.recorder.recording.is_some()
    }

    /// A step is about to be tried.
    pub(super) fn begin_recording(&mut self) {
        if let Recorder { variation: Some(variation), recording: Some(recording), .. } = &mut self.recorder {
            recording.begin_step(variation);
        }
    }

    /// Cuts what was taken into the past off, where the run is kept; everything is settled.
    ///
    /// # Errors
    /// What cannot be gone back through.
    pub(super) fn cut(&mut self) -> Result<(), RunError> {
        let Self { recorder: Recorder { equations, variation, recording, .. }, sampler, .. } = self;
        if let (Some(recording), Some(variation)) = (recording, variation) {
            recording.cut(variation, equations, sampler.as_deref_mut())?;
        }
        Ok(())
    }

    /// Keeps row `number`, which was read into `snapshot`, at θ of the step at hand or between two, where the run is kept.
    ///
    /// # Errors
    /// What has no derivative.
    pub(super) fn keep_row(&mut self, theta: Option<f64>, number: usize, snapshot: &Snapshot) -> Result<(), RunError> {
        if theta.is_none() && self.recorder.recording.as_ref().is_some_and(|recording| recording.took_step()) {
            self.cut()?;
        }
        let Recorder { variation: Some(variation), recording: Some(recording), .. } = &mut self.recorder else {
            return Ok(());
        };
        if theta.is_some_and(|theta| recording.note_row(variation, number, theta)) {
            return Ok(());
        }
        if variation.is_unsolved() {
            // What memories are asked for by the step is none of the row's.
            let within = theta.zip(self.step_at_hand()).map(|(theta, step)| (theta, step.size));
            self.solver.stepper_mut().vary_within(&mut self.recorder, within, snapshot);
        }
        let Recorder { equations, variation: Some(variation), recording: Some(recording), .. } = &mut self.recorder
        else {
            return Ok(());
        };
        if theta.is_some() {
            variation.prepare_works(equations);
        }
        let (is_of_motion, before) = recording.begin_row(variation);
        self.vary(theta, snapshot, is_of_motion);
        if let Recorder { variation: Some(variation), recording: Some(recording), .. } = &mut self.recorder {
            recording.keep_row(number, snapshot, variation, before)?;
        }
        Ok(())
    }
}
