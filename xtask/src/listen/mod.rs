//! `cargo xtask listen`: a blind listening test as one HTML file.
//!
//! Each trial has one flame and one recording, and a sound of every method: the effect, the published method and the
//! simplest rivals, and the recording itself. All sounds of a trial are equally loud. Their order and their names are
//! drawn from the seed; the assignment is in a key beside the page, and nowhere in it.
//!
//! | module | content |
//! |---|---|
//! | `stimuli` | sounds of every method |
//! | `level` | equal loudness |
//! | `order` | random draws from the seed |
//! | `page` | the page |

mod level;
mod order;
mod page;
mod stimuli;

use std::fmt::Write;
use std::path::PathBuf;

use anyhow::{Context, Result, bail, ensure};

use crate::demo::comparisons::reference_folder;
use crate::project;
use order::Order;
use page::{Sound, Trial};
use stimuli::{METHODS, Pair};

/// Options of `cargo xtask listen`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Seed of the pairs, their order and the sounds' names
    #[arg(long, default_value_t = 1)]
    seed: u32,
    /// Number of trials, each of one flame with one recording
    #[arg(long, default_value_t = 6)]
    trials: usize,
    /// Length of every sound in seconds, 2-20
    #[arg(long, default_value_t = 8.0)]
    seconds: f64,
    /// Folder for the page and its key [default: target/listen]
    #[arg(long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// Makes the sounds and writes page and key.
pub fn run(args: &Args) -> Result<()> {
    ensure!((2.0..=20.0).contains(&args.seconds), "--seconds is {}, but must lie between 2 and 20", args.seconds);
    let Some(reference) = reference_folder() else {
        bail!("there is no reference data; set PYROPHONE_REFERENCE to its folder");
    };
    let folder = args.output.clone().unwrap_or_else(|| project::target_dir().join("listen"));
    std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    let mut order = Order::new(args.seed);
    let mut pairs = stimuli::pairs(&reference)?;
    ensure!(!pairs.is_empty(), "{} holds no pairs", reference.display());
    order.shuffle(&mut pairs);
    pairs.truncate(args.trials.max(1));
    let mut key = String::from("seed,trial,code,flame,recording,method\n");
    let mut trials = Vec::new();
    for (number, pair) in pairs.iter().enumerate() {
        trials.push(trial(args, number + 1, pair, &mut order, &mut key)?);
        eprintln!("  {} of {}: {} on {}", number + 1, pairs.len(), pair.flame, pair.recording);
    }
    let page = folder.join(format!("listen-{}.html", args.seed));
    std::fs::write(&page, page::render(args.seed, &trials)).with_context(|| page.display().to_string())?;
    let key_path = folder.join(format!("listen-{}-key.csv", args.seed));
    std::fs::write(&key_path, key).with_context(|| key_path.display().to_string())?;
    println!("{}\n{}", page.display(), key_path.display());
    Ok(())
}

fn trial(args: &Args, number: usize, pair: &Pair, order: &mut Order, key: &mut String) -> Result<Trial> {
    let (rate_hz, mut sounds) = stimuli::sounds(pair, args.seconds)?;
    let lufs = level::match_loudness(&mut sounds, rate_hz)?;
    let original = sounds.last().map(|sound| page::wav(sound, rate_hz)).unwrap_or_default();
    let mut coded = Vec::new();
    for (method, sound) in METHODS.iter().zip(&sounds) {
        let code = order.code();
        let _ = writeln!(key, "{},{number},{code},{},{},{}", args.seed, pair.flame, pair.recording, method.name());
        coded.push(Sound { code, wav: page::wav(sound, rate_hz) });
    }
    order.shuffle(&mut coded);
    Ok(Trial { number, lufs, original, sounds: coded })
}
