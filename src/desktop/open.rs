//! The dialog that opens scans: a folder's folders and scans, and a field for a path. Folders are read on threads of their own,
//! since a folder may lie on a network.

use super::numbers;
use super::style::{self, BAD, FAINT, caption};
use crate::walk::action::Action;
use crate::walk::filling::ScanRequest;
use egui::{
    Align, Align2, Area, Button, Id, Key, Label, Layout, Order, Rect, RichText, ScrollArea, TextEdit, Ui,
    vec2,
};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};

/// Width and height of the dialog, points, where there is room.
const SIZE: [f32; 2] = [460.0, 420.0];
/// Height of a row, points.
const ROW: f32 = 20.0;

/// Something in a folder that can be chosen.
#[derive(Clone, Debug, PartialEq, Eq)]
struct FolderEntry {
    name: String,
    path: PathBuf,
    /// Size of a file; `None` for a folder.
    bytes: Option<u64>,
}

/// What a path leads to.
#[derive(Debug, PartialEq, Eq)]
enum PathTarget {
    /// A folder, and what is in it.
    Folder(PathBuf, Vec<FolderEntry>),
    /// A file.
    File(PathBuf),
    /// Nothing that can be looked at, and why.
    Nothing(String),
}

/// What the user does with the dialog.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum DialogOutcome {
    /// Opens these files as one scan.
    Open(Vec<PathBuf>),
    /// Closes it.
    Close,
}

/// The dialog, from one picture to the next.
#[derive(Debug)]
pub(super) struct OpenDialog {
    folder: PathBuf,
    entries: Vec<FolderEntry>,
    /// Files of the folder that the user has chosen.
    chosen: BTreeSet<PathBuf>,
    /// What the user types: a path, from the folder on if it is not whole.
    typed: String,
    problem: Option<String>,
    looking: Option<Receiver<PathTarget>>,
    /// True if the field is to get the keyboard.
    takes_keys: bool,
}

/// What opens these files in the way in which the scan before was read.
pub(super) fn open(files: Vec<PathBuf>, before: &ScanRequest) -> Action {
    Action::Open(Arc::new(ScanRequest { files, kind: None, ..before.clone() }))
}

impl OpenDialog {
    /// A dialog that begins in the folder of the scan that is shown, else where the program was started.
    pub(super) fn new(shown: &[PathBuf]) -> Self {
        let folder = shown.first().and_then(|file| file.parent()).unwrap_or(Path::new(""));
        let folder = std::path::absolute(folder.join("."))
            .or_else(|_| std::env::current_dir())
            .unwrap_or_else(|_| home());
        let mut dialog = Self {
            folder: folder.clone(),
            entries: Vec::new(),
            chosen: BTreeSet::new(),
            typed: String::new(),
            problem: None,
            looking: None,
            takes_keys: true,
        };
        dialog.go(folder);
        dialog
    }

    /// Has a thread look where a path leads.
    fn go(&mut self, path: PathBuf) {
        let (found, looking) = channel();
        self.looking = Some(looking);
        std::thread::spawn(move || {
            // Nobody waits for it any more once another folder is wanted.
            let _ = found.send(look(&path));
        });
    }

    /// Takes in what the thread has found; returns a file that it was sent for.
    fn take_in(&mut self) -> Option<PathBuf> {
        let found = self.looking.as_ref()?.try_recv().ok()?;
        (self.looking, self.problem) = (None, None);
        // Enter has taken the keyboard from the field, and a click may have.
        self.takes_keys = true;
        match found {
            PathTarget::Folder(folder, entries) => {
                (self.folder, self.entries) = (folder, entries);
                self.chosen.clear();
                self.typed.clear();
                None
            }
            PathTarget::File(path) => Some(path),
            PathTarget::Nothing(problem) => {
                self.problem = Some(problem);
                None
            }
        }
    }

    /// Opens what is typed, else what is chosen.
    fn confirm(&mut self) -> Option<DialogOutcome> {
        if !self.typed.trim().is_empty() {
            let typed = self.typed.trim();
            let path = typed
                .strip_prefix("~/")
                .map_or_else(|| self.folder.join(typed), |in_home| home().join(in_home));
            self.go(path);
            return None;
        }
        let files: Vec<PathBuf> = self.chosen.iter().cloned().collect();
        (!files.is_empty()).then_some(DialogOutcome::Open(files))
    }

    /// Draws the dialog; returns what the user does with it.
    pub(super) fn show(&mut self, ui: &mut Ui) -> Option<DialogOutcome> {
        let mut choice = self.take_in().map(|file| DialogOutcome::Open(vec![file]));
        let screen = ui.ctx().content_rect().size();
        let size = vec2(SIZE[0].min(screen.x - 56.0), SIZE[1].min(screen.y - 48.0)).max(vec2(120.0, 80.0));
        let area =
            Area::new(Id::unique("open")).order(Order::Foreground).anchor(Align2::CENTER_CENTER, [0.0, 0.0]);
        area.show(ui.ctx(), |ui| {
            style::card().fill(style::card().fill.to_opaque()).show(ui, |ui| {
                ui.set_width(size.x);
                ui.horizontal(|ui| {
                    ui.heading("Open a scan");
                    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                        if ui.small_button("Close").clicked() {
                            choice = Some(DialogOutcome::Close);
                        }
                    });
                });
                self.ways(ui);
                let opened = self.list(ui, size.y - 150.0);
                if let Some(problem) = &self.problem {
                    ui.label(RichText::new(problem).small().color(BAD));
                }
                choice = choice.take().or(opened).or(self.ending(ui));
            });
        });
        if ui.input(|input| input.key_pressed(Key::Escape)) {
            choice = Some(DialogOutcome::Close);
        }
        choice
    }

    /// Draws where one is, and the ways up and home.
    fn ways(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            let above = self.folder.parent().map(Path::to_path_buf);
            if ui.add_enabled(above.is_some(), Button::new("Up")).clicked()
                && let Some(above) = above
            {
                self.go(above);
            }
            if ui.button("Home").clicked() {
                self.go(home());
            }
            let folder = self.folder.display().to_string();
            ui.add(Label::new(RichText::new(&folder).color(FAINT)).truncate()).on_hover_text(folder);
        });
    }

    /// Draws the folder's folders and scans; returns what a double click opens.
    fn list(&mut self, ui: &mut Ui, height: f32) -> Option<DialogOutcome> {
        let height = height.max(40.0);
        let mut asked = None;
        let (mut enters, mut picks) = (None, None);
        let rows = ScrollArea::vertical().max_height(height).min_scrolled_height(height).auto_shrink(false);
        ui.spacing_mut().item_spacing.y = 0.0;
        rows.show_rows(ui, ROW, self.entries.len(), |ui, shown| {
            for entry in &self.entries[shown] {
                let (name, size) = match entry.bytes {
                    None => (format!("{} /", entry.name), String::new()),
                    Some(bytes) => (entry.name.clone(), numbers::bytes(bytes)),
                };
                let is_chosen = self.chosen.contains(&entry.path);
                let button = Button::selectable(is_chosen, name)
                    .right_text(RichText::new(size).color(FAINT))
                    .truncate();
                let button = ui.add_sized([ui.available_width(), ROW], button);
                if button.clicked() && entry.bytes.is_none() {
                    enters = Some(entry.path.clone());
                } else if button.double_clicked() {
                    asked = Some(DialogOutcome::Open(vec![entry.path.clone()]));
                } else if button.clicked() {
                    picks = Some(entry.path.clone());
                }
            }
        });
        if self.entries.is_empty() && self.looking.is_none() && self.problem.is_none() {
            let formats = points::format_names("or");
            ui.label(caption(&format!("There is no folder here, and no {formats} file.")));
        }
        ui.spacing_mut().item_spacing.y = 4.0;
        if let Some(path) = picks {
            self.pick(path, ui.input(|input| input.modifiers.command));
        }
        if let Some(folder) = enters {
            self.go(folder);
        }
        asked
    }

    /// Chooses a file in place of the others, or beside them.
    fn pick(&mut self, path: PathBuf, beside: bool) {
        self.typed.clear();
        let was_chosen = self.chosen.contains(&path);
        if !beside {
            self.chosen.clear();
        }
        if beside && was_chosen {
            self.chosen.remove(&path);
        } else {
            self.chosen.insert(path);
        }
    }

    /// Draws the path's field and the button that opens.
    fn ending(&mut self, ui: &mut Ui) -> Option<DialogOutcome> {
        let mut confirmed = false;
        ui.add_space(4.0);
        ui.horizontal(|ui| {
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let can_open = !self.typed.trim().is_empty() || !self.chosen.is_empty();
                confirmed |= ui.add_enabled(can_open, Button::new("Open")).clicked();
                let field =
                    TextEdit::singleline(&mut self.typed).hint_text("A path").desired_width(f32::INFINITY);
                let field = ui.add(field);
                if std::mem::take(&mut self.takes_keys) {
                    field.request_focus();
                }
                let entered = ui.input(|input| input.key_pressed(Key::Enter));
                let is_elsewhere = ui.memory(|memory| memory.focused().is_none());
                confirmed |= entered && (field.lost_focus() || is_elsewhere);
            });
        });
        ui.label(caption("Ctrl and a click: several files as one scan. Enter opens, Esc closes."));
        if confirmed { self.confirm() } else { None }
    }
}

/// Draws what a window without a scan offers; true if the dialog is to open.
pub(super) fn welcome(ui: &mut Ui, within: Rect) -> bool {
    let area =
        Area::new(Id::unique("welcome")).constrain_to(within).anchor(Align2::CENTER_CENTER, [0.0, 0.0]);
    let shown = area.show(ui.ctx(), |ui| {
        let contents = style::card().show(ui, |ui| {
            ui.set_max_width(280.0);
            ui.heading("No scan is open");
            let formats = points::format_names("or");
            ui.label(format!("Drop one on this window ({formats}), or choose it:"));
            ui.add_space(4.0);
            ui.button("Open… (Ctrl+O)").clicked()
        });
        contents.inner
    });
    shown.inner
}

/// The user's own folder.
fn home() -> PathBuf {
    etcetera::home_dir().unwrap_or_else(|_| PathBuf::from("/"))
}

/// Looks where a path leads. Names that begin with a dot are passed over, as everywhere.
fn look(path: &Path) -> PathTarget {
    let failed = |error: std::io::Error| {
        PathTarget::Nothing(format!("{} cannot be read: {error}; choose another", path.display()))
    };
    match std::fs::metadata(path) {
        Err(error) => return failed(error),
        Ok(found) if !found.is_dir() => return PathTarget::File(path.to_owned()),
        Ok(_) => {}
    }
    let folder = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let entry = |found: std::fs::DirEntry| {
        let (path, name) = (found.path(), found.file_name().display().to_string());
        // Links are followed; what leads nowhere is left out.
        let about = std::fs::metadata(&path).ok().filter(|_| !name.starts_with('.'))?;
        let is_scan = points::is_named_as_scan(&path);
        let bytes = (!about.is_dir()).then_some(about.len());
        (about.is_dir() || is_scan).then_some(FolderEntry { name, path, bytes })
    };
    match std::fs::read_dir(&folder) {
        Err(error) => failed(error),
        Ok(all) => {
            let mut entries: Vec<FolderEntry> = all.flatten().filter_map(entry).collect();
            entries.sort_by_cached_key(|entry| (entry.bytes.is_some(), entry.name.to_lowercase()));
            PathTarget::Folder(folder, entries)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dialog(folder: &Path) -> OpenDialog {
        let mut dialog = OpenDialog::new(&[folder.join("shown.las")]);
        settle(&mut dialog);
        dialog
    }

    /// Waits for the thread; returns the file that was found.
    fn settle(dialog: &mut OpenDialog) -> Option<PathBuf> {
        kit::wait::wait_for("the folder", || {
            let file = dialog.take_in();
            dialog.looking.is_none().then_some(file)
        })
    }

    fn names(dialog: &OpenDialog) -> Vec<&str> {
        dialog.entries.iter().map(|entry| entry.name.as_str()).collect()
    }

    #[test]
    fn it_lists_folders_and_scans_and_opens_what_is_chosen() {
        let folder = tempfile::tempdir().unwrap();
        let at = std::fs::canonicalize(folder.path()).unwrap();
        for name in ["b.LAZ", "a.las", "notes.md", "las", ".hidden.las"] {
            std::fs::write(at.join(name), "12345").unwrap();
        }
        std::fs::create_dir(at.join("tiles")).unwrap();
        let mut dialog = dialog(&at);
        assert_eq!(names(&dialog), ["tiles", "a.las", "b.LAZ"]);
        assert_eq!(dialog.entries[1].bytes, Some(5));
        assert_eq!(dialog.confirm(), None, "nothing is chosen");
        dialog.pick(at.join("a.las"), false);
        dialog.pick(at.join("b.LAZ"), false);
        assert_eq!(dialog.confirm(), Some(DialogOutcome::Open(vec![at.join("b.LAZ")])));
        dialog.pick(at.join("a.las"), true);
        assert_eq!(dialog.confirm(), Some(DialogOutcome::Open(vec![at.join("a.las"), at.join("b.LAZ")])));
        dialog.pick(at.join("b.LAZ"), true);
        assert_eq!(dialog.confirm(), Some(DialogOutcome::Open(vec![at.join("a.las")])));
    }

    #[test]
    fn what_is_typed_is_a_folder_a_file_or_said_to_be_none() {
        let folder = tempfile::tempdir().unwrap();
        let at = std::fs::canonicalize(folder.path()).unwrap();
        std::fs::create_dir(at.join("tiles")).unwrap();
        std::fs::write(at.join("tiles/odd.bin"), "").unwrap();
        let mut dialog = dialog(&at);
        let mut enter = |typed: &str| {
            dialog.typed = typed.into();
            assert_eq!(dialog.confirm(), None, "a thread looks first");
            let file = settle(&mut dialog);
            (file, dialog.folder.clone(), dialog.problem.clone())
        };
        assert_eq!(enter("tiles"), (None, at.join("tiles"), None));
        // A file whose name says nothing is opened all the same: its content tells.
        assert_eq!(enter("odd.bin"), (Some(at.join("tiles/odd.bin")), at.join("tiles"), None));
        let (file, still, problem) = enter("none.las");
        assert_eq!((file, still), (None, at.join("tiles")));
        assert!(problem.is_some_and(|problem| problem.contains("none.las cannot be read")));
        assert_eq!(enter(at.to_str().unwrap()).1, at);
    }

    #[test]
    fn another_scan_is_read_as_the_one_before() {
        let read = points::ReadOptions { strict: true, ..points::ReadOptions::AS_FILES_SAY };
        let before = ScanRequest { files: vec!["a.las".into()], read, kind: None };
        let Action::Open(request) = open(vec!["b.las".into()], &before) else { panic!("it opens") };
        assert_eq!((&request.files[..], request.read.strict), (&[PathBuf::from("b.las")][..], true));
    }
}
