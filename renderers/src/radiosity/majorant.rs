//! Upper bounds of solutions, at the cost of a few passes through the operator.
//!
//! Whatever V satisfies V − ρKV ≥ S in all leaves is at least the solution of X − ρKX = S, where light comes to an end (L. Collatz, Math. Z. 48,
//! 1942). So an approximate solution is enough, scaled and raised until it does: V = tV̂ + mA, where A − ρKA ≥ 1, has V − ρKV ≥ t(V̂ − ρKV̂) + m,
//! so that t and m are read off V̂ and K V̂, leaf by leaf, less what rounding may have done to these. What V reflects, S + ρKV, lies
//! between X and V and is what is returned, with KV ≥ KX. A itself is found in the same way from S = 1 by scaling alone; as it is positive and A − ρKA
//! is, too, the spectral radius of ρK is below 1 for this and all lesser ρ (Collatz–Wielandt), so that nothing else need be known of the scene.
//!
//! How V̂ was found doesn't matter to any of this. It is found by
//! cycles of two grids: what a residual sends on after one reflection is smooth and solved for between groups of leaves.

use super::coarse::{Coarse, Factored};
use super::transport::{Buffer, Transport};

/// What a solution may be scaled by, and the most that it is raised by for the last of these as a share of the greatest source, unless cycles
/// are of no use.
const SCALES: [f64; 6] = [1.0, 1.005, 1.01, 1.02, 1.03, SCALED];
const SCALED: f64 = 1.05;
const RAISED: f64 = 5e-3;
const MOST_CYCLES: usize = 40;
/// So many cycles may be of no use.
const SURE_CYCLES: usize = 3;
/// A cycle must leave less than this of a residual.
const STUCK: f64 = 0.7;

/// Where bounds are found.
#[derive(Clone, Copy)]
pub(super) struct Above<'a> {
    pub(super) transport: &'a Transport,
    pub(super) coarse: &'a Coarse,
    /// A with A − ρKA ≥ 1 for all reflectances, and KA; empty where only scaling is wanted.
    pub(super) amplification: &'a [f64],
    pub(super) amplified: &'a [f64],
    /// What rounding may change of an [irradiance](Transport::rounding).
    pub(super) rounding: f64,
}

/// A number of each leaf's kind, for some components.
#[derive(Clone, Copy)]
pub(super) struct Kinds<'k, const W: usize> {
    pub(super) numbers: &'k [[f64; W]],
    /// The kind of each leaf.
    pub(super) kind: &'k [usize],
}

impl<'k, const W: usize> Kinds<'k, W> {
    pub(super) fn of(&self, leaf: usize) -> &'k [f64; W] {
        &self.numbers[self.kind[leaf]]
    }

    pub(super) fn rows(self) -> impl Iterator<Item = &'k [f64; W]> {
        self.kind.iter().map(move |kind| &self.numbers[*kind])
    }
}

/// The reflectances of leaves and of groups, and what solves for groups.
pub(super) type Reflecting<'a, const W: usize> = (Kinds<'a, W>, &'a [[f64; W]], &'a Factored<W>);

/// S − (X − ρ K X), from X and K X.
fn residue<const W: usize>(
    (source, reflectance): (&[[f64; W]], Kinds<'_, W>),
    (values, irradiance): (&[[f64; W]], &[[f64; W]]),
    residual: &mut [[f64; W]],
) {
    let rows = residual.iter_mut().zip(source).zip(values).zip(irradiance).zip(reflectance.rows());
    rows.for_each(|((((r, s), v), k), rho)| *r = each(|i| s[i] - (v[i] - rho[i] * k[i])));
}

/// At least the solution X, or nearly, K X as well, and how often this was carried through the operator.
pub(super) struct Majorant<const W: usize> {
    pub(super) values: Vec<[f64; W]>,
    pub(super) irradiance: Vec<[f64; W]>,
    pub(super) passes: usize,
}

fn each<const W: usize>(f: impl FnMut(usize) -> f64) -> [f64; W] {
    core::array::from_fn(f)
}

impl Above<'_> {
    /// At least the solution of X = S + ρ K X, for sources that aren't negative, and the reflectances of leaves and of groups.
    pub(super) fn solve<const W: usize>(
        &self,
        source: &[[f64; W]],
        reflectance: Kinds<'_, W>,
        of_groups: &[[f64; W]],
        buffer: &mut Buffer,
    ) -> Majorant<W> {
        let factored = Factored::new(self.coarse, of_groups);
        let mut values = vec![[0.0; W]; source.len()];
        let mut irradiance = vec![[0.0; W]; source.len()];
        let mut residual = source.to_vec();
        let (mut passes, mut before) = (0, f64::INFINITY);
        loop {
            self.cycle((reflectance, of_groups, &factored), &residual, (&mut values, &mut irradiance), buffer);
            passes += 2 * W;
            let raise = self.raise(source, &values, &irradiance, reflectance);
            let left = raise.left.iter().fold(0.0, |m, left| greater(m, *left));
            let stuck = passes > 2 * W * SURE_CYCLES && !(left < STUCK * before);
            if left <= 1.0 || stuck || passes >= 2 * W * MOST_CYCLES {
                self.raised(&raise, source, reflectance, &mut values, &mut irradiance);
                return Majorant { values, irradiance, passes };
            }
            before = left;
            residue((source, reflectance), (&values, &irradiance), &mut residual);
        }
    }

    /// Nearly the solution of X = S + ρ K X, for any sources, by so many cycles.
    pub(super) fn near<const W: usize>(
        &self,
        source: &[[f64; W]],
        (reflectance, of_groups, factored): Reflecting<'_, W>,
        cycles: usize,
        buffer: &mut Buffer,
    ) -> Majorant<W> {
        let mut values = vec![[0.0; W]; source.len()];
        let mut irradiance = vec![[0.0; W]; source.len()];
        let mut residual = source.to_vec();
        for cycle in 0..cycles {
            if cycle > 0 {
                residue((source, reflectance), (&values, &irradiance), &mut residual);
            }
            self.cycle((reflectance, of_groups, factored), &residual, (&mut values, &mut irradiance), buffer);
        }
        Majorant { values, irradiance, passes: 2 * cycles * W }
    }

    /// Adds to values what solves for their residual, nearly, and finds K times them.
    fn cycle<const W: usize>(
        &self,
        (reflectance, of_groups, factored): Reflecting<'_, W>,
        residual: &[[f64; W]],
        (values, irradiance): (&mut [[f64; W]], &mut [[f64; W]]),
        buffer: &mut Buffer,
    ) {
        self.transport.apply_rows(residual, irradiance, buffer);
        let smooth = self.smooth(factored, of_groups, irradiance);
        let spread = self.coarse.spread.chunks(self.coarse.count().max(1));
        let rows = values.iter_mut().zip(residual).zip(&*irradiance).zip(reflectance.rows()).zip(spread);
        for ((((v, r), k), rho), spread) in rows {
            let light = spread.iter().zip(&smooth).fold(*k, |sum, (e, c)| each(|i| sum[i] + e * c[i]));
            *v = each(|i| v[i] + r[i] + rho[i] * light[i]);
        }
        self.transport.apply_rows(values, irradiance, buffer);
    }

    /// What groups send out of an irradiance and of its reflections, as if each group received its mean.
    fn smooth<const W: usize>(
        &self,
        factored: &Factored<W>,
        of_groups: &[[f64; W]],
        irradiance: &[[f64; W]],
    ) -> Vec<[f64; W]> {
        let coarse = self.coarse;
        let mut means = vec![[0.0; W]; coarse.count()];
        for ((k, group), area) in irradiance.iter().zip(&coarse.group).zip(&self.transport.areas) {
            let share = area / coarse.areas[*group];
            means[*group] = each(|i| means[*group][i] + share * k[i]);
        }
        factored.solve(&mut means);
        means.iter().zip(of_groups).map(|(m, rho)| each(|i| rho[i] * m[i])).collect()
    }

    /// What makes an approximate solution a bound.
    fn raise<const W: usize>(
        &self,
        source: &[[f64; W]],
        values: &[[f64; W]],
        irradiance: &[[f64; W]],
        reflectance: Kinds<'_, W>,
    ) -> Raise<W> {
        let greatest = |rows: &[[f64; W]]| rows.iter().fold([0.0_f64; W], |m, row| each(|i| m[i].max(row[i].abs())));
        let (most, size) = (greatest(source), greatest(values));
        let sent = |place: usize| -> [f64; W] {
            let (v, k, rho) = (&values[place], &irradiance[place], reflectance.of(place));
            each(|i| v[i] - rho[i] * k[i] - self.rounding * size[i])
        };
        if self.amplification.is_empty() {
            let mut scale = [1.0_f64; W];
            for (place, s) in source.iter().enumerate() {
                let sent = sent(place);
                let ratio = |i: usize| if s[i] > 0.0 { s[i] / sent[i] } else { 1.0 };
                // Negative where no scale is enough. Only what isn't negative anywhere shows that light comes to an end.
                let good = |i: usize| ratio(i) > 0.0 && values[place][i] >= 0.0;
                scale = each(|i| if good(i) { scale[i].max(ratio(i)) } else { f64::INFINITY });
            }
            return Raise { scale, more: [0.0; W], left: scale.map(|t| (t - 1.0) / (SCALED - 1.0)) };
        }
        let mut more = [[0.0_f64; W]; SCALES.len()];
        let (mut mean, mut amplification) = ([0.0; W], 0.0);
        for (place, s) in source.iter().enumerate() {
            let (sent, area) = (sent(place), self.transport.areas[place]);
            for (more, scale) in more.iter_mut().zip(SCALES) {
                *more = each(|i| greater(more[i], s[i] - scale * sent[i]));
            }
            mean = each(|i| mean[i] + area * values[place][i]);
            amplification += area * self.amplification[place];
        }
        // Whichever makes the mean least.
        let cost = |choice: usize, i: usize| SCALES[choice] * mean[i] + more[choice][i] * amplification;
        let best: [usize; W] = core::array::from_fn(|i| {
            (0..SCALES.len()).min_by(|a, b| cost(*a, i).total_cmp(&cost(*b, i))).unwrap_or(SCALES.len() - 1)
        });
        let last = more[SCALES.len() - 1];
        let left = each(|i| if last[i] > 0.0 { last[i] / (RAISED * most[i]) } else { 0.0 });
        Raise { scale: each(|i| SCALES[best[i]]), more: each(|i| more[best[i]][i]), left }
    }

    /// Scales and raises an approximate solution; what it reflects is a bound again, and a better one.
    ///
    /// With what rounding does to K V: where an approximate solution is negative it is less than what it is raised by, so that K of its size
    /// is at most K V and K of that.
    fn raised<const W: usize>(
        &self,
        raise: &Raise<W>,
        source: &[[f64; W]],
        reflectance: Kinds<'_, W>,
        values: &mut [[f64; W]],
        irradiance: &mut [[f64; W]],
    ) {
        let Raise { scale, more, .. } = raise;
        let up = 1.0 + 4.0 * self.rounding;
        for (place, k) in irradiance.iter_mut().enumerate() {
            let amplified = self.amplified.get(place).copied().unwrap_or(0.0) * up;
            *k = each(|i| greater(0.0, scale[i] * k[i] + more[i] * amplified) * up);
            let (s, rho) = (&source[place], reflectance.of(place));
            values[place] = each(|i| (s[i] + rho[i] * k[i]) * up);
        }
    }
}

/// The greater one, infinite where that is unknown.
fn greater(one: f64, other: f64) -> f64 {
    if other <= one {
        one
    } else if other > one {
        other
    } else {
        f64::INFINITY
    }
}

/// What makes an approximate solution a bound.
struct Raise<const W: usize> {
    scale: [f64; W],
    /// Times the amplification.
    more: [f64; W],
    /// How far off the solution is, where 1 is good enough.
    left: [f64; W],
}

#[cfg(test)]
pub(super) mod tests {
    use super::{Above, Kinds, RAISED, SCALED};
    use crate::radiosity::coarse::Coarse;
    use crate::radiosity::solve::System;
    use crate::radiosity::transport::{Buffer, Buffers, Transport};

    pub(in crate::radiosity) const LEAVES: usize = 40;
    const GROUPS: usize = 5;

    /// Uneven numbers in [0, 1).
    pub(in crate::radiosity) fn number(seed: usize) -> f64 {
        let [low, high] = [seed % 97, seed / 97].map(|part| f64::from(u32::try_from(part).unwrap_or(0)));
        (0.618_033_988_75 * (low + 1.0) * (low + 3.0) + 0.414_213_562_37 * high * (high + 7.0)).fract()
    }

    /// Leaves of uneven areas that exchange uneven shares of their light, with row sums of at most 1.
    pub(in crate::radiosity) fn transport() -> Transport {
        let areas: Vec<f64> = (0..LEAVES).map(|leaf| 0.5 + number(leaf)).collect();
        let exchange = |a: usize, b: usize| if a == b { 0.0 } else { number(LEAVES * a.min(b) + a.max(b) + 100) };
        let row = |a: usize| (0..LEAVES).map(move |b| exchange(a, b));
        let most = (0..LEAVES).map(|a| row(a).sum::<f64>() / areas[a]).fold(0.0, f64::max);
        let between =
            (0..LEAVES).flat_map(|a| row(a).map(move |e| (a, e))).map(|(a, e)| e / (areas[a] * most)).collect();
        let group = (0..LEAVES).collect();
        Transport::between(&Coarse { group, areas, between, spread: Vec::new() })
    }

    fn coarse(transport: &Transport) -> Coarse {
        let mut buffer = Buffer::default();
        let mut coarse = Coarse::new(transport, (0..LEAVES).map(|leaf| leaf % GROUPS).collect(), GROUPS, &mut buffer);
        coarse.spread_out(transport, &mut buffer);
        coarse
    }

    #[test]
    fn groups_receive_the_mean_of_their_leaves() {
        let transport = transport();
        let coarse = coarse(&transport);
        for to in 0..GROUPS {
            for from in 0..GROUPS {
                let mine = (0..LEAVES).filter(|leaf| coarse.group[*leaf] == to);
                let mean: f64 = mine
                    .map(|leaf| transport.areas[leaf] / coarse.areas[to] * coarse.spread[leaf * GROUPS + from])
                    .sum();
                let found = coarse.between[to * GROUPS + from];
                assert!((found - mean).abs() <= 1e-14 * mean, "{found} {mean}");
            }
        }
    }

    /// Against conjugate gradients to the last digits: never below, and hardly above; reflectances differ within groups, too.
    #[test]
    fn bounds_are_above_solutions_and_near() {
        let transport = transport();
        let coarse = coarse(&transport);
        let mut buffer = Buffer::default();
        for top in [0.3, 0.9, 0.999] {
            let reflectance: Vec<[f64; 2]> = (0..LEAVES)
                .map(|leaf| [top * (0.6 + 0.4 * number(leaf + 7000)), if leaf % GROUPS == 2 { 0.0 } else { top }])
                .collect();
            let of_groups: Vec<[f64; 2]> = reflectance[..GROUPS].to_vec();
            let lit: Vec<[f64; 2]> =
                (0..LEAVES).map(|leaf| [number(leaf + 9000), if leaf == 3 { 1.0 } else { 0.0 }]).collect();
            let source: Vec<[f64; 2]> = lit.iter().zip(&reflectance).map(|(h, r)| [h[0] * r[0], h[1] * r[1]]).collect();
            let rounding = transport.rounding();
            let scaled = Above { transport: &transport, coarse: &coarse, amplification: &[], amplified: &[], rounding };
            let ones = vec![[1.0]; LEAVES];
            let most = |count: usize| vec![[top]; count];
            let most_of_kinds = most(1);
            let all = Kinds { numbers: &most_of_kinds, kind: &[0; LEAVES] };
            let amplification = scaled.solve(&ones, all, &most(GROUPS), &mut buffer);
            let above = Above {
                amplification: amplification.values.as_flattened(),
                amplified: amplification.irradiance.as_flattened(),
                ..scaled
            };
            let each: Vec<usize> = (0..LEAVES).collect();
            let found = above.solve(&source, Kinds { numbers: &reflectance, kind: &each }, &of_groups, &mut buffer);
            let system = System {
                transport: &transport,
                width: 2,
                reflectance: reflectance.into_flattened(),
                lit: lit.into_flattened(),
                largest_sum: 1.0,
            };
            let exact = system.solve(1e-13, &Buffers::default());
            let pairs = [(&found.values, &exact.reflected), (&found.irradiance, &exact.irradiance)];
            for (bound, exact) in pairs {
                for (place, (bound, exact)) in bound.as_flattened().iter().zip(exact.iter()).enumerate() {
                    // What a solution is raised by at most, for a greatest source of at most 1.
                    let raised = RAISED * amplification.values[place / 2][0];
                    assert!(*bound >= exact * (1.0 - 1e-12), "{top}, {place}: {bound} {exact}");
                    assert!(*bound <= SCALED * exact + raised, "{top}, {place}: {bound} {exact}");
                }
            }
        }
    }
}
