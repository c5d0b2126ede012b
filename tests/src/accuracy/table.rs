//! The table of tolerances: one entry for each numeric function, and the reasons why others have none.

use super::gauge::{Gauge, Unit};

/// What is measured of a function.
#[derive(Debug)]
pub struct Entry {
    /// The function's path in its crate.
    pub name: &'static str,
    /// What its errors are counted in.
    pub unit: Unit,
    /// The largest errors that pass, in `f32` and in `f64`.
    pub tolerance: [f64; 2],
    /// How they are measured.
    pub cases: [fn(&mut Gauge); 2],
}

/// Why a public function isn't measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Reason {
    /// It hands out what the value holds.
    Accessor,
    /// It checks its arguments and keeps them.
    Constructor,
    /// It returns whole numbers, names, texts or places in a tree: right or wrong, which other tests tell.
    Discrete,
    /// It hands out a built-in table, which a test compares with its source.
    Table,
    /// It declares what implementations do, or calls them: those are measured.
    Declaration,
    /// It calls another function, or is called by it, which is measured.
    By(&'static str),
}

macro_rules! entries {
    ($($name:literal $unit:expr, [$single:expr, $double:expr] $($case:ident)::+;)*) => {
        /// All entries, in the order of the table.
        pub static ENTRIES: &[Entry] = &[$(Entry {
            name: $name,
            unit: $unit,
            tolerance: [$single, $double],
            cases: [super::cases::$($case)::+::<f32>, super::cases::$($case)::+::<f64>],
        }),*];
    };
}

use Unit::{Absolute, OfBound, Relative, RelativeTo, Ulp, UlpOf, UlpOfLargest};

#[rustfmt::skip]
entries! {
    "Real::sqrt" Ulp, [0.5, 0.5] elementary::sqrt;
    "Real::cbrt" Ulp, [0.5, 0.5] elementary::cbrt;
    "Real::exp" Ulp, [1.0, 1.0] elementary::exp;
    "Real::exp_m1" Ulp, [0.8, 0.8] elementary::exp_m1;
    "Real::ln" Ulp, [0.8, 1.0] elementary::ln;
    "Real::powf" Ulp, [1.0, 1.0] elementary::powf;
    "Real::sin" Ulp, [0.5, 1.0] elementary::sin;
    "Real::cos" Ulp, [0.6, 0.8] elementary::cos;
    "Real::tan" Ulp, [1.0, 0.8] elementary::tan;
    "Real::asin" Ulp, [0.8, 0.8] elementary::asin;
    "Real::acos" Ulp, [1.0, 1.0] elementary::acos;
    "Real::atan" Ulp, [0.8, 0.8] elementary::atan;
    "Real::atan2" Ulp, [1.2, 1.2] elementary::atan2;
    "Real::hypot" Ulp, [1.0, 1.0] elementary::hypot;
    "Real::reciprocal_cbrt_estimate" Relative, [0.04, 0.04] elementary::reciprocal_cbrt_estimate;

    "colour::rgb::rgb_to_xyz_matrix" UlpOfLargest, [10.0, 10.0] colour::rgb_to_xyz_matrix;
    "colour::rgb::linear_rgb_to_xyz" UlpOf("the terms' sum"), [2.0, 8.0] colour::linear_rgb_to_xyz;
    "colour::rgb::xyz_to_linear_rgb" UlpOf("the terms' sum"), [2.0, 20.0] colour::xyz_to_linear_rgb;
    "colour::rgb::encode_srgb" Ulp, [3.0, 6.0] colour::encode_srgb;
    "colour::rgb::decode_srgb" Ulp, [8.0, 8.0] colour::decode_srgb;
    "colour::rgb::linear_rgb_to_srgb8" Absolute("codes"), [0.6, 0.6] colour::linear_rgb_to_srgb8;
    "colour::rgb::srgb8_to_linear_rgb" Ulp, [8.0, 10.0] colour::srgb8_to_linear_rgb;
    "colour::lab::lab_f" Ulp, [1.0, 1.0] colour::lab_f;
    "colour::lab::lab_f_inverse" UlpOf("s³, or 3δ²(|s| + 4/29)"), [1.5, 1.5] colour::lab_f_inverse;
    "colour::lab::xyz_to_lab" UlpOf("500"), [4.0, 5.0] colour::xyz_to_lab;
    "colour::lab::lab_to_xyz" UlpOf("the white"), [10.0, 10.0] colour::lab_to_xyz;
    "colour::delta_e::delta_e_ab" Ulp, [2.0, 1.5] colour::delta_e_ab;
    "colour::delta_e::delta_e_00" RelativeTo("ΔE00 + 1 % of the largest coordinate"), [2e-5, 3e-14] colour::delta_e_00;
    "colour::delta_e::delta_e_00_weighted" RelativeTo("ΔE00 + 1 % of the largest coordinate"), [4e-5, 6e-14] colour::delta_e_00_weighted;
    "colour::xyz::xyz_to_xyy" Ulp, [2.5, 2.5] colour::xyz_to_xyy;
    "colour::xyz::xyy_to_xyz" UlpOf("(1 + x + y) Y/y"), [1.5, 1.5] colour::xyy_to_xyz;
    "colour::in_precision" Ulp, [0.5, 0.0] colour::in_precision;
    "colour::space::RgbSpace::white" Ulp, [1.5, 1.5] colour::space_white;
    "colour::space::RgbSpace::to_xyz" UlpOf("the terms' sum"), [2.5, 60.0] colour::space_to_xyz;
    "colour::space::RgbSpace::from_xyz" UlpOf("the terms' sum"), [2.5, 50.0] colour::space_from_xyz;

    "spectrum::PiecewiseLinear::value" Ulp, [2.0, 1.5] spectra::piecewise_value;
    "spectrum::PiecewiseLinear::segment" Ulp, [2.0, 2.0] spectra::piecewise_segment;
    "spectrum::Uniform::value" Ulp, [2.0, 2.0] spectra::uniform_value;
    "spectrum::Uniform::segment" Ulp, [2.0, 2.0] spectra::uniform_segment;
    "spectrum::Constant::segment" Ulp, [0.0, 0.0] spectra::constant_segment;
    "spectrum::Scaled::value" Ulp, [3.0, 2.5] spectra::scaled_value;
    "spectrum::Scaled::segment" Ulp, [3.0, 2.5] spectra::scaled_segment;
    "spectrum::Line::segment" Ulp, [1.5, 1.0] spectra::line_segment;
    "spectrum::Line::peak" Ulp, [0.5, 0.5] spectra::line_peak;
    "spectrum::Lines::value" Ulp, [1.5, 2.0] spectra::lines_value;
    "spectrum::Lines::segment" Ulp, [1.5, 2.0] spectra::lines_segment;
    "spectrum::Planck::radiance" UlpOf("L (1 + c₂/(λT))"), [5.0, 4.0] spectra::planck_radiance;
    "spectrum::Planck::segment" UlpOf("L (1 + c₂/(λT))"), [2.0, 2.0] spectra::planck_segment;
    "spectrum::Daylight::nominal" Ulp, [0.5, 5.0] spectra::daylight_nominal;
    "spectrum::Daylight::chromaticity" Ulp, [0.5, 5.0] spectra::daylight_chromaticity;
    "spectrum::Daylight::factors" UlpOf("1 + |M|"), [0.6, 250.0] spectra::daylight_factors;
    "spectrum::Daylight::value" UlpOf("the terms, with |M| + 1"), [2.0, 40.0] spectra::daylight_value;
    "spectrum::Daylight::segment" UlpOf("the terms, with |M| + 1"), [2.0, 40.0] spectra::daylight_segment;
    "Observer::value" Ulp, [1.5, 0.8] spectra::observer_value;
    "tristimulus" Ulp, [4.0, 3.0] spectra::integrals;

    "interval::Node::limits" Ulp, [0.0, 0.0] intervals::limits;
    "interval::Domain::weight" Ulp, [1.2, 1.5] intervals::weights;
    "interval::Interval::of_spectrum" OfBound, [0.05, 0.04] intervals::of_spectrum;
    "interval::Interval::of_product" OfBound, [0.03, 0.03] intervals::of_product;
    "interval::Interval::constant" OfBound, [0.06, 0.08] intervals::constant;
    "interval::Interval::sum" OfBound, [0.08, 0.06] intervals::sum;
    "interval::Interval::scale" OfBound, [0.08, 0.08] intervals::scale;
    "interval::Interval::schlick" OfBound, [0.08, 0.08] intervals::schlick;
    "interval::Interval::product" OfBound, [1.0, 1.0] intervals::product;
    "interval::Interval::deviation" Relative, [2.5e-6, 5e-15] intervals::deviation;
    "interval::Interval::mean_tristimulus" UlpOf("the terms"), [0.6, 0.6] intervals::mean_tristimulus;
    "interval::Interval::tristimulus" UlpOf("the terms"), [0.6, 0.8] intervals::tristimulus;
    "interval::Interval::sum_first_order" UlpOf("the terms"), [0.6, 0.6] intervals::sum_first_order;
    "interval::Interval::scale_first_order" UlpOf("the terms"), [0.6, 0.6] intervals::scale_first_order;
    "interval::Interval::schlick_first_order" UlpOf("the terms"), [0.8, 1.5] intervals::schlick_first_order;
    "interval::Interval::product_first_order" UlpOf("the terms"), [1.2, 1.5] intervals::product_first_order;
    "adaptive::evaluate" OfBound, [1.0, 1.0] intervals::evaluated;
    "adaptive::evaluate_by_table" OfBound, [1.0, 1.0] intervals::evaluated_by_table;
    "subdivision::Subdivision::at_scale" OfBound, [1.0, 1.0] intervals::recorded;
    "bound::delta_e_bound" Relative, [8e-3, 2e-10] intervals::delta_e_bound;
    "bound::delta_e_majorant" Relative, [0.5, 0.6] intervals::delta_e_majorant;
    "threshold_table::ThresholdTable::tolerance" Absolute("ΔE*ab"), [1.0, 1.0] intervals::threshold_tolerance;

    "summation::SumGrid::sample" Ulp, [1.5, 1.5] lights::sampled_values;
    "summation::tristimulus_sum" Ulp, [4.0, 5.0] lights::tristimulus_sums;
    "summation::weighted_sum" UlpOf("the terms' sum"), [0.3, 0.4] lights::weighted_sums;
    "summation::DirectColours::illuminate" UlpOfLargest, [10.0, 10.0] lights::direct_illuminate;
    "summation::PreparedColours::illuminate" UlpOfLargest, [10.0, 10.0] lights::prepared_illuminate;
    "cct::xyz_to_uv" Ulp, [3.0, 3.0] lights::xyz_to_uv_case;
    "cct::PlanckianLocus::spectrum" UlpOf("S (1 + c₂/(λT))"), [6.0, 6.0] lights::locus_spectrum;
    "cct::PlanckianLocus::uv" Ulp, [10.0, 12.0] lights::locus_uv;
    "cct::correlated_colour_temperature" Relative, [5e-5, 8e-10] lights::cct;
    "adaptation::Adaptation::bradford" UlpOf("1½"), [15.0, 40.0] adaptation::bradford;
    "adaptation::Adaptation::von_kries" UlpOf("1½"), [10.0, 10.0] adaptation::von_kries;
    "adaptation::von_kries_uv" UlpOf("⅜"), [8.0, 6.0] adaptation::von_kries_uv_case;
    "adaptation::Cie1994::apply" UlpOf("1½"), [12.0, 8.0] adaptation::cie_1994;
    "colour_rendering::ReferenceLight::spectrum" UlpOf("the largest value"), [30.0, 30.0] rendering::reference_spectrum;
    "colour_rendering::cie_13_3" Absolute("index"), [6e-4, 1e-12] rendering::cie_13_3;
    "colour_rendering::cri00" Absolute("index"), [3e-4, 8e-13] rendering::cri00;
    "colour_rendering::r96" Absolute("index"), [5e-4, 5e-13] rendering::r96;
    "colour_rendering::fidelity" Absolute("index"), [1.5e-4, 2e-13] fidelity::fidelity;
    "colour_rendering::fidelity_reference" UlpOf("the largest value"), [20.0, 30.0] fidelity::fidelity_reference;
    "light::measure" Absolute("index"), [4e-4, 1e-10] lights::measure;
    "light::measure_indices" Absolute("index"), [5e-4, 1e-10] lights::measure_indices;
    "light::IndexMeter::measure" Absolute("index"), [5e-4, 1e-10] lights::index_meter;
    "light::LightMeter::measure" Absolute("index"), [4e-4, 1e-10] lights::light_meter;
    "light::LightMeter::munsell" Absolute("index"), [4e-4, 1e-10] lights::light_meter_munsell;
    "light::LightMeter::chromaticity" Relative, [1.5e-6, 2.5e-12] lights::light_meter_chromaticity;
    "light::measure_fidelity" Absolute("index"), [2.5e-4, 6e-11] fidelity::measure_fidelity;
    "light::FidelityMeter::measure" Absolute("index"), [2.5e-4, 6e-11] fidelity::fidelity_meter;
    "action::ActionSpectra::measure" Ulp, [8.0, 8.0] action::action;
    "action::Weighting::apply" Ulp, [1.5, 1.0] action::weighting_apply;
    "action::Projection::new" Relative, [4e-8, 1e-15] action::projection;
    "action::Projection::apply" UlpOf("the terms' sum"), [1.5, 1.5] action::projection_apply;
    "action::Projection::rgb" UlpOf("the terms' sum"), [0.8, 0.4] action::projection_rgb;
    "action::Projection::relative_error" UlpOf("1"), [12.0, 6.0] action::projection_error;

    "bilinear::Tensor::product" UlpOf("the terms' sum"), [2.5, 2.0] bilinear::product;
    "bilinear::Tensor::reflection" UlpOf("¾"), [1.5, 1.5] bilinear::reflection;
    "bilinear::Reflection::apply" UlpOf("the terms' sum"), [2.0, 2.0] bilinear::reflection_apply;
    "bilinear::Reflection::after" UlpOf("¾"), [3.0, 3.0] bilinear::reflection_after;
    "bilinear::Tensor::divisor" UlpOf("κ²"), [3.0, 3.0] bilinear::divisor;
    "bilinear::Divisor::quotient" UlpOf("κ times the largest component"), [3.0, 2.5] bilinear::quotient;
    "bilinear::Divisor::relighting" UlpOf("κ times the largest entry"), [3.0, 4.0] bilinear::relighting;
    "bilinear::Tensor::matrices" UlpOf("¾"), [1.0, 1.0] bilinear::matrices;
    "bilinear::Tensor::from_matrices" UlpOf("¾"), [0.8, 0.8] bilinear::from_matrices;
    "bilinear::Tensor::alpha" UlpOf("⅜"), [0.3, 0.3] bilinear::alpha;
    "bilinear::Tensor::with_alpha" Ulp, [2.0, 2.0] bilinear::with_alpha;
    "bilinear::Tensor::scaled" Ulp, [0.5, 0.5] bilinear::scaled;
    "bilinear::Tensor::rec_709" Absolute("coefficient"), [4e-9, 6e-13] bilinear::rec_709;
    "bilinear::Tensor::rec_2020" Absolute("coefficient"), [2e-8, 6e-13] bilinear::rec_2020;
    "bilinear::Tensor::acescg" Absolute("coefficient"), [1e-8, 5e-13] bilinear::acescg;
    "bilinear::estimate" Absolute("coefficient"), [2e-6, 1.5e-15] bilinear::estimate;
    "bilinear::estimate_rgb" Absolute("coefficient"), [6e-8, 2.5e-16] bilinear::estimate_rgb;
    "prefilter::Prefilter::new" UlpOf("the terms' sum"), [0.8, 1.5] prefilter::prefilter_new;
    "prefilter::Prefilter::material" UlpOf("the terms' sum"), [0.8, 2.0] prefilter::prefilter_material;
    "prefilter::Prefilter::other_light" UlpOf("the terms' sum"), [0.8, 1.5] prefilter::prefilter_other_light;
    "prefilter::Prefilter::balanced" Ulp, [1.2, 1.5] prefilter::prefilter_balanced;
    "upsampling::Sigmoid::smooth" UlpOf("ρ (1 + κ)"), [3.0, 4.0] upsampling::sigmoid_smooth;
    "upsampling::Sigmoid::segment" UlpOf("ρ (1 + κ)"), [3.0, 2.5] upsampling::sigmoid_segment;
    "upsampling::Sigmoid::grey" Ulp, [6.0, 5.0] upsampling::sigmoid_grey;
    "upsampling::Sigmoid::nanometre_coefficients" UlpOf("the terms' sum, in `f64`"), [1.5, 2.0] upsampling::nanometre_coefficients;
    "upsampling::Upsampler::colour" UlpOf("¾"), [40.0, 40.0] upsampling::upsampler_colour;
    "upsampling::Upsampler::reflectance" Absolute("linear sRGB"), [2.5e-6, 4e-15] upsampling::upsampler_reflectance;
    "upsampling::LightUpsampler::emission" Absolute("linear sRGB"), [3e-6, 4e-15] upsampling::emission;
    "upsampling::LightUpsampler::colour" UlpOf("¾"), [40.0, 25.0] upsampling::emission_colour;
    "upsampling::Emission::segment" UlpOf("S (1 + κ)"), [2.0, 2.5] upsampling::emission_segment;
    "upsampling::Emission::scale" Ulp, [2.5, 1.5] upsampling::emission_scale;
    "upsampling::smits::Basis::spectrum" UlpOf("the largest component"), [2.5, 2.0] upsampling::smits_spectrum;
    "upsampling::smits::Bins::segment" Ulp, [0.0, 0.0] upsampling::bins_segment;

    "fresnel::schlick_factor" Ulp, [8.0, 3.0] optics::schlick_factor;
    "fresnel::schlick" Ulp, [5.0, 2.5] optics::schlick;
    "fresnel::ward_factor" UlpOf("¾"), [1.0, 1.2] optics::ward_factor;
    "fresnel::ward" UlpOf("¾"), [2.0, 1.5] optics::ward;
    "fresnel::dielectric" UlpOf("1/cosine of refraction"), [2.5, 4.0] optics::dielectric;
    "fresnel::conductor" Ulp, [25.0, 12.0] optics::conductor;
    "dispersion::Sellmeier::new" Ulp, [1.5, 2.0] optics::sellmeier_new;
    "dispersion::Sellmeier::index" Ulp, [2.0, 2.0] optics::sellmeier_index;
    "dispersion::Sellmeier::derivative" Ulp, [10.0, 6.0] optics::sellmeier_derivative;
    "dispersion::Cauchy::new" Ulp, [0.8, 0.8] optics::cauchy_new;
    "dispersion::Cauchy::index" Ulp, [0.8, 0.5] optics::cauchy_index;
    "dispersion::Cauchy::derivative" Ulp, [3.0, 2.5] optics::cauchy_derivative;
    "dispersion::Dispersion::abbe_number" Relative, [3e-5, 4e-14] optics::abbe_number;

    "brdf::direction" UlpOf("¾"), [2.0, 2.0] reflectance::unit_direction;
    "brdf::Ward::evaluate" UlpOf("f (1 + tan²δ/α²)"), [5.0, 5.0] reflectance::ward_evaluate;
    "brdf::Ward::trigonometric" UlpOf("f (1 + tan²δ/α²)"), [40.0, 40.0] reflectance::ward_trigonometric;
    "brdf::Ward::pdf" UlpOf("p (1 + tan²δ/α²)"), [150.0, 400.0] reflectance::ward_pdf;
    "brdf::Ward::half_vector_pdf" UlpOf("p (1 + tan²δ/α²)"), [8.0, 8.0] reflectance::ward_half_vector_pdf;
    "brdf::Ward::sample" UlpOf("¾, of the direction"), [30.0, 60.0] reflectance::ward_sample;
    "brdf::Ward::sample_half_vector" UlpOf("¾, of the direction"), [20.0, 20.0] reflectance::ward_sample_half_vector;
    "brdf::Ward::invert" UlpOf("1/cos θ, of the direction"), [4.0, 4.0] reflectance::ward_invert;
    "brdf::Ward::albedo" Relative, [8e-5, 8e-5] albedo::ward;
    "brdf::Ward::albedo_by_quadrature" Relative, [1e-5, 1e-5] albedo::ward_by_quadrature;
    "brdf::Schlick::albedo" Relative, [4e-4, 4e-4] albedo::schlick;
    "brdf::Glossy::albedo" Relative, [2.5e-5, 2.5e-5] albedo::glossy_albedo;
    "brdf::Lambert::albedo" Ulp, [0.0, 0.0] albedo::lambert;
    "brdf::Lambert::evaluate" Ulp, [0.5, 0.5] reflectance::lambert_evaluate;
    "brdf::Lambert::pdf" Ulp, [1.2, 1.0] reflectance::lambert_pdf;
    "brdf::Lambert::sample" UlpOf("¾, of the direction"), [8.0, 8.0] reflectance::lambert_sample;
    "brdf::Lambert::invert" UlpOf("¾"), [1.5, 1.5] reflectance::lambert_invert;
    "brdf::Schlick::evaluate" Ulp, [12.0, 12.0] reflectance::schlick_evaluate;
    "brdf::Schlick::pdf" Ulp, [400.0, 800.0] reflectance::schlick_pdf;
    "brdf::Schlick::sample" UlpOf("¾, of the direction"), [200.0, 300.0] reflectance::schlick_sample;
    "brdf::Schlick::invert" UlpOf("1/cos θ, of the direction"), [4.0, 4.0] reflectance::schlick_invert;
    "brdf::Schlick::weights" UlpOf("¾"), [2.0, 2.0] reflectance::schlick_weights;
    "brdf::Schlick::geometric" UlpOf("D (1 + 1/r) + 1/π"), [1.5, 1.5] reflectance::schlick_geometric;
    "brdf::Glossy::evaluate" UlpOf("f (1 + tan²δ/α²)"), [2.5, 2.5] reflectance::glossy_evaluate;
    "brdf::Glossy::pdf" UlpOf("p (1 + tan²δ/α²)"), [3.0, 150.0] reflectance::glossy_pdf;

    "square_to_disk" UlpOf("¾"), [4.0, 3.0] maps::square_to_disk;
    "square_to_disk_pdf" Ulp, [0.5, 0.5] maps::square_to_disk_pdf;
    "disk_to_square" UlpOf("¾"), [1.5, 1.5] maps::disk_to_square;
    "square_to_disk_polar" UlpOf("¾"), [8.0, 8.0] maps::square_to_disk_polar;
    "square_to_disk_polar_pdf" Ulp, [0.5, 0.5] maps::square_to_disk_polar_pdf;
    "disk_to_square_polar" UlpOf("¾"), [1.5, 1.5] maps::disk_to_square_polar;
    "square_to_disk_elliptical" UlpOf("¾"), [2.0, 1.5] maps::square_to_disk_elliptical;
    "square_to_disk_elliptical_pdf" UlpOf("p/(1 − (s² + t²)/2)"), [2.5, 20.0] maps::square_to_disk_elliptical_pdf;
    "disk_to_square_elliptical" UlpOf("¾"), [5.0, 8.0] maps::disk_to_square_elliptical;
    "hexagon_to_disk" UlpOf("¾"), [3.0, 3.0] maps::hexagon_to_disk;
    "hexagon_to_disk_pdf" Ulp, [0.5, 0.5] maps::hexagon_to_disk_pdf;
    "disk_to_hexagon" UlpOf("¾"), [8.0, 10.0] maps::disk_to_hexagon;
    "Disk::new" UlpOf("¾, of the normal"), [2.0, 2.0] maps::disk_normal;
    "Disk::frame" UlpOf("1, of lengths and angles"), [2.5, 2.5] maps::disk_frame;
    "Disk::point" UlpOf("centre + radius"), [1.2, 1.5] maps::disk_point;
    "Disk::local" UlpOf("the vector's length"), [2.5, 2.5] maps::disk_local;
    "Disk::direction" UlpOf("¾"), [1.5, 1.5] maps::disk_direction;
    "disk_configuration_factor" Relative, [2e-6, 2e-14] factors::disk_configuration_factor;
    "disk_irradiance_vector" UlpOfLargest, [6.0, 8.0] factors::disk_irradiance_vector;
    "on_axis_disk_factor" Ulp, [5.0, 3.0] factors::on_axis_disk_factor;
    "disk_parallel_factor" Relative, [5e-7, 1e-15] factors::disk_parallel_factor;
    "disk_perpendicular_factor" Relative, [2e-6, 2e-14] factors::disk_perpendicular_factor;
    "sphere_configuration_factor" Relative, [2.5e-6, 2e-14] factors::sphere_configuration_factor;
    "polygon_configuration_factor" Relative, [3e-6, 1.5e-14] factors::polygon_configuration_factor;
    "polygon_irradiance_vector" UlpOfLargest, [60.0, 150.0] factors::polygon_irradiance_vector;
    "rectangle_parallel_factor" Ulp, [4.0, 4.0] factors::rectangle_parallel_factor;
    "rectangle_perpendicular_factor" Ulp, [5.0, 5.0] factors::rectangle_perpendicular_factor;
    "partition::Subsource::position" UlpOf("¾"), [2.5, 2.5] disks::position;
    "partition::Subsource::weight" Ulp, [0.5, 0.5] disks::weight;
    "partition::Subsource::extent" Ulp, [0.5, 0.8] disks::extent;
    "partition::Subsource::sample" UlpOf("¾"), [1.5, 1.5] disks::sample;
    "partition::Subsource::cubature" Absolute("means of 1, r², r⁴"), [6e-8, 3e-16] disks::cubature;
    "estimate::integrate" Relative, [1.5e-6, 3e-15] disks::integrate;
    "estimate::ratio" Relative, [6e-7, 6e-15] disks::ratio;
    "estimate::ratio_of_parts" Relative, [5e-7, 1.2e-15] disks::ratio_of_parts;
}

/// Public functions without an entry.
#[rustfmt::skip]
pub static EXEMPT: &[(Reason, &[&str])] = &[
    (Reason::Accessor, &[
        "Disk::centre", "Disk::normal", "Disk::radius", "Receiver::normal", "Receiver::position",
        "Sphere::centre", "Sphere::radius", "action::Weighting::weights", "bilinear::Reflection::matrix",
        "bilinear::Tensor::transfer", "brdf::Glossy::model", "brdf::Glossy::reflectances",
        "brdf::Schlick::isotropy", "brdf::Schlick::roughness", "brdf::Ward::alpha", "brdf::Ward::variant",
        "cct::PlanckianLocus::observer", "colour::space::RgbSpace::primaries", "dispersion::Cauchy::valid",
        "dispersion::Glass::valid", "dispersion::Sellmeier::valid", "expression::Program::ops",
        "expression::Program::stack_size", "interval::Domain::depth", "interval::Domain::observer",
        "interval::Node::index", "interval::Node::level", "interval::Pyramid::depth",
        "interval::Pyramid::get", "partition::Label::level", "partition::Label::path",
        "partition::Label::sector", "partition::Subsource::label", "spectrum::Line::centre",
        "spectrum::PiecewiseLinear::values", "spectrum::PiecewiseLinear::wavelengths",
        "spectrum::Planck::temperature", "spectrum::Uniform::first", "spectrum::Uniform::step",
        "spectrum::Uniform::values", "subdivision::Subdivision::stages", "subdivision::Subdivision::status",
        "summation::SumGrid::first", "summation::SumGrid::step", "threshold_table::ThresholdTable::threshold",
        "upsampling::Emission::sigmoid", "upsampling::Sigmoid::coefficients",
        "upsampling::smits::Bins::values",
    ]),
    (Reason::Constructor, &[
        "Observer::new", "Sphere::new", "bilinear::Tensor::classical", "bilinear::Tensor::new",
        "brdf::Glossy::new", "brdf::Schlick::new", "brdf::Ward::new", "estimate::Response::unoccluded",
        "expression::Program::new", "interval::Interval::zero", "interval::Node::new",
        "spectrum::Constant::new", "spectrum::Line::new", "spectrum::Lines::iter", "spectrum::Lines::new",
        "spectrum::PiecewiseLinear::new", "spectrum::Planck::new", "spectrum::Scaled::new",
        "spectrum::Uniform::new", "subdivision::Subdivision::from_stages", "summation::DirectColours::new",
        "summation::SumGrid::new", "upsampling::Sigmoid::new",
    ]),
    (Reason::Discrete, &[
        "Real::abs", "Real::binade", "Real::clamp", "Real::floor", "Real::from_usize", "Real::is_finite",
        "Real::is_nan", "Real::max", "Real::min", "Real::to_f64", "Real::to_usize", "adaptive::Mode::order",
        "bilinear::write_operator", "brdf::Variant::name", "cct::Cct::is_in_range",
        "colour_rendering::ReferenceLight::for_temperature", "colour_rendering::nearest_r96_reference",
        "interval::Node::children", "interval::Node::parent", "interval::Node::position",
        "interval::node_count", "interval::nodes", "partition::Label::child", "partition::Label::children",
        "partition::Label::neighbour", "partition::Label::parent", "partition::Label::root",
        "partition::Label::successor", "partition::Method::parts", "partition::Partition::adaptive",
        "partition::Partition::full", "partition::Partition::write", "partition::Subsource::hits",
        "spectrum::PiecewiseLinear::check_non_negative", "spectrum::Uniform::check_non_negative",
        "summation::SumGrid::wavelength", "tables::find_glass", "tables::find_light", "tables::find_lines",
        "tables::find_metal", "tables::lights", "threshold_table::ThresholdTable::accepts",
    ]),
    (Reason::Table, &[
        "Observer::cie_1931_2deg", "Observer::cie_1964_10deg", "Real::samples", "bilinear::Tensor::iso_rgb",
        "colour_rendering::colorchecker_samples", "colour_rendering::colour_evaluation_samples",
        "colour_rendering::munsell_samples", "dispersion::Glass::find", "dispersion::Glass::from_table",
        "spectrum::RadiationConstant::metre_kelvin", "summation::SumGrid::observer",
        "tables::LineTable::spectrum", "tables::MetalTable::k", "tables::MetalTable::n",
        "tables::ObserverTable::cmf", "tables::UniformTable::spectrum", "upsampling::smits::Basis::lights",
        "upsampling::smits::Basis::reflectances",
    ]),
    (Reason::Declaration, &[
        "brdf::Brdf::albedo", "brdf::Brdf::evaluate", "brdf::Brdf::invert", "brdf::Brdf::pdf",
        "brdf::Brdf::sample", "cct::Locus::node", "dispersion::Dispersion::derivative",
        "dispersion::Dispersion::index", "dispersion::Dispersion::valid", "dispersion::Glass::derivative",
        "dispersion::Glass::index", "expression::Sources::deferred", "expression::Sources::leaf",
        "spectrum::Spectrum::segment", "spectrum::Spectrum::value", "summation::TestColours::illuminate",
    ]),
    (Reason::By("colour::in_precision"), &[
        "Real::from_f64",
    ]),
    (Reason::By("colour::rgb::linear_rgb_to_srgb8"), &[
        "colour::rgb::quantise_8bit",
    ]),
    (Reason::By("colour::space::RgbSpace::from_xyz"), &[
        "colour::space::RgbSpace::new",
    ]),
    (Reason::By("Disk::new"), &[
        "Receiver::new",
    ]),
    (Reason::By("action::ActionSpectra::measure"), &[
        "action::ActionSpectra::new", "action::AlphaOpic::melanopic_der",
    ]),
    (Reason::By("action::Weighting::apply"), &[
        "action::Weighting::new",
    ]),
    (Reason::By("adaptation::Adaptation::bradford"), &[
        "adaptation::Adaptation::apply",
    ]),
    (Reason::By("adaptation::Cie1994::apply"), &[
        "adaptation::Cie1994::new",
    ]),
    (Reason::By("bilinear::Tensor::divisor"), &[
        "bilinear::Divisor::condition",
    ]),
    (Reason::By("brdf::Ward::sample"), &[
        "brdf::Glossy::sample",
    ]),
    (Reason::By("brdf::Lambert::invert"), &[
        "brdf::Glossy::invert",
    ]),
    (Reason::By("cct::correlated_colour_temperature"), &[
        "cct::LocusTable::new", "cct::LocusTable::node", "cct::PlanckianLocus::node",
    ]),
    (Reason::By("cct::PlanckianLocus::spectrum"), &[
        "cct::PlanckianLocus::new",
    ]),
    (Reason::By("adaptive::evaluate"), &[
        "expression::Program::evaluate",
    ]),
    (Reason::By("interval::Domain::weight"), &[
        "interval::Domain::build",
    ]),
    (Reason::By("interval::Interval::of_spectrum"), &[
        "interval::Pyramid::build",
    ]),
    (Reason::By("light::FidelityMeter::measure"), &[
        "light::FidelityMeter::new",
    ]),
    (Reason::By("light::IndexMeter::measure"), &[
        "light::IndexMeter::new",
    ]),
    (Reason::By("light::LightMeter::measure"), &[
        "light::LightMeter::new",
    ]),
    (Reason::By("partition::Subsource::position"), &[
        "partition::Subsource::new",
    ]),
    (Reason::By("prefilter::Prefilter::new"), &[
        "prefilter::Prefilter::light", "prefilter::Prefilter::luminance",
    ]),
    (Reason::By("spectrum::Daylight::chromaticity"), &[
        "spectrum::Daylight::new",
    ]),
    (Reason::By("subdivision::Subdivision::at_scale"), &[
        "subdivision::Subdivision::record",
    ]),
    (Reason::By("summation::PreparedColours::illuminate"), &[
        "summation::PreparedColours::new",
    ]),
    (Reason::By("threshold_table::ThresholdTable::tolerance"), &[
        "threshold_table::ThresholdTable::build",
    ]),
    (Reason::By("upsampling::LightUpsampler::emission"), &[
        "upsampling::LightUpsampler::d65", "upsampling::LightUpsampler::new",
    ]),
    (Reason::By("upsampling::Upsampler::colour"), &[
        "upsampling::Upsampler::d65", "upsampling::Upsampler::new",
    ]),
];
