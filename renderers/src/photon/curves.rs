//! Where photons of a path land, as a function of the wavelength: between some wavelengths at which they were thrown.
//!
//! Throwing every path again for every interval (Iehl–Péroche 2000, §5.1) costs as much as all photons, each time. But the place where a path
//! lands is a smooth function of the wavelength as long as it takes the same reflections and refractions and meets the same shapes:
//! between two wavelengths it is linear in 1/λ², as Cauchy's index is, to the second order. So paths are thrown at a few *keys*, and
//! photons that correspond to each other at two neighbouring keys are interpolated; those that don't stay where they are, each up to the middle. Between
//! faces of one shape at an angle the straight line leaves the shape, and photons on it are not found. This is for where derivatives at one wavelength
//! say too little ([`lines`](super::lines)), and for bands that are asked for one by one.

use core::cmp::Ordering;

use rayon::prelude::*;

use super::motion::{self, Motion, Moving};
use super::{Photon, Scattered};
use crate::spectral::measure;

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
    /// In pieces, of as many paths as they were thrown in.
    photons: Vec<Vec<Tween>>,
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
    /// Photons thrown at increasing wavelengths in nm, in pieces of the same paths at all of them; each in the order of paths and their branches.
    pub(crate) fn new(keys: &[(f64, Vec<Vec<Scattered>>)]) -> Self {
        let stretch = |pair: &[(f64, Vec<Vec<Scattered>>)]| {
            let ((first, from), (last, to)) = (&pair[0], &pair[1]);
            let photons = from.par_iter().zip(to).map(|(from, to)| tweens(from, to)).collect();
            Stretch { limits: [*first, *last], photons }
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
            for tween in stretch.photons.iter().flatten() {
                let wavelength = wavelength_of(tween.path);
                if (first..end).contains(&wavelength) {
                    photons.extend(tween.ends.at(stretch.between(wavelength)));
                }
            }
        }
        photons
    }

    /// The photons of all paths, each at a wavelength in nm of its own, and where they are from.
    pub(crate) fn placed(&self, wavelength_of: impl Fn(u32) -> f64 + Sync) -> (Vec<Photon>, Vec<Source>) {
        let mut placed = (Vec::new(), Vec::new());
        for (stretch, Stretch { photons, .. }) in (0..).zip(&self.stretches) {
            let limits = self.limits_of(stretch);
            let place = |piece: u32, number: u32, tween: &Tween| {
                let at = self.between(wavelength_of(tween.path));
                tween.holds(limits, at).then(|| (tween.photon(limits, at), Source { stretch, piece, number, at }))
            };
            let pieces = photons.par_iter().enumerate().flat_map_iter(|(piece, tweens)| {
                let piece = u32::try_from(piece).unwrap_or(u32::MAX);
                (0..).zip(tweens).filter_map(move |(number, tween)| place(piece, number, tween))
            });
            placed.par_extend(pieces);
        }
        placed
    }

    /// How photons move about where they were placed, and the rest of their ways between two keys: no part is longer than a distance in scene units for each,
    /// unless there would be more than eight.
    pub(crate) fn moving(&self, placed: &[(Source, f32)], rest: &mut Moving) -> Vec<Motion> {
        let parts = |number: usize, rest: &mut Moving| {
            let (from, longest) = placed[number];
            self.parts(from, longest, rest)
        };
        motion::cut(placed.len(), parts, rest)
    }

    /// How a photon moves about where it was placed, and the rest of its way.
    fn parts(&self, from: Source, longest: f32, rest: &mut Moving) -> Motion {
        let limits = self.limits_of(from.stretch);
        let stretch = self.stretches.get(from.stretch as usize);
        let piece = stretch.and_then(|stretch| stretch.photons.get(from.piece as usize));
        let tween = piece.and_then(|piece| piece.get(from.number as usize));
        let mut own = Motion::default();
        tween.into_iter().for_each(|tween| {
            tween.parts(limits, longest, |[start, end], motion| {
                if from.at >= start && (from.at < end || end >= 1.0) {
                    own = motion.about(from.at);
                } else {
                    tween.add([start, end], limits, motion, rest);
                }
            });
        });
        own
    }

    /// All ways between two keys of which no photon was placed: with those and the rest of theirs, each photon is there once at every wavelength.
    pub(crate) fn others(&self, wavelength_of: impl Fn(u32) -> f64, longest: f32, rest: &mut Moving) {
        for (number, stretch) in (0..).zip(&self.stretches) {
            let limits = self.limits_of(number);
            for tween in stretch.photons.iter().flatten() {
                let holds_all = self.stretches.len() == 1 && matches!(tween.ends, Ends::Both(_));
                if !holds_all && !tween.holds(limits, self.between(wavelength_of(tween.path))) {
                    tween.parts(limits, longest, |part, motion| tween.add(part, limits, motion, rest));
                }
            }
        }
    }

    /// Where a stretch begins and ends.
    fn limits_of(&self, stretch: u32) -> [f64; 2] {
        self.stretches.get(stretch as usize).map_or([0.0; 2], |s| s.limits.map(|limit| self.between(limit)))
    }

    /// In how many even steps by 1/λ² there is one between any two keys, which are where these steps are.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most 2 to the number of halvings")]
    pub(crate) fn steps(&self) -> u16 {
        let width = |number: u32| self.limits_of(number).into_iter().fold(0.0, |from, to| to - from);
        let narrowest = (0..).take(self.stretches.len()).map(width).fold(1.0, f64::min);
        (1.0 / narrowest).round().clamp(1.0, f64::from(1_u16 << HALVINGS)) as u16
    }

    /// Where a wavelength is between the first and the last key, from 0 to 1.
    pub(crate) fn between(&self, wavelength: f64) -> f64 {
        match self.stretches.as_slice() {
            [first, .., last] => between([first.limits[0], last.limits[1]], wavelength),
            [stretch] => stretch.between(wavelength),
            [] => 0.0,
        }
    }

    /// Bytes.
    pub(crate) fn bytes(&self) -> usize {
        let pieces = self.stretches.iter().flat_map(|stretch| &stretch.photons);
        pieces.map(|tweens| tweens.capacity() * size_of::<Tween>()).sum()
    }
}

/// Where a photon is from: one of those between two keys.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Source {
    stretch: u32,
    piece: u32,
    number: u32,
    /// Where between the first and the last key it was placed.
    pub(super) at: f64,
}

impl Tween {
    /// From where to where it goes, between the limits of its stretch.
    fn limits(&self, [from, to]: [f64; 2]) -> [f64; 2] {
        match self.ends {
            Ends::Both(_) => [from, to],
            Ends::First(_) => [from, f64::midpoint(from, to)],
            Ends::Last(_) => [f64::midpoint(from, to), to],
        }
    }

    /// Whether it goes through a place: its end belongs to it if that's 1.
    fn holds(&self, stretch: [f64; 2], at: f64) -> bool {
        let [from, to] = self.limits(stretch);
        at >= from && (at < to || to >= 1.0)
    }

    /// The photon at a place.
    fn photon(&self, [from, to]: [f64; 2], at: f64) -> Photon {
        match &self.ends {
            Ends::Both([first, last]) => mixed(first, last, (at - from) / (to - from)),
            Ends::First(photon) | Ends::Last(photon) => *photon,
        }
    }

    /// Adds a part to others, with the photon in its middle.
    fn add(&self, [from, to]: [f64; 2], stretch: [f64; 2], motion: Motion, others: &mut Moving) {
        let at = f64::midpoint(from, to);
        others.0.push(self.photon(stretch, at));
        others.1.push(motion.about(at));
    }

    /// Calls with the parts of its way: from where to where each goes, and how the photon moves.
    #[allow(clippy::cast_possible_truncation, reason = "photons are kept in f32")]
    fn parts(&self, stretch: [f64; 2], longest: f32, call: impl FnMut([f64; 2], Motion)) {
        let [from, to] = self.limits(stretch);
        let width = (to - from) as f32;
        let mut motion = Motion::default();
        if let Ends::Both([first, last]) = &self.ends {
            motion.position = core::array::from_fn(|i| (last.position[i] - first.position[i]) / width);
            motion.flux = (last.flux - first.flux) / width;
        }
        motion.parts([from, to], longest, call);
    }
}

/// The photon between two that correspond to each other, from 0 to 1.
#[allow(clippy::cast_possible_truncation, reason = "photons are kept in f32")]
fn mixed(first: &Photon, last: &Photon, t: f64) -> Photon {
    let t = t as f32;
    let mix = |a: f32, b: f32| a + (b - a) * t;
    let mix_all = |a: [f32; 3], b: [f32; 3]| core::array::from_fn(|i| mix(a[i], b[i]));
    let direction = glam::Vec3A::from_array(mix_all(first.direction, last.direction));
    Photon {
        position: mix_all(first.position, last.position),
        direction: direction.normalize_or(glam::Vec3A::from_array(first.direction)).to_array(),
        flux: mix(first.flux, last.flux),
        ..*first
    }
}

impl Stretch {
    fn between(&self, wavelength: f64) -> f64 {
        between(self.limits, wavelength)
    }
}

/// Where a wavelength is between two others, by 1/λ²: from 0 to 1.
fn between([first, last]: [f64; 2], wavelength: f64) -> f64 {
    ((measure(wavelength) - measure(first)) / (measure(last) - measure(first))).clamp(0.0, 1.0)
}

/// The wavelength in the middle of two others, by the same measure.
fn middle(first: f64, last: f64) -> f64 {
    (2.0 / (measure(first) + measure(last))).sqrt()
}

impl Ends {
    /// The photon at a place from 0 to 1.
    fn at(&self, t: f64) -> Option<Photon> {
        match self {
            Self::Both([first, last]) => Some(mixed(first, last, t)),
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

/// How well it is known where photons land.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Misfit {
    /// The distance that nine of ten photons are not farther than from where they are thought to be.
    distance: f32,
    /// The share of the flux that corresponds to nothing.
    strange: f32,
    /// How much the other fluxes differ from what they are thought to be, relative to themselves.
    change: f32,
}

impl Misfit {
    /// Compares photons that were thrown with what is thought of them.
    pub(super) fn of(thought: &[Scattered], thrown: &[Scattered]) -> Self {
        let (mut distances, mut strange, mut total) = (Vec::new(), 0.0, 0.0);
        pair_up(thought, thrown, |thought, thrown| {
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
        Self { distance: of_nine_in_ten(&mut distances), strange, change: change(thought, thrown) }
    }

    /// Whether photons may be found where they are thought to be: nine of ten within a distance, and their fluxes.
    pub(super) fn is_within(&self, distance: f32) -> bool {
        self.distance <= distance && self.strange <= STRANGE && self.change <= CHANGE
    }
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
    Misfit::of(&thought, middle)
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

/// The share of flux that may correspond to nothing where photons are compared with those that were thrown, how much the rest may differ, and how often
/// a stretch between keys is halved at most.
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
    if halvings == 0 || misfit.is_within(distance) {
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

    /// Pieces of the same paths, whatever was thrown.
    fn in_pieces(thrown: Vec<Scattered>) -> Vec<Vec<Scattered>> {
        let piece = |first: u32| thrown.iter().filter(|s| (first..first + 30).contains(&s.path)).copied().collect();
        [0, 30, 60, 90].map(piece).into()
    }

    fn cauchy(wavelength: f64) -> f64 {
        1e5 / (wavelength * wavelength)
    }

    #[test]
    fn what_follows_cauchys_index_needs_two_keys() {
        let throw = |wavelength: f64| thrown(wavelength, cauchy);
        // One path of a hundred that goes elsewhere is within what is allowed.
        assert_eq!(keys([400.0, 700.0], 1e-4, &throw), [400.0, 700.0]);
        let curves = Curves::new(&[400.0, 700.0].map(|w| (w, vec![throw(w)])));
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
        let keyed: Vec<_> = found.iter().map(|w| (*w, vec![throw(*w)])).collect();
        let curves = Curves::new(&keyed);
        let steps = f64::from(curves.steps());
        assert!(found.iter().all(|key| {
            (curves.between(*key) * steps).fract().min(1.0 - (curves.between(*key) * steps).fract()) <= 1e-9
        }));
        for step in 0..60 {
            let wavelength = 400.0 + 5.0 * f64::from(step);
            let photons = curves.photons([wavelength; 2], |_| wavelength);
            for (photon, exact) in photons.iter().zip(throw(wavelength)).filter(|(_, s)| s.path != 7) {
                assert!((photon.position[0] - exact.photon.position[0]).abs() <= 0.1);
            }
        }
    }

    /// A photon that doesn't move is there at all wavelengths, also where parts may have no length.
    #[test]
    fn what_stays_is_not_lost() {
        let throw = |wavelength: f64| thrown(wavelength, |_| 0.0);
        let own = |_: u32| 450.0;
        for keys in [&[400.0, 700.0][..], &[400.0, 480.0, 700.0]] {
            let curves = Curves::new(&keys.iter().map(|w| (*w, in_pieces(throw(*w)))).collect::<Vec<_>>());
            let (photons, sources) = curves.placed(own);
            let mut rest = (Vec::new(), Vec::new());
            let sources: Vec<_> = sources.into_iter().map(|source| (source, 0.0)).collect();
            let mut motions = curves.moving(&sources, &mut rest);
            curves.others(own, 0.0, &mut rest);
            motions.extend(rest.1);
            for node in 0..=8_u16 {
                let at = f32::from(node) / 8.0;
                let present = |motion: &crate::photon::motion::Motion| motion.at(&photons[0], at).2;
                assert_eq!(motions.iter().map(present).sum::<f32>(), 100.0, "{keys:?} {node}");
            }
        }
    }

    /// At every wavelength each photon is there once, in a part of its way that leads to where it was thrown.
    #[test]
    fn parts_lead_from_wavelength_to_wavelength() {
        let throw = |wavelength: f64| thrown(wavelength, |w| 2e5 / (w * w));
        // The second is on a limit between two stretches.
        let spread: fn(u32) -> f64 = |path| 400.0 + 3.0 * f64::from(path);
        let few = &[400.0, 700.0][..];
        let many = &[400.0, 480.0, 600.0, 700.0][..];
        for (keys, own) in [(few, spread), (many, spread), (many, |_: u32| 480.0)] {
            let curves = Curves::new(&keys.iter().map(|w| (*w, in_pieces(throw(*w)))).collect::<Vec<_>>());
            for longest in [f32::INFINITY, 0.3, 0.01] {
                let (mut photons, sources) = curves.placed(own);
                assert_eq!((photons.len(), sources.len()), (100, 100));
                let sources: Vec<_> = sources.into_iter().map(|source| (source, longest)).collect();
                let mut rest = (Vec::new(), Vec::new());
                let mut motions = curves.moving(&sources, &mut rest);
                curves.others(own, longest, &mut rest);
                photons.extend(rest.0);
                motions.extend(rest.1);
                assert!(keys.len() > 2 || curves.steps() == 1);
                for wavelength in [400.0, 401.0, 480.0, 555.0, 600.0, 699.0, 700.0] {
                    #[allow(clippy::cast_possible_truncation, reason = "as photons are")]
                    let to = curves.between(wavelength) as f32;
                    let (mut found, mut all) = (Vec::new(), 0.0);
                    for (photon, motion) in photons.iter().zip(&motions) {
                        let (place, flux, present) = motion.at(photon, to);
                        if present > 0.0 {
                            assert!((flux - 1.0).abs() <= 1e-6);
                            all += present;
                            found.push((glam::Vec3A::from_array(place).length(), photon.surface));
                        }
                    }
                    let mut exact: Vec<_> = throw(wavelength).iter().map(|s| s.photon).collect();
                    // Path 7 meets another shape: it is where one of its keys is.
                    exact.retain(|photon| photon.position[0] < 6.9 || photon.position[0] > 8.5);
                    assert_eq!(all, 100.0, "{wavelength}");
                    for photon in &exact {
                        let distance = photon.position[0].hypot(1.0);
                        assert!(found.iter().any(|(at, _)| (at - distance).abs() <= 1e-4), "{wavelength} {distance}");
                    }
                }
            }
        }
    }

    /// A band takes each path once, wherever its own wavelength is.
    #[test]
    fn each_path_is_there_once() {
        let throw = |wavelength: f64| thrown(wavelength, cauchy);
        let keyed: Vec<_> = [400.0, 480.0, 600.0, 700.0].map(|w| (w, in_pieces(throw(w)))).into();
        let curves = Curves::new(&keyed);
        let own = |path: u32| 390.0 + 320.0 * f64::from(path) / 99.0;
        let mut places: Vec<_> = curves.photons([390.0, 710.0], own).iter().map(|p| p.position[0]).collect();
        places.sort_by(f32::total_cmp);
        assert_eq!(places.len(), 100);
        assert!(curves.photons([800.0; 2], |_| 800.0).len() == 100, "beyond the last key");
        assert!(Curves::default().photons([500.0; 2], |_| 500.0).is_empty());
    }
}
