//! Inputs, recordings, and the cost of a dictionary.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use pyrophone_synthesis::controls::{DynamicRange, Quality, TextureControls};
use pyrophone_synthesis::texture::pyramid::Pyramid;
use pyrophone_synthesis::texture::{Dictionary, Distribution, PyramidConfig, Texture};

use crate::signals::{Random, signal};
use crate::{RATE_HZ, shortest, timed};

/// A drive and the recording it is used with.
pub struct Pair {
    pub name: String,
    pub input: Vec<f64>,
    pub training: Vec<f64>,
}

impl Pair {
    pub fn dictionary(&self) -> Dictionary {
        Dictionary::new(std::slice::from_ref(&self.training), RATE_HZ, &PyramidConfig::default(), &|_| true).unwrap()
    }
}

/// The reference pairs, or generated ones.
pub fn all() -> Vec<Pair> {
    let default = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/reference");
    let folder = std::env::var_os("PYROPHONE_REFERENCE").map_or_else(default, PathBuf::from);
    let read = |path: PathBuf| -> Option<Vec<f64>> {
        let samples = hound::WavReader::open(path).ok()?.into_samples::<f32>();
        samples.map(|x| x.map(f64::from)).collect::<Result<_, _>>().ok()
    };
    let pair = |name: &str| {
        let file = format!("{name}.wav");
        let input = read(folder.join("signals").join(&file))?;
        Some(Pair { name: name.to_owned(), input, training: read(folder.join("training").join(&file))? })
    };
    let found: Vec<Pair> = ["burning_brick", "dragon", "torch"].into_iter().filter_map(pair).collect();
    if !found.is_empty() {
        return found;
    }
    println!("No reference data found: made-up signals.\n");
    let made_up = |kind: usize| {
        let mut random = Random::new(kind as u64);
        let input = signal(&mut random, kind, 220_000);
        Pair { name: format!("made-up {kind}"), input, training: signal(&mut random, 1, 400_000) }
    };
    vec![made_up(0), made_up(1)]
}

/// Seconds of one core per second of sound, padding included, of a streaming run.
pub fn streaming(drive: &[f64], dictionary: &Arc<Dictionary>, quality: Quality) -> f64 {
    let pyramid = Pyramid::of_input(drive, dictionary.shape()).unwrap();
    let padded = &pyramid.levels[0];
    let controls =
        TextureControls { dynamic_range: DynamicRange::Learned, gate: 0.0, quality, ..TextureControls::default() };
    let learned = Arc::new(Distribution::from_magnitudes(pyramid.top_magnitudes()));
    let channels = dictionary.channels();
    let mut out = vec![vec![0.0; 64]; channels];
    shortest(|| {
        let mut engine = Texture::new(dictionary.shape(), channels, RATE_HZ).unwrap();
        engine.swap_dictionary(Some(Arc::clone(dictionary)));
        engine.swap_distribution(Some(Arc::clone(&learned)));
        let ((), time) = timed(|| {
            for block in padded.chunks(64) {
                let mut blocks: Vec<&mut [f64]> = out.iter_mut().map(|x| &mut x[..block.len()]).collect();
                engine.process(block, None, &controls, &mut blocks);
            }
        });
        time.as_secs_f64() / (padded.len() as f64 / RATE_HZ)
    })
}

/// Cost of building and holding a dictionary, and of the whole engine over it.
pub fn dictionary_table(pairs: &[Pair]) {
    println!("### Dictionary, and the whole engine\n");
    println!("44.1 kHz, mono, the paper's shape. Engine: seconds of one core per second of sound (padded length).\n");
    println!("| pair | recording, s | build, s per 10 s | MB per s | exact | eps 1 | 4096 | **1024** | 256 |");
    println!("|---|---|---|---|---|---|---|---|---|");
    for pair in pairs {
        let build_s = shortest(|| timed(|| pair.dictionary()).1.as_secs_f64());
        let dictionary = Arc::new(pair.dictionary());
        let engine = |quality| streaming(&pair.input, &dictionary, quality);
        let bounded = |candidates| engine(Quality::Bounded { candidates });
        let (padded, eps_one) = {
            use pyrophone_synthesis::texture::offline::{Options, synthesize};
            let padded =
                Pyramid::of_input(&pair.input, &PyramidConfig::default()).unwrap().levels[0].len() as f64 / RATE_HZ;
            let options = Options { eps: 1.0, ..Options::default() };
            let run = || timed(|| synthesize(&pair.input, &dictionary, &options, &|_| true).unwrap()).1;
            (padded, shortest(|| run().as_secs_f64()))
        };
        println!(
            "| {} | {:.1} | {:.3} | {:.2} | {:.4} | {:.4} | {:.4} | {:.4} | {:.4} |",
            pair.name,
            dictionary.seconds(),
            build_s * 10.0 / dictionary.seconds(),
            dictionary.bytes() as f64 / 1e6 / dictionary.seconds(),
            engine(Quality::Exact),
            eps_one / padded,
            bounded(4096),
            bounded(1024),
            bounded(256)
        );
    }
    println!();
}
