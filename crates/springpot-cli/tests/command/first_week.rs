//! Mistakes of the first week: each is told with its place, its value and what would be right.

use crate::support::{ARM, Ended, Place};

/// A refusal that says all of `words`.
#[track_caller]
fn refused(ended: &Ended, words: &[&str]) {
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{}", ended.stderr);
    ended.says(words);
}

#[test]
fn a_robot_a_table_and_a_folder_are_no_scenarios() {
    let place = Place::new();
    place.write("ur5.urdf", "<?xml version=\"1.0\"?>\n<robot name=\"r\"><link name=\"a\"/></robot>\n");
    place.write("scene.xml", "<mujoco model=\"m\"/>\n");
    place.write("rows.csv", "t,x\n0,1\n");
    place.write("states.json", "{\"states\": []}\n");
    std::fs::create_dir(place.path("empty")).unwrap();
    place.done(&["run", "arm.toml", "--out", "finished"]);
    let init = "`springpot init ur5.urdf` writes a scenario with it, `springpot info ur5.urdf` describes it";
    for (file, words) in [
        ("ur5.urdf", &["error: ur5.urdf: a robot in URDF, not a scenario", init][..]),
        ("scene.xml", &["scene.xml: XML, not a scenario", "`springpot init` writes one"]),
        ("rows.csv", &["rows.csv: a table, not a scenario", "`springpot plot FOLDER COLUMN`"]),
        ("states.json", &["states.json: JSON, not a scenario"]),
        (".", &["not a regular file", "it holds arm.toml"]),
        (
            "finished",
            &["it holds the results of a run: `springpot plot finished COLUMN`", "springpot run --resume finished"],
        ),
        ("empty", &["a scenario is read from a file"]),
        ("arm", &["arm: cannot be opened", "did you mean arm.toml?"]),
        ("amr.toml", &["did you mean arm.toml?"]),
    ] {
        for command in ["run", "check"] {
            refused(&place.springpot(&[command, file]), words);
        }
    }
}

#[test]
fn what_is_set_twice_is_refused() {
    let place = Place::new();
    let alpha = ["--set", "element.damper.alpha=0.3", "--set", "element.damper.alpha=0.4"];
    let ended = place.springpot(&[&["check", "arm.toml"][..], &alpha].concat());
    refused(&ended, &["element.damper.alpha is set twice, and was 0.3 before", "leave one of them out"]);
}

#[test]
fn a_file_is_no_folder_for_results() {
    let place = Place::new();
    let before = place.read("arm.toml");
    let ended = place.springpot(&["run", "arm.toml", "--quiet", "--out", "arm.toml"]);
    assert_eq!(ended.code, Some(1));
    ended.says(&["the results cannot be written to arm.toml: it is a file", "name a folder with --out"]);
    #[cfg(unix)]
    {
        let ended = place.springpot(&["run", "arm.toml", "--out", "/dev/null"]);
        ended.says(&["the results cannot be written to /dev/null: it is no folder", "name a folder with --out"]);
    }
    assert_eq!(place.read("arm.toml"), before);
}

#[test]
fn one_case_of_a_sweep_is_differentiated() {
    let place = Place::new();
    let rows = |case: f64| (0..20).map(|k| format!("{case},{k},{}\n", case * f64::from(k * k))).collect::<String>();
    place.write("sweep.csv", format!("alpha,t,x\n{}{}", rows(0.5), rows(2.0)));
    let derivative = ["derivative", "sweep.csv", "--column", "x", "--order", "1"];
    for scheme in ["spline", "exponential"] {
        let with = |more: &[&'static str]| [&derivative[..], &["--scheme", scheme], more].concat();
        let words = ["sweep.csv:22: times must increase, but 0 follows 19", "choose one: --where COLUMN=VALUE"];
        refused(&place.springpot(&with(&[])), &words);
        let ended = place.done(&with(&["--where", "alpha=2"]));
        let last: Vec<f64> = ended.stdout.lines().last().unwrap().split(',').map(|x| x.parse().unwrap()).collect();
        assert_eq!(ended.stdout.lines().count(), 21);
        assert!((last[3] - 76.0).abs() < 1e-6, "{last:?}");
        refused(&place.springpot(&with(&["--where", "alpha=3"])), &["0 rows of numbers"]);
        refused(&place.springpot(&with(&["--where", "alhpa=2"])), &["no column `alhpa`", "alpha"]);
        refused(&place.springpot(&with(&["--where", "alpha"])), &["--where \"alpha\" has no `=`"]);
    }
}

#[test]
fn a_robot_that_was_cut_short_says_where() {
    let place = Place::new();
    place.write("cut.urdf", "<robot name=\"r\">\n<link name=\"a\">\n<inertial>\n<mass value=\"1\"/>\n");
    refused(&place.springpot(&["info", "cut.urdf"]), &["cut.urdf:1:1", "never closed; the text ends on line 4"]);
}

#[test]
fn run_says_what_check_says() {
    let place = Place::new();
    let large = ["--set", "element.damper.rest_length=500"];
    let singular = ["--set", "element.damper.derivative=riemann-liouville", "--set", "element.damper.rest_length=0.49"];
    let short = ["--set", "time.end=5 ms", "--set", "time.output_step=2 s"];
    for (set, words) in [
        (
            &large[..],
            &["starts with a stroke of -499.5 m, more than 20 % of its rest length 500 m", "rest_length = \"start\""][..],
        ),
        (&singular, &["starts with x(0) = 0.01 m and the Riemann-Liouville derivative", "\"caputo\" says"]),
        (&short, &["the run ends at 0.005 s, before a row is due: rows come every 2 s", "are they swapped?"]),
    ] {
        for command in ["check", "run"] {
            place.done(&[&[command, "arm.toml", "--quiet"][..], set].concat()).says(words);
        }
    }
}

#[test]
fn what_cannot_run_is_refused_before_it_begins() {
    let place = Place::new();
    place.done(&["run", "arm.toml", "--quiet"]);
    let before = place.read("results/arm/results.csv");
    let jump = "motion.joints.x=0.01*step(t - 0.1)";
    for (set, words) in [
        (
            "element.damper.u=-9 V",
            &[
                "error: --set:1:18: t = 0 s:",
                "mu_0 + u·mu ≥ 0 is broken",
                "change the input or the parameters",
                "springpot laws",
            ][..],
        ),
        (
            jump,
            &[
                "t = 0.1 s: joint \"x\" jumps by 1e-2",
                "error: --set:1:17: ",
                "velocities may jump, coordinates may not",
            ],
        ),
    ] {
        let ended = place.springpot(&["run", "arm.toml", "--set", set]);
        refused(&ended, words);
        ended.says(&["nothing was run, and earlier results are as they were"]);
        let checked = place.springpot(&["check", "arm.toml", "--quiet", "--set", set]);
        assert_eq!(checked.code, Some(1));
        checked.says(words);
    }
    assert_eq!(place.read("results/arm/results.csv"), before);
    // Where some cases can run they do, and the others are one message.
    let some = ["--sweep", "element.damper.u=-9 V,1 V,-8 V,2 V", "--out", "some"];
    let ended = place.springpot(&[&["run", "arm.toml", "--quiet"][..], &some].concat());
    assert_eq!(ended.code, Some(1));
    ended.says(&["element.damper.u = -9 V and 1 other case: t = 0 s", "2 of 4 cases done, 2 failed"]);
    assert_eq!(ended.stderr.matches("error: ").count(), 1, "{}", ended.stderr);
}

/// The arm with its temperature-like input and its motion from files of loggers.
#[test]
fn csv_files_of_loggers() {
    let place = Place::new();
    let rows = |write: &dyn Fn(f64) -> String| (0..=40).map(|k| write(f64::from(k) * 0.01)).collect::<String>();
    let q = |t: f64| 0.3 * (4.0 * t).sin();
    let x = |t: f64| 0.05 - 0.05 * (6.0 * t).cos();
    place.write("plain.csv", format!("t,q1,x,u\n{}", rows(&|t| format!("{t},{},{},{}\n", q(t), x(t), 1.0 + t))));
    let comma = |x: f64| format!("{x}").replace('.', ",");
    let logged = rows(&|t| {
        format!("{};{};{};{}\n", comma(1000.0 * t), comma(q(t).to_degrees()), comma(1000.0 * x(t)), comma(1.0 + t))
    });
    place.write("logged.csv", format!("# logger 7\n# units below\nTime [ms];q1;x;u\n{logged}"));
    let run = |out: &str, motion: &str, input: &str| {
        let joints = "joints = { q1 = \"0.3*sin(4*t)\", x = \"0.05 - 0.05*cos(6*t)\" }";
        let text = place.read("arm.toml").replace(joints, motion).replace("{ u = \"1 + 0.5*sin(20*t)\" }", input);
        place.write("logged.toml", text);
        let ended = place.springpot(&["run", "logged.toml", "--quiet", "--out", out]);
        (ended.code, ended.stderr)
    };
    let plain = run("plain", "csv = \"plain.csv\"", "{ u = { csv = \"plain.csv\", column = \"u\" } }");
    assert_eq!(plain, (Some(0), String::new()));
    let dialect = "time = \"Time [ms]\", time_unit = \"ms\", separator = \";\"";
    let lines = dialect.replace("\", ", "\"\n").replace(", separator", "\nseparator");
    let motion = format!(
        "csv = \"logged.csv\"\n{}\nunit = {{ q1 = \"deg\", x = \"mm\" }}",
        lines.replace(", time_unit", "\ntime_unit")
    );
    let input = format!("{{ u = {{ csv = \"logged.csv\", column = \"u\", {dialect} }} }}");
    assert_eq!(run("logged", &motion, &input), (Some(0), String::new()));
    let (one, other) = (place.table("plain/results.csv"), place.table("logged/results.csv"));
    for column in ["q.q1", "q.x", "damper.force", "damper.u", "tau.q1"] {
        let largest = one.numbers(column).iter().fold(0.0f64, |m, x| m.max(x.abs()));
        let worst =
            one.numbers(column).iter().zip(other.numbers(column)).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
        assert!(worst < 1e-9 * largest, "{column}: {worst:e}");
    }
    // What is wrong is said with what would be right.
    for (motion, words) in [
        ("csv = \"logged.csv\"", "write separator = ';'"),
        ("csv = \"logged.csv\"\nseparator = \";\"", "write time = \"Time [ms]\""),
        ("csv = \"plain.csv\"\ntime_unit = \"m\"", "is \"m\", which is no unit of time"),
        ("csv = \"plain.csv\"\nseparator = \":\"", "which is no separator"),
        ("csv = \"plain.csv\"\nunit = \"deg\"", "another dimension than m"),
        ("csv = \"plain.csv\"\noutside = \"keep\"", "which is no rule"),
    ] {
        let (code, said) = run("wrong", motion, "{ u = 1 }");
        assert!(code == Some(2) && said.contains(words), "{motion}: {said}");
    }
}

#[test]
fn files_that_end_early_hold_and_files_in_other_units_warn() {
    let place = Place::new();
    let rows = |scale: f64| {
        (0..=10).map(|k| format!("{},{}\n", f64::from(k) * scale, 1.0 + 0.1 * f64::from(k))).collect::<String>()
    };
    place.write("short.csv", format!("t,u\n{}", rows(0.01)));
    place.write("ms.csv", format!("t,u\n{}", rows(50.0)));
    let input = |file: &str, more: &str| format!("element.damper.u={{ csv = \"{file}\", column = \"u\"{more} }}");
    let ended = place.springpot(&["run", "arm.toml", "--quiet", "--set", &input("short.csv", "")]);
    refused(&ended, &["covers t from 0 s to 0.1 s, but the run needs 0 s to 0.35 s", "outside = \"hold\""]);
    place.done(&["run", "arm.toml", "--quiet", "--out", "held", "--set", &input("short.csv", ", outside = \"hold\"")]);
    assert_eq!(place.table("held/results.csv").numbers("damper.u"), [1.0, 2.0, 2.0, 2.0, 2.0]);
    for command in ["check", "run"] {
        let ended = place.done(&[command, "arm.toml", "--quiet", "--set", &input("ms.csv", "")]);
        ended.says(&["\"ms.csv\" covers 500 s, and the run ends at 0.35 s", "write time_unit = \"ms\""]);
        let ended = place.done(&[command, "arm.toml", "--quiet", "--set", "motion.joints.q1=30*sin(4*t)"]);
        ended.says(&["joint \"q1\" turns by", "if its motion is in degrees, say so with unit = \"deg\""]);
    }
}

#[test]
fn mistakes_of_writing_say_what_to_write() {
    let inertia = "inertia = { xx = 0.01, yy = 0.05, zz = 0.05 }";
    let law = "law = \"magnetorheological\"\nparameters = { E_c = \"20 N/m\", mu_0 = 10, mu = 4, alpha = 0.5 }";
    for (from, to, words) in [
        (
            inertia,
            "inertia = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]",
            &["write { xx = … }; its keys are xx, yy, zz, xy, xz and yz"][..],
        ),
        (
            inertia,
            "inertia = { xx = 0.005, yy = 0.02, zz = 0.006 }",
            &["inertia is about the centre of mass, in kg*m^2"],
        ),
        ("alpha = 0.5", "α = 0.5", &["arm.toml:26:", "write alpha for α"]),
        (law, "law = \"spring\"\nparameters = { k = 1 }", &["unknown key `u`", "nothing can stand here: leave it out"]),
        (
            "kind = \"prescribed\"\njoints = { q1 = \"0.3*sin(4*t)\", x = \"0.05 - 0.05*cos(6*t)\" }",
            "kind = \"forward\"\n",
            &["arm.toml:28:10", "leave the scheme out"],
        ),
        ("[time]", "[motion]\nkind = \"forward\"\n[time]", &["duplicate key", "[motion] stands on line 29 already"]),
        ("mass = 2\n", "mass = 2\nmass = 3\n", &["duplicate key", "mass stands on line 10 already"]),
        (
            "name = \"damper\"",
            "name = \"Feder-Dämpfer\"",
            &["which is not a name", "from a to z", "write \"Feder-Daempfer\""],
        ),
    ] {
        let text = ARM.replace(from, to);
        let text = if to.contains("forward") && from.starts_with("kind") {
            text.replace("\n[motion]", "scheme = \"l1\"\n\n[motion]")
        } else {
            text
        };
        assert_ne!(text, ARM);
        refused(&Place::with(&text).springpot(&["check", "arm.toml"]), words);
    }
    let ended = Place::new().springpot(&["check", "arm.toml", "--set", "time.end=1e8"]);
    refused(&ended, &["--set:1:10: `end` of [time] makes 1000000000 rows"]);
}

#[test]
fn warnings_of_a_robot_are_accepted_and_limits_in_degrees_are_told() {
    let place = Place::new();
    let link = |name: &str| {
        format!(
            "<link name=\"{name}\"><inertial><mass value=\"1\"/>\
             <inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>"
        )
    };
    let joint = "<joint name=\"q\" type=\"revolute\"><parent link=\"a\"/><child link=\"b\"/><axis xyz=\"0 0 1\"/>\
                 <limit lower=\"-360\" upper=\"360\" effort=\"1\" velocity=\"10\"/></joint>";
    let robot = format!("<robot name=\"r\">{}{}{joint}<transmission name=\"t\"/></robot>", link("a"), link("b"));
    place.write("r.urdf", robot);
    let text = "[robot]\nurdf = \"r.urdf\"\n[motion]\nkind = \"prescribed\"\njoints = { q = \"0.1*sin(t)\" }\n[time]\nend = 0.1\noutput_step = 0.1\n";
    place.write("r.toml", text);
    let limits =
        "<limit> of more than three turns: degrees? radians are used: joint \"q\" (line 1: lower -360 and upper 360)";
    let checked = place.done(&["check", "r.toml", "--quiet"]);
    checked.says(&[limits, "not used: 1 <transmission>", "accept = [\"limit-in-degrees\", \"not-used\"] in [robot]"]);
    assert_eq!(place.done(&["run", "r.toml", "--quiet"]).stderr, checked.stderr);
    // The list is whole: those that are accepted already stay in it.
    let one = ["check", "r.toml", "--quiet", "--set", "robot.accept=[\"not-used\"]"];
    let rest = place.done(&one);
    rest.says(&[limits, "accept = [\"limit-in-degrees\", \"not-used\"] in [robot]"]);
    assert!(!rest.stderr.contains("transmission"), "{}", rest.stderr);
    place.write("r.toml", text.replace("\"r.urdf\"", "\"r.urdf\"\naccept = [\"limit-in-degrees\", \"not-used\"]"));
    for command in ["check", "run"] {
        assert_eq!(place.done(&[command, "r.toml", "--quiet"]).stderr, "");
    }
    let wrong = ["check", "r.toml", "--set", "robot.accept=[\"not-usd\"]"];
    refused(&place.springpot(&wrong), &["which is no kind of warning", "did you mean `not-used`?"]);
}
