//! The file system as a run sees it: one door for every call, at which a test can stand.
//!
//! Results, checkpoints and locks are read and written through a [`Disk`] alone. The one that users have passes everything on; one with
//! a [`Watch`] asks it first, and so fails, stops, or is written down at any call.

use std::fmt;
use std::fs::{self, File, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

/// How often a lock is tried, and how long it is waited in between.
const LOOKS: usize = 4;
const LOOK: Duration = Duration::from_millis(5);

/// One call to the file system.
#[derive(Debug, Clone, Copy)]
pub enum Call<'a> {
    /// What stands at a path.
    Look(&'a Path),
    /// The names in a folder.
    List(&'a Path),
    /// Opens a file to be read.
    Open(&'a Path),
    /// Reads a piece of a file.
    Read(&'a Path),
    /// Makes a folder and those above it.
    CreateFolder(&'a Path),
    /// Makes a file where there is none.
    Create(&'a Path),
    /// Opens a file to be written.
    Edit(&'a Path),
    /// Opens the file of a lock, which is made where there is none, and locks it.
    Lock(&'a Path),
    /// Writes into a file.
    Write {
        /// The file, by the name that it was opened with.
        file: &'a Path,
        /// Where in the file.
        at: u64,
        /// What.
        bytes: &'a [u8],
    },
    /// Cuts or extends a file.
    SetLength {
        /// The file.
        file: &'a Path,
        /// Its new length.
        length: u64,
    },
    /// Waits until a file is safe from the loss of power.
    Sync(&'a Path),
    /// Waits until the names in a folder are safe from the loss of power.
    SyncFolder(&'a Path),
    /// Gives a file another name, and replaces what had it.
    Rename {
        /// The old name.
        from: &'a Path,
        /// The new name.
        to: &'a Path,
    },
    /// Removes a file.
    Remove(&'a Path),
    /// Removes an empty folder.
    RemoveFolder(&'a Path),
}

/// What a [`Watch`] lets happen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// The call.
    Go,
    /// So many bytes of a write; any other call whole.
    Part(usize),
    /// Nothing where it is a sync, which then is said to be done; any other call whole.
    Pretend,
}

/// Stands at the door of a [`Disk`].
pub trait Watch: fmt::Debug + Send + Sync {
    /// Called before every call, from any thread.
    ///
    /// # Errors
    /// What the call is to fail with, undone.
    fn before(&self, call: &Call<'_>) -> io::Result<Verdict>;
}

/// The file system.
#[derive(Debug, Clone, Default)]
pub struct Disk {
    watch: Option<Arc<dyn Watch>>,
}

/// What stands at a path; links are not followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Entry {
    /// A file of so many bytes.
    File(u64),
    Folder,
    /// A link, a device, or the like.
    Other,
}

/// An open file.
#[derive(Debug)]
pub(crate) struct DiskFile {
    file: File,
    path: Arc<Path>,
    disk: Disk,
}

impl Disk {
    /// The file system with somebody at its door.
    pub fn watched(watch: Arc<dyn Watch>) -> Self {
        Self { watch: Some(watch) }
    }

    fn ask(&self, call: Call<'_>) -> io::Result<Verdict> {
        self.watch.as_ref().map_or(Ok(Verdict::Go), |watch| watch.before(&call))
    }

    /// What stands at a path; `None` where nothing does.
    pub(crate) fn look(&self, path: &Path) -> io::Result<Option<Entry>> {
        self.ask(Call::Look(path))?;
        match fs::symlink_metadata(path) {
            Ok(about) if about.is_file() => Ok(Some(Entry::File(about.len()))),
            Ok(about) => Ok(Some(if about.is_dir() { Entry::Folder } else { Entry::Other })),
            Err(error) if matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// Whether a folder, or a link to one, stands at a path.
    pub(crate) fn is_folder(&self, path: &Path) -> bool {
        self.ask(Call::Look(path)).is_ok() && path.is_dir()
    }

    /// The names in a folder, in their order; none where there is no folder.
    pub(crate) fn list(&self, folder: &Path) -> io::Result<Vec<String>> {
        self.ask(Call::List(folder))?;
        let entries = match fs::read_dir(folder) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
            entries => entries?,
        };
        let name = |entry: io::Result<fs::DirEntry>| Ok(entry?.file_name().to_string_lossy().into_owned());
        let mut names = entries.map(name).collect::<io::Result<Vec<_>>>()?;
        names.sort_unstable();
        Ok(names)
    }

    /// Opens a file to be read.
    pub(crate) fn open(&self, path: &Path) -> io::Result<DiskFile> {
        self.ask(Call::Open(path))?;
        // A FIFO would be waited for, and a device has no end.
        let about = fs::metadata(path)?;
        if !about.is_file() && !about.is_dir() {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "it is no ordinary file"));
        }
        Ok(self.file(File::open(path)?, path))
    }

    /// All bytes of a file.
    pub(crate) fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        self.open(path)?.read_to_end(&mut bytes)?;
        Ok(bytes)
    }

    /// Makes a folder, and those above it; one that is there is no error.
    pub(crate) fn create_folders(&self, path: &Path) -> io::Result<()> {
        self.ask(Call::CreateFolder(path))?;
        fs::create_dir_all(path)
    }

    /// Makes a folder in one that is there; one that is there itself is no error.
    pub(crate) fn create_folder(&self, path: &Path) -> io::Result<()> {
        self.ask(Call::CreateFolder(path))?;
        match fs::create_dir(path) {
            Err(error) if error.kind() != io::ErrorKind::AlreadyExists || !path.is_dir() => Err(error),
            _ => Ok(()),
        }
    }

    /// Makes an empty file; what stands there is removed first, so that no link is followed.
    pub(crate) fn create(&self, path: &Path) -> io::Result<DiskFile> {
        self.remove(path)?;
        self.ask(Call::Create(path))?;
        let file = File::options().read(true).write(true).create_new(true).open(path)?;
        Ok(self.file(file, path))
    }

    /// Opens a file to be written from its beginning.
    pub(crate) fn edit(&self, path: &Path) -> io::Result<DiskFile> {
        self.ask(Call::Edit(path))?;
        Ok(self.file(File::options().read(true).write(true).open(path)?, path))
    }

    /// Opens the file of a lock and locks it; `None` where somebody else has it.
    pub(crate) fn lock(&self, path: &Path) -> io::Result<Option<DiskFile>> {
        self.ask(Call::Lock(path))?;
        let file = File::options().read(true).write(true).create(true).truncate(false).open(path)?;
        // One that only looks ([`Self::is_locked`]) lets go at once.
        for _ in 0..LOOKS {
            match file.try_lock() {
                Ok(()) => return Ok(Some(self.file(file, path))),
                Err(TryLockError::WouldBlock) => std::thread::sleep(LOOK),
                Err(TryLockError::Error(error)) => return Err(error),
            }
        }
        Ok(None)
    }

    /// Whether somebody holds the lock of a file, which is shared for a moment to see it; where there are no locks, whether the file is there.
    pub(crate) fn is_locked(&self, path: &Path) -> bool {
        self.open(path).is_ok_and(|opened| opened.file.try_lock_shared().is_err())
    }

    /// Gives a file another name, and replaces what had it.
    pub(crate) fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        self.ask(Call::Rename { from, to })?;
        fs::rename(from, to)
    }

    /// Removes a file, or a link to one; where nothing is, nothing happens.
    pub(crate) fn remove(&self, path: &Path) -> io::Result<()> {
        self.ask(Call::Remove(path))?;
        match fs::remove_file(path) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
            _ => Ok(()),
        }
    }

    /// Removes a folder, unless it holds something; where nothing is, nothing happens.
    pub(crate) fn remove_folder(&self, path: &Path) -> io::Result<()> {
        self.ask(Call::RemoveFolder(path))?;
        match fs::remove_dir(path) {
            Err(error) if !matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::DirectoryNotEmpty) => {
                Err(error)
            }
            _ => Ok(()),
        }
    }

    /// Waits until the names in a folder are safe from the loss of power.
    pub(crate) fn sync_folder(&self, path: &Path) -> io::Result<()> {
        if self.ask(Call::SyncFolder(path))? == Verdict::Pretend {
            return Ok(());
        }
        match File::open(path) {
            Ok(folder) => folder.sync_all(),
            // Not every system opens folders.
            Err(_) if !cfg!(unix) => Ok(()),
            Err(error) => Err(error),
        }
    }

    fn file(&self, file: File, path: &Path) -> DiskFile {
        DiskFile { file, path: path.into(), disk: self.clone() }
    }
}

impl DiskFile {
    /// Another handle to the same file, with the same position.
    pub(crate) fn try_clone(&self) -> io::Result<Self> {
        Ok(Self { file: self.file.try_clone()?, path: self.path.clone(), disk: self.disk.clone() })
    }

    pub(crate) fn set_length(&self, length: u64) -> io::Result<()> {
        self.disk.ask(Call::SetLength { file: &self.path, length })?;
        self.file.set_len(length)
    }

    /// Waits until all that was written is safe from the loss of power.
    pub(crate) fn sync(&self) -> io::Result<()> {
        match self.disk.ask(Call::Sync(&self.path))? {
            Verdict::Pretend => Ok(()),
            _ => self.file.sync_data(),
        }
    }

    /// Whether its path still leads to it.
    pub(crate) fn is_in_place(&self) -> io::Result<bool> {
        self.disk.ask(Call::Look(&self.path))?;
        #[cfg(unix)]
        {
            use std::os::unix::fs::MetadataExt as _;
            let (own, there) = (self.file.metadata()?, fs::symlink_metadata(&self.path));
            Ok(there.is_ok_and(|there| (there.dev(), there.ino()) == (own.dev(), own.ino())))
        }
        #[cfg(not(unix))]
        Ok(true)
    }
}

impl Read for DiskFile {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.disk.ask(Call::Read(&self.path))?;
        self.file.read(bytes)
    }
}

impl Write for DiskFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let Some(watch) = &self.disk.watch else { return self.file.write(bytes) };
        let at = self.file.stream_position()?;
        let most = match watch.before(&Call::Write { file: &self.path, at, bytes })? {
            Verdict::Part(most) => most.min(bytes.len()),
            _ => bytes.len(),
        };
        self.file.write(&bytes[..most])
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Seek for DiskFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}
