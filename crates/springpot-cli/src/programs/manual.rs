//! `springpot completions` and `springpot man`: what a shell and `man` know about the command.

use crate::arguments::{Arguments, CompletionsOptions, ManOptions};
use crate::{Ending, diagnostic, output, printed, terminal};
use clap::CommandFactory;
use clap_mangen::Man;
use std::fs;
use std::io;
use std::path::Path;

pub(crate) fn completions(options: &CompletionsOptions) -> Ending {
    let mut script = Vec::new();
    clap_complete::generate(options.shell, &mut Arguments::command(), "springpot", &mut script);
    printed(terminal::try_print(&String::from_utf8_lossy(&script)))
}

pub(crate) fn man(options: &ManOptions) -> Ending {
    let Some(folder) = &options.out else {
        return printed(page(Arguments::command()).and_then(|page| terminal::try_print(&page)));
    };
    match write_all(folder) {
        Ok(()) => Ending::Done,
        Err(error) => {
            diagnostic::error(format!("the pages cannot be written to {}: {error}", folder.display()));
            Ending::Failed
        }
    }
}

/// Writes springpot.1 and springpot-COMMAND.1 for every command.
fn write_all(folder: &Path) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    let mut program = Arguments::command();
    // Commands learn their full names.
    program.build();
    let commands = program.get_subcommands().filter(|command| command.get_name() != "help");
    for command in commands.cloned() {
        let file = Man::new(command.clone()).get_filename();
        output::write(&folder.join(file), page(command)?.as_bytes())?;
    }
    output::write(&folder.join("springpot.1"), page(Arguments::command())?.as_bytes())
}

fn page(command: clap::Command) -> io::Result<String> {
    let mut page = Vec::new();
    // There is no page of `help`, so that none is named.
    Man::new(command.disable_help_subcommand(true)).render(&mut page)?;
    Ok(with_examples(&String::from_utf8_lossy(&page)))
}

/// The page with its examples, which stand first in what follows the options, as lines of their own under a heading.
fn with_examples(page: &str) -> String {
    let Some((before, rest)) = page.split_once(".SH EXTRA\n") else { return page.to_owned() };
    let (examples, notes) = rest.split_once("\n\n").unwrap_or((rest.trim_end(), ""));
    let lines: String = examples.lines().skip(1).map(|line| format!("{}\n", line.trim_start())).collect();
    let notes = if notes.is_empty() { String::new() } else { format!(".SH NOTES\n{notes}") };
    format!("{before}.SH EXAMPLES\n.nf\n{lines}.fi\n{notes}")
}
