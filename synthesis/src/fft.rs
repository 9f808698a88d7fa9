//! Fourier transforms: those of [`maths::fft`], whose bits do not depend on the processor.

pub use maths::fft::{Complex64, ComplexTransform, RealTransform, exp, magnitude, polar};
