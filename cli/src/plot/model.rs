//! The model at one wavelength, as a fit left it: any facets, any diffuse term, any tilt.

use leafbrdf_core::{
    Angle, Diffuse, DirectionVectors, DomainError, GgxSurface, Grade, Illumination, Lambert, Normalization, P2,
    Surface, Tilt,
};
use serde_json::Value;

/// Facets and masking.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Facets {
    /// Beckmann facets, V-cavity masking (Eqs 7, 9).
    Beckmann,
    /// GGX facets, Smith's masking.
    Ggx,
}

/// What does not depend on wavelength, beside n and σ.
#[derive(Clone, Copy, Debug)]
pub struct Shape {
    /// Facets and masking.
    pub facets: Facets,
    /// The convention for K.
    pub normalization: Normalization,
    /// The diffuse term, of which P1 is the case e = 0; `None` is Lambert's.
    pub diffuse: Option<P2<f64>>,
    /// How the leaf lay.
    pub tilt: Tilt<f64>,
}

impl Shape {
    /// From `summary.json`.
    ///
    /// # Errors
    /// Facets or a diffuse term that are not drawn, or parameters outside the model's domain.
    pub fn of_summary(summary: &Value) -> Result<Self, String> {
        let word = |key: &str| summary.get(key).and_then(Value::as_str);
        let number = |name: &str| {
            let parameter = summary.get("parameters").and_then(|parameters| parameters.get(name))?;
            parameter.get("value").unwrap_or(parameter).as_f64()
        };
        let domain = |error: DomainError| format!("summary.json: {error}");
        let facets = match word("facets") {
            None | Some("beckmann") => Facets::Beckmann,
            Some("ggx") => Facets::Ggx,
            Some(other) => return Err(format!("facets {other} are not drawn")),
        };
        let diffuse = match word("diffuse") {
            None | Some("lambert") => None,
            Some("p1" | "p2") => {
                let [a, b, e] = ["p1_a", "p1_b", "p2_e"].map(|name| number(name).unwrap_or(0.0));
                Some(P2::new(a, b, e).map_err(domain)?)
            }
            Some(other) => return Err(format!("the diffuse term {other} is not drawn")),
        };
        let degrees = |name: &str| Angle::from_degrees(number(name).unwrap_or(0.0));
        let tilt = Tilt::new(degrees("tilt_in_plane_deg"), degrees("tilt_lateral_deg")).map_err(domain)?;
        let conventions = [Normalization::Bousquet2005, Normalization::CookTorrance];
        let normalization = conventions.into_iter().find(|one| Some(one.name()) == word("normalization"));
        Ok(Shape { facets, normalization: normalization.unwrap_or_default(), diffuse, tilt })
    }

    /// With n and σ.
    ///
    /// # Errors
    /// n < 1, σ ≤ 0, or no number.
    pub fn surface(&self, n: f64, sigma: f64) -> Result<LeafSurface, DomainError> {
        let lobe = match self.facets {
            Facets::Beckmann => Lobe::Beckmann(Surface::new(n, sigma)?.with_normalization(self.normalization)),
            Facets::Ggx => Lobe::Ggx(Surface::ggx(n, sigma)?.with_normalization(self.normalization)),
        };
        Ok(LeafSurface { shape: *self, lobe })
    }
}

#[derive(Clone, Copy, Debug)]
enum Lobe {
    Beckmann(Surface<f64>),
    Ggx(GgxSurface<f64>),
}

/// Everything but k_L.
#[derive(Clone, Copy, Debug)]
pub struct LeafSurface {
    shape: Shape,
    lobe: Lobe,
}

impl LeafSurface {
    /// BRDF_diff/k_L and BRDF_spec in sr⁻¹, as the level instrument sees them; NaN at or below a horizon.
    pub fn parts(&self, directions: &DirectionVectors<f64>) -> [f64; 2] {
        let Ok(seen) = directions.about(&self.shape.tilt) else { return [f64::NAN; 2] };
        let geometry = seen.geometry();
        let diffuse = match self.shape.diffuse {
            None => Lambert.shape(geometry),
            Some(bowl) => bowl.shape(geometry),
        };
        let specular = match self.lobe {
            Lobe::Beckmann(surface) => surface.brdf(geometry),
            Lobe::Ggx(surface) => surface.brdf(geometry),
        };
        // the tilted leaf receives cosθ_s'/cosθ_s of what the level reference does
        [seen.factor() * diffuse, seen.factor() * specular]
    }
}

impl LeafSurface {
    /// DHRF_spec at θ_s = 0, of the leaf as if it lay level.
    pub fn dhrf_at_zenith(&self) -> f64 {
        match (&self.lobe, Illumination::new(Angle::from_degrees(0.0))) {
            (Lobe::Beckmann(surface), Ok(zenith)) => surface.dhrf(&zenith, Grade::E6),
            (Lobe::Ggx(surface), Ok(zenith)) => surface.dhrf(&zenith, Grade::E6),
            // 0° is above the horizon
            (_, Err(_)) => f64::NAN,
        }
    }
}

/// A pair of directions in degrees; `None` at or below the horizon.
pub fn directions(theta_s_deg: f64, theta_v_deg: f64, phi_v_deg: f64) -> Option<DirectionVectors<f64>> {
    let deg = Angle::from_degrees;
    DirectionVectors::from_angles(deg(theta_s_deg), deg(theta_v_deg), deg(phi_v_deg)).ok()
}

/// The model at one wavelength.
#[derive(Clone, Copy, Debug)]
pub struct BandModel {
    /// k_L.
    pub k_l: f64,
    /// The rest.
    pub surface: LeafSurface,
}

impl BandModel {
    /// BRDF in sr⁻¹ from θ_s to (θ_v, φ_v), degrees; NaN at or below the horizon.
    pub fn brdf(&self, theta_s_deg: f64, theta_v_deg: f64, phi_v_deg: f64) -> f64 {
        let Some(directions) = directions(theta_s_deg, theta_v_deg, phi_v_deg) else { return f64::NAN };
        let [diffuse, specular] = self.surface.parts(&directions);
        self.k_l * diffuse + specular
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn without_options_it_is_the_papers_model() {
        let shape = Shape::of_summary(&json!({"normalization": "cook-torrance"})).unwrap();
        let model = BandModel { k_l: 0.3, surface: shape.surface(1.5, 0.3).unwrap() };
        let [s, v, phi] = [40.0, 55.0, 170.0].map(Angle::from_degrees);
        let geometry = leafbrdf_core::Geometry::from_angles(s, v, phi).unwrap();
        let lobe = Surface::new(1.5, 0.3).unwrap().with_normalization(Normalization::CookTorrance);
        let expected = 0.3 / std::f64::consts::PI + lobe.brdf(&geometry);
        // two ways to the same half vector: roundings
        assert!((model.brdf(40.0, 55.0, 170.0) / expected - 1.0).abs() < 1e-12);
        assert!(model.brdf(40.0, 90.0, 0.0).is_nan());
    }

    #[test]
    fn a_tilt_towards_the_source_moves_the_mirror_direction_by_twice_its_angle() {
        let tilted = json!({"parameters": {"tilt_in_plane_deg": {"value": 5.0}}});
        let shape = Shape::of_summary(&tilted).unwrap();
        let model = BandModel { k_l: 0.0, surface: shape.surface(1.5, 0.05).unwrap() };
        let brightest = (0..80).max_by(|a, b| {
            let at = |theta: &i32| model.brdf(40.0, f64::from(*theta), 180.0);
            at(a).total_cmp(&at(b))
        });
        assert_eq!(brightest, Some(30));
    }

    #[test]
    fn what_is_not_drawn_is_said() {
        let error = Shape::of_summary(&json!({"diffuse": "p7"})).unwrap_err();
        assert!(error.contains("p7"));
        assert!(Shape::of_summary(&json!({"facets": "mirror"})).is_err());
    }
}
