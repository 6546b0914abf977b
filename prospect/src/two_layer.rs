//! A leaf of two stacks of plates, the upper one holding more than half of the pigments: palisade over spongy tissue.
//!
//! Stacks of N/2 plates each; water and dry matter are everywhere alike, the share f of the pigments is in the upper one:
//! K₁ = (2 f K_p + K_c)/N, K₂ = (2 (1−f) K_p + K_c)/N, K_p and K_c being what the pigments and the rest absorb in the whole leaf.
//! Light falls on isotropically, R_iso = R₁ + T₁² R₂/(1 − R₁ R₂), and the diffuse reflectance is
//!
//! d = (t_α/t₁₂) (R_iso − r₁₂),  t_α = t_av(40°), t₁₂ = t_av(90°), r₁₂ = 1 − t₁₂,
//!
//! which for f = ½ is exactly PROSPECT's R − (1 − t_α), the first-surface reflection taken off.

use leafbrdf_core::Real;

use crate::error::Error;
use crate::expint::{transmission, transmission_log_slope};
use crate::kernel::{BLOCK, Block, load, piles};
use crate::lanes::{Lanes, Task, widest};
use crate::model::{Prospect, store_with};
use crate::params::{LeafParams, Parameter};
use crate::plate::{Interface, Plate};
use crate::stack::{Pile, SlopeSeries, pile};

/// PROSPECT's plates with the pigments unevenly shared between the leaf's upper and lower half.
///
/// ```
/// use leafbrdf_prospect::{LeafParams, Prospect, TwoLayer, Version, table};
/// let leaf = LeafParams { cab: 40.0, car: 8.0, cw: 0.012, cm: 0.006, ..LeafParams::with_n_struct(1.5) };
/// let model = Prospect::new(table::full(Version::D));
/// let even = TwoLayer::new(model, 0.5)?;
/// let r = model.band(&leaf, 310)?.reflectance;
/// let first_surface = 1.0 - model.view().t_alpha()[310];
/// assert!((even.band(&leaf, 310)? - (r - first_surface)).abs() < 1e-14);
/// // with more chlorophyll on the lit side the same leaf is darker
/// assert!(TwoLayer::new(model, 0.65)?.band(&leaf, 310)? < even.band(&leaf, 310)?);
/// # Ok::<(), leafbrdf_prospect::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct TwoLayer<'a, T> {
    model: Prospect<'a, T>,
    upper_share: T,
}

/// d in one band with its slopes.
struct Band<T> {
    d: T,
    /// ∂d/∂K₁, ∂d/∂K₂ at constant N; ∂d/∂N at constant K.
    by_upper: T,
    by_lower: T,
    by_n: T,
}

impl<'a, T: Real> TwoLayer<'a, T> {
    /// - `upper_share`: f, the share of C_ab, C_car, C_ant and C_brown that is in the upper stack, [0, 1].
    ///
    /// # Errors
    ///
    /// [`Error::PigmentShare`].
    pub fn new(model: Prospect<'a, T>, upper_share: T) -> Result<Self, Error> {
        if !(upper_share >= T::ZERO && upper_share <= T::ONE) {
            return Err(Error::PigmentShare { value: upper_share.to_f64() });
        }
        Ok(TwoLayer { model, upper_share })
    }

    /// The same on another table, or on a part of this one.
    #[must_use]
    pub fn on<'b>(&self, model: Prospect<'b, T>) -> TwoLayer<'b, T> {
        TwoLayer { model, upper_share: self.upper_share }
    }

    /// f.
    #[must_use]
    pub fn upper_share(&self) -> T {
        self.upper_share
    }

    /// The diffuse reflectance d in one band, a fraction.
    ///
    /// # Errors
    ///
    /// As [`Prospect::band`].
    pub fn band(&self, leaf: &LeafParams<T>, band: usize) -> Result<T, Error> {
        // the rules of the model are its own
        self.model.plate(leaf, band)?;
        let (upper, lower) = self.absorption(leaf, band);
        let faces = self.model.view().interface(band).unwrap_or(Interface::new(T::ONE));
        let series = SlopeSeries::new(T::HALF * leaf.n_struct);
        Ok(two_stacks(faces, upper, lower, T::HALF * leaf.n_struct, &series).d)
    }

    /// K of one layer of the upper and of the lower stack.
    fn absorption(&self, leaf: &LeafParams<T>, band: usize) -> (T, T) {
        let (mut upper, mut lower) = (T::ZERO, T::ZERO);
        let constituents = self.model.view().version().constituents();
        for (column, &constituent) in self.model.view().coefficients().zip(constituents) {
            let k = self.model.content(leaf, constituent) * column.get(band).copied().unwrap_or(T::ZERO);
            let (over, under) = self.shares(constituent);
            upper += over * k;
            lower += under * k;
        }
        (upper / leaf.n_struct, lower / leaf.n_struct)
    }

    /// How much more or less of a constituent a layer holds than if it were evenly spread.
    fn shares(&self, constituent: Parameter) -> (T, T) {
        if is_pigment(constituent) {
            (T::TWO * self.upper_share, T::TWO * (T::ONE - self.upper_share))
        } else {
            (T::ONE, T::ONE)
        }
    }
}

impl<T: Lanes> TwoLayer<'_, T> {
    /// d in every band of the table, and its exact derivatives by the listed parameters and by f.
    ///
    /// - `diffuse`: one number a band.
    /// - `derivatives`: parameters × bands, element `p · bands + band`; 0 for what the version lacks.
    /// - `by_upper_share`: ∂d/∂f, one number a band, or nothing.
    ///
    /// # Errors
    ///
    /// As [`Prospect::spectrum`].
    pub fn jacobian(
        &self,
        leaf: &LeafParams<T>,
        parameters: &[Parameter],
        diffuse: &mut [T],
        derivatives: &mut [T],
        by_upper_share: Option<&mut [T]>,
    ) -> Result<(), Error> {
        let view = self.model.view();
        let bands = view.len();
        self.model.plate(leaf, 0)?;
        let length = |slice, found: usize, rows: usize| {
            let expected = rows.saturating_mul(bands);
            if found == expected { Ok(()) } else { Err(Error::Length { slice, expected, found }) }
        };
        length("diffuse", diffuse.len(), 1)?;
        length("derivatives", derivatives.len(), parameters.len())?;
        if let Some(slice) = &by_upper_share {
            length("by_upper_share", slice.len(), 1)?;
        }
        let per_plate = T::ONE / leaf.n_struct;
        let rooms = Rooms { diffuse, derivatives, by_upper_share };
        widest(Spectrum { interior: self, leaf, per_plate, parameters, rooms });
        Ok(())
    }

    /// How a parameter changes K₁ and K₂ per unit of absorption: (column, dK₁, dK₂) for one constituent and one tied to it.
    fn rates(&self, parameter: Parameter, per_plate: T) -> [Option<(usize, T, T)>; 2] {
        let constituents = self.model.view().version().constituents();
        let mut found = constituents.iter().enumerate().filter_map(|(column, &constituent)| {
            let rate = self.model.content_rate(constituent, parameter) * per_plate;
            let (over, under) = self.shares(constituent);
            (rate > T::ZERO).then_some((column, rate * over, rate * under))
        });
        [found.next(), found.next()]
    }
}

/// Where the results go.
struct Rooms<'s, T> {
    diffuse: &'s mut [T],
    derivatives: &'s mut [T],
    by_upper_share: Option<&'s mut [T]>,
}

/// All bands of a view, for one leaf: block by block, as in `kernel.rs`.
struct Spectrum<'m, 'v, 's, T> {
    interior: &'m TwoLayer<'v, T>,
    leaf: &'m LeafParams<T>,
    per_plate: T,
    parameters: &'m [Parameter],
    rooms: Rooms<'s, T>,
}

impl<T: Lanes> Task for Spectrum<'_, '_, '_, T> {
    #[inline(always)]
    fn run(mut self) {
        let view = self.interior.model.view();
        let m = (T::HALF * self.leaf.n_struct).into_lane();
        let series = SlopeSeries::new(m);
        let mut first = 0;
        while first < view.len() {
            let [upper, lower] = self.absorption(first);
            let t_alpha = load(view.t_alpha(), first);
            let t_90 = load(view.t_90(), first);
            // isotropic light on both faces of every plate
            let inner = [t_90, t_90, load(view.t_21(), first)];
            let (over, under) = (piles(&upper, &inner, m, &series), piles(&lower, &inner, m, &series));
            let zero = Block::of(T::Lane::ZERO);
            let mut leaves = Band { d: zero, by_upper: zero, by_lower: zero, by_n: zero };
            for i in 0..BLOCK {
                let band = joined(t_alpha[i], t_90[i], &over.at(i), &under.at(i));
                (leaves.d[i], leaves.by_n[i]) = (band.d, band.by_n);
                (leaves.by_upper[i], leaves.by_lower[i]) = (band.by_upper, band.by_lower);
            }
            self.take(first, &upper, &lower, &leaves);
            first += BLOCK;
        }
    }
}

impl<T: Lanes> Spectrum<'_, '_, '_, T> {
    /// K of one layer of the upper and of the lower stack.
    #[inline(always)]
    fn absorption(&self, first: usize) -> [Block<T::Lane>; 2] {
        let view = self.interior.model.view();
        let mut stacks = [Block::of(T::Lane::ZERO); 2];
        for (column, &constituent) in view.coefficients().zip(view.version().constituents()) {
            let content = self.interior.model.content(self.leaf, constituent) * self.per_plate;
            if content > T::ZERO {
                let column = load(column, first);
                let (over, under) = self.interior.shares(constituent);
                for (k, share) in stacks.iter_mut().zip([over, under]) {
                    let content = (share * content).into_lane();
                    for i in 0..BLOCK {
                        k[i] += content * column[i];
                    }
                }
            }
        }
        stacks
    }

    /// Writes d and its derivatives of one block.
    #[inline(always)]
    fn take(&mut self, first: usize, upper: &Block<T::Lane>, lower: &Block<T::Lane>, leaves: &Band<Block<T::Lane>>) {
        let view = self.interior.model.view();
        let per_plate = self.per_plate.into_lane();
        let Band { d, by_upper, by_lower, by_n } = leaves;
        store_with(self.rooms.diffuse, first, |i| d[i]);
        // never 0 here; without saying so, `chunks_exact_mut` brings a panic
        let rows = self.rooms.derivatives.chunks_exact_mut(view.len().max(1));
        for (&parameter, row) in self.parameters.iter().zip(rows) {
            if parameter == Parameter::NStruct {
                // K = S/N with S fixed
                store_with(row, first, |i| by_n[i] - (by_upper[i] * upper[i] + by_lower[i] * lower[i]) * per_plate);
                continue;
            }
            let mut slope = Block::of(T::Lane::ZERO);
            for (column, over, under) in self.interior.rates(parameter, self.per_plate).into_iter().flatten() {
                let column = load(view.coefficient(column), first);
                let (over, under) = (over.into_lane(), under.into_lane());
                for i in 0..BLOCK {
                    slope[i] += column[i] * (by_upper[i] * over + by_lower[i] * under);
                }
            }
            store_with(row, first, |i| slope[i]);
        }
        if let Some(row) = &mut self.rooms.by_upper_share {
            // dK₁/df = 2 K_p/N = −dK₂/df
            let mut pigments = Block::of(T::Lane::ZERO);
            for (column, &constituent) in view.coefficients().zip(view.version().constituents()) {
                if is_pigment(constituent) {
                    let content = T::TWO * self.interior.model.content(self.leaf, constituent) * self.per_plate;
                    let (column, content) = (load(column, first), content.into_lane());
                    for i in 0..BLOCK {
                        pigments[i] += content * column[i];
                    }
                }
            }
            store_with(row, first, |i| pigments[i] * (by_upper[i] - by_lower[i]));
        }
    }
}

/// What the two stacks hold unevenly.
fn is_pigment(constituent: Parameter) -> bool {
    matches!(constituent, Parameter::Cab | Parameter::Car | Parameter::Cant | Parameter::Cbrown)
}

/// Two stacks of `m` plates each, one on the other.
#[inline(always)]
fn two_stacks<T: Real>(faces: Interface<T>, k_upper: T, k_lower: T, m: T, series: &SlopeSeries<T>) -> Band<T> {
    // isotropic light on both faces of every plate
    let inner = Interface { t_alpha: faces.t_90, ..faces };
    let stack = |k: T| {
        let layer = transmission(k);
        let plate = Plate::new(inner, layer);
        pile(&plate, plate.slope(transmission_log_slope(k, layer.tau)), m, series)
    };
    joined(faces.t_alpha, faces.t_90, &stack(k_upper), &stack(k_lower))
}

/// One stack on the other, seen as PROSPECT sees a leaf.
#[inline(always)]
fn joined<T: Real>(t_alpha: T, t_90: T, upper: &Pile<T>, lower: &Pile<T>) -> Band<T> {
    //               T₁² R₂
    // R_iso = R₁ + ─────────
    //              1 − R₁ R₂
    let inverse = T::ONE / (T::ONE - upper.r * lower.r);
    let through2 = upper.t.squared();
    let r_iso = upper.r + through2 * lower.r * inverse;
    let r_outer = T::ONE - t_90;
    let scale = t_alpha / t_90;

    // ∂R_iso/∂R₁, ∂R_iso/∂T₁, ∂R_iso/∂R₂
    let by_r1 = T::ONE + through2 * (lower.r * inverse).squared();
    let by_t1 = T::TWO * upper.t * lower.r * inverse;
    let by_r2 = through2 * inverse.squared();
    let (s1, s2) = (upper.slopes, lower.slopes);
    Band {
        d: scale * (r_iso - r_outer),
        by_upper: scale * (by_r1 * s1.dr_dk + by_t1 * s1.dt_dk),
        by_lower: scale * by_r2 * s2.dr_dk,
        // both stacks have N/2 plates
        by_n: scale * T::HALF * (by_r1 * s1.dr_dn + by_t1 * s1.dt_dn + by_r2 * s2.dr_dn),
    }
}
