//! What the Rust crates answer to the calls of `tests/bits.c`: the same lines, made without the C interface.

use std::io::{self, BufWriter, Write};

use disk_sampling::estimate::{self, Aim, Panel, Request, Response, integrate, ratio};
use disk_sampling::partition::{Method, Partition};
use disk_sampling::{
    Disk, Receiver, Sphere, disk_configuration_factor, polygon_configuration_factor, rectangle_parallel_factor,
    rectangle_perpendicular_factor, sphere_configuration_factor,
};
use spectral_core::adaptive::{Mode, Piece, Status, Target, evaluate};
use spectral_core::bilinear::Tensor;
use spectral_core::brdf::{Brdf, Glossy, Variant, Ward, direction};
use spectral_core::cct::CctStatus;
use spectral_core::colour::{RgbSpace, delta_e_00, delta_e_ab, lab_to_xyz, linear_rgb_to_srgb8, xyz_to_lab};
use spectral_core::expression::{Op, Program};
use spectral_core::interval::{Domain, Interval, Pyramid, Weight, node_count};
use spectral_core::light::{Chromaticity, measure, measure_fidelity, measure_indices};
use spectral_core::spectrum::{Outside, PiecewiseLinear, RadiationConstant};
use spectral_core::summation::SumGrid;
use spectral_core::tables::find_light;
use spectral_core::upsampling::Upsampler;
use spectral_core::upsampling::smits::Basis;
use spectral_core::{Observer, Real, Spectrum, fresnel, tristimulus};

type Failure = Box<dyn std::error::Error>;
type Outcome = Result<(), Failure>;

/// The generator and the lines.
struct Lines<W> {
    state: u64,
    out: W,
}

impl<W: Write> Lines<W> {
    fn between<R: Real>(&mut self, from: f64, to: f64) -> R {
        self.state = self.state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let number = u32::try_from(self.state >> 40).unwrap_or(0);
        R::from_f64(from + (to - from) * (f64::from(number) / 16_777_216.0))
    }

    fn fill<R: Real, const N: usize>(&mut self, from: f64, to: f64) -> [R; N] {
        core::array::from_fn(|_| self.between(from, to))
    }

    fn bits(&mut self, name: &str, value: f64) -> Outcome {
        let bits = if value.is_nan() { 0x7ff8_0000_0000_0000 } else { value.to_bits() };
        Ok(writeln!(self.out, "{name} {bits:016x}")?)
    }

    fn print<R: Real>(&mut self, name: &str, value: R) -> Outcome {
        self.bits(name, value.to_f64())
    }

    fn numbers<R: Real>(&mut self, name: &str, values: &[R]) -> Outcome {
        values.iter().try_for_each(|&value| self.print(name, value))
    }

    fn count(&mut self, name: &str, value: usize) -> Outcome {
        self.bits(name, f64::from(u32::try_from(value)?))
    }

    fn chromaticity<R: Real>(&mut self, found: &Chromaticity<R>) -> Outcome {
        self.numbers("xyz", &found.xyz)?;
        self.numbers("xy", &found.xy)?;
        self.numbers("uv", &found.uv)?;
        self.print("cct", found.cct.temperature)?;
        self.print("duv", found.cct.duv)?;
        let codes = [CctStatus::Valid, CctStatus::FarFromLocus, CctStatus::BelowRange, CctStatus::AboveRange];
        self.count("cct_status", codes.iter().position(|&s| s == found.cct.status).ok_or("a new status")?)
    }

    fn measures<R: Real, const N: usize>(&mut self, grid: SumGrid<N>, powers: &[R; N]) -> Outcome {
        let (constant, nan) = (RadiationConstant::Its1990, R::from_f64(f64::NAN));
        let indices = measure_indices(grid, powers, constant)?;
        self.chromaticity(&indices.chromaticity)?;
        self.count("indices.defined", usize::from(indices.ra.is_some()))?;
        self.print("indices.ra", indices.ra.unwrap_or(nan))?;
        self.print("indices.cri00", indices.cri00.unwrap_or(nan))?;

        let light = measure(grid, powers, constant)?;
        self.chromaticity(&light.chromaticity)?;
        self.print("power", light.power)?;
        self.print("luminous_efficacy", light.action.luminous_efficacy)?;
        self.print("acv", light.action.acv)?;
        self.print("sy", light.action.sy)?;
        self.print("sy_ratio", light.action.sy_ratio)?;
        self.numbers("alpha_opic_efficacy", &light.action.alpha_opic.efficacy)?;
        self.numbers("alpha_opic_der", &light.action.alpha_opic.daylight_ratio)?;
        let r = light.rendering.as_ref();
        self.count("defined", usize::from(r.is_some()))?;
        self.print("ra", r.map_or(nan, |r| r.ra.general))?;
        self.numbers("ri", &r.map_or([nan; 14], |r| r.ra.special))?;
        self.print("cri00", r.map_or(nan, |r| r.cri00_munsell.general))?;
        self.numbers("cri00_i", &r.map_or([nan; 14], |r| r.cri00_munsell.special))?;
        self.print("cri00_colorchecker", r.map_or(nan, |r| r.cri00_colorchecker.general))?;
        self.print("r96_tcc_lab", r.map_or(nan, |r| r.r96_tcc_lab.general))?;
        self.print("r96_c", light.r96_c.rendering.general)?;

        let fidelity = measure_fidelity(grid, powers, constant)?;
        self.count("fidelity.defined", usize::from(fidelity.is_some()))?;
        self.print("rf", fidelity.as_ref().map_or(nan, |f| f.rf))?;
        self.print("rg", fidelity.as_ref().map_or(nan, |f| f.rg))
    }

    fn lights<R: Real>(&mut self) -> Outcome {
        for name in ["A", "D65", "FL2", "FL11", "LED-B3"] {
            let light = find_light(name).ok_or("no such light")?.spectrum::<R>(Outside::Zero);
            self.measures(SumGrid::CIE_5NM, &SumGrid::CIE_5NM.sample(&light))?;
            self.measures(SumGrid::CIE_1NM, &SumGrid::CIE_1NM.sample(&light))?;
        }
        let mut blue = [R::ZERO; 81];
        blue[14] = R::ONE;
        self.measures(SumGrid::CIE_5NM, &blue)
    }

    fn nodes<R: Real>(&mut self, most: f64) -> [[R; 40]; 2] {
        let mut place = 0.0;
        let wavelengths = core::array::from_fn(|_| {
            let wavelength = R::from_f64(370.0 + 11.0 * place + self.between::<f64>(0.0, 10.0));
            place += 1.0;
            wavelength
        });
        [wavelengths, self.fill(0.0, most)]
    }

    fn products<R: Real>(&mut self) -> Outcome {
        const DEPTH: u8 = 6;
        const NODES: usize = node_count(DEPTH);
        let nodes = [50.0, 1.0, 1.0, 1.0].map(|most| self.nodes::<R>(most));
        let light = PiecewiseLinear::new(&nodes[0][0], &nodes[0][1], Outside::Zero)?;
        self.numbers("sample", &SumGrid::CIE_5NM.sample(&light))?;
        let (from, to) = (R::from_f64(380.0), R::from_f64(780.0));
        self.numbers("tristimulus10", &tristimulus(&Observer::cie_1964_10deg(), &light, from, to))?;
        let white = tristimulus(&Observer::cie_1931_2deg(), &light, from, to);
        self.numbers("tristimulus", &white)?;

        let mut weights = [Weight::default(); NODES];
        let domain = Domain::build(Observer::cie_1931_2deg(), DEPTH, &mut weights)?;
        let mut buffers = [[Interval::zero(); NODES]; 4];
        let mut leaves = Vec::new();
        for (number, ([wavelengths, values], buffer)) in nodes.iter().zip(&mut buffers).enumerate() {
            let outside = if number == 0 { Outside::Zero } else { Outside::Hold };
            leaves.push(Pyramid::build(&PiecewiseLinear::new(wavelengths, values, outside)?, &domain, buffer)?);
        }
        for mode in [Mode::Certified, Mode::Corrected, Mode::Paper] {
            for paints in 0..=3 {
                let mut ops = vec![Op::Leaf(0)];
                ops.extend((1..=paints).flat_map(|paint| [Op::Leaf(paint), Op::Product]));
                let target = Target { mode, threshold: self.between(0.5, 5.0), white };
                let (mut stack, mut pieces) = ([Interval::zero(); 2], [Piece::default(); 64]);
                let program = Program::new(&ops)?;
                let found = evaluate(&program, &domain, &target, &mut leaves.as_slice(), &mut stack, &mut pieces)?;
                self.numbers("product.xyz", &found.xyz)?;
                self.numbers("product.radius", &found.radius)?;
                self.print("product.delta_e", found.delta_e)?;
                let codes = [Status::Reached, Status::DepthExhausted, Status::PiecesExhausted];
                self.count("product.status", codes.iter().position(|&s| s == found.status).ok_or("a new status")?)?;
                self.pieces(&mut pieces[..found.intervals])?;
            }
        }
        Ok(())
    }

    fn pieces<R: Real>(&mut self, pieces: &mut [Piece<R>]) -> Outcome {
        pieces.sort_by(|a, b| a.node.limits::<f64>()[0].total_cmp(&b.node.limits::<f64>()[0]));
        for piece in pieces {
            let [from, to] = piece.node.limits::<R>();
            self.print("piece.from", from)?;
            self.print("piece.to", to)?;
            self.numbers("piece.xyz", &piece.xyz)?;
            self.numbers("piece.radius", &piece.radius)?;
        }
        Ok(())
    }

    fn colours<R: Real>(&mut self) -> Outcome {
        let (xyz, other, white) = (self.fill(0.0, 1.0), self.fill(0.0, 1.0), self.fill::<R, 3>(0.5, 1.5));
        for space in [RgbSpace::REC_709, RgbSpace::REC_2020, RgbSpace::ACESCG] {
            self.numbers("rgb", &space.from_xyz(xyz))?;
            self.numbers("xyz_of_rgb", &space.to_xyz(xyz))?;
        }
        let [r, g, b] = linear_rgb_to_srgb8(xyz).map(f64::from);
        self.bits("srgb8", r + 256.0 * g + 65536.0 * b)?;
        let (lab, second) = (xyz_to_lab(xyz, white), xyz_to_lab(other, white));
        self.numbers("lab", &lab)?;
        self.print("delta_e_ab", delta_e_ab(lab, second))?;
        self.print("delta_e_00", delta_e_00(lab, second))?;
        self.numbers("xyz_of_lab", &lab_to_xyz(second, white))
    }

    fn operators<R: Real>(&mut self) -> Outcome {
        let (light, paint) = (self.fill::<R, 3>(0.0, 1.0), self.fill::<R, 3>(0.125, 0.75));
        let tensors = [Tensor::classical(), Tensor::rec_709(), Tensor::iso_rgb(), Tensor::rec_2020(), Tensor::acescg()];
        for tensor in tensors {
            self.numbers("tensor", tensor.transfer().as_flattened())?;
            self.numbers("bilinear", &tensor.product(light, paint))?;
            self.numbers("reflection", tensor.reflection(paint).matrix().as_flattened())?;
            self.numbers("reflect", &tensor.reflection(paint).apply(light))?;
        }
        let sigmoid = Upsampler::d65(&RgbSpace::REC_709)?.reflectance(paint)?;
        self.numbers("sigmoid", &sigmoid.coefficients())?;
        let wavelength = self.between(380.0, 780.0);
        self.print("sigmoid_value", sigmoid.value(wavelength))?;
        self.numbers("smits", &Basis::reflectances().spectrum(paint)?.values())?;
        self.numbers("smits_light", &Basis::lights().spectrum(light)?.values())
    }

    fn reflectors<R: Real>(&mut self) -> Outcome {
        for variant in [Variant::Ward, Variant::WardDuer, Variant::WardNeumann, Variant::Balanced] {
            let [diffuse, specular] = self.fill(0.0, 0.5);
            let [alpha_u, alpha_v] = self.fill(0.05, 0.5);
            let reflector = Glossy::new(diffuse, specular, Ward::new(variant, alpha_u, alpha_v)?)?;
            let (light, view) = (direction(self.fill(0.125, 1.0))?, direction(self.fill(0.125, 1.0))?);
            let random = self.fill::<R, 3>(0.0, 1.0);
            self.print("evaluate", reflector.evaluate(light, view))?;
            self.print("pdf", reflector.pdf(light, view))?;
            self.print("albedo", reflector.albedo(view))?;
            let sample = reflector.sample(view, random).ok_or("below the surface")?;
            self.numbers("direction", &sample.direction)?;
            self.print("sample.pdf", sample.pdf)?;
            self.print("sample.weight", sample.weight)?;
        }
        let (cosine, real) = (self.between::<R>(0.0, 1.0), R::from_f64);
        self.print("schlick", fresnel::schlick(real(0.25), cosine))?;
        let (reflected, refracted) = fresnel::dielectric(cosine, real(1.5)).ok_or("total reflection")?;
        self.print("dielectric", reflected)?;
        self.print("dielectric.refracted", refracted)?;
        assert!(fresnel::dielectric(real(0.125), real(0.5)).is_none(), "total reflection");
        self.bits("total", 1.0)?;
        self.bits("total.refracted", 0.0)?;
        self.print("conductor", fresnel::conductor(cosine, real(0.25), real(3.5)))
    }

    fn factors<R: Real>(&mut self) -> Outcome {
        let two = R::TWO;
        let [x, y, _] = self.fill(-1.0, 1.0);
        let centre = [x, y, self.between(1.0, 4.0)];
        let disk = Disk::new(centre, [R::ZERO, R::ZERO, -two], self.between(0.25, 2.0))?;
        let normal: [R; 3] = self.fill(-1.0, 1.0);
        let receiver = Receiver::new([R::ZERO; 3], normal)?;
        self.print("disk", disk_configuration_factor(&disk, &receiver))?;
        self.print("sphere", sphere_configuration_factor(&Sphere::new(centre, disk.radius())?, &receiver))?;
        let [a, b] = self.fill(0.0, 2.0);
        let corners = [[-R::ONE, -R::ONE, two], [a, -R::ONE, two], [a, b, two], [-R::ONE, b, two]];
        self.print("polygon", polygon_configuration_factor(receiver.position(), receiver.normal(), &corners))?;
        self.print("parallel", rectangle_parallel_factor(a, b, two))?;
        self.print("perpendicular", rectangle_perpendicular_factor(a, b, two))?;
        let upright = Receiver::new([R::ZERO; 3], [normal[0], normal[1], R::ONE])?;
        self.estimates(&disk, &upright)?;
        self.parts(&disk)
    }

    fn estimates<R: Real>(&mut self, disk: &Disk<R>, receiver: &Receiver<R>) -> Outcome {
        let exact = disk_configuration_factor(disk, receiver);
        let request = Request { relative_error: R::from_f64(0.0625), max_samples: 4096, strata: 2 };
        let mut panels = vec![Panel::default(); 64];
        let respond = |aim: &Aim<R>| Response {
            emission: aim.cosine,
            visibility: if aim.point[0] > R::ZERO { R::ONE } else { R::ZERO },
        };
        let found = integrate(disk, receiver, &request, &mut panels, respond)?;
        self.print("estimate", found.value)?;
        self.print("estimate.error", found.error)?;
        self.count("estimate.samples", found.samples)?;
        let codes = {
            use estimate::Status::{Met, Panels, Resolution, Samples};
            [Met, Panels, Samples, Resolution]
        };
        self.count("estimate.status", codes.iter().position(|&s| s == found.status).ok_or("a new status")?)?;
        let share = ratio(disk, receiver, exact, &request, &mut panels, respond)?;
        self.print("ratio", share.value)?;
        self.print("ratio.error", share.error)?;
        self.count("ratio.samples", share.samples)?;
        self.count("asked", found.samples + share.samples)
    }

    fn parts<R: Real>(&mut self, disk: &Disk<R>) -> Outcome {
        for method in Method::ALL {
            let parts = Partition::<R>::full(method, 5)?;
            self.count("parts.count", parts.clone().count())?;
            for part in parts {
                self.numbers("part", &part.position())?;
                self.print("part.weight", part.weight())?;
                self.count("part.hits", usize::from(part.hits()))?;
            }
            let adaptive = Partition::adaptive(method, 6, disk, [R::ZERO; 3], R::from_f64(0.25))?;
            self.count("adaptive.count", adaptive.clone().count())?;
            for part in adaptive {
                self.numbers("adaptive", &part.position())?;
            }
        }
        Ok(())
    }

    fn all<R: Real>(&mut self) -> Outcome {
        self.state = 1;
        self.lights::<R>()?;
        for _ in 0..20 {
            self.products::<R>()?;
            self.colours::<R>()?;
            self.operators::<R>()?;
            self.reflectors::<R>()?;
            self.factors::<R>()?;
        }
        Ok(())
    }
}

fn main() -> Outcome {
    let mut lines = Lines { state: 1, out: BufWriter::new(io::stdout().lock()) };
    lines.all::<f32>()?;
    lines.all::<f64>()?;
    Ok(lines.out.flush()?)
}
