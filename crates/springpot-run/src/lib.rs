//! Whole runs of scenarios, as every face of Springpot shares them: the command, and programs that are no command.
//!
//! [`Prepared::begin`] reads a scenario, [`Prepared::resume`] a checkpoint, or [`Prepared::merge`] the parts of a run, and opens the folder of the results;
//! [`Prepared::sweep`] runs all cases on all cores; [`Prepared::finish`] draws the figures, writes run.json and puts everything in place.
//! Nothing here prints: warnings are handed over as they come, errors are returned.
//!
//! | module | holds |
//! |---|---|
//! | [`sweep`] | all cases on all cores: columns, rows, curves that are kept, checkpoints, run.json |
//! | [`table`] | results as files: numbers as text, formats, statistics, the folder that holds them |
//! | [`figures`] | figures from the curves that a run kept, or from any others |
//! | [`metrics`] | numbers that say how good a run is, at its end and from its results |
//! | [`modulus`] | an element under a steady sine |
//! | [`parts`] | a law as its parts: drawn, and as formulas |
//! | [`linear`] | small motions by name: eigenvalues, linear models and their files |
//! | [`numbers`] | numbers and counts as a reader wants them |
//! | [`design`] | parameters moved until a metric is as small as constraints let it be |
//! | [`trial`] | scenarios whose parameters take other values |
//! | [`labels`] | names of columns as a reader of a figure wants them |
//!
//! ```no_run
//! use springpot::law::Catalog;
//! use springpot::system::Stop;
//! use springpot_run::sweep::{Progress, Status};
//! use springpot_run::table::disk::Disk;
//! use springpot_run::{Asked, NewRun, Prepared, Surroundings, Warning};
//!
//! let (catalog, disk, stop, progress) = (Catalog::standard(), Disk::default(), Stop::new(false), Progress::default());
//! let surroundings = Surroundings { catalog: &catalog, disk: &disk, stop: &stop, holder: "an example" };
//! let mut warn = |warning: Warning| eprintln!("{warning}");
//! let mut run = Prepared::begin(NewRun::of(Asked::read("scenarios/piezo_order.toml".as_ref())?), surroundings, &mut warn)?;
//! let outcome = run.sweep(4, &stop, &progress)?;
//! let finished = run.finish(outcome, &progress, &mut warn)?;
//! assert_eq!(finished.outcome.status, Status::Done);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod asked;
mod checks;
pub mod design;
mod export;
pub mod figures;
mod finish;
pub mod fit;
mod follow;
pub mod labels;
pub mod linear;
mod meshes;
pub mod metrics;
pub mod modulus;
pub mod numbers;
mod panels;
pub mod parts;
mod planned;
mod prepare;
mod record;
mod report;
mod results;
mod scene;
mod survey;
pub mod sweep;
pub mod table;
pub mod trial;
mod trouble;
mod view;
mod warning;

/// A name for this build: what one build computes, another may round differently.
pub const BUILD: &str = env!("SPRINGPOT_BUILD");

pub use asked::Asked;
pub use export::{ExportError, ExportFormat, export};
pub use finish::Finished;
pub use follow::{NewRows, News, Tail, Underway};
pub use planned::Planned;
pub use prepare::{BeginError, NewRun, Prepared, Surroundings};
pub use report::{comparison, quoted, report};
pub use results::{Results, ResultsError, Told, of_other_version};
pub use survey::{Depth, ElementSurvey, Found, Survey};
pub use table::folder::{COMPARISON_LATEX, COMPARISON_PAGE, REPORT_LATEX, REPORT_PAGE, VIEW_PAGE, latex_figures};
pub use table::sealed::{SealError, open, seal};
pub use trouble::Trouble;
pub use view::view;
pub use warning::{Warn, Warning, robot_warnings};
