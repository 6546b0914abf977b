//! Tables: cut, interpolated, resampled.

use leafbrdf_prospect::sensor::{Response, weighted, weights};
use leafbrdf_prospect::table::{self, Table5B, TableD, TablePro, View, Wavelengths};
use leafbrdf_prospect::{Error, LeafParams, Prospect, Version};

static DEVICE: TableD<f32, 121> = TableD::<f32, 121>::cut::<400, 5>();

fn leaf() -> LeafParams<f64> {
    LeafParams { cab: 40.0, car: 8.0, cw: 0.012, cm: 0.009, ..LeafParams::with_n_struct(1.5) }
}

fn spectrum(view: View<'_, f64>) -> Vec<f64> {
    let (mut r, mut t) = (vec![0.0; view.len()], vec![0.0; view.len()]);
    Prospect::new(view).spectrum(&leaf(), &mut r, &mut t).expect("a possible leaf");
    r
}

/// What a handheld spectrometer needs, 400–1000 nm at 5 nm in single precision: under 5 KB was asked for.
#[test]
fn a_device_table_is_smaller_than_five_kilobytes() {
    assert!(size_of_val(&DEVICE) <= 4400, "{} bytes", size_of_val(&DEVICE));
}

#[test]
fn a_cut_table_holds_the_rows_it_was_cut_from() {
    static VERSION_5B: Table5B<f64, 3> = Table5B::<f64, 3>::cut::<401, 1000>();
    static PRO: TablePro<f64, 2> = TablePro::<f64, 2>::cut::<1700, 800>();
    let device = DEVICE.view();
    let full = table::full(Version::D);
    for (band, nm) in device.wavelengths().iter().enumerate() {
        let row = nm as usize - 400;
        assert_eq!(nm, 400.0 + 5.0 * band as f32);
        assert_eq!(device.t_alpha()[band], full.t_alpha()[row] as f32);
        for (cut, whole) in device.coefficients().zip(full.coefficients()) {
            assert_eq!(cut[band], whole[row] as f32);
        }
    }
    let whole = spectrum(table::full(Version::P5B));
    assert_eq!(spectrum(VERSION_5B.view()), [whole[1], whole[1001], whole[2001]]);
    assert_eq!(PRO.view().coefficients().count(), 8);
    assert_eq!(PRO.view().wavelengths().last(), Some(2500.0));
}

#[test]
fn a_run_of_bands_is_that_part_of_the_spectrum() {
    let full = table::full(Version::D);
    let whole = spectrum(full);
    for range in [0..2101, 5..6, 100..164, 2037..2101] {
        let part = full.bands(range.clone()).expect("bands of the table");
        assert_eq!(spectrum(part), whole[range.clone()]);
        assert_eq!(part.wavelengths().get(0), Some(400.0 + range.start as f64));
    }
    assert!(full.bands(2000..2102).is_none());
}

#[test]
fn interpolation_is_exact_at_the_table_and_smooth_between() {
    let full = table::full(Version::D);
    let whole = spectrum(full);
    let wavelengths: Vec<f64> = (0..4201).map(|i| 400.0 + 0.5 * f64::from(i)).collect();
    let mut room = vec![0.0; 9 * wavelengths.len()];
    let fine = spectrum(full.at_wavelengths(&wavelengths, &mut room).expect("inside the table"));
    for (band, value) in whole.iter().enumerate() {
        assert_eq!(fine[2 * band], *value);
    }
    let mut worst: f64 = 0.0;
    // Between two bands: against the mean of the neighbours' spectra, which differs by the curvature of R(K): 2.0e-4 at
    // the red edge.
    for band in 0..2100 {
        let mean = 0.5 * (whole[band] + whole[band + 1]);
        worst = worst.max((fine[2 * band + 1] - mean).abs());
    }
    assert!(worst < 3e-4, "{worst}");
}

/// t_av is interpolated, not recomputed from an interpolated n: the difference must drown in n's published fourth decimal.
#[test]
fn interpolating_the_interface_is_as_good_as_computing_it() {
    let full = table::full(Version::D);
    for band in 0..2100 {
        let (below, above) = (full.refractive_index(band).unwrap(), full.refractive_index(band + 1).unwrap());
        for (cone, column) in [(40.0, full.t_alpha()), (90.0, full.t_90())] {
            let computed = leafbrdf_prospect::interface::t_av(cone, 0.5 * (below + above));
            assert!((0.5 * (column[band] + column[band + 1]) - computed).abs() < 1e-6);
        }
    }
}

#[test]
fn wavelengths_outside_or_out_of_order_are_refused() {
    let full = table::full(Version::D);
    let mut room = vec![0.0; 18];
    let error = full.at_wavelengths(&[399.9, 500.0], &mut room).unwrap_err();
    assert_eq!(error.to_string(), "wavelength 399.9 nm is outside the table, 400 to 2500 nm");
    assert!(matches!(full.at_wavelengths(&[500.0, f64::NAN], &mut room), Err(Error::Wavelength { .. })));
    assert_eq!(full.at_wavelengths(&[500.0, 500.0], &mut room).unwrap_err(), Error::WavelengthOrder { position: 1 });
    assert!(matches!(full.at_wavelengths(&[500.0], &mut room), Err(Error::Length { expected: 9, .. })));
    assert!(View::<f64>::from_columns(Version::D, Wavelengths::Listed(&[]), &[]).is_err());
}

fn seen(response: &Response<'_, f64>, spectrum: &[f64]) -> f64 {
    let mut room = vec![0.0; table::BANDS];
    weights(response, table::full(Version::D).wavelengths(), &mut room).expect("inside the table");
    assert!((room.iter().sum::<f64>() - 1.0).abs() < 1e-13 && room.iter().all(|&weight| weight >= 0.0));
    weighted(spectrum, &room).expect("one weight a band")
}

/// Normal moments: FWHM = 2 √(2 ln 2) s. The cut at 2.5 FWHM (5.9 s), where 3e-8 is left, takes 1e-7 of the variance.
#[test]
fn a_gaussian_band_has_its_mean_and_its_width() {
    let wavelengths: Vec<f64> = table::full(Version::D).wavelengths().iter().collect();
    for (centre, fwhm) in [(705.0, 15.0), (550.3, 3.0), (1610.2, 94.0), (842.0, 115.0)] {
        let gaussian = Response::Gaussian { centre, fwhm };
        assert!((seen(&gaussian, &wavelengths) - centre).abs() < 1e-7 * fwhm);
        let squares: Vec<f64> = wavelengths.iter().map(|w| (w - centre).powi(2)).collect();
        let variance = fwhm * fwhm / (8.0 * std::f64::consts::LN_2);
        // straight lines between 1 nm steps add up to 1/6 nm² to a parabola
        let excess = seen(&gaussian, &squares) - variance;
        assert!((-2e-6 * variance..1.0 / 6.0 + 1e-6).contains(&excess), "{fwhm} nm: {excess}");
    }
}

#[test]
fn a_band_much_narrower_than_the_step_interpolates() {
    let spectrum = spectrum(table::full(Version::D));
    let narrow = seen(&Response::Gaussian { centre: 710.25, fwhm: 0.01 }, &spectrum);
    assert!((narrow - (0.75 * spectrum[310] + 0.25 * spectrum[311])).abs() < 1e-12);
}

#[test]
fn a_box_given_as_a_table_averages() {
    let spectrum = spectrum(table::full(Version::D));
    let boxed = Response::Table { wavelengths: &[700.0, 710.0], values: &[3.0, 3.0] };
    let mean = (0.5 * (spectrum[300] + spectrum[310]) + spectrum[301..310].iter().sum::<f64>()) / 10.0;
    assert!((seen(&boxed, &spectrum) - mean).abs() < 1e-13);
}

#[test]
fn impossible_responses_are_refused() {
    let wavelengths = table::full(Version::D).wavelengths();
    let mut room = vec![0.0; table::BANDS];
    for (response, expected) in [
        (Response::Gaussian { centre: 700.0, fwhm: 0.0 }, Error::Response),
        (Response::Gaussian { centre: 700.0, fwhm: f64::NAN }, Error::Response),
        (
            Response::Gaussian { centre: 405.0, fwhm: 10.0 },
            Error::Wavelength { value: 380.0, first: 400.0, last: 2500.0 },
        ),
        (Response::Table { wavelengths: &[700.0, 710.0], values: &[0.0, 0.0] }, Error::Response),
        (Response::Table { wavelengths: &[700.0, 710.0], values: &[1.0, -1.0] }, Error::Response),
        (Response::Table { wavelengths: &[700.0, 690.0], values: &[1.0, 1.0] }, Error::WavelengthOrder { position: 1 }),
        (
            Response::Table { wavelengths: &[700.0], values: &[1.0, 1.0] },
            Error::Length { slice: "response", expected: 1, found: 2 },
        ),
    ] {
        assert_eq!(weights(&response, wavelengths, &mut room), Err(expected));
    }
}

/// A spectrum that is 1 at 710 nm only, straight to 0 at its neighbours, under a Gaussian of 2 nm there:
/// 2 ∫₀¹ g(x) (1 − x) dx / ∫ g dx = 0.42214 (20-digit quadrature). Steps of 1/8 nm leave an error of h² g″/12, 1e-3.
#[test]
fn a_peak_as_narrow_as_the_step_is_integrated_and_not_sampled() {
    let mut spike = vec![0.0; table::BANDS];
    spike[310] = 1.0;
    let narrow = seen(&Response::Gaussian { centre: 710.0, fwhm: 2.0 }, &spike);
    assert!((narrow - 0.422_137_7).abs() < 2e-3, "{narrow}");
}
