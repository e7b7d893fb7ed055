//! Commands for other programs: fmu, completions, man.

pub(crate) mod fmu;
pub(crate) mod manual;
