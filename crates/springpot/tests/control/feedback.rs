//! Torques and inputs as expressions of the state.

use super::support::forward::{distance, every, largest, slider, state};
use super::support::robots::{ARM, magnetorheological};
use super::support::{Run, run, try_run};

const FREE: &str = "law = \"spring\"\nparameters = { k = 1e-30 }";

/// A mass of 2 kg on a slide, `torque` on it.
fn driven(torque: &str, start: &str, rest: &str) -> String {
    format!("{}torque = {{ q = {torque} }}\n{rest}", slider("2", 0.0, FREE, start))
}

#[test]
fn a_spring_and_a_dashpot_by_feedback_are_those_of_an_element() {
    let law = "law = \"kelvin-voigt\"\nparameters = { k = 50, c = 3 }";
    let times = every(4.0, 0.05, 1e-10);
    let material = run(&format!("{}{times}", slider("2", -9.81, law, &state("0.1", "0"))));
    for torque in [
        "\"-50*q.q - 3*v.q\"",
        "\"-50*e.stroke - 3*e.rate\"",
        "{ expression = \"-50*(e.length - 8) - 3*v.q\", unit = \"N\" }",
    ] {
        let by_feedback =
            run(&format!("{}torque = {{ q = {torque} }}\n{times}", slider("2", -9.81, FREE, &state("0.1", "0"))));
        let off = distance(&material.column("q.q"), &by_feedback.column("q.q"));
        assert!(off < 1e-11, "{torque}: {off:e}");
        assert!(by_feedback.residual() < 1e-9);
    }
}

#[test]
fn the_gripper_is_seen_in_place_and_speed() {
    let arm = |torque: &str| {
        let text = format!(
            "{ARM}\n[motion]\nkind = \"forward\"\nstart = {{ q = {{ q2 = 0.1, q3 = 0.2 }} }}\n{torque}\n{}",
            every(0.5, 0.05, 1e-10)
        );
        run(&text)
    };
    let by_gripper = arm("torque = { q2 = \"40*gripper.z - 5*gripper.vz\", q3 = \"-3*gripper.vx\" }");
    let by_hand = arm(
        "torque = { q2 = \"40*(0.6 - 0.5*sin(q.q2) - 0.4*sin(q.q2 + q.q3)) - 5*(-0.5*cos(q.q2)*v.q2 - 0.4*cos(q.q2 + q.q3)*(v.q2 + v.q3))\", \
         q3 = \"-3*(cos(q.q1)*(-0.5*sin(q.q2)*v.q2 - 0.4*sin(q.q2 + q.q3)*(v.q2 + v.q3)) - sin(q.q1)*v.q1*(0.5*cos(q.q2) + 0.4*cos(q.q2 + q.q3)))\" }",
    );
    for joint in ["q.q1", "q.q2", "q.q3"] {
        let off = distance(&by_gripper.column(joint), &by_hand.column(joint));
        assert!(off < 1e-11, "{joint}: {off:e}");
    }
}

/// m ẍ = −F·sign(v) stops at rest; m ẍ = −k x·step(x) − 2k x·step(−x) has another period on each side.
#[test]
fn steps_end_where_an_expression_has_a_kink() {
    let run = run(&driven("\"-8*q.q - 24*min(q.q, 0)\"", &state("0.5", "0"), &every(6.0, 0.05, 1e-10)));
    // Half swings with ω = 2 above 0 and ω = 4 below.
    let (slow, fast) = (2.0f64, 4.0f64);
    let exact = |t: f64| {
        let pi = std::f64::consts::PI;
        let period = pi / slow + pi / fast;
        let mut s = (t + 0.5 * pi / slow) % period;
        if s < pi / slow {
            0.5 * (slow * s).sin()
        } else {
            s -= pi / slow;
            -0.5 * slow / fast * (fast * s).sin()
        }
    };
    let off = largest(run.t().iter().zip(run.column("q.q")).map(|(t, q)| q - exact(*t)));
    assert!(off < 1e-9, "{off:e}");
    assert!(run.residual() < 1e-9, "{}", run.residual());
}

/// An on–off force switches where its argument passes zero: m ẍ = −3 sign(x) is a train of parabolas.
#[test]
fn forces_that_jump_switch_where_they_do() {
    let run = run(&driven("\"-3*sign(q.q)\"", &state("0.75", "0"), &every(8.0, 0.1, 1e-9)));
    // a = 1.5: from 0.75 at rest to 0 in 1 s.
    let exact = |t: f64| {
        let s = t % 4.0;
        let half = |s: f64| 0.75 * (1.0 - (s - 0.0).powi(2));
        match s {
            s if s < 1.0 => half(s),
            s if s < 3.0 => -half(s - 2.0),
            s => half(s - 4.0),
        }
    };
    let off = largest(run.t().iter().zip(run.column("q.q")).map(|(t, q)| q - exact(*t)));
    assert!(off < 1e-8, "{off:e}");
    assert!(run.report.steps < 5_000, "{}", run.report.steps);
}

#[test]
fn a_force_that_chatters_is_told() {
    let run = try_run(&driven("\"-3*sign(v.q)\"", &state("0", "1"), &every(2.0, 0.1, 1e-9)));
    let error = run.error.expect("it comes to rest").to_string();
    assert!(error.contains("switches again and again") && error.contains("-3*sign(v.q)"), "{error}");
    let smooth = try_run(&driven("\"-3*tanh(v.q/1e-3)\"", &state("0", "1"), &every(2.0, 0.1, 1e-9)));
    assert!(smooth.error.is_none());
}

/// A skyhook by the voltage of a magnetorheological strut: the coefficient follows the state at every time.
fn skyhook(u: &str, rtol: f64) -> Run {
    let strut = magnetorheological(0.6, "caputo");
    let strut = strut.replace("u = \"1 V\"", &format!("u = {u}"));
    assert!(strut.contains(u));
    run(&format!(
        "{ARM}{strut}\n[motion]\nkind = \"forward\"\nstart = {{ q = {{ q2 = 0.1, q3 = 0.2 }} }}\ntorque = {{ q2 = -30 }}\n{}",
        every(1.0, 0.02, rtol)
    ))
}

#[test]
fn inputs_that_follow_the_state_close_the_balance() {
    for u in [
        "\"2*tanh(strut.rate/0.05)^2\"",
        "{ expression = \"2*step(strut.rate*gripper.vz)\", unit = \"V\", sample = \"1 ms\" }",
        "\"1 + 0.5*sin(20*t)*q.q2\"",
    ] {
        let run = skyhook(u, 1e-9);
        assert!(run.residual() < 1e-8, "{u}: {:e}", run.residual());
        let u = run.column("strut.u");
        assert!(u.iter().any(|value| *value != u[0]));
    }
}

#[test]
fn what_is_sampled_holds_from_its_sample_on() {
    let text = |sample: &str| {
        driven(
            &format!("{{ expression = \"-50*q.q - 3*v.q\", unit = \"N\", sample = \"{sample}\" }}"),
            &state("0.1", "0"),
            &every(1.0, 0.01, 1e-10),
        )
    };
    let run = run(&text("20 ms"));
    let (tau, q, v) = (run.column("tau.q"), run.column("q.q"), run.column("v.q"));
    for k in 0..=100 {
        let at = k - k % 2;
        assert!((tau[k] + 50.0 * q[at] + 3.0 * v[at]).abs() < 1e-12, "row {k}");
    }
    // Between two samples the mass moves with a constant force.
    let a = tau[0] / 2.0;
    assert!((q[1] - (0.1 + 0.5 * a * 1e-4)).abs() < 1e-14);
    // Ever finer samples come to the law at every time.
    let exact = super::support::run(&driven("\"-50*q.q - 3*v.q\"", &state("0.1", "0"), &every(1.0, 0.01, 1e-10)));
    let off = |sample: &str| distance(&super::support::run(&text(sample)).column("q.q"), &exact.column("q.q"));
    let (coarse, fine) = (off("2 ms"), off("1 ms"));
    assert!((1.9..2.1).contains(&(coarse / fine)), "{coarse:e} {fine:e}");
}

/// Two sampled signals of one instant see one another's old values, 0 before t = 0.
#[test]
fn samples_of_one_instant_see_old_values() {
    let run = run(&driven(
        "{ expression = \"2 + a.q\", unit = \"N\", sample = \"0.1 s\" }",
        &state("0", "0"),
        &every(0.5, 0.05, 1e-9),
    ));
    // τ_k = 2 + τ_{k−1}/2, from 0.
    let mut wanted = 0.0;
    for (k, tau) in run.column("tau.q").into_iter().enumerate() {
        if k % 2 == 0 {
            wanted = 2.0 + wanted / 2.0;
        }
        assert!((tau - wanted).abs() < 1e-12, "row {k}: {tau}, not {wanted}");
    }
}

#[test]
fn sampled_forces_of_elements_are_those_just_before() {
    let law = "law = \"magnetorheological\"\nparameters = { E_c = 100, mu_0 = 5, mu = 20, alpha = 0.5 }\n\
               inputs = { u = { expression = \"step(e.force)\", unit = \"V\", sample = \"10 ms\" } }";
    let run = run(&format!("{}{}", slider("2", -9.81, law, &state("0.1", "0")), every(1.0, 0.01, 1e-9)));
    let (u, force, derivative) = (run.column("e.u"), run.column("e.force"), run.column("e.derivative"));
    let stroke = run.column("e.stroke");
    for k in 1..u.len() {
        let before = 100.0 * stroke[k] + (5.0 + 20.0 * u[k - 1]) * derivative[k];
        assert_eq!(u[k], if before >= 0.0 { 1.0 } else { 0.0 }, "row {k}");
        assert!((force[k] - (100.0 * stroke[k] + (5.0 + 20.0 * u[k]) * derivative[k])).abs() < 1e-9);
    }
    assert!(run.residual() < 1e-8, "{}", run.residual());
}

/// A base that floats is moved by the arm on it alone: what both have of momentum stays nothing.
#[test]
fn a_floating_base_follows_its_arm() {
    let text = "[robot]\ngravity = [0, 0, 0]\n[[robot.body]]\nname = \"base\"\njoint = { name = \"free\", kind = \"floating\" }\nmass = 10\n\
                inertia = { xx = 1, yy = 1, zz = 1 }\n[[robot.body]]\nname = \"arm\"\n\
                joint = { name = \"q1\", kind = \"prismatic\", axis = [1, 0, 0] }\nmass = 2\n[motion]\nkind = \"forward\"\n\
                [motion.controller]\nkind = \"pd-gravity\"\nkp = 40\nkd = 12\n\
                reference = { kind = \"move\", to = { q1 = 1 }, duration = 1 }\n";
    let run = run(&format!("{text}{}", every(6.0, 0.1, 1e-9)));
    let (base, arm) = (run.column("q.free.x"), run.column("q.q1"));
    assert!((arm.last().unwrap() - 1.0).abs() < 1e-3);
    let off = largest(base.iter().zip(&arm).map(|(base, arm)| 12.0 * base + 2.0 * arm));
    assert!(off < 1e-9, "{off:e}");
}

/// A ball with an inertia and no mass off its centre, on a joint that turns freely.
fn ball(kind: &str, inertia: [f64; 3], motion: &str) -> String {
    let [xx, yy, zz] = inertia;
    format!(
        "[robot]\ngravity = [0, 0, 0]\n[[robot.body]]\nname = \"b\"\nmass = 2\njoint = {{ name = \"s\", kind = \"{kind}\" }}\n\
         inertia = {{ xx = {xx}, yy = {yy}, zz = {zz} }}\n[motion]\nkind = \"forward\"\n{motion}\n"
    )
}

/// J ω' = −d ω where J is that of a ball; of another body what is dissipated is what the actuators take.
#[test]
fn a_ball_joint_is_damped() {
    let motion = "start = { v = { s = { wx = 3, wy = -2, wz = 1 } } }\n\
        torque = { s = { wx = \"-0.5*v.s.wx\", wy = \"-0.5*v.s.wy\", wz = \"-0.5*v.s.wz\" } }";
    let times = every(3.0, 0.1, 1e-10);
    let round = run(&format!("{}{times}", ball("spherical", [0.4; 3], motion)));
    for (name, start) in [("v.s.wx", 3.0), ("v.s.wy", -2.0), ("v.s.wz", 1.0)] {
        let exact: Vec<f64> = round.t().iter().map(|t| start * (-0.5 / 0.4 * t).exp()).collect();
        let off = distance(&exact, &round.column(name));
        assert!(off < 1e-9, "{name}: {off:e}");
    }
    let long = run(&format!("{}{times}", ball("spherical", [0.2, 0.4, 0.5], motion)));
    assert!(long.residual() < 1e-9, "{:e}", long.residual());
    let sampled = motion
        .replace("\"-0.5*v.s.wy\"", "{ expression = \"-0.5*v.s.wy + q.s.qx\", unit = \"N*m\", sample = \"10 ms\" }");
    assert!(run(&format!("{}{times}", ball("spherical", [0.2, 0.4, 0.5], &sampled))).residual() < 1e-9);
}

/// m x" = −k x of a body that floats, turned by 30 degrees about z: its axes are not those of the world.
#[test]
fn a_floating_body_is_held() {
    let motion = "start = { q = { s = { x = 0.3, y = -0.1, rpy = [0, 0, \"30 deg\"] } } }\n\
        torque = { s = { vx = \"-50*(q.s.x*cos(pi/6) + q.s.y*sin(pi/6))\", vy = \"-50*(q.s.y*cos(pi/6) - q.s.x*sin(pi/6))\" } }";
    let held = run(&format!("{}{}", ball("floating", [0.4; 3], motion), every(3.0, 0.1, 1e-10)));
    for (name, start) in [("q.s.x", 0.3), ("q.s.y", -0.1)] {
        let exact: Vec<f64> = held.t().iter().map(|t| start * (5.0 * t).cos()).collect();
        let off = distance(&exact, &held.column(name));
        assert!(off < 1e-9, "{name}: {off:e}");
    }
}
