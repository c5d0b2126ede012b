//! What a rendering has come to, in a file: it goes on from there as if it had never stopped.
//!
//! A line says what was rendered, then come the numbers of all pixels in little-endian order and a hash of them.

use core::fmt::{self, Write as _};
use std::io::{ErrorKind, Write as _};
use std::path::Path;

use super::Paths;
use super::film::{NUMBERS, Pixel};
use crate::image::write_atomic;
use crate::scene::{Sampler, Scene};
use crate::whitted::RenderError;

/// To be raised whenever the same sample comes out otherwise than before.
const VERSION: u32 = 1;

/// What must be the same for a rendering to go on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Identity {
    pub(super) scene: u128,
    pub(super) size: [usize; 2],
    pub(super) seed: u64,
    /// The representation, and after a slash what is steered by, if that isn't the default.
    pub(super) spectra: String,
    pub(super) paths: Paths,
}

/// The FNV-1a hash of 128 bits (G. Fowler, L. C. Noll, K.-P. Vo).
#[derive(Clone, Copy, Debug)]
struct Hash(u128);

impl Default for Hash {
    fn default() -> Self {
        Self(0x6c62_272e_07bb_0142_62b8_2175_6295_c58d)
    }
}

impl Hash {
    fn add(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u128::from(*byte)).wrapping_mul(0x0000_0000_0100_0000_0000_0000_0000_013b);
        }
    }
}

impl fmt::Write for Hash {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.add(text.as_bytes());
        Ok(())
    }
}

/// A number that differs for scenes that differ in anything but name, image size, sample count and seed.
pub(super) fn digest(scene: &Scene) -> u128 {
    let mut film = scene.film;
    (film.width, film.height) = (0, 0);
    let sampler = Sampler { sample_count: 0, seed: 0 };
    let scene = Scene { name: String::new(), film, sampler, ..scene.clone() };
    let mut hash = Hash::default();
    // Every number in it is written with all its digits.
    let _ = write!(hash, "{scene:?}");
    hash.0
}

/// What a file of such paths calls itself.
const fn word(paths: Paths) -> &'static str {
    match paths {
        Paths::All => "path",
        Paths::WithoutCaustics => "path-without-caustics",
    }
}

impl Identity {
    fn head(&self, samples: u32) -> String {
        let Self { scene, size: [width, height], seed, spectra, paths } = self;
        let paths = word(*paths);
        format!(
            "spectral {paths} {VERSION} scene {scene:032x} size {width}x{height} seed {seed} spectra {spectra} samples {samples}\n"
        )
    }

    /// What differs from the head of a file, or the samples that it has.
    fn check(&self, head: &str) -> Result<u32, &'static str> {
        const DAMAGED: &str = "is not the state of a path-traced picture";
        let words: Vec<&str> = head.split(' ').collect();
        let [
            "spectral",
            paths,
            version,
            "scene",
            scene,
            "size",
            size,
            "seed",
            seed,
            "spectra",
            spectra,
            "samples",
            samples,
        ] = words[..]
        else {
            return Err(DAMAGED);
        };
        if ![Paths::All, Paths::WithoutCaustics].map(word).contains(&paths) {
            return Err(DAMAGED);
        }
        let [width, height] = self.size;
        if version != VERSION.to_string() {
            return Err("is of another version of this program");
        }
        for (same, otherwise) in [
            (paths == word(self.paths), "is of other paths, with or without caustics"),
            (scene == format!("{:032x}", self.scene), "is of another scene"),
            (size == format!("{width}x{height}"), "is of another image size"),
            (seed == self.seed.to_string(), "is of another seed"),
            (representation(spectra) == representation(&self.spectra), "is of another representation of spectra"),
            (spectra == self.spectra, "is steered otherwise"),
        ] {
            if !same {
                return Err(otherwise);
            }
        }
        samples.parse().map_err(|_| DAMAGED)
    }
}

/// What comes before the slash.
fn representation(spectra: &str) -> &str {
    spectra.split('/').next().unwrap_or_default()
}

/// The pixels in a state file and how many samples they have; `None` if there is no such file.
pub(super) fn read(path: &Path, identity: &Identity) -> Result<Option<(Vec<Pixel>, u32)>, RenderError> {
    let fail = |reason: &str| RenderError::new(format!("{}: {reason}", path.display()));
    let bytes = match std::fs::read(path) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(fail(&error.to_string())),
    };
    let end = bytes.iter().take(1024).position(|b| *b == b'\n').unwrap_or(0);
    let head = String::from_utf8_lossy(&bytes[..end]);
    let samples = identity.check(&head).map_err(fail)?;
    let [width, height] = identity.size;
    let expected = width * height * NUMBERS * size_of::<f64>();
    let body = bytes.get(end + 1..).unwrap_or_default();
    let Some((numbers, hash)) = body.split_at_checked(expected) else { return Err(fail("is too short")) };
    if hash_of(&head, numbers).to_le_bytes() != hash {
        return Err(fail("is damaged"));
    }
    let pixel = |bytes: &[u8]| {
        let mut numbers = [0.0; NUMBERS];
        for (number, bytes) in numbers.iter_mut().zip(bytes.as_chunks().0) {
            *number = f64::from_le_bytes(*bytes);
        }
        Pixel::from_numbers(&numbers)
    };
    Ok(Some((numbers.chunks_exact(NUMBERS * size_of::<f64>()).map(pixel).collect(), samples)))
}

/// Writes a state file: complete, or not at all.
pub(super) fn write(path: &Path, identity: &Identity, pixels: &[Pixel], samples: u32) -> Result<(), RenderError> {
    let head = identity.head(samples);
    let numbers: Vec<u8> = pixels.iter().flat_map(Pixel::numbers).flat_map(f64::to_le_bytes).collect();
    let hash = hash_of(head.trim_end(), &numbers);
    write_atomic(path, |file| {
        file.write_all(head.as_bytes())?;
        file.write_all(&numbers)?;
        file.write_all(&hash.to_le_bytes())
    })
    .map_err(|e| RenderError::new(e.to_string()))
}

fn hash_of(head: &str, numbers: &[u8]) -> u128 {
    let mut hash = Hash::default();
    hash.add(head.as_bytes());
    hash.add(numbers);
    hash.0
}
