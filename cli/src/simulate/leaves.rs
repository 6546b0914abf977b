//! The paper's three leaves, as far as it prints them.

use leafbrdf_prospect::LeafParams;

/// A leaf to simulate: the surface of Table 4 over an interior of ours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PresetLeaf {
    /// Name on the command line and in files.
    pub name: &'static str,
    /// The species.
    pub species: &'static str,
    /// n (Table 4; it belongs to K = 2π²).
    pub n: f64,
    /// σ (Table 4).
    pub sigma: f64,
    /// PROSPECT-D parameters. The paper prints none: these give spectra like those of its Fig. 7 (chlorophyll absorption
    /// deepest and the near-infrared plateau near 0.45 to 0.5), and keep k_L above the lower bound of Table 3.
    pub interior: LeafParams<f64>,
}

/// Laurel, beech, hazel, in the paper's order.
///
/// C_car = C_ab/4: the paper's PROSPECT did not tell the pigments apart. Water is transparent below 900 nm.
pub fn presets() -> [PresetLeaf; 3] {
    let interior =
        |n_struct, cab, cm| LeafParams { cab, car: cab / 4.0, cw: 0.01, cm, ..LeafParams::with_n_struct(n_struct) };
    [
        PresetLeaf {
            name: "laurel",
            species: "Prunus laurocerasus",
            n: 1.22,
            sigma: 0.078,
            interior: interior(2.0, 45.0, 0.009),
        },
        PresetLeaf {
            name: "beech",
            species: "Fagus sylvatica",
            n: 1.56,
            sigma: 0.29,
            interior: interior(1.6, 18.0, 0.005),
        },
        PresetLeaf {
            name: "hazel",
            species: "Corylus avellana",
            n: 1.68,
            sigma: 0.46,
            interior: interior(1.7, 15.0, 0.004),
        },
    ]
}
