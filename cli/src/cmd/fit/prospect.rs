//! `leafbrdf fit --model prospect`: structure and contents of leaves from hemispherical spectra.

use std::str::FromStr;

use clap::Args;
use indicatif::ProgressBar;
use leafbrdf::fit::{ProspectOptions, fit_prospect};
use leafbrdf::spectra::{LeafSpectra, read_spectra};
use leafbrdf_fit::Interval;
use leafbrdf_fit::hemispherical::{Free, default_free};
use leafbrdf_fit::leaf::parameters::place;
use leafbrdf_fit::leaf::{Prior, Treatment, default_bounds};
use leafbrdf_fit::surface;
use leafbrdf_prospect::{Error, LeafParams, Parameter, Prospect, Version, table};

use super::super::Failure;
use super::super::version::VersionName;
use super::leaves::{self, Model};
use super::{Arguments, Range};

/// The options that only this model has.
#[derive(Args, Debug)]
#[group(id = "prospect_options")]
#[command(next_help_heading = "Options of --model prospect and leaf")]
pub struct Options {
    /// Version of PROSPECT [default: D]
    #[arg(long, value_enum, ignore_case = true)]
    prospect: Option<VersionName>,
    /// Parameters that are free, such as n_struct,cab,cm; all others are held, at 0 or as --fix says (with leaf n_struct at what
    /// the recommended method holds it at) [default: all of the version that --fix and --car-per-cab leave; for PRO without cm,
    /// which is prot + cbc there; without n_struct where a gain is free]
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    free: Vec<Name>,
    /// Parameters that are held, and where
    #[arg(long, value_name = "NAME=VALUE,…", value_delimiter = ',', allow_hyphen_values = true)]
    fix: Vec<Value>,
    /// Bounds of free parameters [default: n_struct 1:5, cab 0:150, car 0:40, cant 0:60, cbrown 0:4, cw 0:0.12, cm 0:0.06,
    /// prot 0:0.008, cbc 0:0.06]
    #[arg(long, value_name = "NAME=LOWER:UPPER,…", value_delimiter = ',', allow_hyphen_values = true)]
    bounds: Vec<Bounds>,
    /// Tie carotenoids to chlorophyll: C_car = RATIO · C_ab (0.25 is usual)
    #[arg(long, value_name = "RATIO", allow_negative_numbers = true)]
    car_per_cab: Option<f64>,
    /// Where a leaf has no transmittance: take n_struct from its reflectance at 1131 nm (or 800 nm), and hold it
    #[arg(long)]
    n_prior: bool,
}

/// What the options decide of a leaf's interior.
pub(super) struct Decided {
    pub version: Version,
    pub car_per_cab: Option<f64>,
    pub treatments: Vec<(Parameter, Treatment)>,
}

/// A parameter by its name.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Name(Parameter);

/// NAME=VALUE.
#[derive(Clone, Copy, Debug)]
struct Value(Parameter, f64);

/// NAME=LOWER:UPPER.
#[derive(Clone, Copy, Debug)]
struct Bounds(Parameter, Interval<f64>);

impl FromStr for Name {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Parameter::ALL.into_iter().find(|parameter| parameter.name() == text.trim()).map(Name).ok_or_else(|| {
            let names = Parameter::ALL.map(Parameter::name).join(", ");
            let of_surface = surface::NAMES.contains(&text.trim());
            let remedy = if of_surface { "; the surface's are for --hold and --prior" } else { "" };
            format!("{text:?} is no parameter: expected one of {names}{remedy}")
        })
    }
}

impl FromStr for Value {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("{text:?}: expected NAME=VALUE, such as cw=0.01");
        let (name, value) = text.split_once('=').ok_or_else(wrong)?;
        let Name(parameter) = name.parse()?;
        value.trim().parse().map(|value| Value(parameter, value)).map_err(|_| wrong())
    }
}

impl FromStr for Bounds {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("{text:?}: expected NAME=LOWER:UPPER, such as cab=0:80");
        let (name, range) = text.split_once('=').ok_or_else(wrong)?;
        let Name(parameter) = name.parse()?;
        let Range(lower, upper) = range.parse().map_err(|_| wrong())?;
        let (lowest, highest) = parameter.limits();
        if let Some(value) = [lower, upper].into_iter().find(|value| !(*value >= lowest && *value <= highest)) {
            let error: Error = Error::Outside { parameter, value };
            return Err(format!("{text:?}: expected bounds within {lowest}:{highest}; {error}"));
        }
        Ok(Bounds(parameter, Interval::new(lower, upper)))
    }
}

impl Options {
    /// For the other models: none of these options must be there.
    pub fn refuse(&self) -> Result<(), Failure> {
        let given = [
            ("--prospect", self.prospect.is_some()),
            ("--free", !self.free.is_empty()),
            ("--fix", !self.fix.is_empty()),
            ("--bounds", !self.bounds.is_empty()),
            ("--car-per-cab", self.car_per_cab.is_some()),
            ("--n-prior", self.n_prior),
        ];
        match given.iter().find(|(_, given)| *given) {
            Some((option, _)) => Err(Failure::Usage(format!("{option} is an option of --model prospect and leaf"))),
            None => Ok(()),
        }
    }

    /// The same options for `--model leaf`: what they and the user's priors decide, the rest being the method's.
    pub(super) fn decided(&self, default: Version, priors: &[(Parameter, Prior)]) -> Result<Decided, Failure> {
        let usage = |message: String| Err(Failure::Usage(message));
        if self.n_prior {
            return usage(
                "--n-prior is an option of --model prospect: --model leaf holds n_struct, or frees it".to_string(),
            );
        }
        let version = self.prospect.map_or(default, |name| name.0);
        let known =
            |parameter: Parameter| parameter == Parameter::NStruct || version.constituents().contains(&parameter);
        if let Some(ratio) = self.car_per_cab {
            let model = Prospect::new(table::full(version));
            model.with_car_per_cab(ratio).map_err(|error| Failure::Usage(format!("--car-per-cab: {error}")))?;
        }
        let mut treatments: Vec<(Parameter, Treatment)> = Vec::new();
        for Value(parameter, value) in &self.fix {
            let name = parameter.name();
            if treatments.iter().any(|(other, _)| other == parameter) {
                return usage(format!("--fix {name} stands twice"));
            }
            if !known(*parameter) && *value != 0.0 {
                return usage(format!("--fix: {}", Error::NotInVersion { parameter: *parameter, version }));
            }
            if *parameter == Parameter::Car && self.car_per_cab.is_some() {
                return usage("--fix car: car is tied to cab; leave it out, or leave --car-per-cab out".to_string());
            }
            let (lowest, highest) = parameter.limits();
            if !(*value >= lowest && *value <= highest) {
                return usage(format!("--fix: {}", Error::Outside { parameter: *parameter, value: *value }));
            }
            if *parameter == Parameter::Cab {
                super::super::warn_of_milligrams(*value);
            }
            treatments.push((*parameter, Treatment::Held(*value)));
        }
        for (place, Name(parameter)) in self.free.iter().enumerate() {
            let name = parameter.name();
            if self.free.iter().take(place).any(|other| other.0 == *parameter) {
                return usage(format!("--free {name} stands twice"));
            }
            if treatments.iter().any(|(other, _)| other == parameter) {
                return usage(format!("{name} is free and fixed: leave it out of --free or of --fix"));
            }
            if !known(*parameter) {
                return usage(format!("--free: {}", Error::NotInVersion { parameter: *parameter, version }));
            }
            if *parameter == Parameter::Car && self.car_per_cab.is_some() {
                return usage(
                    "car is free and tied to cab: leave it out of --free, or leave --car-per-cab out".to_string(),
                );
            }
        }
        let split = [Parameter::Prot, Parameter::Cbc].iter().any(|part| self.free.iter().any(|name| name.0 == *part));
        if version == Version::Pro && split && self.free.iter().any(|name| name.0 == Parameter::Cm) {
            return usage(format!("--free: {}", Error::DryMatterTwice));
        }
        for parameter in Parameter::ALL {
            let free = self.free.iter().any(|name| name.0 == parameter);
            let bounds = self.bounds.iter().find(|bounds| bounds.0 == parameter).map(|bounds| bounds.1);
            let fixed = treatments.iter().any(|(other, _)| *other == parameter);
            let prior = priors.iter().find(|prior| prior.0 == parameter).map(|prior| prior.1);
            let held = fixed || !known(parameter) || (!self.free.is_empty() && !free);
            for (option, given) in [("--bounds", bounds.is_some()), ("--prior", prior.is_some())] {
                if given && held {
                    return usage(format!("{option} {}: the parameter is not free", parameter.name()));
                }
            }
            if let Some(prior) = prior {
                self.check_prior(parameter, prior, version, free)?;
            }
            match (bounds, free || prior.is_some(), fixed) {
                (Some(bounds), ..) => treatments.push((parameter, Treatment::Free { bounds, prior })),
                (None, true, _) => {
                    let bounds = default_bounds(place(parameter), prior.is_some_and(|prior| prior.log));
                    treatments.push((parameter, Treatment::Free { bounds, prior }));
                }
                (None, false, false)
                    if !self.free.is_empty() && parameter != Parameter::NStruct && known(parameter) =>
                {
                    treatments.push((parameter, Treatment::Held(0.0)));
                }
                _ => {}
            }
        }
        let absorbs = |parameter: Parameter, where_nobody_says: bool| {
            let treatment = treatments.iter().find(|(other, _)| *other == parameter).map(|(_, treatment)| treatment);
            treatment.map_or(where_nobody_says, |treatment| *treatment != Treatment::Held(0.0))
        };
        if version == Version::Pro
            && absorbs(Parameter::Cm, false)
            && [Parameter::Prot, Parameter::Cbc].iter().any(|part| absorbs(*part, true))
        {
            return usage(
                "cm: in PROSPECT-PRO dry matter is prot + cbc, and would absorb twice; speak of these, or say --fix prot=0,cbc=0".to_string(),
            );
        }
        Ok(Decided { version, car_per_cab: self.car_per_cab, treatments })
    }

    /// A prior must speak of a parameter of its own, in its unit, and lie where the parameter may be.
    fn check_prior(&self, parameter: Parameter, prior: Prior, version: Version, free: bool) -> Result<(), Failure> {
        let (name, centre) = (parameter.name(), prior.centre);
        let usage = |message: String| Err(Failure::Usage(message));
        if parameter == Parameter::Car && self.car_per_cab.is_some() {
            return usage("--prior car: car is tied to cab; leave it out, or leave --car-per-cab out".to_string());
        }
        if parameter == Parameter::Cm && version == Version::Pro && !free {
            return usage("--prior cm: dry matter is prot + cbc in PROSPECT-PRO; give priors of these".to_string());
        }
        let (lowest, highest) = parameter.limits();
        if !(centre >= lowest && centre <= highest) {
            return usage(format!("--prior: {}", Error::Outside { parameter, value: centre }));
        }
        let given = self.bounds.iter().find(|bounds| bounds.0 == parameter).map(|bounds| bounds.1);
        let bounds = given.unwrap_or_else(|| default_bounds(place(parameter), prior.log));
        if !(centre >= bounds.lower && centre <= bounds.upper) {
            let (lower, upper) = (bounds.lower, bounds.upper);
            return usage(format!(
                "--prior {name}: {centre} lies outside its bounds {lower}:{upper}; --bounds moves them"
            ));
        }
        Ok(())
    }

    /// What is sought, checked as far as that can be done without a spectrum.
    fn options(&self, arguments: &Arguments) -> Result<ProspectOptions, Failure> {
        let usage = |message: String| Err(Failure::Usage(message));
        let version = self.prospect.map_or(Version::D, |name| name.0);
        let mut held = LeafParams::with_n_struct(f64::NAN);
        for (place, Value(parameter, value)) in self.fix.iter().enumerate() {
            if self.fix.iter().take(place).any(|other| other.0 == *parameter) {
                return usage(format!("--fix {} stands twice", parameter.name()));
            }
            held.set(*parameter, *value);
            if *parameter == Parameter::Cab {
                super::super::warn_of_milligrams(*value);
            }
        }
        let fixed = |parameter: Parameter| self.fix.iter().any(|value| value.0 == parameter);
        let tied = |parameter: Parameter| parameter == Parameter::Car && self.car_per_cab.is_some();
        let names: Vec<Parameter> = if self.free.is_empty() {
            default_free(version).into_iter().filter(|parameter| !fixed(*parameter) && !tied(*parameter)).collect()
        } else {
            self.free.iter().map(|name| name.0).collect()
        };
        for (place, parameter) in names.iter().enumerate() {
            let name = parameter.name();
            if fixed(*parameter) {
                return usage(format!("{name} is free and fixed: leave it out of --free or of --fix"));
            }
            if tied(*parameter) {
                return usage(
                    "car is free and tied to cab: leave it out of --free, or leave --car-per-cab out".to_string(),
                );
            }
            if names.iter().take(place).any(|other| other == parameter) {
                return usage(format!("--free {name} stands twice"));
            }
        }
        if names.is_empty() {
            return usage("every parameter is held: leave one of them out of --fix".to_string());
        }
        if held.n_struct.is_nan() {
            if !names.contains(&Parameter::NStruct) && !self.n_prior {
                let message = "n_struct is neither free nor held: add it to --free, or hold it with --fix n_struct=1.5";
                return usage(message.to_string());
            }
            held.n_struct = 1.5;
        }
        let free: Vec<Free<f64>> = names
            .into_iter()
            .map(|parameter| match self.bounds.iter().find(|bounds| bounds.0 == parameter) {
                Some(Bounds(_, bounds)) => Free { parameter, bounds: *bounds },
                None => Free::new(parameter),
            })
            .collect();
        if let Some(Bounds(parameter, _)) =
            self.bounds.iter().find(|bounds| !free.iter().any(|free| free.parameter == bounds.0))
        {
            return usage(format!("--bounds {}: the parameter is not free", parameter.name()));
        }
        // every rule of the model shows where nothing that is free is 0
        let mut middle = held;
        for one in &free {
            middle.set(one.parameter, 0.5 * (one.bounds.lower + one.bounds.upper));
        }
        let model = Prospect::new(table::full(version));
        let checked = match self.car_per_cab {
            Some(ratio) => model.with_car_per_cab(ratio),
            None => Ok(model),
        };
        checked.and_then(|model| model.band(&middle, 0)).map_err(|error| {
            let option = match error {
                Error::CarPerCab { .. } | Error::CarGivenAndTied => "--car-per-cab",
                Error::Outside { parameter, .. } | Error::NotInVersion { parameter, .. } if !fixed(parameter) => {
                    "--free"
                }
                Error::DryMatterTwice if !self.free.is_empty() => "--free",
                _ => "--fix",
            };
            Failure::Usage(format!("{option}: {error}"))
        })?;
        Ok(ProspectOptions {
            version,
            free,
            held,
            car_per_cab: self.car_per_cab,
            n_prior: self.n_prior,
            wavelengths: arguments.wavelengths,
            use_sd: !arguments.ignore_sd,
        })
    }
}

/// Options that speak of directions or of a surface, which spectra do not have: refused rather than ignored.
fn refuse_others(arguments: &Arguments) -> Result<(), Failure> {
    let given = [
        ("--max-theta-v", arguments.max_theta_v != 70.0),
        ("--k-l-bounds", arguments.k_l_bounds != Range(0.01, 0.99)),
        ("--n-bounds", arguments.n_bounds != Range(1.1, 5.0)),
        ("--sigma-bounds", arguments.sigma_bounds != Range(0.01, 1.0)),
        ("--start-n", arguments.start_n.is_some()),
        ("--start-sigma", arguments.start_sigma.is_some()),
        ("--starts", arguments.starts.is_some()),
        ("--robust", arguments.robust),
        ("--quantity", arguments.quantity.is_some()),
        ("--azimuth", arguments.azimuth.is_some()),
        ("--normalization", arguments.normalization.is_some()),
    ];
    match given.iter().find(|(_, given)| *given) {
        Some((option, _)) => Err(Failure::Usage(format!("{option} has no meaning for --model prospect: leave it out"))),
        None => Ok(()),
    }
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let options = arguments.prospect.options(arguments)?;
    refuse_others(arguments)?;
    arguments.surface.refuse("prospect")?;
    arguments.leaf.refuse("prospect")?;
    let model = Model { name: "prospect", normalization: None, bands: None };
    let read = || leaves::read(arguments, read_spectra, |leaf| &leaf.name);
    let fit = |data: &LeafSpectra, _: &ProgressBar| fit_prospect(data, &options).map_err(|failure| failure.to_string());
    leaves::each(arguments, &model, read, fit, |outcome, folder, data, file| {
        outcome.write(folder, data, file)?;
        Ok((outcome.values(), outcome.line()))
    })
}
