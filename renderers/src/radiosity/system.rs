//! Solutions for representations that leave no bounds to be solved for, and what residual and balance say of any solution.

use alloc::sync::Arc;

use super::coupled::Coupled;
use super::representation::{self, Representation};
use super::solution::{Lights, Solution};
use super::solve::{Solved, System};
use super::transport::Buffer;
use super::{Radiosity, RadiosityError, Report, mesh};

/// Components that are solved for together.
const BLOCK: usize = 32;

/// A solution with what its residual and balance are made of, row by row.
pub(super) struct Judged<'j> {
    pub(super) width: usize,
    /// Radiosity that is sent out, and irradiance from lights without area.
    pub(super) emitted: &'j [f64],
    pub(super) direct: &'j [f64],
    /// All irradiance, and what is reflected of it.
    pub(super) arriving: Vec<f64>,
    pub(super) leaving: Vec<f64>,
    pub(super) solved: &'j Solved,
    pub(super) amplification: Vec<f64>,
}

impl<'j> Judged<'j> {
    /// The solution of a system.
    pub(super) fn new(system: &'j System<'_>, emitted: &'j [f64], solved: &'j Solved) -> Self {
        let arriving: Vec<f64> = solved.irradiance.iter().zip(&system.lit).map(|(k, h)| k + h).collect();
        let leaving = arriving.iter().zip(&system.reflectance).map(|(h, r)| h * r).collect();
        let amplification = system.amplification();
        Self { width: system.width, emitted, direct: &system.direct, arriving, leaving, solved, amplification }
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
        let mut buffer = Buffer::default();
        let spectra = Spectra::new(self, representation);
        for first in (0..width).step_by(BLOCK) {
            let block = BLOCK.min(width - first);
            let (system, emitted) = self.system(&spectra, first, block, &mut buffer);
            self.check(&system.reflectance, block)?;
            let solved = match self.settings.bounces {
                Some(count) => system.bounces(count, &mut buffer),
                None => system.solve(self.settings.residual, &mut buffer),
            };
            // And once for the light sent out.
            report.passes += solved.passes + block;
            self.judge(&Judged::new(&system, &emitted, &solved), &mut report);
            for (to, from) in reflected.chunks_mut(width).zip(solved.reflected.chunks(block)) {
                to[first..first + block].copy_from_slice(from);
            }
        }
        Ok(self.seen(Solution::new(self, Arc::new(representation), &reflected, report)))
    }

    /// The system for some components, and the radiosity that lights send out.
    fn system(&self, spectra: &Spectra, first: usize, width: usize, buffer: &mut Buffer) -> (System<'_>, Vec<f64>) {
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
        (System { transport: &self.transport, width, reflectance, direct, lit, largest_sum }, emitted)
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
        let judged =
            Judged { width, emitted: &emitted, direct: &direct, arriving, leaving, solved: &solved, amplification };
        let mut report = Report { intervals: representation.intervals(), ..self.report() };
        report.passes = solved.passes + width;
        self.judge(&judged, &mut report);
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

    /// Notes residual and energy balance.
    pub(super) fn judge(&self, judged: &Judged<'_>, report: &mut Report) {
        let Judged { width, emitted, direct, arriving, leaving, solved, amplification } = judged;
        report.iterations = report.iterations.max(solved.steps);
        if self.settings.bounces.is_some() {
            return;
        }
        let (mut sent, mut kept, mut largest) = (vec![0.0; *width], vec![0.0; *width], vec![0.0_f64; *width]);
        for (leaf, (area, sum)) in self.transport.areas.iter().zip(&self.sums).enumerate() {
            for component in 0..*width {
                let i = leaf * width + component;
                let (emission, reflected) = (emitted[i], solved.reflected[i]);
                let absorbed = arriving[i] - leaving[i];
                sent[component] += area * (emission + direct[i]);
                kept[component] += area * (absorbed + (emission + reflected) * (1.0 - sum));
                largest[component] = largest[component].max(reflected.abs());
            }
        }
        for (component, amplification) in amplification.iter().enumerate().filter(|(i, _)| largest[*i] > 0.0) {
            let residual = solved.residual[component] / largest[component];
            report.residual = report.residual.max(residual);
            let bounded = *amplification > 1.0 || residual == 0.0;
            let error = if bounded { residual * amplification } else { f64::INFINITY };
            report.iteration_error = report.iteration_error.max(error);
            let (sent, kept) = (sent[component], kept[component]);
            let balance = if sent == 0.0 { 0.0 } else { (sent - kept) / sent };
            if balance.abs() >= report.energy_balance.abs() {
                report.energy_balance = balance;
            }
        }
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
