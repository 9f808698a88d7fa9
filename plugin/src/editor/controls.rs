//! All parameters, group by group.

use egui::{Frame, Margin, RichText, ScrollArea, Ui};
use pyrophone_settings::{Kind, PARAMETERS};

use super::hand::Hand;
use super::theme;
use super::widgets::{KNOB, PICK_WIDTH, choice, knob, toggle};

/// A page of parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Page {
    /// What most is played with.
    #[default]
    Play,
    /// Vortex sound, and the flame that may move it.
    Vortex,
    /// What decides sizes and latency.
    Structure,
}

impl Page {
    /// Its groups, with a word on what they do.
    const fn groups(self) -> &'static [Group] {
        match self {
            Self::Play => &[
                Group { name: "Drive", note: "what goes in" },
                Group { name: "Levels", note: "what is heard" },
                Group { name: "Extension", note: "noise above the cutoff" },
                Group { name: "Flame", note: "what burns where nothing goes in (drive flame)" },
                Group { name: "Texture", note: "fire from the recording" },
            ],
            Self::Vortex => &[
                Group { name: "Vortex", note: "the whoosh of turbulent gas" },
                Group {
                    name: "Flame",
                    note: "what burns where nothing goes in (drive flame), and moves the flow of fields",
                },
                Group { name: "Levels", note: "what is heard" },
            ],
            Self::Structure => &[Group {
                name: "Structure",
                note: "sizes of the engines: a change restarts them and may change the latency",
            }],
        }
    }
}

/// Between groups and within them, in points.
const SPACING: f32 = 6.0;
const MARGIN: i8 = 9;

/// The groups of a page.
pub fn show(ui: &mut Ui, page: Page, hand: &mut Hand<'_>) {
    ScrollArea::vertical().id_salt(page as usize).auto_shrink(false).show(ui, |ui| {
        let room = ui.available_width();
        let mut rest = page.groups();
        while let [first, ..] = rest {
            // As many as fit beside each other, but one at least.
            let mut width = first.width();
            let more = rest[1..].iter().take_while(|group| {
                width += SPACING + group.width();
                width <= room
            });
            let (row, next) = rest.split_at(1 + more.count());
            ui.horizontal_top(|ui| {
                ui.spacing_mut().item_spacing.x = SPACING;
                row.iter().for_each(|group| group.show(ui, room, hand));
            });
            rest = next;
        }
    });
}

struct Group {
    name: &'static str,
    note: &'static str,
}

impl Group {
    /// Its parameters by their places in the table: choices and switches, then knobs. The switch for bypass stands in the
    /// head of the window.
    fn members(&self) -> (Vec<usize>, Vec<usize>) {
        let members = (0..PARAMETERS.len())
            .filter(|index| PARAMETERS[*index].group == self.name && PARAMETERS[*index].id != "bypass");
        members.partition(|index| matches!(PARAMETERS[*index].kind, Kind::Choice { .. } | Kind::Toggle { .. }))
    }

    fn width(&self) -> f32 {
        let (picks, knobs) = self.members();
        let picks = if picks.is_empty() { 0.0 } else { PICK_WIDTH + SPACING };
        2.0 * f32::from(MARGIN) + picks + knobs.len() as f32 * (KNOB.x + SPACING)
    }

    fn show(&self, ui: &mut Ui, room: f32, hand: &mut Hand<'_>) {
        let (picks, knobs) = self.members();
        let width = self.width().min(room) - 2.0 * f32::from(MARGIN);
        Frame::new().fill(theme::PANEL).corner_radius(theme::ROUNDING).inner_margin(Margin::symmetric(MARGIN, 6)).show(
            ui,
            |ui| {
                ui.vertical(|ui| {
                    ui.set_width(width);
                    ui.horizontal(|ui| {
                        ui.label(
                            RichText::new(self.name.to_uppercase()).font(theme::head()).color(theme::EMBER).strong(),
                        );
                        ui.add(
                            egui::Label::new(RichText::new(self.note).font(theme::small()).color(theme::WEAK))
                                .truncate(),
                        );
                    });
                    ui.horizontal_top(|ui| {
                        if !picks.is_empty() {
                            ui.vertical(|ui| {
                                ui.set_width(PICK_WIDTH);
                                picks.iter().for_each(|index| match PARAMETERS[*index].kind {
                                    Kind::Choice { names, .. } => choice(ui, *index, names, hand),
                                    _ => toggle(ui, *index, hand),
                                });
                            });
                        }
                        ui.horizontal_wrapped(|ui| knobs.iter().for_each(|index| knob(ui, *index, hand)));
                    });
                });
            },
        );
    }
}
