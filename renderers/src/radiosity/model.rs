//! A field as if all leaves of a group had one radiosity: where spectra are split is planned there.

use spectral_core::adaptive::Mode;

use super::cell::{Cell, Part, Row, Spectra};
use super::coarse::Factored;
use super::field::{Field, Lit, Work};
use super::transport::{Buffer, Transport};

/// The model of a field: means over groups of leaves.
pub(super) fn model_field<'m>(
    field: &Field<'_>,
    mode: Mode,
    model: &'m Transport,
    spectra: &Spectra<'_>,
    buffer: &mut Buffer,
) -> Field<'m> {
    let coarse = &field.coarse;
    let mean = |values: &[f64]| {
        let mut means = vec![0.0; coarse.count()];
        for ((value, group), area) in values.iter().zip(&coarse.group).zip(&field.transport.areas) {
            means[*group] += value * area / coarse.areas[*group];
        }
        means
    };
    let of_lamp = |lit: &Lit| Lit { emitted: mean(&lit.emitted), direct: mean(&lit.direct), all: mean(&lit.all) };
    let mut result = Field {
        transport: model,
        surface: field.of_groups.clone(),
        reflectances: field.reflectances.clone(),
        lamps: field.lamps.iter().map(of_lamp).collect(),
        largest_sum: field.largest_sum,
        sums: &[],
        coarse: coarse.of_itself(),
        of_groups: field.of_groups.clone(),
        amplification: Vec::new(),
        amplified: Vec::new(),
        rounding: model.rounding(),
        bounces: field.bounces,
    };
    if mode == Mode::Certified {
        let greatest: Vec<f64> = result.reflectances.iter().map(|factor| spectra.greatest(*factor)).collect();
        result.amplify(&greatest, buffer);
    }
    result
}

impl Field<'_> {
    /// Reflected radiosity on some cells, with the mean of all channels, where each leaf is a group by itself: by elimination; by iteration where that
    /// fails, as it does for all groups if light never comes to an end in a closed space that no lamp shines into.
    pub(super) fn planned(&self, cells: &[Cell], work: &mut Work<'_>) -> Vec<Vec<Row>> {
        let rows = |cell: &Cell| {
            let rows = self.eliminated(cell);
            if rows.iter().all(|row| row.norm.is_finite() && row.value.iter().all(|value| value.is_finite())) {
                return rows;
            }
            self.solve(Mode::Paper, core::slice::from_ref(cell), work).pop().unwrap_or(rows)
        };
        cells.iter().map(rows).collect()
    }

    /// Reflected radiosity on a cell, with the mean of all channels, where each leaf is a group by itself: by elimination. Not finite where pivots
    /// vanish.
    fn eliminated(&self, cell: &Cell) -> Vec<Row> {
        let parts: Vec<Part> = self.reflectances.iter().map(|factor| cell.part(*factor)).collect();
        let of_part = |Part { mean: [x, y, z], common, .. }: &Part| [*x, *y, *z, *common];
        let reflectance: Vec<[f64; 4]> = self.surface.iter().map(|kind| of_part(&parts[*kind])).collect();
        let mut arriving: Vec<[f64; 4]> = self.lamps[cell.lamp].all.iter().map(|h| [*h; 4]).collect();
        Factored::new(&self.coarse, &reflectance).solve(&mut arriving);
        let row = |(h, rho): (&[f64; 4], &[f64; 4])| {
            let [x, y, z, common] = core::array::from_fn(|i| rho[i] * h[i]);
            Row { value: [x, y, z], norm: common, ..Row::default() }
        };
        arriving.iter().zip(&reflectance).map(row).collect()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests fail by panicking")]
mod tests {
    use spectral_core::adaptive::Mode;
    use spectral_core::interval::Node;

    use super::model_field;
    use crate::radiosity::cell::Spectra;
    use crate::radiosity::coarse::Coarse;
    use crate::radiosity::field::{Field, Lit, Work};
    use crate::radiosity::transport::{Buffer, Buffers, Transport};
    use crate::radiosity::{Radiosity, Settings};
    use crate::scene::builtin;
    use crate::spectral::{Factor, Palette};

    /// Elimination finds what iteration does.
    #[test]
    fn groups_are_solved_for_directly_as_by_iteration() {
        let scene = builtin::load("cornell-box", &[]).unwrap();
        let (mut palette, mut buffer, buffers) = (Palette::default(), Buffer::default(), Buffers::default());
        let settings = Settings { accuracy: 0.1, points: false, ..Settings::default() };
        let radiosity = Radiosity::new(&scene, &settings, &mut palette, &|_| {}).unwrap();
        let lamps = radiosity.lamps();
        let mut spectra = Spectra::new(&palette, false).unwrap();
        spectra.tabulate(&lamps);
        let field = radiosity.field(Mode::Paper, &lamps, &spectra, &mut buffer).unwrap();
        let transport = Transport::between(&field.coarse);
        let model = model_field(&field, Mode::Paper, &transport, &spectra, &mut buffer);
        for node in [Node::ROOT, Node::ROOT.children().unwrap()[0]] {
            let cell = spectra.cell(0, lamps[0], node).unwrap();
            let mut work = Work { tolerance: 1e-13, buffers: &buffers, report: &mut |_, _| {} };
            let iterated = model.solve(Mode::Paper, core::slice::from_ref(&cell), &mut work).remove(0);
            let found = model.eliminated(&cell);
            let most = iterated.iter().fold(0.0, |m: f64, row| m.max(row.norm));
            assert!(most > 0.0 && found.len() == iterated.len() && found.len() > 6);
            for (one, other) in found.iter().zip(&iterated) {
                let off = one.numbers().iter().zip(other.numbers()).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
                assert!(off <= 1e-11 * most, "{one:?} {other:?}");
            }
        }
    }

    /// Two groups that keep all light to themselves, but have none, don't hide what the third has.
    #[test]
    fn groups_that_lose_no_light_are_solved_for_by_iteration() {
        let coarse = Coarse {
            group: vec![0, 1, 2],
            areas: vec![1.0; 3],
            between: vec![0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.5],
            spread: Vec::new(),
        };
        let (transport, lit) = (Transport::between(&coarse), vec![0.0, 0.0, 1.0]);
        let field = Field {
            transport: &transport,
            surface: vec![0, 0, 1],
            reflectances: [1.0, 0.5].map(|scale| Factor { scale, leaf: None }).to_vec(),
            lamps: vec![Lit { emitted: vec![0.0; 3], direct: lit.clone(), all: lit }],
            largest_sum: 1.0,
            sums: &[],
            coarse,
            of_groups: vec![0, 0, 1],
            amplification: Vec::new(),
            amplified: Vec::new(),
            rounding: transport.rounding(),
            bounces: None,
        };
        let (palette, buffers) = (Palette::default(), Buffers::default());
        let spectra = Spectra::new(&palette, false).unwrap();
        let cell = spectra.cell(0, None, Node::ROOT).unwrap();
        assert!(field.eliminated(&cell)[2].norm.is_nan());
        let mut work = Work { tolerance: 1e-13, buffers: &buffers, report: &mut |_, _| {} };
        let rows = field.planned(&[cell], &mut work).remove(0);
        // ρ/(1 − ρK)
        for (row, radiosity) in rows.iter().zip([0.0, 0.0, 2.0 / 3.0]) {
            let numbers = row.value.iter().chain([&row.norm]);
            assert!(numbers.clone().all(|number| (number - radiosity).abs() <= 1e-12), "{row:?} {radiosity}");
        }
        assert_eq!(rows.len(), 3);
    }
}
