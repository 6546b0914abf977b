//! Whole leaves on arbitrary small measurements, as `fit --model surface` and `--model leaf` run them: finite or a stated reason,
//! inside the bounds, no worse than a start, standard errors or the reason why not.

use leafbrdf::fit::{FitFailure, Selected, Selection, fit_leaf, fit_surface};
use leafbrdf::measurement::{Azimuth, Direction, Layout, Measurement, Metadata, Quantity};
use leafbrdf_core::{Angle, Geometry, Surface};
use leafbrdf_fit::leaf::parameters::NAMES;
use leafbrdf_fit::leaf::{self, DirectionalData, LeafFit, LeafOptions, Method, Treatment};
use leafbrdf_fit::surface::model::{N, PARAMETERS, SIGMA};
use leafbrdf_fit::surface::{self, DiffuseKind, FacetKind, ScanSize, SurfaceFit, SurfaceOptions};
use leafbrdf_fit::{AtBound, Interval};
use leafbrdf_prospect::{Coupling, Version};

use crate::Input;

/// One surface for all bands.
pub fn surface_fit(data: &[u8]) {
    let input = &mut Input::new(data);
    let mut options = surface_options(input);
    if input.flag() {
        options.starts.push([input.within(1.1, 5.0), input.within(0.01, 1.0), 0.0, 0.0, 0.0, 0.0, 0.0]);
    }
    let measured = measurement(input, &[480.0, 550.0, 670.0]);
    let fit = || {
        let selected = Selected::new(&measured, &Selection::default())?;
        fit_surface(&measured, selected, &options, Interval::new(0.01, 0.99))
    };
    let outcome = match fit() {
        Ok(outcome) => outcome,
        Err(failure) => return stated(&failure, &measured),
    };
    assert_eq!(format!("{outcome:?}"), format!("{:?}", fit().expect("it could be fitted before")), "twice the same");
    let fit = &outcome.fit;
    for i in 0..PARAMETERS {
        let (lower, upper) = match fit.parameters[i] {
            surface::Treatment::Held(value) => (value, value),
            surface::Treatment::Free { bounds, .. } => (bounds.lower, bounds.upper),
        };
        inside(fit.x[i], lower, upper, fit.at_bound[i], i);
        let known = fit.errors.knowledge[i] == surface::Knowledge::Identified;
        honest(fit.errors.standard_errors[i], known, &fit.errors);
    }
    assert!(fit.chi2 >= 0.0 && fit.rmse >= 0.0 && fit.rmse.is_finite() && !(fit.r2 > 1.0), "{fit:?}");
    assert_eq!(fit.n_obs, outcome.selected.used, "every value counts");
    for band in &fit.bands {
        assert_eq!(band.k_lambert.is_some(), band.n_obs > 0, "{band:?}");
        assert!(band.k_lambert.is_none_or(f64::is_finite) && band.squares.is_finite(), "{band:?}");
    }
    no_worse_than_its_starts(fit, &outcome.selected, &options);
    assert!(!outcome.line().is_empty() && outcome.values().bands <= outcome.selected.wavelengths_nm.len());
}

/// Surface and interior of the leaf.
pub fn leaf_fit(data: &[u8]) {
    let input = &mut Input::new(data);
    let method = [Method::Recommended, Method::TwoStep, Method::Joint][input.below(3)];
    let mut options = LeafOptions::new(method);
    options.version = [Version::D, Version::P5B, Version::Pro][input.below(3)];
    options.surface.valleys = 2;
    options.surface.scan = ScanSize { sigma: 6, n: 4, tilt: 3 };
    if method != Method::Recommended {
        let couplings = [Coupling::Bousquet, Coupling::Prospecular, Coupling::Offset, Coupling::GainOffset];
        options.coupling = couplings[input.below(4)];
        options.content_priors = input.flag();
        options.surface = surface_options(input);
        options.max_iterations = 30;
    }
    if input.flag() {
        options.car_per_cab = Some(input.within(0.05, 1.0));
    }
    // the recipe's grid, and what lies beside it or outside PROSPECT
    let grid = [440.0, 450.0, 550.0, 680.0, 705.5, 800.0, 1200.0, 1650.0, 1940.0, 2300.0, 350.0, 2600.0];
    let count = 1 + input.below(5);
    let mut nm: Vec<f64> = (0..count).map(|_| grid[input.below(grid.len())]).collect();
    nm.sort_by(f64::total_cmp);
    nm.dedup();
    let measured = measurement(input, &nm);
    let outcome = match Selected::new(&measured, &Selection::default())
        .and_then(|selected| fit_leaf(&measured, selected, &options))
    {
        Ok(outcome) => outcome,
        Err(failure) => return stated(&failure, &measured),
    };
    let fit = &outcome.fit;
    for (i, name) in NAMES.into_iter().enumerate() {
        let (lower, upper) = match fit.treatments[i] {
            Treatment::Held(value) => (value, value),
            Treatment::Free { bounds, .. } => (bounds.lower, bounds.upper),
        };
        inside(fit.x[i], lower, upper, fit.at_bound[i], name);
        let error = fit.standard_errors[i];
        assert!(error.is_none_or(|error| error >= 0.0 && error.is_finite()), "{name}: {fit:?}");
        // means over bands have their scatter as error, and are held in the second step
        let known = matches!(fit.knowledge[i], leaf::Knowledge::Identified | leaf::Knowledge::PriorOnly);
        assert!(error.is_some() || !known, "{name}: neither an error nor the reason: {fit:?}");
    }
    let sums = [fit.cost, fit.rmse];
    assert!(sums.iter().all(|sum| sum.is_finite() && *sum >= 0.0) && !(fit.r2 > 1.0), "{fit:?}");
    assert!(fit.k_lambert.iter().all(|k| k.is_finite()), "{fit:?}");
    assert!(fit.agreeing >= 1 && fit.agreeing <= fit.starts, "{} of {}", fit.agreeing, fit.starts);
    assert!(!outcome.line().is_empty() && !outcome.values().rmse.is_nan());
    if method == Method::Joint {
        no_worse_than_a_start(input, &outcome.selected, &options, fit);
    }
}

/// Facets, diffuse term, tilt, loss and convention.
fn surface_options(input: &mut Input<'_>) -> SurfaceOptions {
    let choice = input.byte();
    let mut options = if choice & 1 == 0 { SurfaceOptions::paper() } else { SurfaceOptions::paper().with_ggx() };
    options = match choice >> 1 & 3 {
        0 | 1 => options,
        2 => options.with_p1(),
        _ => options.with_p2(),
    };
    if choice >> 3 & 3 == 3 {
        options = options.with_tilt();
    }
    options.robust = choice >> 5 & 7 == 7;
    options.valleys = 2;
    options.scan = ScanSize { sigma: 6, n: 4, tilt: 3 };
    options
}

/// A few directions at a few wavelengths: a leaf that the model can make with noise on it, some values missing, some anything.
fn measurement(input: &mut Input<'_>, nm: &[f64]) -> Measurement {
    let directions: Vec<Direction> = (0..1 + input.below(7))
        .map(|_| Direction {
            theta_s_deg: input.within(0.0, 80.0),
            theta_v_deg: input.within(0.0, 75.0),
            phi_v_deg: input.within(0.0, 360.0),
        })
        .collect();
    let truth = Surface::new(input.within(1.1, 3.0), input.within(0.05, 1.0)).expect("inside");
    let noise = input.within(0.0, 0.2);
    let bands = &nm[..nm.len().min(1 + input.below(nm.len()))];
    let mut values = Vec::new();
    for band in 0..bands.len() {
        let k_lambert = input.within(0.0, 1.0);
        for direction in &directions {
            let [s, v, phi] =
                [direction.theta_s_deg, direction.theta_v_deg, direction.phi_v_deg].map(Angle::from_degrees);
            let geometry = Geometry::from_angles(s, v, phi).expect("inside");
            let leaf = k_lambert * core::f64::consts::FRAC_1_PI + truth.brdf(&geometry);
            values.push(match input.byte() {
                0 if band > 0 => f64::NAN,
                1 => input.within(-10.0, 10.0),
                byte => leaf + noise * (f64::from(byte) / 255.0 - 0.5),
            });
        }
    }
    let sd = (input.byte() % 4 == 3).then(|| values.iter().map(|_| input.within(1e-4, 0.1)).collect());
    Measurement {
        name: "fuzz".to_string(),
        sample: None,
        metadata: Metadata::new(),
        quantity: Quantity::Brdf,
        layout: Layout::Long,
        azimuth: Azimuth::Forward180,
        wavelengths_nm: bands.to_vec(),
        directions,
        values,
        sd,
    }
}

/// A refusal is one sentence, and no refusal of the model's numbers on data like these.
fn stated(failure: &FitFailure, measured: &Measurement) {
    let message = failure.to_string();
    assert!(!message.is_empty() && !message.contains('\n'), "not one sentence: {message:?}");
    assert!(!message.contains("NaN") && !message.contains("inf"), "{message:?} of {measured:?}");
}

/// In its interval, and at the end of it that it says.
fn inside(value: f64, lower: f64, upper: f64, at: AtBound, what: impl std::fmt::Debug) {
    assert!(value >= lower && value <= upper, "{what:?}: {value} outside {lower} to {upper}");
    match at {
        AtBound::Free => {}
        AtBound::Lower => assert!(value == lower, "{what:?}: {value} is not {lower}"),
        AtBound::Upper => assert!(value == upper, "{what:?}: {value} is not {upper}"),
    }
}

/// An error where it is known, and only there.
fn honest(error: Option<f64>, known: bool, of: &impl std::fmt::Debug) {
    assert_eq!(error.is_some(), known, "an error, or the reason why not: {of:?}");
    assert!(error.is_none_or(|error| error >= 0.0 && error.is_finite()), "{of:?}");
}

/// Σ ω (y − k_L/π − p)² with the best k_L in every band, for a level leaf over Lambert, from the equations alone.
fn chi2(selected: &Selected, options: &SurfaceOptions, n: f64, sigma: f64) -> f64 {
    let brdf = |geometry: &Geometry<f64>| match options.facets {
        FacetKind::Beckmann => {
            Surface::new(n, sigma).expect("inside").with_normalization(options.normalization).brdf(geometry)
        }
        FacetKind::Ggx => {
            Surface::ggx(n, sigma).expect("inside").with_normalization(options.normalization).brdf(geometry)
        }
    };
    let width = selected.geometries.len();
    let of_band = |(band, values): (usize, &[f64])| -> f64 {
        let weight =
            |i: usize| selected.sd.as_ref().map_or(1.0, |sd| 1.0 / (sd[band * width + i] * sd[band * width + i]));
        let rest: Vec<(f64, f64)> = values
            .iter()
            .zip(&selected.geometries)
            .enumerate()
            .filter(|(_, (y, _))| !y.is_nan())
            .map(|(i, (y, geometry))| (weight(i), y - brdf(geometry)))
            .collect();
        let weights: f64 = rest.iter().map(|(w, _)| w).sum();
        let mean = rest.iter().map(|(w, r)| w * r).sum::<f64>() / weights;
        rest.iter().map(|(w, r)| w * (r - mean) * (r - mean)).sum()
    };
    selected.brdf.chunks_exact(width).enumerate().map(of_band).filter(|chi2| !chi2.is_nan()).sum()
}

/// Where the cost is χ² alone: what is said is what the parameters give, and no start of the caller's is better.
fn no_worse_than_its_starts(fit: &SurfaceFit, selected: &Selected, options: &SurfaceOptions) {
    let level = fit.x[4] == 0.0 && fit.x[5] == 0.0 && !fit.parameters[4].is_free();
    if options.diffuse != DiffuseKind::Lambert || options.robust || !level {
        return;
    }
    let weights = selected.sd.iter().flatten().fold(1.0_f64, |most, sd| most.max(1.0 / (sd * sd)));
    let squares: f64 = selected.brdf.iter().filter(|y| !y.is_nan()).map(|y| (y.abs() + 1.0).powi(2)).sum();
    let found = chi2(selected, options, fit.x[N], fit.x[SIGMA]);
    // rounding of χ²: 1e-9 of it, and what is left of the squares that cancel in it
    let slack = |chi2: f64| 1e-9 * chi2 + 1e-11 * weights * squares;
    assert!((fit.chi2 - found).abs() <= slack(found), "χ² = {} said, {found} found: {fit:?}", fit.chi2);
    for start in &options.starts {
        let at_start = chi2(selected, options, start[N], start[SIGMA]);
        assert!(fit.chi2 <= at_start + slack(at_start), "started at χ² = {at_start}, ended at {}", fit.chi2);
    }
}

/// A joint search from one start of the caller's ends no higher than it began.
fn no_worse_than_a_start(input: &mut Input<'_>, selected: &Selected, options: &LeafOptions, fit: &LeafFit) {
    let mut start = fit.x;
    for (x, treatment) in start.iter_mut().zip(&fit.treatments) {
        if let Treatment::Free { bounds, .. } = treatment {
            *x = bounds.lower + (bounds.upper - bounds.lower) * (0.1 + 0.8 * f64::from(input.byte()) / 255.0);
        }
    }
    let data = DirectionalData {
        wavelengths_nm: &selected.wavelengths_nm,
        directions: &selected.vectors,
        brdf: &selected.brdf,
        sd: selected.sd.as_deref(),
    };
    let from = |max_iterations: u32| {
        let options = LeafOptions { starts: vec![start], only_starts: true, max_iterations, ..options.clone() };
        leaf::fit(&data, &options)
    };
    // a start outside the model's domain is refused
    let (Ok(begun), Ok(ended)) = (from(0), from(30)) else { return };
    assert!(ended.cost <= begun.cost * (1.0 + 1e-9), "begun at {}, ended at {}: {ended:?}", begun.cost, ended.cost);
}
