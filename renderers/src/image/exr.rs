//! `OpenEXR` files: linear 32-bit floats, bit for bit.

use super::png::check_finite;
use super::raster::area;
use super::{ImageError, Picture, ScalarMap, write_atomic};
use ::exr::error::Error as Codec;
use ::exr::image::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer};
use ::exr::math::Vec2;
use ::exr::meta::attribute::{AttributeValue, Chromaticities, Text};
use ::exr::meta::header::LayerAttributes;
use ::exr::prelude::{ReadChannels, ReadLayers, WritableImage, read};
use spectral_core::colour::rgb::{PRIMARIES, WHITE_CHROMATICITY};
use std::io;
use std::path::Path;

/// What is in an `OpenEXR` file: a picture, its other channels and its texts.
#[derive(Clone, Debug, PartialEq)]
pub struct ExrPicture {
    /// The channels `R`, `G`, `B`.
    pub picture: Picture,
    /// All other channels with their names, in the file's (alphabetical) order.
    pub channels: Vec<(String, ScalarMap)>,
    /// The attributes that are texts, with their names, sorted.
    pub attributes: Vec<(String, String)>,
}

/// Writes a picture as `OpenEXR`: channels `R`, `G`, `B` of 32-bit floats, bit for bit, compressed without loss (ZIP).
///
/// `channels` go beside them under their names, and `attributes` (name, text) into the header, which also gets the
/// chromaticities of Rec. 709. Names that the format uses itself, such as `channels`, can't be given to an attribute,
/// but for `capDate`, `comments`, `owner` and `software`.
///
/// # Errors
/// [`ImageError::NotFinite`] for a pixel that is infinite or NaN: such a value is a mistake of its maker, and spoils
/// every mean; [`ImageError::ChannelSize`]; [`ImageError::Name`]; [`ImageError::Io`].
pub fn write_exr(
    path: &Path,
    picture: &Picture,
    channels: &[(&str, &ScalarMap)],
    attributes: &[(&str, &str)],
) -> Result<(), ImageError> {
    check_finite(path, picture)?;
    let mut list = Vec::with_capacity(3 + channels.len());
    for (index, name) in ["R", "G", "B"].into_iter().enumerate() {
        list.push((Text::from(name), picture.pixels().iter().map(|pixel| pixel[index]).collect()));
    }
    for &(name, map) in channels {
        let name = checked_name(path, name, list.iter().map(|(other, _)| other))?;
        check_channel(path, picture, &name.to_string(), map)?;
        list.push((name, map.pixels().to_vec()));
    }
    let size = [picture.width(), picture.height()];
    write_image(path, &layered(size, list, checked_attributes(path, attributes)?))
}

fn write_image(path: &Path, image: &FlatImage) -> Result<(), ImageError> {
    write_atomic(path, |file| {
        image.write().to_buffered(file).map_err(|error| match error {
            Codec::Io(source) => source,
            Codec::Invalid(reason) => io::Error::new(io::ErrorKind::InvalidInput, reason),
            other => io::Error::other(other),
        })
    })
}

/// Writes channels without colours as `OpenEXR`, in 32-bit floats, bit for bit, compressed without loss (ZIP): numbers that are not finite,
/// too, of which NaN says that there is no value.
///
/// # Errors
/// [`ImageError::ChannelSize`]; [`ImageError::Name`]; [`ImageError::Size`] without channels; [`ImageError::Io`].
pub fn write_exr_channels(
    path: &Path,
    channels: &[(&str, &ScalarMap)],
    attributes: &[(&str, &str)],
) -> Result<(), ImageError> {
    let Some((_, first)) = channels.first() else { return Err(ImageError::Size { width: 0, height: 0 }) };
    let size = [first.width(), first.height()];
    if let Some((name, _)) = channels.iter().find(|(_, map)| !first.same_size(map)) {
        return Err(ImageError::ChannelSize { file: path.to_owned(), channel: (*name).to_owned() });
    }
    let channels = channels.iter().map(|(name, map)| ((*name).to_owned(), (*map).clone())).collect();
    write_layer(path, size, channels, attributes)
}

/// Writes channels that are all of one size.
pub(super) fn write_layer(
    path: &Path,
    size: [usize; 2],
    channels: Vec<(String, ScalarMap)>,
    attributes: &[(&str, &str)],
) -> Result<(), ImageError> {
    let mut list: Vec<(Text, Vec<f32>)> = Vec::with_capacity(channels.len());
    for (name, map) in channels {
        let name = checked_name(path, &name, list.iter().map(|(other, _)| other))?;
        list.push((name, map.into_pixels()));
    }
    write_image(path, &layered(size, list, checked_attributes(path, attributes)?))
}

type FlatImage = Image<Layer<AnyChannels<FlatSamples>>>;

fn layered([width, height]: [usize; 2], channels: Vec<(Text, Vec<f32>)>, own: LayerAttributes) -> FlatImage {
    let channels =
        channels.into_iter().map(|(name, samples)| AnyChannel::new(name, FlatSamples::F32(samples))).collect();
    let size = Vec2(width, height);
    // Sixteen rows a block: a good ratio, and other readers know it.
    let layer = Layer::new(size, own, Encoding::SMALL_LOSSLESS, AnyChannels::sort(channels));
    let mut image = Image::from_layer(layer);
    image.attributes.chromaticities = Some(rec_709());
    image
}

fn rec_709() -> Chromaticities {
    #[allow(clippy::cast_possible_truncation, reason = "the format holds f32")]
    let [red, green, blue, white] =
        [PRIMARIES[0], PRIMARIES[1], PRIMARIES[2], WHITE_CHROMATICITY].map(|[x, y]| Vec2(x as f32, y as f32));
    Chromaticities { red, green, blue, white }
}

fn check_channel(file: &Path, picture: &Picture, name: &str, map: &ScalarMap) -> Result<(), ImageError> {
    let (file, channel) = (file.to_owned(), name.to_owned());
    if !picture.same_size(map) {
        return Err(ImageError::ChannelSize { file, channel });
    }
    if let Some(index) = map.pixels().iter().position(|value| !value.is_finite()) {
        let (x, y) = map.position(index);
        return Err(ImageError::NotFinite { file, channel, x, y });
    }
    Ok(())
}

const OUTSIDE_LATIN_1: &str = "has a character outside Latin-1";

/// Names in `OpenEXR` are of 1 to 255 Latin-1 characters here (31 in files of old readers), each given once.
fn checked_name<'t>(file: &Path, name: &str, mut taken: impl Iterator<Item = &'t Text>) -> Result<Text, ImageError> {
    let refuse = |reason| ImageError::Name { file: file.to_owned(), name: name.to_owned(), reason };
    let text = Text::new_or_none(name).ok_or_else(|| refuse(OUTSIDE_LATIN_1))?;
    match text.as_slice().len() {
        0 => Err(refuse("is an empty name")),
        1..=255 if name.contains('\0') => Err(refuse("has a null character")),
        1..=255 if taken.any(|other| *other == text) => Err(refuse("is given twice")),
        1..=255 => Ok(text),
        _ => Err(refuse("is longer than 255 characters")),
    }
}

/// The texts that the format knows by name, beside those that are free.
fn standard_text<'a>(name: &str, own: &'a mut LayerAttributes) -> Option<&'a mut Option<Text>> {
    match name {
        "capDate" => Some(&mut own.capture_date),
        "comments" => Some(&mut own.comments),
        "owner" => Some(&mut own.owner),
        "software" => Some(&mut own.software_name),
        _ => None,
    }
}

fn checked_attributes(file: &Path, attributes: &[(&str, &str)]) -> Result<LayerAttributes, ImageError> {
    let mut own = LayerAttributes::default();
    let mut names: Vec<Text> = Vec::with_capacity(attributes.len());
    for &(name, value) in attributes {
        let key = checked_name(file, name, names.iter())?;
        let text = Text::new_or_none(value).ok_or_else(|| ImageError::Name {
            file: file.to_owned(),
            name: value.to_owned(),
            reason: OUTSIDE_LATIN_1,
        })?;
        names.push(key.clone());
        match standard_text(name, &mut own) {
            Some(standard) => *standard = Some(text),
            None => drop(own.other.insert(key, AttributeValue::Text(text))),
        }
    }
    Ok(own)
}

/// Reads an `OpenEXR` file: the first layer that is flat, at its full resolution, of any lossless or lossy compression
/// that the `exr` crate decodes, samples converted to `f32` exactly (16-bit floats) or to nearest (integers).
///
/// Colours are taken as they are: chromaticities in the header are not looked at. The picture is the data window.
///
/// # Errors
/// [`ImageError::Io`]; [`ImageError::Malformed`]; [`ImageError::Unsupported`] (deep data, subsampled channels);
/// [`ImageError::MissingChannel`] if `R`, `G` or `B` is not there; [`ImageError::Size`]; [`ImageError::NotFinite`].
pub fn read_exr(path: &Path) -> Result<ExrPicture, ImageError> {
    let Channels { mut channels, attributes, .. } = read_channels(path)?;
    let picture = colours(path, &mut channels)?;
    for (name, map) in &channels {
        check_channel(path, &picture, name, map)?;
    }
    Ok(ExrPicture { picture, channels, attributes })
}

/// The channels of an `OpenEXR` file.
#[derive(Clone, Debug, PartialEq)]
pub struct Channels {
    /// Pixels in a row, and rows.
    pub size: [usize; 2],
    /// All channels with their names, in the file's (alphabetical) order.
    pub channels: Vec<(String, ScalarMap)>,
    /// The attributes that are texts, with their names, sorted.
    pub attributes: Vec<(String, String)>,
}

/// Reads the channels of an `OpenEXR` file as [`read_exr`] does, whichever they are, and numbers that are not finite, too.
///
/// # Errors
/// As [`read_exr`], but for missing channels and numbers that are not finite.
pub fn read_channels(path: &Path) -> Result<Channels, ImageError> {
    let image = decode(path)?;
    let Layer { channel_data, attributes, size, .. } = image.layer_data;
    let mut channels = Vec::with_capacity(channel_data.list.len());
    for channel in channel_data.list {
        let name = channel.name.to_string();
        if channel.sampling != Vec2(1, 1) {
            return Err(ImageError::unsupported(path, format_args!("channel `{name}` is subsampled")));
        }
        let samples = match channel.sample_data {
            FlatSamples::F32(samples) => samples,
            other => other.values_as_f32().collect(),
        };
        channels.push((name, ScalarMap::from_pixels(size.width(), size.height(), samples)?));
    }
    Ok(Channels { size: [size.width(), size.height()], channels, attributes: texts(&attributes) })
}

/// How many bytes of pixels a byte of a file can stand for at most: ZIP has 1032.
const MOST_COMPRESSED: u64 = 4096;

fn decode(path: &Path) -> Result<FlatImage, ImageError> {
    let refuse = |error| match error {
        Codec::Io(source) => ImageError::io(path, source),
        Codec::NotSupported(reason) => ImageError::unsupported(path, reason),
        other => ImageError::malformed(path, other),
    };
    // The header first: sizes are checked before memory is asked for.
    let meta = ::exr::meta::MetaData::read_from_file(path, false).map_err(refuse)?;
    let length = std::fs::metadata(path).map_err(|source| ImageError::io(path, source))?.len();
    for header in &meta.headers {
        let pixels = area(header.layer_size.width(), header.layer_size.height())? as u64;
        let bytes = pixels.saturating_mul(header.channels.bytes_per_pixel as u64);
        if bytes > length.saturating_mul(MOST_COMPRESSED).saturating_add(1 << 20) {
            return Err(ImageError::malformed(path, format_args!("{length} bytes can't hold {bytes} bytes of pixels")));
        }
    }
    read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_file(path)
        .map_err(refuse)
}

/// Takes `R`, `G` and `B` out of the channels.
fn colours(file: &Path, channels: &mut Vec<(String, ScalarMap)>) -> Result<Picture, ImageError> {
    let mut take = |wanted: &str| match channels.iter().position(|(name, _)| name == wanted) {
        Some(index) => Ok(channels.remove(index).1),
        None => Err(ImageError::MissingChannel { file: file.to_owned(), channel: wanted.to_owned() }),
    };
    let (red, green, blue) = (take("R")?, take("G")?, take("B")?);
    let pixels = red.pixels().iter().zip(green.pixels()).zip(blue.pixels()).map(|((&r, &g), &b)| [r, g, b]).collect();
    let picture = Picture::from_pixels(red.width(), red.height(), pixels)?;
    check_finite(file, &picture)?;
    Ok(picture)
}

fn texts(attributes: &LayerAttributes) -> Vec<(String, String)> {
    let mut texts: Vec<_> = attributes
        .other
        .iter()
        .filter_map(|(name, value)| match value {
            AttributeValue::Text(text) => Some((name.to_string(), text.to_string())),
            _ => None,
        })
        .collect();
    let mut own = attributes.clone();
    for name in ["capDate", "comments", "owner", "software"] {
        let text = standard_text(name, &mut own).and_then(Option::take);
        texts.extend(text.map(|text| (name.to_owned(), text.to_string())));
    }
    texts.sort();
    texts
}
