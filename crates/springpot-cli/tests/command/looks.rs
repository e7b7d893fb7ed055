//! How figures look: ranges, scales, sizes, words, formats, windows, statistics.

use crate::support::{ARM, Place};

const SWEEP: &str = "
[[sweep]]
parameter = \"element.damper.alpha\"
values = [0.2, 0.5, 1.0]
";

/// Draws one figure of the swept arm.
fn drawn(figure: &str) -> (Place, String) {
    let place = Place::with(&format!("{ARM}{SWEEP}\n[[figure]]\nname = \"f\"\n{figure}\n"));
    let ended = place.done(&["run", "arm.toml", "--set", "time.output_step=0.01"]);
    assert_eq!(ended.stderr, "");
    let svg = place.read("results/arm/figures/f.svg");
    (place, svg)
}

/// Texts of an SVG, without its marks.
fn texts(svg: &str) -> Vec<String> {
    let texts = svg.split("<text").skip(1).map(|rest| {
        let inner = rest.split_once('>').unwrap().1.split("</text>").next().unwrap();
        inner.split('<').map(|piece| piece.split_once('>').map_or(piece, |(_, text)| text)).collect::<String>()
    });
    texts.collect()
}

fn has(svg: &str, text: &str) -> bool {
    texts(svg).iter().any(|other| other == text)
}

/// Numbers at the axes and in the legend.
fn numbers(svg: &str) -> Vec<f64> {
    texts(svg).iter().filter_map(|text| text.replace('−', "-").parse().ok()).collect()
}

/// Width and height on paper, mm.
fn size(svg: &str) -> [f64; 2] {
    ["width", "height"].map(|name| {
        let rest = &svg[svg.find(&format!(" {name}=\"")).unwrap() + name.len() + 3..];
        rest.split('"').next().unwrap().parse::<f64>().unwrap() * 25.4 / 96.0
    })
}

#[test]
fn ranges_scales_and_labels_are_those_that_are_asked_for() {
    let (_, svg) = drawn("y = \"damper.force\"\ny_range = [-7, \"8000 mN\"]\nx_range = [\"100 ms\", 0.2]");
    let shown = numbers(&svg);
    assert!(
        shown.iter().all(|n| (-7.0..=8.0).contains(n)) && shown.contains(&0.1) && shown.contains(&0.2),
        "{shown:?}"
    );
    assert!(!shown.contains(&0.3), "{shown:?}");

    let labels = "x_label = \"time\"\ny_label = \"F_{d}, N\"\nlegend = \"order\"";
    let (_, svg) = drawn(&format!("y = \"damper.force\"\n{labels}"));
    for text in ["time", "Fd, N", "order", "0.2", "1.0"] {
        assert!(has(&svg, text), "{text}: {:?}", texts(&svg));
    }
    let (_, svg) = drawn("y = \"damper.force\"\nlegend = false");
    assert!(!has(&svg, "α") && !has(&svg, "0.5"), "{:?}", texts(&svg));

    let (_, svg) = drawn("y = \"damper.stored\"\ny_scale = \"log\"\ny_range = [1e-6, 1]");
    assert!(has(&svg, "10⁻⁶") && has(&svg, "10⁻²"), "{:?}", texts(&svg));
    let (_, svg) = drawn("y = [\"damper.force\", \"damper.Q.x\"]\nlabels = { \"damper.Q.*\" = \"pull\" }");
    assert!(has(&svg, "pull") && has(&svg, "force F of damper") && has(&svg, "force, N"), "{:?}", texts(&svg));
}

#[test]
fn sizes_formats_and_windows() {
    let figure =
        "y = \"damper.force\"\nsize = [\"90 mm\", \"6 cm\"]\nformats = [\"pdf\", \"svg\"]\nwindow = [0.1, \"200 ms\"]";
    let (place, svg) = drawn(figure);
    let [width, height] = size(&svg);
    assert!((width - 90.0).abs() < 0.01 && (height - 60.0).abs() < 0.01, "{width} {height}");
    let shown = numbers(&svg);
    assert!(shown.contains(&0.10) && shown.contains(&0.20) && !shown.contains(&0.0), "{shown:?}");
    let files = place.files("results/arm/figures");
    assert_eq!(files, ["f.pdf", "f.svg"]);
    let pdf = std::fs::read(place.path("results/arm/figures/f.pdf")).unwrap();
    assert!(pdf.starts_with(b"%PDF-1.") && pdf.ends_with(b"%%EOF"));
    let listed = place.record("results/arm")["files"].to_string();
    assert!(listed.contains("figures/f.pdf") && !listed.contains("f.png"), "{listed}");
    // A later run draws other formats, and what it does not draw goes.
    let text = place.read("arm.toml").replace("[\"pdf\", \"svg\"]", "[\"png\"]");
    place.write("arm.toml", text);
    let ended = place.done(&["run", "arm.toml"]);
    assert!(ended.stdout.contains("1 figure (PNG)") || ended.stdout.contains("figure\u{a0}(PNG)"), "{}", ended.stdout);
    assert_eq!(place.files("results/arm/figures"), ["f.png"]);
}

#[test]
fn figures_of_one_scenario_have_one_width() {
    let figures = "[[figure]]\nname = \"a\"\ny = \"damper.force\"\n[[figure]]\nname = \"b\"\ny = \"damper.*\"\n\
                   where = { \"element.damper.alpha\" = 0.5 }\n[[figure]]\nname = \"c\"\nkind = \"robot\"\n\
                   [[figure]]\nname = \"d\"\ny = \"v.*\"\nlabels = { \"v.q1\" = \"a name that is far longer than any other name of a column\" }\n";
    let place = Place::with(&format!("{ARM}{SWEEP}{figures}"));
    place.done(&["run", "arm.toml"]);
    for name in ["a", "b", "c", "d"] {
        let [width, _] = size(&place.read(format!("results/arm/figures/{name}.svg")));
        assert!((width - 150.0).abs() < 0.01, "{name}: {width}");
    }
}

#[test]
fn two_units_have_two_axes_and_more_have_panels() {
    let (_, svg) =
        drawn("y = [\"damper.force\", \"damper.stroke\"]\nunits = { \"damper.stroke\" = \"mm\", t = \"ms\" }");
    for text in ["force F of damper, N", "stroke x of damper, mm", "time t, ms"] {
        assert!(has(&svg, text), "{text}: {:?}", texts(&svg));
    }
    // Each axis has the name of its column, and so has the legend.
    let words = texts(&svg).join(" ");
    assert_eq!(words.matches("stroke x of damper, mm").count(), 2, "{words}");
    assert!(!svg.contains("×10³") && numbers(&svg).contains(&300.0), "{:?}", texts(&svg));
    let (_, svg) = drawn("y = [\"damper.force\", \"damper.stroke\", \"damper.stored\", \"damper.u\"]");
    let words = texts(&svg).join(" ");
    for text in ["force F of damper, N", "stroke x of damper, m", "energy stored in damper, J", "u of damper, V"] {
        assert_eq!(words.matches(text).count(), 1, "{text}: {words}");
    }
    assert_eq!(texts(&svg).iter().filter(|text| *text == "time t, s").count(), 1);
}

#[test]
fn several_columns_say_which_they_are_and_the_axis_their_quantity() {
    let (_, svg) = drawn("y = [\"q.*\"]\nwhere = { \"element.damper.alpha\" = 0.5 }\ny_range = [-1, 1]");
    // A turn and a shift have different units.
    assert!(has(&svg, "q₁, rad") && has(&svg, "x, m"), "{:?}", texts(&svg));
    let (_, svg) = drawn("y = [\"damper.stored\", \"energy.kinetic\"]\nwhere = { \"element.damper.alpha\" = 0.5 }");
    for text in ["energy, J", "energy stored in damper", "kinetic energy"] {
        assert!(has(&svg, text), "{text}: {:?}", texts(&svg));
    }
    // A swept value is a colour, a column a dash.
    let (_, svg) = drawn("y = [\"damper.stored\", \"energy.kinetic\"]");
    for text in ["energy, J", "α", "0.5", "1.0", "energy stored in damper", "kinetic energy"] {
        assert_eq!(texts(&svg).iter().filter(|other| *other == text).count(), 1, "{text}: {:?}", texts(&svg));
    }
    assert_eq!(svg.matches("stroke-width=\"1.7\" stroke-dasharray").count(), 3);
}

#[test]
fn legends_are_short_and_have_symbols() {
    let legend = |sweep: &str| {
        let text = format!("{ARM}{sweep}[[figure]]\nname = \"f\"\ny = \"damper.force\"\n");
        let place = Place::with(&text);
        place.done(&["run", "arm.toml"]);
        texts(&place.read("results/arm/figures/f.svg"))
    };
    let shown =
        legend("[[sweep]]\nparameter = \"element.damper.alpha\"\nvalues = { from = 0.1, to = 0.9, count = 7 }\n");
    for text in ["0.1", "0.2333", "0.3667", "0.9"] {
        assert!(shown.iter().any(|other| other == text), "{text}: {shown:?}");
    }
    let expressions = "[[sweep]]\nparameter = \"motion.joints.x\"\n\
        values = [{ expression = \"5*sin(2*pi*1*t)\", unit = \"mm\" }, { expression = \"5*sin(2*pi*2*t)\", unit = \"mm\" }]\n";
    let shown = legend(expressions);
    assert!(shown.iter().any(|text| text == "5·sin(2π·2·t) mm"), "{shown:?}");
    let shown = legend("[[sweep]]\nparameter = \"element.damper.E_c\"\nvalues = [\"20 N/m\", \"30 N/m\"]\n");
    assert!(shown.iter().any(|text| text == "Ec"), "{shown:?}");
}

#[test]
fn statistics_are_drawn_over_a_swept_parameter() {
    let figure =
        "kind = \"summary\"\nx = \"element.damper.alpha\"\ny = [\"max(damper.force)\", \"final(damper.force)\"]";
    let (place, svg) = drawn(figure);
    for text in ["α", "force F, N", "max of force F of damper", "final of force F of damper"] {
        assert!(has(&svg, text), "{text}: {:?}", texts(&svg));
    }
    // Three marks on each of the two curves.
    assert_eq!(svg.matches("<circle").count(), 6);
    // The upper curve begins, at α = 0.2, as far above the lower one as the largest force is above the last.
    let forces = place.table("results/arm/results.csv").numbers("damper.force");
    let of_first = &forces[..forces.len() / 3];
    let largest = of_first.iter().copied().fold(f64::MIN, f64::max);
    let ticks: Vec<(f64, f64)> = svg
        .lines()
        .filter(|line| line.contains("text-anchor=\"end\""))
        .map(|line| {
            let y = line.split(" y=\"").nth(1).unwrap().split('"').next().unwrap().parse().unwrap();
            (y, texts(line)[0].replace('−', "-").parse().unwrap())
        })
        .collect();
    let centers = svg.lines().filter(|line| line.starts_with("<circle"));
    let heights: Vec<f64> =
        centers.map(|line| line.split("cy=\"").nth(1).unwrap().split('"').next().unwrap().parse().unwrap()).collect();
    let per_newton = (ticks[0].0 - ticks[1].0) / (ticks[1].1 - ticks[0].1);
    let between = (heights[3] - heights[0]) / per_newton;
    let wanted = largest - of_first[of_first.len() - 1];
    assert!(wanted > 0.0 && (between - wanted).abs() < 0.01 * wanted, "{between} {wanted}");
    // A second sweep makes curves, and quantities have their unit.
    let sweeps =
        format!("{SWEEP}[[sweep]]\nparameter = \"element.damper.u\"\nvalues = [\"0 V\", \"2000 mV\", \"4 V\"]\n");
    let figure = "[[figure]]\nname = \"f\"\nkind = \"summary\"\nx = \"element.damper.u\"\ny = \"rms(damper.force)\"\nwindow = [0.1, 0.3]\n";
    let place = Place::with(&format!("{ARM}{sweeps}{figure}"));
    place.done(&["run", "arm.toml", "--set", "time.output_step=0.01"]);
    let svg = place.read("results/arm/figures/f.svg");
    for text in ["u, V", "rms of force F of damper, N", "α", "0.5", "4.0"] {
        assert!(has(&svg, text), "{text}: {:?}", texts(&svg));
    }
}

#[test]
fn looks_that_make_no_sense_are_refused() {
    for (figure, words) in [
        (
            "y = \"damper.force\"\ny_range = [5, 1]",
            &["`y_range` of [[figure]] 1 runs from 5 to 1", "smaller end first"][..],
        ),
        ("y = \"damper.force\"\nx_range = [1, 1]", &["`x_range`", "two different ends"]),
        ("y = \"damper.force\"\nx_range = [1]", &["has 1 entries", "[from, to]"]),
        (
            "y = \"damper.force\"\ny_range = [0, \"5 mm\"]",
            &["holds 5 mm, but force F of damper is in N", "a quantity in N"],
        ),
        ("y = \"damper.force\"\ny_range = [0, \"much\"]", &["\"much\"", "a quantity such as \"5 N\""]),
        ("y = \"damper.force\"\ny_scale = \"log\"\ny_range = [0, 10]", &["on a logarithmic scale", "above zero"]),
        ("y = \"damper.force\"\ny_scale = \"logarithmic\"", &["is no scale", "log"]),
        ("y = \"damper.force\"\naspect = \"wide\"", &["is no aspect", "equal"]),
        ("y = \"damper.force\"\naspect = \"equal\"", &["x and y have different units", "`units`"]),
        (
            "y = \"gripper.z\"\nx = \"gripper.x\"\naspect = \"equal\"\nx_scale = \"log\"",
            &["no meaning on a logarithmic scale"],
        ),
        ("y = \"damper.force\"\nsize = [90, 60]", &["holds 90000 mm", "size = [\"90 mm\", \"60 mm\"]"]),
        ("y = \"damper.force\"\nsize = \"90 mm\"", &["an array of two lengths"]),
        (
            "y = \"damper.force\"\nlabels = { \"damper.forse\" = \"F\" }",
            &["matches no column", "did you mean `damper.force`?"],
        ),
        ("y = \"damper.force\"\nlabels = false", &["a table of texts by column"]),
        ("y = \"damper.force\"\nlegend = true", &["a text or false"]),
        ("y = \"damper.force\"\nwindow = [0.3, 0.1]", &["no stretch of time", "earlier time first"]),
        ("y = \"damper.force\"\nwindow = [1, 2]", &["where there is no row", "from 0 to 0.35 s"]),
        ("y = \"damper.force\"\nformats = [\"gif\"]", &["is no format of figures", "pdf"]),
        ("y = \"damper.force\"\nformats = []", &["is empty", "formats = [\"svg\", \"pdf\"]"]),
        ("y = \"damper.force\"\nview = [30, 20]", &["no meaning where kind = \"curves\"", "leave `view` out"]),
        ("kind = \"robot\"\nview = [30, 120]", &["no direction", "-90 to 90"]),
        ("kind = \"robot\"\nlabels = { a = \"b\" }", &["false, where kind = \"robot\""]),
        ("kind = \"robot\"\nx_range = [0, 1]", &["no meaning where kind = \"robot\""]),
        (
            "kind = \"summary\"\nx = \"element.damper.alpha\"\ny = \"metric(peak)\"",
            &["no metric has this name", "there is none yet"],
        ),
        (
            "kind = \"summary\"\nx = \"element.damper.alpha\"\ny = \"damper.force\"",
            &["no statistic of a column", "max(damper.force)"],
        ),
        (
            "kind = \"summary\"\nx = \"element.damper.alpha\"\ny = \"maxi(damper.force)\"",
            &["\"maxi\" is no statistic", "did you mean `max`?"],
        ),
        (
            "kind = \"summary\"\nx = \"element.damper.mu\"\ny = \"max(damper.force)\"",
            &["which is not swept", "element.damper.alpha"],
        ),
        ("kind = \"summary\"\ny = \"max(damper.force)\"", &["has no `x`", "a swept path"]),
        (
            "kind = \"summary\"\nx = \"element.damper.alpha\"\ny = \"max(damper.force)\"\nwhere = { \"element.damper.alpha\" = 0.5 }",
            &["`where` chooses one value", "leave it out"],
        ),
    ] {
        let place = Place::with(&format!("{ARM}{SWEEP}[[figure]]\n{figure}\n"));
        for command in ["run", "check"] {
            let ended = place.springpot(&[command, "arm.toml"]);
            assert_eq!(ended.code, Some(2), "{figure}");
            let said = ended.said();
            assert!(said.starts_with("error: arm.toml:4"), "{figure}: {said}");
            for words in words {
                assert!(said.contains(words), "{figure}: no {words:?} in {said}");
            }
        }
        assert!(!place.path("results").exists());
    }
    let place =
        Place::with(&format!("{ARM}[[figure]]\nname = \"f\"\ny = \"damper.force\"\nsize = [\"25 mm\", \"20 mm\"]\n"));
    let ended = place.done(&["run", "arm.toml"]);
    assert!(ended.stderr.contains("25 by 20 mm leaves no room"), "{}", ended.stderr);
}
