//! One call of everything public, on inputs that the compiler cannot fold away.

use core::hint::black_box;

use leafbrdf_core::{
    Absorbing, Angle, Dielectric, DirectionCosines, DirectionTerms, DirectionVectors, DomainError, Geometry, GgxTerms,
    Grade, Illumination, Index, Leaf, Normalization, P1, Portable, Real, Surface, Tilt,
};
use leafbrdf_fit::band::scan::{GridSize, Scan, ScanTable};
use leafbrdf_fit::hemispherical::{
    self, Free, HemisphericalError, HemisphericalOptions, HemisphericalProblem, Measured, Spectra, n_prior,
    workspace_len,
};
use leafbrdf_fit::{Band, BandOptions, BandSolver, Directions, Interval};
use leafbrdf_prospect::{Lanes, LeafParams, Parameter, Prospect, Version, table};

/// 400–1000 nm at 10 nm.
const BANDS: usize = 61;
static SINGLE: table::TableD<f32, BANDS> = table::TableD::<f32, BANDS>::cut::<400, 10>();
static DOUBLE: table::TableD<f64, BANDS> = table::TableD::<f64, BANDS>::cut::<400, 10>();

/// Takes a result: its name and the bits of its value as an `f64` (exact for `f32` results).
pub type Print<'a> = dyn FnMut(&str, u64) + 'a;

/// Everything in single precision, the FPU's own.
pub fn single(print: &mut Print<'_>) {
    all::<f32>(print);
    all::<Portable<f32>>(print);
    inversion::<f32>(print);
    if hemispherical(print, SINGLE.view()).is_err() {
        print("error", 2);
    }
}

/// Everything in double precision, in software on this core.
pub fn double(print: &mut Print<'_>) {
    all::<f64>(print);
    all::<Portable<f64>>(print);
    inversion::<f64>(print);
    if prospect(print).is_err() {
        print("error", 1);
    }
    if hemispherical(print, DOUBLE.view()).is_err() {
        print("error", 2);
    }
}

fn all<T: Real>(print: &mut Print<'_>) {
    if let Err(error) = surface::<T>(print).and_then(|()| extended::<T>(print)).and_then(|()| hemisphere::<T>(print)) {
        print("error", 0);
        print(error.parameter, 0);
        print(error.expected, 0);
    }
}

/// An input that the compiler has to take as unknown.
fn input<T: Real>(value: f64) -> T {
    T::lit(black_box(value))
}

/// Geometry, Fresnel factor, surface, leaf and the gradients, for laurel of Table 4.
fn surface<T: Real>(print: &mut Print<'_>) -> Result<(), DomainError> {
    let mut show = |name: &str, value: T| print(name, value.to_f64().to_bits());
    let angle = |degrees: f64| Angle::<T>::from_degrees(input(degrees));

    let mirror = Geometry::from_angles(angle(60.0), angle(60.0), angle(180.0))?;
    let aside = Geometry::from_angles(angle(45.0), angle(30.0), angle(150.0))?;
    let table = Geometry::from_cosines(DirectionCosines {
        cos_theta_s: input(0.5),
        sin_theta_s: input(0.866_025_403_784_438_6),
        cos_theta_v: input(0.6),
        sin_theta_v: input(0.8),
        cos_phi_v: input(-0.9),
    })?;
    show("alpha", aside.alpha());
    show("theta_a", aside.theta_a());
    show("radians", angle(30.0).radians());
    show("tan", angle(30.0).tan());

    let dielectric = Dielectric::new(input::<T>(1.22))?;
    let (fresnel, slope) = dielectric.fresnel_with_slope(aside.cos_theta_a());
    show("fresnel", fresnel);
    show("fresnel_slope", slope);
    show("r_s", dielectric.polarized(aside.cos_theta_a()).r_s);
    let absorbing = Absorbing::new(input::<T>(1.22), input(0.1))?;
    let (fresnel, slope) = absorbing.fresnel_with_slope(aside.cos_theta_a());
    show("absorbing", fresnel);
    show("absorbing_slope", slope);
    show("r_p", absorbing.polarized(aside.cos_theta_a()).r_p);

    let laurel = Surface::new(input::<T>(1.22), input(0.078))?;
    show("mirror", laurel.brdf(&mirror));
    show("mirror_4pi", laurel.with_normalization(black_box(Normalization::CookTorrance)).brdf(&mirror));
    let rough = Surface::new(input::<T>(1.5), input(0.3))?;
    show("aside", rough.brdf(&aside));
    show("table", rough.brdf(&table));
    show("complex", Surface::absorbing(input::<T>(1.5), input(0.1), input(0.3))?.brdf(&aside));

    let gradient = Leaf::new(input(0.45), rough)?.brdf_with_gradient(&aside);
    show("leaf", gradient.value);
    show("d_k_lambert", gradient.d_k_lambert);
    show("d_n", gradient.d_n);
    show("d_sigma", gradient.d_sigma);
    show("brf", Leaf::new(input(0.45), rough)?.brf(&table));
    Ok(())
}

/// GGX facets over a P1 interior, level and tilted, with every derivative.
fn extended<T: Real>(print: &mut Print<'_>) -> Result<(), DomainError> {
    let mut show = |name: &str, value: T| print(name, value.to_f64().to_bits());
    let angle = |degrees: f64| Angle::<T>::from_degrees(input(degrees));

    let surface = Surface::ggx(input::<T>(1.5), input(0.25))?;
    let leaf = Leaf::with_diffuse(input(0.45), surface, P1::new(input(0.15), input(-0.05))?)?;
    let level = Geometry::from_angles(angle(45.0), angle(30.0), angle(150.0))?;
    show("ggx", leaf.brdf(&level));
    let terms = GgxTerms::new(&level, Normalization::CookTorrance);
    let gradient = terms.brdf_with_gradient(surface.index(), surface.sigma());
    show("ggx_d_n", gradient.d_n);
    show("ggx_d_sigma", gradient.d_sigma);

    let vectors = DirectionVectors::from_angles(angle(45.0), angle(30.0), angle(150.0))?;
    let tilted = vectors.about(&Tilt::new(angle(3.0), angle(-2.0))?)?;
    let gradient = leaf.brdf_tilted_with_gradient(&tilted);
    show("tilted", gradient.value);
    show("tilted_d_a", gradient.d_a);
    show("tilted_d_b", gradient.d_b);
    show("tilted_d_in_plane", gradient.d_in_plane);
    show("tilted_d_lateral", gradient.d_lateral);

    let illumination = Illumination::new(angle(40.0))?;
    show("ggx_dhrf_e10", surface.dhrf(&illumination, Grade::E10));
    let gradient = surface.dhrf_with_gradient(&illumination, black_box(Grade::E4d));
    show("ggx_dhrf", gradient.value);
    show("ggx_dhrf_d_n", gradient.d_n);
    show("ggx_dhrf_d_sigma", gradient.d_sigma);
    print("ggx_evaluations", illumination.evaluations_ggx(surface.sigma(), Grade::E4d) as u64);
    Ok(())
}

/// The hemispherical integral, value and gradient, in the cheapest grade and the best one.
fn hemisphere<T: Real>(print: &mut Print<'_>) -> Result<(), DomainError> {
    let mut show = |name: &str, value: T| print(name, value.to_f64().to_bits());
    let illumination = Illumination::new(Angle::<T>::from_degrees(input(40.0)))?;
    let dielectric = Dielectric::new(input::<T>(1.5))?;
    let sigma = input(0.3);
    show("dhrf_e4d", illumination.dhrf(dielectric, sigma, black_box(Grade::E4d)));
    show("dhrf_e10", illumination.dhrf(dielectric, sigma, Grade::E10));
    let gradient = illumination.dhrf_with_gradient(Absorbing::new(input::<T>(1.5), input(0.1))?, sigma, Grade::E4d);
    show("dhrf", gradient.value);
    show("dhrf_d_n", gradient.d_n);
    show("dhrf_d_sigma", gradient.d_sigma);
    print("evaluations", illumination.evaluations(sigma, Grade::E4d) as u64);
    Ok(())
}

/// Directions of the small campaign below.
const DIRECTIONS: usize = 12;

/// A grid of starts that fits a small memory.
const GRID: GridSize = GridSize { sigma: 6, n: 5 };

/// k_L, n and σ from twelve values that beech of Table 4 would give, on one lane and with all memory on the stack.
fn inversion<T: Real>(print: &mut Print<'_>) {
    if campaign::<T>(print).is_none() {
        print("error", 2);
    }
}

fn campaign<T: Real>(print: &mut Print<'_>) -> Option<()> {
    let beech = Leaf::new(input::<T>(0.45), Surface::new(input(1.56), input(0.29)).ok()?).ok()?;
    let (mut cos_theta_a, mut tan2_alpha, mut lobe) =
        ([T::ZERO; DIRECTIONS], [T::ZERO; DIRECTIONS], [T::ZERO; DIRECTIONS]);
    let mut brdf = [T::ZERO; DIRECTIONS];
    let places = cos_theta_a.iter_mut().zip(&mut tan2_alpha).zip(&mut lobe).zip(&mut brdf);
    for (i, (((cos_theta_a, tan2_alpha), lobe), brdf)) in places.enumerate() {
        let angle = |degrees: f64| Angle::<T>::from_degrees(input(degrees));
        let theta_v = angle(6.0 * i as f64);
        let geometry =
            Geometry::from_angles(angle(45.0), theta_v, angle(if i % 3 == 0 { 90.0 } else { 180.0 })).ok()?;
        let terms = DirectionTerms::new(&geometry, Normalization::Bousquet2005);
        (*cos_theta_a, *tan2_alpha, *lobe) = (terms.cos_theta_a, terms.tan2_alpha, terms.weight);
        *brdf = beech.brdf(&geometry);
    }
    let directions = Directions { cos_theta_a: &cos_theta_a, tan2_alpha: &tan2_alpha, weight: &lobe };
    let options = BandOptions::table_3();
    let mut workspace = [T::ZERO; GRID.workspace(DIRECTIONS)];
    let mut cost = [T::ZERO; GRID.points()];
    let table = ScanTable::new(GRID, options.bounds, directions, DIRECTIONS, &mut workspace)?;
    let mut solver = BandSolver::<T, 1>::new(directions, options, Scan::new(table, &mut cost)).ok()?;
    let fit = solver.fit(Band { brdf: &brdf, weight: &[T::ONE; DIRECTIONS] }, &[]).ok()??;
    for (name, value) in ["fit_k_lambert", "fit_n", "fit_sigma"].into_iter().zip(fit.parameters) {
        print(name, value.to_f64().to_bits());
    }
    print("fit_iterations", u64::from(fit.iterations));
    Some(())
}

/// One band of PROSPECT-D, in the near infrared.
fn prospect(print: &mut Print<'_>) -> Result<(), leafbrdf_prospect::Error> {
    let leaf = LeafParams {
        cab: input(40.0),
        car: input(8.0),
        cw: input(0.01),
        cm: input(0.009),
        ..LeafParams::with_n_struct(input(1.5))
    };
    let optics = Prospect::new(table::full(Version::D)).band(&leaf, black_box(400))?;
    print("reflectance", optics.reflectance.to_bits());
    print("transmittance", optics.transmittance.to_bits());
    Ok(())
}

/// N and C_ab back from the spectra that they make, N from the plateau, in memory of the caller's.
fn hemispherical<T: Lanes>(print: &mut Print<'_>, view: table::View<'_, T>) -> Result<(), HemisphericalError> {
    let model = Prospect::new(view);
    let leaf = LeafParams {
        cab: input(42.0),
        car: input(9.0),
        cw: input(0.01),
        cm: input(0.007),
        ..LeafParams::with_n_struct(input(1.6))
    };
    let (mut reflectance, mut transmittance) = ([T::ZERO; BANDS], [T::ZERO; BANDS]);
    model.spectrum(&leaf, &mut reflectance, &mut transmittance)?;
    let weights = [input::<T>(2.0); BANDS];
    let problem = HemisphericalProblem {
        model,
        spectra: Spectra {
            reflectance: Some(Measured { values: &reflectance, weights: Some(&weights) }),
            transmittance: Some(Measured { values: &transmittance, weights: None }),
        },
        held: leaf,
    };
    let free = [Parameter::NStruct, Parameter::Cab].map(Free::new);
    // away from the leaf, so that there is something to search for
    let start = LeafParams { cab: input(15.0), ..LeafParams::with_n_struct(input(2.5)) };
    let options = HemisphericalOptions { max_iterations: 12, ..HemisphericalOptions::default() };
    let mut workspace = [T::ZERO; workspace_len(2)];
    let fit = hemispherical::fit(&problem, &free, &[start], &options, &mut workspace)?;
    let mut show = |name: &str, value: T| print(name, value.to_f64().to_bits());
    show("n_struct", fit.leaf.n_struct);
    show("cab", fit.leaf.cab);
    show("n_effective", fit.n_effective);
    show("rmse", fit.rmse());
    for error in fit.standard_errors {
        show("standard_error", error.unwrap_or(T::ZERO));
    }
    show("n_prior", n_prior(&model, &reflectance, Interval::new(T::ONE, input(5.0)))?.n_struct);
    Ok(())
}

/// A bounds check that can fail: the search for panics must find it.
#[cfg(feature = "planted-panic")]
pub fn planted_panic(print: &mut Print<'_>) {
    let values = [1.0_f64, 2.0, 3.0];
    print("planted", black_box(&values)[black_box(1_usize)].to_bits());
}
