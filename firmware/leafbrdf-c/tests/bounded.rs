//! How long the searches can take: the worst case over random inputs, ordinary and absurd.

use std::mem::MaybeUninit;

use leafbrdf_c::*;

/// splitmix64.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [low, high).
    fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * (self.next() >> 40) as f32 / (1 << 24) as f32
    }
}

fn call<T>(function: impl FnOnce(Option<&mut MaybeUninit<T>>) -> lb_status) -> Result<T, lb_status> {
    let mut out = MaybeUninit::uninit();
    match function(Some(&mut out)) {
        // SAFETY: LB_OK promises that the output is written
        LB_OK => Ok(unsafe { out.assume_init() }),
        status => Err(status),
    }
}

/// What a measurement can look like.
const KINDS: u32 = 8;

fn value(random: &mut Random, kind: u32, truth: f32, i: usize) -> f32 {
    match kind {
        // a leaf as an instrument sees it, well and badly
        0 => truth + random.between(-0.003, 0.003),
        1 => truth + random.between(-0.1, 0.1),
        // a leaf without noise
        2 => truth,
        // no leaf: noise, negative values, a flat line, one spike, numbers near the ends of single precision
        3 => random.between(0.0, 1.0),
        4 => random.between(-2.0, 0.1),
        5 => 0.25,
        6 => {
            if i == 17 {
                50.0
            } else {
                0.1
            }
        }
        _ => random.between(-1.0, 1.0) * 10.0_f32.powi((random.next() % 24) as i32 - 12),
    }
}

/// The worst of 8 × 500 bands of 8 to 64 random directions.
#[test]
fn a_band_takes_at_most_its_limit_of_steps_whatever_the_data() {
    let mut random = Random(20_051);
    let (mut worst, mut unconverged) = ([0; KINDS as usize], 0);
    for round in 0..500 {
        for kind in 0..KINDS {
            let count = 8 + (random.next() % 57) as usize;
            let leaf = lb_leaf {
                k_lambert: random.between(0.0, 1.0),
                n: random.between(1.05, 3.0),
                sigma: random.between(0.01, 1.2),
                normalization: LB_BOUSQUET_2005,
            };
            let mut arrays = [const { Vec::new() }; 5];
            let theta_s = random.between(0.0, 75.0);
            for i in 0..count {
                let theta_v = random.between(0.0, 80.0);
                let phi_v = random.between(0.0, 360.0);
                let at = call(|out| lb_direction_from_degrees(theta_s, theta_v, phi_v, LB_BOUSQUET_2005, out)).unwrap();
                let truth = call(|out| lb_brdf_at(Some(&leaf), Some(&at), out)).unwrap();
                let weight = if round % 3 == 0 { random.between(0.0, 2.0) } else { 1.0 };
                let row = [at.cos_theta_a, at.tan2_alpha, at.lobe_weight, value(&mut random, kind, truth, i), weight];
                for (array, number) in arrays.iter_mut().zip(row) {
                    array.push(number);
                }
            }
            let [cos_theta_a, tan2_alpha, lobe_weight, brdf, weight] = arrays.each_ref().map(|array| array.as_ptr());
            let directions = lb_directions { cos_theta_a, tan2_alpha, lobe_weight, count: count as u32 };
            let mut workspace = lb_workspace { memory: [0.0; LB_WORKSPACE_FLOATS] };
            // SAFETY: five arrays of `count` values
            let band = call(|out| unsafe { lb_fit_band(Some(&directions), brdf, weight, None, &mut workspace, out) });
            let band = band.expect("finite data, weights not negative");
            let place = &mut worst[kind as usize];
            *place = band.iterations.max(*place);
            unconverged += 1 - band.converged;
            // whatever the data, the answer is a leaf inside the bounds
            assert!((0.01..=0.99).contains(&band.k_lambert) && (1.1..=5.0).contains(&band.n), "{kind} {band:?}");
            assert!((0.01..=1.0).contains(&band.sigma) && !band.rmse.is_nan(), "{kind} {band:?}");
        }
    }
    println!("steps, worst of each kind: {worst:?}; {unconverged} of 4000 not converged");
    assert!(worst.iter().all(|steps| *steps <= LB_BAND_MOST_STEPS), "{worst:?}");
}

/// The worst of 6,000 leaves and absurd values at 3 to 16 wavelengths.
#[test]
fn chlorophyll_takes_at_most_its_limit_of_steps_whatever_the_data() {
    let mut random = Random(2005);
    let (mut worst, mut unconverged) = (0, 0);
    for round in 0..6000 {
        let bands = 3 + (random.next() % 14) as usize;
        let wavelengths: Vec<f32> = (0..bands).map(|_| random.between(400.0, 1000.0)).collect();
        let level = random.between(-1.0, 2.0);
        let k_lambert: Vec<f32> = wavelengths
            .iter()
            .map(|nm| match round % 3 {
                // dark in the visible, bright beyond the red edge, and noise
                0 => (if *nm > 720.0 { 0.45 } else { 0.08 }) + random.between(-0.05, 0.05),
                1 => random.between(-1.0, 2.0),
                _ => level,
            })
            .collect();
        let held = lb_interior { n_struct: 1.5, cab: 0.0, car: 0.0, cant: 0.0, cbrown: 0.0, cw: 0.01, cm: 0.005 };
        let surface = lb_leaf { k_lambert: 0.0, n: 1.5, sigma: 0.3, normalization: LB_BOUSQUET_2005 };
        let (nm, k) = (wavelengths.as_ptr(), k_lambert.as_ptr());
        // SAFETY: two arrays of `bands` values
        let found =
            call(|out| unsafe { lb_fit_cab(Some(&surface), nm, k, bands as u32, Some(&held), 0.25, out) }).unwrap();
        worst = worst.max(found.iterations);
        unconverged += 1 - found.converged;
        assert!((1.0..=5.0001).contains(&found.n_struct) && (0.0..=150.01).contains(&found.cab), "{found:?}");
    }
    println!("steps, worst: {worst}; {unconverged} of 6000 not converged");
    assert!(worst <= LB_CAB_MOST_STEPS, "{worst}");
}
