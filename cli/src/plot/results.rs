//! What `fit` wrote into a leaf's folder, and the measurement behind it.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use leafbrdf_core::Normalization;
use serde_json::Value;

use super::PlotError;
use super::model::{BandModel, Shape};
use crate::measurement::{Measurement, ReadOptions, read_path};

/// A table read by the names of its columns.
#[derive(Clone, Debug, Default)]
pub struct Columns {
    columns: BTreeMap<String, Vec<String>>,
    rows: usize,
}

impl Columns {
    fn read(path: &Path) -> Result<Self, PlotError> {
        let wrong = |error: csv::Error| PlotError(format!("{}: {error}", path.display()));
        let mut reader = csv::Reader::from_path(path).map_err(wrong)?;
        let names: Vec<String> = reader.headers().map_err(wrong)?.iter().map(str::to_string).collect();
        let mut table = Columns::default();
        for record in reader.records() {
            let record = record.map_err(wrong)?;
            for (name, cell) in names.iter().zip(&record) {
                table.columns.entry(name.clone()).or_default().push(cell.to_string());
            }
            table.rows += 1;
        }
        Ok(table)
    }

    /// A column of numbers, NaN where a cell is empty; all NaN where there is no such column.
    pub fn numbers(&self, name: &str) -> Vec<f64> {
        match self.columns.get(name) {
            Some(cells) => cells.iter().map(|cell| cell.parse().unwrap_or(f64::NAN)).collect(),
            None => vec![f64::NAN; self.rows],
        }
    }

    /// Is there such a column?
    pub fn has(&self, name: &str) -> bool {
        self.columns.contains_key(name)
    }
}

/// k_L, n, σ over the wavelengths of a fit.
#[derive(Clone, Debug)]
pub struct Bands {
    /// Wavelengths, nm.
    pub wavelengths_nm: Vec<f64>,
    /// k_L, n, σ; NaN where a band was not fitted.
    pub values: [Vec<f64>; 3],
    /// Their standard errors; NaN where there are none.
    pub errors: [Vec<f64>; 3],
}

impl Bands {
    /// The fitted band that is nearest to a wavelength.
    pub fn nearest(&self, nm: f64) -> Option<usize> {
        let fitted = (0..self.wavelengths_nm.len()).filter(|&band| self.values.iter().all(|v| v[band].is_finite()));
        let distance = |band: usize| (self.wavelengths_nm[band] - nm).abs();
        fitted.min_by(|&a, &b| distance(a).total_cmp(&distance(b)))
    }

    /// The fitted band of least k_L.
    pub fn darkest(&self) -> Option<usize> {
        let fitted = (0..self.wavelengths_nm.len()).filter(|&band| self.values.iter().all(|v| v[band].is_finite()));
        fitted.min_by(|&a, &b| self.values[0][a].total_cmp(&self.values[0][b]))
    }
}

/// One leaf's folder.
#[derive(Clone, Debug)]
pub struct Results {
    /// The folder.
    pub folder: PathBuf,
    /// The leaf's name.
    pub leaf: String,
    /// `bands`, `surface`, `leaf`, `prospect`.
    pub model: String,
    /// `summary.json`.
    pub summary: Value,
    /// `bands.csv`, where the model has bands.
    pub bands: Option<Bands>,
    /// `dhrf.csv`.
    pub dhrf: Option<Columns>,
    /// `spectrum.csv`.
    pub spectrum: Option<Columns>,
}

impl Results {
    /// Reads a leaf's folder.
    ///
    /// # Errors
    /// No `summary.json`, or files that `fit` did not write.
    pub fn read(folder: &Path) -> Result<Self, PlotError> {
        let path = folder.join("summary.json");
        let text = fs::read_to_string(&path).map_err(|error| PlotError(format!("{}: {error}", path.display())))?;
        let summary: Value =
            serde_json::from_str(&text).map_err(|error| PlotError(format!("{}: {error}", path.display())))?;
        let word = |key: &str| summary.get(key).and_then(Value::as_str).map(str::to_string);
        let (Some(leaf), Some(model)) = (word("leaf"), word("model")) else {
            return Err(PlotError(format!("{}: no summary of a fit: leaf or model is missing", path.display())));
        };
        let table = |name: &str| {
            let path = folder.join(name);
            path.is_file().then(|| Columns::read(&path)).transpose()
        };
        let bands = match table("bands.csv")? {
            Some(table) if table.has("k_l") => {
                let columns =
                    |suffix: &str| ["k_l", "n", "sigma"].map(|name| table.numbers(&format!("{name}{suffix}")));
                let wavelengths_nm = table.numbers("wavelength_nm");
                Some(Bands { wavelengths_nm, values: columns(""), errors: columns("_se") })
            }
            _ => None,
        };
        Ok(Results {
            folder: folder.to_path_buf(),
            leaf,
            model,
            bands,
            dhrf: table("dhrf.csv")?,
            spectrum: table("spectrum.csv")?,
            summary,
        })
    }

    /// The convention for K of n and σ.
    pub fn normalization(&self) -> Normalization {
        let name = self.summary.get("normalization").and_then(Value::as_str);
        let conventions = [Normalization::Bousquet2005, Normalization::CookTorrance];
        conventions.into_iter().find(|one| Some(one.name()) == name).unwrap_or_default()
    }

    /// Facets, diffuse term and tilt of the fit.
    ///
    /// # Errors
    /// A model that is not drawn.
    pub fn shape(&self) -> Result<Shape, PlotError> {
        Shape::of_summary(&self.summary).map_err(PlotError)
    }

    /// The model at one band, as fitted.
    ///
    /// # Errors
    /// A model that is not drawn, or parameters outside its domain: not what `fit` wrote.
    pub fn model_at(&self, band: usize) -> Result<BandModel, PlotError> {
        let bands = self.bands.as_ref().ok_or_else(|| PlotError("there is no bands.csv".to_string()))?;
        let [k_l, n, sigma] = [0, 1, 2].map(|p| bands.values[p].get(band).copied().unwrap_or(f64::NAN));
        let surface = self.shape()?.surface(n, sigma);
        Ok(BandModel { k_l, surface: surface.map_err(|error| PlotError(format!("bands.csv: {error}")))? })
    }

    /// A number of a parameter in `summary.json`, such as its `standard_error`.
    pub fn number(&self, parameter: &str, what: &str) -> Option<f64> {
        self.summary.get("parameters")?.get(parameter)?.get(what)?.as_f64()
    }

    /// The correlation of two parameters, where `summary.json` has it.
    pub fn correlation(&self, one: &str, other: &str) -> Option<f64> {
        self.summary.get("correlations")?.get(format!("{one},{other}"))?.as_f64()
    }

    /// The greatest θ_v that took part in the fit, degrees: as many directions lie above it as were left out.
    pub fn max_theta_v_deg(&self, measurement: &Measurement) -> f64 {
        let directions = self.summary.get("directions");
        let left_out = directions.and_then(|directions| directions.get("left_out_beyond_max_theta_v"));
        let Some(left_out) = left_out.and_then(Value::as_u64) else { return 70.0 };
        let mut angles: Vec<f64> = measurement.directions.iter().map(|d| d.theta_v_deg).collect();
        angles.sort_by(f64::total_cmp);
        let last = angles.len().saturating_sub(1 + left_out as usize);
        angles.get(last).copied().unwrap_or(70.0)
    }

    /// The measurement that was fitted: `asked` for, or where `summary.json` says (as it stands there, else beside it).
    ///
    /// # Errors
    /// It cannot be found, read, or does not hold this leaf; the sentence says what to do.
    pub fn measurement(&self, asked: Option<&Path>, options: &ReadOptions) -> Result<Measurement, PlotError> {
        let remedy = "say where it is with --measurement FILE";
        let named = self.summary.get("file").and_then(Value::as_str).unwrap_or("-");
        let path = match asked {
            Some(path) => path.to_path_buf(),
            None if named == "-" => {
                return Err(PlotError(format!("the measurement came from standard input: {remedy}")));
            }
            None => {
                let beside = Path::new(named).file_name().map(|name| self.folder.join(name));
                let places = [Some(PathBuf::from(named)), Some(self.folder.join(named)), beside];
                let found = places.into_iter().flatten().find(|path| path.is_file());
                found.ok_or_else(|| PlotError(format!("the measurement {named} is not there: {remedy}")))?
            }
        };
        let leaves = read_path(&path, options).map_err(|error| PlotError(error.to_string()))?;
        let count = leaves.len();
        let mut all = leaves.into_iter();
        let alone = if count == 1 && asked.is_some() { all.next() } else { all.find(|leaf| leaf.name == self.leaf) };
        alone.ok_or_else(|| PlotError(format!("{}: no leaf {} among its {count}: {remedy}", path.display(), self.leaf)))
    }
}
