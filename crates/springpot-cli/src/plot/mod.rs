//! `springpot plot`: columns of a finished run as a figure.

mod curves;
mod look;
mod summary;
mod table;

pub(crate) use self::look::LookOptions;

use self::curves::Wanted;
use self::table::Table;
use crate::arguments::PlotOptions;
use crate::{Ending, diagnostic, output, printed, terminal};
use springpot_report::{Plot, Rendered};
use springpot_run::figures::bytes;
use springpot_scenario::FigureFormat;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Why nothing is drawn.
struct Refused {
    message: String,
    help: Option<String>,
}

impl Refused {
    fn new(message: impl Into<String>, help: impl Into<Option<String>>) -> Self {
        Self { message: message.into(), help: help.into() }
    }

    /// The same of the abscissa of a table.
    fn of_abscissa(self, table: &Table) -> Self {
        let measured = "the abscissa of measured points is called as that of the run; `data` of a [[figure]] takes columns of other names";
        if table.is_measured { Self { help: Some(measured.to_owned()), ..self } } else { self }
    }

    fn show(self) {
        match self.help {
            Some(help) => diagnostic::error_with_help(self.message, help),
            None => diagnostic::error(self.message),
        }
    }
}

pub(crate) fn plot(options: &PlotOptions) -> Ending {
    let figure = match figure(options) {
        Ok(figure) => figure,
        Err(refused) => {
            refused.show();
            return Ending::Refused;
        }
    };
    let rendered = match figure.plot.render() {
        Ok(rendered) => rendered,
        Err(error) => {
            diagnostic::error(format!("the figure is not drawn: {error}"));
            return Ending::Failed;
        }
    };
    rendered.remarks.iter().for_each(|remark| diagnostic::warning(format!("figure: {remark}"), None));
    let mut lines = String::new();
    for (file, format) in &figure.files {
        match output::written(file, write(file, bytes(&rendered, *format))) {
            Ending::Done => {}
            ending => return ending,
        }
        lines.push_str(&format!("{}\n", file.display()));
    }
    printed(terminal::try_print(&lines))
}

/// The figure for a program that is no command; else what is wrong, with what would be right.
pub(crate) fn rendered(options: &PlotOptions) -> Result<Rendered, String> {
    let refused = |Refused { message, help }| help.map_or(message.clone(), |help| format!("{message} ({help})"));
    figure(options).map_err(refused)?.plot.render().map_err(|error| format!("the figure is not drawn: {error}"))
}

fn write(file: &Path, bytes: &[u8]) -> io::Result<()> {
    if let Some(folder) = file.parent() {
        fs::create_dir_all(folder)?;
    }
    output::write(file, bytes)
}

struct Figure {
    plot: Plot,
    files: Vec<(PathBuf, FigureFormat)>,
}

fn figure(options: &PlotOptions) -> Result<Figure, Refused> {
    let out = options.out.as_ref().map(|out| Ok((out.clone(), format(out)?))).transpose()?;
    let mut formats: Vec<FigureFormat> = Vec::with_capacity(options.formats.len());
    for word in &options.formats {
        let format = format_named(word)?;
        if !formats.contains(&format) {
            formats.push(format);
        }
    }
    let (folders, columns) = results_and_columns(options)?;
    let tables =
        folders.iter().enumerate().map(|(at, folder)| Table::open(folder, at > 0)).collect::<Result<Vec<_>, _>>()?;
    let plot = match summary::asked(&columns)? {
        Some(asked) => summary::plot(&tables, options, &asked)?,
        None => curves::plot(&tables, &Wanted::new(&tables, options, &columns)?, options.title.as_deref())?,
    };
    let files = match out {
        Some(out) => vec![out],
        None => {
            let name = name(&tables, options, &columns);
            let folder = tables[0].folder.join("figures");
            let formats = if formats.is_empty() { FigureFormat::DEFAULT.to_vec() } else { formats };
            formats.into_iter().map(|format| (folder.join(format!("{name}.{}", format.name())), format)).collect()
        }
    };
    Ok(Figure { plot, files })
}

/// Of the words on the command line: the first and those after it that are there as folders or CSV files are results, the others columns.
fn results_and_columns(options: &PlotOptions) -> Result<(Vec<PathBuf>, Vec<String>), Refused> {
    let is_results = |word: &&String| {
        let path = Path::new(word.as_str());
        path.is_dir() || (has_ending(path, "csv") && path.is_file())
    };
    let further = options.y.iter().take_while(is_results).count();
    let (folders, columns) = options.y.split_at(further);
    if columns.is_empty() {
        let message = "no column is named";
        return Err(Refused::new(message, "name a column behind the results, such as strut.force".to_owned()));
    }
    let folders = std::iter::once(options.results.clone()).chain(folders.iter().map(PathBuf::from));
    Ok((folders.collect(), columns.to_vec()))
}

/// The format of that name.
fn format_named(word: &str) -> Result<FigureFormat, Refused> {
    let found = FigureFormat::ALL.into_iter().find(|format| word.trim().eq_ignore_ascii_case(format.name()));
    found.ok_or_else(|| {
        let message = format!("--formats {word}: there is no such format of figures");
        Refused::new(message, "write some of svg, png and pdf: --formats svg,pdf".to_owned())
    })
}

/// The format that the name of a file says.
fn format(out: &Path) -> Result<FigureFormat, Refused> {
    FigureFormat::ALL.into_iter().find(|format| has_ending(out, format.name())).ok_or_else(|| {
        Refused::new(
            format!("--out {} is none of .svg, .png and .pdf", out.display()),
            "write a name that ends in .svg, .png or .pdf".to_owned(),
        )
    })
}

fn has_ending(file: &Path, wanted: &str) -> bool {
    file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case(wanted))
}

/// Characters of the name of a file.
const LONGEST_NAME: usize = 80;

fn plain(c: char) -> char {
    if c.is_ascii_alphanumeric() || "_-.".contains(c) { c } else { '_' }
}

/// A text as the name of a file: `max(strut.force)` is max-strut.force.
fn file_name(text: &str) -> String {
    text.replace('(', "-").replace(')', "").chars().map(plain).collect()
}

/// What is drawn, as the name of a file; other than those of the figures that the run drew.
fn name(tables: &[Table], options: &PlotOptions, columns: &[String]) -> String {
    let last = |path: &str| path.trim().trim_end_matches('"').rsplit('.').next().unwrap_or(path).to_owned();
    // Of a swept parameter its last name says enough.
    let is_swept = tables[0].sweeps.iter().any(|sweep| sweep.parameters.contains(&options.x));
    let x = if is_swept { last(&options.x) } else { options.x.clone() };
    let over = (options.x != "t").then(|| format!("over-{x}"));
    let chosen = options.selection.iter().map(|assignment| {
        let (path, value) =
            assignment.split_at(springpot_scenario::equals_sign(assignment).unwrap_or(assignment.len()));
        format!("{}_{}", last(path), value.trim_start_matches('=').trim())
    });
    let others = tables.iter().skip(1).map(|table| format!("with-{}", table.name()));
    let words: Vec<String> = columns.iter().cloned().chain(over).chain(chosen).chain(others).collect();
    let full = words.join("-");
    let mut name: String = file_name(&full).chars().take(LONGEST_NAME).collect();
    // What is cut off or replaced may be all that tells two figures apart.
    let is_plain = |c: char| plain(c) == c || "*?, ()".contains(c);
    if full.chars().count() > LONGEST_NAME || !full.chars().all(is_plain) {
        name.push_str(&format!("-{:08x}", crc32fast::hash(full.as_bytes())));
    }
    if name.starts_with('.') {
        name.insert(0, '_');
    }
    if tables[0].drawn.contains(&format!("figures/{name}.svg")) {
        name.push_str("-plot");
    }
    name
}
