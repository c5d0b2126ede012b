//! BRDFs, Fresnel's formulae and dispersion.

use core::hint::black_box;

use spectral_core::Real;
use spectral_core::brdf::{self, Brdf, Glossy, Lambert, Sample, Schlick, Variant, Ward};
use spectral_core::dispersion::{Cauchy, Dispersion, Glass, Sellmeier};
use spectral_core::fresnel;
use spectral_core::tables::glasses;

use crate::Run;

fn put_sample<R: Real>(run: &mut Run, sample: Option<Sample<R>>) {
    run.put_option(sample, |run, sample| {
        run.put_all(&sample.direction);
        run.put_all(&[sample.pdf, sample.weight]);
    });
}

/// All methods of a BRDF; the time is of one evaluation, one sample and one density.
fn put_brdf<R: Real, B: Brdf<R>>(run: &mut Run, brdf: &B) {
    let is_above = run.below(8) > 0;
    let (light, view, u) = (run.direction(true), run.direction(is_above), run.array(0.0, 1.0));
    let (value, sample, pdf) =
        run.time_call(|| (brdf.evaluate(light, view), brdf.sample(view, u), brdf.pdf(light, view)));
    run.put_all(&[value, pdf]);
    put_sample(run, sample);
    run.put_option(brdf.invert(light, view), |run, u| run.put_all(&u));
}

/// A Ward model of any variant.
fn ward<R: Real>(run: &mut Run) -> Option<Ward<R>> {
    let variant = *Variant::ALL.get(run.index(4))?;
    let first = run.within(-0.01, 0.6);
    let second = if run.below(2) == 0 { first } else { run.within(0.01, 0.6) };
    Ward::new(variant, first, second).ok()
}

fn put_dispersion<R: Real, D: Dispersion<R>>(run: &mut Run, glass: &D) {
    let wavelength = run.within(250.0, 1200.0);
    let index = run.time_call(|| glass.index(wavelength));
    run.put_all(&[index, glass.derivative(wavelength), glass.abbe_number()]);
    run.put_all(&glass.valid());
}

entries! {
    brdf_lambert 12 ["brdf::Brdf for Lambert"] |run, R| {
        put_brdf::<R, _>(run, &Lambert);
        let view = run.direction::<R>(false);
        run.put(Lambert.albedo(view));
    }
    brdf_ward 32 [
        "brdf::Ward::new", "brdf::Ward::variant", "brdf::Ward::alpha", "brdf::Variant::name", "brdf::Brdf for Ward",
        "FromStr for Variant",
    ] |run, R| {
        let model = ward::<R>(run);
        run.put_option(model, |run, model| {
            run.put_all(&model.alpha());
            run.put_text(model.variant().name());
            run.put_bits(u64::from(model.variant().name().parse() == Ok(model.variant())));
            put_brdf(run, &model);
        });
    }
    brdf_ward_half_vector 16 [
        "brdf::Ward::sample_half_vector", "brdf::Ward::half_vector_pdf", "brdf::Ward::trigonometric",
    ] |run, R| {
        let model = ward::<R>(run);
        run.put_option(model, |run, model| {
            let (light, view, u) = (run.direction(true), run.direction(true), run.array(0.0, 1.0));
            let sample = run.time_call(|| model.sample_half_vector(view, u));
            put_sample(run, sample);
            run.put(model.half_vector_pdf(light, view));
            let (light, view) = (run.array(0.0, 1.5), run.array(0.0, 1.5));
            run.put(model.trigonometric(light, view));
        });
    }
    brdf_ward_albedo 2 ["brdf::Ward::albedo_by_quadrature"] |run, R| {
        let model = ward::<R>(run);
        run.put_option(model, |run, model| {
            let view = run.direction(true);
            let albedo = run.time_call(|| model.albedo(view));
            run.put_all(&[albedo, model.albedo_by_quadrature(view)]);
        });
    }
    brdf_glossy 16 [
        "brdf::Glossy::new", "brdf::Glossy::reflectances", "brdf::Glossy::model", "brdf::Brdf for Glossy",
    ] |run, R| {
        let (diffuse, specular) = (run.within(-0.05, 0.7), run.within(0.0, 0.6));
        let model = ward::<R>(run).and_then(|model| Glossy::new(diffuse, specular, model).ok());
        run.put_option(model, |run, glossy| {
            run.put_all(&glossy.reflectances());
            run.put_all(&glossy.model().alpha());
            put_brdf(run, &glossy);
        });
    }
    brdf_glossy_albedo 3 [] |run, R| {
        let (diffuse, specular) = (run.within(0.1, 0.4), run.within(0.1, 0.6));
        let model = ward::<R>(run).and_then(|model| Glossy::new(diffuse, specular, model).ok());
        run.put_option(model, |run, glossy| {
            let view = run.direction(true);
            let albedo = run.time_call(|| glossy.albedo(view));
            run.put(albedo);
        });
    }
    brdf_schlick 32 [
        "brdf::Schlick::new", "brdf::Schlick::roughness", "brdf::Schlick::isotropy", "brdf::Schlick::weights",
        "brdf::Schlick::geometric", "brdf::Brdf for Schlick",
    ] |run, R| {
        let (roughness, isotropy) = (run.within::<R>(-0.05, 1.0), run.within(0.01, 1.0));
        run.put_option(Schlick::new(roughness, isotropy).ok(), |run, model| {
            run.put_all(&[model.roughness(), model.isotropy()]);
            run.put_all(&model.weights());
            let [t, v, v_prime, w] = run.array(0.0, 1.0);
            run.put(model.geometric(t, v, v_prime, w));
            put_brdf(run, &model);
        });
    }
    brdf_schlick_albedo 1 [] |run, R| {
        let (roughness, isotropy) = (run.within::<R>(0.05, 0.4), run.within(0.2, 1.0));
        run.put_option(Schlick::new(roughness, isotropy).ok(), |run, model| {
            let view = run.direction(true);
            let albedo = run.time_call(|| model.albedo(view));
            run.put(albedo);
        });
    }
    brdf_direction 24 ["brdf::direction"] |run, R| {
        let vector = run.array::<R, 3>(-3.0, 3.0);
        let found = run.time_call(|| brdf::direction(vector));
        run.put_option(found.ok(), |run, direction| run.put_all(&direction));
    }
    fresnel_schlick 24 [
        "fresnel::schlick_factor", "fresnel::schlick", "fresnel::ward_factor", "fresnel::ward",
    ] |run, R| {
        let (reflectance, cosine) = (run.unit::<R>(), run.unit());
        let result = run.time_call(|| fresnel::schlick(reflectance, cosine));
        run.put_all(&[result, fresnel::schlick_factor(cosine)]);
        run.put_all(&[fresnel::ward(reflectance, cosine), fresnel::ward_factor(cosine)]);
    }
    fresnel_dielectric 32 ["fresnel::dielectric"] |run, R| {
        let (cosine, eta) = (run.unit::<R>(), run.within(0.4, 2.5));
        let found = run.time_call(|| fresnel::dielectric(cosine, eta));
        run.put_option(found, |run, (reflectance, cosine)| run.put_all(&[reflectance, cosine]));
    }
    fresnel_conductor 32 ["fresnel::conductor"] |run, R| {
        let (cosine, n, k) = (run.unit::<R>(), run.within(0.05, 3.0), run.within(0.0, 8.0));
        let result = run.time_call(|| fresnel::conductor(cosine, n, k));
        run.put(result);
    }
    dispersion_sellmeier 16 ["dispersion::Sellmeier::new", "dispersion::Dispersion for Sellmeier"] |run, R| {
        let terms = core::array::from_fn(|_| [run.within(0.0, 1.0), run.within(0.0, 0.05)]);
        let valid = [run.within(300.0, 500.0), run.within(450.0, 1000.0)];
        run.put_option(Sellmeier::<R>::new(terms, valid).ok(), |run, glass| put_dispersion(run, &glass));
    }
    dispersion_cauchy 16 ["dispersion::Cauchy::new", "dispersion::Dispersion for Cauchy"] |run, R| {
        let (a, b) = (run.within(0.5, 2.0), run.within(0.0, 0.02));
        let valid = [run.within(300.0, 500.0), run.within(450.0, 1000.0)];
        run.put_option(Cauchy::<R>::new(a, b, valid).ok(), |run, glass| put_dispersion(run, &glass));
    }
    dispersion_glass 8 [
        "dispersion::Glass::from_table", "dispersion::Glass::find", "dispersion::Dispersion for Glass",
    ] |run, R| {
        let glass = Glass::<R>::from_table(black_box(&glasses::N_BK7));
        put_dispersion(run, &glass);
        run.put_option(Glass::<R>::find(black_box("N-SF11")), |run, glass| put_dispersion(run, &glass));
    }
}
