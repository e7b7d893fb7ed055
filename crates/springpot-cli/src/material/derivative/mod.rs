//! `springpot derivative`.

mod sheet;
mod steps;
mod streamed;
mod whole;

use crate::arguments::DerivativeOptions;
use crate::output::{self, Output};
use crate::plain::Plain;
use crate::{Ending, diagnostic, mistakes, printed};
use sheet::{Layout, Sheet};
use springpot::fractional::{DerivativeError, Method};
use springpot_scenario::csv::{CsvProblem, CsvRows};
use std::fs::File;
use std::io::{self, BufWriter, IsTerminal, Read, Write};
use std::path::Path;

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
    /// A column of the file has the name of one that is added.
    #[error("the file has a column `{0}` already, and it is not told what it is a derivative of")]
    ColumnThere(String),
    /// A choice of rows without a value.
    #[error("--where {0:?} has no `=`; write COLUMN=VALUE")]
    NoValue(String),
    /// Two points make a line, whatever x does between them.
    #[error("{given} rows of numbers; at least three are needed")]
    TooFewRows { line: u64, given: usize },
    /// The order, or too few rows for it.
    #[error(transparent)]
    Derivative(#[from] DerivativeError),
    /// What a scheme asks of the row on this line.
    #[error("{problem}")]
    Row { line: u64, problem: DerivativeError },
    /// What no number holds.
    #[error(
        "`{name}` is no finite number here: steps of time are too short, or values too large; write both in other units"
    )]
    NotFinite { line: u64, name: String },
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
    fn help(&self) -> Option<&'static str> {
        let restarts = matches!(self, Self::Csv(CsvProblem::TimeNotIncreasing { time, before, .. }) if time < before);
        if matches!(self, Self::ColumnThere(_)) {
            return Some("name that column otherwise, or take it out of the file");
        }
        restarts.then_some("where the rows of several cases follow one another, choose one: --where COLUMN=VALUE")
    }

    fn line(&self) -> Option<u64> {
        match self {
            Self::Csv(problem) => problem.line(),
            Self::Row { line, .. } | Self::NotFinite { line, .. } | Self::TooFewRows { line, .. } => Some(*line),
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
    if let Some((message, help)) = file.and_then(mistakes::table_is_scenario) {
        diagnostic::error_with_help(message, help);
        return Ending::Refused;
    }
    if let (Some(file), Some(out)) = (file, &options.out)
        && output::is_same_file(file, out)
    {
        let message = format!("--out {} is the file that is read, which would be lost", out.display());
        diagnostic::error_with_help(message, "name another file".to_owned());
        return Ending::Refused;
    }
    let ended = Input::open(file).map_err(|source| CsvProblem::Unreadable { source }.into());
    let ended = ended.and_then(|input| write(options, input));
    match ended {
        Ok(()) => Ending::Done,
        Err(Problem::Output(error)) => match &options.out {
            Some(out) => output::written(out, Err(error)),
            None => printed(Err(error)),
        },
        Err(problem) => {
            let place = problem.line().map_or_else(String::new, |line| format!(":{line}"));
            let message = format!("{name}{place}: {problem}");
            match problem.help() {
                Some(help) => diagnostic::error_with_help(message, help.to_owned()),
                None => diagnostic::error(message),
            }
            Ending::Refused
        }
    }
}

/// Where the rows come from.
struct Input<'a> {
    rows: Box<dyn Read>,
    /// The regular file, which can be read twice.
    file: Option<&'a Path>,
}

impl<'a> Input<'a> {
    /// A file, or the standard input.
    fn open(file: Option<&'a Path>) -> io::Result<Self> {
        let Some(file) = file else { return Ok(Self { rows: Box::new(io::stdin().lock()), file: None }) };
        let is_regular = std::fs::metadata(file)?.is_file();
        Ok(Self { rows: Box::new(File::open(file)?), file: is_regular.then_some(file) })
    }
}

/// Writes to where the options say; a file is there whole or not at all.
fn write(options: &DerivativeOptions, input: Input<'_>) -> Result<(), Problem> {
    let Some(out) = &options.out else {
        let stdout = io::stdout().lock();
        let mut output: Box<dyn Write> = match stdout.is_terminal() {
            true => Box::new(Plain(BufWriter::new(stdout))),
            false => Box::new(BufWriter::new(stdout)),
        };
        let ended = differentiate(options, input, &mut output, true);
        output.flush()?;
        return ended;
    };
    let mut output = Output::open(out)?;
    let is_stream = output.is_stream();
    differentiate(options, input, &mut output, is_stream)?;
    Ok(output.finish()?)
}

/// Writes the derivatives; where the output `is_stream`, what is written cannot be taken back.
fn differentiate(
    options: &DerivativeOptions,
    Input { rows, file }: Input<'_>,
    output: &mut dyn Write,
    is_stream: bool,
) -> Result<(), Problem> {
    let mut rows = CsvRows::new(rows)?;
    let layout = Layout::new(options, &rows)?;
    layout.check_orders()?;
    // What is wrong with a file is found before its first row is written.
    let rehearse = || match file.filter(|_| is_stream) {
        Some(file) => {
            let again = File::open(file).map_err(|source| CsvProblem::Unreadable { source })?;
            streamed::differentiate(&layout, Sheet::default(), &mut CsvRows::new(again)?, &mut io::sink())
        }
        None => Ok(()),
    };
    if options.scheme == Method::Exponential {
        if options.error {
            return Err(Problem::NoEstimate);
        }
        rehearse()?;
        return streamed::differentiate(&layout, Sheet::default(), &mut rows, output);
    }
    let mut sheet = Sheet::default();
    while let Some(row) = rows.next_row()? {
        if !layout.takes(&row) {
            continue;
        }
        sheet.push(&layout, &row)?;
        if sheet.size() > HELD {
            return match options.scheme {
                Method::Spline if !options.error => {
                    rehearse()?;
                    streamed::differentiate(&layout, sheet, &mut rows, output)
                }
                scheme => Err(Problem::Large(scheme)),
            };
        }
    }
    whole::differentiate(&layout, &sheet, (options.scheme, options.error), rows.line(), output)
}
