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
