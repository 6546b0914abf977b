//! The study as plain data: what went in, what every model made of it, what the paper prints.
//!
//! [`Study`] is the one place of these numbers: `text` prints them, and whoever draws a report takes them from here.

use leafbrdf_fit::leaf::{LeafFit, parameters};
use leafbrdf_fit::surface::SurfaceFit;
use leafbrdf_prospect::Parameter;

use super::bands::BandsReport;
use super::paper::{LAUREL_DHRF, Printed, Statement, Verdict};
use crate::fit::FitFailure;
use crate::hemisphere::{HemisphereOptions, hemispheres};
use crate::measurement::Measurement;
use crate::simulate::{CoupledLeaf, PresetLeaf};

/// A value and its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Its standard error; `None` where the fit gives none.
    pub se: Option<f64>,
}

/// The whole demo.
#[derive(Clone, Debug)]
pub struct Study {
    /// Laurel, beech, hazel.
    pub leaves: Vec<LeafStudy>,
    /// How DHRF_spec follows σ and n (§4.1).
    pub sensitivity: Vec<Statement>,
    /// Spectral invariance and the light that does not enter the leaf (§4.3, §4.4), judged on the demo's leaves.
    pub statements: Vec<Statement>,
    /// BRDF_spec of Table 4 in the mirror direction at 60°, sr⁻¹: under K = 2π² and under K = 4π.
    pub mirror_brdf: [[f64; 3]; 2],
}

/// One leaf.
#[derive(Clone, Debug)]
pub struct LeafStudy {
    /// `laurel`, `beech`, `hazel`.
    pub name: &'static str,
    /// The species.
    pub species: &'static str,
    /// n and σ that went in: Table 4's.
    pub surface_truth: [f64; 2],
    /// N, C_ab (µg cm⁻²), C_m (g cm⁻²) that went in: ours.
    pub interior_truth: [f64; 3],
    /// What the paper prints of this leaf.
    pub paper: Printed,
    /// k_L, n, σ in every band (§4.2).
    pub bands: BandsReport,
    /// One n and σ for the leaf, k_L in every band.
    pub surface: SurfaceStudy,
    /// Five parameters, n and σ first (§4.6).
    pub two_step: FiveParameters,
    /// Five parameters at once (Eq. 18), which the paper found unstable.
    pub joint: FiveParameters,
    /// DHRF by integration over the 98 views at θ_s = 60° (§3.1), at 550, 670, 780 nm.
    pub integrated: Vec<Integrated>,
}

/// The model with one surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceStudy {
    /// n and σ.
    pub surface: [Estimate; 2],
    /// RMSE over all values, sr⁻¹.
    pub rmse: f64,
    /// Greatest distance of k_L from the truth.
    pub k_lambert_worst: f64,
}

/// A fit of the five parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FiveParameters {
    /// n and σ.
    pub surface: [Estimate; 2],
    /// N, C_ab (µg cm⁻²), C_m (g cm⁻²).
    pub interior: [Estimate; 3],
    /// RMSE over all values, sr⁻¹ (Table 5, right column).
    pub rmse: f64,
    /// Starts searched from, and how many of them arrived at this minimum.
    pub starts: [u32; 2],
    /// Bands with a negative k_L.
    pub negative: usize,
}

/// DHRF of measured values, θ_s = 60°.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Integrated {
    /// Wavelength, nm.
    pub wavelength_nm: f64,
    /// What the paper says of its laurel (§3.1).
    pub paper_laurel: f64,
    /// The true DHRF.
    pub truth: f64,
    /// By interpolation between the views.
    pub plain: Estimate,
    /// The same with the fitted lobe subtracted before and added behind.
    pub subtracted: Estimate,
}

impl SurfaceStudy {
    pub(super) fn new(fit: &SurfaceFit, leaf: &CoupledLeaf) -> Self {
        let estimate = |p: usize| Estimate { value: fit.x[p], se: fit.errors.standard_errors[p] };
        let off = fit.bands.iter().zip(&leaf.k_lambert).map(|(band, truth)| (band.k_lambert? - truth).abs().into());
        SurfaceStudy {
            surface: [estimate(0), estimate(1)],
            rmse: fit.rmse,
            k_lambert_worst: off.map(|off: Option<f64>| off.unwrap_or(f64::NAN)).fold(0.0, f64::max),
        }
    }
}

impl FiveParameters {
    pub(super) fn new(fit: &LeafFit) -> Self {
        let estimate = |p: usize| Estimate { value: fit.x[p], se: fit.standard_errors[p] };
        FiveParameters {
            surface: [estimate(0), estimate(1)],
            interior: [Parameter::NStruct, Parameter::Cab, Parameter::Cm].map(|one| estimate(parameters::place(one))),
            rmse: fit.rmse,
            starts: [fit.starts, fit.agreeing],
            negative: fit.k_lambert.iter().filter(|k_l| **k_l < 0.0).count(),
        }
    }
}

impl LeafStudy {
    /// RMSE of five parameters over that of 3×400 (Table 5): the paper's way of fitting them, all at once, and as printed.
    pub fn rmse_ratios(&self) -> [f64; 3] {
        let [per_band, five] = self.paper.rmse;
        [self.two_step.rmse / self.bands.rmse, self.joint.rmse / self.bands.rmse, five / per_band]
    }

    /// N, C_ab, C_m of a preset.
    pub(super) fn interior_of(preset: &PresetLeaf) -> [f64; 3] {
        [preset.interior.n_struct, preset.interior.cab, preset.interior.cm]
    }
}

impl Study {
    /// Share of all (band, parameter) pairs whose standard error covers the truth; 68.3 % for Gaussian errors.
    pub fn covered(&self) -> f64 {
        let bands = || self.leaves.iter().map(|leaf| &leaf.bands);
        let all = || bands().flat_map(|leaf| leaf.recovery.iter().map(move |r| (r.covered, leaf.bands as f64)));
        all().map(|(share, bands)| share * bands).sum::<f64>() / all().map(|(_, bands)| bands).sum::<f64>()
    }
}

/// DHRF of the 98 views at θ_s = 60°, plain and with the lobe subtracted, beside the truth.
pub(super) fn integrated(measured: &Measurement, leaf: &CoupledLeaf) -> Result<Vec<Integrated>, FitFailure> {
    let chosen = thinned(measured);
    let plain = HemisphereOptions { theta_s_deg: Some(60.0), ..HemisphereOptions::default() };
    let subtracting = HemisphereOptions { subtract: Some(super::fit_options()), ..plain.clone() };
    let [plain, subtracted] = [plain, subtracting].map(|options| hemispheres(&chosen, &options));
    let (plain, subtracted) = (plain?, subtracted?);
    let (specular, shape) = leaf.dhrf_parts(60.0).map_err(|error| FitFailure(error.to_string()))?;
    let rows = plain.iter().zip(&subtracted);
    rows.map(|((_, nm, plain), (_, _, subtracted))| {
        let in_words = |error: &crate::hemisphere::NotMeasured| FitFailure(error.to_string());
        let (plain, subtracted) = (plain.as_ref().map_err(in_words)?, subtracted.as_ref().map_err(in_words)?);
        let estimate = |row: &crate::hemisphere::MeasuredDhrf| Estimate { value: row.dhrf(), se: Some(row.error()) };
        let band = leaf.wavelengths_nm.iter().position(|other| other == nm);
        Ok(Integrated {
            wavelength_nm: *nm,
            paper_laurel: LAUREL_DHRF.iter().find(|(other, _)| other == nm).map_or(f64::NAN, |(_, dhrf)| *dhrf),
            truth: band.map_or(f64::NAN, |band| specular + shape * leaf.k_lambert[band]),
            plain: estimate(plain),
            subtracted: estimate(subtracted),
        })
    })
    .collect()
}

/// The measurement at the wavelengths of Fig. 1 alone.
fn thinned(measured: &Measurement) -> Measurement {
    let places: Vec<usize> = (0..measured.wavelengths_nm.len())
        .filter(|band| LAUREL_DHRF.iter().any(|(nm, _)| *nm == measured.wavelengths_nm[*band]))
        .collect();
    Measurement {
        wavelengths_nm: places.iter().map(|band| measured.wavelengths_nm[*band]).collect(),
        values: places.iter().flat_map(|band| measured.band(*band).to_vec()).collect(),
        ..measured.clone()
    }
}

/// §4.3 and §4.4 on the demo's leaves. That n and σ are the same at every wavelength went in; what comes out shows how much
/// noise alone makes them vary.
pub(super) fn statements(leaves: &[LeafStudy]) -> Vec<Statement> {
    let of = |number: &dyn Fn(&LeafStudy) -> f64| -> Vec<(String, f64)> {
        leaves.iter().map(|leaf| (leaf.name.to_string(), number(leaf))).collect()
    };
    vec![
        Statement {
            section: "4.4",
            says: "DHRF_spec varies very slowly with the wavelength",
            found: of(&|leaf| leaf.bands.dhrf_specular_range),
            verdict: Verdict::Holds,
            because: "(max - min)/mean over the bands at 60 deg; only noise makes it vary here",
        },
        Statement {
            section: "4.4",
            says: "it is almost the same at theta_s = 8, 21 and 41 deg",
            found: of(&|leaf| leaf.bands.dhrf_specular[2] / leaf.bands.dhrf_specular[0]),
            verdict: Verdict::InPart,
            because: "41 deg over 8 deg; 21 deg differs by 1 to 2 %",
        },
        Statement {
            section: "4.4",
            says: "it is double at 60 deg",
            found: of(&|leaf| leaf.bands.dhrf_specular[3] / leaf.bands.dhrf_specular[0]),
            verdict: Verdict::InPart,
            because: "60 deg over 8 deg: nearly for beech, four times for the smooth laurel, half as much again for hazel",
        },
        Statement {
            section: "4.4",
            says: "it can exceed the diffuse part where absorption is strong",
            found: of(&|leaf| leaf.bands.specular_over_diffuse),
            verdict: Verdict::Holds,
            because: "greatest DHRF_spec/k_L at 60 deg; above 1 for beech and hazel",
        },
    ]
}
