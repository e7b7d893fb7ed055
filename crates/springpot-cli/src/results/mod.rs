//! Commands about results: plot, metrics, view, report, export.

pub(crate) mod export;
mod folder;
pub(crate) mod metrics;
pub(crate) mod plot;
pub(crate) mod report;
pub(crate) mod view;

pub(crate) use folder::{open, refused, say_version, write_page};
