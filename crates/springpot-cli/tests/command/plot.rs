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
        (&["r", "t", "--out", "a.pdf"], &["neither .svg nor .png"]),
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
