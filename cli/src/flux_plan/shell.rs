//! Jobs as shell scripts: plain, running the parts one after another, and for Slurm.

use super::Job;

/// Placeholder for the frames until the shell's variable replaces it; it needs quoting, and no file has this name.
const PLACE: &str = "\u{1}";

/// A script that measures part by part and resumes where it stopped.
pub fn plain(job: &Job) -> String {
    let mut text = head(job);
    for (first, last) in job.chunks() {
        text += &format!("{}\n", command(job, &job.measure_arguments(&frames(first, last))));
    }
    text + &command(job, &job.merge_arguments()) + "\n"
}

/// A script that submits an array of parts, each of which may be requeued, and a merge job that runs when all are done.
pub fn slurm(job: &Job) -> String {
    let count = job.chunks().count();
    let mut lists = String::new();
    for (task, (first, last)) in job.chunks().enumerate() {
        lists += &format!("  {task}) frames={} ;;\n", quoted(&frames(first, last)));
    }
    // The shell inserts the frames, after any quoted arguments before them.
    let measure = command(job, &job.measure_arguments(PLACE));
    let parts = job.parts.join(format!("part_{PLACE}.csv")).display().to_string();
    let (before, behind) = parts.split_once(PLACE).unwrap_or((&parts, ""));
    let measure = measure.replace(&quoted(&parts), &format!("{}\"$frames\"{}", quoted(before), quoted(behind)));
    let measure = measure.replace(&quoted(PLACE), "\"$frames\"");
    format!(
        "{}array=$(sbatch --parsable --array=0-{} --requeue --open-mode=append --job-name=flux <<'EOF'\n\
         #!/bin/sh\nset -eu\ncase $SLURM_ARRAY_TASK_ID in\n{lists}esac\nexec {measure}\nEOF\n)\n\
         sbatch --dependency=afterok:\"$array\" --job-name=flux-merge --open-mode=append <<'EOF'\n\
         #!/bin/sh\nset -eu\nexec {}\nEOF\n",
        head(job),
        count.saturating_sub(1),
        command(job, &job.merge_arguments())
    )
}

fn head(job: &Job) -> String {
    format!("#!/bin/sh\nset -eu\nmkdir -p {}\n", quoted(&job.parts.display().to_string()))
}

fn frames(first: i64, last: i64) -> String {
    if first == last { first.to_string() } else { format!("{first}-{last}") }
}

fn command(job: &Job, arguments: &[String]) -> String {
    let program = job.program.display().to_string();
    let words: Vec<String> = std::iter::once(&program).chain(arguments).map(|word| quoted(word)).collect();
    words.join(" ")
}

/// A word, quoted for a POSIX shell.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./:=+,@%".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}
