//! Beams: the light of one source that meets one mirror or piece of glass before anything else.
//!
//! Spheres are aimed at by directions in the cone that they fill, everything else by points on its surface: facets, divided where a light
//! is near, are chosen by the light that they receive, as some trial rays found it. A ray counts only if it meets first what it
//! was aimed at, so that beams share the light of a scene without overlap, whatever is in front of what.

use super::aim::{Aim, Lamp};
use super::points::{Points, Purpose};
use super::target::{Body, Facet, Target};
use super::trace::Surroundings;
use crate::direct::{Light, Scratch};
use crate::geometry::Hit;

/// Facets are divided until they are smaller than this part of their distance from the light, so often at most, and into so many parts of
/// the whole target.
const LARGEST_PART: f64 = 0.5;
const MOST_DIVISIONS: u32 = 6;
const MOST_PARTS: usize = 1 << 18;

/// How many trial rays a target is explored by, and each of its parts at least and at most.
const TRIALS: usize = 1 << 16;
const TRIALS_OF_PART: [usize; 2] = [3, 15];

/// What parts are taken to receive at least, of the mean: light may reach other places of them than those looked at.
const DARK: f64 = 1.0 / 8.0;

/// Attempts that tell how much flux a beam has, and more of them if none met its target.
const PILOT: u32 = 2048;
const LONG_PILOT: u32 = 1 << 15;

/// The numbers of passes that are no passes.
const EXPLORING: u32 = u32::MAX;
const PILOTING: u32 = u32::MAX - 1;

/// A part of a target: a square of the unit square of one of its facets.
#[derive(Clone, Copy, Debug)]
struct Part {
    facet: u32,
    low: [f32; 2],
    size: f32,
    /// The facet's area over the probability of the part, by area.
    area: f64,
}

/// One light aimed at one mirror or piece of glass.
#[derive(Clone, Debug)]
pub(crate) struct Beam {
    /// The light's number among those of [`Whitted`](crate::whitted::Whitted).
    pub(crate) light: u32,
    /// The number of the shape.
    pub(crate) shape: u32,
    /// The mean flux of an attempt for a light factor of 1, as the pilot found it: the flux of the beam, in m² sr, sr or m².
    pub(crate) flux: f64,
    /// How many of the attempts meet the target, and how many of the rays that were traced for them.
    pub(crate) share_of_attempts: f64,
    pub(crate) share_of_rays: f64,
    /// None for spheres.
    parts: Vec<Part>,
    cumulative: Vec<f64>,
    /// Attempts with less flux than this are made as often as their flux is of this one, and then count for this much.
    typical: f64,
}

/// What an attempt came to.
#[derive(Clone, Copy, Debug)]
pub(super) enum Attempt {
    /// Nothing was traced.
    None,
    /// The ray met something else, or the side that is no mirror.
    Missed,
    /// The ray met its target.
    Met(Aim, Hit),
}

impl Beam {
    /// Explores how a light sees a target; `None` if none of very many rays meets it.
    pub(super) fn new(
        [light, shape]: [u32; 2],
        (lamp, target): (Lamp<'_>, &Target),
        around: &Surroundings<'_>,
        seed: u32,
    ) -> Option<Self> {
        let mut beam = Self {
            light,
            shape,
            flux: 0.0,
            share_of_attempts: 0.0,
            share_of_rays: 0.0,
            parts: Vec::new(),
            cumulative: Vec::new(),
            typical: 0.0,
        };
        let number = shape.wrapping_mul(0x9e37).wrapping_add(light);
        if let Body::Facets(facets) = &target.body {
            beam.divide(facets, lamp);
            beam.explore(facets, (lamp, target), around, Points::new(seed, EXPLORING, number));
        }
        let points = Points::new(seed, PILOTING, number);
        let counts = [PILOT, LONG_PILOT];
        counts.into_iter().any(|count| beam.pilot(count, (lamp, target), around, points)).then_some(beam)
    }

    /// Cuts facets in parts that are small as seen from the light.
    #[allow(clippy::cast_possible_truncation, reason = "multiples of powers of two")]
    fn divide(&mut self, facets: &[Facet], lamp: Lamp<'_>) {
        for (number, facet) in (0..).zip(facets) {
            let mut squares = vec![([0.0; 2], 1.0, 0)];
            while let Some(([x, y], size, divisions)) = squares.pop() {
                let half: f64 = size / 2.0;
                let distance = lamp.scale(facet.at([x + half, y + half])) - facet.diameter(half);
                let small = facet.diameter(size) <= LARGEST_PART * distance;
                if small || divisions == MOST_DIVISIONS || self.parts.len() + squares.len() >= MOST_PARTS {
                    self.parts.push(Part { facet: number, low: [x as f32, y as f32], size: size as f32, area: 0.0 });
                } else {
                    let corners = [[0.0, 0.0], [half, 0.0], [0.0, half], [half, half]];
                    squares.extend(corners.map(|[dx, dy]| ([x + dx, y + dy], half, divisions + 1)));
                }
            }
        }
    }

    /// Finds how much light each part receives, which it is chosen by.
    #[allow(clippy::cast_precision_loss, reason = "counts of trials and parts")]
    fn explore(
        &mut self,
        facets: &[Facet],
        (lamp, target): (Lamp<'_>, &Target),
        around: &Surroundings<'_>,
        points: Points,
    ) {
        let [least, most] = TRIALS_OF_PART;
        let trials = (TRIALS / self.parts.len().max(1)).clamp(least, most);
        let mut scratch = Scratch::default();
        let mut received = |(number, part): (usize, &Part)| {
            let facet = &facets[part.facet as usize];
            let unhindered = lamp.irradiance(facet, facet.at(part.within([0.5; 2])), &mut scratch);
            let (mut all, mut met) = (0.0, 0.0);
            for trial in 0..trials {
                let [s, t, p, q] = points.place(u32::try_from(number * trials + trial).unwrap_or(u32::MAX));
                let Some(aim) = lamp.aim_at_facet(facet, facet.at(part.within([s, t])), [p, q]) else { continue };
                all += aim.flux;
                if matches!(reach(aim, target, around), Attempt::Met(..)) {
                    met += aim.flux;
                }
            }
            // As if one more had met it: what is hidden in all trials may be seen the next time.
            let one = all / trials as f64;
            let seen = if all > 0.0 { (met + one) / (all + one) } else { 1.0 };
            facet.area * f64::from(part.size).powi(2) * unhindered * seen
        };
        let mut weights: Vec<f64> = self.parts.iter().enumerate().map(&mut received).collect();
        let areas: Vec<f64> =
            self.parts.iter().map(|p| facets[p.facet as usize].area * f64::from(p.size).powi(2)).collect();
        let (flux, area) = (weights.iter().sum::<f64>(), areas.iter().sum::<f64>());
        // Where nothing was found at all, all places count alike.
        let dark = if flux > 0.0 { DARK * flux / area } else { 1.0 };
        for (weight, area) in weights.iter_mut().zip(&areas) {
            *weight = weight.max(dark * area);
        }
        let total: f64 = weights.iter().sum();
        let mut sum = 0.0;
        for ((part, weight), area) in self.parts.iter_mut().zip(weights).zip(areas) {
            part.area = area * (total / weight);
            sum += weight;
            self.cumulative.push(sum);
        }
    }

    /// Measures the beam; whether any of its rays met the target.
    fn pilot(
        &mut self,
        count: u32,
        (lamp, target): (Lamp<'_>, &Target),
        around: &Surroundings<'_>,
        points: Points,
    ) -> bool {
        self.typical = 0.0;
        let (mut sum, mut met) = (0.0, 0_u32);
        for index in 0..count {
            if let Attempt::Met(aim, _) = self.attempt((lamp, target), around, points, index) {
                sum += aim.flux;
                met += 1;
            }
        }
        if met == 0 {
            return false;
        }
        self.flux = sum / f64::from(count);
        self.typical = sum / f64::from(met);
        let (mut met, mut traced) = (0_u32, 0_u32);
        for index in 0..count {
            match self.attempt((lamp, target), around, points, index) {
                Attempt::None => {}
                Attempt::Missed => traced += 1,
                Attempt::Met(..) => {
                    traced += 1;
                    met += 1;
                }
            }
        }
        // Where roulette left nothing of the few that met it, one of them is taken to be left.
        self.share_of_attempts = f64::from(met.max(1)) / f64::from(count);
        self.share_of_rays = f64::from(met) / f64::from(traced.max(1));
        true
    }

    /// One attempt; the flux is that for a light factor of 1 if there is one attempt in all.
    pub(super) fn attempt(
        &self,
        (lamp, target): (Lamp<'_>, &Target),
        around: &Surroundings<'_>,
        points: Points,
        index: u32,
    ) -> Attempt {
        let u = points.place(index);
        let aim = match &target.body {
            Body::Ball(ball) => lamp.aim_at_ball(ball, u),
            Body::Facets(facets) => self.to_parts(facets, lamp, target, u),
        };
        let Some(aim) = aim else { return Attempt::None };
        if aim.flux >= self.typical {
            return reach(aim, target, around);
        }
        if points.decision(index, 0, Purpose::Start) * self.typical >= aim.flux {
            return Attempt::None;
        }
        reach(Aim { flux: self.typical, ..aim }, target, around)
    }

    /// A ray to a part that is chosen by the light that it receives.
    fn to_parts(&self, facets: &[Facet], lamp: Lamp<'_>, target: &Target, [s, t, p, q]: [f64; 4]) -> Option<Aim> {
        let total = self.cumulative.last()?;
        let place = s * total;
        let number = self.cumulative.partition_point(|sum| *sum <= place).min(self.parts.len() - 1);
        let before = number.checked_sub(1).and_then(|n| self.cumulative.get(n)).copied().unwrap_or(0.0);
        let (part, until) = (self.parts.get(number)?, self.cumulative.get(number)?);
        let facet = facets.get(part.facet as usize)?;
        let rest = ((place - before) / (until - before)).clamp(0.0, 1.0);
        let aim = lamp.aim_at_facet(facet, facet.at(part.within([rest, t])), [p, q])?;
        let front = facet.normal.dot(aim.ray.direction.as_dvec3()) < 0.0;
        (target.side(front) > 0.0).then_some(Aim { flux: aim.flux * part.area, ..aim })
    }

    /// The flux of all attempts together for the light's factor, with the light's spectrum by its mean.
    pub(super) fn luminous(&self, light: &Light, around: &Surroundings<'_>) -> f64 {
        let factor = light.factor();
        self.flux * factor.scale * around.mean(factor)
    }
}

impl Part {
    fn within(&self, u: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|i| f64::from(self.low[i]) + u[i] * f64::from(self.size))
    }
}

/// Traces a ray to its target.
fn reach(aim: Aim, target: &Target, around: &Surroundings<'_>) -> Attempt {
    match around.scene.world().closest_hit(&aim.ray) {
        Some(hit) if hit.primitive == aim.primitive && target.side(hit.front) > 0.0 => Attempt::Met(aim, hit),
        _ => Attempt::Missed,
    }
}
