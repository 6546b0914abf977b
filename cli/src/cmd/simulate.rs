//! `leafbrdf simulate`: a measurement file of a leaf that is known.

use std::io::{self, Write};
use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, ValueEnum};
use leafbrdf::measurement::{
    Azimuth, Direction, Layout, Metadata, Quantity, WriteOptions, read_directions, write_path,
};
use leafbrdf::simulate::{
    AnyDiffuse, AnySurface, CoupledLeaf, FacetKind, Instrument, LeafModel, Noise, PresetLeaf, SimulationError,
    paper_directions, presets, write_truth,
};
use leafbrdf_core::{Normalization, P1};
use leafbrdf_prospect::{Coupling, LeafParams, Parameter};

use super::list::List;
use super::version::VersionName;
use super::{Failure, NormalizationName};

/// Simulate the measurement of a leaf with known parameters (Eq. 18)
///
/// A preset (n and sigma of Table 4 over an interior of ours), or any leaf: what is given replaces the preset's value. Without
/// other directions, the paper's campaign: θ_s 8, 21, 41, 60°; 98 views each, 65 of them with θ_v ≤ 70°; 480 to 879 nm.
/// All parameters are written into the header of the file. The same command gives the same bytes.
#[derive(Args)]
#[command(after_help = "Examples:
  leafbrdf simulate --leaf beech --seed 1 -o beech.csv
  leafbrdf simulate --leaf laurel --geometry my-leaf.csv --tilt 2,-1 --wavelengths 400:2500:10
  leafbrdf simulate --n 1.48 --sigma 0.3 --facets ggx --diffuse p1 --n-struct 1.5 --cab 40 --car 8 --cw 0.012 --cm 0.006")]
pub struct Arguments {
    /// Preset that gives every parameter not given otherwise
    #[arg(long, value_name = "LEAF", ignore_case = true)]
    leaf: Option<PresetName>,
    /// Refractive index n of the surface, ≥ 1
    #[arg(
        long,
        value_name = "N",
        required_unless_present = "leaf",
        allow_negative_numbers = true,
        help_heading = "Surface"
    )]
    n: Option<f64>,
    /// Roughness σ of the surface, > 0
    #[arg(
        long,
        value_name = "SIGMA",
        required_unless_present = "leaf",
        allow_negative_numbers = true,
        help_heading = "Surface"
    )]
    sigma: Option<f64>,
    /// Facets and masking
    #[arg(long, value_enum, default_value = "beckmann", help_heading = "Surface")]
    facets: FacetKind,
    /// Constant K of the specular term [default: bousquet2005, for ggx cook-torrance]
    #[arg(long, value_enum, help_heading = "Surface")]
    normalization: Option<NormalizationName>,
    /// Diffuse term: k_L/π, or with a bowl
    #[arg(long, value_enum, default_value = "lambert", help_heading = "Interior")]
    diffuse: DiffuseName,
    /// Depth of the bowl and its lean away from the source, both −1 to 1, for --diffuse p1 [default: 0.15,0]
    #[arg(long, value_name = "A,B", allow_hyphen_values = true, help_heading = "Interior")]
    p1: Option<Pair>,
    /// N, number of plates, 1 to 10
    #[arg(
        long,
        value_name = "N",
        required_unless_present = "leaf",
        allow_negative_numbers = true,
        help_heading = "Interior"
    )]
    n_struct: Option<f64>,
    /// C_ab, chlorophylls a + b, µg cm⁻²
    #[arg(long, value_name = "CAB", allow_negative_numbers = true, help_heading = "Interior")]
    cab: Option<f64>,
    /// C_car, carotenoids, µg cm⁻²
    #[arg(long, value_name = "CAR", allow_negative_numbers = true, help_heading = "Interior")]
    car: Option<f64>,
    /// C_ant, anthocyanins, µg cm⁻² (D, PRO)
    #[arg(long, value_name = "CANT", allow_negative_numbers = true, help_heading = "Interior")]
    cant: Option<f64>,
    /// C_brown, brown pigments, arbitrary units
    #[arg(long, value_name = "CBROWN", allow_negative_numbers = true, help_heading = "Interior")]
    cbrown: Option<f64>,
    /// C_w, equivalent water thickness, cm
    #[arg(long, value_name = "CW", allow_negative_numbers = true, help_heading = "Interior")]
    cw: Option<f64>,
    /// C_m, dry matter, g cm⁻²
    #[arg(long, value_name = "CM", allow_negative_numbers = true, help_heading = "Interior")]
    cm: Option<f64>,
    /// C_prot, proteins, g cm⁻² (PRO)
    #[arg(long, value_name = "PROT", allow_negative_numbers = true, help_heading = "Interior")]
    prot: Option<f64>,
    /// C_cbc, carbon-based constituents other than proteins, g cm⁻² (PRO)
    #[arg(long, value_name = "CBC", allow_negative_numbers = true, help_heading = "Interior")]
    cbc: Option<f64>,
    /// Version of PROSPECT
    #[arg(long, value_enum, ignore_case = true, default_value = "D", help_heading = "Interior")]
    prospect: VersionName,
    /// From PROSPECT's reflectance to k_L
    #[arg(long, value_enum, default_value = "bousquet", help_heading = "Interior")]
    coupling: CouplingName,
    /// Gain g, for --coupling gain-offset [default: 1]
    #[arg(long, value_name = "G", allow_negative_numbers = true, help_heading = "Interior")]
    gain: Option<f64>,
    /// Offset b of k_L, for --coupling offset and gain-offset [default: 0]
    #[arg(long, value_name = "B", allow_negative_numbers = true, help_heading = "Interior")]
    offset: Option<f64>,
    /// Directions of a CSV file with the columns theta_s_deg, theta_v_deg, phi_v_deg, or of a measurement file; - is standard
    /// input [default: the paper's]
    #[arg(long, value_name = "FILE", conflicts_with_all = ["theta_s", "theta_v", "phi_v"], help_heading = "Measurement")]
    geometry: Option<PathBuf>,
    /// Illumination zenith angles in degrees; all combinations of the three lists
    #[arg(long, value_name = "LIST", requires_all = ["theta_v", "phi_v"], help_heading = "Measurement")]
    theta_s: Option<List>,
    /// Viewing zenith angles in degrees
    #[arg(long, value_name = "LIST", requires_all = ["theta_s", "phi_v"], help_heading = "Measurement")]
    theta_v: Option<List>,
    /// Viewing azimuths in degrees; 180 is the forward, specular side
    #[arg(long, value_name = "LIST", requires_all = ["theta_s", "theta_v"], allow_hyphen_values = true,
          help_heading = "Measurement")]
    phi_v: Option<List>,
    /// Wavelengths in nm, rising, 400 to 2500
    #[arg(long, value_name = "LIST", default_value = "480:879:1", help_heading = "Measurement")]
    wavelengths: List,
    /// Tilt of the sample in degrees: towards the source, and across towards φ_v = 90°; the reference panel stays level
    #[arg(
        long,
        value_name = "IN_PLANE,LATERAL",
        default_value = "0,0",
        allow_hyphen_values = true,
        help_heading = "Measurement"
    )]
    tilt: Pair,
    /// Lose signal beyond this θ_v in degrees, in proportion to cosθ_v: the viewed area outgrows the lit one (§2.3)
    #[arg(long, value_name = "DEG", num_args = 0..=1, default_missing_value = "70", help_heading = "Measurement")]
    loss_beyond: Option<f64>,
    /// Standard deviation of the noise as a share of the value [default: 0, or 0.01 with --seed alone]
    #[arg(long, value_name = "SHARE", allow_negative_numbers = true, help_heading = "Noise")]
    noise_relative: Option<f64>,
    /// Standard deviation of the noise that does not depend on the value, sr⁻¹ [default: 0, or 0.003 with --seed alone]
    #[arg(long, value_name = "SR-1", allow_negative_numbers = true, help_heading = "Noise")]
    noise_absolute: Option<f64>,
    /// Seed of the noise; without it and without a size of noise there is none [default: 2005]
    #[arg(long, value_name = "SEED", help_heading = "Noise")]
    seed: Option<u64>,
    /// Write the standard deviation of the noise beside each value, in the long layout
    #[arg(long, help_heading = "Noise")]
    with_sd: bool,
    /// Name of the leaf [default: the preset's, or leaf]
    #[arg(long, value_name = "NAME", help_heading = "File")]
    name: Option<String>,
    /// Layout of the file: one column a direction, or one row a value
    #[arg(long, value_enum, help_heading = "File")]
    layout: Option<Layout>,
    /// Quantity of the file: BRDF in sr⁻¹, or BRF = π·BRDF
    #[arg(long, value_enum, default_value = "brdf", help_heading = "File")]
    quantity: Quantity,
    /// Azimuth convention of the file
    #[arg(long, value_enum, default_value = "forward_180", help_heading = "File")]
    azimuth: Azimuth,
    /// File for the true k_L, n and sigma of every wavelength
    #[arg(long, value_name = "FILE", help_heading = "File")]
    truth: Option<PathBuf>,
    /// File to write, whole or not at all, compressed where its name ends in .gz; - is standard output
    #[arg(short, long, value_name = "FILE", default_value = "-", help_heading = "File")]
    output: PathBuf,
}

/// A leaf of the paper.
#[derive(Clone, Copy, ValueEnum)]
enum PresetName {
    /// n 1.22, sigma 0.078 (Table 4): a narrow peak
    Laurel,
    /// n 1.56, sigma 0.29: a wide one
    Beech,
    /// n 1.68, sigma 0.46: hairs
    Hazel,
}

impl PresetName {
    fn leaf(self) -> PresetLeaf {
        let [laurel, beech, hazel] = presets();
        match self {
            PresetName::Laurel => laurel,
            PresetName::Beech => beech,
            PresetName::Hazel => hazel,
        }
    }
}

#[derive(Clone, Copy, ValueEnum)]
enum DiffuseName {
    /// The same in all directions (Eq. 4)
    Lambert,
    /// First reciprocal polynomials: darker towards the normal
    P1,
}

#[derive(Clone, Copy, ValueEnum)]
enum CouplingName {
    /// k_L = R − DHRF_spec(n, sigma, 0°) (Eq. 17)
    Bousquet,
    /// k_L = R less PROSPECT's first-surface reflection
    Prospecular,
    /// k_L = R + b
    Offset,
    /// k_L = g · (R less first-surface reflection) + b
    GainOffset,
}

/// Two numbers between a comma.
#[derive(Clone, Copy)]
struct Pair([f64; 2]);

impl FromStr for Pair {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |part: &str| part.trim().parse::<f64>().ok().filter(|number| number.is_finite());
        let pair = text.split_once(',').and_then(|(first, second)| Some(Pair([number(first)?, number(second)?])));
        pair.ok_or_else(|| format!("{text:?}: expected two numbers with a comma between them, such as 2,-1"))
    }
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let usage = |error: SimulationError| Failure::Usage(error.to_string());
    let preset = arguments.leaf.map(PresetName::leaf);
    let model = model(arguments, preset.as_ref())?;
    let List(wavelengths_nm) = &arguments.wavelengths;
    if !wavelengths_nm.is_sorted_by(|a, b| a < b) {
        return Err(Failure::Usage("--wavelengths: expected rising wavelengths, each once".to_string()));
    }
    let hint = wavelengths_nm.first().map_or("", |nm| super::micrometres(*nm));
    let leaf = model.at(wavelengths_nm).map_err(|error| Failure::Usage(format!("{error}{hint}")))?;

    let instrument = instrument(arguments)?;
    let (mut noise, seed) = noise(arguments)?;
    let name = arguments.name.clone().or_else(|| Some(preset?.name.to_string())).unwrap_or_else(|| "leaf".to_string());
    let mut metadata = Metadata::new();
    if let Some(preset) = preset {
        metadata.push("species", preset.species);
    }
    metadata.push("source", format!("simulated by leafbrdf {}, not measured", env!("CARGO_PKG_VERSION")));
    model.describe(&mut metadata);
    instrument.describe(&mut metadata);
    noise.describe(seed, &mut metadata);

    let measured = instrument.measure(&leaf, &name, metadata, &mut noise).map_err(usage)?;
    warn(&leaf, measured.counts().missing);
    if let Some(path) = &arguments.truth {
        write_truth(path, &leaf).map_err(|error| Failure::writing(Some(path), &error))?;
    }
    let form =
        WriteOptions { layout: arguments.layout, quantity: Some(arguments.quantity), azimuth: Some(arguments.azimuth) };
    Ok(write_path(&arguments.output, &[measured], &form)?)
}

/// What the user should know; where standard error is closed, the file is written all the same.
fn warn(leaf: &CoupledLeaf, missing: usize) {
    let mut errors = io::stderr().lock();
    let negative = leaf.negative();
    if negative > 0 {
        let _ = writeln!(
            errors,
            "warning: k_L is negative at {negative} of {} wavelengths: this surface reflects more than PROSPECT's whole leaf",
            leaf.k_lambert.len()
        );
    }
    if missing > 0 {
        let _ = writeln!(errors, "{missing} values are missing: the tilt puts their views below the leaf's horizon");
    }
}

fn model(arguments: &Arguments, preset: Option<&PresetLeaf>) -> Result<LeafModel, Failure> {
    let usage = |error: SimulationError| Failure::Usage(error.to_string());
    let normalization = arguments.normalization.map_or(arguments.facets.usual_normalization(), Normalization::from);
    // clap asks for n, sigma and n_struct where there is no preset
    let or_preset = |given: Option<f64>, of: fn(&PresetLeaf) -> f64| given.or(preset.map(of)).unwrap_or(f64::NAN);
    let (n, sigma) = (or_preset(arguments.n, |leaf| leaf.n), or_preset(arguments.sigma, |leaf| leaf.sigma));
    let surface = AnySurface::new(arguments.facets, n, sigma, normalization).map_err(|error| usage(error.into()))?;

    let given = [
        arguments.n_struct,
        arguments.cab,
        arguments.car,
        arguments.cant,
        arguments.cbrown,
        arguments.cw,
        arguments.cm,
        arguments.prot,
        arguments.cbc,
    ];
    let mut interior = preset.map_or(LeafParams::with_n_struct(f64::NAN), |leaf| leaf.interior);
    for (parameter, value) in Parameter::ALL.into_iter().zip(given) {
        interior.set(parameter, value.unwrap_or(interior.get(parameter)));
    }
    super::warn_of_milligrams(interior.cab);
    let diffuse = match arguments.diffuse {
        DiffuseName::Lambert if arguments.p1.is_some() => {
            return Err(Failure::Usage("--p1 is no part of --diffuse lambert: add --diffuse p1".to_string()));
        }
        DiffuseName::Lambert => AnyDiffuse::Lambert,
        DiffuseName::P1 => {
            let Pair([a, b]) = arguments.p1.unwrap_or(Pair([0.15, 0.0]));
            AnyDiffuse::P1(P1::new(a, b).map_err(|error| Failure::Usage(format!("--p1: {error}")))?)
        }
    };
    let coupling = match arguments.coupling {
        CouplingName::Bousquet => Coupling::Bousquet,
        CouplingName::Prospecular => Coupling::Prospecular,
        CouplingName::Offset => Coupling::Offset,
        CouplingName::GainOffset => Coupling::GainOffset,
    };
    let unused = |flag: &str| Failure::Usage(format!("{flag} is no part of --coupling {}", coupling.name()));
    if arguments.gain.is_some() && coupling != Coupling::GainOffset {
        return Err(unused("--gain"));
    }
    if arguments.offset.is_some() && !matches!(coupling, Coupling::Offset | Coupling::GainOffset) {
        return Err(unused("--offset"));
    }
    let (gain, offset) = (arguments.gain.unwrap_or(1.0), arguments.offset.unwrap_or(0.0));
    if !(gain > 0.0 && gain.is_finite() && offset.is_finite()) {
        return Err(Failure::Usage("--gain, --offset: expected a gain above 0 and a finite offset".to_string()));
    }
    Ok(LeafModel { surface, diffuse, version: arguments.prospect.0, interior, coupling, gain, offset })
}

fn instrument(arguments: &Arguments) -> Result<Instrument, Failure> {
    let directions = match (&arguments.geometry, &arguments.theta_s, &arguments.theta_v, &arguments.phi_v) {
        (Some(path), ..) => read_directions(path)?,
        (None, Some(List(sources)), Some(List(zeniths)), Some(List(azimuths))) => sources
            .iter()
            .flat_map(|s| zeniths.iter().flat_map(move |v| azimuths.iter().map(move |phi| (*s, *v, *phi))))
            .map(|(theta_s_deg, theta_v_deg, phi_v_deg)| Direction { theta_s_deg, theta_v_deg, phi_v_deg })
            .collect(),
        _ => paper_directions(),
    };
    if let Some(limit) = arguments.loss_beyond
        && !(limit > 0.0 && limit < 90.0)
    {
        return Err(Failure::Usage(format!("--loss-beyond {limit}: expected an angle between 0 and 90 degrees")));
    }
    let Pair(tilt_deg) = arguments.tilt;
    Ok(Instrument { directions, tilt_deg, loss_beyond_deg: arguments.loss_beyond, with_sd: arguments.with_sd })
}

/// The noise and its seed: of the paper's size where there is only a seed.
fn noise(arguments: &Arguments) -> Result<(Noise, u64), Failure> {
    let (relative, absolute) = match (arguments.noise_relative, arguments.noise_absolute, arguments.seed) {
        (None, None, Some(_)) => (Noise::RELATIVE, Noise::ABSOLUTE),
        (relative, absolute, _) => (relative.unwrap_or(0.0), absolute.unwrap_or(0.0)),
    };
    if !(relative >= 0.0 && absolute >= 0.0 && relative.is_finite() && absolute.is_finite()) {
        return Err(Failure::Usage("--noise-relative, --noise-absolute: expected standard deviations ≥ 0".to_string()));
    }
    let seed = arguments.seed.unwrap_or(leafbrdf::demo::SEED);
    Ok((Noise::new(relative, absolute, seed), seed))
}
