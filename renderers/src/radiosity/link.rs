//! Links between patches, refined where light would be put in the wrong place (P. Hanrahan, D. Salzman & L. Aupperle, "A rapid
//! hierarchical radiosity algorithm", SIGGRAPH 1991).

use rayon::prelude::*;

use super::cluster;
use super::error::RadiosityError;
use super::exchange::exchange;
use super::mesh::{LEAF, Node, Patches};
use super::rough::Pair;
use super::transport::{Link, Spread};
use super::view::{Between, View};

/// Relative error of exchanges where nothing blocks.
const TOLERANCE: f64 = 1e-10;
/// How uncertain a share is of which all points agree, though it isn't proven.
pub(super) const AGREED: f64 = 0.125;
/// How much the variation over a sender counts, as it is halved again by that of its radiosity.
const SENDER: f64 = 0.5;
/// The same for clusters, of which the variation of radiosity is known, at least.
const CLUSTER_SENDER: f64 = 0.25;
/// Points on a patch say nothing of the light from what is smaller than this share of its size; then its distance does.
pub(super) const SMALL: f64 = 0.5;
/// Bytes for a link while links are refined, with those of the operator.
const LINK_BYTES: usize = 96;
/// Pairs that are looked at together.
const BATCH: usize = 1 << 16;
/// Bytes for a patch.
const PATCH_BYTES: usize = 512;

/// Luminous values of patches and clusters.
#[derive(Default)]
pub(super) struct Values {
    /// Of the patches there were when they were computed; for newer ones their parents' count.
    pub(super) patches: Vec<f64>,
    pub(super) clusters: Vec<f64>,
}

impl Values {
    /// From values of the patches followed by those of the clusters.
    pub(super) fn new(mut rows: Vec<f64>, patches: usize) -> Self {
        let clusters = rows.split_off(patches.min(rows.len()));
        Self { patches: rows, clusters }
    }

    /// Makes all values at least this large.
    pub(super) fn raise(&mut self, least: f64) {
        self.patches.iter_mut().chain(&mut self.clusters).for_each(|value| *value = value.max(least));
    }

    fn at(&self, number: u32) -> f64 {
        cluster::index(number).map_or_else(|| self.patches[number as usize], |c| self.clusters[c])
    }
}

/// What links are refined by.
pub(super) struct Oracle {
    /// Luminous radiosity.
    pub(super) radiosity: Values,
    /// Luminous irradiance; at least as much as counts as darkness.
    pub(super) irradiance: Values,
    /// Luminous reflectance.
    pub(super) reflectance: Values,
    /// The root mean square deviation of radiosity within clusters.
    pub(super) uneven: Vec<f64>,
    /// The relative error of irradiance that a link may cause, times the area.
    pub(super) most: f64,
    /// The same for links with clusters, without the area.
    pub(super) most_in_cluster: f64,
    /// The most memory, in bytes.
    pub(super) memory: usize,
}

impl Oracle {
    fn check(&self, patches: usize, links: usize) -> Result<(), RadiosityError> {
        let bytes = PATCH_BYTES.saturating_mul(patches).saturating_add(LINK_BYTES.saturating_mul(links));
        if bytes <= self.memory { Ok(()) } else { Err(RadiosityError::TooLarge { patches, links, bytes }) }
    }

    /// For each end, the relative error of irradiance that a link causes because it is the same all over that end, about, times the area, over
    /// what is allowed.
    fn errors(&self, patches: &Patches, link: &Link) -> [f64; 2] {
        if self.most == f64::INFINITY {
            return [0.0; 2];
        }
        // What arrives matters as far as it is reflected.
        let weight = |sent: f64, to: u32| self.reflectance.at(to) * sent / self.irradiance.at(to);
        let error = |own: u32, other: u32, flux: f32| {
            let arriving = weight(self.radiosity.at(other), own);
            match cluster::index(own) {
                None => arriving.max(weight(SENDER * self.radiosity.at(own), other)) * f64::from(flux) / self.most,
                Some(index) => {
                    // The faces of a cluster may be small: each is to have the right light, too.
                    let over = |error: f64, area: f64| error / self.most.min(self.most_in_cluster * area);
                    let unevenly = self.uneven[index].max(CLUSTER_SENDER * self.radiosity.at(own));
                    over(arriving, patches.area(own)).max(over(weight(unevenly, other), patches.area(other)))
                        * f64::from(flux)
                }
            }
        };
        [error(link.p, link.q, link.spread[0].flux), error(link.q, link.p, link.spread[1].flux)]
    }
}

/// The link between two patches, if they see each other. What is clear for their parents is for them.
fn link(patches: &Patches, p: u32, q: u32, clear: bool) -> Option<Link> {
    let [a, b] = [p, q].map(|n| &patches.nodes[n as usize]);
    let exchange = exchange(&a.polygon, &b.polygon, patches.slack, TOLERANCE);
    if !(exchange > 0.0) {
        return None;
    }
    let between = if clear { Between::Clear } else { patches.between(a, b) };
    if matches!(between, Between::Blocked) {
        return None;
    }
    let clear = matches!(between, Between::Clear);
    let views = [patches.view(a, b, &between), patches.view(b, a, &between)];
    let seen = if clear { 1.0 } else { seen_share([a, b], &views) };
    let spread = |own: &Node, other: &Node, view: &View| {
        let whole = exchange / own.polygon.area;
        let scale = if view.open > 0.0 { whole / view.open } else { 0.0 };
        let mut varies = view.varies * scale;
        if other.polygon.radius < SMALL * own.polygon.radius || !(view.open > 0.0) {
            let distance = (own.polygon.centre - other.polygon.centre).length();
            varies = varies.max(0.5 * (own.polygon.radius / distance).min(1.0) * whole * seen);
        }
        if !clear && (seen <= 0.0 || seen >= 1.0) {
            varies = varies.max(AGREED * whole);
        }
        #[allow(clippy::cast_possible_truncation, reason = "an estimate")]
        Spread { flux: (varies * own.polygon.area) as f32, cut: view.cut }
    };
    let spread = [spread(a, b, &views[0]), spread(b, a, &views[1])];
    Some(Link { p, q, exchange, seen, clear, spread })
}

/// The visible share of the light between two patches, from what points of the smaller see, or of both.
fn seen_share([p, q]: [&Node; 2], [from_p, from_q]: &[View; 2]) -> f64 {
    let weight = |own: &Node, other: &Node| {
        if other.polygon.radius < SMALL * own.polygon.radius { 0.0 } else { own.polygon.area }
    };
    let (p, q) = (weight(p, q), weight(q, p));
    let open = p * from_p.open + q * from_q.open;
    if open > 0.0 { ((p * from_p.seen + q * from_q.seen) / open).min(1.0) } else { 0.0 }
}

/// Two ends that may exchange light, and whether nothing blocks, for certain.
type Ends = (u32, u32, bool);

/// What all links come from.
pub(super) fn all_pairs(patches: &Patches, oracle: &Oracle) -> Result<Vec<Ends>, RadiosityError> {
    if !patches.clusters.is_empty() {
        return Ok(vec![(cluster::FIRST, cluster::FIRST, false)]);
    }
    oracle.check(patches.roots, patches.roots.saturating_mul(patches.roots) / 4)?;
    let roots = u32::try_from(patches.roots).unwrap_or(LEAF);
    Ok((0..roots).flat_map(|p| (p + 1..roots).map(move |q| (p, q, false))).collect())
}

/// What becomes of two ends.
fn pair(patches: &Patches, (p, q, clear): Ends) -> Pair {
    if p == q {
        return Pair::Near(0);
    }
    if cluster::index(p).is_some() || cluster::index(q).is_some() {
        return patches.rough(p, q);
    }
    link(patches, p, q, clear).map_or(Pair::Apart, Pair::Linked)
}

/// Adds links between pairs to those there are and refines all until each is good enough.
///
/// Level by level, so that what is coarse decides how patches are cut, and some pairs at a time, so that there is room for links alone.
pub(super) fn refine(
    patches: &mut Patches,
    mut links: Vec<Link>,
    mut pairs: Vec<Ends>,
    oracle: &mut Oracle,
) -> Result<Vec<Link>, RadiosityError> {
    links.retain(|link| !subdivide(patches, link, oracle, &mut pairs));
    while !pairs.is_empty() {
        let (mut parts_of_pairs, mut parts_of_links) = (Vec::new(), Vec::new());
        for (index, batch) in pairs.chunks(BATCH).enumerate() {
            // Pairs that have become links, or nothing, aren't counted as well.
            let open = pairs.len() - index * BATCH + parts_of_pairs.len() + parts_of_links.len();
            oracle.check(patches.nodes.len(), links.len() + open)?;
            let known = &*patches;
            let found: Vec<Pair> = batch.par_iter().map(|ends| pair(known, *ends)).collect();
            for (found, (p, q, clear)) in found.into_iter().zip(batch) {
                match found {
                    Pair::Apart => {}
                    Pair::Linked(link) => {
                        if !subdivide(patches, &link, oracle, &mut parts_of_links) {
                            links.push(link);
                        }
                    }
                    Pair::Near(end) => {
                        parts_of_pairs.extend(parts(patches, [*p, *q], end).into_iter().map(|[p, q]| (p, q, *clear)));
                    }
                }
            }
        }
        parts_of_pairs.append(&mut parts_of_links);
        pairs = parts_of_pairs;
    }
    Ok(links)
}

/// The pairs that a pair with a cluster at one end consists of.
fn parts(patches: &Patches, ends: [u32; 2], end: usize) -> Vec<[u32; 2]> {
    let Some(cluster) = cluster::index(ends[end]) else { return Vec::new() };
    let [a, b] = patches.clusters[cluster].children;
    if ends[0] == ends[1] {
        let within = [a, b].into_iter().filter(|child| cluster::index(*child).is_some()).map(|child| [child; 2]);
        return within.chain([[a, b]]).collect();
    }
    [a, b].map(|child| if end == 0 { [child, ends[1]] } else { [ends[0], child] }).to_vec()
}

/// If a link isn't good enough, replaces it by links to the parts of the end where it causes more of the error, or of the other if that
/// can't be split.
fn subdivide(patches: &mut Patches, link: &Link, oracle: &mut Oracle, pairs: &mut Vec<Ends>) -> bool {
    let errors = oracle.errors(patches, link);
    if !(errors[0].max(errors[1]) > 1.0) {
        return false;
    }
    let ends = [(link.p, link.q, link.spread[0].cut), (link.q, link.p, link.spread[1].cut)];
    let order = if errors[0] >= errors[1] { [0, 1] } else { [1, 0] };
    for (split, other, cut) in order.map(|end| ends[end]) {
        if let Some(cluster) = cluster::index(split) {
            pairs.extend(patches.clusters[cluster].children.map(|child| (child, other, false)));
            return true;
        }
        if patches.split_by(split as usize, cut) {
            for values in [&mut oracle.radiosity, &mut oracle.irradiance, &mut oracle.reflectance] {
                values.patches.resize(patches.nodes.len(), values.patches[split as usize]);
            }
            let child = patches.nodes[split as usize].child;
            pairs.extend([child, child + 1].map(|c| (c, other, link.clear)));
            return true;
        }
    }
    false
}
