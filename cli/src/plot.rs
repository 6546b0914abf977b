//! Figures of a fit, as SVG and PNG: those of the paper, and what it would have shown with more room.
//!
//! | room | figure |
//! |---|---|
//! | `hemisphere_map` | BRDF over the hemisphere, measured and modelled (Figs 1, 2, 5) |
//! | `spectra` | k_L, n, σ against wavelength with error bands (Fig. 4); reflectance and transmittance with PROSPECT's |
//! | `scatter` | measured against modelled BRDF, as a density (Fig. 4) |
//! | `dhrf` | diffuse and specular DHRF for each θ_s (Fig. 6), and the share that never entered the leaf (§4.4) |
//! | `principal_plane` | cuts through the plane of incidence, with residuals |
//! | `valley` | χ² over n and σ |
//! | `model` | the fitted model at any direction |
//! | `results` | what `fit` wrote, read back |
//! | `svg`, `axes`, `style`, `colour`, `contour`, `png` | the tools |
//!
//! The same files give the same bytes. Every series differs from the others in dashes or marker as well as in colour, every map
//! in lightness, every axis has its unit.

mod axes;
mod colour;
mod contour;
mod dhrf;
mod figures;
mod hemisphere_map;
mod model;
#[cfg(feature = "png")]
mod png;
mod principal_plane;
mod results;
mod scatter;
mod spectra;
mod style;
mod svg;
mod valley;

use std::fmt;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

pub use colour::scale as colour_scale;
pub use figures::{Figure, Made, figures_of_leaf, figures_of_leaves};
pub use results::Results;

use crate::measurement::{Measurement, ReadOptions};
use crate::output::AtomicFile;

/// Folder of the figures inside a leaf's folder.
pub const FIGURES: &str = "figures";

/// Why there are no figures, in the words that the user reads.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlotError(
    /// The sentence.
    pub String,
);

impl fmt::Display for PlotError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for PlotError {}

/// Kind of file that a figure is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Lines and text: for journals and the web.
    Svg,
    /// Pixels, twice as many as the SVG's size says.
    Png,
}

/// What to draw.
#[derive(Clone, Debug)]
pub struct PlotOptions {
    /// Wavelengths of the maps, nm; the nearest that were fitted are taken.
    pub wavelengths_nm: Vec<f64>,
    /// Kinds of files.
    pub kinds: Vec<Kind>,
    /// The measurement, where `summary.json` does not lead to it.
    pub measurement: Option<PathBuf>,
    /// How to read it.
    pub read: ReadOptions,
}

impl PlotOptions {
    /// Green, red and near-infrared, as in the paper's Fig. 1, nm.
    pub const WAVELENGTHS_NM: [f64; 3] = [550.0, 670.0, 780.0];

    /// The kinds that this build can write.
    pub fn all_kinds() -> Vec<Kind> {
        if cfg!(feature = "png") { vec![Kind::Svg, Kind::Png] } else { vec![Kind::Svg] }
    }
}

impl Default for PlotOptions {
    fn default() -> Self {
        PlotOptions {
            wavelengths_nm: Self::WAVELENGTHS_NM.to_vec(),
            kinds: Self::all_kinds(),
            measurement: None,
            read: ReadOptions::default(),
        }
    }
}

/// What came of it.
#[derive(Clone, Debug, Default)]
pub struct Plotted {
    /// Files written.
    pub files: Vec<PathBuf>,
    /// Figures that are missing, and why.
    pub left_out: Vec<String>,
}

/// The folders of leaves in a fit's folder: itself, or those inside it.
///
/// # Errors
/// There is no fit.
pub fn leaf_folders(folder: &Path) -> Result<Vec<PathBuf>, PlotError> {
    let is_leaf = |folder: &Path| folder.join("summary.json").is_file();
    if is_leaf(folder) {
        return Ok(vec![folder.to_path_buf()]);
    }
    let entries = fs::read_dir(folder).map_err(|error| PlotError(format!("{}: {error}", folder.display())))?;
    let mut leaves: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).filter(|path| is_leaf(path)).collect();
    leaves.sort();
    if leaves.is_empty() {
        return Err(PlotError(format!(
            "{}: no fit is here: expected summary.json in it or in folders inside it, as written by `leafbrdf fit … -o {}`",
            folder.display(),
            folder.display()
        )));
    }
    Ok(leaves)
}

/// Draws every figure of a fit's folder: into `figures` of each leaf's folder, and, for several leaves, of the folder itself.
///
/// # Errors
/// There is no fit in the folder, its files are not what `fit` writes, or the figures cannot be written.
pub fn plot(folder: &Path, options: &PlotOptions) -> Result<Plotted, PlotError> {
    let folders = leaf_folders(folder)?;
    let mut plotted = Plotted::default();
    let mut leaves = Vec::new();
    for place in &folders {
        let results = Results::read(place)?;
        let measurement = if results.model == "prospect" {
            None
        } else {
            match results.measurement(options.measurement.as_deref(), &options.read) {
                Ok(measurement) => Some(measurement),
                Err(why) => {
                    let sentence = format!("{}: maps, density, cuts and valley are left out: {why}", results.leaf);
                    plotted.left_out.push(sentence);
                    None
                }
            }
        };
        let made = figures_of_leaf(&results, measurement.as_ref(), options)?;
        write_all(&place.join(FIGURES), &made, options, &mut plotted)?;
        leaves.push((results, measurement));
    }
    if leaves.len() > 1 {
        let pairs: Vec<(&Results, Option<&Measurement>)> = leaves.iter().map(|(r, m)| (r, m.as_ref())).collect();
        let made = figures_of_leaves(&pairs)?;
        write_all(&folder.join(FIGURES), &made, options, &mut plotted)?;
    }
    Ok(plotted)
}

fn write_all(folder: &Path, made: &Made, options: &PlotOptions, plotted: &mut Plotted) -> Result<(), PlotError> {
    plotted.left_out.extend(made.left_out.iter().cloned());
    if made.figures.is_empty() {
        return Ok(());
    }
    let wrong = |path: &Path, error: &io::Error| PlotError(format!("{}: cannot be written: {error}", path.display()));
    fs::create_dir_all(folder).map_err(|error| wrong(folder, &error))?;
    for figure in &made.figures {
        for kind in &options.kinds {
            let path = folder.join(format!("{}.{}", figure.name, kind.extension()));
            let bytes = kind.render(&figure.svg)?;
            let write = || {
                let mut file = AtomicFile::create(&path)?;
                file.write_all(&bytes)?;
                file.commit()
            };
            write().map_err(|error| wrong(&path, &error))?;
            plotted.files.push(path);
        }
    }
    Ok(())
}

impl Kind {
    fn extension(self) -> &'static str {
        match self {
            Kind::Svg => "svg",
            Kind::Png => "png",
        }
    }

    /// The bytes of a file of this kind.
    ///
    /// # Errors
    /// PNG in a build without the feature `png`.
    pub fn render(self, svg: &str) -> Result<Vec<u8>, PlotError> {
        match self {
            Kind::Svg => Ok(svg.as_bytes().to_vec()),
            #[cfg(feature = "png")]
            Kind::Png => png::render(svg),
            #[cfg(not(feature = "png"))]
            Kind::Png => Err(PlotError("PNG needs a build with the feature png; SVG is there: --svg".to_string())),
        }
    }
}
