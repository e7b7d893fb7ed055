//! What every figure promises, whatever the data.

use proptest::prelude::*;
use springpot_report::{
    Curve, ElementMark, ElementShape, ElementSign, JointKind, JointMark, Link, Panel, Plot, Rendered, ReportError,
    RobotDrawing, Scale, WORLD,
};

fn curve(label: &str, x: &[f64], y: &[f64]) -> Curve {
    Curve { label: label.into(), x: x.into(), y: y.into(), ..Curve::default() }
}

fn plot(curves: Vec<Curve>) -> Plot {
    Plot {
        title: Some("Generalized force Q₂ at 25 °C".into()),
        x: "t, s".into(),
        y: "Q₂ of strut, N·m".into(),
        legend_title: Some("order".into()),
        panels: vec![Panel { title: Some("exact".into()), curves, ..Panel::default() }],
        ..Plot::default()
    }
}

fn waves(count: usize, points: usize) -> Vec<Curve> {
    let x: Vec<f64> = (0..points).map(|i| 10.0 * i as f64 / points as f64).collect();
    let wave = |i: usize| -> Vec<f64> { x.iter().map(|t| (8.0 * t).sin() * (1.0 + i as f64)).collect() };
    (0..count).map(|i| curve(&format!("α = 0.{}", i + 1), &x, &wave(i))).collect()
}

/// Width and height that the file's header names.
fn png_size(png: &[u8]) -> (u32, u32) {
    assert_eq!(png[..8], [0x89, b'P', b'N', b'G', 0x0d, 0x0a, 0x1a, 0x0a]);
    assert_eq!(&png[12..16], b"IHDR");
    let number = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().unwrap());
    (number(16), number(20))
}

/// A number attribute of the `<svg>` tag.
fn svg_size(svg: &str, name: &str) -> f64 {
    let start = svg.find(&format!(" {name}=\"")).unwrap() + name.len() + 3;
    svg[start..].split('"').next().unwrap().parse().unwrap()
}

/// Width and height of what is drawn.
fn view_box(svg: &str) -> [f64; 2] {
    let numbers = svg.split("viewBox=\"0 0 ").nth(1).unwrap().split('"').next().unwrap();
    let numbers: Vec<f64> = numbers.split(' ').map(|number| number.parse().unwrap()).collect();
    [numbers[0], numbers[1]]
}

/// The page that a PDF file says, points of 1/72 inch.
fn media_box(pdf: &[u8]) -> Vec<f64> {
    assert!(pdf.starts_with(b"%PDF-1.") && pdf.ends_with(b"%%EOF"));
    let text = String::from_utf8_lossy(pdf);
    let (_, page) = text.split_once("/MediaBox [").unwrap();
    page.split(']').next().unwrap().split_whitespace().map(|number| number.parse().unwrap()).collect()
}

/// Coordinates of all points of the thickest lines: the curves.
fn curve_points(svg: &str) -> Vec<[f64; 2]> {
    let curves = svg.lines().filter(|line| line.starts_with("<path") && line.contains("stroke-width=\"1.7\""));
    let data = curves.map(|line| line.split('"').nth(1).unwrap().replace(['M', 'L'], " "));
    let numbers: Vec<f64> =
        data.flat_map(|d| d.split_whitespace().map(|n| n.parse().unwrap()).collect::<Vec<_>>()).collect();
    numbers.chunks(2).map(|p| [p[0], p[1]]).collect()
}

/// All formats are there, agree in size, and the SVG is well formed as far as tags go.
fn check(figure: &Rendered) {
    let (width, height) = png_size(&figure.png);
    // What is shrunk to its page keeps its pixels.
    let drawn = view_box(&figure.svg);
    let page = ["width", "height"].map(|name| svg_size(&figure.svg, name));
    for (axis, pixels) in [(0, width), (1, height)] {
        assert!((f64::from(pixels) - 2.5 * drawn[axis]).abs() < 1.1, "{pixels} {drawn:?}");
        let said = media_box(&figure.pdf)[2 + axis];
        assert!((said - 0.75 * page[axis]).abs() < 0.02, "{said} {page:?}");
    }
    assert!(figure.svg.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\"") && figure.svg.ends_with("</svg>\n"));
    assert!(!figure.svg.contains("NaN") && !figure.svg.contains("inf"));
    for line in figure.svg.lines().filter(|line| !line.is_empty()) {
        assert_eq!(line.matches('<').count(), line.matches('>').count(), "{line}");
    }
}

#[test]
fn drawing_twice_gives_the_same_bytes() {
    let plot = plot(waves(6, 1000));
    let first = plot.render().unwrap();
    check(&first);
    assert_eq!(first, plot.render().unwrap());
    assert_eq!(first, std::thread::spawn(move || plot.render().unwrap()).join().unwrap());
}

#[test]
fn the_picture_is_not_blank() {
    let figure = plot(waves(2, 100)).render().unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(&figure.png)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    assert_eq!(info.color_type, png::ColorType::Rgb);
    let near = |target: [u8; 3]| pixels.chunks(3).filter(|p| (0..3).all(|i| p[i].abs_diff(target[i]) < 6)).count();
    // Paper, ink, and the first two colours of curves.
    for (color, least) in
        [([255; 3], 500_000), ([0x22; 3], 3000), ([0x00, 0x72, 0xb2], 3000), ([0xd5, 0x5e, 0x00], 3000)]
    {
        assert!(near(color) > least, "{color:?}: {}", near(color));
    }
    let dims = reader.info().pixel_dims.unwrap();
    assert_eq!((dims.xppu, dims.yppu), (9449, 9449));
}

#[test]
fn all_texts_are_there_in_order() {
    let svg = plot(waves(6, 50)).render().unwrap().svg;
    for text in ["Generalized force Q₂ at 25 °C", "t, s", "Q₂ of strut, N·m", "order", "exact"] {
        assert!(svg.contains(&format!(">{text}</text>")), "{text}");
    }
    let places: Vec<usize> = (1..=6).map(|i| svg.find(&format!(">α = 0.{i}</text>")).unwrap()).collect();
    assert!(places.is_sorted());
    assert!(svg.contains("font-family=\"'DejaVu Sans', Verdana, Arial, sans-serif\""));
    assert!(svg.contains(">−") && !svg.contains(">-"), "minus signs are no hyphens");
}

#[test]
fn panels_share_one_legend() {
    let mut plot = plot(waves(3, 50));
    plot.panels = vec![plot.panels[0].clone(); 5];
    plot.panels[4].curves.push(curve("extra", &[0.0, 1.0], &[0.0, 1.0]));
    let svg = plot.render().unwrap().svg;
    assert_eq!(svg.matches(">α = 0.2</text>").count(), 1);
    assert_eq!(svg.matches(">extra</text>").count(), 1);
    assert_eq!(svg.matches(">exact</text>").count(), 5);
}

#[test]
fn xml_specials_are_escaped() {
    let mut plot = plot(vec![curve("a<b & \"c\"", &[0.0, 1.0], &[0.0, 1.0])]);
    plot.title = Some("F > 0 & x < 1 \u{0} \u{8}".into());
    let figure = plot.render().unwrap();
    check(&figure);
    assert!(figure.svg.contains(">a&lt;b &amp; &quot;c&quot;</text>"));
    assert!(figure.svg.contains(">F &gt; 0 &amp; x &lt; 1</text>"));
    assert!(!figure.svg.contains(['\u{0}', '\u{8}']));
}

#[test]
fn degenerate_data_still_make_a_figure() {
    let (nan, inf) = (f64::NAN, f64::INFINITY);
    let cases: Vec<(&str, Vec<Curve>)> = vec![
        ("no curve", vec![]),
        ("no point", vec![curve("a", &[], &[])]),
        ("one point", vec![curve("a", &[3.0], &[4.0])]),
        ("all NaN", vec![curve("a", &[0.0, 1.0], &[nan, nan])]),
        ("infinite", vec![curve("a", &[0.0, inf, 1.0, 2.0], &[1.0, 2.0, -inf, nan])]),
        ("constant", vec![curve("a", &[0.0, 1.0], &[7.0, 7.0])]),
        ("zero", vec![curve("a", &[0.0, 1.0], &[0.0, 0.0])]),
        ("same x", vec![curve("a", &[2.0, 2.0], &[0.0, 1.0])]),
        ("tiny", vec![curve("a", &[0.0, 1e-9], &[-1e-9, 2e-9])]),
        ("subnormal", vec![curve("a", &[0.0, 5e-324], &[-5e-324, 1e-320])]),
        ("huge", vec![curve("a", &[0.0, 1e9], &[-1e9, 3e9])]),
        ("extreme", vec![curve("a", &[-1e300, 1e300], &[-1e300, 1e300])]),
        ("beyond", vec![curve("a", &[-f64::MAX, f64::MAX], &[-f64::MAX, f64::MAX])]),
        ("offset", vec![curve("a", &[1e9, 1e9 + 1.0], &[1.0, 1.0 + 1e-9])]),
        ("rounding", vec![curve("a", &[0.0, 1.0], &[1.0, 1.0 + f64::EPSILON])]),
        ("mixed", vec![curve("a", &[0.0, 1.0], &[1e-9, 2e-9]), curve("b", &[0.0, 1.0], &[1e9, -1e9])]),
        ("nameless", vec![curve("", &[0.0, 1.0], &[0.0, 1.0])]),
        ("foreign", vec![curve("漢字 🤖", &[0.0, 1.0], &[0.0, 1.0])]),
        ("long label", vec![curve(&"m".repeat(5000), &[0.0, 1.0], &[0.0, 1.0])]),
    ];
    for (name, curves) in cases {
        let empty = curves.iter().all(|c| !c.x.iter().zip(&c.y).any(|(x, y)| x.abs() <= 1e300 && y.abs() <= 1e300));
        let figure = plot(curves).render().unwrap_or_else(|error| panic!("{name}: {error}"));
        check(&figure);
        assert_eq!(figure.svg.contains("no data"), empty, "{name}");
    }
    check(&Plot::default().render().unwrap());
    let mut long = plot(waves(1, 10));
    (long.title, long.y) = (Some("word ".repeat(2000)), "y".repeat(3000).into());
    check(&long.render().unwrap());
    check(&plot(waves(400, 5)).render().unwrap());
}

#[test]
fn gaps_break_lines() {
    let y: Vec<f64> = (0..100).map(|i| if i == 50 { f64::NAN } else { f64::from(i) }).collect();
    let x: Vec<f64> = (0..100).map(f64::from).collect();
    let svg = plot(vec![curve("a", &x, &y)]).render().unwrap().svg;
    let line = svg.lines().find(|line| line.starts_with("<path") && line.contains("stroke-width=\"1.7\"")).unwrap();
    assert_eq!(line.matches('M').count(), 2);
    // Straight pieces need their ends alone.
    assert_eq!(line.matches('L').count(), 2);
}

#[test]
fn long_curves_are_thinned_without_losing_extremes() {
    let count = 100_000u32;
    let x: Vec<f64> = (0..count).map(f64::from).collect();
    let mut y: Vec<f64> = x.iter().map(|t| (0.7 * t).sin()).collect();
    (y[12_345], y[77_777]) = (3.0, -2.5);
    let figure = plot(vec![curve("a", &x, &y)]).render().unwrap();
    let points = curve_points(&figure.svg);
    assert!(points.len() > 20_000 && points.len() < 40_000, "{}", points.len());
    // y runs from −2.5 to 3 over the panel less 5 % on either side of the range.
    let (low, high) = points.iter().fold((f64::MAX, f64::MIN), |(lo, hi), p| (lo.min(p[1]), hi.max(p[1])));
    let panel = panel_height(&figure.svg);
    assert!((high - low - panel / 1.1).abs() < 0.12, "{} of {panel}", high - low);
    let at = |value: f64| points.iter().filter(|p| (p[1] - value).abs() < 0.005).count();
    assert_eq!((at(low), at(high)), (1, 1));

    for curves in [1, 6, 40] {
        let curves = (0..curves).map(|i| curve(&format!("noise {i}"), &x, &y)).collect();
        assert!(plot(curves).render().unwrap().svg.len() < 2_000_000);
    }
    // A scribble that runs to and fro.
    let wild: Vec<f64> = (0..count).map(|i| f64::from(i * 7919 % 9973)).collect();
    assert!(plot(vec![curve("a", &wild, &y)]).render().unwrap().svg.len() < 2_000_000);
}

/// Height of the first panel: its two axes are one line.
fn panel_height(svg: &str) -> f64 {
    let axes = svg.lines().find(|line| line.contains("stroke=\"#222222\" stroke-width=\"1\"")).unwrap();
    let numbers: Vec<f64> = axes.split(['M', 'L', ' ', '"']).filter_map(|word| word.parse().ok()).collect();
    numbers[3] - numbers[1]
}

#[test]
fn sizes_are_kept() {
    let mut small = plot(waves(6, 400));
    for size in [[90.0, 60.0], [180.0, 120.0], [70.0, 70.0]] {
        small.size = Some(size);
        let figure = small.render().unwrap();
        check(&figure);
        let said = ["width", "height"].map(|name| svg_size(&figure.svg, name) * 25.4 / 96.0);
        assert!((said[0] - size[0]).abs() < 0.01 && (said[1] - size[1]).abs() < 0.01, "{said:?}");
    }
    small.size = Some([30.0, 20.0]);
    let error = small.render().unwrap_err();
    assert!(matches!(error, ReportError::TooSmall { .. }) && error.to_string().contains("30 by 20 mm"), "{error}");
    // All others are as wide as one another, whatever their legend says.
    small.size = None;
    small.panels[0].curves[0].label = "a label that is far longer than those of the others".into();
    let many = Plot { panels: vec![small.panels[0].clone(); 7], ..small.clone() };
    let widths = [&small, &many, &plot(waves(1, 5))].map(|plot| svg_size(&plot.render().unwrap().svg, "width"));
    assert!(widths.iter().all(|width| (width - 566.93).abs() < 0.01), "{widths:?}");
}

#[test]
fn narrow_pages_have_smaller_letters_and_room_for_curves() {
    let mut narrow = plot(waves(4, 400));
    let legend = ["exact", "expansion-2004(7)", "expansion-2004(30)", "expansion-2004(100)"];
    for (curve, label) in narrow.panels[0].curves.iter_mut().zip(legend) {
        curve.label = label.into();
    }
    narrow.legend_title = Some("scheme".into());
    narrow.title = Some("Derivative of order ½ of the stroke, exact and expanded".into());
    let height = |size: [f64; 2]| {
        let svg = Plot { size: Some(size), ..narrow.clone() }.render().unwrap().svg;
        // On paper.
        (panel_height(&svg) / (view_box(&svg)[0] / svg_size(&svg, "width")), view_box(&svg)[0])
    };
    let (panel, laid_out) = height([90.0, 60.0]);
    assert!(panel > 0.28 * 60.0 * 96.0 / 25.4, "{panel}");
    assert!((laid_out * 25.4 / 96.0 - 110.0).abs() < 0.01, "{laid_out}");
    assert!((height([110.0, 80.0]).1 * 25.4 / 96.0 - 110.0).abs() < 0.01);
}

#[test]
fn what_is_not_shown_is_said() {
    let mut plot = plot(vec![curve("a", &[0.0, 1.0, 2.0], &[0.0, 1.0, 10.0])]);
    assert!(plot.render().unwrap().remarks.is_empty());
    plot.y.scale = Scale::Log;
    let remarks = plot.render().unwrap().remarks;
    assert_eq!(remarks, ["1 of 3 points is not above zero: not drawn on the logarithmic y axis"]);

    let mut robot = arm();
    assert!(robot.render().unwrap().remarks.is_empty());
    // More bodies in one place than names find room about it.
    let body = |k: usize| Link { name: format!("body_number_{k}"), points: vec![[0.0; 3], [0.0, 0.0, 0.01]] };
    robot.links.extend((0..200).map(body));
    let figure = robot.render().unwrap();
    let [remark] = &figure.remarks[..] else { panic!("{:?}", figure.remarks) };
    let named = (0..200).filter(|k| figure.svg.contains(&format!(">body_number_{k}<"))).count();
    let others = format!(" and {} more", 200 - named - 8);
    assert!(named > 0 && remark.starts_with("no room for the names body_number_"), "{named}: {remark}");
    assert!(remark.ends_with(&others), "{named}: {remark}");
}

#[test]
fn ranges_cut_curves_and_scales_bend_them() {
    let x: Vec<f64> = (1..=1000).map(f64::from).collect();
    let y: Vec<f64> = x.iter().map(|x| 1e6 / (x * x)).collect();
    let mut cut = plot(vec![curve("a", &x, &y)]);
    cut.y.range = Some([0.0, 100.0]);
    cut.x.range = Some([0.0, 500.0]);
    let svg = cut.render().unwrap().svg;
    let points = curve_points(&svg);
    let high = points.iter().map(|p| p[1]).fold(f64::MAX, f64::min);
    let panel = panel_height(&svg);
    let low = points.iter().map(|p| p[1]).fold(f64::MIN, f64::max);
    // From the upper edge, where y = 100, to y = 4 at x = 500.
    assert!((low - high - 0.96 * panel).abs() < 0.1, "{low} {high} {panel}");

    // A power is a straight line on two logarithmic axes.
    let mut bent = plot(vec![curve("a", &x, &y)]);
    (bent.x.scale, bent.y.scale) = (Scale::Log, Scale::Log);
    let points = curve_points(&bent.render().unwrap().svg);
    let (first, last) = (points[0], points[points.len() - 1]);
    for point in &points {
        let share = (point[0] - first[0]) / (last[0] - first[0]);
        assert!((point[1] - first[1] - share * (last[1] - first[1])).abs() < 0.2, "{point:?}");
    }
    let svg = bent.render().unwrap().svg;
    assert!(svg.contains(">100</text>") && svg.contains(">10⁶</text>"), "{svg}");
}

#[test]
fn circles_are_round_where_lengths_are_equal() {
    let angle: Vec<f64> = (0..=360).map(|degrees| f64::from(degrees).to_radians()).collect();
    let (x, y): (Vec<f64>, Vec<f64>) = angle.iter().map(|a| (a.cos(), 3.0 + a.sin())).unzip();
    for (size, range) in [(None, None), (Some([90.0, 90.0]), None), (Some([150.0, 60.0]), Some([2.0, 4.5]))] {
        let mut round = plot(vec![curve("a", &x, &y)]);
        (round.is_equal, round.size, round.y.range) = (true, size, range);
        let points = curve_points(&round.render().unwrap().svg);
        let wide = |axis: usize| {
            let values = points.iter().map(|p| p[axis]);
            values.clone().fold(f64::MIN, f64::max) - values.fold(f64::MAX, f64::min)
        };
        assert!((wide(0) - wide(1)).abs() < 0.15, "{size:?}: {} {}", wide(0), wide(1));
    }
}

#[test]
fn a_second_axis_and_kinds_of_curves() {
    let mut both = plot(waves(3, 200));
    let forces = both.panels[0].curves.clone();
    both.panels[0].curves.extend(forces.into_iter().map(|curve| Curve {
        kind: "stroke".into(),
        is_right: true,
        y: curve.y.iter().map(|y| 1e-3 * y).collect(),
        ..curve
    }));
    both.panels[0].curves[..3].iter_mut().for_each(|curve| curve.kind = "force".into());
    both.right = Some("stroke, m".into());
    let svg = both.render().unwrap().svg;
    for text in ["stroke, m", "Q₂ of strut, N·m", "force", "stroke", "α = 0.1", "α = 0.3", "×10⁻³"] {
        assert_eq!(svg.matches(&format!(">{text}</text>")).count(), 1, "{text}");
    }
    // Three colours and two dashes.
    let curves =
        |words: &str| svg.lines().filter(|line| line.contains("stroke-width=\"1.7\"") && line.contains(words)).count();
    assert_eq!((curves("stroke="), curves("stroke-dasharray"), curves("#0072b2")), (6, 3, 0));
    both.hides_legend = true;
    assert!(!both.render().unwrap().svg.contains(">α = 0.1</text>"));
}

#[test]
fn indices_are_lowered() {
    let mut lowered = plot(waves(2, 10));
    lowered.legend_title = Some("E_{d}".into());
    lowered.title = Some("at E_{d}, all of it".into());
    let figure = lowered.render().unwrap();
    check(&figure);
    assert!(figure.svg.contains(">E<tspan dy=\"2.04\" font-size=\"8.64\">d</tspan></text>"), "{}", figure.svg);
    assert!(figure.svg.contains("<title>at Ed, all of it</title>"));
}

#[test]
fn refusals_name_the_cause() {
    let error = plot(vec![curve("force", &[0.0, 1.0], &[0.0])]).render().unwrap_err();
    assert_eq!(
        error.to_string(),
        "curve `force` has 2 x values and 1 y values; it needs as many of one as of the other"
    );
    let mut many = plot(vec![]);
    many.panels = vec![Panel::default(); 65];
    assert!(matches!(many.render(), Err(ReportError::TooManyPanels { panels: 65, limit: 64 })));
    let error = plot(waves(2001, 2)).render().unwrap_err();
    assert!(matches!(error, ReportError::TooManyCurves { curves: 2001, limit: 2000 }));
    let robot = RobotDrawing { gripper: Some([0.0, f64::NAN, 0.0]), ..arm() };
    assert_eq!(robot.render().unwrap_err().to_string(), "the position of `gripper` is not finite");
    many.panels.truncate(64);
    check(&many.render().unwrap());
}

fn element(name: &str, from: [f64; 3], to: [f64; 3]) -> ElementMark {
    ElementMark { name: name.into(), from, to, ..ElementMark::default() }
}

fn arm() -> RobotDrawing {
    let joint = |name: &str, position, axis, kind| JointMark { name: name.into(), position, axis, kind };
    let mut robot = RobotDrawing {
        title: Some("Arm & strut".into()),
        links: vec![
            Link { name: "column".into(), points: vec![[0.0; 3], [0.0, 0.0, 0.6]] },
            Link { name: "arm".into(), points: vec![[0.0, 0.0, 0.6], [0.5, 0.0, 0.6], [0.9, 0.0, 0.5]] },
        ],
        joints: vec![
            joint("q1", [0.0; 3], [0.0, 0.0, 1.0], JointKind::Revolute),
            joint("slide", [0.0, 0.0, 0.6], [0.0, 2.0, 0.0], JointKind::Prismatic),
        ],
        elements: vec![element("strut", [0.14, -0.1, 0.08], [0.44, 0.1, 0.68])],
        gripper: Some([0.9, 0.0, 0.5]),
        ground: Some([0.0; 3]),
        ..RobotDrawing::default()
    };
    robot.bracket("column", [0.14, -0.1, 0.08]);
    robot.bracket("arm", [0.44, 0.1, 0.68]);
    robot
}

#[test]
fn brackets_start_on_their_body() {
    let mut robot = arm();
    assert_eq!(robot.links[2], Link { name: "column".into(), points: vec![[0.0, 0.0, 0.08], [0.14, -0.1, 0.08]] });
    assert_eq!(robot.links[3].points[0], [0.44, 0.0, 0.6]);
    let count = robot.links.len();
    robot.bracket("arm", [0.5, 0.0, 0.6]);
    assert_eq!(robot.links.len(), count);
    robot.bracket("nobody", [1.0, 0.0, 0.0]);
    assert_eq!(robot.links[count], Link { name: WORLD.into(), points: vec![[1.0, 0.0, 0.0]] });
}

#[test]
fn robots_show_names_and_scale() {
    let figure = arm().render().unwrap();
    check(&figure);
    for text in ["Arm &amp; strut", "q₁", "slide", "strut", "column", "arm", "H", "x", "y", "z"] {
        assert!(figure.svg.contains(&format!(">{text}</text>")), "{text}");
    }
    assert!(figure.svg.contains(" m</text>"));
    assert_eq!(figure, arm().render().unwrap());
}

#[test]
fn elements_of_every_shape_are_drawn() {
    let over = vec![[0.3, 0.2, 0.3], [0.6, 0.2, 0.9]];
    let at = |name: &str, point, shape| ElementMark { shape, ..element(name, point, point) };
    let shapes = vec![
        ElementMark { shape: ElementShape::Cable(over), ..element("rope", [0.1, 0.0, 0.1], [0.9, 0.0, 0.5]) },
        at("torsion", [0.0; 3], ElementShape::Turn),
        at("buffer", [0.0, 0.0, 0.6], ElementShape::Slide([0.0, 2.0, 0.0])),
        at("mount", [0.5, 0.0, 0.6], ElementShape::Bushing),
    ];
    let bare = RobotDrawing { elements: Vec::new(), ..arm() }.render().unwrap();
    for one in &shapes {
        let figure = RobotDrawing { elements: vec![one.clone()], ..arm() }.render().unwrap();
        check(&figure);
        assert!(figure.svg.contains(&format!(">{}</text>", one.name)), "{}", one.name);
        assert!(figure.svg.matches("#c0391b").count() > bare.svg.matches("#c0391b").count() + 1, "{}", one.name);
    }
    check(&RobotDrawing { elements: shapes.clone(), ..arm() }.render().unwrap());
    let nowhere = ElementMark { shape: ElementShape::Cable(vec![[f64::NAN, 0.0, 0.0]]), ..shapes[0].clone() };
    let refused = RobotDrawing { elements: vec![nowhere], ..arm() }.render().unwrap_err();
    assert_eq!(refused.to_string(), "the position of `rope` is not finite");
}

#[test]
fn a_robot_that_floats_has_no_base() {
    const PLINTH: &str = "#d9d9d9";
    let floating = RobotDrawing { ground: None, ..arm() }.render().unwrap();
    check(&floating);
    assert!(arm().render().unwrap().svg.contains(PLINTH) && !floating.svg.contains(PLINTH));
}

#[test]
fn robots_of_many_joints_get_more_room() {
    let mut robot = arm();
    let room = |robot: &RobotDrawing| {
        let svg = robot.render().unwrap().svg;
        assert!((svg_size(&svg, "width") - 566.93).abs() < 0.01);
        view_box(&svg)[0]
    };
    let narrow = room(&robot);
    robot.joints.extend(std::iter::repeat_n(JointMark { name: String::new(), ..robot.joints[0].clone() }, 38));
    let wide = room(&robot);
    assert!(narrow == 566.93 && wide > 1.5 * narrow && wide < 2.1 * narrow, "{narrow} {wide}");
}

#[test]
fn robots_are_turned_sized_and_left_without_names() {
    let mut robot = arm();
    robot.size = Some([90.0, 70.0]);
    let figure = robot.render().unwrap();
    let said = ["width", "height"].map(|name| svg_size(&figure.svg, name) * 25.4 / 96.0);
    assert!((said[0] - 90.0).abs() < 0.01 && (said[1] - 70.0).abs() < 0.01, "{said:?}");
    robot.view = Some([0.0, 0.0]);
    let front = robot.render().unwrap();
    assert_ne!(front.svg, figure.svg);
    // Seen along y, that axis is a cross in a circle: no arrow of the sign of the axes leads to its name.
    assert!(front.svg.contains(">y</text>"));
    robot.hides_names = true;
    let bare = robot.render().unwrap().svg;
    assert!(!bare.contains(">q₁</text>") && !bare.contains(">strut</text>") && bare.contains(">x</text>"));
}

#[test]
fn elements_have_the_sign_of_their_law() {
    let mut robot = arm();
    let mut seen = Vec::new();
    let maxwell = ElementSign::Series(vec![ElementSign::Spring, ElementSign::Dashpot]);
    let both = ElementSign::Parallel(vec![ElementSign::Spring, ElementSign::Springpot, ElementSign::Source]);
    for sign in [ElementSign::Spring, ElementSign::Dashpot, ElementSign::Springpot, ElementSign::Source, maxwell, both]
    {
        robot.elements[0].sign = sign;
        let figure = robot.render().unwrap();
        assert!(!seen.contains(&figure.svg));
        seen.push(figure.svg);
    }
}

#[test]
fn degenerate_robots_still_make_a_figure() {
    check(&RobotDrawing::default().render().unwrap());
    let mut robot = arm();
    robot.joints[0].axis = [0.0; 3];
    robot.links.push(Link::default());
    robot.links.push(Link { name: "dot".into(), points: vec![[0.1; 3]] });
    robot.elements.push(element("<none>", [0.2; 3], [0.2; 3]));
    check(&robot.render().unwrap());
    for scale in [1e-9, 1e9, 1e90] {
        let mut robot = arm();
        robot.links.iter_mut().flat_map(|link| &mut link.points).flatten().for_each(|v| *v *= scale);
        robot.joints.iter_mut().for_each(|joint| joint.position = joint.position.map(|v| v * scale));
        robot.elements.clear();
        robot.gripper = None;
        check(&robot.render().unwrap());
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None,
        rng_seed: proptest::test_runner::RngSeed::Fixed(2), ..ProptestConfig::default() })]

    /// Any numbers and any text give a figure.
    #[test]
    fn any_plot_is_drawn(
        points in proptest::collection::vec((any::<f64>(), any::<f64>()), 0..40),
        label in any::<String>(), title in any::<Option<String>>(), panels in 0usize..4,
    ) {
        let (x, y): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
        let curves = vec![Curve { label: label.clone(), x, y, ..Curve::default() }];
        let panel = Panel { title: title.clone(), curves, ..Panel::default() };
        let (x, y) = (label.clone().into(), label.into());
        let plot = Plot { title, x, y, panels: vec![panel; panels], ..Plot::default() };
        check(&plot.render().unwrap());
    }

    /// Every name that must be shown is shown.
    #[test]
    fn any_robot_is_drawn(points in proptest::collection::vec(proptest::array::uniform3(-2.0..2.0f64), 2..9)) {
        let joint = |(i, position): (usize, &[f64; 3])| JointMark {
            name: format!("q{}", i + 1), position: *position, axis: [position[1], 1.0, position[0]],
            kind: if i % 3 == 2 { JointKind::Prismatic } else { JointKind::Revolute },
        };
        let robot = RobotDrawing {
            title: None,
            links: points.windows(2).map(|pair| Link { name: "body".into(), points: pair.to_vec() }).collect(),
            joints: points.iter().enumerate().map(joint).collect(),
            elements: vec![element("strut", points[0], points[points.len() - 1])],
            gripper: Some(points[1]),
            ground: Some(points[0]),
            ..RobotDrawing::default()
        };
        let figure = robot.render().unwrap();
        check(&figure);
        prop_assert!(figure.svg.contains(">strut</text>") && figure.svg.contains(">q₂</text>"));
    }
}
