//! `springpot laws`: the catalog, one law's page, and laws from data sheets.

mod page;
mod sheet;

use crate::arguments::LawsOptions;
use crate::{Ending, diagnostic, printed, terminal};
use springpot::law::{Catalog, Entry};
use springpot_scenario::suggest;

pub(crate) fn laws(options: &LawsOptions, catalog: &Catalog) -> Ending {
    let law: Option<&Entry> = match &options.name {
        None => None,
        Some(name) => match catalog.get(name) {
            Some(law) => Some(law),
            None => return unknown(catalog, name),
        },
    };
    let text = match (&options.from, law) {
        (Some(data), law) => match sheet::text(catalog, data, law, options.json) {
            Ok(text) => text,
            Err(refused) => {
                refused.show(data);
                return Ending::Refused;
            }
        },
        (None, Some(law)) if options.json => pretty(&page::json(law)),
        (None, Some(law)) => page::text(law),
        (None, None) if options.json => pretty(&catalog.entries().iter().map(|law| page::json(law)).collect()),
        (None, None) => table(catalog),
    };
    printed(terminal::try_print(&text))
}

fn unknown(catalog: &Catalog, name: &str) -> Ending {
    let help = suggest(name, catalog.entries().iter().map(|law| &*law.name));
    diagnostic::error_with_help(format!("there is no law {name:?}"), help);
    Ending::Refused
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
               NAME. For parameters from a data sheet: springpot laws --from DATA.";
    text.push_str(&terminal::hanging("", how, width));
    text
}
