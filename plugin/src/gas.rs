//! The gas of vortex sound's flow `live`: simulated on a separate thread, in time for the audio thread.
//!
//! Requests go one way through a ring, results the other way. Offline the audio thread waits for the results it needs;
//! in real time it holds the last step and counts the late ones. A block longer than a step (16 ms) leaves no time for
//! simulation, so some of its steps are late on any machine.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use pyrophone_flame::live::LiveFlow;
use pyrophone_synthesis::chain::Chain;
use pyrophone_synthesis::vortex::{Simulator, StepRequest};
use rayon::{ThreadPool, ThreadPoolBuilder};
use ringbuf::traits::{Consumer, Observer, Producer, Split};
use ringbuf::{HeapCons, HeapProd, HeapRb};

/// Most sources of the simulation.
const MOST_SOURCES: usize = 160;

/// Maximum number of pending steps; a block of 8192 samples at 44.1 kHz asks for twelve.
const STEPS: usize = 64;

/// Polling interval of the thread, while the flow is used and while it is not.
const POLL_INTERVAL: Duration = Duration::from_millis(1);
const REST: Duration = Duration::from_millis(8);

/// Polling interval of an offline render for its step.
const PATIENCE: Duration = Duration::from_micros(100);

/// Result of one step.
#[derive(Debug, Clone, Copy)]
struct StepResult {
    run: u64,
    step: u64,
    /// None where the simulation failed.
    speeds_m_s: Option<[f32; MOST_SOURCES]>,
}

/// The audio thread's end.
struct GasProxy {
    requests: HeapProd<StepRequest>,
    answers: HeapCons<StepResult>,
    /// The newest result received.
    newest: Option<StepResult>,
    /// True in an offline render.
    waits: bool,
}

impl GasProxy {
    /// Returns the result of a step, if available; drops those of earlier steps, which are obsolete.
    fn poll(&mut self, run: u64, step: u64) -> Option<&StepResult> {
        let is_wanted = |answer: &StepResult| (answer.run, answer.step) >= (run, step);
        while !self.newest.as_ref().is_some_and(is_wanted) {
            self.newest = Some(self.answers.try_pop()?);
        }
        self.newest.as_ref().filter(|answer| (answer.run, answer.step) == (run, step))
    }
}

impl Simulator for GasProxy {
    fn request(&mut self, request: StepRequest) {
        // Obsolete results make room.
        while self.newest.is_none_or(|answer| answer.run < request.run) {
            let Some(answer) = self.answers.try_pop() else { break };
            self.newest = Some(answer);
        }
        while self.requests.try_push(request).is_err() && self.waits && self.requests.read_is_held() {
            std::thread::sleep(PATIENCE);
        }
    }

    fn answer(&mut self, run: u64, step: u64, speeds_m_s: &mut [f32]) -> bool {
        loop {
            // Read before the ring is polled: results pushed before the thread ended must not be missed.
            let can_wait = self.waits && self.answers.write_is_held();
            if let Some(answer) = self.poll(run, step) {
                let Some(speeds) = &answer.speeds_m_s else { return false };
                let count = speeds_m_s.len().min(MOST_SOURCES);
                speeds_m_s[..count].copy_from_slice(&speeds[..count]);
                return true;
            }
            if !can_wait || self.newest.as_ref().is_some_and(|answer| (answer.run, answer.step) > (run, step)) {
                return false;
            }
            std::thread::sleep(PATIENCE);
        }
    }
}

/// The thread's end of one simulation.
struct GasWorker {
    requests: HeapCons<StepRequest>,
    answers: HeapProd<StepResult>,
    flow: LiveFlow,
    run: u64,
    /// A result for which there was no room yet.
    held: Option<StepResult>,
}

impl GasWorker {
    /// Simulates a requested step, if there is one.
    fn work(&mut self) -> bool {
        if let Some(answer) = self.held.take() {
            self.held = self.answers.try_push(answer).err();
            return self.held.is_none();
        }
        let Some(request) = self.requests.try_pop() else { return false };
        if request.run != self.run {
            self.run = request.run;
            self.flow.reset();
        }
        let speeds_m_s = self.flow.step(request.speed_m_s).ok().map(|speeds| {
            let mut speeds_m_s = [0.0; MOST_SOURCES];
            speeds_m_s.iter_mut().zip(speeds).for_each(|(to, speed)| *to = speed);
            speeds_m_s
        });
        self.held = self.answers.try_push(StepResult { run: request.run, step: request.step, speeds_m_s }).err();
        true
    }
}

/// Switches read by both threads.
#[derive(Debug, Default)]
struct Switches {
    /// True while the flow is in use.
    used: AtomicBool,
    quit: AtomicBool,
}

/// The thread that simulates for one chain; dropping it ends it.
#[derive(Debug)]
pub struct Gas {
    switches: Arc<Switches>,
    pool: Option<ThreadPool>,
    thread: Option<JoinHandle<()>>,
}

impl Gas {
    /// Starts the thread for `chain`, which waits for every step in an offline render (`waits`). If that fails, the
    /// flow `live` follows the envelope.
    pub fn start(chain: &mut Chain, waits: bool) -> Result<Self, String> {
        let step_s = chain.live_step_s();
        let flow = || LiveFlow::new(step_s).map_err(|error| error.to_string());
        let flows = [flow()?, flow()?];
        let places = flows[0].places();
        let mut workers = Vec::with_capacity(flows.len());
        let remotes = flows.map(|flow| {
            let (requests_in, requests_out) = HeapRb::new(STEPS).split();
            let (answers_in, answers_out) = HeapRb::new(STEPS).split();
            workers.push(GasWorker { requests: requests_out, answers: answers_in, flow, run: 0, held: None });
            Box::new(GasProxy { requests: requests_in, answers: answers_out, newest: None, waits })
                as Box<dyn Simulator>
        });
        chain.set_simulators(remotes, &places[..places.len().min(MOST_SOURCES)]).map_err(|error| error.to_string())?;
        let switches = Arc::new(Switches::default());
        let theirs = switches.clone();
        let work = move || {
            while !theirs.quit.load(Ordering::Relaxed) {
                // Counted, because `any` would stop at the first one with work.
                let found = workers.iter_mut().filter_map(|worker| worker.work().then_some(())).count();
                if found == 0 {
                    std::thread::sleep(if theirs.used.load(Ordering::Relaxed) { POLL_INTERVAL } else { REST });
                }
            }
        };
        // A separate pool does not queue: in the common one this work would wait behind the indexing of recordings. Its
        // thread must be joined here, because a pool does not do that.
        let mut thread = None;
        let pool = ThreadPoolBuilder::new().num_threads(1).panic_handler(|_| {}).spawn_handler(|worker| {
            let spawned = std::thread::Builder::new().name("pyrophone-gas".to_owned()).spawn(|| worker.run());
            thread = Some(spawned?);
            Ok(())
        });
        let pool = pool.build().map_err(|error| error.to_string())?;
        pool.spawn(work);
        Ok(Self { switches, pool: Some(pool), thread })
    }

    /// Sets whether the flow is in use; real-time safe.
    pub fn set_used(&self, used: bool) {
        self.switches.used.store(used, Ordering::Relaxed);
    }
}

impl Drop for Gas {
    fn drop(&mut self) {
        self.switches.quit.store(true, Ordering::Relaxed);
        // Its thread ends once the pool is gone.
        drop(self.pool.take());
        if let Some(thread) = self.thread.take() {
            // A panic in the thread has been reported by the thread itself.
            let _ = thread.join();
        }
    }
}
