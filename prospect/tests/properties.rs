//! Laws that hold for every leaf, tried on random ones.

use leafbrdf_prospect::{
    Interface, Jacobian, LeafParams, Parameter, Prospect, Version, plates, plates_with_slopes, table,
};
use proptest::prelude::*;

/// Rounding of R, T and A: a few 1e-15 by `tests/golden.rs`.
const ROUNDING: f64 = 1e-14;

fn version() -> impl Strategy<Value = Version> {
    prop_oneof![Just(Version::P5B), Just(Version::D), Just(Version::Pro)]
}

/// Leaves over the whole accepted range: each constituent is absent, ordinary or extreme.
fn leaf(version: Version) -> impl Strategy<Value = LeafParams<f64>> {
    let fractions = prop::collection::vec(prop_oneof![Just(0.0), 0.0..1.0_f64, Just(1.0)], 9);
    (fractions, any::<bool>()).prop_map(move |(fractions, extreme)| {
        let mut leaf = LeafParams::with_n_struct(1.0);
        for (parameter, fraction) in Parameter::ALL.into_iter().zip(fractions) {
            let (lowest, highest) = if extreme { parameter.limits() } else { parameter.typical() };
            let known = parameter == Parameter::NStruct || version.constituents().contains(&parameter);
            let split = version == Version::Pro && parameter == Parameter::Cm;
            if known && !split {
                leaf.set(parameter, if fraction == 0.0 { lowest } else { lowest + fraction * (highest - lowest) });
            }
        }
        leaf
    })
}

fn case() -> impl Strategy<Value = (Version, LeafParams<f64>)> {
    version().prop_flat_map(|version| leaf(version).prop_map(move |leaf| (version, leaf)))
}

fn spectrum(version: Version, leaf: &LeafParams<f64>) -> (Vec<f64>, Vec<f64>) {
    let (mut r, mut t) = (vec![0.0; table::BANDS], vec![0.0; table::BANDS]);
    Prospect::new(table::full(version)).spectrum(leaf, &mut r, &mut t).expect("a possible leaf");
    (r, t)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(256) })]

    #[test]
    fn light_is_reflected_transmitted_or_absorbed_and_never_made((version, leaf) in case()) {
        let (r, t) = spectrum(version, &leaf);
        let mut a = vec![0.0; table::BANDS];
        Prospect::new(table::full(version)).absorptance(&leaf, &mut a).expect("a possible leaf");
        for ((r, t), a) in r.iter().zip(&t).zip(&a) {
            prop_assert!(*r > 0.0 && *t >= 0.0 && *a >= 0.0, "{r} {t} {a}");
            prop_assert!(r + t <= 1.0 + ROUNDING);
            prop_assert!((r + t + a - 1.0).abs() <= ROUNDING, "{r} + {t} + {a}");
        }
    }

    #[test]
    fn without_absorbers_nothing_is_lost(n_struct in 1.0..10.0_f64) {
        let (r, t) = spectrum(Version::D, &LeafParams::with_n_struct(n_struct));
        for (r, t) in r.iter().zip(&t) {
            prop_assert!((r + t - 1.0).abs() <= ROUNDING);
        }
    }

    #[test]
    fn more_of_any_absorber_never_raises_what_leaves_the_leaf(
        (version, leaf) in case(),
        which in 0..8_usize,
        share in 0.0..1.0_f64,
    ) {
        let constituents = version.constituents();
        let parameter = constituents[which % constituents.len()];
        prop_assume!(!(version == Version::Pro && parameter == Parameter::Cm));
        let mut more = leaf;
        more.set(parameter, leaf.get(parameter) + share * (parameter.limits().1 - leaf.get(parameter)));
        let (r, t) = spectrum(version, &leaf);
        let (r_more, t_more) = spectrum(version, &more);
        for band in 0..table::BANDS {
            prop_assert!(r_more[band] + t_more[band] <= r[band] + t[band] + ROUNDING, "{parameter:?}, band {band}");
        }
    }

    #[test]
    fn more_chlorophyll_darkens_the_red_and_leaves_the_short_wave_infrared_alone(
        (version, leaf) in case(),
        more in 1.0..100.0_f64,
    ) {
        let greener = LeafParams { cab: leaf.cab + more, ..leaf };
        prop_assume!(greener.cab <= 300.0);
        let (r, t) = spectrum(version, &leaf);
        let (r_green, t_green) = spectrum(version, &greener);
        for nm in 640..=690 {
            let band = nm - 400;
            prop_assert!(r_green[band] <= r[band] + ROUNDING && t_green[band] <= t[band] + ROUNDING, "{nm} nm");
        }
        // to the bit: chlorophyll has no coefficient there
        prop_assert_eq!(&r_green[800..], &r[800..]);
        prop_assert_eq!(&t_green[800..], &t[800..]);
    }

    #[test]
    fn a_little_more_n_is_a_little_more_reflectance(
        k in prop_oneof![Just(0.0), 1e-12..1e-3_f64, 0.0..10.0_f64, 10.0..600.0_f64],
        n_struct in prop_oneof![Just(1.0), 1.0..10.0_f64],
        step in 1e-9..1e-3_f64,
        n in 1.2..1.6_f64,
    ) {
        let faces = Interface::new(n);
        let (here, there) = (plates(faces, k, n_struct), plates(faces, k, n_struct + step));
        // ∂R/∂N and ∂T/∂N are below 1 for every plate
        prop_assert!(there.reflectance >= here.reflectance - ROUNDING);
        prop_assert!(there.reflectance - here.reflectance <= step + ROUNDING);
        prop_assert!(there.transmittance <= here.transmittance + ROUNDING);
        prop_assert!(here.transmittance - there.transmittance <= step + ROUNDING);
    }

    /// Around K = 2 the expansion changes, around small D the series of the slopes sets in: no step anywhere.
    #[test]
    fn value_and_slopes_are_continuous_in_absorption(
        k in prop_oneof![Just(2.0), 1.999..2.001_f64, 1e-12..1e-2_f64, 0.0..5.0_f64],
        n_struct in 1.0..10.0_f64,
    ) {
        let faces = Interface::new(1.4);
        let (low, high) = (k * (1.0 - 1e-9), k * (1.0 + 1e-9));
        let (a, da) = plates_with_slopes(faces, low, n_struct);
        let (b, db) = plates_with_slopes(faces, high, n_struct);
        let width = high - low;
        // trapezoid rule: what is left is the third derivative, 1e-18 of a singularity no worse than ln K
        let rest = 1e-14 + width * 1e-6;
        prop_assert!((b.reflectance - a.reflectance - 0.5 * width * (da.dr_dk + db.dr_dk)).abs() <= rest);
        prop_assert!((b.transmittance - a.transmittance - 0.5 * width * (da.dt_dk + db.dt_dk)).abs() <= rest);
        for (a, b) in [(da.dr_dk, db.dr_dk), (da.dt_dk, db.dt_dk), (da.dr_dn, db.dr_dn), (da.dt_dn, db.dt_dn)] {
            prop_assert!((a - b).abs() <= 1e-7 * (1.0 + a.abs()), "{a} {b}");
        }
    }

    #[test]
    fn every_instruction_set_gives_the_same_bits((version, leaf) in case()) {
        let (r, t) = spectrum(version, &leaf);
        let (mut r_plain, mut t_plain) = (vec![0.0; table::BANDS], vec![0.0; table::BANDS]);
        Prospect::new(table::full(version))
            .spectrum_portable(&leaf, &mut r_plain, &mut t_plain)
            .expect("a possible leaf");
        prop_assert!(r.iter().zip(&r_plain).all(|(a, b)| a.to_bits() == b.to_bits()));
        prop_assert!(t.iter().zip(&t_plain).all(|(a, b)| a.to_bits() == b.to_bits()));
    }

    /// The scalar path uses the standard library's exp and ln: equal within 1e-12 was asked for.
    #[test]
    fn bands_one_by_one_agree_with_the_vectorised_spectrum((version, leaf) in case()) {
        let (r, t) = spectrum(version, &leaf);
        let model = Prospect::new(table::full(version));
        for band in (0..table::BANDS).step_by(13) {
            let single = model.band(&leaf, band).expect("a band of the table");
            prop_assert!((single.reflectance - r[band]).abs() <= ROUNDING);
            prop_assert!((single.transmittance - t[band]).abs() <= ROUNDING);
        }
    }

    #[test]
    fn derivatives_come_with_the_very_same_values((version, leaf) in case()) {
        let (r, t) = spectrum(version, &leaf);
        let (mut r_too, mut t_too) = (vec![0.0; table::BANDS], vec![0.0; table::BANDS]);
        let (mut dr, mut dt) = (vec![0.0; 9 * table::BANDS], vec![0.0; 9 * table::BANDS]);
        let room = Jacobian {
            reflectance: &mut r_too,
            transmittance: &mut t_too,
            d_reflectance: &mut dr,
            d_transmittance: &mut dt,
        };
        Prospect::new(table::full(version)).jacobian(&leaf, &Parameter::ALL, room).expect("a possible leaf");
        prop_assert_eq!(r, r_too);
        prop_assert_eq!(t, t_too);
        prop_assert!(dr.iter().chain(&dt).all(|slope| slope.is_finite()));
    }

    /// Order and choice of parameters change nothing but places.
    #[test]
    fn a_parameter_has_one_derivative_whoever_is_asked_with_it((version, leaf) in case()) {
        let bands = table::full(version).bands(100..137).expect("bands of the table");
        let model = Prospect::new(bands);
        let run = |parameters: &[Parameter]| {
            let (mut r, mut t) = (vec![0.0; 37], vec![0.0; 37]);
            let (mut dr, mut dt) = (vec![0.0; 37 * parameters.len()], vec![0.0; 37 * parameters.len()]);
            let room =
                Jacobian { reflectance: &mut r, transmittance: &mut t, d_reflectance: &mut dr, d_transmittance: &mut dt };
            model.jacobian(&leaf, parameters, room).expect("a possible leaf");
            (dr, dt)
        };
        let (all_r, all_t) = run(&Parameter::ALL);
        let (some_r, some_t) = run(&[Parameter::Cw, Parameter::NStruct]);
        prop_assert_eq!(&some_r[..37], &all_r[5 * 37..6 * 37]);
        prop_assert_eq!(&some_t[37..], &all_t[..37]);
    }

    #[test]
    fn single_precision_stays_within_its_rounding((version, leaf) in case()) {
        let faces = table::full(version).interface(300).expect("a band of the table");
        let faces32 =
            Interface { t_alpha: faces.t_alpha as f32, t_90: faces.t_90 as f32, t_21: faces.t_21 as f32 };
        for k in [0.0, 1e-7, 1e-3, leaf.cab / 100.0, leaf.cw * 100.0] {
            let double = plates(faces, k, leaf.n_struct);
            let single = plates(faces32, k as f32, leaf.n_struct as f32);
            prop_assert!((f64::from(single.reflectance) - double.reflectance).abs() <= 5e-6);
            prop_assert!((f64::from(single.transmittance) - double.transmittance).abs() <= 5e-6);
        }
    }
}
