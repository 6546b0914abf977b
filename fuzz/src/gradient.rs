//! The exact derivatives: finite everywhere, and equal to differences of the model where those mean something.

use leafbrdf_core::{Angle, Beckmann, Geometry, Index, Leaf, Real, Surface, VCavity};

use crate::{Input, Mirror};

/// The gradient of the leaf BRDF in double and single precision, and of the surface with a complex index.
pub fn gradient(data: &[u8]) {
    let input = || Input::new(data);
    finite::<f64>(&mut input());
    finite::<f32>(&mut input());
    against_differences(&mut input());
}

fn geometry<T: Real>(input: &mut Input<'_>, highest_deg: f64) -> Option<Geometry<T>> {
    let mut angle = |low, high| Angle::from_degrees(T::lit(input.within(low, high)));
    Geometry::from_angles(angle(0.0, highest_deg), angle(0.0, highest_deg), angle(-360.0, 360.0)).ok()
}

/// On the whole domain: finite where the number type can hold it, and the value is that of the plain evaluation.
fn finite<T: Real>(input: &mut Input<'_>) {
    let Some(geometry) = geometry::<T>(input, 90.0) else { return };
    let n = T::lit(input.within(1.0, 16_384.0));
    let sigma = T::lit(input.within(9.313_225_746_154_785e-10, 1024.0));
    let k_lambert = T::lit(input.within(0.0, 1.0));
    let kappa = T::lit(input.within(0.0, 1e4));

    if let Ok(surface) = Surface::new(n, sigma)
        && let Ok(leaf) = Leaf::new(k_lambert, surface)
    {
        let gradient = leaf.brdf_with_gradient(&geometry);
        assert!(gradient.value.to_f64() == leaf.brdf(&geometry).to_f64(), "the value is that of the plain evaluation");
        assert!(gradient.d_k_lambert > T::ZERO && gradient.d_k_lambert < T::ONE, "∂/∂k_L = 1/π");
        slopes(&geometry, &surface);
    }
    if let Ok(surface) = Surface::absorbing(n, kappa, sigma) {
        slopes(&geometry, &surface);
    }
}

/// Near σ = 2⁻³⁰ and the horizon the true derivatives exceed the largest `f32`: infinite then, but never NaN.
fn slopes<T: Real, I: Index<T>>(geometry: &Geometry<T>, surface: &Surface<T, I>) {
    let gradient = surface.brdf_with_gradient(geometry);
    assert!(gradient.value.to_f64() == surface.brdf(geometry).to_f64(), "the value is that of the plain evaluation");

    // the same lobe with F ≡ 1
    let mirror = Surface::with_parts(Mirror, surface.sigma(), Beckmann, VCavity).expect("the same σ");
    let lobe = mirror.with_normalization(surface.normalization()).brdf(geometry).to_f64();
    let (_, fresnel_slope) = surface.index().fresnel_with_slope(geometry.cos_theta_a());
    holds(gradient.d_n, lobe * fresnel_slope.to_f64(), "∂/∂n");

    let (sigma, tan2_alpha) = (surface.sigma().to_f64(), geometry.tan2_alpha().to_f64());
    holds(gradient.d_sigma, gradient.value.to_f64() * 2.0 / sigma * (tan2_alpha / (sigma * sigma) - 1.0), "∂/∂σ");
}

/// Finite where its size, in double precision, says that `T` can hold it.
fn holds<T: Real>(slope: T, size: f64, what: &str) {
    assert!(!slope.to_f64().is_nan(), "{what} is NaN, not about {size}");
    assert!(slope.is_finite() || size.abs() > 0.99 * T::MAX.to_f64(), "{what} = {slope:?}, not about {size}");
}

/// Central differences in f64, away from the edges (n → 1, σ → 0, the far tail of the lobe, the horizon), where the
/// truncation error h²/6 · f‴ is below 1e-5 of the derivative's scale and cancellation below 1e-8.
fn against_differences(input: &mut Input<'_>) {
    let Some(geometry) = geometry::<f64>(input, 85.0) else { return };
    let n = input.within(1.02, 3.0);
    let sigma = input.within(0.05, 2.0);
    let kappa = input.within(0.01, 2.0);
    if geometry.tan2_alpha() / (sigma * sigma) > 50.0 {
        return;
    }
    compare(&geometry, |n, sigma| Surface::new(n, sigma).expect("inside"), n, sigma);
    compare(&geometry, |n, sigma| Surface::absorbing(n, kappa, sigma).expect("inside"), n, sigma);
}

fn compare<I: Index<f64>>(geometry: &Geometry<f64>, surface: impl Fn(f64, f64) -> Surface<f64, I>, n: f64, sigma: f64) {
    let gradient = surface(n, sigma).brdf_with_gradient(geometry);
    let brdf = |n, sigma| surface(n, sigma).brdf(geometry);

    // The scale on which F changes is n − 1 or more; that on which the lobe does is σ/(2 tan²α/σ²), at least σ/100.
    let step_n = 1e-4 * (n - 1.0);
    let difference_n = (brdf(n + step_n, sigma) - brdf(n - step_n, sigma)) / (2.0 * step_n);
    close(gradient.d_n, difference_n, gradient.value / (n - 1.0), "∂/∂n");

    let step_sigma = 2e-6 * sigma;
    let difference_sigma = (brdf(n, sigma + step_sigma) - brdf(n, sigma - step_sigma)) / (2.0 * step_sigma);
    close(gradient.d_sigma, difference_sigma, gradient.value * 100.0 / sigma, "∂/∂σ");
}

/// Within 1e-6 of the derivative's natural scale (value over the length on which the value changes).
fn close(exact: f64, difference: f64, scale: f64, what: &str) {
    assert!((exact - difference).abs() <= 1e-6 * scale + 1e-300, "{what}: exact {exact}, by differences {difference}");
}
