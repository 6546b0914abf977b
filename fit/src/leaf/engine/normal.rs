//! What the data say of the parameters at a point: score, normal matrix, and scatter, summed over the directions.

use std::vec::Vec;

use leafbrdf_prospect::Parameter;

use super::super::lobes::Lobes;
use super::super::parameters::{COUNT, INTERIOR, place};
use super::super::residuals::Whitening;
use super::{Cost, Diffuse};

/// χ² without priors, with the normal matrix of all free parameters, by the parameters themselves.
#[derive(Clone, Debug)]
pub(in super::super) struct Normal {
    pub chi2: f64,
    /// Jᵀr and JᵀJ of whitened residuals r = measured − modelled.
    pub score: [f64; COUNT],
    pub matrix: [[f64; COUNT]; COUNT],
    /// Jᵀ of further columns asked for: ∂/∂ln N, ∂/∂f, ∂/∂λ.
    pub held: [[f64; COUNT]; 3],
}

impl Cost<'_> {
    /// χ², score and normal matrix at x.
    pub fn normal(&mut self, x: &[f64; COUNT], held: bool) -> Result<Normal, leafbrdf_prospect::Error> {
        let diffuse = self.diffuse(x, held)?;
        let bands = diffuse.k.len();
        let free: Vec<usize> = (0..COUNT).filter(|i| self.is_free(*i)).collect();
        let lobes = Lobes::new(&self.model, x)?;
        let mut normal =
            Normal { chi2: 0.0, score: [0.0; COUNT], matrix: [[0.0; COUNT]; COUNT], held: [[0.0; COUNT]; 3] };
        let pi = core::f64::consts::PI;
        for (direction, measured) in self.measured.brf.chunks_exact(bands.max(1)).enumerate() {
            let Some(whitening) = self.whitening_of.get(direction).and_then(|i| self.whitenings.get(*i)) else { break };
            let (residual, columns, extra) =
                whitened(whitening, &lobes, &diffuse, (direction, measured), &free, &mut self.columns);
            normal.chi2 += residual.iter().map(|r| r * r).sum::<f64>();
            let columns = &*columns;
            for (place, column) in columns.chunks_exact(bands).enumerate() {
                let i = free[place];
                normal.score[i] += dot(column, residual);
                for (other, earlier) in columns.chunks_exact(bands).enumerate().take(place + 1) {
                    normal.matrix[i][free[other]] += dot(column, earlier);
                }
            }
            if held {
                for kind in 0..3 {
                    let extra = &mut extra[..bands];
                    for (band, e) in extra.iter_mut().enumerate() {
                        let value = lobes.at(direction, band);
                        *e = match kind {
                            0 => {
                                let slopes = &diffuse.slopes[place(Parameter::NStruct)];
                                pi * value.diffuse * x[INTERIOR] * slopes.get(band).copied().unwrap_or(0.0)
                            }
                            1 => pi * value.diffuse * self.room.by_share[band],
                            // read at λ + δ what the model says of λ: as if the model were shifted the other way
                            _ => slope_along(self.measured.wavelengths_nm, &diffuse.k, band) * pi * value.diffuse,
                        };
                    }
                    whitening.apply(extra);
                    for (place, column) in columns.chunks_exact(bands).enumerate() {
                        normal.held[kind][free[place]] += dot(column, extra);
                    }
                }
            }
        }
        for i in 0..COUNT {
            for j in 0..i {
                normal.matrix[j][i] = normal.matrix[i][j];
            }
        }
        Ok(normal)
    }

    /// Σ J Jᵀ r² over all values, whitened: what [`Normal::matrix`] times their variance is where all have the same, and is not where
    /// some are noisier.
    pub fn scatter(&mut self, x: &[f64; COUNT]) -> Result<[[f64; COUNT]; COUNT], leafbrdf_prospect::Error> {
        let diffuse = self.diffuse(x, false)?;
        let bands = diffuse.k.len();
        let free: Vec<usize> = (0..COUNT).filter(|i| self.is_free(*i)).collect();
        let lobes = Lobes::new(&self.model, x)?;
        let mut scatter = [[0.0; COUNT]; COUNT];
        for (direction, measured) in self.measured.brf.chunks_exact(bands.max(1)).enumerate() {
            let Some(whitening) = self.whitening_of.get(direction).and_then(|i| self.whitenings.get(*i)) else { break };
            let (residual, columns, _) =
                whitened(whitening, &lobes, &diffuse, (direction, measured), &free, &mut self.columns);
            columns
                .chunks_exact_mut(bands)
                .for_each(|column| column.iter_mut().zip(&*residual).for_each(|(j, r)| *j *= r));
            for (column, &i) in columns.chunks_exact(bands).zip(&free) {
                for (other, &k) in columns.chunks_exact(bands).zip(&free) {
                    scatter[i][k] += dot(column, other);
                }
            }
        }
        Ok(scatter)
    }
}

/// Residual and free columns of one direction, whitened, and the room behind them.
fn whitened<'c>(
    whitening: &Whitening,
    lobes: &Lobes,
    diffuse: &Diffuse,
    (direction, measured): (usize, &[f64]),
    free: &[usize],
    room: &'c mut [f64],
) -> (&'c mut [f64], &'c mut [f64], &'c mut [f64]) {
    let bands = diffuse.k.len();
    let (residual, rest) = room.split_at_mut(bands);
    lobes.residual(direction, &diffuse.k, measured, residual);
    whitening.apply(residual);
    let (columns, extra) = rest.split_at_mut(free.len() * bands);
    for (column, &i) in columns.chunks_exact_mut(bands).zip(free) {
        lobes.column(direction, i, diffuse, column);
    }
    whitening.apply_to_all(columns, bands);
    (residual, columns, extra)
}

/// dy/dλ per nm by the neighbours.
fn slope_along(nm: &[f64], y: &[f64], band: usize) -> f64 {
    let (before, after) = (band.saturating_sub(1), (band + 1).min(nm.len().saturating_sub(1)));
    let width = nm[after] - nm[before];
    if width > 0.0 { (y[after] - y[before]) / width } else { 0.0 }
}

/// Σ a b, in eight sums that the compiler puts side by side.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (a8, b8) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = a8.remainder().iter().zip(b8.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a8.zip(b8) {
        for i in 0..8 {
            sums[i] += a[i] * b[i];
        }
    }
    sums.iter().sum::<f64>() + rest
}
