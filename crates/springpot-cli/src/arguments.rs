//! What the command line takes.

mod look;

use clap::{ArgGroup, Args, Parser, Subcommand, ValueEnum, ValueHint};
use look::LookOptions;
use springpot::fractional::{Definition, Method};
use springpot_run::linear::Where;
use springpot_run::sweep::Shard;
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
  springpot run arm.toml --set element.strut.alpha=0.3 --out soft
  springpot run arm.toml --set 'element.strut.T=40 degC' --out warm
  springpot run arm.toml --sweep element.strut.alpha=0.2,0.5,0.8
  springpot run arm.toml --format parquet
  springpot run arm.toml --checkpoint-every '10 s'
  springpot run --resume results/arm
  springpot run grid.toml --shard 3/16

Writes results.csv (or .parquet, .npz), summary.csv, events.csv and metrics.csv where there are events and metrics, figures/ and run.json. \
They take the place of the last run's files when the run ends, all or none, \
and of nothing else; one run at a time writes to a folder. \
Ctrl-C ends a run early; the rows so far are kept, all of them complete. With --checkpoint-every a run that was interrupted or \
killed goes on with --resume, and its results are those of an uninterrupted run.")]
    Run(RunOptions),
    /// Run a scenario with its derivatives, and say which of its numbers matter.
    #[command(after_help = "\
Examples:
  springpot sensitivity arm.toml
  springpot sensitivity arm.toml --by element.strut.k,element.strut.to.point.0
  springpot sensitivity arm.toml --by element.strut.k --of 'q.*' --check

Runs the scenario as `run --sensitivity` does, into a folder of results, and prints which parameters change which columns most, the gradients of \
its metrics, and what the derivatives take of steps. Without --by the parameters are those of [sensitivity], or all [[parameter]]. With --check the \
derivatives of the first case are compared with differences of whole runs, one line a parameter.

Exit codes: 0 done, 1 a run failed or a derivative differs by more than 1e-5 of its largest value, 2 the input was refused, 130 interrupted.")]
    Sensitivity(SensitivityOptions),
    /// Move the parameters of a scenario until a metric is as small, or as large, as constraints let it be.
    #[command(after_help = "\
Examples:
  springpot design strut.toml
  springpot design strut.toml --starts 20 --out designed

Moves every [[parameter]] within its bounds by exact gradients, from several starts, for [design] of the file. Into the folder of results: \
design.json, steps.csv with all runs, designed.toml, the scenario with the values found and its comments, and the results of its run.

Exit codes: 0 done, 1 no admissible point was found or the search did not converge, 2 the input was refused, 130 interrupted.")]
    Design(DesignOptions),
    /// Put the parts of a run together that several machines have run.
    #[command(after_help = "\
Examples:
  springpot run grid.toml --shard 1/2 --out part-1
  springpot run grid.toml --shard 2/2 --out part-2
  springpot merge part-1 part-2 --out results/grid

The results are those of the whole run on one machine, to the bit, with its figures; parts may be named in any order and stay as they are. \
A part that was interrupted or killed goes on with `springpot run --resume PART`.")]
    Merge(MergeOptions),
    /// Read and check a scenario without running it.
    #[command(after_help = "\
Examples:
  springpot check scenarios/magnetorheological_order.toml
  springpot check --schema > springpot.schema.json

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
    /// Differentiate columns of a CSV file to any order from -2 to 2.
    #[command(after_help = "\
Examples:
  springpot derivative motion.csv --column x --order 0.5
  springpot derivative motion.csv --column x --column y --order 0.5 --order -1
  springpot derivative motion.csv --column x --order 1.5 --error --out bend.csv
  springpot derivative sweep.csv --column x --order 0.5 --where case=2
  springpot derivative - --column force --order -0.5 --scheme exponential

Negative orders integrate. Writes the columns of the file, time first, then one called \"D^0.5 x\" for every column and order; rows where the derivative is \
infinite stay empty. The lower terminal is the first time. spline (smooth samples), hermite (follows kinks and noise over fewer \
samples) and the names of the literature want all rows at once; exponential writes each row three rows later, and large files \
take it in place of spline: the numbers are the same to 1e-12. l1 is exact for broken lines.")]
    Derivative(DerivativeOptions),
    /// Turn a springpot into springs and dampers with a verified error.
    #[command(after_help = "\
Examples:
  springpot prony --order 0.5 --coefficient '50 N*s^alpha/m' --from 1e-3 --to 10
  springpot prony --order 0.5 --coefficient 50 --from 1e-3 --to 10 --format csv
  springpot prony --order 0.3 --coefficient 2e6 --band --from 0.1 --to 1e3

For codes that know no fractional order. The series G_e + sum of g_k exp(-t/tau_k) stands for the relaxation G(t) = G_e + c t^-alpha/Gamma(1 - alpha) between two times, or, \
with --band, for the complex modulus G_e + c (i omega)^alpha between two frequencies. All g_k are positive: springs g_k, each in \
series with a damper g_k tau_k. The error is verified after building. Numbers without a unit are SI (frequencies Hz).

Abaqus and Ansys need a long-term modulus above 0. Without --equilibrium a spring takes the place of what relaxes after the \
window; the bound includes it, and a comment says so.")]
    Prony(PronyOptions),
    /// Stiffness and loss of an element under steady sines, over frequency and amplitude.
    #[command(after_help = "\
Examples:
  springpot modulus scenarios/thermoviscoelastic_order.toml strut
  springpot modulus pad.toml pad --from '0.1 Hz' --to '1 kHz' --out pad.csv
  springpot modulus pad.toml pad --amplitude '2 mm' --out pad.svg
  springpot modulus rubber.toml mount --amplitude '0.1 mm,1 mm,5 mm'
  springpot modulus rubber.toml mount --from 10 --to 10 --amplitude '1 mm,5 mm'

K* = K' + i K'' is the force over the stroke of a sine that has lasted for ever, of a law that is not linear the first harmonic \
of the force; a cycle of the amplitude X loses pi K'' X^2. Inputs have their values at t = 0, sweeps their first ones. \
Where the law is not linear, or amplitudes are several, every row has its amplitude. Where --from is --to there is one frequency. \
Frequencies without a unit are in Hz.")]
    Modulus(ModulusOptions),
    /// Natural frequencies and damping about rest, and answers to sines.
    #[command(after_help = "\
Examples:
  springpot modes scenarios/falling_thermoviscoelastic.toml --equilibrium
  springpot modes arm.toml --at 0.5 --set element.strut.alpha=0.3
  springpot modes arm.toml --out eigenvalues.svg
  springpot modes arm.toml --frequency-response tau.q2 strut.force --to 20
  springpot modes arm.toml --sweep motion.controller.kp=10:99:9 --out locus.svg
  springpot modes arm.toml --margins q2 --decibel --out loop.svg

Linearises about the start, the configuration at a time, or the static equilibrium that the robot sinks into, and prints the \
eigenvalues of M s^2 + D s + K(s) on the principal sheet. At rest springpots and dashpots carry no force. Torques and inputs have their values at \
that time, sweeps their first ones; where the motion is prescribed, constant actuator forces hold it. \
Feedback and controllers that act at every time are in it, their references standing still; --open leaves them out, and sampled ones are \
always left out. INPUT is tau.JOINT, ELEMENT.INPUT, q.JOINT of a prescribed joint, or reference.JOINT of a controller; COLUMN is one of the results. \
--margins opens the loop at the torque of JOINT; its figure is FILE with gain and phase, and FILE-nyquist beside it. \
Frequencies without a unit are in Hz.

Exit codes: 0 done, 1 the motion does not come as far, 2 the input was refused, or there is no equilibrium.")]
    Modes(ModesOptions),
    /// Linear model of first order about rest, memories as a few decays.
    #[command(after_help = "\
Examples:
  springpot linearise arm.toml --input tau.q2 --output q.q2 --out arm.json
  springpot linearise arm.toml --input reference.q1 --output q.q1 --out loop.npz

x' = A x + B u, y = C x + D u of small motions about the start, the configuration at a time, or the static equilibrium. Every memory is a few \
decays, as few as keep each channel's frequency response within the tolerance of the exact one, relative to it at every frequency of the band. \
Feedback and controllers that act at every time are in it; --open leaves them out, and sampled ones are refused without it. \
Inputs are those of modes --frequency-response, outputs the columns of the results but energies. \
The .npz file has the keys of the .json file, with units along unit_names, about_t and about_q.

Exit codes: 0 done, 1 the tolerance is out of reach, or the motion does not come as far, 2 the input was refused.")]
    Linearise(LineariseOptions),
    /// Show the laws of elements, or find the parameters of one from a data sheet or a measurement.
    #[command(after_help = "\
Examples:
  springpot laws
  springpot laws thermoviscoelastic
  springpot laws --from 'tan_delta = 0.3 at 10 Hz, stiffness = 5 kN/m'
  springpot laws kelvin-voigt --from 'stiffness = 2 kN/m, damping = 40 N*s/m'
  springpot laws --from dma.csv --area '4 cm^2' --length '10 mm'

--from reads NAME = VALUE [at FREQUENCY], ..., where NAME is tan_delta (or loss_factor), \
stiffness (dynamic, |k*|), storage, loss or \
damping, and FREQUENCY is in Hz or rad/s, or 0 for a static value; a number is in Hz. \
Where a frequency is left out, it is the only other one that is \
given, else 0. Without NAME the law is the one that the data determine. \
tan_delta = 30 deg is the angle. Moduli (E', E'', ... in Pa) take the sample: area = 4 cm^2, length = 10 mm.

From a CSV file with the columns frequency, storage, and loss or tan_delta \
(units behind the names, E' [MPa]; else Hz and N/m) a law is fitted, k + c*(i*omega)^alpha unless NAME says which, \
and drawn into FILE-fit.svg.

Exit codes: 0 done, 1 the figure cannot be written, 2 no such law, or the data determine none.")]
    Laws(LawsOptions),
    /// Shift a modulus measured at several temperatures to one master curve.
    #[command(after_help = "\
Examples:
  springpot master dma.csv --reference '20 degC'
  springpot master dma.csv --reference '20 degC' --vertical --out master
  springpot master dma.csv --reference 293.15 --law fractional-zener --json

The columns are frequency, storage, and loss or tan_delta (or modulus and tan_delta), and T, with units behind the names: frequency [Hz], \
E' [MPa], T [degC]. Each temperature's curve is shifted onto its neighbour; WLF and Arrhenius are fitted to the shifts. Into the folder \
--out: shifts.csv, master.csv, master.json, and two figures.

Exit codes: 0 done, 1 curves do not overlap or a file cannot be written, 2 the table was refused.")]
    Master(MasterOptions),
    /// Fit parameters of a scenario to measurements.
    #[command(after_help = "\
Examples:
  springpot fit pad.toml
  springpot fit pad.toml --laws springpot,fractional-kelvin-voigt --out pad-fit
  springpot fit arm.toml --starts 4 --intervals profile --strict

[[data]] names CSV files and their columns, [[parameter]] what is sought, [fit] how. Data are moduli, relaxation or creep of an element, its force along \
a measured stroke, or columns of a run; a file whose data are all of elements needs no robot, motion or time. Into the folder --out: fit.json, parameters.csv, \
correlation.csv, residuals.csv, fitted.toml, and figures. `springpot check` says beforehand what the data can determine.

Exit codes: 0 done, 1 not converged, no start could be evaluated, or --strict and something is not determined, 2 the scenario or its data were refused, 130 \
interrupted: the best so far is written.")]
    Fit(FitOptions),
    /// Draw columns of a finished run.
    #[command(after_help = "\
Examples:
  springpot plot results/arm strut.force
  springpot plot results/arm 'strut.Q.*' --where element.strut.alpha=0.4
  springpot plot results/arm strut.force --x strut.stroke --out loop.svg
  springpot plot results/arm strut.force --unit strut.force=kN --y-range 0,2
  springpot plot results/arm results/other strut.force --out both.pdf
  springpot plot results/orders 'max(strut.force)' --x element.strut.alpha

The cases of a first sweep make curves, those of others panels. \
Columns may be globs: * stands for any text, ? for one character. \
Several results are drawn in one figure, whose legend names their folders.

Exit codes: 0 done, 1 the figure cannot be drawn or written, 2 the results, a column or a value is not there.")]
    Plot(Box<PlotOptions>),
    /// Work out metrics of a finished run from its rows.
    #[command(after_help = "\
Examples:
  springpot metrics results/arm
  springpot metrics results/arm --metric 'rms(strut.force)'
  springpot metrics results/arm --metric 'peak = max(v.q1), window = [1, 2]'
  springpot metrics arm --metric 'settling-time(gripper.error), band = \"1 mm\"'

Prints what the run wrote into metrics.csv, or other metrics: [NAME =] KIND(COLUMN), and behind commas window, band, target and levels as \
[[metric]] of a scenario has them. Kinds: min, max, final, peak-to-peak, mean, rms, settling-time, overshoot, frequency, \
log-decrement, residual-vibration, rise-time, iae, ise, itae, effort. Reads results.csv, .parquet and .npz; where metrics.csv of the run is missing it is written again.

Exit codes: 0 done, 1 a file cannot be written, 2 the results, a metric or a column is not there.")]
    Metrics(MetricsOptions),
    /// Write a page that shows the robot of a run in motion, or serve it while the run goes on.
    #[command(after_help = "\
Examples:
  springpot view results/arm
  springpot view results/arm --case 0,4 --out soft_and_stiff.html
  springpot view results/arm --serve

Writes one file, view.html among the results, which any browser opens and which asks for nothing from a network: the robot moving, its elements \
coloured by force or stored energy, the gripper's trail, events, and curves of any columns beside it; ? on the page lists its keys. Of a sweep \
the first 12 cases are shown, or those named; of more than a million numbers, every so many rows. `run --view` writes it too. With --serve the page comes from 127.0.0.1 until Ctrl-C, and follows a run that is under way in \
the folder.

Exit codes: 0 done, 1 the file cannot be written or the port is taken, 2 the results or a case are not there.")]
    View(ViewOptions),
    /// Write a page that says what a run was and what came of it, or how two runs differ.
    #[command(after_help = "\
Examples:
  springpot report results/arm
  springpot report results/arm results/stiff --out compared.html
  springpot report results/arm --tex

Writes one file, report.html among the results, to be read in any browser and printed: warnings, figures, each element with its law, equations, \
parameters and source, metrics, events, the balance of energy case by case, the robot, statistics of the columns, the scenario as it was run and the \
command that runs it again. Of two results, comparison.html among the first: what was run otherwise, metrics side by side, curves over one another, \
and the largest difference of every column. --tex writes the same as a LaTeX document, report.tex, with its pictures in the folder \
report-figures beside it: pdflatex makes a PDF of them.

Exit codes: 0 done, 1 the file cannot be written, 2 there are no results.")]
    Report(ReportOptions),
    /// Write a finished run as a file for other programs: MCAP, glTF.
    #[command(after_help = "\
Examples:
  springpot export results/arm arm.mcap
  springpot export results/arm soft.glb --case 4

The ending of the file says what it is. .mcap is a recording as ROS 2 makes them, for Foxglove and rosbag2: joint states, frames, the gripper, \
elements and all other columns of every row, with all digits, and events. .glb and .gltf (the same as text) are the robot with its elements in \
motion in glTF 2.0, for browsers, Blender and engines of games, with at most 2000 keyframes.

Exit codes: 0 done, 1 the file cannot be written, 2 the results or a case are not there, or the ending is none of these.")]
    Export(ExportOptions),
    /// Write a scenario as an FMU, which other simulation tools drive (FMI 2.0 for Co-Simulation).
    #[command(after_help = "\
Examples:
  springpot fmu arm.toml
  springpot fmu arm.toml --set element.strut.alpha=0.3 --out soft.fmu
  springpot fmu arm.toml --library target/release/libspringpot_capi.so

Inputs of the FMU are tau.JOINT, added to the actuator force of every joint that a force drives, and ELEMENT.INPUT; outputs are all \
other columns of a run; parameters are those of the laws, start.q and start.v, all in SI units. Steps of communication may have any size; states can be \
kept, set and serialized. A motion that is given in advance has no tau.JOINT. The scenario and every file that it names are in the FMU, \
with the shared library of this platform.

Exit codes: 0 done, 1 the scenario cannot start, or the file cannot be written, 2 the scenario was refused (several cases, named \
schemes), or the library is not there.")]
    Fmu(FmuOptions),
    /// Write a commented scenario to start from.
    #[command(after_help = "\
Examples:
  springpot init
  springpot init panda.urdf --out panda_mount.toml
  springpot init panda.urdf --from panda_link0 --to panda_link3
  springpot init panda.urdf --forward --gripper panda_hand
  springpot init quadrotor.urdf --floating-base

Without a robot: an arm with one element, in scenario.toml. \
With one: its joints and an element between two of its links, in \
ROBOT.toml. A file that is there is never overwritten. What is written runs as it is.

Exit codes: 0 done, 1 the file cannot be written, 2 it is there, or the robot was refused.")]
    Init(InitOptions),
    /// Print a script that completes commands and options in a shell.
    #[command(after_help = "\
Examples:
  springpot completions bash > springpot.bash
  springpot completions zsh > ~/.zfunc/_springpot
  springpot completions fish > ~/.config/fish/completions/springpot.fish
  springpot completions powershell >> $PROFILE")]
    Completions(CompletionsOptions),
    /// Print the manual page, or write the pages of all commands.
    #[command(after_help = "\
Examples:
  springpot man | man -l -
  springpot man --out ~/.local/share/man/man1")]
    Man(ManOptions),
}

#[derive(Debug, Args)]
pub(crate) struct LawsOptions {
    /// Law to describe, or to find parameters of [default: all]
    #[arg(value_name = "NAME")]
    pub(crate) name: Option<String>,
    /// Values of a data sheet, such as 'tan_delta = 0.3 at 10 Hz, stiffness = 5 kN/m', or a CSV file
    #[arg(long, value_name = "DATA")]
    pub(crate) from: Option<String>,
    /// Area of the sample that moduli were measured on, such as '4 cm^2'
    #[arg(long, value_name = "AREA", requires = "from", allow_hyphen_values = true)]
    pub(crate) area: Option<String>,
    /// Its length, such as '10 mm'
    #[arg(long, value_name = "LENGTH", requires = "from", allow_hyphen_values = true)]
    pub(crate) length: Option<String>,
    /// Figure of a CSV file and its law, .svg or .png [default: FILE-fit.svg]
    #[arg(long, value_name = "FILE", requires = "from")]
    pub(crate) out: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Print a LaTeX document
    #[arg(long, conflicts_with_all = ["json", "from"])]
    pub(crate) latex: bool,
}

#[derive(Debug, Args)]
pub(crate) struct FitOptions {
    /// Scenario file (TOML) with [[data]] and [[parameter]]
    #[arg(value_name = "SCENARIO")]
    pub(crate) file: PathBuf,
    /// Override a value of the file, such as element.strut.alpha=0.5; PATH= takes the key out; may be given several times
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub(crate) overrides: Vec<String>,
    /// Number of starts, in place of that of [fit]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000), allow_negative_numbers = true)]
    pub(crate) starts: Option<u32>,
    /// How intervals are found, in place of that of [fit]: wald, profile or bootstrap(COUNT)
    #[arg(long, value_name = "HOW")]
    pub(crate) intervals: Option<String>,
    /// Laws, or networks, to be fitted one after the other, in place of those of [fit]
    #[arg(long, value_name = "LAW,...")]
    pub(crate) laws: Option<String>,
    /// Folder for the files [default: results/SCENARIO]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Print fit.json
    #[arg(long)]
    pub(crate) json: bool,
    /// Exit with 1 where parameters are not determined
    #[arg(long)]
    pub(crate) strict: bool,
}

#[derive(Debug, Args)]
pub(crate) struct MasterOptions {
    /// CSV file with a header row: frequency, storage and loss or tan_delta, T
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,
    /// Temperature of the master curve, in K or with a unit
    #[arg(long, value_name = "TEMPERATURE", allow_hyphen_values = true)]
    pub(crate) reference: String,
    /// Shift moduli too, by a factor b_T of each temperature
    #[arg(long)]
    pub(crate) vertical: bool,
    /// Fit this law to the master curve
    #[arg(long, value_name = "NAME")]
    pub(crate) law: Option<String>,
    /// With --law and moduli: area of the part, such as '4 cm^2' [default: 1 m^2]
    #[arg(long, value_name = "AREA", requires = "law", allow_hyphen_values = true)]
    pub(crate) area: Option<String>,
    /// With --law and moduli: its length, such as '10 mm' [default: 1 m]
    #[arg(long, value_name = "LENGTH", requires = "law", allow_hyphen_values = true)]
    pub(crate) length: Option<String>,
    /// Folder for the files [default: results/FILE]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct PlotOptions {
    /// Folder of the results of a run, or its results.csv
    #[arg(value_name = "RESULTS")]
    pub(crate) results: PathBuf,
    /// Columns to draw, or statistics such as max(COLUMN) over a swept parameter; before them further results to draw in the same figure
    #[arg(value_name = "COLUMN", required = true)]
    pub(crate) y: Vec<String>,
    /// Column of the abscissa; of statistics a swept path
    #[arg(long, value_name = "COLUMN", default_value = "t")]
    pub(crate) x: String,
    /// Draw only the cases with this value of a swept parameter; may be given several times
    #[arg(long = "where", value_name = "PATH=VALUE")]
    pub(crate) selection: Vec<String>,
    /// Unit to draw a column in, such as strut.stroke=mm; may be given several times
    #[arg(long = "unit", value_name = "COLUMN=UNIT")]
    pub(crate) units: Vec<String>,
    /// File to write, .svg, .png or .pdf [default: SVG and PNG in the figures/ of the results]
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// Formats of the figure among the results, of svg, png and pdf [default: svg,png]
    #[arg(long, value_name = "FORMAT,...", value_delimiter = ',', conflicts_with = "out")]
    pub(crate) formats: Vec<String>,
    /// Title of the figure
    #[arg(long, value_name = "TEXT")]
    pub(crate) title: Option<String>,
    #[command(flatten)]
    pub(crate) look: LookOptions,
}

#[derive(Debug, Args)]
pub(crate) struct MetricsOptions {
    /// Folder of the results of a run, or its file of rows
    #[arg(value_name = "RESULTS")]
    pub(crate) results: PathBuf,
    /// A metric in place of those of the run: [NAME =] KIND(COLUMN), KEY = VALUE, ...; may be given several times
    #[arg(long = "metric", value_name = "METRIC")]
    pub(crate) metrics: Vec<String>,
    /// Write a file instead of the standard output
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct ReportOptions {
    /// Folder of the results of a run
    #[arg(value_name = "RESULTS")]
    pub(crate) results: PathBuf,
    /// Results to compare them with
    #[arg(value_name = "OTHER")]
    pub(crate) other: Option<PathBuf>,
    /// File to write [default: report.html, or comparison.html, among the results; with --tex those names with .tex]
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// Write a LaTeX document, with its pictures in a folder beside it
    #[arg(long)]
    pub(crate) tex: bool,
}

#[derive(Debug, Clone, Args)]
pub(crate) struct ViewOptions {
    /// Folder of the results of a run
    #[arg(value_name = "RESULTS")]
    pub(crate) results: PathBuf,
    /// Cases to show, counted from 0 [default: the first 12]
    #[arg(long = "case", value_name = "K,...", value_delimiter = ',')]
    pub(crate) cases: Vec<usize>,
    /// File to write [default: view.html among the results]
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// Serve the page to browsers on this machine instead, with the rows of a run under way as they come
    #[arg(long, conflicts_with = "out")]
    pub(crate) serve: bool,
    /// Port of the server [default: any that is free]
    #[arg(long, value_name = "N", requires = "serve")]
    pub(crate) port: Option<u16>,
}

#[derive(Debug, Args)]
pub(crate) struct ExportOptions {
    /// Folder of the results of a run
    #[arg(value_name = "RESULTS", value_hint = ValueHint::DirPath)]
    pub(crate) results: PathBuf,
    /// File to write: .mcap, .glb or .gltf
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) file: PathBuf,
    /// Case to write, counted from 0 [default: the first that has rows]
    #[arg(long, value_name = "K")]
    pub(crate) case: Option<usize>,
}

#[derive(Debug, Args)]
pub(crate) struct FmuOptions {
    /// Scenario file (TOML)
    #[arg(value_name = "SCENARIO")]
    pub(crate) file: PathBuf,
    /// Override a value of the file, such as element.strut.alpha=0.5; PATH= takes the key out; may be given several times
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub(crate) overrides: Vec<String>,
    /// File to write [default: <file stem>.fmu]
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// Shared library of this platform [default: beside this command, or in ../lib]
    #[arg(long, value_name = "FILE")]
    pub(crate) library: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct InitOptions {
    /// Robot (URDF or MJCF file)
    #[arg(value_name = "ROBOT")]
    pub(crate) robot: Option<PathBuf>,
    /// Let its root link float on a joint called floating_base
    #[arg(long, requires = "robot")]
    pub(crate) floating_base: bool,
    /// Take inertias that no distribution of mass has as they are
    #[arg(long, requires = "robot")]
    pub(crate) accept_inertia: bool,
    /// Let it move by forces, from rest, in place of a prescribed motion
    #[arg(long, requires = "robot")]
    pub(crate) forward: bool,
    /// Link whose place is told as that of the gripper
    #[arg(long, value_name = "LINK", requires = "robot")]
    pub(crate) gripper: Option<String>,
    /// Link that the element begins at
    #[arg(long, value_name = "LINK", requires = "robot")]
    pub(crate) from: Option<String>,
    /// Link that it ends at
    #[arg(long, value_name = "LINK", requires = "robot")]
    pub(crate) to: Option<String>,
    /// File to write [default: scenario.toml, or the name of the robot's file with .toml]
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct CompletionsOptions {
    /// Shell
    #[arg(value_name = "SHELL")]
    pub(crate) shell: clap_complete::Shell,
}

#[derive(Debug, Args)]
pub(crate) struct ManOptions {
    /// Folder to write springpot.1 and a page for every command into
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct RunOptions {
    /// Scenario file (TOML)
    #[arg(value_name = "SCENARIO", required_unless_present = "resume")]
    pub(crate) file: Option<PathBuf>,
    /// Override a value of the file, such as element.strut.alpha=0.5; PATH= takes the key out; may be given several times
    #[arg(long = "set", value_name = "PATH=VALUE", conflicts_with = "resume")]
    pub(crate) overrides: Vec<String>,
    /// Sweep a parameter: PATH=v1,v2,... or PATH=FROM:TO:COUNT[:log]; may be given several times
    #[arg(long = "sweep", value_name = "PATH=VALUES", conflicts_with = "resume")]
    pub(crate) sweeps: Vec<String>,
    /// Differentiate every column by these numbers too: paths, or names of parameters; may be given several times
    #[arg(long, value_name = "PATH,PATH", conflicts_with = "resume")]
    pub(crate) sensitivity: Vec<String>,
    /// Folder of the results [default: results/<file stem>]
    #[arg(long, value_name = "DIR", conflicts_with = "resume")]
    pub(crate) out: Option<PathBuf>,
    /// Format of the rows: csv, parquet or npz (NumPy)
    #[arg(long, value_name = "FORMAT", value_parser = ["csv", "parquet", "npz"], default_value = "csv")]
    #[arg(hide_possible_values = true, conflicts_with = "resume")]
    pub(crate) format: String,
    /// Keep the state of the run every so much simulated time, in s or with a unit
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub(crate) checkpoint_every: Option<String>,
    /// Go on with the run whose results are in this folder
    #[arg(long, value_name = "DIR", conflicts_with = "file")]
    pub(crate) resume: Option<PathBuf>,
    /// Run one part of the cases, such as 3/16 on the third of 16 machines; `merge` puts the parts together
    #[arg(long, value_name = "K/N", conflicts_with = "resume")]
    pub(crate) shard: Option<Shard>,
    /// Cases at a time [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..), allow_negative_numbers = true)]
    pub(crate) jobs: Option<u16>,
    /// Write no figures
    #[arg(long)]
    pub(crate) no_figures: bool,
    /// Write view.html too, a page that shows the robot in motion
    #[arg(long)]
    pub(crate) view: bool,
    /// Print nothing but warnings and errors
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

#[derive(Debug, Args)]
pub(crate) struct SensitivityOptions {
    /// Scenario file (TOML)
    #[arg(value_name = "SCENARIO")]
    pub(crate) file: PathBuf,
    /// Differentiate by these numbers: paths, or names of parameters [default: those of the file]
    #[arg(long, value_name = "PATH,PATH")]
    pub(crate) by: Vec<String>,
    /// Differentiate these columns, or all that a glob matches [default: those of the file]
    #[arg(long, value_name = "COLUMN,COLUMN", value_delimiter = ',')]
    pub(crate) of: Vec<String>,
    /// Override a value of the file, such as element.strut.alpha=0.5; PATH= takes the key out; may be given several times
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub(crate) overrides: Vec<String>,
    /// Sweep a parameter: PATH=v1,v2,... or PATH=FROM:TO:COUNT[:log]; may be given several times
    #[arg(long = "sweep", value_name = "PATH=VALUES")]
    pub(crate) sweeps: Vec<String>,
    /// Compare with differences of whole runs of the first case
    #[arg(long)]
    pub(crate) check: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Folder of the results [default: results/<file stem>]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Cases at a time [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..), allow_negative_numbers = true)]
    pub(crate) jobs: Option<u16>,
    /// Write no figures
    #[arg(long)]
    pub(crate) no_figures: bool,
}

#[derive(Debug, Args)]
pub(crate) struct DesignOptions {
    /// Scenario file (TOML)
    #[arg(value_name = "SCENARIO")]
    pub(crate) file: PathBuf,
    /// Override a value of the file, such as element.strut.alpha=0.5; PATH= takes the key out; may be given several times
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub(crate) overrides: Vec<String>,
    /// Starts of the search [default: those of the file, 8]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..), allow_negative_numbers = true)]
    pub(crate) starts: Option<u16>,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Folder of the results [default: results/<file stem>]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Starts at a time [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..), allow_negative_numbers = true)]
    pub(crate) jobs: Option<u16>,
    /// Write no figures
    #[arg(long)]
    pub(crate) no_figures: bool,
}

#[derive(Debug, Args)]
pub(crate) struct MergeOptions {
    /// Folders of the parts
    #[arg(value_name = "DIR", required = true)]
    pub(crate) parts: Vec<PathBuf>,
    /// Folder of the results [default: results/<file stem>]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Format of the rows: csv, parquet or npz (NumPy) [default: that of the parts]
    #[arg(long, value_name = "FORMAT", value_parser = ["csv", "parquet", "npz"], hide_possible_values = true)]
    pub(crate) format: Option<String>,
    /// Write no figures
    #[arg(long)]
    pub(crate) no_figures: bool,
    /// Print nothing but warnings and errors
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

#[derive(Debug, Args)]
pub(crate) struct CheckOptions {
    /// Scenario file (TOML)
    #[arg(value_name = "SCENARIO", required_unless_present = "schema")]
    pub(crate) file: Option<PathBuf>,
    /// Override a value of the file, such as element.strut.alpha=0.5; PATH= takes the key out; may be given several times
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub(crate) overrides: Vec<String>,
    /// Sweep a parameter: PATH=v1,v2,... or PATH=FROM:TO:COUNT[:log]; may be given several times
    #[arg(long = "sweep", value_name = "PATH=VALUES")]
    pub(crate) sweeps: Vec<String>,
    /// Differentiate every column by these numbers too: paths, or names of parameters; may be given several times
    #[arg(long, value_name = "PATH,PATH")]
    pub(crate) sensitivity: Vec<String>,
    /// Print the JSON schema of scenario files, with which editors complete them
    #[arg(long, conflicts_with_all = ["file", "overrides", "sweeps", "sensitivity", "quiet"])]
    pub(crate) schema: bool,
    /// Print nothing but warnings and errors
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ModulusOptions {
    /// Scenario file (TOML)
    #[arg(value_name = "SCENARIO")]
    pub(crate) file: PathBuf,
    /// Name of the element
    #[arg(value_name = "ELEMENT")]
    pub(crate) element: String,
    /// Lowest frequency
    #[arg(long, value_name = "FREQUENCY", default_value = "0.01 Hz", allow_hyphen_values = true)]
    pub(crate) from: String,
    /// Highest frequency
    #[arg(long, value_name = "FREQUENCY", default_value = "100 Hz", allow_hyphen_values = true)]
    pub(crate) to: String,
    /// Number of frequencies, evenly on a logarithmic scale
    #[arg(long, value_name = "N", default_value_t = 121, allow_hyphen_values = true)]
    pub(crate) points: usize,
    /// Amplitude of the stroke, or several of them; of a law that is not linear it must be given [default: 1 mm, or 1 mrad]
    #[arg(long, value_name = "STROKE[,STROKE…]", allow_hyphen_values = true)]
    pub(crate) amplitude: Option<String>,
    /// Override a value of the file, such as element.strut.alpha=0.5; PATH= takes the key out; may be given several times
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub(crate) overrides: Vec<String>,
    /// Print all of it as JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Write FILE.csv, .json, .svg, .png or .pdf instead of printing
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
}

// The configuration that small motions are about: a doc comment would be the help of the command.
#[derive(Debug, Args)]
pub(crate) struct AboutOptions {
    /// Go to the static equilibrium first
    #[arg(long)]
    pub(crate) equilibrium: bool,
    /// Time of the motion, in s or with a unit [default: the start]
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub(crate) at: Option<String>,
    /// Leave feedback and controllers out
    #[arg(long)]
    pub(crate) open: bool,
}

impl AboutOptions {
    /// As the library is asked.
    pub(crate) fn place(&self) -> Where<'_> {
        Where { at: self.at.as_deref(), equilibrium: self.equilibrium, open: self.open }
    }
}

#[derive(Debug, Args)]
pub(crate) struct ModesOptions {
    /// Scenario file (TOML)
    #[arg(value_name = "SCENARIO")]
    pub(crate) file: PathBuf,
    #[command(flatten)]
    pub(crate) about: AboutOptions,
    /// Answer of a column to sines of an input, over the frequency
    #[arg(long, value_names = ["INPUT", "COLUMN"], num_args = 2, group = "frequency")]
    pub(crate) frequency_response: Vec<String>,
    /// Phase, gain and delay margins of the loop through a joint's torque
    #[arg(long, value_name = "JOINT", group = "frequency", conflicts_with_all = ["frequency_response", "open"])]
    pub(crate) margins: Option<String>,
    /// Eigenvalues of every case: PATH=1,2,3 or PATH=from:to:count; may be given several times
    #[arg(long = "sweep", value_name = "PATH=VALUES", conflicts_with_all = ["frequency_response", "margins"])]
    pub(crate) sweeps: Vec<String>,
    /// Gains of figures in dB
    #[arg(long)]
    pub(crate) decibel: bool,
    /// Lowest frequency
    #[arg(long, value_name = "FREQUENCY", default_value = "0.1 Hz", requires = "frequency")]
    #[arg(allow_hyphen_values = true)]
    pub(crate) from: String,
    /// Highest frequency
    #[arg(long, value_name = "FREQUENCY", default_value = "100 Hz", requires = "frequency")]
    #[arg(allow_hyphen_values = true)]
    pub(crate) to: String,
    /// Number of frequencies, evenly on a logarithmic scale
    #[arg(long, value_name = "N", default_value_t = 301, requires = "frequency", allow_hyphen_values = true)]
    pub(crate) points: usize,
    /// Override a value of the file, such as element.strut.alpha=0.5; PATH= takes the key out; may be given several times
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub(crate) overrides: Vec<String>,
    /// Print all of it as JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Write FILE.csv, .json, .svg, .png or .pdf instead of printing
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct LineariseOptions {
    /// Scenario file (TOML)
    #[arg(value_name = "SCENARIO")]
    pub(crate) file: PathBuf,
    /// Inputs: tau.JOINT, ELEMENT.INPUT, q.JOINT of a prescribed joint, reference.JOINT of a controller
    #[arg(long = "input", value_name = "NAME[,NAME…]", required = true, value_delimiter = ',')]
    pub(crate) inputs: Vec<String>,
    /// Outputs: columns of the results
    #[arg(long = "output", value_name = "COLUMN[,COLUMN…]", required = true, value_delimiter = ',')]
    pub(crate) outputs: Vec<String>,
    #[command(flatten)]
    pub(crate) about: AboutOptions,
    /// Frequencies between which it is exact
    #[arg(long, value_name = "FROM,TO", default_value = "0.1 Hz,100 Hz", allow_hyphen_values = true)]
    pub(crate) band: String,
    /// Relative deviation that every channel may have
    #[arg(long, value_name = "SHARE", default_value_t = 1e-4, allow_hyphen_values = true)]
    pub(crate) tolerance: f64,
    /// Override a value of the file, such as element.strut.alpha=0.5; PATH= takes the key out; may be given several times
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub(crate) overrides: Vec<String>,
    /// File to write: .json, or .npz for NumPy
    #[arg(long, value_name = "FILE")]
    pub(crate) out: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct RobotOptions {
    /// Robot: a URDF or MJCF file (.urdf, .xml), or a scenario or its [robot] alone (.toml)
    #[arg(value_name = "ROBOT")]
    pub(crate) file: PathBuf,
    /// Let the root link of a URDF file float on a joint called floating_base
    #[arg(long)]
    pub(crate) floating_base: bool,
    /// Give joints that mimic another one coordinates of their own
    #[arg(long)]
    pub(crate) ignore_mimic: bool,
    /// Take inertias of a file that no distribution of mass has as they are
    #[arg(long)]
    pub(crate) accept_inertia: bool,
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
    #[arg(long, value_name = "N", conflicts_with = "states", allow_negative_numbers = true)]
    pub(crate) case: Option<usize>,
    /// With --at: print JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// With --at: print a LaTeX document
    #[arg(long, conflicts_with_all = ["states", "json"])]
    pub(crate) latex: bool,
    /// Override a value of a scenario, such as element.strut.alpha=0.5; may be given several times
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub(crate) overrides: Vec<String>,
}

#[derive(Debug, Args)]
pub(crate) struct DerivativeOptions {
    /// CSV file with a header row; - or nothing reads the standard input
    #[arg(value_name = "FILE")]
    pub(crate) file: Option<PathBuf>,
    /// Column to differentiate; may be given several times
    #[arg(long = "column", value_name = "NAME", required = true)]
    pub(crate) columns: Vec<String>,
    /// Order of the derivative, -2 to 2; may be given several times
    #[arg(long = "order", value_name = "ORDER", required = true, allow_hyphen_values = true)]
    pub(crate) orders: Vec<f64>,
    /// Column of the times [default: t, else the first]
    #[arg(long, value_name = "NAME")]
    pub(crate) time: Option<String>,
    /// Take the rows where a column has a value, as those of one case; may be given several times
    #[arg(long = "where", value_name = "COLUMN=VALUE")]
    pub(crate) selection: Vec<String>,
    /// caputo, riemann-liouville or grunwald-letnikov
    #[arg(long, value_name = "KIND", default_value = "caputo")]
    pub(crate) kind: Definition,
    /// spline, hermite, exponential, grunwald-letnikov, grunwald-letnikov(N), l1, l1-2, fbdf-1 to fbdf-6, expansion-2004(N), expansion-2008(N)
    #[arg(long, value_name = "SCHEME", default_value = "spline")]
    pub(crate) scheme: Method,
    /// Add a column with an estimate of the error behind every derivative
    #[arg(long)]
    pub(crate) error: bool,
    /// File to write [default: the standard output]
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct ScenarioOptions {
    /// Scenario file (TOML)
    #[arg(value_name = "SCENARIO")]
    pub(crate) file: PathBuf,
    /// Override a value of the file, such as element.strut.alpha=0.5; PATH= takes the key out; may be given several times
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub(crate) overrides: Vec<String>,
}

#[derive(Debug, Args)]
pub(crate) struct PronyOptions {
    /// Order alpha of the springpot, above 0 and below 1
    #[arg(long, value_name = "ALPHA", allow_hyphen_values = true, required_unless_present = "law")]
    pub(crate) order: Option<f64>,
    /// Coefficient c, such as '50 N*s^alpha/m' or '2 MPa*s^alpha'
    #[arg(long, value_name = "C", allow_hyphen_values = true, required_unless_present = "law")]
    pub(crate) coefficient: Option<String>,
    /// A whole law in place of the springpot, such as fractional-zener
    #[arg(long, value_name = "NAME", conflicts_with_all = ["order", "coefficient", "equilibrium"])]
    pub(crate) law: Option<String>,
    /// A parameter of the law; may be given several times
    #[arg(long = "parameter", value_name = "NAME=VALUE", requires = "law", allow_hyphen_values = true)]
    pub(crate) parameters: Vec<String>,
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

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    /// The words of a line of a shell, up to what the shell does with the output.
    fn words(line: &str) -> Vec<String> {
        let (mut words, mut word, mut quoted) = (Vec::new(), String::new(), false);
        for c in line.chars().chain([' ']) {
            match c {
                '\'' => quoted = !quoted,
                '#' | '>' | '<' | '|' if !quoted && word.is_empty() => break,
                ' ' if !quoted => words.extend(Some(std::mem::take(&mut word)).filter(|word| !word.is_empty())),
                c => word.push(c),
            }
        }
        words
    }

    fn parses(line: &str) {
        let read = Arguments::try_parse_from(words(line));
        let help = read.as_ref().err().is_some_and(|error| !error.use_stderr());
        assert!(help || read.is_ok(), "{line}: {}", read.err().unwrap());
    }

    #[test]
    fn examples_of_the_help_are_admissible() {
        let program = Arguments::command();
        for command in program.get_subcommands() {
            let text = command.get_after_help().unwrap().to_string();
            let examples = text.lines().skip(1).take_while(|line| !line.is_empty());
            assert!(text.starts_with("Example") && examples.clone().count() > 0, "{}", command.get_name());
            for line in examples {
                assert!(line.chars().count() <= 80, "{line}");
                parses(line.trim());
            }
        }
    }

    #[test]
    fn commands_of_the_documents_are_admissible() {
        let mut seen = Vec::new();
        for document in ["README.md", "docs/COMMANDS.md", "docs/SCENARIO.md", "docs/ROBOTS.md"] {
            let path = format!("{}/../../{document}", env!("CARGO_MANIFEST_DIR"));
            let text = std::fs::read_to_string(path).unwrap();
            for line in text.split("\n```sh\n").skip(1).flat_map(|rest| rest.split("\n```").next().unwrap().lines()) {
                let line = line.replace("cargo run --release -- ", "springpot ");
                if line.starts_with("springpot ") {
                    parses(&line);
                    seen.push(words(&line)[1].clone());
                }
            }
        }
        let program = Arguments::command();
        for command in program.get_subcommands() {
            assert!(seen.iter().any(|name| name == command.get_name()), "no document shows {}", command.get_name());
        }
        assert!(seen.len() > 35, "{}", seen.len());
    }
}
