//! A scenario as an FMU: FMI 2.0 for Co-Simulation.
//!
//! An FMU holds the scenario with the files that it names (`resources/`), this library (`binaries/`), and what the scenario's variables are
//! called (`modelDescription.xml`). [`Package`] makes one; [`functions`] are those of the standard, each a few lines over a
//! [`Instance`], which is a [`springpot::Simulation`] with the modes of the standard around it.
//!
//! | variables | causality | |
//! |---|---|---|
//! | `time` | independent | s |
//! | `tau.JOINT` | input | added to the actuator force that the scenario says, N·m or N, where a force drives the joint; held over a step |
//! | `ELEMENT.INPUT` | input | an input of a law, SI; until it is set, what the scenario says |
//! | `element.ELEMENT.PARAMETER`, `motion.start.q.JOINT`, `motion.start.v.JOINT`, `solver.rtol` | parameter | numbers of the scenario, SI, by their paths |
//! | every other column of a run | output | that of an actuator force that is an input too is called `tau.JOINT.total` |
//!
//! Time starts at 0, where the memories begin. Instances are numbers to whoever holds them, so that one that was freed is refused and not followed; any thread may use
//! any of them, one call at a time for each.
//!
//! Functional Mock-up Interface for Model Exchange and Co-Simulation, version 2.0.4, Modelica Association 2022.

mod build;
mod checkpoint;
mod description;
mod extension;
#[allow(unsafe_code)]
pub mod functions;
mod guid;
mod instance;
mod library;
#[allow(unsafe_code)]
mod log;
mod mode;
mod package;
mod registry;
mod resources;
mod uri;
mod variables;
mod zip;

pub use checkpoint::Checkpoint;
pub use extension::without_python;
pub use instance::{Fault, Instance};
pub use library::{LIBRARY, PLATFORM, is_this_library};
pub use mode::Mode;
pub use package::{Package, PackageError};
pub use resources::Resources;
pub use variables::{Role, Variable};
