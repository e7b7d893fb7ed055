//! `springpot master`: master curves from tables.

use crate::support::{Csv, Place, testdata};
use serde_json::Value;

fn record() -> String {
    std::fs::read_to_string(testdata("dma/fractional_zener_wlf.csv")).unwrap()
}

fn place() -> Place {
    let place = Place::new();
    place.write("dma.csv", record());
    place
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value}"))
}

#[test]
fn a_master_curve_its_files_and_its_line() {
    let place = place();
    let page = place.done(&["master", "dma.csv", "--reference", "20 degC"]).stdout;
    for words in [
        "master curve at 293.15 K, 20 degC",
        "144 rows at 9 temperatures",
        "BIC prefers wlf",
        "shift = { kind = \"wlf\", C1 = ",
    ] {
        assert!(page.contains(words), "{words}: {page}");
    }
    assert_eq!(place.files("results/dma"), ["master.csv", "master.json", "master.svg", "shifts.csv", "shifts.svg"]);
    let answer: Value = serde_json::from_str(&place.read("results/dma/master.json")).unwrap();
    for (name, exact) in [("C1", 12.0), ("C2", 80.0)] {
        let (value, sd) = (number(&answer["wlf"][name]), number(&answer["wlf"]["sd"][name]));
        assert!((value - exact).abs() < 3.0 * sd && sd < 0.1 * exact, "{name}: {value} ± {sd}");
    }
    let shifts = Csv::new(&place.read("results/dma/shifts.csv"));
    let [t, log_a, sd, log_b] = ["T", "log10_a_T", "sd", "log10_b_T"].map(|name| shifts.numbers(name));
    assert_eq!((t.len(), t[4], log_a[4], sd[4]), (9, 293.15, 0.0, 0.0));
    for k in 0..9 {
        let exact = -12.0 * (t[k] - 293.15) / (80.0 + t[k] - 293.15);
        assert!(
            (log_a[k] - exact).abs() <= 3.0 * sd[k] && sd[k] < 0.05 && log_b[k] == 0.0,
            "{}: {} ± {}",
            t[k],
            log_a[k],
            sd[k]
        );
    }
    let rows = Csv::new(&place.read("results/dma/master.csv"));
    let hertz = rows.numbers("frequency [Hz]");
    assert!(hertz.len() == 144 && hertz.windows(2).all(|pair| pair[0] <= pair[1]));
    // The curve goes into `laws --from` as it is; and the line into an element.
    let again = place.done(&[
        "laws",
        "fractional-zener",
        "--from",
        "results/dma/master.csv",
        "--area",
        "1",
        "--length",
        "1",
        "--json",
    ]);
    let with = place.done(&[
        "master",
        "dma.csv",
        "--reference",
        "20 degC",
        "--law",
        "fractional-zener",
        "--out",
        "m",
        "--json",
    ]);
    let [again, with]: [Value; 2] = [again, with].map(|ended| serde_json::from_str(&ended.stdout).unwrap());
    for (name, exact) in [("k_e", 2e6), ("k_m", 1.5e9), ("c", 4e7), ("alpha", 0.5)] {
        let (value, sd) = (number(&with["law"]["parameters"][name]), number(&with["law"]["sd"][name]));
        assert!((value - exact).abs() < 4.0 * sd && sd < 0.1 * exact, "{name}: {value} ± {sd}");
        assert!((number(&again["parameters"][name]) / value - 1.0).abs() < 1e-6, "{name}");
    }
    assert_eq!(with["shift"], answer["shift"]);
}

#[test]
fn tables_as_they_come() {
    let place = place();
    let json = |file: &str, more: &[&str]| -> Value {
        let arguments = [&["master", file, "--reference", "20 degC", "--json"], more].concat();
        serde_json::from_str(&place.done(&arguments).stdout).unwrap()
    };
    let plain = json("dma.csv", &[]);
    let cells = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
    let rows: Vec<Vec<String>> = record().lines().skip(1).map(cells).collect();
    let number = |cell: &str| cell.parse::<f64>().unwrap();
    let table = |head: &str, of: &dyn Fn(&[String]) -> String| {
        [head.to_owned()].into_iter().chain(rows.iter().map(|row| of(row))).collect::<Vec<_>>().join("\n")
    };
    // |E*| and tan δ, K, decimal commas, and a row of units below the names.
    place.write(
        "kelvin.csv",
        table("freq;modulus [Pa];tan_delta;T", &|row| {
            let (storage, loss) = (1e6 * number(&row[1]), 1e6 * number(&row[2]));
            format!("{};{};{};{}", row[0], storage.hypot(loss), loss / storage, number(&row[3]) + 273.15)
                .replace('.', ",")
        }),
    );
    place.write(
        "units.csv",
        format!(
            "\u{feff}{}",
            table("f,E_stor,E_loss,T,Set\nHz, MPa, MPa, C, -", &|row| format!("{},0", row.join(",")))
        ),
    );
    for file in ["kelvin.csv", "units.csv"] {
        let found = json(file, &[]);
        for (own, other) in found["shifts"].as_array().unwrap().iter().zip(plain["shifts"].as_array().unwrap()) {
            let [own, other] = [own, other].map(|one| one["log10_a_T"].as_f64().unwrap());
            assert!((own - other).abs() < 1e-6, "{file}: {own} {other}");
        }
    }
    let text = record();
    let spoiled = text.lines().enumerate().map(|(k, line)| {
        let cells: Vec<&str> = line.split(',').collect();
        match k {
            3 => format!("{},NaN,{},{}\n", cells[0], cells[2], cells[3]),
            40 => format!("{},{},{},\n", cells[0], cells[1], cells[2]),
            _ => format!("{line}\n"),
        }
    });
    place.write("holes.csv", spoiled.collect::<String>());
    let ended = place.springpot(&["master", "holes.csv", "--reference", "20 degC", "--json"]);
    ended.says(&["2 rows with empty cells left out"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let vertical = json("dma.csv", &["--vertical"]);
    let rise = &vertical["shifts"][0];
    assert!(rise["log10_b_T"].as_f64().unwrap().abs() < 4.0 * rise["sd_b"].as_f64().unwrap(), "{rise}");
    assert!(place.read("results/dma/shifts.csv").starts_with("T,log10_a_T,sd,log10_b_T,sd_b\n"));
}

#[test]
fn what_is_refused_and_what_fails() {
    let place = place();
    let all = record();
    let keep = |name: &str, temperatures: &[&str]| {
        let rows =
            all.lines().filter(|line| line.ends_with(']') || temperatures.contains(&line.rsplit(',').next().unwrap()));
        place.write(name, rows.collect::<Vec<_>>().join("\n"));
    };
    let ends = |file: &str, reference: &str, code: i32, words: &[&str]| {
        let ended = place.springpot(&["master", file, "--reference", reference]);
        ended.ends(code, words);
        assert_eq!(ended.stdout, "");
    };
    keep("apart.csv", &["0", "5", "35", "40"]);
    ends(
        "apart.csv",
        "5 degC",
        1,
        &["the curves at 278.15 K and 308.15 K do not overlap", "measure at temperatures between"],
    );
    keep("one.csv", &["20"]);
    ends("one.csv", "20 degC", 2, &["all rows are at one temperature, 293.15 K", "laws --from"]);
    ends("dma.csv", "20", 2, &["--reference 20: 20 K", "'20 degC'"]);
    ends("dma.csv", "warm", 2, &["--reference warm"]);
    ends("dma.csv", "60 degC", 2, &["outside of what was measured, 273.15 K to 313.15 K"]);
    ends("none.csv", "20 degC", 2, &["none.csv"]);
    place.write("bare.csv", all.replace("T [degC]", "T"));
    ends("bare.csv", "20 degC", 2, &["bare.csv:2: T is 0", "name the column T [degC]"]);
    place.write("cold.csv", all.replace(",T [degC]", ",U"));
    ends("cold.csv", "20 degC", 2, &["no column is the temperature", "T [degC]"]);
    place.write("second.csv", all.replace("T [degC]", "T [s]"));
    ends("second.csv", "20 degC", 2, &["\"s\" is no unit of a temperature"]);
    place.write("text.csv", all.replacen("0.158489,", "0.158489,x", 1));
    ends("text.csv", "20 degC", 2, &["text.csv:3"]);
    place.write("minus.csv", all.replacen("0.158489,", "0.158489,-", 1));
    ends("minus.csv", "20 degC", 2, &["minus.csv:3", "must be positive"]);
    place.write("empty.csv", "");
    ends("empty.csv", "20 degC", 2, &["empty.csv"]);
    place.write("head.csv", all.lines().next().unwrap());
    ends("head.csv", "20 degC", 2, &["head.csv"]);
    let ended = place.springpot(&["master", "dma.csv", "--reference", "20 degC", "--law", "pringpot"]);
    ended.ends(2, &["there is no law \"pringpot\"", "springpot"]);
    keep("two.csv", &["20", "25"]);
    let two = place.done(&["master", "two.csv", "--reference", "22 degC"]).stdout;
    assert!(two.contains("BIC prefers arrhenius") && !two.contains("wlf"), "{two}");
}
