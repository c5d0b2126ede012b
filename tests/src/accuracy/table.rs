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
    "Real::exp_m1" Ulp, [1.0, 1.0] elementary::exp_m1;
    "Real::ln" Ulp, [1.0, 1.0] elementary::ln;
    "Real::powf" Ulp, [1.0, 1.0] elementary::powf;
    "Real::sin" Ulp, [1.0, 1.0] elementary::sin;
    "Real::cos" Ulp, [1.0, 1.0] elementary::cos;
    "Real::tan" Ulp, [1.0, 1.0] elementary::tan;
    "Real::asin" Ulp, [1.0, 1.0] elementary::asin;
    "Real::acos" Ulp, [1.0, 1.0] elementary::acos;
    "Real::atan" Ulp, [1.0, 1.0] elementary::atan;
    "Real::atan2" Ulp, [1.0, 1.0] elementary::atan2;
    "Real::hypot" Ulp, [1.0, 1.0] elementary::hypot;
    "Real::reciprocal_cbrt_estimate" Relative, [0.04, 0.04] elementary::reciprocal_cbrt_estimate;

    "colour::rgb::rgb_to_xyz_matrix" UlpOfLargest, [1.0, 1.0] colour::rgb_to_xyz_matrix;
    "colour::rgb::linear_rgb_to_xyz" UlpOf("the terms' sum"), [1.0, 1.0] colour::linear_rgb_to_xyz;
    "colour::rgb::xyz_to_linear_rgb" UlpOf("the terms' sum"), [1.0, 1.0] colour::xyz_to_linear_rgb;
    "colour::rgb::encode_srgb" Ulp, [4.0, 4.0] colour::encode_srgb;
    "colour::rgb::decode_srgb" Ulp, [4.0, 4.0] colour::decode_srgb;
    "colour::rgb::linear_rgb_to_srgb8" Absolute("codes"), [0.5, 0.5] colour::linear_rgb_to_srgb8;
    "colour::rgb::srgb8_to_linear_rgb" Ulp, [4.0, 4.0] colour::srgb8_to_linear_rgb;
    "colour::lab::lab_f" Ulp, [2.0, 2.0] colour::lab_f;
    "colour::lab::lab_f_inverse" UlpOf("s³, or 3δ²(|s| + 4/29)"), [2.0, 2.0] colour::lab_f_inverse;
    "colour::lab::xyz_to_lab" UlpOf("500"), [1.0, 1.0] colour::xyz_to_lab;
    "colour::lab::lab_to_xyz" UlpOf("the white"), [1.0, 1.0] colour::lab_to_xyz;
    "colour::delta_e::delta_e_ab" Ulp, [2.0, 2.0] colour::delta_e_ab;
    "colour::delta_e::delta_e_00" RelativeTo("ΔE00 + 1 % of the largest coordinate"), [1e-5, 1e-13] colour::delta_e_00;
    "colour::delta_e::delta_e_00_weighted" RelativeTo("ΔE00 + 1 % of the largest coordinate"), [1e-5, 1e-13] colour::delta_e_00_weighted;
    "colour::xyz::xyz_to_xyy" Ulp, [2.0, 2.0] colour::xyz_to_xyy;
    "colour::xyz::xyy_to_xyz" UlpOf("(1 + x + y) Y/y"), [2.0, 2.0] colour::xyy_to_xyz;
    "colour::in_precision" Ulp, [0.5, 0.0] colour::in_precision;
    "colour::space::RgbSpace::white" Ulp, [1.0, 1.0] colour::space_white;
    "colour::space::RgbSpace::to_xyz" UlpOf("the terms' sum"), [1.0, 1.0] colour::space_to_xyz;
    "colour::space::RgbSpace::from_xyz" UlpOf("the terms' sum"), [1.0, 1.0] colour::space_from_xyz;

    "spectrum::PiecewiseLinear::value" Ulp, [4.0, 4.0] spectra::piecewise_value;
    "spectrum::PiecewiseLinear::segment" Ulp, [4.0, 4.0] spectra::piecewise_segment;
    "spectrum::Uniform::value" Ulp, [4.0, 4.0] spectra::uniform_value;
    "spectrum::Uniform::segment" Ulp, [4.0, 4.0] spectra::uniform_segment;
    "spectrum::Constant::segment" Ulp, [0.0, 0.0] spectra::constant_segment;
    "spectrum::Scaled::value" Ulp, [4.0, 4.0] spectra::scaled_value;
    "spectrum::Scaled::segment" Ulp, [4.0, 4.0] spectra::scaled_segment;
    "spectrum::Line::segment" Ulp, [4.0, 4.0] spectra::line_segment;
    "spectrum::Line::peak" Ulp, [4.0, 4.0] spectra::line_peak;
    "spectrum::Lines::value" Ulp, [4.0, 4.0] spectra::lines_value;
    "spectrum::Lines::segment" Ulp, [4.0, 4.0] spectra::lines_segment;
    "spectrum::Planck::radiance" UlpOf("L (1 + c₂/(λT))"), [4.0, 4.0] spectra::planck_radiance;
    "spectrum::Planck::segment" UlpOf("L (1 + c₂/(λT))"), [4.0, 4.0] spectra::planck_segment;
    "spectrum::Daylight::nominal" Ulp, [4.0, 4.0] spectra::daylight_nominal;
    "spectrum::Daylight::chromaticity" Ulp, [4.0, 4.0] spectra::daylight_chromaticity;
    "spectrum::Daylight::factors" UlpOf("1 + |M|"), [4.0, 4.0] spectra::daylight_factors;
    "spectrum::Daylight::value" UlpOf("the terms, with |M| + 1"), [4.0, 4.0] spectra::daylight_value;
    "spectrum::Daylight::segment" UlpOf("the terms, with |M| + 1"), [4.0, 4.0] spectra::daylight_segment;
    "Observer::value" Ulp, [4.0, 4.0] spectra::observer_value;
    "tristimulus" Ulp, [16.0, 16.0] spectra::integrals;

    "interval::Node::limits" Ulp, [0.0, 0.0] intervals::limits;
    "interval::Domain::weight" Ulp, [4.0, 4.0] intervals::weights;
    "interval::Interval::of_spectrum" OfBound, [1.0, 1.0] intervals::of_spectrum;
    "interval::Interval::of_product" OfBound, [1.0, 1.0] intervals::of_product;
    "interval::Interval::constant" OfBound, [1.0, 1.0] intervals::constant;
    "interval::Interval::sum" OfBound, [1.0, 1.0] intervals::sum;
    "interval::Interval::scale" OfBound, [1.0, 1.0] intervals::scale;
    "interval::Interval::schlick" OfBound, [1.0, 1.0] intervals::schlick;
    "interval::Interval::product" OfBound, [1.0, 1.0] intervals::product;
    "interval::Interval::deviation" Relative, [1e-5, 1e-14] intervals::deviation;
    "interval::Interval::mean_tristimulus" UlpOf("the terms"), [4.0, 4.0] intervals::mean_tristimulus;
    "interval::Interval::tristimulus" UlpOf("the terms"), [4.0, 4.0] intervals::tristimulus;
    "interval::Interval::sum_first_order" UlpOf("the terms"), [4.0, 4.0] intervals::sum_first_order;
    "interval::Interval::scale_first_order" UlpOf("the terms"), [4.0, 4.0] intervals::scale_first_order;
    "interval::Interval::schlick_first_order" UlpOf("the terms"), [4.0, 4.0] intervals::schlick_first_order;
    "interval::Interval::product_first_order" UlpOf("the terms"), [4.0, 4.0] intervals::product_first_order;
    "adaptive::evaluate" OfBound, [1.0, 1.0] intervals::evaluated;
    "adaptive::evaluate_by_table" OfBound, [1.0, 1.0] intervals::evaluated_by_table;
    "subdivision::Subdivision::at_scale" OfBound, [1.0, 1.0] intervals::recorded;
    "bound::delta_e_bound" Relative, [1e-3, 1e-11] intervals::delta_e_bound;
    "bound::delta_e_majorant" Relative, [1e-3, 1e-11] intervals::delta_e_majorant;
    "threshold_table::ThresholdTable::tolerance" Absolute("ΔE\\*ab"), [1.0, 1.0] intervals::threshold_tolerance;

    "summation::SumGrid::sample" Ulp, [4.0, 4.0] lights::sampled_values;
    "summation::tristimulus_sum" Ulp, [40.0, 40.0] lights::tristimulus_sums;
    "summation::weighted_sum" UlpOf("the terms' sum"), [4.0, 4.0] lights::weighted_sums;
    "summation::DirectColours::illuminate" UlpOfLargest, [40.0, 40.0] lights::direct_illuminate;
    "summation::PreparedColours::illuminate" UlpOfLargest, [40.0, 40.0] lights::prepared_illuminate;
    "cct::xyz_to_uv" Ulp, [4.0, 4.0] lights::xyz_to_uv_case;
    "cct::PlanckianLocus::spectrum" UlpOf("S (1 + c₂/(λT))"), [10.0, 10.0] lights::locus_spectrum;
    "cct::PlanckianLocus::uv" Ulp, [40.0, 40.0] lights::locus_uv;
    "cct::correlated_colour_temperature" Relative, [1e-5, 1e-8] lights::cct;
    "adaptation::Adaptation::bradford" UlpOf("1½"), [10.0, 10.0] lights::bradford;
    "adaptation::Adaptation::von_kries" UlpOf("1½"), [10.0, 10.0] lights::von_kries;
    "adaptation::von_kries_uv" UlpOf("⅜"), [10.0, 10.0] lights::von_kries_uv_case;
    "adaptation::Cie1994::apply" UlpOf("1½"), [10.0, 10.0] lights::cie_1994;
    "colour_rendering::ReferenceLight::spectrum" UlpOf("the largest value"), [10.0, 10.0] lights::reference_spectrum;
    "colour_rendering::cie_13_3" Absolute("index"), [1e-3, 1e-11] lights::cie_13_3;
    "colour_rendering::cri00" Absolute("index"), [1e-3, 1e-11] lights::cri00;
    "colour_rendering::r96" Absolute("index"), [1e-3, 1e-11] lights::r96;
    "colour_rendering::fidelity_reference" UlpOf("the largest value"), [10.0, 10.0] lights::fidelity_reference;
    "light::measure" Absolute("index"), [1e-3, 1e-9] lights::measure;
    "light::measure_indices" Absolute("index"), [1e-3, 1e-9] lights::measure_indices;
    "light::IndexMeter::measure" Absolute("index"), [1e-3, 1e-9] lights::index_meter;
    "light::LightMeter::measure" Absolute("index"), [1e-3, 1e-9] lights::light_meter;
    "light::LightMeter::munsell" Absolute("index"), [1e-3, 1e-9] lights::light_meter_munsell;
    "light::LightMeter::chromaticity" Relative, [1e-4, 1e-9] lights::light_meter_chromaticity;
    "light::measure_fidelity" Absolute("index"), [1e-3, 1e-9] lights::measure_fidelity;
    "light::FidelityMeter::measure" Absolute("index"), [1e-3, 1e-9] lights::fidelity_meter;
    "action::ActionSpectra::measure" Ulp, [10.0, 10.0] lights::action;
    "action::Weighting::apply" Ulp, [10.0, 10.0] lights::weighting_apply;
    "action::Projection::new" Relative, [1e-6, 1e-13] lights::projection;
    "action::Projection::apply" UlpOf("the terms' sum"), [4.0, 4.0] lights::projection_apply;
    "action::Projection::rgb" UlpOf("the terms' sum"), [4.0, 4.0] lights::projection_rgb;
    "action::Projection::relative_error" UlpOf("1"), [1e-4, 1e-13] lights::projection_error;

    "bilinear::Tensor::product" UlpOf("the terms' sum"), [4.0, 4.0] components::product;
    "bilinear::Tensor::reflection" UlpOf("¾"), [4.0, 4.0] components::reflection;
    "bilinear::Reflection::apply" UlpOf("the terms' sum"), [4.0, 4.0] components::reflection_apply;
    "bilinear::Reflection::after" UlpOf("¾"), [4.0, 4.0] components::reflection_after;
    "bilinear::Tensor::divisor" UlpOf("κ²"), [10.0, 10.0] components::divisor;
    "bilinear::Divisor::quotient" UlpOf("κ times the largest component"), [10.0, 10.0] components::quotient;
    "bilinear::Divisor::relighting" UlpOf("κ times the largest entry"), [10.0, 10.0] components::relighting;
    "bilinear::Tensor::matrices" UlpOf("¾"), [4.0, 4.0] components::matrices;
    "bilinear::Tensor::from_matrices" UlpOf("¾"), [4.0, 4.0] components::from_matrices;
    "bilinear::Tensor::alpha" UlpOf("⅜"), [4.0, 4.0] components::alpha;
    "bilinear::Tensor::with_alpha" Ulp, [10.0, 10.0] components::with_alpha;
    "bilinear::Tensor::scaled" Ulp, [1.0, 1.0] components::scaled;
    "bilinear::Tensor::rec_709" Absolute("coefficient"), [1e-6, 1e-14] components::rec_709;
    "bilinear::Tensor::rec_2020" Absolute("coefficient"), [1e-6, 1e-14] components::rec_2020;
    "bilinear::Tensor::acescg" Absolute("coefficient"), [1e-6, 1e-14] components::acescg;
    "bilinear::estimate" Absolute("coefficient"), [1e-6, 1e-14] components::estimate;
    "bilinear::estimate_rgb" Absolute("coefficient"), [1e-6, 1e-14] components::estimate_rgb;
    "prefilter::Prefilter::new" UlpOf("the terms' sum"), [10.0, 10.0] components::prefilter_new;
    "prefilter::Prefilter::material" UlpOf("the terms' sum"), [32.0, 32.0] components::prefilter_material;
    "prefilter::Prefilter::other_light" UlpOf("the terms' sum"), [10.0, 10.0] components::prefilter_other_light;
    "prefilter::Prefilter::balanced" Ulp, [4.0, 4.0] components::prefilter_balanced;
    "upsampling::Sigmoid::smooth" UlpOf("ρ (1 + κ)"), [4.0, 4.0] components::sigmoid_smooth;
    "upsampling::Sigmoid::segment" UlpOf("ρ (1 + κ)"), [4.0, 4.0] components::sigmoid_segment;
    "upsampling::Sigmoid::grey" Ulp, [4.0, 4.0] components::sigmoid_grey;
    "upsampling::Sigmoid::nanometre_coefficients" UlpOf("the terms' sum, in `f64`"), [4.0, 4.0] components::nanometre_coefficients;
    "upsampling::Upsampler::colour" UlpOf("¾"), [40.0, 40.0] components::upsampler_colour;
    "upsampling::Upsampler::reflectance" Absolute("linear sRGB"), [1e-5, 1e-12] components::upsampler_reflectance;
    "upsampling::LightUpsampler::emission" Absolute("linear sRGB"), [1e-5, 1e-12] components::emission;
    "upsampling::LightUpsampler::colour" UlpOf("¾"), [40.0, 40.0] components::emission_colour;
    "upsampling::Emission::segment" UlpOf("S (1 + κ)"), [10.0, 10.0] components::emission_segment;
    "upsampling::Emission::scale" Ulp, [10.0, 10.0] components::emission_scale;
    "upsampling::smits::Basis::spectrum" UlpOf("the largest component"), [4.0, 4.0] components::smits_spectrum;
    "upsampling::smits::Bins::segment" Ulp, [0.0, 0.0] components::bins_segment;

    "fresnel::schlick_factor" Ulp, [4.0, 4.0] optics::schlick_factor;
    "fresnel::schlick" Ulp, [4.0, 4.0] optics::schlick;
    "fresnel::ward_factor" UlpOf("¾"), [4.0, 4.0] optics::ward_factor;
    "fresnel::ward" UlpOf("¾"), [4.0, 4.0] optics::ward;
    "fresnel::dielectric" UlpOf("1/cosine of refraction"), [4.0, 4.0] optics::dielectric;
    "fresnel::conductor" Ulp, [4.0, 4.0] optics::conductor;
    "dispersion::Sellmeier::new" Ulp, [4.0, 4.0] optics::sellmeier_new;
    "dispersion::Sellmeier::index" Ulp, [4.0, 4.0] optics::sellmeier_index;
    "dispersion::Sellmeier::derivative" Ulp, [4.0, 4.0] optics::sellmeier_derivative;
    "dispersion::Cauchy::new" Ulp, [4.0, 4.0] optics::cauchy_new;
    "dispersion::Cauchy::index" Ulp, [4.0, 4.0] optics::cauchy_index;
    "dispersion::Cauchy::derivative" Ulp, [4.0, 4.0] optics::cauchy_derivative;
    "dispersion::Dispersion::abbe_number" Relative, [1e-3, 1e-12] optics::abbe_number;

    "brdf::direction" UlpOf("¾"), [2.0, 2.0] reflectance::unit_direction;
    "brdf::Ward::evaluate" UlpOf("f (1 + tan²δ/α²)"), [2.0, 2.0] reflectance::ward_evaluate;
    "brdf::Ward::trigonometric" UlpOf("f (1 + tan²δ/α²)"), [2.0, 2.0] reflectance::ward_trigonometric;
    "brdf::Ward::pdf" UlpOf("p (1 + tan²δ/α²)"), [2.0, 2.0] reflectance::ward_pdf;
    "brdf::Ward::half_vector_pdf" UlpOf("p (1 + tan²δ/α²)"), [2.0, 2.0] reflectance::ward_half_vector_pdf;
    "brdf::Ward::sample" UlpOf("¾, of the direction"), [2.0, 2.0] reflectance::ward_sample;
    "brdf::Ward::sample_half_vector" UlpOf("¾, of the direction"), [2.0, 2.0] reflectance::ward_sample_half_vector;
    "brdf::Ward::invert" UlpOf("1/cos θ, of the direction"), [2.0, 2.0] reflectance::ward_invert;
    "brdf::Ward::albedo" Relative, [2e-4, 2e-4] albedo::ward;
    "brdf::Ward::albedo_by_quadrature" Relative, [2e-5, 2e-5] albedo::ward_by_quadrature;
    "brdf::Schlick::albedo" Relative, [1e-4, 1e-4] albedo::schlick;
    "brdf::Glossy::albedo" Relative, [2e-4, 2e-4] albedo::glossy_albedo;
    "brdf::Lambert::albedo" Ulp, [0.0, 0.0] albedo::lambert;
    "brdf::Lambert::evaluate" Ulp, [2.0, 2.0] reflectance::lambert_evaluate;
    "brdf::Lambert::pdf" Ulp, [2.0, 2.0] reflectance::lambert_pdf;
    "brdf::Lambert::sample" UlpOf("¾, of the direction"), [2.0, 2.0] reflectance::lambert_sample;
    "brdf::Lambert::invert" UlpOf("¾"), [2.0, 2.0] reflectance::lambert_invert;
    "brdf::Schlick::evaluate" Ulp, [2.0, 2.0] reflectance::schlick_evaluate;
    "brdf::Schlick::pdf" Ulp, [2.0, 2.0] reflectance::schlick_pdf;
    "brdf::Schlick::sample" UlpOf("¾, of the direction"), [2.0, 2.0] reflectance::schlick_sample;
    "brdf::Schlick::invert" UlpOf("1/cos θ, of the direction"), [2.0, 2.0] reflectance::schlick_invert;
    "brdf::Schlick::weights" UlpOf("¾"), [2.0, 2.0] reflectance::schlick_weights;
    "brdf::Schlick::geometric" UlpOf("D (1 + 1/r) + 1/π"), [2.0, 2.0] reflectance::schlick_geometric;
    "brdf::Glossy::evaluate" UlpOf("f (1 + tan²δ/α²)"), [2.0, 2.0] reflectance::glossy_evaluate;
    "brdf::Glossy::pdf" UlpOf("p (1 + tan²δ/α²)"), [2.0, 2.0] reflectance::glossy_pdf;

    "square_to_disk" UlpOf("¾"), [2.0, 2.0] maps::square_to_disk;
    "square_to_disk_pdf" Ulp, [2.0, 2.0] maps::square_to_disk_pdf;
    "disk_to_square" UlpOf("¾"), [2.0, 2.0] maps::disk_to_square;
    "square_to_disk_polar" UlpOf("¾"), [2.0, 2.0] maps::square_to_disk_polar;
    "square_to_disk_polar_pdf" Ulp, [2.0, 2.0] maps::square_to_disk_polar_pdf;
    "disk_to_square_polar" UlpOf("¾"), [2.0, 2.0] maps::disk_to_square_polar;
    "square_to_disk_elliptical" UlpOf("¾"), [2.0, 2.0] maps::square_to_disk_elliptical;
    "square_to_disk_elliptical_pdf" UlpOf("p/(1 − (s² + t²)/2)"), [2.0, 2.0] maps::square_to_disk_elliptical_pdf;
    "disk_to_square_elliptical" UlpOf("¾"), [2.0, 2.0] maps::disk_to_square_elliptical;
    "hexagon_to_disk" UlpOf("¾"), [2.0, 2.0] maps::hexagon_to_disk;
    "hexagon_to_disk_pdf" Ulp, [2.0, 2.0] maps::hexagon_to_disk_pdf;
    "disk_to_hexagon" UlpOf("¾"), [2.0, 2.0] maps::disk_to_hexagon;
    "Disk::new" UlpOf("¾, of the normal"), [2.0, 2.0] maps::disk_normal;
    "Disk::frame" UlpOf("1, of lengths and angles"), [2.0, 2.0] maps::disk_frame;
    "Disk::point" UlpOf("centre + radius"), [2.0, 2.0] maps::disk_point;
    "Disk::local" UlpOf("the vector's length"), [2.0, 2.0] maps::disk_local;
    "Disk::direction" UlpOf("¾"), [2.0, 2.0] maps::disk_direction;
    "disk_configuration_factor" Relative, [1e-5, 1e-12] factors::disk_configuration_factor;
    "disk_irradiance_vector" UlpOfLargest, [2.0, 2.0] factors::disk_irradiance_vector;
    "on_axis_disk_factor" Ulp, [2.0, 2.0] factors::on_axis_disk_factor;
    "disk_parallel_factor" Relative, [1e-5, 1e-12] factors::disk_parallel_factor;
    "disk_perpendicular_factor" Relative, [1e-5, 1e-12] factors::disk_perpendicular_factor;
    "sphere_configuration_factor" Relative, [1e-5, 1e-12] factors::sphere_configuration_factor;
    "polygon_configuration_factor" Relative, [1e-5, 1e-12] factors::polygon_configuration_factor;
    "polygon_irradiance_vector" UlpOfLargest, [1e-5, 1e-12] factors::polygon_irradiance_vector;
    "rectangle_parallel_factor" Ulp, [8.0, 8.0] factors::rectangle_parallel_factor;
    "rectangle_perpendicular_factor" Ulp, [16.0, 16.0] factors::rectangle_perpendicular_factor;
    "partition::Subsource::position" UlpOf("¾"), [10.0, 10.0] disks::position;
    "partition::Subsource::weight" Ulp, [1.0, 1.0] disks::weight;
    "partition::Subsource::extent" Ulp, [1.0, 1.0] disks::extent;
    "partition::Subsource::sample" UlpOf("¾"), [10.0, 10.0] disks::sample;
    "partition::Subsource::cubature" Absolute("means of 1, r², r⁴"), [1e-6, 1e-14] disks::cubature;
    "estimate::integrate" Relative, [1e-5, 1e-12] disks::integrate;
    "estimate::ratio" Relative, [1e-5, 1e-12] disks::ratio;
    "estimate::ratio_of_parts" Relative, [1e-4, 1e-12] disks::ratio_of_parts;
}

/// Public functions without an entry.
pub static EXEMPT: &[(Reason, &[&str])] = &[];
