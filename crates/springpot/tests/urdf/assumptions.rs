//! What is assumed, and what is odd about numbers: warnings that name the link or joint.

use crate::support::{ARM, FLOATING, arm_and, arm_with, parse, parse_with, warned, warned_with};
use springpot::model::description::DescriptionWarningKind::{
    AxisLength, IncompleteLimit, MimicIgnored, NoAxis, NoInertial, NoLimit, NoName, NotPositive, NotUsed,
    OfFloatingJoint, PointMass, Renamed, SenselessLimit, TriangleInequality, ZeroMass,
};
use springpot::model::description::{DescriptionOptions, DescriptionPlace, Owner};
use springpot::model::{JointKind, Limits};

const LIMIT: &str = r#"<limit lower="0" upper="0.3" effort="50" velocity="1"/>"#;
const INERTIA: &str = r#"<inertia ixx="0.3" ixy="0" ixz="0" iyy="0.4" iyz="0" izz="0.5"/>"#;

/// A link with this tensor on a fixed joint on `parent`; its `<inertial>` is in line 31.
fn fixed_link(parent: &str, ixx: &str) -> String {
    let inertia = format!("<inertia ixx=\"{ixx}\" ixy=\"0\" ixz=\"0\" iyy=\"0.1\" iyz=\"0\" izz=\"0.1\"/>");
    let link = format!("<link name=\"odd\"><inertial><mass value=\"1\"/>{inertia}</inertial></link>");
    arm_and(&format!(
        "{link}<joint name=\"on\" type=\"fixed\"><parent link=\"{parent}\"/><child link=\"odd\"/></joint>"
    ))
}

#[test]
fn massless_links_on_moving_joints() {
    let inertial = &ARM[ARM.find("    <inertial>").unwrap()..ARM.find("  </link>").unwrap()];
    let text = arm_with(inertial, "");
    warned(&text, &[(NoInertial, "moving links without <inertial>, taken as massless: link \"upper\" (line 3)")]);
    let text = arm_with("<mass value=\"1\"/>", "<mass value=\"0\"/>");
    warned(&text, &[(ZeroMass, "moving links of mass 0: link \"lower\" (line 11)")]);
    // The root of a fixed base and links on fixed joints are frames.
    let frames = arm_and(
        "<link name=\"tool\"/><joint name=\"f\" type=\"fixed\"><parent link=\"lower\"/><child link=\"tool\"/></joint>",
    );
    warned(&frames, &[]);
    let message = "moving links without <inertial>, taken as massless: link \"base\" (line 2)";
    warned_with(&frames, &FLOATING, &[(NoInertial, message)]);
}

#[test]
fn inertias_that_no_distribution_of_mass_has() {
    let text = arm_with(INERTIA, &INERTIA.replace("0.5", "0.8"));
    let message = "<inertia> that no distribution of mass has: \
                   link \"upper\" (line 4: moment 0.8 above the sum 0.7 of the other two)";
    let urdf = warned(&text, &[(TriangleInequality, message)]);
    assert_eq!(urdf.bodies[0].inertia[2][2], 0.8);
    // Within 1e-9 of itself it is rounding.
    warned(&arm_with(INERTIA, &INERTIA.replace("0.5", "0.7000000005")), &[]);
    // What is fixed to the world has no part in the dynamics; what is fixed to a moving link has.
    warned(&fixed_link("base", "0.3"), &[]);
    let message = "<inertia> that no distribution of mass has: link \"odd\" (line 31: moment 0.3 above the sum 0.2 of \
        the other two)";
    let urdf = warned(&fixed_link("lower", "0.3"), &[(TriangleInequality, message)]);
    // Together with the link that carries it, it is a body.
    assert!(urdf.model([0.0; 3]).is_ok());
}

#[test]
fn negative_moments_on_fixed_joints() {
    let lead = "<inertia> with a negative principal moment: link \"odd\"";
    let message = format!("{lead} (line 31: -0.01 kg*m^2, fixed to the world)");
    let urdf = warned(&fixed_link("base", "-0.01"), &[(NotPositive, &message)]);
    assert_eq!(urdf.bodies[2].inertia[0][0], -0.01);
    assert!(urdf.model([0.0; 3]).is_ok());
    warned(&fixed_link("lower", "-0.01"), &[(NotPositive, &format!("{lead} (line 31: -0.01 kg*m^2)"))]);
}

#[test]
fn inertias_that_are_accepted() {
    let accepting = DescriptionOptions { accept_inertia: true, ..DescriptionOptions::default() };
    // Without being accepted it is listed too, and no robot can be made of it.
    let text = arm_with(INERTIA, &INERTIA.replace("0.5", "0.8"));
    let error = parse(&text).model([0.0; 3]).unwrap_err();
    assert!(error.problem.is_of_no_mass() && error.line() == Some(3), "{error}");
    let message = "<inertia> that no distribution of mass has: \
                   link \"upper\" (line 4: moment 0.8 above the sum 0.7 of the other two)";
    let model = warned_with(&text, &accepting, &[(TriangleInequality, message)]).model([0.0; 3]).unwrap();
    assert!(!model.may_be_indefinite());
    let largest = model.link_inertia(0).about_com().to_matrix().into_iter().flatten().fold(0.0, f64::max);
    assert!((largest - 0.8).abs() < 1e-12, "{largest}");
    // Beside the axis of the shoulder nothing turns with it.
    let text = arm_with(INERTIA, &INERTIA.replace("0.3", "-0.01"));
    let negative = "<inertia> with a negative principal moment: link \"upper\" (line 4: -0.01 kg*m^2, used as it is)";
    let model = warned_with(&text, &accepting, &[(NotPositive, negative)]).model([0.0; 3]).unwrap();
    assert!(model.may_be_indefinite());
    // About the axis of the shoulder there is too little.
    let text = arm_with(INERTIA, &INERTIA.replace("iyy=\"0.4\"", "iyy=\"-4\""));
    let error = parse_with(&text, &accepting).unwrap().model([0.0; 3]).unwrap_err();
    assert!(!error.problem.is_of_no_mass() && error.line() == Some(3), "{error}");
    assert!(error.to_string().contains("the mass matrix is not positive definite at joint \"shoulder\""), "{error}");
    // What is judged with what carries it is as before where that is a body.
    let text = fixed_link("lower", "-0.01");
    assert!(!parse_with(&text, &accepting).unwrap().model([0.0; 3]).unwrap().may_be_indefinite());
}

#[test]
fn rounding_errors_instead_of_an_inertia() {
    let noise = "<inertia ixx=\"0\" ixy=\"1e-18\" ixz=\"0\" iyy=\"0\" iyz=\"0\" izz=\"-3e-17\"/>";
    let message = "<inertia> of rounding errors, taken as 0: link \"upper\" (line 4)";
    let urdf = warned(&arm_with(INERTIA, noise), &[(PointMass, message)]);
    assert_eq!((urdf.bodies[0].mass, urdf.bodies[0].inertia), (2.0, [[0.0; 3]; 3]));
}

#[test]
fn axes() {
    let axis = "    <axis xyz=\"1 0 0\"/>\n";
    let urdf = warned(&arm_with(axis, ""), &[(NoAxis, "no <axis>, 1 0 0 assumed: joint \"elbow\" (line 24)")]);
    assert_eq!(urdf.bodies[1].joint.axis, [1.0, 0.0, 0.0]);
    warned(&arm_with(axis, "<axis/>\n"), &[(NoAxis, "no <axis>, 1 0 0 assumed: joint \"elbow\" (line 28)")]);
    let message = "<axis> not of length 1, its direction is used: joint \"elbow\" (line 28: length 5.0)";
    let text = arm_with(axis, "<axis xyz=\"3 0 4\"/>\n");
    let model = warned(&text, &[(AxisLength, message)]).model([0.0; 3]).unwrap();
    let z = model.joint_placement(1).rotation.z_axis().0;
    // The first joint turns about y; the elbow's axis stays in the plane of x and z of its link.
    assert!((z[0].hypot(z[1]).hypot(z[2]) - 1.0).abs() < 1e-15);
    // Digits that were rounded are no oddity.
    warned(&arm_with(axis, "<axis xyz=\"0.7071 0 0.7071\"/>\n"), &[]);
}

#[test]
fn limits_that_are_missing() {
    let urdf = warned(&arm_with(LIMIT, ""), &[(NoLimit, "no <limit>, taken as unlimited: joint \"elbow\" (line 24)")]);
    assert_eq!(urdf.bodies[1].joint.limits[0], Limits::NONE);
    let incomplete = "incomplete <limit>: joint \"elbow\" (line 29:";
    let cases = [
        ("upper=\"0.3\" effort=\"50\" velocity=\"1\"", "lower taken as 0"),
        ("lower=\"-1\" effort=\"50\" velocity=\"1\"", "upper taken as 0"),
        ("effort=\"50\" velocity=\"1\"", "lower and upper taken as 0"),
        ("lower=\"0\" upper=\"0.3\" velocity=\"1\"", "effort taken as unlimited"),
        ("lower=\"0\" upper=\"0.3\" effort=\"50\"", "velocity taken as unlimited"),
    ];
    for (limit, what) in cases {
        let text = arm_with(LIMIT, &format!("<limit {limit}/>"));
        warned(&text, &[(IncompleteLimit, &format!("{incomplete} {what})"))]);
    }
    let limits = parse(&arm_with(LIMIT, "<limit effort=\"50\"/>")).bodies[1].joint.limits[0];
    assert_eq!(limits, Limits { lower: 0.0, upper: 0.0, effort: 50.0, velocity: f64::INFINITY });
}

#[test]
fn limits_that_make_no_sense() {
    let senseless = "senseless <limit>, taken as unlimited: joint \"elbow\" (line 29:";
    let urdf = warned(
        &arm_with("lower=\"0\"", "lower=\"1\""),
        &[(SenselessLimit, &format!("{senseless} lower 1 and upper 0.3)"))],
    );
    let limits = urdf.bodies[1].joint.limits[0];
    assert_eq!((limits.lower, limits.upper, limits.effort), (f64::NEG_INFINITY, f64::INFINITY, 50.0));
    warned(&arm_with("effort=\"50\"", "effort=\"-1\""), &[(SenselessLimit, &format!("{senseless} effort -1)"))]);
    warned(
        &arm_with("lower=\"0\"", "lower=\"inf\""),
        &[(SenselessLimit, &format!("{senseless} lower inf and upper 0.3)"))],
    );
    let unlimited = arm_with(LIMIT, "<limit lower=\"-inf\" upper=\"inf\" effort=\"Inf\" velocity=\" inf \"/>");
    assert_eq!(warned(&unlimited, &[]).bodies[1].joint.limits[0], Limits::NONE);
}

#[test]
fn continuous_joints_have_no_lower_and_upper() {
    let text = arm_with("type=\"prismatic\"", "type=\"continuous\"");
    let urdf = warned(&text, &[(NotUsed, "not used: 1 lower and upper <limit> of continuous joints")]);
    let expected = Limits { effort: 50.0, velocity: 1.0, ..Limits::NONE };
    assert_eq!((urdf.bodies[1].joint.kind, urdf.bodies[1].joint.limits[0]), (JointKind::Continuous, expected));
    warned(&text.replace(LIMIT, ""), &[]);
}

#[test]
fn mimic_joints_that_are_ignored() {
    let text = arm_with("<origin xyz=\"0 0 0.4\"/>", "<mimic joint=\"shoulder\"/>");
    let options = DescriptionOptions { ignore_mimic: true, ..DescriptionOptions::default() };
    let message = "<mimic> not applied, own coordinates instead: joint \"elbow\" (line 25)";
    let urdf = warned_with(&text, &options, &[(MimicIgnored, message)]);
    assert_eq!((urdf.bodies[1].joint.mimic.clone(), urdf.model([0.0; 3]).unwrap().nv()), (None, 2));
    warned_with(&text.replace("\"shoulder\"/>", "\"nobody\"/>"), &options, &[(MimicIgnored, message)]);
    assert_eq!(parse(&text).model([0.0; 3]).unwrap().nv(), 1);
}

#[test]
fn floating_joints_have_no_axis() {
    let text = arm_with("type=\"prismatic\"", "type=\"floating\"")
        .replace("<origin xyz=\"0 0 0.4\"/>", "<dynamics damping=\"1\"/>");
    let elbow = "of joint \"elbow\"";
    let message = format!(
        "not used, the joint is floating: <dynamics> {elbow} (line 25), <axis> {elbow} (line 28), <limit> {elbow} \
            (line 29)"
    );
    let urdf = warned(&text, &[(OfFloatingJoint, &message)]);
    assert_eq!((urdf.bodies[1].joint.kind, urdf.bodies[1].joint.damping[0]), (JointKind::Floating, 0.0));
}

#[test]
fn a_fixed_joint_with_the_name_of_the_floating_one() {
    let more = "<link name=\"tool\"/><joint name=\"floating_base\" type=\"fixed\">\
                <parent link=\"lower\"/><child link=\"tool\"/></joint>";
    let text = arm_and(more).replace("name=\"elbow\"", "name=\"floating_base_2\"");
    warned(&text, &[]);
    let message = "names that are reserved: joint \"floating_base\" (line 31: called \"floating_base_2_\" here)";
    let no_inertial = "moving links without <inertial>, taken as massless: link \"base\" (line 2)";
    let urdf = warned_with(&text, &FLOATING, &[(NoInertial, no_inertial), (Renamed, message)]);
    assert_eq!(urdf.bodies[3].joint.name, "floating_base_2_");
}

#[test]
fn a_robot_without_name() {
    let urdf = warned(&arm_with("<robot name=\"arm\">", "<robot>"), &[(NoName, "no name: <robot> (line 1)")]);
    assert_eq!(urdf.name, "");
}

#[test]
fn long_lists_are_shortened_but_kept() {
    let more: String = (0..10)
        .map(|k| {
            format!(
                "<link name=\"l{k}\"/>\n<joint name=\"j{k}\" type=\"continuous\">\
                 <parent link=\"base\"/><child link=\"l{k}\"/></joint>"
            )
        })
        .collect();
    let urdf = parse(&arm_and(&more));
    let [inertials, axes] = urdf.warnings.as_slice() else { panic!("{:?}", urdf.warnings) };
    let message = "moving links without <inertial>, taken as massless: \
                   link \"l0\" (line 31), link \"l1\" (line 32), link \"l2\" (line 33), link \"l3\" (line 34) \
                   and 6 more";
    assert_eq!((inertials.to_string().as_str(), inertials.places.len(), inertials.line()), (message, 10, 31));
    let place = DescriptionPlace { owner: Owner::Joint("j9".into()), line: 41, what: String::new() };
    assert_eq!((axes.kind, axes.places.last()), (NoAxis, Some(&place)));
}
