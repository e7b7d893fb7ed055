//! Joints of `[[robot.body]]` and how they are prescribed: continuous and floating ones.

use crate::support::{assert_all_refused, cases, catalog, edited, pose};
use serde_json::json;
use springpot::model::JointKind;
use springpot::motion::PosePath;
use springpot_scenario::RefusalKind::*;
use springpot_scenario::Scenario;
use std::fmt::Write as _;

/// A boat that floats with a wheel on it.
const BOAT: &str = r#"
[[robot.body]]
name = "boat"
joint = { name = "sea", kind = "floating", origin = [1, 0, 0], rpy = [0, 0, "90 deg"] }
mass = 10
inertia = { xx = 1, yy = 2, zz = 2.5 }

[[robot.body]]
name = "wheel"
joint = { name = "axle", kind = "continuous", axis = [0, 2, 0], damping = "0.1 N*m*s/rad", friction = 0.2 }
mass = 1
inertia = { xx = 0.01, yy = 0.02, zz = 0.01 }

[motion]
kind = "prescribed"
joints = { sea = { x = "2*t", z = "10 cm", rpy = ["0.1*sin(t)", 0, "30 deg"] }, axle = "20*t" }

[time]
end = 1
output_step = 0.1
"#;

#[test]
fn continuous_and_floating_joints_are_planned() {
    let plan = cases(BOAT).unwrap().plan(0).unwrap();
    assert_eq!([0, 1].map(|j| plan.model.described_joint(j).kind), [JointKind::Floating, JointKind::Continuous]);
    assert_eq!((plan.model.damping()[1], plan.model.friction()[1]), (0.1, 0.2));
    let pose = pose(&plan);
    assert_eq!(pose.position.each_ref().map(|signal| signal.value(0.5)), [1.0, 0.0, 0.1]);
    assert!((pose.rpy[2].is_constant().unwrap() - 30f64.to_radians()).abs() < 1e-15);
    let written = &plan.resolved()["motion"]["joints"]["sea"];
    assert_eq!(["x", "y", "z"].map(|axis| &written[axis]), [&json!("2*t"), &json!(0.0), &json!(0.1)]);
    assert_eq!(written["rpy"][0], "0.1*sin(t)");

    let columns: Vec<(String, String)> = plan.system().columns().into_iter().map(|c| (c.name, c.unit)).collect();
    let mut expected = vec![("t".to_owned(), "s".to_owned())];
    let mut add = |symbol: &str, parts: &[&str], units: &[&str], own: &str| {
        let sea = parts.iter().zip(units).map(|(part, unit)| (format!("{symbol}.sea.{part}"), (*unit).to_owned()));
        expected.extend(sea);
        expected.push((format!("{symbol}.axle"), own.to_owned()));
    };
    let velocities = ["vx", "vy", "vz", "wx", "wy", "wz"];
    add("q", &["x", "y", "z", "qx", "qy", "qz", "qw"], &["m", "m", "m", "1", "1", "1", "1"], "rad");
    add("v", &velocities, &["m/s", "m/s", "m/s", "rad/s", "rad/s", "rad/s"], "rad/s");
    add("a", &velocities, &["m/s^2", "m/s^2", "m/s^2", "rad/s^2", "rad/s^2", "rad/s^2"], "rad/s^2");
    add("tau", &velocities, &["N", "N", "N", "N*m", "N*m", "N*m"], "N*m");
    assert_eq!(columns[..expected.len()], expected);
}

#[test]
fn what_is_left_out_of_a_pose_is_zero() {
    let rests = edited(BOAT, &[("{ x = \"2*t\", z = \"10 cm\", rpy = [\"0.1*sin(t)\", 0, \"30 deg\"] }", "{}")]);
    let PosePath { position, rpy } = pose(&cases(&rests).unwrap().plan(0).unwrap());
    assert!(position.iter().chain(&rpy).all(|signal| signal.is_constant() == Some(0.0) && signal.value(0.5) == 0.0));
}

#[test]
fn parts_of_a_pose_have_paths() {
    let sweep = "[[sweep]]\nparameter = \"motion.joints.sea.y\"\nvalues = [\"5 cm\", \"0.2*t\"]\n\
                 [[sweep]]\nparameter = \"motion.joints.sea.rpy\"\nvalues = [[0, 0, 0], [0, \"0.1*t\", 0]]\n";
    let cases = cases(&format!("{BOAT}{sweep}")).unwrap();
    let state = |case: usize| cases.plan(case).unwrap().system().state(1.0).unwrap();
    assert_eq!([0, 1, 2, 3].map(|case| state(case).q[1]), [0.05, 0.05, 0.2, 0.2]);
    assert_eq!([0, 1].map(|case| state(case).v[4]), [0.0, 0.1]);
    let mut scenario = Scenario::parse(BOAT, "boat.toml", "").unwrap();
    scenario.set("motion.joints.sea.z=-3").unwrap();
    assert_eq!(scenario.cases(&catalog()).unwrap().plan(0).unwrap().system().state(0.0).unwrap().q[2], -3.0);
}

#[test]
fn poses_come_from_csv_files_too() {
    let folder = tempfile::tempdir().unwrap();
    let header = "t,axle,sea.x,sea.y,sea.z,sea.roll,sea.pitch,sea.yaw\n";
    let mut samples = header.to_owned();
    for k in 0..=40 {
        let t = 0.025 * f64::from(k);
        let _ = writeln!(samples, "{t},{},{},{},{},{},{},{}", 20.0 * t, 2.0 * t, 0.0, 0.1, 0.1 * t * t, 0.0, 0.5);
    }
    std::fs::write(folder.path().join("all.csv"), &samples).unwrap();
    std::fs::write(folder.path().join("some.csv"), samples.replace("sea.pitch", "pitch")).unwrap();
    let start = BOAT.find("joints = ").unwrap();
    let end = BOAT.find("\n\n[time]").unwrap();
    let with = |file: &str| {
        let text = format!("{}csv = \"{file}\"{}", &BOAT[..start], &BOAT[end..]);
        Scenario::parse(&text, "boat.toml", folder.path()).unwrap().cases(&catalog())
    };
    let expected = edited(BOAT, &[("[\"0.1*sin(t)\", 0, \"30 deg\"]", "[\"0.1*t^2\", 0, 0.5]")]);
    let state = |cases: springpot_scenario::Cases| cases.plan(0).unwrap().system().state(0.7).unwrap();
    let (read, written) = (state(with("all.csv").unwrap()), state(cases(&expected).unwrap()));
    for (read, written) in [(read.q, written.q), (read.v, written.v), (read.a, written.a)] {
        assert!(read.iter().zip(&written).all(|(a, b)| (a - b).abs() < 1e-10), "{read:?} {written:?}");
    }
    let refusals = with("some.csv").map(|cases| cases.len()).unwrap_err().to_string();
    assert!(refusals.contains("`csv` of [motion] leaves out the columns sea.pitch"), "{refusals}");
}

#[test]
fn joints_are_refused_where_they_are_wrong() {
    let sea = "kind = \"floating\", origin";
    let axle = "kind = \"continuous\", axis = [0, 2, 0]";
    let floats = "sea = { x = \"2*t\", z = \"10 cm\", rpy = [\"0.1*sin(t)\", 0, \"30 deg\"] }";
    let prescribed = &BOAT[BOAT.find("kind = \"prescribed\"").unwrap()..BOAT.find("\n\n[time]").unwrap()];
    let free = "a floating joint moves freely in all six directions";
    assert_all_refused(
        BOAT,
        &[
            (
                &[(sea, "kind = \"floating\", ‸axis = [0, 0, 1], origin")],
                Rule,
                &format!("`axis` of the joint of body \"boat\" has no meaning: {free}"),
            ),
            (&[(sea, "kind = \"floating\", ‸damping = 1, origin")], Rule, free),
            (&[(sea, "kind = \"floating\", ‸friction = 1, origin")], Rule, free),
            (&[(axle, "kind = \"fixed\", ‸axis = [0, 2, 0]")], Rule, "has no meaning: a fixed joint does not move"),
            (
                &[("joint = { name = \"axle\"", "joint = ‸{ name = \"axle\""), (", axis = [0, 2, 0]", "")],
                Missing,
                "has no `axis`",
            ),
            (&[(axle, "kind = ‸\"continous\", axis = [0, 2, 0]")], UnknownName, "did you mean `continuous`?"),
            (
                &[(sea, "kind = ‸\"gimbal\", origin")],
                UnknownName,
                "there is fixed, revolute, continuous, prismatic, helical, cylindrical, universal, planar, spherical and floating",
            ),
            (&[("0.1 N*m*s/rad", "0.1 ‸N*s/m")], BadQuantity, "this place takes `N*m*s/rad`"),
            (
                &[(floats, "sea = ‸0")],
                WrongType,
                "`sea` of `joints` of [motion] must be a table { x = …, y = …, z = …, rpy = [roll, pitch, yaw] }, since the joint is floating",
            ),
            (&[(floats, "sea = ‸\"0.1*t\"")], WrongType, "since the joint is floating, not the text \"0.1*t\""),
            (&[(floats, "sea = { ‸yaw = 0 }")], UnknownKey, "unknown key `yaw`"),
            (&[(floats, "sea = { rpy = ‸[0, 0] }")], WrongType, "an array of three signals: roll, pitch, yaw"),
            (&[(floats, "sea = { rpy = [0, 0, \"1 ‸m\"] }")], BadQuantity, "this place takes `rad`"),
            (&[(floats, "sea = { x = \"1 ‸rad\" }")], BadQuantity, "this place takes `m`"),
            (&[(floats, "sea = { x = ‸\"1/t\" }")], OutOfRange, "is not finite at t = 0 s"),
            (&[("axle = \"20*t\"", "axle = { ‸x = 0 }")], UnknownKey, "unknown key `x`"),
            (&[("joints = {", "joints = ‸{"), (&format!("{floats}, "), "")], Missing, "leaves out the joints sea"),
            (
                &[
                    (prescribed, "kind = ‸\"gripper-path\"\nx = 0\ny = 0\nz = 0"),
                    ("[motion]", "[robot.gripper]\nbody = \"wheel\"\npoint = [0, 0, 0]\n[motion]"),
                ],
                Rule,
                "moves joints of one degree, but joint \"sea\" is floating\n  help: write kind = \"prescribed\", or a joint of another kind",
            ),
        ],
    );
}

#[test]
fn the_floating_base_of_a_urdf_takes_no_gripper_path() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../testdata/multibody");
    let text = "[robot]\nurdf = \"panda.urdf\"\nfloating_base = true\n[robot.gripper]\nbody = \"panda_hand\"\npoint = [0, 0, 0]\n\
                [motion]\nkind = \"gripper-path\"\nx = 0.4\ny = 0\nz = 0.4\n[time]\nend = 1\noutput_step = 1\n";
    let refusals = Scenario::parse(text, "a.toml", folder).unwrap().cases(&catalog()).map(|_| ()).unwrap_err();
    assert_eq!(refusals.len(), 1);
    let shown = refusals.to_string();
    assert!(shown.starts_with("a.toml:8:8: kind = \"gripper-path\" moves joints of one degree"), "{shown}");
    assert!(shown.ends_with("help: leave floating_base out, or write kind = \"prescribed\""), "{shown}");
}

#[test]
fn damping_may_be_swept_from_zero() {
    let sweep = "[[sweep]]\nparameter = \"robot.body.wheel.joint.damping\"\nvalues = [0, 0.1]\n";
    let still = edited(BOAT, &[("damping = \"0.1 N*m*s/rad\", friction = 0.2", "damping = 0")]);
    let cases = cases(&format!("{still}{sweep}")).unwrap();
    let columns = [0, 1].map(|case| cases.plan(case).unwrap().system().columns());
    assert_eq!(columns[0], columns[1]);
    assert_eq!(columns[0].iter().filter(|column| column.name == "energy.joints").count(), 1);
    let alone = crate::support::cases(&still).unwrap().plan(0).unwrap().system().columns();
    assert!(alone.iter().all(|column| column.name != "energy.joints"));
}
