//! The folder of a run's results.

use std::fs::{self, File};
use std::io::{self, Read as _, Seek as _};
use std::path::{Component, Path, PathBuf};

/// The rows while they are written, and at the end.
const PART: &str = "results.csv.part";
const RESULTS: &str = "results.csv";
/// Statistics per case and column, while they are written and at the end.
const SUMMARY_PART: &str = "summary.csv.part";
const SUMMARY: &str = "summary.csv";
/// What was run and how it went.
const RUN: &str = "run.json";
/// The folder of the figures, and what their names end with.
const FIGURES: &str = "figures";
const FIGURE_ENDINGS: [&str; 2] = ["svg", "png"];

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
        let listed = fs::read_to_string(path.join(RUN)).ok();
        let listed = listed.and_then(|text| serde_json::from_str::<serde_json::Value>(&text).ok());
        let listed = listed.as_ref().and_then(|run| run["files"].as_array());
        let listed = listed.into_iter().flatten().filter_map(|name| name.as_str());
        let figures = listed.filter(|name| is_figure(name));
        for name in figures.chain([PART, SUMMARY_PART, RESULTS, SUMMARY, RUN]) {
            match fs::remove_file(path.join(name)) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
                _ => {}
            }
        }
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
