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

/// Button of the page to be opened, and an item that only that page has; see `editor::map` of the plug-in.
const PAGE: &str = "button.Engines";
const ON_THE_PAGE: &str = "knob.alpha";

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
            .args(["-displayfd", "1", "-screen", "0", "1280x900x24", "+extension", "GLX", "-nolisten", "tcp"])
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

    /// Clicks on the name of a page until that page is drawn. `map` is the file with the positions of the window's
    /// items.
    pub fn turn_page(&self, map: &Path) -> Result<()> {
        let began = Instant::now();
        while began.elapsed() < PATIENCE {
            std::thread::sleep(GLANCE);
            // There is none before the first frame.
            let text = std::fs::read_to_string(map).unwrap_or_default();
            if middle(&text, ON_THE_PAGE).is_some() {
                return Ok(());
            }
            if let Some(place) = middle(&text, PAGE) {
                self.click(place)?;
            }
        }
        let drawn = std::fs::read_to_string(map).map(|text| text.lines().next().unwrap_or_default().to_owned());
        bail!("{ON_THE_PAGE} is not seen within {PATIENCE:?} of clicks on {PAGE}; drawn: {drawn:?}")
    }

    fn click(&self, (x, y): (i32, i32)) -> Result<()> {
        let mut mouse = Command::new("xdotool");
        mouse.args(["search", "--onlyvisible", "--name", "^Pyrophone$", "mousemove", "--window", "%1"]);
        mouse.args([x.to_string(), y.to_string()]).args(["click", "1"]).env("DISPLAY", &self.display);
        let moved = mouse.stdout(Stdio::null()).status().context("calling xdotool")?;
        ensure!(moved.success(), "there is no window to click on");
        Ok(())
    }

    /// Saves a picture of the window with this map. Under Wine, graphics drivers may draw beside the screen, where a
    /// picture of the screen would not show it.
    pub fn photograph(&self, map: &Path, file: &Path) -> Result<()> {
        let map = std::fs::read_to_string(map).with_context(|| map.display().to_string())?;
        let list = Command::new("xwininfo").args(["-root", "-tree"]).env("DISPLAY", &self.display).output();
        let list = String::from_utf8_lossy(&list.context("calling xwininfo")?.stdout).into_owned();
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
