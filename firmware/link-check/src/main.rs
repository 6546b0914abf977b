//! Calls the public interface of the no_std crates and prints every result, bit by bit.
//!
//! Built for a Cortex-M4F, the linked image must hold no panic and no allocator; run under QEMU, it must print what
//! the same program prints on the host: without fused multiply-add the results are the same to the last bit.

#![cfg_attr(target_os = "none", no_std, no_main)]

mod calls;
#[cfg(target_os = "none")]
mod device;

/// `name bits` in hexadecimal, a line.
fn print(write: fn(u8), name: &str, bits: u64) {
    for byte in name.bytes() {
        write(byte);
    }
    write(b' ');
    for nibble in (0..16).rev() {
        let digit = ((bits >> (4 * nibble)) & 0xF) as u8;
        write(if digit < 10 { b'0' + digit } else { b'a' + digit - 10 });
    }
    write(b'\n');
}

/// All calls, all results.
fn print_all(write: fn(u8)) {
    let mut print_one = |name: &str, bits: u64| print(write, name, bits);
    calls::single(&mut print_one);
    calls::double(&mut print_one);
    #[cfg(feature = "planted-panic")]
    calls::planted_panic(&mut print_one);
}

#[cfg(not(target_os = "none"))]
fn main() {
    use std::io::Write;
    print_all(|byte| std::io::stdout().write_all(&[byte]).expect("standard output takes a byte"));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All results, by name.
    fn results() -> Vec<(String, f64)> {
        let mut all = Vec::new();
        let mut keep = |name: &str, bits: u64| all.push((name.to_owned(), f64::from_bits(bits)));
        calls::single(&mut keep);
        calls::double(&mut keep);
        all
    }

    #[test]
    fn no_call_ends_in_an_error_and_every_result_is_finite() {
        let all = results();
        assert!(all.iter().all(|(name, value)| name != "error" && value.is_finite()), "{all:?}");
    }

    /// Laurel at 60° in the mirror direction, golden value of Eq. 10 with n = 1.22, σ = 0.078: the four number types
    /// give it, single precision to its 1e-5.
    #[test]
    fn the_mirror_peak_of_laurel_is_the_papers() {
        let n2 = 1.22_f64 * 1.22;
        let g = (n2 - 0.75).sqrt();
        let r_s = (g - 0.5) / (g + 0.5);
        let r_p = r_s * ((g + 0.5) * 0.5 - 1.0) / ((g - 0.5) * 0.5 + 1.0);
        let fresnel = 0.5 * (r_s * r_s + r_p * r_p);
        // F G / (2π² cos²θ σ²), G = 1 in the mirror direction at 60°
        let expected = fresnel / (2.0 * std::f64::consts::PI.powi(2) * 0.25 * 0.078 * 0.078);
        let mirrors: Vec<f64> = results().into_iter().filter(|(name, _)| name == "mirror").map(|r| r.1).collect();
        assert_eq!(mirrors.len(), 4);
        for mirror in mirrors {
            assert!((mirror / expected - 1.0).abs() < 1e-5, "{mirror} {expected}");
        }
    }
}
