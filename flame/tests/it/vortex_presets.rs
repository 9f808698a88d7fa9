//! The vortex-sound textures that are shipped.

use std::path::Path;

use crate::vortex_common::{centroid_hz, rank_correlation, seam};
use pyrophone_flame::vortex_texture::{Shipped, speeds};
use pyrophone_synthesis::vortex::texture::{Row, VortexTexture};

/// Digests of what `cargo xtask vortex` makes, in the order of [`Shipped::ALL`].
const DIGESTS: [u64; Shipped::ALL.len()] = [0xb11b_0295_c1b5_e41a, 0xe9ed_b4dc_983b_d0e9];

const MOST_BYTES: usize = 2_000_000;

const LEAST_RANK_CORRELATION: f64 = 0.95;

fn bytes(name: &str) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../presets/vortex/{name}.vtx"));
    std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn texture(name: &str) -> VortexTexture {
    VortexTexture::from_bytes(&bytes(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// FNV-1a (Fowler, Noll & Vo 1991).
fn digest(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}

fn series(row: &Row) -> [&[f32]; 5] {
    row.components.each_ref().map(Vec::as_slice)
}

#[test]
fn shipped_textures_are_those_that_the_recipes_make() {
    for (Shipped { name, recipe, speeds: (low, high, count) }, expected) in Shipped::ALL.into_iter().zip(DIGESTS) {
        let bytes = bytes(name);
        println!("{name}: {} bytes, digest {:#018x}", bytes.len(), digest(&bytes));
        assert!(bytes.len() <= MOST_BYTES, "{name}: {} bytes", bytes.len());
        let texture = texture(name);
        assert_eq!(texture.sample_rate_hz(), recipe.rate_hz, "{name}");
        assert_eq!(texture.period_samples(), recipe.period_samples(), "{name}");
        let found: Vec<f64> = texture.rows().iter().map(|row| row.speed_m_s).collect();
        assert_eq!(found, speeds(low, high, count).unwrap(), "{name}");
        assert_eq!(digest(&bytes), expected, "{name}: {:#018x} is not what was measured", digest(&bytes));
    }
}

#[test]
fn faster_rows_are_louder_and_brighter_and_none_has_a_seam() {
    for Shipped { name, .. } in Shipped::ALL {
        let texture = texture(name);
        let mut centroids = vec![];
        let mut seams = vec![];
        for row in texture.rows() {
            let (across, most) = seam(series(row));
            let centroid = centroid_hz(series(row), texture.sample_rate_hz());
            let level_db = 20.0 * row.gain.log10();
            println!(
                "{name} {:5.2} m/s: {level_db:6.1} dB re 1 Pa, centroid {centroid:5.1} Hz, seam {across:.1} of {most:.1}",
                row.speed_m_s,
            );
            seams.push((row.speed_m_s, across, most));
            centroids.push(centroid);
        }
        let gains: Vec<f64> = texture.rows().iter().map(|row| row.gain).collect();
        let (level, brightness) = (rank_correlation(&gains), rank_correlation(&centroids));
        println!("{name}: rank correlation with speed: level {level:.3}, centroid {brightness:.3}");
        assert!(level >= LEAST_RANK_CORRELATION, "{name}: level {level}");
        assert!(brightness >= LEAST_RANK_CORRELATION, "{name}: centroid {brightness}");
        for (speed, across, most) in seams {
            assert!(across < most, "{name} {speed} m/s: {across} across the seam, 99 of 100 below {most}");
        }
    }
}

/// The slowest row takes the fewest steps, yet is recorded whole in the soak only (`PYROPHONE_SOAK=1`): else as much of the
/// same flow as a sixteenth of its period takes, with the same bits on every system.
#[test]
fn the_slowest_row_is_recorded_as_it_was() {
    use pyrophone_flame::vortex_texture::Recipe;

    const SHORT_DIGEST: u64 = 0x0d5a_d014_2498_26e2;
    let Shipped { name, recipe, speeds: (low, ..) } = Shipped::ALL[0];
    let short = Recipe { period_s: recipe.period_s / 16.0, ..recipe };
    assert_eq!(16 * short.period_steps(low), recipe.period_steps(low), "steps are as long");
    let recorded = |recipe: Recipe| {
        let row = recipe.record(low, |_| true).unwrap();
        VortexTexture::new(recipe.rate_hz, vec![row]).unwrap().to_bytes()
    };
    let found = digest(&recorded(short));
    assert_eq!(found, SHORT_DIGEST, "{name}: {found:#018x}: the flow, or what is heard of it, has changed");
    if std::env::var("PYROPHONE_SOAK").as_deref() == Ok("1") {
        let shipped = VortexTexture::new(recipe.rate_hz, vec![texture(name).rows()[0].clone()]).unwrap().to_bytes();
        assert!(recorded(recipe) == shipped, "{name}: the shipped row is not what the recipe makes");
    }
}
