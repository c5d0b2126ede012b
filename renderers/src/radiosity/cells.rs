//! Irradiance on surfaces, interpolated between places where it has been gathered.
//!
//! Surfaces are covered with triangles. Each of their edges is judged by itself: where the irradiance in its middle is far from the mean of
//! that at its ends, both its triangles are split there, so that neighbours always agree about their edge and what is interpolated is
//! continuous. The middles that were looked at serve twice: the interpolation is quadratic (six places a triangle). Which triangles are worth
//! it, the places that the camera sees tell; the cells are a function of these places alone, whatever the number of threads.

use std::collections::HashMap;

use glam::DVec3;
use rayon::prelude::*;

/// None.
const NONE: u32 = u32::MAX;
/// Generations of triangles.
pub(super) const GENERATIONS: usize = 24;
/// Triangles with fewer places that the camera sees are not split, nor are triangles that start with fewer interpolated.
const FEW: usize = 3;

/// A surface that irradiance is interpolated on.
#[derive(Clone, Debug)]
pub(super) struct Chart {
    /// Corners of the convex polygons that it is made of, anticlockwise as seen from the side that receives; each with the primitive,
    /// among those of the solution, that it is a part of.
    pub(super) polygons: Vec<(Vec<DVec3>, u32)>,
    /// A point behind all of them.
    pub(super) apex: DVec3,
    pub(super) form: Form,
}

/// How a chart is bent.
#[derive(Clone, Copy, Debug)]
pub(super) enum Form {
    /// Flat, with a normal.
    Flat(DVec3),
    /// Flat, with a normal at each corner of a triangle, between which normals are interpolated.
    Smooth([DVec3; 3], [DVec3; 3]),
    /// A sphere of this radius about the apex, with gathers at another distance; inside or outside.
    Sphere { radius: f64, reach: f64, inward: bool },
}

impl Form {
    /// The normal at a place.
    fn normal(&self, place: DVec3, apex: DVec3) -> DVec3 {
        match self {
            Self::Flat(normal) => *normal,
            Self::Smooth([a, b, c], normals) => {
                let whole = (*b - *a).cross(*c - *a);
                let share = |p: DVec3, q: DVec3| (p - place).cross(q - place).dot(whole);
                let [x, y, z] = [share(*b, *c), share(*c, *a), share(*a, *b)];
                (normals[0] * x + normals[1] * y + normals[2] * z).normalize_or(whole.normalize_or_zero())
            }
            Self::Sphere { inward, .. } => (place - apex).normalize_or_zero() * if *inward { -1.0 } else { 1.0 },
        }
    }

    /// The place on the surface that stands for one on a chord.
    fn on_surface(&self, place: DVec3, apex: DVec3) -> DVec3 {
        match self {
            Self::Sphere { radius, .. } => apex + (place - apex).normalize_or_zero() * *radius,
            Self::Flat(_) | Self::Smooth(..) => place,
        }
    }

    /// Where light is gathered, for a place on the surface and one a little off the edges of its polygon.
    fn gathered(&self, place: DVec3, inset: DVec3, apex: DVec3) -> DVec3 {
        match self {
            Self::Sphere { reach, .. } => apex + (place - apex).normalize_or_zero() * *reach,
            Self::Flat(_) | Self::Smooth(..) => inset,
        }
    }
}

/// What is asked for irradiance: it fills a row for a position, a normal and a primitive.
pub(crate) trait Gather: Sync {
    /// Numbers in a row.
    fn width(&self) -> usize;
    /// How many of them, the first ones, add up with any sign; the others bound errors.
    fn values(&self) -> usize;
    /// The irradiance at a place, and its tristimulus values.
    fn gather(&self, position: DVec3, normal: DVec3, primitive: u32, row: &mut [f64]) -> [f64; 3];
}

/// When cells are good enough.
#[derive(Clone, Copy, Debug)]
pub(super) struct Goal {
    /// The most that the middle of an edge may differ from the mean of its ends, as a share.
    pub(super) tolerance: f64,
    /// What is darker than this share of the mean counts as this bright.
    pub(super) floor: f64,
    /// The most places that the camera sees in one triangle, as a share of all.
    pub(super) crowd: f64,
}

#[derive(Clone, Copy, Debug)]
struct Vertex {
    position: DVec3,
    /// Where light is gathered for it: off the edges of its polygon.
    inset: DVec3,
    normal: DVec3,
    primitive: u32,
}

#[derive(Clone, Copy, Debug)]
struct Triangle {
    corners: [u32; 3],
    chart: u32,
    /// The first of its parts.
    children: u32,
    count: u32,
}

/// The cells of a scene's surfaces.
#[derive(Clone, Debug, Default)]
pub(super) struct Cells {
    width: usize,
    values: usize,
    apices: Vec<DVec3>,
    /// The triangles that each chart starts with.
    bases: Vec<core::ops::Range<u32>>,
    triangles: Vec<Triangle>,
    vertices: Vec<Vertex>,
    numbers: HashMap<[u64; 7], u32>,
    /// The vertex in the middle of an edge, by the edge's ends.
    middles: HashMap<[u32; 2], u32>,
    rows: Vec<f64>,
    colours: Vec<Option<[f64; 3]>>,
}

/// A place that the camera sees: its chart and position.
pub(super) type Seen = (u32, DVec3);

impl Cells {
    /// Makes cells for the places that the camera sees; `progress` is told after each generation of them.
    pub(super) fn new(
        charts: &[Chart],
        seen: &[Seen],
        goal: Goal,
        gather: &dyn Gather,
        progress: &dyn Fn(u64),
    ) -> Self {
        let mut cells = Self { width: gather.width(), values: gather.values(), ..Self::default() };
        for chart in charts {
            cells.add(chart);
        }
        let mut open = cells.assigned(seen);
        open.retain(|(number, places)| {
            let chart = cells.triangles[*number as usize].chart as usize;
            places.len() >= if matches!(charts[chart].form, Form::Smooth(..)) { 1 } else { FEW }
        });
        #[allow(clippy::cast_precision_loss, reason = "a count")]
        let crowd = goal.crowd * seen.len() as f64;
        for _ in 0..GENERATIONS {
            if open.is_empty() {
                break;
            }
            open = cells.refine(open, charts, seen, (goal, crowd), gather);
            progress(1);
        }
        cells.numbers = HashMap::new();
        cells
    }

    /// How many gathers were made.
    pub(super) fn gathers(&self) -> usize {
        self.colours.iter().flatten().count()
    }

    fn add(&mut self, chart: &Chart) {
        let from = self.count();
        let number = u32::try_from(self.apices.len()).unwrap_or(NONE);
        for (polygon, primitive) in &chart.polygons {
            #[allow(clippy::cast_precision_loss, reason = "corners are few")]
            let centre = polygon.iter().sum::<DVec3>() / polygon.len() as f64;
            let numbers: Vec<u32> =
                polygon.iter().map(|c| self.vertex(chart, *c, inset(*c, centre), *primitive)).collect();
            for pair in numbers.windows(2).skip(1) {
                let corners = [numbers[0], pair[0], pair[1]];
                self.triangles.push(Triangle { corners, chart: number, children: NONE, count: 0 });
            }
        }
        self.apices.push(chart.apex);
        self.bases.push(from..self.count());
    }

    fn count(&self) -> u32 {
        u32::try_from(self.triangles.len()).unwrap_or(NONE)
    }

    /// The number of a vertex; equal ones have one.
    fn vertex(&mut self, chart: &Chart, position: DVec3, inset: DVec3, primitive: u32) -> u32 {
        let position = chart.form.on_surface(position, chart.apex);
        let inset = chart.form.gathered(position, inset, chart.apex);
        let normal = chart.form.normal(position, chart.apex);
        let [x, y, z] = position.to_array().map(f64::to_bits);
        let (mark, owner) = match chart.form {
            // Triangles of a smooth mesh share vertices.
            Form::Smooth(..) => (normal, NONE),
            Form::Flat(_) | Form::Sphere { .. } => (inset, primitive),
        };
        let [u, v, w] = mark.to_array().map(f64::to_bits);
        let next = u32::try_from(self.vertices.len()).unwrap_or(NONE);
        let number = *self.numbers.entry([x, y, z, u, v, w, u64::from(owner)]).or_insert(next);
        if number == next {
            self.vertices.push(Vertex { position, inset, normal, primitive });
            self.rows.resize(self.vertices.len() * self.width, 0.0);
            self.colours.push(None);
        }
        number
    }

    /// The vertex in the middle of an edge.
    fn middle(&mut self, a: u32, b: u32, chart: &Chart) -> u32 {
        let key = [a.min(b), a.max(b)];
        if let Some(known) = self.middles.get(&key) {
            return *known;
        }
        let [a, b] = key.map(|n| self.vertices[n as usize]);
        let mean = |a: DVec3, b: DVec3| (a + b) / 2.0;
        let number = self.vertex(chart, mean(a.position, b.position), mean(a.inset, b.inset), a.primitive);
        self.middles.insert(key, number);
        number
    }

    /// Barycentric coordinates of a place in a triangle.
    fn weights(&self, triangle: &Triangle, place: DVec3) -> [f64; 3] {
        let apex = self.apices[triangle.chart as usize];
        let [a, b, c] = triangle.corners.map(|n| self.vertices[n as usize].position - apex);
        let x = place - apex;
        let parts = [x.dot(b.cross(c)), x.dot(c.cross(a)), x.dot(a.cross(b))];
        let sum: f64 = parts.iter().sum();
        parts.map(|p| p / sum)
    }

    /// Of some triangles the one that a place is in, or is the least outside of.
    fn best(&self, among: core::ops::Range<u32>, place: DVec3) -> Option<u32> {
        let mut best = None;
        let mut least = f64::NEG_INFINITY;
        for number in among {
            let weights = self.weights(&self.triangles[number as usize], place);
            let own = weights.into_iter().fold(f64::INFINITY, f64::min);
            if own > least {
                (best, least) = (Some(number), own);
                if own >= 0.0 {
                    break;
                }
            }
        }
        best
    }

    /// The places seen in each of the triangles that charts start with.
    fn assigned(&self, seen: &[Seen]) -> Vec<(u32, Vec<u32>)> {
        let mut places = vec![Vec::new(); self.triangles.len()];
        for (number, (chart, position)) in (0..).zip(seen) {
            if let Some(triangle) = self.best(self.bases[*chart as usize].clone(), *position) {
                places[triangle as usize].push(number);
            }
        }
        (0..).zip(places).collect()
    }

    /// One generation: gathers what is missing, splits where it must be, and returns the parts.
    fn refine(
        &mut self,
        open: Vec<(u32, Vec<u32>)>,
        charts: &[Chart],
        seen: &[Seen],
        (goal, crowd): (Goal, f64),
        gather: &dyn Gather,
    ) -> Vec<(u32, Vec<u32>)> {
        let mut wanted = Vec::new();
        for (number, places) in &open {
            let Triangle { corners, chart, .. } = self.triangles[*number as usize];
            wanted.extend(corners);
            for [a, b] in edges_of(corners) {
                if places.len() >= FEW {
                    let middle = self.middle(a, b, &charts[chart as usize]);
                    wanted.push(middle);
                }
            }
        }
        self.gather(wanted, gather);
        let mean = self.mean();
        let mut split: HashMap<[u32; 2], bool> = HashMap::new();
        for (number, places) in &open {
            let corners = self.triangles[*number as usize].corners;
            if places.len() < FEW {
                continue;
            }
            #[allow(clippy::cast_precision_loss, reason = "a count")]
            let crowded = places.len() as f64 > crowd;
            let longest = self.longest(corners);
            for (place, [a, b]) in edges_of(corners).into_iter().enumerate() {
                let key = [a.min(b), a.max(b)];
                let bent = self.error(key) > goal.tolerance * self.scale(key, goal.floor * mean);
                let must = bent || (crowded && place == longest);
                *split.entry(key).or_default() |= must;
            }
        }
        self.propagate(&open, &mut split, charts);
        let missing: Vec<u32> =
            split.iter().filter(|(_, must)| **must).filter_map(|(key, _)| self.middles.get(key).copied()).collect();
        self.gather(missing, gather);
        let mut next = Vec::new();
        for (number, places) in open {
            let corners = self.triangles[number as usize].corners;
            let flags = edges_of(corners).map(|[a, b]| split.get(&[a.min(b), a.max(b)]).copied().unwrap_or(false));
            if flags.contains(&true) {
                let from = self.split(number, flags);
                next.extend(self.shared(from, &places, seen));
            }
        }
        next
    }

    /// Splits the longest edge of each triangle that has any edge split, until nothing changes.
    fn propagate(&mut self, open: &[(u32, Vec<u32>)], split: &mut HashMap<[u32; 2], bool>, charts: &[Chart]) {
        loop {
            let mut changed = false;
            for (number, _) in open {
                let Triangle { corners, chart, .. } = self.triangles[*number as usize];
                let keys = edges_of(corners).map(|[a, b]| [a.min(b), a.max(b)]);
                let is_split = |key: &[u32; 2]| split.get(key).copied().unwrap_or(false);
                let longest = keys[self.longest(corners)];
                if keys.iter().any(is_split) && !is_split(&longest) {
                    split.insert(longest, true);
                    self.middle(longest[0], longest[1], &charts[chart as usize]);
                    changed = true;
                }
            }
            if !changed {
                return;
            }
        }
    }

    fn longest(&self, corners: [u32; 3]) -> usize {
        let length = |[a, b]: [u32; 2]| {
            (self.vertices[a as usize].position - self.vertices[b as usize].position).length_squared()
        };
        let lengths = edges_of(corners).map(length);
        // The first of equal ones, whatever their rounding.
        (1..3).fold(0, |best, i| if lengths[i] > lengths[best] * (1.0 + 1e-9) { i } else { best })
    }

    /// Gathers the light of vertices that have none yet.
    fn gather(&mut self, mut wanted: Vec<u32>, gather: &dyn Gather) {
        wanted.sort_unstable();
        wanted.dedup();
        wanted.retain(|n| self.colours[*n as usize].is_none());
        let width = self.width;
        let found: Vec<(Vec<f64>, [f64; 3])> = wanted
            .par_iter()
            .map(|number| {
                let vertex = &self.vertices[*number as usize];
                let mut row = vec![0.0; width];
                let colour = gather.gather(vertex.inset, vertex.normal, vertex.primitive, &mut row);
                (row, colour)
            })
            .collect();
        for (number, (row, colour)) in wanted.into_iter().zip(found) {
            self.rows[number as usize * width..][..width].copy_from_slice(&row);
            self.colours[number as usize] = Some(colour);
        }
    }

    /// The mean luminous irradiance over the vertices.
    fn mean(&self) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0_f64);
        for colour in self.colours.iter().flatten() {
            sum += colour[1];
            count += 1.0;
        }
        sum / count.max(1.0)
    }

    fn colour(&self, vertex: u32) -> [f64; 3] {
        self.colours[vertex as usize].unwrap_or_default()
    }

    /// How far the middle of an edge is from the mean of its ends.
    fn error(&self, key: [u32; 2]) -> f64 {
        let Some(middle) = self.middles.get(&key) else { return 0.0 };
        let [a, b, m] = [key[0], key[1], *middle].map(|n| self.colour(n));
        (0..3).fold(0.0, |worst: f64, i| worst.max((m[i] - (a[i] + b[i]) / 2.0).abs()))
    }

    /// What the error of an edge is compared with.
    fn scale(&self, key: [u32; 2], floor: f64) -> f64 {
        key.iter().fold(floor, |scale, n| scale.max(self.colour(*n)[1]))
    }

    /// Makes the parts of a triangle and returns their numbers.
    fn split(&mut self, number: u32, flags: [bool; 3]) -> core::ops::Range<u32> {
        let Triangle { corners, chart, .. } = self.triangles[number as usize];
        let turn = self.longest(corners);
        let corner = [0, 1, 2].map(|i| corners[(i + turn) % 3]);
        let middle = |i: usize| {
            let [a, b] = [corner[i], corner[(i + 1) % 3]];
            self.middles.get(&[a.min(b), a.max(b)]).copied()
        };
        let flag = |i: usize| flags[(i + turn) % 3];
        let [c0, c1, c2] = corner;
        let parts = match (middle(0), flag(1).then(|| middle(1)).flatten(), flag(2).then(|| middle(2)).flatten()) {
            (Some(m0), Some(m1), Some(m2)) => vec![[c0, m0, m2], [m0, c1, m1], [m2, m1, c2], [m0, m1, m2]],
            (Some(m0), Some(m1), None) => vec![[c0, m0, c2], [m0, c1, m1], [m0, m1, c2]],
            (Some(m0), None, Some(m2)) => vec![[c0, m0, m2], [m2, m0, c2], [m0, c1, c2]],
            (Some(m0), None, None) => vec![[c0, m0, c2], [m0, c1, c2]],
            (None, ..) => vec![corner],
        };
        let from = self.count();
        self.triangles.extend(parts.iter().map(|corners| Triangle {
            corners: *corners,
            chart,
            children: NONE,
            count: 0,
        }));
        let to = self.count();
        self.triangles[number as usize].children = from;
        self.triangles[number as usize].count = to - from;
        from..to
    }

    /// The places of a triangle among its parts.
    fn shared(&self, parts: core::ops::Range<u32>, places: &[u32], seen: &[Seen]) -> Vec<(u32, Vec<u32>)> {
        let mut of_parts: Vec<(u32, Vec<u32>)> = parts.clone().map(|n| (n, Vec::new())).collect();
        for place in places {
            if let Some(part) = self.best(parts.clone(), seen[*place as usize].1) {
                of_parts[(part - parts.start) as usize].1.push(*place);
            }
        }
        of_parts
    }

    /// Writes the irradiance at a place of a chart; false if none has been gathered there.
    pub(super) fn interpolate(&self, chart: u32, place: DVec3, row: &mut [f64]) -> bool {
        let Some(mut number) = self.best(self.bases[chart as usize].clone(), place) else { return false };
        loop {
            let triangle = &self.triangles[number as usize];
            if triangle.children == NONE {
                break;
            }
            let Some(part) = self.best(triangle.children..triangle.children + triangle.count, place) else { break };
            number = part;
        }
        let triangle = &self.triangles[number as usize];
        if triangle.corners.iter().any(|n| self.colours[*n as usize].is_none()) {
            return false;
        }
        let weights = self.weights(triangle, place).map(|w| w.max(0.0));
        let sum: f64 = weights.iter().sum();
        let weights = weights.map(|w| w / sum);
        let values = self.values;
        let mut add = |vertex: u32, weight: f64| {
            let from = &self.rows[vertex as usize * self.width..][..self.width];
            row[..values].iter_mut().zip(from).for_each(|(r, f)| *r += weight * f);
            // Errors add up, whatever the sign.
            row[values..].iter_mut().zip(&from[values..]).for_each(|(r, f)| *r += weight.abs() * f);
        };
        // A quadratic in each direction where the middle of the edge is known, linear elsewhere.
        let mut of_corners = weights;
        for (i, [a, b]) in edges_of(triangle.corners).into_iter().enumerate() {
            let j = (i + 1) % 3;
            let bubble = weights[i] * weights[j];
            if let Some(middle) = self.bend(a, b) {
                of_corners[i] -= 2.0 * bubble;
                of_corners[j] -= 2.0 * bubble;
                add(middle, 4.0 * bubble);
            }
        }
        for (vertex, weight) in triangle.corners.into_iter().zip(of_corners) {
            add(vertex, weight);
        }
        true
    }

    /// The middle of an edge if irradiance may be a quadratic through it: one that is not negative anywhere.
    fn bend(&self, a: u32, b: u32) -> Option<u32> {
        let middle = *self.middles.get(&[a.min(b), a.max(b)])?;
        let [_, y, _] = self.colours[middle as usize]?;
        let [from, to] = [a, b].map(|n| self.colour(n)[1]);
        // As a Bézier curve: its inner ordinate is not negative, which is enough.
        (4.0 * y >= from + to).then_some(middle)
    }
}

/// The edges of a triangle, each from its corner of the same number to the next.
const fn edges_of([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

/// A point a little off the edges of a polygon that a corner of it belongs to.
fn inset(corner: DVec3, centre: DVec3) -> DVec3 {
    corner + (centre - corner) * 1e-4
}
