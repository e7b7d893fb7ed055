//! Who stands at the door of the disk: counts calls, lets one fail, stops at one, or writes all of them down.

use springpot_run::table::disk::{Call, Disk, Verdict, Watch};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

/// What happens at a call.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Fault {
    /// Nothing more reaches the disk; of a write that is half of it.
    Kill { half: bool },
    /// The call fails with this error of the system, alone or as all that follow.
    Fail { error: i32, once: bool },
}

/// A call that changes something.
#[derive(Debug, Clone)]
pub(crate) enum Change {
    Folder,
    /// Makes a file where none is.
    Touch(PathBuf),
    Create(PathBuf),
    Write(PathBuf, u64, Vec<u8>),
    SetLength(PathBuf, u64),
    Sync(PathBuf),
    SyncFolder,
    Rename(PathBuf, PathBuf),
    Remove(PathBuf),
    RemoveFolder,
}

#[derive(Debug)]
pub(crate) struct Door {
    fault: Option<(usize, Fault)>,
    /// Calls so far; where it kills, those that change something.
    count: AtomicUsize,
    changes: Mutex<Option<Vec<Change>>>,
}

impl Door {
    pub(crate) fn faulty(at: usize, fault: Fault) -> Arc<Self> {
        Arc::new(Self { fault: Some((at, fault)), count: AtomicUsize::new(0), changes: Mutex::new(None) })
    }

    pub(crate) fn writing_down() -> Arc<Self> {
        Arc::new(Self { fault: None, count: AtomicUsize::new(0), changes: Mutex::new(Some(Vec::new())) })
    }

    /// Lets everything pass; only that no sync waits.
    pub(crate) fn open() -> Arc<Self> {
        Arc::new(Self { fault: None, count: AtomicUsize::new(0), changes: Mutex::new(None) })
    }

    pub(crate) fn disk(self: &Arc<Self>) -> Disk {
        Disk::watched(self.clone())
    }

    /// Whether the call came at which something was to happen.
    pub(crate) fn was_reached(&self) -> bool {
        self.fault.is_some_and(|(at, _)| self.count.load(Ordering::SeqCst) > at)
    }

    pub(crate) fn changes(&self) -> Vec<Change> {
        self.changes.lock().unwrap().take().unwrap_or_default()
    }
}

fn change(call: &Call<'_>) -> Option<Change> {
    let own = Path::to_owned;
    Some(match *call {
        Call::CreateFolder(_) => Change::Folder,
        Call::Create(path) => Change::Create(own(path)),
        Call::Write { file, at, bytes } => Change::Write(own(file), at, bytes.to_vec()),
        Call::SetLength { file, length } => Change::SetLength(own(file), length),
        Call::Sync(path) => Change::Sync(own(path)),
        Call::SyncFolder(_) => Change::SyncFolder,
        Call::Rename { from, to } => Change::Rename(own(from), own(to)),
        Call::Remove(path) => Change::Remove(own(path)),
        Call::RemoveFolder(_) => Change::RemoveFolder,
        Call::Lock(path) => Change::Touch(own(path)),
        Call::Look(_) | Call::List(_) | Call::Open(_) | Call::Read(_) | Call::Edit(_) => return None,
    })
}

impl Watch for Door {
    fn before(&self, call: &Call<'_>) -> io::Result<Verdict> {
        if let Some(changes) = self.changes.lock().unwrap().as_mut() {
            changes.extend(change(call));
        }
        let killed = || Err(io::Error::other("killed"));
        match self.fault {
            None => {}
            Some((at, Fault::Kill { half })) => {
                let counts = change(call).is_some();
                let before = self.count.fetch_add(usize::from(counts), Ordering::SeqCst);
                match call {
                    _ if before < at || (before == at && !counts) => {}
                    Call::Write { bytes, .. } if before == at && half => return Ok(Verdict::Part(bytes.len() / 2)),
                    _ => return killed(),
                }
            }
            Some((at, Fault::Fail { error, once })) => {
                let now = self.count.fetch_add(1, Ordering::SeqCst);
                if now == at || (now > at && !once) {
                    return Err(io::Error::from_raw_os_error(error));
                }
            }
        }
        Ok(Verdict::Pretend)
    }
}
