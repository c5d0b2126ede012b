//! `OpenEXR` pictures, some rows at a time from the top.

use core::fmt;
use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use ::exr::block::UncompressedBlock;
use ::exr::block::chunk::{Chunk, CompressedBlock};
use ::exr::error::Error as Codec;
use ::exr::math::Vec2;
use ::exr::meta::MetaData;
use ::exr::meta::attribute::{ChannelDescription, SampleType};
use ::exr::meta::header::Header;
use ::exr::prelude::f16;
use rayon::prelude::*;

use super::radiance::MAX_SIDE;
use super::rows::{Plane, Rows};
use crate::image::ImageError;

/// What a row of tiles, or the rows that are compressed together, may take in memory, in bytes.
pub(super) const MAX_BAND: usize = 1 << 26;

const COLOURS: [&str; 3] = ["R", "G", "B"];

/// Reads blocks where the table of offsets says they are, so that rows come from the top whatever their order in the file.
#[derive(Debug)]
pub(super) struct ExrReader {
    file: PathBuf,
    input: BufReader<File>,
    meta: MetaData,
    layout: Layout,
    /// Blocks side by side and on top of each other; pixels of a full one.
    blocks: [usize; 2],
    block_size: [usize; 2],
    offsets: Vec<u64>,
    /// Rows of blocks that have been read.
    done: usize,
    pending: Rows,
}

/// Where a pixel's samples are within the samples of a row, which is stored channel by channel.
#[derive(Clone, Debug)]
struct Layout {
    /// Bytes of a pixel.
    bytes: usize,
    /// Bytes of a pixel in the channels before, for R, G, B; and whether samples are of 16 bits.
    colours: [(usize, bool); 3],
    /// The same for all other channels, with the bytes of a sample.
    others: Vec<(usize, usize)>,
}

impl ExrReader {
    /// Reads the header and the table of offsets.
    pub(super) fn open(file: &Path) -> Result<Self, ImageError> {
        let mut input = BufReader::new(File::open(file).map_err(|source| ImageError::io(file, source))?);
        let refuse = |error| refused(file, error);
        let meta = MetaData::read_from_buffered(&mut input, false).map_err(refuse)?;
        MetaData::validate(&meta.headers, false).map_err(refuse)?;
        let [header] = meta.headers.as_slice() else {
            return Err(ImageError::unsupported(file, "more than one part"));
        };
        let [width, height] = [header.layer_size.width(), header.layer_size.height()];
        if !([width, height].iter().all(|side| (1..=MAX_SIDE).contains(side))) {
            let size = format_args!("a picture of {width} × {height} pixels, for sides up to {MAX_SIDE}");
            return Err(ImageError::unsupported(file, size));
        }
        let layout = Layout::new(file, header)?;
        let block_size = [header.max_block_pixel_size().width(), header.max_block_pixel_size().height()];
        if block_size.contains(&0) {
            return Err(ImageError::malformed(file, "tiles without pixels"));
        }
        let blocks = [width.div_ceil(block_size[0]), height.div_ceil(block_size[1])];
        let band = [blocks[0], block_size[0], block_size[1].min(height), layout.bytes.max(size_of::<[f32; 3]>())];
        if band.into_iter().try_fold(1, usize::checked_mul).is_none_or(|bytes| bytes > MAX_BAND) {
            let [across, down] = block_size;
            return Err(ImageError::unsupported(
                file,
                format_args!(
                    "blocks of {across} × {down} pixels: a row of them takes more than {} MiB",
                    MAX_BAND >> 20
                ),
            ));
        }
        let offsets = read_offsets(&mut input, blocks[0] * blocks[1])
            .map_err(|error| refused(file, Codec::from(error)))?
            .ok_or_else(|| ImageError::malformed(file, "the table of blocks is not complete"))?;
        let others = layout.others.iter().map(|(_, width)| Plane { width: *width, bytes: Vec::new() }).collect();
        let pending = Rows { length: width, colours: Vec::new(), others };
        Ok(Self { file: file.to_owned(), input, layout, blocks, block_size, offsets, done: 0, pending, meta })
    }

    /// The header; there is one.
    pub(super) fn header(&self) -> &Header {
        &self.meta.headers[0]
    }

    /// The channels that aren't R, G or B, in the order of [`Rows::others`].
    pub(super) fn other_channels(&self) -> impl Iterator<Item = &ChannelDescription> {
        self.header().channels.list.iter().filter(|channel| !COLOURS.iter().any(|name| channel.name.eq(name)))
    }

    /// The next rows: `count` of them, or what is left.
    pub(super) fn next_rows(&mut self, count: usize) -> Result<Rows, ImageError> {
        while self.pending.count() < count && self.done < self.blocks[1] {
            let wanted = (count - self.pending.count()).div_ceil(self.block_size[1]);
            let end = (self.done + wanted.max(1)).min(self.blocks[1]);
            self.read_blocks(end)?;
        }
        Ok(self.pending.take(count))
    }

    /// Appends the rows of blocks up to `end` to those that are pending.
    fn read_blocks(&mut self, end: usize) -> Result<(), ImageError> {
        let indices = self.done * self.blocks[0]..end * self.blocks[0];
        let chunks = indices.map(|index| self.read_chunk(index)).collect::<Result<Vec<_>, _>>()?;
        let decompress = |chunk| UncompressedBlock::decompress_chunk(chunk, &self.meta, false);
        let blocks: Vec<_> = chunks.into_par_iter().map(decompress).collect();
        let top = self.done * self.block_size[1];
        let bottom = (end * self.block_size[1]).min(self.header().layer_size.height());
        let first = self.pending.grow(bottom - top);
        for block in blocks {
            let block = block.map_err(|error| refused(&self.file, error))?;
            self.layout.unpack(&block, first, top, &mut self.pending);
        }
        self.done = end;
        Ok(())
    }

    /// Reads a block of the first level of resolution, from which all others are made, and checks that it is the one.
    fn read_chunk(&mut self, index: usize) -> Result<Chunk, ImageError> {
        let damaged =
            |what: &dyn fmt::Display| ImageError::malformed(&self.file, format_args!("block {index}: {what}"));
        self.input.seek_to(self.offsets[index]).map_err(|source| ImageError::io(&self.file, source))?;
        let chunk = Chunk::read(&mut self.input, &self.meta).map_err(|error| match error {
            Codec::Io(source) => ImageError::io(&self.file, source),
            other => damaged(&other),
        })?;
        let header = &self.meta.headers[0];
        let [x, y] = [index % self.blocks[0], index / self.blocks[0]];
        let here = match &chunk.compressed_block {
            CompressedBlock::Tile(tile) => {
                tile.coordinates.tile_index == Vec2(x, y) && tile.coordinates.level_index == Vec2(0, 0)
            }
            CompressedBlock::ScanLine(lines) => {
                let top = i64::from(header.own_attributes.layer_position.y());
                usize::try_from(i64::from(lines.y_coordinate) - top) == Ok(y * self.block_size[1])
            }
            _ => false,
        };
        if here { Ok(chunk) } else { Err(damaged(&"it is another block than it should be")) }
    }
}

/// Seeks that keep what has been read ahead where they can.
trait SeekTo {
    fn seek_to(&mut self, position: u64) -> std::io::Result<()>;
}

impl SeekTo for BufReader<File> {
    fn seek_to(&mut self, position: u64) -> std::io::Result<()> {
        let here = self.stream_position()?;
        let distance = i128::from(position) - i128::from(here);
        match i64::try_from(distance) {
            Ok(distance) => self.seek_relative(distance),
            Err(_) => self.seek(SeekFrom::Start(position)).map(drop),
        }
    }
}

/// The table of offsets, of which there are `count` for the first level; `None` where a block was never written.
fn read_offsets(input: &mut BufReader<File>, count: usize) -> std::io::Result<Option<Vec<u64>>> {
    let mut offsets = Vec::new();
    for _ in 0..count {
        let mut bytes = [0; 8];
        input.read_exact(&mut bytes)?;
        offsets.push(u64::from_le_bytes(bytes));
    }
    let start = input.stream_position()?;
    Ok(offsets.iter().all(|offset| *offset >= start).then_some(offsets))
}

pub(super) fn refused(file: &Path, error: Codec) -> ImageError {
    match error {
        Codec::Io(source) => ImageError::io(file, source),
        Codec::NotSupported(reason) => ImageError::unsupported(file, reason),
        other => ImageError::malformed(file, other),
    }
}

impl Layout {
    fn new(file: &Path, header: &Header) -> Result<Self, ImageError> {
        let mut colours = [None; 3];
        let mut others = Vec::new();
        for (offset, channel) in header.channels.channels_with_byte_offset() {
            let refuse = |what| ImageError::unsupported(file, format_args!("channel `{}` {what}", channel.name));
            if channel.sampling != Vec2(1, 1) {
                return Err(refuse("is subsampled"));
            }
            match COLOURS.iter().position(|name| channel.name.eq(name)) {
                None => others.push((offset, channel.sample_type.bytes_per_sample())),
                Some(_) if channel.sample_type == SampleType::U32 => return Err(refuse("is of integers")),
                Some(index) => colours[index] = Some((offset, channel.sample_type == SampleType::F16)),
            }
        }
        let found = |index: usize| {
            let missing = || ImageError::MissingChannel { file: file.to_owned(), channel: COLOURS[index].to_owned() };
            colours[index].ok_or_else(missing)
        };
        let colours = [found(0)?, found(1)?, found(2)?];
        Ok(Self { bytes: header.channels.bytes_per_pixel, colours, others })
    }

    /// Puts a block in its place; `first` is the index of the first pixel of row `top`.
    fn unpack(&self, block: &UncompressedBlock, first: usize, top: usize, rows: &mut Rows) {
        let (Vec2(left, y), Vec2(width, _)) = (block.index.pixel_position, block.index.pixel_size);
        for (line, samples) in block.data.chunks_exact(width * self.bytes).enumerate() {
            let start = first + (y - top + line) * rows.length + left;
            let pixels = &mut rows.colours[start..start + width];
            for (index, (offset, half)) in self.colours.iter().enumerate() {
                read_samples(&samples[width * offset..], *half, pixels, index);
            }
            for ((offset, bytes), plane) in self.others.iter().zip(&mut rows.others) {
                let from = &samples[width * offset..width * (offset + bytes)];
                plane.bytes[start * bytes..(start + width) * bytes].copy_from_slice(from);
            }
        }
    }
}

fn read_samples(bytes: &[u8], half: bool, pixels: &mut [[f32; 3]], index: usize) {
    if half {
        for (pixel, bytes) in pixels.iter_mut().zip(bytes.as_chunks().0) {
            pixel[index] = f16::from_ne_bytes(*bytes).to_f32();
        }
    } else {
        for (pixel, bytes) in pixels.iter_mut().zip(bytes.as_chunks().0) {
            pixel[index] = f32::from_ne_bytes(*bytes);
        }
    }
}
