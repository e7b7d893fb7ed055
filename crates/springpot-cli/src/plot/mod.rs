//! `springpot plot`: columns of a finished run as a figure.

mod curves;
mod table;

use self::curves::Wanted;
use self::table::Table;
use crate::arguments::PlotOptions;
use crate::{Ending, diagnostic, output, printed, terminal};
use springpot_report::{Plot, Rendered};
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
    let Rendered { svg, png, .. } = match figure.plot.render() {
        Ok(rendered) => rendered,
        Err(error) => {
            diagnostic::error(format!("the figure is not drawn: {error}"));
            return Ending::Failed;
        }
    };
    let files = figure.files.iter().map(|file| {
        let bytes = if is_png(file) { &png[..] } else { svg.as_bytes() };
        (file, bytes)
    });
    let mut lines = String::new();
    for (file, bytes) in files {
        match output::written(file, write(file, bytes)) {
            Ending::Done => {}
            ending => return ending,
        }
        lines.push_str(&format!("{}\n", file.display()));
    }
    printed(terminal::try_print(&lines))
}

fn write(file: &Path, bytes: &[u8]) -> io::Result<()> {
    if let Some(folder) = file.parent() {
        fs::create_dir_all(folder)?;
    }
    output::write(file, bytes)
}

struct Figure {
    plot: Plot,
    files: Vec<PathBuf>,
}

fn figure(options: &PlotOptions) -> Result<Figure, Refused> {
    if let Some(out) = &options.out
        && !is_png(out)
        && !has_ending(out, "svg")
    {
        return Err(Refused::new(
            format!("--out {} is neither .svg nor .png", out.display()),
            "write a name that ends in .svg or .png".to_owned(),
        ));
    }
    let table = Table::open(&options.results)?;
    let wanted = Wanted::new(&table, options)?;
    let plot = curves::plot(&table, &wanted, options.title.clone())?;
    let files = match &options.out {
        Some(out) => vec![out.clone()],
        None => {
            let name = name(&table, options);
            ["svg", "png"].map(|ending| table.folder.join("figures").join(format!("{name}.{ending}"))).to_vec()
        }
    };
    Ok(Figure { plot, files })
}

fn is_png(file: &Path) -> bool {
    has_ending(file, "png")
}

fn has_ending(file: &Path, wanted: &str) -> bool {
    file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case(wanted))
}

/// What is drawn, as the name of a file; other than those of the figures that the run drew.
fn name(table: &Table, options: &PlotOptions) -> String {
    let over = (options.x != "t").then(|| format!("over-{}", options.x));
    let words: Vec<&str> = options.y.iter().map(String::as_str).chain(over.as_deref()).collect();
    let plain = |c: char| if c.is_ascii_alphanumeric() || "_-.".contains(c) { c } else { '_' };
    let mut name: String = words.join("-").chars().map(plain).take(80).collect();
    if name.starts_with('.') {
        name.insert(0, '_');
    }
    if table.drawn.contains(&format!("figures/{name}.svg")) {
        name.push_str("-plot");
    }
    name
}
