//! The page: one file of HTML, with sounds and pictures beside it.

/// A section of the page: a heading, sounds, a table.
pub struct Section {
    /// The heading.
    pub title: String,
    /// A sentence or two, HTML.
    pub intro: String,
    /// Sounds.
    pub rows: Vec<Row>,
    /// Rows of a table, HTML.
    pub table: Option<String>,
}

/// One sound.
pub struct Row {
    /// Prefix of its files' names.
    pub slug: String,
    /// Its name.
    pub name: String,
    /// Its description, HTML.
    pub note: String,
    /// Whether it is an input or a recording, not a result.
    pub is_source: bool,
    /// Short facts in small print.
    pub facts: Vec<String>,
}

/// The whole page.
pub fn render(sections: &[Section]) -> String {
    let links: String =
        sections.iter().map(|s| format!("<a href='#{}'>{}</a>", anchor(&s.title), escaped(&s.title))).collect();
    let body: String = sections.iter().map(section).collect();
    format!(
        "<!doctype html>\n<html lang=en><meta charset=utf-8><meta name=viewport content='width=device-width'>\
         <title>Pyrophone</title>\n<style>{STYLE}</style>\n\
         <header><h1>Pyrophone</h1><p>Full-band fire from a low-frequency flame. Every result on this page was bounced through the \
         CLAP plug-in, version {version}, in a headless host, with its latency compensated.</p><nav>{links}</nav></header>\n\
         <main>{body}</main>\n\
         <footer>Players use 16-bit copies, brought to a peak of −1 dB by the gain stated; spectra show the levels of the 32-bit \
         originals. Real time: seconds of sound per second of computing, on one core. Spectrograms: 0 dB is each sound's own maximum; click to play from there.</footer>\n\
         <script>{SCRIPT}</script>\n",
        version = env!("CARGO_PKG_VERSION"),
    )
}

/// Text as HTML.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;").replace('\'', "&#39;")
}

fn anchor(title: &str) -> String {
    title
        .to_lowercase()
        .split(|c: char| !c.is_ascii_alphanumeric())
        .filter(|x| !x.is_empty())
        .collect::<Vec<_>>()
        .join("-")
}

fn section(section: &Section) -> String {
    let rows: String = section.rows.iter().map(row).collect();
    let table = section.table.as_ref().map_or_else(String::new, |rows| format!("<table>{rows}</table>"));
    let (id, title, intro) = (anchor(&section.title), escaped(&section.title), &section.intro);
    format!("<section id='{id}'><h2>{title}</h2><p class=intro>{intro}</p>\n{rows}{table}</section>\n")
}

fn row(row: &Row) -> String {
    let Row { slug, name, note, facts, .. } = row;
    let name = escaped(name);
    let class = if row.is_source { "row source" } else { "row" };
    let facts: Vec<String> = facts.iter().map(|fact| escaped(fact)).collect();
    format!(
        "<article class='{class}'><div class=about><h3>{name}</h3><p>{note}</p>\
         <audio controls preload=none src='{slug}.wav'></audio>\
         <p class=facts>{} · <a href='{slug}.float.wav' download title='32-bit float, unmodified'>original</a></p></div>\
         <div class=time><img loading=lazy src='{slug}.spectrogram.png' alt='Spectrogram of {name}'><i></i></div>\
         <img class=spectrum loading=lazy src='{slug}.spectrum.png' alt='Spectrum of {name}'></article>\n",
        facts.join(" · "),
    )
}

const STYLE: &str = "
:root { color-scheme: dark; --ground: #0e0a0a; --card: #151010; --line: #2c2220; --text: #eadfd6; --dim: #a4948a; --ember: #ff7a2f; --glow: #ffc454; --blue: #6fb7ff }
* { box-sizing: border-box }
html { background: var(--ground); scroll-behavior: smooth }
body { margin: 0 auto; max-width: 1460px; padding: 0 24px 48px; color: var(--text); font: 15px/1.5 system-ui, 'Segoe UI', 'Helvetica Neue', sans-serif }
header { padding: 40px 0 8px }
h1 { margin: 0; font-size: 40px; font-weight: 650; letter-spacing: -.02em; background: linear-gradient(90deg, #fff3d0, var(--glow) 30%, var(--ember) 65%, #b3261a); background-clip: text; -webkit-background-clip: text; color: transparent; width: max-content }
header p { margin: 4px 0 16px; color: var(--dim); max-width: 70ch }
nav { display: flex; flex-wrap: wrap; gap: 6px }
nav a { border: 1px solid var(--line); border-radius: 99px; padding: 2px 12px; font-size: 13px; color: var(--text); text-decoration: none }
nav a:hover, nav a:focus-visible { border-color: var(--ember); color: var(--glow) }
section { padding-top: 36px }
h2 { margin: 0; font-size: 22px; font-weight: 620; letter-spacing: -.01em }
.intro { margin: 2px 0 14px; color: var(--dim); max-width: 100ch }
code { background: #241a18; border-radius: 4px; padding: 1px 6px; font: 13px ui-monospace, Menlo, Consolas, monospace; color: var(--text) }
.generated { font-size: 11px; font-weight: 650; letter-spacing: .06em; text-transform: uppercase; color: #14100c; background: var(--glow); border-radius: 4px; padding: 1px 6px; margin-right: 4px }
.row { display: grid; grid-template-columns: 268px minmax(0, 680fr) minmax(0, 430fr); gap: 16px; align-items: stretch; background: var(--card); border: 1px solid var(--line); border-left: 3px solid var(--ember); border-radius: 10px; padding: 12px 14px; margin-bottom: 10px }
.source { border-left-color: #5b4a42 }
.about { display: flex; flex-direction: column; min-width: 0 }
h3 { margin: 0; font-size: 16px; font-weight: 620 }
.about p { margin: 2px 0 10px; color: var(--dim); font-size: 13.5px; line-height: 1.42 }
audio { width: 100%; height: 38px; margin-top: auto }
.about .facts { margin: 8px 0 0; font-size: 12px; color: #8d7d73 }
a { color: var(--glow) }
.row img { display: block; width: 100% }
.time { position: relative; align-self: center; cursor: pointer }
.spectrum { align-self: center }
.time i { position: absolute; top: 3.2%; height: 86.4%; left: 5.735%; width: 2px; background: #fff; opacity: 0; pointer-events: none; box-shadow: 0 0 6px #fff8 }
.playing { border-color: #5a3322; border-left-color: var(--glow) }
.playing .time i { opacity: .85 }
table { border-collapse: collapse; background: var(--card); border: 1px solid var(--line); border-radius: 10px; overflow: hidden; font-variant-numeric: tabular-nums }
th, td { padding: 6px 16px; text-align: right; border-top: 1px solid var(--line) }
th { font-weight: 500; color: var(--dim); font-size: 13.5px }
th[colspan] { text-align: center; border-left: 1px solid var(--line); color: var(--text) }
tr > th:first-child[rowspan], tr:nth-child(n+3) > th { text-align: left; color: var(--text) }
td b { color: var(--glow); font-weight: 600 }
footer { margin-top: 32px; color: #8d7d73; font-size: 13px; max-width: 100ch }
@media (max-width: 1080px) { .row { grid-template-columns: 1fr } .about { max-width: 560px } .spectrum { max-width: 560px } }
";

/// One sound at a time; a line that moves along the spectrogram; a click into it plays from there.
const SCRIPT: &str = "
const plot = { from: 78 / 1360, width: 1164 / 1360 };
for (const row of document.querySelectorAll('.row')) {
  const audio = row.querySelector('audio'), picture = row.querySelector('.time'), line = picture.querySelector('i');
  const draw = () => {
    line.style.left = 100 * (plot.from + plot.width * (audio.currentTime / audio.duration || 0)) + '%';
    if (!audio.paused) requestAnimationFrame(draw);
  };
  audio.onplay = () => {
    for (const other of document.querySelectorAll('audio')) if (other !== audio) other.pause();
    for (const other of document.querySelectorAll('.playing')) other.classList.remove('playing');
    row.classList.add('playing');
    draw();
  };
  audio.onseeked = draw;
  picture.onclick = async event => {
    const share = (event.offsetX / picture.clientWidth - plot.from) / plot.width;
    if (!(audio.duration > 0)) {
      await new Promise(ready => { audio.addEventListener('loadedmetadata', ready, { once: true }); audio.preload = 'metadata'; audio.load(); });
    }
    audio.currentTime = Math.max(0, Math.min(1, share)) * audio.duration;
    audio.play();
  };
}
";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_from_outside_cannot_become_markup() {
        let row = Row {
            slug: "a".into(),
            name: "<b>'x' & \"y\"".into(),
            note: String::new(),
            is_source: true,
            facts: vec!["1 < 2".into()],
        };
        let section = Section { title: "A <i>".into(), intro: String::new(), rows: vec![row], table: None };
        let page = render(&[section]);
        assert!(page.contains("&lt;b&gt;&#39;x&#39; &amp; &quot;y&quot;") && page.contains("1 &lt; 2"));
        assert!(!page.contains("<b>'x'") && !page.contains("<i></i></i>") && page.contains("id='a-i'"));
    }
}
