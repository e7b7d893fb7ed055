//! `springpot init`: a commented scenario to start from.

mod robot;

use crate::arguments::InitOptions;
use crate::{Ending, diagnostic, output, printed, terminal};
use springpot::law::Catalog;
use std::io;
use std::path::{Path, PathBuf};

/// The starter without a robot: every line of it is admissible, and the file runs as it is.
const STARTER: &str = include_str!("starter.toml");

pub(crate) fn init(options: &InitOptions, catalog: &Catalog) -> Ending {
    let out = options.out.clone().unwrap_or_else(|| default_file(options.robot.as_deref()));
    let others = ["urdf", "xacro", "xml", "json", "csv", "py"];
    if let Some(ending) = out.extension().filter(|ending| others.iter().any(|other| ending.eq_ignore_ascii_case(other)))
    {
        let message = format!("--out {}: init writes a scenario (TOML), no .{}", out.display(), ending.display());
        let help = format!("write --out {}", out.with_extension("toml").display());
        diagnostic::error_with_help(message, help);
        return Ending::Refused;
    }
    // Before anything is read: a file that is there is its author's.
    if output::is_taken(&out) {
        return is_there(&out);
    }
    let text = match &options.robot {
        None => STARTER.to_owned(),
        Some(robot) => match robot::scenario(robot, &out, options, catalog) {
            Ok(text) => text,
            Err(ending) => return ending,
        },
    };
    match output::create(&out, text.as_bytes()) {
        Ok(true) => printed(terminal::try_print(&next_steps(&out))),
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => is_there(&out),
        // What reads a pipe or a device has the scenario, and nothing that could be checked and run.
        streamed => output::written(&out, streamed.map(drop)),
    }
}

fn is_there(out: &Path) -> Ending {
    let help = "choose another name with --out; nothing is overwritten".to_owned();
    diagnostic::error_with_help(format!("{} is there already", out.display()), help);
    Ending::Refused
}

/// `scenario.toml`, or the name of the robot's file with the ending `.toml`, in the current folder.
fn default_file(robot: Option<&Path>) -> PathBuf {
    let mut name = robot.and_then(Path::file_stem).unwrap_or("scenario".as_ref()).to_owned();
    name.push(".toml");
    name.into()
}

fn next_steps(out: &Path) -> String {
    let file = out.display();
    format!(
        "wrote {file}\n\n\
         springpot check {file}   what it says: robot, elements, rows, figures\n\
         springpot run {file}     rows, statistics and figures into results/{}/\n",
        out.file_stem().unwrap_or_default().to_string_lossy()
    )
}
