//! Time for indirect light at places over the number of faces, with exponents fitted to it, and how far it is from that of a walk through all
//! faces.

use disk_sampling::Receiver;
use renderers::radiosity::{Flat, Radiosity, Settings, Solution};
use renderers::scene::Scene;
use renderers::spectral::Palette;

use crate::scaling::{BOXES, ROOM_ACCURACY, SQUARES, exponent, hilly_room, processor, room};

/// Places in each scene, and those of them where all faces are looked at.
const PLACES: u32 = 48;
const WALKS: usize = 12;

pub(crate) fn run() {
    let asked = |what: &str| std::env::args().any(|argument| argument == what);
    let all = !["room", "hills"].into_iter().any(asked);
    if all || asked("hills") {
        println!("light at places of a room with a mesh of hills, at an accuracy of {ROOM_ACCURACY}");
        series(&SQUARES.map(|squares| (2 * squares * squares, hilly_room(squares))));
    }
    if all || asked("room") {
        println!("light at places of a room with boxes, at an accuracy of {ROOM_ACCURACY}");
        series(&BOXES.map(|boxes| (6 * boxes, room(boxes))));
    }
}

fn series(scenes: &[(u32, Scene)]) {
    let mut points = Vec::new();
    for (faces, scene) in scenes {
        let settings = Settings { accuracy: ROOM_ACCURACY, points: false, ..Settings::default() };
        let mut palette = Palette::default();
        let radiosity = Radiosity::new(scene, &settings, &mut palette, &|_| {}).expect("a solution");
        let solution = radiosity.solve(&Flat).expect("a solution");
        points.push((f64::from(*faces), measured(*faces, &solution)));
    }
    println!("exponent of the time for a place: {:.2}\n", exponent(&points));
}

/// Milliseconds for a place.
fn measured(faces: u32, solution: &Solution<'_>) -> f64 {
    let places: Vec<Receiver<f64>> = (0..PLACES).filter_map(place).collect();
    let start = processor();
    let found: Vec<f64> = places.iter().map(|place| solution.indirect(place)[0]).collect();
    let time = 1e3 * (processor() - start) / places.len() as f64;
    let start = processor();
    let walks: Vec<f64> = places.iter().take(WALKS).map(|place| solution.indirect_within(place, 0.0)[0]).collect();
    let walk = 1e3 * (processor() - start) / WALKS as f64;
    let errors: Vec<f64> = found.iter().zip(&walks).map(|(found, walk)| (found / walk - 1.0).abs()).collect();
    println!(
        "{faces:6} faces, {:7} patches: {time:8.2} ms a place, {walk:8.2} ms by a walk through all faces; rms difference {:.1e}, largest {:.1e}",
        solution.report().patches,
        (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt(),
        errors.iter().fold(0.0_f64, |most, e| most.max(*e)),
    );
    time
}

/// Places on the walls above the hills, and in the air under the ceiling that look down or aside.
fn place(index: u32) -> Option<Receiver<f64>> {
    let part = |step: f64| (0.5 + step * f64::from(index)).fract();
    let (a, b) = (3.8 * part(0.754_877_666_246_692_7) - 1.9, 2.9 * part(0.569_840_290_998_053_3) - 1.0);
    let (position, normal) = match index % 4 {
        0 => ([-2.0, a, b], [1.0, 0.0, 0.0]),
        1 => ([a, 2.0, b], [0.0, -1.0, 0.0]),
        2 => ([a, b, 1.8], [0.0, 0.0, -1.0]),
        _ => ([a, b, 1.75], [0.6, 0.0, -0.8]),
    };
    Receiver::new(position, normal).ok()
}
