//! What the fit of every band makes of a leaf, beside what went in.

use leafbrdf_core::{Angle, Grade, Illumination, Surface};

use crate::fit::{BandsOutcome, Summary};
use crate::measurement::Measurement;
use crate::simulate::{CoupledLeaf, Noise, PresetLeaf, SOURCES_DEG};

/// θ_s at which DHRF_spec is reported: those of the paper's §4.4.
pub const DHRF_SOURCES_DEG: [f64; 4] = SOURCES_DEG;

/// VIS ends here, nm (as in `summary.json`).
const VIS_END_NM: f64 = 700.0;

/// The wavelength of the paper's Fig. 2, where chlorophyll absorbs most, nm.
const RED_NM: f64 = 680.0;

/// How well one parameter has been found again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recovery {
    /// The true value; for k_L the mean over the bands.
    pub truth: f64,
    /// Mean of the fitted values over the bands.
    pub mean: f64,
    /// Standard error of that mean: the bands' noise is independent, so √(Σ se²)/bands.
    pub mean_se: f64,
    /// Root mean square of fitted − true over the bands.
    pub rms_error: f64,
    /// Root mean square of the bands' standard errors.
    pub rms_se: f64,
    /// Share of the bands whose fitted value lies within one standard error of the truth.
    pub covered: f64,
}

impl Recovery {
    /// `bands`: (fitted, standard error, truth) of each.
    fn new(bands: &[(f64, f64, f64)]) -> Self {
        let count = bands.len() as f64;
        let mean = |of: &dyn Fn(&(f64, f64, f64)) -> f64| bands.iter().map(of).sum::<f64>() / count;
        let mean_square_se = mean(&|(_, se, _)| se * se);
        Recovery {
            truth: mean(&|(_, _, truth)| *truth),
            mean: mean(&|(fitted, _, _)| *fitted),
            mean_se: (mean_square_se / count).sqrt(),
            rms_error: mean(&|(fitted, _, truth)| (fitted - truth) * (fitted - truth)).sqrt(),
            rms_se: mean_square_se.sqrt(),
            covered: mean(&|(fitted, se, truth)| if (fitted - truth).abs() <= *se { 1.0 } else { 0.0 }),
        }
    }
}

/// The bands of one leaf.
#[derive(Clone, Debug)]
pub struct BandsReport {
    /// `laurel`, `beech`, `hazel`.
    pub name: &'static str,
    /// Bands with a result and a standard error for every parameter.
    pub bands: usize,
    /// Values used a band.
    pub values: usize,
    /// k_L, n, σ.
    pub recovery: [Recovery; 3],
    /// True k_L: least and greatest over the bands.
    pub k_lambert_range: [f64; 2],
    /// RMSE of the fit over all values, sr⁻¹.
    pub rmse: f64,
    /// Root mean square of the noise that was added to the values used, sr⁻¹.
    pub noise: f64,
    /// (max − min)/mean of n and σ over VIS and NIR.
    pub invariance: [[f64; 2]; 2],
    /// DHRF_spec at [`DHRF_SOURCES_DEG`], mean over the bands' n and σ.
    pub dhrf_specular: [f64; 4],
    /// (max − min)/mean of the bands' DHRF_spec at θ_s = 60°.
    pub dhrf_specular_range: f64,
    /// Greatest DHRF_spec(60°)/k_L over the bands.
    pub specular_over_diffuse: f64,
    /// Greatest measured BRDF at θ_s = 60°, θ_v ≤ 70°, 680 nm, sr⁻¹.
    pub maximum: f64,
}

/// One band with a standard error for every parameter; the parameters are k_L, n, σ.
struct FittedBand {
    wavelength_nm: f64,
    value: [f64; 3],
    error: [f64; 3],
    truth: [f64; 3],
}

impl BandsReport {
    pub(super) fn new(
        preset: &PresetLeaf,
        leaf: &CoupledLeaf,
        measured: &Measurement,
        outcome: &BandsOutcome,
        summary: &Summary,
    ) -> Self {
        let fitted: Vec<FittedBand> = leaf
            .wavelengths_nm
            .iter()
            .zip(&leaf.k_lambert)
            .zip(&outcome.bands)
            .filter_map(|((nm, k_l), band)| {
                let band = band.as_ref()?;
                let [Some(k_l_se), Some(n_se), Some(sigma_se)] = band.standard_errors else { return None };
                Some(FittedBand {
                    wavelength_nm: *nm,
                    value: band.parameters,
                    error: [k_l_se, n_se, sigma_se],
                    truth: [*k_l, preset.n, preset.sigma],
                })
            })
            .collect();
        let recovery = [0, 1, 2].map(|p| {
            let of: Vec<_> = fitted.iter().map(|band| (band.value[p], band.error[p], band.truth[p])).collect();
            Recovery::new(&of)
        });
        let invariance = [true, false].map(|vis| {
            [1, 2].map(|p| {
                let inside = fitted.iter().filter(|band| (band.wavelength_nm <= VIS_END_NM) == vis);
                relative_range(inside.map(|band| band.value[p]))
            })
        });
        let noise = Noise::new(Noise::RELATIVE, Noise::ABSOLUTE, 0);
        let variance = |brdf: &f64| noise.sd(*brdf).powi(2);
        let used = &outcome.selected.brdf;
        let at_60 = dhrf_of_bands(60.0, leaf, &fitted);
        let extreme = |start, pick: fn(f64, f64) -> f64| leaf.k_lambert.iter().copied().fold(start, pick);
        BandsReport {
            name: preset.name,
            bands: fitted.len(),
            values: outcome.selected.geometries.len(),
            recovery,
            k_lambert_range: [extreme(f64::INFINITY, f64::min), extreme(f64::NEG_INFINITY, f64::max)],
            rmse: summary.rmse,
            noise: (used.iter().map(variance).sum::<f64>() / used.len() as f64).sqrt(),
            invariance,
            dhrf_specular: DHRF_SOURCES_DEG.map(|theta_s| mean(&dhrf_of_bands(theta_s, leaf, &fitted))),
            dhrf_specular_range: relative_range(at_60.iter().copied()),
            specular_over_diffuse: at_60
                .iter()
                .zip(&fitted)
                .map(|(specular, band)| specular / band.value[0])
                .fold(f64::NEG_INFINITY, f64::max),
            maximum: maximum(measured),
        }
    }
}

/// (max − min)/mean.
fn relative_range(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let count = values.clone().count() as f64;
    let least = values.clone().fold(f64::INFINITY, f64::min);
    let greatest = values.clone().fold(f64::NEG_INFINITY, f64::max);
    (greatest - least) * count / values.sum::<f64>()
}

/// DHRF_spec at θ_s of the bands' fitted n and σ; grade E6, below 10⁻⁶ relative. NaN outside the model's domain.
fn dhrf_of_bands(theta_s_deg: f64, leaf: &CoupledLeaf, fitted: &[FittedBand]) -> Vec<f64> {
    let source = Illumination::new(Angle::from_degrees(theta_s_deg)).ok();
    let of_band = |band: &FittedBand| {
        let [_, n, sigma] = band.value;
        let surface = Surface::new(n, sigma).ok()?.with_normalization(leaf.model.surface.normalization());
        Some(surface.dhrf(&source?, Grade::E6))
    };
    fitted.iter().map(|band| of_band(band).unwrap_or(f64::NAN)).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The greatest value at θ_s = 60°, θ_v ≤ 70°, 680 nm, sr⁻¹.
fn maximum(measured: &Measurement) -> f64 {
    let brdf = measured.brdf();
    let band = measured.wavelengths_nm.iter().position(|nm| *nm == RED_NM).unwrap_or(0);
    let values = brdf.iter().skip(band * measured.directions.len()).zip(&measured.directions);
    let bright = values.filter(|(_, d)| d.theta_s_deg == 60.0 && d.theta_v_deg <= 70.0);
    bright.map(|(value, _)| *value).fold(f64::NAN, f64::max)
}
