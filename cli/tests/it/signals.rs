//! Signals: the work is cleaned up, and the process dies of the signal, as a shell must see.
#![cfg(unix)]

use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::common::{hiss, write};

const INT: i32 = 2;
const TERM: i32 = 15;
const HUP: i32 = 1;

/// White noise in both: searches through all of it, many seconds of work.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "in.wav", &[hiss(400_000, 2)], 44_100);
    write(folder.path(), "fire.wav", &[hiss(2_000_000, 3)], 44_100);
    folder
}

fn pyrophone(folder: &Path, arguments: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pyrophone"));
    command.current_dir(folder).args(arguments.split(' ')).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn send(child: &Child, signal: i32) {
    let sent = Command::new("kill").args([format!("-{signal}"), child.id().to_string()]).status().unwrap();
    assert!(sent.success(), "the command ended before it could be stopped");
}

#[test]
fn signals_in_mid_render_leave_nothing_and_kill_the_process() {
    for (signal, work) in [
        (INT, "texture --input in.wav --training fire.wav"),
        (TERM, "render --preset texture-paper --set quality=exact --input in.wav --training fire.wav"),
        (HUP, "texture --input in.wav --training fire.wav"),
    ] {
        let folder = folder();
        let child = pyrophone(folder.path(), &format!("{work} --output out.wav --json")).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(1500));
        send(&child, signal);
        let output = child.wait_with_output().unwrap();
        assert_eq!((output.status.signal(), output.status.code()), (Some(signal), None), "{work}");
        let printed = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(printed.ends_with("error: cancelled; nothing was written\n"), "{work}: {printed}");
        assert!(output.stdout.is_empty(), "{work}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2, "{work}: something was left behind");
    }
}

#[test]
fn a_wait_for_standard_input_can_be_stopped() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = pyrophone(folder.path(), "extend --input - --output out.wav");
    let child = command.stdin(Stdio::piped()).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(500));
    send(&child, TERM);
    let began = Instant::now();
    let mut child = child;
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        assert!(began.elapsed() < Duration::from_secs(30), "it waits for ever");
        std::thread::sleep(Duration::from_millis(20));
    };
    assert_eq!(status.signal(), Some(TERM));
}

#[test]
fn a_shell_loop_ends_with_the_command_that_is_interrupted() {
    let folder = folder();
    let binary = env!("CARGO_BIN_EXE_pyrophone");
    // A shell that ends a loop does so since its child was killed by the signal that it has got itself.
    let script = format!(
        "for n in 1 2 3; do echo $n >> runs; '{binary}' texture --input in.wav --training fire.wav --output $n.wav; done"
    );
    let mut bash = Command::new("bash");
    bash.current_dir(folder.path()).args(["-c", &script]).stderr(Stdio::null());
    // A group of its own, which gets the signal as from a terminal.
    std::os::unix::process::CommandExt::process_group(&mut bash, 0);
    let Ok(mut shell) = bash.spawn() else {
        eprintln!("skipped: there is no bash");
        return;
    };
    std::thread::sleep(Duration::from_millis(1500));
    let sent = Command::new("kill").args(["-INT", "--", &format!("-{}", shell.id())]).status().unwrap();
    assert!(sent.success());
    shell.wait().unwrap();
    assert_eq!(std::fs::read_to_string(folder.path().join("runs")).unwrap(), "1\n", "the loop went on");
}

#[cfg(target_os = "linux")]
#[test]
fn work_under_nohup_outlives_its_terminal() {
    let folder = folder();
    let binary = env!("CARGO_BIN_EXE_pyrophone");
    let script = format!("trap '' HUP; exec '{binary}' texture --input in.wav --training fire.wav --output out.wav -q");
    let mut shell = Command::new("sh");
    let mut child = shell.current_dir(folder.path()).args(["-c", &script]).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(700));
    send(&child, HUP);
    std::thread::sleep(Duration::from_millis(500));
    assert!(child.try_wait().unwrap().is_none(), "it was hung up");
    send(&child, TERM);
    assert_eq!(child.wait().unwrap().signal(), Some(TERM));
}
