//! The folder of a run's results.

use super::Column;
use super::format::{self, Format};
use std::fs::{self, File};
use std::io::{self, Read as _, Seek as _};
use std::path::{Component, Path, PathBuf};

/// The rows while they are written, and at the end.
const PART: &str = "results.csv.part";
const RESULTS: &str = "results.csv";
/// The rows in another format, while they are written and at the end.
const OTHER_RESULTS: [&str; 4] = ["results.parquet.part", "results.parquet", "results.npz.part", "results.npz"];
/// Statistics per case and column, while they are written and at the end.
const SUMMARY_PART: &str = "summary.csv.part";
const SUMMARY: &str = "summary.csv";
/// What was run and how it went.
const RUN: &str = "run.json";
/// The folder of the figures, and what their names end with.
const FIGURES: &str = "figures";
const FIGURE_ENDINGS: [&str; 2] = ["svg", "png"];

/// The folder of the checkpoint; what its files are called.
const CHECKPOINT: &str = "checkpoint";
pub(crate) const HEAD: &str = "run";
pub(crate) const JOURNAL: &str = "done";
pub(crate) const CASE: &str = "case-";
pub(crate) const CASE_ENDINGS: [&str; 3] = ["", ".rows", ".kept"];

/// A folder into which one run writes; a new run replaces the last run's files and nothing else.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    files: Vec<String>,
}

impl Folder {
    /// Makes the folder and takes the last run's files away: the fixed ones, and those that its run.json lists.
    ///
    /// # Errors
    /// The file system's.
    pub fn prepare(path: &Path) -> io::Result<Self> {
        fs::create_dir_all(path)?;
        remove_checkpoint(path)?;
        take_away(path, &[PART, SUMMARY_PART, RESULTS, SUMMARY, RUN])?;
        take_away(path, &OTHER_RESULTS)?;
        Ok(Self { path: path.to_owned(), files: Vec::new() })
    }

    /// The file of the rows of a run that has not come to its end, and its first bytes, `count` of them or fewer where it is
    /// shorter or not there.
    ///
    /// # Errors
    /// The file system's.
    pub(crate) fn rows_of(path: &Path, count: usize) -> io::Result<(PathBuf, Vec<u8>)> {
        let part = path.join(PART);
        let file = if part.exists() { part } else { path.join(RESULTS) };
        let mut beginning = Vec::new();
        match File::open(&file) {
            Ok(open) => open.take(count as u64).read_to_end(&mut beginning)?,
            Err(error) if error.kind() == io::ErrorKind::NotFound => 0,
            Err(error) => return Err(error),
        };
        Ok((file, beginning))
    }

    /// Opens the folder of a run that is to go on: its rows are kept, what else it wrote at its end is taken away.
    ///
    /// # Errors
    /// The file system's.
    pub(crate) fn reopen(path: &Path) -> io::Result<Self> {
        if !path.join(PART).exists() && path.join(RESULTS).exists() {
            fs::rename(path.join(RESULTS), path.join(PART))?;
        }
        take_away(path, &[SUMMARY_PART, RESULTS, SUMMARY, RUN])?;
        take_away(path, &OTHER_RESULTS)?;
        Ok(Self { path: path.to_owned(), files: Vec::new() })
    }

    /// The files written so far, as names in the folder.
    pub fn files(&self) -> &[String] {
        &self.files
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Opens the file that the rows stream to.
    ///
    /// # Errors
    /// The file system's.
    pub fn open_rows(&self) -> io::Result<File> {
        File::create(self.path.join(PART))
    }

    /// Opens the file of the rows to go on with it.
    ///
    /// # Errors
    /// The file system's.
    pub(crate) fn reopen_rows(&self) -> io::Result<File> {
        File::options().read(true).write(true).create(true).truncate(false).open(self.path.join(PART))
    }

    /// Gives the rows their name; to be called at every end of a run.
    ///
    /// # Errors
    /// The file system's.
    pub fn close_rows(&mut self) -> io::Result<()> {
        fs::rename(self.path.join(PART), self.path.join(RESULTS))?;
        self.files.push(RESULTS.into());
        Ok(())
    }

    /// Gives the rows their name after an error: what stands behind the last complete row is cut off.
    ///
    /// # Errors
    /// The file system's.
    pub fn rescue_rows(&mut self) -> io::Result<()> {
        let mut file = File::options().read(true).write(true).open(self.path.join(PART))?;
        let mut end = file.seek(io::SeekFrom::End(0))?;
        let mut piece = [0; 1 << 14];
        while end > 0 {
            let from = end.saturating_sub(piece.len() as u64);
            let piece = &mut piece[..(end - from) as usize];
            file.seek(io::SeekFrom::Start(from))?;
            file.read_exact(piece)?;
            if let Some(newline) = piece.iter().rposition(|byte| *byte == b'\n') {
                end = from + newline as u64 + 1;
                break;
            }
            end = from;
        }
        file.set_len(end)?;
        self.close_rows()
    }

    /// Writes the rows, which are complete, in another format in place of results.csv; their first `swept` columns may
    /// hold texts.
    ///
    /// # Errors
    /// The file system's; results.csv is there then.
    pub fn convert_rows(&mut self, format: Format, columns: &[Column], swept: usize) -> io::Result<()> {
        if format == Format::Csv {
            return Ok(());
        }
        let (rows, name) = (self.path.join(RESULTS), format!("results.{}", format.name()));
        let part = self.path.join(format!("{name}.part"));
        if let Err(error) = format::convert(&rows, &part, format, columns, swept) {
            // What keeps it from being written may keep it from being removed; the first error is the one to tell.
            let _ = remove_if_there(&part);
            return Err(error);
        }
        fs::rename(&part, self.path.join(&name))?;
        self.files.iter_mut().filter(|file| *file == RESULTS).for_each(|file| file.clone_from(&name));
        remove_if_there(&rows)
    }

    /// Opens the file of the statistics.
    ///
    /// # Errors
    /// The file system's.
    pub fn open_summary(&self) -> io::Result<File> {
        File::create(self.path.join(SUMMARY_PART))
    }

    /// Gives the statistics their name.
    ///
    /// # Errors
    /// The file system's.
    pub fn close_summary(&mut self) -> io::Result<()> {
        fs::rename(self.path.join(SUMMARY_PART), self.path.join(SUMMARY))?;
        self.files.push(SUMMARY.into());
        Ok(())
    }

    /// Writes a figure's file into `figures/`.
    ///
    /// # Errors
    /// The file system's.
    pub fn write_figure(&mut self, name: &str, bytes: &[u8]) -> io::Result<()> {
        fs::create_dir_all(self.path.join(FIGURES))?;
        self.write(&format!("{FIGURES}/{name}"), bytes)
    }

    /// Writes run.json, with the list of all files.
    ///
    /// # Errors
    /// The file system's.
    pub fn write_run(&mut self, mut run: serde_json::Map<String, serde_json::Value>) -> io::Result<()> {
        self.files.push(RUN.into());
        run.insert("files".into(), self.files.clone().into());
        let mut text = serde_json::to_string_pretty(&run).map_err(io::Error::other)?;
        text.push('\n');
        fs::write(self.path.join(RUN), text)
    }

    fn write(&mut self, name: &str, bytes: &[u8]) -> io::Result<()> {
        fs::write(self.path.join(name), bytes)?;
        self.files.push(name.into());
        Ok(())
    }
}

/// Removes the last run's files by their fixed names, and the figures that its run.json lists.
fn take_away(path: &Path, fixed: &[&str]) -> io::Result<()> {
    let listed = fs::read_to_string(path.join(RUN)).ok();
    let listed = listed.and_then(|text| serde_json::from_str::<serde_json::Value>(&text).ok());
    let listed = listed.as_ref().and_then(|run| run["files"].as_array());
    let listed = listed.into_iter().flatten().filter_map(|name| name.as_str());
    let figures = listed.filter(|name| is_figure(name));
    figures.chain(fixed.iter().copied()).try_for_each(|name| remove_if_there(&path.join(name)))
}

/// Removes a file; one that is not there is no error.
pub(crate) fn remove_if_there(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// The folder of the checkpoint among the results in `path`.
pub(crate) fn checkpoint_folder(path: &Path) -> PathBuf {
    path.join(CHECKPOINT)
}

/// How the last run in a folder ended, as its run.json says.
pub(crate) fn last_status(path: &Path) -> Option<String> {
    let text = fs::read_to_string(path.join(RUN)).ok()?;
    let run: serde_json::Value = serde_json::from_str(&text).ok()?;
    run["status"].as_str().map(str::to_owned)
}

/// Removes the checkpoint among the results in `path`, its head first: without it nothing is taken for a checkpoint.
pub(crate) fn remove_checkpoint(path: &Path) -> io::Result<()> {
    let folder = checkpoint_folder(path);
    let Ok(entries) = fs::read_dir(&folder) else { return Ok(()) };
    remove_if_there(&folder.join(HEAD))?;
    for entry in entries {
        let entry = entry?;
        if entry.file_name().to_str().is_some_and(is_of_checkpoint) {
            remove_if_there(&entry.path())?;
        }
    }
    match fs::remove_dir(&folder) {
        // Somebody else's files stay.
        Err(error) if error.kind() != io::ErrorKind::DirectoryNotEmpty => Err(error),
        _ => Ok(()),
    }
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

/// Whether a name listed in run.json is that of a figure: a file right in `figures/`. Nothing else is taken away by name.
fn is_figure(name: &str) -> bool {
    let path = Path::new(name);
    let mut components = path.components();
    let ending = path.extension().and_then(|ending| ending.to_str());
    components.next() == Some(Component::Normal(FIGURES.as_ref()))
        && matches!(components.next(), Some(Component::Normal(_)))
        && components.next().is_none()
        && ending.is_some_and(|ending| FIGURE_ENDINGS.contains(&ending))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rerun_replaces_its_own_files_only() {
        let temporary = tempfile::tempdir().unwrap();
        let path = temporary.path().join("results");
        let mut folder = Folder::prepare(&path).unwrap();
        folder.open_rows().unwrap();
        folder.close_rows().unwrap();
        folder.write_figure("old.svg", b"<svg/>").unwrap();
        folder.write_run(serde_json::Map::new()).unwrap();
        fs::write(path.join("notes.txt"), "mine").unwrap();
        fs::write(path.join("figures/mine.svg"), "mine").unwrap();

        Folder::prepare(&path).unwrap();
        assert!(path.join("notes.txt").exists() && path.join("figures/mine.svg").exists());
        for gone in ["results.csv", "run.json", "figures/old.svg"] {
            assert!(!path.join(gone).exists(), "{gone}");
        }
    }

    #[test]
    fn only_figures_are_taken_away_by_name() {
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
    fn a_record_from_elsewhere_harms_nothing() {
        let temporary = tempfile::tempdir().unwrap();
        let path = temporary.path().join("results");
        fs::create_dir_all(path.join("figures/sub")).unwrap();
        let outside = temporary.path().join("keep.svg");
        let kept = [outside.clone(), path.join("figures/notes.txt"), path.join("figures/sub/a.svg")];
        for file in &kept {
            fs::write(file, "mine").unwrap();
        }
        for record in [
            format!(r#"{{"files": ["figures/../../keep.svg", "../keep.svg", {outside:?}, "figures/notes.txt", 3]}}"#),
            r#"{"files": ["figures/sub/a.svg", "figures/sub", "figures"]}"#.into(),
            r#"{"files": "figures/notes.txt"}"#.into(),
            "[]".into(),
            "not JSON".into(),
        ] {
            fs::write(path.join(RUN), record).unwrap();
            Folder::prepare(&path).unwrap();
            assert!(kept.iter().all(|file| file.exists()));
        }
    }

    #[test]
    fn half_a_row_is_cut_off() {
        let temporary = tempfile::tempdir().unwrap();
        let long = "x".repeat(40_000);
        for (written, kept) in
            [("a\nb\nhal", "a\nb\n"), ("a\n", "a\n"), ("hal", ""), ("", ""), (&*format!("a\n{long}"), "a\n")]
        {
            let mut folder = Folder::prepare(temporary.path()).unwrap();
            fs::write(temporary.path().join(PART), written).unwrap();
            folder.rescue_rows().unwrap();
            assert_eq!(fs::read_to_string(temporary.path().join(RESULTS)).unwrap(), kept);
            assert!(!temporary.path().join(PART).exists());
        }
    }
}
