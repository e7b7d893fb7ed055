//! Mistakes of people who know other programs: each is told with its place, its value and what would be right.

use crate::support::{ARM, Place, edited, testdata};

const MOTION: &str = "kind = \"prescribed\"\njoints = { q1 = \"0.3*sin(4*t)\", x = \"0.05 - 0.05*cos(6*t)\" }";

#[test]
fn expressions_of_other_languages() {
    let place = Place::new();
    for (signal, words) in [
        ("20*np.sin(2*np.pi*t)", &["unknown name `np.sin`; did you mean `sin`?", "--set:1:21"][..]),
        ("math.sqrt(t + 1)", &["unknown name `math.sqrt`; did you mean `sqrt`?"]),
        ("t<1 ? 0 : 20", &["`<`: an expression has no conditions; step(t - 1) is 0 before t = 1"]),
        ("if t<1 then 0 else 1", &["`if`: an expression has no conditions"]),
        ("where(t > 1, 0, 1)", &["an expression has no conditions"]),
    ] {
        place.springpot(&["check", "arm.toml", "--set", &format!("motion.joints.q1={signal}")]).ends(2, words);
    }
    let forward = edited(&[(MOTION, "kind = \"forward\"\n\n[[event]]\nname = \"far\"\nwhen = \"q1 > 0.2\"\n")]);
    place.write("arm.toml", &forward);
    place.springpot(&["check", "arm.toml"]).ends(
        2,
        &[
            "arm.toml:34:12",
            "an event happens where `when` passes zero: write \"q.q1 - 0.2\" and direction = \"rising\"",
        ],
    );
    place.write("arm.toml", forward.replace("q1 > 0.2", "q.q1 < -0.2"));
    place.springpot(&["check", "arm.toml"]).ends(2, &["write \"q.q1 - (-0.2)\" and direction = \"falling\""]);
}

#[test]
fn names_without_their_beginning() {
    let place = Place::new();
    place.done(&["run", "arm.toml", "--out", "r"]);
    place.springpot(&["metrics", "r", "--metric", "max(q1)"]).ends(2, &["did you mean `q.q1`?"]);
    place.springpot(&["plot", "r", "q1"]).ends(2, &["q.q1"]);
    place.springpot(&["plot", "arm.toml", "q.x"]).ends(
        2,
        &[
            "arm.toml is a scenario, and plot draws the results of a run",
            "springpot run arm.toml",
            "springpot plot results/arm COLUMN",
        ],
    );
    place.done(&["run", "arm.toml", "--format", "parquet", "--out", "p"]);
    place.springpot(&["plot", "p", "q.x"]).ends(2, &["view, report, export and metrics read it", "--format csv"]);
}

#[test]
fn files_of_samples() {
    let place = Place::new();
    place.write("T.csv", "time,T\n0,1\n1,2\n");
    place.write("back.csv", "t,T\n0,1\n1,2\n1,3\n2,4\n");
    place.write("bare.csv", "0,1\n1,2\n");
    let with = |file: &str| {
        let signal = format!("element.damper.u={{ csv = \"{file}\", column = \"T\" }}");
        place.springpot(&["check", "arm.toml", "--set", &signal])
    };
    with("T.csv").ends(2, &["no column `t`; did you mean `time`?", "write time = \"time\""]);
    with("back.csv")
        .ends(2, &["back.csv:4: times must increase, but 1 follows 1", "sort the rows by t", "look at line 4"]);
    with("bare.csv").ends(2, &["write the names of the columns above the numbers"]);
}

#[test]
fn measurements() {
    let place = Place::new();
    let rows = |temperature: &str| -> String {
        let row = |f: f64| format!("{temperature},{f},{},{}\n", 2000.0 * (1.0 + f.sqrt()), 0.2);
        [0.1, 1.0, 10.0, 100.0].map(row).concat()
    };
    let header = "temperature [degC],frequency [Hz],storage [N/m],tan_delta\n";
    place.write("one.csv", format!("{header}{}", rows("20")));
    place.write("two.csv", format!("{header}{}{}", rows("20"), rows("40")));
    place.done(&["laws", "--from", "one.csv"]);
    for law in [&["laws", "--from", "two.csv"][..], &["laws", "fractional-zener", "--from", "two.csv"]] {
        place
            .springpot(law)
            .ends(2, &["two.csv:6: the rows were measured at several temperatures", "20 and 40", "line 6"]);
    }
    place
        .springpot(&["laws", "prony", "--from", "one.csv"])
        .ends(2, &["is not fitted from data yet", "springpot prony"]);
    // Other habits of instruments.
    let comma = "Ang. frequency (rad/s);E' (MPa);Tan Delta\n0,62832;2,0;0,2\n6,2832;2,5;0,2\n62,832;3,1;0,2\n";
    place.write("comma.csv", comma);
    let sample = ["--area", "4 cm^2", "--length", "10 mm", "--json"];
    let read = place.done(&[&["laws", "--from", "comma.csv"][..], &sample].concat());
    let point = comma.replace(',', ".").replace(';', ",");
    place.write("point.csv", point);
    let same = place.done(&[&["laws", "--from", "point.csv"][..], &sample].concat());
    assert_eq!(read.stdout.replace("comma", "point"), same.stdout);
    let plain =
        place.done(&["laws", "--from", "E = 2 MPa at 10 Hz, tan_delta = 0.2 at 10 Hz, area = 4 cm^2, length = 10 mm"]);
    assert!(plain.stdout.contains("springpot"), "{}", plain.stdout);
    let far = place.done(&["laws", "spring", "--from", "tan_delta = 0.3 at 10 Hz, stiffness = 5 kN/m"]);
    far.ends(0, &["spring misses the data by 100 %", "name another law, or none"]);
}

#[test]
fn laws_in_other_words() {
    let place = Place::new();
    for (edit, words) in [
        (("alpha = 0.5", "order = 0.5"), &["unknown key `order`", "did you mean `alpha`?"][..]),
        (("alpha = 0.5", "\"α\" = 0.5"), &["unknown key `α`", "did you mean `alpha`?"]),
    ] {
        place.write("arm.toml", edited(&[edit]));
        let ended = place.springpot(&["check", "arm.toml"]);
        ended.ends(2, words);
        assert!(!ended.stderr.contains("needs the parameters"), "{}", ended.stderr);
    }
    place.write(
        "arm.toml",
        edited(&[
            ("law = \"magnetorheological\"", "network = \"springpot(alpha, c)\""),
            ("{ E_c = \"20 N/m\", mu_0 = 10, mu = 4, alpha = 0.5 }", "{ c = \"50 N*s^alpha/m\", alpha = 0.4 }"),
            ("inputs = { u = \"1 + 0.5*sin(20*t)\" }\n", ""),
        ]),
    );
    place.springpot(&["check", "arm.toml"]).ends(
        2,
        &[
            "is \"50 N*s^alpha/m\", but stands in the network where an order does",
            "the coefficient comes first: springpot(c, alpha)",
        ],
    );
    // Energies per mole.
    let shifted = "alpha = 0.5 }\nshift = { kind = \"arrhenius\", energy = \"60 kJ/mol\", T_ref = \"20 degC\" }";
    let warm = edited(&[("alpha = 0.5 }", shifted), ("sin(20*t)\" }", "sin(20*t)\", T = \"30 degC\" }")]);
    place.write("arm.toml", &warm);
    place.done(&["run", "arm.toml", "-q", "--no-figures", "--out", "kilo"]);
    place.done(&["run", "arm.toml", "-q", "--no-figures", "--out", "bare", "--set", "element.damper.shift.energy=6e4"]);
    assert_eq!(place.read("kilo/results.csv"), place.read("bare/results.csv"));
    place.springpot(&["check", "arm.toml", "--set", "element.damper.shift.energy=60 kJ"]).ends(2, &["`J/mol`"]);
    place.write("arm.toml", edited(&[("axis = [0, 1, 0],", "axis = [0, 1, 0], limits = [-1, 1],")]));
    place.springpot(&["check", "arm.toml"]).ends(2, &["`limits` of", "`lower`, `upper`, `velocity` and `effort`"]);
}

#[test]
fn toml_in_other_dress() {
    let place = Place::new();
    place.write("arm.toml", edited(&[("mass = \"500 g\"", "mass = “500 g”")]));
    place
        .springpot(&["check", "arm.toml"])
        .ends(2, &["arm.toml:17:8", "“ is a quote of running text", "write straight quotes: mass = \"500 g\""]);
    place.write("arm.toml", edited(&[("end = 0.35", "end: 3 s")]));
    place.springpot(&["check", "arm.toml"]).ends(2, &["arm.toml:34", "write end = \"3 s\""]);
    place.write("arm.toml", format!("{ARM}[[figure]]\nname = \"f\"\ny = \"q.x\"\nformats = \"all\"\n"));
    place.springpot(&["check", "arm.toml"]).ends(2, &["\"svg\", \"png\" and \"pdf\"", "\"all\""]);
}

#[test]
fn failures_show_their_line() {
    let place = Place::new();
    let busy = place.springpot(&["run", "arm.toml", "--set", "motion.joints.q1=0.001*sin(1e12*t)"]);
    assert!(busy.code != Some(0), "{}", busy.stderr);
    busy.ends(busy.code.unwrap(), &["--set:1:18", "q1", "changes too often", "look at its frequency"]);
    // Its points meet on the way: what is shown is where they stand.
    place.write(
        "arm.toml",
        edited(&[
            ("from = { body = \"world\", point = [0, 0.3, 0] }", "from = { body = \"world\", point = [0.4, 0, 0.5] }"),
            ("to = { body = \"slide\", point = [-0.4, 0.3, 0] }", "to = { body = \"slide\", point = [0, 0, 0] }"),
            ("\"0.3*sin(4*t)\"", "0"),
            ("0.05 - 0.05*cos(6*t)", "0.1 - t"),
            ("\"50 cm\"", "\"10 cm\""),
        ]),
    );
    place
        .springpot(&["run", "arm.toml"])
        .ends(1, &["arm.toml:22:8", "its points met", "from = { body = \"world\", point = [0.4, 0, 0.5] }"]);
    place.write("arm.toml", edited(&[("\"0.3*sin(4*t)\"", "\"0.3*step(t - 0.2)\"")]));
    let jumped = place.springpot(&["run", "arm.toml"]);
    jumped.ends(jumped.code.unwrap(), &["arm.toml:31:17", "0.3*step(t - 0.2)", "coordinates may not: ramp it"]);
    assert_ne!(jumped.code, Some(0));
}

#[test]
fn words_of_the_command_line() {
    let place = Place::new();
    place.done(&["run", "arm.toml", "--out", "r", "-q"]);
    for (arguments, words) in [
        (
            &["check", "arm.toml", "--set", "element.damper.alpha", "0.4"][..],
            &["write --set element.damper.alpha=0.4"][..],
        ),
        (
            &["run", "arm.toml", "--sweep", "element.damper.alpha", "0.4,0.5"],
            &["write --sweep element.damper.alpha=0.4,0.5"],
        ),
        (
            &["export", "r", "a.glb", "--format", "mcap"],
            &["no option --format", "the ending of the file says the format: .mcap, .glb or .gltf"],
        ),
        (&["run", "arm.toml", "--shard", "3/2"], &["--shard 3/2", "--shard 3/16 is the third of 16"]),
        (
            &["run", "arm.toml", "--format", "hdf5"],
            &["--format hdf5: not a value that it takes", "csv, parquet and npz"],
        ),
        (&["run", "arm.toml", "--jobs", "two"], &["--jobs two: not a value", "a whole number from 1 on"]),
        (&["run"], &["`springpot run` lacks <SCENARIO>", "springpot run --help"]),
        (&["plot", "r"], &["`springpot plot` lacks <COLUMN>"]),
        (&["fmu", "arm.toml", "--out", "a.txt"], &["--out a.txt is no .fmu", "write a name that ends in .fmu"]),
        (&["plot", "r", "q.x", "--formats", "all"], &["--formats all", "write some of svg, png and pdf"]),
    ] {
        let ended = place.springpot(arguments);
        ended.ends(2, words);
        assert!(ended.stderr.starts_with("error: ") && !ended.stderr.contains("invalid"), "{}", ended.stderr);
    }
    assert!(!place.path("a.txt").exists());
    let drawn = place.done(&["plot", "r", "q.x", "--formats", "svg,pdf"]);
    assert_eq!(drawn.stdout.lines().collect::<Vec<_>>(), ["r/figures/q.x.svg", "r/figures/q.x.pdf"]);
}

#[test]
fn starters() {
    let place = Place::new();
    let ur5 = testdata("multibody/ur5.urdf");
    let from = |from: &str, to: &str| place.springpot(&["init", &ur5, "--from", from, "--to", to, "--out", "a.toml"]);
    from("wrist_1_link", "wrist_1_link")
        .ends(2, &["--from and --to are one link, \"wrist_1_link\": an element joins two"]);
    let link = |name: &str| {
        format!(
            "<link name=\"{name}\"><inertial><origin xyz=\"0 0 0.2\"/><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>"
        )
    };
    let joint = "<joint name=\"hip\" type=\"continuous\"><parent link=\"base\"/><child link=\"upper\"/><axis xyz=\"0 1 0\"/></joint>";
    place.write("one.urdf", format!("<robot name=\"one\">{}</robot>", link("base")));
    place.write("two.urdf", format!("<robot name=\"two\">{}{}{joint}</robot>", link("base"), link("upper")));
    place
        .springpot(&["init", "one.urdf"])
        .ends(2, &["the single link \"base\"", "springpot init one.urdf --floating-base"]);
    place.done(&["init", "one.urdf", "--floating-base"]);
    place.done(&["init", "two.urdf", "--from", "base", "--gripper", "upper"]);
    let text = place.read("two.toml");
    assert!(text.contains("from = { body = \"base\"") && text.contains("[robot.gripper]\nbody = \"upper\""), "{text}");
    place.done(&["run", "two.toml", "-q", "--out", "two"]);
    assert!(place.table("two/results.csv").header.contains(&"gripper.x".to_owned()));
    place.done(&["init", "two.urdf", "--forward", "--out", "fall.toml"]);
    let fell = place.done(&["check", "fall.toml"]);
    assert!(fell.stdout.contains("forward, 0 to 2 s"), "{}", fell.stdout);
}

#[test]
fn metrics_of_a_sweep_are_a_table() {
    let place = Place::with(&format!(
        "{ARM}\n[[metric]]\nname = \"peak\"\nof = \"damper.force\"\nkind = \"max\"\n\n[[metric]]\nname = \"last\"\nof = \"q.x\"\nkind = \"final\"\n"
    ));
    let ended = place.done(&["run", "arm.toml", "--no-figures", "--sweep", "element.damper.alpha=0.2,0.8"]);
    let lines: Vec<&str> =
        ended.stdout.lines().filter(|line| line.starts_with("metrics  ") || line.starts_with("    ")).collect();
    assert_eq!(lines.len(), 3, "{}", ended.stdout);
    assert!(
        lines[0].starts_with("metrics  alpha  ") && lines[0].contains("peak, N") && lines[0].contains("last, m"),
        "{lines:?}"
    );
    assert!(lines[1].starts_with("         0.2 ") && lines[2].starts_with("         0.8 "), "{lines:?}");
    let written = place.table("results/arm/metrics.csv").numbers("value");
    let shown: f64 = lines[1].split_whitespace().nth(1).unwrap().parse().unwrap();
    assert!((shown - written[0]).abs() <= 1e-5 * written[0].abs(), "{shown} {written:?}");
    let many = place.done(&["run", "arm.toml", "--no-figures", "--sweep", "element.damper.alpha=0.1:0.9:20"]);
    assert!(many.stdout.contains("8 more cases in metrics.csv"), "{}", many.stdout);
}
