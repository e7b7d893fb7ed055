//! Gripper paths through singular configurations: rows on and beside the instant, starts and ends there, and where no motion leads on.

use crate::support::robots::{ARM, springpot};
use crate::support::{Run, cases, run, run_case};
use springpot::motion::PathError;
use springpot::system::RunError;
use std::f64::consts::PI;

/// Links of the arm that turns about y in the plane of x and z.
const LINKS: [f64; 2] = [0.4, 0.35];

/// A file of testdata/silent up to its output times, and those.
fn silent(name: &str, times: &[f64]) -> String {
    let file = format!("{}/../../testdata/silent/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&file).unwrap_or_else(|error| panic!("{file}: {error}"));
    let end = text.find("output_times").expect("output times");
    format!("{}output_times = {times:?}\n", &text[..end])
}

/// Times on, and from 1e-15 to 0.1 s beside an instant.
fn around(instant: f64, end: f64) -> Vec<f64> {
    let beside = (0..=56).map(|k| 10f64.powf(-15.0 + 0.25 * f64::from(k)));
    let mut times: Vec<f64> = beside.flat_map(|d| [instant - d, instant + d]).chain([0.0, instant, end]).collect();
    times.retain(|t| (0.0..=end).contains(t));
    times.sort_by(f64::total_cmp);
    times.dedup();
    times
}

/// Largest departure of q, v, a from `exact` over all rows.
fn misses<const N: usize>(run: &Run, joints: [&str; N], exact: impl Fn(f64) -> [[f64; N]; 3]) -> [f64; 3] {
    let mut worst = [0.0f64; 3];
    for (order, prefix) in ["q", "v", "a"].into_iter().enumerate() {
        for (j, joint) in joints.into_iter().enumerate() {
            for (t, x) in run.t().into_iter().zip(run.column(&format!("{prefix}.{joint}"))) {
                let miss = (x - exact(t)[order][j]).abs();
                assert!(miss.is_finite(), "{prefix}.{joint} at {t}");
                worst[order] = worst[order].max(miss);
            }
        }
    }
    worst
}

/// What the ledger leaves, as a share of what was turned over.
fn residual(run: &Run) -> f64 {
    run.report.energy_residual.expect("a ledger") / run.report.energy_turned_over.expect("a ledger")
}

#[test]
fn an_arm_that_is_straight_for_an_instant() {
    // q = (0.3 t, t − 1): straight at t = 1 s.
    let times = around(1.0, 2.0);
    let run = run(&silent("d4_singular_row", &times));
    assert_eq!(run.rows.len(), times.len());
    let [q, v, a] = misses(&run, ["q0", "q1"], |t| [[0.3 * t, t - 1.0], [0.3, 1.0], [0.0, 0.0]]);
    println!("q {q:.1e}, v {v:.1e}, a {a:.1e}, residual {:.1e}", residual(&run));
    assert!(q < 1e-12 && v < 1e-10 && a < 1e-8, "{q:.1e} {v:.1e} {a:.1e}");
    // ½ vᵀMv of the straight arm: bodies of 1 kg at 0.2 m, and at 0.4 m and 0.175 m more.
    let kinetic = 0.5 * (0.2f64.powi(2) * 0.3f64.powi(2) + (0.4 * 0.3f64 + 0.175 * 1.3).powi(2));
    let k = times.iter().position(|t| *t == 1.0).unwrap();
    assert!((run.column("energy.kinetic")[k] - kinetic).abs() < 1e-10);
    assert!(run.column("tau.q0")[k].abs() < 1e-9 && residual(&run) < 1e-9);
}

/// q, v, a of the arm whose gripper is at (0.75 − 0.05 t², 0), from its closed form.
fn drawn_in(t: f64) -> [[f64; 2]; 3] {
    let [l0, l1] = LINKS;
    // sin(q1/2) = −g with g = t·k.
    let c = 0.05 / (4.0 * l0 * l1);
    let k = (c * (1.5 - 0.05 * t * t)).sqrt();
    let (dk, ddk) = (-0.05 * c * t / k, -0.05 * c / k - (0.05 * c * t).powi(2) / k.powi(3));
    let (g, dg, ddg) = (t * k, k + t * dk, 2.0 * dk + t * ddk);
    let root = (1.0 - g * g).sqrt();
    let q1 = -2.0 * g.asin();
    let (v1, a1) = (-2.0 * dg / root, -2.0 * (ddg / root + g * dg * dg / root.powi(3)));
    let (r2, (s, c)) = (l0 * l0 + l1 * l1 + 2.0 * l0 * l1 * q1.cos(), q1.sin_cos());
    let q0 = -(l1 * s).atan2(l0 + l1 * c);
    let share = -(l1 * l1 + l0 * l1 * c) / r2;
    let dshare = l0 * l1 * s * (l0 * l0 - l1 * l1) / (r2 * r2);
    [[q0, q1], [share * v1, v1], [dshare * v1 * v1 + share * a1, a1]]
}

#[test]
fn a_start_at_the_limit_of_the_reach() {
    let times = around(0.0, 2.0);
    let run = run(&silent("d4b_start_at_reach", &times));
    assert_eq!(run.rows.len(), times.len());
    let [q, v, a] = misses(&run, ["q0", "q1"], drawn_in);
    println!("q {q:.1e}, v {v:.1e}, a {a:.1e}, residual {:.1e}", residual(&run));
    assert!(q < 1e-11 && v < 1e-9 && a < 1e-7, "{q:.1e} {v:.1e} {a:.1e}");
    assert!(residual(&run) < 1e-9 && run.column("energy.residual").iter().all(|x| x.abs() < 1e-10));
}

/// The arm of `silent` between two slides along y, with the gripper at y(t); the rest as in "d4_singular_row".
fn with_slides(count: usize, y: &str, end: f64, times: &[f64]) -> String {
    let text = silent("d4_singular_row", times);
    let slide = |name: &str, y: &str| {
        format!(
            "[[robot.body]]\nname = \"{name}\"\njoint = {{ name = \"{name}\", kind = \"prismatic\", axis = [0, 1, 0]{y} }}\nmass = 1\n"
        )
    };
    let mut text = text.replacen("[[robot.body]]", &format!("{}[[robot.body]]", slide("s0", "")), 1);
    if count == 2 {
        let gripper = "[robot.gripper]\nbody = \"b1\"\npoint = [0.35, 0, 0]";
        assert!(text.contains(gripper));
        let last = slide("s1", ", origin = [0.35, 0, 0]");
        text = text.replace(gripper, &format!("{last}[robot.gripper]\nbody = \"s1\"\npoint = [0, 0, 0]"));
    }
    text.replace("y = 0", &format!("y = \"{y}\"")).replace("end = 2", &format!("end = {end}"))
}

#[test]
fn straight_for_an_instant_while_redundant() {
    // Two slides share what y asks of them.
    let run = run(&with_slides(2, "0.2*sin(2*t)", 2.0, &around(1.0, 2.0)));
    let exact = |t: f64| {
        let (s, c) = (2.0 * t).sin_cos();
        [[0.1 * s, 0.3 * t, t - 1.0, 0.1 * s], [0.2 * c, 0.3, 1.0, 0.2 * c], [-0.4 * s, 0.0, 0.0, -0.4 * s]]
    };
    let [q, v, a] = misses(&run, ["s0", "q0", "q1", "s1"], exact);
    println!("q {q:.1e}, v {v:.1e}, a {a:.1e}, residual {:.1e}", residual(&run));
    assert!(q < 1e-10 && v < 1e-9 && a < 1e-7, "{q:.1e} {v:.1e} {a:.1e}");
    assert!(residual(&run) < 1e-8);
}

#[test]
fn a_corner_where_the_arm_is_straight() {
    let run = run(&with_slides(1, "0.1*abs(t - 1)", 2.0, &around(1.0, 2.0)));
    let exact = |t: f64| {
        let side = if t >= 1.0 { 0.1 } else { -0.1 };
        [[0.1 * (t - 1.0).abs(), 0.3 * t, t - 1.0], [side, 0.3, 1.0], [0.0; 3]]
    };
    let [q, v, a] = misses(&run, ["s0", "q0", "q1"], exact);
    println!("q {q:.1e}, v {v:.1e}, a {a:.1e}, residual {:.1e}", residual(&run));
    assert!(q < 1e-11 && v < 1e-8 && a < 1e-6, "{q:.1e} {v:.1e} {a:.1e}");
}

#[test]
fn an_end_where_the_arm_is_straight() {
    let times = around(1.0, 1.0);
    let run = run(&silent("d4_singular_row", &times).replace("end = 2", "end = 1"));
    assert_eq!(run.rows.len(), times.len());
    let [q, v, a] = misses(&run, ["q0", "q1"], |t| [[0.3 * t, t - 1.0], [0.3, 1.0], [0.0, 0.0]]);
    println!("q {q:.1e}, v {v:.1e}, a {a:.1e}, residual {:.1e}", residual(&run));
    assert!(q < 1e-12 && v < 1e-9 && a < 1e-7, "{q:.1e} {v:.1e} {a:.1e}");
    assert!(residual(&run) < 1e-9);
}

#[test]
fn paths_through_straight_arms_at_any_speed() {
    // q1 = w·sin(t − s): straight at t = s + kπ, at a rate that changes; q0 turns with it.
    for (k, (w, s)) in [(0.3, 0.7), (1.0, 1.3), (2.5, 0.4), (0.05, 1.1)].into_iter().enumerate() {
        let (q0, q1) = ("0.2*t + 0.1*cos(t)", format!("{w}*sin(t - {s})"));
        let [l0, l1] = LINKS;
        let path = |f: &str| format!("{l0}*{f}({q0}) + {l1}*{f}({q0} + {q1})");
        let text = silent("d4_singular_row", &around(s, 5.0));
        let (head, tail) = (&text[..text.find("x = ").unwrap()], &text[text.find("[time]").unwrap()..]);
        let guess = w * (-s).sin();
        let text = format!(
            "{head}x = \"{}\"\ny = 0\nz = \"-({})\"\nguess = {{ q0 = 0.1, q1 = {guess} }}\n{}",
            path("cos"),
            path("sin"),
            tail.replace("end = 2", "end = 5")
        );
        let run = run(&text);
        let exact = |t: f64| {
            let ((a, b), (sin, cos)) = ((t - s).sin_cos(), t.sin_cos());
            [[0.2 * t + 0.1 * cos, w * a], [0.2 - 0.1 * sin, w * b], [-0.1 * cos, -w * a]]
        };
        let [q, v, a] = misses(&run, ["q0", "q1"], exact);
        println!("{k}: q {q:.1e}, v {v:.1e}, a {a:.1e}, residual {:.1e}", residual(&run));
        assert!(q < 1e-11 && v < 1e-8 && a < 1e-6, "{k}: {q:.1e} {v:.1e} {a:.1e}");
        assert!(residual(&run) < 1e-8, "{k}");
    }
}

/// How a run along x(t) of the arm of "d4b_start_at_reach" stops, and its last row.
fn stops(x: &str, z: &str, guess: &str) -> (PathError, f64) {
    let text = silent("d4b_start_at_reach", &[0.0, 0.25, 0.5, 0.75, 0.999, 1.0, 1.5, 2.0]);
    let text = text.replace("0.75-0.05*t^2", x).replace("z = 0\n", &format!("z = \"{z}\"\n"));
    let run = run_case(&cases(&text.replace("q0 = 0.1, q1 = -0.2", guess)), 0);
    assert!(run.rows.iter().flatten().all(|x| x.is_finite()));
    let Some(RunError::Path(error)) = run.error else { panic!("{:?}", run.error) };
    (error, run.report.t_reached.unwrap_or(-1.0))
}

#[test]
fn what_no_smooth_motion_leads_through_is_said() {
    let guess = "q0 = 0.1, q1 = -0.2";
    // A corner that touches the limit of the reach: the rates grow without bound.
    let (error, last) = stops("0.75 - 0.05*abs(t - 1)", "0", "q0 = 0.5, q1 = -1");
    println!("{error}");
    assert!(matches!(error, PathError::Singular { t } if (t - 1.0).abs() < 1e-6) && last == 0.999, "{last}");
    assert!(error.to_string().contains("singular on it at t = ") && error.to_string().contains("leads through it"));
    // A start from which it leaves as the root of the time.
    let (error, last) = stops("0.75 - 0.05*t", "0", guess);
    println!("{error}");
    assert!(error == PathError::Singular { t: 0.0 } && last == -1.0, "{last}");
    // A circle along the limit of the reach: no row, rather than one of least velocity that is not the motion's.
    let (error, last) = stops("0.75*cos(0.3*t)", "-0.75*sin(0.3*t)", guess);
    assert!(error == PathError::Singular { t: 0.0 } && last == -1.0, "{last}");
    // A guess that says nothing of the side.
    let (error, _) = stops("0.75 - 0.05*t^2", "0", "q0 = 0, q1 = 0");
    println!("{error}");
    assert!(error == PathError::Singular { t: 0.0 } && error.to_string().contains("to the side to which"));
    // Beyond the reach it is the reach.
    let (error, last) = stops("0.7 + 0.05*t", "0", guess);
    println!("{error}");
    let PathError::OutOfReach { t, at, distance, .. } = error else { panic!("{error:?}") };
    assert!((t - 1.0).abs() < 1e-6 && at > t && distance > 1e-9 && last == 0.999, "{t} {at} {distance} {last}");
    assert!((distance - 0.05 * (at - 1.0)).abs() < 1e-6);
}

#[test]
fn the_side_of_the_guess_is_taken() {
    let times = [0.0, 0.3, 2.0];
    let other = silent("d4b_start_at_reach", &times).replace("q0 = 0.1, q1 = -0.2", "q0 = -0.3, q1 = 0.7");
    let mirrored = |t: f64| drawn_in(t).map(|x| x.map(|x| -x));
    let [q, v, a] = misses(&run(&other), ["q0", "q1"], mirrored);
    assert!(q < 1e-11 && v < 1e-9 && a < 1e-7, "{q:.1e} {v:.1e} {a:.1e}");
}

#[test]
fn past_the_axis_of_the_column() {
    // The gripper passes the axis of q1 at a distance d: q1 turns by π in the time of d/(0.5 m/s), or not at all on the axis itself.
    for d in [0.1f64, 1e-3, 1e-5, 1e-6, 0.0] {
        let times: Vec<f64> = around(1.0, 2.0).into_iter().filter(|t| (t - 1.0).abs() > 1e-10 || *t == 1.0).collect();
        let path = format!(
            "[motion]\nkind = \"gripper-path\"\nx = \"0.5*(t - 1)\"\ny = {d:?}\nz = 0.5\n\
             guess = {{ q1 = 3, q2 = -1, q3 = 2.2 }}\n[time]\nend = 2\noutput_times = {times:?}\n"
        );
        let run = run(&format!("{ARM}{}{path}", springpot(0.5, "caputo")));
        let exact = |t: f64| {
            let x = 0.5 * (t - 1.0);
            let square = x * x + d * d;
            let turning = [[d.atan2(x)], [-0.5 * d / square], [0.5 * d * x / (square * square)]];
            if d == 0.0 { [[PI], [0.0], [0.0]] } else { turning }
        };
        let [q, v, a] = misses(&run, ["q1"], exact);
        // As shares of the largest.
        let fast = if d == 0.0 { 1.0 } else { 0.5 / d };
        let (v, a) = (v / fast, a / (fast * fast));
        println!("d = {d:e}: q {q:.1e}, v {v:.1e}, a {a:.1e}, residual {:.1e}", residual(&run));
        assert!(q < 1e-12 && v < 1e-9 && a < 1e-9, "d = {d:e}: {q:.1e} {v:.1e} {a:.1e}");
        assert!(residual(&run) < 1e-7, "d = {d:e}: {:.1e}", residual(&run));
    }
}

#[test]
fn a_turn_that_is_too_sharp_is_no_smooth_motion() {
    // Within 10 nm of the axis a turn by π would last 20 ns.
    let path = "[motion]\nkind = \"gripper-path\"\nx = \"0.5*(t - 1)\"\ny = 1e-8\nz = 0.5\n\
                guess = { q1 = 3, q2 = -1, q3 = 2.2 }\n[time]\nend = 2\noutput_times = [0, 0.9, 0.99, 0.999, 1, 1.01, 2]\n";
    let run = run_case(&cases(&format!("{ARM}{}{path}", springpot(0.5, "caputo"))), 0);
    let Some(RunError::Path(PathError::Singular { t })) = run.error else { panic!("{:?}", run.error) };
    assert!((t - 1.0).abs() < 1e-6 && run.report.t_reached == Some(0.99), "{t} {:?}", run.report.t_reached);
}
