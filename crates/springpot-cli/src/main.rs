//! The `springpot` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    springpot_cli::main_from(std::env::args_os())
}
