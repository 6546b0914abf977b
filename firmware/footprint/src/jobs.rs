//! What is measured: one job an entry point.

use core::hint::black_box;
use core::mem::MaybeUninit;

use example::text::{print, print_bits, print_whole};
use leafbrdf_c::{
    LB_BOUSQUET_2005, LB_SLICE_BANDS, LB_WORKSPACE_FLOATS, lb_band, lb_bounds, lb_brdf, lb_brdf_at,
    lb_brdf_from_degrees, lb_brdf_gradient, lb_cab, lb_cosines, lb_dhrf, lb_direction, lb_direction_from_cosines,
    lb_direction_from_degrees, lb_directions, lb_fit_band, lb_fit_cab, lb_gradient, lb_interior, lb_leaf,
    lb_prospect_slice, lb_status, lb_workspace,
};

use crate::cost::{empty, line, measure};
use crate::inputs::{Case, Random};

/// Cases of the short calls, and how often each is called.
const CASES: usize = 64;
const CALLS: u32 = 4096;
/// Values of a band: the reach of issue 6.
const VALUES: usize = 260;
/// Bands that are inverted.
const BANDS: u32 = 12;

type Out<'a, T> = Option<&'a mut MaybeUninit<T>>;

/// Where results go, and what has become of them.
struct Sink(u32);

impl Sink {
    /// FNV-1a over the bits.
    fn word(&mut self, word: u32) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u32::from(byte)).wrapping_mul(16_777_619);
        }
    }

    fn float(&mut self, value: f32) {
        self.word(if value.is_nan() { 0x7FC0_0000 } else { value.to_bits() });
    }

    fn print(self, name: &str) {
        line("bits", name);
        print_bits(self.0);
        print("\n");
    }

    fn new() -> Self {
        Sink(2_166_136_261)
    }
}

/// A value that an entry point wrote, or the bits of its status.
fn value(status: lb_status, out: MaybeUninit<f32>) -> f32 {
    if status == 0 {
        // SAFETY: status 0 says that it was written
        unsafe { out.assume_init() }
    } else {
        f32::NAN
    }
}

pub fn all() {
    evaluations();
    hemisphere();
    bands();
    interior();
}

fn evaluations() {
    let mut random = Random(2005);
    let cases: [Case; CASES] = core::array::from_fn(|_| Case::draw(&mut random));
    let at = |i: u32| black_box(&cases[i as usize % CASES]);

    type Brdf = for<'a> extern "C" fn(Option<&'a lb_leaf>, Option<&'a lb_cosines>, Out<'a, f32>) -> lb_status;
    empty!(no_brdf(Option<&lb_leaf>, Option<&lb_cosines>, Out<'_, f32>));
    measure("lb_brdf", lb_brdf as Brdf, no_brdf as Brdf, CALLS, false, |f, i| {
        let case = at(i);
        let mut out = MaybeUninit::zeroed();
        black_box(f(Some(&case.leaf), Some(&case.cosines), Some(&mut out)));
    });

    type Degrees = for<'a> extern "C" fn(Option<&'a lb_leaf>, f32, f32, f32, Out<'a, f32>) -> lb_status;
    empty!(no_degrees(Option<&lb_leaf>, f32, f32, f32, Out<'_, f32>));
    measure("lb_brdf_from_degrees", lb_brdf_from_degrees as Degrees, no_degrees as Degrees, CALLS, false, |f, i| {
        let case = at(i);
        let [s, v, phi] = case.degrees;
        let mut out = MaybeUninit::zeroed();
        black_box(f(Some(&case.leaf), s, v, phi, Some(&mut out)));
    });

    type Gradient =
        for<'a> extern "C" fn(Option<&'a lb_leaf>, Option<&'a lb_cosines>, Out<'a, lb_gradient>) -> lb_status;
    empty!(no_gradient(Option<&lb_leaf>, Option<&lb_cosines>, Out<'_, lb_gradient>));
    measure("lb_brdf_gradient", lb_brdf_gradient as Gradient, no_gradient as Gradient, CALLS, false, |f, i| {
        let case = at(i);
        let mut out = MaybeUninit::zeroed();
        black_box(f(Some(&case.leaf), Some(&case.cosines), Some(&mut out)));
    });

    let directions: [lb_direction; CASES] = core::array::from_fn(|i| {
        let mut out = MaybeUninit::zeroed();
        lb_direction_from_cosines(Some(&at(i as u32).cosines), LB_BOUSQUET_2005, Some(&mut out));
        // SAFETY: numbers, zero where nothing was written
        unsafe { out.assume_init() }
    });
    type At = for<'a> extern "C" fn(Option<&'a lb_leaf>, Option<&'a lb_direction>, Out<'a, f32>) -> lb_status;
    empty!(no_at(Option<&lb_leaf>, Option<&lb_direction>, Out<'_, f32>));
    measure("lb_brdf_at", lb_brdf_at as At, no_at as At, CALLS, false, |f, i| {
        let mut out = MaybeUninit::zeroed();
        black_box(f(Some(&at(i).leaf), Some(black_box(&directions[i as usize % CASES])), Some(&mut out)));
    });

    let mut sink = Sink::new();
    let mut random = Random(77);
    for _ in 0..4096 {
        let case = Case::draw(&mut random);
        let [s, v, phi] = case.degrees;
        let mut out = MaybeUninit::zeroed();
        sink.float(value(lb_brdf(Some(&case.leaf), Some(&case.cosines), Some(&mut out)), out));
        let mut out = MaybeUninit::zeroed();
        sink.float(value(lb_brdf_from_degrees(Some(&case.leaf), s, v, phi, Some(&mut out)), out));
    }
    sink.print("evaluations");
    edges();
}

/// What is refused, and as what: both calls of the BRDF at the edges of every argument, and of every two of them, for the first in order
/// counts. Where there is a floating-point unit these checks are not compiled but written (`leafbrdf-c/src/entry.rs`).
fn edges() {
    // bits on both sides of every bound, zeros, the ends of the range and what is no number
    const EDGES: [u32; 26] = [
        0,
        1,
        2,
        0x8000_0000,
        0x8000_0001,
        0x307F_FFFF, // 2^-30
        0x3080_0000,
        0x3F7F_FFFF, // 1
        0x3F80_0000,
        0x3F80_0001,
        0xBF80_0000,
        0xBF80_0001,
        0x42B3_FFFF, // 90
        0x42B4_0000,
        0x43B4_0000, // 360
        0x43B4_0001,
        0xC3B4_0001,
        0x4480_0000, // 2^10
        0x4480_0001,
        0x4680_0000, // 2^14
        0x4680_0001,
        0x7F7F_FFFF,
        0x7F80_0000,
        0xFF80_0000,
        0x7FC0_0000,
        0xFFFF_FFFF,
    ];
    // k_lambert, n, sigma, normalization; the directions
    const GOOD: [f32; 9] = [0.3, 1.5, 0.25, 0.0, 0.8, 0.6, 0.6, 0.8, -0.5];
    const DEGREES: [f32; 3] = [40.0, 50.0, 170.0];
    let mut sink = Sink::new();
    let mut both = |arguments: &[u32; 9], degrees: &[u32; 3]| {
        let [k_lambert, n, sigma, normalization, at @ ..] = *arguments;
        let [k_lambert, n, sigma] = [k_lambert, n, sigma].map(f32::from_bits);
        let [cos_theta_s, sin_theta_s, cos_theta_v, sin_theta_v, cos_phi_v] = at.map(f32::from_bits);
        let leaf = black_box(lb_leaf { k_lambert, n, sigma, normalization });
        let at = black_box(lb_cosines { cos_theta_s, sin_theta_s, cos_theta_v, sin_theta_v, cos_phi_v });
        let [s, v, phi] = degrees.map(f32::from_bits);
        let mut out = MaybeUninit::zeroed();
        let status = lb_brdf(Some(&leaf), Some(&at), Some(&mut out));
        sink.word(status as u32);
        sink.float(value(status, out));
        let mut out = MaybeUninit::zeroed();
        let status = lb_brdf_from_degrees(Some(&leaf), s, v, phi, Some(&mut out));
        sink.word(status as u32);
        sink.float(value(status, out));
    };
    let (good, degrees) = (GOOD.map(f32::to_bits), DEGREES.map(f32::to_bits));
    for first in 0..9 {
        // the tenth is none
        for second in first + 1..10 {
            for a in EDGES {
                for b in EDGES {
                    let (mut arguments, mut degrees) = (good, degrees);
                    // no index: an image must hold no panic
                    for (place, edge) in [(first, a), (second, b)] {
                        arguments.iter_mut().skip(place).take(1).for_each(|argument| *argument = edge);
                        degrees.iter_mut().skip(place.saturating_sub(4)).take(1).for_each(|degree| {
                            if place >= 4 {
                                *degree = edge;
                            }
                        });
                    }
                    both(&arguments, &degrees);
                    if second == 9 {
                        break;
                    }
                }
            }
        }
    }
    let case = Case::draw(&mut Random(1));
    for null in 0..3 {
        let mut out = MaybeUninit::zeroed();
        let leaf = Some(&case.leaf).filter(|_| null != 0);
        let at = Some(&case.cosines).filter(|_| null != 1);
        sink.word(lb_brdf(leaf, at, Some(&mut out).filter(|_| null != 2)) as u32);
        let mut out = MaybeUninit::zeroed();
        sink.word(lb_brdf_from_degrees(leaf, 1.0, 2.0, 3.0, Some(&mut out).filter(|_| null != 2)) as u32);
    }
    sink.print("edges");
}

fn hemisphere() {
    type Dhrf = for<'a> extern "C" fn(Option<&'a lb_leaf>, f32, Out<'a, f32>) -> lb_status;
    empty!(no_dhrf(Option<&lb_leaf>, f32, Out<'_, f32>));
    // θ_s from 0° to 88° times σ from 0.01 to 1 in equal ratios
    const ANGLES: u32 = 12;
    const ROUGHNESSES: u32 = 12;
    let at = |i: u32| {
        let mut sigma = 0.01;
        for _ in 0..i / ANGLES {
            sigma *= 1.519_911; // 100^(1/11)
        }
        let sigma = if sigma > 1.0 { 1.0 } else { sigma };
        (lb_leaf { k_lambert: 0.1, n: 1.5, sigma, normalization: LB_BOUSQUET_2005 }, (i % ANGLES) as f32 * 8.0)
    };
    measure("lb_dhrf", lb_dhrf as Dhrf, no_dhrf as Dhrf, ANGLES * ROUGHNESSES, true, |f, i| {
        let (leaf, theta_s) = at(i);
        let mut out = MaybeUninit::zeroed();
        black_box(f(Some(&leaf), theta_s, Some(&mut out)));
    });
    let mut sink = Sink::new();
    for i in 0..ANGLES * ROUGHNESSES {
        let (leaf, theta_s) = at(i);
        let mut out = MaybeUninit::zeroed();
        sink.float(value(lb_dhrf(Some(&leaf), theta_s, Some(&mut out)), out));
    }
    sink.print("hemisphere");
}

/// A goniometer's 260 directions under a lamp at 40°: 13 zenith angles times 20 azimuths.
fn direction(i: usize) -> lb_direction {
    let (theta_v, phi_v) = (2.5 + 5.5 * (i % 13) as f32, 18.0 * (i / 13) as f32);
    let mut out = MaybeUninit::zeroed();
    lb_direction_from_degrees(40.0, theta_v, phi_v, LB_BOUSQUET_2005, Some(&mut out));
    // SAFETY: numbers, zero where nothing was written
    unsafe { out.assume_init() }
}

/// A leaf of a fixed seed, and the noise of its measurement: 2 % of the value and 0.002 sr⁻¹.
fn simulate(case: u32, brdf: &mut [f32; VALUES]) {
    let mut random = Random(case.wrapping_mul(0x9E37_79B9) ^ 5);
    random.next();
    let leaf = lb_leaf {
        k_lambert: random.between(0.02, 0.6),
        n: random.between(1.2, 1.8),
        sigma: random.between(0.1, 0.6),
        normalization: LB_BOUSQUET_2005,
    };
    for (i, brdf) in brdf.iter_mut().enumerate() {
        let mut out = MaybeUninit::zeroed();
        let exact = value(lb_brdf_at(Some(&leaf), Some(&direction(i)), Some(&mut out)), out);
        *brdf = exact + (0.02 * exact + 0.002) * random.normal();
    }
}

fn bands() {
    let (mut cos_theta_a, mut tan2_alpha, mut lobe_weight) = ([0.0; VALUES], [0.0; VALUES], [0.0; VALUES]);
    for i in 0..VALUES {
        let at = direction(i);
        (cos_theta_a[i], tan2_alpha[i], lobe_weight[i]) = (at.cos_theta_a, at.tan2_alpha, at.lobe_weight);
    }
    let directions = lb_directions {
        cos_theta_a: cos_theta_a.as_ptr(),
        tan2_alpha: tan2_alpha.as_ptr(),
        lobe_weight: lobe_weight.as_ptr(),
        count: VALUES as u32,
    };
    let weight = [1.0; VALUES];
    let mut brdf = [0.0; VALUES];
    let mut workspace = lb_workspace { memory: [0.0; LB_WORKSPACE_FLOATS] };

    type Fit = for<'a> unsafe extern "C" fn(
        Option<&'a lb_directions>,
        *const f32,
        *const f32,
        Option<&'a lb_bounds>,
        *mut lb_workspace,
        Out<'a, lb_band>,
    ) -> lb_status;
    empty!(
        no_fit(Option<&lb_directions>, *const f32, *const f32, Option<&lb_bounds>, *mut lb_workspace, Out<'_, lb_band>)
    );
    let place = &raw mut workspace;
    let mut steps = 0;
    let mut sink = Sink::new();
    for case in 0..BANDS {
        simulate(case, &mut brdf);
        let name = [
            "lb_fit_band_0",
            "lb_fit_band_1",
            "lb_fit_band_2",
            "lb_fit_band_3",
            "lb_fit_band_4",
            "lb_fit_band_5",
            "lb_fit_band_6",
            "lb_fit_band_7",
            "lb_fit_band_8",
            "lb_fit_band_9",
            "lb_fit_band_10",
            "lb_fit_band_11",
        ][case as usize];
        measure(name, lb_fit_band as Fit, no_fit as Fit, 1, false, |f, _| {
            let mut out = MaybeUninit::zeroed();
            // SAFETY: arrays of 260 values, and a workspace that nothing else uses
            black_box(unsafe { f(Some(&directions), brdf.as_ptr(), weight.as_ptr(), None, place, Some(&mut out)) });
        });
        let mut out = MaybeUninit::<lb_band>::zeroed();
        // SAFETY: the same; the result is numbers, zero where nothing was written
        let band = unsafe {
            lb_fit_band(Some(&directions), brdf.as_ptr(), weight.as_ptr(), None, place, Some(&mut out));
            out.assume_init()
        };
        for number in [band.k_lambert, band.n, band.sigma, band.k_lambert_se, band.n_se, band.sigma_se, band.rmse] {
            sink.float(number);
        }
        sink.word(band.iterations);
        steps = steps.max(band.iterations);
    }
    sink.print("bands");
    line("worst", "steps_of_a_band");
    print_whole(u64::from(steps));
    print("\n");
}

fn interior() {
    let leaf = lb_interior { n_struct: 1.5, cab: 40.0, car: 8.0, cant: 0.0, cbrown: 0.0, cw: 0.01, cm: 0.009 };
    const COUNT: usize = LB_SLICE_BANDS as usize;
    let (mut reflectance, mut transmittance) = ([MaybeUninit::zeroed(); COUNT], [MaybeUninit::zeroed(); COUNT]);
    let (r, t) = (reflectance.as_mut_ptr(), transmittance.as_mut_ptr());
    type Slice = for<'a> unsafe extern "C" fn(
        Option<&'a lb_interior>,
        u32,
        u32,
        *mut MaybeUninit<f32>,
        *mut MaybeUninit<f32>,
    ) -> lb_status;
    empty!(no_slice(Option<&lb_interior>, u32, u32, *mut MaybeUninit<f32>, *mut MaybeUninit<f32>));
    measure("lb_prospect_slice", lb_prospect_slice as Slice, no_slice as Slice, 1, false, |f, _| {
        // SAFETY: room for every band
        black_box(unsafe { f(Some(&leaf), 0, LB_SLICE_BANDS, r, t) });
    });
    let mut sink = Sink::new();
    for value in reflectance.iter().chain(&transmittance) {
        // SAFETY: numbers, zero where nothing was written
        sink.float(unsafe { value.assume_init() });
    }

    // k_L of eight bands, from a green leaf's reflectance less its surface's
    let wavelengths = [500.0, 550.0, 600.0, 650.0, 680.0, 710.0, 740.0, 800.0_f32];
    let k_lambert = [0.03, 0.10, 0.06, 0.035, 0.03, 0.13, 0.36, 0.44_f32];
    let surface = lb_leaf { k_lambert: 0.0, n: 1.4, sigma: 0.3, normalization: LB_BOUSQUET_2005 };
    type Cab = for<'a> unsafe extern "C" fn(
        Option<&'a lb_leaf>,
        *const f32,
        *const f32,
        u32,
        Option<&'a lb_interior>,
        f32,
        Out<'a, lb_cab>,
    ) -> lb_status;
    empty!(no_cab(Option<&lb_leaf>, *const f32, *const f32, u32, Option<&lb_interior>, f32, Out<'_, lb_cab>));
    let mut found = MaybeUninit::<lb_cab>::zeroed();
    let place = &raw mut found;
    measure("lb_fit_cab", lb_fit_cab as Cab, no_cab as Cab, 1, false, |f, _| {
        // SAFETY: arrays of 8 values; `found` outlives the call
        black_box(unsafe {
            f(Some(&surface), wavelengths.as_ptr(), k_lambert.as_ptr(), 8, Some(&leaf), 0.25, Some(&mut *place))
        });
    });
    // SAFETY: numbers, zero where nothing was written
    let found = unsafe { found.assume_init() };
    for number in [found.n_struct, found.cab, found.n_struct_se, found.cab_se] {
        sink.float(number);
    }
    sink.print("interior");
}
