//! Bit-identical output elsewhere: the command line's digests on other processors and systems, which are emulated here.
//!
//! The digests are those of `cli/tests/digests.txt`. Anything that this machine cannot emulate is counted as skipped.

mod screen;
mod wine;

use anyhow::{Result, ensure};
use clap::ValueEnum;

use crate::package::{self, build::program};
use crate::setup::{self, Need, is_program};
use crate::tally::Tally;
use crate::{cargo, project};

/// The command line, and the test that compares its digests.
const PACKAGE: &str = "pyrophone-cli";
const TEST: &str = "digests";
/// Environment variable with the program that the test runs instead of the command line built for it.
const LAUNCHER: &str = "PYROPHONE_LAUNCHER";

/// A processor of 2008: no AVX, no fused multiplication.
const OLD: (&str, &str) = ("qemu-x86_64", "Nehalem");

const ARM: &str = "aarch64-unknown-linux-gnu";
const ARM_LINKER: &str = "aarch64-linux-gnu-gcc";
/// Debian's C library for it.
const ARM_LIBRARIES: &str = "/usr/aarch64-linux-gnu";

/// Another system or processor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Elsewhere {
    /// A processor without AVX, under qemu
    OldProcessor,
    /// 64-bit ARM, under qemu
    Arm,
    /// macOS, compiled and linked only
    Macos,
    /// Windows, under Wine
    Windows,
}

impl Elsewhere {
    /// Installs what is missing to build for it and to emulate it.
    pub fn prepare(self) -> Result<()> {
        let needs: &[&[Need]] = match self {
            Self::OldProcessor => &[&setup::EMULATOR],
            Self::Arm => &[&setup::ARM_BUILD, &setup::EMULATOR],
            Self::Macos => &[&setup::MACOS_CHECK],
            Self::Windows => &[&setup::WINDOWS_PACKAGE, &setup::WINE],
        };
        needs.iter().try_for_each(|needs| setup::ensure(needs))
    }
}

/// Compares the digests in one place, as far as this machine can, and builds the necessary programs. Under Wine, the
/// bundles are played and opened as well.
pub fn soak(tally: &mut Tally, place: Elsewhere) -> Result<()> {
    match place {
        Elsewhere::OldProcessor => old_processor(tally),
        Elsewhere::Arm => arm(tally),
        Elsewhere::Macos => {
            macos(tally);
            Ok(())
        }
        Elsewhere::Windows => wine::soak(tally),
    }
}

/// Compares the digests under Wine, if the Windows build is there and up to date.
pub fn test(tally: &mut Tally) -> Result<()> {
    wine::test(tally)
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
        built = Some(program(&["--package", PACKAGE], ARM, ARM_LINKER, "pyrophone")?);
        Ok(())
    });
    match built {
        Some(built) => compare(tally, name, &format!("qemu-aarch64 -L {ARM_LIBRARIES} {}", built.display()), &[]),
        None => Ok(()),
    }
}

/// Compiles and links for macOS without running anything.
fn macos(tally: &mut Tally) {
    let name = "linked for macOS";
    let missing = setup::missing(&setup::MACOS_CHECK);
    if missing.is_empty() {
        tally.step(name, package::check_macos);
    } else {
        tally.skip(name, &format!("there is no {} here", missing.join(" ")));
    }
}

/// Runs the test of the digests with another command line.
fn compare(tally: &mut Tally, name: &str, launcher: &str, environment: &[(&str, String)]) -> Result<()> {
    let mut all = vec![(LAUNCHER, launcher)];
    all.extend(environment.iter().map(|(name, value)| (*name, value.as_str())));
    tally.cargo_test(name, &all, &["--package", PACKAGE, "--test", TEST, "outputs_have_their_digests", "--", "--exact"])
}
