//! `springpot fmu`: what is written, and what is refused. What an FMU does is tested in `springpot-capi`.

use crate::support::Place;
use std::fs;
use std::path::Path;
use std::process::Command;

const LIBRARY: &str = springpot_capi::fmi::LIBRARY;

/// The names of the files in an archive, from its directory.
fn names(archive: &[u8]) -> Vec<String> {
    let heads = archive.windows(4).enumerate().filter(|(_, window)| *window == b"PK\x01\x02");
    let name = |(at, _): (usize, &[u8])| {
        let length = usize::from(archive[at + 28]) + 256 * usize::from(archive[at + 29]);
        String::from_utf8_lossy(archive.get(at + 46..at + 46 + length)?).into_owned().into()
    };
    heads.filter_map(name).collect()
}

/// A library that is the size of a page, and the right one to the command.
fn stub(place: &Place) -> &'static str {
    let found = [".", "deps"].map(|folder| Path::new(env!("CARGO_BIN_EXE_springpot")).parent().unwrap().join(folder));
    let own = found.iter().map(|folder| folder.join(LIBRARY)).find_map(|file| fs::read(file).ok());
    let own = own.expect("cargo builds the library with the command");
    let at = |text: &[u8]| own.windows(text.len()).position(|window| window == text).unwrap();
    let mark = at(concat!("springpot-capi for FMUs, version ", env!("CARGO_PKG_VERSION"), ";").as_bytes());
    place.write("library", [&own[..64], &own[mark..mark + 64], b"fmi2DoStep"].concat());
    "library"
}

#[test]
fn an_fmu_holds_scenario_files_and_library() {
    let place = Place::new();
    fs::create_dir(place.path("data")).unwrap();
    place.write("data/u.csv", "t,u\n0,1\n1,2\n");
    let set = "element.damper.u={ csv = \"data/u.csv\", column = \"u\", unit = \"V\" }";
    let ended = place.done(&["fmu", "arm.toml", "--set", set, "--library", stub(&place)]);
    assert!(ended.stdout.starts_with("wrote arm.fmu\n"), "{}", ended.stdout);
    assert!(ended.stdout.contains("damper.u"), "{}", ended.stdout);
    let archive = fs::read(place.path("arm.fmu")).unwrap();
    let names = names(&archive);
    for name in ["modelDescription.xml", "resources/scenario.toml", "resources/set.json", "resources/files/u.csv"] {
        assert!(names.iter().any(|known| known == name), "{name}: {names:?}");
    }
    assert!(names.iter().any(|name| name.starts_with("binaries/") && name.contains("/arm.")), "{names:?}");
    // Again, the same bytes; where the folder cannot be written, nothing is left of another one.
    place.done(&["fmu", "arm.toml", "--set", set, "--library", "library", "--out", "again.fmu"]);
    assert_ne!(fs::read(place.path("again.fmu")).unwrap().len(), 0);
    assert_eq!(fs::read(place.path("again.fmu")).unwrap(), archive);
    let failed = place.springpot(&["fmu", "arm.toml", "--library", "library", "--out", "nowhere/arm.fmu"]);
    assert_eq!(failed.code, Some(1));
    assert!(failed.stderr.contains("nowhere/arm.fmu cannot be written"), "{}", failed.stderr);
}

#[test]
fn the_library_beside_the_command_is_found() {
    let place = Place::new();
    place.done(&["fmu", "arm.toml"]);
    let archive = fs::read(place.path("arm.fmu")).unwrap();
    assert!(archive.len() > 100_000, "{} bytes", archive.len());
}

#[test]
fn without_a_library_there_is_no_fmu() {
    let place = Place::new();
    // A command that stands alone.
    let alone = place.path("alone");
    fs::create_dir(&alone).unwrap();
    let program = alone.join("springpot");
    fs::copy(env!("CARGO_BIN_EXE_springpot"), &program).unwrap();
    let ended = Command::new(&program).current_dir(place.path(".")).args(["fmu", "arm.toml"]).output().unwrap();
    let told = String::from_utf8_lossy(&ended.stderr).into_owned();
    assert_eq!(ended.status.code(), Some(2), "{told}");
    assert!(told.contains(LIBRARY) && told.contains("cargo build --release -p springpot-capi"), "{told}");
    // In ../lib, as it is installed.
    fs::create_dir(place.path("lib")).unwrap();
    fs::copy(place.path(stub(&place)), place.path("lib").join(LIBRARY)).unwrap();
    let ended = Command::new(&program).current_dir(place.path(".")).args(["fmu", "arm.toml"]).output().unwrap();
    assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
    fs::remove_file(place.path("arm.fmu")).unwrap();

    for (library, words) in [
        ("arm.toml", "arm.toml is not the library of this version"),
        ("none.so", "none.so cannot be read"),
        (".", ". cannot be read: not a regular file"),
    ] {
        let ended = place.springpot(&["fmu", "arm.toml", "--library", library]);
        assert_eq!(ended.code, Some(2));
        assert!(ended.stderr.contains(words) && ended.stderr.contains("--library FILE"), "{}", ended.stderr);
    }
    assert!(!place.path("arm.fmu").exists());
}

#[test]
fn what_cannot_be_an_fmu_is_refused() {
    let place = Place::new();
    stub(&place);
    let swept = format!("{}\n[[sweep]]\nparameter = \"element.damper.u\"\nvalues = [1, 2]\n", place.read("arm.toml"));
    place.write("swept.toml", swept);
    for (arguments, code, words) in [
        (&["fmu", "swept.toml", "--library", "library"][..], 2, "the scenario has 2 cases, and an FMU is one"),
        (
            &["fmu", "arm.toml", "--set", "element.damper.scheme=l1", "--library", "library"],
            2,
            "element \"damper\" has a named scheme",
        ),
        (&["fmu", "arm.toml", "--set", "element.damper.alpha=3", "--library", "library"], 2, "--set:1:22"),
        (&["fmu", "none.toml", "--library", "library"], 2, "none.toml: cannot be opened"),
        (
            &["fmu", "arm.toml", "--set", "element.damper.u=-100", "--library", "library"],
            1,
            "the scenario cannot start",
        ),
    ] {
        let ended = place.springpot(arguments);
        assert_eq!(ended.code, Some(code), "{arguments:?}: {}", ended.stderr);
        assert!(ended.stderr.contains(words), "{arguments:?}: {}", ended.stderr);
    }
    assert!(place.files(".").iter().all(|file| !file.ends_with(".fmu") && !file.ends_with(".part")));
}
