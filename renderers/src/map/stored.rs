//! Maps of radiance spectra that are stored in a file.

use rayon::prelude::*;

use super::meter::{Found, Luminous, Measure, NOTHING};
use super::{Map, Of, Quantity, colours, split};
use crate::image::SpectralPicture;
use crate::render::Spectra;
use crate::spectral::{Palette, UniformBins, wavelengths};
use crate::whitted::RenderError;

/// Between which wavelengths in nm spectra must be known.
const NEEDED: [f64; 2] = [400.0, 700.0];
/// The widest gap between wavelengths in nm.
const WIDEST: f64 = 20.0;

/// Maps of stored radiances, W m⁻² sr⁻¹ nm⁻¹; and the grid in nm on which they were summed.
///
/// Spectra are linear between their wavelengths, constant for half a step beyond the first and the last of them, and 0 outside; they are
/// summed at 5 nm, or at 1 nm if they have wavelengths closer than 2.5 nm. The values of a
/// grid of 5 nm are taken as they are. A pixel with a negative value anywhere has no value.
///
/// # Errors
/// Illuminance, which radiances know nothing of; spectra that don't reach from 400 to 700 nm or have gaps of more than 20 nm.
pub fn of_spectra(picture: &SpectralPicture, quantities: &[Quantity]) -> Result<(Vec<Map>, u16), RenderError> {
    if let Some(quantity) = quantities.iter().find(|quantity| !quantity.is_of(Of::Radiance)) {
        return Err(RenderError::new(format!("{quantity} is not a quantity of radiance, which is what is stored")));
    }
    let known = picture.wavelengths();
    check(known)?;
    let closest = known.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
    let step = if closest < 2.5 { 1 } else { 5 };
    let grid = wavelengths(step).unwrap_or_default();
    let weights: Vec<Share> = grid.iter().map(|wavelength| Share::at(known, *wavelength)).collect();
    let mut maps = Vec::new();
    for luminous in [true, false] {
        let own: Vec<Quantity> = quantities.iter().copied().filter(|q| q.is_luminous() == luminous).collect();
        if own.is_empty() {
            continue;
        }
        let measure = measure(step, &own)?;
        let (values, found) = pixels(picture, &weights, &*measure, own.len());
        let size = [picture.width(), picture.height()];
        let own = split(&own, Of::Radiance, size, &values, &found);
        maps.extend(own.map_err(|error| RenderError::new(error.to_string()))?);
    }
    maps.sort_by_key(|map| quantities.iter().position(|q| *q == map.quantity));
    Ok((maps, step))
}

fn measure(step: u16, quantities: &[Quantity]) -> Result<Box<dyn Measure>, RenderError> {
    let spectra = Spectra::Wavelengths(step);
    if quantities.iter().all(|quantity| quantity.is_luminous()) {
        let bins = UniformBins::at_wavelengths(&Palette::default(), step).map_err(RenderError::new)?;
        let [_, luminous, _] = bins.weights();
        return Ok(Box::new(Luminous { weights: luminous.clone() }));
    }
    colours(spectra, quantities).ok_or_else(|| RenderError::new("no grid"))
}

fn check(known: &[f64]) -> Result<(), RenderError> {
    let (Some(first), Some(last)) = (known.first(), known.last()) else {
        return Err(RenderError::new("the picture has no wavelengths"));
    };
    if !(*first <= NEEDED[0] + WIDEST / 2.0 && *last >= NEEDED[1] - WIDEST / 2.0) {
        let [from, to] = NEEDED;
        return Err(RenderError::new(format!(
            "spectra from {first} to {last} nm: they are needed from {from} to {to} nm"
        )));
    }
    match known.windows(2).find(|pair| !(pair[1] - pair[0] <= WIDEST)) {
        Some(pair) => {
            let (from, to) = (pair[0], pair[1]);
            Err(RenderError::new(format!(
                "spectra with nothing between {from} and {to} nm: at most {WIDEST} nm may be"
            )))
        }
        None => Ok(()),
    }
}

/// Which stored values a value of the grid is made of.
#[derive(Clone, Copy, Debug)]
struct Share {
    first: usize,
    weights: [f64; 2],
}

impl Share {
    fn at(known: &[f64], wavelength: f64) -> Self {
        let after = known.partition_point(|w| *w < wavelength);
        let at = |index: usize| known.get(index).copied().unwrap_or(f64::NAN);
        let last = known.len().saturating_sub(1);
        if at(after) == wavelength {
            return Self { first: after, weights: [1.0, 0.0] };
        }
        if after == 0 || after > last {
            // Bins reach beyond their middle.
            let (end, next) = if after == 0 { (0, 1.min(last)) } else { (last, last.saturating_sub(1)) };
            let near = (at(end) - wavelength).abs() <= 0.5 * (at(end) - at(next)).abs();
            return Self { first: end, weights: [if near { 1.0 } else { 0.0 }, 0.0] };
        }
        let share = (wavelength - at(after - 1)) / (at(after) - at(after - 1));
        Self { first: after - 1, weights: [1.0 - share, share] }
    }
}

/// The values of all pixels, pixel by pixel, and what became of each.
fn pixels(picture: &SpectralPicture, shares: &[Share], measure: &dyn Measure, count: usize) -> (Vec<f32>, Vec<Found>) {
    let (width, height) = (picture.width(), picture.height());
    let mut values = vec![NOTHING; width * height * count];
    let mut found = vec![Found::Nowhere; width * height];
    let rows = values.par_chunks_mut(width * count).zip(found.par_chunks_mut(width)).enumerate();
    rows.for_each_init(
        || vec![0.0_f64; width * shares.len()],
        |spectra, (y, (values, found))| {
            fill(picture, shares, y, spectra);
            let pixels = values.chunks_mut(count).zip(found).zip(spectra.chunks(shares.len()));
            for ((values, found), spectrum) in pixels {
                *found = measure.measure(spectrum, values);
            }
        },
    );
    (values, found)
}

/// The spectra of a row on the grid, pixel by pixel.
fn fill(picture: &SpectralPicture, shares: &[Share], y: usize, spectra: &mut [f64]) {
    for (place, share) in shares.iter().enumerate() {
        let [first, second] = share.weights;
        let row = |index: usize| picture.row(index, y);
        let own = spectra.iter_mut().skip(place).step_by(shares.len());
        match (row(share.first), row(share.first + 1)) {
            (Some(one), Some(other)) if second != 0.0 => {
                for (to, (a, b)) in own.zip(one.iter().zip(other)) {
                    *to = first * f64::from(*a) + second * f64::from(*b);
                }
            }
            (Some(one), _) => own.zip(one).for_each(|(to, a)| *to = first * f64::from(*a)),
            (None, _) => own.for_each(|to| *to = 0.0),
        }
    }
}
