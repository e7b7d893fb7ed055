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
//! | [`collocation`] | nodes of a step, their matrices and quadratures | nothing |
//! | [`fractional`] | derivatives and integrals of order −2 … 2: samples, streams, functions; kernel, memory, named schemes | `collocation` |
//! | [`identification`] | least squares of any residuals: bounds, starts, what a minimum says | nothing |
//! | [`law`] | stroke history → force; the catalog of laws | `fractional` |
//! | [`signal`] | functions of time with exact derivatives | nothing |
//! | [`elements`] | an element: measure (distance of points, coordinate of a joint), law, inputs; all of them without a robot | `dynamics`, `law`, `signal` |
//! | [`motion`] | kinematics given in advance: signals, gripper paths | `dynamics`, `signal` |
//! | [`actuation`] | forward dynamics: start, torques, prescribed and locked joints | `model`, `motion` |
//! | [`observe`] | what can be observed: quantities with names, units and values; the table in memory | `elements`, `table` |
//! | [`system`] | what is simulated, and how: settings, times of rows, events, errors | all above |
//! | [`equations`] | the equations of motion at one time; states without a run | `system` |
//! | [`methods`] | how steps are taken: prescribed motions, Radau IIA(5), steps of one size | `equations` |
//! | [`driver`] | runs and simulations: steps, rows, energy | `methods` |
//! | [`linear`] | small motions about rest: equilibria, eigenvalues, answers to sines | `driver` |
//! | [`table`] | the columns of rows | nothing |
//!
//! It knows numbers only: no files but URDF, no threads, no terminal. Scenario files are read by the crate `springpot-scenario`, sweeps,
//! results and figures are made by `springpot-run`.
//!
//! A whole run in memory:
//!
//! ```
//! use springpot::elements::{Element, Line};
//! use springpot::law::{Catalog, Derivative};
//! use springpot::model::{Anchor, BodySpec, JointSpec, ModelBuilder, Parent};
//! use springpot::motion::{JointPath, Trajectory};
//! use springpot::signal::{Expression, Signal};
//! use springpot::system::{RowTimes, Settings, Stop, System};
//! use springpot::driver::run;
//!
//! let mut builder = ModelBuilder::new([0.0, 0.0, -9.81]);
//! let arm = builder.push(BodySpec {
//!     name: "arm".into(),
//!     parent: Parent::World,
//!     joint: JointSpec::revolute("q1", [0.0, 1.0, 0.0], [0.0; 3]),
//!     mass: 1.0,
//!     com: [0.2, 0.0, 0.0],
//!     inertia: [[0.0; 3]; 3],
//! })?;
//! let model = builder.finish()?;
//!
//! let line = Line {
//!     from: model.resolve(&Anchor { body: Parent::World, point: [0.0, 0.0, -0.3] })?,
//!     to: model.resolve(&Anchor { body: Parent::Body(arm), point: [0.3, 0.0, 0.0] })?,
//! };
//! let laws = Catalog::standard();
//! let law = laws.get("springpot").expect("a law that comes with Springpot");
//! // Rest length 0.42 m, c = 50 N·s^0.4/m.
//! let strut = Element::new("strut", line, 0.42, law, &[50.0, 0.4], Derivative::Caputo)?;
//! let swing = Signal::expression(Expression::parse("0.5*sin(2*pi*t)")?);
//! let motion = Trajectory::Prescribed(vec![JointPath::Coordinate(swing)]);
//! let system = System::new(model, vec![strut], motion);
//! let settings = Settings::new(1.0, RowTimes::Step { step: 0.01, end: 1.0 });
//!
//! let mut table = system.table();
//! let (report, outcome) = run(&system, &settings, &mut table, &Stop::new(false));
//! outcome?;
//! assert_eq!(report.rows, 101);
//! let force = table.column("strut.force").expect("a column of every element");
//! let largest = force.iter().fold(0.0, |largest: f64, force| largest.max(force.abs()));
//! assert!((10.0..12.0).contains(&largest), "{largest} N");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod account;
pub mod actuation;
pub mod collocation;
pub mod control;
pub mod driver;
pub mod dual;
pub mod dynamics;
pub mod elements;
pub mod equations;
pub mod fractional;
pub mod identification;
pub mod law;
mod linalg;
pub mod linear;
pub mod methods;
pub mod model;
pub mod motion;
pub mod names;
pub mod observe;
pub mod optimisation;
mod quadrature;
mod random;
pub mod signal;
pub mod spatial;
pub mod system;
pub mod table;

pub use driver::Simulation;
pub use system::sensitivity;
