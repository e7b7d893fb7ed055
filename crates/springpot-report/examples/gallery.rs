//! Draws one figure of every kind: `cargo run --release -p springpot-report --example gallery -- FOLDER`.

use springpot_report::{
    Curve, ElementMark, JointKind, JointMark, Link, Panel, Plot, Rendered, ReportError, RobotDrawing, WORLD,
};
use std::path::Path;
use std::time::Instant;

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let folder = std::env::args().nth(1).ok_or("name a folder for the figures")?;
    let folder = Path::new(&folder);
    std::fs::create_dir_all(folder)?;
    for (name, plot) in plots() {
        save(folder, name, || plot.render())?;
    }
    for (name, robot) in robots() {
        save(folder, name, || robot.render())?;
    }
    Ok(())
}

/// Writes NAME.svg, NAME.png and NAME.pdf and says how long drawing took: the best of five.
fn save(folder: &Path, name: &str, draw: impl Fn() -> Result<Rendered, ReportError>) -> Result<(), Failure> {
    let figure = draw()?;
    let mut time = f64::INFINITY;
    for _ in 0..5 {
        let start = Instant::now();
        draw()?;
        time = time.min(start.elapsed().as_secs_f64());
    }
    println!(
        "{name:24} {:6.1} ms  svg {:7} B  png {:7} B  pdf {:7} B",
        1e3 * time,
        figure.svg.len(),
        figure.png.len(),
        figure.pdf.len()
    );
    std::fs::write(folder.join(name).with_extension("svg"), figure.svg)?;
    std::fs::write(folder.join(name).with_extension("png"), figure.png)?;
    std::fs::write(folder.join(name).with_extension("pdf"), figure.pdf)?;
    Ok(())
}

fn curve(label: &str, count: usize, point: impl Fn(f64) -> (f64, f64)) -> Curve {
    let points = (0..count).map(|i| point(i as f64 / (count - 1).max(1) as f64));
    let (x, y) = points.unzip();
    Curve { label: label.into(), x, y, ..Curve::default() }
}

/// A force of a falling order: decays and swings.
fn force(t: f64, alpha: f64) -> f64 {
    -12.0 * (0.35 + 0.1 * t) + 5.0 * (0.3 + alpha) * (8.0 * t + 0.5 * std::f64::consts::PI * alpha).sin()
}

fn single(title: &str, x_label: &str, y_label: &str, curves: Vec<Curve>) -> Plot {
    Plot {
        title: (!title.is_empty()).then(|| title.into()),
        x: x_label.into(),
        y: y_label.into(),
        panels: vec![Panel { curves, ..Panel::default() }],
        ..Plot::default()
    }
}

fn plots() -> Vec<(&'static str, Plot)> {
    let orders = [0.1, 0.3, 0.5, 0.7, 0.9, 1.0];
    let swing = |alpha: f64, count| curve(&format!("α = {alpha}"), count, |s| (10.0 * s, force(10.0 * s, alpha)));
    let order =
        single("Generalized force Q₂ at 25 °C", "t, s", "Q₂ of strut, N·m", orders.map(|a| swing(a, 1000)).into());

    let loop_of = |name: &str, alpha: f64| {
        curve(name, 600, |s| {
            let phase = 12.0 * std::f64::consts::PI * s;
            let fade = 1.0 - (-0.6 * phase).exp();
            (0.02 * phase.sin(), fade * (1.0 * phase.sin() + 3.0 * alpha * (phase + 0.5).cos()))
        })
    };
    let hysteresis = single(
        "Hysteresis of the magnetorheological strut",
        "stroke x, m",
        "F of strut, N",
        vec![loop_of("u = 0 V", 0.1), loop_of("u = 1 V", 0.25), loop_of("u = 2 V", 0.4)],
    );

    let schemes = ["exact", "expansion-2004(7)", "expansion-2004(30)", "expansion-2004(100)"];
    let error = |name: &str, error: f64| {
        curve(name, 400, |s| (10.0 * s, force(10.0 * s, 0.5) * (1.0 - error * (0.3 + 0.7 * (3.0 * s).sin()))))
    };
    let scheme = single(
        "The papers' own scheme beside the exact one",
        "t, s",
        "D⁰·⁵x of strut, m·s⁻⁰·⁵",
        schemes.iter().zip([0.0, 0.35, 0.12, 0.03]).map(|(name, e)| error(name, e)).collect(),
    );

    let panel = |temperature: f64| Panel {
        title: Some(format!("T = {temperature} °C")),
        curves: orders[..4]
            .iter()
            .map(|a| {
                let mut curve = swing(*a, 500);
                curve.y.iter_mut().for_each(|y| *y -= 0.1 * temperature);
                curve
            })
            .collect(),
        ..Panel::default()
    };
    let grid = |title: &str, count: usize| Plot {
        title: Some(title.into()),
        x: "t, s".into(),
        y: "Q₂ of strut, N·m".into(),
        legend_title: Some("order".into()),
        panels: (0..count).map(|i| panel(10.0 * i as f64)).collect(),
        ..Plot::default()
    };

    let temperatures: Vec<Curve> = (0..13)
        .map(|i| curve(&format!("{} degC", 5 * i), 300, |s| (10.0 * s, force(10.0 * s, 0.5) - 0.4 * f64::from(i))))
        .collect();
    let mut many = single("Thirteen temperatures", "t, s", "Q₂ of strut, N·m", temperatures);
    many.legend_title = Some("T".into());

    let names = ["strut", "cushion", "belt", "tendon", "gasket", "mount", "strap", "pad"];
    let elements = names.iter().enumerate().map(|(i, name)| {
        curve(name, 200, |s| (10.0 * s, 100.0 * (i as f64 + 1.0) * (1.0 - (-s * (8.0 - i as f64)).exp())))
    });
    let elements = single("Eight elements", "t, s", "energy stored, J", elements.collect());

    let noise = |seed: u64, label: &str| {
        let mut state = seed;
        let count = 100_000;
        let mut curve = curve(label, count, |s| (3600.0 * s, (20.0 * s).sin()));
        for y in &mut curve.y {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            *y += 0.4 * ((state >> 40) as f64 / f64::from(1 << 24) - 0.5);
        }
        curve
    };
    let long = single("Two curves of 100 000 points", "t, s", "F, N", vec![noise(1, "strut"), noise(7, "belt")]);

    let tiny =
        single("Small numbers", "t, s", "x, m", vec![curve("a < b & c", 300, |s| (1e-4 * s, 3e-9 * (20.0 * s).sin()))]);
    let huge = single(
        "Large numbers close together, and a long title that has to be broken into two lines to stay in its figure",
        "distance along the path of the gripper, m",
        "F of the very stiff element between the column and the forearm, N",
        vec![curve("with a label so long that the legend has to break it into lines", 300, |s| {
            (2e6 * s, 1e9 + 40.0 * (20.0 * s).sin())
        })],
    );
    let gaps = single(
        "Gaps, one point, a constant",
        "t, s",
        "q, rad",
        vec![
            curve("gap", 100, |s| (s, if (s - 0.5).abs() < 0.1 { f64::NAN } else { (6.0 * s).sin() })),
            curve("point", 1, |_| (0.5, 0.5)),
            curve("constant", 2, |s| (s, -0.5)),
            curve("nothing", 5, |s| (s, f64::NAN)),
        ],
    );
    let empty = single("Nothing to show", "t, s", "Q₁ of strut, N·m", vec![]);
    let mut unequal = grid("Ranges of their own", 3);
    for (i, panel) in unequal.panels.iter_mut().enumerate() {
        panel.curves.iter_mut().for_each(|curve| curve.y.iter_mut().for_each(|y| *y *= 10f64.powi(3 * i as i32)));
    }
    vec![
        ("order", order),
        ("hysteresis", hysteresis),
        ("scheme", scheme),
        ("panels-2", grid("Generalized force at two temperatures", 2)),
        ("panels-3", grid("Generalized force at three temperatures", 3)),
        ("panels-5", grid("Generalized force at five temperatures", 5)),
        ("panels-12", grid("Generalized force at twelve temperatures", 12)),
        ("unequal", unequal),
        ("many", many),
        ("elements", elements),
        ("long", long),
        ("tiny", tiny),
        ("huge", huge),
        ("gaps", gaps),
        ("empty", empty),
    ]
}

fn link(name: &str, points: &[[f64; 3]]) -> Link {
    Link { name: name.into(), points: points.to_vec() }
}

fn joint(name: &str, position: [f64; 3], axis: [f64; 3], kind: JointKind) -> JointMark {
    JointMark { name: name.into(), position, axis, kind }
}

fn element(name: &str, from: [f64; 3], to: [f64; 3]) -> ElementMark {
    ElementMark { name: name.into(), from, to, ..ElementMark::default() }
}

fn robots() -> Vec<(&'static str, RobotDrawing)> {
    use JointKind::{Prismatic, Revolute};
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);

    let mut column = RobotDrawing {
        title: Some("Thermoviscoelastic strut on a three-body robot".into()),
        links: vec![
            link("column", &[[0.0; 3], [0.0, 0.0, 0.6]]),
            link("upper_arm", &[[0.0, 0.0, 0.6], [0.5, 0.0, 0.6]]),
            link("forearm", &[[0.5, 0.0, 0.6], [0.9, 0.0, 0.6]]),
        ],
        joints: vec![
            joint("q1", [0.0; 3], z, Revolute),
            joint("q2", [0.0, 0.0, 0.6], y, Revolute),
            joint("q3", [0.5, 0.0, 0.6], y, Revolute),
        ],
        elements: vec![element("strut", [0.14, -0.1, 0.08], [0.44, 0.1, 0.68])],
        gripper: Some([0.9, 0.0, 0.6]),
        ground: Some([0.0; 3]),
        ..RobotDrawing::default()
    };
    column.bracket("column", [0.14, -0.1, 0.08]);
    column.bracket("forearm", [0.44, 0.1, 0.68]);

    let (elbow, wrist) = ([0.55, 0.0, 0.95], [0.95, 0.0, 0.55]);
    let mut bent = RobotDrawing {
        title: Some("Two elements and a tool".into()),
        links: vec![
            link("base", &[[0.0; 3], [0.0, 0.0, 0.5]]),
            link("boom", &[[0.0, 0.0, 0.5], elbow]),
            link("stick", &[elbow, wrist]),
            link("tool", &[wrist, [0.95, 0.0, 0.35]]),
        ],
        joints: vec![
            joint("q1", [0.0, 0.0, 0.2], z, Revolute),
            joint("q2", [0.0, 0.0, 0.5], y, Revolute),
            joint("q3", elbow, y, Revolute),
            joint("wrist_roll", wrist, [1.0, 0.0, -1.0], Revolute),
        ],
        elements: vec![
            element("cushion", [0.0, 0.12, 0.3], [0.35, 0.1, 0.8]),
            element("tendon", [0.0, -0.12, 0.3], [0.85, -0.06, 0.65]),
            element("guy", [-0.5, 0.0, 0.0], [0.0, 0.0, 0.42]),
        ],
        gripper: Some([0.95, 0.0, 0.35]),
        ground: Some([0.0; 3]),
        ..RobotDrawing::default()
    };
    for (body, anchor) in [("base", [0.0, 0.12, 0.3]), ("boom", [0.35, 0.1, 0.8]), ("base", [0.0, -0.12, 0.3])] {
        bent.bracket(body, anchor);
    }
    bent.bracket("stick", [0.85, -0.06, 0.65]);
    bent.bracket(WORLD, [-0.5, 0.0, 0.0]);

    let slide = RobotDrawing {
        title: Some("Gantry with a sliding arm, seen straight on".into()),
        links: vec![
            link("mast", &[[0.0; 3], [0.0, 0.0, 0.8]]),
            link("carriage", &[[0.0, 0.0, 0.7], [0.4, 0.0, 0.7]]),
            link("arm", &[[0.4, 0.0, 0.7], [0.7, 0.0, 0.45]]),
        ],
        joints: vec![
            joint("s", [0.0, 0.0, 0.35], z, Prismatic),
            joint("r", [0.2, 0.0, 0.7], x, Prismatic),
            joint("q3", [0.4, 0.0, 0.7], [0.0, -1.0, 0.0], Revolute),
        ],
        elements: vec![element("damper", [0.0, 0.0, 0.1], [0.6, 0.0, 0.533])],
        gripper: Some([0.7, 0.0, 0.45]),
        ground: Some([0.0; 3]),
        ..RobotDrawing::default()
    };

    // A seven-joint arm of human size, standing bent.
    let chain = [
        [0.0, 0.0, 0.0],
        [0.0, 0.0, 0.33],
        [0.1, 0.05, 0.62],
        [0.28, 0.12, 0.78],
        [0.5, 0.14, 0.74],
        [0.62, 0.1, 0.6],
        [0.66, 0.06, 0.45],
        [0.66, 0.04, 0.34],
    ];
    let axes = [z, y, [0.3, 0.15, 0.9], y, [0.9, 0.1, -0.2], [0.1, 1.0, 0.0], [0.0, -0.1, -1.0]];
    let mut arm = RobotDrawing {
        title: Some("Seven joints".into()),
        links: chain.windows(2).enumerate().map(|(i, pair)| link(&format!("link{}", i + 1), pair)).collect(),
        joints: chain
            .iter()
            .zip(axes)
            .enumerate()
            .map(|(i, (p, a))| joint(&format!("q{}", i + 1), *p, a, Revolute))
            .collect(),
        elements: vec![
            element("shoulder_band", [0.0, -0.08, 0.2], [0.08, -0.05, 0.55]),
            element("elbow_band", [0.15, 0.15, 0.6], [0.45, 0.22, 0.82]),
        ],
        gripper: Some(chain[7]),
        ground: Some([0.0; 3]),
        ..RobotDrawing::default()
    };
    arm.bracket("link1", [0.0, -0.08, 0.2]);
    arm.bracket("link2", [0.08, -0.05, 0.55]);
    arm.bracket("link2", [0.15, 0.15, 0.6]);
    arm.bracket("link4", [0.45, 0.22, 0.82]);

    let mut hanging = RobotDrawing {
        title: Some("Pendulum".into()),
        links: vec![link("rod", &[[0.0; 3], [0.006, 0.0, -0.02]])],
        joints: vec![joint("q", [0.0; 3], y, Revolute)],
        elements: vec![element("band", [0.02, 0.0, -0.001], [0.0045, 0.0, -0.015])],
        gripper: None,
        ground: Some([0.0; 3]),
        ..RobotDrawing::default()
    };
    hanging.bracket(WORLD, [0.02, 0.0, -0.001]);
    vec![
        ("robot", column),
        ("robot-elements", bent),
        ("robot-slide", slide),
        ("robot-seven", arm),
        ("robot-hanging", hanging),
        ("robot-empty", RobotDrawing::default()),
    ]
}
