//! What a program takes: processor time and memory.

use std::process::{Child, Command, Stdio};
use std::time::Duration;

use anyhow::{Context, Result, ensure};

/// Ticks per second in /proc, the same on every Linux.
const TICKS_PER_S: f64 = 100.0;
/// Fields of /proc/self/stat after the program's name: user and system time of children that have ended.
const CHILDREN: [usize; 2] = [13, 14];
/// Pause between two looks at a running program's memory.
const PAUSE: Duration = Duration::from_millis(5);

/// Processor time and memory of a program that has ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spent {
    /// User and system time of all its threads, in seconds.
    pub cpu_s: f64,
    /// Most memory at a time, in MB.
    pub peak_mb: f64,
}

/// Runs a program to its end, without its output.
pub fn spent(command: &mut Command) -> Result<Spent> {
    let before_s = children_s()?;
    let name = command.get_program().to_string_lossy().into_owned();
    let child = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn();
    let mut child = child.with_context(|| format!("{name} cannot be started; is it installed?"))?;
    let mut peak_mb = 0.0f64;
    let status = loop {
        peak_mb = peak_mb.max(memory_mb(&child));
        match child.try_wait()? {
            Some(status) => break status,
            None => std::thread::sleep(PAUSE),
        }
    };
    ensure!(status.success(), "{name} failed: {status}");
    Ok(Spent { cpu_s: children_s()? - before_s, peak_mb })
}

/// The most memory that a running program has had so far, in MB; 0 once it has ended.
fn memory_mb(child: &Child) -> f64 {
    let text = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|line| line.trim().strip_suffix("kB")?.trim().parse::<f64>().ok()).unwrap_or(0.0) / 1e3
}

fn children_s() -> Result<f64> {
    let text = std::fs::read_to_string("/proc/self/stat").context("processor time needs /proc")?;
    parse(&text).context("/proc/self/stat has another form")
}

/// The sum of the children's times in a line of /proc/self/stat.
fn parse(stat: &str) -> Option<f64> {
    // The name may contain spaces and brackets, so fields are counted from the last bracket.
    let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks: Option<f64> = CHILDREN.iter().map(|field| fields.get(*field)?.parse::<f64>().ok()).sum();
    Some(ticks? / TICKS_PER_S)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn children_are_found_behind_a_name_with_brackets() {
        let stat = "7 (a) b) S 1 2 3 4 5 6 7 8 9 10 11 12 250 50 20 0";
        assert_eq!(parse(stat), Some(3.0));
        assert_eq!(parse("7 (a) S 1"), None);
    }

    #[test]
    fn busy_child_costs_time_and_memory() {
        let busy = "i=0; while [ $i -lt 100000 ]; do i=$((i+1)); done";
        let Spent { cpu_s, peak_mb } = spent(Command::new("sh").args(["-c", busy])).unwrap();
        assert!(cpu_s > 0.0 && (0.1..100.0).contains(&peak_mb), "{cpu_s} s, {peak_mb} MB");
        assert!(spent(&mut Command::new("no-such-program-here")).is_err());
    }
}
