//! Between scattered viewing directions: natural-neighbour interpolation on an equal-area disc.

use std::cell::RefCell;
use std::f64::consts::SQRT_2;
use std::fmt;

use spade::handles::FixedVertexHandle;
use spade::{DelaunayTriangulation, HasPosition, NaturalNeighbor, Point2, Triangulation};

/// A viewing direction as a point of the unit disc: x towards the source (φ_v = 0), y towards φ_v = 90°, radius √2 sin(θ_v/2).
///
/// Lambert's azimuthal projection: equal solid angles become equal areas (the hemisphere's 2π sr the disc's π, a factor of 2),
/// and θ_v = 90° is the rim.
///
/// ```
/// use leafbrdf::hemisphere::disc;
/// let [x, y] = disc(60.0, 180.0);
/// assert!((x + 0.5_f64.sqrt()).abs() < 1e-15 && y.abs() < 1e-15); // half of the hemisphere's solid angle lies within 60°
/// ```
pub fn disc(theta_v_deg: f64, phi_v_deg: f64) -> [f64; 2] {
    let radius = SQRT_2 * (theta_v_deg.to_radians() / 2.0).sin();
    let (sin_phi, cos_phi) = phi_v_deg.to_radians().sin_cos();
    [radius * cos_phi, radius * sin_phi]
}

/// θ_v and φ_v (0 to 360) in degrees of a point of the disc; beyond the rim θ_v is above 90°. NaN beyond radius √2.
pub fn direction_of([x, y]: [f64; 2]) -> [f64; 2] {
    let theta = 2.0 * (x.hypot(y) / SQRT_2).asin();
    let phi = y.atan2(x).to_degrees();
    [theta.to_degrees(), if phi < 0.0 { phi + 360.0 } else { phi }]
}

/// Why directions span no part of the hemisphere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshError {
    /// Fewer than three directions, or all of them on one line of the disc.
    NoArea {
        /// How many different directions there are.
        directions: usize,
    },
    /// A direction that is no number.
    NotFinite,
}

impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            MeshError::NoArea { directions } => write!(
                f,
                "{directions} directions span no part of the hemisphere: at least three are needed, not all on one line \
                 through it"
            ),
            MeshError::NotFinite => f.write_str("a direction is no number"),
        }
    }
}

impl std::error::Error for MeshError {}

/// A place of the disc, and the directions that fall on it (every φ_v is the same place at θ_v = 0).
struct Site {
    at: Point2<f64>,
    directions: Vec<usize>,
}

impl HasPosition for Site {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.at
    }
}

/// Scattered viewing directions, triangulated on the disc (Delaunay).
pub struct DirectionMesh {
    triangulation: DelaunayTriangulation<Site>,
    hull: Vec<[f64; 2]>,
}

impl DirectionMesh {
    /// `directions`: θ_v and φ_v in degrees. Values for them are given to [`Interpolator::at`] in the same order.
    ///
    /// # Errors
    /// Fewer than three different directions, all of them on one line, or one that is no number.
    pub fn new(directions: impl IntoIterator<Item = [f64; 2]>) -> Result<Self, MeshError> {
        let mut sites: Vec<Site> = Vec::new();
        for (index, [theta_v, phi_v]) in directions.into_iter().enumerate() {
            let [x, y] = disc(theta_v, phi_v);
            if !(x.is_finite() && y.is_finite()) {
                return Err(MeshError::NotFinite);
            }
            // 10⁻⁹ of the radius is 10⁻⁷ degrees: the same direction, spelled differently
            match sites.iter_mut().find(|site| (site.at.x - x).hypot(site.at.y - y) < 1e-9) {
                Some(site) => site.directions.push(index),
                None => sites.push(Site { at: Point2::new(x, y), directions: vec![index] }),
            }
        }
        let no_area = MeshError::NoArea { directions: sites.len() };
        let mut triangulation = DelaunayTriangulation::new();
        for site in sites {
            triangulation.insert(site).map_err(|_| MeshError::NotFinite)?;
        }
        if triangulation.all_vertices_on_line() {
            return Err(no_area);
        }
        let hull = triangulation.convex_hull().map(|edge| {
            let at = edge.from().position();
            [at.x, at.y]
        });
        let hull = hull.collect();
        Ok(DirectionMesh { triangulation, hull })
    }

    /// The corners of the directions' convex hull on the disc, in order.
    pub fn hull(&self) -> &[[f64; 2]] {
        &self.hull
    }

    /// The point of the hull that is nearest to a point outside of it; for a point inside, the nearest of its rim.
    pub fn nearest_on_hull(&self, point: [f64; 2]) -> [f64; 2] {
        let ends = self.hull.iter().zip(self.hull.iter().cycle().skip(1));
        let nearest = ends.map(|(from, to)| nearest_on_segment(point, *from, *to));
        let distance = |other: &[f64; 2]| (other[0] - point[0]).hypot(other[1] - point[1]);
        nearest.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(point)
    }

    /// What interpolates on this mesh; keep it for many points, it has buffers.
    pub fn interpolator(&self) -> Interpolator<'_> {
        Interpolator { mesh: self, natural: self.triangulation.natural_neighbor(), room: RefCell::new(Vec::new()) }
    }
}

/// The point of the segment from `a` to `b` that is nearest to `point`.
pub fn nearest_on_segment(point: [f64; 2], a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    let along = [b[0] - a[0], b[1] - a[1]];
    let length2 = along[0] * along[0] + along[1] * along[1];
    let part = ((point[0] - a[0]) * along[0] + (point[1] - a[1]) * along[1]) / length2;
    let part = if length2 > 0.0 { part.clamp(0.0, 1.0) } else { 0.0 };
    [a[0] + part * along[0], a[1] + part * along[1]]
}

/// Sibson's natural-neighbour interpolation (1981): each neighbour counts by the area that the point would take from its
/// Voronoi cell.
///
/// Exact at the directions themselves and for functions that are linear on the disc; never above the greatest neighbour or
/// below the least; smooth except at the directions.
pub struct Interpolator<'a> {
    mesh: &'a DirectionMesh,
    natural: NaturalNeighbor<'a, DelaunayTriangulation<Site>>,
    room: RefCell<Vec<(FixedVertexHandle, f64)>>,
}

impl Interpolator<'_> {
    /// Which directions a point of the disc takes its value from, and their weights, whose sum is 1; nothing outside the hull.
    ///
    /// The same weights serve every wavelength.
    pub fn weights(&self, [x, y]: [f64; 2], weights: &mut Vec<(usize, f64)>) {
        weights.clear();
        let mut room = self.room.borrow_mut();
        self.natural.get_weights(Point2::new(x, y), &mut room);
        for (vertex, weight) in room.iter() {
            let site = self.mesh.triangulation.vertex(*vertex);
            let directions = &site.data().directions;
            weights.extend(directions.iter().map(|index| (*index, weight / directions.len() as f64)));
        }
    }

    /// The value at a point of the disc; `None` outside the hull, or where `values` is too short.
    pub fn at(&self, values: &[f64], point: [f64; 2]) -> Option<f64> {
        let mut weights = Vec::with_capacity(16);
        self.weights(point, &mut weights);
        if weights.is_empty() {
            return None;
        }
        weights.iter().map(|(index, weight)| Some(weight * values.get(*index)?)).sum()
    }

    /// The same, with the value of the nearest point of the hull outside of it.
    pub fn at_or_nearest(&self, values: &[f64], point: [f64; 2]) -> Option<f64> {
        self.at(values, point).or_else(|| {
            let [x, y] = self.mesh.nearest_on_hull(point);
            // a hair inside: rounding may have left the point outside the hull again
            let within = |shrink: f64| self.at(values, [x * shrink, y * shrink]);
            within(1.0).or_else(|| within(1.0 - 1e-9)).or_else(|| within(1.0 - 1e-6))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::paper_directions;

    fn goniometer() -> Vec<[f64; 2]> {
        let of_source = paper_directions().into_iter().filter(|d| d.theta_s_deg == 8.0);
        of_source.map(|d| [d.theta_v_deg, d.phi_v_deg]).collect()
    }

    /// Points that are no directions.
    fn points() -> impl Iterator<Item = [f64; 2]> {
        (1..40).map(|i| disc(f64::from(i) * 1.7, f64::from(i) * 37.3))
    }

    #[test]
    fn a_point_of_the_disc_and_its_direction_are_one() {
        for [theta, phi] in goniometer() {
            let [back_theta, back_phi] = direction_of(disc(theta, phi));
            // asin loses half the digits nowhere below 90°: a few units of the last place of 90 and 360
            assert!((back_theta - theta).abs() < 1e-12 && (back_phi - phi).abs() < 1e-12, "{theta} {phi}");
        }
    }

    #[test]
    fn equal_solid_angles_are_equal_areas() {
        for theta in [10.0, 45.0, 89.0_f64] {
            let [radius, _] = disc(theta, 0.0);
            // cap 2π(1 − cosθ) sr, disc π r²
            assert!((radius * radius - (1.0 - theta.to_radians().cos())).abs() < 1e-15);
        }
    }

    #[test]
    fn functions_that_are_linear_on_the_disc_come_back_exactly() {
        let directions = goniometer();
        let linear = |[x, y]: [f64; 2]| 3.0 + 2.0 * x - 5.0 * y;
        let values: Vec<f64> = directions.iter().map(|[theta, phi]| linear(disc(*theta, *phi))).collect();
        let mesh = DirectionMesh::new(directions).unwrap();
        let between = mesh.interpolator();
        let mut inside = 0;
        for point in points() {
            let Some(value) = between.at(&values, point) else { continue };
            inside += 1;
            // sums of some ten products of area ratios: 10⁻¹² of the values' size is thousands of roundings
            assert!((value - linear(point)).abs() < 1e-11, "{point:?}: {value} {}", linear(point));
        }
        assert!(inside > 30);
    }

    #[test]
    fn weights_are_positive_and_add_up_to_one() {
        let mesh = DirectionMesh::new(goniometer()).unwrap();
        let between = mesh.interpolator();
        let mut weights = Vec::new();
        for point in points() {
            between.weights(point, &mut weights);
            let sum: f64 = weights.iter().map(|(_, weight)| weight).sum();
            assert!(weights.is_empty() || (sum - 1.0).abs() < 1e-12);
            assert!(weights.iter().all(|(_, weight)| *weight > -1e-12));
        }
    }

    #[test]
    fn a_direction_has_its_own_value() {
        let directions = goniometer();
        let values: Vec<f64> = (0..directions.len()).map(|i| (i as f64).sin()).collect();
        let mesh = DirectionMesh::new(directions.clone()).unwrap();
        let between = mesh.interpolator();
        for ([theta, phi], value) in directions.iter().zip(&values) {
            let found = between.at_or_nearest(&values, disc(*theta, *phi)).unwrap();
            assert!((found - value).abs() < 1e-9, "{theta} {phi}: {found} {value}");
        }
    }

    #[test]
    fn the_zenith_seen_under_several_azimuths_has_their_mean() {
        let directions = [[0.0, 0.0], [0.0, 90.0], [60.0, 0.0], [60.0, 120.0], [60.0, 240.0]];
        let mesh = DirectionMesh::new(directions).unwrap();
        let value = mesh.interpolator().at(&[1.0, 3.0, 9.0, 9.0, 9.0], [0.0, 0.0]).unwrap();
        assert!((value - 2.0).abs() < 1e-12);
    }

    #[test]
    fn outside_the_hull_there_is_nothing_or_the_nearest_value() {
        let mesh = DirectionMesh::new([[60.0, 0.0], [60.0, 120.0], [60.0, 240.0]]).unwrap();
        let between = mesh.interpolator();
        assert_eq!(between.at(&[1.0, 2.0, 3.0], disc(89.0, 0.0)), None);
        let nearest = between.at_or_nearest(&[1.0, 2.0, 3.0], disc(89.0, 0.0)).unwrap();
        assert!((nearest - 1.0).abs() < 1e-5, "{nearest}");
    }

    #[test]
    fn directions_without_area_are_refused() {
        let refused = |directions: &[[f64; 2]]| DirectionMesh::new(directions.iter().copied()).err();
        assert_eq!(refused(&[]), Some(MeshError::NoArea { directions: 0 }));
        assert_eq!(refused(&[[10.0, 0.0], [10.0, 360.0], [20.0, 0.0]]), Some(MeshError::NoArea { directions: 2 }));
        assert_eq!(
            refused(&[[10.0, 0.0], [20.0, 0.0], [30.0, 0.0]]),
            Some(MeshError::NoArea { directions: 3 }),
            "the source's side of the principal plane only"
        );
        assert_eq!(refused(&[[f64::NAN, 0.0]]), Some(MeshError::NotFinite));
    }
}
