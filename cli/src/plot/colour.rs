//! The colour scale of maps: our own, from dark violet-blue over green to pale yellow, with even steps of lightness.
//!
//! Made in OKLab (Ottosson 2020, bottosson.github.io/posts/oklab), whose L is perceived lightness: L rises linearly from 0.22 to
//! 0.97 while the hue turns from blue (285°) to yellow (105°). Order is carried by lightness alone, so it survives
//! grey print and every kind of colour vision.

/// Lightness at both ends.
const LIGHTNESS: [f64; 2] = [0.22, 0.97];
/// Hue at both ends, degrees.
const HUE_DEG: [f64; 2] = [285.0, 105.0];
/// The most chroma that is asked for; less where the screen has no such colour.
const CHROMA: f64 = 0.15;

/// The colour of a part of the scale, 0 to 1, as sRGB.
pub fn scale(part: f64) -> [u8; 3] {
    let part = part.clamp(0.0, 1.0);
    let between = |[from, to]: [f64; 2]| from + part * (to - from);
    let (sin_hue, cos_hue) = between(HUE_DEG).to_radians().sin_cos();
    let lightness = between(LIGHTNESS);
    // the greatest chroma up to CHROMA that sRGB holds, by bisection
    let rgb = |chroma: f64| linear_rgb([lightness, chroma * cos_hue, chroma * sin_hue]);
    let holds = |chroma: f64| rgb(chroma).iter().all(|channel| (0.0..=1.0).contains(channel));
    let (mut inside, mut outside) = (0.0, CHROMA);
    if holds(outside) {
        inside = outside;
    }
    for _ in 0..30 {
        let middle = 0.5 * (inside + outside);
        if holds(middle) {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    rgb(inside).map(|channel| (255.0 * gamma(channel.clamp(0.0, 1.0))).round() as u8)
}

/// `#rrggbb` of a part of the scale, 0 to 1.
pub fn hex(part: f64) -> String {
    let [r, g, b] = scale(part);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// OKLab → linear sRGB; the matrices are Ottosson's.
fn linear_rgb([l, a, b]: [f64; 3]) -> [f64; 3] {
    let cones = [
        l + 0.3963377774 * a + 0.2158037573 * b,
        l - 0.1055613458 * a - 0.0638541728 * b,
        l - 0.0894841775 * a - 1.2914855480 * b,
    ];
    let [l, m, s] = cones.map(|cone| cone * cone * cone);
    [
        4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
        -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
        -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s,
    ]
}

/// The sRGB transfer function (IEC 61966-2-1).
fn gamma(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// OKLab's L of an sRGB colour: the way back, with Ottosson's inverse matrices.
    fn lightness(rgb: [u8; 3]) -> f64 {
        let [r, g, b] = rgb.map(|channel| {
            let channel = f64::from(channel) / 255.0;
            if channel <= 0.04045 { channel / 12.92 } else { ((channel + 0.055) / 1.055).powf(2.4) }
        });
        let l = 0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b;
        let m = 0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b;
        let s = 0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b;
        0.2104542553 * l.cbrt() + 0.7936177850 * m.cbrt() - 0.0040720468 * s.cbrt()
    }

    #[test]
    fn lightness_rises_all_the_way_in_even_steps() {
        let steps: Vec<f64> = (0..=100).map(|i| lightness(scale(f64::from(i) / 100.0))).collect();
        for (place, pair) in steps.windows(2).enumerate() {
            let step = pair[1] - pair[0];
            // 0.75/100 each; a channel of 8 bits is good to about 0.002 of lightness
            assert!(step > 0.003 && step < 0.012, "step {place}: {step}");
        }
        assert!((steps[0] - 0.22).abs() < 0.003 && (steps[100] - 0.97).abs() < 0.003, "{steps:?}");
    }

    #[test]
    fn the_ends_are_dark_blue_and_pale_yellow() {
        let ([r0, _, b0], [r1, g1, b1]) = (scale(0.0), scale(1.0));
        assert!(b0 > r0 && r1 > b1 && g1 > b1);
        assert_eq!(scale(-1.0), scale(0.0));
        assert_eq!(scale(7.0), scale(1.0));
    }
}
