//! Accuracy against the system's functions, and bits that must be the same on every machine.

/// Numbers over many magnitudes, positive and negative.
fn numbers() -> impl Iterator<Item = f64> {
    (-400..=400).map(|n| f64::from(n) * 0.0371).flat_map(|x| [x, x * x * x, x * 1e-6])
}

/// True if two numbers are the same up to a few units of the last place.
fn close(found: f64, expected: f64) -> bool {
    found == expected
        || (found - expected).abs() <= 4.0 * f64::EPSILON * expected.abs()
        || (found.is_nan() && expected.is_nan())
}

#[test]
fn functions_of_one_number_are_those_of_the_system_but_for_the_last_place() {
    type Pair = (&'static str, fn(f64) -> f64, fn(f64) -> f64);
    let pairs: [Pair; 14] = [
        ("sin", super::sin, f64::sin),
        ("cos", super::cos, f64::cos),
        ("tan", super::tan, f64::tan),
        ("asin", super::asin, f64::asin),
        ("tanh", super::tanh, f64::tanh),
        ("exp", super::exp, f64::exp),
        ("exp2", super::exp2, f64::exp2),
        ("exp_m1", super::exp_m1, f64::exp_m1),
        ("ln", super::ln, f64::ln),
        ("ln_1p", super::ln_1p, f64::ln_1p),
        ("log2", super::log2, f64::log2),
        ("log10", super::log10, f64::log10),
        ("cbrt", super::cbrt, f64::cbrt),
        ("sin_cos", |x| super::sin_cos(x).0, f64::sin),
    ];
    for (name, ours, system) in pairs {
        for x in numbers() {
            assert!(close(ours(x), system(x)), "{name}({x}): {} instead of {}", ours(x), system(x));
        }
    }
}

#[test]
fn functions_of_two_numbers_are_those_of_the_system_but_for_the_last_place() {
    for (x, y) in numbers().zip(numbers().skip(7)) {
        let x = x.abs();
        assert!(close(super::pow(x, y), x.powf(y)), "pow({x}, {y})");
        assert!(close(super::hypot(x, y), x.hypot(y)), "hypot({x}, {y})");
    }
    for n in -20..=20 {
        assert!(close(super::powi(1.37, n), 1.37f64.powi(n)), "powi({n})");
    }
}

/// A digest of bits.
fn digest(bits: impl Iterator<Item = u64>) -> u64 {
    bits.fold(0xcbf2_9ce4_8422_2325, |hash, word| {
        word.to_le_bytes().iter().fold(hash, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
    })
}

#[test]
fn bits_are_those_of_every_other_machine() {
    let doubles = numbers().flat_map(|x| {
        let (sin, cos) = super::sin_cos(x);
        let small = x / (1.0 + x.abs());
        let size = 1e-3 + x.abs();
        [
            super::sin(x),
            super::cos(x),
            super::tan(x),
            super::asin(small),
            super::tanh(x),
            super::exp(small),
            super::exp2(x),
            super::exp_m1(small),
            super::ln(size),
            super::ln_1p(size),
            super::log2(size),
            super::log10(size),
            super::pow(size, small),
            super::cbrt(x),
            super::hypot(x, small),
            super::powi(x, 3),
            sin,
            cos,
        ]
    });
    let singles = numbers().flat_map(|x| {
        let x = x as f32;
        let size = 1e-3 + x.abs();
        [super::sin(x), super::cos(x), super::exp(-size), super::ln(size), super::pow(size, 0.3), super::tanh(x)]
    });
    let bits = doubles.map(f64::to_bits).chain(singles.map(|x| u64::from(x.to_bits())));
    // Measured once. Whatever changes it changes the sound of every preset.
    assert_eq!(format!("{:016x}", digest(bits)), "82df385078a19f8c");
}
