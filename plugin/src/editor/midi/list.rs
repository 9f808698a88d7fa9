//! The list of MIDI controllers: the parameters they move, the scope of each assignment, and a button to remove it.

use egui::{Align, Label, Layout, Rect, RichText, ScrollArea, Ui, Vec2};
use pyrophone_settings::controller_file::Assignments;
use pyrophone_settings::{PARAMETERS, index_of};

use super::super::widgets::section::{filled, section, title_row, within};
use super::super::{map, theme};
use super::{MidiPanel, Numbers, numbers};
use crate::controllers::Controllers;

/// Height of a line, and widths of the controller's number, of its button and of **Remove all**, in points.
const LINE: f32 = 22.0;
const NUMBER: f32 = 44.0;
const REMOVE: f32 = 58.0;
const REMOVE_ALL: f32 = 116.0;

/// The button in the head is taller than the head, in points.
const BELOW_HEAD: f32 = 6.0;

/// Seconds for which the button asks for confirmation.
const ASKS_S: f64 = 10.0;

/// Scope of an assignment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Scope {
    /// In this session, and in future instances.
    Both,
    /// In this session: another computer or an older instance assigned it.
    Session,
    /// In future instances: another instance assigned it while this one was open.
    Later,
}

impl Scope {
    fn words(self) -> &'static str {
        match self {
            Self::Both => "session and new instances",
            Self::Session => "session only",
            Self::Later => "new instances only",
        }
    }

    fn is_in_session(self) -> bool {
        self != Self::Later
    }

    fn is_kept(self) -> bool {
        self != Self::Session
    }
}

/// An assignment: a controller, and the index in the table of the parameter that it moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Line {
    number: u8,
    index: usize,
    scope: Scope,
}

/// All assignments of the session and of the file, by controller.
fn lines(session: &Numbers, kept: &Assignments) -> Vec<Line> {
    let mut lines: Vec<Line> = session
        .iter()
        .enumerate()
        .filter_map(|(index, number)| {
            let number = (*number)?;
            let is_kept = kept.get(PARAMETERS[index].id) == Some(&number);
            Some(Line { number, index, scope: if is_kept { Scope::Both } else { Scope::Session } })
        })
        .collect();
    lines.extend(kept.iter().filter_map(|(id, number)| {
        let index = index_of(id).ok()?;
        (session[index] != Some(*number)).then_some(Line { number: *number, index, scope: Scope::Later })
    }));
    lines.sort_by_key(|line| (line.number, line.index));
    lines
}

impl MidiPanel {
    /// Draws the list in `rect`.
    pub fn list(&mut self, ui: &mut Ui, rect: Rect, controllers: &Controllers) {
        let lines = lines(&numbers(controllers), &self.kept);
        let inner = section(ui, rect, "MIDI", if lines.is_empty() { "controllers" } else { "assignments" });
        if lines.is_empty() {
            within(ui, inner, "no controllers", |ui| {
                let words = "No controller is assigned yet. Right-click a knob, fader or list, choose MIDI learn, and move the controller.";
                ui.add(Label::new(RichText::new(words).font(theme::small()).color(theme::WEAK)).wrap());
            });
            return;
        }
        self.remove_all_button(ui, title_row(rect), controllers);
        let mut removed = None;
        within(ui, inner.with_min_y(inner.top() + BELOW_HEAD), "controllers", |ui| {
            ScrollArea::vertical().id_salt("controllers").auto_shrink(false).show(ui, |ui| {
                for shown in &lines {
                    if line(ui, shown) {
                        removed = Some(*shown);
                    }
                }
            });
        });
        if let Some(line) = removed {
            self.remove(line, controllers);
        }
    }

    fn remove(&mut self, line: Line, controllers: &Controllers) {
        if line.scope.is_in_session() {
            controllers.assign(line.index, None);
            // The file assigns another controller to this parameter, which gets a line to itself.
            if let Some(seen) = &mut self.seen {
                seen[line.index] = None;
            }
        }
        if line.scope.is_kept() {
            let id = PARAMETERS[line.index].id;
            self.work(move |file| file.assign(id, None));
        }
    }

    /// A button that asks for confirmation: removing the defaults of future instances cannot be undone.
    fn remove_all_button(&mut self, ui: &mut Ui, row: Rect, controllers: &Controllers) {
        let place = row.with_min_x(row.right() - REMOVE_ALL);
        let now_s = ui.input(|input| input.time);
        let asks = self.asked_s.is_some_and(|asked_s| now_s < asked_s + ASKS_S);
        let words = if asks { "Remove all for good" } else { "Remove all" };
        let button = filled(ui, place, words, "Remove all", asks, true);
        let button = button
            .on_hover_text("Removes all assignments, from this session and for new instances; asks for confirmation");
        if button.clicked() && asks {
            controllers.set_all(&Assignments::new());
            (self.seen, self.asked_s) = (Some(numbers(controllers)), None);
            self.work(|file| file.clear());
        } else if button.clicked() {
            self.asked_s = Some(now_s);
            ui.ctx().request_repaint_after_secs(ASKS_S as f32);
        }
    }
}

/// Draws a line; true if it is to be removed.
fn line(ui: &mut Ui, line: &Line) -> bool {
    let parameter = &PARAMETERS[line.index];
    let (rect, _) = ui.allocate_exact_size(Vec2::new(ui.available_width(), LINE), egui::Sense::hover());
    map::note(ui, format_args!("midi.{}.{}", line.number, parameter.id), rect);
    ui.painter().rect_filled(rect, 3.0, theme::GROUND);
    let button = rect.with_min_x(rect.right() - REMOVE).shrink(1.0);
    let name = format!("remove.{}.{}", line.number, parameter.id);
    let is_clicked = filled(ui, button, "Remove", &name, false, true).clicked();
    let words = rect.with_min_x(rect.left() + 6.0).with_max_x(button.left() - 6.0);
    let (number, words) = words.split_left_right_at_x(words.left() + NUMBER);
    label(ui, number, &format!("CC {}", line.number), theme::BLUE, "number");
    let (left, right) = words.split_left_right_at_fraction(0.46);
    let name = label(ui, left.with_max_x(left.right() - 4.0), parameter.name, theme::TEXT, "name");
    name.on_hover_text(parameter.help);
    label(ui, right, line.scope.words(), theme::WEAK, "scope");
    is_clicked
}

/// Text of a line, shortened where space is lacking.
fn label(ui: &mut Ui, rect: Rect, words: &str, color: egui::Color32, salt: &str) -> egui::Response {
    let builder = egui::UiBuilder::new().id_salt((salt, rect.top() as i32)).max_rect(rect);
    let mut place = ui.new_child(builder.layout(Layout::left_to_right(Align::Center)));
    place.add(Label::new(RichText::new(words).font(theme::small()).color(color)).truncate())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_say_where_assignments_hold() {
        let place = |id: &str| index_of(id).expect("a parameter");
        let mut session: Numbers = std::array::from_fn(|_| None);
        for (id, number) in [("macro_size", 21), ("macro_fury", 7), ("alpha", 30)] {
            session[place(id)] = Some(number);
        }
        let kept = [("macro_size", 21), ("alpha", 31), ("macro_hiss", 7)].map(|(id, number)| (id.to_owned(), number));
        let found = lines(&session, &Assignments::from(kept));
        let found: Vec<(u8, &str, Scope)> =
            found.iter().map(|line| (line.number, PARAMETERS[line.index].id, line.scope)).collect();
        let mut expected = vec![
            (7, "macro_fury", Scope::Session),
            (7, "macro_hiss", Scope::Later),
            (21, "macro_size", Scope::Both),
            (30, "alpha", Scope::Session),
            (31, "alpha", Scope::Later),
        ];
        expected.sort_by_key(|(number, id, _)| (*number, place(id)));
        assert_eq!(found, expected);
    }
}
