//! The band solver on arbitrary data and bounds: what it returns is finite, inside the bounds, no worse than any start,
//! what it says it is, and the same every time.

use leafbrdf_core::{Angle, DirectionTerms, Geometry, Normalization, Real, Surface};
use leafbrdf_fit::band::scan::{GridSize, Scan, ScanTable};
use leafbrdf_fit::{
    AtBound, Band, BandBounds, BandFit, BandOptions, BandSolver, Directions, Identifiability, Interval,
    LeafBandsOptions, LeafData, Start, fit_bands,
};

use crate::Input;

/// A whole leaf by `fit_bands` in double precision, and its first band by a single-precision solver without vectors, as on
/// a device.
pub fn bands(data: &[u8]) {
    let case = Case::read(&mut Input::new(data));
    whole_leaf(&case);
    on_a_device(&case, None);
    on_a_device(&case, Some(GridSize { sigma: 5, n: 4 }));
}

/// One leaf's problem.
struct Case {
    geometries: Vec<Geometry<f64>>,
    brdf: Vec<f64>,
    sd: Option<Vec<f64>>,
    options: LeafBandsOptions,
}

impl Case {
    fn read(input: &mut Input<'_>) -> Self {
        let normalization = if input.flag() { Normalization::CookTorrance } else { Normalization::Bousquet2005 };
        let mut band = BandOptions::table_3();
        if input.flag() {
            band.bounds = BandBounds {
                k_lambert: interval(input, -1.0, 2.0),
                n: interval(input, 1.0001, 100.0),
                sigma: interval(input, 1e-4, 10.0),
            };
        }
        band.starts = input.below(5);
        let starts = (0..input.below(3))
            .map(|_| Start { n: input.within(1.0001, 100.0), sigma: input.within(1e-4, 10.0) })
            .collect();
        let robust = input.byte() % 8 == 7;

        let directions = 1 + input.below(12);
        let geometries: Vec<_> = (0..directions).map(|_| geometry(input)).collect();
        // a leaf that the model can make, as the ground on which the data are laid
        let surface = Surface::new(input.within(1.0, 5.0), input.within(0.01, 2.0)).expect("inside");
        let truth = surface.with_normalization(normalization);
        let k_lambert = input.within(0.0, 1.0);
        let noise = input.within(0.0, 1.0);
        let bands = 1 + input.below(2);
        let brdf = (0..bands)
            .flat_map(|_| geometries.iter())
            .map(|geometry| {
                let leaf = k_lambert * core::f64::consts::FRAC_1_PI + truth.brdf(geometry);
                match input.byte() {
                    0 => f64::NAN,
                    1 => input.within(-1e6, 1e6),
                    2 => input.anything(),
                    byte => leaf + noise * (f64::from(byte) / 255.0 - 0.5),
                }
            })
            .collect::<Vec<f64>>();
        let sd = input.flag().then(|| brdf.iter().map(|_| input.around(1e-6, 10.0)).collect());
        let options = LeafBandsOptions { normalization, band, grid: GridSize { sigma: 8, n: 6 }, starts, robust };
        Case { geometries, brdf, sd, options }
    }

    /// The bands, value by value.
    fn bands(&self) -> impl Iterator<Item = (usize, &[f64])> {
        self.brdf.chunks_exact(self.geometries.len()).enumerate()
    }

    /// ω of a value.
    fn weight(&self, band: usize, direction: usize) -> f64 {
        let place = band * self.geometries.len() + direction;
        if self.brdf[place].is_nan() { 0.0 } else { self.sd.as_ref().map_or(1.0, |sd| 1.0 / (sd[place] * sd[place])) }
    }

    /// What must be refused: infinite values, an sd that is no positive number or whose square has no inverse, bounds that
    /// are no box of the domain.
    fn is_valid(&self) -> bool {
        let usable = |sd: f64| sd > 0.0 && sd.is_finite() && (1.0 / (sd * sd)).is_finite();
        let sd_of = |place: usize| self.sd.as_ref().map_or(1.0, |sd| sd[place]);
        let mut values = self.brdf.iter().enumerate().filter(|(_, y)| !y.is_nan());
        self.options.band.bounds.check().is_ok() && values.all(|(place, y)| y.is_finite() && usable(sd_of(place)))
    }

    /// Can sums of squares be formed in this range of numbers? Beyond, only bounds and the absence of panics are asked for.
    fn is_moderate(&self, largest: f64) -> bool {
        let sd = self.sd.iter().flatten();
        self.brdf.iter().all(|y| y.is_nan() || y.abs() < largest)
            && sd.into_iter().all(|sd| *sd > 1.0 / largest && *sd < largest)
    }

    /// χ² of one band at given parameters, straight from Eqs 3, 10 and 11.
    fn chi2(&self, band: usize, parameters: [f64; 3]) -> f64 {
        let [k_lambert, n, sigma] = parameters;
        let surface = Surface::new(n, sigma).expect("inside the bounds, so inside the domain");
        let surface = surface.with_normalization(self.options.normalization);
        let values = self.brdf.chunks_exact(self.geometries.len()).nth(band).expect("a band of the leaf");
        let residuals = values.iter().zip(&self.geometries).enumerate().filter(|(_, (y, _))| !y.is_nan());
        residuals
            .map(|(i, (y, geometry))| {
                let residual = y - k_lambert * core::f64::consts::FRAC_1_PI - surface.brdf(geometry);
                self.weight(band, i) * residual * residual
            })
            .sum()
    }

    /// χ² at (n, σ) with the best k_L inside its bounds, and that k_L.
    fn profile(&self, band: usize, n: f64, sigma: f64) -> f64 {
        let surface = Surface::new(n, sigma).expect("inside").with_normalization(self.options.normalization);
        let values = self.brdf.chunks_exact(self.geometries.len()).nth(band).expect("a band of the leaf");
        let (mut sum, mut weights) = (0.0, 0.0);
        for (i, (y, geometry)) in values.iter().zip(&self.geometries).enumerate().filter(|(_, (y, _))| !y.is_nan()) {
            let weight = self.weight(band, i);
            sum += weight * (y - surface.brdf(geometry));
            weights += weight;
        }
        let bounds = self.options.band.bounds.k_lambert;
        let k_lambert = (core::f64::consts::PI * sum / weights).clamp(bounds.lower, bounds.upper);
        self.chi2(band, [k_lambert, n, sigma])
    }

    /// Rounding of χ²: 10⁻⁹ of it, and what the sum of the squares of the numbers that cancel in it leaves in `f64`.
    fn slack(&self, band: usize, chi2: f64, parameters: [f64; 3]) -> f64 {
        let [k_lambert, n, sigma] = parameters;
        let surface = Surface::new(n, sigma).expect("inside").with_normalization(self.options.normalization);
        let values = self.brdf.chunks_exact(self.geometries.len()).nth(band).expect("a band of the leaf");
        let squares: f64 = values
            .iter()
            .zip(&self.geometries)
            .enumerate()
            .filter(|(_, (y, _))| !y.is_nan())
            .map(|(i, (y, geometry))| {
                let size = y.abs() + k_lambert.abs() + surface.brdf(geometry);
                self.weight(band, i) * size * size
            })
            .sum();
        1e-9 * chi2 + 1e-12 * squares
    }
}

/// Mostly two numbers in order inside [low, high], sometimes anything.
fn interval(input: &mut Input<'_>, low: f64, high: f64) -> Interval<f64> {
    let (a, b) = (input.around(low, high), input.around(low, high));
    if input.byte() % 16 == 15 { Interval::new(a, b) } else { Interval::new(a.min(b), a.max(b)) }
}

fn geometry(input: &mut Input<'_>) -> Geometry<f64> {
    let mut angle = |low, high| Angle::from_degrees(input.within(low, high));
    Geometry::from_angles(angle(0.0, 89.9), angle(0.0, 89.9), angle(-360.0, 360.0)).expect("inside")
}

fn whole_leaf(case: &Case) {
    let fit = || {
        let data = LeafData { geometries: &case.geometries, brdf: &case.brdf, sd: case.sd.as_deref() };
        fit_bands(&data, &case.options, &|_| {})
    };
    let results = fit();
    assert_eq!(results.is_ok(), case.is_valid(), "{results:?}");
    let Ok(results) = results else { return };
    assert_eq!(format!("{results:?}"), format!("{:?}", fit().expect("it could be fitted before")), "twice the same");

    assert_eq!(results.len(), case.bands().count(), "one result a band");
    for ((band, values), result) in case.bands().zip(&results) {
        // an sd beyond 1e154 leaves no weight
        let counted = (0..values.len()).filter(|i| case.weight(band, *i) > 0.0).count();
        // where χ² overflows there may be none either
        assert!(result.is_none() || counted >= 3, "a fit of {counted} values");
        assert!(result.is_some() || counted < 3 || !case.is_moderate(1e7), "no fit of {counted} values");
        let Some(fit) = result else { continue };
        // Huber's weight of a far outlier may underflow
        assert!(
            fit.n_obs == counted || (case.options.robust && fit.n_obs < counted),
            "{counted} values count: {fit:?}"
        );
        inside(fit, &case.options.band.bounds);
        // Huber's loss has weights of its own
        if !case.options.robust && case.is_moderate(1e7) {
            honest(case, band, fit);
        }
    }
}

/// Inside the bounds, at them where it says so, and with errors that mean something.
fn inside<T: Real>(fit: &BandFit<T>, bounds: &BandBounds<T>) {
    let intervals = [bounds.k_lambert, bounds.n, bounds.sigma];
    for (i, interval) in intervals.iter().enumerate() {
        let value = fit.parameters[i];
        assert!(value >= interval.lower && value <= interval.upper, "{value:?} outside {interval:?} in {fit:?}");
        match fit.at_bound[i] {
            AtBound::Free => {}
            AtBound::Lower => assert!(value == interval.lower, "{fit:?}"),
            AtBound::Upper => assert!(value == interval.upper, "{fit:?}"),
        }
        assert_eq!(fit.at_bound[i] != AtBound::Free, fit.identifiability[i] == Identifiability::Held, "{fit:?}");
        let identified = fit.identifiability[i] == Identifiability::Identified;
        assert_eq!(fit.standard_errors[i].is_some(), identified, "an error, or the reason why not: {fit:?}");
        if let Some(error) = fit.standard_errors[i] {
            assert!(error >= T::ZERO && error.is_finite(), "{fit:?}");
        }
    }
}

/// χ² is what the parameters give, and no start is better.
fn honest(case: &Case, band: usize, fit: &BandFit<f64>) {
    let chi2 = case.chi2(band, fit.parameters);
    let slack = case.slack(band, chi2, fit.parameters);
    assert!((fit.chi2 - chi2).abs() <= slack, "χ² = {} said, {chi2} found, in {fit:?}", fit.chi2);
    if let Some(second) = fit.second {
        assert!(second.chi2 >= fit.chi2, "the second valley is lower: {fit:?}");
    }
    let BandBounds { n, sigma, .. } = case.options.band.bounds;
    for start in &case.options.starts {
        let (n, sigma) = (start.n.clamp(n.lower, n.upper), start.sigma.clamp(sigma.lower, sigma.upper));
        let at_start = case.profile(band, n, sigma);
        let slack = slack + case.slack(band, at_start, [fit.parameters[0], n, sigma]);
        assert!(fit.chi2 <= at_start + slack, "started at χ² = {at_start}, ended at {fit:?}");
    }
    for correlation in fit.correlations.into_iter().flatten() {
        assert!(correlation.abs() <= 1.0 + 1e-6, "{fit:?}");
    }
}

/// Single precision, one lane, memory of the caller's: the first band.
fn on_a_device(case: &Case, grid: Option<GridSize>) {
    let single = |x: f64| x as f32;
    let terms: Vec<DirectionTerms<f64>> =
        case.geometries.iter().map(|g| DirectionTerms::new(g, case.options.normalization)).collect();
    let cos_theta_a: Vec<f32> = terms.iter().map(|t| single(t.cos_theta_a)).collect();
    let tan2_alpha: Vec<f32> = terms.iter().map(|t| single(t.tan2_alpha)).collect();
    let lobe_weight: Vec<f32> = terms.iter().map(|t| single(t.weight)).collect();
    let directions = Directions { cos_theta_a: &cos_theta_a, tan2_alpha: &tan2_alpha, weight: &lobe_weight };
    let (_, values) = case.bands().next().expect("at least one band");
    let missing = |y: &f64| y.is_nan();
    let brdf: Vec<f32> = values.iter().map(|y| if missing(y) { 0.0 } else { single(*y) }).collect();
    let weight: Vec<f32> = (0..values.len()).map(|i| single(case.weight(0, i))).collect();

    let interval = |x: Interval<f64>| Interval::new(single(x.lower), single(x.upper));
    let double = case.options.band.bounds;
    let bounds =
        BandBounds { k_lambert: interval(double.k_lambert), n: interval(double.n), sigma: interval(double.sigma) };
    let options = BandOptions { bounds, starts: case.options.band.starts, ..BandOptions::table_3() };
    let starts: Vec<Start<f32>> =
        case.options.starts.iter().map(|s| Start { n: single(s.n), sigma: single(s.sigma) }).collect();

    let mut workspace = vec![0.0; grid.map_or(0, |grid| grid.workspace(values.len()))];
    let mut cost = vec![0.0; grid.map_or(0, GridSize::points)];
    let scan = grid.filter(|_| bounds.check().is_ok()).and_then(|grid| {
        let table = ScanTable::new(grid, bounds, directions, values.len(), &mut workspace)?;
        Scan::new(table, &mut cost)
    });
    let scans = scan.is_some();
    let Ok(mut solver) = BandSolver::<f32, 1>::new(directions, options, scan) else {
        assert!(bounds.check().is_err(), "bounds refused that check accepts");
        return;
    };
    let band = Band { brdf: &brdf, weight: &weight };
    let result = solver.fit(band, &starts);
    let numbers = brdf.iter().chain(&weight).all(|x| x.is_finite());
    assert_eq!(result.is_ok(), numbers, "{result:?}");
    let Ok(result) = result else { return };
    assert_eq!(format!("{result:?}"), format!("{:?}", solver.fit(band, &starts).expect("as before")), "twice the same");
    let counted = weight.iter().filter(|w| **w > 0.0).count();
    let searched = counted >= 3 && (scans || !starts.is_empty());
    assert!(result.is_none() || searched, "a fit of {counted} values");
    assert!(result.is_some() || !searched || !case.is_moderate(1e7), "no fit of {counted} values");
    if let Some(fit) = result {
        inside(&fit, &bounds);
    }
}
