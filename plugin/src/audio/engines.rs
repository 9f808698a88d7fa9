//! Engines for one activation, built on a thread of their own, so that a host's main thread need not wait for them.

use std::sync::mpsc;
use std::thread::JoinHandle;
use std::time::Duration;

use nice_plug::nice_warn;
use pyrophone_synthesis::Error;
use pyrophone_synthesis::chain::Chain;
use pyrophone_synthesis::vortex::SpeakerLayout;
use ringbuf::traits::{Consumer, Producer, Split};
use ringbuf::{HeapCons, HeapProd, HeapRb};

use super::audition::Audition;
use super::burst::Burst;
use crate::gas::Gas;
use crate::loader::Engine;
use crate::loader::link::fingerprint;

/// The engines that run.
pub struct Engines {
    pub(super) chain: Chain,
    pub(super) audition: Audition,
    pub(super) burst: Burst,
    /// Fingerprint of the running structure.
    pub(super) structure: u64,
    pub(super) latency_samples: u32,
    /// Fingerprint of the structure for which a restart was last requested.
    pub(super) restart_asked: u64,
    engine: Engine,
    gas: Option<Gas>,
}

impl Engines {
    /// Engines without a recording.
    ///
    /// # Errors
    /// As [`Chain::new`].
    pub fn new(engine: Engine) -> Result<Self, Error> {
        let chain = Chain::new(engine.sample_rate_hz, engine.channels, &engine.structure)?;
        let layout = SpeakerLayout::of_channels(engine.channels.output);
        let effects = layout.ok().and_then(SpeakerLayout::low_frequency_effects);
        let structure = fingerprint(&engine.structure);
        Ok(Self {
            audition: Audition::new(chain.sample_rate_hz(), chain.latency_samples(), effects),
            burst: Burst::new(chain.sample_rate_hz()),
            structure,
            latency_samples: chain.latency_samples() as u32,
            restart_asked: structure,
            chain,
            engine,
            gas: None,
        })
    }

    /// What they were built for.
    pub fn engine(&self) -> &Engine {
        &self.engine
    }

    /// Restores the state of a fresh activation; keeps the recording.
    pub(super) fn reset(&mut self) {
        self.chain.reset();
        self.audition.reset();
        self.burst.stop();
    }

    /// Restarts the simulation of gas; an offline render waits for each of its steps.
    pub(super) fn start_gas(&mut self, is_offline: bool) {
        self.gas = match Gas::start(&mut self.chain, is_offline) {
            Ok(gas) => Some(gas),
            Err(reason) => {
                nice_warn!("Pyrophone's gas cannot be simulated live: {reason}");
                None
            }
        };
    }

    pub(super) fn stop_gas(&mut self) {
        self.gas = None;
    }

    /// Sets whether the simulated gas is in use; real-time safe.
    pub(super) fn set_gas_used(&self, used: bool) {
        if let Some(gas) = &self.gas {
            gas.set_used(used);
        }
    }
}

/// The end of a ring through which engines arrive.
pub struct Pending(HeapCons<Box<Engines>>);

impl Pending {
    /// Both ends of a new ring.
    pub fn pair() -> (HeapProd<Box<Engines>>, Self) {
        let (arriving, arrived) = HeapRb::new(1).split();
        (arriving, Self(arrived))
    }

    /// The engines, once they are built; real-time safe.
    pub(super) fn receive(&mut self) -> Option<Box<Engines>> {
        self.0.try_pop()
    }
}

/// Engines, or where they will arrive.
pub enum Built {
    /// Engines to run at once.
    Ready(Box<Engines>),
    /// Engines that are still being built.
    Pending(Pending),
}

/// Builds engines on a thread of its own.
#[derive(Debug, Default)]
pub struct Builder {
    thread: Option<JoinHandle<()>>,
}

impl Builder {
    /// Builds engines with gas, and waits for them for at most `limit` (`None`: no limit).
    ///
    /// # Errors
    /// What is wrong with `engine`, or with the system's threads.
    pub fn build(&mut self, engine: Engine, is_offline: bool, limit: Option<Duration>) -> Result<Built, String> {
        self.finish();
        let (mut arriving, mut pending) = Pending::pair();
        let (sender, receiver) = mpsc::channel();
        let work = move || {
            let built = Engines::new(engine).map(|mut engines| {
                engines.start_gas(is_offline);
                // If nobody awaits them any more, they end here.
                let _ = arriving.try_push(Box::new(engines));
            });
            let _ = sender.send(built.map_err(|error| error.to_string()));
        };
        let thread = std::thread::Builder::new().name("pyrophone-engines".to_owned()).spawn(work);
        self.thread = Some(thread.map_err(|error| format!("the system cannot start a thread ({error})"))?);
        let outcome = match limit {
            Some(limit) => receiver.recv_timeout(limit),
            None => receiver.recv().map_err(mpsc::RecvTimeoutError::from),
        };
        match outcome {
            Ok(Ok(())) => Ok(pending.receive().map_or(Built::Pending(pending), Built::Ready)),
            Ok(Err(reason)) => Err(reason),
            Err(mpsc::RecvTimeoutError::Timeout) => Ok(Built::Pending(pending)),
            Err(mpsc::RecvTimeoutError::Disconnected) => Err("building the engines failed".to_owned()),
        }
    }

    /// Waits until nothing is being built.
    pub fn finish(&mut self) {
        if let Some(thread) = self.thread.take() {
            // A panic in the thread has been reported by the thread itself.
            let _ = thread.join();
        }
    }
}

impl Drop for Builder {
    fn drop(&mut self) {
        self.finish();
    }
}
