//! Rows and checkpoints that were damaged, cut, swapped, or are another run's.

use crate::door::{Door, Fault};
use crate::quietly;
use crate::scene::{Dice, Files, Scene, difference};
use std::process::ExitCode;

/// What kills at all sorts of calls leave, of those that can be gone on with.
fn killed(scene: &Scene, count: usize, dice: &mut Dice) -> Vec<Files> {
    let mut found = Vec::new();
    for _ in 0..20 * count {
        scene.fill(&scene.earlier);
        let left = scene.run(&Door::faulty(20 + dice.roll(150), Fault::Kill { half: false }));
        let states = left.files.keys().filter(|name| name.starts_with("checkpoint/case-")).count();
        if states > 0 && !left.files.contains_key(".unfinished/commit") {
            found.push(left.files);
        }
        if found.len() == count {
            break;
        }
    }
    assert_eq!(found.len(), count, "{}: kills that can be gone on from", scene.name);
    found
}

/// One damage to a file, which may be exchanged for that of `other`; `None` where it leaves the file as it was.
fn damaged(good: &[u8], other: Option<&Vec<u8>>, dice: &mut Dice) -> Option<Option<Vec<u8>>> {
    let mut bad = good.to_vec();
    let at = dice.roll(good.len());
    match dice.roll(7) {
        0 if !bad.is_empty() => bad[at] ^= 1 << dice.roll(8),
        1 => bad.truncate(at),
        2 => bad[at..].fill(0),
        3 => bad.extend(vec![b'7'; 1 + dice.roll(100)]),
        4 => {
            let end = bad.len().min(at + 1 + dice.roll(60));
            drop(bad.drain(at..end));
        }
        5 => bad = other?.clone(),
        _ => return Some(None),
    }
    (bad != good).then_some(Some(bad))
}

fn damage(scene: &Scene, states: usize, tries: usize) {
    let mut dice = Dice(11);
    let killed = killed(scene, states, &mut dice);
    let (mut tried, mut went_on, mut refused) = (0, 0, 0);
    while tried < tries {
        let (good, foreign) = (&killed[dice.roll(states)], &killed[dice.roll(states)]);
        let names: Vec<&String> =
            good.keys().filter(|name| name.contains("checkpoint/") || name.ends_with(".part")).collect();
        let name = names[dice.roll(names.len())];
        // Another state of the same run, or the rows of another one.
        let swapped = foreign.get(name).or_else(|| scene.earlier.get("results.csv"));
        let Some(bad) = damaged(&good[name], swapped, &mut dice) else { continue };
        let what = format!("{name}, {:?} of {} bytes", bad.as_ref().map(Vec::len), good[name].len());
        let mut files = good.clone();
        match bad {
            Some(bad) => drop(files.insert(name.clone(), bad)),
            None => drop(files.remove(name)),
        }
        scene.fill(&files);
        let on = scene.resume(&Door::open());
        tried += 1;
        if on.code == ExitCode::SUCCESS {
            scene.is_whole(&on.files, &what);
            went_on += 1;
        } else {
            assert_eq!(on.code, ExitCode::from(2), "{} {what}", scene.name);
            let changed = difference(&on.files, &files);
            assert!(changed.is_none(), "{} {what}: refused and changed: {changed:?}", scene.name);
            refused += 1;
        }
    }
    println!("{}: {tried} damages, {went_on} gone on with, {refused} refused", scene.name);
    assert!(went_on > tries / 20 && refused > tries / 20);
}

#[test]
fn some_damages_are_refused_or_do_not_matter() {
    quietly("damage::some_damages_are_refused_or_do_not_matter", || {
        Scene::few().iter().filter(|scene| scene.checkpoints).for_each(|scene| damage(scene, 6, 120));
    });
}

#[test]
#[ignore = "a minute"]
fn all_damages_are_refused_or_do_not_matter() {
    quietly("damage::all_damages_are_refused_or_do_not_matter", || {
        Scene::all().iter().filter(|scene| scene.checkpoints).for_each(|scene| damage(scene, 20, 1_000));
    });
}
