//! Refusals as they appear in the terminal: message, the offending line with a caret, and what would be right.

use crate::arguments::ScenarioOptions;
use miette::{Diagnostic, GraphicalReportHandler, GraphicalTheme, LabeledSpan, NamedSource, SourceCode};
use springpot::law::Catalog;
use springpot::scenario::{Cases, Refusal, Refusals, Scenario};
use std::fmt::{self, Display};
use std::io::IsTerminal;

/// Reads the scenario, applies the overrides and checks everything.
pub(crate) fn open(options: &ScenarioOptions) -> Result<Cases, Refusals> {
    let mut scenario = Scenario::read(&options.file)?;
    for assignment in &options.overrides {
        scenario.set(assignment)?;
    }
    scenario.cases(&Catalog::standard())
}

/// Prints refusals on stderr.
pub(crate) fn print(refusals: &Refusals) {
    let plain = std::env::var_os("NO_COLOR").is_some() || !std::io::stderr().is_terminal();
    let theme = if plain { GraphicalTheme::unicode_nocolor() } else { GraphicalTheme::unicode() };
    let handler = GraphicalReportHandler::new_themed(theme).with_links(false);
    for refusal in refusals.iter() {
        let shown = Shown::new(refusal);
        let mut text = String::new();
        match handler.render_report(&mut text, &shown) {
            Ok(()) => eprint!("{text}"),
            Err(fmt::Error) => eprintln!("error: {refusal}"),
        }
    }
}

/// A refusal as miette shows it.
#[derive(Debug)]
struct Shown<'a> {
    refusal: &'a Refusal,
    source: NamedSource<String>,
}

impl<'a> Shown<'a> {
    fn new(refusal: &'a Refusal) -> Self {
        Self { refusal, source: NamedSource::new(&refusal.file, refusal.text.to_string()) }
    }
}

impl Display for Shown<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Refusal { file, line, column, message, .. } = self.refusal;
        write!(f, "{file}:{line}:{column}: {message}")
    }
}

impl std::error::Error for Shown<'_> {}

impl Diagnostic for Shown<'_> {
    fn help<'b>(&'b self) -> Option<Box<dyn Display + 'b>> {
        self.refusal.help.as_ref().map(|help| Box::new(help) as Box<dyn Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        (!self.refusal.text.is_empty()).then_some(&self.source as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let span = self.refusal.span.clone();
        let label = LabeledSpan::new(Some(self.refusal.label.clone()), span.start, span.len());
        Some(Box::new(std::iter::once(label)))
    }
}
