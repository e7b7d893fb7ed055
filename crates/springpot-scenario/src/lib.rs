//! Scenario files: TOML text → [`Scenario`] (as written) → [`Cases`] (the grid of its sweeps) → [`Plan`] (one run,
//! validated, in SI units, with every default filled in).
//!
//! Everything that is wrong in a scenario is a [`Refusal`] with file, line, column, value and what would be right.
//!
//! ```
//! use springpot::law::Catalog;
//! use springpot_scenario::Scenario;
//!
//! let text = r#"
//! [[robot.body]]
//! name = "pendulum"
//! joint = { name = "q1", kind = "revolute", axis = [0, 1, 0] }
//! mass = "500 g"
//! com = [0, 0, -0.3]
//! [motion]
//! kind = "prescribed"
//! joints = { q1 = "0.1*sin(8*t)" }
//! [time]
//! end = "10 s"
//! output_step = "10 ms"
//! "#;
//! let mut scenario = Scenario::parse(text, "pendulum.toml", "")?;
//! scenario.set("solver.rtol=1e-7")?;
//! let cases = scenario.cases(&Catalog::standard())?;
//! assert_eq!(cases.len(), 1);
//! let plan = cases.plan(0)?;
//! assert_eq!(plan.bodies[0].mass, 0.5);
//! assert_eq!(plan.settings.rows.count(), 1001);
//!
//! scenario.set("time.end=10 m")?;
//! let refusals = scenario.cases(&Catalog::standard()).map(|_| ()).unwrap_err();
//! assert!(refusals.to_string().starts_with("--set:1:13: `end` of [time]"));
//! # Ok::<(), springpot_scenario::Refusals>(())
//! ```

mod cases;
mod changes;
pub mod csv;
mod elements;
mod figures;
mod fit;
mod keys;
mod motion;
mod plan;
mod reader;
mod robot;
mod scenario;
mod sensitivity;
mod signals;
mod text;
mod time;
pub mod units;

pub use cases::{Cases, SweptValue};
pub use changes::path::equals_sign;
pub use elements::past::PastPlan;
pub use elements::plan::{ElementPlan, FramePlan, ShapePlan};
pub use figures::{
    AxisLook, ColumnGlob, FIGURE_SIDES, FigureFormat, FigureKind, FigureLabel, FigureNumbers, FigurePlan, FigurePoints,
    FigureUnit, LOOK_OPTIONS, Look, LookOption, RangeEnd, Said, Selection, Spelt, Statistic, Summarised, SweptAxis,
    Takes,
};
pub use fit::{
    DataColumn, DataKind, DataPlan, FitParameter, FitPlan, FitSettings, Fitting, Intervals, MaterialAt, Moved,
    PastOfStroke, Role,
};
pub use keys::{MAX_CASES, MetricKind};
pub use motion::MotionPlan;
pub use plan::cure::Cure;
pub use plan::design::{Constraint, DesignPlan};
pub use plan::events::EventPlan;
pub use plan::metrics::{Band, Metric, MetricPlan};
pub use plan::sensitivity::{ParameterPlan, SensitivityPlan};
pub use plan::{OutputPlan, Plan};
pub use robot::described::{BodyPlaces, DescriptionPlan, EndStops, Gripper, RobotPlan};
pub use scenario::{LoneElement, Portable, Scenario, json_schema};
pub use signals::plan::SignalPlan;
pub use text::glob::matches;
pub use text::names::{list, suggest};
pub use text::quoted::toml_key;
pub use text::refusal::{Place, Refusal, RefusalKind, Refusals, Remark, Source};
