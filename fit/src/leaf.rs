//! The whole leaf: n and σ of its surface and the structure and contents of its interior, from directional reflectance alone.
//!
//! Three methods, one engine:
//!
//! | method | what |
//! |---|---|
//! | [`Method::Recommended`] | the interior from the leaf's darkest directions by a [`Recipe`] (N held, gain and flat offset free), then the surface on all directions with the interior frozen |
//! | [`Method::TwoStep`] | the paper's (§4.6): n and σ first, held; then Eq. 17 inverted for the interior |
//! | [`Method::Joint`] | everything at once (Eq. 18), any subset held, tied or with a prior |
//!
//! | room | what |
//! |---|---|
//! | `recipe` | every constant of the recommended method, and where each comes from |
//! | `parameters` | the leaf's parameters in one list, and the coordinates in which they are sought |
//! | `residuals` | how errors of neighbouring wavelengths resemble each other |
//! | `engine`, `lobes` | χ² of a leaf with exact derivatives; what the surface makes of every direction |
//! | `problem`, `error` | what was measured, what is sought; what cannot be |
//! | `recommended`, `joint`, `found` | the methods; where their searches ended |
//! | `report`, `errors` | what comes back; standard errors, correlations, what the data cannot tell |

mod engine;
mod error;
mod errors;
mod found;
mod joint;
mod lobes;
pub mod parameters;
mod problem;
pub mod recipe;
mod recommended;
mod report;
mod residuals;

pub use error::LeafError;
pub use lobes::dhrf;
pub use parameters::{Prior, Treatment};
pub use problem::{DirectionalData, LeafOptions, Method, SurfaceFrom, default_bounds, fit};
pub use recipe::{HeldSd, Interior, RECIPES, RECOMMENDED, Recipe, ShareRule};
pub use report::{Knowledge, LeafFit, OtherLeaf, RecipeReport};
pub use residuals::ResidualModel;
