//! Irradiance at any place from many faces: near ones in closed form, all others by rays.
//!
//! To walk all faces takes as long as there are faces, and most of them give next to nothing or are hidden. So they are sampled: a ray costs a walk
//! through the tree of the scene's faces, so that a place costs about as much as the logarithm of their number. Those that are close and give
//! much, by the first rays, are seen in closed form instead. Directions are spread in proportion to the cosine, as points of a sequence of low discrepancy that is shifted by
//! another amount at each place (R. Cranley & T. Patterson, SIAM J. Numer. Anal. 13, 1976); the means of eight parts of the sequence tell the error,
//! about. Where the most rays are too few for what was asked for, all faces are seen in closed form.

use glam::DVec3;

use super::Solution;
use super::gather::{Entry, Look, Place};
use super::mesh::{LEAF, Patches};
use super::rays::{line, nearest};
use crate::geometry::Hit;
use crate::geometry::glam::Vec3A;
use crate::geometry::sampling::square_to_cosine_hemisphere;

/// Faces that give more than this share of the light are seen in closed form, if they are nearer than this share of their radius.
const NEAR: f64 = 0.03;
const CLOSE: f64 = 0.25;
/// Light below this share of what a place in the scene's mean light receives counts as this share.
const DARK: f64 = 0.01;
/// The first rays tell which faces are near and how much light there is; then there are ever more.
const PILOT: usize = 256;
const LEAST_RAYS: usize = 512;
const MOST_RAYS: usize = 1 << 16;
/// Parts of the sequence that tell its error.
const PARTS: usize = 8;
/// Steps of a sequence in two dimensions without clusters: 1/g and 1/g², g³ = g + 1.
const STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_3];

/// The leaves that rays hit.
#[derive(Clone, Debug, Default)]
pub(super) struct HitLeaves {
    /// For the back and the front of each primitive, where its roots begin; one more at the end. None where faces are few.
    starts: Vec<u32>,
    roots: Vec<u32>,
}

impl HitLeaves {
    pub(super) fn new(patches: &Patches) -> Self {
        if patches.clusters.is_empty() {
            return Self::default();
        }
        let place = |root: u32| {
            let node = &patches.nodes[root as usize];
            let front = patches.blockers[node.primitive as usize].normal.dot(node.polygon.normal) > 0.0;
            2 * node.primitive as usize + usize::from(front)
        };
        let mut roots: Vec<u32> = (0..).take(patches.roots).collect();
        roots.sort_by_key(|root| place(*root));
        let mut starts = vec![0; 2 * patches.blockers.len() + 1];
        roots.iter().for_each(|root| starts[place(*root) + 1] += 1);
        for index in 1..starts.len() {
            starts[index] += starts[index - 1];
        }
        Self { starts, roots }
    }

    /// The root and the leaf that were hit.
    fn find(&self, patches: &Patches, hit: &Hit) -> Option<[u32; 2]> {
        let place = 2 * *patches.face.get(hit.primitive as usize)? as usize + usize::from(hit.front);
        let roots = self.roots.get(*self.starts.get(place)? as usize..*self.starts.get(place + 1)? as usize)?;
        let position = hit.position.as_dvec3();
        let root = match roots {
            [] => return None,
            [root] => *root,
            _ => nearest(patches, roots, position)?,
        };
        let mut node = root;
        loop {
            let child = patches.nodes[node as usize].child;
            if child == LEAF {
                return Some([root, node]);
            }
            let [a, b, c, d] = line(&patches.nodes[child as usize].polygon);
            let above = a * position.x + b * position.y + c * position.z + d > 0.0;
            node = child + u32::from(above);
        }
    }
}

/// Rays from a place.
struct Sample<'p> {
    place: &'p Place<'p>,
    leaves: &'p HitLeaves,
    axes: [Vec3A; 3],
    shift: [f64; 2],
    /// The place in the sequence of the first of these.
    first: usize,
    /// The root and the leaf that each ray hit, if any.
    hits: Vec<Option<[u32; 2]>>,
}

impl<'p> Sample<'p> {
    fn new(place: &'p Place<'p>, leaves: &'p HitLeaves) -> Self {
        let normal = place.normal.as_vec3a();
        let (u, v) = normal.any_orthonormal_pair();
        Self { place, leaves, axes: [u, v, normal], shift: shift(place.position), first: 0, hits: Vec::new() }
    }

    /// Leaves the rays so far to others.
    fn restart(&mut self) {
        self.first += self.hits.len();
        self.hits.clear();
    }

    /// Goes on to so many rays.
    fn trace(&mut self, count: usize) {
        for index in self.first + self.hits.len()..self.first + count {
            #[allow(clippy::cast_precision_loss, reason = "counts of rays")]
            let at = |axis: usize| (self.shift[axis] + STEPS[axis] * (index + 1) as f64).fract();
            #[allow(clippy::cast_possible_truncation, reason = "rays are traced in f32")]
            let way = square_to_cosine_hemisphere([at(0) as f32, at(1) as f32]);
            let [u, v, normal] = self.axes;
            let patches = self.place.patches;
            let hit = patches.world.closest_hit(&self.place.point.ray(u * way.x + v * way.y + normal * way.z));
            self.hits.push(hit.and_then(|hit| self.leaves.find(patches, &hit)));
        }
    }

    /// The mean of a value over all rays, and its standard error, estimated from eight parts of the rays.
    fn mean(&self, value: impl Fn([u32; 2]) -> f64) -> [f64; 2] {
        let parts = self.hits.chunks(self.hits.len().div_ceil(PARTS).max(1));
        #[allow(clippy::cast_precision_loss, reason = "counts of rays")]
        let of_part =
            |part: &[Option<[u32; 2]>]| part.iter().flatten().map(|hit| value(*hit)).sum::<f64>() / part.len() as f64;
        let means: Vec<f64> = parts.map(of_part).collect();
        #[allow(clippy::cast_precision_loss, reason = "a small constant")]
        let count = PARTS as f64;
        let mean = means.iter().sum::<f64>() / count;
        let squares = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>();
        [mean, (squares / (count * (count - 1.0))).sqrt()]
    }

    /// What the rays hit, but for some roots in order.
    fn entries(&self, without: &[u32]) -> impl Iterator<Item = Entry> + use<> {
        let other = |[root, leaf]: &[u32; 2]| without.binary_search(root).is_err().then_some(*leaf);
        let mut leaves: Vec<u32> = self.hits.iter().flatten().filter_map(other).collect();
        leaves.sort_unstable();
        #[allow(clippy::cast_precision_loss, reason = "counts of rays")]
        let share = |same: &[u32], all: usize| same.len() as f64 / all as f64;
        let all = self.hits.len();
        let entries: Vec<Entry> =
            leaves.chunk_by(|a, b| a == b).map(|same| Entry::Node(same[0], share(same, all))).collect();
        entries.into_iter()
    }
}

/// Two numbers in [0, 1) that have nothing to do with each other, nor with those of other places.
fn shift(position: DVec3) -> [f64; 2] {
    // The finaliser of SplitMix64 (S. Vigna).
    let mix = |mut bits: u64| {
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^ (bits >> 31)
    };
    // Adding 0 makes −0 the same place as 0.
    let all = position.to_array().iter().fold(0x9e37_79b9_7f4a_7c15, |all: u64, x| mix(all ^ (x + 0.0).to_bits()));
    [all >> 32, all & 0xffff_ffff].map(|half| f64::from(u32::try_from(half).unwrap_or(0)) / 4_294_967_296.0)
}

impl Solution<'_> {
    /// Where the light at a place comes from if faces are many.
    pub(super) fn look_far(&self, place: &Place<'_>, share: f64, tolerance: f64) -> Vec<Entry> {
        let mut rays = Sample::new(place, &self.radiosity.hit);
        rays.trace(PILOT);
        let level = |[_, leaf]: [u32; 2]| self.levels[leaf as usize];
        let whole = rays.mean(level)[0].max(DARK);
        let look = self.at_first(place, share, whole);
        if !(tolerance > 0.0) {
            return self.walk(&look);
        }
        let mut list = Vec::new();
        let near = self.near(&rays, NEAR * whole);
        near.iter().for_each(|root| self.add(&look, *root as usize, None, &mut list));
        // Others than those that told what is near, or what few of them hit by chance would be missing.
        rays.restart();
        let others = |hit: [u32; 2]| if near.binary_search(&hit[0]).is_ok() { 0.0 } else { level(hit) };
        let mut count = LEAST_RAYS;
        loop {
            rays.trace(count);
            if rays.mean(others)[1] <= tolerance * whole {
                break;
            }
            if count >= MOST_RAYS {
                return self.walk(&look);
            }
            count *= 2;
        }
        list.extend(rays.entries(&near));
        list
    }

    /// What all faces give in closed form.
    fn walk(&self, look: &Look<'_>) -> Vec<Entry> {
        let mut list = Vec::new();
        (0..look.place.patches.roots).for_each(|root| self.add(look, root, None, &mut list));
        list
    }

    /// The roots, in order, that are close and from which at least so much comes, by some rays.
    fn near(&self, rays: &Sample<'_>, least: f64) -> Vec<u32> {
        let mut hits: Vec<[u32; 2]> = rays.hits.iter().flatten().copied().collect();
        hits.sort_unstable();
        #[allow(clippy::cast_precision_loss, reason = "counts of rays")]
        let gives = |same: &[[u32; 2]]| {
            same.iter().map(|[_, leaf]| self.levels[*leaf as usize]).sum::<f64>() / rays.hits.len() as f64
        };
        let of_root = hits.chunk_by(|a, b| a[0] == b[0]);
        let is_close = |root: u32| {
            let polygon = &rays.place.patches.nodes[root as usize].polygon;
            polygon.distance(rays.place.position) <= CLOSE * polygon.radius
        };
        of_root.filter(|same| gives(same) >= least && is_close(same[0][0])).map(|same| same[0][0]).collect()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests fail by panicking")]
mod tests {
    use core::fmt::Write as _;

    use super::{Entry, Place};
    use crate::geometry::{Hit, Ray};
    use crate::radiosity::{Flat, Radiosity, Settings, Solution};
    use crate::scene::{Source, load};
    use crate::spectral::Palette;
    use disk_sampling::Receiver;

    const SQUARES: u32 = 20;

    /// A closed room of 4 with a lamp under its ceiling, and hills of 800 triangles on its floor.
    fn hills() -> Radiosity {
        let grey = |rho| format!("<bsdf type='diffuse'><spectrum name='reflectance' value='{rho}'/></bsdf>");
        let xml = format!(
            "<scene version='3.0.0'><sensor type='perspective'><float name='fov' value='40'/></sensor>
            <shape type='cube'><transform name='to_world'><scale value='2'/></transform>
            <boolean name='flip_normals' value='true'/>{}</shape>
            <shape type='rectangle'><transform name='to_world'><scale value='0.5'/><rotate x='1' angle='180'/>
            <translate z='1.9'/></transform><emitter type='area'><spectrum name='radiance' value='10'/></emitter></shape>
            <shape type='obj'><string name='filename' value='hills.obj'/>{}</shape></scene>",
            grey(0.7),
            grey(0.4)
        );
        let mut mesh = String::new();
        let at = |i: u32| 4.0 * f64::from(i) / f64::from(SQUARES) - 2.0;
        for (x, y) in (0..=SQUARES).flat_map(|i| (0..=SQUARES).map(move |j| (at(i), at(j)))) {
            writeln!(mesh, "v {x} {y} {}", 0.4 * (3.0 * x).sin() * (4.0 * y + x).cos() - 1.5).unwrap();
        }
        let row = SQUARES + 1;
        for corner in (0..SQUARES).flat_map(|i| (0..SQUARES).map(move |j| i * row + j + 1)) {
            let [a, b, c, d] = [corner, corner + row, corner + row + 1, corner + 1];
            writeln!(mesh, "f {a} {b} {c}\nf {a} {c} {d}").unwrap();
        }
        let scene = load(&Source::text("hills.xml", xml).with_asset("hills.obj", mesh), &[]).unwrap();
        let settings = Settings { accuracy: 3e-2, points: false, ..Settings::default() };
        let radiosity = Radiosity::new(&scene, &settings, &mut Palette::default(), &|_| {}).unwrap();
        assert!(!radiosity.patches.clusters.is_empty());
        radiosity
    }

    /// On a wall and in the air above the hills.
    fn places() -> Vec<Receiver<f64>> {
        let part = |index: u32, step: f64| (0.5 + step * f64::from(index)).fract();
        let place = |index: u32| {
            let (a, b) = (3.6 * part(index, 0.7549) - 1.8, 2.6 * part(index, 0.5698) - 0.9);
            let [position, normal] = if index.is_multiple_of(2) {
                [[-2.0, a, b], [1.0, 0.0, 0.0]]
            } else {
                [[a, b, -0.8], [0.6, 0.0, -0.8]]
            };
            Receiver::new(position, normal).unwrap()
        };
        (0..16).map(place).collect()
    }

    /// How far light at places is from that of a walk through all faces: root mean square and largest, as shares.
    fn off(solution: &Solution<'_>, walks: &[f64], tolerance: f64) -> [f64; 2] {
        let found = places().into_iter().map(|place| solution.indirect_within(&place, tolerance)[0]);
        let off: Vec<f64> = found.zip(walks).map(|(found, walk)| (found / walk - 1.0).abs()).collect();
        let count = f64::from(u32::try_from(off.len()).unwrap());
        let mean_square = off.iter().map(|o| o * o).sum::<f64>() / count;
        [mean_square.sqrt(), off.iter().fold(0.0, |m: f64, o| m.max(*o))]
    }

    /// The error is the standard error that was asked for, or less, and none is far out; it falls with the tolerance.
    #[test]
    fn light_of_far_faces_is_within_the_tolerance() {
        let radiosity = hills();
        let solution = radiosity.solve(&Flat).unwrap();
        let walks: Vec<f64> = places().iter().map(|place| solution.indirect_within(place, 0.0)[0]).collect();
        assert!(walks.iter().all(|walk| *walk > 0.0));
        let [coarse, fine] = [1e-2, 1e-3].map(|tolerance| {
            let [mean, most] = off(&solution, &walks, tolerance);
            assert!(mean <= 1.2 * tolerance && most <= 4.0 * tolerance, "{tolerance}: {mean} {most}");
            mean
        });
        assert!(coarse > 3.0 * fine, "{coarse} {fine}");
    }

    /// Where no number of rays is enough, the light is that of the walk.
    #[test]
    fn what_rays_cannot_reach_is_walked() {
        let radiosity = hills();
        let solution = radiosity.solve(&Flat).unwrap();
        for place in places().iter().take(4) {
            let [walk, strict] = [0.0, 1e-12].map(|tolerance| solution.indirect_within(place, tolerance)[0]);
            assert_eq!(walk.to_bits(), strict.to_bits(), "{walk} {strict}");
        }
    }

    /// A ray to the middle of a leaf finds that leaf and its root; on the other side of a face that has one side, nothing.
    #[test]
    fn rays_find_the_leaves_they_hit() {
        let radiosity = hills();
        let patches = &radiosity.patches;
        let mut roots: Vec<usize> = (0..patches.nodes.len()).collect();
        for (index, node) in patches.nodes.iter().enumerate() {
            node.children().into_iter().flatten().for_each(|child| roots[child] = roots[index]);
        }
        let (mut leaves, mut found, mut one_sided) = (0, 0, 0);
        for leaf in patches.leaves() {
            leaves += 1;
            let node = &patches.nodes[leaf];
            let (polygon, normal) = (&node.polygon, node.polygon.normal);
            let from = polygon.centre + normal * (1e-2 * polygon.radius);
            let hit = patches.world.closest_hit(&Ray::new(from.as_vec3a(), (-normal).as_vec3a()));
            // Another face may be in between.
            let Some(hit) = hit.filter(|hit| patches.face[hit.primitive as usize] == node.primitive) else { continue };
            found += 1;
            let known = [roots[leaf], leaf].map(|number| u32::try_from(number).unwrap());
            assert_eq!(radiosity.hit.find(patches, &hit), Some(known));
            let same_face = patches.nodes[..patches.roots].iter().filter(|root| root.primitive == node.primitive);
            if same_face.map(|root| root.polygon.normal.dot(normal)).all(|cosine| cosine > 0.0) {
                one_sided += 1;
                assert_eq!(radiosity.hit.find(patches, &Hit { front: !hit.front, ..hit }), None);
            }
        }
        assert!(leaves > 800 && 10 * found >= 9 * leaves && one_sided > 0, "{leaves} {found} {one_sided}");
    }

    /// In a closed room the factors of all that is seen add up to 1: no face is counted twice or left out.
    #[test]
    fn faces_fill_the_hemisphere() {
        let radiosity = hills();
        let solution = radiosity.solve(&Flat).unwrap();
        for receiver in places() {
            let place = Place::new(&radiosity.patches, &receiver);
            let sum = |tolerance: f64| -> f64 {
                let list = solution.look(&place, 0.01, tolerance);
                list.iter()
                    .map(|entry| match entry {
                        Entry::Node(_, f) | Entry::Point(_, f) => *f,
                    })
                    .sum()
            };
            let [walk, by_rays] = [0.0, 3e-3].map(sum);
            assert!((walk - 1.0).abs() <= 2e-3 && (by_rays - 1.0).abs() <= 1e-2, "{walk} {by_rays}");
        }
    }
}
