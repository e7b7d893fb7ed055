//! Multibody dynamics with fractional-order material elements.
//!
//! Springpot simulates robots whose bodies are joined by real materials: rubber, polymer, foam, magnetorheological fluid,
//! piezo ceramics. Such a material's force remembers the whole past motion, and a fractional derivative says so with two
//! numbers where a chain of springs and dashpots needs twenty.
//!
//! Everything inside the library is in SI units, radians and right-handed frames. A force is positive in tension, a stroke is
//! length less rest length.
//!
//! | module | holds | knows |
//! |---|---|---|
//! | [`spatial`] | vectors, rotations, spatial quantities, over one scalar | nothing |
//! | [`model`] | the robot: bodies, joints, anchors, from code or a URDF file; constant once built | `spatial` |
//! | [`dynamics`] | kinematics, RNEA, CRBA, ABA and their derivatives, Coriolis terms, pairs of anchors | `model` |
//! | [`fractional`] | derivatives and integrals of order −2 … 2: samples, streams, functions; kernel, memory, named schemes | nothing |
//! | [`law`] | stroke history → force; the catalog of laws | `fractional` |
//! | [`signal`] | functions of time with exact derivatives | nothing |
//! | [`element`] | a law between two anchors | `model`, `law`, `signal` |
//! | [`motion`] | q, v, a as functions of time: prescribed, gripper paths | `dynamics`, `signal` |
//! | [`simulate`] | the time loop: rows, step control, energy | all above |
//! | [`scenario`], [`sweep`], [`table`] | files in, all cases on all cores, results out | all above |
//!
//! A whole run in memory:
//!
//! ```
//! use springpot::law::Catalog;
//! use springpot::scenario::Scenario;
//! use springpot::simulate::{Stop, along};
//!
//! let text = r#"
//! robot.body = [{ name = "arm", joint = { name = "q1", kind = "revolute", axis = [0, 1, 0] }, mass = 1, com = [0.2, 0, 0] }]
//! motion = { kind = "prescribed", joints = { q1 = "0.5*sin(2*pi*t)" } }
//! time = { end = "1 s", output_step = "10 ms" }
//! [[element]]
//! name = "strut"
//! from = { body = "world", point = [0, 0, -0.3] }
//! to = { body = "arm", point = [0.3, 0, 0] }
//! rest_length = "42 cm"
//! law = "springpot"
//! parameters = { c = "50 N*s^alpha/m", alpha = 0.4 }
//! "#;
//! let cases = Scenario::parse(text, "arm.toml", "")?.cases(&Catalog::standard())?;
//! let plan = cases.plan(0)?;
//! let system = plan.system();
//! let force = system.columns().iter().position(|column| column.name == "strut.force").expect("a column of every element");
//! let mut largest = 0.0_f64;
//! let mut rows = |row: &[f64]| -> std::io::Result<()> {
//!     largest = largest.max(row[force].abs());
//!     Ok(())
//! };
//! let (report, outcome) = along(&system, &plan.settings(), &mut rows, &Stop::new(false));
//! outcome?;
//! assert_eq!(report.rows, 101);
//! assert!((10.0..12.0).contains(&largest), "{largest} N");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod dynamics;
pub mod element;
pub mod fractional;
pub mod law;
mod linalg;
pub mod model;
pub mod motion;
pub mod names;
#[cfg(feature = "scenario")]
pub mod scenario;
pub mod signal;
pub mod simulate;
pub mod spatial;
#[cfg(feature = "scenario")]
pub mod sweep;
pub mod table;
