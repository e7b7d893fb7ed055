//! `springpot fmu`.

use crate::arguments::FmuOptions;
use crate::{Ending, diagnostic, output, printed, terminal};
use springpot::law::Catalog;
use springpot_capi::fmi::{LIBRARY, Package, PackageError, Role, is_this_library};
use springpot_run::numbers::count;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

pub(crate) fn fmu(options: &FmuOptions, catalog: &Catalog) -> Ending {
    let stem = options.file.file_stem().unwrap_or("scenario".as_ref());
    let out = options.out.clone().unwrap_or_else(|| Path::new(stem).with_extension("fmu"));
    if !out.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("fmu")) {
        let help = "write a name that ends in .fmu: other tools know an FMU by it".to_owned();
        diagnostic::error_with_help(format!("--out {} is no .fmu", out.display()), help);
        return Ending::Refused;
    }
    let packed = match diagnostic::scenario(&options.file, &options.overrides) {
        Ok(scenario) => Package::new(&scenario, &stem.to_string_lossy(), catalog),
        Err(refused) => Err(refused.into()),
    };
    let package = match packed.and_then(verified) {
        Ok(package) => package,
        Err(error) => return refused(error),
    };
    let library = match library(options.library.as_deref(), package.own_laws()) {
        Ok(library) => library,
        Err(ending) => return ending,
    };
    let archive = match package.archive(library) {
        Ok(archive) => archive,
        Err(error) => return refused(error),
    };
    for event in package.silent_events() {
        diagnostic::warning(
            format!("event {event:?} is not in the FMU"),
            Some("its master sees the columns and says what happens".to_owned()),
        );
    }
    match output::write(&out, &archive) {
        Ok(()) => printed(terminal::try_print(&summary(&package, &out))),
        failed => output::written(&out, failed),
    }
}

/// A package that stands in an empty folder as it does beside its files.
fn verified(package: Package) -> Result<Package, PackageError> {
    let folder = tempfile::tempdir().map_err(|error| PackageError::Moved(error.to_string()))?;
    package.verify(folder.path())?;
    Ok(package)
}

fn refused(error: PackageError) -> Ending {
    match error {
        PackageError::Scenario(refusals) => diagnostic::refused(&refusals),
        PackageError::Start(error) => {
            diagnostic::error(format!("the scenario cannot start: {error}"));
            return Ending::Failed;
        }
        error => diagnostic::error(error.to_string()),
    }
    Ending::Refused
}

/// The bytes of the library of this version: the one that is named, else the first that is found, which knows no `own_laws`.
fn library(named: Option<&Path>, own_laws: &[String]) -> Result<Vec<u8>, Ending> {
    let help = || {
        format!(
            "make it with cargo build --release -p springpot-capi, which puts {LIBRARY} into target/release, and name it with --library FILE"
        )
    };
    if let Some(file) = named {
        return match read(file) {
            Ok(bytes) if is_this_library(&bytes) => {
                let is_unheard = |law: &&String| !bytes.windows(law.len()).any(|window| window == law.as_bytes());
                if let Some(law) = own_laws.iter().find(is_unheard) {
                    let message = format!("the name of the law {law:?} is not in {}", file.display());
                    let help = "a library that does not know it cannot start the FMU: springpot_capi::set_catalog hands it over";
                    diagnostic::warning(message, Some(help.to_owned()));
                }
                Ok(bytes)
            }
            Ok(_) => {
                let message = format!("{} is not the library of this version of springpot", file.display());
                diagnostic::error_with_help(message, help());
                Err(Ending::Refused)
            }
            Err(error) => {
                diagnostic::error_with_help(format!("{} cannot be read: {error}", file.display()), help());
                Err(Ending::Refused)
            }
        };
    }
    if let Some(law) = own_laws.first() {
        let message =
            format!("the law {law:?} does not come with Springpot, and the library that does knows nothing of it");
        let help = "build a library that hands it to springpot_capi::set_catalog, and name it with --library FILE";
        diagnostic::error_with_help(message, help.to_owned());
        return Err(Ending::Refused);
    }
    let offered = OFFERED.get().and_then(|offer| offer());
    let mut found = places().into_iter().filter_map(|file| read(&file).ok()).chain(offered);
    found.find(|bytes| is_this_library(bytes)).ok_or_else(|| {
        diagnostic::error_with_help(format!("{LIBRARY}, which goes into the FMU, is not beside this command"), help());
        Ending::Refused
    })
}

static OFFERED: OnceLock<fn() -> Option<Vec<u8>>> = OnceLock::new();

/// Where `fmu` gets its library from when none stands beside the command: a program that has its functions offers itself.
pub fn offer_library(offer: fn() -> Option<Vec<u8>>) {
    // The first one stays: a process has one.
    let _ = OFFERED.set(offer);
}

/// A regular file; opening anything else may wait.
fn read(file: &Path) -> io::Result<Vec<u8>> {
    if !fs::metadata(file)?.is_file() {
        return Err(io::Error::other("not a regular file"));
    }
    fs::read(file)
}

/// Where the library may be: beside the command, where it is installed, and where cargo builds it.
fn places() -> Vec<PathBuf> {
    let own = std::env::current_exe().and_then(fs::canonicalize).unwrap_or_default();
    let folder = own.parent().unwrap_or(Path::new(""));
    [folder.join(LIBRARY), folder.join("../lib").join(LIBRARY), folder.join("deps").join(LIBRARY)].into()
}

fn summary(package: &Package, out: &Path) -> String {
    let of = |is: fn(&Role) -> bool| package.variables().iter().filter(|variable| is(&variable.role)).count();
    let inputs: Vec<&str> = package
        .variables()
        .iter()
        .filter(|variable| variable.is_input())
        .map(|variable| variable.name.as_str())
        .collect();
    let parameters = of(|role| matches!(role, Role::Parameter { .. }));
    let outputs = of(|role| matches!(role, Role::Output { .. }));
    let named = if inputs.is_empty() { "none".to_owned() } else { inputs.join(", ") };
    let width = terminal::stdout_width().or(Some(80));
    let line = |lead: &str, words: &str| terminal::hanging(&format!("{lead:<10}"), words, width);
    [
        format!("wrote {}\n\n", out.display()),
        line("inputs", &named),
        line(
            "others",
            &format!("{}, {}", count(parameters, "parameter", "parameters"), count(outputs, "output", "outputs")),
        ),
        line("guid", package.guid()),
    ]
    .concat()
}
