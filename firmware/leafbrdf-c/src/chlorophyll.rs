//! Chlorophyll of a leaf whose surface is known: N and C_ab from k_L at a few wavelengths.
//!
//! min over N, C_ab of the sum of (k_L + DHRF_spec(n, sigma, 0) - R_prospect(N, C_ab, ...))^2, Eq. 17 with everything else held.
//! R is nearly straight in ln N and in ln(C_0 + C_ab), C_0 = 20 ug cm^-2 being where a leaf begins to be dark: these two are what
//! the search moves in. Derivatives are exact, wavelengths are gone through one after the other: no workspace.

use core::mem::MaybeUninit;

use leafbrdf_core::Real;
use leafbrdf_fit::solver::{Evaluation, Minimum, Objective, SolverOptions, minimize};
use leafbrdf_fit::{AtBound, Interval};
use leafbrdf_prospect::{LeafParams, plates_with_slopes};

use crate::border::slice;
use crate::hemisphere;
use crate::interior::{LB_SLICE_BANDS, LB_SLICE_FIRST_NM, LB_SLICE_STEP_NM, Wavelength, lb_interior};
use crate::number::{Number, float, number};
use crate::status::{LB_ERR_DATA, LB_ERR_INTERIOR, LB_ERR_NULL, LB_ERR_TOO_FEW, LB_ERR_WAVELENGTH, lb_status};
use crate::surface::{give, lb_leaf};

/// What lb_fit_cab finds.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct lb_cab {
    /// N, number of plates; sought from 1 to 5.
    pub n_struct: f32,
    /// C_ab, chlorophylls a + b, ug cm^-2; sought from 0 to 150.
    pub cab: f32,
    /// Standard error of N; NaN where N is at a bound or the data do not determine it.
    pub n_struct_se: f32,
    /// Standard error of C_ab, ug cm^-2; NaN as above.
    pub cab_se: f32,
    /// DHRF_spec of the surface at normal incidence, which was added to k_L.
    pub dhrf_specular: f32,
    /// Root mean square of measured - modelled reflectance, a fraction.
    pub rmse: f32,
    /// Steps of the search, over all its starts.
    pub iterations: u32,
    /// 1 where the search arrived at a minimum, 0 where it ran out of steps.
    pub converged: u32,
}

/// C_0, ug cm^-2.
const ORIGIN: f64 = 20.0;

/// The most steps of lb_fit_cab, over both its starts; a step is at most two passes over the wavelengths.
pub const LB_CAB_MOST_STEPS: u32 = 80;

/// Where the search starts, N and C_ab: green and pale.
const STARTS: [[f32; 2]; 2] = [[1.5, 40.0], [1.5, 8.0]];

/// Chlorophyll content of a leaf whose surface is known: N and C_ab from k_L at a few wavelengths (Eqs 16 to 18: the
/// interior's reflectance is k_L + DHRF_spec(n, sigma, 0)), the other contents held as given.
///
/// - surface: n, sigma and their normalization; k_lambert is not looked at.
/// - wavelengths_nm: inside the slice, in any order; between its bands the table is interpolated. Some in the red edge
///   (700 to 740 nm) and some in the near infrared, or C_ab and N stay unknown.
/// - k_lambert: k_L at these wavelengths, one value each; more than 2.
/// - bands: their number.
/// - held: the other contents; its n_struct and cab are not looked at, but must lie in their ranges.
/// - car_per_cab: C_car = car_per_cab x C_ab, 0 to 10, added to held's car; 0.25 is usual in green leaves, 0 ties nothing.
///
/// Bounded: at most LB_CAB_MOST_STEPS steps.
///
/// # Safety
/// `wavelengths_nm` and `k_lambert` point to `bands` values, or are null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lb_fit_cab(
    surface: Option<&lb_leaf>,
    wavelengths_nm: *const f32,
    k_lambert: *const f32,
    bands: u32,
    held: Option<&lb_interior>,
    car_per_cab: f32,
    cab: Option<&mut MaybeUninit<lb_cab>>,
) -> lb_status {
    let (Some(surface), Some(held), Some(out)) = (surface, held, cab) else { return LB_ERR_NULL };
    let fit = || {
        // SAFETY: the caller's promise about pointers and lengths
        let (wavelengths_nm, k_lambert) = unsafe { (slice(wavelengths_nm, bands)?, slice(k_lambert, bands)?) };
        let held = held.checked()?;
        if !(0.0..=10.0).contains(&car_per_cab) {
            return Err(LB_ERR_INTERIOR);
        }
        let dhrf_specular = hemisphere::specular(surface, number(0.0))?;
        let mut misfit = Misfit { wavelengths_nm, k_lambert, dhrf_specular, held, car_per_cab };
        misfit.check()?;
        Ok(misfit.fit())
    };
    give(out, fit())
}

struct Misfit<'a> {
    wavelengths_nm: &'a [f32],
    k_lambert: &'a [f32],
    dhrf_specular: Number,
    held: LeafParams<f32>,
    car_per_cab: f32,
}

impl Misfit<'_> {
    fn check(&self) -> Result<(), lb_status> {
        if self.k_lambert.len() < 3 {
            return Err(LB_ERR_TOO_FEW);
        }
        let last = LB_SLICE_FIRST_NM as f32 + LB_SLICE_STEP_NM as f32 * (LB_SLICE_BANDS - 1) as f32;
        if !self.wavelengths_nm.iter().all(|nm| *nm >= LB_SLICE_FIRST_NM as f32 && *nm <= last) {
            return Err(LB_ERR_WAVELENGTH);
        }
        // beyond these no k_L was meant; NaN fails as well
        if !self.k_lambert.iter().all(|k| *k >= -1.0 && *k <= 2.0) {
            return Err(LB_ERR_DATA);
        }
        Ok(())
    }

    fn fit(&mut self) -> lb_cab {
        let at = |n_struct: f32, cab: f32| [number(n_struct).ln(), (number(cab) + Number::lit(ORIGIN)).ln()];
        let (lower, upper) = (at(1.0, 0.0), at(5.0, 150.0));
        let bounds = [Interval::new(lower[0], upper[0]), Interval::new(lower[1], upper[1])];
        let options = SolverOptions {
            tolerance: Number::lit(1e-4),
            max_iterations: LB_CAB_MOST_STEPS / STARTS.len() as u32,
            // half-way from a pale leaf to a dark one
            max_step: [Number::HALF, Number::ONE],
        };
        let mut iterations = 0;
        let mut best: Option<Minimum<Number, 2>> = None;
        for [n_struct, cab] in STARTS {
            let found = minimize(self, &bounds, &at(n_struct, cab), &options);
            iterations += found.iterations;
            if best.is_none_or(|best| found.evaluation.cost < best.evaluation.cost) {
                best = Some(found);
            }
        }
        let Some(best) = best else { return self.report(&[lower[0], lower[1]], [Number::ZERO; 2], Number::ZERO) };
        let errors = standard_errors(&best, self.k_lambert.len());
        let mut report = self.report(&best.x, errors, best.evaluation.cost);
        report.iterations = iterations;
        report.converged = u32::from(best.termination.converged());
        report
    }

    /// From ln N and ln(C_0 + C_ab) with their standard errors to what the caller asked for.
    fn report(&self, x: &[Number; 2], errors: [Number; 2], cost: Number) -> lb_cab {
        let n_struct = x[0].exp();
        let shifted = x[1].exp();
        lb_cab {
            n_struct: float(n_struct),
            cab: float((shifted - Number::lit(ORIGIN)).max(Number::ZERO)),
            n_struct_se: float(errors[0] * n_struct),
            cab_se: float(errors[1] * shifted),
            dhrf_specular: float(self.dhrf_specular),
            rmse: float((cost / number(self.k_lambert.len() as f32)).sqrt()),
            iterations: 0,
            converged: 0,
        }
    }
}

/// Standard errors of x from the normal matrix and the residual variance; NaN for what is held at a bound or not determined.
fn standard_errors(minimum: &Minimum<Number, 2>, values: usize) -> [Number; 2] {
    let unknown = number(f32::NAN);
    let [[a, b], [_, c]] = minimum.evaluation.gauss_newton.map(|row| row.map(|x| Number::HALF * x));
    let free = minimum.at_bound.map(|at| at == AtBound::Free);
    let count = free.iter().filter(|free| **free).count();
    let variance = minimum.evaluation.cost / number(values.saturating_sub(count) as f32);
    let determinant = a * c - b * b;
    let error = |inverse: Number| if inverse > Number::ZERO { (variance * inverse).sqrt() } else { unknown };
    match free {
        // a determinant of a few roundings says that one parameter does for the other
        [true, true] if determinant > Number::lit(16.0) * Number::EPSILON * (a * c) => {
            [error(c / determinant), error(a / determinant)]
        }
        [true, false] => [error(Number::ONE / a), unknown],
        [false, true] => [unknown, error(Number::ONE / c)],
        _ => [unknown; 2],
    }
}

impl Objective<Number, 2> for Misfit<'_> {
    fn evaluate(&mut self, x: &[Number; 2]) -> Evaluation<Number, 2> {
        let n_struct = x[0].exp().max(Number::ONE);
        let shifted = x[1].exp();
        let cab = (shifted - Number::lit(ORIGIN)).max(Number::ZERO);
        let per_plate = Number::ONE / n_struct;
        let (mut cost, mut gradient) = (Number::ZERO, [Number::ZERO; 2]);
        let [mut nn, mut nc, mut cc] = [Number::ZERO; 3];
        for (nm, k_lambert) in self.wavelengths_nm.iter().zip(self.k_lambert) {
            let place = (*nm - LB_SLICE_FIRST_NM as f32) / LB_SLICE_STEP_NM as f32;
            let band = place as u32;
            let Some(here) = Wavelength::new(&self.held, self.car_per_cab, band as usize, place - band as f32) else {
                continue;
            };
            let k = (here.others + cab * here.cab) * per_plate;
            let (optics, slopes) = plates_with_slopes(here.faces, k, n_struct);
            let residual = number(*k_lambert) + self.dhrf_specular - optics.reflectance;
            // K = S/N: dK/dln N = -K, dK/dln(C_0 + C_ab) = k_ab (C_0 + C_ab)/N
            let by_n = slopes.dr_dn * n_struct - slopes.dr_dk * k;
            let by_cab = slopes.dr_dk * (here.cab * shifted * per_plate);
            cost += residual * residual;
            gradient[0] += residual * by_n;
            gradient[1] += residual * by_cab;
            nn += by_n * by_n;
            nc += by_n * by_cab;
            cc += by_cab * by_cab;
        }
        let normal = [[nn, nc], [nc, cc]].map(|row| row.map(|x| Number::TWO * x));
        // the curvature of R is left out: Gauss and Newton's matrix serves as the Hessian
        let gradient = [-Number::TWO * gradient[0], -Number::TWO * gradient[1]];
        Evaluation { cost, gradient, hessian: normal, gauss_newton: normal }
    }
}
