//! Commands about a scenario: init, check, run, merge.

pub(crate) mod check;
pub(crate) mod failures;
pub(crate) mod init;
pub(crate) mod run;
pub(crate) mod starts;
pub(crate) mod swept;
