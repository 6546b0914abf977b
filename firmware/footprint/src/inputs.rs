//! Inputs of a fixed seed: the same on every board.

use leafbrdf_c::{LB_BOUSQUET_2005, lb_cosines, lb_leaf};
use leafbrdf_core::Angle;
use leafbrdf_core::real::device::F32;

/// Numbers in [0, 1) with 24 bits (Numerical Recipes' linear congruence; its low bits are the weak ones).
pub struct Random(pub u32);

impl Random {
    pub fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 8) as f32 / 16_777_216.0
    }

    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.next()
    }

    /// Mean 0, standard deviation 1, nearly normal: the sum of twelve.
    pub fn normal(&mut self) -> f32 {
        let mut sum = -6.0;
        for _ in 0..12 {
            sum += self.next();
        }
        sum
    }
}

/// A leaf and a pair of directions: θ from 1° to 79°, n from 1.1 to 2, σ from 0.05 to 0.9, as the bars of the error ask for.
#[derive(Clone, Copy)]
pub struct Case {
    pub leaf: lb_leaf,
    pub degrees: [f32; 3],
    pub cosines: lb_cosines,
}

impl Case {
    /// Half of the cases near the mirror direction, where the lobe is.
    pub fn draw(random: &mut Random) -> Case {
        let sigma = random.between(0.05, 0.9);
        let theta_s = random.between(1.0, 79.0);
        let reach = 40.0 * sigma;
        let (theta_v, phi_v) = if random.next() < 0.5 {
            (theta_s + random.between(-reach, reach), 180.0 + random.between(-reach, reach))
        } else {
            (random.between(1.0, 79.0), random.between(0.0, 360.0))
        };
        // `clamp` could panic, and an image must hold no panic
        #[allow(clippy::manual_clamp)]
        let theta_v = if theta_v < 1.0 {
            1.0
        } else if theta_v > 79.0 {
            79.0
        } else {
            theta_v
        };
        let degrees = [theta_s, theta_v, phi_v];
        let n = random.between(1.1, 2.0);
        Case {
            leaf: lb_leaf { k_lambert: random.between(0.01, 0.6), n, sigma, normalization: LB_BOUSQUET_2005 },
            degrees,
            cosines: cosines(degrees),
        }
    }
}

fn cosines(degrees: [f32; 3]) -> lb_cosines {
    let [(sin_s, cos_s), (sin_v, cos_v), (_, cos_phi)] = degrees.map(|x| Angle::from_degrees(F32(x)).sin_cos());
    lb_cosines {
        cos_theta_s: cos_s.0,
        sin_theta_s: sin_s.0,
        cos_theta_v: cos_v.0,
        sin_theta_v: sin_v.0,
        cos_phi_v: cos_phi.0,
    }
}
