//! Commands about a scenario: init, check, run, merge, sensitivity, fit, design.

pub(crate) mod check;
pub(crate) mod design;
pub(crate) mod failures;
pub(crate) mod fit;
pub(crate) mod init;
pub(crate) mod run;
pub(crate) mod sensitivity;
pub(crate) mod starts;
pub(crate) mod swept;
