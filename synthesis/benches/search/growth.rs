//! Long recordings.

use std::sync::Arc;

use pyrophone_synthesis::controls::Quality;
use pyrophone_synthesis::texture::{Dictionary, PyramidConfig};

use crate::pairs::{Pair, streaming};
use crate::signals::Random;
use crate::{RATE_HZ, timed};

/// Seconds of drive.
const DRIVE_SECONDS: f64 = 2.0;

/// Cost against length.
pub fn table(pairs: &[Pair]) {
    println!("### Long recordings\n");
    println!(
        "Recordings mixed from all the pairs' at random places and levels, under {DRIVE_SECONDS} s of {}. Engine as above.\n",
        pairs[0].name
    );
    println!("| recording, s | build, s | MB | MB per s | exact | 1024 |");
    println!("|---|---|---|---|---|---|");
    let longest = pairs.iter().max_by_key(|pair| pair.input.len()).unwrap();
    let from = longest.input.len() / 3;
    let drive = &longest.input[from..from + (DRIVE_SECONDS * RATE_HZ) as usize];
    for seconds in [10.0, 60.0, 600.0] {
        let recording = mixture(pairs, (seconds * RATE_HZ) as usize);
        let (dictionary, time) =
            timed(|| Dictionary::new(&[recording], RATE_HZ, &PyramidConfig::default(), &|_| true).unwrap());
        let megabytes = dictionary.bytes() as f64 / 1e6;
        let dictionary = Arc::new(dictionary);
        println!(
            "| {seconds} | {:.2} | {megabytes:.0} | {:.2} | {:.4} | {:.4} |",
            time.as_secs_f64(),
            megabytes / seconds,
            streaming(drive, &dictionary, Quality::Exact),
            streaming(drive, &dictionary, Quality::default()),
        );
    }
    println!();
}

/// Two pieces of recordings at a time, one over the other, so that nothing repeats.
fn mixture(pairs: &[Pair], samples: usize) -> Vec<f64> {
    let mut random = Random::new(5);
    let mut out = Vec::with_capacity(samples);
    while out.len() < samples {
        let piece = (44_100 + random.below(88_200)).min(samples - out.len());
        let mut layer = || {
            let training = &pairs[random.below(pairs.len())].training;
            (training, random.below(training.len() - piece), 0.3 + 0.7 * random.unit())
        };
        let ((a, at_a, gain_a), (b, at_b, gain_b)) = (layer(), layer());
        out.extend((0..piece).map(|i| gain_a * a[at_a + i] + gain_b * b[at_b + i]));
    }
    out
}
