//! Compares bare metal with the host, proves that no panic is left, and measures: see `../run`.

mod rows;
mod scan;
mod table;
mod target;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use embedded_entries::{CONTROLS, ENTRIES};

use rows::{Precision, Wanted, fnv, in_parallel};
use table::Table;
use target::{ALL, LinkError, M0, M4F, Report, Row, Target, Tools};

type Outcome<T> = Result<T, String>;

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(words) => {
            eprintln!("embedded: {words}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Outcome<()> {
    let mut arguments = std::env::args().skip(1);
    let (Some(linker), write) = (arguments.next(), arguments.next()) else {
        return Err("usage: embedded-runner LINKER [--table]".into());
    };
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let tools = Tools { linker: linker.into(), scripts: root.join("image"), built: root.join("target") };
    let images = root.join("target/images");
    std::fs::create_dir_all(&images).map_err(|error| format!("{}: {error}", images.display()))?;

    check_coverage(&root)?;
    check_controls(&tools, &images)?;
    let rows = rows::all();
    let gate = check_panics(&tools, &images, &rows)?;
    println!("panics: none in {gate} images of one row; the control is refused");

    let measured = measure_singly(&tools, &images, &rows)?;
    measured.check_budget()?;
    let file = root.join("TABLE.md");
    if write.as_deref() == Some("--table") {
        return measured.write(&file);
    }
    measured.compare(&file)?;
    compare_demo(&tools, &images)?;
    compare_bits(&tools, &images, &rows)
}

/// Every public function is in a row, and every function that a row names exists.
fn check_coverage(root: &Path) -> Outcome<()> {
    let mut public = BTreeSet::new();
    for name in ["spectral-core", "disk-sampling"] {
        let source = root.join("..").join(name).join("src");
        let found = scan::public_functions(&source).map_err(|error| format!("{}: {error}", source.display()))?;
        public.extend(found);
    }
    let named = ENTRIES.into_iter().flatten().flat_map(|entry| entry.covers).map(|name| (*name).to_string());
    let named: BTreeSet<String> = named.collect();
    let list = |names: Vec<&String>| names.into_iter().map(|name| format!("\n  {name}")).collect::<String>();
    let (missing, stale) = (list(public.difference(&named).collect()), list(named.difference(&public).collect()));
    if !missing.is_empty() || !stale.is_empty() {
        return Err(format!("public functions in no row:{missing}\nin a row but not public:{stale}"));
    }
    println!("coverage: {} public functions and implementations of traits, all in rows", public.len());
    Ok(())
}

/// A gate that can't fail would prove nothing.
fn check_controls(tools: &Tools, images: &Path) -> Outcome<()> {
    for target in ALL {
        for control in CONTROLS {
            let wanted = [Wanted { entry: control, precision: Precision::Single }.symbol()];
            let linked = target.link(tools, "rows_main", &wanted, &images.join("control.elf"));
            let has_panic = control.name == "control_index";
            match linked {
                Ok(()) if !has_panic => {}
                Err(LinkError::Panic) if has_panic => {}
                other => return Err(format!("{}: {} gave {other:?}", target.name, control.name)),
            }
        }
    }
    Ok(())
}

/// Every row by itself in both precisions on Cortex-M4F, and in `f32` on Cortex-M0; the number of images.
///
/// The images of all rows at once, on the other targets, pass the same gate when their bits are compared.
fn check_panics(tools: &Tools, images: &Path, rows: &[Wanted]) -> Outcome<usize> {
    let singles = rows.iter().filter(|row| row.precision == Precision::Single);
    let jobs: Vec<_> = rows.iter().map(|row| (M4F, row)).chain(singles.map(|row| (M0, row))).collect();
    let results = in_parallel(&jobs, |(target, row), worker| {
        let image = images.join(format!("gate-{worker}.elf"));
        match target.link(tools, "rows_main", &[row.symbol()], &image) {
            // What does not fit is not the gate's business.
            Ok(()) | Err(LinkError::Full) => None,
            Err(LinkError::Panic) => Some(format!("{}: a panic is left in {}", target.name, row.symbol())),
            Err(LinkError::Other(words)) => Some(words),
        }
    });
    let faults: Vec<String> = results.into_iter().flatten().collect();
    if faults.is_empty() { Ok(jobs.len()) } else { Err(faults.join("\n")) }
}

/// Sizes, stacks and instructions of every row in `f32` on Cortex-M4F and Cortex-M0.
fn measure_singly(tools: &Tools, images: &Path, rows: &[Wanted]) -> Outcome<Table> {
    let empty = Wanted { entry: &CONTROLS[0], precision: Precision::Single };
    let singles: Vec<Wanted> =
        [empty].into_iter().chain(rows.iter().copied()).filter(|row| row.precision == Precision::Single).collect();
    let jobs: Vec<(Target, Wanted)> =
        [M4F, M0].into_iter().flat_map(|target| singles.iter().map(move |row| (target, *row))).collect();
    let reports = in_parallel(&jobs, |(target, row), worker| {
        let image = images.join(format!("single-{worker}.elf"));
        match target.measure(tools, &[row.symbol()], &image, true) {
            Ok(report) => Ok(Some(report)),
            Err(LinkError::Full) => Ok(None),
            // Out of RAM: what takes more on Cortex-M4F is not expected to run.
            Err(error) if *target == M0 => {
                let larger = M4F.measure(tools, &[row.symbol()], &image, false);
                match larger {
                    Ok(report) if !fits(&report.rows[0], target) => Ok(None),
                    _ => Err(format!("{}: {error:?}", row.symbol())),
                }
            }
            Err(error) => Err(format!("{}: {error:?}", row.symbol())),
        }
    });
    let reports = reports.into_iter().collect::<Outcome<Vec<Option<Report>>>>()?;
    let (large, small) = reports.split_at(singles.len());
    Table::new(&singles, large, small)
}

/// Whether a row that took as much stack on Cortex-M4F can be expected to run in a machine's RAM.
fn fits(row: &Row, target: &Target) -> bool {
    row.stack * 5 / 4 + 1024 <= target.ram
}

/// All rows on all targets against the host.
fn compare_bits(tools: &Tools, images: &Path, rows: &[Wanted]) -> Outcome<()> {
    let digests: Vec<(u64, u32)> = rows.iter().map(Wanted::on_host).collect();
    for precision in [Precision::Single, Precision::Double] {
        let of = rows.iter().zip(&digests).filter(|(row, _)| row.precision == precision);
        let (count, all) =
            of.fold((0, fnv([])), |(count, all), (_, (digest, results))| (count + results, fnv([all, *digest])));
        println!("host {precision}: {count} results, digest {all:016x}");
    }
    let large = measure_all(&M4F, tools, images, rows)?;
    for target in ALL {
        let chosen: Vec<usize> = (0..rows.len()).filter(|&i| fits(&large[i], &target)).collect();
        let wanted: Vec<Wanted> = chosen.iter().map(|&i| rows[i]).collect();
        let found = if target == M4F { large.clone() } else { measure_all(&target, tools, images, &wanted)? };
        for (&place, found) in chosen.iter().zip(&found) {
            let (digest, results) = digests[place];
            if (found.digest, found.results) != (digest, u64::from(results)) {
                let name = rows[place].symbol();
                return Err(format!("{}: {name} gives {:016x}, not {digest:016x}", target.name, found.digest));
            }
        }
        let left: Vec<String> = (0..rows.len()).filter(|i| !chosen.contains(i)).map(|i| rows[i].symbol()).collect();
        println!("{}: the same bits in {} of {} rows", target.name, chosen.len(), rows.len());
        if !left.is_empty() {
            println!("    more state than {} KB of RAM: {}", target.ram >> 10, left.join(", "));
        }
    }
    compare_wasm(tools, rows, &digests)
}

/// Rows in as few images as the flash allows.
fn measure_all(target: &Target, tools: &Tools, images: &Path, rows: &[Wanted]) -> Outcome<Vec<Row>> {
    let symbols: Vec<String> = rows.iter().map(Wanted::symbol).collect();
    match target.measure(tools, &symbols, &images.join(format!("all-{}.elf", target.name)), false) {
        Ok(report) => Ok(report.rows),
        Err(LinkError::Full) if rows.len() > 1 => {
            let (first, second) = rows.split_at(rows.len() / 2);
            let mut found = measure_all(target, tools, images, first)?;
            found.extend(measure_all(target, tools, images, second)?);
            Ok(found)
        }
        Err(error) => Err(format!("{}: {error:?}", target.name)),
    }
}

/// What node prints for a module's export.
fn wasm(tools: &Tools, what: &str) -> Outcome<String> {
    let module: PathBuf = tools.built.join("wasm32-unknown-unknown/release/embedded_image.wasm");
    let output = Command::new("node").arg(tools.scripts.join("run.mjs")).arg(module).arg(what).output();
    let output = output.map_err(|error| format!("node: {error}"))?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    if output.status.success() { Ok(text) } else { Err(format!("node: {}", String::from_utf8_lossy(&output.stderr))) }
}

fn compare_wasm(tools: &Tools, rows: &[Wanted], digests: &[(u64, u32)]) -> Outcome<()> {
    let text = wasm(tools, "rows")?;
    let lines: Vec<&str> = text.lines().collect();
    let names: Vec<&str> = ENTRIES.into_iter().flatten().map(|entry| entry.name).collect();
    if lines.len() != names.len() {
        return Err(format!("WebAssembly: {} rows, not {}", lines.len(), names.len()));
    }
    for (row, (digest, _)) in rows.iter().zip(digests) {
        let line = names.iter().position(|name| *name == row.entry.name).and_then(|place| lines.get(place));
        let column = usize::from(row.precision == Precision::Double);
        let found = line.and_then(|line| line.split(' ').nth(column)).unwrap_or_default();
        if found != format!("{digest:016x}") {
            return Err(format!("WebAssembly: {} gives {found}, not {digest:016x}", row.symbol()));
        }
    }
    println!("WebAssembly: the same bits in {0} of {0} rows", rows.len());
    Ok(())
}

/// The demonstration, to the letter.
fn compare_demo(tools: &Tools, images: &Path) -> Outcome<()> {
    let mut host = String::new();
    if !embedded_demo::report(&mut |line| host += &format!("{line}\n")) {
        return Err(format!("the demonstration lacks results:\n{host}"));
    }
    for target in ALL {
        let image = images.join(format!("demo-{}.elf", target.name));
        target.link(tools, "demo_main", &[], &image).map_err(|error| format!("{}: {error:?}", target.name))?;
        same_demo(target.name, &target.run(&image, false)?, &host)?;
    }
    same_demo("WebAssembly", &wasm(tools, "demo")?, &host)?;
    print!("demonstration, the same everywhere:\n{host}");
    Ok(())
}

fn same_demo(name: &str, text: &str, host: &str) -> Outcome<()> {
    if text == host { Ok(()) } else { Err(format!("{name} prints\n{text}where the host prints\n{host}")) }
}
