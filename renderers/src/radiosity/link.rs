//! Links between patches, refined where light would be put in the wrong place (P. Hanrahan, D. Salzman & L. Aupperle, "A rapid
//! hierarchical radiosity algorithm", SIGGRAPH 1991).

use rayon::prelude::*;

use super::error::RadiosityError;
use super::exchange::exchange;
use super::mesh::{Node, Patches};
use super::transport::{Link, Spread};
use super::view::{Between, View};

/// Relative error of exchanges where nothing blocks.
const TOLERANCE: f64 = 1e-10;
/// How uncertain a share is of which all points agree, though it isn't proven.
const AGREED: f64 = 0.125;
/// How much the variation over a sender counts, as it is halved again by that of its radiosity.
const SENDER: f64 = 0.5;
/// Points on a patch say nothing of the light from what is smaller than this share of its size; then its distance does.
const SMALL: f64 = 0.5;
/// Bytes for a link while links are refined, with those of the operator.
const LINK_BYTES: usize = 96;
/// Bytes for a patch.
const PATCH_BYTES: usize = 512;

/// What links are refined by.
pub(super) struct Oracle<'o> {
    /// Luminous radiosity of the nodes there were when it was computed; for newer ones their parents' counts.
    pub(super) radiosity: Vec<f64>,
    /// The same for irradiance; at least as much as counts as darkness.
    pub(super) irradiance: Vec<f64>,
    /// Luminous reflectance of the sides.
    pub(super) reflectance: &'o [f64],
    /// The relative error of irradiance that a link may cause, times the area.
    pub(super) most: f64,
    /// The most memory, in bytes.
    pub(super) memory: usize,
}

impl Oracle<'_> {
    fn check(&self, patches: usize, links: usize) -> Result<(), RadiosityError> {
        let bytes = PATCH_BYTES.saturating_mul(patches).saturating_add(LINK_BYTES.saturating_mul(links));
        if bytes <= self.memory { Ok(()) } else { Err(RadiosityError::TooLarge { patches, links, bytes }) }
    }

    /// The relative error of irradiance that a link causes because it is the same all over each end, about, times the area.
    fn errors(&self, patches: &Patches, link: &Link) -> [f64; 2] {
        let reflectance = |n: u32| self.reflectance[patches.nodes[n as usize].side as usize];
        // What arrives matters as far as it is reflected.
        let weight =
            |from: u32, to: u32| reflectance(to) * self.radiosity[from as usize] / self.irradiance[to as usize];
        let (forth, back) = (weight(link.p, link.q), weight(link.q, link.p));
        let [p, q] = link.spread.map(|spread| f64::from(spread.flux));
        [p * back.max(SENDER * forth), q * forth.max(SENDER * back)]
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

/// Links between all roots.
pub(super) fn of_roots(patches: &Patches, oracle: &Oracle<'_>) -> Result<Vec<Link>, RadiosityError> {
    let roots = u32::try_from(patches.roots).unwrap_or(u32::MAX);
    oracle.check(patches.roots, patches.roots.saturating_mul(patches.roots) / 4)?;
    Ok((0..roots)
        .into_par_iter()
        .flat_map_iter(|p| (p + 1..roots).filter_map(move |q| link(patches, p, q, false)))
        .collect())
}

/// Refines links until each is good enough.
pub(super) fn refine(
    patches: &mut Patches,
    links: Vec<Link>,
    oracle: &mut Oracle<'_>,
) -> Result<Vec<Link>, RadiosityError> {
    let (mut done, mut open) = (Vec::new(), links);
    while !open.is_empty() {
        let mut pairs = Vec::new();
        for link in open {
            if !subdivide(patches, &link, oracle, &mut pairs) {
                done.push(link);
            }
        }
        oracle.check(patches.nodes.len(), done.len() + pairs.len())?;
        let known = &*patches;
        open = pairs.into_par_iter().filter_map(|(p, q, clear)| link(known, p, q, clear)).collect();
    }
    Ok(done)
}

/// If a link isn't good enough, replaces it by links to the halves of the end where it causes more of the error, or of the other if that
/// can't be split.
fn subdivide(patches: &mut Patches, link: &Link, oracle: &mut Oracle<'_>, pairs: &mut Vec<(u32, u32, bool)>) -> bool {
    let errors = oracle.errors(patches, link);
    if !(errors[0].max(errors[1]) > oracle.most) {
        return false;
    }
    let ends = [(link.p, link.q, link.spread[0].cut), (link.q, link.p, link.spread[1].cut)];
    let order = if errors[0] >= errors[1] { [0, 1] } else { [1, 0] };
    for (split, other, cut) in order.map(|end| ends[end]) {
        if patches.split_by(split as usize, cut) {
            oracle.radiosity.resize(patches.nodes.len(), oracle.radiosity[split as usize]);
            oracle.irradiance.resize(patches.nodes.len(), oracle.irradiance[split as usize]);
            let child = patches.nodes[split as usize].child;
            pairs.extend([child, child + 1].map(|c| (c, other, link.clear)));
            return true;
        }
    }
    false
}
