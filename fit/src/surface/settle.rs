//! What of a tilt the directions allow, and see.

use leafbrdf_core::{Angle, Tilt};

use super::model::{DirectionalModel, LeafModel, N, PARAMETERS, SIGMA, TILT_IN_PLANE, TILT_LATERAL};
use super::options::SurfaceOptions;
use super::search::Treatment;
use crate::FitError;
use crate::bounds::Interval;

/// Tilts within what keeps every direction above the horizon; what the directions cannot see, held at 0.
pub(crate) fn settle(
    model: &LeafModel<'_, f64>,
    options: &SurfaceOptions,
) -> Result<([Treatment<f64>; PARAMETERS], [bool; PARAMETERS]), FitError> {
    let mut parameters = options.parameters;
    let mut unseen = [false; PARAMETERS];
    let tilts = [TILT_IN_PLANE, TILT_LATERAL];
    if !tilts.iter().any(|&place| parameters[place].is_free()) {
        return Ok((parameters, unseen));
    }
    let level = Tilt::new(Angle::from_radians(0.0), Angle::from_radians(0.0))?;
    let mut lowest = 1.0_f64;
    for direction in model.directions {
        let seen = direction.about(&level)?;
        lowest = lowest.min(seen.geometry().cos_theta_s()).min(seen.geometry().cos_theta_v());
    }
    // both tilts at once turn the normal by √2 times as much; one degree is left above the horizon
    let room = (lowest.asin() - 1.0_f64.to_radians()) * core::f64::consts::FRAC_1_SQRT_2;
    if !(room > 1.0_f64.to_radians()) {
        return Err(FitError::Bounds { parameter: "tilt", expected: "no direction within 3° of the horizon" });
    }
    for place in tilts {
        if let Treatment::Free { bounds, .. } = &mut parameters[place] {
            *bounds = Interval::new(bounds.lower.max(-room), bounds.upper.min(room));
            if !(bounds.lower < bounds.upper) {
                return Err(FitError::Bounds {
                    parameter: "tilt",
                    expected: "bounds that keep the views above the horizon",
                });
            }
        }
    }
    if parameters[TILT_LATERAL].is_free() {
        let mut x = parameters.map(|one| match one {
            Treatment::Held(value) => value,
            Treatment::Free { bounds, prior } => prior.map_or(0.5 * (bounds.lower + bounds.upper), |prior| prior.mean),
        });
        x[N] = x[N].clamp(1.3, 2.0);
        x[SIGMA] = x[SIGMA].clamp(0.1, 0.5);
        let (mut in_plane, mut lateral) = (0.0_f64, 0.0_f64);
        model.derivatives(&x, |value| {
            let size = |place: usize| value.d_specular[place].abs() + value.d_diffuse[place].abs();
            in_plane = in_plane.max(size(TILT_IN_PLANE));
            lateral = lateral.max(size(TILT_LATERAL));
        })?;
        if !(lateral > 1e-9 * in_plane) {
            parameters[TILT_LATERAL] = Treatment::Held(0.0);
            unseen[TILT_LATERAL] = true;
        }
    }
    Ok((parameters, unseen))
}
