//! Time, links and bytes over the number of patches, with exponents fitted to them: the Cornell box, refined by accuracy, a room with ever
//! more boxes, and one with an ever finer mesh of hills.

use core::fmt::Write as _;
use std::time::Instant;

use renderers::radiosity::{Radiosity, Settings};
use renderers::scene::{Scene, Source, builtin, load};
use renderers::spectral::{Palette, UniformBins};

/// For the Cornell box: from some hundreds of patches to more than 50 000.
const ACCURACIES: [f64; 6] = [1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5];
/// Boxes in the room; each has six faces. The last case takes minutes.
pub(crate) const BOXES: [u32; 5] = [83, 332, 832, 3332, 8332];
/// Squares along each side of the hills, each of two triangles.
pub(crate) const SQUARES: [u32; 5] = [16, 32, 50, 100, 158];
/// For the rooms.
pub(crate) const ROOM_ACCURACY: f64 = 1e-2;
const BINS: usize = 81;

/// What a case took.
struct Taken {
    faces: Option<u32>,
    patches: f64,
    links: f64,
    bytes: f64,
    /// Processor seconds of all threads for patches and links, and for the solution.
    build: f64,
    solve: f64,
}

/// All, or of `room`, `hills` and `cornell-box` those that are asked for.
pub(crate) fn run() {
    let asked = |what: &str| std::env::args().any(|argument| argument == what);
    let all = !["cornell-box", "room", "hills"].into_iter().any(asked);
    if all || asked("cornell-box") {
        cornell_box();
    }
    if all || asked("room") {
        crowded_room();
    }
    if all || asked("hills") {
        hills();
    }
}

fn cornell_box() {
    println!("Cornell box by accuracy, without points; solved for {BINS} bins");
    let cornell_box = builtin::load("cornell-box", &[]).expect("a built-in scene");
    let rows = ACCURACIES.map(|accuracy| taken(&cornell_box, accuracy, None));
    fits(&rows);
}

fn crowded_room() {
    println!("room with boxes at an accuracy of {ROOM_ACCURACY}, without points");
    let rows = BOXES.map(|boxes| taken(&room(boxes), ROOM_ACCURACY, Some(6 * boxes)));
    fits(&rows);
}

fn hills() {
    println!("room with a mesh of hills at an accuracy of {ROOM_ACCURACY}, without points");
    let rows = SQUARES.map(|squares| taken(&hilly_room(squares), ROOM_ACCURACY, Some(2 * squares * squares)));
    fits(&rows);
}

/// `faces` is about how many there are, for scenes of many.
fn taken(scene: &Scene, accuracy: f64, faces: Option<u32>) -> Taken {
    let label = faces.map_or(format!("{accuracy:e}"), |faces| format!("{faces} faces"));
    let reset = std::fs::write("/proc/self/clear_refs", "5").is_ok();
    let settings = Settings { accuracy, points: false, ..Settings::default() };
    let mut palette = Palette::default();
    let (start, before) = (Instant::now(), processor());
    let radiosity = Radiosity::new(scene, &settings, &mut palette, &|_| {}).expect("a solution");
    let (build_wall, build) = (start.elapsed().as_secs_f64(), processor() - before);
    let bins = UniformBins::new(&palette, BINS).expect("bins");
    let (start, before) = (Instant::now(), processor());
    let report = *radiosity.solve(&bins).expect("a solution").report();
    let (solve_wall, solve) = (start.elapsed().as_secs_f64(), processor() - before);
    let resident = if reset { peak() } else { None };
    println!(
        "{label:>10}: {:7} patches {:9} links {:8.1} MB of operator {:7.1} MB of rows {:>8} MB resident build {build_wall:.2} s (processors {build:.2} s) solution {solve_wall:.2} s (processors {solve:.2} s)",
        report.patches,
        report.links,
        report.bytes as f64 / 1e6,
        report.row_bytes as f64 / 1e6,
        resident.map_or("?".to_owned(), |bytes| format!("{:.0}", bytes / 1e6)),
    );
    Taken {
        faces,
        patches: report.patches as f64,
        links: report.links as f64,
        bytes: report.bytes as f64,
        build,
        solve,
    }
}

/// The most memory, in bytes, that this process has had since that was reset, where the system tells.
fn peak() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    Some(1024.0 * line.split_whitespace().nth(1)?.parse::<f64>().ok()?)
}

/// The seconds that processors have worked for this process; 0 where the system doesn't tell.
pub(crate) fn processor() -> f64 {
    // Linux counts hundredths for programs; the name of the process ends with the last parenthesis.
    let ticks = std::fs::read_to_string("/proc/self/stat").ok().and_then(|stat| {
        let mut fields = stat.rsplit(')').next()?.split_whitespace().skip(11);
        Some(fields.next()?.parse::<f64>().ok()? + fields.next()?.parse::<f64>().ok()?)
    });
    ticks.unwrap_or(0.0) / 100.0
}

/// Prints the exponents of the number of faces, or of patches where there are few faces.
fn fits(rows: &[Taken]) {
    let slope = |value: fn(&Taken) -> f64| {
        let of = |row: &Taken| (row.faces.map_or(row.patches, f64::from), value(row));
        exponent(&rows.iter().map(of).collect::<Vec<_>>())
    };
    println!(
        "exponents: links {:.2}, bytes {:.2}, processor seconds of the build {:.2}, of the solution {:.2}\n",
        slope(|row| row.links),
        slope(|row| row.bytes),
        slope(|row| row.build),
        slope(|row| row.solve),
    );
}

/// The power of the first number of each pair that the second grows with, by least squares of the logarithms.
pub(crate) fn exponent(pairs: &[(f64, f64)]) -> f64 {
    let points: Vec<(f64, f64)> = pairs.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let count = points.len() as f64;
    let mean = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / count, y + p.1 / count));
    let (over, under) = points
        .iter()
        .fold((0.0, 0.0), |(over, under), p| (over + (p.0 - mean.0) * (p.1 - mean.1), under + (p.0 - mean.0).powi(2)));
    over / under
}

fn grey(reflectance: f64) -> String {
    format!("<bsdf type='diffuse'><spectrum name='reflectance' value='{reflectance}'/></bsdf>")
}

/// A closed room of 4 with a lamp under its ceiling and hills on its floor.
pub(crate) fn hilly_room(squares: u32) -> Scene {
    let mut mesh = String::new();
    let at = |i: u32| 4.0 * f64::from(i) / f64::from(squares) - 2.0;
    for (x, y) in (0..=squares).flat_map(|i| (0..=squares).map(move |j| (at(i), at(j)))) {
        writeln!(mesh, "v {x} {y} {}", 0.3 * (5.0 * x).sin() * (4.0 * y + x).cos() - 1.5).expect("a string");
    }
    let row = squares + 1;
    for corner in (0..squares).flat_map(|i| (0..squares).map(move |j| i * row + j + 1)) {
        let [a, b, c, d] = [corner, corner + row, corner + row + 1, corner + 1];
        writeln!(mesh, "f {a} {b} {c}\nf {a} {c} {d}").expect("a string");
    }
    let shape = format!("<shape type='obj'><string name='filename' value='hills.obj'/>{}</shape>", grey(0.5));
    let source = Source::text("hills.xml", empty_room() + &shape + "</scene>").with_asset("hills.obj", mesh);
    load(&source, &[]).expect("a scene")
}

fn empty_room() -> String {
    format!(
        "<scene version='3.0.0'><sensor type='perspective'><float name='fov' value='40'/></sensor>
        <shape type='cube'><transform name='to_world'><scale value='2'/></transform>
        <boolean name='flip_normals' value='true'/>{}</shape>
        <shape type='rectangle'><transform name='to_world'><scale value='0.5'/><rotate x='1' angle='180'/>
        <translate z='1.9'/></transform><emitter type='area'><spectrum name='radiance' value='10'/></emitter></shape>",
        grey(0.7)
    )
}

/// A closed room of 4 with a lamp under its ceiling and boxes of all positions and turns, apart from each other.
pub(crate) fn room(boxes: u32) -> Scene {
    let side = (1..).find(|side: &u32| side.pow(3) >= boxes).unwrap_or(1);
    let cell = 3.4 / f64::from(side);
    let mut xml = empty_room();
    for index in 0..boxes {
        let at = [index % side, index / side % side, index / side / side].map(|i| (f64::from(i) + 0.5) * cell - 1.7);
        // The diagonal is 0.7 of a cell.
        let half = 0.2 * cell;
        let turn = f64::from(index) * 137.5;
        write!(
            xml,
            "<shape type='cube'><transform name='to_world'><scale value='{half}'/>
            <rotate x='1' y='{}' z='0.5' angle='{turn}'/>
            <translate x='{}' y='{}' z='{}'/></transform>{}</shape>",
            (f64::from(index) * 0.618).fract(),
            at[0],
            at[1],
            at[2],
            grey(0.5)
        )
        .expect("a string");
    }
    xml += "</scene>";
    load(&Source::text("room.xml", &xml), &[]).expect("a scene")
}
