//! An instance that is played block by block, while the test's own thread is the host's main thread.

use pyrophone_host::bounce::{AutomationPoint, await_ready};
use pyrophone_host::{Block, BusLayout, Configuration, ControllerMessage, Event, Plugin, Processor, Tail, Transport};

/// Longest block, in frames.
pub const MAX_BLOCK: usize = 8192;

/// The host's timeline.
#[derive(Debug, Clone, Copy)]
pub enum Clock {
    /// It plays, from this position on.
    Playing(i64),
    /// Likewise, and tells no tempo.
    WithoutTempo(i64),
    /// It stands at this position.
    Stopped(i64),
    /// It tells nothing at all.
    Absent,
}

impl Clock {
    /// The timeline `samples` later.
    #[must_use]
    pub fn transport(self, samples: usize) -> Option<Transport> {
        let later = |position: i64| position.saturating_add_unsigned(samples as u64);
        match self {
            Self::Playing(position) => Some(Transport::playing_at(later(position))),
            Self::WithoutTempo(position) => Some(Transport { tempo: None, ..Transport::playing_at(later(position)) }),
            Self::Stopped(position) => Some(Transport { playing: false, ..Transport::playing_at(position) }),
            Self::Absent => None,
        }
    }
}

/// An active instance that plays.
pub struct Live {
    player: Player,
    plugin: Box<dyn Plugin>,
}

/// The half that plays; it may go to another thread.
pub struct Player {
    processor: Box<dyn Processor>,
    layout: BusLayout,
}

impl Live {
    /// Activates as for playing in real time, once the recording is there, and starts.
    pub fn start(mut plugin: Box<dyn Plugin>, sample_rate: f64, layout: BusLayout) -> Self {
        let configuration = Configuration { sample_rate, max_block: MAX_BLOCK, layout, offline: false };
        await_ready(plugin.as_mut(), &configuration).unwrap_or_else(|error| panic!("{error}"));
        let mut processor = plugin.activate(&configuration).unwrap_or_else(|error| panic!("{error}"));
        plugin.run_callbacks();
        processor.start().unwrap_or_else(|error| panic!("{error}"));
        Self { player: Player { processor, layout }, plugin }
    }

    /// The half of the main thread, and the one that plays.
    pub fn halves(&mut self) -> (&mut dyn Plugin, &mut Player) {
        (self.plugin.as_mut(), &mut self.player)
    }

    /// The half of the main thread.
    pub fn plugin(&mut self) -> &mut dyn Plugin {
        self.plugin.as_mut()
    }

    /// Plays `input` in blocks of at most `block` frames; the output is not compensated.
    pub fn play(&mut self, input: &[Vec<f32>], clock: Clock, block: usize) -> Vec<Vec<f32>> {
        self.player.play(input, clock, block)
    }

    /// The same with automation, whose samples count from the input's first.
    pub fn play_automated(
        &mut self,
        input: &[Vec<f32>],
        clock: Clock,
        block: usize,
        points: &[AutomationPoint],
    ) -> Vec<Vec<f32>> {
        self.player.play_automated(input, clock, block, points)
    }

    /// Has messages of MIDI controllers come with the next block.
    pub fn move_controllers(&mut self, messages: &[ControllerMessage]) {
        self.player.processor.move_controllers(messages);
    }

    /// The tail reported at present.
    pub fn tail(&mut self) -> Tail {
        self.player.processor.tail()
    }

    /// Ends playing; the instance is inactive then.
    pub fn stop(self) -> Box<dyn Plugin> {
        let Self { player, mut plugin } = self;
        plugin.deactivate(player.processor).unwrap_or_else(|error| panic!("{error}"));
        plugin.run_callbacks();
        plugin
    }
}

impl Player {
    /// As [`Live::play`].
    pub fn play(&mut self, input: &[Vec<f32>], clock: Clock, block: usize) -> Vec<Vec<f32>> {
        self.play_automated(input, clock, block, &[])
    }

    /// As [`Live::play_automated`].
    pub fn play_automated(
        &mut self,
        input: &[Vec<f32>],
        clock: Clock,
        block: usize,
        points: &[AutomationPoint],
    ) -> Vec<Vec<f32>> {
        let samples = input[0].len();
        let mut output = vec![vec![f32::NAN; samples]; self.layout.output as usize];
        let mut start = 0;
        while start < samples {
            let range = start..samples.min(start + block);
            let due = points.iter().filter(|point| range.contains(&(point.sample as usize)));
            let events: Vec<Event> = due
                .map(|point| Event { offset: (point.sample as usize - start) as u32, id: point.id, value: point.value })
                .collect();
            let inputs: Vec<&[f32]> = input.iter().map(|channel| &channel[range.clone()]).collect();
            let mut outputs: Vec<&mut [f32]> = output.iter_mut().map(|channel| &mut channel[range.clone()]).collect();
            let mut block = Block {
                input: &inputs,
                sidechain: None,
                output: &mut outputs,
                events: &events,
                transport: clock.transport(start),
                in_place: false,
            };
            self.processor.process(&mut block).unwrap_or_else(|error| panic!("{error}"));
            start = range.end;
        }
        output
    }
}
