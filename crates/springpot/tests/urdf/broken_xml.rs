//! Files that cannot be read, and texts that are no XML or another kind of it.

use crate::support::{ARM, arm_and, arm_with, parse_with, refused};
use crate::work::Work;
use springpot::model::description::{DescriptionOptions, DescriptionProblem, RobotDescription};

fn read(path: &std::path::Path) -> springpot::model::description::DescriptionError {
    RobotDescription::read(path, &DescriptionOptions::default()).expect_err("this is no robot")
}

#[test]
fn files_that_cannot_be_read() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing.urdf");
    let error = read(&missing);
    assert!(matches!(*error.problem, DescriptionProblem::Unreadable { .. }));
    assert!(error.to_string().starts_with(&format!("{}: cannot be read: ", missing.display())), "{error}");
    let error = read(folder.path());
    assert_eq!(error.to_string(), format!("{}: not a regular file", folder.path().display()));
    let latin = folder.path().join("latin.urdf");
    std::fs::write(&latin, b"<robot>\n  <!-- M\xfcnchen -->\n</robot>").unwrap();
    let message = format!("{}:2:9: not UTF-8 text; save the file as UTF-8", latin.display());
    assert_eq!(read(&latin).to_string(), message);
}

#[test]
fn a_file_is_named_with_line_and_column() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("arm.urdf");
    std::fs::write(&path, arm_with(r#"<mass value="2"/>"#, r#"<mass value="two"/>"#)).unwrap();
    let message = "value of <mass> of link \"upper\" holds \"two\", which is not a number";
    assert_eq!(read(&path).to_string(), format!("{}:6:20: {message}", path.display()));
    std::fs::write(&path, ARM).unwrap();
    assert_eq!(RobotDescription::read(&path, &DescriptionOptions::default()).unwrap().file, Some(path));
}

#[test]
fn broken_xml() {
    refused("", "line 1, column 1: not XML: there is no element in it");
    refused("<!-- nothing -->\n", "line 1, column 17: not XML: there is no element in it");
    refused(
        "<!-- <a> -->\n <robot>\n<link/>",
        "line 2, column 2: not XML: the outermost element is never closed; the text ends on line 3",
    );
    refused("hello", "line 1, column 1: not XML: unknown token");
    refused("<robot>\n<link name='a\n", "line 2, column 14: not XML: the text ends too early");
    refused("<robot>\n</link>", "line 2, column 1: not XML: expected 'robot' tag, not 'link'");
    refused("<robot name='a' name='b'/>", "line 1, column 17: not XML: attribute 'name' is already defined");
    refused("<robot name='<'/>", "line 1, column 14: not XML: expected ''', found '<'");
    refused("<robot/><robot/>", "line 1, column 9: not XML: unknown token");
    refused("<robot\n<", "line 2, column 1: not XML: invalid name token");
    refused("<robot>\n</robot\n<", "line 3, column 1: not XML: expected '>', found '<'");
    refused("<robot name\n\n</robot>", "line 3, column 1: not XML: expected '=', found '<'");
    let message = "line 1, column 9: not XML: the prefix \"old\" is not declared (xmlns:old=\"…\" in <robot> would do)";
    refused("<robot><old:link/></robot>", message);
}

#[test]
fn documents_with_entities() {
    refused(
        "<?xml version='1.0'?>\n<!DOCTYPE robot><robot/>",
        "line 2, column 1: not XML: it has a <!DOCTYPE>, which no robot needs",
    );
    let bomb = "<!DOCTYPE r [<!ENTITY a \"aaaa\"><!ENTITY b \"&a;&a;\">]><robot name=\"&b;\"/>";
    refused(bomb, "line 1, column 1: not XML: it has a <!DOCTYPE>, which no robot needs");
    refused("<robot name=\"&b;\"/>", "line 1, column 14: not XML: unknown entity reference 'b'");
}

#[test]
fn other_kinds_of_xml() {
    let told = |element: &str, help: &str| {
        format!("the outermost element is <{element}>, neither <robot> (URDF) nor <mujoco> (MJCF){help}")
    };
    let sdf = told("sdf", "; this is an SDF file, which is not read");
    refused("<!-- -->\n<sdf/>", &format!("line 2, column 1: {sdf}"));
    refused("<Robot/>", &format!("line 1, column 1: {}", told("Robot", "; names are case-sensitive")));
    refused("<html/>", &format!("line 1, column 1: {}", told("html", "")));
    refused("<robot name=\"empty\"/>", "line 1, column 1: the robot has no <link>");
}

#[test]
fn xacro_must_be_expanded() {
    let xmlns = "xmlns:xacro=\"http://www.ros.org/wiki/xacro\"";
    let help = "is xacro, not URDF; expand it first: xacro robot.urdf.xacro > robot.urdf";
    let macros = arm_and("<xacro:arm/>");
    refused(&macros.replace("<robot", &format!("<robot {xmlns}")), &format!("line 31, column 1: <xacro:arm> {help}"));
    refused(&macros, &format!("line 31, column 2: <xacro:…> {help}"));
    let inside = arm_with("<mass value=\"2\"/>", &format!("<x:mass {}/>", xmlns.replace(":xacro=", ":x=")));
    refused(&inside, &format!("line 6, column 7: <x:mass> {help}"));
    let expression = arm_with("0 0 0.4", "0 0 ${2 * length}");
    let message = "xyz of <origin> of joint \"elbow\" holds \"0 0 ${2 * length}\", which is not a number but xacro; \
                   expand the file first: xacro robot.urdf.xacro > robot.urdf";
    refused(&expression, &format!("line 25, column 18: {message}"));
    // What xacro leaves behind is fine.
    let expanded = ARM.replace("<robot", &format!("<robot {xmlns}"));
    assert_eq!(parse_with(&expanded, &DescriptionOptions::default()).unwrap().warnings, []);
}

#[test]
fn a_default_namespace_does_not_matter() {
    let text = ARM.replace("<robot", "<robot xmlns=\"http://www.ros.org\"");
    let urdf = parse_with(&text, &DescriptionOptions::default()).unwrap();
    assert_eq!((urdf.bodies.len(), urdf.warnings.len()), (2, 0));
}

#[test]
fn hostile_texts_are_refused_in_time() {
    let work = Work::begin();
    let deep = arm_and(&"<a>".repeat(200_000));
    let message = "line 31, column 600001: not XML: expected 'a' tag, not 'robot'";
    refused(&deep, message);
    let closed = arm_and(&format!("{}{}", "<a>".repeat(200_000), "</a>".repeat(200_000)));
    assert_eq!(parse_with(&closed, &DescriptionOptions::default()).unwrap().warnings[0].places.len(), 1);
    let gazebo = closed.replacen("<a>", "<gazebo>", 1);
    let gazebo = format!("{}</gazebo></robot>", gazebo.trim_end().strip_suffix("</a></robot>").unwrap());
    assert_eq!(parse_with(&gazebo, &DescriptionOptions::default()).unwrap().warnings.len(), 1);

    let wide: String = (0..100_000).map(|k| format!(" a{k}=\"\"")).collect();
    refused(
        &format!("<robot{wide}/>"),
        "line 1, column 1: more than 128 attributes in one tag; this is no description of a robot",
    );
    let spaces: String = (0..3_000).map(|k| format!("<a xmlns:a{k}=\"{k}\">")).collect();
    refused(
        &spaces,
        "line 1, column 41781: more than 2000 declarations of namespaces; this is no description of a robot",
    );
    refused(&"=".repeat(17_000_000), "more than 16000000 tags and attributes; this is no description of a robot");
    let comments =
        arm_and(&format!("<!-- {} --><![CDATA[<a {}]]><?a {}?>", "=".repeat(500), "=".repeat(500), "=".repeat(500)));
    assert!(parse_with(&comments, &DescriptionOptions::default()).is_ok());
    assert!(work.done().as_secs() < 20, "{:?}", work.done());
}
