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

use rayon::prelude::*;

use crate::measurement::{Measurement, ReadOptions};
use crate::output::AtomicFile;

/// Text with sub- and superscripts, for pages that hold figures.
pub(crate) mod text {
    pub(crate) use super::svg::{escaped, html, literal, plain};

    /// A figure with nothing on it.
    #[cfg(test)]
    pub(crate) fn blank(prefix: &str, title: &str) -> String {
        super::svg::Svg::new(10.0, 10.0, prefix, title, "nothing").finish()
    }
}

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
    /// Names of the figures that are drawn; all without any.
    pub only: Vec<&'static str>,
}

impl PlotOptions {
    /// Green, red and near-infrared, as in the paper's Fig. 1, nm.
    pub const WAVELENGTHS_NM: [f64; 3] = [550.0, 670.0, 780.0];

    /// Is a figure of this name asked for?
    fn wants(&self, name: &str) -> bool {
        self.only.is_empty() || self.only.contains(&name)
    }

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
            only: Vec::new(),
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

/// Figures of a fit's folder.
#[derive(Clone, Debug, Default)]
pub struct Drawn {
    /// Each leaf's name and figures, in the order of [`leaf_folders`].
    pub leaves: Vec<(String, Vec<Figure>)>,
    /// Figures of several leaves together.
    pub together: Vec<Figure>,
    /// Figures that are missing, and why.
    pub left_out: Vec<String>,
}

/// Draws every figure of a fit's folder.
///
/// # Errors
/// There is no fit in the folder, or its files are not what `fit` writes.
pub fn draw(folder: &Path, options: &PlotOptions) -> Result<Drawn, PlotError> {
    let leaves = leaf_folders(folder)?;
    let one = |place: &PathBuf| -> Result<(Results, Option<Measurement>, Made), PlotError> {
        let results = Results::read(place)?;
        let mut measurement = None;
        let mut missing = None;
        if results.model != "prospect" {
            match results.measurement(options.measurement.as_deref(), &options.read) {
                Ok(found) => measurement = Some(found),
                Err(why) => {
                    missing = Some(format!("{}: maps, density, cuts and valley are left out: {why}", results.leaf));
                }
            }
        }
        let mut made = figures_of_leaf(&results, measurement.as_ref(), options)?;
        made.left_out.extend(missing);
        Ok((results, measurement, made))
    };
    let made = leaves.par_iter().map(one).collect::<Result<Vec<_>, _>>()?;
    let mut drawn = Drawn::default();
    if made.len() > 1 && options.only.is_empty() {
        let pairs: Vec<(&Results, Option<&Measurement>)> = made.iter().map(|(r, m, _)| (r, m.as_ref())).collect();
        let together = figures_of_leaves(&pairs)?;
        drawn.together = together.figures;
        drawn.left_out = together.left_out;
    }
    for (results, _, one) in made {
        drawn.left_out.extend(one.left_out);
        drawn.leaves.push((results.leaf, one.figures));
    }
    Ok(drawn)
}

impl Drawn {
    /// Writes the figures into `figures` of each leaf's folder, and, of several leaves, of the folder itself.
    ///
    /// # Errors
    /// The system's, and PNG in a build without it.
    pub fn write(&self, folder: &Path, kinds: &[Kind]) -> Result<Vec<PathBuf>, PlotError> {
        let mut files = Vec::new();
        for (place, (_, figures)) in leaf_folders(folder)?.iter().zip(&self.leaves) {
            write_all(&place.join(FIGURES), figures, kinds, &mut files)?;
        }
        write_all(&folder.join(FIGURES), &self.together, kinds, &mut files)?;
        Ok(files)
    }
}

/// Draws and writes every figure of a fit's folder.
///
/// # Errors
/// Those of [`draw`] and [`Drawn::write`].
pub fn plot(folder: &Path, options: &PlotOptions) -> Result<Plotted, PlotError> {
    let drawn = draw(folder, options)?;
    Ok(Plotted { files: drawn.write(folder, &options.kinds)?, left_out: drawn.left_out })
}

fn write_all(folder: &Path, figures: &[Figure], kinds: &[Kind], files: &mut Vec<PathBuf>) -> Result<(), PlotError> {
    if figures.is_empty() {
        return Ok(());
    }
    let wrong = |path: &Path, error: &io::Error| PlotError(format!("{}: cannot be written: {error}", path.display()));
    fs::create_dir_all(folder).map_err(|error| wrong(folder, &error))?;
    let all: Vec<(&Figure, Kind)> =
        figures.iter().flat_map(|figure| kinds.iter().map(move |kind| (figure, *kind))).collect();
    let written = all.par_iter().map(|(figure, kind)| {
        let path = folder.join(format!("{}.{}", figure.name, kind.extension()));
        let bytes = kind.render(&figure.svg)?;
        let write = || {
            let mut file = AtomicFile::create(&path)?;
            file.write_all(&bytes)?;
            file.commit()
        };
        write().map_err(|error| wrong(&path, &error))?;
        Ok(path)
    });
    files.extend(written.collect::<Result<Vec<_>, PlotError>>()?);
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
