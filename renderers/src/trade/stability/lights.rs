//! Indices of lights over their scale.

use spectral_core::Real;
use spectral_core::light::measure_indices;
use spectral_core::spectrum::{Outside, RadiationConstant};
use spectral_core::summation::SumGrid;
use spectral_core::tables::fluorescent;

use super::{Sweep, domain, powers, steps};

const GRID: SumGrid<81> = SumGrid::CIE_5NM;

/// All sweeps of indices.
pub(super) fn sweeps(quick: bool) -> Result<Vec<Sweep>, String> {
    let steps = steps(quick);
    let truth = indices(&GRID.sample(&fluorescent::FL2.spectrum::<f64>(Outside::Zero))).ok_or("FL2 has no index")?;
    let mut all = Vec::new();
    for (place, name, error) in
        [(0, "R_a over radiance", "error of R_a"), (1, "CCT over radiance", "relative error of the CCT")]
    {
        all.push(sweep::<f32>([name, "f32", error], place, truth, steps));
        all.push(sweep::<f64>([name, "f64", error], place, truth, steps));
    }
    Ok(all)
}

/// R_a and CCT.
fn indices<R: Real>(light: &[R; 81]) -> Option<[f64; 2]> {
    let found = measure_indices(GRID, light, RadiationConstant::Its1990).ok()?;
    Some([found.ra?.to_f64(), found.chromaticity.cct.temperature.to_f64()])
}

fn sweep<R: Real>([name, kind, error]: [&str; 3], place: usize, truth: [f64; 2], steps: i32) -> Sweep {
    let lamp: [f64; 81] = GRID.sample(&fluorescent::FL2.spectrum(Outside::Zero));
    let single = kind == "f32";
    // Samples are rounded once more by scaling: what that changes is not the index's error, but of its size.
    let (tolerance, source) = match (place, single) {
        (0, true) => {
            (5e-4, "spectral_core::light: scales from 1e-37 to 1e37; measure_indices: in f32 within 5e-4 of f64")
        }
        (0, false) => (1e-10, "spectral_core::light: scales from 1e-37 to 1e37; measure_indices: within 1e-10"),
        _ => (f64::NAN, ""),
    };
    let documented = if place == 0 { domain([1e-30, 1e30], tolerance, source) } else { None };
    Sweep::new([name, kind, "scale of the lamp", error], documented, &powers(-36, 36, steps), |scale| {
        let light: [R; 81] = lamp.map(|v| R::from_f64(v * scale));
        let found = indices(&light)?[place];
        Some(if place == 0 { found - truth[0] } else { found / truth[1] - 1.0 })
    })
}
