//! The rows of a run, and what run.json says of them.

use super::NotDrawn;
use crate::metrics::is_within;
use crate::results::of_other_version;
use crate::table::{cut_field, matches, push_number};
use crate::warning::Warn;
use ::csv::{ByteRecord, Reader};
use serde_json::Value;
use springpot::table::Column;
use springpot_scenario::units::Unit;
use springpot_scenario::{RangeEnd, csv};
use std::collections::HashMap;
use std::fs::{self, File};
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// Bytes that are read at a time.
const CHUNK: usize = 1 << 18;

/// Takes a row, its line in the file, and the index of the value that each sweep has there.
type Visit<'a> = &'a mut dyn FnMut(&ByteRecord, u64, &[usize]) -> Result<(), NotDrawn>;

/// A table of results that has been opened; its rows are read when they are asked for.
pub(super) struct Table {
    file: PathBuf,
    pub(super) folder: PathBuf,
    pub(super) columns: Vec<Column>,
    pub(super) sweeps: Vec<Sweep>,
    /// Files that the run lists as its own.
    pub(super) drawn: Vec<String>,
    /// Whether it is no run's: what was measured, beside a run.
    pub(super) is_measured: bool,
    /// By column, how its numbers become SI, where its heading has a unit.
    units: Vec<Option<Unit>>,
}

/// What is read of the rows of a table.
pub(super) struct Reading<'a> {
    /// Columns whose numbers are taken.
    pub(super) columns: &'a [usize],
    /// For each sweep the value that is chosen.
    pub(super) chosen: &'a [Option<String>],
    /// Rows with t in between, where there is such a column.
    pub(super) window: Option<[f64; 2]>,
}

/// A case: the index of the value that each sweep has there, and what is kept of its rows.
pub(super) struct Case<K> {
    pub(super) position: Vec<usize>,
    pub(super) kept: K,
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
    /// Their values by name or as written; as the rows have them where run.json says nothing.
    pub(super) labels: Vec<String>,
    /// Whether these are names.
    pub(super) are_names: bool,
    /// By value, each parameter as written, where labels do not say it.
    written: Vec<Vec<String>>,
    /// Index of a value by its fields in a row.
    by_fields: HashMap<Vec<u8>, usize>,
}

impl Table {
    /// A table of a run, or, `beside` one, of anybody.
    pub(super) fn open(at: &Path, beside: bool, warn: Warn<'_>) -> Result<Self, NotDrawn> {
        if at.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml")) && at.is_file() {
            let (file, stem) = (at.display(), at.file_stem().unwrap_or_default().to_string_lossy());
            let help = format!(
                "run it first, `springpot run {file}`, and name its results: springpot plot results/{stem} COLUMN"
            );
            return Err(NotDrawn::new(format!("{file} is a scenario, and plot draws the results of a run"), help));
        }
        let (file, folder) = if at.is_dir() {
            (rows_in(at)?, at.to_owned())
        } else {
            (at.to_owned(), at.parent().unwrap_or(Path::new("")).to_owned())
        };
        let mut reader = reader(&file)?;
        let header = reader.headers().map_err(|error| unreadable(&file, &error))?;
        let names: Vec<String> = header.iter().map(str::to_owned).collect();
        if names.is_empty() || names.iter().all(String::is_empty) {
            return Err(NotDrawn::new(format!("{} has no columns", file.display()), None));
        }
        let record = folder.join("run.json");
        let run = record.is_file().then(|| fs::read_to_string(record).ok()).flatten();
        let is_measured = beside && run.is_none();
        if run.is_none() && !beside {
            let message = format!("there is no run.json beside {}: the labels have no units", file.display());
            warn(message.into());
        }
        let run: Value = run.and_then(|text| serde_json::from_str(&text).ok()).unwrap_or_default();
        let version = run["versions"]["springpot"].as_str().unwrap_or_default();
        of_other_version(&folder, version).into_iter().for_each(&mut *warn);
        let described = run["columns"].as_array().map_or(&[][..], Vec::as_slice);
        let headings: Vec<(&str, Option<Unit>)> = names.iter().map(|name| heading(name, is_measured)).collect();
        let columns = headings.iter().map(|(name, own)| {
            if let Some(own) = own {
                let unit = if own.dimension().is_none() { String::new() } else { own.dimension().to_string() };
                return Column::new(*name, unit.as_str(), "");
            }
            let found = described.iter().find(|column| column["name"] == *name);
            let word = |key: &str| found.and_then(|column| column[key].as_str()).unwrap_or_default();
            Column::new(*name, word("unit"), word("meaning"))
        });
        let columns: Vec<Column> = columns.collect();
        let sweeps: Vec<Sweep> = run["sweeps"].as_array().into_iter().flatten().map(Sweep::of).collect();
        let swept = sweeps.iter().flat_map(|sweep| &sweep.parameters);
        // A file beside another run's record has no sweeps that are known.
        let belongs = swept.clone().count() <= names.len() && swept.eq(names.iter().take(swept_count(&sweeps)));
        let drawn = run["files"].as_array().into_iter().flatten().filter_map(Value::as_str).map(str::to_owned);
        let (sweeps, drawn) = (if belongs { sweeps } else { Vec::new() }, drawn.collect());
        let units = headings.into_iter().map(|(_, unit)| unit).collect();
        Ok(Self { file, folder, columns, sweeps, drawn, is_measured, units })
    }

    /// Whether a glob means the column `k`: by its name, of a measured one with or without its unit.
    pub(super) fn is_called(&self, k: usize, glob: &str) -> bool {
        matches(glob, &self.columns[k].name) || self.is_measured && heading(glob, true).0 == self.columns[k].name
    }

    /// What the results are called.
    pub(super) fn name(&self) -> String {
        let folder = match self.is_measured {
            true => self.file.file_stem(),
            false => self.folder.file_name().or_else(|| self.file.file_stem()),
        };
        let folder = folder.unwrap_or_default();
        folder.to_string_lossy().into_owned()
    }

    /// Calls `visit` with every row; returns the sweeps with the values that run.json does not list.
    fn visit(&self, visit: Visit<'_>) -> Result<Vec<Sweep>, NotDrawn> {
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
            visit(&record, record.position().map_or(0, ::csv::Position::line), &position)?;
        }
        Ok(sweeps)
    }

    /// What is kept of every case that is chosen, in the order of the rows; and the sweeps as [`Self::visit`] returns them. `begin` is
    /// asked at the first row of a case, `add` takes the numbers of a row.
    pub(super) fn cases<K>(
        &self,
        Reading { columns, chosen, window }: Reading<'_>,
        mut begin: impl FnMut(&ByteRecord, u64, &[usize]) -> Result<K, NotDrawn>,
        add: impl Fn(&mut K, &[f64]),
    ) -> Result<(Vec<Case<K>>, Vec<Sweep>), NotDrawn> {
        let window = window.zip(self.columns.iter().position(|column| column.name == "t"));
        let mut numbers = Vec::with_capacity(columns.len());
        let mut cases: Vec<Case<K>> = Vec::new();
        let sweeps = self.visit(&mut |record, line, position| {
            if cases.last().is_none_or(|case| case.position != position) {
                let mut values = chosen.iter().zip(position).zip(&self.sweeps);
                let is_chosen = values.all(|((chosen, &at), sweep)| {
                    chosen.as_ref().is_none_or(|chosen| sweep.labels.get(at) == Some(chosen))
                });
                if !is_chosen {
                    return Ok(());
                }
                cases.push(Case { position: position.to_vec(), kept: begin(record, line, position)? });
            }
            if let Some((window, t)) = window
                && !is_within(window, self.number(record, t, line)?)
            {
                return Ok(());
            }
            numbers.clear();
            for &column in columns {
                numbers.push(self.number(record, column, line)?);
            }
            if let Some(case) = cases.last_mut() {
                add(&mut case.kept, &numbers);
            }
            Ok(())
        })?;
        Ok((cases, sweeps))
    }

    /// The rows of metrics.csv.
    pub(super) fn metrics(&self) -> Result<Vec<MetricRow>, NotDrawn> {
        let file = self.folder.join("metrics.csv");
        if !file.is_file() {
            let help = "springpot metrics works them out, or name them in the scenario: [[metric]]".to_owned();
            return Err(NotDrawn::new(format!("{} holds no metrics.csv", self.folder.display()), help));
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
    pub(super) fn number(&self, record: &ByteRecord, column: usize, line: u64) -> Result<f64, NotDrawn> {
        let field = record.get(column).unwrap_or_default();
        let text = std::str::from_utf8(field).unwrap_or("?");
        let value = if text.is_empty() { Some(f64::NAN) } else { text.parse().ok() };
        let unit = self.units[column].as_ref();
        value.map(|value| unit.map_or(value, |unit| unit.to_si(value))).ok_or_else(|| {
            let (file, name, field) = (self.file.display(), &self.columns[column].name, cut_field(field));
            NotDrawn::new(format!("{file}:{line}: {field} in column {name:?} is not a number"), None)
        })
    }
}

/// Name and unit of a measured column, `Force [kN]`; of another one all of it is the name.
fn heading(written: &str, is_measured: bool) -> (&str, Option<Unit>) {
    let parts = || csv::heading(written).map(|(name, unit)| (name, Some(unit)));
    is_measured.then(parts).flatten().unwrap_or((written, None))
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
        let are_names = value["names"].is_array();
        let mut sweep = Self { parameters: texts("parameters"), labels: texts("labels"), are_names, ..Self::default() };
        let each = |value: &Value| -> Vec<String> {
            value.as_array().into_iter().flatten().filter_map(Value::as_str).map(str::to_owned).collect()
        };
        sweep.written = value["written"].as_array().into_iter().flatten().map(each).collect();
        // What has no label there is listed as the rows have it.
        let listed = value["values"].as_array().into_iter().flatten().take(sweep.labels.len());
        for (k, values) in listed.enumerate() {
            let fields: Vec<Vec<u8>> = values.as_array().into_iter().flatten().map(field).collect();
            // Values that look alike in the rows cannot be told apart; the first stands for all.
            sweep.by_fields.entry(fields.join(&b'\n')).or_insert(k);
        }
        sweep
    }

    /// The values of a parameter as written; nothing where that is not told.
    pub(super) fn written(&self, path: &str) -> Vec<String> {
        if self.parameters.len() == 1 && !self.are_names {
            return self.labels.clone();
        }
        let at = self.parameters.iter().position(|parameter| parameter == path);
        let one = |value: &Vec<String>| at.and_then(|at| value.get(at)).cloned();
        self.written.iter().map(one).collect::<Option<_>>().unwrap_or_default()
    }

    /// The label of the value that is meant by a text: one as written, or a number or quantity that has the value of the rows.
    pub(super) fn find(&self, value: &str) -> Option<&String> {
        if let Some(label) = self.labels.iter().find(|label| *label == value) {
            return Some(label);
        }
        // A text as the rows have it, where the values have names.
        if let Some(k) = self.by_fields.get(value.as_bytes()).filter(|_| self.are_names) {
            return self.labels.get(*k);
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

fn rows_in(folder: &Path) -> Result<PathBuf, NotDrawn> {
    let names = ["results.csv", "results.csv.part"];
    if let Some(found) = names.map(|name| folder.join(name)).into_iter().find(|file| file.is_file()) {
        return Ok(found);
    }
    let other = ["results.parquet", "results.npz"].into_iter().find(|name| folder.join(name).is_file());
    Err(match other {
        Some(name) => NotDrawn::new(
            format!("{} holds {name}, and plot reads CSV", folder.display()),
            "view, report, export and metrics read it; for plot run the scenario with --format csv".to_owned(),
        ),
        None => NotDrawn::new(
            format!("{} holds no results.csv", folder.display()),
            "name the folder of the results of a run, such as results/arm".to_owned(),
        ),
    })
}

fn reader(file: &Path) -> Result<Reader<BufReader<File>>, NotDrawn> {
    let refused = |why: String| {
        let help = "name the folder of the results of a run, such as results/arm, or its results.csv".to_owned();
        NotDrawn::new(format!("{} cannot be opened: {why}", file.display()), help)
    };
    // The rows are read twice, and opening a pipe would wait for its other end.
    if !fs::metadata(file).map_err(|error| refused(error.to_string()))?.is_file() {
        return Err(refused("not a regular file".to_owned()));
    }
    let open = File::open(file).map_err(|error| refused(error.to_string()))?;
    Ok(Reader::from_reader(BufReader::with_capacity(CHUNK, open)))
}

fn unreadable(file: &Path, error: &::csv::Error) -> NotDrawn {
    let line = error.position().map_or_else(String::new, |position| format!(":{}", position.line()));
    let what = match error.kind() {
        ::csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("{len} fields where the header has {expected_len}")
        }
        ::csv::ErrorKind::Utf8 { .. } => "not UTF-8".to_owned(),
        _ => error.to_string(),
    };
    NotDrawn::new(format!("{}{line}: {what}", file.display()), None)
}
