//! Properties of each fuel.

use crate::controls::Fuel;

/// Sound of a fuel. Values are drawn uniformly from their ranges on a logarithmic scale.
#[derive(Debug)]
pub(super) struct Properties {
    pub bursts: Bursts,
    pub rupture: Rupture,
    pub hiss: Tone,
    pub body: Tone,
}

/// Times of the ruptures.
#[derive(Debug)]
pub(super) struct Bursts {
    /// Bursts a second.
    pub per_second: f64,
    /// Mean number of ruptures in a burst, more than 1.
    pub size: f64,
    /// Mean gap within a burst in seconds.
    pub gap_s: f64,
}

/// Sound of the ruptures.
#[derive(Debug)]
pub(super) struct Rupture {
    /// Peak of the median one in dBFS, and the standard deviation of peaks in dB.
    pub median_db: f64,
    pub deviation_db: f64,
    /// Time constant of the click in seconds, and its centre frequency in Hz.
    pub click_s: [f64; 2],
    pub click_hz: [f64; 2],
    /// Lowest mode in Hz of the piece that rings, its time constant in seconds, and its level against the click in dB.
    pub ring_hz: [f64; 2],
    pub ring_s: [f64; 2],
    pub ring_db: f64,
}

/// A layer of noise.
#[derive(Debug)]
pub(super) struct Tone {
    /// Frequency in Hz of the spectrum's hump.
    pub hump_hz: f64,
    /// Level in dB against other fuels.
    pub level_db: f64,
}

/// Tone without a fuel.
const NEUTRAL: [Tone; 2] = [Tone { hump_hz: 5000.0, level_db: 0.0 }, Tone { hump_hz: 160.0, level_db: 0.0 }];

/// Seasoned wood: sharp snaps, some of them loud; little steam.
const DRY_WOOD: Properties = Properties {
    bursts: Bursts { per_second: 10.0, size: 1.6, gap_s: 0.012 },
    rupture: Rupture {
        median_db: -27.0,
        deviation_db: 10.0,
        click_s: [0.0002, 0.0018],
        click_hz: [3000.0, 11_000.0],
        ring_hz: [900.0, 3500.0],
        ring_s: [0.0015, 0.006],
        ring_db: -8.0,
    },
    hiss: Tone { hump_hz: 5000.0, level_db: 0.0 },
    body: Tone { hump_hz: 160.0, level_db: 0.0 },
};

/// Green wood: pops of larger, duller pieces in longer bursts; steam whistles out of it.
const WET_WOOD: Properties = Properties {
    bursts: Bursts { per_second: 4.0, size: 2.5, gap_s: 0.025 },
    rupture: Rupture {
        median_db: -25.0,
        deviation_db: 10.0,
        click_s: [0.0006, 0.005],
        click_hz: [2000.0, 6000.0],
        ring_hz: [350.0, 1400.0],
        ring_s: [0.004, 0.010],
        ring_db: -3.0,
    },
    hiss: Tone { hump_hz: 3500.0, level_db: 6.0 },
    body: Tone { hump_hz: 130.0, level_db: -2.0 },
};

/// Grass and leaves: many tiny cells, all high.
const GRASS: Properties = Properties {
    bursts: Bursts { per_second: 18.0, size: 2.5, gap_s: 0.006 },
    rupture: Rupture {
        median_db: -32.0,
        deviation_db: 8.0,
        click_s: [0.0002, 0.0008],
        click_hz: [6000.0, 15_000.0],
        ring_hz: [2500.0, 6000.0],
        ring_s: [0.0005, 0.0015],
        ring_db: -12.0,
    },
    hiss: Tone { hump_hz: 7000.0, level_db: 3.0 },
    body: Tone { hump_hz: 260.0, level_db: 0.0 },
};

/// Paper: crinkling of thin sheets, in long bursts as they curl.
const PAPER: Properties = Properties {
    bursts: Bursts { per_second: 8.0, size: 3.0, gap_s: 0.009 },
    rupture: Rupture {
        median_db: -32.0,
        deviation_db: 9.0,
        click_s: [0.0002, 0.0012],
        click_hz: [3000.0, 12_000.0],
        ring_hz: [1200.0, 3500.0],
        ring_s: [0.0008, 0.0025],
        ring_db: -9.0,
    },
    hiss: Tone { hump_hz: 6000.0, level_db: -6.0 },
    body: Tone { hump_hz: 220.0, level_db: -3.0 },
};

/// Coal and embers: rare ticks of brittle, hard pieces over a low glow.
const COAL: Properties = Properties {
    bursts: Bursts { per_second: 1.2, size: 2.2, gap_s: 0.020 },
    rupture: Rupture {
        median_db: -29.0,
        deviation_db: 8.0,
        click_s: [0.0002, 0.0009],
        click_hz: [4000.0, 12_000.0],
        ring_hz: [1800.0, 4500.0],
        ring_s: [0.0015, 0.005],
        ring_db: -4.0,
    },
    hiss: Tone { hump_hz: 5500.0, level_db: -3.0 },
    body: Tone { hump_hz: 90.0, level_db: -6.0 },
};

/// The fuels that burn, in the order of [`Fuel::burning_index`].
pub(super) const BURNING: [&Properties; 5] = [&DRY_WOOD, &WET_WOOD, &GRASS, &PAPER, &COAL];

const _: () = assert!(BURNING.len() + 1 == Fuel::ALL.len(), "each fuel needs its properties");

/// Tones of hiss and body.
pub(super) fn tones(fuel: Fuel) -> [&'static Tone; 2] {
    match fuel.burning_index().and_then(|place| BURNING.get(place)) {
        Some(properties) => [&properties.hiss, &properties.body],
        None => [&NEUTRAL[0], &NEUTRAL[1]],
    }
}
