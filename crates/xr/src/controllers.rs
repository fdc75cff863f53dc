//! What the parts of each kind of controller are for: one table, from which come the bindings that a runtime is told and
//! the table in docs/CONTROLLERS.md.
//!
//! Paths are those of the specification's interaction profiles. A runtime maps a controller that it does not find here
//! to the kind that is most like it.

use openxr::ExtensionSet;

/// What a part of a controller is for: an action in OpenXR's sense.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Control {
    /// The pose of the pointing ray.
    Aim,
    /// The pose of what the hand holds.
    Grip,
    /// The stick.
    Move,
    /// The button under a trackpad. Where there is one, [`Control::Move`] counts only while it is pressed.
    Press,
    /// The trigger.
    Select,
    /// A grab, as a button.
    Grab,
    /// A grab, as how hard the hand squeezes.
    Squeeze,
    /// A bare hand's pinch: a selection, or the menu while the palm faces the eyes.
    Pinch,
    /// The menu button.
    Menu,
    /// The button that leads back to the start.
    Reset,
    /// The motor that shakes the controller.
    Vibration,
}

/// The hands that have a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WhichHands {
    /// Left and right.
    Both,
    /// The left one.
    Left,
    /// The right one.
    Right,
}

impl WhichHands {
    /// True if the hand is one of these: 0 is left, 1 is right.
    #[must_use]
    pub fn contain(self, hand: usize) -> bool {
        self == Self::Both || [Self::Left, Self::Right].get(hand) == Some(&self)
    }
}

/// A part of a controller and what it is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ControlBinding {
    /// What it is for.
    pub control: Control,
    /// The hands that have it.
    pub hands: WhichHands,
    /// Its path below that of the hand: "input/trigger/value".
    pub path: &'static str,
}

impl ControlBinding {
    /// What people call the part: "Trigger". `None` for what no finger touches.
    #[must_use]
    pub fn name(&self) -> Option<&'static str> {
        let mut words = self.path.strip_prefix("input/")?.split('/');
        Some(match (words.next()?, words.next()) {
            ("thumbstick", Some("click")) => "Stick, pressed",
            ("thumbstick", _) => "Stick",
            ("trackpad", Some("click")) => "Trackpad, pressed",
            ("trackpad", _) => "Trackpad",
            ("trigger", _) => "Trigger",
            ("squeeze", _) => "Grip",
            ("select", _) => "Button",
            ("menu", _) => "Menu button",
            ("a", _) => "A",
            ("b", _) => "B",
            ("y", _) => "Y",
            ("pinch_ext", _) => "Pinch",
            ("grasp_ext", _) => "Fist",
            _ => return None,
        })
    }
}

/// An extension that adds a kind of controller.
#[derive(Clone, Copy, Debug)]
pub struct Extension {
    /// Its name in the specification.
    pub name: &'static str,
    /// Its place in a set of extensions.
    pub flag: fn(&mut ExtensionSet) -> &mut bool,
}

/// A kind of controller: an interaction profile in OpenXR's sense.
#[derive(Clone, Copy, Debug)]
pub struct Profile {
    /// What people call it.
    pub name: &'static str,
    /// Its path.
    pub path: &'static str,
    /// The extension that it comes with; `None` if every runtime of OpenXR 1.0 knows the path.
    pub extension: Option<Extension>,
    /// Its parts except the poses, which all kinds have.
    parts: &'static [ControlBinding],
}

impl PartialEq for Profile {
    /// A kind is known by its path.
    fn eq(&self, other: &Self) -> bool {
        self.path == other.path
    }
}

impl Profile {
    /// All parts.
    pub fn bindings(&self) -> impl Iterator<Item = &'static ControlBinding> {
        POSES.iter().chain(self.parts)
    }

    /// The parts of a hand, 0 left and 1 right, that are for `control`.
    pub fn of(&self, control: Control, hand: usize) -> impl Iterator<Item = &'static ControlBinding> {
        self.bindings().filter(move |part| part.control == control && part.hands.contain(hand))
    }

    /// True for hands that hold nothing.
    #[must_use]
    pub fn is_bare_hand(&self) -> bool {
        self.bindings().any(|part| part.control == Control::Pinch)
    }
}

const fn both(control: Control, path: &'static str) -> ControlBinding {
    ControlBinding { control, hands: WhichHands::Both, path }
}

const fn left(control: Control, path: &'static str) -> ControlBinding {
    ControlBinding { control, hands: WhichHands::Left, path }
}

const fn right(control: Control, path: &'static str) -> ControlBinding {
    ControlBinding { control, hands: WhichHands::Right, path }
}

/// What all kinds have.
const POSES: [ControlBinding; 2] =
    [both(Control::Aim, "input/aim/pose"), both(Control::Grip, "input/grip/pose")];

/// The parts of Meta's controllers, which differ in what scanwalk has no use for.
const TOUCH: [ControlBinding; 9] = [
    both(Control::Move, "input/thumbstick"),
    both(Control::Select, "input/trigger/value"),
    both(Control::Squeeze, "input/squeeze/value"),
    left(Control::Menu, "input/menu/click"),
    left(Control::Menu, "input/y/click"),
    right(Control::Menu, "input/b/click"),
    both(Control::Reset, "input/thumbstick/click"),
    right(Control::Reset, "input/a/click"),
    both(Control::Vibration, "output/haptic"),
];

/// The parts of controllers that are like Meta's and have a button for the grab.
const TOUCH_WITH_GRAB: [ControlBinding; 9] = [
    both(Control::Move, "input/thumbstick"),
    both(Control::Select, "input/trigger/value"),
    both(Control::Grab, "input/squeeze/click"),
    left(Control::Menu, "input/menu/click"),
    left(Control::Menu, "input/y/click"),
    right(Control::Menu, "input/b/click"),
    both(Control::Reset, "input/thumbstick/click"),
    right(Control::Reset, "input/a/click"),
    both(Control::Vibration, "output/haptic"),
];

/// The path of the one kind that every runtime must know.
const SIMPLE: &str = "/interaction_profiles/khr/simple_controller";

/// The extension of both kinds of Pico controllers.
const PICO: Extension =
    Extension { name: "XR_BD_controller_interaction", flag: |set| &mut set.bd_controller_interaction };

/// The kinds of controllers.
///
/// The names that OpenXR 1.1 has for kinds of extensions are left out, for scanwalk asks for 1.0, and runtimes of 1.1
/// still offer the extensions.
pub const PROFILES: [Profile; 13] = [
    Profile {
        name: "Valve Index",
        path: "/interaction_profiles/valve/index_controller",
        extension: None,
        parts: &[
            both(Control::Move, "input/thumbstick"),
            both(Control::Select, "input/trigger/value"),
            // The value is 1 as soon as a hand lies round the controller.
            both(Control::Squeeze, "input/squeeze/force"),
            both(Control::Menu, "input/b/click"),
            both(Control::Reset, "input/thumbstick/click"),
            right(Control::Reset, "input/a/click"),
            both(Control::Vibration, "output/haptic"),
        ],
    },
    Profile {
        name: "Oculus Touch (Quest, Quest 2, Rift)",
        path: "/interaction_profiles/oculus/touch_controller",
        extension: None,
        parts: &TOUCH,
    },
    Profile {
        name: "Meta Quest Touch Plus (Quest 3)",
        path: "/interaction_profiles/meta/touch_controller_plus",
        extension: Some(Extension {
            name: "XR_META_touch_controller_plus",
            flag: |set| &mut set.meta_touch_controller_plus,
        }),
        parts: &TOUCH,
    },
    Profile {
        name: "Meta Quest Touch Pro",
        path: "/interaction_profiles/facebook/touch_controller_pro",
        extension: Some(Extension {
            name: "XR_FB_touch_controller_pro",
            flag: |set| &mut set.fb_touch_controller_pro,
        }),
        parts: &TOUCH,
    },
    Profile {
        name: "HTC Vive",
        path: "/interaction_profiles/htc/vive_controller",
        extension: None,
        parts: &[
            both(Control::Move, "input/trackpad"),
            both(Control::Press, "input/trackpad/click"),
            both(Control::Select, "input/trigger/value"),
            both(Control::Grab, "input/squeeze/click"),
            both(Control::Menu, "input/menu/click"),
            both(Control::Vibration, "output/haptic"),
        ],
    },
    Profile {
        name: "HTC Vive Cosmos",
        path: "/interaction_profiles/htc/vive_cosmos_controller",
        extension: Some(Extension {
            name: "XR_HTC_vive_cosmos_controller_interaction",
            flag: |set| &mut set.htc_vive_cosmos_controller_interaction,
        }),
        parts: &TOUCH_WITH_GRAB,
    },
    Profile {
        name: "HTC Vive Focus 3",
        path: "/interaction_profiles/htc/vive_focus3_controller",
        extension: Some(Extension {
            name: "XR_HTC_vive_focus3_controller_interaction",
            flag: |set| &mut set.htc_vive_focus3_controller_interaction,
        }),
        parts: &TOUCH_WITH_GRAB,
    },
    Profile {
        name: "Windows Mixed Reality",
        path: "/interaction_profiles/microsoft/motion_controller",
        extension: None,
        parts: &[
            both(Control::Move, "input/thumbstick"),
            both(Control::Select, "input/trigger/value"),
            both(Control::Grab, "input/squeeze/click"),
            both(Control::Menu, "input/menu/click"),
            both(Control::Reset, "input/thumbstick/click"),
            both(Control::Vibration, "output/haptic"),
        ],
    },
    Profile {
        name: "HP Reverb G2",
        path: "/interaction_profiles/hp/mixed_reality_controller",
        extension: Some(Extension {
            name: "XR_EXT_hp_mixed_reality_controller",
            flag: |set| &mut set.ext_hp_mixed_reality_controller,
        }),
        parts: &[
            both(Control::Move, "input/thumbstick"),
            both(Control::Select, "input/trigger/value"),
            both(Control::Squeeze, "input/squeeze/value"),
            both(Control::Menu, "input/menu/click"),
            both(Control::Reset, "input/thumbstick/click"),
            right(Control::Reset, "input/a/click"),
            both(Control::Vibration, "output/haptic"),
        ],
    },
    Profile {
        name: "Pico 4",
        path: "/interaction_profiles/bytedance/pico4_controller",
        extension: Some(PICO),
        parts: &TOUCH_WITH_GRAB,
    },
    Profile {
        name: "Pico Neo 3",
        path: "/interaction_profiles/bytedance/pico_neo3_controller",
        extension: Some(PICO),
        parts: &[
            both(Control::Move, "input/thumbstick"),
            both(Control::Select, "input/trigger/value"),
            both(Control::Grab, "input/squeeze/click"),
            both(Control::Menu, "input/menu/click"),
            both(Control::Reset, "input/thumbstick/click"),
            right(Control::Reset, "input/a/click"),
            both(Control::Vibration, "output/haptic"),
        ],
    },
    Profile {
        name: "Bare hands",
        path: "/interaction_profiles/ext/hand_interaction_ext",
        extension: Some(Extension {
            name: "XR_EXT_hand_interaction",
            flag: |set| &mut set.ext_hand_interaction,
        }),
        parts: &[
            both(Control::Pinch, "input/pinch_ext/value"),
            // Runtimes may have a gesture of their own for what is far away.
            both(Control::Pinch, "input/aim_activate_ext/value"),
            both(Control::Grab, "input/grasp_ext/value"),
        ],
    },
    Profile {
        name: "Any other",
        path: SIMPLE,
        extension: None,
        parts: &[
            both(Control::Select, "input/select/click"),
            both(Control::Menu, "input/menu/click"),
            both(Control::Vibration, "output/haptic"),
        ],
    },
];

#[cfg(test)]
mod tests {
    use super::*;

    /// What a profile lacks in a hand of what nobody can do without.
    fn lacks(profile: &Profile, hand: usize) -> Vec<&'static str> {
        let has = |controls: &[Control]| controls.iter().any(|c| profile.of(*c, hand).next().is_some());
        let essential: [(&str, &[Control]); 5] = [
            ("aim", &[Control::Aim]),
            ("grip", &[Control::Grip]),
            ("select", &[Control::Select, Control::Pinch]),
            ("menu", &[Control::Menu, Control::Pinch]),
            // Whoever has no stick moves by selecting where to.
            ("move", &[Control::Move, Control::Select, Control::Pinch]),
        ];
        essential.iter().filter(|(_, controls)| !has(controls)).map(|(name, _)| *name).collect()
    }

    #[test]
    fn both_hands_of_every_kind_reach_what_is_essential() {
        for profile in &PROFILES {
            for hand in [0, 1] {
                assert_eq!(lacks(profile, hand), [""; 0], "{}", profile.name);
            }
            let grabs = [Control::Grab, Control::Squeeze].iter().any(|c| profile.of(*c, 0).next().is_some());
            assert!(grabs || profile.path == SIMPLE, "{}", profile.name);
        }
        const ONE: [ControlBinding; 1] = [right(Control::Select, "input/select/click")];
        let one_handed = Profile { parts: &ONE, ..PROFILES[0] };
        assert_eq!(lacks(&one_handed, 0), ["select", "menu", "move"]);
        assert_eq!(lacks(&one_handed, 1), ["menu"]);
    }

    #[test]
    fn a_trackpad_has_a_button_and_a_stick_has_none() {
        for profile in &PROFILES {
            for hand in [0, 1] {
                let is_pad = profile.of(Control::Move, hand).any(|part| part.path.contains("trackpad"));
                assert_eq!(is_pad, profile.of(Control::Press, hand).next().is_some(), "{}", profile.name);
            }
        }
    }

    #[test]
    fn no_kind_and_no_part_is_named_twice() {
        for (at, profile) in PROFILES.iter().enumerate() {
            let same = |other: &Profile| other.path == profile.path || other.name == profile.name;
            assert!(!PROFILES[..at].iter().any(same), "{}", profile.name);
            assert!(profile.path.starts_with("/interaction_profiles/"), "{}", profile.path);
            for hand in [0, 1] {
                let mut paths: Vec<&str> = profile
                    .bindings()
                    .filter(|part| part.hands.contain(hand))
                    .map(|part| part.path)
                    .collect();
                assert!(paths.iter().all(|path| path.starts_with("input/") || path.starts_with("output/")));
                let num_paths = paths.len();
                paths.sort_unstable();
                paths.dedup();
                assert_eq!(paths.len(), num_paths, "{}: a part does two things", profile.name);
            }
        }
    }

    #[test]
    fn every_part_that_a_finger_touches_has_a_name() {
        for part in PROFILES.iter().flat_map(Profile::bindings) {
            let is_touched = !matches!(part.control, Control::Aim | Control::Grip | Control::Vibration);
            // What a runtime takes for a pinch at what is far away is a pinch all the same.
            let is_twice = part.path.starts_with("input/aim_activate_ext");
            assert_eq!(part.name().is_some(), is_touched && !is_twice, "{}", part.path);
        }
    }

    #[test]
    fn each_extension_has_its_own_flag() {
        for extension in PROFILES.iter().filter_map(|profile| profile.extension) {
            let mut set = ExtensionSet::default();
            *(extension.flag)(&mut set) = true;
            // The names end with a zero, as C wants them.
            let names: Vec<_> = set.names().iter().map(|name| name.to_vec()).collect();
            assert_eq!(names, [[extension.name.as_bytes(), b"\0"].concat()]);
        }
    }
}
