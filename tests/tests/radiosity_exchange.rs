//! Light between squares against closed forms in 50-digit arithmetic, from a thousandth of their side to a hundred times that.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail by panicking")]

use renderers::radiosity::polygon_exchange;

type Quad = [[f64; 3]; 4];

/// `independent`: written by tests/peers/exchange_reference.py.
const REFERENCE: &str = include_str!("../data/exchange_squares.csv");

fn opposite(h: f64) -> [Quad; 2] {
    [
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
        [[0.0, 0.0, h], [0.0, 1.0, h], [1.0, 1.0, h], [1.0, 0.0, h]],
    ]
}

fn upright(gap: f64) -> [Quad; 2] {
    let (low, high) = (gap, gap + 1.0);
    [
        [[low, 0.0, 0.0], [high, 0.0, 0.0], [high, 1.0, 0.0], [low, 1.0, 0.0]],
        [[0.0, 0.0, low], [0.0, 1.0, low], [0.0, 1.0, high], [0.0, 0.0, high]],
    ]
}

#[test]
fn squares_to_twelve_digits() {
    let mut count = 0;
    for line in REFERENCE.lines().filter(|line| !line.starts_with('#')) {
        let [kind, distance, exact] = line.split(", ").collect::<Vec<_>>()[..] else { panic!("{line}") };
        let (distance, exact): (f64, f64) = (distance.parse().unwrap(), exact.parse().unwrap());
        let pair = if kind == "parallel" { opposite(distance) } else { upright(distance) };
        // Axes in another order, and the polygons: nothing is rounded by that.
        for turn in 0..3 {
            let [one, other] = pair.map(|quad| quad.map(|[x, y, z]| [[x, y, z], [y, z, x], [z, x, y]][turn]));
            for found in [polygon_exchange(&one, &other), polygon_exchange(&other, &one)] {
                let found = found.unwrap();
                assert!((found / exact - 1.0).abs() <= 1e-12, "{line}: {found}, off by {:e}", found / exact - 1.0);
            }
        }
        count += 1;
    }
    assert!(count >= 38);
}

#[test]
fn what_is_no_polygon_is_refused() {
    let [one, _] = opposite(1.0);
    let line = [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
    let nan = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, f64::NAN, 0.0]];
    let nonagon: Vec<[f64; 3]> = (0..9).map(|i| [f64::from(i).cos(), f64::from(i).sin(), 0.0]).collect();
    for other in [&line[..], &nan, &nonagon, &one[..2], &[]] {
        assert_eq!(polygon_exchange(&one, other), None, "{other:?}");
    }
}
