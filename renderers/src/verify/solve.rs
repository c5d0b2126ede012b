//! The cases computed by this project.

use std::time::Instant;

use disk_sampling::Disk;
use disk_sampling::partition::{self, Partition, Subsource};

use super::case::{Answer, Case, Work};
use super::disk::{Method, Sampling};
use super::model::{Shape, Vec3, along, dot};

/// Answers to a case, one for each point, or why there are none.
///
/// # Errors
/// A line that says what is missing or what went wrong.
pub fn solve(case: &Case) -> Result<Vec<Answer>, String> {
    match &case.work {
        Work::Method(sampling) => {
            case.points.iter().map(|point| by_method(case, *sampling, point.position, point.normal)).collect()
        }
        Work::Misses(sampling) => Ok(vec![misses(*sampling)?]),
        Work::Direct | Work::Global => Err("illuminance of scenes is not part of this version".to_owned()),
    }
}

/// The disk of a case that has one.
fn disk_of(case: &Case) -> Result<(Disk<f64>, f64), String> {
    let mut surfaces = case.model.surfaces.iter();
    let found = surfaces.find_map(|surface| match surface.shape {
        Shape::Disk { centre, normal, radius } => Some((Disk::new(centre, normal, radius), surface.exitance)),
        _ => None,
    });
    let (disk, exitance) = found.ok_or("the case has no disk")?;
    Ok((disk.map_err(|error| error.to_string())?, exitance))
}

fn subdivision(sampling: Sampling) -> Result<Partition<f64>, String> {
    let method = match sampling.method {
        Method::Square => partition::Method::Square,
        Method::MappedSquare => partition::Method::MappedSquare,
        Method::Hexagon => partition::Method::Hexagon,
        Method::EqualAreaHexagon => partition::Method::EqualAreaHexagon,
    };
    let depth = (1..=partition::MAX_DEPTH).find(|&depth| method.parts(depth) == u64::from(sampling.count));
    let depth = depth.ok_or_else(|| format!("no subdivision has {} parts", sampling.count))?;
    Partition::full(method, depth).map_err(|error| error.to_string())
}

/// Illuminance by the samples of a method, nothing in the way: Σ weight · M/π · A cos θ cos θ′ / d².
fn by_method(case: &Case, sampling: Sampling, point: Vec3, normal: Vec3) -> Result<Answer, String> {
    let start = Instant::now();
    let (disk, exitance) = disk_of(case)?;
    let mut sum = 0.0;
    let mut samples = 0;
    for subsource in subdivision(sampling)? {
        samples += 1;
        if subsource.hits() {
            let to = along(disk.point(subsource.position()), -1.0, point);
            let d2 = dot(to, to);
            sum += subsource.weight() * dot(to, normal).max(0.0) * (-dot(to, disk.normal())).max(0.0) / (d2 * d2);
        }
    }
    // M/π · π r²
    let illuminance = exitance * disk.radius() * disk.radius() * sum;
    Ok(Answer { illuminance: Some(illuminance), samples: Some(samples), seconds: Some(start.elapsed().as_secs_f64()) })
}

/// The share in per cent of fully jittered samples that miss the disk.
///
/// The random numbers are a Kronecker sequence of the plastic number ρ = 1.3247…, (n/ρ, n/ρ²) mod 1: even, and in no relation
/// to the parts' edges.
fn misses(sampling: Sampling) -> Result<Answer, String> {
    const TRIALS: u32 = 1 << 16;
    const PLASTIC: f64 = 1.324_717_957_244_746;
    let start = Instant::now();
    let random = |n: u32| [1.0 / PLASTIC, 1.0 / (PLASTIC * PLASTIC)].map(|step| (f64::from(n) * step).fract());
    let missed = |part: &Subsource<f64>| (0..TRIALS).filter(|&n| !part.sample(1.0, random(n)).1).count();
    let parts: Vec<_> = subdivision(sampling)?.collect();
    #[allow(clippy::cast_precision_loss, reason = "a few million at most")]
    let [missed, all] = [parts.iter().map(missed).sum::<usize>() as f64, parts.len() as f64];
    let share = 100.0 * missed / (all * f64::from(TRIALS));
    let samples = Some(u64::from(TRIALS) * parts.len() as u64);
    Ok(Answer { illuminance: Some(share), samples, seconds: Some(start.elapsed().as_secs_f64()) })
}
