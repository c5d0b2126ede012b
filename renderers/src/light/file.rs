//! Files of spectra: two columns of text, or IES TM-27 XML.

use core::fmt;
use std::path::Path;

use roxmltree::{Document, Node};
use spectral_core::spectrum::{Outside, PiecewiseLinear};
use spectral_core::tables::UniformTable;

/// The visible range in nm, over which lights are summed.
const VISIBLE: [f64; 2] = [380.0, 780.0];

/// A spectrum as tabulated: spectral power, of any unit and scale, at increasing wavelengths in nm.
///
/// Linear between its nodes, 0 outside them. At least two nodes, all finite, powers not negative, and some of the range
/// in 380–780 nm.
#[derive(Clone, Debug, PartialEq)]
pub struct SpectralTable {
    wavelengths: Vec<f64>,
    powers: Vec<f64>,
}

impl SpectralTable {
    /// The nodes' wavelengths in nm.
    #[must_use]
    pub fn wavelengths(&self) -> &[f64] {
        &self.wavelengths
    }

    /// The spectral power at the nodes.
    #[must_use]
    pub fn powers(&self) -> &[f64] {
        &self.powers
    }

    /// The step in nm when the nodes are at multiples of a whole step that counts from 0, as in tables of the CIE.
    #[must_use]
    pub fn whole_step(&self) -> Option<f64> {
        let (first, second) = (self.wavelengths.first()?, self.wavelengths.get(1)?);
        let step = second - first;
        let regular = self.wavelengths.windows(2).all(|pair| pair[1] - pair[0] == step);
        (regular && step.fract() == 0.0 && first % step == 0.0).then_some(step)
    }

    /// The smallest distance between nodes in nm.
    #[must_use]
    pub fn finest_step(&self) -> f64 {
        self.wavelengths.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min)
    }

    /// The table as a piecewise linear function; `None` never happens for a table that was read.
    #[must_use]
    pub fn spectrum(&self) -> Option<PiecewiseLinear<'_, f64>> {
        PiecewiseLinear::new(&self.wavelengths, &self.powers, Outside::Zero).ok()
    }
}

impl From<&UniformTable> for SpectralTable {
    fn from(table: &UniformTable) -> Self {
        let powers = table.samples.double.to_vec();
        let (first, step) = (u32::from(table.first), u32::from(table.step));
        let wavelengths = (0..).map(|index: u32| f64::from(first + index * step)).take(powers.len()).collect();
        Self { wavelengths, powers }
    }
}

/// Why a file of a spectrum was refused: one line, with the line of the file at fault.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LightFileError {
    /// The file's name.
    pub file: String,
    /// The line at fault, from 1; 0 when the file could not be read at all.
    pub line: u32,
    /// What is wrong.
    pub message: String,
}

impl fmt::Display for LightFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.line == 0 {
            write!(f, "{}: {}", self.file, self.message)
        } else {
            write!(f, "{}:{}: {}", self.file, self.line, self.message)
        }
    }
}

impl core::error::Error for LightFileError {}

/// Reads a spectrum from a file: TM-27 XML when it starts with `<`, two columns of text otherwise.
///
/// # Errors
/// [`LightFileError`] when the file can't be read, or as [`parse_light`].
pub fn read_light(path: &Path) -> Result<SpectralTable, LightFileError> {
    let file = path.display().to_string();
    let bytes =
        std::fs::read(path).map_err(|e| LightFileError { file: file.clone(), line: 0, message: e.to_string() })?;
    parse_light(&file, &bytes)
}

/// Parses what a file of a spectrum holds: TM-27 XML when it starts with `<`, two columns of text otherwise.
///
/// # Errors
/// [`LightFileError`] when it isn't UTF-8 text, or as [`parse_csv`] and [`parse_spdx`].
pub fn parse_light(file: &str, bytes: &[u8]) -> Result<SpectralTable, LightFileError> {
    let text = match core::str::from_utf8(bytes) {
        Ok(text) => text,
        Err(error) => {
            let line = line_of(bytes, error.valid_up_to());
            return Err(LightFileError { file: file.to_owned(), line, message: "not UTF-8 text".to_owned() });
        }
    };
    let text = text.trim_start_matches('\u{feff}');
    if text.trim_start().starts_with('<') { parse_spdx(file, text) } else { parse_csv(file, text) }
}

fn line_of(bytes: &[u8], position: usize) -> u32 {
    let before = bytes.iter().take(position).filter(|&&byte| byte == b'\n').count();
    u32::try_from(before).unwrap_or(u32::MAX).saturating_add(1)
}

/// Parses two columns of text: wavelength in nm, and spectral power of any unit.
///
/// Columns are separated by a comma, a semicolon, a tab or spaces; beside a semicolon or a tab, a comma is a decimal
/// comma. `#` starts a comment, blank lines don't count, and the first other line may be a heading.
///
/// # Errors
/// [`LightFileError`] with the line that isn't two numbers, holds NaN, infinity or a negative power, or whose wavelength
/// isn't above the one before; and when there are fewer than two samples or none in the visible range.
pub fn parse_csv(file: &str, text: &str) -> Result<SpectralTable, LightFileError> {
    let mut builder = Builder::new(file);
    let mut heading_allowed = true;
    for (line, content) in (1..).zip(text.lines()) {
        builder.line = line;
        let content = content.split('#').next().unwrap_or_default().trim();
        if content.is_empty() {
            continue;
        }
        let cells = cells(content);
        let is_heading = cells.first().is_some_and(|cell| cell.parse::<f64>().is_err());
        if heading_allowed && is_heading {
            heading_allowed = false;
            continue;
        }
        heading_allowed = false;
        let [wavelength, power] = cells.as_slice() else {
            let count = cells.len();
            return Err(builder.error(format!("{count} columns, where wavelength in nm and power are needed")));
        };
        builder.add(wavelength, power)?;
    }
    builder.finish()
}

/// The cells of a line, with decimal points.
fn cells(line: &str) -> Vec<String> {
    let split = |separator: char| line.split(separator).map(|cell| cell.trim().replace(',', ".")).collect::<Vec<_>>();
    let cells = if line.contains(';') {
        split(';')
    } else if line.contains('\t') {
        // A tab may be blank space beside a comma that separates.
        let cells = split('\t');
        if cells.iter().any(|cell| cell.ends_with('.') && cell.matches('.').count() > 1) { commas(line) } else { cells }
    } else if line.contains(',') {
        commas(line)
    } else {
        line.split_whitespace().map(str::to_owned).collect()
    };
    // Trailing separators are no column.
    let filled = cells.iter().rposition(|cell| !cell.is_empty()).map_or(0, |last| last + 1);
    cells.into_iter().take(filled).collect()
}

fn commas(line: &str) -> Vec<String> {
    line.split(',').map(|cell| cell.trim().to_owned()).collect()
}

/// Parses an IES TM-27 spectrum (`.spdx`): `<SpectralData wavelength="…">power</SpectralData>`.
///
/// # Errors
/// [`LightFileError`] when it isn't such XML, when the quantity is no light (`reflectance` and the like), and as
/// [`parse_csv`].
pub fn parse_spdx(file: &str, text: &str) -> Result<SpectralTable, LightFileError> {
    let mut builder = Builder::new(file);
    let document = Document::parse(text).map_err(|error| {
        builder.line = error.pos().row;
        builder.error(error.to_string())
    })?;
    let line = |node: &Node<'_, '_>| document.text_pos_at(node.range().start).row;
    let distributions: Vec<_> =
        document.descendants().filter(|node| node.tag_name().name() == "SpectralDistribution").collect();
    let [distribution] = distributions.as_slice() else {
        builder.line = distributions.get(1).map_or(1, line);
        let count = distributions.len();
        return Err(builder.error(format!("{count} elements <SpectralDistribution>, where one is needed")));
    };
    let child = |name: &str| distribution.children().find(|node| node.tag_name().name() == name);
    if let Some(quantity) = child("SpectralQuantity") {
        let name = quantity.text().unwrap_or_default().trim().to_owned();
        let of_matter = ["absorptance", "transmittance", "reflectance", "r-factor", "t-factor"];
        if of_matter.contains(&name.to_ascii_lowercase().as_str()) {
            builder.line = line(&quantity);
            return Err(builder.error(format!("the quantity is {name}, not that of a light")));
        }
    }
    for node in distribution.children().filter(|node| node.tag_name().name() == "SpectralData") {
        builder.line = line(&node);
        let Some(wavelength) = node.attribute("wavelength") else {
            return Err(builder.error("<SpectralData> has no wavelength".to_owned()));
        };
        builder.add(wavelength.trim(), node.text().unwrap_or_default().trim())?;
    }
    builder.finish()
}

/// A table under construction, and the line that is being read.
struct Builder<'a> {
    file: &'a str,
    line: u32,
    first_line: u32,
    table: SpectralTable,
}

impl<'a> Builder<'a> {
    fn new(file: &'a str) -> Self {
        let table = SpectralTable { wavelengths: Vec::new(), powers: Vec::new() };
        Self { file, line: 1, first_line: 1, table }
    }

    fn error(&self, message: String) -> LightFileError {
        // XML parsers may quote what they found, line breaks included.
        let message = message.replace(char::is_control, " ");
        LightFileError { file: self.file.to_owned(), line: self.line, message }
    }

    fn number(&self, text: &str, what: &str) -> Result<f64, LightFileError> {
        match text.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            Ok(_) => Err(self.error(format!("the {what} is not finite: {text}"))),
            Err(_) => Err(self.error(format!("the {what} is not a number: {text:?}"))),
        }
    }

    fn add(&mut self, wavelength: &str, power: &str) -> Result<(), LightFileError> {
        let wavelength = self.number(wavelength, "wavelength")?;
        let power = self.number(power, "power")?;
        if wavelength <= 0.0 {
            return Err(self.error(format!("the wavelength is not positive: {wavelength}")));
        }
        if power < 0.0 {
            return Err(self.error(format!("the power is negative: {power}")));
        }
        match self.table.wavelengths.last() {
            Some(&last) if wavelength == last => {
                return Err(self.error(format!("the wavelength {wavelength} nm is there twice")));
            }
            Some(&last) if wavelength < last => {
                return Err(
                    self.error(format!("the wavelength {wavelength} nm is not above the one before, {last} nm"))
                );
            }
            Some(_) => {}
            None => self.first_line = self.line,
        }
        self.table.wavelengths.push(wavelength);
        self.table.powers.push(power);
        Ok(())
    }

    fn finish(mut self) -> Result<SpectralTable, LightFileError> {
        let count = self.table.wavelengths.len();
        let (Some(&first), Some(&last)) = (self.table.wavelengths.first(), self.table.wavelengths.last()) else {
            return Err(self.error("no samples".to_owned()));
        };
        if count < 2 {
            return Err(self.error("one sample, where a spectrum needs at least two".to_owned()));
        }
        if last <= VISIBLE[0] || first >= VISIBLE[1] {
            self.line = self.first_line;
            return Err(self.error(format!("{first}–{last} nm misses the visible range, 380–780 nm")));
        }
        Ok(self.table)
    }
}
