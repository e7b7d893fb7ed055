//! Mesh files: where they are looked for, and what is said of those that are not found.

use crate::support::ARM;
use springpot::model::description::{
    DescriptionOptions, DescriptionPlace, DescriptionWarningKind, Owner, RobotDescription,
};
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A folder with these files, each with the text after a blank, if there is one.
fn folder(files: &[&str]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for file in files {
        let (name, text) = file.split_once(' ').unwrap_or((file, ""));
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    folder
}

/// The mesh files that are not found by the robot at `urdf`; none is outside.
fn missing(urdf: &Path, files: &[&str], package_path: &[PathBuf]) -> Vec<String> {
    let (missing, outside) = looked_for(urdf, files, package_path);
    assert_eq!(outside, [""; 0]);
    missing
}

/// The mesh files that are not found by the robot at `urdf`, and those that are outside.
fn looked_for(urdf: &Path, files: &[&str], package_path: &[PathBuf]) -> (Vec<String>, Vec<String>) {
    let meshes: String = files
        .iter()
        .map(|file| format!("\n<visual><geometry><mesh filename=\"{file}\"/></geometry></visual>"))
        .collect();
    let text = ARM.replace("<link name=\"base\"/>", &format!("<link name=\"base\">{meshes}</link>"));
    let options = DescriptionOptions { package_path: package_path.to_vec(), ..DescriptionOptions::default() };
    let urdf = RobotDescription::parse(&text, Some(urdf), &options).unwrap();
    let of = |kind: DescriptionWarningKind| {
        let places = urdf.warnings.iter().filter(|warning| warning.kind == kind).flat_map(|warning| &warning.places);
        places.map(|place| place.what.clone()).collect::<Vec<_>>()
    };
    let (missing, outside) = (of(DescriptionWarningKind::MeshNotFound), of(DescriptionWarningKind::MeshOutside));
    let all: usize = urdf.warnings.iter().map(|warning| warning.places.len()).sum();
    assert_eq!(all, missing.len() + outside.len());
    (missing, outside)
}

#[test]
fn a_package_is_an_ancestor_or_stands_beside_one() {
    let root = folder(&[
        "ws/arm/urdf/arm.urdf",
        "ws/arm/meshes/a.stl",
        "ws/hand/b.stl",
        "ws/odd/package.xml <package><name> named </name></package>",
        "ws/odd/urdf/odd.urdf",
        "ws/odd/c.stl",
    ]);
    let urdf = root.path().join("ws/arm/urdf/arm.urdf");
    let found = ["package://arm/meshes/a.stl", "package://hand/b.stl", "package://odd/c.stl", "model://hand//b.stl"];
    assert_eq!(missing(&urdf, &found, &[]), [""; 0]);
    let not_found =
        ["package://arm/meshes/b.stl", "package://foot/b.stl", "package://named/c.stl", "package://", "package://arm"];
    assert_eq!(missing(&urdf, &not_found, &[]), not_found);
    // Its own package.xml gives a package its name.
    let odd = root.path().join("ws/odd/urdf/odd.urdf");
    assert_eq!(missing(&odd, &["package://named/c.stl", "package://odd/c.stl"], &[]), [""; 0]);
}

#[test]
fn a_package_is_in_the_package_path_or_one_of_it() {
    let root = folder(&[
        "robot/arm.urdf",
        "other/hand/b.stl",
        "other/broken/package.xml <package><name>",
        "x/package.xml <package><name>foot</name></package>",
        "x/f.stl",
    ]);
    let urdf = root.path().join("robot/arm.urdf");
    let path = |name: &str| root.path().join(name);
    let files = ["package://hand/b.stl", "package://foot/f.stl"];
    assert_eq!(missing(&urdf, &files, &[]), files);
    assert_eq!(missing(&urdf, &files, &[path("other")]), ["package://foot/f.stl"]);
    assert_eq!(missing(&urdf, &files, &[path("other/hand"), path("x"), path("none"), path("other/broken")]), [""; 0]);
}

#[test]
fn plain_paths_count_from_the_file() {
    let root = folder(&["robot/arm.urdf", "robot/a.stl", "meshes/b.stl", "robot/shapes/c.stl"]);
    let urdf = root.path().join("robot/arm.urdf");
    let absolute = root.path().join("robot/a.stl");
    let absolute = absolute.to_str().unwrap();
    let found = ["a.stl", "shapes/../a.stl", absolute, &format!("file://{absolute}"), "http://example.org/x.stl"];
    assert_eq!(looked_for(&urdf, &found, &[]), (vec![], vec![]));
    let not_found = ["b.stl", "", "a.stl/b", "file://none/b.stl"].map(str::to_owned).to_vec();
    assert_eq!(missing(&urdf, &not_found.iter().map(String::as_str).collect::<Vec<_>>(), &[]), not_found);
}

#[test]
fn what_is_outside_the_robot_and_its_packages_is_not_read() {
    let root = folder(&[
        "ws/arm/urdf/arm.urdf",
        "ws/arm/meshes/a.stl",
        "ws/flat/arm.urdf",
        "ws/secret.stl",
        "ws/deep/package.xml <package><name>deep</name></package>",
        "ws/deep/a/b/arm.urdf",
        "ws/deep/c.stl",
        "far/x.stl",
        "far/package.xml <package><name>far</name></package>",
    ]);
    let path = |name: &str| root.path().join(name);
    let secret = path("ws/secret.stl").display().to_string();
    let of_file = format!("file://{secret}");
    let outside = |urdf: &str, files: &[&str], package_path: &[PathBuf]| {
        let files = files.iter().map(|file| (*file).to_owned()).collect::<Vec<_>>();
        let names: Vec<&str> = files.iter().map(String::as_str).collect();
        assert_eq!(looked_for(&path(urdf), &names, package_path), (vec![], files));
    };
    let ways = [
        "../secret.stl",
        "../../../etc/passwd",
        &secret,
        &of_file,
        "/etc/passwd",
        "file:///etc/passwd",
        "..",
        "package://../secret.stl",
        "package://./secret.stl",
        "package://flat/../secret.stl",
        "model://flat/a/../../secret.stl",
    ];
    outside("ws/flat/arm.urdf", &ways, &[]);
    outside("ws/flat/arm.urdf", &ways, &[path("ws/arm"), path("ws/flat")]);
    // The folder above one that is called urdf, a package.xml above, and what is given.
    assert_eq!(looked_for(&path("ws/arm/urdf/arm.urdf"), &["../meshes/a.stl"], &[]), (vec![], vec![]));
    assert_eq!(looked_for(&path("ws/deep/a/b/arm.urdf"), &["../../c.stl"], &[]), (vec![], vec![]));
    assert_eq!(looked_for(&path("ws/flat/arm.urdf"), &["../secret.stl"], &[path("ws")]), (vec![], vec![]));
    outside("ws/deep/a/b/arm.urdf", &["../../../secret.stl"], &[]);
    // Far above, what is no package is not taken for one; the root of the file system holds none.
    fs::create_dir_all(path("ws/deep/a/b/c/d")).unwrap();
    fs::write(path("ws/deep/a/b/c/d/arm.urdf"), "").unwrap();
    let far = path("ws/deep/a/b/c/d/arm.urdf");
    let plain = ["package://arm/meshes/a.stl", "package://ws/secret.stl", "package://etc/passwd", "package://tmp/x"];
    assert_eq!(missing(&far, &plain, &[]), plain);
    assert_eq!(looked_for(&far, &["package://far/x.stl", "package://deep/c.stl"], &[]), (vec![], vec![]));
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(path("ws/secret.stl"), path("ws/flat/link.stl")).unwrap();
        std::os::unix::fs::symlink(path("far"), path("ws/flat/folder")).unwrap();
        outside("ws/flat/arm.urdf", &["link.stl", "folder/x.stl", "package://flat/link.stl"], &[]);
    }
}

#[test]
fn a_missing_mesh_names_link_file_and_line() {
    let root = folder(&["arm.urdf"]);
    let shape = |file: &str| format!("\n<collision><geometry><mesh filename=\"{file}\"/></geometry></collision>");
    let shapes: String = ["a.stl", "b.stl", "c.stl"].map(shape).concat();
    let path = root.path().join("arm.urdf");
    fs::write(&path, ARM.replace("<link name=\"base\"/>", &format!("<link name=\"base\">{shapes}</link>"))).unwrap();
    let urdf = RobotDescription::read(&path, &DescriptionOptions::default()).unwrap();
    let [warning] = urdf.warnings.as_slice() else { panic!("{:?}", urdf.warnings) };
    let message = "mesh files not found, not needed for the dynamics: \
                   \"a.stl\" of link \"base\" (line 3), \"b.stl\" of link \"base\" (line 4) and 1 more";
    assert_eq!(warning.to_string(), message);
    let place = DescriptionPlace { owner: Owner::Link("base".into()), line: 5, what: "c.stl".into() };
    assert_eq!(warning.places[2], place);
}

#[test]
fn nothing_is_looked_for_without_a_file() {
    let text = ARM.replace(
        "<link name=\"base\"/>",
        "<link name=\"base\"><visual><geometry><mesh filename=\"a.stl\"/></geometry></visual></link>",
    );
    assert_eq!(RobotDescription::parse(&text, None, &DescriptionOptions::default()).unwrap().warnings, []);
}
