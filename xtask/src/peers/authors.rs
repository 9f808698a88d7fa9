//! The authors' programs and data.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use serde_json::Value;

use crate::spent::spent;

/// Rate of all their signals, in Hz.
pub const RATE_HZ: u32 = 44_100;
/// Folders of their C++ that are searched for headers, and what is compiled beside the main program.
const HEADERS: [&str; 7] = ["datastructure", "linearalgebra", "util", "parser", "tinyxml", "texture", "."];
const COMPILED: [&str; 3] = ["parser", "texture", "tinyxml"];
/// Sources by themselves: the main program, and vectors without Intel's library.
const ALONE: [&str; 2] = ["testwindowsynthesis.cpp", "linearalgebra/VECTOR_DEBUG.cpp"];
/// Configuration of the C++, as in the authors' own folders.
const CONFIGURATION: &str = r#"<?xml version="1.0" ?>
<synthesis basesignal="input_data.vector" trainingsignal="training_data.vector" Fs="44100" numLevels="6" windowHW="4"
  featureHW="3" epsANN="1.0" falloff="0.00" scaleCDF="1" scalingAlpha="1.0" />
"#;
/// Runs the page's script on two raw files, with the page's default tolerance.
const PAGE: &str = "const fs = require('fs'), [folder, input, training] = process.argv.slice(1); \
    for (const name of ['kdtree.js', 'deterministic_rng.js', 'texture_synthesis.js']) require(folder + '/' + name); \
    const read = name => { const b = fs.readFileSync(name); \
      return Float64Array.from(new Float32Array(b.buffer, b.byteOffset, b.length / 4)); }; \
    TextureSynthesis.synthesize(read(input), read(training), { epsilon: 5 });";

/// A flame and its recording.
pub struct Pair {
    pub name: String,
    pub input: Vec<f32>,
    pub training: Vec<f32>,
}

impl Pair {
    /// Length in seconds of the padded signal, by which the published algorithm's cost grows: a power of two, plus 1.
    pub fn padded_s(&self) -> f64 {
        (self.input.len().saturating_sub(1).next_power_of_two() + 1) as f64 / f64::from(RATE_HZ)
    }
}

/// Their C++, compiled, and the folder of their page.
pub struct Program {
    cpp: PathBuf,
    page: PathBuf,
}

impl Program {
    /// Compiles the C++ in their folder into `target`.
    pub fn build(authors: &Path, target: &Path) -> Result<Self> {
        let source = authors.join("srcOrig");
        ensure!(
            source.join(ALONE[0]).exists(),
            "{} has no srcOrig/{}: name the folder `fire-texture-synthesis` of the authors' repository",
            authors.display(),
            ALONE[0]
        );
        fs::create_dir_all(target).with_context(|| format!("making {}", target.display()))?;
        let page = authors.canonicalize().with_context(|| authors.display().to_string())?;
        let cpp = target.canonicalize()?.join("testwindowsynthesis");
        let mut compile = Command::new("g++");
        compile.current_dir(&source).args(["-O3", "-std=gnu++14", "-fpermissive", "-w"]);
        compile.args(HEADERS.map(|folder| format!("-I{folder}"))).args(ALONE);
        for folder in COMPILED {
            compile.args(sources(&source, folder)?);
        }
        let status = compile.arg("-lann").arg("-o").arg(&cpp).status().context("g++ is not installed")?;
        ensure!(status.success(), "g++ failed; it needs libann-dev and libboost-dev");
        Ok(Self { cpp, page })
    }

    /// CPU seconds of the C++, run in the folder `place`.
    pub fn cpp_s(&self, pair: &Pair, place: &Path) -> Result<f64> {
        write_vector(&place.join("input_data.vector"), &pair.input)?;
        write_vector(&place.join("training_data.vector"), &pair.training)?;
        fs::write(place.join("default.xml"), CONFIGURATION)?;
        Ok(spent(Command::new(&self.cpp).current_dir(place))?.cpu_s)
    }

    /// CPU seconds of the page's script.
    pub fn page_s(&self, pair: &Pair, place: &Path) -> Result<f64> {
        let raw = [("input.f32", &pair.input), ("training.f32", &pair.training)];
        for (name, signal) in raw {
            let bytes: Vec<u8> = signal.iter().flat_map(|x| x.to_le_bytes()).collect();
            fs::write(place.join(name), bytes)?;
        }
        let mut node = Command::new("node");
        node.arg("-e").arg(PAGE).arg(&self.page).args(raw.map(|(name, _)| name));
        Ok(spent(node.current_dir(place))?.cpu_s)
    }
}

/// Sources in a folder of theirs, relative to their source's root.
fn sources(root: &Path, folder: &str) -> Result<Vec<PathBuf>> {
    let path = root.join(folder);
    let entries = fs::read_dir(&path).with_context(|| path.display().to_string())?;
    let names = entries.map(|entry| Ok(PathBuf::from(folder).join(entry?.file_name())));
    let mut names = names.collect::<Result<Vec<_>>>()?;
    names.retain(|name| name.extension() == Some(OsStr::new("cpp")));
    names.sort();
    Ok(names)
}

/// Writes a signal as their programs read it: the number of samples, then doubles.
fn write_vector(path: &Path, signal: &[f32]) -> Result<()> {
    let mut bytes = i32::try_from(signal.len())?.to_le_bytes().to_vec();
    bytes.extend(signal.iter().flat_map(|x| f64::from(*x).to_le_bytes()));
    fs::write(path, bytes).with_context(|| format!("writing {}", path.display()))
}

/// All pairs in the page's `assets` that are complete.
pub fn pairs(authors: &Path) -> Result<Vec<Pair>> {
    let assets = authors.join("assets");
    let path = assets.join("manifest.json");
    let text = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    let manifest: Value = serde_json::from_str(&text).with_context(|| path.display().to_string())?;
    let examples = manifest["examples"].as_array().context("the manifest lists no examples")?;
    let mut pairs = Vec::new();
    for example in examples {
        let name = example["name"].as_str().context("an example without a name")?.to_owned();
        let signals = ["input", "training"].map(|kind| signal(&assets, example, kind));
        match signals {
            [Some(input), Some(training)] => pairs.push(Pair { name, input, training }),
            _ => eprintln!("left out: {name}, whose files are missing or cut short"),
        }
    }
    ensure!(!pairs.is_empty(), "{} has no complete pair", assets.display());
    Ok(pairs)
}

/// One signal of an example; `None` if its file is missing or has fewer samples than the manifest says.
fn signal(assets: &Path, example: &Value, kind: &str) -> Option<Vec<f32>> {
    let bytes = fs::read(assets.join(example[format!("{kind}_file")].as_str()?)).ok()?;
    let samples = usize::try_from(example[format!("{kind}_samples")].as_u64()?).ok()?;
    let values = bytes.get(..4 * samples)?.as_chunks::<4>().0;
    Some(values.iter().map(|x| f32::from_le_bytes(*x)).collect())
}
