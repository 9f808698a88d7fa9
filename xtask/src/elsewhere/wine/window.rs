//! The plug-in's window under Wine: drawn, clicked, and given files by the system's dialog and by dropping them.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command};

use anyhow::{Context, Result, bail, ensure};

use super::super::screen::{Screen, WINDOW};
use super::{Wine, release, shown};

/// The bundles with a window.
const BUNDLES: [&str; 2] = ["Pyrophone.clap", "Pyrophone.vst3"];
/// Button of a page to be opened, and an item that only that page has; see `editor::map` of the plug-in.
const PAGE: (&str, &str) = ("button.Engines", "knob.alpha");
/// Button that opens the system's dialog, and that dialog's title.
const DIALOG: (&str, &str) = ("button.Load recording", "Load a recording of fire");

/// Dots per inch of a screen on which everything has twice the usual size.
const DENSE: u32 = 192;

/// Where the window begins from which a file is dragged: beside the plug-in's.
const DRAGGED_FROM: (i32, i32) = (1300, 100);
/// Title and place of the window onto which a take is dragged, beside the other one.
const RECEIVER: (&str, (i32, i32)) = ("Receiver", (1300, 100));
/// Buttons that record a take and drag it out, and what a window says of it that has loaded it.
const RECORD: &str = "button.Record";
const DRAG_OUT: &str = "button.Drag out";
const TAKE: &str = "recording.take ";
/// A folder and a file whose path has more characters than Windows used to allow, some of which are in no code page.
const FAR: &str = "recordings of fires, each in a folder with a long name";
const NAME: &str = "Höllenfeuer 火の音 огонь.wav";
/// What the window says of the recording beside its name.
const FACTS: &str = ": 4.0 s, 48 kHz, stereo";
/// Windows' old limit for the characters of a path.
const OLD_LIMIT: usize = 260;

/// A window with a plug-in's editor, which closes at the end.
pub(super) struct Opened {
    program: Child,
    pub(super) map: PathBuf,
}

impl Drop for Opened {
    fn drop(&mut self) {
        // It would run for the whole time requested.
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

impl Wine {
    /// Opens a bundle's window.
    fn open(&self, bundle: &str, folder: &Path) -> Result<Opened> {
        self.open_as(WINDOW, bundle, folder)
    }

    /// Opens a bundle's window under a title.
    fn open_as(&self, title: &str, bundle: &str, folder: &Path) -> Result<Opened> {
        self.open_at(title, &folder.join("bundled").join(bundle), folder)
    }

    /// Opens the window of a bundle at a path.
    pub(super) fn open_at(&self, title: &str, bundle: &Path, folder: &Path) -> Result<Opened> {
        let name = bundle.file_name().unwrap_or_default().to_string_lossy();
        let map = folder.join(format!("{title}.{name}.map"));
        let _ = fs::remove_file(&map);
        let mut command = self.command(&release().join("examples/window.exe"), folder);
        command.arg(shown(bundle)).args(["600", title]);
        command.env("PYROPHONE_EDITOR_MAP", shown(&map));
        Ok(Opened { program: command.spawn().context("calling wine")?, map })
    }

    /// Opens both bundles' windows, and turns a page of each.
    pub fn windows(&self, screen: &Screen, folder: &Path) -> Result<()> {
        for bundle in BUNDLES {
            let window = self.open(bundle, folder)?;
            screen.click_until(&window.map, PAGE).with_context(|| format!("the window of {bundle}"))?;
            screen.photograph(&window.map, &folder.join(format!("{bundle}.png")))?;
        }
        Ok(())
    }

    /// The same on a screen with twice the usual dots per inch, in a Windows that is used for nothing else: programs that
    /// run already do not notice. Whether the window is enlarged there depends on Wine; that host and plug-in agree on its
    /// size does not.
    pub fn dense_windows(&self, screen: &Screen, folder: &Path) -> Result<()> {
        let wine = self.on_screen(screen, "wine-with-dense-screen")?;
        let dots = DENSE.to_string();
        let desktop = r"HKEY_CURRENT_USER\Control Panel\Desktop";
        wine.system(&["reg", "add", desktop, "/v", "LogPixels", "/t", "REG_DWORD", "/d", &dots, "/f"])?;
        for bundle in BUNDLES {
            let window = wine.open(bundle, folder)?;
            let tried = screen.click_until(&window.map, PAGE).and_then(|()| {
                screen.has_window_of(&window.map)?;
                screen.photograph(&window.map, &folder.join(format!("{bundle}.dense.png")))
            });
            tried.with_context(|| format!("the window of {bundle}"))?;
        }
        Ok(())
    }

    /// Loads a recording by the system's dialog.
    pub fn dialog(&self, screen: &Screen, folder: &Path) -> Result<()> {
        let (button, title) = DIALOG;
        let recording = self.recording(folder)?;
        for bundle in BUNDLES {
            let window = self.open(bundle, folder)?;
            let loaded = screen.click(&window.map, button).and_then(|()| {
                // The dialog accepts Windows' own slashes only.
                screen.enter(title, &shown(&recording).replace('/', "\\"))?;
                screen.wait_for(&window.map, &format!("recording.fire.wav{FACTS}"))
            });
            loaded.with_context(|| format!("the window of {bundle}"))?;
        }
        Ok(())
    }

    /// Drops a recording on the window: from another program, from another drive, with a long path in several scripts.
    pub fn drops(&self, screen: &Screen, folder: &Path) -> Result<()> {
        let path = self.far_recording(folder)?;
        for bundle in BUNDLES {
            let window = self.open(bundle, folder)?;
            screen.click_until(&window.map, PAGE).with_context(|| format!("the window of {bundle}"))?;
            let mut source = self.command(&release().join("examples/drag.exe"), folder);
            source.arg(&path).args([DRAGGED_FROM.0, DRAGGED_FROM.1].map(|at| at.to_string()));
            // Closes at the end, like the window.
            let _source = Opened { program: source.spawn().context("calling wine")?, map: PathBuf::new() };
            let dropped = screen
                .drag("drag from here", &window.map, PAGE.1)
                .and_then(|()| screen.wait_for(&window.map, &format!("recording.{NAME}{FACTS}")));
            dropped.with_context(|| format!("the window of {bundle}"))?;
        }
        Ok(())
    }

    /// Drags what was recorded out of a window onto another one, which loads it.
    pub fn takes(&self, screen: &Screen, folder: &Path) -> Result<()> {
        let (title, place) = RECEIVER;
        for bundle in BUNDLES {
            let receiver = self.open_as(title, bundle, folder)?;
            screen.wait_for(&receiver.map, PAGE.0)?;
            screen.move_window(title, place)?;
            let source = self.open(bundle, folder)?;
            // Once to record, and once to end that.
            let dragged = screen
                .click(&source.map, RECORD)
                .and_then(|()| screen.click(&source.map, RECORD))
                .and_then(|()| screen.drag_out(&source.map, DRAG_OUT, title))
                .and_then(|()| screen.wait_for_any(&receiver.map, TAKE));
            dragged.with_context(|| format!("the window of {bundle}"))?;
        }
        Ok(())
    }

    /// A sound file, made by the command line.
    fn recording(&self, folder: &Path) -> Result<PathBuf> {
        let path = folder.join("fire.wav");
        if !path.exists() {
            self.run(&self.command_line(), folder, "render --preset hearth --seconds 4 --output fire.wav")?;
        }
        Ok(path)
    }

    /// The same file under a long name, on a drive of its own; returns Windows' path of it.
    fn far_recording(&self, folder: &Path) -> Result<String> {
        let drive = folder.join("drive");
        let mut place = PathBuf::new();
        while place.as_os_str().len() < OLD_LIMIT {
            place.push(FAR);
        }
        fs::create_dir_all(drive.join(&place)).context("a long path")?;
        fs::copy(self.recording(folder)?, drive.join(&place).join(NAME)).context("copying a recording")?;
        self.add_drive("e:", &drive)?;
        Ok(format!("E:\\{}\\{NAME}", place.display()).replace('/', "\\"))
    }

    /// Gives a folder a drive's letter.
    fn add_drive(&self, letter: &str, folder: &Path) -> Result<()> {
        let drives = self.installation()?.join("dosdevices");
        ensure!(drives.is_dir(), "{} is not there", drives.display());
        let drive = drives.join(letter);
        let _ = fs::remove_file(&drive);
        std::os::unix::fs::symlink(folder, &drive).with_context(|| drive.display().to_string())
    }

    /// Runs one of Wine's own programs.
    fn system(&self, arguments: &[&str]) -> Result<()> {
        let mut command = Command::new(self.program);
        let status = command.args(arguments).envs(self.environment.iter().cloned()).status().context("calling wine")?;
        if !status.success() {
            bail!("{arguments:?}: {status}");
        }
        Ok(())
    }
}
