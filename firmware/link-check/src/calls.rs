//! One call of everything public, on inputs that the compiler cannot fold away.

use core::hint::black_box;

use leafbrdf_core::{
    Absorbing, Angle, Dielectric, DirectionCosines, DomainError, Geometry, Index, Leaf, Normalization, Portable, Real,
    Surface,
};

/// Takes a result: its name and the bits of its value as an `f64` (exact for `f32` results).
pub type Print<'a> = dyn FnMut(&str, u64) + 'a;

/// Everything in single precision, the FPU's own.
pub fn single(print: &mut Print<'_>) {
    all::<f32>(print);
    all::<Portable<f32>>(print);
}

/// Everything in double precision, in software on this core.
pub fn double(print: &mut Print<'_>) {
    all::<f64>(print);
    all::<Portable<f64>>(print);
}

fn all<T: Real>(print: &mut Print<'_>) {
    if let Err(error) = surface::<T>(print) {
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

/// A bounds check that can fail: the search for panics must find it.
#[cfg(feature = "planted-panic")]
pub fn planted_panic(print: &mut Print<'_>) {
    let values = [1.0_f64, 2.0, 3.0];
    print("planted", black_box(&values)[black_box(1_usize)].to_bits());
}
