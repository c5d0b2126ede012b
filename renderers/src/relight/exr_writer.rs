//! `OpenEXR` pictures from rows.

use std::io::{self, Seek, Write};

use ::exr::block::writer::ChunksWriter;
use ::exr::block::{self, BlockIndex, UncompressedBlock};
use ::exr::compression::Compression;
use ::exr::error::Error as Codec;
use ::exr::math::Vec2;
use ::exr::meta::attribute::{ChannelDescription, Chromaticities, LineOrder, SampleType, Text};
use ::exr::meta::header::{Header, standard_names};
use ::exr::meta::{BlockDescription, MetaData};
use ::exr::prelude::SmallVec;
use rayon::prelude::*;

use super::radiance::RadianceHeader;
use super::rows::Rows;
use super::{Pull, batch};

/// Rows that are compressed together.
const BLOCK: usize = 16;

/// A picture that is going to be written: 32-bit colours, other channels as they were, compressed without loss (ZIP) in
/// blocks of 16 rows.
pub(super) struct ExrPlan {
    header: Header,
    /// For each channel of the file: a component, or the index of another channel.
    order: Vec<Sample>,
    /// Whether rows come from the bottom, and whether pixels come from the right.
    last_first: bool,
    backwards: bool,
}

#[derive(Clone, Copy)]
enum Sample {
    Colour(usize),
    Other(usize),
}

impl ExrPlan {
    /// A picture like another one, with all that its header says but for the thumbnail.
    pub(super) fn like<'c>(source: &Header, others: impl Iterator<Item = &'c ChannelDescription>) -> Self {
        let mut plan = Self::of([source.layer_size.width(), source.layer_size.height()], others.cloned());
        let mut own = source.own_attributes.clone();
        own.preview = None;
        let mut shared = source.shared_attributes.clone();
        // Standard names with values of another type can be read, but not written again.
        for &name in standard_names::ALL {
            if let Some(name) = core::str::from_utf8(name).ok().and_then(Text::new_or_none) {
                own.other.remove(&name);
                shared.other.remove(&name);
            }
        }
        plan.header = plan.header.with_attributes(own).with_shared_attributes(shared);
        plan
    }

    /// A Radiance picture of rows.
    pub(super) fn radiance(source: &RadianceHeader) -> Self {
        let mut plan = Self::of(source.resolution.size(), core::iter::empty());
        plan.last_first = source.resolution.last_first;
        plan.backwards = source.resolution.backwards;
        #[allow(clippy::cast_possible_truncation, reason = "the format holds f32")]
        {
            // Width by height here.
            plan.header.shared_attributes.pixel_aspect = (1.0 / source.pixel_aspect) as f32;
            plan.header.shared_attributes.chromaticities = source.primaries.map(|p| {
                let [rx, ry, gx, gy, bx, by, wx, wy] = p.map(|value| value as f32);
                Chromaticities { red: Vec2(rx, ry), green: Vec2(gx, gy), blue: Vec2(bx, by), white: Vec2(wx, wy) }
            });
        }
        plan
    }

    fn of([width, height]: [usize; 2], others: impl Iterator<Item = ChannelDescription>) -> Self {
        let colour = |(index, name)| (ChannelDescription::new(name, SampleType::F32, false), Sample::Colour(index));
        let other = |(index, channel)| (channel, Sample::Other(index));
        let mut channels: Vec<_> = ["R", "G", "B"].into_iter().enumerate().map(colour).collect();
        channels.extend(others.enumerate().map(other));
        // The format wants them sorted.
        channels.sort_by(|(a, _), (b, _)| a.name.cmp(&b.name));
        let order = channels.iter().map(|(_, sample)| *sample).collect();
        let channels: SmallVec<[_; 5]> = channels.into_iter().map(|(channel, _)| channel).collect();
        let mut header = Header::new(Text::default(), Vec2(width, height), channels).with_encoding(
            Compression::ZIP16,
            BlockDescription::ScanLines,
            LineOrder::Increasing,
        );
        header.own_attributes.layer_name = None;
        Self { header, order, last_first: false, backwards: false }
    }

    /// Writes the picture, a batch of rows at a time.
    pub(super) fn write<W: Write + Seek>(mut self, out: W, pull: Pull<'_>) -> io::Result<()> {
        if self.last_first {
            self.header.line_order = LineOrder::Decreasing;
        }
        let header = self.header.clone();
        let written = block::write(out, SmallVec::from_iter([header]), true, |meta, chunks| {
            let height = self.header.layer_size.height();
            let batch = batch(self.header.layer_size.width()) / BLOCK * BLOCK;
            let mut done = 0;
            while done < height {
                // From the bottom, blocks are still aligned to the top.
                let aligned = if self.last_first && done == 0 { (height - 1) % BLOCK + 1 } else { batch };
                let mut rows = pull(aligned.min(height - done))?;
                let count = rows.count();
                let top = if self.last_first { height - done - count } else { done };
                self.orient(&mut rows);
                for (index, chunk) in self.compress(&meta, &rows, top) {
                    chunks.write_chunk(index, chunk?)?;
                }
                done += count;
            }
            Ok(())
        });
        written.map_err(|error| match error {
            Codec::Io(source) => source,
            Codec::Invalid(reason) => io::Error::new(io::ErrorKind::InvalidInput, reason),
            other => io::Error::other(other),
        })
    }

    /// Turns rows so that the first one is at the top and begins at the left.
    fn orient(&self, rows: &mut Rows) {
        // Radiance pictures have no other channels.
        if self.last_first != self.backwards {
            rows.colours.chunks_exact_mut(rows.length).for_each(<[_]>::reverse);
        }
        if self.last_first {
            rows.colours.reverse();
        }
    }

    /// The blocks of some rows with their indices, in the order in which they are to be written.
    fn compress(&self, meta: &MetaData, rows: &Rows, top: usize) -> Vec<(usize, Result<block::chunk::Chunk, Codec>)> {
        let blocks = rows.count().div_ceil(BLOCK);
        let one = |index: usize| {
            let first = index * BLOCK;
            let size = Vec2(rows.length, BLOCK.min(rows.count() - first));
            let index =
                BlockIndex { layer: 0, pixel_position: Vec2(0, top + first), pixel_size: size, level: Vec2(0, 0) };
            let block = UncompressedBlock { index, data: self.pack(rows, first, size.height()) };
            ((top + first) / BLOCK, block.compress_to_chunk(&meta.headers))
        };
        let mut chunks: Vec<_> = (0..blocks).into_par_iter().map(one).collect();
        if self.last_first {
            chunks.reverse();
        }
        chunks
    }

    /// The samples of some rows: of each row, channel by channel.
    fn pack(&self, rows: &Rows, first: usize, count: usize) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(count * rows.length * self.header.channels.bytes_per_pixel);
        for row in first..first + count {
            let pixels = row * rows.length..(row + 1) * rows.length;
            for sample in &self.order {
                match *sample {
                    Sample::Colour(index) => {
                        bytes
                            .extend(rows.colours[pixels.clone()].iter().flat_map(|colour| colour[index].to_ne_bytes()));
                    }
                    Sample::Other(index) => {
                        let plane = &rows.others[index];
                        bytes.extend(&plane.bytes[pixels.start * plane.width..pixels.end * plane.width]);
                    }
                }
            }
        }
        bytes
    }
}
