//! χ² of a whole leaf with exact derivatives by all of its parameters.
//!
//! ```text
//! BRDF(λ, v) = k_L(λ) · s_v(a, b, tilt) + p_v(n, σ, tilt),   k_L from the interior by a coupling (Eqs 17, 18)
//! ∂BRDF      = s ∂k_L + k_L ∂s + ∂p
//! ```
//!
//! Everything is in reflectance (π · BRDF). Directions are independent of each other, wavelengths as a [`ResidualModel`] says.

mod diffuse;
mod normal;

use std::vec;
use std::vec::Vec;

pub(super) use diffuse::{Diffuse, leaf_of};

use leafbrdf_prospect::{Coupling, Parameter, Prospect};

use super::lobes::Lobes;
use super::parameters::{Axis, COUNT, Prior, Treatment};
use super::recipe::Interior;
use super::residuals::{ResidualModel, Whitening};
use crate::bounds::Interval;
use crate::solver::{Evaluation, Minimum, Objective, SolverOptions, minimize};
use crate::surface::LeafModel;
use crate::surface::model::PARAMETERS;

/// What a leaf is made of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Model<'a> {
    /// PROSPECT at the measured wavelengths.
    pub prospect: Prospect<'a, f64>,
    pub interior: Interior,
    pub coupling: Coupling,
    /// n is a coefficient on the tabulated index: PROSPECULAR's surface.
    pub scaled_index: bool,
    /// The directions with their surface; without it the measurement is a single diffuse reflectance.
    pub surface: Option<LeafModel<'a, f64>>,
}

/// What was measured, in reflectance: direction by direction, one value a band, NaN where missing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measured<'a> {
    pub wavelengths_nm: &'a [f64],
    pub brf: &'a [f64],
    /// Standard deviations; they multiply the white part of the residual model.
    pub sd: Option<&'a [f64]>,
}

/// Room that one search after the other uses.
struct Room {
    r: Vec<f64>,
    t: Vec<f64>,
    dr: Vec<f64>,
    dt: Vec<f64>,
    by_share: Vec<f64>,
    /// The interior is frozen, and `r` holds its reflectance.
    frozen: bool,
}

/// χ² as a function of the coordinates.
pub(super) struct Cost<'a> {
    pub model: Model<'a>,
    pub measured: Measured<'a>,
    pub axes: [Axis; COUNT],
    pub priors: [Option<Prior>; COUNT],
    /// What one squared standard deviation of a prior weighs, in units of χ².
    pub prior_weight: f64,
    whitenings: Vec<Whitening>,
    /// Which whitening each direction has: those without gaps share the first.
    whitening_of: Vec<usize>,
    room: Room,
    columns: Vec<f64>,
}

impl<'a> Cost<'a> {
    pub fn new(
        model: Model<'a>,
        measured: Measured<'a>,
        residuals: &ResidualModel,
        treatments: &[Treatment; COUNT],
        prior_weight: f64,
    ) -> Self {
        let bands = measured.wavelengths_nm.len();
        let mut whitenings = Vec::new();
        let mut whitening_of = Vec::new();
        let mut full = None;
        let first_surface = model.prospect.view().t_alpha().iter().map(|t_alpha| 1.0 - t_alpha);
        for (direction, values) in measured.brf.chunks_exact(bands.max(1)).enumerate() {
            let gapless = values.iter().all(|y| !y.is_nan()) && measured.sd.is_none();
            if let (true, Some(shared)) = (gapless, full) {
                whitening_of.push(shared);
                continue;
            }
            let scale = |band: usize| match measured.sd {
                _ if values.get(band).is_none_or(|y| y.is_nan()) => 0.0,
                Some(sd) => sd.get(direction * bands + band).copied().unwrap_or(0.0),
                None => 1.0,
            };
            whitenings.push(Whitening::new(residuals, measured.wavelengths_nm, first_surface.clone(), scale));
            whitening_of.push(whitenings.len() - 1);
            if gapless {
                full = Some(whitenings.len() - 1);
            }
        }
        let free = treatments.iter().filter(|one| one.is_free()).count();
        let axes: [Axis; COUNT] = core::array::from_fn(|i| Axis::new(i, &treatments[i]));
        let wanted = Parameter::ALL.len();
        Cost {
            model,
            measured,
            axes,
            priors: treatments.map(|one| one.prior()),
            prior_weight,
            whitenings,
            whitening_of,
            room: Room {
                r: vec![0.0; bands],
                t: vec![0.0; bands],
                dr: vec![0.0; wanted * bands],
                dt: vec![0.0; wanted * bands],
                by_share: vec![0.0; bands],
                frozen: false,
            },
            columns: vec![0.0; (free + 4) * bands],
        }
    }

    /// Values that count.
    pub fn used(&self) -> usize {
        self.whitening_of.iter().filter_map(|i| self.whitenings.get(*i)).map(Whitening::used).sum()
    }

    /// The parameters at u, and their slopes.
    pub fn parameters(&self, u: &[f64; COUNT]) -> ([f64; COUNT], [f64; COUNT]) {
        let mut slopes = [0.0; COUNT];
        let x = core::array::from_fn(|i| {
            let (x, slope) = self.axes[i].value(u[i]);
            slopes[i] = slope;
            x
        });
        (x, slopes)
    }

    /// The coordinates of x, inside the bounds.
    pub fn coordinates(&self, x: &[f64; COUNT]) -> [f64; COUNT] {
        core::array::from_fn(|i| self.axes[i].coordinate(x[i]))
    }

    fn is_free(&self, i: usize) -> bool {
        !matches!(self.axes[i], Axis::Held(_))
    }

    /// The modelled reflectance, direction by direction.
    pub fn modelled(&mut self, x: &[f64; COUNT]) -> Result<Vec<f64>, leafbrdf_prospect::Error> {
        let diffuse = self.diffuse(x, false)?;
        let lobes = Lobes::new(&self.model, x)?;
        let bands = diffuse.k.len();
        let pi = core::f64::consts::PI;
        Ok((0..self.whitening_of.len() * bands)
            .map(|i| {
                let (direction, band) = (i / bands, i % bands);
                let value = lobes.at(direction, band);
                pi * (diffuse.k[band] * value.diffuse + value.specular)
            })
            .collect())
    }

    /// Searches from a start.
    pub fn search(&mut self, start: &[f64; COUNT], tolerance: f64, max_iterations: u32) -> Minimum<f64, COUNT> {
        let bounds: [Interval<f64>; COUNT] = core::array::from_fn(|i| self.axes[i].bounds());
        let u = self.coordinates(start);
        let max_step = core::array::from_fn(|i| match self.axes[i] {
            // logarithms of contents: no more than a factor of 4.5 at once
            Axis::Log(_) => 1.5,
            Axis::Fresnel(_) => 1.0,
            Axis::Shifted(bounds, origin) => 0.35 * ((bounds.upper + origin) / (bounds.lower + origin)).ln(),
            Axis::Plain(_) if i < PARAMETERS => 0.25,
            _ => 1.5,
        });
        minimize(self, &bounds, &u, &SolverOptions { tolerance, max_iterations, max_step })
    }
}

impl Objective<f64, COUNT> for Cost<'_> {
    fn evaluate(&mut self, u: &[f64; COUNT]) -> Evaluation<f64, COUNT> {
        let (x, slope) = self.parameters(u);
        let mut gradient = [0.0; COUNT];
        let mut gauss_newton = [[0.0; COUNT]; COUNT];
        for (i, row) in gauss_newton.iter_mut().enumerate() {
            // a held parameter stays where it is
            row[i] = if self.is_free(i) { 0.0 } else { 1.0 };
        }
        let mut cost = f64::MAX;
        // outside the model's domain: a cost that no step is taken for
        if let Ok(normal) = self.normal(&x, false) {
            cost = normal.chi2;
            for i in (0..COUNT).filter(|i| self.is_free(*i)) {
                gradient[i] = -2.0 * normal.score[i] * slope[i];
                for j in (0..COUNT).filter(|j| self.is_free(*j)) {
                    gauss_newton[i][j] = 2.0 * normal.matrix[i][j] * slope[i] * slope[j];
                }
                if let Some(prior) = self.priors[i] {
                    let (misfit, by_x) = prior.misfit(x[i]);
                    cost += self.prior_weight * misfit * misfit;
                    gradient[i] += 2.0 * self.prior_weight * misfit * by_x * slope[i];
                    gauss_newton[i][i] += 2.0 * self.prior_weight * (by_x * slope[i]).powi(2);
                }
            }
            if !cost.is_finite() {
                cost = f64::MAX;
            }
        }
        Evaluation { cost, gradient, hessian: gauss_newton, gauss_newton }
    }
}

#[cfg(test)]
mod tests {
    use leafbrdf_core::{Angle, DirectionVectors, Normalization};
    use leafbrdf_prospect::Version;

    use super::super::parameters::{GAIN, NAMES, OFFSET, place};
    use super::super::problem::{default_bounds, tabulate, view};
    use super::*;
    use crate::surface::model::{N, SIGMA};
    use crate::surface::{DiffuseKind, FacetKind};

    const NM: [f64; 7] = [450.0, 550.0, 710.0, 850.0, 1250.0, 1650.0, 2200.0];

    fn directions() -> Vec<DirectionVectors<f64>> {
        let deg = Angle::from_degrees;
        [(30.0, 0.0), (30.0, 180.0), (55.0, 150.0), (15.0, 60.0)]
            .map(|(theta_v, phi_v)| DirectionVectors::from_angles(deg(35.0), deg(theta_v), deg(phi_v)).unwrap())
            .to_vec()
    }

    /// χ² at x of a leaf that is somewhere else, every parameter free; with its gradient by the coordinates.
    fn check(coupling: Coupling, scaled_index: bool, interior: Interior, facets: FacetKind, residuals: ResidualModel) {
        let directions = directions();
        let columns = tabulate(Version::D, &NM).unwrap();
        let surface = LeafModel {
            directions: &directions,
            facets,
            diffuse: DiffuseKind::P2,
            normalization: Normalization::CookTorrance,
        };
        let model = Model {
            prospect: Prospect::new(view(Version::D, &NM, &columns).unwrap()),
            interior,
            coupling,
            scaled_index,
            surface: Some(surface),
        };
        let mut x = [0.0; COUNT];
        x[..PARAMETERS].copy_from_slice(&[1.45, 0.3, 0.12, -0.05, 0.03, -0.02, 0.08]);
        if scaled_index {
            x[N] = 1.05;
        }
        for (parameter, value) in Parameter::ALL.into_iter().zip([1.6, 35.0, 9.0, 2.0, 0.1, 0.012, 0.007, 0.0, 0.0]) {
            x[place(parameter)] = value;
        }
        (x[GAIN], x[OFFSET]) = (1.08, 0.015);
        let [cab, prot, cbc] = [Parameter::Cab, Parameter::Prot, Parameter::Cbc].map(place);
        let treatments: [Treatment; COUNT] = core::array::from_fn(|i| match i {
            // unknown to version D
            i if i == prot || i == cbc => Treatment::Held(0.0),
            N => Treatment::Free { bounds: Interval::new(if scaled_index { 0.8 } else { 1.1 }, 3.0), prior: None },
            SIGMA => Treatment::Free { bounds: Interval::new(0.01, 1.0), prior: Some(Prior::plain(0.2, 0.1)) },
            2..PARAMETERS => Treatment::Free { bounds: Interval::new(-0.3, 0.3), prior: Some(Prior::plain(0.0, 0.1)) },
            i if i == cab => Treatment::within(i, default_bounds(i, true), Some(Prior::log(60.0, 0.5))),
            _ => Treatment::Free { bounds: default_bounds(i, false), prior: None },
        });
        let brf: Vec<f64> = (0..directions.len() * NM.len()).map(|i| 0.2 + 0.1 * ((i * i) as f64).sin()).collect();
        let measured = Measured { wavelengths_nm: &NM, brf: &brf, sd: None };
        let mut cost = Cost::new(model, measured, &residuals, &treatments, 0.7);
        let u = cost.coordinates(&x);
        let exact = cost.evaluate(&u);
        for i in (0..COUNT).filter(|i| treatments[*i].is_free()) {
            let h = 1e-4 * cost.axes[i].bounds().width();
            let mut at = |step: f64| {
                let mut u = u;
                u[i] += step;
                cost.evaluate(&u).cost
            };
            let difference = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
            // rounding 1e-16 · cost/h; DHRF by grade E8 makes steps of 4e-9 of itself where its nodes change
            let tolerance = 1e-7 * exact.cost.max(exact.gradient[i].abs());
            assert!(
                (exact.gradient[i] - difference).abs() < tolerance,
                "{}: {} {difference}",
                NAMES[i],
                exact.gradient[i]
            );
        }
    }

    #[test]
    fn the_gradient_is_that_of_differences_under_every_coupling_interior_and_facet() {
        let two = Interior::TwoLayer { upper_share: 0.65 };
        let slow = ResidualModel { slow_sd: 0.01, length_nm: 100.0, white_sd: 0.005, surface_sd: 0.01 };
        let white = ResidualModel::white(1.0);
        check(Coupling::Bousquet, false, Interior::Plain, FacetKind::Beckmann, white);
        check(Coupling::Bousquet, false, two, FacetKind::Ggx, white);
        check(Coupling::Prospecular, true, Interior::Plain, FacetKind::Beckmann, white);
        check(Coupling::Offset, false, Interior::Plain, FacetKind::Ggx, slow);
        check(Coupling::GainOffset, false, two, FacetKind::Beckmann, slow);
    }
}
