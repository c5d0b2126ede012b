//! Closed rooms: CIE 171:2006 test case 5.8, the furnace, and the flux of a light in a black box.

use core::f64::consts::PI;

use super::case::{Case, Check, Provenance, Reduction, Standing, Tolerance, Work, half_printed_unit};
use super::model::{Light, Model, SensorPoint, Shape, flat};
use super::oracle::gauss_legendre;

/// All cases of closed rooms.
pub(super) fn cases() -> Vec<Case> {
    let rows = [
        (0.0, "0.00", 2),
        (0.05, "5.48", 2),
        (0.1, "11.6", 1),
        (0.2, "26.0", 1),
        (0.3, "44.6", 1),
        (0.4, "69.4", 1),
        (0.5, "104", 0),
        (0.6, "156", 0),
        (0.7, "243", 0),
        (0.8, "417", 0),
        (0.9, "937", 0),
        (0.95, "1979", 0),
    ];
    let mut cases: Vec<_> = rows.map(|(reflectance, printed, decimals)| cube(reflectance, printed, decimals)).into();
    for reflectance in [0.5, 0.9] {
        cases.push(furnace(reflectance, true));
        cases.push(furnace(reflectance, false));
    }
    cases.push(flux());
    cases
}

/// CIE 171 5.8: a cube of 4 m with an isotropic point of 10 000 lm in the middle, 20 × 20 points on the floor.
///
/// The thesis takes the plain mean of a regular grid of 20 × 20 points, which by itself overstates the mean of light
/// reflected once by 0.134 % (the walls' edges are dark). Here the points are Gauss–Legendre nodes, whose weighted mean
/// is right to 4·10⁻⁶ (both by numerical integration of light reflected once).
///
/// The mean indirect illuminance over a side is Φ ρ / (A (1 − ρ)): by symmetry it is the same on all sides, and of the
/// flux Φ the walls absorb all, hence (E_direct + E_indirect) A (1 − ρ) = Φ. The direct part Φ cos θ / (4 π d²) is
/// subtracted in closed form, so that a program need only answer the illuminance at the points.
fn cube(reflectance: f64, printed: &str, decimals: i32) -> Case {
    const FLUX: f64 = 10_000.0;
    let intensity = FLUX / (4.0 * PI);
    let mut model = Model::default();
    model.room([-2.0, -2.0, 0.0], [2.0, 2.0, 4.0], [reflectance; 6]);
    model.lights.push(Light::Point { position: [0.0, 0.0, 2.0], intensity });
    let nodes = gauss_legendre(20);
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for (row, (b, weight_b)) in nodes.iter().enumerate() {
        for (column, (a, weight_a)) in nodes.iter().enumerate() {
            let place = [4.0 * a - 2.0, 4.0 * b - 2.0, 0.0];
            points.push(SensorPoint::new(format!("{}-{}", row + 1, column + 1), place, [0.0, 0.0, 1.0]));
            weights.push(weight_a * weight_b);
        }
    }
    let direct = |point: &SensorPoint| {
        let [x, y, _] = point.position;
        let d2 = x * x + y * y + 4.0;
        intensity * 2.0 / (d2 * d2.sqrt())
    };
    let less: Vec<f64> = points.iter().map(direct).collect();
    let exact = FLUX * reflectance / (96.0 * (1.0 - reflectance));
    // Without reflection nothing may be left: less than half the last digit of the printed 0.00 lx.
    let absolute = if reflectance == 0.0 { half_printed_unit(2) } else { 0.0 };
    let tolerance = Tolerance { relative: 1e-3, absolute };
    let rounding = Tolerance { relative: 1e-3, absolute: half_printed_unit(decimals) };
    let check = |name: &str, reference, provenance, tolerance| Check {
        name: name.into(),
        quantity: "mean indirect illuminance, lx",
        reduction: Reduction::Sum { weights: weights.clone(), less: less.clone() },
        reference,
        provenance,
        tolerance,
        standing: Standing::Judged,
    };
    let closed = Provenance::Recomputed("Φ ρ / (A (1 − ρ))");
    let source = Provenance::Published("CIE 171:2006, table 20, in thesis, table 1.11");
    let checks = vec![
        check("mean", exact, closed, tolerance),
        check("mean.printed", printed.parse().unwrap_or(f64::NAN), source, rounding),
    ];
    let about = format!(
        "Cube of 4 m, all sides ρ = {reflectance}, isotropic point of 10 000 lm in the middle; 20 × 20 Gauss–Legendre \
         nodes on the floor. 0.1 % asked for."
    );
    Case { name: format!("cie-171.5.8.{reflectance:.2}"), about, model, points, work: Work::Global, checks }
}

/// Closed, every surface with the same exitance M on its own and the same reflectance: E = M / (1 − ρ) everywhere,
/// whatever the orientation.
fn furnace(reflectance: f64, sphere: bool) -> Case {
    const EXITANCE: f64 = 100.0;
    let mut model = Model::default();
    if sphere {
        model.reflect(Shape::Sphere { centre: [0.0; 3], radius: 1.0, inward: true }, reflectance);
    } else {
        model.room([-1.0, -1.0, -0.5], [1.0, 1.0, 0.5], [reflectance; 6]);
    }
    for surface in &mut model.surfaces {
        surface.exitance = EXITANCE;
    }
    let points = vec![
        SensorPoint::new("middle", [0.0; 3], [0.0, 0.0, 1.0]),
        SensorPoint::new("off-middle", [0.3, -0.2, 0.1], [0.6, 0.0, 0.8]),
        SensorPoint::new("near-side", [0.2, 0.1, -0.45], [0.0, 0.6, -0.8]),
    ];
    let check = |(index, point): (usize, &SensorPoint)| Check {
        name: point.name.clone(),
        quantity: "illuminance, lx",
        reduction: Reduction::Point { index, scale: 1.0 },
        reference: EXITANCE / (1.0 - reflectance),
        provenance: Provenance::Recomputed("M / (1 − ρ)"),
        tolerance: Tolerance::relative(1e-3),
        standing: Standing::Judged,
    };
    let checks = points.iter().enumerate().map(check).collect();
    let shape = if sphere { "sphere of 1 m radius" } else { "box of 2 m × 2 m × 1 m" };
    let about = format!("Furnace: closed {shape}, M = {EXITANCE} lm/m², ρ = {reflectance}. 0.1 % asked for.");
    let name = format!("furnace.{}.{reflectance:.2}", if sphere { "sphere" } else { "box" });
    Case { name, about, model, points, work: Work::Global, checks }
}

/// All flux of a light arrives: Σ w E over the floor and walls of a black room, by Gauss–Legendre quadrature, is Φ.
fn flux() -> Case {
    const FLUX: f64 = 1000.0;
    const NODES: u32 = 10;
    let mut model = Model::default();
    let (width, height) = (4.0, 3.0);
    model.room([-2.0, -2.0, 0.0], [2.0, 2.0, height + 0.01], [0.0; 6]);
    model.shine(flat(2, height, [-0.5, 0.5], [-0.5, 0.5], -1.0), FLUX);
    let nodes = gauss_legendre(NODES);
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for (i, (a, wa)) in nodes.iter().enumerate() {
        for (j, (b, wb)) in nodes.iter().enumerate() {
            let (x, y, z) = (4.0 * a - 2.0, 4.0 * b - 2.0, height * b);
            let places = [
                ("floor", [x, y, 0.0], [0.0, 0.0, 1.0], width),
                ("low-x", [-2.0, x, z], [1.0, 0.0, 0.0], height),
                ("high-x", [2.0, x, z], [-1.0, 0.0, 0.0], height),
                ("low-y", [x, -2.0, z], [0.0, 1.0, 0.0], height),
                ("high-y", [x, 2.0, z], [0.0, -1.0, 0.0], height),
            ];
            for (side, position, normal, extent) in places {
                points.push(SensorPoint::new(format!("{side}-{}-{}", i + 1, j + 1), position, normal));
                weights.push(wa * wb * width * extent);
            }
        }
    }
    let less = vec![0.0; points.len()];
    let check = Check {
        name: "total".into(),
        quantity: "luminous flux, lm",
        reduction: Reduction::Sum { weights, less },
        reference: FLUX,
        provenance: Provenance::Recomputed("what the light sends out"),
        // The quadrature itself errs by less than 1e-6 (test below); the rest is asked of the program.
        tolerance: Tolerance::relative(1e-3),
        standing: Standing::Judged,
    };
    let about =
        "Flux: Lambertian square of 1 m and 1000 lm, 3 m above the floor of a black room of 4 m × 4 m; illuminance at \
                 Gauss–Legendre nodes on floor and walls sums to the flux. 0.1 % asked for."
            .into();
    Case { name: "flux.black-room".into(), about, model, points, work: Work::Direct, checks: vec![check] }
}

#[cfg(test)]
mod tests {
    use super::{cases, flux};
    use crate::verify::case::{Answer, Status};
    use crate::verify::oracle::{parallel_rectangle, perpendicular_rectangle};

    #[test]
    fn closed_forms_round_to_the_printed_means() {
        for case in cases().iter().filter(|case| case.name.starts_with("cie-171.5.8")) {
            let [exact, printed] = [0, 1].map(|i| case.checks[i].reference);
            let half = case.checks[1].tolerance.absolute;
            assert!((exact - printed).abs() <= half * (1.0 + 1e-9), "{} {exact} {printed}", case.name);
        }
    }

    #[test]
    fn closed_form_illuminances_sum_to_the_flux() {
        let case = flux();
        let answers = case.points.iter().map(|point| {
            let [x, y, z] = point.position;
            let square = |a: f64| [-0.5 - a, 0.5 - a];
            let factor = match point.name.split('-').next() {
                Some("floor") => parallel_rectangle(square(x), square(y), 3.0),
                _ if point.normal[0] != 0.0 => perpendicular_rectangle(3.0 - z, [1.5, 2.5], square(y)),
                _ => perpendicular_rectangle(3.0 - z, [1.5, 2.5], square(x)),
            };
            Answer { illuminance: Some(1000.0 * factor), samples: None, seconds: None }
        });
        let outcome = &case.judge(&Ok(answers.collect()))[0];
        assert_eq!(outcome.status, Status::Pass);
        assert!(outcome.relative_error.is_some_and(|error| error.abs() <= 1e-6), "{:?}", outcome.relative_error);
    }
}
