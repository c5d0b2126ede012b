//! Spectral representations by name, and what each is made of.

use spectral_core::bilinear::Tensor;
use spectral_core::colour::rgb;

use crate::radiosity::Representation;
use crate::scene::Scene;
use crate::spectral::{
    ComponentResolver, Components, FactorOrder, IntervalSettings, Palette, Resolver, Role, Uniform, UniformBins,
};
use crate::whitted::RenderError;

/// How spectra are represented.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spectra {
    /// Adaptive intervals with a colour bound.
    Interval(IntervalSettings),
    /// Equal bins over 380–780 nm.
    Uniform(usize),
    /// Values at every so many nm from 380 to 780: [`UniformBins::at_wavelengths`].
    Wavelengths(u16),
    /// The naive product of three components.
    Rgb,
    /// The product of three components, those of materials filtered for the light that is the strongest in the scene.
    RgbPrefiltered,
    /// The bilinear product of three components.
    Bilinear,
    /// The same with this much transferred into red, green and blue: α of Granier and Damez 2004, section 6.2.
    BilinearAlpha([f64; 3]),
    /// Spectra of ten bins, made of three components.
    Smits,
}

impl Default for Spectra {
    /// Intervals with a certified bound of ΔE*ab 1.
    fn default() -> Self {
        Self::Interval(IntervalSettings::default())
    }
}

impl Spectra {
    /// What colour differences are relative to: the settings' white for intervals, Rec. 709's at Y = 1 for others.
    pub(super) fn white(&self) -> [f64; 3] {
        if let Self::Interval(settings) = self { settings.white() } else { rgb::WHITE }
    }

    /// Whether products of spectra may be reordered.
    pub(super) const fn factor_order(&self) -> FactorOrder {
        match self {
            Self::Bilinear | Self::BilinearAlpha(_) => FactorOrder::Kept,
            Self::Interval(_)
            | Self::Uniform(_)
            | Self::Wavelengths(_)
            | Self::Rgb
            | Self::RgbPrefiltered
            | Self::Smits => FactorOrder::Free,
        }
    }
}

impl core::fmt::Display for Spectra {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Interval(_) => write!(f, "interval"),
            Self::Uniform(count) => write!(f, "uniform:{count}"),
            Self::Wavelengths(step) => write!(f, "wavelengths:{step}"),
            Self::Rgb => write!(f, "rgb"),
            Self::RgbPrefiltered => write!(f, "rgb-prefiltered"),
            Self::Bilinear => write!(f, "bilinear"),
            Self::BilinearAlpha([r, g, b]) => write!(f, "bilinear:{r},{g},{b}"),
            Self::Smits => write!(f, "smits"),
        }
    }
}

/// What is done with a spectral representation, whichever it is.
pub(super) trait Represented: Sized {
    /// What comes of it.
    type Output;

    /// Does it with adaptive intervals.
    fn with_intervals(self, settings: IntervalSettings) -> Result<Self::Output, RenderError>;

    /// Does it with bins or components, and resolvers for them.
    fn with<R: Resolver>(
        self,
        representation: &dyn Representation,
        new_resolver: impl Fn() -> R + Sync,
    ) -> Result<Self::Output, RenderError>;
}

impl Spectra {
    /// Makes the representation of a palette, and does something with it.
    pub(super) fn apply<W: Represented>(
        self,
        scene: &Scene,
        palette: &Palette,
        work: W,
    ) -> Result<W::Output, RenderError> {
        let bins = |bins: UniformBins, work: W| work.with(&bins, || Uniform::new(&bins));
        let components =
            |components: Components, work: W| work.with(&components, || ComponentResolver::new(&components));
        match self {
            Self::Interval(settings) => work.with_intervals(settings),
            Self::Uniform(count) => bins(UniformBins::new(palette, count).map_err(RenderError::new)?, work),
            Self::Wavelengths(step) => {
                bins(UniformBins::at_wavelengths(palette, step).map_err(RenderError::new)?, work)
            }
            Self::Smits => bins(UniformBins::smits(palette).map_err(RenderError::new)?, work),
            Self::Rgb => components(Components::naive(palette).map_err(RenderError::new)?, work),
            Self::RgbPrefiltered => components(prefiltered(scene, palette)?, work),
            Self::Bilinear | Self::BilinearAlpha(_) => components(bilinear(self, palette)?, work),
        }
    }
}

/// Components for the bilinear product, with the transfer that is asked for.
pub(crate) fn bilinear(spectra: Spectra, palette: &Palette) -> Result<Components, RenderError> {
    let tensor = match spectra {
        Spectra::BilinearAlpha(alpha) => {
            Tensor::rec_709().with_alpha(alpha).map_err(|e| RenderError::new(e.to_string()))?
        }
        _ => Tensor::rec_709(),
    };
    Components::bilinear(palette, &tensor).map_err(RenderError::new)
}

/// Components filtered for the light with the largest luminous flux.
pub(crate) fn prefiltered(scene: &Scene, palette: &Palette) -> Result<Components, RenderError> {
    let Some(spectrum) = scene.dominant_light() else {
        return Err(RenderError::new("rgb-prefiltered needs a light, and the scene has none"));
    };
    let spectrum = scene.spectrum(spectrum);
    let mut own = Palette::default();
    own.factor(spectrum, Role::Light);
    let light = own.leaves().first().map(|(light, _)| light.clone());
    let light = light.ok_or_else(|| RenderError::new("the dominant light has no spectrum"))?;
    Components::prefiltered(palette, &light)
        .map_err(|e| RenderError::new(format!("rgb-prefiltered, {}: {e}", spectrum.label)))
}
