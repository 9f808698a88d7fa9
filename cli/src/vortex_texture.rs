//! `pyrophone vortex-texture`: the sound that turbulent gas radiates over a range of speeds.

mod kept;

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use pyrophone_flame::vortex_texture::{FlowModel, Origin, Progress, Recipe, speeds};
use pyrophone_recording::write_file;
use pyrophone_synthesis::vortex::texture::{Row, VortexTexture};
use rayon::prelude::*;

use self::kept::TextureCheckpoint;
use crate::args::{FlowKind, VortexTextureArgs};
use crate::error::Error;
use crate::output::check_file;
use crate::progress::{Stage, Work, note};
use crate::summary::Outcome;

/// Share of a row's work that settling is assumed to take.
const SETTLING: f64 = 0.3;

/// Records a texture and writes it.
pub fn run(args: &VortexTextureArgs, work: &Work) -> Result<Outcome, Error> {
    let plan = Plan::new(args)?;
    check_file(&args.output)?;
    let mut kept = TextureCheckpoint::open(&args.output, plan.settings());
    kept.restore();
    let kept = Mutex::new(kept);
    let recorded = plan.record(&kept, work);
    let kept = kept.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    let written = recorded.and_then(|rows| {
        let texture = VortexTexture::new(plan.recipe.rate_hz, rows).map_err(Error::of_file(&args.output))?;
        let bytes = texture.to_bytes();
        Ok(write_file(&args.output, |file| std::io::Write::write_all(file, &bytes))?)
    });
    match written {
        Ok(()) => {
            kept.remove();
            Ok(Outcome { output: Some(args.output.clone()), ..Outcome::default() })
        }
        Err(error) => Err(kept.unfinished(error)),
    }
}

/// A texture to record.
struct Plan {
    recipe: Recipe,
    speeds_m_s: Vec<f64>,
}

impl Plan {
    fn new(args: &VortexTextureArgs) -> Result<Self, Error> {
        let recipe = Recipe {
            kind: match args.kind {
                FlowKind::Wind => FlowModel::Wind,
                FlowKind::Fire => FlowModel::Fire,
                FlowKind::Jet => FlowModel::Jet,
            },
            voxels: args.voxels,
            voxel_size_m: args.voxel_size,
            rate_hz: args.rate,
            period_s: args.seconds,
            perturbation: args.perturbation,
            origin: if args.paper { Origin::Cells } else { Origin::Centre },
            seed: args.seed,
        };
        recipe.validate()?;
        let (low, high, count) = args.speeds;
        Ok(Self { recipe, speeds_m_s: speeds(low, high, count)? })
    }

    /// Settings that a resumed run must share with the interrupted one. The set of rows is not among them.
    fn settings(&self) -> String {
        let Recipe { kind, voxels: [x, y, z], voxel_size_m, rate_hz, period_s, perturbation, origin, seed } =
            self.recipe;
        format!(
            "{}, {x}x{y}x{z} voxels of {voxel_size_m} m, {period_s} s at {rate_hz} Hz, perturbation {perturbation}, seed {seed}{}",
            kind.name(),
            if origin == Origin::Cells { ", paper" } else { "" }
        )
    }

    /// Records all rows, as many at a time as there are cores; each is stored once it is done.
    fn record(&self, kept: &Mutex<TextureCheckpoint>, work: &Work) -> Result<Vec<Row>, Error> {
        let stage = work.stage("recording");
        let total: usize = self.speeds_m_s.iter().map(|speed| self.recipe.recorded_steps(*speed)).sum();
        let meter = Meter { stage: &stage, done: AtomicU64::new(0), total: total as f64 };
        let from_before: Vec<Option<Row>> = self.speeds_m_s.iter().map(|speed| lock(kept).row(*speed)).collect();
        let found = from_before.iter().flatten().count();
        if found > 0 {
            note(&format!("{found} rows are reused from an interrupted run"));
        }
        // The long ones first, so that no core is left alone with one at the end.
        let rows: Result<Vec<Row>, Error> = self
            .speeds_m_s
            .par_iter()
            .zip(from_before)
            .rev()
            .with_max_len(1)
            .map(|(speed, before)| match before {
                Some(row) => Ok(row),
                None => {
                    let row = self.row(*speed, &meter)?;
                    lock(kept).keep(row.clone())?;
                    Ok(row)
                }
            })
            .collect();
        let mut rows = rows?;
        rows.reverse();
        Ok(rows)
    }

    fn row(&self, speed_m_s: f64, meter: &Meter<'_>) -> Result<Row, Error> {
        let steps = self.recipe.recorded_steps(speed_m_s) as f64;
        let mut before = 0.0;
        let row = self.recipe.record(speed_m_s, |progress| {
            let now = match progress {
                // The time that settling takes is unknown, so each report covers half of the rest of its share.
                Progress::Settling => before + 0.5 * (SETTLING - before) / steps.max(1.0),
                Progress::Recording(share) => f64::max(before, SETTLING + (1.0 - SETTLING) * share),
            };
            let go_on = meter.add((now - before) * steps);
            before = now;
            go_on
        });
        row.map_err(|error| match error {
            pyrophone_flame::Error::Cancelled => Error::Cancelled,
            other => other.into(),
        })
    }
}

/// One progress bar for all rows.
struct Meter<'a> {
    stage: &'a Stage<'a>,
    /// Thousandths of steps done.
    done: AtomicU64,
    total: f64,
}

impl Meter<'_> {
    /// Adds finished steps; returns false to stop.
    fn add(&self, steps: f64) -> bool {
        let more = (steps * 1e3) as u64;
        let done = self.done.fetch_add(more, Ordering::Relaxed) + more;
        self.stage.report((done as f64 * 1e-3 / self.total) as f32)
    }
}

fn lock(kept: &Mutex<TextureCheckpoint>) -> std::sync::MutexGuard<'_, TextureCheckpoint> {
    kept.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}
