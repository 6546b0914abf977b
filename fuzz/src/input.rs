//! Bytes → numbers: most of them inside a domain, many of those at its edges, some anything at all.

use arbitrary::Unstructured;

/// A source of structured values; after the last byte it yields zeros, so that any input is a whole case.
pub struct Input<'a>(Unstructured<'a>);

impl<'a> Input<'a> {
    /// Reads from `data`.
    pub fn new(data: &'a [u8]) -> Self {
        Input(Unstructured::new(data))
    }

    /// One byte.
    pub fn byte(&mut self) -> u8 {
        self.0.arbitrary().unwrap_or(0)
    }

    /// Any integer below `end` (0 where `end` is 0).
    pub fn below(&mut self, end: usize) -> usize {
        usize::from(self.byte()) % end.max(1)
    }

    /// A yes or no.
    pub fn flag(&mut self) -> bool {
        self.byte() & 1 == 1
    }

    /// Any number at all: NaN, infinities and subnormal numbers included.
    pub fn anything(&mut self) -> f64 {
        f64::from_bits(self.0.arbitrary().unwrap_or(0))
    }

    /// A number in [low, high]: one of the ends, close to one, or anywhere between, evenly or by its logarithm.
    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        let kind = self.byte();
        let fraction = f64::from(self.0.arbitrary::<u32>().unwrap_or(0)) / f64::from(u32::MAX);
        let near = 2.0_f64.powi(-i32::from(kind >> 3) * 2);
        let value = match kind % 8 {
            0 => low,
            1 => high,
            2 => low + (high - low) * near * fraction,
            3 => high - (high - low) * near * fraction,
            4 if low > 0.0 => low * (high / low).powf(fraction),
            _ => low + (high - low) * fraction,
        };
        value.clamp(low, high)
    }

    /// Mostly [`within`](Self::within), one time in sixteen [`anything`](Self::anything).
    pub fn around(&mut self, low: f64, high: f64) -> f64 {
        if self.byte() % 16 == 15 { self.anything() } else { self.within(low, high) }
    }

    /// All bytes that are left.
    pub fn rest(&mut self) -> &'a [u8] {
        self.0.bytes(self.0.len()).unwrap_or(&[])
    }
}
