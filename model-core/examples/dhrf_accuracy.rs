//! Prints the tables of errors and costs in the documentation of `Grade`.
//!
//!     cargo run --release -p leafbrdf-core --example dhrf_accuracy
//!
//! 20,000 scattered (θ_s, σ, index) for each region, one index in four complex; inputs rounded to `f32`. Truth for E4d, E6
//! and E8 is E10; E10 itself is compared with the golden files. First the paper's facets, then GGX.

use leafbrdf_core::{
    Absorbing, Angle, Beckmann, DhrfGradient, Ggx, Grade, Hemispherical, Illumination, Real, Smith, VCavity,
};

const POINTS: usize = 20_000;

struct Region {
    name: &'static str,
    theta_s: (f64, f64),
    sigma: (f64, f64),
    n: (f64, f64),
}

const REGIONS: [Region; 5] = [
    Region { name: "n 1.1–5, σ 0.01–1, θ_s ≤ 89°", theta_s: (0.0, 89.0), sigma: (0.01, 1.0), n: (1.1, 5.0) },
    Region { name: "θ_s 89–89.9°", theta_s: (89.0, 89.9), sigma: (0.01, 1.0), n: (1.1, 5.0) },
    Region { name: "σ 0.005–0.01", theta_s: (0.0, 89.9), sigma: (0.005, 0.01), n: (1.1, 5.0) },
    Region { name: "σ 1–2", theta_s: (0.0, 89.9), sigma: (1.0, 2.0), n: (1.1, 5.0) },
    Region { name: "n 1.001–1.1", theta_s: (0.0, 89.0), sigma: (0.01, 1.0), n: (1.001, 1.1) },
];

/// Weyl's sequence: evenly spread, the same on every machine.
fn fill(i: usize, irrational: f64) -> f64 {
    (0.5 + i as f64 * irrational).fract()
}

fn scattered(region: &Region, i: usize) -> [f64; 4] {
    let [a, b, c, d] =
        [0.856_674_883_854_503, 0.733_891_856_627_125_7, 0.628_706_721_068_654_2, 0.538_596_958_290_891_2]
            .map(|irrational| fill(i, irrational));
    let between = |(low, high): (f64, f64), x: f64| low + (high - low) * x;
    let geometric = |(low, high): (f64, f64), x: f64| low * (high / low).powf(x);
    // half of the angles in the last third, where the integrand is difficult
    let theta_s =
        if i.is_multiple_of(2) { between(region.theta_s, a) } else { between(region.theta_s, 1.0 - a * a / 3.0) };
    let sigma = if i % 4 < 2 { between(region.sigma, b) } else { geometric(region.sigma, b) };
    let n = if i % 8 < 4 { 1.0 + geometric((region.n.0 - 1.0, region.n.1 - 1.0), c) } else { between(region.n, c) };
    let kappa = if i % 16 == 5 || i % 16 == 10 {
        5.0 * d
    } else if i % 16 == 15 {
        0.3 * d
    } else {
        0.0
    };
    [theta_s, sigma, n, kappa].map(|x| f64::from(x as f32))
}

fn gradient<T: Real, L: Hemispherical<T>>([theta_s, sigma, n, kappa]: [f64; 4], grade: Grade) -> DhrfGradient<f64> {
    let illumination = Illumination::new(Angle::from_degrees(T::lit(theta_s))).expect("θ_s in the domain");
    let index = Absorbing::new(T::lit(n), T::lit(kappa)).expect("index in the domain");
    let DhrfGradient { value, d_n, d_sigma } = L::dhrf_with_gradient(&illumination, index, T::lit(sigma), grade);
    DhrfGradient { value: value.to_f64(), d_n: d_n.to_f64(), d_sigma: d_sigma.to_f64() }
}

/// Errors of the value (relative) and of the logarithmic derivatives (absolute).
fn errors(point: [f64; 4], got: DhrfGradient<f64>, truth: DhrfGradient<f64>) -> [f64; 3] {
    let [_, sigma, n, _] = point;
    [
        (got.value / truth.value - 1.0).abs(),
        ((got.d_n - truth.d_n) * n / truth.value).abs(),
        ((got.d_sigma - truth.d_sigma) * sigma / truth.value).abs(),
    ]
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

fn report<L: Hemispherical<f64> + Hemispherical<f32>>(
    name: &str,
    grade: Grade,
    points: &[[f64; 4]],
    truth: impl Fn(usize) -> DhrfGradient<f64>,
) {
    let (mut double, mut single) = ([0.0_f64; 3], [0.0_f64; 3]);
    let mut all = Vec::new();
    let (mut most, mut total) = (0, 0);
    for (i, &point) in points.iter().enumerate() {
        let truth = truth(i);
        let got = errors(point, gradient::<f64, L>(point, grade), truth);
        let got_single = errors(point, gradient::<f32, L>(point, grade), truth);
        all.push(got[0]);
        for k in 0..3 {
            double[k] = double[k].max(got[k]);
            single[k] = single[k].max(got_single[k]);
        }
        let illumination = Illumination::new(Angle::from_degrees(point[0])).expect("θ_s in the domain");
        let evaluations = <L as Hemispherical<f64>>::evaluations(&illumination, point[1], grade);
        most = most.max(evaluations);
        total += evaluations;
    }
    println!(
        "| {name} | {grade:?} | {:.1e} | {:.0e} | {:.1e} | {:.1e} | {:.1e} | {:.1e} | {:.1e} | {most} | {} |",
        double[0],
        median(all),
        double[1],
        double[2],
        single[0],
        single[1],
        single[2],
        total / points.len(),
    );
}

/// The largest relative error on a golden file whose last named column is the value.
fn golden<L: Hemispherical<f64>>(text: &str, names: [&str; 5], grade: Grade) -> (f64, f64) {
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let header: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let places = names.map(|name| header.iter().position(|column| *column == name));
    let mut all = Vec::new();
    for line in lines {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
        let [n, kappa, sigma, theta_s, value] = places.map(|place| place.map_or(0.0, |place| cells[place]));
        if sigma <= 1.0 && theta_s <= 89.0 {
            all.push((gradient::<f64, L>([theta_s, sigma, n, kappa], grade).value / value - 1.0).abs());
        }
    }
    (all.iter().copied().fold(0.0, f64::max), median(all))
}

/// The largest relative step where the number of nodes changes with σ, found by a scan in steps of 0.0002.
fn largest_step<L: Hemispherical<f64>>(grade: Grade) -> f64 {
    let mut largest = 0.0_f64;
    for theta_s in [0.0, 8.0, 21.0, 41.0, 50.0, 60.0, 80.0, 88.0] {
        let mut last = None;
        for i in 50..5_000 {
            let point = [theta_s, 0.0002 * f64::from(i), 1.5, 0.0];
            let error = gradient::<f64, L>(point, grade).value / gradient::<f64, L>(point, Grade::E10).value - 1.0;
            largest = largest.max(last.map_or(0.0, |last: f64| (error - last).abs()));
            last = Some(error);
        }
    }
    largest
}

fn tables<L: Hemispherical<f64> + Hemispherical<f32>>() {
    println!("| region | grade | f64 max | median | ∂n | ∂σ | f32 max | ∂n | ∂σ | evaluations max | mean |");
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    for region in &REGIONS {
        let points: Vec<[f64; 4]> = (0..POINTS).map(|i| scattered(region, i)).collect();
        let truth: Vec<DhrfGradient<f64>> = points.iter().map(|&point| gradient::<f64, L>(point, Grade::E10)).collect();
        for grade in Grade::ALL {
            report::<L>(region.name, grade, &points, |i| truth[i]);
        }
    }
    for grade in [Grade::E4d, Grade::E6, Grade::E8] {
        println!("{grade:?}, largest step in σ: {:.1e}", largest_step::<L>(grade));
    }
}

fn against<L: Hemispherical<f64>>(name: &str, text: &str) {
    for grade in Grade::ALL {
        let (worst, middle) = golden::<L>(text, ["n", "kappa", "sigma", "theta_s_deg", "dhrf_4pi"], grade);
        println!("{grade:?}, {name}: max {worst:.1e}, median {middle:.0e}");
    }
}

fn main() {
    println!("Beckmann facets, masking of Eq. 7");
    tables::<(Beckmann, VCavity)>();
    against::<(Beckmann, VCavity)>("real index, reference grid", include_str!("../tests/golden/dhrf_reference.csv"));
    against::<(Beckmann, VCavity)>(
        "complex index, reference values",
        include_str!("../tests/golden/dhrf_index_reference.csv"),
    );
    println!("GGX facets, Smith's masking");
    tables::<(Ggx, Smith)>();
    against::<(Ggx, Smith)>("reference values", include_str!("../tests/golden/ggx_dhrf_reference.csv"));
}
