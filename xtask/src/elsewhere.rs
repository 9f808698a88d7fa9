//! The same bits elsewhere: the command line's digests on other processors and systems, which are emulated here.
//!
//! The digests are those of `cli/tests/digests.txt`. Whatever this machine cannot emulate is counted as skipped.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};

use crate::package::{self, System, build::program};
use crate::setup::{self, is_program};
use crate::tally::Tally;
use crate::{cargo, project};

/// The command line, and the test that compares its digests.
const PACKAGE: &str = "pyrophone-cli";
const TEST: &str = "digests";
/// Environment variable that tells the test what to run instead of the command line built for it.
const LAUNCHER: &str = "PYROPHONE_LAUNCHER";

/// A processor of 2008: no AVX, no fused multiplication.
const OLD: (&str, &str) = ("qemu-x86_64", "Nehalem");

const ARM: &str = "aarch64-unknown-linux-gnu";
const ARM_LINKER: &str = "aarch64-linux-gnu-gcc";
/// Debian's C library for it.
const ARM_LIBRARIES: &str = "/usr/aarch64-linux-gnu";

const WINDOWS: &str = "x86_64-pc-windows-gnu";
const WINDOWS_LINKER: &str = "x86_64-w64-mingw32-gcc";
/// Source of the library that Wine lacks.
const STAND_IN: &str = "xtask/wine/bcryptprimitives.c";

/// Compares the digests wherever this machine can, building what is needed for that.
pub fn soak(tally: &mut Tally) -> Result<()> {
    old_processor(tally)?;
    arm(tally)?;
    macos(tally);
    windows(tally, true)
}

/// Compares the digests under Wine, if the Windows build is there and up to date.
pub fn test(tally: &mut Tally) -> Result<()> {
    windows(tally, false)
}

fn old_processor(tally: &mut Tally) -> Result<()> {
    let (emulator, processor) = OLD;
    let name = "digests on a processor without AVX";
    if !is_program(emulator) {
        tally.skip(name, "qemu is not installed (`apt-get install qemu-user`)");
        return Ok(());
    }
    let built = cargo::command().args(["build", "--release", "--package", PACKAGE]).status()?;
    ensure!(built.success(), "the command line does not build; see above");
    let program = project::target_dir().join("release/pyrophone");
    compare(tally, name, &format!("{emulator} -cpu {processor} {}", program.display()), &[])
}

fn arm(tally: &mut Tally) -> Result<()> {
    let name = "digests on 64-bit ARM";
    let mut missing = setup::missing(&setup::ARM_BUILD);
    if !is_program("qemu-aarch64") {
        missing.push("qemu-user");
    }
    if !missing.is_empty() {
        tally.skip(name, &format!("there is no {} here", missing.join(" ")));
        return Ok(());
    }
    let mut built = None;
    tally.step("command line for 64-bit ARM", || {
        built = Some(program(PACKAGE, ARM, ARM_LINKER, "pyrophone")?);
        Ok(())
    });
    match built {
        Some(built) => compare(tally, name, &format!("qemu-aarch64 -L {ARM_LIBRARIES} {}", built.display()), &[]),
        None => Ok(()),
    }
}

/// Nothing can be run: it is compiled, no more.
fn macos(tally: &mut Tally) {
    let missing = setup::missing(&setup::CHECK);
    if missing.is_empty() {
        tally.step("compiled for macOS", package::check_macos);
    } else {
        tally.skip("compiled for macOS", &format!("there is no {} here", missing.join(" ")));
    }
}

fn windows(tally: &mut Tally, build: bool) -> Result<()> {
    let name = "digests under Wine";
    let Some(wine) = ["wine64", "wine", "/usr/lib/wine/wine64"]
        .into_iter()
        .find(|name| is_program(name) || Path::new(name).is_file())
    else {
        tally.skip(name, "wine is not installed (`apt-get install wine64`)");
        return Ok(());
    };
    let missing = setup::missing(&setup::WINDOWS_PACKAGE);
    let built = project::target_dir().join("cross").join(WINDOWS).join("release/pyrophone.exe");
    if !missing.is_empty() {
        tally.skip(name, &format!("there is no {} here", missing.join(" ")));
        return Ok(());
    }
    if build {
        tally.step("command line for Windows", || program(PACKAGE, WINDOWS, WINDOWS_LINKER, "pyrophone.exe").map(drop));
    } else if !is_current(&built)? {
        tally.skip(name, "pyrophone.exe is not built from this source (`cargo xtask package --system windows`)");
        return Ok(());
    }
    if !tally.step("what Wine lacks", || stand_in(&built)) {
        return Ok(());
    }
    let prefix = project::target_dir().join("wine");
    std::fs::create_dir_all(&prefix).context("a folder for Wine")?;
    let environment = [("WINEPREFIX", prefix.to_string_lossy().into_owned()), ("WINEDEBUG", "-all".to_owned())];
    compare(tally, name, &format!("{wine} {}", built.display()), &environment)?;
    if build {
        tally.step("bounces under Wine", || bounces(wine, &environment));
    }
    Ok(())
}

/// Plays both bundles in our own host, all built for Windows: each writes what the command line writes.
fn bounces(wine: &str, environment: &[(&str, String)]) -> Result<()> {
    let player = program("xtask", WINDOWS, WINDOWS_LINKER, "xtask-sound.exe")?;
    stand_in(&player)?;
    let folder = project::target_dir().join("wine-bounces");
    let built = package::build::build(System::Windows)?;
    package::bundles(System::Windows, &built, &folder.join("bundled"))?;
    let run = |program: &Path, arguments: &str| -> Result<()> {
        let mut command = Command::new(wine);
        command.arg(program).args(arguments.split_whitespace()).current_dir(&folder);
        command.envs(environment.iter().map(|(name, value)| (*name, value)));
        // Wine shows the root as drive Z.
        command.env("CARGO_TARGET_DIR", format!("Z:{}", folder.display())).env("PYROPHONE_CACHE", "");
        let status = command.status().context("calling wine")?;
        ensure!(status.success(), "{} {arguments}: {status}", program.display());
        Ok(())
    };
    run(&built.program, "simulate torch --seconds 1 --resolution 32 --output drive.wav")?;
    for preset in ["extend", "campfire"] {
        run(&built.program, &format!("render --preset {preset} --input drive.wav --output render.wav"))?;
        let expected = std::fs::read(folder.join("render.wav")).context("render.wav")?;
        for format in ["clap", "vst3"] {
            run(
                &player,
                &format!("bounce --format {format} --preset {preset} --offline --input drive.wav --output bounce.wav"),
            )?;
            let found = std::fs::read(folder.join("bounce.wav")).context("bounce.wav")?;
            ensure!(
                samples(&found) == samples(&expected),
                "{preset}, {format}: the bounce is not what `render` writes"
            );
        }
    }
    Ok(())
}

/// The samples of a WAV file, after whatever else it begins with.
fn samples(wav: &[u8]) -> Option<&[u8]> {
    let at = wav.windows(4).position(|name| name == b"data")?;
    wav.get(at + 8..)
}

/// Makes the library that Wine 8 lacks and Windows has, and puts it beside the program.
fn stand_in(program: &Path) -> Result<()> {
    let library = program.with_file_name("bcryptprimitives.dll");
    let mut compiler = Command::new(WINDOWS_LINKER);
    compiler.current_dir(project::root()).args(["-shared", "-O1", "-o"]).arg(&library).args([STAND_IN, "-ladvapi32"]);
    ensure!(compiler.status().context("calling mingw's compiler")?.success(), "{STAND_IN} does not compile");
    Ok(())
}

/// Whether a program is there and was built after every source that it is made of was last changed.
fn is_current(program: &Path) -> Result<bool> {
    let Ok(about) = std::fs::metadata(program) else { return Ok(false) };
    let built = about.modified()?;
    let mut folders: Vec<PathBuf> =
        ["maths", "synthesis", "flame", "settings", "recording", "training", "cli", "presets"]
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

/// Runs the test of the digests with another command line.
fn compare(tally: &mut Tally, name: &str, launcher: &str, environment: &[(&str, String)]) -> Result<()> {
    let mut all = vec![(LAUNCHER, launcher)];
    all.extend(environment.iter().map(|(name, value)| (*name, value.as_str())));
    tally.cargo_test(name, &all, &["--package", PACKAGE, "--test", TEST, "outputs_have_their_digests", "--", "--exact"])
}
