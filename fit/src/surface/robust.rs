//! Huber's loss, by reweighting.

use std::vec;
use std::vec::Vec;

use super::leaf::{SurfaceData, eliminate, values_at};
use super::model::LeafModel;
use super::profile::{Place, Profile};
use super::search::{SearchOptions, Valley, polish};
use super::spectra::{Spectra, band_weights};
use crate::FitError;

/// Huber's loss by reweighting: the scale is 1.4826 × the median absolute residual of the leaf, the knee 1.345 scales.
#[allow(clippy::type_complexity)]
pub(super) fn robust(
    data: &SurfaceData<'_>,
    model: &LeafModel<'_, f64>,
    options: &SearchOptions<f64>,
    start: Valley<f64>,
    weight: Option<&[f64]>,
    places: &mut [Place<f64>],
) -> Result<(Valley<f64>, Option<Vec<f64>>), FitError> {
    const ROUNDS: usize = 50;
    let directions = data.directions.len();
    let mut best = start;
    let original: Vec<f64> =
        data.brdf.chunks_exact(directions).enumerate().flat_map(|(b, y)| band_weights(b, y, weight)).collect();
    let mut current = original.clone();
    let mut residual = vec![0.0; directions];
    for _ in 0..ROUNDS {
        let values = values_at(model, &best.x)?;
        let mut all = vec![0.0; data.brdf.len()];
        for ((y, w), r) in data
            .brdf
            .chunks_exact(directions)
            .zip(current.chunks_exact(directions))
            .zip(all.chunks_exact_mut(directions))
        {
            residual.fill(0.0);
            eliminate(&values, y, w, &mut residual);
            r.copy_from_slice(&residual);
        }
        let scaled = |(r, w): (&f64, &f64)| r.abs() * w.sqrt();
        let mut sizes: Vec<f64> = all.iter().zip(&original).filter(|(_, w)| **w > 0.0).map(scaled).collect();
        sizes.sort_by(f64::total_cmp);
        let scale = 1.4826 * sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
        if !(scale > 0.0) {
            break;
        }
        for ((w, w0), r) in current.iter_mut().zip(&original).zip(&all) {
            *w = w0 * (1.345 * scale / scaled((r, w0))).min(1.0);
        }
        let spectra = Spectra::new(directions, data.brdf, Some(&current))?;
        let next = spectra.moments(|moments| {
            Profile::new(model, moments, places).map(|mut profile| polish(&mut profile, options, &best.x))
        });
        let Some(next) = next else { break };
        let still = next.x.iter().zip(&best.x).all(|(a, b)| (a - b).abs() <= 1e-7 * b.abs().max(1e-3));
        best = Valley { iterations: best.iterations + next.iterations, ..next };
        if still {
            break;
        }
    }
    Ok((best, Some(current)))
}
