//! A library of an FMU out of an extension of Python that has the same functions.
//!
//! An extension leaves the names of Python to whoever loads it, and no other program has them. The functions of an FMU ask for none: where the names
//! need not be there, any program can load it. In the ELF format that is one bit of a name (weak, System V ABI, chapter 4).

/// Class, byte order and version of the files that are known: 64 bits, little-endian.
const IDENTITY: &[u8] = b"\x7fELF\x02\x01\x01";
/// The type of the section with the names that a loader sees, and the size of one.
const DYNAMIC_NAMES: u32 = 11;
const NAME_SIZE: usize = 24;
/// The upper half of what a name is: global, weak.
const GLOBAL: u8 = 1;
const WEAK: u8 = 2;

/// The same library, which loads where nobody has the names of Python; `None` where it is none of the known format.
pub fn without_python(mut library: Vec<u8>) -> Option<Vec<u8>> {
    if !library.starts_with(IDENTITY) {
        return None;
    }
    let sections = place(&library, 0x28, 8)?;
    let (size, count) = (place(&library, 0x3a, 2)?, place(&library, 0x3c, 2)?);
    let end = library.len();
    let section = |k: usize| sections.checked_add(size.checked_mul(k)?).filter(|at| *at <= end);
    let names = (0..count).find_map(|k| {
        let head = section(k)?;
        (place(&library, head + 4, 4)? == DYNAMIC_NAMES as usize).then_some(head)
    })?;
    let (from, length, texts) = (
        place(&library, names + 0x18, 8)?,
        place(&library, names + 0x20, 8)?,
        section(place(&library, names + 0x28, 4)?)?,
    );
    let texts = place(&library, texts + 0x18, 8)?;
    let end = from.checked_add(length).filter(|end| *end <= library.len())?;
    for at in (from..end).step_by(NAME_SIZE) {
        let is_elsewhere = place(&library, at + 6, 2)? == 0;
        let text = texts.checked_add(place(&library, at, 4)?)?;
        let is_of_python = library.get(text..)?.starts_with(b"Py") || library.get(text..)?.starts_with(b"_Py");
        let kind = library.get_mut(at + 4)?;
        if is_elsewhere && is_of_python && *kind >> 4 == GLOBAL {
            *kind = WEAK << 4 | (*kind & 0xf);
        }
    }
    Some(library)
}

/// A number of so many bytes at a place.
fn place(bytes: &[u8], at: usize, size: usize) -> Option<usize> {
    let mut whole = [0; 8];
    whole[..size].copy_from_slice(bytes.get(at..at.checked_add(size)?)?);
    usize::try_from(u64::from_le_bytes(whole)).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file of three sections: nothing, texts of names, and names `(text, kind, section)`.
    fn library(names: &[(&str, u8, u16)]) -> (Vec<u8>, usize) {
        let mut bytes = IDENTITY.to_vec();
        bytes.resize(64, 0);
        let (mut texts, mut table) = (vec![0_u8], Vec::new());
        for (text, kind, section) in names {
            let mut name = vec![0; NAME_SIZE];
            name[..4].copy_from_slice(&(texts.len() as u32).to_le_bytes());
            name[4] = *kind;
            name[6..8].copy_from_slice(&section.to_le_bytes());
            table.extend(name);
            texts.extend(text.bytes().chain([0]));
        }
        let (texts_at, names_at) = (bytes.len(), bytes.len() + texts.len());
        bytes.extend(texts);
        bytes.extend(&table);
        let sections = bytes.len();
        for (kind, from, size, link) in [(0_u32, 0, 0, 0_u32), (3, texts_at, 0, 0), (11, names_at, table.len(), 1)] {
            let mut head = vec![0; 64];
            head[4..8].copy_from_slice(&kind.to_le_bytes());
            head[0x18..0x20].copy_from_slice(&(from as u64).to_le_bytes());
            head[0x20..0x28].copy_from_slice(&(size as u64).to_le_bytes());
            head[0x28..0x2c].copy_from_slice(&link.to_le_bytes());
            bytes.extend(head);
        }
        bytes[0x28..0x30].copy_from_slice(&(sections as u64).to_le_bytes());
        bytes[0x3a..0x3c].copy_from_slice(&64_u16.to_le_bytes());
        bytes[0x3c..0x3e].copy_from_slice(&3_u16.to_le_bytes());
        (bytes, names_at)
    }

    #[test]
    fn names_of_python_need_not_be_there() {
        let names = [
            ("PyErr_Occurred", 0x12, 0),
            ("_Py_NoneStruct", 0x11, 0),
            ("malloc", 0x12, 0),
            ("PyInit__springpot", 0x12, 7),
            ("Py_None", 0x22, 0),
        ];
        let (bytes, at) = library(&names);
        let loose = without_python(bytes.clone()).unwrap();
        let kinds: Vec<u8> = (0..names.len()).map(|k| loose[at + NAME_SIZE * k + 4]).collect();
        // What is elsewhere and of Python is weak, and nothing else is another one.
        assert_eq!(kinds, [0x22, 0x21, 0x12, 0x12, 0x22]);
        assert_eq!(bytes.iter().zip(&loose).filter(|(a, b)| a != b).count(), 2);
        assert_eq!(without_python(loose.clone()).unwrap(), loose);
    }

    #[test]
    fn what_is_no_library_brings_nothing_down() {
        let (bytes, _) = library(&[("PyErr_Occurred", 0x12, 0)]);
        assert!(without_python(b"MZ".to_vec()).is_none() && without_python(IDENTITY.to_vec()).is_none());
        // Nobody asks for the last fields of the last section.
        for length in 0..bytes.len() - 20 {
            assert!(without_python(bytes[..length].to_vec()).is_none(), "{length}");
        }
        for at in 0..bytes.len() {
            for value in [0, 0x7f, 0xff] {
                let mut torn = bytes.clone();
                torn[at] = value;
                let _ = without_python(torn);
            }
        }
    }
}
