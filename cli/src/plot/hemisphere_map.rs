//! Polar maps of BRDF over the hemisphere (Figs 1, 2, 5): measured above, modelled below, one colour scale.

use super::axes::{labels, round_up};
use super::colour::hex;
use super::contour::{Grid, path};
use super::style::{HAIR, INK, PAPER, SMALL_PX, TEXT_PX};
use super::svg::{Anchor, Stroke, Svg, TextStyle, number};
use crate::hemisphere::{DirectionMesh, direction_of, disc};

/// Radius of a map, px.
const RADIUS: f64 = 122.0;
/// From the middle of a map to the middle of the next, px.
const PITCH_X: f64 = 272.0;
const PITCH_Y: f64 = 280.0;
/// Left of the first map's middle.
const LEFT: f64 = 222.0;
/// Above the first map's middle.
const TOP: f64 = 236.0;
/// Nodes of the grid across the disc. A lobe of σ = 0.05 is some 4° wide at half its height, which is five nodes.
const NODES: usize = 151;
/// Behind the maps, where there is no value.
const SKY: &str = "#eceef1";
/// Shades of the colour scale.
const SHADES: usize = 24;

/// One direction and its value.
#[derive(Clone, Copy, Debug)]
pub struct Dot {
    /// θ_v, degrees.
    pub theta_v_deg: f64,
    /// φ_v, degrees.
    pub phi_v_deg: f64,
    /// BRDF, sr⁻¹.
    pub brdf: f64,
    /// Took part in the fit.
    pub fitted: bool,
}

/// One column of maps: one leaf, wavelength and source.
pub struct Column<'a> {
    /// Above the column.
    pub heading: String,
    /// θ_s, degrees.
    pub theta_s_deg: f64,
    /// Measured values.
    pub dots: Vec<Dot>,
    /// BRDF of the model at (θ_v, φ_v), sr⁻¹; without it the lower map is left out.
    pub model: Option<Box<dyn Fn(f64, f64) -> f64 + 'a>>,
}

/// A column's maps on the grid.
struct Maps {
    hull: String,
    /// Do the directions enclose an area? Those of one plane do not: their dots carry the values.
    encloses: bool,
    grids: Vec<(&'static str, Grid)>,
    /// What the tilt puts below the leaf's horizon: the rim and, within it, where the model ends; or nothing.
    hidden: String,
    greatest: f64,
    middle: f64,
}

/// Columns of maps as one figure; `title` stands above, `note` below. `None` where no column has directions enough.
pub fn hemisphere_map(prefix: &str, title: &str, note: &str, columns: &[Column<'_>]) -> Option<String> {
    let drawn: Vec<(&Column<'_>, Maps)> = columns.iter().filter_map(|column| Some((column, maps(column)?))).collect();
    let rows = drawn.iter().map(|(_, maps)| maps.grids.len()).max()?;
    let greatest = drawn.iter().map(|(_, maps)| maps.greatest).fold(0.0, f64::max);
    let middle = drawn.iter().map(|(_, maps)| maps.middle).fold(0.0, f64::max);
    // A narrow peak over a faint ground needs the square root; otherwise equal steps of BRDF are equal steps of lightness.
    let scale = Scale { end: round_up(greatest), square_root: greatest > 5.0 * middle };

    let width = (LEFT + PITCH_X * (drawn.len() - 1) as f64 + RADIUS + 190.0).max(760.0);
    let height = TOP + PITCH_Y * (rows - 1) as f64 + RADIUS + 84.0;
    let mut svg = Svg::new(width, height, prefix, title, note);
    svg.text([24.0, 34.0], title, TextStyle { size: 18.0, bold: true, ..TextStyle::default() });
    for (place, (column, maps)) in drawn.iter().enumerate() {
        let x = LEFT + PITCH_X * place as f64;
        let style = TextStyle { bold: true, ..TextStyle::middle() };
        svg.text([x, TOP - RADIUS - 34.0], &column.heading, style);
        for (row, (name, grid)) in maps.grids.iter().enumerate() {
            let centre = [x, TOP + PITCH_Y * row as f64];
            map(
                &mut svg,
                centre,
                column,
                (&maps.hull, row > 0, maps.encloses, &maps.hidden),
                grid,
                &scale,
                [row == 0 && place == 0, row == 0 && place + 1 == drawn.len()],
            );
            if place == 0 {
                let style = TextStyle { upwards: true, bold: true, ..TextStyle::middle() };
                svg.text([34.0, centre[1]], name, style);
            }
        }
    }
    let bar = [LEFT + PITCH_X * (drawn.len() - 1) as f64 + RADIUS + 92.0, TOP - RADIUS];
    scale.bar(&mut svg, bar, PITCH_Y * (rows - 1) as f64 + 2.0 * RADIUS);
    let flat = drawn.iter().any(|(_, maps)| !maps.encloses);
    let note = if flat { "equal-area disc: middle θ_v = 0°, rim 90°; coloured dots: measured values" } else { note };
    legend(&mut svg, [LEFT - RADIUS, height - 40.0], note, drawn.iter().any(|(c, _)| c.dots.iter().any(|d| !d.fitted)));
    Some(svg.finish())
}

/// A point of the unit disc on the figure: the source on the left, forward on the right.
fn place([x, y]: [f64; 2], [centre_x, centre_y]: [f64; 2]) -> [f64; 2] {
    [centre_x - RADIUS * x, centre_y - RADIUS * y]
}

fn maps(column: &Column<'_>) -> Option<Maps> {
    let dots: Vec<&Dot> = column.dots.iter().filter(|dot| dot.brdf.is_finite()).collect();
    let mesh = DirectionMesh::new(dots.iter().map(|dot| [dot.theta_v_deg, dot.phi_v_deg])).ok()?;
    let values: Vec<f64> = dots.iter().map(|dot| dot.brdf).collect();
    let between = mesh.interpolator();
    let step = 2.0 / (NODES - 1) as f64;
    // grid columns run from left to right, which is −x
    let point = |column: usize, row: usize| [1.0 - step * column as f64, 1.0 - step * row as f64];
    let measured = Grid::new(NODES, NODES, |i, j| {
        let at = point(i, j);
        // A little more than the hull, where the clip cuts; the rest of the square needs no value.
        let [x, y] = mesh.nearest_on_hull(at);
        let near = (x - at[0]).hypot(y - at[1]) < 3.0 * step;
        between.at(&values, at).or_else(|| near.then(|| between.at_or_nearest(&values, at))?).unwrap_or(f64::NAN)
    });
    // What lies between the directions, or beyond those fitted, does not stretch the scale: there the model may exceed it.
    let used = || dots.iter().filter(|dot| dot.fitted);
    let mut greatest = used().map(|dot| dot.brdf).fold(0.0, f64::max);
    if let Some(model) = &column.model {
        greatest = used().map(|dot| model(dot.theta_v_deg, dot.phi_v_deg)).fold(greatest, f64::max);
    }
    let mut grids = vec![("measured", measured)];
    let mut hidden = String::new();
    if let Some(model) = &column.model {
        let modelled = Grid::new(NODES, NODES, |i, j| {
            let at = point(i, j);
            let [theta_v, phi_v] = direction_of(at);
            // beyond the rim or the leaf's horizon, for the last cells inside it: the value there
            if theta_v < 95.0 { model(theta_v.min(horizon(model, phi_v)), phi_v) } else { f64::NAN }
        });
        hidden = below_the_horizon(model);
        grids.push(("modelled", modelled));
    }
    let mut sorted = values.clone();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted[sorted.len() / 2];
    let ring: Vec<[f64; 2]> = mesh.hull().iter().map(|corner| place(*corner, [0.0, 0.0])).collect();
    let sides = ring.iter().zip(ring.iter().cycle().skip(1));
    let area: f64 = sides.map(|([x, y], [next_x, next_y])| 0.5 * (x * next_y - next_x * y)).sum();
    // a square pixel: less shows no colour
    let encloses = area.abs() > 1.0;
    Some(Maps { hull: ring_path(&ring), encloses, grids, hidden, greatest, middle })
}

/// A closed line, px.
fn ring_path(ring: &[[f64; 2]]) -> String {
    let mut data = String::new();
    for [x, y] in ring {
        data.push_str(&format!("{}{} {}", if data.is_empty() { 'M' } else { 'L' }, number(*x), number(*y)));
    }
    data.push('Z');
    data
}

/// The largest θ_v at which the model has a value, degrees: 89.9 but for tilted leaves.
fn horizon(model: &dyn Fn(f64, f64) -> f64, phi_v_deg: f64) -> f64 {
    let (mut seen, mut hidden) = (0.0, 89.9);
    if model(hidden, phi_v_deg).is_finite() {
        return hidden;
    }
    for _ in 0..12 {
        let middle = 0.5 * (seen + hidden);
        *(if model(middle, phi_v_deg).is_finite() { &mut seen } else { &mut hidden }) = middle;
    }
    seen
}

/// The part of the disc that a tilted leaf does not see, as a path; nothing for a level one.
fn below_the_horizon(model: &dyn Fn(f64, f64) -> f64) -> String {
    let ends: Vec<(f64, f64)> = (0..180).map(|i| 2.0 * f64::from(i)).map(|phi| (horizon(model, phi), phi)).collect();
    if ends.iter().all(|(theta, _)| *theta == 89.9) {
        return String::new();
    }
    let at = |theta: f64, phi: f64| place(disc(theta, phi), [0.0, 0.0]);
    let inner: Vec<[f64; 2]> =
        ends.iter().map(|&(theta, phi)| at(if theta == 89.9 { 90.0 } else { theta }, phi)).collect();
    rim() + &ring_path(&inner)
}

/// From BRDF to a shade.
struct Scale {
    end: f64,
    square_root: bool,
}

impl Scale {
    /// The BRDF at a part of the scale.
    fn value(&self, part: f64) -> f64 {
        self.end * if self.square_root { part * part } else { part }
    }

    fn part(&self, value: f64) -> f64 {
        let part = value / self.end;
        if self.square_root { part.max(0.0).sqrt() } else { part }
    }

    /// The shade of a value.
    fn shade(&self, value: f64) -> usize {
        let shade = (self.part(value) * SHADES as f64).floor().max(0.0) as usize;
        shade.min(SHADES - 1)
    }

    fn bar(&self, svg: &mut Svg, [left, top]: [f64; 2], height: f64) {
        let width = 20.0;
        for shade in 0..SHADES {
            let from = top + height * (1.0 - (shade + 1) as f64 / SHADES as f64);
            // each shade runs on under the next: no seams
            let below = top + height - from;
            svg.rect([left, from, width, below.min(2.0 * height / SHADES as f64)], &shade_hex(shade), "");
        }
        svg.outline(&format!("M{} {}h{}v{}h-{}Z", number(left), number(top), width, number(height), width), HAIR);
        let ticks: Vec<f64> = if self.square_root {
            [0.0, 0.02, 0.05, 0.1, 0.2, 0.4, 0.6, 0.8, 1.0].map(|part| part * self.end).to_vec()
        } else {
            (0..=5).map(|i| f64::from(i) * self.end / 5.0).collect()
        };
        for tick in &ticks {
            // each with its own decimals, the ticks being uneven
            let mut label = labels(&[*tick]).concat();
            if *tick == self.end {
                label.insert_str(0, "≥ ");
            }
            let y = top + height * (1.0 - self.part(*tick));
            svg.line([left + width, y], [left + width + 5.0, y], HAIR);
            let style = TextStyle { size: SMALL_PX, ..TextStyle::default() };
            svg.text([left + width + 9.0, y + 0.36 * SMALL_PX], &label, style);
        }
        let label = if self.square_root { "BRDF, square-root scale (sr⁻¹)" } else { "BRDF (sr⁻¹)" };
        let style = TextStyle { upwards: true, class: "axis-label", ..TextStyle::middle() };
        svg.text([left - 10.0, top + 0.5 * height], label, style);
    }
}

fn shade_hex(shade: usize) -> String {
    hex((shade as f64 + 0.5) / SHADES as f64)
}

/// The whole disc as a path.
fn rim() -> String {
    super::axes::marker(super::style::Marker::Disc, [0.0, 0.0], RADIUS)
}

fn map(
    svg: &mut Svg,
    centre: [f64; 2],
    column: &Column<'_>,
    (hull, whole, encloses, hidden): (&str, bool, bool, &str),
    grid: &Grid,
    scale: &Scale,
    [first, last]: [bool; 2],
) {
    let step = 2.0 / (NODES - 1) as f64;
    let at = |x: f64, y: f64| place([1.0 - step * x, 1.0 - step * y], [0.0, 0.0]);
    svg.begin_at(centre);
    svg.circle([0.0, 0.0], RADIUS, SKY, None, "sky");
    let rim = rim();
    let domain = if whole { &rim } else { hull };
    svg.begin_clip(domain);
    svg.fill(domain, &shade_hex(0), 1.0);
    for shade in 1..SHADES {
        let level = scale.value(shade as f64 / SHADES as f64);
        svg.fill(&path(&grid.at_least(level, at)), &shade_hex(shade), 1.0);
    }
    if whole {
        svg.fill(hidden, SKY, 1.0);
    }
    svg.end();
    if whole {
        svg.outline(hull, Stroke { colour: "#ffffff", width: 1.0, dash: "2 3" });
    }
    // θ_v = 30°, 60° and the horizon; white over dark shades, ink over pale ones: a thin line of each
    for theta in [30.0, 60.0] {
        let [radius, _] = disc(theta, 0.0);
        svg.circle([0.0, 0.0], radius * RADIUS, "none", Some(Stroke { colour: "#ffffff", width: 0.7, dash: "" }), "");
        let dashed = Stroke { colour: "#3a3d42", width: 0.7, dash: "3 3" };
        svg.circle([0.0, 0.0], radius * RADIUS, "none", Some(dashed), "");
    }
    svg.circle([0.0, 0.0], RADIUS, "none", Some(HAIR), "");
    for dot in &column.dots {
        let at = place(disc(dot.theta_v_deg, dot.phi_v_deg), [0.0, 0.0]);
        if whole || encloses || !dot.brdf.is_finite() {
            direction_dot(svg, at, dot.fitted && dot.brdf.is_finite(), "direction");
        } else {
            let rim = Stroke { colour: "#16181c", width: 0.8, dash: "" };
            svg.circle(at, 5.5, &shade_hex(scale.shade(dot.brdf)), Some(rim), "direction");
        }
    }
    star(svg, place(disc(column.theta_s_deg, 0.0), [0.0, 0.0]));
    svg.end();

    let [x, y] = centre;
    // azimuths at the outer maps of the upper row, where there is room
    for (phi, label, anchor, shown) in [
        (0.0, "φ_v = 0°", Anchor::End, first),
        (90.0, "90°", Anchor::Middle, first || last),
        (180.0, "180°", Anchor::Start, last),
        (270.0, "270°", Anchor::Middle, first || last),
    ] {
        if shown {
            let [dx, dy] = place(disc(90.0, phi), [0.0, 0.0]);
            let (out_x, out_y) = (dx * (1.0 + 5.0 / RADIUS), dy * (1.0 + 11.0 / RADIUS));
            let style = TextStyle { size: SMALL_PX, anchor, ..TextStyle::default() };
            svg.text([x + out_x, y + out_y + 0.36 * SMALL_PX], label, style);
        }
    }
    for (theta, label) in [(30.0, "30°"), (60.0, "60°"), (90.0, "90°")] {
        // along φ_v = 225°, where no lobe is
        let [dx, dy] = place(disc(theta, 315.0), [0.0, 0.0]);
        halo(svg, [x + dx, y + dy + 4.0], label);
    }
}

/// Small text over a map: ink on a pale rim.
fn halo(svg: &mut Svg, [x, y]: [f64; 2], text: &str) {
    let (width, height) = (0.68 * 11.0 * text.chars().count() as f64, 14.0);
    svg.begin("label");
    let data = format!(
        "M{} {}h{}v{}h-{}Z",
        number(x - 0.5 * width),
        number(y - 11.0),
        number(width),
        number(height),
        number(width)
    );
    svg.fill(&data, PAPER, 0.78);
    svg.text([x, y], text, TextStyle { size: 11.0, colour: Some(INK), ..TextStyle::middle() });
    svg.end();
}

/// A direction: filled where it took part, open where it did not.
fn direction_dot(svg: &mut Svg, at: [f64; 2], used: bool, class: &str) {
    let rim = Stroke { colour: "#16181c", width: 0.8, dash: "" };
    if used {
        svg.circle(at, 2.1, "#ffffff", Some(rim), class);
    } else {
        let pale = Stroke { colour: "#ffffff", width: 1.6, dash: "" };
        svg.circle(at, 2.3, "none", Some(pale), "");
        svg.circle(at, 2.3, "none", Some(Stroke { width: 0.7, ..rim }), class);
    }
}

/// The source.
fn star(svg: &mut Svg, [x, y]: [f64; 2]) {
    let mut data = String::new();
    for corner in 0..10 {
        let radius = if corner % 2 == 0 { 10.0 } else { 4.2 };
        let (sin, cos) = (f64::from(corner) * 36.0).to_radians().sin_cos();
        data.push(if corner == 0 { 'M' } else { 'L' });
        data.push_str(&format!("{} {}", number(x + radius * sin), number(y - radius * cos)));
    }
    data.push('Z');
    svg.fill(&data, "#e8590c", 1.0);
    svg.outline(&data, Stroke { colour: "#ffffff", width: 1.4, dash: "" });
}

fn legend(svg: &mut Svg, [x, y]: [f64; 2], note: &str, open: bool) {
    let small = TextStyle { size: SMALL_PX, ..TextStyle::default() };
    star(svg, [x + 8.0, y - 5.0]);
    svg.text([x + 24.0, y], "source", small);
    // on a shade of the maps, as there: on paper, a white disc and a ring look alike
    let ground = |svg: &mut Svg, x: f64| svg.rect([x - 8.0, y - 12.0, 16.0, 14.0], &shade_hex(SHADES / 3), "");
    ground(svg, x + 100.0);
    direction_dot(svg, [x + 100.0, y - 5.0], true, "key");
    svg.text([x + 114.0, y], "direction fitted", small);
    if open {
        ground(svg, x + 250.0);
        direction_dot(svg, [x + 250.0, y - 5.0], false, "key");
        svg.text([x + 264.0, y], "measured, not fitted", small);
    }
    svg.text([x, y + TEXT_PX + 7.0], note, small);
}
