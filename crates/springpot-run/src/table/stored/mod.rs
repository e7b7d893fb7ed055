//! Rows of finished runs, read again in whatever format they are.

mod csv;
mod npz;
mod parquet;
mod thrift;

use super::disk::Disk;
use super::format::Format;
use std::io;
use std::path::{Path, PathBuf};

/// A file of rows.
#[derive(Debug)]
pub(crate) struct Stored {
    disk: Disk,
    file: PathBuf,
    format: Format,
    columns: Vec<String>,
}

/// Takes a row: its first fields as text of CSV, each with its comma, and the numbers that are wanted; NaN where there is none.
pub(crate) type Take<'a> = &'a mut dyn FnMut(&str, &[f64]) -> io::Result<()>;

/// What is wanted of each row.
#[derive(Debug, Clone, Copy)]
struct Wanted<'a> {
    /// So many of the first columns as text.
    lead: usize,
    /// Columns whose numbers are wanted, by their index.
    numbers: &'a [usize],
}

/// Values of a column over some rows.
#[derive(Debug)]
enum Values {
    Numbers(Vec<f64>),
    Texts(Vec<String>),
}

impl Stored {
    /// Opens a file whose name tells its format.
    ///
    /// # Errors
    /// The file system's; [`io::ErrorKind::InvalidData`] where it is none that a run wrote.
    pub(crate) fn open(disk: &Disk, file: &Path) -> io::Result<Self> {
        let ending = file.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
        let format = Format::named(ending)
            .ok_or_else(|| io::Error::new(io::ErrorKind::InvalidData, "neither .csv, .parquet nor .npz"))?;
        let columns = match format {
            Format::Csv => csv::columns(disk, file),
            Format::Parquet => parquet::Table::open(disk, file).map(|table| table.names()),
            Format::Npz => npz::Table::open(disk, file).map(|table| table.names()),
        };
        Ok(Self { disk: disk.clone(), file: file.to_owned(), format, columns: columns? })
    }

    /// The file.
    pub(crate) fn file(&self) -> &Path {
        &self.file
    }

    /// Names of the columns.
    pub(crate) fn columns(&self) -> &[String] {
        &self.columns
    }

    /// Calls `take` with every row.
    ///
    /// # Errors
    /// As [`Self::open`]; what `take` returns.
    pub(crate) fn visit(&self, lead: usize, numbers: &[usize], take: Take<'_>) -> io::Result<()> {
        let wanted = Wanted { lead, numbers };
        match self.format {
            Format::Csv => csv::visit(&self.disk, &self.file, wanted, take),
            Format::Parquet => parquet::Table::open(&self.disk, &self.file)?.visit(wanted, take),
            Format::Npz => npz::Table::open(&self.disk, &self.file)?.visit(wanted, take),
        }
    }
}

impl Wanted<'_> {
    /// Hands over rows whose wanted columns hold these values: first those of the lead, then the numbers.
    fn hand_over(self, columns: &[Values], rows: usize, take: Take<'_>) -> io::Result<()> {
        let (first, others) = columns.split_at(self.lead);
        let (mut lead, mut numbers) = (String::new(), Vec::with_capacity(others.len()));
        for row in 0..rows {
            lead.clear();
            for column in first {
                match column {
                    Values::Numbers(values) => super::push_number(&mut lead, *values.get(row).ok_or_else(damaged)?),
                    Values::Texts(texts) => super::push_text(&mut lead, texts.get(row).ok_or_else(damaged)?),
                }
                lead.push(',');
            }
            numbers.clear();
            for column in others {
                let Values::Numbers(values) = column else { return Err(damaged()) };
                numbers.push(*values.get(row).ok_or_else(damaged)?);
            }
            take(&lead, &numbers)?;
        }
        Ok(())
    }

    /// The wanted columns, by their index, as [`Self::hand_over`] takes them.
    fn indices(self) -> impl Iterator<Item = usize> {
        (0..self.lead).chain(self.numbers.iter().copied())
    }
}

fn damaged() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, "the rows are not those of a run")
}

#[cfg(test)]
mod tests {
    use super::super::format;
    use super::*;
    use springpot::table::Column;
    use std::fmt::Write as _;
    use std::fs;

    /// All that a file holds: leads, and numbers by their bits.
    fn rows(stored: &Stored, lead: usize, numbers: &[usize]) -> Vec<(String, Vec<u64>)> {
        let mut rows = Vec::new();
        let mut take = |lead: &str, numbers: &[f64]| {
            rows.push((lead.to_owned(), numbers.iter().map(|number| number.to_bits()).collect()));
            Ok(())
        };
        stored.visit(lead, numbers, &mut take).unwrap();
        rows
    }

    #[test]
    fn every_format_reads_back_to_the_same_bits() {
        let (folder, disk) = (tempfile::tempdir().unwrap(), Disk::default());
        let names = ["element.strut.law", "element.strut.alpha", "t", "strut.force", "q.q1"];
        let columns = names.map(|name| Column::new(name, "", ""));
        // More rows than one group of a parquet file holds.
        let mut text = format!("{}\n", names.join(","));
        for row in 0..230_000_u32 {
            let law = if row < 7 { "\"a, \"\"b\"\"\"" } else { "µ" };
            let force = if row % 3 == 0 { String::new() } else { format!("{}", f64::from(row).sqrt()) };
            writeln!(
                text,
                "{law},{},{},{force},{:e}",
                0.1 + f64::from(row / 100),
                f64::from(row) * 1e-3,
                -f64::from(row) * 1e-9
            )
            .unwrap();
        }
        let csv = folder.path().join("results.csv");
        fs::write(&csv, text).unwrap();
        let first = Stored::open(&disk, &csv).unwrap();
        assert_eq!(first.columns(), names);
        let expected = rows(&first, 2, &[2, 4, 3]);
        assert_eq!((expected.len(), &*expected[3].0), (230_000, "\"a, \"\"b\"\"\",0.1,"));
        assert!(f64::from_bits(expected[3].1[2]).is_nan() && f64::from_bits(expected[4].1[2]) == 2.0);
        for format in [Format::Parquet, Format::Npz] {
            let file = folder.path().join(format!("results.{}", format.name()));
            format::convert(&disk, &csv, &file, format, &columns, 2).unwrap();
            let stored = Stored::open(&disk, &file).unwrap();
            assert_eq!(stored.columns(), names, "{format:?}");
            assert!(rows(&stored, 2, &[2, 4, 3]) == expected, "{format:?}");
            assert!(rows(&stored, 0, &[3]).len() == 230_000);
            // Texts are no numbers.
            assert!(stored.visit(0, &[0], &mut |_, _| Ok(())).is_err());
        }
    }

    #[test]
    fn damaged_files_are_refused_and_none_brings_the_reader_down() {
        let (folder, disk) = (tempfile::tempdir().unwrap(), Disk::default());
        let columns = ["law", "t"].map(|name| Column::new(name, "", ""));
        let csv = folder.path().join("results.csv");
        fs::write(&csv, "law,t\nspring,0\n\"a,b\",1.5\n").unwrap();
        for format in [Format::Parquet, Format::Npz] {
            let file = folder.path().join(format!("a.{}", format.name()));
            format::convert(&disk, &csv, &file, format, &columns, 1).unwrap();
            let whole = fs::read(&file).unwrap();
            let read = || Stored::open(&disk, &file).and_then(|stored| stored.visit(1, &[1], &mut |_, _| Ok(())));
            assert!(read().is_ok());
            for length in 0..whole.len() {
                fs::write(&file, &whole[..length]).unwrap();
                let outcome = read();
                assert!(format == Format::Npz || outcome.is_err(), "{format:?} {length}");
            }
            for at in 0..whole.len() {
                for value in [0, 0x7f, 0x80, 0xff, whole[at] ^ 1] {
                    let mut bytes = whole.clone();
                    bytes[at] = value;
                    fs::write(&file, bytes).unwrap();
                    let _ = read();
                }
            }
        }
        for (text, good) in
            [("law,t\nspring,0\n", true), ("law,t\n", true), ("law,t\nspring,x\n", false), ("law,t\nspring\n", false)]
        {
            fs::write(&csv, text).unwrap();
            let read = Stored::open(&disk, &csv).and_then(|stored| stored.visit(1, &[1], &mut |_, _| Ok(())));
            assert_eq!(read.is_ok(), good, "{text:?}");
        }
        assert!(Stored::open(&disk, &folder.path().join("results.txt")).is_err());
    }
}
