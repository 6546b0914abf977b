//! Largest relative errors against double precision.

use core::mem::MaybeUninit;

use example::text::{print, print_whole};
use leafbrdf_c::{LB_BOUSQUET_2005, lb_brdf, lb_brdf_from_degrees, lb_dhrf, lb_leaf};
use leafbrdf_core::{Angle, Dielectric, DirectionCosines, Geometry, Grade, Illumination, Leaf, Normalization, Surface};

use crate::cost::line;
use crate::inputs::{Case, Random};

pub fn all() {
    let mut random = Random(400);
    let (mut cosines, mut degrees) = ([0.0_f64; 2], [0.0_f64; 2]);
    for _ in 0..400_000 {
        let mut case = Case::draw(&mut random);
        case.leaf.k_lambert = 0.0;
        let surface = Surface::new(f64::from(case.leaf.n), f64::from(case.leaf.sigma)).expect("inside the domain");
        let leaf = Leaf::new(0.0, surface).expect("inside the domain");
        let c = case.cosines;
        let table = Geometry::from_cosines(DirectionCosines {
            cos_theta_s: f64::from(c.cos_theta_s),
            sin_theta_s: f64::from(c.sin_theta_s),
            cos_theta_v: f64::from(c.cos_theta_v),
            sin_theta_v: f64::from(c.sin_theta_v),
            cos_phi_v: f64::from(c.cos_phi_v),
        });
        let [s, v, phi] = case.degrees.map(|x| Angle::from_degrees(f64::from(x)));
        let angles = Geometry::from_angles(s, v, phi);
        let [s, v, phi] = case.degrees;
        let value = |call: &dyn Fn(Option<&mut MaybeUninit<f32>>) -> i32| {
            let mut out = MaybeUninit::zeroed();
            assert_eq!(call(Some(&mut out)), 0);
            // SAFETY: status 0
            f64::from(unsafe { out.assume_init() })
        };
        for (geometry, value, largest) in [
            (table, value(&|out| lb_brdf(Some(&case.leaf), Some(&case.cosines), out)), &mut cosines),
            (angles, value(&|out| lb_brdf_from_degrees(Some(&case.leaf), s, v, phi, out)), &mut degrees),
        ] {
            let geometry = geometry.expect("inside the domain");
            let exponent = geometry.tan2_alpha() / surface.sigma().powi(2);
            if exponent < 80.0 {
                let error = (value / leaf.brdf(&geometry) - 1.0).abs();
                let largest = &mut largest[usize::from(exponent >= 14.0)];
                *largest = largest.max(error);
            }
        }
    }
    show("lb_brdf_14", cosines[0]);
    show("lb_brdf_80", cosines[1]);
    show("lb_brdf_from_degrees_14", degrees[0]);
    show("lb_brdf_from_degrees_80", degrees[1]);

    let mut largest = 0.0_f64;
    for _ in 0..4000 {
        let sigma = 10.0_f32.powf(random.between(-2.0, 0.0));
        let (n, theta) = (random.between(1.1, 5.0), random.between(0.0, 89.0));
        let leaf = lb_leaf { k_lambert: 0.0, n, sigma, normalization: LB_BOUSQUET_2005 };
        let mut out = MaybeUninit::zeroed();
        assert_eq!(lb_dhrf(Some(&leaf), theta, Some(&mut out)), 0);
        // SAFETY: status 0
        let value = f64::from(unsafe { out.assume_init() });
        let source = Illumination::new(Angle::from_degrees(f64::from(theta))).expect("inside the domain");
        let index = Dielectric::new(f64::from(n)).expect("inside the domain");
        let exact = Normalization::Bousquet2005.factor::<f64>() * source.dhrf(index, f64::from(sigma), Grade::E10);
        largest = largest.max((value / exact - 1.0).abs());
    }
    show("lb_dhrf", largest);
}

fn show(name: &str, error: f64) {
    line("error", name);
    print_whole((error * 1e8).ceil() as u64);
    print("\n");
}
