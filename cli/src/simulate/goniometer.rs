//! The directions of a campaign.

use crate::measurement::Direction;

/// θ_s of the paper's illumination arc (§2.2), degrees.
pub const SOURCES_DEG: [f64; 4] = [8.0, 21.0, 41.0, 60.0];

/// Detectors: angle from the zenith of the arc across the plane of incidence, degrees; > 0 on the side of φ_v = 90°.
const DETECTORS_DEG: [f64; 7] = [0.0, 12.0, -24.0, 36.0, -48.0, 60.0, -72.0];

/// Positions of sample holder and illumination arc in the plane of incidence: −66.5° to 83° in steps of 11.5°; > 0 forward.
const POSITIONS: std::ops::RangeInclusive<i32> = -6..=7;
const POSITION_STEP_DEG: f64 = 11.5;
const POSITION_ZERO_DEG: f64 = 2.5;

/// A goniometer with the numbers of the paper's (§2.2, §2.3): θ_s = 8, 21, 41, 60°, seven detectors on a fixed arc × 14
/// positions = 98 viewing directions for each, 65 of them with θ_v ≤ 70°, 392 in all.
///
/// The paper does not print the directions; these are ours. Sample holder and illumination arc turn together about the axis
/// that lies in the leaf across the plane of incidence; the arc of detectors stands over this axis. A detector at the angle γ
/// along the arc and a position ψ then look from
///
/// ```text
/// v = (−cos γ sin ψ, sin γ, cos γ cos ψ),   x towards the source, z along the leaf normal
/// ```
///
/// The detector at γ = 0 scans the plane of incidence, through the mirror direction of θ_s = 60° (ψ = 60°) to 83° forward;
/// the others stand on its two sides in turn, so that with the mirror symmetry of a leaf (φ_v and −φ_v) every 12° across are
/// seen. A tilted leaf, which has no such symmetry, still shows both of its sides. No direction is nearer than 0.44° to the
/// limit of 70°. Angles are rounded to 0.01°: what is written is what is simulated.
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
        let (x, y, z) = (-cos_gamma * sin_psi, sin_gamma, cos_gamma * cos_psi);
        let phi = rounded(y.atan2(x).to_degrees());
        Direction {
            theta_s_deg,
            theta_v_deg: rounded(x.hypot(y).atan2(z).to_degrees()),
            phi_v_deg: if phi < 0.0 { rounded(phi + 360.0) } else { phi },
        }
    };
    let positions = || POSITIONS.map(|position| f64::from(position) * POSITION_STEP_DEG + POSITION_ZERO_DEG);
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
    fn fourteen_directions_lie_in_the_plane_of_incidence_eight_of_them_forward() {
        let side = |phi: f64| paper_directions().iter().filter(|d| d.theta_s_deg == 8.0 && d.phi_v_deg == phi).count();
        assert_eq!((side(180.0), side(0.0)), (8, 6));
        assert!(paper_directions().iter().any(|d| (d.theta_s_deg, d.theta_v_deg, d.phi_v_deg) == (60.0, 60.0, 180.0)));
    }

    // each |γ| but 0 stands on one side only: half of all directions but those of the plane have φ_v < 180
    #[test]
    fn both_sides_of_the_plane_are_seen_and_no_direction_is_the_mirror_image_of_another() {
        let of_source: Vec<_> = paper_directions().into_iter().filter(|d| d.theta_s_deg == 8.0).collect();
        let left = of_source.iter().filter(|d| d.phi_v_deg > 0.0 && d.phi_v_deg < 180.0).count();
        assert_eq!(left, 3 * 14);
        for d in of_source.iter().filter(|d| d.phi_v_deg % 180.0 != 0.0) {
            let image = Direction { phi_v_deg: 360.0 - d.phi_v_deg, ..*d };
            assert!(of_source.iter().all(|other| other.key() != image.key()), "{d:?}");
        }
    }
}
