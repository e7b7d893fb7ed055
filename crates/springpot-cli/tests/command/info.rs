//! `springpot info`: robots as a reader and as a program see them.

use crate::support::{Place, testdata};
use serde_json::{Value, json};

fn urdf(name: &str) -> String {
    testdata(&format!("multibody/{name}.urdf"))
}

fn json_of(place: &Place, arguments: &[&str]) -> Value {
    let ended = place.done(&[&["info", "--json"], arguments].concat());
    assert_eq!(ended.stderr, "", "what was not used stands in the output");
    serde_json::from_str(&ended.stdout).unwrap()
}

#[test]
fn a_gripper_with_a_following_finger() {
    let place = Place::new();
    let ended = place.done(&["info", &urdf("panda")]);
    assert_eq!(ended.stderr, "");
    let expected = "\
robot     panda
joints    7 revolute, 2 prismatic, of which 1 follows another; nq = 8, nv = 8
mass      16.822 kg that moves, 0.62977 kg fixed to the world
gravity   (0, 0, -9.81) m/s²

joint                   link               kind       axis  mass, kg
                        panda_link0        world             0.62977
panda_joint1            panda_link1        revolute   z      4.9707
panda_joint2            panda_link2        revolute   z      0.64693
panda_joint3            panda_link3        revolute   z      3.2286
panda_joint4            panda_link4        revolute   z      3.5879
panda_joint5            panda_link5        revolute   z      1.2259
panda_joint6            panda_link6        revolute   z      1.6666
panda_joint7            panda_link7        revolute   z      1.4655
├─ panda_finger_joint1  panda_leftfinger   prismatic  y      0.015
└─ panda_finger_joint2  panda_rightfinger  prismatic  -y     0.015

joint                q  v     from       to       speed  effort  damping
panda_joint1         0  0  -2.8973   2.8973  rad  2.175      87    0.003
panda_joint2         1  1  -1.7628   1.7628  rad  2.175      87    0.003
panda_joint3         2  2  -2.8973   2.8973  rad  2.175      87    0.003
panda_joint4         3  3  -3.0718  -0.0698  rad  2.175      87    0.003
panda_joint5         4  4  -2.8973   2.8973  rad  2.61       12    0.003
panda_joint6         5  5  -0.0175   3.7525  rad  2.61       12    0.003
panda_joint7         6  6  -2.8973   2.8973  rad  2.61       12    0.003
panda_finger_joint1  7  7   0        0.04    m    0.2       100    0.3
panda_finger_joint2         0        0.04    m    0.2       100    0.3
speed in rad/s or m/s, effort in N·m or N, damping in N·m·s/rad or N·s/m

joints that follow others
  panda_finger_joint2 = panda_finger_joint1

links on fixed joints, behind what carries them
  panda_link7  panda_link8, panda_hand, panda_hand_tcp

not used or assumed
- ";
    assert!(ended.stdout.starts_with(expected), "{}", ended.stdout);
    assert!(ended.stdout.contains("\n- not used: 7 <safety_controller>\n"), "{}", ended.stdout);
    let free = place.done(&["info", &urdf("panda"), "--ignore-mimic"]).stdout;
    assert!(free.contains("joints    7 revolute, 2 prismatic; nq = 9, nv = 9\n"), "{free}");
    assert!(!free.contains("joints that follow") && free.contains("<mimic>"), "{free}");
}

#[test]
fn a_floating_humanoid() {
    let place = Place::new();
    let text = place.done(&["info", &urdf("simple_humanoid"), "--floating-base"]).stdout;
    for lines in [
        "joints    29 revolute, 1 floating; nq = 36, nv = 35\nmass      130.8 kg\n",
        "                       world\nfloating_base          base_link    floating            27\n\
         ├─ RLEG_HIP_R          RLEG_LINK1   revolute  x          2.5\n│  RLEG_HIP_P ",
        "└─ WAIST_P             WAIST_LINK1  revolute  y          6\n   WAIST_R ",
        "   ├─ RARM_SHOULDER_P  RARM_LINK1   revolute  y          3\n   │  RARM_SHOULDER_R ",
        "\nfloating_base    0-6  0-5\nRLEG_HIP_R         7    6  -0.3491  1.5708  rad   3.87     100\n",
        "links on fixed joints, behind what carries them\n  base_link  BODY\n",
    ] {
        assert!(text.contains(lines), "{lines}\nin\n{text}");
    }
    assert!(text.lines().all(|line| line.chars().count() <= 80 || line.contains("package://")), "{text}");
}

#[test]
fn bodies_of_a_scenario() {
    let place = Place::new();
    let expected = "\
robot     arm
joints    1 revolute, 1 prismatic; nq = 2, nv = 2
mass      2.5 kg
gravity   (0, 0, -9.81) m/s²
gripper   (0.1, 0, 0) m of slide

joint  link   kind       axis  mass, kg
       world
q1     arm    revolute   y          2
x      slide  prismatic  x          0.5

joint  q  v
q1     0  0  rad
x      1  1  m
";
    assert_eq!(place.done(&["info", "arm.toml"]).stdout, expected);
    // [robot] is enough, and may name a URDF file.
    std::fs::copy(urdf("solo12"), place.path("solo.urdf")).unwrap();
    place.write("solo.toml", "robot = { urdf = \"solo.urdf\", floating_base = true }\n");
    let text = place.done(&["info", "solo.toml"]).stdout;
    assert!(text.contains("joints    12 revolute, 1 floating; nq = 19, nv = 18\n"), "{text}");
}

#[test]
fn the_data_are_those_of_the_reference_to_the_bit() {
    let place = Place::new();
    let mut compared = 0;
    for (name, flags) in
        [("double_pendulum", &[][..]), ("ur5", &[]), ("panda", &["--ignore-mimic"]), ("simple_humanoid", &[])]
    {
        let info = json_of(&place, &[&[urdf(name).as_str()], flags].concat());
        let file = std::fs::read_to_string(testdata(&format!("multibody/{name}.json"))).unwrap();
        let reference: Value = serde_json::from_str(&file).unwrap();
        let model = &reference["model"];
        assert_eq!((&info["nq"], &info["nv"], &info["gravity"]), (&model["nq"], &model["nv"], &model["gravity"]));
        let joints = info["joints"].as_array().unwrap();
        assert_eq!(joints.len(), model["joints"].as_array().unwrap().len());
        for expected in model["joints"].as_array().unwrap() {
            let joint = joints.iter().find(|joint| joint["name"] == expected["name"]).unwrap();
            let kind = match expected["type"].as_str().unwrap() {
                "R" => ["revolute", "continuous"].as_slice(),
                _ => &["prismatic"],
            };
            assert!(kind.contains(&joint["kind"].as_str().unwrap()), "{joint}");
            let (mass, of_reference) = (joint["mass"].as_f64().unwrap(), expected["mass"].as_f64().unwrap());
            assert!((mass - of_reference).abs() <= 1e-15 * of_reference, "{}: {mass}", joint["name"]);
            assert_eq!(joint["q"].as_array().unwrap().len(), 1);
            compared += 1;
        }
    }
    assert_eq!(compared, 2 + 6 + 9 + 29);
}

#[test]
fn everything_is_in_the_data() {
    let place = Place::new();
    let panda = json_of(&place, &[&urdf("panda")]);
    let keys: Vec<&String> = panda.as_object().unwrap().keys().collect();
    assert_eq!(
        keys,
        [
            "base",
            "file",
            "fixed_mass",
            "frames",
            "gravity",
            "gripper",
            "joints",
            "links",
            "mass",
            "name",
            "nq",
            "nv",
            "q",
            "v",
            "warnings"
        ]
    );
    assert_eq!((&panda["base"], &panda["q"][7]), (&json!("panda_link0"), &json!("panda_finger_joint1")));
    let [.., leader, follower] = &panda["joints"].as_array().unwrap()[..] else { panic!("{panda}") };
    assert_eq!((&leader["q"], &leader["follows"]), (&json!([7]), &Value::Null));
    assert_eq!((&follower["q"], &follower["v"]), (&json!([]), &json!([])));
    assert_eq!(follower["follows"], json!({ "joint": "panda_finger_joint1", "multiplier": 1.0, "offset": 0.0 }));
    assert_eq!(leader["limits"], json!({ "lower": 0.0, "upper": 0.04, "velocity": 0.2, "effort": 100.0 }));
    assert_eq!(
        (&leader["damping"], &leader["parent"], &leader["axis"]),
        (&json!(0.3), &json!("panda_hand"), &json!([0.0, 1.0, 0.0]))
    );
    let tcp = panda["frames"].as_array().unwrap().iter().find(|frame| frame["name"] == "panda_hand_tcp").unwrap();
    assert_eq!((&tcp["parent"], &tcp["carrier"]), (&json!("panda_hand"), &json!("panda_link7")));
    // The reference has this frame in the frame of its joint.
    let file: Value =
        serde_json::from_str(&std::fs::read_to_string(testdata("multibody/panda.json")).unwrap()).unwrap();
    for (key, numbers) in [("R", 9), ("p", 3)] {
        let [computed, expected] = [&tcp[key], &file["model"]["ee"][key]].map(crate::support::numbers);
        assert!(expected.len() == numbers && computed.iter().zip(&expected).all(|(c, e)| (c - e).abs() < 1e-15));
    }
    let warnings = panda["warnings"].as_array().unwrap();
    assert!(warnings.iter().any(|warning| warning["message"] == "not used: 7 <safety_controller>"
        && warning["places"].as_array().unwrap().len() == 7
        && warning["places"][0]["joint"] == "panda_joint1"));

    // No limit is null.
    let arm = json_of(&place, &["arm.toml"]);
    assert_eq!(arm["joints"][0]["limits"], json!({ "lower": null, "upper": null, "velocity": null, "effort": null }));
    assert_eq!(
        (&arm["gripper"], &panda["gripper"]),
        (&json!({ "body": "slide", "point": [0.1, 0.0, 0.0] }), &Value::Null)
    );
    let floating = json_of(&place, &[&urdf("solo12"), "--floating-base"]);
    let base = &floating["joints"][0];
    assert_eq!(
        (&base["name"], &base["kind"], &base["axis"]),
        (&json!("floating_base"), &json!("floating"), &Value::Null)
    );
    assert_eq!((&base["q"], &base["v"]), (&json!([0, 1, 2, 3, 4, 5, 6]), &json!([0, 1, 2, 3, 4, 5])));
    assert_eq!((&floating["q"][6], &floating["v"][3]), (&json!("floating_base.qw"), &json!("floating_base.wx")));
}

#[test]
fn packages_are_found_where_they_are_said_to_be() {
    let place = Place::new();
    std::fs::create_dir_all(place.path("somewhere/shapes/meshes")).unwrap();
    place.write("somewhere/shapes/meshes/rod.stl", "");
    place.write(
        "rod.urdf",
        "<robot name=\"rod\"><link name=\"base\"/><link name=\"rod\"><inertial><mass value=\"1\"/><origin xyz=\"0 0 1\"/>\
         <inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial><visual><geometry>\
         <mesh filename=\"package://shapes/meshes/rod.stl\"/></geometry></visual></link>\
         <joint name=\"pivot\" type=\"continuous\"><parent link=\"base\"/><child link=\"rod\"/><axis xyz=\"0 3 4\"/></joint></robot>",
    );
    let missing = place.done(&["info", "rod.urdf"]).stdout;
    assert!(missing.contains("\"package://shapes/meshes/rod.stl\""), "{missing}");
    let found = place.done(&["info", "rod.urdf", "--package-path", "elsewhere", "--package-path", "somewhere"]).stdout;
    assert!(!found.contains("package://") && found.contains("pivot  rod   continuous  (0, 0.6, 0.8)"), "{found}");
}

#[test]
fn mistakes_are_marked() {
    let place = Place::new();
    let text = std::fs::read_to_string(urdf("ur5")).unwrap();
    for (from, to, words) in [
        (
            "<mass value=\"3.7\"/>",
            "<mass value=\"-3.7\"/>",
            &["arm.urdf:", ": value of <mass> of link \"shoulder_link\" is -3.7", "─┬─"][..],
        ),
        (
            "<parent link=\"shoulder_link\"/>",
            "<parent link=\"sholder_link\"/>",
            &["did you mean \"shoulder_link\"?", "│     <parent"],
        ),
        ("</robot>", "", &["not XML"]),
    ] {
        assert_eq!(text.matches(from).count(), 1, "{from}");
        place.write("arm.urdf", text.replace(from, to));
        for command in [&["info", "arm.urdf"][..], &["dynamics", "arm.urdf", "--states", "-"]] {
            let ended = place.springpot(command);
            assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{}", ended.stderr);
            assert!(words.iter().all(|word| ended.stderr.contains(word)), "{words:?} in {}", ended.stderr);
        }
    }
    let spoilt = place.springpot(&["info", "arm.toml", "--floating-base"]);
    assert_eq!(spoilt.code, Some(2));
    place.write("arm.toml", "title = \"no robot\"\n");
    let ended = place.springpot(&["info", "arm.toml"]);
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""));
    assert!(ended.stderr.contains("the scenario has no `robot`"), "{}", ended.stderr);
    for nothing in ["none.urdf", "none.toml", "."] {
        assert_eq!(place.springpot(&["info", nothing]).code, Some(2));
    }
}

#[test]
fn long_chains_are_no_recursion() {
    let place = Place::new();
    let inertial = "<inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>";
    let link = |k: usize| {
        let joint = |name: &str, child: &str| {
            format!(
                "<link name=\"{child}{k}\">{inertial}</link><joint name=\"{name}{k}\" type=\"continuous\"><parent link=\"l{}\"/><child link=\"{child}{k}\"/></joint>",
                k - 1
            )
        };
        joint("j", "l") + &joint("k", "m")
    };
    let links: String = (1..=20_000).map(link).collect();
    place.write("tree.urdf", format!("<robot name=\"tree\"><link name=\"l0\"/>{links}</robot>"));
    let text = place.done(&["info", "tree.urdf"]).stdout;
    assert!(text.contains("joints    40000 continuous; nq = 40000, nv = 40000\n"));
    assert!(text.lines().all(|line| line.chars().count() < 100) && text.contains("┄ k20000 "));
}
