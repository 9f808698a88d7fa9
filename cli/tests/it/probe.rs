//! The snippets of `docs/probe.md`: Blender's is run as it stands there, and what it writes is read.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::common::skip::skip;
use crate::common::{pyrophone, read, succeeds};
use pyrophone_flame::import::{Selection, Sequence, Series};

/// Frames per second and frames of the fire in `probe/fire.py`.
const RATE_HZ: f64 = 360.0;
const FRAMES: usize = 40;

fn project() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The block of code in `docs/probe.md` that holds a text.
fn block(text: &str) -> String {
    let page = std::fs::read_to_string(project().join("docs/probe.md")).unwrap();
    let found = page.split("```").skip(1).step_by(2).find(|block| block.contains(text));
    let (_, code) = found.unwrap_or_else(|| panic!("no block with {text}")).split_once('\n').unwrap();
    code.to_owned()
}

/// Runs the snippet on the fire, in a folder of its own.
fn blender(at: &Path, is_adaptive: bool) {
    std::fs::write(at.join("probe.py"), block("flame_grid")).unwrap();
    let mut command = Command::new("blender");
    command.args(["--background", "--factory-startup", "--python-exit-code", "1"]).current_dir(at);
    // Blender resolves paths against PWD, which only a shell changes.
    command.env("PWD", at).arg("--python").arg(project().join("cli/tests/probe/fire.py"));
    command.arg("--python").arg(at.join("probe.py"));
    command.env("ADAPTIVE", if is_adaptive { "1" } else { "0" });
    let output = command.output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stderr));
}

/// The probe's table beside the cache that the same run has written.
#[test]
fn the_blender_probe_writes_what_its_cache_holds() {
    if Command::new("blender").arg("--version").output().is_err() {
        skip("there is no Blender here (apt-get install blender)");
        return;
    }
    for is_adaptive in [false, true] {
        let folder = tempfile::tempdir().unwrap();
        let at = folder.path();
        blender(at, is_adaptive);
        let series = Series::read(&at.join("probe.csv")).unwrap();
        assert_eq!(series.values.len(), FRAMES);
        assert!((series.rate_hz.unwrap() - RATE_HZ).abs() < 0.01, "{:?}", series.rate_hz);
        let largest = series.values.iter().copied().fold(0.0, f64::max);
        assert!(largest > 0.0, "nothing burns");
        succeeds(at, "flux --input probe.csv --output probe.wav");
        assert!(read(&at.join("probe.wav")).channels[0].iter().any(|sample| *sample != 0.0));

        // The same from the cache, in which an adaptive domain is a box that grows.
        succeeds(at, "flux --input cache --rate 360 --measure release --flux-csv cache.csv");
        let table = std::fs::read_to_string(at.join("cache.csv")).unwrap();
        let released: Vec<f64> =
            table.lines().skip(1).map(|line| line.split(',').nth(1).unwrap().parse().unwrap()).collect();
        assert_eq!(released.len(), FRAMES);
        for (frame, (probe, cache)) in series.values.iter().zip(&released).enumerate() {
            assert!((probe - cache).abs() <= 0.01 * largest, "{is_adaptive}, frame {frame}: {probe} {cache}");
        }
        let sequence = Sequence::open(&at.join("cache")).unwrap();
        let edges: Vec<f64> = (0..FRAMES)
            .filter_map(|index| {
                Some(sequence.read_field(index, &Selection::default()).ok()?.transform().voxel_edges()[0])
            })
            .collect();
        assert!(edges.iter().all(|edge| (edge / edges[0] - 1.0).abs() < 1e-5), "{is_adaptive}: {edges:?}");
    }
}

/// EmberGen's and FDS's recipes: what these programs write is read as the page says.
#[test]
fn the_other_recipes_make_what_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let step_s = 0.00277778;
    let page = std::fs::read_to_string(project().join("docs/probe.md")).unwrap();
    for text in ["&DUMP DT_HRR=0.00277778 /", "--measure release --rate 360", "case_hrr.csv"] {
        assert!(page.contains(text), "{text}");
    }
    // As FDS 6 writes it: units, names, then rows with blanks before the numbers.
    let mut table = "s,kW,kW,kW\nTime,HRR,Q_RADI,Q_CONV\n".to_owned();
    for step in 0..720 {
        let hrr = 100.0 + 30.0 * (f64::from(step) * 0.9).sin();
        table += &format!(" {:.7E}, {hrr:.7E}, -1.0E+00, 0.0E+00\n", f64::from(step) * step_s);
    }
    std::fs::write(at.join("case_hrr.csv"), table).unwrap();
    let output = pyrophone(at, "flux --input case_hrr.csv --output flame.wav --json");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let printed: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!((printed["seconds"].as_f64().unwrap() - 2.0).abs() < 0.01, "{printed}");
}

/// A frame of `flames` alone, as a NumPy array: no velocity beside it.
fn flames(value: f32) -> Vec<u8> {
    let size = 8;
    let text = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({size}, {size}, {size}), }}");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend(118u16.to_le_bytes());
    bytes.extend(format!("{text:<117}\n").as_bytes());
    bytes.extend((0..size * size * size).flat_map(|n: usize| (if n < 100 { value } else { 0.0 }).to_le_bytes()));
    bytes
}

#[test]
fn the_embergen_recipe_needs_the_field_alone() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::create_dir(at.join("export")).unwrap();
    for frame in 0u8..8 {
        let name = format!("export/flames_{frame:04}.npy");
        std::fs::write(at.join(name), flames(1.0 + f32::from(frame % 3))).unwrap();
    }
    succeeds(at, "flux --input export/ --measure release --rate 360 --flux-csv out.csv --output out.wav");
    let table = std::fs::read_to_string(at.join("out.csv")).unwrap();
    let released: Vec<f64> =
        table.lines().skip(1).map(|line| line.split(',').nth(1).unwrap().parse().unwrap()).collect();
    assert_eq!(released.len(), 8);
    for (frame, released) in released.iter().enumerate() {
        assert_eq!(*released, 100.0 * (1 + frame % 3) as f64, "frame {frame}");
    }
}
