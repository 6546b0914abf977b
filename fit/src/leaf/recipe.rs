//! The recommended method as data: every constant of it in one place, and where each comes from.
//!
//! From reflectance alone PROSPECT's N is read off the absolute level of the near infrared, which carries a gain error of a few per
//! cent, the bowl of the diffuse term, and the surface; and an error of N is one of path length in all constituents. So N is held
//! and a gain left free: N acts on the diffuse reflectance mostly as a factor. The surface term is one flat offset beside a
//! reflectance that has PROSPECT's own first-surface reflection taken off, and directions towards the specular side are left out.

use leafbrdf_prospect::Parameter;

use super::parameters::Prior;
use super::residuals::ResidualModel;

/// The inside of the leaf.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Interior {
    /// PROSPECT's one pile of plates.
    Plain,
    /// Two piles, this share of the pigments in the upper one ([`leafbrdf_prospect::TwoLayer`]).
    TwoLayer {
        /// f, [0, 1].
        upper_share: f64,
    },
}

impl Interior {
    /// The name in files and on the command line.
    pub const fn name(&self) -> &'static str {
        match self {
            Interior::Plain => "plain",
            Interior::TwoLayer { .. } => "two-layer",
        }
    }
}

/// How the interior is taken from a leaf's darkest directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recipe {
    /// Name on the command line.
    pub name: &'static str,
    /// Wavelengths where leaves are dark, nm: a direction that is bright there sees the surface.
    pub dark_nm: &'static [f64],
    /// Of V directions, ⌊V · share⌋ are kept (at least one), those that are least bright there.
    pub kept_share: f64,
    /// Wavelengths that are fitted: first, last, step, nm.
    pub grid_nm: [f64; 3],
    /// Left out of them, ends included, nm.
    pub without_nm: Option<[f64; 2]>,
    /// The inside of the leaf.
    pub interior: Interior,
    /// How f follows from the dry matter of a first fit; `None`: it stays where it is.
    pub share_rule: Option<ShareRule>,
    /// N, held.
    pub n_struct: f64,
    /// The residuals' covariance.
    pub residuals: ResidualModel,
    /// ln N, f and the instrument's wavelength scale are held: what they may be off by, for the standard errors.
    pub held_sd: HeldSd,
    /// Which of these constants were chosen by looking at the chemistry of leaves, and of which leaves.
    pub chosen: &'static str,
}

/// f = f₀ − slope · ln(C_m/reference), between two bounds: leaves with more dry matter per area share their pigments more evenly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShareRule {
    /// Per factor e of C_m.
    pub slope: f64,
    /// C_m of a leaf whose share is f₀, g cm⁻².
    pub reference_cm: f64,
    /// Least and largest share.
    pub within: [f64; 2],
    /// With a larger standard error of ln C_m, f₀ stays.
    pub most_uncertain: f64,
}

impl ShareRule {
    /// f for a C_m in g cm⁻² with this standard error of its logarithm.
    pub fn share(&self, at_reference: f64, cm: f64, log_sd: f64) -> f64 {
        if cm > 0.0 && log_sd < self.most_uncertain {
            (at_reference - self.slope * (cm / self.reference_cm).ln()).clamp(self.within[0], self.within[1])
        } else {
            at_reference
        }
    }
}

/// By how much what is held may be off: one standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldSd {
    /// Of ln N.
    pub log_n_struct: f64,
    /// Of f.
    pub upper_share: f64,
    /// Of the wavelength scale, nm.
    pub wavelength_nm: f64,
}

/// Dark by chlorophyll and carotenoids (440–460, 680 nm) and by water (1930–1950 nm).
const DARK_NM: [f64; 7] = [440.0, 450.0, 460.0, 680.0, 1930.0, 1940.0, 1950.0];

const HELD_SD: HeldSd = HeldSd { log_n_struct: 0.15, upper_share: 0.10, wavelength_nm: 1.0 };

/// One plain leaf, N = 1.4, every band alike: the recipe with the fewest choices.
pub const PLAIN: Recipe = Recipe {
    name: "plain",
    dark_nm: &DARK_NM,
    kept_share: 0.5,
    grid_nm: [410.0, 2450.0, 10.0],
    without_nm: None,
    interior: Interior::Plain,
    share_rule: None,
    n_struct: 1.4,
    residuals: ResidualModel::white(0.01),
    held_sd: HELD_SD,
    chosen: "n_struct = 1.4 was chosen by the chemistry of 99 leaves of 13 species (one instrument)",
};

/// Two piles of plates, 65 % of the pigments in the upper one, N = 1.5, whitened residuals.
pub const TWO_LAYER: Recipe = Recipe {
    name: "two-layer",
    interior: Interior::TwoLayer { upper_share: 0.65 },
    n_struct: 1.5,
    residuals: ResidualModel { slow_sd: 0.01, length_nm: 60.0, white_sd: 0.002, surface_sd: 0.0 },
    chosen: "upper_share = 0.65 and n_struct = 1.5 were chosen by the chemistry of 99 leaves of 13 species (one instrument): \
             the share removes a bias of C_ab that a scale error of 1.2 in the absorption coefficients would look like",
    ..PLAIN
};

/// Two thirds of the pigments in the upper half, N = 1.5, without the flank of the 1.9 µm water band.
pub const DORSIVENTRAL: Recipe = Recipe {
    name: "dorsiventral",
    grid_nm: [410.0, 2400.0, 10.0],
    without_nm: Some([1870.0, 1910.0]),
    interior: Interior::TwoLayer { upper_share: 2.0 / 3.0 },
    n_struct: 1.5,
    residuals: ResidualModel { slow_sd: 0.01, length_nm: 100.0, white_sd: 0.005, surface_sd: 0.0 },
    chosen: "upper_share = 2/3 was chosen by the chemistry of 99 leaves of 13 species (one instrument), among 0.5 to 0.7, and acts on \
             C_ab alone; residual length 100 nm and white part 0.005 were seen there among 30 to 200 nm and 0.002 to 0.005, within \
             noise; that leaving out 1870 to 1910 nm (the flank of a water band, and water vapour) takes away a bias of C_m was seen \
             there too; n_struct = 1.5 is the textbook value of a dicotyledon's leaf, 1.4 to 1.6 were looked at",
    ..PLAIN
};

/// The same with a share that falls as dry matter grows, and an offset that need not be quite flat: best on leaves whose species it
/// was not chosen by.
pub const DRY_MATTER: Recipe = Recipe {
    name: "dry-matter",
    interior: Interior::TwoLayer { upper_share: 0.7 },
    share_rule: Some(ShareRule { slope: 0.1, reference_cm: 0.005, within: [0.5, 0.8], most_uncertain: 0.7 }),
    residuals: ResidualModel { surface_sd: 0.01, ..DORSIVENTRAL.residuals },
    held_sd: HeldSd { upper_share: 0.08, ..HELD_SD },
    chosen: "upper_share = 0.7 - 0.1 ln(C_m / 5 mg cm^-2): both numbers were chosen by the C_ab of 99 leaves of 13 species (one \
             instrument), among 0.63 to 0.7 and 0 to 0.2, and act on C_ab alone; a positive slope wins whichever species is left out. \
             Residual length 100 nm and white part 0.005 were seen there among 30 to 200 nm and 0.002 to 0.005, within noise; that leaving \
             out 1870 to 1910 nm (the flank of a water band, and water vapour) takes away a bias of C_m was seen there too; n_struct = 1.5 \
             is an ordinary value of a dicotyledon's leaf, 1.3 to 1.6 were looked at; that the offset may follow the first surface's \
             reflectance, by 0.01, was seen there among 0 to 0.05 to lower the error of C_m by 5 %",
    ..DORSIVENTRAL
};

/// Every recipe.
pub const RECIPES: [&Recipe; 4] = [&DRY_MATTER, &DORSIVENTRAL, &TWO_LAYER, &PLAIN];

/// The recipe of `--method recommended`. Changing it changes the default.
pub const RECOMMENDED: &Recipe = &DRY_MATTER;

impl Recipe {
    /// The recipe of this name.
    pub fn from_name(name: &str) -> Option<&'static Recipe> {
        RECIPES.into_iter().find(|recipe| recipe.name == name)
    }

    /// What is known of a leaf before it is measured: wide, and the same for every recipe. Contents in their logarithm.
    pub fn prior(&self, place: usize) -> Option<Prior> {
        use super::parameters::{GAIN, OFFSET, interior};
        Some(match place {
            GAIN => Prior::log(1.0, 0.2),
            OFFSET => Prior::plain(0.0, 0.1),
            _ => match interior(place)? {
                // freed by the user: as uncertain as the errors take it to be
                Parameter::NStruct => Prior::log(self.n_struct, self.held_sd.log_n_struct),
                Parameter::Cab => Prior::log(40.0, 1.5),
                Parameter::Car => Prior::log(8.0, 1.0),
                Parameter::Cant => Prior::log(0.5, 1.5),
                Parameter::Cbrown => Prior::log(0.005, 1.5),
                Parameter::Cw => Prior::log(0.012, 1.0),
                Parameter::Cm => Prior::log(0.006, 1.0),
                Parameter::Prot => Prior::log(0.001, 1.0),
                Parameter::Cbc => Prior::log(0.005, 1.0),
            },
        })
    }
}
