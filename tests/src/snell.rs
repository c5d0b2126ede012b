//! Closed forms of geometrical optics, `independent` oracles for refraction: prisms, plane-parallel plates, and lenses bounded by a sphere.
//!
//! Angles are in radians, lengths in one unit of the caller's, indices relative to the medium around. Light is unpolarised at every boundary, as
//! in the renderers: the reflectance is the mean of both polarisations each time anew, so that shares of light that passes several
//! boundaries are products of these means ([`Plate::transmitted_polarised`] has the other way, which real light goes). Boundaries are
//! smooth, media clear unless they say otherwise.

use core::f64::consts::{FRAC_PI_2, PI};

use crate::quadrature::integrate;

/// Reflectance of a boundary for light polarised across and along the plane of incidence, by Fresnel's formulae; 1 where all is reflected.
/// `index` is that behind the boundary relative to that before it.
#[must_use]
pub fn reflectances(incidence: f64, index: f64) -> [f64; 2] {
    let Some(refraction) = refracted(incidence, index) else { return [1.0; 2] };
    let (before, behind) = (incidence.cos(), refraction.cos());
    let across = (before - index * behind) / (before + index * behind);
    let along = (index * before - behind) / (index * before + behind);
    [across * across, along * along]
}

/// The mean of both polarisations' [`reflectances`].
#[must_use]
pub fn reflectance(incidence: f64, index: f64) -> f64 {
    let [across, along] = reflectances(incidence, index);
    (across + along) / 2.0
}

/// The angle of refraction by Snell's law, with the sign of the angle of incidence; `None` where all is reflected.
#[must_use]
pub fn refracted(incidence: f64, index: f64) -> Option<f64> {
    let sine = incidence.sin() / index;
    (sine.abs() <= 1.0).then(|| sine.asin())
}

/// A plane-parallel plate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plate {
    /// Distance of its faces.
    pub thickness: f64,
    /// Its index.
    pub index: f64,
    /// Absorption coefficient: exp(−a s) remains after a way s.
    pub absorption: f64,
}

impl Plate {
    /// How far light that passes is moved aside, across its direction, by its first passage: d sin θ (1 − cos θ / (n cos θ′)).
    #[must_use]
    pub fn shift(&self, incidence: f64) -> f64 {
        let inside = (incidence.sin() / self.index).asin();
        self.thickness * incidence.sin() * (1.0 - incidence.cos() / (self.index * inside.cos()))
    }

    /// The share that remains of light after one way through.
    fn remaining(&self, incidence: f64) -> f64 {
        let inside = (incidence.sin() / self.index).asin();
        (-self.absorption * self.thickness / inside.cos()).exp()
    }

    /// The shares of light that pass in the end and come back in the end, after all inner reflections: with the boundary's reflectance R
    /// and the share τ that remains after a way through, (1 − R)² τ / (1 − R² τ²) and R + R (1 − R)² τ² / (1 − R² τ²). For a clear plate the
    /// first is (1 − R) / (1 + R).
    #[must_use]
    pub fn shares(&self, incidence: f64) -> [f64; 2] {
        Self::series(reflectance(incidence, self.index), self.remaining(incidence))
    }

    /// The share that passes if each polarisation keeps to itself: the mean of both [`shares`](Self::shares).
    #[must_use]
    pub fn transmitted_polarised(&self, incidence: f64) -> f64 {
        let remaining = self.remaining(incidence);
        reflectances(incidence, self.index).map(|r| Self::series(r, remaining)[0]).iter().sum::<f64>() / 2.0
    }

    fn series(reflectance: f64, remaining: f64) -> [f64; 2] {
        let through = 1.0 - reflectance;
        let round = 1.0 - (reflectance * remaining).powi(2);
        let passes = through * through * remaining / round;
        [passes, reflectance * (1.0 + passes * remaining)]
    }
}

/// A prism in its principal section: the refracting edge is at the origin, the faces go down from there symmetrically to the y axis, and light
/// comes from the left through the left face and leaves through the right one.
///
/// Angles of incidence are positive for light that comes from the base's side of the face's normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prism {
    /// The angle between the faces.
    pub apex: f64,
    /// Its index.
    pub index: f64,
}

/// What becomes of a ray through a prism.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dispersed {
    /// Where it leaves: how far from the edge along the right face.
    pub exit: f64,
    /// The angle of its direction to the x axis, upwards.
    pub direction: f64,
    /// The share of the light that passes both boundaries, without any inner reflection.
    pub share: f64,
}

impl Prism {
    /// The angle by which light is turned towards the base, i₁ + i₂ − A with sin i₂ = n sin(A − asin(sin i₁ / n)); `None` if it is totally
    /// reflected at the second face.
    #[must_use]
    pub fn deviation(&self, incidence: f64) -> Option<f64> {
        let first = refracted(incidence, self.index)?;
        Some(incidence + refracted(self.apex - first, 1.0 / self.index)? - self.apex)
    }

    /// The least deviation, 2 asin(n sin(A/2)) − A, and the angle of incidence that has it; `None` if nothing passes.
    #[must_use]
    pub fn least_deviation(&self) -> Option<[f64; 2]> {
        let incidence = refracted(self.apex / 2.0, 1.0 / self.index)?;
        Some([2.0 * incidence - self.apex, incidence])
    }

    /// A ray that meets the left face at distance `entry` from the edge, with this angle of incidence; `None` if it doesn't leave through the
    /// right face, which is taken as endless.
    #[must_use]
    pub fn ray(&self, entry: f64, incidence: f64) -> Option<Dispersed> {
        let first = refracted(incidence, self.index)?;
        let second = self.apex - first;
        let deviation = self.deviation(incidence)?;
        // The law of sines in the triangle of edge, entry and exit.
        let exit = entry * first.cos() / second.cos();
        let share = (1.0 - reflectance(incidence, self.index)) * (1.0 - reflectance(second.abs(), 1.0 / self.index));
        Some(Dispersed { exit, direction: incidence - self.apex / 2.0 - deviation, share })
    }

    /// The point of the left (−1) or right (1) face at a distance from the edge.
    #[must_use]
    pub fn face(&self, side: f64, distance: f64) -> [f64; 2] {
        let (sin, cos) = (self.apex / 2.0).sin_cos();
        [side * sin * distance, -cos * distance]
    }

    /// The height y at which a ray meets the plane x = `plane` behind the prism; `None` if it doesn't.
    #[must_use]
    pub fn height(&self, entry: f64, incidence: f64, plane: f64) -> Option<f64> {
        let ray = self.ray(entry, incidence)?;
        let [x, y] = self.face(1.0, ray.exit);
        (ray.direction.cos() > 0.0 && plane >= x).then(|| y + ray.direction.tan() * (plane - x))
    }
}

/// A lens with a spherical face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lens {
    /// A full sphere.
    Ball,
    /// A hemisphere whose round face is towards the light.
    RoundFirst,
    /// A hemisphere whose flat face is towards the light.
    FlatFirst,
}

/// Which way light goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Reflected from outside by the round face that light meets first.
    Reflected,
    /// Through the lens, with so many inner reflections. Hemispheres have the way without any alone.
    Through(u32),
}

/// Parallel light of irradiance 1 along the axis, through a lens onto a screen across the axis.
///
/// Rays are told apart by the angle i in [0, π/2] with the height sin i times the radius above the axis, which for the round face first is the
/// angle of incidence. Everything is exact: rays are traced in the meridional plane by trigonometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Focus {
    /// The lens, with the sphere's centre at the origin of the axis.
    pub lens: Lens,
    /// The sphere's radius.
    pub radius: f64,
    /// The index.
    pub index: f64,
    /// How far behind the sphere's centre the screen is; at least the radius.
    pub distance: f64,
}

/// Where a ray meets the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Height above the axis; negative if the ray has crossed it.
    pub height: f64,
    /// Its derivative by the ray's angle.
    pub slope: f64,
    /// The share of the light that goes this way.
    pub share: f64,
}

/// A ray behind the lens, in the meridional plane.
struct Outgoing {
    /// A point of it along the axis and above it, with derivatives by the angle i.
    place: [f64; 2],
    place_slope: [f64; 2],
    /// The angle by which it goes down towards the axis, and its derivative.
    turned: f64,
    turned_slope: f64,
    share: f64,
}

/// Cells in which roots are looked for.
const CELLS: u32 = 2048;
/// Of the quadrature.
const TOLERANCE: f64 = 1e-10;

impl Focus {
    /// Where the ray of angle i meets the screen; `None` if it doesn't or no light goes this way.
    #[must_use]
    pub fn spot(&self, way: Way, angle: f64) -> Option<Spot> {
        let ray = match (self.lens, way) {
            (Lens::Ball | Lens::RoundFirst, Way::Reflected) => self.reflected(angle),
            (Lens::Ball, Way::Through(inner)) => self.through_ball(angle, inner)?,
            (Lens::RoundFirst, Way::Through(0)) => self.round_first(angle)?,
            (Lens::FlatFirst, Way::Through(0)) => self.flat_first(angle)?,
            _ => return None,
        };
        let cosine = ray.turned.cos();
        let ahead = self.distance - ray.place[0];
        if cosine <= 0.0 || ahead < 0.0 {
            return None;
        }
        let tangent = ray.turned.tan();
        Some(Spot {
            height: ray.place[1] - tangent * ahead,
            slope: ray.place_slope[1] - ray.turned_slope * ahead / (cosine * cosine) + tangent * ray.place_slope[0],
            share: ray.share,
        })
    }

    /// A point of the sphere at an angle from the side that the light comes from, and its derivative where the angle's is `slope`.
    fn on_sphere(&self, angle: f64, slope: f64) -> [[f64; 2]; 2] {
        let (sin, cos) = angle.sin_cos();
        [[-self.radius * cos, self.radius * sin], [self.radius * sin * slope, self.radius * cos * slope]]
    }

    fn reflected(&self, angle: f64) -> Outgoing {
        let [place, place_slope] = self.on_sphere(angle, 1.0);
        let share = reflectance(angle, self.index);
        Outgoing { place, place_slope, turned: 2.0 * angle - PI, turned_slope: 2.0, share }
    }

    /// The angle of refraction and its derivative.
    fn inside(&self, angle: f64) -> Option<[f64; 2]> {
        let refraction = refracted(angle, self.index)?;
        Some([refraction, angle.cos() / (self.index * refraction.cos())])
    }

    /// Each chord takes the ray on by π − 2r around the centre, and each inner reflection turns it by as much.
    fn through_ball(&self, angle: f64, inner: u32) -> Option<Outgoing> {
        let [refraction, slope] = self.inside(angle)?;
        let inner = f64::from(inner);
        let chord = PI - 2.0 * refraction;
        let [place, place_slope] = self.on_sphere(angle + (inner + 1.0) * chord, 1.0 - 2.0 * (inner + 1.0) * slope);
        let reflected = reflectance(angle, self.index);
        Some(Outgoing {
            place,
            place_slope,
            // Taken into (−π, π], so that tangents of large angles lose nothing.
            turned: remainder(2.0 * (angle - refraction) + inner * chord),
            turned_slope: 2.0 * (1.0 - slope) - 2.0 * inner * slope,
            share: (1.0 - reflected).powi(2) * reflected.powf(inner),
        })
    }

    fn round_first(&self, angle: f64) -> Option<Outgoing> {
        let [refraction, slope] = self.inside(angle)?;
        let (down, down_slope) = (angle - refraction, 1.0 - slope);
        let turned = refracted(down, 1.0 / self.index)?;
        let [[z, height], [z_slope, height_slope]] = self.on_sphere(angle, 1.0);
        let (tangent, cosine) = (down.tan(), down.cos());
        Some(Outgoing {
            place: [0.0, height + tangent * z],
            place_slope: [0.0, height_slope + tangent * z_slope + down_slope * z / (cosine * cosine)],
            turned,
            turned_slope: self.index * cosine * down_slope / turned.cos(),
            share: (1.0 - reflectance(angle, self.index)) * (1.0 - reflectance(down, 1.0 / self.index)),
        })
    }

    fn flat_first(&self, angle: f64) -> Option<Outgoing> {
        let leaving = refracted(angle, 1.0 / self.index)?;
        let [place, place_slope] = self.on_sphere(PI - angle, -1.0);
        Some(Outgoing {
            place,
            place_slope,
            turned: leaving - angle,
            turned_slope: self.index * angle.cos() / leaving.cos() - 1.0,
            share: (1.0 - reflectance(0.0, self.index)) * (1.0 - reflectance(angle, 1.0 / self.index)),
        })
    }

    /// Angles between which the distance from the axis is monotonous: the ends of equal cells, and where it turns.
    fn nodes(&self, way: Way) -> Vec<f64> {
        let at = |cell: u32| FRAC_PI_2 * f64::from(cell) / f64::from(CELLS);
        let rising = |spot: Spot| spot.height * spot.slope > 0.0;
        let mut nodes = vec![0.0];
        for cell in 0..CELLS {
            let [from, to] = [at(cell), at(cell + 1)];
            nodes.extend(self.change(way, [from, to], rising));
            nodes.push(to);
        }
        nodes
    }

    /// Where between two angles a property of the spot changes, if it isn't the same at both; no spot has the property.
    fn change(&self, way: Way, [mut low, mut high]: [f64; 2], property: impl Fn(Spot) -> bool) -> Option<f64> {
        let has = |angle: f64| self.spot(way, angle).is_some_and(&property);
        let first = has(low);
        if has(high) == first {
            return None;
        }
        loop {
            let middle = f64::midpoint(low, high);
            if middle <= low || middle >= high {
                return Some(middle);
            }
            if has(middle) == first { low = middle } else { high = middle }
        }
    }

    /// The flux within a distance of the axis on the screen: ∫ share 2π h dh over the rays that end there, to 10⁻⁹ of it.
    #[must_use]
    pub fn flux(&self, way: Way, within: f64) -> f64 {
        let inside = |spot: Spot| spot.height.abs() <= within;
        let nodes = self.nodes(way);
        let mut ends = vec![0.0];
        for pair in nodes.windows(2) {
            ends.extend(self.change(way, [pair[0], pair[1]], inside));
        }
        ends.push(FRAC_PI_2);
        let share = |angle: f64| {
            let spot = self.spot(way, angle).filter(|spot| inside(*spot));
            spot.map_or(0.0, |spot| spot.share * angle.sin() * angle.cos())
        };
        let parts = ends.windows(2).filter(|p| self.spot(way, f64::midpoint(p[0], p[1])).is_some_and(inside));
        2.0 * PI * self.radius.powi(2) * parts.map(|p| integrate(&share, p[0], p[1], TOLERANCE)).sum::<f64>()
    }

    /// The irradiance at a distance r > 0 from the axis, relative to that of the beam: Σ share |h dh / (r dr)| over the rays that end there.
    #[must_use]
    pub fn irradiance(&self, way: Way, at: f64) -> f64 {
        let nodes = self.nodes(way);
        let roots = nodes.windows(2).filter_map(|p| self.change(way, [p[0], p[1]], |s| s.height.abs() <= at));
        let light = |angle: f64| {
            // A ray whose end leaves the screen is no root.
            let spot = self.spot(way, angle).filter(|s| (s.height.abs() / at - 1.0).abs() <= 1e-6)?;
            Some(spot.share * self.radius.powi(2) * angle.sin() * angle.cos() / (at * spot.slope.abs()))
        };
        roots.filter_map(light).sum()
    }

    /// The distances from the axis where caustics are: where neighbouring rays meet the screen at the same distance, and irradiance is
    /// infinite.
    #[must_use]
    pub fn folds(&self, way: Way) -> Vec<f64> {
        let at = |cell: u32| FRAC_PI_2 * f64::from(cell) / f64::from(CELLS);
        let turns = (0..CELLS).filter_map(|cell| self.change(way, [at(cell), at(cell + 1)], |s| s.slope > 0.0));
        let fold = |angle: f64| self.spot(way, angle).filter(|s| s.slope.abs() <= 1e-6 * self.radius);
        turns.filter_map(fold).map(|spot| spot.height.abs()).collect()
    }
}

/// An angle in (−π, π].
fn remainder(angle: f64) -> f64 {
    angle - 2.0 * PI * (angle / (2.0 * PI)).round()
}
