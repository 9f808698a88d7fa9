//! Windows, through Wine: the packaged command line, and both bundles in our own host and in a window.

mod newcomer;
mod window;

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

use super::screen::{self, Screen};
use super::{TEST, compare};
use crate::package::build::{self, Built, WINDOWS_LINKER, program};
use crate::package::{self, System};
use crate::project;
use crate::setup::{self, is_program};
use crate::tally::Tally;

/// Source of the library that Wine lacks.
const STAND_IN: &str = "xtask/wine/bcryptprimitives.c";
/// Environment variable with the folder of a Windows.
const PREFIX: &str = "WINEPREFIX";
/// Our own host, the program that opens windows with it, and the one that drags files to them.
const PLAYERS: [&str; 10] = [
    "--package",
    "xtask",
    "--package",
    "pyrophone-host",
    "--bin",
    "xtask-sound",
    "--example",
    "window",
    "--example",
    "drag",
];
/// The tests that need a screen.
const ON_SCREEN: [(&str, OnScreen); 7] = [
    ("bounces under Wine", |wine, _, folder| wine.bounces(folder)),
    ("window under Wine", Wine::windows),
    ("window under Wine, files from the system's dialog", Wine::dialog),
    ("window under Wine, files dropped on it", Wine::drops),
    ("window under Wine, a take dragged out of it", Wine::takes),
    ("window under Wine on a dense screen", Wine::dense_windows),
    ("the newcomer's path under Wine", Wine::newcomer),
];

/// A test on a screen, with files in a folder.
type OnScreen = fn(&Wine, &Screen, &Path) -> Result<()>;

/// Wine, and a separate folder for its Windows installation.
struct Wine {
    program: &'static str,
    environment: Vec<(&'static str, String)>,
}

/// Builds the Windows packages' contents, and tries all of them.
pub(super) fn soak(tally: &mut Tally) -> Result<()> {
    let Some(wine) = Wine::find(tally)? else { return Ok(()) };
    let mut built = None;
    tally.step("plug-in and command line for Windows", || {
        built = Some(build::build(System::Windows)?);
        Ok(())
    });
    let Some(built) = built else { return Ok(()) };
    wine.digests(tally, &built.program)?;
    let folder = project::target_dir().join("wine-bounces");
    if tally.step("our host for Windows", || build_players(&built, &folder)) {
        if let Some(why) = screen::obstacle() {
            ON_SCREEN.iter().for_each(|(test, _)| tally.skip(test, why));
            return Ok(());
        }
        // Plug-ins need one even for a bounce: a VST3's messages go through a hidden window.
        let screen = Screen::start()?;
        let wine = wine.on_screen(&screen, "wine-with-screen")?;
        for (name, test) in ON_SCREEN {
            tally.step(name, || test(&wine, &screen, &folder));
        }
    }
    Ok(())
}

/// Compares the digests of the Windows build that is there, if it is up to date.
pub(super) fn test(tally: &mut Tally) -> Result<()> {
    let Some(wine) = Wine::find(tally)? else { return Ok(()) };
    let built = built().program;
    if is_current(&built)? {
        wine.digests(tally, &built)
    } else {
        let why = "pyrophone.exe is not built from this source (`cargo xtask package --system windows`)";
        tally.skip(&format!("{TEST} under Wine"), why);
        Ok(())
    }
}

/// Folder of the build for Windows.
fn release() -> PathBuf {
    project::target_dir().join("cross").join(System::Windows.triple()).join("release")
}

/// What that build has made.
fn built() -> Built {
    Built { library: release().join(System::Windows.library()), program: release().join(System::Windows.program()) }
}

/// Builds our host, and lays out the bundles where it looks for them.
fn build_players(built: &Built, folder: &Path) -> Result<()> {
    let player = program(&PLAYERS, System::Windows.triple(), WINDOWS_LINKER, "xtask-sound.exe")?;
    for program in [&player, &release().join("examples/window.exe")] {
        stand_in(program)?;
    }
    package::bundles(System::Windows, built, &folder.join("bundled"))
}

impl Wine {
    /// Wine and the tools to build for it; counts as skipped if something is missing.
    fn find(tally: &mut Tally) -> Result<Option<Self>> {
        let name = format!("{TEST} under Wine");
        let known = ["wine64", "wine", "/usr/lib/wine/wine64"];
        let Some(program) = known.into_iter().find(|name| is_program(name) || Path::new(name).is_file()) else {
            tally.skip(&name, "wine is not installed (`apt-get install wine64`)");
            return Ok(None);
        };
        let missing = setup::missing(&setup::WINDOWS_PACKAGE);
        if !missing.is_empty() {
            tally.skip(&name, &format!("there is no {} here", missing.join(" ")));
            return Ok(None);
        }
        Ok(Some(Self { program, environment: environment("wine")? }))
    }

    /// The same on a screen. A Windows that has begun without a screen does not find one later, so it is another one.
    fn on_screen(&self, screen: &Screen, installation: &str) -> Result<Self> {
        let mut environment = environment(installation)?;
        environment.push(("DISPLAY", screen.display().to_owned()));
        Ok(Self { program: self.program, environment })
    }

    fn digests(&self, tally: &mut Tally, program: &Path) -> Result<()> {
        if !tally.step("what Wine lacks", || stand_in(program)) {
            return Ok(());
        }
        compare(
            tally,
            &format!("{TEST} under Wine"),
            &format!("{} {}", self.program, program.display()),
            &self.environment,
        )
    }

    /// A program for Windows, called in a folder.
    fn command(&self, program: &Path, folder: &Path) -> Command {
        let mut command = Command::new(self.program);
        command.arg(program).current_dir(folder);
        command.envs(self.environment.iter().map(|(name, value)| (*name, value)));
        command.env("CARGO_TARGET_DIR", shown(folder)).env("PYROPHONE_CACHE", "");
        command
    }

    fn run(&self, program: &Path, folder: &Path, arguments: &str) -> Result<()> {
        let status =
            self.command(program, folder).args(arguments.split_whitespace()).status().context("calling wine")?;
        ensure!(status.success(), "{} {arguments}: {status}", program.display());
        Ok(())
    }

    /// Plays both bundles in our own host, all built for Windows: each output must equal the command line's.
    fn bounces(&self, folder: &Path) -> Result<()> {
        let program = &self.command_line();
        let player = release().join("xtask-sound.exe");
        self.run(program, folder, "simulate torch --seconds 1 --resolution 32 --output drive.wav")?;
        for preset in ["extend", "campfire"] {
            let arguments = format!("--preset {preset} --input drive.wav --output");
            self.run(program, folder, &format!("render {arguments} render.wav"))?;
            let expected = samples(&folder.join("render.wav"))?;
            for format in ["clap", "vst3"] {
                self.run(&player, folder, &format!("bounce --format {format} --offline {arguments} bounce.wav"))?;
                let found = samples(&folder.join("bounce.wav"))?;
                ensure!(found == expected, "{preset}, {format}: the bounce is not what `render` writes");
            }
        }
        Ok(())
    }

    /// The packaged command line.
    fn command_line(&self) -> PathBuf {
        built().program
    }

    /// Folder of this Windows.
    fn installation(&self) -> Result<PathBuf> {
        let found = self.environment.iter().find(|(name, _)| *name == PREFIX);
        Ok(PathBuf::from(&found.context("Wine has no folder")?.1))
    }
}

/// Wine's environment, with a Windows installation in this folder.
fn environment(folder: &str) -> Result<Vec<(&'static str, String)>> {
    let prefix = project::target_dir().join(folder);
    std::fs::create_dir_all(&prefix).context("a folder for Wine")?;
    Ok(vec![(PREFIX, prefix.to_string_lossy().into_owned()), ("WINEDEBUG", "-all".to_owned())])
}

/// A path as programs under Wine know it: the root is drive Z.
fn shown(path: &Path) -> String {
    format!("Z:{}", path.display())
}

/// The samples of a WAV file, after any other chunks.
fn samples(path: &Path) -> Result<Vec<u8>> {
    let wav = std::fs::read(path).with_context(|| path.display().to_string())?;
    let Some(at) = wav.windows(4).position(|name| name == b"data") else {
        bail!("{} has no samples", path.display());
    };
    Ok(wav[at + 4..].to_vec())
}

/// Builds the library that Wine 8 lacks and Windows has, and puts it beside the program.
fn stand_in(program: &Path) -> Result<()> {
    let library = program.with_file_name("bcryptprimitives.dll");
    let mut compiler = Command::new(WINDOWS_LINKER);
    compiler.current_dir(project::root()).args(["-shared", "-O1", "-o"]).arg(&library).args([STAND_IN, "-ladvapi32"]);
    ensure!(compiler.status().context("calling mingw's compiler")?.success(), "{STAND_IN} does not compile");
    Ok(())
}

/// True if a program exists and is newer than all its sources.
fn is_current(program: &Path) -> Result<bool> {
    let Ok(about) = std::fs::metadata(program) else { return Ok(false) };
    let built = about.modified()?;
    let mut folders: Vec<PathBuf> = [
        "maths",
        "assets",
        "synthesis",
        "flame",
        "settings",
        "recording",
        "training",
        "fires",
        "analysis",
        "cli",
        "presets",
    ]
    .map(|name| project::root().join(name))
    .to_vec();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).with_context(|| folder.display().to_string())? {
            let entry = entry?;
            if entry.file_type()?.is_dir() {
                folders.push(entry.path());
            } else if entry.metadata()?.modified()? > built {
                return Ok(false);
            }
        }
    }
    Ok(true)
}
