//! Lines of equal value in a map.

use super::{Raster, ScalarMap};
use std::collections::HashMap;

/// A line through points in pixels from the top left corner of the map, where the middle of the first pixel is at ½, ½.
pub(super) type Line = Vec<[f32; 2]>;

/// Lines shorter than this many points are noise.
const SHORTEST: usize = 16;
/// How often lines are smoothed.
const SMOOTHED: usize = 3;

/// The lines at a level, by marching squares between the middles of pixels.
///
/// Where neighbours differ by more than `jump` or belong to different parts (at edges of objects) there is none, nor where one has no value.
pub(super) fn contours(map: &ScalarMap, parts: Option<&Raster<u32>>, level: f64, jump: f64) -> Vec<Line> {
    let mut links = Links::default();
    for y in 0..map.height().saturating_sub(1) {
        for x in 0..map.width().saturating_sub(1) {
            if is_whole(parts, [x, y]) {
                cell(map, [x, y], level, jump, &mut links);
            }
        }
    }
    let mut lines: Vec<Line> = links.lines().into_iter().filter(|line| line.len() >= SHORTEST).collect();
    lines.iter_mut().for_each(|line| (0..SMOOTHED).for_each(|_| smooth(line)));
    lines
}

/// Whether four neighbouring pixels belong to one part.
fn is_whole(parts: Option<&Raster<u32>>, [x, y]: [usize; 2]) -> bool {
    parts.is_none_or(|parts| {
        let own = parts.get(x, y);
        [[x + 1, y], [x, y + 1], [x + 1, y + 1]].into_iter().all(|[x, y]| parts.get(x, y) == own)
    })
}

/// A map whose pixels are means over neighbours in 5 × 5 of the same part that are not further than `jump` from them: noise makes no lines
/// then.
pub(super) fn smoothed(map: &ScalarMap, parts: Option<&Raster<u32>>, jump: f64) -> ScalarMap {
    const REACH: usize = 2;
    let mut result = map.clone();
    let (width, height) = (map.width(), map.height());
    for (index, to) in result.pixels_mut().iter_mut().enumerate() {
        let (x, y) = (index % width, index / width);
        let own = f64::from(*to);
        let (mut sum, mut count) = (0.0, 0.0);
        for v in y.saturating_sub(REACH)..(y + REACH + 1).min(height) {
            for u in x.saturating_sub(REACH)..(x + REACH + 1).min(width) {
                let value = map.get(u, v).map_or(f64::NAN, |value| f64::from(*value));
                let same = parts.is_none_or(|parts| parts.get(u, v) == parts.get(x, y));
                if same && (value - own).abs() <= jump {
                    sum += value;
                    count += 1.0;
                }
            }
        }
        #[allow(clippy::cast_possible_truncation, reason = "maps are kept in f32")]
        if count > 0.0 {
            *to = (sum / count) as f32;
        }
    }
    result
}

/// Crossings of the level with edges between pixels, each linked to the next one on its line.
#[derive(Default)]
struct Links {
    /// For an edge, where it is crossed and its one or two neighbours on the line.
    edges: HashMap<usize, ([f32; 2], [Option<usize>; 2])>,
}

impl Links {
    fn link(&mut self, ends: [(usize, [f32; 2]); 2]) {
        for [(own, place), (other, _)] in [ends, [ends[1], ends[0]]] {
            let (_, next) = self.edges.entry(own).or_insert((place, [None; 2]));
            if next[0].is_none() {
                next[0] = Some(other);
            } else {
                next[1] = Some(other);
            }
        }
    }

    /// Lines from their ends, then closed ones; from the top, so that the result doesn't depend on the order of the table.
    fn lines(mut self) -> Vec<Line> {
        let mut keys: Vec<usize> = self.edges.keys().copied().collect();
        keys.sort_unstable();
        let is_end = |(_, next): &([f32; 2], [Option<usize>; 2])| next[1].is_none();
        let ends: Vec<usize> = keys.iter().copied().filter(|key| self.edges.get(key).is_some_and(is_end)).collect();
        ends.into_iter().chain(keys).filter_map(|start| self.follow(start)).collect()
    }

    /// The line from a crossing, which is taken out; `None` if it is gone already.
    fn follow(&mut self, start: usize) -> Option<Line> {
        let (place, mut next) = self.edges.remove(&start)?;
        let mut line = vec![place];
        while let Some((place, onwards)) = next.into_iter().flatten().find_map(|key| self.edges.remove(&key)) {
            line.push(place);
            next = onwards;
        }
        // A closed line ends where it began.
        if next.contains(&Some(start)) && line.len() > 2 {
            line.push(line[0]);
        }
        Some(line)
    }
}

/// Links the crossings within four neighbouring pixels.
fn cell(map: &ScalarMap, [x, y]: [usize; 2], level: f64, jump: f64, links: &mut Links) {
    let places = [[x, y], [x + 1, y], [x + 1, y + 1], [x, y + 1]];
    let values = places.map(|[x, y]| map.get(x, y).map_or(f64::NAN, |value| f64::from(*value)));
    let (least, most) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)));
    if !(values.iter().all(|v| v.is_finite()) && most - least <= jump && least < level && level <= most) {
        return;
    }
    let width = map.width();
    // Edges by the pixel at their left or top end: 0 to the right, 1 downwards.
    let keys = [2 * (y * width + x), 2 * (y * width + x + 1) + 1, 2 * ((y + 1) * width + x), 2 * (y * width + x) + 1];
    let crossing = |edge: usize| {
        let (a, b) = (values[edge], values[(edge + 1) % 4]);
        if (a < level) == (b < level) {
            return None;
        }
        let share = (level - a) / (b - a);
        let at = |axis: usize| {
            let (from, to) = (number(places[edge][axis]), number(places[(edge + 1) % 4][axis]));
            from + narrow(share) * (to - from) + 0.5
        };
        Some((keys[edge], [at(0), at(1)]))
    };
    match [0, 1, 2, 3].map(crossing) {
        // A saddle: by the middle, high ground is joined or parted.
        [Some(a), Some(b), Some(c), Some(d)] => {
            let middle = values.iter().sum::<f64>() / 4.0;
            if (middle < level) == (values[0] < level) {
                links.link([a, b]);
                links.link([c, d]);
            } else {
                links.link([a, d]);
                links.link([b, c]);
            }
        }
        crossings => {
            let mut crossed = crossings.into_iter().flatten();
            if let (Some(a), Some(b)) = (crossed.next(), crossed.next()) {
                links.link([a, b]);
            }
        }
    }
}

/// Moves every point but the ends to the middle between itself and that of its neighbours.
fn smooth(line: &mut [[f32; 2]]) {
    let Some(mut before) = line.first().copied() else { return };
    for index in 1..line.len().saturating_sub(1) {
        let (own, after) = (line[index], line[index + 1]);
        line[index] = core::array::from_fn(|a| 0.25 * before[a] + 0.5 * own[a] + 0.25 * after[a]);
        before = own;
    }
}

#[allow(clippy::cast_precision_loss, reason = "pixels of a picture are far below 2^24")]
fn number(pixel: usize) -> f32 {
    pixel as f32
}

#[allow(clippy::cast_possible_truncation, reason = "a place in a drawing")]
fn narrow(share: f64) -> f32 {
    share as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cone(width: usize, height: usize) -> ScalarMap {
        let value = |x: usize, y: usize| (number(x) + 0.5 - 20.0).hypot(number(y) + 0.5 - 15.0);
        ScalarMap::from_fn(width, height, value).unwrap()
    }

    #[test]
    fn a_cone_has_circles() {
        let lines = contours(&cone(40, 30), None, 10.0, 100.0);
        assert_eq!(lines.len(), 1);
        assert_eq!(lines[0].first(), lines[0].last());
        for [x, y] in &lines[0] {
            let radius = (x - 20.0).hypot(y - 15.0);
            // Smoothing shrinks a circle a little.
            assert!((radius - 10.0).abs() <= 0.2, "{radius}");
        }
    }

    #[test]
    fn lines_end_at_the_border_and_where_there_is_nothing() {
        let mut map = ScalarMap::from_fn(60, 40, |_, y| number(y)).unwrap();
        assert_eq!(contours(&map, None, 9.75, 100.0).len(), 1);
        for y in 0..40 {
            map.pixels_mut()[y * 60 + 30] = f32::NAN;
        }
        let lines = contours(&map, None, 9.75, 100.0);
        assert_eq!(lines.len(), 2);
        assert!(lines.iter().flatten().all(|[_, y]| (y - 10.25).abs() <= 1e-5));
    }

    #[test]
    fn edges_of_objects_are_no_lines() {
        let map = ScalarMap::from_fn(40, 40, |x, _| if x < 20 { 0.0 } else { 10.0 }).unwrap();
        assert!(contours(&map, None, 5.0, 8.0).is_empty());
        assert_eq!(contours(&map, None, 5.0, 20.0).len(), 1);
        let parts = Raster::from_fn(40, 40, |x, _| u32::from(x >= 20)).unwrap();
        assert!(contours(&map, Some(&parts), 5.0, 20.0).is_empty());
        let smooth = smoothed(&map, Some(&parts), 100.0);
        assert_eq!((smooth.get(19, 5), smooth.get(20, 5)), (Some(&0.0), Some(&10.0)));
    }

    #[test]
    fn a_saddle_has_two_lines() {
        let map = ScalarMap::from_fn(41, 41, |x, y| (number(x) - 20.3) * (number(y) - 20.2)).unwrap();
        assert_eq!(contours(&map, None, 0.5, 1000.0).len(), 2);
        assert_eq!(contours(&map, None, -0.5, 1000.0).len(), 2);
    }

    #[test]
    fn smoothing_keeps_edges_and_planes() {
        let map = ScalarMap::from_fn(20, 20, |x, y| if x < 10 { 0.1 * number(y) } else { 50.0 }).unwrap();
        let smooth = smoothed(&map, None, 5.0);
        assert!((smooth.get(9, 10).unwrap() - 1.0).abs() <= 1e-6);
        assert!((smooth.get(10, 10).unwrap() - 50.0).abs() <= 1e-5);
    }
}
