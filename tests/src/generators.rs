//! Random spectra and rendering expressions, for property tests, fuzzing and benchmarks: every choice comes from a [`Draw`], so
//! that a case is reproduced by its seed, or by the bytes that a fuzzer supplies.

use core::ops::Range;

use spectral_core::Real;
use spectral_core::expression::{Op, Sources};
use spectral_core::interval::{Domain, Interval, Node, Pyramid, node_count};
use spectral_core::spectrum::{
    Constant, Daylight, Lines, Outside, PiecewiseLinear, Planck, RadiationConstant, Rounding, Scaled, Spectrum,
};
use spectral_core::tables::{self, UniformTable, colorchecker, cornell};

use crate::dense::{Beyond, Polyline};

/// A source of choices: SplitMix64 (Steele, Lea and Flood 2014) from a seed, after the bytes of a fuzzer if there are any.
#[derive(Clone, Debug)]
pub struct Draw<'a> {
    bytes: &'a [u8],
    state: u64,
}

impl Draw<'static> {
    /// Choices that a seed decides.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self { bytes: &[], state: seed }
    }
}

impl<'a> Draw<'a> {
    /// Choices that bytes decide, eight for each, and a fixed seed when these are used up.
    #[must_use]
    pub const fn from_bytes(bytes: &'a [u8]) -> Self {
        Self { bytes, state: 0 }
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        if let Some((first, rest)) = self.bytes.split_first_chunk::<8>() {
            self.bytes = rest;
            return u64::from_le_bytes(*first);
        }
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.state ^ (self.state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number in [0, 1).
    #[allow(clippy::cast_precision_loss, reason = "53 bits fit exactly")]
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A number in [`low`, `high`).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A positive number whose logarithm is uniform in [ln `low`, ln `high`).
    pub fn magnitude(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// An integer in `range`, which must not be empty; the bias is below 2⁻³² for small ranges.
    pub fn index(&mut self, range: Range<usize>) -> usize {
        let count = (range.end - range.start).max(1) as u64;
        let offset = ((u128::from(self.bits()) * u128::from(count)) >> 64) as u64;
        range.start + usize::try_from(offset).unwrap_or(0)
    }

    /// True once in `n` times.
    pub fn once_in(&mut self, n: usize) -> bool {
        self.index(0..n) == 0
    }

    /// A member of a list; `None` of an empty one.
    pub fn pick<T: Copy>(&mut self, list: &[T]) -> Option<T> {
        (!list.is_empty()).then(|| list[self.index(0..list.len())])
    }
}

/// A spectrum in the core's representation, with the truth about it.
#[derive(Debug)]
pub struct Stored<R> {
    /// What it is, for messages.
    pub name: String,
    /// The exact piecewise linear function.
    pub truth: Polyline,
    intervals: Vec<Interval<R>>,
}

/// Spectra for random expressions: fixed ones, and some random ones that can be drawn anew.
#[derive(Debug)]
pub struct Palette<R> {
    spectra: Vec<Stored<R>>,
    lights: Vec<u32>,
    reflectances: Vec<u32>,
    fixed: [usize; 3],
}

impl<R: Real> Sources<R> for &Palette<R> {
    fn leaf(&self, id: u32, node: Node) -> Option<&Interval<R>> {
        self.spectra.get(id as usize)?.intervals.get(node.position())
    }
    fn deferred(&mut self, id: u32, node: Node) -> Option<Interval<R>> {
        self.leaf(id, node).copied()
    }
}

/// The data files of the tables that [`tables::lights`] lists, with the behaviour outside their range.
const LIGHT_FILES: [&str; 6] = [
    "cie_illuminants_A_D50_D55_D65_D75_C_5nm.csv",
    "cie_fl1_fl12_5nm.csv",
    "cie_fl3_1_fl3_15_5nm.csv",
    "cie_hp1_hp5_5nm.csv",
    "cie_led_illuminants_5nm.csv",
    "narrowband_lamps_nist_5nm.csv",
];

impl<R: Real> Palette<R> {
    /// All built-in lights and reflectances, black bodies, daylights, lines and constants, on the parts of a domain.
    ///
    /// # Errors
    /// A spectrum that should be accepted was refused, or a data file can't be read.
    pub fn new(domain: &Domain<'_, R>) -> Result<Self, String> {
        let mut palette = Self { spectra: Vec::new(), lights: Vec::new(), reflectances: Vec::new(), fixed: [0; 3] };
        palette.add_tables(domain)?;
        for temperature in [1000.0, 1500.0, 2856.0, 6504.0, 25000.0] {
            palette.add_planck(domain, temperature)?;
        }
        for temperature in [4000.0, 7000.0, 25000.0] {
            palette.add_daylight(domain, temperature)?;
        }
        for width in [0.05, 1.0, 10.0] {
            palette.add_lines(domain, &[588.995, 589.5924], &[2.0 / 3.0, 1.0 / 3.0], width)?;
        }
        palette.add_constant(domain, 1.0, true)?;
        for value in [0.0, 1.0, 0.5, 1e-5] {
            palette.add_constant(domain, value, false)?;
        }
        palette.fixed = [palette.spectra.len(), palette.lights.len(), palette.reflectances.len()];
        Ok(palette)
    }

    /// Replaces the random spectra: lights and reflectances, so many each.
    ///
    /// # Errors
    /// A spectrum that should be accepted was refused.
    pub fn redraw(&mut self, draw: &mut Draw<'_>, domain: &Domain<'_, R>, count: usize) -> Result<(), String> {
        let [spectra, lights, reflectances] = self.fixed;
        self.spectra.truncate(spectra);
        self.lights.truncate(lights);
        self.reflectances.truncate(reflectances);
        for _ in 0..count {
            self.add_random_light(draw, domain)?;
            let (nodes, outside) = random_reflectance::<R>(draw);
            self.add_nodes(domain, "random reflectance", &nodes, outside, false)?;
        }
        Ok(())
    }

    /// All spectra; a program's leaves are their places.
    #[must_use]
    pub fn spectra(&self) -> &[Stored<R>] {
        &self.spectra
    }

    /// The place of the spectrum of this name.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<u32> {
        self.spectra.iter().position(|s| s.name == name).and_then(|id| u32::try_from(id).ok())
    }

    /// The places of the lights.
    #[must_use]
    pub fn lights(&self) -> &[u32] {
        &self.lights
    }

    /// The places of the reflectances.
    #[must_use]
    pub fn reflectances(&self) -> &[u32] {
        &self.reflectances
    }

    fn add<S: Spectrum<R>>(
        &mut self,
        domain: &Domain<'_, R>,
        name: &str,
        spectrum: &S,
        truth: Polyline,
        light: bool,
    ) -> Result<(), String> {
        let mut intervals = vec![Interval::zero(); node_count(domain.depth())];
        Pyramid::build(spectrum, domain, &mut intervals).map_err(|error| format!("{name}: {error}: {truth:?}"))?;
        let id = u32::try_from(self.spectra.len()).map_err(|_| "too many spectra")?;
        self.spectra.push(Stored { name: name.to_owned(), truth, intervals });
        let family = if light { &mut self.lights } else { &mut self.reflectances };
        family.push(id);
        Ok(())
    }

    fn add_tables(&mut self, domain: &Domain<'_, R>) -> Result<(), String> {
        for table in tables::lights() {
            let read = |file: &&str| Polyline::read(file, table.name, Beyond::Zero).ok();
            let truth = LIGHT_FILES.iter().find_map(read);
            if let Some(truth) = truth {
                self.add(domain, table.name, &table.spectrum(Outside::Zero), truth, true)?;
            }
        }
        let patches = ("colorchecker24_ohta1997_5nm.csv", &colorchecker::ALL[..]);
        let paints = ("cornell_box_reflectance_4nm.csv", &cornell::ALL[..]);
        for (file, list) in [patches, paints] {
            for table in list {
                self.add_reflectance_table(domain, file, table)?;
            }
        }
        Ok(())
    }

    fn add_reflectance_table(
        &mut self,
        domain: &Domain<'_, R>,
        file: &str,
        table: &UniformTable,
    ) -> Result<(), String> {
        let truth = Polyline::read(file, table.name, Beyond::Hold)?;
        self.add(domain, table.name, &table.spectrum(Outside::Hold), truth, false)
    }

    /// A black body's nodes are the core's own values at whole nanometres, which define the spectrum.
    fn add_planck(&mut self, domain: &Domain<'_, R>, temperature: f64) -> Result<(), String> {
        let spectrum =
            Planck::new(R::from_f64(temperature), RadiationConstant::Si2019).map_err(|error| error.to_string())?;
        let node = |w: u32| (f64::from(w), spectrum.radiance(R::from_f64(f64::from(w))).to_f64());
        let truth = Polyline::new(&(379..=781).map(node).collect::<Vec<_>>(), Beyond::Zero);
        self.add(domain, &format!("Planck {temperature} K"), &spectrum, truth, true)
    }

    /// A daylight's nodes are the core's own values at its nodes.
    fn add_daylight(&mut self, domain: &Domain<'_, R>, temperature: f64) -> Result<(), String> {
        let spectrum = Daylight::new(R::from_f64(temperature), Rounding::None).map_err(|error| error.to_string())?;
        let node = |w: u32| (f64::from(w), spectrum.value(R::from_f64(f64::from(w))).to_f64());
        let nodes: Vec<_> = (300..=830).step_by(5).map(node).collect();
        let truth = Polyline::new(&nodes, Beyond::Zero);
        self.add(domain, &format!("daylight {temperature} K"), &spectrum, truth, true)
    }

    fn add_lines(&mut self, domain: &Domain<'_, R>, centres: &[f64], powers: &[f64], width: f64) -> Result<(), String> {
        let round = |list: &[f64]| list.iter().map(|v| R::from_f64(*v)).collect::<Vec<_>>();
        let (centres, powers, width) = (round(centres), round(powers), R::from_f64(width));
        let spectrum = Lines::new(&centres, &powers, width).map_err(|error| error.to_string())?;
        let truth = triangles(&centres, &powers, width);
        self.add(domain, &format!("lines {centres:?} of base {width}"), &spectrum, truth, true)
    }

    fn add_constant(&mut self, domain: &Domain<'_, R>, value: f64, light: bool) -> Result<(), String> {
        let value = R::from_f64(value);
        let spectrum = Constant::new(value).map_err(|error| error.to_string())?;
        let truth = Polyline::constant(value.to_f64());
        self.add(domain, &format!("constant {value}"), &spectrum, truth, light)
    }

    fn add_nodes(
        &mut self,
        domain: &Domain<'_, R>,
        name: &str,
        nodes: &[(R, R)],
        outside: Outside,
        light: bool,
    ) -> Result<(), String> {
        let (wavelengths, values): (Vec<R>, Vec<R>) = nodes.iter().copied().unzip();
        let spectrum = PiecewiseLinear::new(&wavelengths, &values, outside).map_err(|error| error.to_string())?;
        let exact: Vec<_> = nodes.iter().map(|(w, v)| (w.to_f64(), v.to_f64())).collect();
        let beyond = if outside == Outside::Hold { Beyond::Hold } else { Beyond::Zero };
        self.add(domain, name, &spectrum, Polyline::new(&exact, beyond), light)
    }

    fn add_random_light(&mut self, draw: &mut Draw<'_>, domain: &Domain<'_, R>) -> Result<(), String> {
        match draw.index(0..8) {
            0 => self.add_planck(domain, draw.magnitude(1000.0, 25000.0)),
            1 => self.add_daylight(domain, draw.between(4000.0, 25000.0)),
            2..5 => {
                let count = if draw.once_in(2) { 1 } else { draw.index(2..6) };
                let centres: Vec<_> = (0..count).map(|_| wavelength(draw)).collect();
                let powers: Vec<_> = (0..count).map(|_| draw.magnitude(1e-3, 1e3)).collect();
                self.add_lines(domain, &centres, &powers, draw.magnitude(0.05, 20.0))
            }
            5 => {
                let mut nodes = irregular_nodes::<R>(draw);
                let size = draw.magnitude(1e-3, 1e3);
                let range = draw.magnitude(1e-8, 1.0);
                for (_, value) in &mut nodes {
                    *value = R::from_f64(size * draw.magnitude(range, 1.0001));
                }
                self.add_nodes(domain, "random light", &nodes, random_outside(draw), true)
            }
            6 => self.add_scaled_table(draw, domain),
            _ => {
                let value = draw.magnitude(1e-3, 1e3);
                self.add_constant(domain, value, true)
            }
        }
    }

    /// A light from a table in another unit, as a leaf of its own.
    fn add_scaled_table(&mut self, draw: &mut Draw<'_>, domain: &Domain<'_, R>) -> Result<(), String> {
        let names = ["A", "D65", "FL2", "FL11", "HP1", "LED-B3"];
        let name = draw.pick(&names).unwrap_or_default();
        let (Some(table), Some(id)) = (tables::find_light(name), self.find(name)) else {
            return Err(format!("no light {name}"));
        };
        let factor = R::from_f64(draw.magnitude(1e-30, 1e30));
        let spectrum = Scaled::new(table.spectrum(Outside::Zero), factor).map_err(|error| error.to_string())?;
        let truth = self.spectra[id as usize].truth.scaled(factor.to_f64());
        self.add(domain, &format!("{name} times {:e}", factor.to_f64()), &spectrum, truth, true)
    }
}

/// The sum of the triangles of [`Lines`], with corners rounded as its documentation says.
fn triangles<R: Real>(centres: &[R], powers: &[R], width: R) -> Polyline {
    let corners: Vec<[f64; 3]> =
        centres.iter().map(|&c| [c - width * R::HALF, c, c + width * R::HALF].map(R::to_f64)).collect();
    let mut nodes: Vec<f64> = corners.iter().flatten().copied().collect();
    nodes.sort_unstable_by(f64::total_cmp);
    nodes.dedup();
    let value = |w: f64| {
        let line = |(&[low, centre, high], power): (&[f64; 3], &R)| {
            let peak = 2.0 * power.to_f64() / (high - low);
            let part = ((w - low) / (centre - low)).min((high - w) / (high - centre));
            peak * part.max(0.0)
        };
        corners.iter().zip(powers).map(line).sum()
    };
    Polyline::new(&nodes.iter().map(|w| (*w, value(*w))).collect::<Vec<_>>(), Beyond::Zero)
}

/// A wavelength in nm: anywhere, on or close to a dyadic boundary, or at an end of the domain.
fn wavelength(draw: &mut Draw<'_>) -> f64 {
    let level = draw.index(0..11);
    let part = f64::from(u32::try_from(draw.index(0..(1 << level) + 1)).unwrap_or(0));
    let boundary = 380.0 + 400.0 * part / f64::from(1_u32 << level);
    match draw.index(0..6) {
        0 => boundary,
        1 => boundary + draw.between(-1.0, 1.0) * draw.magnitude(1e-4, 1.0),
        2 => 380.0 + draw.between(-2.0, 2.0),
        3 => 780.0 + draw.between(-2.0, 2.0),
        _ => draw.between(375.0, 785.0),
    }
}

fn random_outside(draw: &mut Draw<'_>) -> Outside {
    if draw.once_in(2) { Outside::Zero } else { Outside::Hold }
}

/// Two to two dozen nodes at irregular distinct wavelengths, with values 0.
fn irregular_nodes<R: Real>(draw: &mut Draw<'_>) -> Vec<(R, R)> {
    let count = draw.index(2..25);
    let mut nodes = vec![(R::from_f64(draw.between(350.0, 400.0)), R::ZERO)];
    nodes.extend((0..count).map(|_| (R::from_f64(wavelength(draw)), R::ZERO)));
    distinct(nodes)
}

fn distinct<R: Real>(mut nodes: Vec<(R, R)>) -> Vec<(R, R)> {
    nodes.sort_by(|a, b| a.0.to_f64().total_cmp(&b.0.to_f64()));
    nodes.dedup_by(|a, b| a.0 == b.0);
    if nodes.len() < 2 {
        nodes.push((R::from_f64(800.0), R::ZERO));
    }
    nodes
}

/// The nodes of a random reflectance in [0, 1]: irregular values, steps between 0 and 1, a step, or a spike or notch.
fn random_reflectance<R: Real>(draw: &mut Draw<'_>) -> (Vec<(R, R)>, Outside) {
    let at = |w: f64, v: f64| (R::from_f64(w), R::from_f64(v));
    let (low, high) = (draw.unit() * draw.unit(), 1.0 - draw.unit() * draw.unit());
    match draw.index(0..4) {
        0 => {
            let mut nodes = irregular_nodes(draw);
            for (_, value) in &mut nodes {
                *value = R::from_f64(draw.unit());
            }
            (nodes, random_outside(draw))
        }
        1 => {
            let mut nodes = irregular_nodes(draw);
            for (_, value) in &mut nodes {
                *value = if draw.once_in(2) { R::ONE } else { R::ZERO };
            }
            (nodes, random_outside(draw))
        }
        2 => {
            let (place, width) = (wavelength(draw), draw.magnitude(1e-3, 10.0));
            (distinct(vec![at(place, low), at(place + width, high)]), Outside::Hold)
        }
        _ => {
            let (place, width) = (wavelength(draw), draw.magnitude(1e-2, 10.0));
            let nodes = vec![at(place, low), at(place + width, high), at(place + 2.0 * width, low)];
            (distinct(nodes), Outside::Hold)
        }
    }
}

/// A random rendering expression.
#[derive(Clone, Debug)]
pub struct Expression<R> {
    /// The postfix program; its leaves, deferred or not, are places in the palette.
    pub ops: Vec<Op<R>>,
    /// The light that it begins with.
    pub light: u32,
    /// The degree of the program as a polynomial in its spectra.
    pub factors: usize,
}

/// How many factors a term has at most: a light, and reflectances.
pub const MAX_FACTORS: usize = 7;

/// Draws an expression: one to three lights, each through up to six reflectances, with scales, Schlick terms and nested sums.
pub fn expression<R: Real>(draw: &mut Draw<'_>, palette: &Palette<R>) -> Expression<R> {
    let mut ops = Vec::new();
    let light = draw.pick(&palette.lights).unwrap_or_default();
    let mut factors = path(draw, palette, light, MAX_FACTORS, &mut ops);
    let terms = draw.pick(&[0, 0, 0, 1, 1, 2]).unwrap_or_default();
    for _ in 0..terms {
        let other = if draw.once_in(2) { light } else { draw.pick(&palette.lights).unwrap_or_default() };
        factors = factors.max(path(draw, palette, other, MAX_FACTORS, &mut ops));
        if draw.once_in(20) {
            ops.push(Op::Scale(R::from_f64(-draw.unit())));
        }
        ops.push(Op::Sum);
    }
    if factors < MAX_FACTORS && draw.once_in(4) {
        factors += reflectance(draw, palette, MAX_FACTORS - factors, &mut ops);
        ops.push(Op::Product);
    }
    if draw.once_in(2) {
        ops.push(Op::Scale(R::from_f64(draw.magnitude(1e-30, 1e30))));
    }
    Expression { ops, light, factors }
}

/// A light times some reflectances; returns the number of factors.
fn path<R: Real>(draw: &mut Draw<'_>, palette: &Palette<R>, light: u32, most: usize, ops: &mut Vec<Op<R>>) -> usize {
    ops.push(leaf(draw, light));
    if draw.once_in(3) {
        ops.push(Op::Scale(R::from_f64(draw.magnitude(1e-3, 1e3))));
    }
    let mut factors = 1;
    let goal = draw.index(1..most + 1);
    while factors < goal {
        factors += reflectance(draw, palette, goal - factors, ops);
        ops.push(Op::Product);
    }
    factors
}

/// A reflectance, plain, in a Schlick term, or a product or mixture of several; returns the number of factors.
fn reflectance<R: Real>(draw: &mut Draw<'_>, palette: &Palette<R>, most: usize, ops: &mut Vec<Op<R>>) -> usize {
    let id = draw.pick(&palette.reflectances).unwrap_or_default();
    ops.push(leaf(draw, id));
    let mut factors = 1;
    match draw.index(0..8) {
        0 if most > 1 => {
            factors += reflectance(draw, palette, most - 1, ops);
            ops.push(Op::Product);
        }
        1 => {
            let part = R::from_f64(draw.unit());
            ops.push(Op::Scale(part));
            factors = factors.max(reflectance(draw, palette, most, ops));
            ops.extend([Op::Scale(R::ONE - part), Op::Sum]);
        }
        _ => {}
    }
    if draw.once_in(3) {
        let fresnel = match draw.index(0..8) {
            0 => R::ZERO,
            1 => R::ONE,
            _ => R::from_f64(draw.unit().powi(3)),
        };
        ops.push(Op::Schlick(fresnel));
    }
    factors
}

fn leaf<R: Real>(draw: &mut Draw<'_>, id: u32) -> Op<R> {
    if draw.once_in(8) { Op::Deferred(id) } else { Op::Leaf(id) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectral_core::Observer;
    use spectral_core::expression::Program;
    use spectral_core::interval::Weight;

    fn with_palette(test: impl Fn(Palette<f32>, &Domain<'_, f32>)) {
        let mut weights = vec![Weight::default(); node_count(2)];
        let domain = Domain::build(Observer::cie_1931_2deg(), 2, &mut weights).unwrap();
        test(Palette::new(&domain).unwrap(), &domain);
    }

    #[test]
    fn the_palette_has_all_families() {
        with_palette(|mut palette, domain| {
            // A, C, four D; 12 + 15 + 5 + 9 + 9 lamps; 5 black bodies, 3 daylights, 3 lines, 1 flat.
            assert_eq!(palette.lights().len(), 6 + 12 + 15 + 5 + 9 + 9 + 5 + 3 + 3 + 1);
            assert_eq!(palette.reflectances().len(), 24 + 3 + 4);
            let fixed = palette.spectra().len();
            for seed in 0..20 {
                palette.redraw(&mut Draw::new(seed), domain, 10).unwrap();
                assert_eq!(palette.spectra().len(), fixed + 20);
            }
        });
    }

    #[test]
    fn expressions_are_valid_programs_of_at_most_so_many_factors() {
        with_palette(|mut palette, domain| {
            palette.redraw(&mut Draw::new(1), domain, 4).unwrap();
            let mut seen = [false; MAX_FACTORS + 1];
            for seed in 0..20_000 {
                let expression = expression(&mut Draw::new(seed), &palette);
                assert!(Program::new(&expression.ops).is_ok(), "{seed}: {expression:?}");
                assert_eq!(degree(&expression.ops), expression.factors, "{seed}");
                seen[expression.factors] = true;
            }
            assert_eq!(seen.iter().filter(|s| **s).count(), MAX_FACTORS);
        });
    }

    /// The degree of a program in its leaves.
    fn degree<R: Real>(ops: &[Op<R>]) -> usize {
        let mut stack: Vec<usize> = Vec::new();
        for op in ops {
            match op {
                Op::Leaf(_) | Op::Deferred(_) => stack.push(1),
                Op::Sum | Op::Product => {
                    let (a, b) = (stack.pop().unwrap(), stack.pop().unwrap());
                    stack.push(if matches!(op, Op::Sum) { a.max(b) } else { a + b });
                }
                Op::Scale(_) | Op::Schlick(_) => {}
            }
        }
        stack[0]
    }

    #[test]
    fn choices_are_reproducible_uniform_and_driven_by_bytes() {
        let sum: f64 = {
            let mut draw = Draw::new(3);
            (0..10_000).map(|_| draw.unit()).sum()
        };
        // Mean of 10⁴ uniform numbers: 5 standard deviations of 0.0029.
        assert!((sum / 1e4 - 0.5).abs() <= 5.0 / (12.0_f64 * 1e4).sqrt());
        assert_eq!(Draw::new(7).bits(), Draw::new(7).bits());
        let mut draw = Draw::from_bytes(&[1, 0, 0, 0, 0, 0, 0, 0, 9]);
        assert_eq!(draw.bits(), 1);
        assert_eq!(draw.bits(), Draw::new(0).bits());
    }
}
