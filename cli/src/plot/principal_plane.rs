//! Cuts through the plane of incidence: measured values, the model, and their difference, one panel a source.

use super::axes::{Axis, Frame, Unit};
use super::model::BandModel;
use super::style::{HAIR, SMALL_PX, TEXT_PX, series};
use super::svg::{Stroke, Svg, TextStyle};

/// Directions nearer to the plane than this belong to the cut, degrees.
pub const OUT_OF_PLANE_DEG: f64 = 3.0;

/// One source: θ_s and measured (θ_v, φ_v, BRDF, fitted).
pub struct Cut {
    /// θ_s, degrees.
    pub theta_s_deg: f64,
    /// θ_v and φ_v in degrees, BRDF in sr⁻¹, and whether the value took part in the fit.
    pub values: Vec<(f64, f64, f64, bool)>,
}

/// Signed θ_v (forward is positive) of a direction in the plane, or nothing.
fn in_plane(theta_v_deg: f64, phi_v_deg: f64) -> Option<f64> {
    let (sin_phi, cos_phi) = phi_v_deg.to_radians().sin_cos();
    let out = (theta_v_deg.to_radians().sin() * sin_phi.abs()).asin().to_degrees();
    (out <= OUT_OF_PLANE_DEG).then_some(if cos_phi > 0.0 { -theta_v_deg } else { theta_v_deg })
}

const WIDTH: f64 = 380.0;
const HEIGHT: f64 = 190.0;
const LOW: f64 = 74.0;

/// `error`: RMSE of the band, sr⁻¹, the grey band behind the residuals.
pub fn principal_plane(
    prefix: &str,
    title: &str,
    note: &str,
    cuts: &[Cut],
    model: &BandModel,
    error: f64,
) -> Result<String, String> {
    let panels: Vec<(&Cut, Vec<[f64; 4]>)> = cuts
        .iter()
        .map(|cut| {
            let rows = cut.values.iter().filter_map(|(theta_v, phi_v, brdf, fitted)| {
                let angle = in_plane(*theta_v, *phi_v)?;
                let modelled = model.brdf(cut.theta_s_deg, *theta_v, *phi_v);
                brdf.is_finite().then_some([angle, *brdf, modelled, f64::from(u8::from(*fitted))])
            });
            (cut, rows.collect::<Vec<_>>())
        })
        .filter(|(_, rows)| rows.len() >= 3)
        .take(6)
        .collect();
    if panels.is_empty() {
        return Err(format!("no source has three directions within {OUT_OF_PLANE_DEG}° of the plane of incidence"));
    }
    let columns = panels.len().min(2);
    let rows = panels.len().div_ceil(columns);
    let (left, top, pitch_x, pitch_y) = (96.0, 92.0, WIDTH + 92.0, HEIGHT + LOW + 118.0);
    let width = left + pitch_x * (columns - 1) as f64 + WIDTH + 36.0;
    let bottom = top + pitch_y * (rows - 1) as f64 + HEIGHT + 14.0 + LOW;
    let difference = |v: &[f64; 4]| v[1] - v[2];
    let reach = |values: &[[f64; 4]]| {
        let seen = values.iter().filter(|v| v[3] > 0.0).map(difference);
        super::axes::round_up(seen.fold(1.05 * error, |most, residual| most.max(1.05 * residual.abs())))
    };
    // only values that were not fitted can lie there
    let beyond = panels.iter().any(|(_, values)| values.iter().any(|v| difference(v).abs() > reach(values)));
    let height = bottom + if beyond { 134.0 } else { 116.0 };
    let mut svg = Svg::new(width.max(720.0), height, prefix, title, note);
    svg.text([24.0, 34.0], title, TextStyle { size: 18.0, bold: true, ..TextStyle::default() });
    let (curve, points) = (series(1), series(0));
    for (place, (cut, values)) in panels.iter().enumerate() {
        let (column, row) = (place % columns, place / columns);
        let mut x = Axis::exact("viewing angle θ_v, forward side positive", Unit::Degrees, -90.0, 90.0, 6);
        x.ticks = vec![-60.0, -30.0, 0.0, 30.0, 60.0];
        let line: Vec<[f64; 2]> = (-356..=356)
            .map(|quarter| {
                let angle = f64::from(quarter) / 4.0;
                let phi = if angle < 0.0 { 0.0 } else { 180.0 };
                [angle, model.brdf(cut.theta_s_deg, angle.abs(), phi)]
            })
            .collect();
        let limit = values.iter().filter(|v| v[3] > 0.0).map(|v| v[0].abs()).fold(0.0, f64::max).max(30.0);
        let seen = line.iter().filter(|[angle, _]| angle.abs() <= limit).map(|[_, brdf]| *brdf);
        let y = Axis::around("BRDF", Unit::PerSr, seen.chain(values.iter().map(|v| v[1])).chain([0.0]), 4);
        let (frame_left, frame_top) = (left + pitch_x * column as f64, top + pitch_y * row as f64);
        let frame = Frame { left: frame_left, top: frame_top, width: WIDTH, height: HEIGHT, x: x.clone(), y };
        frame.grid(&mut svg);
        frame.heading(&mut svg, &format!("θ_s = {}°", cut.theta_s_deg));
        svg.begin_clip(&frame.outline(4.0));
        svg.begin_clip(&frame.outline(0.0));
        frame.line(&mut svg, line, curve.stroke(1.8));
        svg.end();
        source_mark(&mut svg, &frame, cut.theta_s_deg);
        marks(&mut svg, &frame, values, |v| v[1]);
        svg.end();
        frame.axes(&mut svg, false, false);

        let reach = reach(values);
        let mut y = Axis::exact("residual", Unit::PerSr, -reach, reach, 2);
        y.ticks = vec![-reach, 0.0, reach];
        let below = Frame { left: frame_left, top: frame_top + HEIGHT + 14.0, width: WIDTH, height: LOW, x, y };
        below.grid(&mut svg);
        svg.begin_clip(&below.outline(0.0));
        below.band(&mut svg, &[[-90.0, -error, error], [90.0, -error, error]], "#7a7f87");
        below.line(&mut svg, [[-90.0, 0.0], [90.0, 0.0]], HAIR);
        svg.end();
        // the largest residual stands at the edge: its disc is not cut
        svg.begin_clip(&below.outline(4.0));
        let inside: Vec<[f64; 4]> = values.iter().filter(|v| difference(v).abs() <= reach).copied().collect();
        marks(&mut svg, &below, &inside, difference);
        svg.end();
        below.axes(&mut svg, true, false);
        if column == 0 {
            for (frame, size) in [(&frame, TEXT_PX), (&below, SMALL_PX)] {
                let style = TextStyle { class: "axis-label", upwards: true, size, ..TextStyle::middle() };
                svg.text([30.0, frame.top + 0.5 * frame.height], &frame.y.label, style);
            }
        }
    }
    let y = bottom + 76.0;
    svg.fill(&super::axes::marker(points.marker, [left + 8.0, y - 5.0], 4.0), points.colour, 1.0);
    svg.text([left + 20.0, y], "measured (open: not fitted)", TextStyle { size: SMALL_PX, ..TextStyle::default() });
    svg.line([left + 240.0, y - 5.0], [left + 280.0, y - 5.0], curve.stroke(1.8));
    svg.text([left + 288.0, y], "model", TextStyle { size: SMALL_PX, ..TextStyle::default() });
    svg.fill(&format!("M{} {}h36v12h-36Z", left + 356.0, y - 11.0), "#7a7f87", 0.25);
    svg.text([left + 400.0, y], "± RMSE", TextStyle { size: SMALL_PX, ..TextStyle::default() });
    if beyond {
        let style = TextStyle { size: SMALL_PX, ..TextStyle::default() };
        svg.text([left, y + 42.0], "open residuals beyond the axis are left out", style);
    }
    svg.text([left, y + 24.0], note, TextStyle { size: SMALL_PX, ..TextStyle::default() });
    Ok(svg.finish())
}

/// Where the light comes from, at the foot of the frame.
fn source_mark(svg: &mut Svg, frame: &Frame, theta_s_deg: f64) {
    let [x, y] = frame.at(-theta_s_deg, frame.y.from);
    svg.line([x, y], [x, frame.top], Stroke { colour: "#e8590c", width: 1.0, dash: "2 4" });
    let style = TextStyle { size: 12.0, colour: Some("#b34700"), ..TextStyle::end() };
    svg.text([x - 5.0, frame.top + 14.0], "source", style);
}

/// Fitted values as filled discs, others open.
fn marks(svg: &mut Svg, frame: &Frame, values: &[[f64; 4]], of: impl Fn(&[f64; 4]) -> f64) {
    for value in values {
        let at = frame.at(value[0], of(value));
        let rim = Stroke { colour: series(0).colour, width: 1.3, dash: "" };
        let fill = if value[3] > 0.0 { series(0).colour } else { "#ffffff" };
        svg.circle(at, 3.6, fill, Some(rim), "");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forward_is_positive_and_what_is_out_of_the_plane_is_left_out() {
        assert_eq!(in_plane(30.0, 180.0), Some(30.0));
        assert_eq!(in_plane(30.0, 0.0), Some(-30.0));
        assert_eq!(in_plane(30.0, 360.0), Some(-30.0));
        assert_eq!(in_plane(2.0, 91.0), Some(2.0), "near the zenith every azimuth is in the plane");
        assert_eq!(in_plane(30.0, 90.0), None);
        assert_eq!(in_plane(60.0, 176.0), None, "3.5 degrees aside");
    }
}
