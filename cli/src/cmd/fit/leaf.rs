//! `leafbrdf fit --model leaf`: surface and interior of whole leaves.

use clap::{Args, ValueEnum};
use indicatif::ProgressBar;
use leafbrdf::fit::fit_leaf;
use leafbrdf::measurement::Measurement;
use leafbrdf_fit::leaf::parameters::{GAIN, NAMES, OFFSET, interior, place};
use leafbrdf_fit::leaf::recipe::{DORSIVENTRAL, DRY_MATTER, PLAIN, TWO_LAYER};
use leafbrdf_fit::leaf::{Interior, LeafOptions, Method, Prior, Recipe, SurfaceFrom, Treatment, default_bounds};
use leafbrdf_fit::surface::model::{N, SIGMA, TILT_IN_PLANE, TILT_LATERAL};
use leafbrdf_fit::surface::{DiffuseKind, FacetKind, Treatment as Level};
use leafbrdf_prospect::{Coupling, Parameter};

use super::super::Failure;
use super::super::leaf::CouplingName;
use super::leaves::{self, Model};
use super::{Arguments, Range};

/// How a leaf is inverted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum MethodName {
    /// The most accurate that is known: the interior from the leaf's darkest directions, N held, gain and flat offset free; then the
    /// surface (GGX facets, P2 diffuse term, tilt) from all directions
    Recommended,
    /// The paper's (§4.6): n and σ first; then Eq. 17 inverted for the interior
    TwoStep,
    /// Everything at once (Eq. 18)
    Joint,
}

/// The inside of the leaf.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum InteriorName {
    /// Two piles of plates, 70 % of the pigments in the upper one, less where there is more dry matter: an assumption, chosen by
    /// chemistry
    DryMatter,
    /// The same with two thirds for every leaf
    Dorsiventral,
    /// The same with 65 %, and other constants of the recommended method
    TwoLayer,
    /// PROSPECT as it is
    Plain,
}

impl InteriorName {
    fn recipe(self) -> &'static Recipe {
        match self {
            InteriorName::DryMatter => &DRY_MATTER,
            InteriorName::Dorsiventral => &DORSIVENTRAL,
            InteriorName::TwoLayer => &TWO_LAYER,
            InteriorName::Plain => &PLAIN,
        }
    }
}

/// Where two-step takes n and σ from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FromName {
    /// Means over separately fitted bands (Table 4)
    Bands,
    /// One n and σ for all bands
    Surface,
}

/// The options that only this model has.
#[derive(Args, Debug)]
#[group(id = "leaf_options")]
#[command(next_help_heading = "Options of --model leaf")]
pub struct Options {
    /// How the leaf is inverted [default: recommended]
    #[arg(long, value_enum)]
    method: Option<MethodName>,
    /// From the interior to k_L, for two-step and joint; recommended has gain-offset [default: bousquet]
    #[arg(long, value_enum)]
    coupling: Option<CouplingName>,
    /// The inside of the leaf; with recommended also the constants that go with it [default: dry-matter for recommended, plain
    /// for the others, where the share does not follow the dry matter]
    #[arg(long, value_enum)]
    interior: Option<InteriorName>,
    /// Where two-step takes n and sigma from [default: bands with the paper's level surface whose n and sigma are free and without
    /// priors, else surface]
    #[arg(long, value_enum)]
    surface_from: Option<FromName>,
    /// Contents, gain and offset have the wide priors of recommended in two-step and joint too
    #[arg(long)]
    content_priors: bool,
    /// Hold the gain of coupling gain-offset here
    #[arg(long, value_name = "GAIN")]
    gain: Option<f64>,
    /// Hold the offset of couplings offset and gain-offset here
    #[arg(long, value_name = "OFFSET", allow_negative_numbers = true)]
    offset: Option<f64>,
}

impl Options {
    /// For the other models: none of these options must be there.
    pub fn refuse(&self, model: &str) -> Result<(), Failure> {
        let given = [
            ("--method", self.method.is_some()),
            ("--coupling", self.coupling.is_some()),
            ("--interior", self.interior.is_some()),
            ("--surface-from", self.surface_from.is_some()),
            ("--content-priors", self.content_priors),
            ("--gain", self.gain.is_some()),
            ("--offset", self.offset.is_some()),
        ];
        match given.iter().find(|(_, given)| *given) {
            Some((option, _)) => {
                Err(Failure::Usage(format!("{option} has no meaning for --model {model}: it is one of --model leaf")))
            }
            None => Ok(()),
        }
    }

    /// What is sought, and how.
    fn options(&self, arguments: &Arguments) -> Result<LeafOptions, Failure> {
        let usage = |message: &str| Err(Failure::Usage(message.to_string()));
        let method = match self.method.unwrap_or(MethodName::Recommended) {
            MethodName::Recommended => Method::Recommended,
            MethodName::TwoStep => Method::TwoStep,
            MethodName::Joint => Method::Joint,
        };
        if arguments.robust {
            return usage("--robust has no meaning for --model leaf: leave it out");
        }
        if arguments.k_l_bounds != Range(0.01, 0.99) {
            return usage("--k-l-bounds has no meaning for --model leaf, where k_l follows from the interior");
        }
        let mut options = LeafOptions::new(method);
        options.surface = arguments.surface.surface(arguments, options.surface)?;
        options.content_priors = self.content_priors;
        if method == Method::Recommended {
            if self.coupling.is_some_and(|name| name.0 != Coupling::GainOffset) {
                return usage(
                    "--method recommended has the coupling gain-offset: use --method joint or two-step for others",
                );
            }
            if self.content_priors {
                return usage("--content-priors: --method recommended always has them");
            }
            if let Some(name) = self.interior {
                options.recipe = name.recipe();
            }
        } else {
            options.coupling = self.coupling.map_or(Coupling::Bousquet, |name| name.0);
            options.interior = self.interior.map_or(Interior::Plain, |name| name.recipe().interior);
        }
        if let Some(from) = self.surface_from {
            if method != Method::TwoStep {
                return usage("--surface-from is an option of --method two-step");
            }
            options.surface_from = match from {
                FromName::Bands => SurfaceFrom::Bands,
                FromName::Surface => SurfaceFrom::Surface,
            };
        }
        if method == Method::TwoStep {
            // the bands are fitted with the paper's level surface, n and sigma free: anything else is one surface's
            let other = (options.surface.facets != FacetKind::Beckmann).then_some("--facets");
            let other = other.or((options.surface.diffuse != DiffuseKind::Lambert).then_some("--diffuse"));
            let tilted = options.surface.parameters[TILT_IN_PLANE..=TILT_LATERAL].iter();
            let other = other.or(tilted.clone().any(|tilt| *tilt != Level::Held(0.0)).then_some("a tilt"));
            let spoken = [N, SIGMA].iter().any(|&place| arguments.surface.speaks_of(place));
            match other.or(spoken.then_some("--hold or --prior of n or sigma")) {
                Some(other) if self.surface_from == Some(FromName::Bands) => {
                    return Err(Failure::Usage(format!(
                        "--surface-from bands: separately fitted bands have the paper's surface, without {other}; leave one of them out"
                    )));
                }
                Some(_) => options.surface_from = SurfaceFrom::Surface,
                None => {}
            }
        }
        let coupling = if method == Method::Recommended { Coupling::GainOffset } else { options.coupling };
        for (option, value, at, has) in [
            ("--gain", self.gain, GAIN, coupling == Coupling::GainOffset),
            ("--offset", self.offset, OFFSET, matches!(coupling, Coupling::GainOffset | Coupling::Offset)),
        ] {
            let Some(value) = value else { continue };
            if !has {
                let message = format!("{option}: coupling {} has none; try --coupling gain-offset", coupling.name());
                return Err(Failure::Usage(message));
            }
            if !value.is_finite() || (at == GAIN && value <= 0.0) {
                return Err(Failure::Usage(format!("{option} {value}: expected a number, and a gain > 0")));
            }
            options.treatments.push((at, Treatment::Held(value)));
        }
        let mut priors = Vec::new();
        for (at, prior) in arguments.surface.interior_priors() {
            let name = NAMES.get(at).copied().unwrap_or_default();
            let Some(prior) = prior else {
                let message = format!(
                    "--prior {name}=none: --method recommended needs a prior, the others have none without --content-priors; a wide one \
                     is {name}=MEDIAN:3:ln"
                );
                return Err(Failure::Usage(message));
            };
            if let Some(parameter) = interior(at) {
                priors.push((parameter, prior));
                continue;
            }
            if !(coupling == Coupling::GainOffset || (at == OFFSET && coupling == Coupling::Offset)) {
                let message =
                    format!("--prior {name}: coupling {} has none; try --coupling gain-offset", coupling.name());
                return Err(Failure::Usage(message));
            }
            if options.treatments.iter().any(|(other, _)| *other == at) {
                return Err(Failure::Usage(format!(
                    "{name} is held and has a prior: leave out --{name}, or its --prior"
                )));
            }
            let bounds = default_bounds(at, prior.log);
            if !(prior.centre >= bounds.lower && prior.centre <= bounds.upper) {
                let message = format!(
                    "--prior {name}: {} lies outside its bounds {}:{}",
                    prior.centre, bounds.lower, bounds.upper
                );
                return Err(Failure::Usage(message));
            }
            if prior.log && at == OFFSET {
                return usage("--prior offset: it may be negative: expected offset=MEAN:SD");
            }
            options.treatments.push((at, Treatment::Free { bounds, prior: Some(prior) }));
        }
        arguments.prospect.interior_of_a_leaf(&mut options, &priors)?;
        Ok(options)
    }
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    arguments.check_starts()?;
    let options = arguments.leaf.options(arguments)?;
    let model = Model { name: "leaf", normalization: Some(options.surface.normalization.name()), bands: None };
    let fit = |data: &Measurement, _: &ProgressBar| {
        fit_leaf(data, leaves::selected(data, arguments)?, &options).map_err(|failure| failure.to_string())
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

/// What --prospect, --free, --fix, --bounds, --car-per-cab and --prior say of a leaf's interior.
impl super::prospect::Options {
    fn interior_of_a_leaf(&self, options: &mut LeafOptions, priors: &[(Parameter, Prior)]) -> Result<(), Failure> {
        let decided = self.decided(options.version, priors)?;
        options.version = decided.version;
        options.car_per_cab = decided.car_per_cab;
        options.treatments.extend(decided.treatments.into_iter().map(|(parameter, what)| (place(parameter), what)));
        Ok(())
    }
}
