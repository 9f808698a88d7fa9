//! The window's pages, and their parameters group by group.

use std::sync::LazyLock;

use egui::{Frame, Margin, RichText, ScrollArea, Ui};
use pyrophone_settings::{Group, Id, PARAMETERS, Parameter, ParameterKind};

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
    fn groups(self) -> &'static [ControlGroup] {
        // The layout never changes, so it is looked up once and not in every frame.
        static ENGINES: LazyLock<[ControlGroup; 7]> = LazyLock::new(|| {
            [
                ControlGroup::new(Group::Drive, "the input"),
                ControlGroup::new(Group::Levels, "the mix"),
                ControlGroup::new(Group::Extension, "noise above the cutoff"),
                ControlGroup::new(Group::Flame, "the built-in flame (drive flame)"),
                ControlGroup::new(Group::Texture, "fire from the recording"),
                ControlGroup::new(Group::Crackle, "the recording's crackles, split off the texture"),
                ControlGroup::new(Group::Fuel, "crackle, hiss and roar without a recording"),
            ]
        });
        static SPACE: LazyLock<[ControlGroup; 3]> = LazyLock::new(|| {
            [
                ControlGroup::new(Group::Vortex, "the whoosh of turbulent gas"),
                ControlGroup::new(Group::Flame, "the built-in flame (drive flame), which moves the flow of fields"),
                ControlGroup::new(Group::Levels, "the mix"),
            ]
        });
        static SETUP: LazyLock<[ControlGroup; 2]> = LazyLock::new(|| {
            [
                ControlGroup::new(
                    Group::Structure,
                    "engine sizes: a change restarts the engines and may change the latency",
                ),
                ControlGroup::of("Quality", "effort of each search", |parameter| parameter.index == Id::Quality),
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
pub fn show(ui: &mut Ui, page: Page, edit: &mut ParamEditor<'_>) {
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
            let used: f32 = row.iter().map(ControlGroup::width).sum::<f32>() + SPACING * (row.len() - 1) as f32;
            let spare = (room - used).max(0.0) / row.len() as f32;
            ui.horizontal_top(|ui| {
                ui.spacing_mut().item_spacing.x = SPACING;
                row.iter().for_each(|group| group.show(ui, (group.width() + spare).min(room), edit));
            });
            rest = next;
        }
    });
}

struct ControlGroup {
    head: String,
    note: &'static str,
    /// Choices and switches, and knobs, by their indices in the table.
    picks: Vec<usize>,
    knobs: Vec<usize>,
}

impl ControlGroup {
    /// All of a group except the bypass switch, which is in the window's header.
    fn new(group: Group, note: &'static str) -> Self {
        Self::of(group.name(), note, |parameter| parameter.group == group && parameter.index != Id::Bypass)
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

    fn show(&self, ui: &mut Ui, width: f32, edit: &mut ParamEditor<'_>) {
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
                                    ParameterKind::Choice { names, .. } => choice(ui, *index, names, edit),
                                    _ => toggle(ui, *index, edit),
                                });
                            });
                        }
                        ui.horizontal_wrapped(|ui| self.knobs.iter().for_each(|index| knob(ui, *index, edit)));
                    });
                });
            },
        );
    }
}
