//! Clusters: groups of faces near each other that look in similar directions, so that far ones exchange light as one (B. Smits, J. Arvo &
//! D. Greenberg, "A clustering algorithm for radiosity in complex environments", SIGGRAPH 1994; A. Willmott, P. Heckbert & M. Garland,
//! "Face cluster radiosity", Eurographics Workshop on Rendering 1999).
//!
//! Where faces are few, all are linked to all and there are no clusters.

use glam::DVec3;

use super::mesh::{Node, Side};
use super::sight::spread;

/// Numbers from here on are those of clusters, smaller ones those of patches.
pub(super) const FIRST: u32 = 1 << 31;
/// As many faces are linked all to all.
pub(super) const FEW_FACES: usize = 512;
/// Points that stand for a cluster.
pub(super) const POINTS: usize = 8;
/// Differences of unit normals count as this share of a cluster's size.
const TURN: f64 = 0.7;
/// Faces wider than this share of what they are among are set apart.
const LARGE: f64 = 0.4;
/// Halves have at least this share of the faces, or as many as each other.
const LEAST_SHARE: f64 = 1.0 / 32.0;

/// The number of a cluster among clusters, if it is that of one.
pub(super) const fn index(id: u32) -> Option<usize> {
    if id >= FIRST { Some((id - FIRST) as usize) } else { None }
}

/// A point of a face of a cluster.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    pub(super) position: DVec3,
    pub(super) normal: DVec3,
    pub(super) primitive: u32,
}

/// A group of two or more faces.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cluster {
    /// Numbers of clusters or of roots.
    pub(super) children: [u32; 2],
    pub(super) area: f64,
    /// Of a sphere around all of it.
    pub(super) centre: DVec3,
    pub(super) radius: f64,
    /// All normals are within an angle of this unit vector, in rad.
    pub(super) axis: DVec3,
    pub(super) angle: f64,
    /// Evenly spread over the area.
    pub(super) samples: [Sample; POINTS],
}

/// All clusters, parents before their children; the first is everything.
pub(super) fn clusters(roots: &[Node], sides: &[Side]) -> Vec<Cluster> {
    if roots.len() <= FEW_FACES {
        return Vec::new();
    }
    let mut builder = Builder { roots, sides, clusters: Vec::with_capacity(roots.len() - 1) };
    let mut members: Vec<u32> = (0..).take(roots.len()).collect();
    builder.add(&mut members);
    builder.clusters
}

struct Builder<'r> {
    roots: &'r [Node],
    sides: &'r [Side],
    clusters: Vec<Cluster>,
}

impl Builder<'_> {
    fn root(&self, number: u32) -> &Node {
        &self.roots[number as usize]
    }

    /// The number of the cluster of these roots, or of the root if there is one alone.
    fn add(&mut self, members: &mut [u32]) -> u32 {
        if let [single] = members {
            return *single;
        }
        let place = self.clusters.len();
        let number = FIRST + u32::try_from(place).unwrap_or(0);
        let cut = self.halve(members);
        let cluster = self.cluster(members, number);
        self.clusters.push(cluster);
        let (one, other) = members.split_at_mut(cut);
        let children = [self.add(one), self.add(other)];
        self.clusters[place].children = children;
        // Only now are the members in the order of the tree, in which neighbours are near each other.
        self.clusters[place].samples = self.samples(members, self.clusters[place].area, number);
        number
    }

    /// Bounds of the members, without children.
    fn cluster(&self, members: &[u32], number: u32) -> Cluster {
        let nodes = || members.iter().map(|m| &self.root(*m).polygon);
        let area: f64 = nodes().map(|p| p.area).sum();
        let (low, high) = nodes()
            .flat_map(|p| p.corners().iter())
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), corner| (low.min(*corner), high.max(*corner)));
        let centre = (low + high) / 2.0;
        let furthest = nodes().flat_map(|p| p.corners().iter()).map(|c| c.distance_squared(centre));
        let radius = furthest.fold(0.0, f64::max).sqrt();
        let axis = nodes().map(|p| p.normal * p.area).sum::<DVec3>().normalize_or_zero();
        let least = nodes().map(|p| p.normal.dot(axis)).fold(1.0, f64::min);
        let angle = if axis == DVec3::ZERO { core::f64::consts::PI } else { least.clamp(-1.0, 1.0).acos() };
        let samples = [Sample { position: centre, normal: axis, primitive: 0 }; POINTS];
        Cluster { children: [number; 2], area, centre, radius, axis, angle, samples }
    }

    /// Orders members so that the two halves follow each other, and returns where the second begins: in between.
    fn halve(&self, members: &mut [u32]) -> usize {
        let shines = |m: &u32| self.sides[self.root(*m).side as usize].emission.is_some();
        if let Some(cut) = partition(members, |m| !shines(m)) {
            return cut;
        }
        let nodes = || members.iter().map(|m| &self.root(*m).polygon);
        let range = |values: &dyn Fn(&Node) -> DVec3| {
            members
                .iter()
                .map(|m| values(self.root(*m)))
                .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
        };
        let (low, high) = range(&|node| node.polygon.centre);
        let (low_normal, high_normal) = range(&|node| node.polygon.normal);
        let largest = nodes().fold(0.0_f64, |most, p| most.max(p.radius));
        let reach = 0.5 * (high - low).length() + largest;
        if largest > LARGE * reach
            && let Some(cut) = partition(members, |m| self.root(*m).polygon.radius > 0.5 * largest)
        {
            return cut;
        }
        let (size, turn) = (high - low, (high_normal - low_normal) * (TURN * (high - low).length()));
        let extents = [size.x, size.y, size.z, turn.x, turn.y, turn.z];
        let widest = (1..6).fold(0, |best, i| if extents[i] > extents[best] { i } else { best });
        let value = |m: u32| {
            let polygon = &self.root(m).polygon;
            [polygon.centre, polygon.normal][widest / 3][widest % 3]
        };
        let middle = [(low + high) / 2.0, (low_normal + high_normal) / 2.0][widest / 3][widest % 3];
        let below = members.iter().filter(|m| value(**m) < middle).count();
        #[allow(clippy::cast_precision_loss, reason = "counts of faces")]
        let share = below.min(members.len() - below) as f64 / members.len() as f64;
        if share >= LEAST_SHARE
            && let Some(cut) = partition(members, |m| value(*m) < middle)
        {
            return cut;
        }
        let half = members.len() / 2;
        members.select_nth_unstable_by(half, |a, b| value(*a).total_cmp(&value(*b)).then(a.cmp(b)));
        half
    }

    /// Points on the members, evenly spread over their area.
    fn samples(&self, members: &[u32], area: f64, number: u32) -> [Sample; POINTS] {
        let mut samples = [Sample { position: DVec3::ZERO, normal: DVec3::ZERO, primitive: 0 }; POINTS];
        let first = number.wrapping_mul(0x9e37_79b1) >> 12;
        let (mut rest, mut member) = (0.0, 0);
        for (k, sample) in (0_u32..).zip(&mut samples) {
            let [u, v, w, _] = spread(first + k);
            #[allow(clippy::cast_precision_loss, reason = "few points")]
            let goal = (f64::from(k) + w) / POINTS as f64 * area;
            while member + 1 < members.len() && rest + self.root(members[member]).polygon.area < goal {
                rest += self.root(members[member]).polygon.area;
                member += 1;
            }
            let node = self.root(members[member]);
            *sample =
                Sample { position: node.polygon.point([u, v]), normal: node.polygon.normal, primitive: node.primitive };
        }
        samples
    }
}

/// Puts first what fulfils a condition, each part in the order it had; `None` if one part is empty.
fn partition(members: &mut [u32], first: impl Fn(&u32) -> bool) -> Option<usize> {
    let (mut one, other): (Vec<u32>, Vec<u32>) = members.iter().partition(|m| first(m));
    let cut = one.len();
    if one.is_empty() || other.is_empty() {
        return None;
    }
    one.extend(other);
    members.copy_from_slice(&one);
    Some(cut)
}

#[cfg(test)]
mod tests {
    use core::fmt::Write as _;

    use super::*;
    use crate::radiosity::mesh::Patches;
    use crate::radiosity::source::Source;
    use crate::radiosity::{Flat, Others, Radiosity, Settings};
    use crate::scene::{self, Scene, load};
    use crate::spectral::Palette;

    /// A closed room of 4 with a lamp in it and boxes of all positions and turns.
    fn room(boxes: u32) -> Scene {
        let side = (1..).find(|side: &u32| side.pow(3) >= boxes).unwrap();
        let cell = 3.4 / f64::from(side);
        let grey = |rho: f64| format!("<bsdf type='diffuse'><spectrum name='reflectance' value='{rho}'/></bsdf>");
        let mut xml = format!(
            "<scene version='3.0.0'><sensor type='perspective'><float name='fov' value='40'/></sensor>
            <shape type='cube'><transform name='to_world'><scale value='2'/></transform>
            <boolean name='flip_normals' value='true'/>{}</shape>
            <shape type='cube'><transform name='to_world'><scale x='0.5' y='0.5' z='0.02'/><translate z='1.9'/></transform>
            <emitter type='area'><spectrum name='radiance' value='10'/></emitter></shape>",
            grey(0.7)
        );
        for index in 0..boxes {
            let at = [index % side, index / side % side, index / side / side];
            let [x, y, z] = at.map(|i| (f64::from(i) + 0.5) * cell - 1.7);
            let (half, turn, axis) = (0.2 * cell, f64::from(index) * 137.5, (f64::from(index) * 0.618).fract());
            write!(
                xml,
                "<shape type='cube'><transform name='to_world'><scale value='{half}'/>
                <rotate x='1' y='{axis}' z='0.5' angle='{turn}'/><translate x='{x}' y='{y}' z='{z}'/></transform>{}</shape>",
                grey(if index % 3 == 0 { 0.8 } else { 0.3 })
            )
            .unwrap();
        }
        load(&scene::Source::text("room.xml", xml + "</scene>"), &[]).unwrap()
    }

    const BOXES: u32 = 90;
    const ACCURACY: f64 = 1e-2;

    /// Radiosity and area of each root, and how many links there are.
    fn radiosities(scene: &Scene, with_clusters: bool) -> (Vec<[f64; 2]>, usize) {
        let mut palette = Palette::default();
        let mut patches = Patches::new(scene, Others::Refused, &mut palette).unwrap();
        let sources = Source::all(scene, &mut palette).unwrap();
        assert!(patches.roots > FEW_FACES);
        if !with_clusters {
            patches.clusters.clear();
        }
        let settings = Settings { accuracy: ACCURACY, points: false, ..Settings::default() };
        let radiosity = Radiosity::between(patches, sources, &settings, &palette, &|_| {}).unwrap();
        let solution = radiosity.solve(&Flat).unwrap();
        let report = solution.report();
        assert!(report.closed == 1.0 && report.energy_balance.abs() <= 1e-8, "{report:?}");
        let root = |root: usize| [solution.nodes[root], radiosity.patches.nodes[root].polygon.area];
        ((0..radiosity.patches.roots).map(root).collect(), report.links)
    }

    #[test]
    fn clusters_give_the_light_of_all_pairs() {
        let scene = room(BOXES);
        let ((found, links), (exact, all_links)) = (radiosities(&scene, true), radiosities(&scene, false));
        assert!(links < all_links, "{links} {all_links}");
        let sum =
            |of: &dyn Fn(&[f64; 2], &[f64; 2]) -> f64| found.iter().zip(&exact).map(|(f, e)| of(f, e)).sum::<f64>();
        let all = sum(&|_, [e, area]| e * area);
        let (mean, off) =
            (sum(&|[b, area], [e, _]| (b - e) * area) / all, sum(&|[b, area], [e, _]| (b - e).abs() * area) / all);
        // As far as those are from the truth: means over all faces are as good as asked for, single ones several times worse.
        assert!(mean.abs() <= ACCURACY && off <= 3.0 * ACCURACY, "{mean} {off}");
    }

    #[test]
    fn each_root_is_in_one_cluster_of_each_level() {
        let patches = Patches::new(&room(BOXES), Others::Refused, &mut Palette::default()).unwrap();
        let mut count = vec![0; patches.roots + patches.clusters.len()];
        for (place, cluster) in patches.clusters.iter().enumerate() {
            let areas = cluster.children.map(|child| patches.area(child));
            assert!((areas[0] + areas[1] - cluster.area).abs() <= 1e-12 * cluster.area);
            for child in cluster.children {
                assert!(index(child).is_none_or(|child| child > place));
                count[index(child).map_or(child as usize, |c| patches.roots + c)] += 1;
                let (axis, angle, centre, radius) = match index(child) {
                    Some(c) => {
                        let c = &patches.clusters[c];
                        (c.axis, c.angle, c.centre, 0.0 * c.radius)
                    }
                    None => {
                        let polygon = &patches.nodes[child as usize].polygon;
                        (polygon.normal, 0.0, polygon.centre, polygon.radius)
                    }
                };
                assert!(centre.distance(cluster.centre) <= cluster.radius * (1.0 + 1e-12) + radius);
                assert!(angle > cluster.angle || axis.dot(cluster.axis) >= cluster.angle.cos() - 1e-12);
            }
        }
        assert_eq!(count[patches.roots], 0);
        assert!(count.iter().enumerate().all(|(place, n)| *n == 1 || place == patches.roots));
    }
}
