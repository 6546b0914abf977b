//! From one mounting to the next: fit the views of one measurement of a leaf, predict another measurement of the same leaf, made
//! after it was taken out of its holder and put back.
//!
//! ```sh
//! cargo run --release -p leafbrdf --example surface_transfer -- FIRST SECOND
//! ```
//!
//! FIRST and SECOND are folders of measurement files; `qX.csv` of SECOND is the leaf `X.csv` of FIRST. Prints, for each kind of
//! surface, the median over the leaves of the root mean square of measured − predicted BRF (wavelengths 480–879 nm × directions,
//! θ_v ≤ 70°), and how the two measurements differ in the directions that they share (the repeatability: no model can do better
//! than that but by luck). The last columns compare n, σ of separate fits to both measurements with their standard errors.

use std::path::{Path, PathBuf};

use leafbrdf::fit::{Selected, Selection};
use leafbrdf::measurement::{ReadOptions, read_path};
use leafbrdf_core::Normalization;
use leafbrdf_fit::surface::model::{PARAMETERS, TILT_IN_PLANE, TILT_LATERAL};
use leafbrdf_fit::surface::{
    DirectionalModel, LeafModel, SurfaceData, SurfaceFit, SurfaceOptions, Treatment, fit_surface,
};

struct Pair {
    first: Selected,
    second: Selected,
    shared: Vec<(usize, usize)>,
}

fn main() {
    let folders: Vec<PathBuf> = std::env::args().skip(1).map(PathBuf::from).collect();
    let [first, second] = folders.as_slice() else { panic!("usage: surface_transfer FIRST SECOND") };
    let mut pairs = Vec::new();
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(second).expect("SECOND").flatten().map(|file| file.path()).collect();
    files.sort();
    for file in files {
        let name = file.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        let Some(partner) = name.strip_prefix('q').map(|name| first.join(name)).filter(|file| file.exists()) else {
            continue;
        };
        pairs.push(pair(&partner, &file));
    }
    println!("{} leaves, root mean square of measured - predicted BRF", pairs.len());
    let repeated = pairs.iter().filter(|pair| !pair.shared.is_empty()).map(repeatability).collect();
    println!("{:<46} {:.4}", "the second measurement itself, shared directions", median(repeated));
    println!(
        "{:<46} {:>7} {:>7} {:>9} {:>8} {:>8}",
        "fitted to the first", "median", "mean", "level", "z of n", "z of sigma"
    );
    let dark = |mut options: SurfaceOptions| {
        options.parameters[0] = Treatment::Held(1.0);
        options.parameters[1] = Treatment::Held(0.3);
        options
    };
    let derived = SurfaceOptions { normalization: Normalization::CookTorrance, ..SurfaceOptions::paper() };
    for (name, options) in [
        ("Lambert alone", dark(SurfaceOptions::paper())),
        ("the paper's surface, K = 2 pi^2", SurfaceOptions::paper()),
        ("the paper's surface, K = 4 pi", derived.clone()),
        ("the same, tilt", derived.clone().with_tilt()),
        ("the same, P1, tilt", derived.with_p1().with_tilt()),
        ("GGX", SurfaceOptions::paper().with_ggx()),
        ("GGX, P1", SurfaceOptions::paper().with_ggx().with_p1()),
        ("GGX, tilt", SurfaceOptions::paper().with_ggx().with_tilt()),
        ("GGX, P1, tilt", SurfaceOptions::paper().with_ggx().with_p1().with_tilt()),
        ("GGX, P2, tilt", SurfaceOptions::paper().with_ggx().with_p2().with_tilt()),
    ] {
        let (mut as_fitted, mut level, mut z) = (Vec::new(), Vec::new(), [Vec::new(), Vec::new()]);
        for pair in &pairs {
            let (one, two) = (fit(&pair.first, &options), fit(&pair.second, &options));
            as_fitted.push(misfit(&one, one.x, &pair.second, &options));
            let mut x = one.x;
            x[TILT_IN_PLANE] = 0.0;
            x[TILT_LATERAL] = 0.0;
            level.push(misfit(&one, x, &pair.second, &options));
            for (i, z) in z.iter_mut().enumerate() {
                if let (Some(a), Some(b)) = (one.errors.standard_errors[i], two.errors.standard_errors[i]) {
                    z.push((one.x[i] - two.x[i]).abs() / (a * a + b * b).sqrt());
                }
            }
        }
        let mean = as_fitted.iter().sum::<f64>() / as_fitted.len() as f64;
        let [n, sigma] = z.map(median);
        println!("{name:<46} {:7.4} {mean:7.4} {:9.4} {n:8.2} {sigma:8.2}", median(as_fitted), median(level));
    }
    println!(
        "level: the leaf taken as level in its second mounting. z: median of |difference|/standard error (0.67 where errors are right)"
    );
}

fn pair(first: &Path, second: &Path) -> Pair {
    let read = |file: &Path| read_path(file, &ReadOptions::default()).expect("a measurement file").remove(0);
    let (first, second) = (read(first), read(second));
    let selection = Selection { wavelengths: "480:879".parse().ok(), ..Selection::default() };
    let kept = |leaf: &leafbrdf::measurement::Measurement| -> Vec<[f64; 3]> {
        let views = leaf.directions.iter().filter(|d| d.theta_v_deg <= 70.0);
        // at nadir every azimuth is the same direction
        views.map(|d| [d.theta_s_deg, d.theta_v_deg, if d.theta_v_deg > 0.0 { d.phi_v_deg } else { 0.0 }]).collect()
    };
    let (a, b) = (kept(&first), kept(&second));
    let shared =
        a.iter().enumerate().filter_map(|(i, key)| Some((i, b.iter().position(|other| other == key)?))).collect();
    let select = |leaf| Selected::new(leaf, &selection).expect("bands between 480 and 879 nm");
    Pair { first: select(&first), second: select(&second), shared }
}

fn repeatability(pair: &Pair) -> f64 {
    let (a, b) = (pair.first.vectors.len(), pair.second.vectors.len());
    let differences = pair.first.brdf.chunks_exact(a).zip(pair.second.brdf.chunks_exact(b));
    rms(differences.flat_map(|(one, two)| pair.shared.iter().map(|(i, k)| one[*i] - two[*k]).collect::<Vec<_>>()))
}

fn fit(leaf: &Selected, options: &SurfaceOptions) -> SurfaceFit {
    fit_surface(&SurfaceData { directions: &leaf.vectors, brdf: &leaf.brdf, sd: None }, options).expect("a fit")
}

fn misfit(fit: &SurfaceFit, x: [f64; PARAMETERS], leaf: &Selected, options: &SurfaceOptions) -> f64 {
    let model = LeafModel {
        directions: &leaf.vectors,
        facets: options.facets,
        diffuse: options.diffuse,
        normalization: options.normalization,
    };
    let mut values = Vec::new();
    model.values(&x, |value| values.push(value)).expect("directions above the horizon");
    let rows = leaf.brdf.chunks_exact(values.len()).zip(&fit.bands);
    rms(rows.flat_map(|(row, band)| {
        let k = band.k_lambert.unwrap_or(f64::NAN);
        row.iter().zip(&values).map(|(y, [s, p])| y - k * s - p).collect::<Vec<_>>()
    }))
}

/// In BRF, of differences in BRDF.
fn rms(differences: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = differences.filter(|d| d.is_finite()).fold((0.0, 0), |(sum, count), d| (sum + d * d, count + 1));
    std::f64::consts::PI * (sum / f64::from(count)).sqrt()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
