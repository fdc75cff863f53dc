//! The window on a virtual screen: pictures, panel, keys, mouse, sizes, ends, all under Vulkan's validation layer
//! with synchronization validation. The tests need Xvfb, xdotool and the layer, and fail where these are missing.
//!
//! Every case runs the real window in a process of its own (winit allows one event loop a process, on the
//! main thread): this program again, with a role in the environment.

mod desktop_support;

use desktop_support::child::{ChildWindow, ROLE};
use desktop_support::walk::{self, EYE_PX, QUARTERS};
use kit::picture::Picture;
use kit::screen::Screen;
use kit::wait::wait_for;

const CASES: &[(&str, fn())] = &[
    ("the_mirror_shows_exact_colors_and_keeps_its_shape", the_mirror_shows_exact_colors_and_keeps_its_shape),
    ("panel_and_help_come_and_go", panel_and_help_come_and_go),
    ("keys_and_mouse_become_actions", keys_and_mouse_become_actions),
    ("losing_the_keyboard_stops_moving", losing_the_keyboard_stops_moving),
    ("closing_the_window_ends_the_walk", closing_the_window_ends_the_walk),
    ("the_end_of_the_walk_closes_the_window", the_end_of_the_walk_closes_the_window),
    ("the_window_outlives_its_gpu", the_window_outlives_its_gpu),
    ("loading_and_its_failure_are_shown", loading_and_its_failure_are_shown),
    ("no_display_is_a_plain_sentence", no_display_is_a_plain_sentence),
    ("the_validation_layer_can_object", the_validation_layer_can_object),
];

fn main() {
    if let Ok(role) = std::env::var(ROLE) {
        return walk::play(&role);
    }
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if arguments.iter().any(|a| a == "--list") {
        CASES.iter().for_each(|(name, _)| println!("{name}: test"));
        return;
    }
    let wanted: Vec<&String> = arguments.iter().filter(|a| !a.starts_with('-')).collect();
    let mut num_failed = 0;
    for (name, case) in CASES {
        if !wanted.is_empty() && !wanted.iter().any(|w| name.contains(w.as_str())) {
            continue;
        }
        let failed = std::panic::catch_unwind(case).is_err();
        num_failed += usize::from(failed);
        println!("test {name} ... {}", if failed { "FAILED" } else { "ok" });
    }
    assert_eq!(num_failed, 0, "cases failed");
}

/// Middles of the four quarters of an image that covers, or lies within, an area.
fn middles(area: [f64; 4], cover: bool) -> [[usize; 2]; 4] {
    let [x, y, width, height] = area;
    let [eye_width, eye_height] = EYE_PX.map(f64::from);
    let (across, down) = (width / eye_width, height / eye_height);
    let scale = if cover { across.max(down) } else { across.min(down) };
    [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]].map(|[right, below]: [f64; 2]| {
        // The places are a little off the center, where even a cropped image shows all four quarters.
        let px = x + width / 2.0 + right * 0.15 * scale * eye_width;
        let py = y + height / 2.0 + below * 0.15 * scale * eye_height;
        [px as usize, py as usize]
    })
}

fn wait_quarters(window: &ChildWindow, area: [f64; 4], cover: bool, eye: usize) {
    for ([x, y], color) in middles(area, cover).into_iter().zip(QUARTERS[eye]) {
        window.wait_pixel(x, y, color);
    }
}

fn the_mirror_shows_exact_colors_and_keeps_its_shape() {
    let screen = Screen::start();
    let window = ChildWindow::open("walk", &screen);
    window.xdotool(&["key", "Tab"]);
    wait_quarters(&window, [0.0, 0.0, 960.0, 640.0], true, 0);
    // The image is cropped in its middle: the colors' border is at the window's center, in both directions.
    let picture = window.picture();
    picture.keep("mirror-left");
    assert_eq!((picture.width, picture.height), (960, 640));
    assert_eq!([picture.at(477, 318), picture.at(482, 318)], [QUARTERS[0][0], QUARTERS[0][1]]);
    assert_eq!([picture.at(477, 322), picture.at(482, 322)], [QUARTERS[0][2], QUARTERS[0][3]]);

    window.xdotool(&["key", "m"]);
    wait_quarters(&window, [0.0, 0.0, 960.0, 640.0], true, 1);
    window.xdotool(&["key", "m"]);
    wait_quarters(&window, [0.0, 0.0, 480.0, 640.0], false, 0);
    wait_quarters(&window, [480.0, 0.0, 480.0, 640.0], false, 1);
    // The images are whole: above and below are bars that belong to no image.
    let both = window.picture();
    both.keep("mirror-both");
    let colors: Vec<_> = QUARTERS.concat();
    assert!(!colors.contains(&both.at(200, 30)) && colors.contains(&both.at(200, 70)));

    for (width, height) in [(1300, 500), (301, 707), (1400, 900)] {
        window.xdotool(&["windowsize", &window.id, &width.to_string(), &height.to_string()]);
        let half = f64::from(width / 2);
        wait_quarters(&window, [0.0, 0.0, half, height.into()], false, 0);
        wait_quarters(&window, [half, 0.0, half, height.into()], false, 1);
    }
    close(window);
}

fn panel_and_help_come_and_go() {
    let screen = Screen::start();
    let window = ChildWindow::open("walk", &screen);
    window.xdotool(&["windowsize", &window.id, "1280", "800"]);
    // A picture of the new size reaches into the new corner.
    window.wait_pixel(1270, 790, QUARTERS[0][3]);
    let with_panel = window.picture();
    with_panel.keep("panel");
    window.xdotool(&["key", "Tab"]);
    let plain = settled(&window, |p| p.num_different(&with_panel) > 50_000);
    // The panel is at the left: nothing differs right of it.
    let right_of =
        |p: &Picture| (0..p.height).flat_map(|y| (400..p.width).map(move |x| (x, y))).collect::<Vec<_>>();
    assert!(right_of(&plain).iter().all(|&(x, y)| plain.at(x, y) == with_panel.at(x, y)));
    window.xdotool(&["key", "F1"]);
    let help = settled(&window, |p| p.num_different(&plain) > 50_000);
    help.keep("help");
    assert_ne!(help.at(640, 400), plain.at(640, 400), "the help is in the middle");
    window.xdotool(&["key", "Escape"]);
    settled(&window, |p| p.num_different(&plain) == 0);
    window.xdotool(&["key", "Escape"]);
    settled(&window, |p| p.num_different(&plain) > 1000).keep("leave");
    // A first Esc is forgotten after two seconds; two in time quit.
    settled(&window, |p| p.num_different(&plain) == 0);
    window.xdotool(&["key", "Escape"]);
    window.xdotool(&["key", "Escape"]);
    assert_silent(window.wait_end());
}

fn keys_and_mouse_become_actions() {
    let screen = Screen::start();
    let window = ChildWindow::open("walk", &screen);
    let moving = |direction: &str, fast: bool| format!("Move {{ direction: {direction}, fast: {fast} }}");
    let rest = moving("[0.0, 0.0, 0.0]", false);
    let held = [
        ("w", "[0.0, 0.0, 1.0]"),
        ("s", "[0.0, 0.0, -1.0]"),
        ("a", "[-1.0, 0.0, 0.0]"),
        ("d", "[1.0, 0.0, 0.0]"),
        ("e", "[0.0, 1.0, 0.0]"),
        ("q", "[0.0, -1.0, 0.0]"),
        ("space", "[0.0, 1.0, 0.0]"),
    ];
    for (key, direction) in held {
        let already = window.commands().len();
        window.xdotool(&["keydown", key]);
        window.wait_command(&moving(direction, false), already);
        window.xdotool(&["keyup", key]);
        window.wait_command(&rest, already);
    }
    window.xdotool(&["keydown", "shift", "keydown", "w"]);
    window.wait_command(&moving("[0.0, 0.0, 1.0]", true), 0);
    window.xdotool(&["keyup", "w", "keyup", "shift"]);
    for (key, command) in [
        ("Home", "WholeView"),
        ("f", "WholeView"),
        ("r", "Reset"),
        ("Left", "Snap(-1)"),
        ("period", "Snap(1)"),
        ("o", "NextOverlay"),
        ("F12", "Screenshot"),
    ] {
        let already = window.commands().len();
        window.xdotool(&["key", key]);
        window.wait_command(command, already);
    }
    let already = window.commands().len();
    window.xdotool(&["mousemove", "700", "300", "mousedown", "1"]);
    window.xdotool(&["mousemove", "730", "280", "mouseup", "1", "mousemove", "100", "600"]);
    window.wait_command("Look { delta_px: [30.0, -20.0] }", already);
    window.xdotool(&["mousemove", "700", "300", "click", "4"]);
    window.wait_command("Faster(1.0)", already);

    // The mouse on the panel is egui's.
    window.xdotool(&["mousemove", "100", "200"]);
    let already = window.commands().len();
    window.xdotool(&["mousedown", "1", "mousemove", "120", "260", "mouseup", "1", "click", "4"]);
    window.xdotool(&["key", "r"]);
    window.wait_command("Reset", already);
    let since = window.commands()[already..].to_vec();
    assert_eq!(since, ["Reset"], "neither Look nor Faster came from the panel");
    close(window);
}

fn losing_the_keyboard_stops_moving() {
    let screen = Screen::start();
    let window = ChildWindow::open("walk", &screen);
    window.xdotool(&["keydown", "w"]);
    window.wait_command("Move { direction: [0.0, 0.0, 1.0], fast: false }", 0);
    let already = window.commands().len();
    screen.take_keyboard();
    window.wait_command("Move { direction: [0.0, 0.0, 0.0], fast: false }", already);
    window.xdotool(&["keyup", "w"]);
    close(window);
}

/// The window draws on another GPU, with its panel as it was, and takes keys as before.
fn the_window_outlives_its_gpu() {
    let screen = Screen::start();
    let window = ChildWindow::open("another", &screen);
    window.xdotool(&["key", "Tab"]);
    window.cue();
    window.wait_command("another GPU", 0);
    window.xdotool(&["windowsize", &window.id, "1100", "700"]);
    wait_quarters(&window, [0.0, 0.0, 1100.0, 700.0], true, 0);
    let already = window.commands().len();
    window.xdotool(&["key", "r"]);
    window.wait_command("Reset", already);
    window.xdotool(&["key", "Tab"]);
    let without = window.picture();
    settled(&window, |p| p.num_different(&without) > 20_000).keep("another-gpu");
    close(window);
}

fn closing_the_window_ends_the_walk() {
    let screen = Screen::start();
    let window = ChildWindow::open("walk", &screen);
    close(window);
}

fn the_end_of_the_walk_closes_the_window() {
    let screen = Screen::start();
    for role in ["stop", "vanish"] {
        let window = ChildWindow::open(role, &screen);
        window.cue();
        assert_silent(window.wait_end());
    }
}

fn loading_and_its_failure_are_shown() {
    let screen = Screen::start();
    for role in ["loading", "broken"] {
        let window = ChildWindow::open(role, &screen);
        // The card alone is in the middle of what the panel leaves free.
        let num_written = |p: &Picture| {
            let middle = (0..60).flat_map(|y| (0..200).map(move |x| (535 + x, 290 + y)));
            middle.filter(|&(x, y)| p.at(x, y) != p.at(4, 4)).count()
        };
        let picture = settled(&window, |p| num_written(p) > 3000);
        picture.keep(role);
        close(window);
    }
}

fn no_display_is_a_plain_sentence() {
    let (line, log) = ChildWindow::without_display("walk").wait_end();
    assert_eq!(
        line,
        "ended with: no window can be opened: there is no display (neither DISPLAY nor \
         WAYLAND_DISPLAY is set); run scanwalk on a desktop, or use --window off"
    );
    assert_eq!(log, "");
}

fn the_validation_layer_can_object() {
    let (line, log) = ChildWindow::without_display("hazard").wait_end();
    assert_eq!(line, "ended well");
    assert!(
        log.contains("SYNC-HAZARD-WRITE-AFTER-WRITE"),
        "the validation layer did not see a hazard made on purpose (apt install vulkan-validationlayers): {log}"
    );
}

/// Waits until the picture is as wanted at two looks in a row, between which only the panel's plots may move.
fn settled(window: &ChildWindow, wanted: impl Fn(&Picture) -> bool) -> Picture {
    let mut before: Option<Picture> = None;
    wait_for("the picture", || {
        let now = Some(window.picture()).filter(&wanted);
        let stays = before.as_ref().zip(now.as_ref()).is_some_and(|(a, b)| a.num_different(b) < 4000);
        before = now;
        stays.then(|| before.clone()).flatten()
    })
}

/// Asks the window to close as a desktop's close button does, and checks a good end.
fn close(window: ChildWindow) {
    window.ask_to_close();
    let commands = wait_for("Quit", || {
        let commands = window.commands();
        commands.iter().any(|c| c == "Quit").then_some(commands)
    });
    assert_eq!(commands.last().map(String::as_str), Some("Quit"));
    assert_silent(window.wait_end());
}

fn assert_silent((line, log): (String, String)) {
    assert_eq!(line, "ended well, stop requested: true");
    assert_eq!(log, "", "the validation layer objects");
}
