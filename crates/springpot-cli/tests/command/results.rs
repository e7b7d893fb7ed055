//! `springpot run` as a user types it: its files, columns, rows and numbers.

use crate::support::{Csv, Place};
use springpot_run::table::push_number;
use std::path::Path;

const COLUMNS: [&str; 27] = [
    "t",
    "q.q1",
    "q.x",
    "v.q1",
    "v.x",
    "a.q1",
    "a.x",
    "tau.q1",
    "tau.x",
    "damper.length",
    "damper.stroke",
    "damper.rate",
    "damper.derivative",
    "damper.force",
    "damper.Q.q1",
    "damper.Q.x",
    "damper.stored",
    "damper.dissipated",
    "damper.input",
    "damper.u",
    "gripper.x",
    "gripper.y",
    "gripper.z",
    "energy.kinetic",
    "energy.potential",
    "energy.actuators",
    "energy.residual",
];

const SWEEP: &str = "
[[sweep]]
parameter = \"element.damper.alpha\"
values = [0.2, 0.5]
[[sweep]]
parameter = [\"element.damper.mu\", \"element.damper.mu_0\"]
values = { from = 1, to = 3, count = 3 }
";

#[test]
fn a_run_writes_its_files_and_says_so() {
    let place = Place::with(&format!("{}\n[[figure]]\ny = [\"damper.Q.*\"]\n", crate::support::ARM));
    let ended = place.done(&["run", "arm.toml"]);
    let files = ["figures/figure-1.png", "figures/figure-1.svg", "results.csv", "run.json", "summary.csv"];
    assert_eq!(place.files("results/arm"), files);
    assert_eq!(
        place.files(""),
        ["arm.toml".to_owned()].into_iter().chain(files.map(|f| format!("results/arm/{f}"))).collect::<Vec<_>>()
    );
    assert_eq!(ended.stderr, "");
    let lines: Vec<&str> = ended.stdout.lines().collect();
    assert!(lines[0].starts_with("5 rows, ") && lines[0].ends_with(" s"), "{lines:?}");
    assert!(lines[1].starts_with("energy   balance closes to ") && lines[1].ends_with(" J turned over"), "{lines:?}");
    let results =
        format!("results  {}: results.csv, summary.csv, run.json, 1 figure (SVG and PNG)", path("results/arm"));
    assert_eq!(lines[2..], [results]);
}

fn path(path: &str) -> String {
    path.split('/').collect::<std::path::PathBuf>().display().to_string()
}

#[test]
fn columns_stand_in_the_order_of_the_format() {
    let place = Place::new();
    place.done(&["run", "arm.toml", "--no-figures"]);
    let results = place.table("results/arm/results.csv");
    assert_eq!(results.header, COLUMNS);

    let record = place.record("results/arm");
    let columns = record["columns"].as_array().unwrap();
    assert_eq!(columns.iter().map(|column| column["name"].as_str().unwrap()).collect::<Vec<_>>(), COLUMNS);
    let unit = |name: &str| columns[results.at(name)]["unit"].as_str().unwrap();
    assert_eq!(["q.q1", "q.x", "tau.q1", "tau.x"].map(unit), ["rad", "m", "N*m", "N"]);
    assert_eq!(["damper.derivative", "damper.u", "energy.residual", "t"].map(unit), ["m/s^alpha", "V", "J", "s"]);
    assert!(columns.iter().all(|column| !column["meaning"].as_str().unwrap().is_empty()));

    let (text, at) = (place.read("arm.toml"), place.read("arm.toml").find("[motion]").unwrap());
    let path = "[motion]\nkind = \"gripper-path\"\nx = \"0.5*cos(0.3*sin(t))\"\ny = 0\nz = \"0.5 + 0.5*sin(0.3*sin(t))\"\n[time]\nend = 0.1\noutput_step = 0.1\n";
    place.write("path.toml", format!("{}{path}", &text[..at]));
    place.done(&["run", "path.toml", "--set", "robot.body.arm.joint.damping=0.1"]);
    let header = place.table("results/path/results.csv").header;
    assert_eq!(header[..23], COLUMNS[..23]);
    let rest =
        ["gripper.error", "energy.kinetic", "energy.potential", "energy.actuators", "energy.joints", "energy.residual"];
    assert_eq!(header[23..], rest);
}

#[test]
fn rows_stand_at_multiples_of_the_step_and_at_the_end() {
    let place = Place::new();
    let times = |arguments: &[&str]| {
        place.done(&[&["run", "arm.toml", "--no-figures", "--quiet", "--out", "o"], arguments].concat());
        place.table("o/results.csv").numbers("t")
    };
    assert_eq!(times(&[]), [0.0, 0.1, 0.2, 0.3, 0.35]);
    // The last multiple is the end but for rounding.
    assert_eq!(times(&["--set", "time.end=0.3"]), [0.0, 0.1, 0.2, 0.3]);
    assert_eq!(times(&["--set", "time.output_step=10"]), [0.0, 0.35]);
    place.write(
        "at.toml",
        crate::support::ARM.replace("output_step = \"100 ms\"", "output_times = [\"50 ms\", 0.1, 0.35]"),
    );
    place.done(&["run", "at.toml"]);
    assert_eq!(place.table("results/at/results.csv").numbers("t"), [0.05, 0.1, 0.35]);
}

#[test]
fn numbers_read_back_to_the_same_bits() {
    let place = Place::new();
    place.done(&["run", "arm.toml", "--set", "time.output_step=0.01"]);
    let results = place.table("results/arm/results.csv");
    let mut cells = 0;
    for cell in results.rows.iter().flatten() {
        let mut again = String::new();
        push_number(&mut again, cell.parse().unwrap());
        assert_eq!(*cell, again);
        cells += 1;
    }
    assert_eq!(cells, 36 * COLUMNS.len());
    let (t, u) = (results.numbers("t"), results.numbers("damper.u"));
    for (t, u) in t.iter().zip(u) {
        assert!((u - (1.0 + 0.5 * (20.0 * t).sin())).abs() < 4e-16);
    }
    assert!(results.numbers("damper.stroke")[0].abs() < 1e-15);

    // The statistics are those of the rows.
    let summary = place.table("results/arm/summary.csv");
    assert_eq!(summary.header, ["column", "unit", "min", "max", "rms"]);
    assert_eq!(summary.texts("column"), COLUMNS);
    for (row, column) in summary.rows.iter().zip(COLUMNS) {
        let values = results.numbers(column);
        let extreme = |pick: fn(f64, f64) -> f64| values.iter().copied().reduce(pick).unwrap();
        assert_eq!(row[2].parse::<f64>().unwrap(), extreme(f64::min), "{column}");
        assert_eq!(row[3].parse::<f64>().unwrap(), extreme(f64::max), "{column}");
        let rms = (values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64).sqrt();
        assert!((row[4].parse::<f64>().unwrap() - rms).abs() <= 1e-15 * rms, "{column}");
    }
}

/// Columns that are empty in the first row, and in every row.
fn empty_columns(csv: &Csv) -> (Vec<&str>, Vec<&str>) {
    let empty = |rows: &[Vec<String>]| {
        let all = |k: &usize| rows.iter().all(|row| row[*k].is_empty());
        (0..csv.header.len()).filter(all).map(|k| csv.header[k].as_str()).collect()
    };
    for row in &csv.rows[1..] {
        let empty = (0..row.len()).filter(|k| row[*k].is_empty()).map(|k| csv.header[k].as_str());
        let always = ["damper.stored", "damper.dissipated", "energy.residual"];
        assert!(empty.clone().eq(empty.filter(|column| always.contains(column))));
    }
    (empty(&csv.rows[..1]), empty(&csv.rows))
}

#[test]
fn a_singular_start_leaves_its_cells_empty() {
    let place = Place::new();
    let results = |arguments: &[&str]| {
        let ended = place.done(&[&["run", "arm.toml"], arguments].concat());
        (place.table("results/arm/results.csv"), ended.stdout)
    };
    let singular = ["--set", "element.damper.derivative=riemann-liouville", "--set", "element.damper.rest_length=0.45"];
    let constant = ["--set", "element.damper.u=1.5"];
    let (csv, said) = results(&[&singular[..], &constant].concat());
    let (first, every) = empty_columns(&csv);
    let energies = ["damper.stored", "damper.dissipated", "energy.residual"];
    assert_eq!(every, energies);
    let infinite = ["tau.q1", "tau.x", "damper.derivative", "damper.force", "damper.Q.q1", "damper.Q.x"];
    assert_eq!(first, [&infinite[..], &energies].concat());
    assert!(said.contains("balance unknown: element \"damper\" starts with x(0) != 0"), "{said}");
    let record = place.record("results/arm");
    assert!(record["energy_residual"].is_null() && record["ledger"].as_str().unwrap().contains("damper"), "{record}");

    // A coefficient that varies has infinite work to do on an infinite energy.
    let (csv, _) = results(&singular);
    assert!(csv.texts("damper.input")[1..].iter().all(|cell| cell.is_empty()));

    // Neither a start from x = 0, nor Caputo, nor a whole order is singular.
    for regular in [&singular[..2], &singular[2..], &[&singular[..], &["--set", "element.damper.alpha=1"]].concat()] {
        let (csv, said) = results(regular);
        assert_eq!(empty_columns(&csv), (vec![], vec![]), "{regular:?}");
        assert!(said.contains("balance closes"), "{said}");
        assert!(place.record("results/arm")["ledger"].is_null());
    }

    // A named scheme keeps no account of energy.
    let (csv, said) = results(&["--set", "element.damper.scheme=l1"]);
    let unknown = ["damper.stored", "damper.dissipated", "damper.input", "energy.actuators", "energy.residual"];
    assert_eq!(empty_columns_of_scheme(&csv), unknown);
    assert!(said.contains("named scheme"), "{said}");
}

fn empty_columns_of_scheme(csv: &Csv) -> Vec<&str> {
    let all = |k: &usize| csv.rows[1..].iter().all(|row| row[*k].is_empty());
    (0..csv.header.len()).filter(all).map(|k| csv.header[k].as_str()).collect()
}

#[test]
fn sweeps_come_in_grid_order_for_any_number_of_jobs() {
    let place = Place::with(&format!("{}{SWEEP}", crate::support::ARM));
    let run = |jobs: &str| {
        let ended = place.done(&["run", "arm.toml", "--jobs", jobs, "--out", jobs]);
        assert!(ended.stdout.contains("\n6 cases, 30 rows, "), "{}", ended.stdout);
        (place.read(format!("{jobs}/results.csv")), place.read(format!("{jobs}/summary.csv")))
    };
    let one = run("1");
    assert!(run("2") == one && run("3") == one && run("500") == one);

    let results = Csv::new(&one.0);
    let swept = ["element.damper.alpha", "element.damper.mu", "element.damper.mu_0"];
    assert_eq!(results.header[..3], swept);
    assert_eq!(results.header[3..], COLUMNS);
    let grid: Vec<[&str; 3]> = results.rows.chunks(5).map(|case| [0, 1, 2].map(|k| case[0][k].as_str())).collect();
    let expected = ["0.2", "0.5"].into_iter().flat_map(|alpha| ["1", "2", "3"].map(|mu| [alpha, mu, mu]));
    assert_eq!(grid, expected.collect::<Vec<_>>());
    let summary = Csv::new(&one.1);
    assert_eq!(summary.header, [&swept[..], &["column", "unit", "min", "max", "rms"]].concat());
    assert_eq!(summary.rows.len(), 6 * COLUMNS.len());

    let record = place.record("1");
    assert_eq!((&record["status"], &record["t_reached"]), (&"done".into(), &0.35.into()));
    let cases = record["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 6);
    for (index, case) in cases.iter().enumerate() {
        assert_eq!((&case["index"], &case["status"], &case["rows"]), (&index.into(), &"done".into(), &5.into()));
        assert_eq!(case["parameters"]["element.damper.mu"], (index % 3 + 1) as f64);
    }
}

#[test]
fn a_case_of_a_sweep_is_the_run_alone() {
    let place = Place::with(&format!("{}{SWEEP}", crate::support::ARM));
    place.write("one.toml", crate::support::ARM);
    place.done(&["run", "arm.toml"]);
    let set = ["alpha=0.5", "mu=2", "mu_0=2"].map(|value| format!("element.damper.{value}"));
    let arguments = set.iter().flat_map(|set| ["--set", set.as_str()]);
    place.done(&["run", "one.toml"].into_iter().chain(arguments).collect::<Vec<_>>());
    let (all, one) = (place.table("results/arm/results.csv"), place.table("results/one/results.csv"));
    assert!(all.rows[20..25].iter().zip(&one.rows).all(|(all, one)| all[3..] == one[..]));
}

#[test]
fn swept_quantities_are_si_numbers_and_texts_stay() {
    let sweep = "[[sweep]]\nparameter = \"element.damper.rest_length\"\nvalues = [\"50 cm\", \"600 mm\"]\n\
                 [[sweep]]\nparameter = \"element.damper.scheme\"\nvalues = [\"exact\", \"l1\"]\n\
                 [[sweep]]\nparameter = \"element.damper.u\"\nvalues = [\"1.5 V\", \"sin(t)^2\"]\n";
    let place = Place::with(&format!("{}{sweep}", crate::support::ARM));
    let ended = place.done(&["run", "arm.toml"]);
    let results = place.table("results/arm/results.csv");
    let cases: Vec<String> = results.rows.chunks(5).map(|case| case[0][..3].join(" ")).collect();
    let expected = [
        "0.5 exact 1.5",
        "0.5 exact sin(t)^2",
        "0.5 l1 1.5",
        "0.5 l1 sin(t)^2",
        "0.6 exact 1.5",
        "0.6 exact sin(t)^2",
        "0.6 l1 1.5",
        "0.6 l1 sin(t)^2",
    ];
    assert_eq!(cases, expected);
    assert!(ended.stdout.contains("unknown in 4 cases: element \"damper\" has a named scheme"), "{}", ended.stdout);
}

#[test]
fn output_chooses_columns() {
    let place = Place::with(&format!(
        "{}\n[output]\ncolumns = [\"*.Q.x\", \"t\", \"q.*\", \"energy.r?sidual\"]\n",
        crate::support::ARM
    ));
    place.done(&["run", "arm.toml"]);
    let results = place.table("results/arm/results.csv");
    assert_eq!(results.header, ["t", "q.q1", "q.x", "damper.Q.x", "energy.residual"]);
    assert_eq!(place.table("results/arm/summary.csv").texts("column"), results.header);
    place.write("arm.toml", crate::support::ARM);
    place.done(&["run", "arm.toml", "--out", "all"]);
    let all = place.table("all/results.csv");
    for column in &results.header {
        assert_eq!(results.texts(column), all.texts(column));
    }
}

#[test]
fn a_rerun_replaces_its_own_files_and_no_others() {
    let place = Place::with(&format!("{}\n[[figure]]\nname = \"old\"\ny = \"damper.force\"\n", crate::support::ARM));
    let out = Path::new("here").join("and there");
    let out = out.to_str().unwrap();
    place.done(&["run", "arm.toml", "--out", out]);
    place.write("here/and there/notes.txt", "mine");
    place.write("here/and there/figures/mine.svg", "mine");
    place.write(
        "arm.toml",
        crate::support::ARM.replace("\n[motion]", "\n[[figure]]\nname = \"new\"\ny = \"t\"\n[motion]"),
    );
    place.done(&["run", "arm.toml", "--out", out]);
    let files = [
        "figures/mine.svg",
        "figures/new.png",
        "figures/new.svg",
        "notes.txt",
        "results.csv",
        "run.json",
        "summary.csv",
    ];
    assert_eq!(place.files(out), files);
    place.done(&["run", "arm.toml", "--no-figures", "--out", out]);
    assert_eq!(place.files(out), ["figures/mine.svg", "notes.txt", "results.csv", "run.json", "summary.csv"]);
    assert!(!place.path("results").exists());
}

#[test]
fn quiet_says_nothing() {
    let place = Place::with(&format!("{}\n[[figure]]\ny = \"damper.force\"\n", crate::support::ARM));
    for arguments in [&["run", "arm.toml", "--quiet"][..], &["run", "-q", "arm.toml"], &["check", "-q", "arm.toml"]] {
        let ended = place.done(arguments);
        assert_eq!((ended.stdout.as_str(), ended.stderr.as_str()), ("", ""));
    }
    assert!(place.path("results/arm/figures/figure-1.svg").exists());
}

#[test]
fn overrides_reach_the_record() {
    let place = Place::new();
    let set = ["--set", "element.damper.E_c=35 N/m", "--set", "title = Another", "--set", "solver.rtol=1e-6"];
    place.done(&[&["run", "arm.toml"], &set[..]].concat());
    let plan = &place.record("results/arm")["plan"];
    assert_eq!(plan["title"], "Another");
    assert_eq!(plan["elements"][0]["parameters"]["E_c"], 35.0);
    assert_eq!(plan["solver"]["rtol"], 1e-6);
    assert_eq!(plan["elements"][0]["derivative"], "caputo");
}

#[test]
fn windows_files_run_as_well() {
    let place = Place::with(&format!("\u{feff}{}", crate::support::ARM.replace('\n', "\r\n")));
    place.write("plain.toml", crate::support::ARM);
    place.done(&["run", "arm.toml"]);
    place.done(&["run", "plain.toml"]);
    assert_eq!(place.read("results/arm/results.csv"), place.read("results/plain/results.csv"));
}

#[test]
fn files_named_in_a_scenario_are_relative_to_it() {
    let place = Place::new();
    std::fs::create_dir(place.path("sub")).unwrap();
    let samples: String =
        (0..=40).map(|k| format!("{},{}\r\n", 0.01 * f64::from(k), 0.3 * f64::from(k) * 0.01)).collect();
    place.write("sub/u.csv", format!("\u{feff}t,u\r\n{samples}"));
    place.write(
        "sub/arm.toml",
        crate::support::ARM.replace("\"1 + 0.5*sin(20*t)\"", "{ csv = \"u.csv\", column = \"u\" }"),
    );
    place.done(&["run", "sub/arm.toml"]);
    let results = place.table("results/arm/results.csv");
    for (t, u) in results.numbers("t").iter().zip(results.numbers("damper.u")) {
        assert!((u - 0.3 * t).abs() < 1e-12);
    }
}
