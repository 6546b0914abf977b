//! The directions of a campaign.

use crate::measurement::Direction;

/// θ_s of the paper's illumination arc (§2.2), degrees.
pub const SOURCES_DEG: [f64; 4] = [8.0, 21.0, 41.0, 60.0];

/// Detectors: angle from the zenith of the arc, towards the side away from the source, degrees.
const DETECTORS_DEG: [f64; 7] = [-69.0, -48.0, -27.0, -6.0, 15.0, 36.0, 57.0];

/// Positions of sample holder and illumination arc: −72° to 84° in steps of 12°.
const POSITIONS: std::ops::RangeInclusive<i32> = -6..=7;
const POSITION_STEP_DEG: f64 = 12.0;

/// A goniometer with the numbers of the paper's (§2.2, §2.3): θ_s = 8, 21, 41, 60°, seven detectors on a fixed arc × 14
/// positions = 98 viewing directions for each, 65 of them with θ_v ≤ 70°, 392 in all.
///
/// The paper does not print the directions; these are ours. Sample holder and illumination arc turn together about the line
/// where the leaf meets the plane of incidence, under an arc of detectors that contains this line. A detector at the angle
/// γ along the arc (> 0: forward) and a position ψ then look from
///
/// ```text
/// v = (−sin γ, cos γ sin ψ, cos γ cos ψ),   x towards the source, z along the leaf normal
/// ```
///
/// At ψ = 0 the detectors lie in the plane of incidence, at θ_v = 6, 15, 27, 36, 48, 57 and 69°. No direction is nearer than
/// 0.45° to the limit of 70°. Angles are rounded to 0.01°: what is written is what is simulated.
///
/// ```
/// use leafbrdf::simulate::paper_directions;
/// let directions = paper_directions();
/// let used = directions.iter().filter(|d| d.theta_v_deg <= 70.0).count();
/// assert_eq!((directions.len(), used), (4 * 98, 260));
/// ```
pub fn paper_directions() -> Vec<Direction> {
    let rounded = |degrees: f64| (degrees * 100.0).round() / 100.0;
    let view = |theta_s_deg, gamma_deg: f64, psi_deg: f64| {
        let ((sin_gamma, cos_gamma), (sin_psi, cos_psi)) =
            (gamma_deg.to_radians().sin_cos(), psi_deg.to_radians().sin_cos());
        let (x, y, z) = (-sin_gamma, cos_gamma * sin_psi, cos_gamma * cos_psi);
        let phi = rounded(y.atan2(x).to_degrees());
        Direction {
            theta_s_deg,
            theta_v_deg: rounded(x.hypot(y).atan2(z).to_degrees()),
            phi_v_deg: if phi < 0.0 { rounded(phi + 360.0) } else { phi },
        }
    };
    let positions = || POSITIONS.map(|position| f64::from(position) * POSITION_STEP_DEG);
    let of_source = |theta_s| positions().flat_map(move |psi| DETECTORS_DEG.map(|gamma| view(theta_s, gamma, psi)));
    SOURCES_DEG.into_iter().flat_map(of_source).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_source_has_98_distinct_directions_above_the_horizon_65_of_them_within_70_degrees() {
        let all = paper_directions();
        for source in SOURCES_DEG {
            let of_source: Vec<_> = all.iter().filter(|d| d.theta_s_deg == source).collect();
            let mut keys: Vec<_> = of_source.iter().map(|d| d.key()).collect();
            keys.sort_unstable();
            keys.dedup();
            assert_eq!((of_source.len(), keys.len()), (98, 98));
            assert_eq!(of_source.iter().filter(|d| d.theta_v_deg <= 70.0).count(), 65);
            assert!(of_source.iter().all(|d| d.theta_v_deg < 88.0 && (d.theta_v_deg - 70.0).abs() > 0.44));
        }
    }

    #[test]
    fn seven_directions_lie_in_the_plane_of_incidence_three_of_them_forward() {
        let side = |phi: f64| paper_directions().iter().filter(|d| d.theta_s_deg == 8.0 && d.phi_v_deg == phi).count();
        assert_eq!((side(180.0), side(0.0)), (3, 4));
    }
}
