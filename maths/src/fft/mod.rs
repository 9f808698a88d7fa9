//! Fourier transforms with the same bits on every system and processor.
//!
//! Libraries choose their algorithm by the processor, fuse multiplications where they can, and take their sines from
//! the system: each of these changes the last digit. Here, one algorithm is compiled for wider and narrower vectors.
//!
//! | module | contents |
//! |---|---|
//! | `passes` | butterflies of two to seven samples |
//! | `complex` | transforms of complex samples |
//! | `chirp` | those of lengths with larger prime factors |
//! | `real` | transforms of real samples, at half the cost |

mod chirp;
mod complex;
mod passes;
mod real;
#[cfg(test)]
mod tests;

pub use complex::ComplexTransform;
pub use num_complex::Complex64;
pub use real::RealTransform;

/// The complex number of a magnitude and an angle in radians.
pub fn polar(magnitude: f64, angle: f64) -> Complex64 {
    let (sin, cos) = crate::sin_cos(angle);
    Complex64::new(magnitude * cos, magnitude * sin)
}

/// The magnitude of a complex number.
pub fn magnitude(z: Complex64) -> f64 {
    crate::hypot(z.re, z.im)
}

/// e to the power of a complex number.
pub fn exp(z: Complex64) -> Complex64 {
    polar(crate::exp(z.re), z.im)
}

/// Room for complex samples, real and imaginary parts apart: vectors load either at once.
#[derive(Debug)]
struct Parts<'a> {
    re: &'a mut [f64],
    im: &'a mut [f64],
}

/// The width of vectors to compute with, found out once.
#[derive(Clone, Copy)]
struct Machine {
    /// Vectors of 256 bits, where the processor has them: strides of four samples fill those, and not wider ones.
    #[cfg(target_arch = "x86_64")]
    v3: Option<pulp::x86::V3>,
    other: pulp::Arch,
}

impl std::fmt::Debug for Machine {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str("Machine")
    }
}

impl Machine {
    fn best() -> Self {
        Self {
            #[cfg(target_arch = "x86_64")]
            v3: pulp::x86::V3::try_new(),
            other: pulp::Arch::new(),
        }
    }

    /// Does `work`, compiled for the vectors chosen. Nothing is fused: the bits are the same at any width.
    #[inline(always)]
    fn run<W: pulp::WithSimd>(self, work: W) -> W::Output {
        #[cfg(target_arch = "x86_64")]
        if let Some(v3) = self.v3 {
            return pulp::Simd::vectorize(v3, work);
        }
        self.other.dispatch(work)
    }
}
