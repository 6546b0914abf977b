//! The model against values that other code computed with 40 digits.

mod common;

use common::Table;
use leafbrdf_core::{
    Absorbing, Angle, Dielectric, Geometry, Index, Normalization, Portable, Real, Surface, facet, masking,
};

fn relative(value: f64, reference: f64) -> f64 {
    if value == reference { 0.0 } else { ((value - reference) / reference).abs() }
}

fn geometry<T: Real>(theta_s: f64, theta_v: f64, phi_v: f64) -> Geometry<T> {
    let deg = |x| Angle::from_degrees(T::lit(x));
    Geometry::from_angles(deg(theta_s), deg(theta_v), deg(phi_v)).unwrap()
}

#[test]
fn brdf_agrees_with_40_digits_to_1e_12() {
    check_brdf::<f64>(1e-12);
}

#[test]
fn portable_brdf_agrees_with_40_digits_to_1e_12() {
    check_brdf::<Portable<f64>>(1e-12);
}

/// The bound is the project's promise for double precision; measured: 6e-13 where tan²α/σ² is about 450.
fn check_brdf<T: Real>(bound: f64) {
    let table = Table::read(include_str!("golden/brdf_reference.csv"));
    let at = |name| table.column(name);
    let mut worst: f64 = 0.0;
    let mut compared = 0;
    for row in &table.rows {
        let (n, sigma) = (row[at("n")], row[at("sigma")]);
        let g: Geometry<T> = geometry(row[at("theta_s_deg")], row[at("theta_v_deg")], row[at("phi_v_deg")]);
        let surface = Surface::new(T::lit(n), T::lit(sigma)).unwrap();

        let fresnel = Dielectric::new(T::lit(n)).unwrap().fresnel(g.cos_theta_a()).to_f64();
        assert!(relative(fresnel, row[at("F")]) < bound, "F {fresnel} {row:?}");
        assert!(relative(masking::v_cavity(&g).to_f64(), row[at("G")]) < bound, "G {row:?}");
        // α and θ_a: absolute, in degrees; the reference has 17 digits of an angle up to 90
        assert!((g.alpha().to_f64().to_degrees() - row[at("alpha_deg")]).abs() < 1e-12, "alpha {row:?}");
        assert!((g.theta_a().to_f64().to_degrees() - row[at("theta_a_deg")]).abs() < 1e-12, "theta_a {row:?}");

        let density = facet::beckmann(g.tan2_alpha(), T::lit(sigma)).to_f64();
        if row[at("D_beckmann")] > 1e-200 {
            assert!(relative(density, row[at("D_beckmann")]) < bound, "D {density} {row:?}");
        }
        for (normalization, column) in [(Normalization::CookTorrance, "f_4pi"), (Normalization::Bousquet2005, "f_2pi2")]
        {
            let value = surface.with_normalization(normalization).brdf(&g).to_f64();
            let reference = row[at(column)];
            if reference > 1e-200 {
                worst = worst.max(relative(value, reference));
                compared += 1;
                assert!(relative(value, reference) < bound, "{normalization:?} {value} {row:?}");
            } else {
                assert!((0.0..=1.1e-200).contains(&value), "{normalization:?} {value} {row:?}");
            }
        }
    }
    println!("BRDF_spec: worst relative error {worst:.1e} of {compared}");
    assert!(compared > 2_000);
}

#[test]
fn fresnel_of_a_complex_index_agrees_with_40_digits_to_1e_12() {
    let table = Table::read(include_str!("golden/fresnel_reference.csv"));
    let at = |name| table.column(name);
    let mut worst: f64 = 0.0;
    for row in &table.rows {
        let (n, kappa) = (row[at("n")], row[at("k")]);
        let cos = Angle::from_degrees(row[at("theta_deg")]).cos();
        let mut candidates = vec![Absorbing::new(n, kappa).unwrap().polarized(cos)];
        if kappa == 0.0 {
            candidates.push(Dielectric::new(n).unwrap().polarized(cos));
        }
        for polarized in candidates {
            worst = worst.max(relative(polarized.unpolarized(), row[at("F")]));
            assert!(relative(polarized.unpolarized(), row[at("F")]) < 1e-12, "{polarized:?} {row:?}");
            assert!((polarized.r_s - row[at("R_s")]).abs() < 1e-12, "{polarized:?} {row:?}");
            assert!((polarized.r_p - row[at("R_p")]).abs() < 1e-12, "{polarized:?} {row:?}");
        }
    }
    println!("F: worst relative error {worst:.1e}");
    assert_eq!(table.rows.len(), 600);
}
