//! The extended surface: GGX facets with Smith's masking, the diffuse term P1 and a tilted leaf.

use std::cell::Cell;

use leafbrdf_core::{
    Absorbing, Angle, Diffuse, DirectionVectors, Geometry, Grade, Illumination, Index, Leaf, P1, Real, Surface, Tilt,
};

use crate::{Counting, Input};

/// Double and single precision, level and tilted, and the hemispherical integral.
pub fn extended(data: &[u8]) {
    both::<f64>(&mut Input::new(data));
    both::<f32>(&mut Input::new(data));
}

fn both<T: Real>(input: &mut Input<'_>) {
    let angles = [input.around(0.0, 90.0), input.around(0.0, 90.0), input.around(-360.0, 360.0)];
    let angles = angles.map(|degrees| Angle::from_degrees(T::lit(degrees)));
    let (n, sigma) = (T::lit(input.around(1.0, 16_384.0)), T::lit(input.around(9.313_225_746_154_785e-10, 1024.0)));
    let (a, b) = (T::lit(input.around(-1.0, 1.0)), T::lit(input.around(-1.0, 1.0)));
    let tilts = [input.around(-80.0, 80.0), input.around(-80.0, 80.0)];
    let kappa = T::lit(input.within(0.0, 1e4));

    let diffuse = P1::new(a, b);
    assert_eq!(diffuse.is_ok(), a.abs() < T::ONE && b.abs() < T::ONE, "P1 of {a:?}, {b:?}");
    let Ok(surface) = Surface::ggx(n, sigma) else {
        let inside = n >= T::ONE && n <= T::lit(1e4) && sigma >= T::lit(1e-9) && sigma <= T::lit(1e3);
        assert!(!inside, "n = {n:?}, σ = {sigma:?} are in the domain");
        return;
    };
    if let Ok(source) = Illumination::new(angles[0])
        && let Ok(index) = Absorbing::new(n, kappa)
    {
        hemisphere(&source, index, sigma);
    }
    let [theta_s, theta_v, phi_v] = angles;
    let Ok(geometry) = Geometry::from_angles(theta_s, theta_v, phi_v) else {
        assert!(DirectionVectors::from_angles(theta_s, theta_v, phi_v).is_err(), "one domain for both");
        return;
    };
    let vectors = DirectionVectors::from_angles(theta_s, theta_v, phi_v).expect("one domain for both");
    let Ok(swapped) = Geometry::from_angles(theta_v, theta_s, phi_v) else { unreachable!("one domain for both") };

    let brdf = surface.brdf(&geometry);
    assert!(brdf >= T::ZERO && brdf.is_finite(), "BRDF = {brdf:?}");
    assert!(brdf.to_f64() == surface.brdf(&swapped).to_f64(), "reciprocity");
    let gradient = surface.brdf_with_gradient(&geometry);
    assert!((gradient.value.to_f64() - brdf.to_f64()).abs() <= 8.0 * T::EPSILON.to_f64() * brdf.to_f64());
    assert!(!gradient.d_n.to_f64().is_nan() && !gradient.d_sigma.to_f64().is_nan(), "{gradient:?}");

    let Ok(diffuse) = diffuse else { return };
    // positive by algebra; where a and b are within rounding of 1 so is 0
    assert!(diffuse.shape(&geometry) >= T::lit(-16.0) * T::EPSILON / (T::ONE - a), "{:?}", diffuse.shape(&geometry));
    assert!(diffuse.shape(&geometry).to_f64() == diffuse.shape(&swapped).to_f64(), "reciprocity of P1");
    tilted(&vectors, surface, diffuse, tilts);
}

/// A tilted leaf has a value wherever both directions see its upper face; in a wide inner domain every slope is finite.
fn tilted<T: Real>(
    vectors: &DirectionVectors<T>,
    surface: leafbrdf_core::GgxSurface<T>,
    diffuse: P1<T>,
    tilts: [f64; 2],
) {
    let [in_plane, lateral] = tilts.map(|degrees| Angle::from_degrees(T::lit(degrees)));
    let Ok(tilt) = Tilt::new(in_plane, lateral) else {
        assert!(!tilts.iter().all(|degrees| degrees.abs() < 79.9999), "{tilts:?} is inside");
        return;
    };
    let tilted = match vectors.about(&tilt) {
        Ok(tilted) => tilted,
        Err(error) => {
            assert!(error.parameter == "theta_s" || error.parameter == "theta_v", "{error}");
            return;
        }
    };
    assert!(tilted.factor() >= T::ZERO, "{:?}", tilted.factor());
    let geometry = tilted.geometry();
    if geometry.cos_theta_s() < T::lit(1e-3) || geometry.cos_theta_v() < T::lit(1e-3) || surface.sigma() < T::lit(1e-3)
    {
        return;
    }
    let Ok(leaf) = Leaf::with_diffuse(T::HALF, surface, diffuse) else { unreachable!("k_L = ½") };
    let at = leaf.brdf_tilted_with_gradient(&tilted);
    let value = leaf.brdf_tilted(&tilted);
    let scale = tilted.factor() * (surface.brdf(geometry) + diffuse.shape(geometry).abs());
    assert!(
        (at.value - value).abs() <= T::lit(64.0) * T::EPSILON * scale,
        "{:?} with slopes, {value:?} without",
        at.value
    );
    for slope in [at.d_k_lambert, at.d_n, at.d_sigma, at.d_a, at.d_b, at.d_in_plane, at.d_lateral] {
        assert!(slope.is_finite(), "{at:?}");
    }
}

fn hemisphere<T: Real, I: Index<T>>(source: &Illumination<T>, index: I, sigma: T) {
    for grade in Grade::ALL {
        let gradient = source.dhrf_ggx_with_gradient(index, sigma, grade);
        let value = gradient.value;
        assert!(value >= T::ZERO && value <= T::ONE, "{grade:?}: DHRF = {value:?}");
        assert!(value.to_f64() == source.dhrf_ggx(index, sigma, grade).to_f64(), "{grade:?}: without the gradient");
        assert!(gradient.d_n.is_finite() && gradient.d_sigma.is_finite(), "{grade:?}: {gradient:?}");

        // F ≡ 1 stands above every F, and the cost belongs to θ_s and σ alone
        let calls = Cell::new(0);
        let mirror = source.dhrf_ggx(Counting { calls: &calls }, sigma, grade);
        let roundings = 1.0 + 64.0 * T::EPSILON.to_f64();
        assert!(value.to_f64() <= mirror.to_f64() * roundings, "{grade:?}: {value:?} above the mirror's {mirror:?}");
        assert_eq!(calls.get(), source.evaluations_ggx(sigma, grade), "{grade:?}");
        assert!(grade != Grade::E4d || calls.get() <= 400, "E4d: {} evaluations", calls.get());
    }
}
