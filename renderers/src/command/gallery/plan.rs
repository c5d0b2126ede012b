//! What the gallery shows: for each built-in scene the ways to render it, and which of them the others are compared with.

use super::papers::Figure;

/// One way to render a scene.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mode {
    /// Its name on the page and of its folder.
    pub(super) name: &'static str,
    /// Options of `spectral render`, separated by blanks.
    pub(super) options: &'static str,
}

/// A scene, or a view of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    /// The heading, and the name of its folder.
    pub(super) name: &'static str,
    pub(super) scene: &'static str,
    /// Options that are the same for all modes.
    pub(super) options: &'static [&'static str],
    /// Photons that are thrown, of renderers that throw some by number.
    pub(super) photons: Option<u32>,
    /// What makes diffuse white Y = 1, more or less.
    pub(super) exposure: f32,
    pub(super) modes: &'static [Mode],
    /// The mode that the others are compared with, by name.
    pub(super) reference: &'static str,
    /// What of its light is mapped: options of `spectral map`.
    pub(super) maps: &'static [&'static str],
}

/// Where the maps of an entry are, beside its modes.
pub(super) const MAPS: &str = "maps";

impl Entry {
    /// The numbers of papers that belong to it.
    pub(super) fn figures<'f>(&self, all: &'f [Figure]) -> impl Iterator<Item = &'f Figure> {
        let name = self.name;
        all.iter().filter(move |figure| figure.entry == name)
    }
}

const fn mode(name: &'static str, options: &'static str) -> Mode {
    Mode { name, options }
}

/// Direct light by all representations.
const DIRECT: &[Mode] = &[
    mode("interval", "--spectra interval"),
    mode("uniform-401", "--spectra uniform:401"),
    mode("rgb", "--spectra rgb"),
    mode("bilinear", "--spectra bilinear"),
    mode("smits", "--spectra smits"),
    mode("rgb-prefiltered", "--spectra rgb-prefiltered"),
];

/// All light between surfaces by all representations.
const ALL_LIGHT: &[Mode] = &[
    mode("interval", "--renderer radiosity --accuracy 0.05 --spectra interval"),
    mode("uniform-81", "--renderer radiosity --accuracy 0.05 --spectra uniform:81"),
    mode("rgb", "--renderer radiosity --accuracy 0.05 --spectra rgb"),
    mode("bilinear", "--renderer radiosity --accuracy 0.05 --spectra bilinear"),
    mode("smits", "--renderer radiosity --accuracy 0.05 --spectra smits"),
    mode("rgb-prefiltered", "--renderer radiosity --accuracy 0.05 --spectra rgb-prefiltered"),
];

/// Where all surfaces are grey, there is nothing to compare but renderers.
const GREY: &[Mode] = &[
    mode("interval", "--renderer radiosity --accuracy 0.05 --spectra interval"),
    mode("uniform-81", "--renderer radiosity --accuracy 0.05 --spectra uniform:81"),
];

/// The ways of Iehl and Péroche.
const BOUNDS: &[Mode] = &[
    mode("certified", "--threshold 3 --bound certified"),
    mode("corrected", "--threshold 3 --bound corrected"),
    mode("paper", "--threshold 3 --bound paper"),
    mode("uniform-401", "--spectra uniform:401"),
];

/// Mirrors, glass and highlights.
const SPECULAR: &[Mode] =
    &[mode("interval", "--spectra interval"), mode("uniform-81", "--spectra uniform:81"), mode("rgb", "--spectra rgb")];

/// Caustics, with the light between surfaces.
const CAUSTICS: &[Mode] = &[
    mode("interval", "--renderer photon-map --accuracy 0.1 --spectra interval"),
    mode("uniform-81", "--renderer photon-map --accuracy 0.1 --spectra uniform:81"),
    mode("rgb", "--renderer photon-map --accuracy 0.1 --spectra rgb"),
];

/// Caustics, with an ambient term as Iehl and Péroche have it.
const PHOTONS: &[Mode] = &[
    mode("interval", "--renderer photon-map --between ambient --threshold 3"),
    mode("uniform-24", "--renderer photon-map --between ambient --spectra uniform:24"),
];

/// What light does to people and plants: what the eye gets, and what leaves do.
const LIFE: &[&str] = &["--quantity acv,melanopic --of radiance", "--quantity sy"];

const fn entry(name: &'static str, exposure: f32, modes: &'static [Mode], reference: &'static str) -> Entry {
    Entry { name, scene: name, options: &[], photons: None, exposure, modes, reference, maps: &[] }
}

const fn mapped(entry: Entry, maps: &'static [&'static str]) -> Entry {
    Entry { maps, ..entry }
}

const fn with_photons(entry: Entry, photons: u32) -> Entry {
    Entry { photons: Some(photons), ..entry }
}

/// All of the gallery, in the order of the page.
pub(super) const ENTRIES: &[Entry] = &[
    entry("cornell-box", 1.0, DIRECT, "uniform-401"),
    entry("cornell-box-sodium", 1.0, DIRECT, "uniform-401"),
    entry("cornell-box-lamp", 1.0, ALL_LIGHT, "uniform-81"),
    entry("cornell-box-paper", 1.0, BOUNDS, "uniform-401"),
    entry("cornell-box-spheres", 1.0, SPECULAR, "uniform-81"),
    with_photons(entry("cornell-box-glass", 1.0, CAUSTICS, "uniform-81"), 100_000),
    with_photons(entry("caustic-ring", 1.0, PHOTONS, "uniform-24"), 37_004),
    with_photons(entry("caustic-ring-mirror", 1.0, PHOTONS, "uniform-24"), 37_004),
    with_photons(entry("prism", 1.0, PHOTONS, "uniform-24"), 40_558),
    with_photons(entry("prism-lamp", 1.0, PHOTONS, "uniform-24"), 10_000),
    entry("grazing", 1.0, SPECULAR, "uniform-81"),
    entry("cie-171-5-8", 1500.0, GREY, "uniform-81"),
    entry("furnace", 0.5, GREY, "uniform-81"),
    entry("lounge", 1.0, ALL_LIGHT, "uniform-81"),
    mapped(entry("neumann-schanda", 1.0, ALL_LIGHT, "uniform-81"), &["--quantity cct,ra"]),
    entry("fluorescent-spheres", 600.0, ALL_LIGHT, "uniform-81"),
    mapped(entry("cri-room", 500.0, ALL_LIGHT, "uniform-81"), &["--quantity illuminance,cct,ra,cri00"]),
    mapped(entry("seminar-room", 800.0, ALL_LIGHT, "uniform-81"), &["--quantity illuminance,cct,cri00"]),
    mapped(entry("office", 150.0, ALL_LIGHT, "uniform-81"), LIFE),
    Entry {
        name: "office-workplace",
        scene: "office",
        options: &["-Dorigin=1.5 -1.6 1.25", "-Dtarget=1.7 0.2 1.05", "-Dfov=90"],
        photons: None,
        exposure: 150.0,
        modes: ALL_LIGHT,
        reference: "uniform-81",
        maps: LIFE,
    },
];

#[cfg(test)]
mod tests {
    use renderers::scene::builtin;

    use super::*;
    use crate::command::gallery::papers;

    #[test]
    fn every_built_in_scene_is_shown_and_has_a_reference() {
        for name in builtin::names() {
            assert!(ENTRIES.iter().any(|entry| entry.scene == name), "{name} is missing");
        }
        for entry in ENTRIES {
            assert!(builtin::names().any(|name| name == entry.scene), "{}", entry.name);
            assert!(entry.modes.iter().any(|mode| mode.name == entry.reference), "{}", entry.name);
        }
    }

    #[test]
    fn every_number_of_a_paper_belongs_to_a_mode() {
        let figures = papers::figures().unwrap();
        assert!(figures.len() >= 8);
        for figure in &figures {
            let entry = ENTRIES.iter().find(|entry| entry.name == figure.entry);
            let modes = entry.map(|entry| entry.modes).unwrap_or_default();
            let is_map = figure.mode == MAPS && entry.is_some_and(|entry| !entry.maps.is_empty());
            assert!(is_map || modes.iter().any(|mode| mode.name == figure.mode), "{figure:?}");
        }
    }
}
