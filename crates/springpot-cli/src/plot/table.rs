//! The rows of a run, and what run.json says of them.

use super::Refused;
use crate::{diagnostic, plain};
use csv::{ByteRecord, Reader};
use serde_json::Value;
use springpot::table::Column;
use springpot_run::table::push_number;
use springpot_scenario::RangeEnd;
use springpot_scenario::units::Unit;
use std::collections::HashMap;
use std::fs::{self, File};
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// Bytes that are read at a time.
const CHUNK: usize = 1 << 18;

/// Takes a row, its line in the file, and the index of the value that each sweep has there.
pub(super) type Visit<'a> = &'a mut dyn FnMut(&ByteRecord, u64, &[usize]) -> Result<(), Refused>;

/// A table of results that has been opened; its rows are read when they are asked for.
pub(super) struct Table {
    file: PathBuf,
    pub(super) folder: PathBuf,
    pub(super) columns: Vec<Column>,
    pub(super) sweeps: Vec<Sweep>,
    /// Files that the run lists as its own.
    pub(super) drawn: Vec<String>,
}

/// A row of metrics.csv.
#[derive(Debug, Clone)]
pub(super) struct MetricRow {
    /// Swept values as in the file.
    pub(super) swept: Vec<Vec<u8>>,
    pub(super) name: String,
    /// NaN: none.
    pub(super) value: f64,
    pub(super) unit: String,
}

/// One sweep: parameters that move together.
#[derive(Debug, Clone, Default)]
pub(super) struct Sweep {
    pub(super) parameters: Vec<String>,
    /// Their values as written; as the rows have them where run.json says nothing.
    pub(super) labels: Vec<String>,
    /// Index of a value by its fields in a row.
    by_fields: HashMap<Vec<u8>, usize>,
}

impl Table {
    pub(super) fn open(results: &Path) -> Result<Self, Refused> {
        let (file, folder) = if results.is_dir() {
            (rows_in(results)?, results.to_owned())
        } else {
            (results.to_owned(), results.parent().unwrap_or(Path::new("")).to_owned())
        };
        let mut reader = reader(&file)?;
        let header = reader.headers().map_err(|error| unreadable(&file, &error))?;
        let names: Vec<String> = header.iter().map(str::to_owned).collect();
        if names.is_empty() || names.iter().all(String::is_empty) {
            return Err(Refused::new(format!("{} has no columns", file.display()), None));
        }
        let record = folder.join("run.json");
        let run = record.is_file().then(|| fs::read_to_string(record).ok()).flatten();
        if run.is_none() {
            let message = format!("there is no run.json beside {}: the labels have no units", file.display());
            diagnostic::warning(message, None);
        }
        let run: Value = run.and_then(|text| serde_json::from_str(&text).ok()).unwrap_or_default();
        let described = run["columns"].as_array().map_or(&[][..], Vec::as_slice);
        let columns = names.iter().map(|name| {
            let found = described.iter().find(|column| column["name"] == name.as_str());
            let word = |key: &str| found.and_then(|column| column[key].as_str()).unwrap_or_default();
            Column::new(name, word("unit"), word("meaning"))
        });
        let columns: Vec<Column> = columns.collect();
        let sweeps: Vec<Sweep> = run["sweeps"].as_array().into_iter().flatten().map(Sweep::of).collect();
        let swept = sweeps.iter().flat_map(|sweep| &sweep.parameters);
        // A file beside another run's record has no sweeps that are known.
        let belongs = swept.clone().count() <= names.len() && swept.eq(names.iter().take(swept_count(&sweeps)));
        let drawn = run["files"].as_array().into_iter().flatten().filter_map(Value::as_str).map(str::to_owned);
        Ok(Self { file, folder, columns, sweeps: if belongs { sweeps } else { Vec::new() }, drawn: drawn.collect() })
    }

    /// What the results are called.
    pub(super) fn name(&self) -> String {
        let folder = self.folder.file_name().or_else(|| self.file.file_stem()).unwrap_or_default();
        folder.to_string_lossy().into_owned()
    }

    /// Calls `visit` with every row; returns the sweeps with the values that run.json does not list.
    pub(super) fn visit(&self, visit: Visit<'_>) -> Result<Vec<Sweep>, Refused> {
        let mut sweeps = self.sweeps.clone();
        let mut reader = reader(&self.file)?;
        let mut record = ByteRecord::new();
        let (mut lead, mut position): (Vec<Vec<u8>>, Vec<usize>) = (Vec::new(), vec![0; self.sweeps.len()]);
        let swept = swept_count(&self.sweeps);
        while reader.read_byte_record(&mut record).map_err(|error| unreadable(&self.file, &error))? {
            if swept > 0 && (lead.is_empty() || !lead.iter().eq(record.iter().take(swept))) {
                lead = record.iter().take(swept).map(<[u8]>::to_vec).collect();
                let mut fields = &lead[..];
                for (sweep, at) in sweeps.iter_mut().zip(&mut position) {
                    let (own, rest) = fields.split_at(sweep.parameters.len());
                    (*at, fields) = (sweep.index(own), rest);
                }
            }
            visit(&record, record.position().map_or(0, csv::Position::line), &position)?;
        }
        Ok(sweeps)
    }

    /// The rows of metrics.csv.
    pub(super) fn metrics(&self) -> Result<Vec<MetricRow>, Refused> {
        let file = self.folder.join("metrics.csv");
        if !file.is_file() {
            let help = "springpot metrics works them out, or name them in the scenario: [[metric]]".to_owned();
            return Err(Refused::new(format!("{} holds no metrics.csv", self.folder.display()), help));
        }
        let swept = swept_count(&self.sweeps);
        let mut rows = Vec::new();
        for record in reader(&file)?.byte_records() {
            let record = record.map_err(|error| unreadable(&file, &error))?;
            let text = |k: usize| String::from_utf8_lossy(record.get(swept + k).unwrap_or_default()).into_owned();
            let fields = record.iter().take(swept).map(<[u8]>::to_vec).collect();
            // A metric without a value is a gap.
            rows.push(MetricRow {
                swept: fields,
                name: text(0),
                value: text(2).parse().unwrap_or(f64::NAN),
                unit: text(3),
            });
        }
        Ok(rows)
    }

    /// Index of the value that each of `sweeps` has in these fields.
    pub(super) fn position(&self, sweeps: &mut [Sweep], mut fields: &[Vec<u8>]) -> Vec<usize> {
        let mut own = |sweep: &mut Sweep| {
            let (own, rest) = fields.split_at(sweep.parameters.len().min(fields.len()));
            fields = rest;
            sweep.index(own)
        };
        sweeps.iter_mut().map(&mut own).collect()
    }

    /// The number in a field of a row; NaN where it is empty.
    pub(super) fn number(&self, record: &ByteRecord, column: usize, line: u64) -> Result<f64, Refused> {
        let field = record.get(column).unwrap_or_default();
        let text = std::str::from_utf8(field).unwrap_or("?");
        let value = if text.is_empty() { Some(f64::NAN) } else { text.parse().ok() };
        value.ok_or_else(|| {
            let (file, name, field) = (self.file.display(), &self.columns[column].name, plain::field(field));
            Refused::new(format!("{file}:{line}: {field} in column {name:?} is not a number"), None)
        })
    }
}

fn swept_count(sweeps: &[Sweep]) -> usize {
    sweeps.iter().map(|sweep| sweep.parameters.len()).sum()
}

impl Sweep {
    /// As run.json has it.
    fn of(value: &Value) -> Self {
        let texts = |key: &str| -> Vec<String> {
            value[key].as_array().into_iter().flatten().filter_map(Value::as_str).map(str::to_owned).collect()
        };
        let mut sweep = Self { parameters: texts("parameters"), labels: texts("labels"), ..Self::default() };
        for (k, values) in value["values"].as_array().into_iter().flatten().enumerate() {
            let fields: Vec<Vec<u8>> = values.as_array().into_iter().flatten().map(field).collect();
            // Values that look alike in the rows cannot be told apart; the first stands for all.
            sweep.by_fields.entry(fields.join(&b'\n')).or_insert(k);
        }
        sweep
    }

    /// The label of the value that is meant by a text: one as written, or a number or quantity that has the value of the rows.
    pub(super) fn find(&self, value: &str) -> Option<&String> {
        if let Some(label) = self.labels.iter().find(|label| *label == value) {
            return Some(label);
        }
        let wanted = RangeEnd::parse(value).ok()?;
        let unit = wanted.unit.as_ref().map(|unit| Unit::parse(unit, &|_| None)).transpose().ok()?;
        let same = |number: f64, other: f64| (number - other).abs() <= 1e-12 * other.abs();
        if unit.is_none()
            && let Some(label) =
                self.labels.iter().find(|label| label.parse().is_ok_and(|label| same(label, wanted.number)))
        {
            return Some(label);
        }
        let si = unit.map_or(wanted.number, |unit| unit.to_si(wanted.number));
        let mut rows = self.by_fields.iter().filter(|(field, _)| {
            std::str::from_utf8(field).ok().and_then(|field| field.parse().ok()).is_some_and(|number| same(number, si))
        });
        rows.next().and_then(|(_, k)| self.labels.get(*k))
    }

    /// Index of the value of these fields, which is listed where it is not known.
    pub(super) fn index(&mut self, fields: &[Vec<u8>]) -> usize {
        let key = fields.join(&b'\n');
        if let Some(index) = self.by_fields.get(&key) {
            return *index;
        }
        let shown: Vec<_> = fields.iter().map(|field| String::from_utf8_lossy(field)).collect();
        self.labels.push(shown.join(", "));
        self.by_fields.insert(key, self.labels.len() - 1);
        self.labels.len() - 1
    }
}

/// A swept value as the rows have it.
fn field(value: &Value) -> Vec<u8> {
    let mut text = String::new();
    match value {
        Value::String(written) => text.push_str(written),
        value => push_number(&mut text, value.as_f64().unwrap_or(f64::NAN)),
    }
    text.into_bytes()
}

fn rows_in(folder: &Path) -> Result<PathBuf, Refused> {
    let names = ["results.csv", "results.csv.part"];
    if let Some(found) = names.map(|name| folder.join(name)).into_iter().find(|file| file.is_file()) {
        return Ok(found);
    }
    let other = ["results.parquet", "results.npz"].into_iter().find(|name| folder.join(name).is_file());
    Err(match other {
        Some(name) => Refused::new(
            format!("{} holds {name}, and plot reads CSV", folder.display()),
            "run the scenario again with --format csv".to_owned(),
        ),
        None => Refused::new(
            format!("{} holds no results.csv", folder.display()),
            "name the folder of the results of a run, such as results/arm".to_owned(),
        ),
    })
}

fn reader(file: &Path) -> Result<Reader<BufReader<File>>, Refused> {
    let refused = |why: String| {
        let help = "name the folder of the results of a run, such as results/arm, or its results.csv".to_owned();
        Refused::new(format!("{} cannot be opened: {why}", file.display()), help)
    };
    // The rows are read twice, and opening a pipe would wait for its other end.
    if !fs::metadata(file).map_err(|error| refused(error.to_string()))?.is_file() {
        return Err(refused("not a regular file".to_owned()));
    }
    let open = File::open(file).map_err(|error| refused(error.to_string()))?;
    Ok(Reader::from_reader(BufReader::with_capacity(CHUNK, open)))
}

fn unreadable(file: &Path, error: &csv::Error) -> Refused {
    let line = error.position().map_or_else(String::new, |position| format!(":{}", position.line()));
    let what = match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("{len} fields where the header has {expected_len}")
        }
        csv::ErrorKind::Utf8 { .. } => "not UTF-8".to_owned(),
        _ => error.to_string(),
    };
    Refused::new(format!("{}{line}: {what}", file.display()), None)
}
