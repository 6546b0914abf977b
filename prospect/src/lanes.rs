//! Which arithmetic a loop over bands uses: plain operations that vectorise, with the same bits on every machine.

use leafbrdf_core::Real;

/// A number that spectra are stored in, and the arithmetic that evaluates them.
///
/// `f64` and `f32` are evaluated as [`Portable`](leafbrdf_core::Portable) numbers: exponential and logarithm are plain
/// arithmetic, so that the compiler puts bands side by side in SIMD registers, and every instruction set gives the same
/// bits. Another number type may name itself as its `Lane`.
pub trait Lanes: Real {
    /// The type that computes.
    type Lane: Real;
    /// Into the computing type; no change of value.
    fn into_lane(self) -> Self::Lane;
    /// Back again.
    fn from_lane(lane: Self::Lane) -> Self;
}

#[cfg(any(feature = "std", feature = "libm"))]
mod portable {
    use super::Lanes;
    use leafbrdf_core::Portable;

    impl Lanes for f64 {
        type Lane = Portable<f64>;
        #[inline(always)]
        fn into_lane(self) -> Portable<f64> {
            Portable(self)
        }
        #[inline(always)]
        fn from_lane(lane: Portable<f64>) -> f64 {
            lane.0
        }
    }

    impl Lanes for f32 {
        type Lane = Portable<f32>;
        #[inline(always)]
        fn into_lane(self) -> Portable<f32> {
            Portable(self)
        }
        #[inline(always)]
        fn from_lane(lane: Portable<f32>) -> f32 {
            lane.0
        }
    }
}

/// A loop over bands that may be compiled for several instruction sets.
///
/// `run` and everything it calls must be `#[inline(always)]`, or the wider registers are not used.
pub(crate) trait Task {
    fn run(self);
}

/// Runs a task with the widest instruction set of this machine (AVX-512, AVX2, or the build's own).
#[cfg(feature = "std")]
#[inline]
pub(crate) fn widest(task: impl Task) {
    struct OnSimd<K>(K);
    impl<K: Task> pulp::WithSimd for OnSimd<K> {
        type Output = ();
        #[inline(always)]
        fn with_simd<S: pulp::Simd>(self, _simd: S) {
            self.0.run();
        }
    }
    pulp::Arch::new().dispatch(OnSimd(task));
}

/// Without `std` there is no way to ask the machine: the build's own instruction set.
#[cfg(not(feature = "std"))]
#[inline]
pub(crate) fn widest(task: impl Task) {
    task.run();
}
