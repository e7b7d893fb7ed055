//! A kill or an error at every call to the file system.

use crate::door::{Door, Fault};
use crate::quietly;
use crate::scene::{Files, Scene};
use std::process::ExitCode;

/// No room, an error of the device, read-only, a signal.
const ERRORS: [i32; 4] = [28, 5, 30, 4];

/// What became of the faults.
#[derive(Debug, Default)]
struct Tally {
    faults: u32,
    /// The earlier results were there, as they were.
    earlier: u32,
    /// The new ones were, or were put in place by the next command.
    new: u32,
    went_on: u32,
    refused: u32,
}

/// Faults at every `stride`th call of a run, and the same for the run that goes on from the middle.
fn disturb(scene: &Scene, faults: &[Fault], stride: usize, tally: &mut Tally) {
    for (which, fault) in faults.iter().enumerate() {
        let mut at = which % stride;
        loop {
            scene.fill(&scene.earlier);
            let door = Door::faulty(at, *fault);
            let left = scene.run(&door);
            if !door.was_reached() {
                scene.is_whole(&left.files, "undisturbed");
                break;
            }
            judge(scene, *fault, left.code, &left.files, &format!("{fault:?} at call {at}"), tally);
            at += stride;
        }
    }
}

/// A run that was disturbed leaves the earlier results or the new ones; it can be gone on with or begun anew.
fn judge(scene: &Scene, fault: Fault, code: ExitCode, files: &Files, what: &str, tally: &mut Tally) {
    tally.faults += 1;
    if let Fault::Fail { .. } = fault {
        assert!(code == ExitCode::SUCCESS || code == ExitCode::from(1), "{} {what}: {code:?}", scene.name);
        if code == ExitCode::SUCCESS {
            scene.is_whole(files, what);
        }
    }
    if let Some(part) = files.get("results.csv.part") {
        let rows = scene.whole.get("results.csv").map_or(&b""[..], |rows| rows);
        assert!(rows.is_empty() || rows.starts_with(part), "{} {what}: rows", scene.name);
    }
    let on = scene.resume(&Door::open());
    if on.code == ExitCode::SUCCESS {
        scene.is_whole(&on.files, &format!("{what}, gone on with"));
        tally.went_on += 1;
    } else {
        assert_eq!(on.code, ExitCode::from(2), "{} {what}: --resume", scene.name);
        tally.refused += 1;
    }
    if scene.has_whole(&on.files) {
        tally.new += u32::from(on.code != ExitCode::SUCCESS || scene.has_whole(files));
    } else {
        scene.is_earlier(&on.files, what);
    }
    let committed = files.contains_key(".unfinished/commit") || scene.has_whole(files);
    if !committed {
        scene.is_earlier(files, what);
        tally.earlier += 1;
    }
    scene.fill(files);
    scene.runs_again(what);
}

/// The same for the run that goes on after a kill.
fn disturb_resumed(scene: &Scene, faults: &[Fault], stride: usize, tally: &mut Tally) {
    let mut dice = crate::scene::Dice(7);
    let mut middle = None;
    for _ in 0..100 {
        scene.fill(&scene.earlier);
        let door = Door::faulty(dice.roll(100), Fault::Kill { half: true });
        let left = scene.run(&door);
        // One with states and rows, and not yet at its end.
        let states = left.files.keys().filter(|name| name.starts_with("checkpoint/case-")).count();
        if door.was_reached() && states > 0 && !left.files.contains_key(".unfinished/commit") {
            middle = Some(left.files);
        }
    }
    let middle = middle.expect("no kill came between");
    for (which, fault) in faults.iter().enumerate() {
        let mut at = which % stride;
        loop {
            scene.fill(&middle);
            let door = Door::faulty(at, *fault);
            let left = scene.resume(&door);
            if !door.was_reached() {
                scene.is_whole(&left.files, "gone on with undisturbed");
                break;
            }
            tally.faults += 1;
            let what = format!("{fault:?} at call {at} of --resume");
            if left.code == ExitCode::SUCCESS && matches!(fault, Fault::Fail { .. }) {
                scene.is_whole(&left.files, &what);
            }
            if !left.files.contains_key(".unfinished/commit") && !scene.has_whole(&left.files) {
                scene.is_earlier(&left.files, &what);
                tally.earlier += 1;
            }
            let again = scene.resume(&Door::open());
            if scene.has_whole(&left.files) && again.code == ExitCode::from(2) {
                // Only what no longer counts may not yet be swept up.
                assert!(scene.has_whole(&again.files), "{} {what}", scene.name);
                tally.new += 1;
            } else {
                assert_eq!(again.code, ExitCode::SUCCESS, "{} {what}", scene.name);
                scene.is_whole(&again.files, &what);
                tally.went_on += 1;
            }
            at += stride;
        }
    }
}

fn campaign(scenes: Vec<Scene>, faults: &[Fault], stride: usize) {
    for scene in scenes {
        let mut tally = Tally::default();
        disturb(&scene, faults, stride, &mut tally);
        if scene.checkpoints {
            disturb_resumed(&scene, faults, stride, &mut tally);
        }
        println!("{}: {tally:?}", scene.name);
        assert!(tally.faults > 20 && tally.earlier > 10 && (tally.went_on > 5 || !scene.checkpoints), "{tally:?}");
    }
}

const KILLS: [Fault; 2] = [Fault::Kill { half: false }, Fault::Kill { half: true }];

#[test]
fn some_faults_lose_and_mix_nothing() {
    quietly("calls::some_faults_lose_and_mix_nothing", || {
        let fails = [Fault::Fail { error: 28, once: true }, Fault::Fail { error: 5, once: false }];
        campaign(Scene::few(), &[KILLS[0], KILLS[1], fails[0], fails[1]], 5);
    });
}

#[test]
#[ignore = "some minutes"]
fn no_fault_loses_or_mixes_anything() {
    quietly("calls::no_fault_loses_or_mixes_anything", || {
        let once = ERRORS.into_iter().map(|error| Fault::Fail { error, once: true });
        // A signal at every call from then on is no disk's.
        let lasting = ERRORS[..3].iter().map(|&error| Fault::Fail { error, once: false });
        campaign(Scene::all(), &KILLS.into_iter().chain(once).chain(lasting).collect::<Vec<_>>(), 1);
    });
}
