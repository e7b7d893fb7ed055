//! The `springpot` command.

use springpot::law::Catalog;
use std::process::ExitCode;

fn main() -> ExitCode {
    springpot_cli::main_from(&Catalog::standard(), std::env::args_os())
}
