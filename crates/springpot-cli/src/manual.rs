//! `springpot completions` and `springpot man`: what a shell and `man` know about the command.

use crate::arguments::{Arguments, CompletionsOptions, ManOptions};
use crate::{Ending, diagnostic, printed, terminal};
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
    clap_mangen::generate_to(Arguments::command(), folder)
}

fn page(command: clap::Command) -> io::Result<String> {
    let mut page = Vec::new();
    Man::new(command).render(&mut page)?;
    Ok(String::from_utf8_lossy(&page).into_owned())
}
