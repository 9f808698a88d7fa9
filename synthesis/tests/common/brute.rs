//! Texture synthesis as Chadwick & James 2011, §5, state it, with nothing clever:
//! every window is compared with every entry.
#![allow(dead_code)]

/// Settings of a run.
#[derive(Debug, Clone, Copy)]
pub struct Settings {
    pub levels: usize,
    pub window: usize,
    pub feature: usize,
    pub falloff: f64,
    pub dynamic_range: bool,
    pub scaling_alpha: f64,
}

struct Padded {
    levels: Vec<Vec<f64>>,
    start: Vec<usize>,
    end: Vec<usize>,
}

fn pad(x: &[f64], levels: usize, mirror: bool) -> Padded {
    let n = x.len();
    let mut e = 2;
    while e + 1 < n {
        e *= 2;
    }
    e += 1;
    let (start, end) = ((e - n) / 2, (e - n) / 2 + n);
    let mut out = vec![0.0; e];
    out[start..end].copy_from_slice(x);
    if mirror {
        for i in 0..start {
            if start - i < n {
                out[i] = x[start - i];
            }
        }
        for i in end..e {
            out[i] = out[2 * end - i - 2];
        }
    }
    let mut padded = Padded { levels: vec![out], start: vec![start], end: vec![end] };
    for l in 1..levels {
        let finer = &padded.levels[l - 1];
        let size = (finer.len() - 1) / 2 + 1;
        let taps = [0.05, 0.25, 0.40, 0.25, 0.05];
        let coarser = (0..size as i64).map(|i| {
            (0..5)
                .filter(|t| (0..finer.len() as i64).contains(&(2 * i + t - 2)))
                .fold(0.0, |sum, t| sum + taps[t as usize] * finer[(2 * i + t - 2) as usize])
        });
        padded.levels.push(coarser.collect());
        padded.start.push(padded.start[l - 1].div_ceil(2));
        padded.end.push(padded.end[l - 1].div_ceil(2));
    }
    padded
}

fn feature(fine: &[f64], coarse: &[f64], window: usize, s: &Settings) -> Vec<f64> {
    let (w, c) = (s.window as i64, (window * s.window) as i64);
    let reach = w * (s.feature as i64 + 1);
    let at = |x: &[f64], i: i64| if i >= 0 && (i as usize) < x.len() { x[i as usize] } else { 0.0 };
    let mut out = Vec::new();
    for i in c - reach..=c - w {
        out.push(at(fine, i) * (-s.falloff * (c - i).abs() as f64).exp());
    }
    for i in 0..=2 * reach {
        let position = c as f64 / 2.0 - reach as f64 + i as f64;
        let (below, part) = (position.floor() as i64, position - position.floor());
        let x = at(coarse, below) * (1.0 - part) + at(coarse, below + 1) * part;
        out.push(x * (-s.falloff * (i - reach).abs() as f64).exp());
    }
    out
}

fn entries(training: &Padded, l: usize, s: &Settings) -> Vec<usize> {
    let (w, reach) = (s.window as i64, (s.window * (s.feature + 1)) as i64);
    let (start, end) = (training.start[l] as i64, training.end[l] as i64);
    let fits = |window: &usize| {
        let c = (*window as i64) * w;
        let causal = (c - reach..=c - w).all(|i| start <= i && i < end);
        let coarse = |i: i64| i >= 0 && i < training.levels[l + 1].len() as i64;
        causal && coarse(c.div_euclid(2) - reach) && coarse(c.div_euclid(2) + reach + 1)
    };
    (0..=training.levels[l].len() / s.window).filter(fits).collect()
}

fn sorted_top(padded: &Padded) -> Vec<f64> {
    let top = padded.levels.len() - 1;
    let mut values: Vec<f64> = padded.levels[top][padded.start[top]..padded.end[top]].iter().map(|x| x.abs()).collect();
    values.sort_by(f64::total_cmp);
    values
}

fn cdf(sorted: &[f64], q: f64) -> f64 {
    let at = q * (sorted.len() - 1) as f64;
    let i = at.floor() as usize;
    let next = (i + 1).min(sorted.len() - 1);
    sorted[i] * (1.0 - (at - i as f64)) + sorted[next] * (at - i as f64)
}

fn inverse(sorted: &[f64], a: f64) -> f64 {
    if a < sorted[0] {
        return 0.0;
    }
    if a >= sorted[sorted.len() - 1] {
        return 1.0;
    }
    let i = (0..sorted.len() - 1).find(|i| sorted[*i] <= a && a < sorted[i + 1]).unwrap();
    (i as f64 + (a - sorted[i]) / (sorted[i + 1] - sorted[i])) / (sorted.len() - 1) as f64
}

/// A window to be matched.
pub struct Match<'a> {
    pub level: usize,
    /// Window numbers of the level's entries.
    pub entries: &'a [usize],
    pub query: &'a [f64],
}

/// The output of texture synthesis, as long as `input`.
pub fn synthesize(input: &[f64], training: &[f64], s: &Settings) -> Vec<f64> {
    let padded = pad(training, s.levels, true);
    let mut features: (usize, Vec<Vec<f64>>) = (usize::MAX, Vec::new());
    synthesize_by(input, training, s, |Match { level, entries, query }| {
        if features.0 != level {
            let of = |w: &usize| feature(&padded.levels[level], &padded.levels[level + 1], *w, s);
            features = (level, entries.iter().map(of).collect());
        }
        let mut best = (f64::INFINITY, 0);
        for (entry, candidate) in features.1.iter().enumerate() {
            let mut sum = 0.0;
            for (x, q) in candidate.iter().zip(query) {
                sum += (x - q) * (x - q);
                if sum >= best.0 {
                    break;
                }
            }
            if sum < best.0 {
                best = (sum, entry);
            }
        }
        entries[best.1]
    })
}

/// The same with windows matched by `nearest`, which answers window numbers.
pub fn synthesize_by(
    input: &[f64],
    training: &[f64],
    s: &Settings,
    mut nearest: impl FnMut(Match<'_>) -> usize,
) -> Vec<f64> {
    let mut output = pad(input, s.levels, false);
    let training = pad(training, s.levels, true);
    let (cdf_input, cdf_training) = (sorted_top(&output), sorted_top(&training));
    for l in 0..s.levels - 1 {
        output.levels[l].fill(0.0);
    }
    for l in (0..s.levels - 1).rev() {
        let windows = entries(&training, l, s);
        if windows.is_empty() {
            continue;
        }
        for window in 0..=output.levels[l].len() / s.window {
            let mut query = feature(&output.levels[l], &output.levels[l + 1], window, s);
            let mut scale = 1.0;
            if s.dynamic_range && l + 2 == s.levels {
                let coarse = &mut query[s.window * s.feature + 1..];
                let m = coarse.iter().fold(0.0, |sum, x| sum + x.abs()) / coarse.len() as f64;
                if m > 1e-4 {
                    let r = cdf(&cdf_training, inverse(&cdf_input, m)) / m;
                    let factor = (1.0 - s.scaling_alpha) + s.scaling_alpha * r;
                    if factor != 0.0 && factor.is_finite() {
                        coarse.iter_mut().for_each(|x| *x *= factor);
                        scale = 1.0 / factor;
                    }
                }
            }
            let matched = nearest(Match { level: l, entries: &windows, query: &query });
            let (from, to) = (matched as i64 - 1, window as i64 - 1);
            let w = s.window as i64;
            for i in 0..=2 * w {
                let (from, to) = (from * w + i, to * w + i);
                if from >= 0
                    && (from as usize) < training.levels[l].len()
                    && to >= 0
                    && (to as usize) < output.levels[l].len()
                {
                    let factor = (w - (w - i).abs()) as f64 * (1.0 / w as f64) * scale;
                    output.levels[l][to as usize] += factor * training.levels[l][from as usize];
                }
            }
        }
    }
    output.levels[0][output.start[0]..output.end[0]].to_vec()
}
