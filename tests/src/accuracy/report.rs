//! The table as Markdown.

use super::Measured;
use super::gauge::{Choice, Unit};
use super::scan;

/// Where the table belongs, from the root of the workspace.
pub const PATH: &str = "tests/ACCURACY.md";

const HEAD: &str = "\
# Accuracy

The largest errors that were found of every public numeric function of `spectral-core` and `disk-sampling`, in `f32` and `f64`, against
arithmetic of 106 bits (10⁻³⁰) that shares no code with them. Arguments are taken as exact: an error here is the function's own.

Written by `cargo run --release -p spectral-tests --bin accuracy_table`, from the entries in
[`tests/src/accuracy/table.rs`](src/accuracy/table.rs); `cargo test --release -p spectral-tests --test accuracy` fails when this file is not
current, when an error is above its tolerance or a tolerance more than three times the error, and when a public function is missing.

Points are special values and lists (L), numbers within 12 units in the last place of domain limits, branch points and joints (E; 3 where a
function is costly), grids (S) and seeded random numbers (R); the letter says where the largest error was. *ULP*: units in the last place of the
exact result, at least those of the least normal number.
";

/// The whole file.
///
/// # Errors
/// The sources can't be read.
pub fn markdown(measured: &[Measured]) -> Result<String, String> {
    let functions = scan::public_functions()?;
    let mut text = HEAD.to_owned();
    for name in scan::CRATES {
        text += &format!(
            "\n## {name}\n\n| function | counted in | `f32` | `f64` | points | domain |\n|---|---|---|---|---|---|\n"
        );
        for row in measured.iter().filter(|row| functions.get(row.entry.name) == Some(&name)) {
            text += &line(row);
        }
    }
    Ok(text)
}

fn line(row: &Measured) -> String {
    let [single, double] = &row.found;
    let figure = |found: &super::Found| format!("{} {}", two_digits(found.worst), letter(found.choice));
    format!(
        "| `{}` | {} | {} | {} | {} | {} |\n",
        row.entry.name,
        escaped(&unit(row.entry.unit)),
        figure(single),
        figure(double),
        double.points,
        escaped(&domain(&single.domain, &double.domain)),
    )
}

fn escaped(text: &str) -> String {
    text.replace('|', "\\|").replace('*', "\\*")
}

/// Both, where they differ by the range of numbers.
fn domain(single: &str, double: &str) -> String {
    if single == double { double.into() } else { format!("f32: {single}; f64: {double}") }
}

fn unit(unit: Unit) -> String {
    match unit {
        Unit::Ulp => "ULP".into(),
        Unit::UlpOfLargest => "ULP of the largest component".into(),
        Unit::UlpOf(what) => format!("ULP of {what}"),
        Unit::Relative => "relative".into(),
        Unit::RelativeTo(what) => format!("relative to {what}"),
        Unit::Absolute(what) => what.into(),
        Unit::OfBound => "the stated bound".into(),
    }
}

const fn letter(choice: Choice) -> &'static str {
    match choice {
        Choice::List => "L",
        Choice::Edge => "E",
        Choice::Spaced => "S",
        Choice::Random => "R",
    }
}

/// A number with two significant digits.
#[must_use]
pub fn two_digits(x: f64) -> String {
    if x == 0.0 {
        return "0".into();
    }
    let scientific = format!("{x:.1e}");
    let exponent = scientific.split_once('e').and_then(|(_, e)| e.parse::<i32>().ok()).unwrap_or(0);
    match exponent {
        -2..=0 => format!("{x:.*}", usize::try_from(1 - exponent).unwrap_or(1)),
        1..=3 => {
            let unit = 10_f64.powi(exponent - 1);
            format!("{:.0}", (x / unit).round() * unit)
        }
        _ => scientific.replace('-', "−"),
    }
}
