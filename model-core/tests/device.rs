//! The number of a microcontroller, `device::F32`: its functions against double precision, and the model that they give.

use leafbrdf_core::real::device::F32;
use leafbrdf_core::{
    Angle, Dielectric, DirectionCosines, DirectionTerms, Geometry, Grade, Illumination, Normalization, Real, Surface,
};

/// Largest error of `value` against `exact` in units of the last place of an `f32`, over the given arguments.
fn worst(arguments: impl Iterator<Item = f32>, value: impl Fn(f32) -> f32, exact: impl Fn(f64) -> f64) -> (f64, f32) {
    let mut worst = (0.0, 0.0);
    for x in arguments {
        let (ours, exact) = (f64::from(value(x)), exact(f64::from(x)));
        // the last place at the exact value: 2⁻²³ of its power of two
        let ulp = 2.0_f64.powi(exact.abs().log2().floor().max(-126.0) as i32 - 23);
        let error = (ours - exact).abs() / ulp;
        // NaN is an error of the largest kind
        if !(error <= worst.0) {
            worst = (error, x);
        }
    }
    worst
}

/// Numbers of every size between two bounds (of one sign): equal steps of their bits.
fn spread(from: f32, to: f32, count: u32) -> impl Iterator<Item = f32> {
    let (low, high) = (from.to_bits(), to.to_bits());
    let step = ((high - low) / count).max(1);
    (0..count).map(move |i| f32::from_bits(low + i * step)).chain([from, to])
}

#[test]
fn the_exponential_is_within_one_unit_in_the_last_place() {
    let below = spread(1e-9, 87.3, 200_000).map(|x| -x);
    let (error, at) = worst(below.chain(spread(1e-9, 87.33, 200_000)), |x| F32(x).exp().0, f64::exp);
    println!("exp: {error:.3} units at {at:e}");
    assert!(error <= 1.0, "{error} at {at:e}");
}

#[test]
fn the_exponential_keeps_its_limits() {
    for zero in [0.0, -0.0, 1e-40, -1e-40, 1e-12, -1e-12] {
        assert_eq!(F32(zero).exp().0, 1.0, "{zero:e}");
    }
    for low in [-87.4, -88.8, -1e5, f32::MIN, f32::NEG_INFINITY] {
        assert_eq!(F32(low).exp().0, 0.0, "{low:e}");
    }
    for high in [87.34, 88.73, 1e5, f32::MAX, f32::INFINITY] {
        assert_eq!(F32(high).exp().0, f32::INFINITY, "{high:e}");
    }
    assert!(F32(f32::NAN).exp().0.is_nan() && F32(-f32::NAN).exp().0.is_nan());
}

#[test]
fn sine_and_cosine_are_within_one_unit_in_the_last_place_of_any_angle() {
    // double precision reduces the argument by a π of more digits than an f32 has exponents
    for (name, arguments) in [
        ("to a turn", spread(1e-30, 6.3, 300_000).collect::<Vec<_>>()),
        ("everywhere", spread(1e-3, f32::MAX, 300_000).collect()),
        (
            "near multiples of a right angle",
            (1..2000).map(|k| (f64::from(k) * std::f64::consts::FRAC_PI_2) as f32).collect(),
        ),
    ] {
        let (sin, at_sin) = worst(arguments.iter().copied(), |x| F32(x).sin_cos().0.0, f64::sin);
        let (cos, at_cos) = worst(arguments.iter().copied(), |x| F32(x).sin_cos().1.0, f64::cos);
        println!("{name}: sin {sin:.3} at {at_sin:e}, cos {cos:.3} at {at_cos:e}");
        assert!(sin <= 1.0 && cos <= 1.0, "{name}: sin {sin} at {at_sin:e}, cos {cos} at {at_cos:e}");
        for x in arguments {
            let ((sin, cos), (minus, same)) = (F32(x).sin_cos(), F32(-x).sin_cos());
            assert_eq!((sin, cos), (-minus, same), "odd and even at {x:e}");
        }
    }
    assert_eq!(F32(0.0).sin_cos(), (F32(0.0), F32(1.0)));
    assert!(F32(f32::INFINITY).sin_cos().0.0.is_nan() && F32(f32::NAN).sin_cos().1.0.is_nan());
}

#[test]
fn arc_sine_tangent_and_logarithm_are_as_exact_as_the_documents_say() {
    let unit = spread(1e-20, 1.0, 200_000).collect::<Vec<_>>();
    let (asin, at_asin) = worst(unit.into_iter(), |x| F32(x).asin().0, f64::asin);
    let (tan, at_tan) = worst(spread(1e-20, 1.57, 200_000), |x| F32(x).tan().0, f64::tan);
    let (ln, at_ln) = worst(spread(1e-37, 1e37, 200_000), |x| F32(x).ln().0, f64::ln);
    println!("asin {asin:.3} at {at_asin:e}, tan {tan:.3} at {at_tan:e}, ln {ln:.3} at {at_ln:e}");
    assert!(asin <= 2.5, "asin: {asin} at {at_asin:e}");
    assert!(tan <= 2.5, "tan: {tan} at {at_tan:e}");
    assert!(ln <= 1.0, "ln: {ln} at {at_ln:e}");
    assert!(F32(1.000_1).asin().0.is_nan());
}

/// Reproducible numbers in [0, 1): a linear congruence (Knuth's MMIX constants).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
}

/// A surface and a pair of directions, half of them near the mirror direction; all inputs exact in `f32`.
struct Point {
    n: f32,
    sigma: f32,
    degrees: [f32; 3],
}

impl Point {
    fn draw(numbers: &mut Numbers, least_sigma: f64) -> Point {
        let theta_s = numbers.between(1.0, 79.0);
        let sigma = least_sigma * (0.9 / least_sigma).powf(numbers.next());
        let near = numbers.next() < 0.5;
        let spread = 60.0 * sigma;
        let theta_v = if near { theta_s + numbers.between(-spread, spread) } else { numbers.between(1.0, 79.0) };
        let phi_v = if near { 180.0 + numbers.between(-spread, spread) } else { numbers.between(-360.0, 360.0) };
        Point {
            n: numbers.between(1.1, 2.0) as f32,
            sigma: sigma as f32,
            degrees: [theta_s as f32, theta_v.clamp(1.0, 79.0) as f32, phi_v.clamp(-360.0, 360.0) as f32],
        }
    }

    fn geometry(&self) -> Geometry<f64> {
        let [s, v, phi] = self.degrees.map(|x| Angle::from_degrees(f64::from(x)));
        Geometry::from_angles(s, v, phi).unwrap()
    }

    fn surface(&self) -> (Surface<F32>, Surface<f64>) {
        (
            Surface::new(F32(self.n), F32(self.sigma)).unwrap(),
            Surface::new(f64::from(self.n), f64::from(self.sigma)).unwrap(),
        )
    }

    fn cosines(&self) -> DirectionCosines<f32> {
        let [(ss, cs), (sv, cv), (_, cos_phi_v)] = self.degrees.map(|x| {
            let (sin, cos) = f64::from(x).to_radians().sin_cos();
            (sin as f32, cos as f32)
        });
        DirectionCosines { cos_theta_s: cs, sin_theta_s: ss, cos_theta_v: cv, sin_theta_v: sv, cos_phi_v }
    }
}

fn convert<T>(d: DirectionCosines<f32>, to: impl Fn(f32) -> T) -> DirectionCosines<T> {
    DirectionCosines {
        cos_theta_s: to(d.cos_theta_s),
        sin_theta_s: to(d.sin_theta_s),
        cos_theta_v: to(d.cos_theta_v),
        sin_theta_v: to(d.sin_theta_v),
        cos_phi_v: to(d.cos_phi_v),
    }
}

/// The bars of the device: 1e-5 where tan²α/σ² < 14, 2.5e-5 where < 80, from angles (σ ≥ 0.01) and from cosines (σ ≥ 0.05).
#[test]
fn the_direct_evaluations_keep_the_bars_of_the_device() {
    for (name, from_degrees, least_sigma) in [("degrees", true, 0.01), ("cosines", false, 0.05)] {
        let mut numbers = Numbers(2005);
        let mut largest = [0.0_f64; 2];
        let mut counted = [0; 2];
        for _ in 0..400_000 {
            let point = Point::draw(&mut numbers, least_sigma);
            let (device, exact) = point.surface();
            let (value, geometry) = if from_degrees {
                let [s, v, phi] = point.degrees.map(F32);
                (device.brdf_at_degrees(s, v, phi).unwrap(), point.geometry())
            } else {
                let d = point.cosines();
                (
                    device.brdf_at_cosines(&convert(d, F32)).unwrap(),
                    Geometry::from_cosines(convert(d, f64::from)).unwrap(),
                )
            };
            let exponent = geometry.tan2_alpha() / exact.sigma().powi(2);
            if exponent >= 80.0 {
                continue;
            }
            let class = usize::from(exponent >= 14.0);
            counted[class] += 1;
            let error = (value.to_f64() / exact.brdf(&geometry) - 1.0).abs();
            assert!(error.is_finite(), "{name} {:?} {} {}: {value:?}", point.degrees, point.n, point.sigma);
            largest[class] = largest[class].max(error);
        }
        println!("{name}: {:.2e} below 14 ({}), {:.2e} below 80 ({})", largest[0], counted[0], largest[1], counted[1]);
        assert!(counted[0] > 100_000 && counted[1] > 30_000);
        assert!(largest[0] <= 1e-5 && largest[1] <= 2.5e-5, "{name}: {largest:?}");
    }
}

/// In double precision the direct form is the general one but for rounding: some 50 roundings of 1.1e-16, amplified by the
/// exponent (80) and by 1/cos at 79°.
#[test]
fn the_direct_form_is_the_general_one() {
    let mut numbers = Numbers(7);
    for _ in 0..20_000 {
        let point = Point::draw(&mut numbers, 0.05);
        for normalization in [Normalization::Bousquet2005, Normalization::CookTorrance] {
            let surface = point.surface().1.with_normalization(normalization);
            let cosines = convert(point.cosines(), f64::from);
            // sines and cosines that belong together to the last bit, not to f32's
            let pair = |cos: f64| (1.0 - cos * cos).sqrt();
            let cosines = DirectionCosines {
                sin_theta_s: pair(cosines.cos_theta_s),
                sin_theta_v: pair(cosines.cos_theta_v),
                ..cosines
            };
            let geometry = Geometry::from_cosines(cosines).unwrap();
            if geometry.tan2_alpha() / surface.sigma().powi(2) > 80.0 {
                continue;
            }
            let (direct, general) = (surface.brdf_at_cosines(&cosines).unwrap(), surface.brdf(&geometry));
            assert!((direct / general - 1.0).abs() < 1e-12, "{direct:e} {general:e} {cosines:?}");
            let terms = DirectionTerms::at_cosines(&cosines, normalization).unwrap();
            let same = DirectionTerms::new(&geometry, normalization);
            for (a, b) in [
                (terms.cos_theta_a, same.cos_theta_a),
                (terms.tan2_alpha, same.tan2_alpha),
                (terms.weight, same.weight),
            ] {
                assert!((a - b).abs() <= 1e-13 * b.abs(), "{a:e} {b:e}");
            }
        }
    }
}

#[test]
fn what_lies_outside_the_domain_is_refused() {
    let surface = Surface::new(F32(1.5), F32(0.3)).unwrap();
    for [s, v, phi] in [
        [90.0, 10.0, 0.0],
        [-1.0, 10.0, 0.0],
        [10.0, 90.0, 0.0],
        [10.0, f32::NAN, 0.0],
        [10.0, 10.0, 360.1],
        [10.0, 10.0, f32::NAN],
    ] {
        assert!(surface.brdf_at_degrees(F32(s), F32(v), F32(phi)).is_err(), "{s} {v} {phi}");
    }
    let good = DirectionCosines {
        cos_theta_s: F32(0.6),
        sin_theta_s: F32(0.8),
        cos_theta_v: F32(0.8),
        sin_theta_v: F32(0.6),
        cos_phi_v: F32(-1.0),
    };
    assert!(surface.brdf_at_cosines(&good).is_ok());
    for bad in [
        DirectionCosines { cos_theta_s: F32(0.0), ..good },
        DirectionCosines { cos_theta_v: F32(1.1), ..good },
        DirectionCosines { sin_theta_v: F32(-0.6), ..good },
        DirectionCosines { sin_theta_s: F32(f32::NAN), ..good },
        DirectionCosines { cos_phi_v: F32(-1.1), ..good },
    ] {
        assert!(surface.brdf_at_cosines(&bad).is_err(), "{bad:?}");
    }
}

/// Everything the constructors accept, down to σ = 10⁻⁹, n = 10⁴ and the horizon, gives a number, and none below 0.
#[test]
fn every_accepted_input_gives_a_finite_and_non_negative_value() {
    let mut numbers = Numbers(11);
    for _ in 0..200_000 {
        let n = F32((1.0 + 10.0_f64.powf(numbers.between(-9.0, 3.99))) as f32);
        let sigma = F32(10.0_f64.powf(numbers.between(-8.9, 2.9)) as f32);
        let zenith = |numbers: &mut Numbers| F32((90.0 - 10.0_f64.powf(numbers.between(-5.0, 1.95))) as f32);
        let (s, v) = (zenith(&mut numbers), zenith(&mut numbers));
        let v = if numbers.next() < 0.3 { s } else { v };
        let phi = F32(if numbers.next() < 0.3 { 180.0 } else { numbers.between(-360.0, 360.0) as f32 });
        let surface = Surface::new(n, sigma).unwrap();
        let value = surface.brdf_at_degrees(s, v, phi).unwrap();
        assert!(value.0 >= 0.0 && value.0.is_finite(), "{n:?} {sigma:?} {s:?} {v:?} {phi:?}: {value:?}");
    }
}

/// DHRF with the device's numbers: the quadrature's error in `f32`, 1e-5 (E4d) and 1.8e-6 (E6), with a margin for
/// our functions' own.
#[test]
fn the_hemispherical_integral_is_as_exact_as_in_plain_single_precision() {
    let mut numbers = Numbers(3);
    let mut largest = [0.0_f64; 2];
    for _ in 0..4000 {
        let theta = numbers.between(0.0, 89.0) as f32;
        let (n, sigma) = (numbers.between(1.1, 5.0) as f32, 10.0_f64.powf(numbers.between(-2.0, 0.0)) as f32);
        let exact = Illumination::new(Angle::from_degrees(f64::from(theta))).unwrap().dhrf(
            Dielectric::new(f64::from(n)).unwrap(),
            f64::from(sigma),
            Grade::E10,
        );
        let source = Illumination::new(Angle::from_degrees(F32(theta))).unwrap();
        for (largest, grade) in largest.iter_mut().zip([Grade::E4d, Grade::E6]) {
            let value = source.dhrf(Dielectric::new(F32(n)).unwrap(), F32(sigma), grade);
            *largest = largest.max((value.to_f64() / exact - 1.0).abs());
        }
    }
    println!("DHRF: {largest:?}");
    assert!(largest[0] < 1.2e-5 && largest[1] < 2.5e-6, "{largest:?}");
}
