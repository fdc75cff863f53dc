//! The page of controllers has the table that the bindings are made from.

use std::path::{Path, PathBuf};
use xr::controllers::{Control, ControlBinding, PROFILES, Profile, WhichHands};

const HEAD: &str = "| controller | profile | extension | move | select | grab | menu | back to the start | vibrates |\n\
                    |---|---|---|---|---|---|---|---|---|\n";

fn page() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/CONTROLLERS.md")
}

/// A part as the page has it.
fn part(part: &ControlBinding) -> String {
    let path = part.path.strip_prefix("input/").unwrap_or(part.path);
    match part.hands {
        WhichHands::Both => format!("`{path}`"),
        WhichHands::Left => format!("left `{path}`"),
        WhichHands::Right => format!("right `{path}`"),
    }
}

/// The parts that are for any of `controls`, or a dash.
fn cell(profile: &Profile, controls: &[Control]) -> String {
    let parts: Vec<String> =
        profile.bindings().filter(|binding| controls.contains(&binding.control)).map(part).collect();
    if parts.is_empty() { "–".into() } else { parts.join(", ") }
}

fn row(profile: &Profile) -> String {
    let movement = match cell(profile, &[Control::Press]).as_str() {
        "–" => cell(profile, &[Control::Move]),
        press => format!("{} during {press}", cell(profile, &[Control::Move])),
    };
    let (select, menu) = if profile.is_bare_hand() {
        let pinch = cell(profile, &[Control::Pinch]);
        (pinch.clone(), format!("{pinch}, palm to the eyes"))
    } else {
        (cell(profile, &[Control::Select]), cell(profile, &[Control::Menu]))
    };
    let cells = [
        profile.name.to_owned(),
        format!("`{}`", profile.path.trim_start_matches("/interaction_profiles/")),
        profile.extension.map_or_else(|| "–".into(), |extension| format!("`{}`", extension.name)),
        movement,
        select,
        cell(profile, &[Control::Grab, Control::Squeeze]),
        menu,
        cell(profile, &[Control::Reset]),
        if profile.of(Control::Vibration, 0).next().is_some() { "yes".into() } else { "–".into() },
    ];
    format!("| {} |\n", cells.join(" | "))
}

/// The page with this table in place of its own.
fn with_table(page: &str, table: &str) -> String {
    let is_row = |line: &&str| line.starts_with('|');
    let before: String = page.split_inclusive('\n').take_while(|line| !is_row(line)).collect();
    let after: String = page[before.len()..].split_inclusive('\n').skip_while(is_row).collect();
    before + table + &after
}

/// The test writes the page anew with `SCANWALK_BLESS=1`.
#[test]
fn the_page_has_the_table_of_bindings() {
    let table = HEAD.to_owned() + &PROFILES.iter().map(row).collect::<String>();
    let written = std::fs::read_to_string(page()).unwrap();
    let wanted = with_table(&written, &table);
    if std::env::var_os("SCANWALK_BLESS").is_some() {
        std::fs::write(page(), &wanted).unwrap();
    }
    let written = std::fs::read_to_string(page()).unwrap();
    assert!(
        written == wanted,
        "docs/CONTROLLERS.md is not what the table says: `SCANWALK_BLESS=1 cargo test --test program controllers` writes it anew"
    );
    assert_eq!(written.lines().filter(|line| line.starts_with('|')).count(), PROFILES.len() + 2);
    // The comparison can fail.
    assert_ne!(with_table(&written, &table.replace("`trigger/value`", "`trigger/click`")), written);
    assert_eq!(with_table("a\n| b |\n| c |\nd\n", "| e |\n"), "a\n| e |\nd\n");
}
