//! The editor opens in a host's window, draws, closes and opens again.

use std::collections::HashMap;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use pyrophone_host::editor::EditorWindow;
use pyrophone_host::{Configuration, Format};
use pyrophone_tests::live::{Clock, Live};
use pyrophone_tests::{
    RATE_HZ, STEREO, await_recording, flame, load_session, open, preset, recording, session, target_dir,
};
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{ConnectionExt, ImageFormat};

/// A display, and the server that is ours to end.
struct Screen(Option<Child>);

impl Screen {
    /// The display that `DISPLAY` names, else a server of our own; none where there is neither.
    fn open() -> Option<Self> {
        if std::env::var_os("DISPLAY").is_some() {
            return Some(Self(None));
        }
        let server = Command::new("Xvfb")
            // Without -noreset it starts over whenever its last client leaves, and refuses whoever comes meanwhile.
            .args([
                "-displayfd",
                "1",
                "-screen",
                "0",
                "1280x800x24",
                "+extension",
                "GLX",
                "-nolisten",
                "tcp",
                "-noreset",
            ])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let mut server = match server {
            Ok(server) => server,
            Err(error) => {
                assert!(std::env::var("CI").as_deref() != Ok("true"), "no DISPLAY, and Xvfb: {error}");
                eprintln!("skipped: no DISPLAY, and Xvfb: {error}");
                return None;
            }
        };
        let mut number = String::new();
        let output = server.stdout.as_mut().expect("a pipe");
        BufReader::new(output).read_line(&mut number).expect("Xvfb tells its display");
        // SAFETY: the only test of this program; no other thread reads or writes the environment yet.
        unsafe { std::env::set_var("DISPLAY", format!(":{}", number.trim())) };
        Some(Self(Some(server)))
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        if let Some(server) = &mut self.0 {
            // It may have ended by itself; then there is nothing to end.
            let _ = server.kill();
            let _ = server.wait();
        }
    }
}

/// Red, green and blue of every pixel of a window that lies wholly on the screen, row by row.
struct Picture {
    width: u32,
    height: u32,
    rgb: Vec<u8>,
}

impl Picture {
    fn of(window: &EditorWindow) -> Self {
        let (connection, _) = x11rb::connect(None).expect("a display");
        let (width, height) = window.size();
        let image = connection
            .get_image(ImageFormat::Z_PIXMAP, window.id(), 0, 0, width as u16, height as u16, !0)
            .expect("a request")
            .reply()
            .expect("the window lies on the screen");
        assert!(image.depth >= 24, "a screen of {} bits", image.depth);
        assert_eq!(connection.setup().image_byte_order, x11rb::protocol::xproto::ImageOrder::LSB_FIRST);
        // 32 bits per pixel, blue first.
        let rgb = image.data.chunks_exact(4).flat_map(|pixel| [pixel[2], pixel[1], pixel[0]]).collect();
        Self { width, height, rgb }
    }

    /// How many pixels have each colour.
    fn colours(&self) -> HashMap<[u8; 3], usize> {
        let mut colours = HashMap::new();
        for pixel in self.rgb.as_chunks::<3>().0 {
            *colours.entry(*pixel).or_default() += 1;
        }
        colours
    }

    /// Whether something is drawn: text in many shades, and no single colour nearly everywhere.
    fn is_drawn(&self) -> bool {
        let colours = self.colours();
        let most = colours.values().max().copied().unwrap_or(0);
        colours.len() > 40 && most * 100 < (self.rgb.len() / 3) * 98
    }

    fn save(&self, path: &Path) {
        let file = std::fs::File::create(path).expect("created");
        let mut encoder = png::Encoder::new(std::io::BufWriter::new(file), self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        let mut writer = encoder.write_header().expect("written");
        writer.write_image_data(&self.rgb).expect("written");
    }
}

#[test]
fn opens_draws_closes_and_opens_again() {
    let Some(_screen) = Screen::open() else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = recording(folder.path(), "campfire.wav", 2, 150_000);
    let mut plugin = open(Format::Clap);
    load_session(plugin.as_mut(), &preset("default", &[]), &session(Some(&path), None));
    await_recording(plugin.as_mut(), RATE_HZ, STEREO);
    let mut live = Live::start(plugin, RATE_HZ, STEREO);
    let input = flame(81, 2, 4096);
    let mut position = 0;
    for round in 0..3 {
        let window = EditorWindow::open(live.plugin(), "Pyrophone").unwrap_or_else(|error| panic!("{error}"));
        let (width, height) = window.size();
        assert!((400..=1280).contains(&width) && (300..=800).contains(&height), "{width} x {height}");
        let began = Instant::now();
        let picture = loop {
            // It plays meanwhile, so that there are levels to show.
            let output = live.play(&input, Clock::Playing(position), 512);
            assert!(pyrophone_tests::peak(&output[0]).is_finite());
            position += 4096;
            window.run_for(live.plugin(), Duration::from_millis(90));
            let picture = Picture::of(&window);
            if picture.is_drawn() && began.elapsed() > Duration::from_secs(2) {
                break picture;
            }
            assert!(began.elapsed() < Duration::from_secs(60), "nothing is drawn: {} colours", picture.colours().len());
        };
        if round == 0 {
            let path = target_dir().join("editor.png");
            picture.save(&path);
            println!("the editor as drawn: {} ({} colours)", path.display(), picture.colours().len());
        }
        window.close(live.plugin());
    }
    // It outlives its editor, and may go with the editor open.
    let mut plugin = live.stop();
    let window = EditorWindow::open(plugin.as_mut(), "Pyrophone").expect("opened while inactive");
    window.run_for(plugin.as_mut(), Duration::from_millis(300));
    let configuration = Configuration { sample_rate: 48_000.0, max_block: 512, layout: STEREO, offline: false };
    let processor = plugin.activate(&configuration).expect("active with its editor open");
    plugin.deactivate(processor).expect("inactive");
    window.close(plugin.as_mut());
}
