//! Laws of single lights: inverse square, cosine, and area lights with closed forms.
//!
//! The area lights stand for section 5.3 of CIE 171:2006 (a Lambertian rectangle over a parallel and beside a
//! perpendicular plane). The report's own geometry is not public: sizes and positions here are this bench's own.

use core::f64::consts::PI;

use super::case::{Case, Check, Provenance, Reduction, Standing, Tolerance, Work};
use super::model::{Light, Model, SensorPoint, Shape, Vec3, flat};
use super::oracle::{parallel_rectangle, perpendicular_rectangle};

/// All cases of single lights.
pub(super) fn cases() -> Vec<Case> {
    vec![inverse_square(), cosine(), parallel(), perpendicular(), occluded(), sphere()]
}

/// A case that asks for the illuminance at each point.
fn case(name: &str, about: &str, model: Model, formula: &'static str, rows: Vec<(SensorPoint, f64)>) -> Case {
    let check = |(index, (point, reference)): (usize, &(SensorPoint, f64))| Check {
        name: point.name.clone(),
        quantity: "illuminance, lx",
        reduction: Reduction::Point { index, scale: 1.0 },
        reference: *reference,
        provenance: Provenance::Recomputed(formula),
        tolerance: Tolerance { relative: 1e-3, absolute: if *reference == 0.0 { 1e-6 } else { 0.0 } },
        standing: Standing::Judged,
    };
    let checks = rows.iter().enumerate().map(check).collect();
    let points = rows.into_iter().map(|(point, _)| point).collect();
    let about = format!("{about} 0.1 % asked for.");
    Case { name: name.into(), about, model, points, work: Work::Direct, checks }
}

fn point_light() -> Model {
    let mut model = Model::default();
    model.lights.push(Light::Point { position: [0.0, 0.0, 3.0], intensity: 1000.0 });
    model
}

fn inverse_square() -> Case {
    let row = |distance: f64| {
        let point = SensorPoint::new(format!("{distance}"), [0.0, 0.0, 3.0 - distance], [0.0, 0.0, 1.0]);
        (point, 1000.0 / (distance * distance))
    };
    let rows = [0.5, 1.0, 2.0, 4.0, 8.0, 16.0].map(row).into();
    let about = "Isotropic point of 1000 cd; facing it, at distances in metres.";
    case("point.inverse-square", about, point_light(), "I / d²", rows)
}

fn cosine() -> Case {
    let row = |degrees: f64| {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let point = SensorPoint::new(format!("{degrees}"), [0.0, 0.0, 1.0], [sine, 0.0, cosine]);
        (point, if degrees < 90.0 { 250.0 * cosine } else { 0.0 })
    };
    let rows = [0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 85.0, 89.0, 95.0].map(row).into();
    case(
        "point.cosine",
        "Isotropic point of 1000 cd, 2 m away; tilted by degrees.",
        point_light(),
        "I cos θ / d²",
        rows,
    )
}

/// A Lambertian square of 1 m and 1000 lm, 3 m above the floor, facing down.
fn ceiling_light() -> Model {
    let mut model = Model::default();
    model.shine(flat(2, 3.0, [-0.5, 0.5], [-0.5, 0.5], -1.0), 1000.0);
    model
}

fn square(offset: f64) -> [f64; 2] {
    [-0.5 - offset, 0.5 - offset]
}

fn parallel() -> Case {
    let row = |(name, [x, y, z]): (&str, Vec3)| {
        let factor = parallel_rectangle(square(x), square(y), 3.0 - z);
        (SensorPoint::new(name, [x, y, z], [0.0, 0.0, 1.0]), 1000.0 * factor)
    };
    let places = [
        ("middle", [0.0, 0.0, 0.0]),
        ("x-0.5", [0.5, 0.0, 0.0]),
        ("x-1", [1.0, 0.0, 0.0]),
        ("x-2", [2.0, 0.0, 0.0]),
        ("x-4", [4.0, 0.0, 0.0]),
        ("corner", [0.5, 0.5, 0.0]),
        ("diagonal-2", [2.0, 2.0, 0.0]),
        ("near", [0.1, 0.2, 2.5]),
        ("contact", [0.1, 0.2, 2.99]),
    ];
    let about = "Lambertian square of 1 m and 1000 lm, 3 m above the floor, facing down; receivers face up (geometry of this \
                 bench, after CIE 171:2006, 5.3).";
    case("area.parallel", about, ceiling_light(), "thesis eq. 1.2", places.map(row).into())
}

fn perpendicular() -> Case {
    let row = |(name, y, z): (&str, f64, f64)| {
        let factor = perpendicular_rectangle(3.0 - z, [1.5, 2.5], square(y));
        (SensorPoint::new(name, [-2.0, y, z], [1.0, 0.0, 0.0]), 1000.0 * factor)
    };
    let places = [
        ("z-2.9", 0.0, 2.9),
        ("z-2.5", 0.0, 2.5),
        ("z-2", 0.0, 2.0),
        ("z-1", 0.0, 1.0),
        ("z-0", 0.0, 0.0),
        ("side-1.5", 1.5, 1.5),
    ];
    let about = "The same square light; receivers on a wall 2 m from its middle, facing it (geometry of this bench, after CIE \
                 171:2006, 5.3).";
    case("area.perpendicular", about, ceiling_light(), "thesis eq. 1.3", places.map(row).into())
}

/// A half plane of shadow: a black screen at half height with a straight edge hides part of the light.
fn occluded() -> Case {
    let mut model = ceiling_light();
    // The edge at x = 0 runs far beyond the light on both sides; the screen covers x < 0.
    model.reflect(flat(2, 1.5, [-6.0, 0.0], [-6.0, 6.0], 1.0), 0.0);
    let row = |x: f64| {
        // Seen from (x, 0, 0), the edge at half height hides the light where it is left of 2 · 0 − x.
        let from = (-x).clamp(-0.5, 0.5);
        let factor = parallel_rectangle([from - x, 0.5 - x], [-0.5, 0.5], 3.0);
        let factor = if from < 0.5 { factor } else { 0.0 };
        (SensorPoint::new(format!("x{x:+}"), [x, 0.0, 0.0], [0.0, 0.0, 1.0]), 1000.0 * factor)
    };
    let rows = [-0.6, -0.4, -0.25, 0.0, 0.1, 0.25, 0.4, 0.6].map(row).into();
    let about =
        "The same square light over a black screen 1.5 m up, whose edge at x = 0 throws a penumbra on the floor.";
    case("area.penumbra", about, model, "thesis eq. 1.2 over the visible part", rows)
}

fn sphere() -> Case {
    const RADIUS: f64 = 0.25;
    let mut model = Model::default();
    let exitance = 1000.0 / (4.0 * PI * RADIUS * RADIUS);
    model.shine(Shape::Sphere { centre: [0.0, 0.0, 2.0], radius: RADIUS, inward: false }, exitance);
    let row = |(name, position, normal): (&str, Vec3, Vec3)| {
        let to: Vec3 = core::array::from_fn(|i| [0.0, 0.0, 2.0][i] - position[i]);
        let d2 = to.iter().map(|x| x * x).sum::<f64>();
        let cosine = to.iter().zip(&normal).map(|(a, b)| a * b).sum::<f64>() / d2.sqrt();
        (SensorPoint::new(name, position, normal), 1000.0 * cosine / (4.0 * PI * d2))
    };
    let places = [
        ("below", [0.0; 3], [0.0, 0.0, 1.0]),
        ("aside", [2.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
        ("aside-tilted", [2.0, 0.0, 0.0], [0.6, 0.0, 0.8]),
        ("near", [0.0, 0.0, 1.7], [0.0, 0.0, 1.0]),
    ];
    let about = "Lambertian sphere of 0.25 m radius and 1000 lm; all of it above the receivers' horizons.";
    case("area.sphere", about, model, "Φ cos θ / (4 π d²)", places.map(row).into())
}

#[cfg(test)]
mod tests {
    use super::cases;

    #[test]
    fn references_are_sane() {
        for case in cases() {
            for check in &case.checks {
                assert!(check.reference >= 0.0 && check.reference.is_finite(), "{}.{}", case.name, check.name);
            }
        }
        let penumbra = cases().into_iter().find(|case| case.name == "area.penumbra").unwrap();
        let values: Vec<f64> = penumbra.checks.iter().map(|check| check.reference).collect();
        // Dark left of −½, half the light at 0 by symmetry, all of it right of ½.
        assert_eq!(values[0], 0.0);
        let open = cases().into_iter().find(|case| case.name == "area.parallel").unwrap().checks[0].reference;
        assert!((values[3] - open / 2.0).abs() <= 1e-12 * open, "{values:?} {open}");
    }
}
