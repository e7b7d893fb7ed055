//! Cases with names, elements that are not enabled, rows at equal ratios, measured points.

use crate::support::{ARM, Place};

/// The arm with a second element, which a sweep switches on and off; its cases have names.
fn arm() -> String {
    let spring = "[[element]]\nname = \"spring\"\njoint = \"q1\"\nlaw = \"kelvin-voigt\"\nparameters = { k = 3, c = 0.1 }\n\n[motion]";
    let sweep = "\n[[sweep]]\nparameter = [\"element.spring.enabled\", \"element.damper.u\"]\n\
                 values = [[true, \"1 + 0.5*sin(20*t)\"], [false, \"0 V\"], [false, \"1 + 0.5*sin(20*t)\"]]\n\
                 names = [\"both\", \"damper, no voltage\", \"damper alone\"]\n\
                 [[metric]]\nname = \"work\"\nof = \"energy.actuators\"\nkind = \"final\"\n\
                 [[figure]]\nname = \"spring\"\ny = \"spring.force\"\n\
                 [[figure]]\nname = \"tau\"\ny = \"tau.q1\"\n[[figure]]\nname = \"robot\"\nkind = \"robot\"\n";
    format!("{}{sweep}", ARM.replace("[motion]", spring))
}

#[test]
fn names_stand_wherever_cases_are_told_apart() {
    let place = Place::with(&arm());
    place.done(&["run", "arm.toml", "--out", "r", "--quiet"]);
    let names = ["both", "damper, no voltage", "damper alone"];
    let record = place.record("r");
    assert_eq!(record["sweeps"][0]["names"], serde_json::json!(names));
    assert_eq!(record["cases"][1]["name"], names[1]);
    assert_eq!(record["cases"][1]["parameters"]["element.damper.u"], 0.0);
    let tau = place.read("r/figures/tau.svg");
    names.iter().for_each(|name| assert!(tau.contains(&format!(">{name}<")), "{name}: {tau}"));
    assert!(!tau.contains("sin(") && !tau.contains("enabled"), "{tau}");
    // The command finds them, by name or by value.
    for chosen in ["element.damper.u=damper, no voltage", "element.spring.enabled=damper alone"] {
        place.done(&["plot", "r", "tau.q1", "--where", chosen, "--out", "one.svg"]);
        assert!(!place.read("one.svg").contains(">both<"), "{chosen}");
    }
    let refused = place.springpot(&["plot", "r", "tau.q1", "--where", "element.damper.u=none"]);
    assert!(refused.code == Some(2) && refused.stderr.contains("values: both, damper, no voltage, damper alone"));
    place.done(&["report", "r", "--out", "r.html"]);
    place.done(&["report", "r", "r", "--out", "both.html"]);
    place.done(&["view", "r", "--out", "view.html"]);
    for page in ["r.html", "both.html", "view.html"] {
        let html = place.read(page);
        assert!(html.contains("damper alone"), "{page}");
    }
    let checked = place.done(&["check", "arm.toml"]);
    let said = checked.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
    let swept = "element.spring.enabled, element.damper.u: both, \"damper, no voltage\", damper alone";
    assert!(said.contains(swept), "{}", checked.stdout);
}

#[test]
fn what_is_not_enabled_leaves_its_cells_empty_and_acts_on_nothing() {
    let place = Place::with(&arm());
    place.done(&["run", "arm.toml", "--out", "r", "--quiet"]);
    let rows = place.table("r/results.csv");
    let count = rows.rows.len() / 3;
    let spring: Vec<&String> = rows.header.iter().filter(|name| name.starts_with("spring.")).collect();
    assert!(spring.len() > 8, "{spring:?}");
    for name in &spring {
        let cells = rows.texts(name);
        assert!(cells[..count].iter().all(|cell| !cell.is_empty()), "{name}");
        assert!(cells[count..].iter().all(|cell| cell.is_empty()), "{name}");
    }
    // All else is that of a robot without it, to the bit.
    place.write("plain.toml", ARM);
    place.done(&["run", "plain.toml", "--out", "plain", "--quiet"]);
    let plain = place.table("plain/results.csv");
    let mut compared = 0;
    for name in &plain.header {
        assert_eq!(rows.texts(name)[2 * count..], plain.texts(name)[..], "{name}");
        compared += 1;
    }
    assert!(compared > 20, "{compared}");
    assert_ne!(rows.texts("tau.q1")[..count], plain.texts("tau.q1")[..]);
    // It has no curve, no statistic, and a case without it no spring in its scene.
    let svg = place.read("r/figures/spring.svg");
    assert!(!svg.contains("damper alone"), "{svg}");
    let scenes = &place.record("r")["scenes"];
    let elements = |scene: usize| scenes[scene]["elements"].as_array().unwrap().len();
    assert_eq!((elements(0), elements(1)), (2, 1));
    let summary = place.read("r/summary.csv");
    let of = |case: &str| summary.lines().find(|line| line.starts_with(case) && line.contains("spring.force")).unwrap();
    assert!(of("false,0").ends_with(",,,"), "{}", of("false,0"));

    // Parts of the run make the same, and so does going on with one.
    for part in ["1/2", "2/2"] {
        place.done(&["run", "arm.toml", "--shard", part, "--out", &format!("part-{}", &part[..1]), "--quiet"]);
    }
    place.done(&["merge", "part-1", "part-2", "--out", "merged"]);
    for file in ["results.csv", "summary.csv", "metrics.csv", "figures/spring.svg"] {
        assert_eq!(place.read(format!("merged/{file}")), place.read(format!("r/{file}")), "{file}");
    }
    place.done(&["metrics", "r"]);
    let metrics = place.read("r/metrics.csv");
    assert_eq!(metrics, place.read("merged/metrics.csv"));
}

#[test]
fn five_decades_of_a_relaxation_in_rows_of_equal_ratios() {
    let text = "[[robot.body]]\nname = \"m\"\njoint = { name = \"x\", kind = \"prismatic\", axis = [1, 0, 0] }\nmass = 1\n\
                [[element]]\nname = \"pad\"\njoint = \"x\"\nlaw = \"springpot\"\nparameters = { c = 2, alpha = 0.3 }\n\
                past = { held = \"1 ms\" }\n[motion]\nkind = \"prescribed\"\njoints = { x = 0.5 }\n\
                [time]\nend = \"1000 s\"\noutput_times = { from = \"10 ms\", to = \"1000 s\", count = 51, scale = \"log\" }\n\
                [[figure]]\nname = \"relaxation\"\ny = \"pad.force\"\nx_scale = \"log\"\ny_scale = \"log\"\n";
    let place = Place::with(text);
    place.done(&["run", "arm.toml", "--out", "r", "--quiet"]);
    let rows = place.table("r/results.csv");
    let (t, force) = (rows.numbers("t"), rows.numbers("pad.force"));
    assert_eq!(t.len(), 51);
    let decades: Vec<f64> = t.iter().copied().step_by(10).collect();
    assert_eq!(decades, [0.01, 0.1, 1.0, 10.0, 100.0, 1000.0]);
    // F = c·x/Γ(1 − α)·(t + 1 ms)^−α after a step 1 ms before t = 0; Γ(0.7) = 1.298055332647558.
    for (t, force) in t.iter().zip(&force) {
        let exact = 2.0 * 0.5 / 1.298_055_332_647_558 * (t + 1e-3).powf(-0.3);
        assert!((force / exact - 1.0).abs() < 1e-8, "{t}: {force} for {exact}");
    }
    assert_eq!(place.record("r")["plan"]["time"]["output_times"].as_array().unwrap().len(), 51);
    let svg = place.read("r/figures/relaxation.svg");
    for label in [">0.01<", ">1000<"] {
        assert!(svg.contains(label), "{label}: {svg}");
    }
}

#[test]
fn measured_points_stand_beside_columns() {
    let figure = "[[figure]]\nname = \"both\"\ny = \"damper.force\"\nunits = { \"damper.force\" = \"mN\", t = \"ms\" }\n\
                  data = { csv = \"rig.csv\", x = \"Zeit [ms]\", y = \"Force [N]\", label = \"on the rig\", x_unit = \"ms\", separator = \";\" }\n";
    let place = Place::with(&format!("{ARM}{figure}"));
    place.write("rig.csv", "# made up\nZeit [ms];Force [N]\n0;0,5\n100;1,5\n300;-0,25\n");
    place.done(&["run", "arm.toml", "--out", "r", "--quiet"]);
    let svg = place.read("r/figures/both.svg");
    assert!(svg.contains("on the rig") && svg.contains("force F of damper"), "{svg}");
    let dots = svg.matches("<circle").count();
    assert_eq!(dots, 4, "three points and that of the legend: {svg}");
    let data = &place.record("r")["plan"]["figures"][0]["data"][0];
    assert_eq!((&data["csv"], &data["points"]), (&"rig.csv".into(), &3.into()));
    for (from, to, words) in [
        ("y = \"Force [N]\"", "y = \"Kraft\"", "no column"),
        ("rig.csv", "none.csv", "cannot be read"),
        (", separator = \";\"", "", "write separator = ';'"),
        ("x_unit = \"ms\"", "x_unit = \"mm\"", "measured points are drawn beside t, which is in s"),
        ("x_unit", "x_units", "did you mean `x_unit`?"),
        ("label = \"on the rig\", ", "label = 3, ", "must be a text"),
    ] {
        let text = format!("{ARM}{figure}");
        assert_eq!(text.matches(from).count(), 1, "{from}");
        place.write("bad.toml", text.replace(from, to));
        let refused = place.springpot(&["check", "bad.toml"]);
        let said = refused.said();
        assert!(refused.code == Some(2) && said.contains(words), "{to}: {said}");
    }

    // The command draws a file of points beside a run, with units in its headings, and columns that the run does not have.
    place.write("rig.csv", "t [ms],damper.force [mN],Load [N]\n0,500,0.5\n100,1500,1.5\n300,-250,-0.25\n");
    place.done(&["plot", "r", "rig.csv", "damper.force", "--out", "same.svg"]);
    let same = place.read("same.svg");
    assert!(same.contains(">rig<") && same.matches("<circle").count() == 4, "{same}");
    place.done(&["plot", "r", "rig.csv", "damper.force", "Load [N]", "--out", "more.svg"]);
    let more = place.read("more.svg");
    assert!(more.contains("rig: Load") && more.matches("<circle").count() == 8, "{more}");
    let refused = place.springpot(&["plot", "r", "rig.csv", "damper.force", "--x", "damper.stroke"]);
    assert!(refused.code == Some(2) && refused.stderr.contains("called as that of the run"), "{}", refused.stderr);
}

#[test]
fn names_of_drawn_files_are_short() {
    let metric = "[[metric]]\nname = \"work\"\nof = \"energy.actuators\"\nkind = \"final\"\n";
    let place = Place::with(&format!("{ARM}{metric}"));
    place.done(&["run", "arm.toml", "--out", "r", "--quiet", "--sweep", "element.damper.alpha=0.2,0.5"]);
    let drawn = place.done(&["plot", "r", "metric(work)", "--x", "element.damper.alpha"]);
    let name = "r/figures/metric-work-over-alpha";
    assert_eq!(drawn.stdout, format!("{name}.svg\n{name}.png\n"));
}
