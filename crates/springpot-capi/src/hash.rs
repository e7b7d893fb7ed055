//! FNV-1a, for what must be told apart and not kept secret.

/// FNV-1a of 128 bits.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hash(u128);

impl Hash {
    const START: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
    const PRIME: u128 = 0x0000_0000_0100_0000_0000_0000_0000_013b;

    /// Of nothing.
    pub(crate) const fn new() -> Self {
        Self(Self::START)
    }

    /// With more bytes, told apart from what comes before and after.
    pub(crate) fn with(self, bytes: &[u8]) -> Self {
        let length = (bytes.len() as u64).to_le_bytes();
        let all = length.iter().chain(bytes);
        Self(all.fold(self.0, |hash, byte| (hash ^ u128::from(*byte)).wrapping_mul(Self::PRIME)))
    }

    /// All 128 bits.
    pub(crate) const fn value(self) -> u128 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_told_apart() {
        let of = |parts: &[&str]| parts.iter().fold(Hash::new(), |hash, part| hash.with(part.as_bytes())).value();
        assert_ne!(of(&["ab", "c"]), of(&["a", "bc"]));
        assert_ne!(of(&[]), of(&[""]));
        assert_eq!(of(&["ab", "c"]), of(&["ab", "c"]));
    }
}
