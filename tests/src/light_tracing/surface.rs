//! What surfaces do with particles.

use renderers::scene::{BsdfId, BsdfKind, ConductorFresnel, Ior, Scene, SpectrumId};

use super::TraceError;

/// One side of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Side {
    /// Nothing comes back.
    Black,
    Diffuse(SpectrumId),
    Mirror {
        /// The material that has n and k; `None` for a perfect mirror.
        metal: Option<BsdfId>,
        factor: SpectrumId,
    },
    Glass {
        bsdf: BsdfId,
        /// Factors on reflected and on refracted light.
        factors: [SpectrumId; 2],
        absorption: Option<SpectrumId>,
        /// Whether its index depends on the wavelength.
        disperses: bool,
    },
}

impl Side {
    pub(super) const fn is_specular(&self) -> bool {
        matches!(self, Self::Mirror { .. } | Self::Glass { .. })
    }
}

/// Front and back of all shapes.
pub(super) fn sides(scene: &Scene) -> Result<Vec<[Side; 2]>, TraceError> {
    scene.shapes.iter().map(|shape| of_bsdf(scene, shape.bsdf)).collect()
}

fn of_bsdf(scene: &Scene, id: BsdfId) -> Result<[Side; 2], TraceError> {
    let bsdf = scene.bsdf(id);
    Ok(match &bsdf.kind {
        BsdfKind::Diffuse { reflectance } => [Side::Diffuse(*reflectance), Side::Black],
        BsdfKind::Conductor { fresnel, specular_reflectance } => {
            let metal = (*fresnel != ConductorFresnel::Perfect).then_some(id);
            [Side::Mirror { metal, factor: *specular_reflectance }, Side::Black]
        }
        BsdfKind::Dielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance, absorption } => {
            let disperses = [int_ior, ext_ior].iter().any(|ior| !matches!(ior, Ior::Constant(_)));
            let factors = [*specular_reflectance, *specular_transmittance];
            [Side::Glass { bsdf: id, factors, absorption: *absorption, disperses }; 2]
        }
        BsdfKind::TwoSided { front, back } => [of_bsdf(scene, *front)?[0], of_bsdf(scene, *back)?[0]],
        _ => return Err(TraceError::Material(bsdf.label.clone())),
    })
}

/// Fresnel's reflectance of a boundary and the cosine of refraction, for the cosine of incidence and the index behind relative to that before;
/// `None` where all is reflected.
pub(super) fn dielectric(cosine: f64, index: f64) -> Option<[f64; 2]> {
    let refracted2 = 1.0 - (1.0 - cosine * cosine) / (index * index);
    if refracted2 <= 0.0 {
        return None;
    }
    let refracted = refracted2.sqrt();
    let across = (cosine - index * refracted) / (cosine + index * refracted);
    let along = (refracted - index * cosine) / (refracted + index * cosine);
    Some([f64::midpoint(across * across, along * along), refracted])
}

/// The same for a metal of index n + i k, by complex numbers: with m² − sin² θ = q², the amplitudes are (cos θ − q) / (cos θ + q) across the plane
/// of incidence and (m² cos θ − q) / (m² cos θ + q) along it.
pub(super) fn metal(cosine: f64, n: f64, k: f64) -> f64 {
    let m2 = [n * n - k * k, 2.0 * n * k];
    let q = square_root([m2[0] - (1.0 - cosine * cosine), m2[1]]);
    let ratio = |a: [f64; 2]| {
        let size = |sign: f64| (a[0] + sign * q[0]).powi(2) + (a[1] + sign * q[1]).powi(2);
        size(-1.0) / size(1.0)
    };
    f64::midpoint(ratio([cosine, 0.0]), ratio(m2.map(|m| m * cosine)))
}

/// The root with positive parts of a complex number whose imaginary part isn't negative.
fn square_root([re, im]: [f64; 2]) -> [f64; 2] {
    let size = re.hypot(im);
    [f64::midpoint(size, re), f64::midpoint(size, -re)].map(|square| square.max(0.0).sqrt())
}

#[cfg(test)]
mod tests {
    use super::{dielectric, metal};
    use spectral_core::fresnel;

    /// `independent`: the core's formulae, which are written otherwise.
    #[test]
    fn reflectances_are_those_of_the_core() {
        for step in 0..=100 {
            let cosine = f64::from(step) / 100.0;
            for (n, k) in [(0.14, 4.5), (1.66, 1.94), (2.8, 8.5), (1.5, 0.0)] {
                let [found, expected] = [metal(cosine, n, k), fresnel::conductor(cosine, n, k)];
                assert!((found - expected).abs() <= 1e-12, "{cosine} {n} {k}: {found}, not {expected}");
            }
            for index in [0.5, 0.66, 1.0003, 1.5, 2.4] {
                match (dielectric(cosine, index), fresnel::dielectric(cosine, index)) {
                    (None, None) => {}
                    (Some([share, refracted]), Some((expected, cosine))) => {
                        assert!((share - expected).abs() <= 1e-12 && (refracted - cosine).abs() <= 1e-12);
                    }
                    other => panic!("{cosine} {index}: {other:?}"),
                }
            }
        }
    }
}
