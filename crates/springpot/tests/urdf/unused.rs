//! Elements, attributes and text that are not used: every one is listed.

use crate::support::{arm_and, arm_with, warned};
use springpot::model::description::DescriptionWarningKind::{
    InSimulator, NotUsed, StrayText, UnknownAttribute, UnknownElement,
};
use springpot::model::description::Owner;

#[test]
fn known_elements_without_part_in_the_dynamics_are_one_line() {
    let text = arm_and("<gazebo/><transmission/><gazebo reference=\"a\"><kp>1</kp></gazebo><ros2_control/>")
        .replace("<origin xyz=\"0 0 0.4\"/>", "<safety_controller k_velocity=\"1\"/><calibration rising=\"0\"/>")
        .replace("upper=\"1\"", "upper=\"1\" jerk=\"2\"");
    let message = "not used: 1 jerk of <limit>, 1 <safety_controller>, 1 <calibration>, 2 <gazebo>, 1 <transmission>, \
        1 <ros2_control>";
    let urdf = warned(&text, &[(NotUsed, message)]);
    assert_eq!(urdf.warnings[0].places.len(), 7);
    assert_eq!(urdf.warnings[0].places[1].owner, Owner::Joint("elbow".into()));
}

#[test]
fn shapes_are_not_mentioned() {
    let shape = "<visual name=\"v\"><origin xyz=\"any\"/>\
                 <geometry><box size=\"1 1 1\"/></geometry></visual><collision/><material name=\"m\"/>";
    let text = arm_with("<link name=\"base\"/>", &format!("<link name=\"base\">{shape}{shape}</link>"));
    warned(&text.replace("</robot>", "<material name=\"red\"/></robot>"), &[]);
}

#[test]
fn elements_of_fixed_joints_are_listed() {
    let text = arm_with("type=\"prismatic\"", "type=\"fixed\"")
        .replace("<origin xyz=\"0 0 0.4\"/>", "<mimic joint=\"nobody\"/>");
    let message = "not used: 1 <mimic> of fixed joints, 1 <axis> of fixed joints, 1 <limit> of fixed joints";
    let urdf = warned(&text, &[(NotUsed, message)]);
    assert_eq!(urdf.bodies[1].joint.mimic, None);
}

#[test]
fn unknown_elements_and_attributes_name_their_owner() {
    let text = arm_with("<mass value=\"2\"/>", "<mass value=\"2\" unit=\"kg\"/><density/>")
        .replace("<child link=\"lower\"/>", "<child link=\"lower\"><frame/></child>")
        .replace("</robot>", "<lights/>\n<lights/></robot>");
    let elements = "not known, not used: <density> of link \"upper\" (line 6), <frame> of joint \"elbow\" (line 27), 2 \
        <lights> (from line 31)";
    let attributes = "not known, not used: unit of <mass> of link \"upper\" (line 6)";
    warned(&text, &[(UnknownElement, elements), (UnknownAttribute, attributes)]);
    let foreign = arm_and("<other:joint xmlns:other=\"http://example.org\" name=\"x\"/>");
    warned(&foreign, &[(UnknownElement, "not known, not used: <other:joint> (line 31)")]);
    let misspelt = arm_with("<dynamics damping=\"0.1\"", "<dynamics dampping=\"0.1\"");
    let message = "not known, not used: dampping of <dynamics> of joint \"shoulder\" (line 22)";
    let urdf = warned(&misspelt, &[(UnknownAttribute, message)]);
    assert_eq!(urdf.bodies[0].joint.damping[0], 0.0);
}

#[test]
fn text_between_elements_is_listed() {
    let text = arm_with("<link name=\"base\"/>", "<link name=\"base\">s</link>")
        .replace("<mass value=\"1\"/>", "<mass value=\"1\">kg</mass>");
    let message =
        "text between elements, not used: in <link> of link \"base\" (line 2), in <mass> of link \"lower\" (line 12)";
    warned(&text, &[(StrayText, message)]);
}

#[test]
fn what_changes_the_motion_in_a_simulator_is_named() {
    let text = arm_and(
        "<gazebo reference=\"upper\"><turnGravityOff>true</turnGravityOff></gazebo>
         <gazebo><joint name=\"loop\" type=\"revolute\"><parent>upper</parent><child>lower</child></joint></gazebo>
         <gazebo reference=\"elbow\"><springStiffness>5</springStiffness><turnGravityOff>false</turnGravityOff></gazebo>
         <gazebo><plugin><joint>elbow</joint></plugin></gazebo>",
    );
    let message = "not used, though it changes the motion in the simulator: \
                   <turnGravityOff> (line 31), <joint> (line 32), <springStiffness> (line 33)";
    warned(&text, &[(InSimulator, message), (NotUsed, "not used: 4 <gazebo>")]);
}
