//! The generator of `spectral-core/src/tables` from the CSV files of `spectral-core/data`.
//!
//! Run it with `cargo run -p spectral-tests --bin generate_tables`; a test compares what is committed with what it
//! would write.

use core::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// Where the CSV files are.
#[must_use]
pub fn data_directory() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../spectral-core/data")
}

/// Where the generated files belong.
#[must_use]
pub fn table_directory() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../spectral-core/src/tables")
}

/// A CSV file with a header line; lines that start with `#` are comments.
#[derive(Debug)]
pub struct Csv {
    /// The column names.
    pub header: Vec<String>,
    /// The cells, row by row, as written.
    pub rows: Vec<Vec<String>>,
}

impl Csv {
    /// Reads a file of the data directory.
    ///
    /// # Errors
    /// The file can't be read, or a row has more or fewer cells than the header.
    pub fn read(file: &str) -> Result<Self, String> {
        let path = data_directory().join(file);
        let text = fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        Self::parse(&text).map_err(|error| format!("{file}: {error}"))
    }

    /// Parses the text of a file.
    ///
    /// # Errors
    /// There is no header, or a row has more or fewer cells than the header.
    pub fn parse(text: &str) -> Result<Self, String> {
        let mut lines = text.lines().filter(|line| !line.starts_with('#') && !line.is_empty());
        let split = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
        let header = split(lines.next().ok_or("no header")?);
        let rows: Vec<_> = lines.map(split).collect();
        match rows.iter().find(|row| row.len() != header.len()) {
            Some(row) => Err(format!("{} cells instead of {}: {}", row.len(), header.len(), row.join(","))),
            None => Ok(Self { header, rows }),
        }
    }

    /// The position of a column.
    ///
    /// # Errors
    /// There is no such column.
    pub fn index(&self, name: &str) -> Result<usize, String> {
        self.header.iter().position(|column| column == name).ok_or_else(|| format!("no column {name}"))
    }

    /// The cells of a column, as written.
    ///
    /// # Errors
    /// There is no such column.
    pub fn column(&self, name: &str) -> Result<Vec<&str>, String> {
        let index = self.index(name)?;
        Ok(self.rows.iter().map(|row| row[index].as_str()).collect())
    }

    /// The first column and the named one as numbers, without the rows in which the named one is empty.
    ///
    /// # Errors
    /// There is no such column, or a cell isn't a number.
    pub fn numbers(&self, name: &str) -> Result<(Vec<f64>, Vec<f64>), String> {
        let parse = |cell: &&str| cell.parse::<f64>().map_err(|_| format!("not a number: {cell}"));
        let [keys, values] = self.pairs(name)?;
        Ok((keys.iter().map(parse).collect::<Result<_, _>>()?, values.iter().map(parse).collect::<Result<_, _>>()?))
    }

    /// The first column and the named one, without the rows in which the named one is empty.
    fn pairs(&self, name: &str) -> Result<[Vec<&str>; 2], String> {
        let keys = self.column(&self.header[0])?;
        let (keys, values) = keys.into_iter().zip(self.column(name)?).filter(|(_, value)| !value.is_empty()).unzip();
        Ok([keys, values])
    }
}

/// What the columns of a file become.
enum Kind {
    /// One `UniformTable` a column.
    Uniform { quantity: &'static str },
    /// One `ObserverTable` of the given constant and name.
    Observer { constant: &'static str, name: &'static str },
    /// One `BinTable` a column after the bin edges.
    Bins { quantity: &'static str },
    /// One `LineTable` of the given constant and name.
    Lines { constant: &'static str, name: &'static str },
    /// One `MetalTable` for each pair of columns `X_n`, `X_k`, named `X` followed by the suffix.
    Metals { suffix: &'static str, author: &'static str },
    /// One `GlassTable` a row, of the given formula and coefficient columns.
    Glasses { formula: &'static str, columns: &'static [&'static str] },
}

/// A generated file: its name, its documentation, and its sources.
struct Module {
    name: &'static str,
    doc: &'static str,
    table: &'static str,
    sources: &'static [(&'static str, Kind)],
}

const POWER: Kind = Kind::Uniform { quantity: "relative spectral power" };
const REFLECTANCE: Kind = Kind::Uniform { quantity: "spectral reflectance" };
const METALS: [(&str, Kind); 3] = [
    ("metals_nk_mitsuba_luxpop.csv", Kind::Metals { suffix: "", author: "luxpop, as shipped with Mitsuba 3" }),
    ("metals_nk_johnson_christy.csv", Kind::Metals { suffix: "-Johnson", author: "Johnson and Christy 1972" }),
    ("aluminium_nk_rakic1995.csv", Kind::Metals { suffix: "-Rakic", author: "Rakić 1995" }),
];

/// Every generated file.
const MODULES: [Module; 19] = [
    Module {
        name: "observers",
        doc: "Colour-matching functions of the CIE standard observers at 1 nm.",
        table: "ObserverTable",
        sources: &[
            ("cie_1931_2deg_cmf_1nm.csv", Kind::Observer { constant: "CIE_1931_2", name: "CIE 1931 2°" }),
            ("cie_1964_10deg_cmf_1nm.csv", Kind::Observer { constant: "CIE_1964_10", name: "CIE 1964 10°" }),
        ],
    },
    Module {
        name: "illuminants",
        doc: "CIE standard illuminants A and D65 and illuminants D50, D55, D75 and C: relative spectral power, 100 at\n\
              560 nm.",
        table: "UniformTable",
        sources: &[("cie_illuminants_A_D50_D55_D65_D75_C_5nm.csv", POWER)],
    },
    Module {
        name: "fluorescent",
        doc: "CIE fluorescent lamps FL1 to FL12 and FL3.1 to FL3.15: relative spectral power.",
        table: "UniformTable",
        sources: &[("cie_fl1_fl12_5nm.csv", POWER), ("cie_fl3_1_fl3_15_5nm.csv", POWER)],
    },
    Module {
        name: "high_pressure",
        doc: "CIE high-pressure discharge lamps: sodium (HP1), colour-enhanced sodium (HP2), metal halide (HP3 to HP5);\n\
              relative spectral power.",
        table: "UniformTable",
        sources: &[("cie_hp1_hp5_5nm.csv", POWER)],
    },
    Module {
        name: "led",
        doc: "CIE typical LED illuminants: relative spectral power.",
        table: "UniformTable",
        sources: &[("cie_led_illuminants_5nm.csv", POWER)],
    },
    Module {
        name: "narrowband",
        doc: "Lamps with narrow bands, measured at 5 nm (Ohno and Davis 2008): relative spectral power.\n\n\
              The sodium and mercury lines themselves are in [`lines`](super::lines).",
        table: "UniformTable",
        sources: &[("narrowband_lamps_nist_5nm.csv", POWER)],
    },
    Module {
        name: "lines",
        doc: "Spectral lines of sodium and mercury: wavelengths in air and relative powers.",
        table: "LineTable",
        sources: &[
            ("lines_sodium_d.csv", Kind::Lines { constant: "SODIUM_D", name: "sodium-D" }),
            ("lines_mercury.csv", Kind::Lines { constant: "MERCURY", name: "mercury" }),
        ],
    },
    Module {
        name: "daylight",
        doc: "The basis of CIE daylight: see [`Daylight`](crate::spectrum::Daylight).",
        table: "UniformTable",
        sources: &[(
            "cie_daylight_basis_S0_S1_S2_5nm.csv",
            Kind::Uniform { quantity: "daylight basis function, S0 = 100 at 560 nm" },
        )],
    },
    Module {
        name: "colorchecker",
        doc: "The 24 ColorChecker patches by Ohta (1997), in the chart's order: spectral reflectance at 5 nm.",
        table: "UniformTable",
        sources: &[("colorchecker24_ohta1997_5nm.csv", REFLECTANCE)],
    },
    Module {
        name: "babelcolor",
        doc: "The 24 ColorChecker patches, BabelColor's average of 30 charts, in the chart's order: spectral reflectance at\n\
              10 nm.",
        table: "UniformTable",
        sources: &[("colorchecker24_babelcolor_avg_10nm.csv", REFLECTANCE)],
    },
    Module {
        name: "cornell",
        doc: "Measured reflectances of the three paints of the Cornell box.",
        table: "UniformTable",
        sources: &[("cornell_box_reflectance_4nm.csv", REFLECTANCE)],
    },
    Module {
        name: "cornell_lamp",
        doc: "The lamp of the Cornell box.",
        table: "UniformTable",
        sources: &[("cornell_box_light.csv", Kind::Uniform { quantity: "relative spectral radiance" })],
    },
    Module {
        name: "test_colours",
        doc: "Test-colour samples TCS01 to TCS14 of CIE 13.3-1995: spectral radiance factor.",
        table: "UniformTable",
        sources: &[("cie_13_3_tcs01_tcs14_5nm.csv", Kind::Uniform { quantity: "spectral radiance factor" })],
    },
    Module {
        name: "ces",
        doc: "Colour evaluation samples CES01 to CES99 of CIE 224:2017 and ANSI/IES TM-30: spectral radiance factor.",
        table: "UniformTable",
        sources: &[("cie_224_ces01_ces99_5nm.csv", Kind::Uniform { quantity: "spectral radiance factor" })],
    },
    Module {
        name: "glasses",
        doc: "Dispersion coefficients of transparent materials: see [`crate::dispersion`].",
        table: "GlassTable",
        sources: &[
            (
                "sellmeier_coefficients.csv",
                Kind::Glasses { formula: "Sellmeier", columns: &["B1", "C1", "B2", "C2", "B3", "C3", "B4", "C4"] },
            ),
            ("cauchy_coefficients.csv", Kind::Glasses { formula: "Cauchy", columns: &["A", "B"] }),
        ],
    },
    Module {
        name: "metals",
        doc: "Optical constants n and k of metals.\n\n\
              The tables named by the chemical symbol alone are those that Mitsuba 3 ships.",
        table: "MetalTable",
        sources: &METALS,
    },
    Module {
        name: "alpha_opic",
        doc: "Action spectra of the human photoreceptors (CIE S 026:2018) at 1 nm, each over the range that is tabulated.",
        table: "UniformTable",
        sources: &[("cie_s026_alpha_opic_1nm.csv", Kind::Uniform { quantity: "action spectrum, 1 at its peak" })],
    },
    Module {
        name: "action",
        doc: "Other action spectra: photosynthesis and melatonin suppression (Aubé et al. 2013), photosynthesis of three\n\
              crops (McCree 1972).",
        table: "UniformTable",
        sources: &[
            ("action_aube2013_pas_msas_5nm.csv", Kind::Uniform { quantity: "action spectrum, 1 at its peak" }),
            ("action_mccree1972_5nm.csv", Kind::Uniform { quantity: "relative action spectrum" }),
        ],
    },
    Module {
        name: "smits",
        doc: "Basis reflectances of Smits (1999) for sRGB, constant over ten bins from 380 nm to 720 nm.",
        table: "BinTable",
        sources: &[("smits1999_basis_10bins.csv", Kind::Bins { quantity: "reflectance" })],
    },
];

/// Every generated file: its path and its contents.
///
/// # Errors
/// A data file can't be read or isn't what its kind of table needs.
pub fn generate() -> Result<Vec<(PathBuf, String)>, String> {
    let file = |module: &Module| {
        let path = table_directory().join(format!("{}.rs", module.name));
        Ok((path, write_module(module)?))
    };
    MODULES.iter().map(file).collect()
}

fn write_module(module: &Module) -> Result<String, String> {
    let files = module.sources.iter().map(|(file, _)| format!("data/{file}")).collect::<Vec<_>>().join(", ");
    let mut out = format!("// Generated from {files} by generate_tables of spectral-tests: not to be edited.\n");
    for line in module.doc.lines() {
        let _ = writeln!(out, "{}", format!("//! {line}").trim_end());
    }
    out.push_str(
        "#![allow(\n    clippy::approx_constant,\n    clippy::excessive_precision,\n    clippy::unreadable_literal,\n",
    );
    out.push_str("    reason = \"decimals as they are in the source\"\n)]\n\n");
    let _ = writeln!(out, "use super::{};", uses(module.table));
    let mut constants = Vec::new();
    for (file, kind) in module.sources {
        let csv = Csv::read(file)?;
        write_source(&mut out, &mut constants, &csv, kind).map_err(|error| format!("{file}: {error}"))?;
    }
    let _ = writeln!(out, "\n/// All of these tables, in the order of their source.");
    let _ = writeln!(out, "pub static ALL: [{}; {}] = [", module.table, constants.len());
    for constant in constants {
        let _ = writeln!(out, "    {constant},");
    }
    out.push_str("];\n");
    Ok(out)
}

fn uses(table: &str) -> String {
    if table == "GlassTable" { "{Formula, GlassTable}".to_owned() } else { table.to_owned() }
}

fn write_source(out: &mut String, constants: &mut Vec<String>, csv: &Csv, kind: &Kind) -> Result<(), String> {
    match kind {
        Kind::Uniform { quantity } => {
            for name in &csv.header[1..] {
                constants.push(write_uniform(out, csv, name, quantity)?);
            }
        }
        Kind::Observer { constant, name } => {
            write_observer(out, csv, constant, name)?;
            constants.push((*constant).to_owned());
        }
        Kind::Bins { quantity } => {
            for name in &csv.header[3..] {
                constants.push(write_bins(out, csv, name, quantity)?);
            }
        }
        Kind::Lines { constant, name } => {
            let fields = [("wavelengths", csv.column("wavelength_nm")?), ("powers", csv.column("power")?)];
            open(out, &format!("The lines of {name}: wavelengths in nm, relative powers"), constant, "LineTable", name);
            write_fields(out, &fields)?;
            constants.push((*constant).to_owned());
        }
        Kind::Metals { suffix, author } => {
            for symbol in csv.header.iter().filter_map(|column| column.strip_suffix("_n")) {
                constants.push(write_metal(out, csv, symbol, suffix, author)?);
            }
        }
        Kind::Glasses { formula, columns } => {
            for row in &csv.rows {
                constants.push(write_glass(out, csv, row, formula, columns)?);
            }
        }
    }
    Ok(())
}

fn write_uniform(out: &mut String, csv: &Csv, name: &str, quantity: &str) -> Result<String, String> {
    let [wavelengths, values] = csv.pairs(name)?;
    let (first, step, last) = steps(&wavelengths)?;
    let constant = identifier(name);
    let doc = format!("`{name}`: {quantity}, {first}–{last} nm at {step} nm");
    open(out, &doc, &constant, "UniformTable", name);
    let _ = writeln!(out, "    first: {first},\n    step: {step},");
    write_fields(out, &[("samples", values)])?;
    Ok(constant)
}

fn write_observer(out: &mut String, csv: &Csv, constant: &str, name: &str) -> Result<(), String> {
    let (first, step, last) = steps(&csv.column("wavelength_nm")?)?;
    let doc = format!("x̄, ȳ, z̄ of the {name} standard observer, {first}–{last} nm at {step} nm");
    open(out, &doc, constant, "ObserverTable", name);
    let _ = writeln!(out, "    first: {first},\n    step: {step},\n    columns: [");
    for column in ["xbar", "ybar", "zbar"] {
        let _ = write!(out, "    ");
        write_list(out, &csv.column(column)?)?;
    }
    out.push_str("    ],\n};\n");
    Ok(())
}

fn write_bins(out: &mut String, csv: &Csv, name: &str, quantity: &str) -> Result<String, String> {
    let (lower, width, _) = steps(&csv.column("bin_lo_nm")?)?;
    let (upper, ..) = steps(&csv.column("bin_hi_nm")?)?;
    if upper != lower + width {
        return Err("the bins don't adjoin".to_owned());
    }
    let constant = identifier(name);
    open(out, &format!("`{name}`: {quantity}, bins of {width} nm from {lower} nm"), &constant, "BinTable", name);
    let _ = writeln!(out, "    lower: {lower},\n    width: {width},");
    write_fields(out, &[("samples", csv.column(name)?)])?;
    Ok(constant)
}

fn write_metal(out: &mut String, csv: &Csv, symbol: &str, suffix: &str, author: &str) -> Result<String, String> {
    let [wavelengths, n] = csv.pairs(&format!("{symbol}_n"))?;
    let [others, k] = csv.pairs(&format!("{symbol}_k"))?;
    if wavelengths != others {
        return Err(format!("n and k of {symbol} are at different wavelengths"));
    }
    let name = format!("{symbol}{suffix}");
    let constant = identifier(&name);
    let (first, last) = (wavelengths[0], wavelengths[wavelengths.len() - 1]);
    open(out, &format!("n and k of {symbol}, {first}–{last} nm ({author})"), &constant, "MetalTable", &name);
    write_fields(out, &[("wavelengths", wavelengths), ("n", n), ("k", k)])?;
    Ok(constant)
}

fn write_glass(out: &mut String, csv: &Csv, row: &[String], formula: &str, columns: &[&str]) -> Result<String, String> {
    let cell = |column: &str| csv.index(column).map(|index| row[index].as_str());
    let name = cell("material")?.replace('_', "-");
    // A name that starts with a digit, such as a glass code, isn't an identifier.
    let plain = identifier(&name);
    let constant = if plain.starts_with(|c: char| c.is_ascii_digit()) { format!("GLASS_{plain}") } else { plain };
    let doc =
        format!("{name}: index {} at 587.56 nm, Abbe number {}. Source: {}", cell("nd")?, cell("Vd")?, cell("source")?);
    let absent_is_zero = |column: &&str| cell(column).map(|text| if text.is_empty() { "0" } else { text });
    let coefficients = columns.iter().map(absent_is_zero).collect::<Result<Vec<_>, _>>()?;
    open(out, &doc, &constant, "GlassTable", &name);
    let _ = writeln!(out, "    formula: Formula::{formula},");
    let _ = writeln!(out, "    valid: [{}, {}],", cell("valid_from_nm")?, cell("valid_to_nm")?);
    write_fields(out, &[("coefficients", coefficients)])?;
    Ok(constant)
}

/// The documentation and the first lines of a constant.
fn open(out: &mut String, doc: &str, constant: &str, table: &str, name: &str) {
    let _ = writeln!(out, "\n/// {doc}.\npub const {constant}: {table} = {table} {{\n    name: \"{name}\",");
}

/// The lists of a constant, and its end.
fn write_fields(out: &mut String, fields: &[(&str, Vec<&str>)]) -> Result<(), String> {
    for (field, values) in fields {
        let _ = write!(out, "    {field}: ");
        write_list(out, values)?;
    }
    out.push_str("};\n");
    Ok(())
}

/// A `samples!` list from where the line stands to its end.
fn write_list(out: &mut String, cells: &[&str]) -> Result<(), String> {
    let literals = cells.iter().map(|text| literal(text)).collect::<Result<Vec<_>, _>>()?;
    let _ = writeln!(out, "samples!({};", literals.len());
    write_wrapped(out, &literals);
    out.push_str("    ),\n");
    Ok(())
}

fn write_wrapped(out: &mut String, literals: &[String]) {
    const WIDTH: usize = 110;
    let mut line = String::new();
    for literal in literals {
        if !line.is_empty() && line.len() + literal.len() > WIDTH {
            let _ = writeln!(out, "       {line}");
            line.clear();
        }
        let _ = write!(line, " {literal},");
    }
    let _ = writeln!(out, "       {line}");
}

/// A decimal of a CSV file as a Rust literal of the same digits.
fn literal(text: &str) -> Result<String, String> {
    let number: f64 = text.parse().map_err(|_| format!("not a number: {text:?}"))?;
    if !number.is_finite() || text.starts_with(['+', '.']) || text.ends_with('.') {
        return Err(format!("not a plain finite decimal: {text:?}"));
    }
    Ok(if text.contains(['.', 'e', 'E']) { text.to_owned() } else { format!("{text}.0") })
}

/// First value, step and last value of whole numbers at equal steps.
fn steps(cells: &[&str]) -> Result<(u16, u16, u16), String> {
    let parse = |cell: &&str| cell.parse::<u16>().map_err(|_| format!("not a whole number: {cell}"));
    let numbers = cells.iter().map(parse).collect::<Result<Vec<_>, _>>()?;
    let (&[first, second, ..], &[.., last]) = (&numbers[..], &numbers[..]) else {
        return Err("fewer than two rows".to_owned());
    };
    let step = second.checked_sub(first).filter(|&step| step > 0).ok_or("the wavelengths don't increase")?;
    if numbers.windows(2).any(|pair| pair[1].checked_sub(pair[0]) != Some(step)) {
        return Err("the step changes".to_owned());
    }
    Ok((first, step, last))
}

/// The name of a column as that of a constant.
fn identifier(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_uppercase() } else { '_' }).collect()
}
