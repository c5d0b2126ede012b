//! The built-in spectra against the tables they come from, and against other ways to the same numbers.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail by panicking")]

use spectral_core::spectrum::{
    Constant, Daylight, Line, Lines, Outside, PiecewiseLinear, Planck, RadiationConstant, Rounding, Scaled, Segment,
    Spectrum, SpectrumError, Uniform,
};
use spectral_core::tables::{self, UniformTable, daylight, fluorescent, illuminants, lines, observers};
use spectral_core::{Real, Samples};
use spectral_tests::tables::Csv;

/// The lamps, reflectances and action spectra: everything that must not be negative.
fn non_negative_tables() -> Vec<&'static UniformTable> {
    use tables::{action, alpha_opic, babelcolor, colorchecker, cornell, test_colours};
    let others = [&babelcolor::ALL[..], &colorchecker::ALL, &cornell::ALL, &test_colours::ALL, &alpha_opic::ALL];
    tables::lights().chain(others.into_iter().flatten()).chain(&action::ALL).collect()
}

fn assert_valid<R: Real>(table: &UniformTable, sign: bool) {
    let from_table = table.spectrum::<R>(Outside::Zero);
    let checked = Uniform::new(from_table.first(), from_table.step(), from_table.values(), Outside::Zero);
    let spectrum = checked.unwrap_or_else(|error| panic!("{}: {error}", table.name));
    assert!(!sign || spectrum.check_non_negative().is_ok(), "{} has a negative sample", table.name);
    assert_eq!(table.samples.single.len(), table.samples.double.len());
}

#[test]
fn tables_are_valid_spectra() {
    for table in non_negative_tables() {
        assert_valid::<f32>(table, true);
        assert_valid::<f64>(table, true);
    }
    for table in &daylight::ALL {
        assert_valid::<f32>(table, false);
        assert_valid::<f64>(table, false);
    }
}

fn assert_valid_metal<R: Real>(metal: &tables::MetalTable) {
    for spectrum in [metal.n::<R>(), metal.k::<R>()] {
        let checked = PiecewiseLinear::new(spectrum.wavelengths(), spectrum.values(), Outside::Hold);
        let spectrum = checked.unwrap_or_else(|error| panic!("{}: {error}", metal.name));
        assert_eq!(spectrum.check_non_negative(), Ok(()), "{}", metal.name);
    }
}

#[test]
fn metals_are_valid_spectra() {
    for metal in &tables::metals::ALL {
        assert_valid_metal::<f32>(metal);
        assert_valid_metal::<f64>(metal);
    }
    // Johnson and Christy print 0.13 and 4.103 for gold at 704.5 nm.
    let gold = tables::find_metal("au-johnson").unwrap();
    assert_eq!((gold.n::<f64>().value(704.5), gold.k::<f64>().value(704.5)), (0.13, 4.103));
    assert_eq!(gold.n::<f64>().value(2000.0), 0.17, "held beyond 892 nm");
}

/// `published`: CIE 15:2004, tables T.1, T.6 to T.8, CIE 15:2018; `independent`: the copies in luxpy 1.12.5.
#[test]
fn spot_values_by_name() {
    let at =
        |name: &str, wavelength| tables::find_light(name).unwrap().spectrum::<f64>(Outside::Zero).value(wavelength);
    assert_eq!(
        [at("FL2", 380.0), at("fl2", 435.0), at("FL2", 440.0), at("FL2", 545.0), at("FL2", 610.0), at("FL2", 780.0)],
        [1.18, 34.98, 11.81, 24.88, 13.8, 0.27]
    );
    assert_eq!([at("A", 560.0), at("D65", 560.0), at("D50", 560.0)], [100.0; 3]);
    assert_eq!(
        [at("HP1", 590.0), at("HP2", 590.0), at("FL3.15", 380.0), at("led_v1", 410.0)],
        [142.55, 0.39, 300.0, 16.51]
    );
    assert_eq!(at("LPS", 590.0), 1.0);
    assert_eq!([at("cornell lamp", 450.0), at("cornell-lamp", 700.5)], [4.0, 0.0]);
    assert!(tables::find_light("FL13").is_none());
    assert_eq!(tables::find_lines("Sodium-D").unwrap().name, "sodium-D");
}

#[test]
fn names_are_unique() {
    let mut names: Vec<_> = tables::lights().map(|table| table.name.to_ascii_lowercase()).collect();
    let count = names.len();
    names.sort();
    names.dedup();
    assert_eq!((names.len(), count), (count, 6 + 27 + 5 + 9 + 9 + 1));
}

#[test]
fn samples_are_the_decimals_rounded_once() {
    let csv = Csv::read("cie_1931_2deg_cmf_1nm.csv").unwrap();
    for (column, samples) in ["xbar", "ybar", "zbar"].iter().zip(&observers::CIE_1931_2.columns) {
        let cells = csv.column(column).unwrap();
        let single: Vec<f32> = cells.iter().map(|cell| cell.parse().unwrap()).collect();
        let double: Vec<f64> = cells.iter().map(|cell| cell.parse().unwrap()).collect();
        assert_eq!((samples.single, samples.double), (&single[..], &double[..]));
    }
}

/// `published`: CIE 1931 2° at 555 nm and 600 nm; ∫ȳ over 360–830 nm.
#[test]
fn observer_triplets() {
    let observer = &observers::CIE_1931_2;
    assert_eq!(observer.cmf::<f64>(555 - 360), [0.5120501, 1.0, 0.005749999]);
    assert_eq!(observer.cmf::<f32>(600 - 360), [1.0622, 0.631, 0.0008]);
    assert_eq!(observer.cmf::<f64>(471), [0.0; 3]);
    let sum: f64 = (0..471).map(|index| observer.cmf::<f64>(index)[1]).sum();
    assert!((sum - 106.8569).abs() <= 5e-5, "{sum}");
}

/// Half a unit of the last digit in which CIE 15 prints the D illuminants, and the rounding of the comparison.
const HALF_PRINTED: f64 = 0.0005 + 1e-9;

/// `published`: CIE 15:2004 table T.1, from the same formula by CIE's own calculation.
#[test]
fn daylight_gives_the_d_illuminants() {
    let tables = [(5000.0, illuminants::D50), (5500.0, illuminants::D55), (7500.0, illuminants::D75)];
    for (nominal, table) in tables {
        let daylight = Daylight::nominal(nominal, Rounding::ThreeDecimals).unwrap();
        for (wavelength, &published) in (300_u16..).step_by(5).zip(table.samples.double) {
            let error = (daylight.value(f64::from(wavelength)) - published).abs();
            assert!(error <= HALF_PRINTED, "{} at {wavelength} nm: {error}", table.name);
        }
    }
}

/// `published`: CIE 15:2004 table T.1. D65 is standardised at 10 nm and the values between are means of their
/// neighbours, while the basis at 5 nm is itself rounded.
#[test]
fn daylight_gives_d65() {
    let daylight = Daylight::nominal(6500.0, Rounding::ThreeDecimals).unwrap();
    assert_eq!(daylight.factors(), [-0.295, -0.689]);
    for (wavelength, &published) in (300_u16..).step_by(5).zip(illuminants::D65.samples.double) {
        let at = |offset: f64| daylight.value(f64::from(wavelength) + offset);
        let expected = if wavelength % 10 == 0 { at(0.0) } else { 0.5 * (at(-5.0) + at(5.0)) };
        // The means are rounded once more: to four decimals, or to three from 100 on.
        let again = if wavelength % 10 == 0 {
            0.0
        } else if published < 100.0 {
            0.00005
        } else {
            0.0005
        };
        let error = (expected - published).abs();
        assert!(error <= HALF_PRINTED + again, "{wavelength} nm: {error}");
    }
}

/// Temperature, chromaticity, and powers at 400, 455, 600 and 725 nm with rounded factors and with exact ones.
type Row = (f64, [f64; 2], [f64; 4], [f64; 4]);

/// `independent`: colour-science 0.4.7, CCT_to_xy_CIE_D and sd_CIE_illuminant_D_series, the latter rounded and not.
#[test]
fn daylight_agrees_with_colour_science() {
    let rows: [Row; 5] = [
        (
            4000.0,
            [0.382_343_62, 0.383_766_26],
            [26.373_3, 65.946_8, 108.275_4, 104.842_6],
            [26.391_499_374_4, 65.962_149_480_5, 108.271_447_312_8, 104.834_449_748_7],
        ),
        (
            6504.0,
            [0.312_714_06, 0.329_119_10],
            [82.798_3, 117.444_15, 90.000_4, 65.733_7],
            [82.778_133_082_1, 117.428_658_076_8, 90.002_443_187_6, 65.737_359_147_1],
        ),
        (
            7000.0,
            [0.305_357_43, 0.321_646_35],
            [92.594_7, 125.309_95, 88.483_6, 62.750_9],
            [92.613_944_968_6, 125.325_202_463_4, 88.480_928_115_1, 62.745_748_059_0],
        ),
        (
            7001.0,
            [0.305_343_34, 0.321_631_72],
            [92.638_1, 125.344_2, 88.477_8, 62.739_8],
            [92.633_813_796_3, 125.341_010_537_1, 88.478_075_380_5, 62.740_212_466_0],
        ),
        (
            25000.0,
            [0.249_853_67, 0.254_799_46],
            [219.143_3, 220.398, 78.935_4, 47.313_8],
            [219.137_998_024_3, 220.393_669_832_4, 78.936_333_468_9, 47.315_673_090_5],
        ),
    ];
    for (temperature, chromaticity, rounded, exact) in rows {
        for (rounding, expected) in [(Rounding::ThreeDecimals, rounded), (Rounding::None, exact)] {
            let daylight = Daylight::new(temperature, rounding).unwrap();
            for (ours, theirs) in daylight.chromaticity().into_iter().zip(chromaticity) {
                assert!((ours - theirs).abs() <= 5e-9 + 1e-12);
            }
            for (wavelength, expected) in [400.0, 455.0, 600.0, 725.0].into_iter().zip(expected) {
                let error = (daylight.value(wavelength) - expected).abs();
                assert!(error <= 1e-9, "{temperature} K, {wavelength} nm: {error}");
            }
        }
    }
}

#[test]
fn daylight_at_its_limits() {
    for refused in [3999.9, 25000.1, f64::NAN, f64::INFINITY, -6500.0] {
        assert_eq!(Daylight::new(refused, Rounding::None).unwrap_err(), SpectrumError::ColourTemperature);
    }
    for temperature in (4000..=25000).step_by(100) {
        let daylight = Daylight::new(f64::from(temperature), Rounding::None).unwrap();
        assert!((300..=830).all(|wavelength| daylight.value(f64::from(wavelength)) >= 0.0), "{temperature} K");
        assert_eq!(daylight.value(560.0), 100.0);
    }
    let (double, single) =
        (Daylight::<f64>::nominal(6500.0, Rounding::default()), Daylight::<f32>::nominal(6500.0, Rounding::default()));
    let (double, single) = (double.unwrap(), single.unwrap());
    for wavelength in 295_u16..=835 {
        let (double, single) = (double.value(f64::from(wavelength)), single.value(f32::from(wavelength)));
        assert!((double - f64::from(single)).abs() <= 4.0 * f64::from(f32::EPSILON) * double, "{wavelength} nm");
    }
}

/// `published`: CIE 15:2004 table T.1, six significant digits; A is Planck's law for 2848 K with c₂ = 1.4350·10⁻² m K.
#[test]
fn planck_gives_illuminant_a() {
    let planck = Planck::new(2848.0, RadiationConstant::Cie1931).unwrap();
    let normalised = Scaled::new(planck, 100.0 / planck.value(560.0)).unwrap();
    for (wavelength, &published) in (300_u16..).step_by(5).zip(illuminants::A.samples.double) {
        let unit = 10_f64.powf(published.log10().floor() - 5.0);
        let error = (normalised.value(f64::from(wavelength)) - published).abs();
        assert!(error <= 0.5 * unit * (1.0 + 1e-6), "{wavelength} nm: {error}");
    }
}

/// `independent`: colour-science 0.4.7, planck_law with c₂ = 1.4388·10⁻² m K and its c₁ of seven digits.
#[test]
fn planck_agrees_with_colour_science() {
    let rows: [(f64, [f64; 3]); 4] = [
        (1000.0, [0.541_064_210_519_644, 15_021.770_255_203_734, 4_021_531.687_882_564_5]),
        (2856.0, [26_265_814_377.032_867, 267_969_332_951.806_9, 647_353_209_705.490_2]),
        (6504.0, [44_672_952_049_970.53, 42_445_113_559_576.57, 25_703_433_058_224.36]),
        (25000.0, [4_237_556_612_753_874.5, 1_205_042_660_877_998.2, 377_972_326_089_459.0]),
    ];
    // Its first constant, 3.741771·10⁻¹⁶ W m², is below ours.
    let ratio = 3.741_771_852_192_757e-16 / 3.741_771e-16;
    for (temperature, radiances) in rows {
        let planck = Planck::new(temperature, RadiationConstant::Its1990).unwrap();
        for (wavelength, per_metre) in [380.0, 560.0, 780.0].into_iter().zip(radiances) {
            let expected = per_metre * 1e-9 * ratio;
            let error = (planck.value(wavelength) / expected - 1.0).abs();
            assert!(error <= 1e-13, "{temperature} K, {wavelength} nm: {error}");
        }
    }
}

/// Wien's displacement law, b = 2.897 771 955·10⁻³ m K, and a slope that would show a shift of a thousandth.
#[test]
fn planck_peaks_where_wien_says() {
    for temperature in [300.0, 2856.0, 5000.0, 6504.0, 25000.0] {
        let planck = Planck::new(temperature, RadiationConstant::Si2019).unwrap();
        let slope = |wavelength: f64| {
            let h = 1e-4;
            let radiance = |factor: f64| planck.radiance(wavelength * factor).ln();
            (radiance(1.0 + h) - radiance(1.0 - h)) / (2.0 * h)
        };
        let peak = 2.897_771_955e6 / temperature;
        assert!(slope(peak).abs() <= 1e-6, "{temperature} K: {}", slope(peak));
        assert!(slope(peak * 1.001) < -0.004 && slope(peak * 0.999) > 0.004);
    }
}

/// Stefan and Boltzmann: ∫L dλ = σ T⁴ / π, less the share above 1 mm, (15 / π⁴) x³ / 3 with x = c₂ / (λ T).
#[test]
fn planck_integrates_to_stefan_boltzmann() {
    for temperature in [1000.0_f64, 2856.0, 6504.0] {
        let planck = Planck::new(temperature, RadiationConstant::Si2019).unwrap();
        let (mut sum, mut wavelength) = (0.0, -1.0_f64);
        loop {
            let Segment { end, first, last } = planck.segment(wavelength);
            if end.is_infinite() {
                break;
            }
            sum += (end - wavelength) * 0.5 * (first + last);
            wavelength = end;
        }
        let x = 1.438_776_877e-2 / (1e-3 * temperature);
        let tail = 15.0 / core::f64::consts::PI.powi(4) * (x.powi(3) / 3.0 - x.powi(4) / 8.0);
        let expected = 5.670_374_419e-8 * temperature.powi(4) / core::f64::consts::PI * (1.0 - tail);
        // Four times the last digit of c₂, and the last of σ.
        assert!((sum / expected - 1.0).abs() <= 2e-9, "{temperature} K: {}", sum / expected - 1.0);
    }
}

/// The interpolation errors that the documentation of `Planck` states: not above, and not idly high.
#[test]
fn planck_interpolation_error_is_as_documented() {
    let stated: [(f64, f64); 7] = [
        (1000.0, 8.7e-4),
        (2000.0, 1.4e-4),
        (2856.0, 4.1e-5),
        (5000.0, 3.7e-6),
        (6504.0, 5.1e-6),
        (10000.0, 2.1e-6),
        (25000.0, 9.8e-6),
    ];
    for (temperature, bound) in stated {
        let planck = Planck::new(temperature, RadiationConstant::Si2019).unwrap();
        let error = |wavelength: f64| (planck.value(wavelength) / planck.radiance(wavelength) - 1.0).abs();
        let worst = (0..400 * 40).map(|i| error(380.0 + f64::from(i) / 40.0)).fold(0.0, f64::max);
        assert!(worst <= bound && worst >= 0.9 * bound, "{temperature} K: {worst}");
    }
}

#[test]
fn planck_in_single_precision() {
    for temperature in [1000.0_f32, 2856.0, 6504.0, 25000.0] {
        let single = Planck::new(temperature, RadiationConstant::Si2019).unwrap();
        let double = Planck::new(f64::from(temperature), RadiationConstant::Si2019).unwrap();
        for wavelength in 380_u16..=780 {
            let exact = double.radiance(f64::from(wavelength));
            let x = 1.438_776_877e7 / (f64::from(wavelength) * f64::from(temperature));
            let error = (f64::from(single.radiance(f32::from(wavelength))) / exact - 1.0).abs();
            assert!(error <= (6.0 + x) * f64::from(f32::EPSILON), "{temperature} K, {wavelength} nm: {error}");
        }
    }
    for refused in [0.0_f32, -1.0, f32::NAN, 1.1e9] {
        assert_eq!(Planck::new(refused, RadiationConstant::Si2019), Err(SpectrumError::Temperature));
    }
}

#[test]
fn radiation_constants() {
    use RadiationConstant::{Cie1931, Ipts1948, Its1990, Si2019};
    let values = [Cie1931, Ipts1948, Its1990, Si2019].map(RadiationConstant::metre_kelvin);
    // The last one is the exact h c / k, cut after ten digits as CODATA prints it.
    let exact = 6.626_070_15e-34 * 299_792_458.0 / 1.380_649e-23;
    assert_eq!(values[..3], [1.4350e-2, 1.4380e-2, 1.4388e-2]);
    assert!(values[3] <= exact && exact - values[3] <= 1e-11);
    assert_eq!(RadiationConstant::default(), Si2019);
}

/// The integral of a spectrum by its own pieces.
fn integral<R: Real>(spectrum: &impl Spectrum<R>, from: R, to: R) -> f64 {
    let (mut sum, mut wavelength) = (0.0, from);
    while wavelength < to {
        let piece = spectrum.segment(wavelength);
        if piece.end > to {
            break;
        }
        sum += (piece.end.to_f64() - wavelength.to_f64()) * 0.5 * (piece.first.to_f64() + piece.last.to_f64());
        wavelength = piece.end;
    }
    sum
}

#[test]
fn a_line_integrates_to_its_power() {
    for width in [0.01_f64, 0.5, 2.0, 100.0] {
        let line = Line::new(588.995, width, 3.25).unwrap();
        assert!((integral(&line, 0.0, 1000.0) / 3.25 - 1.0).abs() <= 4.0 * f64::EPSILON, "{width} nm");
        assert!(line.value(588.995) == line.peak());
    }
    for width in [0.01_f32, 0.5, 2.0, 100.0] {
        let line = Line::new(588.995, width, 3.25).unwrap();
        assert!((integral(&line, 0.0, 1000.0) / 3.25 - 1.0).abs() <= 4.0 * f64::from(f32::EPSILON), "{width} nm");
    }
}

#[test]
fn lines_overlap_and_add() {
    let sodium = lines::SODIUM_D.spectrum(2.0_f64).unwrap();
    assert!((integral(&sodium, 0.0, 1000.0) - 1.0).abs() <= 8.0 * f64::EPSILON);
    let parts: Vec<Line<f64>> = sodium.iter().collect();
    let (d2, d1) = (parts[0], parts[1]);
    assert_eq!((d2.centre(), d1.centre()), (588.9950, 589.5924));
    for i in 0..400 {
        let wavelength = 587.0 + f64::from(i) * 0.01;
        let error = (sodium.value(wavelength) - d2.value(wavelength) - d1.value(wavelength)).abs();
        assert!(error <= 2.0 * f64::EPSILON, "{wavelength} nm");
    }
    let mercury = lines::MERCURY.spectrum(1.0_f32).unwrap();
    let total: f64 = lines::MERCURY.powers.double.iter().sum();
    assert!((integral(&mercury, 0.0, 1000.0) / total - 1.0).abs() <= 8.0 * f64::from(f32::EPSILON));
}

/// The powers of the mercury lines are those of the lamp in the table at 5 nm, as their file says.
#[test]
fn mercury_powers_follow_from_the_lamp() {
    let (wavelengths, lamp) = Csv::read("narrowband_lamps_nist_5nm.csv").unwrap().numbers("Mercury").unwrap();
    let group = |from: f64, to: f64| {
        let at = |wavelength: f64| lamp[wavelengths.iter().position(|&w| w == wavelength).unwrap()];
        let floor = 0.5 * (at(from - 5.0) + at(to + 5.0));
        let inside = wavelengths.iter().zip(&lamp).filter(|&(&w, _)| w >= from && w <= to);
        inside.map(|(_, power)| power - floor).sum::<f64>()
    };
    let green = group(540.0, 550.0);
    let yellow = group(570.0, 585.0) / 2.0;
    let expected = [group(400.0, 410.0), group(430.0, 440.0), green, yellow, yellow].map(|power| power / green);
    for (power, expected) in lines::MERCURY.powers.double.iter().zip(expected) {
        assert!((power - expected).abs() <= 0.00005, "{power} for {expected}");
    }
}

#[test]
fn outside_and_at_the_ends() {
    let (wavelengths, values) = ([400.0, 500.0, 700.0], [1.0, 3.0, 2.0]);
    let zero = PiecewiseLinear::new(&wavelengths, &values, Outside::Zero).unwrap();
    let hold = PiecewiseLinear::new(&wavelengths, &values, Outside::Hold).unwrap();
    assert_eq!([399.0, 400.0, 450.0, 700.0, 701.0].map(|w| zero.value(w)), [0.0, 1.0, 2.0, 2.0, 0.0]);
    assert_eq!([399.0, 400.0, 450.0, 700.0, 701.0].map(|w| hold.value(w)), [1.0, 1.0, 2.0, 2.0, 2.0]);
    assert_eq!(zero.segment(0.0), Segment { end: 400.0, first: 0.0, last: 0.0 });
    assert_eq!(zero.segment(400.0), Segment { end: 500.0, first: 1.0, last: 3.0 });
    assert_eq!(zero.segment(700.0), Segment { end: f64::INFINITY, first: 0.0, last: 0.0 });
    assert_eq!(hold.segment(700.0), Segment { end: f64::INFINITY, first: 2.0, last: 2.0 });
    let uniform = fluorescent::FL2.spectrum::<f64>(Outside::Zero);
    assert_eq!([379.9, 780.0, 780.1].map(|w| uniform.value(w)), [0.0, 0.27, 0.0]);
    let constant = Constant::new(0.5_f32).unwrap();
    assert_eq!(constant.segment(-1e30), Segment { end: f32::INFINITY, first: 0.5, last: 0.5 });
}

#[test]
fn bad_spectra_are_refused_by_node() {
    use SpectrumError::{LengthMismatch, Negative, Order, Range, Step, TooFewNodes, Value, Wavelength, Width};
    let new = |wavelengths: &[f64], values: &[f64]| PiecewiseLinear::new(wavelengths, values, Outside::Zero).err();
    assert_eq!(new(&[], &[]), Some(TooFewNodes { count: 0 }));
    assert_eq!(new(&[1.0], &[1.0]), Some(TooFewNodes { count: 1 }));
    assert_eq!(new(&[1.0, 2.0], &[1.0]), Some(LengthMismatch { wavelengths: 2, values: 1 }));
    assert_eq!(new(&[1.0, 2.0, f64::NAN], &[1.0; 3]), Some(Wavelength { index: 2 }));
    assert_eq!(new(&[1.0, f64::INFINITY], &[1.0; 2]), Some(Wavelength { index: 1 }));
    assert_eq!(new(&[1.0, 2.0, 2.0, 3.0], &[1.0; 4]), Some(Order { index: 2 }));
    assert_eq!(new(&[1.0, 2.0, 1.5], &[1.0; 3]), Some(Order { index: 2 }));
    assert_eq!(new(&[-1e308, 1e308], &[1.0; 2]), Some(Range));
    assert_eq!(new(&[1.0, 2.0], &[1.0, f64::NAN]), Some(Value { index: 1 }));
    let uniform = |first: f32, step: f32, values: &[f32]| Uniform::new(first, step, values, Outside::Zero).err();
    assert_eq!(uniform(380.0, 5.0, &[1.0]), Some(TooFewNodes { count: 1 }));
    assert_eq!(uniform(f32::NAN, 5.0, &[1.0; 2]), Some(Wavelength { index: 0 }));
    for step in [0.0, -5.0, f32::NAN, f32::INFINITY, 1e-6] {
        assert_eq!(uniform(380.0, step, &[1.0; 2]), Some(Step), "{step}");
    }
    assert_eq!(uniform(380.0, f32::MAX, &[1.0; 3]), Some(Range));
    assert_eq!(uniform(380.0, 5.0, &[1.0, 1.0, f32::INFINITY]), Some(Value { index: 2 }));
    let negative = Uniform::new(380.0, 5.0, &[0.0, -0.0, -1e-30], Outside::Zero).unwrap();
    assert_eq!(negative.check_non_negative(), Err(Negative { index: 2 }));
    let lines = |centres: &[f32], powers: &[f32], width| Lines::new(centres, powers, width).err();
    assert_eq!(lines(&[400.0, 500.0], &[1.0], 1.0), Some(LengthMismatch { wavelengths: 2, values: 1 }));
    assert_eq!(lines(&[400.0, 1e9], &[1.0, 1.0], 1.0), Some(Width { index: 1 }));
    assert_eq!(lines(&[400.0, 500.0], &[1.0, -1.0], 1.0), Some(Negative { index: 1 }));
    assert_eq!(lines(&[400.0, f32::NAN], &[1.0, 1.0], 1.0), Some(Wavelength { index: 1 }));
    assert_eq!(lines(&[400.0], &[f32::NAN], 1.0), Some(Value { index: 0 }));
    for width in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert_eq!(lines(&[400.0], &[1.0], width), Some(Width { index: 0 }), "{width}");
    }
    assert_eq!(Constant::new(f64::NAN), Err(Value { index: 0 }));
    assert!(Scaled::new(Constant::new(1.0).unwrap(), f64::INFINITY).is_err());
    assert_eq!(Order { index: 7 }.to_string(), "wavelength 7 is not above the one before");
}

#[test]
fn samples_pick_the_precision() {
    let samples: Samples = fluorescent::FL1.samples;
    assert_eq!((f32::samples(&samples)[0], f64::samples(&samples)[0]), (1.87_f32, 1.87_f64));
}
