//! Clicks in the panel: what is chosen in it becomes actions.

use super::controls::WindowState;
use super::history::History;
use super::recent::RecentScan;
use super::{WindowOptions, panel, style};
use crate::walk::action::Action;
use crate::walk::appearance::{Appearance, QualityPreset};
use crate::walk::filling::ScanRequest;
use crate::walk::kind::ScanKind;
use crate::walk::link::{HeadsetState, LoadState};
use crate::walk::state::{AppState, SpeedFactor};
use egui::{Context, Event, Modifiers, PointerButton, Pos2, RawInput, Rect, Shape, Vec2};
use points::{ReadOptions, Unit, Up};
use render::options::{Overlay, Quality};
use std::sync::Arc;
use std::time::Instant;

/// A panel, and somebody who clicks in it.
struct Clicker {
    context: Context,
    size: Vec2,
    view: WindowState,
    load: LoadState,
    recent: Vec<RecentScan>,
    headset: HeadsetState,
    appearance: Appearance,
    asked: Vec<Action>,
}

impl Clicker {
    fn new(width: f32, height: f32) -> Self {
        let context = Context::default();
        style::apply(&context);
        let request = ScanRequest {
            files: vec!["hall.laz".into()],
            read: ReadOptions::AS_FILES_SAY,
            kind: Some(ScanKind::Interior),
        };
        let load = LoadState {
            facts: vec![("points".into(), "7".into())],
            scan: Some(Arc::new(request)),
            ..LoadState::default()
        };
        let recent = [("a.las", true), ("gone.las", false)]
            .map(|(name, is_there)| RecentScan { files: vec![name.into()], is_there })
            .to_vec();
        let (size, view) = (Vec2::new(width, height), WindowState::new(&WindowOptions::sample()));
        let appearance = Appearance { shows_surround: true, ..Appearance::sample() };
        let headset = HeadsetState::default();
        Self { context, size, view, load, recent, headset, appearance, asked: Vec::new() }
    }

    /// Draws the panel with these events; returns the words that are seen, and where.
    fn pass(&mut self, events: Vec<Event>) -> Vec<(String, Pos2)> {
        fn collect(shape: &Shape, words: &mut Vec<(String, Pos2)>) {
            match shape {
                Shape::Text(text) => {
                    words.push((text.galley.text().to_owned(), text.visual_bounding_rect().center()));
                }
                Shape::Vec(shapes) => shapes.iter().for_each(|shape| collect(shape, words)),
                _ => {}
            }
        }
        let screen_rect = Some(Rect::from_min_size(Pos2::ZERO, self.size));
        let options = WindowOptions::sample();
        let mut state = AppState::new(Overlay::None, SpeedFactor::sample(), Appearance::sample());
        state.set_appearance(self.appearance);
        let history = History::default();
        let contents = panel::Contents {
            history: &history,
            load: &self.load,
            headset: &self.headset,
            recent: &self.recent,
            widgets: &options.widgets,
            state: state.snapshot(),
            eye_px: None,
            now: Instant::now(),
        };
        let (view, asked) = (&mut self.view, &mut self.asked);
        let input = RawInput { screen_rect, events, ..RawInput::default() };
        let mut output = self.context.run_ui(input, |ui| asked.extend(panel::show(ui, &contents, view)));
        // egui insists that its caller deals with its textures.
        output.textures_delta.clear();
        let mut words = Vec::new();
        output.shapes.iter().for_each(|clipped| collect(&clipped.shape, &mut words));
        words
    }

    /// The words that are seen.
    fn words(&mut self) -> Vec<String> {
        // The first passes of an area only measure it.
        (0..3).for_each(|_| _ = self.pass(Vec::new()));
        self.pass(Vec::new()).into_iter().map(|(word, _)| word).collect()
    }

    /// Clicks on this word, the one after `skipped` others of its kind.
    fn click(&mut self, word: &str, skipped: usize) {
        self.words();
        let words = self.pass(Vec::new());
        let found = words.iter().filter(|(seen, _)| seen == word).nth(skipped);
        let pos = found.unwrap_or_else(|| panic!("no {word} in {words:?}")).1;
        let button = |pressed| Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        for event in [Event::PointerMoved(pos), button(true), button(false)] {
            self.pass(vec![event]);
        }
        self.pass(Vec::new());
    }

    /// The scan that is asked for.
    fn opened(&mut self) -> ScanRequest {
        let asked = std::mem::take(&mut self.asked);
        let [Action::Open(request)] = &asked[..] else { panic!("{asked:?}") };
        ScanRequest::clone(request)
    }
}

#[test]
fn another_unit_or_axis_reads_the_scan_anew() {
    let mut clicker = Clicker::new(1000.0, 1000.0);
    clicker.click("auto", 0);
    clicker.click("-y", 0);
    let request = clicker.opened();
    assert_eq!((request.read.up, request.read.unit), (Up::MinusY, Unit::Auto));
    assert_eq!((request.files[0].to_str(), request.kind), (Some("hall.laz"), Some(ScanKind::Interior)));
    clicker.click("auto", 1);
    clicker.click("mm", 0);
    let request = clicker.opened();
    assert_eq!((request.read.up, request.read.unit.meters()), (Up::Auto, Some(0.001)));
    // What it is read as already is no reason to read it again.
    clicker.click("auto", 1);
    clicker.click("auto", 2);
    assert_eq!(clicker.asked, []);
}

#[test]
fn a_headset_that_never_answered_is_looked_for_at_once() {
    let mut clicker = Clicker::new(1000.0, 1000.0);
    assert!(!clicker.words().contains(&"Look now".to_owned()), "nobody wishes for one");
    clicker.headset.is_sought = true;
    clicker.click("Look now", 0);
    assert_eq!(clicker.asked, [Action::LookForHeadset]);
    clicker.headset.waiting_because = Some("it is gone".into());
    assert!(!clicker.words().contains(&"Look now".to_owned()), "the card that stays has the button");
}

#[test]
fn the_picture_is_changed_in_it() {
    let mut clicker = Clicker::new(1000.0, 1000.0);
    clicker.click("Performance", 0);
    assert_eq!(std::mem::take(&mut clicker.asked), [Action::SetPreset(QualityPreset::Performance)]);
    let now = clicker.appearance.draw.quality;
    let (other, word) =
        if now == Quality::Hqs { (Quality::Closest, "closest") } else { (Quality::Hqs, "hqs") };
    clicker.click(word, 0);
    let mut wanted = clicker.appearance;
    wanted.draw.quality = other;
    assert_eq!(clicker.asked, [Action::SetAppearance(wanted)]);
    clicker.click("Surround", 0);
    // What unfolds takes its time.
    (0..60).for_each(|_| _ = clicker.pass(Vec::new()));
    let words = clicker.words();
    assert!(words.contains(&"Sky".into()) && !words.contains(&"Background".into()), "{words:?}");
    clicker.appearance.shows_surround = false;
    let words = clicker.words();
    assert!(!words.contains(&"Sky".into()) && words.contains(&"Background".into()), "{words:?}");
}

#[test]
fn scans_that_were_opened_last_are_opened_again_while_they_are_there() {
    let mut clicker = Clicker::new(1000.0, 1000.0);
    clicker.click("Open…", 0);
    assert!(clicker.view.opening && clicker.asked.is_empty());
    clicker.click("Recent", 0);
    clicker.click("gone.las", 0);
    assert_eq!(clicker.asked, []);
    // A click closes the list.
    clicker.click("Recent", 0);
    clicker.click("a.las", 0);
    assert_eq!(clicker.opened().files, [std::path::PathBuf::from("a.las")]);
    clicker.recent.clear();
    assert!(!clicker.words().contains(&"Recent".into()));
}

#[test]
fn in_a_narrow_window_the_panel_is_a_button_at_first() {
    let mut clicker = Clicker::new(640.0, 480.0);
    assert_eq!(clicker.words(), ["Panel"]);
    clicker.click("Panel", 0);
    assert!(clicker.words().contains(&"Open…".into()));
    clicker.click("–", 0);
    assert_eq!(clicker.words(), ["Panel"]);
    let mut wide = Clicker::new(800.0, 600.0);
    assert!(wide.words().contains(&"Open…".into()));
    wide.click("–", 0);
    assert_eq!(wide.words(), ["Panel"]);
}
