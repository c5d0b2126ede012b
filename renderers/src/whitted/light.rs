//! Direct light: exact where nothing blocks, subdivided where something does.

use disk_sampling::{polygon_configuration_factor, square_to_disk};
use glam::{DVec3, Vec3A};

use crate::geometry::{SurfacePoint, World};
use crate::luminaire::PlacedLuminaire;
use crate::spectral::Factor;

/// The finest lattice of points on a light at which visibility is asked for: 16 × 16 cells.
const MAX_LEVEL: u32 = 4;
const LATTICE: usize = (1 << MAX_LEVEL) + 1;
/// Corners of the polygon of equal area that stands for a disk in closed forms: its configuration factor is within
/// 3·10⁻⁴ of the disk's wherever the disk is above the horizon and its distance is at least half its radius.
const DISK_CORNERS: usize = 48;
/// How far inside its edge a light is asked for visibility: a share of its size.
const INSET: f64 = 1e-3;

/// A light.
#[derive(Clone, Debug)]
pub(super) enum Light {
    /// A flat light, or a spherical one, which looks like a disk from everywhere.
    Area(AreaLight),
    /// A point light: intensity.
    Point { position: DVec3, intensity: Factor },
    /// A point light by its distribution: intensity for each candela.
    Luminaire { luminaire: PlacedLuminaire, intensity: Factor },
    /// Parallel light along a unit vector: irradiance on a plane across it.
    Directional { direction: DVec3, irradiance: Factor },
}

/// A light with an area.
#[derive(Clone, Debug)]
pub(super) struct AreaLight {
    pub(super) shape: AreaShape,
    pub(super) radiance: Factor,
    /// The light's own primitive, which doesn't block it.
    pub(super) primitive: u32,
}

/// The shape of a light.
#[derive(Clone, Copy, Debug)]
pub(super) enum AreaShape {
    Rectangle(Flat),
    Disk(Flat),
    Sphere { centre: DVec3, radius: f64 },
}

/// A flat shape `centre` + x `u` + y `v`; the front is where `normal` points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flat {
    pub(super) centre: DVec3,
    pub(super) u: DVec3,
    pub(super) v: DVec3,
    pub(super) normal: DVec3,
}

/// Direct light from one part of a light on a surface, where it is visible.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    /// The direction to the part, a unit vector.
    pub(super) direction: DVec3,
    /// Irradiance divided by the light's radiance (by its intensity or irradiance for lights without area).
    pub(super) irradiance: f64,
}

/// A surface element that receives light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Receiver {
    pub(super) point: SurfacePoint,
    pub(super) position: DVec3,
    /// The unit shading normal on the side that is seen.
    pub(super) normal: DVec3,
    /// The unit geometric normal on the side that is seen.
    pub(super) geometric: DVec3,
}

impl Flat {
    pub(super) fn at(&self, [x, y]: [f64; 2]) -> DVec3 {
        self.centre + self.u * x + self.v * y
    }
}

/// What a light looks like from one receiver.
#[derive(Clone, Copy)]
struct Outline {
    flat: Flat,
    round: bool,
    /// A sphere that the flat shape stands for.
    sphere: Option<(DVec3, f64)>,
}

/// How a receiver sees a point of a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sight {
    Visible,
    Blocked,
    BelowHorizon,
}

/// A light as one receiver sees it: a flat shape and how lattice points map to it.
struct View<'w> {
    world: &'w World,
    receiver: &'w Receiver,
    flat: Flat,
    round: bool,
    /// A sphere that the flat shape stands for.
    sphere: Option<(DVec3, f64)>,
    primitive: u32,
    /// Whether all of the light is known to be visible.
    clear: bool,
    known: [[Option<Sight>; LATTICE]; LATTICE],
    total: f64,
    visible: f64,
}

impl View<'_> {
    /// The point of the light for a point of the unit square.
    fn point(&self, square: [f64; 2]) -> DVec3 {
        let inset = |x: f64| (x - 0.5) * (1.0 - INSET) + 0.5;
        let [x, y] = square.map(inset);
        if self.round { self.flat.at(square_to_disk([x, y])) } else { self.flat.at([2.0 * x - 1.0, 2.0 * y - 1.0]) }
    }

    /// Irradiance per area, up to a factor: cosines at both ends over the squared distance.
    fn density(&self, point: DVec3) -> f64 {
        let way = point - self.receiver.position;
        let squared = way.length_squared();
        let at_receiver = way.dot(self.receiver.normal).max(0.0);
        let at_light = -way.dot(self.flat.normal);
        if squared > 0.0 { at_receiver * at_light.max(0.0) / (squared * squared) } else { 0.0 }
    }

    fn sees(&self, point: DVec3) -> Sight {
        let way = point - self.receiver.position;
        if way.dot(self.receiver.normal) <= 0.0 {
            return Sight::BelowHorizon;
        }
        if way.dot(self.receiver.geometric) <= 0.0 {
            return Sight::Blocked;
        }
        let target = match self.sphere {
            None => SurfacePoint::new(single(point), single(self.flat.normal)).on(self.primitive),
            Some((centre, radius)) => {
                let direction = way.normalize_or_zero();
                let to_centre = centre - self.receiver.position;
                let along = to_centre.dot(direction);
                let across = (to_centre - direction * along).length_squared();
                let entry = self.receiver.position + direction * (along - (radius * radius - across).max(0.0).sqrt());
                SurfacePoint::new(single(entry), single((entry - centre).normalize_or_zero()))
            }
        };
        if self.world.occluded(&self.receiver.point, &target) { Sight::Blocked } else { Sight::Visible }
    }

    /// Visibility at a lattice point, asked for once.
    fn lattice(&mut self, column: usize, row: usize) -> Sight {
        if self.clear {
            return Sight::Visible;
        }
        if let Some(known) = self.known[row][column] {
            return known;
        }
        let last = f64::from(1_u32 << MAX_LEVEL);
        #[allow(clippy::cast_precision_loss, reason = "at most 16")]
        let square = [column as f64 / last, row as f64 / last];
        let seen = self.sees(self.point(square));
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
        let sights = corners.map(|(x, y)| self.lattice(column + x, row + y));
        let half = width / 2;
        let inside = if half == 0 { None } else { Some(self.lattice(column + half, row + half)) };
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
        let middle = self.point([x, y]);
        let side = f64::from(1_u32 << level);
        let weight = self.density(middle) / (side * side);
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

/// Irradiance over π times radiance if nothing blocks, in closed form.
fn unblocked(flat: &Flat, round: bool, receiver: &Receiver) -> f64 {
    let (position, normal) = (receiver.position.to_array(), receiver.normal.to_array());
    let factor = |corners: &[[f64; 3]]| polygon_configuration_factor(position, normal, corners);
    if round {
        // The regular polygon with the disk's area.
        #[allow(clippy::cast_precision_loss, reason = "a small constant")]
        let step = core::f64::consts::TAU / DISK_CORNERS as f64;
        let radius = (step / step.sin()).sqrt();
        let mut angle = 0.0_f64;
        let corners: [[f64; 3]; DISK_CORNERS] = core::array::from_fn(|_| {
            angle += step;
            flat.at([radius * angle.cos(), radius * angle.sin()]).to_array()
        });
        factor(&corners)
    } else {
        factor(&[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|c| flat.at(c).to_array()))
    }
}

impl AreaLight {
    /// The light's shape as the receiver sees it: flat, with the sphere it stands for.
    fn flat(&self, receiver: &Receiver) -> Option<Outline> {
        match self.shape {
            AreaShape::Rectangle(flat) => Some(Outline { flat, round: false, sphere: None }),
            AreaShape::Disk(flat) => Some(Outline { flat, round: true, sphere: None }),
            AreaShape::Sphere { centre, radius } => {
                // The disk of the sphere's visible cap fills the same cone.
                let way = receiver.position - centre;
                let distance = way.length();
                if distance <= radius {
                    return None;
                }
                let normal = way / distance;
                let seen = radius * (1.0 - (radius / distance).powi(2)).sqrt();
                let (u, v) = normal.any_orthonormal_pair();
                let middle = centre + normal * (radius * radius / distance);
                let flat = Flat { centre: middle, u: u * seen, v: v * seen, normal };
                Some(Outline { flat, round: true, sphere: Some((centre, radius)) })
            }
        }
    }

    /// Calls `receive` for each visible part of the light. The parts' irradiances add up to the closed form where nothing blocks, and
    /// to its visible share (the ratio estimator) elsewhere. At least 4^`least` parts are made. `is_clear` tells whether nothing
    /// blocks for certain; then no shadow rays are needed.
    pub(super) fn illuminate(
        &self,
        world: &World,
        receiver: &Receiver,
        least: u32,
        is_clear: impl FnOnce() -> bool,
        mut receive: impl FnMut(Part),
    ) {
        let Some(Outline { flat, round, sphere }) = self.flat(receiver) else { return };
        if (receiver.position - flat.centre).dot(flat.normal) <= 0.0 {
            return;
        }
        let exact = core::f64::consts::PI * unblocked(&flat, round, receiver);
        if exact <= 0.0 {
            return;
        }
        let clear = is_clear();
        if clear && least == 0 {
            let direction = (flat.centre - receiver.position).normalize_or_zero();
            receive(Part { direction, irradiance: exact });
            return;
        }
        let mut view = View {
            world,
            receiver,
            flat,
            round,
            sphere,
            primitive: self.primitive,
            clear,
            known: [[None; LATTICE]; LATTICE],
            total: 0.0,
            visible: 0.0,
        };
        let start = start_level(&flat, receiver).max(least);
        if least == 0 {
            view.cell(0, 0, 0, start, &mut |_, _, _| {});
            if view.total > 0.0 && view.visible > 0.0 {
                let direction = (flat.centre - receiver.position).normalize_or_zero();
                // The share is exactly 1 where all of the lattice is visible.
                receive(Part { direction, irradiance: exact * (view.visible / view.total) });
            }
            return;
        }
        let mut parts = Vec::new();
        view.cell(0, 0, 0, start, &mut |point, weight, share| parts.push((point, weight * share)));
        if view.total > 0.0 {
            let scale = exact / view.total;
            for (point, weight) in parts.into_iter().filter(|(_, weight)| *weight > 0.0) {
                let direction = (point - receiver.position).normalize_or_zero();
                receive(Part { direction, irradiance: scale * weight });
            }
        }
    }
}

/// The coarsest lattice that is asked for visibility: its cells look at most half as wide as they are far.
fn start_level(flat: &Flat, receiver: &Receiver) -> u32 {
    let size = 2.0 * flat.u.length().max(flat.v.length());
    let distance = (flat.centre - receiver.position).length();
    let mut level = 0;
    let mut cell = size;
    while cell > 0.5 * distance && level < 2 {
        cell /= 2.0;
        level += 1;
    }
    level
}

impl Light {
    /// The factor of the light's spectrum.
    pub(super) const fn factor(&self) -> Factor {
        match self {
            Self::Area(area) => area.radiance,
            Self::Point { intensity, .. } | Self::Luminaire { intensity, .. } => *intensity,
            Self::Directional { irradiance, .. } => *irradiance,
        }
    }

    /// Calls `receive` for each visible part of the light; `is_clear` tells whether nothing blocks for certain.
    pub(super) fn illuminate(
        &self,
        world: &World,
        receiver: &Receiver,
        least: u32,
        is_clear: impl FnOnce() -> bool,
        mut receive: impl FnMut(Part),
    ) {
        match self {
            Self::Area(area) => area.illuminate(world, receiver, least, is_clear, receive),
            Self::Point { position, .. } => from_point(world, receiver, *position, |_| 1.0, receive),
            Self::Luminaire { luminaire, .. } => {
                from_point(world, receiver, luminaire.position, |direction| luminaire.candela(direction), receive);
            }
            Self::Directional { direction, .. } => {
                let towards = -*direction;
                let cosine = towards.dot(receiver.normal);
                let above = cosine > 0.0 && towards.dot(receiver.geometric) > 0.0;
                if above && !world.occluded_direction(&receiver.point, single(towards)) {
                    receive(Part { direction: towards, irradiance: cosine });
                }
            }
        }
    }
}

/// Light from a point of this intensity in the direction of travel.
fn from_point(
    world: &World,
    receiver: &Receiver,
    position: DVec3,
    intensity: impl FnOnce(DVec3) -> f64,
    mut receive: impl FnMut(Part),
) {
    let way = position - receiver.position;
    let squared = way.length_squared();
    let direction = way / squared.sqrt();
    let cosine = direction.dot(receiver.normal);
    let above = cosine > 0.0 && direction.dot(receiver.geometric) > 0.0;
    if above && !world.occluded_point(&receiver.point, single(position)) {
        receive(Part { direction, irradiance: intensity(-direction) * cosine / squared });
    }
}

/// The vector in the precision of rays.
pub(super) fn single(v: DVec3) -> Vec3A {
    v.as_vec3a()
}
