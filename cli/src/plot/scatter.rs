//! Measured against modelled BRDF: how many values lie where (Fig. 4).

use super::axes::{Axis, Frame, Unit};
use super::colour::hex;
use super::style::{HAIR, INK, SMALL_PX};
use super::svg::{Stroke, Svg, TextStyle, number};

const SIDE: f64 = 480.0;
/// Cells along each side.
const CELLS: usize = 120;
/// Shades, each √2 times as many values as the last or more.
const SHADES: usize = 10;

/// `pairs`: modelled and measured BRDF, sr⁻¹; those that are no numbers are left out.
pub fn scatter(prefix: &str, title: &str, pairs: &[[f64; 2]]) -> Result<String, String> {
    let pairs: Vec<[f64; 2]> = pairs.iter().copied().filter(|[x, y]| x.is_finite() && y.is_finite()).collect();
    if pairs.len() < 2 {
        return Err("there are no values to compare".to_string());
    }
    let all = || pairs.iter().flatten().copied();
    let whole = Axis::around("", Unit::PerSr, all().chain([0.0]), 25);
    let axis = |quantity: &str| Axis::exact(quantity, Unit::PerSr, whole.from, whole.to, 6);
    let frame =
        Frame { left: 96.0, top: 70.0, width: SIDE, height: SIDE, x: axis("modelled BRDF"), y: axis("measured BRDF") };
    let mut counts = vec![0_u32; CELLS * CELLS];
    for [x, y] in &pairs {
        let cell = |part: f64| ((part * CELLS as f64) as usize).min(CELLS - 1);
        counts[cell(frame.y.part(*y)) * CELLS + cell(frame.x.part(*x))] += 1;
    }
    let most = f64::from(counts.iter().copied().max().unwrap_or(1)).max(2.0);
    let shade = |count: u32| ((f64::from(count).ln() / most.ln()) * SHADES as f64).min(SHADES as f64 - 1.0) as usize;
    let colour = |shade: usize| hex(0.86 - 0.86 * shade as f64 / (SHADES as f64 - 1.0));

    let mut svg = Svg::new(96.0 + SIDE + 130.0, 70.0 + SIDE + 64.0, prefix, title, "density of values");
    svg.text([24.0, 34.0], title, TextStyle { size: 18.0, bold: true, ..TextStyle::default() });
    frame.grid(&mut svg);
    let size = SIDE / CELLS as f64;
    for level in 0..SHADES {
        let mut data = String::new();
        for (cell, count) in counts.iter().enumerate().filter(|(_, count)| **count > 0 && shade(**count) == level) {
            let _ = count;
            let (row, column) = (cell / CELLS, cell % CELLS);
            let (x, y) = (frame.left + size * column as f64, frame.top + SIDE - size * (row + 1) as f64);
            data.push_str(&format!("M{} {}h{size}v{size}h-{size}z", number(x), number(y)));
        }
        svg.fill(&data, &colour(level), 1.0);
    }
    let [least, end] = [frame.x.from, frame.x.to];
    frame.line(&mut svg, [[least, least], [end, end]], Stroke { colour: INK, width: 1.2, dash: "6 4" });
    frame.axes(&mut svg, true, true);

    let count = pairs.len() as f64;
    let mean = pairs.iter().map(|[_, y]| y).sum::<f64>() / count;
    let squares: f64 = pairs.iter().map(|[x, y]| (y - x).powi(2)).sum();
    let spread: f64 = pairs.iter().map(|[_, y]| (y - mean).powi(2)).sum();
    let bias = pairs.iter().map(|[x, y]| y - x).sum::<f64>() / count;
    let rmse = (squares / count).sqrt();
    let exponent = |value: f64| format!("{value:.2e}").replace('-', "−");
    let words = [
        format!("{} values", pairs.len()),
        format!("RMSE {} sr⁻¹", exponent(rmse)),
        if bias.abs() < 1e-3 * rmse {
            "bias below RMSE/1000".into()
        } else {
            format!("bias {} sr⁻¹", exponent(bias))
        },
        format!("R² {:.4}", 1.0 - squares / spread),
    ];
    for (line, text) in words.iter().enumerate() {
        let at = [frame.left + 16.0, frame.top + 26.0 + 20.0 * line as f64];
        svg.text(at, text, TextStyle { size: SMALL_PX, ..TextStyle::default() });
    }
    // along the line, outside the corner
    svg.text([frame.left + SIDE - 8.0, frame.top - 8.0], "1:1", TextStyle { size: SMALL_PX, ..TextStyle::end() });

    let (x, top, height) = (96.0 + SIDE + 44.0, 70.0 + 60.0, SIDE - 120.0);
    for level in 0..SHADES {
        let step = height / SHADES as f64;
        svg.rect([x, top + height - step * (level + 1) as f64, 18.0, step + 0.5], &colour(level), "");
    }
    svg.outline(&format!("M{x} {top}h18v{height}h-18Z"), HAIR);
    let mut decade = 1.0;
    while decade <= most {
        let y = top + height * (1.0 - f64::ln(decade) / most.ln());
        svg.line([x + 18.0, y], [x + 23.0, y], HAIR);
        let style = TextStyle { size: SMALL_PX, ..TextStyle::default() };
        svg.text([x + 27.0, y + 0.36 * SMALL_PX], &format!("{decade}"), style);
        decade *= 10.0;
    }
    let style = TextStyle { upwards: true, class: "axis-label", ..TextStyle::middle() };
    svg.text([x - 10.0, top + 0.5 * height], "values in a cell, logarithmic (count)", style);
    Ok(svg.finish())
}
