use super::*;
use std::fs;

fn folder(path: &Path) -> Result<Folder, FolderError> {
    Folder::open(path, Disk::default(), "a test")
}

/// Begins a run with these figures; `input` is read by its scenario.
fn begin(folder: &mut Folder, figures: &[&str], checkpoints: bool, input: Option<&Path>) -> Result<(), FolderError> {
    let figures: Vec<String> = figures.iter().map(|name| (*name).to_owned()).collect();
    let is_input = |file: &Path| input == Some(file);
    folder.begin(Targets { figures: &figures, checkpoints, is_input: &is_input })
}

fn record(files: &[String]) -> serde_json::Map<String, serde_json::Value> {
    let text = r#"{ "status": "done", "versions": { "springpot": "1" } }"#;
    let mut record: serde_json::Map<_, _> = serde_json::from_str(text).unwrap();
    record.insert("files".into(), files.into());
    record
}

/// A run of one row and one figure.
fn run(path: &Path, row: &str, figure: &str) -> Result<(), FolderError> {
    let mut folder = folder(path)?;
    begin(&mut folder, &[figure], false, None)?;
    folder.create_rows()?.write_all(row.as_bytes())?;
    folder.create_summary()?.write_all(row.as_bytes())?;
    folder.write_figure(figure, row.as_bytes())?;
    folder.put(record, false)
}

/// All files in a folder and below, and what they hold.
fn files(path: &Path) -> Vec<(String, String)> {
    fn below(path: &Path, lead: &str, found: &mut Vec<(String, String)>) {
        for entry in fs::read_dir(path).unwrap().map(Result::unwrap) {
            let name = format!("{lead}{}", entry.file_name().to_str().unwrap());
            match entry.file_type().unwrap().is_dir() {
                true => below(&entry.path(), &format!("{name}/"), found),
                false => found.push((name, fs::read_to_string(entry.path()).unwrap_or_default())),
            }
        }
    }
    let mut found = Vec::new();
    below(path, "", &mut found);
    found.sort();
    found
}

#[test]
fn a_rerun_replaces_its_own_files_and_no_others() {
    let temporary = tempfile::tempdir().unwrap();
    let path = temporary.path().join("results");
    run(&path, "1\n", "old.svg").unwrap();
    fs::write(path.join("notes.txt"), "mine").unwrap();
    fs::write(path.join("figures/mine.svg"), "mine").unwrap();
    run(&path, "2\n", "new.svg").unwrap();
    let names: Vec<String> = files(&path).into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, ["figures/mine.svg", "figures/new.svg", "notes.txt", "results.csv", "run.json", "summary.csv"]);
    assert_eq!(fs::read_to_string(path.join("results.csv")).unwrap(), "2\n");
}

#[test]
fn what_no_run_wrote_is_refused_and_stays() {
    for name in [
        "results.csv",
        "results.parquet",
        "results.npz",
        "summary.csv",
        "run.json",
        "figures/a.svg",
        "results.csv.part",
        "checkpoint/run",
        "checkpoint/case-7",
        ".unfinished/summary.csv",
    ] {
        let temporary = tempfile::tempdir().unwrap();
        let path = temporary.path();
        fs::create_dir_all(path.join(name).parent().unwrap()).unwrap();
        fs::write(path.join(name), "mine").unwrap();
        let before = files(path);
        let refused = folder(path).and_then(|mut folder| begin(&mut folder, &["a.svg"], true, None));
        let at = if name.starts_with("checkpoint") || name.starts_with('.') {
            path.join(name.split('/').next().unwrap())
        } else {
            path.join(name)
        };
        assert!(matches!(&refused, Err(FolderError::Foreign(file)) if *file == at), "{name}: {refused:?}");
        assert_eq!(files(path), before, "{name}");
    }
    // A folder of the name of a file, and what is read, are no better.
    let temporary = tempfile::tempdir().unwrap();
    fs::create_dir(temporary.path().join("summary.csv")).unwrap();
    let refused = folder(temporary.path()).and_then(|mut folder| begin(&mut folder, &[], false, None));
    assert!(matches!(refused, Err(FolderError::Foreign(_))));
    let temporary = tempfile::tempdir().unwrap();
    run(temporary.path(), "1\n", "a.svg").unwrap();
    let input = temporary.path().join("results.csv");
    let refused = folder(temporary.path()).and_then(|mut folder| begin(&mut folder, &[], false, Some(&input)));
    assert!(matches!(refused, Err(FolderError::Input(file)) if file == input));
}

#[test]
fn a_record_from_elsewhere_harms_nothing() {
    let temporary = tempfile::tempdir().unwrap();
    let path = temporary.path().join("results");
    fs::create_dir_all(path.join("figures/sub")).unwrap();
    let outside = temporary.path().join("keep.svg");
    let kept = [outside.clone(), path.join("figures/notes.txt"), path.join("figures/sub/a.svg")];
    for file in &kept {
        fs::write(file, "mine").unwrap();
    }
    let versions = r#""versions": { "springpot": "1" }"#;
    for files in [
        format!(r#"["figures/../../keep.svg", "../keep.svg", {outside:?}, "figures/notes.txt", "run.json"]"#),
        r#"["figures/sub/a.svg", "figures/sub", "figures", "run.json"]"#.into(),
    ] {
        for own in ["results.csv", "summary.csv", "figures/a.svg"] {
            let _ = fs::remove_file(path.join(own));
        }
        fs::write(path.join(RUN), format!(r#"{{ "files": {files}, {versions} }}"#)).unwrap();
        run(&path, "1\n", "a.svg").unwrap();
        assert!(kept.iter().all(|file| fs::read_to_string(file).unwrap() == "mine"));
    }
    fs::remove_dir_all(&path).unwrap();
    fs::create_dir(&path).unwrap();
    for record in [
        format!(r#"{{ "files": "run.json", {versions} }}"#),
        format!(r#"{{ "files": ["results.csv"], {versions} }}"#),
        r#"{ "files": ["results.csv", "run.json"] }"#.into(),
        "[]".into(),
        "not JSON".into(),
    ] {
        fs::write(path.join(RUN), &record).unwrap();
        assert!(matches!(run(&path, "1\n", "a.svg"), Err(FolderError::Foreign(_))), "{record}");
        assert_eq!(fs::read_to_string(path.join(RUN)).unwrap(), record);
    }
}

#[cfg(unix)]
#[test]
fn links_are_replaced_or_refused_and_never_followed() {
    use std::os::unix::fs::symlink;
    let temporary = tempfile::tempdir().unwrap();
    let (path, target) = (temporary.path().join("results"), temporary.path().join("target"));
    fs::write(&target, "mine").unwrap();
    run(&path, "1\n", "a.svg").unwrap();
    // One in the place of a file that the last run wrote is replaced.
    fs::remove_file(path.join("figures/a.svg")).unwrap();
    symlink(&target, path.join("figures/a.svg")).unwrap();
    run(&path, "2\n", "a.svg").unwrap();
    assert_eq!(fs::read_to_string(path.join("figures/a.svg")).unwrap(), "2\n");
    assert!(path.join("figures/a.svg").symlink_metadata().unwrap().is_file());
    // One that no run wrote is refused, whatever it leads to.
    for name in ["figures/b.svg", "results.csv.part", "figures", ".lock", ".unfinished"] {
        let there = path.join(name);
        let _ = fs::remove_dir_all(&there);
        symlink(&target, &there).unwrap();
        assert!(matches!(run(&path, "3\n", "b.svg"), Err(FolderError::Foreign(file)) if file == there), "{name}");
        fs::remove_file(&there).unwrap();
    }
    assert_eq!(fs::read_to_string(&target).unwrap(), "mine");
    assert_eq!(fs::read_to_string(path.join("results.csv")).unwrap(), "2\n");
}

#[test]
fn what_appears_underway_keeps_the_results_waiting() {
    let temporary = tempfile::tempdir().unwrap();
    let path = temporary.path();
    let mut first = folder(path).unwrap();
    begin(&mut first, &[], false, None).unwrap();
    first.create_rows().unwrap().write_all(b"1\n").unwrap();
    first.create_summary().unwrap();
    fs::write(path.join("summary.csv"), "mine").unwrap();
    let pending = first.put(record, false);
    assert!(matches!(&pending, Err(FolderError::Pending { .. })), "{pending:?}");
    drop(first);
    assert!(matches!(folder(path), Err(FolderError::Pending { .. })));
    assert_eq!(fs::read_to_string(path.join("summary.csv")).unwrap(), "mine");
    fs::remove_file(path.join("summary.csv")).unwrap();
    assert_eq!(folder(path).unwrap().settled(), Some("done"));
    let names: Vec<String> = files(path).into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, ["results.csv", "run.json", "summary.csv"]);
}

#[test]
fn half_a_row_is_cut_off() {
    let temporary = tempfile::tempdir().unwrap();
    let long = "x".repeat(40_000);
    for (written, kept) in
        [("a\nb\nhal", "a\nb\n"), ("a\n", "a\n"), ("hal", ""), ("", ""), (&*format!("a\n{long}"), "a\n")]
    {
        let mut folder = folder(temporary.path()).unwrap();
        begin(&mut folder, &[], false, None).unwrap();
        folder.create_rows().unwrap().write_all(written.as_bytes()).unwrap();
        folder.cut_rows().unwrap();
        assert_eq!(fs::read_to_string(temporary.path().join(PART)).unwrap(), kept);
    }
}
