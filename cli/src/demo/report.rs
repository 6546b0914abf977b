//! What went in, what came out, and what the paper says, side by side.

use std::fmt;

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

/// Numbers that the paper prints for its own, real leaves.
struct Printed {
    /// (max − min)/mean of n and σ in the VIS, percent (§4.3).
    vis_percent: [f64; 2],
    /// RMSE of the per-band fit, sr⁻¹ (Table 5).
    rmse: f64,
    /// Maximum BRDF at θ_s = 60°, sr⁻¹ (§3.2).
    maximum: f64,
}

/// Laurel, beech, hazel.
const PRINTED: [Printed; 3] = [
    Printed { vis_percent: [2.0, 8.0], rmse: 1.51e-2, maximum: 1.1 },
    Printed { vis_percent: [5.0, 7.0], rmse: 1.12e-2, maximum: 0.29 },
    Printed { vis_percent: [10.0, 9.0], rmse: 0.90e-2, maximum: 0.14 },
];

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

/// One leaf of the demo.
#[derive(Clone, Debug)]
pub struct LeafReport {
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

impl LeafReport {
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
        let extreme = |start, pick: fn(f64, f64) -> f64| leaf.k_lambert.iter().copied().fold(start, pick);
        LeafReport {
            name: preset.name,
            bands: fitted.len(),
            values: outcome.selected.geometries.len(),
            recovery,
            k_lambert_range: [extreme(f64::INFINITY, f64::min), extreme(f64::NEG_INFINITY, f64::max)],
            rmse: summary.rmse,
            noise: (used.iter().map(variance).sum::<f64>() / used.len() as f64).sqrt(),
            invariance,
            dhrf_specular: DHRF_SOURCES_DEG.map(|theta_s| mean_dhrf(theta_s, leaf, &fitted)),
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

/// DHRF_spec at θ_s, mean over the bands' fitted n and σ; grade E6, below 10⁻⁶ relative.
fn mean_dhrf(theta_s_deg: f64, leaf: &CoupledLeaf, fitted: &[FittedBand]) -> f64 {
    let Ok(source) = Illumination::new(Angle::from_degrees(theta_s_deg)) else { return f64::NAN };
    let of_band = |band: &FittedBand| {
        let [_, n, sigma] = band.value;
        let surface = Surface::new(n, sigma).ok()?;
        Some(surface.with_normalization(leaf.model.surface.normalization()).dhrf(&source, Grade::E6))
    };
    fitted.iter().filter_map(of_band).sum::<f64>() / fitted.len() as f64
}

/// The greatest value at θ_s = 60°, θ_v ≤ 70°, 680 nm, sr⁻¹.
fn maximum(measured: &Measurement) -> f64 {
    let brdf = measured.brdf();
    let band = measured.wavelengths_nm.iter().position(|nm| *nm == RED_NM).unwrap_or(0);
    let values = brdf.iter().skip(band * measured.directions.len()).zip(&measured.directions);
    let bright = values.filter(|(_, d)| d.theta_s_deg == 60.0 && d.theta_v_deg <= 70.0);
    bright.map(|(value, _)| *value).fold(f64::NAN, f64::max)
}

/// The demo's result: one column a leaf.
#[derive(Clone, Debug)]
pub struct DemoReport {
    /// Laurel, beech, hazel.
    pub leaves: Vec<LeafReport>,
}

impl DemoReport {
    /// Share of all (band, parameter) pairs whose standard error covers the truth; 68.3 % for Gaussian errors.
    pub fn covered(&self) -> f64 {
        let all =
            || self.leaves.iter().flat_map(|leaf| leaf.recovery.iter().map(move |r| (r.covered, leaf.bands as f64)));
        all().map(|(share, bands)| share * bands).sum::<f64>() / all().map(|(_, bands)| bands).sum::<f64>()
    }
}

impl fmt::Display for DemoReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (bands, values) = self.leaves.first().map_or((0, 0), |leaf| (leaf.bands, leaf.values));
        writeln!(f, "Three simulated leaves, measured and inverted as in Bousquet et al. (2005).")?;
        writeln!(f, "  model       BRDF = k_L/pi + BRDF_spec(n, sigma), normalization bousquet2005 (K = 2 pi^2)")?;
        writeln!(f, "  truth       n and sigma of Table 4; k_L from PROSPECT-D (Eq. 17), leaf contents ours")?;
        writeln!(
            f,
            "  goniometer  theta_s 8, 21, 41, 60 deg; 98 views each, 65 with theta_v <= 70 deg: {values} values a band"
        )?;
        let (relative, absolute) = (100.0 * Noise::RELATIVE, Noise::ABSOLUTE);
        writeln!(f, "  noise       {relative} % of the value and {absolute} sr^-1; {bands} bands, 480 to 879 nm")?;
        writeln!(f)?;
        let row = |f: &mut fmt::Formatter<'_>, name: &str, cell: &dyn Fn(usize, &LeafReport) -> String| {
            write!(f, "{name:<36}")?;
            for (place, leaf) in self.leaves.iter().enumerate() {
                write!(f, "{:>21}", cell(place, leaf))?;
            }
            writeln!(f)
        };
        row(f, "", &|_, leaf| leaf.name.to_string())?;
        for (p, name, digits) in [(1, "n", 4), (2, "sigma", 5)] {
            row(f, &format!("{name}, true (Table 4)"), &|_, leaf| {
                format!("{}", (leaf.recovery[p].truth * 1e6).round() / 1e6)
            })?;
            row(f, &format!("{name}, mean of the bands ± s.e."), &|_, leaf| {
                let Recovery { mean, mean_se, .. } = leaf.recovery[p];
                format!("{mean:.*} ± {mean_se:.*}", digits, digits + 1)
            })?;
            row(f, "  error of a band (rms), its s.e.", &|_, leaf| {
                let Recovery { rms_error, rms_se, .. } = leaf.recovery[p];
                format!("{rms_error:.*}, {rms_se:.*}", digits, digits)
            })?;
        }
        row(f, "k_L, true, least to greatest", &|_, leaf| {
            let [least, greatest] = leaf.k_lambert_range;
            format!("{least:.3} to {greatest:.3}")
        })?;
        row(f, "  error of a band (rms), its s.e.", &|_, leaf| {
            let Recovery { rms_error, rms_se, .. } = leaf.recovery[0];
            format!("{rms_error:.5}, {rms_se:.5}")
        })?;
        row(f, "rmse of the fit, sr^-1", &|_, leaf| format!("{:.2e}", leaf.rmse))?;
        row(f, "  noise that was added", &|_, leaf| format!("{:.2e}", leaf.noise))?;
        row(f, "  paper, real leaves (Table 5)", &|place, _| printed(place, |p| format!("{:.2e}", p.rmse)))?;
        row(f, "(max - min)/mean of n, sigma, VIS", &|_, leaf| percent(leaf.invariance[0]))?;
        row(f, "  paper (4.3)", &|place, _| {
            printed(place, |p| format!("{:.0} %, {:.0} %", p.vis_percent[0], p.vis_percent[1]))
        })?;
        row(f, "(max - min)/mean of n, sigma, NIR", &|_, leaf| percent(leaf.invariance[1]))?;
        row(f, "greatest BRDF, theta_s 60, 680 nm", &|_, leaf| format!("{:.2}", leaf.maximum))?;
        row(f, "  paper (3.2)", &|place, _| printed(place, |p| format!("{}", p.maximum)))?;
        for (place, theta_s) in DHRF_SOURCES_DEG.iter().enumerate() {
            row(f, &format!("DHRF_spec at theta_s = {theta_s} deg"), &|_, leaf| {
                format!("{:.4}", leaf.dhrf_specular[place])
            })?;
        }
        row(f, "  at 21, 41, 60 deg / at 8 deg", &|_, leaf| {
            let [first, rest @ ..] = leaf.dhrf_specular;
            rest.map(|dhrf| format!("{:.2}", dhrf / first)).join(", ")
        })?;
        writeln!(f, "  paper (4.4): almost the same at 8, 21 and 41 deg, double at 60 deg")?;
        writeln!(f)?;
        writeln!(
            f,
            "Truth within one standard error: {:.1} % of {} (band, parameter) pairs; 68.3 % is right for Gaussian noise.",
            100.0 * self.covered(),
            self.leaves.iter().map(|leaf| 3 * leaf.bands).sum::<usize>()
        )?;
        row(f, "  for k_L, n, sigma, %", &|_, leaf| {
            leaf.recovery.map(|r| format!("{:.0}", 100.0 * r.covered)).join(", ")
        })?;
        writeln!(
            f,
            "Eq. 11 counts all values alike; laurel's peak is noisier than the rest, so its errors come out too small."
        )?;
        writeln!(f, "A long file with a column sd is weighted by 1/sd^2, which mends that.")
    }
}

fn printed(place: usize, cell: impl Fn(&Printed) -> String) -> String {
    PRINTED.get(place).map_or_else(String::new, cell)
}

fn percent([n, sigma]: [f64; 2]) -> String {
    format!("{:.1} %, {:.1} %", 100.0 * n, 100.0 * sigma)
}
