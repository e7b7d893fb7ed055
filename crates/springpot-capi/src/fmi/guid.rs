//! The identity of an FMU.

use crate::hash::Hash;

/// The layout of resources that this version reads and writes.
const LAYOUT: &str = "springpot-fmu-1";

/// `{8-4-4-4-12}` hexadecimal digits that follow from the version of the library and from all files, in whatever order.
pub(super) fn of<'a>(files: impl Iterator<Item = (&'a str, &'a [u8])>) -> String {
    let mut files: Vec<_> = files.collect();
    files.sort_unstable();
    let start = Hash::new().with(LAYOUT.as_bytes()).with(env!("CARGO_PKG_VERSION").as_bytes());
    let hash = files.iter().fold(start, |hash, (name, bytes)| hash.with(name.as_bytes()).with(bytes));
    let digits = format!("{:032x}", hash.value());
    let part = |from: usize, to: usize| &digits[from..to];
    format!("{{{}-{}-{}-{}-{}}}", part(0, 8), part(8, 12), part(12, 16), part(16, 20), part(20, 32))
}

#[cfg(test)]
mod tests {
    #[test]
    fn it_follows_from_names_and_bytes_and_not_from_their_order() {
        let of = |files: &[(&str, &[u8])]| super::of(files.iter().copied());
        let one = of(&[("a", b"1"), ("b", b"2")]);
        assert_eq!(one, of(&[("b", b"2"), ("a", b"1")]));
        assert_ne!(one, of(&[("a", b"2"), ("b", b"1")]));
        assert_eq!(one.len(), 38);
        assert_eq!(one.matches('-').count(), 4);
    }
}
