//! The hemisphere of viewing directions: what lies between the directions that were measured.
//!
//! | room | what |
//! |---|---|
//! | `interpolate` | natural-neighbour interpolation on an equal-area disc |

mod interpolate;

pub use interpolate::{DirectionMesh, Interpolator, MeshError, direction_of, disc, nearest_on_segment};
