//! The page: one file of HTML, with sounds and pictures beside it.

/// Two sounds at one loudness: before and after.
pub struct Pair {
    /// Before, and after.
    pub sides: [Side; 2],
}

/// One of a pair.
pub struct Side {
    /// Prefix of the names of its row's files.
    pub slug: String,
    /// Its loudness, in small print.
    pub fact: String,
    /// A WAV file in Base64: browsers do not let a page read files beside it.
    pub wav: String,
}

/// A section of the page: a heading, sounds, a table.
#[derive(Default)]
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
    /// True for an input or a recording, false for a result.
    pub is_source: bool,
    /// Its length: switching between players of equal length keeps the position.
    pub duration_ms: u64,
    /// Short facts in small print.
    pub facts: Vec<String>,
    /// Its licence.
    pub rights: String,
}

/// The whole page.
pub fn render(pair: &Pair, sections: &[Section]) -> String {
    let links: String =
        sections.iter().map(|s| format!("<a href='#{}'>{}</a>", anchor(&s.title), escaped(&s.title))).collect();
    let body: String = sections.iter().map(section).collect();
    format!(
        "<!doctype html>\n<html lang=en><meta charset=utf-8><meta name=viewport content='width=device-width'>\
         <title>Pyrophone</title>\n<style>{STYLE}</style>\n\
         <header><h1>Pyrophone</h1><p>Full-band fire from a low-frequency flame. Every result on this page was bounced through the \
         CLAP plug-in, version {version}, in a headless host, with its latency compensated.</p></header>\n\
         <main>{}<nav>{links}<a href='#sources-and-licences'>Sources and licences</a></nav>{body}{ABOUT}</main>\n\
         <script>{SCRIPT}</script>\n",
        opening(pair),
        version = env!("CARGO_PKG_VERSION"),
    )
}

/// Before and after, to switch between while they play.
fn opening(Pair { sides: [before, after] }: &Pair) -> String {
    let side = |side: &Side, number: usize, title: &str, is_on: bool| {
        let Side { slug, fact, wav } = side;
        format!(
            "<div class=side data-number={number}><h3>{title}</h3>\
             <div class=picture><img src='{slug}.spectrogram.png' alt='Spectrogram: {title}'><i></i></div>\
             <button aria-pressed={is_on}>Hear {title} <kbd>{}</kbd></button><p class=facts>{}</p>\
             <script type='text/plain'>{wav}</script></div>",
            number + 1,
            escaped(fact),
        )
    };
    format!(
        "<section class=pair id=pair><h2>Before and after</h2><p class=intro>The flame alone, and the fire that the default preset makes of it, \
         at the same loudness. Both play in sync, so you can switch between them at any time.</p>\
         <div class=sides>{}{}</div><p><button class=play>Play</button></p></section>\n",
        side(before, 0, "before", false),
        side(after, 1, "after", true),
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
    let table = section.table.as_ref();
    let table = table.map_or_else(String::new, |rows| format!("<div class=wide><table>{rows}</table></div>"));
    let (id, title, intro) = (anchor(&section.title), escaped(&section.title), &section.intro);
    format!("<section id='{id}'><h2>{title}</h2><p class=intro>{intro}</p>\n{rows}{table}</section>\n")
}

fn row(row: &Row) -> String {
    let Row { slug, name, note, facts, duration_ms, rights, .. } = row;
    let name = escaped(name);
    let class = if row.is_source { "row source" } else { "row" };
    let facts: Vec<String> = facts.iter().map(|fact| escaped(fact)).collect();
    format!(
        "<article class='{class}' data-ms={duration_ms}><div class=about><h3>{name}</h3><p>{note}</p>\
         <audio controls preload=none src='{slug}.wav'></audio>\
         <p class=facts>{} · <a href='{slug}.float.wav' download title='32-bit float, unmodified'>original</a><br>Rights: {}</p></div>\
         <div class=picture><img loading=lazy src='{slug}.spectrogram.png' alt='Spectrogram of {name}'><i></i></div>\
         <img class=spectrum loading=lazy src='{slug}.spectrum.png' alt='Spectrum of {name}'></article>\n",
        facts.join(" · "),
        escaped(rights),
    )
}

/// Origin of the page and of everything on it.
const ABOUT: &str = "<section id='sources-and-licences'><h2>Sources and licences</h2>
<ul><li>Each sound states its rights. Pyrophone claims none in its results: a result may be used as far as the sounds that it was made from allow.
<li>Pyrophone: MIT or Apache-2.0, in the files <code>LICENSE-MIT</code> and <code>LICENSE-APACHE</code>; its manual is <code>docs/manual.md</code>.
<li>Extension and texture: J. Chadwick and D. James, <a href='https://doi.org/10.1145/1964921.1964979'>Animating Fire with Sound</a>, 2011.
<li>Vortex sound: Y. Dobashi, T. Yamamoto and T. Nishita, <i>Synthesizing Sound from Turbulent Field using Sound Textures for Interactive Fluid Simulation</i>, 2004.
<li>The recorded fireplace: ezwa, <a href='https://soundbible.com'>soundbible.com</a>, public domain, as <a href='https://github.com/rafaelmardojai/blanket'>Blanket</a> ships it.
</ul>
<p class=intro>Players use 16-bit copies at −20 LUFS, or quieter where a peak would exceed −1 dB; the gain is stated. Spectra show the levels of the
32-bit originals. <i>Real time</i> is the seconds of sound per second of computing, on one core. In spectrograms, 0 dB is each sound's own maximum;
click one to play from that point. If a sound of the same length is playing, the next one that you start continues from its position.</p></section>
";

const STYLE: &str = include_str!("page.css");

/// Script for the pair at matched loudness; one player at a time, which continues at the position of another of the
/// same length; a line that moves along the spectrogram; a click into it plays from there.
const SCRIPT: &str = include_str!("page.js");

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
            duration_ms: 8000,
            facts: vec!["1 < 2".into()],
            rights: "<yours>".into(),
        };
        let side = || Side { slug: "a".into(), fact: "3 > 2".into(), wav: "UklGRg==".into() };
        let section = Section { title: "A <i>".into(), rows: vec![row], ..Section::default() };
        let page = render(&Pair { sides: [side(), side()] }, &[section]);
        assert!(page.contains("&lt;b&gt;&#39;x&#39; &amp; &quot;y&quot;") && page.contains("1 &lt; 2"));
        assert!(page.contains("Rights: &lt;yours&gt;") && page.contains("3 &gt; 2"));
        assert!(!page.contains("<b>'x'") && !page.contains("<i></i></i>") && page.contains("id='a-i'"));
    }
}
