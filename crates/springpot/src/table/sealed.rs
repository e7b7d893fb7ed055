//! Files that are there as a whole or not at all, and whose damage is noticed.

use std::fmt;
use std::fs::{self, File};
use std::io::{self, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// The first line of a sealed file: who wrote it, in which format.
const TAG: &str = concat!("springpot ", env!("CARGO_PKG_VERSION"), " checkpoint 2\n");

/// Longest first line that is looked at.
const LONGEST_TAG: usize = 100;

/// Why a sealed file cannot be read.
#[derive(Debug, thiserror::Error)]
pub(crate) enum SealError {
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

/// The 64-bit FNV-1a hash of bytes and of formatted text (Fowler, Noll, Vo): no two of a file's accidents are likely to share it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Fnv(u64);

impl Fnv {
    pub(crate) const fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    pub(crate) const fn value(self) -> u64 {
        self.0
    }

    fn of(bytes: &[u8]) -> u64 {
        let mut hash = Self::new();
        hash.take(bytes);
        hash.0
    }

    fn take(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
}

impl fmt::Write for Fnv {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.take(text.as_bytes());
        Ok(())
    }
}

/// Writes `bytes` to `path`. Whenever this is broken off, by the loss of power too, the file holds either these bytes or those before.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let new = path.with_extension("new");
    let mut file = File::create(&new)?;
    file.write_all(TAG.as_bytes())?;
    file.write_all(&frame(bytes)?)?;
    file.write_all(bytes)?;
    file.sync_all()?;
    fs::rename(&new, path)?;
    // The name is safe once the folder is; not every system opens folders.
    if let Some(folder) = path.parent().and_then(|folder| File::open(folder).ok()) {
        let _ = folder.sync_all();
    }
    Ok(())
}

/// The bytes that [`write`] wrote.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>, SealError> {
    let bytes = fs::read(path)?;
    let Some(rest) = bytes.strip_prefix(TAG.as_bytes()) else {
        let line = bytes.iter().take(LONGEST_TAG).position(|byte| *byte == b'\n').map(|end| &bytes[..end]);
        let line = line.and_then(|line| std::str::from_utf8(line).ok());
        let tag = line.filter(|line| line.starts_with("springpot ") && line.contains(" checkpoint "));
        return Err(tag.map_or(SealError::Damaged, |tag| SealError::OtherVersion(tag.to_owned())));
    };
    match take_record(&mut &*rest)? {
        Taken::Record(record) if record.len() + FRAME == rest.len() => Ok(record),
        _ => Err(SealError::Damaged),
    }
}

/// Length, its complement, and hash.
const FRAME: usize = 4 + 4 + 8;

fn frame(bytes: &[u8]) -> io::Result<[u8; FRAME]> {
    let length = u32::try_from(bytes.len()).map_err(|_| io::Error::from(io::ErrorKind::FileTooLarge))?;
    let mut frame = [0; FRAME];
    frame[..4].copy_from_slice(&length.to_le_bytes());
    frame[4..8].copy_from_slice(&(!length).to_le_bytes());
    frame[8..].copy_from_slice(&Fnv::of(bytes).to_le_bytes());
    Ok(frame)
}

/// What stands where a record should.
enum Taken {
    Record(Vec<u8>),
    /// Less than was to be written.
    Half,
    Nothing,
}

fn take_record(from: &mut impl Read) -> Result<Taken, SealError> {
    let mut frame = Vec::new();
    from.by_ref().take(FRAME as u64).read_to_end(&mut frame)?;
    if frame.len() < FRAME {
        return Ok(if frame.is_empty() { Taken::Nothing } else { Taken::Half });
    }
    let number = |at: usize| u32::from_le_bytes([frame[at], frame[at + 1], frame[at + 2], frame[at + 3]]);
    let length = number(0);
    if length != !number(4) {
        return Err(SealError::Damaged);
    }
    let mut record = Vec::new();
    from.by_ref().take(length.into()).read_to_end(&mut record)?;
    if record.len() < length as usize {
        return Ok(Taken::Half);
    }
    if Fnv::of(&record).to_le_bytes() != frame[8..] {
        return Err(SealError::Damaged);
    }
    Ok(Taken::Record(record))
}

/// Takes a record and its place.
type Visit<'a> = &'a mut dyn FnMut(u64, &[u8]) -> Result<(), SealError>;

/// Records, one after the other.
#[derive(Debug)]
pub(crate) struct Journal {
    file: File,
    path: PathBuf,
}

impl Journal {
    /// An empty journal.
    pub(crate) fn create(path: &Path) -> io::Result<Self> {
        File::create(path)?;
        Ok(Self { file: File::options().append(true).open(path)?, path: path.to_owned() })
    }

    /// Hands every record and its place to `visit`, in their order. Half a record at the end, which a kill may leave, is cut off.
    pub(crate) fn open(path: &Path, visit: Visit<'_>) -> Result<Self, SealError> {
        let mut reader = BufReader::new(File::open(path)?);
        let mut at = 0;
        loop {
            match take_record(&mut reader)? {
                Taken::Record(record) => {
                    visit(at, &record)?;
                    at += (FRAME + record.len()) as u64;
                }
                Taken::Half => {
                    File::options().write(true).open(path)?.set_len(at)?;
                    break;
                }
                Taken::Nothing => break,
            }
        }
        Ok(Self { file: File::options().append(true).open(path)?, path: path.to_owned() })
    }

    /// Adds one record.
    pub(crate) fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        let whole = [&frame(bytes)?[..], bytes].concat();
        self.file.write_all(&whole)
    }

    /// Waits until all records are safe from the loss of power.
    pub(crate) fn sync(&self) -> io::Result<()> {
        self.file.sync_data()
    }

    /// The record at a place that [`Self::open`] told.
    pub(crate) fn record(&self, at: u64) -> Result<Vec<u8>, SealError> {
        let mut file = File::open(&self.path)?;
        file.seek(SeekFrom::Start(at))?;
        match take_record(&mut file)? {
            Taken::Record(record) => Ok(record),
            _ => Err(SealError::Damaged),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_cut_or_changed_is_never_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("case-1");
        write(&path, b"old").unwrap();
        write(&path, b"the state of a run").unwrap();
        assert_eq!(read(&path).unwrap(), b"the state of a run");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        let good = fs::read(&path).unwrap();
        for length in 0..good.len() {
            fs::write(&path, &good[..length]).unwrap();
            assert!(matches!(read(&path), Err(SealError::Damaged)), "{length}");
        }
        for at in 0..good.len() {
            for bit in 0..8 {
                let mut bad = good.clone();
                bad[at] ^= 1 << bit;
                fs::write(&path, &bad).unwrap();
                let refused = matches!(read(&path), Err(SealError::Damaged | SealError::OtherVersion(_)));
                assert!(refused, "byte {at}, bit {bit}");
            }
        }
        fs::write(&path, [&good[..], b"x"].concat()).unwrap();
        assert!(matches!(read(&path), Err(SealError::Damaged)));
        fs::write(&path, "springpot 99.1.0 checkpoint 7\nwhatever").unwrap();
        assert!(matches!(read(&path), Err(SealError::OtherVersion(tag)) if tag == "springpot 99.1.0 checkpoint 7"));
    }

    #[test]
    fn half_a_record_is_cut_off_and_a_changed_one_is_noticed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("done");
        let mut journal = Journal::create(&path).unwrap();
        ["first", "", "third"].iter().for_each(|text| journal.append(text.as_bytes()).unwrap());
        let good = fs::read(&path).unwrap();
        let records = |path: &Path| {
            let mut found: Vec<(u64, Vec<u8>)> = Vec::new();
            let journal = Journal::open(path, &mut |at, record| {
                found.push((at, record.to_vec()));
                Ok(())
            })?;
            for (at, record) in &found {
                assert_eq!(&journal.record(*at)?, record);
            }
            Ok::<_, SealError>(found.into_iter().map(|(_, record)| record).collect::<Vec<_>>())
        };
        assert_eq!(records(&path).unwrap(), [&b"first"[..], b"", b"third"]);
        for length in 0..good.len() {
            fs::write(&path, &good[..length]).unwrap();
            let whole = records(&path).unwrap();
            assert!(whole.len() < 3);
            Journal::open(&path, &mut |_, _| Ok(())).unwrap().append(b"new").unwrap();
            assert_eq!(records(&path).unwrap(), [whole, vec![b"new".to_vec()]].concat());
        }
        for at in 0..good.len() {
            let mut bad = good.clone();
            bad[at] ^= 0x10;
            fs::write(&path, &bad).unwrap();
            assert!(matches!(records(&path), Err(SealError::Damaged)), "byte {at}");
        }
    }
}
