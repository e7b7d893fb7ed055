//! The laws that the functions of C and of FMUs know.

use springpot::law::Catalog;
use std::sync::OnceLock;

static CATALOG: OnceLock<Catalog> = OnceLock::new();

/// Hands the laws of `catalog` to [`c`](crate::c) and [`fmi::functions`](crate::fmi::functions) of this process, which know those that come with
/// Springpot where nobody does.
///
/// A shared library with laws of its own is a crate of the type `cdylib` that depends on this one, and calls this before it is asked for a bank or an
/// instance, at best when it is loaded. `examples/own_laws.rs` is one.
///
/// # Errors
/// The catalog itself, where laws were handed over or asked for before: banks and instances of one process know the same laws.
pub fn set_catalog(catalog: Catalog) -> Result<(), Catalog> {
    CATALOG.set(catalog)
}

/// The laws of this process.
pub(crate) fn catalog() -> &'static Catalog {
    CATALOG.get_or_init(Catalog::standard)
}
