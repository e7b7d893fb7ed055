//! Links that are refused, each with its line.

use crate::support::{arm_and, arm_with, parse, refused};
use springpot::model::ModelError;
use springpot::model::description::DescriptionProblem;

const MASS: &str = r#"<mass value="2"/>"#;
const INERTIA: &str = r#"<inertia ixx="0.3" ixy="0" ixz="0" iyy="0.4" iyz="0" izz="0.5"/>"#;

#[test]
fn names() {
    refused(&arm_and("<link/>"), "line 31, column 1: <link> has no name");
    refused(&arm_and("<link name=\" \"/>"), "line 31, column 1: the name of this <link> is empty");
    let message = "line 31, column 1: there are two of link \"upper\", the first in line 3; names must be unique";
    refused(&arm_and("<link name=\"upper\"/>"), message);
    let message = "line 2, column 3: a link is called \"world\", which is the inertial frame; only the root link can \
        have that name: rename it";
    let text = arm_with("<link name=\"base\"/>", "<link name=\"world\"/><link name=\"base\"/>");
    let joint = "<joint name=\"on\" type=\"fixed\"><parent link=\"lower\"/><child link=\"world\"/></joint></robot>";
    refused(&text.replace("</robot>", joint), message);
}

#[test]
fn elements_that_are_missing_or_stand_twice() {
    refused(&arm_with(MASS, ""), "line 4, column 5: link \"upper\" has no <mass>");
    refused(&arm_with(INERTIA, ""), "line 4, column 5: link \"upper\" has no <inertia>");
    let twice = arm_with("<link name=\"base\"/>", "<link name=\"base\">\n<inertial/>\n<inertial/></link>");
    refused(&twice, "line 4, column 1: link \"base\" has two <inertial>, the first in line 3; one is allowed");
    let twice = arm_with(MASS, &format!("{MASS}\n {MASS}"));
    refused(&twice, "line 7, column 2: link \"upper\" has two <mass>, the first in line 6; one is allowed");
}

#[test]
fn attributes_that_are_missing() {
    refused(&arm_with(MASS, "<mass>2</mass>"), "line 6, column 7: <mass> of link \"upper\" has no value");
    for name in ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"] {
        let text = arm_with(INERTIA, &INERTIA.replace(name, "i"));
        refused(&text, &format!("line 7, column 7: <inertia> of link \"upper\" has no {name}"));
    }
}

#[test]
fn texts_that_are_no_numbers() {
    let not = |text: &str, shown: &str| {
        let message =
            format!("line 6, column 20: value of <mass> of link \"upper\" holds {shown:?}, which is not a number");
        refused(&arm_with(MASS, &format!("<mass value=\"{text}\"/>")), &message);
    };
    not("x", "x");
    not("2kg", "2kg");
    not("0x10", "0x10");
    not("1_000", "1_000");
    not("--1", "--1");
    not(&"9x".repeat(100), &format!("{}…", "9x".repeat(20)));
    let comma = "line 5, column 20: xyz of <origin> of link \"upper\" holds \"0,0,0.1\", which is not a number; \
                 numbers are separated by blanks and have a decimal point";
    refused(&arm_with("0 0 0.1\" rpy", "0,0,0.1\" rpy"), comma);
    // The word in the middle is not skipped.
    let message = "line 5, column 20: xyz of <origin> of link \"upper\" holds \"x\", which is not a number";
    refused(&arm_with("0 0 0.1\" rpy", "0 x 0 0.1\" rpy"), message);
}

#[test]
fn numbers_that_are_not_finite() {
    for text in ["nan", "NaN", "inf", "-inf", "infinity", "1e400"] {
        let message =
            format!("line 6, column 20: value of <mass> of link \"upper\" holds {text:?}; it must be a finite number");
        refused(&arm_with(MASS, &format!("<mass value=\"{text}\"/>")), &message);
    }
}

#[test]
fn too_many_and_too_few_numbers() {
    let counts = [("", "0 numbers"), ("1", "1 number"), ("1 2", "2 numbers"), ("1 2 3 4", "4 numbers")];
    for (text, given) in counts {
        let message = format!("line 5, column 20: xyz of <origin> of link \"upper\" has {given}; it needs 3");
        refused(&arm_with("0 0 0.1\" rpy", &format!("{text}\" rpy")), &message);
    }
    let message = "line 6, column 20: value of <mass> of link \"upper\" has 2 numbers; it needs 1";
    refused(&arm_with(MASS, "<mass value=\"2 3\"/>"), message);
}

#[test]
fn numbers_may_be_written_in_many_ways() {
    let text = arm_with("0 0 0.1\" rpy", " 1. \t.5\n +2.5E-1 \" rpy");
    assert_eq!(parse(&text).bodies[0].com, [1.0, 0.5, 0.25]);
}

#[test]
fn masses_and_inertias_that_no_body_has() {
    let message = "line 6, column 7: value of <mass> of link \"upper\" is -2; it must be 0 or more";
    refused(&arm_with(MASS, "<mass value=\"-2\"/>"), message);
    let negative = arm_with(INERTIA, &INERTIA.replace("0.3", "-0.3"));
    let moments = "the <inertia> of link \"upper\" has the principal moment";
    refused(&negative, &format!("line 7, column 7: {moments} -0.3 kg*m^2; all three must be 0 or more"));
    let off_diagonal = arm_with(INERTIA, &INERTIA.replace("ixy=\"0\"", "ixy=\"1\""));
    refused(&off_diagonal, &format!("line 7, column 7: {moments} -0.6512 kg*m^2; all three must be 0 or more"));
    // The limit is 1e-12 of the largest moment.
    let just = |ixx: &str| {
        arm_with(INERTIA, &format!("<inertia ixx=\"{ixx}\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/>"))
    };
    assert_eq!(parse(&just("-0.9e-12")).bodies[0].inertia[0][0], -0.9e-12);
    refused(&just("-1.1e-12"), &format!("line 7, column 7: {moments} -1.1e-12 kg*m^2; all three must be 0 or more"));
}

#[test]
fn the_quaternion_of_later_versions_is_refused() {
    let text = arm_with("rpy=\"0 0 0\"/>\n      <mass", "quat_xyzw=\"0 0 0 1\"/>\n      <mass");
    let message = "line 5, column 7: quat_xyzw of <origin> of link \"upper\" changes the motion of the robot and is \
        not supported";
    refused(&text, message);
}

#[test]
fn what_only_the_whole_robot_shows_has_the_line_of_the_link() {
    // Without inertia about its axis, the last joint could turn freely.
    let massless = arm_with("<mass value=\"1\"/>", "<mass value=\"0\"/>")
        .replace("0.1\" i", "0\" i")
        .replace("izz=\"0.1\"", "izz=\"0\"");
    let error = parse(&massless).model([0.0; 3]).expect_err("singular");
    let DescriptionProblem::Model { source } = &*error.problem else { panic!("{error}") };
    assert!(matches!(source, ModelError::SingularMassMatrix { joint, .. } if joint == "elbow"), "{source}");
    assert_eq!(error.line(), Some(10));
    assert!(error.to_string().contains(&source.to_string()));

    let lonely = parse("<robot name=\"r\">\n<link name=\"rock\"/></robot>").model([0.0; 3]).expect_err("nothing moves");
    let message = "line 2, column 1: the robot is the single link \"rock\", which is the world on a fixed base; with \
        floating_base it can move";
    assert_eq!(lonely.to_string(), message);
}
