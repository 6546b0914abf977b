//! Diffuse and specular DHRF of each θ_s (Fig. 6), and the share of the reflected light that never entered the leaf (§4.4).

use super::axes::{Axis, Frame, Unit, end_labels};
use super::results::Columns;
use super::spectra::wavelength_axis;
use super::style::{SMALL_PX, Series, series};
use super::svg::{Svg, TextStyle};

/// One θ_s: wavelengths, diffuse and specular DHRF.
struct Source {
    theta_s_deg: f64,
    rows: Vec<[f64; 4]>,
}

/// The table by θ_s, ascending: (nm, diffuse, specular, standard error of the latter).
fn sources(table: &Columns) -> Vec<Source> {
    let columns = ["wavelength_nm", "theta_s_deg", "dhrf_diffuse", "dhrf_specular", "dhrf_specular_se"];
    let [nm, theta_s, diffuse, specular, error] = columns.map(|name| table.numbers(name));
    let mut sources: Vec<Source> = Vec::new();
    for (row, theta) in theta_s.iter().enumerate().filter(|(_, theta)| theta.is_finite()) {
        let one = [nm[row], diffuse[row], specular[row], error[row]];
        match sources.iter_mut().find(|source| source.theta_s_deg == *theta) {
            Some(source) => source.rows.push(one),
            None => sources.push(Source { theta_s_deg: *theta, rows: vec![one] }),
        }
    }
    sources.sort_by(|a, b| a.theta_s_deg.total_cmp(&b.theta_s_deg));
    sources
}

const WIDTH: f64 = 400.0;
const HEIGHT: f64 = 330.0;
const LABELS: f64 = 96.0;

/// Contributions on the left, share on the right.
pub fn dhrf(prefix: &str, title: &str, note: &str, table: &Columns) -> Result<String, String> {
    let sources = sources(table);
    let Some(first) = sources.first().filter(|source| source.rows.len() > 1) else {
        return Err("dhrf.csv has fewer than two wavelengths".to_string());
    };
    if sources.iter().flat_map(|source| &source.rows).all(|row| row[2].is_nan()) {
        return Err("dhrf.csv has no specular part: these facets have no hemispherical integral yet".to_string());
    }
    let nm: Vec<f64> = first.rows.iter().map(|row| row[0]).collect();
    let (left, top) = (88.0, 92.0);
    let second = left + WIDTH + LABELS + 96.0;
    let mut svg = Svg::new(second + WIDTH + LABELS, top + HEIGHT + 92.0, prefix, title, note);
    svg.text([24.0, 34.0], title, TextStyle { size: 18.0, bold: true, ..TextStyle::default() });

    let values = sources.iter().flat_map(|source| &source.rows).flat_map(|row| [row[1], row[2]]).chain([0.0]);
    let frame = Frame {
        left,
        top,
        width: WIDTH,
        height: HEIGHT,
        x: wavelength_axis(&nm),
        y: Axis::around("DHRF", Unit::Unitless, values, 6),
    };
    frame.grid(&mut svg);
    frame.heading(&mut svg, "diffuse and specular part");
    svg.begin_clip(&frame.outline(1.0));
    let mut labels = Vec::new();
    let diffuse = Series { dash: "", ..series(2) };
    // with a bowl the diffuse part depends on θ_s a little; the paper's does not
    frame.line(&mut svg, first.rows.iter().map(|row| [row[0], row[1]]), diffuse.stroke(2.6));
    let end = |values: &dyn Fn(&[f64; 4]) -> f64, source: &Source| source.rows.last().map_or(f64::NAN, values);
    labels.push((frame.at(nm[0], end(&|row| row[1], first))[1], "diffuse".to_string(), diffuse.colour));
    for (place, source) in sources.iter().enumerate() {
        let style = series(place + usize::from(place > 1));
        let band: Vec<[f64; 3]> = source.rows.iter().map(|[nm, _, s, se]| [*nm, s - se, s + se]).collect();
        frame.band(&mut svg, &band, style.colour);
        frame.line(&mut svg, source.rows.iter().map(|row| [row[0], row[2]]), style.stroke(1.8));
        let text = format!("θ_s = {}°", source.theta_s_deg);
        labels.push((frame.at(nm[0], end(&|row| row[2], source))[1], text, style.colour));
    }
    svg.end();
    frame.axes(&mut svg, true, true);
    end_labels(&mut svg, left + WIDTH, labels, [top, top + HEIGHT]);

    let share = |row: &[f64; 4]| 100.0 * row[2] / (row[1] + row[2]);
    let frame = Frame {
        left: second,
        x: frame.x.clone(),
        y: Axis::exact("DHRF_{spec} / DHRF", Unit::Percent, 0.0, 100.0, 5),
        ..frame
    };
    frame.grid(&mut svg);
    frame.heading(&mut svg, "share that never entered the leaf");
    svg.begin_clip(&frame.outline(1.0));
    let mut labels = Vec::new();
    for (place, source) in sources.iter().enumerate() {
        let style = series(place + usize::from(place > 1));
        frame.line(&mut svg, source.rows.iter().map(|row| [row[0], share(row)]), style.stroke(1.8));
        labels.push((
            frame.at(nm[0], end(&|row| share(row), source))[1],
            format!("θ_s = {}°", source.theta_s_deg),
            style.colour,
        ));
    }
    svg.end();
    frame.axes(&mut svg, true, true);
    end_labels(&mut svg, second + WIDTH, labels, [top, top + HEIGHT]);
    svg.text([left, top + HEIGHT + 78.0], note, TextStyle { size: SMALL_PX, ..TextStyle::default() });
    Ok(svg.finish())
}
