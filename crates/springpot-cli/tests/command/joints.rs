//! Joints of several coordinates as a user meets them: one scenario through every door.

use crate::support::Place;
use serde_json::Value;

/// The scenario of docs/how-to/joints.md.
fn spindle() -> String {
    let page = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/how-to/joints.md")).unwrap();
    let (_, text) = page.split_once("```toml file=spindle.toml\n").unwrap();
    text.split_once("```").unwrap().0.to_owned()
}

const EVENTS: &str = r#"
[[event]]
name = "turned"
when = "q.c.rz - 0.1"
action = "record"
"#;

#[test]
fn one_scenario_through_every_door() {
    let place = Place::new();
    let torque = "torque = { screw = \"5e-3*sin(3*t)\" }";
    let feedback = "torque = { screw = \"5e-3*sin(3*t) - 0.01*v.screw\", c = { wz = \"-0.05*(q.c.rz - q.u.first)\" } }";
    let text = spindle();
    assert!(text.contains(torque));
    place.write("s.toml", text.replace(torque, feedback).replace("end = \"2 s\"", "end = \"0.5 s\"") + EVENTS);
    let says = |arguments: &[&str], words: &[&str]| {
        let said = place.done(arguments).stdout;
        assert!(words.iter().all(|words| said.contains(words)), "{arguments:?}: {said}");
    };
    says(&["check", "s.toml"], &["4 bodies; 4 joints: u, screw, c, ball", "on joint c.z", "dy/dq = c.vz: 1"]);
    let kinds = "1 helical, 1 cylindrical, 1 universal, 1 spherical; nq = 9, nv = 8";
    says(&["info", "s.toml"], &[kinds, "x, then y", "z, 0.02 m per turn", "kg·m² or kg"]);
    let told: Value = serde_json::from_str(&place.done(&["info", "s.toml", "--json"]).stdout).unwrap();
    assert_eq!(told["joints"].as_array().unwrap().len(), 4);
    assert_eq!(
        (&told["joints"][2]["q"], &told["joints"][1]["lead"]),
        (&serde_json::json!([3, 4]), &serde_json::json!(0.02))
    );
    place.done(&["run", "s.toml", "--out", "out"]);
    let rows = place.read("out/results.csv");
    for column in ["q.u.first", "q.c.rz", "v.c.wz", "tau.c.wz", "q.ball.qw", "v.ball.wx", "spring.Q.c.vz"] {
        assert!(rows.lines().next().unwrap().split(',').any(|name| name == column), "{column}");
    }
    // Recorded to the moment.
    let events = place.read("out/events.csv");
    let names: Vec<&str> = events.lines().next().unwrap().split(',').collect();
    let at = names.iter().position(|name| *name == "q.c.rz").unwrap();
    let angle: f64 = events.lines().nth(1).unwrap().split(',').nth(at).unwrap().parse().unwrap();
    assert!((angle - 0.1).abs() < 1e-9, "{angle}");
    for file in ["out.glb", "out.mcap"] {
        place.done(&["export", "out", file]);
    }
    place.done(&["view", "out", "--out", "page.html"]);
    assert!(place.read("page.html").contains("\"kind\":\"helical\""));
    place.done(&["report", "out", "--out", "report.html"]);
    place.done(&["dynamics", "s.toml", "--at", "0"]);
    // The balance closes in steps of one size too.
    place.done(&[
        "run",
        "s.toml",
        "--out",
        "fixed",
        "-q",
        "--no-figures",
        "--set",
        "solver.method=midpoint",
        "--set",
        "solver.step=0.5 ms",
    ]);
    place
        .springpot(&[
            "run",
            "s.toml",
            "--out",
            "far",
            "-q",
            "--no-figures",
            "--set",
            "robot.body.frame.joint.upper={ first = 0.2 }",
        ])
        .ends(0, &["joint \"u.first\" passes its upper limit 0.2 rad at t = 0 s"]);
}

#[test]
fn a_sweep_of_a_rotor_and_of_a_coordinate() {
    let place = Place::new();
    place.write("s.toml", spindle().replace("end = \"2 s\"", "end = \"0.1 s\""));
    for path in [
        "robot.body.spindle.joint.armature",
        "robot.body.spindle.joint.lead",
        "robot.body.sleeve.joint.damping.z",
        "motion.start.q.u.first",
    ] {
        place.done(&["run", "s.toml", "--out", "swept", "-q", "--no-figures", "--sweep", &format!("{path}=0.01,0.02")]);
        assert!(place.read("swept/results.csv").contains(path), "{path}");
        std::fs::remove_dir_all(place.path("swept")).unwrap();
    }
    place
        .springpot(&["check", "s.toml", "--set", "robot.body.spindle.joint.lead=0"])
        .ends(2, &["`lead`", "a helical joint advances by its lead in each turn"]);
    place.springpot(&["check", "s.toml", "--set", "element.spring.joint=c"]).ends(2, &["name one of c.z, c.rz"]);
}

#[test]
fn a_starter_of_a_urdf_with_a_table_and_a_ball() {
    let place = Place::new();
    let inertial = "<inertial><mass value=\"1\"/><origin xyz=\"0.1 0 0\"/><inertia ixx=\"0.1\" iyy=\"0.1\" izz=\"0.1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>";
    let urdf = format!(
        "<robot name=\"arm\"><link name=\"base\"/><link name=\"slab\">{inertial}</link><link name=\"nut\">{inertial}</link><link name=\"bob\">{inertial}</link>\n\
         <joint name=\"table\" type=\"planar\"><parent link=\"base\"/><child link=\"slab\"/><axis xyz=\"0 0 1\"/></joint>\n\
         <joint name=\"j5\" type=\"revolute\"><parent link=\"slab\"/><child link=\"nut\"/><origin xyz=\"0 0 0.1\"/><axis xyz=\"0 1 0\"/><limit lower=\"-1\" upper=\"1\" effort=\"5\" velocity=\"30\"/></joint>\n\
         <joint name=\"hip\" type=\"ball\"><parent link=\"nut\"/><child link=\"bob\"/><origin xyz=\"0.3 0 0\"/></joint></robot>\n"
    );
    place.write("arm.urdf", urdf);
    for (file, more) in [("moved.toml", &[][..]), ("free.toml", &["--forward"])] {
        place.done(&[&["init", "arm.urdf", "--out", file], more].concat());
        assert!(place.read(file).contains("table = { x = "), "{}", place.read(file));
        place.done(&["run", file, "--out", &format!("{file}.out"), "--no-figures", "-q"]);
    }
    place.write("states.json", "{\"joints\": [\"hip\", \"j5\", \"table.rz\", \"table.x\", \"table.y\"], \"states\": [{\"q\": [0,0,0,2,0.1,0,0,0], \"v\": [1,0,0,1,0,0,0], \"a\": [0,0,0,0,0,0,0], \"tau\": [0,0,0,0,0,0,0]}]}\n");
    place
        .springpot(&["dynamics", "arm.urdf", "--states", "states.json"])
        .ends(0, &["quaternion of hip in states[0] has the length 2"]);
}
