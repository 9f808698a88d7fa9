//! A desk to try editors at: a screen, a hand on mouse and keyboard, and an eye for what is drawn.
//!
//! A program that uses it may hold one test only: the desk is set up in the environment, which all threads share.

mod drag_source;
mod map;
mod picture;
mod spot;
mod ui_driver;

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use pyrophone_host::Plugin;
use pyrophone_host::editor::EditorWindow;
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{AtomEnum, PropMode};
use x11rb::wrapper::ConnectionExt;

pub use map::Map;
pub use picture::Picture;
pub use spot::DropSpot;
pub use ui_driver::{ESCAPE, RETURN, UiDriver};

use crate::target_dir;

/// Size of the screen of a server of our own, in pixels.
pub const SCREEN: (u32, u32) = (1280, 800);

/// Limit of every wait, generous because machines may be slow and busy.
pub const PATIENCE: Duration = Duration::from_secs(30);

/// Limits how often the window draws.
const FRAMES_VARIABLE: &str = "PYROPHONE_FRAMES_PER_SECOND";

/// A screen, and a folder that the editors' files are in.
pub struct TestDisplay {
    folder: tempfile::TempDir,
    server: Option<Child>,
}

impl TestDisplay {
    /// On the display that `DISPLAY` names, else on a server of our own; none where there is neither, but for continuous integration,
    /// where a test that is left out has failed.
    pub fn set_up() -> Option<Self> {
        let server = match std::env::var_os("DISPLAY") {
            Some(_) => None,
            None => Some(start_server()?),
        };
        let desk = Self { folder: tempfile::tempdir().expect("a temporary folder"), server };
        let variables = [
            ("PYROPHONE_PRESETS", desk.presets()),
            ("PYROPHONE_EDITOR_MAP", desk.map_file()),
            ("PYROPHONE_DIALOG", desk.dialog_answer()),
        ];
        // Tests play faster than time goes by, and software draws what they look at: fewer frames leave more of the machine.
        if std::env::var_os(FRAMES_VARIABLE).is_none() {
            // SAFETY: the only test of its program, and no plugin is there yet; nobody else reads or writes the environment.
            unsafe { std::env::set_var(FRAMES_VARIABLE, "15") };
        }
        for (name, path) in variables {
            // SAFETY: the only test of its program, and no plugin is there yet; nobody else reads or writes the environment.
            unsafe { std::env::set_var(name, path) };
        }
        Some(desk)
    }

    /// Makes pixels smaller for windows that open from now on, as desktops do by `Xft.dpi`; with 0 the desktop tells
    /// nothing. Only on a server of our own.
    pub fn scale_screen(&self, scale: f64) -> bool {
        if self.server.is_none() {
            return false;
        }
        let (connection, screen) = x11rb::connect(None).expect("a display");
        let root = connection.setup().roots[screen].root;
        let resources = if scale > 0.0 { format!("Xft.dpi:\t{:.0}\n", 96.0 * scale) } else { String::new() };
        let (name, kind) = (AtomEnum::RESOURCE_MANAGER, AtomEnum::STRING);
        connection
            .change_property8(PropMode::REPLACE, root, name, kind, resources.as_bytes())
            .expect("a request")
            .check()
            .expect("resources");
        true
    }

    /// A folder of its own.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// The user's presets; none at first.
    pub fn presets(&self) -> PathBuf {
        self.folder().join("presets")
    }

    /// The file that is chosen in the system's dialog; it is not there at first.
    pub fn dialog_answer(&self) -> PathBuf {
        self.folder().join("chosen in the dialog.wav")
    }

    fn map_file(&self) -> PathBuf {
        self.folder().join("map")
    }

    /// Map of the window that has drawn last, once one has.
    pub fn map(&self) -> Option<Map> {
        Map::read(&self.map_file())
    }

    /// Opens an editor; the map is that of its window from then on, once it has drawn.
    pub fn open(&self, plugin: &mut dyn Plugin) -> EditorWindow {
        // There is none at first.
        let _ = std::fs::remove_file(self.map_file());
        EditorWindow::open(plugin, "Pyrophone").unwrap_or_else(|error| panic!("{error}"))
    }

    /// Opens an editor, and makes `pass` until it is drawn.
    pub fn open_drawn(&self, plugin: &mut dyn Plugin, mut pass: impl FnMut()) -> EditorWindow {
        for _ in 0..3 {
            let mut window = self.open(plugin);
            let began = Instant::now();
            while began.elapsed() < PATIENCE {
                pass();
                window.run_for(plugin, Duration::from_millis(20));
                if self.map().is_some_and(|map| map.frames >= 3) && Picture::of_window(&window).is_drawn() {
                    return window;
                }
            }
            // With baseview 0.4.2 a window that is asked to draw before it is shown may stay empty. The effect asks later; should it
            // happen all the same, users open the window again, and so does this, but not for ever.
            println!("nothing was drawn in {PATIENCE:?}; opening the window again");
            window.close(plugin);
        }
        panic!("nothing is drawn, however often it is opened");
    }

    /// Keeps a picture of a window among what was built.
    pub fn screenshot(window: &EditorWindow, name: &str) -> Picture {
        let folder = target_dir().join("screenshots");
        std::fs::create_dir_all(&folder).expect("a folder");
        let picture = Picture::of_window(window);
        picture.save(&folder.join(format!("{name}.png")));
        picture
    }
}

fn start_server() -> Option<Child> {
    let (width, height) = SCREEN;
    let server = Command::new("Xvfb")
        .args(["-displayfd", "1", "-screen", "0", &format!("{width}x{height}x24"), "+extension", "GLX"])
        // Without -noreset it starts over whenever its last client leaves, and refuses whoever comes meanwhile. With -r a key
        // that is held a little too long on a busy machine is one key all the same.
        .args(["-nolisten", "tcp", "-noreset", "-r"])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn();
    let mut server = match server {
        Ok(server) => server,
        Err(error) => {
            assert!(std::env::var("CI").as_deref() != Ok("true"), "no DISPLAY, and Xvfb: {error}");
            crate::skip::skip(&format!("no DISPLAY, and Xvfb: {error}"));
            return None;
        }
    };
    let mut number = String::new();
    let output = server.stdout.as_mut().expect("a pipe");
    BufReader::new(output).read_line(&mut number).expect("Xvfb tells its display");
    // SAFETY: the only test of its program; no other thread reads or writes the environment yet.
    unsafe { std::env::set_var("DISPLAY", format!(":{}", number.trim())) };
    Some(server)
}

/// Waits until no thread has ended for two seconds, or for fifteen in all.
fn settle() {
    let threads = || std::fs::read_dir("/proc/self/task").map_or(0, Iterator::count);
    let (began, mut since, mut last) = (Instant::now(), Instant::now(), threads());
    while since.elapsed() < Duration::from_secs(2) && began.elapsed() < Duration::from_secs(15) {
        std::thread::sleep(Duration::from_millis(50));
        let now = threads();
        if std::mem::replace(&mut last, now) != now {
            since = Instant::now();
        }
    }
}

impl Drop for TestDisplay {
    fn drop(&mut self) {
        if let Some(server) = &mut self.server {
            // baseview 0.4.2 does not always wait for a window's thread to end, and Xlib ends a program whose server has gone.
            settle();
            // It may have ended by itself; then there is nothing to end.
            let _ = server.kill();
            let _ = server.wait();
        }
    }
}
