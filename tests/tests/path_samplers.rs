//! The path tracer's samplers against the densities that they state: chi-square tests with Šidák's correction.
#![allow(clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail by panicking")]
#![allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "numbers of cells and steps are small"
)]

use core::f64::consts::{PI, TAU};

use renderers::geometry::glam::DVec3;
use renderers::path::{PathTracer, Probe, Sampled};
use renderers::scene::{Source, load};
use renderers::spectral::Palette;
use spectral_tests::statistics::{ChiSquare, Rng};

const SIGNIFICANCE: f64 = 0.01;
/// All chi-square tests of this file.
const TESTS: u32 = 5 + 2 + 1 + 8;
const SAMPLES: u32 = 200_000;

const MESH: &str = "v -1 -1 2\nv 1 -1 2\nv 0 1 2.5\nv 3 0 1\nv 3.2 0.3 2\nf 1 3 2\nf 2 3 4\nf 2 4 5\n";

fn tracer(body: &str) -> PathTracer {
    let xml = format!(
        "<scene version='3.0.0'><sensor type='perspective'><float name='fov' value='40'/></sensor>{body}</scene>"
    );
    let scene = load(&Source::text("test.xml", xml).with_asset("mesh.obj", MESH), &[]).unwrap();
    PathTracer::new(&scene, [1, 1], &mut Palette::default()).unwrap()
}

/// The floor z = 0 with a material.
fn floor(material: &str) -> String {
    format!("<shape type='rectangle'><transform name='to_world'><scale value='20'/></transform>{material}</shape>")
}

const SHINES: &str = "<emitter type='area'><spectrum name='radiance' value='1'/></emitter>";

/// The floor at the origin, seen from a direction.
fn probe(tracer: &PathTracer, view: DVec3) -> Probe<'_> {
    let probe = tracer.probe(view * 0.5, -view).unwrap();
    assert!((probe.normal() - DVec3::Z).length() <= 1e-6);
    probe
}

fn square(rng: &mut Rng) -> [f32; 2] {
    [rng.unit_f32(), rng.unit_f32()]
}

/// Cells of a unit square of parameters of directions, each with its expected share of samples by the midpoint rule.
struct Cells<'f> {
    sides: [usize; 2],
    /// From parameters to a direction, and the solid angle for each unit of them.
    direction: &'f dyn Fn([f64; 2]) -> (DVec3, f64),
    /// From a direction to parameters; `None` outside.
    parameters: &'f dyn Fn(DVec3) -> Option<[f64; 2]>,
}

impl Cells<'_> {
    const STEPS: usize = 48;

    /// Compares samples with the density stated for their directions; those outside the cells have a cell of their own.
    fn test(&self, mut sample: impl FnMut() -> Option<DVec3>, density: impl Fn(DVec3) -> f64) -> ChiSquare {
        let [across, down] = self.sides;
        let mut counts = vec![0_u64; across * down + 1];
        for _ in 0..SAMPLES {
            let cell = sample().and_then(|d| (self.parameters)(d)).map_or(across * down, |[s, t]| {
                let place = |x: f64, n: usize| ((x * n as f64) as usize).min(n - 1);
                place(s, across) + across * place(t, down)
            });
            counts[cell] += 1;
        }
        let total = f64::from(SAMPLES);
        let mut expected: Vec<f64> =
            (0..across * down).map(|cell| total * self.share([cell % across, cell / across], &density)).collect();
        let rest = total - expected.iter().sum::<f64>();
        assert!(rest >= -1e-3 * total, "the density's integral is more than 1 by {}", -rest / total);
        // What is left by rounding alone can't be told from nothing.
        expected.push(if rest <= 1e-6 * total { 0.0 } else { rest });
        ChiSquare::new(&counts, &expected)
    }

    fn share(&self, cell: [usize; 2], density: &impl Fn(DVec3) -> f64) -> f64 {
        let steps = Self::STEPS;
        let sum: f64 = (0..steps * steps)
            .map(|i| {
                let within = [i % steps, i / steps].map(|k| (k as f64 + 0.5) / steps as f64);
                let at: [f64; 2] = core::array::from_fn(|a| (cell[a] as f64 + within[a]) / self.sides[a] as f64);
                let (direction, solid_angle) = (self.direction)(at);
                density(direction) * solid_angle
            })
            .sum();
        sum / (steps * steps * self.sides[0] * self.sides[1]) as f64
    }
}

/// Cells of a flat light, given by a point for each pair of parameters and their inverse in its plane.
fn flat_light(
    probe: &Probe<'_>,
    point: &dyn Fn([f64; 2]) -> DVec3,
    normal: DVec3,
    area: f64,
    inverse: &dyn Fn(DVec3) -> Option<[f64; 2]>,
    rng: &mut Rng,
) -> ChiSquare {
    let plane = point([0.5; 2]).dot(normal);
    let direction = |at: [f64; 2]| {
        let point = point(at);
        let squared = point.length_squared();
        let direction = point / squared.sqrt();
        (direction, area * direction.dot(normal).abs() / squared)
    };
    let parameters = |direction: DVec3| inverse(direction * (plane / direction.dot(normal)));
    let cells = Cells { sides: [12, 12], direction: &direction, parameters: &parameters };
    cells.test(|| choose_light(probe, rng).map(|s| s.direction), |d| probe.light_density(d))
}

/// A direction to a light; its stated density must be what another sampler is told for this direction.
fn choose_light(probe: &Probe<'_>, rng: &mut Rng) -> Option<Sampled> {
    let sampled = probe.sample_light(rng.unit(), square(rng))?;
    let stated = sampled.density.unwrap();
    if sampled.weight > 0.0 && rng.unit() < 0.01 {
        let told = probe.light_density(sampled.direction);
        // Within the rounding of f32 rays; edges can be missed by it.
        assert!(told == 0.0 || (stated / told - 1.0).abs() <= 1e-3, "{stated} {told}");
        assert!((sampled.weight * stated - 1.0).abs() <= 1e-12);
    }
    Some(sampled)
}

fn unit_square(x: f64, y: f64) -> Option<[f64; 2]> {
    // Rays and hits are rounded: what is on the edge is inside.
    let edge = |v: f64| (-1e-5..=1.0 + 1e-5).contains(&v).then_some(v.clamp(0.0, 1.0));
    Some([edge(x)?, edge(y)?])
}

#[track_caller]
fn assert_accepted(name: &str, test: ChiSquare) {
    assert!(test.accepts(SIGNIFICANCE, TESTS), "{name}: {test}");
}

const MATT: &str = "<bsdf type='diffuse'/>";

#[test]
fn flat_lights_are_chosen_evenly_over_their_area() {
    let mut rng = Rng::new(11);
    let down = "<rotate x='1' angle='180'/>";
    let body = format!(
        "{}<shape type='rectangle'><transform name='to_world'>{down}<scale x='2' y='0.5'/>
        <translate x='1' z='1'/></transform>{SHINES}</shape>",
        floor(MATT)
    );
    let rectangle = tracer(&body);
    let probe_ = probe(&rectangle, DVec3::Z);
    let point = |[s, t]: [f64; 2]| DVec3::new(4.0 * s - 1.0, t - 0.5, 1.0);
    let inverse = |p: DVec3| unit_square((p.x + 1.0) / 4.0, p.y + 0.5);
    assert_accepted("rectangle", flat_light(&probe_, &point, DVec3::Z, 4.0, &inverse, &mut rng));

    let body = format!(
        "{}<shape type='disk'><transform name='to_world'>{down}<translate x='0.5' z='0.7'/></transform>{SHINES}</shape>",
        floor(MATT)
    );
    let disk = tracer(&body);
    let probe_ = probe(&disk, DVec3::Z);
    let point = |[s, t]: [f64; 2]| {
        let (sin, cos) = (TAU * t).sin_cos();
        DVec3::new(0.5 + s.sqrt() * cos, s.sqrt() * sin, 0.7)
    };
    let inverse = |p: DVec3| {
        let (x, y) = (p.x - 0.5, p.y);
        unit_square(x * x + y * y, (y.atan2(x) / TAU).rem_euclid(1.0))
    };
    assert_accepted("disk", flat_light(&probe_, &point, DVec3::Z, PI, &inverse, &mut rng));
}

/// Triangles of a mesh, each chosen as its area (they shine alike) and evenly over it.
#[test]
fn triangles_of_a_mesh_are_chosen_by_their_area() {
    let mesh = format!(
        "{}<shape type='obj'><string name='filename' value='mesh.obj'/><boolean name='face_normals' value='true'/>
        {SHINES}</shape>",
        floor(MATT)
    );
    let mesh = tracer(&mesh);
    let probe = probe(&mesh, DVec3::Z);
    let vertex = |i: usize| {
        let line = MESH.lines().nth(i - 1).unwrap();
        let mut numbers = line.split(' ').skip(1).map(|w| w.parse::<f64>().unwrap());
        DVec3::from_array(core::array::from_fn(|_| numbers.next().unwrap()))
    };
    let mut rng = Rng::new(12);
    for corners in [[1, 3, 2], [2, 3, 4], [2, 4, 5]] {
        let [a, b, c] = corners.map(vertex);
        let cross = (b - a).cross(c - a);
        // Each triangle's samples are told by where they meet its plane; those of others are outside.
        let inside = |p: DVec3| {
            let (v, w) = (
                (p - a).cross(c - a).dot(cross) / cross.length_squared(),
                (b - a).cross(p - a).dot(cross) / cross.length_squared(),
            );
            let sum = v + w;
            if !(probe.light_density(p.normalize()) > 0.0) {
                return None;
            }
            if v < -1e-9 || w < -1e-9 { None } else { unit_square(sum * sum, w / sum) }
        };
        let point = |[s, t]: [f64; 2]| {
            let sum = s.sqrt();
            a + ((b - a) * (1.0 - t) + (c - a) * t) * sum
        };
        let normal = cross.normalize();
        let test = flat_light(&probe, &point, normal, cross.length() / 2.0, &inside, &mut rng);
        assert_accepted("triangle", test);
    }
}

#[test]
fn spheres_are_seen_in_cones_and_from_within_by_area() {
    let mut rng = Rng::new(13);
    let (centre, radius) = (DVec3::new(0.5, -1.0, 2.0), 1.2);
    let body = format!(
        "{}<shape type='sphere'><point name='center' value='0.5 -1 2'/><float name='radius' value='1.2'/>{SHINES}</shape>",
        floor(MATT)
    );
    let sphere = tracer(&body);
    let probe_ = probe(&sphere, DVec3::Z);
    let (axis, cosine) = (centre.normalize(), (1.0 - radius * radius / centre.length_squared()).sqrt());
    let (x, y) = axis.any_orthonormal_pair();
    let direction = |[s, t]: [f64; 2]| {
        let z = 1.0 - s * (1.0 - cosine);
        let (sin, cos) = (TAU * t).sin_cos();
        (axis * z + (x * cos + y * sin) * (1.0 - z * z).sqrt(), TAU * (1.0 - cosine))
    };
    let parameters =
        |d: DVec3| unit_square((1.0 - d.dot(axis)) / (1.0 - cosine), (d.dot(y).atan2(d.dot(x)) / TAU).rem_euclid(1.0));
    let cells = Cells { sides: [12, 12], direction: &direction, parameters: &parameters };
    let density = |d: DVec3| {
        if d.dot(axis) > cosine * (1.0 + 1e-7) { probe_.light_density(d) } else { 1.0 / (TAU * (1.0 - cosine)) }
    };
    let test = cells.test(|| choose_light(&probe_, &mut rng).map(|s| s.direction), density);
    assert_accepted("sphere", test);

    // A floor within a sphere that shines inwards: the upper half of directions.
    let body = format!(
        "{}<shape type='sphere'><point name='center' value='0 0 1'/><float name='radius' value='3'/>
        <boolean name='flip_normals' value='true'/>{SHINES}</shape>",
        floor(MATT)
    );
    let inside = tracer(&body);
    let probe_ = probe(&inside, DVec3::Z);
    let test =
        hemisphere(16).test(|| choose_light(&probe_, &mut rng).map(|s| s.direction), |d| probe_.light_density(d));
    assert_accepted("inside", test);
}

/// The upper hemisphere: height and azimuth.
fn hemisphere(across: usize) -> Cells<'static> {
    Cells {
        sides: [across, across],
        direction: &|[s, t]| {
            let (sin, cos) = (TAU * t).sin_cos();
            let across = (1.0 - s * s).sqrt();
            (DVec3::new(across * cos, across * sin, s), TAU)
        },
        parameters: &|d| (d.z > 0.0).then(|| [d.z, (d.y.atan2(d.x) / TAU).rem_euclid(1.0)]),
    }
}

#[test]
fn the_environment_is_chosen_by_the_cosine() {
    let body = format!("{}<emitter type='constant'><spectrum name='radiance' value='1'/></emitter>", floor(MATT));
    let tracer = tracer(&body);
    let probe = probe(&tracer, DVec3::Z);
    let mut rng = Rng::new(14);
    let test = hemisphere(12).test(|| choose_light(&probe, &mut rng).map(|s| s.direction), |d| probe.light_density(d));
    assert_accepted("environment", test);
}

/// Directions follow the stated density, and the mean of their weights is the albedo by quadrature.
#[test]
fn materials_choose_as_they_state_and_keep_their_albedo() {
    let mut rng = Rng::new(15);
    let schlick = |roughness: f64, isotropy: f64| {
        format!(
            "<bsdf type='schlick'><float name='roughness' value='{roughness}'/><float name='isotropy' value='{isotropy}'/></bsdf>"
        )
    };
    let view = DVec3::new(0.6, 0.3, 0.5).normalize();
    for material in [MATT.to_owned(), schlick(0.3, 1.0), schlick(0.5, 0.4), schlick(0.7, 1.0), schlick(1.0, 1.0)] {
        let tracer = tracer(&floor(&material));
        let probe = probe(&tracer, view);
        let (mut sum, mut squares) = (0.0, 0.0);
        let cells = hemisphere(16);
        let test = cells.test(
            || {
                let sampled = probe.sample_material(rng.unit(), square(&mut rng));
                // The ideal specular part is one direction, outside all solid angles.
                let sampled = sampled.filter(|s| s.density.is_some())?;
                sum += sampled.weight;
                squares += sampled.weight * sampled.weight;
                let [value, density] = probe.material(sampled.direction);
                assert!((sampled.weight * density / value - 1.0).abs() <= 1e-6 || value == 0.0);
                Some(sampled.direction)
            },
            |d| probe.material(d)[1],
        );
        assert_accepted(&material, test);
        let albedo: f64 = (0..256).map(|cell| cells.share([cell % 16, cell / 16], &|d| probe.material(d)[0])).sum();
        let n = f64::from(SAMPLES);
        let error = ((squares / n - (sum / n).powi(2)) / n).sqrt();
        assert!((sum / n - albedo).abs() <= 4.0 * error + 1e-4 * albedo, "{material}: {} {albedo} {error}", sum / n);
    }
}
