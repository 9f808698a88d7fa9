//! Transforms against the definition, and bits that must be the same on every machine.

use std::f64::consts::TAU;

use super::{Complex64, ComplexTransform, RealTransform};

/// Lengths with every kind of pass, in whole vectors and in single samples.
const LENGTHS: [usize; 27] =
    [1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 12, 16, 18, 24, 26, 27, 32, 35, 36, 64, 97, 100, 128, 147, 160, 288, 512];

/// Noise, the same for every machine.
fn signal(len: usize) -> Vec<Complex64> {
    let mut state = 1u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    (0..len).map(|_| Complex64::new(next(), next())).collect()
}

/// A bin as it is defined.
fn bin(signal: &[Complex64], bin: usize) -> Complex64 {
    let turn = |n: usize| TAU * ((n * bin) % signal.len()) as f64 / signal.len() as f64;
    signal.iter().enumerate().map(|(n, x)| x * Complex64::from_polar(1.0, -turn(n))).sum()
}

#[track_caller]
fn assert_close(found: &[Complex64], expected: &[Complex64]) {
    assert_eq!(found.len(), expected.len());
    let largest = expected.iter().map(|x| x.norm()).fold(1.0, f64::max);
    let expected_len = expected.len();
    for (at, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert!(
            (found - expected).norm() < 1e-14 * largest,
            "bin {at} of {}: {found} instead of {expected}",
            expected_len
        );
    }
}

#[test]
fn complex_transforms_are_as_defined() {
    for len in LENGTHS {
        let signal = signal(len);
        let expected: Vec<Complex64> = (0..len).map(|k| bin(&signal, k)).collect();
        let transform = ComplexTransform::new(len);
        let mut found = signal.clone();
        transform.forward(&mut found);
        assert_close(&found, &expected);
        transform.inverse(&mut found);
        found.iter_mut().for_each(|x| *x /= len as f64);
        assert_close(&found, &signal);
    }
}

#[test]
fn real_transforms_are_as_defined() {
    for len in LENGTHS.into_iter().chain(LENGTHS.map(|len| 2 * len)) {
        let real: Vec<f64> = signal(len).iter().map(|x| x.re).collect();
        let complex: Vec<Complex64> = real.iter().map(|x| Complex64::new(*x, 0.0)).collect();
        let transform = RealTransform::new(len);
        let spectrum = transform.spectrum(&real);
        let expected: Vec<Complex64> = (0..=len / 2).map(|k| bin(&complex, k)).collect();
        assert_close(&spectrum, &expected);
        let mut back = vec![0.0; len];
        transform.inverse(&spectrum, &mut back, &mut vec![f64::NAN; transform.room()]);
        let back: Vec<Complex64> = back.iter().map(|x| Complex64::new(x / len as f64, 0.0)).collect();
        assert_close(&back, &complex);
    }
}

#[test]
fn bits_are_those_of_every_other_machine() {
    let mut hash = 0xcbf2_9ce4_8422_2325u64;
    for len in [2, 6, 18, 22, 96, 294, 320, 1024, 4608] {
        let real: Vec<f64> = signal(len).iter().map(|x| x.re).collect();
        let transform = RealTransform::new(len);
        let spectrum = transform.spectrum(&real);
        let mut back = vec![0.0; len];
        transform.inverse(&spectrum, &mut back, &mut vec![0.0; transform.room()]);
        let numbers = spectrum.iter().flat_map(|x| [x.re, x.im]).chain(back);
        for byte in numbers.flat_map(|x| x.to_bits().to_le_bytes()) {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
    // Measured once, the same with and without AVX2. What changes it changes the sound of every preset that extends.
    assert_eq!(format!("{hash:016x}"), "39a207d3e3c02c46");
}
