//! A job of `flux-plan --format slurm` on a real Slurm: an array of parts, one of them requeued in its midst, and the merge
//! behind them. Slurm runs on this machine alone, with a configuration, a key and ports of its own.
//!
//! Slow: `cargo xtask soak`, or `PYROPHONE_SOAK=1`, as root, with Debian's `slurm-wlm` and `munge`.
#![cfg(target_os = "linux")]

mod common;

use std::fs::File;
use std::net::TcpListener;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use common::skip::skip;
use pyrophone_flame::import::npz::{DenseFrame, write_frame};

/// Voxels along an edge; frames; frames of a part.
const SIZE: usize = 36;
const FRAMES: i64 = 24;
const CHUNK: i64 = 12;

/// Longest wait: a requeued job rests for two minutes before it may start again.
const PATIENCE: Duration = Duration::from_secs(900);

/// Programs without which there is no Slurm.
const PROGRAMS: [&str; 6] = ["munged", "slurmctld", "slurmd", "sbatch", "scontrol", "setpriv"];

/// Daemons, which end with the test.
struct Daemons(Vec<Child>);

impl Drop for Daemons {
    fn drop(&mut self) {
        for child in self.0.iter_mut().rev() {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

fn output(command: &mut Command) -> String {
    let output = command.output().unwrap();
    let (said, error) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{command:?}: {said}{error}");
    said.into_owned()
}

/// Runs one of Slurm's clients.
fn slurm(at: &Path, program: &str, arguments: &[&str]) -> String {
    output(Command::new(program).args(arguments).current_dir(at).env("SLURM_CONF", at.join("slurm.conf")))
}

#[track_caller]
fn wait_for(what: &str, mut is_there: impl FnMut() -> bool) {
    let began = Instant::now();
    while !is_there() {
        assert!(began.elapsed() < PATIENCE, "{what} did not come");
        std::thread::sleep(Duration::from_millis(200));
    }
}

fn obstacle() -> Option<String> {
    if std::env::var("PYROPHONE_SOAK").as_deref() != Ok("1") {
        return Some("set PYROPHONE_SOAK=1".into());
    }
    let path = std::env::var_os("PATH").unwrap_or_default();
    // Daemons are in folders that not every user's PATH has.
    let folders: Vec<_> = std::env::split_paths(&path).chain(["/usr/sbin".into(), "/sbin".into()]).collect();
    let is_missing = |name: &&str| !folders.iter().any(|folder| folder.join(name).is_file());
    if let Some(missing) = PROGRAMS.iter().find(|name| is_missing(name)) {
        return Some(format!("there is no {missing} here (apt-get install slurm-wlm munge)"));
    }
    let user = output(Command::new("id").arg("-u"));
    (user.trim() != "0").then(|| "slurmd only starts as root".into())
}

/// Slurm's daemons in a folder, ready for jobs.
fn start(at: &Path) -> Daemons {
    let munge = at.join("munge");
    std::fs::create_dir(&munge).unwrap();
    let key = munge.join("key");
    std::fs::write(&key, [0x5a; 128]).unwrap();
    std::fs::set_permissions(&key, PermissionsExt::from_mode(0o600)).unwrap();
    std::fs::set_permissions(at, PermissionsExt::from_mode(0o755)).unwrap();
    output(Command::new("chown").args(["-R", "munge:"]).arg(&munge));
    let option = |name: &str, file: &str| format!("--{name}={}", munge.join(file).display());
    let files =
        [("key-file", "key"), ("socket", "socket"), ("pid-file", "pid"), ("log-file", "log"), ("seed-file", "seed")];
    // In place of the program that changes the user, so that it is the daemon that is ended.
    let mut munged = Command::new("setpriv");
    munged.args(["--reuid=munge", "--regid=munge", "--clear-groups", "/usr/sbin/munged", "--foreground", "--force"]);
    munged.args(files.map(|(name, file)| option(name, file)));
    let mut daemons = Daemons(vec![spawn(at, &mut munged, "munged")]);
    wait_for("munge's socket", || munge.join("socket").exists());
    std::fs::write(at.join("slurm.conf"), configuration(at)).unwrap();
    let conf = at.join("slurm.conf");
    daemons.0.push(spawn(at, Command::new("/usr/sbin/slurmctld").arg("-D").arg("-f").arg(&conf), "slurmctld"));
    daemons.0.push(spawn(at, Command::new("/usr/sbin/slurmd").args(["-D", "-b"]).arg("-f").arg(&conf), "slurmd"));
    wait_for("an idle node", || {
        let printed = Command::new("sinfo").args(["-h", "-o", "%T"]).env("SLURM_CONF", &conf).output().unwrap();
        String::from_utf8_lossy(&printed.stdout).trim() == "idle"
    });
    daemons
}

fn spawn(at: &Path, command: &mut Command, name: &str) -> Child {
    let log = || Stdio::from(File::create(at.join(format!("{name}.out"))).unwrap());
    command.current_dir(at).stdin(Stdio::null()).stdout(log()).stderr(Stdio::null()).spawn().unwrap()
}

fn configuration(at: &Path) -> String {
    let name = output(Command::new("hostname").arg("-s"));
    let name = name.trim();
    let ports: Vec<u16> = [0, 1]
        .map(|_| TcpListener::bind("127.0.0.1:0").unwrap())
        .map(|listener| listener.local_addr().unwrap().port())
        .to_vec();
    let at = at.display();
    format!(
        "ClusterName=test\nSlurmctldHost={name}(127.0.0.1)\nSlurmctldPort={}\nSlurmdPort={}\n\
         AuthType=auth/munge\nAuthInfo=socket={at}/munge/socket\nCommunicationParameters=NoCtldInAddrAny,NoInAddrAny\n\
         SlurmUser=root\nSlurmdUser=root\nProctrackType=proctrack/pgid\nTaskPlugin=task/none\n\
         SelectType=select/cons_tres\nSelectTypeParameters=CR_CPU\nJobAcctGatherType=jobacct_gather/none\n\
         AccountingStorageType=accounting_storage/none\nMpiDefault=none\nReturnToService=2\nKillWait=5\n\
         SlurmctldPidFile={at}/ctld.pid\nSlurmdPidFile={at}/d.pid\nSlurmdSpoolDir={at}/spool\n\
         StateSaveLocation={at}/state\nSlurmctldLogFile={at}/ctld.log\nSlurmdLogFile={at}/d.log\n\
         NodeName={name} NodeAddr=127.0.0.1 CPUs=2 RealMemory=1000\n\
         PartitionName=all Nodes={name} Default=YES State=UP\n",
        ports[0], ports[1]
    )
}

/// A ball of flame that breathes in a flow away from its middle.
fn cache(at: &Path) {
    std::fs::create_dir(at).unwrap();
    let middle = 0.5 * (SIZE - 1) as f64;
    for number in 1..=FRAMES {
        let radius = 12.0 + 1.5 * (number as f64 * 1.3).sin();
        let from_middle = |n: usize| [n / (SIZE * SIZE), n / SIZE % SIZE, n % SIZE].map(|i| i as f64 - middle);
        let away = |n: usize| from_middle(n).iter().map(|x| x * x).sum::<f64>().sqrt();
        let count = SIZE * SIZE * SIZE;
        let frame = DenseFrame {
            shape: [SIZE; 3],
            flame: &(0..count).map(|n| [(0.5 + 0.5 * (radius - away(n))).clamp(0.0, 1.0) as f32]).collect::<Vec<_>>(),
            velocity: &(0..count).map(|n| from_middle(n).map(|x| x as f32)).collect::<Vec<_>>(),
            voxel_size: 0.05,
            origin: [0.0; 3],
            time_s: None,
        };
        write_frame(File::create(at.join(format!("fire_{number:03}.npz"))).unwrap(), &frame).unwrap();
    }
}

#[test]
fn an_array_with_a_requeued_task_makes_what_one_run_makes() {
    if let Some(why) = obstacle() {
        skip(&why);
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    cache(&at.join("cache"));
    let _daemons = start(at);
    // So fine that a part takes long enough to be stopped in its midst.
    let options = ["--refine", "16", "--rate", "360"];
    let pyrophone = |arguments: &[&str]| {
        output(Command::new(env!("CARGO_BIN_EXE_pyrophone")).args(arguments).current_dir(at));
    };
    let chunk = CHUNK.to_string();
    let plan = ["flux-plan", "--input", "cache", "--chunk", &chunk, "--format", "slurm", "--output", "farm.wav"];
    let job = ["--speed-field", "farm.field", "--job", "job.sh", "--"];
    pyrophone(&[&plan[..], &job, &options].concat());
    let submitted = output(
        Command::new("sh")
            .arg("job.sh")
            .current_dir(at)
            .env("SLURM_CONF", at.join("slurm.conf"))
            .env("RAYON_NUM_THREADS", "1"),
    );
    assert!(submitted.contains("Submitted batch job"), "{submitted}");
    let queue = slurm(at, "squeue", &["-h", "-r", "-n", "flux", "-o", "%A %F %K"]);
    let first = queue.lines().find(|line| line.ends_with(" 0")).unwrap_or_else(|| panic!("{queue}"));
    let task = format!("{}_0", first.split(' ').nth(1).unwrap());
    let part = format!("part_1-{CHUNK}.csv");
    let progress = at.join("farm.wav.parts").join(format!("{part}.flux-progress"));
    wait_for("the first part's progress", || progress.exists());
    assert!(!at.join("farm.wav.parts").join(&part).exists(), "the part was done before it could be requeued");
    slurm(at, "scontrol", &["requeue", &task]);
    wait_for("the merge", || at.join("farm.wav").exists() && at.join("farm.field").exists());
    let logs = at.read_dir().unwrap().map(|entry| entry.unwrap().path());
    let logs = logs.filter(|path| path.extension().is_some_and(|extension| extension == "out"));
    let printed: String = logs.filter_map(|path| std::fs::read_to_string(path).ok()).collect();
    assert!(printed.contains(&format!("of {CHUNK} frames are reused from an interrupted run")), "{printed}");
    let run = ["flux", "--input", "cache", "--output", "one.wav", "--speed-field", "one.field"];
    pyrophone(&[&run[..], &options].concat());
    for (one, farm) in [("one.wav", "farm.wav"), ("one.field", "farm.field")] {
        assert!(std::fs::read(at.join(one)).unwrap() == std::fs::read(at.join(farm)).unwrap(), "{farm}");
    }
}
