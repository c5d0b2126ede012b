//! Relighting of high-dynamic-range pictures: each pixel is divided by the light that it was made under, and multiplied by another.
//!
//! [`relight`] takes a picture from one file to another, `OpenEXR` or Radiance, some rows at a time, so that memory
//! doesn't grow with the picture. The product and its division are those of a [`Tensor`]: the
//! classical one, component by component, or the bilinear one of Granier and Damez (2004, section 7.2), which keeps more
//! of the appearance of colours.
//!
//! # Singular divisors
//! All pixels have the same divisor, the first light. If it is singular (by the classical product, if a component is 0: what
//! the surface would have reflected of it can't be known) no pixel can be relit, and the picture is refused. Close to that the
//! [`condition`](Summary::condition) is large: it says by how much noise and rounding of the picture may be magnified.
//! Pixels that no surface can have under the first light, and those that come out negative, are counted in a [`Tally`].
//!
//! # Files
//! - `OpenEXR`: the data window of the only part, of scanlines or tiles, in any order, of any compression that the `exr`
//!   crate decodes. `R`, `G`, `B` may be of 16 or 32 bits, and are written with 32 in blocks of 16 rows without loss (ZIP). All
//!   other channels and the header are kept as they are, but for lower resolutions and the thumbnail, which are left out.
//! - Radiance: see [`radiance`]. `EXPOSURE` is kept from one Radiance picture to another and divided out for `OpenEXR`, so
//!   that both mean the same radiances; `COLORCORR` is always divided out. Other channels of an `OpenEXR` picture are left out.
//!   Scanlines may be rows or columns from any side; they stay so in a Radiance picture, while to `OpenEXR` columns are refused.
//!
//! Colours are taken to be in the space of the operator: chromaticities in the header are carried over, not looked at.

mod error;
mod exr_reader;
mod exr_writer;
pub mod radiance;
mod relighting;
pub mod rgbe;
mod rows;

use std::ffi::OsStr;
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Write};
use std::path::Path;

use rayon::prelude::*;

pub use error::RelightError;
pub use relighting::{Relighting, Tally};

use crate::image::{ImageError, write_atomic};
use exr_reader::ExrReader;
use exr_writer::ExrPlan;
use radiance::{RadianceHeader, RadianceReader, Resolution, Undo, encode_scanline};
use rows::Rows;
use spectral_core::bilinear::Tensor;

/// Pixels that are in memory at a time, to the nearest rows; at least 16 of these.
const BATCH: usize = 1 << 18;

/// Gives as many rows of the relit picture.
type Pull<'p> = &'p mut dyn FnMut(usize) -> io::Result<Rows>;

/// What was done to a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// The condition number of the division: at least 1, and 1 for white.
    pub condition: f64,
    /// Pixels without a good answer.
    pub tally: Tally,
    /// Channels that were copied, beside the colours.
    pub kept_channels: Vec<String>,
    /// Channels that the output can't hold.
    pub dropped_channels: Vec<String>,
}

/// Relights the picture `input` into `output`, whose name tells the format: `.exr`, `.hdr` or `.pic`.
///
/// `output` appears when it is complete, and may be `input` itself. The result doesn't depend on the number of threads.
/// `progress` is told how many of how many pixels have been done since it was told last.
///
/// # Errors
/// [`RelightError`]; what was at `output` then is still there.
pub fn relight(
    input: &Path,
    output: &Path,
    tensor: &Tensor<f64>,
    [from, to]: [[f64; 3]; 2],
    progress: &mut dyn FnMut(u64, u64),
) -> Result<Summary, RelightError> {
    if !to.iter().all(|c| c.is_finite()) {
        return Err(RelightError::Light(to));
    }
    let radiance = writes_radiance(output)?;
    let mut source = Source::open(input)?;
    let [width, height] = source.size();
    let pixels = width as u64 * height as u64;
    let relighting = Relighting::new(tensor, from, to).map_err(|reason| RelightError::Divisor {
        file: input.to_owned(),
        from,
        pixels,
        reason,
    })?;
    if !relighting.is_usable() {
        return Err(RelightError::Range);
    }
    let plan = Plan::new(input, &mut source, radiance)?;
    let [kept_channels, dropped_channels] = plan.channels(&source);
    let mut stage = Stage { relighting, limit: plan.limit(), file: input, done: 0, tally: Tally::default() };
    let mut failure = None;
    let mut pull = |count| {
        let rows = source.next_rows(count).and_then(|rows| stage.relight(rows));
        // The writers know errors of the system only.
        let rows = rows.map_err(|error| {
            failure = Some(error);
            io::Error::other("no more rows")
        })?;
        progress(rows.colours.len() as u64, pixels);
        Ok(rows)
    };
    let written = write_atomic(output, |file| plan.write(file, &mut pull));
    if let Some(error) = failure {
        return Err(error.into());
    }
    written?;
    Ok(Summary {
        width,
        height,
        condition: relighting.condition(),
        tally: stage.tally,
        kept_channels,
        dropped_channels,
    })
}

/// Whether the output's name is that of a Radiance picture, and not of an `OpenEXR` one.
fn writes_radiance(output: &Path) -> Result<bool, RelightError> {
    match output.extension().map(OsStr::to_ascii_lowercase) {
        Some(extension) if extension == "exr" => Ok(false),
        Some(extension) if extension == "hdr" || extension == "pic" => Ok(true),
        _ => Err(RelightError::Extension(output.to_owned())),
    }
}

/// Relights rows as they pass.
struct Stage<'f> {
    relighting: Relighting,
    limit: f32,
    file: &'f Path,
    /// Rows that have passed.
    done: usize,
    tally: Tally,
}

impl Stage<'_> {
    fn relight(&mut self, mut rows: Rows) -> Result<Rows, ImageError> {
        let relight = |row: &mut [[f32; 3]]| self.relighting.relight_row(row, self.limit);
        let tallies: Vec<_> = rows.colours.par_chunks_mut(rows.length).map(relight).collect();
        for (row, tally) in tallies.into_iter().enumerate() {
            self.tally = self.tally
                + tally.map_err(|[x, component]| ImageError::NotFinite {
                    file: self.file.to_owned(),
                    channel: ["R", "G", "B"][component].to_owned(),
                    x,
                    y: self.done + row,
                })?;
        }
        self.done += rows.count();
        Ok(rows)
    }
}

/// A picture that is read.
enum Source {
    Exr(Box<ExrReader>),
    Radiance(Box<RadianceReader<BufReader<File>>>),
}

impl Source {
    /// Tells the formats apart by their first bytes.
    fn open(file: &Path) -> Result<Self, ImageError> {
        let refuse = |source| ImageError::io(file, source);
        let mut magic = Vec::with_capacity(4);
        let head = File::open(file).map_err(refuse)?;
        (&head).take(4).read_to_end(&mut magic).map_err(refuse)?;
        match magic.as_slice() {
            [0x76, 0x2f, 0x31, 0x01] => Ok(Self::Exr(Box::new(ExrReader::open(file)?))),
            [b'#', b'?', ..] => {
                let input = BufReader::new(File::open(file).map_err(refuse)?);
                Ok(Self::Radiance(Box::new(RadianceReader::new(file, input)?)))
            }
            _ => Err(ImageError::unsupported(file, "neither an OpenEXR nor a Radiance picture")),
        }
    }

    fn size(&self) -> [usize; 2] {
        match self {
            Self::Exr(reader) => [reader.header().layer_size.width(), reader.header().layer_size.height()],
            Self::Radiance(reader) => reader.header().resolution.size(),
        }
    }

    /// The next rows of the file: `count` of them, or what is left.
    fn next_rows(&mut self, count: usize) -> Result<Rows, ImageError> {
        match self {
            Self::Exr(reader) => reader.next_rows(count),
            Self::Radiance(reader) => {
                let length = reader.header().resolution.length;
                let mut rows = Rows { length, ..Rows::default() };
                while rows.count() < count && reader.next_scanline(&mut rows.colours)? {}
                Ok(rows)
            }
        }
    }
}

/// A picture that is going to be written.
enum Plan {
    Exr(Box<ExrPlan>),
    Radiance(RadianceHeader),
}

impl Plan {
    fn new(input: &Path, source: &mut Source, radiance: bool) -> Result<Self, RelightError> {
        Ok(match (source, radiance) {
            (Source::Exr(reader), false) => {
                Self::Exr(Box::new(ExrPlan::like(reader.header(), reader.other_channels())))
            }
            (Source::Exr(reader), true) => Self::Radiance(radiance_header(reader)),
            (Source::Radiance(reader), false) => {
                let header = reader.header();
                if header.resolution.columns {
                    return Err(RelightError::Columns { file: input.to_owned(), resolution: header.resolution });
                }
                Self::Exr(Box::new(ExrPlan::radiance(header)))
            }
            (Source::Radiance(reader), true) => {
                reader.undo(Undo::ColourCorrection);
                Self::Radiance(reader.header().clone())
            }
        })
    }

    /// Channels that aren't colours: those that are kept, and those that are not.
    fn channels(&self, source: &Source) -> [Vec<String>; 2] {
        let Source::Exr(reader) = source else { return Default::default() };
        let others = reader.other_channels().map(|channel| channel.name.to_string()).collect();
        match self {
            Self::Exr(_) => [others, Vec::new()],
            Self::Radiance(_) => [Vec::new(), others],
        }
    }

    /// The largest number that the file holds.
    fn limit(&self) -> f32 {
        match self {
            Self::Exr(_) => f32::MAX,
            Self::Radiance(_) => rgbe::LARGEST,
        }
    }

    fn write(self, file: &mut BufWriter<File>, pull: Pull<'_>) -> io::Result<()> {
        match self {
            Self::Exr(plan) => plan.write(file, pull),
            Self::Radiance(header) => write_radiance(file, &header, pull),
        }
    }
}

/// The rows of a batch.
fn batch(length: usize) -> usize {
    (BATCH / length).max(16)
}

fn write_radiance(file: &mut impl Write, header: &RadianceHeader, pull: Pull<'_>) -> io::Result<()> {
    header.write(file)?;
    let Resolution { scanlines, length, .. } = header.resolution;
    let mut done = 0;
    while done < scanlines {
        let rows = pull(batch(length).min(scanlines - done))?;
        let encoded: Vec<_> = rows.colours.par_chunks(length).map(encode_scanline).collect();
        encoded.iter().try_for_each(|bytes| file.write_all(bytes))?;
        done += rows.count();
    }
    Ok(())
}

/// What a Radiance picture can say of an `OpenEXR` one.
fn radiance_header(reader: &ExrReader) -> RadianceHeader {
    let source = reader.header();
    let mut header = RadianceHeader::new(Resolution::rows(source.layer_size.width(), source.layer_size.height()));
    let shared = &source.shared_attributes;
    let aspect = 1.0 / shared.pixel_aspect;
    if aspect != 1.0 && aspect > 0.0 && aspect.is_finite() {
        header.lines.push(format!("PIXASPECT={aspect}").into_bytes());
    }
    if let Some(c) = shared.chromaticities {
        let points = [c.red, c.green, c.blue, c.white].map(|point| format!("{} {}", point.x(), point.y()));
        header.lines.push(format!("PRIMARIES={}", points.join(" ")).into_bytes());
    }
    header
}
