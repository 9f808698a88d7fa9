//! Texture synthesis against the reference's outputs: zero samples differ.

use std::sync::Arc;

use pyrophone_synthesis::texture::{Dictionary, PyramidConfig, offline};

struct Case {
    name: &'static str,
    pair: &'static str,
    input: Option<std::ops::Range<usize>>,
    training: Option<std::ops::Range<usize>>,
    shape: PyramidConfig,
    options: offline::Options,
}

fn cases() -> Vec<Case> {
    let whole = |name| Case {
        name,
        pair: name,
        input: None,
        training: None,
        shape: PyramidConfig::default(),
        options: offline::Options::default(),
    };
    let excerpt = |name, shape, options| Case {
        name,
        pair: "burning_brick",
        input: Some(60_000..120_000),
        training: Some(100_000..220_000),
        shape,
        options,
    };
    let options = |dynamic_range, scaling_alpha| offline::Options { dynamic_range, scaling_alpha, eps: 0.0 };
    vec![
        whole("burning_brick"),
        whole("dragon"),
        whole("torch"),
        excerpt("variant_a", PyramidConfig { levels: 5, window: 6, feature: 2, falloff: 0.1 }, options(false, 1.0)),
        excerpt("variant_b", PyramidConfig { levels: 7, window: 3, feature: 4, falloff: 0.0 }, options(true, 0.4)),
    ]
}

#[test]
fn every_golden_is_reproduced_to_the_sample() {
    let Some(folder) = crate::common::reference_dir() else { return };
    for case in cases() {
        let cut = |name: &str, range: &Option<std::ops::Range<usize>>| {
            let (channels, _) = crate::common::read_wav(&folder.join(name).join(format!("{}.wav", case.pair)));
            range.clone().map_or(channels[0].clone(), |range| channels[0][range].to_vec())
        };
        let (input, training) = (cut("signals", &case.input), cut("training", &case.training));
        let dictionary = Dictionary::new(&[training], 44_100.0, &case.shape, &|_| true).unwrap();
        let output = offline::synthesize(&input, &Arc::new(dictionary), &case.options, &|_| true).unwrap();
        let golden = crate::common::read_f64(&folder.join(format!("texture/{}.f64", case.name)));
        assert_eq!(output[0].len(), golden.len(), "{}", case.name);
        let differing = output[0].iter().zip(&golden).filter(|(a, b)| **a as f32 != **b as f32).count();
        println!("{}: {differing} of {} samples differ", case.name, golden.len());
        assert_eq!(differing, 0, "{}: samples that differ", case.name);
    }
}
