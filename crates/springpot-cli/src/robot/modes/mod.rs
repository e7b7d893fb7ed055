//! `springpot modes`: natural frequencies and damping of small motions about rest, and how columns answer to sines.

pub(super) mod asked;
mod locus;
mod margins;
mod response;
mod table;

use crate::arguments::ModesOptions;
use crate::{Ending, diagnostic, drawing, output, printed, terminal};
use asked::Asked;
use serde_json::Value;
use springpot::law::Catalog;
use springpot_report::Plot;
use springpot_run::linear;
use springpot_scenario::Refusals;

/// What is wrong, and what would be right.
pub(super) type Problem = (String, String);

/// Why there is no answer.
pub(super) enum Stopped {
    /// It was said already, or has no line of its own.
    Ended(Ending),
    /// The options or the scenario do not fit.
    Refused(Problem),
}

impl Stopped {
    /// Refusals that are told here.
    pub(super) fn told(refusals: Refusals) -> Self {
        diagnostic::refused(&refusals);
        Self::Ended(Ending::Refused)
    }

    /// Says it, if that is still to be done.
    pub(super) fn end(self) -> Ending {
        match self {
            Self::Ended(ending) => ending,
            Self::Refused((message, help)) => {
                diagnostic::error_with_help(message, help);
                Ending::Refused
            }
        }
    }
}

impl From<Problem> for Stopped {
    fn from(problem: Problem) -> Self {
        Self::Refused(problem)
    }
}

impl From<linear::Stopped> for Stopped {
    fn from(stopped: linear::Stopped) -> Self {
        match stopped {
            linear::Stopped::Refused(message, help) => Self::Refused((message, help)),
            linear::Stopped::Failed(message) => {
                diagnostic::error(message);
                Self::Ended(Ending::Failed)
            }
        }
    }
}

/// What is told: a page, rows, data and a figure of the same.
struct Told {
    page: String,
    csv: String,
    json: Value,
    plot: Plot,
    /// Another figure, and what its name has behind that of the first.
    beside: Option<(&'static str, Plot)>,
}

pub(crate) fn modes(options: &ModesOptions, catalog: &Catalog) -> Ending {
    let told = if options.sweeps.is_empty() {
        Asked::read(options, catalog).and_then(|asked| match (&options.frequency_response[..], &options.margins) {
            ([input, column], _) => response::told(&asked, options, input, column),
            (_, Some(joint)) => margins::told(&asked, options, joint),
            _ => table::told(&asked),
        })
    } else {
        locus::told(options, catalog)
    };
    match told {
        Ok(told) => tell(options, &told),
        Err(stopped) => stopped.end(),
    }
}

/// Prints it, or writes it as the ending of the file says.
fn tell(options: &ModesOptions, told: &Told) -> Ending {
    let json = || format!("{:#}\n", told.json);
    let Some(out) = &options.out else {
        let text = if options.json { json() } else { told.page.clone() };
        return printed(terminal::try_print(&text));
    };
    let write = |text: &str| output::written(out, output::write(out, text.as_bytes()));
    match &*drawing::ending(out) {
        "csv" => write(&told.csv),
        "json" => write(&json()),
        ending if drawing::ENDINGS.contains(&ending) => match (drawing::write(out, &told.plot), &told.beside) {
            (Ending::Done, Some((word, plot))) => {
                let stem = out.file_stem().unwrap_or_default().to_string_lossy();
                drawing::write(&out.with_file_name(format!("{stem}-{word}.{ending}")), plot)
            }
            (ending, _) => ending,
        },
        _ => {
            let help = "write a name that ends in .csv, .json, .svg, .png or .pdf".to_owned();
            diagnostic::error_with_help(format!("--out {}: no kind of file", out.display()), help);
            Ending::Refused
        }
    }
}
