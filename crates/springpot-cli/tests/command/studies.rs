//! Studies: constants, scalars by expression, rest lengths from the start, zipped sweeps, sweeps of the command line, components in paths.

use crate::support::{ARM, Place};

/// The arm with constants in its motion and its time.
fn with_constants() -> Place {
    let text = ARM
        .replace(
            "[robot.gripper]",
            "[constants]\nf = \"2 Hz\"\nA = \"5 mm\"\ncycles = 3\nperiod = { expression = \"1/f\" }\n\n[robot.gripper]",
        )
        .replace("0.05 - 0.05*cos(6*t)", "A - A*cos(2*pi*f*t)")
        .replace("end = 0.35", "end = { expression = \"cycles*period\", unit = \"s\" }")
        .replace("mass = \"500 g\"", "mass = { expression = \"500/cycles\", unit = \"g\" }")
        .replace("point = [0.1, 0, 0]", "point = [{ expression = \"20*A\", unit = \"m\" }, 0, 0]");
    Place::with(&text)
}

#[test]
fn constants_stand_in_expressions_and_in_scalars() {
    let place = with_constants();
    place.done(&["run", "arm.toml", "--quiet", "--out", "with"]);
    let plain = ARM
        .replace("0.05 - 0.05*cos(6*t)", "0.005 - 0.005*cos(2*pi*2*t)")
        .replace("end = 0.35", "end = 1.5")
        .replace("\"500 g\"", "0.16666666666666666");
    place.write("plain.toml", plain);
    place.done(&["run", "plain.toml", "--quiet", "--out", "plain"]);
    assert_eq!(place.read("with/results.csv"), place.read("plain/results.csv"));
    let plan = &place.record("with")["plan"];
    assert_eq!(plan["time"]["end"], 1.5);

    // A constant is swept and set like any other value, what it stands in follows.
    place.done(&[
        "run",
        "arm.toml",
        "--quiet",
        "--out",
        "swept",
        "--sweep",
        "constants.f=1 Hz,4 Hz",
        "--set",
        "constants.cycles=2",
    ]);
    let rows = place.table("swept/results.csv");
    let (f, t) = (rows.numbers("constants.f"), rows.numbers("t"));
    let last = |wanted: f64| t.iter().zip(&f).filter(|(_, f)| **f == wanted).map(|(t, _)| *t).fold(0.0, f64::max);
    assert_eq!((last(1.0), last(4.0)), (2.0, 0.5));
}

#[test]
fn what_is_wrong_with_constants_is_said() {
    let place = with_constants();
    for (set, words) in [
        ("constants.f=2 parsec", &["--set:1:15", "parsec"][..]),
        ("constants.pi=3", &["`pi` cannot be a constant: every expression knows it", "choose another name"]),
        ("constants.\"a b\"=3", &["`a b` is no name of a constant", "write a letter or _"]),
        ("constants.f=[1]", &["must be a number, a quantity"]),
        ("constants.period={ expression = \"1/g\" }", &["unknown name `g`", "the constants f, A and cycles"]),
        ("constants.f={ expression = \"2*t\" }", &["names t, and a number does not vary with time"]),
        ("time.end={ expression = \"cyles*period\" }", &["unknown name `cyles`; did you mean `cycles`?"]),
        ("time.end={ expression = \"3/f\", unit = \"m\" }", &["has another dimension than s"]),
        ("time.end={ expression = \"1/(f - 2)\" }", &["is inf, not a finite number"]),
        ("time.end={ expression = \"-period\" }", &["must be positive"]),
        ("time.end={ expression = \"3/f\", unti = \"s\" }", &["unknown key `unti`", "did you mean `unit`?"]),
        ("motion.joints.x=B*sin(t)", &["unknown name `B`"]),
    ] {
        let refused = place.springpot(&["check", "arm.toml", "--set", set]);
        let said = refused.said();
        assert_eq!(refused.code, Some(2), "{set}: {}", refused.stderr);
        words.iter().for_each(|words| assert!(said.contains(words), "{set}: {words:?} is not in {}", refused.stderr));
    }
}

#[test]
fn elements_rest_where_they_start() {
    // The stroke would be 3 mm at t = 0, and its Riemann–Liouville start singular.
    let place =
        Place::with(&ARM.replace("\"50 cm\"", "\"start\"").replace("0.05 - 0.05*cos(6*t)", "0.003 + 0.05*sin(6*t)"));
    let riemann = ["--set", "element.damper.derivative=riemann-liouville"];
    let prescribed = place.read("arm.toml");
    let joints = prescribed.find("kind = \"prescribed\"").unwrap()..prescribed.find("[time]").unwrap();
    for (motion, out) in [
        (&prescribed[joints.clone()], "prescribed"),
        ("kind = \"forward\"\nstart = { q = { x = 0.02 } }\n", "forward"),
        ("kind = \"forward\"\nprescribed = { x = \"0.03 + 0.01*sin(t)\" }\n", "followed"),
    ] {
        place.write("arm.toml", prescribed.replace(&prescribed[joints.clone()], motion));
        let ended = place.done(&[&["run", "arm.toml", "--out", out][..], &riemann].concat());
        let rows = place.table(format!("{out}/results.csv"));
        assert_eq!(rows.numbers("damper.stroke")[0], 0.0, "{out}");
        assert!(rows.numbers("energy.residual").iter().all(|x| x.is_finite()), "{out}: {}", ended.stderr);
        let rest = place.record(out)["plan"]["elements"][0]["rest_length"].as_f64().unwrap();
        assert_eq!(rest, rows.numbers("damper.length")[0], "{out}");
        let checked = place.done(&[&["check", "arm.toml"][..], &riemann].concat());
        assert!(
            !checked.stderr.contains("singular") && checked.stdout.contains("x(0) = 0"),
            "{out}: {}",
            checked.stdout
        );
    }
    // Each case of a sweep has its own.
    place.done(&["run", "arm.toml", "--quiet", "--out", "swept", "--sweep", "element.damper.from.point.2=0,0.1"]);
    let rows = place.table("swept/results.csv");
    let first: Vec<[f64; 2]> =
        (rows.numbers("t").iter().zip(rows.numbers("damper.stroke")).zip(rows.numbers("damper.length")))
            .filter(|((t, _), _)| **t == 0.0)
            .map(|((_, stroke), length)| [stroke, length])
            .collect();
    assert!(first[0][0] == 0.0 && first[1][0] == 0.0 && first[0][1] != first[1][1], "{first:?}");
    let refused = place.springpot(&["check", "arm.toml", "--set", "element.damper.rest_length=begin"]);
    assert!(
        refused.code == Some(2) && refused.stderr.contains("`rest_length` of element \"damper\""),
        "{}",
        refused.stderr
    );
}

#[test]
fn zipped_sweeps_give_every_path_its_own_value() {
    let sweep = "\n[[sweep]]\nparameter = [\"constants.f\", \"time.end\"]\nvalues = [[1, \"2 s\"], [4, \"500 ms\"]]\n";
    let place = with_constants();
    place.write("arm.toml", place.read("arm.toml") + sweep);
    place.done(&["run", "arm.toml", "--quiet", "--out", "zipped"]);
    let rows = place.table("zipped/results.csv");
    assert_eq!(&rows.header[..3], ["constants.f", "time.end", "t"]);
    let ends: Vec<[f64; 2]> =
        rows.numbers("constants.f").into_iter().zip(rows.numbers("time.end")).map(|(f, end)| [f, end]).collect();
    assert!(ends.iter().all(|pair| *pair == [1.0, 2.0] || *pair == [4.0, 0.5]), "{ends:?}");
    assert_eq!(rows.numbers("t").into_iter().fold(0.0, f64::max), 2.0);
    // As many values as paths, or one for all.
    let wrong = place.read("arm.toml").replace("[4, \"500 ms\"]", "[4]");
    place.write("wrong.toml", wrong);
    let refused = place.springpot(&["check", "wrong.toml"]);
    assert!(
        refused.code == Some(2) && refused.stderr.contains("holds [4] beside values for each of 2 parameters"),
        "{}",
        refused.stderr
    );
}

#[test]
fn sweeps_of_the_command_line() {
    let place = Place::with(&format!("{ARM}\n[[sweep]]\nparameter = \"element.damper.alpha\"\nvalues = [0.2, 0.4]\n"));
    let values = |sweeps: &[&str], column: &str| {
        let arguments: Vec<&str> = sweeps.iter().flat_map(|sweep| ["--sweep", sweep]).collect();
        place.done(&[&["run", "arm.toml", "--quiet", "--no-figures", "--out", "r"][..], &arguments].concat());
        let mut values = place.table("r/results.csv").numbers(column);
        values.dedup();
        values
    };
    let alpha = "element.damper.alpha";
    assert_eq!(values(&["element.damper.alpha=0.3,0.5,0.7"], alpha), [0.3, 0.5, 0.7]);
    assert_eq!(values(&["element.damper.alpha=0.2:0.8:4"], alpha), [0.2, 0.4, 0.6, 0.8]);
    assert_eq!(
        values(&["element.damper.mu_0=1:100:3:log"], "element.damper.mu_0"),
        [1.0, 10.0, 100.0, 1.0, 10.0, 100.0]
    );
    assert_eq!(values(&["element.damper.rest_length=49 cm,0.5"], "element.damper.rest_length"), [0.49, 0.5, 0.49, 0.5]);
    let points = "element.damper.to.point=[-0.4,0.3,0],[-0.4,0.3,0.1],[-0.4,0.2,0]";
    assert!(place.done(&["check", "arm.toml", "--sweep", points]).stdout.contains("cases     6\n"));
    let signals = "motion.joints.x=\"0.01*min(t, 1)\",0.02*max(t, 0)";
    assert!(place.done(&["check", "arm.toml", "--sweep", signals]).stdout.contains("cases     4\n"));
    // As check counts them.
    let checked = place.done(&["check", "arm.toml", "--sweep", "element.damper.alpha=0.1:0.9:9"]);
    assert!(checked.stdout.contains("cases     9\n"), "{}", checked.stdout);
    for (arguments, words) in [
        (&["--sweep", "element.damper.alpha"][..], "--sweep \"element.damper.alpha\" has no `=`"),
        (&["--sweep", "element.damper.alpha=0.1,,0.3"], "a value of --sweep is empty"),
        (&["--sweep", "element.damper.alhpa=0.1"], "did you mean `alpha`?"),
        (&["--sweep", "element.damper.alpha=0.1,1.5"], "--sweep:1:26"),
        (&["--sweep", "element.damper.alpha=0.1:0.9:1"], "outside 2"),
        (&["--sweep", "element.damper.alpha=0.1", "--sweep", "element.damper.alpha=0.2"], "swept twice, and was 0.1"),
        (&["--set", "element.damper.alpha=0.1"], "help: sweep it: --sweep PATH=v1,v2"),
        (&["--sweep", "title=a,b"], "which cannot be swept"),
    ] {
        let refused = place.springpot(&[&["check", "arm.toml"][..], arguments].concat());
        assert!(refused.code == Some(2) && refused.stderr.contains(words), "{arguments:?}: {}", refused.stderr);
    }
}

#[test]
fn components_have_paths() {
    let place = Place::new();
    place.done(&["run", "arm.toml", "--quiet", "--out", "whole", "--set", "element.damper.to.point=[-0.4,0.3,0.1]"]);
    place.done(&["run", "arm.toml", "--quiet", "--out", "part", "--set", "element.damper.to.point.2=10 cm"]);
    assert_eq!(place.read("whole/results.csv"), place.read("part/results.csv"));
    for path in ["element.damper.to.point.3", "element.damper.to.point.z", "element.damper.to.point.-1"] {
        let refused = place.springpot(&["check", "arm.toml", "--set", &format!("{path}=1")]);
        assert!(
            refused.code == Some(2) && refused.stderr.contains("components count from 0: 0 to 2"),
            "{}",
            refused.stderr
        );
    }
}

#[test]
fn what_the_file_says_under_a_sweep_is_judged() {
    for (value, words) in [("\"banana\"", "banana"), ("1.5", "1.5"), ("-0.1", "-0.1")] {
        let sweep = "\n[[sweep]]\nparameter = \"element.damper.alpha\"\nvalues = [0.2, 0.4]\n";
        let place = Place::with(&(ARM.replace("alpha = 0.5", &format!("alpha = {value}")) + sweep));
        let refused = place.springpot(&["check", "arm.toml"]);
        assert!(
            refused.code == Some(2) && refused.stderr.contains(words) && refused.stderr.contains("arm.toml:26"),
            "{}",
            refused.stderr
        );
    }
    // What the file leaves to the sweep is not missed.
    let sweep = "\n[[sweep]]\nparameter = \"element.damper.alpha\"\nvalues = [0.2, 0.4]\n";
    Place::with(&(ARM.replace(", alpha = 0.5", "") + sweep)).done(&["check", "arm.toml"]);
}

#[test]
fn swept_columns_have_their_units() {
    let place = with_constants();
    let sweeps = [
        "--sweep",
        "time.end=1 s,2 s",
        "--sweep",
        "element.damper.mu_0=10,20",
        "--sweep",
        "element.damper.alpha=0.3,0.5",
    ];
    place.done(&[&["run", "arm.toml", "--quiet", "--no-figures", "--out", "units"][..], &sweeps].concat());
    let record = place.record("units");
    let units: Vec<&str> = (0..3).map(|k| record["columns"][k]["unit"].as_str().unwrap()).collect();
    assert_eq!(units, ["s", "N*s^alpha/m", ""]);
}

#[test]
fn figures_take_expressions_of_constants() {
    let place = with_constants();
    let figure = "\n[[figure]]\nname = \"f\"\ny = [\"damper.force\"]\nx_range = [0, { expression = \"2*period\" }]\n\
                  y_range = [{ expression = \"-3*A\", unit = \"mN\" }, { expression = \"2*f\", unit = \"kN\" }]\n\
                  size = [{ expression = \"18*A\", unit = \"m\" }, \"60 mm\"]\n";
    place.write("arm.toml", format!("{}{figure}", place.read("arm.toml")));
    place.done(&["run", "arm.toml", "--sweep", "constants.f=1 Hz,4 Hz"]);
    // The axis of forces reaches to 2 Hz times 1 kN of the first value.
    let svg = place.read("results/arm/figures/f.svg");
    assert!(svg.contains(">2000<"), "{svg}");
    let refused = place.springpot(&["run", "arm.toml", "--set", "figure.f.x_range=[0, { expression = \"2*g\" }]"]);
    assert!(refused.code == Some(2) && refused.stderr.contains("unknown name `g`"), "{}", refused.stderr);
}
