use std::collections::HashMap;
use std::path::Path;
use std::time::Duration;

/// The window's map of its widgets, written with every frame; see `editor::map` of the plug-in.
#[derive(Debug, Clone, Default)]
pub struct Map {
    /// Frames since it was opened.
    pub frames: u64,
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// Processor time that laying out and drawing all these frames have taken.
    pub spent: Duration,
    /// The part of it that analysing the sound has taken.
    pub analysing: Duration,
    /// Left, top, right and bottom of all that can be seen, by name.
    pub things: HashMap<String, [i16; 4]>,
}

impl Map {
    /// Reads a map, if there is one.
    pub(super) fn read(path: &Path) -> Option<Self> {
        let text = std::fs::read_to_string(path).ok()?;
        let map = Self::parse(&text);
        assert!(map.is_some(), "not a map: {text}");
        map
    }

    fn parse(text: &str) -> Option<Self> {
        let mut lines = text.lines();
        let frames = lines.next()?.strip_prefix("frame ")?.parse().ok()?;
        let (width, height) = lines.next()?.strip_prefix("size ")?.split_once(' ')?;
        let size = (width.parse().ok()?, height.parse().ok()?);
        let spent = Duration::from_micros(lines.next()?.strip_prefix("ui_us ")?.parse().ok()?);
        let analysing = Duration::from_micros(lines.next()?.strip_prefix("analysis_us ")?.parse().ok()?);
        let things = lines.map(thing).collect::<Option<_>>()?;
        Some(Self { frames, size, spent, analysing, things })
    }

    /// The middle of something, if it can be seen.
    pub fn middle(&self, name: &str) -> Option<(i16, i16)> {
        let [left, top, right, bottom] = *self.things.get(name)?;
        Some((left + (right - left) / 2, top + (bottom - top) / 2))
    }
}

fn thing(line: &str) -> Option<(String, [i16; 4])> {
    let mut words = line.splitn(5, ' ');
    let mut edge = || words.next()?.parse().ok();
    let edges = [edge()?, edge()?, edge()?, edge()?];
    Some((words.next()?.to_owned(), edges))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_what_windows_write() {
        let text = "frame 7\nsize 1060 760\nui_us 1500\nanalysis_us 400\n10 20 30 41 handle.blend low\n0 0 5 5 a\n";
        let map = Map::parse(text).unwrap();
        assert_eq!((map.frames, map.size), (7, (1060, 760)));
        assert_eq!((map.spent, map.analysing), (Duration::from_micros(1500), Duration::from_micros(400)));
        assert_eq!(map.middle("handle.blend low"), Some((20, 30)));
        assert_eq!(map.middle("b"), None);
        assert!(Map::parse("frame 7\nsize 1060\n").is_none());
    }
}
