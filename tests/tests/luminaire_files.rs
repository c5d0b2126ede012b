//! Photometric files in the dialects that there are, and what is refused, with line and field.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test stops at the first thing that should not be")]

use core::f64::consts::PI;

use renderers::luminaire::{Format, LARGEST_FILE, PhotometricFile, Symmetry, parse, parse_eulumdat, parse_ies, read};

/// Factors multiply to 0.45; a quarter of the circle.
const IES: &str =
    "IESNA:LM-63-2002\n[TEST] 7\nTILT=NONE\n2 1000 0.5 3 2 1 2 0.1 0.2 0\n0.9 1 60\n0 45 90\n0 90\n10 8 0\n10 6 0\n";

/// Planes 0 and 90 of four, for a lamp flux of 2000 lm.
const LDT: [&str; 55] = [
    "Company", "3", "4", "4", "90", "3", "45", "report", "name", "number", "file", "date", "600", "300", "80", "500",
    "200", "10", "0", "0", "0", "100", "80", "1", "0", "1", "2", "T5", "2000", "840", "80", "60", "0", "0", "0", "0",
    "0", "0", "0", "0", "0", "0", "0", "90", "180", "270", "0", "45", "90", "10", "8", "0", "10", "6", "0",
];

fn ldt(lines: &[&str]) -> String {
    lines.iter().map(|line| format!("{line}\r\n")).collect()
}

/// The LDT text with a line replaced, counted from 1.
fn ldt_with(changes: &[(usize, &str)]) -> String {
    let mut lines = LDT;
    for (line, text) in changes {
        lines[line - 1] = text;
    }
    ldt(&lines)
}

/// The LDT text with all planes from line 50 on: symmetry and one value at the nadir for each plane.
fn ldt_planes(symmetry: &str, values: &[&str]) -> String {
    let text = ldt_with(&[(3, symmetry)]);
    let head: String = text.split_inclusive('\n').take(49).collect();
    head + &values.iter().map(|value| format!("{value}\n5\n0\n")).collect::<String>()
}

fn ies(text: &str) -> PhotometricFile {
    parse_ies("a.ies", text).unwrap_or_else(|error| panic!("{error}"))
}

fn eulumdat(text: &str) -> PhotometricFile {
    parse_eulumdat("a.ldt", text).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn all_factors_of_an_ies_file_count() {
    let file = ies(IES);
    assert_eq!(file.format, Format::Ies2002);
    assert_eq!(file.labels, ["[TEST] 7"]);
    let factor = 0.5 * 0.9 * 1.0;
    assert_eq!(file.intensity.as_table().unwrap().2, [10.0, 8.0, 0.0, 10.0, 6.0, 0.0].map(|v| v * factor));
    assert_eq!(file.intensity.symmetry(), Symmetry::Quadrant);
    assert_eq!((file.opening.width, file.opening.length, file.opening.height), (0.1, 0.2, 0.0));
    let lamps = &file.lamp_sets[0];
    assert_eq!((lamps.number, lamps.lumens_per_lamp, lamps.watts), (2, Some(1000.0), 60.0));
    let check = file.flux_check();
    assert_eq!((check.lamp_flux, check.stated_flux), (Some(2000.0), None));
    assert!((check.output_ratio.unwrap() - check.flux / 2000.0).abs() <= 1e-15);
    assert_eq!(check.downward_fraction, 1.0);
}

#[test]
fn editions_differ_in_the_ballast_lamp_factor_alone() {
    let peak = |text: &str| {
        let file = ies(text);
        (file.format, file.intensity.peak())
    };
    let edition = |first: &str| IES.replace("IESNA:LM-63-2002", first).replace("0.9 1 60", "0.9 0.5 60");
    assert_eq!(peak(&edition("A luminaire without an edition")), (Format::Ies1986, 0.5 * 0.9 * 0.5 * 10.0));
    assert_eq!(peak(&edition("IESNA91")), (Format::Ies1991, 0.5 * 0.9 * 0.5 * 10.0));
    assert_eq!(peak(&edition("IESNA:LM-63-1995")), (Format::Ies1995, 4.5));
    assert_eq!(peak(&edition("iesna:lm-63-2002 ")), (Format::Ies2002, 4.5));
    assert_eq!(peak(&edition("IES:LM-63-2019")), (Format::Ies2019, 4.5));
    let bare = IES.lines().skip(2).collect::<Vec<_>>().join("\n");
    assert_eq!(ies(&bare).labels, Vec::<String>::new());
    assert_eq!(ies(&edition("first label")).labels, ["first label", "[TEST] 7"]);
}

#[test]
fn numbers_may_stand_anywhere_after_the_tilt() {
    let plain = ies(IES);
    let one_line =
        IES.replacen("\n2 1000", "\n2\n1000", 1).replace(" 60\n0 45", " 60 0 45").replace("0 90\n0 90", "0,90,0, 90");
    for text in [
        one_line,
        IES.replace('\n', "\r\n"),
        IES.replace("10 8 0\n", "10\n\n8\n\t0 "),
        IES.replace("TILT=NONE", "  tilt = none  "),
        format!("\u{feff}{IES}\u{1a}"),
        IES.trim_end().to_owned(),
        IES.replace("1000", "1e3").replace("0.5", "+.5"),
    ] {
        let found = ies(&text);
        assert_eq!((found.intensity, found.lamp_sets), (plain.intensity.clone(), plain.lamp_sets.clone()), "{text:?}");
    }
}

#[test]
fn feet_become_metres_and_absolute_photometry_has_no_lamps() {
    let file = ies(&IES.replace("2 1000 0.5 3 2 1 2 0.1 0.2 0", "1 -1 0.5 3 2 1 1 1 -2 0.5"));
    assert_eq!((file.opening.width, file.opening.length, file.opening.height), (0.3048, -0.6096, 0.1524));
    assert_eq!((file.lamp_sets[0].lumens_per_lamp, file.flux_check().lamp_flux), (None, None));
}

#[test]
fn an_included_tilt_is_kept_and_written() {
    let file = ies(&IES.replace("TILT=NONE", "TILT=INCLUDE\n1\n3\n0 45 90\n1 0.9\n0.8"));
    let tilt = file.tilt.as_ref().unwrap();
    assert_eq!((tilt.geometry, &tilt.angles[..], &tilt.factors[..]), (1, &[0.0, 45.0, 90.0][..], &[1.0, 0.9, 0.8][..]));
    assert_eq!(file.intensity, ies(IES).intensity);
    assert_eq!(ies(&file.to_ies()), file);
}

#[test]
fn eulumdat_is_absolute_by_its_lamps() {
    let file = eulumdat(&ldt(&LDT));
    // 2000 lm of two lamps: 2 cd for each cd/klm.
    assert_eq!(
        file.intensity.as_table().unwrap(),
        (&[0.0, 90.0][..], &[0.0, 45.0, 90.0][..], &[20.0, 16.0, 0.0, 20.0, 12.0, 0.0][..])
    );
    assert_eq!((file.stated_flux, file.stated_downward_fraction), (Some(1600.0), Some(1.0)));
    assert_eq!(file.lamp_sets[0].lumens_per_lamp, Some(1000.0));
    assert_eq!((file.opening.width, file.opening.length, file.opening.height), (0.5, 0.2, 0.01));
    assert_eq!(file.labels[..3], ["[MANUFAC] Company", "[TEST] report", "[LUMINAIRE] name"]);
    // A round opening; the conversion factor, decimal commas, and absolute photometry.
    let round = eulumdat(&ldt_with(&[(17, "0"), (24, "0,5"), (27, "-1")]));
    assert_eq!((round.opening.width, round.opening.length), (-0.5, -0.5));
    assert_eq!((round.intensity.peak(), round.lamp_sets[0].lumens_per_lamp), (10.0, None));
    // What has no effect may be blank.
    let blank = [5, 7, 13, 14, 15, 19, 22, 23, 25, 30, 31, 32, 33, 42].map(|line| (line, ""));
    let blank = eulumdat(&ldt_with(&blank));
    assert_eq!((&blank.intensity, blank.stated_flux), (&file.intensity, None));
}

#[test]
fn lamp_sets_stand_in_groups() {
    let (head, tail) = (ldt(&LDT[..25]), ldt(&LDT[32..]));
    let file = eulumdat(&format!("{head}2\n2\n1\nT5\nLED\n2000\n3000\n840\n930\n80\n90\n60\n20\n{tail}"));
    let sets: Vec<_> =
        file.lamp_sets.iter().map(|s| (s.number, s.lumens_per_lamp, s.watts, &s.kind[..], s.factor)).collect();
    assert_eq!(sets, [(2, Some(1000.0), 60.0, "T5", 1.0), (1, Some(3000.0), 20.0, "LED", 1.5)]);
    assert_eq!(file.intensity, eulumdat(&ldt(&LDT)).intensity);
}

/// Four planes whose values at the nadir name them, under each symmetry: what is at C 0, 90, 180 and 270.
#[test]
fn eulumdat_symmetries_store_the_planes_that_they_say() {
    for (symmetry, values, stands_for, expected) in [
        ("0", &["1", "2", "3", "4"][..], Symmetry::None, [1.0, 2.0, 3.0, 4.0]),
        ("1", &["1"][..], Symmetry::Axial, [1.0; 4]),
        ("2", &["1", "2", "3"][..], Symmetry::AboutC0, [1.0, 2.0, 3.0, 2.0]),
        // Planes 270, 0 and 90.
        ("3", &["4", "1", "2"][..], Symmetry::AboutC90, [1.0, 2.0, 1.0, 4.0]),
        ("4", &["1", "2"][..], Symmetry::Quadrant, [1.0, 2.0, 1.0, 2.0]),
    ] {
        let file = eulumdat(&ldt_planes(symmetry, values));
        assert_eq!(file.intensity.symmetry(), stands_for);
        let found = [0.0, 90.0, 180.0, 270.0].map(|c| file.intensity.candela(c, 0.0) / 2.0);
        assert_eq!(found, expected, "symmetry {symmetry}");
        assert_eq!(file.intensity.candela(45.0, 0.0) / 2.0, (expected[0] + expected[1]) / 2.0);
        assert_eq!(file.intensity.candela(315.0, 0.0) / 2.0, (expected[0] + expected[3]) / 2.0);
    }
}

/// The same luminaire in both formats.
#[test]
fn both_formats_say_the_same() {
    let from_ies = ies("IESNA91\nTILT=NONE\n1 2000 2 3 3 1 2 0 0 0\n1 1 0\n0 45 90\n90 180 270\n2 5 0\n1 5 0\n4 5 0\n");
    let from_ldt = eulumdat(&ldt_planes("3", &["4", "1", "2"]));
    assert_eq!(from_ies.intensity, from_ldt.intensity);
    let again = ies(&from_ldt.to_ies());
    assert_eq!(again.intensity, from_ldt.intensity);
}

#[test]
fn what_a_file_states_is_checked_and_reported() {
    // Isotropic, 100 cd/klm: 400π lm of 2000·0.8.
    let isotropic = ldt_with(&[(3, "1"), (48, "90"), (49, "180"), (50, "100"), (51, "100"), (52, "100"), (22, "50")]);
    let text: String = isotropic.split_inclusive('\n').take(52).collect();
    let check = eulumdat(&text).flux_check();
    assert!((check.flux / (800.0 * PI) - 1.0).abs() <= 1e-14);
    assert_eq!((check.stated_flux, check.stated_downward_fraction), (Some(1600.0), Some(0.5)));
    assert!((check.downward_fraction - 0.5).abs() <= 1e-15);
    assert!((check.output_ratio.unwrap() - 0.4 * PI).abs() <= 1e-14);
}

/// The number of the line, what stands there instead, the line to be named and the error behind it.
type Row = (usize, &'static str, u32, &'static str);

#[track_caller]
fn assert_refused(
    found: Result<PhotometricFile, renderers::luminaire::PhotometricFileError>,
    file: &str,
    line: u32,
    message: &str,
) {
    let error = found.err().unwrap_or_else(|| panic!("not refused: {message}"));
    assert_eq!(error.to_string(), format!("{file}:{line}: {message}"));
}

#[test]
fn bad_ies_files_are_refused_with_line_and_field() {
    let rows: [Row; 47] = [
        (
            1,
            "IESNA:LM-63-2044",
            1,
            "edition: \"IESNA:LM-63-2044\" is not supported (supported: IESNA91, IESNA:LM-63-1995, IESNA:LM-63-2002, IES:LM-63-2019; none for 1986)",
        ),
        (3, "", 9, "TILT: the file ends before it"),
        (
            3,
            "TILT=lamp.tlt",
            3,
            "TILT: \"lamp.tlt\" is not supported (supported: NONE, INCLUDE; not a file of its own)",
        ),
        (3, "TILT=", 3, "TILT: \"\" is not supported (supported: NONE, INCLUDE; not a file of its own)"),
        (3, "TILT=INCLUDE\n4", 4, "lamp-to-luminaire geometry: \"4\" is not supported (supported: 1, 2 or 3)"),
        (3, "TILT=INCLUDE\n1 0", 4, "number of tilt angles: must be from 1 to 1000000, not 0.0"),
        (3, "TILT=INCLUDE\n1 2\n10 10\n1 1", 5, "tilt angle 2: 10.0 is not above 10.0, the angle before it"),
        (3, "TILT=INCLUDE\n1 2\n0 10\n1\n-1", 7, "tilt factor 2: must be zero or positive, not -1.0"),
        (4, "two 1000 1 3 2 1 2 0 0 0", 4, "number of lamps: \"two\" is not a number"),
        (4, "0 1000 1 3 2 1 2 0 0 0", 4, "number of lamps: must be from 1 to 1000000, not 0.0"),
        (4, "1.5 1000 1 3 2 1 2 0 0 0", 4, "number of lamps: 1.5 is not a whole number"),
        (4, "1 0 1 3 2 1 2 0 0 0", 4, "lumens per lamp: must be positive, or -1 for absolute photometry, not 0.0"),
        (4, "1 -2 1 3 2 1 2 0 0 0", 4, "lumens per lamp: must be positive, or -1 for absolute photometry, not -2.0"),
        (4, "1 inf 1 3 2 1 2 0 0 0", 4, "lumens per lamp: \"inf\" is not finite"),
        (4, "1 1000 0 3 2 1 2 0 0 0", 4, "candela multiplier: must be positive, not 0.0"),
        (4, "1 1000 nan 3 2 1 2 0 0 0", 4, "candela multiplier: \"nan\" is not finite"),
        (4, "1 1000 1 1 2 1 2 0 0 0", 4, "number of vertical angles: must be from 2 to 1000000, not 1.0"),
        (4, "1 1000 1 2.5 2 1 2 0 0 0", 4, "number of vertical angles: 2.5 is not a whole number"),
        (4, "1 1000 1 3 -2 1 2 0 0 0", 4, "number of horizontal angles: must be from 1 to 1000000, not -2.0"),
        (4, "1 1000 1 3 1e300 1 2 0 0 0", 4, "number of horizontal angles: must be from 1 to 1000000, not 1e300"),
        (
            4,
            "1 1000 1 3 2 2 2 0 0 0",
            4,
            "photometric type: \"2\" is not supported (supported: 1, type C; types A and B are those of floodlights and headlights)",
        ),
        (
            4,
            "1 1000 1 3 2 3 2 0 0 0",
            4,
            "photometric type: \"3\" is not supported (supported: 1, type C; types A and B are those of floodlights and headlights)",
        ),
        (4, "1 1000 1 3 2 1 3 0 0 0", 4, "units type: \"3\" is not supported (supported: 1 for feet, 2 for metres)"),
        (4, "1 1000 1 3 2 1 2 1e999 0 0", 4, "width: \"1e999\" is not finite"),
        (4, "1 1000 1 3 2 1 2 0 ? 0", 4, "length: \"?\" is not a number"),
        (4, "1 1000 1 3 2 1 2 0 0 NaN", 4, "height: \"NaN\" is not finite"),
        (5, "-0.9 1 60", 5, "ballast factor: must be positive, not -0.9"),
        (5, "0.9 one 60", 5, "future use or file generation type: \"one\" is not a number"),
        (5, "0.9 1 -60", 5, "input watts: must be zero or positive, not -60.0"),
        (6, "0 45 45", 6, "vertical angle 3: 45.0 is not above 45.0, the angle before it"),
        (6, "0 45 30", 6, "vertical angle 3: 30.0 is not above 45.0, the angle before it"),
        (
            6,
            "0 45 85",
            6,
            "vertical angles: 0.0 to 85.0 degrees is not a range of this format (γ: 0 to 90, 90 to 180 or 0 to 180)",
        ),
        (
            6,
            "5 45 90",
            6,
            "vertical angles: 5.0 to 90.0 degrees is not a range of this format (γ: 0 to 90, 90 to 180 or 0 to 180)",
        ),
        (
            6,
            "0\n45\n190",
            8,
            "vertical angles: 0.0 to 190.0 degrees is not a range of this format (γ: 0 to 90, 90 to 180 or 0 to 180)",
        ),
        (6, "0 45 9x", 6, "vertical angle 3: \"9x\" is not a number"),
        (
            7,
            "0 45",
            7,
            "horizontal angles: 0.0 to 45.0 degrees is not a range of this format (C-planes: 0 alone, 0 to 90, 0 to 180, 90 to 270 or 0 to 360)",
        ),
        (
            7,
            "90 180",
            7,
            "horizontal angles: 90.0 to 180.0 degrees is not a range of this format (C-planes: 0 alone, 0 to 90, 0 to 180, 90 to 270 or 0 to 360)",
        ),
        (7, "0 0", 7, "horizontal angle 2: 0.0 is not above 0.0, the angle before it"),
        (7, "90\n0", 8, "horizontal angle 2: 0.0 is not above 90.0, the angle before it"),
        (8, "10 -8 0", 8, "candela at C 0, γ 45: must not be negative, but is -3.6"),
        (8, "10 inf 0", 8, "candela at C 0, γ 45: \"inf\" is not finite"),
        (8, "10 8,5 0", 9, "\"0\" stands after the last value"),
        (9, "10 6", 9, "candela at C 90, γ 90: the file ends before it"),
        (9, "", 9, "candela at C 90, γ 0: the file ends before it"),
        (9, "10 6 0\n\nEND", 11, "\"END\" stands after the last value"),
        (9, "10 6 0 1e308", 9, "\"1e308\" stands after the last value"),
        (9, "1.7e308 1.7e308 1.7e308", 9, "candela: the luminous flux leaves the range of numbers"),
    ];
    for (line, replacement, at, message) in rows {
        let text: String =
            (1..).zip(IES.lines()).map(|(n, old)| format!("{}\n", if n == line { replacement } else { old })).collect();
        assert_refused(parse_ies("a.ies", &text), "a.ies", at, message);
    }
    assert_refused(parse_ies("a.ies", ""), "a.ies", 1, "TILT: the file ends before it");
}

#[test]
fn bad_eulumdat_files_are_refused_with_line_and_field() {
    let rows: [Row; 37] = [
        (2, "4", 2, "type indicator: must be from 0 to 3, not 4.0"),
        (3, "5", 3, "symmetry indicator: must be from 0 to 4, not 5.0"),
        (3, "-1", 3, "symmetry indicator: must be from 0 to 4, not -1.0"),
        (3, "1.5", 3, "symmetry indicator: 1.5 is not a whole number"),
        (4, "0", 4, "number of C-planes: must be from 1 to 1000000, not 0.0"),
        (4, "6", 4, "number of C-planes: must be a multiple of 4 for symmetries 3 and 4, not 6.0"),
        (4, "", 4, "number of C-planes: \"\" is not a number"),
        (4, "8", 47, "C angle 5: 0.0 is not above 270.0, the angle before it"),
        (5, "wide", 5, "distance between C-planes: \"wide\" is not a number"),
        (6, "1", 6, "number of intensities in a C-plane: must be from 2 to 1000000, not 1.0"),
        (6, "1e7", 6, "number of intensities in a C-plane: must be from 2 to 1000000, not 10000000.0"),
        (16, "inf", 16, "length of luminous area: \"inf\" is not finite"),
        (20, "x", 20, "height of luminous area, C180-plane: \"x\" is not a number"),
        (23, "nan", 23, "light output ratio: \"nan\" is not finite"),
        (24, "0", 24, "conversion factor: must be positive, not 0.0"),
        (26, "0", 26, "number of lamp sets: must be from 1 to 1000000, not 0.0"),
        (26, "2", 28, "number of lamps: \"T5\" is not a number"),
        (27, "0", 27, "number of lamps: must be neither 0 nor above 1000000, not 0.0"),
        (27, "0.5", 27, "number of lamps: 0.5 is not a whole number"),
        (29, "0", 29, "flux of lamps: must be positive, not 0.0"),
        (29, "-2000", 29, "flux of lamps: must be positive, not -2000.0"),
        (32, "-60", 32, "wattage: must be zero or positive, not -60.0"),
        (16, "-500", 16, "length of luminous area: must be zero or positive, not -500.0"),
        (22, "-1", 22, "downward flux fraction: must be zero or positive, not -1.0"),
        (32, "lots", 32, "wattage: \"lots\" is not a number"),
        (42, "?", 42, "direct ratio 10: \"?\" is not a number"),
        (43, "10", 43, "C angle 1: must be 0, where the planes begin, not 10.0"),
        (44, "80", 44, "C angle 2: must be 90, a quarter of the planes on, for symmetries 3 and 4, not 80.0"),
        (45, "90", 45, "C angle 3: 90.0 is not above 90.0, the angle before it"),
        (46, "360", 46, "C angle 4: must be below 360, not 360.0"),
        (
            47,
            "10",
            49,
            "G angles: 10.0 to 90.0 degrees is not a range of this format (γ: 0 to 90, 90 to 180 or 0 to 180)",
        ),
        (48, "0", 48, "G angle 2: 0.0 is not above 0.0, the angle before it"),
        (
            49,
            "100",
            49,
            "G angles: 0.0 to 100.0 degrees is not a range of this format (γ: 0 to 90, 90 to 180 or 0 to 180)",
        ),
        (51, "-8", 51, "candela at C 0, γ 45: must not be negative, but is -16"),
        (52, "1e400", 52, "candela at C 0, γ 90: \"1e400\" is not finite"),
        (54, "6 0", 54, "candela at C 90, γ 45: \"6 0\" is not a number"),
        (55, "0\r\n\r\nmore", 57, "\"more\" stands after the last value"),
    ];
    for (line, replacement, at, message) in rows {
        assert_refused(parse_eulumdat("a.ldt", &ldt_with(&[(line, replacement)])), "a.ldt", at, message);
    }
    for (symmetry, change, at, message) in [
        ("2", (45, "170"), 45, "C angle 3: must be 180, half of the planes on, for symmetry 2, not 170.0"),
        ("3", (46, "280"), 46, "C angle 4: must be 270, three quarters of the planes on, for symmetry 3, not 280.0"),
        ("2", (4, "3"), 4, "number of C-planes: must be even for symmetry 2, not 3.0"),
    ] {
        assert_refused(parse_eulumdat("a.ldt", &ldt_with(&[(3, symmetry), change])), "a.ldt", at, message);
    }
}

#[test]
fn a_file_cut_anywhere_is_refused_where_it_ends() {
    for lines in 0..LDT.len() {
        let error = parse_eulumdat("a.ldt", &ldt(&LDT[..lines])).unwrap_err();
        assert_eq!(error.line as usize, lines.max(1), "{error}");
        assert!(error.to_string().ends_with(": the file ends before it") && !error.field.is_empty(), "{error}");
    }
    let words: Vec<_> = IES.match_indices([' ', '\n']).map(|(at, _)| at).collect();
    for at in &words[..words.len() - 1] {
        let error = parse_ies("a.ies", &IES[..*at]).unwrap_err();
        assert!(error.to_string().ends_with(": the file ends before it") && !error.field.is_empty(), "{error}");
    }
}

#[test]
fn symmetry_3_names_the_lines_of_its_own_order() {
    let text = ldt_planes("3", &["4", "-1", "2"]);
    assert_refused(
        parse_eulumdat("a.ldt", &text),
        "a.ldt",
        53,
        "candela at C 180, γ 0: must not be negative, but is -2",
    );
}

#[test]
fn files_are_read_by_their_ending_up_to_a_limit() {
    assert_eq!(parse("x/A.IES", IES).unwrap(), ies(IES));
    assert_eq!(parse("a.Ldt", &ldt(&LDT)).unwrap(), eulumdat(&ldt(&LDT)));
    let error = parse("a.txt", IES).unwrap_err();
    assert_eq!(error.to_string(), "a.txt: file name extension: \"txt\" is not supported (supported: ies, ldt)");
    let long = IES.to_owned() + &" ".repeat(LARGEST_FILE);
    assert_eq!(parse("a.ies", &long).unwrap_err().to_string(), "a.ies: the file has more than 16 MiB");
    assert_eq!(parse("a.ldt", &long).unwrap_err().to_string(), "a.ldt: the file has more than 16 MiB");

    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
    let path = folder.join("latin1.ies");
    // A name in Latin-1.
    std::fs::write(
        &path,
        IES.replace("[TEST] 7", "[TEST] \u{1}").bytes().map(|b| if b == 1 { 0xe9 } else { b }).collect::<Vec<_>>(),
    )
    .unwrap();
    let file = read(&path).unwrap();
    assert_eq!((file.labels, file.intensity), (vec!["[TEST] \u{fffd}".to_owned()], ies(IES).intensity));
    std::fs::write(folder.join("long.ies"), long).unwrap();
    assert!(
        read(&folder.join("long.ies")).unwrap_err().to_string().ends_with("long.ies: the file has more than 16 MiB")
    );
    assert!(read(&folder.join("none.ies")).unwrap_err().to_string().contains("none.ies: cannot read the file: "));
}
