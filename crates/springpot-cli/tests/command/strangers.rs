//! Robots and results of strangers: what of the machine their meshes may name, and that no mesh ends a command.

use crate::support::Place;
use serde_json::Value;
use std::fs;

/// Two triangles.
const MESH: &str = "v 0 0 0\nv 0.1 0 0\nv 0.1 0.1 0\nv 0 0.1 0.1\nf 1 2 3\nf 1 3 4\n";

const RUN: &str = "robot = { urdf = \"urdf/arm.urdf\" }\nmotion = { kind = \"prescribed\", joints = { hinge = \"t\" } }\n\
                   time = { end = \"0.2 s\", output_step = \"0.1 s\" }\n";

/// A place with a robot in robot/urdf/arm.urdf whose arm has these meshes, and secrets beside it.
fn with_meshes(meshes: &[&str]) -> Place {
    let place = Place::new();
    for folder in ["robot/urdf", "robot/meshes", "parts/hand"] {
        fs::create_dir_all(place.path(folder)).unwrap();
    }
    for file in
        ["robot/meshes/link.obj", "robot/urdf/own.obj", "parts/hand/palm.obj", "secret.obj", "robot/meshes/bad.obj"]
    {
        place.write(file, MESH);
    }
    let shape = |name: &&str| format!("<visual><geometry><mesh filename=\"{name}\"/></geometry></visual>");
    let shapes: String = meshes.iter().map(shape).collect();
    place.write(
        "robot/urdf/arm.urdf",
        format!(
            "<robot name=\"arm\"><link name=\"base\"/><link name=\"arm\"><inertial><mass value=\"1\"/><origin xyz=\"0.2 0 0\"/>\
             <inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>{shapes}</link>\
             <joint name=\"hinge\" type=\"continuous\"><parent link=\"base\"/><child link=\"arm\"/><axis xyz=\"0 1 0\"/></joint></robot>"
        ),
    );
    place.write("robot/run.toml", RUN);
    place
}

/// The data of a page.
fn page(place: &Place, results: &str) -> Value {
    place.done(&["view", results, "--out", "page.html"]);
    let html = place.read("page.html");
    let (_, rest) = html.split_once("id=\"data\">").unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

fn notes(page: &Value) -> String {
    page["notes"].to_string()
}

#[test]
fn meshes_are_those_of_the_robot_and_its_packages() {
    let place = with_meshes(&[]);
    let secret = place.path("secret.obj").display().to_string();
    let outside = [
        secret.clone(),
        format!("file://{secret}"),
        "../../secret.obj".into(),
        "package://../secret.obj".into(),
        "package://robot/../secret.obj".into(),
        "package://robot/meshes/link.mesh.obj".into(),
        "/etc/passwd".into(),
        "file:///etc/passwd".into(),
    ];
    let inside = ["own.obj", "../meshes/link.obj", "package://robot/meshes/link.obj", "package://hand/palm.obj"];
    let meshes: Vec<&str> = outside.iter().map(String::as_str).chain(inside).collect();
    let place = {
        drop(place);
        with_meshes(&meshes)
    };
    // Those of this place.
    let secret = place.path("secret.obj").display().to_string();
    let text = place.read("robot/urdf/arm.urdf").replace(&outside[0], &secret);
    place.write("robot/urdf/arm.urdf", text);
    #[cfg(unix)]
    std::os::unix::fs::symlink(place.path("secret.obj"), place.path("robot/meshes/link.mesh.obj")).unwrap();
    place.write("robot/run.toml", RUN.replace("arm.urdf\"", "arm.urdf\", package_path = \"../parts\""));
    let ended = place.done(&["run", "robot/run.toml", "--out", "o"]);
    let words = "mesh files outside the folder of the robot and its packages (package_path), not read: ";
    assert!(ended.stderr.contains(words), "{}", ended.stderr);
    let record = place.read("o/run.json");
    assert!(
        !record.contains(place.path("robot").to_str().unwrap())
            && !record.contains(place.path("parts").to_str().unwrap())
    );
    let record = place.record("o");
    assert!(
        record["warnings"][0].as_str().unwrap().starts_with("urdf/arm.urdf: mesh files outside"),
        "{}",
        record["warnings"]
    );
    let drawn: Vec<&str> = record["scenes"][0]["bodies"][0]["visuals"]
        .as_array()
        .unwrap()
        .iter()
        .map(|visual| visual["shape"]["mesh"]["path"].as_str().unwrap())
        .collect();
    assert_eq!(drawn, ["own.obj", "../meshes/link.obj", "../meshes/link.obj", "../../parts/hand/palm.obj"]);
    let page = page(&place, "o");
    assert_eq!((page["meshes"].as_array().unwrap().len(), notes(&page)), (3, "[]".to_owned()));
    assert!(!place.read("page.html").contains(place.path("robot").to_str().unwrap()), "a path of this machine");
    // `export` takes the same files.
    place.done(&["export", "o", "a.gltf"]);
    let model: Value = serde_json::from_str(&place.read("a.gltf")).unwrap();
    assert!(model["meshes"].as_array().unwrap().iter().any(|mesh| mesh["name"] == "arm"));
}

#[test]
fn results_do_not_say_what_is_read() {
    let place = with_meshes(&["own.obj"]);
    place.done(&["run", "robot/run.toml", "--out", "o"]);
    let sound = place.read("o/run.json");
    assert_eq!(page(&place, "o")["meshes"].as_array().unwrap().len(), 1);
    let secret = place.path("secret.obj").display().to_string();
    let not_drawn = |record: &str, words: &str| {
        assert_ne!(record, sound);
        place.write("o/run.json", record);
        let page = page(&place, "o");
        assert_eq!(page["meshes"].as_array().unwrap().len(), 0, "{words}");
        assert!(notes(&page).contains(words), "{} lacks {words}", notes(&page));
    };
    let strange = "not drawn: outside the folder of the robot and its packages, or no mesh that it names";
    for path in [&*secret, "../../secret.obj", "../meshes/link.obj", "/etc/passwd"] {
        not_drawn(
            &sound
                .replace("\"path\": \"own.obj\"", &format!("\"path\": \"{path}\""))
                .replace("\"path\":\"own.obj\"", &format!("\"path\":\"{path}\"")),
            strange,
        );
    }
    // A robot that the results bring along is not the one that was run.
    place.write("o/evil.urdf", place.read("robot/urdf/arm.urdf").replace("own.obj", &secret));
    not_drawn(&sound.replace("../robot/urdf/arm.urdf", "evil.urdf"), "evil.urdf is not the file that the run read");
    // Nor is one that was changed since.
    place.write("o/run.json", &sound);
    place.write("robot/urdf/arm.urdf", place.read("robot/urdf/arm.urdf") + "\n");
    assert!(notes(&page(&place, "o")).contains("../robot/urdf/arm.urdf is not the file that the run read"));
    place.done(&["run", "robot/run.toml", "--out", "o"]);
    assert_eq!(notes(&page(&place, "o")), "[]");
}

#[test]
fn a_bad_mesh_is_a_note() {
    let place = with_meshes(&["../meshes/bad.obj", "own.obj"]);
    let bad: [(&[u8], &str); 4] = [
        (b"mtllib /dev/zero\nv 0 0 0\nf 1 2 3\n", "line 3: a face names a corner that is not there"),
        (b"v 3e38 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n", "a coordinate is beyond 1e9 or not finite"),
        (b"\xff\xfe", "it holds no triangle"),
        (b"", "it holds no triangle"),
    ];
    for (bytes, why) in bad {
        place.write("robot/meshes/bad.obj", bytes);
        let ended = place.done(&["run", "robot/run.toml", "--out", "o", "--view"]);
        assert!(ended.stdout.contains("view     o/view.html"));
        let page = page(&place, "o");
        assert_eq!(page["meshes"].as_array().unwrap().len(), 1);
        assert!(
            notes(&page).contains(&format!("../meshes/bad.obj cannot be read as a mesh: {why}")),
            "{}",
            notes(&page)
        );
        let ended = place.done(&["export", "o", "a.glb"]);
        assert!(ended.stderr.contains(why), "{}", ended.stderr);
    }
}
