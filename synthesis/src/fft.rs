//! Fourier transforms: [`maths::fft`]'s for what is heard, and plans of a library for what is measured or drawn.
//!
//! `rustfft` is generic: a crate that plans a transform by itself compiles all of the library's algorithms again, which takes
//! half a minute. What is planned here is compiled once. Its bits depend on the processor.

use std::sync::Arc;

pub use maths::fft::{ComplexTransform, RealTransform, exp, magnitude, polar};
pub use realfft::{ComplexToReal, RealToComplex};
use realfft::{RealFftPlanner, num_complex};
pub use rustfft::Fft;
use rustfft::FftPlanner;

pub use num_complex::{Complex32, Complex64};

/// A forward transform of `len` complex samples, any number of them, unscaled; for measurements.
pub fn forward(len: usize) -> Arc<dyn Fft<f64>> {
    FftPlanner::new().plan_fft_forward(len)
}

/// An inverse transform to `len` complex samples, unscaled: after [`forward`] it gives `len` times the signal.
pub fn inverse(len: usize) -> Arc<dyn Fft<f64>> {
    FftPlanner::new().plan_fft_inverse(len)
}

/// A forward transform of `len` real samples to the bins 0..=len/2, unscaled; for measurements.
pub fn real_forward(len: usize) -> Arc<dyn RealToComplex<f64>> {
    RealFftPlanner::new().plan_fft_forward(len)
}

/// An inverse transform from the bins 0..=len/2 to `len` real samples, unscaled; for measurements.
pub fn real_inverse(len: usize) -> Arc<dyn ComplexToReal<f64>> {
    RealFftPlanner::new().plan_fft_inverse(len)
}

/// [`real_forward`] in single precision: half the time, for what is only drawn.
pub fn real_forward_f32(len: usize) -> Arc<dyn RealToComplex<f32>> {
    RealFftPlanner::new().plan_fft_forward(len)
}
