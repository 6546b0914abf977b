//! The study in words and columns, for a terminal.

use std::fmt;

use super::bands::{BandsReport, DHRF_SOURCES_DEG, Recovery};
use super::paper::Statement;
use super::study::{Estimate, LeafStudy, Study};
use crate::simulate::Noise;

impl fmt::Display for Study {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.header(f)?;
        self.bands(f)?;
        self.five_parameters(f)?;
        self.hemispheres(f)?;
        self.statements(f)?;
        self.normalization(f)?;
        self.coverage(f)
    }
}

/// One line: a name and a cell for each leaf.
fn row(
    f: &mut fmt::Formatter<'_>,
    leaves: &[LeafStudy],
    name: &str,
    cell: impl Fn(&LeafStudy) -> String,
) -> fmt::Result {
    write!(f, "{name:<36}")?;
    leaves.iter().try_for_each(|leaf| write!(f, "{:>21}", cell(leaf)))?;
    writeln!(f)
}

fn with_error(Estimate { value, se }: Estimate, digits: usize) -> String {
    match se {
        Some(se) => format!("{value:.digits$} ± {se:.*}", digits + 1),
        None => format!("{value:.digits$}"),
    }
}

fn percent([n, sigma]: [f64; 2], digits: usize) -> String {
    format!("{n:.digits$} %, {sigma:.digits$} %")
}

impl Study {
    fn header(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (bands, values) = self.leaves.first().map_or((0, 0), |leaf| (leaf.bands.bands, leaf.bands.values));
        writeln!(f, "Three simulated leaves, measured and inverted as in Bousquet et al. (2005).")?;
        writeln!(f, "  model       BRDF = k_L/pi + BRDF_spec(n, sigma), normalization bousquet2005 (K = 2 pi^2)")?;
        writeln!(f, "  truth       n and sigma of Table 4; k_L from PROSPECT-D (Eq. 17), leaf contents ours")?;
        writeln!(
            f,
            "  goniometer  theta_s 8, 21, 41, 60 deg; 98 views each, 65 with theta_v <= 70 deg: {values} values a band"
        )?;
        let (relative, absolute) = (100.0 * Noise::RELATIVE, Noise::ABSOLUTE);
        writeln!(f, "  noise       {relative} % of the value and {absolute} sr^-1; {bands} bands, 480 to 879 nm")?;
        writeln!(f)?;
        row(f, &self.leaves, "", |leaf| leaf.name.to_string())
    }

    /// Table 4, the left column of Table 5, §4.3.
    fn bands(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let leaves = &self.leaves;
        for (p, name, digits) in [(1, "n", 4), (2, "sigma", 5)] {
            let recovery = |leaf: &LeafStudy| leaf.bands.recovery[p];
            row(f, leaves, &format!("{name}, true (Table 4)"), |leaf| format!("{}", leaf.surface_truth[p - 1]))?;
            row(f, leaves, &format!("{name}, mean of the bands ± s.e."), |leaf| {
                let Recovery { mean, mean_se, .. } = recovery(leaf);
                format!("{mean:.digits$} ± {mean_se:.*}", digits + 1)
            })?;
            row(f, leaves, "  error of a band (rms), its s.e.", |leaf| {
                let Recovery { rms_error, rms_se, .. } = recovery(leaf);
                format!("{rms_error:.digits$}, {rms_se:.digits$}")
            })?;
            row(f, leaves, &format!("{name}, one for the leaf"), |leaf| {
                with_error(leaf.surface.surface[p - 1], digits)
            })?;
        }
        row(f, leaves, "k_L, true, least to greatest", |leaf| {
            let [least, greatest] = leaf.bands.k_lambert_range;
            format!("{least:.3} to {greatest:.3}")
        })?;
        row(f, leaves, "  error of a band (rms), its s.e.", |leaf| {
            let Recovery { rms_error, rms_se, .. } = leaf.bands.recovery[0];
            format!("{rms_error:.5}, {rms_se:.5}")
        })?;
        row(f, leaves, "(max - min)/mean of n, sigma, VIS", |leaf| {
            percent(leaf.bands.invariance[0].map(|x| 100.0 * x), 1)
        })?;
        row(f, leaves, "  paper (4.3)", |leaf| percent(leaf.paper.vis_percent, 0))?;
        row(f, leaves, "(max - min)/mean of n, sigma, NIR", |leaf| {
            percent(leaf.bands.invariance[1].map(|x| 100.0 * x), 1)
        })?;
        writeln!(
            f,
            "  paper (4.3): larger, almost 25 % for hazel's n. The truth here varies not at all: this is noise."
        )?;
        row(f, leaves, "greatest BRDF, theta_s 60, 680 nm", |leaf| format!("{:.2}", leaf.bands.maximum))?;
        row(f, leaves, "  paper (3.2)", |leaf| format!("{}", leaf.paper.maximum))
    }

    /// §4.6 and Table 5.
    fn five_parameters(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let leaves = &self.leaves;
        writeln!(f, "\nFive parameters instead of 3 x 400 (4.6)")?;
        for (p, name, digits) in [(0, "N", 3), (1, "C_ab, ug/cm2", 2), (2, "C_m, g/cm2", 5)] {
            row(f, leaves, &format!("{name}, true"), |leaf| format!("{}", leaf.interior_truth[p]))?;
            row(f, leaves, "  two steps, as the paper", |leaf| with_error(leaf.two_step.interior[p], digits))?;
            row(f, leaves, "  all five at once (Eq. 18)", |leaf| with_error(leaf.joint.interior[p], digits))?;
        }
        row(f, leaves, "n, all five at once", |leaf| with_error(leaf.joint.surface[0], 4))?;
        row(f, leaves, "sigma, all five at once", |leaf| with_error(leaf.joint.surface[1], 5))?;
        row(f, leaves, "  starts that meet there", |leaf| {
            let [starts, agreeing] = leaf.joint.starts;
            format!("{agreeing} of {starts}")
        })?;
        row(f, leaves, "rmse of the fit, sr^-1", |leaf| format!("{:.2e}", leaf.bands.rmse))?;
        row(f, leaves, "  noise that was added", |leaf| format!("{:.2e}", leaf.bands.noise))?;
        row(f, leaves, "  paper, real leaves (Table 5)", |leaf| format!("{:.2e}", leaf.paper.rmse[0]))?;
        row(f, leaves, "rmse, five parameters: steps, at once", |leaf| {
            format!("{:.2e}, {:.2e}", leaf.two_step.rmse, leaf.joint.rmse)
        })?;
        row(f, leaves, "  paper, real leaves (Table 5)", |leaf| format!("{:.2e}", leaf.paper.rmse[1]))?;
        row(f, leaves, "ratio five/3 x 400: steps, at once", |leaf| {
            let [steps, once, _] = leaf.rmse_ratios();
            format!("{steps:.3}, {once:.3}")
        })?;
        row(f, leaves, "  paper, real leaves", |leaf| format!("{:.3}", leaf.rmse_ratios()[2]))?;
        if leaves.iter().all(|leaf| leaf.joint.starts[0] == leaf.joint.starts[1]) {
            writeln!(f, "  (at once: every start ends there. The paper's joint inversion was unstable.)")?;
        }
        Ok(())
    }

    /// §3.1, §4.4.
    fn hemispheres(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let leaves = &self.leaves;
        writeln!(f, "\nHemispherical reflectance (3.1, 4.4)")?;
        for (place, theta_s) in DHRF_SOURCES_DEG.iter().enumerate() {
            row(f, leaves, &format!("DHRF_spec at theta_s = {theta_s} deg"), |leaf| {
                format!("{:.4}", leaf.bands.dhrf_specular[place])
            })?;
        }
        row(f, leaves, "  at 21, 41, 60 deg / at 8 deg", |leaf| {
            let [first, rest @ ..] = leaf.bands.dhrf_specular;
            rest.map(|dhrf| format!("{:.2}", dhrf / first)).join(", ")
        })?;
        for place in 0..3 {
            let one = |leaf: &LeafStudy| leaf.integrated.get(place).copied();
            let Some(first) = leaves.first().and_then(one) else { continue };
            row(f, leaves, &format!("DHRF at 60 deg, {} nm, true", first.wavelength_nm), |leaf| {
                one(leaf).map_or_else(String::new, |one| format!("{:.3}", one.truth))
            })?;
            row(f, leaves, "  from the 98 views", |leaf| {
                one(leaf).map_or_else(String::new, |one| with_error(one.plain, 3))
            })?;
            row(f, leaves, "  lobe subtracted first", |leaf| {
                one(leaf).map_or_else(String::new, |one| with_error(one.subtracted, 3))
            })?;
            writeln!(f, "  paper, its laurel (3.1): about {}", first.paper_laurel)?;
        }
        writeln!(f, "  (laurel's peak is narrower than the views are apart: the plain integral is too large)")
    }

    fn statements(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "\nStatements of the paper, recomputed")?;
        for Statement { section, says, found, verdict, because } in self.sensitivity.iter().chain(&self.statements) {
            let found: Vec<String> = found.iter().map(|(label, value)| format!("{label} {value:.3}")).collect();
            writeln!(f, "  {section}  {says}")?;
            writeln!(f, "       found: {}", found.join(", "))?;
            writeln!(f, "       {}: {because}", verdict.name())?;
        }
        Ok(())
    }

    /// Which constant Eq. 10 was used with.
    fn normalization(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "\nEq. 10's constant: BRDF_spec of Table 4 at theta_s = theta_v = 60 deg, phi_v = 180 deg, sr^-1")?;
        for (place, name) in ["K = 2 pi^2, as printed", "K = 4 pi, as Eqs 5, 6, 9 give"].into_iter().enumerate() {
            write!(f, "  {name:<34}")?;
            self.mirror_brdf[place].iter().try_for_each(|value| write!(f, "{value:>21.2}"))?;
            writeln!(f)?;
        }
        row(f, &self.leaves, "  measured maximum, diffuse and all", |leaf| format!("{}", leaf.paper.maximum))?;
        writeln!(f, "  So Table 4 belongs to the printed constant, the default here.")
    }

    fn coverage(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f)?;
        writeln!(
            f,
            "Truth within one standard error: {:.1} % of {} (band, parameter) pairs; 68.3 % is right for Gaussian noise.",
            100.0 * self.covered(),
            self.leaves.iter().map(|leaf| 3 * leaf.bands.bands).sum::<usize>()
        )?;
        row(f, &self.leaves, "  for k_L, n, sigma, %", |leaf| {
            let BandsReport { recovery, .. } = &leaf.bands;
            recovery.map(|r| format!("{:.0}", 100.0 * r.covered)).join(", ")
        })?;
        writeln!(
            f,
            "Eq. 11 counts all values alike, though laurel's peak is noisier than the rest; how noisy each direction is, the errors know"
        )?;
        writeln!(f, "from the neighbouring bands. A long file with a column sd is weighted by 1/sd^2.")
    }
}
