//! Results in other formats than CSV, written from the rows when a run has ended.
//!
//! While a run goes on its rows stream to a CSV file, which can be read, cut and gone on with at any time. Numbers
//! there are the shortest text that reads back to the same bits, so that what is made of it at the end has the same
//! bits too.

use super::disk::Disk;
use super::rows::Rows;
use super::{npz, parquet};
use serde::{Deserialize, Serialize};
use springpot::table::Column;
use std::io::{self, BufWriter, Write as _};
use std::path::Path;

/// Bytes that are written at a time.
const CHUNK: usize = 1 << 18;

/// The format of the rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    /// Comma-separated text; empty fields have no value.
    #[default]
    Csv,
    /// Apache Parquet: one optional column of doubles for each column, texts as UTF-8; null where there is no value.
    Parquet,
    /// NumPy's zipped arrays: one array for each column; NaN where there is no value.
    Npz,
}

impl Format {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Csv, Self::Parquet, Self::Npz];

    /// Its name, and the ending of its files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Parquet => "parquet",
            Self::Npz => "npz",
        }
    }

    /// The format of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|format| format.name() == name)
    }
}

/// Writes the rows of the CSV file `from`, whose first `swept` columns may hold texts, to `to`.
///
/// # Errors
/// The file system's; [`io::ErrorKind::InvalidData`] where the rows are not those of `columns`.
pub(super) fn convert(
    disk: &Disk,
    from: &Path,
    to: &Path,
    format: Format,
    columns: &[Column],
    swept: usize,
) -> io::Result<()> {
    let rows = Rows::survey(disk, from, columns, swept)?;
    let mut file = BufWriter::with_capacity(CHUNK, disk.create(to)?);
    match format {
        Format::Csv => {
            io::copy(&mut disk.open(from)?, &mut file)?;
        }
        Format::Parquet => parquet::write(&rows, &mut file)?,
        Format::Npz => npz::write(&rows, &mut file)?,
    }
    file.flush()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn what_is_no_table_of_a_run_is_refused() {
        let (folder, disk) = (tempfile::tempdir().unwrap(), Disk::default());
        let (from, to) = (folder.path().join("a.csv"), folder.path().join("b"));
        let columns = [Column::new("law", "", ""), Column::new("t", "s", "")];
        for format in [Format::Parquet, Format::Npz] {
            for (text, good) in [
                ("law,t\nspring,0\n\"a,b\",\n", true),
                ("law,t\n", true),
                ("law,t\nspring,zero\n", false),
                ("law,t\nspring,inf\n", false),
                ("law,t\nspring\n", false),
                ("law\nspring\n", false),
                ("law,t\nspr\"ing,0,1\n", false),
            ] {
                fs::write(&from, text).unwrap();
                let converted = convert(&disk, &from, &to, format, &columns, 1);
                assert_eq!(converted.is_ok(), good, "{format:?} {text:?} {converted:?}");
            }
            fs::write(&from, b"law,t\n\xff,0\n").unwrap();
            assert!(convert(&disk, &from, &to, format, &columns, 1).is_err());
        }
    }

    #[test]
    fn names() {
        assert!(Format::ALL.into_iter().all(|format| Format::named(format.name()) == Some(format)));
        assert_eq!(Format::named("xlsx"), None);
    }
}
