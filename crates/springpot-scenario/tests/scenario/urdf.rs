//! Robots from URDF files in scenarios: what is planned, and what is refused where.

use crate::support::{catalog, marked, pose};
use springpot::model::{Anchor, JointKind, Parent};
use springpot::signal::Signal;
use springpot_scenario::RefusalKind::{self, *};
use springpot_scenario::{Cases, Refusals, Scenario, ShapePlan};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

/// A lift with a hook: prismatic, revolute with `<dynamics>` and limits, a joint that follows it, a fixed frame, odd names.
const LIFT: &str = r#"<robot name="lift">
  <link name="mast"><inertial><mass value="9"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <link name="car">
    <visual><geometry><mesh filename="package://lift/car.stl"/></geometry></visual>
    <inertial><mass value="4"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
  </link>
  <link name="left hook"><inertial><mass value="1"/><origin xyz="0.2 0 0"/>
    <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
  <link name="right.hook"><inertial><mass value="1"/><origin xyz="0.2 0 0"/>
    <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
  <link name="tip"/>
  <joint name="rail" type="prismatic"><parent link="mast"/><child link="car"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="2" effort="500" velocity="1"/></joint>
  <joint name="left swing" type="revolute"><parent link="car"/><child link="left hook"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1.5" effort="20" velocity="3"/><dynamics damping="0.4" friction="0.1"/></joint>
  <joint name="right.swing" type="continuous"><parent link="car"/><child link="right.hook"/><axis xyz="0 1 0"/>
    <mimic joint="left swing" multiplier="-2" offset="0.5"/></joint>
  <joint name="weld" type="fixed"><parent link="left hook"/><child link="tip"/><origin xyz="0.4 0 0"/></joint>
</robot>
"#;

const REST: &str = r#"
[[element]]
name = "rope"
from = { body = "mast", point = [0, 0.5, 3] }
to = { body = "left hook", point = [0.1, 0, 0] }
rest_length = 2
law = "spring"
parameters = { k = 10 }
[motion]
kind = "prescribed"
joints = { rail = "1 + 0.1*sin(t)", "left swing" = 0.2 }
[time]
end = 1
output_step = 0.1
"#;

const ROBOT: &str = "[robot]\nurdf = \"robots/lift.urdf\"\n";

/// A folder with robots/lift.urdf.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("robots")).unwrap();
    fs::write(folder.path().join("robots/lift.urdf"), LIFT).unwrap();
    folder
}

fn cases_in(folder: &Path, text: &str, set: &[&str]) -> Result<Cases, Refusals> {
    let mut scenario = Scenario::parse(text, "lift.toml", folder)?;
    set.iter().try_for_each(|set| scenario.set(set))?;
    scenario.cases(&catalog())
}

#[test]
fn a_urdf_is_planned_whole() {
    let folder = folder();
    let gripper = "[robot.gripper]\nbody = \"tip\"\npoint = [0, 0, 0.1]\n";
    let cases = cases_in(folder.path(), &format!("{ROBOT}gravity = [0, 0, -1.62]\n{gripper}{REST}"), &[]).unwrap();
    let plan = cases.plan(0).unwrap();
    assert_eq!(plan.gravity, [0.0, 0.0, -1.62]);
    assert_eq!(plan.model.gravity(), plan.gravity);
    let bodies: Vec<&str> = plan.bodies.iter().map(|body| body.name.as_str()).collect();
    assert_eq!(bodies, ["car", "left hook", "tip", "right.hook"]);
    assert_eq!(plan.joint_names().collect::<Vec<_>>(), ["rail", "left swing", "right.swing"]);
    assert_eq!(plan.own_joint_names().collect::<Vec<_>>(), ["rail", "left swing"]);
    assert_eq!((plan.model.nq(), plan.model.nv()), (2, 2));
    assert_eq!(plan.model.damping(), [0.0, 0.4, 0.0]);
    assert_eq!(plan.model.friction(), [0.0, 0.1, 0.0]);
    assert!(plan.output.tells_joint_losses);
    // The root link is the world, whatever its name.
    let ShapePlan::Points(points) = &plan.elements[0].shape else { panic!("between points") };
    assert_eq!(points[0], Anchor { body: Parent::World, point: [0.0, 0.5, 3.0] });
    assert_eq!(points[1].body, Parent::Body(1));
    let gripper = plan.gripper.as_ref().unwrap();
    assert_eq!((gripper.body.as_str(), gripper.anchor.body), ("tip", Parent::Body(2)));
    // Everything of the robot stands where the file is named.
    assert!(plan.body_places.iter().all(|places| places.at("mass").text() == "\"robots/lift.urdf\""));
    assert_eq!(plan.body_places.len(), plan.bodies.len());

    let columns: Vec<String> = plan.system().columns().into_iter().map(|column| column.name).collect();
    assert_eq!(columns[..5], ["t", "q.rail", "q.left swing", "v.rail", "v.left swing"]);
    assert_eq!(columns.iter().filter(|name| name.contains("right")).count(), 0);

    let resolved = plan.resolved();
    let urdf = &resolved["urdf"];
    assert_eq!((&urdf["file"], &urdf["robot"]), (&"robots/lift.urdf".into(), &"lift".into()));
    assert_eq!(
        (&urdf["root"], &urdf["floating_base"], &urdf["ignore_mimic"]),
        (&"mast".into(), &false.into(), &false.into())
    );
    let joint = |body: usize| &resolved["bodies"][body]["joint"];
    assert_eq!(joint(0)["limits"], serde_json::json!({ "lower": 0.0, "upper": 2.0, "velocity": 1.0, "effort": 500.0 }));
    assert_eq!(joint(2)["limits"], serde_json::json!({}));
    assert_eq!(joint(3)["mimic"], serde_json::json!({ "joint": "left swing", "multiplier": -2.0, "offset": 0.5 }));
    assert!(joint(0)["mimic"].is_null());
    assert_eq!(resolved["motion"]["joints"], serde_json::json!({ "rail": "1 + 0.1*sin(t)", "left swing": 0.2 }));
}

#[test]
fn floating_base_and_ignore_mimic_change_the_joints() {
    let folder = folder();
    let text = format!("{ROBOT}{REST}");
    let set = ["robot.floating_base=true", "motion.joints.floating_base.z=\"0.3*t\""];
    // A root link that floats is a body and no longer the world.
    let cases = cases_in(folder.path(), &text, &[&set[..], &["element.rope.from.body=world"]].concat()).unwrap();
    let plan = cases.plan(0).unwrap();
    assert_eq!(plan.bodies[0].name, "mast");
    assert_eq!(plan.bodies[0].joint.kind, JointKind::Floating);
    assert_eq!(plan.own_joint_names().collect::<Vec<_>>(), ["floating_base", "rail", "left swing"]);
    assert_eq!(plan.resolved()["urdf"]["floating_base"], true);
    let pose = pose(&plan);
    assert_eq!(pose.position.each_ref().map(|signal| signal.value(0.5)), [0.0, 0.0, 0.15]);
    assert_eq!(pose.rpy.each_ref().map(Signal::is_constant), [Some(0.0); 3]);
    assert_eq!(
        plan.resolved()["motion"]["joints"]["floating_base"],
        serde_json::json!({ "x": 0.0, "y": 0.0, "z": "0.3*t", "rpy": [0.0, 0.0, 0.0] })
    );

    let set = ["robot.ignore_mimic=true", "motion.joints.\"right.swing\"=0.1"];
    let cases = cases_in(folder.path(), &text, &set).unwrap();
    let plan = cases.plan(0).unwrap();
    assert_eq!(plan.own_joint_names().collect::<Vec<_>>(), ["rail", "left swing", "right.swing"]);
    assert!(cases.warnings().iter().any(|warning| warning.contains("<mimic>") && warning.contains("right.swing")));
}

#[test]
fn names_of_a_urdf_are_kept_and_quoted_in_paths() {
    let folder = folder();
    let text = format!(
        "{ROBOT}{REST}[[sweep]]\nparameter = 'motion.joints.\"left swing\"'\nvalues = [0.1, 0.3]\n\
         [[figure]]\ny = \"q.left swing\"\nwhere = {{ 'motion.joints.\"left swing\"' = 0.3 }}\n"
    );
    let cases = cases_in(folder.path(), &text, &[]).unwrap();
    assert_eq!(cases.parameters(), ["motion.joints.\"left swing\""]);
    assert_eq!(cases.plan(1).unwrap().system().state(0.0).unwrap().q[1], 0.3);
    assert_eq!(cases.figures()[0].selection[0].value, 1);
    for path in ["motion.joints.\"left swing\"=0.7", " motion . joints . 'left swing' = 0.7"] {
        let cases = cases_in(folder.path(), &format!("{ROBOT}{REST}"), &[path]).unwrap();
        assert_eq!(cases.plan(0).unwrap().system().state(0.0).unwrap().q[1], 0.7, "{path}");
    }
}

#[test]
fn a_sweep_reads_each_file_once_and_may_go_through_files() {
    let folder = folder();
    let heavy =
        LIFT.replace("<mass value=\"4\"/>", "<mass value=\"8\"/>").replace("damping=\"0.4\" friction=\"0.1\"", "");
    fs::write(folder.path().join("robots/heavy.urdf"), heavy).unwrap();
    let sweep = "[[sweep]]\nparameter = \"robot.urdf\"\nvalues = [\"robots/heavy.urdf\", \"robots/lift.urdf\"]\n";
    let cases = cases_in(folder.path(), &format!("{ROBOT}{REST}{sweep}"), &[]).unwrap();
    let plans = [0, 1].map(|case| cases.plan(case).unwrap());
    assert_eq!(plans.each_ref().map(|plan| plan.bodies[0].mass), [8.0, 4.0]);
    // One of them has joint losses: both tell them, so that their columns are the same.
    let columns = plans.each_ref().map(|plan| plan.system().columns());
    assert_eq!(columns[0], columns[1]);
    assert!(columns[0].iter().any(|column| column.name == "energy.joints"));
    let meshes = cases.warnings().into_iter().filter(|warning| warning.contains("car.stl")).collect::<Vec<_>>();
    assert_eq!(meshes.len(), 2);
    assert!(meshes[0].contains("heavy.urdf: ") && meshes[1].contains("lift.urdf: "), "{meshes:?}");

    // Read before the file changed, and not again.
    fs::remove_file(folder.path().join("robots/lift.urdf")).unwrap();
    assert_eq!(cases.plan(1).unwrap().bodies[0].mass, 4.0);
}

#[test]
fn packages_are_looked_for_beside_the_scenario() {
    let folder = folder();
    fs::create_dir_all(folder.path().join("elsewhere/lift")).unwrap();
    fs::write(folder.path().join("elsewhere/lift/car.stl"), "").unwrap();
    let warns = |path: &str| {
        let cases = cases_in(folder.path(), &format!("{ROBOT}{path}{REST}"), &[]).unwrap();
        cases.warnings().iter().any(|warning| warning.contains("car.stl"))
    };
    assert!(warns(""));
    assert!(warns("package_path = \"nowhere\"\n"));
    assert!(!warns("package_path = \"elsewhere\"\n"));
    assert!(!warns("package_path = [\"nowhere\", \"elsewhere/lift\"]\n"));
    let cases = cases_in(folder.path(), &format!("{ROBOT}package_path = \"elsewhere\"\n{REST}"), &[]).unwrap();
    assert_eq!(cases.plan(0).unwrap().resolved()["urdf"]["package_path"], serde_json::json!(["elsewhere"]));
}

/// Asserts that the text, in a folder with the lift, is refused at its mark.
fn assert_refused(text: &str, kind: RefusalKind, words: &str) {
    let folder = folder();
    let broken = LIFT.replace("<mass value=\"4\"/>", "<mass value=\"-4\"/>");
    fs::write(folder.path().join("robots/broken.urdf"), broken).unwrap();
    fs::write(folder.path().join("robots/alone.urdf"), "<robot name=\"a\"><link name=\"rock\"/></robot>").unwrap();
    let fixed = LIFT.replace("prismatic", "fixed").replace("revolute", "fixed").replace("continuous", "fixed");
    fs::write(folder.path().join("robots/stiff.urdf"), fixed).unwrap();
    let twice = LIFT.replace("\"left swing\"", "\"floating_base.x\"");
    fs::write(folder.path().join("robots/twice.urdf"), twice).unwrap();
    let (text, line, column) = marked(text);
    let refusals = cases_in(folder.path(), &text, &[]).map(|cases| cases.len()).expect_err("must be refused");
    let shown = refusals.to_string();
    let found = refusals.iter().find(|refusal| (refusal.line, refusal.column) == (line, column));
    let refusal = found.unwrap_or_else(|| panic!("nothing at {line}:{column} but\n{shown}\n{text}"));
    assert_eq!(refusal.kind, kind, "{shown}");
    assert!(refusal.to_string().contains(words), "no {words:?} in\n{shown}");
    assert_eq!(refusals.len(), 1, "{shown}");
}

#[test]
fn what_is_wrong_with_the_robot_is_refused_in_its_place() {
    let robot = |lines: &str| format!("[robot]\n{lines}\n{REST}");
    let body = "[[robot.body]]\nname = \"a\"\nmass = 1\ncom = [0, 1, 0]\njoint = { name = \"q\", kind = \"revolute\", axis = [1, 0, 0] }\n";
    for (text, kind, words) in [
        (robot("urdf = ‸\"robots/none.urdf\""), File, "none.urdf: cannot be read: "),
        (
            robot("urdf = ‸\"robots/none.urdf\""),
            File,
            "help: write the path of the robot's file, relative to the scenario",
        ),
        (robot("urdf = ‸\"robots\""), File, "not a regular file"),
        (robot("urdf = ‸\"robots/broken.urdf\""), File, "broken.urdf:5:15: value of <mass> of link \"car\" is -4"),
        (robot("urdf = ‸\"robots/alone.urdf\""), File, "alone.urdf:1:1: the robot is the single link \"rock\""),
        (
            robot("urdf = ‸\"robots/stiff.urdf\""),
            Missing,
            "has no joint that moves: all are fixed\n  help: floating_base = true",
        ),
        (
            robot("urdf = ‸\"robots/twice.urdf\"\nfloating_base = true"),
            BadName,
            "has joints whose names make the same column twice: \"floating_base.x\"",
        ),
        (robot("urdf = ‸3"), WrongType, "`urdf` of [robot] must be a text"),
        (
            robot("urdf = \"robots/lift.urdf\"\nfloating_base = ‸\"yes\""),
            WrongType,
            "must be true or false, not the text \"yes\"",
        ),
        (robot("urdf = \"robots/lift.urdf\"\nignore_mimic = ‸1"), WrongType, "must be true or false"),
        (
            robot("urdf = \"robots/lift.urdf\"\npackage_path = ‸1"),
            WrongType,
            "the path of a folder, or an array of them",
        ),
        (robot("urdf = \"robots/lift.urdf\"\npackage_path = [\"a\", ‸1]"), WrongType, "must be a text"),
        (robot("urdf = \"robots/lift.urdf\"\n‸package_pth = \"a\""), UnknownKey, "did you mean `package_path`?"),
        (
            format!("[robot]\nurdf = \"robots/lift.urdf\"\nbody = ‸[{{ name = \"a\" }}]\n{REST}"),
            Rule,
            "`body` of [robot] stands beside `urdf`\n  help: a robot is a file or [[robot.body]] blocks",
        ),
        (
            format!(
                "[robot]\n‸floating_base = true\n{body}[motion]\nkind = \"prescribed\"\njoints = {{ q = 0 }}\n[time]\nend = 1\noutput_step = 1\n"
            ),
            Rule,
            "`floating_base` of [robot] belongs to `urdf`, and this robot has none; give the first [[robot.body]] a joint of kind = \"floating\"",
        ),
        (
            format!(
                "[robot]\n‸ignore_mimic = true\n{body}[motion]\nkind = \"prescribed\"\njoints = {{ q = 0 }}\n[time]\nend = 1\noutput_step = 1\n"
            ),
            Rule,
            "`ignore_mimic` of [robot] belongs to `urdf`",
        ),
        (
            format!("‸[robot]\ngravity = [0, 0, 0]\n{REST}"),
            Missing,
            "[robot] has no `body`\n  help: write urdf = \"arm.urdf\", mjcf = \"arm.xml\", or",
        ),
    ] {
        assert_refused(&text, kind, words);
    }
}

#[test]
fn what_names_the_robots_parts_wrongly_is_refused_in_its_place() {
    let whole = format!("{ROBOT}{REST}");
    let edit = |from: &str, to: &str| {
        assert_eq!(whole.matches(from).count(), 1, "{from}");
        whole.replace(from, to)
    };
    for (text, kind, words) in [
        (edit("body = \"left hook\"", "body = ‸\"left\""), UnknownName, "names no body: \"left\""),
        (edit("body = \"mast\"", "body = ‸\"masts\""), UnknownName, "did you mean `mast`?"),
        (edit("body = \"left hook\"", "body = ‸\"hook\""), UnknownName, "did you mean `right.hook`?"),
        (
            edit("joints = { rail", "joints = { ‸\"right.swing\" = 0, rail"),
            Rule,
            "joint \"right.swing\" follows \"left swing\" (-2*left swing + 0.5) and has no coordinate of its own",
        ),
        (edit("joints = { rail", "joints = { ‸weld = 0, rail"), Rule, "joint \"weld\" is fixed and has no coordinate"),
        (edit("joints = { rail = \"1 + 0.1*sin(t)\",", "joints = ‸{"), Missing, "leaves out the joints rail"),
        (edit("\"left swing\" = 0.2", "‸\"left swin\" = 0.2"), UnknownKey, "did you mean `left swing`?"),
    ] {
        assert_refused(&text, kind, words);
    }
    let on_root = "[robot]\nurdf = \"robots/lift.urdf\"\ngripper = ‸{ body = \"mast\", point = [0, 0, 0] }\n";
    assert_refused(
        &format!("{on_root}{REST}"),
        Rule,
        "is on \"mast\", the root link, which is the world and does not move\n  help: write one of car, left hook, tip and right.hook",
    );
    let on_world = on_root.replace("mast", "world");
    assert_refused(&format!("{on_world}{REST}"), Rule, "is on the world, which does not move");
    // Both ends on the world, by its two names.
    let edited = edit("body = \"left hook\", point = [0.1, 0, 0] }", "body = \"world\", point = [0.1, 0, 0] }")
        .replace("to = {", "to = ‸{");
    let words = "has both ends on the world, which is also called \"mast\": its length cannot change";
    assert_refused(&edited, Rule, words);
}

#[test]
fn names_that_lack_their_prefix_are_understood() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata/multibody");
    let text = "[robot]\nurdf = \"panda.urdf\"\n[motion]\nkind = \"gripper-path\"\nx = 0\ny = 0\nz = 1\nguess = { joint7 = 1 }\n\
                [robot.gripper]\nbody = \"hand\"\npoint = [0, 0, 0]\n[time]\nend = 1\noutput_step = 1\n";
    let refusals = cases_in(&path, text, &[]).map(|cases| cases.len()).unwrap_err().to_string();
    assert!(refusals.contains("did you mean `panda_hand`?"), "{refusals}");
    let text = text.replace("\"hand\"", "\"panda_hand\"");
    let refusals = cases_in(&path, &text, &[]).map(|cases| cases.len()).unwrap_err().to_string();
    assert!(refusals.contains("did you mean `panda_joint7`?"), "{refusals}");
}

#[test]
fn robots_beyond_all_measure_are_refused() {
    let chain = |joints: usize| {
        let inertia = "<inertial><mass value=\"1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial>";
        let mut text = "<robot name=\"chain\"><link name=\"l0\"/>".to_owned();
        for k in 1..=joints {
            let _ = write!(
                text,
                "<link name=\"l{k}\">{inertia}</link><joint name=\"j{k}\" type=\"continuous\"><parent link=\"l{}\"/>\
                 <child link=\"l{k}\"/><axis xyz=\"0 0 1\"/></joint>",
                k - 1
            );
        }
        text + "</robot>"
    };
    let folder = tempfile::tempdir().unwrap();
    let refusals = |joints: usize, more: &str| {
        fs::write(folder.path().join("chain.urdf"), chain(joints)).unwrap();
        let text = format!(
            "[robot]\nurdf = \"chain.urdf\"\n{more}[time]\nend = 1\noutput_step = 1\n[motion]\nkind = \"prescribed\"\ncsv = \"no.csv\"\n"
        );
        cases_in(folder.path(), &text, &[]).map(|cases| cases.len()).unwrap_err().to_string()
    };
    let shown = refusals(10_001, "");
    assert!(shown.contains("has 10001 moving joints; at most 10000 are taken"), "{shown}");
    let shown = refusals(10_000, &"[[element]]\n".repeat(1_001));
    assert!(shown.contains("holds 1001 elements on a robot of 10000 velocities"), "{shown}");
}
