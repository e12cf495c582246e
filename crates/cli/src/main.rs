//! The `hemicube` program: solve, measure and draw scenes by radiosity.
#![forbid(unsafe_code)]

mod args;
mod backend;
mod csv;
mod failure;
mod history;
mod input;
mod interrupt;
mod links;
mod output;
mod picture;
#[cfg(feature = "gpu")]
mod picture_on_gpu;
mod progress;
mod report;
mod solving;
mod verb;

use args::{Cli, Verb};
use clap::Parser;
use failure::Failure;
use std::process::ExitCode;
use std::time::Instant;

fn main() -> ExitCode {
    let start = Instant::now();
    std::panic::set_hook(Box::new(|panic| {
        let line =
            format!("hemicube: this is a bug, please report it with the command line: {panic}");
        eprintln!("{}", failure::one_line(&line));
    }));
    let cli = Cli::parse();
    match run(&cli, start) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            if let Some(message) = failure.message() {
                eprintln!("hemicube: {}", failure::one_line(message));
            }
            ExitCode::from(failure.exit_code())
        }
    }
}

fn run(cli: &Cli, start: Instant) -> Result<(), Failure> {
    if let Some(threads) = cli.global.threads {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads.into())
            .build_global()
            .map_err(|e| Failure::Failed(format!("--threads {threads}: {e}")))?;
    }
    match &cli.verb {
        Verb::Solve(args) => verb::solve::run(args, cli.global, start),
        Verb::Measure(args) => verb::measure::run(args, cli.global, start),
        Verb::Render(args) => verb::render::run(args, cli.global, start),
        Verb::FormFactors(args) => verb::form_factors::run(args, cli.global, start),
        Verb::Compare(args) => verb::compare::run(args, cli.global, start),
        Verb::Environment(args) => verb::environment::run(args, cli.global, start),
        Verb::View(args) => verb::view::run(args),
        Verb::Gallery(args) => verb::gallery::run(args, cli.global),
        Verb::Adapters => verb::adapters::run(cli.global),
        Verb::Scenes => verb::scenes::run(cli.global),
        Verb::Info(args) => verb::info::run(args, cli.global),
        Verb::Completions(args) => verb::completions::run(args),
    }
}
