//! Limits of joints as end stops, as a user meets them.

use crate::support::Place;

const PENDULUM: &str = r#"<robot name="pendulum">
  <link name="base"/>
  <link name="arm">
    <inertial><origin xyz="0.2 0 0"/><mass value="2"/><inertia ixx="0.01" iyy="0.05" izz="0.05" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <joint name="q1" type="revolute">
    <parent link="base"/><child link="arm"/><axis xyz="0 1 0"/><limit lower="-0.1" upper="0.3" velocity="50" effort="50"/>
  </joint>
</robot>
"#;

const FALLING: &str = "robot = { urdf = \"arm.urdf\", limits = { stiffness = 1e4, damping = 10 } }\nmotion = { kind = \"forward\" }\n\
                       time = { end = \"3 s\", output_step = \"10 ms\" }\nsolver = { rtol = 1e-8 }\n";

#[test]
fn a_pendulum_lies_on_the_limit_of_its_joint() {
    let place = Place::with(FALLING);
    place.write("arm.urdf", PENDULUM);
    place.done(&["run", "arm.toml", "--out", "o"]);
    let rows = place.table("o/results.csv");
    let last = |column: &str| *rows.numbers(column).last().unwrap();
    // 2 kg at 0.2 m on 1e4 N·m/rad.
    let excess = 2.0 * 9.81 * 0.2 * 0.3f64.cos() / 1e4;
    assert!(
        (last("q.q1") - 0.3 - excess).abs() < 1e-5 && last("v.q1").abs() < 1e-3,
        "{} {}",
        last("q.q1"),
        last("v.q1")
    );
    assert!(rows.header.iter().all(|name| !name.contains("ends")) && last("energy.joints") > 1.0);
    let record = place.record("o");
    let share = record["energy_residual"].as_f64().unwrap() / record["energy_turned_over"].as_f64().unwrap();
    assert!(share <= 1e-7, "{share:e}");
    assert_eq!(record["plan"]["limits"], serde_json::json!({ "stiffness": 1e4, "damping": 10.0 }));

    // Its hysteresis, sampled beyond the limit, and a sweep.
    let sweep = ["run", "arm.toml", "--out", "s", "--sweep", "robot.limits.damping=0,10"];
    place.done(&sweep);
    assert_eq!(place.record("s")["cases_done"], 2);
}

#[test]
fn what_is_refused() {
    let place = Place::with(FALLING);
    place.write("arm.urdf", PENDULUM);
    for (set, words) in [
        ("robot.limits.stiffness=0", "`stiffness` of `limits` of [robot]"),
        ("robot.limits.damping=-1", "`damping` of `limits` of [robot]"),
        ("robot.limits.stiffness=\"3 N/m\"", "`stiffness` of `limits` of [robot]"),
        ("robot.limits.mass=3", "unknown key `mass`"),
        ("robot.limits=3", "must be a table"),
    ] {
        let refused = place.springpot(&["check", "arm.toml", "--set", set]);
        assert_eq!(refused.code, Some(2), "{set}: {}", refused.stdout);
        assert!(refused.stderr.contains(words), "{set}: {}", refused.stderr);
    }
    place.write("arm.urdf", PENDULUM.replace("type=\"revolute\"", "type=\"continuous\""));
    let refused = place.springpot(&["check", "arm.toml"]);
    assert!(refused.code == Some(2) && refused.stderr.contains("no joint of the robot has"), "{}", refused.stderr);
}
