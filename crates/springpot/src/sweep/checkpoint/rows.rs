//! The rows that belong to a checkpoint: what is behind them is cut off, what was kept aside takes its place.

use super::error::{CheckpointError, at};
use super::{CaseState, Earlier, Written, file_of, length};
use crate::sweep::layout::Layout;
use crate::table::folder::Folder;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

/// Leaves in the file of the rows the cases that have ended, up to the first that has not, and the rows of that one; what else was
/// known of later cases and is no longer whole is forgotten, so that they run again.
///
/// The rows of a run are always the same, and are written in the order of the cases: what the file holds is their beginning,
/// however it came to its end. An interrupt has the rows of later cases follow those of the first that is under way; these, too,
/// are kept aside.
pub(super) fn restore(
    results: &Path,
    earlier: &mut Earlier,
    states: &mut BTreeMap<usize, CaseState>,
    layout: &Layout,
) -> Result<Folder, CheckpointError> {
    let header = crate::sweep::header(layout.written());
    let (path, beginning) = Folder::rows_of(results, header.len()).map_err(at(results))?;
    let wrong = || CheckpointError::Rows(path.clone());
    if !header.as_bytes().starts_with(&beginning) {
        return Err(wrong());
    }
    let has = length(&path);
    let is_aside = |case: usize, bytes: u64| length(&file_of(results, case, ".rows")) >= bytes;

    let (mut end, mut first, mut missing) = (header.len() as u64, 0, Vec::new());
    // Where the rows that the file is to keep end.
    let mut sound = end;
    while let Some(ended) = earlier.done.get(&first) {
        end += ended.bytes;
        if missing.is_empty() && end <= has {
            sound = end;
        } else if ended.aside && is_aside(first, ended.bytes) {
            missing.push((first, ended.bytes));
        } else {
            break;
        }
        first += 1;
    }
    if let Some(state) = states.get(&first) {
        let Written { bytes, aside, .. } = state.written;
        if aside && is_aside(first, bytes) {
            missing.push((first, bytes));
        } else if !aside && missing.is_empty() && sound + bytes <= has {
            sound += bytes;
        } else {
            return Err(wrong());
        }
    }
    earlier.done.retain(|case, ended| *case < first || (*case > first && ended.aside && is_aside(*case, ended.bytes)));
    states.retain(|case, state| *case == first || (state.written.aside && is_aside(*case, state.written.bytes)));
    let kept = earlier.done.iter().map(|(case, ended)| (*case, ended.kept));
    for (case, rows) in kept.chain(states.iter().map(|(case, state)| (*case, state.written.kept))) {
        let file = file_of(results, case, ".kept");
        let columns = layout.kept(case).map_or(0, <[usize]>::len) as u64;
        if length(&file) < rows.saturating_mul(8 * columns) {
            return Err(CheckpointError::Damaged(file));
        }
    }
    earlier.first = Some(first);

    let folder = Folder::reopen(results).map_err(at(results))?;
    rewrite(&folder, header.as_bytes(), sound, &missing).map_err(at(&path))?;
    Ok(folder)
}

/// Cuts the rows back to `sound` bytes and adds what is missing from what was kept aside.
fn rewrite(folder: &Folder, header: &[u8], sound: u64, missing: &[(usize, u64)]) -> io::Result<()> {
    let mut file = folder.reopen_rows()?;
    file.write_all(header)?;
    file.set_len(sound)?;
    file.seek(SeekFrom::End(0))?;
    for &(case, bytes) in missing {
        copy_aside(&file_of(folder.path(), case, ".rows"), bytes, &mut |piece| file.write_all(piece))?;
    }
    file.sync_all()
}

/// Hands over the first `bytes` of a file, piece by piece.
pub(super) fn copy_aside(file: &Path, bytes: u64, take: &mut dyn FnMut(&[u8]) -> io::Result<()>) -> io::Result<()> {
    if bytes == 0 {
        return Ok(());
    }
    let (mut from, mut piece) = (File::open(file)?.take(bytes), vec![0; 1 << 16]);
    while from.limit() > 0 {
        match from.read(&mut piece)? {
            0 => return Err(io::ErrorKind::UnexpectedEof.into()),
            length => take(&piece[..length])?,
        }
    }
    Ok(())
}
