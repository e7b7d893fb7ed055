//! `springpot plot`: columns of a finished run, its cases as curves, its labels with units.

use crate::support::{ARM, Place};
use std::fs;

const SWEEPS: &str = "
[[sweep]]
parameter = [\"element.damper.alpha\", \"solver.rtol\"]
values = [0.2, 0.05, 0.1]
[[sweep]]
parameter = \"element.damper.u\"
values = [\"0 V\", \"2000 mV\"]
";

fn swept() -> Place {
    // Tolerances above their range would be refused.
    let sweeps = SWEEPS.replace("[0.2, 0.05, 0.1]", "[0.05, 0.01, 0.1]");
    let place = Place::with(&format!("{ARM}{sweeps}"));
    place.done(&["run", "arm.toml", "--out", "r", "--set", "time.output_step=0.01", "--quiet"]);
    place
}

#[test]
fn curves_and_panels_as_a_run_draws_them() {
    let place = swept();
    let ended = place.done(&["plot", "r", "damper.force", "--title", "Force & voltage"]);
    assert_eq!(ended.stdout, "r/figures/damper.force.svg\nr/figures/damper.force.png\n");
    assert!(fs::read(place.path("r/figures/damper.force.png")).unwrap().starts_with(b"\x89PNG"));
    let svg = place.read("r/figures/damper.force.svg");
    for words in ["force F of damper, N", "time t, s", "Force &amp; voltage", ">0.05<", ">0.01<", ">0.1<", "2000 mV"] {
        assert!(svg.contains(words), "{words}: {svg}");
    }
    // One drawn by the scenario is the same figure, byte for byte.
    let sweeps = SWEEPS.replace("[0.2, 0.05, 0.1]", "[0.05, 0.01, 0.1]");
    let figure = "[[figure]]\nname = \"f\"\ntitle = \"Force & voltage\"\ny = \"damper.force\"\n";
    place.write("arm.toml", format!("{ARM}{sweeps}{figure}"));
    place.done(&["run", "arm.toml", "--out", "r", "--set", "time.output_step=0.01", "--quiet"]);
    assert_eq!(place.read("r/figures/f.svg"), svg);
}

#[test]
fn cases_columns_and_units_are_chosen() {
    let place = swept();
    let one = ["--where", "element.damper.alpha=0.050", "--where", "element.damper.u=2000 mV"];
    let draw = |arguments: &[&str]| {
        place.done(&[&["plot", "r"], arguments, &one, &["--out", "f.svg"]].concat());
        place.read("f.svg")
    };
    let svg = draw(&["damper.force", "--x", "damper.stroke", "--unit", "damper.*=mN", "--unit", "damper.stroke=mm"]);
    assert!(
        svg.contains("force F of damper, mN") && svg.contains("stroke x of damper, mm") && !svg.contains("2000 mV")
    );
    let svg = draw(&["damper.Q.*", "damper.force"]);
    for words in ["Q₁ of damper, N·m", "Q at x of damper, N", "force F of damper, N"] {
        assert!(svg.contains(words), "{words}: {svg}");
    }
    // results.csv by its own name, into a PNG.
    place.done(&["plot", "r/results.csv", "energy.*", "--where", one[1], "--out", "new/e.PNG"]);
    assert!(fs::read(place.path("new/e.PNG")).unwrap().starts_with(b"\x89PNG"));
}

#[test]
fn names_of_files_are_plain_and_no_figure_of_the_run_is_lost() {
    let place = Place::with(&format!("{ARM}[[figure]]\nname = \"t\"\ny = \"damper.force\"\n"));
    place.done(&["run", "arm.toml", "--out", "r", "--quiet"]);
    let drawn = place.read("r/figures/t.svg");
    place.done(&["plot", "r", "t"]);
    place.done(&["plot", "r", "damper.Q.?1", "v.*", "--x", "damper.stroke"]);
    let files = place.files("r/figures");
    assert!(files.contains(&"t-plot.svg".to_owned()), "{files:?}");
    assert!(files.contains(&"damper.Q._1-v._-over-damper.stroke.svg".to_owned()), "{files:?}");
    assert_eq!(place.read("r/figures/t.svg"), drawn);
}

#[test]
fn results_are_overlaid() {
    let place = Place::new();
    for (out, alpha) in [("slow", "0.3"), ("fast", "0.8")] {
        let set = format!("element.damper.alpha={alpha}");
        place.done(&["run", "arm.toml", "--out", out, "--set", &set, "--set", "time.output_step=0.01", "--quiet"]);
    }
    let ended = place.done(&["plot", "slow", "fast", "damper.force"]);
    assert_eq!(ended.stdout, "slow/figures/damper.force-with-fast.svg\nslow/figures/damper.force-with-fast.png\n");
    let svg = place.read("slow/figures/damper.force-with-fast.svg");
    assert!(svg.contains(">slow</text>") && svg.contains(">fast</text>") && svg.contains("force F of damper, N"));
    place.done(&["plot", "slow", "fast/results.csv", "damper.force", "damper.Q.x", "--out", "b.svg"]);
    let svg = place.read("b.svg");
    for text in ["slow", "fast", "force F of damper", "Q at x of damper", "force, N"] {
        assert!(svg.contains(&format!(">{text}</text>")), "{text}");
    }
    let ended = place.springpot(&["plot", "slow", "fast", "damper.forse"]);
    assert!(ended.code == Some(2) && ended.stderr.contains("did you mean `damper.force`?"), "{}", ended.stderr);
}

#[test]
fn values_are_found_as_written_and_in_si_and_files_tell_them() {
    let sweeps = "[[sweep]]\nparameter = \"motion.joints.x\"\nvalues = [{ expression = \"5*sin(2*pi*1*t)\", unit = \"mm\" }, \
                  { expression = \"5*sin(2*pi*2*t)\", unit = \"mm\" }]\n\
                  [[sweep]]\nparameter = \"element.damper.u\"\nvalues = [\"500 mV\", \"2 V\"]\n";
    let place = Place::with(&format!("{ARM}{sweeps}"));
    place.done(&["run", "arm.toml", "--out", "r", "--quiet"]);
    let one = "motion.joints.x={ expression = \"5*sin(2*pi*1*t)\", unit = \"mm\" }";
    place.done(&["plot", "r", "damper.force", "--where", one, "--out", "a.svg"]);
    assert!(place.read("a.svg").contains(">500 mV</text>"));
    let mut drawn = Vec::new();
    for value in ["500 mV", "0.5", "0.5 V"] {
        place.done(&["plot", "r", "damper.force", "--where", &format!("element.damper.u={value}"), "--out", "b.svg"]);
        drawn.push(place.read("b.svg"));
    }
    assert!(drawn[0] == drawn[1] && drawn[1] == drawn[2] && drawn[0].contains("5·sin(2π·1·t) mm"), "{}", drawn[0]);
    let before = place.files("r").len();
    for value in ["500 mV", "2 V"] {
        place.done(&["plot", "r", "damper.force", "--where", &format!("element.damper.u={value}")]);
    }
    place.done(&["plot", "r", "damper.force", "--where", one]);
    place.done(&["plot", "r", "damper.force", "--where", &one.replace("pi*1", "pi*2")]);
    let files = place.files("r");
    assert_eq!(files.len(), before + 8, "{files:?}");
    assert!(files.contains(&"figures/damper.force-u_500_mV.svg".to_owned()), "{files:?}");
}

#[test]
fn looks_are_those_of_scenarios() {
    let look = "y_range = [-5, 5]\nx_range = [0, 0.3]\ny_label = \"F, N\"\nsize = [\"90 mm\", \"60 mm\"]\nlegend = \"order\"\n\
                labels = { \"damper.*\" = \"force\" }\nwindow = [0.1, 0.2]\n";
    let sweep = "[[sweep]]\nparameter = \"element.damper.alpha\"\nvalues = [0.2, 0.5]\n";
    let place = Place::with(&format!("{ARM}{sweep}[[figure]]\nname = \"f\"\ny = \"damper.force\"\n{look}"));
    place.done(&["run", "arm.toml", "--out", "r", "--set", "time.output_step=0.01", "--quiet"]);
    let options = [
        "--y-range=-5,5",
        "--x-range",
        "0,300ms",
        "--y-label",
        "F, N",
        "--size",
        "90mm,60mm",
        "--legend",
        "order",
        "--label",
        "damper.*=force",
        "--window",
        "0.1,200ms",
        "--out",
        "f.svg",
    ];
    place.done(&[&["plot", "r", "damper.force"], &options[..]].concat());
    assert_eq!(place.read("f.svg"), place.read("r/figures/f.svg"));
    place.done(&["plot", "r", "gripper.x", "--x", "gripper.z", "--aspect", "equal", "--no-legend", "--out", "a.pdf"]);
    assert!(fs::read(place.path("a.pdf")).unwrap().starts_with(b"%PDF-1."));
}

#[test]
fn a_table_alone_is_drawn_without_units() {
    let place = Place::new();
    place.write("a.csv", "t,y\n0,1\n1,\n2,3\n");
    let ended = place.done(&["plot", "a.csv", "y", "--out", "a.svg"]);
    assert!(ended.stderr.contains("no run.json beside a.csv"), "{}", ended.stderr);
    assert!(place.read("a.svg").contains("<svg"));
}

#[test]
fn what_is_not_there_is_said() {
    let place = swept();
    fs::create_dir(place.path("empty")).unwrap();
    fs::create_dir(place.path("other")).unwrap();
    place.write("other/results.npz", "");
    place.write("text.csv", "t,y\n0,1\n1,one\n");
    place.write("ragged.csv", "t,y\n0,1\n1\n");
    place.write("none.csv", "t,y\n");
    place.write("void.csv", "");
    let before = place.files(".");
    for (arguments, words) in [
        (&["r", "damper.forse"][..], &["\"damper.forse\" matches no column", "did you mean `damper.force`?"][..]),
        (&["r", "t", "--x", "damper.*"], &["matches several columns"]),
        (&["r", "t", "--x", "tt"], &["matches no column"]),
        (&["r", "t", "--where", "element.damper.alfa=1"], &["is not swept", "element.damper.alpha"]),
        (&["r", "t", "--where", "element.damper.alpha=0.3"], &["no case has this value", "0.05"]),
        (&["r", "t", "--where", "element.damper.alpha"], &["has no `=`"]),
        (&["r", "t", "--unit", "t"], &["has no `=`"]),
        (&["r", "t", "--unit", "t=mm"], &["t is in s, which does not convert to mm"]),
        (&["r", "t", "--unit", "t=parsec"], &["parsec"]),
        (&["r", "t", "--out", "a.gif"], &["none of .svg, .png and .pdf"]),
        (&["r", "r"], &["no column is named", "strut.force"]),
        (&["r", "t", "--x-range", "3"], &["is not two values", "A,B"]),
        (&["r", "t", "--y-range=-1,-2"], &["--y-range -1,-2 runs from -1 to -2", "smaller end first"]),
        (&["r", "damper.force", "--y-range", "1mm,2mm"], &["holds 1 mm, but force F of damper is in N"]),
        (&["r", "t", "--y-scale", "log", "--y-range", "0,1"], &["logarithmic", "above zero"]),
        (&["r", "t", "--size", "90,60"], &["90 is no side of a figure", "as in 90mm,60mm"]),
        (&["r", "damper.force", "--aspect", "equal"], &["different units"]),
        (&["r", "t", "--label", "t"], &["has no `=`"]),
        (&["r", "t", "--label", "tt=time"], &["\"tt\" matches no column"]),
        (&["r", "t", "--window", "2,1"], &["no stretch of time"]),
        (&["r", "t", "--window", "2,3"], &["no row lies in it"]),
        (&["r", "*"], &["more than 64 curves", "--where"]),
        (&["nowhere", "t"], &["cannot be opened", "results/arm"]),
        (&["empty", "t"], &["holds no results.csv"]),
        (&["other", "t"], &["plot reads CSV", "--format csv"]),
        (&["text.csv", "y"], &["text.csv:3: \"one\" in column \"y\" is not a number"]),
        (&["ragged.csv", "y"], &["ragged.csv:3: 1 fields where the header has 2"]),
        (&["none.csv", "y"], &["no rows to draw"]),
        (&["void.csv", "y"], &["has no columns"]),
    ] {
        let ended = place.springpot(&[&["plot"], arguments].concat());
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{arguments:?}");
        assert!(words.iter().all(|word| ended.stderr.contains(word)), "{arguments:?}: {}", ended.stderr);
    }
    assert_eq!(place.files("."), before);
    let failed = place.springpot(&["plot", "r", "t", "--out", "text.csv/a.svg"]);
    assert!(failed.code == Some(1) && failed.stderr.contains("cannot be written"), "{}", failed.stderr);
}

/// Orders and voltages with a metric, and summaries over them.
const SURVEYED: &str = r#"
[[metric]]
name = "peak"
of = "damper.force"
kind = "max"
[[sweep]]
parameter = "element.damper.alpha"
values = [0.2, 0.6, 0.4]
[[sweep]]
parameter = "element.damper.u"
values = ["1 V", "4 V"]
[[figure]]
name = "survey"
kind = "summary"
x = "element.damper.alpha"
y = ["max(damper.force)", "rms(damper.force)", "final(damper.force)"]
units = { "damper.force" = "mN" }
window = [0.1, 0.3]
[[figure]]
name = "peaks"
kind = "summary"
x = "element.damper.u"
y = "metric(peak)"
[[figure]]
name = "some"
kind = "summary"
x = "element.damper.u"
y = "mean(damper.force)"
where = { "element.damper.alpha" = 0.4 }
"#;

#[test]
fn statistics_over_a_swept_parameter_as_a_run_draws_them() {
    let place = Place::with(&format!("{ARM}{SURVEYED}"));
    place.done(&["run", "arm.toml", "--out", "r", "--set", "time.output_step=0.01", "--quiet"]);
    let same = |name: &str, arguments: &[&str]| {
        place.done(&[&["plot", "r"], arguments, &["--out", "f.svg"]].concat());
        assert_eq!(place.read("f.svg"), place.read(format!("r/figures/{name}.svg")), "{name}");
    };
    let look = ["--x", "element.damper.alpha", "--unit", "damper.force=mN", "--window", "0.1,0.3"];
    same("survey", &[&["max(damper.force)", "rms(damper.force)", "final(damper.force)"], &look[..]].concat());
    same("peaks", &["metric(peak)", "--x", "element.damper.u"]);
    same("some", &["mean(damper.force)", "--x", "element.damper.u", "--where", "element.damper.alpha=0.4"]);
    // The only parameter needs no name, and one that moves with others has the numbers of the rows.
    let zipped = "[[sweep]]\nparameter = [\"element.damper.alpha\", \"element.damper.u\"]\nvalues = [[0.2, \"1 V\"], [0.5, \"t\"]]\n";
    place.write("one.toml", format!("{ARM}[[sweep]]\nparameter = \"element.damper.alpha\"\nvalues = [0.2, 0.5]\n"));
    place.write("two.toml", format!("{ARM}{zipped}"));
    place.done(&["run", "one.toml", "--out", "one", "--quiet"]);
    place.done(&["run", "two.toml", "--out", "two", "--quiet"]);
    place.done(&["plot", "one", "max(damper.force)", "--out", "f.svg"]);
    place.done(&["plot", "two", "max(damper.*)", "--x", "element.damper.alpha", "--out", "g.svg"]);
    place.done(&["plot", "one", "two", "max(damper.force)", "--x", "element.damper.alpha", "--out", "h.svg"]);
    assert!(place.read("h.svg").contains(">one<") && place.read("h.svg").contains(">two<"));
    let refused = |arguments: &[&str], message: &str| {
        let ended = place.springpot(&[&["plot"], arguments].concat());
        assert_eq!(ended.code, Some(2), "{arguments:?}: {}", ended.stderr);
        assert!(ended.stderr.contains(message), "{arguments:?}: {}", ended.stderr);
    };
    refused(&["r", "max(damper.force)"], "choose one with --x: element.damper.alpha, element.damper.u");
    refused(&["r", "max(damper.force)", "damper.force"], "is no statistic");
    refused(&["r", "max(damper.farce)", "--x", "element.damper.u"], "matches no column");
    refused(&["r", "metric(peek)", "--x", "element.damper.u"], "peak");
    refused(&["r", "max(damper.force)", "--x", "damper.force"], "it is not swept in r");
    refused(&["one", "metric(peak)"], "holds no metrics.csv");
    refused(
        &["two", "max(damper.force)", "--x", "element.damper.u"],
        "a summary over element.damper.u needs numbers, and t is none",
    );
    place.done(&["run", "arm.toml", "--out", "p", "--set", "time.end=0.1", "--quiet"]);
    fs::remove_file(place.path("p/run.json")).unwrap();
    refused(&["p", "max(damper.force)"], "has no sweep");
}
