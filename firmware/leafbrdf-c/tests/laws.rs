//! What the C interface promises, called as C calls it.

use std::ffi::CStr;
use std::mem::MaybeUninit;
use std::ptr::null;

use leafbrdf_c::*;
use leafbrdf_core::{Angle, Dielectric, Geometry, Grade, Illumination, Index, Leaf, Surface};

const LAUREL: lb_leaf = lb_leaf { k_lambert: 0.0, n: 1.22, sigma: 0.078, normalization: LB_BOUSQUET_2005 };
const BEECH: lb_leaf = lb_leaf { k_lambert: 0.2, n: 1.56, sigma: 0.29, normalization: LB_BOUSQUET_2005 };

/// The status, and the output where it was written.
fn call<T>(function: impl FnOnce(Option<&mut MaybeUninit<T>>) -> lb_status) -> Result<T, lb_status> {
    let mut out = MaybeUninit::uninit();
    match function(Some(&mut out)) {
        // SAFETY: LB_OK promises that the output is written
        LB_OK => Ok(unsafe { out.assume_init() }),
        status => Err(status),
    }
}

fn degrees(leaf: &lb_leaf, theta_s: f32, theta_v: f32, phi_v: f32) -> Result<f32, lb_status> {
    call(|out| lb_brdf_from_degrees(Some(leaf), theta_s, theta_v, phi_v, out))
}

fn cosines(theta_s: f64, theta_v: f64, phi_v: f64) -> lb_cosines {
    lb_cosines {
        cos_theta_s: theta_s.to_radians().cos() as f32,
        sin_theta_s: theta_s.to_radians().sin() as f32,
        cos_theta_v: theta_v.to_radians().cos() as f32,
        sin_theta_v: theta_v.to_radians().sin() as f32,
        cos_phi_v: phi_v.to_radians().cos() as f32,
    }
}

/// Within 2.5e-5 of itself: the single-precision budget where tan²α/σ² < 80.
#[track_caller]
fn close(single: f32, double: f64) {
    assert!((f64::from(single) / double - 1.0).abs() < 2.5e-5, "{single} {double}");
}

#[test]
fn every_entry_point_gives_the_model_in_double_precision() {
    let double = Leaf::new(0.2, Surface::new(1.56, 0.29).unwrap()).unwrap();
    for (theta_s, theta_v, phi_v) in [(45.0, 0.0, 0.0), (60.0, 60.0, 180.0), (30.0, 65.0, 120.0), (10.0, 20.0, 300.0)] {
        let deg = Angle::from_degrees;
        let geometry = Geometry::from_angles(deg(theta_s), deg(theta_v), deg(phi_v)).unwrap();
        let gradient = double.brdf_with_gradient(&geometry);
        let value = gradient.value;
        close(degrees(&BEECH, theta_s as f32, theta_v as f32, phi_v as f32).unwrap(), value);
        let at = cosines(theta_s, theta_v, phi_v);
        close(call(|out| lb_brdf(Some(&BEECH), Some(&at), out)).unwrap(), value);
        let from_c = call(|out| lb_brdf_gradient(Some(&BEECH), Some(&at), out)).unwrap();
        close(from_c.value, value);
        close(from_c.d_k_lambert, gradient.d_k_lambert);
        close(from_c.d_n, gradient.d_n);
        // a difference: where the lobe neither grows nor shrinks with sigma few digits are left
        assert!((f64::from(from_c.d_sigma) - gradient.d_sigma).abs() < 2.5e-5 * (gradient.d_sigma.abs() + value));
        let from_degrees =
            call(|out| lb_direction_from_degrees(theta_s as f32, theta_v as f32, phi_v as f32, LB_BOUSQUET_2005, out));
        let from_cosines = call(|out| lb_direction_from_cosines(Some(&at), LB_BOUSQUET_2005, out));
        for direction in [from_degrees.unwrap(), from_cosines.unwrap()] {
            close(call(|out| lb_brdf_at(Some(&BEECH), Some(&direction), out)).unwrap(), value);
        }
    }
    for theta in [0.0_f64, 40.0, 85.0] {
        let cos = theta.to_radians().cos();
        let fresnel = Dielectric::new(1.5).unwrap().fresnel(cos);
        close(call(|out| lb_fresnel(1.5, cos as f32, out)).unwrap(), fresnel);
        let source = Illumination::new(Angle::from_degrees(theta)).unwrap();
        let dhrf = call(|out| lb_dhrf(Some(&BEECH), theta as f32, out)).unwrap();
        // E4d's own 2e-5 on both sides is one and the same; the rest is single precision
        close(dhrf, double.surface().dhrf(&source, Grade::E4d));
    }
}

/// The paper measured a peak of 1.1 to 1.2 sr⁻¹ (§3.1); Table 4 gives 1.25 under 2π², and π/2 times that under 4π.
#[test]
fn the_mirror_peak_of_laurel_belongs_to_its_normalization() {
    let printed = degrees(&LAUREL, 60.0, 60.0, 180.0).unwrap();
    assert!((printed - 1.25).abs() < 0.01, "{printed}");
    let derived = lb_leaf { normalization: LB_COOK_TORRANCE, ..LAUREL };
    close(degrees(&derived, 60.0, 60.0, 180.0).unwrap() / printed, std::f64::consts::FRAC_PI_2);
}

#[test]
fn null_is_a_status_and_never_a_crash() {
    let at = cosines(10.0, 20.0, 30.0);
    let mut value = MaybeUninit::uninit();
    assert_eq!(lb_brdf(None, Some(&at), Some(&mut value)), LB_ERR_NULL);
    assert_eq!(lb_brdf(Some(&BEECH), None, Some(&mut value)), LB_ERR_NULL);
    assert_eq!(lb_brdf(Some(&BEECH), Some(&at), None), LB_ERR_NULL);
    assert_eq!(lb_brdf_gradient(Some(&BEECH), Some(&at), None), LB_ERR_NULL);
    assert_eq!(lb_brdf_at(Some(&BEECH), None, Some(&mut value)), LB_ERR_NULL);
    assert_eq!(lb_brdf_from_degrees(None, 0.0, 0.0, 0.0, Some(&mut value)), LB_ERR_NULL);
    assert_eq!(lb_direction_from_degrees(0.0, 0.0, 0.0, 0, None), LB_ERR_NULL);
    assert_eq!(lb_direction_from_cosines(None, 0, None), LB_ERR_NULL);
    assert_eq!(lb_fresnel(1.5, 1.0, None), LB_ERR_NULL);
    assert_eq!(lb_dhrf(Some(&BEECH), 0.0, None), LB_ERR_NULL);
    let mut campaign = Campaign::new(|_| 0.0);
    let directions = campaign.directions();
    let inside = INSIDE;
    let mut band = MaybeUninit::uninit();
    let workspace: *mut lb_workspace = &mut campaign.workspace;
    let (brdf, weight) = (campaign.brdf.as_ptr(), campaign.weight.as_ptr());
    // SAFETY: every pointer is null or points to what the function asks for
    unsafe {
        assert_eq!(lb_fit_band(None, brdf, weight, None, workspace, Some(&mut band)), LB_ERR_NULL);
        assert_eq!(lb_fit_band(Some(&directions), null(), weight, None, workspace, Some(&mut band)), LB_ERR_NULL);
        assert_eq!(lb_fit_band(Some(&directions), brdf, null(), None, workspace, Some(&mut band)), LB_ERR_NULL);
        let nowhere = std::ptr::null_mut();
        assert_eq!(lb_fit_band(Some(&directions), brdf, weight, None, nowhere, Some(&mut band)), LB_ERR_NULL);
        assert_eq!(lb_fit_band(Some(&directions), brdf, weight, None, workspace, None), LB_ERR_NULL);
        let empty = lb_directions { lobe_weight: null(), ..directions };
        assert_eq!(lb_fit_band(Some(&empty), brdf, weight, None, workspace, Some(&mut band)), LB_ERR_NULL);
        let no_bands = std::ptr::null_mut();
        assert_eq!(lb_fit_bands(Some(&directions), brdf, weight, 1, None, workspace, no_bands), LB_ERR_NULL);
        let no_values = std::ptr::null_mut();
        assert_eq!(lb_prospect_slice(Some(&inside), 0, 1, no_values, no_values), LB_ERR_NULL);
        assert_eq!(lb_prospect_slice(None, 0, 1, no_values, no_values), LB_ERR_NULL);
        assert_eq!(lb_fit_cab(Some(&BEECH), null(), brdf, 5, Some(&inside), 0.25, None), LB_ERR_NULL);
    }
}

#[test]
fn what_is_outside_its_domain_is_named_and_nothing_is_written() {
    let outside = |leaf: lb_leaf| degrees(&leaf, 30.0, 40.0, 100.0).unwrap_err();
    for bad in [-0.1, -1e-30, 1.000_000_1, 1.1, f32::NAN, -f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(outside(lb_leaf { k_lambert: bad, ..BEECH }), LB_ERR_K_LAMBERT);
    }
    // both ends are inside, and a zero is a zero
    for good in [0.0, -0.0, 1.0] {
        assert!(degrees(&lb_leaf { k_lambert: good, ..BEECH }, 30.0, 40.0, 100.0).is_ok());
    }
    for bad in [0.9, -1.5, 16_384.002, f32::NAN] {
        assert_eq!(outside(lb_leaf { n: bad, ..BEECH }), LB_ERR_N);
        assert_eq!(call(|out| lb_fresnel(bad, 0.5, out)).unwrap_err(), LB_ERR_N);
    }
    for bad in [0.0, -0.3, 9.3e-10, 1_024.000_1, f32::NAN] {
        assert_eq!(outside(lb_leaf { sigma: bad, ..BEECH }), LB_ERR_SIGMA);
    }
    for (n, sigma) in [(1.0, 1024.0), (16_384.0, 9.313_226e-10)] {
        assert!(degrees(&lb_leaf { n, sigma, ..BEECH }, 30.0, 40.0, 100.0).is_ok());
    }
    assert_eq!(outside(lb_leaf { normalization: 2, ..BEECH }), LB_ERR_NORMALIZATION);
    for bad in [-1.0, 90.0, f32::NAN, f32::INFINITY] {
        assert_eq!(degrees(&BEECH, bad, 10.0, 0.0), Err(LB_ERR_THETA_S));
        assert_eq!(degrees(&BEECH, 10.0, bad, 0.0), Err(LB_ERR_THETA_V));
        assert_eq!(call(|out| lb_dhrf(Some(&BEECH), bad, out)), Err(LB_ERR_THETA_S));
    }
    for bad in [-361.0, 361.0, f32::NAN] {
        assert_eq!(degrees(&BEECH, 10.0, 10.0, bad), Err(LB_ERR_PHI_V));
    }
    for bad in [-0.1, 1.1, f32::NAN] {
        assert_eq!(call(|out| lb_fresnel(1.5, bad, out)), Err(LB_ERR_THETA_A));
    }
    let good = cosines(30.0, 40.0, 100.0);
    let with = |at: lb_cosines| call(|out| lb_brdf(Some(&BEECH), Some(&at), out)).unwrap_err();
    assert_eq!(with(lb_cosines { cos_theta_s: 0.0, ..good }), LB_ERR_THETA_S);
    assert_eq!(with(lb_cosines { cos_theta_v: f32::NAN, ..good }), LB_ERR_THETA_V);
    assert_eq!(with(lb_cosines { cos_phi_v: -1.1, ..good }), LB_ERR_PHI_V);
    // an untouched output keeps what it held
    let mut value = MaybeUninit::new(7.0_f32);
    assert_ne!(lb_brdf_from_degrees(Some(&BEECH), 91.0, 0.0, 0.0, Some(&mut value)), LB_OK);
    // SAFETY: initialised above
    assert_eq!(unsafe { value.assume_init() }, 7.0);
}

#[test]
fn every_status_has_a_text_of_its_own_in_ascii() {
    let text = |status| {
        // SAFETY: a constant string by the function's promise
        unsafe { CStr::from_ptr(lb_status_text(status)) }.to_str().unwrap()
    };
    let known: Vec<&str> = (0..=LB_ERR_WAVELENGTH).map(text).collect();
    for (i, one) in known.iter().enumerate() {
        assert!(one.is_ascii() && *one != text(-1) && !known[..i].contains(one), "{one}");
    }
    assert_eq!(text(LB_ERR_WAVELENGTH + 1), text(-1));
}

#[test]
fn the_version_is_the_packages() {
    let version = lb_version();
    let text = format!("{}.{}.{}", version >> 16, (version >> 8) & 0xFF, version & 0xFF);
    assert_eq!(text, env!("CARGO_PKG_VERSION"));
}

const COUNT: usize = 41;

/// A measurement of 41 directions: nadir, and five rings of eight, lit at 45°.
struct Campaign {
    arrays: [[f32; COUNT]; 3],
    brdf: [f32; COUNT],
    weight: [f32; COUNT],
    workspace: lb_workspace,
}

impl Campaign {
    /// Beech with k_L = 0.2, and what `noise` adds to each value, sr⁻¹.
    fn new(mut noise: impl FnMut(usize) -> f32) -> Self {
        let mut campaign = Campaign {
            arrays: [[0.0; COUNT]; 3],
            brdf: [0.0; COUNT],
            weight: [1.0; COUNT],
            workspace: lb_workspace { memory: [f32::NAN; LB_WORKSPACE_FLOATS] },
        };
        for i in 0..COUNT {
            let (ring, place) = (i.div_ceil(8), (i + 7) % 8);
            let theta_v = [0.0, 15.0, 30.0, 45.0, 55.0, 65.0][ring];
            let direction =
                call(|out| lb_direction_from_degrees(45.0, theta_v, 45.0 * place as f32, LB_BOUSQUET_2005, out))
                    .unwrap();
            campaign.arrays[0][i] = direction.cos_theta_a;
            campaign.arrays[1][i] = direction.tan2_alpha;
            campaign.arrays[2][i] = direction.lobe_weight;
            campaign.brdf[i] = call(|out| lb_brdf_at(Some(&BEECH), Some(&direction), out)).unwrap() + noise(i);
        }
        campaign
    }

    fn directions(&self) -> lb_directions {
        let [cos_theta_a, tan2_alpha, lobe_weight] = &self.arrays;
        lb_directions {
            cos_theta_a: cos_theta_a.as_ptr(),
            tan2_alpha: tan2_alpha.as_ptr(),
            lobe_weight: lobe_weight.as_ptr(),
            count: COUNT as u32,
        }
    }

    fn fit(&mut self, bounds: Option<&lb_bounds>) -> Result<lb_band, lb_status> {
        let directions = self.directions();
        let workspace: *mut lb_workspace = &mut self.workspace;
        // SAFETY: arrays of COUNT values, a workspace of our own
        call(|out| unsafe {
            lb_fit_band(Some(&directions), self.brdf.as_ptr(), self.weight.as_ptr(), bounds, workspace, out)
        })
    }
}

#[test]
fn a_band_without_noise_gives_its_leaf_back() {
    let band = Campaign::new(|_| 0.0).fit(None).unwrap();
    // no noise but rounding: 6e-8 of values up to 0.12 sr⁻¹; what the fit's tolerance of 1e-4 χ² leaves of it is less than 1e-4
    assert!(
        (band.k_lambert - 0.2).abs() < 1e-4 && (band.n - 1.56).abs() < 5e-4 && (band.sigma - 0.29).abs() < 5e-4,
        "{band:?}"
    );
    assert_eq!((band.converged, band.at_bound, band.n_obs, band.status), (1, 0, 41, LB_OK));
}

/// Noise of ±0.002 sr⁻¹, alternating: standard errors of a few per cent, the truth within three of them.
#[test]
fn standard_errors_cover_the_truth() {
    let band = Campaign::new(|i| if (i * 7) % 5 < 2 { 0.002 } else { -0.0013 }).fit(None).unwrap();
    for (value, error, truth) in
        [(band.k_lambert, band.k_lambert_se, 0.2), (band.n, band.n_se, 1.56), (band.sigma, band.sigma_se, 0.29)]
    {
        assert!(error > 0.0 && error < 0.05 && (value - truth).abs() < 3.0 * error, "{value} {error} {truth}");
    }
}

#[test]
fn a_missing_value_does_not_count_and_bounds_hold() {
    let mut campaign = Campaign::new(|_| 0.0);
    campaign.brdf[5] = 9.0;
    campaign.weight[5] = 0.0;
    let band = campaign.fit(None).unwrap();
    assert!((band.n - 1.56).abs() < 5e-4 && band.n_obs == 40, "{band:?}");
    let low = lb_bounds {
        k_lambert_lower: 0.0,
        k_lambert_upper: 1.0,
        n_lower: 1.1,
        n_upper: 1.4,
        sigma_lower: 0.05,
        sigma_upper: 0.8,
    };
    let held = campaign.fit(Some(&low)).unwrap();
    assert_eq!((held.n, held.at_bound), (1.4, LB_AT_UPPER_N));
    assert!(held.n_se.is_nan() && held.sigma_se > 0.0);
    assert_eq!(campaign.fit(Some(&lb_bounds { n_upper: 1.0, ..low })).unwrap_err(), LB_ERR_BOUNDS);
    campaign.brdf[7] = f32::NAN;
    assert_eq!(campaign.fit(None).unwrap_err(), LB_ERR_DATA);
    campaign.brdf[7] = 0.1;
    campaign.weight[7] = -1.0;
    assert_eq!(campaign.fit(None).unwrap_err(), LB_ERR_DATA);
    campaign.weight = [0.0; COUNT];
    assert_eq!(campaign.fit(None).unwrap_err(), LB_ERR_TOO_FEW);
}

#[test]
fn bands_in_one_call_are_the_bands_one_by_one() {
    let mut campaigns = [0.0_f32, 0.001, -0.001].map(|size| Campaign::new(|i| if i % 3 == 0 { size } else { 0.0 }));
    let mut brdf: Vec<f32> = campaigns.iter().flat_map(|campaign| campaign.brdf).collect();
    let one_by_one = campaigns.each_mut().map(|campaign| campaign.fit(None).unwrap());
    let shared = &mut campaigns[0];
    let directions = shared.directions();
    let weight = shared.weight;
    let mut fit = |brdf: &[f32]| {
        let mut bands = [const { MaybeUninit::<lb_band>::uninit() }; 3];
        let workspace: *mut lb_workspace = &mut shared.workspace;
        // SAFETY: three bands of COUNT values, room for three results
        let status = unsafe {
            let bands = bands.as_mut_ptr();
            lb_fit_bands(Some(&directions), brdf.as_ptr(), weight.as_ptr(), 3, None, workspace, bands)
        };
        // SAFETY: every band is written, with a status of its own
        (status, bands.map(|band| unsafe { band.assume_init() }))
    };
    assert_eq!(fit(&brdf), (LB_OK, one_by_one));
    // a band that cannot be fitted says so, and the others are there
    brdf[COUNT + 3] = f32::INFINITY;
    let (status, bands) = fit(&brdf);
    assert_eq!((status, bands[0], bands[2]), (LB_ERR_DATA, one_by_one[0], one_by_one[2]));
    assert_eq!(bands[1].status, LB_ERR_DATA);
}

const INSIDE: lb_interior =
    lb_interior { n_struct: 1.6, cab: 30.0, car: 7.5, cant: 1.0, cbrown: 0.05, cw: 0.01, cm: 0.005 };

fn slice(interior: &lb_interior) -> Result<[[f32; LB_SLICE_BANDS as usize]; 2], lb_status> {
    let mut spectra = [[const { MaybeUninit::uninit() }; LB_SLICE_BANDS as usize]; 2];
    let [reflectance, transmittance] = &mut spectra;
    let (r, t) = (reflectance.as_mut_ptr(), transmittance.as_mut_ptr());
    // SAFETY: room for every band
    match unsafe { lb_prospect_slice(Some(interior), 0, LB_SLICE_BANDS, r, t) } {
        // SAFETY: every band is written
        LB_OK => Ok(spectra.map(|spectrum| spectrum.map(|value| unsafe { value.assume_init() }))),
        status => Err(status),
    }
}

#[test]
fn the_slice_is_prospect_d() {
    use leafbrdf_prospect::{LeafParams, Prospect, Version, table};
    let [reflectance, transmittance] = slice(&INSIDE).unwrap();
    let leaf = LeafParams {
        cab: 30.0,
        car: 7.5,
        cant: 1.0,
        cbrown: 0.05,
        cw: 0.01,
        cm: 0.005,
        ..LeafParams::with_n_struct(1.6_f64)
    };
    let model = Prospect::new(table::full(Version::D));
    for band in 0..LB_SLICE_BANDS as usize {
        let double = model.band(&leaf, 5 * band).unwrap();
        // 1e-6 is what the crate promises of single precision
        assert!((f64::from(reflectance[band]) - double.reflectance).abs() < 1e-6, "{band}");
        assert!((f64::from(transmittance[band]) - double.transmittance).abs() < 1e-6, "{band}");
    }
    assert_eq!(slice(&lb_interior { cm: 50.0, ..INSIDE }).unwrap_err(), LB_ERR_INTERIOR);
    assert_eq!(slice(&lb_interior { n_struct: f32::NAN, ..INSIDE }).unwrap_err(), LB_ERR_INTERIOR);
    let mut value = MaybeUninit::uninit();
    for (first, bands) in [(121, 1), (120, 2), (0, 0), (1, u32::MAX)] {
        // SAFETY: refused before anything is written
        let status = unsafe { lb_prospect_slice(Some(&INSIDE), first, bands, value.as_mut_ptr(), value.as_mut_ptr()) };
        assert_eq!(status, LB_ERR_COUNT);
    }
}

fn cab(wavelengths: &[f32], k_lambert: &[f32], held: &lb_interior) -> Result<lb_cab, lb_status> {
    let (nm, k, bands) = (wavelengths.as_ptr(), k_lambert.as_ptr(), k_lambert.len() as u32);
    // SAFETY: both slices hold `bands` values
    call(|out| unsafe { lb_fit_cab(Some(&BEECH), nm, k, bands, Some(held), 0.25, out) })
}

/// Pale, ordinary and dark leaves of one to three plates, C_car = C_ab/4.
#[test]
fn chlorophyll_comes_back_from_eight_wavelengths() {
    let wavelengths = [550.0, 600.0, 680.0, 700.0, 720.0, 740.0, 780.0, 850.0];
    let specular = call(|out| lb_dhrf(Some(&BEECH), 0.0, out)).unwrap();
    for n_struct in [1.0, 1.3, 1.6, 2.2, 3.0] {
        for cab_true in [0.0, 2.0, 10.0, 30.0, 60.0, 90.0] {
            let inside = lb_interior { n_struct, cab: cab_true, car: cab_true / 4.0, cant: 0.0, ..INSIDE };
            let [reflectance, _] = slice(&inside).unwrap();
            let k_lambert = wavelengths.map(|nm| reflectance[(nm as usize - 400) / 5] - specular);
            let held = lb_interior { car: 0.0, ..inside };
            let found = cab(&wavelengths, &k_lambert, &held).unwrap();
            // reflectances are rounded to 6e-8; dR/dC_ab is about 1e-3 per µg in the green of a dark leaf, and 1e-4 of χ²
            // is where the search stops
            assert!((found.n_struct - n_struct).abs() < 2e-3, "{found:?} {inside:?}");
            assert!((found.cab - cab_true).abs() < 0.02 + 2e-3 * cab_true, "{found:?} {inside:?}");
            assert_eq!((found.converged, found.dhrf_specular), (1, specular));
        }
    }
}

#[test]
fn chlorophyll_of_impossible_data_is_a_status() {
    let (nm, k) = ([550.0, 700.0, 780.0], [0.1, 0.1, 0.4]);
    assert!(cab(&nm, &k, &INSIDE).is_ok());
    assert_eq!(cab(&nm[..2], &k[..2], &INSIDE).unwrap_err(), LB_ERR_TOO_FEW);
    assert_eq!(cab(&[399.0, 700.0, 780.0], &k, &INSIDE).unwrap_err(), LB_ERR_WAVELENGTH);
    assert_eq!(cab(&[f32::NAN, 700.0, 780.0], &k, &INSIDE).unwrap_err(), LB_ERR_WAVELENGTH);
    assert_eq!(cab(&nm, &[0.1, f32::NAN, 0.4], &INSIDE).unwrap_err(), LB_ERR_DATA);
    assert_eq!(cab(&nm, &k, &lb_interior { cw: -0.1, ..INSIDE }).unwrap_err(), LB_ERR_INTERIOR);
}
