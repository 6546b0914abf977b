//! The model: a table, the rules for its parameters, and spectra out of it.

use leafbrdf_core::Real;

use crate::absorption::{Action, Rules};
use crate::error::Error;
use crate::expint::{transmission, transmission_log_slope};
use crate::kernel::{BLOCK, Block, Results, Sink, Spectrum, load};
use crate::lanes::{Lanes, widest};
use crate::params::{LeafParams, Parameter};
use crate::plate::{Interface, Plate};
use crate::stack::{self, Decay, Optics, Pair, Reciprocals, SlopeSeries, Slopes};
use crate::table::View;

/// PROSPECT on one table.
///
/// ```
/// use leafbrdf_prospect::{LeafParams, Prospect, Version, table};
/// let model = Prospect::new(table::full(Version::D));
/// let leaf = LeafParams { cab: 40.0, car: 8.0, cw: 0.01, cm: 0.009, ..LeafParams::with_n_struct(1.5) };
/// let (mut r, mut t) = ([0.0; table::BANDS], [0.0; table::BANDS]);
/// model.spectrum(&leaf, &mut r, &mut t)?;
/// // green leaves reflect 5 % of red and nearly half of near-infrared light
/// assert!(r[670 - 400] < 0.06 && r[800 - 400] > 0.4);
/// # Ok::<(), leafbrdf_prospect::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Prospect<'a, T> {
    view: View<'a, T>,
    rules: Rules<T>,
}

impl<'a, T: Real> Prospect<'a, T> {
    /// The model on a table, every parameter free.
    #[must_use]
    pub fn new(view: View<'a, T>) -> Self {
        Prospect { view, rules: Rules { car_per_cab: None, allow_cm_with_prot_cbc: false } }
    }

    /// Ties carotenoids to chlorophyll, C_car = `ratio` · C_ab: the parameter set N, C_ab, C_m of Bousquet et al. (2005), whose
    /// PROSPECT did not tell the pigments apart. The derivative by C_ab then includes the carotenoids' part.
    ///
    /// - `ratio`: unitless (µg per µg), ≥ 0; 0.25 is usual in green leaves.
    ///
    /// # Errors
    ///
    /// [`Error::CarPerCab`] for a ratio that is negative or not finite.
    pub fn with_car_per_cab(mut self, ratio: T) -> Result<Self, Error> {
        if !(ratio >= T::ZERO && ratio.is_finite()) {
            return Err(Error::CarPerCab { value: ratio.to_f64() });
        }
        self.rules.car_per_cab = Some(ratio);
        Ok(self)
    }

    /// Lets PROSPECT-PRO take C_m together with C_prot or C_cbc, which otherwise is refused because the same matter would absorb
    /// twice.
    #[must_use]
    pub fn allow_cm_with_prot_cbc(mut self) -> Self {
        self.rules.allow_cm_with_prot_cbc = true;
        self
    }

    /// The table.
    #[must_use]
    pub fn view(&self) -> View<'a, T> {
        self.view
    }

    /// The same model on another table, or on a part of this one.
    #[must_use]
    pub fn on<'b>(&self, view: View<'b, T>) -> Prospect<'b, T> {
        Prospect { view, rules: self.rules }
    }

    /// Reflectance, transmittance and absorptance in one band, with the arithmetic of `T` itself.
    ///
    /// # Errors
    ///
    /// As [`Prospect::spectrum`]; [`Error::Length`] for a band beyond the table.
    pub fn band(&self, leaf: &LeafParams<T>, band: usize) -> Result<Optics<T>, Error> {
        let (faces, k, n_struct) = self.plate(leaf, band)?;
        Ok(plates(faces, k, n_struct))
    }

    /// What the leaf is made of in one band: the faces of a plate, the absorption coefficient K of one layer, and N.
    pub(crate) fn plate(&self, leaf: &LeafParams<T>, band: usize) -> Result<(Interface<T>, T, T), Error> {
        let layer = self.rules.layer(self.view.version(), leaf)?;
        let faces = self.view.interface(band).ok_or(Error::Length {
            slice: "bands",
            expected: band.saturating_add(1),
            found: self.view.len(),
        })?;
        let mut k = T::ZERO;
        for (column, &content) in self.view.coefficients().zip(&layer.contents) {
            k += content * column.get(band).copied().unwrap_or(T::ZERO);
        }
        Ok((faces, k, leaf.n_struct))
    }

    /// How much of a constituent the leaf holds, ties included.
    pub(crate) fn content(&self, leaf: &LeafParams<T>, constituent: Parameter) -> T {
        match (constituent, self.rules.car_per_cab) {
            (Parameter::Car, Some(ratio)) => ratio * leaf.cab,
            _ => leaf.get(constituent),
        }
    }

    /// d(content of a constituent)/d(parameter): 1, 0, or the ratio of a tie.
    pub(crate) fn content_rate(&self, constituent: Parameter, parameter: Parameter) -> T {
        match (constituent, parameter, self.rules.car_per_cab) {
            (Parameter::Car, Parameter::Car, Some(_)) => T::ZERO,
            (Parameter::Car, Parameter::Cab, Some(ratio)) => ratio,
            _ if constituent == parameter => T::ONE,
            _ => T::ZERO,
        }
    }

    /// Slopes by every parameter of [`Parameter::ALL`] of what has slopes `by_k` and `by_n` with respect to K and N in one band.
    pub(crate) fn chain(&self, band: usize, k: T, n_struct: T, by_k: T, by_n: T) -> [T; Parameter::ALL.len()] {
        let coefficient = |column| self.view.coefficient(column).get(band).copied().unwrap_or(T::ZERO);
        Parameter::ALL.map(|parameter| match self.rules.action(self.view.version(), parameter) {
            // K = S/N with S fixed: dK/dN = −K/N
            Action::Structure => by_n - by_k * k / n_struct,
            Action::Content { own, tied } => {
                let tied = tied.map_or(T::ZERO, |(column, ratio)| ratio * coefficient(column));
                by_k * (coefficient(own) + tied) / n_struct
            }
            Action::Nothing => T::ZERO,
        })
    }
}

/// A leaf of `n_struct` ≥ 1 plates whose layers have absorption coefficient `k` ≥ 0, at one wavelength: the model without
/// tables and without checks.
///
/// ```
/// use leafbrdf_prospect::{Interface, plates};
/// // one plate of glass without absorption: 1 − t_av(40°) at the first face, and what the second sends back
/// let glass = plates(Interface::new(1.5_f64), 0.0, 1.0);
/// assert!((glass.reflectance + glass.transmittance - 1.0).abs() < 1e-15);
/// ```
#[must_use]
pub fn plates<T: Real>(faces: Interface<T>, k: T, n_struct: T) -> Optics<T> {
    stack::leaf(&Plate::new(faces, transmission(k)), n_struct - T::ONE)
}

/// [`plates`] with the exact slopes by K and N.
#[must_use]
pub fn plates_with_slopes<T: Real>(faces: Interface<T>, k: T, n_struct: T) -> (Optics<T>, Slopes<T>) {
    let m = n_struct - T::ONE;
    let layer = transmission(k);
    let plate = Plate::new(faces, layer);
    let slope = plate.slope(transmission_log_slope(k, layer.tau));
    let pair = Pair::new(&plate);
    let decay = Decay::new(Decay::rate(pair.growth), m);
    let reciprocals = Reciprocals::new(&pair, &decay);
    let value = stack::optics(&plate, &pair, &decay, &reciprocals);
    (value, stack::slopes(&plate, slope, &pair, &decay, &reciprocals, m, &SlopeSeries::new(m)))
}

/// Room for a spectrum and its derivatives, lent by the caller.
///
/// A derivative array holds one run of bands for each wanted parameter, in the order of the list:
/// element `p · bands + band`.
#[derive(Debug)]
pub struct Jacobian<'s, T> {
    /// R, one value a band.
    pub reflectance: &'s mut [T],
    /// T, one value a band.
    pub transmittance: &'s mut [T],
    /// ∂R/∂parameter, per unit of the parameter; parameters × bands.
    pub d_reflectance: &'s mut [T],
    /// ∂T/∂parameter.
    pub d_transmittance: &'s mut [T],
}

impl<T: Lanes> Prospect<'_, T> {
    /// Reflectance and transmittance of a leaf in every band of the table, fractions.
    ///
    /// With `std` the widest SIMD instructions of the machine are used; the results are the same to the last bit.
    /// Accuracy: 1e-13 absolute in `f64`, 1e-6 in `f32`, at every limit (no absorption, one plate, opaque).
    ///
    /// # Errors
    ///
    /// Those of [`LeafParams::check`]; [`Error::DryMatterTwice`]; [`Error::CarGivenAndTied`]; [`Error::Length`] for slices that
    /// do not have one element a band.
    pub fn spectrum(&self, leaf: &LeafParams<T>, reflectance: &mut [T], transmittance: &mut [T]) -> Result<(), Error> {
        let layer = self.rules.layer(self.view.version(), leaf)?;
        self.fits("reflectance", reflectance.len(), 1)?;
        self.fits("transmittance", transmittance.len(), 1)?;
        widest(Spectrum { view: self.view, layer, sink: Values { reflectance, transmittance } });
        Ok(())
    }

    /// [`Prospect::spectrum`] without choosing instructions at run time: what a device runs, and the same bits.
    ///
    /// # Errors
    ///
    /// As [`Prospect::spectrum`].
    pub fn spectrum_portable(
        &self,
        leaf: &LeafParams<T>,
        reflectance: &mut [T],
        transmittance: &mut [T],
    ) -> Result<(), Error> {
        use crate::lanes::Task as _;
        let layer = self.rules.layer(self.view.version(), leaf)?;
        self.fits("reflectance", reflectance.len(), 1)?;
        self.fits("transmittance", transmittance.len(), 1)?;
        Spectrum { view: self.view, layer, sink: Values { reflectance, transmittance } }.run();
        Ok(())
    }

    /// Absorptance 1 − R − T in every band, without cancellation where little is absorbed.
    ///
    /// # Errors
    ///
    /// As [`Prospect::spectrum`].
    pub fn absorptance(&self, leaf: &LeafParams<T>, absorptance: &mut [T]) -> Result<(), Error> {
        let layer = self.rules.layer(self.view.version(), leaf)?;
        self.fits("absorptance", absorptance.len(), 1)?;
        widest(Spectrum { view: self.view, layer, sink: Absorptance { absorptance } });
        Ok(())
    }

    /// Reflectance, transmittance and their exact derivatives by the listed parameters, one pass.
    ///
    /// The values are those of [`Prospect::spectrum`] to the bit. Accuracy of the derivatives in `f64`: 1e-10 relative
    /// (`tests/golden/derivatives_reference.csv`). A parameter that the version lacks, or C_car where it is tied, has derivative 0.
    ///
    /// # Errors
    ///
    /// As [`Prospect::spectrum`].
    ///
    /// ```
    /// use leafbrdf_prospect::{Jacobian, LeafParams, Parameter, Prospect, Version, table};
    /// let red = table::full(Version::D).bands(270..271).unwrap();
    /// let leaf = LeafParams { cab: 40.0, ..LeafParams::with_n_struct(1.5) };
    /// let (mut r, mut t, mut dr, mut dt) = ([0.0; 1], [0.0; 1], [0.0; 2], [0.0; 2]);
    /// let room =
    ///     Jacobian { reflectance: &mut r, transmittance: &mut t, d_reflectance: &mut dr, d_transmittance: &mut dt };
    /// Prospect::new(red).jacobian(&leaf, &[Parameter::NStruct, Parameter::Cab], room)?;
    /// // more chlorophyll darkens the red, in reflection and in transmission
    /// assert!(dr[1] < 0.0 && dt[1] < 0.0);
    /// # Ok::<(), leafbrdf_prospect::Error>(())
    /// ```
    pub fn jacobian(&self, leaf: &LeafParams<T>, parameters: &[Parameter], room: Jacobian<'_, T>) -> Result<(), Error> {
        let layer = self.rules.layer(self.view.version(), leaf)?;
        self.fits("reflectance", room.reflectance.len(), 1)?;
        self.fits("transmittance", room.transmittance.len(), 1)?;
        self.fits("d_reflectance", room.d_reflectance.len(), parameters.len())?;
        self.fits("d_transmittance", room.d_transmittance.len(), parameters.len())?;
        let actions = Parameter::ALL.map(|parameter| self.rules.action(self.view.version(), parameter));
        let sink = Rows { view: self.view, per_plate: layer.per_plate, parameters, actions, room };
        widest(Spectrum { view: self.view, layer, sink });
        Ok(())
    }

    fn fits(&self, slice: &'static str, found: usize, rows: usize) -> Result<(), Error> {
        let expected = rows.saturating_mul(self.view.len());
        if found == expected { Ok(()) } else { Err(Error::Length { slice, expected, found }) }
    }
}

/// Writes R and T.
struct Values<'s, T> {
    reflectance: &'s mut [T],
    transmittance: &'s mut [T],
}

impl<T: Lanes> Sink<T> for Values<'_, T> {
    const SLOPES: bool = false;
    #[inline(always)]
    fn take(&mut self, first: usize, results: &Results<T::Lane>) {
        store(self.reflectance, first, &results.reflectance);
        store(self.transmittance, first, &results.transmittance);
    }
}

/// Writes 1 − R − T.
struct Absorptance<'s, T> {
    absorptance: &'s mut [T],
}

impl<T: Lanes> Sink<T> for Absorptance<'_, T> {
    const SLOPES: bool = false;
    #[inline(always)]
    fn take(&mut self, first: usize, results: &Results<T::Lane>) {
        store(self.absorptance, first, &results.absorptance);
    }
}

/// Writes R, T and one run of derivatives for each parameter.
struct Rows<'a, 's, T> {
    view: View<'a, T>,
    per_plate: T,
    parameters: &'s [Parameter],
    /// What each of `Parameter::ALL` does.
    actions: [Action<T>; Parameter::ALL.len()],
    room: Jacobian<'s, T>,
}

impl<T: Lanes> Sink<T> for Rows<'_, '_, T> {
    const SLOPES: bool = true;
    #[inline(always)]
    fn take(&mut self, first: usize, results: &Results<T::Lane>) {
        store(self.room.reflectance, first, &results.reflectance);
        store(self.room.transmittance, first, &results.transmittance);
        // dK/dC = k/N for a constituent
        let per_plate = self.per_plate.into_lane();
        let (mut dr, mut dt) = (results.dr_dk, results.dt_dk);
        for (dr, dt) in dr.iter_mut().zip(dt.iter_mut()) {
            *dr *= per_plate;
            *dt *= per_plate;
        }
        // never 0 here; without saying so, `chunks_exact_mut` brings a panic
        let bands = self.view.len().max(1);
        let d_reflectance = self.room.d_reflectance.chunks_exact_mut(bands);
        let d_transmittance = self.room.d_transmittance.chunks_exact_mut(bands);
        for ((&parameter, to_r), to_t) in self.parameters.iter().zip(d_reflectance).zip(d_transmittance) {
            match self.actions.get(parameter as usize) {
                Some(Action::Structure) => {
                    // K = S/N with S fixed: dK/dN = −K/N
                    store_with(to_r, first, |i| results.dr_dn[i] - results.k[i] * dr[i]);
                    store_with(to_t, first, |i| results.dt_dn[i] - results.k[i] * dt[i]);
                }
                Some(&Action::Content { own, tied }) => {
                    let mut k = load(self.view.coefficient(own), first);
                    if let Some((column, ratio)) = tied {
                        let column = load(self.view.coefficient(column), first);
                        let ratio = ratio.into_lane();
                        for (sum, k) in k.iter_mut().zip(column.iter()) {
                            *sum += ratio * *k;
                        }
                    }
                    store_with(to_r, first, |i| dr[i] * k[i]);
                    store_with(to_t, first, |i| dt[i] * k[i]);
                }
                Some(Action::Nothing) | None => {
                    store_with(to_r, first, |_| T::Lane::ZERO);
                    store_with(to_t, first, |_| T::Lane::ZERO);
                }
            }
        }
    }
}

/// Copies a block to its place; what lies beyond the end is padding.
#[inline(always)]
fn store<T: Lanes>(to: &mut [T], first: usize, block: &Block<T::Lane>) {
    store_with(to, first, |i| block[i]);
}

/// Writes a block, element by element.
#[inline(always)]
pub(crate) fn store_with<T: Lanes>(to: &mut [T], first: usize, value: impl Fn(usize) -> T::Lane) {
    let rest = to.get_mut(first..).unwrap_or_default();
    if let Some(whole) = rest.first_chunk_mut::<BLOCK>() {
        for (i, to) in whole.iter_mut().enumerate() {
            *to = T::from_lane(value(i));
        }
    } else {
        let mut block = [T::ZERO; BLOCK];
        for (i, to) in block.iter_mut().enumerate() {
            *to = T::from_lane(value(i));
        }
        for (to, value) in rest.iter_mut().zip(block) {
            *to = value;
        }
    }
}
