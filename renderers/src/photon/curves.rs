//! Where photons of a path land, as a function of the wavelength: between some wavelengths at which they were thrown.
//!
//! Throwing every path again for every interval (Iehl–Péroche 2000, §5.1) costs as much as all photons, each time. But the place where a path
//! lands is a smooth function of the wavelength as long as it takes the same reflections and refractions and meets the same shapes:
//! between two wavelengths it is linear in 1/λ², as Cauchy's index is, to the second order. So paths are thrown at a few *keys*, and
//! photons that correspond to each other at two neighbouring keys are interpolated; those that don't stay where they are, each up to the middle.

use core::cmp::Ordering;

use super::{Photon, Scattered};

/// Photons at wavelengths between keys.
#[derive(Clone, Debug, Default)]
pub(crate) struct Curves {
    stretches: Vec<Stretch>,
}

/// The wavelengths between two neighbouring keys.
#[derive(Clone, Debug)]
struct Stretch {
    /// In nm.
    limits: [f64; 2],
    photons: Vec<Tween>,
}

/// One photon at the ends of a stretch.
#[derive(Clone, Copy, Debug)]
struct Tween {
    path: u32,
    ends: Ends,
}

#[derive(Clone, Copy, Debug)]
enum Ends {
    Both([Photon; 2]),
    First(Photon),
    Last(Photon),
}

impl Curves {
    /// Photons thrown at increasing wavelengths in nm, each list in the order of paths and their branches.
    pub(crate) fn new(keys: &[(f64, Vec<Scattered>)]) -> Self {
        let stretch = |pair: &[(f64, Vec<Scattered>)]| Stretch {
            limits: [pair[0].0, pair[1].0],
            photons: tweens(&pair[0].1, &pair[1].1),
        };
        Self { stretches: keys.windows(2).map(stretch).collect() }
    }

    /// The photons of all paths, each at a wavelength in nm of its own between the limits; beyond the first and the last key as at that key.
    pub(crate) fn photons(&self, [from, to]: [f64; 2], wavelength_of: impl Fn(u32) -> f64) -> Vec<Photon> {
        let mut photons = Vec::new();
        let last = self.stretches.len().saturating_sub(1);
        for (number, stretch) in self.stretches.iter().enumerate() {
            let [mut first, mut end] = stretch.limits;
            if number == 0 {
                first = f64::NEG_INFINITY;
            }
            if number == last {
                end = f64::INFINITY;
            }
            if to < first || from >= end {
                continue;
            }
            for tween in &stretch.photons {
                let wavelength = wavelength_of(tween.path);
                if (first..end).contains(&wavelength) {
                    photons.extend(tween.ends.at(stretch.between(wavelength)));
                }
            }
        }
        photons
    }

    /// The photons of all paths, each at a wavelength in nm of its own, and how each moves; `None` where that is not the same for all wavelengths,
    /// as there are more keys than two.
    pub(crate) fn moving(&self, wavelength_of: impl Fn(u32) -> f64) -> Option<(Vec<Photon>, Vec<Motion>)> {
        let [stretch] = self.stretches.as_slice() else { return None };
        let mut moving = (Vec::with_capacity(stretch.photons.len()), Vec::with_capacity(stretch.photons.len()));
        for tween in &stretch.photons {
            let t = stretch.between(wavelength_of(tween.path));
            if let Some(photon) = tween.ends.at(t) {
                moving.0.push(photon);
                moving.1.push(tween.motion(t));
            }
        }
        Some(moving)
    }

    /// Where a wavelength is between the first and the last key, from 0 to 1.
    pub(crate) fn between(&self, wavelength: f64) -> f64 {
        match self.stretches.as_slice() {
            [stretch, ..] => stretch.between(wavelength),
            [] => 0.0,
        }
    }

    /// Bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.stretches.iter().map(|s| s.photons.capacity() * size_of::<Tween>()).sum()
    }
}

/// How a photon moves with the wavelength: its change from the first to the last key.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Motion {
    /// In scene units.
    position: [f32; 3],
    flux: f32,
    /// Where between the keys the photon is that moves.
    at: f32,
}

impl Motion {
    /// The farthest that the photon goes, in scene units.
    pub(crate) fn reach(&self) -> f32 {
        glam::Vec3A::from_array(self.position).length() * self.at.max(1.0 - self.at)
    }

    /// Where the photon is, and its flux, at another place between the keys; it stays where it is if that is too far.
    pub(crate) fn moved(&self, photon: &Photon, to: f32, farthest: f32) -> ([f32; 3], f32) {
        let t = to - self.at;
        let way = glam::Vec3A::from_array(self.position) * t;
        let position = glam::Vec3A::from_array(photon.position);
        let position = if way.length_squared() <= farthest * farthest { position + way } else { position };
        (position.to_array(), (photon.flux + self.flux * t).max(0.0))
    }
}

impl Tween {
    #[allow(clippy::cast_possible_truncation, reason = "photons are kept in f32")]
    fn motion(&self, t: f64) -> Motion {
        let still = Motion { position: [0.0; 3], flux: 0.0, at: t as f32 };
        match self.ends {
            Ends::Both([first, last]) => Motion {
                position: core::array::from_fn(|i| last.position[i] - first.position[i]),
                flux: last.flux - first.flux,
                ..still
            },
            Ends::First(_) | Ends::Last(_) => still,
        }
    }
}

impl Stretch {
    fn between(&self, wavelength: f64) -> f64 {
        between(self.limits, wavelength)
    }
}

/// Where a wavelength is between two others, by 1/λ²: from 0 to 1.
fn between([first, last]: [f64; 2], wavelength: f64) -> f64 {
    let measure = |w: f64| 1.0 / (w * w);
    ((measure(wavelength) - measure(first)) / (measure(last) - measure(first))).clamp(0.0, 1.0)
}

/// The wavelength in the middle of two others, by the same measure.
fn middle(first: f64, last: f64) -> f64 {
    (2.0 / (1.0 / (first * first) + 1.0 / (last * last))).sqrt()
}

impl Ends {
    /// The photon at a place from 0 to 1.
    #[allow(clippy::cast_possible_truncation, reason = "photons are kept in f32")]
    fn at(&self, t: f64) -> Option<Photon> {
        match self {
            Self::Both([first, last]) => {
                let t = t as f32;
                let mix = |a: f32, b: f32| a + (b - a) * t;
                let mix_all = |a: [f32; 3], b: [f32; 3]| core::array::from_fn(|i| mix(a[i], b[i]));
                let direction = glam::Vec3A::from_array(mix_all(first.direction, last.direction));
                Some(Photon {
                    position: mix_all(first.position, last.position),
                    direction: direction.normalize_or(glam::Vec3A::from_array(first.direction)).to_array(),
                    flux: mix(first.flux, last.flux),
                    ..*first
                })
            }
            Self::First(photon) => (t < 0.5).then_some(*photon),
            Self::Last(photon) => (t >= 0.5).then_some(*photon),
        }
    }
}

/// Calls with the photons of two lists, each in the order of paths and branches: those that correspond to each other together.
fn pair_up(first: &[Scattered], last: &[Scattered], mut call: impl FnMut(Option<&Scattered>, Option<&Scattered>)) {
    let key = |s: &Scattered| (s.path, s.branch);
    let (mut first, mut last) = (first.iter().peekable(), last.iter().peekable());
    loop {
        let order = match (first.peek(), last.peek()) {
            (None, None) => return,
            (Some(_), None) => Ordering::Less,
            (None, Some(_)) => Ordering::Greater,
            (Some(a), Some(b)) => key(a).cmp(&key(b)),
        };
        match order {
            Ordering::Less => call(first.next(), None),
            Ordering::Greater => call(None, last.next()),
            Ordering::Equal => match (first.next(), last.next()) {
                (Some(a), Some(b))
                    if a.photon.surface != b.photon.surface || a.photon.spectrum != b.photon.spectrum =>
                {
                    call(Some(a), None);
                    call(None, Some(b));
                }
                (a, b) => call(a, b),
            },
        }
    }
}

fn tweens(first: &[Scattered], last: &[Scattered]) -> Vec<Tween> {
    let mut photons = Vec::with_capacity(first.len().max(last.len()));
    pair_up(first, last, |a, b| {
        let tween = match (a, b) {
            (Some(a), Some(b)) => Tween { path: a.path, ends: Ends::Both([a.photon, b.photon]) },
            (Some(a), None) => Tween { path: a.path, ends: Ends::First(a.photon) },
            (None, Some(b)) => Tween { path: b.path, ends: Ends::Last(b.photon) },
            (None, None) => return,
        };
        photons.push(tween);
    });
    photons
}

/// How well photons are interpolated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Misfit {
    /// The distance that nine of ten photons in the middle of a stretch are not farther than from where they are thought to be.
    distance: f32,
    /// The share of the flux there that corresponds to nothing.
    strange: f32,
    /// How much the other fluxes there differ from what they are thought to be, relative to themselves.
    change: f32,
}

/// Compares photons that were thrown in the middle of a stretch with what its ends say.
fn misfit([first, middle, last]: [&[Scattered]; 3]) -> Misfit {
    let mut thought = Vec::new();
    pair_up(first, last, |a, b| {
        if let (Some(a), Some(b)) = (a, b)
            && let Some(photon) = Ends::Both([a.photon, b.photon]).at(0.5)
        {
            thought.push(Scattered { photon, ..*a });
        }
    });
    let (mut distances, mut strange, mut total) = (Vec::new(), 0.0, 0.0);
    pair_up(&thought, middle, |thought, thrown| {
        total += thrown.map_or(0.0, |s| s.photon.flux);
        match (thought, thrown) {
            (Some(a), Some(b)) => {
                let [a, b] = [a, b].map(|s| glam::Vec3A::from_array(s.photon.position));
                distances.push(a.distance(b));
            }
            (one, other) => strange += one.or(other).map_or(0.0, |s| s.photon.flux),
        }
    });
    let strange = if total > 0.0 { strange / total } else { 0.0 };
    Misfit { distance: of_nine_in_ten(&mut distances), strange, change: change(&thought, middle) }
}

/// How much the fluxes differ of photons that correspond to each other, relative to themselves: the sum of all differences.
pub(crate) fn change(first: &[Scattered], last: &[Scattered]) -> f32 {
    let (mut differences, mut total) = (0.0, 0.0);
    pair_up(first, last, |a, b| {
        if let (Some(a), Some(b)) = (a, b) {
            let [a, b] = [a, b].map(|s| s.photon.flux);
            differences += (a - b).abs();
            total += a.max(b);
        }
    });
    if total > 0.0 { differences / total } else { 0.0 }
}

/// How far nine of ten photons move at most between two wavelengths at which they were thrown.
pub(crate) fn shift(first: &[Scattered], last: &[Scattered]) -> f32 {
    let mut distances = Vec::new();
    pair_up(first, last, |a, b| {
        if let (Some(a), Some(b)) = (a, b) {
            let [a, b] = [a, b].map(|s| glam::Vec3A::from_array(s.photon.position));
            distances.push(a.distance(b));
        }
    });
    of_nine_in_ten(&mut distances)
}

/// Calls with the places of photons that correspond to each other.
pub(crate) fn places(first: &[Scattered], last: &[Scattered], mut call: impl FnMut([f32; 3], [f32; 3])) {
    pair_up(first, last, |a, b| {
        if let (Some(a), Some(b)) = (a, b) {
            call(a.photon.position, b.photon.position);
        }
    });
}

/// What nine of ten numbers don't exceed; 0 if there are none.
pub(crate) fn of_nine_in_ten(distances: &mut [f32]) -> f32 {
    let place = distances.len() * 9 / 10;
    if distances.is_empty() { 0.0 } else { *distances.select_nth_unstable_by(place, f32::total_cmp).1 }
}

/// The share of flux that may correspond to nothing in the middle of a stretch, how much the rest may differ, and how often a stretch is
/// halved at most.
const STRANGE: f32 = 0.02;
const CHANGE: f32 = 0.01;
const HALVINGS: u32 = 4;

/// Wavelengths in nm, in increasing order, between which photons may be interpolated: nine of ten within a distance, and their fluxes. `throw` throws some paths at a
/// wavelength.
pub(crate) fn keys(limits: [f64; 2], distance: f32, throw: &impl Fn(f64) -> Vec<Scattered>) -> Vec<f64> {
    let ends = limits.map(|wavelength| (wavelength, throw(wavelength)));
    let mut keys = vec![limits[0]];
    halve(&ends[0], &ends[1], distance, throw, HALVINGS, &mut keys);
    keys
}

/// Adds the keys after the first, up to the last.
fn halve(
    first: &(f64, Vec<Scattered>),
    last: &(f64, Vec<Scattered>),
    distance: f32,
    throw: &impl Fn(f64) -> Vec<Scattered>,
    halvings: u32,
    keys: &mut Vec<f64>,
) {
    let wavelength = middle(first.0, last.0);
    let between = (wavelength, throw(wavelength));
    let misfit = misfit([&first.1, &between.1, &last.1]);
    let fits = misfit.distance <= distance && misfit.strange <= STRANGE && misfit.change <= CHANGE;
    if halvings == 0 || fits {
        keys.push(last.0);
        return;
    }
    halve(first, &between, distance, throw, halvings - 1, keys);
    halve(&between, last, distance, throw, halvings - 1, keys);
}

#[cfg(test)]
mod tests {
    use super::{Curves, keys};
    use crate::photon::{Photon, Scattered};

    /// Photons of a made-up prism: path p lands at p + spread(λ), and path 7 meets another shape beyond 500 nm.
    fn thrown(wavelength: f64, spread: impl Fn(f64) -> f64) -> Vec<Scattered> {
        let photon = |path: u32| {
            #[allow(clippy::cast_possible_truncation, reason = "a made-up place")]
            let place = (f64::from(path) + spread(wavelength)) as f32;
            Scattered {
                photon: Photon {
                    position: [place, 0.0, 1.0],
                    direction: [0.0, 0.0, 1.0],
                    flux: 1.0,
                    spectrum: 0,
                    surface: if path == 7 && wavelength > 500.0 { 3 } else { 1 },
                },
                path,
                branch: 0,
            }
        };
        (0..100).map(photon).collect()
    }

    fn cauchy(wavelength: f64) -> f64 {
        1e5 / (wavelength * wavelength)
    }

    #[test]
    fn what_follows_cauchys_index_needs_two_keys() {
        let throw = |wavelength: f64| thrown(wavelength, cauchy);
        // One path of a hundred that goes elsewhere is within what is allowed.
        assert_eq!(keys([400.0, 700.0], 1e-4, &throw), [400.0, 700.0]);
        let curves = Curves::new(&[(400.0, throw(400.0)), (700.0, throw(700.0))]);
        for wavelength in [400.0, 450.0, 555.0, 699.0] {
            let photons = curves.photons([wavelength; 2], |_| wavelength);
            assert_eq!(photons.len(), 100);
            for (photon, exact) in photons.iter().zip(throw(wavelength)).filter(|(_, s)| s.path != 7) {
                assert!((photon.position[0] - exact.photon.position[0]).abs() <= 1e-4);
            }
        }
        let photons = curves.photons([450.0; 2], |_| 450.0);
        assert_eq!(photons.iter().filter(|p| p.surface == 1).count(), 100);
        let photons = curves.photons([650.0; 2], |_| 650.0);
        assert_eq!(photons.iter().filter(|p| p.surface == 3).count(), 1);
    }

    #[test]
    fn what_bends_more_needs_more_keys() {
        let bent = |wavelength: f64| 10.0 * (wavelength / 400.0).powi(-12);
        let throw = |wavelength: f64| thrown(wavelength, bent);
        let found = keys([400.0, 700.0], 0.05, &throw);
        assert!((5..17).contains(&found.len()) && found.windows(2).all(|pair| pair[0] < pair[1]), "{found:?}");
        let keyed: Vec<_> = found.iter().map(|w| (*w, throw(*w))).collect();
        let curves = Curves::new(&keyed);
        for step in 0..60 {
            let wavelength = 400.0 + 5.0 * f64::from(step);
            let photons = curves.photons([wavelength; 2], |_| wavelength);
            for (photon, exact) in photons.iter().zip(throw(wavelength)).filter(|(_, s)| s.path != 7) {
                assert!((photon.position[0] - exact.photon.position[0]).abs() <= 0.1);
            }
        }
    }

    /// Between two keys a photon's motion leads from its place at one wavelength to that at any other; what is too far stays, and with more keys
    /// no motion is the same for all wavelengths.
    #[test]
    fn motions_lead_from_wavelength_to_wavelength() {
        let throw = |wavelength: f64| thrown(wavelength, cauchy);
        let curves = Curves::new(&[(400.0, throw(400.0)), (700.0, throw(700.0))]);
        let (photons, motions) = curves.moving(|path| 400.0 + 3.0 * f64::from(path)).unwrap();
        assert_eq!((photons.len(), motions.len()), (100, 100));
        for wavelength in [400.0, 450.0, 555.0, 700.0] {
            #[allow(clippy::cast_possible_truncation, reason = "as photons are")]
            let to = curves.between(wavelength) as f32;
            for ((photon, motion), exact) in photons.iter().zip(&motions).zip(throw(wavelength)) {
                let ([place, ..], flux) = motion.moved(photon, to, 1.0);
                let [stays, ..] = motion.moved(photon, to, 0.0).0;
                assert!((flux - 1.0).abs() <= 1e-6 && stays == photon.position[0]);
                // Path 7 meets another shape: nothing is known of its way there.
                let expected = if exact.path == 7 { stays } else { exact.photon.position[0] };
                assert!((place - expected).abs() <= 2e-5, "{wavelength} {}: {place} {expected}", exact.path);
                assert!((place - photon.position[0]).abs() <= motion.reach() + 1e-5);
            }
        }
        let keyed: Vec<_> = [400.0, 480.0, 700.0].map(|w| (w, throw(w))).into();
        assert!(Curves::new(&keyed).moving(|_| 500.0).is_none());
    }

    /// A band takes each path once, wherever its own wavelength is.
    #[test]
    fn each_path_is_there_once() {
        let throw = |wavelength: f64| thrown(wavelength, cauchy);
        let keyed: Vec<_> = [400.0, 480.0, 600.0, 700.0].map(|w| (w, throw(w))).into();
        let curves = Curves::new(&keyed);
        let own = |path: u32| 390.0 + 320.0 * f64::from(path) / 99.0;
        let mut places: Vec<_> = curves.photons([390.0, 710.0], own).iter().map(|p| p.position[0]).collect();
        places.sort_by(f32::total_cmp);
        assert_eq!(places.len(), 100);
        assert!(curves.photons([800.0; 2], |_| 800.0).len() == 100, "beyond the last key");
        assert!(Curves::default().photons([500.0; 2], |_| 500.0).is_empty());
    }
}
