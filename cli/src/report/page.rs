//! The page: a single HTML file with embedded pictures.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::plots::{ASH, Axis, EMBER, GLOW, Plot};
use super::raster::Picture;
use super::{BAND_HZ, Report, figures};
use pyrophone_analysis::Spectrum;

/// Range of a spectrum's axis in dB.
const RANGE_DB: f64 = 90.0;
/// Lowest frequency of a spectrum in Hz.
const LOWEST_HZ: f64 = 10.0;

/// Renders the whole page; fails if a picture cannot be drawn.
pub fn render(report: &Report<'_>) -> Result<String, String> {
    let spectrum = Spectrum::of_channels(&[report.pressure], report.sample_rate_hz);
    let title = escaped(&report.title);
    let mut body = String::new();
    body += &format!(
        "<section class=tables>{}{}</section>\n",
        table("Origin", &report.facts),
        table("Figures", &figures(report, &spectrum))
    );
    if !report.surfaces.is_empty() {
        let mut pictures = String::new();
        for (label, picture) in &report.surfaces {
            let (source, label) = (data_uri(picture)?, escaped(label));
            pictures += &format!(
                "<figure><img src='{source}' alt='Flame front, {label}'><figcaption>{label}</figcaption></figure>\n"
            );
        }
        body += &format!("<section><h2>Flame front</h2><div class=fronts>{pictures}</div></section>\n");
    }
    for (heading, note, plot) in [
        (
            "Velocity flux",
            "Volume per second through the front, at every step; positive where the flame expands.",
            flux(report)?,
        ),
        ("Area", "Of the front, in square world units.", area(report)?),
        (
            if report.is_envelope { "Envelope" } else { "Pressure" },
            if report.is_envelope {
                "As written to the file."
            } else {
                "The flux's derivative after the high-pass, as written to the file."
            },
            Some(pressure(report)?),
        ),
        (
            "Spectrum of the pressure",
            "The marked band comes from the simulation itself; above it, the sound is synthesised.",
            spectrum_of(report, &spectrum)?,
        ),
    ] {
        let Some(picture) = plot else { continue };
        let source = data_uri(&picture)?;
        body += &format!(
            "<section><h2>{heading}</h2><p>{note}</p><img class=plot src='{source}' alt='{heading}'></section>\n"
        );
    }
    Ok(format!(
        "<!doctype html>\n<html lang=en><meta charset=utf-8><meta name=viewport content='width=device-width'>\
         <title>{title}</title>\n<style>{STYLE}</style>\n<header><h1>{title}</h1></header>\n<main>{body}</main>\n\
         <footer>Pyrophone {}</footer>\n",
        env!("CARGO_PKG_VERSION"),
    ))
}

fn seconds(report: &Report<'_>) -> Axis {
    let end = report.flux.len() as f64 / report.rate_hz;
    let sound_s = report.pressure.len() as f64 / f64::from(report.sample_rate_hz);
    Axis { range: (0.0, end.max(sound_s).max(1e-6)), logarithmic: false, unit: "s" }
}

fn steps(report: &Report<'_>, values: &[f64]) -> Vec<(f64, f64)> {
    values.iter().enumerate().map(|(step, value)| (step as f64 / report.rate_hz, *value)).collect()
}

fn flux(report: &Report<'_>) -> Result<Option<Picture>, String> {
    let points = steps(report, report.flux);
    let y = Axis::around(report.flux.iter().copied(), "volume/s");
    Plot { points: &points, color: GLOW, x: seconds(report), y, band: None }.draw().map(Some)
}

fn area(report: &Report<'_>) -> Result<Option<Picture>, String> {
    if report.area.is_empty() {
        return Ok(None);
    }
    let points = steps(report, report.area);
    let y = Axis::around(report.area.iter().copied(), "area");
    Plot { points: &points, color: ASH, x: seconds(report), y, band: None }.draw().map(Some)
}

fn pressure(report: &Report<'_>) -> Result<Picture, String> {
    let rate_hz = f64::from(report.sample_rate_hz);
    let points: Vec<(f64, f64)> =
        report.pressure.iter().enumerate().map(|(n, sample)| (n as f64 / rate_hz, f64::from(*sample))).collect();
    let y = Axis::around(points.iter().map(|point| point.1), "full scale");
    Plot { points: &points, color: EMBER, x: seconds(report), y, band: None }.draw()
}

fn spectrum_of(report: &Report<'_>, spectrum: &Spectrum) -> Result<Option<Picture>, String> {
    let points = spectrum.levels_db(LOWEST_HZ, spectrum.nyquist_hz());
    let loudest = points.iter().fold(f64::NEG_INFINITY, |loudest, point| loudest.max(point.1));
    if report.is_envelope || loudest < -250.0 {
        return Ok(None);
    }
    let top = (loudest / 10.0).ceil() * 10.0;
    let x = Axis { range: (LOWEST_HZ, spectrum.nyquist_hz()), logarithmic: true, unit: "Hz" };
    let y = Axis { range: (top - RANGE_DB, top), logarithmic: false, unit: "dB/Hz" };
    Plot { points: &points, color: EMBER, x, y, band: Some(BAND_HZ) }.draw().map(Some)
}

fn table(heading: &str, rows: &[(String, String)]) -> String {
    let rows: String =
        rows.iter().map(|(label, value)| format!("<tr><th>{}<td>{}", escaped(label), escaped(value))).collect();
    format!("<div><h2>{heading}</h2><table>{rows}</table></div>\n")
}

/// A picture as an embedded PNG.
fn data_uri(picture: &Picture) -> Result<String, String> {
    let mut bytes = vec![];
    let mut encoder = png::Encoder::new(&mut bytes, picture.width, picture.height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let failed = |error: png::EncodingError| error.to_string().replace(['\n', '\r'], " ");
    let mut writer = encoder.write_header().map_err(failed)?;
    writer.write_image_data(&picture.rgb).map_err(failed)?;
    writer.finish().map_err(failed)?;
    Ok(format!("data:image/png;base64,{}", STANDARD.encode(&bytes)))
}

/// Text with HTML special characters escaped.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;").replace('\'', "&#39;")
}

const STYLE: &str = "
:root { color-scheme: dark; --ground: #0e0a0a; --card: #151010; --line: #2c2220; --text: #eadfd6; --dim: #a4948a; --ember: #ff7a2f; --glow: #ffc454 }
* { box-sizing: border-box }
html { background: var(--ground) }
body { margin: 0 auto; max-width: 1180px; padding: 0 24px 48px; color: var(--text); font: 15px/1.5 system-ui, 'Segoe UI', 'Helvetica Neue', sans-serif }
header { padding: 36px 0 0 }
h1 { margin: 0; font-size: 38px; font-weight: 650; letter-spacing: -.02em; background: linear-gradient(90deg, #fff3d0, var(--glow) 30%, var(--ember) 65%, #b3261a); background-clip: text; -webkit-background-clip: text; color: transparent; width: max-content; max-width: 100% }
section { padding-top: 28px }
h2 { margin: 0 0 8px; font-size: 20px; font-weight: 620; letter-spacing: -.01em }
section > p { margin: -4px 0 10px; color: var(--dim) }
.tables { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 440px), 1fr)); gap: 20px }
table { width: 100%; border-collapse: collapse; background: var(--card); border: 1px solid var(--line); font-variant-numeric: tabular-nums }
th, td { padding: 6px 14px; text-align: left; vertical-align: top; border-top: 1px solid var(--line); overflow-wrap: anywhere }
th { font-weight: 500; color: var(--dim); width: 11em }
.fronts { display: grid; grid-template-columns: repeat(auto-fill, minmax(170px, 1fr)); gap: 10px }
figure { margin: 0; background: #110c0c; border: 1px solid var(--line); border-radius: 8px; overflow: hidden }
figure img, .plot { display: block; width: 100% }
.plot { border: 1px solid var(--line); border-radius: 8px }
figcaption { padding: 4px 10px 6px; font-size: 12.5px; color: var(--dim); font-variant-numeric: tabular-nums }
footer { padding-top: 28px; font-size: 12.5px; color: #8d7d73 }
";

#[cfg(test)]
mod tests {
    use super::*;

    fn report<'a>(flux: &'a [f64], pressure: &'a [f32]) -> Report<'a> {
        Report {
            title: "<b>'x' & \"y\"".into(),
            facts: vec![("a<b".into(), "c>d".into())],
            surfaces: vec![("1 < 2".into(), Picture { width: 1, height: 1, rgb: vec![1, 2, 3] })],
            flux,
            area: &[],
            rate_hz: 360.0,
            pressure,
            sample_rate_hz: 44_100,
            is_envelope: false,
        }
    }

    #[test]
    fn text_from_outside_cannot_become_markup() {
        let page = render(&report(&[0.0, 1.0], &[0.0, 0.5, 0.0])).unwrap();
        assert!(
            page.contains("&lt;b&gt;&#39;x&#39; &amp; &quot;y") && page.contains("1 &lt; 2") && page.contains("a&lt;b")
        );
        assert!(!page.contains("<b>"));
    }

    #[test]
    fn page_embeds_its_pictures_and_links_nowhere() {
        let page = render(&report(&[0.0, 1.0], &[0.0, 0.5, 0.0])).unwrap();
        let sources = page.matches("src='").count();
        assert!(sources >= 4 && page.matches("src='data:image/png;base64,").count() == sources);
        assert!(!page.contains("http"));
    }

    #[test]
    fn nothing_and_silence_have_a_page_too() {
        for (flux, pressure) in [(&[][..], &[][..]), (&[1.0; 10], &[0.0; 1000])] {
            assert!(render(&report(flux, pressure)).unwrap().contains("silence"));
        }
    }
}
