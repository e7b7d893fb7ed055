//! The placements of a scene, which know nothing of the engine, agree with the engine's own.

use serde_json::Value;
use springpot::law::Catalog;
use springpot::system::Stop;
use springpot_report::scene::{Kinematics, Scene};
use springpot_run::sweep::Progress;
use springpot_run::table::disk::Disk;
use springpot_run::{Asked, NewRun, Prepared, Surroundings, Warning};
use std::fs;
use std::path::Path;

/// A body that flies and turns, with an arm of every kind of joint behind it and a joint that follows another one's follower.
const FLYING: &str = r#"
<robot name="flyer"><link name="hull">INERTIAL</link>
<joint name="a" type="revolute"><origin xyz="0.1 -0.2 0.3" rpy="0.4 -0.5 0.6"/><parent link="hull"/><child link="l1"/><axis xyz="1 2 -2"/>
<limit lower="-9" upper="9" effort="9" velocity="9"/></joint><link name="l1">INERTIAL</link>
<joint name="b" type="prismatic"><origin xyz="0.3 0 0.1" rpy="-1 0.2 2"/><parent link="l1"/><child link="l2"/><axis xyz="0 3 4"/>
<limit lower="-9" upper="9" effort="9" velocity="9"/></joint><link name="l2">INERTIAL</link>
<joint name="c" type="continuous"><origin xyz="0 0.1 0" rpy="0 1.3 0"/><parent link="l2"/><child link="l3"/><axis xyz="0 0 1"/>
<mimic joint="a" multiplier="-0.7" offset="0.3"/></joint><link name="l3">INERTIAL</link>
<joint name="d" type="fixed"><origin xyz="0 0.1 0.2" rpy="0.1 0.2 0.3"/><parent link="l3"/><child link="tip"/></joint><link name="tip">INERTIAL</link>
</robot>"#;
const INERTIAL: &str = r#"<inertial><origin xyz="0.05 0.02 -0.01"/><mass value="1.5"/><inertia ixx="0.03" iyy="0.02" izz="0.025" ixy="0.001" ixz="0" iyz="0.002"/></inertial>"#;
const FLIGHT: &str = r#"
[robot]
urdf = "flyer.urdf"
floating_base = true
gripper = { body = "tip", point = [0.1, 0.2, -0.3] }
[motion]
kind = "forward"
[motion.start.q]
a = 0.5
b = 0.1
[motion.start.v]
a = 3
b = -0.4
[time]
end = 1
output_step = 0.02
"#;

/// The largest distance of the gripper from where the rows have it, and how far it is from the origin at most.
fn distance(scenario: &Path, out: &Path) -> (f64, f64) {
    let (catalog, disk, stop, progress) = (Catalog::standard(), Disk::default(), Stop::new(false), Progress::default());
    let surroundings = Surroundings { catalog: &catalog, disk: &disk, stop: &stop, holder: "a test" };
    let mut warn = |_: Warning| {};
    let run = NewRun { out: Some(out.to_owned()), ..NewRun::of(Asked::read(scenario).unwrap()) };
    let mut run = Prepared::begin(run, surroundings, &mut warn).unwrap();
    let outcome = run.sweep(2, &stop, &progress).unwrap();
    run.finish(outcome, &progress, &mut warn).unwrap();
    let record: Value = serde_json::from_slice(&fs::read(out.join("run.json")).unwrap()).unwrap();
    let scene: Scene = serde_json::from_value(record["scenes"][0].clone()).unwrap();
    let gripper = scene.gripper.clone().unwrap();
    let mut reader = csv::Reader::from_path(out.join("results.csv")).unwrap();
    let header = reader.headers().unwrap().clone();
    let column = |name: &str| header.iter().position(|column| column == name);
    let tree = Kinematics::new(&scene, column);
    assert!(tree.missing().is_empty());
    let wanted = ["gripper.x", "gripper.y", "gripper.z"].map(|name| column(name).unwrap());
    let (mut worst, mut scale) = (0.0_f64, 0.0_f64);
    for record in reader.records().map(Result::unwrap) {
        let row: Vec<f64> = record.iter().map(|field| field.parse().unwrap_or(f64::NAN)).collect();
        let placed = tree.world(&tree.local(&row));
        let found = gripper.body.map_or(gripper.point, |body| placed[body].point(gripper.point));
        for k in 0..3 {
            worst = worst.max((found[k] - row[wanted[k]]).abs());
            scale = scale.max(found[k].abs());
        }
    }
    (worst, scale)
}

#[test]
fn the_gripper_is_where_the_rows_have_it() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("flyer.urdf"), FLYING.replace("INERTIAL", INERTIAL)).unwrap();
    fs::write(folder.path().join("flyer.toml"), FLIGHT).unwrap();
    let scenarios = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let names = ["panda_drop", "panda_gripper_path", "tendon_finger", "thermoviscoelastic_order"];
    let of = names.map(|name| scenarios.join(format!("{name}.toml")));
    for scenario in of.iter().chain([&folder.path().join("flyer.toml")]) {
        let (worst, scale) = distance(scenario, &folder.path().join("results"));
        assert!(scale > 0.05 && worst <= 1e-12 * scale, "{}: {worst:e} of {scale}", scenario.display());
    }
}
