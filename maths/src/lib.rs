#![doc = include_str!("../README.md")]

pub mod fft;

/// The floating-point types of the functions: `f32` and `f64`.
pub trait Real: private::Functions {}

impl Real for f32 {}
impl Real for f64 {}

/// Defines the public functions, and the trait behind them for both types.
macro_rules! functions {
    ($($(#[$doc:meta])* fn $name:ident($($argument:ident),+) = $double:ident, $single:ident;)*) => {
        $(
            $(#[$doc])*
            #[inline]
            pub fn $name<T: Real>($($argument: T),+) -> T {
                T::$name($($argument),+)
            }
        )*

        mod private {
            use std::ops::{Div, Mul};

            /// The functions of one type, out of reach of other crates.
            pub trait Functions: Copy + Mul<Output = Self> + Div<Output = Self> {
                const ONE: Self;
                fn sin_cos(self) -> (Self, Self);
                $(fn $name($($argument: Self),+) -> Self;)*
            }

            impl Functions for f64 {
                const ONE: Self = 1.0;

                #[inline]
                fn sin_cos(self) -> (Self, Self) {
                    libm::sincos(self)
                }

                $(
                    #[inline]
                    fn $name($($argument: Self),+) -> Self {
                        libm::$double($($argument),+)
                    }
                )*
            }

            impl Functions for f32 {
                const ONE: Self = 1.0;

                #[inline]
                fn sin_cos(self) -> (Self, Self) {
                    libm::sincosf(self)
                }

                $(
                    #[inline]
                    fn $name($($argument: Self),+) -> Self {
                        libm::$single($($argument),+)
                    }
                )*
            }
        }
    };
}

functions! {
    /// The sine of an angle in radians.
    fn sin(x) = sin, sinf;
    /// The cosine of an angle in radians.
    fn cos(x) = cos, cosf;
    /// The tangent of an angle in radians.
    fn tan(x) = tan, tanf;
    /// The angle in radians, -π/2..=π/2, whose sine is `x`; not a number beyond ±1.
    fn asin(x) = asin, asinf;
    /// The hyperbolic tangent.
    fn tanh(x) = tanh, tanhf;
    /// e to the power `x`.
    fn exp(x) = exp, expf;
    /// 2 to the power `x`.
    fn exp2(x) = exp2, exp2f;
    /// `exp(x) - 1`, exact near 0.
    fn exp_m1(x) = expm1, expm1f;
    /// The natural logarithm.
    fn ln(x) = log, logf;
    /// `ln(1 + x)`, exact near 0.
    fn ln_1p(x) = log1p, log1pf;
    /// The logarithm to base 2.
    fn log2(x) = log2, log2f;
    /// The logarithm to base 10.
    fn log10(x) = log10, log10f;
    /// `x` to the power `y`.
    fn pow(x, y) = pow, powf;
    /// The cube root.
    fn cbrt(x) = cbrt, cbrtf;
    /// The length of the hypotenuse over `x` and `y`, without intermediate overflow.
    fn hypot(x, y) = hypot, hypotf;
}

/// Sine and cosine of an angle in radians.
#[inline]
pub fn sin_cos<T: Real>(x: T) -> (T, T) {
    x.sin_cos()
}

/// `x` times itself.
#[inline]
pub fn square<T: Real>(x: T) -> T {
    x * x
}

/// `x` to an integer power, by squaring. The compiler's own function may round differently if it knows both numbers.
#[inline]
pub fn powi<T: Real>(x: T, n: i32) -> T {
    let (mut power, mut square, mut left) = (T::ONE, x, n.unsigned_abs());
    loop {
        if left & 1 == 1 {
            power = power * square;
        }
        left >>= 1;
        if left == 0 {
            break;
        }
        square = square * square;
    }
    if n < 0 { T::ONE / power } else { power }
}

#[cfg(test)]
mod tests;
