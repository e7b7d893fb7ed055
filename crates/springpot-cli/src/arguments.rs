//! What the command line takes.

use clap::{ArgGroup, Args, Parser, Subcommand, ValueEnum};
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
  springpot run arm.toml --checkpoint-every '10 s'
  springpot run --resume results/arm

Writes results.csv, summary.csv, figures/ and run.json. A rerun replaces the last run's files and nothing else. \
Ctrl-C ends a run early; the rows so far are kept, all of them complete. With --checkpoint-every a run that was interrupted or \
killed goes on with --resume, and its results are those of an uninterrupted run.")]
    Run(RunOptions),
    /// Read and check a scenario without running it.
    #[command(after_help = "\
Example:
  springpot check scenarios/magnetorheological_order.toml

Prints, per element, the length l(0), the stroke x(0) and dl/dq at t = 0, and warns of a large initial stroke and of a \
singular Riemann-Liouville start, in any case of a sweep. Exit code 1 where a run is known to fail, as on a gripper path \
out of reach.")]
    Check(CheckOptions),
    /// Describe a robot: tree, masses, joints, limits, frames, and what was not used.
    #[command(after_help = "\
Examples:
  springpot info arm.urdf
  springpot info humanoid.urdf --floating-base --json > humanoid.json

In the tree a line hangs on the line above it, unless a branch says otherwise. Masses are those of moving links together with \
all that is fixed to them. docs/ROBOTS.md describes the JSON.")]
    Info(InfoOptions),
    /// Compute the dynamics of a robot in given states, or along a scenario's motion.
    #[command(after_help = "\
Examples:
  springpot dynamics arm.urdf --states states.json > dynamics.json
  springpot dynamics scenarios/thermoviscoelastic_order.toml --at 0.5

With --states: reads {\"joints\": [names, the order of the numbers; optional], \"states\": [{\"q\": [], \"v\": [], \"a\": [], \"tau\": []}]} \
and prints the rigid-body terms of every state as JSON, in SI units and in the same order; joint damping and friction stay out. \
With --at: prints the equations of motion at that time term by term, with the forces of the elements. docs/ROBOTS.md describes both.

Exit codes: 0 done, 1 some numbers are not finite or the motion does not come as far, 2 the input was refused.")]
    Dynamics(DynamicsOptions),
    /// Turn a springpot into a Prony series with a verified error, for codes that know no fractional order.
    #[command(after_help = "\
Examples:
  springpot prony --order 0.5 --coefficient '50 N*s^alpha/m' --from '1 ms' --to '10 s'
  springpot prony --order 0.3 --coefficient '2 MPa*s^alpha' --band --from '0.1 Hz' --to '1 kHz' --format abaqus

The series G_e + sum of g_k exp(-t/tau_k) stands for the relaxation G(t) = G_e + c t^-alpha/Gamma(1 - alpha) between two times, or, \
with --band, for the complex modulus G_e + c (i omega)^alpha between two frequencies. All g_k are positive: springs g_k, each in \
series with a damper g_k tau_k. The error is verified after building. Numbers without a unit are SI (frequencies Hz).

Abaqus and Ansys need a long-term modulus above 0. Without --equilibrium a spring takes the place of what relaxes after the \
window; the bound includes it, and a comment says so.")]
    Prony(PronyOptions),
}

#[derive(Debug, Args)]
pub(crate) struct RunOptions {
    /// Scenario file (TOML)
    #[arg(value_name = "SCENARIO", required_unless_present = "resume")]
    pub(crate) file: Option<PathBuf>,
    /// Override a value of the file, such as element.strut.alpha=0.5; may be given several times
    #[arg(long = "set", value_name = "PATH=VALUE", conflicts_with = "resume")]
    pub(crate) overrides: Vec<String>,
    /// Folder of the results [default: results/<file stem>]
    #[arg(long, value_name = "DIR", conflicts_with = "resume")]
    pub(crate) out: Option<PathBuf>,
    /// Keep the state of the run every so much simulated time, in s or with a unit
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub(crate) checkpoint_every: Option<String>,
    /// Go on with the run whose results are in this folder
    #[arg(long, value_name = "DIR", conflicts_with = "file")]
    pub(crate) resume: Option<PathBuf>,
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
pub(crate) struct RobotOptions {
    /// Robot: a URDF file (.urdf), or a scenario or its [robot] alone (.toml)
    #[arg(value_name = "ROBOT")]
    pub(crate) file: PathBuf,
    /// Let the root link of a URDF file float on a joint called floating_base
    #[arg(long)]
    pub(crate) floating_base: bool,
    /// Give joints that mimic another one coordinates of their own
    #[arg(long)]
    pub(crate) ignore_mimic: bool,
    /// Folder that is a package, or holds some, for package:// paths; may be given several times
    #[arg(long, value_name = "DIR")]
    pub(crate) package_path: Vec<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct InfoOptions {
    #[command(flatten)]
    pub(crate) robot: RobotOptions,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
#[command(group(ArgGroup::new("what").args(["states", "at"]).required(true)))]
pub(crate) struct DynamicsOptions {
    #[command(flatten)]
    pub(crate) robot: RobotOptions,
    /// States to compute the dynamics in (JSON); - reads the standard input
    #[arg(long, value_name = "FILE")]
    pub(crate) states: Option<PathBuf>,
    /// With --states: Christoffel symbols too, where every joint has one degree of freedom
    #[arg(long, conflicts_with = "at")]
    pub(crate) christoffel: bool,
    /// With --states: pose and Jacobian of this link too (or of the link that this joint moves)
    #[arg(long, value_name = "NAME", conflicts_with = "at")]
    pub(crate) frame: Option<String>,
    /// Time along the scenario's motion, in s or with a unit
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub(crate) at: Option<String>,
    /// With --at: the case of a scenario with sweeps, counted from 0 as in run.json [default: 0]
    #[arg(long, value_name = "N", conflicts_with = "states")]
    pub(crate) case: Option<usize>,
    /// With --at: print JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Override a value of a scenario, such as element.strut.alpha=0.5; may be given several times
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub(crate) overrides: Vec<String>,
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

#[derive(Debug, Args)]
pub(crate) struct PronyOptions {
    /// Order alpha of the springpot, above 0 and below 1
    #[arg(long, value_name = "ALPHA", allow_hyphen_values = true)]
    pub(crate) order: f64,
    /// Coefficient c, such as '50 N*s^alpha/m' or '2 MPa*s^alpha'
    #[arg(long, value_name = "C", allow_hyphen_values = true)]
    pub(crate) coefficient: String,
    /// Shortest time, in s or with a unit; with --band the lowest frequency
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub(crate) from: String,
    /// Longest time; with --band the highest frequency
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub(crate) to: String,
    /// --from and --to are frequencies, in Hz or with a unit (rad/s is an angular frequency)
    #[arg(long)]
    pub(crate) band: bool,
    /// Largest relative error on the window
    #[arg(long, value_name = "ERROR", default_value_t = 1e-4, allow_hyphen_values = true)]
    pub(crate) rtol: f64,
    /// Modulus of a spring beside the springpot, such as '200 N/m' [default: 0]
    #[arg(long, value_name = "MODULUS", allow_hyphen_values = true)]
    pub(crate) equilibrium: Option<String>,
    /// What to print
    #[arg(long, value_enum, default_value_t = PronyFormat::Table)]
    pub(crate) format: PronyFormat,
    /// With --format abaqus or ansys: what the bulk modulus does
    #[arg(long, value_enum, default_value_t = BulkModulus::Elastic)]
    pub(crate) bulk: BulkModulus,
    /// Write a file instead of the standard output
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
}

/// How a Prony series is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum PronyFormat {
    /// A table to read
    Table,
    /// Comma-separated values: modulus, relaxation time, viscosity
    Csv,
    /// Everything, with the window and the error
    Json,
    /// Abaqus keywords (*VISCOELASTIC, TIME=PRONY)
    Abaqus,
    /// Ansys Mechanical APDL commands (TB,PRONY)
    Ansys,
}

/// The bulk modulus where a series is taken for a shear modulus.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum BulkModulus {
    /// It does not relax
    Elastic,
    /// It relaxes like the shear modulus
    Relaxes,
}
