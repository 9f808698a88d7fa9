//! Rendering of a hop: it is decided, its sources are summed a few at a time, and it is prepared for output.

use super::acoustics::SPEED_OF_SOUND_M_S;
use super::bank::Bank;
use super::hop::Hop;
use super::layout::MOST_CHANNELS;
use super::level::Blend;
use super::motion::Motion;
use super::read::{Gain, Part};
use super::renderer::Vortex;
use super::source::{Edge, Identity, VortexSource};
use crate::controls::{Flow, VortexControls};
use crate::error::within;

/// Largest speed, as a share of the speed of sound, with which a source's distance follows a jump.
const FASTEST: f64 = 0.5;

/// Inputs of the summation of a source.
struct Summing<'a> {
    hop: Hop,
    bank: &'a Bank,
    motion: Motion<'a>,
}

impl Vortex {
    /// Starts to sound with the hop at `start`.
    pub(super) fn start(&mut self, start: i64, controls: &VortexControls) {
        self.state.is_fresh = false;
        self.state.is_exchanged = false;
        self.moving.jump(controls);
        // The start is mid-stream: the previous hop is heard during this one, and the one before that is the filter's
        // past.
        for (back, is_fresh) in [(2, true), (1, false)] {
            self.decide(start - back * self.sizes.hop as i64, controls, is_fresh);
            self.sum_rest();
            self.finish();
        }
        self.begin(start, controls);
    }

    /// Begins the hop at `start`.
    pub(super) fn begin(&mut self, start: i64, controls: &VortexControls) {
        if std::mem::take(&mut self.state.is_exchanged) {
            self.sources.iter_mut().for_each(|source| source.presence = 0.0);
            self.declick.begin(&self.output.pressures);
        }
        self.decide(start, controls, false);
        if let Some(live) = &mut self.live {
            if controls.flow == Flow::Live { live.advance(self.present.speed_m_s) } else { live.stop() }
        }
    }

    /// Decides the sound of the hop at `start`.
    fn decide(&mut self, start: i64, controls: &VortexControls, is_fresh: bool) {
        self.state.flow = controls.flow;
        let identity = Identity { seed: controls.seed, flow: controls.flow };
        let before = self.moving.now();
        let frame = self.moving.next(controls);
        let speed_m_s = frame.speed_m_s * maths::pow(self.follower.now, frame.curve);
        let ends = [start, start + self.sizes.hop as i64];
        let offset_s = within(controls.field_offset_s, -3600.0, 3600.0);
        let time_s = |at: i64| at as f64 / self.sizes.sample_rate_hz + offset_s;
        let moments = self.field.as_deref().map(|field| ends.map(|at| field.moment(time_s(at))));
        let wanted = match controls.flow {
            Flow::Envelope => controls.count,
            Flow::Field => self.field.as_ref().map_or(0, |field| field.sources()),
            Flow::Live => self.live.as_ref().map_or(0, |live| live.sources()),
        };
        let wanted = wanted.min(self.sources.len());
        if is_fresh {
            for (index, source) in self.sources.iter_mut().enumerate() {
                *source = VortexSource::new(index, identity);
                source.presence = f32::from(u8::from(index < wanted));
            }
        }
        let sounding = self.sources.iter().rposition(|source| source.presence > 0.0).map_or(0, |last| last + 1);
        let reference = |bank: &Bank| bank.levels().ln_gain(frame.ln_reference as f32);
        self.present = Hop {
            start,
            before,
            pose: frame.pose.pose(),
            identity,
            moments,
            wanted,
            speed_m_s,
            ln_speed: if self.follower.now > 0.0 { maths::ln(speed_m_s) as f32 } else { f32::NEG_INFINITY },
            ln_reference: self.bank.as_deref().map_or(0.0, reference),
            stays: frame.pose == before.pose && !is_fresh,
            is_fresh,
            sources: wanted.max(sounding),
            summed: 0,
            frame,
        };
        self.output.clear();
    }

    /// Sums the remaining sources of the hop.
    pub(super) fn sum_rest(&mut self) {
        self.sum(self.present.sources);
    }

    /// Sums the hop's sources up to number `until`.
    pub(super) fn sum(&mut self, until: usize) {
        let hop = self.present;
        let range = hop.summed..until.min(hop.sources);
        if range.is_empty() {
            return;
        }
        self.present.summed = range.end;
        // Moved out of `self` while other fields change; nothing is allocated.
        let (field, live, bank) = (self.field.take(), self.live.take(), self.bank.take());
        let mut sources = std::mem::take(&mut self.sources);
        let motion = Motion { field: field.as_deref().zip(hop.moments), live: live.as_ref() };
        let bank_here = bank.as_deref().filter(|bank| bank.sample_rate_hz() == self.sizes.sample_rate_hz);
        let summing = bank_here.map(|bank| Summing { hop, bank, motion });
        let number = hop.start.div_euclid(self.sizes.hop as i64);
        for (index, source) in sources[range.clone()].iter_mut().enumerate() {
            let index = range.start + index;
            let present = source.turn(index, number, index < hop.wanted, hop.identity);
            if let Some(summing) = summing.as_ref().filter(|_| present > 0.0 || source.presence > 0.0) {
                self.sum_source(summing, index, source, present);
            }
        }
        self.sources = sources;
        (self.field, self.live, self.bank) = (field, live, bank);
    }

    /// Adds one source, whose presence was `present` at the hop's start.
    fn sum_source(&mut self, summing: &Summing<'_>, index: usize, source: &mut VortexSource, present: f32) {
        let Summing { hop, bank, .. } = summing;
        source.vary(hop.frame.variation as f32);
        if hop.is_fresh {
            source.edge = self.edge(summing, false, index, source, false);
        }
        let was_heard = present > 0.0 && source.edge.gains.iter().any(|gain| *gain != 0.0);
        let end = self.edge(summing, true, index, source, was_heard);
        // A source that was not heard may have been anywhere.
        let start = if was_heard { source.edge } else { Edge { gains: [0.0; MOST_CHANNELS], ..end } };
        source.edge = end;

        let mut rows = [(0, 0.0, 0.0); 4];
        let mut count = 0;
        for (row, weight) in start.blend.rows() {
            rows[count] = (row, weight, 0.0);
            count += 1;
        }
        for (row, weight) in end.blend.rows() {
            match rows[..count].iter_mut().find(|(known, ..)| *known == row) {
                Some((_, _, to)) => *to = weight,
                None => {
                    rows[count] = (row, 0.0, weight);
                    count += 1;
                }
            }
        }
        let mut gains = [Gain { channel: 0, from: 0.0, to: 0.0 }; MOST_CHANNELS];
        let mut audible = 0;
        for (channel, (from, to)) in start.gains.iter().zip(end.gains).take(self.sizes.channels).enumerate() {
            let gain = Gain { channel, from: present * from, to: source.presence * to };
            if gain.from != 0.0 || gain.to != 0.0 {
                gains[audible] = gain;
                audible += 1;
            }
        }
        if count == 0 || audible == 0 {
            return;
        }

        let period = bank.period() as f64;
        let rate_hz = source.pace * bank.rate_hz();
        let steps_per_m = rate_hz / SPEED_OF_SOUND_M_S;
        let turns = hop.start as f64 * (rate_hz / self.sizes.sample_rate_hz);
        let begun = turns - period * (turns / period).floor();
        let at = begun + source.offset * period - start.distance_m * steps_per_m;
        let at = at - period * (at / period).floor();
        // Rounding may reach the period itself.
        let first = (at as usize).min(bank.period() - 1);
        let nearer = (start.distance_m - end.distance_m) / self.sizes.hop as f64;
        let step = self.sizes.factor as f64 * (rate_hz / self.sizes.sample_rate_hz + nearer * steps_per_m);
        let mut parts = [Part { series: &[], from: 0.0, change: 0.0 }; 4];
        for (part, (row, from, to)) in parts.iter_mut().zip(&rows[..count]) {
            let (scale, series) = bank.series(*row, source.direction, first);
            *part = Part { series, from: scale * from, change: scale * (to - from) };
        }
        let phase = (at - first as f64).max(0.0) as f32;
        self.reader.process(&parts[..count], phase, step as f32, &gains[..audible], &mut self.output.pressures);
    }

    /// Sound of a source at the start of the hop, or at its `end`; `was_heard` is true if its edge is its previous sound.
    fn edge(&self, summing: &Summing<'_>, end: bool, index: usize, source: &VortexSource, was_heard: bool) -> Edge {
        let Summing { hop, bank, motion } = summing;
        let pose = &hop.pose;
        let edge = &source.edge;
        let (position, ln_speed, presence) = if source.identity.flow == Flow::Envelope {
            (None, hop.ln_speed + source.ln_deviation, 1.0)
        } else if let Some(state) = motion.state_at(source.identity.flow, index, end) {
            let speed_m_s = (hop.frame.field_speed * state.speed_m_s) as f32;
            (Some(pose.position_of(state.position)), maths::ln(speed_m_s), state.presence)
        } else {
            return Edge { distance_m: edge.distance_m, ..Edge::default() };
        };
        let blend = bank.levels().blend_at(edge.blend.row, ln_speed, hop.frame.range as f32, hop.ln_reference);
        let moves = position.is_some_and(|position| position != edge.position) || presence != edge.motion_presence;
        if was_heard && edge.settled && hop.stays && !moves {
            return Edge { blend, ..*edge };
        }
        let position = position.unwrap_or_else(|| pose.in_ball(source.ball));
        let distance_m = position.iter().map(|x| x * x).sum::<f64>().sqrt();
        let level = (presence * pose.attenuation(distance_m)) as f32;
        let gains = self.panner.gains(position).map(|gain| level * gain);
        // A distance that jumps is traversed gradually, because the time at which a source is heard must advance.
        let walk = FASTEST * SPEED_OF_SOUND_M_S * self.sizes.hop as f64 / self.sizes.sample_rate_hz;
        let delayed_m =
            if was_heard { edge.distance_m + (distance_m - edge.distance_m).clamp(-walk, walk) } else { distance_m };
        let settled = delayed_m == distance_m;
        Edge { blend, gains, position, motion_presence: presence, distance_m: delayed_m, settled }
    }

    /// Converts the hop's pressures to output, with the remains of an exchange.
    pub(super) fn finish(&mut self) {
        self.declick.add(&mut self.output.pressures);
        self.output.finish(&self.present.before, &self.present.frame);
    }
}

impl Blend {
    /// The rows that sound, with their amplitudes.
    fn rows(self) -> impl Iterator<Item = (usize, f32)> {
        (self.row..).zip(self.weights).filter(|(_, weight)| *weight > 0.0)
    }
}
