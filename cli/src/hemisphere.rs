//! The hemisphere of viewing directions: what lies between the directions that were measured.
//!
//! | room | what |
//! |---|---|
//! | `interpolate` | natural-neighbour interpolation on an equal-area disc |
//! | `integrate` | DHRF as a weighted sum of measured values, with its errors (Eq. 2) |
//! | `peak` | the specular peak: place, height, width (§3.1) |
//! | `measured` | both for every wavelength and θ_s of a measurement file |

mod integrate;
mod interpolate;
mod measured;
mod peak;

pub use integrate::{Hemisphere, Integral, IntegrationError};
pub use interpolate::{DirectionMesh, Interpolator, MeshError, direction_of, disc, nearest_on_segment};
pub use measured::{HemisphereOptions, MeasuredDhrf, NotMeasured, Rows, SubtractedLobe, hemispheres};
pub use peak::{Peak, background};
