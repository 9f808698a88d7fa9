//! The comparisons of Chadwick & James 2011, §6, on the reference pairs.

use std::path::{Path, PathBuf};

use anyhow::Result;
use pyrophone_recording::Recording;

use super::page::{Row, Section};
use super::studio::{Beside, Job, RenderedJob, Sound, Studio};
use crate::bounce::{load, preset};
use crate::project;

/// The reference pairs, with their titles.
const PAIRS: [(&str, &str); 3] = [("burning_brick", "Burning Brick"), ("dragon", "Dragon"), ("torch", "Torch")];

/// The paper's Table 2: example, length of recording and of result in seconds, time for extension and for texture in
/// seconds.
const TABLE_2: [(&str, f64, f64, f64, f64); 5] = [
    ("Dragon", 15.0, 9.0, 223.0, 56.0),
    ("Candle", 10.0, 6.0, 151.0, 86.0),
    ("Torch", 16.0, 5.0, 63.0, 41.0),
    ("Flame Jet", 15.0, 10.0, 256.0, 54.0),
    ("Burning Brick", 8.0, 5.0, 64.0, 20.0),
];

/// The folder of the reference data; none if it is not there.
pub fn reference_folder() -> Option<PathBuf> {
    let beside = || project::root().join("../shared/reference");
    let folder = std::env::var_os("PYROPHONE_REFERENCE").map_or_else(beside, PathBuf::from);
    folder.join("signals").is_dir().then_some(folder)
}

/// Rights in the paper's signals, and in its recordings.
const SIGNAL_RIGHTS: &str = "BSD 2-clause, J. Chadwick 2011";
const RECORDING_RIGHTS: &str =
    "The Recordist, Ultimate Fire; licensed for the paper's own release, may not be passed on";

/// One example of the paper.
struct Pair {
    slug: &'static str,
    title: &'static str,
    input: Recording,
    training: PathBuf,
    input_sound: Sound,
    training_sound: Sound,
}

/// The time that one example took, in seconds.
struct Timing {
    title: &'static str,
    recording_s: f64,
    input_s: f64,
    extension_s: f64,
    texture_s: f64,
    indexing_s: f64,
}

/// All comparisons.
pub fn sections(studio: &Studio, reference: &Path) -> Result<Vec<Section>> {
    let pairs: Vec<Pair> =
        PAIRS.iter().map(|(slug, title)| Pair::load(reference, slug, title)).collect::<Result<_>>()?;
    let mut timings = vec![];
    let mut sections = vec![];
    for pair in &pairs {
        let (section, timing) = example(studio, pair)?;
        sections.push(section);
        timings.push(timing);
    }
    let [brick, dragon, torch] = &pairs[..] else { return Ok(sections) };
    sections.push(exponents(studio, brick)?);
    sections.push(crossed(studio, &[(brick, dragon), (brick, torch), (dragon, brick)])?);
    sections.push(dynamic_range(studio, torch)?);
    sections.push(table_2(&timings));
    Ok(sections)
}

impl Pair {
    fn load(reference: &Path, slug: &'static str, title: &'static str) -> Result<Self> {
        let training = reference.join("training").join(format!("{slug}.wav"));
        let input = load(&reference.join("signals").join(format!("{slug}.wav")), None)?;
        let recording = load(&training, None)?;
        Ok(Self {
            slug,
            title,
            input_sound: Sound::new(input.channels.clone(), input.sample_rate_hz, SIGNAL_RIGHTS),
            input,
            training,
            training_sound: Sound::new(recording.channels, recording.sample_rate_hz, RECORDING_RIGHTS),
        })
    }

    fn render_fire(
        &self,
        studio: &Studio,
        name: &str,
        settings: &[&str],
        recording: Option<&Pair>,
    ) -> Result<RenderedJob> {
        let values = preset(name, settings.iter().copied())?;
        let training = recording.map(|pair| pair.training.as_path());
        studio.render(&Job { input: &self.input, training, values: &values, output_channels: 1 })
    }

    fn beside<'a>(&'a self, recording: Option<&'a Pair>, alpha: Option<f64>) -> Beside<'a> {
        Beside::Result { input: &self.input_sound, training: recording.map(|pair| &pair.training_sound), alpha }
    }
}

fn timed(mut row: Row, rendered: &RenderedJob) -> Row {
    row.facts.push(rendered.speed());
    row
}

/// Input, recording, extension and texture of one pair.
fn example(studio: &Studio, pair: &Pair) -> Result<(Section, Timing)> {
    let slug = |what: &str| format!("{}-{what}", pair.slug);
    let input =
        studio.row(&slug("input"), "Input", "Pressure of the simulated flame.", &pair.input_sound, &Beside::Input)?;
    let recording = studio.row(
        &slug("training"),
        "Recording",
        "The fire recording that the paper pairs with it.",
        &pair.training_sound,
        &Beside::Training,
    )?;

    let extended = pair.render_fire(studio, "extend", &[], None)?;
    let extension =
        studio.row(&slug("extend"), "Extension", "alpha 2.5.", &extended.sound, &pair.beside(None, Some(2.5)))?;
    let textured = pair.render_fire(studio, "texture-paper", &[], Some(pair))?;
    let texture = studio.row(
        &slug("texture"),
        "Texture, as published",
        "Full dynamic range mapping.",
        &textured.sound,
        &pair.beside(Some(pair), None),
    )?;
    let timing = Timing {
        title: pair.title,
        recording_s: load(&pair.training, None)?.duration_s(),
        input_s: pair.input.duration_s(),
        extension_s: extended.playing.as_secs_f64(),
        texture_s: textured.playing.as_secs_f64(),
        indexing_s: textured.loading.as_secs_f64(),
    };
    let rows = vec![input, recording, timed(extension, &extended), timed(texture, &textured)];
    let intro = "An example of the paper, from its authors' release.".to_owned();
    Ok((Section { title: format!("The paper's {}", pair.title), intro, rows, ..Section::default() }, timing))
}

fn exponents(studio: &Studio, pair: &Pair) -> Result<Section> {
    let mut rows = vec![];
    for (alpha, note) in [
        (2.5, "The paper: too much at the top."),
        (3.0, "The paper: reasonable."),
        (3.5, "The paper: too much at the bottom."),
    ] {
        let rendered = pair.render_fire(studio, "extend", &[&format!("alpha={alpha}")], None)?;
        let slug = format!("{}-alpha-{alpha}", pair.slug);
        let row =
            studio.row(&slug, &format!("alpha {alpha}"), note, &rendered.sound, &pair.beside(None, Some(alpha)))?;
        rows.push(timed(row, &rendered));
    }
    Ok(Section {
        title: format!("Varying the exponent: {}", pair.title),
        intro: "The power of the added noise falls as frequency to the minus alpha.".into(),
        rows,
        ..Section::default()
    })
}

fn crossed(studio: &Studio, pairs: &[(&Pair, &Pair)]) -> Result<Section> {
    let mut rows = vec![];
    for (flame, fire) in pairs {
        let rendered = flame.render_fire(studio, "texture-paper", &[], Some(fire))?;
        let slug = format!("{}-from-{}", flame.slug, fire.slug);
        let name = format!("{}, {}'s fire", flame.title, fire.title);
        let note = format!("The flame of {}, with the recording of {}.", flame.title, fire.title);
        let row = studio.row(&slug, &name, &note, &rendered.sound, &flame.beside(Some(fire), None))?;
        rows.push(timed(row, &rendered));
    }
    Ok(Section {
        title: "Other recordings".into(),
        intro: "The same flames, with the recordings of other examples.".into(),
        rows,
        ..Section::default()
    })
}

fn dynamic_range(studio: &Studio, pair: &Pair) -> Result<Section> {
    let variants: [(&str, &str, &[&str]); 3] = [
        (
            "1",
            "Full mapping. The flame's range is wider than the recording's: neighbouring windows add up to a tonal buzz, as the paper says.",
            &[],
        ),
        ("0.5", "Half of the mapping hides the buzz.", &["scaling_alpha=0.5"]),
        ("off", "No mapping: the recording's own loudness at each match.", &["dynamic_range=off"]),
    ];
    let mut rows = vec![];
    for (name, note, settings) in variants {
        let rendered = pair.render_fire(studio, "texture-paper", settings, Some(pair))?;
        let slug = format!("{}-dynamics-{name}", pair.slug);
        let row =
            studio.row(&slug, &format!("Dynamics {name}"), note, &rendered.sound, &pair.beside(Some(pair), None))?;
        rows.push(timed(row, &rendered));
    }
    Ok(Section {
        title: format!("Dynamic range mapping: {}", pair.title),
        intro: "How far the recording's loudness is mapped onto the flame's (§5.3).".into(),
        rows,
        ..Section::default()
    })
}

/// The paper's times beside ours.
fn table_2(timings: &[Timing]) -> Section {
    let head = "<tr><th rowspan=2>Example<th colspan=2>Recording, s<th colspan=2>Sound, s<th colspan=2>Extension, s\
                <th colspan=3>Texture, s<tr><th>paper<th>here<th>paper<th>here<th>paper<th>here<th>paper<th>here<th>+ index";
    let rows = TABLE_2.iter().map(|(title, recording, sound, extension, texture)| {
        let ours = match timings.iter().find(|timing| timing.title == *title) {
            Some(t) => [t.recording_s, t.input_s, t.extension_s, t.texture_s, t.indexing_s].map(|s| {
                let places = if s < 1.0 { 3 } else { 1 };
                format!("<b>{s:.places$}</b>")
            }),
            None => std::array::from_fn(|_| "–".to_owned()),
        };
        let [our_recording, our_sound, our_extension, our_texture, our_index] = ours;
        format!(
            "<tr><th>{title}<td>{recording}<td>{our_recording}<td>{sound}<td>{our_sound}<td>{extension}<td>{our_extension}\
             <td>{texture}<td>{our_texture}<td>{our_index}"
        )
    });
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    Section {
        title: "Table 2: times".into(),
        intro: format!(
            "Seconds for a whole sound. The paper's are of 2011 (extension in unoptimised Matlab). Ours are those of the plugin in a \
             host on this machine ({cores} cores): extension and texture run on one of them, texture with exact search; reading and \
             indexing the recording is done once, on all of them. Candle and Flame Jet are not among the data at hand."
        ),
        table: Some(format!("{head}{}", rows.collect::<String>())),
        ..Section::default()
    }
}
