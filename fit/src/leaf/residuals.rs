//! How the model errors of neighbouring wavelengths resemble each other, and residuals made independent.
//!
//! C_ij = s² exp(−|λ_i − λ_j|/ℓ) + w² δ_ij: a slow part that forgets exponentially, and white noise. Its Cholesky factor is never
//! built. The slow part is a Markov chain, so the innovations of a scalar Kalman filter, each over its standard deviation, are
//! exactly L⁻¹r: a few operations a band instead of a row of a matrix.
//!
//! A third part is one shape φ over all wavelengths with an unknown amplitude c ~ N(0, v²), C + v² φφᵀ: the same as c fitted with
//! that prior, without a parameter more. With ψ = v L⁻¹φ and q = ψᵀψ, (1 + ψψᵀ)^(−½) = 1 − (1 − 1/√(1 + q)) ψψᵀ/q.

use std::vec::Vec;

/// The residuals' covariance over the wavelengths of one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResidualModel {
    /// s: standard deviation of the slow part, in reflectance; 0 without one.
    pub slow_sd: f64,
    /// ℓ: the wavelength distance after which 1/e of it is left, nm.
    pub length_nm: f64,
    /// w: standard deviation of the white part, in reflectance.
    pub white_sd: f64,
    /// v: standard deviation of a part that follows the first surface's reflectance ρ(λ) = 1 − t_av(40°, n(λ)) as far as that
    /// departs from its mean, φ = ρ/mean(ρ) − 1, in reflectance; 0 without one.
    pub surface_sd: f64,
}

impl ResidualModel {
    /// Independent residuals, all with this standard deviation.
    pub const fn white(sd: f64) -> Self {
        ResidualModel { slow_sd: 0.0, length_nm: 1.0, white_sd: sd, surface_sd: 0.0 }
    }

    /// The variance of a single residual where φ = 0.
    pub fn variance(&self) -> f64 {
        self.slow_sd * self.slow_sd + self.white_sd * self.white_sd
    }
}

/// A filter for one set of wavelengths, some of which are left out.
#[derive(Clone, Debug)]
pub(super) struct Whitening {
    /// Band by band: how much of the slow part is left since the band before, the filter's gain, and 1/√(innovation variance)
    /// (0 where the band is left out).
    steps: Vec<[f64; 3]>,
    /// Without a slow part: 1/w of each band.
    white: Option<Vec<f64>>,
    /// ψ, and (1 − 1/√(1 + q))/q.
    shape: Option<(Vec<f64>, f64)>,
}

impl Whitening {
    /// `scale` multiplies the white standard deviation of each band; a band with 0 or less, or NaN, is left out.
    /// `first_surface` is ρ(λ) up to a factor, one value a band.
    pub fn new(
        model: &ResidualModel,
        wavelengths_nm: &[f64],
        first_surface: impl Iterator<Item = f64> + Clone,
        scale: impl Fn(usize) -> f64,
    ) -> Self {
        let slow = model.slow_sd * model.slow_sd;
        // variance of the slow part, given all bands so far
        let mut variance = slow;
        let mut before: Option<f64> = None;
        let steps: Vec<[f64; 3]> = wavelengths_nm
            .iter()
            .enumerate()
            .map(|(band, nm)| {
                let left = before.map_or(1.0, |before| (-(nm - before).abs() / model.length_nm).exp());
                before = Some(*nm);
                variance = left * left * variance + slow * (1.0 - left * left);
                let white = model.white_sd * scale(band);
                if !(white > 0.0) {
                    return [left, 0.0, 0.0];
                }
                let innovation = variance + white * white;
                let gain = variance / innovation;
                variance -= gain * variance;
                [left, gain, 1.0 / innovation.sqrt()]
            })
            .collect();
        let white = (slow == 0.0).then(|| steps.iter().map(|[_, _, inverse]| *inverse).collect());
        let mut whitening = Whitening { steps, white, shape: None };
        if model.surface_sd > 0.0 {
            let mean = first_surface.clone().sum::<f64>() / wavelengths_nm.len() as f64;
            let mut psi: Vec<f64> = first_surface.map(|rho| model.surface_sd * (rho / mean - 1.0)).collect();
            whitening.apply(&mut psi);
            let q = psi.iter().map(|psi| psi * psi).sum::<f64>();
            if q > 0.0 {
                whitening.shape = Some((psi, (1.0 - 1.0 / (1.0 + q).sqrt()) / q));
            }
        }
        whitening
    }

    /// r ← C^(−½)r, a square root of C⁻¹; 0 where the band is left out.
    pub fn apply(&self, r: &mut [f64]) {
        self.filter(r);
        self.take_shape_from(r);
    }

    /// r ← (1 + ψψᵀ)^(−½) r.
    fn take_shape_from(&self, r: &mut [f64]) {
        let Some((psi, factor)) = &self.shape else { return };
        let amount = factor * psi.iter().zip(&*r).map(|(psi, r)| psi * r).sum::<f64>();
        r.iter_mut().zip(psi).for_each(|(r, psi)| *r -= amount * psi);
    }

    /// r ← L⁻¹r of the slow and the white part.
    fn filter(&self, r: &mut [f64]) {
        if let Some(white) = &self.white {
            for (r, inverse) in r.iter_mut().zip(white) {
                // 0 · NaN would be NaN
                *r = if *inverse > 0.0 { *r * inverse } else { 0.0 };
            }
            return;
        }
        self.step_through([r]);
    }

    /// [`apply`](Self::apply) to several columns of `bands` numbers each, one after the other in memory.
    pub fn apply_to_all(&self, columns: &mut [f64], bands: usize) {
        // each step waits for the one before: four columns at a time fill the wait
        let mut fours = columns.chunks_exact_mut((4 * bands).max(1));
        for four in &mut fours {
            let (a, rest) = four.split_at_mut(bands);
            let (b, rest) = rest.split_at_mut(bands);
            let (c, d) = rest.split_at_mut(bands);
            if self.white.is_some() {
                [&mut *a, b, c, d].into_iter().for_each(|column| self.filter(column));
            } else {
                self.step_through([&mut *a, b, c, d]);
            }
            [a, b, c, d].into_iter().for_each(|column| self.take_shape_from(column));
        }
        fours.into_remainder().chunks_exact_mut(bands.max(1)).for_each(|column| self.apply(column));
    }

    /// The recursion, in columns side by side.
    #[inline(always)]
    fn step_through<const K: usize>(&self, mut columns: [&mut [f64]; K]) {
        let bands = columns.iter().map(|column| column.len()).min().unwrap_or(0).min(self.steps.len());
        columns = columns.map(|column| &mut column[..bands]);
        let mut slow = [0.0; K];
        for (band, [left, gain, inverse]) in self.steps[..bands].iter().enumerate() {
            for (slow, column) in slow.iter_mut().zip(&mut columns) {
                *slow *= left;
                if *inverse > 0.0 {
                    let innovation = column[band] - *slow;
                    *slow += gain * innovation;
                    column[band] = innovation * inverse;
                } else {
                    column[band] = 0.0;
                }
            }
        }
    }

    /// How many bands count.
    pub fn used(&self) -> usize {
        self.steps.iter().filter(|[_, _, inverse]| *inverse > 0.0).count()
    }
}

#[cfg(test)]
mod tests {
    use std::vec;

    use super::*;

    /// A first surface that reflects less towards the infrared.
    fn rho(nm: &[f64]) -> impl Iterator<Item = f64> + Clone {
        nm.iter().map(|nm| 0.05 - 1e-5 * nm)
    }

    /// rᵀC⁻¹r by elimination, the textbook way.
    fn quadratic_form(model: &ResidualModel, nm: &[f64], r: &[f64]) -> f64 {
        let n = nm.len();
        let mean = rho(nm).sum::<f64>() / n as f64;
        let phi: Vec<f64> = rho(nm).map(|rho| rho / mean - 1.0).collect();
        let mut c: Vec<Vec<f64>> = (0..n)
            .map(|i| {
                let of = |j: usize| {
                    let slow = model.slow_sd.powi(2) * (-(nm[i] - nm[j]).abs() / model.length_nm).exp();
                    let surface = model.surface_sd.powi(2) * phi[i] * phi[j];
                    slow + surface + if i == j { model.white_sd.powi(2) } else { 0.0 }
                };
                (0..n).map(of).collect()
            })
            .collect();
        let mut x = r.to_vec();
        for k in 0..n {
            for i in k + 1..n {
                let factor = c[i][k] / c[k][k];
                for j in k..n {
                    c[i][j] -= factor * c[k][j];
                }
                x[i] -= factor * x[k];
            }
        }
        (0..n).map(|k| x[k] * x[k] / c[k][k]).sum()
    }

    #[test]
    fn whitened_residuals_have_the_quadratic_form_of_their_covariance() {
        let nm = [410.0, 420.0, 430.0, 437.5, 500.0, 900.0, 901.0, 1500.0];
        let r = [0.01, -0.004, 0.02, 0.013, -0.03, 0.002, 0.001, -0.01];
        for model in [
            ResidualModel { slow_sd: 0.01, length_nm: 60.0, white_sd: 0.002, surface_sd: 0.0 },
            ResidualModel { slow_sd: 0.01, length_nm: 1e4, white_sd: 0.02, surface_sd: 0.0 },
            ResidualModel { slow_sd: 0.01, length_nm: 60.0, white_sd: 0.002, surface_sd: 0.05 },
            ResidualModel::white(0.01),
            ResidualModel { surface_sd: 0.01, ..ResidualModel::white(0.01) },
        ] {
            let mut white = r;
            Whitening::new(&model, &nm, rho(&nm), |_| 1.0).apply(&mut white);
            let ours: f64 = white.iter().map(|r| r * r).sum();
            // both sides: rounding times a condition number below 10³
            assert!((ours / quadratic_form(&model, &nm, &r) - 1.0).abs() < 1e-11);
        }
    }

    #[test]
    fn a_band_that_is_left_out_is_as_if_it_had_never_been() {
        let model = ResidualModel { slow_sd: 0.01, length_nm: 60.0, white_sd: 0.004, surface_sd: 0.0 };
        let (nm, r) = ([410.0, 420.0, 430.0, 450.0], [0.01, 99.0, 0.02, -0.01]);
        let mut white = r;
        let gap = Whitening::new(&model, &nm, rho(&nm), |band| if band == 1 { f64::NAN } else { 1.0 });
        gap.apply(&mut white);
        let with_gap: f64 = white.iter().map(|r| r * r).sum();
        assert_eq!((gap.used(), white[1]), (3, 0.0));
        assert!((with_gap / quadratic_form(&model, &[410.0, 430.0, 450.0], &[0.01, 0.02, -0.01]) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn columns_together_are_whitened_as_each_alone() {
        let nm = [410.0, 420.0, 430.0, 450.0, 700.0];
        let bands = nm.len();
        for model in [
            ResidualModel { slow_sd: 0.01, length_nm: 60.0, white_sd: 0.004, surface_sd: 0.01 },
            ResidualModel::white(0.01),
            ResidualModel { surface_sd: 0.01, ..ResidualModel::white(0.01) },
        ] {
            let whitening = Whitening::new(&model, &nm, rho(&nm), |band| if band == 2 { 0.0 } else { 1.0 });
            // one column, less than four, four, and more
            for count in [0, 1, 3, 4, 11] {
                let mut together: Vec<f64> = (0..count * bands).map(|i| (0.7 * i as f64).sin()).collect();
                let mut alone = together.clone();
                whitening.apply_to_all(&mut together, bands);
                alone.chunks_exact_mut(bands).for_each(|column| whitening.apply(column));
                assert_eq!(together, alone);
            }
        }
    }

    #[test]
    fn white_residuals_are_divided_by_their_standard_deviation() {
        let mut r = vec![0.02, 0.04];
        let nm = [500.0, 501.0];
        let model = ResidualModel::white(0.01);
        Whitening::new(&model, &nm, rho(&nm), |band| if band == 0 { 1.0 } else { 2.0 }).apply(&mut r);
        assert!((r[0] - 2.0).abs() < 1e-15 && (r[1] - 2.0).abs() < 1e-15);
    }
}
