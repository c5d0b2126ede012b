//! Relighting from file to file: every format into every other, orientations, encodings, damage, memory.
#![allow(clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail by panicking")]
#![allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, reason = "small test pictures")]

use core::result::Result;
use std::fs;
use std::path::{Path, PathBuf};

use exr::prelude::*;
use renderers::image::{ImageError, Picture, Raster, read_exr, write_exr};
use renderers::relight::radiance::{RadianceHeader, RadianceReader, Resolution, Undo, encode_scanline};
use renderers::relight::{RelightError, Relighting, Summary, relight, rgbe};
use spectral_core::bilinear::{DivisorError, Tensor};
use spectral_tests::statistics::Rng;

const SKY: [f64; 3] = [0.4, 0.9, 1.0];
const YELLOW: [f64; 3] = [1.0, 0.9, 0.1];

fn fresh(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("relight_files").join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Colours over many orders of magnitude, saturated ones among them.
fn varied(width: usize, height: usize) -> Picture {
    let mut rng = Rng::new(7);
    let pixels = (0..width * height).map(|_| {
        let scale = 10.0_f32.powf(8.0 * rng.unit_f32() - 4.0);
        [rng.unit_f32(), rng.unit_f32(), rng.unit_f32()].map(|c| scale * c * c)
    });
    Picture::from_pixels(width, height, pixels.collect()).unwrap()
}

/// What relighting should make of a picture.
fn expected(picture: &Picture, tensor: &Tensor<f64>) -> Picture {
    let relighting = Relighting::new(tensor, SKY, YELLOW).unwrap();
    picture.map(|pixel| relighting.relit(pixel.map(f64::from)).map(|c| c as f32))
}

/// As a Radiance file has it.
fn in_rgbe(picture: &Picture) -> Picture {
    picture.map(|pixel| rgbe::decode(rgbe::encode(*pixel)).map(|c| c as f32))
}

fn go(input: &Path, output: &Path) -> Result<Summary, RelightError> {
    relight(input, output, &Tensor::rec_709(), [SKY, YELLOW], &mut |_, _| {})
}

fn write_radiance(path: &Path, header: &RadianceHeader, scanlines: impl Iterator<Item = Vec<[f32; 3]>>) {
    let mut bytes = Vec::new();
    header.write(&mut bytes).unwrap();
    scanlines.for_each(|line| bytes.extend(encode_scanline(&line)));
    fs::write(path, bytes).unwrap();
}

fn write_rows(path: &Path, picture: &Picture) {
    let header = RadianceHeader::new(Resolution::rows(picture.width(), picture.height()));
    write_radiance(path, &header, picture.pixels().chunks(picture.width()).map(<[_]>::to_vec));
}

/// The picture of a Radiance file with all its scanlines as rows, and its header.
fn read_radiance(path: &Path) -> (Picture, RadianceHeader) {
    let bytes = fs::read(path).unwrap();
    let mut reader = RadianceReader::new(path, bytes.as_slice()).unwrap();
    let mut pixels = Vec::new();
    while reader.next_scanline(&mut pixels).unwrap() {}
    let Resolution { length, scanlines, .. } = reader.header().resolution;
    (Picture::from_pixels(length, scanlines, pixels).unwrap(), reader.header().clone())
}

#[test]
fn every_format_becomes_every_other() {
    let folder = fresh("formats");
    // More than a block, none of them full; wide enough for runs, and too narrow for them.
    for [width, height] in [[70, 37], [5, 17], [1, 1]] {
        let picture = varied(width, height);
        let [exr, hdr] = [folder.join("in.exr"), folder.join("in.hdr")];
        write_exr(&exr, &picture, &[], &[]).unwrap();
        write_rows(&hdr, &picture);
        for (input, source) in [(&exr, picture.clone()), (&hdr, in_rgbe(&picture))] {
            let right = expected(&source, &Tensor::rec_709());
            let summary = go(input, &folder.join("out.exr")).unwrap();
            assert_eq!([summary.width, summary.height], [width, height]);
            assert_eq!(read_exr(&folder.join("out.exr")).unwrap().picture, right);
            for name in ["out.hdr", "out.PIC"] {
                assert_eq!(go(input, &folder.join(name)).unwrap(), summary);
                assert_eq!(read_radiance(&folder.join(name)).0, in_rgbe(&right));
            }
            let negative = right.pixels().iter().filter(|p| p.iter().any(|c| *c < 0.0)).count();
            assert_eq!(summary.tally.negative, negative as u64);
        }
    }
    assert_eq!(names(&folder), ["in.exr", "in.hdr", "out.PIC", "out.exr", "out.hdr"], "nothing is left behind");
}

#[test]
fn a_light_for_itself_changes_no_byte() {
    let folder = fresh("identity");
    let [hdr, exr] = [folder.join("a.hdr"), folder.join("a.exr")];
    write_rows(&hdr, &varied(64, 20));
    let before = fs::read(&hdr).unwrap();
    // In place, too.
    relight(&hdr, &hdr, &Tensor::rec_709(), [SKY, SKY], &mut |_, _| {}).unwrap();
    assert!(fs::read(&hdr).unwrap() == before);
    relight(&hdr, &exr, &Tensor::classical(), [SKY, SKY], &mut |_, _| {}).unwrap();
    fs::remove_file(&hdr).unwrap();
    relight(&exr, &hdr, &Tensor::iso_rgb(), [YELLOW, YELLOW], &mut |_, _| {}).unwrap();
    assert!(fs::read(&hdr).unwrap() == before);
}

#[test]
fn all_orientations_show_the_same_picture() {
    let folder = fresh("orientations");
    let [width, height] = [11, 35];
    let picture = varied(width, height);
    let right = expected(&in_rgbe(&picture), &Tensor::rec_709());
    for case in 0..8_u8 {
        let [columns, last_first, backwards] = [0, 1, 2].map(|bit| case >> bit & 1 == 1);
        let [scanlines, length] = if columns { [width, height] } else { [height, width] };
        let resolution = Resolution { columns, last_first, backwards, scanlines, length };
        // Y points upwards, so that "-Y" is from the top.
        let at = |first: usize, second: usize| {
            let first = if last_first { scanlines - 1 - first } else { first };
            let second = if backwards { length - 1 - second } else { second };
            if columns { [first, second] } else { [second, first] }
        };
        let arrange = |picture: &Picture| {
            let pixel = |x, y| {
                let [x, y] = at(y, x);
                *picture.get(x, y).unwrap()
            };
            Raster::from_fn(length, scanlines, pixel).unwrap()
        };
        let input = folder.join("in.hdr");
        let arranged = arrange(&picture);
        write_radiance(&input, &RadianceHeader::new(resolution), arranged.pixels().chunks(length).map(<[_]>::to_vec));
        let output = folder.join("out.hdr");
        assert_eq!([go(&input, &output).unwrap().width, go(&input, &output).unwrap().height], [width, height]);
        let (relit, header) = read_radiance(&output);
        assert_eq!(header.resolution, resolution);
        assert_eq!(relit, in_rgbe(&arrange(&right)));
        let (output, result) = (folder.join("out.exr"), go(&input, &folder.join("out.exr")));
        if columns {
            let error = result.unwrap_err();
            assert!(matches!(error, RelightError::Columns { .. }) && !output.exists(), "{error}");
            assert!(error.to_string().contains(&resolution.to_string()), "{error}");
        } else {
            result.unwrap();
            assert_eq!(read_exr(&output).unwrap().picture, right, "{resolution}");
            fs::remove_file(&output).unwrap();
        }
    }
}

#[test]
fn resolutions_are_written_as_radiance_has_them() {
    let rows = Resolution::rows(3, 2);
    assert_eq!(rows.to_string(), "-Y 2 +X 3");
    let upwards = Resolution { last_first: true, backwards: true, ..rows };
    assert_eq!(upwards.to_string(), "+Y 2 -X 3");
    let columns = Resolution { columns: true, ..upwards };
    assert_eq!(columns.to_string(), "-X 2 +Y 3");
    assert_eq!(columns.size(), [2, 3]);
}

#[test]
fn old_encodings_are_read() {
    let path = Path::new("old.hdr");
    let pixel = |m: u8| [m, m / 2, 3, 130];
    let flat: Vec<_> = [128, 150, 150, 150, 200].iter().map(|m| pixel(*m)).collect();
    let runs = vec![pixel(128), pixel(150), [1, 1, 1, 2], pixel(200)];
    let decoded: Vec<_> = flat.iter().map(|p| rgbe::decode(*p).map(|c| c as f32)).collect();
    for body in [flat, runs] {
        let bytes = [b"#?RADIANCE\n\n-Y 1 +X 5\n".as_slice(), body.as_flattened()].concat();
        let mut read = Vec::new();
        assert!(RadianceReader::new(path, bytes.as_slice()).unwrap().next_scanline(&mut read).unwrap());
        assert_eq!(read, decoded);
    }
    // 300 = 44 + 1 · 256, and the count after another pixel begins anew.
    let body = [pixel(128), [1, 1, 1, 44], [1, 1, 1, 1], pixel(150), [1, 1, 1, 3]];
    let bytes = [b"#?RGBE\r\n\r\n-Y 1 +X 305\r\n".as_slice(), body.as_flattened()].concat();
    let mut read = Vec::new();
    RadianceReader::new(path, bytes.as_slice()).unwrap().next_scanline(&mut read).unwrap();
    let second = read.iter().position(|p| *p != read[0]).unwrap();
    assert_eq!([second, read.len()], [301, 305]);
    assert!(read[301..].iter().all(|p| *p == read[301]));
    // Another program's encoder, run by run.
    let body = [&[2, 2, 0, 9][..], &[137, 128], &[4, 1, 2, 3, 4, 133, 9], &[137, 0], &[137, 129]].concat();
    let bytes = [b"#?RADIANCE\n\n-Y 1 +X 9\n".as_slice(), &body].concat();
    let mut read = Vec::new();
    RadianceReader::new(path, bytes.as_slice()).unwrap().next_scanline(&mut read).unwrap();
    let greens: Vec<_> = read.iter().map(|p| p[1] * 128.0 - 0.5).collect();
    assert_eq!(greens, [1.0, 2.0, 3.0, 4.0, 9.0, 9.0, 9.0, 9.0, 9.0]);
}

#[test]
fn header_lines_mean_what_they_mean_in_radiance() {
    let folder = fresh("header");
    let [input, hdr, exr] = ["in.hdr", "out.hdr", "out.exr"].map(|name| folder.join(name));
    let lines = [
        "oconv scene",
        "EXPOSURE=2",
        "\tEXPOSURE=100",
        "COLORCORR=2 1 .5",
        "EXPOSURE= 4",
        "PIXASPECT=2",
        "PRIMARIES= .64 .33 .3 .6 .15 .06 .3127 .329",
    ];
    let head = format!("#?RADIANCE\n{}\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n", lines.join("\n"));
    fs::write(&input, [head.as_bytes(), &[200, 160, 130, 140]].concat()).unwrap();
    let classical = Tensor::classical();
    let to = [1.0, 0.5, 0.25];
    relight(&input, &hdr, &classical, [[1.0; 3], to], &mut |_, _| {}).unwrap();
    relight(&input, &exr, &classical, [[1.0; 3], to], &mut |_, _| {}).unwrap();

    let stored = rgbe::decode([200, 160, 130, 140]);
    let undone = [stored[0] / 2.0, stored[1], stored[2] / 0.5];
    let relit = [undone[0], 0.5 * undone[1], 0.25 * undone[2]];
    assert_eq!(read_exr(&exr).unwrap().picture.pixels()[0], relit.map(|c| (c / 8.0) as f32));
    let bytes = fs::read(&hdr).unwrap();
    assert_eq!(bytes[bytes.len() - 4..], rgbe::encode(relit.map(|c| c as f32)), "with its exposure");
    let text = String::from_utf8_lossy(&bytes).into_owned();
    let kept: Vec<_> = text.lines().skip(1).take_while(|line| !line.is_empty()).collect();
    let not_undone = lines.iter().filter(|line| !line.starts_with("COLORCORR")).copied();
    assert_eq!(kept, not_undone.chain(["FORMAT=32-bit_rle_rgbe"]).collect::<Vec<_>>());

    let mut reader = RadianceReader::new(&input, fs::read(&input).unwrap().leak() as &[u8]).unwrap();
    let header = reader.header().clone();
    assert_eq!((header.exposure, header.colour_correction, header.pixel_aspect), (8.0, [2.0, 1.0, 0.5], 2.0));
    reader.undo(Undo::ColourCorrection);
    let mut pixels = Vec::new();
    reader.next_scanline(&mut pixels).unwrap();
    assert_eq!(pixels, [undone.map(|c| c as f32)]);

    let meta = exr::meta::MetaData::read_from_file(&exr, true).unwrap();
    let shared = &meta.headers[0].shared_attributes;
    assert_eq!(shared.pixel_aspect, 0.5, "width by height");
    assert_eq!(shared.chromaticities.unwrap().white, Vec2(0.3127, 0.329));
    relight(&exr, &hdr, &classical, [[1.0; 3]; 2], &mut |_, _| {}).unwrap();
    let (_, back) = read_radiance(&hdr);
    assert_eq!((back.pixel_aspect, back.exposure), (2.0, 1.0));
    assert!((back.primaries.unwrap()[7] - 0.329).abs() <= 1e-7);
}

type Channels = exr::image::AnyChannels<FlatSamples>;

/// An EXR file of R and B of 16 bits, G of 32, alpha of 16 and a channel of integers.
fn write_mixed(path: &Path, picture: &Picture, encoding: Encoding, offset: Vec2<i32>) {
    let component = |index: usize| picture.pixels().iter().map(move |pixel| pixel[index]);
    let half = |index| FlatSamples::F16(component(index).map(f16::from_f32).collect());
    let count = picture.pixels().len() as u32;
    let channels = [
        ("R", half(0)),
        ("G", FlatSamples::F32(component(1).collect())),
        ("B", half(2)),
        ("A", FlatSamples::F16((0..count).map(|i| f16::from_f32(i as f32 / count as f32)).collect())),
        ("object.id", FlatSamples::U32((0..count).collect())),
    ];
    let channels = channels.into_iter().map(|(name, samples)| AnyChannel::new(name, samples)).collect();
    let mut attributes = LayerAttributes::named("layer").with_position(offset);
    attributes.owner = Some(Text::from("somebody"));
    let size = Vec2(picture.width(), picture.height());
    let layer: Layer<Channels> = Layer::new(size, attributes, encoding, AnyChannels::sort(channels));
    let mut image = Image::from_layer(layer);
    image.attributes.display_window = IntegerBounds::new(Vec2(-3, 2), Vec2(100, 80));
    image.write().to_file(path).unwrap();
}

#[test]
fn all_kinds_of_exr_are_read() {
    let folder = fresh("kinds");
    let [input, output] = ["in.exr", "out.exr"].map(|name| folder.join(name));
    let picture = varied(50, 43);
    let halved = picture.map(|[r, g, b]| [f16::from_f32(*r).to_f32(), *g, f16::from_f32(*b).to_f32()]);
    let right = expected(&halved, &Tensor::rec_709());
    let tiles = |x, y| Blocks::Tiles(Vec2(x, y));
    for (compression, blocks, line_order) in [
        (Compression::Uncompressed, Blocks::ScanLines, LineOrder::Increasing),
        (Compression::RLE, Blocks::ScanLines, LineOrder::Decreasing),
        (Compression::ZIP1, tiles(16, 16), LineOrder::Increasing),
        (Compression::ZIP16, tiles(7, 64), LineOrder::Decreasing),
        (Compression::ZIP16, Blocks::ScanLines, LineOrder::Decreasing),
        (Compression::PIZ, tiles(64, 9), LineOrder::Unspecified),
        (Compression::PIZ, Blocks::ScanLines, LineOrder::Increasing),
    ] {
        let encoding = Encoding { compression, blocks, line_order };
        write_mixed(&input, &picture, encoding, Vec2(4, -7));
        let summary = go(&input, &output).unwrap();
        assert_eq!(summary.kept_channels, ["A", "object.id"], "{encoding:?}");
        assert_eq!(read_exr(&output).unwrap().picture, right, "{encoding:?}");

        let all = |path: &Path| read_all_flat_layers_from_file(path).unwrap();
        let (before, after) = (all(&input), all(&output));
        let of = |image: &FlatImage, name: &str| {
            let channels = &image.layer_data[0].channel_data.list;
            channels.iter().find(|channel| channel.name.eq(name)).unwrap().sample_data.clone()
        };
        for name in ["A", "object.id"] {
            assert_eq!(of(&before, name), of(&after, name), "{encoding:?}");
        }
        assert_eq!(before.attributes.display_window, after.attributes.display_window);
        assert_eq!(before.layer_data[0].attributes, after.layer_data[0].attributes);

        let summary = go(&input, &folder.join("out.hdr")).unwrap();
        assert_eq!((summary.kept_channels.len(), summary.dropped_channels.len()), (0, 2));
        assert_eq!(read_radiance(&folder.join("out.hdr")).0, in_rgbe(&right), "{encoding:?}");
    }
}

#[test]
fn the_first_level_of_a_mip_map_is_the_picture() {
    let folder = fresh("mip_map");
    let [input, output] = ["in.exr", "out.exr"].map(|name| folder.join(name));
    let picture = varied(20, 12);
    let level = |level: u32| {
        let size = Vec2((20_usize >> level).max(1), (12_usize >> level).max(1));
        let samples = |index: usize| -> Vec<f32> {
            if level == 0 { picture.pixels().iter().map(|p| p[index]).collect() } else { vec![0.5; size.area()] }
        };
        [0, 1, 2].map(samples)
    };
    let levels: Vec<_> = (0..5).map(level).collect();
    let channel = |(index, name): (usize, &str)| {
        let level_data = levels.iter().map(|level| FlatSamples::F32(level[index].clone())).collect();
        let rounding_mode = exr::math::RoundingMode::Down;
        AnyChannel::new(name, exr::image::Levels::Mip { rounding_mode, level_data })
    };
    let channels = AnyChannels::sort(["R", "G", "B"].into_iter().enumerate().map(channel).collect());
    let encoding = Encoding {
        compression: Compression::RLE,
        blocks: Blocks::Tiles(Vec2(8, 8)),
        line_order: LineOrder::Increasing,
    };
    let layer = Layer::new(Vec2(20, 12), LayerAttributes::named("mip"), encoding, channels);
    Image::from_layer(layer).write().to_file(&input).unwrap();
    go(&input, &output).unwrap();
    assert_eq!(read_exr(&output).unwrap().picture, expected(&picture, &Tensor::rec_709()));
}

#[test]
fn pictures_that_cannot_be_are_refused_by_name() {
    let folder = fresh("refused");
    let output = folder.join("out").join("out.exr");
    fs::create_dir(output.parent().unwrap()).unwrap();
    let channels = |list: &[(&str, FlatSamples)]| {
        let list = list.iter().map(|(name, samples)| AnyChannel::new(*name, samples.clone())).collect();
        let layer =
            Layer::new(Vec2(2, 1), LayerAttributes::named("x"), Encoding::UNCOMPRESSED, AnyChannels::sort(list));
        let path = folder.join("bad.exr");
        Image::from_layer(layer).write().to_file(&path).unwrap();
        go(&path, &output).unwrap_err().to_string()
    };
    let floats = || FlatSamples::F32(vec![1.0, 2.0]);
    let said = channels(&[("R", floats()), ("B", floats())]);
    assert!(said.contains("bad.exr") && said.contains("no channel `G`"), "{said}");
    let said = channels(&[("Y", floats())]);
    assert!(said.contains("no channel `R`"), "{said}");
    let said = channels(&[("R", floats()), ("G", FlatSamples::U32(vec![1, 2])), ("B", floats())]);
    assert!(said.contains("channel `G` is of integers"), "{said}");
    let infinite = FlatSamples::F16(vec![f16::ONE, f16::INFINITY]);
    let said = channels(&[("R", floats()), ("G", infinite), ("B", floats())]);
    assert!(said.contains("channel `G` is not finite at pixel (1, 0)"), "{said}");
    let said = channels(&[("R", floats()), ("G", floats()), ("B", FlatSamples::F32(vec![f32::NAN, 0.0]))]);
    assert!(said.contains("channel `B` is not finite at pixel (0, 0)"), "{said}");

    let radiance = |text: &str| {
        let path = folder.join("bad.hdr");
        fs::write(&path, text).unwrap();
        let said = go(&path, &output).unwrap_err().to_string();
        assert!(said.contains("bad.hdr") && !said.contains('\n'), "{said}");
        said
    };
    for (header, part) in [
        ("", "neither an OpenEXR nor a Radiance picture"),
        ("P6 2 1 255\n", "neither an OpenEXR nor a Radiance picture"),
        ("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n0000", "colours in XYZ"),
        ("#?RADIANCE\nFORMAT=ascii\n\n-Y 1 +X 1\n0000", "FORMAT=ascii"),
        ("#?RADIANCE\nEXPOSURE=0\n\n-Y 1 +X 1\n0000", "EXPOSURE=0"),
        ("#?RADIANCE\nEXPOSURE=bright\n\n-Y 1 +X 1\n0000", "EXPOSURE=bright"),
        ("#?RADIANCE\nEXPOSURE=1e200\nEXPOSURE=1e200\n\n-Y 1 +X 1\n0000", "EXPOSURE=1e200"),
        ("#?RADIANCE\nCOLORCORR=1 1\n\n-Y 1 +X 1\n0000", "COLORCORR=1 1"),
        ("#?RADIANCE\nPRIMARIES=1 2 3 4 5 6 7 nan\n\n-Y 1 +X 1\n0000", "PRIMARIES="),
        ("#?RADIANCE\n\n-Y 0 +X 1\n", "`-Y 0 +X 1`"),
        ("#?RADIANCE\n\n-Y 1 +X 262145\n", "`-Y 1 +X 262145`"),
        ("#?RADIANCE\n\n-Y 1 +Y 1\n", "`-Y 1 +Y 1`"),
        ("#?RADIANCE\n\n-Y 1 +X 1 1\n", "`-Y 1 +X 1 1`"),
        ("#?RADIANCE\n\n-Y 1 +X 1\n\x01\x01\x01\x02", "scanline 0: it begins with a run"),
        ("#?RADIANCE\n\n-Y 1 +X 2\n0000\x01\x01\x01\x02", "scanline 0: a run goes beyond its end"),
        ("#?RADIANCE\n\n-Y 1 +X 9\n\x02\x02\x00\x08", "scanline 0: it is encoded as one of 8 pixels"),
        ("#?RADIANCE\n\n-Y 1 +X 9\n\x02\x02\x00\x09\x00", "scanline 0: a run goes beyond its end"),
        ("#?RADIANCE\nEXPOSURE=1e-300\n\n-Y 1 +X 1\n0000", "channel `R` is not finite"),
    ] {
        let said = radiance(header);
        assert!(said.contains(part), "{header:?}: {said}");
    }
    assert_eq!(names(output.parent().unwrap()), [""; 0]);
    assert!(matches!(go(&folder.join("none.hdr"), &output), Err(RelightError::Image(ImageError::Io { .. }))));
    assert!(matches!(go(&folder.join("bad.exr"), &folder.join("out.png")), Err(RelightError::Extension(_))));
}

#[test]
fn lights_that_cannot_be_are_refused() {
    let folder = fresh("lights");
    let [input, output] = ["in.hdr", "out.hdr"].map(|name| folder.join(name));
    write_rows(&input, &varied(4, 3));
    let (bilinear, classical) = (Tensor::rec_709(), Tensor::classical());
    let error = |tensor, lights| relight(&input, &output, tensor, lights, &mut |_, _| {}).unwrap_err();
    for (tensor, from) in [(&classical, [1.0, 0.0, 1.0]), (&bilinear, [0.0; 3])] {
        let error = error(tensor, [from, YELLOW]);
        assert!(matches!(error, RelightError::Divisor { pixels: 12, reason: DivisorError::Singular, .. }), "{error}");
    }
    let found = error(&classical, [[1.0, f64::NAN, 1.0], YELLOW]);
    assert!(matches!(found, RelightError::Divisor { reason: DivisorError::NotFinite, .. }), "{found}");
    assert!(matches!(error(&classical, [SKY, [1.0, 1.0, f64::INFINITY]]), RelightError::Light(_)));
    assert!(matches!(error(&classical, [[1e-150; 3], [1e150; 3]]), RelightError::Range));
    assert!(!output.exists());
    // Cyan has no red to the classical operator, but is no singular divisor to the bilinear one.
    let cyan = [0.0, 1.0, 1.0];
    assert!(relight(&input, &output, &bilinear, [cyan, YELLOW], &mut |_, _| {}).unwrap().condition >= 2.0);
    let classical = relight(&input, &output, &classical, [[0.5, 1.0, 1.0], YELLOW], &mut |_, _| {}).unwrap();
    assert!((classical.condition - 2.0).abs() <= 1e-12, "{classical:?}");
}

#[test]
fn pixels_without_a_good_answer_are_counted() {
    let folder = fresh("counted");
    let [input, exr, hdr] = ["in.exr", "out.exr", "out.hdr"].map(|name| folder.join(name));
    // Under a light without much red, nothing is that red; and the last ones are beyond the range.
    let pixels = vec![[0.5; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0; 3], [3e38; 3], [f32::MAX, 0.0, -1.0]];
    write_exr(&input, &Picture::from_pixels(3, 2, pixels.clone()).unwrap(), &[], &[]).unwrap();
    let tensor = Tensor::rec_709();
    let relighting = Relighting::new(&tensor, SKY, YELLOW).unwrap();
    let count = |test: &dyn Fn([f64; 3]) -> bool| pixels.iter().filter(|p| test(p.map(f64::from))).count() as u64;
    let impossible = count(&|p| relighting.reflectance(p).iter().any(|c| *c < 0.0));
    let negative = count(&|p| relighting.relit(p).iter().any(|c| *c < 0.0));
    let beyond = |limit: f32| count(&|p| relighting.relit(p).iter().any(|c| c.abs() > f64::from(limit)));
    assert!([impossible, negative, beyond(f32::MAX), beyond(rgbe::LARGEST)].iter().all(|n| (1..6).contains(n)));

    for (output, limit) in [(&exr, f32::MAX), (&hdr, rgbe::LARGEST)] {
        let tally = go(&input, output).unwrap().tally;
        assert_eq!([tally.impossible, tally.negative, tally.limited], [impossible, negative, beyond(limit)]);
    }
    assert!(read_exr(&exr).unwrap().picture.pixels().as_flattened().contains(&f32::MAX));
}

/// Every truncation, and every third byte changed: an error of one line that names the file, or a picture; no panic, nothing left.
fn survives_damage(original: &Path) {
    let bytes = fs::read(original).unwrap();
    let folder = original.parent().unwrap().join("damaged");
    fs::create_dir(&folder).unwrap();
    let [input, output] = [folder.join(original.file_name().unwrap()), folder.join("out").with_extension("hdr")];
    let attempt = |bytes: &[u8]| {
        fs::write(&input, bytes).unwrap();
        let result = go(&input, &output);
        if let Err(error) = &result {
            let said = error.to_string();
            assert!(said.contains(input.file_name().unwrap().to_str().unwrap()), "{said}");
            assert!(!said.contains('\n') && !output.exists() && names(&folder).len() == 1, "{said}");
        } else {
            fs::remove_file(&output).unwrap();
        }
        result
    };
    assert!(attempt(&bytes).is_ok());
    for length in 0..bytes.len() {
        assert!(attempt(&bytes[..length]).is_err(), "{length} of {} bytes were read", bytes.len());
    }
    let mut rng = Rng::new(11);
    for place in (0..bytes.len()).step_by(3) {
        let mut changed = bytes.clone();
        changed[place] ^= 1 + (rng.bits() % 255) as u8;
        drop(attempt(&changed));
    }
}

#[test]
fn damaged_radiance_files_are_refused() {
    let folder = fresh("damaged_radiance");
    let path = folder.join("in.hdr");
    write_rows(&path, &varied(12, 9));
    survives_damage(&path);
}

#[test]
fn damaged_exr_files_are_refused() {
    for (name, encoding) in [
        ("lines", Encoding::SMALL_LOSSLESS),
        ("tiles", Encoding { blocks: Blocks::Tiles(Vec2(5, 5)), ..Encoding::FAST_LOSSLESS }),
    ] {
        let folder = fresh(&format!("damaged_exr_{name}"));
        let path = folder.join("in.exr");
        write_mixed(&path, &varied(12, 18), encoding, Vec2(0, 0));
        survives_damage(&path);
    }
}
