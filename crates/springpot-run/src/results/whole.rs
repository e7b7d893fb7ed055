//! A run that has ended, read back whole: its cases with every number to the bit, and what it says of itself.

use super::{Results, ResultsError};
use crate::labels;
use crate::record::{Listed, Sweep};
use crate::sweep::{Ended, Parcel, push_row};
use crate::table::{push_number, push_text};
use crate::trouble::Trouble;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use springpot::sensitivity::Lost;
use springpot::table::Column;
use springpot_scenario::SweptValue;
use std::collections::{BTreeMap, HashMap};
use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// What a run that has ended says of itself, its numbers aside.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Told {
    /// Its folder, from the root of the file system.
    pub folder: PathBuf,
    /// Of its rows: `csv`, `parquet` or `npz`.
    pub format: String,
    /// The title of the scenario.
    pub title: Option<String>,
    /// What the scenario was called, its text, what was set and what was swept beside it; empty where run.json does not say it.
    pub scenario: (String, String, Vec<String>, Vec<String>),
    /// Paths of the swept parameters.
    pub parameters: Vec<String>,
    /// By sweep the paths that move together, the number of its values, and what they are called where they have names.
    pub axes: Vec<(Vec<String>, usize, Option<Vec<String>>)>,
    /// Name, unit and meaning of every column, those of swept parameters first.
    pub columns: Vec<[String; 3]>,
    /// Name, column and unit of every metric.
    pub metrics: Vec<[String; 3]>,
    /// Columns of events.csv behind the swept parameters and the name of the event.
    pub event_columns: Vec<String>,
    /// Name, paths, value and unit of what the first case is differentiated by.
    pub differentiated: Vec<(String, Vec<String>, f64, String)>,
    /// By index the swept values of a case, SI, and what it is called.
    pub cases: BTreeMap<usize, (Vec<SweptValue>, String)>,
}

impl Told {
    /// What stands at an axis that shows a column; `None` where there is no such column.
    pub fn axis(&self, column: usize) -> Option<String> {
        let [name, unit, meaning] = self.columns.get(column)?;
        Some(labels::axis(&Column::new(&**name, &**unit, &**meaning), None))
    }
}

/// Lines of a table, by the swept values that lead them: the fields behind these.
type Lines = HashMap<String, Vec<Vec<String>>>;

/// A case whose rows are being read.
struct Open {
    index: usize,
    lead: String,
    /// How many rows run.json tells of; `None`: it does not list the case.
    wanted: Option<u64>,
    rows: u64,
    /// Time of the last row, s; −∞ without a column of it.
    last: f64,
}

/// Swept values as they lead lines, and columns.
type Rows = (String, Vec<Vec<f64>>);

impl Results {
    /// Opens results and reads all of them; of other versions too, as far as they are understood.
    ///
    /// # Errors
    /// There are none, they cannot be read, do not fit together, or are one part of a run or of one that is under way.
    pub fn whole(&self) -> Result<(Told, Vec<Arc<Parcel>>), ResultsError> {
        let record = self.file("run.json").and_then(|bytes| serde_json::from_slice::<Value>(&bytes).ok());
        let record = record.ok_or_else(|| ResultsError::NoRecord(self.folder.clone()))?;
        if record.get("shard").is_some_and(|shard| !shard.is_null()) {
            return Err(ResultsError::Part(self.folder.clone()));
        }
        self.check_columns()?;
        let mut rows = self.all_rows()?;
        let [metrics, gradients, events] = ["metrics.csv", "gradient.csv", "events.csv"].map(|name| self.lines(name));
        let ((metric_lines, _), (gradient_lines, _), (event_lines, event_head)) = (metrics?, gradients?, events?);
        let mut told = self.told(&record, &metric_lines, event_head);
        // Cases with equal values are equal: what is found of all of them is shared out.
        let mut sharing: HashMap<String, (usize, usize)> = HashMap::new();
        rows.values().for_each(|(lead, _)| sharing.entry(lead.clone()).or_default().0 += 1);
        let written: BTreeMap<usize, &Value> = listed(&record).map(|case| (place(case, "index"), case)).collect();
        let mut parcels = Vec::new();
        let indices: Vec<usize> = rows.keys().chain(written.keys()).copied().collect();
        let indices: std::collections::BTreeSet<usize> = indices.into_iter().collect();
        for index in indices {
            let case = self.record.cases.iter().find(|case| case.index == index);
            let none = || (String::new(), vec![Vec::new(); self.columns.len()]);
            let has_rows = rows.contains_key(&index);
            let (lead, columns) = rows.remove(&index).unwrap_or_else(none);
            let (cases, before) = sharing.entry(lead.clone()).or_default();
            let shared = |lines: &Lines, name: &str| match lines.get(&lead) {
                Some(all) if has_rows && all.len().is_multiple_of(*cases) => {
                    let own = all.len() / *cases;
                    Ok(all[*before * own..(*before + 1) * own].to_vec())
                }
                Some(_) if has_rows => {
                    Err(self.damaged(name, format!("its lines for {lead:?} are not those of {cases} cases")))
                }
                _ => Ok(Vec::new()),
            };
            let lines = [
                shared(&metric_lines, "metrics.csv")?,
                shared(&gradient_lines, "gradient.csv")?,
                shared(&event_lines, "events.csv")?,
            ];
            *before += 1;
            told.cases.insert(index, self.called(index, case, &lead));
            let ended = self.ended(index, written.get(&index).copied(), (&told, &record), (&lead, lines))?;
            parcels.push(Arc::new(Parcel::read_back(ended, columns)));
        }
        Ok((told, parcels))
    }

    /// Writes the rows as CSV, whatever their format is.
    ///
    /// # Errors
    /// They cannot be read or written.
    pub fn write_csv(&self, out: &mut dyn io::Write) -> io::Result<()> {
        let mut line = String::new();
        for (k, name) in self.rows.columns().iter().enumerate() {
            if k > 0 {
                line.push(',');
            }
            push_text(&mut line, name);
        }
        line.push('\n');
        let numbers: Vec<usize> = (self.swept..self.rows.columns().len()).collect();
        self.rows.visit(self.swept, &numbers, &mut |lead, values| {
            out.write_all(line.as_bytes())?;
            line.clear();
            push_row(&mut line, lead, values.iter().copied());
            Ok(())
        })?;
        out.write_all(line.as_bytes())?;
        out.flush()
    }

    /// What is wrong with a file of the results.
    fn damaged(&self, name: &str, why: impl Into<String>) -> ResultsError {
        let error = io::Error::new(io::ErrorKind::InvalidData, why.into());
        ResultsError::File { file: self.folder.join(name), error }
    }

    /// Whether the rows have the columns of run.json.
    fn check_columns(&self) -> Result<(), ResultsError> {
        let (known, found): (Vec<Column>, _) = (self.record.columns().collect(), self.rows.columns());
        let differs = known.iter().zip(found).find(|(known, found)| known.name != **found);
        let why = match differs {
            Some((known, found)) => format!("it has a column {found:?} where run.json tells of {:?}", known.name),
            None if known.len() != found.len() => {
                format!("it has {} columns where run.json tells of {}", found.len(), known.len())
            }
            None => return Ok(()),
        };
        Err(self.damaged(&self.record.rows_file(), why))
    }

    /// The columns of every case with rows, by its index.
    fn all_rows(&self) -> Result<BTreeMap<usize, Rows>, ResultsError> {
        let file = self.record.rows_file();
        let listed: BTreeMap<usize, &Listed> = self.record.cases.iter().map(|case| (case.index, case)).collect();
        let total = self.record.totals.cases_total;
        // A run that was broken off lists what it began; of many cases that came to their end the first ones alone are listed.
        let all = matches!(&*self.record.status, "done" | "failed") && total > listed.len();
        let mut indices: Box<dyn Iterator<Item = usize>> =
            if all { Box::new(0..total) } else { Box::new(listed.keys().copied()) };
        let time = self.columns.iter().position(|column| column.name == "t");
        let numbers: Vec<usize> = (self.swept..self.swept + self.columns.len()).collect();
        let mut found: BTreeMap<usize, Rows> = BTreeMap::new();
        let mut open: Option<Open> = None;
        let invalid = |why: String| io::Error::new(io::ErrorKind::InvalidData, why);
        let short = |open: &Open| {
            let wanted = open.wanted.filter(|wanted| *wanted != open.rows)?;
            Some(format!("it holds {} rows of case {}, where run.json tells of {wanted}", open.rows, open.index))
        };
        let mut next = || indices.find(|index| listed.get(index).is_none_or(|case| case.rows > 0));
        let mut take = |lead: &str, values: &[f64]| {
            let t = time.map_or(f64::NEG_INFINITY, |time| values[time]);
            let goes_on = |open: &Open| {
                open.lead == lead && open.wanted.map_or(t > open.last || time.is_none(), |wanted| open.rows < wanted)
            };
            if !open.as_ref().is_some_and(goes_on) {
                if let Some(why) = open.as_ref().and_then(short) {
                    return Err(invalid(why));
                }
                let Some(index) = next() else {
                    return Err(invalid("it holds more cases than run.json tells of".into()));
                };
                let case = listed.get(&index);
                if let Some(wanted) = case.map(|case| self.record.lead(case)).filter(|wanted| wanted != lead) {
                    let (is, wanted) = (lead.trim_end_matches(','), wanted.trim_end_matches(','));
                    return Err(invalid(format!(
                        "the rows of case {index} begin with {is:?} where run.json tells of {wanted:?}"
                    )));
                }
                open =
                    Some(Open { index, lead: lead.to_owned(), wanted: case.map(|case| case.rows), rows: 0, last: t });
                found.insert(index, (lead.to_owned(), vec![Vec::new(); values.len()]));
            }
            if let Some(open) = &mut open {
                (open.rows, open.last) = (open.rows + 1, t);
                let (_, columns) = found.entry(open.index).or_default();
                columns.iter_mut().zip(values).for_each(|(column, value)| column.push(*value));
            }
            Ok(())
        };
        let read = self.rows.visit(self.swept, &numbers, &mut take);
        read.map_err(|error| ResultsError::File { file: self.folder.join(&file), error })?;
        match open.as_ref().and_then(short).or_else(|| next().map(|index| format!("it holds no row of case {index}"))) {
            Some(why) => Err(self.damaged(&file, why)),
            None => Ok(found),
        }
    }

    /// The lines of a table that the run wrote, and what stands above them; nothing where it wrote none.
    fn lines(&self, name: &str) -> Result<(Lines, Vec<String>), ResultsError> {
        let mut lines = Lines::new();
        if !self.record.files.iter().any(|file| file == name) {
            return Ok((lines, Vec::new()));
        }
        let failed = |error: csv::Error| self.damaged(name, error.to_string());
        let file = self.folder.join(name);
        let bytes = self.disk.read(&file).map_err(|error| ResultsError::File { file, error })?;
        let mut reader = csv::Reader::from_reader(&bytes[..]);
        let head = reader.headers().map_err(failed)?.iter().skip(self.swept).map(str::to_owned).collect();
        for line in reader.records() {
            let line = line.map_err(failed)?;
            let mut lead = String::new();
            for field in line.iter().take(self.swept) {
                push_text(&mut lead, field);
                lead.push(',');
            }
            lines.entry(lead).or_default().push(line.iter().skip(self.swept).map(str::to_owned).collect());
        }
        Ok((lines, head))
    }

    fn told(&self, record: &Value, metric_lines: &Lines, event_head: Vec<String>) -> Told {
        let text = |column: &Column| [&column.name, &column.unit, &column.meaning].map(ToString::to_string);
        let columns = self.record.columns();
        let metrics = self.record.metrics().into_iter().map(|metric| {
            let is_own = |line: &&Vec<String>| line.first() == Some(&metric.name);
            let written = metric_lines.values().flatten().find(is_own).and_then(|line| line.get(3).cloned());
            let unit = || metric.kind.unit(&self.record.column(&metric.of).unit).into_owned();
            [metric.name.clone(), metric.of.clone(), written.unwrap_or_else(unit)]
        });
        let by = record["sensitivity"]["parameters"].as_array().into_iter().flatten().map(|own| {
            let paths = words(own, "path").split(", ").map(str::to_owned).collect();
            (words(own, "name"), paths, own["value"].as_f64().unwrap_or(f64::NAN), words(own, "unit"))
        });
        let scenario = self.record.scenario.as_ref();
        Told {
            folder: self.folder.canonicalize().unwrap_or_else(|_| self.folder.clone()),
            format: self.record.rows_file().trim_start_matches("results.").to_owned(),
            title: self.record.title.clone(),
            scenario: scenario.map_or_else(Default::default, |own| {
                (own.name.clone(), own.text.clone(), own.set.clone(), own.sweep.clone())
            }),
            parameters: self.record.parameters().cloned().collect(),
            axes: self.record.sweeps.iter().map(axis).collect(),
            columns: columns.map(|column| text(&column)).collect(),
            metrics: metrics.collect(),
            event_columns: event_head.into_iter().skip(1).collect(),
            differentiated: by.collect(),
            cases: BTreeMap::new(),
        }
    }

    /// The swept values of a case, and what it is called.
    fn called(&self, index: usize, case: Option<&Listed>, lead: &str) -> (Vec<SweptValue>, String) {
        let read = |field: &str| match field.parse() {
            Ok(number) => SweptValue::Number(number),
            Err(_) => SweptValue::Text(field.to_owned()),
        };
        let values: Vec<SweptValue> = match case {
            Some(case) => self.record.parameters().filter_map(|path| case.parameters.get(path)).map(swept).collect(),
            None => {
                let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(lead.as_bytes());
                let fields = reader.records().next().and_then(Result::ok).unwrap_or_default();
                fields.iter().take(self.swept).map(read).collect()
            }
        };
        let mut words = Vec::new();
        let mut stride: usize = self.record.sweeps.iter().map(|sweep| sweep.count.max(1)).product();
        let mut own = values.iter();
        for sweep in &self.record.sweeps {
            stride = (stride / sweep.count.max(1)).max(1);
            let at = index / stride % sweep.count.max(1);
            let values: Vec<String> = own.by_ref().take(sweep.parameters.len()).map(written).collect();
            match sweep.name(at) {
                Some(name) => words.push(name.clone()),
                None => words.extend(
                    sweep
                        .parameters
                        .iter()
                        .zip(values)
                        .enumerate()
                        .map(|(k, (path, value))| format!("{path} = {}", sweep.written(at, k).unwrap_or(&value))),
                ),
            }
        }
        (values, words.join(", "))
    }

    /// What is known of a case, its rows aside; `lines` are those of metrics, gradients and events.
    fn ended(
        &self,
        index: usize,
        case: Option<&Value>,
        (told, record): (&Told, &Value),
        (lead, [metrics, gradients, events]): (&str, [Vec<Vec<String>>; 3]),
    ) -> Result<Ended, ResultsError> {
        let number = |text: Option<&String>, name: &str| match text.map(String::as_str) {
            Some("") => Ok(f64::NAN),
            Some(text) => text.parse().map_err(|_| self.damaged(name, format!("{text:?} is no number"))),
            None => Err(self.damaged(name, "a line is too short")),
        };
        let column = |lines: &[Vec<String>], at: usize, name: &str| {
            lines.iter().map(|line| number(line.get(at), name)).collect::<Result<Vec<f64>, _>>()
        };
        let slopes = column(&gradients, 4, "gradient.csv")?;
        let lost = record["sensitivity"]["lost"].as_array().into_iter().flatten();
        let lost = lost.filter(|lost| lost.get("case").is_none_or(|case| case.as_u64() == Some(index as u64)));
        let lost = lost.filter_map(|lost| {
            let name = words(lost, "parameter");
            let parameter = told.differentiated.iter().position(|(own, ..)| *own == name)?;
            Some(Lost { parameter, t: lost["t"].as_f64()?, why: words(lost, "why") })
        });
        let mut ended = Ended {
            index,
            metrics: column(&metrics, 2, "metrics.csv")?,
            gradients: slopes.chunks(told.differentiated.len().max(1)).map(<[f64]>::to_vec).collect(),
            lost: lost.collect(),
            events: String::new(),
            ..Ended::default()
        };
        for line in events {
            ended.events.push_str(lead);
            for (k, field) in line.iter().enumerate() {
                if k > 0 {
                    ended.events.push(',');
                }
                push_text(&mut ended.events, field);
            }
            ended.events.push('\n');
        }
        let Some(case) = case else { return Ok(ended) };
        let damaged = |error: serde_json::Error| self.damaged("run.json", format!("case {index}: {error}"));
        ended.report = serde_json::from_value(case.clone()).map_err(damaged)?;
        ended.limits = match &case["limits"] {
            Value::Null => Vec::new(),
            limits => serde_json::from_value(limits.clone()).map_err(damaged)?,
        };
        let text = |key: &str| case[key].as_str().map(str::to_owned);
        let message =
            text("error").or_else(|| (words(case, "status") == "interrupted").then(|| "interrupted".to_owned()));
        ended.error = message.map(|message| Trouble {
            message,
            place: text("error_place"),
            help: text("error_help"),
            t: case["error_t"].as_f64(),
            at: None,
        });
        ended.no_ledger = text("ledger").map(|why| why.trim_start_matches("unknown: ").to_owned());
        ended.wall = Duration::try_from_secs_f64(case["wall_time"].as_f64().unwrap_or(0.0)).unwrap_or_default();
        Ok(ended)
    }
}

fn axis(sweep: &Sweep) -> (Vec<String>, usize, Option<Vec<String>>) {
    let names: Option<Vec<String>> = (0..sweep.count).map(|at| sweep.name(at).cloned()).collect();
    (sweep.parameters.clone(), sweep.count, names)
}

fn listed(record: &Value) -> impl Iterator<Item = &Value> {
    record["cases"].as_array().into_iter().flatten()
}

fn place(value: &Value, key: &str) -> usize {
    value[key].as_u64().and_then(|index| usize::try_from(index).ok()).unwrap_or(0)
}

fn words(value: &Value, key: &str) -> String {
    value[key].as_str().unwrap_or_default().to_owned()
}

fn swept(value: &Value) -> SweptValue {
    match value {
        Value::String(text) => SweptValue::Text(text.clone()),
        value => SweptValue::Number(value.as_f64().unwrap_or(f64::NAN)),
    }
}

fn written(value: &SweptValue) -> String {
    match value {
        SweptValue::Text(text) => text.clone(),
        SweptValue::Number(number) => {
            let mut text = String::new();
            push_number(&mut text, *number);
            text
        }
    }
}
