//! Bytes whose damage is noticed, in memory or in files that are there as a whole or not at all.

use super::disk::{Disk, DiskFile};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::io::{self, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// The first line of a file of a checkpoint: who wrote it, in which format. Another build may round differently.
pub(crate) const CHECKPOINT: &str =
    concat!("springpot ", env!("CARGO_PKG_VERSION"), " checkpoint 4, build ", env!("SPRINGPOT_BUILD"), "\n");

/// What every first line says of its file.
const TAGGED: [&str; 2] = [" checkpoint ", " commit "];

/// Longest first line that is looked at.
const LONGEST_TAG: usize = 100;

/// Why what was sealed cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum SealError {
    /// The file system's reason.
    #[error(transparent)]
    File(#[from] io::Error),
    /// Another version wrote it; its first line.
    #[error("written by {0:?}")]
    OtherVersion(String),
    /// Some of its bytes are missing or others than were written.
    #[error("damaged")]
    Damaged,
}

/// `bytes` behind the line `tag`, so that their damage is noticed.
pub(crate) fn sealed(tag: &str, bytes: &[u8]) -> io::Result<Vec<u8>> {
    Ok([tag.as_bytes(), &frame(bytes)?, bytes].concat())
}

/// The bytes that [`sealed()`] put behind the line `tag`.
pub(crate) fn opened<'a>(tag: &str, bytes: &'a [u8]) -> Result<&'a [u8], SealError> {
    let Some(rest) = bytes.strip_prefix(tag.as_bytes()) else {
        return Err(line(bytes).map_or(SealError::Damaged, |line| SealError::OtherVersion(line.to_owned())));
    };
    match rest.split_at_checked(FRAME) {
        Some((frame, body)) if self::frame(body)? == frame => Ok(body),
        _ => Err(SealError::Damaged),
    }
}

/// A value as bytes behind the line `tag`, which says what it is and in which format.
///
/// # Errors
/// More than 4 GiB.
pub fn seal(tag: &str, value: &impl Serialize) -> io::Result<Vec<u8>> {
    sealed(tag, &postcard::to_stdvec(value).map_err(io::Error::other)?)
}

/// The value that [`seal`] made bytes of, with the same `tag`.
///
/// ```
/// use springpot_run::{open, seal};
///
/// let mut bytes = seal("springpot pair 1\n", &(1.5, 2.5))?;
/// assert_eq!(open::<(f64, f64)>("springpot pair 1\n", &bytes)?, (1.5, 2.5));
/// bytes[20] ^= 1;
/// assert!(open::<(f64, f64)>("springpot pair 1\n", &bytes).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`SealError`].
pub fn open<T: DeserializeOwned>(tag: &str, bytes: &[u8]) -> Result<T, SealError> {
    match postcard::take_from_bytes(opened(tag, bytes)?) {
        Ok((value, [])) => Ok(value),
        _ => Err(SealError::Damaged),
    }
}

/// Writes `bytes` to `path` behind the line `tag`. Whenever this is broken off, by the loss of power too, the file holds either these
/// bytes or those before.
pub(crate) fn write(disk: &Disk, path: &Path, tag: &str, bytes: &[u8]) -> io::Result<()> {
    let new = path.with_extension("new");
    let mut file = disk.create(&new)?;
    file.write_all(&sealed(tag, bytes)?)?;
    file.sync()?;
    disk.rename(&new, path)?;
    path.parent().map_or(Ok(()), |folder| disk.sync_folder(folder))
}

/// The bytes that [`write()`] wrote behind the line `tag`.
pub(crate) fn read(disk: &Disk, path: &Path, tag: &str) -> Result<Vec<u8>, SealError> {
    opened(tag, &disk.read(path)?).map(<[u8]>::to_vec)
}

/// The first line of a sealed file, whoever sealed it; `None` where it is something else.
pub(crate) fn first_line(bytes: &[u8]) -> Option<&str> {
    line(bytes).filter(|line| TAGGED.iter().any(|word| line.contains(word)))
}

/// The first line of anything that was sealed.
fn line(bytes: &[u8]) -> Option<&str> {
    let end = bytes.iter().take(LONGEST_TAG).position(|byte| *byte == b'\n')?;
    std::str::from_utf8(&bytes[..end]).ok().filter(|line| line.starts_with("springpot "))
}

/// Length, its complement, and CRC-32.
const FRAME: usize = 4 + 4 + 4;

fn frame(bytes: &[u8]) -> io::Result<[u8; FRAME]> {
    let length = u32::try_from(bytes.len()).map_err(|_| io::Error::from(io::ErrorKind::FileTooLarge))?;
    let mut frame = [0; FRAME];
    frame[..4].copy_from_slice(&length.to_le_bytes());
    frame[4..8].copy_from_slice(&(!length).to_le_bytes());
    frame[8..].copy_from_slice(&crc32fast::hash(bytes).to_le_bytes());
    Ok(frame)
}

/// What stands where a record should.
enum Taken {
    Record(Vec<u8>),
    /// Less than was to be written.
    Half,
    /// Other bytes than were written.
    Other,
    Nothing,
}

fn take_record(from: &mut impl Read) -> io::Result<Taken> {
    let mut frame = Vec::new();
    from.by_ref().take(FRAME as u64).read_to_end(&mut frame)?;
    if frame.len() < FRAME {
        return Ok(if frame.is_empty() { Taken::Nothing } else { Taken::Half });
    }
    let number = |at: usize| u32::from_le_bytes([frame[at], frame[at + 1], frame[at + 2], frame[at + 3]]);
    let length = number(0);
    if length != !number(4) {
        return Ok(Taken::Other);
    }
    let mut record = Vec::new();
    from.by_ref().take(length.into()).read_to_end(&mut record)?;
    if record.len() < length as usize {
        return Ok(Taken::Half);
    }
    Ok(if crc32fast::hash(&record) == number(8) { Taken::Record(record) } else { Taken::Other })
}

/// Takes a record and its place.
type Visit<'a> = &'a mut dyn FnMut(u64, &[u8]) -> Result<(), SealError>;

/// Records, one after the other.
#[derive(Debug)]
pub(crate) struct Journal {
    file: DiskFile,
    path: PathBuf,
    disk: Disk,
}

/// A journal that was read, and is not yet gone on with.
#[derive(Debug)]
pub(crate) struct Recorded {
    path: PathBuf,
    /// Where its sound records end.
    end: u64,
}

impl Recorded {
    /// Hands every record and its place to `visit`, in their order. A last record that is not whole, or not what was written, as a kill
    /// or a loss of power leaves it, counts as not there.
    pub(crate) fn read(disk: &Disk, path: &Path, visit: Visit<'_>) -> Result<Self, SealError> {
        let mut reader = BufReader::new(disk.open(path)?);
        let mut end = 0;
        loop {
            match take_record(&mut reader)? {
                Taken::Record(record) => {
                    visit(end, &record)?;
                    end += (FRAME + record.len()) as u64;
                }
                Taken::Nothing => break,
                Taken::Half | Taken::Other => {
                    reader.seek(SeekFrom::Start(end))?;
                    let mut rest = Vec::new();
                    reader.read_to_end(&mut rest)?;
                    if holds_a_record(&rest[1..])? {
                        return Err(SealError::Damaged);
                    }
                    break;
                }
            }
        }
        Ok(Self { path: path.to_owned(), end })
    }

    /// Goes on behind the last sound record; what stands there is cut off.
    pub(crate) fn go_on(self, disk: &Disk) -> io::Result<Journal> {
        let mut file = disk.edit(&self.path)?;
        file.set_length(self.end)?;
        file.seek(SeekFrom::Start(self.end))?;
        Ok(Journal { file, path: self.path, disk: disk.clone() })
    }
}

/// Whether a sound record of any length but 0 begins anywhere: then what stands before it is no torn end.
fn holds_a_record(bytes: &[u8]) -> io::Result<bool> {
    for at in 0..bytes.len() {
        let Some(frame) = bytes.get(at..at + 8) else { break };
        // Records that do not end in the file, and nearly all other places, are seen here.
        let complements = (0..4).all(|k| frame[k] == !frame[k + 4]);
        if complements && matches!(take_record(&mut &bytes[at..])?, Taken::Record(record) if !record.is_empty()) {
            return Ok(true);
        }
    }
    Ok(false)
}

impl Journal {
    /// An empty journal.
    pub(crate) fn create(disk: &Disk, path: &Path) -> io::Result<Self> {
        Ok(Self { file: disk.create(path)?, path: path.to_owned(), disk: disk.clone() })
    }

    /// Adds one record.
    pub(crate) fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        let whole = [&frame(bytes)?[..], bytes].concat();
        self.file.write_all(&whole)
    }

    /// Waits until all records are safe from the loss of power.
    pub(crate) fn sync(&self) -> io::Result<()> {
        self.file.sync()
    }

    /// The record at a place that [`Recorded::read`] told.
    pub(crate) fn record(&self, at: u64) -> Result<Vec<u8>, SealError> {
        record(&self.disk, &self.path, at)
    }
}

/// The record of a journal at a place that [`Recorded::read`] told.
pub(crate) fn record(disk: &Disk, path: &Path, at: u64) -> Result<Vec<u8>, SealError> {
    let mut file = disk.open(path)?;
    file.seek(SeekFrom::Start(at))?;
    match take_record(&mut file)? {
        Taken::Record(record) => Ok(record),
        _ => Err(SealError::Damaged),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn what_is_cut_or_changed_is_never_read() {
        let (folder, disk) = (tempfile::tempdir().unwrap(), Disk::default());
        let path = folder.path().join("case-1");
        let write = |bytes: &[u8]| super::write(&disk, &path, CHECKPOINT, bytes).unwrap();
        let read = || super::read(&disk, &path, CHECKPOINT);
        write(b"old");
        write(b"the state of a run");
        assert_eq!(read().unwrap(), b"the state of a run");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        let good = fs::read(&path).unwrap();
        for length in 0..good.len() {
            fs::write(&path, &good[..length]).unwrap();
            assert!(matches!(read(), Err(SealError::Damaged)), "{length}");
        }
        for at in 0..good.len() {
            for bit in 0..8 {
                let mut bad = good.clone();
                bad[at] ^= 1 << bit;
                fs::write(&path, &bad).unwrap();
                let refused = matches!(read(), Err(SealError::Damaged | SealError::OtherVersion(_)));
                assert!(refused, "byte {at}, bit {bit}");
            }
        }
        fs::write(&path, [&good[..], b"x"].concat()).unwrap();
        assert!(matches!(read(), Err(SealError::Damaged)));
        fs::write(&path, "springpot 99.1.0 checkpoint 7\nwhatever").unwrap();
        assert!(matches!(read(), Err(SealError::OtherVersion(tag)) if tag == "springpot 99.1.0 checkpoint 7"));
    }

    /// What a journal holds; every record is found at its place again.
    fn records(path: &Path) -> Result<Vec<Vec<u8>>, SealError> {
        let (disk, mut found) = (Disk::default(), Vec::<(u64, Vec<u8>)>::new());
        let recorded = Recorded::read(&disk, path, &mut |at, record| {
            found.push((at, record.to_vec()));
            Ok(())
        })?;
        let journal = recorded.go_on(&disk)?;
        for (at, record) in &found {
            assert_eq!(&journal.record(*at)?, record);
        }
        Ok(found.into_iter().map(|(_, record)| record).collect())
    }

    #[test]
    fn a_torn_end_is_cut_off_and_a_changed_record_is_noticed() {
        let (folder, disk) = (tempfile::tempdir().unwrap(), Disk::default());
        let path = folder.path().join("done");
        let mut journal = Journal::create(&disk, &path).unwrap();
        ["first", "", "third"].iter().for_each(|text| journal.append(text.as_bytes()).unwrap());
        let good = fs::read(&path).unwrap();
        assert_eq!(records(&path).unwrap(), [&b"first"[..], b"", b"third"]);
        for length in 0..good.len() {
            // What is lost at the end is missing, or is zeros, or others follow it.
            for (more, with) in [(0, 0), (good.len() - length, 0), (40, 0), (40, 0xff)] {
                fs::write(&path, [&good[..length], &vec![with; more]].concat()).unwrap();
                let whole = records(&path).unwrap();
                assert!(whole.len() < 3, "{length} {more}");
                assert!(whole.iter().zip([&b"first"[..], b"", b"third"]).all(|(found, wrote)| found == wrote));
                Recorded::read(&disk, &path, &mut |_, _| Ok(())).unwrap().go_on(&disk).unwrap().append(b"new").unwrap();
                assert_eq!(records(&path).unwrap(), [whole, vec![b"new".to_vec()]].concat());
            }
        }
        let last = good.len() - FRAME - "third".len();
        for at in 0..good.len() {
            let mut bad = good.clone();
            bad[at] ^= 0x10;
            fs::write(&path, &bad).unwrap();
            match records(&path) {
                Err(SealError::Damaged) => assert!(at < last, "byte {at}"),
                found => assert!(at >= last && found.unwrap().len() == 2, "byte {at}"),
            }
        }
    }
}
