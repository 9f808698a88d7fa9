//! The paper's texture synthesis, played through the real bundles: zero samples differ.

use pyrophone_host::Format;
use pyrophone_host::bounce::{BlockSize, BounceOptions};
use pyrophone_synthesis::texture::shape::Padding;
use pyrophone_tests::{MONO, RATE_HZ, differing, learned, load_session, open, play, preset, reference, session};

#[test]
fn dragon_through_both_formats_is_the_golden_output() {
    let Some(folder) = reference::reference_dir() else { return };
    let (input, _) = reference::read_wav(&folder.join("signals/dragon.wav"));
    let input: Vec<f32> = input[0].iter().map(|x| *x as f32).collect();
    let golden: Vec<f32> = reference::read_f64(&folder.join("texture/dragon.f64")).iter().map(|x| *x as f32).collect();
    let values = preset("texture-paper", &[]);
    let learned = learned(&values, std::slice::from_ref(&input), RATE_HZ);
    let session = session(Some(&folder.join("training/dragon.wav")), Some(learned));
    let padding = Padding::new(input.len(), 6, "input").expect("long enough");
    for format in Format::ALL {
        for block in [BlockSize::Fixed(64), BlockSize::Random { seed: 3, max: 2000 }] {
            let mut plugin = open(format);
            load_session(plugin.as_mut(), &values, &session);
            let options = BounceOptions {
                block: block.clone(),
                pad_before: padding.start[0],
                extra_after: padding.size[0] - padding.end[0],
                ..BounceOptions::new(RATE_HZ, MONO)
            };
            let output = play(plugin.as_mut(), std::slice::from_ref(&input), &options);
            let found = differing(&output[0][..input.len()], &golden);
            println!("{format}, {block:?}: {found} of {} samples differ", golden.len());
            assert_eq!(found, 0, "{format}, {block:?}");
        }
    }
}
