//! Joints of all kinds in forward runs: tops against their closed forms, chains of joints, rotors and followers.

use crate::support::forward::{distance, every, largest};
use crate::support::{Run, run};
use springpot::spatial::{Quaternion, Rotation, Vec3};

/// sn, cn and dn of u at the modulus k < 1.
///
/// Source: Abramowitz and Stegun, Handbook of Mathematical Functions, 1964, §16.4 (the arithmetic-geometric mean).
fn jacobi(u: f64, k: f64) -> [f64; 3] {
    let (mut a, mut b) = (1.0, (1.0 - k * k).sqrt());
    let mut steps: Vec<(f64, f64)> = Vec::new();
    // Digits double in each step.
    for _ in 0..7 {
        let c = 0.5 * (a - b);
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
        steps.push((a, c));
    }
    let mut phi = (1u64 << steps.len()) as f64 * a * u;
    for (a, c) in steps.into_iter().rev() {
        phi = 0.5 * (phi + (c / a * phi.sin()).asin());
    }
    let sn = phi.sin();
    [sn, phi.cos(), (1.0 - k * k * sn * sn).sqrt()]
}

/// The integral of f from 0 to each of `times`, by the Gauss rule of order ten on panels of at most 10 ms.
fn integrals(times: &[f64], f: impl Fn(f64) -> f64) -> Vec<f64> {
    const NODES: [(f64, f64); 3] = [
        (0.0, 0.568_888_888_888_888_9),
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
        (0.906_179_845_938_664, 0.236_926_885_056_189_1),
    ];
    let mut sum = 0.0;
    let mut from = 0.0;
    times
        .iter()
        .map(|&to| {
            let panels = ((to - from) / 0.01f64).ceil().max(1.0);
            let half = 0.5 * (to - from) / panels;
            for p in 0..panels as usize {
                let middle = from + half * (2 * p + 1) as f64;
                for (x, w) in NODES {
                    let both = f(middle + x * half) + if x == 0.0 { 0.0 } else { f(middle - x * half) };
                    sum += w * half * both;
                }
            }
            from = to;
            sum
        })
        .collect()
}

fn turns(run: &Run, joint: &str) -> Vec<Rotation> {
    let q = ["qx", "qy", "qz", "qw"].map(|part| run.column(&format!("q.{joint}.{part}")));
    (0..q[0].len()).map(|k| Rotation::from_quaternion(Quaternion::new([0, 1, 2, 3].map(|i| q[i][k])))).collect()
}

fn spins(run: &Run, joint: &str) -> [Vec<f64>; 3] {
    ["wx", "wy", "wz"].map(|part| run.column(&format!("v.{joint}.{part}")))
}

/// How far an angle that is only known up to whole turns is from another one.
fn apart(a: f64, b: f64) -> f64 {
    let turn = a - b;
    (turn - std::f64::consts::TAU * (turn / std::f64::consts::TAU).round()).abs()
}

fn top(gravity: f64, com: f64, moments: [f64; 3], start: &str, end: f64) -> Run {
    let [xx, yy, zz] = moments;
    run(&(format!(
        "[robot]\ngravity = [0, 0, {gravity}]\n[[robot.body]]\nname = \"top\"\njoint = {{ name = \"s\", kind = \"spherical\" }}\nmass = 2\n\
         com = [0, 0, {com}]\ninertia = {{ xx = {xx}, yy = {yy}, zz = {zz} }}\n[motion]\nkind = \"forward\"\nstart = {{ {start} }}\n"
    ) + &every(end, 0.05, 1e-12)))
}

/// Euler and Poinsot: a free body about its centre of mass. Landau and Lifshitz, Mechanics, §37.
#[test]
fn a_free_body_spins_in_elliptic_functions() {
    let [i1, i2, i3] = [0.1f64, 0.18, 0.25];
    let [w1, w3] = [1.5f64, 2.5];
    // The angular momentum stands on z: the turn that leads the body's L = (i1·w1, 0, i3·w3) there is one about y.
    let tilt = -(i1 * w1).atan2(i3 * w3);
    let start = format!("q = {{ s = {{ rpy = [0, {tilt:.17}, 0] }} }}, v = {{ s = {{ wx = {w1}, wz = {w3} }} }}");
    let run = top(-9.81, 0.0, [i1, i2, i3], &start, 10.0);
    let energy2 = i1 * w1 * w1 + i3 * w3 * w3;
    let square = (i1 * w1).powi(2) + (i3 * w3).powi(2);
    assert!(square > energy2 * i2, "about the axis of the largest moment");
    let rate = ((i3 - i2) * (square - energy2 * i1) / (i1 * i2 * i3)).sqrt();
    let k = ((i2 - i1) * (energy2 * i3 - square) / ((i3 - i2) * (square - energy2 * i1))).sqrt();
    let middle = ((energy2 * i3 - square) / (i2 * (i3 - i2))).sqrt();
    let closed = |t: f64| {
        let [sn, cn, dn] = jacobi(rate * t, k);
        [w1 * cn, middle * sn, w3 * dn]
    };
    let (times, w, turns) = (run.t(), spins(&run, "s"), turns(&run, "s"));
    let size = square.sqrt();
    let precession = |t: f64| {
        let third = i3 * closed(t)[2];
        size * (energy2 - third * third / i3) / (square - third * third)
    };
    let azimuths = integrals(&times, precession);
    let (mut spin, mut momentum, mut azimuth) = (0.0f64, 0.0f64, 0.0f64);
    let of = |z: Vec3| z.0[1].atan2(z.0[0]);
    for (k, &t) in times.iter().enumerate() {
        let right = closed(t);
        spin = spin.max(largest((0..3).map(|i| w[i][k] - right[i])));
        let turned = turns[k] * Vec3([i1 * w[0][k], i2 * w[1][k], i3 * w[2][k]]);
        momentum = momentum.max(largest([turned.0[0], turned.0[1], turned.0[2] - size]));
        azimuth = azimuth.max(apart(of(turns[k].column(2)) - of(turns[0].column(2)), azimuths[k]));
    }
    let drift = largest(run.column("energy.kinetic").iter().map(|x| x - 0.5 * energy2));
    println!(
        "spin {spin:.1e}, momentum {momentum:.1e}, azimuth {azimuth:.1e}, energy {drift:.1e}, {} steps",
        run.report.steps
    );
    assert!(spin < 1e-9 && momentum < 1e-9 && azimuth < 1e-9 && drift < 1e-9);
    assert!(largest(w[1].iter().copied()) > 1.0, "it wobbles");
}

/// Lagrange: a heavy symmetric top on a point. Goldstein, Classical Mechanics, §5.7; cos θ is elliptic between two roots of a cubic.
#[test]
fn a_heavy_top_nutates_in_elliptic_functions() {
    let (mass, gravity, arm, transverse, axial) = (2.0, 9.81, 0.15, 0.02, 0.012);
    let (tilt, drift, spin) = (0.6f64, 1.0, 40.0);
    let start = format!(
        "q = {{ s = {{ rpy = [{tilt}, 0, 0] }} }}, v = {{ s = {{ wy = {:.17}, wz = {spin} }} }}",
        drift * tilt.sin()
    );
    let run = top(-gravity, arm, [transverse, transverse, axial], &start, 3.0);
    // About the point.
    let a_point = transverse + mass * arm * arm;
    let (a, beta) = (axial * spin / a_point, 2.0 * mass * gravity * arm / a_point);
    let u0 = tilt.cos();
    let b = drift * (1.0 - u0 * u0) + a * u0;
    let alpha = drift * drift * (1.0 - u0 * u0) + beta * u0;
    // f(u) = (α − βu)(1 − u²) − (b − au)² = β (u − u0)(u² + p u + r): it starts where it turns round.
    let p = u0 - (alpha + a * a) / beta;
    let r = (2.0 * a * b - beta) / beta + u0 * p;
    let root = (p * p - 4.0 * r).sqrt();
    let (lower, upper) = (0.5 * (-p - root), 0.5 * (-p + root));
    assert!(-1.0 < lower && lower < u0 && upper > 1.0, "{lower} {u0} {upper}: it starts at its highest");
    let k = ((u0 - lower) / (upper - lower)).sqrt();
    let rate = 0.5 * (beta * (upper - lower)).sqrt();
    // u = u₁ + (u₂ − u₁) sn²(K + x), and sn(K + x) = cn x/dn x.
    let closed = |t: f64| {
        let [_, cn, dn] = jacobi(rate * t, k);
        lower + (u0 - lower) * (cn / dn).powi(2)
    };
    let (times, w, turns) = (run.t(), spins(&run, "s"), turns(&run, "s"));
    let azimuths = integrals(&times, |t| {
        let u = closed(t);
        (b - a * u) / (1.0 - u * u)
    });
    let of = |z: Vec3| z.0[1].atan2(z.0[0]);
    let (mut nutation, mut azimuth) = (0.0f64, 0.0f64);
    for (k, &t) in times.iter().enumerate() {
        let z = turns[k].column(2);
        nutation = nutation.max((z.0[2] - closed(t)).abs());
        azimuth = azimuth.max(apart(of(z) - of(turns[0].column(2)), azimuths[k]));
    }
    let axial_spin = largest(w[2].iter().map(|w| w - spin));
    println!("nutation {nutation:.1e}, precession {azimuth:.1e}, spin {axial_spin:.1e}, {} steps", run.report.steps);
    assert!(nutation < 1e-9 && azimuth < 1e-9 && axial_spin < 1e-9);
    let range: Vec<f64> = turns.iter().map(|turn| turn.column(2).0[2]).collect();
    assert!(u0 - range.iter().fold(1.0, |least: f64, u| least.min(*u)) > 0.05, "it nutates");
}

/// A gimbal with a screw, a sleeve and a plate, on joints of several coordinates or on chains of them.
fn mechanism(is_chain: bool) -> String {
    let rest = "mass = 2\ncom = [0.1, -0.05, -0.2]\ninertia = { xx = 0.03, yy = 0.04, zz = 0.02, xy = 0.003 }\n";
    let one = |name: &str, parent: &str, joint: &str, rest: &str| {
        format!("[[robot.body]]\nname = \"{name}\"\nparent = \"{parent}\"\njoint = {{ {joint} }}\n{rest}")
    };
    let point = "mass = 0\n";
    let placed = "origin = [0.1, 0, -0.3], rpy = [0.3, -0.2, 0.5]";
    if is_chain {
        [
            one("g1", "world", "name = \"first\", kind = \"revolute\", axis = [1, 0, 0], damping = 0.05", point),
            one("frame", "g1", "name = \"second\", kind = \"revolute\", axis = [0.3, 1, 0], damping = 0.1, armature = 0.01", rest),
            one("s1", "frame", &format!("name = \"turn\", kind = \"revolute\", axis = [0, 0, 2], armature = 0.002, friction = 0.1, {placed}"), point),
            one(
                "spindle",
                "s1",
                &format!(
                    "name = \"advance\", kind = \"prismatic\", axis = [0, 0, 1], mimic = {{ joint = \"turn\", multiplier = \"{:.17} m/rad\" }}",
                    0.05 / std::f64::consts::TAU
                ),
                rest,
            ),
            one("c1", "frame", &format!("name = \"z\", kind = \"prismatic\", axis = [0, 1, 1], damping = 20, {placed}"), point),
            one("sleeve", "c1", "name = \"rz\", kind = \"revolute\", axis = [0, 1, 1], damping = 0.02", rest),
            one("p1", "sleeve", "name = \"x\", kind = \"prismatic\", axis = [1, 0, 0], damping = 5, origin = [0, 0.2, 0]", point),
            one("p2", "p1", "name = \"y\", kind = \"prismatic\", axis = [0, 1, 0], damping = 5", point),
            one("plate", "p2", "name = \"p\", kind = \"revolute\", axis = [0, 0, 1], damping = 0.1", rest),
        ]
        .concat()
    } else {
        [
            one(
                "frame",
                "world",
                "name = \"u\", kind = \"universal\", axis = [1, 0, 0], axis2 = [0.3, 1, 0], damping = { first = 0.05, second = 0.1 }, armature = { second = 0.01 }",
                rest,
            ),
            one("spindle", "frame", &format!("name = \"h\", kind = \"helical\", axis = [0, 0, 2], lead = \"50 mm\", armature = 0.002, friction = 0.1, {placed}"), rest),
            one("sleeve", "frame", &format!("name = \"c\", kind = \"cylindrical\", axis = [0, 1, 1], damping = {{ z = 20, rz = 0.02 }}, {placed}"), rest),
            one("plate", "sleeve", "name = \"p\", kind = \"planar\", damping = { x = 5, y = 5, rz = 0.1 }, origin = [0, 0.2, 0]", rest),
        ]
        .concat()
    }
}

#[test]
fn joints_of_several_coordinates_move_as_their_chains() {
    let of = |is_chain: bool| {
        let [slide, x, y, first, wz] = match is_chain {
            true => ["z", "x", "y", "first", "rz = 2"],
            false => ["c.z", "p.x", "p.y", "", ""],
        };
        let springs: String = [slide, x, y]
            .iter()
            .enumerate()
            .map(|(k, joint)| {
                format!("[[element]]\nname = \"e{k}\"\njoint = \"{joint}\"\nlaw = \"fractional-kelvin-voigt\"\nparameters = {{ k = 800, c = 20, alpha = 0.4 }}\n")
            })
            .collect();
        let start = match is_chain {
            true => format!("start = {{ q = {{ {first} = 0.4, turn = 0.3 }}, v = {{ {wz}, y = 0.5 }} }}\ntorque = {{ turn = \"0.3*sin(3*t)\" }}"),
            false => "start = { q = { u = { first = 0.4 }, h = 0.3 }, v = { c = { wz = 2 }, p = { vy = 0.5 } } }\ntorque = { h = \"0.3*sin(3*t)\" }".to_owned(),
        };
        let text = format!("{}{springs}[motion]\nkind = \"forward\"\n{start}\n", mechanism(is_chain));
        run(&(text + &every(2.0, 0.02, 1e-11)))
    };
    let (one, chain) = (of(false), of(true));
    let pairs = [
        ("q.u.first", "q.first"),
        ("q.u.second", "q.second"),
        ("q.h", "q.turn"),
        ("q.c.z", "q.z"),
        ("q.c.rz", "q.rz"),
        ("q.p.x", "q.x"),
        ("q.p.y", "q.y"),
        ("q.p.rz", "q.p"),
        ("v.c.vz", "v.z"),
        ("v.p.wz", "v.p"),
        ("energy.kinetic", "energy.kinetic"),
        ("energy.joints", "energy.joints"),
        ("e0.stored", "e0.stored"),
    ];
    for (left, right) in pairs {
        let error = distance(&one.column(left), &chain.column(right));
        let size = largest(chain.column(right)).max(1.0);
        println!("{left}: {error:.1e} of {size:.1}");
        assert!(error < 2e-10 * size, "{left}: {error:e}");
        assert!(largest(chain.column(right)) > 1e-2, "{right} moves");
    }
    assert!(one.residual() < 1e-10, "{:e}", one.residual());
}

/// The rotor's inertia is the only one there is: θ = M t²/2J.
#[test]
fn a_rotor_alone_turns() {
    let text = "[[robot.body]]\nname = \"r\"\njoint = { name = \"q\", kind = \"revolute\", axis = [0, 1, 0], armature = \"20 g*m^2\" }\nmass = 0\n\
                [motion]\nkind = \"forward\"\ntorque = { q = 0.3 }\n";
    let run = run(&(text.to_owned() + &every(1.0, 0.1, 1e-9)));
    let q = run.column("q.q");
    for (t, q) in run.t().into_iter().zip(q) {
        assert!((q - 0.5 * 0.3 / 0.02 * t * t).abs() < 1e-12, "{t} {q}");
    }
    assert!((run.column("energy.kinetic").last().unwrap() - 0.5 * 0.02 * 15.0 * 15.0).abs() < 1e-10);
}

/// A weight across the axis of a slider makes nothing of its motion, however small or slow that is; one partly along it is what the motion is told from.
#[test]
fn small_and_slow_motions_beside_weights() {
    let mut worst = 0.0f64;
    for (axis, along) in [("[1, 0, 0]", 0.0), ("[0.6, 0.8, 0]", 0.0), ("[0.6, 0, 0.8]", -9.81 * 0.8)] {
        for (amplitude, period) in [(1.0, 2.0), (1e-9, 2.0), (1e-12, 2.0), (1.0, 2e4), (1.0, 2e9)] {
            for method in ["", "method = \"radau\"", "method = \"explicit\""] {
                let omega = std::f64::consts::TAU / period;
                let (k, c) = (omega * omega, 0.02 * omega);
                let end = 3.0 * period;
                let run = run(&format!(
                    "[robot]\ngravity = [0, 0, -9.81]\n[[robot.body]]\nname = \"a\"\nmass = 1\njoint = {{ name = \"x\", kind = \"prismatic\", axis = {axis} }}\n\
                     [[element]]\nname = \"s\"\njoint = \"x\"\nlaw = \"kelvin-voigt\"\nparameters = {{ k = {k:e}, c = {c:e} }}\n\
                     [motion]\nkind = \"forward\"\nstart = {{ q = {{ x = {amplitude:e} }} }}\n[time]\nend = {end:e}\noutput_step = {step:e}\n\
                     [solver]\nrtol = 1e-9\n{method}\n",
                    step = end / 60.0,
                ));
                assert!(run.error.is_none(), "{axis} {amplitude} {period} {method}: {:?}", run.error);
                let (rest, decay) = (along / k, 0.5 * c);
                let swing = (k - decay * decay).sqrt();
                let exact = |t: f64| {
                    let (sin, cos) = (swing * t).sin_cos();
                    rest + (amplitude - rest) * (-decay * t).exp() * (cos + decay / swing * sin)
                };
                let wanted: Vec<f64> = run.t().into_iter().map(exact).collect();
                let error = distance(&run.column("q.x"), &wanted) / largest([amplitude, rest]);
                assert!(error < 1e-8, "{axis} {amplitude} {period} {method}: {error:e}");
                worst = worst.max(error);
            }
        }
    }
    println!("{worst:.1e}");
}
