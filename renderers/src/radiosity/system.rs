//! Solutions for representations that leave no bounds to be solved for, and what residual and balance say of any solution.

use alloc::sync::Arc;

use super::coupled::Coupled;
use super::representation::{self, Representation};
use super::solution::{Lights, Solution};
use super::solve::{Solved, System};
use super::transport::{Buffer, Buffers};
use super::{Radiosity, RadiosityError, Report, mesh};

/// Components that are solved for together.
const BLOCK: usize = 32;

/// What one component has at one leaf.
pub(super) struct Part {
    /// Radiosity that is sent out, and irradiance from lights without area.
    pub(super) emitted: f64,
    pub(super) direct: f64,
    /// All irradiance, what is reflected of it, and what was solved for.
    pub(super) arriving: f64,
    pub(super) leaving: f64,
    pub(super) reflected: f64,
}

/// What residual and balance of a solution say, component by component.
pub(super) struct Judgement {
    components: Vec<Component>,
    steps: usize,
}

#[derive(Clone, Copy, Default)]
struct Component {
    sent: f64,
    kept: f64,
    largest: f64,
    residual: f64,
    amplification: f64,
}

impl Judgement {
    /// From the areas of all leaves with what they see of patches, ΣF.
    pub(super) fn new(
        leaves: (&[f64], &[f64]),
        solved: &Solved,
        amplification: &[f64],
        part: impl Fn(usize, usize) -> Part,
    ) -> Self {
        let known = solved.residual.iter().zip(amplification);
        let component = |(residual, amplification): (&f64, &f64)| Component {
            residual: *residual,
            amplification: *amplification,
            ..Component::default()
        };
        let mut components: Vec<Component> = known.map(component).collect();
        for (leaf, (area, sum)) in leaves.0.iter().zip(leaves.1).enumerate() {
            for (index, component) in components.iter_mut().enumerate() {
                let Part { emitted, direct, arriving, leaving, reflected } = part(leaf, index);
                component.sent += area * (emitted + direct);
                component.kept += area * (arriving - leaving + (emitted + reflected) * (1.0 - sum));
                component.largest = component.largest.max(reflected.abs());
            }
        }
        Self { components, steps: solved.steps }
    }

    /// Notes what is worst.
    pub(super) fn note(&self, report: &mut Report) {
        report.iterations = report.iterations.max(self.steps);
        for component in self.components.iter().filter(|component| component.largest > 0.0) {
            let Component { sent, kept, largest, residual, amplification } = component;
            let residual = residual / largest;
            report.residual = report.residual.max(residual);
            let bounded = *amplification > 1.0 || residual == 0.0;
            let error = if bounded { residual * amplification } else { f64::INFINITY };
            report.iteration_error = report.iteration_error.max(error);
            let balance = if *sent == 0.0 { 0.0 } else { (sent - kept) / sent };
            if balance.abs() >= report.energy_balance.abs() {
                report.energy_balance = balance;
            }
        }
    }
}

impl Radiosity {
    /// The radiosity of all patches, for all numbers of a representation of the palette's spectra: by conjugate gradients where a reflectance
    /// multiplies number by number, by GMRES elsewhere. [`solve_intervals`](Self::solve_intervals) splits the spectrum by itself.
    ///
    /// # Errors
    /// [`RadiosityError::NoSolution`] where the surfaces around a closed space reflect everything.
    pub fn solve<'r>(&'r self, representation: &'r dyn Representation) -> Result<Solution<'r>, RadiosityError> {
        if !representation.is_diagonal() {
            return self.solve_coupled(representation);
        }
        let width = representation.width();
        let leaves = self.transport.leaves.len();
        let mut reflected = vec![0.0; leaves * width];
        let mut report = Report { intervals: representation.intervals(), ..self.report() };
        let (mut buffer, buffers) = (Buffer::default(), Buffers::default());
        let spectra = Spectra::new(self, representation);
        for first in (0..width).step_by(BLOCK) {
            let block = BLOCK.min(width - first);
            let (system, emitted, direct) = self.system(&spectra, first, block, &mut buffer);
            self.check(&system.reflectance, block)?;
            let solved = match self.settings.bounces {
                Some(count) => system.bounces(count, &mut buffer),
                None => system.solve(self.settings.residual, &buffers),
            };
            // And once for the light sent out.
            report.passes += solved.passes + block;
            self.judge(&solved, &system.amplification(), &mut report, |place| {
                let arriving = solved.irradiance[place] + system.lit[place];
                (emitted[place], direct[place], arriving, arriving * system.reflectance[place])
            });
            for (to, from) in reflected.chunks_mut(width).zip(solved.reflected.chunks(block)) {
                to[first..first + block].copy_from_slice(from);
            }
        }
        Ok(self.seen(Solution::new(self, Arc::new(representation), &reflected, report)))
    }

    /// The system for some components, with the radiosity that lights send out and the irradiance from those without area.
    fn system(
        &self,
        spectra: &Spectra,
        first: usize,
        width: usize,
        buffer: &mut Buffer,
    ) -> (System<'_>, Vec<f64>, Vec<f64>) {
        let rows = |of_sides: &[f64]| -> Vec<f64> {
            let side = |leaf: &u32| self.patches.nodes[*leaf as usize].side as usize;
            let row = |leaf: &u32| of_sides[side(leaf) * spectra.width + first..][..width].to_vec();
            self.transport.leaves.iter().flat_map(row).collect()
        };
        let (reflectance, emitted) = (rows(&spectra.reflectance), rows(&spectra.lights.emission));
        let mut lit = vec![0.0; emitted.len()];
        if emitted.iter().any(|e| *e != 0.0) {
            self.transport.apply(&emitted, &mut lit, width, buffer);
        }
        let direct = self.direct(&spectra.lights.sources, spectra.width, first, width);
        lit.iter_mut().zip(&direct).for_each(|(h, d)| *h += d);
        let largest_sum = self.balance.largest;
        (System { transport: &self.transport, width, reflectance, lit, largest_sum }, emitted, direct)
    }

    /// Irradiance of the leaves from lights without area, for some components of these lights' rows of `all`.
    pub(super) fn direct(&self, rows: &[f64], all: usize, first: usize, width: usize) -> Vec<f64> {
        let mut direct = vec![0.0; self.transport.leaves.len() * width];
        for (index, spectrum) in rows.chunks(all).enumerate() {
            let spectrum = &spectrum[first..][..width];
            for (row, factor) in direct.chunks_mut(width).zip(self.lit.iter().skip(index).step_by(self.sources.len())) {
                row.iter_mut().zip(spectrum).for_each(|(h, s)| *h += factor * s);
            }
        }
        direct
    }

    /// Refuses closed spaces that reflect everything.
    fn check(&self, reflectance: &[f64], width: usize) -> Result<(), RadiosityError> {
        if self.settings.bounces.is_some() || self.balance.closed < 1.0 {
            return Ok(());
        }
        let all = |i: usize| reflectance.iter().skip(i).step_by(width).all(|r| *r >= 1.0);
        if !reflectance.is_empty() && (0..width).any(all) { Err(RadiosityError::NoSolution) } else { Ok(()) }
    }

    /// The radiosity where reflectances are operators on rows.
    fn solve_coupled<'r>(&'r self, representation: &'r dyn Representation) -> Result<Solution<'r>, RadiosityError> {
        let width = representation.width();
        let sides = &self.patches.sides;
        let mut buffer = Buffer::default();
        let ones: Vec<f64> =
            sides.iter().flat_map(|side| representation::reflectance(representation, side.reflectance)).collect();
        self.check(&ones, width)?;
        let lights = Lights::new(self, representation);
        let surface: Vec<usize> =
            self.transport.leaves.iter().map(|leaf| self.patches.nodes[*leaf as usize].side as usize).collect();
        let emitted: Vec<f64> =
            surface.iter().flat_map(|side| &lights.emission[side * width..][..width]).copied().collect();
        let mut lit = vec![0.0; emitted.len()];
        self.transport.apply(&emitted, &mut lit, width, &mut buffer);
        let direct = self.direct(&lights.sources, width, 0, width);
        lit.iter_mut().zip(&direct).for_each(|(h, d)| *h += d);
        let matrices = sides.iter().map(|side| representation::matrix(representation, side.reflectance)).collect();
        let largest_sum = self.balance.largest;
        let system = Coupled { transport: &self.transport, width, surface, matrices, lit, largest_sum };
        let solved = match self.settings.bounces {
            Some(count) => system.bounces(count, &mut buffer),
            None => system.solve(self.settings.residual, &mut buffer),
        };
        let arriving: Vec<f64> = solved.irradiance.iter().zip(&system.lit).map(|(k, h)| k + h).collect();
        let leaving = system.reflected(&arriving);
        let amplification = vec![system.amplification(); width];
        let mut report = Report { intervals: representation.intervals(), ..self.report() };
        report.passes = solved.passes + width;
        self.judge(&solved, &amplification, &mut report, |place| {
            (emitted[place], direct[place], arriving[place], leaving[place])
        });
        Ok(self.seen(Solution::new(self, Arc::new(representation), &solved.reflected, report)))
    }

    /// The solution with radiosity at points of patches, where that changes what places see.
    fn seen<'r>(&self, mut solution: Solution<'r>) -> Solution<'r> {
        // Where nothing blocks, the means over patches are as good and keep all light.
        if self.settings.points && self.settings.bounces.is_none() && self.uncertain > 0 {
            solution.polish();
        }
        solution
    }

    /// Notes residual and energy balance, from radiosity that is sent out, irradiance from lights without area, all irradiance and what is reflected
    /// of that, number by number.
    fn judge(
        &self,
        solved: &Solved,
        amplification: &[f64],
        report: &mut Report,
        numbers: impl Fn(usize) -> (f64, f64, f64, f64),
    ) {
        if self.settings.bounces.is_some() {
            report.iterations = report.iterations.max(solved.steps);
            return;
        }
        let width = amplification.len();
        let part = |leaf: usize, component: usize| {
            let place = leaf * width + component;
            let (emitted, direct, arriving, leaving) = numbers(place);
            Part { emitted, direct, arriving, leaving, reflected: solved.reflected[place] }
        };
        Judgement::new((&self.transport.areas, &self.sums), solved, amplification, part).note(report);
    }
}

/// Rows of a representation.
struct Spectra {
    width: usize,
    /// Of each side.
    reflectance: Vec<f64>,
    lights: Lights,
}

impl Spectra {
    fn new(radiosity: &Radiosity, representation: &dyn Representation) -> Self {
        let row = |side: &mesh::Side| representation::reflectance(representation, side.reflectance);
        Self {
            width: representation.width(),
            reflectance: radiosity.patches.sides.iter().flat_map(row).collect(),
            lights: Lights::new(radiosity, representation),
        }
    }
}
