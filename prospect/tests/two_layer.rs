//! The interior of two stacks: given values, its limit, exact derivatives.

use leafbrdf_prospect::{LeafParams, Parameter, Prospect, TwoLayer, Version, table};

fn leaf() -> LeafParams<f64> {
    LeafParams { cab: 40.0, car: 8.0, cant: 0.5, cbrown: 0.005, cw: 0.012, cm: 0.006, ..LeafParams::with_n_struct(1.5) }
}

fn model() -> Prospect<'static, f64> {
    Prospect::new(table::full(Version::D))
}

const FREE: [Parameter; 7] = [
    Parameter::NStruct,
    Parameter::Cab,
    Parameter::Car,
    Parameter::Cant,
    Parameter::Cbrown,
    Parameter::Cw,
    Parameter::Cm,
];

/// d of all bands, derivatives by `FREE`, and by f.
fn all(leaf: &LeafParams<f64>, share: f64) -> [Vec<f64>; 3] {
    let bands = table::BANDS;
    let (mut d, mut by, mut by_share) = (vec![0.0; bands], vec![0.0; FREE.len() * bands], vec![0.0; bands]);
    let interior = TwoLayer::new(model(), share).unwrap();
    interior.jacobian(leaf, &FREE, &mut d, &mut by, Some(&mut by_share)).unwrap();
    [d, by, by_share]
}

/// Values handed over with the specification, from a NumPy implementation; 7 decimals.
#[test]
fn the_diffuse_reflectance_is_that_of_an_independent_implementation() {
    let nm = [550, 680, 710, 750, 850, 1200, 1650, 2200];
    let uneven = [0.0819911, 0.0003494, 0.1711438, 0.3964952, 0.4212761, 0.3901919, 0.2912773, 0.1441895];
    let even = [0.1050339, 0.0013412, 0.194498, 0.3999121, 0.4213105, 0.3901919, 0.2912773, 0.1441895];
    for (share, expected) in [(0.65, uneven), (0.5, even)] {
        let [d, ..] = all(&leaf(), share);
        for (nm, expected) in nm.into_iter().zip(expected) {
            // The values given are themselves off by up to 2e-7: at f = ½ they differ by that from PROSPECT-D's R − (1 − t_α),
            // which `golden.rs` holds to 1e-13.
            assert!((d[nm - 400] - expected).abs() < 2.5e-7, "f = {share}, {nm} nm: {}", d[nm - 400]);
        }
    }
}

#[test]
fn evenly_shared_pigments_are_prospects_leaf_without_its_first_surface_reflection() {
    for (n_struct, scale) in [(1.0, 1.0), (1.5, 0.0), (1.5, 1.0), (2.7, 3.0)] {
        let mut leaf = leaf();
        leaf.n_struct = n_struct;
        for parameter in FREE.into_iter().skip(1) {
            leaf.set(parameter, scale * leaf.get(parameter));
        }
        let (mut r, mut t) = (vec![0.0; table::BANDS], vec![0.0; table::BANDS]);
        model().spectrum(&leaf, &mut r, &mut t).unwrap();
        let [d, ..] = all(&leaf, 0.5);
        for ((d, r), t_alpha) in d.iter().zip(&r).zip(model().view().t_alpha()) {
            // PROSPECT's own accuracy is 1e-13
            assert!((d - (r - (1.0 - t_alpha))).abs() < 2e-13, "N = {n_struct}, {d}");
        }
    }
}

#[test]
fn derivatives_are_those_of_differences() {
    let [_, by, by_share] = all(&leaf(), 0.62);
    let difference = |shifted: &dyn Fn(f64) -> Vec<f64>, h: f64| -> Vec<f64> {
        let [a, b, c, d] = [h, -h, 2.0 * h, -2.0 * h].map(shifted);
        (0..a.len()).map(|i| (8.0 * (a[i] - b[i]) - (c[i] - d[i])) / (12.0 * h)).collect()
    };
    let close = |exact: &[f64], difference: &[f64], unit: f64, name: &str| {
        for (band, (exact, difference)) in exact.iter().zip(difference).enumerate() {
            // a step of 1e-3 of the parameter: rounding 1e-15/1e-3, truncation (1e-3)⁴ times derivatives of order 10
            assert!((exact - difference).abs() * unit < 1e-10, "{name}, band {band}: {exact} {difference}");
        }
    };
    for (place, parameter) in FREE.into_iter().enumerate() {
        let unit = leaf().get(parameter);
        let shifted = |step: f64| {
            let mut leaf = leaf();
            leaf.set(parameter, unit + step);
            let [d, ..] = all(&leaf, 0.62);
            d
        };
        let exact = &by[place * table::BANDS..(place + 1) * table::BANDS];
        close(exact, &difference(&shifted, 1e-3 * unit), unit, parameter.name());
    }
    close(&by_share, &difference(&|step| all(&leaf(), 0.62 + step)[0].clone(), 1e-3), 1.0, "upper_share");
}

#[test]
fn without_absorption_and_where_no_light_comes_through_nothing_breaks() {
    for (n_struct, cw) in [(1.0, 0.0), (1.5, 0.0), (1.0, 1.0), (3.0, 1.0)] {
        let leaf = LeafParams { cw, ..LeafParams::with_n_struct(n_struct) };
        let [d, by, by_share] = all(&leaf, 0.65);
        assert!(d.iter().chain(&by).chain(&by_share).all(|x| x.is_finite()));
        assert!(d.iter().all(|d| *d > -1e-12 && *d < 1.0));
    }
}

#[test]
fn a_tied_carotenoid_moves_with_chlorophyll_and_a_share_beyond_1_is_refused() {
    let tied = model().with_car_per_cab(0.2).unwrap();
    let leaf = LeafParams { car: 0.0, ..leaf() };
    let free = LeafParams { car: 8.0, ..leaf };
    let band = 90;
    let (with_tie, without) = (TwoLayer::new(tied, 0.6).unwrap(), TwoLayer::new(model(), 0.6).unwrap());
    assert_eq!(with_tie.band(&leaf, band).unwrap(), without.band(&free, band).unwrap());
    for share in [-0.1, 1.1, f64::NAN] {
        assert!(TwoLayer::new(model(), share).unwrap_err().to_string().contains("from 0 to 1"));
    }
}
