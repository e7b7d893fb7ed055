//! Commands and options that do not exist: what was meant, or else what there is.

use crate::arguments::Arguments;
use crate::diagnostic;
use clap::CommandFactory as _;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use springpot::names::nearest;
use springpot_scenario::{list, suggest};
use std::ffi::OsString;
use std::path::Path;

/// Prints what is wrong with the arguments; `false` where clap says it well enough.
pub(crate) fn told(error: &clap::Error, arguments: &[OsString]) -> bool {
    let said = |kind| match error.get(kind) {
        Some(ContextValue::String(said)) => Some(said.clone()),
        _ => None,
    };
    match error.kind() {
        ErrorKind::InvalidSubcommand => said(ContextKind::InvalidSubcommand).is_some_and(|name| command(&name)),
        ErrorKind::UnknownArgument => said(ContextKind::InvalidArg).is_some_and(|name| option(&name, arguments)),
        ErrorKind::MissingRequiredArgument => missing(error, arguments),
        ErrorKind::ArgumentConflict => conflict(error, arguments),
        ErrorKind::InvalidValue | ErrorKind::ValueValidation => {
            let (value, argument) = (said(ContextKind::InvalidValue), said(ContextKind::InvalidArg));
            value.zip(argument).is_some_and(|(value, argument)| wrong(error, &value, &argument))
        }
        _ => false,
    }
}

/// A value that its option does not take.
fn wrong(error: &clap::Error, value: &str, argument: &str) -> bool {
    let option = argument.split_whitespace().next().unwrap_or(argument);
    let known: Vec<String> = match error.get(ContextKind::ValidValue) {
        Some(ContextValue::Strings(known)) => known.clone(),
        _ => Vec::new(),
    };
    if value.is_empty() {
        diagnostic::error_with_help(format!("{option} has no value"), format!("write {argument}"));
        return true;
    }
    let help = match (option, known.is_empty()) {
        (_, false) => {
            let known = || known.iter().map(String::as_str);
            let meant = nearest(value, known()).map_or_else(String::new, |right| format!("did you mean {right}? "));
            format!("{meant}there is {}", list(known()))
        }
        ("--jobs", true) => "write how many cases run at a time: a whole number from 1 on".to_owned(),
        ("--shard", true) => "write which part of how many is run: --shard 3/16 is the third of 16".to_owned(),
        ("--port", true) => "write a number from 0 to 65535".to_owned(),
        ("--case", true) => "write a whole number: cases count from 0".to_owned(),
        (_, true) => match std::error::Error::source(error) {
            Some(why) if !why.to_string().starts_with("invalid") => format!("write {argument}: {why}"),
            Some(_) => format!("write {argument}, a number"),
            None => format!("write {argument}"),
        },
    };
    diagnostic::error_with_help(format!("{option} {value}: not a value that it takes"), help);
    true
}

/// What a command cannot do without.
fn missing(error: &clap::Error, arguments: &[OsString]) -> bool {
    let Some(ContextValue::Strings(lacking)) = error.get(ContextKind::InvalidArg) else { return false };
    let all = Arguments::command();
    let chosen = arguments.iter().filter_map(|argument| argument.to_str()).find_map(|text| all.find_subcommand(text));
    let Some(chosen) = chosen else { return false };
    let of = chosen.get_name();
    let lacking: Vec<&str> = lacking.iter().map(String::as_str).collect();
    let at = arguments.iter().position(|argument| argument == of).map_or(arguments.len(), |at| at + 1);
    let given = arguments[at..].iter().map(|argument| springpot_run::quoted(&argument.to_string_lossy()));
    let wanted = lacking.iter().map(|name| name.replace(['<', '>'], "").trim_end_matches("...").to_owned());
    let words = given.chain(wanted).collect::<Vec<_>>().join(" ");
    let help = format!("write springpot {of} {words}; `springpot {of} --help` shows examples");
    diagnostic::error_with_help(format!("`springpot {of}` lacks {}", list(lacking.iter().copied())), help);
    true
}

/// Arguments that exclude one another, and why.
const EXCLUDE: [(&str, &str, &str, &str); 8] = [
    ("plot", "--out", "--formats", "the ending of --out says the format: leave --formats out"),
    ("view", "--serve", "--out", "--serve shows the page and writes none: leave one of them out"),
    ("run", "SCENARIO", "--resume", "--resume goes on with the scenario that its folder holds: name the folder alone"),
    ("run", "--resume", "", "a run goes on as it began: leave it out, or begin anew with springpot run SCENARIO"),
    ("check", "--schema", "", "--schema describes all scenarios, and looks at none: leave one of them out"),
    (
        "prony",
        "--law",
        "",
        "--law takes the place of a springpot, whose numbers are its parameters: --parameter NAME=VALUE",
    ),
    ("dynamics", "--at", "", "--at is a time along a scenario's motion, --states are states of their own: choose one"),
    (
        "dynamics",
        "--states",
        "--case",
        "--case is one of a scenario, which --at goes along: leave it out beside --states",
    ),
];

/// Two arguments that do not stand together.
fn conflict(error: &clap::Error, arguments: &[OsString]) -> bool {
    let all = Arguments::command();
    let chosen = arguments.iter().filter_map(|argument| argument.to_str()).find_map(|text| all.find_subcommand(text));
    let Some(of) = chosen.map(clap::Command::get_name) else { return false };
    let (one, other) = match (error.get(ContextKind::InvalidArg), error.get(ContextKind::PriorArg)) {
        (Some(ContextValue::String(one)), Some(ContextValue::String(other))) => (one, other),
        (Some(ContextValue::String(one)), Some(ContextValue::Strings(others))) if !others.is_empty() => {
            (one, &others[0])
        }
        _ => return false,
    };
    let bare = |name: &str| name.split_whitespace().next().unwrap_or(name).replace(['<', '>', '[', ']'], "");
    let (one, other) = (bare(one), bare(other));
    if one == other {
        diagnostic::error_with_help(format!("{one} is given twice"), "write it once".to_owned());
        return true;
    }
    let names = |name: &str| name.is_empty() || name == one || name == other;
    let why = EXCLUDE.iter().find(|(command, first, second, _)| *command == of && names(first) && names(second));
    let help = why.map_or_else(
        || format!("leave one of them out; `springpot {of} --help` explains both"),
        |(.., why)| (*why).to_owned(),
    );
    diagnostic::error_with_help(format!("{one} cannot be used with {other}"), help);
    true
}

/// A scenario where a table of numbers belongs.
pub(crate) fn table_is_scenario(file: &Path) -> Option<(String, String)> {
    let is_toml = file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"));
    let (name, stem) = (file.display(), file.file_stem().unwrap_or_default().to_string_lossy());
    let help = || format!("run it first, `springpot run {name}`: its rows are then in results/{stem}/results.csv");
    (is_toml && file.is_file()).then(|| (format!("{name} is a scenario, not a table of numbers (CSV)"), help()))
}

/// `--set PATH=VALUE` for `--set PATH VALUE`.
fn joined(value: &str, arguments: &[OsString]) -> Option<String> {
    let texts: Vec<&str> = arguments.iter().map(|argument| argument.to_str().unwrap_or_default()).collect();
    let at = texts.windows(3).position(|three| matches!(three[0], "--set" | "--sweep") && three[2] == value)?;
    let [option, path] = [texts[at], texts[at + 1]];
    let value = value.trim_start_matches('=');
    (!path.contains('=') || path.ends_with('='))
        .then(|| format!("write {option} {}={value}", path.trim_end_matches('=')))
}

fn command(name: &str) -> bool {
    let (message, help) = match instead(name) {
        Some(help) => (format!("{name:?} is no command, but a file"), help),
        None => {
            let all = Arguments::command();
            let names: Vec<&str> = all.get_subcommands().map(clap::Command::get_name).collect();
            (format!("there is no command {name:?}"), suggest(name, names))
        }
    };
    diagnostic::error_with_help(message, help);
    true
}

/// What to type for a file, by its ending.
fn instead(name: &str) -> Option<String> {
    let file = Path::new(name);
    let is_like = |ending: &str| file.extension().is_some_and(|own| own.eq_ignore_ascii_case(ending));
    let with = |lines: [(&str, &str); 2]| {
        let [(first, does), (second, also)] = lines.map(|(command, does)| (format!("springpot {command}"), does));
        Some(format!("`{first}` {does}, `{second}` {also}"))
    };
    if is_like("toml") {
        return with([(&format!("run {name}"), "runs it"), (&format!("check {name}"), "looks at it first")]);
    }
    if is_like("urdf") {
        let (init, info) = (format!("init {name}"), format!("info {name}"));
        return with([(&init, "writes a scenario with this robot"), (&info, "describes it")]);
    }
    if is_like("csv") {
        let (plot, derivative) = ("plot FOLDER COLUMN", format!("derivative {name} --column NAME --order 0.5"));
        return with([(plot, "draws results"), (&derivative, "differentiates a column")]);
    }
    if file.join("run.json").is_file() {
        let (plot, resume) = (format!("plot {name} COLUMN"), format!("run --resume {name}"));
        return with([(&plot, "draws its results"), (&resume, "goes on with a run that was interrupted")]);
    }
    None
}

fn option(name: &str, arguments: &[OsString]) -> bool {
    let all = Arguments::command();
    let chosen = arguments.iter().filter_map(|argument| argument.to_str()).find_map(|text| all.find_subcommand(text));
    let Some(chosen) = chosen else { return false };
    let of = chosen.get_name();
    let Some(bare) = name.strip_prefix("--").or_else(|| name.strip_prefix('-')) else {
        let message = format!("`springpot {of}` takes no {name:?} after what stands before it");
        let help =
            joined(name, arguments).unwrap_or_else(|| format!("`springpot {of} --help` shows how it is written"));
        diagnostic::error_with_help(message, help);
        return true;
    };
    let has = |command: &clap::Command, long: &str| command.get_arguments().any(|own| own.get_long() == Some(long));
    let own: Vec<&str> = chosen.get_arguments().filter_map(clap::Arg::get_long).collect();
    let others: Vec<&str> =
        all.get_subcommands().filter(|command| has(command, bare)).map(clap::Command::get_name).collect();
    let help = match (nearest(bare, own.iter().copied()), others.as_slice()) {
        (Some(right), _) => format!("did you mean --{right}? "),
        (None, [_, ..]) if of == "export" && bare == "format" => {
            "the ending of the file says the format: .mcap, .glb or .gltf. ".to_owned()
        }
        (None, [_, ..]) => format!("it is one of `springpot {}`. ", others.join("`, `springpot ")),
        (None, []) => {
            let own: Vec<String> = own.iter().map(|long| format!("--{long}")).collect();
            format!("there is {}. ", list(own.iter().map(String::as_str)))
        }
    };
    let help = format!("{help}`springpot {of} --help` explains all");
    diagnostic::error_with_help(format!("`springpot {of}` has no option {name}"), help);
    true
}
