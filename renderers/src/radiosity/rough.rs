//! Links with clusters: what these exchange is estimated at points on both ends and by rays between them.
//!
//! Such a link is kept only where the light that it puts in the wrong place is little, as told by how uneven it is at the points. The error of
//! the estimate is of the same kind and smaller by the root of the number of points.

use glam::DVec3;

use super::cluster::{self, Cluster, Sample};
use super::link::{AGREED, SMALL};
use super::mesh::{Cut, Node, Patches};
use super::sight::surface_point;
use super::transport::{Link, Spread};
use super::view::{MOST_POINTS, Points, best_cut};

/// Clusters whose radii add up to more than this share of the distance of their centres don't exchange light as a whole.
const NEAR: f64 = 0.8;
/// About how many rays there are for a link.
const RAYS: usize = 16;
/// Room for the points of an end.
const ROOM: usize = if cluster::POINTS > MOST_POINTS { cluster::POINTS } else { MOST_POINTS };

/// What became of a pair.
pub(super) enum Pair {
    /// They don't see each other, for certain.
    Apart,
    /// Too near for one link: this end's parts are to be looked at, the first or the second.
    Near(usize),
    Linked(Link),
}

/// An end of a link.
#[derive(Clone, Copy)]
enum End<'p> {
    Patch(&'p Node),
    Cluster(&'p Cluster),
}

impl End<'_> {
    const fn centre(&self) -> DVec3 {
        match self {
            Self::Patch(node) => node.polygon.centre,
            Self::Cluster(cluster) => cluster.centre,
        }
    }

    const fn radius(&self) -> f64 {
        match self {
            Self::Patch(node) => node.polygon.radius,
            Self::Cluster(cluster) => cluster.radius,
        }
    }

    const fn area(&self) -> f64 {
        match self {
            Self::Patch(node) => node.polygon.area,
            Self::Cluster(cluster) => cluster.area,
        }
    }

    /// Points with weights that add up to 1.
    fn points(&self) -> Sites {
        let mut sites = Sites { all: [(DVec3::ZERO, DVec3::ZERO, 0, 0.0); ROOM], count: 0 };
        let mut push = |position, normal, primitive, weight| {
            sites.all[sites.count] = (position, normal, primitive, weight);
            sites.count += 1;
        };
        match self {
            Self::Patch(node) => {
                Points::on(&node.polygon)
                    .iter()
                    .for_each(|(position, weight)| push(*position, node.polygon.normal, node.primitive, *weight));
            }
            Self::Cluster(cluster) => {
                #[allow(clippy::cast_precision_loss, reason = "few points")]
                let weight = 1.0 / cluster.samples.len() as f64;
                for Sample { position, normal, primitive } in cluster.samples {
                    push(position, normal, primitive, weight);
                }
            }
        }
        sites
    }

    /// Whether none of it looks towards any of another end.
    fn looks_away_from(&self, other: &Self) -> bool {
        let (axis, angle) = match self {
            Self::Patch(node) => (node.polygon.normal, 0.0),
            Self::Cluster(cluster) => (cluster.axis, cluster.angle),
        };
        let way = other.centre() - self.centre();
        let (distance, reach) = (way.length(), self.radius() + other.radius());
        if !(distance > reach) {
            return false;
        }
        let off = (axis.dot(way) / distance).clamp(-1.0, 1.0).acos();
        off - angle - (reach / distance).asin() > core::f64::consts::FRAC_PI_2
    }
}

/// Points: position, normal, primitive and weight.
struct Sites {
    all: [(DVec3, DVec3, u32, f64); ROOM],
    count: usize,
}

impl Sites {
    fn get(&self) -> &[(DVec3, DVec3, u32, f64)] {
        &self.all[..self.count]
    }
}

/// What points of one end see of the other, and the other way round.
struct Sights {
    /// cos cos / (π r²) for each pair of points.
    kernel: [[f64; ROOM]; ROOM],
    /// 1, 0, or NaN where nobody looked.
    seen: [[f64; ROOM]; ROOM],
}

/// What the points of one end see of the other end.
struct RoughView {
    /// Mean configuration factor over the other end's area, as if nothing blocked, and of what is seen.
    open: f64,
    seen: f64,
    /// What is seen from each point, and the mean distance from its mean.
    values: [f64; ROOM],
    varies: f64,
}

impl Sights {
    /// From the first end, or from the other.
    fn view(&self, sites: &[Sites; 2], own: usize) -> RoughView {
        let (from, to) = (sites[own].get(), sites[1 - own].get());
        let at = |rows: &[[f64; ROOM]; ROOM], k: usize, l: usize| if own == 0 { rows[k][l] } else { rows[l][k] };
        let mut view = RoughView { open: 0.0, seen: 0.0, values: [0.0; ROOM], varies: 0.0 };
        // For each point what is open, what of that was looked at, and what of that was seen.
        let mut sums = [[0.0; 3]; ROOM];
        let mut all = [0.0; 2];
        for (k, (_, _, _, weight)) in from.iter().enumerate() {
            for (l, (_, _, _, other)) in to.iter().enumerate() {
                let (kernel, seen) = (other * at(&self.kernel, k, l), at(&self.seen, k, l));
                sums[k][0] += kernel;
                if seen >= 0.0 {
                    sums[k][1] += kernel;
                    sums[k][2] += kernel * seen;
                }
            }
            view.open += weight * sums[k][0];
            all[0] += weight * sums[k][1];
            all[1] += weight * sums[k][2];
        }
        let share = if all[0] > 0.0 { all[1] / all[0] } else { 0.0 };
        for ((value, [open, looked, seen]), (_, _, _, weight)) in view.values.iter_mut().zip(sums).zip(from) {
            *value = open * if looked > 0.0 { seen / looked } else { share };
            view.seen += weight * *value;
        }
        view.varies = from.iter().zip(&view.values).map(|((.., w), value)| w * (value - view.seen).abs()).sum();
        view
    }
}

impl Patches {
    fn end(&self, number: u32) -> End<'_> {
        cluster::index(number)
            .map_or_else(|| End::Patch(&self.nodes[number as usize]), |c| End::Cluster(&self.clusters[c]))
    }

    /// Looks at a pair with a cluster.
    pub(super) fn rough(&self, p: u32, q: u32) -> Pair {
        let ends = [self.end(p), self.end(q)];
        if let Some(end) = nearer_parts(&ends) {
            return Pair::Near(end);
        }
        if ends[0].looks_away_from(&ends[1]) || ends[1].looks_away_from(&ends[0]) {
            return Pair::Apart;
        }
        let sites = ends.map(|end| end.points());
        let sights = self.sights(&sites);
        Pair::Linked(self.estimate([p, q], &ends, &sites, &sights))
    }

    /// Looks from points to points.
    fn sights(&self, [from, to]: &[Sites; 2]) -> Sights {
        let mut sights = Sights { kernel: [[0.0; ROOM]; ROOM], seen: [[f64::NAN; ROOM]; ROOM] };
        let mut positive = 0;
        for ((x, n, ..), row) in from.get().iter().zip(&mut sights.kernel) {
            for ((y, m, ..), value) in to.get().iter().zip(row) {
                let way = *y - *x;
                let cosines = way.dot(*n).max(0.0) * (-way.dot(*m)).max(0.0);
                if cosines > 0.0 {
                    *value = cosines / (core::f64::consts::PI * way.length_squared().powi(2));
                    positive += 1;
                }
            }
        }
        // Along diagonals, so that each point has about as many rays.
        let step = usize::div_ceil(positive, RAYS).max(1);
        let mut any = false;
        for step in [step, 1] {
            for (k, (x, n, own, _)) in from.get().iter().enumerate() {
                let start = surface_point(*x, *n, *own);
                for (l, (y, m, other, _)) in to.get().iter().enumerate() {
                    if (k + l) % step == 0 && sights.kernel[k][l] > 0.0 {
                        let blocked = self.world.occluded(&start, &surface_point(*y, *m, *other));
                        sights.seen[k][l] = if blocked { 0.0 } else { 1.0 };
                        any = true;
                    }
                }
            }
            if any {
                break;
            }
        }
        sights
    }

    fn estimate(&self, [p, q]: [u32; 2], ends: &[End<'_>; 2], sites: &[Sites; 2], sights: &Sights) -> Link {
        let views = [sights.view(sites, 0), sights.view(sites, 1)];
        let exchange = self.exchange_by_points(ends, sites, views[0].open * ends[0].area() * ends[1].area());
        let seen = if views[0].open > 0.0 { (views[0].seen / views[0].open).min(1.0) } else { 0.0 };
        let spread = |own: usize| {
            let (end, other, view) = (&ends[own], &ends[1 - own], &views[own]);
            let whole = exchange / end.area();
            let scale = if view.open > 0.0 { whole / view.open } else { 0.0 };
            let mut varies = view.varies * scale;
            let distance = (end.centre() - other.centre()).length();
            if matches!(end, End::Patch(_)) && other.radius() < SMALL * end.radius() {
                varies = varies.max(0.5 * (end.radius() / distance).min(1.0) * whole * seen);
            }
            if seen <= 0.0 || seen >= 1.0 {
                varies = varies.max(AGREED * whole);
            }
            if !(view.open > 0.0) {
                // No two points face each other; some of the rest may.
                varies = AGREED * other.area() / (core::f64::consts::PI * distance * distance);
            }
            let cut = match end {
                End::Patch(node) => best_cut(&node.polygon, &core::array::from_fn(|i| view.values[i])),
                End::Cluster(_) => Cut::Longest,
            };
            #[allow(clippy::cast_possible_truncation, reason = "an estimate")]
            Spread { flux: (varies * end.area()) as f32, cut }
        };
        Link { p, q, exchange, seen, clear: false, spread: [spread(0), spread(1)] }
    }

    /// The exchange of a patch with points is exact but for these; `otherwise` is from points on both ends.
    fn exchange_by_points(&self, ends: &[End<'_>; 2], sites: &[Sites; 2], otherwise: f64) -> f64 {
        for own in [0, 1] {
            if let End::Patch(node) = ends[own] {
                let other = 1 - own;
                let factor = |(position, normal, _, weight): &(DVec3, DVec3, u32, f64)| {
                    weight * self.factor(&node.polygon, *position, *normal)
                };
                return ends[other].area() * sites[other].get().iter().map(factor).sum::<f64>();
            }
        }
        otherwise
    }
}

/// The end whose parts must be looked at, as the two are too near each other for their sizes.
fn nearer_parts(ends: &[End<'_>; 2]) -> Option<usize> {
    match ends {
        [End::Cluster(a), End::Cluster(b)] => {
            let near = a.radius + b.radius > NEAR * (a.centre - b.centre).length();
            near.then_some(usize::from(b.radius > a.radius))
        }
        [End::Patch(node), End::Cluster(cluster)] => {
            (cluster.radius > NEAR * node.polygon.distance(cluster.centre)).then_some(1)
        }
        [End::Cluster(cluster), End::Patch(node)] => {
            (cluster.radius > NEAR * node.polygon.distance(cluster.centre)).then_some(0)
        }
        [End::Patch(_), End::Patch(_)] => None,
    }
}
