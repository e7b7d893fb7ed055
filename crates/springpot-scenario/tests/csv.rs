//! CSV files as tables of numbers, and what is refused in them.

use proptest::prelude::*;
use proptest::test_runner::{RngSeed, TestRunner};
use springpot::signal::Signal;
use springpot_scenario::csv::{CsvProblem, CsvRows, CsvTable};

fn config(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, rng_seed: RngSeed::Fixed(11), failure_persistence: None, ..ProptestConfig::default() }
}

fn table(text: &str) -> Result<CsvTable, CsvProblem> {
    CsvTable::from_bytes("motion.csv", text.as_bytes(), "t").map_err(|error| error.problem)
}

#[test]
fn reads_several_columns_at_once() {
    for text in [
        "t,q1,q2\n0,1,2\n0.5,3,4e-1\n1,5,6\n",
        "\u{feff}t,q1,q2\r\n0,1,2\r\n0.5,3,4e-1\r\n1,5,6",
        "\"t\", q1 ,q2\n\n 0 ,1,2\n0.5,\"3\",0.4\n   \n+1,5,6\n\n",
        "q2,t,q1\n2,0,1\n.4,.5,3\n6,1,5\n",
    ] {
        let read = table(text).unwrap();
        assert_eq!(read.time(), [0.0, 0.5, 1.0]);
        assert_eq!(read.column("q1").unwrap(), [1.0, 3.0, 5.0]);
        assert_eq!(read.column("q2").unwrap(), [2.0, 0.4, 6.0]);
        assert_eq!(read.headers().len(), 3);
    }
}

#[test]
fn a_column_nobody_asks_for_may_hold_text() {
    let read = table("t,label,q1\n0,start,1\n1,end,2\n").unwrap();
    assert_eq!(read.column("q1").unwrap(), [1.0, 2.0]);
    let error = read.column("label").unwrap_err();
    assert_eq!(error.to_string(), "motion.csv:2: `start` in column 2 (`label`) is not a number");
}

#[test]
fn refusals_say_where_and_what_would_be_right() {
    for (text, says) in [
        ("", "motion.csv: the file is empty"),
        ("\n\n", "motion.csv: the file is empty"),
        ("t,q1\n", "motion.csv:1: 0 rows of numbers; at least two"),
        ("\nt,q1\n0,1\n\n", "motion.csv:3: 1 rows of numbers; at least two"),
        ("0,1\n1,2\n2,3\n", "motion.csv:1: the first row must name the columns, but it starts with the number 0"),
        (
            "t;q1\n0;1\n1;2\n",
            "motion.csv:1: columns must be separated by commas, but the header has ';' as character 2",
        ),
        ("t,q1,\n0,1,\n1,2,\n", "motion.csv:1: column 3 has no name"),
        ("\n\nt,q1,q1\n0,1,1\n1,2,2\n", "motion.csv:3: columns 2 and 3 are both called `q1`"),
        ("time,q1\n0,1\n1,2\n", "motion.csv:1: no column `t`; did you mean `time`?; the columns are time, q1"),
        ("t,q1\n0,1\n1\n", "motion.csv:3: 1 cells, but the header has 2"),
        ("t,q1\n\n\n0,1\n\n1,2,3", "motion.csv:6: 3 cells"),
        ("\n\nt,q1\n0,1\n\n1,2,3", "motion.csv:6: 3 cells"),
        ("t,q1\r\n0,1\r\n\r\n1,2,3\r\n", "motion.csv:4: 3 cells, but the header has 2"),
        ("t,q1\n0,1\n1,x\n", "motion.csv:3: `x` in column 2 (`q1`) is not a number"),
        ("t,q1\n0,1\n1,\n", "motion.csv:3: column 2 (`q1`) is empty"),
        ("t,q1\n0,NaN\n1,1\n", "motion.csv:2: `NaN` in column 2 (`q1`) is not a finite number"),
        ("t,q1\n0,1e999\n1,1\n", "`1e999` in column 2 (`q1`) is not a finite number"),
        ("t,q1\n0,1\ninf,1\n", "motion.csv:3: `inf` in column 1 (`t`) is not a finite number"),
        ("t,q1\nzero,1\n1,1\n", "motion.csv:2: `zero` in column 1 (`t`) is not a number"),
        ("t,q1\n0,1\n1,1\n1,2\n", "motion.csv:4: times must increase, but 1 follows 1"),
        ("t,q2\n0,1\n1,1\n", "motion.csv:1: no column `q1`; did you mean `q2`?; the columns are t, q2"),
    ] {
        let read = CsvTable::from_bytes("motion.csv", text.as_bytes(), "t");
        let error = read.and_then(|read| read.column("q1").map(<[f64]>::to_vec)).expect_err(text);
        assert!(error.to_string().contains(says), "{text:?}: {error}");
    }
    let latin = CsvTable::from_bytes("motion.csv", b"t,q1\n0,1\n1,\xb5\n", "t").unwrap_err();
    assert_eq!((latin.problem.line(), latin.problem.column()), (Some(3), Some(2)));
    assert!(matches!(latin.problem, CsvProblem::NotUtf8 { .. }));
    let utf16 = CsvTable::from_bytes("motion.csv", b"\xff\xfet\0,\0q\0\n\0", "t").unwrap_err();
    assert!(matches!(utf16.problem, CsvProblem::NotUtf8 { line: 1, column: 1 }));
    let line = "t,x\n\n0,".to_owned() + &"1".repeat(2 << 20);
    assert!(matches!(table(&line), Err(CsvProblem::LongLine { line: 3, .. })));
    let mut rows = CsvRows::new(line.as_bytes()).unwrap();
    assert!(matches!(rows.next_row(), Err(CsvProblem::LongLine { line: 3, .. })));
}

#[test]
fn files() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("T.csv");
    std::fs::write(&path, "time,T\n0,20\n60,25\n").unwrap();
    let read = CsvTable::read_with_time(&path, "time").unwrap();
    assert_eq!((read.time(), read.column("T").unwrap()), (&[0.0, 60.0][..], &[20.0, 25.0][..]));
    assert_eq!(read.file(), path);
    assert!(matches!(CsvTable::read(&path).unwrap_err().problem, CsvProblem::MissingColumn { .. }));
    let absent = CsvTable::read(folder.path().join("none.csv")).unwrap_err();
    assert!(matches!(absent.problem, CsvProblem::Unreadable { .. }) && absent.to_string().contains("none.csv"));
    assert!(matches!(CsvTable::read(folder.path()).unwrap_err().problem, CsvProblem::NotAFile));
}

fn bytes() -> impl Strategy<Value = Vec<u8>> {
    let fragments = vec![
        "t",
        ",",
        ",",
        "\n",
        "\n",
        "\r\n",
        "q1",
        "0",
        "1",
        "2.5",
        "1e9",
        "-",
        "\"",
        " ",
        "nan",
        "\u{feff}",
        ";",
        "t,q1\n0,1\n",
        "\u{0}",
        "\u{b5}",
        "9e999",
    ];
    let pieces = prop::collection::vec(prop::sample::select(fragments), 0..40);
    let table = prop::collection::vec((0..100_u32, any::<f64>()), 0..12).prop_map(|rows| {
        let rows: String = rows.iter().enumerate().map(|(i, (t, x))| format!("{},{x}\n", i as u32 * 90 + t)).collect();
        format!("t,q1\n{rows}")
    });
    let mutated = (table.clone(), any::<prop::sample::Index>(), any::<u8>()).prop_map(|(text, index, byte)| {
        let mut bytes = text.into_bytes();
        let at = index.index(bytes.len());
        bytes[at] = byte;
        bytes
    });
    prop_oneof![
        prop::collection::vec(any::<u8>(), 0..200),
        pieces.prop_map(|pieces| pieces.concat().into_bytes()),
        table.prop_map(String::into_bytes),
        mutated,
    ]
}

/// Gives its bytes a few at a time.
struct Trickle<'a>(&'a [u8], usize);

impl std::io::Read for Trickle<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let count = self.1.min(self.0.len()).min(buffer.len());
        let (now, later) = self.0.split_at(count);
        buffer[..count].copy_from_slice(now);
        (self.0, self.1) = (later, self.1 % 7 + 1);
        Ok(count)
    }
}

/// A row with its line.
type Row = (u64, Vec<Vec<u8>>);

/// Every row, and what is wrong behind the last one.
fn rows_of(reader: impl std::io::Read) -> (Vec<Row>, String) {
    let mut read = Vec::new();
    let mut rows = match CsvRows::new(reader) {
        Ok(rows) => rows,
        Err(problem) => return (read, problem.to_string()),
    };
    loop {
        match rows.next_row() {
            Ok(Some(row)) => read.push((row.line(), row.cells().map(<[u8]>::to_vec).collect())),
            Ok(None) => return (read, format!("ends behind line {}", rows.line())),
            Err(problem) => return (read, problem.to_string()),
        }
    }
}

/// Quotes in the header have all of the file read with quotes, by another reader.
#[test]
fn lines_are_split_as_files_with_quotes_are() {
    let (mut runner, long) = (TestRunner::new(config(3_000)), std::cell::Cell::new(0));
    let outcome = runner.run(&(bytes(), 1..8_usize), |(bytes, few)| {
        let [plain, quoted] = [&b"t,q1\n"[..], b"\"t\",q1\n"].map(|header| [header, &bytes].concat());
        let rows = rows_of(Trickle(&plain, few));
        long.set(long.get() + usize::from(rows.0.len() > 2));
        prop_assert_eq!(&rows, &rows_of(&quoted[..]));
        prop_assert_eq!(&rows, &rows_of(&plain[..]));
        Ok(())
    });
    if let Err(error) = outcome {
        panic!("{error}");
    }
    assert!(long.get() > 300, "only {} files have rows", long.get());
    for text in ["\u{feff}# \"a\n t , x \n\n1, 2\r\n#3,4\n 5,\"6\n7\"\n8,9", "\u{feff}"] {
        let rows = rows_of(Trickle(text.as_bytes(), 1));
        let cells = |row: &[&str]| row.iter().map(|cell| cell.as_bytes().to_vec()).collect::<Vec<_>>();
        let expected = [(4, cells(&["1", "2"])), (7, cells(&["5", "6\n7"])), (8, cells(&["8", "9"]))];
        assert_eq!(rows.0, expected[..if text.len() > 9 { 3 } else { 0 }], "{rows:?}");
    }
}

fn never_panics(cases: u32) {
    let accepted = std::cell::Cell::new(0_u32);
    let mut runner = TestRunner::new(config(cases));
    let outcome = runner.run(&bytes(), |bytes| {
        match CsvTable::from_bytes("x.csv", &bytes, "t") {
            Ok(read) => {
                accepted.set(accepted.get() + 1);
                prop_assert!(read.time().windows(2).all(|w| w[0] < w[1]));
                for name in read.headers() {
                    if let Ok(column) = read.column(name) {
                        prop_assert_eq!(column.len(), read.time().len());
                        prop_assert!(Signal::spline(read.time(), column).is_ok());
                        prop_assert!(Signal::linear(read.time(), column).is_ok());
                    }
                }
            }
            Err(error) => prop_assert!(error.to_string().starts_with("x.csv")),
        }
        Ok(())
    });
    if let Err(error) = outcome {
        panic!("{error}");
    }
    assert!(accepted.get() > cases / 10, "only {} tables of {cases} were accepted", accepted.get());
}

#[test]
fn never_panics_on_any_bytes() {
    never_panics(10_000);
}

#[test]
#[ignore = "a minute"]
fn never_panics_on_a_million_files() {
    never_panics(1_000_000);
}
