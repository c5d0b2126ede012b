//! The visible share of a light by shadow rays, to a requested accuracy: cells along the shadow's edge are divided, the heaviest first.

use alloc::collections::BinaryHeap;
use core::cmp::Ordering;
use core::hash::{BuildHasherDefault, Hasher as _};
use std::collections::HashMap;

use super::lattice::{Panel, Sight};
use super::source::{Receiver, Source};
use crate::geometry::{NO_PRIMITIVE, World};
use crate::spectral::PairHasher;

/// Cells are at least 1/2 to this power as wide as the light, and at most 1/2 to the other.
const LEAST_LEVEL: u32 = 3;
const MOST_LEVEL: u32 = 12;
/// How far inside its edge a light is asked for visibility, a share of its size: some roundings of the rays.
const INSET: f64 = 1e-5;
/// The standard deviation of the visible share of a cell that an edge passes through by a random point in each of its quarters: 0.14 where
/// the edge passes two quarters, at most 0.25 where it passes all.
const DEVIATION: f64 = 0.2;
/// How many standard deviations of their sum the error is stated as.
const CONFIDENCE: f64 = 3.0;
/// Nodes and weights of the Gauss–Legendre rule with three points on [0, 1].
const GAUSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_31, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

/// A visible share, the estimated error of it, and the rays it took.
#[derive(Clone, Copy, Debug)]
pub(super) struct Share {
    pub(super) value: f64,
    pub(super) error: f64,
    pub(super) rays: u64,
}

/// What asks whether a point of the unit square is visible, and how much it counts.
pub(super) struct Probe<'w> {
    pub(super) world: &'w World,
    pub(super) receiver: &'w Receiver,
    pub(super) panel: Panel,
    pub(super) primitive: u32,
}

impl<'w> Probe<'w> {
    pub(super) fn new(world: &'w World, receiver: &'w Receiver, source: &Source) -> Self {
        let panel = Panel::new(&source.shape, receiver.position);
        Self { world, receiver, panel, primitive: source.primitive }
    }

    /// The environment around a receiver.
    pub(super) fn of_sky(world: &'w World, receiver: &'w Receiver) -> Self {
        let panel = Panel::Sky { position: receiver.position, up: receiver.normal };
        Self { world, receiver, panel, primitive: NO_PRIMITIVE }
    }

    fn sight(&self, square: [f64; 2]) -> Sight {
        self.panel.sees(self.panel.point(square, INSET), self.primitive, self.receiver, self.world)
    }

    fn density(&self, square: [f64; 2]) -> f64 {
        self.panel.density(self.panel.point(square, 0.0), self.receiver)
    }
}

/// A cell in which not all looks the same, by its weight.
#[derive(Clone, Copy, Debug)]
struct Cell {
    weight: f64,
    share: f64,
    level: u32,
    column: u32,
    row: u32,
}

impl PartialEq for Cell {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Cell {}

impl PartialOrd for Cell {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Cell {
    fn cmp(&self, other: &Self) -> Ordering {
        let place = |cell: &Self| (cell.level, cell.row, cell.column);
        self.weight.total_cmp(&other.weight).then_with(|| place(other).cmp(&place(self)))
    }
}

/// The sums over all cells.
struct Sums<'p> {
    probe: &'p Probe<'p>,
    known: HashMap<(u32, u32), Sight, BuildHasherDefault<PairHasher>>,
    mixed: BinaryHeap<Cell>,
    /// Cells that are not divided any more.
    finest: Vec<Cell>,
    /// Weights of all cells, of the uniformly visible ones, and of the visible shares of the others.
    total: f64,
    visible: f64,
    /// The sum of the squares of the weights of cells that are not uniform.
    squares: f64,
}

/// The share of a light that is visible, by at most about twice `most_rays` shadow rays: they stop when the error, three standard deviations
/// of what isn't known of the cells along the shadow's edge, is at most `accuracy` of the share. What is smaller than 1/16 of the light's width
/// and doesn't meet a shadow's edge may be missed.
pub(super) fn visible_share(probe: &Probe<'_>, accuracy: f64, most_rays: u64) -> Share {
    let mut sums = Sums {
        probe,
        known: HashMap::default(),
        mixed: BinaryHeap::new(),
        finest: Vec::new(),
        total: 0.0,
        visible: 0.0,
        squares: 0.0,
    };
    let cells = 1 << LEAST_LEVEL;
    for (row, column) in (0..cells).flat_map(|row| (0..cells).map(move |column| (row, column))) {
        sums.add(LEAST_LEVEL, column, row);
    }
    while sums.error() > accuracy * sums.visible && sums.rays() < most_rays {
        let Some(cell) = sums.mixed.pop() else { break };
        if cell.level == MOST_LEVEL {
            sums.finest.push(cell);
        } else {
            sums.divide(&cell);
        }
    }
    sums.result()
}

impl Sums<'_> {
    #[allow(clippy::cast_precision_loss, reason = "a number of rays")]
    fn rays(&self) -> u64 {
        self.known.len() as u64
    }

    fn error(&self) -> f64 {
        CONFIDENCE * DEVIATION * self.squares.max(0.0).sqrt()
    }

    fn sight(&mut self, column: u32, row: u32) -> Sight {
        let probe = self.probe;
        let last = f64::from(2_u32 << MOST_LEVEL);
        *self.known.entry((column, row)).or_insert_with(|| probe.sight([column, row].map(|c| f64::from(c) / last)))
    }

    fn add(&mut self, level: u32, column: u32, row: u32) {
        let weight = self.weight(level, column, row);
        self.total += weight;
        let width = 2 << (MOST_LEVEL - level);
        let (x, y) = (column * width, row * width);
        let corners = [(0, 0), (width, 0), (0, width), (width, width)].map(|(dx, dy)| self.sight(x + dx, y + dy));
        let middle = self.sight(x + width / 2, y + width / 2);
        let count = |sight| corners.iter().map(|s| u32::from(*s == sight)).sum::<u32>();
        // The middle stands for as much as the corners together.
        let twice = |sight| f64::from(count(sight) + 4 * u32::from(middle == sight));
        let (visible, blocked) = (twice(Sight::Visible), twice(Sight::Blocked));
        if blocked == 0.0 {
            self.visible += weight;
        } else if visible > 0.0 {
            let share = visible / (visible + blocked);
            self.visible += weight * share;
            self.squares += weight * weight;
            self.mixed.push(Cell { weight, share, level, column, row });
        }
    }

    fn divide(&mut self, cell: &Cell) {
        self.total -= cell.weight;
        self.visible -= cell.weight * cell.share;
        self.squares -= cell.weight * cell.weight;
        for (x, y) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            self.add(cell.level + 1, 2 * cell.column + x, 2 * cell.row + y);
        }
    }

    /// The integral of the density over a cell.
    fn weight(&self, level: u32, column: u32, row: u32) -> f64 {
        let width = 1.0 / f64::from(1_u32 << level);
        let (x, y) = (f64::from(column) * width, f64::from(row) * width);
        let mut sum = 0.0;
        for (u, along) in GAUSS {
            for (v, across) in GAUSS {
                sum += along * across * self.probe.density([x + u * width, y + v * width]);
            }
        }
        sum * width * width
    }

    /// Random points, not those of the lattice, tell the shares of the cells that are left: so the errors along an edge that runs with the
    /// lattice don't add up.
    fn result(mut self) -> Share {
        let error = self.error();
        let mut rays = self.rays();
        for cell in self.mixed.iter().chain(&self.finest) {
            self.visible += cell.weight * (random_share(self.probe, cell).unwrap_or(cell.share) - cell.share);
            rays += 4;
        }
        if !(self.total > 0.0) {
            return Share { value: 0.0, error: 0.0, rays };
        }
        Share { value: (self.visible / self.total).clamp(0.0, 1.0), error: error / self.total, rays }
    }
}

/// The visible share of a cell by a random point in each of its quarters; `None` if all of them are below the horizon.
fn random_share(probe: &Probe<'_>, cell: &Cell) -> Option<f64> {
    let mut hasher = PairHasher::default();
    hasher.write_u32(cell.level);
    hasher.write_u32(cell.column);
    hasher.write_u32(cell.row);
    let width = 0.5 / f64::from(1_u32 << cell.level);
    let (mut visible, mut blocked) = (0, 0);
    for (x, y) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let mut place = |cell: u32, half: u32| {
            hasher.write_u32(half);
            (f64::from(2 * cell + half) + unit(hasher.finish())) * width
        };
        match probe.sight([place(cell.column, x), place(cell.row, y)]) {
            Sight::Visible => visible += 1,
            Sight::Blocked => blocked += 1,
            Sight::BelowHorizon => {}
        }
    }
    (visible + blocked > 0).then(|| f64::from(visible) / f64::from(visible + blocked))
}

/// Mixes the bits of a number to another in [0, 1) (the finaliser of MurmurHash3).
#[allow(clippy::cast_possible_truncation, reason = "the highest 32 bits")]
fn unit(mut bits: u64) -> f64 {
    bits = (bits ^ (bits >> 33)).wrapping_mul(0xff51_afd7_ed55_8ccd);
    bits = (bits ^ (bits >> 33)).wrapping_mul(0xc4ce_b9fe_1a85_ec53);
    f64::from((bits >> 32) as u32) / f64::from(u32::MAX).next_up()
}
