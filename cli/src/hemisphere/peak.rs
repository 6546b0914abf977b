//! The specular peak of a measured BRDF: where it is, how high above the diffuse background, how wide (§3.1, §3.2).

use std::f64::consts::PI;

use super::direction_of;
use super::integrate::{Hemisphere, cell_place, ring_length};

/// The peak of one wavelength and θ_s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// The brightest direction measured: θ_v and φ_v, degrees.
    pub brightest_deg: [f64; 2],
    /// Its value above the background, sr⁻¹.
    pub height: f64,
    /// Mean of the background's directions, sr⁻¹.
    pub background: f64,
    /// Centre of the part above half height, weighted by what exceeds it: θ_v and φ_v, degrees.
    pub centre_deg: [f64; 2],
    /// Diameter in degrees of the round cone that has the solid angle of the part above half height.
    pub width_deg: f64,
    /// The part above half height reaches the outermost directions: the peak may go on beyond, and be higher and wider.
    pub cut: bool,
}

/// The directions whose mean is the diffuse background: the darkest quarter (three at least), by their mean over the bands.
///
/// Chosen once for all wavelengths, so that noise does not choose: the darkest quarter of each band would be too dark.
pub fn background(means: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..means.len()).collect();
    order.sort_by(|a, b| means[*a].total_cmp(&means[*b]));
    order.truncate((means.len() / 4).max(3));
    order
}

impl Peak {
    /// `directions` and `values` as the hemisphere was made of; `background` from [`background`].
    ///
    /// `None` where no value is above the background.
    pub fn find(
        hemisphere: &Hemisphere,
        directions: &[[f64; 2]],
        values: &[f64],
        background: &[usize],
        room: &mut Vec<f64>,
    ) -> Option<Peak> {
        let dark: Vec<f64> = background.iter().filter_map(|index| values.get(*index).copied()).collect();
        let background = dark.iter().sum::<f64>() / dark.len() as f64;
        let (at, top) = values.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1))?;
        let brightest_deg = *directions.get(at)?;
        let height = top - background;
        // what rounding leaves of a flat leaf is no peak
        if !(height > 1e-9 * top.abs()) {
            return None;
        }
        hemisphere.map(values, room);
        let half = background + 0.5 * height;
        let part = above_half(hemisphere, room, half, brightest_deg);

        let (mut weight, mut sum, mut solid_angle, mut cut) = (0.0, [0.0; 2], 0.0, false);
        for cell in part {
            let (place, omega) = cell_place(cell);
            let excess = room[cell] - half;
            weight += excess;
            sum = [sum[0] + excess * place[0], sum[1] + excess * place[1]];
            solid_angle += omega;
            cut |= !hemisphere.cells[cell].inside;
        }
        let centre_deg = if weight > 0.0 { direction_of([sum[0] / weight, sum[1] / weight]) } else { brightest_deg };
        // Ω = 2π (1 − cos ½width)
        let width_deg = 2.0 * (1.0 - solid_angle / (2.0 * PI)).acos().to_degrees();
        Some(Peak { brightest_deg, height, background, centre_deg, width_deg, cut })
    }
}

/// The points above half height that hang together with the one nearest to the brightest direction.
fn above_half(hemisphere: &Hemisphere, map: &[f64], half: f64, brightest_deg: [f64; 2]) -> Vec<usize> {
    let [x, y] = super::disc(brightest_deg[0], brightest_deg[1]);
    let distance = |cell: usize| {
        let ([px, py], _) = cell_place(cell);
        (px - x).hypot(py - y)
    };
    let bright = |cell: &usize| map.get(*cell).is_some_and(|value| *value > half);
    let Some(start) = (0..hemisphere.cells.len()).filter(bright).min_by(|a, b| distance(*a).total_cmp(&distance(*b)))
    else {
        return Vec::new();
    };
    let ring = ring_length();
    let mut seen = vec![false; map.len()];
    let (mut waiting, mut part) = (vec![start], Vec::new());
    seen[start] = true;
    while let Some(cell) = waiting.pop() {
        part.push(cell);
        let (first, place) = (cell - cell % ring, cell % ring);
        let round = [first + (place + 1) % ring, first + (place + ring - 1) % ring];
        // the innermost ring surrounds one point: across it lies its other half
        let inward = if cell >= ring { cell - ring } else { (place + ring / 2) % ring };
        for next in round.into_iter().chain([inward, cell + ring]) {
            if next < map.len() && !seen[next] && bright(&next) {
                seen[next] = true;
                waiting.push(next);
            }
        }
    }
    part
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hemisphere::disc;

    /// A ring of views every 5°, dense enough to see shapes.
    fn dense() -> Vec<[f64; 2]> {
        let ring = |t| (0..if t == 0 { 1 } else { 72 }).map(move |p| [f64::from(t) * 5.0, f64::from(p) * 5.0]);
        (0..=17).flat_map(ring).collect()
    }

    #[test]
    fn a_gaussian_peak_has_its_place_height_and_width_again() {
        let directions = dense();
        let [cx, cy] = disc(40.0, 180.0);
        // a standard deviation of 0.1 on the disc is 0.1 · √2 rad where the disc is not stretched: 1.1774 σ is half of the
        // full width
        let shape = |[theta, phi]: &[f64; 2]| {
            let [x, y] = disc(*theta, *phi);
            0.03 + 0.5 * (-((x - cx).powi(2) + (y - cy).powi(2)) / (2.0 * 0.01)).exp()
        };
        let values: Vec<f64> = directions.iter().map(shape).collect();
        let hemisphere = Hemisphere::new(&directions, false).unwrap();
        let peak = Peak::find(&hemisphere, &directions, &values, &background(&values), &mut Vec::new()).unwrap();
        assert_eq!(peak.brightest_deg, [40.0, 180.0]);
        assert!((peak.background - 0.03).abs() < 1e-4 && (peak.height - 0.5).abs() < 1e-3, "{peak:?}");
        // equal-area disc: the same solid angle as a cap of area π (1.1774 · 0.1)², doubled
        let solid_angle = 2.0 * PI * (0.11774_f64).powi(2);
        let width = 2.0 * (1.0 - solid_angle / (2.0 * PI)).acos().to_degrees();
        // facets between 5° views under-estimate a convex peak: 2 % of the width
        assert!((peak.width_deg / width - 1.0).abs() < 0.02, "{} {width}", peak.width_deg);
        assert!((peak.centre_deg[0] - 40.0).abs() < 0.5 && (peak.centre_deg[1] - 180.0).abs() < 0.5 && !peak.cut);
    }

    #[test]
    fn a_peak_at_the_zenith_hangs_together_across_it_and_one_at_the_rim_is_cut() {
        let directions = dense();
        let hemisphere = Hemisphere::new(&directions, false).unwrap();
        let find = |theta: f64| {
            let [cx, cy] = disc(theta, 180.0);
            let shape = |[theta, phi]: &[f64; 2]| {
                let [x, y] = disc(*theta, *phi);
                0.1 + (-((x - cx).powi(2) + (y - cy).powi(2)) / 0.02).exp()
            };
            let values: Vec<f64> = directions.iter().map(shape).collect();
            Peak::find(&hemisphere, &directions, &values, &background(&values), &mut Vec::new()).unwrap()
        };
        let (zenith, oblique, rim) = (find(0.0), find(40.0), find(85.0));
        assert!((zenith.width_deg / oblique.width_deg - 1.0).abs() < 0.03, "{zenith:?} {oblique:?}");
        assert!(zenith.centre_deg[0] < 1.0 && !zenith.cut && rim.cut);
    }

    #[test]
    fn a_flat_leaf_has_no_peak() {
        let directions = dense();
        let hemisphere = Hemisphere::new(&directions, false).unwrap();
        let flat = vec![0.1; directions.len()];
        assert_eq!(Peak::find(&hemisphere, &directions, &flat, &background(&flat), &mut Vec::new()), None);
    }
}
