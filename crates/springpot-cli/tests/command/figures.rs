//! Figures of runs: which curves, panels, legends and labels they have.

use crate::support::{ARM, Place};

/// Two sweeps: the first makes curves, the second panels.
const SWEEPS: &str = "
[[sweep]]
parameter = \"element.damper.alpha\"
values = [0.2, 0.5, 1.0]
[[sweep]]
parameter = \"element.damper.u\"
values = [\"0 V\", \"2 V\"]
";

/// The words of an SVG, without its marks.
fn words(svg: &str) -> String {
    let body = &svg[svg.find("<rect").unwrap()..];
    let mut words = String::new();
    let mut inside = false;
    for c in body.chars() {
        match c {
            '<' => inside = true,
            '>' => {
                inside = false;
                words.push(' ');
            }
            _ if !inside => words.push(c),
            _ => {}
        }
    }
    words.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn drawn(figure: &str) -> (Place, String) {
    let place = Place::with(&format!("{ARM}{SWEEPS}\n[[figure]]\nname = \"f\"\n{figure}\n"));
    let ended = place.done(&["run", "arm.toml", "--set", "time.output_step=0.01"]);
    assert_eq!(ended.stderr, "");
    let png = std::fs::read(place.path("results/arm/figures/f.png")).unwrap();
    assert!(png.starts_with(b"\x89PNG\r\n\x1a\n") && png.len() > 5_000);
    let svg = place.read("results/arm/figures/f.svg");
    assert!(svg.starts_with("<svg") || svg.starts_with("<?xml"));
    (place, svg)
}

#[test]
fn the_first_sweep_makes_curves_and_the_second_panels() {
    let (_, svg) = drawn("title = \"Force of the damper\"\ny = [\"damper.force\"]");
    let words = words(&svg);
    for text in
        ["Force of the damper", "force F of damper, N", "time t, s", "α", "0.2", "0.5", "1.0", "u = 0 V", "u = 2 V"]
    {
        assert!(words.contains(text), "no {text:?} in {words}");
    }
    assert_eq!(words.matches("u = ").count(), 2, "{words}");
}

#[test]
fn where_chooses_and_units_convert() {
    let (place, svg) = drawn(
        "y = [\"damper.force\"]\nwhere = { \"element.damper.u\" = \"2 V\" }\nunits = { \"damper.force\" = \"mN\" }",
    );
    let words = words(&svg);
    assert!(words.contains("force F of damper, mN") && !words.contains("u = "), "{words}");
    // The axis reaches as far as the largest force, in mN.
    let results = place.table("results/arm/results.csv");
    let forces = results.numbers("damper.force").into_iter().zip(results.numbers("element.damper.u"));
    let largest = forces.filter(|(_, u)| *u == 2.0).map(|(force, _)| 1e3 * force.abs()).fold(0.0, f64::max);
    let numbers = words.split(' ').filter_map(|word| word.replace('−', "-").parse::<f64>().ok());
    let tick = numbers.fold(0.0f64, |most, number| most.max(number.abs()));
    assert!(tick > 0.5 * largest && tick < 1.5 * largest, "{tick} {largest}: {words}");
}

#[test]
fn several_columns_of_one_case_are_told_apart() {
    let figure = "x = \"damper.stroke\"\ny = [\"damper.Q.*\"]\n\
                  where = { \"element.damper.u\" = \"2 V\", \"element.damper.alpha\" = 0.5 }";
    let words = words(&drawn(figure).1);
    for text in ["stroke x of damper, m", "Q₁ of damper", "Q at x of damper"] {
        assert!(words.contains(text), "no {text:?} in {words}");
    }
}

#[test]
fn curves_of_several_columns_and_cases_say_which_is_which() {
    let figure = "y = [\"damper.Q.*\", \"damper.stroke\"]\nwhere = { \"element.damper.u\" = \"2 V\" }";
    let words = words(&drawn(figure).1);
    // Three units are three panels, each with the name of its column; colours are the swept values.
    for text in ["Q₁ of damper, N·m", "Q at x of damper, N", "stroke x of damper, m", "α 0.2 0.5 1.0"] {
        assert!(words.contains(text), "{text}: {words}");
    }
}

#[test]
fn the_robot_is_drawn_with_its_names() {
    let (_, svg) = drawn("kind = \"robot\"\ntitle = \"The arm\"");
    let words = words(&svg);
    for text in ["The arm", "damper", "q₁", "arm", "slide", "H", "0.1 m"] {
        assert!(words.contains(text), "no {text:?} in {words}");
    }
}

#[test]
fn figures_that_cannot_be_drawn_are_left_out_with_a_word() {
    let sweep = "[[sweep]]\nparameter = \"element.damper.mu\"\nvalues = { from = 1, to = 2, count = 65 }\n";
    let place = Place::with(&format!("{ARM}{sweep}[[figure]]\nname = \"many\"\ny = \"t\"\n"));
    let ended = place.done(&["run", "arm.toml"]);
    assert!(
        ended.stderr.contains("warning: figure \"many\" is not drawn: it would hold 65 curves"),
        "{}",
        ended.stderr
    );
    assert_eq!(place.files("results/arm"), ["results.csv", "run.json", "summary.csv"]);
}

#[test]
fn figures_are_refused_before_anything_runs() {
    for (figure, words) in [
        ("y = \"damper.forces\"", "did you mean `damper.force`?"),
        ("y = \"damper.force\"\nunits = { \"damper.force\" = \"m\" }", "does not convert to m"),
        ("y = \"damper.force\"\nx = \"damper.Q.*\"", "x matches several columns"),
        ("y = \"damper.force\"\nname = \"../up\"", "not a file name"),
        ("y = \"damper.force\"\nwhere = { \"element.damper.u\" = 1 }", "not swept"),
    ] {
        let place = Place::with(&format!("{ARM}[[figure]]\n{figure}\n"));
        for command in ["run", "check"] {
            let ended = place.springpot(&[command, "arm.toml"]);
            assert_eq!(ended.code, Some(2), "{figure}");
            assert!(ended.stderr.starts_with("error: arm.toml:3") && ended.stderr.contains(words), "{}", ended.stderr);
        }
        assert!(!place.path("results").exists());
    }
}

#[test]
fn long_curves_are_thinned_alike_however_they_are_drawn() {
    let sweep = "[[sweep]]\nparameter = \"element.damper.alpha\"\nvalues = [0.2, 0.5]\n";
    let figures = "[[figure]]\nname = \"force\"\ny = \"damper.force\"\n\
                   [[figure]]\nname = \"loop\"\nx = \"damper.stroke\"\ny = \"damper.force\"\n";
    let output = "[output]\ncolumns = [\"t\", \"damper.force\", \"damper.stroke\"]\n";
    let place = Place::with(&format!("{ARM}{sweep}{figures}{output}"));
    // 87 501 rows a case, more than a curve keeps.
    for jobs in ["1", "2"] {
        place.done(&["run", "arm.toml", "--set", "time.output_step=4e-6", "--out", jobs, "--jobs", jobs, "--quiet"]);
    }
    place.done(&["plot", "2", "damper.force", "--out", "force.svg"]);
    place.done(&["plot", "2", "damper.force", "--x", "damper.stroke", "--out", "loop.svg"]);
    for name in ["force.svg", "loop.svg"] {
        let svg = place.read(format!("1/figures/{name}"));
        assert!(svg == place.read(format!("2/figures/{name}")) && svg == place.read(name), "{name}");
        assert!(svg.len() > 3_000 && svg.len() < 600_000, "{name}: {}", svg.len());
    }
}
