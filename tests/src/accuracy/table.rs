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
    "colour::lab::lab_f_inverse" Ulp, [2.0, 2.0] colour::lab_f_inverse;
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
}

/// Public functions without an entry.
pub static EXEMPT: &[(Reason, &[&str])] = &[];
