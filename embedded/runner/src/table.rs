//! Sizes, stacks and instructions as Markdown.

use core::fmt::Write;
use std::fs;
use std::path::Path;

use crate::rows::Wanted;
use crate::target::{M0, M4F, Report, Target};

/// How far figures may be from those in the file: another release of the compiler, or other paths in symbols, may order and
/// inline a little differently.
const RELATIVE: f64 = 0.03;
const ABSOLUTE: f64 = 64.0;

/// The row that has a budget, and that in bytes of flash and stack.
const BUDGET: (&str, f64, f64) = ("light_measure_indices", 65_536.0, 4096.0);

/// Figures of a row on one target: bytes of flash, bytes of stack, instructions a call; the first and the last one without
/// the harness's own.
#[derive(Clone, Copy, Debug)]
struct Figures {
    flash: f64,
    stack: f64,
    /// None where no call is timed.
    instructions: Option<f64>,
}

/// The table.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    rows: Vec<(&'static str, [Option<Figures>; 2])>,
    static_ram: u64,
}

/// What a row costs above the empty one.
fn figures(report: Option<&Report>, empty: &Report, target: &Target) -> Option<Figures> {
    let (row, none) = (report?.rows.first()?, empty.rows.first()?);
    let a_call = |(instructions, calls): (f64, f64)| (calls > 0.0).then_some(instructions / calls);
    let instructions = a_call(row.instructions(target)).zip(a_call(none.instructions(target)));
    Some(Figures {
        flash: report?.flash as f64 - empty.flash as f64,
        stack: row.stack as f64,
        instructions: instructions.map(|(row, none)| (row - none).round().max(0.0)),
    })
}

impl Table {
    /// From the reports of the same rows on Cortex-M4F and Cortex-M0, of which the first row is the empty one.
    pub(crate) fn new(rows: &[Wanted], large: &[Option<Report>], small: &[Option<Report>]) -> Result<Self, String> {
        let (Some(Some(first)), Some(Some(second))) = (large.first(), small.first()) else {
            return Err("the empty row was not measured".into());
        };
        let all = rows.iter().zip(large.iter().zip(small)).skip(1);
        let rows = all.map(|(row, (large, small))| {
            let both = [figures(large.as_ref(), first, &M4F), figures(small.as_ref(), second, &M0)];
            (row.entry.name, both)
        });
        let static_ram = large.iter().chain(small).flatten().map(|report| report.static_ram).max().unwrap_or(0);
        Ok(Self { rows: rows.collect(), static_ram })
    }

    /// Colour temperature, R_a and CRI00 have to fit a small machine; nothing may take static RAM.
    pub(crate) fn check_budget(&self) -> Result<(), String> {
        let (name, flash, stack) = BUDGET;
        let row = self.rows.iter().find(|row| row.0 == name).ok_or("the row with a budget is missing")?;
        for (figures, target) in row.1.iter().zip([M4F, M0]) {
            let figures = figures.ok_or_else(|| format!("{name} does not run on {}", target.name))?;
            println!("{name} on {}: {} bytes of flash, {} of stack", target.name, figures.flash, figures.stack);
            if !(figures.flash <= flash && figures.stack <= stack) {
                return Err(format!("{name} on {} is over its budget: {figures:?}", target.name));
            }
        }
        if self.static_ram > 0 {
            return Err(format!("{} bytes of static RAM, where there should be none", self.static_ram));
        }
        Ok(())
    }

    fn markdown(&self) -> String {
        let mut text = String::from(HEAD);
        for (name, figures) in &self.rows {
            let _ = write!(text, "| `{name}` |");
            for figures in figures {
                let _ = match figures {
                    Some(Figures { flash, stack, instructions: Some(instructions) }) => {
                        write!(text, " {flash} | {stack} | {instructions} |")
                    }
                    Some(Figures { flash, stack, instructions: None }) => write!(text, " {flash} | {stack} | – |"),
                    None => write!(text, " – | – | – |"),
                };
            }
            text.push('\n');
        }
        text
    }

    pub(crate) fn write(&self, file: &Path) -> Result<(), String> {
        fs::write(file, self.markdown()).map_err(|error| format!("{}: {error}", file.display()))
    }

    /// Whether the file still says what was measured.
    pub(crate) fn compare(&self, file: &Path) -> Result<(), String> {
        let old = fs::read_to_string(file).map_err(|error| format!("{}: {error}", file.display()))?;
        let new = self.markdown();
        let stale: String = new
            .lines()
            .enumerate()
            .filter(|(place, line)| !same_line(old.lines().nth(*place).unwrap_or_default(), line))
            .map(|(_, line)| format!("\n{line}"))
            .collect();
        if stale.is_empty() && old.lines().count() == new.lines().count() {
            println!("table: current");
            return Ok(());
        }
        Err(format!("{} is not current (run with --table):{stale}", file.display()))
    }
}

fn same_line(old: &str, new: &str) -> bool {
    let (old, new): (Vec<&str>, Vec<&str>) = (old.split('|').collect(), new.split('|').collect());
    let same = |(old, new): (&&str, &&str)| match (old.trim().parse::<f64>(), new.trim().parse::<f64>()) {
        (Ok(old), Ok(new)) => (old - new).abs() <= ABSOLUTE.max(RELATIVE * old.abs()),
        _ => old == new,
    };
    old.len() == new.len() && old.iter().zip(&new).all(same)
}

const HEAD: &str = "\
# What the functions cost in `f32`

Generated by `embedded/run --table`; `embedded/run` fails when a figure is off by more than 3 % and 64. Built for size
(`opt-level = \"s\"`, `lto = \"fat\"`) and emulated by QEMU.

- **Row**: one of the table in [`entries/src`](entries/src), which says which public functions it calls and with what
  arguments.
- **Flash**: bytes of code and tables that an image gains by the row, `libm`, soft floats and the row's own arguments included.
- **Stack**: worst depth in bytes, painted and scanned: the row's arguments, buffers and results included.
- **Instructions**: a call's mean, counted by the emulator: not cycles.

No function uses static RAM. Where there is no figure the row's buffers don't fit the 16 KB of RAM of the Cortex-M0, or its
tables the 256 KB of flash. The Cortex-M0 has no floating-point unit; that of the Cortex-M4F is of single precision.

| row | M4F flash | stack | instructions | M0 flash | stack | instructions |
|---|---:|---:|---:|---:|---:|---:|
";
