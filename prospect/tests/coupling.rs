//! The coupled leaf (Eq. 18): golden values, exact derivatives, laws.

use std::f64::consts::PI;

use leafbrdf_core::{Angle, Geometry, Grade, Illumination, Normalization, Surface};
use leafbrdf_prospect::{
    CoupledBand, CoupledLeaf, Coupling, Error, LeafParams, Link, Parameter, Prospect, Version, table,
};

/// Made independently of this project's code; its first lines say how.
const REFERENCE: &str = include_str!("golden/leaf_reference.csv");

fn geometry(theta_s: f64, theta_v: f64, phi_v: f64) -> Geometry<f64> {
    let deg = Angle::from_degrees;
    Geometry::from_angles(deg(theta_s), deg(theta_v), deg(phi_v)).unwrap()
}

fn interior() -> LeafParams<f64> {
    LeafParams { cab: 38.0, car: 9.0, cant: 2.0, cbrown: 0.05, cw: 0.011, cm: 0.006, ..LeafParams::with_n_struct(1.6) }
}

#[test]
fn k_l_and_brdf_are_those_of_the_reference() {
    let mut rows = 0;
    for line in REFERENCE.lines().filter(|line| !line.starts_with('#') && !line.starts_with("normalization")) {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |place: usize| cells[place].parse::<f64>().unwrap();
        let normalization = match cells[0] {
            "bousquet2005" => Normalization::Bousquet2005,
            "cook-torrance" => Normalization::CookTorrance,
            other => panic!("{other}"),
        };
        let interior = LeafParams {
            cab: number(5),
            car: number(6),
            cant: number(7),
            cbrown: number(8),
            cw: number(9),
            cm: number(10),
            ..LeafParams::with_n_struct(number(4))
        };
        let surface = Surface::new(number(2), number(3)).unwrap().with_normalization(normalization);
        let model = Prospect::new(table::full(Version::D));
        let leaf = CoupledLeaf::new(model, interior, Coupling::from_name(cells[1]).unwrap(), surface);
        let ours = leaf.band(number(11) as usize - 400, &geometry(number(12), number(13), number(14))).unwrap();
        // asked for: 1e-9; the reference's DHRF is good to 8e-11 of itself
        assert!((ours.diffuse.k_lambert - number(15)).abs() < 1e-9, "{line}");
        assert!((ours.brdf - number(16)).abs() < 1e-9, "{line}");
        rows += 1;
    }
    assert_eq!(rows, 480);
}

/// One leaf of every coupling, with its scaled index where that is what the coupling is used with.
fn leaf(coupling: Coupling, interior: LeafParams<f64>, [n, sigma, gain, offset]: [f64; 4]) -> CoupledBand<f64> {
    let surface = Surface::new(n, sigma).unwrap().with_normalization(Normalization::CookTorrance);
    let model = Prospect::new(table::full(Version::D));
    let leaf = CoupledLeaf::new(model, interior, coupling, surface).with_gain_and_offset(gain, offset);
    let leaf = if coupling == Coupling::Prospecular { leaf.with_scaled_index(n) } else { leaf };
    leaf.band(320, &geometry(45.0, 50.0, 175.0)).unwrap()
}

#[test]
fn derivatives_are_those_of_differences() {
    let at = [1.12, 0.27, 1.1, 0.02];
    for coupling in Coupling::ALL {
        let exact = leaf(coupling, interior(), at);
        let outer = [exact.d_n, exact.d_sigma, exact.d_gain, exact.d_offset];
        for (place, derivative) in outer.into_iter().enumerate() {
            let shifted = |step: f64| {
                let mut at = at;
                at[place] += step;
                leaf(coupling, interior(), at).brdf
            };
            let h = 1e-4;
            // central difference of fourth order: h⁴ times a fifth derivative below 10³, and rounding of 1e-16/h
            let difference = (8.0 * (shifted(h) - shifted(-h)) - (shifted(2.0 * h) - shifted(-2.0 * h))) / (12.0 * h);
            assert!((derivative - difference).abs() < 1e-9, "{coupling:?}, {place}: {derivative} {difference}");
        }
        for (parameter, derivative) in Parameter::ALL.into_iter().zip(exact.d_interior) {
            if matches!(parameter, Parameter::Prot | Parameter::Cbc) {
                assert_eq!(derivative, 0.0, "unknown to version D");
                continue;
            }
            let h = 1e-3 * interior().get(parameter);
            let shifted = |step: f64| {
                let mut interior = interior();
                interior.set(parameter, interior.get(parameter) + step);
                leaf(coupling, interior, at).brdf
            };
            let difference = (8.0 * (shifted(h) - shifted(-h)) - (shifted(2.0 * h) - shifted(-2.0 * h))) / (12.0 * h);
            let scale = derivative.abs().max(1e-6);
            // rounding: 1e-16/(1e-3 · parameter), relative to derivative · parameter of 1e-3 and more
            assert!((derivative - difference).abs() < 1e-8 * scale, "{coupling:?}, {parameter:?}");
        }
    }
}

#[test]
fn what_the_surface_reflects_and_what_the_diffuse_term_sends_back_add_up_to_prospects_reflectance() {
    let surface = Surface::new(1.4, 0.25).unwrap();
    let model = Prospect::new(table::full(Version::D));
    let leaf = CoupledLeaf::new(model, interior(), Coupling::Bousquet, surface);
    let dhrf = surface.dhrf(&Illumination::new(Angle::from_degrees(0.0)).unwrap(), Grade::E10);
    for band in [20, 150, 280, 450, 900, 1500] {
        let k_l = leaf.band(band, &geometry(30.0, 20.0, 0.0)).unwrap().diffuse.k_lambert;
        let r = model.band(&interior(), band).unwrap().reflectance;
        // a few roundings
        assert!((k_l + dhrf - r).abs() < 1e-15);
    }
}

#[test]
fn gain_1_and_offset_0_are_prospeculars_diffuse_term_and_an_offset_is_minus_a_surface() {
    let (r, t_alpha) = (0.4123, 0.957);
    let none = Link::default();
    let gain_offset = Coupling::GainOffset.diffuse(r, t_alpha, &none);
    assert_eq!(gain_offset.k_lambert, Coupling::Prospecular.diffuse(r, t_alpha, &none).k_lambert);
    let offset = Coupling::Offset.diffuse(r, t_alpha, &Link { offset: -0.03, ..none });
    let surface = Coupling::Bousquet.diffuse(r, t_alpha, &Link { dhrf_specular: 0.03, ..none });
    assert_eq!(offset.k_lambert, surface.k_lambert);
}

#[test]
fn a_negative_lambert_coefficient_is_said_and_kept() {
    // n = 3 under K = 2π² reflects 16 % at normal incidence: more than the whole leaf in the red, less in the infrared
    let model = Prospect::new(table::full(Version::D));
    let leaf = CoupledLeaf::new(model, interior(), Coupling::Bousquet, Surface::new(3.0, 0.1).unwrap());
    assert!(leaf.negative(270).unwrap());
    assert!(!leaf.negative(450).unwrap());
    let band = leaf.band(270, &geometry(45.0, 0.0, 0.0)).unwrap();
    assert!(band.diffuse.k_lambert < -0.05 && band.brdf >= band.diffuse.k_lambert / PI, "not clipped");
}

#[test]
fn a_coefficient_that_leaves_no_index_is_refused_with_the_index() {
    let surface = Surface::new(1.2, 0.2).unwrap();
    let model = Prospect::new(table::full(Version::D));
    let leaf = CoupledLeaf::new(model, interior(), Coupling::Prospecular, surface).with_scaled_index(0.5);
    let error = leaf.band(100, &geometry(30.0, 20.0, 0.0)).unwrap_err();
    assert!(matches!(error, Error::SurfaceIndex { value } if value < 1.0));
    assert!(error.to_string().contains("expected a number from 1"));
}
