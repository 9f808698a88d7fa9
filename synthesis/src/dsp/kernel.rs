//! The kernel that turns a simulation's steps into sound.

/// The cubic of Mitchell & Netravali (1988) with B = C = 1/3, and its derivative, at `x` steps from its middle; both are
/// zero from 2 steps on (Chadwick & James 2011, §3, eq. 9-10).
pub fn mitchell_netravali(x: f64) -> (f64, f64) {
    let (a, sign) = (x.abs(), x.signum());
    if a < 1.0 {
        ((21.0 * a * a * a - 36.0 * a * a + 16.0) / 18.0, sign * (63.0 * a * a - 72.0 * a) / 18.0)
    } else if a < 2.0 {
        ((-7.0 * a * a * a + 36.0 * a * a - 60.0 * a + 32.0) / 18.0, sign * (-21.0 * a * a + 72.0 * a - 60.0) / 18.0)
    } else {
        (0.0, 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The kernel's printed form for any B and C (Mitchell & Netravali 1988, eq. 8).
    fn printed(x: f64) -> f64 {
        let (b, c, a) = (1.0 / 3.0, 1.0 / 3.0, x.abs());
        let cubic = if a < 1.0 {
            (12.0 - 9.0 * b - 6.0 * c) * a.powi(3) + (-18.0 + 12.0 * b + 6.0 * c) * a.powi(2) + (6.0 - 2.0 * b)
        } else if a < 2.0 {
            (-b - 6.0 * c) * a.powi(3)
                + (6.0 * b + 30.0 * c) * a.powi(2)
                + (-12.0 * b - 48.0 * c) * a
                + 8.0 * b
                + 24.0 * c
        } else {
            0.0
        };
        cubic / 6.0
    }

    #[test]
    fn kernel_is_the_printed_one_and_its_slopes_are_its_own() {
        for step in -2500..=2500 {
            let x = f64::from(step) / 1000.0;
            let (value, slope) = mitchell_netravali(x);
            assert!((value - printed(x)).abs() < 1e-14, "{x}");
            let difference = (printed(x + 1e-6) - printed(x - 1e-6)) / 2e-6;
            assert!((slope - difference).abs() < 1e-5, "{x}: {slope} {difference}");
        }
    }

    #[test]
    fn kernels_add_up_to_one_and_their_slopes_to_nothing() {
        for step in 0..1000 {
            let x = f64::from(step) / 1000.0;
            let sums = (-3..=3).map(|tap| mitchell_netravali(x - f64::from(tap)));
            let (value, slope) = sums.fold((0.0, 0.0), |sum, tap| (sum.0 + tap.0, sum.1 + tap.1));
            assert!((value - 1.0).abs() < 1e-14 && slope.abs() < 1e-14, "{x}: {value} {slope}");
        }
    }
}
