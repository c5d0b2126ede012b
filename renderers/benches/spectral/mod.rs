//! What spectra cost a radiosity solution, and how far off the patches' colours are: all representations on one transport, in turns.

use std::time::Instant;

use renderers::radiosity::{Radiosity, Settings, Solution};
use renderers::scene::{Emitter, Scene, Source, SpectrumKind, builtin, load};
use renderers::spectral::{Components, IntervalSettings, Palette, Role, UniformBins};
use spectral_core::adaptive::Mode;
use spectral_core::bilinear::Tensor;
use spectral_core::colour::rgb::WHITE;
use spectral_core::colour::{delta_e_ab, xyz_to_lab};
use spectral_core::tables::{UniformTable, colorchecker, fluorescent};

/// Each representation is solved for so often; the least time counts.
const ROUNDS: usize = 3;
/// The same for solutions of milliseconds.
const SHORT_ROUNDS: usize = 101;
/// What these are refined to, and the others.
const ACCURACY: f64 = 3e-3;

/// A representation to compare.
#[derive(Clone, Copy)]
enum Way {
    Uniform(usize),
    Interval(Mode, f64),
    Naive,
    Prefiltered,
    Bilinear([f64; 3]),
    Smits,
}

impl Way {
    fn name(self) -> String {
        match self {
            Self::Uniform(bins) => format!("uniform:{bins}"),
            Self::Interval(mode, threshold) => format!("{mode:?} {threshold}"),
            Self::Naive => "rgb".to_owned(),
            Self::Prefiltered => "rgb-prefiltered".to_owned(),
            Self::Bilinear(alpha) => format!("bilinear {}", alpha.map(|a| format!("{a:.2}")).join(" ")),
            Self::Smits => "smits".to_owned(),
        }
    }
}

/// What one solution gave.
struct Outcome {
    colours: Vec<[f64; 3]>,
    text: String,
}

fn outcome(solution: &Solution<'_>) -> Outcome {
    let report = solution.report();
    let colours = solution
        .patches()
        .map(|(row, _)| solution.representation().colour(&[], row).value.map(|v| v * core::f64::consts::FRAC_1_PI));
    let text = format!(
        "{:5} {:6} {:6} {:8} {:9.3} {:8.1e} {:8.1e} {:8.3}",
        report.intervals,
        solution.width(),
        report.iterations,
        report.passes,
        report.row_bytes as f64 / 1e6,
        report.iteration_error,
        report.energy_balance,
        report.delta_e_bound,
    );
    Outcome { colours: colours.collect(), text }
}

/// Solves, and makes what the representation needs of spectra: both are timed.
fn solved(radiosity: &Radiosity, palette: &Palette, way: Way) -> Outcome {
    let of = |representation: &dyn renderers::radiosity::Representation| {
        outcome(&radiosity.solve(representation).expect("a solution"))
    };
    match way {
        Way::Uniform(bins) => of(&UniformBins::new(palette, bins).expect("bins")),
        Way::Interval(mode, threshold) => {
            let settings = IntervalSettings { mode, threshold, white: 1.0 };
            outcome(&radiosity.solve_intervals(palette, &settings).expect("a solution"))
        }
        Way::Naive => of(&Components::naive(palette).expect("components")),
        Way::Prefiltered => {
            let dominant = palette.leaves().iter().find(|(_, role)| *role == Role::Light).expect("a light");
            of(&Components::prefiltered(palette, &dominant.0).expect("components"))
        }
        Way::Bilinear(alpha) => {
            let tensor = Tensor::rec_709().with_alpha(alpha).expect("a tensor");
            of(&Components::bilinear(palette, &tensor).expect("components"))
        }
        Way::Smits => of(&UniformBins::smits(palette).expect("bins")),
    }
}

fn table(table: &UniformTable) -> (Vec<f64>, Vec<f64>) {
    let values = table.samples.double.to_vec();
    let wavelengths = (0..values.len()).map(|i| f64::from(table.first) + f64::from(table.step) * i as f64).collect();
    (wavelengths, values)
}

/// The Cornell box under a lamp of the luminance of the built-in one.
fn cornell(lamp: &UniformTable) -> Scene {
    let mut scene = builtin::load("cornell-box", &[]).expect("a built-in scene");
    let Some(Emitter::Area { radiance, .. }) = scene.emitters.first() else { panic!("the box has a lamp") };
    let radiance = *radiance;
    let (wavelengths, values) = table(lamp);
    let values = values.iter().map(|v| v * 40.0 / luminance(lamp)).collect();
    scene.spectra[radiance.0].kind = SpectrumKind::Table { wavelengths, values };
    scene
}

/// ∫Sȳ / ∫ȳ.
fn luminance(lamp: &UniformTable) -> f64 {
    let (wavelengths, values) = table(lamp);
    let spectrum =
        spectral_core::spectrum::PiecewiseLinear::new(&wavelengths, &values, spectral_core::spectrum::Outside::Zero)
            .expect("a spectrum");
    let observer = spectral_core::Observer::cie_1931_2deg();
    spectral_core::tristimulus(&observer, &spectrum, 380.0, 780.0)[1] / renderers::spectral::Y_INTEGRAL
}

/// A closed cube of 2 m with four paints of the ColorChecker on its faces, and a point light off its middle.
fn cube(paints: [usize; 4], lamp: &UniformTable) -> Scene {
    let listed = |wavelengths: &[f64], values: &[f64]| {
        let pairs = wavelengths.iter().zip(values).map(|(w, v)| format!("{w}:{v}"));
        pairs.collect::<Vec<_>>().join(", ")
    };
    let turns = [("x", 0), ("x", 180), ("x", 90), ("x", -90), ("y", 90), ("y", -90)];
    let faces = turns.iter().zip(paints.iter().cycle()).map(|((axis, angle), paint)| {
        let (wavelengths, values) = table(&colorchecker::ALL[*paint]);
        format!(
            "<shape type='rectangle'><transform name='to_world'><translate z='-1'/><rotate {axis}='1' angle='{angle}'/></transform>
            <bsdf type='diffuse'><spectrum name='reflectance' value='{}'/></bsdf></shape>",
            listed(&wavelengths, &values)
        )
    });
    let (wavelengths, values) = table(lamp);
    let values: Vec<f64> = values.iter().map(|v| v * 4.0 / luminance(lamp)).collect();
    let xml = format!(
        "<scene version='3.0.0'><sensor type='perspective'><float name='fov' value='40'/></sensor>{}
        <emitter type='point'><point name='position' x='0.2' y='0.1' z='0.3'/>
        <spectrum name='intensity' value='{}'/></emitter></scene>",
        faces.collect::<String>(),
        listed(&wavelengths, &values)
    );
    load(&Source::text("cube.xml", xml), &[]).expect("a scene")
}

fn refined(scene: &Scene, palette: &mut Palette) -> Radiosity {
    let settings = Settings { accuracy: ACCURACY, points: false, ..Settings::default() };
    Radiosity::new(scene, &settings, palette, &|_| {}).expect("a solution")
}

/// The mean and the largest ΔE*ab between some colours and others.
fn errors(one: &[[f64; 3]], other: &[[f64; 3]]) -> [f64; 2] {
    let lab = |xyz: &[f64; 3]| xyz_to_lab(*xyz, WHITE);
    let errors: Vec<f64> = one.iter().zip(other).map(|(a, b)| delta_e_ab(lab(a), lab(b))).collect();
    [errors.iter().sum::<f64>() / errors.len() as f64, errors.iter().fold(0.0, |m, e| m.max(*e))]
}

/// The corrected mode against 81 bins, in turns: the least and the median of times, and the true error.
fn corrected(name: &str, scene: &Scene) {
    let mut palette = Palette::default();
    let radiosity = refined(scene, &mut palette);
    let truth = solved(&radiosity, &palette, Way::Uniform(1600)).colours;
    let ways = [Way::Uniform(81), Way::Interval(Mode::Corrected, 10.0)];
    let mut times = ways.map(|_| Vec::with_capacity(SHORT_ROUNDS));
    let mut found = None;
    for _ in 0..SHORT_ROUNDS {
        for (way, times) in ways.iter().zip(&mut times) {
            let start = Instant::now();
            let outcome = solved(&radiosity, &palette, *way);
            times.push(start.elapsed().as_secs_f64());
            found = Some(outcome);
        }
    }
    times.iter_mut().for_each(|times| times.sort_by(f64::total_cmp));
    let [least, median] = [0, SHORT_ROUNDS / 2].map(|place| times.each_ref().map(|times| times[place]));
    let [mean, most] = errors(&found.expect("a solution").colours, &truth);
    println!(
        "{name:28} {:5} patches, least {:.2} of {:.2} ms: {:.3}; median {:.2} of {:.2} ms: {:.3}; mean dE {mean:.3}, max {most:.3}",
        truth.len(),
        1e3 * least[1],
        1e3 * least[0],
        least[1] / least[0],
        1e3 * median[1],
        1e3 * median[0],
        median[1] / median[0],
    );
}

fn compare(name: &str, scene: &Scene) {
    let mut palette = Palette::default();
    let radiosity = refined(scene, &mut palette);
    let [reference, finer] = [401, 1600].map(|bins| solved(&radiosity, &palette, Way::Uniform(bins)).colours);
    let [_, apart] = errors(&reference, &finer);
    println!("\n{name}: {} patches; uniform:401 is within {apart:.4} of uniform:1600", reference.len());
    println!(
        "{:20} parts  width  steps   passes   rows MB   left  balance    bound  mean dE   max dE  seconds  of 81",
        ""
    );
    let ways = [
        Way::Uniform(81),
        Way::Uniform(27),
        Way::Interval(Mode::Certified, 1.0),
        Way::Interval(Mode::Certified, 3.0),
        Way::Interval(Mode::Corrected, 3.0),
        Way::Interval(Mode::Corrected, 10.0),
        Way::Interval(Mode::Corrected, 20.0),
        Way::Interval(Mode::Paper, 3.0),
        Way::Naive,
        Way::Prefiltered,
        Way::Bilinear(Tensor::<f64>::rec_709().alpha()),
        Way::Bilinear([0.0, 0.0, 1.0]),
        Way::Smits,
    ];
    let mut least = vec![f64::INFINITY; ways.len()];
    let mut found: Vec<Option<Outcome>> = ways.iter().map(|_| None).collect();
    for _ in 0..ROUNDS {
        for (place, way) in ways.iter().enumerate() {
            let start = Instant::now();
            found[place] = Some(solved(&radiosity, &palette, *way));
            least[place] = least[place].min(start.elapsed().as_secs_f64());
        }
    }
    for ((way, outcome), seconds) in ways.iter().zip(found.iter().flatten()).zip(&least) {
        let [mean, most] = errors(&outcome.colours, &finer);
        println!("{:20} {} {mean:8.4} {most:8.4} {seconds:8.4} {:6.2}", way.name(), outcome.text, seconds / least[0]);
    }
}

/// All scenes by all representations; with `corrected`, only that mode in the cubes and the box, often.
pub(crate) fn run() {
    let only_corrected = std::env::args().any(|argument| argument == "corrected");
    let with = |name: &str, scene: &Scene| if only_corrected { corrected(name, scene) } else { compare(name, scene) };
    for name in ["cornell-box", "cornell-box-lamp", "cornell-box-sodium"] {
        with(name, &builtin::load(name, &[]).expect("a built-in scene"));
    }
    with("Cornell box, FL11", &cornell(&fluorescent::FL11));
    let d65 = &spectral_core::tables::illuminants::D65;
    for paints in [[0, 5, 10, 15], [3, 7, 11, 18], [2, 14, 16, 19]] {
        with(&format!("cube {paints:?}, D65"), &cube(paints, d65));
        with(&format!("cube {paints:?}, FL11"), &cube(paints, &fluorescent::FL11));
    }
}
