//! The folder of a run's results.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

/// The rows while they are written, and at the end.
const PART: &str = "results.csv.part";
const RESULTS: &str = "results.csv";
/// Statistics per case and column.
const SUMMARY: &str = "summary.csv";
/// What was run and how it went.
const RUN: &str = "run.json";

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
        // Only figures are listed by name; nothing outside the folder is ever touched.
        let figures = listed.filter(|name| name.starts_with("figures/") && !name.contains(".."));
        for name in figures.chain([PART, RESULTS, SUMMARY, RUN]) {
            match fs::remove_file(path.join(name)) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
                _ => {}
            }
        }
        Ok(Self { path: path.to_owned(), files: Vec::new() })
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

    /// Opens the file of the statistics.
    ///
    /// # Errors
    /// The file system's.
    pub fn open_summary(&self) -> io::Result<File> {
        File::create(self.path.join(SUMMARY))
    }

    /// Lists the statistics among the run's files.
    pub fn close_summary(&mut self) {
        self.files.push(SUMMARY.into());
    }

    /// Writes a figure's file into `figures/`.
    ///
    /// # Errors
    /// The file system's.
    pub fn write_figure(&mut self, name: &str, bytes: &[u8]) -> io::Result<()> {
        fs::create_dir_all(self.path.join("figures"))?;
        self.write(&format!("figures/{name}"), bytes)
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
}
