//! Refractive indices against the catalogues, against differences, and in both precisions.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail by panicking")]

use spectral_core::dispersion::{Cauchy, Dispersion, DispersionError, Glass, LINE_C, LINE_D, LINE_F, Sellmeier};
use spectral_core::tables::{find_glass, glasses};
use spectral_tests::tables::Csv;

/// Half a unit of the last printed digit.
fn half_unit(printed: &str) -> f64 {
    let decimals = printed.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    0.5 * 0.1_f64.powi(i32::try_from(decimals).unwrap())
}

/// `published`: the n_d and V_d of the coefficients' sources.
#[test]
fn index_and_abbe_number_are_as_printed() {
    let mut count = 0;
    for file in ["sellmeier_coefficients.csv", "cauchy_coefficients.csv"] {
        let csv = Csv::read(file).unwrap();
        let names = csv.column("material").unwrap();
        for ((name, nd), vd) in names.iter().zip(csv.column("nd").unwrap()).zip(csv.column("Vd").unwrap()) {
            let glass = Glass::<f64>::find(name).unwrap();
            let (index, abbe) = (glass.index(LINE_D), glass.abbe_number());
            // The catalogues drop trailing zeros: five decimals at least of n_d, two of V_d.
            let (n_tolerance, v_tolerance) = (half_unit(nd).min(5e-6), half_unit(vd).min(5e-3));
            assert!((index - nd.parse::<f64>().unwrap()).abs() <= n_tolerance, "{name}: {index}");
            assert!((abbe - vd.parse::<f64>().unwrap()).abs() <= v_tolerance, "{name}: {abbe}");
            count += 1;
        }
    }
    assert_eq!(count, glasses::ALL.len());
}

/// `published`: Schott's data sheet of N-BK7, lines C', C, e, F, F', g, h.
#[test]
fn bk7_at_other_lines() {
    let glass = Glass::<f64>::from_table(&glasses::N_BK7);
    let lines = [
        (643.8469, 1.51472),
        (656.2725, 1.51432),
        (546.0740, 1.51872),
        (486.1327, 1.52238),
        (479.9914, 1.52283),
        (435.8343, 1.52668),
        (404.6561, 1.53024),
    ];
    for (wavelength, printed) in lines {
        assert!((glass.index(wavelength) - printed).abs() <= 5e-6, "{wavelength} nm: {}", glass.index(wavelength));
    }
}

#[test]
fn glass_437907_is_its_code_tabulated() {
    let glass = Glass::<f64>::from_table(&glasses::GLASS_437907);
    let (wavelengths, indices) = Csv::read("glass_437907_cauchy.csv").unwrap().numbers("n").unwrap();
    for (wavelength, index) in wavelengths.into_iter().zip(indices) {
        // The coefficients are stated to ten decimals, A's rounding and B's (times 1/λ² < 7).
        assert!((glass.index(wavelength) - index).abs() <= 8.0 * 0.5e-10, "{wavelength} nm");
    }
}

#[test]
fn derivative_is_the_slope() {
    for table in &glasses::ALL {
        let glass = Glass::<f64>::from_table(table);
        for wavelength in (400..=740).step_by(20).map(f64::from) {
            let h = 0.01;
            let slope = (glass.index(wavelength + h) - glass.index(wavelength - h)) / (2.0 * h);
            let derivative = glass.derivative(wavelength);
            // Truncation h²/6 n''' (n''' below 100 n'/λ²) and rounding EPSILON n / h.
            let tolerance = derivative.abs() * h * h * 20.0 / (wavelength * wavelength) + 8.0 * f64::EPSILON / h;
            assert!(
                (slope - derivative).abs() <= tolerance,
                "{} at {wavelength} nm: {slope}, {derivative}",
                table.name
            );
            assert!(derivative < 0.0, "{} at {wavelength} nm: normal dispersion", table.name);
        }
    }
}

#[test]
fn single_precision_is_as_documented() {
    let epsilon = f64::from(f32::EPSILON);
    for table in &glasses::ALL {
        let (single, double) = (Glass::<f32>::from_table(table), Glass::<f64>::from_table(table));
        let bound = if matches!(single, Glass::Cauchy(_)) { 3.0 } else { 8.0 };
        for wavelength in 380_u16..=780 {
            let exact = double.index(f64::from(wavelength));
            let error = (f64::from(single.index(f32::from(wavelength))) - exact).abs() / exact;
            assert!(error <= bound * epsilon, "{} at {wavelength} nm: {} EPSILON", table.name, error / epsilon);
        }
    }
}

#[test]
fn held_outside_the_range() {
    let glass = Glass::<f64>::from_table(&glasses::SF11);
    assert_eq!(glass.valid(), [390.0, 2500.0]);
    assert_eq!([glass.index(100.0), glass.index(-5.0), glass.index(f64::NAN)], [glass.index(390.0); 3]);
    assert_eq!(glass.index(1e300), glass.index(2500.0));
    assert_eq!([389.9, 2500.1, f64::NAN].map(|w| glass.derivative(w)), [0.0; 3]);
    assert!(glass.derivative(390.0) < 0.0);
}

#[test]
fn built_in_materials_pass_their_constructors() {
    for table in &glasses::ALL {
        match Glass::<f32>::from_table(table) {
            Glass::Sellmeier(glass) => {
                let c = table.coefficients.single;
                let terms = core::array::from_fn(|i| [c[2 * i], c[2 * i + 1]]);
                assert_eq!(Sellmeier::new(terms, glass.valid()), Ok(glass), "{}", table.name);
            }
            Glass::Cauchy(glass) => {
                let c = table.coefficients.single;
                assert_eq!(Cauchy::new(c[0], c[1], glass.valid()), Ok(glass), "{}", table.name);
            }
        }
    }
    assert!(find_glass("n bk7").is_some() && find_glass("fused_silica").is_some() && find_glass("BK8").is_none());
}

#[test]
fn bad_coefficients_are_refused() {
    let none = [[0.0; 2]; 4];
    let with = |term: [f64; 2]| [term, [0.0; 2], [0.0; 2], [0.0; 2]];
    let range = [300.0, 1000.0];
    assert_eq!(Sellmeier::new(with([1.0, f64::NAN]), range), Err(DispersionError::Coefficient { index: 1 }));
    assert_eq!(Sellmeier::new(with([1.0, 0.25]), range), Err(DispersionError::Resonance { index: 0 }));
    assert_eq!(Sellmeier::new(with([-2.0, 0.01]), range), Err(DispersionError::Index));
    for bad in [[0.0, 1.0], [2.0, 1.0], [1.0, f64::INFINITY], [f64::NAN, 1.0], [1.0, 1.0]] {
        assert_eq!(Sellmeier::new(none, bad), Err(DispersionError::Range), "{bad:?}");
        assert_eq!(Cauchy::new(1.5, 0.0, bad), Err(DispersionError::Range), "{bad:?}");
    }
    assert_eq!(Cauchy::new(1.5, f64::INFINITY, range), Err(DispersionError::Coefficient { index: 1 }));
    assert_eq!(Cauchy::new(1.0, -0.2, range), Err(DispersionError::Index));
    let vacuum = Sellmeier::new(none, range).unwrap();
    assert_eq!([LINE_C, LINE_D, LINE_F].map(|line| vacuum.index(line)), [1.0; 3]);
}
