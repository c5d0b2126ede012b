//! Visibility of a light asked for by shadow rays, on a lattice that is refined along the shadow's edge: quick, and as good as a pixel
//! needs it.

use disk_sampling::square_to_disk;
use glam::DVec3;

use super::source::{Flat, Receiver, Shape, Source, single};
use super::visible::Cones;
use crate::geometry::{SurfacePoint, World};

/// The finest lattice of points on a light at which visibility is asked for: 16 × 16 cells.
const MAX_LEVEL: u32 = 4;
const LATTICE: usize = (1 << MAX_LEVEL) + 1;
/// How far inside its edge a light is asked for visibility: a share of its size.
const INSET: f64 = 1e-3;

/// How a receiver sees a point of a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sight {
    Visible,
    Blocked,
    BelowHorizon,
}

/// The side of a light that a receiver sees: how it is filled by the unit square, area for area.
#[derive(Clone, Copy, Debug)]
pub(super) enum Panel {
    Rectangle(Flat),
    Triangle {
        corners: [DVec3; 3],
        normal: DVec3,
    },
    /// A disk, or the disk of a sphere's visible cap, which fills the same cone.
    Round {
        flat: Flat,
        sphere: Option<(DVec3, f64)>,
    },
    /// The hemisphere around a direction, by its projection on the unit disk: a point is the receiver's position plus a direction.
    Sky {
        position: DVec3,
        up: DVec3,
    },
}

impl Panel {
    /// The side of a light that is seen from a position outside of it.
    pub(super) fn new(shape: &Shape, position: DVec3) -> Self {
        match *shape {
            Shape::Rectangle(flat) => Self::Rectangle(flat),
            Shape::Disk(flat) => Self::Round { flat, sphere: None },
            Shape::Triangle(corners) => {
                let [a, b, c] = corners;
                Self::Triangle { corners, normal: (b - a).cross(c - a).normalize_or_zero() }
            }
            Shape::Sphere { centre, radius } => {
                let circle = super::blocker::cap(centre - position, radius);
                let flat = Flat { centre: circle.centre + position, u: circle.u, v: circle.v, normal: -circle.normal };
                Self::Round { flat, sphere: Some((centre, radius)) }
            }
        }
    }

    /// Its middle.
    pub(super) fn middle(&self) -> DVec3 {
        match self {
            Self::Rectangle(flat) | Self::Round { flat, .. } => flat.centre,
            Self::Triangle { corners, .. } => corners.iter().sum::<DVec3>() / 3.0,
            Self::Sky { position, up } => *position + *up,
        }
    }

    /// The unit normal towards the side that shines.
    pub(super) fn normal(&self) -> DVec3 {
        match self {
            Self::Rectangle(flat) | Self::Round { flat, .. } => flat.normal,
            Self::Triangle { normal, .. } => *normal,
            Self::Sky { up, .. } => -*up,
        }
    }

    /// Its width.
    fn size(&self) -> f64 {
        match self {
            Self::Rectangle(flat) | Self::Round { flat, .. } => 2.0 * flat.u.length().max(flat.v.length()),
            Self::Sky { .. } => 2.0,
            Self::Triangle { corners: [a, b, c], .. } => a.distance(*b).max(b.distance(*c)).max(c.distance(*a)),
        }
    }

    /// The point for a point of the unit square, inside the edge by half the share `inset` of the size.
    pub(super) fn point(&self, square: [f64; 2], inset: f64) -> DVec3 {
        let [x, y] = square.map(|x| (x - 0.5) * (1.0 - inset) + 0.5);
        match self {
            Self::Rectangle(flat) => flat.at([2.0 * x - 1.0, 2.0 * y - 1.0]),
            Self::Round { flat, .. } => flat.at(square_to_disk([x, y])),
            Self::Sky { position, up } => {
                let [x, y] = square_to_disk([x, y]);
                let (u, v) = up.any_orthonormal_pair();
                *position + u * x + v * y + *up * (1.0 - x * x - y * y).max(0.0).sqrt()
            }
            Self::Triangle { corners: [a, b, c], .. } => {
                let along = x.sqrt();
                *a + (*b - *a) * (along * (1.0 - y)) + (*c - *a) * (along * y)
            }
        }
    }

    /// Irradiance per area, up to a factor: cosines at both ends over the squared distance.
    pub(super) fn density(&self, point: DVec3, receiver: &Receiver) -> f64 {
        if let Self::Sky { .. } = self {
            return 1.0;
        }
        let way = point - receiver.position;
        let squared = way.length_squared();
        let at_receiver = way.dot(receiver.normal).max(0.0);
        let at_light = -way.dot(self.normal());
        if way.dot(receiver.geometric) <= 0.0 {
            return 0.0;
        }
        if squared > 0.0 { at_receiver * at_light.max(0.0) / (squared * squared) } else { 0.0 }
    }

    /// Whether the receiver sees one of its points, of which `is_hidden` tells if something is before it.
    fn sees_if(&self, point: DVec3, receiver: &Receiver, is_hidden: impl FnOnce(DVec3) -> bool) -> Sight {
        let way = point - receiver.position;
        if way.dot(receiver.normal) <= 0.0 || way.dot(receiver.geometric) <= 0.0 {
            Sight::BelowHorizon
        } else if is_hidden(way) {
            Sight::Blocked
        } else {
            Sight::Visible
        }
    }

    /// Whether the receiver sees one of its points, by a shadow ray.
    pub(super) fn sees(&self, point: DVec3, primitive: u32, receiver: &Receiver, world: &World) -> Sight {
        self.sees_if(point, receiver, |way| self.is_hidden(point, way, primitive, receiver, world))
    }

    fn is_hidden(&self, point: DVec3, way: DVec3, primitive: u32, receiver: &Receiver, world: &World) -> bool {
        let target = match self {
            Self::Sky { .. } => {
                return world.occluded_direction(&receiver.point, single(way));
            }
            Self::Round { sphere: Some((centre, radius)), .. } => {
                let direction = way.normalize_or_zero();
                let to_centre = *centre - receiver.position;
                let along = to_centre.dot(direction);
                let across = (to_centre - direction * along).length_squared();
                let entry = receiver.position + direction * (along - (radius * radius - across).max(0.0).sqrt());
                SurfacePoint::new(single(entry), single((entry - *centre).normalize_or_zero()))
            }
            _ => SurfacePoint::new(single(point), single(self.normal())).on(primitive),
        };
        world.occluded(&receiver.point, &target)
    }
}

/// How it is found out whether something is before a point of a light.
#[derive(Clone, Copy)]
pub(super) enum Shadows<'s> {
    /// Nothing is, for certain.
    None,
    /// What is in these cones is hidden.
    Cones(&'s Cones),
    /// By rays.
    Rays,
}

/// A light as one receiver sees it, point by point.
pub(super) struct Lattice<'w> {
    world: &'w World,
    receiver: &'w Receiver,
    panel: Panel,
    primitive: u32,
    shadows: Shadows<'w>,
    known: [[Option<Sight>; LATTICE]; LATTICE],
    /// The sum of all parts' weights, and of those that are visible.
    total: f64,
    visible: f64,
}

impl<'w> Lattice<'w> {
    /// The lattice on a light that the receiver is before.
    pub(super) fn new(world: &'w World, receiver: &'w Receiver, source: &Source, shadows: Shadows<'w>) -> Self {
        Self {
            world,
            receiver,
            panel: Panel::new(&source.shape, receiver.position),
            primitive: source.primitive,
            shadows,
            known: [[None; LATTICE]; LATTICE],
            total: 0.0,
            visible: 0.0,
        }
    }

    /// Calls `parts` with middle, weight and visible share of the light's parts, at least 4^`least`, and returns the visible share of
    /// all.
    pub(super) fn share(&mut self, least: u32, parts: &mut dyn FnMut(DVec3, f64, f64)) -> f64 {
        let start = self.start_level().max(least);
        self.cell(0, 0, 0, start, parts);
        // Exactly 1 where all of the lattice is visible.
        if self.total > 0.0 { self.visible / self.total } else { 0.0 }
    }

    /// The coarsest lattice that is asked for visibility: its cells look at most half as wide as they are far.
    fn start_level(&self) -> u32 {
        let distance = (self.panel.middle() - self.receiver.position).length();
        let mut level = 0;
        let mut cell = self.panel.size();
        while cell > 0.5 * distance && level < 2 {
            cell /= 2.0;
            level += 1;
        }
        level
    }

    /// Visibility at a lattice point, asked for once.
    fn sight(&mut self, column: usize, row: usize) -> Sight {
        if matches!(self.shadows, Shadows::None) {
            return Sight::Visible;
        }
        if let Some(known) = self.known[row][column] {
            return known;
        }
        let last = f64::from(1_u32 << MAX_LEVEL);
        #[allow(clippy::cast_precision_loss, reason = "at most 16")]
        let square = [column as f64 / last, row as f64 / last];
        let (panel, point, receiver) = (&self.panel, self.panel.point(square, INSET), self.receiver);
        let seen = match self.shadows {
            Shadows::Cones(cones) => panel.sees_if(point, receiver, |way| cones.hide(way)),
            _ => panel.sees(point, self.primitive, receiver, self.world),
        };
        self.known[row][column] = Some(seen);
        seen
    }

    /// Adds a cell of the lattice: whole where its corners and middle agree, in quarters where they don't.
    fn cell(&mut self, level: u32, column: usize, row: usize, least: u32, parts: &mut dyn FnMut(DVec3, f64, f64)) {
        let width = 1_usize << (MAX_LEVEL - level);
        let corners = [(0, 0), (width, 0), (0, width), (width, width)];
        if level < least {
            return self.quarters(level, column, row, least, parts);
        }
        let sights = corners.map(|(x, y)| self.sight(column + x, row + y));
        let half = width / 2;
        let inside = if half == 0 { None } else { Some(self.sight(column + half, row + half)) };
        let count = |sight| sights.iter().filter(|s| **s == sight).count();
        // What is below the horizon neither lights nor is blocked: the closed form leaves it out.
        let (visible, blocked) = (count(Sight::Visible), count(Sight::Blocked));
        let agrees = match inside {
            None => true,
            Some(Sight::Visible) => blocked == 0,
            Some(Sight::Blocked) => visible == 0,
            Some(Sight::BelowHorizon) => visible + blocked == 0,
        };
        let uniform = (visible == 0 || blocked == 0) && agrees;
        if !uniform && level < MAX_LEVEL {
            return self.quarters(level, column, row, least, parts);
        }
        let last = f64::from(1_u32 << MAX_LEVEL);
        #[allow(clippy::cast_precision_loss, reason = "at most 16")]
        let [x, y] = [column, row].map(|c| (c as f64 + width as f64 / 2.0) / last);
        let middle = self.panel.point([x, y], INSET);
        let side = f64::from(1_u32 << level);
        let weight = self.panel.density(middle, self.receiver) / (side * side);
        #[allow(clippy::cast_precision_loss, reason = "at most 4")]
        let share = if visible == 0 { 0.0 } else { visible as f64 / (visible + blocked) as f64 };
        self.total += weight;
        self.visible += weight * share;
        parts(middle, weight, share);
    }

    fn quarters(&mut self, level: u32, column: usize, row: usize, least: u32, parts: &mut dyn FnMut(DVec3, f64, f64)) {
        let half = 1_usize << (MAX_LEVEL - level - 1);
        for (x, y) in [(0, 0), (half, 0), (0, half), (half, half)] {
            self.cell(level + 1, column + x, row + y, least, parts);
        }
    }
}
