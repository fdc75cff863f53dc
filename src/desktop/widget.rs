//! A setting in the panel: its name, and a widget of the kind that its value needs.

use super::style::FAINT;
use super::{Widget, Widgets, numbers};
use egui::{ComboBox, RichText, Slider, Ui};
use serde::Serialize;
use serde::de::DeserializeOwned;
use toml::Value;

/// Names that stand side by side, at most; more of them unfold.
const MOST_BESIDE: usize = 3;
/// Width of a slider, points.
const SLIDER_WIDTH: f32 = 122.0;

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
    control(ui, key, widget, &mut value);
    ui.end_row();
    if value != before
        && let Ok(chosen) = value.try_into()
    {
        set(chosen);
    }
}

/// Draws the widget. A value of a kind that no widget changes is shown as it is.
fn control(ui: &mut Ui, key: &str, widget: &Widget, value: &mut Value) {
    match (value, widget.range) {
        (Value::Boolean(is_set), _) => _ = ui.checkbox(is_set, ""),
        (Value::String(name), _) if (1..=MOST_BESIDE).contains(&widget.names.len()) => {
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 2.0;
                names(ui, widget, name);
            });
        }
        (Value::String(name), _) if !widget.names.is_empty() => {
            let unfolding = ComboBox::from_id_salt(key).selected_text(Widget::title_of(name));
            unfolding.show_ui(ui, |ui| names(ui, widget, name));
        }
        (Value::Float(number), Some([least, most])) => {
            ui.spacing_mut().slider_width = SLIDER_WIDTH;
            // A range without zero goes over orders of magnitude.
            let slider = Slider::new(number, least..=most).logarithmic(least > 0.0);
            let unit = widget.unit;
            ui.add(slider.custom_formatter(|number, _| numbers::with_unit(number, unit)));
        }
        (value, _) => _ = ui.label(value.to_string()),
    }
}

fn names(ui: &mut Ui, widget: &Widget, chosen: &mut String) {
    for name in widget.names {
        ui.selectable_value(chosen, (*name).to_owned(), Widget::title_of(name));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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

    fn widgets(names: &'static [&'static str], range: Option<[f64; 2]>) -> Widgets {
        let (title, help) = ("Some setting".into(), String::new());
        [("a.key", Widget { title, help, names, range, unit: "degrees" })].into()
    }

    #[test]
    fn a_click_chooses_a_name() {
        let widgets = widgets(&["left", "right"], None);
        let mut chosen = Vec::new();
        let mut draw = |ui: &mut Ui| row(ui, &widgets, "a.key", "left".to_owned(), |name| chosen.push(name));
        assert_eq!(click("Right", &mut draw), ["Some setting", "Left", "Right"]);
        click("Left", &mut draw);
        assert_eq!(chosen, ["right"], "the value that it has is no choice");
    }

    #[test]
    fn the_value_tells_the_kind_of_widget() {
        let range = widgets(&[], Some([1.0, 180.0]));
        assert!(click("", &mut |ui| row(ui, &range, "a.key", 30.0, |_| {})).contains(&"30 degrees".into()));
        let many = widgets(&["a", "b", "c", "d"], None);
        let words = click("", &mut |ui| row(ui, &many, "a.key", "b".to_owned(), |_| {}));
        assert!(words.contains(&"B".into()) && !words.contains(&"C".into()), "{words:?}");
        // No widget changes a list, which is seen all the same.
        let list = click("", &mut |ui| row(ui, &widgets(&[], None), "a.key", [1, 2], |_| {}));
        assert!(list.contains(&"[1, 2]".into()), "{list:?}");
    }
}
