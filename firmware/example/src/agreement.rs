//! The evaluations of `../c-example/agreement.c`, by the Rust interface of the crates: the same inputs, the same order, the same hash.

use leafbrdf_c::{
    LB_BOUSQUET_2005, LB_SLICE_BANDS, LB_SLICE_FIRST_NM, LB_SLICE_STEP_NM, lb_cab, lb_fit_cab, lb_interior, lb_leaf,
};
use leafbrdf_core::real::device::F32;
use leafbrdf_core::{
    Dielectric, DirectionCosines, DirectionTerms, DomainError, Geometry, Grade, Illumination, Index, Leaf,
    Normalization, Real, Surface,
};
use leafbrdf_fit::device::{self, Workspace};
use leafbrdf_fit::{Band, BandOptions, Directions};
use leafbrdf_prospect::table::TableD;
use leafbrdf_prospect::{Interface, plates};

/// Blocks of evaluations.
pub const BLOCKS: u32 = 16;
const POINTS: usize = 256;
const DIRECTIONS: usize = 41;

/// Takes a result: what it is of, which block, and the hash of the block's bits.
pub type Print<'a> = dyn FnMut(&str, u32, u32) + 'a;

/// Numerical Recipes' linear congruential generator; the low bits are its weak ones.
struct Random(u32);

impl Random {
    fn next(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        self.0 >> 8
    }

    fn below(&mut self, bound: u32, step: f32) -> f32 {
        (self.next() % bound.max(1)) as f32 * step
    }
}

/// FNV-1a.
struct Hash(u32);

impl Hash {
    fn new() -> Self {
        Hash(2_166_136_261)
    }

    fn word(&mut self, word: u32) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u32::from(byte)).wrapping_mul(16_777_619);
        }
    }

    fn float(&mut self, F32(value): F32) {
        self.word(if value.is_nan() { 0x7fc0_0000 } else { value.to_bits() });
    }

    /// A status of the C interface, and the value where there is one.
    fn value(&mut self, result: Result<F32, u32>) {
        match result {
            Ok(value) => {
                self.word(0);
                self.float(value);
            }
            Err(status) => self.word(status),
        }
    }

    fn values<const N: usize>(&mut self, result: Result<[F32; N], u32>) {
        match result {
            Ok(values) => values.into_iter().for_each(|value| self.value(Ok(value))),
            Err(status) => (0..N).for_each(|_| self.value(Err(status))),
        }
    }
}

/// The status that C has for a domain error.
fn status(error: DomainError) -> u32 {
    match error.parameter {
        "theta_s" => 2,
        "theta_v" => 3,
        "phi_v" | "cos_phi_v" => 4,
        "k_lambert" => 6,
        "n" => 7,
        _ => 8,
    }
}

/// A leaf, now and then an impossible one.
#[derive(Clone, Copy)]
struct Draw {
    k_lambert: f32,
    n: f32,
    sigma: f32,
    normalization: Normalization,
}

impl Draw {
    fn new(random: &mut Random) -> Self {
        Draw {
            k_lambert: random.below(1030, 1.0 / 1024.0),
            n: 1.0 + random.below(2048, 1.0 / 1024.0),
            sigma: random.below(1024, 1.0 / 1024.0),
            normalization: if random.next().is_multiple_of(2) {
                Normalization::Bousquet2005
            } else {
                Normalization::CookTorrance
            },
        }
    }

    fn surface(&self) -> Result<Surface<F32>, u32> {
        let surface = Surface::new(F32(self.n), F32(self.sigma)).map_err(status)?;
        Ok(surface.with_normalization(self.normalization))
    }

    fn leaf(&self) -> Result<Leaf<F32>, u32> {
        // k_L is named before the surface, as in C
        Leaf::new(F32(self.k_lambert), Surface::new(F32(1.0), F32(1.0)).map_err(status)?).map_err(status)?;
        Leaf::new(F32(self.k_lambert), self.surface()?).map_err(status)
    }
}

/// sin and cos of 2 atan(t), t = i/128.
fn pair(random: &mut Random) -> (F32, F32) {
    let t = random.below(128, 1.0 / 128.0);
    let t2 = t * t;
    (F32(2.0 * t / (1.0 + t2)), F32((1.0 - t2) / (1.0 + t2)))
}

fn cosines(random: &mut Random) -> DirectionCosines<F32> {
    let (sin_theta_s, cos_theta_s) = pair(random);
    let (sin_theta_v, cos_theta_v) = pair(random);
    let cos_phi_v = F32(random.below(2049, 1.0 / 1024.0) - 1.0);
    DirectionCosines { cos_theta_s, sin_theta_s, cos_theta_v, sin_theta_v, cos_phi_v }
}

/// k_L/π.
fn diffuse(leaf: &Leaf<F32>) -> F32 {
    leaf.k_lambert() * F32::lit(core::f64::consts::FRAC_1_PI)
}

/// k_L/π + BRDF_spec of a prepared direction.
fn brdf_at(leaf: &Leaf<F32>, terms: &DirectionTerms<F32>) -> F32 {
    let surface = leaf.surface();
    diffuse(leaf) + terms.brdf(surface.index(), surface.sigma())
}

fn points(random: &mut Random, block: u32, print: &mut Print<'_>) {
    let [mut brdf, mut gradients, mut by_degrees, mut directions, mut fresnel] = [(); 5].map(|()| Hash::new());
    for _ in 0..POINTS {
        let draw = Draw::new(random);
        let at = cosines(random);
        let theta_s = F32(random.below(5800, 1.0 / 64.0));
        let theta_v = F32(random.below(5800, 1.0 / 64.0));
        let phi_v = F32(random.below(11_521, 1.0 / 32.0));
        let cos_theta_a = F32(random.below(1025, 1.0 / 1024.0));

        let leaf = draw.leaf();
        brdf.value(leaf.and_then(|leaf| leaf.brdf_at_cosines(&at).map_err(status)));
        gradients.values(leaf.and_then(|leaf| {
            let gradient = leaf.brdf_with_gradient(&Geometry::from_cosines(at).map_err(status)?);
            Ok([gradient.value, gradient.d_k_lambert, gradient.d_n, gradient.d_sigma])
        }));
        by_degrees.value(leaf.and_then(|leaf| leaf.brdf_at_degrees(theta_s, theta_v, phi_v).map_err(status)));

        let terms = DirectionTerms::at_degrees(theta_s, theta_v, phi_v, draw.normalization).map_err(status);
        directions.values(terms.map(|terms| [terms.cos_theta_a, terms.tan2_alpha, terms.weight]));
        if let Ok(terms) = terms {
            directions.value(leaf.map(|leaf| brdf_at(&leaf, &terms)));
        }
        let index = Dielectric::new(F32(draw.n)).map_err(status);
        fresnel.value(index.map(|index| index.fresnel(cos_theta_a)));
    }
    let names = ["brdf", "gradient", "degrees", "direction", "fresnel"];
    for (name, hash) in names.into_iter().zip([brdf, gradients, by_degrees, directions, fresnel]) {
        print(name, block, hash.0);
    }
}

fn hemisphere(random: &mut Random, block: u32, print: &mut Print<'_>) {
    let mut hash = Hash::new();
    for _ in 0..8 {
        let draw = Draw::new(random);
        let source = Illumination::from_degrees(F32(random.below(5800, 1.0 / 64.0)));
        let dhrf = draw.surface().and_then(|surface| {
            let source = source.map_err(status)?;
            Ok(surface.dhrf(&source, Grade::E4d))
        });
        hash.value(dhrf);
    }
    print("dhrf", block, hash.0);
}

fn inversion(random: &mut Random, block: u32, print: &mut Print<'_>) {
    let mut hash = Hash::new();
    let mut draw = Draw::new(random);
    draw.k_lambert = if draw.k_lambert > 1.0 { 1.0 } else { draw.k_lambert };
    draw.sigma += 1.0 / 32.0;
    let leaf = draw.leaf();
    let mut terms = [[F32(0.0); DIRECTIONS]; 3];
    let (mut brdf, mut weight) = ([F32(0.0); DIRECTIONS], [F32(0.0); DIRECTIONS]);
    let [cos_theta_a, tan2_alpha, lobe] = &mut terms;
    let prepared = cos_theta_a.iter_mut().zip(tan2_alpha).zip(lobe);
    for (i, ((((c, t), l), brdf), weight)) in prepared.zip(&mut brdf).zip(&mut weight).enumerate() {
        let theta_s = F32(random.below(60, 1.0));
        let theta_v = F32(random.below(70, 1.0));
        let phi_v = F32(random.below(360, 1.0));
        let at = DirectionTerms::at_degrees(theta_s, theta_v, phi_v, Normalization::Bousquet2005);
        let Ok(at) = at else { continue };
        hash.word(0);
        (*c, *t, *l) = (at.cos_theta_a, at.tan2_alpha, at.weight);
        let value = leaf.map(|leaf| brdf_at(&leaf, &at));
        hash.value(value);
        // what an instrument adds
        *brdf = value.unwrap_or(F32(0.0)) + F32(random.below(64, 1.0 / 65536.0));
        *weight = F32(if i % 8 == 7 { 0.0 } else { 1.0 });
    }
    let [cos_theta_a, tan2_alpha, lobe] = &terms;
    let directions = Directions { cos_theta_a, tan2_alpha, weight: lobe };
    let band = Band { brdf: &brdf, weight: &weight };
    let mut workspace = Workspace::new();
    if let Ok(Some(fit)) = device::fit_band(directions, band, &BandOptions::table_3(), &mut workspace) {
        hash.values(Ok(fit.parameters));
        hash.values(Ok(fit.standard_errors.map(|error| error.unwrap_or(F32(f32::NAN)))));
        hash.value(Ok(fit.rmse));
        hash.word(fit.n_obs as u32);
        let [k_at, n_at, sigma_at] = fit.at_bound.map(|at| at as u32);
        hash.word(k_at | n_at << 2 | sigma_at << 4);
        hash.word(fit.iterations);
        hash.word(u32::from(fit.converged));
    }
    print("fit", block, hash.0);
}

fn interior(random: &mut Random, block: u32, print: &mut Print<'_>) {
    static SLICE: TableD<f32, { LB_SLICE_BANDS as usize }> =
        TableD::<f32, { LB_SLICE_BANDS as usize }>::cut::<LB_SLICE_FIRST_NM, LB_SLICE_STEP_NM>();
    let mut hash = Hash::new();
    let inside = lb_interior {
        n_struct: 1.0 + random.below(1024, 1.0 / 1024.0),
        cab: random.below(100, 1.0),
        car: random.below(20, 1.0),
        cant: random.below(4, 1.0),
        cbrown: random.below(8, 1.0 / 64.0),
        cw: random.below(32, 1.0 / 1024.0),
        cm: random.below(16, 1.0 / 1024.0),
    };
    let lb_interior { n_struct, cab, car, cant, cbrown, cw, cm } = inside;
    let mut k_lambert = [0.0; 8];
    let mut wavelengths = [0.0; 8];
    let mut places = k_lambert.iter_mut().zip(&mut wavelengths);
    hash.word(0);
    let view = SLICE.view();
    for band in 0..LB_SLICE_BANDS as usize {
        let Some(faces) = view.interface(band) else { continue };
        let faces = Interface { t_alpha: F32(faces.t_alpha), t_90: F32(faces.t_90), t_21: F32(faces.t_21) };
        let mut coefficients = view.coefficients().map(|column| F32(column.get(band).copied().unwrap_or(0.0)));
        let k_ab = coefficients.next().unwrap_or(F32(0.0));
        let mut k = F32(0.0);
        for (coefficient, content) in coefficients.zip([car, cant, cbrown, cw, cm]) {
            k += F32(content) * coefficient;
        }
        let optics = plates(faces, (k + F32(cab) * k_ab) / F32(n_struct), F32(n_struct));
        hash.float(optics.reflectance);
        hash.float(optics.transmittance);
        if band % 12 == 8
            && band >= 20
            && let Some((k_lambert, nm)) = places.next()
        {
            *k_lambert = optics.reflectance.0;
            *nm = (u32::from(LB_SLICE_FIRST_NM) + u32::from(LB_SLICE_STEP_NM) * band as u32) as f32;
        }
    }
    print("prospect", block, hash.0);

    let mut hash = Hash::new();
    let surface = lb_leaf { k_lambert: 0.0, n: 1.5, sigma: 0.25, normalization: LB_BOUSQUET_2005 };
    let mut cab = core::mem::MaybeUninit::<lb_cab>::zeroed();
    // SAFETY: two arrays of eight; `cab` is numbers, for which zero is a value
    let (status, cab) = unsafe {
        let status = lb_fit_cab(
            Some(&surface),
            wavelengths.as_ptr(),
            k_lambert.as_ptr(),
            8,
            Some(&inside),
            0.25,
            Some(&mut cab),
        );
        (status as u32, cab.assume_init())
    };
    for value in [cab.n_struct, cab.cab, cab.n_struct_se, cab.cab_se, cab.dhrf_specular, cab.rmse] {
        hash.value(if status == 0 { Ok(F32(value)) } else { Err(status) });
    }
    hash.word(cab.iterations);
    hash.word(cab.converged);
    print("cab", block, hash.0);
}

/// Everything.
pub fn agreement(print: &mut Print<'_>) {
    let mut random = Random(20_051);
    for block in 0..BLOCKS {
        points(&mut random, block, print);
        hemisphere(&mut random, block, print);
        inversion(&mut random, block, print);
        interior(&mut random, block, print);
    }
}
