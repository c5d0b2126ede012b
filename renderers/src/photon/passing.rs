//! Light of photons that pass a place as the wavelength changes.

use core::ops::Range;

use glam::{DVec3, Vec3A, Vec4};

use super::bands::Thrown;
use super::footprints::Footprint;
use super::map::{LEAF, Region};
use super::ways::{About, Ways};
use super::{Density, Place};
use crate::spectral::Band;
use crate::whitted::nodes_of;

/// The share of the light that may change in more steps than are looked at.
const FASTEST: f64 = 0.1;

/// Light that passes a place, with memory to find it.
#[derive(Debug, Default)]
pub(crate) struct Passed {
    pub(crate) list: Vec<Passing>,
    /// Irradiances for a spectrum of 1, and sums of the squares of what each photon has of them.
    pub(crate) irradiances: Vec<f32>,
    pub(crate) squares: Vec<f64>,
    /// In how many steps it changes by 1/λ² over the visible wavelengths, most of it.
    pub(crate) steps: u16,
    /// What all irradiances are multiplied by, and the part of the error that each photon has, relative to its light: the squares of all parts add up
    /// to that of the sum's standard error.
    pub(crate) share: f64,
    pub(crate) error: f64,
    table: Vec<[f32; LEAF]>,
}

/// Light that reaches a surface at some wavelengths: from one direction, or from all where directions don't matter.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Passing {
    /// The unit vector to where it comes from; zero for all directions.
    pub(crate) direction: DVec3,
    /// The product of spectra that it is multiplied by.
    pub(crate) spectrum: u32,
    /// In how many steps it is known.
    pub(crate) steps: u16,
    /// The number of the first end of a step at which it is known, and what is known from there on: a part of [`Passed::irradiances`] and of
    /// [`Passed::squares`].
    pub(crate) first: u16,
    pub(crate) known: Range<usize>,
}

/// What light is wanted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    /// The band that it is wanted for; all waves if there is none.
    pub(super) band: Option<Band>,
    /// Whether light from all directions counts alike.
    pub(super) alike: bool,
}

/// Sums over leaves: of light, and of light times radii and times relative biases.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    light: f64,
    radii: f64,
    biases: f64,
}

/// Where light of a product is added up, from the end of a step on.
struct Known<'p> {
    irradiances: &'p mut [f32],
    squares: &'p mut [f64],
    first: u16,
}

impl<'p> Known<'p> {
    fn new((irradiances, squares): (&'p mut [f32], &'p mut [f64]), known: Range<usize>, first: u16) -> Self {
        let irradiances = irradiances.get_mut(known.clone()).unwrap_or_default();
        Self { irradiances, squares: squares.get_mut(known).unwrap_or_default(), first }
    }

    /// Adds light and the squares of its parts at the end of a step, if that's asked for, of photons of which so much is there; the light.
    #[inline]
    fn add(&mut self, node: u16, (light, squares): (f32, f64), present: f32) -> f32 {
        let place = usize::from(node.wrapping_sub(self.first));
        let (Some(irradiance), Some(sum)) = (self.irradiances.get_mut(place), self.squares.get_mut(place)) else {
            return 0.0;
        };
        *irradiance += light;
        // The other half of a photon is no other photon.
        *sum += squares / f64::from(present);
        light
    }
}

impl Passed {
    /// Finds the light of photons at a place.
    pub(super) fn find(
        &mut self,
        thrown: &Thrown,
        (place, region): (&Place<'_>, &Region),
        density: &Density,
        wanted: Wanted,
    ) {
        self.list.clear();
        self.irradiances.clear();
        self.squares.clear();
        let mut sums = Sums::default();
        thrown.passing(place.surface, region, |ways, photons, footprint| {
            let Footprint { radius, bias } = footprint;
            let nodes = wanted.band.map_or([0, ways.steps + 1], |band| nodes_of(band, ways.steps));
            let near = ways.nodes_near(region.position, radius, nodes);
            if near[0] >= near[1] {
                return;
            }
            self.table.clear();
            let first = ways.light(About { region, radius, kernel: density.kernel }, near, &mut self.table);
            let light = match ways.spectrum {
                Some(spectrum) if wanted.alike && place.face.is_some() => self.add_all((ways, spectrum, first), nodes),
                _ => self.add_each((ways, first), (place, photons), nodes, wanted.alike),
            };
            let light = f64::from(light) / f64::from(nodes[1] - nodes[0]);
            sums.light += light;
            sums.radii += light * f64::from(radius);
            sums.biases += light * f64::from(bias);
        });
        let radius = if sums.light > 0.0 { sums.radii / sums.light } else { 0.0 };
        self.share = 1.0 / density.mass_within(place, radius);
        self.judge(sums);
    }

    /// Adds up the light of all photons of a leaf, which are of one product, from so many steps on after their ways began; the sum of all.
    fn add_all(&mut self, (ways, spectrum, start): (&Ways, u32, u16), nodes: [u16; 2]) -> f32 {
        let total: f32 = self.table.iter().map(sum_of).sum();
        if !(total > 0.0) {
            return 0.0;
        }
        let known = self.known((ways.steps, spectrum), nodes);
        let mut sums = Known::new((&mut self.irradiances, &mut self.squares), known, nodes[0]);
        let mut counted = 0.0;
        for (step, row) in (start..).zip(&self.table) {
            let present = ways.present(f32::from(step));
            if ways.are_together {
                counted += sums.add(ways.first(0) + step, (sum_of(row), squares_of(row)), present[0]);
                continue;
            }
            let mut lit = lit_of(row);
            while lit != 0 {
                let lane = lit.trailing_zeros() as usize;
                lit &= lit - 1;
                let square = f64::from(row[lane]) * f64::from(row[lane]);
                counted += sums.add(ways.first(lane) + step, (row[lane], square), present[lane]);
            }
        }
        counted
    }

    /// The same one by one.
    fn add_each(
        &mut self,
        (ways, start): (&Ways, u16),
        (place, photons): (&Place<'_>, &[super::Photon]),
        nodes: [u16; 2],
        alike: bool,
    ) -> f32 {
        let mut total = 0.0;
        let mut lit = self.table.iter().fold(0, |lit, row| lit | lit_of(row));
        while lit != 0 {
            let lane = lit.trailing_zeros() as usize;
            lit &= lit - 1;
            let Some(photon) = photons.get(lane).filter(|photon| place.sees(photon)) else { continue };
            let known = if alike {
                self.known((ways.steps, photon.spectrum), nodes)
            } else {
                let direction = Vec3A::from_array(photon.direction).as_dvec3();
                self.new_one(direction, (ways.steps, photon.spectrum), nodes)
            };
            let mut sums = Known::new((&mut self.irradiances, &mut self.squares), known, nodes[0]);
            for (step, row) in (start..).zip(&self.table).filter(|(_, row)| row[lane] > 0.0) {
                let square = f64::from(row[lane]) * f64::from(row[lane]);
                let present = ways.present(f32::from(step))[lane];
                total += sums.add(ways.first(lane) + step, (row[lane], square), present);
            }
        }
        total
    }

    /// Where light of a product that is known in some steps is added up.
    fn known(&mut self, (steps, spectrum): (u16, u32), nodes: [u16; 2]) -> Range<usize> {
        let is_it = |passing: &&Passing| passing.steps == steps && passing.spectrum == spectrum;
        match self.list.iter().find(is_it) {
            Some(known) => known.known.clone(),
            None => self.new_one(DVec3::ZERO, (steps, spectrum), nodes),
        }
    }

    fn new_one(&mut self, direction: DVec3, (steps, spectrum): (u16, u32), [first, end]: [u16; 2]) -> Range<usize> {
        let start = self.irradiances.len();
        let known = start..start + usize::from(end - first);
        self.irradiances.resize(known.end, 0.0);
        self.squares.resize(known.end, 0.0);
        self.list.push(Passing { direction, spectrum, steps, first, known: known.clone() });
        known
    }

    /// Decides on the steps, and on the part of the error that photons have.
    #[allow(clippy::cast_precision_loss, reason = "few wavelengths")]
    fn judge(&mut self, sums: Sums) {
        let mean = |known: &Range<usize>| {
            self.irradiances[known.clone()].iter().map(|x| f64::from(*x)).sum::<f64>() / known.len() as f64
        };
        let square = |known: &Range<usize>| self.squares[known.clone()].iter().sum::<f64>() / known.len() as f64;
        let squares: f64 = self.list.iter().map(|passing| square(&passing.known)).sum();
        self.error = if squares > 0.0 { (1.0 + sums.biases * sums.biases / squares).sqrt() } else { 0.0 };
        self.steps = self.list.iter().map(|passing| passing.steps).max().unwrap_or(1);
        let least = self.list.iter().map(|passing| passing.steps).min().unwrap_or(1);
        let mut faster = 0.0;
        while self.steps > least {
            let own = self.list.iter().filter(|passing| passing.steps == self.steps);
            faster += own.map(|passing| mean(&passing.known)).sum::<f64>();
            if faster > FASTEST * sums.light {
                break;
            }
            self.steps /= 2;
        }
    }
}

/// The sum of a leaf's numbers.
fn sum_of(row: &[f32; LEAF]) -> f32 {
    let mut parts = [0.0; 4];
    for four in row.chunks_exact(4) {
        parts.iter_mut().zip(four).for_each(|(part, x)| *part += x);
    }
    parts.iter().sum()
}

/// The sum of their squares.
fn squares_of(row: &[f32; LEAF]) -> f64 {
    let mut parts = [0.0; 4];
    for four in row.chunks_exact(4) {
        parts.iter_mut().zip(four).for_each(|(part, x)| *part += f64::from(*x) * f64::from(*x));
    }
    parts.iter().sum()
}

/// A bit for each that is above 0.
fn lit_of(row: &[f32; LEAF]) -> u32 {
    let fours = row.chunks_exact(4).map(|four| Vec4::from_slice(four).cmpgt(Vec4::ZERO).bitmask());
    fours.enumerate().fold(0, |lit, (place, bits)| lit | bits << (4 * place))
}

impl Passing {
    /// Some of its numbers at the end of a step, of so many: between those that are known on a line, or of more the mean about it.
    pub(crate) fn at<N: Copy + Into<f64>>(&self, numbers: &[N], node: u16, steps: u16) -> f64 {
        let known = numbers.get(self.known.clone()).unwrap_or_default();
        let number = |own: i32| -> Option<f64> {
            let place = usize::try_from(own - i32::from(self.first)).ok()?;
            known.get(place).map(|x| (*x).into())
        };
        if steps == self.steps {
            return number(i32::from(node)).unwrap_or(0.0);
        }
        if steps > self.steps {
            let times = steps / self.steps;
            let (before, part) = (i32::from(node / times), f64::from(node % times) / f64::from(times));
            let [from, to] = [before, before + 1].map(|own| number(own).unwrap_or(0.0));
            return from + (to - from) * part;
        }
        let times = i32::from(self.steps / steps);
        let (mut sum, mut total) = (0.0, 0.0);
        for off in 1 - times..times {
            if let Some(own) = number(i32::from(node) * times + off) {
                let weight = 1.0 - f64::from(off.abs()) / f64::from(times);
                sum += weight * own;
                total += weight;
            }
        }
        if total > 0.0 { sum / total } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{About, Passed, Passing, Place, Region, Sums, Ways};
    use crate::photon::map::LEAF;
    use crate::photon::motion::Motion;
    use crate::photon::random::Random;
    use crate::photon::{Kernel, Photon};

    fn passing(steps: u16, [first, end]: [u16; 2]) -> Passing {
        Passing { direction: DVec3::ZERO, spectrum: 0, steps, first, known: 0..usize::from(end - first) }
    }

    /// A line is the same in more steps and in fewer.
    #[test]
    fn lines_are_known_in_any_steps() {
        for (steps, [first, end]) in [(1, [0, 2]), (4, [0, 5]), (4, [1, 4]), (8, [3, 6])] {
            let line = passing(steps, [first, end]);
            let numbers: Vec<f64> = (first..end).map(|node| 3.0 + 2.0 * f64::from(node) / f64::from(steps)).collect();
            for others in [1_u16, 2, 4, 8, 64] {
                for node in 0..=others {
                    let at = f64::from(node) / f64::from(others) * f64::from(steps);
                    // A whole step is known on both sides, or the end itself.
                    let room = f64::from((steps / others).max(1)) - 1.0;
                    let is_within = at - room >= f64::from(first) && at + room <= f64::from(end - 1);
                    let found = line.at(&numbers, node, others);
                    assert!(
                        !is_within || (found - 3.0 - 2.0 * at / f64::from(steps)).abs() <= 1e-12,
                        "{steps} {others} {node}: {found}"
                    );
                }
            }
        }
        // What isn't known is not made up.
        assert_eq!(passing(4, [0, 1]).at(&[5.0_f64], 4, 4), 0.0);
    }

    /// Most of the light says in how many steps it is looked at, and photons' part of the error has the bias in it.
    #[test]
    fn little_light_that_is_fast_does_not_count() {
        for (fast, steps) in [(0.05_f32, 2), (0.5, 8)] {
            let list = vec![passing(2, [0, 3]), Passing { known: 3..12, ..passing(8, [0, 9]) }];
            let irradiances: Vec<f32> = [1.0; 3].into_iter().chain([fast; 9]).collect();
            let squares = irradiances.iter().map(|x| f64::from(*x) * 0.01).collect();
            let mut passed = Passed { list, irradiances, squares, ..Passed::default() };
            let light = 1.0 + f64::from(fast);
            passed.judge(Sums { light, radii: light, biases: 0.1 * light });
            assert_eq!(passed.steps, steps);
            let squares = 0.01 * light;
            assert!((passed.error - (1.0 + 0.01 * light * light / squares).sqrt()).abs() <= 1e-6);
        }
    }

    /// Two parts of a way are one photon where they meet, in light and in errors, whatever is asked for: together and one by one.
    #[test]
    fn parts_of_a_way_are_one_photon() {
        let own = Photon { flux: 3.0, ..Photon::default() };
        // A few that stay for all wavelengths, and others for parts of them that end at the same place.
        for cuts in [&[0.0_f32, 1.0][..], &[0.0, 0.5, 1.0], &[0.0, 0.25, 0.75, 1.0]] {
            let parts: Vec<Motion> = cuts
                .windows(2)
                .map(|limits| Motion { limits: [limits[0], limits[1]], at: limits[0], ..Motion::default() })
                .collect();
            let photons = vec![own; parts.len()];
            let region = Region::ball([0.0; 3], 0.0);
            let place = Place { position: [0.0; 3], normal: [0.0; 3], surface: 0, face: None };
            let ways = Ways::new(&photons, &parts, 1.0, 4);
            assert_eq!(ways.are_together, parts.len() == 1);
            for nodes in [[0, 5], [1, 4], [2, 3], [0, 3], [4, 5]] {
                for is_alike in [true, false] {
                    let mut passed = Passed::default();
                    let about = About { region: &region, radius: 1.0, kernel: Kernel::Constant };
                    let start = ways.light(about, nodes, &mut passed.table);
                    let total = if is_alike {
                        passed.add_all((&ways, 0, start), nodes)
                    } else {
                        passed.add_each((&ways, start), (&place, &photons), nodes, true)
                    };
                    let light = 3.0 / core::f32::consts::PI;
                    let count = nodes[1] - nodes[0];
                    assert_eq!(passed.irradiances.len(), usize::from(count));
                    assert!((total - f32::from(count) * light).abs() <= 1e-5, "{cuts:?} {nodes:?}: {total}");
                    for (irradiance, squares) in passed.irradiances.iter().zip(&passed.squares) {
                        assert!((irradiance - light).abs() <= 1e-6, "{cuts:?} {nodes:?}: {irradiance}");
                        let square = f64::from(light) * f64::from(light);
                        assert!((squares - square).abs() <= 1e-6, "{cuts:?} {nodes:?} {is_alike}: {squares}");
                    }
                }
            }
        }
    }

    /// Where all ways of a leaf end together before the last wavelength, half of each photon is there at their end, and its square is half of a whole's.
    #[test]
    fn halves_that_end_together_are_half_a_photon_each() {
        let photons = [Photon { flux: 3.0, ..Photon::default() }; 2];
        let ways = Ways::new(&photons, &[Motion { limits: [0.0, 0.5], ..Motion::default() }; 2], 1.0, 4);
        assert!(ways.are_together);
        let (region, mut passed) = (Region::ball([0.0; 3], 0.0), Passed::default());
        let about = About { region: &region, radius: 1.0, kernel: Kernel::Constant };
        let start = ways.light(about, [0, 5], &mut passed.table);
        passed.add_all((&ways, 0, start), [0, 5]);
        let light = 3.0 / core::f32::consts::PI;
        for ((irradiance, squares), photons) in
            passed.irradiances.iter().zip(&passed.squares).zip([2.0, 2.0, 1.0, 0.0, 0.0])
        {
            assert!((irradiance - photons * light).abs() <= 1e-6, "{irradiance}");
            assert!((squares - f64::from(photons * light * light)).abs() <= 1e-6, "{squares}");
        }
    }

    /// Where photons of a leaf may be near enough, none is left out; of many places most ends of steps are.
    #[test]
    fn light_is_found_where_it_may_be() {
        let mut random = Random::new(7);
        let (mut asked, mut near_ones, mut lit) = (0, 0, 0_u32);
        for leaf in 0..200_u16 {
            // Some stay, others are slow or fast, on a line or all over, the whole time or for a part of it.
            let speed = [0.0, 0.1, 4.0, 40.0][usize::from(leaf % 4)];
            let course = random.vector();
            let photon = |random: &mut Random| {
                let photon = Photon { position: random.vector().map(|x| 0.3 * x), flux: 1.0, ..Photon::default() };
                let own = random.vector();
                let position = core::array::from_fn(|i| speed * (course[i] + 0.1 * own[i]));
                let limits = if leaf % 5 == 0 { [0.25, 0.75] } else { [0.0, 1.0] };
                (photon, Motion { position, limits, at: 0.5, ..Motion::default() })
            };
            let (photons, motions): (Vec<_>, Vec<_>) = (0..LEAF).map(|_| photon(&mut random)).unzip();
            let ways = Ways::new(&photons, &motions, 1.0, 4);
            for _ in 0..50 {
                let position = random.vector().map(|x| (1.0 + speed) * x);
                let region = Region::ball(position, 0.0);
                let about = About { region: &region, radius: 1.0, kernel: Kernel::Constant };
                for nodes in [[0, ways.steps + 1], [1, ways.steps]] {
                    let (mut all, mut some) = (Vec::new(), Vec::new());
                    let first = ways.light(about, nodes, &mut all);
                    let near = ways.nodes_near(position, 1.0, nodes);
                    assert!(nodes[0] <= near[0] && near[1] <= nodes[1]);
                    let start = if near[0] < near[1] { ways.light(about, near, &mut some) } else { first };
                    for (step, row) in (first..).zip(&all) {
                        let found = step.checked_sub(start).and_then(|place| some.get(usize::from(place)));
                        assert!(found.is_some_and(|found| found == row) || row.iter().all(|light| *light == 0.0));
                        lit += u32::from(row.iter().any(|light| *light > 0.0));
                    }
                    asked += u32::from(nodes[1] - nodes[0]);
                    near_ones += u32::from(near[1].saturating_sub(near[0]));
                }
            }
        }
        assert!(lit > 500 && near_ones < 2 * lit + asked / 10, "{lit}, {near_ones} of {asked}");
    }
}
