//! Robots from the angles of their joints.

use crate::support::{Found, Noise, Place, all_found, rows_of};
use springpot::observe::Quantity;
use springpot_run::fit::Outcome;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// The three-body arm on its strut, `NAME` in braces being numbers.
const ARM: &str = r#"
robot.gravity = [0, 0, -9.81]
[[robot.body]]
name = "column"
joint = { name = "q1", kind = "revolute", axis = [0, 0, 1], damping = {d1} }
mass = 6
com = [0.02, 0, 0.3]
inertia = { xx = 0.2, yy = 0.2, zz = 0.06, xz = 0.01 }
[[robot.body]]
name = "upper_arm"
joint = { name = "q2", kind = "revolute", axis = [0, 1, 0], origin = [0, 0, 0.6], damping = {d2} }
mass = {m2}
com = [0.25, 0.01, 0.02]
inertia = { xx = 0.01, yy = 0.07, zz = 0.07, xy = 0.001, yz = 0.0005 }
[[robot.body]]
name = "forearm"
joint = { name = "q3", kind = "revolute", axis = [0, 1, 0], origin = [0.5, 0, 0], damping = {d3} }
mass = {m3}
com = [0.18, -0.01, 0.01]
inertia = { xx = 0.006, yy = {i3}, zz = 0.03, xz = -0.001, yz = 0.0004 }
[[element]]
name = "strut"
from = { body = "column", point = [0.14, -0.1, 0.08] }
to = { body = "forearm", point = [-0.06, 0.1, 0.08] }
rest_length = {l0}
law = "fractional-kelvin-voigt"
parameters = { k = {k}, c = {c}, alpha = {alpha} }
[motion]
kind = "forward"
torque = { q1 = "{drive}*2*sin(3*t)", q2 = "{drive}*(3*sin(5*t) - 10)", q3 = "{drive}*(1.5*sin(7*t) - 3)" }
start.v = { q1 = {w1}, q2 = {w2}, q3 = {w3} }
start.q = { q1 = {a1}, q2 = {a2}, q3 = {a3} }
[time]
end = 2
output_step = 0.01
[solver]
rtol = 1e-6
"#;

/// Numbers of the arm by name.
type Numbers = BTreeMap<&'static str, f64>;

fn numbers(of: &[(&'static str, f64)]) -> Numbers {
    let all = ["d1", "d2", "d3", "a1", "a2", "a3", "w1", "w2", "w3", "drive"].map(|name| (name, 0.0));
    let inertial = [("m2", 3.0), ("m3", 2.0), ("i3", 0.03), ("l0", 0.7)];
    all.into_iter().chain(inertial).chain(of.iter().copied()).collect()
}

fn arm(numbers: &Numbers) -> String {
    let put = |text: String, (name, value): (&&str, &f64)| text.replace(&format!("{{{name}}}"), &format!("{value:?}"));
    numbers.iter().fold(ARM.to_owned(), put)
}

/// A parameter block of each of these paths, under its name.
fn sought(paths: &[(&str, &str)]) -> String {
    paths.iter().fold(String::new(), |mut text, (name, path)| {
        _ = write!(text, "[[parameter]]\nname = \"{name}\"\npath = \"{path}\"\n");
        text
    })
}

const LAW: [(&str, &str); 4] = [
    ("l0", "element.strut.rest_length"),
    ("k", "element.strut.k"),
    ("c", "element.strut.c"),
    ("alpha", "element.strut.alpha"),
];

/// A place with 3 × 301 angles of the arm with these numbers over two seconds, with noise of 1 mrad.
fn measured(truth: &Numbers, seed: u64) -> Place {
    let place = Place::new();
    let times: Vec<f64> = (0..301).map(|row| f64::from(row) / 150.0).collect();
    let mut noise = Noise(seed);
    let mut text = "t,q1,q2,q3\n".to_owned();
    for (t, angles) in times.iter().zip(rows_of(&place, &arm(truth), &[0, 1, 2].map(Quantity::Coordinate), &times)) {
        let cells: Vec<String> = angles.iter().map(|angle| (angle + 1e-3 * noise.normal()).to_string()).collect();
        _ = writeln!(text, "{t},{}", cells.join(","));
    }
    place.write("rows.csv", &text);
    place
}

/// The record of the angles; `sd` and what else stands in it.
fn record(sd: &str, more: &str) -> String {
    let column = |joint: &str| format!("\"q.{joint}\" = {{ column = \"{joint}\"{sd} }}");
    let columns: Vec<String> = ["q1", "q2", "q3"].map(column).into();
    format!("[[data]]\nname = \"fall\"\ncsv = \"rows.csv\"\ncolumns = {{ {} }}\n{more}", columns.join(", "))
}

const MILLIRADIAN: &str = ", sd = \"1 mrad\"";

/// The furthest of what was found from what is to be found, in standard deviations of that.
fn furthest(found: &[(String, Found)], exact: &[(String, Found)]) -> f64 {
    let off = |((name, own), (other, exact)): (&(String, Found), &(String, Found))| {
        assert_eq!(name, other);
        (own.value - exact.value).abs() / exact.sd
    };
    found.iter().zip(exact).map(off).fold(0.0, f64::max)
}

/// All within four standard deviations of the truth, and the cost that noise leaves.
fn is_true(outcome: &Outcome, truth: impl Fn(&str) -> f64) {
    for (name, found) in all_found(outcome) {
        let off = (found.value - truth(&name)).abs() / found.sd;
        assert!(off < 4.0, "{name}: {} ± {} for {}", found.value, found.sd, truth(&name));
    }
    let cost = outcome.fit.cost;
    assert!((893.0 - 170.0..893.0 + 170.0).contains(&cost), "{cost}");
}

/// The strut, and where and how fast the arm starts: the same minimum from near, from three times off, and where nothing but the first start is tried.
#[test]
fn the_strut_of_a_falling_arm_from_three_times_off() {
    let truth = numbers(&[("k", 50.0), ("c", 50.0), ("alpha", 0.5), ("w1", 0.2)]);
    let place = measured(&truth, 41);
    let free: Vec<String> =
        ["q", "v"].iter().flat_map(|of| (1..=3).map(move |joint| format!("\"motion.start.{of}.q{joint}\""))).collect();
    let fit = |of: &[(&'static str, f64)], sd: &str, starts: usize| {
        let data = record(sd, &format!("free = [{}]\n", free.join(", ")));
        place.fit(&format!("{}{}{data}[fit]\nstarts = {starts}\n", arm(&numbers(of)), sought(&LAW)))
    };
    let near = fit(&[("k", 60.0), ("c", 40.0), ("alpha", 0.4), ("l0", 0.68)], MILLIRADIAN, 1);
    is_true(&near, |name| match name.strip_prefix("fall.motion.start.") {
        Some("v.q1") => 0.2,
        Some(_) => 0.0,
        None => truth[name],
    });
    let exact = all_found(&near);
    assert_eq!(exact.len(), 10);
    let far: [([f64; 3], usize); 2] = [([150.0, 150.0, 0.8], 1), ([17.0, 17.0, 0.17], 20)];
    for ([k, c, alpha], starts) in far {
        let found = fit(&[("k", k), ("c", c), ("alpha", alpha)], MILLIRADIAN, starts);
        let off = furthest(&all_found(&found), &exact);
        assert!(off < 0.02, "from {k}, {c}, {alpha}: {off} standard deviations");
    }
    // Of a noise that is not known.
    let found = fit(&[("k", 150.0), ("c", 17.0), ("alpha", 0.8)], "", 1);
    let off = furthest(&all_found(&found), &exact);
    assert!(off < 0.02, "{off} standard deviations");
}

/// Masses, an inertia, dampings of joints and the strut, ten unknowns that are up to three times off.
#[test]
fn inertias_dampings_and_the_strut_of_a_driven_arm() {
    let own = [("k", 150.0), ("c", 50.0), ("alpha", 0.4), ("d1", 0.3), ("d2", 0.4), ("d3", 0.2), ("drive", 1.0)];
    let truth = numbers(&own);
    let place = measured(&truth, 42);
    let robot = [
        ("d1", "robot.body.column.joint.damping"),
        ("d2", "robot.body.upper_arm.joint.damping"),
        ("d3", "robot.body.forearm.joint.damping"),
        ("m2", "robot.body.upper_arm.mass"),
        ("m3", "robot.body.forearm.mass"),
        ("i3", "robot.body.forearm.inertia.yy"),
    ];
    let fit = |numbers: &Numbers| {
        // The second start is one of no body.
        let starts = format!("start = [{:?}, 0.3]\n", numbers["i3"]);
        let text = format!("{}{}{}{starts}{}", arm(numbers), sought(&LAW), sought(&robot), record(MILLIRADIAN, ""));
        place.fit(&format!("{text}[fit]\nstarts = 1\n"))
    };
    let near = fit(&truth);
    is_true(&near, |name| truth[name]);
    let mut far = truth.clone();
    let off =
        [("k", 3.0), ("c", 0.33), ("d1", 3.0), ("d2", 0.33), ("d3", 3.0), ("m2", 3.0), ("m3", 0.33), ("i3", 1.15)];
    off.iter().for_each(|(name, by)| *far.get_mut(name).unwrap() *= by);
    far.insert("alpha", 0.8);
    let off = furthest(&all_found(&fit(&far)), &all_found(&near));
    assert!(off < 0.02, "{off} standard deviations");
}

/// Where no record tells how one of the joints moves, growing parts of it lead there.
#[test]
fn the_strut_from_two_of_three_angles() {
    let truth = numbers(&[("k", 50.0), ("c", 50.0), ("alpha", 0.5)]);
    let place = measured(&truth, 43);
    let data = record(MILLIRADIAN, "").replace(", \"q.q3\" = { column = \"q3\", sd = \"1 mrad\" }", "");
    assert!(!data.contains("q3"));
    let fit = |of: &[(&'static str, f64)], starts: usize| {
        place.fit(&format!("{}{}{data}[fit]\nstarts = {starts}\n", arm(&numbers(of)), sought(&LAW)))
    };
    let near = all_found(&fit(&[("k", 50.0), ("c", 50.0), ("alpha", 0.5)], 1));
    let far = [("k", 10.0), ("c", 10.0), ("alpha", 0.8)];
    let off = furthest(&all_found(&fit(&far, 2)), &near);
    assert!(off < 0.02, "{off} standard deviations");
}
