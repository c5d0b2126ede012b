//! Fresnel's formulae and their approximations, at their limits; the models' spectral terms as maps of interval spectra.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test stops at what should not be, and prints what it measured"
)]

use spectral_core::Real;
use spectral_core::brdf::{Brdf, Variant, Ward, direction};
use spectral_core::expression::Op;
use spectral_core::fresnel::{conductor, dielectric, schlick, schlick_factor, ward, ward_factor};

fn limits<R: Real>(tolerance: R) {
    let r = R::from_f64;
    let close = |a: R, b: R| (a - b).abs() <= tolerance;
    // Normal incidence, grazing incidence, Brewster's angle (half of what is polarised across remains), total reflection.
    let (normal, refracted) = dielectric(R::ONE, r(1.5)).unwrap();
    assert!(close(normal, r(0.04)) && close(refracted, R::ONE));
    assert!(close(dielectric(R::ZERO, r(1.5)).unwrap().0, R::ONE));
    let brewster = R::ONE / r(3.25).sqrt();
    let across = r(-1.25 / 3.25);
    assert!(close(dielectric(brewster, r(1.5)).unwrap().0, across * across * R::HALF));
    assert!(dielectric(R::HALF, r(1.0 / 1.5)).is_none() && dielectric(r(0.9), r(1.0 / 1.5)).is_some());
    // Light that goes back the way it came.
    let (forth, cosine) = dielectric(r(0.3), r(1.7)).unwrap();
    assert!(close(dielectric(cosine, r(1.0 / 1.7)).unwrap().0, forth));
    for eta in [R::ZERO, -R::ONE, R::from_f64(f64::NAN)] {
        assert!(dielectric(R::HALF, eta).is_none());
    }
    // Conductors: normal and grazing incidence; k = 0 is a dielectric.
    assert!(close(conductor(R::ONE, r(0.2), r(3.0)), r(9.64 / 10.44)));
    assert!(close(conductor(R::ZERO, r(0.2), r(3.0)), R::ONE));
    for c in [0.05, 0.3, 0.7, 1.0] {
        let transparent = dielectric(r(c), r(1.5)).unwrap().0;
        assert!(close(conductor(r(c), r(1.5), R::ZERO), transparent));
        assert!(close(conductor(r(c), r(1.5), r(1e-6)), transparent));
    }
    // Approximations: ρ at normal incidence, 1 at grazing incidence (Ward's stays 0.3 % below), growing in between.
    for rho in [R::ZERO, r(0.04), r(0.5), R::ONE] {
        assert!(schlick(rho, R::ONE) == rho && schlick(rho, R::ZERO) == R::ONE);
        assert!((ward(rho, R::ONE) - rho).abs() <= r(1e-6));
        assert!((ward(rho, R::ZERO) - R::ONE).abs() <= r(0.0029));
    }
    assert!(close(schlick_factor(R::HALF), r(1.0 / 32.0)));
    assert!(close(ward_factor(R::HALF), r(f64::exp(-2.925) - 0.002_879_899_16)));
    // Cosines out of their range are limited to it.
    for bad in [r(-1.0), r(2.0), R::INFINITY, R::from_f64(f64::NAN)] {
        for value in [
            schlick(r(0.1), bad),
            ward(r(0.1), bad),
            conductor(bad, r(0.2), r(3.0)),
            dielectric(bad, r(1.5)).unwrap().0,
        ] {
            assert!(value >= R::ZERO && value <= R::ONE, "{bad}: {value}");
        }
    }
}

#[test]
fn formulae_meet_their_limits() {
    limits::<f64>(R64);
    limits::<f32>(2e-6);
}

const R64: f64 = 2e-12;

/// Between its ends, Schlick's approximation for an index of 1.5 is within 0.04 of the exact reflectance.
#[test]
fn approximations_are_near_the_exact_reflectance() {
    let worst = |f: &dyn Fn(f64) -> f64| {
        (0..=1000_u32)
            .map(|i| f64::from(i) / 1000.0)
            .map(|c| (f(c) - dielectric(c, 1.5).unwrap().0).abs())
            .fold(0.0, f64::max)
    };
    let (by_schlick, by_ward) = (worst(&|c| schlick(0.04, c)), worst(&|c| ward(0.04, c)));
    println!("largest error for an index of 1.5: Schlick {by_schlick:.4}, Ward {by_ward:.4}");
    assert!(by_schlick <= 0.05 && by_ward <= 0.1 && by_schlick > 0.001);
}

/// A glossy paint in daylight: ρ_d(λ)/π + ρ'(λ) f with ρ' = ρ + (1 − ρ) F is a sum of affine maps of two interval spectra,
/// so that the certified bound holds for it.
mod spectral {
    use super::{Brdf, Op, Variant, Ward, direction, schlick_factor, ward_factor};
    use spectral_core::adaptive::{Mode, Piece, Target, evaluate};
    use spectral_core::expression::Program;
    use spectral_core::interval::{Domain, Interval, Pyramid, Weight, node_count};
    use spectral_core::spectrum::Outside;
    use spectral_core::tables::{colorchecker, illuminants};
    use spectral_core::{Observer, tristimulus};
    use spectral_tests::dense::{Beyond, Dense, Polyline, cie_1931, least_delta_e};

    const DEPTH: u8 = 8;
    const NODES: usize = node_count(DEPTH);

    #[test]
    fn the_certified_bound_carries_through() {
        let coat = Ward::new(Variant::Balanced, 0.15, 0.15).unwrap();
        let (light, body, gloss) = (illuminants::D65, colorchecker::GREEN, colorchecker::ORANGE_YELLOW);
        let mut weights = vec![Weight::default(); NODES];
        let domain = Domain::<f64>::build(Observer::cie_1931_2deg(), DEPTH, &mut weights).unwrap();
        let mut buffers = vec![[Interval::zero(); NODES]; 3];
        let [first, second, third] = buffers.as_mut_slice() else { unreachable!() };
        let leaves = [
            Pyramid::build(&light.spectrum(Outside::Zero), &domain, first).unwrap(),
            Pyramid::build(&body.spectrum(Outside::Hold), &domain, second).unwrap(),
            Pyramid::build(&gloss.spectrum(Outside::Hold), &domain, third).unwrap(),
        ];
        let white = tristimulus(domain.observer(), &light.spectrum(Outside::Zero), 380.0, 780.0);
        let patches = "colorchecker24_ohta1997_5nm.csv";
        let spectra = [
            Polyline::read("cie_illuminants_A_D50_D55_D65_D75_C_5nm.csv", light.name, Beyond::Zero).unwrap(),
            Polyline::read(patches, body.name, Beyond::Hold).unwrap(),
            Polyline::read(patches, gloss.name, Beyond::Hold).unwrap(),
        ];
        let dense = Dense::new(&cie_1931().unwrap(), &[&spectra[0], &spectra[1], &spectra[2]], [380.0, 780.0], 8);
        let view = direction([0.6, 0.1, 0.7]).unwrap();
        let mut pieces_used = Vec::new();
        for (x, z) in [(-0.6, 0.8), (-0.7, 0.5), (-0.9, 0.3), (-0.99, 0.1), (0.3, 0.9)] {
            let to_light = direction([x, -0.1, z]).unwrap();
            let geometric = coat.evaluate(to_light, view) * to_light[2];
            for fresnel in [schlick_factor(to_light[2]), ward_factor(to_light[2])] {
                let diffuse = to_light[2] / core::f64::consts::PI;
                let ops = [
                    Op::Leaf(0),
                    Op::Leaf(1),
                    Op::Scale(diffuse),
                    Op::Leaf(2),
                    Op::Schlick(fresnel),
                    Op::Scale(geometric),
                    Op::Sum,
                    Op::Product,
                ];
                for threshold in [10.0, 3.0, 1.0] {
                    let program = Program::new(&ops).unwrap();
                    let target = Target { mode: Mode::Certified, threshold, white };
                    let mut stack = [Interval::zero(); 3];
                    let mut pieces = [Piece::default(); 256];
                    let found =
                        evaluate(&program, &domain, &target, &mut leaves.as_slice(), &mut stack, &mut pieces).unwrap();
                    let truth = dense.integrate(&ops);
                    let error = least_delta_e(found.xyz, &truth, white);
                    pieces_used.push(found.intervals);
                    assert!(error <= found.delta_e, "{x} {z} {threshold}: {error} above {}", found.delta_e);
                    assert!(found.delta_e <= threshold, "{x} {z}: {} above {threshold}", found.delta_e);
                }
            }
        }
        println!("intervals used: {pieces_used:?}");
    }
}
