//! Which instructions are used, chosen when the program runs.
//!
//! A plain build runs on every processor. Where this one has wider registers, a task is run through a door: a function that is compiled for
//! them, with all that is inlined into it.

use std::fmt;
use std::sync::OnceLock;

use super::columns::ColumnWork;

/// The variable that asks for another level than the best.
const VARIABLE: &str = "SPRINGPOT_SIMD";

/// How wide registers are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum SimdLevel {
    /// What every processor of the target has: one state at a time.
    Baseline,
    /// AVX2 and FMA: four states side by side.
    Avx2,
    /// AVX-512 (F, DQ, VL) and FMA: eight states side by side.
    Avx512,
}

/// Why there is no such level.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SimdError {
    /// The variable has another word.
    #[error("{VARIABLE} is \"{word}\"; it must be baseline, avx2 or avx512, or not set at all")]
    Unknown {
        /// That word.
        word: String,
    },
    /// The processor has no such instructions.
    #[error(
        "this processor has no {wanted}; its best level is {best} ({VARIABLE}={best}, or the variable not set at all)"
    )]
    Missing {
        /// What was asked for.
        wanted: SimdLevel,
        /// What there is.
        best: SimdLevel,
    },
}

impl fmt::Display for SimdLevel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl SimdLevel {
    /// All of them, the narrowest first.
    pub const ALL: [Self; 3] = [Self::Baseline, Self::Avx2, Self::Avx512];

    /// Its word in `SPRINGPOT_SIMD`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Baseline => "baseline",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    /// The widest that this processor has.
    pub fn best() -> Self {
        static BEST: OnceLock<SimdLevel> = OnceLock::new();
        *BEST.get_or_init(|| Self::ALL.into_iter().rev().find(|level| level.is_there()).unwrap_or(Self::Baseline))
    }

    /// What `SPRINGPOT_SIMD` says, else the best.
    ///
    /// # Errors
    /// [`SimdError`]: another word, or a level that this processor has not.
    pub fn chosen() -> Result<Self, SimdError> {
        static CHOSEN: OnceLock<Result<SimdLevel, SimdError>> = OnceLock::new();
        CHOSEN
            .get_or_init(|| Self::read(std::env::var_os(VARIABLE).map(|word| word.to_string_lossy().into_owned())))
            .clone()
    }

    fn read(word: Option<String>) -> Result<Self, SimdError> {
        let Some(word) = word.filter(|word| !word.is_empty()) else { return Ok(Self::best()) };
        match Self::ALL.into_iter().find(|level| level.name() == word) {
            Some(level) => level.available(),
            None => Err(SimdError::Unknown { word }),
        }
    }

    /// The level itself where this processor has it.
    ///
    /// # Errors
    /// [`SimdError::Missing`].
    pub fn available(self) -> Result<Self, SimdError> {
        let best = Self::best();
        if self <= best { Ok(self) } else { Err(SimdError::Missing { wanted: self, best }) }
    }

    #[cfg(target_arch = "x86_64")]
    fn is_there(self) -> bool {
        let fma = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
        let wide = is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl");
        match self {
            Self::Baseline => true,
            Self::Avx2 => fma,
            Self::Avx512 => fma && wide,
        }
    }

    #[cfg(not(target_arch = "x86_64"))]
    fn is_there(self) -> bool {
        self == Self::Baseline
    }
}

/// What is done behind a door; `run` and all that it calls must be `#[inline(always)]`, lest it be compiled outside.
pub(crate) trait Task {
    fn run(self);
}

/// The door to AVX2.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
pub(super) fn avx2(task: impl Task) {
    task.run();
}

/// The door to AVX-512.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
pub(super) fn avx512(task: impl Task) {
    task.run();
}

/// Work on rows of numbers, so many columns at a time as the registers are wide: the same bits at every level.
pub(super) fn in_columns(work: impl ColumnWork<f64>) {
    // What cannot be read is refused by those who start; the bits are the same.
    match SimdLevel::chosen().unwrap_or(SimdLevel::Baseline) {
        #[cfg(target_arch = "x86_64")]
        SimdLevel::Avx512 => super::lanes::in_columns::<super::lanes::Lanes8>(work),
        #[cfg(target_arch = "x86_64")]
        SimdLevel::Avx2 => super::lanes::in_columns::<super::lanes::Lanes4>(work),
        _ => work.run::<f64>(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_read_by_name() {
        let read = |word: &str| SimdLevel::read(Some(word.into()));
        assert_eq!(SimdLevel::read(None), Ok(SimdLevel::best()));
        assert_eq!(read(""), Ok(SimdLevel::best()));
        assert_eq!(read("baseline"), Ok(SimdLevel::Baseline));
        for level in SimdLevel::ALL {
            let found = read(level.name());
            let missing = SimdError::Missing { wanted: level, best: SimdLevel::best() };
            assert_eq!(found, if level <= SimdLevel::best() { Ok(level) } else { Err(missing) });
        }
        let refused = read("AVX").unwrap_err().to_string();
        assert_eq!(refused, "SPRINGPOT_SIMD is \"AVX\"; it must be baseline, avx2 or avx512, or not set at all");
        let missing = SimdError::Missing { wanted: SimdLevel::Avx512, best: SimdLevel::Avx2 }.to_string();
        assert!(missing.starts_with("this processor has no avx512; its best level is avx2"), "{missing}");
    }
}
