//! The interior's part of a leaf: k_L(λ) by a coupling, with its derivatives.

use std::vec;
use std::vec::Vec;

use leafbrdf_core::{DhrfGradient, Grade};
use leafbrdf_prospect::{Jacobian, LeafParams, Link, Parameter, TwoLayer};

use super::super::lobes::dhrf_at_zenith;
use super::super::parameters::{COUNT, GAIN, INTERIOR, OFFSET, interior, place};
use super::super::recipe::Interior;
use super::{Cost, Room};
use crate::surface::model::{N, SIGMA};

/// k_L and its derivatives, over all bands.
pub(in super::super) struct Diffuse {
    pub k: Vec<f64>,
    /// One run of bands for each parameter; empty where the derivative is 0.
    pub slopes: [Vec<f64>; COUNT],
}

impl Cost<'_> {
    /// k_L with derivatives by the free parameters; with `held`, ∂k_L/∂N and ∂k_L/∂f too.
    pub fn diffuse(&mut self, x: &[f64; COUNT], held: bool) -> Result<Diffuse, leafbrdf_prospect::Error> {
        let model = self.model;
        let view = model.prospect.view();
        let bands = view.len();
        let leaf = leaf_of(x);
        let free: [bool; COUNT] = core::array::from_fn(|i| self.is_free(i));
        let wanted: Vec<Parameter> = Parameter::ALL
            .into_iter()
            .filter(|one| self.is_free(place(*one)) || (held && *one == Parameter::NStruct))
            .collect();
        let Room { r, t, dr, dt, by_share, frozen } = &mut self.room;
        let (dr, dt) = (&mut dr[..wanted.len() * bands], &mut dt[..wanted.len() * bands]);
        let t_alpha = view.t_alpha();
        let mut k = vec![0.0; bands];
        match model.interior {
            // nothing in it moves: what it was before
            _ if *frozen && wanted.is_empty() && !held => {}
            Interior::Plain => {
                let room = Jacobian {
                    reflectance: &mut *r,
                    transmittance: &mut *t,
                    d_reflectance: &mut *dr,
                    d_transmittance: dt,
                };
                model.prospect.jacobian(&leaf, &wanted, room)?;
            }
            Interior::TwoLayer { upper_share } => {
                let interior = TwoLayer::new(model.prospect, upper_share)?;
                interior.jacobian(&leaf, &wanted, r, dr, held.then_some(&mut by_share[..]))?;
                // as R of a leaf whose first surface is PROSPECT's
                r.iter_mut().zip(t_alpha).for_each(|(r, t_alpha)| *r += 1.0 - t_alpha);
            }
        }
        // a free interior is asked for again at other values
        *frozen = wanted.is_empty();
        let mut slopes = [const { Vec::new() }; COUNT];
        let mut link = Link { dhrf_specular: 0.0, gain: x[GAIN], offset: x[OFFSET] };
        let mut dhrf = DhrfGradient { value: 0.0, d_n: 0.0, d_sigma: 0.0 };
        if let (Some(surface), true) = (model.surface, model.coupling.takes_surface()) {
            dhrf = dhrf_at_zenith(&surface, x[N], x[SIGMA], Grade::E8)?;
            link.dhrf_specular = dhrf.value;
        }
        let terms: Vec<_> =
            r.iter().zip(t_alpha).map(|(r, t_alpha)| model.coupling.diffuse(*r, *t_alpha, &link)).collect();
        for (k, term) in k.iter_mut().zip(&terms) {
            *k = term.k_lambert;
        }
        for (parameter, column) in wanted.iter().zip(dr.chunks_exact(bands)) {
            slopes[place(*parameter)] = column.iter().zip(&terms).map(|(d, term)| d * term.d_reflectance).collect();
        }
        let flat = |of: fn(&leafbrdf_prospect::DiffuseTerm<f64>) -> f64, factor: f64| -> Vec<f64> {
            terms.iter().map(|term| factor * of(term)).collect()
        };
        if free[GAIN] {
            slopes[GAIN] = flat(|term| term.d_gain, 1.0);
        }
        if free[OFFSET] {
            slopes[OFFSET] = flat(|term| term.d_offset, 1.0);
        }
        if model.coupling.takes_surface() && model.surface.is_some() {
            if free[N] {
                slopes[N] = flat(|term| term.d_dhrf_specular, dhrf.d_n);
            }
            if free[SIGMA] {
                slopes[SIGMA] = flat(|term| term.d_dhrf_specular, dhrf.d_sigma);
            }
        }
        if held {
            if matches!(model.interior, Interior::Plain) {
                by_share.fill(0.0);
            }
            by_share.iter_mut().zip(&terms).for_each(|(d, term)| *d *= term.d_reflectance);
        }
        Ok(Diffuse { k, slopes })
    }
}

/// PROSPECT's parameters among the leaf's.
pub(in super::super) fn leaf_of(x: &[f64; COUNT]) -> LeafParams<f64> {
    let mut leaf = LeafParams::with_n_struct(x[INTERIOR]);
    for (value, i) in x.iter().zip(0..) {
        if let Some(parameter) = interior(i) {
            leaf.set(parameter, *value);
        }
    }
    leaf
}
