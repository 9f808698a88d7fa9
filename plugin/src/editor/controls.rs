//! The window's pages, and their parameters group by group.

use std::sync::LazyLock;

use egui::{Frame, Margin, RichText, ScrollArea, Ui};
use pyrophone_settings::{PARAMETERS, Parameter, ParameterKind};

use super::param_editor::ParamEditor;
use super::theme;
use super::widgets::{KNOB, PICK_WIDTH, choice, knob, toggle};

/// A page of the window.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Page {
    /// Performing: flame, layers, macros, takes.
    #[default]
    Play,
    /// Pictures of the engines, and all their parameters.
    Engines,
    /// Vortex sound, and the position of its sources.
    Space,
    /// Settings that decide sizes and latency, made once.
    Setup,
}

impl Page {
    /// All pages, in order of display.
    pub const ALL: [Self; 4] = [Self::Play, Self::Engines, Self::Space, Self::Setup];

    /// The page's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Play => "Play",
            Self::Engines => "Engines",
            Self::Space => "Space",
            Self::Setup => "Setup",
        }
    }

    /// The page's content, in a few words.
    pub fn hint(self) -> &'static str {
        match self {
            Self::Play => "Perform: flame, layers, macros, takes",
            Self::Engines => "Displays and all parameters of each engine",
            Self::Space => "The whoosh of moving gas, and its position",
            Self::Setup => "Engine sizes, which decide the latency; scale, folder of presets, MIDI controllers",
        }
    }

    /// The page's groups, with a note on each.
    fn groups(self) -> &'static [Group] {
        // The layout never changes, so it is looked up once and not in every frame.
        static ENGINES: LazyLock<[Group; 7]> = LazyLock::new(|| {
            [
                Group::new("Drive", "the input"),
                Group::new("Levels", "the mix"),
                Group::new("Extension", "noise above the cutoff"),
                Group::new("Flame", "the built-in flame (drive flame)"),
                Group::new("Texture", "fire from the recording"),
                Group::new("Crackle", "the recording's crackles, split off the texture"),
                Group::new("Fuel", "crackle, hiss and roar without a recording"),
            ]
        });
        static SPACE: LazyLock<[Group; 3]> = LazyLock::new(|| {
            [
                Group::new("Vortex", "the whoosh of turbulent gas"),
                Group::new("Flame", "the built-in flame (drive flame), which moves the flow of fields"),
                Group::new("Levels", "the mix"),
            ]
        });
        static SETUP: LazyLock<[Group; 2]> = LazyLock::new(|| {
            [
                Group::new("Structure", "engine sizes: a change restarts the engines and may change the latency"),
                Group::of("Quality", "effort of each search", |parameter| parameter.id == "quality"),
            ]
        });
        match self {
            Self::Play => &[],
            Self::Engines => &*ENGINES,
            Self::Space => &*SPACE,
            Self::Setup => &*SETUP,
        }
    }
}

/// Between groups and within them, in points.
const SPACING: f32 = 6.0;
const MARGIN: i8 = 9;

/// The groups of a page.
pub fn show(ui: &mut Ui, page: Page, hand: &mut ParamEditor<'_>) {
    ScrollArea::vertical().id_salt(page as usize).auto_shrink(false).show(ui, |ui| {
        let room = ui.available_width();
        let mut rest = page.groups();
        while let [first, ..] = rest {
            // As many as fit side by side, but at least one.
            let mut width = first.width();
            let more = rest[1..].iter().take_while(|group| {
                width += SPACING + group.width();
                width <= room
            });
            let (row, next) = rest.split_at(1 + more.count());
            // The remaining width is shared, so that all rows have the same length.
            let used: f32 = row.iter().map(Group::width).sum::<f32>() + SPACING * (row.len() - 1) as f32;
            let spare = (room - used).max(0.0) / row.len() as f32;
            ui.horizontal_top(|ui| {
                ui.spacing_mut().item_spacing.x = SPACING;
                row.iter().for_each(|group| group.show(ui, (group.width() + spare).min(room), hand));
            });
            rest = next;
        }
    });
}

struct Group {
    head: String,
    note: &'static str,
    /// Choices and switches, and knobs, by their indices in the table.
    picks: Vec<usize>,
    knobs: Vec<usize>,
}

impl Group {
    /// All of a group except the bypass switch, which is in the window's header.
    fn new(name: &'static str, note: &'static str) -> Self {
        Self::of(name, note, |parameter| parameter.group == name && parameter.id != "bypass")
    }

    /// The parameters that are members.
    fn of(name: &str, note: &'static str, is_member: impl Fn(&Parameter) -> bool) -> Self {
        let members = (0..PARAMETERS.len()).filter(|index| is_member(&PARAMETERS[*index]));
        let (picks, knobs) = members.partition(|index| {
            matches!(PARAMETERS[*index].kind, ParameterKind::Choice { .. } | ParameterKind::Toggle { .. })
        });
        Self { head: name.to_uppercase(), note, picks, knobs }
    }

    fn width(&self) -> f32 {
        let picks = if self.picks.is_empty() { 0.0 } else { PICK_WIDTH + SPACING };
        2.0 * f32::from(MARGIN) + picks + self.knobs.len() as f32 * (KNOB.x + SPACING)
    }

    fn show(&self, ui: &mut Ui, width: f32, hand: &mut ParamEditor<'_>) {
        let width = width - 2.0 * f32::from(MARGIN);
        Frame::new().fill(theme::PANEL).corner_radius(theme::ROUNDING).inner_margin(Margin::symmetric(MARGIN, 6)).show(
            ui,
            |ui| {
                ui.vertical(|ui| {
                    ui.set_width(width);
                    ui.horizontal(|ui| {
                        ui.label(RichText::new(&self.head).font(theme::head()).color(theme::EMBER).strong());
                        ui.add(
                            egui::Label::new(RichText::new(self.note).font(theme::small()).color(theme::WEAK))
                                .truncate(),
                        );
                    });
                    ui.horizontal_top(|ui| {
                        if !self.picks.is_empty() {
                            ui.vertical(|ui| {
                                ui.set_width(PICK_WIDTH);
                                self.picks.iter().for_each(|index| match PARAMETERS[*index].kind {
                                    ParameterKind::Choice { names, .. } => choice(ui, *index, names, hand),
                                    _ => toggle(ui, *index, hand),
                                });
                            });
                        }
                        ui.horizontal_wrapped(|ui| self.knobs.iter().for_each(|index| knob(ui, *index, hand)));
                    });
                });
            },
        );
    }
}
