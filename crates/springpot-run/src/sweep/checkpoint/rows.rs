//! The rows that belong to a checkpoint: what is behind them is cut off, what was kept aside takes its place, others are refused.

use super::error::{CheckpointError, at};
use super::record::Stretch;
use super::{CaseState, Earlier, file_of};
use crate::sweep::layout::Layout;
use crate::table::disk::{Disk, DiskFile, Entry};
use crate::table::folder::Folder;
use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// What of the rows is sound.
#[derive(Debug)]
pub(super) struct Sound {
    /// The file that holds them; `None` where there is none.
    pub(super) file: Option<PathBuf>,
    /// The first case that has not ended.
    pub(super) first: usize,
    /// Bytes of the file that are sound, its header included.
    bytes: u64,
    /// Cases that are to follow from what was kept aside.
    pub(super) missing: Vec<(usize, Stretch)>,
}

/// Looks for the cases from `start` that have ended, up to the first that has not, and for the rows of that one; what else was known of later cases and
/// is no longer whole is forgotten, so that they run again.
///
/// The rows of a run are always the same, and are written in the order of the cases: what the file holds is their beginning,
/// however it came to its end. An interrupt has the rows of later cases follow those of the first that is under way; these, too,
/// are kept aside. The loss of power leaves an end that is missing, or zeros: cases that lie there run again. Where nothing
/// is what was written, or the rows of a case under way are not, the rows are another run's or damaged, and are refused.
pub(super) fn survey(
    folder: &Folder,
    earlier: &mut Earlier,
    states: &mut BTreeMap<usize, CaseState>,
    (start, layout): (usize, &Layout),
) -> Result<Sound, CheckpointError> {
    let (disk, results) = (folder.disk(), folder.path());
    let header = crate::sweep::header(layout.written());
    let mut best: Option<Sound> = None;
    let mut there = Vec::new();
    for file in folder.rows() {
        if disk.look(&file).map_err(at(&file))?.is_some() {
            there.push(file);
        }
    }
    let candidates = there.iter().cloned().map(Some).chain(there.is_empty().then_some(None));
    for file in candidates {
        let shown = file.clone().unwrap_or(results.to_owned());
        let found = in_file((disk, results), file, (start, header.as_bytes()), earlier, states).map_err(at(&shown))?;
        let better = |found: &Sound, best: &Sound| (found.first, found.bytes) > (best.first, best.bytes);
        if let Some(found) = found
            && best.as_ref().is_none_or(|best| better(&found, best))
        {
            best = Some(found);
        }
    }
    let Some(sound) = best else {
        return Err(CheckpointError::Rows(there.into_iter().next().unwrap_or(folder.rows()[0].clone())));
    };
    let first = sound.first;
    let is_aside = |case: usize, stretch: Stretch| -> Result<bool, CheckpointError> {
        let file = file_of(results, case, ".rows");
        holds(disk, &file, stretch).map_err(at(&file))
    };
    let mut forgotten = BTreeSet::new();
    for (&case, ended) in earlier.done.range(first..) {
        if case == first || !ended.aside || !is_aside(case, ended.rows)? {
            forgotten.insert(case);
        }
    }
    earlier.done.retain(|case, _| !forgotten.contains(case));
    let mut lost = BTreeSet::new();
    for (&case, state) in states.iter() {
        if case != first && !(state.written.aside && is_aside(case, state.written.rows)?) {
            lost.insert(case);
        }
    }
    states.retain(|case, _| !lost.contains(case));
    let kept = earlier.done.iter().map(|(case, ended)| (*case, ended.kept));
    for (case, stretch) in kept.chain(states.iter().map(|(case, state)| (*case, state.written.kept))) {
        let file = file_of(results, case, ".kept");
        let row = 8 * layout.kept(case).map_or(0, <[usize]>::len) as u64;
        let fits = stretch.bytes == 0 || (row > 0 && stretch.bytes % row == 0);
        if !fits || !holds(disk, &file, stretch).map_err(at(&file))? {
            return Err(CheckpointError::Damaged(file));
        }
    }
    earlier.first = Some(first);
    Ok(sound)
}

/// What is sound in one file; `None` where its rows are not those of the checkpoint.
fn in_file(
    (disk, results): (&Disk, &Path),
    file: Option<PathBuf>,
    (start, header): (usize, &[u8]),
    earlier: &Earlier,
    states: &BTreeMap<usize, CaseState>,
) -> io::Result<Option<Sound>> {
    let mut rows: Box<dyn Read> = match &file {
        Some(file) => Box::new(BufReader::new(disk.open(file)?)),
        None => Box::new(io::empty()),
    };
    let mut beginning = Vec::new();
    rows.by_ref().take(header.len() as u64).read_to_end(&mut beginning)?;
    if !header.starts_with(&beginning) {
        let mut after = beginning.iter().zip(header).skip_while(|(found, wrote)| found == wrote);
        if after.any(|(found, _)| *found != 0) {
            return Ok(None);
        }
        // Power was lost before the header was safe: no row is.
        rows = Box::new(io::empty());
    }
    let is_aside = |case: usize, stretch: Stretch| holds(disk, &file_of(results, case, ".rows"), stretch);
    let mut sound = Sound { file, first: start, bytes: header.len() as u64, missing: Vec::new() };
    while let Some(ended) = earlier.done.get(&sound.first) {
        let found = if sound.missing.is_empty() { compare(&mut rows, ended.rows)? } else { Found::Torn };
        if found == Found::Same {
            sound.bytes += ended.rows.bytes;
        } else if ended.aside && is_aside(sound.first, ended.rows)? {
            sound.missing.push((sound.first, ended.rows));
        } else if found == Found::Other && sound.first == start {
            return Ok(None);
        } else {
            break;
        }
        sound.first += 1;
    }
    if let Some(state) = states.get(&sound.first)
        && !earlier.done.contains_key(&sound.first)
    {
        let stretch = state.written.rows;
        if state.written.aside && is_aside(sound.first, stretch)? {
            sound.missing.push((sound.first, stretch));
        } else if !state.written.aside && sound.missing.is_empty() && compare(&mut rows, stretch)? == Found::Same {
            sound.bytes += stretch.bytes;
        } else {
            return Ok(None);
        }
    }
    Ok(Some(sound))
}

/// What stands where a stretch should.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Found {
    Same,
    /// Less, or zeros at its end.
    Torn,
    Other,
}

/// Reads as much as a stretch is long, and compares it.
fn compare(from: &mut impl Read, wanted: Stretch) -> io::Result<Found> {
    let (mut from, mut piece) = (from.take(wanted.bytes), vec![0; 1 << 16]);
    let (mut read, mut last) = (Stretch::default(), None);
    loop {
        match from.read(&mut piece) {
            Ok(0) => break,
            Ok(length) => {
                read.take(&piece[..length]);
                last = Some(piece[length - 1]);
            }
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    let torn = read.bytes < wanted.bytes || last == Some(0);
    Ok(if read == wanted {
        Found::Same
    } else if torn {
        Found::Torn
    } else {
        Found::Other
    })
}

/// Whether a file begins with a stretch.
fn holds(disk: &Disk, file: &Path, stretch: Stretch) -> io::Result<bool> {
    if stretch.bytes == 0 {
        return Ok(true);
    }
    match disk.look(file)? {
        Some(Entry::File(length)) if length >= stretch.bytes => {
            Ok(compare(&mut disk.open(file)?, stretch)? == Found::Same)
        }
        _ => Ok(false),
    }
}

/// Has the file of the rows end with what is sound, and adds what is missing from what was kept aside.
pub(super) fn restore(folder: &Folder, sound: &Sound, layout: &Layout) -> io::Result<()> {
    let header = crate::sweep::header(layout.written());
    let [part, _] = folder.rows();
    let mut file = match &sound.file {
        Some(from) if *from == part => {
            let mut file = folder.reopen_rows()?;
            file.write_all(header.as_bytes())?;
            file.set_length(sound.bytes)?;
            file.seek(SeekFrom::Start(sound.bytes))?;
            file
        }
        // The results of an interrupted run stay as they are until there are others.
        Some(from) if sound.bytes > header.len() as u64 => {
            let mut file = folder.create_rows()?;
            copy(folder.disk().open(from)?, sound.bytes, &mut |piece| file.write_all(piece))?;
            file
        }
        _ => {
            let mut file = folder.create_rows()?;
            file.write_all(header.as_bytes())?;
            file
        }
    };
    for (case, stretch) in &sound.missing {
        let path = file_of(folder.path(), *case, ".rows");
        copy_aside(folder.disk(), &path, *stretch, &mut |piece| file.write_all(piece))?;
    }
    file.sync()?;
    folder.disk().sync_folder(folder.path())
}

/// Hands over the stretch at the beginning of a file, piece by piece.
pub(super) fn copy_aside(
    disk: &Disk,
    file: &Path,
    stretch: Stretch,
    take: &mut dyn FnMut(&[u8]) -> io::Result<()>,
) -> io::Result<()> {
    if stretch.bytes == 0 {
        return Ok(());
    }
    copy(disk.open(file)?, stretch.bytes, take)
}

pub(super) fn copy(from: DiskFile, bytes: u64, take: &mut dyn FnMut(&[u8]) -> io::Result<()>) -> io::Result<()> {
    let (mut from, mut piece) = (from.take(bytes), vec![0; 1 << 16]);
    while from.limit() > 0 {
        match from.read(&mut piece) {
            Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
            Ok(length) => take(&piece[..length])?,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}
