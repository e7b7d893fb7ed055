//! Where resources are.

use std::path::PathBuf;

/// The folder that a `file:` URI leads to (RFC 8089).
///
/// # Errors
/// In words, where it is none.
pub(super) fn folder(uri: &str) -> Result<PathBuf, String> {
    let refuse = || format!("{uri:?} is no file: URI of a folder");
    let rest = uri.strip_prefix("file:").ok_or_else(refuse)?;
    let path = match rest.strip_prefix("//") {
        Some(rest) if rest.starts_with('/') => rest,
        Some(rest) => {
            let path = rest.strip_prefix("localhost").ok_or_else(refuse)?;
            if path.starts_with('/') { path } else { return Err(refuse()) }
        }
        None => rest,
    };
    let decoded = decoded(path).ok_or_else(refuse)?;
    // Of Windows: /C:/folder.
    let bytes = decoded.as_bytes();
    let has_drive = cfg!(windows) && bytes.len() > 2 && bytes[0] == b'/' && bytes[2] == b':';
    Ok(PathBuf::from(if has_drive { &decoded[1..] } else { &decoded[..] }))
}

/// A text with %XX as bytes.
fn decoded(text: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let Some((&byte, after)) = rest.split_first() {
        rest = after;
        if byte != b'%' {
            bytes.push(byte);
            continue;
        }
        let digits = rest.get(..2).filter(|digits| digits.iter().all(u8::is_ascii_hexdigit))?;
        bytes.push(u8::from_str_radix(std::str::from_utf8(digits).ok()?, 16).ok()?);
        rest = &rest[2..];
    }
    String::from_utf8(bytes).ok().filter(|text| !text.contains('\0'))
}

#[cfg(test)]
mod tests {
    use super::folder;
    use std::path::Path;

    #[test]
    fn uris_of_files_lead_to_folders_and_others_nowhere() {
        for uri in ["file:///tmp/a%20b/%C3%A4", "file:/tmp/a b/ä", "file://localhost/tmp/a%20b/ä"] {
            assert_eq!(folder(uri).as_deref(), Ok(Path::new("/tmp/a b/ä")), "{uri}");
        }
        for uri in
            ["", "/tmp", "http://a/b", "file://host/tmp", "file:///tmp/%2", "file:///%zz", "file:///%00", "file:///%+1"]
        {
            assert!(folder(uri).is_err(), "{uri}");
        }
    }
}
