//! The two azimuth conventions.

use super::input::Source;
use super::{Direction, ReadError, check};

/// Which φ_v is the forward, specular side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, clap::ValueEnum)]
pub enum Azimuth {
    /// φ_v = 180° is the forward side and 0° looks back at the source: the paper's convention, ours, and the default.
    #[value(name = "forward_180")]
    Forward180,
    /// φ_v = 0° is the forward side.
    #[value(name = "forward_0")]
    Forward0,
}

impl Azimuth {
    /// As it stands in files.
    pub fn name(self) -> &'static str {
        match self {
            Azimuth::Forward180 => "forward_180",
            Azimuth::Forward0 => "forward_0",
        }
    }

    pub(crate) fn other(self) -> Self {
        match self {
            Azimuth::Forward180 => Azimuth::Forward0,
            Azimuth::Forward0 => Azimuth::Forward180,
        }
    }

    pub(crate) fn from_name(name: &str) -> Option<Self> {
        [Azimuth::Forward180, Azimuth::Forward0].into_iter().find(|azimuth| name.eq_ignore_ascii_case(azimuth.name()))
    }
}

/// Changes the azimuths of a file from `forward_0` to `forward_180`.
///
/// Two azimuths that differ by less than the rounding of 180° (3e-14°) become one; that is an error, as for any other
/// direction that stands twice.
pub(super) fn turn(source: Source<'_>, directions: &mut [Direction]) -> Result<(), ReadError> {
    turned(directions);
    match check::twice(directions) {
        None => Ok(()),
        Some((index, before)) => Err(ReadError::whole(
            source.name,
            format!(
                "directions {} and {} are the same but for rounding: expected each direction once",
                before + 1,
                index + 1
            ),
        )),
    }
}

/// Changes the azimuths of all directions from either convention to the other one.
///
/// The range stays the file's own: (−180, 180] where there is a negative azimuth, [0, 360) where there is none.
pub(super) fn turned(directions: &mut [Direction]) {
    let signed = directions.iter().any(|direction| direction.phi_v_deg < 0.0);
    for direction in directions {
        let phi = direction.phi_v_deg;
        let down = if signed { phi > 0.0 } else { phi >= 180.0 };
        direction.phi_v_deg = decimal_sum(phi, if down { -180.0 } else { 180.0 });
    }
}

/// φ ± 180 as one would write it: 0.1 + 180 is 180.1, and 180.1 − 180 is 0.1 again, not 0.09999999999999432.
///
/// Azimuths of up to 12 decimals get the double nearest to the decimal sum. The rounding of the binary sum, at most
/// 5.7e-14, is well below half a unit of the twelfth decimal. Longer ones get the binary sum.
fn decimal_sum(phi: f64, turn: f64) -> f64 {
    let sum = phi + turn;
    let to_12_decimals = |x: f64| format!("{x:.12}").parse::<f64>();
    match (to_12_decimals(phi), to_12_decimals(sum)) {
        (Ok(same), Ok(decimal)) if same == phi => decimal,
        _ => sum,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn azimuths_of_turned(phis: &[f64]) -> Vec<f64> {
        let mut directions: Vec<Direction> =
            phis.iter().map(|&phi_v_deg| Direction { theta_s_deg: 30.0, theta_v_deg: 40.0, phi_v_deg }).collect();
        turned(&mut directions);
        directions.iter().map(|direction| direction.phi_v_deg).collect()
    }

    #[test]
    fn turning_by_half_a_circle_keeps_the_range() {
        assert_eq!(azimuths_of_turned(&[0.0, 90.0, 180.0, 270.0, 359.0]), [180.0, 270.0, 0.0, 90.0, 179.0]);
        assert_eq!(azimuths_of_turned(&[-90.0, 0.0, 30.0, 180.0]), [90.0, 180.0, -150.0, 0.0]);
    }

    #[test]
    fn turning_twice_changes_nothing() {
        let phis: Vec<f64> = (0..3600).map(|tenth| f64::from(tenth) / 10.0).collect();
        assert_eq!(azimuths_of_turned(&azimuths_of_turned(&phis)), phis);
        let signed: Vec<f64> = (-1799..=1800).map(|tenth| f64::from(tenth) / 10.0).collect();
        assert_eq!(azimuths_of_turned(&azimuths_of_turned(&signed)), signed);
    }
}
