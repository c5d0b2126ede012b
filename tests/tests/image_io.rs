//! Picture files: round trips, damaged files, and what is left behind when writing fails.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::cast_precision_loss,
    reason = "a test may fail, and its pictures are small"
)]

use renderers::compare::{CompareError, CompareOptions, compare};
use renderers::image::{
    FalseColour, ImageError, Picture, ScalarMap, read_exr, read_picture, read_png, write_atomic, write_exr, write_png,
};
use renderers::report::{ChartLabels, Histogram};
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// An empty directory of this name under the build directory.
fn directory(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("image_io").join(name);
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).unwrap();
    path
}

fn names(directory: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Every kind of finite `f32`: signs, zeros, subnormal and huge numbers.
fn varied_picture(width: usize, height: usize) -> Picture {
    let special =
        [0.0, -0.0, 1.0, -0.25, f32::MIN_POSITIVE, f32::from_bits(1), -f32::from_bits(77), f32::MAX, f32::MIN];
    Picture::from_fn(width, height, |x, y| {
        [0, 1, 2].map(|c| {
            let k = 3 * (y * width + x) + c;
            special.get(k).copied().unwrap_or_else(|| {
                let bits = u32::try_from(k).unwrap().wrapping_mul(2_654_435_761);
                let value = f32::from_bits(bits);
                if value.is_finite() { value } else { 0.5 }
            })
        })
    })
    .unwrap()
}

fn bits(values: &[f32]) -> Vec<u32> {
    values.iter().map(|value| value.to_bits()).collect()
}

#[test]
fn exr_comes_back_bit_for_bit() {
    let file = directory("exr_round_trip").join("picture.exr");
    // Sizes around the sixteen rows of a compressed block.
    for (width, height) in [(1, 1), (7, 15), (16, 16), (33, 17), (64, 50)] {
        let picture = varied_picture(width, height);
        let bound =
            ScalarMap::from_fn(width, height, |x, y| -f32::from_bits(u32::try_from(x * y + 1).unwrap())).unwrap();
        let channels = [("bound", &bound), ("S0.550,000000nm", &bound)];
        let attributes = [("threshold", "3"), ("renderer", "Whitted, größer"), ("comments", "two words")];
        write_exr(&file, &picture, &channels, &attributes).unwrap();
        let back = read_exr(&file).unwrap();
        assert_eq!(bits(back.picture.pixels().as_flattened()), bits(picture.pixels().as_flattened()));
        assert_eq!((back.picture.width(), back.picture.height()), (width, height));
        assert_eq!(back.channels.len(), 2);
        for (name, map) in &back.channels {
            assert!(["bound", "S0.550,000000nm"].contains(&name.as_str()));
            assert_eq!(bits(map.pixels()), bits(bound.pixels()));
        }
        for (name, text) in attributes {
            assert!(back.attributes.contains(&(name.to_owned(), text.to_owned())), "{name}: {:?}", back.attributes);
        }
        assert_eq!(read_picture(&file).unwrap(), picture);
    }
}

#[test]
fn png_comes_back_to_within_half_a_code() {
    let file = directory("png_round_trip").join("picture.png");
    let picture = Picture::from_fn(64, 4, |x, y| {
        let value = (x * 4 + y) as f32 / 255.0;
        [value, 1.0 - value, value * value]
    })
    .unwrap();
    write_png(&file, &picture, 1.0).unwrap();
    let back = read_picture(&file).unwrap();
    assert!(back.same_size(&picture));
    let encode = |value: f32| 255.0 * spectral_core::colour::encode_srgb(f64::from(value));
    for (a, b) in back.pixels().as_flattened().iter().zip(picture.pixels().as_flattened()) {
        assert!((encode(*a) - encode(*b)).abs() <= 0.5 + 1e-4, "{a} {b}");
    }
    // What has been quantised once does not change any more.
    write_png(&file, &back, 1.0).unwrap();
    assert_eq!(read_png(&file).unwrap(), back);
}

#[test]
fn exposure_is_a_factor_and_the_rest_is_clipped() {
    let directory = directory("exposure");
    let picture = Picture::from_pixels(2, 1, vec![[0.25, 4.0, -1.0], [0.5, 0.0, 1e30]]).unwrap();
    write_png(&directory.join("a.png"), &picture, 2.0).unwrap();
    let expected = Picture::from_pixels(2, 1, vec![[0.5, 1.0, 0.0], [1.0, 0.0, 1.0]]).unwrap();
    write_png(&directory.join("b.png"), &expected, 1.0).unwrap();
    assert_eq!(fs::read(directory.join("a.png")).unwrap(), fs::read(directory.join("b.png")).unwrap());
    for exposure in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert!(matches!(write_png(&directory.join("c.png"), &picture, exposure), Err(ImageError::Exposure(_))));
    }
    assert_eq!(names(&directory), ["a.png", "b.png"]);
}

#[test]
fn pixels_that_are_not_finite_are_refused_and_named() {
    let directory = directory("not_finite");
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut picture = Picture::filled(3, 2, [0.5; 3]).unwrap();
        let good = picture.clone();
        picture.pixels_mut()[4][2] = bad;
        let mut map = ScalarMap::filled(3, 2, 0.0).unwrap();
        map.pixels_mut()[5] = bad;
        let (exr, png) = (directory.join("a.exr"), directory.join("a.png"));
        for error in [
            write_exr(&exr, &picture, &[], &[]).unwrap_err(),
            write_png(&png, &picture, 1.0).unwrap_err(),
            write_exr(&exr, &good, &[("bound", &map)], &[]).unwrap_err(),
        ] {
            let ImageError::NotFinite { channel, x, y, .. } = &error else { panic!("{error}") };
            assert!((channel == "B" && (*x, *y) == (1, 1)) || (channel == "bound" && (*x, *y) == (2, 1)), "{error}");
            assert!(error.to_string().contains("a."), "{error}");
        }
    }
    assert!(names(&directory).is_empty());
}

#[test]
fn names_and_sizes_are_checked() {
    let directory = directory("names");
    let file = directory.join("a.exr");
    let picture = Picture::filled(3, 2, [0.5; 3]).unwrap();
    let map = ScalarMap::filled(3, 2, 0.0).unwrap();
    let other = ScalarMap::filled(2, 3, 0.0).unwrap();
    let long = "n".repeat(256);
    for name in ["", "R", "ΔE00", "nul\0", long.as_str()] {
        let error = write_exr(&file, &picture, &[(name, &map)], &[]).unwrap_err();
        assert!(matches!(error, ImageError::Name { .. }), "`{name}`: {error}");
    }
    let twice = write_exr(&file, &picture, &[("a", &map), ("a", &map)], &[]);
    assert!(matches!(twice, Err(ImageError::Name { .. })));
    let size = write_exr(&file, &picture, &[("a", &other)], &[]);
    assert!(matches!(size, Err(ImageError::ChannelSize { .. })));
    for attribute in [("", "x"), ("Δ", "x"), ("x", "Δ")] {
        let error = write_exr(&file, &picture, &[], &[attribute]).unwrap_err();
        assert!(matches!(error, ImageError::Name { .. }), "{attribute:?}: {error}");
    }
    let error = write_exr(&file, &picture, &[], &[("channels", "x")]).unwrap_err();
    assert!(error.to_string().contains("`channels` is reserved"), "{error}");
    assert!(names(&directory).is_empty());
    write_exr(&file, &picture, &[(&long[1..], &map)], &[]).unwrap();
    assert_eq!(read_exr(&file).unwrap().channels[0].0.len(), 255);
}

/// Reads every damaged version of a file: it must be refused, or be a picture, never anything else.
fn survives_damage(original: &Path, truncated_is_refused: bool) {
    let bytes = fs::read(original).unwrap();
    let damaged = original.with_extension("damaged");
    for length in 0..bytes.len() {
        fs::write(&damaged, &bytes[..length]).unwrap();
        let result = read_picture(&damaged);
        assert!(result.is_err() || !truncated_is_refused, "{length} of {} bytes were read", bytes.len());
    }
    let mut refused = 0;
    for index in 0..bytes.len() {
        for flip in [0x01, 0x10, 0x80, 0xff] {
            let mut bytes = bytes.clone();
            bytes[index] ^= flip;
            fs::write(&damaged, &bytes).unwrap();
            match read_picture(&damaged) {
                Ok(picture) => {
                    assert!(picture.pixels().as_flattened().iter().all(|value| value.is_finite()));
                }
                Err(error) => {
                    refused += 1;
                    let text = error.to_string();
                    assert!(!text.contains('\n'), "{text}");
                    assert!(text.contains("damaged") || matches!(error, ImageError::Size { .. }), "{text}");
                }
            }
        }
    }
    assert!(refused > bytes.len() / 2, "only {refused} of {} changes were noticed", 4 * bytes.len());
}

#[test]
fn damaged_exr_files_are_refused() {
    let file = directory("damaged_exr").join("a.exr");
    let map = ScalarMap::filled(5, 3, 0.5).unwrap();
    write_exr(&file, &varied_picture(5, 3), &[("extra", &map)], &[("renderer", "path")]).unwrap();
    survives_damage(&file, true);
}

#[test]
fn damaged_png_files_are_refused() {
    let file = directory("damaged_png").join("a.png");
    let picture = Picture::from_fn(9, 7, |x, y| [x as f32 / 9.0, y as f32 / 7.0, 0.5]).unwrap();
    write_png(&file, &picture, 1.0).unwrap();
    // The last chunk says only that the file ends.
    survives_damage(&file, false);
}

#[test]
fn other_files_are_refused_by_name() {
    let directory = directory("other");
    for (name, content) in [("empty.exr", &b""[..]), ("text.png", b"not a picture"), ("short", b"\x76\x2f")] {
        let file = directory.join(name);
        fs::write(&file, content).unwrap();
        let error = read_picture(&file).unwrap_err();
        assert!(matches!(error, ImageError::Unsupported { .. }), "{error}");
        assert!(error.to_string().contains(name), "{error}");
        assert!(matches!(read_exr(&file), Err(ImageError::Malformed { .. })));
        assert!(matches!(read_png(&file), Err(ImageError::Malformed { .. })));
    }
    let error = read_picture(&directory.join("missing.exr")).unwrap_err();
    assert!(matches!(&error, ImageError::Io { source, .. } if source.kind() == io::ErrorKind::NotFound), "{error}");
    assert!(error.to_string().contains("missing.exr"), "{error}");
    assert!(read_picture(&directory).is_err());
}

#[test]
fn nothing_is_left_when_writing_fails() {
    let directory = directory("atomic");
    let file = directory.join("a.txt");
    let fail = |file: &mut io::BufWriter<fs::File>| {
        file.write_all(&[7; 100_000])?;
        Err(io::Error::other("the disk is full"))
    };
    let error = write_atomic(&file, fail).unwrap_err();
    assert!(error.to_string().ends_with("a.txt: the disk is full"), "{error}");
    assert!(names(&directory).is_empty());

    write_atomic(&file, |file| file.write_all(b"old")).unwrap();
    assert!(write_atomic(&file, fail).is_err());
    assert_eq!(fs::read(&file).unwrap(), b"old");
    let panicked = std::panic::catch_unwind(|| write_atomic(&file, |_| panic!("in the middle of a file")));
    assert!(panicked.is_err());
    assert_eq!(fs::read(&file).unwrap(), b"old");
    assert_eq!(names(&directory), ["a.txt"]);

    write_atomic(&file, |file| file.write_all(b"new")).unwrap();
    assert_eq!(fs::read(&file).unwrap(), b"new");
    assert_eq!(names(&directory), ["a.txt"]);
}

#[test]
fn nothing_but_regular_files_is_replaced() {
    let directory = directory("irregular");
    let place = directory.join("directory");
    fs::create_dir(&place).unwrap();
    for path in [place.as_path(), &directory.join("missing").join("a.txt"), Path::new("/"), Path::new("")] {
        assert!(matches!(write_atomic(path, |_| Ok(())), Err(ImageError::Io { .. })), "{}", path.display());
    }
    assert_eq!(names(&directory), ["directory"]);
}

#[test]
fn many_threads_may_write_to_one_place() {
    let directory = directory("threads");
    let file = directory.join("a.txt");
    std::thread::scope(|scope| {
        for letter in b'a'..b'i' {
            let file = &file;
            scope.spawn(move || {
                for _ in 0..5 {
                    write_atomic(file, |file| file.write_all(&[letter; 10_000])).unwrap();
                }
            });
        }
    });
    let content = fs::read(&file).unwrap();
    assert_eq!(content.len(), 10_000);
    assert!(content.iter().all(|byte| *byte == content[0]), "two writers were mixed");
    assert_eq!(names(&directory), ["a.txt"]);
}

#[test]
fn comparing_files_writes_maps_and_numbers() {
    let directory = directory("compare");
    let (first, second) = (directory.join("a.exr"), directory.join("b.png"));
    let picture = Picture::from_fn(40, 30, |x, y| [x as f32 / 40.0, y as f32 / 30.0, 0.25]).unwrap();
    write_exr(&first, &picture, &[], &[]).unwrap();
    write_png(&second, &picture, 1.0).unwrap();
    let out = directory.join("new").join("maps");
    let comparison = compare(&first, &second, &out, &CompareOptions::default()).unwrap();
    // Half a code of 8-bit sRGB: not nothing, but less than 1 also in the dark.
    assert!(comparison.delta_e00.mean > 0.0 && comparison.delta_e00.max <= 1.0, "{comparison:?}");
    assert!(
        comparison.delta_e00.mean <= comparison.delta_e00.p95 && comparison.delta_e00.p95 <= comparison.delta_e00.max
    );
    assert!(comparison.relative_brightness.min < 0.0 && comparison.relative_brightness.max > 0.0, "{comparison:?}");
    assert_eq!(comparison.files.len(), names(&out).len());
    for file in &comparison.files {
        let written = read_picture(file).unwrap();
        assert!(written.width() >= 40 && written.height() >= 30, "{}", file.display());
    }
    let numbers = read_exr(&out.join("difference.exr")).unwrap();
    let (name, map) = &numbers.channels[0];
    assert_eq!(name, "delta_e00");
    let largest = map.pixels().iter().fold(0.0_f32, |largest, &value| largest.max(value));
    assert_eq!(f64::from(largest), comparison.delta_e00.max);

    let same = compare(&first, &first, &out, &CompareOptions::default()).unwrap();
    assert_eq!((same.delta_e00.max, same.relative_brightness.max), (0.0, 0.0));
}

#[test]
fn comparisons_that_cannot_be_are_refused_by_name() {
    let directory = directory("compare_refused");
    let (first, second) = (directory.join("a.exr"), directory.join("b.exr"));
    write_exr(&first, &varied_picture(4, 3), &[], &[]).unwrap();
    write_exr(&second, &varied_picture(3, 4), &[], &[]).unwrap();
    let out = directory.join("maps");
    let error = compare(&first, &second, &out, &CompareOptions::default()).unwrap_err();
    assert!(matches!(error, CompareError::FileSize { sizes: [(4, 3), (3, 4)], .. }), "{error}");
    assert!(error.to_string().contains("a.exr") && error.to_string().contains("b.exr"), "{error}");
    let error = compare(&first, &directory.join("c.exr"), &out, &CompareOptions::default()).unwrap_err();
    assert!(error.to_string().contains("c.exr"), "{error}");
    assert!(!out.exists(), "nothing is written before both pictures are read");
    // A file where the directory should be.
    let error = compare(&first, &first, &second, &CompareOptions::default()).unwrap_err();
    assert!(matches!(error, CompareError::Image(ImageError::Io { .. })), "{error}");
}

#[test]
fn pictures_of_all_finite_numbers_can_be_compared() {
    let directory = directory("compare_extremes");
    let (first, second) = (directory.join("a.exr"), directory.join("b.exr"));
    write_exr(&first, &varied_picture(16, 16), &[], &[]).unwrap();
    write_exr(&second, &Picture::filled(16, 16, [0.0; 3]).unwrap(), &[], &[]).unwrap();
    let comparison = compare(&first, &second, &directory, &CompareOptions::default()).unwrap();
    assert!(comparison.delta_e00.mean.is_finite() && comparison.relative_brightness.max.is_finite());
}

#[test]
fn maps_and_charts_are_pictures() {
    let directory = directory("drawings");
    let map = ScalarMap::from_fn(30, 20, |x, y| (x * y) as f32).unwrap();
    FalseColour::fitting("x y", &map).write_png(&directory.join("map.png"), &map).unwrap();
    let drawn = read_png(&directory.join("map.png")).unwrap();
    // Shown eightfold, with the legend to the right and the heading above.
    assert!(drawn.width() > 240 + 40 && drawn.height() > 160 + 30);
    let mut colours: Vec<_> = drawn.pixels().iter().map(|pixel| pixel.map(f32::to_bits)).collect();
    colours.sort_unstable();
    colours.dedup();
    assert!(colours.len() > 200, "a continuous map has many colours: {}", colours.len());

    let histogram = Histogram::of_counts([1, 2, 2, 3, 3, 3]);
    let labels = ChartLabels { title: "Intervals", values: "Intervals", counts: "Pixels" };
    histogram.write_png(&directory.join("chart.png"), &labels, Default::default()).unwrap();
    let chart = read_png(&directory.join("chart.png")).unwrap();
    assert_eq!((chart.width(), chart.height()), (640, 400));
    assert_eq!(names(&directory), ["chart.png", "map.png"]);
}
