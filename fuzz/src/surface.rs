//! The surface model: inside its domain every value is finite, not negative, reciprocal to the last bit and symmetric in
//! the azimuth; outside, there is an error and no value.

use leafbrdf_core::{
    Absorbing, Angle, Dielectric, DomainError, Geometry, Index, Leaf, Normalization, Polarized, Real, Surface,
};

use crate::Input;

/// [`Surface`] and [`Leaf`] with a real index in double precision.
pub fn surface_f64(data: &[u8]) {
    real_index::<f64>(&mut Input::new(data));
}

/// [`Surface`] and [`Leaf`] with a real index in single precision.
pub fn surface_f32(data: &[u8]) {
    real_index::<f32>(&mut Input::new(data));
}

/// [`Surface`] with a complex index, in both precisions.
pub fn surface_complex(data: &[u8]) {
    complex_index::<f64>(&mut Input::new(data));
    complex_index::<f32>(&mut Input::new(data));
}

/// One case: a pair of directions in degrees, as files have them, rounded to `T` first.
struct Case<T> {
    theta_s: T,
    theta_v: T,
    phi_v: T,
}

impl<T: Real> Case<T> {
    fn read(input: &mut Input<'_>) -> Self {
        Case {
            theta_s: T::lit(input.around(0.0, 90.0)),
            theta_v: T::lit(input.around(0.0, 90.0)),
            phi_v: T::lit(input.around(-360.0, 360.0)),
        }
    }

    fn geometry(&self) -> Result<Geometry<T>, DomainError> {
        let [theta_s, theta_v, phi_v] = [self.theta_s, self.theta_v, self.phi_v].map(Angle::from_degrees);
        Geometry::from_angles(theta_s, theta_v, phi_v)
    }

    /// Whether the directions are above the horizon; `None` where either answer will do: −0.0 and what becomes it in
    /// radians, and a φ_v that exceeds a turn by no more than rounding.
    fn in_domain(&self) -> Option<bool> {
        let theta = |theta: T| match theta.to_f64() {
            degrees if (0.0..90.0).contains(&degrees) => Some(true),
            degrees if degrees < 0.0 && degrees > -1e-30 => None,
            _ => Some(false),
        };
        let phi = match self.phi_v.to_f64().abs() {
            degrees if degrees <= 360.0 => Some(true),
            degrees if degrees <= 360.001 => None,
            _ => Some(false),
        };
        all(&[theta(self.theta_s), theta(self.theta_v), phi])
    }
}

/// Whether `value` lies in [low, high], the ends rounded to `T`.
fn domain<T: Real>(value: T, low: f64, high: f64) -> Option<bool> {
    Some(value >= T::lit(low) && value <= T::lit(high))
}

/// False where one is false; unknown where one is unknown and none is false.
fn all(parts: &[Option<bool>]) -> Option<bool> {
    if parts.contains(&Some(false)) {
        Some(false)
    } else if parts.contains(&None) {
        None
    } else {
        Some(true)
    }
}

/// The constructor's answer agrees with the domain.
fn agrees<V>(made: &Result<V, DomainError>, expected: Option<bool>, what: &str) {
    if let Some(expected) = expected {
        assert_eq!(made.is_ok(), expected, "{what}");
    }
    if let Err(error) = made {
        assert!(!error.parameter.is_empty() && !error.expected.is_empty(), "{what}: an error that says nothing");
    }
}

/// Same number, same sign of zero.
fn same_bits<T: Real>(a: T, b: T) -> bool {
    a.to_f64().to_bits() == b.to_f64().to_bits()
}

fn real_index<T: Real>(input: &mut Input<'_>) {
    let case = Case::<T>::read(input);
    let n = T::lit(input.around(1.0, 16_384.0));
    let sigma = T::lit(input.around(9.313_225_746_154_785e-10, 1024.0));
    let k_lambert = T::lit(input.around(0.0, 1.0));

    let dielectric = Dielectric::new(n);
    agrees(&dielectric, domain(n, 1.0, 16_384.0), "n");
    let surface = Surface::new(n, sigma);
    agrees(&surface, all(&[domain(n, 1.0, 16_384.0), domain(sigma, 9.313_225_746_154_785e-10, 1024.0)]), "n, sigma");
    if let (Ok(dielectric), Ok(geometry)) = (dielectric, case.geometry()) {
        fresnel_laws(dielectric, dielectric.polarized(geometry.cos_theta_a()), &geometry);
    }
    let Ok(surface) = surface else { return };
    laws(&case, &surface);

    let leaf = Leaf::new(k_lambert, surface);
    agrees(&leaf, domain(k_lambert, 0.0, 1.0), "k_lambert");
    if let (Ok(leaf), Ok(geometry)) = (leaf, case.geometry()) {
        let brdf = leaf.brdf(&geometry);
        assert!(brdf.is_finite() && brdf >= surface.brdf(&geometry), "a leaf is at least as bright as its surface");
        assert!(leaf.brf(&geometry) >= brdf, "BRF is π BRDF");
    }
}

fn complex_index<T: Real>(input: &mut Input<'_>) {
    let case = Case::<T>::read(input);
    let n = T::lit(input.around(1.0, 16_384.0));
    let kappa = T::lit(input.around(0.0, 1e4));
    let sigma = T::lit(input.around(9.313_225_746_154_785e-10, 1024.0));

    let absorbing = Absorbing::new(n, kappa);
    let index_domain = all(&[domain(n, 1.0, 16_384.0), domain(kappa, 0.0, 1e4)]);
    agrees(&absorbing, index_domain, "n, kappa");
    let surface = Surface::absorbing(n, kappa, sigma);
    agrees(&surface, all(&[index_domain, domain(sigma, 9.313_225_746_154_785e-10, 1024.0)]), "n, kappa, sigma");
    if let (Ok(absorbing), Ok(geometry)) = (absorbing, case.geometry()) {
        fresnel_laws(absorbing, absorbing.polarized(geometry.cos_theta_a()), &geometry);
    }
    if let Ok(surface) = surface {
        laws(&case, &surface);
    }
}

/// R_s, R_p and F lie in [0, 1]. A few roundings are allowed above 1, where a metal reflects everything.
fn fresnel_laws<T: Real, I: Index<T>>(index: I, polarized: Polarized<T>, geometry: &Geometry<T>) {
    let most = T::ONE + T::lit(16.0) * T::EPSILON;
    let (fresnel, slope) = index.fresnel_with_slope(geometry.cos_theta_a());
    for (name, value) in [("F", fresnel), ("R_s", polarized.r_s), ("R_p", polarized.r_p)] {
        assert!(value >= T::ZERO && value <= most, "{name} = {value:?}");
    }
    assert!(same_bits(fresnel, index.fresnel(geometry.cos_theta_a())), "F is the same with and without its slope");
    assert!(slope.is_finite(), "∂F/∂n = {slope:?}");
}

/// What holds for any index.
fn laws<T: Real, I: Index<T>>(case: &Case<T>, surface: &Surface<T, I>) {
    let geometry = case.geometry();
    agrees(&geometry, case.in_domain(), "directions");
    let Ok(geometry) = geometry else { return };

    assert!(geometry.cos_theta_a() > T::ZERO && geometry.cos_theta_a() <= T::ONE, "{geometry:?}");
    assert!(geometry.tan2_alpha() >= T::ZERO && geometry.tan2_alpha().is_finite(), "{geometry:?}");
    // the angles are in their ranges, one rounding of π/2 allowed
    let quarter_turn = T::HALF * T::PI * (T::ONE + T::EPSILON);
    for angle in [geometry.alpha(), geometry.theta_a()] {
        assert!(angle >= T::ZERO && angle <= quarter_turn, "{angle:?} of {geometry:?}");
    }

    let brdf = surface.brdf(&geometry);
    assert!(brdf.is_finite() && brdf >= T::ZERO, "BRDF = {brdf:?}");

    // Helmholtz: source and view change places, and not one bit moves
    let swapped = Case { theta_s: case.theta_v, theta_v: case.theta_s, phi_v: case.phi_v };
    let swapped = swapped.geometry().expect("both zenith angles have the same domain");
    assert!(same_bits(brdf, surface.brdf(&swapped)), "reciprocity: {brdf:?} and {:?}", surface.brdf(&swapped));

    // the leaf has no left and right
    let mirrored = Case { phi_v: -case.phi_v, ..*case };
    let mirrored = mirrored.geometry().expect("the domain of φ_v is symmetric");
    assert!(same_bits(brdf, surface.brdf(&mirrored)), "φ and −φ: {brdf:?} and {:?}", surface.brdf(&mirrored));

    // K = 2π² against 4π: 2/π of it, but for the rounding of that factor (absolutely, where both are subnormal)
    let printed = surface.with_normalization(Normalization::Bousquet2005).brdf(&geometry).to_f64();
    let derived = surface.with_normalization(Normalization::CookTorrance).brdf(&geometry).to_f64();
    let difference = (printed - core::f64::consts::FRAC_2_PI * derived).abs();
    assert!(difference <= 8.0 * T::EPSILON.to_f64() * derived + 1e-30, "{printed} {derived}");
}
