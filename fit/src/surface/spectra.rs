//! Measured bands → [`Moments`]: one group for each pattern of missing values, rotated; or every band by itself.

use std::collections::BTreeMap;
use std::vec;
use std::vec::Vec;

use super::moments::{Group, Moments, compress};
use crate::FitError;

/// The rows of a leaf, in memory of its own.
#[derive(Clone, Debug, Default)]
pub struct Spectra {
    groups: Vec<Owned>,
    constant: f64,
}

#[derive(Clone, Debug)]
struct Owned {
    weight: Vec<f64>,
    rows: Vec<f64>,
    gain: Vec<f64>,
}

impl Spectra {
    /// k_L free in every band. `brdf` holds band after band, one value a direction, NaN where missing; `weight` ω in the same
    /// order, or nothing where every value counts once.
    ///
    /// Bands with the same weights in every direction are rotated into one group; others stay as they are.
    ///
    /// # Errors
    /// [`FitError`] for lengths that do not belong together, infinite values, or ω that are not positive numbers.
    pub fn new(directions: usize, brdf: &[f64], weight: Option<&[f64]>) -> Result<Self, FitError> {
        check(directions, brdf, weight)?;
        let mut patterns: BTreeMap<Vec<u64>, Vec<f64>> = BTreeMap::new();
        for (band, values) in brdf.chunks_exact(directions).enumerate() {
            let omega = band_weights(band, values, weight);
            let rows = patterns.entry(omega.iter().map(|w| w.to_bits()).collect()).or_default();
            rows.extend(values.iter().map(|y| if y.is_nan() { 0.0 } else { *y }));
        }
        let groups = patterns.into_iter().map(|(pattern, mut rows)| {
            let bands = rows.len() / directions;
            let weight: Vec<f64> = pattern.into_iter().map(f64::from_bits).collect();
            let left = compress(&mut rows, directions);
            rows.truncate(left * directions);
            let mut gain = vec![0.0; left];
            if let Some(first) = gain.first_mut() {
                *first = (bands as f64).sqrt();
            }
            Owned { weight, rows, gain }
        });
        Ok(Spectra { groups: groups.filter(|group| group.weight.iter().any(|w| *w > 0.0)).collect(), constant: 0.0 })
    }

    /// k_L(λ) = Σ c_i `basis`_i(λ), the c free: for a diffuse spectrum known up to a gain and a flat offset, basis = {d, 1}.
    /// The basis must be able to make a constant spectrum, and no value may be missing.
    ///
    /// # Errors
    /// As [`new`](Self::new), and [`FitError::NotFinite`] for a missing value, a basis without the constant, or a dependent one.
    pub fn with_basis(directions: usize, brdf: &[f64], basis: &[&[f64]]) -> Result<Self, FitError> {
        check(directions, brdf, None)?;
        if let Some(index) = brdf.iter().position(|y| y.is_nan()) {
            return Err(FitError::NotFinite { what: "brdf (missing values need k_L free in every band)", index });
        }
        let bands = brdf.len() / directions;
        // orthonormal, the constant first (Gram and Schmidt, twice)
        let mut units: Vec<Vec<f64>> = vec![vec![1.0 / (bands as f64).sqrt(); bands]];
        for spectrum in basis {
            if spectrum.len() != bands {
                return Err(FitError::Length { what: "basis", found: spectrum.len(), expected: bands });
            }
            let mut rest = spectrum.to_vec();
            for _ in 0..2 {
                for unit in &units {
                    let share: f64 = rest.iter().zip(unit).map(|(a, b)| a * b).sum();
                    rest.iter_mut().zip(unit).for_each(|(a, b)| *a -= share * b);
                }
            }
            let (norm, size) = (norm(&rest), norm(spectrum));
            if norm > 1e-9 * size {
                units.push(rest.into_iter().map(|a| a / norm).collect());
            }
        }
        if units.len() > basis.len() {
            return Err(FitError::NotFinite { what: "basis (it must contain the constant spectrum)", index: 0 });
        }
        let rows: Vec<f64> =
            units.iter().flat_map(|unit| (0..directions).map(|v| along(unit, brdf, directions, v))).collect();
        let mut gain = vec![0.0; units.len()];
        if let Some(first) = gain.first_mut() {
            *first = (bands as f64).sqrt();
        }
        // what the basis cannot reach, free of cancellation: the projected residual itself
        let mut constant = 0.0;
        for (band, values) in brdf.chunks_exact(directions).enumerate() {
            for (v, y) in values.iter().enumerate() {
                let reached: f64 =
                    units.iter().enumerate().map(|(r, unit)| unit[band] * rows[r * directions + v]).sum();
                constant += (y - reached).powi(2);
            }
        }
        Ok(Spectra { groups: vec![Owned { weight: vec![1.0; directions], rows, gain }], constant })
    }

    /// Calls `with` on the rows.
    pub fn moments<R>(&self, with: impl FnOnce(Moments<'_, f64>) -> R) -> R {
        let groups: Vec<Group<'_, f64>> =
            self.groups.iter().map(|g| Group { weight: &g.weight, rows: &g.rows, gain: &g.gain }).collect();
        with(Moments { groups: &groups, constant: self.constant })
    }
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn along(unit: &[f64], brdf: &[f64], directions: usize, v: usize) -> f64 {
    brdf.iter().skip(v).step_by(directions).zip(unit).map(|(y, u)| y * u).sum()
}

/// ω of one band; 0 where the value is missing.
pub(super) fn band_weights(band: usize, values: &[f64], weight: Option<&[f64]>) -> Vec<f64> {
    let first = band * values.len();
    let of = |(v, y): (usize, &f64)| match weight {
        _ if y.is_nan() => 0.0,
        Some(weight) => weight.get(first + v).copied().unwrap_or(0.0),
        None => 1.0,
    };
    values.iter().enumerate().map(of).collect()
}

fn check(directions: usize, brdf: &[f64], weight: Option<&[f64]>) -> Result<(), FitError> {
    if directions == 0 || brdf.is_empty() || !brdf.len().is_multiple_of(directions) {
        let expected = brdf.len().max(1).next_multiple_of(directions.max(1));
        return Err(FitError::Length { what: "brdf", found: brdf.len(), expected });
    }
    if let Some(index) = brdf.iter().position(|y| y.is_infinite()) {
        return Err(FitError::NotFinite { what: "brdf", index });
    }
    if let Some(weight) = weight {
        if weight.len() != brdf.len() {
            return Err(FitError::Length { what: "weight", found: weight.len(), expected: brdf.len() });
        }
        // a missing value may have any weight, a value that counts must have a positive one
        let wrong = |(w, y): (&f64, &f64)| !y.is_nan() && !(*w > 0.0 && w.is_finite());
        if let Some(index) = weight.iter().zip(brdf).position(wrong) {
            return Err(FitError::NotFinite { what: "weight (or is not positive)", index });
        }
    }
    Ok(())
}
