//! A setting in the panel: its name, and a widget of the kind that its value needs.

use super::style::FAINT;
use super::{Widget, Widgets, numbers};
use egui::emath::Numeric;
use egui::{ComboBox, DragValue, RichText, Slider, Ui};
use serde::Serialize;
use serde::de::DeserializeOwned;
use toml::Value;

/// Names that stand side by side, at most; more of them unfold.
const MOST_BESIDE: usize = 3;
/// Width of a slider, points.
const SLIDER_WIDTH: f32 = 122.0;
/// Points over which a number is dragged from its least to its greatest value, if that is not far.
const DRAG_POINTS: f64 = 500.0;

/// Draws a row for the setting with this key, whose value is `now`; calls `set` with the value that the user chooses.
pub(super) fn row<T: Serialize + DeserializeOwned>(
    ui: &mut Ui,
    widgets: &Widgets,
    key: &'static str,
    now: T,
    set: impl FnOnce(T),
) {
    // A key without a widget is a mistake of whoever draws the row, which every test of the panel shows.
    let widget = widgets.get(key).expect("a setting");
    ui.label(RichText::new(&widget.title).color(FAINT)).on_hover_text(&widget.help);
    // All values of settings can be written as TOML.
    let before = Value::try_from(now).expect("a value");
    let mut value = before.clone();
    // Not all that a file may say is a value here: a scan that is seen is of some kind.
    let is_value = |name: &&String| Value::String((*name).clone()).try_into::<T>().is_ok();
    let names: Vec<&String> = widget.names.iter().filter(is_value).collect();
    control(ui, key, widget, &names, &mut value);
    ui.end_row();
    if value != before
        && let Ok(chosen) = value.try_into()
    {
        set(chosen);
    }
}

/// Draws the widget. A value of a kind that no widget changes is shown as it is.
fn control(ui: &mut Ui, key: &str, widget: &Widget, names: &[&String], value: &mut Value) {
    match (value, widget.range) {
        (Value::Boolean(is_set), _) => _ = ui.checkbox(is_set, ""),
        (value, _) if (1..=MOST_BESIDE).contains(&names.len()) => {
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 2.0;
                choose(ui, names, value);
            });
        }
        (value, _) if !names.is_empty() => {
            let shown = value.as_str().map_or_else(|| value.to_string(), ToOwned::to_owned);
            ComboBox::from_id_salt(key).selected_text(shown).show_ui(ui, |ui| choose(ui, names, value));
        }
        (Value::Float(number), Some([least, most])) => {
            ui.spacing_mut().slider_width = SLIDER_WIDTH;
            // A range without zero goes over orders of magnitude.
            let slider = Slider::new(number, least..=most).logarithmic(least > 0.0);
            let unit = widget.unit;
            ui.add(slider.custom_formatter(|number, _| numbers::with_unit(number, unit)));
        }
        (Value::Integer(number), Some(range)) => {
            _ = ui.horizontal(|ui| {
                drag(ui, number, range);
                ui.label(widget.unit);
            })
        }
        (Value::Array(items), Some(range)) => {
            _ = ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 2.0;
                for item in items {
                    match item {
                        Value::Integer(number) => drag(ui, number, range),
                        Value::Float(number) => drag(ui, number, range),
                        other => _ = ui.label(other.to_string()),
                    }
                }
                ui.label(widget.unit);
            })
        }
        (value, _) => _ = ui.label(value.to_string()),
    }
}

/// Draws the names, of which a click chooses one.
fn choose(ui: &mut Ui, names: &[&String], value: &mut Value) {
    for name in names {
        ui.selectable_value(value, Value::String((*name).clone()), *name);
    }
}

/// Draws a number that is dragged, or written.
fn drag(ui: &mut Ui, number: &mut impl Numeric, [least, most]: [f64; 2]) {
    let speed = ((most - least) / DRAG_POINTS).min(1.0);
    ui.add(DragValue::new(number).range(least..=most).speed(speed));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::walk::moving::Hand;
    use egui::{Context, Event, Modifiers, PointerButton, Pos2, RawInput, Rect, Shape, vec2};

    /// Where the words are painted that one pass of `draw` paints, given these events.
    fn pass(context: &Context, events: Vec<Event>, draw: &mut impl FnMut(&mut Ui)) -> Vec<(String, Pos2)> {
        let screen_rect = Some(Rect::from_min_size(Pos2::ZERO, vec2(640.0, 480.0)));
        let mut output = context.run_ui(RawInput { screen_rect, events, ..RawInput::default() }, draw);
        // egui insists that its caller deals with its textures.
        output.textures_delta.clear();
        let words = output.shapes.iter().filter_map(|clipped| match &clipped.shape {
            Shape::Text(text) => Some((text.galley.text().to_owned(), text.visual_bounding_rect().center())),
            _ => None,
        });
        words.collect()
    }

    /// Draws, and clicks on a word; returns all words.
    fn click(on: &str, draw: &mut impl FnMut(&mut Ui)) -> Vec<String> {
        let context = Context::default();
        let words = pass(&context, Vec::new(), draw);
        if let Some(&(_, pos)) = words.iter().find(|(word, _)| word == on) {
            let button = |pressed| Event::PointerButton {
                pos,
                button: PointerButton::Primary,
                pressed,
                modifiers: Modifiers::NONE,
            };
            pass(&context, vec![Event::PointerMoved(pos)], draw);
            pass(&context, vec![button(true)], draw);
            pass(&context, vec![button(false)], draw);
        }
        words.into_iter().map(|(word, _)| word).collect()
    }

    fn widgets(names: &[&str], range: Option<[f64; 2]>) -> Widgets {
        let (title, help) = ("Some setting".into(), String::new());
        let names = names.iter().map(ToString::to_string).collect();
        [("a.key", Widget { title, help, names, range, unit: "degrees" })].into()
    }

    #[test]
    fn a_click_chooses_a_name() {
        let widgets = widgets(&["left", "right"], None);
        let mut chosen = Vec::new();
        let mut draw = |ui: &mut Ui| row(ui, &widgets, "a.key", "left".to_owned(), |name| chosen.push(name));
        assert_eq!(click("right", &mut draw), ["Some setting", "left", "right"]);
        click("left", &mut draw);
        assert_eq!(chosen, ["right"], "the value that it has is no choice");
    }

    #[test]
    fn the_value_tells_the_kind_of_widget() {
        let range = widgets(&[], Some([1.0, 180.0]));
        assert!(click("", &mut |ui| row(ui, &range, "a.key", 30.0, |_| {})).contains(&"30 degrees".into()));
        let many = widgets(&["a", "b", "c", "d"], None);
        let words = click("", &mut |ui| row(ui, &many, "a.key", "b".to_owned(), |_| {}));
        assert!(words.contains(&"b".into()) && !words.contains(&"c".into()), "{words:?}");
        let whole = widgets(&[], Some([0.0, 255.0]));
        assert!(click("", &mut |ui| row(ui, &whole, "a.key", 17, |_| {})).contains(&"17".into()));
        let list = click("", &mut |ui| row(ui, &whole, "a.key", [1, 2], |_| {}));
        assert!(list.contains(&"1".into()) && list.contains(&"2".into()), "{list:?}");
        // No widget changes a text, which is seen all the same.
        let text = click("", &mut |ui| row(ui, &widgets(&[], None), "a.key", "words".to_owned(), |_| {}));
        assert!(text.contains(&"\"words\"".into()), "{text:?}");
    }

    #[test]
    fn a_number_is_dragged_within_its_range() {
        let range = widgets(&[], Some([0.0, 20.0]));
        let mut chosen = Vec::new();
        let context = Context::default();
        let mut draw =
            |ui: &mut Ui| row(ui, &range, "a.key", [17, 5], |numbers: [u8; 2]| chosen.push(numbers));
        let words = pass(&context, Vec::new(), &mut draw);
        let (_, from) = words.iter().find(|(word, _)| word == "17").cloned().unwrap();
        let button = |pressed| Event::PointerButton {
            pos: from,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        pass(&context, vec![Event::PointerMoved(from)], &mut draw);
        pass(&context, vec![button(true)], &mut draw);
        pass(&context, vec![Event::PointerMoved(from + vec2(300.0, 0.0))], &mut draw);
        assert_eq!(chosen.last(), Some(&[20, 5]), "{chosen:?}");
    }

    #[test]
    fn names_that_are_no_values_are_not_offered() {
        let hands = widgets(&["auto", "left", "right"], None);
        let words = click("", &mut |ui| row(ui, &hands, "a.key", Hand::Left, |_| {}));
        assert_eq!(words, ["Some setting", "left", "right"]);
    }
}
