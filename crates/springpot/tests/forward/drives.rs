//! Joints that are prescribed, locked, driven or followed, each against the same robot made otherwise.

use crate::support::forward::{distance, every, falling, largest, slider, state};
use crate::support::robots::{ARM, strut};
use crate::support::{Run, run};

const RTOL: f64 = 1e-9;

/// Largest distance of the named columns of two runs.
fn gap(a: &Run, b: &Run, names: &[&str]) -> f64 {
    largest(names.iter().map(|name| distance(&a.column(name), &b.column(name))))
}

#[test]
fn the_torque_of_a_prescribed_joint_brings_the_motion_about() {
    let rows = every(1.0, 0.002, RTOL);
    let first = run(&(falling(0.5, 25.0, "caputo", "prescribed = { q2 = \"0.3 + 0.2*sin(6*t)\" }") + &rows));
    assert!(largest(first.column("tau.q2")) > 10.0 && largest(first.column("v.q3")) > 1.0);
    // Free joints have no actuator.
    assert_eq!((largest(first.column("tau.q1")), largest(first.column("tau.q3"))), (0.0, 0.0));
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("torque.csv");
    let lines = first.column("t").into_iter().zip(first.column("tau.q2")).map(|(t, tau)| format!("{t},{tau}\n"));
    std::fs::write(&file, format!("t,tau\n{}", lines.collect::<String>())).unwrap();
    let torque = format!(
        "torque = {{ q2 = {{ csv = {file:?}, column = \"tau\" }} }}\nstart = {{ q = {{ q2 = 0.3 }}, v = {{ q2 = 1.2 }} }}"
    );
    let again = run(&(falling(0.5, 25.0, "caputo", &torque) + &rows));
    // Straight lines between samples 2 ms apart err by h² tau''/8 = 2e-5 of tau.
    let error = gap(&first, &again, &["q.q1", "q.q2", "q.q3"]);
    println!("the same motion within {error:.1e}");
    assert!(error < 2e-4, "{error:e}");
    assert!(first.residual() < 10.0 * RTOL && again.residual() < 10.0 * RTOL);
}

#[test]
fn all_joints_prescribed_is_a_prescribed_motion() {
    let joints = "{ q1 = 0, q2 = \"0.1*sin(8*t)\", q3 = \"0.1*t\" }";
    let rows = every(5.0, 0.05, 1e-9);
    for derivative in ["caputo", "riemann-liouville"] {
        let forward = run(&(falling(0.5, 25.0, derivative, &format!("prescribed = {joints}")) + &rows));
        let along =
            falling(0.5, 25.0, derivative, "").replace("\"forward\"", &format!("\"prescribed\"\njoints = {joints}"));
        let along = run(&(along + &rows));
        assert_eq!(forward.names, along.names);
        for name in &forward.names {
            let (a, b) = (forward.column(name), along.column(name));
            let error = distance(&a, &b) / (1.0 + largest(b));
            // Energies are integrals of powers over other steps.
            println!("{derivative} {name}: {error:.1e}");
            let bound = if name.starts_with("energy") || name.ends_with("dissipated") { 1e-7 } else { 2e-9 };
            assert!(error < bound, "{derivative} {name}: {error:e}");
        }
    }
}

#[test]
fn a_prescribed_joint_apart_from_the_free_ones_is_watched() {
    // The element stretches with q2 alone, which moves fast; q1 is free and hardly moves.
    let text = format!(
        "{ARM}{}\n[motion]\nkind = \"forward\"\nprescribed = {{ q2 = \"0.3*sin(40*t)\", q3 = 0 }}\n",
        strut("law = \"springpot\"\nparameters = { c = 50, alpha = 0.5 }")
    );
    let forward = run(&(text.clone() + &every(2.0, 0.01, 1e-8)));
    let along = text.replace("\"forward\"", "\"prescribed\"").replace("prescribed = { ", "joints = { q1 = 0, ");
    let along = run(&(along + &every(2.0, 0.01, 1e-10)));
    let error = gap(&forward, &along, &["strut.derivative"]) / largest(along.column("strut.derivative"));
    println!("D^½ x within {error:.1e}, {} steps", forward.report.steps);
    assert!(error < 1e-7, "{error:e}");
}

#[test]
fn a_prescribed_joint_beside_a_singular_start_costs_no_more_steps() {
    let text =
        falling(0.8, 25.0, "riemann-liouville", "prescribed = { q2 = \"0.1*sin(3*t)\" }").replace("70 cm", "65 cm");
    let [coarse, fine] = [1e-6, 1e-9].map(|rtol| run(&(text.clone() + &every(2.0, 0.01, rtol))));
    assert!(coarse.report.steps < 1000 && fine.report.steps < 4000, "{} {}", coarse.report.steps, fine.report.steps);
    let error = gap(&coarse, &fine, &["q.q3", "v.q3"]);
    println!("{} steps, q and v of the free joint within {error:.1e}", coarse.report.steps);
    assert!(error < 1e-6, "{error:e}");
}

#[test]
fn a_locked_joint_is_a_fixed_one() {
    let motion = "start = { q = { q2 = 0.3, q3 = -0.4 } }\nlocked = [\"q3\"]";
    let locked = run(&(falling(0.5, 25.0, "caputo", motion) + &every(1.0, 0.01, RTOL)));
    let fixed = falling(0.5, 25.0, "caputo", "start = { q = { q2 = 0.3 } }").replace(
        "joint = { name = \"q3\", kind = \"revolute\", axis = [0, 1, 0], origin = [0.5, 0, 0] }",
        "joint = { name = \"q3\", kind = \"fixed\", rpy = [0, -0.4, 0], origin = [0.5, 0, 0] }",
    );
    let fixed = run(&(fixed + &every(1.0, 0.01, RTOL)));
    let error = gap(&locked, &fixed, &["q.q1", "q.q2", "v.q1", "v.q2", "strut.stroke", "energy.kinetic"]);
    println!("locked and fixed within {error:.1e}");
    assert!(error < 1e-7, "{error:e}");
    assert!(locked.column("q.q3").iter().all(|q| *q == -0.4) && largest(locked.column("tau.q3")) > 1.0);
    assert_eq!(largest(locked.column("v.q3")), 0.0);
}

#[test]
fn a_joint_that_follows_another_weighs_on_it() {
    // B moves by 3 q − 0.2: its mass counts ninefold, and so do its damping and the element that it pulls.
    let urdf = r#"<robot name="pair"><link name="world_link"/>
<link name="a"><inertial><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="b"><inertial><mass value="0.5"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="lead" type="prismatic"><parent link="world_link"/><child link="a"/><axis xyz="0 0 1"/>
<limit lower="-9" upper="9" effort="9" velocity="9"/><dynamics damping="0.3"/></joint>
<joint name="follow" type="prismatic"><origin xyz="1 0 0"/><parent link="world_link"/><child link="b"/><axis xyz="1 0 0"/>
<limit lower="-9" upper="9" effort="9" velocity="9"/><dynamics damping="0.2"/><mimic joint="lead" multiplier="3" offset="-0.2"/></joint>
</robot>"#;
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("pair.urdf");
    std::fs::write(&file, urdf).unwrap();
    let motion = |joint: &str| {
        format!(
            "[motion]\nkind = \"forward\"\nstart = {{ q = {{ {joint} = 0.1 }} }}\ntorque = {{ {joint} = \"2*sin(3*t)\" }}\n"
        )
    };
    let follower = format!(
        "[robot]\nurdf = {file:?}\n[[element]]\nname = \"e\"\nfrom = {{ body = \"world\", point = [-4, 0, 0] }}\n\
         to = {{ body = \"b\", point = [0, 0, 0] }}\nrest_length = 4.8\nlaw = \"fractional-kelvin-voigt\"\n\
         parameters = {{ k = 20, c = 10, alpha = 0.6 }}\nderivative = \"riemann-liouville\"\n{}",
        motion("lead")
    );
    let by_hand = format!(
        "[robot]\ngravity = [0, 0, {}]\n[[robot.body]]\nname = \"a\"\n\
         joint = {{ name = \"q\", kind = \"prismatic\", axis = [0, 0, 1], origin = [0, 0, 4], damping = {} }}\nmass = {}\n\
         [[element]]\nname = \"e\"\nfrom = {{ body = \"world\", point = [0, 0, 0] }}\nto = {{ body = \"a\", point = [0, 0, 0] }}\n\
         rest_length = 4\nlaw = \"fractional-kelvin-voigt\"\nparameters = {{ k = 180, c = 90, alpha = 0.6 }}\n\
         derivative = \"riemann-liouville\"\n{}",
        -9.81 * 2.0 / (2.0 + 9.0 * 0.5),
        0.3 + 9.0 * 0.2,
        2.0 + 9.0 * 0.5,
        motion("q")
    );
    let rows = every(3.0, 0.01, 1e-10);
    let (a, b) = (run(&(follower + &rows)), run(&(by_hand + &rows)));
    let error = distance(&a.column("q.lead"), &b.column("q.q")).max(distance(&a.column("v.lead"), &b.column("v.q")));
    println!("followed and by hand within {error:.1e}");
    assert!(error < 1e-7, "{error:e}");
    assert!(largest(a.column("q.lead")) > 0.1);
}

/// A cart whose path has a corner at 0.4 s, and a pendulum of 1 kg at 0.5 m on it.
const CART: &str = r#"
[[robot.body]]
name = "cart"
joint = { name = "x", kind = "prismatic", axis = [1, 0, 0] }
mass = 2
[[robot.body]]
name = "pendulum"
joint = { name = "swing", kind = "revolute", axis = [0, 1, 0] }
mass = 1
com = [0, 0, -0.5]
inertia = { xx = 0.02, yy = 0.02, zz = 0.02 }
[motion]
kind = "forward"
prescribed = { x = "0.8*abs(t - 0.4)" }
"#;

#[test]
fn a_corner_in_a_prescribed_path_kicks_the_free_joints() {
    let run = run(&(CART.to_owned() + &every(1.4, 0.01, 1e-9)));
    let (t, swing, speed) = (run.column("t"), run.column("q.swing"), run.column("v.swing"));
    let (lever, inertia) = (0.5, 0.02 + 0.25);
    for k in 0..t.len() {
        if t[k] < 0.3999 {
            assert_eq!((swing[k], speed[k]), (0.0, 0.0));
            continue;
        }
        // Seen from the cart, which goes on steadily, the pendulum keeps the energy of the kick m l Δv/(J + m l²).
        let kick = lever * 1.6 / inertia;
        let energy = 0.5 * inertia * speed[k].powi(2) + 9.81 * lever * (1.0 - swing[k].cos());
        let expected = 0.5 * inertia * kick * kick;
        assert!(t[k] < 0.4001 || (energy / expected - 1.0).abs() < 1e-7, "t = {}: {energy} {expected}", t[k]);
    }
    assert!(largest(swing.clone()) > 0.5);
    println!("balance {:.1e}", run.residual());
    assert!(run.residual() < 1e-8);
}

/// M a = tau − F of the vertical slider without gravity, in rows where the torque switches, long after a singular start and in steps of
/// every kind.
#[test]
fn rows_where_torques_switch_know_the_share_of_a_singular_start() {
    let law = "law = \"springpot\"\nparameters = { c = 50, alpha = 0.4 }\nderivative = \"riemann-liouville\"";
    let torque = "\ntorque = { q = \"5*sign(t-0.2)*sin(7*t)\" }";
    let text = slider("2", 0.0, law, &(state("0.1", "0") + torque));
    let rows = |end: f64| every(end, 0.1, 1e-9);
    for text in [
        text.clone() + &rows(0.5),
        text.clone() + &rows(0.5) + "method = \"midpoint\"\nstep = \"2 ms\"\n",
        text.clone() + "prescribed = {}" + &rows(0.5),
    ] {
        let run = run(&text);
        let (a, tau, force) = (run.column("a.q"), run.column("tau.q"), run.column("e.force"));
        for k in 1..a.len() {
            let left = 2.0 * a[k] - (tau[k] - force[k]);
            assert!(left.abs() < 1e-9, "row {k}: {left:e} of {}", force[k]);
        }
    }
}
