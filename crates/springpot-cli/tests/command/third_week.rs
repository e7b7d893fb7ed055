//! What a reader met who came without knowing anything: pages, named values, units of measured points, damaged records.

use crate::support::{ARM, Place};

/// The arm with what is swept, measured and drawn.
fn with(more: &str) -> Place {
    Place::with(&format!("{ARM}\n{more}"))
}

const NAMED: &str = r#"
[[sweep]]
parameter = "element.damper.E_c"
values = ["0.1 N/cm", "0.2 N/cm", "0.3 N/cm"]
names = ["soft, as bought", "medium", "stiff"]
"#;

#[test]
fn formulas_of_a_report_hold_what_they_were_written_with() {
    let place = Place::with(ARM);
    place.done(&["run", "arm.toml", "--quiet", "--out", "o"]);
    place.done(&["report", "o"]);
    let page = place.read("o/report.html");
    assert!(page.contains("<mo>\u{2062}</mo>") && !page.contains('\u{fffd}'));
}

#[test]
fn a_record_whose_names_are_not_its_labels_is_refused() {
    let place = with(NAMED);
    place.done(&["run", "arm.toml", "--quiet", "--out", "o"]);
    let mut record = place.record("o");
    record["sweeps"][0]["names"].as_array_mut().unwrap().pop();
    place.write("o/run.json", record.to_string());
    for arguments in [&["view", "o"][..], &["view", "o", "--serve"], &["report", "o"], &["export", "o", "a.glb"]] {
        let words = ["o/run.json: the sweep of element.damper.E_c has 3 labels and other names, 2", "damaged"];
        place.springpot(arguments).ends(2, &words);
    }
    place.springpot(&["metrics", "o", "--metric", "max(damper.force)"]).ends(2, &["has 3 labels and other names"]);
}

#[test]
fn named_values_are_told_by_their_names_and_drawn_over_their_numbers() {
    let figure = "[[metric]]\nname = \"peak\"\nof = \"damper.force\"\nkind = \"max\"\n\n\
                  [[figure]]\nname = \"over\"\nkind = \"summary\"\nx = \"element.damper.E_c\"\ny = \"max(damper.force)\"\n";
    let place = with(&format!("{NAMED}\n{figure}"));
    let ended = place.done(&["run", "arm.toml", "--out", "o", "--sweep", "element.damper.mu=4,5"]);
    assert!(ended.stdout.contains("element.damper.E_c: \"soft, as bought\", medium, stiff"), "{}", ended.stdout);
    let lines: Vec<&str> = ended.stdout.lines().filter(|line| line.contains("soft, as bought ")).collect();
    assert_eq!(lines.len(), 2, "{}", ended.stdout);
    assert!(!ended.stdout.contains("N/cm"), "{}", ended.stdout);
    let x = ["max(damper.force)", "--x", "element.damper.E_c", "--out", "p.svg"];
    place.done(&[&["plot", "o"][..], &x].concat());
    let texts = |file: &str| -> Vec<String> {
        let text = place.read(file);
        text.split("<text").skip(1).filter_map(|text| Some(text.split('>').nth(1)?.to_owned())).collect()
    };
    let (drawn, figure) = (texts("p.svg"), texts("o/figures/over.svg"));
    // In the unit that they are written in.
    assert!(
        drawn.iter().any(|text| text.starts_with("0.10")) && !drawn.iter().any(|text| text.starts_with("10")),
        "{drawn:?}"
    );
    assert_eq!(drawn, figure);
    // Pages call cases by what was written, not by numbers of SI.
    place.done(&["run", "arm.toml", "--out", "v", "--quiet", "--view", "--sweep", "element.damper.u=0.5 V,1500 mV"]);
    let page = place.read("v/view.html");
    assert!(page.contains("\"name\":\"soft, as bought, u = 1500 mV\""));
}

#[test]
fn a_constant_is_swept_in_one_unit() {
    let place = with("[constants]\nf = \"1 Hz\"\n");
    let check =
        |values: &str| place.springpot(&["check", "arm.toml", "--quiet", "--sweep", &format!("constants.f={values}")]);
    for (values, at, words) in [
        ("1 Hz,2 N", "--sweep:1:18", "1 Hz, which is in Hz, and 2 N, which is in N"),
        ("1,2 rad/s", "--sweep:1:15", "1, which is a pure number, and 2 rad/s, which is in rad/s"),
        ("1 Hz,2 rad/s", "--sweep:1:18", "units of one kind"),
        ("1 rad,2", "--sweep:1:19", "2, which is a pure number"),
    ] {
        check(values).ends(2, &[at, words]);
    }
    for values in ["1,2", "0,2 V/mm,0,1 kV/mm", "1 Hz,2 kHz", "1 rad,90 deg", "1 N/m,2 kg/s^2"] {
        check(values).ends(0, &[]);
    }
}

#[test]
fn brackets_behind_a_name_are_the_unit_of_measured_points() {
    let figure = |data: &str| {
        format!("[[figure]]\nname = \"f\"\ny = \"damper.force\"\ndata = {{ csv = \"rig.csv\", {data} }}\n")
    };
    let draw = |data: &str| {
        let place = with(&figure(data));
        place.write("rig.csv", "t [ms],F [kN],F [weird],F [2]\n0,0,0,0\n300,0.002,2,2\n");
        let ended = place.springpot(&["run", "arm.toml", "--quiet", "--out", "o"]);
        (place, ended)
    };
    let figure_of = |data: &str| {
        let (place, ended) = draw(data);
        ended.ends(0, &[]);
        place.read("o/figures/f.svg")
    };
    let told = figure_of("x = \"t [ms]\", y = \"F [kN]\", label = \"rig\"");
    let said = figure_of("x = \"t [ms]\", x_unit = \"ms\", y = \"F [kN]\", y_unit = \"kN\", label = \"rig\"");
    let plain = figure_of("x = \"t [ms]\", y = \"F [2]\", label = \"rig\"");
    assert_eq!(told, said);
    assert_eq!(told, plain);
    let (_, refused) = draw("x = \"t [ms]\", y = \"F [weird]\"");
    refused.ends(2, &["arm.toml:", "its brackets tell no unit", "weird", "y_unit = \"ms\""]);
    let (_, refused) = draw("x = \"t [ms]\", y = \"F [kN]\", x_unit = \"mm\"");
    refused.ends(2, &["measured points are drawn beside t, which is in s"]);
}

const CONTROLLED: &str = r#"
[robot]
gravity = [0, 0, 0]

[robot.gripper]
body = "arm"
point = [0.5, 0, 0]

[[robot.body]]
name = "arm"
joint = { name = "q1", kind = "revolute", axis = [0, 0, 1] }
mass = 2
com = [0.2, 0, 0]
inertia = { xx = 0.01, yy = 0.05, zz = 0.05 }

[motion]
kind = "forward"

[motion.controller]
kind = "computed-torque"
kp = 100
kd = 20
reference = { kind = "joints", q1 = "0.5*step(t - 0.2)" }

[time]
end = 1
output_step = "100 ms"
"#;

#[test]
fn references_that_jump_are_marked_themselves() {
    let place = Place::with(CONTROLLED);
    let path = "reference = { kind = \"gripper-path\", x = \"0.5*cos(0.3*step(t - 0.2))\", y = \"0.5*sin(0.3*step(t - 0.2))\", z = 0 }";
    place.write("path.toml", CONTROLLED.replace("reference = { kind = \"joints\", q1 = \"0.5*step(t - 0.2)\" }", path));
    for command in ["check", "run"] {
        place.springpot(&[command, "arm.toml"]).ends(2, &["arm.toml:23:37", "jumps by 5e-1"]);
        place.springpot(&[command, "path.toml"]).ends(2, &["path.toml:23:13", "jumps by"]);
        // Where a case can run, both tell the one that cannot.
        let sweep = ["--sweep", "motion.controller.kind=pd-gravity,computed-torque"];
        place.springpot(&[&[command, "arm.toml"][..], &sweep].concat()).ends(1, &["arm.toml:23:37"]);
    }
}

/// The arm with one text in place of another that it holds once.
fn edited(from: &str, to: &str) -> Place {
    assert_eq!(ARM.matches(from).count(), 1, "{from}");
    Place::with(&ARM.replace(from, to))
}

#[test]
fn values_that_are_none_of_toml_are_written_right() {
    for (from, to, words) in [
        ("end = 0.35", "end = 1 s", "write end = \"1 s\""),
        ("law = \"magnetorheological\"", "law = magnetorheological", "write law = \"magnetorheological\""),
        ("end = 0.35", "end = 0,35", "write end = 0.35: numbers have a decimal point"),
        ("end = 0.35", "end = 0,35 s # long", "write end = \"0.35 s\""),
        ("end = 0.35", "end = .35", "write end = 0.35: a digit stands before the point"),
        ("end = 0.35", "end = -5.", "write end = -5.0"),
        ("end = 0.35", "end = None", "leave end out"),
        ("point = [0.1, 0, 0]", "point = [10 cm, 0, 0]", "write \"10 cm\""),
        ("point = [0.1, 0, 0]", "point = [0.1; 0; 0]", "write commas between values"),
        ("[motion]", "[motion]\ngravity_compensation = True", "write gravity_compensation = true"),
        ("mass = 2", "mass = 2 // kg", "a comment begins with #: write mass = 2 # kg"),
        ("mass = 2", "// mass\nmass = 2", "a comment begins with #: write # mass"),
        ("[time]", "[time", "write [time]"),
        ("[[element]]", "[[element]", "write [[element]]"),
        ("1 + 0.5*sin(20*t)", "0 if t<1 else 20", "an expression has no conditions; step(t - 1) is 0 before t = 1"),
    ] {
        edited(from, to).springpot(&["check", "arm.toml"]).ends(2, &["arm.toml:", words]);
    }
}

#[test]
fn arguments_are_told_with_what_was_given() {
    let place = Place::with(ARM);
    place.write("tt.csv", "t,x\n0,0\n1,1\n2,3\n3,5\n");
    place.write("other.toml", ARM);
    place.done(&["run", "arm.toml", "--quiet", "--out", "o"]);
    for (arguments, words) in [
        (&["plot", "o", "q.x", "--out", "x.pdf", "--formats", "svg"][..], &["leave --formats out"][..]),
        (&["view", "o", "--serve", "--out", "x.html"], &["--serve shows the page and writes none"]),
        (&["run", "arm.toml", "--resume", "o"], &["SCENARIO cannot be used with --resume", "name the folder alone"]),
        (&["run", "arm.toml", "--out", "a", "--out", "b"], &["--out is given twice", "write it once"]),
        (&["modulus", "arm.toml"], &["write springpot modulus arm.toml ELEMENT"]),
        (&["export", "o"], &["write springpot export o FILE"]),
        (&["plot", "o"], &["write springpot plot o COLUMN"]),
        (&["derivative", "arm.toml", "--column", "x", "--order", "0.5"], &["arm.toml is a scenario, not a table"]),
        (&["laws", "--from", "arm.toml"], &["arm.toml is a scenario, not a table", "run it first"]),
        (&["run", "nosuch.toml"], &["the current folder holds arm.toml and other.toml"]),
        (&["run", "sub/nosuch.toml"], &["there is no folder sub"]),
        (&["run", "am.toml"], &["did you mean arm.toml?"]),
        (
            &["modulus", "arm.toml", "damper", "--set", "element.damper.enabled=false"],
            &["element \"damper\" is not enabled", "--set element.damper.enabled=true"],
        ),
        (&["init", "--out", "a.urdf"], &["init writes a scenario (TOML), no .urdf", "write --out a.toml"]),
        (
            &["derivative", "tt.csv", "--column", "x", "--order", "0.5", "--out", "./tt.csv"],
            &["--out ./tt.csv is the file that is read", "name another file"],
        ),
    ] {
        let ended = place.springpot(arguments);
        ended.ends(2, words);
        assert!(!ended.stderr.contains("Usage:"), "{}", ended.stderr);
    }
    assert!(!place.path("a.urdf").exists() && place.read("tt.csv").starts_with("t,x\n"));
    let drawn = place.done(&["plot", "o", "q.x", "--formats", "svg,svg"]);
    assert_eq!(drawn.stdout, "o/figures/q.x.svg\n");
}

#[test]
fn numbers_in_other_units_are_warned_of() {
    let warned = |place: Place, words: &[&str]| place.springpot(&["check", "arm.toml", "--quiet"]).ends(0, words);
    warned(
        edited("\"0.3*sin(4*t)\"", "\"40 + 0.1*sin(t)\""),
        &["arm.toml:31:17: joint \"q1\" starts at 40 without a unit: rad, and so 6.4 turns", "unit = \"deg\""],
    );
    warned(edited("com = [0.05,", "com = [50,"), &["arm.toml:18:7: body \"slide\": its centre of mass is 50 m away"]);
    warned(
        edited("origin = [0.4,", "origin = [400,"),
        &["body \"slide\": its joint is 400 m away, where other bodies"],
    );
    for text in ["\"12 + 0.1*sin(t)\"", "{ expression = \"2000 + sin(t)\", unit = \"deg\" }"] {
        let ended = edited("\"0.3*sin(4*t)\"", text).springpot(&["check", "arm.toml", "--quiet"]);
        assert!(!ended.stderr.contains("without a unit"), "{}", ended.stderr);
    }
    let robot = "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>\
                 <visual><geometry><mesh filename=\"package://shop/b.stl\"/></geometry></visual></link>\
                 <joint name=\"j\" type=\"continuous\"><parent link=\"a\"/><child link=\"b\"/><axis xyz=\"0 0 1\"/></joint></robot>";
    let place = Place::with(
        "[robot]\nurdf = \"r.urdf\"\npackage_path = [\"nowhere\"]\n[motion]\nkind = \"prescribed\"\njoints = { j = \"sin(t)\" }\n[time]\nend = 1\noutput_step = 0.1\n",
    );
    place.write("r.urdf", robot);
    let words =
        ["arm.toml:3:17", "there is no folder nowhere", "package_path = \"FOLDER\" in [robot], the folder shop"];
    place.springpot(&["check", "arm.toml", "--quiet"]).ends(0, &words);
}
