//! Processor time of a child.

use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};

/// Ticks per second in /proc, the same on every Linux.
const TICKS_PER_S: f64 = 100.0;
/// Fields of /proc/self/stat after the program's name: user and system time of children that have ended.
const CHILDREN: [usize; 2] = [13, 14];

/// Runs a program to its end, without its output; returns its processor time in seconds.
pub fn cpu_s(command: &mut Command) -> Result<f64> {
    let before = children_s()?;
    let status = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).status();
    let name = command.get_program().to_string_lossy().into_owned();
    let status = status.with_context(|| format!("{name} cannot be started; is it installed?"))?;
    ensure!(status.success(), "{name} failed: {status}");
    Ok(children_s()? - before)
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
    fn busy_child_costs_time() {
        let spent =
            cpu_s(Command::new("sh").args(["-c", "i=0; while [ $i -lt 100000 ]; do i=$((i+1)); done"])).unwrap();
        assert!(spent > 0.0);
        assert!(cpu_s(&mut Command::new("no-such-program-here")).is_err());
    }
}
