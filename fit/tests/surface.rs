//! One surface for the whole leaf: the laws that its fit must keep.

mod common;

use common::Random;
use leafbrdf_core::{Angle, DirectionVectors};
use leafbrdf_fit::surface::{
    DirectionalModel, FacetKind, Knowledge, LeafModel, PARAMETERS, Place, Profile, Spectra, SurfaceData, SurfaceFit,
    SurfaceOptions, Treatment, fit_surface,
};

/// 41 directions at one θ_s, as on a hemispherical goniometer: θ_v 10–60° at seven azimuths, and nadir.
fn hemisphere(theta_s: f64) -> Vec<DirectionVectors<f64>> {
    let mut directions = vec![(0.0, 0.0)];
    for phi in [0.0, 30.0, 60.0, 90.0, 120.0, 150.0, 180.0] {
        directions.extend((1..=6).map(|i| (10.0 * f64::from(i), phi)));
    }
    directions.retain(|&(theta_v, phi)| !(phi == 0.0 && (10.0..=20.0).contains(&theta_v)));
    directions.iter().map(|&(theta_v, phi)| direction(theta_s, theta_v, phi)).collect()
}

/// 12 directions in the plane of incidence.
fn principal_plane(theta_s: f64) -> Vec<DirectionVectors<f64>> {
    let forward = [60.0, 50.0, 40.0, 30.0, 20.0, 10.0].map(|theta_v| (theta_v, 180.0));
    let backward = [10.0, 20.0, 30.0, 40.0, 50.0, 60.0].map(|theta_v| (theta_v, 0.0));
    forward.iter().chain(&backward).map(|&(theta_v, phi)| direction(theta_s, theta_v, phi)).collect()
}

fn direction(theta_s: f64, theta_v: f64, phi_v: f64) -> DirectionVectors<f64> {
    let deg = Angle::from_degrees;
    DirectionVectors::from_angles(deg(theta_s), deg(theta_v), deg(phi_v)).unwrap()
}

/// A green leaf's k_L: dark in the visible but for a hill at 550 nm, a red edge, a bright plateau.
fn k_lambert(band: usize, bands: usize) -> f64 {
    let nm = 480.0 + 400.0 * band as f64 / bands as f64;
    let hill = 0.08 * (-((nm - 550.0) / 35.0).powi(2)).exp();
    0.04 + hill + 0.42 / (1.0 + (-(nm - 715.0) / 12.0).exp())
}

/// BRDF of a leaf with the surface `x` of `options`.
fn leaf(
    directions: &[DirectionVectors<f64>],
    options: &SurfaceOptions,
    x: &[f64; PARAMETERS],
    bands: usize,
) -> Vec<f64> {
    let model = model(directions, options);
    let mut values = Vec::new();
    model.values(x, |value| values.push(value)).unwrap();
    (0..bands).flat_map(|b| values.iter().map(move |[s, p]| k_lambert(b, bands) * s + p).collect::<Vec<_>>()).collect()
}

fn model<'a>(directions: &'a [DirectionVectors<f64>], options: &SurfaceOptions) -> LeafModel<'a, f64> {
    LeafModel { directions, facets: options.facets, diffuse: options.diffuse, normalization: options.normalization }
}

fn fit(directions: &[DirectionVectors<f64>], brdf: &[f64], options: &SurfaceOptions) -> SurfaceFit {
    fit_surface(&SurfaceData { directions, brdf, sd: None }, options).unwrap()
}

fn every_kind() -> Vec<SurfaceOptions> {
    let mut all = Vec::new();
    for kind in 0..8 {
        let mut options = SurfaceOptions::paper();
        if kind & 1 > 0 {
            options = options.with_ggx();
        }
        if kind & 2 > 0 {
            options = options.with_p1();
        }
        if kind & 4 > 0 {
            options = options.with_tilt();
        }
        all.push(options);
    }
    all
}

/// A surface inside the bounds of `options`; held parameters stay where they are held.
fn surface(options: &SurfaceOptions, random: &mut Random) -> [f64; PARAMETERS] {
    let drawn = [
        random.uniform(1.25, 1.8),
        random.uniform(0.08, 0.5),
        random.uniform(0.0, 0.3),
        random.uniform(-0.15, 0.15),
        random.uniform(-4.0, 4.0).to_radians(),
        random.uniform(-4.0, 4.0).to_radians(),
    ];
    core::array::from_fn(|i| match options.parameters[i] {
        Treatment::Held(value) => value,
        Treatment::Free { .. } => drawn[i],
    })
}

#[test]
fn without_noise_every_kind_of_surface_is_found_exactly() {
    // χ² falls to rounding, 1e-16 of the data; the flattest parameter (n of a rough lobe) then has 9 digits
    let mut random = Random(1);
    for options in every_kind() {
        for theta_s in [20.0, 40.0, 55.0] {
            let directions = hemisphere(theta_s);
            let truth = surface(&options, &mut random);
            let fit = fit(&directions, &leaf(&directions, &options, &truth, 60), &options);
            for (found, true_value) in fit.x.iter().zip(truth) {
                assert!((found - true_value).abs() < 1e-8, "{options:?}\n{truth:?}\n{:?} {}", fit.x, fit.rmse);
            }
            assert!(fit.rmse < 1e-9);
            for (b, band) in fit.bands.iter().enumerate() {
                assert!((band.k_lambert.unwrap() - k_lambert(b, 60)).abs() < 1e-8);
            }
        }
    }
}

#[test]
fn the_gradient_of_the_profile_is_the_slope_of_its_cost() {
    let mut random = Random(2);
    for options in every_kind() {
        let directions = hemisphere(40.0);
        let truth = surface(&options, &mut random);
        let mut brdf = leaf(&directions, &options, &truth, 20);
        brdf.iter_mut().for_each(|y| *y += 0.01 * random.normal());
        let holes: Vec<f64> = brdf.iter().enumerate().map(|(i, y)| if i % 17 == 3 { f64::NAN } else { *y }).collect();
        for data in [&brdf, &holes] {
            let spectra = Spectra::new(directions.len(), data, None).unwrap();
            let model = model(&directions, &options);
            let mut places = vec![Place::empty(); directions.len()];
            let x = surface(&options, &mut random);
            spectra.moments(|moments| {
                let mut profile = Profile::new(&model, moments, &mut places).unwrap();
                let at = profile.derivatives(&x).unwrap();
                assert!((at.chi2 / profile.chi2(&x).unwrap() - 1.0).abs() < 1e-13);
                for i in 0..PARAMETERS {
                    if !options.parameters[i].is_free() {
                        continue;
                    }
                    // central difference of step h: error h² f'''/6 ~ 1e-8, rounding 1e-16/h ~ 1e-11
                    let h = 1e-5;
                    let moved = |by: f64| core::array::from_fn(|k| x[k] + if k == i { by } else { 0.0 });
                    let slope = (profile.chi2(&moved(h)).unwrap() - profile.chi2(&moved(-h)).unwrap()) / (2.0 * h);
                    let scale = at.normal[i][i].sqrt() * at.chi2.sqrt();
                    assert!((slope - at.gradient[i]).abs() < 1e-6 * scale, "{i}: {slope} {}", at.gradient[i]);
                }
            });
        }
    }
}

#[test]
fn the_principal_plane_does_not_see_a_lateral_tilt() {
    let options = SurfaceOptions::paper().with_tilt();
    let directions = principal_plane(40.0);
    let truth = [1.5, 0.25, 0.0, 0.0, 3.0_f64.to_radians(), 0.0];
    let fit = fit(&directions, &leaf(&directions, &options, &truth, 40), &options);
    assert_eq!(fit.errors.knowledge[5], Knowledge::NotIdentifiable);
    assert_eq!(fit.x[5], 0.0);
    assert_eq!(fit.errors.standard_errors[5], None);
    assert!((fit.x[4] - truth[4]).abs() < 1e-8, "{:?}", fit.x);
    assert_eq!(fit.parameters[5], Treatment::Held(0.0));
    let _ = FacetKind::Ggx;
}
