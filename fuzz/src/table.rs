//! Text files of numbers: lamps, points, readings, answers.

use std::sync::OnceLock;

use renderers::brdf::parse_readings;
use renderers::illuminance::parse_points;
use renderers::light::{parse_csv, parse_spdx};
use renderers::verify::{Answers, Case, cases};

/// A lamp's spectrum, as text and as IES TM-27: what is accepted has increasing wavelengths and no negative power.
pub fn light_file(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    for found in [parse_csv("fuzz.csv", &text), parse_spdx("fuzz.csv", &text)] {
        match found {
            Err(error) => named("fuzz.csv", &error.to_string(), &text),
            Ok(table) => {
                assert!(table.wavelengths().len() >= 2 && table.wavelengths().len() == table.powers().len());
                assert!(table.wavelengths().windows(2).all(|pair| pair[0] < pair[1]));
                assert!(table.powers().iter().all(|v| *v >= 0.0 && v.is_finite()));
            }
        }
    }
}

/// Points of `spectral illuminance`.
pub fn points_file(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    match parse_points("fuzz.txt", &text) {
        Err(error) => named("fuzz.txt", &error.to_string(), &text),
        Ok(points) => {
            assert!(!points.is_empty());
            for point in points {
                assert!(
                    point.position.is_finite() && point.normal.is_finite() && point.normal.abs().max_element() > 0.0,
                    "{point:?}"
                );
            }
        }
    }
}

/// Readings of `spectral brdf fit`.
pub fn readings_file(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    match parse_readings("fuzz.csv", &text) {
        Err(error) => named("fuzz.csv", &error.to_string(), &text),
        Ok(readings) => {
            assert!(!readings.is_empty());
            assert!(readings.iter().all(|reading| reading.value >= 0.0 && reading.value.is_finite()));
        }
    }
}

/// Answers for `spectral verify --score`.
pub fn answers_file(bytes: &[u8]) {
    static CASES: OnceLock<Vec<Case>> = OnceLock::new();
    let text = String::from_utf8_lossy(bytes);
    if let Err(error) = Answers::parse("fuzz.csv", &text, CASES.get_or_init(|| cases(None))) {
        named("fuzz.csv", &error.to_string(), &text);
    }
}

/// One line that begins with the file's name, and with a line's number unless the fault is that something is missing.
fn named(file: &str, message: &str, text: &str) {
    super::assert_one_line(message);
    let rest =
        message.strip_prefix(file).and_then(|rest| rest.strip_prefix(':')).unwrap_or_else(|| panic!("{message}"));
    let number: String = rest.chars().take_while(char::is_ascii_digit).collect();
    if let Ok(line) = number.parse::<usize>() {
        // XML may end too early: in the line after the last one.
        assert!((1..=text.lines().count() + 1).contains(&line), "{message}");
    }
}
