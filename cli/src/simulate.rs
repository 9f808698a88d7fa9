//! `pyrophone simulate`: the flame signal of a built-in scene.

mod kept;

use std::path::{Path, PathBuf};

use pyrophone_flame::flux::{Flux, Row, Steps};
use pyrophone_flame::front::{Mesh, Refinement};
use pyrophone_flame::import::npz::{DenseFrame, write_frame};
use pyrophone_flame::scenes::{Options, STEP_RATE_HZ, Scene, Simulation};
use pyrophone_flame::speed_field::{Regions, Up, stride};
use pyrophone_flame::{Frame, Front};
use pyrophone_recording::write_file;
use pyrophone_synthesis::vortex::{End, SpeedField};

use self::kept::{Flow, SimulationCheckpoint};
use crate::args::SimulateArgs;
use crate::error::Error;
use crate::flux::signal::Signal;
use crate::flux::{motion, sound};
use crate::input::in_range;
use crate::output::make_folder;
use crate::progress::{Stage, Work, note};
use crate::report::View;
use crate::summary::Outcome;

/// Value of the burning field at the flame front.
const ISO: f64 = 0.5;

/// Number of pictures of the front in a report.
const PICTURES: u64 = 12;

/// Steps between checkpoints.
const KEEP_STEPS: u64 = 360;

/// Simulates a scene and writes the requested outputs.
pub fn run(args: &SimulateArgs, work: &Work) -> Result<Outcome, Error> {
    let field: Vec<&Path> = args.speed_field.iter().map(|path| path.as_path()).collect();
    sound::check(&args.sound, None, &field, false)?;
    let plan = Plan::new(args)?;
    let outputs = sound::files(&args.sound).chain(args.speed_field.as_deref()).chain(args.sound.report.as_deref());
    let Some(beside) = outputs.into_iter().next() else { return Ok(Outcome::default()) };
    let mut kept = SimulationCheckpoint::open(beside, plan.settings(), plan.regions.as_ref().map_or(0, Regions::len));
    let Simulated { steps, meshes, flow } = match plan.simulate(&mut kept, work) {
        Ok(simulated) => simulated,
        Err(error) => return Err(kept.unfinished(error)),
    };
    if let Some(path) = &args.speed_field {
        let start_s = args.sound.time_reference.unwrap_or(0) as f64 / f64::from(args.sound.sample_rate);
        let written = plan.field(&flow).and_then(|field| motion::write(path, &field.starting_at(start_s)));
        if let Err(error) = written {
            return Err(kept.unfinished(error));
        }
    }
    let flux = Flux::from_steps(&steps)?;
    let signal = Signal::of_flux(&flux, Some(STEP_RATE_HZ));
    let view = View::of_meshes(meshes.iter().map(|(_, mesh)| mesh));
    let label = |frame: i64| format!("frame {frame} · {:.3} s", frame as f64 / STEP_RATE_HZ);
    let surfaces = meshes.iter().map(|(frame, mesh)| (label(*frame), view.draw(mesh))).collect();
    let facts = vec![("Scene".into(), plan.options_text()), ("Box".into(), plan.box_text()?)];
    match sound::write(&args.sound, &signal, Some(&flux), facts, surfaces, work) {
        Ok(done) => {
            kept.remove();
            Ok(done.with_files(args.speed_field.iter().cloned().collect()))
        }
        Err(error) => Err(kept.unfinished(error)),
    }
}

/// A simulation to be run.
struct Plan {
    options: Options,
    scene: Scene,
    front: Front,
    refinement: Refinement,
    /// Steps before the first recorded step, and recorded steps.
    pre_roll: u64,
    count: u64,
    cache: Option<PathBuf>,
    /// True if pictures are requested.
    draws: bool,
    /// Sub-volumes whose speeds are requested.
    regions: Option<Regions>,
}

/// Fronts to draw, with their frames.
type Meshes = Vec<(i64, Mesh)>;

/// All measurements.
struct Simulated {
    steps: Steps,
    meshes: Meshes,
    flow: Flow,
}

/// Results of one step.
struct Measured {
    row: Row,
    /// Speeds of the sub-volumes, at every step that the field needs.
    speeds: Option<Vec<f32>>,
    /// The front, if it is to be drawn.
    mesh: Option<Mesh>,
}

impl Plan {
    fn new(args: &SimulateArgs) -> Result<Self, Error> {
        let scene = args.scene;
        in_range("--seconds", args.seconds, 0.01, 3600.0)?;
        let pre_roll_s = args.pre_roll.unwrap_or(scene.default_pre_roll_s());
        in_range("--pre-roll", pre_roll_s, 0.0, 60.0)?;
        let options = Options {
            resolution: args.resolution.unwrap_or(Options::default().resolution),
            seed: args.seed,
            intensity: args.intensity,
            wind: args.wind,
            turbulence: args.turbulence,
        };
        Ok(Self {
            options,
            scene,
            front: Front::new(ISO, args.refine)?,
            refinement: args.refine.into(),
            pre_roll: (pre_roll_s * STEP_RATE_HZ).round() as u64,
            count: ((args.seconds * STEP_RATE_HZ).round() as u64).max(1),
            cache: args.cache.clone(),
            draws: args.sound.report.is_some(),
            regions: match args.speed_field {
                Some(_) => Some(Regions::of_solver(Simulation::new(scene, options)?.solver())),
                None => None,
            },
        })
    }

    fn options_text(&self) -> String {
        let Options { resolution, seed, intensity, wind, turbulence } = self.options;
        format!(
            "{}, resolution {resolution}, seed {seed}, intensity {intensity}, wind {wind}, turbulence {turbulence}, pre-roll {} steps",
            self.scene.name(),
            self.pre_roll
        )
    }

    /// Settings that a resumed run must share with the interrupted one. The length is not among them.
    fn settings(&self) -> String {
        let cache = self.cache.as_ref().map(|folder| format!(", cache {}", folder.display())).unwrap_or_default();
        let field = if self.regions.is_some() { ", speed field" } else { "" };
        format!("{}, iso {ISO}, refine {}{cache}{field}", self.options_text(), self.refinement)
            .replace(['\n', '\r'], " ")
    }

    fn box_text(&self) -> Result<String, Error> {
        let simulation = Simulation::new(self.scene, self.options)?;
        let domain = simulation.solver().domain();
        let [x, y, z] = domain.shape();
        Ok(format!("{x}×{y}×{z} voxels of {:.1} mm", 1000.0 * domain.voxel_size_m()))
    }

    /// Flux and area of all recorded steps, and the fronts to draw.
    fn simulate(&self, kept: &mut SimulationCheckpoint, work: &Work) -> Result<Simulated, Error> {
        if let Some(folder) = &self.cache {
            make_folder(folder)?;
            self.check_cache(folder)?;
        }
        let mut simulation = Simulation::new(self.scene, self.options)?;
        let (mut steps, mut flow) = kept.restore(&mut simulation);
        let is_kept = |frame: &i64| self.cache_path(frame.unsigned_abs()).is_none_or(|path| path.is_file());
        let frames = simulation.steps().saturating_sub(self.pre_roll);
        let flow_is_whole = self.regions.is_none() || flow.len() as u64 == frames.div_ceil(stride(STEP_RATE_HZ));
        if steps.len() as u64 != frames || !steps.keys().all(is_kept) || !flow_is_whole {
            note("the interrupted run's files are incomplete; starting again");
            simulation.reset();
            steps.clear();
            flow.clear();
        }
        if simulation.steps() > 0 {
            note(&format!("{} steps are reused from an interrupted run", simulation.steps()));
            steps.retain(|frame, _| frame.unsigned_abs() < self.count);
            flow.truncate(self.count.div_ceil(stride(STEP_RATE_HZ)) as usize);
        }
        let stage = work.stage("simulating");
        let mut meshes = vec![];
        let total = self.pre_roll + self.count;
        while simulation.steps() < total {
            let end = (simulation.steps() / KEEP_STEPS + 1) * KEEP_STEPS;
            for measured in self.stretch(&mut simulation, end.min(total), &stage)? {
                meshes.extend(measured.mesh.map(|mesh| (measured.row.frame, mesh)));
                flow.extend(measured.speeds);
                steps.insert(measured.row.frame, Some(measured.row));
            }
            kept.keep(&simulation, &steps, &flow)?;
            work.check()?;
        }
        Ok(Simulated { steps, meshes, flow })
    }

    /// Continues up to step `end`, or until cancelled; the fronts of all steps are measured.
    fn stretch(&self, simulation: &mut Simulation, end: u64, stage: &Stage<'_>) -> Result<Vec<Measured>, Error> {
        let total = (self.pre_roll + self.count) as f32;
        let mut measured = vec![];
        let mut last: Option<Frame> = None;
        while simulation.steps() < end && stage.report(simulation.steps() as f32 / total) {
            // While the gas takes its next step, the front of the last one is measured.
            let (_, front) = rayon::join(|| simulation.step(), || last.take().map(|frame| self.measure(&frame)));
            measured.extend(front.transpose()?);
            last = self.frame(simulation)?;
        }
        measured.extend(last.map(|frame| self.measure(&frame)).transpose()?);
        Ok(measured)
    }

    fn measure(&self, frame: &Frame) -> Result<Measured, Error> {
        let row = Row::new(frame.number, &self.front.measure(frame)?);
        let every = self.count.div_ceil(PICTURES);
        let number = frame.number.unsigned_abs();
        let is_drawn = self.draws && number % every == every / 2;
        let regions = self.regions.as_ref().filter(|_| self.is_in_field(number));
        Ok(Measured {
            row,
            mesh: is_drawn.then(|| self.front.mesh(&frame.field)).transpose()?,
            speeds: regions.map(|regions| regions.mean_speeds(&frame.velocity)),
        })
    }

    /// The speed field of the measured speeds.
    fn field(&self, flow: &Flow) -> Result<SpeedField, Error> {
        let Some(regions) = &self.regions else { return Err(pyrophone_flame::Error::NoMotion.into()) };
        let rate_hz = STEP_RATE_HZ / stride(STEP_RATE_HZ) as f64;
        Ok(regions.field(flow, rate_hz, Up::Z, End::Clamped)?)
    }

    /// The last step, if it is recorded; numbered from the first recorded step, as in the cache.
    fn frame(&self, simulation: &Simulation) -> Result<Option<Frame>, Error> {
        let Some(number) = simulation.steps().checked_sub(self.pre_roll + 1) else { return Ok(None) };
        if let Some(path) = self.cache_path(number) {
            self.write_cache(&path, number, simulation)?;
        }
        // Only the speed field's steps need the gas far from the front.
        let frame = if self.is_in_field(number) { simulation.frame()? } else { simulation.front_frame()? };
        Ok(Some(Frame { number: i64::try_from(number).unwrap_or(i64::MAX), ..frame }))
    }

    /// True if the speed field has a step at a frame.
    fn is_in_field(&self, frame: u64) -> bool {
        self.regions.is_some() && frame.is_multiple_of(stride(STEP_RATE_HZ))
    }

    fn cache_path(&self, frame: u64) -> Option<PathBuf> {
        self.cache.as_ref().map(|folder| folder.join(format!("{}_{frame:06}.npz", self.scene.name())))
    }

    /// Rejects a folder with frames that this run would not overwrite: they would be mixed with its own.
    fn check_cache(&self, folder: &Path) -> Result<(), Error> {
        let own = |name: &str| {
            let number = name.strip_prefix(self.scene.name()).and_then(|rest| rest.strip_prefix('_'));
            number.and_then(|rest| rest.strip_suffix(".npz")?.parse().ok()).is_some_and(|frame: u64| frame < self.count)
        };
        let others = folder.read_dir().into_iter().flatten().flatten().map(|entry| entry.file_name());
        let foreign =
            others.map(|name| name.to_string_lossy().into_owned()).find(|name| name.ends_with(".npz") && !own(name));
        foreign.map_or(Ok(()), |name| {
            let shown = folder.display();
            Err(Error::Conflict(format!("{shown}: it contains {name} from another run; choose another folder")))
        })
    }

    fn write_cache(&self, path: &Path, number: u64, simulation: &Simulation) -> Result<(), Error> {
        let (flame, velocity) = simulation.solver().centred();
        let domain = simulation.solver().domain();
        let frame = DenseFrame {
            shape: domain.shape(),
            flame: &flame,
            velocity: &velocity,
            voxel_size: domain.voxel_size_m(),
            origin: simulation.solver().origin_m(),
            time_s: Some(number as f64 / STEP_RATE_HZ),
        };
        Ok(write_file(path, |file| write_frame(std::io::BufWriter::new(file), &frame))?)
    }
}
