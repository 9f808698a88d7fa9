//! A virtual screen, and a mouse on it.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail, ensure};

use crate::setup::is_program;

/// Limit of every wait, generous because Wine draws slowly and machines may be busy.
const PATIENCE: Duration = Duration::from_secs(300);
const GLANCE: Duration = Duration::from_secs(2);

/// Title of the window that our host gives an editor.
pub(super) const WINDOW: &str = "Pyrophone";
/// Place in a window at which something is dropped, in pixels from its corner: within any window.
const DROPPED_AT: (i32, i32) = (300, 300);

/// Reason why a screen or a mouse is impossible here, if any.
pub(super) fn obstacle() -> Option<&'static str> {
    ["Xvfb", "xdotool", "import", "xwininfo"]
        .into_iter()
        .any(|name| !is_program(name))
        .then_some("it needs a screen, a mouse and pictures (`apt-get install xvfb xdotool imagemagick x11-utils`)")
}

/// An X server of our own.
pub(super) struct Screen {
    server: Child,
    display: String,
}

impl Screen {
    pub fn start() -> Result<Self> {
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "2560x1700x24", "+extension", "GLX", "-nolisten", "tcp"])
            .arg("-noreset")
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .context("calling Xvfb")?;
        let mut number = String::new();
        if let Some(output) = server.stdout.as_mut() {
            BufReader::new(output).read_line(&mut number)?;
        }
        Ok(Self { server, display: format!(":{}", number.trim()) })
    }

    pub fn display(&self) -> &str {
        &self.display
    }

    /// Clicks on an item of the window until another one is there. `map` is the file with the positions of the window's
    /// items.
    pub fn click_until(&self, map: &Path, (clicked, wanted): (&str, &str)) -> Result<()> {
        self.until(map, wanted, |items| {
            if let Some(place) = middle(items, clicked) {
                self.mouse(&at(place), &["click", "1"])?;
            }
            Ok(())
        })
    }

    /// Waits until an item is there, and clicks on it once.
    pub fn click(&self, map: &Path, item: &str) -> Result<()> {
        self.wait_for(map, item)?;
        self.mouse(&at(self.place(map, item)?), &["click", "1"])
    }

    /// Waits until an item is there.
    pub fn wait_for(&self, map: &Path, item: &str) -> Result<()> {
        self.until(map, item, |_| Ok(()))
    }

    /// Waits until an item is there whose name begins like this.
    pub fn wait_for_any(&self, map: &Path, start: &str) -> Result<()> {
        let is_wanted = |items: &str| names(items).any(|name| name.starts_with(start));
        self.while_not(map, start, is_wanted, |_| Ok(()))
    }

    /// Waits until an item is there, and does something every so often until then.
    fn until(&self, map: &Path, wanted: &str, step: impl Fn(&str) -> Result<()>) -> Result<()> {
        self.while_not(map, wanted, |items| middle(items, wanted).is_some(), step)
    }

    /// Waits for a map on which something is there, and does something every so often until then.
    fn while_not(
        &self,
        map: &Path,
        wanted: &str,
        is_there: impl Fn(&str) -> bool,
        step: impl Fn(&str) -> Result<()>,
    ) -> Result<()> {
        let began = Instant::now();
        while began.elapsed() < PATIENCE {
            std::thread::sleep(GLANCE);
            // There is none before the first frame.
            let items = std::fs::read_to_string(map).unwrap_or_default();
            if is_there(&items) {
                return Ok(());
            }
            step(&items)?;
        }
        let drawn = std::fs::read_to_string(map).map(|text| text.lines().next().unwrap_or_default().to_owned());
        bail!("{wanted} is not seen within {PATIENCE:?}; drawn: {drawn:?}")
    }

    fn place(&self, map: &Path, item: &str) -> Result<(i32, i32)> {
        let items = std::fs::read_to_string(map).with_context(|| map.display().to_string())?;
        middle(&items, item).with_context(|| format!("{item} is not in the window"))
    }

    /// Types a line into a window with this title, once there is one.
    pub fn enter(&self, title: &str, line: &str) -> Result<()> {
        let began = Instant::now();
        let focus = ["search", "--onlyvisible", "--name", title, "windowfocus", "--sync", "%1"];
        while !self.xdotool(&focus)? {
            ensure!(began.elapsed() < PATIENCE, "no window with the title {title} within {PATIENCE:?}");
            std::thread::sleep(GLANCE);
        }
        std::thread::sleep(GLANCE);
        ensure!(self.xdotool(&["type", "--delay", "50", line])?, "{line} cannot be typed");
        ensure!(self.xdotool(&["key", "Return"])?, "{line} cannot be entered");
        Ok(())
    }

    /// Drags from the middle of the window with this title to an item of the plug-in's.
    pub fn drag(&self, title: &str, map: &Path, item: &str) -> Result<()> {
        let began = Instant::now();
        let press = ["search", "--onlyvisible", "--name", title, "mousemove", "--window", "%1", "60", "30"];
        while !self.xdotool(&press)? {
            ensure!(began.elapsed() < PATIENCE, "no window with the title {title} within {PATIENCE:?}");
            std::thread::sleep(GLANCE);
        }
        let (x, y) = self.place(map, item)?;
        ensure!(self.xdotool(&["mousedown", "1"])?, "the mouse cannot be pressed");
        // Sources notice a drag by the mouse's first steps, and targets by those after it has entered.
        for step in [200, 100, 20, 0] {
            std::thread::sleep(GLANCE);
            self.mouse(&at((x + step, y)), &[])?;
        }
        std::thread::sleep(GLANCE);
        ensure!(self.xdotool(&["mouseup", "1"])?, "the mouse cannot be released");
        Ok(())
    }

    /// Drags an item of the plug-in's window to the window with this title.
    pub fn drag_out(&self, map: &Path, item: &str, title: &str) -> Result<()> {
        self.wait_for(map, item)?;
        let (x, y) = self.place(map, item)?;
        self.mouse(&at((x, y)), &["mousedown", "1"])?;
        // The window notices a drag by the mouse's first steps.
        for step in [4, 12, 24] {
            std::thread::sleep(GLANCE);
            self.mouse(&at((x + step, y)), &[])?;
        }
        let (x, y) = DROPPED_AT;
        for step in [30, 10, 0] {
            std::thread::sleep(GLANCE);
            self.mouse_in(title, &at((x + step, y)), &[])?;
        }
        std::thread::sleep(GLANCE);
        ensure!(self.xdotool(&["mouseup", "1"])?, "the mouse cannot be released");
        Ok(())
    }

    /// Moves the window with this title to a place on the screen.
    pub fn move_window(&self, title: &str, place: (i32, i32)) -> Result<()> {
        let ([x, y], title) = (at(place), format!("^{title}$"));
        let moved = self.xdotool(&["search", "--onlyvisible", "--name", &title, "windowmove", "%1", &x, &y])?;
        ensure!(moved, "there is no window {title} to move");
        Ok(())
    }

    /// Moves the mouse to a place in the plug-in's window, and does something more.
    fn mouse(&self, place: &[String; 2], more: &[&str]) -> Result<()> {
        self.mouse_in(WINDOW, place, more)
    }

    /// Moves the mouse to a place in the window with this title, and does something more.
    fn mouse_in(&self, title: &str, place: &[String; 2], more: &[&str]) -> Result<()> {
        let ([x, y], title) = (place, format!("^{title}$"));
        let moved = ["search", "--onlyvisible", "--name", &title, "mousemove", "--window", "%1", x, y];
        ensure!(self.xdotool(&[&moved, more].concat())?, "there is no window {title} to point at");
        Ok(())
    }

    /// True if a call of xdotool succeeds.
    fn xdotool(&self, arguments: &[&str]) -> Result<bool> {
        let mut tool = Command::new("xdotool");
        tool.args(arguments).env("DISPLAY", &self.display).stdout(Stdio::null()).stderr(Stdio::null());
        Ok(tool.status().context("calling xdotool")?.success())
    }

    /// Fails unless the host's window is as large as the plug-in's on this map.
    pub fn has_window_of(&self, map: &Path) -> Result<()> {
        let map = std::fs::read_to_string(map).with_context(|| map.display().to_string())?;
        let size = size(&map).context("the map has no size")?;
        let list = self.windows()?;
        let window = list.lines().find(|line| line.contains("\"Pyrophone\"")).unwrap_or("there is none");
        ensure!(window.contains(&format!(" {size}+")), "the host's window is not of {size} pixels: {window}");
        Ok(())
    }

    /// All windows, as `xwininfo` lists them.
    fn windows(&self) -> Result<String> {
        let list = Command::new("xwininfo").args(["-root", "-tree"]).env("DISPLAY", &self.display).output();
        Ok(String::from_utf8_lossy(&list.context("calling xwininfo")?.stdout).into_owned())
    }

    /// Saves a picture of the window with this map. Under Wine, graphics drivers may draw beside the screen, where a
    /// picture of the screen would not show it.
    pub fn photograph(&self, map: &Path, file: &Path) -> Result<()> {
        let map = std::fs::read_to_string(map).with_context(|| map.display().to_string())?;
        let list = self.windows()?;
        let drawn = size(&map).and_then(|size| drawn_beside(&list, &size));
        let mut camera = Command::new("import");
        camera.args(["-window", drawn.context("nothing of the window's size is drawn")?]).arg(file);
        let taken = camera.env("DISPLAY", &self.display).status().context("calling import")?;
        ensure!(taken.success(), "{} cannot be written", file.display());
        Ok(())
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        // Fails if the server has ended by itself, which is fine.
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// A place as the mouse takes it.
fn at((x, y): (i32, i32)) -> [String; 2] {
    [x, y].map(|number| number.to_string())
}

/// The names on a window's map.
fn names(map: &str) -> impl Iterator<Item = &str> {
    map.lines().filter_map(|line| line.splitn(5, ' ').nth(4))
}

/// The middle of something on a window's map, if it is there: lines of left, top, right, bottom and name.
fn middle(map: &str, name: &str) -> Option<(i32, i32)> {
    let line = map.lines().find(|line| line.splitn(5, ' ').nth(4) == Some(name))?;
    let mut edges = line.split(' ').map_while(|word| word.parse::<i32>().ok());
    let [left, top, right, bottom] = [edges.next()?, edges.next()?, edges.next()?, edges.next()?];
    Some((left + (right - left) / 2, top + (bottom - top) / 2))
}

/// Width and height of the window on its map, such as `1100x790`.
fn size(map: &str) -> Option<String> {
    map.lines().find_map(|line| line.strip_prefix("size ")).map(|size| size.replace(' ', "x"))
}

/// Number of the unnamed window of this size, in the output of `xwininfo -tree`.
fn drawn_beside<'a>(list: &'a str, size: &str) -> Option<&'a str> {
    let place = format!(" {size}+0+0 ");
    let line = list.lines().find(|line| line.contains("(has no name)") && line.contains(&place))?;
    line.split_whitespace().next()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn things_are_found_on_a_map() {
        let map = "frame 7\nsize 1060 760\nui_us 1500\n10 20 30 41 button.Engines\n0 0 5 5 a b\n";
        assert_eq!(middle(map, "button.Engines"), Some((20, 30)));
        assert_eq!(middle(map, "a b"), Some((2, 2)));
        assert_eq!(middle(map, "b"), None);
        assert_eq!(middle("", "a"), None);
        assert_eq!(names(map).collect::<Vec<_>>(), ["button.Engines", "a b"]);
    }

    #[test]
    fn the_picture_is_of_what_is_drawn() {
        let list = "     0x600001 \"Pyrophone\": (\"window.exe\" \"window.exe\")  1100x790+4+23  +4+23\n        \
                    0x40002d (has no name): ()  1100x790+0+0  +-1+-1\n";
        assert_eq!(size("frame 7\nsize 1100 790\n").as_deref(), Some("1100x790"));
        assert_eq!(drawn_beside(list, "1100x790"), Some("0x40002d"));
        assert_eq!(drawn_beside(list, "800x600"), None);
    }
}
