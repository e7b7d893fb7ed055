//! A run that is under way, watched from beside it.
//!
//! A run writes its rows into `results.csv.part`, and what they are into `.unfinished/running.json` before the first of them; both are only read here.

use crate::record::{self, Listed, Record};
use crate::results::Results;
use crate::table::disk::{Disk, DiskFile};
use crate::table::folder::{PART, RUNNING, UNFINISHED, is_held};
use crate::table::{push_number, push_text};
use crate::view::{shown, view_columns};
use serde_json::Value;
use springpot::table::Column;
use springpot_report::page::{View, ViewCase};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// Numbers that a page is sent.
const MOST_NUMBERS: usize = 1_200_000;
/// Rows that come together.
const MOST_ROWS: usize = 500;
/// Bytes that are read at a time.
const PIECE: usize = 1 << 20;

/// A run that is under way in a folder.
#[derive(Debug)]
pub struct Underway {
    disk: Disk,
    folder: PathBuf,
    record: Record,
    /// Those of swept parameters aside.
    columns: Vec<Column>,
    told: Vec<u8>,
    /// Every so many rows are sent.
    stride: usize,
    /// Swept values of the listed cases, as they lead their rows.
    leads: Vec<String>,
}

/// One reader of the rows of a run under way.
#[derive(Debug)]
pub struct Tail<'a> {
    run: &'a Underway,
    file: DiskFile,
    /// What was read behind the last whole row.
    rest: Vec<u8>,
    /// Bytes up to the end of the last whole row.
    position: u64,
    /// What was sent before, bytes.
    sent: u64,
    has_head: bool,
    /// Case of the last row: its place among those listed, and its rows so far.
    case: Option<usize>,
    rows: usize,
}

/// What is new.
#[derive(Debug, Clone)]
pub enum News {
    /// A case begins.
    Case(Box<ViewCase>),
    /// Some rows of a case.
    Rows(NewRows),
    /// The run has ended: done, failed or interrupted.
    Ended(String),
}

/// Rows of a case.
#[derive(Debug, Clone, PartialEq)]
pub struct NewRows {
    /// Index of the case.
    pub case: usize,
    /// NaN: empty.
    pub rows: Vec<Vec<f64>>,
    /// Where they end: what [`Underway::tail`] goes on from.
    pub position: u64,
}

impl Underway {
    /// The run under way in a folder; `None` where there is none.
    pub fn open(disk: &Disk, folder: &Path) -> Option<Self> {
        let told = disk.read(&told_in(folder)).ok().filter(|_| is_held(disk, folder))?;
        let record: Record = serde_json::from_slice(&told).ok()?;
        let columns: Vec<Column> = record.columns().skip(record.parameters().count()).collect();
        let rows = record.plan["time"]["rows"].as_u64().unwrap_or(1) as usize;
        let numbers = rows.saturating_mul(record.cases.len()).saturating_mul(columns.len());
        let lead = |case: &Listed| {
            let mut lead = String::new();
            for path in record.parameters() {
                match case.parameters.get(path) {
                    Some(Value::Number(number)) => push_number(&mut lead, number.as_f64().unwrap_or(f64::NAN)),
                    Some(Value::String(text)) => push_text(&mut lead, text),
                    _ => {}
                }
                lead.push(',');
            }
            lead
        };
        let leads = record.cases.iter().map(lead).collect();
        let (disk, folder, stride) = (disk.clone(), folder.to_owned(), numbers.div_ceil(MOST_NUMBERS).max(1));
        Some(Self { disk, folder, record, columns, told, stride, leads })
    }

    /// The page without rows, which asks `follow` for them.
    pub fn view(&self, follow: &str) -> View {
        let record = &self.record;
        let mut notes = Vec::new();
        if self.stride > 1 {
            notes.push(format!("one of {} rows is shown", self.stride));
        }
        if record.cases_total > record.cases.len() {
            notes.push(format!("the first {} of {} cases are shown", record.cases.len(), record.cases_total));
        }
        View {
            title: record.title.clone(),
            name: record::name(&self.folder),
            status: "running".to_owned(),
            version: record.version().to_owned(),
            notes,
            columns: view_columns(&self.columns),
            scenes: record.scenes.clone(),
            laws: record.laws.clone(),
            cases: record.cases.iter().take(1).map(|case| self.case(case)).collect(),
            follow: Some(follow.to_owned()),
        }
    }

    fn case(&self, case: &Listed) -> ViewCase {
        ViewCase { status: "running".to_owned(), ..shown(&self.record, case) }
    }

    /// Reads the rows from the first one on; what stands in the first `sent` bytes is not told again.
    ///
    /// # Errors
    /// The file system's.
    pub fn tail(&self, sent: u64) -> io::Result<Tail<'_>> {
        let file = self.disk.open(&self.folder.join(PART))?;
        Ok(Tail { run: self, file, rest: Vec::new(), position: 0, sent, has_head: false, case: None, rows: 0 })
    }

    /// How the run has ended; `None` while it is under way.
    fn ended(&self) -> Option<String> {
        let folder = &self.folder;
        if self.disk.read(&told_in(folder)).is_ok_and(|told| told == self.told) {
            // A run that was killed says nothing.
            return (!is_held(&self.disk, folder)).then(|| "interrupted".to_owned());
        }
        let ended = Results::open(&self.disk, folder).ok().map(|results| results.record.status);
        Some(ended.unwrap_or_else(|| "interrupted".to_owned()))
    }
}

fn told_in(folder: &Path) -> PathBuf {
    folder.join(UNFINISHED).join(RUNNING)
}

impl Tail<'_> {
    /// What has come since the last call, or nothing.
    ///
    /// # Errors
    /// The file system's.
    pub fn news(&mut self) -> io::Result<Vec<News>> {
        let mut news = Vec::new();
        if self.read(&mut news)? {
            return Ok(news);
        }
        if let Some(status) = self.run.ended() {
            // Rows may have come in between.
            while self.read(&mut news)? {}
            news.push(News::Ended(status));
        }
        Ok(news)
    }

    /// Takes one piece; false where nothing is there.
    fn read(&mut self, news: &mut Vec<News>) -> io::Result<bool> {
        let mut piece = Vec::with_capacity(PIECE);
        Read::by_ref(&mut self.file).take(PIECE as u64).read_to_end(&mut piece)?;
        if piece.is_empty() {
            return Ok(false);
        }
        self.rest.extend_from_slice(&piece);
        let (mut from, mut is_quoted) = (0, false);
        for at in 0..self.rest.len() {
            match self.rest[at] {
                b'"' => is_quoted = !is_quoted,
                b'\n' if !is_quoted => {
                    let line = String::from_utf8_lossy(&self.rest[from..at]).into_owned();
                    self.position += (at + 1 - from) as u64;
                    from = at + 1;
                    self.line(&line, news);
                }
                _ => {}
            }
        }
        self.rest.drain(..from);
        Ok(true)
    }

    fn line(&mut self, line: &str, news: &mut Vec<News>) {
        if !std::mem::replace(&mut self.has_head, true) {
            return;
        }
        let listed = &self.run.record.cases;
        // Cases come in their order; those without a row do not come.
        let from = self.case.unwrap_or(0);
        let Some(case) = (from..listed.len()).find(|case| line.starts_with(&self.run.leads[*case])) else { return };
        let is_new = self.case != Some(case);
        if is_new {
            (self.case, self.rows) = (Some(case), 0);
        }
        let is_sent = self.position <= self.sent;
        if is_new && case > 0 && !is_sent {
            news.push(News::Case(Box::new(self.run.case(&listed[case]))));
        }
        self.rows += 1;
        if is_sent || !(self.rows - 1).is_multiple_of(self.run.stride) {
            return;
        }
        let fields = line[self.run.leads[case].len()..].split(',');
        let row: Vec<f64> = fields.map(|field| field.trim_end().parse().unwrap_or(f64::NAN)).collect();
        let (case, position) = (listed[case].index, self.position);
        match news.last_mut() {
            Some(News::Rows(last)) if last.case == case && last.rows.len() < MOST_ROWS => {
                last.rows.push(row);
                last.position = position;
            }
            _ => news.push(News::Rows(NewRows { case, rows: vec![row], position })),
        }
    }
}
