//! Links between patches, refined where light would be put in the wrong place (P. Hanrahan, D. Salzman & L. Aupperle, "A rapid
//! hierarchical radiosity algorithm", SIGGRAPH 1991).

use rayon::prelude::*;

use super::error::RadiosityError;
use super::exchange::exchange;
use super::mesh::Patches;
use super::sight::Sight;
use super::transport::Link;

/// Relative error of exchanges where nothing blocks.
const TOLERANCE: f64 = 1e-10;
/// Rays that tell how much of one patch another one sees.
const RAYS: u32 = 16;
/// How uncertain a share is of which all rays agree, though it isn't proven.
const AGREED: f64 = 0.125;
/// Bytes for a link while links are refined, with those of the operator.
const LINK_BYTES: usize = 64;
/// Bytes for a patch.
const PATCH_BYTES: usize = 512;

/// What links are refined by.
pub(super) struct Oracle<'o> {
    /// Luminous radiosity of the nodes there were when it was computed; for newer ones their parents' counts.
    pub(super) radiosity: Vec<f64>,
    /// Luminous reflectance of the sides.
    pub(super) reflectance: &'o [f64],
    /// The flux that a link may put in the wrong place.
    pub(super) most: f64,
    /// The most memory, in bytes.
    pub(super) memory: usize,
}

impl Oracle<'_> {
    fn check(&self, patches: usize, links: usize) -> Result<(), RadiosityError> {
        let bytes = PATCH_BYTES.saturating_mul(patches).saturating_add(LINK_BYTES.saturating_mul(links));
        if bytes <= self.memory { Ok(()) } else { Err(RadiosityError::TooLarge { patches, links, bytes }) }
    }

    /// The flux that a link puts in the wrong place, about.
    fn error(&self, patches: &Patches, link: &Link) -> f64 {
        let [p, q] = [link.p, link.q].map(|n| &patches.nodes[n as usize]);
        // What arrives matters as far as it is reflected.
        let flux = |from: u32, to: u32| {
            self.radiosity[from as usize] * self.reflectance[patches.nodes[to as usize].side as usize]
        };
        let largest = flux(link.p, link.q).max(flux(link.q, link.p)) * link.exchange;
        let distance = (p.polygon.centre - q.polygon.centre).length();
        let smooth = (p.polygon.radius.max(q.polygon.radius) / distance).min(1.0);
        let shadow = if link.clear {
            0.0
        } else if link.seen > 0.0 && link.seen < 1.0 {
            1.0
        } else {
            AGREED
        };
        largest * (smooth * link.seen).max(shadow)
    }
}

/// The link between two patches, if they see each other. What is clear for their parents is for them.
fn link(patches: &Patches, p: u32, q: u32, clear: bool) -> Option<Link> {
    let [a, b] = [p, q].map(|n| &patches.nodes[n as usize]);
    let exchange = exchange(&a.polygon, &b.polygon, patches.slack, TOLERANCE);
    if !(exchange > 0.0) {
        return None;
    }
    let sight = if clear { Sight::Clear } else { patches.sight(a, b) };
    let seen = match sight {
        Sight::Clear => 1.0,
        Sight::Blocked => return None,
        Sight::Mixed => patches.visible_share(a, b, RAYS),
    };
    Some(Link { p, q, exchange, seen, clear: sight == Sight::Clear })
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
        let known = &*patches;
        let judge = |link: &Link| oracle.error(known, link) > oracle.most;
        let coarse: Vec<bool> = open.par_iter().map(judge).collect();
        let mut pairs = Vec::new();
        for (link, coarse) in open.into_iter().zip(coarse) {
            if !(coarse && subdivide(patches, &link, oracle, &mut pairs)) {
                done.push(link);
            }
        }
        oracle.check(patches.nodes.len(), done.len() + pairs.len())?;
        let known = &*patches;
        open = pairs.into_par_iter().filter_map(|(p, q, clear)| link(known, p, q, clear)).collect();
    }
    Ok(done)
}

/// Replaces a link by links to the halves of its larger end, or of the other if that can't be split.
fn subdivide(patches: &mut Patches, link: &Link, oracle: &mut Oracle<'_>, pairs: &mut Vec<(u32, u32, bool)>) -> bool {
    let radius = |n: u32| patches.nodes[n as usize].polygon.radius;
    let ends = if radius(link.p) >= radius(link.q) {
        [(link.p, link.q), (link.q, link.p)]
    } else {
        [(link.q, link.p), (link.p, link.q)]
    };
    for (large, other) in ends {
        if patches.split(large as usize) {
            oracle.radiosity.resize(patches.nodes.len(), oracle.radiosity[large as usize]);
            let child = patches.nodes[large as usize].child;
            pairs.extend([child, child + 1].map(|c| (c, other, link.clear)));
            return true;
        }
    }
    false
}
