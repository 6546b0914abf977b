//! `leafbrdf fit --model surface`, and the options that every model of a whole leaf's surface shares.

use std::str::FromStr;

use clap::{Args, ValueEnum};
use indicatif::ProgressBar;
use leafbrdf::fit::fit_surface;
use leafbrdf::measurement::Measurement;
use leafbrdf_core::Normalization;
use leafbrdf_fit::Interval;
use leafbrdf_fit::leaf::{self, parameters};
use leafbrdf_fit::surface::model::{DIFFUSE_E, N, PARAMETERS, SIGMA, TILT_IN_PLANE, TILT_LATERAL};
use leafbrdf_fit::surface::{DiffuseKind, NAMES, Prior, SurfaceOptions, Treatment};

use super::super::Failure;
use super::leaves::{self, Model};
use super::{Arguments, Range};

/// The distribution of facets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Facets {
    /// Beckmann facets, V-cavity masking: the paper's (Eqs 7, 9)
    Beckmann,
    /// GGX facets, Smith's masking: a lobe with a tail. K = 4π unless --normalization says otherwise
    Ggx,
}

/// The shape of the diffuse term.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Diffuse {
    /// k_L/π in every direction: the paper's (Eq. 4)
    Lambert,
    /// A bowl a and an asymmetry b: k_L/π (1 − a cosθ_s cosθ_v − b sinθ_s sinθ_v cosφ_v)/(1 − 2a/3)
    P1,
    /// The same, and e for the angle through which the light turned: − e cos²2θ_a, over 1 − 2a/3 − e/2
    P2,
}

/// The surface's options that the models of a whole leaf share.
#[derive(Args, Debug)]
#[group(id = "surface_options")]
#[command(next_help_heading = "Options of --model surface (and of models that contain it)")]
pub struct Options {
    /// Distribution of facets [default: beckmann]
    #[arg(long, value_enum)]
    facets: Option<Facets>,
    /// Shape of the diffuse term [default: lambert]
    #[arg(long, value_enum)]
    diffuse: Option<Diffuse>,
    /// The leaf may be tilted in its holder: two angles more, each N(0°, 3°) and within ±10° [default: level]
    #[arg(long)]
    tilt: bool,
    /// Parameters of the surface that are held: n, sigma, p1_a, p1_b, p2_e, tilt_in_plane_deg, tilt_lateral_deg
    #[arg(long, value_name = "NAME=VALUE,…", value_delimiter = ',', allow_hyphen_values = true)]
    hold: Vec<Hold>,
    /// What is known beforehand, as a mean and a standard deviation, or NAME=none [default: p1_a=0.15:0.1, p1_b=0:0.1, p2_e=0.1:0.03,
    /// tilt_in_plane_deg=0:3, tilt_lateral_deg=0:3]. With --model leaf also n_struct, cab, car, cant, cbrown, cw, cm, prot, cbc, gain and
    /// offset, in the units of the columns (cab=40:20), which replaces the method's prior and frees a parameter that the method
    /// holds; and for those NAME=MEDIAN:SD:ln, where ln(x/MEDIAN) has this SD (cab=40:0.5:ln: within a factor of 1.65 two times in three)
    #[arg(long, value_name = "NAME=MEAN:SD[:ln],…", value_delimiter = ',', allow_hyphen_values = true)]
    prior: Vec<PriorOf>,
}

/// NAME=VALUE.
#[derive(Clone, Copy, Debug)]
struct Hold(usize, f64);

/// NAME=MEAN:SD, NAME=MEDIAN:SD:ln or NAME=none: the place is that of a leaf's list, which begins with the surface's.
#[derive(Clone, Copy, Debug)]
struct PriorOf(usize, Option<leaf::Prior>);

fn named<'a>(text: &'a str, names: &[&str]) -> Result<(usize, &'a str), String> {
    let (name, value) = text.split_once('=').ok_or_else(|| format!("{text:?}: expected NAME=…, such as n=1.45"))?;
    let place = names.iter().position(|known| *known == name.trim());
    let place = place.ok_or_else(|| format!("{name:?} is no parameter: expected one of {}", names.join(", ")))?;
    Ok((place, value.trim()))
}

/// By what to multiply a number of the command line: angles are in degrees there.
fn unit(place: usize) -> f64 {
    if place == TILT_IN_PLANE || place == TILT_LATERAL { 1.0_f64.to_radians() } else { 1.0 }
}

impl FromStr for Hold {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (place, value) = named(text, &parameters::NAMES)?;
        if place >= PARAMETERS {
            return Err(format!(
                "{text:?}: --hold is for the surface; --fix holds a parameter of the interior, --gain and --offset those"
            ));
        }
        match value.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(Hold(place, value * unit(place))),
            _ => Err(format!("{text:?}: expected NAME=VALUE, such as n=1.45")),
        }
    }
}

impl FromStr for PriorOf {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (place, value) = named(text, &parameters::NAMES)?;
        if value == "none" {
            return Ok(PriorOf(place, None));
        }
        let wrong = || format!("{text:?}: expected NAME=MEAN:SD with SD > 0, such as n=1.48:0.03, or NAME=none");
        let parts: Vec<&str> = value.split(':').map(str::trim).collect();
        let (centre, sd, log) = match parts[..] {
            [centre, sd] => (centre, sd, false),
            [centre, sd, "ln"] => (centre, sd, true),
            _ => return Err(wrong()),
        };
        let (Ok(centre), Ok(sd)) = (centre.parse::<f64>(), sd.parse::<f64>()) else { return Err(wrong()) };
        if !(centre.is_finite() && sd > 0.0 && sd.is_finite()) {
            return Err(wrong());
        }
        if log && place < PARAMETERS {
            let name = NAMES[place];
            return Err(format!(
                "{text:?}: the surface's parameters have no logarithmic priors: expected {name}=MEAN:SD"
            ));
        }
        if log && centre <= 0.0 {
            return Err(format!("{text:?}: expected a MEDIAN > 0, for it is ln(x/MEDIAN) that has this SD"));
        }
        let prior =
            if log { leaf::Prior::log(centre, sd) } else { leaf::Prior::plain(centre * unit(place), sd * unit(place)) };
        Ok(PriorOf(place, Some(prior)))
    }
}

impl Options {
    /// For models without these options: none of them must be there.
    pub fn refuse(&self, model: &str) -> Result<(), Failure> {
        let given = [
            ("--facets", self.facets.is_some()),
            ("--diffuse", self.diffuse.is_some()),
            ("--tilt", self.tilt),
            ("--hold", !self.hold.is_empty()),
            ("--prior", !self.prior.is_empty()),
        ];
        match given.iter().find(|(_, given)| *given) {
            Some((option, _)) => {
                Err(Failure::Usage(format!("{option} has no meaning for --model {model}: try --model surface")))
            }
            None => Ok(()),
        }
    }

    /// Each parameter once, and none both held and with a prior: the one would silently win over the other.
    fn check_once(&self) -> Result<(), Failure> {
        let name = |place: usize| parameters::NAMES.get(place).copied().unwrap_or_default();
        for (at, Hold(place, _)) in self.hold.iter().enumerate() {
            if self.hold.iter().take(at).any(|other| other.0 == *place) {
                return Err(Failure::Usage(format!("--hold {} stands twice", name(*place))));
            }
        }
        for (at, PriorOf(place, _)) in self.prior.iter().enumerate() {
            if self.prior.iter().take(at).any(|other| other.0 == *place) {
                return Err(Failure::Usage(format!("--prior {} stands twice", name(*place))));
            }
            if self.hold.iter().any(|hold| hold.0 == *place) {
                let name = name(*place);
                return Err(Failure::Usage(format!(
                    "{name} is held and has a prior: leave it out of --hold or of --prior"
                )));
            }
        }
        Ok(())
    }

    /// What --prior says of a leaf's interior, gain and offset: places in its list, and priors in the units of its columns.
    pub fn interior_priors(&self) -> Vec<(usize, Option<leaf::Prior>)> {
        let inside = self.prior.iter().filter(|prior| prior.0 >= PARAMETERS);
        inside.map(|PriorOf(place, prior)| (*place, *prior)).collect()
    }

    /// Does --hold or --prior speak of this parameter of the surface?
    pub fn speaks_of(&self, place: usize) -> bool {
        self.hold.iter().any(|hold| hold.0 == place) || self.prior.iter().any(|prior| prior.0 == place)
    }

    /// The surface as asked for, over `preset` (what the model takes where nothing is said).
    pub fn surface(&self, arguments: &Arguments, preset: SurfaceOptions) -> Result<SurfaceOptions, Failure> {
        let mut options = preset;
        match self.facets {
            Some(Facets::Ggx) => options = options.with_ggx(),
            Some(Facets::Beckmann) => options = options.with_beckmann(),
            None => {}
        }
        match self.diffuse {
            Some(Diffuse::P1) => options = options.with_p1(),
            Some(Diffuse::P2) => options = options.with_p2(),
            Some(Diffuse::Lambert) => options = options.with_lambert(),
            None => {}
        }
        if self.tilt {
            options = options.with_tilt();
        }
        if let Some(name) = arguments.normalization {
            options.normalization = Normalization::from(name);
        }
        for (place, range) in [(N, arguments.n_bounds), (SIGMA, arguments.sigma_bounds)] {
            let Range(lower, upper) = range;
            options.parameters[place] = Treatment::Free { bounds: Interval::new(lower, upper), prior: None };
        }
        self.check_once()?;
        for PriorOf(place, wanted) in &self.prior {
            match options.parameters.get_mut(*place) {
                Some(Treatment::Free { prior, .. }) => {
                    *prior = wanted.map(|wanted| Prior { mean: wanted.centre, sd: wanted.sd });
                }
                Some(Treatment::Held(_)) => return Err(absent("--prior", *place)),
                // the interior's: see `interior_priors`
                None => {}
            }
        }
        for Hold(place, value) in &self.hold {
            let has = match *place {
                N | SIGMA | TILT_IN_PLANE | TILT_LATERAL => true,
                DIFFUSE_E => options.diffuse == DiffuseKind::P2,
                _ => options.diffuse != DiffuseKind::Lambert,
            };
            if !has {
                return Err(absent("--hold", *place));
            }
            options.parameters[*place] = Treatment::Held(*value);
        }
        options.robust = arguments.robust;
        options.valleys = usize::from(arguments.starts.unwrap_or(8));
        if arguments.start_n.is_some() || arguments.start_sigma.is_some() {
            let mut start = [0.0; PARAMETERS];
            start[N] = arguments.start_n.unwrap_or(1.47);
            start[SIGMA] = arguments.start_sigma.unwrap_or(0.3);
            options.starts.push(start);
        }
        options.check().map_err(|error| Failure::Usage(error.to_string()))?;
        Ok(options)
    }
}

fn absent(option: &str, place: usize) -> Failure {
    let remedy = match place {
        TILT_IN_PLANE | TILT_LATERAL => "add --tilt",
        _ => "add --diffuse p1",
    };
    Failure::Usage(format!("{option} {}: the model has no such free parameter; {remedy}", NAMES[place]))
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    arguments.check_starts()?;
    arguments.prospect.refuse()?;
    arguments.leaf.refuse("surface")?;
    if let Some((place, _)) = arguments.surface.interior_priors().first() {
        let name = parameters::NAMES.get(*place).copied().unwrap_or_default();
        return Err(Failure::Usage(format!(
            "--prior {name}: a surface has no such parameter; it is one of --model leaf"
        )));
    }
    let options = arguments.surface.surface(arguments, SurfaceOptions::paper())?;
    let Range(lower, upper) = arguments.k_l_bounds;
    let model = Model { name: "surface", normalization: Some(options.normalization.name()), bands: None };
    let fit = |data: &Measurement, _: &ProgressBar| {
        let selected = leaves::selected(data, arguments)?;
        fit_surface(data, selected, &options, Interval::new(lower, upper)).map_err(|failure| failure.to_string())
    };
    leaves::each(
        arguments,
        &model,
        || leaves::measurements(arguments),
        fit,
        |outcome, folder, data, file| {
            outcome.write_tables(folder)?;
            outcome.write_summary(folder, data, file)?;
            Ok((outcome.values(), outcome.line()))
        },
    )
}
