//! Which figures a fit has.

use super::hemisphere_map::{Column, Dot, hemisphere_map};
use super::model::{BandModel, directions};
use super::principal_plane::{Cut, OUT_OF_PLANE_DEG, principal_plane};
use super::results::Results;
use super::svg::literal;
use super::valley::{Values, valley};
use super::{PlotError, PlotOptions, dhrf, scatter, spectra};
use crate::measurement::Measurement;

/// One figure.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Its file name without extension.
    pub name: &'static str,
    /// What it shows, for a caption.
    pub caption: String,
    /// The document.
    pub svg: String,
}

/// Figures, and why others are missing.
#[derive(Clone, Debug, Default)]
pub struct Made {
    /// In the order of the paper.
    pub figures: Vec<Figure>,
    /// A sentence for each that is missing, or doubtful.
    pub left_out: Vec<String>,
}

impl Made {
    fn add(&mut self, leaf: &str, name: &'static str, caption: String, svg: Result<String, String>) {
        match svg {
            Ok(svg) => self.figures.push(Figure { name, caption, svg }),
            Err(why) => self.left_out.push(format!("{leaf}: {name} is left out: {why}")),
        }
    }
}

/// Wavelength where chlorophyll absorbs most: the paper's Fig. 2, nm.
const RED_NM: f64 = 680.0;

/// The measured values of one band and source.
fn dots(measurement: &Measurement, nm: f64, theta_s_deg: f64, limit: f64) -> Vec<Dot> {
    let Some(band) = measurement.wavelengths_nm.iter().position(|other| *other == nm) else { return Vec::new() };
    let brdf = measurement.brdf();
    let values = brdf.iter().skip(band * measurement.directions.len()).zip(&measurement.directions);
    let of_source = values.filter(|(_, d)| d.theta_s_deg == theta_s_deg);
    let dot = |(value, d): (&f64, &crate::measurement::Direction)| Dot {
        theta_v_deg: d.theta_v_deg,
        phi_v_deg: d.phi_v_deg,
        brdf: *value,
        fitted: d.theta_v_deg <= limit,
    };
    of_source.map(dot).collect()
}

/// The distinct θ_s, ascending.
fn sources(measurement: &Measurement) -> Vec<f64> {
    let mut sources: Vec<f64> = measurement.directions.iter().map(|d| d.theta_s_deg).collect();
    sources.sort_by(f64::total_cmp);
    sources.dedup();
    sources
}

/// A column of maps of one leaf.
fn column<'a>(
    results: &Results,
    measurement: &Measurement,
    band: usize,
    theta_s_deg: f64,
    heading: String,
) -> Result<Column<'a>, PlotError> {
    let nm = results.bands.as_ref().map_or(f64::NAN, |bands| bands.wavelengths_nm[band]);
    let model: BandModel = results.model_at(band)?;
    Ok(Column {
        heading,
        theta_s_deg,
        dots: dots(measurement, nm, theta_s_deg, results.max_theta_v_deg(measurement)),
        model: Some(Box::new(move |theta_v, phi_v| model.brdf(theta_s_deg, theta_v, phi_v))),
    })
}

const TOO_FEW: &str = "its directions span no part of the hemisphere";

/// Every figure of one leaf.
///
/// # Errors
/// Files that `fit` did not write.
pub fn figures_of_leaf(
    results: &Results,
    measurement: Option<&Measurement>,
    options: &PlotOptions,
) -> Result<Made, PlotError> {
    let mut made = Made::default();
    if let Some(measurement) = measurement.filter(|_| options.wants("hemisphere-wavelengths")) {
        maps(&mut made, results, measurement, options)?;
    }
    let leaf = results.leaf.as_str();
    let shown = literal(leaf);
    if let Some(bands) = results.bands.as_ref().filter(|_| options.wants("parameters")) {
        let title = format!("{shown}: k_L, n and σ against wavelength");
        let note = format!("shaded: ± one standard error; {}", convention(results));
        let caption = "Lambert coefficient, refractive index and roughness, band by band (as Fig. 4)".to_string();
        made.add(leaf, "parameters", caption, spectra::parameters(&format!("{leaf}-parameters"), &title, &note, bands));
    }
    if let Some(measurement) = measurement.filter(|_| options.wants("density")) {
        density(&mut made, results, measurement)?;
    }
    if let Some(table) = results.dhrf.as_ref().filter(|_| options.wants("dhrf")) {
        let title = format!("{shown}: where the reflected light comes from");
        // with a bowl the diffuse part is not k_L alone
        let note = format!("DHRF = diffuse part + DHRF_{{spec}}(θ_s), Eqs 12–14; {}", convention(results));
        let caption =
            "Diffuse and specular DHRF for each source (as Fig. 6), and the share that never entered the leaf";
        made.add(leaf, "dhrf", caption.to_string(), dhrf::dhrf(&format!("{leaf}-dhrf"), &title, &note, table));
    }
    if let Some(table) = &results.spectrum {
        let version = results.summary.get("prospect").and_then(serde_json::Value::as_str).unwrap_or("");
        let title = format!("{shown}: measured spectra and PROSPECT-{version}");
        let caption = format!("Hemispherical reflectance and transmittance with the PROSPECT-{version} fit");
        let svg = spectra::hemispherical(&format!("{leaf}-spectrum"), &title, "difference: measured − modelled", table);
        made.add(leaf, "spectrum", caption, svg);
    }
    if let Some(measurement) = measurement {
        if results.model == "leaf" && options.wants("dhrf-zenith") {
            zenith(&mut made, results, measurement)?;
        }
        if options.wants("principal-plane") || options.wants("valley") {
            cuts(&mut made, results, measurement)?;
        }
    }
    Ok(made)
}

fn convention(results: &Results) -> &'static str {
    match results.normalization() {
        leafbrdf_core::Normalization::Bousquet2005 => "n belongs to K = 2π² (Eq. 10 as printed)",
        leafbrdf_core::Normalization::CookTorrance => "n belongs to K = 4π (as derived)",
    }
}

const MAP_NOTE: &str =
    "equal-area disc: middle θ_v = 0°, rim 90°; measured values are interpolated between the directions";

/// Hemisphere maps over wavelengths and over sources.
fn maps(made: &mut Made, results: &Results, measurement: &Measurement, options: &PlotOptions) -> Result<(), PlotError> {
    let Some(bands) = &results.bands else { return Ok(()) };
    let leaf = results.leaf.as_str();
    let shown = literal(leaf);
    let sources = sources(measurement);
    let widest = sources.last().copied().unwrap_or(0.0);
    let mut chosen: Vec<usize> = options.wavelengths_nm.iter().filter_map(|nm| bands.nearest(*nm)).collect();
    chosen.dedup();
    let columns = chosen
        .iter()
        .map(|&band| column(results, measurement, band, widest, format!("{} nm", bands.wavelengths_nm[band])))
        .collect::<Result<Vec<_>, _>>()?;
    let title = format!("{shown}: BRDF over the hemisphere, θ_s = {widest}°");
    let map = hemisphere_map(&format!("{leaf}-wavelengths"), &title, MAP_NOTE, &columns);
    let caption = format!("BRDF at θ_s = {widest}° for chosen wavelengths, measured and modelled (as Fig. 1)");
    made.add(leaf, "hemisphere-wavelengths", caption, map.ok_or_else(|| TOO_FEW.to_string()));

    let Some(band) = bands.nearest(RED_NM) else { return Ok(()) };
    let nm = bands.wavelengths_nm[band];
    // the paper has four sources; of more, four from the least to the widest
    let some: Vec<f64> = match sources.len() {
        0..=4 => sources,
        count => (0..4).map(|i| sources[i * (count - 1) / 3]).collect(),
    };
    let columns = some
        .iter()
        .map(|&theta_s| column(results, measurement, band, theta_s, format!("θ_s = {theta_s}°")))
        .collect::<Result<Vec<_>, _>>()?;
    let title = format!("{shown}: BRDF over the hemisphere at {nm} nm");
    let map = hemisphere_map(&format!("{leaf}-sources"), &title, MAP_NOTE, &columns);
    let caption = format!("BRDF at {nm} nm for each source, measured and modelled (as Figs 2 and 5)");
    made.add(leaf, "hemisphere-sources", caption, map.ok_or_else(|| TOO_FEW.to_string()));
    Ok(())
}

/// Measured against modelled values of every band that was fitted.
fn density(made: &mut Made, results: &Results, measurement: &Measurement) -> Result<(), PlotError> {
    let Some(bands) = &results.bands else { return Ok(()) };
    let limit = results.max_theta_v_deg(measurement);
    let brdf = measurement.brdf();
    let width = measurement.directions.len();
    let mut pairs = Vec::new();
    for (band, nm) in bands.wavelengths_nm.iter().enumerate() {
        let place = measurement.wavelengths_nm.iter().position(|other| other == nm);
        let (Some(place), Ok(model)) = (place, results.model_at(band)) else { continue };
        for (value, d) in brdf.iter().skip(place * width).zip(&measurement.directions) {
            if d.theta_v_deg <= limit && value.is_finite() {
                pairs.push([model.brdf(d.theta_s_deg, d.theta_v_deg, d.phi_v_deg), *value]);
            }
        }
    }
    let leaf = results.leaf.as_str();
    let stated = results.summary.get("rmse").and_then(serde_json::Value::as_f64);
    let squares: f64 = pairs.iter().map(|[modelled, measured]| (measured - modelled).powi(2)).sum();
    let rmse = (squares / pairs.len() as f64).sqrt();
    // what the drawing leaves out by other rules than the fit is far below a hundredth
    if let Some(stated) = stated.filter(|stated| (rmse - stated).abs() > 0.01 * stated + 1e-9) {
        made.left_out.push(format!(
            "{leaf}: the figures' measurement departs from the fit by {rmse:.3e} sr^-1, the one that was fitted by {stated:.3e}: \
             is it another leaf's, or has it changed?"
        ));
    }
    let title = format!("{}: measured against modelled BRDF", literal(leaf));
    let caption = "Measured against modelled BRDF, all bands and directions fitted (as Fig. 4)".to_string();
    made.add(leaf, "density", caption, scatter::scatter(&format!("{leaf}-density"), &title, &pairs));
    Ok(())
}

/// DHRF(λ, 0°) of the surface model, k_L being each band's own, and PROSPECT's (Fig. 7).
fn zenith(made: &mut Made, results: &Results, measurement: &Measurement) -> Result<(), PlotError> {
    let Some(bands) = &results.bands else { return Ok(()) };
    let limit = results.max_theta_v_deg(measurement);
    let brdf = measurement.brdf();
    let width = measurement.directions.len();
    let seen: Vec<_> = measurement
        .directions
        .iter()
        .map(|d| directions(d.theta_s_deg, d.theta_v_deg, d.phi_v_deg).filter(|_| d.theta_v_deg <= limit))
        .collect();
    let (mut own, mut fitted) = (Vec::new(), Vec::new());
    for (band, nm) in bands.wavelengths_nm.iter().enumerate() {
        let model = results.model_at(band)?;
        let place =
            measurement.wavelengths_nm.iter().position(|other| other == nm).unwrap_or(measurement.wavelengths_nm.len());
        let (mut sum, mut squares) = (0.0, 0.0);
        for (value, seen) in brdf.iter().skip(place * width).zip(&seen) {
            let Some(seen) = seen else { continue };
            let [diffuse, specular] = model.surface.parts(seen);
            if value.is_finite() && diffuse.is_finite() {
                sum += diffuse * (value - specular);
                squares += diffuse * diffuse;
            }
        }
        let surface = model.surface.dhrf_at_zenith();
        own.push(sum / squares + surface);
        fitted.push(model.k_l + surface);
    }
    let leaf = results.leaf.as_str();
    let version = results.summary.get("prospect").and_then(serde_json::Value::as_str).unwrap_or("");
    let title = format!("{}: DHRF at normal incidence and PROSPECT-{version}", literal(leaf));
    let note = "thick: k_L of each band alone + DHRF_{spec}(0°), Eq. 17; difference: surface model − PROSPECT";
    let caption = format!("DHRF(λ, 0°) of the surface model and its PROSPECT-{version} fit (as Fig. 7)");
    let svg = spectra::dhrf_at_zenith(&format!("{leaf}-zenith"), &title, note, &bands.wavelengths_nm, own, fitted);
    made.add(leaf, "dhrf-zenith", caption, svg);
    Ok(())
}

/// Cuts through the plane of incidence and the valley of χ², in the red.
fn cuts(made: &mut Made, results: &Results, measurement: &Measurement) -> Result<(), PlotError> {
    let Some(bands) = &results.bands else { return Ok(()) };
    let Some(band) = bands.nearest(RED_NM) else { return Ok(()) };
    let nm = bands.wavelengths_nm[band];
    let Some(place) = measurement.wavelengths_nm.iter().position(|other| *other == nm) else { return Ok(()) };
    let leaf = results.leaf.as_str();
    let shown = literal(leaf);
    let model = results.model_at(band)?;
    let limit = results.max_theta_v_deg(measurement);

    let cut = |theta_s_deg: f64| Cut {
        theta_s_deg,
        values: dots(measurement, nm, theta_s_deg, limit)
            .into_iter()
            .map(|dot| (dot.theta_v_deg, dot.phi_v_deg, dot.brdf, dot.fitted))
            .collect(),
    };
    let cuts: Vec<Cut> = sources(measurement).into_iter().map(cut).collect();
    let squares: Vec<f64> = cuts
        .iter()
        .flat_map(|cut| cut.values.iter().map(move |value| (cut.theta_s_deg, value)))
        .filter(|(_, (_, _, brdf, fitted))| *fitted && brdf.is_finite())
        .map(|(theta_s, (theta_v, phi_v, brdf, _))| (brdf - model.brdf(theta_s, *theta_v, *phi_v)).powi(2))
        .collect();
    let rmse = (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt();
    let title = format!("{shown}: plane of incidence at {nm} nm");
    let note = format!(
        "values within {OUT_OF_PLANE_DEG}° of the plane; residual: measured − modelled in the value's own direction"
    );
    let caption = format!("Cuts through the plane of incidence at {nm} nm with residuals");
    let svg = principal_plane(&format!("{leaf}-plane"), &title, &note, &cuts, &model, rmse);
    made.add(leaf, "principal-plane", caption, svg);

    let of = |columns: &[Vec<f64>; 3]| [columns[1][band], columns[2][band]];
    let mut errors = of(&bands.errors);
    let mut correlation = None;
    let width = measurement.directions.len();
    let brdf = measurement.brdf();
    let column_of = |place: usize, i: usize| brdf.get(place * width + i).copied().unwrap_or(f64::NAN);
    // One n and σ for the leaf: the mean over the bands has its valley where their sum has it. Its depth is not the fit's,
    // whose residuals are alike in neighbouring bands, so the regions come from the fit's own errors.
    let whole = results.model != "bands";
    let value: Box<dyn Fn(usize) -> f64> = if whole {
        errors = ["n", "sigma"].map(|name| results.number(name, "standard_error").unwrap_or(f64::NAN));
        correlation = Some(results.correlation("n", "sigma").unwrap_or(0.0));
        let places = bands.wavelengths_nm.iter();
        let places: Vec<usize> =
            places.filter_map(|nm| measurement.wavelengths_nm.iter().position(|other| other == nm)).collect();
        Box::new(move |i| places.iter().map(|&place| column_of(place, i)).sum::<f64>() / places.len() as f64)
    } else {
        Box::new(move |i| column_of(place, i))
    };
    let weighted = results.summary.get("weights").and_then(serde_json::Value::as_str) == Some("1/sd^2") && !whole;
    let sd = measurement.brdf_sd().filter(|_| weighted);
    let values =
        measurement.directions.iter().enumerate().filter(|(_, d)| d.theta_v_deg <= limit).filter_map(|(i, d)| {
            let weight = sd.as_ref().map_or(1.0, |sd| 1.0 / (sd[place * width + i] * sd[place * width + i]));
            Values::value([d.theta_s_deg, d.theta_v_deg, d.phi_v_deg], value(i), weight)
        });
    let values =
        Values { values: values.collect(), fitted: of(&bands.values), errors, correlation, shape: results.shape()? };
    let (place, regions) = match whole {
        true => ("of the mean over the bands".to_string(), "; regions from the fit's standard errors and correlation"),
        false => (format!("at {nm} nm"), ""),
    };
    let title = format!("{shown}: χ² over n and σ {place}");
    let note = format!("k_L at its best everywhere; cross: the fit{regions}; {}", convention(results));
    let caption = format!("Valley of χ² over n and σ {place}, and the joint confidence of the two");
    made.add(leaf, "valley", caption, valley(&format!("{leaf}-valley"), &title, &note, &values));
    Ok(())
}

/// Columns of a figure of several leaves, at most.
const LEAVES: usize = 6;

/// Figures of several leaves together.
///
/// # Errors
/// Files that `fit` did not write.
pub fn figures_of_leaves(leaves: &[(&Results, Option<&Measurement>)]) -> Result<Made, PlotError> {
    let mut made = Made::default();
    let with_data: Vec<(&Results, &Measurement)> =
        leaves.iter().filter_map(|(results, measurement)| Some((*results, (*measurement)?))).collect();
    // Fig. 2: θ_s = 21° at 680 nm. Fig. 5: θ_s = 41° where the leaf is darkest.
    let pictures: [(&'static str, f64, bool); 2] = [("leaves-680nm", 21.0, false), ("leaves-darkest", 41.0, true)];
    for (name, wanted, darkest) in pictures {
        let mut columns = Vec::new();
        for (results, measurement) in &with_data {
            let Some(bands) = &results.bands else { continue };
            let band = if darkest { bands.darkest() } else { bands.nearest(RED_NM) };
            let distance = |theta: &f64| (theta - wanted).abs();
            let source = sources(measurement).into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
            let (Some(band), Some(theta_s)) = (band, source) else { continue };
            let mut heading = literal(&results.leaf);
            if darkest || bands.wavelengths_nm[band] != RED_NM {
                heading.push_str(&format!(", {} nm", bands.wavelengths_nm[band]));
            }
            if theta_s != wanted {
                heading.push_str(&format!(", θ_s = {theta_s}°"));
            }
            columns.push(column(results, measurement, band, theta_s, heading)?);
        }
        if columns.len() < 2 {
            continue;
        }
        let many = columns.len() > LEAVES;
        columns.truncate(LEAVES);
        let (title, as_figure) = match darkest {
            true => (format!("BRDF where each leaf is darkest, θ_s = {wanted}°"), "Fig. 5"),
            false => (format!("BRDF at {RED_NM} nm, θ_s = {wanted}°"), "Fig. 2"),
        };
        let caption = format!("Leaves side by side, measured and modelled (as {as_figure})");
        let map = hemisphere_map(name, &title, MAP_NOTE, &columns);
        made.add("all leaves", name, caption, map.ok_or_else(|| TOO_FEW.to_string()));
        if many {
            made.left_out.push(format!("{name}: only the first {LEAVES} leaves are shown"));
        }
    }
    Ok(made)
}
