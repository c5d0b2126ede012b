//! The command line: what each command takes, and how its results are shown.
//!
//! Exit codes: 0 when done, 1 when a check failed, 2 for bad input, with one line on stderr.

mod compare;
mod light;
mod render;
mod scene;

use std::io::Write as _;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Spectral rendering with a colour error bound, and the measures to judge it by.
#[derive(Debug, Parser)]
#[command(name = "spectral", version, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
    /// Print one JSON object instead of tables.
    #[arg(long, global = true)]
    json: bool,
    /// Threads to use; all cores by default. The result does not depend on it.
    #[arg(long, global = true, value_name = "N")]
    threads: Option<usize>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Render a scene; without one, the built-in Cornell box under D65.
    Render(render::Arguments),
    /// Compare two pictures: colour difference and relative brightness.
    Compare(compare::Arguments),
    /// Everything there is to say of a light: colour temperature, colour rendering, action spectra.
    Light(light::Arguments),
    /// List the built-in scenes, or write one out as files for other renderers.
    Scene(scene::Arguments),
}

/// Bad input, in one line.
#[derive(Debug)]
struct Failure(String);

impl<E: core::error::Error> From<E> for Failure {
    fn from(error: E) -> Self {
        Self(error.to_string())
    }
}

/// What a command answers: a text for people, and the same for programs.
struct Answer {
    text: String,
    json: serde_json::Value,
}

/// Runs the command that the program was called with.
pub(crate) fn run() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => {
            // Help and version are not errors; clap knows where each goes.
            let _ = error.print();
            return ExitCode::from(if error.use_stderr() { 2 } else { 0 });
        }
    };
    let json = arguments.json;
    match dispatch(arguments) {
        Ok(answer) => {
            let shown = if json { answer.json.to_string() } else { answer.text };
            let mut out = std::io::stdout().lock();
            match writeln!(out, "{}", shown.trim_end()).and_then(|()| out.flush()) {
                Ok(()) => ExitCode::SUCCESS,
                Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => ExitCode::SUCCESS,
                Err(error) => fail(&format!("standard output: {error}")),
            }
        }
        Err(Failure(line)) => fail(&line),
    }
}

fn fail(line: &str) -> ExitCode {
    let _ = writeln!(std::io::stderr(), "spectral: {line}");
    ExitCode::from(2)
}

fn dispatch(arguments: Arguments) -> Result<Answer, Failure> {
    if let Some(threads) = arguments.threads {
        if !(1..=1024).contains(&threads) {
            return Err(Failure(format!("--threads must be from 1 to 1024, not {threads}")));
        }
        rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    }
    match arguments.command {
        Command::Render(render) => render.run(),
        Command::Compare(compare) => compare.run(),
        Command::Light(light) => light.run(),
        Command::Scene(scene) => scene.run(),
    }
}
