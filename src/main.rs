//! The `periplus` program: see the library's crate documentation.

use clap::Parser;
use periplus::cli::Cli;
use periplus::commands;
use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(match Cli::try_parse() {
        Ok(cli) => commands::dispatch(cli),
        Err(answer) => commands::answer(&answer),
    })
}
