//! A model of power loss: what was not synced is lost, zeroed, or cut; names as they were, or as they were at the last sync.

use crate::door::{Change, Door};
use crate::quietly;
use crate::scene::{Files, Scene};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// What becomes of bytes that were written and not synced.
#[derive(Debug, Clone, Copy)]
enum Tail {
    Lost,
    Zeros,
    Half,
}

/// A file as it is, and as it was when it was last synced.
#[derive(Debug, Clone, Default)]
struct Inode {
    now: Vec<u8>,
    synced: Vec<u8>,
}

/// A file system as the loss of power finds it.
#[derive(Debug, Clone, Default)]
struct Model {
    inodes: Vec<Inode>,
    names: BTreeMap<PathBuf, usize>,
    synced_names: BTreeMap<PathBuf, usize>,
}

impl Model {
    fn of(out: &Path, files: &Files) -> Self {
        let mut model = Self::default();
        for (name, bytes) in files {
            model.names.insert(out.join(name), model.inodes.len());
            model.inodes.push(Inode { now: bytes.clone(), synced: bytes.clone() });
        }
        model.synced_names.clone_from(&model.names);
        model
    }

    fn apply(&mut self, change: &Change) {
        match change {
            Change::Touch(path) if self.names.contains_key(path) => {}
            Change::Touch(path) | Change::Create(path) => {
                self.names.insert(path.clone(), self.inodes.len());
                self.inodes.push(Inode::default());
            }
            Change::Write(path, at, bytes) => {
                let Some(now) = self.inode(path).map(|inode| &mut inode.now) else { return };
                let (at, end) = (*at as usize, *at as usize + bytes.len());
                now.resize(now.len().max(end), 0);
                now[at..end].copy_from_slice(bytes);
            }
            Change::SetLength(path, length) => {
                if let Some(inode) = self.inode(path) {
                    inode.now.resize(*length as usize, 0);
                }
            }
            Change::Sync(path) => {
                if let Some(inode) = self.inode(path) {
                    inode.synced.clone_from(&inode.now);
                }
                self.synced_names.clone_from(&self.names);
            }
            Change::SyncFolder => self.synced_names.clone_from(&self.names),
            Change::Rename(from, to) => {
                if let Some(inode) = self.names.remove(from) {
                    self.names.insert(to.clone(), inode);
                }
            }
            Change::Remove(path) => drop(self.names.remove(path)),
            Change::Folder | Change::RemoveFolder => {}
        }
    }

    /// By a name that it has, which for an open file is the one that it was opened with.
    fn inode(&mut self, path: &Path) -> Option<&mut Inode> {
        self.names.get(path).copied().map(|at| &mut self.inodes[at])
    }

    fn after(&self, out: &Path, tail: Tail, names_lost: bool) -> Files {
        let names = if names_lost { &self.synced_names } else { &self.names };
        let bytes = |inode: &Inode| {
            let (now, synced) = (&inode.now, &inode.synced);
            let grown = now.len().saturating_sub(synced.len());
            match tail {
                Tail::Lost => synced.clone(),
                Tail::Zeros => [&synced[..], &vec![0; grown]].concat(),
                Tail::Half => [&synced[..], &now[now.len() - grown..now.len() - grown / 2]].concat(),
            }
        };
        let name = |path: &Path| path.strip_prefix(out).unwrap().to_str().unwrap().to_owned();
        names.iter().map(|(path, inode)| (name(path), bytes(&self.inodes[*inode]))).collect()
    }
}

#[derive(Debug, Default)]
struct Tally {
    states: u32,
    went_on: u32,
    refused: u32,
    settled: u32,
}

fn lose_power(scene: &Scene, stride: usize) {
    scene.fill(&scene.earlier);
    let door = Door::writing_down();
    let left = scene.run(&door);
    assert_eq!(left.code, ExitCode::SUCCESS);
    let (changes, out, mut tally) = (door.changes(), scene.out(), Tally::default());
    assert!(changes.len() > 20);
    let mut model = Model::of(&out, &scene.earlier);
    for count in 0..=changes.len() {
        if count > 0 {
            model.apply(&changes[count - 1]);
        }
        let is_end = count == changes.len();
        if count % stride != 0 && !is_end {
            continue;
        }
        for tail in [Tail::Lost, Tail::Zeros, Tail::Half] {
            for names_lost in [false, true] {
                let files = model.after(&out, tail, names_lost);
                let what = format!("power lost after {count} of {} changes, {tail:?}, {names_lost}", changes.len());
                tally.states += 1;
                scene.fill(&files);
                let on = scene.resume(&Door::open());
                if is_end {
                    // What was said to be done is.
                    assert!(scene.has_whole(&on.files), "{} {what}", scene.name);
                }
                if on.code == ExitCode::SUCCESS {
                    scene.is_whole(&on.files, &what);
                    tally.went_on += 1;
                } else {
                    assert_eq!(on.code, ExitCode::from(2), "{} {what}", scene.name);
                    let has_head = files.get("checkpoint/run").is_some_and(|head| !head.is_empty());
                    assert!(!has_head || scene.has_whole(&on.files), "{} {what}: refused", scene.name);
                    match scene.has_whole(&on.files) {
                        true => tally.settled += 1,
                        false => scene.is_earlier(&on.files, &what),
                    }
                    tally.refused += 1;
                }
                scene.fill(&files);
                scene.runs_again(&what);
            }
        }
    }
    println!("{}, loss of power: {tally:?}", scene.name);
    assert!(tally.states > 20 && (tally.went_on > 5 || !scene.checkpoints), "{tally:?}");
}

#[test]
fn some_losses_of_power_leave_one_run_or_the_other() {
    quietly("power::some_losses_of_power_leave_one_run_or_the_other", || {
        Scene::few().iter().for_each(|scene| lose_power(scene, 5));
    });
}

#[test]
#[ignore = "some minutes"]
fn no_loss_of_power_leaves_anything_else() {
    quietly("power::no_loss_of_power_leaves_anything_else", || {
        Scene::all().iter().for_each(|scene| lose_power(scene, 1));
    });
}
