//! Sums over the bands of a leaf, direction by direction: what the errors are made of.

use std::vec;
use std::vec::Vec;

use super::super::model::{DirectionValue, PARAMETERS};
use super::matrix::{Matrix, Root, Vector, ZERO, dot, eigen, form, product, transposed};
use super::{Band, Problem, leverage};

/// ∂model/∂parameter of one value, k_L following: J_λv of the parameters listed, 0 elsewhere.
fn slope(value: &DirectionValue<f64>, band: &Band<'_>, taken: &Vector, listed: &[usize]) -> Vector {
    let mut j = [0.0; PARAMETERS];
    for &i in listed {
        j[i] = value.d_specular[i] + band.k_lambert * value.d_diffuse[i] - taken[i] * value.diffuse;
    }
    j
}

/// The lower triangle of Σ x xᵀ · `weight`, over the parameters listed.
fn add_outer(sum: &mut Matrix, listed: &[usize], x: &Vector, weight: f64) {
    for (n, &i) in listed.iter().enumerate() {
        let scaled = weight * x[i];
        for &k in listed.iter().take(n + 1) {
            sum[i][k] += scaled * x[k];
        }
    }
}

fn mirror(m: &mut Matrix) {
    for i in 0..PARAMETERS {
        for k in 0..i {
            m[k][i] = m[i][k];
        }
    }
}

fn list(free: &[bool; PARAMETERS]) -> Vec<usize> {
    (0..PARAMETERS).filter(|&i| free[i]).collect()
}

/// What the values weigh, before any residual is looked at.
pub(super) struct Seen {
    /// A = Σ ω J Jᵀ of the free parameters.
    pub normal: Matrix,
    /// Σ ω J r: 0 at the minimum but for the pull of priors.
    pub gradient: Vector,
    /// how many values have a weight
    pub values: f64,
    in_direction: Vec<bool>,
}

impl Seen {
    pub fn new<'a>(
        values: &[DirectionValue<f64>],
        free: &[bool; PARAMETERS],
        bands: impl Iterator<Item = Band<'a>>,
    ) -> Self {
        let listed = list(free);
        let in_direction = vec![false; values.len()];
        let mut seen = Seen { normal: ZERO, gradient: [0.0; PARAMETERS], values: 0.0, in_direction };
        for band in bands {
            let taken = leverage(values, &band);
            let lines = values.iter().zip(band.weight).zip(band.residual).zip(&mut seen.in_direction);
            for (((value, w), r), in_direction) in lines.filter(|(((_, w), _), _)| **w > 0.0) {
                let j = slope(value, &band, &taken, &listed);
                *in_direction = true;
                seen.values += 1.0;
                add_outer(&mut seen.normal, &listed, &j, *w);
                for &i in &listed {
                    seen.gradient[i] += w * r * j[i];
                }
            }
        }
        mirror(&mut seen.normal);
        seen
    }

    /// How many directions have a value.
    pub fn directions(&self) -> f64 {
        self.in_direction.iter().filter(|seen| **seen).count() as f64
    }
}

/// One direction over all bands.
#[derive(Clone)]
struct Cluster {
    /// Σ ω J r
    score: Vector,
    /// Σ ω J Jᵀ: its share of A
    information: Matrix,
    /// Σ ω² J Jᵀ r²/(1 − h): the variance of the score, were the bands independent
    scatter: Matrix,
    /// Σ r and Σ k_L r, for equal weights
    sums: [f64; 2],
    /// Σ h: what k_L takes of a residual
    taken: f64,
    values: f64,
}

pub(super) struct Clusters {
    clusters: Vec<Cluster>,
    /// Σ_λ √ω_v √ω_u J_λv r_λu of every pair of directions, where weights differ between bands
    cross: Vec<Vector>,
    /// Σ ω r²
    pub squares: f64,
}

impl Clusters {
    /// Residuals are those of the fit less J · `step`.
    pub fn new<'a>(
        problem: &Problem<'_>,
        free: &[bool; PARAMETERS],
        step: &Vector,
        bands: impl Iterator<Item = Band<'a>>,
    ) -> Self {
        let values = problem.values;
        let listed = list(free);
        let none = Cluster {
            score: [0.0; PARAMETERS],
            information: ZERO,
            scatter: ZERO,
            sums: [0.0; 2],
            taken: 0.0,
            values: 0.0,
        };
        let mut clusters = vec![none; values.len()];
        let mut cross = if problem.uniform { Vec::new() } else { vec![[0.0; PARAMETERS]; values.len() * values.len()] };
        let mut squares = 0.0;
        let mut rest = vec![0.0; values.len()];
        let mut slopes = vec![[0.0; PARAMETERS]; values.len()];
        for band in bands {
            let taken = leverage(values, &band);
            let s2: f64 = values.iter().zip(band.weight).map(|(value, w)| w * value.diffuse * value.diffuse).sum();
            for (v, (value, j)) in values.iter().zip(&mut slopes).enumerate() {
                *j = slope(value, &band, &taken, &listed);
                rest[v] = band.residual[v] - listed.iter().map(|&i| j[i] * step[i]).sum::<f64>();
            }
            for (v, cluster) in clusters.iter_mut().enumerate() {
                let (w, r, j) = (band.weight[v], rest[v], &slopes[v]);
                if !(w > 0.0) {
                    continue;
                }
                let diffuse = values[v].diffuse;
                let h = if s2 > 0.0 { w * diffuse * diffuse / s2 } else { 0.0 };
                squares += w * r * r;
                cluster.values += 1.0;
                cluster.taken += h;
                cluster.sums[0] += r;
                cluster.sums[1] += band.k_lambert * r;
                add_outer(&mut cluster.information, &listed, j, w);
                // a band of one value has h = 1 and leaves nothing but rounding
                add_outer(&mut cluster.scatter, &listed, j, w * w * r * r / (1.0 - h).max(1e-6));
                for &i in &listed {
                    cluster.score[i] += w * r * j[i];
                }
                let root = w.sqrt();
                for (u, sum) in cross.iter_mut().skip(v * values.len()).take(values.len()).enumerate() {
                    let scaled = band.weight[u].sqrt() * rest[u] * root;
                    for &i in &listed {
                        sum[i] += scaled * j[i];
                    }
                }
            }
        }
        for cluster in &mut clusters {
            mirror(&mut cluster.information);
            mirror(&mut cluster.scatter);
        }
        Clusters { clusters, cross, squares }
    }

    /// M with the same covariance between bands in all directions, on `nu` degrees of freedom.
    pub fn pooled(&self, problem: &Problem<'_>, first: Option<&Band<'_>>, nu: f64) -> Matrix {
        let mut pooled = ZERO;
        match first {
            Some(band) if problem.uniform => {
                let values = problem.values;
                let at = |k: f64| leverage(values, &Band { k_lambert: k, ..*band });
                let (alpha, with_one) = (at(0.0), at(1.0));
                let mut second = [[0.0; 2]; 2];
                for Cluster { sums, .. } in &self.clusters {
                    for a in 0..2 {
                        for b in 0..2 {
                            second[a][b] += sums[a] * sums[b];
                        }
                    }
                }
                for (value, w) in values.iter().zip(band.weight) {
                    let d: Vector = core::array::from_fn(|i| value.d_specular[i] - alpha[i] * value.diffuse);
                    let e: Vector =
                        core::array::from_fn(|i| value.d_diffuse[i] - (with_one[i] - alpha[i]) * value.diffuse);
                    for i in 0..PARAMETERS {
                        for k in 0..PARAMETERS {
                            pooled[i][k] += w
                                * w
                                * (d[i] * second[0][0] * d[k]
                                    + second[0][1] * (d[i] * e[k] + e[i] * d[k])
                                    + e[i] * second[1][1] * e[k]);
                        }
                    }
                }
            }
            _ => {
                for u in &self.cross {
                    for i in 0..PARAMETERS {
                        for k in 0..PARAMETERS {
                            pooled[i][k] += u[i] * u[k];
                        }
                    }
                }
            }
        }
        pooled.map(|row| row.map(|x| x / nu))
    }

    /// Variances of the free parameters, each direction having a size of its own.
    pub fn own(&self, inverse: &Matrix, root: &Root, free: &[bool; PARAMETERS], nu: f64) -> Vector {
        let seen = || self.clusters.iter().filter(|cluster| cluster.values > 0.0);
        let count = seen().count() as f64;
        let bands = seen().map(|cluster| cluster.values).sum::<f64>() / count.max(1.0);
        // how many times more the sum over bands scatters than independent bands would
        let inflation: Vector = core::array::from_fn(|i| {
            let (mut ratios, mut of) = (0.0, 0.0);
            for cluster in seen() {
                let scatter = form(&cluster.scatter, &inverse[i]);
                if free[i] && scatter > 0.0 {
                    ratios += dot(&cluster.score, &inverse[i]).powi(2) / scatter;
                    of += 1.0;
                }
            }
            (ratios / (of - (count - nu)).max(1.0)).clamp(1.0, bands.max(1.0))
        });
        let common = inflation.map(|f| if bands > 1.0 { (f - 1.0) / (bands - 1.0) } else { 1.0 });
        let (into, onto) = (product(inverse, &root.up), transposed(&root.down));
        let mut variance = [0.0; PARAMETERS];
        for cluster in seen() {
            // the direction's share in its own prediction
            let share = product(&product(&onto, &cluster.information), &root.down);
            let (share, axes) = eigen(&share);
            let scatter = product(&product(&onto, &cluster.scatter), &root.down);
            let scatter = product(&product(&transposed(&axes), &scatter), &axes);
            let reach = product(&into, &axes);
            let left = 1.0 - cluster.taken / cluster.values;
            for i in (0..PARAMETERS).filter(|&i| free[i]) {
                // a direction that alone decides a parameter leaves no residual to be judged by: no more than 20 times its own
                let given_back = |share: f64| (1.0 - common[i] * share / left.max(1e-6)).max(0.05).sqrt();
                let c: Vector = core::array::from_fn(|a| reach[i][a] / given_back(share[a]));
                variance[i] += inflation[i] * form(&scatter, &c);
            }
        }
        variance
    }
}
