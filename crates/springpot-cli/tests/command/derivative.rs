//! `springpot derivative`: files in, derivatives out.

use crate::support::{Csv, Ended, Place, testdata};
use serde_json::Value;
use std::io::Write;
use std::process::Stdio;

/// `t,x` with x = f(t) at k·h.
fn samples(count: usize, h: f64, f: impl Fn(f64) -> f64) -> String {
    let rows = (0..count).map(|k| k as f64 * h).map(|t| format!("{t},{}\n", f(t)));
    format!("t,x\n{}", rows.collect::<String>())
}

/// The command with `text` on its standard input.
fn piped(place: &Place, arguments: &[&str], text: &[u8]) -> Ended {
    let mut command = place.command(arguments);
    let mut child =
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
    let mut input = child.stdin.take().expect("a pipe");
    let text = text.to_owned();
    let writer = std::thread::spawn(move || {
        // A command that has seen enough closes the pipe.
        let _ = input.write_all(&text);
    });
    let ended = Ended::from(child.wait_with_output().expect("it ends"));
    writer.join().expect("it writes");
    ended
}

/// Largest difference, in units of the largest value of `b`.
fn gap(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    largest(&mut a.iter().zip(b).map(|(a, b)| (a - b).abs())) / largest(&mut b.iter().map(|b| b.abs()))
}

#[test]
fn the_reference_values_from_forty_thousand_samples() {
    let oracle: Value =
        serde_json::from_str(&std::fs::read_to_string(testdata("fractional/derivatives.json")).unwrap()).unwrap();
    let number = |value: &Value| value.as_str().expect("a decimal text").parse::<f64>().unwrap();
    let place = Place::new();
    let mut compared = 0;
    for (name, f) in [
        ("0.7*sin(8t)+0.1*t", Box::new(|t: f64| 0.7 * (8.0 * t).sin() + 0.1 * t) as Box<dyn Fn(f64) -> f64>),
        ("exp(-t)", Box::new(|t: f64| (-t).exp())),
        ("1+sin(3t)", Box::new(|t: f64| 1.0 + (3.0 * t).sin())),
        ("cos(3t)", Box::new(|t: f64| (3.0 * t).cos())),
    ] {
        let Some(rows) = oracle["functions"].get(name).and_then(Value::as_array) else {
            panic!("no {name} among {:?}", oracle["functions"].as_object().unwrap().keys())
        };
        place.write("x.csv", samples(40_001, 2.5e-4, f));
        let mut orders: Vec<&str> = rows.iter().map(|row| row["alpha"].as_str().unwrap()).collect();
        orders.sort_unstable();
        orders.dedup();
        let mut arguments = vec!["derivative", "x.csv", "--column", "x"];
        orders.iter().for_each(|order| arguments.extend(["--order", order]));
        for (kind, key) in [("caputo", "caputo"), ("riemann-liouville", "rl"), ("grunwald-letnikov", "rl")] {
            let ended = place.done(&[&arguments[..], &["--kind", kind]].concat());
            let table = Csv::new(&ended.stdout);
            for order in &orders {
                let values = table.numbers(&format!("D^{order} x"));
                let wanted = rows.iter().filter(|row| row["alpha"] == **order);
                let wanted: Vec<(f64, f64)> = wanted.map(|row| (number(&row["t"]), number(&row[key]))).collect();
                let within = wanted.iter().filter(|(t, _)| *t <= 10.0);
                let largest = within.clone().map(|(_, d)| d.abs()).fold(0.0, f64::max);
                for (t, d) in within {
                    let at = (t / 2.5e-4).round();
                    assert!((at * 2.5e-4 - t).abs() < 1e-12, "{t} is no sample");
                    let error = (values[at as usize] - d).abs() / largest;
                    assert!(error < 1e-7, "{name}, {kind} {order} at {t}: {error:e}");
                    compared += 1;
                }
            }
        }
    }
    println!("{compared} numbers");
    assert!(compared > 300, "{compared}");
}

#[test]
fn columns_keep_their_text_and_their_order() {
    let place = Place::new();
    place.write("a.csv", "\u{feff}x, note ,time\r\n1.50,\"a, \"\"b\"\"\",0\r\n\r\n2,é,1e-1\r\n 3 ,,0.20\r\n4,d,.3\r\n");
    let ended = place.done(&["derivative", "a.csv", "--time", "time", "--column", "x", "--order", "-1"]);
    let lines: Vec<&str> = ended.stdout.lines().collect();
    assert_eq!(lines[0], "time,x,note,D^-1 x");
    assert!(lines[1].starts_with("0,1.50,\"a, \"\"b\"\"\",0"), "{}", lines[1]);
    assert!(lines[2].starts_with("1e-1,2,é,0.1687"), "{}", lines[2]);
    assert!(lines[3].starts_with("0.20,3,,") && lines[4].starts_with(".3,4,d,"), "{ended:?}");
    // Without --time and without a column t the first column is the time.
    place.write("b.csv", "s,x\n0,0\n1,1\n2,4\n3,9\n");
    let ended = place.done(&["derivative", "b.csv", "--column", "x", "--order", "1"]);
    let table = Csv::new(&ended.stdout);
    assert_eq!(table.header, ["s", "x", "D^1 x"]);
    assert!(gap(&table.numbers("D^1 x"), &[0.0, 2.0, 4.0, 6.0]) < 1e-12);
}

#[test]
fn singular_rows_are_empty() {
    let place = Place::new();
    place.write("x.csv", samples(200, 0.01, |t| 2.0 + t));
    let arguments = ["derivative", "x.csv", "--column", "x", "--order", "0.5", "--kind", "riemann-liouville"];
    for scheme in ["spline", "hermite", "exponential", "l1", "fbdf-3"] {
        let table = Csv::new(&place.done(&[&arguments[..], &["--scheme", scheme]].concat()).stdout);
        let texts = table.texts("D^0.5 x");
        assert!(texts[0].is_empty() && texts[1..].iter().all(|text| !text.is_empty()), "{scheme}");
    }
}

#[test]
fn a_stream_gives_the_numbers_of_the_whole() {
    let place = Place::new();
    let text = samples(3000, 0.003, |t| (5.0 * t).cos() + t.sqrt());
    place.write("x.csv", &text);
    let arguments = ["derivative", "x.csv", "--column", "x", "--order", "0.7", "--order", "-0.4", "--order", "1.5"];
    let whole = Csv::new(&place.done(&arguments).stdout);
    let piped_arguments = [&["derivative"], &arguments[2..], &["--scheme", "exponential"]].concat();
    let stream = Csv::new(&piped(&place, &piped_arguments, text.as_bytes()).stdout);
    assert_eq!(whole.header, stream.header);
    for order in ["0.7", "-0.4", "1.5"] {
        let name = format!("D^{order} x");
        let error = gap(&stream.numbers(&name), &whole.numbers(&name));
        assert!(error < 1e-10, "{order}: {error:e}");
    }
}

#[test]
fn equal_steps_may_be_rounded_and_start_anywhere() {
    let place = Place::new();
    let (h, exact) = (1.0 / 300.0, |t: f64| 2.0 * (t / std::f64::consts::PI).sqrt());
    let rows = (0..900).map(|k| k as f64 * h).map(|t| format!("{:.6},{}\n", 1e6 + t, t));
    place.write("x.csv", format!("t,x\n{}", rows.collect::<String>()));
    // A scheme for equal steps takes them, although they differ by 1e-6 s.
    let table =
        Csv::new(&place.done(&["derivative", "x.csv", "--column", "x", "--order", "0.5", "--scheme", "fbdf-2"]).stdout);
    let wanted: Vec<f64> = (0..900).map(|k| exact(k as f64 * h)).collect();
    let error = gap(&table.numbers("D^0.5 x"), &wanted);
    assert!(error < 1e-7, "{error:e}");
}

/// sin 20t at steps of 1 ms that are up to 3 µs off, times with seven decimals: the first one is "0" in one file.
#[test]
fn a_round_time_changes_nothing() {
    let place = Place::new();
    let files = ["jitter_0.csv", "jitter_0.0000000.csv"].map(|name| testdata(&format!("silent/{name}")));
    let texts = files.each_ref().map(|file| std::fs::read_to_string(file).unwrap());
    assert!(texts[0].starts_with("t,x\n0,") && texts[1].starts_with("t,x\n0.0000000,"));
    let exact = [("0.5", -4.392_917_638_728), ("1", -16.995_267_712_1), ("2", 210.865_715_937)];
    let mut arguments = vec!["--column", "x"];
    exact.iter().for_each(|(order, _)| arguments.extend(["--order", order]));
    for scheme in ["spline", "hermite", "exponential"] {
        let tables = files.each_ref().map(|file| {
            let ended = place.done(&[&["derivative", file, "--scheme", scheme], &arguments[..]].concat());
            Csv::new(&ended.stdout)
        });
        for (order, exact) in exact {
            let [a, b] = tables.each_ref().map(|table| table.texts(&format!("D^{order} x")));
            assert_eq!(a, b, "{scheme}, order {order}");
            let row = tables[0].texts("t").iter().position(|t| *t == "0.4990019").unwrap();
            let error = (a[row].parse::<f64>().unwrap() - exact).abs() / exact.abs();
            // The cubic's order is 4 − a in ωh = 0.02.
            let bound = if scheme == "hermite" { 0.02f64.powf(4.0 - order.parse::<f64>().unwrap()) } else { 1e-10 };
            assert!(error < bound, "{scheme}, order {order}: {error:e}");
        }
    }
    for file in &files {
        let ended = place.springpot(&["derivative", file, "--column", "x", "--order", "0.5", "--scheme", "fbdf-3"]);
        assert!(ended.code == Some(2) && ended.stderr.contains("fbdf-3 needs equal steps"), "{}", ended.stderr);
    }
}

/// The text of the time of a row, from its number and a draw below 7.
type TimeText = fn(u64, u64) -> String;

/// Whatever text stands for a number, as fixed decimals, exponents, trailing zeros, the derivative is the same to the bit.
#[test]
fn other_texts_of_the_same_times_change_nothing() {
    let place = Place::new();
    let mut seed = 0x9e37_79b9_7f4a_7c15_u64;
    let mut draw = |below: u64| {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        seed % below
    };
    let rewritten = |text: &str, choice: u64| {
        let number: f64 = text.parse().unwrap();
        match choice {
            0 => text.to_owned(),
            1 => number.to_string(),
            2 => format!("{number:e}"),
            3 if text.contains('.') => format!("{text}000"),
            3 => format!("{text}.0"),
            4 => format!("+{number:E}"),
            _ => format!("{number:.30}"),
        }
    };
    // Rounded, jittered by 3 units, by tenths of a step, whole, shortest.
    let times: [(&str, TimeText, bool); 5] = [
        ("rounded", |k, _| format!("{:.6}", k as f64 / 300.0), true),
        ("jittered", |k, off| format!("{:.6}", 0.004 * k as f64 + 1e-6 * (off as f64 - 3.0) + 1.0), false),
        ("random", |k, off| format!("{:.2}", k as f64 + 0.1 * (off as f64 - 3.0)), false),
        ("whole", |k, _| (500 + 20 * k).to_string(), true),
        ("shortest", |k, _| (0.1 * k as f64).to_string(), true),
    ];
    for (name, time, is_equal) in times {
        let texts: Vec<String> = (0..300).map(|k| time(k, draw(7))).collect();
        let mut results: Vec<(Option<i32>, Vec<String>)> = Vec::new();
        for round in 0..4 {
            let rows = texts.iter().enumerate().map(|(k, text)| {
                let text = rewritten(text, if round == 0 { 0 } else { draw(6) });
                format!("{text},{}\n", (0.05 * k as f64).sin())
            });
            place.write("x.csv", format!("t,x\n{}", rows.collect::<String>()));
            for scheme in ["spline", "hermite", "fbdf-3"] {
                let ended =
                    place.springpot(&["derivative", "x.csv", "--column", "x", "--order", "0.5", "--scheme", scheme]);
                assert_eq!(ended.code, Some(if is_equal || scheme != "fbdf-3" { 0 } else { 2 }), "{name}, {scheme}");
                let done = (ended.code == Some(0)).then(|| Csv::new(&ended.stdout));
                let column = done.iter().flat_map(|table| table.texts("D^0.5 x")).map(str::to_owned);
                results.push((ended.code, column.collect()));
            }
        }
        for round in results.chunks(3).skip(1) {
            assert_eq!(round, &results[..3], "{name}");
        }
    }
}

#[test]
fn an_estimate_stands_behind_every_derivative() {
    let place = Place::new();
    place.write("smooth.csv", samples(2000, 0.005, |t| (2.0 * t).sin()));
    place.write("kinked.csv", samples(2000, 0.005, |t| (t - 5.0).abs()));
    let largest = |file: &str| {
        let table = Csv::new(&place.done(&["derivative", file, "--column", "x", "--order", "0.5", "--error"]).stdout);
        assert_eq!(table.header, ["t", "x", "D^0.5 x", "error of D^0.5 x"]);
        table.numbers("error of D^0.5 x").into_iter().fold(0.0, f64::max)
    };
    let (smooth, kinked) = (largest("smooth.csv"), largest("kinked.csv"));
    assert!(smooth < 1e-10 && kinked > 1e-3, "{smooth:e} {kinked:e}");
}

#[test]
fn a_file_is_written_whole_or_not_at_all() {
    let place = Place::new();
    place.write("x.csv", samples(50, 0.1, |t| t));
    let ended = place.done(&["derivative", "x.csv", "--column", "x", "--order", "0.5", "--out", "d.csv"]);
    assert!(ended.stdout.is_empty() && ended.stderr.is_empty(), "{ended:?}");
    assert_eq!(place.table("d.csv").rows.len(), 50);
    place.write("bad.csv", "t,x\n0,1\n1,2\n2,?\n3,4\n");
    for scheme in ["spline", "exponential"] {
        let arguments =
            ["derivative", "bad.csv", "--column", "x", "--order", "0.5", "--out", "e.csv", "--scheme", scheme];
        assert_eq!(place.springpot(&arguments).code, Some(2));
        assert!(place.files(".").iter().all(|name| !name.starts_with("e.csv")), "{:?}", place.files("."));
    }
}

#[test]
fn mistakes_name_the_line() {
    let place = Place::new();
    let cases = [
        ("t,x\n0,1\n0.2,2\n0.1,3\n", "x.csv:4: times must increase, but 0.1 follows 0.2"),
        ("t,x\n0,1\n0.1,2\n\n0.1,3\n", "x.csv:5: times must increase, but 0.1 follows 0.1"),
        ("t,x\n0,1\n,2\n1,3\n", "x.csv:3: column 1 (`t`) is empty"),
        ("t,x\n0,1\n1,\n2,3\n", "x.csv:3: column 2 (`x`) is empty"),
        ("t,x\n0,1\n1,two\n2,3\n", "x.csv:3: `two` in column 2 (`x`) is not a number"),
        ("t,x\n0,1\n1,inf\n2,3\n", "x.csv:3: `inf` in column 2 (`x`) is not a finite number"),
        ("t,x\n0,1\n1,2,3\n", "x.csv:3: 3 cells, but the header has 2"),
        ("", "x.csv: the file is empty"),
        ("t,x\n", "x.csv:1: 0 rows of numbers"),
        ("t,x\n0,1\n", "x.csv:2: 1 rows of numbers"),
        ("t,x\n0,1\n1,2\n", "x.csv:3: 2 rows of numbers; at least three are needed"),
        ("0,1\n1,2\n", "x.csv:1: the first row must name the columns"),
        ("t;x\n0;1\n", "x.csv:1: columns must be separated by commas"),
        ("t,y\n0,1\n", "x.csv:1: no column `x`"),
    ];
    for (text, message) in cases {
        place.write("x.csv", text);
        for scheme in ["spline", "exponential"] {
            let ended =
                place.springpot(&["derivative", "x.csv", "--column", "x", "--order", "0.5", "--scheme", scheme]);
            assert_eq!(ended.code, Some(2), "{text:?}");
            assert!(ended.stderr.starts_with(&format!("error: {message}")), "{text:?}: {}", ended.stderr);
        }
    }
    place.write("x.csv", "t,x\n0,1\n1,2\n2.5,3\n3,4\n");
    let ended = place.springpot(&["derivative", "x.csv", "--column", "x", "--order", "0.5", "--scheme", "fbdf-2"]);
    assert!(ended.code == Some(2) && ended.stderr.contains("x.csv:4: fbdf-2 needs equal steps"), "{}", ended.stderr);
}

#[test]
fn what_no_number_holds_is_refused() {
    let place = Place::new();
    place.write("x.csv", "t,x\n0,0\n1e-250,2\n2e-250,3\n3e-250,5\n");
    let arguments = ["derivative", "x.csv", "--column", "x", "--order", "0.5"];
    place.springpot(&arguments).ends(2, &["x.csv:3: `D^0.5 x` is no finite number here"]);
    place.write("x.csv", "t,x\n0,0\n1e-9,1e308\n2e-9,-1e308\n3e-9,1e308\n");
    for scheme in ["spline", "exponential", "l1"] {
        let arguments = [&arguments[..], &["--scheme", scheme]].concat();
        let ended = place.springpot(&arguments);
        ended.ends(2, &["x.csv:", "`D^0.5 x` is no finite number here", "in other units"]);
        assert!(ended.stdout.is_empty(), "{scheme}: {}", ended.stdout);
    }
    // A jump from nothing is one without bound at the start.
    place.write("x.csv", "t,x\n0,1\n1,2\n2,3\n");
    let started = place.springpot(&[&arguments[..], &["--kind", "riemann-liouville"]].concat());
    assert!(started.code == Some(0) && started.stdout.contains("\n0,1,\n"), "{}", started.stdout);
}

#[test]
fn a_column_that_is_there_is_not_written_twice() {
    let place = Place::new();
    place.write("x.csv", "t,x,D^0.5 x,error of D^1 x\n0,1,0,0\n1,2,0,0\n2,3,0,0\n");
    let run = |more: &[&str]| place.springpot(&[&["derivative", "x.csv", "--column", "x"], more].concat());
    run(&["--order", "0.5"]).ends(2, &["x.csv: the file has a column `D^0.5 x` already", "name that column otherwise"]);
    run(&["--order", "1", "--error"]).ends(2, &["the file has a column `error of D^1 x` already"]);
    assert_eq!(run(&["--order", "1"]).code, Some(0));
}

#[test]
fn a_file_is_refused_before_its_first_row_is_written() {
    let place = Place::new();
    let text = samples(3000, 0.003, f64::sin);
    let arguments = ["derivative", "x.csv", "--column", "x", "--order", "0.7", "--scheme", "exponential"];
    #[cfg(unix)]
    std::os::unix::fs::symlink("/dev/stdout", place.path("stdout")).unwrap();
    for (mistake, words) in [
        ("9.1,?\n", "x.csv:3002: `?` in column 2 (`x`) is not a number"),
        ("1,1\n", "x.csv:3002: times must increase"),
        ("9.1\n", "x.csv:3002: 1 cells"),
        ("1e300,1\n", "x.csv:3002: "),
    ] {
        place.write("x.csv", format!("{text}{mistake}"));
        let outs = [&[][..], &["--out", "stdout"]];
        for out in &outs[..if cfg!(unix) { 2 } else { 1 }] {
            let refused = place.springpot(&[&arguments[..], out].concat());
            assert_eq!((refused.code, refused.stdout.as_str()), (Some(2), ""), "{mistake}: {}", refused.stderr);
            assert!(refused.stderr.contains(words), "{mistake}: {}", refused.stderr);
        }
    }
    // Of a pipe the rows before the mistake are out, whole ones alone.
    let piped_arguments = [&["derivative"], &arguments[2..]].concat();
    let refused = piped(&place, &piped_arguments, format!("{text}9.1,?\n").as_bytes());
    assert_eq!(refused.code, Some(2));
    assert!(refused.stderr.starts_with("error: standard input:3002: `?`"), "{}", refused.stderr);
    assert_eq!(Csv::new(&refused.stdout).rows.len(), 2997);
    let refused = piped(&place, &piped_arguments, b"t,x\n0,1\n1,2\n2,?\n");
    assert_eq!((refused.code, refused.stdout.as_str()), (Some(2), ""), "{}", refused.stderr);
}

#[test]
fn wrong_arguments() {
    let place = Place::new();
    place.write("x.csv", samples(20, 0.1, |t| t));
    for (arguments, message) in [
        (&["--column", "x", "--order", "2.5"][..], "the order 2.5 must lie between -2 and 2"),
        (&["--column", "x", "--order", "NaN"], "the order NaN must lie between -2 and 2"),
        (&["--column", "x", "--order", "half"], "--order half: not a value that it takes"),
        (&["--column", "x", "--order", "1", "--order", "1"], "--order 1 is given twice"),
        (&["--column", "x", "--column", "x", "--order", "1"], "--column x is given twice"),
        (&["--column", "t", "--order", "1"], "`t` is the time"),
        (&["--column", "x", "--order", "1", "--time", "s"], "no column `s`"),
        (&["--column", "x", "--order", "1", "--kind", "capto"], "caputo, riemann-liouville and grunwald-letnikov"),
        (
            &["--column", "x", "--order", "1", "--scheme", "l7"],
            "spline, hermite, exponential, grunwald-letnikov, grunwald-letnikov(N), l1",
        ),
        (&["--column", "x", "--order", "1", "--scheme", "exponential", "--error"], "estimated from all rows at once"),
        (&["--order", "1"], "`springpot derivative` lacks --column <NAME>"),
    ] {
        let ended = place.springpot(&[&["derivative", "x.csv"], arguments].concat());
        assert!(ended.code == Some(2) && ended.stderr.contains(message), "{arguments:?}: {}", ended.stderr);
        assert!(ended.stdout.is_empty(), "{arguments:?}");
    }
    let ended = place.springpot(&["derivative", "none.csv", "--column", "x", "--order", "1"]);
    assert!(ended.code == Some(2) && ended.stderr.starts_with("error: none.csv: cannot be read"), "{}", ended.stderr);
}

#[test]
fn mutated_files_end_in_numbers_or_in_a_refusal() {
    let place = Place::new();
    let whole = samples(40, 0.05, |t| (3.0 * t).sin()).into_bytes();
    let mut seed = 0x2545_f491_4f6c_dd1d_u64;
    let mut draw = |below: usize| {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        (seed % below as u64) as usize
    };
    for round in 0..60 {
        let mut bytes = whole.clone();
        for _ in 0..=draw(4) {
            let at = draw(bytes.len());
            match draw(4) {
                0 => bytes[at] = b",\n\"e-.0\xff9"[draw(9)],
                1 => drop(bytes.remove(at)),
                2 => bytes.insert(at, b",\n\"e-.0 9"[draw(9)]),
                _ => bytes.truncate(at.max(1)),
            }
        }
        let scheme = ["spline", "exponential", "hermite", "l1", "fbdf-3"][round % 5];
        let mut command = place.command(&["derivative", "-", "--column", "x", "--order", "0.5", "--scheme", scheme]);
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let _ = child.stdin.take().unwrap().write_all(&bytes);
        let output = child.wait_with_output().unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert!(!stderr.contains("panicked"), "{}\n{stderr}", String::from_utf8_lossy(&bytes));
        match output.status.code() {
            Some(0) => assert!(stderr.is_empty(), "{stderr}"),
            code => assert!(code == Some(2) && stderr.starts_with("error: standard input"), "{code:?} {stderr}"),
        }
    }
}

/// 400 MB pass through in little memory; some seconds.
#[test]
#[ignore = "takes long"]
fn a_large_file_streams() {
    let place = Place::new();
    let rows = 20_000_000_u64;
    let mut command = place.command(&["derivative", "--column", "x", "--order", "0.5", "--out", "d.csv"]);
    let mut child = command.stdin(Stdio::piped()).spawn().unwrap();
    let mut input = std::io::BufWriter::new(child.stdin.take().unwrap());
    input.write_all(b"t,x\n").unwrap();
    for k in 0..rows {
        let t = k as f64 * 1e-4;
        writeln!(input, "{t:.4},{:.12}", (0.01 * t).sin()).unwrap();
    }
    drop(input);
    assert!(child.wait().unwrap().success());
    let size = std::fs::metadata(place.path("d.csv")).unwrap().len();
    assert!(size > 20 * rows, "{size}");
}
