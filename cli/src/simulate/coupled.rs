//! The five-parameter leaf (Eq. 18) with its true k_L(λ).

use std::f64::consts::PI;

use leafbrdf_core::{Angle, Illumination, Normalization, Surface};
use leafbrdf_prospect::{Coupling, LeafParams, Link, Prospect, Version};

use super::{AnyDiffuse, AnySurface, PresetLeaf, SimulationError};
use crate::measurement::Metadata;
use crate::spectra::Grid;

/// What makes a leaf: the parameters behind a simulated measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeafModel {
    /// n, σ, their facets and their convention for K.
    pub surface: AnySurface,
    /// Shape of the diffuse term.
    pub diffuse: AnyDiffuse,
    /// Version of PROSPECT.
    pub version: Version,
    /// Structure and contents.
    pub interior: LeafParams<f64>,
    /// From PROSPECT's reflectance to k_L.
    pub coupling: Coupling,
    /// Gain and offset of the couplings that have them.
    pub gain: f64,
    /// See [`gain`](Self::gain).
    pub offset: f64,
}

impl LeafModel {
    /// The paper's leaf: Beckmann facets, Lambert's diffuse term, PROSPECT-D, Eq. 17.
    pub fn new(surface: Surface<f64>, interior: LeafParams<f64>) -> Self {
        LeafModel {
            surface: AnySurface::Beckmann(surface),
            diffuse: AnyDiffuse::Lambert,
            version: Version::D,
            interior,
            coupling: Coupling::Bousquet,
            gain: 1.0,
            offset: 0.0,
        }
    }

    /// A preset, n and σ under the convention that they belong to (K = 2π²).
    ///
    /// # Errors
    /// None for the presets as they stand.
    pub fn of_preset(preset: &PresetLeaf) -> Result<Self, SimulationError> {
        let surface = Surface::new(preset.n, preset.sigma)?.with_normalization(Normalization::Bousquet2005);
        Ok(LeafModel::new(surface, preset.interior))
    }

    /// The leaf at these wavelengths, nm, rising; between the 1 nm of PROSPECT's tables they are interpolated.
    ///
    /// # Errors
    /// Parameters of the interior outside PROSPECT's limits, wavelengths outside 400–2500 nm.
    pub fn at(&self, wavelengths_nm: &[f64]) -> Result<CoupledLeaf, SimulationError> {
        let grid = Grid::new(wavelengths_nm.to_vec());
        let mut room = grid.room(self.version);
        let view = grid.view(self.version, &mut room)?;
        let (mut reflectance, mut transmittance) = (vec![0.0; view.len()], vec![0.0; view.len()]);
        Prospect::new(view).spectrum(&self.interior, &mut reflectance, &mut transmittance)?;

        let dhrf_specular = self.surface.dhrf(&Illumination::new(Angle::from_degrees(0.0))?);
        let link = Link { dhrf_specular, gain: self.gain, offset: self.offset };
        let k_lambert = reflectance
            .iter()
            .zip(view.t_alpha())
            .map(|(reflectance, t_alpha)| self.coupling.diffuse(*reflectance, *t_alpha, &link).k_lambert)
            .collect();
        Ok(CoupledLeaf { model: *self, wavelengths_nm: wavelengths_nm.to_vec(), k_lambert, dhrf_specular })
    }

    /// The parameters as lines of a file's header: all that is needed to compute the leaf again.
    pub fn describe(&self, metadata: &mut Metadata) {
        let surface = &self.surface;
        metadata.push(
            "surface",
            format!(
                "n {}, sigma {}, {} facets, normalization {}",
                surface.n(),
                surface.sigma(),
                surface.kind().name(),
                surface.normalization().name()
            ),
        );
        let diffuse = match &self.diffuse {
            AnyDiffuse::Lambert => "lambert".to_string(),
            AnyDiffuse::P1(bowl) => format!("p1, a {}, b {}", bowl.a(), bowl.b()),
        };
        metadata.push("diffuse", diffuse);
        let mut interior = format!("PROSPECT-{}", self.version.name());
        for parameter in
            std::iter::once(leafbrdf_prospect::Parameter::NStruct).chain(self.version.constituents().iter().copied())
        {
            let value = self.interior.get(parameter);
            interior += &format!(", {} {value}", parameter.name());
            if value != 0.0 && !parameter.unit().is_empty() {
                interior += &format!(" {}", parameter.unit());
            }
        }
        metadata.push("interior", interior);
        let coupling = match self.coupling {
            Coupling::Offset => format!("offset, b {}", self.offset),
            Coupling::GainOffset => format!("gain-offset, g {}, b {}", self.gain, self.offset),
            coupling => coupling.name().to_string(),
        };
        metadata.push("coupling", coupling);
    }
}

/// A leaf at some wavelengths: the true values behind a simulated measurement.
#[derive(Clone, Debug)]
pub struct CoupledLeaf {
    /// Its parameters.
    pub model: LeafModel,
    /// Wavelengths, nm, rising.
    pub wavelengths_nm: Vec<f64>,
    /// k_L(λ); for Eq. 17's coupling R_prospect(λ) − DHRF_spec(n, σ, 0°).
    pub k_lambert: Vec<f64>,
    /// DHRF_spec(n, σ, 0°).
    pub dhrf_specular: f64,
}

impl CoupledLeaf {
    /// The number of wavelengths at which k_L is negative: there the interior and the surface do not go together.
    pub fn negative(&self) -> usize {
        self.k_lambert.iter().filter(|k_l| **k_l < 0.0).count()
    }

    /// DHRF_spec and DHRF_diff/k_L at θ_s; the DHRF is their sum after the latter is multiplied by k_L (Eq. 12).
    ///
    /// # Errors
    /// θ_s outside [0°, 90°).
    pub fn dhrf_parts(&self, theta_s_deg: f64) -> Result<(f64, f64), SimulationError> {
        let theta_s = Angle::from_degrees(theta_s_deg);
        let specular = self.model.surface.dhrf(&Illumination::new(theta_s)?);
        Ok((specular, self.model.diffuse.hemispherical(theta_s.radians().cos())))
    }

    /// The largest k_L, over π: the scale of the diffuse term, sr⁻¹.
    pub fn brightest_diffuse(&self) -> f64 {
        self.k_lambert.iter().copied().fold(f64::NEG_INFINITY, f64::max) / PI
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::presets;
    use leafbrdf_prospect::table;

    fn interior() -> LeafParams<f64> {
        LeafParams { cab: 40.0, car: 10.0, cw: 0.01, cm: 0.009, ..LeafParams::with_n_struct(1.5) }
    }

    fn paper_bands() -> Vec<f64> {
        (480..=879).map(f64::from).collect()
    }

    #[test]
    fn lambert_coefficient_and_specular_dhrf_add_up_to_prospects_reflectance() {
        let surface = Surface::new(1.56, 0.29).unwrap();
        let leaf = LeafModel::new(surface, interior()).at(&paper_bands()).unwrap();
        let model = Prospect::new(table::full(Version::D));
        for (nm, k_l) in leaf.wavelengths_nm.iter().zip(&leaf.k_lambert) {
            let r = model.band(&interior(), *nm as usize - 400).unwrap().reflectance;
            // both sides f64: the kernel and the single band agree to rounding
            assert!((k_l + leaf.dhrf_specular - r).abs() < 1e-14, "{nm} nm");
        }
    }

    #[test]
    fn a_surface_brighter_than_the_whole_leaf_is_counted() {
        // n = 3 reflects 16 % at normal incidence under K = 2π², more than a green leaf in the red
        let leaf = LeafModel::new(Surface::new(3.0, 0.1).unwrap(), interior()).at(&paper_bands()).unwrap();
        assert!(leaf.negative() > 100 && leaf.negative() < 400);
    }

    // §3.1, to the one decimal that it prints
    #[test]
    fn laurel_reflects_about_a_tenth_of_red_a_fifth_of_green_and_half_of_infrared_light_at_60_degrees() {
        let leaf = LeafModel::of_preset(&presets()[0]).unwrap().at(&[550.0, 670.0, 780.0]).unwrap();
        let (specular, shape) = leaf.dhrf_parts(60.0).unwrap();
        for (k_l, printed) in leaf.k_lambert.iter().zip([0.2, 0.1, 0.5]) {
            let dhrf = k_l * shape + specular;
            assert!((dhrf - printed).abs() < 0.05, "{dhrf}, paper {printed}");
        }
    }

    // a leaf's spectrum (Fig. 7): green above blue and red, an edge at 700 nm, a plateau of 0.4 to 0.55
    #[test]
    fn every_preset_has_the_spectrum_of_a_green_leaf_and_a_positive_lambert_coefficient() {
        for preset in presets() {
            let leaf = LeafModel::of_preset(&preset).unwrap().at(&paper_bands()).unwrap();
            let k_l = |nm: usize| leaf.k_lambert[nm - 480];
            assert!(k_l(550) > 2.0 * k_l(480) && k_l(550) > 2.0 * k_l(675), "{}", preset.name);
            assert!(k_l(750) > 3.0 * k_l(690), "{}", preset.name);
            assert!(k_l(780) > 0.4 && k_l(780) < 0.55 && (k_l(879) / k_l(780) - 1.0).abs() < 0.02, "{}", preset.name);
            // Table 3's lower bound
            assert!(leaf.k_lambert.iter().all(|k_l| *k_l > 0.01), "{}", preset.name);
        }
    }

    #[test]
    fn impossible_input_is_refused_by_name() {
        let model = LeafModel::new(Surface::new(1.5, 0.3).unwrap(), interior());
        let error = |model: &LeafModel, nm: &[f64]| model.at(nm).unwrap_err().to_string();
        assert!(error(&model, &[300.0, 800.0]).contains("300"));
        assert!(error(&model, &[800.0, 2501.0]).contains("2501"));
        let heavy = LeafModel { interior: LeafParams { cm: 9.0, ..interior() }, ..model };
        assert!(error(&heavy, &[800.0]).contains("cm"));
    }
}
