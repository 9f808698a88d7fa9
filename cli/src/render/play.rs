//! Rendering of a whole signal through the chain.

use pyrophone_settings::Values;
use pyrophone_settings::automation::Event;
use pyrophone_synthesis::chain::{Chain, Transport};

use crate::error::Error;

/// Samples per call of the chain, unless automation splits the block.
pub const BLOCK_SAMPLES: usize = 4096;

/// Everything to play.
pub struct Score<'a> {
    /// Channels of the main input, all of the same length.
    pub main: &'a [Vec<f32>],
    /// Channels of the sidechain, of that length too.
    pub sidechain: &'a [Vec<f32>],
    /// Channels of the output.
    pub outputs: usize,
    /// Values of all parameters at the start.
    pub values: Values,
    /// Parameter changes, sorted by time.
    pub events: &'a [Event],
}

/// Plays the whole score from position 0 and cuts off the latency. `go_on` receives the finished share (0-1) and
/// returns whether to continue.
pub fn play(
    chain: &mut Chain,
    score: &Score<'_>,
    block_samples: usize,
    go_on: &dyn Fn(f32) -> bool,
) -> Result<Vec<Vec<f32>>, Error> {
    let latency = chain.latency_samples();
    let total = score.main.first().map_or(0, Vec::len) + latency;
    let padded = |channel: &Vec<f32>| {
        let mut padded = channel.clone();
        padded.resize(total, 0.0);
        padded
    };
    let mut played: Vec<Vec<f32>> = score.main.iter().map(padded).collect();
    played.resize(score.outputs, vec![0.0; total]);
    let sidechain: Vec<Vec<f32>> = score.sidechain.iter().map(padded).collect();
    let mut values = score.values;
    let mut events = score.events.iter().peekable();
    let mut at = 0;
    while at < total {
        while let Some(event) = events.next_if(|event| event.sample <= at as u64) {
            values.set(event.parameter, event.value)?;
        }
        let next_event = events.peek().map_or(total, |event| usize::try_from(event.sample).unwrap_or(total));
        let end = total.min(at + block_samples).min(next_event);
        let mut block: Vec<&mut [f32]> = played.iter_mut().map(|channel| &mut channel[at..end]).collect();
        let side: Vec<&[f32]> = sidechain.iter().map(|channel| &channel[at..end]).collect();
        let transport = Transport { playing: true, position: Some(at as i64) };
        chain.process(&mut block, &side, &values.controls(), transport);
        at = end;
        if !go_on(at as f32 / total as f32) {
            return Err(Error::Cancelled);
        }
    }
    for channel in &mut played {
        channel.drain(..latency);
    }
    Ok(played)
}

#[cfg(test)]
mod tests {
    use pyrophone_settings::{Automation, Preset};
    use pyrophone_synthesis::chain::Channels;

    use super::*;

    const RATE_HZ: f64 = 48_000.0;

    /// Half a second of hum through the preset `extend`, with automation.
    fn played(csv: &str, block_samples: usize) -> Vec<Vec<f32>> {
        let values = Preset::find("extend").unwrap().values;
        let channels = Channels { input: 1, sidechain: 0, output: 2 };
        let mut chain = Chain::new(RATE_HZ, channels, &values.structure()).unwrap();
        let hum = (0..24_000).map(|n| 0.3 * (n as f32 * 0.0118).sin()).collect();
        let events = Automation::from_csv(csv).unwrap().events(RATE_HZ);
        let score = Score { main: &[hum], sidechain: &[], outputs: 2, values, events: &events };
        play(&mut chain, &score, block_samples, &|_| true).unwrap()
    }

    #[test]
    fn linear_ramp_is_independent_of_block_size() {
        let csv =
            "time_s,id,value,curve\n0,alpha,1,linear\n0.05,output_level,-20,linear\n0.3,output_level,0\n0.4,alpha,5\n";
        let whole = played(csv, BLOCK_SAMPLES);
        for block_samples in [1, 37, 480, 100_000] {
            assert!(played(csv, block_samples) == whole, "blocks of {block_samples}");
        }
        assert!(played(&csv.replace("linear", "step"), BLOCK_SAMPLES) != whole, "the ramp is not heard");
    }

    #[test]
    fn linear_ramp_of_the_level_rises_evenly() {
        let flat = played("time_s,id,value\n0,output_level,0\n", BLOCK_SAMPLES);
        let ramp = played("time_s,id,value,curve\n0,output_level,-20,linear\n0.5,output_level,0\n", BLOCK_SAMPLES);
        for n in (2_000..22_000).step_by(997).filter(|n| flat[0][*n].abs() > 0.01) {
            let expected_db = -20.0 + 20.0 * n as f32 / 24_000.0;
            let found_db = 20.0 * (ramp[0][n] / flat[0][n]).log10();
            assert!((found_db - expected_db).abs() < 0.5, "sample {n}: {found_db} instead of {expected_db} dB");
        }
    }
}
