//! χ² over n and σ, k_L always at its best: how well the two are known, and how alone the minimum is.

use leafbrdf_core::DirectionVectors;

use super::axes::{Axis, Frame, Unit};
use super::colour::hex;
use super::contour::{Grid, path};
use super::model::{Shape, directions};
use super::style::{INK, PAPER, SMALL_PX};
use super::svg::{Anchor, Stroke, Svg, TextStyle, number};

/// Values that share one diffuse coefficient, and the surface that was fitted to them.
pub struct Values {
    /// Directions, BRDF in sr⁻¹ and weight of each value.
    pub values: Vec<(DirectionVectors<f64>, f64, f64)>,
    /// n and σ as fitted.
    pub fitted: [f64; 2],
    /// Their standard errors, NaN where there are none.
    pub errors: [f64; 2],
    /// Their correlation, where the regions of confidence are to follow from the errors rather than from χ².
    pub correlation: Option<f64>,
    /// Facets, diffuse term, tilt.
    pub shape: Shape,
}

impl Values {
    /// A value that takes part; `None` at or below the horizon, without a number or without weight.
    pub fn value(angles_deg: [f64; 3], brdf: f64, weight: f64) -> Option<(DirectionVectors<f64>, f64, f64)> {
        let [theta_s, theta_v, phi_v] = angles_deg;
        let directions = directions(theta_s, theta_v, phi_v)?;
        (brdf.is_finite() && weight > 0.0 && weight.is_finite()).then_some((directions, brdf, weight))
    }

    /// χ² at n and σ with the best k_L ≥ 0, which enters linearly. NaN outside the model's domain.
    fn chi2(&self, n: f64, sigma: f64) -> f64 {
        let Ok(surface) = self.shape.surface(n, sigma) else { return f64::NAN };
        let (mut shapes, mut sum, mut squares) = (0.0, 0.0, 0.0);
        for (directions, brdf, weight) in &self.values {
            let [diffuse, specular] = surface.parts(directions);
            if specular.is_nan() {
                continue;
            }
            let rest = brdf - specular;
            shapes += weight * diffuse * diffuse;
            sum += weight * rest * diffuse;
            squares += weight * rest * rest;
        }
        // Σ w (r − k d)² is least at k = Σ w r d / Σ w d²
        let k_l = (sum / shapes).max(0.0);
        squares - 2.0 * k_l * sum + k_l * k_l * shapes
    }
}

const SIDE: f64 = 400.0;
const NODES: usize = 91;

/// The whole valley on the left, the minimum on the right.
pub fn valley(prefix: &str, title: &str, note: &str, values: &Values) -> Result<String, String> {
    let [n, sigma] = values.fitted;
    let least = values.chi2(n, sigma);
    let freedom = values.values.len() as f64 - 3.0;
    if !(least > 0.0 && freedom >= 1.0) {
        return Err("χ² has no scale: the model meets every value, or there are too few".to_string());
    }
    let (left, top) = (92.0, 92.0);
    let second = left + SIDE + 130.0;
    let mut svg = Svg::new(second + SIDE + 50.0, top + SIDE + 98.0, prefix, title, note);
    svg.text([24.0, 34.0], title, TextStyle { size: 18.0, bold: true, ..TextStyle::default() });

    let n_label = "refractive index n";
    let sigma_label = "roughness σ, logarithmic";
    let whole = Frame {
        left,
        top,
        width: SIDE,
        height: SIDE,
        x: Axis::exact(n_label, Unit::Unitless, 1.05, 1.2 + 2.5 * (n - 1.0).max(0.16), 9),
        y: Axis::logarithmic(sigma_label, Unit::Unitless, (sigma / 4.0).max(0.01), (4.0 * sigma).min(1.2)),
    };
    let ratios = [1.2, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0, 50.0];
    let words = ratios.map(|ratio| format!("{ratio}"));
    panel(&mut svg, &whole, values.fitted, |n, sigma| values.chi2(n, sigma) / least, &ratios, &words);
    whole.heading(&mut svg, "χ² / least χ²");
    cross(&mut svg, &whole, values.fitted);
    whole.axes(&mut svg, true, true);

    // joint regions of two parameters: Δχ² = 2.30, 6.18, 11.83 times the variance of a value (68.3, 95.4, 99.7 %)
    let variance = least / freedom;
    let reach = |p: usize| {
        let error = values.errors[p];
        if error.is_finite() && error > 0.0 { 5.0 * error } else { 0.03 * values.fitted[p] }
    };
    let around = |quantity: &str, p: usize, count: usize| {
        let (middle, reach) = (values.fitted[p], reach(p));
        Axis::exact(
            quantity,
            Unit::Unitless,
            (middle - reach).max(if p == 0 { 1.0 } else { 1e-4 }),
            middle + reach,
            count,
        )
    };
    let near = Frame {
        left: second,
        top,
        width: SIDE,
        height: SIDE,
        x: around(n_label, 0, 7),
        y: around("roughness σ", 1, 8),
    };
    let levels = [2.30, 6.18, 11.83];
    let words = ["68 %", "95 %", "99.7 %"].map(String::from);
    let region = |n: f64, sigma: f64| match values.correlation {
        None => (values.chi2(n, sigma) - least) / variance,
        Some(correlation) => {
            let [x, y] = [(n - values.fitted[0]) / values.errors[0], (sigma - values.fitted[1]) / values.errors[1]];
            (x * x - 2.0 * correlation * x * y + y * y) / (1.0 - correlation * correlation)
        }
    };
    panel(&mut svg, &near, values.fitted, region, &levels, &words);
    near.heading(&mut svg, "joint confidence of n and σ");
    cross(&mut svg, &near, values.fitted);
    near.axes(&mut svg, true, true);
    svg.text([left, top + SIDE + 78.0], note, TextStyle { size: SMALL_PX, ..TextStyle::default() });
    Ok(svg.finish())
}

/// Filled rings, the innermost darkest, each line with its number.
fn panel(
    svg: &mut Svg,
    frame: &Frame,
    fitted: [f64; 2],
    height: impl Fn(f64, f64) -> f64,
    levels: &[f64],
    words: &[String],
) {
    let part = |node: usize| node as f64 / (NODES - 1) as f64;
    let grid = Grid::new(NODES, NODES, |i, j| {
        // the grid's set is where −χ² is at least −level
        -height(frame.x.value(part(i)), frame.y.value(1.0 - part(j)))
    });
    let step = SIDE / (NODES - 1) as f64;
    let at = |x: f64, y: f64| [frame.left + step * x, frame.top + step * y];
    svg.fill(&frame.outline(0.0), &hex(1.0), 1.0);
    let mut lines = Vec::new();
    svg.begin_clip(&frame.outline(0.0));
    for (place, level) in levels.iter().enumerate().rev() {
        let loops = grid.at_least(-level, at);
        let shade = 0.25 + 0.7 * place as f64 / levels.len() as f64;
        let data = path(&loops);
        svg.fill(&data, &hex(shade), 1.0);
        svg.outline(&data, Stroke { colour: INK, width: 0.8, dash: "" });
        lines.push((loops, words[place].clone()));
    }
    svg.end();
    let mut taken: Vec<[f64; 2]> = vec![frame.at(fitted[0], fitted[1])];
    for (loops, word) in lines.iter().rev() {
        // where the line is inside the frame and far from the labels already there
        let inside = |[x, y]: &[f64; 2]| {
            *x > frame.left + 26.0
                && *x < frame.left + SIDE - 26.0
                && *y > frame.top + 14.0
                && *y < frame.top + SIDE - 14.0
        };
        let room =
            |[x, y]: &[f64; 2]| taken.iter().map(|[a, b]| (x - a).hypot(1.6 * (y - b))).fold(f64::INFINITY, f64::min);
        let best = loops
            .iter()
            .flatten()
            .copied()
            .filter(inside)
            .max_by(|a, b| room(a).min(60.0).total_cmp(&room(b).min(60.0)));
        if let Some(at) = best.filter(|at| room(at) > 26.0) {
            let width = 8.0 * word.chars().count() as f64 + 4.0;
            let box_path = format!(
                "M{} {}h{}v15h-{}Z",
                number(at[0] - 0.5 * width),
                number(at[1] - 7.5),
                number(width),
                number(width)
            );
            svg.fill(&box_path, PAPER, 0.8);
            let style = TextStyle { size: 12.0, colour: Some(INK), anchor: Anchor::Middle, ..TextStyle::default() };
            svg.text([at[0], at[1] + 4.3], word, style);
            taken.push(at);
        }
    }
}

/// Where the fit ended.
fn cross(svg: &mut Svg, frame: &Frame, [n, sigma]: [f64; 2]) {
    let [x, y] = frame.at(n, sigma);
    for (dx, dy) in [(8.0, 0.0), (0.0, 8.0)] {
        svg.line([x - dx, y - dy], [x + dx, y + dy], Stroke { colour: "#ffffff", width: 3.4, dash: "" });
    }
    for (dx, dy) in [(7.0, 0.0), (0.0, 7.0)] {
        svg.line([x - dx, y - dy], [x + dx, y + dy], Stroke { colour: "#d6336c", width: 1.8, dash: "" });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chi2_is_least_at_the_truth_and_does_not_depend_on_the_ground() {
        let shape = Shape::of_summary(&serde_json::json!({})).unwrap();
        let surface = shape.surface(1.56, 0.29).unwrap();
        let of = |k_l: f64| {
            let angles =
                (0..60).map(|i| [20.0 + 10.0 * f64::from(i % 5), 1.1 * f64::from(i), 180.0 - f64::from(i % 7)]);
            let values = angles.map(|[theta_s, theta_v, phi_v]| {
                let directions = directions(theta_s, theta_v, phi_v).unwrap();
                let [diffuse, specular] = surface.parts(&directions);
                (directions, k_l * diffuse + specular, 1.0)
            });
            Values { values: values.collect(), fitted: [1.56, 0.29], errors: [0.01, 0.01], correlation: None, shape }
        };
        let (dark, bright) = (of(0.2), of(0.5));
        // a difference of sums below 2: a few of their roundings
        assert!(dark.chi2(1.56, 0.29).abs() < 1e-14);
        for (n, sigma) in [(1.5, 0.29), (1.6, 0.29), (1.56, 0.25), (1.56, 0.33)] {
            assert!(dark.chi2(n, sigma) > 1e-8);
            assert!((dark.chi2(n, sigma) - bright.chi2(n, sigma)).abs() < 1e-14);
        }
        assert!(dark.chi2(0.5, 0.3).is_nan());
    }
}
