//! The command line: what each command takes, and how its results are shown.
//!
//! Exit codes: 0 when done, 1 when a check failed, 2 for bad input, with one line on stderr.

mod brdf;
mod compare;
mod gallery;
mod gather;
mod illuminance;
mod light;
mod map;
mod photons;
mod relight;
mod render;
mod scene;
mod spectral_exr;
mod trade;
mod verify;

use std::io::Write as _;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use renderers::scene::Scene;

/// Spectral rendering with a colour error bound, and the measures to judge it by.
#[derive(Debug, Parser)]
#[command(name = "spectral", version, arg_required_else_help = false)]
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
    /// Put a high-dynamic-range picture under another light.
    Relight(relight::Arguments),
    /// Render every built-in scene in several ways, with comparisons, into one page.
    Gallery(gallery::Arguments),
    /// Everything there is to say of a light: colour temperature, colour rendering, action spectra.
    Light(light::Arguments),
    /// Models of glossy reflection: fitted to measured data, and what they reflect.
    Brdf(brdf::Arguments),
    /// Illuminance at points of a scene.
    Illuminance(illuminance::Arguments),
    /// Lighting measures in every pixel of a scene: illuminance, colour temperature, colour rendering, action factors.
    Map(map::Arguments),
    /// List the built-in scenes, or write one out as files for other renderers.
    Scene(scene::Arguments),
    /// Analytic test cases for illuminance: judge this project, or write them for other programs and judge those.
    Verify(verify::Arguments),
    /// What accuracy costs: speed-error curves of all methods, and how far their input may go.
    Trade(trade::Arguments),
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
        Err(error) if error.use_stderr() => return fail(&one_line(&error.render().to_string())),
        Err(help) => return show(&help.render().to_string()),
    };
    let json = arguments.json;
    match dispatch(arguments) {
        Ok((answer, code)) => {
            let shown = show(&if json { answer.json.to_string() } else { answer.text });
            if shown == ExitCode::SUCCESS { code } else { shown }
        }
        Err(Failure(line)) => fail(&line),
    }
}

/// Runs a command of this program, by its name and what it takes.
fn run_line<'a>(words: impl Iterator<Item = &'a str>) -> Result<Answer, Failure> {
    let arguments = Arguments::try_parse_from(core::iter::once("spectral").chain(words));
    let arguments = arguments.map_err(|error| Failure(one_line(&error.render().to_string())))?;
    dispatch(arguments).map(|(answer, _)| answer)
}

/// Prints a result. Whoever reads only its beginning has got what was wanted.
fn show(text: &str) -> ExitCode {
    let mut out = std::io::stdout().lock();
    match writeln!(out, "{}", text.trim_end()).and_then(|()| out.flush()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => ExitCode::SUCCESS,
        Err(error) => fail(&format!("standard output: {error}")),
    }
}

fn fail(message: &str) -> ExitCode {
    let _ = writeln!(std::io::stderr(), "spectral: {}", single_line(message));
    ExitCode::from(2)
}

/// What a scene's author should know, each a line on stderr; the same for JSON.
fn warn(scene: &Scene) -> Vec<String> {
    let warnings: Vec<_> = scene.warnings().iter().map(ToString::to_string).collect();
    for warning in &warnings {
        let _ = writeln!(std::io::stderr(), "warning: {}", single_line(warning));
    }
    warnings
}

/// File names and options may hold line breaks.
fn single_line(message: &str) -> String {
    message.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

/// What clap says of wrong arguments and how to mend them, without the usage that `--help` shows.
fn one_line(error: &str) -> String {
    let said = error.split("\n\nUsage:").next().unwrap_or_default();
    let said = said.split("\n\nFor more information").next().unwrap_or_default();
    let paragraphs = said.trim_start_matches("error: ").split("\n\n");
    let words = |paragraph: &str| paragraph.split_whitespace().collect::<Vec<_>>().join(" ");
    paragraphs.map(words).filter(|p| !p.is_empty()).collect::<Vec<_>>().join("; ")
}

/// The answer, and how the program is to exit: a check may have failed.
fn dispatch(arguments: Arguments) -> Result<(Answer, ExitCode), Failure> {
    if let Some(threads) = arguments.threads {
        if !(1..=1024).contains(&threads) {
            return Err(Failure(format!("--threads must be from 1 to 1024, not {threads}")));
        }
        rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    }
    let answer = match arguments.command {
        Command::Verify(verify) => return verify.run(),
        Command::Trade(trade) => return trade.run(),
        Command::Gallery(gallery) => return gallery.run(),
        Command::Render(render) => render.run(),
        Command::Compare(compare) => compare.run(),
        Command::Relight(relight) => relight.run(),
        Command::Light(light) => light.run(),
        Command::Brdf(brdf) => brdf.run(),
        Command::Illuminance(illuminance) => illuminance.run(),
        Command::Map(map) => map.run(),
        Command::Scene(scene) => scene.run(),
    }?;
    Ok((answer, ExitCode::SUCCESS))
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::{Arguments, one_line};

    #[test]
    fn what_clap_says_fits_a_line() {
        let said = |arguments: &[&str]| {
            let all = core::iter::once("spectral").chain(arguments.iter().copied());
            one_line(&Arguments::try_parse_from(all).unwrap_err().render().to_string())
        };
        for (arguments, expected) in [
            (
                &[][..],
                "'spectral' requires a subcommand but one was not provided [subcommands: render, compare, relight, gallery, light, brdf, illuminance, map, scene, verify, trade, help]",
            ),
            (
                &["render", "--sise", "4x4"],
                "unexpected argument '--sise' found; tip: a similar argument exists: '--size'",
            ),
            (
                &["render", "--bound", "x"],
                "invalid value 'x' for '--bound <BOUND>' [possible values: paper, corrected, certified]",
            ),
            (&["compare"], "the following required arguments were not provided: <FIRST> <SECOND>"),
            (
                &["render", "--spp", "two\nUsage: 3"],
                "invalid value 'two Usage: 3' for '--spp <N>': invalid digit found in string",
            ),
        ] {
            assert_eq!(said(arguments), expected);
        }
    }
}
