//! Joints that are refused, each with its line.

use crate::support::{ARM, FLOATING, arm_and, arm_with, parse, parse_with, refused, refused_with};
use springpot::model::Mimic;
use springpot::model::description::DescriptionOptions;

const AXIS: &str = r#"<axis xyz="1 0 0"/>"#;

/// The arm with more in its elbow, which has line 25 then.
fn elbow_with(more: &str) -> String {
    arm_with("<origin xyz=\"0 0 0.4\"/>", &format!("{more}<origin xyz=\"0 0 0.4\"/>"))
}

#[test]
fn names_and_types() {
    refused(&arm_and("<joint/>"), "line 31, column 1: <joint> has no name");
    refused(&arm_and("<joint name=\"\"/>"), "line 31, column 1: the name of this <joint> is empty");
    refused(&arm_and("<joint name=\"a\"/>"), "line 31, column 1: <joint> of joint \"a\" has no type");
    let joint = ARM[ARM.find("<joint name=\"elbow\"").unwrap()..].replace("</robot>\n", "");
    let message = "line 31, column 1: there are two of joint \"elbow\", the first in line 24; names must be unique";
    refused(&arm_and(&joint), message);
    let types = "fixed, revolute, continuous, prismatic, planar, spherical, floating";
    let message = "line 24, column 3: joint \"elbow\" has the unknown type \"Prismatic\"; did you mean \"prismatic\"?; \
        the types are";
    refused(&arm_with("type=\"prismatic\"", "type=\"Prismatic\""), &format!("{message} {types}"));
    let message = "line 24, column 3: joint \"elbow\" has the unknown type \"\"; the types are";
    refused(&arm_with("type=\"prismatic\"", "type=\"\""), &format!("{message} {types}"));
    for kind in ["helical", "cylindrical", "universal"] {
        let text = arm_with("type=\"prismatic\"", &format!("type=\"{kind}\""));
        let message =
            format!("line 24, column 3: joint \"elbow\" is {kind}, which is not supported yet; supported are {types}");
        refused(&text, &message);
    }
}

#[test]
fn elements_that_are_missing_or_stand_twice() {
    let missing = |element: &str, name: &str| {
        refused(&arm_with(element, ""), &format!("line 24, column 3: joint \"elbow\" has no <{name}>"));
    };
    missing("<parent link=\"upper\"/>", "parent");
    missing("<child link=\"lower\"/>", "child");
    let message = "line 26, column 5: <parent> of joint \"elbow\" has no link";
    refused(&arm_with("<parent link=\"upper\"/>", "<parent name=\"upper\"/>"), message);
    for element in ["origin", "parent", "child", "axis", "limit", "dynamics", "mimic"] {
        let text = elbow_with(&format!("<{element} link=\"upper\" joint=\"shoulder\"/><{element}/>"));
        let error = parse_with(&text, &DescriptionOptions::default()).expect_err("twice");
        let message = format!("joint \"elbow\" has two <{element}>, the first in line 25; one is allowed");
        assert!(error.to_string().ends_with(&message), "{error}");
    }
}

#[test]
fn numbers() {
    let message = "line 28, column 16: xyz of <axis> of joint \"elbow\" has 2 numbers; it needs 3";
    refused(&arm_with(AXIS, "<axis xyz=\"1 0\"/>"), message);
    let message = "line 25, column 18: xyz of <origin> of joint \"elbow\" holds \"nan\"; it must be a finite number";
    refused(&arm_with("0 0 0.4", "0 0 nan"), message);
    let message = "line 29, column 19: lower of <limit> of joint \"elbow\" holds \"nan\"; it must be a finite number";
    refused(&arm_with("lower=\"0\"", "lower=\"nan\""), message);
    let message = "line 25, column 24: damping of <dynamics> of joint \"elbow\" holds \"much\", which is not a number";
    refused(&elbow_with("<dynamics damping=\"much\"/>"), message);
    let message = "line 25, column 37: offset of <mimic> of joint \"elbow\" holds \"inf\"; it must be a finite number";
    refused(&elbow_with("<mimic joint=\"shoulder\" offset=\"inf\"/>"), message);
}

#[test]
fn numbers_that_make_no_sense() {
    let message =
        "line 28, column 5: the <axis> of joint \"elbow\" is 0 0 0; it must point somewhere, as in xyz=\"0 0 1\"";
    refused(&arm_with(AXIS, "<axis xyz=\"0 0 0\"/>"), message);
    for name in ["damping", "friction"] {
        let text = elbow_with(&format!("<dynamics {name}=\"-0.5\"/>"));
        let message =
            format!("line 25, column 5: {name} of <dynamics> of joint \"elbow\" is -0.5; it must be 0 or more");
        refused(&text, &message);
    }
    // A fixed joint has no axis to point anywhere.
    parse(&arm_with(AXIS, "<axis xyz=\"0 0 0\"/>").replace("\"prismatic\"", "\"fixed\""));
}

#[test]
fn the_name_of_the_floating_joint_is_reserved() {
    let text = ARM.replace("\"elbow\"", "\"floating_base\"");
    let message = "line 24, column 3: a joint is called \"floating_base\", the name of the joint that lets the base \
        float; rename it";
    refused_with(&text, &FLOATING, message);
    assert_eq!(parse(&text).bodies[1].joint.name, "floating_base");
}

#[test]
fn mimic_joints_follow_joints_of_one_degree() {
    let message =
        "line 25, column 5: joint \"elbow\" mimics joint \"sholder\", which does not exist; did you mean \"shoulder\"?";
    refused(&elbow_with("<mimic joint=\"sholder\"/>"), message);
    let message = "line 25, column 5: joint \"elbow\" mimics joint \"left\", which does not exist; with ignore_mimic \
        it has its own coordinate";
    refused(&elbow_with("<mimic joint=\"left\"/>"), message);
    refused(&elbow_with("<mimic/>"), "line 25, column 5: <mimic> of joint \"elbow\" has no joint");
    let message = "line 25, column 5: joint \"elbow\" mimics itself, in a circle; one of them must be free";
    refused(&elbow_with("<mimic joint=\"elbow\"/>"), message);
    for kind in ["fixed", "floating"] {
        let text = elbow_with("<mimic joint=\"shoulder\"/>").replace("\"revolute\"", &format!("\"{kind}\""));
        let message = format!(
            "line 25, column 5: joint \"elbow\" mimics joint \"shoulder\", but joint \"shoulder\" is {kind}; only \
                joints of one degree can"
        );
        refused(&text, &message);
    }
}

/// A joint that turns freely, or shifts in a plane, follows none.
#[test]
fn joints_of_several_degrees_follow_none() {
    for (written, kind) in [("ball", "spherical"), ("planar", "planar")] {
        let text = elbow_with("<mimic joint=\"shoulder\"/>");
        let text = text.replace("type=\"prismatic\"", &format!("type=\"{written}\""));
        let message = format!(
            "line 25, column 5: joint \"elbow\" mimics joint \"shoulder\", but joint \"elbow\" is {kind}; only \
                joints of one degree can"
        );
        refused(&text, &message);
    }
}

/// A chain of three revolute joints a, b, c, of which each follows the one that is named, if one is.
fn chain(followed: [&str; 3]) -> String {
    let mut text = String::from("<robot name=\"chain\">\n<link name=\"0\"/>\n");
    for (k, (name, followed)) in ["a", "b", "c"].into_iter().zip(followed).enumerate() {
        let mimic = if followed.is_empty() {
            String::new()
        } else {
            format!("<mimic joint=\"{followed}\" multiplier=\"2\" offset=\"0.5\"/>")
        };
        let inertia = "<inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/>";
        text += &format!("<link name=\"{}\"><inertial><mass value=\"1\"/>{inertia}</inertial></link>\n", k + 1);
        text += &format!(
            "<joint name=\"{name}\" type=\"continuous\"><parent link=\"{k}\"/><child link=\"{}\"/>{mimic}\
             <axis xyz=\"0 0 1\"/></joint>\n",
            k + 1
        );
    }
    text + "</robot>"
}

#[test]
fn mimic_joints_do_not_follow_one_another_in_a_circle() {
    let message = "the joints \"a\" and \"b\" mimic one another in a circle; one of them must be free";
    let text = chain(["b", "a", ""]);
    let column = text.lines().nth(3).unwrap().find("<mimic").unwrap() + 1;
    refused(&text, &format!("line 4, column {column}: {message}"));
    let error = parse_with(&chain(["b", "c", "a"]), &DescriptionOptions::default()).expect_err("a circle");
    assert!(error.to_string().contains("the joints \"a\", \"b\" and \"c\" mimic one another"), "{error}");
    let error = parse_with(&chain(["b", "c", "b"]), &DescriptionOptions::default()).expect_err("a circle");
    assert!(error.to_string().contains("the joints \"b\" and \"c\" mimic one another"), "{error}");
}

#[test]
fn mimic_joints_may_follow_mimic_joints() {
    let urdf = parse(&chain(["c", "a", ""]));
    let follows = |joint: &str| Some(Mimic { joint: joint.into(), multiplier: 2.0, offset: 0.5 });
    let found: Vec<_> = urdf.bodies.iter().map(|body| body.joint.mimic.clone()).collect();
    assert_eq!(found, [follows("c"), follows("a"), None]);
    let model = urdf.model([0.0; 3]).unwrap();
    assert_eq!((model.nv(), model.followed(1)), (1, Some((2, 4.0, 1.5))));
    let plain = parse(&elbow_with("<mimic joint=\"shoulder\"/>"));
    let expected = Mimic { joint: "shoulder".into(), multiplier: 1.0, offset: 0.0 };
    assert_eq!(plain.bodies[1].joint.mimic, Some(expected));
}
