//! Patches receive from all around them what they must.
//!
//! The form factors of a patch add up to the share of its hemisphere that patches fill: 1 in a closed space. Links take form factors as
//! constant over groups of patches, and visibility is sampled: sums are off, and what multiple reflections make of that grows like
//! 1/(1 − ρ). The symmetric scaling D G D with the positive diagonal D that gives all sums their value (R. Sinkhorn, Ann. Math. Statist.
//! 35, 1964) keeps reciprocity and puts that right: in closed spaces the total of the light is then exact, whatever the mesh.

use rayon::prelude::*;

use super::cluster;
use super::exchange::exchange;
use super::mesh::{LEAF, Patches};
use super::sight::{spread, surface_point};
use super::transport::{Buffer, Link, Transport};
use crate::geometry::glam::Vec3A;
use crate::geometry::sampling::square_to_cosine_hemisphere;

/// Rays that look for a hole in a space.
const RAYS: usize = 1 << 14;
/// The least number of rays from a leaf; and where there are clusters, whose links are less exact than that many rays.
const FEW_RAYS: u32 = 4;
const MANY_RAYS: u32 = 256;
/// Sums further from 1 than this are not of a closed space, whatever rays say.
const FURTHEST: f64 = 0.75;
const ROUNDS: usize = 200;
/// Rounds end when the largest error falls by less: at rounding, or where patches may not be scaled any more.
const SLOW: f64 = 0.98;
/// The most by which a patch is scaled.
const MOST_SCALE: f64 = 2.0;
/// Relative error of the form factors that sums are made of.
const TOLERANCE: f64 = 1e-5;
/// The most that a group's open shares are filled by what some of its leaves have in excess; where that is not enough, those of a larger group are.
const MOST_FILLED: f64 = 0.5;
/// When sums are near enough to what they should be.
const NEAR: f64 = 4e-15;

/// How well light is kept.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Balance {
    /// Share of the area of patches that belongs to closed spaces.
    pub(super) closed: f64,
    /// Largest |ΣF − 1| there before scaling.
    pub(super) before: f64,
    /// The same after scaling.
    pub(super) after: f64,
    /// Largest ΣF anywhere, after scaling.
    pub(super) largest: f64,
}

/// Scales the operator.
pub(super) fn balance(patches: &Patches, links: &[Link], transport: &mut Transport, buffer: &mut Buffer) -> Balance {
    let roots = roots(patches);
    let mut groups = connected(patches, links, &roots);
    let group_of = |groups: &mut Groups, leaf: u32| groups.find(roots[leaf as usize]);
    let mut open = vec![false; patches.roots + patches.clusters.len()];
    let filled = filled(patches, &transport.leaves);
    for (leaf, share) in transport.leaves.iter().zip(&filled) {
        open[group_of(&mut groups, *leaf)] |= *share < 1.0;
    }
    let mut sums = transport.row_sums(buffer);
    for (leaf, sum) in transport.leaves.iter().zip(&sums) {
        open[group_of(&mut groups, *leaf)] |= !((sum - 1.0).abs() <= FURTHEST);
    }
    let closed: Vec<bool> = transport.leaves.iter().map(|leaf| !open[group_of(&mut groups, *leaf)]).collect();
    let targets = if patches.clusters.is_empty() {
        targets(patches, links, transport, &closed)
    } else {
        filled.iter().zip(&closed).map(|(share, closed)| if *closed { 1.0 } else { *share }).collect()
    };
    let off = |sums: &[f64]| {
        let closed = sums.iter().zip(&closed).filter(|(_, closed)| **closed);
        closed.fold(0.0_f64, |off, (sum, _)| off.max((sum - 1.0).abs()))
    };
    let before = off(&sums);
    let mut worst = f64::INFINITY;
    for _ in 0..ROUNDS {
        let pairs = || sums.iter().zip(&targets).filter(|(sum, target)| **sum > 0.0 && **target > 0.0);
        let off = pairs().fold(0.0_f64, |most, (sum, target)| most.max((sum / target - 1.0).abs()));
        if off <= NEAR || off > SLOW * worst {
            break;
        }
        worst = off;
        for ((scale, sum), target) in transport.scale.iter_mut().zip(&sums).zip(&targets) {
            if *sum > 0.0 && *target > 0.0 {
                *scale = (*scale * (target / sum).sqrt()).clamp(1.0 / MOST_SCALE, MOST_SCALE);
            }
        }
        sums = transport.row_sums(buffer);
    }
    let total: f64 = transport.areas.iter().sum();
    let area: f64 = transport.areas.iter().zip(&closed).map(|(a, closed)| if *closed { *a } else { 0.0 }).sum();
    Balance { closed: area / total, before, after: off(&sums), largest: sums.iter().fold(0.0, |m, s| s.max(m)) }
}

/// Roots, and after them clusters, that light goes between. Links of a cluster are those of all of its members.
fn connected(patches: &Patches, links: &[Link], roots: &[usize]) -> Groups {
    let place =
        |number: u32| cluster::index(number).map_or_else(|| roots[number as usize], |cluster| patches.roots + cluster);
    let mut groups = Groups::new(patches.roots + patches.clusters.len());
    let mut is_linked = vec![false; patches.clusters.len()];
    for link in links.iter().filter(|link| link.seen > 0.0) {
        groups.join(place(link.p), place(link.q));
        [link.p, link.q].into_iter().filter_map(cluster::index).for_each(|cluster| is_linked[cluster] = true);
    }
    for (index, cluster) in patches.clusters.iter().enumerate() {
        if is_linked[index] {
            for child in cluster.children {
                groups.join(patches.roots + index, place(child));
                cluster::index(child).into_iter().for_each(|child| is_linked[child] = true);
            }
        }
    }
    groups
}

/// What the form factors of each leaf add up to: 1 in closed spaces; elsewhere the sum of its own factors to all that it and the groups it is in
/// are linked to, where links have those of the groups.
fn targets(patches: &Patches, links: &[Link], transport: &Transport, closed: &[bool]) -> Vec<f64> {
    if closed.iter().all(|closed| *closed) {
        return vec![1.0; closed.len()];
    }
    let mut parents = vec![LEAF; patches.nodes.len()];
    for (parent, node) in (0..).zip(&patches.nodes) {
        node.children().into_iter().flatten().for_each(|child| parents[child] = parent);
    }
    let mut of_node = vec![Vec::new(); patches.nodes.len()];
    for link in links.iter().filter(|link| link.seen > 0.0) {
        of_node[link.p as usize].push((link.q, link));
        of_node[link.q as usize].push((link.p, link));
    }
    let target = |(leaf, closed): (&u32, &bool)| {
        if *closed {
            return 1.0;
        }
        let own = &patches.nodes[*leaf as usize].polygon;
        let (mut sum, mut node) = (0.0, *leaf);
        while node != LEAF {
            for (other, link) in &of_node[node as usize] {
                let direct = if node == *leaf {
                    link.exchange
                } else {
                    exchange(own, &patches.nodes[*other as usize].polygon, patches.slack, TOLERANCE)
                };
                sum += direct * link.seen;
            }
            node = parents[node as usize];
        }
        sum / own.area
    };
    let mut sums: Vec<f64> = transport.leaves.par_iter().zip(closed).map(target).collect();
    share_out(patches, transport, &mut sums);
    sums
}

/// Gives what leaves have above 1 to those near them, unless nothing has room: then it is cut off.
///
/// The visible share of a group's link is right for the group as a whole, nearly: leaves that are given more than there is around them have it from
/// others, which lack it. To cut it off would lose light: 0.14 % of all exchanges in the Cornell box at an accuracy of 0.003. So the excess goes to the
/// smallest group around a leaf whose open shares 1 − ΣF are enough, and these shrink by the same factor: ΣAF stays what it was, and no sum is
/// above 1. What sees nothing has no room.
fn share_out(patches: &Patches, transport: &Transport, sums: &mut [f64]) {
    let nodes = patches.nodes.len();
    let mut leaf_of = vec![None; nodes];
    transport.leaves.iter().enumerate().for_each(|(leaf, node)| leaf_of[*node as usize] = Some(leaf));
    // For each node, what is in excess and what is open, times area; and what is left of the open shares below.
    let (mut flux, mut left) = (vec![[0.0_f64; 2]; nodes], vec![1.0; nodes]);
    let mut all = [0.0_f64; 2];
    for node in (0..nodes).rev() {
        let [mut excess, mut open] = match (leaf_of[node], patches.nodes[node].children()) {
            (Some(leaf), _) => {
                let off = transport.areas[leaf] * (sums[leaf] - 1.0);
                sums[leaf] = sums[leaf].min(1.0);
                [off.max(0.0), if sums[leaf] > 0.0 { (-off).max(0.0) } else { 0.0 }]
            }
            (None, Some([a, b])) => [flux[a][0] + flux[b][0], flux[a][1] + flux[b][1]],
            (None, None) => [0.0; 2],
        };
        if excess > 0.0 && excess <= MOST_FILLED * open {
            left[node] = 1.0 - excess / open;
            (excess, open) = (0.0, open - excess);
        }
        flux[node] = [excess, open];
        if node < patches.roots {
            all = [all[0] + excess, all[1] + open];
        }
    }
    let of_all = if all[1] > 0.0 { 1.0 - (all[0] / all[1]).min(1.0) } else { 1.0 };
    left[..patches.roots].iter_mut().for_each(|left| *left *= of_all);
    for (index, node) in patches.nodes.iter().enumerate() {
        node.children().into_iter().flatten().for_each(|child| left[child] *= left[index]);
    }
    for (sum, node) in sums.iter_mut().zip(&transport.leaves) {
        if *sum > 0.0 {
            *sum += (1.0 - *sum) * (1.0 - left[*node as usize]);
        }
    }
}

/// The root of each node.
fn roots(patches: &Patches) -> Vec<usize> {
    let mut roots: Vec<usize> = (0..patches.nodes.len()).collect();
    for (index, node) in patches.nodes.iter().enumerate() {
        for child in node.children().into_iter().flatten() {
            roots[child] = roots[index];
        }
    }
    roots
}

/// The share of rays from each leaf that meet a patch's front.
fn filled(patches: &Patches, leaves: &[u32]) -> Vec<f64> {
    let mut is_patch = vec![[false; 2]; patches.blockers.len()];
    for node in &patches.nodes[..patches.roots] {
        let primitive = node.primitive as usize;
        let front = node.polygon.normal.dot(patches.blockers[primitive].normal) > 0.0;
        is_patch[primitive][usize::from(front)] = true;
    }
    let least = if patches.clusters.is_empty() { FEW_RAYS } else { MANY_RAYS };
    let rays = u32::try_from(RAYS / leaves.len().max(1)).unwrap_or(0).max(least);
    let filled = |leaf: &u32| {
        let node = &patches.nodes[*leaf as usize];
        let normal = node.polygon.normal.as_vec3a();
        let (u, v) = normal.any_orthonormal_pair();
        let meets = |index: &u32| {
            #[allow(clippy::cast_possible_truncation, reason = "rays are traced in f32")]
            let [a, b, c, d] = spread(index.wrapping_add(leaf.wrapping_mul(rays)) & 0xf_ffff);
            let way: Vec3A = square_to_cosine_hemisphere([single(c), single(d)]);
            let from = surface_point(node.polygon.point([a, b]), node.polygon.normal, node.primitive);
            let hit = patches.world.closest_hit(&from.ray(u * way.x + v * way.y + normal * way.z));
            hit.is_some_and(|hit| is_patch[patches.face[hit.primitive as usize] as usize][usize::from(hit.front)])
        };
        let met = u32::try_from((0..rays).filter(meets).count()).unwrap_or(rays);
        f64::from(met) / f64::from(rays)
    };
    leaves.par_iter().map(filled).collect()
}

#[allow(clippy::cast_possible_truncation, reason = "rays are traced in f32")]
fn single(x: f64) -> f32 {
    x as f32
}

/// Disjoint sets.
struct Groups {
    parents: Vec<usize>,
}

impl Groups {
    fn new(count: usize) -> Self {
        Self { parents: (0..count).collect() }
    }

    fn find(&mut self, mut item: usize) -> usize {
        while self.parents[item] != item {
            self.parents[item] = self.parents[self.parents[item]];
            item = self.parents[item];
        }
        item
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.find(a), self.find(b));
        self.parents[a.max(b)] = a.min(b);
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests fail by panicking")]
mod tests {
    use super::*;
    use crate::radiosity::view::Between;
    use crate::radiosity::{Radiosity, Settings};
    use crate::scene::builtin;
    use crate::spectral::Palette;

    fn cornell_box() -> Radiosity {
        let scene = builtin::load("cornell-box", &[]).unwrap();
        let settings = Settings { accuracy: 1e-2, points: false, ..Settings::default() };
        Radiosity::new(&scene, &settings, &mut Palette::default(), &|_| {}).unwrap()
    }

    fn total(radiosity: &Radiosity, sums: &[f64]) -> f64 {
        sums.iter().zip(&radiosity.transport.areas).map(|(sum, area)| sum * area).sum()
    }

    /// Some leaves have more than there is, and that goes to the nearest that have less: nothing is lost, and what is far from them stays as it is.
    #[test]
    fn excess_stays_near_where_it_is_found() {
        let radiosity = cornell_box();
        let (patches, transport) = (&radiosity.patches, &radiosity.transport);
        let parent = (patches.roots..patches.nodes.len()).find_map(|node| {
            let children = patches.nodes[node].children()?;
            let leaf = |child: usize| transport.leaves.iter().position(|leaf| *leaf as usize == child);
            Some([leaf(children[0])?, leaf(children[1])?])
        });
        let [one, other] = parent.unwrap();
        let (areas, mut sums) = (&transport.areas, vec![0.8; transport.leaves.len()]);
        sums[one] = 1.0 + 0.05 * areas[other] / areas[one];
        let before = total(&radiosity, &sums);
        share_out(patches, transport, &mut sums);
        assert!(
            (sums[one] - 1.0).abs() <= 1e-15 && (sums[other] - 0.85).abs() <= 1e-12,
            "{} {}",
            sums[one],
            sums[other]
        );
        assert!(sums.iter().enumerate().all(|(leaf, sum)| [one, other].contains(&leaf) || *sum == 0.8));
        // So much that the sibling has no room for it.
        sums[one] = 1.0 + 0.3 * areas[other] / areas[one];
        sums[other] = 0.8;
        let more = total(&radiosity, &sums);
        share_out(patches, transport, &mut sums);
        assert!(sums.iter().all(|sum| *sum <= 1.0) && sums[other] > 0.8 && sums[other] <= 0.9 + 1e-12);
        let after = total(&radiosity, &sums);
        assert!(more > before && (after - more).abs() <= 1e-12 * more, "{before} {more} {after}");
    }

    /// Where nothing has room, nothing is above 1.
    #[test]
    fn no_sum_is_above_one() {
        let radiosity = cornell_box();
        let mut sums = vec![1.01; radiosity.transport.leaves.len()];
        sums[0] = 0.99;
        share_out(&radiosity.patches, &radiosity.transport, &mut sums);
        assert!(sums.iter().all(|sum| (sum - 1.0).abs() <= 1e-15), "{sums:?}");
    }

    /// Leaves that see nothing have no room for others' excess, and where there is none even the smallest sums stay what they are.
    #[test]
    fn what_sees_nothing_gets_nothing_and_small_sums_stay() {
        let radiosity = cornell_box();
        let (patches, transport) = (&radiosity.patches, &radiosity.transport);
        let mut sums = vec![0.0_f64; transport.leaves.len()];
        sums[1] = 1e-12;
        let before = sums.clone();
        share_out(patches, transport, &mut sums);
        assert!(sums.iter().zip(&before).all(|(after, before)| after.to_bits() == before.to_bits()), "{sums:?}");
        sums.fill(0.5);
        (sums[0], sums[1]) = (1.1, 0.0);
        let before = total(&radiosity, &sums);
        share_out(patches, transport, &mut sums);
        let after = total(&radiosity, &sums);
        assert!((after - before).abs() <= 1e-12 * before && sums[1] == 0.0, "{before} {after} {}", sums[1]);
        assert!(sums.iter().all(|sum| *sum <= 1.0));
    }

    /// What is seen of a patch is no more than the patch, but for rounding: shares of links need not be cut for more than that.
    #[test]
    fn what_is_seen_is_no_more_than_there_is() {
        let patches = &cornell_box().patches;
        let (mut pairs, mut partly) = (0, 0);
        for p in (0..patches.nodes.len()).step_by(7) {
            for q in (0..patches.nodes.len()).step_by(11) {
                let [a, b] = [p, q].map(|n| &patches.nodes[n]);
                if !(exchange(&a.polygon, &b.polygon, patches.slack, TOLERANCE) > 0.0) {
                    continue;
                }
                let between = patches.between(a, b);
                if matches!(between, Between::Blocked) {
                    continue;
                }
                let view = patches.view(a, b, &between);
                pairs += 1;
                partly += u32::from(view.seen < view.open * (1.0 - 1e-9));
                assert!(view.seen <= view.open * (1.0 + 1e-12), "{p} {q}: {} {}", view.seen, view.open);
            }
        }
        assert!(pairs > 1000 && partly > 100, "{pairs} {partly}");
    }
}
