//! What a goniometer makes of a leaf: directions, tilt of the sample, loss of signal at grazing views, noise.

use leafbrdf_core::{Angle, Geometry, Tilt};

use super::{CoupledLeaf, Noise, SimulationError};
use crate::measurement::{Azimuth, Direction, Layout, Measurement, Metadata, Quantity};

/// Values are rounded to one part in this many, sr⁻¹.
const STEPS_PER_SR: f64 = 1e6;
/// Standard deviations likewise, so that small ones keep their digits.
const STEPS_PER_SR_OF_SD: f64 = 1e9;

/// The way a leaf is measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Instrument {
    /// Where the light comes from and where it is seen.
    pub directions: Vec<Direction>,
    /// Tilt of the sample, degrees: towards the source (positive), and across the plane of incidence towards φ_v = 90°.
    /// The reference panel stays level.
    pub tilt_deg: [f64; 2],
    /// θ_v beyond which signal is lost, degrees; see [`signal`](Self::signal).
    pub loss_beyond_deg: Option<f64>,
    /// Standard deviations are recorded beside the values.
    pub with_sd: bool,
}

impl Instrument {
    /// A level sample, no loss.
    pub fn new(directions: Vec<Direction>) -> Self {
        Instrument { directions, tilt_deg: [0.0; 2], loss_beyond_deg: None, with_sd: false }
    }

    /// The share of the signal that a view at θ_v keeps: min(1, cosθ_v/cosθ_limit).
    ///
    /// §2.3 reports a loss beyond θ_v = 70° by a misplaced viewed area, and no more than that. Our model: the viewed area
    /// grows as 1/cosθ_v, fills the lit area at the limit, and beyond sees the dark leaf around it in the same proportion.
    ///
    /// ```
    /// use leafbrdf::simulate::Instrument;
    /// let arc = Instrument { loss_beyond_deg: Some(70.0), ..Instrument::new(Vec::new()) };
    /// assert_eq!(arc.signal(69.0), 1.0);
    /// assert!((arc.signal(80.0) - 0.508).abs() < 1e-3);
    /// ```
    pub fn signal(&self, theta_v_deg: f64) -> f64 {
        match self.loss_beyond_deg {
            Some(limit) if theta_v_deg > limit => theta_v_deg.to_radians().cos() / limit.to_radians().cos(),
            _ => 1.0,
        }
    }

    /// BRDF in sr⁻¹ as it is recorded (Eq. 18), noise included, rounded to 10⁻⁶ sr⁻¹. A view that the tilt puts below the
    /// leaf's horizon is missing.
    ///
    /// # Errors
    /// Directions at or below the horizon of the instrument, a tilt that leaves no view, standard deviations asked for
    /// where there is no noise.
    pub fn measure(
        &self,
        leaf: &CoupledLeaf,
        name: &str,
        metadata: Metadata,
        noise: &mut Noise,
    ) -> Result<Measurement, SimulationError> {
        if self.with_sd && noise.is_nothing() {
            return Err(SimulationError::NoNoise);
        }
        let deg = Angle::from_degrees;
        let tilt = Tilt::new(deg(self.tilt_deg[0]), deg(self.tilt_deg[1]))?;
        let level = self.tilt_deg == [0.0; 2];
        // diffuse shape and lobe of each view, both in sr⁻¹ and as the instrument counts them
        let views = self
            .directions
            .iter()
            .map(|d| {
                let (theta_s, theta_v, phi_v) = (deg(d.theta_s_deg), deg(d.theta_v_deg), deg(d.phi_v_deg));
                let plain = Geometry::from_angles(theta_s, theta_v, phi_v)?;
                let (geometry, factor) = if level {
                    (plain, 1.0)
                } else {
                    match Geometry::tilted(theta_s, theta_v, phi_v, &tilt) {
                        Ok(tilted) => (*tilted.geometry(), tilted.factor()),
                        Err(_) => return Ok((f64::NAN, f64::NAN)),
                    }
                };
                let kept = factor * self.signal(d.theta_v_deg);
                Ok((kept * leaf.model.diffuse.shape(&geometry), kept * leaf.model.surface.brdf(&geometry)))
            })
            .collect::<Result<Vec<(f64, f64)>, SimulationError>>()?;
        if views.iter().all(|(shape, _)| shape.is_nan()) {
            return Err(SimulationError::NothingSeen);
        }
        let truth: Vec<f64> =
            leaf.k_lambert.iter().flat_map(|k_l| views.iter().map(move |(shape, lobe)| k_l * shape + lobe)).collect();
        let rounded = |value: f64, steps: f64| (value * steps).round() / steps;
        let sd = self.with_sd.then(|| truth.iter().map(|brdf| rounded(noise.sd(*brdf), STEPS_PER_SR_OF_SD)).collect());
        Ok(Measurement {
            name: name.to_string(),
            sample: Some(name.to_string()),
            metadata,
            quantity: Quantity::Brdf,
            layout: if self.with_sd { Layout::Long } else { Layout::Wide },
            azimuth: Azimuth::Forward180,
            wavelengths_nm: leaf.wavelengths_nm.clone(),
            directions: self.directions.clone(),
            values: truth.iter().map(|brdf| rounded(noise.on(*brdf), STEPS_PER_SR)).collect(),
            sd,
        })
    }

    /// Tilt and loss as lines of a file's header, where there are any.
    pub fn describe(&self, metadata: &mut Metadata) {
        let [in_plane, lateral] = self.tilt_deg;
        if self.tilt_deg != [0.0; 2] {
            metadata.push("tilt", format!("in_plane {in_plane} deg (towards the source), lateral {lateral} deg"));
        }
        if let Some(limit) = self.loss_beyond_deg {
            metadata.push("loss", format!("beyond theta_v {limit} deg times cos(theta_v)/cos({limit} deg)"));
        }
    }
}
