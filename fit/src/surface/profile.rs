//! χ² with k_L eliminated in every row, its exact gradient, and Gauss and Newton's matrix.
//!
//! ```text
//! residual of row r:  ρ = z − g p − κ s,   κ = Σ ω s (z − g p)/Σ ω s²
//! χ² = Σ_r Σ_v ω ρ² (+ what no parameter reaches)
//! ∂χ²/∂x = −2 Σ_v [∂p Σ_r ω g ρ + ∂s Σ_r ω κ ρ]
//! ```
//!
//! p is the lobe, s the diffuse shape, z the measured row, g its gain. That κ moves with x adds nothing to the gradient: ρ is
//! perpendicular to s. k_L is not bounded here.

use leafbrdf_core::{DomainError, Real};

use super::model::{DirectionValue, DirectionalModel, PARAMETERS};
use super::moments::Moments;

/// One direction's place in the caller-owned workspace.
#[derive(Clone, Copy, Debug)]
pub struct Place<T> {
    value: DirectionValue<T>,
    /// Σ_r ω g ρ and Σ_r ω κ ρ
    residual: [T; 2],
    /// Σ_r ω g², Σ_r ω g κ, Σ_r ω κ²
    product: [T; 3],
}

impl<T: Real> Place<T> {
    /// An empty place.
    pub const fn empty() -> Self {
        Place { value: DirectionValue::dark(), residual: [T::ZERO; 2], product: [T::ZERO; 3] }
    }
}

/// χ² and its derivatives over [n, σ, a, b, t_x, t_y, e].
#[derive(Clone, Copy, Debug)]
pub struct Derivatives<T> {
    /// χ².
    pub chi2: T,
    /// ∂χ²/∂x.
    pub gradient: [T; PARAMETERS],
    /// JᵀWJ, J being the derivative of the model with k_L eliminated: the normal matrix, half of Gauss and Newton's Hessian.
    pub normal: [[T; PARAMETERS]; PARAMETERS],
}

/// χ² of a leaf as a function of its surface.
#[derive(Debug)]
pub struct Profile<'a, T, M> {
    model: &'a M,
    moments: Moments<'a, T>,
    places: &'a mut [Place<T>],
}

impl<'a, T: Real, M: DirectionalModel<T>> Profile<'a, T, M> {
    /// `None` unless there is one place a direction.
    pub fn new(model: &'a M, moments: Moments<'a, T>, places: &'a mut [Place<T>]) -> Option<Self> {
        (places.len() == model.directions()).then_some(Profile { model, moments, places })
    }

    /// χ² at [n, σ, a, b, t_x, t_y, e].
    ///
    /// # Errors
    /// The model's.
    pub fn chi2(&mut self, x: &[T; PARAMETERS]) -> Result<T, DomainError> {
        self.set_values(x)?;
        Ok(self.moments.constant + self.sum_up(|_| true, |_, _, _| ()))
    }

    fn set_values(&mut self, x: &[T; PARAMETERS]) -> Result<(), DomainError> {
        let mut places = self.places.iter_mut();
        self.model.values(x, |[diffuse, specular]| {
            if let Some(place) = places.next() {
                place.value.diffuse = diffuse;
                place.value.specular = specular;
            }
        })
    }

    /// The part of the last [`chi2`](Self::chi2) that no lobe reaches: the same for all n and σ, tilt and shape being held.
    pub fn chi2_without_lobe(&mut self) -> T {
        self.moments.constant + self.sum_up(|gain| gain == T::ZERO, |_, _, _| ())
    }

    /// The rest of χ², at [n, σ, a, b, t_x, t_y, e].
    ///
    /// # Errors
    /// The model's.
    pub fn chi2_of_lobe(&mut self, x: &[T; PARAMETERS]) -> Result<T, DomainError> {
        self.set_values(x)?;
        Ok(self.sum_up(|gain| gain != T::ZERO, |_, _, _| ()))
    }

    /// χ² of the asked rows, for the values that stand in the places; `each` is told ω, ρ, g and κ, direction by direction.
    #[inline(always)]
    fn sum_up(&mut self, rows: impl Fn(T) -> bool, mut each: impl FnMut(&mut Place<T>, T, [T; 3])) -> T {
        let width = self.places.len();
        let mut chi2 = T::ZERO;
        for group in self.moments.groups {
            let s2 = sum(group.weight.iter().zip(&*self.places).map(|(w, p)| *w * p.value.diffuse.squared()));
            for (row, gain) in group.rows.chunks_exact(width.max(1)).zip(group.gain).filter(|(_, gain)| rows(**gain)) {
                let s_z = self.onto_shape(group.weight, row, *gain);
                let kappa = if s2 > T::ZERO { s_z / s2 } else { T::ZERO };
                for ((w, z), place) in group.weight.iter().zip(row).zip(self.places.iter_mut()) {
                    let rho = *z - *gain * place.value.specular - kappa * place.value.diffuse;
                    chi2 += *w * rho.squared();
                    each(place, *w, [rho, *gain, kappa]);
                }
            }
        }
        chi2
    }

    /// Σ ω s (z − g p).
    #[inline(always)]
    fn onto_shape(&self, weight: &[T], row: &[T], gain: T) -> T {
        let terms = weight.iter().zip(row).zip(&*self.places);
        sum(terms.map(|((w, z), p)| *w * p.value.diffuse * (*z - gain * p.value.specular)))
    }

    /// χ² with its derivatives.
    ///
    /// # Errors
    /// The model's.
    pub fn derivatives(&mut self, x: &[T; PARAMETERS]) -> Result<Derivatives<T>, DomainError> {
        let mut places = self.places.iter_mut();
        self.model.derivatives(x, |value| {
            if let Some(place) = places.next() {
                *place = Place { value, ..Place::empty() };
            }
        })?;
        let chi2 = self.moments.constant
            + self.sum_up(
                |_| true,
                |place, w, [rho, gain, kappa]| {
                    let (w_gain, w_kappa) = (w * gain, w * kappa);
                    place.residual[0] += w_gain * rho;
                    place.residual[1] += w_kappa * rho;
                    place.product[0] += w_gain * gain;
                    place.product[1] += w_gain * kappa;
                    place.product[2] += w_kappa * kappa;
                },
            );
        let mut gradient = [T::ZERO; PARAMETERS];
        let mut normal = [[T::ZERO; PARAMETERS]; PARAMETERS];
        for place in &*self.places {
            let (p, s) = (&place.value.d_specular, &place.value.d_diffuse);
            let [gg, gk, kk] = place.product;
            for i in 0..PARAMETERS {
                gradient[i] -= T::TWO * (p[i] * place.residual[0] + s[i] * place.residual[1]);
                // Σ_r ω (g p_i + κ s_i)(g p_j + κ s_j)
                let (of_p, of_s) = (p[i] * gg + s[i] * gk, p[i] * gk + s[i] * kk);
                for j in 0..=i {
                    normal[i][j] += of_p * p[j] + of_s * s[j];
                }
            }
        }
        self.project(&mut normal);
        for i in 0..PARAMETERS {
            for j in 0..i {
                normal[j][i] = normal[i][j];
            }
        }
        Ok(Derivatives { chi2, gradient, normal })
    }

    /// Takes out of the normal matrix what κ can follow: Σ_r t_i t_j/Σ ω s², t_i = Σ_v ω s (g p_i + κ s_i).
    fn project(&self, normal: &mut [[T; PARAMETERS]; PARAMETERS]) {
        let width = self.places.len();
        for group in self.moments.groups {
            let mut s2 = T::ZERO;
            let mut on_p = [T::ZERO; PARAMETERS];
            let mut on_s = [T::ZERO; PARAMETERS];
            for (w, place) in group.weight.iter().zip(&*self.places) {
                let w_s = *w * place.value.diffuse;
                s2 += w_s * place.value.diffuse;
                for i in 0..PARAMETERS {
                    on_p[i] += w_s * place.value.d_specular[i];
                    on_s[i] += w_s * place.value.d_diffuse[i];
                }
            }
            if !(s2 > T::ZERO) {
                continue;
            }
            // Σ_r g², Σ_r g κ, Σ_r κ²
            let (mut gg, mut gk, mut kk) = (T::ZERO, T::ZERO, T::ZERO);
            for (row, gain) in group.rows.chunks_exact(width.max(1)).zip(group.gain) {
                let kappa = self.onto_shape(group.weight, row, *gain) / s2;
                gg += gain.squared();
                gk += *gain * kappa;
                kk += kappa.squared();
            }
            let inverse = T::ONE / s2;
            for i in 0..PARAMETERS {
                let of_p = (on_p[i] * gg + on_s[i] * gk) * inverse;
                let of_s = (on_p[i] * gk + on_s[i] * kk) * inverse;
                for j in 0..=i {
                    normal[i][j] -= of_p * on_p[j] + of_s * on_s[j];
                }
            }
        }
    }
}

#[inline(always)]
fn sum<T: Real>(terms: impl Iterator<Item = T>) -> T {
    terms.fold(T::ZERO, |sum, term| sum + term)
}
