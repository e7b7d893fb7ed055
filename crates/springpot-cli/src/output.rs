//! Files that a command writes: there whole or not at all.
//!
//! The text of a regular file goes into a new file beside it, which takes its name at the end: until then, and after any failure,
//! what was there before is still there. A link is followed, and the file that it leads to is replaced. Devices, pipes and open
//! descriptors (`/dev/stdout`) are written to as they are.

use crate::signals;
use crate::{Ending, diagnostic};
use std::ffi::OsStr;
use std::fs::{self, File, Metadata};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock, PoisonError};
use tempfile::TempPath;

/// Bytes that are written to a file at a time.
const CHUNK: usize = 1 << 16;

/// Links that are followed one after another, as many as Linux does.
const MOST_LINKS: usize = 40;

/// Folders of the descriptors of this process.
const DESCRIPTORS: [&str; 2] = ["/dev/fd", "/proc/self/fd"];

/// The file that takes another one's name at the end; Ctrl-C takes it away.
static UNFINISHED: Mutex<Option<PathBuf>> = Mutex::new(None);

/// What is being written.
pub(crate) struct Output(Sink);

enum Sink {
    /// A new file beside `target`.
    Beside { file: BufWriter<File>, path: TempPath, target: PathBuf },
    /// What is no file to be replaced.
    Stream(BufWriter<Box<dyn Write>>),
}

/// Where a path leads behind its links.
enum Goal {
    /// To a file, which need not be there.
    File(PathBuf),
    /// To a device or a pipe.
    Stream(PathBuf),
    /// To an open descriptor of this process.
    Descriptor(PathBuf),
}

impl Output {
    /// Opens `path`; a pipe waits for its reader.
    ///
    /// # Errors
    /// The file system's: also where the file or its folder must not be written.
    pub(crate) fn open(path: &Path) -> io::Result<Self> {
        let target = match goal(path)? {
            Goal::File(target) => target,
            stream => return Ok(Self(Sink::Stream(BufWriter::new(stream.open()?)))),
        };
        if found(&target)?.is_some() {
            // A file that must not be written is not replaced either.
            File::options().write(true).open(&target)?;
        }
        let (file, path) = beside(&target)?;
        Ok(Self(Sink::Beside { file: BufWriter::with_capacity(CHUNK, file), path, target }))
    }

    /// Whether what was written is out already.
    pub(crate) fn is_stream(&self) -> bool {
        matches!(self.0, Sink::Stream(_))
    }

    /// Gives the file its name, when all of it is on the disk; the rights of the file that it replaces are kept.
    pub(crate) fn finish(mut self) -> io::Result<()> {
        self.flush()?;
        let Sink::Beside { file, path, target } = self.0 else { return Ok(()) };
        let file = file.into_inner().map_err(io::IntoInnerError::into_error)?;
        if let Some(before) = found(&target)? {
            keep_owner(&path, &before);
            file.set_permissions(before.permissions())?;
        }
        file.sync_all()?;
        path.persist(&target)?;
        sync_folder(&target);
        Ok(())
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.0 {
            Sink::Beside { file, .. } => file.write(bytes),
            Sink::Stream(stream) => stream.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.0 {
            Sink::Beside { file, .. } => file.flush(),
            Sink::Stream(stream) => stream.flush(),
        }
    }
}

/// Writes a whole text.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut output = Output::open(path)?;
    output.write_all(bytes)?;
    output.finish()
}

/// Whether `path` is that of a file or a folder, or of a link that leads nowhere: of what [`create`] does not touch.
pub(crate) fn is_taken(path: &Path) -> bool {
    path.symlink_metadata().is_ok() && !matches!(goal(path), Ok(Goal::Stream(_) | Goal::Descriptor(_)))
}

/// Whether two paths lead to one file.
pub(crate) fn is_same_file(one: &Path, other: &Path) -> bool {
    let is_file = |path: &Path| path.metadata().is_ok_and(|found| found.is_file());
    is_file(one) && is_file(other) && fs::canonicalize(one).ok() == fs::canonicalize(other).ok()
}

/// Writes a whole text where nothing is yet; returns whether it went into a file.
///
/// # Errors
/// `AlreadyExists` where something is, and the file system's.
pub(crate) fn create(path: &Path, bytes: &[u8]) -> io::Result<bool> {
    let goal = goal(path)?;
    if !matches!(goal, Goal::File(_)) {
        let mut stream = goal.open()?;
        stream.write_all(bytes).and_then(|()| stream.flush())?;
        return Ok(false);
    }
    let (mut file, new) = beside(path)?;
    file.write_all(bytes)?;
    file.sync_all()?;
    new.persist_noclobber(path)?;
    sync_folder(path);
    Ok(true)
}

/// How a command ends that wrote `path`, or could not.
pub(crate) fn written(path: &Path, result: io::Result<()>) -> Ending {
    match result {
        Ok(()) => Ending::Done,
        // Whoever reads a pipe has read enough.
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ending::Done,
        Err(error) => {
            diagnostic::error(format!("{} cannot be written: {error}", path.display()));
            Ending::Failed
        }
    }
}

/// What stands at `path`, links followed; `None` where nothing does.
fn found(path: &Path) -> io::Result<Option<Metadata>> {
    match fs::metadata(path) {
        Ok(found) => Ok(Some(found)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error),
    }
}

/// Follows the links of `path`.
fn goal(path: &Path) -> io::Result<Goal> {
    let mut at = path.to_owned();
    for _ in 0..MOST_LINKS {
        if at.parent().is_some_and(|folder| DESCRIPTORS.iter().any(|own| folder == Path::new(own))) {
            return Ok(Goal::Descriptor(at));
        }
        match fs::read_link(&at) {
            Ok(next) => at = at.parent().unwrap_or(Path::new("")).join(next),
            // No link: all of them are followed.
            Err(_) => break,
        }
    }
    match found(&at)? {
        Some(found) if found.is_dir() => Err(io::ErrorKind::IsADirectory.into()),
        Some(found) if !found.is_file() => Ok(Goal::Stream(at)),
        _ => Ok(Goal::File(at)),
    }
}

impl Goal {
    /// Opens what is there to write to it as it is.
    fn open(&self) -> io::Result<Box<dyn Write>> {
        let mut how = File::options();
        let opened = match self {
            Self::File(path) | Self::Stream(path) => how.write(true).open(path),
            Self::Descriptor(path) => match path.file_name().and_then(OsStr::to_str) {
                Some("1") => return Ok(Box::new(io::stdout())),
                Some("2") => return Ok(Box::new(io::stderr())),
                // What it leads to may hold something already.
                _ => how.append(true).open(path),
            },
        };
        Ok(Box::new(opened?))
    }
}

/// A new file in the folder of `target`, with a name that no other has. Ctrl-C takes it away.
fn beside(target: &Path) -> io::Result<(File, TempPath)> {
    let open = |path: &Path| File::options().write(true).create_new(true).open(path);
    clean_up_on_interrupt();
    // Held until the file's name is known: an interrupt in between waits for it.
    let mut known = unfinished();
    let made = tempfile::Builder::new().prefix(".springpot-").suffix(".part").make_in(folder_of(target), open)?;
    let (file, path) = made.into_parts();
    *known = Some(path.to_path_buf());
    Ok((file, path))
}

fn folder_of(file: &Path) -> &Path {
    file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Gives `file` the owner of the file that it replaces, where that is allowed.
#[cfg(unix)]
fn keep_owner(file: &Path, before: &Metadata) {
    use std::os::unix::fs::MetadataExt;
    // Without the right to it the file belongs to who wrote it, as any new one does.
    let _ = std::os::unix::fs::chown(file, Some(before.uid()), Some(before.gid()));
}

#[cfg(not(unix))]
fn keep_owner(_: &Path, _: &Metadata) {}

/// Brings the new name to the disk, where the system can.
fn sync_folder(target: &Path) {
    if cfg!(unix)
        && let Ok(folder) = File::open(folder_of(target))
    {
        // The file itself is whole either way.
        let _ = folder.sync_all();
    }
}

fn unfinished() -> std::sync::MutexGuard<'static, Option<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// From here on Ctrl-C takes the file that is not finished away before it ends the process.
fn clean_up_on_interrupt() {
    static INSTALLED: OnceLock<()> = OnceLock::new();
    INSTALLED.get_or_init(|| {
        signals::before_the_end(|| {
            if let Some(file) = unfinished().take() {
                let _ = fs::remove_file(file);
            }
        });
    });
}
