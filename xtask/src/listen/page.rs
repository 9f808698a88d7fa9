//! The page: one HTML file with embedded sounds, which exports its answers as CSV.

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// A sound of a trial.
#[derive(Debug)]
pub struct Sound {
    /// Name in the results.
    pub code: String,
    /// A WAV file in Base64.
    pub wav: String,
}

/// A trial.
#[derive(Debug)]
pub struct Trial {
    /// Counted from 1.
    pub number: usize,
    /// Loudness of all its sounds in LUFS.
    pub lufs: f64,
    /// The labelled recording: a WAV file in Base64.
    pub original: String,
    /// Sounds, in order of display.
    pub sounds: Vec<Sound>,
}

/// A mono sound as a 16-bit WAV file in Base64.
pub fn wav(sound: &[f32], rate_hz: u32) -> String {
    let data_bytes = 2 * sound.len() as u32;
    let mut file = Vec::with_capacity(44 + data_bytes as usize);
    file.extend(b"RIFF");
    file.extend((36 + data_bytes).to_le_bytes());
    file.extend(b"WAVEfmt \x10\0\0\0\x01\0\x01\0");
    file.extend(rate_hz.to_le_bytes());
    file.extend((2 * rate_hz).to_le_bytes());
    file.extend(b"\x02\0\x10\0data");
    file.extend(data_bytes.to_le_bytes());
    sound.iter().for_each(|x| file.extend(((x * 32_767.0).round() as i16).to_le_bytes()));
    STANDARD.encode(file)
}

/// The whole page.
pub fn render(seed: u32, trials: &[Trial]) -> String {
    let mut body = String::new();
    for trial in trials {
        let _ = write!(
            body,
            "<section><h2>Trial {} of {}</h2><p>The original: <audio controls src='data:audio/wav;base64,{}'></audio></p>",
            trial.number,
            trials.len(),
            trial.original
        );
        for (place, sound) in trial.sounds.iter().enumerate() {
            body.push_str(&question(trial, place, sound));
        }
        body.push_str("</section>\n");
    }
    format!(
        "<!doctype html>\n<html lang=en><meta charset=utf-8><meta name=viewport content='width=device-width'>\
         <title>Listening test {seed}</title>\n<style>{STYLE}</style>\n\
         <h1>Listening test</h1><p>Each trial has five sounds of a fire, equally loud and in random order. Use headphones, and set the volume \
         once, with the first original. Rate the quality of every sound, and how well it could replace the original in a scene. \
         Sounds may be played as often as you like.</p>\n\
         <p><label>Your name or number: <input id=listener></label></p>\n{body}\
         <p><button id=save>Save the answers as CSV</button> <span id=missing></span></p>\n\
         <script>const seed = {seed};{SCRIPT}</script>\n"
    )
}

fn question(trial: &Trial, place: usize, sound: &Sound) -> String {
    let letter = char::from(b'A' + place as u8 % 26);
    let (number, code) = (trial.number, &sound.code);
    let choices: String = ["not at all", "hardly", "perhaps", "well", "perfectly"]
        .iter()
        .enumerate()
        .map(|(value, text)| format!("<label><input type=radio name=r{code} value={value}> {text}</label> "))
        .collect();
    format!(
        "<fieldset data-trial={number} data-place={letter} data-code={code} data-lufs={lufs:.1}><legend>{letter}</legend>\
         <audio controls src='data:audio/wav;base64,{wav}'></audio>\
         <p>Quality: <span class=scale>bad</span> <input type=range min=0 max=100 value=50 class=quality> \
         <span class=scale>excellent</span> <output>–</output></p>\
         <p>It could replace the original in a scene: {choices}</p></fieldset>\n",
        lufs = trial.lufs,
        wav = sound.wav,
    )
}

const STYLE: &str = "body{font:16px system-ui,sans-serif;max-width:52rem;margin:2rem auto;padding:0 1rem}\
    fieldset{margin:1rem 0;border:1px solid #999}audio{vertical-align:middle}.quality{width:18rem;vertical-align:middle}\
    label{white-space:nowrap;margin-right:.6rem}";

/// Script of the page; a slider counts as answered once it was moved.
const SCRIPT: &str = r#"
const sets = [...document.querySelectorAll('fieldset')];
for (const set of sets) {
  const slider = set.querySelector('.quality');
  slider.addEventListener('input', () => {
    set.dataset.quality = slider.value;
    set.querySelector('output').textContent = slider.value;
  });
}
const players = [...document.querySelectorAll('audio')];
for (const player of players) {
  player.addEventListener('play', () => players.forEach(other => { if (other !== player) other.pause(); }));
}
document.querySelector('#save').addEventListener('click', () => {
  const listener = document.querySelector('#listener').value.replace(/[",\n]/g, ' ').trim();
  const rows = ['seed,listener,trial,place,code,lufs,quality,replaces'];
  let missing = 0;
  for (const set of sets) {
    const choice = set.querySelector('input[type=radio]:checked');
    const { trial, place, code, lufs, quality } = set.dataset;
    if (!choice || quality === undefined) missing += 1;
    rows.push([seed, listener, trial, place, code, lufs, quality ?? '', choice ? choice.value : ''].join(','));
  }
  document.querySelector('#missing').textContent = missing ? missing + ' sounds are not rated wholly.' : 'All are rated.';
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([rows.join('\n') + '\n'], { type: 'text/csv' }));
  link.download = 'listen-' + seed + '-' + (listener || 'results') + '.csv';
  link.click();
});
"#;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_holds_all_sounds_under_their_codes_and_names_no_method() {
        let sound = |code: &str| Sound { code: code.to_owned(), wav: wav(&[0.0, 0.5], 44_100) };
        let trial = Trial {
            number: 1,
            lufs: -24.04,
            original: wav(&[0.1], 44_100),
            sounds: vec![sound("abc123"), sound("def456")],
        };
        let page = render(7, &[trial]);
        assert!(page.contains("data-code=abc123") && page.contains("data-place=B data-code=def456"));
        assert!(page.contains("data-lufs=-24.0") && page.contains("const seed = 7"));
        for method in super::super::stimuli::METHODS {
            assert!(
                !page.contains(&format!("\"{}\"", method.name())) && !page.contains(&format!(">{}<", method.name()))
            );
        }
        let file = STANDARD.decode(wav(&[0.0, 1.0], 48_000)).unwrap();
        let sound = pyrophone_recording::decode_bytes(&file, "x.wav", &pyrophone_recording::no_progress).unwrap();
        assert_eq!((sound.sample_rate_hz, sound.channels.len(), sound.len_samples()), (48_000, 1, 2));
        assert!((sound.channels[0][1] - 1.0).abs() < 1e-3);
    }
}
