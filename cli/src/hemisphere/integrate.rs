//! The hemispherical integral of a BRDF that is known in scattered directions (Eq. 2, §3.1).
//!
//! ```text
//! DHRF = ∫ f cosθ_v dΩ_v = 2 ∫ f (1 − r²) dA = Σ w_i f_i      over the unit disc, r² = 1 − cosθ_v
//! ```
//!
//! Natural-neighbour interpolation is linear in the values, so the integral is a weighted sum of them: the weights depend on
//! the directions alone and serve every wavelength.

use std::f64::consts::PI;
use std::fmt;

use super::{DirectionMesh, Interpolator, MeshError, disc};

/// Rings of equal width on the disc, and points on each.
const RINGS: usize = 100;
const POINTS: usize = 180;

/// To tell what its neighbours say of a direction, so many of the others are enough.
const NEAREST: usize = 60;

/// How far inside the hull the second point of the linear continuation lies, in radii of the disc.
const STEP: f64 = 0.15;

/// Least share of ∫ cosθ dΩ that the directions must enclose.
const LEAST_ENCLOSED: f64 = 0.5;

/// Below this share, views lie in one plane but for the rounding of their azimuths.
const NO_AREA: f64 = 1e-6;

/// A smooth function between points at equal distances differs from its interpolation by about a third of what leaving one
/// point out shows (0.26 to 0.37 for lobes of σ ≥ 0.2 on the paper's goniometer).
const SMOOTH_PART: f64 = 1.0 / 3.0;

/// Why the directions of a measurement cannot be integrated over.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum IntegrationError {
    /// They span no area: too few, or all in one plane.
    Mesh(MeshError),
    /// They enclose too small a part of the hemisphere.
    Enclosed {
        /// The part, of ∫ cosθ dΩ.
        share: f64,
    },
}

impl fmt::Display for IntegrationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            IntegrationError::Mesh(MeshError::NoArea { directions }) => write!(
                f,
                "{directions} directions, all in one plane or too few (three at least), span no part of the hemisphere: a \
                 DHRF needs views across the principal plane too; a fit (leafbrdf fit) gives a modelled one"
            ),
            IntegrationError::Mesh(error) => error.fmt(f),
            IntegrationError::Enclosed { share } => write!(
                f,
                "the directions enclose {:.0} % of the hemisphere (of ∫ cosθ dΩ), and {:.0} % are needed: most of the integral \
                 would be extrapolated",
                100.0 * share,
                100.0 * LEAST_ENCLOSED
            ),
        }
    }
}

impl std::error::Error for IntegrationError {}

/// A hemispherical integral, and how well it is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Integral {
    /// DHRF, unitless.
    pub dhrf: f64,
    /// Share of it that comes from beyond the outermost directions, where the nearest value is taken.
    pub extrapolated_share: f64,
    /// Error of the interpolation, from values left out one by one: √(Σ (w_i e_i)² + (Σ w_i e_i / 3)²).
    pub interpolation_error: f64,
    /// Difference between continuing with the nearest value and continuing linearly.
    pub extrapolation_error: f64,
    /// Standard deviation by the noise of the values; NaN where it is not known.
    pub noise_sd: f64,
}

impl Integral {
    /// The three errors together, as independent ones; noise where it is known (it is in the interpolation's error as well).
    pub fn error(&self) -> f64 {
        let noise = if self.noise_sd.is_nan() { 0.0 } else { self.noise_sd };
        (self.interpolation_error.powi(2) + self.extrapolation_error.powi(2) + noise * noise).sqrt()
    }
}

/// One point of the quadrature.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    /// Where its neighbours begin.
    first: usize,
    /// Whether it lies within the hull of the directions.
    pub inside: bool,
}

/// Everything about a set of viewing directions that an integral needs.
pub struct Hemisphere {
    /// w_i: inside the hull, beyond it, and beyond it with linear continuation.
    inside: Vec<f64>,
    beyond: Vec<f64>,
    linear: Vec<f64>,
    /// For each direction what its neighbours say of it.
    left_out: Vec<Vec<(usize, f64)>>,
    pub(super) cells: Vec<Cell>,
    neighbours: Vec<(u32, f32)>,
}

impl Hemisphere {
    /// Directions as θ_v, φ_v in degrees.
    ///
    /// - `mirrored`: every view is taken for its mirror image too, f(φ_v) = f(−φ_v), as for every leaf that is not tilted
    ///   sideways. Where both sides are seen this only makes the mesh finer: the integral of a leaf without the symmetry is
    ///   that of the mean of both images. Where one side is seen it replaces the other.
    ///
    /// # Errors
    /// Fewer than three directions, all of them in one plane, or less than half of ∫ cosθ dΩ enclosed.
    pub fn new(directions: &[[f64; 2]], mirrored: bool) -> Result<Self, IntegrationError> {
        let (sites, owner) = with_images(directions, mirrored);
        let mesh = DirectionMesh::new(sites.iter().copied()).map_err(IntegrationError::Mesh)?;
        let between = mesh.interpolator();

        let zeros = || vec![0.0; directions.len()];
        let (mut inside, mut beyond, mut linear) = (zeros(), zeros(), zeros());
        let mut cells = Vec::with_capacity(RINGS * POINTS);
        let mut neighbours: Vec<(u32, f32)> = Vec::with_capacity(RINGS * POINTS * 6);
        let (mut near, mut deeper) = (Vec::new(), Vec::new());
        for (point, weight) in quadrature() {
            between.weights(point, &mut near);
            let within = !near.is_empty();
            cells.push(Cell { first: neighbours.len(), inside: within });
            if within {
                near.iter().for_each(|(site, share)| inside[owner[*site]] += weight * share);
            } else {
                let rim = mesh.nearest_on_hull(point);
                at_rim(&between, rim, &mut near);
                near.iter().for_each(|(site, share)| beyond[owner[*site]] += weight * share);
                // f(rim) + (f(rim) − f(deeper)) · distance/step, radially
                let length = rim[0].hypot(rim[1]);
                let deeper_in = [rim[0] * (1.0 - STEP / length), rim[1] * (1.0 - STEP / length)];
                between.weights(deeper_in, &mut deeper);
                let steps = if deeper.is_empty() { 0.0 } else { (point[0] - rim[0]).hypot(point[1] - rim[1]) / STEP };
                near.iter().for_each(|(site, share)| linear[owner[*site]] += weight * share * (1.0 + steps));
                deeper.iter().for_each(|(site, share)| linear[owner[*site]] -= weight * share * steps);
            }
            neighbours.extend(near.iter().map(|(site, share)| (owner[*site] as u32, *share as f32)));
        }
        // a constant function of 1/π integrates to 1
        let share = inside.iter().sum::<f64>() / PI;
        if share < NO_AREA {
            return Err(IntegrationError::Mesh(MeshError::NoArea { directions: directions.len() }));
        }
        if !(share >= LEAST_ENCLOSED) {
            return Err(IntegrationError::Enclosed { share });
        }
        let left_out = (0..directions.len()).map(|index| left_out(index, &sites, &owner)).collect();
        Ok(Hemisphere { inside, beyond, linear, left_out, cells, neighbours })
    }

    /// DHRF of the values, sr⁻¹, one a direction, none missing; `sd` their standard deviations.
    pub fn integrate(&self, values: &[f64], sd: Option<&[f64]>) -> Integral {
        let sum = |weights: &[f64]| weights.iter().zip(values).map(|(w, f)| w * f).sum::<f64>();
        let (within, beyond, linear) = (sum(&self.inside), sum(&self.beyond), sum(&self.linear));
        let weights = || self.inside.iter().zip(&self.beyond).map(|(inside, beyond)| inside + beyond);

        let expected = |from: &Vec<(usize, f64)>| from.iter().map(|(index, share)| share * values[*index]).sum::<f64>();
        let (mut squares, mut signed) = (0.0, 0.0);
        for ((weight, value), from) in weights().zip(values).zip(&self.left_out) {
            let part = weight * (value - expected(from));
            squares += part * part;
            signed += part;
        }
        let noise_sd =
            sd.map_or(f64::NAN, |sd| weights().zip(sd).map(|(weight, sd)| (weight * sd).powi(2)).sum::<f64>().sqrt());
        Integral {
            dhrf: within + beyond,
            extrapolated_share: beyond / (within + beyond),
            interpolation_error: (squares + (SMOOTH_PART * signed).powi(2)).sqrt(),
            extrapolation_error: (linear - beyond).abs(),
            noise_sd,
        }
    }

    /// Share of ∫ cosθ dΩ that the directions enclose.
    pub fn enclosed(&self) -> f64 {
        self.inside.iter().sum::<f64>() / PI
    }

    /// The interpolated value at every point of the quadrature.
    pub(super) fn map(&self, values: &[f64], map: &mut Vec<f64>) {
        map.clear();
        let ends = self.cells.iter().skip(1).map(|cell| cell.first).chain([self.neighbours.len()]);
        map.extend(self.cells.iter().zip(ends).map(|(cell, end)| {
            let near = self.neighbours.get(cell.first..end).unwrap_or(&[]);
            near.iter().map(|(index, share)| f64::from(*share) * values[*index as usize]).sum::<f64>()
        }));
    }
}

/// Points of the disc, ring by ring, and the integral of 2 (1 − r²) dA = cosθ dΩ over the surroundings of each.
fn quadrature() -> impl Iterator<Item = ([f64; 2], f64)> {
    // 2π ∫ 2 (1 − r²) r dr
    let up_to = |radius: f64| 2.0 * PI * (radius.powi(2) - 0.5 * radius.powi(4));
    (0..RINGS).flat_map(move |ring| {
        let weight = (up_to(edge(ring + 1)) - up_to(edge(ring))) / POINTS as f64;
        (0..POINTS).map(move |point| (at(middle(ring), point), weight))
    })
}

/// Inner edge of a ring.
fn edge(ring: usize) -> f64 {
    ring as f64 / RINGS as f64
}

/// Radius of a ring's points.
fn middle(ring: usize) -> f64 {
    (ring as f64 + 0.5) / RINGS as f64
}

fn at(radius: f64, point: usize) -> [f64; 2] {
    let (sin, cos) = (2.0 * PI * (point as f64 + 0.5) / POINTS as f64).sin_cos();
    [radius * cos, radius * sin]
}

/// Points of the quadrature on each ring.
pub(super) const fn ring_length() -> usize {
    POINTS
}

/// A point of the quadrature by its number: its place on the disc, and the solid angle around it, sr.
pub(super) fn cell_place(cell: usize) -> ([f64; 2], f64) {
    let ring = cell / POINTS;
    let solid_angle = 2.0 * PI * (edge(ring + 1).powi(2) - edge(ring).powi(2)) / POINTS as f64;
    (at(middle(ring), cell % POINTS), solid_angle)
}

/// The directions, with their mirror images behind them, and which direction each of these is.
fn with_images(directions: &[[f64; 2]], mirrored: bool) -> (Vec<[f64; 2]>, Vec<usize>) {
    let mut sites = directions.to_vec();
    let mut owner: Vec<usize> = (0..directions.len()).collect();
    let images = directions.iter().enumerate().filter(|_| mirrored);
    for (index, [theta_v, phi_v]) in images {
        let image = [*theta_v, -phi_v];
        let [x, y] = disc(image[0], image[1]);
        // a view in the plane, or one whose image was measured itself, needs none
        let measured = |site: &[f64; 2]| {
            let [other_x, other_y] = disc(site[0], site[1]);
            (other_x - x).hypot(other_y - y) < 1e-9
        };
        if !directions.iter().any(measured) {
            sites.push(image);
            owner.push(index);
        }
    }
    (sites, owner)
}

/// What the other directions say of this one: the weights without it (and its image).
fn left_out(index: usize, sites: &[[f64; 2]], owner: &[usize]) -> Vec<(usize, f64)> {
    let point = disc(sites[index][0], sites[index][1]);
    let mut others: Vec<usize> = (0..sites.len()).filter(|site| owner[*site] != index).collect();
    let distance = |site: &usize| {
        let [x, y] = disc(sites[*site][0], sites[*site][1]);
        (x - point[0]).hypot(y - point[1])
    };
    if sites.len() > 4 * NEAREST {
        others.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        others.truncate(NEAREST);
    }
    let Ok(mesh) = DirectionMesh::new(others.iter().map(|site| sites[*site])) else { return vec![(index, 1.0)] };
    let between = mesh.interpolator();
    let mut near = Vec::new();
    between.weights(point, &mut near);
    if near.is_empty() {
        at_rim(&between, mesh.nearest_on_hull(point), &mut near);
    }
    near.iter().map(|(place, share)| (owner[others[*place]], *share)).collect()
}

/// The weights at a point of the hull's rim: a hair inside, where no cell is empty and rounding leaves nothing outside.
fn at_rim(between: &Interpolator<'_>, [x, y]: [f64; 2], near: &mut Vec<(usize, f64)>) {
    for shrink in [1e-9, 1e-6, 1e-4, 1e-2] {
        between.weights([x * (1.0 - shrink), y * (1.0 - shrink)], near);
        if !near.is_empty() && near.iter().all(|(_, share)| share.is_finite()) {
            return;
        }
    }
    near.clear();
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::paper_directions;

    fn goniometer() -> Vec<[f64; 2]> {
        let of_source = paper_directions().into_iter().filter(|d| d.theta_s_deg == 8.0);
        of_source.map(|d| [d.theta_v_deg, d.phi_v_deg]).collect()
    }

    #[test]
    fn a_lambertian_leaf_integrates_to_its_coefficient() {
        for mirrored in [false, true] {
            let hemisphere = Hemisphere::new(&goniometer(), mirrored).unwrap();
            let integral = hemisphere.integrate(&[0.37 / PI; 98], Some(&[0.0; 98]));
            // the weights of every point add up to one: rounding
            assert!((integral.dhrf - 0.37).abs() < 1e-12, "{integral:?}");
            assert!(integral.error() < 1e-12 && integral.noise_sd == 0.0, "{integral:?}");
            // the outermost views stand 3° to 18° above the horizon, where cosθ leaves little
            assert!(integral.extrapolated_share > 0.0 && integral.extrapolated_share < 0.07, "{integral:?}");
        }
    }

    // ∫ cosθ · cosθ dΩ = 2π/3; on the disc cosθ = 1 − r² is a paraboloid, which linear facets under-estimate
    #[test]
    fn a_cosine_integrates_to_its_known_value_within_the_stated_error() {
        let directions = goniometer();
        let hemisphere = Hemisphere::new(&directions, true).unwrap();
        let values: Vec<f64> = directions.iter().map(|[theta, _]| theta.to_radians().cos()).collect();
        let integral = hemisphere.integrate(&values, None);
        let error = integral.dhrf - 2.0 * PI / 3.0;
        assert!(error.abs() < integral.error(), "{error} {integral:?}");
        assert!(error.abs() < 0.01 * 2.0 * PI / 3.0, "{error}");
        assert!(integral.noise_sd.is_nan());
    }

    #[test]
    fn turning_all_azimuths_changes_nothing_but_the_grid_under_them() {
        let directions = goniometer();
        let values: Vec<f64> = directions.iter().map(|[theta, phi]| 0.1 + disc(*theta, *phi)[0].powi(2)).collect();
        let dhrf = |turn: f64| {
            let turned: Vec<[f64; 2]> = directions.iter().map(|[theta, phi]| [*theta, phi + turn]).collect();
            Hemisphere::new(&turned, false).unwrap().integrate(&values, None).dhrf
        };
        let level = dhrf(0.0);
        // points 2° apart: a turn by one of them is the same sum, others move with the grid by less than its error, 2·10⁻⁴
        assert!((dhrf(2.0) / level - 1.0).abs() < 1e-10);
        assert!((dhrf(77.7) / level - 1.0).abs() < 2e-4);
    }

    #[test]
    fn half_a_hemisphere_and_its_image_are_a_whole_one() {
        let half: Vec<[f64; 2]> =
            (0..=8).flat_map(|p| (1..=8).map(move |t| [f64::from(t) * 10.0, f64::from(p) * 22.5])).collect();
        let values: Vec<f64> = half.iter().map(|[theta, phi]| 0.1 + 0.02 * disc(*theta, *phi)[0]).collect();
        let whole = Hemisphere::new(&half, true).unwrap().integrate(&values, None);
        // ∫ x cosθ dΩ = 0 by symmetry: 0.1 π, but for the rim beyond 80°, where the nearest value is taken
        assert!((whole.dhrf / (0.1 * PI) - 1.0).abs() < 1e-3, "{whole:?}");
        // without the image the hull is a half disc: the other half would be its edge's values
        let refused = Hemisphere::new(&half, false).err();
        assert!(matches!(refused, Some(IntegrationError::Enclosed { share }) if share > 0.4), "{refused:?}");
    }

    #[test]
    fn noise_adds_up_as_the_weights_say() {
        let hemisphere = Hemisphere::new(&goniometer(), true).unwrap();
        let noise = hemisphere.integrate(&[0.1; 98], Some(&[0.01; 98])).noise_sd;
        // 98 independent values of about equal weight: 0.01 π/√98, somewhat more as the weights differ
        let equal = 0.01 * PI / 98_f64.sqrt();
        assert!(noise > equal && noise < 1.5 * equal, "{noise} {equal}");
    }

    #[test]
    fn too_few_directions_or_too_small_a_part_are_refused_with_the_reason() {
        let refused = |directions: &[[f64; 2]]| Hemisphere::new(directions, true).err().unwrap().to_string();
        let plane: Vec<[f64; 2]> =
            (1..=7).flat_map(|t| [0.0, 180.0].map(move |phi| [f64::from(t) * 10.0, phi])).collect();
        assert!(refused(&plane).contains("principal plane"), "{}", refused(&plane));
        let cap: Vec<[f64; 2]> = (0..8).map(|p| [30.0, f64::from(p) * 45.0]).collect();
        assert!(refused(&cap).contains("enclose"), "{}", refused(&cap));
    }
}
