//! The reference robots: what the file says against what the reference program made of the same file.

use crate::support::{ARM, FLOATING, arm_with, parse, parse_with};
use serde_json::Value;
use springpot::model::description::{DescriptionOptions, DescriptionWarningKind, FLOATING_BASE, RobotDescription};
use springpot::model::{JointKind, Limits, Model, Parent};
use springpot::spatial::{Placement, Rotation, Vec3};
use std::path::{Path, PathBuf};

/// The reference files and how many joints each has.
const ROBOTS: [(&str, usize); 8] = [
    ("double_pendulum", 2),
    ("ur5", 6),
    ("panda", 9),
    ("panda_mimic", 9),
    ("simple_humanoid", 29),
    ("simple_humanoid_ff", 30),
    ("solo12_ff", 13),
    ("anymal_b_ff", 13),
];

pub(crate) fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata/multibody")
}

fn numbers(value: &Value) -> Vec<f64> {
    match value.as_array() {
        Some(items) => items.iter().flat_map(numbers).collect(),
        None => vec![value.as_f64().expect("a number")],
    }
}

fn close(computed: &[f64], reference: &Value, what: &str) -> usize {
    let reference = numbers(reference);
    let largest = reference.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    assert_eq!(computed.len(), reference.len(), "{what}");
    for (k, (c, r)) in computed.iter().zip(&reference).enumerate() {
        assert!((c - r).abs() <= 1e-12 * largest.max(1e-3), "{what}[{k}]: {c} instead of {r}");
    }
    reference.len()
}

/// The frame of the body on `joint` in the frame of its link, whose z axis is the joint's.
fn body_in_link(model: &Model, joint: usize) -> Placement {
    *model.frame(Parent::Body(model.joint_body(joint))).unwrap().placement()
}

fn inverse(placement: &Placement) -> Placement {
    let rotation = placement.rotation.transpose();
    Placement { rotation, translation: -(rotation * placement.translation) }
}

/// Compares one joint and all that is merged into its link; returns how many numbers were compared.
fn compare(model: &Model, described: &Value, joints: &[Value], robot: &str) -> usize {
    let its_name = |described: &Value| match described["type"].as_str().unwrap() {
        "FF" => FLOATING_BASE.to_owned(),
        _ => described["name"].as_str().unwrap().to_owned(),
    };
    let name = its_name(described);
    let joint = model.joint_index(&name).unwrap_or_else(|| panic!("{robot} has no joint {name}"));
    let parent =
        described["parent"].as_u64().map(|parent| model.joint_index(&its_name(&joints[parent as usize])).unwrap());
    assert_eq!(model.parent_link(joint), parent.map_or(0, |parent| parent + 1), "{robot} {name}");

    let own = body_in_link(model, joint);
    let in_link = *model.joint_placement(joint) * own;
    let in_parent = parent.map_or(in_link, |parent| inverse(&body_in_link(model, parent)) * in_link);
    let what = |field: &str| format!("{robot} {name} {field}");
    let mut count = close(in_parent.rotation.0.as_flattened(), &described["placement_R"], &what("rotation"));
    count += close(&in_parent.translation.0, &described["placement_p"], &what("origin"));
    if model.described_joint(joint).kind.has_axis() {
        count += close(&own.rotation.0[2], &described["axis"], &what("axis"));
    }

    let inertia = model.link_inertia(joint).to_parent(&inverse(&own));
    count += close(&[inertia.mass], &described["mass"], &what("mass"));
    let com = inertia.first_moment.0.map(|x| x / inertia.mass);
    count += close(&com, &described["com"], &what("com"));
    count + close(inertia.about_com().to_matrix().as_flattened(), &described["inertia_com"], &what("inertia"))
}

#[test]
fn reference_robots_have_the_same_joints_and_merged_inertias() {
    let mut compared = 0;
    for (robot, joints) in ROBOTS {
        let text = std::fs::read_to_string(folder().join(format!("{robot}.json"))).unwrap();
        let file: Value = serde_json::from_str(&text).unwrap();
        let options = DescriptionOptions {
            floating_base: file["floating_base"].as_bool().unwrap(),
            ignore_mimic: robot == "panda",
            ..DescriptionOptions::default()
        };
        let path = folder().join(Path::new(file["urdf"].as_str().unwrap()).file_name().unwrap());
        let urdf = RobotDescription::read(&path, &options).unwrap();
        let gravity = numbers(&file["model"]["gravity"]).try_into().unwrap();
        let model = urdf.model(gravity).unwrap_or_else(|error| panic!("{error}"));
        let described = file["model"]["joints"].as_array().unwrap();
        assert_eq!((described.len(), model.joint_count()), (joints, joints), "{robot}");
        assert_eq!(model.nv(), file["model"]["nv"].as_u64().unwrap() as usize, "{robot}");
        compared += described.iter().map(|joint| compare(&model, joint, described, robot)).sum::<usize>();

        let end = &file["model"]["ee"];
        let frame = model.frame(model.find_body(end["frame"].as_str().unwrap()).unwrap()).unwrap();
        let carrier = model.joint_index(described[end["joint"].as_u64().unwrap() as usize]["name"].as_str().unwrap());
        assert_eq!(frame.link(), carrier.unwrap() + 1, "{robot}");
        let in_joint = inverse(&body_in_link(&model, frame.link() - 1)) * *frame.placement();
        compared += close(in_joint.rotation.0.as_flattened(), &end["R"], robot);
        compared += close(&in_joint.translation.0, &end["p"], robot);
    }
    // 28 a joint with an axis, 25 a floating one, 12 an end.
    assert_eq!(compared, 108 * 28 + 3 * 25 + 8 * 12);
}

#[test]
fn the_arm_is_read_word_for_word() {
    let urdf = parse(ARM);
    assert_eq!((urdf.name.as_str(), urdf.root.name.as_str(), urdf.root.line), ("arm", "base", 2));
    assert_eq!(urdf.root.inertial, None);
    assert_eq!(urdf.warnings, []);
    let [upper, lower] = urdf.bodies.as_slice() else { panic!("{:?}", urdf.bodies) };
    assert_eq!((upper.name.as_str(), upper.parent), ("upper", Parent::World));
    assert_eq!((lower.name.as_str(), lower.parent), ("lower", Parent::Body(0)));
    assert_eq!((upper.mass, upper.com), (2.0, [0.0, 0.0, 0.1]));
    assert_eq!(upper.inertia, [[0.3, 0.0, 0.0], [0.0, 0.4, 0.0], [0.0, 0.0, 0.5]]);
    assert_eq!(lower.com, [0.0; 3]);
    let joint = &upper.joint;
    assert_eq!((joint.kind, joint.axis, joint.origin), (JointKind::Revolute, [0.0, 1.0, 0.0], [0.0, 0.0, 0.5]));
    assert_eq!((joint.damping[0], joint.friction[0]), (0.1, 0.2));
    assert_eq!(joint.limits[0], Limits { lower: -1.0, upper: 1.0, velocity: 2.0, effort: 10.0 });
    assert_eq!((lower.joint.kind, lower.joint.damping[0]), (JointKind::Prismatic, 0.0));
    assert_eq!((urdf.root.line, urdf.lines[1].link, urdf.lines[1].joint), (2, 10, 24));
    let model = urdf.model([0.0, 0.0, -9.81]).unwrap();
    assert_eq!(model.find_body("base"), Some(Parent::World));
    assert_eq!(model.joint_names(), ["shoulder", "elbow"]);
}

#[test]
fn inertias_are_turned_to_the_axes_of_the_link() {
    let turned = arm_with(r#"0 0 0.1" rpy="0 0 0"#, r#"0.2 0.3 0.1" rpy="0.4 -0.5 0.6"#);
    let upper = &parse(&turned).bodies[0];
    assert_eq!(upper.com, [0.2, 0.3, 0.1]);
    // The axes of the <origin> are principal ones.
    let r = Rotation::from_rpy([0.4, -0.5, 0.6]);
    for (k, moment) in [0.3, 0.4, 0.5].into_iter().enumerate() {
        let axis = r.column(k);
        let product = Vec3(upper.inertia.map(|row| Vec3(row).dot(axis)));
        for i in 0..3 {
            assert!((product.0[i] - moment * axis.0[i]).abs() < 1e-15);
        }
    }
}

#[test]
fn bodies_come_depth_first_in_the_order_of_the_file() {
    let links: String = "rabcdef".chars().map(|name| format!("<link name=\"{name}\"/>")).collect();
    let joints: String = ["ef", "rb", "be", "ra", "ac", "bd"]
        .map(|ends| {
            let (parent, child) = ends.split_at(1);
            format!(
                "<joint name=\"{ends}\" type=\"fixed\"><parent link=\"{parent}\"/><child link=\"{child}\"/></joint>"
            )
        })
        .concat();
    let text = format!("<robot name=\"tree\">{joints}{links}</robot>");
    let urdf = parse(&text);
    let names: String = urdf.bodies.iter().map(|body| body.name.as_str()).collect();
    assert_eq!(names, "befdac");
    let parents: Vec<Parent> = urdf.bodies.iter().map(|body| body.parent).collect();
    let body = Parent::Body;
    assert_eq!(parents, [Parent::World, body(0), body(1), body(0), Parent::World, body(4)]);
    let floating = parse_with(&text, &FLOATING).unwrap();
    let names: String = floating.bodies.iter().map(|body| body.name.as_str()).collect();
    assert_eq!(names, "rbefdac");
    assert_eq!((floating.bodies[0].joint.name.as_str(), floating.bodies[0].parent), ("floating_base", Parent::World));
    assert_eq!(floating.bodies[0].joint.kind, JointKind::Floating);
    assert_eq!(floating.lines.len(), 7);
}

#[test]
fn a_floating_joint_inside_the_tree_has_six_velocities() {
    let text = arm_with("\"elbow\" type=\"prismatic\"", "\"elbow\" type=\"floating\"")
        .replace("    <axis xyz=\"1 0 0\"/>\n", "")
        .replace("    <limit lower=\"0\" upper=\"0.3\" effort=\"50\" velocity=\"1\"/>\n", "");
    let urdf = parse(&text);
    assert_eq!(urdf.warnings, []);
    assert_eq!(urdf.model([0.0; 3]).unwrap().nv(), 7);
}

#[test]
fn the_root_may_be_called_world() {
    let text = ARM.replace("\"base\"", "\"world\"");
    let model = parse(&text).model([0.0; 3]).unwrap();
    assert_eq!(model.find_body("world"), Some(Parent::World));

    let urdf = parse_with(&text, &FLOATING).unwrap();
    assert_eq!((urdf.bodies[0].name.as_str(), urdf.root.name.as_str()), ("floating_base", "world"));
    let told =
        urdf.warnings.iter().find(|warning| warning.kind == DescriptionWarningKind::Renamed).unwrap().to_string();
    assert!(told.contains("link \"world\" (line 2: called \"floating_base\" here)"), "{told}");
    let inertial =
        r#"<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>"#;
    let heavy = text.replace("<link name=\"world\"/>", &format!("<link name=\"world\">{inertial}</link>"));
    let model = parse_with(&heavy, &FLOATING).unwrap().model([0.0; 3]).unwrap();
    assert_eq!((model.nv(), model.find_body("world")), (8, Some(Parent::World)));
}
