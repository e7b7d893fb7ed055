//! What a file must not be, told by its place.

use springpot::model::description::{DescriptionOptions, RobotDescription};

/// A file of one body with this joint, and this before the bodies.
fn text(before: &str, inside: &str) -> String {
    format!("<mujoco>\n{before}\n<worldbody><body name=\"a\">\n{inside}\n</body></worldbody></mujoco>")
}

const SOLID: &str = "<joint/><geom size=\"0.1\"/>";

fn refusal(text: &str) -> String {
    let read = RobotDescription::parse(text, None, &DescriptionOptions::default());
    let built = read.and_then(|robot| robot.model([0.0; 3]));
    built.map(|_| ()).expect_err(text).to_string()
}

#[test]
fn mistakes_are_named_by_their_place() {
    let many = "<body>".repeat(1_200) + &"</body>".repeat(1_200);
    for (before, inside, why) in [
        ("", "<joint/><geom size=\"0.1\" class=\"hevy\"/>", "line 4, column 9: body \"a\" names the class \"hevy\""),
        (
            "<default><default class=\"heavy\"/></default>",
            "<geom class=\"hevy\" size=\"1\"/>",
            "did you mean \"heavy\"?",
        ),
        ("<default><default class=\"b\"/><default class=\"b\"/></default>", SOLID, "two <default> of class \"b\""),
        ("<compiler angle=\"degrees\"/>", SOLID, "did you mean \"degree\"?"),
        ("<compiler fitaabb=\"true\"/>", SOLID, "fitaabb"),
        ("<compiler eulerseq=\"xyw\"/>", SOLID, "three letters"),
        ("<include file=\"b.xml\"/>", SOLID, "no folder to look in"),
        ("", "<joint name=\"j\" axis=\"0 0 0\"/><geom size=\"1\"/>", "joint \"j\" has an axis without direction"),
        ("", "<joint type=\"hing\"/><geom size=\"1\"/>", "did you mean \"hinge\"?"),
        ("", "<joint damping=\"-1\"/><geom size=\"1\"/>", "damping of -1"),
        ("", "<joint armature=\"x\"/><geom size=\"1\"/>", "\"x\""),
        ("", "<joint type=\"ball\" armature=\"-1\"/><geom size=\"1\"/>", "armature"),
        ("", "<joint/><joint name=\"a_joint\"/><geom size=\"1\"/>", "joint \"a_joint\" stands twice"),
        ("", "<joint name=\"a b\"/><joint name=\"a/b\"/><geom size=\"1\"/>", "becomes \"a_b\", and so does \"a b\""),
        ("", "<joint/><freejoint/><geom size=\"1\"/>", "must be the only joint"),
        ("", "<joint/><body><freejoint/><geom size=\"1\"/></body>", "must be the only joint"),
        ("", "<joint/><geom type=\"box\" size=\"1 1\"/>", "needs 3 positive numbers"),
        ("", "<joint/><geom type=\"capsule\" size=\"1\" fromto=\"0 0 0 0 0 0\"/>", "no length"),
        ("", "<joint/><geom type=\"mesh\" mesh=\"m\"/>", "names the mesh \"m\", and there is none"),
        ("<asset><mesh name=\"m\" file=\"m.stl\"/></asset>", "<joint/><geom mesh=\"m\"/>", "m.stl\" is not found"),
        ("", "<joint/><geom size=\"1\" quat=\"1 0 0 0\" euler=\"0 0 0\"/>", "one attitude is enough"),
        ("", "<joint/><geom size=\"1\" quat=\"0 0 0 0\"/>", "no direction"),
        ("", "<joint/><inertial pos=\"0 0 0\"/>", "without mass"),
        ("", "<joint/><composite/>", "<composite>, which is not supported"),
        ("", "<joint/><geom size=\"1\"/><replicate count=\"3\"/>", "<replicate>"),
        ("", "<joint/>", "mass"),
        ("", &*many, "levels"),
    ] {
        let told = refusal(&text(before, inside));
        assert!(told.contains(why), "{before} {inside:.60}: {told}");
    }
    let world = "<mujoco><worldbody><joint/></worldbody></mujoco>";
    assert!(refusal(world).contains("does not move"), "{}", refusal(world));
    let floats = DescriptionOptions { floating_base: true, ..DescriptionOptions::default() };
    let told = RobotDescription::parse(&text("", SOLID), None, &floats).unwrap_err().to_string();
    assert!(told.contains("freejoint"), "{told}");
}

#[test]
fn included_files_stay_inside_and_come_once() {
    let folder = tempfile::tempdir().unwrap();
    let inner = folder.path().join("robot");
    std::fs::create_dir(&inner).unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("out.xml", "<mujoco/>");
    write("robot/twice.xml", "<mujoco><include file=\"self.xml\"/></mujoco>");
    write("robot/wrong.xml", "<mujoco>\n<worldbody><body><joint axis=\"x\"/></body></worldbody></mujoco>");
    let read = |include: &str| {
        write("robot/self.xml", &text(&format!("<include file={include:?}/>"), SOLID));
        let read = RobotDescription::read(&inner.join("self.xml"), &DescriptionOptions::default());
        read.map(|_| ()).unwrap_err().to_string()
    };
    assert!(read("../out.xml").contains("outside its folder"), "{}", read("../out.xml"));
    assert!(read("self.xml").contains("a second time"), "{}", read("self.xml"));
    assert!(read("twice.xml").contains("a second time"), "{}", read("twice.xml"));
    assert!(read("none.xml").contains("no such file"), "{}", read("none.xml"));
    // A mistake in an included file is told in that file.
    let told = read("wrong.xml");
    assert!(told.contains("wrong.xml:2:") && told.contains("\"x\""), "{told}");
}
