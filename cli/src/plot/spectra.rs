//! What depends on wavelength: k_L, n, σ with error bands (Fig. 4), and hemispherical spectra with PROSPECT's.

use super::axes::{Axis, Frame, Unit};
use super::results::{Bands, Columns};
use super::style::{INK, Marker, SMALL_PX, Series, series};
use super::svg::{Stroke, Svg, TextStyle};

/// The panels from above: quantity and series.
const PANELS: [(&str, usize); 3] = [("k_L", 2), ("n", 0), ("σ", 1)];

/// k_L, n and σ of every band, each with a band of ± one standard error.
pub fn parameters(prefix: &str, title: &str, note: &str, bands: &Bands) -> Result<String, String> {
    if bands.wavelengths_nm.len() < 2 {
        return Err("one band makes no line over wavelength".to_string());
    }
    let (left, width, height, pitch, top) = (100.0, 640.0, 158.0, 182.0, 70.0);
    let bottom = top + 2.0 * pitch + height;
    let mut svg = Svg::new(left + width + 40.0, bottom + 84.0, prefix, title, note);
    svg.text([24.0, 34.0], title, TextStyle { size: 18.0, bold: true, ..TextStyle::default() });
    for (p, (quantity, style)) in PANELS.into_iter().enumerate() {
        let rows: Vec<[f64; 3]> = bands
            .wavelengths_nm
            .iter()
            .zip(&bands.values[p])
            .zip(&bands.errors[p])
            .map(|((nm, value), error)| [*nm, value - error, value + error])
            .collect();
        let mut seen: Vec<f64> = bands.values[p].clone();
        // bands without an error, or with a wild one, do not stretch the axis
        let typical = spread(&bands.values[p]).max(median(&bands.errors[p]));
        let near = |value: &&f64| bands.values[p].iter().any(|other| (*value - other).abs() < 4.0 * typical);
        seen.extend(rows.iter().flat_map(|[_, low, high]| [low, high]).filter(near));
        let frame = Frame {
            left,
            top: top + pitch * p as f64,
            width,
            height,
            x: wavelength_axis(&bands.wavelengths_nm),
            y: Axis::around(quantity, Unit::Unitless, seen, 4),
        };
        let style = series(style);
        frame.grid(&mut svg);
        svg.begin_clip(&frame.outline(0.0));
        frame.band(&mut svg, &rows, style.colour);
        let line = bands.wavelengths_nm.iter().zip(&bands.values[p]).map(|(nm, value)| [*nm, *value]);
        frame.line(&mut svg, line, Series { dash: "", ..style }.stroke(1.8));
        svg.end();
        frame.axes(&mut svg, p == 2, false);
        // the three labels in one column, whatever the width of their ticks
        let style = TextStyle { class: "axis-label", upwards: true, ..TextStyle::middle() };
        svg.text([30.0, frame.top + 0.5 * height], &frame.y.label, style);
    }
    svg.text([left, bottom + 70.0], note, TextStyle { size: SMALL_PX, ..TextStyle::default() });
    Ok(svg.finish())
}

/// The axis of wavelengths, from the first to the last.
pub fn wavelength_axis(wavelengths_nm: &[f64]) -> Axis {
    let first = wavelengths_nm.iter().copied().fold(f64::INFINITY, f64::min);
    let last = wavelengths_nm.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    Axis::exact("wavelength λ", Unit::Nm, first, last.max(first + 1.0), 8)
}

fn median(values: &[f64]) -> f64 {
    let mut finite: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    finite.sort_by(f64::total_cmp);
    finite.get(finite.len() / 2).copied().unwrap_or(0.0)
}

/// Half of the distance between the quarters.
fn spread(values: &[f64]) -> f64 {
    let mut finite: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    finite.sort_by(f64::total_cmp);
    let at = |part: usize| finite.get(part * (finite.len().max(1) - 1) / 4).copied().unwrap_or(0.0);
    0.5 * (at(3) - at(1))
}

/// One line of a spectrum figure.
struct Line<'a> {
    name: &'a str,
    measured: Vec<f64>,
    modelled: Vec<f64>,
    series: Series,
}

/// Reflectance and transmittance, measured and PROSPECT's, with residuals below: `spectrum.csv`.
pub fn hemispherical(prefix: &str, title: &str, note: &str, spectrum: &Columns) -> Result<String, String> {
    let nm = spectrum.numbers("wavelength_nm");
    let line = |name, of: &str, place| {
        let measured = spectrum.numbers(of);
        let modelled = spectrum.numbers(&format!("{of}_modelled"));
        Line { name, measured, modelled, series: series(place) }
    };
    let mut lines = vec![line("reflectance", "reflectance", 0), line("transmittance", "transmittance", 1)];
    lines.retain(|line| line.measured.iter().any(|value| value.is_finite()));
    if lines.is_empty() || nm.len() < 2 {
        return Err("spectrum.csv holds no spectrum".to_string());
    }
    Ok(fitted(prefix, title, note, &nm, &lines))
}

/// DHRF(λ, 0°) of the surface model and PROSPECT's reflectance (Fig. 7), with the difference below.
pub fn dhrf_at_zenith(
    prefix: &str,
    title: &str,
    note: &str,
    nm: &[f64],
    dhrf: Vec<f64>,
    prospect: Vec<f64>,
) -> Result<String, String> {
    if nm.len() < 2 {
        return Err("one band makes no spectrum".to_string());
    }
    if dhrf.iter().all(|value| value.is_nan()) {
        return Err("no band has a DHRF".to_string());
    }
    let line = Line { name: "DHRF(λ, 0°)", measured: dhrf, modelled: prospect, series: series(0) };
    Ok(fitted(prefix, title, note, nm, &[line]))
}

/// A wide line, paler than the series' own, so that a dashed line on top of it is seen.
fn wide(series: Series) -> Stroke<'static> {
    let colour = if series.marker == Marker::Disc { "#7db9e0" } else { "#e9a57e" };
    Stroke { colour, width: 4.0, dash: "" }
}

fn fitted(prefix: &str, title: &str, note: &str, nm: &[f64], lines: &[Line<'_>]) -> String {
    let (left, width, top, height, low) = (100.0, 660.0, 70.0, 330.0, 96.0);
    let bottom = top + height + 26.0 + low;
    let mut svg = Svg::new(left + width + 40.0, bottom + 110.0, prefix, title, note);
    svg.text([24.0, 34.0], title, TextStyle { size: 18.0, bold: true, ..TextStyle::default() });
    let all = lines.iter().flat_map(|line| line.measured.iter().chain(&line.modelled)).copied();
    let x = wavelength_axis(nm);
    let quantity = if lines.len() > 1 { "reflectance, transmittance" } else { lines[0].name };
    let frame = Frame {
        left,
        top,
        width,
        height,
        x: x.clone(),
        y: Axis::around(quantity, Unit::Unitless, all.chain([0.0]), 6),
    };
    let residual =
        |line: &Line<'_>| -> Vec<f64> { line.measured.iter().zip(&line.modelled).map(|(a, b)| a - b).collect() };
    let residuals: Vec<Vec<f64>> = lines.iter().map(residual).collect();
    let y = Axis::around("difference", Unit::Unitless, residuals.iter().flatten().copied().chain([0.0]), 3);
    let below = Frame { left, top: top + height + 26.0, width, height: low, x, y };
    frame.grid(&mut svg);
    below.grid(&mut svg);
    svg.begin_clip(&frame.outline(1.0));
    let points = |values: &[f64]| -> Vec<[f64; 2]> { nm.iter().zip(values).map(|(nm, v)| [*nm, *v]).collect() };
    for line in lines {
        frame.line(&mut svg, points(&line.measured), wide(line.series));
        let dashed = Series { colour: INK, dash: "7 5", marker: Marker::Disc };
        frame.line(&mut svg, points(&line.modelled), dashed.stroke(1.5));
    }
    svg.end();
    svg.begin_clip(&below.outline(1.0));
    below.line(&mut svg, [[below.x.from, 0.0], [below.x.to, 0.0]], super::style::HAIR);
    for (line, residuals) in lines.iter().zip(&residuals) {
        below.line(&mut svg, points(residuals), line.series.stroke(1.6));
    }
    svg.end();
    frame.axes(&mut svg, false, false);
    below.axes(&mut svg, true, false);
    for (frame, size) in [(&frame, super::style::TEXT_PX), (&below, SMALL_PX)] {
        let style = TextStyle { class: "axis-label", upwards: true, size, ..TextStyle::middle() };
        svg.text([30.0, frame.top + 0.5 * frame.height], &frame.y.label, style);
    }
    let y = bottom + 72.0;
    let mut x = left;
    for line in lines {
        svg.line([x, y - 5.0], [x + 34.0, y - 5.0], wide(line.series));
        let text = if lines.len() > 1 { format!("{}, measured", line.name) } else { "surface model".to_string() };
        svg.text([x + 42.0, y], &text, TextStyle { size: SMALL_PX, ..TextStyle::default() });
        x += 70.0 + 8.2 * text.chars().count() as f64;
    }
    let dashed = Stroke { colour: INK, width: 1.5, dash: "7 5" };
    svg.line([x, y - 5.0], [x + 34.0, y - 5.0], dashed);
    svg.text([x + 42.0, y], "PROSPECT", TextStyle { size: SMALL_PX, ..TextStyle::default() });
    svg.text([left, y + 24.0], note, TextStyle { size: SMALL_PX, ..TextStyle::default() });
    svg.finish()
}
