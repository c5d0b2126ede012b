//! Letters drawn as strokes: enough for the labels of legends and charts, at any size.
//!
//! A glyph is a string of strokes separated by `|`. A stroke is a list of points, two digits each: x to the right and y
//! down, on a grid where capitals reach from y = 0 to the baseline at y = [`BASELINE`], small letters from 2, and
//! descenders to 8. Straight lines join the points; after `~` they are quadratic Bézier curves, every second point a
//! control point.

/// The baseline, in units of the grid; the height of capitals and digits.
pub(super) const BASELINE: f32 = 6.0;
/// Space between glyphs, in units of the grid.
const GAP: f32 = 1.8;
/// Width of a space, in units of the grid, gap included.
const SPACE: f32 = 3.4;

/// One element of a stroke, in units of the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Segment {
    /// Starts a stroke.
    Move(f32, f32),
    /// A straight line.
    Line(f32, f32),
    /// A quadratic Bézier curve: control point and end.
    Curve(f32, f32, f32, f32),
}

/// The strokes of a text that starts at x = 0, and its width (without the last gap), in units of the grid.
pub(super) fn strokes(text: &str) -> (Vec<Segment>, f32) {
    let mut segments = Vec::new();
    let mut x = 0.0_f32;
    for character in text.chars() {
        if character == ' ' {
            x += SPACE;
            continue;
        }
        let glyph = glyph(character);
        glyph.split('|').for_each(|stroke| push_stroke(stroke, x, &mut segments));
        x += width(glyph) + GAP;
    }
    (segments, (x - GAP).max(0.0))
}

/// The largest x of a glyph.
fn width(glyph: &str) -> f32 {
    let largest = glyph.split('|').flat_map(points).fold(0.0, |largest: f32, (x, _)| largest.max(x));
    // Narrow glyphs such as a point need some room of their own.
    largest.max(0.4)
}

fn points(stroke: &str) -> impl Iterator<Item = (f32, f32)> {
    let digit = |byte: u8| f32::from(byte.saturating_sub(b'0'));
    stroke.trim_start_matches('~').split(' ').filter_map(move |pair| match *pair.as_bytes() {
        [x, y] => Some((digit(x), digit(y))),
        _ => None,
    })
}

fn push_stroke(stroke: &str, offset: f32, segments: &mut Vec<Segment>) {
    let curved = stroke.starts_with('~');
    let mut points = points(stroke).map(|(x, y)| (x + offset, y));
    let Some((x, y)) = points.next() else { return };
    segments.push(Segment::Move(x, y));
    while let Some((x, y)) = points.next() {
        segments.push(match curved.then(|| points.next()).flatten() {
            Some((end_x, end_y)) => Segment::Curve(x, y, end_x, end_y),
            None => Segment::Line(x, y),
        });
    }
}

/// The strokes of a character; an empty box for one that is not here.
#[rustfmt::skip]
fn glyph(character: char) -> &'static str {
    match character {
        '0' => "~20 40 43 46 26 06 03 00 20",
        '1' => "11 20 26|16 36",
        '2' => "~01 00 20 40 41 43 06|06 46",
        '3' => "~01 00 20 40 41 43 23|~23 43 45 46 26 06 05",
        '4' => "36 30 04 44",
        '5' => "40 00 02|~02 12 22 42 44 46 26 06 05",
        '6' => "~41 40 20 00 03 03 04 06 26 46 44 42 22 02 04",
        '7' => "00 40 16",
        '8' => "~20 40 41 43 23 03 01 00 20|~23 43 45 46 26 06 05 03 23",
        '9' => "~05 06 26 46 43 43 42 40 20 00 02 04 24 44 42",
        'A' => "06 20 46|14 34",
        'B' => "20 00 06 26|03 23|~20 40 41 43 23|~23 43 45 46 26",
        'C' => "~41 40 20 00 03 06 26 46 45",
        'D' => "10 00 06 16|~10 40 43 46 16",
        'E' => "40 00 06 46|03 33",
        'F' => "40 00 06|03 33",
        'G' => "~41 40 20 00 03 06 26 46 44|44 43 23",
        'H' => "00 06|40 46|03 43",
        'I' => "00 20|10 16|06 26",
        'J' => "30 34|~34 36 16 06 05",
        'K' => "00 06|40 04|13 46",
        'L' => "00 06 46",
        'M' => "06 00 24 40 46",
        'N' => "06 00 46 40",
        'O' => "~20 40 43 46 26 06 03 00 20",
        'P' => "06 00 20|~20 40 41 43 23|23 03",
        'Q' => "~20 40 43 46 26 06 03 00 20|34 46",
        'R' => "06 00 20|~20 40 41 43 23|23 03|23 46",
        'S' => "~41 40 20 00 01 03 23 43 45 46 26 06 05",
        'T' => "00 40|20 26",
        'U' => "00 04|~04 06 26 46 44|44 40",
        'V' => "00 26 40",
        'W' => "00 16 32 56 60",
        'X' => "00 46|40 06",
        'Y' => "00 23 40|23 26",
        'Z' => "00 40 06 46",
        'a' => "~22 42 44 46 26 06 04 02 22|42 46",
        'b' => "~22 42 44 46 26 06 04 02 22|00 06",
        'c' => "~43 42 22 02 04 06 26 46 45",
        'd' => "~22 42 44 46 26 06 04 02 22|40 46",
        'e' => "04 44|~44 42 22 02 04 06 26 36 45",
        'f' => "~30 10 12|12 16|02 32",
        'g' => "~22 42 44 46 26 06 04 02 22|42 46|~46 48 28 18 07",
        'h' => "00 06|~04 02 22 42 44|44 46",
        'i' => "02 06|00 00",
        'j' => "22 26|~26 28 08|20 20",
        'k' => "00 06|32 05|14 36",
        'l' => "00 05|~05 06 16",
        'm' => "02 06|~04 02 22 32 34|34 36|~34 32 52 62 64|64 66",
        'n' => "02 06|~04 02 22 42 44|44 46",
        'o' => "~22 42 44 46 26 06 04 02 22",
        'p' => "~22 42 44 46 26 06 04 02 22|02 08",
        'q' => "~22 42 44 46 26 06 04 02 22|42 48",
        'r' => "02 06|~04 02 32",
        's' => "~43 42 22 02 03 04 24 44 45 46 26 06 05",
        't' => "10 15|~15 16 26|02 32",
        'u' => "02 04|~04 06 26 46 44|42 46",
        'v' => "02 26 42",
        'w' => "02 16 33 56 62",
        'x' => "02 46|42 06",
        'y' => "02 25|42 08",
        'z' => "02 42 06 46",
        '.' => "06 06",
        ',' => "16 07",
        ':' => "03 03|06 06",
        ';' => "13 13|16 07",
        '!' => "00 04|06 06",
        '?' => "~01 00 20 40 41 43 24|26 26",
        '\'' => "00 02",
        '-' => "04 24",
        '−' => "03 43",
        '–' => "04 44",
        '_' => "07 47",
        '+' => "03 43|21 25",
        '±' => "02 42|20 24|06 46",
        '×' => "12 56|52 16",
        '·' => "03 03",
        '*' => "10 14|01 23|21 03",
        '/' => "06 40",
        '|' => "00 07",
        '%' => "06 40|~10 20 21 22 12 02 01 00 10|~34 44 45 46 36 26 25 24 34",
        '°' => "~10 20 21 22 12 02 01 00 10",
        '²' => "00 20 21 03 23",
        '(' => "~20 03 26",
        ')' => "~00 23 06",
        '[' => "20 00 06 26",
        ']' => "00 20 26 06",
        '<' => "41 03 45",
        '>' => "01 43 05",
        '≤' => "40 02 44|06 46",
        '≥' => "00 42 04|06 46",
        '=' => "02 42|04 44",
        'Δ' => "06 20 46 06",
        'µ' => "02 08|~04 06 26 46 44|42 46",
        _ => "00 40 46 06 00",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: &str = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz.,:;!?'-−–_+±×·*/|%°²()[]<>≤≥=Δµ";

    #[test]
    fn every_glyph_is_well_formed() {
        for character in ALL.chars() {
            for stroke in glyph(character).split('|') {
                let curved = stroke.starts_with('~');
                let pairs: Vec<&str> = stroke.trim_start_matches('~').split(' ').collect();
                assert!(pairs.iter().all(|pair| pair.len() == 2), "`{character}`: {stroke}");
                assert!(pairs.len() >= 2 && (!curved || pairs.len() % 2 == 1), "`{character}`: {stroke}");
                assert!(points(stroke).all(|(x, y)| (0.0..=6.0).contains(&x) && (0.0..=8.0).contains(&y)));
                assert_eq!(points(stroke).count(), pairs.len());
            }
        }
    }

    #[test]
    fn every_character_is_drawn_differently_but_o_and_zero() {
        let mut glyphs: Vec<_> = ALL.chars().filter(|c| *c != 'O').map(glyph).collect();
        let count = glyphs.len();
        glyphs.sort_unstable();
        glyphs.dedup();
        assert_eq!(glyphs.len(), count);
        assert!(!glyphs.contains(&glyph('\u{1f600}')), "the box stands for what is not here, and for nothing else");
    }

    #[test]
    fn texts_advance() {
        let (segments, width) = strokes("1");
        assert_eq!(segments[0], Segment::Move(1.0, 1.0));
        assert!((width - 3.0).abs() <= 1e-5);
        let (segments, width) = strokes("L 0");
        assert_eq!(segments[3], Segment::Move(2.0 + (4.0 + GAP + SPACE), 0.0));
        assert!(matches!(segments[4], Segment::Curve(..)));
        assert!((width - (8.0 + GAP + SPACE)).abs() <= 1e-5);
        assert_eq!(strokes(""), (Vec::new(), 0.0));
    }
}
