use super::*;
use crate::{ControllerMessage, Event, Format, Parameter, Tail};

#[test]
fn random_sizes_reach_from_none_to_the_longest() {
    let mut sizes = BlockSizes::new(&BlockSize::Random { seed: 3, max: 7 }).unwrap();
    let mut seen = [false; 8];
    for _ in 0..1000 {
        seen[sizes.next()] = true;
    }
    assert_eq!(seen, [true; 8]);
    for block in [BlockSize::Fixed(0), BlockSize::Cycle(vec![0, 0])] {
        assert!(BlockSizes::new(&block).is_err());
    }
}

/// Delays by its latency and multiplies by the one parameter's value, sample by sample.
struct Delay {
    line: Vec<f32>,
    at: usize,
    gain: f32,
}

impl Processor for Delay {
    fn start(&mut self) -> Result<(), HostError> {
        self.line.fill(0.0);
        Ok(())
    }

    fn stop(&mut self) {}

    fn reset(&mut self) -> Result<(), HostError> {
        self.start()
    }

    fn process(&mut self, block: &mut Block<'_>) -> Result<(), HostError> {
        let position = block.transport.and_then(|t| t.position).unwrap_or(-1);
        assert_eq!(position, 1000 + self.at as i64, "the time line has a gap");
        for frame in 0..block.output[0].len() {
            for event in block.events.iter().filter(|e| e.offset as usize == frame) {
                self.gain = event.value as f32;
            }
            let length = self.line.len();
            let delayed = std::mem::replace(&mut self.line[self.at % length], block.input[0][frame]);
            block.output[0][frame] = delayed * self.gain;
            self.at += 1;
        }
        Ok(())
    }

    fn move_controllers(&mut self, _: &[ControllerMessage]) {}

    fn tail(&mut self) -> Tail {
        Tail::Samples(0)
    }

    fn instance(&self) -> u64 {
        0
    }
}

struct DelayPlugin;

impl Plugin for DelayPlugin {
    fn format(&self) -> Format {
        Format::Clap
    }

    fn name(&self) -> &str {
        "delay"
    }

    fn parameters(&self) -> &[Parameter] {
        &[]
    }

    fn value(&mut self, id: u32) -> Result<f64, HostError> {
        Err(HostError::UnknownParameter { id })
    }

    fn set_value(&mut self, id: u32, _: f64) -> Result<(), HostError> {
        Err(HostError::UnknownParameter { id })
    }

    fn text(&mut self, id: u32, _: f64) -> Result<String, HostError> {
        Err(HostError::UnknownParameter { id })
    }

    fn parse(&mut self, id: u32, _: &str) -> Result<f64, HostError> {
        Err(HostError::UnknownParameter { id })
    }

    fn state(&mut self) -> Result<Vec<u8>, HostError> {
        Ok(Vec::new())
    }

    fn set_state(&mut self, _: &[u8]) -> Result<(), HostError> {
        Ok(())
    }

    fn activate(&mut self, _: &Configuration) -> Result<Box<dyn Processor>, HostError> {
        Ok(Box::new(Delay { line: vec![0.0; 7], at: 0, gain: 1.0 }))
    }

    fn deactivate(&mut self, _: Box<dyn Processor>) -> Result<(), HostError> {
        Ok(())
    }

    fn take_reported_values(&mut self) -> Vec<Event> {
        Vec::new()
    }

    fn take_menu_choices(&mut self) -> Vec<(u32, i32)> {
        Vec::new()
    }

    fn latency_samples(&mut self) -> u32 {
        7
    }

    fn run_callbacks(&mut self) -> Requests {
        Requests::default()
    }

    fn open_editor(&mut self, _: u32) -> Result<(u32, u32), HostError> {
        Err(HostError::Unsupported(String::new()))
    }

    fn scale_editor(&mut self, _: f64) -> Result<(u32, u32), HostError> {
        unreachable!()
    }

    fn resize_editor(&mut self, _: (u32, u32)) -> Result<(u32, u32), HostError> {
        Err(HostError::Process)
    }

    fn take_wanted_editor_size(&mut self) -> Option<(u32, u32)> {
        None
    }

    fn close_editor(&mut self) {}

    fn forget_editor(&mut self) {}
}

#[test]
fn latency_and_padding_are_compensated_and_automation_is_exact() {
    let input: Vec<f32> = (1..=50_i16).map(f32::from).collect();
    for block in [
        BlockSize::Fixed(1),
        BlockSize::Fixed(64),
        BlockSize::Cycle(vec![0, 3, 5]),
        BlockSize::Random { seed: 1, max: 9 },
    ] {
        let mut options = BounceOptions::new(48_000.0, BusLayout { input: 1, sidechain: 0, output: 1 });
        options.block = block;
        options.pad_before = 11;
        options.extra_after = 4;
        options.start_position = 1000;
        options.automation = vec![AutomationPoint { sample: 27, id: 0, value: 0.5 }];
        let bounced = bounce(&mut DelayPlugin, std::slice::from_ref(&input), None, &options).unwrap();
        // The gain acts on what leaves the plugin, which is 7 samples older than what enters it.
        let expected: Vec<f32> = input
            .iter()
            .copied()
            .chain([0.0; 4])
            .enumerate()
            .map(|(i, x)| if i + 7 >= 27 { x * 0.5 } else { x })
            .collect();
        assert_eq!(bounced.channels, [expected], "{:?}", options.block);
        assert_eq!(bounced.latency_samples, 7);
    }
}

#[test]
fn automation_moves_with_the_padding() {
    let layout = BusLayout { input: 1, sidechain: 0, output: 1 };
    let mut options = BounceOptions::new(48_000.0, layout);
    options.pad_before = 10;
    let point = |sample, id| AutomationPoint { sample, id, value: 0.0 };
    options.automation = vec![point(5, 1), point(-99, 2), point(-3, 3), point(90, 4)];
    let events: Vec<_> = absolute_events(&options, 100).into_iter().map(|(sample, event)| (sample, event.id)).collect();
    assert_eq!(events, [(0, 2), (7, 3), (15, 1)]);
}
