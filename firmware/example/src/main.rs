//! An instrument in the hand: from the BRDF of a leaf at 41 directions and 8 wavelengths to k_L, n and σ with standard errors, to the
//! light that never enters the leaf (DHRF_spec), and, with the surface known, to its chlorophyll.
//!
//! ```text
//! directions ─ DirectionTerms::at_degrees ─┐
//! BRDF(λ) ──── device::fit_band ── k_L(λ), n(λ), σ(λ) ── mean n, σ: the surface (§4.3)
//!                                          ├─ DHRF(λ) = k_L + DHRF_spec (Eq. 12)
//!                                          └─ k_L(λ) with the surface held ── lb_fit_cab ── N, C_ab (Eqs 16–18)
//! ```

#![cfg_attr(target_os = "none", no_std, no_main)]

use core::hint::black_box;
use core::mem::MaybeUninit;

use example::board;
use example::measurement::{BANDS, BRDF, DIRECTIONS, DIRECTIONS_DEG, WAVELENGTHS_NM};
use example::text::{print, print_decimal, print_whole};
use leafbrdf_c::{LB_BOUSQUET_2005, LB_OK, lb_brdf, lb_cab, lb_cosines, lb_fit_cab, lb_interior, lb_leaf};
use leafbrdf_core::real::device::F32;
use leafbrdf_core::{Angle, DirectionTerms, DomainError, Grade, Illumination, Normalization, Real, Surface};
use leafbrdf_fit::device::{Fit, Workspace, fit_band};
use leafbrdf_fit::{Band, BandOptions, Directions, FitError};

/// The instrument's directions, prepared once; a product would keep them as constants in flash.
struct Head {
    cos_theta_a: [F32; DIRECTIONS],
    tan2_alpha: [F32; DIRECTIONS],
    lobe_weight: [F32; DIRECTIONS],
}

impl Head {
    fn new() -> Result<Self, DomainError> {
        let zero = [F32(0.0); DIRECTIONS];
        let mut head = Head { cos_theta_a: zero, tan2_alpha: zero, lobe_weight: zero };
        let places = head.cos_theta_a.iter_mut().zip(&mut head.tan2_alpha).zip(&mut head.lobe_weight);
        for (((cos_theta_a, tan2_alpha), lobe_weight), [theta_s, theta_v, phi_v]) in places.zip(DIRECTIONS_DEG) {
            let terms =
                DirectionTerms::at_degrees(F32(theta_s), F32(theta_v), F32(phi_v), Normalization::Bousquet2005)?;
            (*cos_theta_a, *tan2_alpha, *lobe_weight) = (terms.cos_theta_a, terms.tan2_alpha, terms.weight);
        }
        Ok(head)
    }

    fn directions(&self) -> Directions<'_, F32> {
        Directions { cos_theta_a: &self.cos_theta_a, tan2_alpha: &self.tan2_alpha, weight: &self.lobe_weight }
    }

    /// k_L of a band with the surface held: π times the mean of what the lobe leaves.
    fn k_lambert(&self, surface: &Surface<F32>, brdf: &[F32]) -> F32 {
        let mut sum = F32(0.0);
        let terms = self.cos_theta_a.iter().zip(&self.tan2_alpha).zip(&self.lobe_weight);
        for (((cos_theta_a, tan2_alpha), weight), brdf) in terms.zip(brdf) {
            let terms = DirectionTerms { cos_theta_a: *cos_theta_a, tan2_alpha: *tan2_alpha, weight: *weight };
            sum += *brdf - terms.brdf(surface.index(), surface.sigma());
        }
        F32::PI * sum / F32(DIRECTIONS as f32)
    }
}

/// One band. The report goes straight to the caller's memory: every copy on the way would cost a hundred bytes of stack.
fn invert(head: &Head, brdf: &[F32], workspace: &mut Workspace<F32>) -> Result<Option<Fit<F32>>, FitError> {
    static EVERY_VALUE_ONCE: [F32; DIRECTIONS] = [F32(1.0); DIRECTIONS];
    let band = Band { brdf, weight: &EVERY_VALUE_ONCE };
    fit_band(head.directions(), band, &BandOptions::table_3(), workspace)
}

/// Numbers of one line.
fn row(values: &[f32]) {
    for (i, value) in values.iter().enumerate() {
        print(if i == 0 { "" } else { "  " });
        print_decimal(*value);
    }
    print("\n");
}

fn instrument() -> Result<(), DomainError> {
    let head = Head::new()?;
    let theta_s = DIRECTIONS_DEG.first().map_or(0.0, |[theta_s, ..]| *theta_s);
    let source = Illumination::new(Angle::from_degrees(F32(theta_s)))?;
    let mut workspace = Workspace::new();

    print("nm  k_L +- se  n +- se  sigma +- se  rmse  DHRF\n");
    let (mut mean_n, mut mean_sigma) = (F32(0.0), F32(0.0));
    for (nm, brdf) in WAVELENGTHS_NM.iter().zip(&BRDF) {
        let Ok(Some(fit)) = &invert(&head, brdf, &mut workspace) else { continue };
        let [k_lambert, n, sigma] = fit.parameters;
        let [k_lambert_se, n_se, sigma_se] = fit.standard_errors.map(|error| error.map_or(f32::NAN, |error| error.0));
        let dhrf = k_lambert + Surface::new(n, sigma)?.dhrf(&source, Grade::E4d);
        print_whole(*nm as u64);
        print("  ");
        row(&[k_lambert.0, k_lambert_se, n.0, n_se, sigma.0, sigma_se, fit.rmse.0, dhrf.0]);
        mean_n += n;
        mean_sigma += sigma;
    }

    let bands = F32(BANDS as f32);
    let surface = Surface::new(mean_n / bands, mean_sigma / bands)?;
    print("surface: n, sigma, DHRF_spec at theta_s\n");
    row(&[surface.index().n().0, surface.sigma().0, surface.dhrf(&source, Grade::E4d).0]);

    let mut k_lambert = [0.0; BANDS];
    for (k_lambert, brdf) in k_lambert.iter_mut().zip(&BRDF) {
        *k_lambert = head.k_lambert(&surface, brdf).0;
    }
    if let Some(cab) = chlorophyll(&surface, &k_lambert) {
        print("interior: N +- se, C_ab +- se (ug/cm2), rmse\n");
        row(&[cab.n_struct, cab.n_struct_se, cab.cab, cab.cab_se, cab.rmse]);
    }
    costs(&head, &surface, &k_lambert, &source);
    Ok(())
}

/// N and C_ab, carotenoids tied to chlorophyll, water and dry matter of an ordinary leaf.
fn chlorophyll(surface: &Surface<F32>, k_lambert: &[f32; BANDS]) -> Option<lb_cab> {
    let surface =
        lb_leaf { k_lambert: 0.0, n: surface.index().n().0, sigma: surface.sigma().0, normalization: LB_BOUSQUET_2005 };
    let held = lb_interior { n_struct: 1.5, cab: 0.0, car: 0.0, cant: 0.0, cbrown: 0.0, cw: 0.01, cm: 0.005 };
    let mut cab = MaybeUninit::uninit();
    // SAFETY: both arrays hold BANDS values
    let status = unsafe {
        let (nm, k_lambert) = (WAVELENGTHS_NM.as_ptr(), k_lambert.as_ptr());
        lb_fit_cab(Some(&surface), nm, k_lambert, BANDS as u32, Some(&held), 0.25, Some(&mut cab))
    };
    // SAFETY: written where the status is LB_OK
    (status == LB_OK).then(|| unsafe { cab.assume_init() })
}

/// Instructions and stack of each step. Nothing to see on the host.
fn costs(head: &Head, surface: &Surface<F32>, k_lambert: &[f32; BANDS], source: &Illumination<F32>) {
    const TIMES: u64 = 1000;
    let cost = |name: &str, times: u64, work: &mut dyn FnMut()| {
        let instructions = board::instructions(|| {
            for _ in 0..times {
                work();
            }
        });
        let stack = board::stack(work);
        if instructions > 0 {
            print("cost: ");
            print(name);
            print(": ");
            print_whole(instructions / times);
            print(" instructions, ");
            print_whole(stack as u64);
            print(" B stack\n");
        }
    };
    let mut workspace = Workspace::new();
    cost("evaluation, prepared direction", TIMES, &mut || {
        let terms = DirectionTerms {
            cos_theta_a: black_box(F32(0.8)),
            tan2_alpha: black_box(F32(0.02)),
            weight: black_box(F32(0.5)),
        };
        black_box(terms.brdf(surface.index(), surface.sigma()));
    });
    let beech = lb_leaf { k_lambert: 0.2, n: 1.56, sigma: 0.29, normalization: LB_BOUSQUET_2005 };
    let at = lb_cosines { cos_theta_s: 0.8, sin_theta_s: 0.6, cos_theta_v: 0.6, sin_theta_v: 0.8, cos_phi_v: -0.75 };
    let mut brdf = MaybeUninit::uninit();
    cost("evaluation, cosines through C", TIMES, &mut || {
        black_box(lb_brdf(black_box(Some(&beech)), black_box(Some(&at)), Some(&mut brdf)));
    });
    cost("evaluation, degrees", TIMES, &mut || {
        let _ = black_box(surface.brdf_at_degrees(black_box(F32(45.0)), black_box(F32(30.0)), black_box(F32(150.0))));
    });
    cost("dhrf, specular", 1, &mut || {
        black_box(surface.dhrf(source, Grade::E4d));
    });
    cost("band, k_L n sigma", 1, &mut || {
        // by reference: a copy of the report would count as the fit's stack
        let fit = invert(head, black_box(&BRDF[2]), &mut workspace);
        black_box(&fit);
    });
    cost("cab, N and C_ab", 1, &mut || {
        let cab = chlorophyll(surface, k_lambert);
        black_box(&cab);
    });
}

#[cfg_attr(all(target_os = "none", target_arch = "arm"), cortex_m_rt::entry)]
#[cfg_attr(all(target_os = "none", target_arch = "riscv32"), riscv_rt::entry)]
fn main() -> ! {
    board::start();
    match instrument() {
        Ok(()) => board::exit(true),
        Err(error) => {
            print(error.parameter);
            print(": expected ");
            print(error.expected);
            print("\n");
            board::exit(false)
        }
    }
}
