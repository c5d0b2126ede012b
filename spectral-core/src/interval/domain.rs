//! The visible domain, split dyadically, and the weight of each part.

use crate::Observer;
use crate::Real;
use crate::integrate::{Sum, for_each_piece};
use crate::spectrum::{Segment, Spectrum};

/// The lower limit of the visible domain in nm.
pub const FIRST_WAVELENGTH: f64 = 380.0;
/// The upper limit of the visible domain in nm.
pub const LAST_WAVELENGTH: f64 = 780.0;
/// The deepest level that a [`Domain`] may have: 2¹² parts of 0.098 nm, whose limits are exact in `f32`, too.
pub const MAX_DEPTH: u8 = 12;

/// One part of the visible domain: the `index`-th of 2^`level` equal parts (Iehl–Péroche's interval (j, i)).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Node {
    level: u8,
    index: u16,
}

impl Node {
    /// The whole visible domain, interval (0, 0).
    pub const ROOT: Self = Self { level: 0, index: 0 };

    /// The `index`-th of 2^`level` parts; `None` when there is no such part or the level is above [`MAX_DEPTH`].
    #[must_use]
    pub const fn new(level: u8, index: u16) -> Option<Self> {
        if level <= MAX_DEPTH && index < (1 << level) { Some(Self { level, index }) } else { None }
    }

    /// The level j.
    #[must_use]
    pub const fn level(self) -> u8 {
        self.level
    }

    /// The index i, below 2^j.
    #[must_use]
    pub const fn index(self) -> u16 {
        self.index
    }

    /// The two halves; `None` at [`MAX_DEPTH`].
    #[must_use]
    pub const fn children(self) -> Option<[Self; 2]> {
        if self.level >= MAX_DEPTH {
            return None;
        }
        let level = self.level + 1;
        Some([Self { level, index: 2 * self.index }, Self { level, index: 2 * self.index + 1 }])
    }

    /// The part this is a half of; `None` for the root.
    #[must_use]
    pub const fn parent(self) -> Option<Self> {
        if self.level == 0 { None } else { Some(Self { level: self.level - 1, index: self.index / 2 }) }
    }

    /// The place in breadth-first order, from 0 for the root to 2^(depth+1) − 2.
    #[must_use]
    pub const fn position(self) -> usize {
        (1 << self.level) - 1 + self.index as usize
    }

    /// The limits in nm, exact.
    #[must_use]
    pub fn limits<R: Real>(self) -> [R; 2] {
        let width = (LAST_WAVELENGTH - FIRST_WAVELENGTH) / f64::from(1_u32 << self.level);
        let first = FIRST_WAVELENGTH + width * f64::from(self.index);
        [R::from_f64(first), R::from_f64(first + width)]
    }
}

/// The weights of one part: I_a = ∫ā over it in nm, and what the operators need of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Weight<R> {
    /// I_a = ∫ā in nm, within 8 ε.
    pub integral: [R; 3],
    /// 1 / I_a, or 0 where I_a is 0.
    pub inverse: [R; 3],
    /// √I_a.
    pub root: [R; 3],
}

/// The spectrum 1.
struct Unit;

impl<R: Real> Spectrum<R> for Unit {
    fn segment(&self, _: R) -> Segment<R> {
        Segment { end: R::INFINITY, first: R::ONE, last: R::ONE }
    }
}

impl<R: Real> Weight<R> {
    fn new(observer: &Observer<R>, node: Node) -> Self {
        let [from, to] = node.limits();
        let mut sums = [Sum::<R>::default(); 3];
        for_each_piece(observer, &Unit, from, to, |piece| {
            for (a, sum) in sums.iter_mut().enumerate() {
                sum.add(piece.weight(a));
            }
        });
        let integral = sums.map(Sum::value);
        let inverse = integral.map(|i| if i > R::ZERO { R::ONE / i } else { R::ZERO });
        Self { integral, inverse, root: integral.map(R::sqrt) }
    }
}

/// How many nodes a dyadic tree of this depth has: 2^(`depth`+1) − 1.
#[must_use]
pub const fn node_count(depth: u8) -> usize {
    (1 << (depth + 1)) - 1
}

/// Why a domain or a pyramid could not be built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum BuildError {
    /// The depth is above [`MAX_DEPTH`].
    TooDeep,
    /// The caller's buffer holds fewer than [`node_count`] entries.
    BufferTooSmall {
        /// How many entries are needed.
        needed: usize,
    },
    /// The spectrum has an infinite or undefined value inside the visible domain, or one whose integral overflows.
    NotFinite,
}

impl core::fmt::Display for BuildError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::TooDeep => write!(f, "the depth is above {MAX_DEPTH}"),
            Self::BufferTooSmall { needed } => {
                write!(f, "the buffer is too small: {needed} entries are needed")
            }
            Self::NotFinite => write!(f, "the spectrum is not finite over the visible domain"),
        }
    }
}

impl core::error::Error for BuildError {}

/// The visible domain [380, 780] nm, split dyadically down to `depth`, with the weights of an observer.
#[derive(Clone, Copy, Debug)]
pub struct Domain<'a, R> {
    observer: Observer<'a, R>,
    weights: &'a [Weight<R>],
    depth: u8,
}

impl<'a, R: Real> Domain<'a, R> {
    /// Computes the weights into the caller's buffer of at least [`node_count`]`(depth)` entries.
    ///
    /// # Errors
    /// [`BuildError::TooDeep`] and [`BuildError::BufferTooSmall`].
    pub fn build(observer: Observer<'a, R>, depth: u8, buffer: &'a mut [Weight<R>]) -> Result<Self, BuildError> {
        if depth > MAX_DEPTH {
            return Err(BuildError::TooDeep);
        }
        let needed = node_count(depth);
        let weights = buffer.get_mut(..needed).ok_or(BuildError::BufferTooSmall { needed })?;
        for (node, weight) in nodes(depth).zip(weights.iter_mut()) {
            *weight = Weight::new(&observer, node);
        }
        Ok(Self { observer, weights, depth })
    }

    /// The deepest level.
    #[must_use]
    pub const fn depth(&self) -> u8 {
        self.depth
    }

    /// The observer whose colour-matching functions weight the parts.
    #[must_use]
    pub const fn observer(&self) -> &Observer<'a, R> {
        &self.observer
    }

    /// The weight of a part; zeros below the deepest level.
    #[must_use]
    #[inline]
    pub fn weight(&self, node: Node) -> Weight<R> {
        self.weights.get(node.position()).copied().unwrap_or_default()
    }
}

/// All nodes down to `depth`, in the order of [`Node::position`].
pub fn nodes(depth: u8) -> impl Iterator<Item = Node> {
    (0..=depth.min(MAX_DEPTH)).flat_map(|level| (0..1_u16 << level).map(move |index| Node { level, index }))
}
