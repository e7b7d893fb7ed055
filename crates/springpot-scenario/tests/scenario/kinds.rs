//! Kinds of joint with several coordinates, rotors, limits and followers: what scenarios say of them, and what is refused.

use crate::support::{assert_all_refused, cases, catalog, edited, refusals};
use springpot::model::{FrictionLaw, Limits};
use springpot_scenario::RefusalKind::*;
use springpot_scenario::{Plan, Scenario};

/// One joint of every kind that has more than an axis.
const TREE: &str = r#"
[[robot.body]]
name = "gimbal"
joint = { name = "u", kind = "universal", axis = [1, 0, 0], axis2 = [0, 1, 0], damping = { first = 0.5 }, friction = { second = { force = "0.2 N*m", stick = true } } }
mass = 1
inertia = { xx = 0.1, yy = 0.1, zz = 0.1 }

[[robot.body]]
name = "sleeve"
joint = { name = "c", kind = "cylindrical", axis = [0, 0, 1], damping = { z = "20 N*s/m", rz = "0.1 N*m*s/rad" }, armature = { rz = "2 g*m^2" }, lower = { z = "-10 cm" }, upper = { z = 0.3 } }
mass = 1
inertia = { xx = 0.1, yy = 0.1, zz = 0.1 }

[[robot.body]]
name = "screw"
joint = { name = "h", kind = "helical", axis = [0, 0, 1], lead = "5 mm", effort = "3 N*m", velocity = 20 }
mass = 1
inertia = { xx = 0.1, yy = 0.1, zz = 0.1 }

[[robot.body]]
name = "plate"
joint = { name = "p", kind = "planar", damping = 0.3 }
mass = 1
inertia = { xx = 0.1, yy = 0.1, zz = 0.1 }

[[robot.body]]
name = "bob"
joint = { name = "s", kind = "spherical" }
mass = 1
inertia = { xx = 0.1, yy = 0.1, zz = 0.1 }

[[robot.body]]
name = "dial"
joint = { name = "d", kind = "revolute", axis = [0, 0, 1], mimic = { joint = "h", multiplier = -2, offset = "10 deg" } }
mass = 1
inertia = { xx = 0.1, yy = 0.1, zz = 0.1 }

[motion]
kind = "forward"
start = { q = { u = { second = 0.2 }, s = { rpy = [0, 0, "90 deg"] } }, v = { c = { wz = 3 }, s = { wy = 1 } } }
torque = { p = { vy = 2 }, s = { wx = "0.1*t" } }
prescribed = { c = { rz = "t" } }
locked = ["u"]

[time]
end = 1
output_step = 0.1
"#;

fn plan(text: &str) -> Plan {
    cases(text).unwrap_or_else(|refusals| panic!("{refusals}")).plan(0).unwrap()
}

#[test]
fn joints_of_several_coordinates_are_planned() {
    let plan = plan(TREE);
    let model = &plan.model;
    let names: Vec<String> = model.q_labels().into_iter().map(|label| label.name).collect();
    assert_eq!(names.join(" "), "u.first u.second c.z c.rz h p.x p.y p.rz s.qx s.qy s.qz s.qw");
    assert_eq!(model.damping(), [0.5, 0.0, 20.0, 0.1, 0.0, 0.3, 0.3, 0.3, 0.0, 0.0]);
    assert_eq!((model.friction()[1], model.friction_laws()[1]), (0.2, FrictionLaw::Sticking));
    assert_eq!(model.rotors(), [0.0, 0.0, 0.0, 0.002, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert_eq!(*model.limits(2), Limits { lower: -0.1, upper: 0.3, ..Limits::NONE });
    assert_eq!(*model.limits(4), Limits { effort: 3.0, velocity: 20.0, ..Limits::NONE });
    assert_eq!(model.followed(9), Some((4, -2.0, 10f64.to_radians())));
    let state = plan.system().state(0.0).unwrap();
    let half = std::f64::consts::FRAC_1_SQRT_2;
    assert_eq!(state.q[1], 0.2);
    assert!((state.q[10] - half).abs() < 1e-15 && (state.q[11] - half).abs() < 1e-15, "{:?}", state.q);
    // The cylindrical joint is moved by signals whole: z is 0, and rz goes with t.
    assert_eq!((state.v[2], state.v[3], state.v[9]), (0.0, 1.0, 1.0));
    let record = plan.resolved();
    assert_eq!(record["bodies"][1]["joint"]["damping"], serde_json::json!({ "z": 20.0, "rz": 0.1 }));
    assert_eq!(record["bodies"][2]["joint"]["lead"], 0.005);
}

#[test]
fn a_mimic_takes_a_ratio_of_two_units_and_one_coordinate_of_several() {
    let rack = edited(
        TREE,
        &[(
            "mimic = { joint = \"h\", multiplier = -2, offset = \"10 deg\" }",
            "mimic = { joint = \"c.z\", multiplier = \"4 rad/cm\" }",
        )],
    );
    assert_eq!(plan(&rack).model.followed(9), Some((2, 400.0, 0.0)));
}

#[test]
fn every_coordinate_is_prescribed_by_its_own_signal() {
    let start = TREE.find("[motion]").unwrap();
    let end = TREE.find("[time]").unwrap();
    let motion = "[motion]\nkind = \"prescribed\"\n";
    let joints = "joints = { u = { first = \"t\", second = \"t^2\" }, c = { z = \"0.1*t\" }, h = \"3*t\", p = {}, s = { rpy = [0, \"t\", 0] } }\n";
    let with = |text: &str| format!("{}{motion}{text}{}", &TREE[..start], &TREE[end..]);
    let state = plan(&with(joints)).system().state(0.5).unwrap();
    assert_eq!(state.q[..8], [0.5, 0.25, 0.05, 0.0, 1.5, 0.0, 0.0, 0.0]);
    assert_eq!(state.v, [1.0, 1.0, 0.1, 0.0, 3.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    assert!((state.q[9] - 0.25f64.sin()).abs() < 1e-15, "half of the turn about y");
    // From a file: a column for each coordinate, roll, pitch and yaw of the spherical joint.
    let folder = tempfile::tempdir().unwrap();
    let mut text = "t,u.first,u.second,c.z,c.rz,h,p.x,p.y,p.rz,s.roll,s.pitch,s.yaw\n".to_owned();
    for k in 0..=100 {
        let t = 0.01 * f64::from(k);
        text += &format!("{t},{t},{},{},0,{},0,0,0,0,{t},0\n", t * t, 0.1 * t, 3.0 * t);
    }
    std::fs::write(folder.path().join("all.csv"), &text).unwrap();
    let read = |text: String| Scenario::parse(&text, "a.toml", folder.path()).unwrap().cases(&catalog());
    let again = read(with("csv = \"all.csv\"\n")).unwrap().plan(0).unwrap().system().state(0.5).unwrap();
    for (a, b) in again.q.iter().chain(&again.v).zip(state.q.iter().chain(&state.v)) {
        assert!((a - b).abs() < 1e-9, "{:?} {:?}", again.q, state.q);
    }
    std::fs::write(folder.path().join("all.csv"), text.replace("s.yaw", "yaw")).unwrap();
    let refused = read(with("csv = \"all.csv\"\n")).map(|cases| cases.len()).unwrap_err().to_string();
    assert!(refused.contains("leaves out the columns s.yaw"), "{refused}");
}

#[test]
fn controllers_drive_every_coordinate() {
    let start = TREE.find("start = ").unwrap();
    let end = TREE.find("[time]").unwrap();
    let with = |controller: &str| {
        format!(
            "{}locked = [\"s\"]\n[motion.controller]\nkind = \"pd-gravity\"\n{controller}\n{}",
            &TREE[..start],
            &TREE[end..]
        )
    };
    let reference = "reference = { kind = \"joints\", u = { first = \"0.1*t\", second = 0 }, c = 0, h = 1, p = 0 }";
    let by_part = plan(&with(&format!(
        "kp = {{ u = 80, c = {{ z = \"500 N/m\", rz = 3 }} }}\n{reference}\nlimits = {{ u = {{ second = 4 }}, p = 7 }}"
    )));
    let record = by_part.resolved();
    let controller = &record["motion"]["controller"];
    let kp = serde_json::json!({
        "u.first": 80.0, "u.second": 80.0, "c.z": 500.0, "c.rz": 3.0, "h": 0.0, "p.x": 0.0, "p.y": 0.0, "p.rz": 0.0,
    });
    assert_eq!(controller["kp"], kp);
    assert_eq!(controller["limits"], serde_json::json!({ "u.second": 4.0, "p.x": 7.0, "p.y": 7.0, "p.rz": 7.0 }));
    let to = with("kp = 1\nreference = { kind = \"move\", to = { u = { first = 0.5 } }, duration = 1 }");
    assert_eq!(plan(&to).resolved()["motion"]["controller"]["reference"]["to"], serde_json::json!({ "u.first": 0.5 }));
    let wrong = refusals(&with(&format!("kp = {{ u = {{ frist = 1 }} }}\n{reference}"))).to_string();
    assert!(
        wrong.contains("unknown key `frist` in `u` of `kp` of [motion.controller]") && wrong.contains("`first`"),
        "{wrong}"
    );
    let missing = refusals(&with("kp = 1\nreference = { kind = \"joints\", u = { first = 0 }, c = 0, h = 1, p = 0 }"))
        .to_string();
    assert!(missing.contains("has no signal for u.second"), "{missing}");
}

#[test]
fn what_is_wrong_with_a_joint_is_refused_with_its_place() {
    let helical = "lead = \"5 mm\"";
    let second = "axis2 = [0, 1, 0]";
    let mimic = "joint = \"h\", multiplier = -2, offset = \"10 deg\"";
    assert_all_refused(
        TREE,
        &[
            (
                &[(helical, "lead = ‸\"5 mm/rad\"")],
                BadQuantity,
                "is \"5 mm/rad\", the advance in an angle, but `lead` is that in a whole turn, a length\n  help: write the advance in each turn: lead = \"0.031415926535897934 m\"",
            ),
            (&[(helical, "lead = ‸1e300")], OutOfRange, "outside ±1e9 m"),
            (
                &[("damping = { z = \"20 N*s/m\", rz = \"0.1 N*m*s/rad\" }", "damping = ‸\"20 N*s/m\"")],
                BadQuantity,
                "one unit does not fit both\n  help: write { z = …, rz = … }, each in its unit",
            ),
            (
                &[(mimic, "joint = ‸\"c.wz\"")],
                UnknownName,
                "no coordinate of \"c\" that a joint can follow: the joint is cylindrical\n  help: did you mean `c.rz`?",
            ),
            (
                &[(mimic, "joint = ‸\"s.qx\"")],
                UnknownName,
                "the joint is spherical\n  help: follow a joint that has one coordinate",
            ),
            (&[(helical, "lead = ‸0")], OutOfRange, "is 0, but a helical joint advances by its lead in each turn"),
            (
                &[("joint = { name = \"h\"", "joint = ‸{ name = \"h\""), (&format!("{helical}, "), "")],
                Missing,
                "has no `lead`",
            ),
            (
                &[("joint = { name = \"u\"", "joint = ‸{ name = \"u\""), (&format!("{second}, "), "")],
                Missing,
                "has no `axis2`",
            ),
            (&[(second, "axis2 = ‸[-2, 0, 0]")], Rule, "axis2 of joint \"u\" is parallel to its axis"),
            (&[(second, "axis2 = ‸[0, 0, 0]")], OutOfRange, "which has no direction"),
            (
                &[("kind = \"spherical\"", "kind = \"spherical\", ‸axis = [0, 0, 1]")],
                Rule,
                "a spherical joint turns freely about its origin",
            ),
            (
                &[("kind = \"planar\"", "kind = \"planar\", ‸lead = 1")],
                Rule,
                "`lead` of the joint of body \"plate\" has no meaning: a planar joint",
            ),
            (&[("kind = \"planar\"", "kind = \"planar\", ‸axis2 = [1, 0, 0]")], Rule, "has no meaning: a planar joint"),
            (&[("kind = \"spherical\"", "kind = \"spherical\", ‸armature = 1")], Rule, "has no meaning"),
            (&[("kind = \"cylindrical\"", "kind = ‸\"cylindric\"")], UnknownName, "did you mean `cylindrical`?"),
            (&[("kind = \"planar\"", "kind = ‸\"plane\"")], UnknownName, "`planar`"),
            (&[("damping = { first = 0.5 }", "damping = { ‸frist = 0.5 }")], UnknownKey, "`first`"),
            (&[("rz = \"0.1 N*m*s/rad\"", "rz = \"0.1 ‸N*s/m\"")], BadQuantity, "this place takes `N*m*s/rad`"),
            (
                &[("damping = { z = \"20 N*s/m\"", "damping = { z = ‸-1")],
                Rule,
                "joint.damping of body \"sleeve\" is -1; it must be 0 or more",
            ),
            (&[("rz = \"2 g*m^2\"", "rz = \"2 ‸kg\"")], BadQuantity, "this place takes `kg*m^2`"),
            (&[("lower = { z = \"-10 cm\" }", "lower = ‸{ z = \"40 cm\" }")], Rule, "is 0.4 for z, above `upper`, 0.3"),
            (&[("velocity = 20", "velocity = ‸0")], OutOfRange, "must be positive"),
            (&[("effort = \"3 N*m\"", "‸limits = 3")], UnknownKey, "said by `lower`, `upper`, `velocity` and `effort`"),
            (
                &[(mimic, "joint = ‸\"c\"")],
                Rule,
                "is \"c\", which is cylindrical: a joint follows one coordinate\n  help: write one of \"c.z\", \"c.rz\"",
            ),
            (&[(mimic, "joint = ‸\"s\"")], Rule, "is \"s\", which is spherical"),
            (&[(mimic, "joint = ‸\"hh\"")], UnknownName, "names no joint"),
            (&[(mimic, "joint = \"c.z\", multiplier = \"2 ‸m/rad\"")], BadQuantity, "this place takes `rad/m`"),
            (
                &[("kind = \"planar\"", "kind = \"planar\", ‸mimic = { joint = \"h\" }")],
                Rule,
                "`mimic` of the joint of body \"plate\" has no meaning",
            ),
            (&[("u = { second = 0.2 }", "u = ‸0.2")], WrongType, "must be a table"),
            (&[("u = { second = 0.2 }", "u = { ‸secnd = 0.2 }")], UnknownKey, "did you mean `second`?"),
            (
                &[("u = { second = 0.2 }", "‸\"u.second\" = 0.2")],
                Rule,
                "is a coordinate of joint \"u\": write u = { second = … }",
            ),
            (&[("c = { wz = 3 }", "c = { ‸rz = 3 }")], UnknownKey, "unknown key `rz`"),
            (
                &[("s = { rpy = [0, 0, \"90 deg\"] }", "s = { ‸x = 1 }")],
                Rule,
                "a spherical joint turns freely about its origin",
            ),
            (&[("s = { wy = 1 }", "s = { ‸vx = 1 }")], Rule, "a spherical joint turns freely"),
            (&[("locked = [\"u\"]", "locked = [‸\"uu\"]")], UnknownName, "names no joint: \"uu\""),
        ],
    );
}

#[test]
fn one_cause_is_told_once() {
    let said = refusals(&edited(TREE, &[("lower = { z", "mimic = { joint = \"h\" }, lower = { z")]));
    assert_eq!(said.len(), 1, "{said}");
    assert!(said.to_string().contains("`mimic` of the joint of body \"sleeve\" has no meaning"), "{said}");
}

#[test]
fn an_element_on_a_joint_of_several_names_one_coordinate() {
    let with = |joint: &str| {
        format!("{TREE}[[element]]\nname = \"e\"\njoint = {joint}\nlaw = \"spring\"\nparameters = {{ k = 1 }}\n")
    };
    assert!(plan(&with("\"c.rz\"")).elements[0].element.measure.is_rotation());
    assert!(!plan(&with("\"c.z\"")).elements[0].element.measure.is_rotation());
    let refused = refusals(&with("\"c\"")).to_string();
    assert!(refused.contains("joint \"c\" is cylindrical and has 2 coordinates: name one of c.z, c.rz"), "{refused}");
    let refused = refusals(&with("\"c.zz\"")).to_string();
    assert!(refused.contains("names no joint: \"c.zz\"") && refused.contains("c.z"), "{refused}");
    let refused = refusals(&with("\"s\"")).to_string();
    assert!(refused.contains("joint \"s\" is spherical"), "{refused}");
    let refused = refusals(&with("\"s.qx\"")).to_string();
    assert!(refused.contains("is \"s.qx\", but joint \"s\" is spherical"), "{refused}");
}

#[test]
fn feedback_sees_joints_that_turn_freely() {
    let sees = |torque: &str| edited(TREE, &[("s = { wx = \"0.1*t\" }", &format!("s = {{ wx = {torque} }}"))]);
    for torque in ["\"-0.5*v.s.wx\"", "{ expression = \"-q.s.qx - a.s.wy\", unit = \"N*m\", sample = \"10 ms\" }"] {
        plan(&sees(torque));
    }
    assert_all_refused(
        TREE,
        &[
            (
                &[("s = { wx = \"0.1*t\" }", "s = { wx = \"-‸q.s.qx\" }")],
                Rule,
                "q.s.qx changes its sign where the joint is half a turn away from 0\n  help: sample it",
            ),
            (&[("s = { wx = \"0.1*t\" }", "s = { wx = \"-‸a.s.wx\" }")], Rule, "follows from the forces"),
            (
                &[("s = { wx = \"0.1*t\" }", "s = { wx = \"-‸v.c\" }")],
                BadQuantity,
                "unknown name `v.c`\n  help: write one of `v.c.vz`, `v.c.wz`",
            ),
            (
                &[("[time]", "[[event]]\nname = \"x\"\nwhen = \"‸q.c - 0.1\"\n\n[time]")],
                BadQuantity,
                "unknown name `q.c`\n  help: write one of `q.c.z`, `q.c.rz`",
            ),
        ],
    );
}

#[test]
fn end_stops_take_the_limits_of_a_scenario() {
    let stops = plan(&format!("[robot]\nlimits = {{ stiffness = 1e4 }}\n{TREE}")).system();
    assert_eq!(stops.elements.len(), 1);
    let none = edited(TREE, &[(", lower = { z = \"-10 cm\" }, upper = { z = 0.3 }", "")]);
    let refused = refusals(&format!("[robot]\nlimits = {{ stiffness = 1e4 }}\n{none}")).to_string();
    assert!(refused.contains("no joint of the robot has a smallest or largest coordinate"), "{refused}");
}

const ARM: &str = r#"<robot name="arm">
  <link name="base"/>
  <link name="slab"><inertial><mass value="2"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="nut"><inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="bob"><inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="table" type="planar"><parent link="base"/><child link="slab"/><axis xyz="0 0 1"/></joint>
  <joint name="j5" type="revolute"><parent link="slab"/><child link="nut"/><origin xyz="0 0 0.1" rpy="0 0.3 0"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="5" velocity="3"/><dynamics damping="0.2"/></joint>
  <joint name="hip" type="ball"><parent link="nut"/><child link="bob"/></joint>
</robot>"#;

#[test]
fn joints_of_a_urdf_file_get_other_kinds_and_rotors() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("arm.urdf"), ARM).unwrap();
    let read = |joints: &str| {
        let text = format!(
            "[robot]\nurdf = \"arm.urdf\"\n{joints}\n[motion]\nkind = \"forward\"\n[time]\nend = 1\noutput_step = 0.1\n"
        );
        Scenario::parse(&text, "a.toml", folder.path()).unwrap().cases(&catalog())
    };
    let names = |joints: &str| -> String {
        let plan = read(joints).unwrap_or_else(|refusals| panic!("{refusals}")).plan(0).unwrap();
        plan.model.q_labels().into_iter().map(|label| label.name).collect::<Vec<_>>().join(" ")
    };
    let free = "hip.qx hip.qy hip.qz hip.qw";
    assert_eq!(names(""), format!("table.x table.y table.rz j5 {free}"));
    let screw = "[[robot.joint]]\nname = \"j5\"\nkind = \"helical\"\nlead = \"5 mm\"\narmature = \"1e-4 kg*m^2\"\n";
    let plan = read(screw).unwrap().plan(0).unwrap();
    assert_eq!((plan.model.rotors()[3], plan.model.damping()[3], plan.model.limits(3).upper), (1e-4, 0.2, 1.0));
    assert_eq!(plan.bodies[1].joint.lead, 0.005);
    let sleeve = "[[robot.joint]]\nname = \"j5\"\nkind = \"cylindrical\"\narmature = { rz = 2 }\n";
    assert_eq!(names(sleeve), format!("table.x table.y table.rz j5.z j5.rz {free}"));
    let refused = |joints: &str| read(joints).map(|cases| cases.len()).unwrap_err().to_string();
    let cases = [
        ("name = \"j4\"", "names no joint of the file: \"j4\"\n  help: there is table, j5 and hip"),
        ("name = \"j5\"\nkind = \"helical\"", "has no `lead`"),
        ("name = \"j5\"\nkind = \"helical\"\nlead = 0", "a helical joint advances by its lead"),
        ("name = \"j5\"\nkind = \"universal\"\naxis2 = [0, 2, 0]", "axis2 of joint \"j5\" is parallel to its axis"),
        (
            "name = \"j5\"\nlead = 1",
            "`lead` of [[robot.joint]] \"j5\" has no meaning: a revolute joint turns about its axis",
        ),
        ("name = \"hip\"\nkind = \"revolute\"", "but the joint is spherical in the file and has no axis"),
        ("name = \"j5\"\naxis = [1, 0, 0]", "unknown key `axis`"),
        ("name = \"j5\"\nkind = \"screw\"", "which is no kind of joint"),
        ("name = \"j5\"\narmature = -1", "a.toml:5:12: joint.armature of body \"nut\" is -1; it must be 0 or more"),
        (
            "name = \"j5\"\nkind = \"universal\"\naxis2 = [0, 2, 0]",
            "a.toml:6:9: the axis2 of joint \"j5\" is parallel to its axis",
        ),
        ("armature = 1", "has no `name`"),
        ("name = \"j5\"\n[[robot.joint]]\nname = \"j5\"", "which is taken on line 4"),
    ];
    for (joint, words) in cases {
        let said = refused(&format!("[[robot.joint]]\n{joint}\n"));
        assert!(said.contains(words), "{joint}: {said}");
    }
    let bodies = refusals(&format!("[[robot.joint]]\nname = \"u\"\n{TREE}")).to_string();
    assert!(bodies.contains("`joint` of [robot] belongs to `urdf`"), "{bodies}");
}
