//! Whole leaves inverted: what goes in comes out, what is held stays, what cannot be known is said.

use leafbrdf_core::{Angle, DirectionVectors, Geometry, Normalization, Surface};
use leafbrdf_fit::leaf::parameters::{COUNT, GAIN, NAMES, OFFSET, place};
use leafbrdf_fit::leaf::recipe::{DORSIVENTRAL, PLAIN, RECIPES};
use leafbrdf_fit::leaf::{
    DirectionalData, Interior, Knowledge, LeafError, LeafFit, LeafOptions, Method, Prior, RECOMMENDED, SurfaceFrom,
    Treatment, fit,
};
use leafbrdf_fit::{AtBound, Interval};
use leafbrdf_prospect::{CoupledLeaf, Coupling, LeafParams, Parameter, Prospect, TwoLayer, Version, table};

/// Twelve views in the principal plane, as a laboratory takes them: θ_v, φ_v.
const PLANE: [(f64, f64); 12] = [
    (60.0, 180.0),
    (50.0, 180.0),
    (40.0, 180.0),
    (30.0, 180.0),
    (20.0, 180.0),
    (10.0, 180.0),
    (0.0, 0.0),
    (10.0, 0.0),
    (20.0, 0.0),
    (40.0, 0.0),
    (50.0, 0.0),
    (60.0, 0.0),
];
const THETA_S: f64 = 35.0;

fn interior() -> LeafParams<f64> {
    LeafParams { cab: 42.0, car: 9.0, cant: 1.5, cbrown: 0.05, cw: 0.013, cm: 0.006, ..LeafParams::with_n_struct(1.55) }
}

/// A measurement: wavelengths, views, BRDF.
struct Leaf {
    nm: Vec<f64>,
    views: Vec<(f64, f64)>,
    brdf: Vec<f64>,
}

impl Leaf {
    /// Of whatever gives a BRDF for a band from 400 nm and a view.
    fn new(nm: Vec<f64>, views: &[(f64, f64)], brdf: impl Fn(usize, &Geometry<f64>) -> f64) -> Self {
        let deg = Angle::from_degrees;
        let geometry =
            |(theta_v, phi_v): (f64, f64)| Geometry::from_angles(deg(THETA_S), deg(theta_v), deg(phi_v)).unwrap();
        let geometries: Vec<Geometry<f64>> = views.iter().copied().map(geometry).collect();
        let values =
            nm.iter().flat_map(|nm| geometries.iter().map(|g| brdf(*nm as usize - 400, g)).collect::<Vec<_>>());
        Leaf { brdf: values.collect(), nm: nm.clone(), views: views.to_vec() }
    }

    /// Of an interior under a surface (Eq. 18).
    fn coupled(nm: Vec<f64>, views: &[(f64, f64)], coupling: Coupling, interior: LeafParams<f64>) -> Self {
        let model = Prospect::new(table::full(Version::D));
        let surface = Surface::new(1.45, 0.25).unwrap();
        let leaf = CoupledLeaf::new(model, interior, coupling, surface).with_gain_and_offset(1.0, -0.03);
        let leaf = if coupling == Coupling::Prospecular { leaf.with_scaled_index(1.02) } else { leaf };
        Leaf::new(nm, views, |band, geometry| leaf.band(band, geometry).unwrap().brdf)
    }

    fn fit(&self, options: &LeafOptions) -> Result<LeafFit, LeafError> {
        let deg = Angle::from_degrees;
        let vectors = |&(theta_v, phi_v): &(f64, f64)| {
            DirectionVectors::from_angles(deg(THETA_S), deg(theta_v), deg(phi_v)).unwrap()
        };
        let directions: Vec<_> = self.views.iter().map(vectors).collect();
        fit(&DirectionalData { wavelengths_nm: &self.nm, directions: &directions, brdf: &self.brdf, sd: None }, options)
    }

    /// With noise of this standard deviation.
    fn with_noise(self, sd: f64, seed: u64) -> Self {
        self.with_noise_of(|_| sd, seed)
    }

    /// With noise whose standard deviation depends on the value: sums of uniform numbers from a seed.
    fn with_noise_of(mut self, sd: impl Fn(f64) -> f64, seed: u64) -> Self {
        let mut state = seed;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        for y in &mut self.brdf {
            let gauss: f64 = (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
            *y += sd(*y) * gauss;
        }
        self
    }
}

fn every(step: usize) -> Vec<f64> {
    (400..=2500).step_by(step).map(|nm| nm as f64).collect()
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

/// All of the interior within this share.
#[track_caller]
fn recovered(fit: &LeafFit, truth: &LeafParams<f64>, share: f64) {
    for parameter in FREE {
        let (found, true_value) = (fit.interior().get(parameter), truth.get(parameter));
        assert!((found / true_value - 1.0).abs() < share, "{}: {found} instead of {true_value}", parameter.name());
    }
}

#[test]
fn a_joint_fit_without_noise_finds_surface_and_interior_under_every_coupling() {
    for coupling in [Coupling::Bousquet, Coupling::Prospecular, Coupling::Offset] {
        let leaf = Leaf::coupled(every(20), &PLANE, coupling, interior());
        let mut options = LeafOptions::new(Method::Joint);
        options.coupling = coupling;
        let fit = leaf.fit(&options).unwrap();
        // converged to 1e-10 of χ², which noise-free data let fall to rounding
        recovered(&fit, &interior(), 1e-4);
        let n = if coupling == Coupling::Prospecular { 1.02 } else { 1.45 };
        assert!((fit.x[0] - n).abs() < 1e-5 && (fit.x[1] - 0.25).abs() < 1e-5, "{coupling:?} {:?}", fit.x);
        if coupling == Coupling::Offset {
            assert!((fit.x[OFFSET] + 0.03).abs() < 1e-6);
        }
        assert!(fit.rmse < 1e-7 && fit.termination.converged());
    }
}

#[test]
fn with_gain_and_offset_free_n_struct_is_held_and_the_rest_comes_back() {
    let truth = LeafParams { n_struct: RECOMMENDED.n_struct, ..interior() };
    let leaf = Leaf::coupled(every(20), &PLANE, Coupling::GainOffset, truth);
    let mut options = LeafOptions::new(Method::Joint);
    options.coupling = Coupling::GainOffset;
    let fit = leaf.fit(&options).unwrap();
    assert_eq!(fit.knowledge[place(Parameter::NStruct)], Knowledge::Held);
    recovered(&fit, &truth, 1e-4);
    assert!((fit.x[GAIN] - 1.0).abs() < 1e-5 && (fit.x[OFFSET] + 0.03).abs() < 1e-5);
}

#[test]
fn the_papers_two_steps_without_noise_find_both_wherever_the_surface_is_taken_from() {
    let leaf = Leaf::coupled(every(20), &PLANE, Coupling::Bousquet, interior());
    for from in [SurfaceFrom::Bands, SurfaceFrom::Surface] {
        let mut options = LeafOptions::new(Method::TwoStep);
        options.surface_from = from;
        let fit = leaf.fit(&options).unwrap();
        // σ and n of each band are found to about 1e-8; k_L and all else follow
        recovered(&fit, &interior(), 1e-3);
        assert!((fit.x[0] - 1.45).abs() < 1e-5 && (fit.x[1] - 0.25).abs() < 1e-5);
        assert_eq!(fit.knowledge[0], Knowledge::Held);
    }
}

/// Diffuse light alone, k_L = g d + b, d of the recipe's own interior: what its model says is what it must find.
fn diffuse_leaf(nm: Vec<f64>, views: &[(f64, f64)], truth: LeafParams<f64>, interior: Interior) -> Leaf {
    let share = if let Interior::TwoLayer { upper_share } = interior { upper_share } else { 0.5 };
    let model = TwoLayer::new(Prospect::new(table::full(Version::D)), share).unwrap();
    let lobe = Surface::ggx(1.46, 0.2).unwrap().with_normalization(Normalization::CookTorrance);
    Leaf::new(nm, views, |band, geometry| {
        let k_l = 1.07 * model.band(&truth, band).unwrap() + 0.01;
        k_l * std::f64::consts::FRAC_1_PI + lobe.brdf(geometry)
    })
}

#[test]
fn each_recipe_finds_a_leaf_that_is_as_it_assumes() {
    for recipe in RECIPES {
        // brown pigments as green leaves have them, where a prior in the logarithm has its centre
        let truth = LeafParams { n_struct: recipe.n_struct, cbrown: 0.005, ..interior() };
        let assumed = match (recipe.interior, recipe.share_rule) {
            (Interior::TwoLayer { upper_share }, Some(rule)) => {
                Interior::TwoLayer { upper_share: rule.share(upper_share, truth.cm, 0.1) }
            }
            (interior, _) => interior,
        };
        let leaf = diffuse_leaf(every(5), &PLANE, truth, assumed);
        let mut options = LeafOptions::new(Method::Recommended);
        options.recipe = recipe;
        // the surface of this leaf: no bowl, no tilt
        options.surface = options.surface.with_lambert();
        let fit = leaf.fit(&options).unwrap();
        for parameter in FREE.into_iter().skip(1) {
            let (found, sought) = (fit.x[place(parameter)], truth.get(parameter));
            let error = fit.interior_se(parameter).unwrap();
            // priors pull by less than the error that is stated
            assert!((found - sought).abs() < error, "{}: {} {found} ± {error}", recipe.name, parameter.name());
        }
        // what is asked of it: chlorophyll, water and dry matter, against priors 1.5 and 1 wide in the logarithm
        for (parameter, share) in [(Parameter::Cab, 0.02), (Parameter::Cw, 0.02), (Parameter::Cm, 0.1)] {
            let found = fit.x[place(parameter)];
            assert!(
                (found / truth.get(parameter) - 1.0).abs() < share,
                "{}: {} {found}",
                recipe.name,
                parameter.name()
            );
        }
        assert!((fit.x[0] - 1.46).abs() < 0.01 && (fit.x[1] - 0.2).abs() < 0.005, "{}: {:?}", recipe.name, fit.x);
        assert_eq!((fit.starts, fit.agreeing), (3, 3), "all starts meet");
        let report = fit.recipe.unwrap();
        assert_eq!(report.kept.len(), 6, "the darker half of 12 directions");
        assert!(!report.kept.contains(&2) && !report.kept.contains(&1), "the lobe is left out: {:?}", report.kept);
    }
}

#[test]
fn the_darker_half_is_kept_and_the_flank_of_the_water_band_left_out() {
    let leaf = diffuse_leaf(every(1), &PLANE, interior(), DORSIVENTRAL.interior);
    let fit = leaf.fit(&LeafOptions::new(Method::Recommended)).unwrap();
    let report = fit.recipe.unwrap();
    assert_eq!(report.wavelengths_nm.len(), 195, "410 to 2400 nm every 10 nm without 1870 to 1910");
    assert_eq!(report.recipe.name, RECOMMENDED.name);
    assert!(report.wavelengths_nm.iter().all(|nm| !(1870.0..=1910.0).contains(nm) && nm % 10.0 == 0.0));
}

#[test]
fn the_upper_share_falls_as_dry_matter_grows_and_stays_where_dry_matter_is_unknown() {
    let rule = RECOMMENDED.share_rule.unwrap();
    // at the reference itself, one e above it, beyond either bound, and with an error that says nothing
    let of = |cm: f64, log_sd: f64| rule.share(0.7, cm, log_sd);
    assert_eq!(
        [of(0.005, 0.3), of(0.05, 0.3), of(0.0001, 0.3), of(0.02, 0.9), of(0.0, 0.1)],
        [0.7, 0.5, 0.8, 0.7, 0.7]
    );
    assert!((of(0.005 * 1_f64.exp(), 0.3) - 0.6).abs() < 1e-15);
    // without the short-wave infrared dry matter is not known, and the share stays
    let nm: Vec<f64> = (480..880).map(f64::from).collect();
    let leaf = Leaf::coupled(nm, &PLANE, Coupling::Bousquet, interior());
    let report = leaf.fit(&LeafOptions::new(Method::Recommended)).unwrap().recipe.unwrap();
    assert_eq!(report.interior, Interior::TwoLayer { upper_share: 0.7 });
}

#[test]
fn one_direction_gives_contents_and_says_that_it_knows_no_surface() {
    let leaf = Leaf::coupled(every(5), &PLANE[6..7], Coupling::GainOffset, interior());
    let fit = leaf.fit(&LeafOptions::new(Method::Recommended)).unwrap();
    assert!(!fit.has_surface);
    assert_eq!(fit.recipe.as_ref().unwrap().kept, [0]);
    let cab = fit.x[place(Parameter::Cab)];
    assert!((cab - 42.0).abs() < 3.0 * fit.interior_se(Parameter::Cab).unwrap());
    // joint: n and σ are held, and said not to be known
    let fit = leaf.fit(&LeafOptions::new(Method::Joint)).unwrap();
    assert!(!fit.has_surface);
    assert_eq!([fit.knowledge[0], fit.knowledge[1]], [Knowledge::NotIdentifiable; 2]);
    assert_eq!([fit.standard_errors[0], fit.standard_errors[1]], [None, None]);
}

#[test]
fn one_band_tells_nothing_of_contents_and_nothing_is_invented() {
    let leaf = Leaf::coupled(vec![710.0], &PLANE, Coupling::Bousquet, interior());
    let fit = leaf.fit(&LeafOptions::new(Method::Recommended)).unwrap();
    for parameter in [Parameter::Cw, Parameter::Cm, Parameter::Cbrown, Parameter::Cant] {
        assert_eq!(fit.knowledge[place(parameter)], Knowledge::PriorOnly, "{}", parameter.name());
    }
    let fit = leaf.fit(&LeafOptions::new(Method::Joint)).unwrap();
    let known = FREE.iter().filter(|parameter| fit.knowledge[place(**parameter)] == Knowledge::Identified).count();
    assert!(known <= 1, "one value of k_L cannot tell {known} contents: {:?}", fit.knowledge);
    assert!(fit.x.iter().all(|x| x.is_finite()));
}

#[test]
fn visible_and_near_infrared_alone_say_nothing_of_water() {
    let nm: Vec<f64> = (480..880).map(f64::from).collect();
    let leaf = Leaf::coupled(nm, &PLANE, Coupling::Bousquet, interior()).with_noise(1e-3, 5);
    let fit = leaf.fit(&LeafOptions::new(Method::Recommended)).unwrap();
    assert_eq!(fit.knowledge[place(Parameter::Cw)], Knowledge::PriorOnly);
    assert_eq!(fit.knowledge[place(Parameter::Cab)], Knowledge::Identified);
}

#[test]
fn what_is_held_or_tied_stays_so() {
    let leaf = Leaf::coupled(every(20), &PLANE, Coupling::Bousquet, interior()).with_noise(2e-3, 1);
    for method in [Method::Recommended, Method::TwoStep, Method::Joint] {
        let mut options = LeafOptions::new(method);
        options.car_per_cab = Some(0.2);
        options.treatments = vec![
            (place(Parameter::Cant), Treatment::Held(0.0)),
            (place(Parameter::Cbrown), Treatment::Held(0.05)),
            (place(Parameter::NStruct), Treatment::Free { bounds: Interval::new(1.2, 1.4), prior: None }),
        ];
        let fit = leaf.fit(&options).unwrap();
        let found = fit.interior();
        assert_eq!((found.cant, found.cbrown, found.car), (0.0, 0.05, 0.2 * found.cab), "{method:?}");
        assert!(found.n_struct >= 1.2 && found.n_struct <= 1.4, "{method:?} {}", found.n_struct);
        let (car, cab) = (fit.interior_se(Parameter::Car), fit.interior_se(Parameter::Cab));
        assert!((car.unwrap() - 0.2 * cab.unwrap()).abs() < 1e-12);
    }
    // the bound that the data push against is named
    let mut options = LeafOptions::new(Method::Joint);
    options.treatments =
        vec![(place(Parameter::NStruct), Treatment::Free { bounds: Interval::new(1.0, 1.3), prior: None })];
    let fit = leaf.fit(&options).unwrap();
    assert_eq!(fit.at_bound[place(Parameter::NStruct)], AtBound::Upper);
    assert_eq!(fit.knowledge[place(Parameter::NStruct)], Knowledge::AtBound);
}

#[test]
fn a_prior_pulls_by_its_width() {
    let leaf = Leaf::coupled(every(20), &PLANE, Coupling::GainOffset, interior());
    let with = |sd: f64| {
        let mut options = LeafOptions::new(Method::Recommended);
        let bounds = Interval::new(1.0, 100.0);
        options.treatments =
            vec![(place(Parameter::Cab), Treatment::Free { bounds, prior: Some(Prior::log(20.0, sd)) })];
        leaf.fit(&options).unwrap().x[place(Parameter::Cab)]
    };
    assert!((with(1e-4) / 20.0 - 1.0).abs() < 1e-3, "a narrow prior is what holds it");
    assert!(with(1e-4) < with(0.05) && with(0.05) < with(1.5));
}

// What is known beforehand has an error of its own, however large the misfit: a value that the prior decides has the prior's.
#[test]
fn a_value_known_beforehand_is_known_no_worse_afterwards() {
    let mut leaf = Leaf::coupled(every(20), &PLANE, Coupling::Bousquet, interior());
    // a misfit that k_L of single bands could follow and a leaf's contents cannot: the surface alone leaves nothing over
    for (band, values) in leaf.brdf.chunks_exact_mut(PLANE.len()).enumerate() {
        values.iter_mut().for_each(|y| *y += 5e-3 * (0.3 * band as f64).sin());
    }
    let leaf = leaf.with_noise(2e-4, 7);
    let bounds = Interval::new(0.5, 200.0);
    for sd in [1e-3, 1e-2, 0.1] {
        let mut options = LeafOptions::new(Method::Joint);
        let prior = Some(Prior::log(30.0, sd));
        options.treatments = vec![(place(Parameter::Cab), Treatment::Free { bounds, prior })];
        let fit = leaf.fit(&options).unwrap();
        let error = fit.standard_errors[place(Parameter::Cab)].unwrap();
        let known = sd * fit.interior().get(Parameter::Cab);
        // a per cent for what noise by direction adds
        assert!(error < 1.01 * known, "prior {known}, error {error}");
        assert!(sd > 5e-3 || error > 0.95 * known, "prior {known}, error {error}");
    }
}

#[test]
fn missing_values_are_left_out_and_change_nothing_else() {
    let mut leaf = Leaf::coupled(every(20), &PLANE, Coupling::Bousquet, interior());
    for place in (0..leaf.brdf.len()).step_by(7) {
        leaf.brdf[place] = f64::NAN;
    }
    let left = leaf.brdf.iter().filter(|y| !y.is_nan()).count();
    let fit = leaf.fit(&LeafOptions::new(Method::Joint)).unwrap();
    assert_eq!(fit.n_obs, left);
    recovered(&fit, &interior(), 1e-4);
    // a band without any value, and wavelengths that PROSPECT does not know
    let mut leaf = Leaf::coupled(every(20), &PLANE, Coupling::Bousquet, interior());
    leaf.brdf[..12].fill(f64::NAN);
    leaf.nm[1] = 399.0;
    leaf.nm[0] = 398.0;
    let fit = leaf.fit(&LeafOptions::new(Method::Recommended)).unwrap();
    assert_eq!(fit.wavelengths_nm[0], 440.0);
    assert_eq!(fit.bands[0], 2);
}

#[test]
fn scattered_starts_of_the_recipe_end_where_its_own_do() {
    let leaf = Leaf::coupled(every(10), &PLANE, Coupling::Bousquet, interior()).with_noise(3e-3, 9);
    let options = LeafOptions::new(Method::Recommended);
    let best = leaf.fit(&options).unwrap();
    let scatter = |share: f64, wave: f64| -> [f64; COUNT] {
        std::array::from_fn(|i| match best.treatments[i] {
            Treatment::Free { prior: Some(prior), .. } if prior.log => {
                prior.centre * (1.5 * prior.sd * (share + wave * i as f64).sin()).exp()
            }
            _ => best.x[i],
        })
    };
    for place in 0..6 {
        let mut scattered = options.clone();
        scattered.only_starts = true;
        scattered.starts = vec![scatter(place as f64, 1.7 + place as f64)];
        let fit = leaf.fit(&scattered).unwrap();
        // asked for: 0.1 % of the cost
        assert!(fit.cost < 1.001 * best.cost, "{} {}", fit.cost, best.cost);
    }
}

#[test]
fn standard_errors_of_a_joint_fit_cover_the_truth_as_often_as_they_say() {
    let truth = interior();
    let (mut within_one, mut within_two, mut count) = (0, 0, 0);
    for seed in 0..40 {
        let leaf = Leaf::coupled(every(40), &PLANE, Coupling::Bousquet, truth).with_noise(2e-3, 1000 + seed);
        let mut options = LeafOptions::new(Method::Joint);
        options.surface_from = SurfaceFrom::Surface;
        let fit = leaf.fit(&options).unwrap();
        let expected = [(0, 1.45), (1, 0.25)];
        let contents = FREE.map(|parameter| (place(parameter), truth.get(parameter)));
        for (i, sought) in expected.into_iter().chain(contents) {
            let Some(error) = fit.standard_errors[i] else { continue };
            let z = (fit.x[i] - sought).abs() / error;
            count += 1;
            within_one += usize::from(z < 1.0);
            within_two += usize::from(z < 1.96);
        }
    }
    let share = |within: usize| within as f64 / f64::from(count);
    // asked for: 60 to 76 % and 90 to 98 %; 9 parameters × 40 leaves
    assert!(count > 300, "{count}");
    assert!((0.60..0.76).contains(&share(within_one)), "{}", share(within_one));
    assert!((0.90..0.985).contains(&share(within_two)), "{}", share(within_two));
}

/// Noise is larger where more light comes from, and the few bright views are those that decide σ.
#[test]
fn a_noisy_peak_leaves_the_surfaces_standard_errors_honest() {
    let model = Prospect::new(table::full(Version::D));
    let coupled = CoupledLeaf::new(model, interior(), Coupling::Bousquet, Surface::new(1.22, 0.078).unwrap());
    // the mirror direction and its neighbours, and the rest of the plane
    let views = [60.0, 50.0, 45.0, 40.0, 35.0, 30.0, 25.0, 20.0, 10.0].map(|theta_v| (theta_v, 180.0));
    let views = [&views[..], &[(10.0, 0.0), (20.0, 0.0), (50.0, 0.0), (60.0, 0.0)]].concat();
    let nm: Vec<f64> = (480..690).step_by(5).map(f64::from).collect();
    let mut options = LeafOptions::new(Method::Joint);
    options.treatments = [Parameter::Cant, Parameter::Cbrown, Parameter::Cw]
        .map(|parameter| (place(parameter), Treatment::Held(interior().get(parameter))))
        .to_vec();
    let sought = [(0, 1.22), (1, 0.078)];
    let mut within = [[0.0; 2]; 2];
    let leaves = 300;
    for seed in 0..leaves {
        let leaf = Leaf::new(nm.clone(), &views, |band, geometry| coupled.band(band, geometry).unwrap().brdf)
            .with_noise_of(|y| (0.03 * y).hypot(0.001), 5000 + seed);
        let fit = leaf.fit(&options).unwrap();
        for ((i, truth), within) in sought.into_iter().zip(&mut within) {
            let z = (fit.x[i] - truth).abs() / fit.standard_errors[i].unwrap();
            for (within, errors) in within.iter_mut().zip([1.0, 1.96]) {
                *within += f64::from(u8::from(z <= errors)) / leaves as f64;
            }
        }
    }
    // asked for: 60 to 76 % and 90 to 98 %; 300 leaves have a sampling error of 2.7 and 1.3 %
    for ((i, _), [one, two]) in sought.into_iter().zip(within) {
        assert!((0.60..0.76).contains(&one) && (0.90..=0.985).contains(&two), "{}: {one} {two}", NAMES[i]);
    }
}

#[test]
fn a_smooth_misfit_makes_errors_larger_than_white_noise_of_the_same_size() {
    let white = Leaf::coupled(every(10), &PLANE, Coupling::Bousquet, interior()).with_noise(2e-3, 3);
    let mut smooth = Leaf::coupled(every(10), &PLANE, Coupling::Bousquet, interior());
    for (band, values) in smooth.brdf.chunks_exact_mut(12).enumerate() {
        for (v, y) in values.iter_mut().enumerate() {
            *y += 2.8e-3 * (0.03 * band as f64 + v as f64).sin();
        }
    }
    let error = |leaf: &Leaf| leaf.fit(&LeafOptions::new(Method::Joint)).unwrap().interior_se(Parameter::Cab).unwrap();
    assert!(error(&smooth) > 3.0 * error(&white));
}

#[test]
fn other_versions_know_their_own_constituents() {
    let leaf = Leaf::coupled(every(20), &PLANE, Coupling::GainOffset, interior());
    for (version, free) in [(Version::P5B, 5), (Version::D, 6), (Version::Pro, 7)] {
        let mut options = LeafOptions::new(Method::Recommended);
        options.version = version;
        let fit = leaf.fit(&options).unwrap();
        let contents =
            fit.treatments[place(Parameter::Cab)..=place(Parameter::Cbc)].iter().filter(|one| one.is_free()).count();
        assert_eq!(contents, free, "{version:?}");
        let cm = fit.interior().cm;
        assert!(cm > 0.002 && cm < 0.02, "{version:?}: {cm}");
    }
    let mut options = LeafOptions::new(Method::Joint);
    options.version = Version::P5B;
    options.treatments = vec![(place(Parameter::Cant), Treatment::Held(2.0))];
    assert!(leaf.fit(&options).unwrap_err().to_string().contains("5B"));
}

#[test]
fn negative_lambert_coefficients_are_counted_and_kept() {
    // a surface brighter than the whole leaf in the red: R − DHRF_spec < 0
    let dark = LeafParams { cab: 90.0, ..interior() };
    let model = Prospect::new(table::full(Version::D));
    let surface = Surface::new(2.2, 0.15).unwrap().with_normalization(Normalization::CookTorrance);
    let coupled = CoupledLeaf::new(model, dark, Coupling::Bousquet, surface);
    let leaf = Leaf::new(every(20), &PLANE, |band, geometry| coupled.band(band, geometry).unwrap().brdf);
    let mut options = LeafOptions::new(Method::Joint);
    options.surface.normalization = Normalization::CookTorrance;
    let fit = leaf.fit(&options).unwrap();
    let negative = fit.k_lambert.iter().filter(|k| **k < 0.0).count();
    assert!(negative > 5 && fit.negative_k_lambert() == negative);
}

#[test]
fn impossible_input_is_refused_in_words() {
    let leaf = Leaf::coupled(every(20), &PLANE, Coupling::Bousquet, interior());
    let words = |treatment: (usize, Treatment)| {
        let mut options = LeafOptions::new(Method::Joint);
        options.treatments = vec![treatment];
        leaf.fit(&options).unwrap_err().to_string()
    };
    assert!(words((place(Parameter::Cm), Treatment::Held(20.0))).contains("did you mean"));
    let wide = Treatment::Free { bounds: Interval::new(0.5, 3.0), prior: None };
    assert!(words((place(Parameter::NStruct), wide)).contains("n_struct"));
    assert!(words((0, Treatment::Held(1.4))).contains("place 0"));
    let mut elsewhere = Leaf::coupled(every(20), &PLANE, Coupling::Bousquet, interior());
    elsewhere.nm.iter_mut().for_each(|nm| *nm += 3000.0);
    let error = elsewhere.fit(&LeafOptions::new(Method::Joint)).unwrap_err().to_string();
    assert!(error.contains("400 to 2500 nm") && error.contains("3400"), "{error}");
    assert_eq!(NAMES.len(), COUNT);
    assert_eq!(PLAIN.name, "plain");
}

#[test]
fn no_second_minimum_is_deeper_than_the_result() {
    // below 880 nm N, C_w and C_m are nearly exchangeable: other minima exist. 240 bands, so that starts see a part of them
    let narrow: Vec<f64> = (0..240).map(|i| 480.0 + f64::from(i)).collect();
    for seed in 0..4 {
        let leaf = Leaf::coupled(narrow.clone(), &PLANE, Coupling::Bousquet, interior()).with_noise(3e-3, seed);
        for method in [Method::TwoStep, Method::Joint] {
            let fit = leaf.fit(&LeafOptions::new(method)).unwrap();
            assert!(fit.second.as_ref().is_none_or(|second| second.cost >= fit.cost), "{method:?} {:?}", fit.second);
        }
    }
}
