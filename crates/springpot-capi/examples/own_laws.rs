//! A shared library with a law of its own, for C and for FMUs. It has all functions of `springpot.h` and of FMI, and knows its law as soon as it is loaded:
//!
//! ```sh
//! cargo build --release -p springpot-capi --example own_laws     # target/release/examples/libown_laws.so
//! ```
//!
//! C links it in place of libspringpot_capi, and `fmu --library` of a command with the same laws puts it into an FMU.
#![allow(unsafe_code)]

use springpot::law::{Catalog, Entry, Network, Param, Range};
use std::sync::Arc;

/// F = (c_left + c_right)·x'.
fn twin_dashpot() -> Entry {
    Entry {
        name: "twin-dashpot".into(),
        equation: "F = (c_left + c_right)·x'".into(),
        params: ["c_left", "c_right"].map(|c| Param::new(c, "N*s/m", "viscosity", Range::NOT_NEGATIVE)).into(),
        inputs: Vec::new(),
        source: "an example".into(),
        build: Arc::new(|values, _| Ok(Network::parallel(values.iter().map(|c| Network::dashpot(*c))))),
    }
}

/// Called by whoever loads the library, before anything else.
extern "C" fn at_load() {
    // Nobody can have asked for a bank before.
    let _ = springpot_capi::set_catalog(Catalog::standard().with(twin_dashpot()));
}

#[used]
#[cfg_attr(target_os = "linux", unsafe(link_section = ".init_array"))]
#[cfg_attr(target_os = "macos", unsafe(link_section = "__DATA,__mod_init_func"))]
#[cfg_attr(target_os = "windows", unsafe(link_section = ".CRT$XCU"))]
static AT_LOAD: extern "C" fn() = at_load;
