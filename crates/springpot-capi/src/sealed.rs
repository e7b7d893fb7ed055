//! Values as bytes that show whether they are whole.

use crate::hash::Hash;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Bytes of the sum behind the mark.
const SUM: usize = 16;

fn sum(body: &[u8]) -> [u8; SUM] {
    Hash::new().with(body).value().to_le_bytes()
}

/// A value as bytes that begin with `mark`.
pub(crate) fn seal(mark: &[u8], value: &impl Serialize) -> Result<Vec<u8>, postcard::Error> {
    let body = postcard::to_stdvec(value)?;
    Ok([mark, &sum(&body)[..], &body].concat())
}

/// The value of such bytes.
///
/// # Errors
/// Why they are none.
pub(crate) fn open<T: DeserializeOwned>(mark: &[u8], bytes: &[u8]) -> Result<T, &'static str> {
    let rest = bytes.strip_prefix(mark).ok_or("they begin otherwise")?;
    let (told, body) = rest.split_at_checked(SUM).ok_or("they are torn")?;
    if told != sum(body) {
        return Err("they are torn");
    }
    postcard::from_bytes(body).map_err(|_| "they are of another version")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn torn_bytes_are_seen() {
        let whole = seal(b"mark", &(1.5, "text")).unwrap();
        assert_eq!(open::<(f64, String)>(b"mark", &whole), Ok((1.5, "text".to_owned())));
        for at in 0..whole.len() {
            let mut torn = whole.clone();
            torn[at] ^= 1;
            assert!(open::<(f64, String)>(b"mark", &torn).is_err());
            assert!(open::<(f64, String)>(b"mark", &whole[..at]).is_err());
        }
    }
}
