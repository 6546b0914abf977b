//! χ² of a leaf against its spectra, with gradient and Gauss–Newton matrix, block by block.

use leafbrdf_core::Real;
use leafbrdf_prospect::{Jacobian, Lanes, LeafParams, Parameter};

use super::axis::Axis;
use super::report::Residuals;
use super::{HemisphericalError, HemisphericalProblem, Measured};
use crate::solver::{Evaluation, Objective};

/// Bands worked on together: the model's own block, so that no instruction is wasted and all stays in the first-level cache.
pub(super) const BLOCK: usize = 64;

/// χ² as a function of the free parameters' axes.
pub(super) struct Misfit<'a, 'w, T, const P: usize> {
    pub problem: &'a HemisphericalProblem<'a, T>,
    pub parameters: [Parameter; P],
    pub axes: [Axis<T>; P],
    /// At least (2 + 2P) numbers.
    pub workspace: &'w mut [T],
}

/// χ², its gradient by the parameters themselves, halved, and the normal matrix Σ ω ∂y/∂C_i ∂y/∂C_j below its diagonal (j ≤ i).
struct Sums<T, const P: usize> {
    chi2: T,
    gradient: [T; P],
    lower: [[T; P]; P],
}

impl<T: Lanes, const P: usize> Misfit<'_, '_, T, P> {
    /// The leaf at x.
    pub fn leaf(&self, x: &[T; P]) -> LeafParams<T> {
        let mut leaf = self.problem.held;
        for ((parameter, axis), x) in self.parameters.iter().zip(&self.axes).zip(x) {
            leaf.set(*parameter, axis.value(*x));
        }
        leaf
    }

    /// dC/dx of each free parameter.
    pub fn slopes(&self, x: &[T; P]) -> [T; P] {
        core::array::from_fn(|i| self.axes[i].value_and_slope(x[i]).1)
    }

    fn sums(&mut self, leaf: &LeafParams<T>) -> Result<Sums<T, P>, HemisphericalError> {
        let mut sums = Sums { chi2: T::ZERO, gradient: [T::ZERO; P], lower: [[T::ZERO; P]; P] };
        let view = self.problem.model.view();
        let block = (self.workspace.len() / (2 + 2 * P)).clamp(1, BLOCK);
        let mut first = 0;
        while first < view.len() {
            let last = (first + block).min(view.len());
            let bands = last - first;
            let Some(part) = view.bands(first..last) else { break };
            let (reflectance, rest) = split(self.workspace, bands);
            let (transmittance, rest) = split(rest, bands);
            let (d_reflectance, rest) = split(rest, P * bands);
            let (d_transmittance, _) = split(rest, P * bands);
            self.problem.model.on(part).jacobian(
                leaf,
                &self.parameters,
                Jacobian {
                    reflectance: &mut *reflectance,
                    transmittance: &mut *transmittance,
                    d_reflectance: &mut *d_reflectance,
                    d_transmittance: &mut *d_transmittance,
                },
            )?;
            let spectra = &self.problem.spectra;
            for (measured, modelled, derivatives) in [
                (spectra.reflectance, reflectance, d_reflectance),
                (spectra.transmittance, transmittance, d_transmittance),
            ] {
                if let Some(measured) = measured.and_then(|measured| measured.part(first, last)) {
                    sums.add(&measured, modelled, derivatives);
                }
            }
            first = last;
        }
        Ok(sums)
    }

    /// What is left over at `leaf`: Σ residual², and how much neighbouring residuals resemble each other.
    pub fn residuals(&mut self, leaf: &LeafParams<T>) -> Result<[Option<Residuals<T>>; 2], HemisphericalError> {
        let view = self.problem.model.view();
        let spectra = &self.problem.spectra;
        let mut residuals = [spectra.reflectance, spectra.transmittance].map(|m| m.map(|_| Residuals::new()));
        let block = (self.workspace.len() / 2).clamp(1, BLOCK);
        let mut first = 0;
        while first < view.len() {
            let last = (first + block).min(view.len());
            let Some(part) = view.bands(first..last) else { break };
            let (reflectance, rest) = split(self.workspace, last - first);
            let (transmittance, _) = split(rest, last - first);
            self.problem.model.on(part).spectrum(leaf, reflectance, transmittance)?;
            for ((measured, modelled), residuals) in
                [(spectra.reflectance, reflectance), (spectra.transmittance, transmittance)]
                    .into_iter()
                    .zip(&mut residuals)
            {
                let (Some(measured), Some(residuals)) =
                    (measured.and_then(|measured| measured.part(first, last)), residuals)
                else {
                    continue;
                };
                for (i, (value, modelled)) in measured.values.iter().zip(modelled).enumerate() {
                    let weight = measured.weights.map_or(T::ONE, |w| w.get(i).copied().unwrap_or(T::ZERO));
                    residuals.push(*value, *value - *modelled, weight);
                }
            }
            first = last;
        }
        Ok(residuals)
    }
}

impl<T: Lanes, const P: usize> Objective<T, P> for Misfit<'_, '_, T, P> {
    fn evaluate(&mut self, x: &[T; P]) -> Evaluation<T, P> {
        let leaf = self.leaf(x);
        // Setting up has shown that the model accepts the box; an infinite cost would make the search step back.
        let Ok(Sums { chi2, mut gradient, lower }) = self.sums(&leaf) else {
            return Evaluation {
                cost: T::MAX,
                gradient: [T::ZERO; P],
                hessian: [[T::ZERO; P]; P],
                gauss_newton: [[T::ZERO; P]; P],
            };
        };
        let slopes = self.slopes(x);
        let mut normal = lower;
        for i in 0..P {
            gradient[i] = T::TWO * gradient[i] * slopes[i];
            for j in 0..P {
                let product = if j <= i { lower[i][j] } else { lower[j][i] };
                normal[i][j] = T::TWO * product * slopes[i] * slopes[j];
            }
        }
        Evaluation { cost: chi2, gradient, hessian: normal, gauss_newton: normal }
    }
}

impl<'a, T: Real> Measured<'a, T> {
    /// Some of the bands.
    fn part(&self, first: usize, last: usize) -> Option<Measured<'a, T>> {
        Some(Measured {
            values: self.values.get(first..last)?,
            weights: match self.weights {
                None => None,
                Some(weights) => Some(weights.get(first..last)?),
            },
        })
    }
}

impl<T: Real, const P: usize> Sums<T, P> {
    /// Adds one block. `modelled` becomes √ω (modelled − measured), the derivatives are multiplied by √ω.
    fn add(&mut self, measured: &Measured<'_, T>, modelled: &mut [T], derivatives: &mut [T]) {
        for (modelled, measured) in modelled.iter_mut().zip(measured.values) {
            *modelled -= *measured;
        }
        // there is at least one band: said for the compiler, which then leaves no panic in the image
        let bands = modelled.len().max(1);
        if let Some(weights) = measured.weights {
            let rows = core::iter::once(&mut *modelled).chain(derivatives.chunks_exact_mut(bands));
            for row in rows {
                for (value, weight) in row.iter_mut().zip(weights) {
                    *value *= weight.sqrt();
                }
            }
        }
        self.chi2 += dot(modelled, modelled);
        let rows = || derivatives.chunks_exact(bands);
        for (i, ((row, gradient), products)) in rows().zip(&mut self.gradient).zip(&mut self.lower).enumerate() {
            *gradient += dot(row, modelled);
            for (product, other) in products.iter_mut().zip(rows()).take(i + 1) {
                *product += dot(row, other);
            }
        }
    }
}

/// Σ a b in eight sums, the order of which does not depend on the machine.
fn dot<T: Real>(a: &[T], b: &[T]) -> T {
    let mut sums = [T::ZERO; 8];
    let (a_eights, a_rest) = a.as_chunks::<8>();
    let (b_eights, b_rest) = b.as_chunks::<8>();
    for (a, b) in a_eights.iter().zip(b_eights) {
        for i in 0..8 {
            sums[i] += a[i] * b[i];
        }
    }
    for ((sum, a), b) in sums.iter_mut().zip(a_rest).zip(b_rest) {
        *sum += *a * *b;
    }
    let [a, b, c, d, e, f, g, h] = sums;
    ((a + b) + (c + d)) + ((e + f) + (g + h))
}

/// The first `count` numbers and the rest; all, and nothing, where there are fewer.
fn split<T>(slice: &mut [T], count: usize) -> (&mut [T], &mut [T]) {
    let count = count.min(slice.len());
    slice.split_at_mut(count)
}

#[cfg(test)]
mod tests {
    use leafbrdf_prospect::{Prospect, Version, table};

    use super::super::{Free, Spectra};
    use super::*;

    #[test]
    fn the_gradient_is_that_of_chi2_with_any_workspace() {
        let view = table::full(Version::D).bands(0..700).unwrap();
        let values: std::vec::Vec<f64> = (0..700).map(|i| 0.1 + 0.0005 * i as f64).collect();
        let weights: std::vec::Vec<f64> =
            (0..700).map(|i| if i % 7 == 0 { 0.0 } else { 1.0 + (i % 3) as f64 }).collect();
        let problem = HemisphericalProblem {
            model: Prospect::new(view),
            spectra: Spectra {
                reflectance: Some(Measured { values: &values, weights: Some(&weights) }),
                transmittance: Some(Measured { values: &values, weights: None }),
            },
            held: LeafParams { car: 8.0, ..LeafParams::with_n_struct(1.5) },
        };
        let parameters = [Parameter::NStruct, Parameter::Cab, Parameter::Cm];
        let axes = parameters.map(|parameter| Axis::new(&Free::new(parameter)));
        let x = [0.4, 0.5, 0.3];
        let mut first = None;
        // one band at a time, an odd number, the whole block
        for length in [8, 100, 512] {
            let mut workspace = std::vec![0.0; length];
            let mut misfit = Misfit { problem: &problem, parameters, axes, workspace: &mut workspace };
            let here = misfit.evaluate(&x);
            // sums in another order: roundings only
            let before: f64 = *first.get_or_insert(here.cost);
            assert!((here.cost / before - 1.0).abs() < 1e-13);
            for i in 0..3 {
                let mut cost = |step: f64| {
                    let mut x = x;
                    x[i] += step;
                    misfit.evaluate(&x).cost
                };
                // fourth-order difference: error h⁴ and ε/h
                let h = 1e-3;
                let difference = (8.0 * (cost(h) - cost(-h)) - (cost(2.0 * h) - cost(-2.0 * h))) / (12.0 * h);
                assert!((here.gradient[i] / difference - 1.0).abs() < 1e-8, "{i}: {} {difference}", here.gradient[i]);
            }
        }
    }
}
