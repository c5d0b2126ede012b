//! What `spectral render --spectral-exr` takes and writes.

use std::path::Path;
use std::sync::Mutex;

use renderers::image::{Picture, SpectralPicture, write_spectral_exr};
use renderers::render::{Spectra, SpectrumSink};
use renderers::spectral::{Palette, UniformBins};

use super::Failure;

/// Channels of a spectral EXR.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Channels {
    /// Values at every so many nm.
    Step(u16),
    /// So many means.
    Means(usize),
}

impl Channels {
    /// The spectra to render: bins that are rendered anyway are kept.
    pub(super) const fn spectra(self, rendered: Spectra) -> Spectra {
        match (rendered, self) {
            (Spectra::Uniform(count), _) | (_, Self::Means(count)) => Spectra::Uniform(count),
            (_, Self::Step(step)) => Spectra::Wavelengths(step),
        }
    }
}

pub(super) fn parse_channels(text: &str) -> Result<Channels, String> {
    let step = |text: &str| text.parse().ok().filter(|step| (1..=40).contains(step) && 400 % step == 0);
    let means = || text.parse().ok().filter(|n| (1..=1000).contains(n));
    match text.strip_suffix("nm") {
        Some(step_text) => step(step_text).map(Channels::Step),
        None => means().map(Channels::Means),
    }
    .ok_or_else(|| "expected a step that divides 400 nm, such as 5nm, or a number of means from 1 to 1000".to_owned())
}

/// Spectra of pixels as they come.
pub(super) struct Spectral {
    pub(super) spectra: Spectra,
    picture: Mutex<SpectralPicture>,
}

impl Spectral {
    pub(super) fn new(spectra: Spectra, [width, height]: [usize; 2]) -> Result<Self, Failure> {
        let no_light = Palette::default();
        let bins = match spectra {
            Spectra::Wavelengths(step) => UniformBins::at_wavelengths(&no_light, step),
            Spectra::Uniform(count) => UniformBins::new(&no_light, count),
            _ => Err(format!("no spectra with {spectra}")),
        };
        let picture = SpectralPicture::black(width, height, bins.map_err(Failure)?.wavelengths())?;
        Ok(Self { spectra, picture: Mutex::new(picture) })
    }

    pub(super) fn write(self, file: &Path, preview: &Picture, renderer: &str) -> Result<(), Failure> {
        let picture = self.picture.into_inner().map_err(|_| Failure("a thread has failed".to_owned()))?;
        let channels = match self.spectra {
            Spectra::Wavelengths(step) => format!("values at every {step} nm"),
            _ => "means over equal parts of 380 to 780 nm, named after their middles".to_owned(),
        };
        let said =
            [("channelContents", channels.as_str()), ("spectralUnit", "W.m^-2.sr^-1.nm^-1"), ("renderer", renderer)];
        Ok(write_spectral_exr(file, picture, preview, &said)?)
    }
}

impl SpectrumSink for Spectral {
    fn pixel(&self, at: [usize; 2], spectrum: &[f64], share: f64) {
        if let Ok(mut picture) = self.picture.lock() {
            picture.add(at, spectrum, share);
        }
    }
}
