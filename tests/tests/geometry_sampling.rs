//! Samplers, their densities and inverses; the points they are fed with; reconstruction filters.
#![allow(clippy::unwrap_used, reason = "the input is constant")]

use renderers::geometry::glam::{Vec2, Vec3A};
use renderers::geometry::sampling::{
    SobolSequence, cosine_hemisphere_to_square, disk_to_square, square_to_cosine_hemisphere,
    square_to_cosine_hemisphere_pdf, square_to_disk, square_to_disk_pdf, square_to_triangle, square_to_triangle_pdf,
    triangle_to_square,
};
use renderers::geometry::{Filter, GeometryError};
use spectral_tests::statistics::{ChiSquare, Rng};

const SAMPLES: u32 = 200_000;
const CELLS: usize = 20;
const SIGNIFICANCE: f64 = 1e-3;
/// The number of chi-square tests in this file that are expected to pass, for Šidák's correction.
const TESTS: u32 = 13;

/// Counts samples of a domain that `to_cell` maps to [0, 1)², and integrates the density times the Jacobian over the
/// cells by 6 × 6 Gauss points each.
fn chi_square(mut sample: impl FnMut() -> [f64; 2], density: impl Fn([f64; 2]) -> f64) -> ChiSquare {
    let mut observed = vec![0; CELLS * CELLS];
    let cells = f64::from(u32::try_from(CELLS).unwrap());
    for _ in 0..SAMPLES {
        let [i, j] = sample().map(|x| cell_of(x * cells));
        observed[i * CELLS + j] += 1;
    }
    let mut expected = vec![0.0; CELLS * CELLS];
    for (index, value) in expected.iter_mut().enumerate() {
        let corner = [index / CELLS, index % CELLS].map(|i| f64::from(u32::try_from(i).unwrap()));
        for (x, wx) in GAUSS {
            for (y, wy) in GAUSS {
                *value += wx * wy / 4.0 * density([(corner[0] + x) / cells, (corner[1] + y) / cells]);
            }
        }
        *value *= f64::from(SAMPLES) / (cells * cells);
    }
    ChiSquare::new(&observed, &expected)
}

/// Gauss–Legendre nodes on [0, 1] with weights of sum 2 (Abramowitz & Stegun, table 25.4, n = 6).
const GAUSS: [(f64, f64); 6] = [
    (0.033_765_242_898_424, 0.171_324_492_379_170),
    (0.169_395_306_766_868, 0.360_761_573_048_139),
    (0.380_690_406_958_402, 0.467_913_934_572_691),
    (0.619_309_593_041_598, 0.467_913_934_572_691),
    (0.830_604_693_233_132, 0.360_761_573_048_139),
    (0.966_234_757_101_576, 0.171_324_492_379_170),
];

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a cell")]
fn cell_of(x: f64) -> usize {
    (x as usize).min(CELLS - 1)
}

fn square(rng: &mut Rng) -> [f32; 2] {
    [rng.unit_f32(), rng.unit_f32()]
}

/// Corners, centre lines, and random points.
fn squares(rng: &mut Rng) -> Vec<[f32; 2]> {
    let edge = [0.0, 0.25, 0.5, 0.75, 1.0 - f32::EPSILON / 2.0];
    let grid = edge.iter().flat_map(|x| edge.iter().map(|y| [*x, *y]));
    grid.chain((0..10_000).map(|_| square(rng))).collect()
}

fn polar(p: Vec2) -> [f64; 2] {
    let turn = f64::from(p.y).atan2(f64::from(p.x)) / core::f64::consts::TAU;
    [f64::from(p.length_squared()), turn + 0.5]
}

/// In squared radius and azimuth, a density p per unit area is π·p.
fn disk_test(sample: impl Fn([f32; 2]) -> Vec2) -> ChiSquare {
    let mut rng = Rng::new(21);
    let density = |[r2, turn]: [f64; 2]| {
        let angle = (turn - 0.5) * core::f64::consts::TAU;
        let point = Vec2::from_angle(to_f32(angle)) * to_f32(r2.sqrt());
        f64::from(square_to_disk_pdf(point)) * core::f64::consts::PI
    };
    chi_square(|| polar(sample(square(&mut rng))), density)
}

#[allow(clippy::cast_possible_truncation, reason = "the samplers are f32")]
fn to_f32(x: f64) -> f32 {
    x as f32
}

fn accept(test: &ChiSquare) {
    assert!(test.accepts(SIGNIFICANCE, TESTS), "{test}");
}

#[test]
fn the_disk_is_sampled_uniformly() {
    accept(&disk_test(square_to_disk));
}

/// The control: radius not under the root.
#[test]
fn a_wrong_disk_is_found_out() {
    let wrong = disk_test(|u| Vec2::from_angle(u[1] * core::f32::consts::TAU) * u[0]);
    assert!(!wrong.accepts(SIGNIFICANCE, TESTS), "{wrong}");
    let nearly = disk_test(|u| square_to_disk(u) * 0.995);
    assert!(!nearly.accepts(SIGNIFICANCE, TESTS), "{nearly}");
}

#[test]
fn the_triangle_is_sampled_uniformly() {
    let mut rng = Rng::new(22);
    // Cells on the diagonal are half full; the density there is not smooth, so cells are taken in a square that the
    // triangle is folded to: (x + y, x / (x + y)), with Jacobian x + y.
    let fold = |[x, y]: [f64; 2]| if x + y > 0.0 { [x + y, x / (x + y)] } else { [0.0, 0.0] };
    let density = |[s, r]: [f64; 2]| s * f64::from(square_to_triangle_pdf([to_f32(s * r), to_f32(s - s * r)]));
    accept(&chi_square(|| fold(square_to_triangle(square(&mut rng)).map(f64::from)), density));
    assert_eq!(square_to_triangle_pdf([0.6, 0.6]) + square_to_triangle_pdf([-0.1, 0.6]), 0.0);
}

#[test]
fn the_hemisphere_is_sampled_by_its_cosine() {
    let mut rng = Rng::new(23);
    let sample = || {
        let d = square_to_cosine_hemisphere(square(&mut rng));
        assert!((d.length() - 1.0).abs() <= 4.0 * f32::EPSILON && d.z >= 0.0);
        [f64::from(d.z), polar(Vec2::new(d.x, d.y))[1]]
    };
    // Per steradian, in height and azimuth: 2π times the density.
    let density = |[z, turn]: [f64; 2]| {
        let angle = (turn - 0.5) * core::f64::consts::TAU;
        let r = (1.0 - z * z).sqrt();
        let direction = Vec3A::new(to_f32(r * angle.cos()), to_f32(r * angle.sin()), to_f32(z));
        f64::from(square_to_cosine_hemisphere_pdf(direction)) * core::f64::consts::TAU
    };
    accept(&chi_square(sample, density));
    assert_eq!(square_to_cosine_hemisphere_pdf(-Vec3A::Z), 0.0);
}

#[test]
fn inverses_give_back_the_square() {
    let mut rng = Rng::new(24);
    for u in squares(&mut rng) {
        let error = |v: [f32; 2]| (v[0] - u[0]).abs().max((v[1] - u[1]).abs());
        assert!(error(triangle_to_square(square_to_triangle(u))) <= 2.0 * f32::EPSILON, "{u:?}");
        let point = square_to_disk(u);
        assert!(point.length() <= 1.0 + f32::EPSILON);
        assert!(error(disk_to_square(point)) <= 4.0 * f32::EPSILON, "{u:?} {:?}", disk_to_square(point));
        assert!(error(cosine_hemisphere_to_square(square_to_cosine_hemisphere(u))) <= 4.0 * f32::EPSILON);
        let weights = square_to_triangle(u);
        assert!(weights.iter().all(|w| *w >= 0.0) && weights[0] + weights[1] <= 1.0);
    }
}

fn filters() -> [Filter; 5] {
    let gaussian = Filter::gaussian(0.8).unwrap();
    [Filter::default(), gaussian, Filter::pixel(), Filter::tent(1.0).unwrap(), Filter::constant(1.5).unwrap()]
}

#[test]
fn filters_are_sampled_by_their_density() {
    let mut rng = Rng::new(25);
    for filter in filters() {
        let r = filter.radius();
        let sample = || filter.square_to_offset(square(&mut rng)).map(|x| (f64::from(x) + r) / (2.0 * r));
        let density = |p: [f64; 2]| filter.pdf(p.map(|x| to_f32((2.0 * x - 1.0) * r))) * 4.0 * r * r;
        accept(&chi_square(sample, density));
    }
}

/// The control: a Gaussian 2 % too wide.
#[test]
fn a_wrong_filter_is_found_out() {
    let mut rng = Rng::new(26);
    let (filter, wrong) = (Filter::default(), Filter::gaussian(0.51).unwrap());
    let sample = || wrong.square_to_offset(square(&mut rng)).map(|x| (f64::from(x) + 2.04) / 4.08);
    let density = |p: [f64; 2]| filter.pdf(p.map(|x| to_f32((2.0 * x - 1.0) * 2.04))) * 4.08 * 4.08;
    let test = chi_square(sample, density);
    assert!(!test.accepts(SIGNIFICANCE, TESTS), "{test}");
}

#[test]
fn filters_invert_and_integrate() {
    for filter in filters() {
        let r = filter.radius();
        assert_eq!((filter.cumulative(-2.0 * r), filter.cumulative(2.0 * r)), (0.0, 1.0));
        let (mut integral, steps) = (0.0, 20_000);
        for i in 0..steps {
            let x = |i: f64| (2.0 * i / f64::from(steps) - 1.0) * r;
            let middle = x(f64::from(i) + 0.5);
            assert!(
                (filter.cumulative(middle) - integral - filter.density(middle) * r / f64::from(steps)).abs() <= 1e-7
            );
            integral += filter.density(middle) * 2.0 * r / f64::from(steps);
            let u = (f64::from(i) + 0.5) / f64::from(steps);
            assert!((filter.cumulative(filter.quantile(u)) - u).abs() <= 1e-14, "{u}");
            assert!((filter.quantile(u) + filter.quantile(1.0 - u)).abs() <= 1e-9 * r);
        }
        assert!((integral - 1.0).abs() <= 1e-8, "{filter:?}");
        for u in [[0.1, 0.7], [0.5, 0.25], [0.999, 0.01]] {
            let back = filter.offset_to_square(filter.square_to_offset(u));
            assert!((0..2).all(|i| (back[i] - f64::from(u[i])).abs() <= 1e-6), "{back:?}");
        }
    }
}

/// Independent: the error function (Abramowitz & Stegun, table 7.1) gives the Gaussian's distribution function,
/// (σ√(2π) erf(x/σ√2)/2 − bias·x)/integral + ½.
#[test]
fn the_gaussian_matches_the_error_function() {
    let filter = Filter::default();
    let bias = f64::exp(-8.0);
    let scale = 0.5 * (core::f64::consts::TAU).sqrt();
    // erf(z) for z = x/(σ√2), and for the radius, z = 2√2.
    let erf = [(0.5, 0.520_499_877_8), (1.0, 0.842_700_792_9), (1.5, 0.966_105_146_5)];
    let whole = scale * 0.999_936_657_516 - bias * 4.0;
    for (z, value) in erf {
        let x = 0.5 * core::f64::consts::SQRT_2 * z;
        let expected = 0.5 + (scale * value / 2.0 - bias * x) / whole;
        assert!((filter.cumulative(x) - expected).abs() <= 1e-8, "{z}: {} {expected}", filter.cumulative(x));
    }
}

/// Independent: values of Mitsuba 3.9.1's filters; its Gaussian is an approximation within 4·10⁻⁴.
#[test]
fn filters_are_those_of_mitsuba() {
    let (gaussian, tent, pixel) = (Filter::default(), Filter::tent(1.0).unwrap(), Filter::pixel());
    assert_eq!((gaussian.radius(), tent.radius(), pixel.radius()), (2.0, 1.0, 0.5));
    for (x, expected) in
        [(0.0, 0.999_247), (0.25, 0.882_167), (0.5, 0.606_423), (1.0, 0.134_960), (1.5, 0.010_758), (2.0, 1.9e-6)]
    {
        assert!((gaussian.value(x) - expected).abs() <= 4.5e-4, "{x}");
    }
    assert_eq!([0.0, 0.25, 0.75, 1.0].map(|x| tent.value(x)), [1.0, 0.75, 0.25, 0.0]);
    assert_eq!([0.25, 0.6].map(|x| pixel.value(x)), [1.0, 0.0]);
    assert_eq!(gaussian.value(2.1), 0.0);
}

#[test]
fn bad_filters_are_refused() {
    for width in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        for filter in [Filter::gaussian(width), Filter::tent(width), Filter::constant(width)] {
            assert_eq!(filter, Err(GeometryError::BadFilterWidth));
        }
    }
}

/// Every run of 2^m points that starts at a multiple has one point in each elementary interval of area 2^−m.
#[test]
fn points_are_a_net_in_every_run_of_a_power_of_two() {
    for (seed, m) in [(0, 4), (1, 7), (0xdead_beef, 10)] {
        let sequence = SobolSequence::new(seed);
        for (start, dimension) in [(0, 0), (1 << m, 0), (5 << m, 3)] {
            let points: Vec<_> = (start..start + (1 << m)).map(|i| sequence.point(i, dimension)).collect();
            for split in 0..=m {
                let mut seen = vec![false; 1 << m];
                for [x, y] in &points {
                    let [i, j] = [(x, split), (y, m - split)].map(|(v, bits)| index(*v, bits));
                    assert!(*x < 1.0 && *y < 1.0 && !core::mem::replace(&mut seen[(i << (m - split)) + j], true));
                }
            }
        }
    }
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a cell")]
fn index(x: f32, bits: u32) -> usize {
    (f64::from(x) * f64::from(1_u32 << bits)) as usize
}

/// Over many seeds one point is uniform, and the points of two dimensions, pixels or indices are not correlated.
#[test]
fn points_are_uniform_and_independent_over_seeds() {
    let pairs: [fn(u32) -> [f32; 2]; 5] = [
        |seed| SobolSequence::new(seed).point(0, 0),
        |seed| SobolSequence::new(seed).point(77, 2),
        |seed| [SobolSequence::new(seed).point(9, 0)[0], SobolSequence::new(seed).point(9, 1)[0]],
        |seed| [0, 1].map(|x| SobolSequence::for_pixel(x, 5, seed).point(3, 0)[1]),
        |seed| SobolSequence::for_pixel(seed % 512, seed / 512, 0).point(0, 0),
    ];
    for pair in pairs {
        let mut seed = 0;
        let sample = || {
            seed += 1;
            pair(seed).map(f64::from)
        };
        accept(&chi_square(sample, |_| 1.0));
    }
}

/// A smooth integral converges much faster than by random points, whose error would be about 0.28/√n.
#[test]
fn points_integrate_better_than_random_ones() {
    let (count, seeds) = (1024, 64);
    let mut square_error = 0.0;
    for seed in 0..seeds {
        let sequence = SobolSequence::new(seed);
        let value = |i| sequence.point(i, 0).map(f64::from).iter().product::<f64>();
        let mean = (0..count).map(value).sum::<f64>() / f64::from(count);
        square_error += (mean - 0.25).powi(2) / f64::from(seeds);
    }
    let random = (7.0_f64 / 144.0 / f64::from(count)).sqrt();
    assert!(square_error.sqrt() <= random / 30.0, "{} {random}", square_error.sqrt());
}

/// The same on any thread, in any order: points are a function of their arguments.
#[test]
fn points_do_not_depend_on_threads() {
    let point = |i: u32| SobolSequence::for_pixel(i % 7, i / 7, 42).point(i, i % 5);
    let serial: Vec<_> = (0..1000).map(point).collect();
    let halves = [0..500, 500..1000].map(|range| std::thread::spawn(move || range.map(point).collect::<Vec<_>>()));
    let parallel: Vec<_> = halves.into_iter().flat_map(|h| h.join().unwrap()).collect();
    assert_eq!(serial, parallel);
}
