//! `run --format`: Parquet and NumPy files hold what results.csv holds, bit for bit. They are read here by other means than those
//! that wrote them.

#[cfg(unix)]
use crate::support::Place;
use crate::support::{ENDLESS, length, signal, wait_for};
use std::collections::BTreeMap;
use std::fs;
#[cfg(unix)]
use std::process::Stdio;

/// A singular start leaves cells empty; a swept law is a text, beside a swept number.
const ROWS: &str = r#"
[robot]
body = [{ name = "arm", joint = { name = "q1", kind = "revolute", axis = [0, 1, 0] }, mass = 1, com = [0.2, 0, 0] }]
[[element]]
name = "strut"
from = { body = "world", point = [0, 0, -0.3] }
to = { body = "arm", point = [0.3, 0, 0] }
rest_length = 0.3
law = "springpot"
parameters = { c = 50, alpha = 0.4 }
derivative = "riemann-liouville"
[motion]
kind = "prescribed"
joints = { q1 = "0.5*sin(2*t)" }
[time]
end = 1
output_step = 0.125
[[sweep]]
parameter = "element.strut.alpha"
values = [0.2, 0.7]
[[sweep]]
parameter = "motion.joints.q1"
values = ["0.5*sin(2*t)", "0.1*t", 0, "min(t, 0.3)*1"]
"#;

/// One cell.
#[derive(Debug, Clone, PartialEq)]
enum Cell {
    None,
    Bits(u64),
    Text(String),
}

type Columns = Vec<(String, Vec<Cell>)>;

/// What results.csv holds; `texts` are the columns of texts.
fn from_csv(text: &str, texts: &[&str]) -> Columns {
    // Texts with commas stand in quotes; no text holds a quote.
    let fields = |line: &str| {
        let (mut fields, mut quoted) = (vec![String::new()], false);
        for c in line.chars() {
            match c {
                '"' => quoted = !quoted,
                ',' if !quoted => fields.push(String::new()),
                c => fields.last_mut().unwrap().push(c),
            }
        }
        fields
    };
    let mut lines = text.lines().map(fields);
    let mut columns: Columns = lines.next().unwrap().into_iter().map(|name| (name, Vec::new())).collect();
    for line in lines {
        assert_eq!(line.len(), columns.len());
        for (field, (name, cells)) in line.into_iter().zip(&mut columns) {
            cells.push(match texts.contains(&name.as_str()) {
                true => Cell::Text(field),
                false if field.is_empty() => Cell::None,
                false => Cell::Bits(field.parse::<f64>().unwrap().to_bits()),
            });
        }
    }
    columns
}

fn short(bytes: &[u8], at: usize) -> usize {
    usize::from(u16::from_le_bytes(bytes[at..at + 2].try_into().unwrap()))
}

fn long(bytes: &[u8], at: usize) -> usize {
    u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize
}

fn longest(bytes: &[u8], at: usize) -> usize {
    u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap()) as usize
}

/// The checksum of zip, bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |sum, byte| {
        (0..8).fold(sum ^ u32::from(*byte), |sum, _| if sum & 1 == 1 { sum >> 1 ^ 0xedb8_8320 } else { sum >> 1 })
    })
}

/// Reads a zip archive by its zip64 directory, and the arrays in it.
fn from_npz(bytes: &[u8]) -> Columns {
    let end = bytes.len() - 22;
    assert_eq!((&bytes[end..end + 4], &bytes[end - 20..end - 16]), (&b"PK\x05\x06"[..], &b"PK\x06\x07"[..]));
    let end64 = longest(bytes, end - 12);
    assert_eq!(&bytes[end64..end64 + 4], b"PK\x06\x06");
    let (count, mut at) = (longest(bytes, end64 + 32), longest(bytes, end64 + 48));
    assert_eq!(at + longest(bytes, end64 + 40), end64);
    let mut columns = Columns::new();
    for _ in 0..count {
        assert_eq!(&bytes[at..at + 4], b"PK\x01\x02");
        let (name, extra) = (at + 46, at + 46 + short(bytes, at + 28));
        let name = String::from_utf8(bytes[name..extra].to_vec()).unwrap();
        let (size, start) = (longest(bytes, extra + 4), longest(bytes, extra + 20));
        assert_eq!(&bytes[start..start + 4], b"PK\x03\x04");
        let data = start + 30 + short(bytes, start + 26) + short(bytes, start + 28);
        let array = &bytes[data..data + size];
        assert_eq!(long(bytes, start + 14), crc32(array) as usize);
        assert_eq!(long(bytes, start + 14), long(bytes, at + 16));
        columns.push((name.strip_suffix(".npy").unwrap().to_owned(), array_of(array)));
        at = extra + short(bytes, at + 30);
    }
    assert_eq!(at, end64);
    columns
}

fn array_of(bytes: &[u8]) -> Vec<Cell> {
    assert_eq!(&bytes[..8], b"\x93NUMPY\x01\0");
    let values = 10 + short(bytes, 8);
    assert_eq!((values % 64, bytes[values - 1]), (0, b'\n'));
    let head = std::str::from_utf8(&bytes[10..values]).unwrap();
    let between = |from: &str, to: &str| head.split(from).nth(1).unwrap().split(to).next().unwrap().to_owned();
    let (kind, rows) = (between("'descr': '", "'"), between("'shape': (", ","));
    let values = &bytes[values..];
    let cells: Vec<Cell> = match kind.strip_prefix("<U") {
        None => {
            assert_eq!(kind, "<f8");
            let number = |k: usize| f64::from_bits(longest(values, 8 * k) as u64);
            let cell = |number: f64| if number.is_nan() { Cell::None } else { Cell::Bits(number.to_bits()) };
            (0..values.len() / 8).map(|k| cell(number(k))).collect()
        }
        Some(width) => {
            let units: Vec<char> = values.chunks(4).map(|c| char::from_u32(long(c, 0) as u32).unwrap()).collect();
            let texts = units.chunks(width.parse().unwrap());
            texts.map(|text| Cell::Text(text.iter().filter(|c| **c != '\0').collect())).collect()
        }
    };
    assert_eq!(cells.len(), rows.parse::<usize>().unwrap());
    cells
}

/// A value of Thrift's compact protocol.
#[derive(Debug)]
enum Thrift {
    Number(i64),
    Text(Vec<u8>),
    List(Vec<Thrift>),
    Struct(BTreeMap<i64, Thrift>),
}

impl Thrift {
    fn get(&self, field: i64) -> &Self {
        let Self::Struct(fields) = self else { panic!("{self:?}") };
        fields.get(&field).unwrap_or_else(|| panic!("no field {field} in {self:?}"))
    }

    fn number(&self, field: i64) -> i64 {
        let Self::Number(number) = self.get(field) else { panic!("{self:?}") };
        *number
    }

    fn list(&self, field: i64) -> &[Self] {
        let Self::List(items) = self.get(field) else { panic!("{self:?}") };
        items
    }

    fn text(&self) -> String {
        let Self::Text(text) = self else { panic!("{self:?}") };
        String::from_utf8(text.clone()).unwrap()
    }
}

struct Compact<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Compact<'_> {
    fn byte(&mut self) -> u8 {
        self.at += 1;
        self.bytes[self.at - 1]
    }

    fn varint(&mut self) -> u64 {
        let mut value = 0;
        for shift in (0..).step_by(7) {
            let byte = self.byte();
            value |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                break;
            }
        }
        value
    }

    fn zigzag(&mut self) -> i64 {
        let value = self.varint();
        (value >> 1) as i64 ^ -((value & 1) as i64)
    }

    fn value(&mut self, kind: u8) -> Thrift {
        match kind {
            4..=6 => Thrift::Number(self.zigzag()),
            8 => {
                let length = self.varint() as usize;
                self.at += length;
                Thrift::Text(self.bytes[self.at - length..self.at].to_vec())
            }
            9 => {
                let head = self.byte();
                let length = if head >> 4 == 15 { self.varint() } else { u64::from(head >> 4) };
                Thrift::List((0..length).map(|_| self.value(head & 15)).collect())
            }
            12 => {
                let (mut fields, mut last) = (BTreeMap::new(), 0);
                loop {
                    let head = self.byte();
                    if head == 0 {
                        return Thrift::Struct(fields);
                    }
                    last = if head >> 4 == 0 { self.zigzag() } else { last + i64::from(head >> 4) };
                    let value = self.value(head & 15);
                    fields.insert(last, value);
                }
            }
            other => panic!("type {other}"),
        }
    }
}

/// Reads a Parquet file of optional columns, plain values and pages of version 1.
fn from_parquet(bytes: &[u8]) -> Columns {
    let end = bytes.len() - 8;
    assert_eq!((&bytes[..4], &bytes[end + 4..]), (&b"PAR1"[..], &b"PAR1"[..]));
    let footer = Compact { bytes, at: end - long(bytes, end) }.value(12);
    let schema = footer.list(2);
    assert_eq!(schema[0].number(5) as usize, schema.len() - 1);
    let mut columns: Columns = schema[1..].iter().map(|column| (column.get(4).text(), Vec::new())).collect();
    for group in footer.list(4) {
        for (chunk, (name, cells)) in group.list(1).iter().zip(&mut columns) {
            let data = chunk.get(3);
            assert_eq!((data.list(3)[0].text(), data.number(4)), (name.clone(), 0));
            let before = cells.len();
            page(bytes, data, cells);
            assert_eq!((cells.len() - before) as i64, data.number(5));
            assert_eq!(data.number(5), group.number(3));
        }
    }
    assert!(columns.iter().all(|(_, cells)| cells.len() as i64 == footer.number(3)));
    let kept = &footer.list(5)[0];
    assert_eq!(kept.get(1).text(), "springpot.columns");
    let kept: serde_json::Value = serde_json::from_str(&kept.get(2).text()).unwrap();
    let named = kept.as_array().unwrap().iter().map(|column| column["name"].as_str().unwrap());
    assert!(named.eq(columns.iter().map(|(name, _)| name.as_str())));
    columns
}

fn page(bytes: &[u8], data: &Thrift, cells: &mut Vec<Cell>) {
    let start = data.number(9) as usize;
    let mut reader = Compact { bytes, at: start };
    let head = reader.value(12);
    let (rows, mut at) = (head.get(5).number(1) as usize, reader.at);
    assert_eq!(data.number(7) as usize, at - start + head.number(3) as usize);
    let end = at + head.number(3) as usize;
    let levels = long(bytes, at);
    let mut reader = Compact { bytes, at: at + 4 };
    at += 4 + levels;
    let mut given = Vec::new();
    while reader.at < at {
        let run = reader.varint();
        assert_eq!(run & 1, 0, "runs of one value alone are written");
        let value = reader.byte();
        given.extend(std::iter::repeat_n(value == 1, (run >> 1) as usize));
    }
    assert_eq!(given.len(), rows);
    for given in given {
        cells.push(match (given, data.number(1)) {
            (false, _) => Cell::None,
            (true, 5) => {
                at += 8;
                Cell::Bits(longest(bytes, at - 8) as u64)
            }
            (true, 6) => {
                let length = long(bytes, at);
                at += 4 + length;
                Cell::Text(String::from_utf8(bytes[at - length..at].to_vec()).unwrap())
            }
            (_, other) => panic!("physical type {other}"),
        });
    }
    assert_eq!(at, end);
}

#[test]
fn every_format_holds_the_same_bits() {
    let place = Place::with(ROWS);
    place.done(&["run", "arm.toml", "--out", "csv", "--no-figures", "--quiet"]);
    let wanted = from_csv(&place.read("csv/results.csv"), &["motion.joints.q1"]);
    assert_eq!((wanted[0].1.len(), wanted[1].1[0].clone()), (72, Cell::Text("0.5*sin(2*t)".into())));
    assert!(wanted.iter().any(|(_, cells)| cells.contains(&Cell::None)));
    for (format, read) in [("parquet", from_parquet as fn(&[u8]) -> Columns), ("npz", from_npz)] {
        let ended = place.done(&["run", "arm.toml", "--out", format, "--no-figures", "--format", format]);
        assert!(ended.stdout.contains(&format!("results.{format}, summary.csv, run.json")), "{}", ended.stdout);
        let file = format!("results.{format}");
        let mut files = vec!["run.json", "summary.csv", &file];
        files.sort_unstable();
        assert_eq!(place.files(format), files);
        let found = read(&fs::read(place.path(format).join(&file)).unwrap());
        assert_eq!(found.len(), wanted.len());
        for (found, wanted) in found.iter().zip(&wanted) {
            assert_eq!(found, wanted, "{format}");
        }
        let record = place.record(format);
        assert_eq!((&record["format"], &record["files"][0]), (&format.into(), &file.as_str().into()));
        assert_eq!(place.read(place.path(format).join("summary.csv")), place.read("csv/summary.csv"));
    }
    assert_eq!(place.record("csv")["format"], "csv");
    // A rerun in another format leaves none of the last one.
    place.done(&["run", "arm.toml", "--out", "npz", "--no-figures", "--format", "parquet", "--quiet"]);
    assert_eq!(place.files("npz"), ["results.parquet", "run.json", "summary.csv"]);
}

#[test]
fn many_rows_make_several_groups_and_pieces() {
    let place = Place::new();
    let sets = ["--set", "time.end=0.45", "--set", "time.output_step=0.00001", "--no-figures", "--quiet"];
    let run =
        |format: &str| place.done(&[&["run", "arm.toml", "--out", format, "--format", format], &sets[..]].concat());
    run("csv");
    let wanted = from_csv(&place.read("csv/results.csv"), &[]);
    assert_eq!(wanted[0].1.len(), 45_001);
    run("parquet");
    let bytes = fs::read(place.path("parquet/results.parquet")).unwrap();
    assert!(from_parquet(&bytes) == wanted);
    run("npz");
    assert!(from_npz(&fs::read(place.path("npz/results.npz")).unwrap()) == wanted);
}

#[test]
fn mistyped_formats_are_refused() {
    let place = Place::new();
    let refused = place.springpot(&["run", "arm.toml", "--format", "parket"]);
    assert!(
        refused.code == Some(2) && refused.stderr.contains("did you mean parquet? there is csv"),
        "{}",
        refused.stderr
    );
    assert!(!place.path("results").exists());
    let refused = place.springpot(&["run", "--resume", "results/arm", "--format", "npz"]);
    assert!(refused.code == Some(2) && refused.stderr.contains("cannot be used with"), "{}", refused.stderr);
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_has_its_rows_in_the_format() {
    let place = Place::new();
    let interrupted = |more: &[&str]| {
        let arguments =
            [&["run", "arm.toml", "--out", "o", "--format", "npz", "--no-figures", "--quiet"], &ENDLESS[..], more]
                .concat();
        let mut child = place.command(&arguments).stderr(Stdio::null()).spawn().unwrap();
        wait_for("rows", || length(place.path("o/results.csv.part")) >= 1_500);
        signal(&child, "-INT");
        assert_eq!(child.wait().unwrap().code(), Some(130));
    };
    interrupted(&[]);
    assert_eq!(place.files("o"), ["results.npz", "run.json", "summary.csv"]);
    let columns = from_npz(&fs::read(place.path("o/results.npz")).unwrap());
    assert!(columns.iter().all(|(_, cells)| cells.len() == columns[0].1.len() && cells.len() > 1));
    // What can be gone on with stays text until it has come to its end.
    interrupted(&["--checkpoint-every", "0.001"]);
    assert!(place.path("o/results.csv").exists() && !place.path("o/results.npz").exists());
    assert_eq!(place.record("o")["format"], "csv");
}
