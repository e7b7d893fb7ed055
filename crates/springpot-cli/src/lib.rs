//! The command line of Springpot as a library: [`main_from`] takes the laws and the arguments and returns the exit code.
//!
//! A program with laws of its own has the whole command when its `main` is
//!
//! ```no_run
//! use springpot::law::{Catalog, Entry, Network};
//! use std::process::ExitCode;
//! use std::sync::Arc;
//!
//! fn main() -> ExitCode {
//!     let stiff = Entry {
//!         name: "stiff".into(),
//!         equation: "F = 1000·x".into(),
//!         params: Vec::new(),
//!         inputs: Vec::new(),
//!         source: "a crate with laws of its own".into(),
//!         build: Arc::new(|_, _| Ok(Network::spring(1000.0))),
//!     };
//!     springpot_cli::main_from(&Catalog::standard().with(stiff), std::env::args_os())
//! }
//! ```
//!
//! Exit codes: 0 done; 1 a run failed; 2 the input was refused; 130 interrupted.

mod arguments;
mod diagnostic;
mod drawing;
mod excerpt;
mod frequency;
mod grid;
mod material;
mod mistakes;
mod output;
mod plain;
mod programs;
mod progress;
mod results;
mod robot;
mod scenario;
mod signals;
mod terminal;

pub use programs::fmu::offer_library;
pub use scenario::check::{Findings, findings};

use arguments::{Arguments, Command, RunOptions};
use clap::Parser;
use springpot::law::Catalog;
use springpot::spatial::SimdLevel;
use springpot_run::table::disk::Disk;
use std::ffi::OsString;
use std::io::{self, Write as _};
use std::process::ExitCode;

/// How a command ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Ending {
    Done,
    Failed,
    Refused,
    Interrupted,
}

impl From<Ending> for u8 {
    fn from(ending: Ending) -> Self {
        match ending {
            Ending::Done => 0,
            Ending::Failed => 1,
            Ending::Refused => 2,
            Ending::Interrupted => 130,
        }
    }
}

/// How a command ends whose results were printed, or were not.
fn printed(result: io::Result<()>) -> Ending {
    match result {
        Ok(()) => Ending::Done,
        // Whoever reads has read enough.
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ending::Done,
        Err(error) => {
            diagnostic::error(format!("the results cannot be written: {error}"));
            Ending::Failed
        }
    }
}

/// More jobs than this, and than cores, are not started: each takes memory, and none of them is sooner done.
const MOST_JOBS: u16 = 64;

/// The options with a sane number of jobs.
fn with_fewer_jobs(options: RunOptions) -> RunOptions {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let most = u16::try_from(cores).unwrap_or(u16::MAX).max(MOST_JOBS);
    match options.jobs {
        Some(jobs) if jobs > most => {
            diagnostic::warning(format!("--jobs {jobs}: no more than {most} cases run at a time here"), None);
            RunOptions { jobs: Some(most), ..options }
        }
        _ => options,
    }
}

/// Runs the command that `arguments` ask for with the laws of `catalog`; the first argument is the program's name.
pub fn main_from(catalog: &Catalog, arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    main_on(catalog, &Disk::default(), arguments)
}

/// As [`main_from`], with all results of runs on `disk`.
pub fn main_on(catalog: &Catalog, disk: &Disk, arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    code(catalog, disk, arguments).into()
}

/// As [`main_from`], with the exit code as a number: for programs that end by themselves.
pub fn exit_code_from(catalog: &Catalog, arguments: impl IntoIterator<Item = OsString>) -> u8 {
    code(catalog, &Disk::default(), arguments)
}

/// Stack of a command, whatever the system gives to the thread that asks for it.
const STACK: usize = 8 << 20;

fn code(catalog: &Catalog, disk: &Disk, arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    let work = || command(catalog, disk, &arguments);
    std::thread::scope(|scope| match std::thread::Builder::new().stack_size(STACK).spawn_scoped(scope, work) {
        Ok(worker) => worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)),
        // Without memory for a thread this one may still do.
        Err(_) => work(),
    })
}

fn command(catalog: &Catalog, disk: &Disk, arguments: &[OsString]) -> u8 {
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(error) if mistakes::told(&error, arguments) => return Ending::Refused.into(),
        Err(error) => {
            let printed_all = error.print();
            if error.use_stderr() {
                return Ending::Refused.into();
            }
            // Help and version are results, which go to stdout.
            return printed(printed_all.and_then(|()| io::stdout().flush())).into();
        }
    };
    if let Err(error) = SimdLevel::chosen() {
        terminal::print_error(&format!("error: {error}\n"));
        return Ending::Refused.into();
    }
    let ending = match arguments.command {
        Command::Run(options) => scenario::run::run(&with_fewer_jobs(options), catalog, disk),
        Command::Sensitivity(options) => scenario::sensitivity::sensitivity(&options, catalog, disk),
        Command::Design(options) => scenario::design::design(&options, catalog, disk),
        Command::Merge(options) => scenario::run::merge(&options, catalog, disk),
        Command::Check(options) => scenario::check::check(&options, catalog),
        Command::Info(options) => robot::info::info(&options, catalog),
        Command::Dynamics(options) => robot::dynamics::dynamics(&options, catalog),
        Command::Derivative(options) => material::derivative::derivative(&options),
        Command::Laws(options) => material::laws::laws(&options, catalog),
        Command::Master(options) => material::master::master(&options, catalog),
        Command::Fit(options) => scenario::fit::fit_command(&options, catalog),
        Command::Plot(options) => results::plot::plot(&options),
        Command::Metrics(options) => results::metrics::metrics(&options, disk),
        Command::View(options) => results::view::view(&options, disk),
        Command::Report(options) => results::report::report(&options, disk),
        Command::Export(options) => results::export::export(&options, disk),
        Command::Fmu(options) => programs::fmu::fmu(&options, catalog),
        Command::Init(options) => scenario::init::init(&options, catalog),
        Command::Completions(options) => programs::manual::completions(&options),
        Command::Man(options) => programs::manual::man(&options),
        Command::Prony(options) => material::prony::prony(&options, catalog),
        Command::Modulus(options) => material::modulus::modulus(&options, catalog),
        Command::Modes(options) => robot::modes::modes(&options, catalog),
        Command::Linearise(options) => robot::linearise::linearise(&options, catalog),
    };
    ending.into()
}

/// The programs in the book, as documentation tests. docs/ is outside of the package: only tests of the workspace read it.
#[cfg(doctest)]
#[allow(rustdoc::invalid_codeblock_attributes, reason = "files that the reader writes have names")]
mod book {
    #[doc = include_str!("../../../docs/tutorial/rust.md")]
    struct Tutorial;
    #[doc = include_str!("../../../docs/how-to/own-law.md")]
    struct OwnLaw;
    #[doc = include_str!("../../../docs/how-to/own-controller.md")]
    struct OwnController;
}
