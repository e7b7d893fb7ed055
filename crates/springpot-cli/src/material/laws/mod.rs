//! `springpot laws`: the catalog, one law's page, and laws from data sheets and measurements.

mod columns;
mod figure;
mod latex;
mod measured;
mod names;
mod page;
mod sample;
mod sheet;
mod warm;

pub(crate) use measured::{Found, refused_by};
pub(crate) use warm::{Warm, read as read_warm};

use crate::arguments::LawsOptions;
use crate::{Ending, diagnostic, printed, terminal};
use sample::Sample;
use springpot::law::datasheet::Model;
use springpot::law::{Catalog, Entry};
use springpot_scenario::{Place, RefusalKind, Source, suggest};
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// Where a sample is given and nothing is measured in Pa.
const NO_MODULUS: &str = "area and length have no use: nothing is in Pa";
const MODULI: &str = "give a modulus its unit, such as E' = 2 MPa, or E' [MPa] as the name of a column";

/// Why data are refused, and where they stand.
pub(crate) struct Refused {
    message: String,
    help: Option<String>,
    at: Option<Range<usize>>,
}

impl Refused {
    pub(crate) fn new(message: impl Into<String>, help: impl Into<Option<String>>) -> Self {
        Self { message: message.into(), help: help.into(), at: None }
    }

    fn at(at: Range<usize>, message: String, help: impl Into<Option<String>>) -> Self {
        Self { message, help: help.into(), at: Some(at) }
    }

    /// Prints it on stderr, with the place in `data`.
    pub(crate) fn show(self, data: &str) {
        match (self.at, self.help) {
            (Some(span), help) => {
                let source = Source { name: "--from".to_owned(), text: data.into() };
                let refusal = Place { source: Arc::new(source), span }.refuse(RefusalKind::BadQuantity, self.message);
                diagnostic::refused(&refusal.help_if(help).into());
            }
            (None, Some(help)) => diagnostic::error_with_help(self.message, help),
            (None, None) => diagnostic::error(self.message),
        }
    }
}

pub(crate) fn laws(options: &LawsOptions, catalog: &Catalog) -> Ending {
    let law: Option<&Entry> = match &options.name {
        None => None,
        Some(name) => match catalog.get(name) {
            Some(law) => Some(law),
            None => return unknown(catalog, name),
        },
    };
    let text = match (&options.from, law) {
        (Some(data), law) => match found(catalog, data, law, options) {
            Ok((_, Some(ending))) => return ending,
            Ok((text, None)) => text,
            Err(refused) => {
                refused.show(data);
                return Ending::Refused;
            }
        },
        (None, Some(law)) if options.latex => latex::one(law),
        (None, None) if options.latex => latex::all(catalog),
        (None, Some(law)) if options.json => pretty(&page::json(law)),
        (None, Some(law)) => page::text(law),
        (None, None) if options.json => pretty(&catalog.entries().iter().map(|law| page::json(law)).collect()),
        (None, None) => table(catalog),
    };
    printed(terminal::try_print(&text))
}

/// What the data determine, and how the command ends where its figure cannot be written.
fn found(
    catalog: &Catalog,
    data: &str,
    law: Option<&Entry>,
    options: &LawsOptions,
) -> Result<(String, Option<Ending>), Refused> {
    let sample = Sample::new(&options.area, &options.length)?;
    let file = Path::new(data);
    if file.is_file() || file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("csv")) {
        return measured::text(catalog, file, law, sample, options);
    }
    if let Some(out) = &options.out {
        let message = format!("--out {}: only the measurement of a CSV file makes a figure", out.display());
        return Err(Refused::new(message, None));
    }
    Ok((sheet::text(catalog, data, law, sample, options.json)?, None))
}

fn unknown(catalog: &Catalog, name: &str) -> Ending {
    let help = suggest(name, catalog.entries().iter().map(|law| &*law.name));
    diagnostic::error_with_help(format!("there is no law {name:?}"), help);
    Ending::Refused
}

/// The laws that data can determine.
fn determined(catalog: &Catalog) -> String {
    let known = catalog.entries().iter().filter(|law| Model::of(law).is_some());
    known.map(|law| &*law.name).collect::<Vec<_>>().join(", ")
}

fn pretty(value: &serde_json::Value) -> String {
    format!("{value:#}\n")
}

/// Name, inputs and equation of every law, and how to go on.
fn table(catalog: &Catalog) -> String {
    let width = terminal::stdout_width().or(Some(80));
    let inputs = |law: &Entry| law.inputs.iter().map(|input| &*input.name).collect::<Vec<_>>().join(", ");
    let longest = |text: &dyn Fn(&Entry) -> usize, title: &str| {
        catalog.entries().iter().map(|law| text(law)).max().unwrap_or(0).max(title.len())
    };
    let (name, input) = (longest(&|law| law.name.len(), "law"), longest(&|law| inputs(law).len(), "inputs"));
    let lead = |law: &str, inputs: &str| format!("{law:<name$}  {inputs:<input$}  ");
    let mut text = format!("{}force\n", lead("law", "inputs"));
    for law in catalog.entries() {
        // A sign stays with what follows it.
        let equation = ["+ ", "− "].iter().fold(law.equation.to_string(), |equation, sign| {
            equation.replace(sign, &sign.replace(' ', terminal::NO_BREAK))
        });
        text.push_str(&terminal::hanging(&lead(&law.name, &inputs(law)), &equation, width));
    }
    text.push('\n');
    let how = "x is the stroke, length less rest length; F is positive in tension. For parameters, units and an example: springpot laws \
               NAME. For parameters from a data sheet or a measurement: springpot laws --from DATA.";
    text.push_str(&terminal::hanging("", how, width));
    text
}
