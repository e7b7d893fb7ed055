//! What the command line takes.

use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;

/// Robots whose bodies are joined by real materials: exact forces, motion, energy and figures from one scenario file.
#[derive(Debug, Parser)]
#[command(
    name = "springpot",
    version,
    arg_required_else_help = true,
    after_help = "\
Example:
  springpot run scenarios/thermoviscoelastic_order.toml

Exit codes: 0 done, 1 a run failed, 2 the input was refused, 130 interrupted."
)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Run a scenario: rows, statistics and figures into a folder.
    #[command(after_help = "\
Examples:
  springpot run scenarios/thermoviscoelastic_order.toml
  springpot run arm.toml --set element.strut.alpha=0.3 --set 'element.strut.T=40 degC' --out warm

Writes results.csv, summary.csv, figures/ and run.json. A rerun replaces the last run's files and nothing else. \
Ctrl-C ends a run early; the rows so far are kept, all of them complete.")]
    Run(RunOptions),
    /// Read and check a scenario without running it.
    #[command(after_help = "\
Example:
  springpot check scenarios/magnetorheological_order.toml

Prints, per element, the length l(0), the stroke x(0) and dl/dq at t = 0, and warns of a large initial stroke and of a \
singular Riemann-Liouville start, in any case of a sweep. Exit code 1 where a run is known to fail, as on a gripper path \
out of reach.")]
    Check(CheckOptions),
}

#[derive(Debug, Args)]
pub(crate) struct RunOptions {
    #[command(flatten)]
    pub(crate) scenario: ScenarioOptions,
    /// Folder of the results [default: results/<file stem>]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Cases at a time [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) jobs: Option<u16>,
    /// Write no figures
    #[arg(long)]
    pub(crate) no_figures: bool,
    /// Print nothing but warnings and errors
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

#[derive(Debug, Args)]
pub(crate) struct CheckOptions {
    #[command(flatten)]
    pub(crate) scenario: ScenarioOptions,
    /// Print nothing but warnings and errors
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ScenarioOptions {
    /// Scenario file (TOML)
    #[arg(value_name = "SCENARIO")]
    pub(crate) file: PathBuf,
    /// Override a value of the file, such as element.strut.alpha=0.5; may be given several times
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub(crate) overrides: Vec<String>,
}
