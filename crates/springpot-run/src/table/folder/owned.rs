//! What in a folder of results was written by a run, and by which.

use crate::table::disk::{Disk, Entry};
use crate::table::sealed;
use serde::Deserialize;
use springpot_report::latex;
use springpot_report::page::MARK;
use std::io::{self, Read as _, Write as _};
use std::path::{Component, Path};

/// What pages are called among the results that they show.
pub const VIEW_PAGE: &str = "view.html";
/// As [`VIEW_PAGE`], of reports.
pub const REPORT_PAGE: &str = "report.html";
/// As [`VIEW_PAGE`], of what two results have to do with each other.
pub const COMPARISON_PAGE: &str = "comparison.html";
/// [`REPORT_PAGE`] and [`COMPARISON_PAGE`] as LaTeX documents.
pub const REPORT_LATEX: &str = "report.tex";
/// As [`REPORT_LATEX`].
pub const COMPARISON_LATEX: &str = "comparison.tex";

/// The folder of the pictures of a LaTeX document `stem`.tex, beside it.
pub fn latex_figures(stem: &str) -> String {
    format!("{stem}-figures")
}

/// The rows while they are written, and at the end.
pub(crate) const PART: &str = "results.csv.part";
pub(super) const RESULTS: &str = "results.csv";
/// Statistics per case and column.
pub(super) const SUMMARY: &str = "summary.csv";
/// Rows at events of forward runs.
pub(crate) const EVENTS: &str = "events.csv";
/// Metrics per case.
pub(crate) const METRICS: &str = "metrics.csv";
/// Derivatives of metrics per case.
pub(crate) const GRADIENT: &str = "gradient.csv";
/// Which parameters change which columns most, per case.
pub(crate) const RANKING: &str = "ranking.csv";
/// What was run and how it went.
pub(super) const RUN: &str = "run.json";
/// The folder of the figures, and what their names end with.
pub(super) const FIGURES: &str = "figures";
const FIGURE_ENDINGS: [&str; 3] = ["svg", "png", "pdf"];
/// Every other file that a run puts in place.
pub(super) const FIXED: [&str; 9] =
    [RESULTS, "results.parquet", "results.npz", SUMMARY, EVENTS, METRICS, GRADIENT, RANKING, RUN];

/// Bytes of a page within which its mark stands.
const PAGE_HEAD: u64 = 4_096;

/// The folder of what is not yet in its place, and the file in it that says what else belongs to the run.
pub(crate) const UNFINISHED: &str = ".unfinished";
const CLAIMS: &str = "run";
/// What is known of a run under way, in the same folder.
pub(crate) const RUNNING: &str = "running.json";
const CLAIMS_TAG: &str = "springpot run\n";
/// The file that makes a run's files the valid ones.
pub(super) const COMMIT: &str = "commit";

/// The folder of the checkpoint; what its files are called.
const CHECKPOINT: &str = "checkpoint";
pub(crate) const HEAD: &str = "run";
pub(crate) const JOURNAL: &str = "done";
pub(crate) const CASE: &str = "case-";
pub(crate) const CASE_ENDINGS: [&str; 3] = ["", ".rows", ".kept"];

/// What run.json says that matters to those who come after.
#[derive(Debug, Deserialize)]
pub(super) struct Record {
    #[serde(default)]
    pub(super) status: String,
    pub(super) files: Vec<String>,
    #[expect(dead_code, reason = "without it the record is none of ours")]
    versions: Versions,
}

#[derive(Debug, Deserialize)]
struct Versions {
    #[expect(dead_code, reason = "as above")]
    springpot: String,
}

/// Takes away the pages of earlier results, and documents with their pictures: those that bear the mark of ours.
pub(super) fn remove_pages(disk: &Disk, folder: &Path) -> io::Result<()> {
    let remove = |name: &str, mark: &str| -> io::Result<bool> {
        let path = folder.join(name);
        if !matches!(disk.look(&path)?, Some(Entry::File(_))) {
            return Ok(false);
        }
        let mut beginning = Vec::new();
        disk.open(&path)?.take(PAGE_HEAD).read_to_end(&mut beginning)?;
        let is_ours = String::from_utf8_lossy(&beginning).contains(mark);
        if is_ours {
            disk.remove(&path)?;
        }
        Ok(is_ours)
    };
    for name in [VIEW_PAGE, REPORT_PAGE, COMPARISON_PAGE] {
        remove(name, MARK)?;
    }
    for name in [REPORT_LATEX, COMPARISON_LATEX] {
        if remove(name, latex::MARK)? {
            let figures = folder.join(latex_figures(name.trim_end_matches(".tex")));
            if disk.look(&figures)? != Some(Entry::Folder) {
                continue;
            }
            for name in disk.list(&figures)?.iter().filter(|name| is_picture(name)) {
                disk.remove(&figures.join(name))?;
            }
            disk.remove_folder(&figures)?;
        }
    }
    Ok(())
}

/// Whether a file beside a document is one of its pictures, `figure-3.pdf`.
fn is_picture(name: &str) -> bool {
    let number = name.strip_prefix("figure-").and_then(|name| name.split_once('.'));
    number.is_some_and(|(number, ending)| {
        FIGURE_ENDINGS.contains(&ending) && !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit())
    })
}

/// The record of the last run; `None` where there is none, or something else of that name.
pub(super) fn record(disk: &Disk, folder: &Path) -> io::Result<Option<Record>> {
    let path = folder.join(RUN);
    if !matches!(disk.look(&path)?, Some(Entry::File(_))) {
        return Ok(None);
    }
    let record: Option<Record> = serde_json::from_slice(&disk.read(&path)?).ok();
    Ok(record.filter(|record| record.files.iter().any(|file| file == RUN)))
}

/// The files of the last run, of those that a run writes.
pub(super) fn listed(disk: &Disk, folder: &Path) -> io::Result<Vec<String>> {
    let files = record(disk, folder)?.map_or(Vec::new(), |record| record.files);
    Ok(files.into_iter().filter(|file| FIXED.contains(&&**file) || is_figure(file)).collect())
}

/// Whether a name is that of a figure: a file right in `figures/`.
pub(super) fn is_figure(name: &str) -> bool {
    let path = Path::new(name);
    let mut components = path.components();
    let ending = path.extension().and_then(|ending| ending.to_str());
    components.next() == Some(Component::Normal(FIGURES.as_ref()))
        && matches!(components.next(), Some(Component::Normal(_)))
        && components.next().is_none()
        && ending.is_some_and(|ending| FIGURE_ENDINGS.contains(&ending))
}

/// What a run that did not come to its end says to be its own, beside what is in `.unfinished`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Claims {
    pub(super) rows: bool,
    pub(super) checkpoint: bool,
}

impl Claims {
    /// What is claimed in a folder; nothing where no run says so.
    pub(super) fn read(disk: &Disk, folder: &Path) -> io::Result<Self> {
        let path = folder.join(UNFINISHED).join(CLAIMS);
        if disk.look(&path)?.is_none() {
            return Ok(Self::default());
        }
        let text = String::from_utf8_lossy(&disk.read(&path)?).into_owned();
        // Half a line claims nothing: what it names was not begun.
        let whole =
            text.strip_prefix(CLAIMS_TAG).and_then(|text| text.rsplit_once('\n')).map_or("", |(lines, _)| lines);
        let has = |name: &str| whole.lines().any(|line| line == name);
        Ok(Self { rows: has(PART), checkpoint: has(CHECKPOINT) })
    }

    /// Writes them down, safe from the loss of power, before anything of them is there.
    pub(super) fn write(self, disk: &Disk, folder: &Path) -> io::Result<()> {
        let unfinished = folder.join(UNFINISHED);
        disk.create_folder(&unfinished)?;
        let mut text = CLAIMS_TAG.to_owned();
        for (claimed, name) in [(self.rows, PART), (self.checkpoint, CHECKPOINT)] {
            if claimed {
                text.push_str(name);
                text.push('\n');
            }
        }
        let mut file = disk.create(&unfinished.join(CLAIMS))?;
        file.write_all(text.as_bytes())?;
        file.sync()?;
        disk.sync_folder(&unfinished)?;
        disk.sync_folder(folder)
    }
}

/// Whether `.unfinished` is there and not a run's: what a run writes into it comes after its claims.
pub(super) fn is_foreign_unfinished(disk: &Disk, folder: &Path) -> io::Result<bool> {
    let path = folder.join(UNFINISHED);
    Ok(match disk.look(&path)? {
        None => false,
        Some(Entry::Folder) => {
            let names = disk.list(&path)?;
            !names.is_empty() && !names.iter().any(|name| name == CLAIMS || name == COMMIT)
        }
        Some(_) => true,
    })
}

/// Takes away what is not yet in its place, the claims last.
pub(super) fn clear_unfinished(disk: &Disk, folder: &Path) -> io::Result<()> {
    let path = folder.join(UNFINISHED);
    if disk.look(&path)? != Some(Entry::Folder) {
        return Ok(());
    }
    let figures = path.join(FIGURES);
    for name in disk.list(&figures)? {
        disk.remove(&figures.join(name))?;
    }
    disk.remove_folder(&figures)?;
    for name in disk.list(&path)? {
        let plain = name.strip_suffix(".new").unwrap_or(&name);
        if FIXED.contains(&plain) || [COMMIT, RUNNING].contains(&plain) {
            disk.remove(&path.join(name))?;
        }
    }
    disk.remove(&path.join(CLAIMS))?;
    disk.remove_folder(&path)
}

/// The folder of the checkpoint among the results in `folder`.
pub(crate) fn checkpoint_folder(folder: &Path) -> std::path::PathBuf {
    folder.join(CHECKPOINT)
}

/// Whose the checkpoint in a folder is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Checkpoint {
    /// There is none.
    None,
    /// A run wrote it.
    Ours,
    /// Something else has its names.
    Foreign,
}

impl Checkpoint {
    pub(super) fn of(disk: &Disk, folder: &Path, claims: Claims) -> io::Result<Self> {
        let path = checkpoint_folder(folder);
        match disk.look(&path)? {
            None => return Ok(Self::None),
            Some(Entry::Folder) => {}
            Some(_) => return Ok(Self::Foreign),
        }
        let names = disk.list(&path)?;
        if !names.iter().any(|name| is_of_checkpoint(name)) {
            return Ok(Self::None);
        }
        if claims.checkpoint {
            return Ok(Self::Ours);
        }
        let mut beginning = Vec::new();
        if matches!(disk.look(&path.join(HEAD))?, Some(Entry::File(_))) {
            disk.open(&path.join(HEAD))?.take(200).read_to_end(&mut beginning)?;
        }
        Ok(if sealed::first_line(&beginning).is_some() { Self::Ours } else { Self::Foreign })
    }
}

/// Removes the checkpoint among the results in `folder`, its head first: without it nothing is taken for a checkpoint.
pub(super) fn remove_checkpoint(disk: &Disk, folder: &Path) -> io::Result<()> {
    let path = checkpoint_folder(folder);
    let names = disk.list(&path)?;
    if names.is_empty() && disk.look(&path)?.is_none() {
        return Ok(());
    }
    disk.remove(&path.join(HEAD))?;
    for name in names.iter().filter(|name| is_of_checkpoint(name)) {
        disk.remove(&path.join(name))?;
    }
    // Somebody else's files stay.
    disk.remove_folder(&path)
}

/// Whether a file in the folder of the checkpoint is one of its own.
fn is_of_checkpoint(name: &str) -> bool {
    let name = name.strip_suffix(".new").unwrap_or(name);
    let of_case = |name: &str| {
        let mut ends = CASE_ENDINGS.iter().filter_map(|ending| name.strip_suffix(ending));
        ends.any(|digits| !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit()))
    };
    [HEAD, JOURNAL].contains(&name) || name.strip_prefix(CASE).is_some_and(of_case)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_figures_count_by_their_names() {
        for good in ["figures/order.svg", "figures/a.b.png", "figures/figure-1.svg"] {
            assert!(is_figure(good), "{good}");
        }
        for bad in [
            "figures",
            "figures/",
            "figures/notes.txt",
            "figures/.svg",
            "figures/../a.svg",
            "figures/sub/a.svg",
            "figures/../../a.svg",
            "../figures/a.svg",
            "/figures/a.svg",
            "/etc/a.svg",
            "./figures/a.svg",
            "a.svg",
            "",
        ] {
            assert!(!is_figure(bad), "{bad}");
        }
    }

    #[test]
    fn names_of_a_checkpoint() {
        for own in ["run", "done", "case-0", "case-12.rows", "case-7.kept", "run.new", "case-3.new"] {
            assert!(is_of_checkpoint(own), "{own}");
        }
        for other in ["", "runs", "case-", "case-a", "case-1.txt", "notes", "case-1.rows.bak"] {
            assert!(!is_of_checkpoint(other), "{other}");
        }
    }

    #[test]
    fn claims_are_read_as_written_and_halves_claim_nothing() {
        let (folder, disk) = (tempfile::tempdir().unwrap(), Disk::default());
        let file = folder.path().join(UNFINISHED).join(CLAIMS);
        assert_eq!(Claims::read(&disk, folder.path()).unwrap(), Claims::default());
        let all = Claims { rows: true, checkpoint: true };
        for claims in [Claims::default(), Claims { rows: true, checkpoint: false }, all] {
            claims.write(&disk, folder.path()).unwrap();
            assert_eq!(Claims::read(&disk, folder.path()).unwrap(), claims);
        }
        let whole = std::fs::read(&file).unwrap();
        for length in 0..whole.len() {
            std::fs::write(&file, &whole[..length]).unwrap();
            let read = Claims::read(&disk, folder.path()).unwrap();
            assert!(!read.checkpoint && read.rows == (length > CLAIMS_TAG.len() + PART.len()), "{length}");
        }
    }
}
