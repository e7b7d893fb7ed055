//! Files of triangles as robots use them: STL, OBJ and COLLADA.
//!
//! Such files come from strangers. Nothing outside the folder that is named is opened; what a file says of its sizes is compared with what is there
//! before anything is made of it; nothing recurses; bytes, tags, instances and triangles are bounded. What does not fit is refused with its reason.

mod collada;
mod material;
mod obj;
mod sink;
mod stl;

use std::fs::{self, File};
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};

use sink::Sink;
pub(crate) use sink::{Part, Surface};

/// Largest file that is read, bytes.
pub(crate) const LARGEST: u64 = 64 << 20;
/// Most triangles of a file; a binary STL file of the largest size holds fewer.
const MOST_TRIANGLES: usize = 1_500_000;
/// Farthest coordinate, in the unit of the file.
const FARTHEST: f32 = 1e9;

/// Where a file of triangles is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MeshFile {
    /// The file.
    pub path: PathBuf,
    /// The folder of the robot, or its package, that holds it: what the file names outside of it is not opened.
    pub folder: PathBuf,
}

/// Why a file is not drawn.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Unread {
    #[error("it is not there")]
    NotThere,
    #[error("it is outside the folder of the robot and its packages")]
    Outside,
    #[error("it is no ordinary file")]
    NotAFile,
    #[error("it is larger than {} MiB", LARGEST >> 20)]
    TooLarge,
    #[error("its name does not end with .stl, .obj or .dae")]
    Format,
    #[error("it is no text in UTF-8")]
    NotText,
    #[error("line {0}: {1}")]
    Line(usize, &'static str),
    #[error("it is no XML that can be read: {0}")]
    Xml(String),
    #[error("{0}")]
    Broken(&'static str),
    #[error("it has more than {MOST_TRIANGLES} triangles")]
    TooMany,
    #[error("a coordinate is beyond {FARTHEST:e} or not finite")]
    TooFar,
    #[error("it holds no triangle")]
    Empty,
    #[error(transparent)]
    Disk(#[from] io::Error),
}

/// The parts of a file, each of one colour.
///
/// # Errors
/// The file is not there, not inside its folder, no ordinary file, too large, or not what its ending says.
pub(crate) fn read(file: &MeshFile) -> Result<Vec<Part>, Unread> {
    let bytes = bytes_inside(&file.path, &file.folder, LARGEST)?;
    let ending = file.path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_ascii_lowercase();
    let mut sink = Sink::default();
    match ending.as_str() {
        "stl" => stl::read(&bytes, &mut sink)?,
        "obj" => {
            let beside = file.path.parent().unwrap_or(Path::new(""));
            obj::read(&bytes, &|name| material::read(&beside.join(name), &file.folder), &mut sink)?;
        }
        "dae" => collada::read(&bytes, &mut sink)?,
        _ => return Err(Unread::Format),
    }
    sink.finish()
}

/// The bytes of an ordinary file that is inside a folder, also when links are followed.
fn bytes_inside(path: &Path, folder: &Path, largest: u64) -> Result<Vec<u8>, Unread> {
    let not_there = |error: io::Error| match error.kind() {
        io::ErrorKind::NotFound | io::ErrorKind::NotADirectory => Unread::NotThere,
        _ => Unread::Disk(error),
    };
    let (own, folder) = (path.canonicalize().map_err(not_there)?, folder.canonicalize().map_err(not_there)?);
    if !own.starts_with(&folder) {
        return Err(Unread::Outside);
    }
    // A FIFO would be waited for when it is opened.
    if !fs::metadata(&own)?.is_file() {
        return Err(Unread::NotAFile);
    }
    let mut bytes = Vec::new();
    File::open(&own)?.take(largest + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > largest { Err(Unread::TooLarge) } else { Ok(bytes) }
}

/// Numbers of a text, one after the other.
fn floats(text: &str) -> impl Iterator<Item = Result<f32, Unread>> {
    text.split_ascii_whitespace().map(|word| word.parse().map_err(|_| Unread::Broken("a coordinate is no number")))
}

#[cfg(test)]
mod tests;
