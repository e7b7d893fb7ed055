//! `springpot derivative`.

mod sheet;
mod steps;
mod streamed;
mod whole;

use crate::arguments::DerivativeOptions;
use crate::{Ending, diagnostic, printed};
use sheet::{Layout, Sheet};
use springpot::fractional::{DerivativeError, Method};
use springpot::signal::csv::{CsvProblem, CsvRows};
use std::fs::File;
use std::io::{self, BufWriter, IsTerminal, Read, Write};
use std::path::{Path, PathBuf};

/// Most bytes of rows that are held at a time; what is larger is streamed.
const HELD: usize = 256 << 20;

/// Fewest rows.
const FEWEST: usize = 3;

/// Why there is no derivative of a file.
#[derive(Debug, thiserror::Error)]
enum Problem {
    /// What is wrong with the file.
    #[error(transparent)]
    Csv(#[from] CsvProblem),
    /// The column to differentiate is that of the times.
    #[error("`{0}` is the time; --time names another column")]
    TimeItself(String),
    /// A column asked for twice.
    #[error("--column {0} is given twice")]
    ColumnTwice(String),
    /// An order asked for twice.
    #[error("--order {0} is given twice")]
    OrderTwice(f64),
    /// Two points make a line, whatever x does between them.
    #[error("{0} rows of numbers; at least three are needed")]
    TooFewRows(usize),
    /// The order, or too few rows for it.
    #[error(transparent)]
    Derivative(#[from] DerivativeError),
    /// What a scheme asks of the row on this line.
    #[error("{problem}")]
    Row { line: u64, problem: DerivativeError },
    /// Too many rows for a scheme that wants all at once.
    #[error("{0} wants all rows at once, and there are more than {mib} MiB of them; --scheme exponential streams", mib = HELD >> 20)]
    Large(Method),
    /// Errors are estimated from all rows at once.
    #[error("errors are estimated from all rows at once, and --scheme exponential does not hold them")]
    NoEstimate,
    /// The output, not the input.
    #[error("the results cannot be written: {0}")]
    Output(#[from] io::Error),
}

impl Problem {
    fn line(&self) -> Option<u64> {
        match self {
            Self::Csv(problem) => problem.line(),
            Self::Row { line, .. } => Some(*line),
            _ => None,
        }
    }
}

pub(crate) fn derivative(options: &DerivativeOptions) -> Ending {
    let file = options.file.as_deref().filter(|file| *file != Path::new("-"));
    let name = file.map_or_else(|| "standard input".to_owned(), |file| file.display().to_string());
    if options.file.is_none() && io::stdin().is_terminal() {
        diagnostic::error_with_help("no file to read", "name a CSV file, or pipe one in".to_owned());
        return Ending::Refused;
    }
    let input: io::Result<Box<dyn Read>> = match file {
        Some(file) => File::open(file).map(|file| Box::new(file) as Box<dyn Read>),
        None => Ok(Box::new(io::stdin().lock())),
    };
    let ended = match input {
        Ok(input) => write(options, input),
        Err(source) => Err(CsvProblem::Unreadable { source }.into()),
    };
    match ended {
        Ok(()) => Ending::Done,
        Err(Problem::Output(error)) => printed(Err(error)),
        Err(problem) => {
            let place = problem.line().map_or_else(String::new, |line| format!(":{line}"));
            diagnostic::error(format!("{name}{place}: {problem}"));
            Ending::Refused
        }
    }
}

/// Writes to where the options say; a file is there whole or not at all.
fn write(options: &DerivativeOptions, input: Box<dyn Read>) -> Result<(), Problem> {
    let Some(out) = &options.out else {
        let mut output = BufWriter::new(io::stdout().lock());
        let ended = differentiate(options, input, &mut output);
        output.flush()?;
        return ended;
    };
    let part = PathBuf::from(format!("{}.part", out.display()));
    let written = File::create(&part).map_err(Problem::from).and_then(|file| {
        let mut output = BufWriter::new(file);
        differentiate(options, input, &mut output)?;
        output.flush()?;
        Ok(std::fs::rename(&part, out)?)
    });
    if written.is_err() {
        // Nothing but the part is lost with it.
        let _ = std::fs::remove_file(&part);
    }
    written
}

fn differentiate(options: &DerivativeOptions, input: impl Read, output: &mut dyn Write) -> Result<(), Problem> {
    let mut rows = CsvRows::new(input)?;
    let layout = Layout::new(options, &rows)?;
    layout.check_orders()?;
    if options.scheme == Method::Exponential {
        if options.error {
            return Err(Problem::NoEstimate);
        }
        return streamed::differentiate(&layout, Sheet::default(), &mut rows, output);
    }
    let mut sheet = Sheet::default();
    while let Some(row) = rows.next_row()? {
        sheet.push(&layout, &row)?;
        if sheet.size() > HELD {
            return match options.scheme {
                Method::Spline if !options.error => streamed::differentiate(&layout, sheet, &mut rows, output),
                scheme => Err(Problem::Large(scheme)),
            };
        }
    }
    whole::differentiate(&layout, &sheet, options.scheme, options.error, output)
}
