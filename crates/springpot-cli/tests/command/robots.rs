//! Robots from URDF files as a user meets them: warnings, limits, records, sketches.

use crate::support::{ARM, Ended, Place};
use serde_json::{Value, json};

/// A crane that floats or stands: a mast that turns, a jib that lifts, a pulley that follows it, a hook welded on.
const CRANE: &str = r#"<robot name="crane">
  <link name="dock"><inertial><mass value="20"/>
    <inertia ixx="2" ixy="0" ixz="0" iyy="2" iyz="0" izz="2"/></inertial></link>
  <link name="mast"><inertial><mass value="5"/><origin xyz="0 0 0.5"/>
    <inertia ixx="0.4" ixy="0" ixz="0" iyy="0.4" iyz="0" izz="0.02"/></inertial></link>
  <link name="jib"><inertial><mass value="2"/><origin xyz="0.4 0 0"/>
    <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
  <link name="pulley"><inertial><mass value="0.1"/>
    <inertia ixx="1e-4" ixy="0" ixz="0" iyy="1e-4" iyz="0" izz="1e-4"/></inertial></link>
  <link name="hook"/>
  <joint name="slew" type="continuous"><parent link="dock"/><child link="mast"/><origin xyz="0 0 0.2"/><axis xyz="0 0 1"/>
    <limit effort="50" velocity="1"/></joint>
  <joint name="luff" type="revolute"><parent link="mast"/><child link="jib"/><origin xyz="0 0 1"/><axis xyz="0 -1 0"/>
    <limit lower="-0.5" upper="0.5" effort="30" velocity="2"/></joint>
  <joint name="reel" type="continuous"><parent link="jib"/><child link="pulley"/><origin xyz="0.8 0 0"/><axis xyz="0 1 0"/>
    <mimic joint="luff" multiplier="4"/></joint>
  <joint name="weld" type="fixed"><parent link="jib"/><child link="hook"/><origin xyz="0.9 0 -0.1"/></joint>
  <transmission name="motor"/>
</robot>
"#;

const SCENARIO: &str = r#"title = "Crane"
[robot]
urdf = "crane.urdf"
[robot.gripper]
body = "hook"
point = [0, 0, 0]
[[element]]
name = "stay"
from = { body = "dock", point = [0.5, 0, 0.2] }
to = { body = "jib", point = [0.4, 0, 0] }
rest_length = "95 cm"
law = "kelvin-voigt"
parameters = { k = 200, c = 20 }
[motion]
kind = "prescribed"
joints = { slew = "0.4*t", luff = "0.3*sin(3*t)" }
[time]
end = 2
output_step = 0.02
"#;

fn place() -> Place {
    let place = Place::with(ARM);
    place.write("crane.urdf", CRANE);
    place.write("crane.toml", SCENARIO);
    place
}

/// The warnings on stderr, without what helps.
fn warnings(ended: &Ended) -> Vec<&str> {
    ended.stderr.lines().filter_map(|line| line.strip_prefix("warning: ")).collect()
}

/// A link of mass and inertia 1.
fn link(name: &str) -> String {
    format!(
        "<link name=\"{name}\"><inertial><mass value=\"1\"/>\
         <inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial></link>"
    )
}

const UNUSED: &str = "crane.urdf: not used: 1 <transmission>";

#[test]
fn what_a_urdf_holds_and_nobody_uses_is_said() {
    let place = place();
    for arguments in [
        &["run", "crane.toml"][..],
        &["check", "crane.toml"],
        &["run", "-q", "crane.toml"],
        &["check", "-q", "crane.toml"],
    ] {
        let ended = place.done(arguments);
        assert_eq!(warnings(&ended), [UNUSED], "{arguments:?}");
    }
    let record = place.record("results/crane");
    assert_eq!(record["warnings"], json!([UNUSED]));
    assert_eq!(record["limits"], json!([]));
    // Nothing of the kind for robots of bodies.
    place.done(&["run", "arm.toml"]);
    let record = place.record("results/arm");
    assert_eq!(
        (&record["warnings"], &record["limits"], &record["plan"]["urdf"]),
        (&json!([]), &json!([]), &Value::Null)
    );
}

#[test]
fn check_says_where_the_robot_comes_from() {
    let place = place();
    let said = place.done(&["check", "crane.toml"]).stdout;
    let robot = "\
robot     crane.urdf, fixed base, 5 links; 3 joints: slew, luff, reel
          reel follows 4 times luff
";
    assert!(said.contains(robot), "{said}");
    assert!(said.contains("dl/dq = slew: 0, luff: 0.398"), "{said}");
    let floating =
        ["check", "crane.toml", "--set", "robot.floating_base=true", "--set", "motion.joints.floating_base={}"];
    let world = ["--set", "element.stay.from.body=world"];
    let said = place.done(&[&floating[..], &world].concat()).stdout;
    let robot = "\
robot     crane.urdf, floating base, 5 links; 4 joints: floating_base, slew,
          luff, reel
";
    assert!(said.contains(robot), "{said}");
    // Of eight velocities those that lengthen the element.
    let gradient = "\
          dl/dq = floating_base.vx: -0.0995037, floating_base.vz: 0.995037,
          floating_base.wy: -0.517419, luff: 0.398015, others 0
";
    assert!(said.contains(gradient), "{said}");
}

#[test]
fn joints_beyond_their_limits_are_warned_of_once_each() {
    let place = place();
    let arguments = ["crane.toml", "--set", "motion.joints.luff=0.6*cos(3*t)"];
    let ended = place.done(&[&["run"], &arguments[..]].concat());
    let said = warnings(&ended);
    assert_eq!(
        said[..3],
        [
            UNUSED,
            "element \"stay\" starts with a stroke of 0.28757 m, more than 20 % of its rest length 0.95 m",
            "joint \"luff\" passes its lower limit -0.5 rad at t = 0.86 s, by up to 0.0998601 rad at t = 1.04 s"
        ]
    );
    assert_eq!(said[3], "joint \"luff\" passes its upper limit 0.5 rad at t = 0 s, by 0.1 rad");
    assert_eq!(said.len(), 4, "{said:?}");
    let record = place.record("results/crane");
    let upper = json!({
        "joint": "luff", "kind": "upper", "limit": 0.5, "unit": "rad", "first": 0.0, "farthest": 0.0, "value": 0.6,
    });
    assert_eq!(record["cases"][0]["limits"][1], upper);
    let [lower, over_cases] = &record["limits"].as_array().unwrap()[..] else { panic!("two limits") };
    assert_eq!((&lower["kind"], &lower["case"], &lower["cases"]), (&json!("lower"), &json!(0), &json!(1)));
    assert!(upper.as_object().unwrap().iter().all(|(key, value)| over_cases[key] == *value));

    // Before the run, what is beyond at the start.
    let checked = place.done(&[&["check"], &arguments[..]].concat());
    assert_eq!(warnings(&checked)[2..], [said[3]]);
    // Velocities, and what the actuators give for the element's force at the start.
    let hard = ["check", "crane.toml", "--set", "motion.joints.slew=1.5*t", "--set", "element.stay.k=20 kN/m"];
    let checked = place.done(&hard);
    let said = warnings(&checked);
    assert_eq!(said[1], "joint \"slew\" passes its velocity limit 1 rad/s at t = 0 s, by 0.5 rad/s");
    assert!(said[2].starts_with("joint \"luff\" passes its effort limit 30 N*m at t = 0 s, by "), "{said:?}");
    let ran = place.done(&[&["run"], &hard[1..]].concat());
    let record = place.record("results/crane");
    let efforts = place.table("results/crane/results.csv").numbers("tau.luff");
    let effort = record["limits"]
        .as_array()
        .unwrap()
        .iter()
        .find(|limit| [&limit["joint"], &limit["kind"]] == ["luff", "effort"])
        .unwrap();
    let largest = efforts.iter().fold(0.0f64, |most, tau| if tau.abs() > f64::abs(most) { *tau } else { most });
    assert_eq!((&effort["first"], effort["value"].as_f64()), (&json!(0.0), Some(largest)), "{}", ran.stderr);
    // A singular start has no actuator force that could be too large.
    let law = SCENARIO.replace(
        "law = \"kelvin-voigt\"\nparameters = { k = 200, c = 20 }",
        "law = \"springpot\"\nderivative = \"riemann-liouville\"\nparameters = { c = 20000, alpha = 0.5 }",
    );
    assert_ne!(law, SCENARIO);
    place.write("singular.toml", law);
    assert!(warnings(&place.done(&["check", "singular.toml"])).iter().all(|warning| !warning.contains("effort")));
}

#[test]
fn sweeps_say_which_cases_pass_a_limit() {
    let place = place();
    let sweep = "[[sweep]]\nparameter = \"motion.joints.luff\"\nvalues = [\"0.4*sin(3*t)\", \"0.52*sin(3*t)\", \"0.7*sin(3*t)\"]\n";
    place.write("crane.toml", format!("{SCENARIO}{sweep}"));
    let one = |jobs: &str| {
        let ended = place.done(&["run", "crane.toml", "--jobs", jobs]);
        (
            warnings(&ended).into_iter().map(str::to_owned).collect::<Vec<_>>(),
            place.record("results/crane")["limits"].clone(),
        )
    };
    let (said, limits) = one("1");
    assert_eq!(one("3"), (said.clone(), limits.clone()));
    assert!(
        said[1]
            .starts_with("motion.joints.luff = 0.52*sin(3*t) and 1 other case: joint \"luff\" passes its lower limit"),
        "{said:?}"
    );
    assert!(
        said[2]
            .starts_with("motion.joints.luff = 0.52*sin(3*t) and 1 other case: joint \"luff\" passes its upper limit")
    );
    assert!(
        said[3].starts_with(
            "motion.joints.luff = 0.7*sin(3*t): joint \"luff\" passes its velocity limit 2 rad/s at t = 0 s"
        )
    );
    assert_eq!(said.len(), 4);
    let cases: Vec<_> = limits
        .as_array()
        .unwrap()
        .iter()
        .map(|limit| [&limit["case"], &limit["cases"]].map(|n| n.as_u64().unwrap()))
        .collect();
    assert_eq!(cases, [[1, 2], [1, 2], [2, 1]]);
}

#[test]
fn many_limits_are_counted() {
    let place = place();
    let mut links = "<link name=\"l0\"/>".to_owned();
    for k in 1..=13 {
        links.push_str(&link(&format!("l{k}")));
        links.push_str(&format!(
            "<joint name=\"j{k}\" type=\"revolute\"><parent link=\"l{}\"/><child link=\"l{k}\"/><axis xyz=\"0 0 1\"/>\
             <limit lower=\"-1\" upper=\"1\" effort=\"1e9\" velocity=\"9\"/></joint>",
            k - 1
        ));
    }
    place.write("chain.urdf", format!("<robot name=\"chain\">{links}</robot>"));
    let joints: Vec<String> = (1..=13).map(|k| format!("j{k} = 1.5")).collect();
    let text = format!(
        "robot.urdf = \"chain.urdf\"\nmotion = {{ kind = \"prescribed\", joints = {{ {} }} }}\n\
         time = {{ end = 1, output_step = 0.5 }}\n",
        joints.join(", ")
    );
    place.write("chain.toml", text);
    let ran = place.done(&["run", "chain.toml"]);
    assert_eq!(warnings(&ran).len(), 11);
    assert_eq!(warnings(&ran)[10], "3 more limits of joints are passed; run.json says which");
    assert_eq!(place.record("results/chain")["limits"].as_array().unwrap().len(), 13);
    let checked = place.done(&["check", "chain.toml"]);
    assert_eq!(warnings(&checked)[10], "3 more limits of joints are passed at the start");
}

#[test]
fn a_broken_urdf_is_refused_at_the_line_that_names_it() {
    let place = place();
    place.write("crane.urdf", CRANE.replace("<mass value=\"5\"/>", "<mass value=\"five\"/>"));
    for command in ["run", "check"] {
        let ended = place.springpot(&[command, "crane.toml"]);
        assert_eq!(ended.code, Some(2));
        let first = ended.stderr.lines().next().unwrap();
        assert_eq!(
            first,
            "error: crane.toml:3:8: `urdf` of [robot] cannot be used: crane.urdf:4:44: value of <mass> of link \"mast\" holds \"five\", which is not a number"
        );
        assert!(ended.stderr.contains("urdf = \"crane.urdf\""), "{}", ended.stderr);
        assert!(!place.path("results").exists());
    }
}

/// The words of an SVG.
fn words(svg: &str) -> Vec<String> {
    svg.split("<text").skip(1).filter_map(|rest| Some(rest.split_once('>')?.1.split('<').next()?.to_owned())).collect()
}

#[test]
fn sketches_show_links_from_joint_to_joint() {
    let place = place();
    place.write("crane.toml", format!("{SCENARIO}[[figure]]\nkind = \"robot\"\nname = \"sketch\"\n"));
    place.done(&["run", "crane.toml"]);
    let svg = place.read("results/crane/figures/sketch.svg");
    let shown = words(&svg);
    for word in ["slew", "luff", "reel", "dock", "mast", "jib", "stay", "H"] {
        assert!(shown.iter().any(|shown| shown == word), "no {word} in {shown:?}");
    }
    // Fixed links and joints have no line and no name of their own.
    assert!(shown.iter().all(|word| word != "hook" && word != "weld"), "{shown:?}");
    const PLINTH: &str = "#d9d9d9";
    assert_eq!(svg.matches(PLINTH).count(), 2, "the base, and the anchor on the dock");

    // A robot that floats has no base; what floats is no joint to draw.
    let floating = ["--set", "robot.floating_base=true", "--set", "motion.joints.floating_base.z=0.5"];
    place.done(&[&["run", "crane.toml"], &floating[..]].concat());
    let svg = place.read("results/crane/figures/sketch.svg");
    assert!(words(&svg).iter().all(|word| word != "floating_base"));
    assert_eq!(svg.matches(PLINTH).count(), 0);
}

#[test]
fn robots_too_large_for_a_sketch_are_not_drawn() {
    let place = place();
    let body = |k: usize| {
        format!(
            "[[robot.body]]\nname = \"b{k}\"\nmass = 1\ncom = [0.1, 0, 0]\n\
             joint = {{ name = \"j{k}\", kind = \"fixed\", origin = [0.1, 0, 0] }}\n"
        )
    };
    let first = body(0).replace("kind = \"fixed\"", "kind = \"revolute\", axis = [0, 1, 0]");
    let rest = "motion = { kind = \"prescribed\", joints = { j0 = 0 } }\n";
    let figure = "time = { end = 1, output_step = 1 }\n[[figure]]\nkind = \"robot\"\nname = \"big\"\n";
    let bodies: String = std::iter::once(first).chain((1..1000).map(body)).collect();
    place.write("big.toml", format!("{rest}{figure}{bodies}"));
    let ended = place.done(&["run", "big.toml"]);
    let said = &ended.stderr;
    assert!(
        said.starts_with("warning: figure \"big\": no room for the names b") && said.ends_with(" more\n"),
        "{said}"
    );
    let links: String = (0..1001).map(|k| link(&format!("l{k}"))).collect();
    let joint = |k: usize| {
        let ends = format!("<parent link=\"l0\"/><child link=\"l{k}\"/><axis xyz=\"0 0 1\"/>");
        format!("<joint name=\"j{k}\" type=\"continuous\">{ends}</joint>")
    };
    let joints: String = (1..1001).map(joint).collect();
    place.write("hub.urdf", format!("<robot name=\"hub\">{links}{joints}</robot>"));
    let samples = |t: &str| format!("{t}{}\n", ",0".repeat(1000));
    let header: String = std::iter::once("t".to_owned()).chain((1..1001).map(|k| format!(",j{k}"))).collect();
    place.write("hub.csv", format!("{header}\n{}{}", samples("0"), samples("1")));
    let rest = "robot.urdf = \"hub.urdf\"\nmotion = { kind = \"prescribed\", csv = \"hub.csv\" }\n";
    place.write("hub.toml", format!("{rest}{figure}"));
    let ended = place.done(&["run", "hub.toml", "--set", "solver.max_step=0.5"]);
    assert!(
        ended.stderr.contains("figure \"big\" is not drawn: the robot has 1001 links (at most 1000 are drawn)"),
        "{}",
        ended.stderr
    );
}
