//! Spectral EXR files: what renderers write into them, what comes back, and damaged ones. And Radiance files.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use renderers::image::{
    ImageError, Picture, ScalarMap, SpectralPicture, read_channels, read_exr, read_hdr, read_spectral_exr,
    write_exr_channels, write_hdr, write_spectral_exr,
};
use renderers::map::{Quantity, of_spectra};
use renderers::render::{BetweenOptions, Options, Renderer, Spectra, SpectrumSink, Watch, render, render_spectra};
use renderers::scene::builtin;
use renderers::spectral::{Palette, UniformBins};
use spectral_core::colour::rgb::xyz_to_linear_rgb;
use spectral_core::light::IndexMeter;
use spectral_core::spectrum::{Outside, RadiationConstant};
use spectral_core::summation::SumGrid;
use spectral_core::tables::fluorescent::FL2;

fn folder(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("spectral_exr").join(name);
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).unwrap();
    path
}

/// Values of all sizes, each different.
fn varied(width: usize, height: usize, wavelengths: &[f64]) -> SpectralPicture {
    let mut picture = SpectralPicture::black(width, height, wavelengths).unwrap();
    for y in 0..height {
        for x in 0..width {
            let value = |w: &f64| (w / 100.0).powi(i32::try_from(x + y).unwrap() - 3) + 1e-3 * w.sin();
            picture.add([x, y], &wavelengths.iter().map(value).collect::<Vec<_>>(), 1.0);
        }
    }
    picture
}

fn preview(width: usize, height: usize) -> Picture {
    Picture::from_fn(width, height, |x, y| [x, y, x + y].map(|v| f32::from(u16::try_from(v).unwrap()))).unwrap()
}

#[test]
fn spectra_come_back_bit_for_bit() {
    let file = folder("round_trip").join("picture.exr");
    for (width, height, count) in [(1, 1, 1), (7, 17, 3), (33, 16, 81), (5, 40, 40)] {
        let wavelengths: Vec<f64> = (0..count).map(|i| 380.0 + 5.0 * f64::from(i)).collect();
        let picture = varied(width, height, &wavelengths);
        let colours = preview(width, height);
        write_spectral_exr(&file, picture.clone(), &colours, &[("renderer", "test")]).unwrap();
        let back = read_spectral_exr(&file).unwrap();
        assert_eq!(back.picture, picture);
        assert_eq!(back.preview.unwrap(), colours);
        assert!(back.others.is_empty());
        let attribute = |name: &str| back.attributes.iter().find(|(n, _)| n == name).map(|(_, value)| value.as_str());
        assert_eq!(attribute("spectralLayoutVersion"), Some("1.0"));
        assert_eq!(attribute("emissiveUnits"), Some("W.m^-2.sr^-1"));
        assert_eq!(attribute("renderer"), Some("test"));
        // Whoever knows nothing of spectra finds a picture.
        assert_eq!(read_exr(&file).unwrap().picture, colours);
    }
}

#[test]
fn channels_have_the_names_of_the_layout() {
    let file = folder("names").join("picture.exr");
    write_spectral_exr(&file, varied(2, 2, &[382.5, 550.0]), &preview(2, 2), &[]).unwrap();
    let names: Vec<String> = read_channels(&file).unwrap().channels.into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, ["B", "G", "R", "S0.382,500000nm", "S0.550,000000nm"]);
}

/// Wavelengths in other units and orders, other components beside them, and files that have none.
#[test]
fn foreign_channels_are_understood_or_named() {
    let folder = folder("foreign");
    let map = |value: f32| ScalarMap::filled(2, 1, value).unwrap();
    let write = |name: &str, channels: &[(&str, f32)]| {
        let maps: Vec<ScalarMap> = channels.iter().map(|(_, value)| map(*value)).collect();
        let list: Vec<(&str, &ScalarMap)> = channels.iter().map(|(name, _)| *name).zip(&maps).collect();
        let file = folder.join(name);
        write_exr_channels(&file, &list, &[]).unwrap();
        file
    };
    let file = write(
        "units.exr",
        &[("S0.0,7um", 3.0), ("S0.500nm", 2.0), ("S0.4,5e-7m", 1.0), ("S1.500nm", 9.0), ("T.500nm", 8.0)],
    );
    let found = read_spectral_exr(&file).unwrap();
    assert!(found.picture.wavelengths().iter().zip([450.0, 500.0, 700.0]).all(|(a, b)| (a - b).abs() <= 1e-9));
    assert_eq!(found.picture.spectrum(1, 0).unwrap(), [1.0, 2.0, 3.0]);
    assert_eq!(found.picture.spectrum(2, 0), None);
    assert_eq!(
        (found.others.as_slice(), found.preview),
        (["S1.500nm".to_owned(), "T.500nm".to_owned()].as_slice(), None)
    );
    let refused = |file: &Path| read_spectral_exr(file).unwrap_err();
    assert!(matches!(refused(&write("none.exr", &[("T.500nm", 1.0), ("R", 1.0)])), ImageError::Unsupported { .. }));
    let twice = refused(&write("twice.exr", &[("S0.500nm", 1.0), ("S0.500,0nm", 2.0)]));
    assert!(matches!(twice, ImageError::Malformed { .. }) && twice.to_string().contains("same wavelength"), "{twice}");
    let nan = refused(&write("nan.exr", &[("S0.500nm", f32::NAN)]));
    assert!(matches!(nan, ImageError::NotFinite { .. }), "{nan}");
    assert!(matches!(refused(&folder.join("nowhere.exr")), ImageError::Io { .. }));
}

/// Every file cut off anywhere, and bytes changed all over it: an error or a picture, never a panic, and no memory without end.
#[test]
fn damaged_files_are_refused() {
    let folder = folder("damaged");
    let (whole, damaged) = (folder.join("whole.exr"), folder.join("damaged.exr"));
    write_spectral_exr(&whole, varied(9, 20, &[400.0, 450.0, 500.0, 550.0]), &preview(9, 20), &[]).unwrap();
    let bytes = fs::read(&whole).unwrap();
    let mut refused = 0;
    for length in (0..bytes.len()).step_by(13) {
        fs::write(&damaged, &bytes[..length]).unwrap();
        let error = read_spectral_exr(&damaged).unwrap_err().to_string();
        assert!(error.contains("damaged.exr") && !error.contains('\n'), "{length}: {error}");
    }
    for place in (0..bytes.len()).step_by(3) {
        let mut changed = bytes.clone();
        changed[place] ^= [0xff, 0x01, 0x80][place % 3];
        fs::write(&damaged, &changed).unwrap();
        if let Err(error) = read_spectral_exr(&damaged) {
            refused += 1;
            assert!(error.to_string().contains("damaged.exr"), "{place}: {error}");
        }
    }
    assert!(refused > 50, "{refused}");
    assert!(read_spectral_exr(&whole).is_ok());
    // A header that promises far more than the file can hold.
    let window = bytes.windows(10).position(|w| w == b"dataWindow").unwrap();
    let mut huge = bytes;
    // Name and type with their ends, the length, then the least x and y: the largest x and y are next.
    let at = window + "dataWindow\0box2i\0".len() + 4 + 8;
    huge[at..at + 8].copy_from_slice(&[0xff, 0x1f, 0, 0, 0xff, 0x1f, 0, 0]);
    fs::write(&damaged, &huge).unwrap();
    let error = read_spectral_exr(&damaged).unwrap_err();
    assert!(
        matches!(error, ImageError::Malformed { .. } | ImageError::Unsupported { .. } | ImageError::Io { .. }),
        "{error}"
    );
}

#[test]
fn what_no_file_can_hold_is_refused() {
    let file = folder("refused").join("picture.exr");
    assert!(matches!(SpectralPicture::black(4, 4, &[500.0, 500.0]), Err(ImageError::Range { .. })));
    assert!(matches!(SpectralPicture::black(4, 4, &[500.0, 400.0]), Err(ImageError::Range { .. })));
    assert!(matches!(SpectralPicture::black(0, 4, &[500.0]), Err(ImageError::Size { .. })));
    assert!(matches!(SpectralPicture::black(1 << 13, 1 << 13, &[1.0; 100]), Err(ImageError::Size { .. })));
    let mut picture = varied(3, 2, &[500.0]);
    let other = write_spectral_exr(&file, picture.clone(), &preview(2, 3), &[]).unwrap_err();
    assert!(matches!(other, ImageError::ChannelSize { .. }), "{other}");
    picture.add([2, 1], &[f64::NAN], 1.0);
    assert!(matches!(
        write_spectral_exr(&file, picture, &preview(3, 2), &[]),
        Err(ImageError::NotFinite { x: 2, y: 1, .. })
    ));
    assert!(!file.exists());
}

struct Collected(Mutex<SpectralPicture>);

impl SpectrumSink for Collected {
    fn pixel(&self, at: [usize; 2], spectrum: &[f64], share: f64) {
        self.0.lock().unwrap().add(at, spectrum, share);
    }
}

struct Silent;

impl Watch for Silent {
    fn stage(&self, _: &str, _: u64) {}
    fn add(&self, _: u64) {}
}

/// The spectra of pixels are those that their colours are made of, whatever finds the light: direct, between surfaces, through dispersive
/// glass, by photons.
#[test]
fn colours_of_pixels_are_those_of_their_spectra() {
    for (name, renderer, spectra) in [
        ("cornell-box-lamp", Renderer::Whitted, Spectra::Uniform(40)),
        ("cornell-box-lamp", Renderer::Radiosity, Spectra::Wavelengths(5)),
        ("cornell-box-spheres", Renderer::Radiosity, Spectra::Wavelengths(10)),
        ("cornell-box-glass", Renderer::PhotonMap, Spectra::Uniform(8)),
    ] {
        let scene = builtin::load(name, &[]).unwrap();
        let between = BetweenOptions { accuracy: 0.1, exact: false };
        let options =
            Options { renderer, spectra, size: Some([20, 20]), samples: Some(2), between, ..Options::default() };
        let bins = match spectra {
            Spectra::Wavelengths(step) => UniformBins::at_wavelengths(&Palette::default(), step).unwrap(),
            _ => UniformBins::new(&Palette::default(), if let Spectra::Uniform(n) = spectra { n } else { 1 }).unwrap(),
        };
        let sink = Collected(Mutex::new(SpectralPicture::black(20, 20, bins.wavelengths()).unwrap()));
        let rendering = render_spectra(&scene, &options, &Silent, &sink).unwrap();
        assert_eq!(rendering.picture, render(&scene, &options, &|_| {}).unwrap().picture, "{name}");
        let spectral = sink.0.into_inner().unwrap();
        let mut lit = 0;
        for (index, found) in rendering.picture.pixels().iter().enumerate() {
            let spectrum = spectral.spectrum(index % 20, index / 20).unwrap();
            let sum = |w: &Vec<f64>| spectrum.iter().zip(w).map(|(s, w)| f64::from(*s) * w).sum::<f64>();
            let rgb =
                xyz_to_linear_rgb(bins.weights().each_ref().map(sum).map(|v| v / renderers::spectral::Y_INTEGRAL));
            for (a, b) in rgb.iter().zip(found) {
                // Both are kept in f32; RGB may nearly cancel.
                let scale = rgb.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
                assert!(
                    (a - f64::from(*b)).abs() <= 16.0 * f64::from(f32::EPSILON) * scale.max(1e-30),
                    "{name}, {index}: {rgb:?} {found:?}"
                );
            }
            lit += usize::from(spectrum.iter().any(|s| *s > 0.0));
        }
        assert!(lit > 200, "{name}: {lit}");
    }
}

#[test]
fn spectra_that_are_none_are_refused() {
    let scene = builtin::load("cornell-box", &[]).unwrap();
    let sink = Collected(Mutex::new(SpectralPicture::black(1, 1, &[500.0]).unwrap()));
    for (options, said) in [
        (
            Options { spectra: Spectra::Rgb, ..Options::default() },
            "pixels have spectra with bins or wavelengths, not with rgb",
        ),
        (
            Options { renderer: Renderer::Path, spectra: Spectra::Uniform(4), ..Options::default() },
            "the path tracer keeps colours",
        ),
        (
            Options { spectra: Spectra::Wavelengths(7), ..Options::default() },
            "a step of 7 nm does not divide 380 to 780 nm",
        ),
    ] {
        let error = render_spectra(&scene, &options, &Silent, &sink).unwrap_err().to_string();
        assert!(error.contains(said), "{error}");
    }
}

/// Stored spectra of a lamp at its table's wavelengths have the lamp's printed indices; negative light has none; gaps are refused.
#[test]
fn stored_spectra_are_measured_as_lamps_are() {
    let lamp = FL2.spectrum::<f64>(Outside::Zero);
    let stored = |step: u16, first: u16| {
        let wavelengths: Vec<f64> = (first..=780).step_by(usize::from(step)).map(f64::from).collect();
        let mut picture = SpectralPicture::black(3, 1, &wavelengths).unwrap();
        let values: Vec<f64> = wavelengths.iter().map(|w| spectral_core::Spectrum::value(&lamp, *w)).collect();
        picture.add([0, 0], &values, 1e-3);
        picture.add([1, 0], &values, -1e-3);
        picture
    };
    let quantities = [Quantity::Ra, Quantity::Luminance];
    for (step, first, grid) in [(5, 380, 5), (5, 360, 5), (1, 380, 1)] {
        let (maps, found) = of_spectra(&stored(step, first), &quantities).unwrap();
        assert_eq!(found, grid);
        let [ra, luminance] = [0, 1].map(|index| maps[index].values.pixels());
        // Published: 64.158 by the table at 5 nm (thesis, table 3.1); interpolated to 1 nm it is another lamp by up to 0.12.
        assert!((f64::from(ra[0]) - 64.158).abs() <= if step == 5 { 0.001 } else { 0.12 }, "{}", ra[0]);
        assert!(ra[1].is_nan() && luminance[1].is_nan() && ra[2].is_nan() && luminance[2] == 0.0 && luminance[0] > 0.0);
    }
    for (picture, said) in [
        (stored(5, 500), "they are needed from 400 to 700 nm"),
        (stored(50, 380), "spectra with nothing between 380 and 430 nm"),
        (SpectralPicture::black(1, 1, &[550.0]).unwrap(), "they are needed from 400 to 700 nm"),
    ] {
        let error = of_spectra(&picture, &quantities).unwrap_err().to_string();
        assert!(error.contains(said), "{error}");
    }
    let error = of_spectra(&stored(5, 380), &[Quantity::Illuminance]).unwrap_err().to_string();
    assert!(error.contains("illuminance is not a quantity of radiance"), "{error}");
}

/// Spectra are constant for half a step beyond their ends, and 0 further out.
#[test]
fn spectra_end_half_a_step_beyond_their_wavelengths() {
    let of = |wavelengths: &[f64], value: &dyn Fn(f64) -> f64| {
        let mut picture = SpectralPicture::black(1, 1, wavelengths).unwrap();
        picture.add([0, 0], &wavelengths.iter().map(|w| value(*w)).collect::<Vec<_>>(), 1.0);
        let (maps, _) = of_spectra(&picture, &[Quantity::Sy, Quantity::Luminance]).unwrap();
        [0, 1].map(|index| f64::from(maps[index].values.pixels()[0]))
    };
    let coarse: Vec<f64> = (410..=690).step_by(20).map(f64::from).collect();
    let whole: Vec<f64> = (380..=780).step_by(5).map(f64::from).collect();
    let (short, long) = (of(&coarse, &|_| 1.0), of(&whole, &|w| if (400.0..=700.0).contains(&w) { 1.0 } else { 0.0 }));
    for (short, long) in short.into_iter().zip(long) {
        assert!(long > 0.0 && (short / long - 1.0).abs() <= 4.0 * f64::from(f32::EPSILON), "{short} {long}");
    }
}

/// Beyond the ends of the locus there is no distance from it, but a circadian factor.
#[test]
fn lights_beyond_the_locus_have_no_distance_from_it() {
    let wavelengths: Vec<f64> = (380..=780).step_by(5).map(f64::from).collect();
    let line = |centre: f64| -> Vec<f64> {
        wavelengths.iter().map(|w| if (w - centre).abs() <= 5.0 { 1.0 } else { 0.0 }).collect()
    };
    let meter = Box::new(IndexMeter::<f64, 81>::new(SumGrid::CIE_5NM, RadiationConstant::Its1990));
    let (mut beyond, mut within) = (0, 0);
    for centre in (400..=700).step_by(20).map(f64::from) {
        let light = line(centre);
        let mut picture = SpectralPicture::black(1, 1, &wavelengths).unwrap();
        picture.add([0, 0], &light, 1.0);
        let (maps, _) = of_spectra(&picture, &[Quantity::Duv, Quantity::Acv]).unwrap();
        let [duv, acv] = [0, 1].map(|index| f64::from(maps[index].values.pixels()[0]));
        let expected = meter.measure(<&[f64; 81]>::try_from(light.as_slice()).unwrap()).unwrap().chromaticity.cct;
        assert!(acv.is_finite(), "{centre}");
        if expected.is_in_range() {
            assert!((duv - expected.duv).abs() <= 1e-6, "{centre}: {duv} {expected:?}");
            within += 1;
        } else {
            assert!(duv.is_nan(), "{centre}: {duv}");
            beyond += 1;
        }
    }
    assert!(beyond > 0 && within > 0, "{beyond} {within}");
}

/// The median between the two in the middle, and the range that leaves out half a per cent on either side, to the nearest pixel.
#[test]
fn maps_are_summed_up_in_a_few_numbers() {
    let wavelengths: Vec<f64> = (380..=780).step_by(5).map(f64::from).collect();
    let of = |count: usize, level: &dyn Fn(usize) -> f64| {
        let mut picture = SpectralPicture::black(count, 1, &wavelengths).unwrap();
        (0..count).for_each(|x| picture.add([x, 0], &vec![1.0; wavelengths.len()], level(x)));
        of_spectra(&picture, &[Quantity::Luminance]).unwrap().0.remove(0)
    };
    let near = |found: f64, expected: f64| (found / expected - 1.0).abs() <= 4.0 * f64::from(f32::EPSILON);
    let levels = [3.0, 1.0, 10.0, 2.0];
    let four = of(4, &|x| levels[x]);
    let one = four.statistics.min;
    for (found, expected) in [
        (four.statistics.median, 2.5),
        (four.statistics.mean, 4.0),
        (four.statistics.max, 10.0),
        (of(3, &|x| levels[x]).statistics.median, 3.0),
    ] {
        assert!(near(found / one, expected), "{found} {expected}");
    }
    // 0.005 of 150 steps is 0.75: the second pixel; 0.995 of them 149.25.
    let [low, high] = of(151, &|x| f64::from(u32::try_from(150 - x).unwrap()) + 1.0).usual_range().unwrap();
    assert!(near(low / one, 2.0) && near(high / one, 150.0), "{low} {high}");
}

/// Radiance files: each component within 1/128 of its pixel's largest.
#[test]
fn radiance_files_come_back_within_their_precision() {
    let file = folder("hdr").join("picture.hdr");
    for (width, height) in [(1, 1), (7, 5), (40, 3), (300, 2)] {
        let value = |k: usize| {
            f32::from(u16::try_from(k * 7919 % 1000).unwrap()) * 10.0_f32.powi(i32::try_from(k % 9).unwrap() - 4)
        };
        let picture =
            Picture::from_fn(width, height, |x, y| [0, 1, 2].map(|c| value(3 * (y * width + x) + c) - 0.1)).unwrap();
        write_hdr(&file, &picture).unwrap();
        let back = read_hdr(&file).unwrap();
        for (before, after) in picture.pixels().iter().zip(back.pixels()) {
            let largest = before.iter().copied().fold(0.0, f32::max);
            for (a, b) in before.iter().zip(after) {
                assert!((a.max(0.0) - b).abs() <= largest / 128.0 + 1e-32, "{before:?} {after:?}");
            }
        }
    }
    let text = fs::read(&file).unwrap();
    let header = String::from_utf8_lossy(&text[..160]).into_owned();
    assert!(
        header.starts_with("#?RADIANCE\n") && header.contains("\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 300\n"),
        "{header}"
    );
    let black = Picture::filled(2, 2, [f32::NAN, 0.0, 0.0]).unwrap();
    assert!(matches!(write_hdr(&file, &black), Err(ImageError::NotFinite { .. })));
    for length in 0..text.len() {
        if length % 17 == 0 {
            fs::write(&file, &text[..length]).unwrap();
            assert!(read_hdr(&file).unwrap_err().to_string().contains("picture.hdr"));
        }
    }
}
