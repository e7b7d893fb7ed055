//! What is refused of measurements, and where it stands.

use springpot::law::Catalog;
use springpot_scenario::{Fitting, Scenario};
use std::fs;
use std::path::Path;

const PAD: &str = r#"[[element]]
name = "pad"
law = "fractional-kelvin-voigt"
parameters = { k = "100 N/m", c = 50, alpha = 0.5 }
[[parameter]]
name = "alpha"
path = "element.pad.alpha"
[[data]]
name = "dma"
kind = "dma"
element = "pad"
csv = "dma.csv"
columns = { frequency = "f", storage = "E1", loss = "E2" }
"#;

/// A slider that a spring pulls back.
const SLIDER: &str = r#"[[robot.body]]
name = "end"
joint = { name = "x", kind = "prismatic", axis = [1, 0, 0] }
mass = 1
[[element]]
name = "pad"
joint = "x"
law = "kelvin-voigt"
parameters = { k = 100, c = 1 }
[motion]
kind = "forward"
start = { q = { x = 0.1 } }
[time]
end = 1
output_step = 0.1
[[parameter]]
name = "k"
path = "element.pad.k"
[[data]]
csv = "x.csv"
columns = { "q.x" = "x" }
"#;

fn files(folder: &Path) {
    let put = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
    put("dma.csv", "f,E1,E2,T\n0.1,110,20,300\n1,130,50,300\n10,,100,300\n100,300,200,300\n");
    put("x.csv", "t,x\n0,0.1\n0.2,0.07\n0.5,0\n0.7,-0.03\n1,-0.05\n");
    put("late.csv", "t,x\n0,0.1\n0.5,0\n1.5,-0.05\n");
    put("back.csv", "t,x\n0,0.1\n0.5,0\n0.5,-0.05\n");
    put("nan.csv", "t,x\n0,0.1\n0.5,nan\n1,-0.05\n");
    put("units.csv", "f,E1,E2\nHz, MPa, kPa\n0.1,110,20\n1,130,50\n");
    put("none.csv", "t,x\n");
    put("zero.csv", "f,E1,E2\n0,110,20\n1,130,50\n");
}

fn read(text: &str, folder: &Path) -> Result<Fitting, String> {
    files(folder);
    let scenario = Scenario::parse(text, "a.toml", folder).map_err(|refusals| refusals.to_string())?;
    scenario.fit(&Catalog::standard()).map_err(|refusals| refusals.to_string())
}

#[test]
fn what_is_wrong_is_refused_where_it_stands() {
    let folder = tempfile::tempdir().unwrap();
    let cases: [(&str, &str, &str, &str); 38] = [
        (
            PAD,
            "element.pad.alpha\"",
            "element.pad.law\"",
            "a.toml:7:8: element.pad.law cannot be a parameter: it is the text",
        ),
        (
            PAD,
            "element.pad.alpha\"",
            "element.pad.alpha\"\nbounds = [0.2, 1.5]",
            "a.toml:8:10: `bounds` of parameter \"alpha\" are 0.2 … 1.5, and its place takes 0 … 1",
        ),
        (
            PAD,
            "element.pad.alpha\"",
            "element.pad.alpha\"\nbounds = [0.6, 0.9]",
            "a.toml:8:10: `bounds` of parameter \"alpha\" is 0.6 … 0.9, and the file begins outside, at 0.5",
        ),
        (
            PAD,
            "element.pad.alpha\"",
            "element.pad.c\"\nscale = \"logit\"",
            "a.toml:5:1: the parameter \"alpha\": it moves between bounds, and has not both",
        ),
        (PAD, "dma.csv", "zero.csv", "a.toml:12:7: `csv` of data \"dma\" has 0 in frequency on line 2"),
        (PAD, "dma.csv", "units.csv", "a.toml:13:40: `storage` of `columns` of data \"dma\" has the unit \"MPa\""),
        (
            PAD,
            "[[data]]",
            "[fit]\nlaws = [\"series(spring(k), springpot(c))\"]\n[[data]]",
            "a.toml:9:28: `laws` of [fit]: `springpot` takes 2 names, not 1",
        ),
        (PAD, "[[data]]", "[[dat]]", "a.toml:8:3: unknown key `dat`"),
        (PAD, "kind = \"dma\"", "kind = \"dmc\"", "a.toml:10:8: `kind` of data \"dma\" is \"dmc\""),
        (PAD, "element = \"pad\"\n", "", "a.toml:8:1: data \"dma\" has no `element`"),
        (PAD, "element = \"pad\"", "element = \"pod\"", "a.toml:11:11: \"pod\" is no element"),
        (PAD, "\"dma.csv\"", "\"no.csv\"", "a.toml:12:7: `csv` of data \"dma\" cannot be read"),
        (PAD, "loss = \"E2\"", "loss = \"E3\"", "a.toml:13:53: `loss` of `columns` of data \"dma\" is \"E3\""),
        (PAD, ", loss = \"E2\"", "", "a.toml:13:11: `columns` of data \"dma\" has no `loss`"),
        (PAD, "loss = \"E2\"", "lost = \"E2\"", "a.toml:13:53: `columns` of data \"dma\" has no \"lost\""),
        (
            PAD,
            "loss = \"E2\"",
            "loss = \"E2\", T = \"T\"",
            "a.toml:13:63: `T` of `columns` of data \"dma\" says nothing",
        ),
        (
            PAD,
            "loss = \"E2\"",
            "loss = { column = \"E2\", unit = \"mm\" }",
            "a.toml:13:77: `unit` of `loss` of `columns` of data \"dma\" has the unit \"mm\"",
        ),
        (
            PAD,
            "columns",
            "window = [0, 1]\ncolumns",
            "a.toml:13:1: `window` of data \"dma\" has no meaning where kind = \"dma\"",
        ),
        (PAD, "columns", "area = \"1 cm^2\"\ncolumns", "a.toml:13:8: `area` of data \"dma\" stands without `length`"),
        (PAD, "columns", "relative_sd = -1\ncolumns", "a.toml:13:15: `relative_sd` of data \"dma\" is -1"),
        (PAD, "columns", "use = \"nothing\"\ncolumns", "a.toml:13:7: `use` of data \"dma\" is \"nothing\""),
        (PAD, "columns", "use = \"validation\"\ncolumns", "a.toml:8:1: every record is a validation"),
        (PAD, "columns", "loss = { huber = 0 }\ncolumns", "a.toml:13:18: `huber`"),
        (
            PAD,
            "columns",
            "set = { \"element.pad.alpha\" = 0.3 }\ncolumns",
            "a.toml:13:9: element.pad.alpha is set, and is the parameter \"alpha\"",
        ),
        (
            PAD,
            "path = \"element.pad.alpha\"",
            "path = \"element.pad.alpha\"\nbounds = [0.6, 0.9]",
            "a.toml:8:10: `bounds` of parameter \"alpha\"",
        ),
        (
            PAD,
            "path = \"element.pad.alpha\"",
            "path = \"element.pad.alpha\"\nstart = 2",
            "a.toml:5:1: \"alpha\" starts at [2.0], outside 0 … 1",
        ),
        (PAD, "alpha = 0.5", "alpha = 1", "a.toml:5:1: alpha cannot be a parameter: it is 1"),
        (
            PAD,
            "[[parameter]]\nname = \"alpha\"\npath = \"element.pad.alpha\"\n",
            "",
            "a.toml:5:1: there is no parameter",
        ),
        (PAD, "[[data]]", "[fit]\nstarts = 0\n[[data]]", "a.toml:9:10: `starts` of [fit] is 0"),
        (PAD, "[[data]]", "[fit]\nintervals = \"bootstrap(2)\"\n[[data]]", "a.toml:9:13: `intervals` of [fit]"),
        (PAD, "[[data]]", "[fit]\nlaws = [\"spring2\"]\n[[data]]", "a.toml:9:9: `laws` of [fit] names \"spring2\""),
        (
            PAD,
            "[[data]]",
            "[[sweep]]\nparameter = \"element.pad.k\"\nvalues = [1, 2]\n[[data]]",
            "a.toml:8:1: a fit has no sweeps",
        ),
        (SLIDER, "\"q.x\" = \"x\"", "\"q.y\" = \"x\"", "a.toml:21:21: `columns` of data \"data-1\" names \"q.y\""),
        (
            SLIDER,
            "\"q.x\" = \"x\"",
            "\"energy.residual\" = \"x\"",
            "a.toml:21:33: \"energy.residual\" cannot be fitted",
        ),
        (
            SLIDER,
            "x.csv",
            "late.csv",
            "a.toml:20:7: `csv` of data \"data-1\" has t = 1.5 s on line 4, but the run goes from 0 s to 1 s",
        ),
        (SLIDER, "x.csv", "back.csv", "a.toml:20:7: `csv` of data \"data-1\" has t = 0.5 s on line 4 behind 0.5 s"),
        (SLIDER, "x.csv", "nan.csv", "a.toml:20:7: `csv` of data \"data-1\" cannot be read"),
        (SLIDER, "x.csv", "none.csv", "a.toml:20:7: `csv` of data \"data-1\" has no rows"),
    ];
    let mut wrong = Vec::new();
    for (text, old, new, said) in cases {
        assert!(text.contains(old), "{old}");
        match read(&text.replacen(old, new, 1), folder.path()) {
            Err(told) if told.starts_with(said) => {}
            Err(told) => {
                wrong.push(format!("{new}\n  told   {}\n  wanted {said}", told.lines().next().unwrap_or_default()))
            }
            Ok(_) => wrong.push(format!("{new}\n  is taken\n  wanted {said}")),
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn records_are_in_si_and_what_lacks_a_cell_is_skipped() {
    let folder = tempfile::tempdir().unwrap();
    let fitting = read(PAD, folder.path()).unwrap();
    let data = &fitting.plan().data[0];
    assert_eq!((data.at.len(), data.skipped, data.lines.as_slice()), (3, 1, &[2, 3, 5][..]));
    assert!((data.at[0] - std::f64::consts::TAU * 0.1).abs() < 1e-15);
    assert_eq!(data.columns[0].measured, [110.0, 130.0, 300.0]);
    // Units in a row of their own, and moduli of a sample.
    let sample = "area = \"4 cm^2\"\nlength = \"10 mm\"\ncolumns";
    let fitting = read(&PAD.replace("dma.csv", "units.csv").replace("columns", sample), folder.path()).unwrap();
    let data = &fitting.plan().data[0];
    let near = |own: &[f64], wanted: [f64; 2]| own.iter().zip(wanted).all(|(a, b)| (a / b - 1.0).abs() < 1e-14);
    assert!(near(&data.columns[0].measured, [4.4e6, 5.2e6]), "{:?}", data.columns[0].measured);
    assert!(near(&data.columns[1].measured, [800.0, 2000.0]), "{:?}", data.columns[1].measured);
}

#[test]
fn fitted_values_go_where_they_stand() {
    let folder = tempfile::tempdir().unwrap();
    let text =
        SLIDER.replace("columns =", "free = [\"motion.start.v.x\", \"motion.start.q.x\"]\noffset = \"q.x\"\ncolumns =");
    let fitting = read(&text.replace("k = 100, c", "k = \"100 N/m\", c"), folder.path()).unwrap();
    let names: Vec<&str> = fitting.plan().parameters.iter().map(|one| one.sought.name.as_str()).collect();
    assert_eq!(names, ["k", "data-1.motion.start.v.x", "data-1.motion.start.q.x", "data-1.offset.q.x"]);
    let fitted = fitting.fitted(&[123.5, -0.5, 0.25, 9.0]);
    assert!(fitted.contains("parameters = { k = \"123.5 N/m\", c = 1 }"), "{fitted}");
    for set in ["motion.start.v.x\" = \"-0.5 m/s\"", "motion.start.q.x\" = \"0.25 m\""] {
        assert!(fitted.contains(set), "{set}: {fitted}");
    }
    let again = Scenario::parse(&fitted, "b.toml", folder.path()).unwrap();
    let again = again.fit(&Catalog::standard()).unwrap_or_else(|refusals| panic!("{refusals}\n{fitted}"));
    let starts: Vec<f64> = again.plan().parameters.iter().map(|one| one.sought.start[0]).collect();
    assert_eq!(starts, [123.5, -0.5, 0.25, 0.0]);
}
