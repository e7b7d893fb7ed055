//! Gripper paths: the robot follows, its rates are the path's, the answer is unique, and what cannot be followed is said.

use crate::support::robots::{ARM, every, springpot};
use crate::support::truth::derivatives;
use crate::support::{Run, cases, largest, relative_difference, run, run_case, shipped, system};
use springpot::dynamics::{Kinematics, angular_jacobian, angular_jacobian_rate, point_jacobian, point_jacobian_rate};
use springpot::model::Parent;
use springpot::motion::PathError;
use springpot::spatial::{Rotation, Vec3};
use springpot::system::{RunError, System};
use std::fmt::Write as _;

/// An arm of `joints` revolute joints with axes in turn about z, y, y, x, y, x and a gripper at its end.
fn arm(joints: usize) -> String {
    let axes = ["[0, 0, 1]", "[0, 1, 0]", "[0, 1, 0]", "[1, 0, 0]", "[0, 1, 0]", "[1, 0, 0]"];
    let origins =
        ["[0, 0, 0.3]", "[0, 0, 0.2]", "[0.45, 0, 0.02]", "[0.2, 0.01, 0]", "[0.25, 0, 0]", "[0.06, 0, 0.01]"];
    let mut text = String::new();
    for k in 0..joints {
        writeln!(
            text,
            "[[robot.body]]\nname = \"b{k}\"\nmass = {}\ncom = [0.1, 0.01, 0.02]\n\
             joint = {{ name = \"j{k}\", kind = \"revolute\", axis = {}, origin = {} }}\n\
             inertia = {{ xx = 0.02, yy = 0.03, zz = 0.03, xy = 0.001 }}",
            3.0 - 0.4 * k as f64,
            axes[k],
            origins[k],
        )
        .unwrap();
    }
    let reach = [0.3, 0.3, 0.4, 0.3, 0.12, 0.1][joints - 1];
    writeln!(text, "[robot.gripper]\nbody = \"b{}\"\npoint = [{reach}, 0.02, 0.03]", joints - 1).unwrap();
    text
}

fn path(x: &str, y: &str, z: &str, rest: &str) -> String {
    format!("\n[motion]\nkind = \"gripper-path\"\nx = \"{x}\"\ny = \"{y}\"\nz = \"{z}\"\n{rest}\n")
}

/// A closed curve in space within reach of the arms above.
fn curve(rest: &str) -> String {
    path("0.55 + 0.1*cos(2*t)", "0.15*sin(2*t)", "0.45 + 0.08*sin(3*t)", rest)
}

const GUESS: &str = "guess = { j1 = 0.3, j2 = 0.6, j3 = 0.2 }";

/// q, v, a of row `k`.
fn state(run: &Run, k: usize) -> [Vec<f64>; 3] {
    let joints = run.joints();
    ["q", "v", "a"].map(|p| joints.iter().map(|j| run.rows[k][index(run, &format!("{p}.{j}"))]).collect())
}

fn index(run: &Run, name: &str) -> usize {
    run.names.iter().position(|n| n == name).unwrap()
}

fn times(matrix: &[f64], vector: &[f64]) -> Vec<f64> {
    matrix.chunks(vector.len()).map(|row| row.iter().zip(vector).map(|(m, v)| m * v).sum()).collect()
}

/// What of `v` lies in the null space of the 3 × n matrix J: v − Jᵀ(JJᵀ)⁻¹J v.
fn null_space_part(jacobian: &[f64], v: &[f64]) -> f64 {
    let n = v.len();
    let row = |i: usize| &jacobian[i * n..(i + 1) * n];
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let columns: [Vec3; 3] = std::array::from_fn(|j| Vec3(std::array::from_fn(|i| dot(row(i), row(j)))));
    let right = Vec3(std::array::from_fn(|i| dot(row(i), v)));
    let determinant = columns[0].dot(columns[1].cross(columns[2]));
    let y = [
        right.dot(columns[1].cross(columns[2])) / determinant,
        columns[0].dot(right.cross(columns[2])) / determinant,
        columns[0].dot(columns[1].cross(right)) / determinant,
    ];
    (0..n).map(|j| (v[j] - (0..3).map(|i| y[i] * row(i)[j]).sum::<f64>()).abs()).fold(0.0, f64::max)
}

/// The wanted r, ṙ, r̈ of `curve`.
fn wanted(t: f64) -> [[f64; 3]; 3] {
    let ((s2, c2), (s3, c3)) = ((2.0 * t).sin_cos(), (3.0 * t).sin_cos());
    [
        [0.55 + 0.1 * c2, 0.15 * s2, 0.45 + 0.08 * s3],
        [-0.2 * s2, 0.3 * c2, 0.24 * c3],
        [-0.4 * c2, -0.6 * s2, -0.72 * s3],
    ]
}

fn gap(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Largest misses of the path and of its two rates over all rows, and the largest null-space part of v.
fn misses(system: &System, run: &Run) -> [f64; 4] {
    let site = system.gripper.expect("a gripper");
    let mut worst = [0.0f64; 4];
    for k in 0..run.rows.len() {
        let [q, v, a] = state(run, k);
        let kinematics = Kinematics::at_velocity(&system.model, &q, &v);
        let jacobian = point_jacobian(&system.model, &kinematics, &site);
        let rate = point_jacobian_rate(&system.model, &kinematics, &site);
        let [r, dr, ddr] = wanted(run.rows[k][0]);
        let acceleration: Vec<f64> = times(&jacobian, &a).iter().zip(times(&rate, &v)).map(|(x, y)| x + y).collect();
        let all = [
            gap(&kinematics.position(&site).0, &r),
            gap(&times(&jacobian, &v), &dr),
            gap(&acceleration, &ddr),
            null_space_part(&jacobian, &v),
        ];
        worst.iter_mut().zip(all).for_each(|(w, x)| *w = w.max(x));
    }
    worst
}

/// Largest differences of v and dq/dt, of a and dv/dt, by central differences of order 6 over evenly spaced rows.
fn differences(run: &Run, h: f64) -> [f64; 2] {
    const WEIGHTS: [f64; 3] = [45.0 / 60.0, -9.0 / 60.0, 1.0 / 60.0];
    let mut worst = [0.0f64; 2];
    for joint in run.joints() {
        let [q, v, a] = ["q", "v", "a"].map(|prefix| run.column(&format!("{prefix}.{joint}")));
        for k in 3..q.len() - 3 {
            let slope = |x: &[f64]| (0..3).map(|d| WEIGHTS[d] * (x[k + d + 1] - x[k - d - 1])).sum::<f64>() / h;
            worst[0] = worst[0].max((slope(&q) - v[k]).abs());
            worst[1] = worst[1].max((slope(&v) - a[k]).abs());
        }
    }
    worst
}

#[test]
fn redundant_arms_follow_with_least_velocity() {
    for joints in [3, 4, 5, 6] {
        let guess = if joints == 3 { "guess = { j1 = 0.3, j2 = 0.6 }" } else { GUESS };
        let text = format!("{}{}{}", arm(joints), curve(guess), every(3.2, 0.004));
        let (system, run) = (system(&text), run(&text));
        let [position, rate, acceleration, null] = misses(&system, &run);
        let [dq, dv] = differences(&run, 0.004);
        println!(
            "{joints} joints: r {position:.1e}, ṙ {rate:.1e}, r̈ {acceleration:.1e}, null {null:.1e}, q' − v {dq:.1e}, v' − a {dv:.1e}"
        );
        assert!(position < 1e-13 && rate < 1e-13 && acceleration < 1e-12, "{joints} joints");
        assert!(null < 1e-13, "{joints} joints: {null:.1e} of v moves nothing");
        assert!(dq < 1e-8 && dv < 1e-7, "{joints} joints: {dq:.1e} {dv:.1e}");
        assert!(largest(&run.column("gripper.error")) < 1e-12);
    }
}

#[test]
fn the_answer_does_not_depend_on_the_rows() {
    for joints in [3, 6] {
        let guess = if joints == 3 { "guess = { j1 = 0.3, j2 = 0.6 }" } else { GUESS };
        let with = |step: f64| run(&format!("{}{}{}", arm(joints), curve(guess), every(3.0, step)));
        let (coarse, fine) = (with(0.5), with(0.125));
        for (k, row) in coarse.rows.iter().enumerate() {
            assert_eq!(*row, fine.rows[4 * k], "{joints} joints, row {k}");
        }
    }
}

#[test]
fn a_redundant_arm_is_accurate_in_its_null_space_too() {
    // The branch is an integral, q' = J⁺ṙ: run it again by a fourth-order method with a very small step.
    let text = format!("{}{}{}", arm(5), curve(GUESS), every(3.0, 1.0));
    let (system, run) = (system(&text), run(&text));
    let site = system.gripper.unwrap();
    let velocity = |t: f64, q: &[f64]| -> Vec<f64> {
        let kinematics = Kinematics::at_position(&system.model, q);
        let jacobian = point_jacobian(&system.model, &kinematics, &site);
        let [_, rate, _] = wanted(t);
        let n = q.len();
        let mut v = vec![0.0; n];
        // v = Jᵀ y with JJᵀ y = ṙ, by Gauss–Seidel on the three rows (Kaczmarz), to rounding.
        for _ in 0..4000 {
            let before = v.clone();
            for i in 0..3 {
                let row = &jacobian[i * n..(i + 1) * n];
                let miss = rate[i] - row.iter().zip(&v).map(|(r, v)| r * v).sum::<f64>();
                let square: f64 = row.iter().map(|r| r * r).sum();
                v.iter_mut().zip(row).for_each(|(v, r)| *v += r * miss / square);
            }
            if gap(&before, &v) < 1e-16 {
                break;
            }
        }
        v
    };
    let mut q = state(&run, 0)[0].clone();
    let steps = 1500;
    let h = 3.0 / steps as f64;
    for k in 0..steps {
        let t = k as f64 * h;
        let at = |v: &[f64], s: f64| -> Vec<f64> { q.iter().zip(v).map(|(q, v)| q + s * v).collect() };
        let k1 = velocity(t, &q);
        let k2 = velocity(t + 0.5 * h, &at(&k1, 0.5 * h));
        let k3 = velocity(t + 0.5 * h, &at(&k2, 0.5 * h));
        let k4 = velocity(t + h, &at(&k3, h));
        for j in 0..q.len() {
            q[j] += h / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j]);
        }
        if (k + 1) % (steps / 3) == 0 {
            let row = (k + 1) / (steps / 3);
            let error = gap(&q, &state(&run, row)[0]);
            println!("t = {row} s: {error:.1e}");
            assert!(error < 3e-10, "t = {row} s: {error:.1e}");
        }
    }
}

#[test]
fn orientation_paths() {
    // Six joints, position and roll, pitch, yaw: no freedom is left.
    let rpy = "rpy = [\"0.3*sin(t)\", \"0.4 + 0.2*cos(2*t)\", \"0.25*sin(2*t)\"]";
    let motion = curve(&format!("{rpy}\nguess = {{ j1 = -0.5, j2 = 1.2, j3 = 0.1, j4 = -0.5, j5 = 0.1 }}"));
    let text = format!("{}{motion}{}", arm(6), every(3.2, 0.004));
    let (system, run) = (system(&text), run(&text));
    let [position, rate, acceleration, _] = misses(&system, &run);
    let [dq, dv] = differences(&run, 0.004);
    let site = system.gripper.unwrap();
    let (mut turn, mut spin) = (0.0f64, 0.0f64);
    let wanted_rotation =
        |t: f64| Rotation::from_rpy([0.3 * t.sin(), 0.4 + 0.2 * (2.0 * t).cos(), 0.25 * (2.0 * t).sin()]);
    for k in 0..run.rows.len() {
        let [q, v, a] = state(&run, k);
        let t = run.rows[k][0];
        let kinematics = Kinematics::at_velocity(&system.model, &q, &v);
        let frame = system.model.frame(Parent::Body(5)).unwrap();
        let rotation = kinematics.frame(&frame).rotation;
        for i in 0..3 {
            turn = turn.max(gap(&rotation.0[i], &wanted_rotation(t).0[i]));
        }
        // ω from J v against the rotation's own rate, and J a + J̇ v against ω's, by differences of the wanted rotation.
        let omega = |t: f64| -> [f64; 3] {
            let h = 1e-3;
            let slope: [[f64; 3]; 3] = std::array::from_fn(|i| {
                std::array::from_fn(|j| {
                    let r = |s: f64| wanted_rotation(t + s * h).0[i][j];
                    (45.0 * (r(1.0) - r(-1.0)) - 9.0 * (r(2.0) - r(-2.0)) + (r(3.0) - r(-3.0))) / (60.0 * h)
                })
            });
            let r = wanted_rotation(t).0;
            let entry = |i: usize, j: usize| (0..3).map(|k| slope[i][k] * r[j][k]).sum::<f64>();
            [entry(2, 1), entry(0, 2), entry(1, 0)]
        };
        let jacobian = angular_jacobian(&system.model, &kinematics, &site);
        spin = spin.max(gap(&times(&jacobian, &v), &omega(t)));
        let bias = times(&angular_jacobian_rate(&system.model, &kinematics, &site), &v);
        let alpha: Vec<f64> = times(&jacobian, &a).iter().zip(bias).map(|(x, y)| x + y).collect();
        let h = 1e-3;
        let slope: Vec<f64> = (0..3)
            .map(|i| {
                (8.0 * (omega(t + h)[i] - omega(t - h)[i]) - (omega(t + 2.0 * h)[i] - omega(t - 2.0 * h)[i]))
                    / (12.0 * h)
            })
            .collect();
        assert!(gap(&alpha, &slope) < 1e-7, "t = {t}: ω' misses by {:.1e}", gap(&alpha, &slope));
    }
    println!(
        "orientation: r {position:.1e}, ṙ {rate:.1e}, r̈ {acceleration:.1e}, R {turn:.1e}, ω {spin:.1e}, {dq:.1e} {dv:.1e}"
    );
    assert!(position < 1e-12 && rate < 1e-12 && acceleration < 1e-11 && turn < 1e-12 && spin < 1e-10);
    assert!(dq < 1e-8 && dv < 1e-7, "{dq:.1e} {dv:.1e}");
}

#[test]
fn a_path_that_leaves_the_reach_is_an_error_with_time_and_distance() {
    // The arm reaches 0.9 m from (0, 0, 0.6); the path leaves that at t = 1.
    let motion = path("0.8 + 0.1*t", "0", "0.6", "guess = { q3 = 0.8 }");
    let text = format!("{ARM}{}{motion}{}", springpot(0.5, "caputo"), every(2.0, 0.05));
    let run = run_case(&cases(&text), 0);
    let Some(RunError::Path(failure)) = &run.error else { panic!("{:?}", run.error) };
    println!("{failure}");
    let PathError::OutOfReach { t, distance, .. } = *failure else { panic!("{failure}") };
    assert!((t - 1.0).abs() < 1e-6, "{failure}");
    assert!(distance > 1e-9 && distance < 0.1, "{failure}");
    let message = run.error.as_ref().unwrap().to_string();
    assert!(message.contains("cannot reach its path at t = ") && message.contains(" m "), "{message}");
    // The rows before it are complete and right.
    let reached = run.report.t_reached.unwrap();
    assert!(reached <= t && reached > 0.9, "{reached}");
    assert_eq!(run.t(), (0..run.rows.len()).map(|k| (k as f64) / 20.0).collect::<Vec<_>>());
    assert!(run.rows.iter().flatten().all(|x| x.is_finite()));
    assert!(largest(&run.column("gripper.error")) < 1e-9);
    for (t, x) in run.t().into_iter().zip(run.column("gripper.x")) {
        assert!((x - 0.8 - 0.1 * t).abs() < 1e-9);
    }
}

#[test]
fn a_start_out_of_reach_is_an_error_at_once() {
    let motion = path("2 + 0*t", "0", "0.6", "guess = { q3 = 0.8 }");
    let run = run_case(&cases(&format!("{ARM}{}{motion}{}", springpot(0.5, "caputo"), every(2.0, 0.05))), 0);
    let Some(RunError::Path(failure)) = &run.error else { panic!("{:?}", run.error) };
    let PathError::OutOfReach { t, distance, .. } = *failure else { panic!("{failure}") };
    assert_eq!(t, 0.0);
    assert!((distance - 1.1).abs() < 1e-3, "{failure}");
    assert_eq!((run.rows.len(), run.report.t_reached), (0, None));
}

#[test]
fn nearly_outstretched() {
    // The elbow is all but straight at t = 1: the gripper comes within `margin` of its reach of 0.9 m.
    for margin in [1e-3, 1e-5, 1e-7] {
        let motion = path(
            &format!("{:?} - 0.1*(t - 1)^2", 0.9 - margin),
            "0.05*(t - 1)",
            "0.6",
            "guess = { q2 = -0.4, q3 = 0.8 }",
        );
        // The distance from the shoulder is sqrt(x² + y²): keep it inside.
        let text = format!("{ARM}{}{motion}{}", springpot(0.5, "caputo"), every(2.0, 0.01));
        let run = run_case(&cases(&text), 0);
        assert!(run.error.is_none(), "margin {margin:e}: {:?}", run.error);
        let mut worst = 0.0f64;
        for k in 0..run.rows.len() {
            let t = run.rows[k][0];
            let (x, y) = (0.9 - margin - 0.1 * (t - 1.0).powi(2), 0.05 * (t - 1.0));
            let (cosine, q3) = ((x * x + y * y - 0.41) / 0.4, state(&run, k)[0][2]);
            worst = worst.max((q3.cos() - cosine).abs());
            assert!(q3 > 0.0, "t = {t}: the elbow changed sides");
        }
        println!("margin {margin:e}: {worst:.1e}, {} steps, v up to {:.1}", run.effort(), largest(&run.column("v.q3")));
        assert!(worst < 1e-9 && largest(&run.column("gripper.error")) < 1e-9, "margin {margin:e}: {worst:.1e}");
    }
}

#[test]
fn kinked_paths() {
    // The path turns a corner at t = 1 and goes back at t = 2.
    let motion = path("0.8 - 0.05*abs(t - 1)", "0.1*min(t, 4 - t)", "0.3", "guess = { q3 = 1.0 }");
    for alpha in [0.1, 0.5, 0.9] {
        let text = format!("{ARM}{}{motion}{}", springpot(alpha, "caputo"), every(3.0, 0.0371));
        let (system, run) = (system(&text), run(&text));
        let exact = derivatives(&system, 0, &run.t()[1..], 0.1, &[1.0, 2.0]);
        let error = relative_difference(&exact, &run.column("strut.derivative")[1..]);
        let residual = run.report.energy_residual.unwrap() / run.report.energy_turned_over.unwrap();
        println!("alpha = {alpha}: {error:.1e}, residual {residual:.1e}");
        assert!(error < 1e-9, "alpha = {alpha}: {error:.1e}");
        assert!(residual < 1e-7, "alpha = {alpha}: {residual:.1e}");
        assert!(largest(&run.column("gripper.error")) < 1e-12);
    }
}

/// What a solved path is not known to is told from what steps err.
#[test]
fn solved_paths_do_not_try_in_vain() {
    let cases = shipped("magnetorheological_order.toml", &[]);
    for index in 0..cases.len() {
        let report = run_case(&cases, index).report;
        assert!(report.rejected_steps < 50, "case {index}: {} of {}", report.rejected_steps, report.steps);
    }
}
