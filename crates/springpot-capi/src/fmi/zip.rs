//! Zip archives of a few files in memory.
//!
//! APPNOTE.TXT 6.3.10 of PKWARE, section 4.3: deflated entries, their names in UTF-8, the same bytes for the same files.

use miniz_oxide::deflate::compress_to_vec;

/// Version that is needed to read a deflated entry.
const VERSION: u16 = 20;
/// The name is UTF-8.
const FLAGS: u16 = 1 << 11;
const DEFLATED: u16 = 8;
/// 1980-01-01, the first day that the format knows.
const DATE: u16 = 0x21;
/// How much is done to make entries small, of 10.
const EFFORT: u8 = 6;
/// Where numbers of this format end.
const MOST: usize = u32::MAX as usize;

/// An archive of files by name.
///
/// # Errors
/// In words, where it is larger than the format holds.
pub(super) fn archive(files: &[(String, Vec<u8>)]) -> Result<Vec<u8>, String> {
    let (mut archive, mut directory) = (Vec::new(), Vec::new());
    for (name, bytes) in files {
        let packed = compress_to_vec(bytes, EFFORT);
        let at = archive.len();
        if bytes.len().max(at + packed.len()) > MOST || name.len() > usize::from(u16::MAX) {
            return Err(format!("{name} is larger than a zip archive holds"));
        }
        let mut entry = Vec::new();
        for short in [VERSION, FLAGS, DEFLATED, 0, DATE] {
            entry.extend(short.to_le_bytes());
        }
        for long in [crc32fast::hash(bytes), packed.len() as u32, bytes.len() as u32] {
            entry.extend(long.to_le_bytes());
        }
        entry.extend((name.len() as u16).to_le_bytes());
        // No extra field.
        entry.extend(0_u16.to_le_bytes());

        archive.extend(0x0403_4b50_u32.to_le_bytes());
        archive.extend(&entry);
        archive.extend(name.as_bytes());
        archive.extend(&packed);

        directory.extend(0x0201_4b50_u32.to_le_bytes());
        directory.extend(VERSION.to_le_bytes());
        directory.extend(&entry);
        // No comment, the first disk, no attributes.
        directory.extend([0; 10]);
        directory.extend((at as u32).to_le_bytes());
        directory.extend(name.as_bytes());
    }
    let (at, count) = (archive.len(), files.len() as u16);
    if at + directory.len() > MOST || files.len() > usize::from(u16::MAX) {
        return Err("the files are more than a zip archive holds".to_owned());
    }
    archive.extend(&directory);
    archive.extend(0x0605_4b50_u32.to_le_bytes());
    archive.extend([0; 4]);
    archive.extend(count.to_le_bytes());
    archive.extend(count.to_le_bytes());
    archive.extend((directory.len() as u32).to_le_bytes());
    archive.extend((at as u32).to_le_bytes());
    archive.extend([0; 2]);
    Ok(archive)
}
