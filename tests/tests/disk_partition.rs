//! Subdivisions of a disk light: published figures, hierarchy, jitter, aiming failures, refusals.
#![allow(clippy::unwrap_used, reason = "the input is constant")]

use core::f64::consts::PI;

use disk_sampling::partition::{Label, MAX_DEPTH, Method, Partition, PartitionError, Side, Subsource};
use disk_sampling::{Disk, Receiver, disk_to_hexagon};
use spectral_tests::statistics::Rng;

const ROWS: [(f64, f64); 2] = [(0.4, 3.55), (1.0, 1.0)];
const FLUX: f64 = 5000.0;

/// Illuminance straight below a disk of 5000 lm, by the subsources that hit, in lx.
fn on_axis(radius: f64, height: f64, parts: impl Iterator<Item = Subsource<f64>>) -> f64 {
    let square = |x: f64| x * x;
    let sum: f64 = parts
        .filter(Subsource::hits)
        .map(|part| {
            let [x, y] = part.position().map(|x| x * radius);
            part.weight() * square(height) / square(square(x) + square(y) + square(height))
        })
        .sum();
    FLUX / PI * sum
}

fn exact(radius: f64, height: f64) -> f64 {
    FLUX / (PI * (radius * radius + height * height))
}

fn relative_error(method: Method, depth: u32, row: usize) -> f64 {
    let (radius, height) = ROWS[row];
    on_axis(radius, height, Partition::full(method, depth).unwrap()) / exact(radius, height) - 1.0
}

/// Published: the thesis's tables 2.1 and 2.2, in lx, with dj = 0.
#[test]
fn the_printed_tables_are_reproduced() {
    let printed = [
        (0, Method::Square, 117.007),
        (0, Method::Hexagon, 124.720),
        (1, Method::Square, 769.94),
        (1, Method::MappedSquare, 744.81),
        (1, Method::Hexagon, 796.87),
    ];
    for (row, method, lux) in printed {
        let (radius, height) = ROWS[row];
        let computed = on_axis(radius, height, Partition::full(method, 6).unwrap());
        println!(
            "r {radius} h {height} {method:?}: {computed:.3} lx, printed {lux}: {:+.4} %",
            100.0 * (computed / lux - 1.0)
        );
        assert!((computed / lux - 1.0).abs() <= 2e-4);
    }
}
#[test]
fn show() {
    for row in 0..2 {
        for (m, d) in [(Method::Square, 6), (Method::MappedSquare, 6)] {
            println!("{row} {m:?} {:+.3}%", 100.0 * relative_error(m, d, row));
        }
        for m in [Method::Hexagon, Method::EqualAreaHexagon] {
            for d in [1, 3, 5, 7, 9] {
                println!("{row} {m:?} {d} {:+.4}%", 100.0 * relative_error(m, d, row));
            }
        }
    }
}
