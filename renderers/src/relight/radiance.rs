//! Radiance pictures (`.hdr`, `.pic`), a scanline at a time.
//!
//! # What the header's lines mean here
//! - `FORMAT` must be `32-bit_rle_rgbe`, which is also taken for granted; pictures in XYZ are refused.
//! - `EXPOSURE` (a factor) and `COLORCORR` (a factor for each component) say by what the pixels have been multiplied; given more
//!   than once they accumulate. [`RadianceReader::undo`] says which of them are divided out.
//! - `PIXASPECT` (the height of a pixel by its width) accumulates, `PRIMARIES` (x and y of red, green, blue and white) doesn't:
//!   the last one counts. Colours are not converted.
//! - All other lines are kept as they are.
//!
//! Source: Ward, "Real Pixels" (Graphics Gems II, 1991), and the Radiance file formats that come with that program.

use core::fmt;
use std::io::{self, BufRead, Read, Write};
use std::path::{Path, PathBuf};

use super::rgbe::{self, ScanlineError};
use crate::image::ImageError;

/// What a header may take, in bytes.
const LONGEST_HEADER: u64 = 1 << 20;

/// The most pixels of a picture's side.
pub const MAX_SIDE: usize = 1 << 18;

/// The size of a picture and where its scanlines lie: `-Y 480 +X 640` for 480 rows from the top, each from the left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Resolution {
    /// Whether the scanlines are columns, not rows.
    pub columns: bool,
    /// Whether the first scanline is the one at the end of its axis: the lowest row, or the rightmost column.
    ///
    /// Y points upwards in Radiance, so that rows from the top are `-Y`.
    pub last_first: bool,
    /// Whether scanlines run against reading: rows from the right, or columns upwards.
    pub backwards: bool,
    /// How many scanlines there are.
    pub scanlines: usize,
    /// Pixels in a scanline.
    pub length: usize,
}

impl Resolution {
    /// Rows from the top, each from the left.
    #[must_use]
    pub fn rows(width: usize, height: usize) -> Self {
        Self { columns: false, last_first: false, backwards: false, scanlines: height, length: width }
    }

    /// Width and height of the picture.
    #[must_use]
    pub fn size(&self) -> [usize; 2] {
        if self.columns { [self.scanlines, self.length] } else { [self.length, self.scanlines] }
    }

    /// The resolution that a line says; any of the eight orientations.
    fn parse(line: &str) -> Option<Self> {
        let mut words = line.split_ascii_whitespace();
        let (first, scanlines, second, length) = (words.next()?, words.next()?, words.next()?, words.next()?);
        let side = |text: &str| text.parse().ok().filter(|n| (1..=MAX_SIDE).contains(n));
        let (scanlines, length) = (side(scanlines)?, side(length)?);
        let (columns, last_first, backwards) = match (first, second) {
            ("-Y" | "+Y", "-X" | "+X") => (false, first == "+Y", second == "-X"),
            ("-X" | "+X", "-Y" | "+Y") => (true, first == "-X", second == "+Y"),
            _ => return None,
        };
        words.next().is_none().then_some(Self { columns, last_first, backwards, scanlines, length })
    }
}

impl fmt::Display for Resolution {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let x = |against| if against { "-X" } else { "+X" };
        let y = |against| if against { "+Y" } else { "-Y" };
        let (first, second) = if self.columns {
            (x(self.last_first), y(self.backwards))
        } else {
            (y(self.last_first), x(self.backwards))
        };
        write!(f, "{first} {} {second} {}", self.scanlines, self.length)
    }
}

/// What the header of a Radiance picture says.
#[derive(Clone, Debug, PartialEq)]
pub struct RadianceHeader {
    /// The size and the orientation.
    pub resolution: Resolution,
    /// The product of all `EXPOSURE` lines.
    pub exposure: f64,
    /// The product of all `COLORCORR` lines.
    pub colour_correction: [f64; 3],
    /// The product of all `PIXASPECT` lines: height by width.
    pub pixel_aspect: f64,
    /// `PRIMARIES`: x and y of red, green, blue and white.
    pub primaries: Option<[f64; 8]>,
    /// All lines but the first and those of `FORMAT` and `COLORCORR`, without their ends.
    pub lines: Vec<Vec<u8>>,
}

impl RadianceHeader {
    /// The header of a picture of this size, with nothing else to say.
    #[must_use]
    pub fn new(resolution: Resolution) -> Self {
        let lines = Vec::new();
        Self { resolution, exposure: 1.0, colour_correction: [1.0; 3], pixel_aspect: 1.0, primaries: None, lines }
    }

    /// Writes the lines and the resolution. What isn't in [`lines`](Self::lines), is not written.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        out.write_all(b"#?RADIANCE\n")?;
        for line in &self.lines {
            out.write_all(line)?;
            out.write_all(b"\n")?;
        }
        write!(out, "FORMAT=32-bit_rle_rgbe\n\n{}\n", self.resolution)
    }

    fn read(input: &mut impl BufRead) -> Result<Self, Refused> {
        let mut input = input.take(LONGEST_HEADER);
        if !next_line(&mut input)?.starts_with(b"#?") {
            return Err(Refused::Damaged("it does not begin with #?".to_owned()));
        }
        let mut header = Self::new(Resolution::rows(1, 1));
        loop {
            let line = next_line(&mut input)?;
            if line.is_empty() {
                break;
            }
            header.add(line)?;
        }
        let line = next_line(&mut input)?;
        let text = String::from_utf8_lossy(&line);
        header.resolution = Resolution::parse(&text).ok_or_else(|| {
            Refused::Damaged(format!("no picture size can be read from `{}` (sides up to {MAX_SIDE})", shown(&text)))
        })?;
        Ok(header)
    }

    /// Takes in a line of the header.
    fn add(&mut self, line: Vec<u8>) -> Result<(), Refused> {
        // Lines about pictures that this one was made from are indented.
        let Some((name, value)) = variable(&line) else {
            self.lines.push(line);
            return Ok(());
        };
        match name {
            "FORMAT" if value == "32-bit_rle_rgbe" => return Ok(()),
            "FORMAT" if value == "32-bit_rle_xyze" => {
                return Err(Refused::Unsupported("colours in XYZ (FORMAT=32-bit_rle_xyze)".to_owned()));
            }
            "FORMAT" => return Err(Refused::Unsupported(format!("FORMAT={}", shown(value)))),
            "EXPOSURE" => multiply([&mut self.exposure], name, value)?,
            "PIXASPECT" => multiply([&mut self.pixel_aspect], name, value)?,
            "COLORCORR" => {
                multiply(self.colour_correction.each_mut(), name, value)?;
                return Ok(());
            }
            "PRIMARIES" => self.primaries = Some(numbers(value).ok_or_else(|| unreadable(name, value))?),
            _ => {}
        }
        self.lines.push(line);
        Ok(())
    }
}

/// Why a header can't be read.
enum Refused {
    Io(io::Error),
    Damaged(String),
    Unsupported(String),
}

impl From<io::Error> for Refused {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

fn unreadable(name: &str, value: &str) -> Refused {
    Refused::Damaged(format!("{name}={} in the header", shown(value)))
}

/// The beginning of a text of the file, fit for a line.
fn shown(text: &str) -> String {
    text.chars().take(60).map(|c| if c.is_control() { ' ' } else { c }).collect()
}

/// A line without its end.
fn next_line(input: &mut impl BufRead) -> Result<Vec<u8>, Refused> {
    let mut line = Vec::new();
    input.read_until(b'\n', &mut line)?;
    if line.pop() != Some(b'\n') {
        return Err(Refused::Damaged("the file ends within the header".to_owned()));
    }
    while line.last() == Some(&b'\r') {
        line.pop();
    }
    Ok(line)
}

/// The name and the value of a line NAME=value.
fn variable(line: &[u8]) -> Option<(&str, &str)> {
    let (name, value) = core::str::from_utf8(line).ok()?.split_once('=')?;
    let plain = |c: char| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_';
    (!name.is_empty() && name.chars().all(plain)).then_some((name, value.trim()))
}

fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let mut words = text.split_ascii_whitespace();
    let mut values = [0.0; N];
    for value in &mut values {
        *value = words.next()?.parse().ok().filter(|number: &f64| number.is_finite())?;
    }
    words.next().is_none().then_some(values)
}

/// Multiplies factors by those of a line, as long as they stay positive and finite.
fn multiply<const N: usize>(factors: [&mut f64; N], name: &str, value: &str) -> Result<(), Refused> {
    let new: [f64; N] = numbers(value).ok_or_else(|| unreadable(name, value))?;
    for (factor, new) in factors.into_iter().zip(new) {
        *factor *= new;
        if !(*factor > 0.0 && factor.is_finite()) {
            return Err(unreadable(name, value));
        }
    }
    Ok(())
}

/// Which of the header's factors [`RadianceReader::next_scanline`] divides by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Undo {
    /// `COLORCORR`: where `EXPOSURE` is written again, which commutes with what is done to the colours.
    ColourCorrection,
    /// Both.
    Everything,
}

/// Reads a Radiance picture, a scanline at a time, in the order of the file.
#[derive(Debug)]
pub struct RadianceReader<R> {
    file: PathBuf,
    input: R,
    header: RadianceHeader,
    factors: [f64; 3],
    scanline: Vec<[u8; 4]>,
    done: usize,
}

impl<R: BufRead> RadianceReader<R> {
    /// Reads the header. `file` is named in errors.
    ///
    /// # Errors
    /// [`ImageError::Io`], [`ImageError::Malformed`], [`ImageError::Unsupported`].
    pub fn new(file: &Path, mut input: R) -> Result<Self, ImageError> {
        let header = RadianceHeader::read(&mut input).map_err(|refused| match refused {
            Refused::Io(source) => ImageError::io(file, source),
            Refused::Damaged(reason) => ImageError::malformed(file, reason),
            Refused::Unsupported(reason) => ImageError::unsupported(file, reason),
        })?;
        let mut reader =
            Self { file: file.to_owned(), input, header, factors: [1.0; 3], scanline: Vec::new(), done: 0 };
        reader.undo(Undo::Everything);
        Ok(reader)
    }

    /// What the header says.
    #[must_use]
    pub fn header(&self) -> &RadianceHeader {
        &self.header
    }

    /// Chooses which of the header's factors are divided out; all, if nothing is chosen.
    pub fn undo(&mut self, what: Undo) {
        let exposure = if what == Undo::Everything { self.header.exposure } else { 1.0 };
        self.factors = self.header.colour_correction.map(|factor| 1.0 / (factor * exposure));
    }

    /// Appends the pixels of the next scanline, if there is one, and says whether there was.
    ///
    /// A component is infinite only where the header's factors take it out of the range of `f32`.
    ///
    /// # Errors
    /// [`ImageError::Io`], [`ImageError::Malformed`].
    pub fn next_scanline(&mut self, pixels: &mut Vec<[f32; 3]>) -> Result<bool, ImageError> {
        let Resolution { scanlines, length, .. } = self.header.resolution;
        if self.done == scanlines {
            return Ok(false);
        }
        self.scanline.resize(length, [0; 4]);
        rgbe::read_scanline(&mut self.input, &mut self.scanline).map_err(|error| match error {
            ScanlineError::Io(source) if source.kind() != io::ErrorKind::UnexpectedEof => {
                ImageError::io(&self.file, source)
            }
            other => ImageError::malformed(&self.file, format_args!("scanline {}: {other}", self.done)),
        })?;
        self.done += 1;
        let [red, green, blue] = self.factors;
        #[allow(clippy::cast_possible_truncation, reason = "eight bits of mantissa")]
        pixels.extend(self.scanline.iter().map(|pixel| {
            let [r, g, b] = rgbe::decode(*pixel);
            [(r * red) as f32, (g * green) as f32, (b * blue) as f32]
        }));
        Ok(true)
    }
}

/// A scanline in the bytes of a Radiance picture.
///
/// Negative components become 0, and those above [`rgbe::LARGEST`] that.
#[must_use]
pub fn encode_scanline(colours: &[[f32; 3]]) -> Vec<u8> {
    let pixels: Vec<_> = colours.iter().map(|colour| rgbe::encode(*colour)).collect();
    let mut bytes = Vec::with_capacity(4 * pixels.len() + 8);
    rgbe::write_scanline(&pixels, &mut bytes);
    bytes
}
