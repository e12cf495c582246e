//! `hemicube completions`: scripts for shells.

use crate::args::{Cli, CompletionsVerb};
use crate::failure::Failure;
use crate::output::print;
use clap::CommandFactory as _;

/// Prints the script.
pub fn run(args: &CompletionsVerb) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "hemicube", &mut script);
    print(&String::from_utf8_lossy(&script))
}
