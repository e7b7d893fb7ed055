//! Runs of robots from URDF files: joints that follow others, damping and friction, limits.

use crate::support::robots::every;
use crate::support::{Run, cases, largest, relative_difference, run, run_case, shipped};
use springpot::driver::{LimitKind, LimitWatch, PassedLimit};
use springpot::model::FRICTION_SPEED;
use std::path::PathBuf;

const ARM: [&str; 7] =
    ["panda_joint1", "panda_joint2", "panda_joint3", "panda_joint4", "panda_joint5", "panda_joint6", "panda_joint7"];

fn file(name: &str) -> String {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../testdata/multibody").join(name);
    path.display().to_string()
}

/// The Panda with an element at a finger; `more` is what else the robot and the motion say.
fn panda(robot: &str, motion: &str) -> String {
    format!(
        "[robot]\nurdf = '{}'\n{robot}\n[robot.gripper]\nbody = \"panda_hand_tcp\"\npoint = [0, 0.01, 0]\n\
         [[element]]\nname = \"pad\"\nfrom = {{ body = \"panda_rightfinger\", point = [0, 0, 0.04] }}\n\
         to = {{ body = \"panda_link5\", point = [0.1, 0.05, 0] }}\nrest_length = 0.3\nlaw = \"springpot\"\n\
         parameters = {{ c = 40, alpha = 0.5 }}\n[motion]\n{motion}\n{}",
        file("panda.urdf"),
        every(2.0, 0.02)
    )
}

const SWING: &str = "kind = \"prescribed\"\n[motion.joints]\n\
    panda_joint1 = \"0.4*sin(t)\"\npanda_joint2 = \"-0.5 + 0.3*sin(2*t)\"\npanda_joint3 = \"0.2*sin(3*t)\"\n\
    panda_joint4 = \"-2 + 0.3*cos(t)\"\npanda_joint5 = \"0.3*sin(2*t)\"\npanda_joint6 = \"1.6 + 0.2*sin(t)\"\n\
    panda_joint7 = \"0.5*t\"\npanda_finger_joint1 = \"0.02 + 0.015*sin(4*t)\"";

#[test]
fn a_finger_that_follows_moves_as_one_that_is_prescribed() {
    let following = run(&panda("", SWING));
    let both = format!("{SWING}\npanda_finger_joint2 = \"0.02 + 0.015*sin(4*t)\"");
    let prescribed = run(&panda("ignore_mimic = true", &both));
    assert_eq!(following.joints().len() + 1, prescribed.joints().len());

    for joint in ARM {
        let columns = [&prescribed, &following].map(|run| run.column(&format!("tau.{joint}")));
        assert!(relative_difference(&columns[0], &columns[1]) < 1e-12, "{joint}");
        let columns = [&prescribed, &following].map(|run| run.column(&format!("pad.Q.{joint}")));
        assert!(largest(&columns[0]) == 0.0 || relative_difference(&columns[0], &columns[1]) < 1e-12, "{joint}");
    }
    // One actuator moves both fingers, and the pad pulls at both of them through it.
    for column in ["tau", "pad.Q"] {
        let fingers = [1, 2].map(|finger| prescribed.column(&format!("{column}.panda_finger_joint{finger}")));
        let sum: Vec<f64> = fingers[0].iter().zip(&fingers[1]).map(|(a, b)| a + b).collect();
        let one = following.column(&format!("{column}.panda_finger_joint1"));
        assert!(largest(&one) > 0.5, "{column}");
        assert!(relative_difference(&sum, &one) < 1e-12, "{column}");
    }
    for column in ["pad.length", "pad.force", "energy.kinetic", "energy.potential"] {
        assert!(relative_difference(&prescribed.column(column), &following.column(column)) < 1e-12, "{column}");
    }
    // What is lost in the joints depends on steps, which differ by rounding at most.
    for column in ["energy.joints", "energy.actuators"] {
        assert!(relative_difference(&prescribed.column(column), &following.column(column)) < 1e-9, "{column}");
    }
    for run in [&following, &prescribed] {
        let residual = crate::energy::residual(run, &["pad"]);
        assert!(residual < 1e-8, "{residual:e}");
        crate::energy::power_balance(run, "pad");
    }
}

/// A bar on a pivot, and a bar beside it that turns the other way at half the speed; `dynamics` belongs to the second joint.
fn geared(dynamics: &str, limits: &str) -> tempfile::TempDir {
    let link = |name: &str| {
        format!(
            "<link name=\"{name}\"><inertial><origin xyz=\"0.2 0 0\"/><mass value=\"2\"/>\
             <inertia ixx=\"0.01\" ixy=\"0\" ixz=\"0\" iyy=\"0.03\" iyz=\"0\" izz=\"0.03\"/></inertial></link>"
        )
    };
    let joint = |name: &str, child: &str, y: f64, more: &str| {
        format!(
            "<joint name=\"{name}\" type=\"revolute\"><parent link=\"table\"/><child link=\"{child}\"/>\
             <origin xyz=\"0 {y} 0\"/><axis xyz=\"0 1 0\"/>{more}</joint>"
        )
    };
    let text = format!(
        "<robot name=\"geared\"><link name=\"table\"/>{}{}{}{}</robot>",
        link("first_bar"),
        link("second_bar"),
        joint("first", "first_bar", 0.0, "<dynamics damping=\"0.3\" friction=\"0.2\"/>"),
        joint(
            "second",
            "second_bar",
            0.5,
            &format!("<mimic joint=\"first\" multiplier=\"-0.5\" offset=\"0.1\"/>{dynamics}{limits}")
        ),
    );
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("geared.urdf"), text).unwrap();
    folder
}

fn geared_run(folder: &tempfile::TempDir, robot: &str, first: &str) -> (Run, Vec<PassedLimit>) {
    let urdf = folder.path().join("geared.urdf");
    let text = format!(
        "[robot]\nurdf = '{}'\n{robot}\n[motion]\nkind = \"prescribed\"\njoints = {{ first = \"{first}\" }}\n{}",
        urdf.display(),
        every(3.0, 0.01)
    );
    let cases = cases(&text);
    let system = cases.plan(0).unwrap().system();
    let run = run_case(&cases, 0);
    assert!(run.error.is_none(), "{:?}", run.error);
    let mut watch = LimitWatch::new(&system);
    run.rows.iter().for_each(|row| watch.see(row));
    (run, watch.passed())
}

#[test]
fn damping_and_friction_of_the_file_act_through_the_gear() {
    let folder = geared("<dynamics damping=\"0.8\" friction=\"0.1\"/>", "");
    let (run, passed) = geared_run(&folder, "gravity = [0, 0, 0]", "0.4*sin(3*t)");
    assert_eq!(passed, []);
    // Inertia about each pivot 0.03 + 2·0.2²; the second counts by the square of its ratio.
    let inertia = (0.03 + 2.0 * 0.04) * (1.0 + 0.25);
    let smooth = |v: f64| (v / FRICTION_SPEED).tanh();
    let (v, a, tau) = (run.column("v.first"), run.column("a.first"), run.column("tau.first"));
    for k in 0..v.len() {
        let resistance = |v: f64, damping: f64, friction: f64| damping * v + friction * smooth(v);
        let losses = resistance(v[k], 0.3, 0.2) - 0.5 * resistance(-0.5 * v[k], 0.8, 0.1);
        assert!((tau[k] - (inertia * a[k] + losses)).abs() < 1e-12, "row {k}");
    }
    // ∫ (damping·v² + friction·|v|) dt over both joints, but for the smooth sign; |v| adds up to the path of 0.4 sin 3t.
    let squares = 1.44 * (1.5 + 18f64.sin() / 12.0);
    let path = 0.4 * (1.0 + 2.0 + 2.0 + 1.0 - 9f64.sin());
    let lost = (0.3 + 0.25 * 0.8) * squares + (0.2 + 0.5 * 0.1) * path;
    let shown = *run.column("energy.joints").last().unwrap();
    assert!((shown / lost - 1.0).abs() < 1e-4, "{shown} {lost}");
    let residual = run.report.energy_residual.unwrap() / run.report.energy_turned_over.unwrap();
    assert!(residual < 1e-7, "{residual:e}");
}

#[test]
fn limits_of_joints_are_watched_in_the_rows() {
    // The second joint stands at 0.1 − 0.5·first: from 0.1 − 0.2 to 0.1 + 0.2, at most 0.6 rad/s.
    let limits = "<limit lower=\"-0.05\" upper=\"0.25\" velocity=\"0.5\" effort=\"0.001\"/>";
    let folder = geared("", limits);
    let (run, passed) = geared_run(&folder, "", "0.4*sin(3*t)");
    let kinds: Vec<LimitKind> = passed.iter().map(|passed| passed.kind).collect();
    // A joint that follows has no actuator whose effort could be limited.
    assert_eq!(kinds, [LimitKind::Lower, LimitKind::Upper, LimitKind::Velocity]);
    let follower: Vec<f64> = run.column("q.first").iter().map(|q| 0.1 - 0.5 * q).collect();
    let (t, speed) = (run.t(), run.column("v.first").iter().map(|v| -0.5 * v).collect::<Vec<f64>>());
    for passed in &passed {
        let beyond: Vec<f64> = match passed.kind {
            LimitKind::Lower => follower.iter().map(|q| -0.05 - q).collect(),
            LimitKind::Upper => follower.iter().map(|q| q - 0.25).collect(),
            _ => speed.iter().map(|v| v.abs() - 0.5).collect(),
        };
        let first = beyond.iter().position(|x| *x > 0.0).unwrap();
        let most = beyond.iter().copied().fold(f64::MIN, f64::max);
        assert_eq!((passed.joint.as_str(), passed.first), ("second", t[first]));
        assert!((passed.excess() - most).abs() < 1e-15);
        assert_eq!(beyond[t.iter().position(|t| *t == passed.farthest).unwrap()], most);
    }
    assert_eq!(passed[0].first, 0.29);
    assert_eq!(passed[2].to_string(), "joint \"second\" passes its velocity limit 0.5 rad/s at t = 0 s, by 0.1 rad/s");
    assert!(
        passed[1].to_string().starts_with("joint \"second\" passes its upper limit 0.25 rad at t = 1."),
        "{}",
        passed[1]
    );
    assert!(passed[1].to_string().contains(", by up to 0.04") && passed[1].unit == "rad");

    // Within its limits it is silent, and at a limit too, but for rounding.
    let wide = geared("", "<limit lower=\"-0.1\" upper=\"0.3\" velocity=\"0.6\" effort=\"1\"/>");
    assert_eq!(geared_run(&wide, "", "0.4*sin(3*t)").1, []);
    assert_eq!(geared_run(&wide, "", "-0.4 - 1e-10").1, []);
    assert_eq!(geared_run(&wide, "", "-0.4 - 1e-7").1.len(), 1);
}

#[test]
fn efforts_are_those_of_the_actuators() {
    let cases = shipped("panda_gripper_path.toml", &["robot.gravity=[0, 0, -98.1]"]);
    let plan = cases.plan(0).unwrap();
    let system = plan.system();
    let run = run_case(&cases, 0);
    let mut watch = LimitWatch::new(&system);
    run.rows.iter().for_each(|row| watch.see(row));
    let passed = watch.passed();
    let limits = [("panda_joint2", 87.0), ("panda_joint4", 87.0), ("panda_joint6", 12.0)];
    let found: Vec<(&str, f64)> = passed.iter().map(|passed| (passed.joint.as_str(), passed.limit)).collect();
    assert_eq!(found, limits);
    for passed in &passed {
        assert_eq!((passed.kind, passed.unit), (LimitKind::Effort, "N*m"));
        assert_eq!(passed.value.abs(), largest(&run.column(&format!("tau.{}", passed.joint))));
    }
    // The first row, asked for alone, is the first row of the run, whatever its rows are.
    let settings = plan.settings.clone();
    assert_eq!(system.first_row(&settings).unwrap(), run.rows[0]);
}

#[test]
fn a_gripper_path_leaves_the_fingers_alone() {
    let following = run_case(&shipped("panda_gripper_path.toml", &["time.end=2"]), 0);
    assert!(following.error.is_none(), "{:?}", following.error);
    assert!(largest(&following.column("gripper.error")) < 1e-12);
    let fingers = following.column("q.panda_finger_joint1");
    assert!(fingers.iter().all(|q| (q - 0.02).abs() < 1e-12));
    // The same arm motion where the second finger has a coordinate of its own.
    let set = ["time.end=2", "robot.ignore_mimic=true", "motion.guess.panda_finger_joint2=0.02"];
    let free = run_case(&shipped("panda_gripper_path.toml", &set), 0);
    for joint in ARM {
        for symbol in ["q", "v", "a", "tau"] {
            let columns = [&free, &following].map(|run| run.column(&format!("{symbol}.{joint}")));
            assert!(relative_difference(&columns[0], &columns[1]) < 1e-8, "{symbol}.{joint}");
        }
    }
}

#[test]
fn the_gripper_may_be_on_a_joint_that_follows() {
    // One coordinate moves both fingers: the path of one is the mirrored path of the other.
    let path = "kind = \"gripper-path\"\nx = 0.45\ny = \"0.03 + 0.01*sin(3*t)\"\nz = 0.45\nrpy = [\"180 deg\", 0, 0]\n\
                guess = { panda_joint2 = -0.4, panda_joint4 = -2.2, panda_joint6 = 1.8, panda_joint7 = 0.8, panda_finger_joint1 = 0.02 }";
    let text = panda("", path).replace(
        "body = \"panda_hand_tcp\"\npoint = [0, 0.01, 0]",
        "body = \"panda_rightfinger\"\npoint = [0, 0, 0.045]",
    );
    let run = run(&text);
    assert!(largest(&run.column("gripper.error")) < 1e-10);
    // The least motion uses the finger, which is part of the coordinates.
    assert!(largest(&run.column("v.panda_finger_joint1")) > 1e-3);
    let residual = crate::energy::residual(&run, &["pad"]);
    assert!(residual < 1e-7, "{residual:e}");
}
