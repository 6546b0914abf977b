//! What is refused, and the words it is refused with.

use leafbrdf_prospect::{Error, Jacobian, LeafParams, Parameter, Prospect, Version, table};

fn ordinary() -> LeafParams<f64> {
    LeafParams { cab: 40.0, car: 8.0, cw: 0.01, cm: 0.009, ..LeafParams::with_n_struct(1.5) }
}

fn refused(version: Version, leaf: &LeafParams<f64>) -> Error {
    let (mut r, mut t) = ([f64::NAN; table::BANDS], [f64::NAN; table::BANDS]);
    let error = Prospect::new(table::full(version)).spectrum(leaf, &mut r, &mut t).expect_err("impossible leaf");
    assert!(r.iter().chain(&t).all(|value| value.is_nan()), "nothing is written for a refused leaf");
    error
}

#[test]
fn mis_scaled_values_name_the_likely_unit() {
    for (leaf, message) in [
        (
            LeafParams { cm: 20.0, ..ordinary() },
            "cm = 20 g cm⁻² is outside 0 to 0.2 g cm⁻²: did you mean 20 g m⁻² = 0.002 g cm⁻²?",
        ),
        (LeafParams { cw: 10.0, ..ordinary() }, "cw = 10 cm is outside 0 to 1 cm: did you mean 10 mg cm⁻² = 0.01 cm?"),
        (
            LeafParams { cab: 400.0, ..ordinary() },
            "cab = 400 µg cm⁻² is outside 0 to 300 µg cm⁻²: did you mean 400 mg m⁻² = 40 µg cm⁻²?",
        ),
        (LeafParams { car: -1.0, ..ordinary() }, "car = -1 µg cm⁻² is outside 0 to 100 µg cm⁻²"),
        (LeafParams { n_struct: 0.5, ..ordinary() }, "n_struct = 0.5 is outside 1 to 10"),
        (LeafParams { cbrown: f64::NAN, ..ordinary() }, "cbrown = NaN is outside 0 to 10"),
        (LeafParams { cm: f64::INFINITY, ..ordinary() }, "cm = inf g cm⁻² is outside 0 to 0.2 g cm⁻²"),
    ] {
        assert_eq!(refused(Version::D, &leaf).to_string(), message);
    }
}

/// Every parameter: just inside is accepted, just outside and NaN are not.
#[test]
fn limits_hold_for_every_parameter() {
    for parameter in Parameter::ALL {
        let (lowest, highest) = parameter.limits();
        let (usual_lowest, usual_highest) = parameter.typical();
        assert!(lowest <= usual_lowest && usual_lowest < usual_highest && usual_highest <= highest);
        for value in [lowest, highest] {
            let mut leaf = LeafParams::with_n_struct(1.5);
            leaf.set(parameter, value);
            assert_eq!(leaf.check(Version::Pro), Ok(()), "{parameter:?} = {value}");
            let mut single = LeafParams::with_n_struct(1.5_f32);
            single.set(parameter, value as f32);
            assert_eq!(single.check(Version::Pro), Ok(()), "{parameter:?} = {value}, f32");
        }
        for value in [lowest - 1e-9, highest * 1.000001, f64::NAN, f64::INFINITY] {
            let mut leaf = LeafParams::with_n_struct(1.5);
            leaf.set(parameter, value);
            assert!(matches!(leaf.check(Version::Pro), Err(Error::Outside { parameter: p, .. }) if p == parameter));
        }
    }
}

#[test]
fn a_constituent_that_the_version_lacks_is_not_dropped() {
    let error = refused(Version::P5B, &LeafParams { cant: 1.0, ..ordinary() });
    assert_eq!(error.to_string(), "PROSPECT-5B has no coefficients for cant: use version D or PRO, or set it to 0");
    let error = refused(Version::D, &LeafParams { prot: 0.001, ..ordinary() });
    assert_eq!(error, Error::NotInVersion { parameter: Parameter::Prot, version: Version::D });
}

#[test]
fn dry_matter_twice_is_refused_unless_asked_for() {
    let twice = LeafParams { prot: 0.001, ..ordinary() };
    assert_eq!(refused(Version::Pro, &twice), Error::DryMatterTwice);
    assert_eq!(refused(Version::Pro, &LeafParams { cbc: 0.001, ..ordinary() }), Error::DryMatterTwice);
    let model = Prospect::new(table::full(Version::Pro));
    assert!(model.band(&ordinary(), 0).is_ok() && model.band(&LeafParams { cm: 0.0, ..twice }, 0).is_ok());
    let both = model.allow_cm_with_prot_cbc().band(&twice, 1700).expect("asked for");
    let one = model.band(&ordinary(), 1700).expect("an ordinary leaf");
    assert!(both.absorptance > one.absorptance);
}

#[test]
fn carotenoids_follow_chlorophyll_when_tied() {
    let free = Prospect::new(table::full(Version::D));
    let tied = free.with_car_per_cab(0.25).expect("a possible ratio");
    let leaf = LeafParams { car: 0.0, ..ordinary() };
    let set = LeafParams { car: 10.0, ..leaf };
    assert_eq!(tied.band(&leaf, 80), free.band(&set, 80));
    assert_eq!(tied.band(&set, 80), Err(Error::CarGivenAndTied));
    for ratio in [-0.1, f64::NAN, f64::INFINITY] {
        assert!(matches!(free.with_car_per_cab(ratio), Err(Error::CarPerCab { .. })));
    }
    // the derivative by C_ab takes the carotenoids along
    let one = table::full(Version::D).bands(80..81).expect("a band of the table");
    let slopes = |model: Prospect<'_, f64>, leaf: &LeafParams<f64>| {
        let (mut r, mut t, mut dr, mut dt) = ([0.0; 1], [0.0; 1], [0.0; 2], [0.0; 2]);
        let room =
            Jacobian { reflectance: &mut r, transmittance: &mut t, d_reflectance: &mut dr, d_transmittance: &mut dt };
        model.on(one).jacobian(leaf, &[Parameter::Cab, Parameter::Car], room).expect("a possible leaf");
        dr
    };
    let ([ab, car], [together, nothing]) = (slopes(free, &set), slopes(tied, &leaf));
    assert!((together - (ab + 0.25 * car)).abs() < 1e-15 * together.abs() * 8.0);
    assert_eq!(nothing, 0.0);
}

#[test]
fn slices_of_another_length_are_refused() {
    let model = Prospect::new(table::full(Version::D));
    let (mut long, mut short) = ([0.0; table::BANDS], [0.0; 7]);
    let error = model.spectrum(&ordinary(), &mut long, &mut short).expect_err("too short");
    assert_eq!(error.to_string(), "the slice for transmittance has 7 elements, expected 2101");
    assert!(model.absorptance(&ordinary(), &mut short).is_err());
    assert!(model.band(&ordinary(), table::BANDS).is_err());
}

#[test]
fn unusual_values_are_named_but_accepted() {
    let leaf = LeafParams { cw: 0.15, cab: 150.0, ..ordinary() };
    let unusual: Vec<Parameter> = leaf.unusual(Version::D).collect();
    assert_eq!(unusual, [Parameter::Cab, Parameter::Cw]);
    assert_eq!(leaf.check(Version::D), Ok(()));
    assert_eq!(ordinary().unusual(Version::D).count(), 0);
}

#[test]
fn names_lead_back_to_what_they_name() {
    for parameter in Parameter::ALL {
        assert_eq!(Parameter::from_name(parameter.name()), Some(parameter));
    }
    for version in [Version::P5B, Version::D, Version::Pro] {
        assert_eq!(Version::from_name(version.name()), Some(version));
    }
    assert_eq!((Version::from_name("5b"), Parameter::from_name("Cab")), (None, None));
}
