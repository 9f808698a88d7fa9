//! Orders: the latest wins, the old sound stays, cancelling.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use pyrophone_settings::session::Cut;

use super::{Instance, RATE_HZ, Sounds};

#[test]
fn the_latest_request_wins() {
    let (sounds, mut instance) = (Sounds::new(), Instance::running());
    for index in 0..6 {
        instance.load(&sounds.wav(&format!("long{index}.wav"), 4.0, 10 + index));
    }
    let last = sounds.wav("last.wav", 0.5, 3);
    instance.load_and_wait(&last);
    instance.activate(RATE_HZ);
    let dictionary = instance.dictionary().unwrap().unwrap();
    assert!((dictionary.windows().seconds() - 0.5).abs() < 1e-3, "{} s", dictionary.windows().seconds());
    assert_eq!(instance.saved().recording.unwrap().path, last.to_string_lossy());
    std::thread::sleep(Duration::from_millis(300));
    assert!(instance.dictionary().is_none(), "nothing arrives after the last one");
}

#[test]
fn a_failed_load_leaves_the_old_sound_and_says_why() {
    let (sounds, mut instance) = (Sounds::new(), Instance::running());
    let good = sounds.wav("good.wav", 0.5, 1);
    instance.load_and_wait(&good);
    instance.activate(RATE_HZ);
    assert!(instance.dictionary().unwrap().is_some());
    let saved = instance.saved();
    let text = sounds.0.path().join("text.wav");
    std::fs::write(&text, "not a sound at all").unwrap();
    for (path, part) in [
        (sounds.0.path().join("none.wav"), "no such file"),
        (sounds.0.path().to_owned(), "folder"),
        (text, "not a sound file"),
        (sounds.wav("short.wav", 0.0005, 1), "short"),
    ] {
        instance.load(&path);
        instance.wait_for(part, |view| view.error.as_ref().is_some_and(|error| error.contains(part)));
        assert!(instance.dictionary().is_none(), "{}: the old one stays", path.display());
        assert_eq!(instance.saved(), saved);
        assert!(instance.view().recording.unwrap().starts_with("good.wav"));
    }
    instance.load_and_wait(&sounds.wav("better.wav", 0.5, 2));
    assert_eq!(instance.view().error, None, "the message goes when something goes right");
}

#[test]
fn dropping_calls_off_the_work() {
    let sounds = Sounds::new();
    let long = sounds.wav("long.wav", 60.0, 5);
    let instance = Instance::running();
    instance.load(&long);
    instance.wait_for("progress", |view| view.progress.is_some());
    // Joins the thread: it has ended when this returns.
    drop(instance);
}

#[test]
fn cancelled_work_leaves_the_previous_sound() {
    let sounds = Sounds::new();
    let mut instance = Instance::running();
    instance.load_and_wait(&sounds.wav("short.wav", 0.5, 81));
    instance.activate(RATE_HZ);
    let old = instance.dictionary().unwrap().unwrap();
    let long = sounds.wav("endless.wav", 120.0, 82);
    let loader = instance.loader.handle();
    loader.load(long);
    instance.wait_for("progress", |view| view.progress.is_some());
    loader.cancel();
    instance.wait_for("a message", |view| {
        view.progress.is_none() && view.error.as_ref().is_some_and(|error| error.contains("endless.wav"))
    });
    assert!(instance.view().recording.unwrap().starts_with("short.wav"));
    assert!(instance.saved().recording.unwrap().path.ends_with("short.wav"));
    instance.activate(RATE_HZ);
    assert!(Arc::ptr_eq(&instance.dictionary().unwrap().unwrap(), &old));
    loader.cancel();
    instance.activate(RATE_HZ);
    assert!(instance.view().recording.unwrap().starts_with("short.wav"), "there was nothing left to cancel");
}

#[test]
fn a_recording_is_drawn_for_a_window_alone() {
    let sounds = Sounds::new();
    let instance = Instance::running();
    instance.load_and_wait(&sounds.wav("long.wav", 2.0, 53));
    instance.activate(RATE_HZ);
    assert_eq!(instance.view().overview, None, "nobody looks");
    let handle = instance.loader.handle();
    handle.shared.is_watched.store(true, Ordering::Relaxed);
    let drawn = instance.wait_for("a picture", |view| view.overview.is_some());
    assert_eq!(drawn.overview.unwrap().start_s, 0.0);
    let cut = Cut { region_s: Some([0.5, 1.25]), gain_db: 0.0, normalise: false };
    handle.set_cut(cut);
    instance.wait_for("a picture of the part", |view| view.overview.as_ref().is_some_and(|drawn| drawn.start_s == 0.5));
    handle.shared.is_watched.store(false, Ordering::Relaxed);
    instance.load_and_wait(&sounds.wav("other.wav", 0.5, 54));
    instance.activate(RATE_HZ);
    assert_eq!(instance.view().overview, None, "another recording's picture is not shown for this one");
}

#[test]
fn a_recording_is_there_to_be_listened_to_as_long_as_that_is_wanted() {
    let sounds = Sounds::new();
    let mut instance = Instance::running();
    let loader = instance.loader.handle();
    instance.load_and_wait(&sounds.wav("tape.wav", 1.0, 61));
    instance.activate(RATE_HZ);
    assert!(instance.clip().flatten().is_none(), "nobody has asked for it");
    loader.audition(true);
    instance.wait_for("a clip", |view| view.has_clip);
    let clip = instance.clip().unwrap().unwrap();
    assert_eq!((clip.len(), clip[0].len()), (1, 44_100));
    loader.set_cut(Cut { region_s: Some([0.0, 0.5]), ..Cut::default() });
    instance.activate(RATE_HZ);
    assert_eq!(instance.clip().unwrap().unwrap()[0].len(), 22_050);
    instance.activate(2.0 * RATE_HZ);
    assert_eq!(instance.clip().unwrap().unwrap()[0].len(), 44_100, "at the engine's rate");
    loader.audition(false);
    instance.wait_for("no clip", |view| !view.has_clip);
    assert!(instance.clip().unwrap().is_none());
}
