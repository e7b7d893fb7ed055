//! One run at a time in a folder.

use crate::table::disk::{Disk, DiskFile, Entry};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

/// The file of the lock.
pub(super) const LOCK: &str = ".lock";

/// Bytes of it that are looked at.
const LONGEST: usize = 1_000;

/// Times that a lock is tried for whose file others take away just then.
const TRIES: usize = 100;

/// A lock on a folder, until it is dropped or its process ends, however that ends: it is the system's, the file only says whose it is.
#[derive(Debug)]
pub(super) struct Lock {
    /// Holds the lock as long as it is open.
    file: DiskFile,
    path: PathBuf,
    disk: Disk,
    /// Whether the file is a run's, and goes with the lock; what somebody else wrote there stays as it is.
    is_ours: bool,
}

/// What became of taking a lock.
#[derive(Debug)]
pub(super) enum Taken {
    Lock(Lock),
    /// Somebody else has it; what the file says of them.
    Held(String),
    /// What has the name of the lock is no file.
    Foreign(PathBuf),
    /// The file system knows no locks.
    Unknown,
}

/// Takes the lock on `folder` for `holder`: one that nobody holds is free, whatever its file says.
pub(super) fn take(disk: &Disk, folder: &Path, holder: &str) -> io::Result<Taken> {
    let path = folder.join(LOCK);
    for _ in 0..TRIES {
        match disk.look(&path)? {
            None => {}
            Some(Entry::File(_)) => {}
            Some(_) => return Ok(Taken::Foreign(path)),
        }
        let mut file = match disk.lock(&path) {
            Ok(Some(file)) => file,
            Ok(None) => return Ok(Taken::Held(whose(&said(disk, &path)))),
            Err(error) if knows_no_locks(&error) => return Ok(Taken::Unknown),
            Err(error) => return Err(error),
        };
        // The one before may have taken its file away after this one was opened.
        if !file.is_in_place()? {
            continue;
        }
        let is_ours = is_ours(&said(disk, &path));
        let written = match is_ours {
            true => {
                file.set_length(0).and_then(|()| file.write_all(text(holder).as_bytes())).and_then(|()| file.sync())
            }
            false => Ok(()),
        };
        let lock = Lock { file, path, disk: disk.clone(), is_ours };
        return written.map(|()| Taken::Lock(lock));
    }
    Err(io::Error::new(io::ErrorKind::ResourceBusy, format!("{}: others take it all the time", path.display())))
}

/// Whether a run writes to a folder; where the file system knows no locks, the file says it.
pub(crate) fn is_held(disk: &Disk, folder: &Path) -> bool {
    disk.is_locked(&folder.join(LOCK))
}

impl Lock {
    /// Whether its file is still there, so that others meet it.
    pub(super) fn is_in_place(&self) -> io::Result<bool> {
        self.file.is_in_place()
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // One that stays locks nobody out; another run's may have its name by now.
        if self.is_ours && self.is_in_place().unwrap_or(true) {
            let _ = self.disk.remove(&self.path);
        }
    }
}

/// What the file says; nothing where it cannot be read, as on systems where a lock keeps readers away too.
fn said(disk: &Disk, path: &Path) -> String {
    let mut bytes = disk.read(path).unwrap_or_default();
    bytes.truncate(LONGEST);
    String::from_utf8_lossy(&bytes).into_owned()
}

/// A run that was just about to write it leaves nothing, or its beginning; a loss of power may leave zeros instead.
fn is_ours(text: &str) -> bool {
    let text = text.trim_end_matches('\0');
    text.starts_with(LEAD) || LEAD.starts_with(text)
}

const LEAD: &str = "locked by ";

fn whose(text: &str) -> String {
    let line = text.lines().next().unwrap_or_default();
    let printable: String = line.chars().filter(|c| !c.is_control()).collect();
    match printable.strip_prefix(LEAD) {
        Some(holder) if !holder.is_empty() => holder.to_owned(),
        _ => "it does not say which".to_owned(),
    }
}

fn text(holder: &str) -> String {
    let holder: String = holder.chars().map(|c| if c.is_control() { ' ' } else { c }).take(LONGEST / 4).collect();
    format!("{LEAD}{holder}, process {} on {}, since {}\n", std::process::id(), host(), utc(SystemTime::now()))
}

fn host() -> String {
    let file = std::fs::read_to_string("/proc/sys/kernel/hostname").ok();
    let variable = || ["HOSTNAME", "COMPUTERNAME"].iter().find_map(|name| std::env::var(name).ok());
    file.or_else(variable).map_or("this computer".to_owned(), |name| name.trim().to_owned())
}

/// A time as `2026-11-22 05:59:20 UTC`; days as in Hinnant, "chrono-compatible low-level date algorithms".
fn utc(time: SystemTime) -> String {
    let seconds = time.duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let (days, second) = (seconds / 86_400 + 719_468, seconds % 86_400);
    let (era, of_era) = (days / 146_097, days % 146_097);
    let year_of_era = (of_era - of_era / 1_460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let from_march = (5 * of_year + 2) / 153;
    let day = of_year - (153 * from_march + 2) / 5 + 1;
    let month = if from_march < 10 { from_march + 3 } else { from_march - 9 };
    let year = year_of_era + 400 * era + u64::from(month <= 2);
    let (hour, minute, second) = (second / 3_600, second / 60 % 60, second % 60);
    format!("{year:04}-{month:02}-{day:02} {hour:02}:{minute:02}:{second:02} UTC")
}

fn knows_no_locks(error: &io::Error) -> bool {
    const ENOLCK: i32 = 37;
    error.kind() == io::ErrorKind::Unsupported || (cfg!(target_os = "linux") && error.raw_os_error() == Some(ENOLCK))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;
    use std::time::Duration;

    #[test]
    fn one_holder_at_a_time_who_is_named() {
        let (folder, disk) = (tempfile::tempdir().unwrap(), Disk::default());
        let take = || take(&disk, folder.path(), "springpot run a.toml").unwrap();
        let Taken::Lock(first) = take() else { panic!() };
        let Taken::Held(holder) = take() else { panic!() };
        let process = format!("springpot run a.toml, process {} on ", std::process::id());
        assert!(holder.starts_with(&process) && holder.ends_with(" UTC"), "{holder}");
        drop(first);
        assert!(!folder.path().join(LOCK).exists());
        assert!(matches!(take(), Taken::Lock(_)));
    }

    #[test]
    fn what_the_dead_leave_locks_nobody_out_and_what_is_not_ours_stays() {
        let (folder, disk) = (tempfile::tempdir().unwrap(), Disk::default());
        let path = folder.path().join(LOCK);
        for left in ["locked by springpot run b.toml, process 1 on x, since then\n", "locked", "", "\0\0\0", "lock\0\0"]
        {
            fs::write(&path, left).unwrap();
            assert!(matches!(take(&disk, folder.path(), "me").unwrap(), Taken::Lock(_)), "{left:?}");
            assert!(!path.exists(), "{left:?}");
        }
        for mine in ["mine\n", "\0mine"] {
            fs::write(&path, mine).unwrap();
            let Taken::Lock(first) = take(&disk, folder.path(), "me").unwrap() else { panic!() };
            assert!(matches!(take(&disk, folder.path(), "you").unwrap(), Taken::Held(_)));
            drop(first);
            assert_eq!(fs::read_to_string(&path).unwrap(), mine);
        }
    }

    #[test]
    fn many_who_come_and_go_never_meet() {
        let folder = tempfile::tempdir().unwrap();
        let inside = std::sync::atomic::AtomicUsize::new(0);
        let taken = std::sync::atomic::AtomicUsize::new(0);
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| {
                    for _ in 0..100 {
                        if let Ok(Taken::Lock(lock)) = take(&Disk::default(), folder.path(), "me") {
                            assert_eq!(inside.fetch_add(1, std::sync::atomic::Ordering::SeqCst), 0);
                            taken.fetch_add(1, std::sync::atomic::Ordering::SeqCst);
                            inside.fetch_sub(1, std::sync::atomic::Ordering::SeqCst);
                            drop(lock);
                        }
                    }
                });
            }
        });
        assert!(taken.into_inner() > 30);
    }

    #[test]
    fn times_are_those_of_the_calendar() {
        for (seconds, text) in [
            (0, "1970-01-01 00:00:00 UTC"),
            (951_782_399, "2000-02-28 23:59:59 UTC"),
            (951_782_400, "2000-02-29 00:00:00 UTC"),
            (1_795_327_160, "2026-11-22 05:59:20 UTC"),
            (4_107_542_400, "2100-03-01 00:00:00 UTC"),
        ] {
            assert_eq!(utc(UNIX_EPOCH + Duration::from_secs(seconds)), text);
        }
    }
}
