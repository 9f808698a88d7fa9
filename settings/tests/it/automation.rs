//! Automation files: their rows, and what is wrong with bad ones.

use pyrophone_settings::automation::Event;
use pyrophone_settings::{Automation, Error, Id};

#[test]
fn seconds_and_samples_become_events() {
    let text = "time_s,id,value\r\n# a comment\r\n0,alpha,2\r\n0.5, alpha , 3.0\r\n0.5,texture_level,-6 dB\r\n\r\n1,dynamic_range,off\r\n";
    let event = |sample, id, value| Event { sample, parameter: id as usize, value };
    let expected = vec![
        event(0, Id::Alpha, 2.0),
        event(24_000, Id::Alpha, 3.0),
        event(24_000, Id::TextureLevel, -6.0),
        event(48_000, Id::DynamicRange, 0.0),
    ];
    assert_eq!(Automation::from_csv(text).unwrap().events(48_000.0), expected);

    let samples = Automation::from_csv("\u{feff}sample,id,value\n7,alpha,2\n7,alpha,3\n9,bypass,on").unwrap();
    let at: Vec<(u64, f64)> = samples.events(44_100.0).iter().map(|event| (event.sample, event.value)).collect();
    assert_eq!(at, [(7, 2.0), (7, 3.0), (9, 1.0)]);
}

#[test]
fn header_alone_is_empty() {
    assert!(Automation::from_csv("sample,id,value\n").unwrap().is_empty());
}

#[test]
fn bad_files_say_where_and_why() {
    for text in ["", "alpha,2\n", "time,id,value\n", "time_s,id\n"] {
        assert!(matches!(Automation::from_csv(text), Err(Error::AutomationHeader { .. })), "{text:?}");
    }
    for row in ["1,alpha", "1,alpha,2,3", "x,alpha,2", "-1,alpha,2", "nan,alpha,2", "inf,alpha,2", "1e9,alpha,2"] {
        let error = Automation::from_csv(&format!("time_s,id,value\n0,alpha,1\n{row}\n")).unwrap_err();
        assert!(matches!(error, Error::AutomationRow { line: 3, .. }), "{row}: {error}");
    }
    for row in ["1.5,alpha,2", "-1,alpha,2", "99999999999999999999,alpha,2"] {
        let error = Automation::from_csv(&format!("sample,id,value\n{row}\n")).unwrap_err();
        assert!(matches!(error, Error::AutomationRow { line: 2, .. }), "{row}: {error}");
    }
    for row in ["1,alpah,2", "1,alpha,9", "1,alpha,much", "1,levels,5"] {
        let error = Automation::from_csv(&format!("time_s,id,value\n{row}\n")).unwrap_err();
        assert!(matches!(error, Error::AutomationValue { line: 2, .. }), "{row}: {error}");
    }
    let unsorted = Automation::from_csv("sample,id,value\n9,alpha,2\n10,alpha,2\n8,alpha,3\n").unwrap_err();
    assert!(matches!(unsorted, Error::AutomationOrder { line: 4, .. }), "{unsorted}");
}

#[test]
fn linear_ramp_goes_from_row_to_row_in_even_steps() {
    let text = "sample,id,value,curve\n0,alpha,1,linear\n48,cutoff,200,step\n4800,alpha,1.5,\n9600,alpha,3\n";
    let events = Automation::from_csv(text).unwrap().events(48_000.0);
    let alphas: Vec<&Event> = events.iter().filter(|event| event.parameter == Id::Alpha as usize).collect();
    // A tenth of a second are a hundred steps.
    assert_eq!(alphas.len(), 100 + 2, "{alphas:?}");
    for (step, event) in alphas[..=100].iter().enumerate() {
        assert_eq!(event.sample, 48 * step as u64);
        assert!((event.value - (1.0 + 0.005 * step as f64)).abs() < 1e-12, "{event:?}");
    }
    assert_eq!((alphas[101].sample, alphas[101].value), (9600, 3.0), "held, then a step");
    assert!(events.is_sorted_by_key(|event| event.sample));
}

#[test]
fn steps_of_a_ramp_are_a_millisecond_at_least() {
    let text = "time_s,id,value,curve\n0,texture_level,-72,linear\n0.1,texture_level,24,linear\n";
    for rate_hz in [44_100.0, 192_000.0] {
        let events = Automation::from_csv(text).unwrap().events(rate_hz);
        assert_eq!(events.len(), 101, "the last row holds");
        let apart = events.windows(2).map(|pair| pair[1].sample - pair[0].sample);
        assert!(apart.min() >= Some((0.001 * rate_hz) as u64), "at {rate_hz} Hz");
    }
}

#[test]
fn ramps_over_any_time_are_bounded() {
    let text = "sample,id,value,curve\n0,alpha,0,linear\n18446744073709551615,alpha,6\n";
    let events = Automation::from_csv(text).unwrap().events(48_000.0);
    assert_eq!(events.len(), 6001, "thousandths are the last decimal of alpha");
    assert_eq!(events[3000].sample, u64::MAX / 2);
    let at_once = "sample,id,value,curve\n5,alpha,0,linear\n5,alpha,6,linear\n5,alpha,1,linear\n";
    assert_eq!(Automation::from_csv(at_once).unwrap().events(48_000.0).len(), 3, "no time, no ramp");
}

#[test]
fn semicolons_and_decimal_commas_are_read() {
    let text = "time_s;id;value;curve\n0,5;alpha;2,5;linear\n1;alpha;3.5\n1;texture_level;-6,5 dB\n2;drive_mode;input envelope;step\n";
    let same =
        "time_s,id,value,curve\n0.5,alpha,2.5,linear\n1,alpha,3.5\n1,texture_level,-6.5\n2,drive_mode,input envelope\n";
    assert_eq!(Automation::from_csv(text).unwrap(), Automation::from_csv(same).unwrap());
    let without_curve = Automation::from_csv("# from a spreadsheet\nsample;id;value\n7;alpha;2,5\n").unwrap();
    assert_eq!(without_curve.events(1.0), [Event { sample: 7, parameter: Id::Alpha as usize, value: 2.5 }]);
}

#[test]
fn bad_curves_say_what_is_allowed() {
    for (row, says) in [
        ("1,alpha,2,cubic", "`step` or `linear`"),
        ("1,drive_mode,flux,linear", "must be `step`"),
        ("1,gate,on,linear", "must be `step`"),
        ("1,alpha,2,linear,3", "5 fields"),
    ] {
        let error = Automation::from_csv(&format!("time_s,id,value,curve\n0,alpha,1\n{row}\n")).unwrap_err();
        assert!(
            matches!(&error, Error::AutomationRow { line: 3, message } if message.contains(says)),
            "{row}: {error}"
        );
    }
}
