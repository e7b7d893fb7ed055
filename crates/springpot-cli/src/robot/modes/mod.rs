//! `springpot modes`: natural frequencies and damping of small motions about rest, and how columns answer to sines.

mod asked;
mod response;
mod table;

use crate::arguments::ModesOptions;
use crate::{Ending, diagnostic, drawing, output, printed, terminal};
use asked::Asked;
use serde_json::Value;
use springpot::law::Catalog;
use springpot_report::Plot;

/// What is wrong, and what would be right.
type Problem = (String, String);

/// Why there is no answer.
enum Stopped {
    /// It was said already, or has no line of its own.
    Ended(Ending),
    /// The options or the scenario do not fit.
    Refused(Problem),
}

impl From<Problem> for Stopped {
    fn from(problem: Problem) -> Self {
        Self::Refused(problem)
    }
}

/// What is told: a page, rows, data and a figure of the same.
struct Told {
    page: String,
    csv: String,
    json: Value,
    plot: Plot,
}

pub(crate) fn modes(options: &ModesOptions, catalog: &Catalog) -> Ending {
    let told = Asked::read(options, catalog).and_then(|asked| match &options.frequency_response[..] {
        [input, column] => response::told(&asked, options, input, column),
        _ => table::told(&asked),
    });
    match told {
        Ok(told) => tell(options, &told),
        Err(Stopped::Ended(ending)) => ending,
        Err(Stopped::Refused((message, help))) => {
            diagnostic::error_with_help(message, help);
            Ending::Refused
        }
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
        ending if drawing::ENDINGS.contains(&ending) => drawing::write(out, &told.plot),
        _ => {
            let help = "write a name that ends in .csv, .json, .svg, .png or .pdf".to_owned();
            diagnostic::error_with_help(format!("--out {}: no kind of file", out.display()), help);
            Ending::Refused
        }
    }
}
