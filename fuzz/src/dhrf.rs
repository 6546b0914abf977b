//! DHRF_spec by quadrature: finite, inside [0, 1], the same with and without gradient, growing with the index as F does,
//! and at a cost that the index does not change.

use std::cell::Cell;

use leafbrdf_core::{Absorbing, Angle, Dielectric, Grade, Illumination, Index, Real};

use crate::{Counting, Input};

/// All grades, both precisions, real and complex index.
pub fn dhrf(data: &[u8]) {
    both::<f64>(&mut Input::new(data));
    both::<f32>(&mut Input::new(data));
}

fn both<T: Real>(input: &mut Input<'_>) {
    let theta_s = T::lit(input.within(0.0, 90.0));
    let sigma = T::lit(input.within(9.313_225_746_154_785e-10, 1024.0));
    let n = T::lit(input.within(1.0, 16_384.0));
    let kappa = T::lit(input.within(0.0, 1e4));
    let Ok(illumination) = Illumination::new(Angle::from_degrees(theta_s)) else {
        assert!(theta_s.to_f64() >= 90.0 - 1e-5, "θ_s = {theta_s:?} is above the horizon");
        return;
    };
    if let Ok(dielectric) = Dielectric::new(n) {
        laws(&illumination, dielectric, sigma);
    }
    if let Ok(absorbing) = Absorbing::new(n, kappa) {
        laws(&illumination, absorbing, sigma);
    }
}

fn laws<T: Real, I: Index<T>>(illumination: &Illumination<T>, index: I, sigma: T) {
    for grade in Grade::ALL {
        let value = illumination.dhrf(index, sigma, grade);
        assert!(value >= T::ZERO && value <= T::ONE, "{grade:?}: DHRF = {value:?}");
        let gradient = illumination.dhrf_with_gradient(index, sigma, grade);
        assert!(
            gradient.value.to_f64() == value.to_f64(),
            "{grade:?}: {:?} with gradient, {value:?} without",
            gradient.value
        );
        assert!(gradient.d_n.is_finite() && gradient.d_sigma.is_finite(), "{grade:?}: {gradient:?}");

        // F ≡ 1 stands above every F: no surface reflects more than the perfect mirror of the same shape
        let calls = Cell::new(0);
        let mirror = illumination.dhrf(Counting { calls: &calls }, sigma, grade);
        assert!(mirror.to_f64() <= 1.0, "{grade:?}: a perfect mirror returns {mirror:?}");
        let roundings = 1.0 + 64.0 * T::EPSILON.to_f64();
        assert!(value.to_f64() <= mirror.to_f64() * roundings, "{grade:?}: {value:?} above the mirror's {mirror:?}");

        // the cost belongs to θ_s and σ alone
        assert_eq!(calls.get(), illumination.evaluations(sigma, grade), "{grade:?}");
        if grade == Grade::E4d {
            assert!(calls.get() <= 180, "E4d: {} evaluations", calls.get());
        }
    }
}
