//! A run that is under way, watched from beside it.
//!
//! A run writes its rows into `results.csv.part`, and what they are into `.unfinished/running.json` before the first of them; both are only read here.

use crate::meshes;
use crate::record::{self, Listed, Record};
use crate::table::disk::{Disk, DiskFile};
use crate::table::folder::{PART, RUNNING, UNFINISHED, is_held};
use crate::view::{MOST_NUMBERS, shown, view_columns};
use springpot::table::Column;
use springpot_report::page::{View, ViewCase};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// Rows that come together.
const MOST_ROWS: usize = 500;
/// Pieces that are read without news.
const MOST_PIECES: usize = 64;
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
    /// The checksum of run.json when it was opened: that of an earlier run.
    earlier: Option<u32>,
    /// Index of the column of times.
    time: Option<usize>,
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
    t: f64,
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
        let leads = record.cases.iter().map(|case| record.lead(case)).collect();
        let earlier = disk.read(&folder.join("run.json")).ok().map(|bytes| crc32fast::hash(&bytes));
        let time = columns.iter().position(|column| column.name == "t");
        let (disk, folder, stride) = (disk.clone(), folder.to_owned(), numbers.div_ceil(MOST_NUMBERS).max(1));
        Some(Self { disk, folder, record, columns, told, earlier, time, stride, leads })
    }

    /// The page without rows, which asks `follow` for them.
    pub fn view(&self, follow: &str) -> View {
        let record = &self.record;
        let mut notes = Vec::new();
        if self.stride > 1 {
            notes.push(format!("one of {} rows is shown", self.stride));
        }
        if record.totals.cases_total > record.cases.len() {
            notes.push(format!("the first {} of {} cases are shown", record.cases.len(), record.totals.cases_total));
        }
        let (meshes, unseen) = meshes::files(record, &self.folder);
        notes.extend(unseen);
        View {
            title: record.title.clone(),
            name: record::name(&self.folder),
            status: "running".to_owned(),
            version: record.version().to_owned(),
            notes,
            columns: view_columns(&self.columns),
            scenes: record.scenes.clone(),
            meshes,
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
        Ok(Tail {
            run: self,
            file,
            rest: Vec::new(),
            position: 0,
            sent,
            has_head: false,
            case: None,
            rows: 0,
            t: f64::NAN,
        })
    }

    /// What tells it from other runs in its folder.
    pub fn id(&self) -> &str {
        &self.record.id
    }

    /// How the run has ended; `None` while it is under way.
    fn ended(&self) -> Option<String> {
        let folder = &self.folder;
        if self.disk.read(&told_in(folder)).is_ok_and(|told| told == self.told) {
            // A run that was killed says nothing.
            return (!is_held(&self.disk, folder)).then(|| "interrupted".to_owned());
        }
        // One that ended without a row left an earlier run's record.
        let now = self.disk.read(&folder.join("run.json")).ok();
        let own = now.filter(|bytes| Some(crc32fast::hash(bytes)) != self.earlier);
        let status = own.and_then(|bytes| serde_json::from_slice::<Record>(&bytes).ok()).map(|record| record.status);
        Some(status.unwrap_or_else(|| "interrupted".to_owned()))
    }
}

fn told_in(folder: &Path) -> PathBuf {
    folder.join(UNFINISHED).join(RUNNING)
}

impl Tail<'_> {
    /// What has come since the last call; `None` where the run has written nothing more. Of much, a part, which may hold no news.
    ///
    /// # Errors
    /// The file system's.
    pub fn news(&mut self) -> io::Result<Option<Vec<News>>> {
        let mut news = Vec::new();
        for _ in 0..MOST_PIECES {
            if !self.read(&mut news)? {
                return Ok(if news.is_empty() { self.end()? } else { Some(news) });
            }
            if !news.is_empty() {
                break;
            }
        }
        Ok(Some(news))
    }

    /// The last rows and how the run ended, where it has.
    fn end(&mut self) -> io::Result<Option<Vec<News>>> {
        let Some(status) = self.run.ended() else { return Ok(None) };
        let mut news = Vec::new();
        // Rows may have come in between.
        while self.read(&mut news)? {}
        news.push(News::Ended(status));
        Ok(Some(news))
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
        let leads = &self.run.leads;
        let fields = |case: usize| {
            line[leads[case].len()..].split(',').map(|field| field.trim_end().parse().unwrap_or(f64::NAN))
        };
        let time = |case: usize| self.run.time.and_then(|time| fields(case).nth(time)).unwrap_or(f64::NAN);
        // Cases come in their order, times rise within each; those without a row do not come.
        let is_back = |case: usize| time(case) <= self.t;
        let goes_on = self.case.filter(|case| line.starts_with(&leads[*case]) && !is_back(*case));
        let next = || (self.case.map_or(0, |case| case + 1)..listed.len()).find(|case| line.starts_with(&leads[*case]));
        let Some(case) = goes_on.or_else(next) else { return };
        self.t = time(case);
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
        let row: Vec<f64> = fields(case).collect();
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
