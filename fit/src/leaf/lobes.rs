//! What the surface makes of every direction: shape and lobe with their derivatives, and the lobe's DHRF.

use std::vec::Vec;

use leafbrdf_core::{Angle, DhrfGradient, DomainError, Grade, Illumination, Normalization, Surface};

use super::engine::{Diffuse, Model};
use super::parameters::COUNT;
use crate::surface::model::{N, PARAMETERS};
use crate::surface::{DirectionValue, DirectionalModel, FacetKind, LeafModel};

/// Shape and lobe of every direction, once for the leaf, or band by band where the index follows the table.
pub(super) enum Lobes {
    /// A single diffuse reflectance: π s = 1, no lobe.
    None(DirectionValue<f64>),
    Shared(Vec<DirectionValue<f64>>),
    Banded {
        values: Vec<DirectionValue<f64>>,
        directions: usize,
        index: Vec<f64>,
    },
}

impl Lobes {
    pub fn new(model: &Model<'_>, x: &[f64; COUNT]) -> Result<Self, leafbrdf_prospect::Error> {
        let outside = |_: DomainError| leafbrdf_prospect::Error::SurfaceIndex { value: x[N] };
        let Some(surface) = &model.surface else {
            let diffuse = core::f64::consts::FRAC_1_PI;
            return Ok(Lobes::None(DirectionValue { diffuse, ..DirectionValue::dark() }));
        };
        let mut at: [f64; PARAMETERS] = core::array::from_fn(|i| x[i]);
        let directions = surface.directions.len();
        if !model.scaled_index {
            let mut values = Vec::with_capacity(directions);
            surface.derivatives(&at, |value| values.push(value)).map_err(outside)?;
            return Ok(Lobes::Shared(values));
        }
        let view = model.prospect.view();
        let index: Vec<f64> = (0..view.len()).map(|band| view.refractive_index(band).unwrap_or(1.0)).collect();
        let mut values = Vec::with_capacity(directions * index.len());
        for material in &index {
            at[N] = x[N] * material;
            surface.derivatives(&at, |value| values.push(value)).map_err(outside)?;
        }
        Ok(Lobes::Banded { values, directions, index })
    }

    #[inline(always)]
    pub fn at(&self, direction: usize, band: usize) -> &DirectionValue<f64> {
        match self {
            Lobes::None(value) => value,
            Lobes::Shared(values) => &values[direction],
            Lobes::Banded { values, directions, .. } => &values[band * directions + direction],
        }
    }

    /// Measured − modelled reflectance of one direction.
    pub fn residual(&self, direction: usize, k: &[f64], measured: &[f64], residual: &mut [f64]) {
        let pi = core::f64::consts::PI;
        if let Lobes::Banded { .. } = self {
            for (band, ((r, y), k)) in residual.iter_mut().zip(measured).zip(k).enumerate() {
                let value = self.at(direction, band);
                *r = y - pi * (k * value.diffuse + value.specular);
            }
            return;
        }
        let value = self.at(direction, 0);
        let (shape, lobe) = (pi * value.diffuse, pi * value.specular);
        for ((r, y), k) in residual.iter_mut().zip(measured).zip(k) {
            *r = y - (k * shape + lobe);
        }
    }

    /// ∂(modelled reflectance)/∂(parameter i) of one direction.
    pub fn column(&self, direction: usize, i: usize, diffuse: &Diffuse, column: &mut [f64]) {
        let pi = core::f64::consts::PI;
        if i < PARAMETERS {
            if let Lobes::Banded { .. } = self {
                for (band, (c, k)) in column.iter_mut().zip(&diffuse.k).enumerate() {
                    let value = self.at(direction, band);
                    *c = pi * (k * value.d_diffuse[i] + self.index_scale(i, band) * value.d_specular[i]);
                }
            } else {
                let value = self.at(direction, 0);
                let (shape, lobe) = (pi * value.d_diffuse[i], pi * value.d_specular[i]);
                for (c, k) in column.iter_mut().zip(&diffuse.k) {
                    *c = k * shape + lobe;
                }
            }
        } else {
            column.fill(0.0);
        }
        // through k_L; empty where it does not depend on this parameter
        let slopes = &diffuse.slopes[i];
        if let Lobes::Banded { .. } = self {
            for (band, (c, slope)) in column.iter_mut().zip(slopes).enumerate() {
                *c += pi * self.at(direction, band).diffuse * slope;
            }
        } else {
            let shape = pi * self.at(direction, 0).diffuse;
            for (c, slope) in column.iter_mut().zip(slopes) {
                *c += shape * slope;
            }
        }
    }

    /// d(index)/d(coefficient) for n; 1 for everything else.
    #[inline(always)]
    fn index_scale(&self, parameter: usize, band: usize) -> f64 {
        match self {
            Lobes::Banded { index, .. } if parameter == N => index[band],
            _ => 1.0,
        }
    }
}

/// DHRF_spec at normal incidence, with derivatives.
pub(super) fn dhrf_at_zenith(
    model: &LeafModel<'_, f64>,
    n: f64,
    sigma: f64,
    grade: Grade,
) -> Result<DhrfGradient<f64>, leafbrdf_prospect::Error> {
    let outside = |_: DomainError| leafbrdf_prospect::Error::SurfaceIndex { value: n };
    let zenith = Illumination::new(Angle::from_radians(0.0)).map_err(outside)?;
    dhrf(model.facets, model.normalization, n, sigma, &zenith, grade).map_err(outside)
}

/// DHRF_spec of either kind of facets.
pub fn dhrf(
    facets: FacetKind,
    normalization: Normalization,
    n: f64,
    sigma: f64,
    source: &Illumination<f64>,
    grade: Grade,
) -> Result<DhrfGradient<f64>, DomainError> {
    Ok(match facets {
        FacetKind::Beckmann => {
            Surface::new(n, sigma)?.with_normalization(normalization).dhrf_with_gradient(source, grade)
        }
        FacetKind::Ggx => Surface::ggx(n, sigma)?.with_normalization(normalization).dhrf_with_gradient(source, grade),
    })
}
